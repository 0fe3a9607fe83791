/* light.c - sampling and evaluating light sources.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/light.h"

#include "optics/sampling.h"
#include "trace/emitter_cells.h"
#include "trace/emitter_place.h"
#include "trace/light_flat.h"
#include "trace/texture_view.h"

static const Affine *light_place(const World *world, const SceneLight *light, double time, Affine *room)
{
    return scene_place_at(world->scene, light_keys(world->scene, light), &light->to_world, time, room);
}

/* 1 - cos of the half angle under which a sphere is seen whose centre is `to` away; precise for far and small ones. 2
 * from inside, and from the sphere itself: that is outside of it by rounding alone, and would light itself from where it is. */
static double sphere_cone(double radius, Vec3 to)
{
    const double on_sphere = 1e-9;
    double sine2 = radius * radius / vec3_dot(to, to);
    return sine2 < 1 - on_sphere ? sine2 / (1 + sqrt(1 - sine2)) : 2;
}

/* Samples are written where they are wanted: one that is handed up from function to function is copied each time, right after it
 * was written piece by piece, which is what processors wait longest for. */
static void sample_sphere(uint32_t object, double radius, Vec3 centre, Vec3 from, const float u[2], LightSample *sample)
{
    Vec3 to = vec3_sub(centre, from);
    double cone = sphere_cone(radius, to);
    if (cone >= 2) { /* from inside, the light's own surface is opaque */
        *sample = (LightSample){.pdf_w = 0};
        return;
    }
    Vec3f direction = sampling_cone(u[0], u[1], vec3f_from(vec3_scale(to, 1 / vec3_length(to))), (float)cone);
    /* to the near side: what is within the light does not hide it, and a medium takes nothing beyond that */
    Vec3 along = vec3_from_f(direction), beside = vec3_cross(to, along);
    double depth = sqrt(fmax(radius * radius - vec3_dot(beside, beside), 0)), distance = vec3_dot(to, along) - depth;
    double short_of = light_short_of(distance, depth / radius, vec3_along(from, distance, along));
    *sample = (LightSample){.direction = direction,
                            .distance = distance - short_of,
                            .short_of = short_of,
                            .object = object,
                            .primitive = RTC_NO_OBJECT,
                            .pdf_w = sampling_cone_pdf((float)cone)};
}

static void sample_distant(const SceneLight *light, const float u[2], LightSample *sample)
{
    double cone = 1 - light->cos_angle;
    *sample = (LightSample){.direction = sampling_cone(u[0], u[1], vec3f_from(light->towards), (float)cone),
                            .distance = HUGE_VAL,
                            .object = RTC_NO_OBJECT,
                            .pdf_w = sampling_cone_pdf((float)cone)};
}

/* Towards a place of a surface of that area; normal: of length 1, on the side that shines, or with two_sided on either. */
static void sample_place(Vec3 from, Vec3 place, Vec3 normal, bool two_sided, double area, LightSample *sample)
{
    Vec3 to = vec3_sub(place, from);
    double distance = vec3_length(to), cosine = -vec3_dot(to, normal) / distance;
    if (two_sided) cosine = fabs(cosine);
    if (!(cosine > 0) || !(area > 0)) {
        *sample = (LightSample){.pdf_w = 0};
        return;
    }
    double short_of = light_short_of(distance, cosine, place);
    *sample = (LightSample){.direction = vec3f_from(vec3_scale(to, 1 / distance)),
                            .distance = distance - short_of,
                            .short_of = short_of,
                            .object = RTC_NO_OBJECT,
                            .primitive = RTC_NO_OBJECT,
                            .pdf_w = (float)(distance * distance / (cosine * area))};
}

/* The same on the surface of an operand, which a look has to meet: a place of which only the rounded direction is known is met a
 * little before or behind it, and Embree finds no surface that is as near to a ray's end as what coordinates of that size are off by.
 * to: the place from there; across: along the normal. */
static void aim_at_cut(const Emitter *emitter, Vec3 to, Vec3 across, double coordinate, LightSample *sample)
{
    sample->object = emitter->of;
    sample->primitive = RTC_NO_OBJECT;
    if (!(sample->pdf_w > 0)) return;
    double distance = vec3_length(to), cosine = fabs(vec3_dot(to, across)) / (distance * vec3_length(across));
    double beyond = 2 * rtc_rounding(vec3(coordinate, 0, 0)) / cosine;
    sample->slack = (float)((2 * distance + beyond) / sample->distance - 2) + 1e-6f;
}

/* Of a triangle's corners, and of the place that it is looked at from. */
static double largest_coordinate(const World *world, const Emitter *emitter, const LightQuery *query)
{
    Vec3 corner[3];
    rtc_triangle(world->compiled->rtc, emitter->of, emitter->part, query->time, corner);
    double largest = vec3_max_abs(query->from);
    for (int i = 0; i < 3; i++) largest = fmax(largest, vec3_max_abs(corner[i]));
    return largest;
}

static void sample_triangle(const World *world, const Emitter *emitter, const LightQuery *query, LightSample *sample)
{
    const double u[2] = {(double)query->u[0], (double)query->u[1]};
    Vec3 across, place = emitter_place_on_triangle(world->compiled, emitter, query->time, u, &across);
    double length = vec3_length(across), sign = UNLIKELY(emitter->inward) ? -1 : 1;
    bool two_sided = !world->scene->shapes[world->scene->objects[emitter->of].shape].closed;
    sample_place(query->from, place, vec3_scale(across, sign / length), two_sided, 0.5 * length, sample);
    sample->object = emitter->of;
    sample->primitive = emitter->part;
    if (UNLIKELY(emitter->cut))
        aim_at_cut(emitter, vec3_sub(place, query->from), across, largest_coordinate(world, emitter, query), sample);
}

/* Uniform in the piece's own area, which an uneven map makes uneven. */
static void sample_piece(const World *world, const Emitter *emitter, const LightQuery *query, LightSample *sample)
{
    const Scene *scene = world->scene;
    const Piece *piece = emitter_piece(scene, emitter);
    Affine room;
    const Affine *to_world = scene_object_place(scene, &scene->objects[emitter->of], query->time, &room);
    Vec3 normal, local = piece_sample(piece, (double)query->u[0], (double)query->u[1], &normal);
    Vec3 across = affine_area(to_world, normal);
    double stretch = vec3_length(across), sign = (affine_determinant(to_world) < 0) != emitter->inward ? -1 : 1;
    Vec3 place = affine_point(to_world, local);
    sample_place(query->from, place, vec3_scale(across, sign / stretch), false, piece_area(piece) * stretch, sample);
    if (UNLIKELY(emitter->cut)) aim_at_cut(emitter, vec3_sub(place, query->from), across, vec3_max_abs(place), sample);
}

/* Of a round one that stands still: its radius in the world. */
static double ball_radius(const Scene *scene, const Emitter *emitter)
{
    const Affine *to_world = &scene->objects[emitter->of].to_world;
    return emitter_piece(scene, emitter)->r0 * vec3_length(affine_vector(to_world, vec3(1, 0, 0)));
}

/* As aim_at_cut, of the place that a ball was sampled at: a float direction is off by so much of the way, too. */
static void aim_at_cut_ball(const Scene *scene, const Emitter *emitter, Vec3 from, LightSample *sample)
{
    const double of_distance = 4e-7, least_cosine = 1e-9;
    const Vec3 center = scene->objects[emitter->of].to_world.t, along = vec3_from_f(sample->direction);
    const double radius = ball_radius(scene, emitter), distance = sample->distance + sample->short_of;
    const Vec3 out = vec3_sub(vec3_along(from, distance, along), center);
    const double cosine = double_max(fabs(vec3_dot(out, along)) / radius, least_cosine);
    const double beside = of_distance * distance + 2 * rtc_rounding(vec3(vec3_max_abs(center) + radius, 0, 0));
    const double off = double_min(beside / cosine, 0.5 * distance);
    sample->distance = distance - off; /* its near side, too */
    sample->slack = (float)(2 * off / sample->distance) + 1e-6f;
}

static void sample_ball(const World *world, const Emitter *emitter, const LightQuery *query, LightSample *sample)
{
    const Scene *scene = world->scene;
    sample_sphere(emitter->of, ball_radius(scene, emitter), scene->objects[emitter->of].to_world.t, query->from,
                  query->u, sample);
    if (UNLIKELY(emitter->cut) && sample->pdf_w > 0) aim_at_cut_ball(scene, emitter, query->from, sample);
}

/* A direction in the frame of a light. Between two places that it turns through the frame is squeezed; what the light
 * shines around it is not. */
static Vec3 in_frame(const SceneLight *light, const Affine *to_world, Vec3 direction)
{
    if (to_world == &light->to_world) return affine_normal(to_world, direction); /* rigid: the transpose inverts it */
    Vec3 y = vec3_normalize(affine_vector(to_world, vec3(0, 1, 0))), x = affine_vector(to_world, vec3(1, 0, 0));
    x = vec3_normalize(vec3_along(x, -vec3_dot(x, y), y));
    return vec3(vec3_dot(x, direction), vec3_dot(y, direction), vec3_dot(vec3_cross(x, y), direction));
}

static void sample_point(const SceneLight *light, const Affine *to_world, Vec3 from, LightSample *sample)
{
    Vec3 to = vec3_sub(to_world->t, from);
    double square = vec3_dot(to, to), distance = sqrt(square);
    *sample = (LightSample){.pdf_w = 0};
    if (!(distance > 0)) return;
    Vec3 direction = vec3_scale(to, 1 / distance);
    float shape = light_shape(light, vec3_scale(in_frame(light, to_world, direction), -1));
    if (!(shape > 0)) return;
    /* It may be on a surface, as a spot in a ceiling is: with this, one that is met at a cosine of 0.04 and more does not hide it. With
     * less, what a medium absorbs would be less by more than rounding. */
    const double cosine = 0.25, short_of = light_short_of(distance, cosine, to_world->t);
    *sample = (LightSample){.direction = vec3f_from(direction),
                            .distance = distance - short_of,
                            .short_of = short_of,
                            .object = RTC_NO_OBJECT,
                            .primitive = RTC_NO_OBJECT,
                            .pdf_w = 1,
                            .delta = true,
                            .radiance = lanes_all((float)((double)shape / square))};
}

static void sample_light(const World *world, const SceneLight *light, const LightQuery *query, LightSample *sample)
{
    Affine room;
    const Affine *to_world = light_place(world, light, query->time, &room);
    Lanes radiance = spectrum_at(&light->radiance, query->wavelength_nm);
    switch (light->kind) {
    case LIGHT_SPHERE:
        sample_sphere(light->object, light->half_width, to_world->t, query->from, query->u, sample);
        break;
    case LIGHT_DISTANT: sample_distant(light, query->u, sample); break;
    case LIGHT_POINT:
        sample_point(light, to_world, query->from, sample);
        radiance = lanes_mul(sample->radiance, radiance);
        break;
    default: {
        float part;
        light_flat_sample(light, to_world, query->from, query->u, sample, &part);
        radiance = lanes_scale(radiance, part);
    }
    }
    sample->radiance = radiance;
}

/* What a place shines that was chosen on an object: its own, or its texture's there. */
static Lanes sample_emission(const World *world, const SceneSurface *surface, const Emitter *emitter,
                             const LightQuery *query, const LightSample *sample)
{
    if (surface->emission_texture == SCENE_NONE || !(sample->pdf_w > 0))
        return spectrum_at(&surface->emission, query->wavelength_nm);
    Ray ray = ray_make(query->from, sample->direction);
    ray.time = query->time;
    Hit hit = {.t = sample->distance, .object = emitter->of, .primitive = emitter->part};
    if (emitter->kind == EMITTER_BALL) { /* of which the sample knows the direction only */
        const SceneObject *object = &world->scene->objects[emitter->of];
        double radius = ball_radius(world->scene, emitter);
        Vec3 to = vec3_sub(object->to_world.t, query->from);
        double middle = vec3_dot(to, vec3_from_f(sample->direction));
        hit.t = middle - sqrt(fmax(radius * radius + middle * middle - vec3_dot(to, to), 0));
    }
    if (emitter->kind == EMITTER_TRIANGLE) {
        Vec3 corner[3], p = ray_point(&ray, hit.t);
        rtc_triangle(world->compiled->rtc, emitter->of, emitter->part, query->time, corner);
        Vec3 b = vec3_sub(corner[1], corner[0]), c = vec3_sub(corner[2], corner[0]), at = vec3_sub(p, corner[0]);
        Vec3 normal = vec3_cross(b, c);
        double square = vec3_dot(normal, normal);
        hit.u = (float)(vec3_dot(vec3_cross(at, c), normal) / square);
        hit.v = (float)(vec3_dot(vec3_cross(b, at), normal) / square);
        hit.normal = vec3f_from(vec3_scale(normal, 1 / sqrt(square)));
    } else {
        /* only tells the side: patterns are looked up just beneath it */
        hit.normal = emitter->inward ? sample->direction : vec3f_negate(sample->direction);
    }
    return texture_emission(world, surface, &ray, &hit, 0, query->wavelength_nm);
}

/* Towards a place of a medium that shines. */
static void sample_glow(const World *world, const Glow *glow, const LightQuery *query, LightSample *sample)
{
    const Lanes wavelength_nm = query->wavelength_nm;
    GlowPoint point = glow_sample(world->scene, glow, query->time, query->rest, query->u);
    const SceneMedium *medium = &world->scene->media[glow->place->medium];
    Vec3 to = vec3_sub(point.position, query->from);
    double distance = vec3_length(to);
    *sample = (LightSample){.pdf_w = 0};
    if (!(point.amount > 0) || !(distance > 0)) return;
    Lanes radiance = lanes_scale(spectrum_at(&medium->emission, wavelength_nm), point.amount * (float)glow->across);
    if (medium->temperature) radiance = lanes_mul(radiance, media_planck_ratio(medium, point.kelvin, wavelength_nm));
    *sample = (LightSample){.direction = vec3f_from(vec3_scale(to, 1 / distance)),
                            .distance = distance,
                            .object = RTC_NO_OBJECT,
                            .primitive = RTC_NO_OBJECT,
                            .pdf_w = light_pdf_glow(glow, 1, point.density, distance * distance),
                            .glow = glow,
                            .radiance = radiance};
}

static inline void sample_object(const World *world, const Emitter *emitter, const LightQuery *query,
                                 LightSample *sample)
{
    const Scene *scene = world->scene;
    if (emitter->kind == EMITTER_TRIANGLE)
        sample_triangle(world, emitter, query, sample);
    else if (emitter->kind == EMITTER_BALL)
        sample_ball(world, emitter, query, sample);
    else
        sample_piece(world, emitter, query, sample);
    const SceneSurface *surface = &scene->surfaces[scene->objects[emitter->of].surface];
    sample->radiance = sample_emission(world, surface, emitter, query, sample);
}

/* Where its texture is bright. */
ATTR_APART static void sample_in_cells(const World *world, const Emitter *emitter, const LightQuery *query,
                                       LightSample *sample)
{
    LightQuery there = *query;
    float density = emitter_cells_choose(world->emitters.cells[emitter->cells - 1], query->u, there.u);
    sample_object(world, emitter, &there, sample);
    sample->pdf_w *= density;
}

static void sample_emitter(const World *world, const Emitter *emitter, const LightQuery *query, LightSample *sample)
{
    const Scene *scene = world->scene;
    if (emitter->kind == EMITTER_LIGHT) {
        sample_light(world, &scene->lights[emitter->of], query, sample);
        return;
    }
    if (emitter->kind == EMITTER_GLOW) {
        sample_glow(world, &world->media.glows[emitter->of], query, sample);
        return;
    }
    if (UNLIKELY(emitter->cells))
        sample_in_cells(world, emitter, query, sample);
    else
        sample_object(world, emitter, query, sample);
}

void light_sample_emitter(const World *world, uint32_t emitter, const LightQuery *query, LightSample *sample)
{
    sample_emitter(world, &world->emitters.emitters[emitter], query, sample);
    sample->emitter = emitter;
    sample->choice = 1;
}

uint32_t light_sample_object(const World *world, const LightSample *sample)
{
    if (sample->object != RTC_NO_OBJECT || sample->emitter == EMITTER_NONE) return sample->object;
    const Emitter *emitter = &world->emitters.emitters[sample->emitter];
    return emitter->kind == EMITTER_PIECE ? emitter->of : RTC_NO_OBJECT;
}

bool light_is_met(const World *world, const LightSample *sample, const Hit *hit)
{
    if (hit->object != sample->object || hit->t < sample->distance) return false;
    bool inward = world->emitters.emitters[sample->emitter].inward;
    return hit->entering != inward || !world->scene->shapes[world->scene->objects[hit->object].shape].closed;
}

double light_send_extent(const World *world, uint32_t emitter)
{
    const SceneLight *light = light_of_emitter(world, emitter);
    return light && light_is_focused(light) ? light_flat_extent(light) : 0;
}

void light_send(const World *world, uint32_t emitter, double time, const float u[2], const float v[2], Vec3 *origin,
                Vec3f *direction)
{
    const SceneLight *light = light_of_emitter(world, emitter);
    Affine room;
    light_flat_send(light, light_place(world, light, time, &room), u, v, origin, direction);
}

const LightChoice *light_choose(const LightChoices *choices, double *choice)
{
    uint32_t i = 0;
    while (i + 1 < choices->n && *choice >= (double)choices->items[i].cumulative) i++;
    const LightChoice *chosen = &choices->items[i];
    double before = i ? (double)choices->items[i - 1].cumulative : 0;
    *choice = fmin(fmax((*choice - before) / ((double)chosen->cumulative - before), 0), 1 - 0x1p-53);
    return chosen;
}

void light_sample_choice(const World *world, const LightChoice *chosen, LightQuery *query, LightSample *sample)
{
    float probability = chosen->probability;
    if (chosen->light == LIGHT_NEAR) {
        float of_tree;
        uint32_t emitter = light_tree_choose(world->emitters.tree, query->from, query->normal, &query->rest, &of_tree);
        if (emitter == LIGHT_TREE_NONE) {
            *sample = (LightSample){.pdf_w = 0};
            return;
        }
        light_sample_emitter(world, emitter, query, sample);
        probability *= of_tree;
    } else {
        if (chosen->light == LIGHT_ENVIRONMENT)
            light_sample_environment(world, query, sample);
        else
            sample_light(world, &world->scene->lights[chosen->light], query, sample);
        sample->emitter = EMITTER_NONE;
        sample->distant = chosen->light;
    }
    sample->choice = probability;
    sample->pdf_w *= probability;
}

void light_sample(const World *world, const LightChoices *choices, LightQuery *query, LightSample *sample)
{
    if (!choices->n) {
        *sample = (LightSample){.pdf_w = 0};
        return;
    }
    light_sample_choice(world, light_choose(choices, &query->rest), query, sample);
}

/* ---- what lights a line ---- */

static LightPivot pivot_of_ball(Vec3 middle, double radius)
{
    return (LightPivot){middle, 0.25 * radius * radius};
}

LightPivot light_pivot_at(const World *world, uint32_t number, double time, Vec3 place)
{
    const Emitter *emitter = &world->emitters.emitters[number];
    const Scene *scene = world->scene;
    if (emitter->kind == EMITTER_BALL)
        return pivot_of_ball(scene->objects[emitter->of].to_world.t, ball_radius(scene, emitter));
    const SceneLight *light = emitter->kind == EMITTER_LIGHT ? &scene->lights[emitter->of] : NULL;
    if (light &&
        (light->kind == LIGHT_SPHERE || light_is_focused(light))) { /* which place depends on where it is seen from */
        Affine room;
        return pivot_of_ball(light_place(world, light, time, &room)->t, light->half_width);
    }
    return (LightPivot){place, 0};
}

LightPivot light_pivot(const World *world, uint32_t number, double time, double rest, const float u[2])
{
    const Emitter *emitter = &world->emitters.emitters[number];
    const Scene *scene = world->scene;
    Vec3 place = vec3(0, 0, 0);
    float chosen[2];
    if (UNLIKELY(emitter->cells)) {
        emitter_cells_choose(world->emitters.cells[emitter->cells - 1], u, chosen);
        u = chosen;
    }
    switch (emitter->kind) {
    case EMITTER_LIGHT: {
        double ignored;
        place = light_even_place(world, number, time, u, &ignored);
        break;
    }
    case EMITTER_TRIANGLE:
    case EMITTER_PIECE: {
        const double there[2] = {(double)u[0], (double)u[1]};
        place = emitter_place(world->compiled, emitter, time, there, NULL);
        break;
    }
    case EMITTER_BALL: break;
    case EMITTER_GLOW: place = glow_sample(scene, &world->media.glows[emitter->of], time, rest, u).position; break;
    }
    return light_pivot_at(world, number, time, place);
}

Vec3 light_even_place(const World *world, uint32_t emitter, double time, const float u[2], double *area)
{
    const SceneLight *light = light_of_emitter(world, emitter);
    Affine room;
    const Affine *to_world = light_place(world, light, time, &room);
    *area = light_is_flat(light) ? light_flat_area(light, to_world) : 0;
    return light_is_flat(light) ? light_flat_point(light, to_world, u) : to_world->t;
}

double light_even_area(const World *world, uint32_t emitter, double time)
{
    const SceneLight *light = light_of_emitter(world, emitter);
    Affine room;
    return light_is_flat(light) ? light_flat_area(light, light_place(world, light, time, &room)) : 0;
}

bool light_shines_at(const World *world, uint32_t emitter, double time, Vec3 place, Vec3 point)
{
    const SceneLight *light = light_of_emitter(world, emitter);
    Affine room;
    const Affine *to_world = light_place(world, light, time, &room);
    Vec3 local = vec3_normalize(affine_normal(to_world, vec3_sub(point, place))); /* the transpose inverts a rotation */
    return light_shape(light, local) > 0;
}

bool light_reach(const World *world, uint32_t number, double time, Vec3 origin, Vec3f direction, double *begin,
                 double *end)
{
    const Emitter *emitter = &world->emitters.emitters[number];
    if (emitter->kind != EMITTER_LIGHT) return true;
    const SceneLight *light = &world->scene->lights[emitter->of];
    bool flat = light_is_flat(light);
    if (!flat && (light->kind != LIGHT_POINT || !(light->cos_none > 0))) return true;
    Affine room;
    const Affine *to_world = light_place(world, light, time, &room);
    if (flat) return light_flat_reach(light, to_world, origin, direction, begin, end);
    Vec3 axis = vec3_normalize(affine_vector(to_world, vec3(0, 1, 0)));
    return light_cut_to_cone(vec3_sub(origin, to_world->t), vec3_from_f(direction), axis, light->cos_none, begin, end);
}

uint32_t light_sample_group(const World *world, const LightSample *sample)
{
    const Scene *scene = world->scene;
    if (sample->of_sky) return scene->environment_group;
    if (sample->emitter == EMITTER_NONE) return scene->lights[sample->distant].group;
    const Emitter *emitter = &world->emitters.emitters[sample->emitter];
    if (emitter->kind == EMITTER_LIGHT) return scene->lights[emitter->of].group;
    if (emitter->kind == EMITTER_GLOW) return scene->media[world->media.glows[emitter->of].place->medium].light_group;
    return scene->surfaces[scene->objects[emitter->of].surface].light_group;
}

uint32_t light_hit_group(const World *world, const Hit *hit)
{
    const ObjectLook *look = &world->looks[hit->object];
    if (look->light != SCENE_NONE) return world->scene->lights[look->light].group;
    return world->scene->surfaces[look->surface].light_group;
}

bool light_radiance_hit(const World *world, const Ray *ray, const Hit *hit, double footprint, Lanes wavelength_nm,
                        Lanes *radiance)
{
    const Scene *scene = world->scene;
    const ObjectLook *look = &world->looks[hit->object];
    if (LIKELY(!look->shines)) return false;
    if (look->light != SCENE_NONE) {
        const SceneLight *light = &scene->lights[look->light];
        *radiance = spectrum_at(&light->radiance, wavelength_nm);
        if (UNLIKELY(light_is_focused(light))) {
            Affine room;
            const Affine *to_world = light_place(world, light, ray->time, &room);
            *radiance = lanes_scale(*radiance, light_flat_radiance(light, to_world, ray->direction));
        }
        return hit->entering; /* lights shine to one side */
    }
    const SceneSurface *surface = &scene->surfaces[look->surface];
    *radiance = surface->emission_texture == SCENE_NONE
                    ? spectrum_at(&surface->emission, wavelength_nm)
                    : texture_emission(world, surface, ray, hit, footprint, wavelength_nm);
    return true;
}

static float light_pdf(const World *world, const SceneLight *light, Vec3 from, const Ray *ray, const Hit *hit)
{
    Affine room;
    const Affine *to_world = light_place(world, light, ray->time, &room);
    if (light->kind == LIGHT_SPHERE) {
        double cone = sphere_cone(light->half_width, vec3_sub(to_world->t, from));
        return cone < 2 ? sampling_cone_pdf((float)cone) : 0;
    }
    return hit->entering ? light_flat_pdf(light, to_world, from, ray, hit) : 0;
}

/* Of a place on an object that shines. */
static float object_pdf(const World *world, const Emitter *emitter, Vec3 from, const Ray *ray, const Hit *hit)
{
    const SceneObject *object = &world->scene->objects[emitter->of];
    double area;
    if (emitter->kind == EMITTER_TRIANGLE) {
        if (hit->entering == emitter->inward && world->scene->shapes[object->shape].closed) return 0;
        Vec3 corner[3];
        rtc_triangle(world->compiled->rtc, emitter->of, emitter->part, ray->time, corner);
        area = 0.5 * vec3_length(vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0])));
    } else if (hit->entering == emitter->inward) {
        return 0;
    } else if (emitter->kind == EMITTER_BALL) {
        double cone = sphere_cone(ball_radius(world->scene, emitter), vec3_sub(object->to_world.t, from));
        return cone < 2 ? sampling_cone_pdf((float)cone) : 0;
    } else {
        /* the map takes the local unit normal m to a normal along n, and its area to |det| / |transpose n| times as much */
        Affine room;
        const Affine *to_world = scene_object_place(world->scene, object, ray->time, &room);
        double stretch =
            fabs(affine_determinant(to_world)) / vec3_length(affine_normal(to_world, vec3_from_f(hit->normal)));
        area = piece_area(emitter_piece(world->scene, emitter)) * stretch;
    }
    Vec3 to = vec3_sub(ray_point(ray, hit->t), from);
    float pdf = area > 0 ? (float)(vec3_dot(to, to) / (fabs(hit->cos_normal) * area)) : 0;
    if (UNLIKELY(emitter->cells))
        pdf *= emitter_cells_density_hit(&world->emitters, world->compiled, emitter, ray, hit);
    return pdf;
}

float light_pdf_hit(const World *world, const LightChoices *choices, Vec3 from, Vec3f normal, const Ray *ray,
                    const Hit *hit)
{
    const EmitterSet *set = &world->emitters;
    uint32_t number = emitter_of_hit(set, hit);
    if (number == EMITTER_NONE) return 0;
    float choice = light_choice(world, choices, number, from, normal);
    if (!(choice > 0)) return 0;
    const Emitter *emitter = &set->emitters[number];
    return choice * (emitter->kind == EMITTER_LIGHT
                         ? light_pdf(world, &world->scene->lights[emitter->of], from, ray, hit)
                         : object_pdf(world, emitter, from, ray, hit));
}

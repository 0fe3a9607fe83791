/* photon_start.c - where photons start: at points of the targets' boxes, with a light that is seen from there. Of lamps that shine
 * into a cone alone, whose beams may be a thousandth as wide as the boxes, the points are those that light from the lamp comes
 * to.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/photon_start.h"

#include "nest/csg.h"
#include "optics/sampling.h"
#include "trace/shade.h"

/* Where there are such lamps, half the photons are theirs. */
#define BEAMS_PART 0.5
/* The part of a lamp that may shine at a place is a disc of which a square is sampled. */
enum { ATTEMPTS = 6 };

/* ---- boxes ---- */

/* A point of the targets' surfaces, uniform in area. u: uniform in [0, 1)^3. Returns the box. */
static uint32_t target_point(const PhotonTargets *targets, const float u[3], Vec3 *point, Vec3 *normal)
{
    double place = (double)u[2] * targets->cumulative[targets->n - 1];
    uint32_t chosen = 0;
    while (chosen + 1 < targets->n && place >= targets->cumulative[chosen]) chosen++;
    if (chosen) place -= targets->cumulative[chosen - 1];
    place /= targets->density[chosen];
    Box3 box = targets->boxes[chosen];
    Vec3 size = vec3_sub(box.max, box.min);
    double pair[3] = {size.y * size.z, size.z * size.x, size.x * size.y};
    int axis = 0;
    while (axis < 2 && place >= 2 * pair[axis]) place -= 2 * pair[axis++];
    double side = place >= pair[axis] ? 1 : 0, a = (double)u[0], b = (double)u[1];
    double at[3][3] = {{side, a, b}, {b, side, a}, {a, b, side}};
    *point = vec3(box.min.x + at[axis][0] * size.x, box.min.y + at[axis][1] * size.y, box.min.z + at[axis][2] * size.z);
    double sign = 2 * side - 1;
    *normal = vec3(axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0);
    return chosen;
}

static bool box_holds(const Box3 *box, Vec3 p)
{
    return p.x > box->min.x && p.x < box->max.x && p.y > box->min.y && p.y < box->max.y && p.z > box->min.z &&
           p.z < box->max.z;
}

/* Where a line, from + t direction, passes a box's surface first; HUGE_VAL: nowhere. */
static double first_of_box(const Box3 *box, Vec3 from, Vec3 direction)
{
    double enter, leave;
    if (!box3_cut(box, from, direction, &enter, &leave)) return HUGE_VAL;
    return enter > 0 ? enter : leave > 0 ? leave : HUGE_VAL;
}

static double box_size(const Box3 *box)
{
    return vec3_length(vec3_sub(box->max, box->min));
}

/* The normal of the face that a point of a box's surface is on. */
static Vec3 face_at(const Box3 *box, Vec3 p)
{
    const double off[6] = {p.x - box->min.x, box->max.x - p.x, p.y - box->min.y,
                           box->max.y - p.y, p.z - box->min.z, box->max.z - p.z};
    const Vec3 normals[6] = {vec3(-1, 0, 0), vec3(1, 0, 0),  vec3(0, -1, 0),
                             vec3(0, 1, 0),  vec3(0, 0, -1), vec3(0, 0, 1)};
    int nearest = 0;
    for (int i = 1; i < 6; i++)
        if (fabs(off[i]) < fabs(off[nearest])) nearest = i;
    return normals[nearest];
}

/* How far it may be at most from a point of a box to above a sea, in the direction of a light. Surfaces may be slanted, and are in
 * the tiles; of light that comes next to level they mirror nearly all. */
static double way_to_air(const PhotonTargets *targets, const Box3 *box, Vec3 direction)
{
    const double slanted = 2, level = 0.01;
    if (!targets->n_tiles) return 0;
    Box3 both = box3_union(*box, targets->boxes[targets->n - 1]);
    const double sizes[3] = {both.max.x - both.min.x, both.max.y - both.min.y, both.max.z - both.min.z};
    const double along[3] = {direction.x, direction.y, direction.z};
    return slanted * sizes[targets->up] / fmax(fabs(along[targets->up]), level);
}

/* ---- starts ---- */

void photon_choose_light(const Path *path, const PhotonStart *start, Vec3 from, Vec3f normal, LightSample *light)
{
    const World *world = path->tracer->world;
    if (!start || start->emitter == EMITTER_NONE) {
        path_choose_light(path, world_lights(world), from, normal, light);
    } else {
        enum { APART = 1 << 20 }; /* from the numbers of the way */
        LightQuery query = {.from = from, .time = path->ray.time, .wavelength_nm = path->wavelengths.nm};
        sampler_2d(&path->sampler, sampler_dimension(APART + start->attempt, DIM_LIGHT), query.u);
        light_sample_emitter(world, start->emitter, &query, light);
    }
    light->radiance = light_sample_radiance(world, light, path->wavelengths.nm);
}

/* A point of the boxes with any light. */
static bool start_at_box(const PhotonTargets *targets, const Path *path, const float u[3], PhotonStart *start)
{
    const World *world = path->tracer->world;
    uint32_t chosen = target_point(targets, u, &start->point, &start->normal);
    start->size = box_size(&targets->boxes[chosen]);
    start->emitter = EMITTER_NONE;
    photon_choose_light(path, start, start->point, vec3f(0, 0, 0), &start->light);
    const LightSample *light = &start->light;
    if (!(light->pdf_w > 0) || light->delta) return false;
    start->beyond = way_to_air(targets, &targets->boxes[chosen], vec3_from_f(light->direction));
    if (light->emitter != EMITTER_NONE && light_send_extent(world, light->emitter) > 0) return false; /* has its own */
    Vec3 direction = vec3_from_f(light->direction);
    double cosine = vec3_dot(direction, start->normal);
    /* a light outside sends light in, one inside sends it out; each ray starts at one point only */
    if (cosine < 0 && !(isfinite(light->distance) &&
                        box_holds(&targets->boxes[chosen], vec3_along(start->point, light->distance, direction))))
        return false;
    for (uint32_t i = 0; i < targets->n; i++)
        if (i != chosen && first_of_box(&targets->boxes[i], start->point, direction) < light->distance) return false;
    double area = targets->cumulative[targets->n - 1] / (targets->density[chosen] * (1 + targets->more[chosen]));
    start->more = (float)targets->more[chosen];
    start->flux_times_n = (float)(area * fabs(cosine) / (double)light->pdf_w);
    return true;
}

/* The lamp that a number in [0, 1) stands for, by their power; *part: its probability. */
static uint32_t choose_lamp(const PhotonTargets *targets, double u, double *part)
{
    const double all = targets->lamps[targets->n_lamps - 1].power;
    size_t low = 0, high = targets->n_lamps - 1;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (u * all < targets->lamps[middle].power)
            high = middle;
        else
            low = middle + 1;
    }
    *part = (targets->lamps[low].power - (low ? targets->lamps[low - 1].power : 0)) / all;
    return targets->lamps[low].emitter;
}

/* Where light that a lamp sends into its cone comes to the boxes. What is there of it is seen from the point as by any other
 * photon; that such points are as dense as the light that comes to them, times this, is what the flux takes. */
static bool start_at_lamp(const PhotonTargets *targets, const Path *path, double which, const float u[2],
                          const float v[2], PhotonStart *start)
{
    const World *world = path->tracer->world;
    double part = 0, nearest = HUGE_VAL;
    start->emitter = choose_lamp(targets, which, &part);
    if (!(part > 0)) return false;
    Vec3 origin;
    Vec3f direction;
    light_send(world, start->emitter, path->ray.time, u, v, &origin, &direction);
    uint32_t chosen = 0;
    for (uint32_t i = 0; i < targets->n; i++) {
        double t = first_of_box(&targets->boxes[i], origin, vec3_from_f(direction));
        if (t < nearest) nearest = t, chosen = i;
    }
    if (!isfinite(nearest)) return false;
    start->point = vec3_along(origin, nearest, vec3_from_f(direction));
    start->normal = face_at(&targets->boxes[chosen], start->point);
    start->size = box_size(&targets->boxes[chosen]);
    start->beyond = 0; /* a lamp is not that far */
    start->more = 0;
    start->light.pdf_w = 0;
    for (start->attempt = 0; start->attempt < ATTEMPTS; start->attempt++) {
        photon_choose_light(path, start, start->point, vec3f(0, 0, 0), &start->light);
        if (start->light.pdf_w > 0) break;
    }
    start->flux_times_n = (float)(light_send_extent(world, start->emitter) / part);
    return start->light.pdf_w > 0;
}

bool photon_choose_start(const PhotonTargets *targets, const Path *path, PhotonStart *start)
{
    float u[3], more[2];
    double of_beams = targets->n_lamps > 0 ? BEAMS_PART : 0;
    sampler_2d(&path->sampler, DIM_PIXEL, u);
    double which = (double)sampler_3d(&path->sampler, DIM_LENS, more) * 0x1p-32;
    u[2] = more[0];
    start->turned = vec3f(0, 0, 0);
    bool of_beam = which < of_beams;
    if (!(of_beam ? start_at_lamp(targets, path, which / of_beams, u, more, start)
                  : start_at_box(targets, path, u, start)))
        return false;
    start->flux_times_n /= (float)(of_beam ? of_beams : 1 - of_beams);
    return start->flux_times_n > 0 && isfinite(start->flux_times_n);
}

/* Whether the operand's surface that the path starts on is its combination's. The list may have it on either side of that. */
static bool leaves_combination(Tracer *tracer, const Path *path, const PhotonStart *start)
{
    const CompiledScene *compiled = tracer->world->compiled;
    const uint32_t operand = compiled->hull_of_object[start->light.object];
    if (!path->ray.n_left) return true; /* it starts beside, in front of it */
    if (nest_list_reserve(&tracer->list, 1) != STATUS_OK) return false;
    nest_csg_pass(&compiled->csg, &tracer->list, operand, nest_csg_takes(&compiled->csg, operand));
    return !nest_csg_holds(&compiled->csg, nest_csg_tree(&compiled->csg, operand), &tracer->list) &&
           nest_csg_shows(&compiled->csg, &tracer->list, operand);
}

/* Puts the path's ray at the light, on its way to the start's point, and the hulls around the light into its list. */
bool photon_leave_light(Path *path, const PhotonStart *start)
{
    Tracer *tracer = path->tracer;
    const CompiledScene *compiled = tracer->world->compiled;
    Vec3f travel = vec3f_negate(start->light.direction);
    nest_list_empty(&tracer->list);
    if (!isfinite(start->light.distance)) {
        Box3 bounds = rtc_scene_bounds(compiled->rtc);
        double far = start->beyond;
        if (!box3_is_empty(bounds))
            far += vec3_length(vec3_sub(bounds.max, bounds.min)) +
                   vec3_length(vec3_sub(start->point, vec3_scale(vec3_add(bounds.min, bounds.max), 0.5)));
        path->ray = ray_make(vec3_along(start->point, far, vec3_from_f(start->light.direction)), travel);
    } else if (start->light.glow) {
        double time = path->ray.time;
        path->ray =
            ray_make(vec3_along(start->point, start->light.distance, vec3_from_f(start->light.direction)), travel);
        path->ray.time = time;
    } else {
        bool turned = vec3f_dot(start->turned, start->turned) > 0;
        Ray look = ray_make(start->point, turned ? start->turned : start->light.direction);
        look.time = path->ray.time;
        look.t_max = start->light.distance * (1 + 1e-4);
        const bool cut = start->light.slack > 0;
        if (!rtc_all(compiled->rtc, &look, false, &tracer->left)) return false;
        const uint32_t object = light_sample_object(tracer->world, &start->light);
        size_t i = 0, one = 1;
        while (i < tracer->left.n && (cut ? !light_is_met(tracer->world, &start->light, &tracer->left.items[i])
                                          : tracer->left.items[i].object != object))
            i++;
        if (i == tracer->left.n) return false;
        double time = path->ray.time, distance = tracer->left.items[i].t;
        rtc_leave(compiled->rtc, &look, &tracer->left.items[i], &one, false, travel, &path->ray);
        path->ray.time = time;
        if (turned) { /* beside the light's point, so that it goes to the start's */
            path->ray =
                ray_make(vec3_along(start->point, 0.94 * distance, vec3_from_f(start->light.direction)), travel);
            path->ray.time = time;
        }
    }
    if ((isfinite(start->light.distance) || compiled->n_planes) &&
        compiled_interior(compiled, vec3f_from(path->ray.origin), path->ray.time, &tracer->shadow_hits, &tracer->list,
                          NULL) != STATUS_OK)
        return false;
    if (start->light.slack > 0 && !leaves_combination(tracer, path, start)) return false;
    return !start->light.glow ||
           media_is_there(compiled, &tracer->world->media, start->light.glow->place, &tracer->list);
}

/* slab_lamp.c - see slab_lamp.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/slab_lamp.h"

#include "optics/fresnel.h"
#include "optics/sampling.h"
#include "trace/beams.h"
#include "trace/probe.h"
#include "trace/slab_faces.h"

/* A way by more faces than these is not looked for to and fro. */
enum { MOST_PAIRED = 8 };
/* How often light to and fro is looked for: it is a part of R^2, a 500th, of what comes straight. */
static const float looked_again = 0.125f;
/* How often one is sent past what is opaque in its straight way. */
static const float looked_past = 0.125f;

/* ---- the faces ---- */

/* The same past what stands in the straight way, as the light's own may well be free: always to a lamp that is not found otherwise,
 * and to others where light is bent much, by the part of the looks that *often becomes. u: in [0, 1). */
static bool find_faces_past(Path *look, bool delta, float u, FaceWay *way, float *often)
{
    Tracer *tracer = look->tracer;
    NestList *list = &tracer->list, *begin = &tracer->began;
    *often = 1;
    if (delta) return slab_find_faces(look, true, way);
    if (nest_list_copy(begin, list) != STATUS_OK) tracer->out_of_memory = true;
    if (slab_find_faces(look, false, way)) return true;
    if (!way->blocked || !compiled_indices_differ(tracer->world->scene, nest_medium(begin), WORLD_MEDIUM)) return false;
    *often = looked_past;
    nest_list_swap(list, begin);
    return u < looked_past && slab_find_faces(look, true, way);
}

static bool are_parallel(const FlatFace *a, const FlatFace *b)
{
    return fabs(vec3_dot(a->normal, b->normal)) > 1 - 1e-6;
}

/* Pairs of faces that light may go to and fro between. */
static uint32_t count_pairs(const FaceWay *way)
{
    uint32_t n = 0;
    for (uint32_t j = 1; j < way->n && way->n <= MOST_PAIRED; j++)
        for (uint32_t i = 0; i < j; i++) n += are_parallel(&way->faces[i], &way->faces[j]);
    return n;
}

static void add_step(const FaceWay *of, uint32_t i, bool mirrored, bool back, FaceWay *way)
{
    FlatFace *face = &way->faces[way->n];
    *face = of->faces[i];
    face->mirrored = mirrored;
    if (back) face->eta = 1 / face->eta;
    way->numbers[way->n++] = of->numbers[i];
}

/* The way that is mirrored at the second of such a pair, and then at the first. */
static void go_to_and_fro(const FaceWay *straight, uint32_t pair, FaceWay *way)
{
    uint32_t first = 0, second = 1, i;
    for (uint32_t left = pair;; first++) {
        if (first == second) first = 0, second++;
        if (are_parallel(&straight->faces[first], &straight->faces[second]) && !left--) break;
    }
    way->n = 0;
    way->leaving = straight->leaving;
    way->disperses = straight->disperses;
    for (i = 0; i < second; i++) add_step(straight, i, false, false, way);
    add_step(straight, second, true, false, way);
    for (i = second - 1; i > first; i--) add_step(straight, i, false, true, way);
    add_step(straight, first, true, true, way);
    for (i = first + 1; i < straight->n; i++) add_step(straight, i, false, false, way);
}

/* Whether each wavelength leaves by another way, and not just a little beside the others. */
static bool parts_colors(const FaceWay *way, Vec3 direction, const FlatRay *ray)
{
    return way->disperses && vec3_length(vec3_sub(ray->direction, direction)) > 1e-4;
}

/* The faces of a beam's way, from a place on it to the lamp, by the look's indices. */
static void take_route(Path *look, const BeamWay *beam, FaceWay *way)
{
    const BeamRoute *route = &beam->route;
    const Affine *lamp = &light_of_emitter(look->tracer->world, beam->emitter)->to_world;
    way->n = 0;
    way->disperses = way->blocked = way->past = false;
    way->leaving = vec3_scale(vec3_normalize(affine_vector(lamp, vec3(0, 1, 0))), -1);
    for (uint32_t i = route->n; i-- > 0;) {
        const BeamFace *face = &route->faces[i];
        Lanes in_front = path_ior(look, face->medium_behind), behind = path_ior(look, face->medium_before);
        way->faces[way->n] = (FlatFace){.normal = face->normal,
                                        .offset = face->offset,
                                        .eta = (double)lanes_get(in_front, 0) / (double)lanes_get(behind, 0),
                                        .mirrored = face->mirrored};
        way->numbers[way->n++] = face->number;
        way->disperses |= !lanes_uniform(in_front) || !lanes_uniform(behind);
    }
}

/* The direction in which light comes by the faces of a way from one place to another. */
static bool find_direction(const FaceWay *way, Vec3 from, Vec3 to, Vec3 *direction, FlatRay *bent)
{
    const Vec3 *leaving = vec3_dot(way->leaving, way->leaving) > 0 ? &way->leaving : NULL;
    return flat_way_find(way->faces, way->n, from, to, leaving, direction, bent);
}

/* Whether a look is from no surface; normal: as LightQuery's. */
static bool is_in_air(Vec3f normal)
{
    return vec3f_dot(normal, normal) == 0;
}

/* ---- densities ---- */

/* Whether a path that has found a lamp by chance knows what look would have found it: that starts again where the path met the first
 * face, in the hulls that hold the place. Where the hull entered last is on top, which of them is depends on the way to there. */
static bool knows_looks(const World *world)
{
    return world->compiled->order.policy != NEST_ENTERED;
}

/* The object of a lamp that is a ball, which does not hide the places behind it from looks; RTC_NO_OBJECT: it is none. */
static uint32_t ball_of(const World *world, uint32_t emitter)
{
    const SceneLight *light = light_of_emitter(world, emitter);
    return light && light->kind == LIGHT_SPHERE ? light->object : RTC_NO_OBJECT;
}

/* Of a lamp's place that a ray has come to by faces, per steradian of directions from where it began: by looks that choose it
 * straight. */
static float straight_density(const World *world, const LightRival *look, const Ray *ray, const Hit *hit,
                              const FlatRay *bent)
{
    const Vec3 from = look->from, place = ray_point(ray, hit->t), to = vec3_sub(place, from);
    double distance = vec3_length(to);
    Ray straight = ray_make(from, vec3f_from(vec3_scale(to, 1 / distance)));
    Hit seen = *hit;
    seen.t = distance;
    seen.cos_normal = vec3_dot(vec3_from_f(hit->normal), to) / distance;
    straight.time = ray->time;
    if (!slab_is_in_front(look->normal, straight.direction) || (seen.cos_normal < 0) != hit->entering) return 0;
    double pdf_w = (double)light_pdf_hit(world, look->choices, from, look->normal, &straight, &seen);
    double spread = flat_ray_spread(bent, place) / (distance * distance);
    return (float)(pdf_w * spread * fabs(seen.cos_normal / hit->cos_normal));
}

/* The same by looks at beams. */
static float beam_density(const World *world, const LightRival *look, const Ray *ray, const Hit *hit,
                          const FlatRay *bent)
{
    uint32_t emitter = emitter_of_hit(&world->emitters, hit);
    if (!(look->choices->near > 0) || !beams_have(world, emitter)) return 0;
    Vec3 place = ray_point(ray, hit->t);
    double spread = flat_ray_spread(bent, place);
    return (float)(beams_density(world, look->from, is_in_air(look->normal), emitter, place, ray->time) * spread /
                   fabs(hit->cos_normal));
}

/* That of both together. Balls are looked at in both ways where straight looks are few, too: by these alone, what is seen at its rim
 * straight, and in its midst by the bent way, would count without limit. */
static float density_of_both(const World *world, const LightRival *look, const Ray *ray, const Hit *hit,
                             const FlatRay *bent)
{
    float straight = straight_density(world, look, ray, hit, bent);
    if (straight > 0 && ball_of(world, emitter_of_hit(&world->emitters, hit)) == RTC_NO_OBJECT) return straight;
    return straight + beam_density(world, look, ray, hit, bent);
}

/* The faces by which a look towards a lamp would find a way through slabs that was gone, and how often; false: it would not. from: on
 * that way, in front of the first of them. */
static bool finds_way(const Path *path, Vec3 from, uint32_t emitter, Vec3 to, Vec3f lamp_normal, FaceWay *way,
                      float *often)
{
    const World *world = path->tracer->world;
    const SlabWay *gone = &path->slab_way;
    bool one_pair = gone->n_mirrored == 2 && gone->to_and_fro;
    Tracer *looker = gone->n_mirrored && !one_pair ? NULL : tracer_lend(path->tracer);
    if (!looker) return false;
    Path look;
    const Vec3 near = vec3_rounded(from);
    const double distance = vec3_length(vec3_sub(to, near));
    const Vec3f direction = vec3f_from(vec3_normalize(vec3_sub(to, near)));
    double cosine = fabs((double)vec3f_dot(direction, lamp_normal));
    bool found = slabs_are_on_way(&world->slabs, near, direction, distance) &&
                 slab_start_beside(path, looker, from, direction, &look);
    if (found) {
        look.ray.t_max = distance - light_short_of(distance, cosine, to);
        look.ray.target = ball_of(world, emitter);
        found = find_faces_past(&look, false, 0, way, often);
    }
    tracer_take_back(path->tracer);
    if (!found || !one_pair) return found && slab_steps_of(way) == gone->steps;
    const FaceWay straight = *way;
    uint32_t n_pairs = count_pairs(&straight);
    *often *= looked_again / (float)n_pairs;
    for (uint32_t pair = 0; pair < n_pairs; pair++) {
        go_to_and_fro(&straight, pair, way);
        if (slab_steps_of(way) == gone->steps) return true;
    }
    return false;
}

/* Whether a way leads to a lamp's place in the direction that the path has gone. */
static bool is_gone(const Path *path, const FaceWay *way, Vec3 to, FlatRay *bent)
{
    const double same = 1e-3;
    Vec3 direction;
    return find_direction(way, path->scatter_point, to, &direction, bent) &&
           vec3_length(vec3_sub(direction, vec3_from_f(path->slab_way.direction))) <= same &&
           (path->index_lane >= 0 || !parts_colors(way, direction, bent));
}

/* As slab_lamp_density, of a path by a way by whose route looks go. */
static float density_by_route(Path *path, const BeamWay *beam, const Hit *hit)
{
    const World *world = path->tracer->world;
    const Vec3 from = path->scatter_point, to = ray_point(&path->ray, hit->t);
    if (!(path->scatter_lights->near > 0)) return 0;
    Path look;
    FaceWay way;
    FlatRay bent;
    slab_begin_look(path, path->tracer, path->index_lane, &look);
    take_route(&look, beam, &way);
    if (!is_gone(path, &way, to, &bent)) return 0;
    double pdf = beams_density_by_route(world, from, is_in_air(path->scatter_normal), beam, to, path->ray.time);
    return (float)(pdf * flat_ray_spread(&bent, to) / fabs(hit->cos_normal));
}

float slab_lamp_density(Path *path, const Hit *hit)
{
    const World *world = path->tracer->world;
    const SlabWay *gone = &path->slab_way;
    uint32_t emitter = emitter_of_hit(&world->emitters, hit);
    if (!slab_way_has_rival(path) || !knows_looks(world) || emitter == EMITTER_NONE ||
        world->emitters.emitters[emitter].cut)
        return 0;
    Vec3 from = path->scatter_point, to = ray_point(&path->ray, hit->t);
    const BeamWay *beam = beams_find_route(world, from, is_in_air(path->scatter_normal), emitter, gone->steps);
    if (beam) return density_by_route(path, beam, hit);
    FaceWay way;
    float often;
    FlatRay bent;
    if (!finds_way(path, slab_right_beside(from, gone->first_face), emitter, to, hit->normal, &way, &often) ||
        !is_gone(path, &way, to, &bent))
        return 0;
    const LightRival look = {path->scatter_lights, from, path->scatter_normal, -1};
    return often * density_of_both(world, &look, &path->ray, hit, &bent);
}

bool slab_lamp_is_looked_at(const Path *photon, uint32_t emitter, const Ray *begin, Vec3 place)
{
    FaceWay way;
    float often;
    const World *world = photon->tracer->world;
    uint32_t medium = nest_medium(&photon->tracer->list);
    if (!(world_lights_through(world, medium)->near > 0) || !knows_looks(world) || emitter == EMITTER_NONE ||
        world->emitters.emitters[emitter].cut)
        return false;
    const BeamWay *beam = beams_find_route(world, place, false, emitter, photon->slab_way.steps);
    if (beam) return !beam->fans_out;
    return finds_way(photon, slab_right_beside(place, photon->ray.origin), emitter, begin->origin, begin->direction,
                     &way, &often) &&
           !way.past;
}

float slab_weigh_lamp(Path *path, const Hit *hit, float radiance)
{
    float looked = slab_lamp_density(path, hit), weight = 1;
    if (!(looked > 0)) return path_found_part(path, radiance);
    const SlabWay *way = &path->slab_way;
    const float pdf_w = path->scatter_pdf;
    const bool bent = path->probing.bent;
    path->scatter_pdf = way->scatter_pdf;
    path->probing.bent = way->bent;
    if (way->scatter_pdf >= 0) weight = sampling_balance(way->scatter_pdf, looked);
    weight *= path_found_part(path, radiance);
    path->scatter_pdf = pdf_w; /* what shines may go on scattering */
    path->probing.bent = bent;
    return weight;
}

/* ---- looks ---- */

typedef struct LampLook {
    Path *path;
    const LookPlace *from;
    Path look;
    int index_lane;
    float often;         /* such a look is sent at all */
    bool at_beam;        /* counts where no look that goes straight chooses the place */
    const BeamWay *beam; /* NULL, or by whose route it goes; often and at_beam do not count then */
} LampLook;

static bool start(LampLook *l, Vec3f direction)
{
    return slab_start_look(l->path, l->from, l->index_lane, direction, &l->look);
}

/* On from the last face to a lamp that has a surface. */
static bool follow_to_surface(Path *look, uint32_t emitter, Event *event)
{
    const World *world = look->tracer->world;
    for (; slab_look_goes_on(look, event) && event->kind == EVENT_OPAQUE; look->bounce++) {
        if (emitter_of_hit(&world->emitters, &event->hit) == emitter) return true;
        if (look->n_counted++ >= world->max_bounces || !slab_cross_pane(look, event)) return false;
    }
    return false;
}

/* Whether the place of a lamp that a look went to is the one that it has met: one that faces the look's straight way may lie behind
 * others by the bent way, which looks find as well that go there. */
static bool has_met(const LampLook *l, uint32_t emitter, const Ray *ray, const Hit *hit, Vec3 place)
{
    const World *world = l->path->tracer->world;
    double behind = fabs(vec3_dot(vec3_sub(place, ray_point(ray, hit->t)), vec3_from_f(ray->direction)));
    if (ball_of(world, emitter) == RTC_NO_OBJECT)
        return behind < 1e-4 * vec3_length(vec3_sub(place, l->from->place->position));
    return behind < light_of_emitter(world, emitter)->half_width * fabs(hit->cos_normal);
}

/* What comes from a place of a lamp with a surface; pdf_w: its density. */
static bool see_surface(const LampLook *l, uint32_t emitter, Vec3 place, const FlatRay *bent, float *pdf_w,
                        Lanes *arrives)
{
    const World *world = l->path->tracer->world;
    Path look = l->look;
    Event event;
    Lanes radiance;
    if (!follow_to_surface(&look, emitter, &event) || !has_met(l, emitter, &look.ray, &event.hit, place) ||
        !light_radiance_hit(world, &look.ray, &event.hit, 0, look.wavelengths.nm, &radiance))
        return false;
    uint32_t medium = nest_medium(&look.tracer->list);
    *arrives = lanes_mul(look.beta, path_basic_radiance(world, radiance, medium, look.wavelengths.nm));
    if (l->beam) {
        Vec3 from = l->from->place->position, met = ray_point(&look.ray, event.hit.t);
        double pdf = beams_density_by_route(world, from, is_in_air(l->from->normal), l->beam, met, look.ray.time);
        *pdf_w = (float)(pdf * flat_ray_spread(bent, met) / fabs(event.hit.cos_normal));
        return *pdf_w > 0;
    }
    const LightRival from = {l->from->choices, l->from->place->position, l->from->normal, -1};
    float straight = straight_density(world, &from, &look.ray, &event.hit, bent);
    bool counts = ball_of(world, emitter) != RTC_NO_OBJECT || (straight > 0) != l->at_beam;
    *pdf_w = counts ? l->often * density_of_both(world, &from, &look.ray, &event.hit, bent) : 0;
    return *pdf_w > 0;
}

/* What comes from one without size, as if through a steradian. */
static bool see_point(const LampLook *l, const LightSample *light, Vec3 place, const FlatRay *bent, Lanes *arrives)
{
    const World *world = l->path->tracer->world;
    Path look = l->look;
    const LightQuery query = {.from = look.ray.origin, .time = look.ray.time, .wavelength_nm = look.wavelengths.nm};
    LightSample last;
    Lanes transmittance;
    uint32_t medium;
    light_sample_emitter(world, light->emitter, &query, &last);
    look.ray.t_max = last.distance;
    if (!(last.pdf_w > 0) || !path_shadow(&look, &look.ray, &transmittance, &medium)) return false;
    Vec3 to = vec3_sub(place, look.ray.origin);
    float nearer = (float)(vec3_dot(to, to) / flat_ray_spread(bent, place));
    Lanes radiance = path_basic_radiance(world, lanes_scale(last.radiance, nearer), medium, look.wavelengths.nm);
    *arrives = lanes_mul(lanes_mul(look.beta, transmittance), radiance);
    return true;
}

/* A look by the faces of a way at the place of a light, which becomes one in its direction; false: nothing comes by there. */
static bool look_by(LampLook *l, const FaceWay *way, Vec3 place, LightSample *light, Lanes *arrives)
{
    Vec3 direction;
    FlatRay bent;
    if (!find_direction(way, l->from->place->position, place, &direction, &bent)) return false;
    light->direction = vec3f_from(direction);
    if (!slab_is_in_front(l->from->normal, light->direction) || !start(l, light->direction) ||
        !slab_follow_faces(&l->look, way))
        return false;
    light->arrives = arrives;
    return light->delta ? see_point(l, light, place, &bent, arrives)
                        : see_surface(l, light->emitter, place, &bent, &light->pdf_w, arrives);
}

static bool find_straight(LampLook *l, const LightSample *light, FaceWay *way)
{
    if (!start(l, light->direction)) return false;
    l->look.ray.t_max = light->distance;
    l->look.ray.target = light->object;
    l->look.ray.target_primitive = light->primitive;
    float u = sampler_1d(&l->path->sampler, sampler_dimension(l->look.bounce, DIM_ROULETTE));
    return find_faces_past(&l->look, light->delta, u, way, &l->often);
}

/* Those that are known of a beam's way, or in the straight line. */
static bool find_route(LampLook *l, const LightSample *light, FaceWay *way)
{
    if (LIKELY(!l->beam)) return find_straight(l, light, way);
    slab_begin_look(l->path, l->path->tracer->looker, l->index_lane, &l->look);
    take_route(&l->look, l->beam, way);
    return true;
}

/* The faces up to the light. Where each wavelength would come another way, and the path does not know yet by whose indices it goes,
 * its sample's second path is to begin before. */
static bool find_way(LampLook *l, const LightSample *light, Vec3 place, FaceWay *way)
{
    Path *path = l->path;
    Vec3 direction;
    FlatRay bent;
    l->index_lane = path->bent_apart ? path->index_lane : -1;
    if (!find_route(l, light, way)) return false;
    if (!way->disperses) return true;
    /* by the index of one wavelength there may be no way, and by that of another one there may */
    if (find_direction(way, l->from->place->position, place, &direction, &bent) && !parts_colors(way, direction, &bent))
        return true;
    if (path->index_lane < 0) return false;
    path->bent_apart = true;
    l->index_lane = path->index_lane;
    return find_route(l, light, way);
}

/* What comes to and fro between two of a way's faces. */
static void look_again(LampLook *l, const FaceWay *way, Vec3 place, LightLooks *looks)
{
    const Sampler *sampler = &l->path->sampler;
    LightSample *light = &looks->lights[looks->n];
    uint32_t n_pairs = count_pairs(way);
    float u = sampler_1d(sampler, sampler_dimension(l->look.bounce, DIM_LOBE)) / looked_again;
    if (!n_pairs || u >= 1) return;
    FaceWay again;
    go_to_and_fro(way, (uint32_t)(u * (float)n_pairs), &again);
    float chosen = looked_again / (float)n_pairs;
    if (!look_by(l, &again, place, light, &looks->arrives[looks->n])) return;
    light->pdf_w *= chosen;
    looks->n++;
}

/* What a light's direction leads to. Not where looks for what hides it end: from there, a little in front of the lamp, bent ways went
 * past its rim, and a small ball lost up to a tenth of its light. */
static Vec3 place_of(const Path *path, Vec3 from, const LightSample *light)
{
    const float any[2] = {0};
    if (light->delta) return light_pivot(path->tracer->world, light->emitter, path->ray.time, 0, any).place;
    return vec3_along(from, light->distance + light->short_of, vec3_from_f(light->direction));
}

/* The look is set field by field: most of it is set later. False when memory ends. */
static bool begin_look(Path *path, const LookPlace *from, bool at_beam, LampLook *look)
{
    look->path = path;
    look->from = from;
    look->at_beam = at_beam;
    look->beam = NULL;
    return tracer_lend(path->tracer) != NULL;
}

/* Whether looks by the route of a beam's way find all that comes by these faces, so that none that went straight is to. */
static bool is_left_to_route(const LampLook *l, const LightSample *light, const FaceWay *way)
{
    const World *world = l->path->tracer->world;
    return UNLIKELY(world->n_beam_ways) && beams_find_route(world, l->from->place->position, is_in_air(l->from->normal),
                                                            light->emitter, slab_steps_of(way)) != NULL;
}

static void look_straight(Path *path, const LookPlace *from, LightLooks *looks)
{
    LightSample *light = &looks->lights[0];
    const Vec3 position = from->place->position;
    if (!(light->pdf_w > 0) || light->glow || light->slack > 0 || !(light->delta || knows_looks(path->tracer->world)) ||
        !isfinite(light->distance) ||
        !slabs_are_on_way(&path->tracer->world->slabs, position, light->direction, light->distance))
        return;
    const Vec3 place = place_of(path, position, light);
    LampLook look;
    FaceWay way;
    if (!begin_look(path, from, false, &look)) return;
    bool found = slab_is_in_front(from->normal, light->direction) && find_way(&look, light, place, &way);
    if (!found) light->pdf_w = 0; /* nor is it seen straight */
    if (found && way.n) {
        looks->lights[1] = *light;
        if (is_left_to_route(&look, light, &way) || !look_by(&look, &way, place, light, &looks->arrives[0]))
            light->pdf_w = 0;
        look_again(&look, &way, place, looks);
    }
    tracer_take_back(path->tracer);
}

/* Whether a look at a place of a beam, in that direction if it went straight, goes by faces where the beam does not shine straight. */
static bool is_bent(const Path *path, const LookPlace *from, uint32_t emitter, Vec3 place, Vec3f direction,
                    double distance)
{
    const World *world = path->tracer->world;
    const Vec3 position = from->place->position;
    if (!slabs_are_on_way(&world->slabs, position, direction, distance) || !slab_is_in_front(from->normal, direction))
        return false;
    return ball_of(world, emitter) != RTC_NO_OBJECT ||
           !(light_shines_at(world, emitter, path->ray.time, place, position) &&
             light_choice(world, from->choices, emitter, position, from->normal) > 0); /* it is chosen straight */
}

/* What comes from one of the beams to where it does not shine straight, or from a ball, or by the route of a way. */
static void look_at_beam(Path *path, const LookPlace *from, LightLooks *looks)
{
    const World *world = path->tracer->world;
    const Vec3 position = from->place->position;
    const bool in_air = is_in_air(from->normal);
    LightSample *light = &looks->lights[looks->n];
    float u[2];
    BeamPlace at;
    uint32_t digits = sampler_3d(&path->sampler, DIM_BEAMS + 3 * path->bounce, u);
    uint32_t emitter = beams_sample(world, position, in_air, path->ray.time, digits, u, &at);
    if (emitter == EMITTER_NONE) return;
    const Vec3 to = vec3_sub(at.place, position);
    const double distance = vec3_length(to), time = path->ray.time;
    const Vec3f direction = vec3f_from(vec3_scale(to, 1 / distance));
    if (!at.way && !is_bent(path, from, emitter, at.place, direction, distance)) return;
    const bool has_area = at.area > 0;
    if (has_area && !knows_looks(world)) return;
    /* of what has an area the density is that of where the look comes to */
    double density = has_area ? 0
                     : at.way ? beams_density_by_route(world, position, in_air, at.way, at.place, time)
                              : beams_density(world, position, in_air, emitter, at.place, time);
    *light = (LightSample){.direction = direction,
                           .distance = distance - light_short_of(distance, 1, at.place),
                           .object = has_area ? light_of_emitter(world, emitter)->object : RTC_NO_OBJECT,
                           .primitive = RTC_NO_OBJECT,
                           .emitter = emitter,
                           .delta = !has_area,
                           .pdf_w = (float)density};
    LampLook look;
    FaceWay way;
    if (!begin_look(path, from, true, &look)) return;
    look.beam = at.way;
    if (find_way(&look, light, at.place, &way) && way.n > 0) {
        const LightSample again = *light;
        looks->n += (at.way || !is_left_to_route(&look, light, &way)) &&
                    look_by(&look, &way, at.place, light, &looks->arrives[looks->n]);
        looks->lights[looks->n] = again;
        if (!at.way) look_again(&look, &way, at.place, looks);
    }
    tracer_take_back(path->tracer);
}

void slab_look_at_lamp(Path *path, const LookPlace *from, LightLooks *looks)
{
    look_straight(path, from, looks);
    if (UNLIKELY(path->tracer->world->n_beams + path->tracer->world->n_balls) && from->choices->near > 0)
        look_at_beam(path, from, looks);
}

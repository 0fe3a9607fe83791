/* shade.c - what happens to a path at a surface, a boundary, or a place within a medium.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/shade.h"

#include "optics/fresnel.h"
#include "trace/crystal_cross.h"
#include "optics/sampling.h"
#include "scene/ties.h"
#include "trace/airlight.h"
#include "trace/beam_ways.h"
#include "trace/backdrop.h"
#include "trace/catcher.h"
#include "trace/event.h"
#include "trace/probe.h"
#include "trace/shade_bsdf.h"
#include "trace/shaft.h"
#include "trace/slab_lamp.h"
#include "trace/slab_sky.h"
#include "trace/texture_shade.h"

Lanes path_basic_radiance(const World *world, Lanes radiance, uint32_t medium, Lanes wavelength_nm)
{
    Lanes ior = medium_ior(world, medium, wavelength_nm);
    return lanes_div(radiance, lanes_mul(ior, ior));
}

Lanes path_add_radiance(Path *path, Lanes factor, Lanes basic)
{
    float mean_ratio = lanes_mean(path->ratio);
    Lanes more = lanes_scale(lanes_mul(lanes_mul(path->beta, factor), basic), 1 / mean_ratio);
    path_add_found(path, more);
    return more;
}

static float mix_weight(const Path *path, const Event *event, const SceneSurface *surface)
{
    return texture_mix_weight(path->tracer->world, surface, &path->ray, &event->hit, path_footprint(path, true));
}

ATTR_APART const SceneSurface *path_surface_of_mix(const Path *path, const Event *event, const SceneSurface *surface)
{
    const SceneSurface *surfaces = path->tracer->world->scene->surfaces;
    float u = sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_MIX));
    while (surface->mixed) {
        float weight = mix_weight(path, event, surface);
        bool second = u < weight;
        u = float_min(second ? u / weight : (u - weight) / (1 - weight), 0x1.fffffep-1f);
        surface = &surfaces[surface->mix[second]];
    }
    return surface;
}

void path_albedos(const Path *path, const Event *event, const SceneSurface *surface,
                  const Lanes wavelength_nm[COLOR_FOURS], Lanes albedo[COLOR_FOURS])
{
    if (surface->mixed) {
        const SceneSurface *surfaces = path->tracer->world->scene->surfaces;
        Lanes second[COLOR_FOURS];
        path_albedos(path, event, &surfaces[surface->mix[0]], wavelength_nm, albedo);
        path_albedos(path, event, &surfaces[surface->mix[1]], wavelength_nm, second);
        float weight = mix_weight(path, event, surface);
        for (int i = 0; i < COLOR_FOURS; i++)
            albedo[i] = lanes_add(lanes_scale(albedo[i], 1 - weight), lanes_scale(second[i], weight));
    } else if (surface->n_textures) {
        path_read_albedos(path, event, surface, wavelength_nm, albedo);
    } else {
        for (int i = 0; i < COLOR_FOURS; i++) albedo[i] = spectrum_at(&surface->albedo, wavelength_nm[i]);
        bsdf_mix_metal(&surface->spec, wavelength_nm, COLOR_FOURS, albedo);
    }
}

/* A ray that creeps along a rippled surface meets it several times at one place. It leaves the first of them (through: the last),
 * whose plane is not quite that of the one by which the direction was chosen: where that would lead to the wrong side, it is
 * mirrored at the plane, by less than the ripples' slope. */
ATTR_COLD static Vec3f keep_to_side(const Tracer *tracer, const Event *event, bool through, Vec3f direction)
{
    const Hit *hits = tracer->hits.items, *start = &event->hit;
    for (size_t i = 0; i < event->n_cluster; i++) {
        const Hit *hit = &hits[through ? event->n_cluster - 1 - i : i];
        if (hit->object != event->hit.object) continue;
        start = hit;
        break;
    }
    float slope = vec3f_dot(direction, start->normal);
    if (start->entering != event->hit.entering || (slope > 0) == (start->entering != through)) return direction;
    return vec3f_normalize(reflect_direction(direction, start->normal));
}

/* Which of the surfaces a ray starts on is up to the side that it goes to: all are left for the path, which may go to the other. */
void path_start_ray_of_several(const Path *path, const Event *event, bool through, Vec3f direction, Ray *next)
{
    Tracer *tracer = path->tracer;
    bool copied = hit_list_copy(&tracer->looked, tracer->hits.items, event->n_cluster);
    size_t n = copied ? event->n_cluster : 1;
    if (!copied) tracer->out_of_memory = true;
    rtc_leave(tracer->world->compiled->rtc, &path->ray, copied ? tracer->looked.items : tracer->hits.items, &n, through,
              direction, next);
}

void path_leave(Path *path, Event *event, const SurfacePlace *place, bool through, Vec3f direction)
{
    Tracer *tracer = path->tracer;
    path->wave = CRYSTAL_UNPOLARIZED;
    if (UNLIKELY(place->apart)) {
        path_start_ray(path, event, place, through, direction, &path->ray);
        return;
    }
    if (UNLIKELY(event->n_cluster > 1)) direction = keep_to_side(tracer, event, through, direction);
    HitList reached = tracer->hits;
    Ray *ray = &path->ray;
    const bool several = event->n_cluster > 1;
    rtc_leave(tracer->world->compiled->rtc, ray, reached.items, &event->n_cluster, through, direction, ray);
    tracer->hits = tracer->left; /* the ray refers to what it has left until its end */
    tracer->left = reached;
    if (several && !path_cross_towards(tracer, &path->ray, &tracer->next)) tracer->out_of_memory = true;
    if (several)
        nest_list_swap(&tracer->list, &tracer->next);
    else if (through)
        path_go_behind(tracer, event);
}

/* A number in [0, 1) to choose a light by, and two for the place on it; each light gets evenly spread places. Further digits than
 * are evenly spread are for a tree of many lights. Measured, squared error of a typical pixel over that with a number of
 * its own, after 32 samples, lobes of surfaces likewise: 0.82 (still-life), 0.83 (surfaces), 0.87 (finishes), 0.97 (candles). */
static double choice_of_light(const Path *path, float u[2])
{
    uint32_t apart = sampler_dimension(path->bounce, DIM_LIGHT_CHOICE);
    uint32_t digits = sampler_3d(&path->sampler, sampler_dimension(path->bounce, DIM_LIGHT), u);
    if (UNLIKELY(path->tracer->world->trial.choices_apart)) digits = sampler_digits(&path->sampler, apart);
    return (double)((uint64_t)digits << 20 | sampler_key(&path->sampler, apart) >> 12) * 0x1p-52;
}

void path_choose_light(const Path *path, const LightChoices *choices, Vec3 from, Vec3f normal, LightSample *light)
{
    if (!choices->n) {
        *light = (LightSample){.pdf_w = 0};
        return;
    }
    LightQuery query = {.from = from, .normal = normal, .time = path->ray.time, .wavelength_nm = path->wavelengths.nm};
    if (choices->one)
        sampler_2d(&path->sampler, sampler_dimension(path->bounce, DIM_LIGHT), query.u);
    else
        query.rest = choice_of_light(path, query.u);
    light_sample(path->tracer->world, choices, &query, light);
}

void path_look_at_light(Path *path, const LookPlace *from, LightLooks *looks)
{
    path_choose_light(path, from->choices, from->place->position, from->normal, &looks->lights[0]);
    looks->n = 1;
    if (LIKELY(!path->tracer->world->slabs.n)) return;
    slab_look_at_sky(path, from, looks);
    slab_look_at_lamp(path, from, looks);
}

static bool sees(Path *path, Ray *ray, Lanes *transmittance, uint32_t *medium_at_light)
{
    if (path_shadow(path, ray, transmittance, medium_at_light)) return true;
    *medium_at_light = WORLD_MEDIUM;
    return UNLIKELY(path->tracer->world->slabs.n) && isinf(ray->t_max) && slab_shadow(path, ray, transmittance);
}

bool path_sees_light(Path *path, const LightSample *light, Ray *ray, Lanes *transmittance, uint32_t *medium_at_light)
{
    if (UNLIKELY(light->slack > 0)) return path_meets(path, light, ray, transmittance, medium_at_light);
    ray->t_max = light->distance;
    ray->target = light->object;
    ray->target_primitive = light->primitive;
    return sees(path, ray, transmittance, medium_at_light);
}

/* Whether another lamp is met where a ray has looked for this one, see scene/ties.h. No direction finds this one there by chance, so it
 * must not be found by looking, either. */
ATTR_APART static bool has_yielded(Path *path, const LightSample *light, const Ray *looked)
{
    Tracer *tracer = path->tracer;
    const CompiledScene *compiled = tracer->world->compiled;
    uint32_t object = light_sample_object(tracer->world, light);
    if (object == RTC_NO_OBJECT || !tracer->world->yields[object]) return false;
    Ray ray = *looked;
    ray.t_min = light->distance;
    ray.t_max = 2.5 * light->distance; /* the look went half of the way at least */
    ray.target = RTC_NO_OBJECT;
    rtc_all(compiled->rtc, &ray, false, &tracer->shadow_hits);
    const Hit *hits = tracer->shadow_hits.items;
    for (size_t begin = 0, end, n = tracer->shadow_hits.n; begin < n; begin = end) {
        end = begin + rtc_cluster(hits + begin, n - begin);
        for (size_t i = begin; i < end; i++)
            if (hits[i].object == object) return ties_met(compiled, hits + begin, end - begin)->object != object;
    }
    return false;
}

bool path_light_arrives(Path *path, const LightSample *light, Ray *ray, Lanes *basic)
{
    const World *world = path->tracer->world;
    if (UNLIKELY(light->arrives)) {
        *basic = *light->arrives;
        return true;
    }
    if (UNLIKELY(world->own_compiled != NULL) && !catcher_world_has(world, light)) return false;
    Lanes transmittance;
    uint32_t medium;
    if (!path_sees_light(path, light, ray, &transmittance, &medium)) return false;
    if (UNLIKELY(light->glow) &&
        !media_is_there(world->compiled, &world->media, light->glow->place, &path->tracer->shadow_list))
        return false;
    if (UNLIKELY(world->yields) && has_yielded(path, light, ray)) return false;
    if (isinf(light->distance)) medium = WORLD_MEDIUM;
    Lanes radiance = light_sample_radiance(world, light, path->wavelengths.nm);
    *basic = lanes_mul(transmittance, path_basic_radiance(world, radiance, medium, path->wavelengths.nm));
    return true;
}

void path_add_direct_light(Path *path, const LightSample *light, Ray *ray, Lanes scattered, float pdf_w)
{
    const World *world = path->tracer->world;
    Lanes basic;
    if (!path_light_arrives(path, light, ray, &basic)) return;
    float others = light->delta ? 0 : pdf_w;
    if (LIKELY(!light->arrives)) others += airlight_rival_sample(path, light); /* which looks straight */
    float weight = sampling_balance(light->pdf_w, others);
    if (UNLIKELY(light->arrives && world->n_beam_ways)) weight /= 1 + beam_ways_rival(path);
    Lanes more = path_add_radiance(path, lanes_scale(scattered, weight / light->pdf_w), basic);
    if (UNLIKELY(path->tracer->grouped)) path_add_to_group(path, more, light_sample_group(world, light));
}

/* The density of a matte surface's directions. A lobe about the shading normal reaches below the surface; that part of it is
 * mirrored back, so that nothing leaks in and none of the light is lost. direction: above the surface. */
static float diffuse_pdf(const SurfacePlace *place, Vec3f direction)
{
    float cosine = float_max(vec3f_dot(direction, place->normal), 0);
    float folded = float_max(vec3f_dot(path_mirror(place, direction), place->normal), 0);
    return (cosine + folded) / SAMPLING_PI;
}

/* Light that a diffuse surface gets from a light source. */
static void add_light_diffuse(Path *path, const LookPlace *from, Lanes albedo, const LightSample *light)
{
    const SurfacePlace *place = from->place;
    if (!(light->pdf_w > 0) || !(vec3f_dot(light->direction, place->geometric) > 0)) return;
    float diffuse = diffuse_pdf(place, light->direction);
    if (!(diffuse > 0)) return;
    Ray ray;
    path_start_ray(path, from->event, place, false, light->direction, &ray);
    path_add_direct_light(path, light, &ray, lanes_scale(albedo, diffuse), diffuse);
}

static void light_diffuse(Path *path, const LookPlace *from, Lanes albedo)
{
    LightLooks looks;
    path_look_at_light(path, from, &looks);
    for (uint32_t i = 0; i < looks.n; i++) add_light_diffuse(path, from, albedo, &looks.lights[i]);
}

/* A direction chosen by the hero's density: others would have chosen it more often, or less. */
static void weigh_turn(Path *path, Lanes pdf_w)
{
    float hero = lanes_get(pdf_w, 0);
    Lanes factor = hero > 0 ? lanes_scale(pdf_w, 1 / hero) : lanes_all(0);
    path->beta = lanes_mul(path->beta, factor);
    path->ratio = lanes_mul(path->ratio, factor);
}

void path_scatter_in_medium(Path *path, const Event *event)
{
    const Phase *phase = &path->tracer->world->scene->media[event->medium].phase;
    Vec3 position = ray_point(&path->ray, event->t);
    Vec3f along = path->ray.direction;
    path->wave = CRYSTAL_UNPOLARIZED;
    path->scatter_point = position;
    path->scatter_normal = vec3f(0, 0, 0);
    path->from = path->way;
    path->scatter_lights = path_lights(path, false);
    const SurfacePlace place = {.position = position, .apart = true};
    LightLooks looks;
    const LookPlace from = {NULL, &place, path->scatter_lights, vec3f(0, 0, 0)};
    path_look_at_light(path, &from, &looks);
    for (uint32_t i = 0; i < looks.n; i++) {
        const LightSample *light = &looks.lights[i];
        if (!(light->pdf_w > 0)) continue;
        Lanes pdf = phase_evaluate(phase, along, light->direction, path->wavelengths.nm);
        Ray ray;
        ray_begin(&ray, position, light->direction);
        ray.time = path->ray.time;
        path_add_direct_light(path, light, &ray, pdf, path_phase_density(path, phase, pdf));
    }
    float u[2];
    double time = path->ray.time;
    sampler_2d(&path->sampler, sampler_dimension(path->bounce, DIM_SCATTER), u);
    GuideAt guide = path_guide(path, position, EVENT_SCATTER);
    guide.share += shaft_rival(path, &guide);
    Vec3f direction;
    if (UNLIKELY(path_ask_guide(path, &guide, &direction))) {
        Lanes pdf = phase_evaluate(phase, along, direction, path->wavelengths.nm);
        const ProbeWay way = {direction, false, pdf, path_phase_density(path, phase, pdf)};
        path_send_probe(path, &guide, &from, &way);
    }
    Lanes pdf;
    direction = phase_sample(phase, along, u, path->wavelengths.nm, &pdf);
    path->scatter_pdf = path_phase_density(path, phase, pdf);
    if (!phase_is_grey(phase)) weigh_turn(path, pdf);
    path_leave_guide(path, &guide, direction, path->scatter_pdf);
    ray_begin(&path->ray, position, direction);
    path->ray.time = time;
    path->n_scattered++;
}

/* With the shading normal as it is. */
static inline SurfacePlace unbent_place(const World *world, const Ray *ray, const Hit *hit)
{
    Vec3f shading = rtc_shading_normal(world->compiled->rtc, ray, hit);
    bool front = hit->entering;
    return (SurfacePlace){.position = ray_point(ray, hit->t),
                          .normal = front ? shading : vec3f_negate(shading),
                          .geometric = front ? hit->normal : vec3f_negate(hit->normal)};
}

static inline void bend_place(const Ray *ray, SurfacePlace *place)
{
    if (path_is_bent(place))
        place->normal = path_bend_normal(vec3f_negate(ray->direction), place->geometric, place->normal);
}

SurfacePlace path_place_of(const World *world, const Ray *ray, const Hit *hit)
{
    SurfacePlace place = unbent_place(world, ray, hit);
    bend_place(ray, &place);
    return place;
}

/* The curved surface that interpolated normals describe bulges over its facets. Where a facet is turned away from a lamp, or is
 * in the shadow of its neighbours, the curved surface may still be lit; by the facets its light would end in steps and notches. So
 * a surface that lets nothing through is shaded where it bulges, in front of the facet, and there its shading normal is the
 * geometric one. That place is as high as the bulge, but on the ray that has come to the facet instead of on the normal: whatever
 * stands between it and the facet, the path has come past, and the place's list of hulls is the path's own. What stands close to
 * the facet, a film of water, say, or a floor that the surface rests on, stays in front of the place, and is left most of the way:
 * what absorbs light there is to do so on its way out, too. False where the surface is flat or hollow, and where it turns its back
 * by that normal. */
static bool raise_place(const Path *path, const Event *event, SurfacePlace *place)
{
    /* where it comes in so far beside that the place would be above quite another one, in other shadows, it is lower */
    const double least_cosine = 0.05, usual_cosine = 0.2, of_way = 0.125;
    const Tracer *tracer = path->tracer;
    const HitList *hits = &tracer->hits, *passed = &tracer->passed;
    const Ray *ray = &path->ray;
    const Hit *hit = &event->hit;
    double cosine = -(double)vec3f_dot(ray->direction, place->normal);
    if (!(cosine > least_cosine)) return false;
    double height = rtc_bulge(tracer->world->compiled->rtc, ray, hit, place->normal);
    double crossed = passed->n ? double_max(ray->t_min, passed->items[passed->n - 1].t) : ray->t_min;
    double back = double_min(height / double_max(cosine, usual_cosine), of_way * (hit->t - crossed));
    double t = hit->t - back;
    if (!(back * cosine > hit->rounding && t < hits->items[0].t)) return false;
    place->position = ray_point(ray, t);
    place->geometric = place->normal;
    place->apart = true;
    return true;
}

/* Where an opaque surface is shaded. */
static SurfacePlace opaque_place(const Path *path, const Event *event, const SceneSurface *surface)
{
    SurfacePlace place = unbent_place(path->tracer->world, &path->ray, &event->hit);
    if (!event->hit.smooth) return place;
    if (surface->thin || surface->painted || !raise_place(path, event, &place)) bend_place(&path->ray, &place);
    return place;
}

void path_add_emission(Path *path, const Hit *hit)
{
    const World *world = path->tracer->world;
    Lanes radiance;
    /* what nothing else than the camera's ray finds: ways that are weighed against each other must find the same */
    bool alone = path->ray.sight && path->scatter_pdf < 0 && !path_is_in_slabs(path);
    double footprint = alone ? (double)path->cone_width : 0;
    if (!light_radiance_hit(world, &path->ray, hit, footprint, path->wavelengths.nm, &radiance)) return;
    float weight = 1; /* against finding it by light sampling */
    if (path->scatter_pdf >= 0) {
        float pdf =
            light_pdf_hit(world, path->scatter_lights, path->scatter_point, path->scatter_normal, &path->ray, hit);
        weight = sampling_balance(path->scatter_pdf, pdf + airlight_rival_hit(path, hit, pdf));
    }
    if (UNLIKELY(path_is_in_slabs(path)))
        weight = slab_weigh_lamp(path, hit, lanes_mean(radiance));
    else
        weight *= path_found_part(path, lanes_mean(radiance));
    uint32_t medium = nest_medium(&path->tracer->list);
    radiance = path_basic_radiance(world, radiance, medium, path->wavelengths.nm);
    Lanes more = path_add_radiance(path, lanes_all(weight), radiance);
    if (UNLIKELY(path->tracer->grouped)) path_add_to_group(path, more, light_hit_group(world, hit));
}

bool path_shade_opaque(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const ObjectLook *look = &world->looks[event->hit.object];
    path_add_emission(path, &event->hit);
    float rarity = path->from.rarity;
    path->from.rarity = 0;
    if (look->light != SCENE_NONE || look->surface == SCENE_NONE) return false;
    const SceneSurface *surface = path_surface(path, event, look->surface);
    SurfacePlace place = opaque_place(path, event, surface);
    BsdfSpec textured;
    const BsdfSpec *spec = path_spec_at(path, event, surface, &place, &textured);
    if (surface->finished) {
        bool straight = false, goes_on = path_shade_finished(path, event, surface, spec, &place, &straight);
        if (UNLIKELY(straight)) {
            path->from.rarity = rarity;
            slab_pass_pane(path);
        }
        return goes_on;
    }
    if (UNLIKELY(path->probing.is_probe)) return false;
    path->wave = CRYSTAL_UNPOLARIZED;
    Lanes albedo = spectrum_at(spec == &textured ? &spec->base_color : &surface->albedo, path->wavelengths.nm);
    path->scatter_lights = path_lights(path, event->n_cluster > 1);
    const LookPlace from = {event, &place, path->scatter_lights, place.geometric};
    if (LIKELY(!path->is_photon)) light_diffuse(path, &from, albedo);

    float u[2];
    sampler_2d(&path->sampler, sampler_dimension(path->bounce, DIM_SCATTER), u);
    Vec3f direction;
    GuideAt guide = path_guide(path, ray_point(&path->ray, event->hit.t), event->kind);
    if (UNLIKELY(path_ask_guide(path, &guide, &direction)) && vec3f_dot(direction, place.geometric) > 0) {
        float pdf_w = diffuse_pdf(&place, direction);
        path_send_probe(path, &guide, &from, &(ProbeWay){direction, false, lanes_scale(albedo, pdf_w), pdf_w});
    }
    direction = sampling_cosine_hemisphere(u[0], u[1], place.normal, &path->scatter_pdf);
    if (!(vec3f_dot(direction, place.geometric) > 0)) direction = path_mirror(&place, direction);
    path->scatter_pdf = diffuse_pdf(&place, direction);
    path_leave_guide(path, &guide, direction, path->scatter_pdf);
    path->beta = lanes_mul(path->beta, albedo);
    path->scatter_point = place.position;
    path->scatter_normal = place.geometric;
    path_leave(path, event, &place, false, direction);
    return path->scatter_pdf > 0;
}

/* Reflection or refraction about one normal, which is on the side that the ray comes from. One of them is chosen, reflection
 * as often as it reflects, but where a lamp lies in one of both directions: see beacons.h. So what lies in even light is
 * without noise. Measured, squared error after equal time over this way: without beacons 1.2 (peers' glass, whisky,
 * glass-of-water), 1.1 to 1.15 (cut-glass, cold-glass, tea, minirt), 1.3 (still-life), 1.5 (a glass under an image of a
 * studio). What the way without a lamp brings is seen on trial (backdrop.h): over taking it to be the mean of all directions, squared
 * error 0.62 after the same samples in a dark field (soap-bubbles), 1.00 to 1.01 elsewhere. The following were measured without
 * beacons: both ways followed at the first boundary 1.00 (whisky), 1.08 (glass-of-water), 0.95 (peers' glass); reflection more
 * often by 0.4 R (1 - R)^2 0.93, 0.93, 0.88 there and 0.97 (cold-glass, tea), but 1.03 to 1.04 where water is seen from below or
 * from both sides. */
typedef struct BoundaryChoice {
    Vec3f direction;
    Lanes reflectance, chosen; /* as often reflection is chosen, per wavelength; */
    Lanes natural;             /* and as often as it would be if the path were not led */
    bool reflected, straight;  /* straight: as often as it reflects */
    bool total;                /* it lets nothing through */
    bool is_turn;              /* see turns.h */
} BoundaryChoice;

bool path_look_ahead(Path *path, const SurfacePlace *place, Lanes eta_i, float brightness[2])
{
    if (UNLIKELY(path->is_photon)) return false;
    Vec3f direction = path->ray.direction, normal = place->normal;
    float index = lanes_mean(eta_i) / lanes_mean(path_ior(path, WORLD_MEDIUM)), cosine = vec3f_dot(direction, normal);
    Vec3f along = vec3f_scale(vec3f_along(direction, -cosine, normal), index);
    float rest = 1 - vec3f_dot(along, along);
    if (!(rest > 0)) return false; /* neither leaves */
    beacons_look(&path->tracer->world->beacons, vec3f_from(place->position), along, vec3f_scale(normal, sqrtf(rest)),
                 brightness);
    if (UNLIKELY(path->tracer->backdrop)) backdrop_note(path->tracer->backdrop, path, brightness);
    return brightness[0] != brightness[1];
}

/* Whether both ways of a choice are on the sides of the surface that they should be on. */
static bool keeps_sides(const SurfacePlace *place, Vec3f back, bool passes, Vec3f on)
{
    return vec3f_dot(back, place->geometric) > 0 && (!passes || vec3f_dot(on, place->geometric) < 0);
}

/* What a decision leaves of a random number is uniform again, and serves the next one: so
 * the samples of a pixel divide up among all ways through several boundaries as evenly as at one boundary. Measured,
 * squared error after equal time: 0.90 (peers' glass), 0.94 (whisky), 1.00 (glass-of-water, cold-glass) of that with a
 * number for each. The first number of a path from the camera is a third coordinate to the place in its pixel, so that its
 * choices are spread evenly over each part of that, too: 0.96 (peers' glass), 0.98 (aquarium), 0.99 to 1.00 elsewhere, for
 * 64 samples; numbers after a scattering that are third coordinates to its direction gain nothing. Choices in proportion to
 * what comes from either way (root of its mean square), learned by paths of the camera in a grid of places and directions:
 * 0.88 (peers' glass), 0.90 (whisky), 0.95 (glass-of-water) where a picture of its own, with eight times as many samples,
 * teaches; 0.97 to 1.04 where a quarter as many do. Roulette by the same: no better than by throughput. */
bool path_decide(Path *path, float probability)
{
    const float least_left = 0x1p-8f; /* of 32 digits enough remain for the rarest of reflections */
    Decision *decision = &path->decision;
    if (decision->left < least_left) {
        uint32_t digits = decision->of_pixel
                              ? sampler_stream_third(&path->tracer->pixel.place, path->sampler.index_reversed)
                              : sampler_digits(&path->sampler, sampler_dimension(path->bounce, DIM_LOBE));
        *decision = (Decision){.number = (double)digits * 0x1p-32, .left = 1};
    }
    bool yes = decision->number < (double)probability;
    float part = yes ? probability : 1 - probability;
    decision->number = (yes ? decision->number : decision->number - (double)probability) / (double)part;
    decision->left *= part;
    return yes;
}

/* Whether photons choose by their hopes, or probes by their leads. */
static bool is_led(const Path *path, Lanes *chosen)
{
    const PathProbing *probing = &path->probing;
    if (path->is_photon) return probing->hopes && hopes_choose(probing->hopes, probing->step, chosen);
    return probing->leads && leads_choose(probing->leads, &probing->turns, chosen);
}

static void choose_at_boundary(Path *path, const SurfacePlace *place, bool flat, Lanes eta_i, Lanes eta_t,
                               BoundaryChoice *choice)
{
    const World *world = path->tracer->world;
    Vec3f direction = path->ray.direction, normal = flat ? place->geometric : place->normal, on;
    Lanes reflectance;
    bool passes = fresnel_refract(direction, normal, eta_i, eta_t, &reflectance, &on);
    Vec3f back = reflect_direction(direction, normal);
    Lanes chosen = reflectance;
    choice->straight = true;
    float brightness[2];
    if (world->beacons.any && !flat && (passes || !lanes_uniform(reflectance)) && LIKELY(!world->trial.fresnel_alone) &&
        path_look_ahead(path, place, eta_i, brightness) && keeps_sides(place, back, passes, on)) {
        choice->straight = false;
        chosen = fresnel_choice(reflectance, brightness[0], brightness[1]);
    }
    choice->natural = chosen;
    choice->is_turn = UNLIKELY(path->probing.guide.share > 0 || path->is_photon) && passes && !flat &&
                      keeps_sides(place, back, passes, on);
    if (UNLIKELY(choice->is_turn) && is_led(path, &chosen)) choice->straight = false;
    choice->reflectance = reflectance;
    choice->chosen = chosen;
    /* what is reflected totally takes no random number */
    choice->total = !passes;
    choice->reflected = !passes || path_decide(path, lanes_get(chosen, 0));
    choice->direction = choice->reflected ? back : on;
}

/* What the choice does to a path: the hero is carried on by what it is over how often it is chosen, and others besides. */
static void weigh_choice(Path *path, const BoundaryChoice *choice, bool bends_alike)
{
    float hero = lanes_get(choice->reflectance, 0), chosen = lanes_get(choice->chosen, 0);
    if (choice->reflected) {
        Lanes factor = hero > 0 ? lanes_scale(choice->reflectance, 1 / chosen) : lanes_all(1);
        path->beta = lanes_mul(path->beta, factor);
        path->ratio = lanes_mul(path->ratio, choice->straight ? factor : lanes_scale(choice->chosen, 1 / chosen));
        return;
    }
    /* where each wavelength is bent another way, as for photons, this path goes on for the hero alone */
    Lanes carried = bends_alike ? lanes_all(1) : lanes(1, 0, 0, 0);
    if (!bends_alike) path->ratio = lanes_mul(path->ratio, carried);
    if (!choice->straight) {
        carried = lanes_scale(carried, (1 - hero) / (1 - chosen));
        if (UNLIKELY(!lanes_uniform(choice->chosen)))
            path->ratio = lanes_mul(path->ratio, lanes_scale(lanes_rest(choice->chosen), 1 / (1 - chosen)));
    }
    if (!bends_alike || !choice->straight) path->beta = lanes_mul(path->beta, carried);
}

static void note_turn(Path *path, const BoundaryChoice *choice, bool bends_alike)
{
    PathProbing *probing = &path->probing;
    turns_add(&probing->turns, choice->natural, choice->reflected, !bends_alike, path->is_photon);
    probing->part = -1;
    if (path->is_photon) probing->step = hopes_step(probing->step, choice->reflected);
    if (!probing->leads) return;
    float natural = lanes_get(choice->natural, 0), chosen = lanes_get(choice->chosen, 0);
    path->sought *= choice->reflected ? chosen / natural : (1 - chosen) / (1 - natural);
}

/* A coarse mesh with smooth normals may hold light for ever that came in through it, by total reflections about normals that no face
 * has: its rim would be dark. After a few of these in a row it gets out where the face itself lets it. */
ATTR_COLD static void let_out(Path *path, const SurfacePlace *place, Lanes eta_i, Lanes eta_t, BoundaryChoice *choice)
{
    if (path->total_reflections < PATH_MOST_TOTAL) return;
    Decision decision = path->decision;
    BoundaryChoice flat;
    choose_at_boundary(path, place, true, eta_i, eta_t, &flat);
    if (flat.total)
        path->decision = decision;
    else
        *choice = flat;
}

bool path_cross_boundary(Path *path, Event *event)
{
    const World *world = path->tracer->world;
    uint32_t from = event->crossing.medium_from, to = event->crossing.medium_to;
    Lanes eta_i = path_ior(path, from), eta_t = path_ior(path, to);
    if (!path->bent_apart && (world_medium_disperses(world, from) || world_medium_disperses(world, to))) {
        path->bent_apart = true;
        if (path->fork) path_keep_fork(path, event);
    }
    const float rarity = path->from.rarity;
    path->from.rarity = 0;
    SurfacePlace place = path_place(path, event);
    uint32_t number = world->looks[event->hit.object].surface;
    const SceneSurface *surface = number == SCENE_NONE ? NULL : path_surface(path, event, number);
    BsdfSpec room;
    const BsdfSpec *spec = path_boundary_at(path, event, surface, &place, &room);
    if (spec) return path_cross_rough(path, event, surface, spec, &place, eta_i, eta_t);
    if (UNLIKELY(world_refracts_doubly(world, from, to))) {
        path_cross_crystal(path, event, &place);
        return true;
    }
    Decision decision = path->decision;
    BoundaryChoice choice;
    choose_at_boundary(path, &place, false, eta_i, eta_t, &choice);
    /* Which side the new ray is on is the geometry's to say. Where the smooth normal would send a reflection
     * in, or a refraction out, the surface is taken as flat. */
    if ((vec3f_dot(choice.direction, place.geometric) > 0) != choice.reflected) {
        path->decision = decision; /* by the same number */
        choose_at_boundary(path, &place, true, eta_i, eta_t, &choice);
    }
    const bool bends_alike = lanes_uniform(eta_i) && lanes_uniform(eta_t);
    weigh_choice(path, &choice, bends_alike);
    if (UNLIKELY(choice.is_turn)) note_turn(path, &choice, bends_alike);
    if (UNLIKELY(choice.total)) let_out(path, &place, eta_i, eta_t, &choice);
    path->total_reflections = choice.total ? path->total_reflections + 1 : 0;
    const uint64_t face = slab_face_at(world, &event->hit, &place);
    if (UNLIKELY(face)) slab_meet_face(path, event, face, choice.reflected, rarity);
    path->scatter_pdf = -1;
    path->probing.bent = true;
    path_leave(path, event, &place, !choice.reflected, choice.direction);
    return true;
}

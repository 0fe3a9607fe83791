/* path.c - the path integrator.
 *
 * A path goes from event to event: an opaque surface, a boundary between two media, or out of the scene.
 * Between events it may pass any number of silent crossings, which change the interior list and nothing else.
 *
 * Wavelengths: lane 0 is the hero; the path is sampled for it alone. `beta` is the throughput of each lane
 * over the hero's density, `ratio` the density with which the same path would have been sampled with that
 * lane as the hero, over the hero's. A contribution counts beta / mean(ratio): the balance heuristic over
 * the wavelengths ([WNDWH14] A. Wilkie et al., "Hero Wavelength Spectral Sampling", EGSR 2014, eq. 5).
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/path.h"

#include <stdlib.h>

#include "base/array.h"
#include "optics/fresnel.h"
#include "optics/sampling.h"
#include "trace/light.h"

/* A straight line that crosses more surfaces than this without any event is given up, and counted. */
enum { SILENT_LIMIT = 100000 };
/* What the radiance of light from infinity is given in, whatever it comes through: a sea may reach there, too. */
enum { WORLD_MEDIUM = 0 };
/* Bounces before Russian roulette begins. */
enum { ROULETTE_START = 4 };

typedef struct Path {
    Tracer *tracer;
    Sampler sampler;
    WavelengthSample wavelengths;
    Lanes beta, ratio, radiance;
    Ray ray;
    Vec3 scatter_point; /* where the ray's direction was last sampled */
    float scatter_pdf;  /* density of that per steradian; < 0: not sampled from a density (camera, boundary) */
    uint32_t bounce;    /* events so far: each has random numbers of its own */
    bool straight;      /* media do not scatter it: it only looks what is there */
    uint32_t n_counted; /* of these, the ones that the scene's limit counts: not scattering within media */
} Path;

typedef enum EventKind { EVENT_LOST, EVENT_ESCAPE, EVENT_OPAQUE, EVENT_BOUNDARY, EVENT_SCATTER, EVENT_GIVE_UP } EventKind;

typedef struct Event {
    EventKind kind;
    Hit hit;            /* the surface to be shaded */
    size_t n_cluster;   /* surfaces at that place: tracer->hits[0 .. n) */
    NestCrossing crossing;
    double t;           /* EVENT_SCATTER: how far along the ray, */
    uint32_t medium;    /* and what scatters there */
} Event;

void tracer_init(Tracer *tracer, const World *world)
{
    *tracer = (Tracer){.world = world};
    nest_list_init(&tracer->list);
    nest_list_init(&tracer->next);
    nest_list_init(&tracer->shadow_list);
}

void tracer_clear(Tracer *tracer)
{
    hit_list_clear(&tracer->hits);
    hit_list_clear(&tracer->shadow_hits);
    hit_list_clear(&tracer->left);
    nest_list_clear(&tracer->list);
    nest_list_clear(&tracer->next);
    nest_list_clear(&tracer->shadow_list);
    free(tracer->passes);
    tracer->passes = NULL;
}

static Lanes medium_ior(const World *world, uint32_t medium, Lanes wavelength_nm)
{
    return spectrum_at(&world->scene->media[medium].ior, wavelength_nm);
}

/* Optical depth of a stretch of one medium. */
static Lanes stretch_depth(const World *world, uint32_t medium, double length, Lanes wavelength_nm)
{
    const SceneMedium *m = &world->scene->media[medium];
    if (!m->absorbs || world->no_absorption || !(length > 0)) return lanes_all(0);
    /* held finite, so that a wavelength that is not absorbed at all stays so out to infinity */
    return lanes_scale(spectrum_at(&m->absorption, wavelength_nm), length < 1e30 ? (float)length : 1e30f);
}

/* The same for what is lost to a straight ray, by scattering too. */
static Lanes stretch_extinction(const World *world, uint32_t medium, double length, Lanes wavelength_nm)
{
    Lanes depth = stretch_depth(world, medium, length, wavelength_nm);
    const SceneMedium *m = &world->scene->media[medium];
    if (!m->scatters || !(length > 0)) return depth;
    return lanes_add(depth, lanes_scale(spectrum_at(&m->scattering, wavelength_nm), length < 1e30 ? (float)length : 1e30f));
}

static Lanes attenuation(Lanes depth)
{
    return lanes_zero(depth) ? lanes_all(1) : lanes_exp(lanes_sub(lanes_all(0), depth));
}

/* Crosses the hulls among hits[0 .. n), all at one place. */
static bool cross_hits(Tracer *tracer, NestList *list, const Hit *hits, size_t n, NestCrossing *crossing)
{
    const CompiledScene *compiled = tracer->world->compiled;
    if (UNLIKELY(!array_reserve(&tracer->passes, &tracer->passes_capacity, n, sizeof *tracer->passes))) return false;
    uint32_t n_passes = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t hull = compiled->hull_of_object[hits[i].object];
        if (hull == SCENE_NONE) continue;
        if (UNLIKELY(hits[i].doubtful) && nest_list_has(list, hull) == hits[i].entering) continue; /* no surface is there */
        tracer->passes[n_passes++] = (NestPass){hull, hits[i].entering};
    }
    *crossing = (NestCrossing){0};
    if (!n_passes) return true;
    return nest_cross(list, &compiled->order, tracer->passes, n_passes, crossing) == STATUS_OK;
}

static void swap_lists(Tracer *tracer)
{
    NestList swap = tracer->list;
    tracer->list = tracer->next;
    tracer->next = swap;
}

/* Whether a boundary between these media can be seen: their indices differ at some wavelength carried. */
static bool media_differ(const World *world, uint32_t a, uint32_t b, Lanes wavelength_nm)
{
    if (a == b) return false;
    Lanes difference = lanes_sub(medium_ior(world, a, wavelength_nm), medium_ior(world, b, wavelength_nm));
    return !lanes_zero(difference);
}

/* The hit of several at one place that stands for the boundary: crossing them one after another, the one at which the
 * medium last becomes what it is behind them all, or where an opaque combination begins. */
static const Hit *boundary_hit(Tracer *tracer, size_t n, const NestCrossing *crossing)
{
    const CompiledScene *compiled = tracer->world->compiled;
    const Hit *hits = tracer->hits.items, *best = &hits[0];
    if (LIKELY(n == 1) || nest_list_copy(&tracer->shadow_list, &tracer->list) != STATUS_OK) return best;
    for (size_t i = 0; i < n; i++) {
        NestPass pass = {compiled->hull_of_object[hits[i].object], hits[i].entering};
        NestCrossing step;
        if (nest_cross(&tracer->shadow_list, &compiled->order, &pass, 1, &step) != STATUS_OK) return best;
        if (crossing->opaque ? step.opaque : step.medium_from != step.medium_to && step.medium_to == crossing->medium_to)
            best = &hits[i];
    }
    return best;
}

/* Which of the surfaces at one place is to be shaded, if any is opaque. */
static EventKind event_kind(const World *world, const Hit *hits, size_t n, Event *event)
{
    for (size_t i = 0; i < n; i++)
        if (world->compiled->hull_of_object[hits[i].object] == SCENE_NONE) {
            event->hit = hits[i];
            return EVENT_OPAQUE;
        }
    return n ? EVENT_BOUNDARY : EVENT_ESCAPE;
}

static bool any_doubtful(const Hit *hits, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (hits[i].doubtful) return true;
    return false;
}

/* Finds the next surfaces along the path's ray and crosses them into tracer->next; false when memory ends.
 * Where what was found contradicts the list, or is doubtful, Embree's float ray may have met at an edge what the exact ray
 * misses, or missed what it meets. Then the search is done again with the float ray moved by as much as rounding,
 * first onto the exact one, then to both sides of the surface; a reading that is clear and agrees with the list is taken, and
 * the float ray stays there. A contradiction in all of them is a fault. */
static bool cross_nearest(Path *path, Event *event)
{
    enum { ATTEMPTS = 4 };
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    Vec3 nudges[ATTEMPTS] = {path->ray.nudge};
    for (int attempt = 0;; attempt++) {
        path->ray.nudge = nudges[attempt % ATTEMPTS];
        size_t n = rtc_nearest(world->compiled->rtc, &path->ray, &tracer->hits);
        tracer->counters.rays++;
        const Hit *hits = tracer->hits.items;
        event->n_cluster = n;
        event->kind = event_kind(world, hits, n, event);
        event->crossing = (NestCrossing){0};
        if (tracer->hits.out_of_memory) return false;
        if (event->kind != EVENT_BOUNDARY) return true;
        if (nest_list_copy(&tracer->next, &tracer->list) != STATUS_OK ||
            !cross_hits(tracer, &tracer->next, hits, n, &event->crossing))
            return false;
        /* after the last attempt the first reading is taken again, with its faults */
        bool clear = !event->crossing.n_faults && !any_doubtful(hits, n);
        if (LIKELY(clear) || attempt == ATTEMPTS) {
            tracer->counters.crossings += n;
            tracer->counters.nesting_faults += event->crossing.n_faults;
            return true;
        }
        if (attempt == 0) {
            nudges[2] = vec3_scale(vec3_from_f(hits[0].normal), hits[0].rounding);
            nudges[3] = vec3_scale(nudges[2], -1);
        }
    }
}

/* How far a path goes before it is scattered. A medium's scattering is sampled for the hero, and its absorption is a
 * weight: what is sampled never ends a path. */
typedef struct FreeFlight {
    float budget; /* of the hero's optical depth of scattering that is left; INFINITY where nothing scatters */
    Lanes depth;  /* what is used up so far, of every lane */
} FreeFlight;

static FreeFlight begin_flight(Path *path)
{
    FreeFlight flight = {INFINITY, lanes_all(0)};
    if (path->tracer->world->scatters && !path->straight)
        flight.budget = -logf(1 - sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_DISTANCE)));
    return flight;
}

/* Goes up to `length` through a medium; returns how far it came: less where it is scattered. */
static double fly(FreeFlight *flight, const World *world, uint32_t medium, double length, Lanes wavelength_nm, Lanes *coefficient)
{
    const SceneMedium *m = &world->scene->media[medium];
    if (!m->scatters || !(length > 0)) return length;
    *coefficient = spectrum_at(&m->scattering, wavelength_nm);
    double hero = (double)lanes_get(*coefficient, 0), reach = (double)flight->budget;
    bool scattered = hero * length > reach;
    if (scattered) length = reach / hero;
    flight->depth = lanes_add(flight->depth, lanes_scale(*coefficient, length < 1e30 ? (float)length : 1e30f));
    flight->budget -= (float)(hero * length);
    if (scattered || flight->budget < 0) flight->budget = 0;
    return length;
}

/* What the flight has made of the path: lanes that are scattered more, or less, than the hero. */
static void end_flight(Path *path, const FreeFlight *flight, const Lanes *coefficient)
{
    Lanes more = lanes_sub(flight->depth, lanes_all(lanes_get(flight->depth, 0)));
    Lanes factor = attenuation(more);
    if (coefficient) factor = lanes_mul(factor, lanes_scale(*coefficient, 1 / lanes_get(*coefficient, 0)));
    path->beta = lanes_mul(path->beta, factor);
    path->ratio = lanes_mul(path->ratio, factor);
}

/* Follows the path's ray through silent crossings to its next event. Absorption goes into beta. At a boundary
 * tracer->list is the list before it and tracer->next the one behind it. */
static void next_event(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    double t_done = 0; /* the ray's start, not t_min: lengths are measured from the origin */
    Lanes depth = lanes_all(0), coefficient;
    FreeFlight flight = begin_flight(path);
    for (uint32_t silent = 0;; silent++) {
        if (!cross_nearest(path, event)) {
            event->kind = EVENT_LOST;
            return;
        }
        const Hit *hits = tracer->hits.items;
        size_t n = event->n_cluster;
        uint32_t medium = nest_medium(&world->compiled->order, &tracer->list);
        double t = n ? hits[0].t : HUGE_VAL, length = t - t_done;
        double flown = fly(&flight, world, medium, length, path->wavelengths.nm, &coefficient);
        depth = lanes_add(depth, stretch_depth(world, medium, flown, path->wavelengths.nm));
        if (flown < length) {
            *event = (Event){.kind = EVENT_SCATTER, .t = t_done + flown, .medium = medium};
            break;
        }
        t_done = t;
        if (event->kind != EVENT_BOUNDARY) break;
        if (event->crossing.opaque) {
            event->kind = EVENT_OPAQUE;
            event->hit = *boundary_hit(tracer, n, &event->crossing);
            break;
        }
        if (media_differ(world, event->crossing.medium_from, event->crossing.medium_to, path->wavelengths.nm)) {
            event->hit = *boundary_hit(tracer, n, &event->crossing);
            break;
        }
        /* Nothing is there: on along the same ray, with the new list. */
        tracer->counters.silent_crossings++;
        if (silent >= SILENT_LIMIT) {
            tracer->counters.silent_limit++;
            event->kind = EVENT_GIVE_UP;
            return;
        }
        swap_lists(tracer);
        path->ray.t_min = hits[n - 1].t;
    }
    path->beta = lanes_mul(path->beta, attenuation(depth));
    if (world->scatters) end_flight(path, &flight, event->kind == EVENT_SCATTER ? &coefficient : NULL);
}

/* The list of a ray that starts at several surfaces which stand at one place but are not parallel, say where two
 * hulls' surfaces cross: each of them is crossed, or not, by where the ray starts and goes. */
static bool cross_towards(Tracer *tracer, const Ray *ray, NestList *list)
{
    const CompiledScene *compiled = tracer->world->compiled;
    if (nest_list_copy(list, &tracer->list) != STATUS_OK) return false;
    for (size_t i = 0; i < ray->n_left; i++) {
        const Hit *left = &ray->left[i];
        uint32_t hull = compiled->hull_of_object[left->object];
        NestPass pass = {hull, left->inside};
        NestCrossing crossing;
        if (hull == SCENE_NONE || left->inside != left->entering) continue; /* not crossed */
        if (nest_cross(list, &compiled->order, &pass, 1, &crossing) != STATUS_OK) return false;
    }
    return true;
}

/* Transmittance of a straight shadow ray from the path's place; false when something blocks it. Opaque
 * objects and visible boundaries block: light that crosses a boundary arrives by paths that are bent there. */
static bool shadow_transmittance(Path *path, const Ray *ray, Lanes *transmittance, uint32_t *medium_at_light)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    tracer->counters.rays++;
    if (!rtc_all(world->compiled->rtc, ray, true, &tracer->shadow_hits)) return false;
    const Hit *hits = tracer->shadow_hits.items;
    size_t n = tracer->shadow_hits.n;
    if (!cross_towards(tracer, ray, &tracer->shadow_list)) {
        tracer->out_of_memory = true;
        return false;
    }
    uint32_t medium = nest_medium(&world->compiled->order, &tracer->shadow_list);
    Lanes depth = lanes_all(0);
    double t_done = 0;
    for (size_t begin = 0; begin < n;) {
        size_t end = begin + rtc_cluster(hits + begin, n - begin);
        NestCrossing crossing;
        if (!cross_hits(tracer, &tracer->shadow_list, hits + begin, end - begin, &crossing)) {
            tracer->out_of_memory = true;
            return false;
        }
        tracer->counters.crossings += end - begin;
        tracer->counters.nesting_faults += crossing.n_faults;
        if (crossing.opaque || media_differ(world, crossing.medium_from, crossing.medium_to, path->wavelengths.nm))
            return false;
        depth = lanes_add(depth, stretch_extinction(world, medium, hits[begin].t - t_done, path->wavelengths.nm));
        t_done = hits[begin].t;
        medium = crossing.medium_to;
        begin = end;
    }
    depth = lanes_add(depth, stretch_extinction(world, medium, ray->t_max - t_done, path->wavelengths.nm));
    *transmittance = attenuation(depth);
    *medium_at_light = medium;
    return true;
}

/* Radiance given in a medium, as basic radiance. */
static Lanes basic_radiance(const World *world, Lanes radiance, uint32_t medium, Lanes wavelength_nm)
{
    Lanes ior = medium_ior(world, medium, wavelength_nm);
    return lanes_div(radiance, lanes_mul(ior, ior));
}

/* Adds what reaches the camera of a radiance seen at the end of the path. */
static void add_radiance(Path *path, Lanes factor, Lanes basic)
{
    float mean_ratio = lanes_mean(path->ratio);
    path->radiance = lanes_add(path->radiance, lanes_scale(lanes_mul(lanes_mul(path->beta, factor), basic), 1 / mean_ratio));
}

static Lanes surface_albedo(const SceneSurface *surface, Vec3 p, Lanes wavelength_nm)
{
    if (surface->checkered) {
        double cells = floor(p.x / (double)surface->check_size) + floor(p.y / (double)surface->check_size + 0.5) +
                       floor(p.z / (double)surface->check_size);
        if (fmod(cells, 2) != 0) return spectrum_at(&surface->albedo2, wavelength_nm);
    }
    return spectrum_at(&surface->albedo, wavelength_nm);
}

/* The colour of a reflectance under white light, from wavelengths that are evenly spread by importance. */
ATTR_COLD static void reflectance_color(const SceneSurface *surface, Vec3 p, float rgb[3])
{
    enum { SAMPLES = 32 }; /* of four wavelengths each */
    double sum[3] = {0}, white[3] = {0};
    for (int i = 0; i < SAMPLES; i++) {
        WavelengthSample wavelengths = wavelengths_sample(((float)i + 0.5f) / (4 * SAMPLES));
        Lanes light = white_at(wavelengths.nm);
        float reflected[3], given[3];
        color_from_lanes(lanes_mul(surface_albedo(surface, p, wavelengths.nm), light), &wavelengths, reflected);
        color_from_lanes(light, &wavelengths, given);
        for (int c = 0; c < 3; c++) {
            sum[c] += (double)reflected[c];
            white[c] += (double)given[c];
        }
    }
    for (int c = 0; c < 3; c++) rgb[c] = (float)(sum[c] / white[c]);
}

ATTR_COLD static void note_first_sight(const Path *path, const Event *event)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const Scene *scene = world->scene;
    FirstSight *sight = tracer->first_sight;
    *sight = (FirstSight){.object = SCENE_NONE, .medium = SCENE_NONE};
    if (event->kind != EVENT_OPAQUE && event->kind != EVENT_BOUNDARY) return;
    bool opaque = event->kind == EVENT_OPAQUE;
    const SceneObject *object = &scene->objects[event->hit.object];
    HitSurface at;
    rtc_surface(world->compiled->rtc, &path->ray, &event->hit, &at);
    const NestList *list = opaque ? &tracer->list : &tracer->next;
    sight->met = true;
    sight->object = object->part_of != SCENE_NONE ? object->part_of : event->hit.object;
    sight->medium = nest_medium(&world->compiled->order, list);
    compiled_hulls_in(world->compiled, list, &sight->n_hulls);
    sight->distance = event->hit.t;
    sight->position = at.position;
    sight->normal = event->hit.cos_normal < 0 ? at.shading : vec3f_negate(at.shading);
    for (int i = 0; i < 2; i++) sight->uv[i] = at.uv[i];
    for (int i = 0; i < 3; i++) sight->albedo[i] = opaque ? 0 : 1;
    if (opaque && object->light == SCENE_NONE && object->surface != SCENE_NONE)
        reflectance_color(&scene->surfaces[object->surface], at.position, sight->albedo);
}

/* Sends the path on from the surfaces that it has come to: through them, or back. */
static void leave(Path *path, Event *event, bool through, Vec3f direction)
{
    Tracer *tracer = path->tracer;
    HitList reached = tracer->hits;
    path->ray = rtc_leave(tracer->world->compiled->rtc, &path->ray, reached.items, &event->n_cluster, through, direction);
    tracer->hits = tracer->left; /* the ray refers to what it has left until its end */
    tracer->left = reached;
    bool several = event->n_cluster > 1;
    if (several && !cross_towards(tracer, &path->ray, &tracer->next)) tracer->out_of_memory = true;
    if (through || several) swap_lists(tracer);
}

static LightSample choose_light(const Path *path, Vec3 from)
{
    float u[2];
    sampler_2d(&path->sampler, sampler_dimension(path->bounce, DIM_LIGHT), u);
    float choice = sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_LIGHT_CHOICE));
    return light_sample(path->tracer->world, from, path->ray.time, choice, u, path->wavelengths.nm);
}

/* Adds what comes straight along the ray from a light, scattered by the factor, weighted against finding the light
 * by a direction of density scatter_pdf. */
static void add_direct_light(Path *path, const LightSample *light, Ray ray, Lanes scattered, float scatter_pdf)
{
    const World *world = path->tracer->world;
    ray.t_max = light->distance;
    ray.target = light->object;
    Lanes transmittance;
    uint32_t medium;
    if (!shadow_transmittance(path, &ray, &transmittance, &medium)) return;
    float weight = sampling_balance(light->pdf_w, scatter_pdf);
    Lanes factor = lanes_mul(lanes_scale(scattered, weight / light->pdf_w), transmittance);
    if (isinf(light->distance)) medium = WORLD_MEDIUM;
    add_radiance(path, factor, basic_radiance(world, light->radiance, medium, path->wavelengths.nm));
}

/* Light that a diffuse surface gets straight from a light source. */
static void light_diffuse(Path *path, Event *event, const HitSurface *at, Vec3f normal, Vec3f geometric, Lanes albedo)
{
    LightSample light = choose_light(path, at->position);
    if (!(light.pdf_w > 0)) return;
    float cosine = vec3f_dot(light.direction, normal), scatter_pdf = cosine / SAMPLING_PI;
    if (!(cosine > 0) || !(vec3f_dot(light.direction, geometric) > 0)) return;
    Ray ray = rtc_leave(path->tracer->world->compiled->rtc, &path->ray, path->tracer->hits.items, &event->n_cluster, false,
                        light.direction);
    add_direct_light(path, &light, ray, lanes_scale(albedo, scatter_pdf), scatter_pdf);
}

/* A place within a medium where the path is scattered. */
static void scatter_in_medium(Path *path, const Event *event)
{
    const Phase *phase = &path->tracer->world->scene->media[event->medium].phase;
    Vec3 position = ray_point(&path->ray, event->t);
    Vec3f along = path->ray.direction;
    LightSample light = choose_light(path, position);
    if (light.pdf_w > 0) {
        float pdf = phase_evaluate(phase, vec3f_dot(along, light.direction));
        Ray ray = ray_make(position, light.direction);
        ray.time = path->ray.time;
        add_direct_light(path, &light, ray, lanes_all(pdf), pdf);
    }
    float u[2];
    double time = path->ray.time;
    sampler_2d(&path->sampler, sampler_dimension(path->bounce, DIM_SCATTER), u);
    path->scatter_point = position;
    path->ray = ray_make(position, phase_sample(phase, along, u, &path->scatter_pdf));
    path->ray.time = time;
}

/* A hit of an opaque surface. Returns whether the path goes on. */
static bool shade_opaque(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const SceneObject *object = &world->scene->objects[event->hit.object];
    if (object->light != SCENE_NONE) {
        Lanes radiance = light_radiance_hit(world, object->light, &event->hit, path->wavelengths.nm);
        float weight = 1;
        if (path->scatter_pdf >= 0)
            weight = sampling_balance(path->scatter_pdf,
                                       light_pdf_hit(world, object->light, path->scatter_point, &path->ray, &event->hit));
        uint32_t medium = nest_medium(&world->compiled->order, &tracer->list);
        add_radiance(path, lanes_all(weight), basic_radiance(world, radiance, medium, path->wavelengths.nm));
        return false;
    }
    if (object->surface == SCENE_NONE) return false;
    HitSurface at;
    rtc_surface(world->compiled->rtc, &path->ray, &event->hit, &at);
    bool front = event->hit.entering;
    Vec3f geometric = front ? event->hit.normal : vec3f_negate(event->hit.normal);
    Vec3f normal = front ? at.shading : vec3f_negate(at.shading);
    if (!(vec3f_dot(path->ray.direction, normal) < 0)) normal = geometric;
    Lanes albedo = surface_albedo(&world->scene->surfaces[object->surface], at.position, path->wavelengths.nm);
    light_diffuse(path, event, &at, normal, geometric, albedo);

    float u[2];
    sampler_2d(&path->sampler, sampler_dimension(path->bounce, DIM_SCATTER), u);
    Vec3f direction = sampling_cosine_hemisphere(u[0], u[1], normal, &path->scatter_pdf);
    if (!(vec3f_dot(direction, geometric) > 0)) return false; /* into the surface */
    path->beta = lanes_mul(path->beta, albedo);
    path->scatter_point = at.position;
    leave(path, event, false, direction);
    return true;
}

/* Reflection or refraction about one normal, which is on the side that the ray comes from. */
typedef struct BoundaryChoice {
    Vec3f direction;
    Lanes reflectance;
    bool reflected, total;
} BoundaryChoice;

static BoundaryChoice choose_at_boundary(Vec3f direction, Vec3f normal, Lanes eta_i, Lanes eta_t, float u)
{
    BoundaryChoice choice;
    float cosine = float_min(-vec3f_dot(direction, normal), 1);
    choice.reflectance = fresnel_dielectric_lanes(cosine, eta_i, eta_t);
    choice.reflected = u < lanes_get(choice.reflectance, 0);
    if (!choice.reflected &&
        !refract_direction(direction, normal, lanes_get(eta_i, 0), lanes_get(eta_t, 0), &choice.direction))
        choice.reflected = true; /* within rounding of the critical angle */
    if (choice.reflected) choice.direction = reflect_direction(direction, normal);
    return choice;
}

/* A smooth boundary between two dielectrics: one of the two ways is taken, with the probability of the hero's
 * Fresnel reflectance. */
static void cross_boundary(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    Lanes eta_i = medium_ior(world, event->crossing.medium_from, path->wavelengths.nm);
    Lanes eta_t = medium_ior(world, event->crossing.medium_to, path->wavelengths.nm);
    HitSurface at;
    rtc_surface(world->compiled->rtc, &path->ray, &event->hit, &at);
    bool front = event->hit.entering;
    Vec3f geometric = front ? event->hit.normal : vec3f_negate(event->hit.normal);
    Vec3f normal = front ? at.shading : vec3f_negate(at.shading);
    float u = sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_LOBE));
    bool usable = vec3f_dot(path->ray.direction, normal) < 0;
    BoundaryChoice choice;
    if (usable) {
        choice = choose_at_boundary(path->ray.direction, normal, eta_i, eta_t, u);
        /* Which side the new ray is on is the geometry's to say. Where the smooth normal would send a reflection
         * in, or a refraction out, the surface is taken as flat. */
        usable = (vec3f_dot(choice.direction, geometric) > 0) == choice.reflected;
    }
    if (!usable) choice = choose_at_boundary(path->ray.direction, geometric, eta_i, eta_t, u);

    float hero = lanes_get(choice.reflectance, 0);
    if (choice.reflected) {
        Lanes factor = hero > 0 ? lanes_scale(choice.reflectance, 1 / hero) : lanes_all(1);
        path->beta = lanes_mul(path->beta, factor);
        path->ratio = lanes_mul(path->ratio, factor);
    } else if (!lanes_uniform(eta_i) || !lanes_uniform(eta_t)) {
        /* each wavelength is bent another way: this path goes on for the hero alone */
        Lanes hero_only = lanes(1, 0, 0, 0);
        path->beta = lanes_mul(path->beta, hero_only);
        path->ratio = lanes_mul(path->ratio, hero_only);
    }
    path->scatter_pdf = -1;
    leave(path, event, !choice.reflected, choice.direction);
}

/* Ends paths that carry little. The decision uses what is the same whichever lane is the hero. */
static bool survives(Path *path)
{
    if (lanes_zero(path->beta)) return false;
    if (path->bounce < ROULETTE_START) return true;
    float carried = lanes_max(path->beta) / lanes_mean(path->ratio) * 0.25f;
    carried = float_max(carried, lanes_mean(path->beta) / lanes_mean(path->ratio));
    if (carried >= 1) return true;
    if (sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_ROULETTE)) >= carried) return false;
    path->beta = lanes_scale(path->beta, 1 / carried);
    return true;
}

/* The list at the ray's real origin: from the camera's centre on along the lens. */
static bool start_list(Path *path, const SceneCamera *camera)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    Status status = world->camera_list_moves
                        ? compiled_interior(world->compiled, vec3f_from(camera->from), path->ray.time,
                                            &tracer->shadow_hits, &tracer->list, NULL)
                        : nest_list_copy(&tracer->list, &world->camera_list);
    if (status != STATUS_OK) return false;
    if (!world->lens_crosses) return true;
    Vec3 offset = vec3_sub(path->ray.origin, camera->from);
    double length = vec3_length(offset);
    if (!(length > 0)) return true;
    Ray ray = ray_make(camera->from, vec3f_from(vec3_scale(offset, 1 / length)));
    ray.time = path->ray.time;
    ray.t_max = length;
    tracer->counters.rays++;
    rtc_all(world->compiled->rtc, &ray, false, &tracer->shadow_hits);
    NestCrossing crossing;
    for (size_t i = 0; i < tracer->shadow_hits.n; i++)
        if (!cross_hits(tracer, &tracer->list, &tracer->shadow_hits.items[i], 1, &crossing)) return false;
    return true;
}

/* A place in the pixel after a tent filter of radius 1: u in [0,1) to an offset in (-1, 1). */
static double tent(float u)
{
    double v = 2 * (double)u;
    return v < 1 ? sqrt(v) - 1 : 1 - sqrt(2 - v);
}

/* What the camera's ray would meet first if no medium scattered it. The path stays as it is. */
ATTR_COLD static void look_ahead(const Path *path)
{
    Tracer *tracer = path->tracer;
    Path look = *path;
    Event event;
    NestList kept;
    nest_list_init(&kept);
    look.straight = true;
    if (nest_list_copy(&kept, &tracer->list) == STATUS_OK) {
        next_event(&look, &event);
        note_first_sight(&look, &event);
        if (nest_list_copy(&tracer->list, &kept) != STATUS_OK) tracer->out_of_memory = true;
    }
    nest_list_clear(&kept);
}

/* Returns whether the camera's ray met anything. */
static bool follow(Path *path)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    if (UNLIKELY(tracer->first_sight && world->scatters)) look_ahead(path);
    for (bool first = true;; first = false) {
        Event event;
        next_event(path, &event);
        if (UNLIKELY(first && tracer->first_sight && !world->scatters)) note_first_sight(path, &event);
        if (event.kind == EVENT_LOST) tracer->out_of_memory = true;
        if (event.kind == EVENT_LOST || event.kind == EVENT_GIVE_UP) return true;
        if (event.kind == EVENT_ESCAPE) {
            Lanes radiance = light_from_infinity(world, path->ray.direction, path->scatter_pdf, path->wavelengths.nm);
            add_radiance(path, lanes_all(1), basic_radiance(world, radiance, WORLD_MEDIUM, path->wavelengths.nm));
            /* out here the ray is in nothing that is bounded, or a surface was lost */
            if (world->compiled->order.policy != NEST_NONE)
                tracer->counters.nesting_faults += compiled_bounded_in(world->compiled, &tracer->list);
            return !first;
        }
        if (path->n_counted >= world->max_bounces && event.kind != EVENT_SCATTER) {
            /* the last surface may still shine */
            if (event.kind == EVENT_BOUNDARY || world->scene->objects[event.hit.object].light == SCENE_NONE) return true;
        }
        if (event.kind == EVENT_SCATTER)
            scatter_in_medium(path, &event);
        else if (event.kind == EVENT_BOUNDARY)
            cross_boundary(path, &event);
        else if (!shade_opaque(path, &event))
            return true;
        path->n_counted += event.kind != EVENT_SCATTER;
        path->bounce++;
        if (!survives(path)) return true;
    }
}

void trace_sample(Tracer *tracer, uint32_t x, uint32_t y, uint32_t width, uint32_t height, uint32_t seed, uint32_t index,
                  float rgb[3], float *alpha)
{
    const World *world = tracer->world;
    Path path = {.tracer = tracer, .sampler = sampler_make(seed, x, y, index), .beta = lanes_all(1), .ratio = lanes_all(1),
                 .radiance = lanes_all(0), .scatter_pdf = -1};
    float u[2], lens[2];
    sampler_2d(&path.sampler, DIM_PIXEL, u);
    sampler_2d(&path.sampler, DIM_LENS, lens);
    path.wavelengths = wavelengths_sample(sampler_1d(&path.sampler, DIM_WAVELENGTH));
    FilmPoint point = {(double)x + 0.5 + tent(u[0]), (double)y + 0.5 + tent(u[1]), width, height};
    double time = world->moves ? (double)sampler_1d(&path.sampler, DIM_TIME) : 0;
    SceneCamera moved;
    const SceneCamera *camera = world->camera;
    if (camera->keys) {
        moved = scene_camera_at(world->scene, camera, time);
        camera = &moved;
    }
    camera_ray(camera, point, lens, &path.ray);
    path.ray.time = time;
    tracer->counters.paths++;
    bool met = true;
    if (start_list(&path, camera))
        met = follow(&path);
    else
        tracer->out_of_memory = true;
    *alpha = met || world->scene->environment ? 1 : 0;
    color_from_lanes(path.radiance, &path.wavelengths, rgb);
    if (UNLIKELY(!isfinite(rgb[0]) || !isfinite(rgb[1]) || !isfinite(rgb[2]))) {
        tracer->counters.bad_samples++;
        rgb[0] = rgb[1] = rgb[2] = 0;
    }
}

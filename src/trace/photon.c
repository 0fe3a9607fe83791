/* photon.c - light followed from the small bright lights of a scene through its clear objects, to where it is scattered.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/photon.h"

#include <stdlib.h>

#include "optics/sampling.h"
#include "trace/event.h"
#include "trace/photon_start.h"
#include "trace/shade.h"
#include "trace/slab_lamp.h"
#include "trace/slab_sky.h"

/* Boundaries and mirrors that a photon is followed through. */
enum { MOST_EVENTS = 64 };
enum { BATCH = 256 };
/* At a light, to find out in which directions it is seen. */
enum { LOOKS = 24 };
/* The photons' own random numbers: no pixel of a picture has these coordinates. */
enum { PHOTON_PIXEL_X = 0x70686f74, PHOTON_PIXEL_Y = 0x6f6e7300 };

/* ---- on the way ---- */

/* Where an event is, for a photon that ends there. */
static void land(const Path *path, const Event *event, float flux, Photon *photon)
{
    float carried = flux * lanes_mean(path->beta) / lanes_mean(path->ratio);
    double t = event->kind == EVENT_SCATTER ? event->t : event->hit.t;
    *photon = (Photon){.position = vec3f_from(ray_point(&path->ray, t)), .from = vec3f_negate(path->ray.direction)};
    if (event->kind != EVENT_SCATTER)
        photon->normal = event->hit.cos_normal < 0 ? event->hit.normal : vec3f_negate(event->hit.normal);
    photon->at_boundary = event->kind == EVENT_BOUNDARY;
    photon->turns = path->probing.turns.bits;
    photon->chance = lanes_get(path->probing.turns.chance, 0);
    if (isfinite(carried) && carried > 0) photon->flux = carried;
}

/* Whether looks find what comes through slabs as the photon did. */
static bool is_looked_at(Path *path, const LightSample *light, const Ray *begin, const Photon *photon)
{
    const Vec3 place = vec3_from_f(photon->position);
    if (isfinite(light->distance)) return slab_lamp_is_looked_at(path, light->emitter, begin, place);
    return slab_sky_is_looked_at(path, vec3f_negate(begin->direction), place, photon->normal);
}

/* Follows a photon from a light to where it ends; false: to no place of use. */
static bool follow_photon(Path *path, const LightSample *light, float flux, Photon *photon)
{
    const Ray begin = path->ray;
    const Scene *scene = path->tracer->world->scene;
    bool bent = false;
    uint32_t rough = 0;
    uint64_t way = 0;
    for (int i = 0; i < MOST_EVENTS; i++, path->bounce++) {
        Event event;
        path_next_event(path, &event);
        if (event.kind == EVENT_LOST || event.kind == EVENT_ESCAPE || event.kind == EVENT_GIVE_UP) return false;
        land(path, &event, flux, photon);
        if (!(photon->flux > 1e-6f * flux)) return false;
        bool goes_on = false, straight = false;
        const bool at_slab =
            event.kind == EVENT_BOUNDARY && slabs_face(&path->tracer->world->slabs, event.hit.object, event.hit.normal);
        const bool was_bent =
            bent || (path_is_in_slabs(path) && (at_slab || !is_looked_at(path, light, &begin, photon)));
        Vec3f before = path->ray.direction;
        if (event.kind == EVENT_BOUNDARY) {
            goes_on = path_cross_boundary(path, &event) && path_went_straight(path);
            /* half of those that come to frosted glass after others land there, for paths that see it, and half go on */
            if (was_bent && goes_on && path->scatter_pdf > 0) {
                goes_on = sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_GUIDE)) < 0.5f;
                flux *= 2, photon->flux *= 2;
            }
            straight = path->slab_way.bounce == path->bounce + 1;
        } else if (event.kind == EVENT_OPAQUE) {
            const SceneObject *object = &scene->objects[event.hit.object];
            if (object->light != SCENE_NONE || object->surface == SCENE_NONE) return false;
            const SceneSurface *surface = &scene->surfaces[object->surface];
            goes_on =
                (surface->finished || surface->mixed) && path_shade_opaque(path, &event) && path_went_straight(path);
            straight = scene_is_pane(scene, event.hit.object) && vec3f_dot(before, path->ray.direction) > 0.999999f;
        }
        uint64_t step = event.kind == EVENT_SCATTER ? 0 : 2 * (uint64_t)event.hit.object + 1;
        way = hash_u64(way ^ hash_u64(4 * step + 2 * goes_on + (vec3f_dot(path->ray.direction, event.hit.normal) > 0)));
        photon->way = ((uint32_t)(way >> 32) & ~1U) | rough;
        if (!goes_on) return was_bent;
        if (path->scatter_pdf > 0) path->probing.turns = turns_none();
        rough |= path->scatter_pdf > 0;
        /* what comes through panes alone is found by looking at the light; of slabs only their far side tells */
        bent = bent || !straight;
    }
    return false;
}

typedef struct Job {
    const World *world;
    const PhotonTargets *targets;
    float threshold;
    uint32_t seed, first, n;
    Photon *photons;
    const uint32_t *which;
    const Hopes *hopes;
    Hopes *counts; /* of each worker; NULL: unwanted */
    Tracer *tracers;
    const volatile sig_atomic_t *stop;
} Job;

static bool is_stopped(const Job *job)
{
    return job->stop && *job->stop;
}

static Path begin_photon(Tracer *tracer, const Hopes *hopes, uint32_t seed, uint32_t number)
{
    static const Hopes none;
    Path path;
    path_init(&path, tracer, sampler_make(seed, PHOTON_PIXEL_X, PHOTON_PIXEL_Y, number));
    path.wavelengths = world_wavelengths(tracer->world, sampler_1d(&path.sampler, DIM_WAVELENGTH));
    path_is_of_light(&path, hopes && number < PHOTON_EXPLORERS ? &none : hopes);
    path.ray.time = tracer->world->moves ? (double)sampler_1d(&path.sampler, DIM_TIME) : 0;
    return path;
}

/* ---- neighbours ---- */

/* What a photon becomes when its start is changed a little: place and direction where it lands, per unit of change. */
typedef struct Column {
    double place[3], direction[2];
} Column;

/* In the plane that touches the sphere of directions at a photon's: P.-E. Lambert's projection, which keeps areas. */
static void in_plane(Vec3f axis, Vec3f direction, double p[2])
{
    Vec3f x, y;
    sampling_basis(axis, &x, &y);
    float stretch = sqrtf(2 / float_max(1 + vec3f_dot(axis, direction), 1e-3f));
    p[0] = (double)(stretch * vec3f_dot(x, direction));
    p[1] = (double)(stretch * vec3f_dot(y, direction));
}

/* Follows a photon again, by the same random numbers, from another start and in another colour; false: it goes another way. */
static bool follow_other(Job *job, Tracer *tracer, uint32_t number, const PhotonStart *start, double more_color,
                         uint32_t way, Photon *photon)
{
    Path path = begin_photon(tracer, job->hopes, job->seed, number);
    float nm = lanes_get(path.wavelengths.nm, 0);
    if (more_color != 0) lanes_set(&path.wavelengths.nm, 0, guide_wavelength(guide_color(nm) + (float)more_color));
    if (!photon_leave_light(&path, start)) return false;
    path.bounce = 1;
    return follow_photon(&path, &start->light, 1, photon) && photon->way == way;
}

/* more_color: by how much the other's colour is another one; 0: it is its start. */
static bool find_column(Job *job, Tracer *tracer, const PhotonStart *start, double more_color, double step,
                        const Photon *photon, Column *column)
{
    Photon other;
    if (!follow_other(job, tracer, photon->number, start, more_color, photon->way, &other)) return false;
    in_plane(photon->from, other.from, column->direction);
    Vec3 moved = vec3_sub(vec3_from_f(other.position), vec3_from_f(photon->position));
    column->place[0] = moved.x / step;
    column->place[1] = moved.y / step;
    column->place[2] = moved.z / step;
    for (int i = 0; i < 2; i++) column->direction[i] /= step;
    return true;
}

/* In which directions the light is seen from the start's point: mean and covariance, in the plane at its direction. Parts
 * of one object count as one light. */
static void look_at_light(const Path *path, const PhotonStart *start, double mean[2], double spread[3])
{
    const LightSample *light = &start->light;
    const World *world = path->tracer->world;
    const uint32_t object = light_sample_object(world, light);
    double n = 0, p[2], sums[5] = {0};
    for (uint32_t i = 0; i < LOOKS; i++) {
        Path look = *path;
        look.sampler = sampler_make_alone(path->sampler.pixel, PHOTON_PIXEL_X, path->sampler.index_reversed, i);
        LightSample other;
        photon_choose_light(&look, start, start->point, vec3f(0, 0, 0), &other);
        if (!(other.pdf_w > 0) || other.delta || light_sample_object(world, &other) != object ||
            other.glow != light->glow || vec3f_dot(other.direction, light->direction) < 0.9f ||
            lanes_mean(other.radiance) < 0.25f * lanes_mean(light->radiance))
            continue;
        in_plane(light->direction, other.direction, p);
        n++;
        sums[0] += p[0], sums[1] += p[1];
        sums[2] += p[0] * p[0], sums[3] += p[0] * p[1], sums[4] += p[1] * p[1];
    }
    if (n < 3) { /* too seldom chosen: a guess */
        mean[0] = mean[1] = spread[1] = 0;
        spread[0] = spread[2] = 1e-5;
        return;
    }
    mean[0] = sums[0] / n, mean[1] = sums[1] / n;
    spread[0] = sums[2] / n - mean[0] * mean[0] + 1e-10;
    spread[1] = sums[3] / n - mean[0] * mean[1];
    spread[2] = sums[4] / n - mean[1] * mean[1] + 1e-10;
}

/* inverse of a symmetric 3 x 3 matrix: xx xy xz yy yz zz */
static bool invert_symmetric(const double m[6], double inverse[3][3])
{
    double a = m[0], b = m[1], c = m[2], d = m[3], e = m[4], f = m[5];
    double determinant = a * (d * f - e * e) + b * (c * e - b * f) + c * (b * e - c * d);
    if (!(determinant > 0)) return false;
    double parts[6] = {d * f - e * e, c * e - b * f, b * e - c * d, a * f - c * c, b * c - a * e, a * d - b * b};
    for (int i = 0, m_ = 0; i < 3; i++)
        for (int k = i; k < 3; k++, m_++) inverse[i][k] = inverse[k][i] = parts[m_] / determinant;
    return true;
}

/* Photons that start within some distance and from all of the light are, to first order, a normal distribution of places
 * and directions: what it says of directions at a given place. */
static void condition(const Column *columns, int n, const double shift[2], Photon *photon)
{
    double xx[6] = {0}, dx[2][3] = {{0}}, dd[3] = {0}, inverse[3][3];
    for (int c = 0; c < n; c++) {
        const double *x = columns[c].place, *d = columns[c].direction;
        for (int i = 0, m = 0; i < 3; i++) {
            for (int k = i; k < 3; k++) xx[m++] += x[i] * x[k];
            for (int k = 0; k < 2; k++) dx[k][i] += d[k] * x[i];
        }
        dd[0] += d[0] * d[0], dd[1] += d[0] * d[1], dd[2] += d[1] * d[1];
    }
    /* Against what rounding leaves. As much as that is added to places, their directions spread: with 1e-6, the sun's image in a ball
     * was 60 times too large, and so were the samples of its light. */
    double ridge = 1e-10 * (xx[0] + xx[3] + xx[5]);
    xx[0] += ridge, xx[3] += ridge, xx[5] += ridge;
    if (!invert_symmetric(xx, inverse)) return;
    double slope[2][3] = {{0}};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++)
            for (int l = 0; l < 3; l++) slope[k][i] += dx[k][l] * inverse[l][i];
    for (int i = 0; i < 3; i++) {
        dd[0] -= slope[0][i] * dx[0][i];
        dd[1] -= slope[0][i] * dx[1][i];
        dd[2] -= slope[1][i] * dx[1][i];
    }
    for (int k = 0; k < 2; k++) { /* the middle of the light, seen from the photon's place */
        double mean = 0;
        for (int c = 2; c < 4; c++) {
            mean += shift[c - 2] * columns[c].direction[k];
            for (int i = 0; i < 3; i++) mean -= slope[k][i] * shift[c - 2] * columns[c].place[i];
        }
        photon->mean[k] = (float)mean;
        photon->slope[k] = vec3f_from(vec3(slope[k][0], slope[k][1], slope[k][2]));
    }
    for (int i = 0; i < 3; i++) photon->spread[i] = (float)dd[i];
    if (!(photon->spread[0] >= 0 && photon->spread[2] >= 0 && isfinite(photon->mean[0] + photon->mean[1]) &&
          isfinite(photon->spread[0] + photon->spread[1] + photon->spread[2]) && isfinite(photon->slope[0].x)))
        photon->spread[0] = photon->spread[2] = 0;
    if (photon->spread[0] > 0) photon->spread[0] += 1e-12f, photon->spread[2] += 1e-12f;
}

/* One of a photon's neighbours; tried to both sides, and then nearer. turn: which axis, of places and then of directions.
 * false: all of them go another way. */
static bool find_neighbour(Job *job, Path *path, const PhotonStart *start, int axis, double step, const Photon *photon,
                           Column *column)
{
    const double range = 0.1; /* of the target's size: how far the first order is taken to hold */
    const double steps[] = {1, -1, 1.0 / 16, -1.0 / 16};
    const World *world = job->world;
    Vec3f tangent[2];
    for (size_t i = 0; i < COUNT_OF(steps); i++) {
        PhotonStart other = *start;
        double by = steps[i] * step, unit = 1;
        if (axis < 2) { /* another place, the same light's point */
            sampling_basis(vec3f_from(start->normal), &tangent[0], &tangent[1]);
            other.point = vec3_along(start->point, by * start->size, vec3_from_f(tangent[axis]));
            photon_choose_light(path, start, other.point, vec3f(0, 0, 0), &other.light);
            if (light_sample_object(world, &other.light) != light_sample_object(world, &start->light) ||
                other.light.glow != start->light.glow ||
                vec3f_dot(other.light.direction, start->light.direction) < 0.98f)
                continue;
            unit = range;
        } else { /* the same place, another direction */
            sampling_basis(start->light.direction, &tangent[0], &tangent[1]);
            other.light.direction = vec3f_normalize(vec3f_along(start->light.direction, (float)by, tangent[axis - 2]));
            other.turned = start->light.direction;
        }
        if (find_column(job, path->tracer, &other, 0, by / unit, photon, column)) return true;
    }
    return false;
}

/* What has no part in directions: anywhere along the photon's way through a medium; or off its surface, on which all places are, so
 * that these alone would not tell how directions depend on that. */
static Column apart_from(Vec3f along, double reach)
{
    return (Column){{reach * (double)along.x, reach * (double)along.y, reach * (double)along.z}, {0, 0}};
}

/* Finds the photon's neighbours by following four more from starts near by: I.e., its differentials, after L. Schjoth, J.
 * R. Frisvad, K. Erleben, J. Sporring, "Photon Differentials", GRAPHITE (2007). Where one goes another way, nothing is
 * known. */
static void find_neighbours(Job *job, Path *path, const PhotonStart *start, Photon *photon)
{
    const double near = 5e-4; /* of the target's size */
    Column columns[5];
    double mean[2], spread[3];
    int n = 4;
    look_at_light(path, start, mean, spread);
    double a = sqrt(spread[0]), b = spread[1] / a, c = sqrt(fmax(spread[2] - b * b, 1e-12));
    double turn = fmin(fmax(0.3 * sqrt(spread[0] + spread[2]), 2e-4), 1e-2);
    for (int i = 0; i < n; i++)
        if (!find_neighbour(job, path, start, i, i < 2 ? near : turn, photon, &columns[i])) return;
    /* by the light's own axes: direction = mean + (a, b) s + (0, c) t */
    Column first = columns[2], second = columns[3];
    double shift[2] = {mean[0] / a, (mean[1] - b * mean[0] / a) / c};
    for (int i = 0; i < 3; i++) {
        columns[2].place[i] = a * first.place[i] + b * second.place[i];
        columns[3].place[i] = c * second.place[i];
    }
    for (int i = 0; i < 2; i++) {
        columns[2].direction[i] = a * first.direction[i] + b * second.direction[i];
        columns[3].direction[i] = c * second.direction[i];
    }
    const bool in_medium = vec3f_dot(photon->normal, photon->normal) == 0;
    columns[n++] = apart_from(in_medium ? photon->from : photon->normal, start->size);
    condition(columns, n, shift, photon);
}

/* How the direction in which the light is seen from a place depends on the colour by which glass bends it, from what its slopes by
 * the place are. */
static void find_hue(Job *job, Path *path, const PhotonStart *start, Photon *photon)
{
    const double step = 0.04;   /* some 10 nm */
    const float slight = 1e-4f; /* nothing, but for rounding */
    const float unknown = 0.5f; /* it goes another way, as most of the others may, too */
    Column more, less;
    if (!job->world->disperses || !(photon->spread[0] > 0)) return;
    bool is_more = find_column(job, path->tracer, start, step, step, photon, &more),
         is_less = find_column(job, path->tracer, start, -step, -step, photon, &less);
    photon->hue_bend = unknown;
    if (!is_more && !is_less) return;
    if (!is_more) more = less;
    if (!is_less) less = more;
    double bends[2];
    for (int k = 0; k < 2; k++) {
        double of_place[3] = {(double)photon->slope[k].x, (double)photon->slope[k].y, (double)photon->slope[k].z};
        double up = more.direction[k], down = less.direction[k];
        for (int i = 0; i < 3; i++) up -= of_place[i] * more.place[i], down -= of_place[i] * less.place[i];
        photon->hue[k] = (float)(0.5 * (up + down));
        bends[k] = (up - down) / (2 * step);
    }
    if (is_more && is_less) photon->hue_bend = (float)hypot(bends[0], bends[1]);
    bool known = isfinite(photon->hue[0] + photon->hue[1] + photon->hue_bend);
    if (known && fabsf(photon->hue[0]) + fabsf(photon->hue[1]) > slight) return;
    photon->hue[0] = photon->hue[1] = 0;
    photon->hue_bend = known ? 0 : unknown;
}

/* Where photon `number` starts, and its path there; false: it gives nothing. */
static bool start_photon(Job *job, Tracer *tracer, uint32_t number, Path *path, PhotonStart *start)
{
    *path = begin_photon(tracer, job->hopes, job->seed, number);
    if (!photon_choose_start(job->targets, path, start)) return false;
    float radiance = lanes_mean(start->light.radiance);
    if (!(radiance > job->threshold) || !photon_leave_light(path, start)) return false;
    path->bounce = 1;
    path->beta = lanes_scale(start->light.radiance, 1 / radiance);
    return true;
}

static void trace_batch(void *context, uint32_t batch, unsigned worker)
{
    Job *job = context;
    uint32_t end = job->n - batch * BATCH > BATCH ? (batch + 1) * BATCH : job->n;
    for (uint32_t i = batch * BATCH; i < end; i++) {
        uint32_t number = job->first + i;
        Path path;
        PhotonStart start;
        Photon *photon = &job->photons[i];
        *photon = (Photon){.flux = 0};
        if (is_stopped(job)) continue;
        if (!start_photon(job, &job->tracers[worker], number, &path, &start)) continue;
        float radiance = lanes_mean(start.light.radiance);
        const bool landed = follow_photon(&path, &start.light, radiance * start.flux_times_n, photon);
        if (job->counts) hopes_count(&job->counts[worker], path.probing.step, landed);
        if (landed) {
            photon->radiance = radiance;
            photon->more = start.more;
            photon->number = number;
            photon->color = guide_color(lanes_get(path.wavelengths.nm, 0));
        } else {
            photon->flux = 0;
        }
    }
}

static void look_around_one(void *context, uint32_t i, unsigned worker)
{
    Job *job = context;
    if (is_stopped(job)) return;
    Photon *photon = &job->photons[job->which[i]];
    Tracer *tracer = &job->tracers[worker];
    Path path = begin_photon(tracer, job->hopes, job->seed, photon->number);
    PhotonStart start = {.turned = {0, 0, 0}};
    photon->lobe = 1;
    tracer->counters.rays += LOOKS / 2; /* about what they take */
    if (!photon_choose_start(job->targets, &path, &start)) return;
    find_neighbours(job, &path, &start, photon);
    find_hue(job, &path, &start, photon);
}

/* Runs a task of the job's; *rays: how many it took. */
static Status run_job(Job *job, Pool *pool, uint32_t n, void (*task)(void *, uint32_t, unsigned), uint64_t *rays,
                      Error *error)
{
    unsigned n_threads = pool_threads(pool);
    job->tracers = tracers_new(job->world, n_threads);
    if (!job->tracers) return fail_memory(error, n_threads * sizeof(Tracer), "threads");
    pool_run(pool, n, task, job);
    bool out_of_memory = false;
    for (unsigned i = 0; i < n_threads; i++) {
        out_of_memory |= job->tracers[i].out_of_memory;
        *rays += job->tracers[i].counters.rays;
    }
    tracers_free(job->tracers, n_threads);
    return out_of_memory ? fail(error, STATUS_NOMEM, "out of memory while following photons") : STATUS_OK;
}

Status photons_trace(const PhotonSource *source, uint32_t first, uint32_t n, Pool *pool, Photon *photons, Hopes *hopes,
                     uint64_t *rays, Error *error)
{
    Job job = {.world = source->world,
               .targets = source->targets,
               .threshold = source->threshold,
               .seed = source->seed,
               .hopes = source->hopes,
               .first = first,
               .n = n,
               .photons = photons,
               .stop = source->stop};
    const unsigned n_threads = pool_threads(pool);
    if (hopes && !(job.counts = memory_apart(n_threads, sizeof *job.counts)))
        return fail_memory(error, n_threads * sizeof *job.counts, "photons");
    Status status = run_job(&job, pool, (n + BATCH - 1) / BATCH, trace_batch, rays, error);
    for (unsigned t = 0; hopes && t < n_threads; t++)
        for (int i = 0; i < HOPES; i++) {
            hopes->followed[i] += job.counts[t].followed[i];
            hopes->landed[i] += job.counts[t].landed[i];
        }
    free(job.counts);
    return status;
}

Status photons_look_around(const PhotonSource *source, Photon *photons, const uint32_t *which, uint32_t n, Pool *pool,
                           uint64_t *rays, Error *error)
{
    Job job = {.world = source->world,
               .targets = source->targets,
               .threshold = source->threshold,
               .seed = source->seed,
               .hopes = source->hopes,
               .photons = photons,
               .which = which,
               .stop = source->stop};
    return run_job(&job, pool, n, look_around_one, rays, error);
}

float photon_flux(const World *world, const PhotonTargets *targets)
{
    enum { PROBES = 4096 };
    Tracer tracer;
    tracer_init(&tracer, world);
    double flux = 0;
    for (uint32_t i = 0; i < PROBES; i++) {
        Path path = begin_photon(&tracer, NULL, 0, i);
        PhotonStart start = {.turned = {0, 0, 0}};
        if (photon_choose_start(targets, &path, &start))
            flux += (double)(lanes_mean(start.light.radiance) * start.flux_times_n);
    }
    tracer_clear(&tracer);
    return (float)(flux / PROBES);
}

float photon_other_light(Tracer *tracer, Vec3f place, Vec3f normal, float threshold, uint32_t number)
{
    Path path = begin_photon(tracer, NULL, 1, number);
    Box3 bounds = rtc_scene_bounds(tracer->world->compiled->rtc);
    Vec3 from = vec3_from_f(place);
    LightSample light;
    photon_choose_light(&path, NULL, from, normal, &light);
    float cosine = vec3f_dot(normal, normal) > 0 ? vec3f_dot(light.direction, normal) : 1;
    if (!(light.pdf_w > 0) || light.delta || !(cosine > 0)) return 0;
    /* started off the surface by what may be too much for a picture */
    double off = 1e-5 * (box3_is_empty(bounds) ? vec3_length(vec3_sub(from, tracer->world->camera.from))
                                               : vec3_length(vec3_sub(bounds.max, bounds.min)));
    Ray ray = ray_make(vec3_along(from, off, vec3_from_f(normal)), light.direction);
    ray.time = path.ray.time;
    Lanes transmittance;
    uint32_t medium;
    if (compiled_interior(tracer->world->compiled, vec3f_from(ray.origin), ray.time, &tracer->hits, &tracer->list,
                          NULL) != STATUS_OK ||
        !path_sees_light(&path, &light, &ray, &transmittance, &medium))
        return 0;
    float radiance = lanes_mean(lanes_mul(light.radiance, transmittance));
    return radiance * cosine / light.pdf_w * (lanes_mean(light.radiance) > threshold ? PHOTON_BRIGHT_PART : 1);
}

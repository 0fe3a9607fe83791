/* sample.c - a sample of a pixel: its path from the camera, or two where wavelengths go different ways.
 *
 * Where the index of a medium changes with the wavelength, each of a path's four would be bent another way at a boundary. If one of
 * them went on alone, as in [WNDWH14], what is behind glass would be seen in one colour of the rainbow a sample, and these
 * colours would be most of the noise. So a path bends all of its wavelengths alike, by the indices of one of them, k: as if the
 * scene were seen through glass that does not disperse. It finds L(j, k) of each wavelength j, where L(k, k) is what is
 * asked for. Where it comes to a boundary that tells them apart, a second path follows by the same random numbers, by the
 * indices of another of the four, m. Mostly both see nearly the same. The four radiances of the sample are then
 *     at k       2 L(k, k) - 2 s L(k, m)
 *     at m       2 L(m, m) - 2 s L(m, k)
 *     at others  s (L(j, k) + L(j, m))
 * k and m are any two, as likely as any others: in the mean over them j has 2 L(j, j) half of the time, and of each L(j, k)
 * with k not j it has -2 s one time in six and s two times in six, which is nothing. So there is no bias, whatever s is. With s = 1/2
 * a sample of what does not depend on the indices has no noise of colours; where the two paths see nothing alike, 0 has the
 * least. Measured with SHARED, which is between, the squared error of one wavelength that goes on alone, after 16 samples and
 * after equal time (bench sampling): still-life 3.0 and 1.8, cut-glass 2.7 and 1.7, round-solids 2.8 and 1.7. A second path for
 * half of the samples, which then has to make up for the others, too: still-life 1.2, cut-glass 0.8, round-solids 1.1.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/event.h"

#define SHARED 0.4f /* s */

/* The boundary, of one surface, where a sample's first path comes to be bent apart, for the second one to go on from there: the path in
 * front of it, and the event; the list in front is tracer->forked. */
typedef struct PathFork {
    bool kept;
    Path path;
    Event event;
} PathFork;

/* The list where a ray of an orthographic camera starts. A way to there from the camera's centre would be long, and its float
 * direction miss the place by more than that place is apart from surfaces; so the list is looked for anew, at a place of floats,
 * where the ray then starts. */
static bool list_in_picture_plane(Path *path)
{
    Tracer *tracer = path->tracer;
    path->ray.origin = vec3_rounded(path->ray.origin);
    tracer->counters.rays += 2;
    return compiled_interior(tracer->world->compiled, vec3f_from(path->ray.origin), path->ray.time,
                             &tracer->shadow_hits, &tracer->list, NULL) == STATUS_OK;
}

/* The list at the ray's real origin: from the camera's centre on along the lens. */
static bool start_list(Path *path, const SceneCamera *camera)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const NestList *known = lens_list_at(world->lens, path->ray.origin);
    if (known) return nest_list_copy(&tracer->list, known) == STATUS_OK;
    if (UNLIKELY(world->lens_crosses) && camera->projection == PROJECTION_ORTHOGRAPHIC)
        return list_in_picture_plane(path);
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
        if (!path_cross(tracer, &tracer->list, &tracer->shadow_hits.items[i], 1, &crossing)) return false;
    return true;
}

/* A place after the pixel's filter: u in [0,1) to an offset from its middle, with a tent of radius 1 in (-1, 1). */
static double filtered(bool box, float u)
{
    if (box) return (double)u - 0.5;
    double v = 2 * (double)u, from_end = double_min(v, 2 - v);
    return copysign(1 - sqrt(from_end), v - 1); /* which half it is in, no branch could foretell */
}

/* A pixel's samples follow each other, and have most of what their first numbers take in common. */
static const PixelSampler *find_sampler(Tracer *tracer, const FilmSample *sample)
{
    const uint32_t seed = sample->seed, x = sample->x, y = sample->y, index = sample->index;
    PixelSampler *pixel = &tracer->pixel;
    SamplePattern pattern = tracer->world->trial.pattern;
    bool alike = LIKELY(pattern != PATTERN_INDEPENDENT);
    if (!alike || !pixel->made || pixel->seed != seed || pixel->x != x || pixel->y != y) {
        Sampler first = LIKELY(pattern == PATTERN_SHARED) ? sampler_make(seed, x, y, 0)
                        : alike                           ? sampler_make_alone(seed, x, y, 0)
                                                          : sampler_make_independent(seed, x, y, index);
        *pixel = (PixelSampler){.made = true, .seed = seed, .x = x, .y = y, .sampler = first};
        pixel->place = sampler_stream(&first, DIM_PIXEL);
        pixel->wavelength = sampler_stream(&first, DIM_WAVELENGTH);
    }
    if (alike) pixel->sampler.index_reversed = reverse_bits(index);
    return pixel;
}

/* Lanes of the wavelengths whose indices the first path of a sample takes, and the second. */
typedef struct IndexLanes {
    int first, second;
} IndexLanes;

/* The first is the one that is spread most evenly over a pixel's samples; the hero is any of the four, whatever these two are, so
 * that each is the hero as often as the balance heuristic takes it to be. */
static IndexLanes choose_indices(const PixelSampler *pixel, WavelengthSample *wavelengths)
{
    int choice = (int)(sampler_1d(&pixel->sampler, DIM_INDICES) * (LANES * (LANES - 1)));
    IndexLanes lanes = {.first = choice / (LANES - 1)};
    lanes.second = (lanes.first + 1 + choice % (LANES - 1)) % LANES;
    wavelengths->nm = lanes_exchange(wavelengths->nm, lanes.first);
    wavelengths->pdf = lanes_exchange(wavelengths->pdf, lanes.first);
    return lanes;
}

static Lanes share_out(Lanes first, Lanes second, IndexLanes at)
{
    Lanes sum = lanes_scale(lanes_add(first, second), SHARED);
    lanes_set(&sum, at.first, 2 * lanes_get(first, at.first) - 2 * SHARED * lanes_get(second, at.first));
    lanes_set(&sum, at.second, 2 * lanes_get(second, at.second) - 2 * SHARED * lanes_get(first, at.second));
    return sum;
}

static WavelengthSample choose_wavelengths(const World *world, const PixelSampler *pixel)
{
    const Sampler *sampler = &pixel->sampler;
    if (UNLIKELY(world->trial.wavelengths_by_chance))
        return world_wavelengths(world, hash_to_unit_f(sampler_key(sampler, DIM_WAVELENGTH)));
    return world_wavelengths(world, sampler_stream_1d(&pixel->wavelength, sampler->index_reversed));
}

static void set_colors(Path *path, IndexLanes lanes)
{
    const World *world = path->tracer->world;
    if (LIKELY(!world->guide) || !world->disperses) return;
    if (lanes.first < 0) lanes.first = lanes.second = 0; /* the hero alone */
    path->colors[0] = guide_color(lanes_get(path->wavelengths.nm, lanes.first));
    path->colors[1] = guide_color(lanes_get(path->wavelengths.nm, lanes.second));
    path->color = path->colors[path->again];
}

bool path_begin_at_camera(Path *path, FilmPoint point)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    float lens[2] = {0, 0};
    if (world->camera.lens_radius > 0) sampler_2d(&path->sampler, DIM_LENS, lens);
    double time = world->moves ? (double)sampler_1d(&path->sampler, DIM_TIME) : 0;
    SceneCamera moved;
    const SceneCamera *camera = &world->camera;
    if (camera->keys) {
        moved = scene_camera_at(world->scene, camera, time);
        camera = &moved;
    }
    Footprint footprint;
    if (UNLIKELY(!camera_ray(camera, point, lens, &path->ray, &footprint))) return false;
    path->ray.time = time;
    path->ray.sight = true;
    path->cone_width = footprint.width;
    path->cone_spread = footprint.spread;
    if (LIKELY(start_list(path, camera))) return true;
    tracer->out_of_memory = true;
    return false;
}

/* fork: where the second path is to begin; NULL: this is the second one. False where there is nothing to look at. */
static bool follow_path(Tracer *tracer, const PixelSampler *pixel, FilmPoint point, const WavelengthSample *wavelengths,
                        IndexLanes lanes, PathFork *fork, Path *path)
{
    const World *world = tracer->world;
    path_init(path, tracer, pixel->sampler);
    path->looks = world->seeks_airlight;
    path->decision.of_pixel = LIKELY(!world->trial.choices_apart);
    path->wavelengths = *wavelengths;
    path->index_lane = fork ? lanes.first : lanes.second;
    path->again = !fork;
    set_colors(path, lanes);
    path->fork = fork;
    if (UNLIKELY(world->bare != NULL)) {
        path->catching = &tracer->catching[path->again];
        *path->catching = (Catching){.bare = lanes_all(0)};
    }
    tracer->reflected.mean = -1;
    if (UNLIKELY(!path_begin_at_camera(path, point))) {
        tracer->seen = SCENE_NONE;
        tracer->first_sight = (FirstSight){.object = SCENE_NONE, .medium = SCENE_NONE, .through = SCENE_NONE};
        tracer->behind = tracer->first_sight;
        return false;
    }
    path_follow_from_camera(path);
    return true;
}

/* The second path begins where the wavelengths part, as up to there it would be the first one. Where a probe has parted before, or
 * several surfaces are there at once, it begins at the camera. The light is the same to the last bit; the time, of that with all
 * from the camera: cut-glass 0.935, diamond 0.96, shapes 0.97. */
void path_keep_fork(Path *path, const Event *event)
{
    Tracer *tracer = path->tracer;
    PathFork *fork = path->fork;
    path->fork = NULL;
    fork->kept = event->n_cluster == 1 && LIKELY(!tracer->world->trial.pairs_from_camera) &&
                 nest_list_copy(&tracer->forked, &tracer->list) == STATUS_OK;
    if (!fork->kept) return;
    fork->path = *path;
    fork->path.n_counted--; /* it is yet to cross it */
    if (UNLIKELY(tracer->grouped)) memcpy(tracer->groups[1], tracer->groups[0], sizeof tracer->groups[0]);
    fork->event = *event;
}

static Lanes follow_fork(Tracer *tracer, PathFork *fork, int index_lane)
{
    Path *path = &fork->path;
    path->index_lane = index_lane;
    path->again = true;
    path->color = path->probing.guide.color = path->colors[1];
    memset(path->media.ior_of, 0, sizeof path->media.ior_of);
    nest_list_swap(&tracer->list, &tracer->forked);
    if (hit_list_copy(&tracer->hits, &fork->event.hit, 1) &&
        (fork->event.behind != BEHIND_IN_NEXT || path_cross_into_next(tracer, &fork->event)))
        path_follow_from_event(path, &fork->event);
    else
        tracer->out_of_memory = true;
    return path->radiance;
}

/* The second path of a sample. What is told of a sample besides its light is of the first one; but what it shows is what scatters
 * in front, if this one has more light than the first, from there. */
static Lanes follow_again(Tracer *tracer, const PixelSampler *pixel, FilmPoint point,
                          const WavelengthSample *wavelengths, IndexLanes lanes, PathFork *fork, const Path *first)
{
    if (LIKELY(fork->kept)) return follow_fork(tracer, fork, lanes.second);
    Path path;
    uint32_t seen = tracer->seen;
    bool notes_sight = tracer->notes_sight;
    tracer->notes_sight = false;
    (void)follow_path(tracer, pixel, point, wavelengths, lanes, NULL, &path);
    tracer->notes_sight = notes_sight;
    if (!(path_shows_front(&path) && lanes_mean(path.radiance) > lanes_mean(first->radiance))) tracer->seen = seen;
    return path.radiance;
}

/* What a sample caught, of paths whose light from catchers on comes to these lanes; that becomes all of the light. */
static void take_caught(Tracer *tracer, const WavelengthSample *wavelengths, IndexLanes lanes, bool forked, bool kept,
                        Lanes *radiance)
{
    const Catching *first = &tracer->catching[0], *second = kept ? first : &tracer->catching[1];
    CaughtSample *caught = &tracer->caught;
    caught->part = first->part;
    if (!(first->part > 0) && !(forked && second->part > 0)) return;
    Lanes lit = *radiance, bare = first->bare, front = first->front;
    if (forked) {
        bare = share_out(first->bare, second->bare, lanes);
        front = share_out(first->front, second->front, lanes);
    }
    if (first->alike || second->alike) bare = lit;
    color_from_lanes(lit, wavelengths, caught->lit);
    color_from_lanes(bare, wavelengths, caught->bare);
    *radiance = lanes_add(front, lit);
    for (int i = 0; i < 3; i++)
        if (!isfinite(caught->lit[i]) || !isfinite(caught->bare[i])) *caught = (CaughtSample){.part = 0};
}

/* Before both paths of a sample: light of each group is nothing so far. */
static void clear_groups(Tracer *tracer)
{
    tracer->grouped = tracer->groups[0];
    for (uint32_t i = 0; i < tracer->world->scene->light_groups.n; i++)
        tracer->groups[0][i] = tracer->groups[1][i] = lanes_all(0);
}

/* What both paths found of each group becomes what the sample did, as all of their light does; of a bad one nothing. */
static void share_out_groups(Tracer *tracer, IndexLanes lanes, bool forked, bool bad)
{
    for (uint32_t i = 0; i < tracer->world->scene->light_groups.n; i++) {
        Lanes *sum = &tracer->groups[0][i];
        if (forked) *sum = share_out(*sum, tracer->groups[1][i], lanes);
        if (bad) *sum = lanes_all(0);
    }
    tracer->grouped = tracer->groups[0];
}

void trace_sample(Tracer *tracer, const FilmSample *sample, float rgb[3], float *alpha)
{
    const World *world = tracer->world;
    const PixelSampler *pixel = find_sampler(tracer, sample);
    float u[2];
    sampler_stream_2d(&pixel->place, pixel->sampler.index_reversed, u);
    bool box = world->scene->film.box;
    FilmPoint point = {(double)sample->x + 0.5 + filtered(box, u[0]), (double)sample->y + 0.5 + filtered(box, u[1]),
                       sample->width, sample->height};
    WavelengthSample wavelengths = choose_wavelengths(world, pixel);
    IndexLanes lanes = {-1, -1};
    if (world->disperses && LIKELY(!world->trial.hero_alone)) lanes = choose_indices(pixel, &wavelengths);
    Path path;
    PathFork fork;
    fork.kept = false;
    if (UNLIKELY(tracer->tells_groups)) clear_groups(tracer);
    bool looks = follow_path(tracer, pixel, point, &wavelengths, lanes, &fork, &path);
    const bool forked = path.bent_apart && lanes.first >= 0;
    tracer->counters.paths++;
    if (forked) {
        tracer->grouped = tracer->tells_groups ? tracer->groups[1] : NULL;
        path.radiance =
            share_out(path.radiance, follow_again(tracer, pixel, point, &wavelengths, lanes, &fork, &path), lanes);
    }
    if (UNLIKELY(world->bare != NULL)) take_caught(tracer, &wavelengths, lanes, forked, fork.kept, &path.radiance);
    *alpha = looks ? 1 - path.open : 0;
    color_from_lanes(path.radiance, &wavelengths, rgb);
    const bool bad = !isfinite(rgb[0]) || !isfinite(rgb[1]) || !isfinite(rgb[2]) || !isfinite(*alpha);
    if (UNLIKELY(tracer->tells_groups)) share_out_groups(tracer, lanes, forked, bad);
    if (UNLIKELY(bad)) {
        tracer->counters.bad_samples++;
        rgb[0] = rgb[1] = rgb[2] = 0;
        *alpha = 1;
        tracer->caught.part = 0;
        path.radiance = lanes_all(0);
    }
    tracer->light = (SampleLight){path.radiance, wavelengths};
}

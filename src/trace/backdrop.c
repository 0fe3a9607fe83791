/* backdrop.c - see backdrop.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/backdrop.h"

void backdrop_note(Backdrop *backdrop, const Path *path, const float brightness[2])
{
    if (backdrop->noted || path->again || brightness[0] != 1 || brightness[1] != 1) return;
    backdrop->noted = true;
    backdrop->before = path->radiance;
    backdrop->carried = path_carried(path);
}

void backdrop_end(Backdrop *backdrop, const Path *path)
{
    const double most = 64; /* one path that is far brighter than all others tells of itself alone */
    if (path->again) return;
    float carried = lanes_mean(backdrop->carried);
    if (backdrop->noted && carried > 0) {
        float found = lanes_mean(lanes_sub(path->radiance, backdrop->before)) / carried;
        double brightness = double_min((double)found / backdrop->unit, most);
        if (isfinite(brightness)) backdrop->squares += brightness * brightness, backdrop->n++;
    }
    backdrop->noted = false;
}

Status backdrop_find(const World *world, double *brightness, Error *error)
{
    enum { SIDE = 24, MOST = SIDE * SIDE, LEAST = 16 };
    const double darkest = 1.0 / 16;
    const SceneFilm *film = &world->scene->film;
    Backdrop backdrop = {.unit = world->beacons.mean};
    Tracer tracer;
    tracer_init(&tracer, world);
    tracer.backdrop = &backdrop;
    for (uint32_t i = 0; i < MOST && backdrop.squares < MOST && !tracer.out_of_memory; i++) {
        FilmSample sample = film_sample_in_cell(i, SIDE, film->width, film->height);
        sample.index = i;
        float rgb[3], alpha;
        trace_sample(&tracer, &sample, rgb, &alpha);
    }
    bool enough = !tracer.out_of_memory;
    tracer_clear(&tracer);
    double mean = backdrop.n < LEAST ? 1 : backdrop.squares / backdrop.n;
    *brightness = double_max(double_min(sqrt(mean), 1), darkest);
    return enough ? STATUS_OK : fail(error, STATUS_NOMEM, "out of memory for a first look at the scene");
}

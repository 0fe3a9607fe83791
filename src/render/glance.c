/* glance.c - see glance.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/glance.h"

#include "base/luminance.h"
#include "trace/path.h"

/* Places each way, and paths of each. */
enum { SIDE = 32, PATHS = 4 };

Status glance(const World *world, uint32_t width, uint32_t height, Brightness *brightness, Error *error)
{
    Tracer tracer;
    tracer_init(&tracer, world);
    *brightness = (Brightness){0};
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        FilmSample sample = film_sample_in_cell(i, SIDE, width, height);
        double luminance = 0, covers = 0;
        for (; sample.index < PATHS; sample.index++) {
            float rgb[3], alpha;
            trace_sample(&tracer, &sample, rgb, &alpha);
            luminance += (double)color_luminance(rgb) / PATHS;
            covers += (double)alpha;
        }
        if (covers > 0) brightness_note(brightness, luminance);
    }
    bool enough = !tracer.out_of_memory;
    tracer_clear(&tracer);
    return enough ? STATUS_OK : fail(error, STATUS_NOMEM, "out of memory for a first look at the picture");
}

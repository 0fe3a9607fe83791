/* render.h - renders a compiled scene to a film, pass by pass, and says how it goes.
 * Nothing here prints: progress goes through a callback on the calling thread.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RENDER_H
#define MEN_RENDER_H

#include <signal.h>

#include "base/pool.h"
#include "image/image.h"
#include "scene/compile.h"
#include "trace/guide.h"

/* Of a pixel when there is a noise to be reached and nobody says how many. */
enum { RENDER_MOST_SAMPLES = 4096 };

typedef struct RenderSettings {
    uint32_t width, height;
    uint32_t crop[4];           /* x0, y0, x1, y1; all 0: the whole frame */
    uint32_t samples;           /* per pixel; with a noise: at most */
    uint32_t first_sample;      /* for slices; 0 */
    double noise;               /* each pixel stops at this error, as adapt.h has it; 0: none does */
    double time_limit_s;        /* 0: none */
    uint32_t bounces, seed, camera;
    AovSet aovs;                /* further channels */
    bool spreads;               /* samples that stand alone are given to what is around them, see spread.h */
    bool no_absorption;         /* media neither absorb nor emit: for tests */
    SceneCaustics caustics;     /* whether photons look for light behind glass first */
    bool by_chance;             /* no light is looked for, all are found by scattering alone: for tests */
    bool no_airlight;           /* within media light is looked for only where paths are scattered: for tests */
    Trial trial;                /* other ways to take samples: for tests */
} RenderSettings;

typedef struct RenderProgress {
    uint32_t samples_done, samples_total; /* per pixel */
    double fraction;                      /* 0..1 of the work */
    double seconds;                       /* since the start */
    double seconds_left_low, seconds_left_high; /* negative: not known yet */
    double photons;                       /* 0..1 of those that are followed first; < 0: these are done, or none */
    double noise;                         /* of the picture so far, as adapt.h has it; < 0: not known */
    double noise_wanted;                  /* of each pixel; 0: none */
    uint64_t paths, rays;
} RenderProgress;

typedef struct RenderStats {
    uint64_t paths, rays;       /* rays: calls of the ray tracer, closest and shadow */
    uint64_t crossings;         /* surfaces of hulls crossed, silent ones included */
    uint64_t silent_crossings;
    uint64_t nesting_faults;    /* direction and list disagreed */
    uint64_t silent_limit;      /* paths given up at the limit of silent crossings */
    uint64_t bad_samples;       /* not finite; left out */
    uint64_t saturated_samples; /* brighter than the film can hold; held at its limit */
    uint64_t spread_samples;    /* that stood alone and were given to what is around them, */
    double spread_light;        /* and the part of the picture's light that they brought */
    double seconds, cpu_seconds;
    uint32_t samples;           /* per pixel, done everywhere: the least that a pixel has */
    uint32_t most_samples;      /* and the most */
    double mean_samples;
    double noise;               /* of the picture, as adapt.h has it; < 0: not known */
    uint64_t noisy_pixels;      /* that are above the noise that was wanted, with the most samples that they may have */
    GuideStats guide;           /* photons that looked for light behind glass, and what they have found */
    bool stopped;               /* by the stop flag or the time limit, before all samples */
} RenderStats;

typedef struct RenderEvents {
    void *context;
    void (*progress)(void *context, const RenderProgress *progress); /* some times a second; may be NULL */
    const volatile sig_atomic_t *stop; /* not NULL and not 0: finish the tile, then return; may be NULL */
    /* The picture so far, with channels R G B A: at first of every fourth, then of every second pixel each way, with what is
     * between filled in, then between passes, about once a second, and at the end. On the calling thread, while the others
     * wait. May be NULL; what is rendered does not depend on it. */
    void (*picture)(void *context, const Image *image);
} RenderEvents;

/* Renders. *image gets channels R G B A, "noise.Y" (standard error of the luminance), and those of the AOVs, by
 * width x height (outside of a crop 0). Same bits for any number of threads. STATUS_RENDER, STATUS_NOMEM. */
ATTR_NODISCARD Status render_image(const CompiledScene *compiled, const RenderSettings *settings, Pool *pool,
                                   const RenderEvents *events, Image *image, RenderStats *stats, Error *error);

#endif

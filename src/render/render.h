/* render.h - renders a compiled scene to a film, pass by pass, and says how it goes.
 * Nothing here prints: progress goes through a callback on the calling thread.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RENDER_H
#define MEN_RENDER_H

#include <signal.h>

#include "base/pool.h"
#include "render/aov_film.h"
#include "render/brightness.h"
#include "scene/compile.h"
#include "trace/guide.h"

struct RenderState;

/* Of a pixel when there is a noise to be reached and nobody says how many. */
enum { RENDER_MOST_SAMPLES = 4096 };

typedef struct RenderSettings {
    uint32_t width, height;
    uint32_t crop[4]; /* x0, y0, x1, y1; all 0: the whole frame */
    uint32_t samples; /* per pixel; with a noise: at most; adaptive: in the mean */
    uint32_t first_sample,
        end_sample;  /* for slices, neither with a noise nor adaptive: only these, without the last; both 0: all */
    bool repeatable; /* a time limit does not shorten the search for caustics, which is left then and gone on with: the
                          * picture of so many samples is the same however fast it goes */
    double noise;    /* each pixel stops at this error, as adapt.h has it; 0: none does */
    bool adaptive;   /* without a noise: pixels get samples as their errors need them, as adapt.h has it */
    Exposure exposure;   /* with which the picture is shown: noise is in relation to what is white then */
    double time_limit_s; /* 0: none */
    uint32_t bounces, seed, camera;
    AovSet aovs;            /* further channels */
    bool spreads;           /* samples that stand alone are given to what is around them, see spread.h */
    bool denoises;          /* the noise that is left is averaged away, see denoise.h */
    bool no_absorption;     /* media neither absorb nor emit: for tests */
    SceneCaustics caustics; /* whether photons look for light behind glass first */
    bool by_chance;         /* no light is looked for, all are found by scattering alone: for tests */
    bool no_airlight;       /* within media light is looked for only where paths are scattered: for tests */
    Trial trial;            /* other ways to take samples: for tests */
} RenderSettings;

/* Whether pixels may have unlike numbers of samples, which depend on those before. */
static inline bool render_is_uneven(const RenderSettings *settings)
{
    return settings->noise > 0 || settings->adaptive;
}

typedef struct RenderProgress {
    uint32_t samples_done, samples_total;       /* per pixel */
    double fraction;                            /* 0..1 of the work */
    double seconds;                             /* since the start */
    double seconds_left_low, seconds_left_high; /* negative: not known yet */
    double photons;      /* 0..1 of those that are followed first; < 0: these are done, or none */
    double noise;        /* of the picture so far, as adapt.h has it; < 0: not known */
    double noise_wanted; /* of each pixel; 0: none */
    uint64_t paths, rays;
} RenderProgress;

typedef struct RenderStats {
    uint64_t paths, rays; /* rays: calls of the ray tracer, closest and shadow */
    uint64_t crossings;   /* surfaces of hulls crossed, silent ones included */
    uint64_t silent_crossings;
    uint64_t nesting_faults;    /* direction and list disagreed */
    uint64_t silent_limit;      /* paths given up at the limit of silent crossings */
    uint64_t bad_samples;       /* not finite; left out */
    uint64_t saturated_samples; /* brighter than the film can hold; held at its limit */
    uint64_t spread_samples;    /* that stood alone and were given to what is around them, */
    double spread_light;        /* and the part of the picture's light that they brought, */
    double spread_one_colored;  /* and of that, what came by samples of one colour of many */
    double seconds, cpu_seconds;
    uint32_t samples;      /* per pixel, done everywhere: the least that a pixel has */
    uint32_t most_samples; /* and the most */
    double mean_samples;
    double noise;          /* of the picture, as adapt.h has it; < 0: not known */
    uint64_t noisy_pixels; /* that are above the noise that was wanted, with the most samples that they may have */
    GuideStats guide;      /* photons that looked for light behind glass, and what they have found */
    bool stopped;          /* by the stop flag or the time limit, before all samples */
    bool searching; /* and before all photons: the picture is one without caustics, of samples that the state has not */
} RenderStats;

typedef struct RenderEvents {
    void *context;
    void (*progress)(void *context, const RenderProgress *progress); /* some times a second; may be NULL */
    const volatile sig_atomic_t *stop; /* not NULL and not 0: finish the pixel, then return; may be NULL */
    /* The picture so far, with channels R G B A: at first of every fourth, then of every second pixel each way, with what is
     * between filled in, then between passes, about once a second, and at the end. On the calling thread, while the others
     * wait. May be NULL; what is rendered does not depend on it. */
    void (*picture)(void *context, const Image *image);
    /* What there is so far, to be kept: about every save_interval_s, but for at most a hundredth of the time, and soon after
     * *wish is not 0, which becomes 0 then (asked). On the calling thread, while the others wait. save and wish may be NULL,
     * save_interval_s 0: only when asked. What is rendered does not depend on it. */
    void (*save)(void *context, const struct RenderState *state, bool asked);
    volatile sig_atomic_t *wish;
    double save_interval_s;
    /* The render was stopped, and the state is what it goes on from. The picture is not made so far, which takes its time. May be
     * NULL; not called where the samples will not stay. */
    void (*stopped)(void *context);
} RenderEvents;

/* All that the samples of a render, or of a slice of it, have come to: with the scene, the settings and this it goes on as if it
 * had never ended. */
typedef struct RenderState {
    Film film;
    BrightFilm bright; /* without pixels: single bright samples stay where they are */
    AovFilm aovs;
    ImagePlace place; /* of the film in the frame */
    uint32_t *wanted; /* of each pixel by rows, as adapt.h has it, where it is being done; else NULL */
    PathCounters counters;
    uint64_t saturated_samples;
    uint32_t guide_samples; /* of each pixel, that caustics were looked for for; 0: they were not, yet */
    GuideSearch *search;    /* that; NULL: as guide_samples of 0, or it is not known any more, and made anew */
} RenderState;

void render_state_clear(RenderState *state);
bool render_state_is_empty(const RenderState *state); /* without any sample */
/* Whether there is anything to go on from: samples, or photons. */
bool render_state_is_worth_keeping(const RenderState *state);
/* What a state means: the picture, and what stats has of it (not the time, nor what the guide did). exposure: as in the settings.
 * pool: NULL is fine. STATUS_NOMEM. */
ATTR_NODISCARD Status render_state_resolve(const RenderState *state, Exposure exposure, Pool *pool, Image *image,
                                           RenderStats *stats, Error *error);

/* Renders. *image gets channels R G B A, "noise.Y" (standard error of the luminance), and those of the AOVs, by
 * width x height, or of what is rendered of that. Same bits for any number of threads. STATUS_RENDER, STATUS_NOMEM. */
ATTR_NODISCARD Status render_image(const CompiledScene *compiled, const RenderSettings *settings, Pool *pool,
                                   const RenderEvents *events, Image *image, RenderStats *stats, Error *error);
/* The same, and *state is what it came to: {0} on entry, or a state of the same scene and settings (only the number of samples, the
 * noise and the time limit may be others), from which the render goes on, with the guide that it had. On success *state can be
 * gone on from again; where a stop came before its first sample, say amid the search for caustics, its film has none. After a
 * failure nothing in it can be relied on. Either way it is the caller's to clear. Where the time limit of a repeatable render ends
 * amid the search for caustics, its last fifth goes to samples without these, for *image alone; a slice has none. */
ATTR_NODISCARD Status render_go_on(const CompiledScene *compiled, const RenderSettings *settings, Pool *pool,
                                   const RenderEvents *events, RenderState *state, Image *image, RenderStats *stats,
                                   Error *error);

#endif

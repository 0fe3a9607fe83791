/* guide_keep.h - a search for caustics as far as it has come: what there is of it between two steps; private to src/trace/guide*.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GUIDE_KEEP_H
#define MEN_GUIDE_KEEP_H

#include "trace/guide_parts.h"

/* What is done next. */
typedef enum GuideStep {
    GUIDE_STEP_BEGIN,
    GUIDE_STEP_PLAN,
    GUIDE_STEP_FOLLOW,
    GUIDE_STEP_LEARN,
    GUIDE_STEP_TRY,
    GUIDE_STEP_DONE
} GuideStep;

enum { GUIDE_MOST_PHOTONS = 1 << 23, GUIDE_MOST_LANDED = 1 << 20 };

/* What is known besides photons and guides. Without gaps between members: it is kept as bytes. */
typedef struct GuideFacts {
    uint32_t step;     /* a GuideStep */
    uint32_t followed; /* photons */
    uint32_t tried;    /* how often it was tried out what they are worth */
    float other;       /* radiance of a white surface by all other light, on the mean of where photons landed */
    uint64_t n, rays;  /* of photons that landed; and how many rays were taken for all */
    double flux;       /* of all, times those followed */
    double rays_granted, unforeseen;   /* of the last round's flux */
    double mean_visits;                /* of the survey's cells */
    double granted, cost;              /* rays when the rounds began, and those for a photon */
    uint64_t round_begin, round_rays;  /* photons that had landed before the round, and rays */
    uint32_t round_end, round_photons; /* of all that are followed */
    GuideWorth worth;
    Hopes hopes; /* of the first photons */
} GuideFacts;
_Static_assert(sizeof(GuideFacts) == 13 * 8 + sizeof(GuideWorth) + sizeof(Hopes), "the facts of a search as bytes");

struct GuideSearch {
    GuideFacts facts;
    Photon *landed;
    size_t capacity;
    Guide *guide;  /* of the rounds so far */
    Guide *survey; /* counts how often paths come to places; NULL: not yet */
    /* while it is run */
    const GuideSettings *settings;
    PhotonSource source;
    Pool *pool;
    double start_s;
};

/* As it was before the first step. */
void guide_search_clear(GuideSearch *search);

#endif

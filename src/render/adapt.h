/* adapt.h - where more samples are needed, and how noisy a picture is.
 *
 * The noise of a picture is the mean over its pixels of |error of luminance| / sqrt(luminance^2 + (0.1 white)^2): relative in what
 * is bright, absolute in what is darker than a tenth of white, where nobody sees more. White is what is white on a display.
 *
 * A pixel does not judge itself. One that has not seen its firefly yet believes that it is done, and stopping when the
 * samples happen to agree would make pictures darker than they are. Whether it goes on is up to its neighbours' samples
 * alone. So how many it takes is independent of what they say at that time, and so is the error that is estimated from them.
 * What it has met does sway, by way of the neighbours' numbers, how many it takes later on: where light comes by chances
 * so rare that most neighbourhoods have met none after 16 samples, those that have go on, and the mean is too dark, as
 * measured by 2 % with 16 x 16 pixels, and by less with more.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ADAPT_H
#define MEN_ADAPT_H

#include "base/pool.h"
#include "render/brightness.h"
#include "render/film.h"
#include "render/spread.h"

/* The luminance of that tenth of white. */
double adapt_dark(const Brightness *brightness, Exposure exposure);
/* The noise of the picture; negative when a pixel has fewer than two samples,
 * the film does not begin with the first sample, or memory ends. spread: NULL, or where single bright samples
 * go. exposure: an automatic one is that of the film so far. pool: here and below, NULL, or who shares the work; the same bits
 * for any number of threads. */
double adapt_noise(const Film *film, const Spread *spread, Exposure exposure, Pool *pool);

/* Maps: the deviation of a pixel's samples; its error for one sample, as first its halves and at last its neighbours say it;
 * its luminance, as they do; and what is needed on the way. */
enum { ADAPT_DEVIATION, ADAPT_ERROR, ADAPT_LUMINANCE, ADAPT_NEAR, ADAPT_FAR_ERROR, ADAPT_SCRATCH, ADAPT_MAPS };

typedef struct Adapt {
    Exposure exposure;       /* as adapt_noise has it */
    uint32_t *wanted;        /* for each pixel, by rows: how many samples it is to have next */
    float *maps[ADAPT_MAPS]; /* of the same size */
} Adapt;

/* What is left to do. */
typedef struct AdaptPlan {
    uint32_t next;    /* the most samples that any pixel wants more, now; 0: all are done */
    uint64_t left;    /* samples of all pixels, as it looks now, until all are done */
    uint64_t at_most; /* the same if no pixel ever were */
    uint64_t unmet;   /* pixels that have the most samples, and are not done */
} AdaptPlan;

ATTR_NODISCARD Status adapt_init(Adapt *adapt, const Film *film, Exposure exposure, Error *error);
void adapt_clear(Adapt *adapt);
/* Judges all pixels, which have 2 samples or more, and sets what each wants next: at most twice what it has, at most
 * `most`, and in steps such that the samples of a pixel fill its strata, 2^k or 3 * 2^k of them. A function of the film alone.
 * STATUS_NOMEM. */
ATTR_NODISCARD Status adapt_plan(Adapt *adapt, const Film *film, double noise, uint32_t most, Pool *pool,
                                 AdaptPlan *plan, Error *error);
/* The same where not the noise is given but the number of samples: `samples` is to be the mean of all pixels, and each gets the
 * more the larger its error is and the fewer rays its samples take, and at least a quarter of the mean. Each plan looks ahead to
 * that number, or to four times what there is, and gives pixels their shares of it, but only as many as they have; they are asked
 * again then, when more is known. The last plan meets the number to a hundredth. plan->at_most and unmet are 0. */
ATTR_NODISCARD Status adapt_share(Adapt *adapt, const Film *film, uint32_t samples, Pool *pool, AdaptPlan *plan,
                                  Error *error);

#endif

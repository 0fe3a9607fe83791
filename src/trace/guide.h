/* guide.h - where to look for small bright lights that are seen through glass.
 *
 * A straight line to a light that lies behind a clear boundary is blocked, and paths that are bent there find a small
 * light once in some ten thousand tries: each find is then ten thousand times too bright. So before a picture is
 * rendered, photons are followed from the lights through the clear objects (trace/photon.h), and where they land they
 * say from where such light comes. Paths that scatter hereabouts send probes there ([Jensen95] chose the paths' own
 * directions so; probe.c says why not). The density of these directions is known exactly, and weighted against the
 * surface's own ([Veach97] 9.2.2); so the picture converges to the same whatever the photons say, and paths that go from
 * the camera through glass to the place are guided alike.
 *
 * Every photon carries its differentials, so that it says for the places around it in which directions the whole of its
 * light is seen by its way through the glass: lobes whose mean depends on the place. A sun of half a degree is so met
 * through a lens by most directions, in cells that are larger by far than its image. Glass that disperses sends each
 * wavelength another way; photons say how that changes with the wavelength, too, so that a path is led by the one that bends
 * it. The squared error of a rainbow on a floor is a hundredth for that after equal time, in the light of the sun; a fifth,
 * where the lamp is so large that colours overlap.
 *
 * Why not otherwise: manifold next-event estimation (J. Hanika, M. Droske, L. Fascione, EGSR (2015); T. Zeltner, I.
 * Georgiev, W. Jakob, "Specular Manifold Sampling", SIGGRAPH (2020)) has to be told, or to guess, which surfaces a path
 * passes, needs a walk for each of the many ways through nested objects with bubbles, and surfaces that are smooth
 * everywhere. What photons know of one place is taken for its neighbourhood to first order, and guide_search.c lays more
 * of them where that is not enough; where light goes through many facets or bumps, there are never enough. Merging
 * vertices with photons is biased by its radius, and makes a sample depend on a pass of photons.
 * Directions learned from paths of the camera (T. Müller, M. Gross, J. Novák, "Practical Path Guiding for Efficient
 * Light-Transport Simulation", EGSR (2017); targets of A. Rath et al., "Variance-Aware Path Guiding", ACM TOG 39(4)
 * (2020)) were measured on peers' glass: maps of 16 x 16 directions in a tree of cells, shares by records held back.
 * Squared errors are less by 5 % when a twentieth of the picture's paths teach, by 17 % when five times all of them do:
 * where light comes through the glass the noise falls to a third, but what is mirrored by its side is a strip too
 * narrow, and behind drink, ice and bubbles it is chance within the glass that makes the noise, whatever the direction.
 * Candles gain nothing. The lobes of photons, with the best share in each cell of some thousand such records, take 25 %
 * there, for 35 % more time. (All this was measured when directions were chosen by the guide, in the place of probes.)
 * What this does not find: lights without size behind glass, which no direction meets; and images of lights in glass
 * that the camera sees straight, which are found by the pixel's own samples.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GUIDE_H
#define MEN_GUIDE_H

#include <signal.h>

#include "trace/photon.h"
#include "trace/turns.h"

/* What is known of a small region. */
typedef struct GuideCell {
    Vec3f low, high;              /* around its photons, and a little more */
    uint32_t first_four, n_lobes; /* of its lobes, which lie in fours */
    float share, looks;           /* how often to send a probe: by what is scattered there, and by looks along paths */
    float keenness;            /* how dense its directions are where other photons than those of its lobes come from */
    float radiance;            /* of a white surface in the light that the photons bring */
    float scattered;           /* what media scatter of that, of a volume: */
    float color, color_spread; /* of what colour it is, in the mean, and the standard deviation of that */
    uint32_t parts_colors;     /* 1: it comes from other places by other colours */
} GuideCell;

typedef struct Guide Guide;

/* What makes a guide. A photon takes 128 bytes until the guide is made, and each that becomes a lobe some 150 bytes of
 * it then. */
typedef struct GuideSettings {
    uint32_t width, height; /* of the picture */
    uint64_t paths;         /* that it will take: what the guide takes is to be a small part of that */
    uint32_t seed;
    double dark; /* where luminances are less than this, errors are as large as they are; where more, as they relate */
    double time_limit_s;                              /* of the picture; 0: none. The guide gets a part of it */
    double end_s;                                     /* on base/clock.h's clock: the search is left then; 0: never */
    bool always;                                      /* also where little is to be gained */
    const volatile sig_atomic_t *stop;                /* NULL, or not 0: the search is left at once */
    void (*progress)(void *context, double fraction); /* of the work for the guide; NULL: none wanted */
    void *context;
} GuideSettings;

typedef struct GuideStats {
    uint64_t followed, landed, lobes;
    size_t bytes;
    double cpu_seconds; /* that it took to make */
} GuideStats;

/* The search for a guide, which can be left and gone on with: it comes to the same bits however often it was left. What it takes
 * is bounded by the time for a batch of photons, or for one trial of what they are worth. */
typedef struct GuideSearch GuideSearch;

ATTR_NODISCARD Status guide_search_new(GuideSearch **search, Error *error);
void guide_search_free(GuideSearch *search); /* NULL is fine */
/* Makes a guide for the world, or goes on with that, always a little. World and settings are always the same, but for the last five of
 * these. No guide where it would be of no use: without small bright lights, without clear or
 * mirroring objects, where hardly any light comes through these, or where it gains less than the time that it takes (which
 * guide_try.c finds out by paths of the camera). *stats: of all so far. STATUS_NOMEM. */
ATTR_NODISCARD Status guide_search_run(GuideSearch *search, const World *world, const GuideSettings *settings,
                                       Pool *pool, GuideStats *stats, Error *error);
bool guide_search_is_begun(const GuideSearch *search);       /* there is something to be kept of it. NULL: no */
bool guide_search_is_done(const GuideSearch *search);        /* NULL: no */
const Guide *guide_search_result(const GuideSearch *search); /* lives as long; NULL: none, or not done */

/* A search as bytes, with numbers and structs as in memory: write gets one part after another, until it returns false. A search
 * that is done takes what its guide takes, one that is not some 130 bytes for each photon that landed, too. */
enum { GUIDE_PARTS = 10 };
typedef struct GuideBytes {
    void *bytes; /* of malloc */
    uint64_t length;
} GuideBytes;
void guide_search_write(const GuideSearch *search, bool (*write)(void *context, const void *bytes, size_t length),
                        void *context, bool *written);
/* Takes these parts, in any case; false: they cannot be those of a search, or memory has ended. */
ATTR_NODISCARD bool guide_search_read(GuideBytes parts[GUIDE_PARTS], GuideSearch **search);

void guide_free(Guide *guide); /* NULL is fine */
/* The guide at a place. share 0: there is none. */
typedef struct GuideAt {
    const Guide *guide;
    const GuideCell *cell;
    Vec3f offset;      /* of the place in the cell */
    float color;       /* by which the light that is looked for is bent, see guide_color */
    float share, sent; /* how often probes look from there; and those that a path sends which is scattered there */
} GuideAt;

/* at_boundary: of clear objects. */
GuideAt guide_find(const Guide *guide, Vec3 place, bool at_boundary, float color);
/* Tells of all cells in which media scatter light, and that a line, origin + t direction, goes through from t = begin to `end`. */
typedef void GuideVisitor(void *context, const GuideCell *cell, double begin, double end);
void guide_walk(const Guide *guide, Vec3 origin, Vec3 direction, double begin, double end, GuideVisitor *visit,
                void *context);
/* How often looks along paths send probes at most, of all cells. */
float guide_most_looks(const Guide *guide);
/* Along lines on which the cells scatter less than this, looks are fewer in proportion. */
double guide_bright(const Guide *guide);
/* Directions towards lights; u: uniform in [0, 1). */
Vec3f guide_sample(const GuideAt *at, float u, const float v[2]);
/* The density of that per steradian. */
float guide_pdf(const GuideAt *at, Vec3f direction);
/* The same, with what light did that comes from there. */
void guide_leads(const GuideAt *at, Vec3f direction, Leads *leads);
/* Lights of a lesser radiance, as a mean of the wavelengths, are left to chance. */
float guide_threshold(const Guide *guide);

/* What paths note of a guide that is tried out (see guide_try.c): that they came to a place (amount: the part of its share
 * that counts there, ratio: what the path carries), or passed one in a medium (amount: likewise; ratio: what all
 * cells scatter on its way), that a probe was sent (amount: its rays, ratio: what the place scatters of its
 * light, over a white surface that faces it), and what was found of the
 * light that probes look for (amount: luminance; ratio: of the densities by which probes and the path itself find it). */
typedef enum GuideRecordKind { GUIDE_VISIT, GUIDE_LOOK, GUIDE_SENT, GUIDE_FOUND } GuideRecordKind;
typedef struct GuideLedger GuideLedger;
void guide_note(GuideLedger *ledger, const GuideAt *at, GuideRecordKind kind, float amount, float ratio);

#endif

/* photon.h - light followed from the small bright lights of a scene through its clear objects, to where it is scattered.
 *
 * Photons are for guiding paths only (trace/guide.h): none of them adds to a picture, so that nothing here can make one
 * wrong. They start where the straight line between a light and a point of the bounds of a clear or mirroring object
 * says, found by the same sampling of lights as paths use, so that every kind of light is there; and they go on through
 * the nested volumes by the functions of paths.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PHOTON_H
#define MEN_PHOTON_H

#include <signal.h>

#include "base/pool.h"
#include "trace/path.h"
#include "trace/turns.h"

/* What bends light is nearly linear in this (A. L. Cauchy): the square of the wave number, 1 at 500 nm. */
static inline float guide_color(float wavelength_nm)
{
    return 500 / wavelength_nm * (500 / wavelength_nm);
}
static inline float guide_wavelength(float color)
{
    return 500 / sqrtf(color);
}

/* Where light that has come through a smooth boundary, or off a mirror, is scattered; and what its neighbours would be
 * like, in the plane that touches the sphere of directions at `from`, in the frame that sampling_basis makes of that. The
 * light is seen from a place near by in directions about mean + slope * (place - position). */
typedef struct Photon {
    Vec3f position;
    Vec3f from;     /* unit: where it came from, against its travel */
    Vec3f normal;   /* of the surface there, on its side; zero in a medium */
    float flux;     /* mean over the wavelengths; 0: it has ended elsewhere */
    float radiance; /* of its light, likewise */
    float mean[2];
    Vec3f slope[2];
    float spread[3]; /* covariance about the mean: xx, xy, yy; 0: nothing is known */
    float color;     /* of the light by which it was bent, see guide_color */
    float hue[2];    /* and how the mean at a place changes with that, as far as to first order; */
    float hue_bend;  /* away from that it does with the square of the colour, in radians */
    uint32_t number; /* of all that were followed */
    uint32_t
        way; /* the same for those that met the same surfaces, and did the same there; odd: some of these are rough */
    uint16_t lobe;        /* 1: photons_look_around was here */
    uint16_t at_boundary; /* 1: it has landed on frosted glass, else where paths are scattered broadly */
    /* far parts of a sea fill little of the picture, so that their flux counts less: it is 1 + more times that */
    float more;
    uint32_t turns; /* what it did at the smooth boundaries that it has met since the last rough one: see turns.h; */
    float chance;   /* and how likely that was */
} Photon;

/* What it carries, whatever that counts. */
static inline float photon_flux_there(const Photon *photon)
{
    return photon->flux * (1 + photon->more);
}

/* An emitter that is flat and shines into a cone. */
typedef struct PhotonLamp {
    uint32_t emitter;
    double power; /* of this and all before */
} PhotonLamp;

/* Boxes around all that bends or mirrors light, and lamps that have photons of their own. What has no end is many boxes side by
 * side, to which photons are sent as the picture needs them. */
enum { PHOTON_TARGETS = 64, PHOTON_TILES = 28 };
typedef struct PhotonTargets {
    Box3 boxes[PHOTON_TARGETS + PHOTON_TILES];
    double cumulative[PHOTON_TARGETS + PHOTON_TILES]; /* area of this and all before, times density */
    double density[PHOTON_TARGETS + PHOTON_TILES];    /* of photons on its surface */
    double more[PHOTON_TARGETS + PHOTON_TILES];       /* see Photon; all areas, less as that counts, are the last sum */
    uint32_t n, n_tiles;                              /* the tiles come last, */
    int up; /* and go from the bottom to the surface along this axis, 0 .. 2 */
    PhotonLamp *lamps;
    size_t n_lamps;
} PhotonTargets;

/* STATUS_NOMEM. */
ATTR_NODISCARD Status photon_targets(const World *world, PhotonTargets *targets, Error *error);
void photon_targets_clear(PhotonTargets *targets);

/* What lights send through all targets' surfaces, as the mean of the wavelengths; nothing is in the way. */
float photon_flux(const World *world, const PhotonTargets *targets);

/* Where photons come from: lights whose radiance is above the threshold, as the mean of the wavelengths. */
typedef struct PhotonSource {
    const World *world;
    const PhotonTargets *targets;
    float threshold;
    uint32_t seed;
    /* What has become of the first ones, PHOTON_EXPLORERS, by which the others choose their ways, and those explore; NULL: all choose as
     * boundaries reflect. */
    const Hopes *hopes;
    const volatile sig_atomic_t
        *stop; /* NULL, or not 0 to give up: photons that are left then have no flux and no lobe */
} PhotonSource;

enum { PHOTON_EXPLORERS = 1 << 12 };

/* Follows the photons first .. first + n - 1: number i into photons[i - first], a function of seed and i alone. Their flux is
 * what all together carry if they all are alike; of their neighbours nothing is known yet. *rays grows by the rays that it
 * took, *hopes (NULL: unwanted) by what became of them. STATUS_NOMEM. */
ATTR_NODISCARD Status photons_trace(const PhotonSource *source, uint32_t first, uint32_t n, Pool *pool, Photon *photons,
                                    Hopes *hopes, uint64_t *rays, Error *error);
/* Finds the neighbours of the n photons which[...], some six times as much work as following them was. STATUS_NOMEM. */
ATTR_NODISCARD Status photons_look_around(const PhotonSource *source, Photon *photons, const uint32_t *which,
                                          uint32_t n, Pool *pool, uint64_t *rays, Error *error);

/* The irradiance that a place on a surface (or the fluence that one in a medium) gets straight from lights, as a mean of
 * the wavelengths; of brighter lights than the threshold only the part PHOTON_BRIGHT_PART counts, as paths find these
 * without scattering towards them. normal: unit, or zero in a medium. number: of this estimate among many. */
#define PHOTON_BRIGHT_PART 0.3f
float photon_other_light(Tracer *tracer, Vec3f place, Vec3f normal, float threshold, uint32_t number);

#endif

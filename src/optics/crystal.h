/* crystal.h - what becomes of light at a smooth boundary of crystals that refract doubly.
 *
 * In a uniaxial crystal, such as calcite, zircon or ice, light goes as two kinds of waves, each of one polarization. The index of an
 * ordinary wave is the same in all directions; that of an extraordinary one depends on the angle to the optic axis, and its light
 * goes in another direction than its phase. Each wave that meets a boundary becomes up to two that are reflected, and two that go
 * through. Which way these go follows from their phase along the boundary, and how bright they are from Maxwell's equations: the
 * components along the boundary of both fields are the same on either side. [BornWolf99] 15.3; for the equations of four waves
 * [Yeh79].
 *
 * Light in what is isotropic is taken as unpolarized, as everywhere else in this program: what a boundary has polarized is no more so
 * when it comes to the next one. Within a crystal a wave stays what it is until it meets a boundary or is scattered.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CRYSTAL_H
#define MEN_CRYSTAL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/vec3.h"

/* What is on one side of a boundary: of refractive indices above 0. */
typedef struct CrystalSide {
    double ordinary, extraordinary; /* both are the same of what is isotropic */
    Vec3 axis;                      /* the optic axis, unit; of what is isotropic any */
} CrystalSide;

typedef enum CrystalWave { CRYSTAL_UNPOLARIZED, CRYSTAL_ORDINARY, CRYSTAL_EXTRAORDINARY } CrystalWave;

/* "ordinary"; NULL of what is unpolarized. */
const char *crystal_wave_name(CrystalWave wave);

enum { CRYSTAL_WAYS = 4 };
typedef struct CrystalWay {
    CrystalWave wave; /* unpolarized in what is isotropic */
    bool through;
    Vec3 direction; /* unit, of the ray: where the energy goes */
    double part;    /* of the energy that comes to the boundary; > 0 */
} CrystalWay;

static inline bool crystal_is_isotropic(const CrystalSide *side)
{
    return side->ordinary == side->extraordinary;
}

/* How much longer light takes along a ray (unit) than in empty space. */
double crystal_ray_index(const CrystalSide *side, CrystalWave wave, Vec3 direction);
/* A ray of direction (unit) in `from` meets the boundary to `to`, whose normal (unit) is on the side that it comes from, against
 * it. wave: what it is; in a crystal ordinary or extraordinary, else unpolarized. Returns how many ways it goes on; their parts add
 * up to 1. What goes back along one of them has the same part that becomes what came, where both are polarized or both are not; of
 * what is polarized twice as much comes back, as unpolarized light is half of either kind. So a path from a camera may choose among
 * ways by their parts, as one from a lamp may: with light over the square of the index, as it is at other boundaries. */
uint32_t crystal_meet(const CrystalSide *from, const CrystalSide *to, Vec3 direction, CrystalWave wave, Vec3 normal,
                      CrystalWay ways[CRYSTAL_WAYS]);

#endif

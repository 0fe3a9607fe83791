/* airlight.h - light that a thin medium scatters towards a path, looked for by choosing the light first and then the place
 * along the way; private to src/trace.
 *
 * Flights (flight.h) find it by being scattered and then looking at a light. In thin haze that is rare, and near a small
 * lamp, where most of the light is, it is rarer still. So on each stretch of a path's way another place is chosen: a
 * light, and a place by the angle under which the light sees the stretch ([KF12] section 3), so that the squared distance
 * cancels. Of light from infinity the place is chosen by what the medium lets pass.
 *
 * What flights find is weighted against that by the balance heuristic, over the wavelengths as well (path.c): at a place t
 * of the stretch, scattered by one medium, and for one place on one light there are
 *     flight, then light sampling   pf(t) c p        c, p: choosing the light from there, and the place on it
 *     flight, then the phase        pf(t) s          s: the direction's density
 *     this                          q a(t) p         q a(t): choosing the light for the stretch, looking at all, and t
 * with pf(t) the mean over the wavelengths. Where media vary, pf is what the least densities make of the scattering that is
 * there: any function of the place would do, as all three are weighted with the same, and what passes is estimated without
 * bias. So nothing here depends on how media vary. [KF12] is named in full in src/README.md.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_AIRLIGHT_H
#define MEN_AIRLIGHT_H

#include "trace/flight.h"

enum { AIRLIGHT_STRETCHES = 8 };

/* Looks for light on the stretch that the path is about to fly through, from t = begin on. Keeps in path->way what weights need. */
void airlight_look(Path *path, const FlightStretch *stretch, double begin, double length);
/* The flight was scattered at t, of the last stretch. */
void airlight_note(Path *path, const FreeFlight *flight, bool uneven, double t);
/* Which of all the stretches of a path it is, for random numbers, */
static inline uint32_t airlight_stretch(const Path *path, uint32_t number)
{
    return path->bounce * AIRLIGHT_STRETCHES + (number < AIRLIGHT_STRETCHES ? number : AIRLIGHT_STRETCHES - 1);
}
/* and where those of a stretch are: of which light, of a place on it, of a place of the stretch, and of beams (beam_ways.h). */
enum { AIRLIGHT_CHOICE, AIRLIGHT_LIGHT, AIRLIGHT_PLACE, AIRLIGHT_BEAMS, AIRLIGHT_NUMBERS };
static inline uint32_t airlight_dimension(uint32_t stretch, uint32_t which)
{
    return DIM_AIRLIGHT + stretch * AIRLIGHT_NUMBERS + which;
}
/* A place of the stretch, off the surfaces at both ends by what rounding may take, so that straight rays from there find all that
 * they cross. */
double airlight_off_ends(const Path *path, double t);
/* pf(t) where what scatters has this coefficient; depth: since the beginning of the stretch. The mean over the wavelengths, each
 * by how the path came there with it. */
float airlight_flight_density(const Airway *way, Lanes coefficient, Lanes depth);
/* A place of the stretch: what scatters there, and what comes to there of what the path carries. */
typedef struct AirPlace {
    const Phase *phase;
    Lanes coefficient, depth, left; /* depth: of what flights are sure to be scattered by */
} AirPlace;

/* Of several media at the place one is chosen, each as often, of path->way.n_media; *which: uniform in [0, 1), and what that leaves of
 * it. False: nothing scatters there. */
bool airlight_place(Path *path, const FlightStretch *stretch, double t, double *which, AirPlace *place);
/* s, where the phase function is pdf_w at the wavelengths: what path_phase_density says of flights that are scattered there. */
float airlight_turn_density(const Airway *way, const Phase *phase, Lanes coefficient, Lanes depth, Lanes pdf_w);

/* q a(t) / pf(t) at the place where the path was scattered last, for light from infinity and for a place on an emitter; 0
 * where it was not on such a stretch. Times p, it competes with c p and s. */
float airlight_rival_far(const Path *path);
float airlight_rival_near(const Path *path, uint32_t emitter, Vec3 place);
/* The same times p, for a light sample from there, and for a hit by chance with the density of light_pdf_hit. */
float airlight_rival_sample(const Path *path, const LightSample *light);
float airlight_rival_hit(const Path *path, const Hit *hit, float pdf_hit);

#endif

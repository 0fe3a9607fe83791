/* shaft.h - light that comes through glass and that a thin medium scatters towards a path, looked for where photons were
 * scattered; private to src/trace.
 *
 * Behind a prism, a lens or waves light goes through smoke or water in shafts. Flights (flight.h) are scattered within one of them
 * as seldom as it is thin, and looks for lights (airlight.h) end at the glass. But the guide (guide.h) knows where photons
 * were scattered. So on each stretch of a path's way one of its cells may be chosen, by how much light they say is scattered on
 * the stretch within it, then a place within the cell; and a probe (probe.c) is sent from there, as if the path had been
 * scattered there.
 *
 * The same light is found by flights that are scattered at the place, and then by their probes or by chance. All three are weighted
 * by the balance heuristic, as airlight.h has it: with pf(t) the density of flights' places,
 *     flight, then the phase        pf(t) s        s: the direction's density
 *     flight, then a probe          pf(t) r g      r: how often one is sent, g: the guide's density
 *     this                          q a(t) g       q a(t): looking at all, and choosing t
 * over pf(t) that is s + (r + q a(t) / pf(t)) g: so that to the weights it is as if probes were sent more often.
 *
 * There are as many looks as there is light on the stretch, up to four where the line is bright, and as they pay (guide_try.c).
 * Beams of photons, gathered along all of their way ([JNSJ11], named in full in src/README.md), have less noise, but are
 * blurred by their radius; here photons only say where to look. Measured, over probes alone: the squared error of smoke behind
 * a ball of glass a tenth after equal time, of water that scatters a little everywhere nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SHAFT_H
#define MEN_SHAFT_H

#include "trace/flight.h"

/* Looks on the stretch, which is path->way, of which all but its share is set. Keeps in path->way what weights need. */
void shaft_look(Path *path, const FlightStretch *stretch);
/* How often looks find a place of the guide where a flight was scattered last, over how often flights do. */
float shaft_rival(Path *path, const GuideAt *guide);

#endif

/* emitter_cut.h - how much of the surfaces of operands is on the surface of their combination: private to src/trace/emitter*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EMITTER_CUT_H
#define MEN_EMITTER_CUT_H

#include "trace/emitter.h"

/* What asking for places needs, of one thread; {compiled}, and cleared in the end. */
typedef struct CutAsking {
    const CompiledScene *compiled;
    HitList hits;
    NestList list;
    bool out_of_memory;
} CutAsking;
void emitter_cut_begin(CutAsking *asking, const CompiledScene *compiled);
void emitter_cut_end(CutAsking *asking);
/* Whether the combination's surface is at a place of an operand's, see emitter_place. False when memory ends. */
bool emitter_cut_shows(CutAsking *asking, const Emitter *emitter, double time, const double u[2]);

/* Estimates for emitters[0 .. n), all parts of one operand, which part of each is on the combination's surface, by points; parts[i]
 * is never 0. n_points: how many; 0: all parts are 1. The same at all times that it is asked. STATUS_NOMEM. */
ATTR_NODISCARD Status emitter_cut_parts(const CompiledScene *compiled, const Emitter *emitters, uint32_t n,
                                        uint32_t n_points, float *parts, Error *error);

#endif

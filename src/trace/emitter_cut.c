/* emitter_cut.c - see emitter_cut.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/emitter_cut.h"

#include <stdlib.h>

#include "nest/csg.h"
#include "trace/emitter_place.h"

/* Of one triangle or piece no more points are asked: a part in 64 is known well enough to choose by. */
enum { MOST_OF_ONE = 64 };

void emitter_cut_begin(CutAsking *asking, const CompiledScene *compiled)
{
    *asking = (CutAsking){.compiled = compiled};
    nest_list_init(&asking->list);
}

void emitter_cut_end(CutAsking *asking)
{
    nest_list_clear(&asking->list);
    hit_list_clear(&asking->hits);
}

bool emitter_cut_shows(CutAsking *asking, const Emitter *emitter, double time, const double u[2])
{
    const CompiledScene *compiled = asking->compiled;
    Vec3 place = emitter_place(compiled, emitter, time, u, NULL);
    if (compiled_interior(compiled, vec3f_from(place), time, &asking->hits, &asking->list, NULL) != STATUS_OK ||
        nest_list_reserve(&asking->list, 1) != STATUS_OK) {
        asking->out_of_memory = true;
        return false;
    }
    return nest_csg_shows(&compiled->csg, &asking->list, compiled->hull_of_object[emitter->of]);
}

/* Groups of emitters that stand side by side share their points where there are more emitters than points. */
static void ask_all(CutAsking *asking, const Emitter *emitters, uint32_t n, uint32_t n_groups, uint32_t of_one,
                    uint32_t *shown)
{
    for (uint32_t group = 0; group < n_groups; group++) {
        uint32_t begin = (uint32_t)((uint64_t)n * group / n_groups),
                 end = (uint32_t)((uint64_t)n * (group + 1) / n_groups);
        shown[group] = 0;
        for (uint32_t i = 0; i < of_one; i++) {
            double u[2], time = emitter_place_in_turn(asking->compiled->scene, group * of_one + i, u);
            shown[group] += emitter_cut_shows(asking, &emitters[(begin + end) / 2], time, u);
        }
    }
}

/* What few points of one tell is taken together with what all of them tell; a surface of which none is found may still have some that
 * shows. */
static void find_parts(uint32_t n, uint32_t n_groups, uint32_t of_one, const uint32_t *shown, float *parts)
{
    uint32_t all = 0;
    for (uint32_t group = 0; group < n_groups; group++) all += shown[group];
    double of_all = fmin((all + 0.5) / ((double)n_groups * of_one), 1);
    for (uint32_t group = 0; group < n_groups; group++) {
        uint32_t begin = (uint32_t)((uint64_t)n * group / n_groups),
                 end = (uint32_t)((uint64_t)n * (group + 1) / n_groups);
        for (uint32_t i = begin; i < end; i++) parts[i] = (float)((shown[group] + of_all) / (of_one + 1.0));
    }
}

Status emitter_cut_parts(const CompiledScene *compiled, const Emitter *emitters, uint32_t n, uint32_t n_points,
                         float *parts, Error *error)
{
    uint32_t n_groups = n < n_points ? n : n_points;
    for (uint32_t i = 0; i < n; i++) parts[i] = 1;
    if (!n_groups) return STATUS_OK;
    uint32_t of_one = n_points / n_groups < MOST_OF_ONE ? n_points / n_groups : MOST_OF_ONE;
    uint32_t *shown = malloc(n_groups * sizeof *shown);
    if (!shown) return fail_memory(error, n_groups * sizeof *shown, "combinations that shine");
    CutAsking asking;
    emitter_cut_begin(&asking, compiled);
    ask_all(&asking, emitters, n, n_groups, of_one, shown);
    find_parts(n, n_groups, of_one, shown, parts);
    emitter_cut_end(&asking);
    free(shown);
    return asking.out_of_memory ? fail_memory(error, sizeof(Hit), "combinations that shine") : STATUS_OK;
}

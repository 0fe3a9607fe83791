/* report_brims.c - liquids that stand higher than the rim of the solid that holds them, as where one is as high as a box that was
 * meant to be cut off. A dome that bulges over the rim, a stream that comes from above and foam are no such thing.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "check/report_parts.h"

enum { PLACES_ASIDE = 16 };
/* Of the height of the vessel: a drink may be filled a little higher than its rim. */
static const double least_above = 0.03;
/* Of the box around the liquid just below its top; a cylinder fills 0.79 of it. */
static const double least_filled = 0.6;

/* What holds a liquid. */
typedef struct Vessel {
    uint32_t hull; /* of the solids around it the one with the highest rim; SCENE_NONE */
    bool barred;   /* a solid in the liquid goes up as high, and may hold it there */
} Vessel;

static bool may_hold(const Box3 *solid, const Box3 *liquid)
{
    return solid->min.x < liquid->min.x && liquid->max.x < solid->max.x && solid->min.z < liquid->min.z &&
           liquid->max.z < solid->max.z && solid->min.y < liquid->min.y;
}

static void find_vessels(const CompiledScene *compiled, Vessel *vessels)
{
    const Box3 *boxes = compiled->found_bounds;
    for (uint32_t h = 0; h < compiled->n_hulls; h++) vessels[h] = (Vessel){.hull = SCENE_NONE};
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!pair->overlaps) continue;
        ReportVerdict verdict = report_verdict(compiled, pair);
        if (verdict.kind != VERDICT_RULE || compiled->hulls[verdict.top].state != NEST_SOLID) continue;
        Vessel *vessel = &vessels[verdict.bottom];
        if (compiled->unbounded[verdict.top] || boxes[verdict.top].max.y >= boxes[verdict.bottom].max.y) {
            vessel->barred = true;
        } else if (pair->relation == NEST_PARTIAL && may_hold(&boxes[verdict.top], &boxes[verdict.bottom]) &&
                   (vessel->hull == SCENE_NONE || boxes[vessel->hull].max.y < boxes[verdict.top].max.y)) {
            vessel->hull = verdict.top;
        }
    }
}

/* Whether a liquid goes straight up from the rim to its top. */
static bool fills_its_box(const CompiledScene *compiled, uint32_t hull, double y, HitList *hits)
{
    const Box3 *box = &compiled->found_bounds[hull];
    const Vec3 size = vec3_sub(box->max, box->min);
    uint32_t n = 0;
    for (int i = 0; i < PLACES_ASIDE; i++)
        for (int k = 0; k < PLACES_ASIDE; k++) {
            Vec3 place = {box->min.x + size.x * (i + 0.5) / PLACES_ASIDE, y,
                          box->min.z + size.z * (k + 0.5) / PLACES_ASIDE};
            n += report_is_within(compiled, place, compiled->object_of_hull[hull], hits);
        }
    return n >= least_filled * PLACES_ASIDE * PLACES_ASIDE;
}

static bool stands_above(const CompiledScene *compiled, uint32_t hull, const Vessel *vessel, HitList *hits)
{
    const NestHull *liquid = &compiled->hulls[hull];
    const SceneMedium *medium = &compiled->scene->media[liquid->medium];
    if (vessel->hull == SCENE_NONE || vessel->barred || liquid->state != NEST_LIQUID || liquid->mixes) return false;
    if (compiled->unbounded[hull] || spectrum_at_one(&medium->ior, 550) < 1.01F) return false; /* foam */
    const Box3 *box = &compiled->found_bounds[hull], *solid = &compiled->found_bounds[vessel->hull];
    const double above = box->max.y - solid->max.y, below = solid->max.y - box->min.y;
    return above > least_above * (solid->max.y - solid->min.y) && below > above &&
           fills_its_box(compiled, hull, box->max.y - 0.1 * above, hits);
}

static void report_brim(const CompiledScene *compiled, uint32_t hull, uint32_t solid, Diag *diag)
{
    const SceneObject *liquid = report_object(compiled, hull), *vessel = report_object(compiled, solid);
    const double rim = compiled->found_bounds[solid].max.y;
    Buf above = {0};
    report_add_length(&above, compiled->scene, compiled->found_bounds[hull].max.y - rim);
    Diagnostic *report = diag_report(diag, D_LEAKING_LIQUID, liquid->span, "%s stands %s above the rim of %s",
                                     liquid->name, buf_text(&above), vessel->name);
    diag_note(diag, report, vessel->span, "%s is here", vessel->name);
    diag_hint(diag, report, "let %s end below y = %.4g", liquid->name, rim);
    buf_clear(&above);
}

/* Where memory ends there is no remark. */
void report_brims(const CompiledScene *compiled, Diag *diag)
{
    HitList hits = {0};
    uint32_t n = 0;
    Vessel *vessels = malloc((compiled->n_hulls + 1) * sizeof *vessels);
    if (vessels) find_vessels(compiled, vessels);
    for (uint32_t h = 0; vessels && h < compiled->n_hulls && n < REPORT_MOST; h++)
        if (stands_above(compiled, h, &vessels[h], &hits)) {
            report_brim(compiled, h, vessels[h].hull, diag);
            n++;
        }
    hit_list_clear(&hits);
    free(vessels);
}

/* report_buried.c - clear solids much of which is within something opaque, so that little light goes through what is left: a gem whose
 * girdle was placed on the table rather than its tip, a ball in the ground up to its middle.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "base/hash.h"
#include "check/report_parts.h"

enum { LINES = 240 };
/* Of a volume: of a brilliant on its girdle it is a half. What is held by a socket or a frame has less. */
static const double most_sunk = 0.4;

typedef struct Buried {
    double volume, within;
    uint32_t object; /* that much of it is within */
} Buried;

/* Where there is anything opaque: planes, sheets without an inside that things may stand on, as paper, and a box around all else. */
enum { MOST_PLANES = 8 };
typedef struct OpaqueThings {
    uint32_t n_planes, planes[MOST_PLANES];
    uint32_t n_sheets, sheets[MOST_PLANES];
    Box3 sheet_boxes[MOST_PLANES], others;
} OpaqueThings;

static bool is_sheet(const Scene *scene, uint32_t number)
{
    const SceneObject *object = &scene->objects[number];
    return object->tree == SCENE_NONE && object->shape != SCENE_NONE && !scene->shapes[object->shape].closed;
}

static void find_opaque(const CompiledScene *compiled, OpaqueThings *opaque)
{
    const Scene *scene = compiled->scene;
    SceneShapeBox known = {0};
    *opaque = (OpaqueThings){.others = box3_empty()};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        if (!report_is_opaque(compiled, i)) continue;
        if (report_is_plane(scene, i) && opaque->n_planes < MOST_PLANES) {
            opaque->planes[opaque->n_planes++] = i;
            continue;
        }
        Box3 box = scene_next_box_around(scene, &scene->objects[i], &known);
        opaque->others = box3_union(opaque->others, box);
        if (!is_sheet(scene, i) || opaque->n_sheets == MOST_PLANES) continue;
        opaque->sheet_boxes[opaque->n_sheets] = box;
        opaque->sheets[opaque->n_sheets++] = i;
    }
}

/* The sheet that lies over a place and within the box around the solid that it is in. What is within the solid alone, as a leaf that is
 * cast in, is not what it was to stand on. */
static uint32_t sheet_over(const CompiledScene *compiled, const OpaqueThings *opaque, Box3 solid, Vec3 place,
                           HitList *hits)
{
    const double flattest = 0.7; /* the cosine of 45 degrees: steeper is no floor */
    Ray ray = ray_make(place, vec3f(0, 1, 0));
    ray.t_max = solid.max.y - place.y;
    for (uint32_t i = 0; i < opaque->n_sheets; i++) {
        const Box3 *box = &opaque->sheet_boxes[i];
        if (box->min.x > solid.min.x || box->max.x < solid.max.x || box->min.z > solid.min.z ||
            box->max.z < solid.max.z || box->min.y > solid.max.y || box->max.y < place.y)
            continue;
        rtc_all(compiled->rtc, &ray, false, hits);
        for (size_t k = 0; k < hits->n; k++)
            if (hits->items[k].object == opaque->sheets[i] && fabs((double)hits->items[k].cos_normal) > flattest)
                return opaque->sheets[i];
    }
    return SCENE_NONE;
}

static uint32_t plane_above(const CompiledScene *compiled, const OpaqueThings *opaque, Vec3 place, HitList *hits)
{
    for (uint32_t i = 0; i < opaque->n_planes; i++)
        if (report_is_within(compiled, place, opaque->planes[i], hits)) return opaque->planes[i];
    return SCENE_NONE;
}

/* A quick look. */
static bool may_be_buried(const CompiledScene *compiled, const OpaqueThings *opaque, Box3 box, HitList *hits)
{
    for (int corner = 0; corner < 8; corner++)
        if (plane_above(compiled, opaque, box3_corner(box, corner), hits) != SCENE_NONE) return true;
    return box3_meets(opaque->others, box);
}

/* Places along lines through the hull, one for each stretch within it, which stands for the stretch. */
static bool find_buried(const CompiledScene *compiled, const OpaqueThings *opaque, Probe *probe, HitList *hits,
                        uint32_t hull, uint32_t n_lines, Buried *buried)
{
    uint64_t n = 0;
    *buried = (Buried){.object = SCENE_NONE};
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        line_set_begin(&set, compiled->hull_bounds[hull], direction, n_lines / LINE_DIRECTIONS, hull);
        while (probe_next_line(probe, compiled, &set, hull, &line)) {
            if (probe->out_of_memory || hits->out_of_memory) return false;
            for (uint32_t i = probe->first[hull]; i != INTERVAL_NONE; i = probe->intervals[i].next) {
                const Interval *in = &probe->intervals[i];
                double volume = (in->end - in->begin) * line.area;
                double t = in->begin + (in->end - in->begin) * hash_to_unit(hash_u64(n++));
                Vec3 place = vec3_along(line.start, t, vec3_from_f(line.direction));
                uint32_t object = plane_above(compiled, opaque, place, hits);
                if (object == SCENE_NONE) object = report_body_around(compiled, place, hits);
                if (object == SCENE_NONE)
                    object = sheet_over(compiled, opaque, compiled->hull_bounds[hull], place, hits);
                buried->volume += volume;
                if (object == SCENE_NONE || (buried->object != SCENE_NONE && object != buried->object)) continue;
                buried->object = object;
                buried->within += volume;
            }
        }
    }
    return true;
}

/* Of many things that one line strews some are sunk by chance: nobody wants to know, unless all of them are. */
static bool is_chance(const CompiledScene *compiled, uint32_t hull, uint32_t n_buried)
{
    const SceneObject *first = report_object(compiled, hull);
    uint32_t n = 0;
    for (uint32_t h = 0; h < compiled->n_hulls; h++)
        n += span_same_place(report_object(compiled, h)->span, first->span);
    return n > n_buried;
}

/* Whether it comes out above what it is buried in, and so may be meant to stand on it; a cornea comes out of the side of its eye. */
static bool stands_out(const CompiledScene *compiled, uint32_t hull, uint32_t object)
{
    const Scene *scene = compiled->scene;
    return scene_is_plane(scene, object) || is_sheet(scene, object) ||
           compiled->hull_bounds[hull].max.y > scene_object_bounds(scene, &scene->objects[object], NULL).max.y;
}

static void report_one(const CompiledScene *compiled, uint32_t hull, const Buried *buried, uint32_t n, Diag *diag)
{
    const SceneObject *object = report_object(compiled, hull), *opaque = &compiled->scene->objects[buried->object];
    Diagnostic *report =
        diag_report(diag, D_MOSTLY_BURIED, object->span,
                    "about %.0f %% of %s lies %s %s, which is opaque: nothing of that is seen, and the rest is "
                    "dark, as little light goes through it",
                    100 * buried->within / buried->volume, object->name,
                    scene_is_plane(compiled->scene, buried->object) ? "behind"
                    : is_sheet(compiled->scene, buried->object)     ? "below"
                                                                    : "within",
                    opaque->name);
    if (n > 1) diag_note_nowhere(diag, report, "and so do %u more that this line places", (unsigned)(n - 1));
    diag_note(diag, report, opaque->span, "%s is here", opaque->name);
    if (stands_out(compiled, hull, buried->object))
        diag_hint(diag, report, "its lowest place is at y = %.4g: to stand on %s, it is to be lifted by translate()",
                  compiled->hull_bounds[hull].min.y, opaque->name);
    else
        diag_hint(diag, report, "let it come further out of %s, or cut a hollow for it: difference { ... }",
                  opaque->name);
}

/* Of liquids a basin that is filled may hold as much. Where memory ends there is no remark. */
void report_buried(const CompiledScene *compiled, Diag *diag)
{
    Probe probe;
    HitList hits = {0};
    OpaqueThings opaque;
    Buried groups[REPORT_MOST];
    ReportLikes likes = {.n = 0};
    uint32_t n_lines = report_lines_of_each(compiled->n_hulls);
    bool good = probe_init(&probe, compiled, NULL) == STATUS_OK;
    if (n_lines > LINES) n_lines = LINES;
    find_opaque(compiled, &opaque);
    for (uint32_t h = 0; good && h < compiled->n_hulls; h++) {
        const NestHull *hull = &compiled->hulls[h];
        Buried buried;
        if (hull->state == NEST_LIQUID || hull->state == NEST_GAS || hull->mixes ||
            box3_is_unbounded(compiled->hull_bounds[h]) ||
            !may_be_buried(compiled, &opaque, compiled->hull_bounds[h], &hits))
            continue;
        good = find_buried(compiled, &opaque, &probe, &hits, h, n_lines, &buried);
        if (!good || !(buried.within > most_sunk * buried.volume) || buried.within > 0.999 * buried.volume) continue;
        uint32_t group =
            report_count_like(&likes, report_object(compiled, h), &compiled->scene->objects[buried.object], h);
        if (group < REPORT_MOST && likes.counts[group] == 1) groups[group] = buried;
    }
    for (uint32_t i = 0; i < likes.n; i++)
        if (!is_chance(compiled, (uint32_t)likes.first[i], likes.counts[i]))
            report_one(compiled, (uint32_t)likes.first[i], &groups[i], likes.counts[i], diag);
    report_others(diag, D_MOSTLY_BURIED, likes.n_others);
    hit_list_clear(&hits);
    probe_clear(&probe);
}

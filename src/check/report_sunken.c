/* report_sunken.c - thin opaque sheets, as labels, that lie in a clear solid just below its surface, where they were most likely
 * meant to lie on it. What is cast into something is deeper, and things in drinks are in a liquid.
 * A remark that is wrong costs more than one that is missing.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/hash.h"
#include "check/report_parts.h"

enum {
    SHEETS = 2000,    /* that are looked at, at most */
    OF_ONE_PLACE = 2, /* in the text, as the turns of a loop are */
    LINES = 90,
    CHORDS = 240,
    FIRST_CHORDS = 24, /* where none of these is in a solid, nothing is looked for any more */
    LEAST_CHORDS = 8,
    PLACES = 4 /* along a chord */
};

/* Of a sheet's size: what is deeper is meant to be there. */
static const double deepest = 0.015;
/* Of the sheet's width: thicker is no sheet. */
static const double thickest = 0.05;
/* Of the sheet's volume: a little is let in so that no air is between. */
static const double least_part = 0.25;

/* Where a line goes through a sheet. Of one that is not closed the thickness is 0. */
typedef struct Chord {
    Vec3 place, normal; /* where it comes in, outward */
    double thickness;   /* along the normal */
    double area;        /* of the surface for which it stands */
} Chord;

/* How many of some place in the text have been looked at, and whether there was something to say. */
typedef struct SeenPlace {
    Span span;
    uint32_t n;
    bool reported;
} SeenPlace;

typedef struct Sunken {
    const CompiledScene *compiled;
    const Scene *scene;
    Box3 solids; /* around all that are clear and solid */
    Probe probe; /* across a sheet */
    HitList hits;
    NestList operands;
    SceneShapeBox known;
    SeenPlace *seen; /* twice as many as there can be, by hash: where one is taken, in the next free one */
    Chord chords[CHORDS];
    uint32_t n_chords, n_sheets, n_reports;
} Sunken;

/* What of a sheet is in solids near their surfaces. */
typedef struct Depth {
    double all, in; /* volumes; or areas where the thickness is 0 */
    double covered; /* of chords with both their ends in there */
    double deepest;
    uint32_t hull; /* of one of them */
} Depth;

/* ---- the sheet ---- */

static bool may_be_sheet(const Sunken *s, uint32_t number)
{
    const SceneObject *object = &s->scene->objects[number];
    return object->part_of == SCENE_NONE && object->light == SCENE_NONE && object->motion == SCENE_NONE &&
           s->compiled->hull_of_object[number] == SCENE_NONE && !scene_is_thin(s->scene, number) &&
           (object->tree != SCENE_NONE || !scene_is_plane(s->scene, number));
}

/* Whether a line comes into the object or goes out of it with a hit; of a combination where that makes a difference. */
static bool crosses(Sunken *s, uint32_t object, size_t i, bool *entering)
{
    const Hit *hit = &s->hits.items[i];
    const NestCsg *csg = &s->compiled->csg;
    uint32_t tree = s->scene->objects[object].tree, pass = s->compiled->hull_of_object[hit->object];
    *entering = hit->entering;
    if (scene_whole(s->scene, hit->object) != object || hit_repeats(&s->hits, i)) return false;
    if (tree == SCENE_NONE) return true;
    bool before = nest_csg_holds(csg, tree, &s->operands);
    if (nest_list_reserve(&s->operands, 1) != STATUS_OK) return false;
    nest_csg_pass(csg, &s->operands, pass, hit->entering);
    *entering = nest_csg_holds(csg, tree, &s->operands);
    return *entering != before;
}

static void add_chord(Sunken *s, const Line *line, const Hit *enter, double end)
{
    const double least_cosine = 0.3; /* flatter ones say little of the thickness; of a direction of three it is more */
    double cosine = fabs(enter->cos_normal);
    Vec3 normal = vec3_from_f(enter->normal);
    if (s->n_chords == CHORDS || cosine < least_cosine) return;
    if (vec3_dot(normal, vec3_from_f(line->direction)) > 0) normal = vec3_scale(normal, -1);
    s->chords[s->n_chords++] = (Chord){vec3_along(line->start, enter->t, vec3_from_f(line->direction)), normal,
                                       (end - enter->t) * cosine, line->area / cosine / LINE_DIRECTIONS};
}

/* Of a combination: the operands that the line starts in are those that it leaves first. */
static void start_inside(Sunken *s, uint32_t object)
{
    s->operands.n = 0;
    if (s->scene->objects[object].tree == SCENE_NONE) return;
    for (size_t i = 0; i < s->hits.n; i++) {
        const Hit *hit = &s->hits.items[i];
        bool first = !hit->entering && scene_whole(s->scene, hit->object) == object;
        for (size_t k = 0; first && k < i; k++) first = s->hits.items[k].object != hit->object;
        if (first && nest_list_reserve(&s->operands, 1) == STATUS_OK)
            nest_csg_pass(&s->compiled->csg, &s->operands, s->compiled->hull_of_object[hit->object], true);
    }
}

static void find_chords_on(Sunken *s, uint32_t object, const Line *line)
{
    const SceneObject *o = &s->scene->objects[object];
    bool closed = o->tree != SCENE_NONE || s->scene->shapes[o->shape].closed;
    const Hit *enter = NULL;
    Ray ray = ray_make(line->start, line->direction);
    if (o->tree == SCENE_NONE) ray.t_max = line->length;
    rtc_all(s->compiled->rtc, &ray, false, &s->hits);
    start_inside(s, object);
    for (size_t i = 0; i < s->hits.n; i++) {
        const Hit *hit = &s->hits.items[i];
        bool entering;
        if (!crosses(s, object, i, &entering)) continue;
        if (!closed)
            add_chord(s, line, hit, hit->t);
        else if (!entering && enter)
            add_chord(s, line, enter, hit->t);
        enter = entering ? hit : NULL;
    }
}

static double size_of(Box3 box)
{
    return vec3_length(vec3_sub(box.max, box.min));
}

/* Its thickness is the volume over the area of one side; its width that area over its length. false: it is no sheet. */
static bool find_sheet(Sunken *s, uint32_t object, Box3 box, double *thickness)
{
    double area = 0, volume = 0;
    s->n_chords = 0;
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        line_set_begin(&set, box, direction, LINES / LINE_DIRECTIONS, object);
        while (line_set_next(&set, &line)) find_chords_on(s, object, &line);
    }
    for (uint32_t i = 0; i < s->n_chords; i++) {
        area += s->chords[i].area;
        volume += s->chords[i].area * s->chords[i].thickness;
    }
    *thickness = area > 0 ? volume / area : 0;
    return s->n_chords >= LEAST_CHORDS && *thickness <= thickest * area / size_of(box);
}

/* ---- what it is in ---- */

/* The hull that owns a place of the line, and how far it is from there to where another one does; NULL: none. */
static const Interval *owner_at(const Sunken *s, double t, double *distance)
{
    const uint32_t *rank = s->compiled->order.rank;
    const Interval *owner = NULL;
    for (size_t i = 0; i < s->probe.n_intervals; i++) {
        const Interval *other = &s->probe.intervals[i];
        if (!(other->begin < t && t < other->end) || s->compiled->hulls[other->hull].mixes) continue;
        if (!owner || rank[other->hull] > rank[owner->hull]) owner = other;
    }
    if (!owner) return NULL;
    *distance = fmin(owner->enter ? t - owner->begin : HUGE_VAL, owner->leave ? owner->end - t : HUGE_VAL);
    for (size_t i = 0; i < s->probe.n_intervals; i++) {
        const Interval *other = &s->probe.intervals[i];
        if (rank[other->hull] > rank[owner->hull] && !s->compiled->hulls[other->hull].mixes)
            *distance = fmin(*distance, fmax(t - other->end, other->begin - t));
    }
    return owner;
}

/* Along the normal, from beyond the side where the chord comes in. */
static void look_across(Sunken *s, const Chord *chord, double reach, Depth *depth)
{
    static const double along[PLACES] = {1e-4, 1.0 / 3, 2.0 / 3, 1 - 1e-4};
    static const double weights[PLACES] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    Line line = {.start = vec3_along(chord->place, reach, chord->normal),
                 .direction = vec3f_from(vec3_scale(chord->normal, -1)),
                 .length = 2 * reach + chord->thickness};
    double volume = chord->area * (chord->thickness > 0 ? chord->thickness : 1), part = 0;
    bool ends = true;
    probe_surfaces(&s->probe, s->compiled, &line, SCENE_NONE);
    probe_intervals(&s->probe, s->compiled, &line);
    for (int i = 0; i < PLACES; i++) {
        double distance;
        const Interval *owner = owner_at(s, reach + along[i] * chord->thickness, &distance);
        bool near = owner && s->compiled->hulls[owner->hull].state == NEST_SOLID && distance <= reach;
        if (near) {
            part += weights[i];
            depth->hull = owner->hull;
            depth->deepest = fmax(depth->deepest, distance);
        } else if (i == 0 || i == PLACES - 1) {
            ends = false;
        }
    }
    depth->all += volume;
    depth->in += part * volume;
    depth->covered += ends ? volume : 0;
}

static bool is_sunken(Sunken *s, Box3 box, double thickness, Depth *depth)
{
    const double reach = deepest * size_of(box);
    uint32_t n = s->n_chords, stride = n / FIRST_CHORDS + 1;
    *depth = (Depth){.hull = SCENE_NONE};
    for (uint32_t first = 0; first < stride; first++) {
        for (uint32_t i = first; i < n; i += stride)
            if (s->chords[i].thickness <= 4 * thickness) look_across(s, &s->chords[i], reach, depth); /* not along it */
        if (s->probe.out_of_memory || !(depth->in > 0)) return false;
    }
    return depth->in >= least_part * depth->all;
}

static void report_one(Sunken *s, uint32_t number, const Depth *depth, Diag *diag)
{
    const SceneObject *sheet = &s->scene->objects[number], *solid = report_object(s->compiled, depth->hull);
    bool covered = 2 * depth->covered > depth->in;
    Buf deep = {0};
    if (++s->n_reports > REPORT_MOST) return;
    report_add_length(&deep, s->scene, report_two_digits(depth->deepest));
    Diagnostic *report = diag_report(diag, D_SUNKEN_SHEET, sheet->span, "%s, which is thin, lies %s of %s, up to %s %s",
                                     sheet->name, covered ? "inside" : "partly inside", solid->name, buf_text(&deep),
                                     covered ? "below its surface: it is seen through what covers it"
                                             : "deep: there is no air between them, as if glued");
    diag_note(diag, report, solid->span, "%s is here", solid->name);
    diag_hint(diag, report,
              covered
                  ? "to lie on it, it has to be farther out, with a gap of 0.01 mm, say; where it is cast in, that is "
                    "right so"
                  : "to lie on it, it has to be farther out, with a gap of 0.01 mm, say; where it is glued or painted "
                    "on, that is right so");
    buf_clear(&deep);
}

/* ---- the scene ---- */

static SeenPlace *find_place(Sunken *s, Span span)
{
    const uint32_t n = 2 * SHEETS;
    uint32_t i = hash_combine(span.source, span.begin) % n;
    while (s->seen[i].n && !span_same_place(s->seen[i].span, span)) i = (i + 1) % n;
    s->seen[i].span = span;
    return &s->seen[i];
}

static void look_at(Sunken *s, uint32_t number, Diag *diag)
{
    const SceneObject *object = &s->scene->objects[number];
    SeenPlace *seen = find_place(s, object->span);
    if (seen->n == OF_ONE_PLACE || seen->reported) return;
    Box3 box = scene_next_box_around(s->scene, object, &s->known);
    Depth depth;
    double thickness;
    if (box3_is_empty(box) || box3_is_unbounded(box) || box3_is_empty(box3_intersection(box, s->solids))) return;
    box = scene_object_bounds(s->scene, object, NULL);
    seen->n++;
    s->n_sheets++;
    if (!find_sheet(s, number, box, &thickness) || !is_sunken(s, box, thickness, &depth)) return;
    report_one(s, number, &depth, diag);
    seen->reported = true;
}

/* Where memory ends there is no remark. */
void report_sunken(const CompiledScene *compiled, Diag *diag)
{
    NestPolicy policy = compiled->order.policy;
    Sunken *s = calloc(1, sizeof *s);
    if (!s || (policy != NEST_AUTOMATIC && policy != NEST_PRIORITY)) {
        free(s);
        return;
    }
    s->compiled = compiled;
    s->scene = compiled->scene;
    s->solids = box3_empty();
    s->seen = calloc(2 * SHEETS, sizeof *s->seen);
    nest_list_init(&s->operands);
    for (uint32_t h = 0; h < compiled->n_hulls; h++)
        if (compiled->hulls[h].state == NEST_SOLID && !box3_is_empty(compiled->hull_bounds[h]))
            s->solids = box3_union(s->solids, compiled->hull_bounds[h]);
    bool ready = s->seen && probe_init(&s->probe, compiled, NULL) == STATUS_OK && !box3_is_empty(s->solids);
    for (uint32_t i = 0; ready && i < s->scene->n_objects && s->n_sheets < SHEETS && !s->probe.out_of_memory; i++)
        if (may_be_sheet(s, i)) look_at(s, i, diag);
    if (s->n_reports > REPORT_MOST)
        diag_report_nowhere(diag, D_SUNKEN_SHEET, "%u more thin sheets lie inside of clear solids",
                            (unsigned)(s->n_reports - REPORT_MOST));
    probe_clear(&s->probe);
    hit_list_clear(&s->hits);
    nest_list_clear(&s->operands);
    free(s->seen);
    free(s);
}

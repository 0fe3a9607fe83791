/* report_leaks.c - liquids that come out through the wall of the solid that holds them, as where a drink is to reach into its
 * glass and is wider than that at its foot.
 *
 * Lines in all directions find the chords of each that are seen. Those that pass one small cube of space are of one body; what is
 * between two of one line and covered by solids alone is a wall. Cubes are too coarse for thin places, so a chord on the other
 * side of a wall is no part of the main body if walks from it, each step to a random place of a random chord through the place
 * before, never come there. Where most chords of such a body end at the liquid's own surface, it hangs outside; in the bore of a
 * straw, or behind a pane that parts a tank, they end at the wall.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/angle.h"
#include "base/array.h"
#include "base/hash.h"
#include "check/report_parts.h"
#include "optics/sampling.h"

enum {
    CELLS = 128, /* along the longest side of a liquid */
    LINES_IN_ALL = 200000,
    LINES_MOST = 8192,
    LINES_LEAST = 500,
    STEPS = 200, /* of a walk */
    WALKS = 24
};
/* Of the ends of the lines through what comes out, as many are at the liquid's own surface, at least. */
static const double least_own = 0.4;
/* What comes out is less, of the main body: of two halves, neither is out. */
static const double most_out = 0.2;

/* A part of a line that is in the liquid and seen. */
typedef struct Chord {
    Vec3 begin, end;
    uint32_t body;    /* another chord of the same body, or itself */
    uint32_t wall;    /* the hull that is between it and another chord; SCENE_NONE */
    double margin[2]; /* how far from its ends on it is a cell's diagonal away from the surfaces there */
    uint8_t n_own;    /* of its ends, those at the liquid's own surface */
} Chord;

/* What is known of a liquid. */
typedef struct Body {
    const CompiledScene *compiled;
    Probe probe;
    uint32_t hull;
    Vec3 corner, centre;
    double cell, radius;
    uint32_t *cells; /* of each a chord that passes it; SCENE_NONE */
    Chord *chords;
    size_t n, capacity;
    uint32_t main; /* the body of most of it */
    uint64_t n_random;
} Body;

static float random_of(Body *b)
{
    return hash_to_unit_f((uint32_t)hash_u64(b->n_random++));
}

static uint32_t body_of(const Body *b, uint32_t chord)
{
    while (b->chords[chord].body != chord) chord = b->chords[chord].body;
    return chord;
}

/* ---- chords ---- */

/* Where a chord is far enough from its ends for cells not to lie across a wall: number i of its places, half a cell apart; false:
 * there are no more. */
static bool place_within(const Body *b, const Chord *chord, uint32_t i, Vec3 *place)
{
    Vec3 along = vec3_sub(chord->end, chord->begin);
    double length = vec3_length(along), at = chord->margin[0] + 0.5 * b->cell * i;
    if (!(at <= length - chord->margin[1])) return false;
    *place = vec3_along(chord->begin, at / length, along);
    return true;
}

static uint32_t *cell_at(const Body *b, Vec3 place)
{
    const double at[3] = {place.x - b->corner.x, place.y - b->corner.y, place.z - b->corner.z};
    size_t index = 0;
    for (int axis = 2; axis >= 0; axis--)
        index = index * CELLS + (size_t)fmin(fmax(floor(at[axis] / b->cell), 0), CELLS - 1);
    return &b->cells[index];
}

static bool is_solid(const Body *b, const Hit *hit)
{
    uint32_t hull = hit ? compiled_hull(b->compiled, hit->object) : SCENE_NONE;
    return hull != SCENE_NONE && hull != b->hull && b->compiled->hulls[hull].state == NEST_SOLID;
}

static double margin_at(const Body *b, const Hit *hit)
{
    return sqrt(3) * b->cell / fmax(hit ? fabs(hit->cos_normal) : 1, 1e-3);
}

static Chord chord_of(const Body *b, const Line *line, const Interval *own, const ReportStretch *stretch)
{
    const Vec3 direction = vec3_from_f(line->direction);
    return (Chord){.begin = vec3_along(line->start, stretch->begin, direction),
                   .end = vec3_along(line->start, stretch->end, direction),
                   .wall = SCENE_NONE,
                   .margin = {margin_at(b, stretch->from), margin_at(b, stretch->until)},
                   .n_own = (uint8_t)((stretch->from == own->enter) + (stretch->until == own->leave))};
}

/* false when memory ends. */
static bool add_chord(Body *b, const Chord *chord)
{
    if (!ARRAY_ROOM(b->chords, b->capacity, b->n)) return false;
    const uint32_t number = (uint32_t)b->n++;
    b->chords[number] = *chord;
    b->chords[number].body = number;
    Vec3 place;
    for (uint32_t i = 0; place_within(b, chord, i, &place); i++) {
        uint32_t *cell = cell_at(b, place);
        if (*cell == SCENE_NONE)
            *cell = number;
        else
            b->chords[body_of(b, number)].body = body_of(b, *cell);
    }
    return true;
}

/* The chords of an interval; false when memory ends. */
static bool add_chords(Body *b, const Line *line, const Interval *own)
{
    ReportStretch stretch = report_stretch_before(own);
    const Hit *before = NULL;
    for (bool first = true; report_next_seen(b->compiled, &b->probe, own, &stretch); first = false) {
        Chord chord = chord_of(b, line, own, &stretch);
        if (!first && is_solid(b, before) && is_solid(b, stretch.from)) {
            chord.wall = compiled_hull(b->compiled, before->object);
            b->chords[b->n - 1].wall = chord.wall;
        }
        if (!add_chord(b, &chord)) return false;
        before = stretch.until;
    }
    return true;
}

/* Intervals of the liquid on a line; INTERVAL_NONE. */
static uint32_t first_on(Body *b, const Line *line)
{
    if (!probe_surfaces(&b->probe, b->compiled, line, b->hull)) return INTERVAL_NONE;
    probe_intervals(&b->probe, b->compiled, line);
    return b->probe.first[b->hull];
}

/* Looks along lines that are even over all directions and places of the ball around the liquid. */
static bool find_chords(Body *b, uint32_t n_lines)
{
    for (uint32_t i = 0; i < n_lines; i++) {
        Line line = {.direction = sampling_sphere(random_of(b), random_of(b)), .length = 2 * b->radius};
        Vec3f x, y;
        float u, v;
        sampling_basis(line.direction, &x, &y);
        sampling_disc(random_of(b), random_of(b), &u, &v);
        line.start = vec3_along(b->centre, -b->radius, vec3_from_f(line.direction));
        line.start = vec3_along(line.start, b->radius * (double)u, vec3_from_f(x));
        line.start = vec3_along(line.start, b->radius * (double)v, vec3_from_f(y));
        for (uint32_t k = first_on(b, &line); k != INTERVAL_NONE; k = b->probe.intervals[k].next)
            if (!add_chords(b, &line, &b->probe.intervals[k])) return false;
    }
    return !b->probe.out_of_memory;
}

/* ---- bodies ---- */

static double length_of(const Chord *chord)
{
    return vec3_length(vec3_sub(chord->end, chord->begin));
}

/* Finds the main body; returns the length of its chords, or less than 0 when memory ends. */
static double find_main(Body *b)
{
    double *lengths = calloc(b->n + 1, sizeof *lengths);
    if (!lengths) return -1;
    b->main = 0;
    for (uint32_t i = 0; i < b->n; i++) {
        uint32_t body = body_of(b, i);
        lengths[body] += length_of(&b->chords[i]);
        if (lengths[body] > lengths[b->main]) b->main = body;
    }
    double most = lengths[b->main];
    free(lengths);
    return most;
}

/* The chord that a place is in, along a random line through it; false: there is none, as rounding has it. */
static bool step_from(Body *b, Vec3 place, Chord *chord)
{
    Line line = {.direction = sampling_sphere(random_of(b), random_of(b)), .length = 4 * b->radius};
    const double at = 2 * b->radius;
    line.start = vec3_along(place, -at, vec3_from_f(line.direction));
    for (uint32_t k = first_on(b, &line); k != INTERVAL_NONE; k = b->probe.intervals[k].next) {
        const Interval *own = &b->probe.intervals[k];
        ReportStretch stretch = report_stretch_before(own);
        while (report_next_seen(b->compiled, &b->probe, own, &stretch)) {
            if (!(stretch.begin <= at && at <= stretch.end)) continue;
            *chord = chord_of(b, &line, own, &stretch);
            return true;
        }
    }
    return false;
}

/* Whether a walk comes from a chord to the main body. */
static bool comes_to_main(Body *b, Chord chord)
{
    for (int step = 0; step < STEPS; step++) {
        Vec3 place;
        for (uint32_t i = 0; place_within(b, &chord, i, &place); i++) {
            uint32_t cell = *cell_at(b, place);
            if (cell != SCENE_NONE && body_of(b, cell) == b->main) return true;
        }
        place = vec3_along(chord.begin, (double)random_of(b), vec3_sub(chord.end, chord.begin));
        if (!step_from(b, place, &chord)) return true;
    }
    return false;
}

/* What lies beyond a wall, and is not of the main body. */
typedef struct Leak {
    double length; /* of all chords there */
    uint32_t n, n_walked, n_apart, n_own;
    const Chord *longest;
} Leak;

static bool is_suspect(const Body *b, uint32_t chord)
{
    return b->chords[chord].wall != SCENE_NONE && body_of(b, chord) != b->main;
}

/* The length of all chords of bodies that lie beyond a wall; less than 0 when memory ends. */
static double length_beyond(const Body *b)
{
    double length = 0;
    bool *beyond = calloc(b->n + 1, sizeof *beyond);
    if (!beyond) return -1;
    for (uint32_t i = 0; i < b->n; i++) beyond[body_of(b, i)] |= is_suspect(b, i);
    for (uint32_t i = 0; i < b->n; i++) length += beyond[body_of(b, i)] ? length_of(&b->chords[i]) : 0;
    free(beyond);
    return length;
}

static Leak find_leak(Body *b)
{
    Leak leak = {.n = 0, .length = length_beyond(b)};
    for (uint32_t i = 0; i < b->n; i++) leak.n += is_suspect(b, i);
    uint32_t stride = leak.n / WALKS + 1, k = 0;
    for (uint32_t i = 0; i < b->n; i++) {
        const Chord *chord = &b->chords[i];
        if (!is_suspect(b, i)) continue;
        if (k++ % stride) continue;
        leak.n_walked++;
        if (comes_to_main(b, *chord)) continue;
        leak.n_apart++;
        leak.n_own += chord->n_own;
        if (!leak.longest || length_of(chord) > length_of(leak.longest)) leak.longest = chord;
    }
    return leak;
}

static void report_leak(const Body *b, const Leak *leak, double volume, Diag *diag)
{
    const Scene *scene = b->compiled->scene;
    const SceneObject *liquid = report_object(b->compiled, b->hull),
                      *wall = report_object(b->compiled, leak->longest->wall);
    const Vec3 place = vec3_scale(vec3_add(leak->longest->begin, leak->longest->end), 0.5);
    Buf much = {0};
    report_add_volume(&much, scene, report_two_digits(volume));
    Diagnostic *report =
        diag_report(diag, D_LEAKING_LIQUID, liquid->span,
                    "%s comes out through %s: about %s of it are on the other side, as at <%.4g, %.4g, %.4g>",
                    liquid->name, wall->name, buf_text(&much), place.x, place.y, place.z);
    diag_note(diag, report, wall->span, "%s is here", wall->name);
    diag_hint(diag, report, "let %s end within the wall; check --slice shows where it does not", liquid->name);
    buf_clear(&much);
}

/* Whether the liquid comes out. false when memory ends, too. */
static bool look_at(Body *b, uint32_t n_lines, Diag *diag)
{
    const Box3 box = b->compiled->found_bounds[b->hull];
    b->n = 0;
    b->corner = box.min;
    b->centre = box3_centre(box);
    b->cell = vec3_max_abs(vec3_sub(box.max, box.min)) / CELLS;
    b->radius = 0.5 * vec3_length(vec3_sub(box.max, box.min));
    if (!(b->cell > 0) || !isfinite(b->radius)) return false;
    for (size_t i = 0; i < (size_t)CELLS * CELLS * CELLS; i++) b->cells[i] = SCENE_NONE;
    if (!find_chords(b, n_lines)) return false;
    double main = find_main(b);
    if (!(main > 0)) return false;
    Leak leak = find_leak(b);
    if (leak.n_apart < 3 || 2 * leak.n_apart < leak.n_walked || leak.n_own < least_own * 2 * leak.n_apart) return false;
    double out = leak.length * leak.n_apart / leak.n_walked;
    if (out > most_out * main) return false;
    report_leak(b, &leak, MEN_PI * b->radius * b->radius * out / n_lines, diag);
    return true;
}

/* Liquids of which a part is under a solid, and a part is not. */
static uint32_t mark_covered(const CompiledScene *compiled, bool *covered)
{
    uint32_t n = 0;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!pair->overlaps || pair->relation != NEST_PARTIAL) continue;
        ReportVerdict verdict = report_verdict(compiled, pair);
        if (verdict.kind != VERDICT_RULE) continue;
        const NestHull *liquid = &compiled->hulls[verdict.bottom], *solid = &compiled->hulls[verdict.top];
        if (liquid->state != NEST_LIQUID || liquid->mixes || solid->state != NEST_SOLID) continue;
        if (compiled->unbounded[verdict.bottom] || covered[verdict.bottom]) continue;
        covered[verdict.bottom] = true;
        n++;
    }
    return n;
}

/* Where memory ends there is no remark: what needs more will say so. */
void report_leaks(const CompiledScene *compiled, Diag *diag)
{
    Body b = {.compiled = compiled};
    uint32_t n = 0;
    bool *covered = calloc(compiled->n_hulls + 1, sizeof *covered);
    uint32_t n_covered = covered ? mark_covered(compiled, covered) : 0;
    if (n_covered && probe_init(&b.probe, compiled, NULL) == STATUS_OK &&
        (b.cells = malloc((size_t)CELLS * CELLS * CELLS * sizeof *b.cells))) {
        uint32_t n_lines = LINES_IN_ALL / n_covered;
        if (n_lines > LINES_MOST) n_lines = LINES_MOST;
        for (b.hull = 0; b.hull < compiled->n_hulls && n_lines >= LINES_LEAST && n < REPORT_MOST; b.hull++)
            n += covered[b.hull] && look_at(&b, n_lines, diag);
    }
    probe_clear(&b.probe);
    free(b.cells);
    free(b.chords);
    free(covered);
}

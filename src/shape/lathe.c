/* lathe.c - a profile turned about the y axis: checked, and its corners rounded.
 * The profile is a closed polygon in the half plane (r, y). Steps: clean the corners, orient, replace rounded corners
 * by arcs; outline.c does the rest.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "shape/outline.h"

enum { MAX_POINTS = 100000 };

/* A point of the profile as written, with the length of the edges that its rounding takes away. */
typedef struct Corner {
    double r, y;
    double round, tangent;
    uint32_t source; /* its number in the caller's profile */
} Corner;

static Status check_points(const double (*profile)[2], uint32_t n, const double *round, Error *error)
{
    if (n < 3) return fail(error, STATUS_SCENE, "a profile needs at least 3 points; this one has %u", n);
    if (n > MAX_POINTS)
        return fail(error, STATUS_SCENE, "a profile may have at most %d points; this one has %u", MAX_POINTS, n);
    for (uint32_t i = 0; i < n; i++) {
        double r = profile[i][0];
        double y = profile[i][1];
        if (!(fabs(r) <= 1e15) || !(fabs(y) <= 1e15))
            return fail(error, STATUS_SCENE, "profile[%u] = <%g, %g> is not within +-1e15", i, r, y);
        if (r < 0)
            return fail(error, STATUS_SCENE, "profile[%u] = <%g, %g> is left of the axis; r must not be negative", i, r,
                        y);
        if (round && !(round[i] >= 0 && round[i] <= 1e15))
            return fail(error, STATUS_SCENE, "the rounding %g of profile[%u] = <%g, %g> is not within 0..1e15",
                        round[i], i, r, y);
    }
    return STATUS_OK;
}

/* Copies the points without repetitions; returns how many. */
static uint32_t clean_corners(const double (*profile)[2], uint32_t n, const double *round, Corner *corners)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++) {
        Corner corner = {profile[i][0] + 0.0, profile[i][1] + 0.0, round ? round[i] : 0, 0, i}; /* -0 becomes 0 */
        if (kept && corners[kept - 1].r == corner.r && corners[kept - 1].y == corner.y) {
            corners[kept - 1].round = fmax(corners[kept - 1].round, corner.round);
            continue;
        }
        corners[kept++] = corner;
    }
    while (kept > 1 && corners[0].r == corners[kept - 1].r && corners[0].y == corners[kept - 1].y) {
        kept--;
        corners[0].round = fmax(corners[0].round, corners[kept].round);
    }
    return kept;
}

/* Puts the solid on the left of the walk. */
static void orient_corners(Corner *corners, uint32_t n)
{
    double volume = 0;
    for (uint32_t i = 0; i < n; i++) {
        const Corner *a = &corners[i];
        const Corner *b = &corners[(i + 1) % n];
        volume += (a->r * a->r + a->r * b->r + b->r * b->r) * (b->y - a->y);
    }
    if (volume >= 0) return;
    for (uint32_t i = 0, k = n - 1; i < k; i++, k--) {
        Corner keep = corners[i];
        corners[i] = corners[k];
        corners[k] = keep;
    }
}

static bool on_axis(const Corner *a, const Corner *b)
{
    return a->r == 0 && b->r == 0;
}

/* The directions in which the outline comes to corner i and goes from it. At an end on the axis the other
 * side is the mirror image's: there the outline arrives, or starts, horizontally. False where both edges
 * lie on the axis. */
static bool corner_directions(const Corner *corners, uint32_t n, uint32_t i, Dir2 *in, Dir2 *out)
{
    const Corner *before = &corners[(i + n - 1) % n];
    const Corner *here = &corners[i];
    const Corner *after = &corners[(i + 1) % n];
    bool axis_in = on_axis(before, here);
    bool axis_out = on_axis(here, after);
    if (axis_in && axis_out) return false;
    *in = axis_in ? (Dir2){1, 0} : dir2_between(before->r, before->y, here->r, here->y);
    *out = axis_out ? (Dir2){-1, 0} : dir2_between(here->r, here->y, after->r, after->y);
    return true;
}

/* How much of its edges each rounding takes. */
static Status measure_roundings(Corner *corners, uint32_t n, Error *error)
{
    for (uint32_t i = 0; i < n; i++) {
        Corner *corner = &corners[i];
        Dir2 in, out;
        if (!corner_directions(corners, n, i, &in, &out)) continue;
        double angle = fabs(dir2_turn(in, out));
        bool tip = on_axis(&corners[(i + n - 1) % n], corner) || on_axis(corner, &corners[(i + 1) % n]);
        if (!tip && angle > 179.999999 * MEN_DEGREE)
            return fail(error, STATUS_SCENE, "the profile turns back on itself at profile[%u] = <%g, %g>",
                        corner->source, corner->r, corner->y);
        if (corner->round == 0 || angle < 1e-9) continue;
        if (!tip && corner->r == 0)
            return fail(error, STATUS_SCENE,
                        "profile[%u] = <%g, %g> touches the axis between two edges and cannot be rounded",
                        corner->source, corner->r, corner->y);
        corner->tangent = corner->round * tan(tip ? angle : angle / 2); /* a tip's arc is half of one */
    }
    for (uint32_t i = 0; i < n; i++) {
        const Corner *a = &corners[i];
        const Corner *b = &corners[(i + 1) % n];
        if (on_axis(a, b) || a->tangent + b->tangent == 0) continue;
        double length = hypot(b->r - a->r, b->y - a->y);
        if (a->tangent + b->tangent > length * (1 + 1e-12))
            return fail(error, STATUS_SCENE,
                        "the edge from profile[%u] = <%g, %g> to profile[%u] = <%g, %g> is %g long; rounding takes %g "
                        "of it at the "
                        "first point and %g at the second",
                        a->source, a->r, a->y, b->source, b->r, b->y, length, a->tangent, b->tangent);
    }
    return STATUS_OK;
}

/* The arc at a corner whose tangent is not 0, from the edge before it to the edge behind it. */
static bool add_arc(Outline *outline, const Corner *corner, Dir2 in, Dir2 out)
{
    double angle = dir2_turn(in, out);
    double side = angle > 0 ? corner->round : -corner->round; /* from the arc's centre along the normal */
    bool starts_on_axis = corner->r == 0 && in.r == 1 && in.y == 0;
    bool ends_on_axis = corner->r == 0 && out.r == -1 && out.y == 0;
    Dir2 centre; /* from the tangent point on an edge that is really there */
    if (starts_on_axis)
        centre = (Dir2){0, corner->y + corner->tangent * out.y + side * out.r};
    else
        centre = (Dir2){ends_on_axis ? 0 : corner->r - corner->tangent * in.r - side * in.y,
                        corner->y - corner->tangent * in.y + side * in.r};
    Dir2 normal = dir2_outward(in);
    Dir2 start = {starts_on_axis ? 0 : fmax(centre.r + side * normal.r, 0), centre.y + side * normal.y};
    if (!outline_add_arc(outline, start, centre, side, atan2(normal.y, normal.r), angle, corner->source)) return false;
    normal = dir2_outward(out);
    OutlinePoint *last = outline_add_point(outline, ends_on_axis ? 0 : fmax(centre.r + side * normal.r, 0),
                                           centre.y + side * normal.y, corner->source);
    if (!last) return false;
    outline_give_normal(last, normal);
    return true;
}

static Status make_outline(const Corner *corners, uint32_t n, Outline *outline, Error *error)
{
    for (uint32_t i = 0; i < n; i++) {
        const Corner *corner = &corners[i];
        Dir2 in, out;
        if (!corner_directions(corners, n, i, &in, &out)) continue;
        bool added = corner->tangent > 0 ? add_arc(outline, corner, in, out)
                                         : outline_add_point(outline, corner->r, corner->y, corner->source) != NULL;
        if (!added) return fail_memory(error, outline->n * sizeof *outline->points, "a profile");
        if (outline->n > OUTLINE_MAX_EDGES)
            return fail(error, STATUS_SCENE, "the profile makes more than %d edges; round fewer of its corners",
                        OUTLINE_MAX_EDGES);
    }
    if (outline->n) outline->points[outline->n - 1].closes = true; /* whichever way round it is walked */
    return STATUS_OK;
}

Status solid_make_lathe(const double (*profile)[2], uint32_t n, const double *round, bool smooth_all, Solid **solid,
                        Error *error)
{
    TRY(check_points(profile, n, round, error));
    Corner *corners = calloc(n, sizeof *corners);
    if (!corners) return fail_memory(error, n * sizeof *corners, "a profile");
    Outline outline = {0};
    uint32_t n_corners = clean_corners(profile, n, round, corners);
    Status status = STATUS_OK;
    if (n_corners < 3)
        status = fail(error, STATUS_SCENE, "a profile needs at least 3 different points; this one has %u", n_corners);
    if (status == STATUS_OK) {
        orient_corners(corners, n_corners);
        status = measure_roundings(corners, n_corners, error);
    }
    if (status == STATUS_OK) status = make_outline(corners, n_corners, &outline, error);
    if (status == STATUS_OK) status = outline_finish(&outline, smooth_all, solid, error);
    outline_clear(&outline);
    free(corners);
    return status;
}

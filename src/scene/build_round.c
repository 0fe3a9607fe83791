/* build_round.c - solids of revolution: spheres, ellipsoids, tori, cylinders, capsules, cones, lathes.
 *
 * All spheres and ellipsoids share the unit sphere, for which a scale is exact enough (the intersection is in double);
 * the others keep their true sizes, so that only a rigid map stands between a hull's edge and the numbers in the scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/num.h"
#include "scene/build_parts.h"

void build_sphere(Builder *b, const EvalNode *node, const Affine *to_world)
{
    Vec3 center = eval_vector(node, "center");
    double radius = eval_number(node, "radius");
    build_needs(b, node, "strength", "outside of a blob");
    Affine place = {{{radius, 0, 0}, {0, radius, 0}, {0, 0, radius}}, center};
    place = affine_compose(to_world, &place);
    build_object(b, node, build_sphere_shape(b, 1), &place);
}

void build_ellipsoid(Builder *b, const EvalNode *node, const Affine *to_world)
{
    Vec3 radii = eval_vector(node, "radii");
    Affine place = {{{radii.x, 0, 0}, {0, radii.y, 0}, {0, 0, radii.z}}, eval_vector(node, "center")};
    place = affine_compose(to_world, &place);
    build_object(b, node, build_sphere_shape(b, 1), &place);
}

void build_torus(Builder *b, const EvalNode *node, const Affine *to_world)
{
    struct {
        char kind[8];
        double radius, tube;
    } key = {"torus", eval_number(node, "radius"), eval_number(node, "tube")};
    bool found;
    uint32_t shape = build_shape_of(b, &key, sizeof key, &found);
    if (!found) {
        Error error;
        Status status = solid_make_torus(key.radius, key.tube, &b->scene->shapes[shape].solid, &error);
        if (!build_keep_solid(b, shape, status, &error, node->span)) return;
    }
    Affine place = affine_identity();
    place.t = eval_vector(node, "center");
    place = affine_compose(to_world, &place);
    build_object(b, node, shape, &place);
}

/* What stands between two points: the frame at `from` whose y axis goes to `to`, and how far that is; false after
 * reporting. */
static bool rod_of(Builder *b, const EvalNode *node, Affine *frame, double *length)
{
    Vec3 from = eval_vector(node, "from"), to = eval_vector(node, "to");
    Vec3 along = vec3_sub(to, from);
    *length = vec3_length(along);
    if (!(*length > 0) || !isfinite(*length)) {
        diag_report(b->diag, D_DEGENERATE_SHAPE, build_span(node, "to"),
                    "'from' and 'to' of this %s are the same point", node->type->name);
        return false;
    }
    *frame = build_frame(from, vec3_scale(along, 1 / *length));
    return true;
}

void build_capsule(Builder *b, const EvalNode *node, const Affine *to_world)
{
    Affine place;
    struct {
        char kind[8];
        double radius, length;
    } key = {"capsule", eval_number(node, "radius"), 0};
    if (!rod_of(b, node, &place, &key.length)) return;
    bool found;
    uint32_t shape = build_shape_of(b, &key, sizeof key, &found);
    if (!found) {
        Error error;
        Status status = solid_make_capsule(key.radius, key.length, &b->scene->shapes[shape].solid, &error);
        if (!build_keep_solid(b, shape, status, &error, node->span)) return;
    }
    place = affine_compose(to_world, &place);
    build_object(b, node, shape, &place);
}

/* Cylinders are cones of two equal radii. */
static void build_cone_of(Builder *b, const EvalNode *node, const Affine *to_world, double radius_from,
                          double radius_to)
{
    Affine place;
    struct {
        char kind[8];
        double radius_from, radius_to, height, rounding;
    } key = {"cone", radius_from, radius_to, 0, eval_number(node, "rounding")};
    if (!rod_of(b, node, &place, &key.height)) return;
    if (radius_from == 0 && radius_to == 0) {
        diag_report(b->diag, D_DEGENERATE_SHAPE, build_span(node, "radius_from"), "both radii of this cone are 0");
        return;
    }
    double limit = solid_cone_rounding(radius_from, radius_to, key.height);
    if (key.rounding > limit * (1 + 1e-12)) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "rounding"),
                    "a rounding of %g does not fit this %s; the largest that does is %.9g", key.rounding,
                    node->type->name, num_round_down(limit, 9));
        return;
    }
    bool found;
    uint32_t shape = build_shape_of(b, &key, sizeof key, &found);
    if (!found) {
        Error error;
        Status status =
            solid_make_cone(radius_from, radius_to, key.height, key.rounding, &b->scene->shapes[shape].solid, &error);
        if (!build_keep_solid(b, shape, status, &error, node->span)) return;
    }
    place = affine_compose(to_world, &place);
    build_object(b, node, shape, &place);
}

void build_cylinder(Builder *b, const EvalNode *node, const Affine *to_world)
{
    double radius = eval_number(node, "radius");
    build_needs(b, node, "strength", "outside of a blob");
    build_cone_of(b, node, to_world, radius, radius);
}

void build_cone(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_cone_of(b, node, to_world, eval_number(node, "radius_from"), eval_number(node, "radius_to"));
}

/* One radius for each corner, from a list or a single number; NULL when there is no rounding. *ok is false
 * after reporting. */
static const double *lathe_rounding(Builder *b, const EvalNode *node, const EvalProp *profile, bool *ok)
{
    const EvalProp *rounding = eval_prop(node, "rounding");
    size_t n = profile->as.list.n;
    *ok = true;
    if (!rounding || rounding->as.list.n == n) return rounding ? rounding->as.list.numbers : NULL;
    if (rounding->as.list.n != 1) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, rounding->span,
                    "'rounding' has %zu numbers for %zu corners of the profile", rounding->as.list.n, n);
        *ok = false;
        return NULL;
    }
    double *all = ARENA_ARRAY(b->arena, double, n);
    for (size_t i = 0; i < n; i++) /* the axis is no edge: there is nothing to round on it */
        all[i] = profile->as.list.numbers[2 * i] > 0 ? rounding->as.list.numbers[0] : 0;
    return all;
}

typedef struct LatheParts {
    const EvalProp *profile;
    const double *round; /* or NULL */
    const bool *corner;  /* of a curve through all points, else NULL */
    double curve;        /* 0: straight edges; else LatheCurve + 1 */
    double smooth, tolerance;
} LatheParts;

/* Which points a curve through all has corners at; NULL after reporting. */
static const bool *lathe_corners(Builder *b, const EvalNode *node, size_t n)
{
    const EvalProp *corners = eval_prop(node, "corners");
    bool *corner = ARENA_ARRAY(b->arena, bool, n + 1);
    for (size_t i = 0; i < n; i++) corner[i] = false;
    for (size_t i = 0; corners && i < corners->as.list.n; i++) {
        double number = corners->as.list.numbers[i];
        if (!(number < (double)n) || number != floor(number)) {
            diag_report(b->diag, D_VALUE_OUT_OF_RANGE, corners->span,
                        "corner %g is none of the profile's points, which are 0 to %zu", number, n ? n - 1 : 0);
            return NULL;
        }
        corner[(size_t)number] = true;
    }
    return corner;
}

/* false after reporting */
static bool lathe_parts(Builder *b, const EvalNode *node, LatheParts *parts)
{
    const EvalProp *tolerance = eval_prop(node, "tolerance");
    const char *curve = eval_word(node, "curve");
    *parts = (LatheParts){.profile = eval_prop(node, "profile"), .tolerance = tolerance ? tolerance->as.number : 0};
    size_t n = parts->profile->as.list.n;
    if (n > 100000) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, parts->profile->span,
                    "a profile of %zu corners is too long; the limit is 100000", n);
        return false;
    }
    bool natural = strcmp(curve, "natural") == 0, through = natural || strcmp(curve, "cubic") == 0, ok = true;
    if (!through) build_needs(b, node, "corners", "on a curve that is neither cubic nor natural");
    if (strcmp(curve, "linear") == 0) {
        build_needs(b, node, "tolerance", "without a curve");
        parts->smooth = eval_truth(node, "smooth");
        parts->round = lathe_rounding(b, node, parts->profile, &ok);
        return ok;
    }
    build_needs(b, node, "rounding", "on a curve");
    build_needs(b, node, "smooth", "on a curve, which is smooth");
    parts->curve = 1 + (natural ? LATHE_NATURAL : through ? LATHE_CUBIC : LATHE_BEZIER);
    if (through) parts->corner = lathe_corners(b, node, n);
    return !through || parts->corner;
}

/* What tells shapes apart: kind, curve, smooth, tolerance, profile, rounding, corners. */
static uint32_t lathe_shape(Builder *b, const LatheParts *parts, bool *found)
{
    size_t n = parts->profile->as.list.n;
    size_t n_numbers = 4 + 2 * n + (parts->round || parts->corner ? n : 0);
    double *key = ARENA_ARRAY(b->arena, double, n_numbers);
    memcpy(key, "lathe\0\0", 8);
    key[1] = parts->curve;
    key[2] = parts->smooth;
    key[3] = parts->tolerance;
    if (n) memcpy(key + 4, parts->profile->as.list.numbers, 2 * n * sizeof *key);
    if (parts->round) memcpy(key + 4 + 2 * n, parts->round, n * sizeof *key);
    for (size_t i = 0; parts->corner && i < n; i++) key[4 + 2 * n + i] = parts->corner[i];
    return build_shape_of(b, key, n_numbers * sizeof *key, found);
}

/* The outside of a vessel alone, as other programs take it: the edge that closes the profile, from the last point to the
 * first, is slanted, and either it ends on the axis at one end only, or it is longer than all others by far. */
static void remark_open_profile(Builder *b, const LatheParts *parts)
{
    const EvalProp *profile = parts->profile;
    const double *p = profile->as.list.numbers;
    size_t n = profile->as.list.n, last = 2 * (n - 1);
    if (parts->curve == 1 + LATHE_BEZIER && n % 3 == 0) return; /* its last piece leads back */
    double across = fabs(p[last] - p[0]), up = fabs(p[last + 1] - p[1]), closing = hypot(across, up), longest = 0;
    for (size_t i = 0; i + 1 < n; i++)
        longest = fmax(longest, hypot(p[2 * i + 2] - p[2 * i], p[2 * i + 3] - p[2 * i + 1]));
    bool slanted = fmin(across, up) > .01 * closing;
    bool on_axis = p[0] <= 0 || p[last] <= 0;
    if (!slanted || (!on_axis && closing < 1.5 * longest)) return;
    Diagnostic *report = diag_report(b->diag, D_OPEN_PROFILE, profile->span,
                                     "the profile ends at <%g, %g> and is closed by a %s from there to <%g, %g>",
                                     p[last], p[last + 1], parts->corner ? "curve" : "straight edge", p[0], p[1]);
    diag_hint(b->diag, report, "lead it back along the inside, for a wall; or to the axis, for what is full");
}

void build_lathe(Builder *b, const EvalNode *node, const Affine *to_world)
{
    LatheParts parts;
    if (!lathe_parts(b, node, &parts)) return;
    size_t n = parts.profile->as.list.n;
    bool found;
    uint32_t shape = lathe_shape(b, &parts, &found);
    Solid **solid = &b->scene->shapes[shape].solid;
    if (!found) {
        double(*points)[2] = arena_array(b->arena, n ? n : 1, sizeof *points);
        for (size_t i = 0; i < 2 * n; i++) points[i / 2][i % 2] = parts.profile->as.list.numbers[i];
        Error error;
        Status status;
        if (parts.curve > 0)
            status =
                solid_make_curved_lathe((const double(*)[2])points, (uint32_t)n, (LatheCurve)((int)parts.curve - 1),
                                        parts.corner, parts.tolerance, solid, &error);
        else
            status = solid_make_lathe((const double(*)[2])points, (uint32_t)n, parts.round, parts.smooth != 0, solid,
                                      &error);
        if (!build_keep_solid(b, shape, status, &error, parts.profile->span)) return;
        if (*solid) remark_open_profile(b, &parts);
    }
    if (*solid) build_object(b, node, shape, to_world);
}

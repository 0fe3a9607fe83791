/* builtin_curve.c - curves through points, and numbers as text.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/angle.h"
#include "lang/builtin_run.h"

/* ---- splines ---- */

/* Element number at of the points; beyond the ends of an open curve the last step goes on straight. */
static void point_at(const Value *points, int64_t at, bool closed, unsigned width, double out[4])
{
    int64_t n = (int64_t)value_count(points);
    bool before = !closed && at < 0, behind = !closed && at >= n;
    int64_t end = before ? 0 : n - 1, next = before ? 1 : n - 2;
    Value value = value_element(points, (size_t)(before || behind ? end : (at % n + n) % n));
    memcpy(out, value.as.v, width * sizeof(double));
    if (!before && !behind) return;
    Value inner = value_element(points, (size_t)next);
    for (unsigned i = 0; i < width; i++) out[i] = 2 * value.as.v[i] - inner.as.v[i];
}

static bool points_fit(const BuiltinCall *call, Value *result)
{
    const Value *points = &call->args[0];
    size_t n = value_count(points);
    ValueKind kind = n ? value_element(points, 0).kind : VALUE_NONE;
    bool fine = (points->kind == VALUE_LIST || points->kind == VALUE_RANGE) && n >= 2 && value_width(kind) > 0;
    if (fine && points->kind == VALUE_LIST) fine = points->as.list->element == kind;
    if (!fine) builtin_wrong(call, 0, "a list of at least two numbers, vectors of one size or colours", result);
    return fine;
}

/* Where on a curve a call asks for. */
typedef struct CurvePlace {
    const Value *points;
    bool closed;
    unsigned width;
    int64_t step; /* between this point and the next */
    double u;     /* how far, 0 to 1 */
} CurvePlace;

/* false after a report */
static bool find_place(const BuiltinCall *call, CurvePlace *place, Value *result)
{
    if (!points_fit(call, result)) return false;
    if (call->args[1].kind != VALUE_NUMBER || (call->n > 2 && call->args[2].kind != VALUE_BOOL)) {
        builtin_wrong(call, call->args[1].kind == VALUE_NUMBER ? 2 : 1,
                      "points, a number, and whether the curve is closed", result);
        return false;
    }
    const Value *points = &call->args[0];
    bool closed = call->n > 2 && call->args[2].as.truth;
    double t = call->args[1].as.number, n_steps = (double)value_count(points) - (closed ? 0 : 1);
    if (closed) t -= floor(t);
    double at = fmin(fmax(t, 0), 1) * n_steps, step = fmin(floor(at), n_steps - 1);
    *place = (CurvePlace){points, closed, value_width(value_element(points, 0).kind), (int64_t)step, at - step};
    return true;
}

/* E. Catmull, R. Rom, "A Class of Local Interpolating Splines" (1974): between p1 and p2 the cubic whose slope at each
 * is half of the step from its neighbour to its other neighbour. */
void run_spline(const BuiltinCall *call, Value *result)
{
    CurvePlace place;
    if (!find_place(call, &place, result)) return;
    double p[4][4], u = place.u;
    for (int i = 0; i < 4; i++) point_at(place.points, place.step + i - 1, place.closed, place.width, p[i]);
    *result = value_element(place.points, 0);
    for (unsigned i = 0; i < place.width; i++) {
        double a = 2 * p[1][i], b = p[2][i] - p[0][i], c = 2 * p[0][i] - 5 * p[1][i] + 4 * p[2][i] - p[3][i];
        double d = 3 * (p[1][i] - p[2][i]) + p[3][i] - p[0][i];
        result->as.v[i] = u == 1 ? p[2][i] : (a + u * (b + u * (c + u * d))) / 2;
    }
    builtin_finite(call, result);
}

/* What a point does to the slopes falls to 2 - sqrt(3) from each point to the next: beyond so many, to 2e-18. */
enum { NATURAL_REACH = 31, NATURAL_POINTS = 2 * NATURAL_REACH + 2 };

/* The slopes at the place's two points of the cubics through p whose second derivatives agree, and are 0 at both ends;
 * C. de Boor, "A Practical Guide to Splines" (1978), ch. IV. `at`: which of the n points is the first of the two. */
static void natural_slopes(double (*p)[4], unsigned which, int n, int at, double *slope0, double *slope1)
{
    double right[NATURAL_POINTS], after[NATURAL_POINTS];
    for (int i = 0; i < n; i++) {
        bool end = i == 0 || i == n - 1;
        double step = p[i < n - 1 ? i + 1 : i][which] - p[i > 0 ? i - 1 : i][which];
        double here = (end ? 2 : 4) - (i ? after[i - 1] : 0);
        after[i] = 1 / here;
        right[i] = (3 * step - (i ? right[i - 1] : 0)) / here;
    }
    for (int i = n - 2; i >= at; i--) right[i] -= after[i] * right[i + 1];
    *slope0 = right[at];
    *slope1 = right[at + 1];
}

void run_natural_spline(const BuiltinCall *call, Value *result)
{
    CurvePlace place;
    if (!find_place(call, &place, result)) return;
    int64_t last = (int64_t)value_count(place.points) - 1, from = place.step - NATURAL_REACH,
            to = place.step + 1 + NATURAL_REACH;
    if (!place.closed && from < 0) from = 0;
    if (!place.closed && to > last) to = last;
    double p[NATURAL_POINTS][4];
    int n = (int)(to - from + 1), at = (int)(place.step - from);
    for (int i = 0; i < n; i++) point_at(place.points, from + i, place.closed, place.width, p[i]);
    *result = value_element(place.points, 0);
    for (unsigned i = 0; i < place.width; i++) {
        double start, end, a = p[at][i], b = p[at + 1][i], u = place.u;
        natural_slopes(p, i, n, at, &start, &end);
        double c = 3 * (b - a) - 2 * start - end, d = start + end - 2 * (b - a);
        result->as.v[i] = u == 1 ? b : a + u * (start + u * (c + u * d));
    }
    builtin_finite(call, result);
}

/* ---- angles ---- */

/* W. Kahan's formula: exact for small angles, where the arc cosine of a product is not. */
void run_angle(const BuiltinCall *call, Value *result)
{
    const Value *a = &call->args[0], *b = &call->args[1];
    unsigned width = a->kind == VALUE_NUMBER || a->kind == VALUE_COLOR ? 0 : value_width(a->kind);
    if (width == 0 || a->kind != b->kind) {
        builtin_wrong(call, width == 0 ? 0 : 1, "two vectors of one size", result);
        return;
    }
    double length_a = 0, length_b = 0, difference = 0, sum = 0;
    for (unsigned i = 0; i < width; i++) {
        length_a += a->as.v[i] * a->as.v[i];
        length_b += b->as.v[i] * b->as.v[i];
    }
    length_a = sqrt(length_a);
    length_b = sqrt(length_b);
    for (unsigned i = 0; i < width; i++) {
        double p = a->as.v[i] * length_b, q = b->as.v[i] * length_a;
        difference += (p - q) * (p - q);
        sum += (p + q) * (p + q);
    }
    *result = value_number(2 * atan2(sqrt(difference), sqrt(sum)) * (180 / MEN_PI));
    if (length_a == 0 || length_b == 0) result->as.number = (double)NAN;
    builtin_finite(call, result);
}

/* ---- text ---- */

enum { MOST_DIGITS = 17, WIDEST_TEXT = 64, TEXT_SIZE = 512 };

static bool whole_arg(const BuiltinCall *call, uint32_t index, int most, int *whole)
{
    *whole = 0;
    if (index >= call->n) return true;
    const Value *value = &call->args[index];
    if (value->kind != VALUE_NUMBER || !(value->as.number >= 0 && value->as.number <= most)) return false;
    *whole = (int)value->as.number;
    return (double)*whole == value->as.number;
}

void run_text(const BuiltinCall *call, Value *result)
{
    int digits, width;
    if (call->args[0].kind != VALUE_NUMBER) {
        builtin_wrong(call, 0, "a number first", result);
    } else if (!whole_arg(call, 1, MOST_DIGITS, &digits)) {
        builtin_wrong(call, 1, "a whole number of digits, 0 to 17", result);
    } else if (!whole_arg(call, 2, WIDEST_TEXT, &width)) {
        builtin_wrong(call, 2, "a whole number of characters, 0 to 64", result);
    } else {
        char text[TEXT_SIZE];
        double number = call->args[0].as.number;
        int length = snprintf(text, sizeof text, "%0*.*f", width, digits, number);
        if (strspn(text, "-0.") == (size_t)length) /* -0.00 */
            length = snprintf(text, sizeof text, "%0*.*f", width, digits, 0.0);
        *result = value_text(arena_copy_text(call->evaluator->arena, text, (size_t)length));
    }
}

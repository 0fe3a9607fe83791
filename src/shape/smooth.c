/* smooth.c - natural curves: cubics whose second derivatives agree where they meet. The velocities at the points are found from
 * equations that have three unknowns each, for every run of points between two ends by elimination, and around a curve without
 * ends by the formula of Sherman and Morrison. Each equation's own unknown outweighs its neighbours', so nothing has to be pivoted.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/smooth.h"

#include <stdlib.h>

/* before * x[i - 1] + here * x[i] + after * x[i + 1] = right[i] */
typedef struct Equation {
    double before, here, after;
} Equation;

typedef struct Natural {
    const NaturalPoints *points;
    double *velocities;
    Equation *equations; /* room for n + 1 of each */
    double *unknowns, *other,
        *after; /* right sides, then solutions; of the second system; what is left of Equation.after */
} Natural;

/* Solves n equations in place; the first has nothing before it, and the last nothing after. */
static void solve(const Natural *natural, size_t n, double *x)
{
    const Equation *e = natural->equations;
    double *after = natural->after;
    after[0] = e[0].after / e[0].here;
    x[0] /= e[0].here;
    for (size_t i = 1; i < n; i++) {
        double here = e[i].here - e[i].before * after[i - 1];
        after[i] = e[i].after / here;
        x[i] = (x[i] - e[i].before * x[i - 1]) / here;
    }
    for (size_t i = n - 1; i-- > 0;) x[i] -= after[i] * x[i + 1];
}

/* The same where what is before the first is the last, and the other way round: n is at least 3. */
static void solve_ring(const Natural *natural, size_t n, double *x)
{
    Equation *first = &natural->equations[0], *last = &natural->equations[n - 1];
    double *other = natural->other, corner = -first->here, ratio = first->before / corner;
    for (size_t i = 0; i < n; i++) other[i] = 0;
    other[0] = corner;
    other[n - 1] = last->after;
    first->here -= corner;
    last->here -= ratio * last->after;
    solve(natural, n, x);
    solve(natural, n, other);
    double share = (x[0] + ratio * x[n - 1]) / (1 + other[0] + ratio * other[n - 1]);
    for (size_t i = 0; i < n; i++) x[i] -= share * other[i];
}

static double value_at(const NaturalPoints *points, size_t i, unsigned which)
{
    return points->values[i % points->n * points->width + which];
}

/* The second derivative is the same on both sides. */
static void join(const Natural *natural, size_t i, unsigned which, Equation *equation, double *right)
{
    const NaturalPoints *points = natural->points;
    double since = points->times[(i + points->n - 1) % points->n], until = points->times[i % points->n];
    double before = value_at(points, i + points->n - 1, which), here = value_at(points, i, which);
    *equation = (Equation){until, 2 * (since + until), since};
    *right = 3 * (until / since * (here - before) + since / until * (value_at(points, i + 1, which) - here));
}

/* At an end the second derivative is 0, or the velocity where that is what the mirror image asks for; `time` of the piece there,
 * that rises by `step`. */
static Equation end_equation(NaturalAt at, unsigned which, double time, double step, double *right)
{
    bool level = at == NATURAL_MIRRORED && which > 0;
    *right = level ? 0 : 3 * step / time;
    return level ? (Equation){0, 1, 0} : (Equation){1, 2, 1};
}

static void set_piece(const Natural *natural, size_t i, unsigned which, double start, double end)
{
    const NaturalPoints *points = natural->points;
    double *velocities = natural->velocities + i % points->n * 2 * points->width, time = points->times[i % points->n];
    velocities[which] = time * start;
    velocities[points->width + which] = time * end;
}

/* The pieces from a point on, up to the next end. */
static void solve_run(const Natural *natural, size_t first, size_t n_pieces)
{
    const NaturalPoints *points = natural->points;
    size_t n = points->n, last = first + n_pieces;
    NaturalAt from = points->at ? points->at[first % n] : NATURAL_CORNER,
              to = points->at ? points->at[last % n] : NATURAL_CORNER;
    Equation *e = natural->equations;
    double *x = natural->unknowns;
    for (unsigned which = 0; which < points->width; which++) {
        e[0] = end_equation(from, which, points->times[first % n],
                            value_at(points, first + 1, which) - value_at(points, first, which), &x[0]);
        for (size_t i = 1; i < n_pieces; i++) join(natural, first + i, which, &e[i], &x[i]);
        e[n_pieces] = end_equation(to, which, points->times[(last - 1) % n],
                                   value_at(points, last, which) - value_at(points, last - 1, which), &x[n_pieces]);
        solve(natural, n_pieces + 1, x);
        for (size_t i = 0; i < n_pieces; i++) set_piece(natural, first + i, which, x[i], x[i + 1]);
    }
}

static void solve_around(const Natural *natural)
{
    const NaturalPoints *points = natural->points;
    double *x = natural->unknowns;
    for (unsigned which = 0; which < points->width; which++) {
        for (size_t i = 0; i < points->n; i++) join(natural, i, which, &natural->equations[i], &x[i]);
        solve_ring(natural, points->n, x);
        for (size_t i = 0; i < points->n; i++) set_piece(natural, i, which, x[i], x[(i + 1) % points->n]);
    }
}

static bool is_end(const NaturalPoints *points, size_t i)
{
    if (!points->closed && (i == 0 || i == points->n - 1)) return true;
    return points->at && points->at[i % points->n] != NATURAL_PASSES;
}

bool natural_velocities(const NaturalPoints *points, double *velocities)
{
    size_t n = points->n, first = 0, n_pieces = points->closed ? n : n - 1;
    Natural natural = {.points = points,
                       .velocities = velocities,
                       .equations = calloc(n + 1, sizeof(Equation)),
                       .unknowns = calloc(3 * (n + 1), sizeof(double))};
    bool fine = natural.equations && natural.unknowns;
    if (fine) {
        natural.other = natural.unknowns + n + 1;
        natural.after = natural.other + n + 1;
        while (first < n && !is_end(points, first)) first++;
        if (first == n) solve_around(&natural);
        for (size_t run = first, i = first + 1; first < n && i <= first + n_pieces; i++) {
            if (!is_end(points, i)) continue;
            solve_run(&natural, run, i - run);
            run = i;
        }
    }
    free(natural.equations);
    free(natural.unknowns);
    return fine;
}

/* orient2.c - on which side of a line a point is, without rounding.
 * A rounded determinant decides when it is larger than its error can be; else the six products of its expanded form
 * are summed as expansions: sums of doubles that do not overlap.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/orient2.h"

#include <math.h>

enum { N_PRODUCTS = 6 };

/* a * b as a sum of two doubles */
static void exact_product(double a, double b, double *high, double *low)
{
    const double splitter = 134217729; /* 2^27 + 1 */
    double x = a * b;
    double big = splitter * a, a_high = big - (big - a), a_low = a - a_high;
    big = splitter * b;
    double b_high = big - (big - b), b_low = b - b_high;
    *low = a_low * b_low - (((x - a_high * b_high) - a_low * b_high) - a_high * b_low);
    *high = x;
}

/* Adds b to an expansion of n parts, the smallest first; it then has n + 1. */
static void grow(double *parts, int n, double b)
{
    for (int i = 0; i < n; i++) {
        double sum = b + parts[i];
        double virtual_part = sum - b;
        double rest = (b - (sum - virtual_part)) + (parts[i] - virtual_part);
        parts[i] = rest;
        b = sum;
    }
    parts[n] = b;
}

int orient2(Point2 a, Point2 b, Point2 c)
{
    double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
    double determinant = left - right;
    const double bound = 3.3306690738754716e-16 * (fabs(left) + fabs(right)); /* (3 + 16 u) u, u = 2^-53 */
    if (fabs(determinant) > bound) return determinant > 0 ? 1 : -1;
    const double factors[N_PRODUCTS][2] = {{a.x, b.y}, {-a.x, c.y}, {-c.x, b.y}, {-a.y, b.x}, {a.y, c.x}, {c.y, b.x}};
    double parts[2 * N_PRODUCTS];
    for (int i = 0; i < N_PRODUCTS; i++) {
        double high, low;
        exact_product(factors[i][0], factors[i][1], &high, &low);
        grow(parts, 2 * i, low);
        grow(parts, 2 * i + 1, high);
    }
    for (int i = 2 * N_PRODUCTS - 1; i >= 0; i--) /* the largest that is not 0 has the sign of the sum */
        if (parts[i] != 0) return parts[i] > 0 ? 1 : -1;
    return 0;
}

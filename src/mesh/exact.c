/* exact.c - signs of determinants.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/exact.h"

/* A number as a sum of doubles that do not overlap, the smallest first, with no zeros among them. */
enum { MOST_TERMS = 48 }; /* 24 products of three floats, two doubles each */
typedef struct Sum {
    double terms[MOST_TERMS + 1];
    int n;
} Sum;

/* [Shewchuk 1997] grow-expansion with zero elimination. */
static void sum_add(Sum *sum, double x)
{
    int n = 0;
    for (int i = 0; i < sum->n; i++) {
        double term = sum->terms[i];
        double total = x + term;
        double of_term = total - x;
        double lost = (x - (total - of_term)) + (term - of_term);
        x = total;
        if (lost != 0) sum->terms[n++] = lost;
    }
    if (x != 0) sum->terms[n++] = x;
    sum->n = n;
}

/* The largest term is larger than all others together. */
static int sum_sign(const Sum *sum)
{
    if (sum->n == 0) return 0;
    return sum->terms[sum->n - 1] > 0 ? 1 : -1;
}

/* a b is exact in a double; its upper 26 bits and the rest times 24 bits are exact again. */
static void sum_add_product(Sum *sum, double a, double b, double c)
{
    double product = a * b;
    double large = product * 134217729; /* 2^27 + 1 */
    double upper = large - (large - product);
    sum_add(sum, (product - upper) * c);
    sum_add(sum, upper * c);
}

/* sign * det(a, b, c) */
static void sum_add_determinant(Sum *sum, double sign, Vec3 a, Vec3 b, Vec3 c)
{
    sum_add_product(sum, a.x, b.y, sign * c.z);
    sum_add_product(sum, a.y, b.z, sign * c.x);
    sum_add_product(sum, a.z, b.x, sign * c.y);
    sum_add_product(sum, a.z, b.y, -sign * c.x);
    sum_add_product(sum, a.y, b.x, -sign * c.z);
    sum_add_product(sum, a.x, b.z, -sign * c.y);
}

static bool all_equal(float a, float b, float c, float d)
{
    return a == b && b == c && c == d;
}

int exact_side_of_plane(Vec3f a, Vec3f b, Vec3f c, Vec3f d)
{
    const double bound = 7.771561172376103e-16; /* (7 + 56 e) e with e = 2^-53 */
    Vec3 ad = vec3_from_f(a), bd = vec3_from_f(b), cd = vec3_from_f(c), dd = vec3_from_f(d);
    Vec3 p = vec3_sub(bd, ad), q = vec3_sub(cd, ad), r = vec3_sub(dd, ad);
    double xy = p.x * q.y, yx = p.y * q.x, yz = p.y * q.z, zy = p.z * q.y, zx = p.z * q.x, xz = p.x * q.z;
    double determinant = r.x * (yz - zy) + r.y * (zx - xz) + r.z * (xy - yx);
    double size =
        fabs(r.x) * (fabs(yz) + fabs(zy)) + fabs(r.y) * (fabs(zx) + fabs(xz)) + fabs(r.z) * (fabs(xy) + fabs(yx));
    if (determinant > bound * size) return 1;
    if (determinant < -bound * size) return -1;
    /* what is flat along an axis is common, and exact arithmetic is slow */
    if (all_equal(a.x, b.x, c.x, d.x) || all_equal(a.y, b.y, c.y, d.y) || all_equal(a.z, b.z, c.z, d.z)) return 0;
    Sum sum = {.n = 0};
    sum_add_determinant(&sum, 1, bd, cd, dd);
    sum_add_determinant(&sum, -1, ad, cd, dd);
    sum_add_determinant(&sum, 1, ad, bd, dd);
    sum_add_determinant(&sum, -1, ad, bd, cd);
    return sum_sign(&sum);
}

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

int exact_turn(Point2 a, Point2 b, Point2 c)
{
    double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
    double determinant = left - right;
    const double bound = 3.3306690738754716e-16 * (fabs(left) + fabs(right)); /* (3 + 16 e) e */
    if (fabs(determinant) > bound) return determinant > 0 ? 1 : -1;
    /* what lies along an axis is common, and exact arithmetic is slow */
    if ((a.x == b.x && b.x == c.x) || (a.y == b.y && b.y == c.y)) return 0;
    const double factors[6][2] = {{a.x, b.y}, {-a.x, c.y}, {-c.x, b.y}, {-a.y, b.x}, {a.y, c.x}, {c.y, b.x}};
    Sum sum = {.n = 0};
    for (int i = 0; i < 6; i++) {
        double high, low;
        exact_product(factors[i][0], factors[i][1], &high, &low);
        sum_add(&sum, low);
        sum_add(&sum, high);
    }
    return sum_sign(&sum);
}

static Point2 seen_along_x(Vec3f p)
{
    return (Point2){(double)p.y, (double)p.z};
}

int exact_pierce_along_x(Vec3f a, Vec3f b, Vec3f c, Vec3f p, bool *at_edge)
{
    const Point2 corners[3] = {seen_along_x(a), seen_along_x(b), seen_along_x(c)};
    int turn = exact_turn(corners[0], corners[1], corners[2]), least = 1, most = -1;
    for (int k = 0; k < 3; k++) {
        int side = exact_turn(corners[k], corners[(k + 1) % 3], seen_along_x(p));
        least = side < least ? side : least;
        most = side > most ? side : most;
    }
    if (least < 0 && most > 0) return 0; /* beside it */
    if (turn != 0 && least != 0 && most != 0) return turn;
    *at_edge = true;
    return 0;
}

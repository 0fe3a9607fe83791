/* tube_test.c - tori and arcs of revolution against a reference in long double that shares no code with them: the
 * quartic, its derivatives solved one after the other, so that every real root is bracketed.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <float.h>

#include "dice.h"
#include "near.h"

#include "shape/piece.h"

static const double pi = 3.14159265358979323846;

/* ---- the reference ---- */

typedef struct Poly {
    int degree;
    long double c[5]; /* c[k] x^k */
} Poly;

static long double poly_at(const Poly *p, long double x)
{
    long double sum = 0;
    for (int k = p->degree; k >= 0; k--) sum = sum * x + p->c[k];
    return sum;
}

/* All sign changes within +-reach, by bisection between the roots of the derivative. */
static int poly_roots(const Poly *p, long double reach, long double *roots)
{
    if (p->degree == 0) return 0;
    Poly d = {.degree = p->degree - 1};
    for (int k = 0; k < p->degree; k++) d.c[k] = (long double)(k + 1) * p->c[k + 1];
    long double cuts[8];
    int n_cuts = 0, n = 0;
    cuts[n_cuts++] = -reach;
    n_cuts += poly_roots(&d, reach, cuts + 1);
    cuts[n_cuts++] = reach;
    for (int i = 0; i + 1 < n_cuts; i++) {
        long double a = cuts[i], b = cuts[i + 1];
        bool sign = poly_at(p, a) < 0;
        if (sign == (poly_at(p, b) < 0)) continue;
        for (int k = 0; k < 70; k++) {
            long double m = 0.5L * (a + b);
            if ((poly_at(p, m) < 0) == sign)
                a = m;
            else
                b = m;
        }
        roots[n++] = 0.5L * (a + b);
    }
    return n;
}

/* |p|^2 + c^2 - a^2 squared, less 4 c^2 r^2, about the point nearest to the centre; *base is its t. */
static Poly torus_quartic(double c, double a, Vec3 org, Vec3 dir, long double *base)
{
    long double o[3] = {org.x, org.y, org.z}, d[3] = {dir.x, dir.y, dir.z}, od = 0, dd = 0, oo = 0;
    for (int i = 0; i < 3; i++) {
        od += o[i] * d[i];
        dd += d[i] * d[i];
    }
    *base = -od / dd;
    od = 0;
    for (int i = 0; i < 3; i++) {
        o[i] += *base * d[i];
        oo += o[i] * o[i];
        od += o[i] * d[i];
    }
    long double C = c, A = a, s = oo + (C - A) * (C + A), four = 4 * C * C;
    long double level[3] = {o[0] * o[0] + o[2] * o[2], 2 * (o[0] * d[0] + o[2] * d[2]), d[0] * d[0] + d[2] * d[2]};
    return (Poly){4,
                  {s * s - four * level[0], 4 * s * od - four * level[1], 4 * od * od + 2 * s * dd - four * level[2],
                   4 * dd * od, dd * dd}};
}

/* ---- tori ---- */

static Vec3 torus_point(Dice *dice, double c, double a)
{
    double turn = 2 * pi * dice_unit(dice), around = 2 * pi * dice_unit(dice);
    if (dice_unit(dice) < 0.2) around = pi / 2 * floor(4 * dice_unit(dice));
    double r = c + a * cos(around);
    return vec3(r * cos(turn), a * sin(around), r * sin(turn));
}

enum { TORUS_KINDS = 12, LINES_PER_TORUS = 48000 };

static void torus_line(Dice *dice, double c, double a, int kind, Vec3 *org, Vec3 *dir)
{
    Vec3 p = torus_point(dice, c, a), q = torus_point(dice, c, a), random = dice_direction(dice);
    double size = c + a, tiny = dice_tiny(dice);
    Vec3 box = vec3(size * (2.2 * dice_unit(dice) - 1.1), a * (2.2 * dice_unit(dice) - 1.1),
                    size * (2.2 * dice_unit(dice) - 1.1));
    *org = vec3_scale(random, 3 * size);
    *dir = vec3_sub(box, *org);
    switch (kind) {
    case 0: break; /* from outside */
    case 1:
        *org = box;
        *dir = random;
        break; /* from anywhere in or about it */
    case 2:
        *org = p;
        *dir = random;
        break; /* from the surface */
    case 3:
        *org = p;
        *dir = vec3_sub(q, p);
        break; /* from one point of it to another */
    case 4:
        *org = vec3_scale(random, 1e6 * size);
        *dir = vec3_sub(box, *org);
        break;
    case 5:
        *org = vec3(box.x, 5 * size, box.z);
        *dir = vec3(0, -1, 0);
        break;
    case 6:
        *org = p;
        *dir = vec3(tiny * random.x, 1, tiny * random.z);
        break;
    case 7:
        *org = vec3(p.x, p.y, p.z);
        *dir = vec3(random.x, tiny * random.y, random.z);
        break;
    case 8:
        *org = vec3(0, box.y, 0);
        *dir = random;
        break; /* through the axis */
    case 9:
        *org = vec3(p.x, p.y, p.z);
        *dir = vec3(-p.z, tiny * size, p.x);
        break; /* along a circle of latitude */
    case 10: { /* tangent to the tube's own circle */
        double r = hypot(p.x, p.z);
        Vec3 out = vec3(p.x / r, 0, p.z / r);
        double nr = r - c;
        *dir = vec3_along(vec3(-out.x * p.y, nr, -out.z * p.y), tiny * a, random);
        *org = vec3_along(p, -5 * size / a, *dir);
        break;
    }
    default: { /* nearly the asymptotic lines of the saddle: four crossings close together */
        double angle = atan(sqrt(a / fmax(c - a, 1e-3 * c))) + 0.2 * (dice_unit(dice) - 0.5) * sqrt(tiny);
        *org = vec3((c - a) * (1 + 0.2 * tiny * (dice_unit(dice) - 0.5)), 0.1 * a * tiny * random.y, 0);
        *dir = vec3(0, cos(angle), sin(angle));
    }
    }
}

typedef struct Tally {
    long lines, crossings, several, unlike;
    double worst; /* a root's distance from the surface, in rounding of the coordinates */
} Tally;

/* How far p is from the surface of the torus. */
static long double torus_distance(double c, double a, Vec3 org, Vec3 dir, double t)
{
    long double x = (long double)org.x + (long double)t * dir.x, y = (long double)org.y + (long double)t * dir.y,
                z = (long double)org.z + (long double)t * dir.z;
    return fabsl(hypotl(hypotl(x, z) - c, y) - a);
}

/* Takes out the crossings with the void of a spindle torus, which the quartic knows and we fill. */
static int keep_outer(double c, double a, Vec3 org, Vec3 dir, long double base, long double *roots, int n)
{
    int kept = 0;
    for (int i = 0; i < n; i++) {
        long double t = base + roots[i], y = org.y + t * dir.y, r = hypotl(org.x + t * dir.x, org.z + t * dir.z);
        if (fabsl(hypotl(r - c, y) - a) <= fabsl(hypotl(r + c, y) - a)) roots[kept++] = roots[i];
    }
    return kept;
}

/* Where the counts differ, the line must graze the surface: between the crossings that only one has found, it is within
 * rounding of the surface. */
static void check_torus_line(const Piece *torus, Vec3 org, Vec3 dir, int kind, Tally *tally)
{
    double c = torus->r0, a = torus->r1, t[PIECE_MAX_ROOTS];
    int n = piece_intersect(torus, org, dir, -HUGE_VAL, HUGE_VAL, t);
    double scale = vec3_max_abs(org) + c + a, length = vec3_length(dir);
    tally->lines++;
    if (n % 2) fail_msg("a line meets a torus %d times", n);
    for (int i = 0; i < n; i++) {
        if (i && !(t[i] > t[i - 1])) fail_msg("crossings out of order");
        double side = vec3_dot(piece_normal(torus, org, dir, t[i]), dir);
        if ((side > 0) != (i % 2 == 1))
            fail_msg("crossing %d of %d (kind %d) goes the wrong way: %g", i, n, kind, side);
        long double off = torus_distance(c, a, org, dir, t[i]) / (DBL_EPSILON * (scale + fabs(t[i]) * length));
        tally->worst = fmax(tally->worst, (double)off);
        tally->crossings++;
    }
    tally->several += n == 4;
    long double base, roots[5];
    Poly quartic = torus_quartic(c, a, org, dir, &base);
    int m = keep_outer(c, a, org, dir, base, roots, poly_roots(&quartic, 4 * (c + a) / length, roots));
    if (n == m) {
        for (int i = 0; i < n; i++) {
            /* the error along the line is that across it, divided by the cosine; where it grazes, a root of it */
            double cosine = fabs(vec3_dot(piece_normal(torus, org, dir, t[i]), dir)) / length;
            Vec3 p = vec3_along(org, t[i], dir);
            if (a > c && hypot(p.x, p.z) < 1e-3 * a) continue; /* at a spindle's tip the reference knows less than we */
            double off = fabs(t[i] - (double)(base + roots[i])) * length, noise = 64 * DBL_EPSILON * scale;
            if (cosine > 1e-3 ? off * cosine > noise : pow(off / (c + a), 4) > 1e3 * noise / a)
                fail_msg("kind %d: a crossing is %g off (cosine %g)", kind, off, cosine);
        }
        return;
    }
    tally->unlike++;
    /* every crossing of the longer list that has no partner in the other is close to a tangent */
    for (int i = 0; i < (n > m ? n : m); i++) {
        double here = n > m ? t[i] : (double)(base + roots[i]);
        bool partner = false;
        for (int k = 0; k < (n > m ? m : n); k++) {
            double there = n > m ? (double)(base + roots[k]) : t[k];
            partner |= fabs(here - there) * length < 1e-6 * a;
        }
        Vec3 p = vec3_along(org, here, dir);
        double r = hypot(p.x, p.z), nr = r - c;
        Vec3 normal = vec3_normalize(vec3(r > 0 ? p.x / r * nr : nr, p.y, r > 0 ? p.z / r * nr : 0));
        double cosine = fabs(vec3_dot(normal, dir)) / length;
        bool pole = r < 1e-6 * (c + a); /* a spindle's tips: no tangent plane */
        if (!partner && !pole && cosine > 1e-3 * sqrt(scale / a))
            fail_msg("kind %d: %d crossings instead of %d, cosine %g", kind, n, m, cosine);
    }
}

static void test_tori_against_the_quartic(void **state)
{
    (void)state;
    const double sizes[][2] = {{1, 0.5}, {3, 1},     {1, 0.999},   {1, 1},     {1, 1.5},
                               {1, 40},  {10, 0.01}, {1e-6, 3e-7}, {1e8, 4e7}, {2, 1.9}};
    for (size_t s = 0; s < COUNT_OF(sizes); s++) {
        Tally tally = {0};
        Dice dice = {1000003 * (s + 1)};
        Piece torus = {.kind = PIECE_TORUS, .r0 = sizes[s][0], .r1 = sizes[s][1]};
        for (int i = 0; i < LINES_PER_TORUS; i++) {
            Vec3 org, dir;
            torus_line(&dice, torus.r0, torus.r1, i % TORUS_KINDS, &org, &dir);
            if (vec3_dot(dir, dir) > 0) check_torus_line(&torus, org, dir, i % TORUS_KINDS, &tally);
        }
        printf("    torus %g, %g: %ld crossings of %ld lines, %ld met it four times; %ld grazing ones counted "
               "otherwise; at most "
               "%.1f roundings off the surface\n",
               torus.r0, torus.r1, tally.crossings, tally.lines, tally.several, tally.unlike, tally.worst);
        assert_true(tally.crossings > LINES_PER_TORUS);
        assert_true(tally.worst < 8);
    }
}

/* A line that starts on a torus, told so, meets what it meets otherwise, all but its start; and by far most lines are spared
 * that one. */
static void test_starts_are_left_out(void **state)
{
    (void)state;
    const Piece torus = {.kind = PIECE_TORUS, .r0 = 3, .r1 = 1};
    const double noise = 1e-9;
    Dice dice = {77};
    long n_starts = 0, n_left_out = 0, n_others = 0;
    for (int i = 0; i < 200000; i++) {
        double turn = 2 * pi * dice_unit(&dice), tilt = 2 * pi * dice_unit(&dice);
        Vec3 normal = {cos(tilt) * cos(turn), sin(tilt), cos(tilt) * sin(turn)};
        Vec3 org = {(torus.r0 + torus.r1 * cos(tilt)) * cos(turn), torus.r1 * sin(tilt),
                    (torus.r0 + torus.r1 * cos(tilt)) * sin(turn)};
        Vec3 dir = dice_direction(&dice);
        bool inside = vec3_dot(normal, dir) < 0;
        PieceLine line = piece_line(org, dir);
        PieceCrossings all, told;
        piece_cross(&torus, &line, -noise, HUGE_VAL, PIECE_START_ELSEWHERE, &all);
        piece_cross(&torus, &line, -noise, HUGE_VAL, inside ? PIECE_START_INSIDE : PIECE_START_OUTSIDE, &told);
        int k = 0;
        for (int j = 0; j < all.n; j++) {
            bool start = fabs(all.t[j]) < noise && all.leaving[j] != inside;
            n_starts += start;
            n_others += !start;
            if (k < told.n && told.t[k] == all.t[j] && told.leaving[k] == all.leaving[j]) {
                k++;
                continue;
            }
            assert_true(start); /* what is not there must be the start */
            n_left_out++;
        }
        assert_int_equal(k, told.n);
    }
    printf("    %ld starts, %ld of them left out; %ld other crossings, all found\n", n_starts, n_left_out, n_others);
    assert_true(n_left_out > n_starts * 9 / 10 && n_others > 100000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tori_against_the_quartic),
        cmocka_unit_test(test_starts_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

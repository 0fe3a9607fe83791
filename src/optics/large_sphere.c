/* large_sphere.c - see large_sphere.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/large_sphere.h"

#include <math.h>
#include <stdbool.h>

#include "base/angle.h"
#include "base/lanes.h"

/* Airy's argument: what is kept of it. On the dark side nothing is left at the end of it, on the other it is a sum of waves. */
#define AIRY_DARK (-6.0)
#define AIRY_LIT 4.0

/* ---- rays ---- */

/* Rays of p chords, by their angles of incidence from `low` to `high`, along which their turning grows, or falls. */
typedef struct Branch {
    double index;
    int p;
    double low, high;
} Branch;

static double refracted(double index, double incidence)
{
    return asin(fmin(sin(incidence) / index, 1));
}

/* By how much a ray is turned, not brought into 0 .. pi: [Hulst57] 12.2. */
static double turning(double index, int p, double incidence)
{
    return (p - 1) * MEN_PI + 2 * incidence - 2 * p * refracted(index, incidence);
}

/* The steepest incidence that lets a ray in. */
static double last_incidence(double index)
{
    return index < 1 ? asin(index) : MEN_PI / 2;
}

/* The incidence of a ray that is turned by that much; false: none of the branch is. */
static bool find_incidence(const Branch *branch, double wanted, double *incidence)
{
    double ends[2] = {branch->low, branch->high}, off[2];
    for (int k = 0; k < 2; k++) off[k] = turning(branch->index, branch->p, ends[k]) - wanted;
    if (!(off[0] * off[1] <= 0) || ends[0] >= ends[1]) return false;
    *incidence = ends[0];
    for (int i = 0, last = -1; i < 60 && off[1] != off[0]; i++) { /* false position, Illinois' way */
        *incidence = (ends[0] * off[1] - ends[1] * off[0]) / (off[1] - off[0]);
        double here = turning(branch->index, branch->p, *incidence) - wanted;
        if (fabs(here) < 1e-11) break;
        int k = here * off[0] > 0 ? 0 : 1;
        if (k == last) off[1 - k] *= 0.5;
        ends[k] = *incidence;
        off[k] = here;
        last = k;
    }
    return true;
}

/* Fresnel's amplitudes of what is reflected outside: across the plane, and in it. */
static void reflected(double index, double incidence, double r[2])
{
    double within = refracted(index, incidence), ci = cos(incidence), cr = cos(within);
    r[0] = (ci - index * cr) / (ci + index * cr);
    r[1] = (index * ci - cr) / (index * ci + cr);
}

/* How much of the sphere's shadow goes into a solid angle, over the sphere's shadow times pi: [Hulst57] 12.22. Where rays from a
 * ring meet in the axis, what waves would make of that is cut off. */
static double gathering(const Branch *branch, double incidence, double angle)
{
    double within = refracted(branch->index, incidence);
    double slope = fabs(2 - 2 * branch->p * cos(incidence) / (branch->index * fmax(cos(within), 1e-9)));
    double least = fmax(fmin(sin(incidence) / 20, 0.01), 1e-9);
    return sin(incidence) * cos(incidence) / (fmax(sin(angle), least) * fmax(slope, 1e-9));
}

static void amplitudes(const Branch *branch, double incidence, double angle, double a[2])
{
    double r[2], root = sqrt(gathering(branch, incidence, angle));
    reflected(branch->index, incidence, r);
    for (int k = 0; k < 2; k++) {
        a[k] = (1 - r[k] * r[k]) * root;
        for (int i = 1; i < branch->p; i++) a[k] *= -r[k];
    }
}

/* Half the length of its way beyond that of one through the middle of an empty sphere, over the radius: [Hulst57] 12.21. */
static double way(const Branch *branch, double incidence)
{
    return 2 * (cos(incidence) - branch->p * branch->index * cos(refracted(branch->index, incidence)));
}

/* ---- pairs of rays about a bow ---- */

typedef struct Bow {
    double index, incidence, turning;
    double narrow; /* z for each radian from the bow */
    int p;
} Bow;

/* The least turning of rays of p chords: [Hulst57] 13.1; false: they have none. */
static bool find_bow(double index, int p, Bow *bow)
{
    double cosine2 = (index * index - 1) / (p * p - 1.0);
    if (p < 2 || !(cosine2 > 1e-4 && cosine2 < 1 - 1e-4)) return false;
    double incidence = acos(sqrt(cosine2)), within = refracted(index, incidence);
    double ci = cos(incidence), cr = cos(within), first = ci / (index * cr);
    double second = -sin(incidence) / (index * cr) + ci * sin(within) * first / (index * cr * cr);
    *bow = (Bow){index, incidence, turning(index, p, incidence), cbrt(2 * ci * ci / (-2 * p * second)), p};
    return true;
}

/* Both rays that are turned by `off` more than at the bow; false: there is but the first, or none. *alone: the first. */
static bool find_pair(const Bow *bow, double off, double angle, LargePair *pair, double alone[2])
{
    Branch steep = {bow->index, bow->p, 0, bow->incidence}, flat = {bow->index, bow->p, bow->incidence, MEN_PI / 2};
    double first, second, a[2], b[2] = {0, 0};
    alone[0] = alone[1] = 0;
    if (!find_incidence(&steep, bow->turning + off, &first)) return false;
    amplitudes(&steep, first, angle, a);
    if (!find_incidence(&flat, bow->turning + off, &second)) {
        for (int k = 0; k < 2; k++) alone[k] = a[k];
        return false;
    }
    amplitudes(&flat, second, angle, b);
    double z = cbrt(9.0 / 16 * pow(way(&flat, second) - way(&steep, first), 2)), root = sqrt(sqrt(z));
    pair->z = (float)z;
    for (int k = 0; k < 2; k++) {
        pair->sum[k] = (float)((a[k] + b[k]) * root);
        pair->difference[k] = (float)((a[k] - b[k]) / root);
    }
    return true;
}

/* Closer to a bow than the first, in radians, both rays are what they are there; and beyond it by more than the second no sphere
 * sends any light. */
static const double at_bow = 1e-3, darkest = -0.3;

static void add_about_bow(const Bow *bow, double turned, double angle, LargeRays *rays)
{
    double off = turned - bow->turning, alone[2];
    LargePair pair;
    if (off < darkest || rays->n >= LARGE_MOST_RAYS) return;
    if (find_pair(bow, fmax(off, at_bow), angle, &pair, alone)) {
        if (off < at_bow) pair.z = (float)(bow->narrow * off);
        rays->pairs[rays->n++] = pair;
    } else {
        rays->plain += (float)(0.5 * (alone[0] * alone[0] + alone[1] * alone[1]));
    }
}

static void add_chords(double index, int p, double angle, LargeRays *rays)
{
    Bow bow;
    bool bows = find_bow(index, p, &bow);
    const Branch whole = {index, p, 0, last_incidence(index)};
    for (int turns = -p; turns <= p; turns++) {
        for (int side = -1; side <= 1; side += 2) {
            double turned = 2 * MEN_PI * turns + side * angle, incidence, a[2];
            if (bows) {
                add_about_bow(&bow, turned, angle, rays);
            } else if (find_incidence(&whole, turned, &incidence)) {
                amplitudes(&whole, incidence, angle, a);
                rays->plain += (float)(0.5 * (a[0] * a[0] + a[1] * a[1]));
            }
        }
    }
}

void large_rays(double index, double angle, LargeRays *rays)
{
    angle = fmin(fmax(angle, 1e-5), MEN_PI - 1e-5); /* in the axis itself rings are points */
    double incidence = 0.5 * (MEN_PI - angle), r[2] = {1, 1};
    *rays = (LargeRays){0};
    if (incidence < last_incidence(index)) reflected(index, incidence, r);
    rays->plain = (float)(0.125 * (r[0] * r[0] + r[1] * r[1]));
    for (int p = 1; p <= LARGE_MOST_CHORDS; p++) add_chords(index, p, angle, rays);
}

/* ---- Airy's function ---- */

/* Ai and Ai' by their series: M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions" (1964), 10.4.2 to 10.4.5. */
static void airy_at(double z, double *value, double *slope)
{
    const double c1 = 0.355028053887817239, c2 = 0.258819403792806798;
    double f = 1, g = z, of_f = 0, of_g = 1, term_f = 1, term_g = z, z3 = z * z * z;
    for (int k = 1; k < 60; k++) {
        double n = 3.0 * k;
        term_f *= z3 / (n * (n - 1));
        term_g *= z3 / (n * (n + 1));
        f += term_f;
        g += term_g;
        if (z != 0) {
            of_f += n * term_f / z;
            of_g += (n + 1) * term_g / z;
        }
    }
    *value = c1 * f - c2 * g;
    *slope = c1 * of_f - c2 * of_g;
}

void large_airy(LargeAiry *airy)
{
    for (int i = 0; i <= LARGE_AIRY_STEPS; i++) {
        double value, slope;
        airy_at(-(AIRY_DARK + (AIRY_LIT - AIRY_DARK) * i / LARGE_AIRY_STEPS), &value, &slope);
        airy->value[i] = (float)value;
        airy->slope[i] = (float)slope;
    }
}

/* ---- diffraction ---- */

/* What is left of a wave in the mean over a range of phases. */
static double blurred(double range)
{
    double half = 0.5 * range;
    return fabs(half) < 1e-3 ? 1 : sin(half) / half;
}

/* (J1(u) / u)^2, in the mean over u (1 - spread / 2) to u (1 + spread / 2). J1: Abramowitz and Stegun, 9.4.4 and 9.4.6. */
static double disc(double u, double spread)
{
    double t = u / 3;
    if (u <= 3) {
        double t2 = t * t;
        double j =
            0.5 +
            t2 * (-0.56249985 +
                  t2 * (0.21093573 + t2 * (-0.03954289 + t2 * (0.00443319 + t2 * (-0.00031761 + t2 * 0.00001109)))));
        return j * j;
    }
    t = 1 / t;
    double size =
        0.79788456 +
        t * (0.00000156 + t * (0.01659667 + t * (0.00017105 + t * (-0.00249511 + t * (0.00113653 + t * -0.00020033)))));
    double phase =
        u - 2.35619449 +
        t * (0.12499612 + t * (0.0000565 + t * (-0.00637879 + t * (0.00074348 + t * (0.00079824 + t * -0.00029166)))));
    return size * size / (u * u * u) * 0.5 * (1 + cos(2 * phase) * blurred(2 * u * spread));
}

/* ---- all together ---- */

/* Both rays of a pair, over x^(1/3) and more: [CFU57]. Where they are many waves apart, what the sizes of the spheres leave of
 * these. */
static double pair_intensity(const LargeAiry *airy, const LargePair *pair, double third, double x, double spread)
{
    double z = (double)pair->z, at = z * third * third, sum = 0, difference = 0;
    for (int k = 0; k < 2; k++) {
        sum += 0.5 * (double)pair->sum[k] * (double)pair->sum[k];
        difference += 0.5 * (double)pair->difference[k] * (double)pair->difference[k];
    }
    if (at <= AIRY_DARK) return 0;
    if (at >= AIRY_LIT) {
        double root = sqrt(z), apart = 4.0 / 3 * x * z * root, wave = sin(apart) * blurred(apart * spread);
        return 0.5 * (sum / root * (1 + wave) + difference * root * (1 - wave));
    }
    double place = (at - AIRY_DARK) * (LARGE_AIRY_STEPS / (AIRY_LIT - AIRY_DARK));
    int i = place < LARGE_AIRY_STEPS - 1 ? (int)place : LARGE_AIRY_STEPS - 1;
    double part = place - i;
    double value = (double)airy->value[i] + part * (double)(airy->value[i + 1] - airy->value[i]);
    double slope = (double)airy->slope[i] + part * (double)(airy->slope[i + 1] - airy->slope[i]);
    return MEN_PI * (sum * third * value * value + difference / third * slope * slope);
}

float large_intensity(const LargeAiry *airy, const LargeRays *rays, double x, double spread, double angle,
                      double diffracted)
{
    double third = cbrt(x), oblique = 0.5 * (1 + cos(angle)), sum = (double)rays->plain;
    if (diffracted > 0) sum += diffracted * x * x * disc(x * sin(angle), spread) * oblique * oblique;
    for (uint32_t i = 0; i < rays->n; i++) sum += pair_intensity(airy, &rays->pairs[i], third, x, spread);
    return (float)sum;
}

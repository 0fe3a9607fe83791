/* phase.c - phase functions: evaluated in closed form, sampled by inverting the closed form of their integral.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/phase.h"

#include <math.h>

#include "optics/sampling.h"

/* Below this a lobe is taken as symmetric: the integral's closed form divides by g^3. */
#define LEAST_G 1e-3

static PhaseLobe make_lobe(double g, double alpha)
{
    return (PhaseLobe){fabs(g) < LEAST_G ? 0 : g, alpha};
}

Phase phase_isotropic(void)
{
    return phase_hg(0);
}

Phase phase_hg(double g)
{
    return (Phase){1, {make_lobe(g, 0), {0, 0}}, NULL};
}

Phase phase_draine(double g, double alpha)
{
    return (Phase){1, {make_lobe(g, alpha), {0, 0}}, NULL};
}

Phase phase_two_hg(double g1, double g2, double weight)
{
    return (Phase){weight, {make_lobe(g1, 0), make_lobe(g2, 0)}, NULL};
}

Phase phase_of_table(const PhaseTable *table)
{
    return (Phase){1, {{0, 0}, {0, 0}}, table};
}

static double lobe_scale(PhaseLobe lobe)
{
    double g2 = lobe.g * lobe.g;
    return (1 - g2) / (4 * (double)SAMPLING_PI * (1 + lobe.alpha * (1 + 2 * g2) / 3));
}

static double lobe_evaluate(PhaseLobe lobe, double cosine)
{
    double s2 = 1 + lobe.g * lobe.g - 2 * lobe.g * cosine;
    return lobe_scale(lobe) * (1 + lobe.alpha * cosine * cosine) / (s2 * sqrt(s2));
}

float phase_evaluate_lobes(const Phase *phase, float cosine)
{
    double p = phase->weight * lobe_evaluate(phase->lobes[0], (double)cosine);
    if (phase->weight < 1) p += (1 - phase->weight) * lobe_evaluate(phase->lobes[1], (double)cosine);
    return (float)p;
}

/* The squared sine of half the angle between two unit vectors, small ones too as well as floats tell them apart. */
static float half_turn(Vec3f along, Vec3f direction)
{
    bool back = vec3f_dot(along, direction) < 0;
    Vec3f between = back ? vec3f_add(direction, along) : vec3f_sub(direction, along);
    float part = float_min(0.25f * vec3f_dot(between, between), 1);
    return back ? 1 - part : part;
}

Lanes phase_evaluate(const Phase *phase, Vec3f along, Vec3f direction, Lanes wavelength_nm)
{
    if (LIKELY(!phase->table)) return lanes_all(phase_evaluate_lobes(phase, vec3f_dot(along, direction)));
    return phase_table_at(phase->table, half_turn(along, direction), wavelength_nm);
}

/* The indefinite integral of the lobe, without its scale, over the cosine. With s^2 = 1 + g^2 - 2 g u it is one over
 * powers of s. */
static double lobe_integral(PhaseLobe lobe, double cosine)
{
    double g = lobe.g, a = lobe.alpha;
    if (g == 0) return cosine + a * cosine * cosine * cosine / 3;
    double sum = 1 + g * g, s = sqrt(sum - 2 * g * cosine), g2 = 4 * g * g;
    return ((1 + a * sum * sum / g2) / s + 2 * a * sum * s / g2 - a * s * s * s / (3 * g2)) / g;
}

/* The cosine below which the share u of the lobe lies. */
static double lobe_invert(PhaseLobe lobe, double u)
{
    double g = lobe.g;
    if (lobe.alpha == 0) {
        if (g == 0) return 2 * u - 1;
        double s = (1 - g * g) / (1 - g + 2 * g * u);
        return fmin(fmax((1 + g * g - s * s) / (2 * g), -1), 1);
    }
    double from = lobe_integral(lobe, -1), whole = lobe_integral(lobe, 1) - from, low = -1, high = 1;
    double scale = lobe_scale(lobe) * 2 * (double)SAMPLING_PI * whole; /* 1 up to rounding */
    double cosine = 2 * u - 1;
    for (int i = 0; i < 60; i++) { /* Newton, held within brackets */
        double off = (lobe_integral(lobe, cosine) - from) / whole - u;
        if (off > 0)
            high = cosine;
        else
            low = cosine;
        if (fabs(off) < 1e-12 || high - low < 1e-12) break;
        double next = cosine - off * scale / (2 * (double)SAMPLING_PI * lobe_evaluate(lobe, cosine));
        cosine = next > low && next < high ? next : 0.5 * (low + high);
    }
    return cosine;
}

static Vec3f turned(Vec3f along, float cosine, float sine, float u)
{
    float x, y;
    sampling_circle(u, &x, &y);
    return sampling_to_world(vec3f(sine * x, sine * y, cosine), along);
}

Vec3f phase_sample(const Phase *phase, Vec3f along, const float u[2], Lanes wavelength_nm, Lanes *pdf_w)
{
    if (UNLIKELY(phase->table)) {
        float s = phase_table_sample(phase->table, u[0], lanes_get(wavelength_nm, 0));
        *pdf_w = phase_table_at(phase->table, s, wavelength_nm);
        return turned(along, 1 - 2 * s, 2 * sqrtf(s * (1 - s)), u[1]);
    }
    double share = (double)u[0];
    bool second = share >= phase->weight;
    share = second ? (share - phase->weight) / (1 - phase->weight) : share / phase->weight;
    float cosine = (float)lobe_invert(phase->lobes[second], share);
    *pdf_w = lanes_all(phase_evaluate_lobes(phase, cosine));
    return turned(along, cosine, sqrtf(fmaxf(0, 1 - cosine * cosine)), u[1]);
}

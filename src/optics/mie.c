/* mie.c - see mie.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/mie.h"

#include <math.h>

static MieNumber divide(MieNumber a, MieNumber b)
{
    double of_b = b.re * b.re + b.im * b.im;
    return (MieNumber){(a.re * b.re + a.im * b.im) / of_b, (a.im * b.re - a.re * b.im) / of_b};
}

static MieNumber multiply(MieNumber a, MieNumber b)
{
    return (MieNumber){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static double squared(MieNumber a)
{
    return a.re * a.re + a.im * a.im;
}

size_t mie_terms(double x)
{
    return (size_t)(x + 4.05 * cbrt(x) + 2.5) + 1;
}

size_t mie_scratch(double x, MieNumber m)
{
    double most = x * sqrt(squared(m)), n = (double)mie_terms(x);
    most +=
        8 *
        cbrt(
            most); /* beyond where it ceases to swing, what the recurrence begins with is forgotten in steps of the cube root */
    return (size_t)(most > n ? most : n) + 17;
}

/* Of psi_n, whose logarithmic derivative at m x is stable from above, down to n = 1: [BH83] eq. 4.89. */
static void derivatives(double x, MieNumber m, size_t n, MieNumber *d)
{
    const MieNumber z = {m.re * x, m.im * x};
    d[n - 1] = (MieNumber){0, 0};
    for (size_t i = n - 1; i > 0; i--) {
        MieNumber over = divide((MieNumber){(double)i + 1, 0}, z);
        MieNumber rest = divide((MieNumber){1, 0}, (MieNumber){d[i].re + over.re, d[i].im + over.im});
        d[i - 1] = (MieNumber){over.re - rest.re, over.im - rest.im};
    }
}

/* f = D_n / m or m D_n, plus n / x; psi is real, and xi_n = psi_n - i chi_n. */
static MieNumber coefficient(MieNumber f, const double psi[2], const double chi[2])
{
    MieNumber top = {f.re * psi[1] - psi[0], f.im * psi[1]};
    MieNumber xi = {psi[1], -chi[1]}, below = multiply(f, xi);
    below.re -= psi[0];
    below.im += chi[0];
    return divide(top, below);
}

void mie_coefficients(double x, MieNumber m, MieNumber *scratch, MieNumber *a, MieNumber *b)
{
    /* [0] of n - 1, [1] of n: upward, which for psi is stable for as many terms as there are */
    double psi[2] = {cos(x), sin(x)}, chi[2] = {-sin(x), cos(x)};
    size_t n_terms = mie_terms(x);
    derivatives(x, m, mie_scratch(x, m), scratch);
    for (size_t n = 1; n <= n_terms; n++) {
        double order = (double)n, step = (2 * order - 1) / x;
        double next_psi = step * psi[1] - psi[0], next_chi = step * chi[1] - chi[0];
        psi[0] = psi[1];
        psi[1] = next_psi;
        chi[0] = chi[1];
        chi[1] = next_chi;
        MieNumber of_a = divide(scratch[n - 1], m), of_b = multiply(scratch[n - 1], m);
        of_a.re += order / x;
        of_b.re += order / x;
        a[n - 1] = coefficient(of_a, psi, chi);
        b[n - 1] = coefficient(of_b, psi, chi);
    }
}

static double product(MieNumber a, MieNumber b) /* the real part of a b* */
{
    return a.re * b.re + a.im * b.im;
}

MieEfficiencies mie_efficiencies(double x, const MieNumber *a, const MieNumber *b)
{
    double extinction = 0, scattering = 0, forward = 0;
    size_t n_terms = mie_terms(x);
    for (size_t i = 0; i < n_terms; i++) {
        double n = (double)i + 1;
        extinction += (2 * n + 1) * (a[i].re + b[i].re);
        scattering += (2 * n + 1) * (squared(a[i]) + squared(b[i]));
        forward += (2 * n + 1) / (n * (n + 1)) * product(a[i], b[i]);
        if (i + 1 < n_terms) forward += n * (n + 2) / (n + 1) * (product(a[i], a[i + 1]) + product(b[i], b[i + 1]));
    }
    return (MieEfficiencies){2 / (x * x) * extinction, 2 / (x * x) * scattering, 2 * forward / scattering};
}

/* pi_n and tau_n of one angle, upward: [BH83] eq. 4.47. pi[0] of n - 1, pi[1] of n. */
static inline double next_tau(double cosine, double n, double pi[2])
{
    double tau = n * cosine * pi[1] - (n + 1) * pi[0], now = pi[1];
    pi[1] = ((2 * n + 1) * cosine * pi[1] - (n + 1) * pi[0]) / n;
    pi[0] = now;
    return tau;
}

void mie_amplitudes(double x, const MieNumber *a, const MieNumber *b, double cosine, MieNumber *s1, MieNumber *s2)
{
    double pi[2] = {0, 1};
    size_t n_terms = mie_terms(x);
    *s1 = *s2 = (MieNumber){0, 0};
    for (size_t i = 0; i < n_terms; i++) {
        double n = (double)i + 1, scale = (2 * n + 1) / (n * (n + 1)), now = scale * pi[1];
        double tau = scale * next_tau(cosine, n, pi);
        s1->re += a[i].re * now + b[i].re * tau;
        s1->im += a[i].im * now + b[i].im * tau;
        s2->re += a[i].re * tau + b[i].re * now;
        s2->im += a[i].im * tau + b[i].im * now;
    }
}

void mie_angles(const double cosines[MIE_ANGLES], size_t n, MieAngles *angles)
{
    for (int k = 0; k < MIE_ANGLES; k++) {
        double pi[2] = {0, 1};
        for (size_t i = 0; i < n; i++) {
            double now = pi[1], tau = next_tau(cosines[k], (double)i + 1, pi);
            lanes_set(&angles[i].plus[k / LANES], k % LANES, (float)(now + tau));
            lanes_set(&angles[i].minus[k / LANES], k % LANES, (float)(now - tau));
        }
    }
}

void mie_make_terms(const MieNumber *a, const MieNumber *b, size_t n, MieTerm *terms)
{
    for (size_t i = 0; i < n; i++) {
        double order = (double)i + 1, scale = (2 * order + 1) / (order * (order + 1));
        terms[i] = (MieTerm){(float)(scale * (a[i].re + b[i].re)), (float)(scale * (a[i].im + b[i].im)),
                             (float)(scale * (a[i].re - b[i].re)), (float)(scale * (a[i].im - b[i].im))};
    }
}

/* Of four angles: the sums of both kinds of terms, real and imaginary. */
typedef struct Sums {
    Lanes plus_re, plus_im, minus_re, minus_im;
} Sums;

static inline Sums no_sums(void)
{
    Lanes zero = lanes_all(0);
    return (Sums){zero, zero, zero, zero};
}

/* S1 + S2 takes the sums alone, S1 - S2 the differences: [Wiscombe80] section 3. */
static inline void add_term(Sums *sums, const MieTerm *term, Lanes plus, Lanes minus)
{
    sums->plus_re = lanes_add(sums->plus_re, lanes_scale(plus, term->plus_re));
    sums->plus_im = lanes_add(sums->plus_im, lanes_scale(plus, term->plus_im));
    sums->minus_re = lanes_add(sums->minus_re, lanes_scale(minus, term->minus_re));
    sums->minus_im = lanes_add(sums->minus_im, lanes_scale(minus, term->minus_im));
}

static Lanes intensity_of(const Sums *sums)
{
    Lanes plus = lanes_add(lanes_mul(sums->plus_re, sums->plus_re), lanes_mul(sums->plus_im, sums->plus_im));
    Lanes minus = lanes_add(lanes_mul(sums->minus_re, sums->minus_re), lanes_mul(sums->minus_im, sums->minus_im));
    return lanes_scale(lanes_add(plus, minus), 0.25f);
}

void mie_intensities(const MieTerm *terms, size_t n, const MieAngles *angles, Lanes intensity[2])
{
    Sums first = no_sums(), second = no_sums();
    for (size_t i = 0; i < n; i++) {
        add_term(&first, &terms[i], angles[i].plus[0], angles[i].minus[0]);
        add_term(&second, &terms[i], angles[i].plus[1], angles[i].minus[1]);
    }
    intensity[0] = intensity_of(&first);
    intensity[1] = intensity_of(&second);
}

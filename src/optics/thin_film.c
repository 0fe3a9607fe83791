/* thin_film.c - thin films, in which light interferes.
 *
 * Of each polarization the film reflects r = (a + b e^(i phi)) / (1 + a b e^(i phi)), a and b being the amplitudes of its two
 * sides, and phi the phase of a way to and fro within it. Where all cosines are real, so are a and b.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/thin_film.h"

#include <math.h>

typedef struct Complex {
    float re, im;
} Complex;

static Complex times(Complex a, Complex b)
{
    return (Complex){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static Complex scaled(Complex a, float by)
{
    return (Complex){a.re * by, a.im * by};
}

static Complex plus(Complex a, Complex b)
{
    return (Complex){a.re + b.re, a.im + b.im};
}

static Complex minus(Complex a, Complex b)
{
    return (Complex){a.re - b.re, a.im - b.im};
}

static float square_of(Complex a)
{
    return a.re * a.re + a.im * a.im;
}

static Complex over(Complex a, Complex b)
{
    const float square = square_of(b) + 1e-30f;
    return (Complex){(a.re * b.re + a.im * b.im) / square, (a.im * b.re - a.re * b.im) / square};
}

/* The root whose wave decays on its way. */
static Complex root(Complex a)
{
    float size = sqrtf(sqrtf(square_of(a)));
    float half = 0.5f * (sqrtf(square_of(a)) + fabsf(a.re)), larger = sqrtf(half);
    if (!(size > 0)) return (Complex){0, 0};
    float smaller = 0.5f * a.im / larger;
    if (a.re >= 0) return smaller < 0 ? (Complex){-larger, -smaller} : (Complex){larger, smaller};
    return (Complex){fabsf(smaller), larger};
}

/* The squares of both polarizations' amplitudes, of sides with these of each: |(a + b e) / (1 + a b e)|^2 */
static float airy(Complex a, Complex b, Complex turn)
{
    const Complex behind = times(b, turn), one = {1, 0};
    return square_of(plus(a, behind)) / (square_of(plus(one, times(a, behind))) + 1e-30f);
}

/* The same of real amplitudes. */
static float airy_real(float a, float b, float cosine)
{
    const float both = a * b, beside = 2 * both * cosine;
    return float_max(a * a + b * b + beside, 0) / (1 + both * both + beside + 1e-12f);
}

/* Where nothing absorbs, and nothing is reflected totally: in terms of q = n cos of each medium. */
static float reflectance_of_clear(const float q[3], const float n[3], float delay)
{
    const float cosine = cosf(delay * q[1]);
    float across[2], along[2];
    for (int i = 0; i < 2; i++) {
        const float p = q[i] * n[i + 1] * n[i + 1], p_next = q[i + 1] * n[i] * n[i];
        across[i] = (q[i] - q[i + 1]) / (q[i] + q[i + 1] + 1e-30f);
        along[i] = (p - p_next) / (p + p_next + 1e-30f);
    }
    return 0.5f * (airy_real(across[0], across[1], cosine) + airy_real(along[0], along[1], cosine));
}

/* In terms of q = n cos of each medium: a = (q - q') / (q + q') across the plane of incidence; along it of q / n^2. */
static float reflectance_of_one(float cosine, float eta_i, float ior, Complex behind, float delay)
{
    const float along_square =
        eta_i * eta_i * (1 - cosine) * (1 + cosine); /* n sin, the same in all of them, squared */
    const Complex ior_square = {ior * ior, 0}, behind_square = times(behind, behind), sine = {along_square, 0};
    if (behind.im == 0 && along_square >= behind_square.re) return 1;
    const float within = ior_square.re - along_square;
    if (behind.im == 0 && within > 0) {
        const float q[3] = {eta_i * cosine, sqrtf(within), sqrtf(behind_square.re - along_square)},
                    n[3] = {eta_i, ior, behind.re};
        return float_min(reflectance_of_clear(q, n, delay), 1);
    }
    const Complex q_i = {eta_i * cosine, 0}, q = root(minus(ior_square, sine)), q_t = root(minus(behind_square, sine));
    const float decay = expf(-delay * q.im);
    const Complex turn = {decay * cosf(delay * q.re), decay * sinf(delay * q.re)};
    const Complex across_i = over(minus(q_i, q), plus(q_i, q)), across_t = over(minus(q, q_t), plus(q, q_t));
    const Complex p_i = scaled(q_i, 1 / (eta_i * eta_i)), p = scaled(q, 1 / ior_square.re),
                  p_t = over(q_t, behind_square);
    const Complex along_i = over(minus(p_i, p), plus(p_i, p)), along_t = over(minus(p, p_t), plus(p, p_t));
    return float_min(0.5f * (airy(across_i, across_t, turn) + airy(along_i, along_t, turn)), 1);
}

Lanes thin_film_reflectance(const ThinFilm *film, float cosine, Lanes eta_i, Lanes eta_t, Lanes k)
{
    Lanes reflected = lanes_all(0);
    cosine = float_min(float_max(cosine, 0), 1);
    for (int i = 0; i < LANES; i++) {
        const Complex behind = {lanes_get(eta_t, i), lanes_get(k, i)};
        lanes_set(&reflected, i,
                  reflectance_of_one(cosine, lanes_get(eta_i, i), lanes_get(film->ior, i), behind,
                                     lanes_get(film->delay, i)));
    }
    return reflected;
}

Lanes thin_film_mean_reflectance(const ThinFilm *film, Lanes eta_i, Lanes eta_t, Lanes k)
{
    enum { STEPS = 8 }; /* of the squared sine, over which diffuse light is even */
    Lanes sum = lanes_all(0);
    for (int i = 0; i < STEPS; i++)
        sum = lanes_add(sum, thin_film_reflectance(film, sqrtf(((float)i + 0.5f) / STEPS), eta_i, eta_t, k));
    return lanes_scale(sum, 1.0f / STEPS);
}

/* thin_film_test.c - what thin films reflect, against Airy's formula in complex numbers, closed forms, and each other.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "complex_of.h"
#include "dice.h"
#include "near.h"
#include "optics/thin_film.h"
#include "optics/fresnel.h"

static const double pi = 3.14159265358979323846;

/* Of one polarization and wavelength, as the field's two sums of waves have it: with cosines of the angles in each medium. */
static double reference(double cosine, double n0, double n1, double complex n2, double delay)
{
    double sine = n0 * sqrt(1 - cosine * cosine), sum = 0;
    double complex c1 = csqrt(1 - sine * sine / (n1 * n1)), c2 = csqrt(1 - sine * sine / (n2 * n2));
    if (cimag(n1 * c1) < 0) c1 = -c1;
    if (cimag(n2 * c2) < 0) c2 = -c2;
    double complex turn = cexp(complex_of(0, 1) * delay * n1 * c1);
    for (int p = 0; p < 2; p++) {
        double complex a =
            p ? (n1 * cosine - n0 * c1) / (n1 * cosine + n0 * c1) : (n0 * cosine - n1 * c1) / (n0 * cosine + n1 * c1);
        double complex b = p ? (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2) : (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2);
        double complex r = (a + b * turn) / (1 + a * b * turn);
        sum += .5 * creal(r * conj(r));
    }
    return sum;
}

static double measured(double cosine, double n0, double n1, double n2, double k, double delay)
{
    const ThinFilm film = {lanes_all((float)n1), lanes_all((float)delay)};
    return (double)lanes_get(
        thin_film_reflectance(&film, (float)cosine, lanes_all((float)n0), lanes_all((float)n2), lanes_all((float)k)),
        0);
}

static void agrees_with_airy(void **state)
{
    (void)state;
    Dice dice = {7};
    double worst[3] = {0, 0, 0};
    for (int i = 0; i < 300000; i++) {
        double n0 = 1 + dice_unit(&dice), n1 = 1 + 1.5 * dice_unit(&dice), n2 = 1 + dice_unit(&dice);
        double cosine = .02 + .98 * dice_unit(&dice), delay = 20 * dice_unit(&dice),
               k = i % 3 == 2 ? 4 * dice_unit(&dice) : 0;
        double sine = n0 * sqrt(1 - cosine * cosine);
        if (k == 0 && fabs(sine - n2) < 1e-3) continue; /* at the critical angle all changes at once */
        double expected = reference(cosine, n0, n1, complex_of(n2, k), delay);
        int kind = k > 0 ? 2 : sine > n1; /* clear, or through what lets nothing through but its rim, or a metal */
        worst[kind] = fmax(worst[kind], fabs(measured(cosine, n0, n1, n2, k, delay) - expected));
    }
    print_message("largest error: clear %.2g, beyond the critical angle of the film %.2g, on a metal %.2g\n", worst[0],
                  worst[1], worst[2]);
    assert_true(worst[0] < 2e-4 && worst[1] < 2e-4 && worst[2] < 2e-4);
}

/* A quarter of a wave of the right index reflects nothing; one of MgF2 on crown 1.26 %; half a wave is not there. */
static void coatings(void **state)
{
    (void)state;
    const double n2 = 1.52;
    for (double n1 = 1.1; n1 < 2.3; n1 += .1) {
        double quarter = pi / n1, r = (n2 - n1 * n1) / (n2 + n1 * n1), bare = (n2 - 1) / (n2 + 1);
        assert_near(measured(1, 1, n1, n2, 0, quarter), r * r, 1e-6);
        assert_near(measured(1, 1, n1, n2, 0, 2 * quarter), bare * bare, 1e-6);
        assert_near(measured(1, n2, n1, 1, 0, quarter), r * r, 1e-6);
    }
    assert_near(measured(1, 1, 1.38, n2, 0, pi / 1.38), .0126, 5e-5);
    assert_near(measured(1, 1, sqrt(n2), n2, 0, pi / sqrt(n2)), 0, 1e-6);
}

/* What passes one way passes the other way, along the same ray: and beyond the critical angle of both media nothing. */
static void is_reciprocal(void **state)
{
    (void)state;
    Dice dice = {3};
    for (int i = 0; i < 20000; i++) {
        double n0 = 1 + dice_unit(&dice), n1 = 1 + 1.5 * dice_unit(&dice), n2 = n0 + dice_unit(&dice),
               delay = 15 * dice_unit(&dice);
        double cosine = .05 + .95 * dice_unit(&dice), sine = n0 * sqrt(1 - cosine * cosine),
               behind = sqrt(1 - sine * sine / (n2 * n2));
        assert_near(measured(cosine, n0, n1, n2, 0, delay), measured(behind, n2, n1, n0, 0, delay), 3e-4);
        double beyond = sqrt(1 - pow(n0 / n2, 2)) * .999;
        assert_near(measured(beyond, n2, n1, n0, 0, delay), 1, 0);
    }
}

/* Without thickness there is the bare surface. */
static void nothing_is_nothing(void **state)
{
    (void)state;
    for (double cosine = .05; cosine <= 1; cosine += .05) {
        double bare = (double)fresnel_dielectric((float)cosine, 1, 1.5f);
        assert_near(measured(cosine, 1, 2.2, 1.5, 0, 0), bare, 1e-5);
        assert_near(measured(cosine, 1, 1, 1.5, 0, 5), bare, 1e-5);
        bare = (double)lanes_get(fresnel_conductor((float)cosine, lanes_all(2.7f), lanes_all(3.4f)), 0);
        assert_near(measured(cosine, 1, 2.2, 2.7, 3.4, 0), bare, 1e-5);
    }
    /* two blocks of glass with air of a tenth of a wave between them: light that is reflected totally at each gets across */
    double near = measured(.6, 1.5, 1, 1.5, 0, 2 * 2 * pi * .1), far = measured(.6, 1.5, 1, 1.5, 0, 2 * 2 * pi * 2);
    assert_true(near < .6 && far > .9999);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(agrees_with_airy), cmocka_unit_test(coatings),
                                       cmocka_unit_test(is_reciprocal), cmocka_unit_test(nothing_is_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

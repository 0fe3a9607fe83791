/* guide_test.c - the lobes that lead paths to light behind glass: their densities are those of what is sampled, and
 * integrate to one; ways are weighted by the flux that comes by them; photons lose no flux on the way.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"

#include "base/hash.h"
#include "optics/sampling.h"
#include "scene_fixture.h"
#include "trace/guide_fit.h"
#include "trace/guide_parts.h"
#include "trace/sampler.h"

static const double pi = 3.14159265358979323846;

static uint64_t dice_state = 1;
static float dice(void)
{
    return (float)hash_to_unit(hash_u64(dice_state++));
}
static const GuidePlace at_origin; /* of a cell, of no colour */
static float dice_between(float low, float high)
{
    return low + (high - low) * dice();
}

/* A photon that knows its neighbours, with anything from a needle to half of all directions. */
static Photon random_photon(void)
{
    Photon photon = {.position = {dice(), dice(), dice()},
                     .from = sampling_sphere(dice(), dice()),
                     .flux = 1 + dice(),
                     .mean = {dice_between(-.05f, .05f), dice_between(-.05f, .05f)}};
    float a = powf(10, dice_between(-3.5f, 0)), b = a * dice_between(.15f, 1), turn = dice_between(0, 3.1f);
    float c = cosf(turn), s = sinf(turn);
    photon.spread[0] = a * a * c * c + b * b * s * s;
    photon.spread[1] = (a * a - b * b) * c * s;
    photon.spread[2] = a * a * s * s + b * b * c * c;
    photon.color = dice_between(.4f, 1.7f);
    for (int i = 0; i < 2; i++) {
        photon.slope[i] = vec3f(dice_between(-.3f, .3f), dice_between(-.3f, .3f), dice_between(-.3f, .3f));
        photon.hue[i] = dice_between(-.2f, .2f);
    }
    photon.hue_bend = dice_between(0, .03f);
    return photon;
}

/* The plane that touches the sphere of directions at an axis, in polar coordinates: equal areas are equal solid angles. */
static Vec3f at_plane(Vec3f axis, double r, double angle)
{
    Vec3f x, y;
    sampling_basis(axis, &x, &y);
    double sine = r * sqrt(1 - r * r / 4);
    Vec3 p = vec3_scale(vec3_from_f(axis), 1 - r * r / 2);
    p = vec3_along(vec3_along(p, sine * cos(angle), vec3_from_f(x)), sine * sin(angle), vec3_from_f(y));
    return vec3f_from(vec3_normalize(p));
}

/* Radius in that plane. */
static double chord(Vec3f a, Vec3f b)
{
    return vec3_length(vec3_sub(vec3_from_f(a), vec3_from_f(b)));
}

/* One lobe by itself. */
static GuideFour alone(const GuideLobe *lobe)
{
    GuideLobe one = *lobe;
    GuideFour four;
    one.n_sheet = 1;
    one.weight = 1;
    guide_lay_in_fours(&one, 1, &four);
    return four;
}
static Vec3f lobe_sample(const GuideLobe *lobe, GuidePlace place, const float v[2])
{
    GuideFour four = alone(lobe);
    return guide_sample_lobes(&four, 1, place, 0, v);
}
static float lobe_pdf(const GuideLobe *lobe, GuidePlace place, Vec3f direction)
{
    GuideFour four = alone(lobe);
    return guide_lobes_pdf(&four, 1, place, direction);
}

/* The mean direction of many samples, and how far from it the farthest is, in that plane. */
static double reach_of(const GuideLobe *lobe, GuidePlace place, Vec3f *mean)
{
    enum { SAMPLES = 400 };
    Vec3 sum = vec3(0, 0, 0);
    double farthest = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < SAMPLES; i++) {
            const float v[2] = {((float)i + .5f) / SAMPLES, hash_to_unit_f(reverse_bits((uint32_t)i))};
            Vec3f direction = lobe_sample(lobe, place, v);
            if (pass == 0)
                sum = vec3_add(sum, vec3_from_f(direction));
            else
                farthest = fmax(farthest, chord(*mean, direction));
            if (i + 1 == SAMPLES && pass == 0) *mean = vec3f_from(vec3_normalize(sum));
        }
    return fmin(1.15 * farthest + 1e-6, 2);
}

/* Of photons, the first n_known of which are known. */
static uint32_t fit(const Photon *photons, uint32_t n_known, uint32_t n, Vec3f origin, GuideLobe *lobes)
{
    GuidePhotons cell = {.photons = photons, .n = n, .n_known = n_known, .origin = origin};
    for (uint32_t i = 0; i < n_known; i++) cell.known[i].photon = &photons[i];
    return guide_fit(&cell, lobes);
}

/* A guide of photons that were all followed; they are put into another order. */
static Guide *build(Photon *photons, uint32_t n)
{
    Pool *pool;
    Error error;
    Guide *guide;
    assert_int_equal(pool_new(1, &pool, &error), STATUS_OK);
    assert_int_equal(guide_build(photons, n, n, pool, &guide, &error), STATUS_OK);
    pool_free(pool);
    return guide;
}

static void densities(void **state)
{
    (void)state;
    enum { RINGS = 12, SECTORS = 8, FINE = 96, SAMPLES = 40000, LOBES = 60 }; /* fine: discs are small in wide tails */
    double worst_integral = 0, chi_square = 0;
    int n_bins = 0;
    for (int trial = 0; trial < LOBES; trial++) {
        Photon photon = random_photon();
        GuideLobe lobes[GUIDE_CELL_LOBES];
        assert_int_equal(fit(&photon, 1, 1, vec3f(0, 0, 0), lobes), 2); /* its own, and one around all */
        const GuideLobe *lobe = &lobes[trial % 2];
        Vec3f mean = {0, 0, 0};
        GuidePlace place = {vec3f(dice(), dice(), dice()), dice_between(.4f, 1.7f)};
        double reach = reach_of(lobe, place, &mean), expected[RINGS][SECTORS] = {{0}}, sum = 0;
        int counted[RINGS][SECTORS] = {{0}};
        for (int i = 0; i < RINGS * FINE; i++)
            for (int k = 0; k < SECTORS * FINE; k++) {
                double part = 2 * pi / (SECTORS * FINE), step = reach / (RINGS * FINE), r = (i + .5) * step;
                double p = (double)lobe_pdf(lobe, place, at_plane(mean, r, (k + .5) * part)) * r * step * part;
                expected[i / FINE][k / FINE] += p;
                sum += p;
            }
        worst_integral = fmax(worst_integral, fabs(sum - 1));
        for (int i = 0; i < SAMPLES; i++) {
            const float v[2] = {dice(), dice()};
            Vec3f direction = lobe_sample(lobe, place, v), x, y;
            sampling_basis(mean, &x, &y);
            double r = chord(mean, direction);
            double angle = atan2((double)vec3f_dot(y, direction), (double)vec3f_dot(x, direction));
            int ring = (int)(r / reach * RINGS),
                sector = (int)((angle < 0 ? angle + 2 * pi : angle) / (2 * pi) * SECTORS);
            assert_true(lobe_pdf(lobe, place, direction) > 0);
            if (ring < RINGS) counted[ring][sector < SECTORS ? sector : SECTORS - 1]++;
        }
        for (int i = 0; i < RINGS; i++)
            for (int k = 0; k < SECTORS; k++) {
                double e = expected[i][k] * SAMPLES, d = counted[i][k] - e;
                if (e < 25) continue;
                chi_square += d * d / e;
                n_bins++;
            }
    }
    printf("    %d lobes: integrals within %.2g of 1; chi-square %.1f of %d bins\n", LOBES, worst_integral, chi_square,
           n_bins);
    assert_true(worst_integral < 0.01);
    assert_true(fabs(chi_square - n_bins) < 5 * sqrt(2.0 * n_bins));
}

/* Photons of two lights, seen from all places by a linear law each, of which the first dozen are looked around at; and one
 * that came another way. */
static void sheets(void **state)
{
    (void)state;
    enum { N = 60, KNOWN = 12, SAMPLES = 40000 };
    Photon photons[N];
    float flux[2] = {0, 0};
    for (int i = 0; i < N; i++) {
        int light = i % 3 == 0;
        photons[i] =
            (Photon){.position = {dice(), 0, dice()}, .flux = 1, .way = (uint32_t)light, .spread = {1e-4f, 0, 1e-4f}};
        photons[i].slope[0] = vec3f(light ? .02f : -.04f, 0, .01f); /* so that all lobes know the place about as well */
        photons[i].slope[1] = vec3f(0, 0, light ? .04f : .02f);
        Vec3f axis = light ? vec3f(0, 1, 0) : vec3f(.6f, .8f, 0), x, y;
        sampling_basis(axis, &x, &y);
        Vec3f p = photons[i].position;
        photons[i].from = vec3f_normalize(
            vec3f_along(vec3f_along(axis, vec3f_dot(photons[i].slope[0], p), x), vec3f_dot(photons[i].slope[1], p), y));
        if (i < N - 1) flux[light]++;
    }
    photons[N - 1].way = 7;
    GuideLobe lobes[GUIDE_CELL_LOBES];
    GuideFour fours[GUIDE_CELL_FOURS];
    uint32_t n = fit(photons, KNOWN, N, vec3f(.5f, 0, .5f), lobes);
    guide_lay_in_fours(lobes, n, fours);
    assert_int_equal(n, KNOWN + 1);
    assert_near((double)lobes[n - 1].cumulative, 1, 1e-5);
    assert_int_equal(lobes[0].n_sheet + lobes[lobes[0].n_sheet].n_sheet + 1, n);
    int of_first = lobes[0].axis.x < .3f; /* which light the first sheet is of */
    assert_near((double)(lobes[0].weight / lobes[n - 2].weight), (double)(flux[of_first] / flux[1 - of_first]), 1e-4);
    assert_true(lobes[n - 1].weight > 1.f / N && lobes[n - 1].weight < .3f);
    for (uint32_t i = 0; i + 1 < n; i++) assert_true(lobes[i].bend >= 0 && isfinite(lobes[i].bend));
    /* of the mixture's samples, each lobe's density over the mixture's is one on the mean */
    GuidePlace place = {vec3f(.2f, 0, -.3f), 1};
    double sums[KNOWN + 1] = {0}, squares[KNOWN + 1] = {0};
    for (int i = 0; i < SAMPLES; i++) {
        const float v[2] = {dice(), dice()};
        Vec3f direction = guide_sample_lobes(fours, n, place, dice(), v);
        float mixture = guide_lobes_pdf(fours, n, place, direction);
        assert_true(mixture > 0);
        for (uint32_t k = 0; k < n; k++) {
            double ratio = (double)(lobe_pdf(&lobes[k], place, direction) / mixture);
            sums[k] += ratio / SAMPLES, squares[k] += ratio * ratio / SAMPLES;
        }
    }
    for (uint32_t k = 0; k < n; k++)
        assert_true(fabs(sums[k] - 1) < 5 * sqrt((squares[k] - sums[k] * sums[k]) / SAMPLES) + 1e-3);
}

/* A large lamp through waves: light from all of two squares of directions, by a way each, of which every photon that was looked
 * around at claims a small part. What comes from elsewhere in wide ones is foretold all the same; and where the squares are as
 * small as that, by such photons alone. */
static void waves(void **state)
{
    (void)state;
    enum { N = 160, KNOWN = 24 };
    const float halves[2] = {0.3f, 0.01f}, spread = 0.01f * 0.01f / 3;
    Photon photons[N];
    for (int right = 0; right < 2; right++) {
        const float half = halves[right];
        for (int i = 0; i < N; i++) {
            float x = half * dice_between(-1, 1), y = half * dice_between(-1, 1);
            Vec3f axis = vec3f_normalize(i % 2 ? vec3f(-.5f, .8f, 0) : vec3f(.5f, .8f, .2f)), u, v;
            sampling_basis(axis, &u, &v);
            photons[i] = (Photon){.position = {dice(), 0, dice()},
                                  .from = vec3f_normalize(vec3f_along(vec3f_along(axis, x, u), y, v)),
                                  .flux = 1,
                                  .way = 2 * ((uint32_t)i % 2),
                                  .spread = {spread, 0, spread},
                                  .number = (uint32_t)i,
                                  .lobe = i < KNOWN};
        }
        GuideLobe lobes[GUIDE_CELL_LOBES];
        GuideFour fours[GUIDE_CELL_FOURS];
        const Vec3f origin = vec3f(.5f, 0, .5f);
        uint32_t n = fit(photons, KNOWN, N, origin, lobes);
        guide_lay_in_fours(lobes, n, fours);
        assert_near((double)lobes[n - 1].cumulative, 1, 1e-5);
        double sum = 0, even = 1 / (2 * pow(2 * (double)half, 2)); /* the density of both */
        for (int i = KNOWN; i < N; i++) {
            GuidePlace place = {vec3f_along(photons[i].position, -1, origin), 0};
            sum += log((double)guide_lobes_pdf(fours, n, place, photons[i].from)) / (N - KNOWN);
        }
        printf("    two %s squares: %u lobes, %.2f of the choices narrow; %.2f of the even density\n",
               right ? "small" : "wide", n, (double)lobes[KNOWN - 1].cumulative, exp(sum) / even);
        assert_int_equal(n, KNOWN + (right ? 1 : 3));
        assert_true(exp(sum) > (right ? 0.3 : 0.5) * even);
    }
}

/* Of a cell whose photons are known, all of them, with others in eight cells near by. */
static uint32_t fit_beside(const Photon *photons, uint32_t n, const Photon *others, uint32_t n_others, GuideLobe *lobes)
{
    GuidePhotons cell = {.photons = photons,
                         .n = n,
                         .n_known = n,
                         .origin = vec3f(.5f, 0, .5f),
                         .near = {{others, n_others}, {NULL, 0}},
                         .near_part = 0.125f};
    for (uint32_t i = 0; i < n; i++) cell.known[i].photon = &photons[i];
    return guide_fit(&cell, lobes);
}

/* Where lobes are made of all of a cell's photons, these are right if each is what the others foretell: what lands beside the cell, and
 * comes from anywhere in a wide square, says little against them. */
static void judged_within(void **state)
{
    (void)state;
    enum { N = 24, OTHERS = 40 };
    const float spread = 4e-6f;
    for (int alike = 0; alike < 2; alike++) {
        Photon photons[N], others[OTHERS];
        for (int i = 0; i < N + OTHERS; i++) {
            bool own = i < N;
            float wide = own && alike ? 0.002f : 0.08f;
            Vec3f from = vec3f(.5f + dice_between(-wide, wide), .8f, dice_between(-wide, wide));
            *(own ? &photons[i] : &others[i - N]) = (Photon){.position = {dice() + (own ? 0 : 1.5f), 0, dice()},
                                                             .from = vec3f_normalize(from),
                                                             .flux = 1,
                                                             .spread = {spread, 0, spread},
                                                             .number = (uint32_t)i,
                                                             .lobe = own};
        }
        GuideLobe lobes[GUIDE_CELL_LOBES];
        uint32_t n = fit_beside(photons, N, others, OTHERS, lobes);
        printf("    photons that %s: %u lobes, %.2f of the choices narrow\n", alike ? "foretell each other" : "do not",
               n, (double)lobes[N - 1].cumulative);
        assert_true(alike ? lobes[N - 1].cumulative > 0.7f : lobes[N - 1].cumulative < 0.4f);
    }
}

/* Strong light that came by one way to where the tree is near by, and the cell is far away, takes none of its directions. */
static void far_away(void **state)
{
    (void)state;
    enum { N = 24, OTHERS = 40 };
    const float spread = 1e-4f;
    Photon photons[N], others[OTHERS];
    for (int i = 0; i < N; i++)
        photons[i] = (Photon){.position = {dice(), 0, dice()},
                              .from = vec3f_normalize(vec3f(.5f + .01f * dice(), .8f, .01f * dice())),
                              .flux = 1,
                              .spread = {spread, 0, spread},
                              .number = (uint32_t)i,
                              .lobe = 1};
    for (int far = 0; far < 2; far++) {
        for (int i = 0; i < OTHERS; i++)
            others[i] = (Photon){.position = {dice() + (far ? 20 : .2f), 0, dice()},
                                 .from = vec3f_normalize(vec3f(-.6f + .1f * dice(), .6f, .1f * dice())),
                                 .flux = 100,
                                 .way = 2,
                                 .number = N + (uint32_t)i};
        GuideLobe lobes[GUIDE_CELL_LOBES];
        uint32_t n = fit_beside(photons, N, others, OTHERS, lobes);
        printf("    others %s: %u lobes, %.2f of the choices narrow\n", far ? "far away" : "beside", n,
               (double)lobes[N - 1].cumulative);
        assert_true(far ? lobes[N - 1].cumulative > 0.8f : lobes[N - 1].cumulative < 0.4f);
    }
}

/* Where light is folded the lobe that is nearest may be of another sheet, and sure of itself: one that is a little less sure, and knows
 * better, has to be asked as well. */
static void folds(void **state)
{
    (void)state;
    Photon photons[2] = {{.from = {0, 1, 0}, .flux = 1, .spread = {1e-6f, 0, 1e-6f}},
                         {.from = {.08f, .9968f, 0}, .flux = 1, .spread = {25e-6f, 0, 25e-6f}}};
    GuideLobe lobes[GUIDE_CELL_LOBES];
    GuideFour fours[GUIDE_CELL_FOURS];
    uint32_t n = fit(photons, 2, 2, vec3f(0, 0, 0), lobes);
    lobes[0].bend = lobes[1].bend = 0;
    guide_lay_in_fours(lobes, n, fours);
    float sure = guide_lobes_pdf(fours, n, at_origin, vec3f(0, 1, 0)),
          less = guide_lobes_pdf(fours, n, at_origin, vec3f(.08f, .9968f, 0));
    printf("    densities of a sure lobe and of one a fifth as sure: %.3g and %.3g, of both alone %.3g and %.3g\n",
           (double)sure, (double)less, (double)lobe_pdf(&lobes[0], at_origin, vec3f(0, 1, 0)),
           (double)lobe_pdf(&lobes[1], at_origin, vec3f(.08f, .9968f, 0)));
    assert_true(less > 5e-3f * lobe_pdf(&lobes[1], at_origin, vec3f(.08f, .9968f, 0)));
    assert_true(sure > .7f * lobe_pdf(&lobes[0], at_origin, vec3f(0, 1, 0)));
}

/* How wrong a lobe is at a place is told by noisy means, and may be far too much: what it foretells has to be asked for all the same,
 * and so has what is as far from that as it may be wrong. */
static void doubts(void **state)
{
    (void)state;
    Photon photon = {.from = {0, 1, 0}, .flux = 1, .spread = {9e-6f, 0, 9e-6f}};
    GuideLobe lobes[GUIDE_CELL_LOBES];
    (void)fit(&photon, 1, 1, vec3f(0, 0, 0), lobes);
    const GuidePlace away = {vec3f(1, 0, 0), 0};
    const Vec3f foretold = vec3f(0, 1, 0), other = vec3f(.2f, .9798f, 0);
    lobes[0].bend = 0;
    float sure = lobe_pdf(&lobes[0], away, foretold);
    lobes[0].bend = .2f; /* radians, at a distance of 1 */
    float doubtful = lobe_pdf(&lobes[0], away, foretold), beside = lobe_pdf(&lobes[0], away, other);
    printf("    density of what is foretold: %.3g, and %.3g where it may be .2 radians wrong; of what is .2 beside it "
           "%.3g\n",
           (double)sure, (double)doubtful, (double)beside);
    assert_true(doubtful > .01f * sure);
    assert_true(beside > .05f);
}

/* Sunlight on the floor of a still pool, where all photons that know their neighbours stand in a corner of the cell, close together:
 * that their means differ by a little does not make them doubtful at the other end, as the other photons come from where they say. */
static void corners(void **state)
{
    (void)state;
    enum { KNOWN = 24, N = 120, LOOKS = 200 };
    const float radius = .0047f, noise = 2e-4f;
    Photon photons[N];
    for (int i = 0; i < N; i++) {
        Vec3f from = at_plane(vec3f(0, 1, 0), (double)(radius * sqrtf(dice())), 2 * pi * (double)dice()), x, y;
        Vec3f sun = at_plane(vec3f(0, 1, 0), (double)(noise * dice()), 2 * pi * (double)dice());
        sampling_basis(from, &x, &y);
        photons[i] = (Photon){.from = from,
                              .flux = 1,
                              .number = (uint32_t)i,
                              .mean = {vec3f_dot(x, sun), vec3f_dot(y, sun)},
                              .spread = {radius * radius / 4, 0, radius * radius / 4},
                              .position = i < KNOWN ? vec3f(1 - .02f * dice(), 0, 1 - .02f * dice())
                                                    : vec3f(dice_between(-1, 1), 0, dice_between(-1, 1))};
    }
    GuideLobe lobes[GUIDE_CELL_LOBES];
    GuideFour fours[GUIDE_CELL_FOURS];
    uint32_t n = fit(photons, KNOWN, N, vec3f(0, 0, 0), lobes);
    guide_lay_in_fours(lobes, n, fours);
    const GuidePlace place = {vec3f(-1, 0, -1), 0};
    double sum = 0;
    for (int i = 0; i < LOOKS; i++) {
        Vec3f sun = at_plane(vec3f(0, 1, 0), (double)(radius * sqrtf(dice())), 2 * pi * (double)dice());
        sum += (double)guide_lobes_pdf(fours, n, place, sun) * pi * (double)(radius * radius) / LOOKS;
    }
    printf("    at the other end of the cell %.3g of all directions are chosen within the sun\n", sum);
    assert_true(sum > .3);
}

/* Light through a level side of a pool and through the waves on top of it goes one way, by what it meets: what is known far better of
 * the one takes nothing from the other. */
static void sides(void **state)
{
    (void)state;
    Photon photons[3] = {{.from = {0, 1, 0}, .flux = 1, .spread = {1e-8f, 0, 1e-8f}},
                         {.from = {0, .8f, .6f}, .flux = 3, .spread = {1e-4f, 0, 1e-4f}},
                         {.from = {0, 1, 0}, .flux = 1, .spread = {1e-8f, 0, 1e-8f}}};
    const Vec3f ways[] = {photons[0].from, photons[1].from};
    const float expected[] = {.4f, .6f};
    GuideLobe lobes[GUIDE_CELL_LOBES];
    GuideFour fours[GUIDE_CELL_FOURS];
    uint32_t n = fit(photons, 3, 3, at_origin.offset, lobes);
    assert_int_equal(lobes[0].n_sheet, 2);
    assert_int_equal(lobes[2].n_sheet, 1);
    for (uint32_t i = 0; i + 1 < n; i++) lobes[i].bend = 0;
    guide_lay_in_fours(lobes, n, fours);
    for (int i = 0; i < 2; i++) {
        float alone_there = lobe_pdf(&lobes[2 * i], at_origin, ways[i]);
        assert_true(guide_lobes_pdf(fours, n, at_origin, ways[i]) > .8f * expected[i] * alone_there);
    }
}

/* Nine tenths of a cell's light come by a sheet of which others know, a tenth by one that is known there, by the same way and from
 * 0.2 radians beside it: as in the shadow of a glass, whose wall is bent at its foot. What others know is borrowed, and not what they know
 * of a third sheet, or of another way. */
static void borrowed(void **state)
{
    (void)state;
    enum { N = 40, OTHERS = 60 };
    const Vec3f much = vec3f(0, 1, 0), little = vec3f(.2f, .9798f, 0), middle = vec3f(.5f, 0, .5f);
    Photon photons[N], others[OTHERS];
    for (int i = 0; i < N + OTHERS; i++) {
        Photon *photon = i < N ? &photons[i] : &others[i - N];
        *photon = (Photon){.position = {dice(), 0, dice()},
                           .from = i < N && i % 10 ? much : little,
                           .flux = 1,
                           .spread = {1e-5f, 0, 1e-5f},
                           .number = (uint32_t)i};
        if (i >= N) photon->position.x += 1;
    }
    others[0].from = others[10].from = others[20].from = much;
    others[30].from = vec3f(-.2f, .9798f, 0);
    others[40].from = much, others[40].way = 1;
    GuidePhotons cell = {
        .photons = photons, .n = N, .n_known = 1, .known = {{.photon = &photons[0]}}, .origin = middle};
    GuideLobe lobes[GUIDE_CELL_LOBES];
    GuideFour fours[GUIDE_CELL_FOURS];
    uint32_t n = guide_fit(&cell, lobes);
    guide_lay_in_fours(lobes, n, fours);
    float before = guide_lobes_pdf(fours, n, at_origin, much);
    guide_borrow(&cell, others, OTHERS);
    assert_int_equal(cell.n_known, 4);
    for (uint32_t i = 1; i < cell.n_known; i++) {
        const Photon *lent = cell.known[i].photon;
        assert_true(cell.known[i].lent && lent->from.x == 0 && lent->way == 0);
    }
    n = guide_fit(&cell, lobes);
    guide_lay_in_fours(lobes, n, fours);
    float of_much = guide_lobes_pdf(fours, n, at_origin, much);
    float of_little = guide_lobes_pdf(fours, n, at_origin, little);
    printf("    density of what is unknown %.3g, as it is borrowed %.3g; of what is known %.3g\n", (double)before,
           (double)of_much, (double)of_little);
    assert_true(of_much > 50 * before && of_much > 7 * of_little && of_little > .05f * of_much);
}

/* Light of many lamps: of one that no photon of the cell came from, while some of those near by did, so few that it may be chance,
 * is known as they know it. What many of them tell of, and none here, is not here; what is little, is not worth it. */
static void missed(void **state)
{
    (void)state;
    enum { N = 20, NEAR = 80, CELLS = 8 };
    static const struct {
        uint32_t n_near;
        float flux;
        bool borrowed;
    } cases[] = {{16, 1, true}, {80, 1, false}, {16, .2f, false}, {0, 1, false}};
    const Vec3f here = vec3f(0, 1, 0), there = vec3f(.6f, .8f, 0);
    for (size_t c = 0; c < COUNT_OF(cases); c++) {
        Photon photons[N], near[NEAR];
        for (uint32_t i = 0; i < N + cases[c].n_near; i++) {
            Photon *photon = i < N ? &photons[i] : &near[i - N];
            *photon = (Photon){.position = {i < N ? dice() : 1 + dice(), 0, dice()},
                               .from = i < N ? here : there,
                               .flux = i < N ? 1 : cases[c].flux,
                               .spread = {1e-5f, 0, 1e-5f},
                               .way = i < N,
                               .number = i};
        }
        GuidePhotons cell = {.photons = photons,
                             .n = N,
                             .n_known = 1,
                             .known = {{.photon = &photons[0]}},
                             .origin = vec3f(.5f, 0, .5f),
                             .near = {{near, cases[c].n_near / 2}, {near + cases[c].n_near / 2, cases[c].n_near / 2}},
                             .near_part = 1.0f / CELLS};
        guide_borrow(&cell, near, cases[c].n_near);
        assert_true((cell.n_known > 1) == cases[c].borrowed);
        GuideLobe lobes[GUIDE_CELL_LOBES];
        GuideFour fours[GUIDE_CELL_FOURS];
        uint32_t n = guide_fit(&cell, lobes);
        guide_lay_in_fours(lobes, n, fours);
        const GuidePlace place = {vec3f(0, 0, 0), 0};
        float of_there = guide_lobes_pdf(fours, n, place, there), of_here = guide_lobes_pdf(fours, n, place, here);
        assert_true(cases[c].borrowed ? of_there > .02f * of_here && of_there < .3f * of_here
                                      : of_there < .001f * of_here);
    }
}

/* Photons on floors and walls, that are level with each other there, are found again where they are: in cells whose lobes know of all
 * that came to them. */
static void levels(void **state)
{
    (void)state;
    enum { N = 3000 };
    Photon *photons = calloc(N, sizeof *photons);
    for (int i = 0; i < N; i++) {
        photons[i] = random_photon();
        photons[i].lobe = 1;
        photons[i].radiance = 1;
        photons[i].way = (uint32_t)i; /* none tells of another one's light */
        switch (i % 6) {
        case 0: photons[i].position.x = 0; break;
        case 1: photons[i].position.x = 1; break;
        case 2: photons[i].position.z = 0; break;
        default: photons[i].position.y = 0; break;
        }
    }
    Guide *guide = build(photons, N);
    printf("    %d photons on a floor and walls: %u cells with %u lobes\n", N, guide->n_cells, guide->n_lobes);
    assert_int_equal(guide->n_lobes, N + guide->n_cells);
    for (uint32_t i = 0; i < guide->n_cells; i++)
        assert_int_equal(guide->cells[i].n_lobes, guide->begins[i + 1] - guide->begins[i] + 1);
    guide_free(guide);
    free(photons);
}

/* Between the photons of two cells there are places that neither of them is near, and one of the two tells of them. */
static void gaps(void **state)
{
    (void)state;
    enum { N = 4 * 25, PLACES = 10000 };
    Photon photons[N];
    for (int i = 0; i < N; i++) { /* four groups, of 0.4 each way, and 0.1 apart */
        photons[i] = random_photon();
        photons[i].lobe = 1;
        photons[i].position = vec3f(.5f * (float)(i % 2) + .4f * dice(), 0, .5f * (float)(i / 2 % 2) + .4f * dice());
    }
    Guide *guide = build(photons, N);
    assert_int_equal(guide->n_cells, 4);
    for (int i = 0; i < PLACES; i++)
        assert_non_null(guide_find(guide, vec3(.9 * (double)dice(), 0, .9 * (double)dice()), false, 0).cell);
    assert_null(guide_find(guide, vec3(1, 0, 1), false, 0).cell);
    guide_free(guide);
}

/* Photons on frosted glass and those beside it, at the same places, share no cell. */
static void apart(void **state)
{
    (void)state;
    enum { N = 1000 };
    Photon *photons = calloc(N, sizeof *photons);
    for (int i = 0; i < N; i++) {
        photons[i] = random_photon();
        photons[i].lobe = i % 3 != 0;
        photons[i].at_boundary = i % 2 != 0;
    }
    Guide *guide = build(photons, N);
    for (uint32_t i = 0; i < guide->n_cells; i++)
        for (uint32_t k = guide->begins[i]; k < guide->begins[i + 1]; k++) {
            const Photon *photon = &photons[k];
            assert_int_equal(photon->at_boundary, photons[guide->begins[i]].at_boundary);
            GuideAt at = guide_find(guide, vec3_from_f(photon->position), photon->at_boundary, photon->color);
            assert_ptr_equal(at.cell, &guide->cells[i]);
        }
    guide_free(guide);
    free(photons);
}

/* How keen cells are is what their lobes say of photons that they are not made of: much where all light comes out of one narrow cone, as
 * 1 / its solid angle; no more than an even sky's where each photon comes from anywhere, however sure it is of itself; nothing where
 * there are no others. */
static void keenness(void **state)
{
    (void)state;
    enum { N = 512, KNOWN_PART = 16 };
    const float spread = 1e-4f, cone = 2 * SAMPLING_PI * spread;
    const struct {
        bool narrow, others;
        float least, most; /* per steradian */
    } cases[] = {{true, true, .1f / cone, 1 / cone}, {false, true, 0, 1}, {true, false, 0, 0}};
    for (size_t c = 0; c < COUNT_OF(cases); c++) {
        Photon photons[N];
        for (uint32_t i = 0; i < N; i++) {
            float wide = sqrtf(-2 * spread * logf(1 - dice())), around = 2 * SAMPLING_PI * dice();
            Vec3f near_up = vec3f_normalize(vec3f(wide * cosf(around), 1, wide * sinf(around))),
                  any = sampling_sphere(dice(), dice());
            photons[i] = (Photon){.position = {dice(), 0, dice()},
                                  .from = cases[c].narrow ? near_up : any,
                                  .normal = vec3f(0, 1, 0),
                                  .flux = 1,
                                  .spread = {spread, 0, spread},
                                  .number = i,
                                  .lobe = !cases[c].others || i % KNOWN_PART == 0};
        }
        Guide *guide = build(photons, N);
        double mean = 0;
        for (uint32_t i = 0; i < guide->n_cells; i++) mean += (double)guide->cells[i].keenness / guide->n_cells;
        printf("    %-8s %-12s keenness %.4g, an even cone %.4g\n", cases[c].narrow ? "a cone," : "a sky,",
               cases[c].others ? "many photons" : "known alone", mean, (double)(1 / cone));
        assert_true(mean >= (double)cases[c].least && mean <= (double)cases[c].most);
        guide_free(guide);
    }
}

/* A scene whose photons are followed. */
typedef struct Lit {
    Fixture scene;
    World world;
    PhotonTargets targets;
    PhotonSource source;
} Lit;

static void lit_make(Lit *lit, const char *text)
{
    fixture_compile(&lit->scene, text, 1);
    assert_int_equal(world_init(&lit->world, lit->scene.compiled, 0, 100, false, NULL, &lit->scene.error), STATUS_OK);
    assert_int_equal(photon_targets(&lit->world, &lit->targets, &lit->scene.error), STATUS_OK);
    lit->source = (PhotonSource){.world = &lit->world, .targets = &lit->targets, .seed = 1};
}

static void lit_clear(Lit *lit)
{
    photon_targets_clear(&lit->targets);
    world_clear(&lit->world);
    fixture_clear(&lit->scene);
}

/* A lens is what two balls have in common: photons are sent to it, not to the box that both have in common. */
static void lenses(void **state)
{
    (void)state;
    Lit lit;
    lit_make(&lit,
             FIXTURE_MEDIA "intersection { interior = glass  sphere { center = <0, 195, 0>  radius = 200 }\n"
                           "sphere { center = <0, -195, 0>  radius = 200 } }\n"
                           "light { shape = \"distant\"  from = <0, 1, 0>  to = <0, 0, 0>  angle = .5deg  power = 1 }\n"
                           "camera { from = <0, 10, 300>  to = <0, 0, 0> }\n");
    assert_int_equal(lit.targets.n, 1);
    const double radius = sqrt(200.0 * 200 - 195.0 * 195);
    const Box3 *box = &lit.targets.boxes[0];
    printf("    a lens of a radius of %.4g: its box reaches from %.4g to %.4g\n", radius, box->min.x, box->max.x);
    assert_true(box->max.x > radius && box->max.x < 1.2 * radius && box->min.z < -radius && box->min.z > -1.2 * radius);
    lit_clear(&lit);
}

/* How many of n photons land. */
static int count_landed(const Lit *lit, uint32_t n)
{
    Error error;
    uint64_t rays = 0;
    int n_landed = 0;
    Photon *photons = calloc(n, sizeof *photons);
    assert_int_equal(photons_trace(&lit->source, 0, n, NULL, photons, NULL, &rays, &error), STATUS_OK);
    assert_true(rays >= n);
    for (uint32_t i = 0; i < n; i++) n_landed += photons[i].flux > 0;
    free(photons);
    return n_landed;
}

/* Photons go through a boundary as often as light does: the glass around a lamp does not send them back because another lamp, or this
 * one, is there. */
static void bulbs(void **state)
{
    (void)state;
    enum { N = 4000 };
    Lit lit;
    lit_make(
        &lit, FIXTURE_MEDIA
        "for (i in 0..<3) { group { difference { interior = glass  sphere { radius = 15 }  sphere { radius = 14 } }\n"
        "light { shape = sphere  radius = 2  radiance = 1000 }  translate(<100 * i, 0, 0>) } }\n"
        "difference { box { from = <-900, -900, -900>  to = <900, 900, 900> }\n"
        "box { from = <-899, -899, -899>  to = <899, 899, 899> } surface = surface { albedo = .5 } }\n"
        "camera { from = <0, 10, 300>  to = <0, 0, 0> }\n");
    int n_landed = count_landed(&lit, N);
    printf("    of %d photons from lamps in bulbs, %d land beyond these\n", N, n_landed);
    assert_true(n_landed > 0.8 * N);
    lit_clear(&lit);
}

/* What the sun and lamps send through a slab is found by looks, and photons of it are of no use, but for those that its edges bend. */
static void looked_for(void **state)
{
    (void)state;
    enum { N = 4000 };
    static const char *const lights[] = {
        "light { shape = \"distant\"  from = <0, 1, 0>  to = <0, 0, 0>  angle = .5deg  power = 1 }\n",
        "light { shape = \"sphere\"  from = <0, 600, 0>  radius = 3  radiance = 16000 }\n"};
    for (int i = 0; i < 2; i++) {
        Lit lit;
        char text[800];
        snprintf(text, sizeof text,
                 FIXTURE_MEDIA
                 "box { interior = glass  from = <-30, 60, -30>  to = <30, 66, 30> }\n"
                 "ground { surface = surface { albedo = .5 } } camera { from = <0, 10, 300>  to = <0, 0, 0> }\n%s",
                 lights[i]);
        lit_make(&lit, text);
        int n_landed = count_landed(&lit, N);
        printf("    of %d photons from a %s through a slab, %d land\n", N, i ? "lamp" : "sun", n_landed);
        assert_true(n_landed < N / 100);
        lit_clear(&lit);
    }
}

/* What lands behind a slab is what comes to it, less what is reflected. Its faces are not quite parallel, as it would be found by looks
 * (slab_lamp.h). */
static void flux(void **state)
{
    (void)state;
    enum { N = 40000, LOOKED = 1000 };
    static uint32_t landed_ones[N];
    Lit lit;
    Pool *pool;
    Error error;
    lit_make(&lit, FIXTURE_MEDIA
             "mesh { interior = glass  positions = [<-30, 60, -30>, <30, 60, -30>, <30, 60, 30>, <-30, 60, 30>,\n"
             "  <-30, 66, -30>, <30, 66.03, -30>, <30, 66.03, 30>, <-30, 66, 30>]\n"
             "  triangles = [<0, 1, 2>, <0, 2, 3>, <4, 6, 5>, <4, 7, 6>, <0, 5, 1>, <0, 4, 5>, <1, 6, 2>, <1, 5, 6>,\n"
             "  <2, 7, 3>, <2, 6, 7>, <3, 4, 0>, <3, 7, 4>] }\n"
             "ground { surface = surface { albedo = .5 } } camera { from = <0, 10, 300>  to = <0, 0, 0> }\n"
             "light { shape = \"sphere\"  from = <0, 6000, 0>  radius = 26  radiance = 16000 }\n");
    assert_int_equal(pool_new(2, &pool, &error), STATUS_OK);
    assert_int_equal(lit.targets.n, 1);
    Photon *photons = calloc(N, sizeof *photons), *again = calloc(N, sizeof *again);
    uint64_t rays = 0;
    assert_int_equal(photons_trace(&lit.source, 0, N, pool, photons, NULL, &rays, &error), STATUS_OK);
    double landed = 0, sent = (double)photon_flux(&lit.world, &lit.targets), square = 0;
    int n_landed = 0, n_known = 0;
    for (int i = 0; i < N; i++) {
        double flux = (double)photons[i].flux;
        landed += flux / N;
        square += flux * flux / N;
        if (!(flux > 0)) continue;
        assert_near((double)photons[i].position.y, 0, 1e-4);
        assert_true(photons[i].from.y > .9999f && photons[i].normal.y > .9999f);
        n_landed++;
        landed_ones[n_landed - 1] = (uint32_t)i;
    }
    assert_true(rays >= N);
    assert_int_equal(photons_look_around(&lit.source, photons, landed_ones, LOOKED, pool, &rays, &error), STATUS_OK);
    for (int i = 0; i < LOOKED; i++) {
        const Photon *photon = &photons[landed_ones[i]];
        n_known += photon->lobe && photon->spread[0] > 0 && photon->spread[0] < 1e-4f;
    }
    assert_true(n_known > LOOKED * 99 / 100);
    double r = .04, expected = sent * (1 - r) / (1 + r), deviation = sqrt((square - landed * landed) / N);
    printf("    flux behind a slab: expected %.5g, landed %.5g, error %.2g\n", expected, landed, deviation);
    assert_true(fabs(landed - expected) < 4 * deviation + .02 * expected); /* what is sent is an estimate, too */
    /* the same in two parts, by another number of threads */
    Pool *alone;
    assert_int_equal(pool_new(1, &alone, &error), STATUS_OK);
    assert_int_equal(photons_trace(&lit.source, 0, 1000, alone, again, NULL, &rays, &error), STATUS_OK);
    assert_int_equal(photons_trace(&lit.source, 1000, N - 1000, alone, again + 1000, NULL, &rays, &error), STATUS_OK);
    assert_int_equal(photons_look_around(&lit.source, again, landed_ones, LOOKED, alone, &rays, &error), STATUS_OK);
    assert_memory_equal(photons, again, N * sizeof *photons);
    /* after a stop there is nothing more to wait for */
    volatile sig_atomic_t stop = 1;
    lit.source.stop = &stop;
    rays = 0;
    assert_int_equal(photons_look_around(&lit.source, again, landed_ones, LOOKED, pool, &rays, &error), STATUS_OK);
    assert_memory_equal(photons, again, N * sizeof *photons);
    assert_int_equal(photons_trace(&lit.source, 0, N, pool, again, NULL, &rays, &error), STATUS_OK);
    for (int i = 0; i < N; i++) assert_true(again[i].flux == 0);
    assert_int_equal(rays, 0);
    free(photons);
    free(again);
    pool_free(alone);
    pool_free(pool);
    lit_clear(&lit);
}

/* Of a sea without end, which is not quite flat, as looks would find all through a flat one, photons are sent to tiles around what the
 * camera sees of it, some denser than others: what lands on the bottom is what comes to it in the sun, in each of them. */
static void tiles(void **state)
{
    (void)state;
    enum { N = 200000 };
    Lit lit;
    Pool *pool;
    Error error;
    uint64_t rays = 0;
    lit_make(&lit, FIXTURE_MEDIA
             "plane { distance = 2  interior = glass  surface = surface { bump = noise { }  bump_height = 1e-6 } }\n"
             "ground { surface = surface { albedo = .5 } } camera { from = <0, 40, 0>  to = <0, 0, -40> fov = 60 }\n"
             "light { shape = \"distant\"  from = <0, 1, 0>  to = <0, 0, 0>  angle = .5deg  power = 1 }\n");
    const PhotonTargets *targets = &lit.targets;
    assert_int_equal(pool_new(1, &pool, &error), STATUS_OK);
    assert_true(targets->n_tiles > 8 && targets->n == targets->n_tiles && targets->up == 1);
    Photon *photons = calloc(N, sizeof *photons);
    assert_int_equal(photons_trace(&lit.source, 0, N, pool, photons, NULL, &rays, &error), STATUS_OK);
    double least = HUGE_VAL, most = 0, worst = 0;
    const double landing = .96; /* of what comes to glass; but for the ground, nothing goes back */
    for (uint32_t k = 0; k < targets->n; k++) {
        const Box3 *box = &targets->boxes[k];
        double sum = 0, square = 0;
        double area = (box->max.x - box->min.x) * (box->max.z - box->min.z);
        for (int i = 0; i < N; i++) {
            double flux = (double)photon_flux_there(&photons[i]);
            if (!box3_holds_point(*box, vec3_from_f(photons[i].position))) flux = 0;
            sum += flux / N;
            square += flux * flux / N;
        }
        double deviation = sqrt((square - sum * sum) / N) / area, irradiance = sum / area;
        worst = fmax(worst, fabs(irradiance - landing) / deviation);
        least = fmin(least, targets->density[k]);
        most = fmax(most, targets->density[k]);
        for (uint32_t other = 0; other < k; other++)
            assert_false(box3_holds_point(targets->boxes[other], box3_centre(*box)));
    }
    printf("    %u tiles of a sea: densities from %.2g to %.2g, what lands in each within %.2g standard errors\n",
           targets->n, least, most, worst);
    assert_true(most > 5 * least);
    assert_true(worst < 5);
    free(photons);
    pool_free(pool);
    lit_clear(&lit);
}

/* Where a sea without a bottom scatters light, a few paths go a hundred times as deep as the bed that is seen: photons are sent to what is
 * above that. */
static void without_a_bottom(void **state)
{
    (void)state;
    Lit lit;
    lit_make(&lit, FIXTURE_MEDIA
             "medium murk { ior = 1.33  scattering = .01 / 1mm }\n"
             "plane { distance = 2  interior = murk  surface = surface { bump = noise { }  bump_height = 1e-6 } }\n"
             "box { from = <-60, -4, -60>  to = <60, 0, 60>  surface = surface { albedo = .5 } }\n"
             "camera { from = <0, 40, 0>  to = <0, 0, -10>  fov = 60 }\n"
             "light { shape = \"distant\"  from = <0, 1, 0>  to = <0, 0, 0>  angle = .5deg  power = 1 }\n");
    const PhotonTargets *targets = &lit.targets;
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    for (uint32_t k = 0; k < targets->n_tiles; k++) {
        lowest = fmin(lowest, targets->boxes[k].min.y);
        highest = fmax(highest, targets->boxes[k].max.y);
    }
    printf("    %u tiles, from %.3g to %.3g\n", targets->n_tiles, lowest, highest);
    assert_true(targets->n_tiles > 4);
    assert_true(lowest > -4 && lowest <= 0 && highest >= 2 && highest < 2.1);
    lit_clear(&lit);
}

/* Light that a prism parts goes another way by each colour: what one photon knows of its own says where the others' goes. */
static void hues(void **state)
{
    (void)state;
    enum { N = 4000, LOOKED = 300 };
    static uint32_t chosen[N];
    Lit lit;
    Pool *pool;
    Error error;
    lit_make(&lit,
             "meniscus 1.0 unit cm medium flint { ior = cauchy(1.6, .012)  state = solid }\n"
             "prism { interior = flint  outline = [<-8, 0>, <8, 0>, <0, 13.8>]  from = -5  to = 5 }\n"
             "box { from = <30, -50, -50>  to = <31, 50, 50>  surface = surface { albedo = .5 } }\n"
             "box { from = <-50, -50, -31>  to = <50, 50, -30>  surface = surface { albedo = .5 } }\n"
             "light { shape = disc  radius = .5  from = <-46, 0, -6>  to = <-2.6, 0, 5>  angle = .2  power = 1 }\n"
             "camera { from = <0, 90, 60>  to = <0, 0, 0> }\n");
    assert_int_equal(pool_new(1, &pool, &error), STATUS_OK);
    assert_int_equal(lit.targets.n_lamps, 1);
    Photon *photons = calloc(N, sizeof *photons);
    uint64_t rays = 0;
    assert_int_equal(photons_trace(&lit.source, 0, N, pool, photons, NULL, &rays, &error), STATUS_OK);
    uint32_t n = 0;
    for (uint32_t i = 0; i < N; i++)
        if (photons[i].flux > 0 && n < LOOKED) chosen[n++] = i;
    assert_int_equal(n, LOOKED);
    assert_int_equal(photons_look_around(&lit.source, photons, chosen, n, pool, &rays, &error), STATUS_OK);
    double without = 0, with = 0, bound = 0;
    int n_pairs = 0;
    for (uint32_t i = 0; i + 1 < n; i++) {
        const Photon *a = &photons[chosen[i]], *b = &photons[chosen[i + 1]];
        if (a->way != b->way || !(a->spread[0] > 0) || a->hue_bend > .4f) continue;
        GuideLobe lobes[GUIDE_CELL_LOBES];
        GuideFour fours[GUIDE_CELL_FOURS];
        Photon alone = *a;
        uint32_t n_lobes = fit(&alone, 1, 1, a->position, lobes);
        guide_lay_in_fours(lobes, n_lobes, fours);
        GuidePlace there = {vec3f_along(b->position, -1, a->position), b->color}, same = there;
        same.color = a->color;
        with += chord(guide_lobe_mean(fours, 0, there), b->from);
        without += chord(guide_lobe_mean(fours, 0, same), b->from);
        bound += (double)(a->hue_bend * (a->color - b->color) * (a->color - b->color));
        n_pairs++;
    }
    printf("    %d pairs of photons behind a prism: one's direction is %.3g radians from what the other says without "
           "hues, %.3g with; wrong by %.3g, as it says\n",
           n_pairs, without / n_pairs, with / n_pairs, bound / n_pairs);
    assert_true(n_pairs > LOOKED / 3 && without > .01 * n_pairs);
    assert_true(with < .2 * without && with < bound + .003 * n_pairs);
    free(photons);
    pool_free(pool);
    lit_clear(&lit);
}

/* How large a convex mirror shows the sun along one axis, over how large it is, from some distance: its image is at the focus, that
 * far behind the mirror. */
static double mirrored_part(double focus, double distance)
{
    return focus / (focus + distance);
}

/* A ball shows the sun as small as convex mirrors do, and photons that it has mirrored on to a wall, which stands askew, say so: the
 * area of their spreads is that of the image. */
static void images(void **state)
{
    (void)state;
    enum { N = 60000, LOOKED = 300 };
    static uint32_t chosen[N];
    const double radius = 30, sun = .25 * pi / 180 / 2; /* standard deviation along each axis */
    static const Hopes none;
    Lit lit;
    Error error;
    uint64_t rays = 0;
    lit_make(
        &lit, FIXTURE_MEDIA
        "sphere { radius = 30  interior = glass }\n"
        "box { from = <180, -200, -200>  to = <181, 200, 200>  surface = surface { albedo = .5 }  rotate(z, 25) }\n"
        "light { shape = \"distant\"  from = <0, 1, 0>  to = <0, 0, 0>  angle = .5deg  power = 1 }\n"
        "camera { from = <0, 10, 300>  to = <0, 0, 0> }\n");
    lit.source.hopes = &none; /* so that many are mirrored */
    Photon *photons = calloc(N, sizeof *photons);
    assert_int_equal(photons_trace(&lit.source, 0, N, NULL, photons, NULL, &rays, &error), STATUS_OK);
    uint32_t n = 0;
    for (uint32_t i = 0; i < N; i++)
        if (photons[i].flux > 0 && photons[i].turns == 1 && n < LOOKED) chosen[n++] = i;
    assert_int_equal(n, LOOKED);
    assert_int_equal(photons_look_around(&lit.source, photons, chosen, n, NULL, &rays, &error), STATUS_OK);
    double sum = 0;
    for (uint32_t i = 0; i < n; i++) {
        const Photon *photon = &photons[chosen[i]];
        Vec3 place = vec3_from_f(photon->position), from = vec3_from_f(photon->from);
        double along = -vec3_dot(place, from), beside = vec3_dot(place, place) - along * along;
        double cosine = sqrt(fmax(1 - beside / (radius * radius), 0)), distance = along - radius * cosine;
        double image =
            sun * sun * mirrored_part(radius * cosine / 2, distance) * mirrored_part(radius / (2 * cosine), distance);
        const float *spread = photon->spread;
        sum += sqrt(fmax((double)(spread[0] * spread[2] - spread[1] * spread[1]), 0)) / image / n;
    }
    printf("    the sun in a ball: its image spreads over %.3g of its area\n", sum);
    assert_near(sum, 1, .15);
    free(photons);
    lit_clear(&lit);
}

/* Of a lamp that shines into a cone, all of which comes to the glass, what starts is what it sends: each place of it to each
 * direction alike. */
static void beams(void **state)
{
    (void)state;
    Lit lit;
    lit_make(&lit, FIXTURE_MEDIA "box { interior = glass  from = <-30, -30, -30>  to = <30, 30, 30>  rotate(y, 20) }\n"
                                 "light { shape = disc  radius = 2  from = <60, 50, 100>  to = <0, 0, 0>\n"
                                 "  angle = 3deg  blend = 0  radiance = 7 }\n"
                                 "camera { from = <0, 10, 300>  to = <0, 0, 0> }\n");
    double sine = sin(1.5 * pi / 180), extent = pi * 4 * pi * sine * sine; /* m^2 sr */
    double flux = (double)photon_flux(&lit.world, &lit.targets);
    printf("    of a lamp that sends %.5g into its cone, photons carry %.5g\n", 7 * extent, flux);
    assert_int_equal(lit.targets.n_lamps, 1);
    assert_near(lit.targets.lamps->power / (7 * extent), 1, .01);
    assert_near(flux / (7 * extent), 1, .05); /* a mean over the wavelengths */
    lit_clear(&lit);
}

typedef struct Visit {
    const Guide *guide;
    Vec3 origin, direction;
    double along;
    int n_wrong;
} Visit;

static void visit(void *context, const GuideCell *cell, double begin, double end)
{
    Visit *visits = context;
    assert_true(begin < end && cell->scattered > 0);
    visits->along += end - begin;
    for (int i = 1; i < 8; i++) {
        Vec3 place = vec3_along(visits->origin, begin + (end - begin) * i / 8, visits->direction);
        visits->n_wrong += guide_find(visits->guide, place, false, 0).cell != cell;
    }
}

/* Along lines through smoke all cells are met, each where it is. */
static void walks(void **state)
{
    (void)state;
    enum { N = 4000, LINES = 500, STEPS = 4000 };
    Photon *photons = calloc(N, sizeof *photons);
    for (int i = 0; i < N; i++) {
        photons[i] = random_photon();
        photons[i].lobe = 1;
        if (i % 5 == 0) photons[i].position.y = 0, photons[i].normal = vec3f(0, 1, 0); /* on a floor */
        if (i % 7 == 0) photons[i].position = vec3f(dice(), .5f + .01f * dice(), .5f); /* a thin beam */
    }
    Guide *guide = build(photons, N);
    double worst = 0;
    int n_wrong = 0;
    for (int i = 0; i < LINES; i++) {
        Visit visits = {.guide = guide,
                        .origin = vec3(3 * (double)dice() - 1, 3 * (double)dice() - 1, 3 * (double)dice() - 1),
                        .direction = vec3_from_f(sampling_sphere(dice(), dice()))};
        if (i % 10 == 0) visits.direction = vec3(0, i % 20 ? 1 : -1, 0);
        double begin = .5 * (double)dice(), end = begin + 2 * (double)dice(), along = 0;
        guide_walk(guide, visits.origin, visits.direction, begin, end, visit, &visits);
        for (int k = 0; k < STEPS; k++) {
            double t = begin + (end - begin) * (k + .5) / STEPS;
            GuideAt at = guide_find(guide, vec3_along(visits.origin, t, visits.direction), false, 0);
            along += at.cell && at.cell->scattered > 0 ? (end - begin) / STEPS : 0;
        }
        worst = fmax(worst, fabs(along - visits.along));
        n_wrong += visits.n_wrong;
    }
    printf("    %d lines through %u cells: lengths within %.2g of those by steps, %d places in another cell\n", LINES,
           guide->n_cells, worst, n_wrong);
    assert_int_equal(n_wrong, 0);
    assert_true(worst < .02);
    guide_free(guide);
    free(photons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(densities),  cmocka_unit_test(sheets),        cmocka_unit_test(waves),
        cmocka_unit_test(folds),      cmocka_unit_test(doubts),        cmocka_unit_test(corners),
        cmocka_unit_test(sides),      cmocka_unit_test(borrowed),      cmocka_unit_test(missed),
        cmocka_unit_test(keenness),   cmocka_unit_test(levels),        cmocka_unit_test(flux),
        cmocka_unit_test(looked_for), cmocka_unit_test(bulbs),         cmocka_unit_test(lenses),
        cmocka_unit_test(hues),       cmocka_unit_test(beams),         cmocka_unit_test(walks),
        cmocka_unit_test(tiles),      cmocka_unit_test(gaps),          cmocka_unit_test(apart),
        cmocka_unit_test(far_away),   cmocka_unit_test(judged_within), cmocka_unit_test(without_a_bottom),
        cmocka_unit_test(images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

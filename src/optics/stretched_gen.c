/* stretched_gen.c - solves the tables of stretched.h and writes them as C source, at build time.
 *     stretched_gen FILE
 * Asks the tables of microfacet.h, beyond which these go. Takes about fifteen seconds.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "optics/bsdf_lobe.h"
#include "optics/facet_sums.h"
#include "optics/stretched.h"
#include "optics/table_writer.h"

/* A lattice of facets that are mirrors. */
enum { WAYS = 610, WAY_STRIDE = 377 };
/* Between more nearly equal indices next to nothing is missed, and less than rounding would make of it. */
enum { LEAST_INDEX = 3 };
enum { DIRECTIONS = STRETCHED_AZIMUTHS * STRETCHED_ANGLES };

/* What is to be found, for the objects that this is linked with; they are not asked for it. */
const float stretched_mirror[STRETCHED_ROUGHNESSES][STRETCHED_RATIOS][STRETCHED_AZIMUTHS][STRETCHED_ANGLES];
const StretchedTable stretched_missing, stretched_excess;
const StretchedMeans stretched_missing_mean, stretched_reflected_mean;

static float mirrors[STRETCHED_ROUGHNESSES][STRETCHED_RATIOS][STRETCHED_AZIMUTHS][STRETCHED_ANGLES];
static struct Boundaries {
    StretchedTable missing, excess;
} boundaries;
static StretchedMeans missing_mean, reflected_mean;

static void alphas_of(int roughness, int ratio, float *alpha_x, float *alpha_y)
{
    float root = (float)roughness / (STRETCHED_ROUGHNESSES - 1), rms = fmaxf(root * root, MICROFACET_SMOOTH_ALPHA);
    float rest = 1 - (1 - sqrtf(STRETCHED_LEAST_RATIO)) * (float)ratio / (STRETCHED_RATIOS - 1), less = rest * rest;
    *alpha_x = rms * sqrtf(2 / (1 + less * less));
    *alpha_y = less * *alpha_x;
}

static float index_of(int knot)
{
    return microfacet_index_at((float)knot / (STRETCHED_INDICES - 1));
}

static Vec3f direction_at(int azimuth, float z)
{
    float t = (float)azimuth / (STRETCHED_AZIMUTHS - 1), r = sqrtf(fmaxf(0, (1 - z * z) / (t * t + (1 - t) * (1 - t))));
    return vec3f((1 - t) * r, t * r, z);
}

/* ---- mirrors ---- */

static Vec3f mirror_direction(int azimuth, int angle, float alpha_x, float alpha_y)
{
    float low = 0, high = 1, wanted = (float)angle / (STRETCHED_ANGLES - 1);
    for (int i = 0; i < 40; i++) {
        float z = 0.5f * (low + high), s = microfacet_slope(alpha_x, alpha_y, direction_at(azimuth, z));
        *(microfacet_angle(z, s) < wanted ? &low : &high) = z;
    }
    return direction_at(azimuth, fmaxf(0.5f * (low + high), 1e-6f));
}

/* What round facets' k makes of light that goes from v to l, spread over the four knots around l. */
static void add_reflection(const BsdfFacets *facets, MicrofacetPlace round, Vec3f v, const float u[2], double *row)
{
    Vec3f l;
    if (!facets_sample_reflection(facets, v, u, &l)) return;
    FacetReflection r = facets_reflect(facets, v, l);
    double weight =
        (double)(r.shadowing * microfacet_mirror(round, r.angle_v) * microfacet_mirror(round, r.angle_l)) / WAYS;
    MicrofacetPlace azimuth = microfacet_place(stretched_azimuth(l, false), STRETCHED_AZIMUTHS);
    MicrofacetPlace angle = microfacet_place(r.angle_l, STRETCHED_ANGLES);
    for (int i = 0; i < 4; i++) {
        double part =
            (double)((i & 1 ? azimuth.fraction : 1 - azimuth.fraction) * (i & 2 ? angle.fraction : 1 - angle.fraction));
        row[(azimuth.knot + (i & 1)) * STRETCHED_ANGLES + angle.knot + (i >> 1)] += part * weight;
    }
}

static void solve_mirrors(int roughness, int ratio)
{
    static double sums[DIRECTIONS][DIRECTIONS];
    float *k = &mirrors[roughness][ratio][0][0];
    BsdfFacets facets = {.smooth = false};
    alphas_of(roughness, ratio, &facets.alpha_x, &facets.alpha_y);
    MicrofacetPlace round = microfacet_index(facets.alpha_x, facets.alpha_y, lanes_all(1)).roughness;
    memset(sums, 0, sizeof sums);
    for (int i = 0; i < DIRECTIONS; i++) {
        Vec3f v = mirror_direction(i / STRETCHED_ANGLES, i % STRETCHED_ANGLES, facets.alpha_x, facets.alpha_y);
        for (int n = 0; n < WAYS; n++) {
            float u[2];
            facet_lattice(n, WAYS, WAY_STRIDE, u);
            add_reflection(&facets, round, v, u, sums[i]);
        }
        k[i] = 1;
    }
    for (int turn = 0; turn < 60; turn++) {
        static float next[DIRECTIONS];
        for (int i = 0; i < DIRECTIONS; i++) {
            double sum = 0;
            for (int n = 0; n < DIRECTIONS; n++) sum += sums[i][n] * (double)k[n];
            next[i] = sum > 0 ? (float)sqrt((double)k[i] / sum) : k[i];
        }
        memcpy(k, next, sizeof next);
    }
}

/* ---- boundaries ---- */

static float lookup_round(const MicrofacetTable table, float eta, float z, float alpha)
{
    MicrofacetIndex index = microfacet_index(alpha, alpha, lanes_all(eta));
    return lanes_get(microfacet_lookup(table, &index, false, z, stretched_slope(alpha, z)), 0);
}

/* The Fresnel reflectance that an excess is over. */
static float below_excess(float eta, float z, float alpha)
{
    if (eta >= 1) return fresnel_dielectric(z, 1, eta);
    return fresnel_dielectric(fminf(microfacet_softened(z, microfacet_critical(eta), alpha), 1), 1, eta);
}

static uint16_t packed(float x)
{
    return (uint16_t)lrintf((x + 1) * MICROFACET_ONE);
}

/* The direction at an azimuth's knot and a step. */
static Vec3f boundary_direction(int azimuth, int step, float alpha_x, float alpha_y, float eta)
{
    float low = 0, high = 1, wanted = (float)step / (STRETCHED_STEPS - 1);
    for (int i = 0; i < 40; i++) {
        float z = 0.5f * (low + high), alpha = stretched_alpha(alpha_x, alpha_y, direction_at(azimuth, z));
        float s = stretched_slope(alpha, z);
        float at = eta < 1 ? microfacet_angle_within(z, s, microfacet_critical(eta), alpha) : microfacet_angle(z, s);
        *(at < wanted ? &low : &high) = z;
    }
    float z = step == 0 ? 0 : step == STRETCHED_STEPS - 1 ? 1 : 0.5f * (low + high);
    return direction_at(azimuth, fmaxf(z, 1e-6f));
}

static void sum_boundary(int side, int knot, int roughness, int ratio)
{
    float alpha_x, alpha_y, eta = side ? 1 / index_of(knot) : index_of(knot);
    alphas_of(roughness, ratio, &alpha_x, &alpha_y);
    for (int azimuth = 0; azimuth < STRETCHED_AZIMUTHS; azimuth++)
        for (int step = 0; step < STRETCHED_STEPS; step++) {
            float more_missed = 0, more_reflected = 0;
            if (knot >= LEAST_INDEX && ratio > 0) {
                Vec3f v = boundary_direction(azimuth, step, alpha_x, alpha_y, eta);
                float alpha = stretched_alpha(alpha_x, alpha_y, v), reflected, missed;
                facet_sums(alpha_x, alpha_y, eta, v, &reflected, &missed);
                more_missed = missed - lookup_round(microfacet_missing, eta, v.z, alpha);
                more_reflected =
                    reflected - below_excess(eta, v.z, alpha) - lookup_round(microfacet_excess, eta, v.z, alpha);
            }
            boundaries.missing[side][knot][roughness][ratio][azimuth][step] = packed(more_missed);
            boundaries.excess[side][knot][roughness][ratio][azimuth][step] = packed(more_reflected);
        }
}

/* As the tables are looked up, over the directions of a quarter of the hemisphere; beyond round facets. */
static void average_boundary(int side, int knot, int roughness, int ratio)
{
    enum { COSINES = 48, TURNS = 24 };
    float alpha_x, alpha_y, eta = side ? 1 / index_of(knot) : index_of(knot);
    alphas_of(roughness, ratio, &alpha_x, &alpha_y);
    StretchedIndex index = stretched_index(alpha_x, alpha_y, lanes_all(eta));
    const struct Boundaries *found = &boundaries;
    double missed = 0, reflected = 0;
    for (int i = 0; i < COSINES; i++)
        for (int k = 0; k < TURNS; k++) {
            float z = ((float)i + 0.5f) / COSINES, turn = ((float)k + 0.5f) / TURNS * 0.5f * SAMPLING_PI;
            float r = sqrtf(1 - z * z);
            Vec3f v = vec3f(r * cosf(turn), r * sinf(turn), z);
            Lanes m = stretched_lookup_boundary(microfacet_missing, found->missing, &index, false, v);
            Lanes e = stretched_lookup_boundary(microfacet_excess, found->excess, &index, false, v);
            missed += (double)(2 * z * lanes_get(m, 0));
            reflected +=
                (double)(2 * z * (lanes_get(e, 0) + below_excess(eta, z, stretched_alpha(alpha_x, alpha_y, v))));
        }
    Lanes m = microfacet_lookup_mean(microfacet_missing_mean, &index.index, false);
    Lanes r = microfacet_lookup_mean(microfacet_reflected_mean, &index.index, false);
    missing_mean[side][knot][roughness][ratio] = (float)(missed / (COSINES * TURNS)) - lanes_get(m, 0);
    reflected_mean[side][knot][roughness][ratio] = (float)(reflected / (COSINES * TURNS)) - lanes_get(r, 0);
}

/* ---- all ---- */

static int write_tables(const char *path)
{
    FILE *out = fopen(path, "w");
    if (!out) {
        perror(path);
        return 1;
    }
    fputs("/* Made by stretched_gen; see optics/stretched.h. */\n#include \"optics/stretched.h\"\n"
          "#pragma GCC diagnostic ignored \"-Wmissing-braces\"\n",
          out);
    table_write_floats(
        out, "float stretched_mirror[STRETCHED_ROUGHNESSES][STRETCHED_RATIOS][STRETCHED_AZIMUTHS][STRETCHED_ANGLES]",
        &mirrors[0][0][0][0], sizeof mirrors / sizeof(float), STRETCHED_ANGLES);
    table_write_packed(out, "StretchedTable stretched_missing", &boundaries.missing[0][0][0][0][0][0],
                       sizeof(StretchedTable) / sizeof(uint16_t), STRETCHED_STEPS);
    table_write_packed(out, "StretchedTable stretched_excess", &boundaries.excess[0][0][0][0][0][0],
                       sizeof(StretchedTable) / sizeof(uint16_t), STRETCHED_STEPS);
    const size_t n_means = sizeof missing_mean / sizeof(float);
    table_write_floats(out, "StretchedMeans stretched_missing_mean", &missing_mean[0][0][0][0], n_means,
                       STRETCHED_RATIOS);
    table_write_floats(out, "StretchedMeans stretched_reflected_mean", &reflected_mean[0][0][0][0], n_means,
                       STRETCHED_RATIOS);
    return table_close(out, "stretched_gen", path);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fputs("usage: stretched_gen FILE\n", stderr);
        return 2;
    }
    for (int roughness = 0; roughness < STRETCHED_ROUGHNESSES; roughness++)
        for (int ratio = 0; ratio < STRETCHED_RATIOS; ratio++) {
            solve_mirrors(roughness, ratio);
            for (int i = 0; i < 2 * STRETCHED_INDICES; i++) sum_boundary(i % 2, i / 2, roughness, ratio);
        }
    for (int i = 0; i < 2 * STRETCHED_INDICES * STRETCHED_ROUGHNESSES * STRETCHED_RATIOS; i++) {
        int n = i / 2, ratio = n % STRETCHED_RATIOS, roughness = n / STRETCHED_RATIOS % STRETCHED_ROUGHNESSES;
        average_boundary(i % 2, n / STRETCHED_RATIOS / STRETCHED_ROUGHNESSES, roughness, ratio);
    }
    return write_tables(argv[1]);
}

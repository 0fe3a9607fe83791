/* microfacet_gen.c - solves the tables of microfacet.h and writes them as C source, at build time.
 *     microfacet_gen FILE
 * What the facets do that are seen from a direction is summed over a fixed set of them. For mirrors the unknowns are k
 * at the knots: where light goes that meets a facet, and how much, is noted once, and k <- sqrt(k / (K k)) is repeated
 * until k K k = 1. Takes about ten seconds.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>

#include "optics/facet_sums.h"
#include "optics/table_writer.h"

enum { ROUNDS = 400 };

/* Light that a facet sends to a place between two angles, with a weight. */
typedef struct Way {
    int knot;
    float fraction, weight;
} Way;

typedef struct Tables {
    MicrofacetTable missing, excess;
    MicrofacetMeans missing_mean, reflected_mean;
    float mirror[MICROFACET_ROUGHNESSES][MICROFACET_ANGLES];
    float mirror_mean[MICROFACET_ROUGHNESSES];
    Way ways[MICROFACET_ANGLES][FACETS];
} Tables;

static float alpha_of(int roughness)
{
    float r = (float)roughness / (MICROFACET_ROUGHNESSES - 1);
    return fmaxf(r * r, 1e-4f);
}
static float index_of(int knot)
{
    return microfacet_index_at((float)knot / (MICROFACET_INDICES - 1));
}
static Vec3f direction_of(float z)
{
    return vec3f(sqrtf(fmaxf(0, 1 - z * z)), 0, z);
}

/* Where a direction is in a table; critical 0: on the side of the smaller index, and for mirrors. */
static float angle_of(float z, float alpha, float critical)
{
    float s = microfacet_slope(alpha, alpha, direction_of(z));
    return critical > 0 ? microfacet_angle_within(z, s, critical, alpha) : microfacet_angle(z, s);
}

/* The cosine at a knot. */
static float cosine_of(int angle, float alpha, float critical)
{
    float low = 0, high = 1, wanted = (float)angle / (MICROFACET_ANGLES - 1);
    for (int i = 0; i < 40; i++) {
        float middle = 0.5f * (low + high);
        if (angle_of(middle, alpha, critical) < wanted)
            low = middle;
        else
            high = middle;
    }
    return angle == 0 ? 0 : angle == MICROFACET_ANGLES - 1 ? 1 : 0.5f * (low + high);
}

static void look_at_mirrors(Way ways[FACETS], float alpha, float z)
{
    Vec3f v = direction_of(z);
    float s_v = microfacet_slope(alpha, alpha, v);
    for (int i = 0; i < FACETS; i++) {
        Vec3f l = reflect_direction(vec3f_negate(v), facet_visible(alpha, alpha, v, i));
        ways[i] = (Way){0};
        if (!(l.z > 0)) continue;
        float s_l = microfacet_slope(alpha, alpha, l);
        MicrofacetPlace place = microfacet_place(microfacet_angle(l.z, s_l), MICROFACET_ANGLES);
        ways[i] = (Way){place.knot, place.fraction, microfacet_shadowing(z, s_v, l.z, s_l) / FACETS};
    }
}

static float gather(const Way ways[FACETS], const float *k)
{
    double sum = 0;
    for (int i = 0; i < FACETS; i++) {
        const float *at = k + ways[i].knot;
        sum += (double)(ways[i].weight * (at[0] + (at[1] - at[0]) * ways[i].fraction));
    }
    return (float)sum;
}

/* Returns the largest |k K k - 1|. */
static float scale_mirrors(Way ways[MICROFACET_ANGLES][FACETS], float *k)
{
    float worst = 1;
    for (int i = 0; i < MICROFACET_ANGLES; i++) k[i] = 1;
    for (int round = 0; round < ROUNDS && worst > 1e-5f; round++) {
        worst = 0;
        float next[MICROFACET_ANGLES];
        for (int i = 0; i < MICROFACET_ANGLES; i++) {
            float sum = gather(ways[i], k);
            worst = fmaxf(worst, fabsf(k[i] * sum - 1));
            next[i] = sqrtf(k[i] / sum);
        }
        for (int i = 0; i < MICROFACET_ANGLES; i++) k[i] = next[i];
    }
    return worst;
}

/* 2 * integral over the cosine of what a table of angles holds, as it is looked up */
static float mean_over_cosines(const float *table, float alpha, float critical)
{
    enum { STEPS = 2000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        float z = ((float)i + 0.5f) / STEPS;
        MicrofacetPlace place = microfacet_place(angle_of(z, alpha, critical), MICROFACET_ANGLES);
        sum += (double)(2 * z * (table[place.knot] + (table[place.knot + 1] - table[place.knot]) * place.fraction));
    }
    return (float)(sum / STEPS);
}

/* The same of the Fresnel reflectance that the excess is over. */
static float mean_softened(float eta, float alpha, float critical)
{
    enum { STEPS = 2000 };
    double sum = 0;
    if (critical == 0) return fresnel_dielectric_mean(1, eta);
    for (int i = 0; i < STEPS; i++) {
        float z = ((float)i + 0.5f) / STEPS;
        sum += (double)(2 * z * fresnel_dielectric(fminf(microfacet_softened(z, critical, alpha), 1), 1, eta));
    }
    return (float)(sum / STEPS);
}

static uint16_t packed(float x)
{
    return (uint16_t)lrintf((x + 1) * MICROFACET_ONE);
}

static void sum_boundary(int index, int roughness, Tables *tables)
{
    float alpha = alpha_of(roughness), eta = index_of(index);
    for (int side = 0; side < 2; side++) {
        float missing[MICROFACET_ANGLES], excess[MICROFACET_ANGLES];
        float relative = side ? 1 / eta : eta, critical = side ? microfacet_critical(relative) : 0;
        for (int i = 0; i < MICROFACET_ANGLES; i++) {
            float z = cosine_of(i, alpha, critical), reflected, missed;
            facet_sums(alpha, alpha, relative, direction_of(z), &reflected, &missed);
            /* between equal indices all goes straight on, at grazing angles, too, where rounding decides on the side */
            missing[i] = index == 0 ? 0 : missed;
            float soft = side ? fminf(microfacet_softened(z, critical, alpha), 1) : z;
            excess[i] = index == 0 ? 0 : reflected - fresnel_dielectric(soft, 1, relative);
            tables->missing[side][index][roughness][i] = packed(missing[i]);
            tables->excess[side][index][roughness][i] = packed(excess[i]);
        }
        tables->missing_mean[side][index][roughness] = mean_over_cosines(missing, alpha, critical);
        tables->reflected_mean[side][index][roughness] =
            mean_softened(relative, alpha, critical) + mean_over_cosines(excess, alpha, critical);
    }
}

static float solve_mirrors(int roughness, Tables *tables)
{
    float alpha = alpha_of(roughness), ones[MICROFACET_ANGLES], albedo[MICROFACET_ANGLES];
    for (int i = 0; i < MICROFACET_ANGLES; i++) ones[i] = 1;
    for (int i = 0; i < MICROFACET_ANGLES; i++) {
        look_at_mirrors(tables->ways[i], alpha, cosine_of(i, alpha, 0));
        albedo[i] = gather(tables->ways[i], ones);
    }
    tables->mirror_mean[roughness] = mean_over_cosines(albedo, alpha, 0);
    return scale_mirrors(tables->ways, tables->mirror[roughness]);
}

/* Hexadecimal floats: exact, whatever reads them. */
static int write_tables(const char *path, const Tables *tables)
{
    FILE *out = fopen(path, "w");
    if (!out) {
        perror(path);
        return 1;
    }
    /* flat initializers of nested arrays are C; the warning about them is for what people write */
    fputs("/* Made by microfacet_gen; see optics/microfacet.h. */\n#include \"optics/microfacet.h\"\n"
          "#pragma GCC diagnostic ignored \"-Wmissing-braces\"\n",
          out);
    const size_t n_means = sizeof tables->missing_mean / sizeof(float);
    table_write_packed(out, "MicrofacetTable microfacet_missing", &tables->missing[0][0][0][0],
                       sizeof(MicrofacetTable) / sizeof(uint16_t), MICROFACET_ANGLES);
    table_write_packed(out, "MicrofacetTable microfacet_excess", &tables->excess[0][0][0][0],
                       sizeof(MicrofacetTable) / sizeof(uint16_t), MICROFACET_ANGLES);
    table_write_floats(out, "MicrofacetMeans microfacet_missing_mean", &tables->missing_mean[0][0][0], n_means,
                       MICROFACET_ROUGHNESSES);
    table_write_floats(out, "MicrofacetMeans microfacet_reflected_mean", &tables->reflected_mean[0][0][0], n_means,
                       MICROFACET_ROUGHNESSES);
    table_write_floats(out, "float microfacet_mirror_scaling[MICROFACET_ROUGHNESSES][MICROFACET_ANGLES]",
                       &tables->mirror[0][0], MICROFACET_ROUGHNESSES * MICROFACET_ANGLES, MICROFACET_ANGLES);
    table_write_floats(out, "float microfacet_mirror_mean[MICROFACET_ROUGHNESSES]", tables->mirror_mean,
                       MICROFACET_ROUGHNESSES, MICROFACET_ROUGHNESSES);
    return table_close(out, "microfacet_gen", path);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fputs("usage: microfacet_gen FILE\n", stderr);
        return 2;
    }
    Tables *tables = calloc(1, sizeof *tables);
    if (!tables) {
        fputs("microfacet_gen: out of memory\n", stderr);
        return 1;
    }
    float worst = 0;
    for (int roughness = 0; roughness < MICROFACET_ROUGHNESSES; roughness++) {
        worst = fmaxf(worst, solve_mirrors(roughness, tables));
        for (int index = 0; index < MICROFACET_INDICES; index++) sum_boundary(index, roughness, tables);
    }
    int status = 1;
    if (worst < 1e-4f)
        status = write_tables(argv[1], tables);
    else
        fprintf(stderr, "microfacet_gen: %g of the light is missing\n", (double)worst);
    free(tables);
    return status;
}

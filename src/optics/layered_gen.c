/* layered_gen.c - solves the tables of layered.h and writes them as C source, at build time.
 *     layered_gen FILE
 * What a surface makes of light from a direction is noted once, as light that goes to places between angles, for many
 * directions; what a layer makes of that is then a sum over them. Takes some seconds.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>

#include "optics/bsdf_lobe.h"
#include "optics/layered.h"

/* WAYS and STRIDE are neighbours in Fibonacci's sequence. */
enum { WAYS = 610, STRIDE = 377, ROUNDS = 200 };

/* Light that goes to a place between two angles, with a weight, at a cosine. */
typedef struct Way {
    int knot;
    float fraction, weight, cosine;
} Way;

static Way ways[LAYERED_ANGLES][WAYS];
static float cosines[LAYERED_ANGLES]; /* of the knots */
static LayeredTable mirrors[LAYERED_MIRRORS], diffuses[LAYERED_DIFFUSES];
static float fuzz[LAYERED_FUZZ][LAYERED_ANGLES];
static LayeredFuzzTable fuzz_mirrors[LAYERED_MIRRORS], fuzz_diffuses[LAYERED_DIFFUSES];

static Vec3f direction_of(float z)
{
    return vec3f(sqrtf(fmaxf(0, 1 - z * z)), 0, z);
}

static void numbers(int i, float u[2])
{
    u[0] = ((float)i + 0.5f) / WAYS;
    u[1] = ((float)((i * STRIDE) % WAYS) + 0.5f) / WAYS;
}

static Way way_to(float angle, float weight, float cosine)
{
    MicrofacetPlace place = microfacet_place(angle, LAYERED_ANGLES);
    return (Way){place.knot, place.fraction, weight, cosine};
}

/* White facets, with what microfacet_mirror puts back. */
static void look_at_mirrors(float alpha)
{
    BsdfFacets facets = facets_make(alpha, alpha);
    MicrofacetPlace roughness = microfacet_index(alpha, alpha, lanes_all(1)).roughness;
    for (int i = 0; i < LAYERED_ANGLES; i++) {
        float low = 0, high = 1, wanted = (float)i / (LAYERED_ANGLES - 1);
        for (int k = 0; k < 40; k++) {
            float middle = 0.5f * (low + high);
            bool below = microfacet_angle(middle, microfacet_slope(alpha, alpha, direction_of(middle))) < wanted;
            *(below ? &low : &high) = middle;
        }
        cosines[i] = fmaxf(i == LAYERED_ANGLES - 1 ? 1 : 0.5f * (low + high), 1e-6f);
        Vec3f view = direction_of(cosines[i]), light;
        for (int k = 0; k < WAYS; k++) {
            float u[2];
            numbers(k, u);
            ways[i][k] = (Way){.cosine = 1};
            if (!facets_sample_reflection(&facets, view, u, &light)) continue;
            FacetReflection r = facets_reflect(&facets, view, light);
            float scaling = microfacet_mirror(roughness, r.angle_v) * microfacet_mirror(roughness, r.angle_l);
            ways[i][k] = way_to(r.angle_l, r.shadowing * scaling / WAYS, light.z);
        }
    }
}

static void look_at_diffuse(float roughness)
{
    BsdfDiffuse diffuse = diffuse_make(lanes_all(1), roughness);
    for (int i = 0; i < LAYERED_ANGLES; i++) {
        cosines[i] = fmaxf((float)i / (LAYERED_ANGLES - 1), 1e-6f);
        for (int k = 0; k < WAYS; k++) {
            float u[2], pdf;
            numbers(k, u);
            Vec3f light = sampling_cosine_hemisphere(u[0], u[1], vec3f(0, 0, 1), &pdf);
            float f_cos = lanes_get(diffuse_evaluate(&diffuse, direction_of(cosines[i]), light), 0);
            ways[i][k] = way_to(light.z, f_cos / pdf / WAYS, light.z);
        }
    }
}

/* What lets light pass: a layer, or fuzz of a roughness that covers a share. */
typedef struct Cover {
    const BsdfLayer *layer; /* NULL: fuzz */
    int fuzz;
    float share;
} Cover;

static float passed(const Cover *cover, float cosine)
{
    if (cover->layer) return lanes_get(lanes_rest(layer_reflectance(cover->layer, direction_of(cosine))), 0);
    MicrofacetPlace place = microfacet_place(sqrtf(cosine), LAYERED_ANGLES);
    const float *row = fuzz[cover->fuzz];
    return 1 - cover->share * (row[place.knot] + (row[place.knot + 1] - row[place.knot]) * place.fraction);
}

/* u at the knots: u S K S u = T with S = sqrt(T) (T / mean T)^(quarters / 4). */
static void solve(const Cover *cover, int quarters, float u[LAYERED_ANGLES])
{
    static double sums[LAYERED_ANGLES][LAYERED_ANGLES];
    double wanted[LAYERED_ANGLES], mean = 0;
    for (int k = 0; k < WAYS; k++) mean += (double)passed(cover, sqrtf(((float)k + 0.5f) / WAYS)) / WAYS;
    for (int i = 0; i < LAYERED_ANGLES; i++) {
        double white = 0, t = (double)passed(cover, cosines[i]);
        for (int k = 0; k < LAYERED_ANGLES; k++) sums[i][k] = 0;
        for (int k = 0; k < WAYS; k++) {
            const Way *way = &ways[i][k];
            double out = (double)passed(cover, way->cosine);
            double weight = (double)way->weight * sqrt(out) * pow(out / mean, 0.25 * quarters);
            white += (double)way->weight;
            sums[i][way->knot] += weight * (1 - (double)way->fraction);
            sums[i][way->knot + 1] += weight * (double)way->fraction;
        }
        wanted[i] = t > 0 ? sqrt(t) * pow(t / mean, -0.25 * quarters) * white
                          : 0; /* the sum over directions is not exact: of what it has of white */
        u[i] = 1;
    }
    for (int round = 0; round < ROUNDS; round++) {
        float next[LAYERED_ANGLES];
        for (int i = 0; i < LAYERED_ANGLES; i++) {
            double sum = 0;
            for (int k = 0; k < LAYERED_ANGLES; k++) sum += sums[i][k] * (double)u[k];
            next[i] = sum > 0 ? (float)sqrt((double)u[i] * wanted[i] / sum) : u[i];
        }
        for (int i = 0; i < LAYERED_ANGLES; i++) u[i] = next[i];
    }
}

static float index_of(int knot)
{
    float y = (float)knot / (LAYERED_INDICES - 1), x = y * y * y * y / 2;
    return (1 + x) / (1 - x);
}

static void solve_layers(LayeredTable table, int quarters)
{
    for (int rough = 0; rough < LAYERED_ROUGHNESSES; rough++)
        for (int side = 0; side < 2; side++)
            for (int i = 0; i < LAYERED_INDICES; i++) {
                float r = (float)rough / (LAYERED_ROUGHNESSES - 1), eta = index_of(i);
                BsdfLayer layer = layer_make(lanes_all(side ? 1 / eta : eta), r * r, lanes_all(1));
                solve(&(Cover){.layer = &layer}, quarters, table[rough][side][i]);
            }
}

static void solve_fuzz(LayeredFuzzTable table, int quarters)
{
    for (int i = 0; i < LAYERED_FUZZ; i++)
        for (int k = 0; k < LAYERED_SHARES; k++)
            solve(&(Cover){.fuzz = i, .share = (float)k / (LAYERED_SHARES - 1)}, quarters, table[i][k]);
}

static float sum_fuzz(float exponent, float cosine)
{
    enum { STEPS = 200 };
    double sum = 0;
    Vec3f view = direction_of(fmaxf(cosine, 1e-5f));
    for (int i = 0; i < STEPS; i++)
        for (int k = 0; k < STEPS; k++) {
            float z = ((float)i + 0.5f) / STEPS, angle = ((float)k + 0.5f) / STEPS * SAMPLING_PI, r = sqrtf(1 - z * z);
            sum += (double)(layered_fuzz_value(exponent, view, vec3f(r * cosf(angle), r * sinf(angle), z)) * z);
        }
    return (float)(sum * 2 * (double)SAMPLING_PI / (STEPS * STEPS));
}

/* ---- stretched facets ---- */

enum { STRETCHED_DIRECTIONS = STRETCHED_AZIMUTHS * STRETCHED_ANGLES };
static float stretched[STRETCHED_ROUGHNESSES][STRETCHED_RATIOS][STRETCHED_AZIMUTHS][STRETCHED_ANGLES];

/* The direction at two knots. */
static Vec3f stretched_direction(int azimuth, int angle, float alpha_x, float alpha_y)
{
    float t = (float)azimuth / (STRETCHED_AZIMUTHS - 1), length = sqrtf(t * t + (1 - t) * (1 - t));
    float low = 0, high = 1, wanted = (float)angle / (STRETCHED_ANGLES - 1);
    Vec3f w = {0, 0, 1};
    for (int i = 0; i < 40; i++) {
        float z = 0.5f * (low + high), r = sqrtf(fmaxf(0, 1 - z * z)) / length;
        w = vec3f((1 - t) * r, t * r, z);
        *(microfacet_angle(z, microfacet_slope(alpha_x, alpha_y, w)) < wanted ? &low : &high) = z;
    }
    return w;
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

static void solve_stretched(int roughness, int ratio)
{
    static double sums[STRETCHED_DIRECTIONS][STRETCHED_DIRECTIONS];
    float root = (float)roughness / (STRETCHED_ROUGHNESSES - 1), rest = 1 - (float)ratio / (STRETCHED_RATIOS - 1);
    float less = fmaxf(rest * rest, 1e-3f), rms = fmaxf(root * root, 1e-3f);
    float alpha_x = rms * sqrtf(2 / (1 + less * less)), *k = &stretched[roughness][ratio][0][0];
    const BsdfFacets facets = {.alpha_x = alpha_x, .alpha_y = less * alpha_x};
    MicrofacetPlace round = microfacet_index(facets.alpha_x, facets.alpha_y, lanes_all(1)).roughness;
    for (int i = 0; i < STRETCHED_DIRECTIONS; i++) {
        Vec3f v = stretched_direction(i / STRETCHED_ANGLES, i % STRETCHED_ANGLES, facets.alpha_x, facets.alpha_y);
        v.z = fmaxf(v.z, 1e-6f);
        for (int n = 0; n < STRETCHED_DIRECTIONS; n++) sums[i][n] = 0;
        for (int n = 0; n < WAYS; n++) {
            float u[2];
            numbers(n, u);
            add_reflection(&facets, round, v, u, sums[i]);
        }
        k[i] = 1;
    }
    for (int turn = 0; turn < 60; turn++) {
        static float next[STRETCHED_DIRECTIONS];
        for (int i = 0; i < STRETCHED_DIRECTIONS; i++) {
            double sum = 0;
            for (int n = 0; n < STRETCHED_DIRECTIONS; n++) sum += sums[i][n] * (double)k[n];
            next[i] = sum > 0 ? (float)sqrt((double)k[i] / sum) : k[i];
        }
        for (int i = 0; i < STRETCHED_DIRECTIONS; i++) k[i] = next[i];
    }
}

static void write_floats(FILE *out, const char *declaration, const float *values, size_t n)
{
    fprintf(out, "\nconst %s = {\n", declaration);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%af,%s", (double)values[i],
                (i + 1) % LAYERED_ANGLES ? "" : "\n"); /* exact, whatever reads them */
    fputs("};\n", out);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fputs("usage: layered_gen FILE\n", stderr);
        return 2;
    }
    for (int i = 0; i < LAYERED_FUZZ; i++)
        for (int k = 0; k < LAYERED_ANGLES; k++) {
            float root = (float)k / (LAYERED_ANGLES - 1);
            fuzz[i][k] = sum_fuzz(layered_fuzz_exponent((float)i / (LAYERED_FUZZ - 1)), root * root);
        }
    for (int i = 0; i < LAYERED_MIRRORS; i++) {
        float r = (float)i / (LAYERED_MIRRORS - 1);
        look_at_mirrors(fmaxf(r * r, 1.01f * MICROFACET_SMOOTH_ALPHA));
        solve_layers(mirrors[i], layered_quarters(i));
        solve_fuzz(fuzz_mirrors[i], 0);
    }
    for (int i = 0; i < LAYERED_DIFFUSES; i++) {
        look_at_diffuse((float)i / (LAYERED_DIFFUSES - 1));
        solve_layers(diffuses[i], 2);
        solve_fuzz(fuzz_diffuses[i], 2);
    }
    for (int i = 0; i < STRETCHED_ROUGHNESSES; i++)
        for (int k = 0; k < STRETCHED_RATIOS; k++) solve_stretched(i, k);
    FILE *out = fopen(argv[1], "w");
    if (!out) {
        perror(argv[1]);
        return 1;
    }
    fputs("/* Made by layered_gen; see optics/layered.h. */\n#include \"optics/layered.h\"\n"
          "#pragma GCC diagnostic ignored \"-Wmissing-braces\"\n",
          out);
    write_floats(out, "LayeredTable layered_under_mirror[LAYERED_MIRRORS]", &mirrors[0][0][0][0][0],
                 sizeof mirrors / sizeof(float));
    write_floats(out, "LayeredTable layered_under_diffuse[LAYERED_DIFFUSES]", &diffuses[0][0][0][0][0],
                 sizeof diffuses / sizeof(float));
    write_floats(out, "LayeredFuzzTable layered_fuzz_mirror[LAYERED_MIRRORS]", &fuzz_mirrors[0][0][0][0],
                 sizeof fuzz_mirrors / sizeof(float));
    write_floats(out, "LayeredFuzzTable layered_fuzz_diffuse[LAYERED_DIFFUSES]", &fuzz_diffuses[0][0][0][0],
                 sizeof fuzz_diffuses / sizeof(float));
    write_floats(out, "float layered_fuzz_albedo[LAYERED_FUZZ][LAYERED_ANGLES]", &fuzz[0][0],
                 sizeof fuzz / sizeof(float));
    write_floats(
        out, "float stretched_mirror[STRETCHED_ROUGHNESSES][STRETCHED_RATIOS][STRETCHED_AZIMUTHS][STRETCHED_ANGLES]",
        &stretched[0][0][0][0], sizeof stretched / sizeof(float));
    int failed = ferror(out);
    if (fclose(out) != 0 || failed) {
        fprintf(stderr, "layered_gen: cannot write %s\n", argv[1]);
        return 1;
    }
    return 0;
}

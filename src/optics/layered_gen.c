/* layered_gen.c - solves the tables of layered.h and writes them as C source, at build time.
 *     layered_gen FILE
 * What a surface makes of light from a direction is noted once, as light that goes to places between angles, for many
 * directions; what a layer makes of that is then a sum over them. Takes some seconds.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>

#include "optics/bsdf_lobe.h"
#include "optics/fresnel.h"
#include "optics/layered.h"
#include "optics/table_writer.h"

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
static LayeredReturnTable returns[LAYERED_RETURN_ROUGHNESSES];
static float fuzz[LAYERED_FUZZ][LAYERED_ANGLES];
static LayeredFuzzTable fuzz_mirrors[LAYERED_MIRRORS], fuzz_diffuses[LAYERED_DIFFUSES];
static LayeredSkinTable skins;

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

/* Where a direction is in a row of mirrors; critical 0: on the side of the smaller index. */
static float angle_of(float z, float alpha, float critical)
{
    float s = microfacet_slope(alpha, alpha, direction_of(z));
    return critical > 0 ? microfacet_angle_within(z, s, critical, alpha) : microfacet_angle(z, s);
}

/* White facets, with what microfacet_mirror puts back. */
static void look_at_mirrors(float alpha, float critical)
{
    BsdfFacets facets = facets_make(alpha, alpha);
    MicrofacetPlace roughness = microfacet_index(alpha, alpha, lanes_all(1)).roughness;
    for (int i = 0; i < LAYERED_ANGLES; i++) {
        float low = 0, high = 1, wanted = (float)i / (LAYERED_ANGLES - 1);
        for (int k = 0; k < 40; k++) {
            float middle = 0.5f * (low + high);
            *(angle_of(middle, alpha, critical) < wanted ? &low : &high) = middle;
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
            ways[i][k] = way_to(angle_of(light.z, alpha, critical), r.shadowing * scaling / WAYS, light.z);
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
    float blur;             /* alpha of what is under the layer */
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

/* What u is the factor of: T over about what the rest of the equation comes to (layered.h). */
static double divisor(const Cover *cover, float cosine, int quarters, double mean)
{
    float soft = cosine;
    const MicrofacetIndex *index =
        cover->layer ? facets_round_index(&cover->layer->facets, &cover->layer->index) : NULL;
    if (index && index->any_dense) soft = fminf(microfacet_softened(cosine, index->critical, cover->blur), 1);
    return pow((double)passed(cover, soft), 0.5 - 0.25 * quarters) * pow(mean, 0.25 * quarters);
}

/* u at the knots: with g = T over the divisor, u g K g u = T. */
static void solve(const Cover *cover, int quarters, float u[LAYERED_ANGLES])
{
    static double sums[LAYERED_ANGLES][LAYERED_ANGLES];
    double wanted[LAYERED_ANGLES], mean = 0;
    for (int k = 0; k < WAYS; k++) mean += (double)passed(cover, sqrtf(((float)k + 0.5f) / WAYS)) / WAYS;
    for (int i = 0; i < LAYERED_ANGLES; i++) {
        double white = 0;
        for (int k = 0; k < LAYERED_ANGLES; k++) sums[i][k] = 0;
        for (int k = 0; k < WAYS; k++) {
            const Way *way = &ways[i][k];
            double out = (double)passed(cover, way->cosine);
            double weight = out > 0 ? (double)way->weight * out / divisor(cover, way->cosine, quarters, mean) : 0;
            white += (double)way->weight;
            sums[i][way->knot] += weight * (1 - (double)way->fraction);
            sums[i][way->knot + 1] += weight * (double)way->fraction;
        }
        /* the sum over directions is not exact: of what it has of white */
        wanted[i] = divisor(cover, cosines[i], quarters, mean) * white;
        u[i] = 1;
    }
    for (int round = 0; round < ROUNDS; round++) {
        float next[LAYERED_ANGLES];
        for (int i = 0; i < LAYERED_ANGLES; i++) {
            double sum = 0;
            for (int k = 0; k < LAYERED_ANGLES; k++) sum += sums[i][k] * (double)u[k];
            /* where next to nothing passes u says next to nothing, and must not be large */
            next[i] = sum > 0 ? fminf(fmaxf((float)sqrt((double)u[i] * wanted[i] / sum), 0.3f), 3) : u[i];
        }
        for (int i = 0; i < LAYERED_ANGLES; i++) u[i] = next[i];
    }
}

static float index_of(int knot)
{
    return microfacet_index_at((float)knot / (LAYERED_INDICES - 1));
}

static void solve_layer(LayeredTable table, int side, int index, float blur, int quarters)
{
    float eta = side ? 1 / index_of(index) : index_of(index);
    for (int rough = 0; rough < LAYERED_ROUGHNESSES; rough++) {
        float r = (float)rough / (LAYERED_ROUGHNESSES - 1);
        BsdfLayer layer;
        layer_make(lanes_all(eta), r * r, r * r, lanes_all(1), NULL, &layer);
        solve(&(Cover){.layer = &layer, .blur = blur}, quarters, table[rough][side][index]);
    }
}

/* ---- what comes back to facets ---- */

/* What white facets get back at first, from each knot; and at all later times together, if each is alike, as what facets say that
 * reflect `mean` each time. */
static void solve_returns_at_knots(float eta, double first[LAYERED_ANGLES], double later[LAYERED_ANGLES])
{
    static double again[LAYERED_ANGLES][LAYERED_ANGLES];
    const double mean = 0.8;
    double out[LAYERED_ANGLES], sent[LAYERED_ANGLES];
    for (int i = 0; i < LAYERED_ANGLES; i++) {
        double white = 0;
        first[i] = 0, sent[i] = mean;
        for (int k = 0; k < LAYERED_ANGLES; k++) again[i][k] = 0;
        for (int k = 0; k < WAYS; k++) {
            const Way *way = &ways[i][k];
            double back = (double)way->weight * (double)fresnel_dielectric(way->cosine, eta, 1);
            white += (double)way->weight;
            first[i] += back;
            again[i][way->knot] += back * (1 - (double)way->fraction);
            again[i][way->knot + 1] += back * (double)way->fraction;
        }
        first[i] /= white;
        out[i] = 1 - first[i];
        for (int k = 0; k < LAYERED_ANGLES; k++) again[i][k] /= white;
    }
    for (int round = 0; round < ROUNDS; round++)
        for (int i = 0; i < LAYERED_ANGLES; i++) {
            double sum = out[i];
            for (int k = 0; k < LAYERED_ANGLES; k++) sum += again[i][k] * sent[k];
            sent[i] = mean * sum;
        }
    for (int i = 0; i < LAYERED_ANGLES; i++) {
        double y = (sent[i] / mean - out[i]) / (first[i] * mean); /* (1 - b) / (1 - b m) */
        later[i] = fmin(fmax((1 - y) / (1 - y * mean), 0), 1);
    }
}

/* look_at_mirrors has been for that alpha. */
static void solve_returns(float alpha, int index, LayeredReturnTable table)
{
    double knots[2][LAYERED_ANGLES];
    const float eta = index_of(index);
    solve_returns_at_knots(eta, knots[0], knots[1]);
    for (int k = 0; k < LAYERED_RETURN_ANGLES; k++) {
        float outside = fmaxf((float)k / (LAYERED_RETURN_ANGLES - 1), 1e-3f);
        float inside = sqrtf(1 - (1 - outside * outside) / (eta * eta));
        MicrofacetPlace place = microfacet_place(angle_of(inside, alpha, 0), LAYERED_ANGLES);
        for (int time = 0; time < 2; time++) {
            const double *row = knots[time];
            double at = row[place.knot] + (row[place.knot + 1] - row[place.knot]) * (double)place.fraction;
            table[index][k][time] = (float)fmax(at - (double)fresnel_dielectric(outside, 1, eta), 0);
        }
    }
}

static void solve_fuzz(LayeredFuzzTable table, int quarters)
{
    for (int i = 0; i < LAYERED_FUZZ; i++)
        for (int k = 0; k < LAYERED_SHARES; k++)
            solve(&(Cover){.fuzz = i, .share = (float)k / (LAYERED_SHARES - 1)}, quarters, table[i][k]);
}

/* ---- a layer's reflection under fuzz ---- */

/* u of mirrors of a roughness under fuzz, at an angle. */
static float fuzz_to_facets(MicrofacetPlace base, MicrofacetPlace roughness, int share, float angle)
{
    MicrofacetPlace place = microfacet_place(angle, LAYERED_ANGLES);
    float sum = 0;
    for (int i = 0; i < 4; i++) {
        const float *row = fuzz_mirrors[base.knot + (i & 1)][roughness.knot + (i >> 1)][share];
        sum += (i & 1 ? base.fraction : 1 - base.fraction) * (i & 2 ? roughness.fraction : 1 - roughness.fraction) *
               (row[place.knot] + (row[place.knot + 1] - row[place.knot]) * place.fraction);
    }
    return sum;
}

static float fuzz_passed(MicrofacetPlace roughness, float share, float cosine)
{
    Cover near = {.fuzz = roughness.knot, .share = share}, far = {.fuzz = roughness.knot + 1, .share = share};
    float first = passed(&near, cosine);
    return first + (passed(&far, cosine) - first) * roughness.fraction;
}

/* One column of the table: all roughnesses of fuzz, and shares. */
static void solve_skin(int row, int side, int index, int angle)
{
    float r = (float)row / (LAYERED_SKIN_ROUGHNESSES - 1), alpha = fmaxf(r * r, 1.01f * MICROFACET_SMOOTH_ALPHA);
    float eta = side ? 1 / index_of(index) : index_of(index), low = 0, high = 1;
    float wanted = (float)angle / (LAYERED_SKIN_ANGLES - 1);
    BsdfFacets facets = facets_make(alpha, alpha);
    MicrofacetPlace base = microfacet_place(sqrtf(alpha), LAYERED_MIRRORS);
    for (int k = 0; k < 40; k++) {
        float middle = 0.5f * (low + high);
        *(angle_of(middle, alpha, 0) < wanted ? &low : &high) = middle;
    }
    Vec3f view = direction_of(fmaxf(angle == LAYERED_SKIN_ANGLES - 1 ? 1 : 0.5f * (low + high), 1e-4f));
    for (int f = 0; f < LAYERED_SKIN_FUZZ; f++)
        for (int k = 0; k < LAYERED_SKIN_SHARES; k++) {
            MicrofacetPlace roughness = microfacet_place((float)f / (LAYERED_SKIN_FUZZ - 1), LAYERED_FUZZ);
            float share = (float)k / (LAYERED_SKIN_SHARES - 1);
            int column = k * (LAYERED_SHARES - 1) / (LAYERED_SKIN_SHARES - 1);
            double all = 0, out = 0;
            for (int n = 0; n < WAYS; n++) {
                float u[2];
                Vec3f light;
                numbers(n, u);
                if (!facets_sample_reflection(&facets, view, u, &light)) continue;
                FacetReflection reflection = facets_reflect(&facets, view, light);
                double weight = (double)(reflection.shadowing * fresnel_dielectric(reflection.cosine, 1, eta));
                all += weight;
                out += weight * (double)(fuzz_to_facets(base, roughness, column, reflection.angle_l) *
                                         sqrtf(fuzz_passed(roughness, share, light.z)));
            }
            float at_view = fuzz_to_facets(base, roughness, column, wanted);
            skins[f][k][row][side][index][angle] =
                all > 0 ? at_view * (float)(out / all) / sqrtf(fuzz_passed(roughness, share, view.z)) : 1;
        }
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
        float alpha = fmaxf(r * r, 1.01f * MICROFACET_SMOOTH_ALPHA);
        for (int k = 0; k < LAYERED_INDICES; k++) {
            look_at_mirrors(alpha, microfacet_critical(1 / index_of(k)));
            solve_layer(mirrors[i], 1, k, alpha, layered_quarters(i));
        }
        look_at_mirrors(alpha, 0);
        for (int k = 0; k < LAYERED_INDICES; k++) solve_layer(mirrors[i], 0, k, alpha, layered_quarters(i));
        solve_fuzz(fuzz_mirrors[i], 0);
    }
    for (int i = 0; i < LAYERED_RETURN_ROUGHNESSES; i++) {
        float r = (float)i / (LAYERED_RETURN_ROUGHNESSES - 1), alpha = fmaxf(r * r, 1.01f * MICROFACET_SMOOTH_ALPHA);
        look_at_mirrors(alpha, 0);
        /* between equal indices nothing comes back */
        for (int k = 1; k < LAYERED_INDICES; k++) solve_returns(alpha, k, returns[i]);
    }
    for (int i = 0; i < LAYERED_DIFFUSES; i++) {
        look_at_diffuse((float)i / (LAYERED_DIFFUSES - 1));
        for (int k = 0; k < 2 * LAYERED_INDICES; k++) solve_layer(diffuses[i], k % 2, k / 2, 1, 2);
        solve_fuzz(fuzz_diffuses[i], 2);
    }
    for (int i = 0; i < LAYERED_SKIN_ROUGHNESSES; i++)
        for (int k = 0; k < 2 * LAYERED_INDICES; k++)
            for (int n = 0; n < LAYERED_SKIN_ANGLES; n++) solve_skin(i, k % 2, k / 2, n);
    FILE *out = fopen(argv[1], "w");
    if (!out) {
        perror(argv[1]);
        return 1;
    }
    fputs("/* Made by layered_gen; see optics/layered.h. */\n#include \"optics/layered.h\"\n"
          "#pragma GCC diagnostic ignored \"-Wmissing-braces\"\n",
          out);
    table_write_floats(out, "LayeredTable layered_under_mirror[LAYERED_MIRRORS]", &mirrors[0][0][0][0][0],
                       sizeof mirrors / sizeof(float), LAYERED_ANGLES);
    table_write_floats(out, "LayeredTable layered_under_diffuse[LAYERED_DIFFUSES]", &diffuses[0][0][0][0][0],
                       sizeof diffuses / sizeof(float), LAYERED_ANGLES);
    table_write_floats(out, "LayeredFuzzTable layered_fuzz_mirror[LAYERED_MIRRORS]", &fuzz_mirrors[0][0][0][0],
                       sizeof fuzz_mirrors / sizeof(float), LAYERED_ANGLES);
    table_write_floats(out, "LayeredFuzzTable layered_fuzz_diffuse[LAYERED_DIFFUSES]", &fuzz_diffuses[0][0][0][0],
                       sizeof fuzz_diffuses / sizeof(float), LAYERED_ANGLES);
    table_write_floats(out, "LayeredSkinTable layered_fuzz_skin", &skins[0][0][0][0][0][0],
                       sizeof skins / sizeof(float), LAYERED_ANGLES);
    table_write_floats(out, "LayeredReturnTable layered_return[LAYERED_RETURN_ROUGHNESSES]", &returns[0][0][0][0],
                       sizeof returns / sizeof(float), 2 * LAYERED_RETURN_ANGLES);
    table_write_floats(out, "float layered_fuzz_albedo[LAYERED_FUZZ][LAYERED_ANGLES]", &fuzz[0][0],
                       sizeof fuzz / sizeof(float), LAYERED_ANGLES);
    return table_close(out, "layered_gen", argv[1]);
}

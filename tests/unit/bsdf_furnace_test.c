/* bsdf_furnace_test.c - what a surface makes of light that is the same from everywhere: all of it comes back, where
 * nothing absorbs. The mean weight of samples at stratified points, with the standard error of its blocks.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "bsdf_cases.h"
#include "optics/balance.h"

typedef struct Furnace {
    double albedo, error;
} Furnace;

/* n blocks of side * side strata, each with its own shift */
static Furnace furnace(const Bsdf *bsdf, float cosine, float angle, int side)
{
    enum { BLOCKS = 8 };
    double sum = 0, squares = 0;
    uint32_t state = 77;
    Vec3f view = direction_at(cosine, angle);
    for (int block = 0; block < BLOCKS; block++) {
        float shift = random_unit(&state);
        double part = 0;
        for (int i = 0; i < side * side; i++) {
            float u[2] = {((float)(i % side) + random_unit(&state)) / (float)side,
                          ((float)(i / side) + random_unit(&state)) / (float)side};
            float u_choice = shift + (float)((i * 89) % (side * side)) / (float)(side * side);
            BsdfSample sample;
            if (bsdf_sample(bsdf, view, u_choice < 1 ? u_choice : u_choice - 1, u, &sample))
                part += (double)lanes_get(sample.weight, 0) / (side * side);
        }
        sum += part / BLOCKS;
        squares += part * part / BLOCKS;
    }
    return (Furnace){sum, sqrt(fmax(0, squares - sum * sum) / (BLOCKS - 1))};
}

static const float cosines[] = {1, 0.9f, 0.7f, 0.45f, 0.25f, 0.1f, 0.03f};
enum { COSINES = sizeof cosines / sizeof *cosines };

/* Prints the albedo nearest to nothing lost, and returns the largest departure from 1 up to about 85 degrees;
 * at_grazing: beyond. */
static double departure(const Bsdf *bsdf, int side, double *at_grazing)
{
    double worst = 0, grazing = 0;
    for (int i = 0; i < COSINES; i++) {
        Furnace found = furnace(bsdf, cosines[i], 0.3f, side);
        double off = fmax(0, fabs(found.albedo - 1) - 2 * found.error);
        if (cosines[i] > 0.09f)
            worst = fmax(worst, off);
        else
            grazing = fmax(grazing, off);
    }
    *at_grazing = fmax(*at_grazing, grazing);
    return worst;
}

static void boundaries_keep_all_light(void **unused)
{
    (void)unused;
    const float indices[] = {1.01f, 1.03f, 1.1f, 1.33f, 1.5f, 1.77f, 2.42f, 2.5f};
    const float roughnesses[] = {0, 0.05f, 0.1f, 0.2f, 0.3f, 0.45f, 0.6f, 0.8f, 1};
    double worst = 0, grazing = 0;
    printf("largest departure from 1 down to cosine 0.1, in per mille; roughness");
    for (int k = 0; k < 9; k++) printf(" %5g", (double)roughnesses[k]);
    for (int inside = 0; inside <= 1; inside++)
        for (int i = 0; i < 8; i++) {
            printf("\n%28s of index %.2f:", inside ? "from inside" : "from outside", (double)indices[i]);
            for (int k = 0; k < 9; k++) {
                Bsdf bsdf;
                bsdf_begin(&bsdf);
                Lanes air = lanes_all(1), glass = lanes_all(indices[i]);
                float alpha = roughnesses[k] * roughnesses[k];
                bsdf_add_boundary(&bsdf, 1, inside ? glass : air, inside ? air : glass, alpha, alpha, NULL);
                double off = departure(&bsdf, 32, &grazing);
                printf(" %5.1f", off * 1000);
                worst = fmax(worst, off);
            }
        }
    printf("\nlargest %.4f, at cosine 0.03: %.4f\n", worst, grazing);
    assert_true(worst < 0.004);
    assert_true(grazing < 0.0065);
}

static void white_surfaces_stay_white(void **unused)
{
    (void)unused;
    const float roughnesses[] = {0, 0.1f, 0.25f, 0.5f, 0.75f, 1};
    const char *const names[] = {"white metal",         "white, rough diffuse", "white plastic 1.5",
                                 "white plastic 1.128", "white plastic 2.4",    "white plastic 0.9",
                                 "clear sheet 1.5",     "coated white",         "coated white metal"};
    double worst[9] = {0}, grazing[9] = {0};
    printf("largest departure from 1 down to cosine 0.1, in per mille; roughness");
    for (int k = 0; k < 6; k++) printf(" %5g", (double)roughnesses[k]);
    for (int i = 0; i < 9; i++) {
        printf("\n%45s:", names[i]);
        for (int k = 0; k < 6; k++) {
            Bsdf bsdf;
            Lanes white = lanes_all(1), mirror = lanes_all(1e4f);
            float r = roughnesses[k], alpha = r * r;
            const float eta[] = {1.5f, 1.128f, 2.4f, 0.9f};
            bsdf_begin(&bsdf);
            if (i == 7) bsdf_begin_coat(&bsdf, lanes_all(1.5f), alpha, alpha, white);
            if (i == 8) bsdf_begin_coat(&bsdf, lanes_all(1.5f), 0.01f, 0.01f, white);
            if (i == 0 || i == 8) bsdf_add_conductor(&bsdf, 1, white, mirror, alpha, alpha, NULL);
            if (i == 1) bsdf_add_diffuse(&bsdf, 1, white, r);
            if (i >= 2 && i < 6) bsdf_add_plastic(&bsdf, 1, lanes_all(eta[i - 2]), alpha, alpha, white, white, 0);
            if (i == 6) bsdf_add_sheet(&bsdf, 1, lanes_all(1.5f), alpha, alpha, white, NULL);
            if (i == 7) bsdf_add_diffuse(&bsdf, 1, white, 0);
            bsdf_end_coat(&bsdf);
            double off = departure(&bsdf, 48, &grazing[i]);
            worst[i] = fmax(worst[i], off);
            printf(" %5.1f", off * 1000);
        }
        printf("  (%5.1f at cosine 0.03)", grazing[i] * 1000);
    }
    printf("\n");
    for (int i = 0; i < 9; i++) assert_true(worst[i] < 0.005);
}

/* A skin of a smaller index than what is in front of it, as of plastic of index 1.1 in water: looked at closely about
 * the critical angle, where it begins to reflect all. */
static void low_skins_stay_white(void **unused)
{
    (void)unused;
    const float indices[] = {0.6f, 1.1f / 1.33f, 0.9f, 0.97f}, roughnesses[] = {0.06f, 0.1f, 0.14f, 0.2f, 0.35f, 0.7f};
    double worst = 0;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 6; k++)
            for (int at = -4; at <= 4; at++) {
                Bsdf bsdf;
                float alpha = roughnesses[k] * roughnesses[k], critical = sqrtf(1 - indices[i] * indices[i]);
                bsdf_begin(&bsdf);
                bsdf_add_plastic(&bsdf, 1, lanes_all(indices[i]), alpha, alpha, lanes_all(1), lanes_all(1), 0);
                Furnace found = furnace(&bsdf, critical + 0.015f * (float)at, 0.3f, 48);
                double off = fmax(0, fabs(found.albedo - 1) - 2 * found.error);
                worst = fmax(worst, off);
            }
    printf("skins of a smaller index: off by at most %.4f about the critical angle\n", worst);
    assert_true(worst < 0.006);
}

static const float some_roughnesses[] = {0.1f, 0.25f, 0.5f, 1};

/* What is under a coat: facets that reflect all, and EON. */
static void coats_keep_all_light(void **unused)
{
    (void)unused;
    const float indices[] = {1.1f, 1.5f, 2.4f}, coats[] = {0, 0.1f, 0.4f, 0.8f};
    double worst[2] = {0}, grazing = 0;
    for (int base = 0; base < 2; base++)
        for (int i = 0; i < 3; i++)
            for (int c = 0; c < 4; c++)
                for (int k = 0; k < 4; k++) {
                    float r = some_roughnesses[k], alpha = r * r, coat = coats[c] * coats[c];
                    Bsdf bsdf;
                    bsdf_begin(&bsdf);
                    bsdf_begin_coat(&bsdf, lanes_all(indices[i]), coat, coat, lanes_all(1));
                    if (base == 0)
                        bsdf_add_mirrors(&bsdf, 1, alpha, alpha);
                    else
                        bsdf_add_diffuse(&bsdf, 1, lanes_all(1), r);
                    bsdf_end_coat(&bsdf);
                    worst[base] = fmax(worst[base], departure(&bsdf, 32, &grazing));
                }
    printf("under coats: facets off by at most %.4f, matte surfaces %.4f, at cosine 0.03 %.4f\n", worst[0], worst[1],
           grazing);
    assert_true(worst[0] < 0.004);
    assert_true(worst[1] < 0.004);
    assert_true(grazing < 0.005);
}

/* White fuzz on what is white. */
static void fuzz_keeps_all_light(void **unused)
{
    (void)unused;
    const float fuzzes[] = {0, 0.4f, 1};
    const char *const names[] = {"matte", "metal", "plastic", "coated", "translucent"};
    for (int base = 0; base < 5; base++) {
        double worst = 0, grazing = 0;
        for (int f = 0; f < 3; f++)
            for (int k = 0; k < 4; k++) {
                Lanes white = lanes_all(1);
                float r = some_roughnesses[k], alpha = r * r;
                Bsdf bsdf;
                bsdf_begin(&bsdf);
                if (base == 0) bsdf_add_diffuse(&bsdf, 1, white, r);
                if (base == 1) bsdf_add_mirrors(&bsdf, 1, alpha, alpha);
                if (base == 2) bsdf_add_plastic(&bsdf, 1, lanes_all(1.5f), alpha, alpha, white, white, 0.3f);
                if (base == 3) bsdf_begin_coat(&bsdf, lanes_all(1.5f), alpha, alpha, white);
                if (base == 3) bsdf_add_diffuse(&bsdf, 1, white, 0);
                bsdf_end_coat(&bsdf);
                if (base == 4) bsdf_add_translucent(&bsdf, 1, white);
                bsdf_set_fuzz(&bsdf, 0.5f + 0.5f * (float)(k % 2), white, fuzzes[f]);
                worst = fmax(worst, departure(&bsdf, 40, &grazing));
            }
        printf("fuzz on what is %s: off by at most %.4f, at cosine 0.03 %.4f\n", names[base], worst, grazing);
        assert_true(worst < 0.003);
        assert_true(grazing < 0.003);
    }
}

/* With what is kept of it in scenes: the balance, if any, or else layers, of the last surface that was made. *balance is to be
 * freed. */
static void make_balanced(const BsdfSpec *spec, float eta_i, float eta_t, Bsdf *bsdf, Balance **balance)
{
    *balance = NULL;
    if (balance_is_wanted(spec, eta_i, eta_t)) assert_int_equal(balance_new(spec, eta_i, eta_t, balance), STATUS_OK);
    static KeptLayer skin, coat;
    BsdfKept kept = {.balance = *balance, .inner = -1};
    LayerLook look;
    if (!*balance && bsdf_skin_look(spec, eta_i, &look)) {
        kept_layer_make(&look, &skin);
        kept.skin = &skin.layer;
    }
    if (!*balance && bsdf_coat_look(spec, eta_i, &look)) {
        kept_layer_make(&look, &coat);
        kept.coat = &coat.layer;
    }
    bsdf_from_spec(spec, lanes(500, 550, 600, 650), lanes_all(eta_i), lanes_all(eta_t), &kept, bsdf);
}

/* What a scene can say of one surface, all of it white, in three media, from both sides of what is clear: stretched, under
 * stretched coats and fuzz, denser than its medium or not. The worst are listed. */
static void white_mixtures_stay_white(void **unused)
{
    (void)unused;
    enum { SURFACES = 400, SHOWN = 5 };
    uint32_t state = 40;
    double sum = 0, away = 0, error = 0;
    int n_balanced = 0;
    struct {
        double off, error, cosine;
        float medium;
        BsdfSpec spec;
    } worst[SHOWN] = {{0}};
    for (int i = 0; i < SURFACES; i++) {
        BsdfSpec spec;
        Bsdf bsdf;
        Balance *balance;
        float medium = 1 + 0.33f * (float)(i % 3);
        spec_at_random(&state, i, true, &spec);
        float behind = spec.thin_walled ? medium : 1.1f + 1.5f * random_unit(&state);
        make_balanced(&spec, medium, behind, &bsdf, &balance);
        n_balanced += balance != NULL;
        float cosine = 0.03f + 0.97f * random_unit(&state);
        Furnace found = furnace(&bsdf, cosine, 6 * random_unit(&state), 32);
        free(balance);
        double off = fmax(0, fabs(found.albedo - 1) - 2 * found.error);
        sum += found.albedo - 1;
        error += found.error / SURFACES;
        away += off / SURFACES;
        for (int k = 0; k < SHOWN; k++) {
            if (off <= worst[k].off) continue;
            for (int n = SHOWN - 1; n > k; n--) worst[n] = worst[n - 1];
            worst[k].off = off;
            worst[k].error = found.error;
            worst[k].cosine = (double)cosine;
            worst[k].medium = medium;
            worst[k].spec = spec;
            break;
        }
    }
    printf("%d white surfaces of all kinds, %d with balances: off by %.5f, in the mean by %+.5f, beyond two standard "
           "errors, which are %.5f in the mean; the worst:\n",
           (int)SURFACES, n_balanced, away, sum / SURFACES, error);
    for (int k = 0; k < SHOWN; k++) {
        printf("  %.4f (standard error %.4f) at cosine %.2f, ", worst[k].off, worst[k].error, worst[k].cosine);
        spec_print(&worst[k].spec, worst[k].medium);
    }
    assert_true(worst[0].off < 0.005);
    assert_true(error < 0.0015);
    assert_true(away < 0.0003);
    assert_true(fabs(sum / SURFACES) < 0.0005);
}

/* Surfaces of stretched facets, of all kinds and seen from all around. */
enum { STRETCHED_KINDS = 12 };
static const char *const stretched_names[STRETCHED_KINDS] = {"metal",
                                                             "sheet",
                                                             "boundary",
                                                             "boundary from inside",
                                                             "skin",
                                                             "skin in a denser medium",
                                                             "skin over EON in a denser medium",
                                                             "coat over what is matte",
                                                             "coat over metal",
                                                             "coat over metal in a denser medium",
                                                             "metal under fuzz",
                                                             "coat and skin under fuzz"};

/* Returns the index of the medium in front. */
static float spec_stretched(int kind, float roughness, float anisotropy, BsdfSpec *spec)
{
    bsdf_spec_init(spec);
    spec->base_color = spectrum_constant(1);
    spec->specular_roughness = roughness;
    spec->specular_roughness_anisotropy = anisotropy;
    spec->coat_roughness = roughness;
    spec->coat_roughness_anisotropy = anisotropy;
    spec->base_metalness = kind == 0 || kind == 8 || kind == 9 || kind == 10 ? 1 : 0;
    spec->transmission_weight = kind >= 1 && kind <= 3 ? 1 : 0;
    spec->thin_walled = kind == 1;
    if (kind == 6) spec->base_diffuse_roughness = 0.6f;
    if (kind == 7) spec->base_diffuse_roughness = 0.5f;
    if (kind >= 7 && kind != 10) spec->coat_weight = kind == 11 ? 0.5f : 1;
    if (kind == 8) spec->specular_roughness = 0.5f; /* under coats of all kinds */
    if (kind == 9) spec->coat_ior = spectrum_constant(1.4f);
    if (kind >= 10) spec->fuzz_weight = 0.7f;
    return kind == 3 ? 1.5f : kind == 5 || kind == 6 ? 1.5f / 0.85f : kind == 9 ? 1.6f : 1;
}

static void stretched_facets(void **unused)
{
    (void)unused;
    const float anisotropies[] = {0.5f, 0.9f}, roughnesses[] = {0.25f, 0.5f, 1};
    for (int kind = 0; kind < STRETCHED_KINDS; kind++) {
        double worst = 0, sum = 0, error = 0;
        bool noisy =
            kind == 3 || kind == 5 || kind == 6 || kind == 9 || kind == 10; /* mostly about the critical angle */
        int n = 0;
        for (int a = 0; a < 2; a++)
            for (int i = 0; i < 3; i++) {
                BsdfSpec spec;
                Bsdf bsdf;
                Balance *balance;
                float medium = spec_stretched(kind, roughnesses[i], anisotropies[a], &spec);
                make_balanced(&spec, medium, kind == 1 ? medium : kind == 3 ? 1 : 1.5f, &bsdf, &balance);
                for (int at = 0; at < COSINES - 1; at++)
                    for (int turn = 0; turn <= 4; turn++, n++) {
                        Furnace found = furnace(&bsdf, cosines[at], 0.3927f * (float)turn, noisy ? 36 : 20);
                        double off = fmax(0, fabs(found.albedo - 1) - 2 * found.error);
                        worst = fmax(worst, off);
                        sum += off;
                        error += found.error;
                    }
                free(balance);
            }
        printf("stretched facets: %-35s off by at most %.4f, in the mean %.5f, beyond two standard errors of %.5f\n",
               stretched_names[kind], worst, sum / n, error / n);
        assert_true(worst < 0.005);
        assert_true(sum / n < 0.001);
        assert_true(error / n < 0.0025);
    }
}

/* Closely about the critical angle, along the azimuths where facets are stretched most: skins, and glass from within. */
static void stretched_edges(void **unused)
{
    (void)unused;
    double worst = 0;
    for (int kind = 0; kind < 2; kind++)
        for (int k = 0; k < 3; k++) {
            BsdfSpec spec;
            Bsdf bsdf;
            Balance *balance;
            const float roughnesses[] = {0.2f, 0.4f, 0.7f};
            bsdf_spec_init(&spec);
            spec.base_color = spectrum_constant(1);
            spec.specular_roughness = roughnesses[k];
            spec.specular_roughness_anisotropy = 0.95f;
            spec.specular_ior = spectrum_constant(1.38f);
            spec.transmission_weight = (float)kind;
            make_balanced(&spec, 1.66f, 1.38f, &bsdf, &balance);
            float critical = sqrtf(1 - (1.38f / 1.66f) * (1.38f / 1.66f));
            for (int turn = 0; turn <= 3; turn++)
                for (int at = -5; at <= 5; at++) {
                    float cosine = critical + 0.02f * (float)at;
                    Furnace found = furnace(&bsdf, cosine, 0.5236f * (float)turn, 40);
                    double off = fmax(0, fabs(found.albedo - 1) - 2 * found.error);
                    if (off > 0.004)
                        printf("  %s, roughness %g, cosine %.3f, turned by %d: %.4f (%.4f)\n", kind ? "glass" : "skin",
                               (double)roughnesses[k], (double)cosine, 30 * turn, found.albedo, found.error);
                    worst = fmax(worst, off);
                }
            free(balance);
        }
    printf("stretched, about the critical angle: off by at most %.4f\n", worst);
    assert_true(worst < 0.005);
}

/* Near equal indices a stretched boundary is not there, and its two sides agree on how much passes. */
static void stretched_boundaries_agree(void **unused)
{
    (void)unused;
    Bsdf round, stretched;
    for (int i = 0; i < 40; i++) {
        float z = 0.05f + 0.95f * (float)i / 39, eta = 1 + 0.04f * (float)(i % 10 + 1);
        bsdf_begin(&round);
        bsdf_add_boundary(&round, 1, lanes_all(1), lanes_all(eta), 0.25f, 0.25f, NULL);
        bsdf_begin(&stretched);
        bsdf_add_boundary(&stretched, 1, lanes_all(1), lanes_all(eta), 0.25f, 0.2499f, NULL);
        Vec3f view = direction_at(z, 1), light = direction_at(0.7f, 2);
        for (int side = 0; side < 2; side++, light.z = -light.z) {
            Lanes f, g, pdf;
            bsdf_evaluate(&round, view, light, &f, &pdf);
            bsdf_evaluate(&stretched, view, light, &g, &pdf);
            assert_true(fabsf(lanes_get(f, 0) - lanes_get(g, 0)) <= 0.02f * lanes_get(f, 0) + 1e-4f);
        }
    }
}

/* Layers on dark bases, and tinted ones, give back less; nothing gives back more. */
static void nothing_is_gained(void **unused)
{
    (void)unused;
    uint32_t state = 12;
    double most = 0;
    for (int i = 0; i < 400; i++) {
        BsdfSpec spec;
        bsdf_spec_init(&spec);
        spec.base_color = spectrum_constant(random_unit(&state) < 0.5f ? 1 : random_unit(&state));
        spec.base_diffuse_roughness = random_unit(&state);
        spec.base_metalness = random_unit(&state) < 0.5f ? 0 : random_unit(&state);
        spec.specular_roughness = random_unit(&state);
        spec.specular_roughness_anisotropy = i % 4 ? 0 : random_unit(&state);
        spec.specular_weight = random_unit(&state);
        spec.transmission_weight = random_unit(&state) < 0.5f ? 0 : random_unit(&state);
        spec.thin_walled = i % 2;
        spec.coat_weight = random_unit(&state) < 0.5f ? 0 : random_unit(&state);
        spec.coat_roughness = random_unit(&state);
        spec.coat_color = spectrum_constant(random_unit(&state));
        Bsdf bsdf;
        Balance *balance;
        make_balanced(&spec, 1, 1.5f, &bsdf, &balance);
        Furnace found = furnace(&bsdf, 0.05f + 0.95f * random_unit(&state), 1, 16);
        free(balance);
        most = fmax(most, found.albedo - 3 * found.error);
    }
    printf("the most that any of 400 surfaces gives back: %.4f\n", most);
    assert_true(most < 1.01);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boundaries_keep_all_light),  cmocka_unit_test(white_surfaces_stay_white),
        cmocka_unit_test(low_skins_stay_white),       cmocka_unit_test(coats_keep_all_light),
        cmocka_unit_test(fuzz_keeps_all_light),       cmocka_unit_test(white_mixtures_stay_white),
        cmocka_unit_test(stretched_facets),           cmocka_unit_test(stretched_edges),
        cmocka_unit_test(stretched_boundaries_agree), cmocka_unit_test(nothing_is_gained),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

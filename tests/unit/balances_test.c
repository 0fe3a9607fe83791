/* balances_test.c - the balances of a scene: one for each surface between each pair of media, whoever asks, and steps of what
 * textures say.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <stddef.h>

#include "base/pool.h"
#include "trace/balances.h"

enum { ROUND, BRUSHED, TEXTURED, BUSY, SURFACES };

typedef struct Fixed {
    SceneMedium media[2];
    SceneSurface surfaces[SURFACES];
    SurfaceTexture one, many[4];
    Scene scene;
    Balances *balances;
} Fixed;

static void make(Fixed *fixed)
{
    *fixed = (Fixed){0};
    fixed->media[0].ior = spectrum_constant(1);
    fixed->media[1].ior = spectrum_constant(1.33f);
    for (int i = 0; i < SURFACES; i++) {
        SceneSurface *surface = &fixed->surfaces[i];
        bsdf_spec_init(&surface->spec);
        surface->finished = true;
        surface->spec.specular_roughness = 0.5f;
        surface->spec.specular_roughness_anisotropy = i == ROUND ? 0 : 0.7f;
    }
    fixed->one = (SurfaceTexture){.offset = offsetof(BsdfSpec, specular_roughness), .most = 1, .factor = 1};
    fixed->surfaces[TEXTURED].textures = &fixed->one;
    fixed->surfaces[TEXTURED].n_textures = 1;
    for (int i = 0; i < 4; i++) fixed->many[i] = fixed->one;
    fixed->surfaces[BUSY].textures = fixed->many;
    fixed->surfaces[BUSY].n_textures = 4;
    fixed->scene.media = fixed->media;
    fixed->scene.n_media = 2;
    fixed->scene.surfaces = fixed->surfaces;
    fixed->scene.n_surfaces = SURFACES;
    Error error;
    assert_int_equal(balances_new(&fixed->scene, &fixed->balances, &error), STATUS_OK);
}

static const Balance *ask(Fixed *fixed, int surface, float roughness, uint32_t medium)
{
    BsdfSpec spec = fixed->surfaces[surface].spec;
    spec.specular_roughness = roughness;
    const BalanceCase at = {
        .surface = &fixed->surfaces[surface], .spec = &spec, .medium_from = medium, .medium_to = medium};
    const BsdfKept *kept = balances_find(fixed->balances, &at);
    return kept ? kept->balance : NULL;
}

static void each_is_made_once(void **unused)
{
    (void)unused;
    Fixed fixed;
    make(&fixed);
    const Balance *air = ask(&fixed, BRUSHED, 0.5f, 0), *water = ask(&fixed, BRUSHED, 0.5f, 1);
    assert_non_null(air);
    assert_non_null(water);
    assert_ptr_not_equal(air, water);
    assert_ptr_equal(air, ask(&fixed, BRUSHED, 0.5f, 0));
    assert_ptr_equal(water, ask(&fixed, BRUSHED, 0.5f, 1));
    assert_null(ask(&fixed, ROUND, 0.5f, 0));
    balances_free(fixed.balances);
    balances_free(NULL);
}

static void textures_go_by_steps(void **unused)
{
    (void)unused;
    Fixed fixed;
    make(&fixed);
    const Balance *found = ask(&fixed, TEXTURED, 0.5f, 0);
    assert_non_null(found);
    assert_ptr_equal(found, ask(&fixed, TEXTURED, 0.51f, 0));
    assert_ptr_not_equal(found, ask(&fixed, TEXTURED, 0.56f, 0));
    assert_null(ask(&fixed, BUSY, 0.5f, 0)); /* there would be too many */
    balances_free(fixed.balances);
}

/* Of one that is round the layers are kept: alike ones once; none where a texture says how rough it is, or where the medium's
 * index is not one. */
static void layers_are_kept(void **unused)
{
    (void)unused;
    Fixed fixed;
    make(&fixed);
    fixed.surfaces[BRUSHED].spec = fixed.surfaces[ROUND].spec;
    fixed.surfaces[BRUSHED].spec.coat_weight = 1;
    balances_free(fixed.balances);
    Error error;
    fixed.media[1].ior = spectrum_cauchy(1.32, 0.004, 0);
    assert_int_equal(balances_new(&fixed.scene, &fixed.balances, &error), STATUS_OK);
    BalanceCase at = {.surface = &fixed.surfaces[ROUND], .spec = &fixed.surfaces[ROUND].spec};
    const BsdfKept *bare = balances_find(fixed.balances, &at);
    assert_true(bare && bare->skin && !bare->coat && !bare->balance);
    assert_non_null(bare->skin->reflectances);
    at.surface = &fixed.surfaces[BRUSHED];
    at.spec = &at.surface->spec;
    const BsdfKept *coated = balances_find(fixed.balances, &at);
    assert_true(coated && coated->coat && coated->inner > 0);
    assert_ptr_equal(coated->skin, bare->skin);
    at.medium_from = at.medium_to = 1;
    const BsdfKept *in_water = balances_find(fixed.balances, &at);
    assert_true(!in_water || (!in_water->skin && !in_water->coat));
    at = (BalanceCase){.surface = &fixed.surfaces[BUSY], .spec = &fixed.surfaces[BUSY].spec};
    assert_null(balances_find(fixed.balances, &at));
    balances_free(fixed.balances);
}

/* Of more than a few hundred different ones none are, whoever comes first. */
static void many_layers_are_not_kept(void **unused)
{
    (void)unused;
    enum { MANY = 300 };
    static SceneSurface surfaces[MANY];
    Fixed fixed;
    make(&fixed);
    balances_free(fixed.balances);
    for (int n = 200; n <= MANY; n += 100) {
        for (int i = 0; i < n; i++) {
            surfaces[i] = fixed.surfaces[ROUND];
            surfaces[i].spec.specular_roughness = (float)(i + 1) / MANY;
        }
        fixed.scene.surfaces = surfaces;
        fixed.scene.n_surfaces = (uint32_t)n;
        Error error;
        assert_int_equal(balances_new(&fixed.scene, &fixed.balances, &error), STATUS_OK);
        BalanceCase at = {.surface = &surfaces[7], .spec = &surfaces[7].spec};
        const BsdfKept *kept = balances_find(fixed.balances, &at);
        assert_true((kept && kept->skin) == (n == 200));
        balances_free(fixed.balances);
    }
}

/* What is not to be made here: a boundary without more, whatever the surface says else. */
static void bare_boundaries(void **unused)
{
    (void)unused;
    Fixed fixed;
    make(&fixed);
    BalanceCase at = {.surface = &fixed.surfaces[BRUSHED],
                      .spec = &fixed.surfaces[BRUSHED].spec,
                      .medium_from = 0,
                      .medium_to = 1,
                      .bare = true};
    const Balance *in = balances_find(fixed.balances, &at)->balance;
    assert_non_null(in);
    assert_true(in->boundary && !in->skin);
    at.medium_from = 1;
    at.medium_to = 0;
    const Balance *out = balances_find(fixed.balances, &at)->balance;
    assert_non_null(out);
    assert_memory_equal(&in->boundary_misses[0].grid, &out->boundary_misses[1].grid, sizeof(DirectionGrid));
    balances_free(fixed.balances);
}

typedef struct Asking {
    Fixed *fixed;
    const Balance *found[64];
} Asking;

static void ask_from_thread(void *context, uint32_t i, unsigned worker)
{
    (void)worker;
    Asking *asking = context;
    asking->found[i] = ask(asking->fixed, BRUSHED, 0.5f, i % 2);
}

static void threads_get_the_same(void **unused)
{
    (void)unused;
    Fixed fixed;
    make(&fixed);
    Asking asking = {.fixed = &fixed};
    Pool *pool;
    Error error;
    assert_int_equal(pool_new(4, &pool, &error), STATUS_OK);
    pool_run(pool, 64, ask_from_thread, &asking);
    for (int i = 2; i < 64; i++) assert_ptr_equal(asking.found[i], asking.found[i % 2]);
    assert_non_null(asking.found[0]);
    pool_free(pool);
    balances_free(fixed.balances);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_is_made_once), cmocka_unit_test(textures_go_by_steps),
        cmocka_unit_test(layers_are_kept),   cmocka_unit_test(many_layers_are_not_kept),
        cmocka_unit_test(bare_boundaries),   cmocka_unit_test(threads_get_the_same),
    };
    return cmocka_run_group_tests_name("balances", tests, NULL, NULL);
}

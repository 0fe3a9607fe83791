/* guide_search_test.c - the search for caustics comes to the same bits in one go and in pieces, which are kept as bytes in between;
 * and bytes that cannot be those of a search are refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "scene_fixture.h"
#include "trace/guide_keep.h"

static const char scene_text[] =
    FIXTURE_MEDIA "sphere { center = <0, 12, 0>  radius = 8  interior = glass }\n"
                  "box { interior = glass  from = <-30, 30, -30>  to = <30, 36, 30> }\n"
                  "medium haze { mixes = true  scattering = .004 / 1mm }\n"
                  "box { interior = haze  from = <-30, -1, -30>  to = <30, 28, 30> }\n"
                  "ground { surface = surface { albedo = .5 } } camera { from = <0, 40, 60>  to = <0, 0, 0> }\n"
                  "light { shape = \"sphere\"  from = <20, 90, 0>  radius = .5  radiance = 9000 }\n";

typedef struct Lit {
    Fixture scene;
    World world;
} Lit;

static void lit_make(Lit *lit)
{
    fixture_compile(&lit->scene, scene_text, 1);
    assert_int_equal(world_init(&lit->world, lit->scene.compiled, 0, 100, false, NULL, &lit->scene.error), STATUS_OK);
}

static void lit_clear(Lit *lit)
{
    world_clear(&lit->world);
    fixture_clear(&lit->scene);
}

/* Goes on with a search, for one step where time is over from the start. */
static void go_on(const Lit *lit, GuideSearch *search, unsigned threads, double end_s,
                  const volatile sig_atomic_t *stop)
{
    Pool *pool;
    Error error;
    GuideStats stats;
    GuideSettings settings = {.width = 64,
                              .height = 48,
                              .paths = 1500000,
                              .seed = 3,
                              .dark = 0.1,
                              .always = true,
                              .end_s = end_s,
                              .stop = stop};
    assert_int_equal(pool_new(threads, &pool, &error), STATUS_OK);
    assert_int_equal(guide_search_run(search, &lit->world, &settings, pool, &stats, &error), STATUS_OK);
    assert_int_equal(stats.followed, search->facts.followed);
    pool_free(pool);
}

/* ---- bytes ---- */

typedef struct Kept {
    GuideBytes parts[GUIDE_PARTS];
    int n;
} Kept;

static bool keep_part(void *context, const void *bytes, size_t length)
{
    Kept *kept = context;
    void *copy = malloc(length + 1);
    assert_non_null(copy);
    if (length) memcpy(copy, bytes, length);
    kept->parts[kept->n++] = (GuideBytes){copy, length};
    return true;
}

static void keep(const GuideSearch *search, Kept *kept)
{
    bool written;
    kept->n = 0;
    guide_search_write(search, keep_part, kept, &written);
    assert_true(written);
    assert_int_equal(kept->n, GUIDE_PARTS);
}

/* ---- tests ---- */

static void pieces(void **state)
{
    (void)state;
    Lit lit;
    Error error;
    GuideSearch *whole, *search;
    int n_pieces = 0, n_met[GUIDE_STEP_DONE + 1] = {0};
    lit_make(&lit);
    assert_int_equal(guide_search_new(&whole, &error), STATUS_OK);
    go_on(&lit, whole, 2, 0, NULL);
    assert_true(guide_search_is_done(whole));
    assert_int_equal(guide_search_new(&search, &error), STATUS_OK);
    assert_false(guide_search_is_begun(search));
    while (!guide_search_is_done(search)) {
        Kept kept;
        go_on(&lit, search, 1 + (unsigned)n_pieces % 2, 1e-9, NULL);
        assert_true(guide_search_is_begun(search));
        n_met[search->facts.step]++;
        n_pieces++;
        assert_true(n_pieces < 1000);
        keep(search, &kept);
        guide_search_free(search);
        assert_true(guide_search_read(kept.parts, &search));
    }
    const Guide *a = guide_search_result(whole), *b = guide_search_result(search);
    printf("    %u photons, %u cells: in %d pieces, %d and %d of them amid a round\n", search->facts.followed,
           b->n_cells, n_pieces, n_met[GUIDE_STEP_FOLLOW], n_met[GUIDE_STEP_LEARN]);
    for (int i = GUIDE_STEP_PLAN; i <= GUIDE_STEP_DONE; i++) assert_true(n_met[i] > 0);
    assert_memory_equal(&whole->facts, &search->facts, sizeof whole->facts);
    assert_int_equal(a->n_nodes, b->n_nodes);
    assert_int_equal(a->n_cells, b->n_cells);
    assert_int_equal(a->n_fours, b->n_fours);
    assert_int_equal(a->n_lobes, b->n_lobes);
    assert_true(a->threshold == b->threshold);
    assert_true(a->bright > 0 && a->bright == b->bright);
    assert_memory_equal(a->nodes, b->nodes, a->n_nodes * sizeof *a->nodes);
    /* looks are left out by it before it is known of which cell they are */
    for (uint32_t i = 0; i < a->n_cells; i++)
        assert_true(a->cells[i].scattered == 0 || a->cells[i].looks <= guide_most_looks(a));
    assert_memory_equal(a->cells, b->cells, a->n_cells * sizeof *a->cells);
    assert_memory_equal(a->fours, b->fours, a->n_fours * sizeof *a->fours);
    guide_search_free(whole);
    guide_search_free(search);
    lit_clear(&lit);
}

/* A signal comes while nothing is there yet, or amid a round, of which then no half photon is left. */
static void stops(void **state)
{
    (void)state;
    Lit lit;
    Error error;
    GuideSearch *search;
    volatile sig_atomic_t stop = 1;
    lit_make(&lit);
    assert_int_equal(guide_search_new(&search, &error), STATUS_OK);
    go_on(&lit, search, 2, 0, &stop);
    assert_false(guide_search_is_begun(search));
    while (search->facts.step != GUIDE_STEP_FOLLOW) go_on(&lit, search, 2, 1e-9, NULL);
    GuideFacts before = search->facts;
    go_on(&lit, search, 2, 0, &stop);
    assert_memory_equal(&before, &search->facts, sizeof before);
    guide_search_free(search);
    lit_clear(&lit);
}

/* Changes a number of a part; the search is refused. */
static void is_refused(const GuideSearch *search, int part, size_t offset, uint32_t value)
{
    Kept kept;
    GuideSearch *read;
    keep(search, &kept);
    assert_true(offset + sizeof value <= kept.parts[part].length);
    memcpy((char *)kept.parts[part].bytes + offset, &value, sizeof value);
    assert_false(guide_search_read(kept.parts, &read));
    assert_null(read);
    for (int i = 0; i < GUIDE_PARTS; i++) assert_null(kept.parts[i].bytes);
}

static void damage(void **state)
{
    (void)state;
    enum { FACTS, LANDED, COUNTS, NODES, CELLS, FOURS, BEGINS };
    Lit lit;
    Error error;
    GuideSearch *search;
    lit_make(&lit);
    assert_int_equal(guide_search_new(&search, &error), STATUS_OK);
    while (search->facts.step != GUIDE_STEP_FOLLOW) go_on(&lit, search, 2, 1e-9, NULL);
    assert_true(search->guide->n_nodes > 2);
    is_refused(search, FACTS, 0, GUIDE_STEP_BEGIN);
    is_refused(search, FACTS, 0, GUIDE_STEP_DONE + 1);
    is_refused(search, FACTS, offsetof(GuideFacts, followed), GUIDE_MOST_PHOTONS + 1);
    is_refused(search, FACTS, offsetof(GuideFacts, n), 5);
    is_refused(search, FACTS, offsetof(GuideFacts, round_end), 1);
    for (size_t i = 0; i < 6; i++) is_refused(search, COUNTS, i == 2 ? 0 : 4 * i, 1);
    is_refused(search, NODES, offsetof(GuideNode, axis), GUIDE_LEAF + 1);
    is_refused(search, NODES, sizeof(GuideNode) + offsetof(GuideNode, axis), GUIDE_KIND); /* not the root */
    is_refused(search, NODES, offsetof(GuideNode, first), 0);
    is_refused(search, NODES, offsetof(GuideNode, first), search->guide->n_nodes - 1);
    is_refused(search, CELLS, offsetof(GuideCell, first_four), search->guide->n_fours);
    is_refused(search, CELLS, offsetof(GuideCell, n_lobes), GUIDE_CELL_LOBES + 1);
    is_refused(search, FOURS, offsetof(GuideFour, n_sheet), 0);
    is_refused(search, FOURS, offsetof(GuideFour, n_sheet), GUIDE_CELL_LOBES);
    is_refused(search, BEGINS, search->guide->n_cells * sizeof(uint32_t), (uint32_t)search->facts.n + 1);
    is_refused(search, BEGINS, 0, UINT32_MAX);
    Kept kept;
    for (int part = 0; part < GUIDE_PARTS; part++) {
        GuideSearch *read;
        keep(search, &kept);
        kept.parts[part].length++;
        if (part == 7) /* visits that nobody counted are not looked at */
            assert_true(guide_search_read(kept.parts, &read));
        else
            assert_false(guide_search_read(kept.parts, &read));
        guide_search_free(read);
    }
    guide_search_free(search);
    lit_clear(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pieces), cmocka_unit_test(stops), cmocka_unit_test(damage)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

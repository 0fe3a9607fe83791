/* gemcad_test.c - cut stones from GemCad's cutting instructions: closed forms, where facets come to lie, every way of writing them that is
 * about, and damaged files.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/angle.h"
#include "mesh_reader.h"
#include "near.h"

#define HEAD "GemCad 5.0\r\ng 96 0.0\r\ny 4 y\r\nI 1.76\r\nH A stone of a test\r\n"

static double volume_of(Mesh *mesh)
{
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    assert_true(report.closed && !report.inside_out);
    mesh_free(mesh);
    return report.volume;
}

static void expect_volume(const char *text, double volume)
{
    assert_near(volume_of(load(text)), volume, 2e-6 * volume);
}

/* A block of 2 by 2 by 0.8 whose crown is cut at 45 degrees, so that the table is 1.4 wide: a frustum on it. */
#define BLOCK_VOLUME (4 * 0.5 + 0.3 * (4 + 1.4 * 1.4 + 2 * 1.4) / 3)
#define CROWN_AT "0.9192388155425117" /* 1.3 / sqrt(2): the corner of the girdle, .3 up, and 1 out */

static void blocks_are_as_their_closed_forms(void **state)
{
    (void)state;
    expect_volume(HEAD "a 90.0 1.0 96 24 48 72\r\na 0 .5\r\na -0.0 .3\r\n", 4 * .8);
    expect_volume(HEAD "a -90.0 1.0 96 24 48 72\r\na 45 " CROWN_AT " 96 24 48 72\r\na 0.00 .6 96\r\na -0.0 .2 96\r\n",
                  BLOCK_VOLUME);
    /* eight faces of an octahedron with its corners at a distance of 1 */
    expect_volume(HEAD "a 54.735610317245346 .5773502691896258 12 36 60 84\r\n"
                       "a -54.735610317245346 .5773502691896258 12 36 60 84\r\n",
                  4. / 3);
}

/* All of these are the same block. */
static void all_ways_of_writing_are_read(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "GemCad 5.0\ng96 0.0\ny 4 y\nI1.76\na -90 1.0 0 n G1 24 48 72 G the girdle, 4 sides\na 0 .6 n T\n"
        "a 45 " CROWN_AT " 96 n 1 24 n 2 48 n 3 72 n 4 G to the girdle\na 0 -0.2 n culet\nF a note\nF another one\n",
        "\xef\xbb\xbfGemCad 4.51\rg -96 0\ra 90 1\r96 24\r48 n g 72\r\ra 45 " CROWN_AT
        " 96\r24 n C 48\rn D 72\rG a note that\rgoes on 12 x\ra 0 .6\ra -0.0000 .2 96\r",
        "gemcad\n; a remark\ng 64 16\nI 2.417 of a diamond\na 90 1 0 16 32 48\na 45 " CROWN_AT
        " 64 16 32 48\na 0 .6 64\na -0 .2\ny 8 n\n"};
    for (size_t i = 0; i < COUNT_OF(texts); i++) expect_volume(texts[i], BLOCK_VOLUME);
}

/* The extent of what a file has. */
static Box3 box_of(const char *text)
{
    Mesh *mesh = load(text);
    Box3 box = box3_empty();
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        Vec3 p = vec3_from_f(mesh->positions[i]);
        box = box3_union(box, (Box3){p, p});
    }
    mesh_free(mesh);
    return box;
}

/* Seen from above, where x goes to the right and z to the bottom, index 0 is at the bottom, and the others follow against the clock. */
static void facets_are_where_their_index_says(void **state)
{
    (void)state;
#define SIDES(first) "a 90 1 " first " 48 72\na 90 2 24\na 0 .5\na -0 .25\n"
    Box3 box = box_of("GemCad 5.0\ng 96 0\n" SIDES("0"));
    assert_near(box.max.z, 1, 1e-6);
    assert_near(box.max.x, 2, 1e-6);
    assert_near(box.min.x, -1, 1e-6);
    assert_near(box.min.z, -1, 1e-6);
    assert_near(box.max.y, .5, 1e-6);
    assert_near(box.min.y, -.25, 1e-6);
    assert_near(box_of("GemCad 5.0\ng -96 0\n" SIDES("0")).min.x, -2, 1e-6);
    assert_near(box_of("GemCad 5.0\ng 96 24\n" SIDES("96")).max.z, 2, 1e-6);
    /* halves of teeth, too: a side that is turned by a 96th of 180 degrees more */
    box = box_of("GemCad 5.0\ng 96 0\na 90 1 .5 24.5 48.5 72.5\na 0 .5\na -0 .5\n");
    assert_near(box.max.z, cos(MEN_PI / 96) + sin(MEN_PI / 96), 1e-6);
#undef SIDES
}

static void stones_say_what_they_are_of(void **state)
{
    (void)state;
    MeshSource source = {.whole = true};
    Mesh *mesh;
    mesh_free(load(HEAD "a 90 1 96 24 48 72\na 0 .5\na -0 .5\n"));
    assert_int_equal(mesh_load(in_folder(mesh_name), &source, &mesh, NULL), STATUS_OK);
    mesh_free(mesh);
    assert_near(source.unit_m, .005, 1e-12);
    assert_int_equal(source.n_materials, 1);
    assert_string_equal(source.materials[0].name, "stone");
    assert_near(source.materials[0].facts[FACT_INDEX][0], 1.76, 1e-12);
    assert_near(source.materials[0].facts[FACT_TRANSMISSION][0], 1, 0);
    assert_int_equal(source.n_runs, 1);
    mesh_source_clear(&source);
}

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } cases[] = {
        {"", "does not begin with 'GemCad'"},
        {"0 0 0\n1 0 0\n", "does not begin with 'GemCad'"},
        {HEAD, "its 0 facets enclose no stone: that takes 4 at least"},
        {HEAD "a 90 1 96 24 48 72\na 0 .5\n", "its 5 facets enclose no stone: it is open at a side, or cut away whole"},
        {HEAD "a 90 1 96 24 48 72\na 0 -.5\na 0 -.1\na 30 -4 0\n", "enclose no stone"},
        {HEAD "a 90.0\n", ":6: the line ends where their distance from the middle should be"},
        {HEAD "a 91 1 0\n", ":6: '91' stands where an angle from -90 to 90 degrees should be"},
        {HEAD "a 45 1\na 0 1\n", ":6: the facets have no index"},
        {HEAD "a 45 1 12 x 36\n", ":6: 'x' stands where an index of the facets should be"},
        {HEAD "a 45 1 12\n24 1e999\n", ":7: '1e999' stands where an index of the facets should be"},
        {"GemCad 5.0\na 45 1 12\n", ":2: an index before the line 'g'"},
        {"GemCad 5.0\ng 0 0\n", ":2: an index wheel of 0 teeth; it can have 1 to 1000"},
        {"GemCad 5.0\ng 1e6\n", ":2: an index wheel of 1e+06 teeth"},
        {"GemCad 5.0\nI 0.5\n", ":2: a refractive index of 0.5; it can be 1 to 10"},
        {"GemCad 5.0\nI nan\n", ":2: 'nan' stands where the refractive index should be"},
        {"GemCad 5.0\n\nwhatever\n", ":3: 'whatever' stands where a record should be"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) refuse(cases[i].text, cases[i].said);
}

static void spoilt_files_do_no_harm(void **state)
{
    (void)state;
    static const char text[] = HEAD "a -90.0 1.0 96 24 n G1 48 72\r\na 45 " CROWN_AT
                                    " 96 24 48\r\n 72 G a note\r\na 0.00 .6 96\r\na -0.0 .2 96\r\nF more\r\n";
    spoil(text, sizeof text - 1, 2000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_as_their_closed_forms),  cmocka_unit_test(all_ways_of_writing_are_read),
        cmocka_unit_test(facets_are_where_their_index_says), cmocka_unit_test(stones_say_what_they_are_of),
        cmocka_unit_test(damaged_files_are_told_where),      cmocka_unit_test(spoilt_files_do_no_harm),
    };
    mesh_name = "mesh.asc";
    return cmocka_run_group_tests_name("gemcad", tests, make_folder, remove_folder);
}

/* report_meshes_test.c - what `check` says of meshes that cross themselves, and of those whose parts overlap.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "check/report.h"
#include "scene_fixture.h"

#define TETRAHEDRA(second)                                                                                             \
    "positions = [<0, 0, 0>, <9, 0, 0>, <0, 9, 0>, <0, 0, 9>, <2, 2, 2>, " second "] triangles = [<0, 2, 1>, "         \
    "<0, 1, 3>, <0, 3, 2>, <1, 2, 3>, <4, 6, 5>, <4, 5, 7>, <4, 7, 6>, <5, 6, 7>] "

/* A bow tie, drawn out: its sheet crosses itself along an edge. */
#define BOW_TIE                                                                                                        \
    "positions = [<0, 0, 0>, <4, 4, 0>, <4, 0, 0>, <0, 5, 0>, <2, 2, 3>] triangles = [<0, 2, 1>, <0, 3, 2>, "          \
    "<0, 1, 4>, <1, 2, 4>, <2, 3, 4>, <3, 0, 4>] "

/* One report for each mesh, and of the right kind. */
static void meshes_are_reported_once(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        DiagCode code;
        const char *message;
    } cases[] = {
        {FIXTURE_MEDIA "let both = mesh { interior = glass " TETRAHEDRA(
             "<9, 2, 2>, <2, 9, 2>, <2, 2, 9>") "}\n"
                                                "both { translate(<100, 0, 0>) } both {}" FIXTURE_VIEW,
         D_MESH_PARTS_OVERLAP, "the 2 parts of the mesh of both 1 overlap: they are one body"},
        {FIXTURE_MEDIA "mesh { interior = glass " TETRAHEDRA("<3, 2, 2>, <2, 3, 2>, <2, 2, 3>") "}" FIXTURE_VIEW,
         D_MESH_PART_WITHIN, "1 part of the mesh of mesh 1 lies within another and adds nothing"},
        {FIXTURE_MEDIA "mesh { interior = glass " TETRAHEDRA("<1, 2, 2>, <2, 1, 2>, <2, 2, 1>") "}" FIXTURE_VIEW,
         D_COUNT, NULL},
        {FIXTURE_MEDIA "difference { interior = glass box { size = <5, 5, 5> } mesh { " TETRAHEDRA(
             "<9, 2, 2>, <2, 9, 2>, <2, 2, 9>") "} }" FIXTURE_VIEW,
         D_MESH_PARTS_OVERLAP, "overlap: they are one body"},
        {FIXTURE_MEDIA "mesh { surface = surface { } " TETRAHEDRA("<9, 2, 2>, <2, 9, 2>, <2, 2, 9>") "}" FIXTURE_VIEW,
         D_COUNT, NULL},
        {FIXTURE_MEDIA "mesh { interior = glass " BOW_TIE "}" FIXTURE_VIEW, D_MESH_CROSSES_ITSELF, "crosses itself: "},
    };
    static const DiagCode kinds[] = {D_MESH_PARTS_OVERLAP, D_MESH_PART_WITHIN, D_MESH_CROSSES_ITSELF};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture f;
        fixture_compile(&f, cases[i].text, 1);
        report_nested_parts(f.compiled, &f.diag);
        assert_int_equal(report_mesh_crossings(f.compiled, NULL, &f.diag, &f.error), STATUS_OK);
        int n = 0;
        for (const Diagnostic *d = f.diag.first; d; d = d->next)
            for (size_t k = 0; k < COUNT_OF(kinds); k++) n += d->code == kinds[k];
        assert_int_equal(n, cases[i].message ? 1 : 0);
        const Diagnostic *found = fixture_find(&f, cases[i].code);
        if (cases[i].message && (!found || !strstr(found->text, cases[i].message)))
            fail_msg("%s", found ? found->text : cases[i].text);
        fixture_clear(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_reported_once),
    };
    return cmocka_run_group_tests_name("report_meshes", tests, NULL, NULL);
}

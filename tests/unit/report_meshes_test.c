/* report_meshes_test.c - what `check` says of meshes that enclose some of their inside twice.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "check/report.h"
#include "scene_fixture.h"

#define TETRAHEDRA(second)                                                                                             \
    "positions = [<0, 0, 0>, <9, 0, 0>, <0, 9, 0>, <0, 0, 9>, <2, 2, 2>, " second "] triangles = [<0, 2, 1>, "         \
    "<0, 1, 3>, <0, 3, 2>, <1, 2, 3>, <4, 6, 5>, <4, 5, 7>, <4, 7, 6>, <5, 6, 7>] "

static void meshes_that_cross_themselves_are_reported_once(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {FIXTURE_MEDIA "let both = mesh { interior = glass " TETRAHEDRA(
             "<9, 2, 2>, <2, 9, 2>, <2, 2, 9>") "}\n"
                                                "both { translate(<100, 0, 0>) } both {}" FIXTURE_VIEW,
         "crosses itself: 3 pairs of its triangles pass through each other"},
        {FIXTURE_MEDIA "mesh { interior = glass " TETRAHEDRA("<3, 2, 2>, <2, 3, 2>, <2, 2, 3>") "}" FIXTURE_VIEW,
         "1 part of the mesh of mesh 1 lies within another and faces outward"},
        {FIXTURE_MEDIA "mesh { interior = glass " TETRAHEDRA("<1, 2, 2>, <2, 1, 2>, <2, 2, 1>") "}" FIXTURE_VIEW, NULL},
        {FIXTURE_MEDIA "difference { interior = glass box { size = <5, 5, 5> } mesh { " TETRAHEDRA(
             "<9, 2, 2>, <2, 9, 2>, <2, 2, 9>") "} }" FIXTURE_VIEW,
         "crosses itself"},
        {FIXTURE_MEDIA "mesh { surface = surface { } " TETRAHEDRA("<9, 2, 2>, <2, 9, 2>, <2, 2, 9>") "}" FIXTURE_VIEW,
         NULL},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture f;
        fixture_compile(&f, cases[i].text, 1);
        assert_int_equal(report_mesh_crossings(f.compiled, NULL, &f.diag, &f.error), STATUS_OK);
        const Diagnostic *found = fixture_find(&f, D_MESH_CROSSES_ITSELF);
        if (!cases[i].message) {
            assert_null(found);
        } else {
            assert_non_null(found);
            if (!strstr(found->text, cases[i].message)) fail_msg("%s", found->text);
            for (const Diagnostic *d = found->next; d; d = d->next)
                assert_int_not_equal(d->code, D_MESH_CROSSES_ITSELF);
        }
        fixture_clear(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_that_cross_themselves_are_reported_once),
    };
    return cmocka_run_group_tests_name("report_meshes", tests, NULL, NULL);
}

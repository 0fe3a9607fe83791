/* shells_test.c - a thousand hulls in one another: nothing is lost, however deep a ray is inside.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

/* Shells of alternating index about one point. A narrow view meets all of them, a wide one is turned back by total
 * reflection at some depth. */
static void render_shells(const char *view, bool seen_from_inside, NestPolicy policy, FaultCount *faults)
{
    enum { SHELLS = 1000, PICTURE = 4, SAMPLES = 3 };
    char text[1000], what[100];
    snprintf(text, sizeof text,
             "meniscus 1.0 unit mm medium thick { ior = 1.4 } medium thin { ior = 1.35 }\n"
             "for (i in 0..<%d) {\n"
             "  sphere { interior = i %% 2 == 0 ? thick : thin  radius = 10 - .0099 * i  priority = i } }\n%s",
             SHELLS, view);
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .policy = policy, .furnace = true});
    assert_int_equal(scene.compiled->n_hulls, SHELLS);
    RenderSettings settings = truth_settings(PICTURE, SAMPLES);
    settings.bounces = 10000000;
    Picture picture;
    truth_render(&scene, &settings, 0, &picture);
    truth_count(faults, &picture.stats);
    fixture_clear(&scene);
    double difference = truth_difference_from_empty(&settings, &picture);
    snprintf(what, sizeof what, "1,000 shells from %s, %s: difference from no shell",
             seen_from_inside ? "inside" : "outside", nest_policy_text(policy));
    truth_figure(what, 0, difference, 0);
    printf("    %.0f crossings per path\n", (double)picture.stats.crossings / (double)picture.stats.paths);
    /* no boundary changes what a path carries; one path of a pixel would be 1 / SAMPLES */
    assert_true(difference <= 1e-4);
    assert_true(picture.stats.crossings > 100 * picture.stats.paths);
    truth_clear(&picture);
}

static void thousand_shells(void **state)
{
    (void)state;
    static const NestPolicy policies[] = {NEST_AUTOMATIC, NEST_PRIORITY, NEST_ENTERED};
    FaultCount faults = {0};
    for (size_t i = 0; i < COUNT_OF(policies); i++) {
        render_shells("camera { from = <0, 0, 60>  to = <0, 0, 0>  fov = 4deg }", false, policies[i], &faults);
        render_shells("camera { from = <.01, .02, .05>  to = <0, 0, 9>  fov = 40deg }", true, policies[i], &faults);
    }
    truth_print_faults("1,000 shells", &faults);
    assert_int_equal(faults.faults, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(thousand_shells)};
    return cmocka_run_group_tests_name("shells", tests, NULL, NULL);
}

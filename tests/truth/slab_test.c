/* slab_test.c - transmittance and reflectance of stacks of slabs at normal incidence against their closed form.
 *
 * A stack of k media, one inside the other as the skins of an onion, is met along a line as 2k - 1 layers. It is modelled in
 * three ways: as k hulls in one another (every surface once), as 2k - 1 slabs whose faces coincide, and as slabs that reach
 * into each other, where the thinner one is to be on top.
 *
 * The closed form: intensities going right and left on both sides of an interface of reflectance r are related by
 * 1/(1-r) ((1, -r), (r, 1-2r)), across a layer that lets a part `a` through by ((1/a, 0), (0, a)); of the product M of all,
 * T = 1 / M00 and R = M10 / M00. Incoherent multilayers after E. Centurioni, "Generalized matrix method for calculation
 * of internal light energy flux in mixed coherent and incoherent multilayers", Appl. Opt. 44 (2005), without interference.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { MOST = 5, WIDTH = 32, SAMPLES = 384, SAMPLES_COMPARED = 32 };

/* From the outside in: neighbours differ in thickness, so that the automatic order is known. */
static const double iors[MOST] = {1.5, 1.33, 1.7, 1.31, 2.0};
static const double sigmas[MOST] = {0.02, 0.007, 0.03, 0.01, 0.02}; /* per mm */
static const double depths[MOST] = {3, 2, 4, 1.5, 5};               /* mm */
/* Half widths of nested hulls: a rod fits into the box around it, a box into the rod around that. */
static const double widths[MOST] = {40, 38, 26, 24, 16};

typedef enum Scheme { NESTED, COINCIDENT, OVERLAPPING } Scheme;
static const char *const scheme_names[] = {"nested", "coincident", "overlapping"};

/* The medium of layer i of 2k - 1. */
static int medium_of(int layer, int k)
{
    return layer < k ? layer : 2 * k - 2 - layer;
}

typedef struct Stack {
    double transmittance, reflectance;
} Stack;

static void multiply(double m[4], const double by[4])
{
    double product[4] = {m[0] * by[0] + m[1] * by[2], m[0] * by[1] + m[1] * by[3], m[2] * by[0] + m[3] * by[2],
                         m[2] * by[1] + m[3] * by[3]};
    memcpy(m, product, sizeof product);
}

static Stack closed_form(int k)
{
    double m[4] = {1, 0, 0, 1}, before = 1;
    for (int layer = 0; layer <= 2 * k - 1; layer++) {
        double after = layer < 2 * k - 1 ? iors[medium_of(layer, k)] : 1;
        double root = (before - after) / (before + after), r = root * root;
        multiply(m, (double[4]){1 / (1 - r), -r / (1 - r), r / (1 - r), (1 - 2 * r) / (1 - r)});
        before = after;
        if (layer == 2 * k - 1) break;
        double a = exp(-sigmas[medium_of(layer, k)] * depths[medium_of(layer, k)]);
        multiply(m, (double[4]){1 / a, 0, 0, a});
    }
    return (Stack){1 / m[0], m[2] / m[0]};
}

/* One slab from z0 to z1. Boxes are triangles in float, rods exact in double: where they touch, both must agree. */
static void write_slab(Buf *text, int medium, bool rod, double width, const double z[2], NestPolicy policy,
                       int priority)
{
    if (rod)
        buf_format(text, "cylinder { interior = m%d  from = <0, 0, %.17g>  to = <0, 0, %.17g>  radius = %g", medium,
                   z[0], z[1], width);
    else
        buf_format(text, "box { interior = m%d  from = <%g, %g, %.17g>  to = <%g, %g, %.17g>", medium, -width, -width,
                   z[0], width, width, z[1]);
    if (policy == NEST_PRIORITY) buf_format(text, "  priority = %d", priority);
    buf_format(text, " }\n");
}

/* The thinner, the higher in rank: 0 is the thickest. */
static int rank_of(int medium)
{
    int rank = 0;
    for (int i = 0; i < MOST; i++) rank += depths[i] > depths[medium];
    return rank;
}

static void write_stack(Buf *text, int k, Scheme scheme, NestPolicy policy)
{
    double start[2 * MOST] = {0};
    for (int i = 0; i < 2 * k - 1; i++) start[i + 1] = start[i] + depths[medium_of(i, k)];
    for (int i = 0; i < (scheme == NESTED ? k : 2 * k - 1); i++) {
        int medium = medium_of(i, k);
        if (scheme == NESTED) {
            write_slab(text, medium, i % 2, widths[i], (double[2]){start[i], start[2 * k - 1 - i]}, policy, i);
            continue;
        }
        double reach = 0.25, z[2] = {start[i], start[i + 1]};
        if (scheme == OVERLAPPING && i > 0 && depths[medium] > depths[medium_of(i - 1, k)]) z[0] -= reach;
        if (scheme == OVERLAPPING && i < 2 * k - 2 && depths[medium] > depths[medium_of(i + 1, k)]) z[1] += reach;
        write_slab(text, medium, i % 2, 20, z, policy, rank_of(medium));
    }
}

typedef struct Case {
    int k;
    Scheme scheme;
    NestPolicy policy;
    bool reflected; /* the light is far behind the camera; else far behind the stack */
    uint32_t samples;
} Case;

static FaultCount faults;

static void render_case(Case c, Picture *picture)
{
    Buf text = {0};
    buf_format(&text, "meniscus 1.0 unit mm\n");
    for (int i = 0; i < c.k; i++)
        buf_format(&text, "medium m%d { ior = %g  absorption = %g / 1mm }\n", i, iors[i], sigmas[i]);
    write_stack(&text, c.k, c.scheme, c.policy);
    buf_format(&text, "light { from = <0, 0, %d>  to = <0, 0, 0>  size = <100, 100> }\n", c.reflected ? 2000 : -1000);
    buf_format(&text, "camera { from = <0, 0, 1000>  to = <0, 0, 0>  fov = .05deg }\n");
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = buf_text(&text), .policy = c.policy});
    buf_clear(&text);
    RenderSettings settings = truth_settings(WIDTH, c.samples);
    truth_render(&scene, &settings, 0, picture);
    truth_count(&faults, &picture->stats);
    fixture_clear(&scene);
}

static double expected_of(Case c)
{
    Stack stack = closed_form(c.k);
    return c.reflected ? stack.reflectance : stack.transmittance;
}

static void slabs_have_their_closed_form(void **state)
{
    (void)state;
    for (int k = 1; k <= MOST; k++)
        for (Scheme scheme = NESTED; scheme <= OVERLAPPING; scheme++)
            for (int reflected = 0; reflected < 2; reflected++) {
                Case c = {k, scheme, NEST_AUTOMATIC, reflected, SAMPLES};
                char what[100];
                Picture picture;
                render_case(c, &picture);
                snprintf(what, sizeof what, "%s of %d %s", reflected ? "reflectance" : "transmittance", k,
                         scheme_names[scheme]);
                truth_expect(what, expected_of(c), truth_mean(&picture, -1), 4, reflected ? 0.003 : 0.001);
                truth_clear(&picture);
            }
}

/* The same random numbers choose the same ways through the same stack, so that the pictures of all schemes under
 * all policies are one picture, up to rounding. `entered` has no part in overlaps: who owns them depends on the
 * direction there. */
static void schemes_and_policies_agree(void **state)
{
    (void)state;
    static const NestPolicy policies[] = {NEST_AUTOMATIC, NEST_PRIORITY, NEST_ENTERED};
    double largest = 0;
    for (int k = 1; k <= MOST; k++)
        for (int reflected = 0; reflected < 2; reflected++) {
            Picture first, other;
            render_case((Case){k, NESTED, NEST_AUTOMATIC, reflected, SAMPLES_COMPARED}, &first);
            for (size_t p = 0; p < COUNT_OF(policies); p++)
                for (Scheme scheme = NESTED; scheme <= (policies[p] == NEST_ENTERED ? COINCIDENT : OVERLAPPING);
                     scheme++) {
                    render_case((Case){k, scheme, policies[p], reflected, SAMPLES_COMPARED}, &other);
                    largest = fmax(largest, truth_largest_difference(&first, &other));
                    truth_clear(&other);
                }
            truth_clear(&first);
        }
    truth_figure("largest difference of a pixel, all schemes and policies", 0, largest, 0);
    assert_true(largest <= 1e-5);
}

/* Without nesting five media, one inside the other, look like something else. */
static void no_nesting_differs(void **state)
{
    (void)state;
    Case c = {MOST, NESTED, NEST_NONE, false, SAMPLES};
    Picture picture;
    render_case(c, &picture);
    Estimate measured = truth_mean(&picture, -1);
    truth_figure("transmittance of 5 nested, none (must differ)", expected_of(c), measured.mean, measured.error);
    assert_true(fabs(measured.mean - expected_of(c)) > 10 * measured.error);
    truth_clear(&picture);
}

static void no_faults(void **state)
{
    (void)state;
    truth_print_faults("slabs", &faults);
    assert_true(faults.crossings > 10000000);
    assert_int_equal(faults.faults, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slabs_have_their_closed_form),
        cmocka_unit_test(schemes_and_policies_agree),
        cmocka_unit_test(no_nesting_differs),
        cmocka_unit_test(no_faults),
    };
    return cmocka_run_group_tests_name("slab", tests, NULL, NULL);
}

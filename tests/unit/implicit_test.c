/* implicit_test.c - bounds of functions of the scene: they hold for every operation, blocks of the grid that are left out for
 * them hold no crossing, and the mesh of an isosurface is the same without them, and without
 * threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "lang_fixture.h"

#include "dice.h"
#include "near.h"
#include "lang/formula.h"
#include "scene_fixture.h"
#include "shape/implicit_blocks.h"

/* What functions can do; behind ';' what they need. */
static const struct {
    const char *text;
    double known; /* at least this part of small boxes has bounds */
} functions[] = {
    {"f(p) = length(p) - .8", 1},
    {"f(x, y, z) = x * y - z * 3 + x * x - y / 7 - -z", 1},
    {"f(x, y, z) = x / y + 1 / (z * z + .1)", .7},
    {"f(x, y, z) = x % 3 + mod(y, -.7) + z % (abs(x) + 1)", 1},
    {"f(x, y, z) = x ^ 2 + y ^ 3 - abs(z) ^ 1.5 + x ^ 0 + (x * x) ^ y", .95},
    {"f(x, y, z) = x ^ -2 + y ^ -3", .6},
    {"f(x, y, z) = pow(abs(x) + .1, y) + 2 ^ z", 1},
    {"f(p) = p.x ^ .5", .3},
    {"f(p) = p.x < p.y and p.z >= 0 or not (p.x > 1) ? p.x + 1 : p.y <= p.z ? p.y - 1 : -2", 1},
    {"f(p) = (p.x > 0) == (p.y > 0) ? p.z : p == round(p) ? 1 : -.5", 1},
    {"f(p) = clamp(p.x, -.5, .5) + clamp(2, p.y, p.z) + (p.z < p.x ? p.z : p.x) + (p.y > 1 ? p.y : 1)", 1},
    {"f(p) = p.y < p.z ? p.y : -9", 1},
    {"f(p) = p.y < p.z ? p.z : 9", 1},
    {"f(p) = p.y <= p.z ? 9 : p.y", 1},
    {"f(p) = p.y <= p.z ? -9 : p.z", 1},
    {"f(p) = min(p.x, p.y, 1) + max(p.y, p.z) - max(abs(p.x), abs(p.z))", 1},
    {"f(p) = atan2(p.z, p.x) / 360 + atan2(p.y, 1) + atan2(-1, p.x)", 1},
    {"f(p) = mix(p.x, p.y, p.z) + mix(1, 2, p.x) + mix(p.x * 1e6, -p.y, round(p.z))", 1},
    {"f(p) = smoothstep(-.5, .7, p.x) - smoothstep(1, -1, p.y) + smoothstep(p.x, p.y, p.z) + smoothstep(.5, .5, p.z)",
     1},
    {"f(p) = noise(3 * p) + noise(p.x, p.y) + noise(p.x * 8) / 3 - noise(20 * p) * .1", 1},
    {"f(p) = sum([for (i in 0..5) noise(p * 2 ^ i) / 2 ^ i]) - .1", 1},
    {"f(p) = sin(360 * p.x) * cos(360 * p.y) + sin(36000 * p.z) - cos(p.x * 2)", 1},
    {"f(p) = tan(p.x * 20) + p.y", 0},
    {"f(p) = asin(p.x / 5) / 90 + acos(p.y / 5) / 180 - atan(p.z)", 1},
    {"f(p) = asin(p.x) / 90 + acos(p.y) / 180", .01},
    {"f(p) = sqrt(p.x) + sqrt(abs(p.y)) - .5", .3},
    {"f(p) = -floor(p).x + ceil(+p.y) + round(p.z) + sign(p.x) + frac(p.y) - frac(4 * p.z)", 1},
    {"f(p) = exp(p.x) - log(abs(p.y) + .01) + log10(p.z * p.z + 1) - .3", 1},
    {"f(p) = log(p.x) + exp(300 * p.y)", .01},
    {"f(p) = rnd(7, floor(p.x), 3) - .5 + p.y", 1},
    {"f(p) = [.1, .5, .9, .3][floor(abs(p.x)) % 4] - p.z", .3},
    {"f(p) = dot(normalize(p), <0, 1, 0>) + distance(p, <1, 2, 3>) - cross(p, <1, 0, 2>).y - 2", .9},
    {"f(p) = fold(p.x, 4) - .5;def fold(x, n) = n == 0 ? x : fold(abs(x - n), n - 1)", 1},
    {"f(p) = blend(length(p - vec3(.5)) - .6, length(p + vec3(.5)) - .7, .3);def blend(a, b, k) = let (h = clamp(.5 + "
     ".5 "
     "* (b - a) / k, 0, 1)) mix(b, a, h) - k * h * (1 - h)",
     1},
    {"f(p) = p.x > 0 ? 1e308 * p.y * 10 : p.z", .3},
    {"f(p) = -1", 1},
};

static const Program *open_function(Run *run, const char *definition)
{
    char text[600];
    const char *more = strstr(definition, ";");
    int length = more ? (int)(more - definition) : (int)strlen(definition);
    snprintf(text, sizeof text,
             "meniscus 1.0 unit mm %s def %.*s medium ice { } isosurface { interior = ice function = f }",
             more ? more + 1 : "", length, definition);
    run_open(run);
    run->options.schema = scene_schema();
    run->options.frames = run->options.frame = 1;
    run->text = text;
    run_go(run);
    const Program *program = NULL;
    for (size_t i = 0; run->status == STATUS_OK && i < run->result.n_nodes; i++)
        if (strcmp(run->result.nodes[i]->type->name, "isosurface") == 0)
            program = formula_compile_at_points(eval_prop(run->result.nodes[i], "function")->as.function, &run->arena);
    if (program) return program;
    Buf out = {0};
    diag_print(&run->diag, &out, false);
    fail_msg("%s: %s", definition, buf_text(&out));
    return NULL;
}

static double value_of(const Program *program, const double p[3])
{
    const double inputs[PROGRAM_INPUTS] = {p[0], p[1], p[2]};
    double value;
    program_run(program, inputs, &value);
    return value;
}

static bool bounds_of(const Program *program, const double low[3], const double high[3], ProgramRange *range)
{
    const ProgramRange inputs[PROGRAM_INPUTS] = {{low[0], high[0]}, {low[1], high[1]}, {low[2], high[2]}};
    program_bound(program, inputs, range);
    return program_range_is_known(*range);
}

/* Ends and points within are often where functions have their edges. */
static double snapped(Dice *dice, double x)
{
    return dice_below(dice, 4) ? x : round(4 * x) / 4;
}

static void random_box(Dice *dice, double size, double low[3], double high[3])
{
    for (int i = 0; i < 3; i++) {
        low[i] = snapped(dice, 8 * dice_unit(dice) - 4);
        high[i] = dice_below(dice, 8) ? low[i] + snapped(dice, size * dice_unit(dice)) : low[i];
    }
}

static void point_in_box(Dice *dice, const double low[3], const double high[3], double p[3])
{
    for (int i = 0; i < 3; i++) {
        double inner = snapped(dice, low[i] + dice_unit(dice) * (high[i] - low[i]));
        int which = dice_below(dice, 6);
        p[i] = which == 0 ? low[i] : which == 1 ? high[i] : fmin(fmax(inner, low[i]), high[i]);
    }
}

static void values_are_within_their_bounds(void **state)
{
    (void)state;
    static const double sizes[] = {1e-3, .02, .3, 2, 6};
    uint64_t operations = 0;
    for (size_t i = 0; i < COUNT_OF(functions); i++) {
        Run run;
        const Program *program = open_function(&run, functions[i].text);
        Dice dice = {i << 32};
        int n_known = 0;
        for (uint32_t k = 0; k < program->n_steps; k++) operations |= 1ULL << program->steps[k].op;
        for (int n = 0; n < 2000; n++) {
            double low[3], high[3], p[3];
            ProgramRange range;
            random_box(&dice, sizes[n % 5], low, high);
            bool known = bounds_of(program, low, high, &range);
            if (n % 5 < 2) n_known += known;
            for (int k = 0; known && k < 50; k++) {
                point_in_box(&dice, low, high, p);
                double value = value_of(program, p);
                if (!(value >= range.low && value <= range.high))
                    fail_msg("%s: %.17g at <%.17g, %.17g, %.17g>, bounds %.17g .. %.17g", functions[i].text, value,
                             p[0], p[1], p[2], range.low, range.high);
            }
        }
        if (n_known < 800 * functions[i].known) fail_msg("%s: %d of 800 boxes have bounds", functions[i].text, n_known);
        run_close(&run);
    }
    assert_int_equal(operations, (1ULL << (PROGRAM_ENTRY + 1)) - 1); /* all of them */
}

/* Of what the functions of one number give where they are bent, a box must not be too small, nor much too large. */
static void bounds_are_close(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double low, high, least, most; /* of x, and of the function */
    } cases[] = {
        {"f(p) = sin(p.x)", 80, 100, .984807753, 1},
        {"f(p) = sin(p.x)", 260, 271, -1, -.984807753},
        {"f(p) = cos(p.x)", -10, 10, .984807753, 1},
        {"f(p) = cos(p.x)", -200, -170, -1, -.939692621},
        {"f(p) = p.x * p.x", -2, 1, 0, 4},
        {"f(p) = p.x ^ 2", -2, 1, 0, 4},
        {"f(p) = abs(p.x)", -2, 1, 0, 2},
        {"f(p) = p.x % 3", 7, 8, 1, 2},
        {"f(p) = p.x % 3", 8, 10, 0, 3},
        {"f(p) = clamp(p.x, 0, 1)", -1, .5, 0, .5},
        {"f(p) = frac(p.x)", 1.25, 1.5, .25, .5},
        {"f(p) = mix(p.x, p.x + 1, .5)", 0, 1, .5, 1.5},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Run run;
        const Program *program = open_function(&run, cases[i].text);
        const double low[3] = {cases[i].low, 0, 0}, high[3] = {cases[i].high, 0, 0};
        ProgramRange range;
        assert_true(bounds_of(program, low, high, &range));
        bool close = strstr(cases[i].text, "mix")
                         ? range.low <= cases[i].least && range.high >= cases[i].most
                         : fabs(range.low - cases[i].least) < 1e-8 && fabs(range.high - cases[i].most) < 1e-8;
        if (!close) fail_msg("%s: %.17g .. %.17g", cases[i].text, range.low, range.high);
        run_close(&run);
    }
}

/* ---- grids ---- */

typedef struct Asked {
    const Program *program;
    size_t n; /* points of layers */
} Asked;

static bool give_value(void *context, Vec3 p, double *value)
{
    const Asked *asked = context;
    *value = value_of(asked->program, (const double[3]){p.x, p.y, p.z});
    return isfinite(*value);
}

static Vec3 point_of(const Lattice *lattice, uint32_t i, uint32_t j, uint32_t k)
{
    return vec3(lattice->origin.x + lattice->step.x * i, lattice->origin.y + lattice->step.y * j,
                lattice->origin.z + lattice->step.z * k);
}

static bool give_layer(void *context, const Lattice *lattice, uint32_t k, const uint8_t *wanted, double *values)
{
    Asked *asked = context;
    for (uint32_t j = 0; j < lattice->n[1]; j++)
        for (uint32_t i = 0; i < lattice->n[0]; i++) {
            size_t at = (size_t)j * lattice->n[0] + i;
            if (wanted && !wanted[at]) continue;
            asked->n++;
            if (!give_value(context, point_of(lattice, i, j, k), &values[at])) return false;
        }
    return true;
}

static bool give_bounds(void *context, Box3 box, double *low, double *high)
{
    const Asked *asked = context;
    ProgramRange range;
    bool known = bounds_of(asked->program, (const double[3]){box.min.x, box.min.y, box.min.z},
                           (const double[3]){box.max.x, box.max.y, box.max.z}, &range);
    *low = range.low;
    *high = range.high;
    return known;
}

static void blocks_left_out_hold_no_crossing(void **state)
{
    (void)state;
    static const Lattice lattices[] = {{{-1.5, -1.25, -1}, {.05, .0625, .04}, {58, 42, 49}},
                                       {{.125, .25, .375}, {.01, .02, .03}, {2, 5, 34}},
                                       {{-3, -3, -3}, {.1, .1, .1}, {66, 65, 33}}};
    for (size_t n = 0; n < 3 * COUNT_OF(functions); n++) {
        Run run;
        const Lattice *lattice = &lattices[n % 3];
        size_t n_points = (size_t)lattice->n[0] * lattice->n[1];
        Asked asked = {open_function(&run, functions[n / 3].text), 0};
        const ImplicitField field = {&asked, give_layer, give_value, NULL, NULL, give_bounds};
        Blocks blocks = {.sides = NULL};
        assert_int_equal(blocks_make(&field, lattice, NULL, &blocks, NULL), STATUS_OK);
        uint8_t *wanted = malloc(n_points);
        double *values = malloc(n_points * sizeof *values);
        assert_true(wanted && values);
        for (uint32_t k = 0; blocks.sides && k < lattice->n[2]; k++) {
            blocks_of_layer(&blocks, lattice, k, wanted, values);
            for (size_t i = 0; i < n_points; i++) {
                uint32_t x = (uint32_t)(i % lattice->n[0]), y = (uint32_t)(i / lattice->n[0]);
                double value;
                bool valued = give_value(&asked, point_of(lattice, x, y, k), &value);
                if (!wanted[i] && (!valued || (value > 0) != (values[i] > 0)))
                    fail_msg("%s: %g is left out as %g", functions[n / 3].text, value, values[i]);
            }
        }
        free(wanted);
        free(values);
        blocks_clear(&blocks);
        run_close(&run);
    }
}

static void assert_same_bits(const Mesh *a, const Mesh *b)
{
    assert_int_equal(a->n_vertices, b->n_vertices);
    assert_int_equal(a->n_triangles, b->n_triangles);
    assert_memory_equal(a->positions, b->positions, a->n_vertices * sizeof *a->positions);
    assert_memory_equal(a->normals, b->normals, a->n_vertices * sizeof *a->normals);
    assert_memory_equal(a->triangles, b->triangles, a->n_triangles * sizeof *a->triangles);
}

static void meshes_are_the_same_without_bounds_and_threads(void **state)
{
    (void)state;
    Pool *pool;
    assert_int_equal(pool_new(3, &pool, NULL), STATUS_OK);
    const ImplicitOptions options = {.bounds = {{-1.5, -1.25, -1}, {2, 1.5, 1.25}},
                                     .tolerance = 1e-3,
                                     .cells = 24,
                                     .max_points = 100000,
                                     .pool = pool};
    size_t n_made = 0;
    for (size_t i = 0; i < COUNT_OF(functions); i++) {
        Run run;
        const Program *program = open_function(&run, functions[i].text);
        Asked with = {program, 0}, without = {program, 0};
        const ImplicitField bounded = {&with, give_layer, give_value, give_value, NULL, give_bounds};
        const ImplicitField plain = {&without, give_layer, give_value, NULL, NULL, NULL};
        Mesh *one = NULL, *other = NULL;
        ImplicitFound reached, other_reached;
        Error error;
        Status status = mesh_make_implicit(&bounded, &options, "this", &one, &reached, &error);
        assert_int_equal(mesh_make_implicit(&plain, &options, "this", &other, &other_reached, &error), status);
        if (status == STATUS_OK) {
            assert_true(reached.reached == other_reached.reached && reached.jumps == other_reached.jumps);
            assert_same_bits(one, other);
            assert_true(with.n <= without.n);
            if (i == 0) assert_true(with.n < without.n / 2);
            n_made++;
        }
        mesh_free(one);
        mesh_free(other);
        run_close(&run);
    }
    pool_free(pool);
    assert_true(n_made >= COUNT_OF(functions) * 3 / 4);
}

/* ---- jumps ---- */

static Mesh *mesh_of_cells(const char *text, double tolerance, uint32_t cells, ImplicitFound *found, uint64_t *asked)
{
    Run run;
    Error error;
    Mesh *mesh = NULL;
    Asked with = {open_function(&run, text), 0};
    const ImplicitField field = {&with, give_layer, give_value, NULL, NULL, NULL};
    const ImplicitOptions options = {
        .bounds = {{-1.1, -1.2, -1.3}, {1.3, 1.2, 1.1}}, .tolerance = tolerance, .cells = cells, .max_points = 4000000};
    assert_int_equal(mesh_make_implicit(&field, &options, "this", &mesh, found, &error), STATUS_OK);
    *asked = with.n;
    run_close(&run);
    return mesh;
}

static Mesh *mesh_of(const char *text, double tolerance, ImplicitFound *found, uint64_t *asked)
{
    return mesh_of_cells(text, tolerance, 40, found, asked);
}

/* A ball whose inside is told by a step is that of a function with a slope, in places and normals, and found with no finer grid. */
static void a_jump_is_a_surface(void **state)
{
    (void)state;
    static const char *const texts[] = {"f(p) = .8 - length(p)", "f(p) = length(p) < .8 ? 1 : -1",
                                        "f(p) = length(p) < .8 ? 1 + p.x : -.01 - p.z * p.z",
                                        "f(p) = length(p) < .8 ? 7 : 0"};
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        ImplicitFound found;
        uint64_t asked;
        Mesh *mesh = mesh_of(texts[i], 1e-3, &found, &asked);
        double worst = 0;
        int n_turned = 0; /* of triangles so small that floats do not tell their direction */
        for (uint32_t v = 0; v < mesh->n_vertices; v++) {
            Vec3 p = vec3_from_f(mesh->positions[v]);
            worst = fmax(worst, fabs(vec3_length(p) - .8));
            n_turned += vec3_dot(vec3_from_f(mesh->normals[v]), p) < vec3_length(p) * cos(4 / 57.3);
        }
        printf("    %s: places off by %.2g, %d of %u normals turned, reached %.2g, %llu values\n", texts[i], worst,
               n_turned, mesh->n_vertices, found.reached, (unsigned long long)asked);
        assert_true(found.jumps == (i > 0));
        assert_true(worst < 1e-6);
        assert_true(n_turned < (int)mesh->n_vertices / 1000);
        assert_true(found.reached <= 1e-3 && found.reached > 1e-4);
        assert_true(asked < 1500000);
        if (found.jumps) assert_near(vec3_length(found.jump_at), .8, 1e-6);
        if (i == 3) assert_true(found.inner_value == 7 && found.outer_value == 0);
        mesh_free(mesh);
    }
}

/* Nothing but steps, whose edges no grid makes sharp, takes a bounded grid; what is only steep is no jump, nor is an edge of the grid
 * that lies in the surface. */
static void jumps_and_others(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool jumps;
    } cases[] = {
        {"f(p) = -floor(10 * p).x - floor(10 * p).y", true},
        {"f(p) = floor(p.x * 10) / 10 - p.y", true},
        {"f(p) = noise(floor(20 * p)) - .1", true},
        {"f(p) = p.x >= 0 ? 1 : -1", true},
        {"f(p) = 1e6 * (.5 - length(p))", false},
        {"f(p) = 1e-200 * (.5 - length(p))", false},
        {"f(p) = let (u = p.x + .2 * p.y) u / sqrt(u * u + 1e-6)", false},
        {"f(p) = abs(p.y) - sqrt(p.x ^ 2 + p.z ^ 2)", false},
        {"f(p) = p.x - p.y", false},
        {"f(p) = max(0, .5 - length(p))", false},
        {"f(p) = .7 - max(abs(p.x), abs(p.y), abs(p.z))", false},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        ImplicitFound found;
        uint64_t asked;
        Mesh *mesh = mesh_of(cases[i].text, 1e-3, &found, &asked);
        printf("    %s: %u triangles, %llu values\n", cases[i].text, mesh->n_triangles, (unsigned long long)asked);
        if (found.jumps != cases[i].jumps) fail_msg("%s: jumps %d", cases[i].text, found.jumps);
        if (found.jumps) assert_true(mesh->n_triangles < 2000000);
        mesh_free(mesh);
    }
}

/* A sheet of about a step's thickness takes no finer a grid than it needs, however coarse that was to begin with. */
static void thin_sheets(void **state)
{
    (void)state;
    static const char text[] = "f(p) = .2 - abs(sin(300 * p.x) * cos(300 * p.y) + sin(300 * p.y) * cos(300 * p.z) + "
                               "sin(300 * p.z) * cos(300 * p.x))";
    const double tolerance = 1.2e-3;
    const uint32_t cells[] = {24, 48, 96};
    uint32_t n_triangles[COUNT_OF(cells)];
    for (size_t i = 0; i < COUNT_OF(cells); i++) {
        ImplicitFound found;
        uint64_t asked;
        Mesh *mesh = mesh_of_cells(text, tolerance, cells[i], &found, &asked);
        n_triangles[i] = mesh->n_triangles;
        printf("    a sheet, from %u cells: %u triangles, within %.2g\n", cells[i], mesh->n_triangles, found.reached);
        assert_true(found.reached <= tolerance);
        assert_true(n_triangles[i] < 1.2 * n_triangles[0] && n_triangles[i] > 0.8 * n_triangles[0]);
        mesh_free(mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_within_their_bounds),
        cmocka_unit_test(bounds_are_close),
        cmocka_unit_test(blocks_left_out_hold_no_crossing),
        cmocka_unit_test(meshes_are_the_same_without_bounds_and_threads),
        cmocka_unit_test(a_jump_is_a_surface),
        cmocka_unit_test(jumps_and_others),
        cmocka_unit_test(thin_sheets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* formula_test.c - functions of the scene as textures: programs give what the evaluation gives, and what the same patterns
 * give; what cannot be compiled or has no value is refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <time.h>

#include "lang_fixture.h"

#include "dice.h"
#include "lang/formula.h"
#include "near.h"
#include "optics/surface_texture.h"
#include "scene_fixture.h"

static void random_inputs(Dice *dice, double inputs[PROGRAM_INPUTS])
{
    for (int i = 0; i < 3; i++) inputs[PROGRAM_POINT + i] = 8 * dice_unit(dice) - 4;
    Vec3 normal = vec3_normalize(vec3(dice_unit(dice) - 0.5, dice_unit(dice) - 0.5, dice_unit(dice) - 0.5));
    inputs[PROGRAM_NORMAL] = normal.x;
    inputs[PROGRAM_NORMAL + 1] = normal.y;
    inputs[PROGRAM_NORMAL + 2] = normal.z;
    for (int i = 0; i < 2; i++) inputs[PROGRAM_UV + i] = dice_unit(dice);
    inputs[PROGRAM_FOOTPRINT] = 0.1 * dice_unit(dice);
}

/* What functions can do, each with its parameters. */
static const char *const functions[] = {
    "f(p) = p.x + 2 * p.y - p.z / 3",
    "f(x, y, z) = x * y % 3 + abs(z) ^ 1.5 - mod(x, .7)",
    "f(u, v) = frac(8 * u) < .5 ? rgb(.8, .2, .1) : rgb(v, .9, .85)",
    "f(p, normal) = smoothstep(.4, .6, normal.y + .2 * noise(p * 6))",
    "f(uv) = uv.x * uv.y + uv.yx.x",
    "f(p, footprint) = footprint + p.z",
    "f(normal) = normal.x",
    "f(p, scale = 3, t = rgb(.1, .2, .3)) = t * scale * p.x",
    "f(p) = sum([for (i in 0..5) noise(p * 2 ^ i) / 2 ^ i])",
    "f(p) = max([for (i in 0..3) if (i % 2 == 0) sin(90 * p.x + 30 * i)]) + min(p.x, p.y, 1)",
    "f(p) = let (a = length(p), b = a + 1) mix(rgb(.8, .75, .7), rgb(.1, .15, .3), b / (a + 2))",
    "f(p) = rnd(7, floor(p.x), floor(p.y), 3) + rnd(floor(p * 3))",
    "f(p) = noise(p.x) + noise(p.x, p.z) + noise(p.xy, 2)",
    "f(p) = p.x > 0 and (p.y < 1 or not (p.z >= .5)) ? 1 : p.x <= -1 ? .5 : 0",
    "f(p) = (p.x > 0) == (p.y > 0) ? 1 : 0",
    "f(p) = p == <0, 0, 0> or p != p ? 1 : .25",
    "f(p) = [.1, .5, .9, .3][floor(abs(p.x)) % 4]",
    "f(p) = [rgb(1, 0, 0), rgb(0, 1, 0), rgb(0, 0, 1)][floor(4 * abs(p.z)) % 3] * .5",
    "f(p) = clamp(dot(normalize(p), <0, 1, 0>), -.5, .5) + distance(p, <1, 2, 3>) + cross(p, <1, 0, 2>).y",
    "f(p) = atan2(p.z, p.x) / 360 + pow(abs(p.y), .3)",
    "f(p) = rgb(vec3(clamp(p, 0, 1))) * .5 + .25",
    "f(p) = vec2(p.x, p.y).y + vec4(p, 1).w + rgb(.5).r",
    "f(p) = -floor(p).x + ceil(+p.y) + round(p.z) + sign(p.x) + sqrt(abs(p.y)) + exp(-abs(p.z))",
    "f(p) = fold(p.x, 4)  def fold(x, n) = n == 0 ? x : fold(abs(x - n), n - 1)",
    "f(p) = p[0] + p[2] * table[2] + clock  let table = [1, 2, 5]",
    "f(p) = spline([0, 1, .2], .3) * p.x + len(\"four\")",
    "f(p) = product([p.x, p.y + 1, 2]) + product([for (i in 1..4) i]) + sum(sort([3, 1, 2])) * p.z",
    "f(p) = reverse([p.x, p.y, 3])[1] + reverse([p, <1, 2, 3>])[1].z + reverse(1..3)[0] * p.x",
    "f(p) = srgb(frac(p.x), .5, frac(p.y)) + srgb(frac(p.z)) + srgb(frac(p))",
    "f(p) = hsv(atan2(p.z, p.x), frac(p.x), frac(p.y)) + hsv(90 * p.x, 1, .5)",
    "f(p) = hsl(-400 * p.x, frac(p.x), frac(p.y)) + hsl(30, .5, frac(p.z))",
};

static const EvalProp *function_of(Run *run, const char *definition)
{
    char text[600];
    const char *more = strstr(definition, "  ");
    int length = more ? (int)(more - definition) : (int)strlen(definition);
    /* what it needs stands before it */
    snprintf(text, sizeof text, "meniscus 1.0 unit mm %s def %.*s surface s { albedo = formula { function = f } }",
             more ? more : "", length, definition);
    run_open(run);
    run->options.schema = scene_schema();
    run->options.frames = run->options.frame = 1;
    run->text = text;
    run_go(run);
    if (run->status != STATUS_OK) {
        Buf out = {0};
        diag_print(&run->diag, &out, false);
        fail_msg("%s: %s", definition, buf_text(&out));
    }
    for (size_t i = 0; i < run->result.n_nodes; i++)
        if (strcmp(run->result.nodes[i]->type->name, "surface") == 0)
            return eval_prop(eval_prop(run->result.nodes[i], "albedo")->as.node, "function");
    fail();
    return NULL;
}

static void programs_give_what_the_evaluation_gives(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(functions); i++) {
        Run run;
        Dice dice = {i};
        const EvalProp *function = function_of(&run, functions[i]);
        const Program *program = formula_compile(function->as.function, &run.arena);
        if (!program) {
            Buf out = {0};
            diag_print(&run.diag, &out, false);
            fail_msg("%s: %s", functions[i], buf_text(&out));
        }
        for (int k = 0; k < 300; k++) {
            double inputs[PROGRAM_INPUTS], found[PROGRAM_MOST_OUTPUTS], wanted[PROGRAM_MOST_OUTPUTS];
            random_inputs(&dice, inputs);
            program_run(program, inputs, found);
            assert_true(formula_evaluate(function->as.function, inputs, wanted));
            for (uint32_t n = 0; n < program->n_outputs; n++)
                if (!(fabs(found[n] - wanted[n]) <= 1e-14 * (1 + fabs(wanted[n]))))
                    fail_msg("%s: %.17g, not %.17g", functions[i], found[n], wanted[n]);
        }
        run_close(&run);
    }
}

/* As the text has them, whichever compiler built the program: the scene's hash has them in it. */
static void registers_are_in_order(void **state)
{
    (void)state;
    static const double wanted[] = {5, 7, 9};
    Run run;
    const Program *program = formula_compile(function_of(&run, "f(p) = p.x > 5 ? 7 : 9")->as.function, &run.arena);
    assert_int_equal(program->n_constants, COUNT_OF(wanted));
    assert_memory_equal(program->constants, wanted, sizeof wanted);
    run_close(&run);
    program = formula_compile(function_of(&run, "f(p) = cross(p, p.yzx).x")->as.function, &run.arena);
    assert_true(program->n_steps >= 3 && program->steps[0].op == PROGRAM_MULTIPLY &&
                program->steps[1].op == PROGRAM_MULTIPLY);
    assert_int_equal(program->steps[0].a, PROGRAM_POINT + 1);
    assert_int_equal(program->steps[1].a, PROGRAM_POINT + 2);
    run_close(&run);
}

/* The texture that a surface's albedo is, of a scene. */
static const Texture *texture_of(const Scene *scene, uint32_t object, uint32_t *row)
{
    *row = scene->surfaces[scene->objects[object].surface].textures[0].texture;
    return &scene->textures[*row];
}

static void formulas_agree_with_patterns(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"checker { scale(.7) }", "formula { function = squares  scale(.7) }"},
        {"checker { from = rgb(.1, .5, .2)  to = .9  rotate(y, 30)  space = world }",
         "formula { function = squares  from = rgb(.1, .5, .2)  to = .9  rotate(y, 30)  space = world }"},
        {"gradient { wave = sine  frequency = 2 }", "formula { function = wave }"},
        {"gradient { wave = ramp  ramp = [[0, rgb(1, 0, 0)], [.3, rgb(0, 1, 0)], [1, rgb(0, 0, 1)]] }",
         "formula { function = saw  ramp = [[0, rgb(1, 0, 0)], [.3, rgb(0, 1, 0)], [1, rgb(0, 0, 1)]] }"},
        {"gradient { wave = ramp  turbulence = .3  vary = 2 }",
         "formula { function = saw  turbulence = .3  vary = 2 }"},
    };
    for (size_t i = 0; i < COUNT_OF(pairs); i++) {
        char text[1600];
        Fixture f;
        snprintf(text, sizeof text,
                 FIXTURE_MEDIA
                 "def squares(p) = mod(floor(p.x) + floor(p.y) + floor(p.z), 2) "
                 "def wave(p) = .5 - .5 * cos(720 * p.x)  def saw(p) = frac(p.x) "
                 "sphere { surface = surface { albedo = %s } } sphere { surface = surface { albedo = %s } "
                 "center = <5, 0, 0> }" FIXTURE_VIEW,
                 pairs[i][0], pairs[i][1]);
        fixture_good(&f, text);
        uint32_t rows[2];
        (void)texture_of(f.scene, 0, &rows[0]);
        assert_int_equal(texture_of(f.scene, 1, &rows[1])->kind, TEXTURE_FORMULA);
        ReflectedColor color;
        reflected_color_init(&color);
        Dice dice = {i};
        for (int k = 0; k < 2000; k++) {
            TexturePlace at = {.identity = 5};
            at.object = vec3(9 * dice_unit(&dice) - 4, 9 * dice_unit(&dice) - 4, 9 * dice_unit(&dice) - 4);
            at.world = vec3_add(at.object, vec3(1, 2, 3));
            at.object_normal = at.world_normal = vec3(0, 1, 0);
            Lanes nm = lanes(450, 520, 590, 650);
            Lanes a = texture_at(f.scene->textures, rows[0], &at, nm),
                  b = texture_at(f.scene->textures, rows[1], &at, nm);
            for (int lane = 0; lane < LANES; lane++)
                assert_near((double)lanes_get(a, lane), (double)lanes_get(b, lane), 2e-6);
            for (int row = 0; row < 2; row++) { /* at once as one by one */
                Lanes values[COLOR_FOURS];
                texture_at_each(f.scene->textures, rows[row], &at, &(Wavelengths){COLOR_FOURS, color.nm}, values);
                for (int n = 0; n < COLOR_FOURS; n++) {
                    Lanes value = texture_at(f.scene->textures, rows[row], &at, color.nm[n]);
                    for (int lane = 0; lane < LANES; lane++)
                        assert_float_equal(lanes_get(values[n], lane), lanes_get(value, lane), 0);
                }
            }
        }
        fixture_clear(&f);
    }
}

#define ON(definition, what) FIXTURE_MEDIA "def " definition " sphere { surface = surface { " what " } }" FIXTURE_VIEW

static void mistakes_are_reported(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        DiagCode code;
    } cases[] = {
        {ON("f(p) = 1 / (p.x - p.x)", "albedo = f"), D_BAD_NUMBER},
        {ON("f(p) = sqrt(p.x - 5)", "albedo = f"), D_BAD_NUMBER},
        {ON("f(p) = 2", "albedo = f"), D_VALUE_OUT_OF_RANGE},
        {ON("f(p) = rgb(.5, -.5, .5)", "albedo = f"), D_VALUE_OUT_OF_RANGE},
        {ON("f(p) = p.x > .9 ? 1.5 : .5", "ior = 1.5 roughness = f"), D_VALUE_OUT_OF_RANGE},
        {ON("f(p) = -1", "emission = f"), D_VALUE_OUT_OF_RANGE},
        {ON("f(p) = rgb(1, 0, 0)", "ior = 1.5 roughness = f"), D_WRONG_TYPE},
        {ON("f(p) = rgb(1, 0, 0)", "albedo = formula { function = f to = .5 }"), D_WRONG_TYPE},
        {ON("f(p) = p", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = p.x > 0", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = str(p.x)", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = p.x > 0 ? 1 : rgb(1, 0, 0).xy", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = p.w", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = spline([0, 1], p.x)", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = sum([for (i in 0..p.x) 1])", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = sort([p.x, p.y])[0]", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = hsv(p, 1, 1)", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = reverse(p)[0]", "albedo = f"), D_WRONG_TYPE},
        {ON("f(a, b, c, d) = a", "albedo = f"), D_WRONG_TYPE},
        {ON("f(p) = [.1, .2][floor(p.x)]", "albedo = f"), D_BAD_INDEX},
        {ON("f(p) = f(p)", "albedo = f"), D_TOO_DEEP},
        {ON("f(p) = p.x > 0 ? f(p * .5) : .1", "albedo = f"), D_TOO_DEEP},
        {ON("f(p) = sum([for (i in 0..9000) p.x * i]) * 0", "albedo = f"), D_LIMIT},
        {ON("f(p) = .5", "albedo = formula { }"), D_MISSING_PROPERTY},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) fixture_refused(cases[i].text, cases[i].code);
}

static void any_property_takes_one(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(
        &f, FIXTURE_MEDIA
        "def f(p) = .5 + .1 * noise(p)  def hot(p) = 3 * rgb(1, .5, .1)  def g(u, v) = u "
        "sphere { surface = surface { ior = 1.5 albedo = f roughness = f diffuse_roughness = f coat = f coat_roughness "
        "= f "
        "fuzz = f bump = f bump_height = .1 emission = hot } } "
        "sphere { interior = glass surface = surface { roughness = f anisotropy = g } center = <5, 0, 0> } "
        "sphere { surface = surface { albedo = mix { blend = f from = g to = .3 } } center = <9, 0, 0> }"
        "let w = noise { space = world } "
        "sphere { surface = surface { ior = 1.5 albedo = mix { blend = w from = .2 to = w } } center = <9, 9, 0> }"
        "sphere { surface = surface { albedo = mix { blend = w from = noise { } to = w } } center = <9, 9, 9> "
        "}" FIXTURE_VIEW);
    const SceneSurface *all = &f.scene->surfaces[f.scene->objects[0].surface];
    assert_int_equal(all->n_textures, 6);
    assert_true(all->bump != SCENE_NONE && all->emission_texture != SCENE_NONE && all->emits);
    assert_false(all->textures_use_uv);
    assert_true(all->textures_use_object);
    assert_true(f.scene->surfaces[f.scene->objects[1].surface].textures_use_uv);
    assert_true(f.scene->surfaces[f.scene->objects[2].surface].textures_use_uv);
    assert_false(f.scene->surfaces[f.scene->objects[3].surface].textures_use_object);
    assert_true(f.scene->surfaces[f.scene->objects[4].surface].textures_use_object);
    fixture_clear(&f);
}

/* Straight steps: no more than a few times as slow as what is written in C. */
static void speed_is_printed(void **state)
{
    (void)state;
    Run run;
    const EvalProp *function = function_of(&run, "f(p) = sum([for (i in 0..5) noise(p * 2 ^ i) / 2 ^ i])");
    const Program *program = formula_compile(function->as.function, &run.arena);
    enum { N = 100000 };
    double inputs[PROGRAM_INPUTS] = {0.1, 0.2, 0.3}, outputs[PROGRAM_MOST_OUTPUTS], sum = 0, seconds[3];
    for (int which = 0; which < 3; which++) {
        int n = which < 2 ? N : N / 100;
        clock_t start = clock();
        for (int i = 0; i < n; i++) {
            inputs[0] += 0.01;
            if (which == 0) {
                program_run(program, inputs, outputs);
            } else if (which == 2) {
                (void)!formula_evaluate(function->as.function, inputs, outputs);
            } else {
                outputs[0] = 0;
                for (int k = 0; k < 6; k++)
                    outputs[0] +=
                        noise_value((const double[3]){inputs[0] * (1 << k), inputs[1] * (1 << k), inputs[2] * (1 << k)},
                                    3) /
                        (1 << k);
            }
            sum += outputs[0];
        }
        seconds[which] = (double)(clock() - start) / CLOCKS_PER_SEC / n;
    }
    printf("six octaves of noise: %.0f ns as a program of %u steps, %.0f ns in C, %.0f ns by the evaluation\n",
           seconds[0] * 1e9, program->n_steps, seconds[1] * 1e9, seconds[2] * 1e9);
    assert_true(isfinite(sum) && seconds[0] < 10 * seconds[1] + 1e-6);
    run_close(&run);
}

/* ---- grids ---- */

#define GRID(function)                                                                                                 \
    FIXTURE_MEDIA function " medium smoke { mixes = true scattering = .1 "                                             \
                           "density = volume { function = f from = <-2, 0, -2> to = <2, 5, 2> cells = 60 } } "         \
                           "box { interior = smoke from = <-2, 0, -2> to = <2, 5, 2> }" FIXTURE_VIEW

static void build_with_threads(Fixture *fixture, const char *text, unsigned n)
{
    SceneOptions options = {.eval = {.frames = 1, .frame = 1}};
    Error error;
    assert_int_equal(pool_new(n, &options.pool, &error), STATUS_OK);
    fixture_build(fixture, text, &options);
    pool_free(options.pool);
}

/* Whether a function can be compiled or not, and whoever asks it: the grid is the same, and what it should be. */
static void grids_of_functions(void **state)
{
    (void)state;
    static const char *const texts[] = {
        GRID("def f(p) = max(0, noise(p) + 2 * noise(p * 3)) + (p.y > 3 ? sqrt(p.y - 3) : 0) + abs(p.x)"),
        GRID("def f(x, y, z) = max(0, noise(<x, y, z>) + 2 * noise(<x, y, z> * 3)) + (y > 3 ? sqrt(y - 3) : 0) + "
             "abs(x)"),
        GRID("def f(p) = let (a = [max(0, noise(p) + 2 * noise(p * 3)), p.y > 3 ? sqrt(p.y - 3) : 0, abs(p.x)]) "
             "sum([for (i in 0..2) a[i]])"),
        GRID("def f(p) = let (a = [for (c in [p.x]) if (c < 9) c]) "
             "max(0, noise(p) + 2 * noise(p * 3)) + (p.y > 3 ? sqrt(p.y - 3) : 0) + abs(a[0])"), /* not compiled */
    };
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        Fixture one, many;
        fixture_good(&one, texts[i]);
        build_with_threads(&many, texts[i], 3);
        assert_int_equal(many.status, STATUS_OK);
        const Volume *a = one.scene->volumes[0], *b = many.scene->volumes[0];
        assert_int_equal(a->n_blocks, b->n_blocks);
        assert_true(a->n_blocks > 50);
        assert_memory_equal(a->values, b->values, a->n_blocks * (size_t)VOLUME_BRICK_VALUES * sizeof *a->values);
        for (int32_t k = 0; k < a->n_points[1]; k += 5)
            for (int32_t j = 0; j < a->n_points[0]; j += 3) {
                Vec3 at = vec3(j, k, 7), p = vec3(4.0 * j / 48 - 2, 5.0 * k / 60, 4.0 * 7 / 48 - 2);
                double value = noise_value((const double[3]){p.x, p.y, p.z}, 3) +
                               2 * noise_value((const double[3]){3 * p.x, 3 * p.y, 3 * p.z}, 3);
                value = fmax(value, 0) + (p.y > 3 ? sqrt(p.y - 3) : 0) + fabs(p.x);
                assert_near(volume_at(a, at), value, 1e-5);
            }
        fixture_clear(&one);
        fixture_clear(&many);
    }
}

/* What has no value is reported once, at the first place without, as the evaluation has it. */
static void grids_report_as_the_evaluation_does(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {GRID("def f(p) = sqrt(p.y - 4)"), "sqrt(-4) is no finite number"},
        {GRID("def f(p) = 1 / (p.x * p.x + (p.y - 5) ^ 2)"), "division by zero"},
        {GRID("def f(p) = p.y > 3 ? 1 / 0 : 1"), "division by zero"},
        {GRID("def f(p) = p"), "gives a vector of 3, not a number, at <-2, 0, -2>"},
        {GRID("def f(p) = p.y > 3 ? \"a\" : 1"), "gives a string, not a number, at <-2, 3.08333, -2>"},
        {GRID("def f(p) = 1 - p.y"), "must be 0 or more"},
        {GRID("def f(p) = nothing + p.x"), "unknown name 'nothing'"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++)
        for (unsigned n = 1; n <= 3; n += 2) {
            Fixture f;
            build_with_threads(&f, cases[i][0], n);
            assert_int_equal(f.status, STATUS_SCENE);
            assert_int_equal(f.diag.n_errors, 1);
            Buf out = {0};
            diag_print(&f.diag, &out, false);
            if (!strstr(buf_text(&out), cases[i][1])) fail_msg("%s: %s", cases[i][1], buf_text(&out));
            buf_clear(&out);
            fixture_clear(&f);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(programs_give_what_the_evaluation_gives),
        cmocka_unit_test(registers_are_in_order),
        cmocka_unit_test(formulas_agree_with_patterns),
        cmocka_unit_test(mistakes_are_reported),
        cmocka_unit_test(any_property_takes_one),
        cmocka_unit_test(grids_of_functions),
        cmocka_unit_test(grids_report_as_the_evaluation_does),
        cmocka_unit_test(speed_is_printed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* eval_test.c - what scenes evaluate to: the three example scenes of the language, nodes, instances, defaults,
 * settings, files, parameters, and the functions, with rnd and noise bit for bit.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/hash.h"
#include "lang_fixture.h"

static void expect_fine(Run *run)
{
    if (run->status != STATUS_OK || run->diag.n_warnings) {
        char *reports = run_reports(run);
        print_error("%s", reports);
        free(reports);
    }
    assert_int_equal(run->status, STATUS_OK);
    assert_int_equal(run->diag.n_warnings, 0);
}

static void expect_printed(const char *arguments, const char *text)
{
    Run run;
    Buf scene = {0}, wanted = {0};
    buf_format(&scene, "print(%s)", arguments);
    buf_format(&wanted, "%s\n", text);
    run_text(&run, buf_text(&scene));
    expect_fine(&run);
    assert_string_equal(buf_text(&run.result.printed), buf_text(&wanted));
    buf_clear(&scene);
    buf_clear(&wanted);
    run_close(&run);
}

static const EvalNode *node_at(const Run *run, size_t index)
{
    assert_true(index < run->result.n_nodes);
    return run->result.nodes[index];
}

static const EvalNode *named(const Run *run, const char *name)
{
    for (size_t i = 0; i < run->result.n_nodes; i++)
        if (run->result.nodes[i]->name && strcmp(run->result.nodes[i]->name, name) == 0) return run->result.nodes[i];
    return NULL;
}

static size_t count_type(const Run *run, const char *type)
{
    size_t n = 0;
    for (size_t i = 0; i < run->result.n_nodes; i++) n += strcmp(run->result.nodes[i]->type->name, type) == 0;
    return n;
}

static void run_file(Run *run, const char *path)
{
    run_open(run);
    run->path = path;
    run_go(run);
}

/* ---- the example scenes ---- */

static void test_whisky(void **state)
{
    Run run;
    (void)state;
    run_file(&run, "tests/lang/whisky.mns");
    expect_fine(&run);
    assert_true(run.result.unit_m == 1e-3);
    assert_int_equal(count_type(&run, "sphere"), 60);
    assert_int_equal(count_type(&run, "box"), 3);
    const EvalNode *glass = named(&run, "glass"), *drink = named(&run, "drink"), *tumbler = named(&run, "tumbler");
    assert_non_null(glass);
    assert_string_equal(eval_word(glass, "state"), "solid");
    assert_true(eval_number(glass, "depth") == 80);
    assert_ptr_equal(eval_prop(tumbler, "interior")->as.node, glass);
    assert_int_equal(eval_prop(tumbler, "profile")->as.list.n, 7);
    assert_true(eval_prop(tumbler, "profile")->as.list.numbers[4] == 40);
    assert_true(eval_vector(drink, "to").y == 44 && eval_number(drink, "radius") == 37.1);
    const EvalProp *absorption = eval_prop(named(&run, "ice"), "absorption");
    assert_int_equal(absorption->as.spectrum.form, SPECTRUM_VECTOR);
    assert_true(absorption->as.spectrum.rgb[0] == .4 / 1000);
    size_t cubes = 0;
    for (size_t i = 0; i < run.result.n_nodes; i++) {
        const EvalNode *node = node_at(&run, i);
        if (strcmp(node->type->name, "box") != 0) continue;
        static const Vec3 at[] = {{-11, 32, 5}, {12, 35, -7}, {2, 50, 3}};
        assert_non_null(node->prototype);
        assert_ptr_equal(node->props, node->prototype->props);
        assert_true(node->transform.t.x == at[cubes].x && node->transform.t.y == at[cubes].y);
        assert_true(fabs(affine_determinant(&node->transform) - 1) < 1e-12);
        cubes++;
    }
    assert_int_equal(run.result.n_params, 1);
    assert_string_equal(run.result.params[0].name, "level");
    assert_string_equal(run.result.params[0].value, "34");
    assert_string_equal(run.result.params[0].doc, "whisky height above the glass base");
    run_close(&run);
}

static void test_aquarium(void **state)
{
    Run run;
    (void)state;
    run_file(&run, "tests/lang/aquarium.mns");
    expect_fine(&run);
    assert_int_equal(count_type(&run, "sphere"), 120);
    assert_int_equal(count_type(&run, "mesh"), 15);
    const EvalNode *water = named(&run, "water"), *tank = named(&run, "tank");
    assert_int_equal(tank->n_children, 5);
    const EvalProp *ior = eval_prop(water, "ior");
    assert_int_equal(ior->as.spectrum.form, SPECTRUM_TERM);
    assert_string_equal(ior->as.spectrum.term->type->name, "cauchy");
    assert_true(ior->as.spectrum.term->args[0] == 1.3239 && ior->as.spectrum.term->args[1] == 3.1e-3);
    const EvalProp *expect = eval_prop(named(&run, "diver"), "expect");
    assert_int_equal(expect->as.list.n, 1);
    assert_ptr_equal(expect->as.list.nodes[0], water);
    run_close(&run);
}

static void test_soda(void **state)
{
    Run run;
    static const char *const defines[] = {"count=20"};
    (void)state;
    run_open(&run);
    run.path = "tests/lang/soda.mns";
    run.options.defines = defines;
    run.options.n_defines = 1;
    run.options.preset = "draft";
    run_go(&run);
    expect_fine(&run);
    assert_int_equal(count_type(&run, "group"), 72);
    assert_true(count_type(&run, "sphere") > 10 && count_type(&run, "sphere") <= 20);
    assert_int_equal(count_type(&run, "lathe"), 1); /* the macro of the library */
    assert_int_equal(count_type(&run, "render"), 1);
    for (size_t i = 0; i < run.result.n_nodes; i++) {
        const EvalNode *node = node_at(&run, i);
        if (strcmp(node->type->name, "render") == 0) {
            assert_true(eval_number(node, "samples") == 32 && eval_number(node, "noise") == .015);
        }
        if (strcmp(node->type->name, "film") == 0) {
            assert_true(eval_vector(node, "size").x == 270);
            assert_string_equal(eval_prop(node, "output")->as.list.texts[0], "soda.####.exr");
        }
    }
    assert_string_equal(buf_text(&run.result.printed), "large bubbles: 2\n");
    run_close(&run);
}

/* ---- nodes ---- */

static void test_instances(void **state)
{
    Run run;
    (void)state;
    run_text(
        &run,
        "medium glass { ior = 1.5 } let ball = sphere { radius = 2  translate(x) }\n"
        "ball { scale(3) } ball { interior = glass } ball wide { radius = 5 } wide { translate(y) }\n"
        "let pair = group { ball { } ball { translate(z) } } pair { rotate(z, 90) } pair { sphere { radius = 1 } }");
    expect_fine(&run);
    const EvalNode *scaled = node_at(&run, 2), *filled = node_at(&run, 3), *wide = node_at(&run, 4);
    assert_non_null(scaled->prototype);
    assert_null(scaled->name);
    assert_string_equal(scaled->prototype->name, "ball");
    assert_true(scaled->transform.t.x == 3 && scaled->transform.m[1][1] == 3); /* the prototype's first */
    assert_ptr_equal(filled->prototype, scaled->prototype);                    /* interior is no shape */
    assert_int_equal(filled->n_props, 2);
    assert_string_equal(filled->props[0].type->name, "interior"); /* in table order */
    assert_null(wide->prototype);
    assert_true(eval_number(wide, "radius") == 5 && wide->transform.t.x == 1);
    assert_ptr_equal(node_at(&run, 5)->prototype, wide);
    const EvalNode *pair = node_at(&run, 6), *more = node_at(&run, 7);
    assert_int_equal(pair->n_children, 2);
    assert_ptr_equal(pair->children, pair->prototype->children);
    assert_int_equal(more->n_children, 3);
    assert_null(more->prototype);
    run_close(&run);
}

static void test_transforms(void **state)
{
    Run run;
    (void)state;
    run_text(&run, "sphere { radius = 1  translate(x) rotate(z, 90) scale(<1, 2, 1>) }\n"
                   "let turn = transform(translate(x), rotate(z, 90)) sphere { radius = 1  transform(turn) }\n"
                   "sphere { radius = 1  matrix(y, -x, z, <1, 2, 3>) }\n"
                   "print(apply(turn, <1, 0, 0>), apply(inverse(turn), <0, 2, 0>), apply(turn * turn, 0 * x))\n"
                   "print(apply(rotate(<90, 90, 0>), y), apply(rotate(x, 90), y), apply(rotate(y, 90), z))");
    expect_fine(&run);
    Vec3 t = node_at(&run, 1)->transform.t, u = node_at(&run, 2)->transform.t;
    assert_true(t.x == 0 && t.y == 2 && u.x == 0 && u.y == 1);
    Vec3 p = affine_point(&node_at(&run, 3)->transform, vec3(1, 1, 1));
    assert_true(p.x == 0 && p.y == 3 && p.z == 4);
    assert_string_equal(buf_text(&run.result.printed), "<0, 2, 0><1, 0, 0><-1, 1, 0>\n<1, 0, 0><0, 0, 1><1, 0, 0>\n");
    run_close(&run);
}

/* The memory of a transform that only places a node is used again; a transform that is kept must not change by that. */
static void test_kept_transforms(void **state)
{
    Run run;
    (void)state;
    run_text(&run,
             "let kept = translate(x) let list = [translate(2 * x), scale(2)] def shift(n) = translate(<n, 0, 0>)\n"
             "def row() { for (i in 1..3) { let own = shift(i) sphere { radius = 1 translate(y) transform(own) "
             "transform(own) } } }\n"
             "sphere { radius = 1 translate(z) } sphere { radius = 1 transform(kept) translate(z) transform(kept) }\n"
             "sphere { radius = 1 transform(list[0]) shift(5) transform(list[0]) } row()\n"
             "sphere { radius = 1 rotate(z, 90) transform(kept) translate(x) }\n"
             "print(apply(kept, y), apply(list[0], y), apply(list[1], y))");
    expect_fine(&run);
    const double x[] = {0, 2, 9, 2, 4, 6, 2};
    for (size_t i = 0; i < COUNT_OF(x); i++) {
        double found = node_at(&run, i + 1)->transform.t.x; /* the first node is the air */
        if (found != x[i]) fail_msg("node %zu stands at x = %g, not %g", i, found, x[i]);
    }
    assert_string_equal(buf_text(&run.result.printed), "<1, 1, 0><2, 1, 0><0, 2, 0>\n");
    run_close(&run);
}

static void test_defaults_and_none(void **state)
{
    Run run;
    (void)state;
    run_text(&run,
             "def plain() { sphere { radius = 9 } } medium glass { ior = 1.5 }\n"
             "defaults sphere { radius = 4  interior = glass } sphere { }\n"
             "group { defaults sphere { radius = 5 } sphere { } plain() } sphere { radius = 6  interior = none }\n"
             "render { nesting = none }");
    expect_fine(&run);
    assert_true(eval_number(node_at(&run, 2), "radius") == 4);
    const EvalNode *group = node_at(&run, 3);
    assert_true(eval_number(group->children[0], "radius") == 5);
    assert_non_null(eval_prop(group->children[0], "interior")); /* from the outer defaults */
    assert_null(eval_prop(group->children[1], "interior"));     /* the macro was written before them */
    assert_null(eval_prop(node_at(&run, 4), "interior"));
    assert_string_equal(eval_word(node_at(&run, 5), "nesting"), "none");
    run_close(&run);
}

static void test_default_texts(void **state)
{
    Run run;
    (void)state;
    run_text(&run, "sphere { radius = 1 } camera { from = x  to = y } render { } mesh { }");
    expect_fine(&run);
    assert_true(eval_vector(node_at(&run, 1), "center").x == 0);
    assert_true(eval_number(node_at(&run, 2), "fov") == 40);
    assert_true(eval_number(node_at(&run, 3), "samples") == 256);
    assert_string_equal(eval_word(node_at(&run, 3), "nesting"), "automatic");
    assert_false(eval_truth(node_at(&run, 4), "closed"));
    assert_null(eval_prop(node_at(&run, 4), "file"));
    run_close(&run);
}

static void test_macros(void **state)
{
    Run run;
    (void)state;
    run_text(&run, "def row(n) { for (i in 0..<n) { group { translate(<i, 0, 0>) children() } } }\n"
                   "def outer(n) { row(n) { children() } }\n"
                   "outer(3) { sphere { radius = 1 } }\n"
                   "def ball(r = 1) { sphere { radius = r } } ball { r = 4  translate(y) } ball b { } b { scale(2) }\n"
                   "def made(r) = sphere { radius = r } made(7)\n"
                   "def fact(n) = n < 2 ? 1 : n * fact(n - 1) print(fact(10))\n"
                   "def even(n) = n == 0 or odd(n - 1) def odd(n) = n > 0 and even(n - 1) print(even(100))\n"
                   "def nest(n) { def inner(k) = n * 10 + k  print(inner(1)) if (n > 0) { nest(n - 1) } } nest(1)");
    expect_fine(&run);
    assert_int_equal(count_type(&run, "group"), 3);
    assert_int_equal(node_at(&run, 3)->n_children, 1);
    assert_true(node_at(&run, 3)->transform.t.x == 2);
    assert_true(eval_number(node_at(&run, 4), "radius") == 4 && node_at(&run, 4)->transform.t.y == 1);
    assert_string_equal(node_at(&run, 5)->name, "b");
    assert_ptr_equal(node_at(&run, 6)->prototype, node_at(&run, 5));
    assert_true(eval_number(node_at(&run, 7), "radius") == 7);
    assert_string_equal(buf_text(&run.result.printed), "3628800\ntrue\n11\n1\n");
    /* a sphere made by a macro within a macro knows where it came from */
    const DiagChain *chain = node_at(&run, 4)->chain;
    assert_non_null(chain);
    assert_string_equal(chain->what, "in def 'ball', called from");
    run_close(&run);
}

static void test_words(void **state)
{
    Run run;
    (void)state;
    run_text(&run,
             "let gas = \"liquid\" let form = \"solid\" medium a { state = gas } medium b { state = form }\n"
             "medium c { state = \"gas\" } film { aovs = [albedo, \"normal\"]  output = [\"a.exr\", \"b.png\"] }");
    assert_int_equal(run.status, STATUS_OK);
    assert_string_equal(eval_word(named(&run, "a"), "state"), "gas"); /* the property's own word wins */
    assert_string_equal(eval_word(named(&run, "b"), "state"), "solid");
    assert_string_equal(eval_prop(node_at(&run, 4), "aovs")->as.list.texts[0], "albedo");
    assert_int_equal(eval_prop(node_at(&run, 4), "output")->as.list.n, 2);
    run_close(&run);
}

/* ---- functions ---- */

static void test_functions(void **state)
{
    (void)state;
    expect_printed("[sin(30), sin(180), cos(90), cos(60), tan(45), sin(-90), cos(720), sin(390)]",
                   "[0.5, 0, 0, 0.5, 1, -1, 1, 0.5]");
    expect_printed("[round(asin(1)), round(acos(-1)), atan2(1, 1), atan(1)]", "[90, 180, 45, 45]");
    expect_printed("[sqrt(16), abs(-2), floor(-1.5), ceil(1.2), round(2.5), frac(-.25), sign(-3)]",
                   "[4, 2, -2, 2, 3, 0.75, -1]");
    expect_printed("abs(<-1, 2, -3>)", "<1, 2, 3>");
    expect_printed("[min(3, 1, 2), max([4, 9, 2]), min(1..5), clamp(7, 0, 5), mix(2, 4, .5), smoothstep(0, 2, 1)]",
                   "[1, 9, 1, 5, 3, 0.5]");
    expect_printed("mix(<0, 0, 0>, <2, 4, 6>, .5)", "<1, 2, 3>");
    expect_printed("[length(<3, 4>), distance(<1, 1>, <4, 5>), dot(<1, 2, 3>, <4, 5, 6>)]", "[5, 5, 32]");
    expect_printed("cross(x, y), normalize(<0, 3, 4>)", "<0, 0, 1><0, 0.6, 0.8>");
    expect_printed("[len([1, 2]), len(1..7), len(<1, 2, 3>), len(\"élan\"), sum(1..100)]", "[2, 7, 3, 4, 5050]");
    expect_printed("vec3(1), vec3(<1, 2>, 3), vec2(4, 5), vec4(1, 2, 3, 4), vec3(#fff)",
                   "<1, 1, 1><1, 2, 3><4, 5><1, 2, 3, 4><1, 1, 1>");
    expect_printed("rgb(.5), rgb(1, 2, 3) * 2, #000 + .5", "rgb(0.5, 0.5, 0.5)rgb(2, 4, 6)rgb(0.5, 0.5, 0.5)");
    expect_printed("srgb(1, 0, 1) == #f0f, #fff.r, rgb(1, 2, 3).bgr", "true1rgb(3, 2, 1)");
    expect_printed("\"a\" + \"b\" + str(1, <2, 3>), none, true, cauchy(1.3, 2)", "ab1<2, 3>nonetruecauchy(1.3, 2)");
    expect_printed("[1, 2] + [3] == (1..3), \"a\" < \"b\", mod(-1, 3), pow(2, 10), exp(0), log(1), log10(1000)",
                   "truetrue21024103");
    expect_printed("clock, frame, frames, time, x, pi", "0110<1, 0, 0>3.141592653589793");
}

static void test_hues(void **state)
{
    (void)state;
    expect_printed("[hsv(0, 1, 1) == #f00, hsv(60, 1, 1) == #ff0, hsv(120, 1, 1) == #0f0, hsv(180, 1, 1) == #0ff]",
                   "[true, true, true, true]");
    expect_printed("[hsv(240, 1, 1) == #00f, hsv(-60, 1, 1) == #f0f, hsv(720, 1, 1) == #f00, hsv(7, 1, 0) == #000]",
                   "[true, true, true, true]");
    expect_printed(
        "[hsv(30, 1, 1) == srgb(1, .5, 0), hsv(210, .5, .5) == srgb(.25, .375, .5), hsv(1, 0, .5) == srgb(.5)]",
        "[true, true, true]");
    expect_printed(
        "[hsl(0, 1, .5) == #f00, hsl(99, 1, 1) == #fff, hsl(99, 1, 0) == #000, hsl(240, 1, .75) == srgb(.5, .5, 1)]",
        "[true, true, true, true]");
    expect_printed("[hsl(210, .5, .25) == srgb(.125, .25, .375), hsl(9, 0, .5) == srgb(.5)]", "[true, true]");
}

static void test_lists_in_order(void **state)
{
    (void)state;
    expect_printed("sort([3, -1, 2.5, -1]), sort(5..1 by -2), sort([])", "[-1, -1, 2.5, 3][1, 3, 5][]");
    expect_printed("sort([\"b\", \"é\", \"a\", \"B\", \"ab\"])", "[\"B\", \"a\", \"ab\", \"b\", \"é\"]");
    expect_printed("reverse(1..4), reverse([\"a\", 1, <1, 2>]), reverse([]), reverse(sort([2, 7, 5]))",
                   "[4, 3, 2, 1][<1, 2>, 1, \"a\"][][7, 5, 2]");
    expect_printed(
        "[product(1..5), product([]), product([.5])], product([<1, 2>, <3, 4>]), product([#fff, rgb(.5, .2, .1)])",
        "[120, 1, 0.5]<3, 8>rgb(0.5, 0.2, 0.1)");
    expect_printed("(1 / sort([0, 4])[1]), sort([for (i in 1..300) i * 7 % 300])[299], len(sort(1..1000))",
                   "0.252991000");
}

static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static double noise_at(uint64_t whole)
{
    return 2 * hash_to_unit(hash_u64(0x6e6f697365U ^ whole)) - 1;
}

static void test_rnd_and_noise(void **state)
{
    Run run;
    (void)state;
    run_text(&run,
             "sphere { radius = 1  center = <rnd(7, 3), rnd(7, 3, -0.0), rnd(<7, 3, 0>)> }\n"
             "sphere { radius = 1  center = <noise(4), noise(4.5), noise(1.25, -2.5, 3)> }\n"
             "var least = 1 var most = 0 for (i in 1..5000) { least := min(least, rnd(i)) most := max(most, rnd(i)) }\n"
             "print(least < .001, most > .999, least >= 0, most < 1)");
    expect_fine(&run);
    uint64_t h = hash_u64(hash_u64(0x6d656e6973637573U ^ bits_of(7)) ^ bits_of(3));
    Vec3 random = eval_vector(node_at(&run, 1), "center"), noise = eval_vector(node_at(&run, 2), "center");
    assert_true(random.x == hash_to_unit(h));
    h = hash_u64(h ^ bits_of(0));
    assert_true(random.y == hash_to_unit(h) && random.z == hash_to_unit(h));
    double beyond = (noise_at(4) - .8) / .2;
    assert_true(beyond > 0);
    assert_true(noise.x == .8 + .2 * (beyond / sqrt(1 + beyond * beyond)));
    assert_true(fabs(noise.y - (9 * (noise_at(4) + noise_at(5)) - noise_at(3) - noise_at(6)) / 16) < 1e-15);
    assert_true(fabs(noise.z) < 1);
    assert_string_equal(buf_text(&run.result.printed), "truetruetruetrue\n");
    run_close(&run);
}

static void test_working_space(void **state)
{
    Run run;
    static const double swap[9] = {0, 0, 1, 0, 1, 0, 1, 0, 0}; /* red and blue change places */
    (void)state;
    run_open(&run);
    memcpy(run.options.srgb_to_working, swap, sizeof swap);
    run.text = "meniscus 1.0 unit mm print(#ff0000, srgb(1, 0, 0), rgb(1, 0, 0), hsv(0, 1, 1))";
    run_go(&run);
    expect_fine(&run);
    assert_string_equal(buf_text(&run.result.printed), "rgb(0, 0, 1)rgb(0, 0, 1)rgb(1, 0, 0)rgb(0, 0, 1)\n");
    run_close(&run);
}

/* ---- files, parameters, settings ---- */

static void test_files(void **state)
{
    Run run;
    (void)state;
    run_file(&run, "tests/lang/imports.mns");
    expect_fine(&run);
    assert_string_equal(buf_text(&run.result.printed), "used once\nincluded\nincluded\n5 6 7\n");
    assert_int_equal(count_type(&run, "sphere"), 3); /* two by include, one by the macro; none by use */
    assert_int_equal(run.result.n_files, 3);
    assert_string_equal(run.result.files[0], "tests/lang/imports.mns");
    for (size_t i = 0; i < run.result.n_nodes; i++)
        if (strcmp(node_at(&run, i)->type->name, "render") == 0) {
            assert_true(eval_number(node_at(&run, i), "samples") == 64); /* the later one overrides */
            assert_true(eval_number(node_at(&run, i), "bounces") == 5);  /* and adds */
        }
    run_close(&run);
}

static void test_params(void **state)
{
    Run run;
    static const char *const defines[] = {"level=2cm",   "mode=fine", "tone=.5",
                                          "many=[1, 2]", "kind=none", "answer=true"};
    (void)state;
    run_open(&run);
    run.options.defines = defines;
    run.options.n_defines = COUNT_OF(defines);
    run.text =
        "meniscus 1.0 unit mm param level = 34mm in 5mm..60mm param mode = \"coarse\" in [\"coarse\", \"fine\"]\n"
        "param tone: color = #000 param many: list = [] \"a list\" param kind = \"\" param answer = \"no\"\n"
        "print(level, mode, tone, many, kind, answer)";
    run_go(&run);
    expect_fine(&run);
    assert_string_equal(buf_text(&run.result.printed), "20finergb(0.5, 0.5, 0.5)[1, 2]nonetrue\n");
    assert_int_equal(run.result.n_params, 6);
    assert_string_equal(run.result.params[1].value, "\"fine\"");
    run_close(&run);
}

static void test_animation_names(void **state)
{
    Run run;
    (void)state;
    run_open(&run);
    run.options.clock = .25;
    run.options.frame = 31;
    run.options.frames = 120;
    run.options.time = 1.25;
    run.text = "meniscus 1.0 print(clock, \" \", frame, \" \", frames, \" \", time) let clock = 3 print(clock)";
    run_go(&run);
    expect_fine(&run);
    assert_true(run.result.unit_m == 1);
    assert_string_equal(buf_text(&run.result.printed), "0.25 31 120 1.25\n3\n");
    run_close(&run);
}

static void test_missing_scene(void **state)
{
    Run run;
    (void)state;
    run_file(&run, "tests/lang/no-such-scene.mns");
    assert_int_equal(run.status, STATUS_INPUT);
    assert_non_null(strstr(run.error.text, "no-such-scene"));
    run_close(&run);
}

/* Loops over numbers take no memory. */
static void test_memory_of_loops(void **state)
{
    Run run;
    (void)state;
    run_text(&run, "var s = 0 for (i in 1..200000) { s := s + i * 2 } print(s)");
    expect_fine(&run);
    assert_string_equal(buf_text(&run.result.printed), "40000200000\n");
    assert_true(run.arena.total < 1000000); /* loops leave nothing behind */
    run_close(&run);
}

/* A list that grows by an element at a time takes memory in proportion to its length; and is never changed: what begins with it
 * goes its own way. */
static void test_lists_that_grow(void **state)
{
    (void)state;
    static const char *const elements[] = {"i", "<i, 0, 0>", "[i]", "translate(i * x)", "\"a\""};
    for (size_t k = 0; k < COUNT_OF(elements); k++) {
        Run run;
        Buf text = {0};
        buf_format(&text, "var l = [] for (i in 0..<20000) { l := l + [%s] } print(len(l))", elements[k]);
        run_text(&run, buf_text(&text));
        expect_fine(&run);
        assert_string_equal(buf_text(&run.result.printed), "20000\n");
        assert_true(run.arena.total < 40000000);
        run_close(&run);
        buf_clear(&text);
    }
    expect_printed(
        "let (a = [1, 2] + [3], b = a + [4], c = a + [5], d = b + [6], e = b + [7, 8], f = a + a) [a, b, c, d, e, f]",
        "[[1, 2, 3], [1, 2, 3, 4], [1, 2, 3, 5], [1, 2, 3, 4, 6], [1, 2, 3, 4, 7, 8], [1, 2, 3, 1, 2, 3]]");
    expect_printed(
        "let (a = [[1]] + [[2]], b = a + [[3]], c = a + [4], d = b + [[[5]]], e = b + [x]) [a, b, c, d, len(e)]",
        "[[[1], [2]], [[1], [2], [3]], [[1], [2], 4], [[1], [2], [3], [[5]]], 4]");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lists_that_grow),
        cmocka_unit_test(test_whisky),
        cmocka_unit_test(test_aquarium),
        cmocka_unit_test(test_soda),
        cmocka_unit_test(test_instances),
        cmocka_unit_test(test_transforms),
        cmocka_unit_test(test_kept_transforms),
        cmocka_unit_test(test_defaults_and_none),
        cmocka_unit_test(test_default_texts),
        cmocka_unit_test(test_macros),
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_functions),
        cmocka_unit_test(test_hues),
        cmocka_unit_test(test_lists_in_order),
        cmocka_unit_test(test_rnd_and_noise),
        cmocka_unit_test(test_working_space),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_params),
        cmocka_unit_test(test_animation_names),
        cmocka_unit_test(test_missing_scene),
        cmocka_unit_test(test_memory_of_loops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

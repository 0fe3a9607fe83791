/* motion_test.c - how a scene's motion is found: what moves, what is told apart by its place in the text, what cannot
 * be blurred, and meshes that are given a frame later.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "scene_fixture.h"

#define CAMERA(shutter) " camera { from = <0, 0, 1000>  to = <0, 0, 0>  " shutter " } "
#define VIEW(shutter) CAMERA(shutter) "environment { } "
#define HALF VIEW("shutter = 180deg  shutter_steps = 2")

static const Affine *keys_of(const Fixture *scene, uint32_t object)
{
    const Affine *keys = scene_keys(scene->scene, &scene->scene->objects[object]);
    assert_non_null(keys);
    return keys;
}

static void places_follow_the_clock(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(&scene, FIXTURE_MEDIA
                 "sphere { interior = glass  center = <8 * clock, 0, 0> } sphere { interior = ice } "
                 "for (i in 1..3) { if (i > 2 * clock) { sphere { interior = gas  center = <i, clock, 0> } } }" HALF);
    const Scene *s = scene.scene;
    assert_int_equal(s->n_keys, 3);
    assert_near(s->shutter, 0.5, 0);
    const Affine *keys = keys_of(&scene, 0);
    assert_near(keys[0].t.x, 0, 0);
    assert_near(keys[1].t.x, 2, 1e-12);
    assert_near(keys[2].t.x, 4, 1e-12);
    assert_int_equal(s->objects[1].motion, SCENE_NONE);
    /* the third turn of the loop is the third, whether the first is there or not; what goes stays where it was */
    for (uint32_t i = 0; i < 3; i++) {
        keys = keys_of(&scene, 2 + i);
        assert_near(keys[2].t.x, i + 1.0, 0);
        assert_near(keys[1].t.y, 0.25, 1e-12);
        assert_near(keys[2].t.y, i == 0 ? 0.25 : 0.5, 1e-12);
    }
    fixture_clear(&scene);
}

static void without_a_shutter_nothing_moves(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(&scene, FIXTURE_MEDIA "sphere { interior = glass  center = <clock, 0, 0> }" VIEW(""));
    assert_int_equal(scene.scene->n_keys, 0);
    fixture_clear(&scene);
    fixture_good(&scene, FIXTURE_MEDIA "sphere { interior = glass  center = <1, 0, 0> }" HALF);
    assert_int_equal(scene.scene->n_keys, 0);
    fixture_clear(&scene);
}

/* Cells of a height field are cut by their heights; as it moves, they stay as they were cut at first. */
static void height_fields_deform(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(&scene, FIXTURE_MEDIA
                 "height_field { interior = glass  base = -5  size = <3, 1, 3> "
                 "heights = [for (j in 0..5) [for (i in 0..5) cos(90 * i + 70 * j + 500 * clock)]] }" HALF);
    const SceneShape *shape = &scene.scene->shapes[scene.scene->objects[0].shape];
    assert_non_null(shape->mesh_end);
    assert_int_equal(scene.diag.n_warnings, 0);
    assert_true(mesh_same_triangles(shape->mesh, shape->mesh_end));
    assert_near((double)shape->mesh->positions[0].y, 1, 1e-6);
    assert_near((double)shape->mesh_end->positions[0].y, cos(250 * 3.14159265358979 / 180), 1e-6);
    fixture_clear(&scene);
    fixture_good(&scene, FIXTURE_MEDIA "height_field { interior = glass  base = -5  size = <3, 1, 3> "
                                       "heights = [for (j in 0..5) [for (i in 0..(clock > 0 ? 2 : 5)) 1]] }" HALF);
    assert_null(scene.scene->shapes[scene.scene->objects[0].shape].mesh_end);
    assert_int_equal(scene.diag.n_warnings, 1);
    fixture_clear(&scene);
}

static void meshes_deform_and_cones_do_not(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(&scene,
                 FIXTURE_MEDIA "mesh { interior = glass  triangles = [<0, 1, 2>, <0, 3, 1>, <1, 3, 2>, <2, 3, 0>]"
                               "  positions = [<0, 0, 0>, <1, 0, 0>, <0, 0, 1>, <0, 1 + clock, 0>] }"
                               "cone { interior = ice  to = <0, 5 + clock, 0> }" HALF);
    const Scene *s = scene.scene;
    const Mesh *end = s->shapes[s->objects[0].shape].mesh_end;
    assert_non_null(end);
    assert_near((double)end->positions[3].y, 1.5, 1e-6);
    assert_null(s->shapes[s->objects[1].shape].mesh_end);
    assert_true(fixture_find(&scene, D_SHAPE_CHANGES) != NULL);
    assert_int_equal(scene.diag.n_warnings, 1);
    fixture_clear(&scene);
}

#define BALL(surface) "sphere ball { surface = surface { " surface " } } environment { } "
#define CLOUD(volume)                                                                                                  \
    "medium m { ior = 1  absorption = 1  density = " volume " } sphere { interior = m } environment { } "
/* What the clock changes. */
static const struct {
    const char *text, *told; /* a part of the message; NULL: there is none */
} changes[] = {
    {"medium m { ior = 1 + clock } sphere { interior = m } environment { }", "medium m"},
    {"medium m { ior = 1 + clock } sphere { interior = m } if (clock > .1) { sphere { interior = glass  center = "
     "<9, 0, 0> } }"
     "medium n { ior = 2 } environment { }",
     "medium m"},
    {"sphere { interior = clock < .2 ? glass : ice } sphere { interior = glass  center = <9, 0, 0> } environment { "
     "}",
     "medium"},
    {"if (clock < .2) { sphere { interior = glass } } else { sphere { interior = glass } } environment { }", NULL},
    {"sphere ball { interior = glass  priority = clock < .2 ? 1 : 2 } environment { }", "the priority of ball"},
    {BALL("albedo = .5 + clock / 2"), "'albedo' of ball"},
    /* numbers that are not taken any more, later on, are the nearest that are */
    {BALL("albedo = .7 + clock"), "'albedo' of ball"},
    {BALL("albedo = 1 - 2.1 * clock"), "'albedo' of ball"},
    {"sphere ball { radius = .4 - clock  surface = surface { } } environment { }", NULL},
    {"light lamp { shape = sphere  from = y  radius = 1  radiance = .4 - clock } sphere { interior = glass } "
     "environment { }",
     "what shines of lamp"},
    {BALL("albedo = .5  ior = 1.5  roughness = clock < .2 ? .1 : clock > .4 ? .1 : .3"), "'roughness' of ball"},
    {BALL("albedo = clock < .2 ? noise { } : .5"), "'albedo' of ball"},
    {BALL("mix = [surface { albedo = .2 }, surface { albedo = .2 + clock }]"), "'albedo' of ball"},
    {BALL("albedo = .5  emission = #fff  radiance = 1 + clock"), "'emission' of ball"},
    {BALL("albedo = .5  bump = noise { }  bump_height = .1 + clock"), "'bump_height' of ball"},
    {BALL("albedo = clock < .2 ? noise { } : wood { }"), "'albedo' of ball: its texture"},
    {BALL("albedo = noise { octaves = clock < .2 ? 1 : 2 }"), "'albedo' of ball: its texture"},
    {BALL("albedo = wood { seed = clock < .2 ? 1 : 2 }"), "'albedo' of ball: its texture"},
    {"def f(p) = clock < .2 ? .5 : .5 + .1 * sin(p.x) " BALL("albedo = f"), "'albedo' of ball: its texture"},
    {BALL("albedo = mix { blend = clock < .2 ? spots { } : wood { } }"), "'albedo' of ball: its texture"},
    {"light { shape = spot  from = y  to = -y  angle = 30 + 60 * clock }", "what shines of light"},
    {"light { shape = distant  from = <clock, 1, 0>  to = <0, 0, 0> }", "what shines of light"},
    {"light { from = y  to = <clock - .1, 0, 0>  profile = \"tests/unit/lamp.ies\"  shape = point  power = 1 }",
     "the turn about its own axis of light"},
    {"light { from = y  to = <clock - .1, 0, 0>  profile = \"tests/unit/lamp_quarter.ies\"  shape = point  power = "
     "1 }",
     NULL},
    {"sphere { interior = glass } environment { sky = clear  azimuth = 90 * clock  disc = false }", "the environment"},
    {"sphere { interior = glass } environment { color = .5 + clock }", "the environment"},
    {"sphere { interior = glass } environment { rotate(y, 90 * clock) }", "the environment"},
    {"def f(p) = 1 + clock " CLOUD("volume { function = f }"), "the density of m"},
    {"def f(p) = 1 " CLOUD("volume { function = f  cells = 8 + 8 * clock }"), "the density of m"},
    {"def f(p) = 1 " CLOUD("volume { function = f  scale = 1 + clock }"), "the density of m"},
    {"def f(p) = 999 medium m { ior = 1  emission = blackbody(1500)  temperature = volume { function = f  scale = "
     "1 + clock } }"
     "sphere { interior = m } environment { }",
     "the temperature of m"},
    /* what is blurred is no change */
    {"def f(p) = 1 medium m { ior = 1  absorption = 1  density = volume { function = f  translate(<clock, 0, 0>) } "
     "}"
     "sphere { interior = m  center = <clock, 0, 0> }"
     "sphere { surface = surface { albedo = noise { } }  center = <clock, 0, 0> }"
     "sphere { surface = surface { ior = 1.5  roughness = gradient { phase = clock  to = clock } } }"
     "light { shape = spot  from = y  to = <clock, -1, 0> } light { shape = distant  from = y  to = -y }"
     "environment { sky = clear }",
     NULL},
    {"def f(p) = max(0, .5 + .3 * sin(90 * p.x + clock)) " BALL("albedo = f"), NULL},
    /* nor is what comes or goes */
    {"if (clock < .25) { sphere { surface = surface { albedo = .1 } } } sphere { interior = glass } environment { "
     "}",
     NULL},
};

/* What is blurred are places, and numbers of textures: of all else that the clock changes it is told that it stays. */
static void other_values_stay_and_are_told(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(changes); i++) {
        char text[1000];
        Fixture scene;
        snprintf(text, sizeof text, FIXTURE_MEDIA "%s" CAMERA("shutter = 180deg  shutter_steps = 2"), changes[i].text);
        fixture_good(&scene, text);
        const Diagnostic *report = fixture_find(&scene, D_VALUE_CHANGES);
        if ((report != NULL) != (changes[i].told != NULL))
            fail_msg("%s: %s", changes[i].text, report ? report->text : "-");
        if (report && !strstr(report->text, changes[i].told)) fail_msg("%s: %s", changes[i].text, report->text);
        fixture_clear(&scene);
    }
}

/* A fade that ends with the clock goes on beyond it while the last frame's shutter is open, and so does a way. */
static void beyond_the_end_of_a_fade_things_move_on(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(&scene, FIXTURE_MEDIA
                 "sphere ball { surface = surface { albedo = .7 + clock  }  center = <8 * clock, 0, 0> } "
                 "sphere { surface = surface { albedo = gradient { from = .7 + clock  to = .1 } } }" HALF);
    assert_near(keys_of(&scene, 0)[2].t.x, 4, 1e-12);
    assert_non_null(fixture_find(&scene, D_VALUE_CHANGES));
    fixture_clear(&scene);
}

static void shapes_that_come_back_are_told(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(&scene, FIXTURE_MEDIA "cone { interior = ice  to = <0, 5 + sin(720 * clock), 0> }" CAMERA(
                             "shutter = 180deg  shutter_steps = 4") "environment { }");
    assert_non_null(fixture_find(&scene, D_SHAPE_CHANGES));
    fixture_clear(&scene);
}

/* A sphere whose centre moves goes through the texture of its node; one that its node moves takes it along. Each has a
 * frame of its own, also where they shared one at first. */
static void textures_are_where_their_node_is(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(
        &scene, FIXTURE_MEDIA
        "let s = surface { albedo = noise { } }"
        "sphere { surface = s } sphere { surface = s  center = <clock, 0, 0> }"
        "sphere { surface = s  center = <2 * clock, 0, 0> } sphere { surface = s  rotate(y, 100 * clock) }" HALF);
    const Scene *s = scene.scene;
    for (uint32_t i = 0; i < 4; i++) {
        const Affine *keys = scene_motion(s, s->texture_frames[s->objects[i].texture_frame].motion);
        assert_true((keys != NULL) == (i == 1 || i == 2));
        if (keys) assert_near(keys[2].t.x, 0.5 * i, 1e-12);
    }
    fixture_clear(&scene);
}

/* A number of a texture half-way through the shutter, which is open from clock 0 to 1/2. */
static void numbers_of_textures_are_between_keys(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(&scene, FIXTURE_MEDIA "def f(p) = max(0, p.x + clock) "
                                       "sphere { radius = .3  surface = surface { albedo = f } } sphere { surface = "
                                       "surface { albedo = gradient { from = clock  to = 1 } } }" CAMERA(
                                           "shutter = 180deg  shutter_steps = 1") "environment { }");
    const Scene *s = scene.scene;
    assert_int_equal(s->n_keys, 2);
    TexturePlace at = {.object = {0.2, 0, 0}, .object_normal = {0, 1, 0}, .time = 0.5};
    Lanes nm = lanes_all(550);
    uint32_t function = s->surfaces[s->objects[0].surface].textures[0].texture;
    assert_near((double)lanes_get(texture_at(s->textures, function, &at, nm), 0), 0.45, 1e-6);
    at.object.x = -0.3; /* below 0 until the clock is .3 */
    assert_near((double)lanes_get(texture_at(s->textures, function, &at, nm), 0), 0, 1e-6);
    at.time = 1;
    assert_near((double)lanes_get(texture_at(s->textures, function, &at, nm), 0), 0.2, 1e-6);
    uint32_t gradient = s->surfaces[s->objects[1].surface].textures[0].texture;
    at = (TexturePlace){.object = {0.5, 0, 0}, .object_normal = {0, 1, 0}, .time = 0.5};
    assert_near((double)lanes_get(texture_at(s->textures, gradient, &at, nm), 0), 0.625, 1e-3);
    fixture_clear(&scene);
}

static Vec3 first_axis(const Affine *map)
{
    return vec3(map->m[0][0], map->m[1][0], map->m[2][0]);
}

/* A lamp that hangs straight may be turned about itself by its node; before it begins to turn it hangs as it does then. */
static void hanging_lamps_turn_as_they_are_turned(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(&scene, FIXTURE_MEDIA
                 "light { from = 0 * y  to = -y  size = <3, 1>  rotate(y, 360 * clock)  translate(9 * y) }"
                 "light { from = 9 * y  to = 9 * y + <max(0, clock - .25), -1, 0>  size = <3, 1> }" HALF);
    const Affine *about = keys_of(&scene, 0), *later = keys_of(&scene, 1);
    assert_near(vec3_length(vec3_sub(first_axis(&about[1]), vec3(0, 0, -1))), 0, 1e-12);
    assert_near(vec3_length(vec3_sub(first_axis(&about[2]), vec3(-1, 0, 0))), 0, 1e-12);
    Vec3 x = first_axis(&later[2]);
    assert_near(fabs(x.z), 1, 1e-12);
    for (int k = 0; k < 2; k++) assert_near(vec3_length(vec3_sub(first_axis(&later[k]), x)), 0, 1e-12);
    fixture_clear(&scene);
}

/* A profile of one horizontal angle is round only where that is an angle about the axis. */
static void profiles_turn_as_they_are_turned(void **state)
{
    (void)state;
    Fixture scene;
    fixture_good(
        &scene, FIXTURE_MEDIA
        "light { shape = point  profile = \"tests/unit/lamp_fan.ies\"  rotate(y, 360 * clock)  translate(9 * y) }"
        "light { shape = spot  from = 0 * y  to = -y  rotate(y, 360 * clock)  translate(9 * y) }" HALF);
    const Scene *s = scene.scene;
    const Affine *fan = scene_motion(s, s->lights[0].motion), *spot = scene_motion(s, s->lights[1].motion);
    assert_non_null(fan);
    assert_near(vec3_length(vec3_sub(first_axis(&fan[1]), vec3(0, 0, -1))), 0, 1e-12);
    assert_near(vec3_length(vec3_sub(first_axis(&fan[2]), vec3(-1, 0, 0))), 0, 1e-12);
    assert_null(spot);
    fixture_clear(&scene);
}

static void programs_are_aligned(void **state)
{
    (void)state;
    /* x * c0 + c1, where c0 and c1 are one constant in the first */
    const ProgramStep alike[] = {{.op = PROGRAM_MULTIPLY, .to = 10, .a = 0, .b = 9},
                                 {.op = PROGRAM_ADD, .to = 11, .a = 10, .b = 9}};
    const ProgramStep apart[] = {{.op = PROGRAM_MULTIPLY, .to = 11, .a = 0, .b = 9},
                                 {.op = PROGRAM_ADD, .to = 12, .a = 11, .b = 10}};
    const ProgramStep other[] = {{.op = PROGRAM_MULTIPLY, .to = 11, .a = 1, .b = 9},
                                 {.op = PROGRAM_ADD, .to = 12, .a = 11, .b = 10}};
    const double one[] = {2}, two[] = {2, 6};
    const Program a = {one, alike, 1, 2, 12, 1, {11}}, b = {two, apart, 2, 2, 13, 1, {12}},
                  c = {two, other, 2, 2, 13, 1, {12}};
    const Program *pair[] = {&a, &b}, *odd[] = {&a, &c}, *const * aligned;
    const double inputs[PROGRAM_INPUTS] = {3};
    double value;
    Arena arena;
    arena_init(&arena);
    assert_false(program_align(odd, 2, &arena, &aligned));
    assert_true(program_align(pair, 2, &arena, &aligned));
    for (int k = 0; k < 2; k++) {
        program_run(aligned[k], inputs, &value);
        assert_near(value, k ? 12 : 8, 0);
    }
    program_run_between(aligned[0], aligned[1], 0.5, inputs, &value);
    assert_near(value, 10, 0);
    arena_clear(&arena);
}

static void mistakes_of_later_are_told(void **state)
{
    (void)state;
    Fixture scene;
    fixture_text(&scene, FIXTURE_MEDIA "assert(clock < .3, \"too late\") sphere { interior = glass }" HALF);
    assert_int_equal(scene.status, STATUS_SCENE);
    const Diagnostic *report = fixture_find(&scene, D_SHUTTER_MISTAKE);
    assert_non_null(report);
    assert_non_null(strstr(report->text, "too late"));
    fixture_clear(&scene);
    fixture_text(&scene,
                 FIXTURE_MEDIA "sphere { interior = glass }" HALF " camera { from = <0, 0, 5>  shutter = 90deg }");
    assert_non_null(fixture_find(&scene, D_CONFLICTING_PROPERTIES));
    fixture_clear(&scene);
}

/* Two files of a mesh, now and a frame later, and the scene that moves from one to the other. */
typedef struct TwoFrames {
    char folder[40], now[80], later[80], text[800];
} TwoFrames;

static void two_frames_open(TwoFrames *frames)
{
    strcpy(frames->folder, "/tmp/meniscus-motion-XXXXXX");
    assert_non_null(mkdtemp(frames->folder));
    snprintf(frames->now, sizeof frames->now, "%s/now.obj", frames->folder);
    snprintf(frames->later, sizeof frames->later, "%s/later.obj", frames->folder);
    snprintf(frames->text, sizeof frames->text,
             FIXTURE_MEDIA "mesh { interior = glass  file = \"%s\"  next_file = \"%s\" }" HALF, frames->now,
             frames->later);
}

static void two_frames_close(TwoFrames *frames)
{
    remove(frames->now);
    remove(frames->later);
    remove(frames->folder);
}

static void write_mesh(const char *path, const char *top, const char *more)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "v 0 0 0\nv 1 0 0\nv 0 0 -1\nv 0 %s 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n%s", top, more);
    assert_int_equal(fclose(file), 0);
}

static void what_is_dropped_of_a_mesh_is_dropped_a_frame_later(void **state)
{
    (void)state;
    static const char more[] = "v 0 0 0\nf 1 2 3\nf 1 5 2\nf 4 2 1\n"; /* twice, without extent, twice */
    TwoFrames frames;
    two_frames_open(&frames);
    write_mesh(frames.now, "1", more);
    write_mesh(frames.later, "3", more);
    Fixture scene;
    fixture_compile(&scene, frames.text, 1);
    assert_non_null(fixture_find(&scene, D_MESH_MENDED));
    const SceneShape *shape = &scene.scene->shapes[0];
    assert_int_equal(shape->mesh->n_triangles, 4);
    assert_non_null(shape->mesh_end);
    assert_true(mesh_same_triangles(shape->mesh, shape->mesh_end));
    fixture_clear(&scene);
    two_frames_close(&frames);
}

static void a_mesh_may_be_given_a_frame_later(void **state)
{
    (void)state;
    TwoFrames frames;
    two_frames_open(&frames);
    write_mesh(frames.now, "1", "");
    write_mesh(frames.later, "3", "");
    Fixture scene;
    fixture_compile(&scene, frames.text, 1);
    const Mesh *end = scene.scene->shapes[0].mesh_end;
    assert_non_null(end);
    double top = 0;
    for (uint32_t i = 0; i < end->n_vertices; i++) top = fmax(top, (double)end->positions[i].y);
    assert_near(top, 2, 1e-6); /* half a frame later */
    assert_near(scene.compiled->hull_bounds[0].max.y, 2, 1e-5);
    fixture_clear(&scene);
    remove(frames.later);
    fixture_text(&scene, frames.text);
    assert_int_equal(scene.status, STATUS_SCENE);
    fixture_clear(&scene);
    two_frames_close(&frames);
}

#define TETRAHEDRA(x)                                                                                                  \
    "mesh both { interior = glass  positions = [<0, 0, 0>, <9, 0, 0>, <0, 9, 0>, <0, 0, 9>, <1 + " x                   \
    ", 1, 1>, <9 + " x ", 2, 2>, <2 + " x ", 9, 2>, <2 + " x ", 2, 9>]  triangles = [<0, 2, 1>, <0, 1, 3>, "           \
    "<1, 2, 3>, <0, 3, 2>, <4, 6, 5>, <4, 5, 7>, <5, 6, 7>, <4, 7, 6>] "

static void meshes_of_overlapping_parts_move_as_others_do(void **state)
{
    (void)state;
    Fixture scene; /* all of it */
    fixture_compile(&scene, FIXTURE_MEDIA TETRAHEDRA("0") "translate(<20 * clock, 0, 0>) }" HALF, 1);
    assert_null(fixture_find(&scene, D_SHAPE_CHANGES));
    assert_int_equal(scene.compiled->n_hulls, 1);
    assert_int_equal(scene.scene->n_objects, 3);
    const Affine *first = keys_of(&scene, 1), *second = keys_of(&scene, 2);
    assert_near(scene.compiled->hull_bounds[0].max.x, 9 + first[scene.scene->n_keys - 1].t.x, 1e-5);
    assert_memory_equal(first, second, scene.scene->n_keys * sizeof *first);
    fixture_clear(&scene);
    /* one of its parts: they overlap at first and in the end */
    fixture_compile(&scene, FIXTURE_MEDIA TETRAHEDRA("clock") "}" HALF, 1);
    assert_null(fixture_find(&scene, D_SHAPE_CHANGES));
    uint32_t n_deforming = 0;
    for (uint32_t i = 0; i < scene.scene->n_shapes; i++) n_deforming += scene.scene->shapes[i].mesh_end != NULL;
    assert_int_equal(n_deforming, 1);
    fixture_clear(&scene);
    /* they do so at first only */
    fixture_text(&scene, FIXTURE_MEDIA TETRAHEDRA("100 * clock") "}" HALF);
    const Diagnostic *report = fixture_find(&scene, D_SHAPE_CHANGES);
    assert_non_null(report);
    assert_non_null(strstr(report->text, "both"));
    fixture_clear(&scene);
}

/* Parts that come to overlap by the end count as overlapping from the start. */
static void parts_may_come_to_overlap_a_frame_later(void **state)
{
    (void)state;
    TwoFrames frames;
    two_frames_open(&frames);
    static const char other[] =
        "v %d .1 -.1\nv %d .1 -.1\nv %d .1 -.9\nv %d .9 -.1\nf 5 6 7\nf 5 8 6\nf 6 8 7\nf 7 8 5\n";
    char far[200], near[200];
    snprintf(far, sizeof far, other, 5, 6, 5, 5);
    snprintf(near, sizeof near, other, 0, 1, 0, 0);
    write_mesh(frames.now, "1", far);
    write_mesh(frames.later, "1", near);
    Fixture scene;
    fixture_compile(&scene, frames.text, 1);
    assert_int_equal(scene.scene->n_objects, 3);
    uint32_t n_deforming = 0;
    for (uint32_t i = 0; i < scene.scene->n_shapes; i++) n_deforming += scene.scene->shapes[i].mesh_end != NULL;
    assert_int_equal(n_deforming, 2);
    fixture_clear(&scene);
    two_frames_close(&frames);
}

/* A pyramid over a face of four corners, one of which moves inward, so that it is cut another way: the mesh stays the same. */
static void a_face_that_gets_a_hollow_stays_cut_as_it_was(void **state)
{
    (void)state;
    TwoFrames frames;
    two_frames_open(&frames);
    for (int order = 0; order < 2; order++) {
        for (int frame = 0; frame < 2; frame++) {
            FILE *file = fopen(frame ? frames.later : frames.now, "w");
            assert_non_null(file);
            const char *moved = frame == order ? "2 0 2" : ".5 0 .5";
            fprintf(file, "v 0 0 0\nv 2 0 0\nv %s\nv 0 0 2\nv .4 1 .4\nf 1 2 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n",
                    moved);
            fclose(file);
        }
        Fixture scene;
        fixture_compile(&scene, frames.text, 1);
        const SceneShape *shape = &scene.scene->shapes[0];
        assert_int_equal(shape->mesh->n_triangles, 6);
        assert_non_null(shape->mesh_end);
        assert_true(mesh_same_triangles(shape->mesh, shape->mesh_end));
        fixture_clear(&scene);
    }
    two_frames_close(&frames);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_follow_the_clock),
        cmocka_unit_test(without_a_shutter_nothing_moves),
        cmocka_unit_test(beyond_the_end_of_a_fade_things_move_on),
        cmocka_unit_test(height_fields_deform),
        cmocka_unit_test(meshes_deform_and_cones_do_not),
        cmocka_unit_test(other_values_stay_and_are_told),
        cmocka_unit_test(shapes_that_come_back_are_told),
        cmocka_unit_test(textures_are_where_their_node_is),
        cmocka_unit_test(numbers_of_textures_are_between_keys),
        cmocka_unit_test(hanging_lamps_turn_as_they_are_turned),
        cmocka_unit_test(profiles_turn_as_they_are_turned),
        cmocka_unit_test(programs_are_aligned),
        cmocka_unit_test(mistakes_of_later_are_told),
        cmocka_unit_test(a_mesh_may_be_given_a_frame_later),
        cmocka_unit_test(what_is_dropped_of_a_mesh_is_dropped_a_frame_later),
        cmocka_unit_test(meshes_of_overlapping_parts_move_as_others_do),
        cmocka_unit_test(parts_may_come_to_overlap_a_frame_later),
        cmocka_unit_test(a_face_that_gets_a_hollow_stays_cut_as_it_was),
    };
    return cmocka_run_group_tests_name("motion", tests, NULL, NULL);
}

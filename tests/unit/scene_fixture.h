/* scene_fixture.h - scenes from text, for tests.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SCENE_FIXTURE_H
#define MEN_SCENE_FIXTURE_H

#include "scene/build.h"
#include "scene/compile.h"

/* A scene, or the reports why there is none. */
typedef struct Fixture {
    Arena arena;
    SourceSet sources;
    Diag diag;
    Scene *scene;
    Status status;
    Error error;
    CompiledScene *compiled;
} Fixture;

/* Something to stand at the end of scenes that are about other things. */
#define FIXTURE_VIEW " camera { from = <0, 0, 1000>  to = <0, 0, 0> } environment { } "
#define FIXTURE_MEDIA                                                                                                  \
    "meniscus 1.0 unit mm medium glass { ior = 1.5  state = solid } medium water { ior = 1.33  state = liquid } "      \
    "medium ice { ior = 1.31  state = solid } medium gas { ior = 1  state = gas } medium oil { ior = 1.47 } "          \
    "let _to_choose_from = [glass, water, ice, gas, oil] "

static inline void fixture_print(Fixture *fixture)
{
    Buf out = {0};
    diag_print(&fixture->diag, &out, false);
    fputs(buf_text(&out), stderr);
    buf_clear(&out);
}

static inline void fixture_build(Fixture *fixture, const char *text, const SceneOptions *options)
{
    memset(fixture, 0, sizeof *fixture);
    arena_init(&fixture->arena);
    fixture->sources.arena = &fixture->arena;
    diag_init(&fixture->diag, &fixture->arena, &fixture->sources);
    fixture->status =
        scene_build_text("test.mns", text, options, &fixture->diag, &fixture->scene, NULL, &fixture->error);
}

static inline void fixture_text(Fixture *fixture, const char *text)
{
    SceneOptions options = {.eval = {.frames = 1, .frame = 1}};
    fixture_build(fixture, text, &options);
}

/* A scene that must be right. */
static inline void fixture_good(Fixture *fixture, const char *text)
{
    fixture_text(fixture, text);
    if (fixture->status != STATUS_OK) {
        fixture_print(fixture);
        fail_msg("%s: %s", text, fixture->error.text);
    }
}

static inline void fixture_compile(Fixture *fixture, const char *text, unsigned n_threads)
{
    fixture_good(fixture, text);
    Pool *pool = NULL;
    if (n_threads > 1) assert_int_equal(pool_new(n_threads, &pool, &fixture->error), STATUS_OK);
    Status status = compile_scene(fixture->scene, fixture->scene->render.nesting, pool, &fixture->diag,
                                  &fixture->compiled, &fixture->error);
    pool_free(pool);
    if (status != STATUS_OK) fail_msg("%s", fixture->error.text);
}

static inline void fixture_clear(Fixture *fixture)
{
    compiled_scene_free(fixture->compiled);
    scene_free(fixture->scene);
    arena_clear(&fixture->arena);
}

/* The report of that code, or NULL. */
static inline const Diagnostic *fixture_find(const Fixture *fixture, DiagCode code)
{
    for (const Diagnostic *d = fixture->diag.first; d; d = d->next)
        if (d->code == code) return d;
    return NULL;
}

/* The text must be refused with that code. */
static inline void fixture_refused(const char *text, DiagCode code)
{
    Fixture fixture;
    fixture_text(&fixture, text);
    bool found = fixture_find(&fixture, code) != NULL;
    if (!found || fixture.status != STATUS_SCENE || fixture.scene) {
        fixture_print(&fixture);
        fail_msg("not refused with %s: %s", diag_slug(code), text);
    }
    fixture_clear(&fixture);
}

static inline uint32_t fixture_object(const Fixture *fixture, const char *name)
{
    for (uint32_t i = 0; i < fixture->scene->n_objects; i++)
        if (strcmp(fixture->scene->objects[i].name, name) == 0) return i;
    fail_msg("no object '%s'", name);
    return SCENE_NONE;
}

/* The pair of two objects, NULL when nothing is known of it. */
static inline const HullPair *fixture_pair(const Fixture *fixture, const char *one, const char *other)
{
    uint32_t a = fixture_object(fixture, one), b = fixture_object(fixture, other);
    for (size_t i = 0; i < fixture->compiled->n_pairs; i++) {
        const HullPair *pair = &fixture->compiled->pairs[i];
        if ((pair->a == a && pair->b == b) || (pair->a == b && pair->b == a)) return pair;
    }
    return NULL;
}

#endif

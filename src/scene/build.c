/* build.c - from the tree of checked nodes to the scene description: the walk, and what all builders use.
 *
 * The evaluator has seen to types, ranges and units. Here everything is checked that needs more than one
 * property or the geometry itself, lengths stay in scene units, degrees become radians, and each node is
 * turned into rows of the scene's tables.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/build.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "lang/schema_find.h"
#include "scene/build_parts.h"
#include "scene/geometry.h"
#include "scene/library.h"
#include "scene/motion.h"

/* ---- tables ---- */

static void map_grow(Arena *arena, Map *map)
{
    Map grown = {.capacity = map->capacity ? map->capacity * 2 : 64};
    grown.slots = ARENA_ARRAY(arena, MapSlot, grown.capacity);
    for (size_t i = 0; i < map->capacity; i++) {
        if (!map->slots[i].key) continue;
        size_t place = (size_t)map->slots[i].hash & (grown.capacity - 1);
        while (grown.slots[place].key) place = (place + 1) & (grown.capacity - 1);
        grown.slots[place] = map->slots[i];
    }
    grown.n = map->n;
    *map = grown;
}

/* The slot of a key, or the free one where it belongs. There must be one. */
static MapSlot *map_slot(const Map *map, const void *key, size_t length, uint64_t hash)
{
    size_t place = (size_t)hash & (map->capacity - 1);
    for (MapSlot *slot; (slot = &map->slots[place])->key; place = (place + 1) & (map->capacity - 1))
        if (slot->hash == hash && slot->length == length && memcmp(slot->key, key, length) == 0) return slot;
    return &map->slots[place];
}

static uint64_t hash_of_key(const void *key, size_t length)
{
    return hash_u64(hash_bytes(key, length, 0));
}

const uint32_t *map_seek(const Map *map, const void *key, size_t length)
{
    if (!map->n) return NULL;
    const MapSlot *slot = map_slot(map, key, length, hash_of_key(key, length));
    return slot->key ? &slot->value : NULL;
}

uint32_t *map_find(Arena *arena, Map *map, const void *key, size_t length, uint32_t value_if_new)
{
    if (2 * map->n >= map->capacity) map_grow(arena, map);
    uint64_t hash = hash_of_key(key, length);
    MapSlot *slot = map_slot(map, key, length, hash);
    if (slot->key) return &slot->value;
    *slot = (MapSlot){hash, key, length, value_if_new};
    map->n++;
    return &slot->value;
}

uint32_t *build_row_of(Builder *b, Map *map, const EvalNode *node, uint32_t row_if_new, bool *found)
{
    size_t n = map->n;
    const EvalNode **key = &node;
    if (!map_seek(map, key, sizeof node)) {
        key = ARENA_NEW(b->arena, const EvalNode *);
        *key = node;
    }
    uint32_t *row = map_find(b->arena, map, key, sizeof node, row_if_new);
    *found = map->n == n;
    return row;
}

void *room_for_one(Arena *arena, void *items, uint32_t n, uint32_t *capacity, size_t size)
{
    if (n < *capacity) return items;
    uint32_t more = n ? 2 * n : 16;
    void *grown = arena_array(arena, more, size);
    if (n) memcpy(grown, items, n * size);
    *capacity = more;
    return grown;
}

/* ---- what all builders use ---- */

const char *build_word(Builder *b, const EvalNode *node)
{
    size_t length = node->name ? eval_word_length(node->name) : 0;
    bool is_type = length == strlen(node->type->name) && memcmp(node->name, node->type->name, length) == 0;
    return length && !is_type ? arena_copy_text(b->arena, node->name, length) : NULL;
}

const char *build_name(Builder *b, const EvalNode *node, const char *word)
{
    const char *declared = node->name;
    for (const EvalNode *p = node; !declared && p; p = p->prototype) declared = p->name;
    bool own = node->name != NULL;
    const char *base = declared ? declared : word;
    size_t length = eval_word_length(base);
    uint32_t *count = map_find(b->arena, &b->names, base, length, 0);
    ++*count;
    /* a name that was declared stays as it is unless it was declared in a loop or a macro before */
    if (own && *count == 1) return arena_copy_text(b->arena, base, length);
    return arena_format(b->arena, "%.*s %u", (int)length, base, (unsigned)*count);
}

void build_note_file(Builder *b, const char *path)
{
    Scene *scene = b->scene;
    const char *kept = arena_copy_text(b->arena, path, strlen(path));
    size_t n_before = b->files.n;
    map_find(b->arena, &b->files, kept, strlen(kept), 0);
    if (b->files.n == n_before) return;
    b->file_table = room_for_one(b->arena, b->file_table, scene->n_files, &b->files_capacity, sizeof *b->file_table);
    b->file_table[scene->n_files++] = kept;
    scene->files = b->file_table;
}

bool build_text_file(Builder *b, Span span, const char *name, size_t most_bytes, DiagCode not_text, BuildText *file)
{
    const char *path = eval_find_file(&b->eval_options, b->diag, span, name);
    if (!path) return false;
    char *bytes;
    Error error;
    Status status = file_read(path, most_bytes, &bytes, &file->length, &error);
    if (status == STATUS_NOMEM) return build_succeeded(b, status, &error, span);
    if (status != STATUS_OK) {
        diag_report(b->diag, D_FILE_UNREADABLE, span, "%s", error.text);
        return false;
    }
    file_end_lines(bytes, file->length);
    SourceSet *sources = b->diag->sources;
    file->text = arena_copy_text(sources->arena, bytes, file->length);
    free(bytes);
    build_note_file(b, path);
    if (memchr(file->text, 0, file->length)) {
        diag_report(b->diag, not_text, span, "'%s' is no text", name);
        return false;
    }
    file->source = source_add(sources, path, path, file->text, file->length);
    return true;
}

bool build_check_reach(Builder *b, Span span, const char *what, Box3 bounds)
{
    double largest = fmax(vec3_max_abs(bounds.min), vec3_max_abs(bounds.max));
    if (vec3_is_finite(bounds.min) && vec3_is_finite(bounds.max) && largest <= SCENE_REACH) return true;
    Diagnostic *report = diag_report(b->diag, D_VALUE_OUT_OF_RANGE, span,
                                     "%s reaches to %g, and coordinates may not exceed %g", what, largest, SCENE_REACH);
    diag_hint(b->diag, report, "for ground without end there is the node 'ground'");
    return false;
}

bool build_check_transform(Builder *b, const EvalNode *node, const Affine *map)
{
    /* An axis that is flattened to a billionth of the others is flat as far as float coordinates go. */
    const double flat = 1e-9;
    Affine inverse;
    double lengths = 1;
    for (int column = 0; column < 3; column++)
        lengths *= vec3_length(vec3(map->m[0][column], map->m[1][column], map->m[2][column]));
    if (affine_invert(map, &inverse) && isfinite(lengths) && fabs(affine_determinant(map)) > flat * lengths)
        return true;
    diag_report(b->diag, D_SINGULAR_TRANSFORM, node->span, "the transforms of this %s squash it flat",
                node->type->name);
    return false;
}

Span build_author_place(const Builder *b, const EvalNode *node)
{
    return diag_author_place(b->diag->sources, node->span, node->chain);
}

Span build_span(const EvalNode *node, const char *property)
{
    const EvalProp *prop = eval_prop(node, property);
    return prop ? prop->span : node->span;
}

bool build_exclude(Builder *b, const EvalNode *node, const char *property, const char *other)
{
    const EvalProp *first = eval_prop(node, property);
    const EvalProp *second = eval_prop(node, other);
    if (!first || !second) return true;
    Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, second->span,
                                     "'%s' and '%s' exclude each other", property, other);
    diag_note(b->diag, report, first->span, "'%s' is set here", property);
    return false;
}

Diagnostic *build_needs(Builder *b, const EvalNode *node, const char *property, const char *needed)
{
    const EvalProp *prop = eval_prop(node, property);
    if (!prop) return NULL;
    return diag_report(b->diag, D_CONFLICTING_PROPERTIES, prop->span, "'%s' has no effect %s", property, needed);
}

Diagnostic *build_needs_other(Builder *b, const EvalNode *node, const char *property, const char *other,
                              const char *without)
{
    const EvalProp *prop = eval_prop(node, other);
    bool there = prop && (prop->type->kind != PROP_BOOL || prop->as.truth);
    return there ? NULL : build_needs(b, node, property, without);
}

/* ---- the walk ---- */

static void visit_group(Builder *b, const EvalNode *node, const Affine *to_world)
{
    if (b->combination) { /* as an operand: all of it together */
        build_part(b, node, to_world, NEST_UNION);
        return;
    }
    for (size_t i = 0; i < node->n_children; i++) build_visit(b, node->children[i], to_world);
}

/* Whether a node may stand in a combination; reports when not. */
static bool is_operand(Builder *b, const EvalNode *node)
{
    static const char *const others[] = {"ground", "light", "camera"};
    for (size_t i = 0; i < COUNT_OF(others); i++) {
        if (strcmp(node->type->name, others[i]) != 0) continue;
        Diagnostic *report =
            diag_report(b->diag, D_MISPLACED, node->span, "a %s has no inside: it cannot be an operand", others[i]);
        diag_hint(b->diag, report,
                  strcmp(others[i], "ground") == 0 ? "a plane can, which has an inside"
                                                   : "closed shapes, groups and other combinations can");
        return false;
    }
    return true;
}

static const struct {
    const char *type;
    void (*build)(Builder *b, const EvalNode *node, const Affine *to_world);
} placed[] = {
    {"sphere", build_sphere},
    {"box", build_box},
    {"cylinder", build_cylinder},
    {"cone", build_cone},
    {"ellipsoid", build_ellipsoid},
    {"torus", build_torus},
    {"capsule", build_capsule},
    {"lathe", build_lathe},
    {"mesh", build_mesh},
    {"plane", build_plane},
    {"ground", build_ground},
    {"group", visit_group},
    {"light", build_light},
    {"camera", build_camera},
    {"union", build_union},
    {"merge", build_union},
    {"intersection", build_intersection},
    {"difference", build_difference},
    {"prism", build_prism},
    {"sweep", build_sweep},
    {"superellipsoid", build_superellipsoid},
    {"height_field", build_height_field},
    {"text", build_text},
    {"blob", build_blob},
    {"isosurface", build_isosurface},
};

void build_visit(Builder *b, const EvalNode *node, const Affine *parent)
{
    if (b->status != STATUS_OK) return;
    for (size_t i = 0; i < COUNT_OF(placed); i++) {
        if (strcmp(node->type->name, placed[i].type) != 0) continue;
        if (b->options->building) b->options->building(b->options->building_context, placed[i].type, node->name);
        Affine to_world = affine_compose(parent, &node->transform);
        uint64_t where = b->where;
        b->where = hash_u64(where + node->identity);
        Affine outer_frame = b->node_to_world;
        b->node_to_world = to_world;
        const DiagChain *outer = b->diag->chain;
        b->diag->chain = node->chain;
        if ((!b->combination || is_operand(b, node)) && build_check_transform(b, node, &to_world))
            placed[i].build(b, node, &to_world);
        b->diag->chain = outer;
        b->where = where;
        b->node_to_world = outer_frame;
        return;
    }
}

static const EvalNode *find_single(const Builder *b, const char *type)
{
    for (size_t i = 0; i < b->result.n_nodes; i++)
        if (strcmp(b->result.nodes[i]->type->name, type) == 0) return b->result.nodes[i];
    return NULL;
}

/* media[0] is the world's. Without a word about it that is the air of the prelude, which is the first of
 * its name however a scene shadows it. */
static void build_media(Builder *b)
{
    const EvalNode *world = find_single(b, "world");
    const EvalProp *prop = world ? eval_prop(world, "medium") : NULL;
    const EvalNode *medium = prop ? prop->as.node : NULL;
    for (size_t i = 0; !medium && i < b->result.n_nodes; i++) {
        const EvalNode *node = b->result.nodes[i];
        if (strcmp(node->type->name, "medium") == 0 && node->name && strcmp(node->name, "air") == 0) medium = node;
    }
    if (medium) {
        build_medium_of(b, medium, "the world");
    } else {
        b->scene->media = room_for_one(b->arena, NULL, 0, &b->media_capacity, sizeof *b->scene->media);
        b->scene->media[b->scene->n_media++] = (SceneMedium){.name = "air",
                                                             .turned_from = SCENE_NONE,
                                                             .ior = spectrum_constant(1),
                                                             .absorption = spectrum_constant(0),
                                                             .scattering = spectrum_constant(0),
                                                             .state = NEST_GAS};
    }
    for (size_t i = 0; i < b->result.n_nodes; i++)
        if (strcmp(b->result.nodes[i]->type->name, "medium") == 0) build_medium(b, b->result.nodes[i]);
}

/* The film and how to render are there in any case: what no node says is as the table has it. */
static void build_settings(Builder *b)
{
    static const struct {
        const char *type;
        void (*build)(Builder *b, const EvalNode *node);
        bool always;
    } settings[] = {
        {"environment", build_environment, false}, {"film", build_film, true}, {"render", build_render, true}};
    for (size_t i = 0; i < COUNT_OF(settings) && b->status == STATUS_OK; i++) {
        const EvalNode *node = find_single(b, settings[i].type);
        EvalNode unsaid = {.type = schema_node(scene_schema(), settings[i].type)};
        if (node || settings[i].always) settings[i].build(b, node ? node : &unsaid);
    }
}

static bool any_emits(const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_objects; i++)
        if (scene->objects[i].surface != SCENE_NONE && scene->surfaces[scene->objects[i].surface].emits) return true;
    for (uint32_t i = 0; i < scene->n_objects; i++)
        if (scene->objects[i].medium != SCENE_NONE && scene->media[scene->objects[i].medium].emits) return true;
    return scene->media[0].emits;
}

/* The world's medium reaches to infinity, unless its density ends. */
static void check_world(Builder *b, bool distant)
{
    const SceneMedium *medium = &b->scene->media[0];
    if (medium->mixes) {
        Diagnostic *report =
            diag_report(b->diag, D_CONFLICTING_PROPERTIES, medium->span,
                        "the world's medium '%s' mixes, and there is nothing that it could mix with", medium->name);
        diag_hint(b->diag, report, "leave 'mixes' out, or put it into an object");
    }
    if (medium->refracts_doubly)
        diag_report(b->diag, D_CONFLICTING_PROPERTIES, medium->span,
                    "the world's medium '%s' is a crystal: only an object can have an 'extraordinary_ior'",
                    medium->name);
    if (!scene_medium_is_endless(medium)) return;
    if ((medium->absorbs || medium->scatters) && distant) {
        Diagnostic *report = diag_report(b->diag, D_UNBOUNDED_ENVIRONMENT, medium->span,
                                         "the world's medium '%s' %s, so that no light from infinitely far arrives",
                                         medium->name, medium->absorbs ? "absorbs" : "scatters");
        diag_hint(b->diag, report,
                  "fill a box with it, around what is seen; with mixes = true that may reach into the ground");
    }
    if (scene_medium_adds_up(medium))
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, medium->span,
                    "the world's medium '%s' shines and lets all light through: it is infinitely bright", medium->name);
}

/* lit: by lights, or the environment. */
static void check_catchers(Builder *b, bool lit)
{
    const Scene *scene = b->scene;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        if (lit || !scene_is_catcher(scene, i)) continue;
        Diagnostic *report =
            diag_report(b->diag, D_IDLE_CATCHER, scene->objects[i].span,
                        "%s catches no shadows: what lights it are things that shine, which add their light",
                        scene->objects[i].name);
        diag_hint(b->diag, report, "let a light { } or an environment light it");
        return;
    }
}

static void check_whole(Builder *b)
{
    const Scene *scene = b->scene;
    if (b->status != STATUS_OK || b->diag->n_errors) return;
    bool distant = scene->environment != NULL, shines = false;
    for (uint32_t i = 0; i < scene->n_lights; i++) {
        distant = distant || scene->lights[i].kind == LIGHT_DISTANT;
        shines = shines || (scene->lights[i].kind != LIGHT_PORTAL && !spectrum_is_zero(&scene->lights[i].radiance));
    }
    const bool lit = shines || (scene->environment && !environment_is_black(scene->environment));
    if (!scene->n_objects && !scene->n_lights && !scene->environment)
        diag_report_nowhere(b->diag, D_NOTHING_TO_RENDER, "the scene has no objects, lights or environment");
    else if (!lit && !any_emits(scene) && !b->options->no_picture)
        diag_hint(b->diag,
                  diag_report_nowhere(b->diag, D_NO_LIGHT, "nothing in the scene shines: the picture will be black"),
                  "write: environment { color = .5 }, for light from all around");
    else
        check_catchers(b, lit);
    for (uint32_t i = 0; i < scene->n_lights && !scene->environment; i++)
        if (scene->lights[i].kind == LIGHT_PORTAL)
            diag_report(b->diag, D_IDLE_PORTAL, scene->lights[i].span,
                        "a portal without an environment: there is no light to come in");
    if (!scene->n_cameras && !b->options->no_picture) {
        Diagnostic *report = diag_report_nowhere(b->diag, D_NO_CAMERA, "the scene has no camera");
        diag_hint(b->diag, report, "add one: camera { from = <0, 1, 5>  to = <0, 0, 0> }");
    }
    check_world(b, distant);
}

static void build_all(Builder *b)
{
    Scene *scene = b->scene;
    scene->unit_m = b->result.unit_m;
    scene->has_unit = b->result.has_unit;
    scene->animation = b->instant.animation;
    scene->frame = b->instant.frame;
    scene->is_still = b->result.is_still;
    for (size_t i = 0; i < b->result.n_files; i++) build_note_file(b, b->result.files[i]);
    build_media(b);
    Affine world = affine_identity();
    for (size_t i = 0; i < b->result.n_nodes; i++) build_visit(b, b->result.nodes[i], &world);
    build_settings(b);
    build_drop_layered(b);
    check_whole(b);
    if (b->status == STATUS_OK) scene->hash = scene_hash(scene, b->environment_hash, b->arena);
}

EvalOptions scene_eval_options(const SceneOptions *options)
{
    EvalOptions eval = options->eval;
    eval.schema = scene_schema();
    eval.library = &std_library;
    eval.geometry = &scene_geometry;
    eval.geometry_context = options;
    return eval;
}

/* ---- the two guards, and what is left when all is done ---- */

typedef struct Request {
    Builder builder;
    Arena tree; /* of the evaluated nodes, which the scene does not need once it is built */
    SceneText text;
    bool scene_memory_ended;
} Request;

static void task_in_scene(void *context)
{
    build_all(&((Request *)context)->builder);
}

static void task_in_diag(void *context)
{
    Request *request = context;
    Builder *b = &request->builder;
    request->tree.escape = b->diag->arena->escape;
    b->status = scene_evaluate(&request->text, &b->eval_options, &b->options->moment, b->diag, &b->result, &b->instant,
                               b->error);
    if (b->status != STATUS_OK) return;
    /* The scene's arena is guarded inside, so that a jump out of the other one leaves no guard behind in
     * anything but the scene, which is then thrown away. */
    if (!arena_guard(b->arena, task_in_scene, request)) request->scene_memory_ended = true;
}

static Status build_requested(Request *request, const SceneOptions *options, Diag *diag, Scene **scene, Buf *printed,
                              Error *error)
{
    *scene = NULL;
    Scene *made = calloc(1, sizeof *made);
    if (made) made->light_groups = light_groups_none();
    if (!made) return fail_memory(error, sizeof *made, "the scene");
    arena_init(&made->arena);
    Builder *b = &request->builder;
    *b = (Builder){.scene = made,
                   .arena = &made->arena,
                   .diag = diag,
                   .options = options,
                   .eval_options = scene_eval_options(options),
                   .black = SCENE_NONE,
                   .grey = SCENE_NONE,
                   .error = error};
    arena_init(&request->tree);
    b->eval_options.arena = &request->tree;
    const DiagChain *chain = diag->chain;
    bool done = arena_guard(diag->arena, task_in_diag, request);
    diag->chain = chain;
    if (printed) buf_add_bytes(printed, buf_text(&b->result.printed), b->result.printed.length);
    buf_clear(&b->result.printed);
    arena_clear(&request->tree);
    mesh_kept_clear(&b->kept_mesh);
    Status status = b->status;
    if (!done || request->scene_memory_ended)
        status = fail(error, STATUS_NOMEM, "out of memory while building the scene");
    if (status == STATUS_OK && diag->n_errors) status = STATUS_SCENE;
    if (status == STATUS_SCENE && diag->n_errors)
        fail(error, STATUS_SCENE, "the scene has %u error%s", (unsigned)diag->n_errors, diag->n_errors == 1 ? "" : "s");
    if (status == STATUS_OK)
        *scene = made;
    else
        scene_free(made);
    return status;
}

Status build_at_moment(const SceneText *text, const SceneOptions *options, Diag *diag, Scene **scene, Buf *printed,
                       SceneInstant *instant, Error *error)
{
    Request request = {.text = *text};
    Status status = build_requested(&request, options, diag, scene, printed, error);
    if (instant) *instant = request.builder.instant;
    return status;
}

Status scene_build_from(const SceneText *text, const SceneOptions *options, Diag *diag, Scene **scene, Buf *printed,
                        SceneInstant *instant, Error *error)
{
    SceneInstant opening;
    TRY(build_at_moment(text, options, diag, scene, printed, instant ? instant : &opening, error));
    Status status = scene_find_motion(text, options, instant ? instant : &opening, diag, *scene, error);
    if (status != STATUS_OK) {
        scene_free(*scene);
        *scene = NULL;
    }
    return status;
}

Status scene_build(const char *path, const SceneOptions *options, Diag *diag, Scene **scene, Buf *printed, Error *error)
{
    return scene_build_from(&(SceneText){.path = path}, options, diag, scene, printed, NULL, error);
}

Status scene_build_text(const char *name, const char *text, const SceneOptions *options, Diag *diag, Scene **scene,
                        Buf *printed, Error *error)
{
    return scene_build_from(&(SceneText){name, text, strlen(text)}, options, diag, scene, printed, NULL, error);
}

/* scene_hash.c - one number for what a scene means.
 *
 * Two scenes with the same number render the same picture: everything that light meets goes in, names, places in the
 * text and output paths do not, and neither does what nothing refers to. How long to render (samples,
 * noise) is left out on purpose: a render that is resumed with more samples is the same render.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/hash.h"
#include "scene/build_parts.h"

typedef struct Hasher {
    uint64_t state;
} Hasher;

static void add_bytes(Hasher *h, const void *bytes, size_t length)
{
    h->state = hash_bulk(bytes, length, h->state);
}

static void add_integer(Hasher *h, uint64_t x)
{
    h->state = hash_u64(h->state ^ hash_u64(x));
}

static void add_number(Hasher *h, double x)
{
    uint64_t bits;
    x += 0.0; /* -0 is 0 */
    memcpy(&bits, &x, sizeof bits);
    add_integer(h, bits);
}

static void add_vector(Hasher *h, Vec3 v)
{
    add_number(h, v.x);
    add_number(h, v.y);
    add_number(h, v.z);
}

static void add_map(Hasher *h, const Affine *map)
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) add_number(h, map->m[row][column]);
    add_vector(h, map->t);
}

static void add_spectrum(Hasher *h, const Spectrum *spectrum)
{
    for (int i = 0; i < SPECTRUM_SAMPLES; i++)
        add_number(h, (double)spectrum_at_one(spectrum, SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM)));
    if (spectrum->kind != SPECTRUM_ROWS) return;
    add_number(h, (double)spectrum->scale);
    add_bytes(h, spectrum->rows->row, spectrum->rows->n * sizeof *spectrum->rows->row);
}

static void add_mesh(Hasher *h, const Mesh *mesh)
{
    add_integer(h, mesh->n_vertices);
    add_integer(h, mesh->n_triangles);
    add_bytes(h, mesh->positions, mesh->n_vertices * sizeof *mesh->positions);
    add_bytes(h, mesh->triangles, mesh->n_triangles * sizeof *mesh->triangles);
    if (mesh->normals) add_bytes(h, mesh->normals, mesh->n_vertices * sizeof *mesh->normals);
    if (mesh->uvs) add_bytes(h, mesh->uvs, mesh->n_vertices * 2 * sizeof *mesh->uvs);
}

static void add_solid(Hasher *h, const Solid *solid)
{
    add_integer(h, solid->n_pieces);
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        const Piece *p = &solid->pieces[i];
        add_integer(h, p->kind);
        bool arc = p->kind == PIECE_OUTER_ARC || p->kind == PIECE_INNER_ARC;
        const double ends[] = {p->r0, p->y0, p->r1, p->y1};
        const double centre[] = {p->centre_r, p->centre_y};
        const double normals[] = {(double)p->nr0, (double)p->ny0, (double)p->nr1, (double)p->ny1};
        for (size_t k = 0; k < COUNT_OF(ends); k++) add_number(h, ends[k]);
        for (size_t k = 0; arc && k < COUNT_OF(centre); k++) add_number(h, centre[k]);
        for (size_t k = 0; !arc && k < COUNT_OF(normals); k++) add_number(h, normals[k]);
    }
}

/* Hashes of the tables' rows, each computed once however often it is used. */
typedef struct Rows {
    uint64_t *shapes, *media, *surfaces, *textures;
    bool *texture_varies; /* whether it has another value on each object */
} Rows;

uint64_t scene_shape_hash(const SceneShape *shape)
{
    Hasher h = {1};
    if (shape->mesh) add_mesh(&h, shape->mesh);
    if (shape->solid) add_solid(&h, shape->solid);
    return h.state;
}

static void add_volume(Hasher *h, const Volume *volume)
{
    add_integer(h, volume != NULL);
    if (!volume) return;
    add_map(h, &volume->to_lattice);
    size_t n_bricks = 1;
    for (int axis = 0; axis < 3; axis++) {
        add_integer(h, (uint64_t)volume->n_points[axis]);
        n_bricks *= (size_t)volume->n_bricks[axis];
    }
    add_bytes(h, volume->bricks, n_bricks * sizeof *volume->bricks);
    add_bytes(h, volume->values, (size_t)volume->n_blocks * VOLUME_BRICK_VALUES * sizeof *volume->values);
    add_number(h, (double)volume->outside);
}

uint64_t scene_medium_hash(const SceneMedium *medium)
{
    Hasher h = {2};
    add_spectrum(&h, &medium->ior);
    if (medium->refracts_doubly) {
        add_spectrum(&h, &medium->extraordinary);
        add_vector(&h, medium->optic_axis);
    }
    if (medium->pleochroic) add_spectrum(&h, &medium->extraordinary_absorption);
    add_spectrum(&h, &medium->absorption);
    if (medium->scatters) {
        add_spectrum(&h, &medium->scattering);
        add_number(&h, medium->phase.weight);
        for (int i = 0; i < 2; i++) {
            add_number(&h, medium->phase.lobes[i].g);
            add_number(&h, medium->phase.lobes[i].alpha);
        }
        const PhaseTable *table = medium->phase.table;
        if (table) add_bytes(&h, table->recipe, table->recipe_size);
    }
    add_integer(&h, medium->state);
    if (!medium->emits && !medium->density && !medium->mixes) return h.state;
    add_integer(&h, medium->mixes);
    add_volume(&h, medium->density);
    if (!medium->emits) return h.state;
    add_spectrum(&h, &medium->emission);
    add_volume(&h, medium->temperature);
    if (medium->temperature) add_number(&h, medium->reference_k);
    return h.state;
}

static void add_pattern(Hasher *h, const Pattern *p)
{
    const unsigned words[] = {p->kind, p->shape, p->wave, p->style, p->octaves, p->value};
    const double numbers[] = {p->mortar,     p->bevel, p->bond,  p->frequency, p->phase,
                              p->lacunarity, p->gain,  p->grain, p->radius,    p->blur};
    for (size_t i = 0; i < COUNT_OF(words); i++) add_integer(h, words[i]);
    for (size_t i = 0; i < COUNT_OF(numbers); i++) add_number(h, numbers[i]);
    add_integer(h, p->seed);
    add_vector(h, p->size);
}

static void add_textures(Hasher *h, const Rows *rows, uint32_t texture)
{
    if (texture != TEXTURE_NONE) add_integer(h, rows->textures[texture]);
}

/* Those that it refers to stand before it. */
static uint64_t texture_hash(const Texture *t, const Rows *rows)
{
    Hasher h = {4};
    const unsigned words[] = {t->kind, t->in_world, t->is_value, t->projection, t->wrap, t->turbulence_octaves};
    for (size_t i = 0; i < COUNT_OF(words); i++) add_integer(&h, words[i]);
    if (t->placed) add_map(&h, &t->to_pattern);
    add_number(&h, t->vary);
    add_number(&h, t->turns);
    add_number(&h, t->turbulence);
    add_integer(&h, t->seed);
    if (t->kind == TEXTURE_PATTERN) add_pattern(&h, &t->pattern);
    if (t->image) add_integer(&h, texture_image_hash(t->image));
    if (t->program) add_integer(&h, program_hash(t->program));
    if (t->kind == TEXTURE_CONSTANT) add_spectrum(&h, &t->value);
    for (uint32_t i = 0; i < t->n_stops; i++) {
        add_number(&h, (double)t->stops[i].at);
        add_spectrum(&h, &t->stops[i].value);
    }
    const uint32_t others[] = {t->low, t->high, t->blend};
    for (size_t i = 0; t->kind != TEXTURE_CONSTANT && i < COUNT_OF(others); i++) add_textures(&h, rows, others[i]);
    return h.state;
}

static bool texture_varies(const Texture *t, const Rows *rows)
{
    const uint32_t others[] = {t->low, t->high, t->blend};
    if (t->kind == TEXTURE_VARIATION || t->vary > 0) return true;
    for (size_t i = 0; t->kind != TEXTURE_CONSTANT && i < COUNT_OF(others); i++)
        if (others[i] != TEXTURE_NONE && rows->texture_varies[others[i]]) return true;
    return false;
}

static bool surface_varies(const Scene *scene, const SceneSurface *surface, const Rows *rows)
{
    for (int i = 0; surface->mixed && i < 2; i++)
        if (surface_varies(scene, &scene->surfaces[surface->mix[i]], rows)) return true;
    for (uint32_t i = 0; i < surface->n_textures; i++)
        if (rows->texture_varies[surface->textures[i].texture]) return true;
    return (surface->bump != SCENE_NONE && rows->texture_varies[surface->bump]) ||
           (surface->normal_map != SCENE_NONE && rows->texture_varies[surface->normal_map]) ||
           (surface->emission_texture != SCENE_NONE && rows->texture_varies[surface->emission_texture]);
}

static void add_relief(Hasher *h, const SceneSurface *surface, const Rows *rows)
{
    if (surface->bump != SCENE_NONE) {
        add_integer(h, rows->textures[surface->bump]);
        add_number(h, surface->bump_height);
    }
    if (surface->normal_map != SCENE_NONE) {
        add_integer(h, rows->textures[surface->normal_map]);
        add_number(h, (double)surface->normal_x);
        add_number(h, (double)surface->normal_y);
    }
}

static uint64_t surface_hash(const SceneSurface *surface, const Rows *rows)
{
    Hasher h = {3};
    add_spectrum(&h, &surface->albedo);
    for (uint32_t i = 0; i < surface->n_textures; i++) {
        add_integer(&h, surface->textures[i].offset);
        add_integer(&h, rows->textures[surface->textures[i].texture]);
    }
    add_relief(&h, surface, rows);
    if (surface->emits) add_spectrum(&h, &surface->emission);
    if (surface->emission_texture != SCENE_NONE) {
        add_integer(&h, rows->textures[surface->emission_texture]);
        add_number(&h, (double)surface->emission_factor);
    }
    add_number(&h, (double)surface->roughness);
    const BsdfSpec *spec = &surface->spec;
    if (surface->catches) add_integer(&h, surface->catches);
    if (!surface->finished) { /* matte, or clear */
        if (spec->specular_roughness_anisotropy > 0) {
            add_number(&h, (double)spec->specular_roughness_anisotropy);
            add_integer(&h, (uint64_t)surface->grain);
            add_number(&h, surface->grain_angle);
        }
        return h.state;
    }
    const float numbers[] = {spec->base_diffuse_roughness,
                             spec->base_metalness,
                             spec->specular_weight,
                             spec->specular_roughness_anisotropy,
                             spec->transmission_weight,
                             spec->translucency,
                             spec->film_thickness_nm,
                             spec->coat_weight,
                             spec->coat_roughness,
                             spec->coat_roughness_anisotropy,
                             spec->fuzz_weight,
                             spec->fuzz_roughness};
    for (size_t i = 0; i < COUNT_OF(numbers); i++) add_number(&h, (double)numbers[i]);
    add_integer(&h, (uint64_t)spec->thin_walled + 2 * (uint64_t)surface->painted + 4 * (uint64_t)surface->grain);
    add_number(&h, surface->grain_angle);
    add_spectrum(&h, &spec->transmission_color);
    add_spectrum(&h, &spec->fuzz_color);
    add_spectrum(&h, &spec->specular_ior);
    add_spectrum(&h, &spec->coat_ior);
    add_spectrum(&h, &spec->film_ior);
    add_spectrum(&h, &spec->coat_color);
    if (spec->measured_metal) {
        add_spectrum(&h, &spec->metal_n);
        add_spectrum(&h, &spec->metal_k);
    }
    return h.state;
}

/* A mix comes before its surfaces. */
static uint64_t mix_hash(const SceneSurface *surface, const Rows *rows)
{
    Hasher h = {surface_hash(surface, rows)};
    add_number(&h, (double)surface->spec.mix_weight);
    for (int i = 0; i < 2; i++) add_integer(&h, rows->surfaces[surface->mix[i]]);
    return h.state;
}

static Rows hash_rows(const Scene *scene, Arena *scratch)
{
    Rows rows = {ARENA_ARRAY(scratch, uint64_t, scene->n_shapes), ARENA_ARRAY(scratch, uint64_t, scene->n_media),
                 ARENA_ARRAY(scratch, uint64_t, scene->n_surfaces), ARENA_ARRAY(scratch, uint64_t, scene->n_textures),
                 ARENA_ARRAY(scratch, bool, scene->n_textures)};
    for (uint32_t i = 0; i < scene->n_shapes; i++) rows.shapes[i] = scene_shape_hash(&scene->shapes[i]);
    for (uint32_t i = 0; i < scene->n_media; i++) rows.media[i] = scene_medium_hash(&scene->media[i]);
    for (uint32_t i = 0; i < scene->n_textures; i++) {
        rows.textures[i] = texture_hash(&scene->textures[i], &rows);
        rows.texture_varies[i] = texture_varies(&scene->textures[i], &rows);
    }
    for (uint32_t i = scene->n_surfaces; i-- > 0;) {
        const SceneSurface *surface = &scene->surfaces[i];
        rows.surfaces[i] = surface->mixed ? mix_hash(surface, &rows) : surface_hash(surface, &rows);
    }
    return rows;
}

/* Which objects share a medium matters (they merge), the medium's number does not: so each medium counts by
 * the object that used it first. */
static void add_objects(Hasher *h, const Scene *scene, const Rows *rows, Arena *scratch)
{
    uint32_t *first_use = ARENA_ARRAY(scratch, uint32_t, scene->n_media);
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        if (object->shape != SCENE_NONE) {
            add_integer(h, rows->shapes[object->shape]);
            add_map(h, &object->to_world);
        }
        if (object->medium != SCENE_NONE) {
            add_integer(h, rows->media[object->medium]);
            add_integer(h, (uint32_t)object->priority);
            bool world = object->medium == 0;
            if (!world && !first_use[object->medium]) first_use[object->medium] = i + 1;
            add_integer(h, world ? 0 : first_use[object->medium]);
        }
        if (object->surface == SCENE_NONE) continue;
        add_integer(h, rows->surfaces[object->surface]);
        if (object->texture_frame != SCENE_NONE) add_map(h, &scene->texture_frames[object->texture_frame].from_shape);
        if (surface_varies(scene, &scene->surfaces[object->surface], rows))
            add_integer(h, scene_texture_identity(scene, i));
    }
}

static void add_trees(Hasher *h, const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_trees; i++) {
        add_integer(h, scene->trees[i].root);
        add_integer(h, scene->trees[i].object);
    }
    for (uint32_t i = 0; i < scene->n_parts; i++) {
        const NestPart *part = &scene->parts[i];
        add_integer(h, part->operation);
        add_integer(h, part->begin);
        add_integer(h, part->end);
        add_integer(h, part->n_children ? part->first_child : 0);
        add_integer(h, part->n_children);
    }
}

static void add_lights(Hasher *h, const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_lights; i++) {
        const SceneLight *light = &scene->lights[i];
        add_integer(h, light->kind);
        add_integer(h, light->object);
        add_spectrum(h, &light->radiance);
        add_number(h, light->half_width);
        add_number(h, light->half_height);
        if (light->hidden) add_integer(h, light->hidden);
        if (light->kind == LIGHT_POINT || light->kind == LIGHT_PORTAL) add_map(h, &light->to_world);
        if (light->kind == LIGHT_POINT || light_is_focused(light)) {
            add_number(h, light->cos_full);
            add_number(h, light->cos_none);
        }
        if (light->kind == LIGHT_POINT) {
            const LightProfile *profile = light->profile;
            if (profile) add_integer(h, profile->type);
            if (profile && light->mirrored) add_integer(h, light->mirrored);
            for (uint32_t k = 0; profile && k < profile->n_vertical; k++) add_number(h, (double)profile->vertical[k]);
            for (uint32_t k = 0; profile && k < profile->n_horizontal; k++)
                add_number(h, (double)profile->horizontal[k]);
            for (uint32_t k = 0; profile && k < profile->n_vertical * profile->n_horizontal; k++)
                add_number(h, (double)profile->intensity[k]);
        }
        if (light->kind != LIGHT_DISTANT) continue;
        add_vector(h, light->towards);
        add_number(h, light->cos_angle);
    }
}

uint64_t scene_light_hash(const SceneLight *light)
{
    Hasher h = {5};
    add_integer(&h, light->hidden);
    add_spectrum(&h, &light->radiance);
    add_number(&h, light->cos_full);
    add_number(&h, light->cos_none);
    if (light->kind != LIGHT_DISTANT) return h.state;
    add_vector(&h, light->towards);
    add_number(&h, light->cos_angle);
    return h.state;
}

static void add_camera(Hasher *h, const SceneCamera *camera)
{
    add_vector(h, camera->from);
    add_vector(h, camera->forward);
    add_vector(h, camera->up);
    if (camera->projection != PROJECTION_PERSPECTIVE) add_integer(h, camera->projection);
    add_number(h, camera->half_width);
    add_number(h, camera->lens_radius);
    for (int i = 0; i < 2; i++) add_number(h, camera->shift[i]);
    for (int i = 0; i < 3 && camera->lens_radius > 0; i++) add_number(h, camera->focus[i]);
    if (camera->iris.blades > 0) {
        add_integer(h, camera->iris.blades);
        add_number(h, camera->iris.rotation);
        add_number(h, camera->iris.roundness);
    }
}

static void add_cameras(Hasher *h, const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_cameras; i++) add_camera(h, &scene->cameras[i]);
}

static void add_frames(Hasher *h, const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_frames; i++) {
        add_integer(h, scene->frames[i].object);
        add_map(h, &scene->frames[i].to_world);
    }
}

static uint64_t hash_of_rows(const uint64_t *rows, uint32_t n)
{
    return hash_bulk(rows, n * sizeof *rows, n);
}

static void add_environment(Hasher *h, const Scene *scene)
{
    if (!scene->environment) return;
    add_map(h, &scene->world_to_environment);
    if (scene->environment_hidden) add_integer(h, scene->environment_hidden);
}

static void hash_parts(Scene *scene, const Rows *rows, uint64_t environment_hash)
{
    Hasher objects = {hash_of_rows(rows->shapes, scene->n_shapes)}, lights = {0}, cameras = {0},
           sky = {environment_hash};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        add_integer(&objects, object->shape);
        add_integer(&objects, object->medium);
        add_integer(&objects, (uint32_t)object->priority);
        if (object->shape != SCENE_NONE) add_map(&objects, &object->to_world);
    }
    if (scene->n_trees) add_trees(&objects, scene);
    add_frames(&objects, scene);
    add_lights(&lights, scene);
    add_cameras(&cameras, scene);
    add_environment(&sky, scene);
    scene->part_hashes[SCENE_PART_OBJECTS] = objects.state;
    scene->part_hashes[SCENE_PART_MEDIA] = hash_of_rows(rows->media, scene->n_media);
    scene->part_hashes[SCENE_PART_SURFACES] = hash_of_rows(rows->surfaces, scene->n_surfaces);
    scene->part_hashes[SCENE_PART_LIGHTS] = lights.state;
    scene->part_hashes[SCENE_PART_CAMERAS] = cameras.state;
    scene->part_hashes[SCENE_PART_ENVIRONMENT] = sky.state;
}

/* Pictures of groups are of one render only where all is in the same group. */
static void add_light_groups(Hasher *h, const Scene *scene)
{
    if (scene->light_groups.n < 2) return;
    for (uint32_t i = 0; i < scene->light_groups.n; i++)
        add_bytes(h, scene->light_groups.names[i], strlen(scene->light_groups.names[i]));
    for (uint32_t i = 0; i < scene->n_lights; i++) add_integer(h, scene->lights[i].group);
    for (uint32_t i = 0; i < scene->n_surfaces; i++) add_integer(h, scene->surfaces[i].light_group);
    for (uint32_t i = 0; i < scene->n_media; i++) add_integer(h, scene->media[i].light_group);
    add_integer(h, scene->environment_group);
}

uint64_t scene_hash(Scene *scene, uint64_t environment_hash, Arena *scratch)
{
    Hasher h = {0};
    Rows rows = hash_rows(scene, scratch);
    hash_parts(scene, &rows, environment_hash);
    add_integer(&h, rows.media[0]);
    add_objects(&h, scene, &rows, scratch);
    if (scene->n_trees) add_trees(&h, scene);
    add_frames(&h, scene);
    add_lights(&h, scene);
    add_cameras(&h, scene);
    add_integer(&h, environment_hash);
    add_environment(&h, scene);
    add_light_groups(&h, scene);
    add_integer(&h, scene->film.width);
    add_integer(&h, scene->film.height);
    add_integer(&h, scene->film.box);
    add_integer(&h, scene->render.bounces);
    add_integer(&h, scene->render.nesting);
    add_integer(&h, scene->render.caustics);
    add_integer(&h, scene->render.seed);
    return h.state;
}

/* The textures that keys refer to are still ones of the scene, or have keys of their own: which they are does not matter. */
static void add_texture_keys(Hasher *h, const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_textures; i++) {
        const Texture *texture = &scene->textures[i];
        for (uint32_t k = 0; texture->keys && k < texture->n_keys; k++) {
            Texture key = texture->keys[k];
            key.low = key.high = key.blend = TEXTURE_NONE;
            add_integer(h, texture_hash(&key, NULL));
        }
    }
}

uint64_t scene_hash_with_motion(const Scene *scene)
{
    Hasher h = {scene->hash};
    add_number(&h, scene->shutter);
    add_integer(&h, scene->n_keys);
    for (size_t i = 0; i < (size_t)scene->n_motions * scene->n_keys; i++) add_map(&h, &scene->motions[i]);
    for (uint32_t i = 0; i < scene->n_objects; i++)
        if (scene->objects[i].motion != SCENE_NONE) add_integer(&h, i);
    for (uint32_t i = 0; i < scene->n_texture_frames; i++) add_integer(&h, scene->texture_frames[i].motion);
    for (uint32_t i = 0; i < scene->n_frames; i++) add_integer(&h, scene->frames[i].motion);
    for (uint32_t i = 0; i < scene->n_volumes; i++) add_integer(&h, scene->volume_places[i].motion);
    add_texture_keys(&h, scene);
    for (uint32_t i = 0; i < scene->n_shapes; i++)
        if (scene->shapes[i].mesh_end) add_mesh(&h, scene->shapes[i].mesh_end);
    for (uint32_t i = 0; i < scene->n_cameras; i++)
        for (uint32_t k = 0; scene->cameras[i].keys && k < scene->n_keys; k++)
            add_camera(&h, &scene->cameras[i].keys[k]);
    return h.state;
}

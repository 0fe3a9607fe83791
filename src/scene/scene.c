/* scene.c - letting go of a scene; what tells objects apart, the bounds of an object, where cameras are.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

#include "scene/between_planes.h"

void scene_free(Scene *scene)
{
    if (!scene) return;
    for (uint32_t i = 0; i < scene->n_shapes; i++) {
        mesh_free(scene->shapes[i].mesh);
        solid_free(scene->shapes[i].solid);
        mesh_free(scene->shapes[i].mesh_end);
        mesh_parts_clear(&scene->shapes[i].parts);
    }
    for (uint32_t i = 0; i < scene->n_images; i++) texture_image_free(scene->images[i]);
    for (uint32_t i = 0; i < scene->n_volumes; i++) volume_free(scene->volumes[i]);
    environment_free(scene->environment);
    free(scene->objects);
    free(scene->motions);
    free(scene->camera_keys);
    arena_clear(&scene->arena);
    free(scene);
}

NestState scene_mixing_state(const SceneMedium *medium, bool is_world)
{
    const float most_gaseous_ior = 1.01f; /* air: 1.0003; the densest vapours 1.002 */
    if (medium->state != NEST_STATE_UNKNOWN) return medium->state;
    return medium->mixes || is_world || spectrum_max(&medium->ior) <= most_gaseous_ior ? NEST_GAS : NEST_STATE_UNKNOWN;
}

bool scene_catches(const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_surfaces; i++)
        if (scene->surfaces[i].catches) return true;
    return false;
}

bool scene_has_portal(const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_lights; i++)
        if (scene->lights[i].kind == LIGHT_PORTAL) return true;
    return false;
}

bool scene_surface_has_pane(const Scene *scene, uint32_t surface)
{
    const SceneSurface *row = &scene->surfaces[surface];
    if (!row->mixed) return surface_is_pane(row);
    return !row->emits && (scene_surface_has_pane(scene, row->mix[0]) || scene_surface_has_pane(scene, row->mix[1]));
}

uint64_t scene_texture_identity(const Scene *scene, uint32_t object)
{
    const char *name = scene->objects[scene_whole(scene, object)].name;
    return hash_bytes(name, strlen(name), 0);
}

/* Around a circle of radius r about the y axis at height y: an image of a circle reaches as far along each axis as the
 * map's row without its y column is long. */
static Box3 circle_bounds(const Affine *map, double r, double y)
{
    Vec3 center = affine_point(map, vec3(0, y, 0));
    Vec3 reach = vec3(r * hypot(map->m[0][0], map->m[0][2]), r * hypot(map->m[1][0], map->m[1][2]),
                      r * hypot(map->m[2][0], map->m[2][2]));
    return (Box3){vec3_sub(center, reach), vec3_add(center, reach)};
}

/* Around a ball of radius r about the origin, whose image may be an ellipsoid. */
static Vec3 ball_reach(const Affine *map, double r)
{
    double half[3];
    for (int row = 0; row < 3; row++) half[row] = r * vec3_length(vec3(map->m[row][0], map->m[row][1], map->m[row][2]));
    return vec3(half[0], half[1], half[2]);
}

static const Box3 everywhere = {{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}};

static Box3 piece_bounds_under(const Piece *piece, const Affine *map)
{
    Box3 box;
    Vec3 reach;
    switch (piece->kind) {
    case PIECE_PLANE: return everywhere;
    case PIECE_SPHERE:
        reach = ball_reach(map, piece->r0);
        return (Box3){vec3_sub(map->t, reach), vec3_add(map->t, reach)};
    case PIECE_TORUS: /* a ball at every point of a circle */
        reach = ball_reach(map, piece->r1);
        box = circle_bounds(map, piece->r0, 0);
        return (Box3){vec3_sub(box.min, reach), vec3_add(box.max, reach)};
    case PIECE_BAND: /* lies between the two circles at its ends */
        return box3_union(circle_bounds(map, piece->r0, piece->y0), circle_bounds(map, piece->r1, piece->y1));
    default: return affine_box(map, piece_bounds(piece));
    }
}

static Box3 shape_bounds(const SceneShape *shape, const Affine *map)
{
    Box3 box = box3_empty();
    for (uint32_t i = 0; shape->mesh_end && i < shape->mesh_end->n_vertices; i++)
        box = box3_add_point(box, affine_point(map, vec3_from_f(shape->mesh_end->positions[i])));
    for (uint32_t i = 0; shape->mesh && i < shape->mesh->n_vertices; i++)
        box = box3_add_point(box, affine_point(map, vec3_from_f(shape->mesh->positions[i])));
    for (uint32_t i = 0; shape->solid && i < shape->solid->n_pieces; i++) {
        Box3 piece = piece_bounds_under(&shape->solid->pieces[i], map);
        if (!box3_is_empty(piece)) box = box3_union(box, piece);
    }
    return box;
}

static Box3 part_bounds(const Scene *scene, uint32_t number, const Affine *after)
{
    const NestPart *part = &scene->parts[number];
    if (part->operation == NEST_OPERAND)
        return scene_object_bounds(scene, &scene->objects[scene->operands[part->begin]], after);
    Box3 box = part->n_children ? part_bounds(scene, part->first_child, after) : box3_empty();
    for (uint32_t i = 1; i < part->n_children && part->operation != NEST_DIFFERENCE; i++) {
        Box3 other = part_bounds(scene, part->first_child + i, after);
        box = part->operation == NEST_UNION ? box3_union(box, other) : box3_intersection(box, other);
    }
    if (part->operation != NEST_UNION && box3_is_unbounded(box))
        box = box3_intersection(box, between_planes(scene, number, after));
    return box;
}

Box3 scene_object_bounds(const Scene *scene, const SceneObject *object, const Affine *after)
{
    if (object->tree != SCENE_NONE) return part_bounds(scene, scene->trees[object->tree].root, after);
    const Affine *keys = scene_keys(scene, object);
    Box3 box = box3_empty();
    for (uint32_t k = 0; k < (keys ? scene->n_keys : 1); k++) {
        const Affine *to_world = keys ? &keys[k] : &object->to_world;
        Affine map = after ? affine_compose(after, to_world) : *to_world;
        box = box3_union(box, shape_bounds(&scene->shapes[object->shape], &map));
    }
    return box;
}

const Affine *light_keys(const Scene *scene, const SceneLight *light)
{
    uint32_t motion = light->object == SCENE_NONE ? light->motion : scene->objects[light->object].motion;
    return scene_motion(scene, motion);
}

/* Whether every coordinate of an image comes from one coordinate alone, as without any turns, or with quarter turns. */
static bool keeps_axes(const Affine *map)
{
    for (int row = 0; row < 3; row++)
        if ((map->m[row][0] != 0) + (map->m[row][1] != 0) + (map->m[row][2] != 0) > 1) return false;
    return true;
}

Box3 scene_shape_bounds(const SceneShape *shape)
{
    Affine identity = affine_identity();
    return shape_bounds(shape, &identity);
}

/* Whether an object is a mesh that rests, with a vertex at least: then *known becomes what is known of its shape. */
static bool know_mesh(const Scene *scene, const SceneObject *object, SceneShapeBox *known)
{
    const SceneShape *shape = object->shape == SCENE_NONE ? NULL : &scene->shapes[object->shape];
    bool plain = shape && shape->mesh && !shape->mesh_end && !shape->solid && object->motion == SCENE_NONE;
    if (!plain || !shape->mesh->n_vertices) return false;
    if (known->shape != shape) *known = (SceneShapeBox){shape, scene_shape_bounds(shape)};
    return true;
}

Box3 scene_next_bounds(const Scene *scene, const SceneObject *object, SceneShapeBox *known)
{
    if (!keeps_axes(&object->to_world) || !know_mesh(scene, object, known))
        return scene_object_bounds(scene, object, NULL);
    return affine_box(&object->to_world, known->box); /* to the bit: rounding keeps the order of numbers */
}

Box3 scene_next_box_around(const Scene *scene, const SceneObject *object, SceneShapeBox *known)
{
    return know_mesh(scene, object, known) ? affine_box(&object->to_world, known->box)
                                           : scene_object_bounds(scene, object, NULL);
}

static Vec3 blend(Vec3 a, Vec3 b, double part)
{
    return vec3_add(vec3_scale(a, 1 - part), vec3_scale(b, part));
}

bool scene_caustics_from_text(const char *text, SceneCaustics *caustics)
{
    static const char *const words[] = {"automatic", "on", "off"};
    for (uint32_t i = 0; i < COUNT_OF(words); i++)
        if (strcmp(text, words[i]) == 0) {
            *caustics = (SceneCaustics)i;
            return true;
        }
    return false;
}

SceneCamera scene_camera_at(const Scene *scene, const SceneCamera *camera, double time)
{
    if (!camera->keys) return *camera;
    double place = time * (scene->n_keys - 1);
    uint32_t k = place < scene->n_keys - 2 ? (uint32_t)place : scene->n_keys - 2;
    double part = place - k;
    const SceneCamera *from = &camera->keys[k], *to = &camera->keys[k + 1];
    SceneCamera at = *camera;
    at.from = blend(from->from, to->from, part);
    at.forward = vec3_normalize(blend(from->forward, to->forward, part));
    at.right = blend(from->right, to->right, part);
    at.right = vec3_normalize(vec3_along(at.right, -vec3_dot(at.right, at.forward), at.forward));
    at.up = vec3_cross(at.right, at.forward);
    at.half_width = from->half_width * (1 - part) + to->half_width * part;
    for (int i = 0; i < 2; i++) at.shift[i] = from->shift[i] * (1 - part) + to->shift[i] * part;
    for (int i = 0; i < 3; i++) at.focus[i] = from->focus[i] * (1 - part) + to->focus[i] * part;
    return at;
}

Vec3 scene_camera_place(const Scene *scene, const SceneCamera *camera, double x, double y)
{
    if (camera->projection != PROJECTION_ORTHOGRAPHIC) return camera->from;
    double half_height = camera->half_width * scene->film.height / scene->film.width;
    return vec3_along(vec3_along(camera->from, x * camera->half_width, camera->right), y * half_height, camera->up);
}

Vec3 scene_camera_some_place(const Scene *scene, const SceneCamera *camera, uint32_t number)
{
    enum { EACH_WAY = 16 };
    uint32_t row = number / EACH_WAY, column = number % EACH_WAY;
    return scene_camera_place(scene, camera, (2 * column + 1.0) / EACH_WAY - 1, (2 * row + 1.0) / EACH_WAY - 1);
}

Box3 scene_camera_bounds(const Scene *scene, const SceneCamera *camera)
{
    Box3 box = box3_empty();
    for (int corner = 0; corner < 4; corner++)
        box = box3_add_point(box, scene_camera_place(scene, camera, corner & 1 ? 1 : -1, corner & 2 ? 1 : -1));
    return box;
}

uint32_t scene_volume_row(const Scene *scene, const Volume *volume)
{
    for (uint32_t i = 0; volume && i < scene->n_volumes; i++)
        if (scene->volumes[i] == volume) return i;
    return SCENE_NONE;
}

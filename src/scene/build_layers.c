/* build_layers.c - meshes whose parts overlap.
 *
 * A ray that is inside of a mesh cannot enter it again. Where parts of one mesh overlap, it is sorted into layers, each
 * of which is a mesh whose parts do not, and these are joined as a union is. This is done once for each shape, when it
 * is first used for something that has an inside.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/build_parts.h"

/* Puts the layers of one of the shape's meshes into their rows. */
static Status take_layers(Builder *b, uint32_t shape, uint32_t first, bool end, Error *error)
{
    SceneShape *shapes = b->scene->shapes;
    const MeshParts *parts = &shapes[shape].parts;
    Mesh **taken = ARENA_ARRAY(b->arena, Mesh *, parts->n_layers);
    Status status = mesh_take_layers(end ? shapes[shape].mesh_end : shapes[shape].mesh, parts, taken, error);
    for (uint32_t i = 0; i < parts->n_layers; i++)
        *(end ? &shapes[first + i].mesh_end : &shapes[first + i].mesh) = taken[i];
    return status;
}

/* Rows for the layers, after those of all other shapes. */
static Status make_layers(Builder *b, uint32_t shape, uint32_t *first, Error *error)
{
    uint32_t n = b->scene->shapes[shape].parts.n_layers;
    *first = b->scene->n_shapes;
    for (uint32_t i = 0; i < n; i++) b->scene->shapes[build_new_shape(b)].layer_of = shape;
    TRY(take_layers(b, shape, *first, false, error));
    if (b->scene->shapes[shape].mesh_end) TRY(take_layers(b, shape, *first, true, error));
    for (uint32_t i = 0; i < n; i++) {
        const Mesh *mesh = b->scene->shapes[*first + i].mesh;
        ShapeFacts *facts = &b->facts[*first + i];
        facts->bounds = mesh_bounds(mesh);
        facts->volume = mesh_volume(mesh);
        facts->closed = facts->consistent = true;
    }
    return STATUS_OK;
}

Layers build_layers(Builder *b, uint32_t shape)
{
    SceneShape *row = &b->scene->shapes[shape];
    if (!b->facts[shape].many_parts || !b->facts[shape].closed) return (Layers){shape, 1};
    if (!b->facts[shape].first_layer) {
        Error error;
        uint32_t first = shape;
        Status status = mesh_find_parts(row->mesh, row->mesh_end, &row->parts, &error);
        if (status == STATUS_OK && row->parts.n_layers > 1) status = make_layers(b, shape, &first, &error);
        if (!build_succeeded(b, status, &error, (Span){0})) return (Layers){shape, 1};
        row = &b->scene->shapes[shape];
        mesh_parts_clear(&row->parts);
        b->facts[shape].many_parts = row->parts.n_layers > 1;
        b->facts[shape].first_layer = first;
        if (row->parts.n_layers < 2) return (Layers){shape, 1};
    }
    return (Layers){b->facts[shape].first_layer, row->parts.n_layers};
}

void build_drop_layered(Builder *b)
{
    Scene *scene = b->scene;
    bool *used = ARENA_ARRAY(b->arena, bool, scene->n_shapes);
    for (uint32_t i = 0; i < scene->n_objects; i++)
        if (scene->objects[i].shape != SCENE_NONE) used[scene->objects[i].shape] = true;
    for (uint32_t i = 0; i < scene->n_shapes; i++) {
        SceneShape *shape = &scene->shapes[i];
        if (used[i] || shape->parts.n_layers < 2) continue;
        mesh_free(shape->mesh);
        mesh_free(shape->mesh_end);
        shape->mesh = shape->mesh_end = NULL;
    }
}

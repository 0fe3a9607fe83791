/* grower.c - a mesh in the making, whose size is not known before.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/grower.h"

#include <stdlib.h>

#include "base/array.h"

uint32_t grower_vertex(Grower *grower, Vec3 position, Vec3 normal)
{
    size_t n = grower->n_vertices;
    /* two more: Embree reads behind the last, and room is asked for by number */
    if (grower->out_of_memory || n >= UINT32_MAX - 2 ||
        !array_reserve(&grower->positions, &grower->positions_capacity, n + 2, sizeof *grower->positions) ||
        !array_reserve(&grower->normals, &grower->normals_capacity, n + 2, sizeof *grower->normals)) {
        grower->out_of_memory = true;
        return 0;
    }
    double length = vec3_length(normal);
    grower->positions[n] = vec3f_from(position);
    grower->normals[n] = length > 0 && isfinite(length) ? vec3f_from(vec3_scale(normal, 1 / length)) : vec3f(0, 0, 0);
    grower->n_vertices = n + 1;
    return (uint32_t)n;
}

static bool same_place(Vec3f a, Vec3f b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

void grower_triangle(Grower *grower, uint32_t a, uint32_t b, uint32_t c)
{
    if (grower->out_of_memory || grower->too_large) return;
    Vec3f pa = grower->positions[a], pb = grower->positions[b], pc = grower->positions[c];
    if (same_place(pa, pb) || same_place(pb, pc) || same_place(pc, pa)) return;
    size_t n = grower->n_triangles;
    if (n >= GROWER_MAX_TRIANGLES) {
        grower->too_large = true;
        return;
    }
    if (!array_reserve(&grower->triangles, &grower->triangles_capacity, n + 2, sizeof *grower->triangles)) {
        grower->out_of_memory = true;
        return;
    }
    grower->triangles[n][0] = a;
    grower->triangles[n][1] = b;
    grower->triangles[n][2] = c;
    grower->n_triangles = n + 1;
}

void grower_quad(Grower *grower, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    grower_triangle(grower, a, b, c);
    grower_triangle(grower, a, c, d);
}

void grower_clear(Grower *grower)
{
    free(grower->positions);
    free(grower->normals);
    free(grower->triangles);
    *grower = (Grower){0};
}

Status grower_finish(Grower *grower, const char *what, Mesh **mesh, Error *error)
{
    Status status = STATUS_OK;
    if (grower->out_of_memory)
        status = fail_memory(error, grower->n_vertices * 2 * sizeof(Vec3f) + grower->n_triangles * 12, what);
    else if (grower->too_large)
        status = fail(error, STATUS_SCENE, "%s would have more than %d triangles", what, GROWER_MAX_TRIANGLES);
    else if (!grower->n_triangles)
        status = fail(error, STATUS_SCENE, "%s has no extent", what);
    Mesh *made = status == STATUS_OK ? calloc(1, sizeof *made) : NULL;
    if (status == STATUS_OK && !made) status = fail_memory(error, sizeof *made, what);
    if (status != STATUS_OK) {
        grower_clear(grower);
        return status;
    }
    *made = (Mesh){.positions = grower->positions,
                   .normals = grower->normals,
                   .triangles = grower->triangles,
                   .n_vertices = (uint32_t)grower->n_vertices,
                   .n_triangles = (uint32_t)grower->n_triangles};
    *grower = (Grower){0};
    status = mesh_weld(made, NULL, error);
    if (status == STATUS_OK) status = mesh_normalize_normals(made, error);
    if (status == STATUS_OK)
        *mesh = made;
    else
        mesh_free(made);
    return status;
}

/* icosphere.h - a sphere as a mesh of nearly equal triangles, for tests and benches: an icosahedron, split again and again.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_ICOSPHERE_H
#define MEN_TEST_ICOSPHERE_H

#include <stdlib.h>
#include <string.h>

#include "mesh/mesh.h"

/* The triangle and, of each edge, the middle on the unit sphere; then each of the four parts, down to the mesh. */
static inline void icosphere_split(Mesh *mesh, double radius, unsigned subdivisions, const Vec3 corners[3])
{
    if (subdivisions == 0) {
        uint32_t first = mesh->n_vertices;
        for (uint32_t k = 0; k < 3; k++) {
            mesh->positions[first + k] = vec3f_from(vec3_scale(corners[k], radius));
            mesh->normals[first + k] = vec3f_from(corners[k]);
            mesh->triangles[mesh->n_triangles][k] = first + k;
        }
        mesh->n_vertices += 3;
        mesh->n_triangles++;
        return;
    }
    Vec3 a = corners[0], b = corners[1], c = corners[2];
    Vec3 ab = vec3_normalize(vec3_add(a, b)), bc = vec3_normalize(vec3_add(b, c)), ca = vec3_normalize(vec3_add(c, a));
    const Vec3 parts[4][3] = {{ab, bc, ca}, {a, ab, ca}, {b, bc, ab}, {c, ca, bc}};
    for (int i = 0; i < 4; i++) icosphere_split(mesh, radius, subdivisions - 1, parts[i]);
}

/* About the origin: 20 * 4^subdivisions triangles, vertices on the sphere, with its normals; NULL where memory lacks. */
static inline Mesh *icosphere(double radius, unsigned subdivisions)
{
    static const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    const double g = 1.618033988749895; /* the golden ratio: three rectangles of such sides have the corners */
    const Vec3 corners[12] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    uint32_t n_triangles = 20U << 2 * subdivisions;
    Mesh *mesh;
    if (mesh_new(3 * n_triangles, n_triangles, true, false, &mesh, NULL) != STATUS_OK) return NULL;
    mesh->n_vertices = mesh->n_triangles = 0;
    for (int i = 0; i < 20; i++) {
        const Vec3 face[3] = {vec3_normalize(corners[faces[i][0]]), vec3_normalize(corners[faces[i][1]]),
                              vec3_normalize(corners[faces[i][2]])};
        icosphere_split(mesh, radius, subdivisions, face);
    }
    if (mesh_weld(mesh, NULL, NULL) == STATUS_OK) return mesh;
    mesh_free(mesh);
    return NULL;
}

#endif

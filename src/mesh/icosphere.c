/* icosphere.c - a sphere as a mesh of nearly equal triangles: an icosahedron, split again and again.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "mesh/mesh.h"

enum { MAX_SUBDIVISIONS = 9 };

/* The vertices made so far, with a table of the edges that already have their middle. */
typedef struct SphereMaker {
    Vec3 *points; /* unit */
    uint32_t n_points;
    struct {
        uint64_t edge; /* both ends, the lower number above; 0: free (no edge has the end 0 twice) */
        uint32_t middle;
    } * table;
    size_t room;
} SphereMaker;

static uint32_t edge_middle(SphereMaker *maker, uint32_t a, uint32_t b)
{
    uint64_t edge = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    size_t slot = (size_t)hash_u64(edge) & (maker->room - 1);
    while (maker->table[slot].edge && maker->table[slot].edge != edge) slot = (slot + 1) & (maker->room - 1);
    if (!maker->table[slot].edge) {
        maker->table[slot].edge = edge;
        maker->table[slot].middle = maker->n_points;
        maker->points[maker->n_points++] = vec3_normalize(vec3_add(maker->points[a], maker->points[b]));
    }
    return maker->table[slot].middle;
}

static void make_icosahedron(SphereMaker *maker, uint32_t (*triangles)[3])
{
    /* The rectangles of sides 1 and the golden ratio in the three planes of the axes. */
    static const signed char ends[12][2] = {{-1, 1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1},
                                            {-1, -1}, {1, -1}, {-1, 1}, {1, 1}, {-1, -1}, {1, -1}};
    static const uint32_t faces[20][3] = {
        {0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
        {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8}, {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1},
    };
    const double golden = 0.5 * (1 + sqrt(5));
    for (uint32_t i = 0; i < 12; i++) {
        double shorter = ends[i][0], longer = golden * ends[i][1];
        Vec3 p = i < 4 ? vec3(shorter, longer, 0) : i < 8 ? vec3(0, shorter, longer) : vec3(longer, 0, shorter);
        maker->points[i] = vec3_normalize(p);
    }
    maker->n_points = 12;
    memcpy(triangles, faces, sizeof faces);
}

/* Each of the first n triangles becomes four. */
static void split_triangles(SphereMaker *maker, uint32_t (*triangles)[3], uint32_t n)
{
    memset(maker->table, 0, maker->room * sizeof *maker->table);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = triangles[i][0], b = triangles[i][1], c = triangles[i][2];
        uint32_t ab = edge_middle(maker, a, b), bc = edge_middle(maker, b, c), ca = edge_middle(maker, c, a);
        const uint32_t parts[4][3] = {{ab, bc, ca}, {a, ab, ca}, {b, bc, ab}, {c, ca, bc}};
        memcpy(triangles[i], parts[0], sizeof parts[0]);
        memcpy(triangles[n + 3 * i], parts[1], 3 * sizeof parts[0]);
    }
}

Status mesh_make_sphere(double radius, unsigned subdivisions, Mesh **mesh, Error *error)
{
    if (!(radius > 0) || !(radius <= 1e15))
        return fail(error, STATUS_SCENE, "a sphere's radius must be greater than 0 and at most 1e15; it is %g", radius);
    if (subdivisions > MAX_SUBDIVISIONS)
        return fail(error, STATUS_SCENE, "a sphere can be subdivided at most %d times, not %u", MAX_SUBDIVISIONS, subdivisions);
    uint32_t n_triangles = 20U << 2 * subdivisions;
    uint32_t n_vertices = n_triangles / 2 + 2; /* Euler */
    Mesh *made;
    TRY(mesh_new(n_vertices, n_triangles, true, false, &made, error));
    SphereMaker maker = {.room = 64};
    while (maker.room < 2 * (size_t)n_triangles) maker.room *= 2; /* at most 3/8 n edges are split at a time */
    maker.points = malloc(n_vertices * sizeof *maker.points);
    maker.table = malloc(maker.room * sizeof *maker.table);
    Status status = STATUS_OK;
    if (maker.points && maker.table) {
        make_icosahedron(&maker, made->triangles);
        for (uint32_t n = 20; n < n_triangles; n *= 4) split_triangles(&maker, made->triangles, n);
        for (uint32_t i = 0; i < n_vertices; i++) {
            made->positions[i] = vec3f_from(vec3_scale(maker.points[i], radius));
            made->normals[i] = vec3f_from(maker.points[i]);
        }
        *mesh = made;
    } else {
        mesh_free(made);
        status = fail_memory(error, maker.room * sizeof *maker.table, "a sphere");
    }
    free(maker.points);
    free(maker.table);
    return status;
}

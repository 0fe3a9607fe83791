/* mesh.h - triangle meshes: storage, closedness, orientation, enclosed volume.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MESH_H
#define MEN_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/status.h"
#include "base/vec3.h"

/* Owns its arrays. Triangles are counter-clockwise seen from outside. */
typedef struct Mesh {
    Vec3f *positions; /* n_vertices, with 4 bytes of padding behind the last (Embree reads them) */
    Vec3f *normals;   /* per vertex, unit, outward; NULL: flat */
    float *uvs;       /* 2 per vertex, NULL: none */
    uint32_t n_vertices;
    uint32_t (*triangles)[3];
    uint32_t n_triangles;
} Mesh;

void mesh_free(Mesh *mesh); /* the arrays and the mesh itself; NULL is fine */
/* A mesh with zeroed arrays of that size; normals and uvs only when asked for. */
ATTR_NODISCARD Status mesh_new(uint32_t n_vertices, uint32_t n_triangles, bool normals, bool uvs, Mesh **mesh,
                               Error *error);
ATTR_NODISCARD Status mesh_copy(const Mesh *mesh, Mesh **copy, Error *error);

/* Binary little- and big-endian and text PLY; polygons are fanned. Indices out of range, NaN and
 * infinite vertices, truncation and lying headers are STATUS_INPUT with the place. Own reader:
 * a million triangles take about a hundredth of a second (libs.md). */
ATTR_NODISCARD Status mesh_load_ply(const char *path, Mesh **mesh, Error *error);
/* Wavefront OBJ: v, vn, vt, f (any polygon, negative indices); groups and materials are ignored. */
ATTR_NODISCARD Status mesh_load_obj(const char *path, Mesh **mesh, Error *error);
/* By extension (.ply, .obj); others are STATUS_INPUT with the list of what can be read. */
ATTR_NODISCARD Status mesh_load(const char *path, Mesh **mesh, Error *error);

/* Merges vertices whose positions (and normals and uvs, where present) are equal bit by bit (-0 = 0). */
ATTR_NODISCARD Status mesh_weld(Mesh *mesh, Error *error);
/* Moves every vertex; a map that mirrors also turns the triangles round, so that outside stays outside. */
void mesh_transform(Mesh *mesh, const Affine *transform);

/* What closedness means: every undirected edge, by position, is used equally often in both directions. */
typedef struct MeshReport {
    uint32_t n_open_edges;          /* used in one direction more than in the other */
    uint32_t n_non_manifold_edges;  /* used by more than two triangles */
    uint32_t n_degenerate;          /* triangles with two equal vertices or no area */
    uint32_t n_duplicate;           /* triangles that occur twice with the same orientation */
    uint32_t n_components;          /* connected by shared edges */
    uint32_t n_inverted;            /* components that enclose negative volume by themselves: cavities, or inside-out */
    bool inside_out;                /* the sum of the volumes is negative: the mesh as a whole is reversed */
    bool consistent;                /* neighbouring triangles agree on the orientation */
    bool closed;                    /* no open edge, consistent, no NaN */
    struct { Vec3f a, b; } open[4]; /* the first open edges */
    double volume;                  /* signed, of the whole */
    double area;
    Box3 bounds;
} MeshReport;

/* Positions are compared bit by bit, so a mesh that splits its vertices for normals or uvs is closed all
 * the same. */
ATTR_NODISCARD Status mesh_inspect(const Mesh *mesh, MeshReport *report, Error *error);
/* Turns triangles so that neighbours agree, and the whole outward; false when it cannot be (a Moebius
 * band, non-manifold edges). Cavities stay: a component inside another keeps its opposite sense when it
 * had it relative to its own neighbours. */
ATTR_NODISCARD Status mesh_orient(Mesh *mesh, bool *mended, Error *error);
/* Divergence theorem over the triangles, double precision, relative to the mesh's centre. */
double mesh_volume(const Mesh *mesh);

/* Makers of closed meshes. */
/* A box with corners from and to whose edges are bevelled by `bevel` (0: a plain box of 12 triangles) in
 * `segments` steps (1: flat chamfers; more: rounded, with smooth normals on the rounds). */
ATTR_NODISCARD Status mesh_make_box(Vec3 from, Vec3 to, double bevel, unsigned segments, Mesh **mesh, Error *error);

#endif

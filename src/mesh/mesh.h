/* mesh.h - triangle meshes: storage, closedness, orientation, enclosed volume.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MESH_H
#define MEN_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "base/pool.h"
#include "base/status.h"
#include "base/vec3.h"

/* Triangles that follow each other and cover a polygon of the file. */
typedef struct MeshCut {
    uint32_t first, n;
} MeshCut;

/* Owns its arrays. Triangles are counter-clockwise seen from outside. */
typedef struct Mesh {
    Vec3f *positions; /* n_vertices, with 4 bytes of padding behind the last (Embree reads them) */
    Vec3f *normals;   /* per vertex, unit, outward; NULL: flat */
    float *uvs;       /* 2 per vertex, v upward on a picture; NULL: none */
    uint32_t n_vertices;
    uint32_t (*triangles)[3];
    uint32_t n_triangles;
    bool distinct;         /* it is known that no two vertices stand at one place */
    uint32_t grid_columns; /* of a grid of heights, whose cells are cut along the diagonal that is less steep; else 0 */
    MeshCut *cuts;         /* those that are no fans; of the mesh as it was read */
    size_t n_cuts, cuts_capacity;
} Mesh;

/* Of a triangle, to its outer side; twice its area is its length. */
static inline Vec3 mesh_area_normal(const Mesh *mesh, uint32_t triangle)
{
    const uint32_t *t = mesh->triangles[triangle];
    Vec3 a = vec3_from_f(mesh->positions[t[0]]);
    return vec3_cross(vec3_sub(vec3_from_f(mesh->positions[t[1]]), a), vec3_sub(vec3_from_f(mesh->positions[t[2]]), a));
}

void mesh_free(Mesh *mesh); /* the arrays and the mesh itself; NULL is fine */
/* A mesh with zeroed arrays of that size; normals and uvs only when asked for. */
ATTR_NODISCARD Status mesh_new(uint32_t n_vertices, uint32_t n_triangles, bool normals, bool uvs, Mesh **mesh,
                               Error *error);

/* Whether two meshes differ in nothing but places and normals. */
bool mesh_same_triangles(const Mesh *a, const Mesh *b);
/* Merges vertices whose positions (and normals and uvs, where present) are equal bit by bit (-0 = 0), and
 * drops those that no triangle uses. The pool, here and below, may be NULL, and makes no difference to the result. */
ATTR_NODISCARD Status mesh_weld(Mesh *mesh, Pool *pool, Error *error);
/* Vertices that came to stand at one place. */
typedef struct MeshJoin {
    uint32_t n_joined; /* places that others took the place of; 0: nothing was joined */
    double farthest;   /* the largest distance between two that are neighbours among these */
} MeshJoin;

/* Closes a mesh whose seams are open by the last bits: vertices on open edges that are within a distance of each other, and
 * nearer than a quarter of the edges there, move to one place, if that leaves no edge open, crowds none and
 * collapses no triangle, except those that have an open edge shorter than the rounding of their coordinates, which is no edge here;
 * else the mesh stays as it is. within < 0: a millionth of the mesh's diagonal. end: NULL, or the same
 * triangles later, whose vertices move alike. Positions that triangles use must be finite. O(n) memory. */
ATTR_NODISCARD Status mesh_join(Mesh *mesh, Mesh *end, double within, Pool *pool, MeshJoin *join, Error *error);
/* Looks for the distance within which mesh_join would close the mesh, up to `most` of its diagonal, and leaves it as it is: any from
 * join->farthest to *within will do. join->n_joined 0: there is none. */
ATTR_NODISCARD Status mesh_find_join(Mesh *mesh, double most, Pool *pool, MeshJoin *join, double *within, Error *error);

/* Moves every vertex; a map that mirrors also turns the triangles round, so that outside stays outside. */
void mesh_transform(Mesh *mesh, const Affine *transform);

/* Makes the normals unit; one without length becomes the mean of its triangles' normals by area. */
ATTR_NODISCARD Status mesh_normalize_normals(Mesh *mesh, Error *error);

/* Gives the mesh normals at its vertices, in place of any that it has: those of the triangles around them, by their angles there, as
 * far as edges lead from one to the next at which two triangles turn by less than crease_rad; at other edges vertices are split.
 * Positions and triangles stay what they are. end: NULL, or the same triangles later, whose vertices are split alike. O(n). */
ATTR_NODISCARD Status mesh_make_normals(Mesh *mesh, Mesh *end, double crease_rad, Pool *pool, Error *error);

/* Whether its facets are likely to stand for something that is curved: there are many, and of the edges where two of them turn at all,
 * less than half turn by half of crease_rad or more. A cut gem has fewer facets. */
ATTR_NODISCARD Status mesh_is_rounded(Mesh *mesh, double crease_rad, bool *rounded, Error *error);

/* What closedness means: every undirected edge, by position, is used equally often in both directions. */
typedef struct MeshReport {
    uint32_t n_open_edges;         /* edges used in one direction more than in the other */
    uint32_t n_non_manifold_edges; /* used by more than two triangles */
    uint32_t n_degenerate;         /* triangles with two equal vertices or no area */
    uint32_t n_duplicate;          /* triangles that occur twice with the same orientation */
    uint32_t n_components;         /* connected by shared edges */
    uint32_t n_inverted;           /* components that enclose negative volume by themselves: cavities, or inside-out */
    bool inside_out;               /* the sum of the volumes is negative: the mesh as a whole is reversed */
    bool consistent;               /* neighbouring triangles agree on the orientation: no edge is used two or more
                                     * times more in one direction than in the other */
    bool finite;                   /* no NaN, no infinity among the positions that triangles use */
    bool closed;                   /* at least one triangle, no open edge, consistent, finite */
    struct {
        Vec3f a, b;
    } open[4]; /* the first open edges */
    struct {
        Vec3f a, b;
    } non_manifold[4]; /* the first of those */
    double volume;     /* signed, of the whole */
    double area;
    Box3 bounds;
} MeshReport;

/* Positions are compared bit by bit (-0 = 0), so a mesh that splits its vertices for normals or uvs is
 * closed all the same. Triangles with two equal vertices have no part in edges and components. */
ATTR_NODISCARD Status mesh_inspect(const Mesh *mesh, Pool *pool, MeshReport *report, Error *error);
/* The same of what is open only by the last bits, once mesh_join has closed it. *join: of nothing where that was not needed. */
ATTR_NODISCARD Status mesh_inspect_joined(Mesh *mesh, MeshJoin *join, MeshReport *report, Error *error);
/* Numbers the vertices by position: each has the number of the first vertex at its place, bit by bit (-0 = 0). *ids is
 * malloc'd, n_vertices long. */
ATTR_NODISCARD Status mesh_number_positions(const Mesh *mesh, Pool *pool, uint32_t **ids, Error *error);

/* Where a mesh passes through itself. */
typedef struct MeshCrossings {
    uint64_t n;   /* pairs of triangles that cross, or overlap in one plane and look the same way */
    bool gave_up; /* too many triangles lie in each other's boxes, and not all pairs were looked at: n is the least */
    uint32_t n_places; /* of first[] */
    struct {
        uint32_t triangles[2];
        Vec3f place; /* a point that both have in common, rounded */
    } first[4];      /* apart from each other */
} MeshCrossings;

/* Neighbours do not cross, nor do parts that touch from outside (with a corner, along an edge, or face to face); a part
 * that touches from within does. Decided without rounding; positions must be finite. A million triangles of a smooth
 * surface take about half a second of one processor. The pool may be NULL; the result does not depend on it. */
ATTR_NODISCARD Status mesh_find_crossings(const Mesh *mesh, Pool *pool, MeshCrossings *found, Error *error);

/* The bodies that a closed mesh consists of: triangles that are joined and closed by themselves, with the cavities in
 * them. */
typedef struct MeshParts {
    uint32_t n_bodies;
    uint32_t n_overlapping; /* bodies that share some of their inside with another */
    uint32_t n_within;  /* of these: those wholly within another, not in a cavity of it: matter that is there twice */
    Vec3f place;        /* on a body, where it overlaps another */
    Vec3f within_place; /* on the first that is within another */
    bool gave_up;       /* too many overlap, and not all are known */
    uint32_t n_layers;  /* sets of bodies, in each of which none overlaps another; 1: none does in all of the mesh */
    uint32_t *layer;    /* of each triangle; NULL when there is one */
} MeshParts;
/* Bodies that touch from outside do not overlap. A cavity that breaks through the wall of its body, or into another one
 * of the same body, makes no parts. end: NULL, or where the same triangles are later, which counts, too. Near-linear in
 * the triangles where boxes of bodies are apart. */
ATTR_NODISCARD Status mesh_find_parts(const Mesh *mesh, const Mesh *end, MeshParts *parts, Error *error);
void mesh_parts_clear(MeshParts *parts);
/* The triangles of each layer, with the vertices that they use: n_layers meshes. After a failure, taken has those that
 * were made before. */
ATTR_NODISCARD Status mesh_take_layers(const Mesh *mesh, const MeshParts *parts, Mesh **taken, Error *error);

/* Turns triangles so that neighbours agree, and the whole outward; false, with the mesh as it was, when
 * it cannot be (a Moebius band, edges of more than two triangles that do not come out even).
 * The rule: triangles joined by edges of exactly two triangles are a sheet. In every sheet the fewest
 * triangles are turned that make it agree with itself. If the mesh is then closed: when the sum of the
 * volumes is negative, everything is turned; a sheet that still encloses negative volume is a cavity and
 * stays so if it is inside the rest of the mesh (by winding number), and is turned outward if it is not. A
 * sheet that encloses positive volume stays. Normals stay, see mesh_turn_normals. */
ATTR_NODISCARD Status mesh_orient(Mesh *mesh, Pool *pool, bool *mended, Error *error);
/* Turns vertex normals that point against the triangles around them, and counts them. */
ATTR_NODISCARD Status mesh_turn_normals(Mesh *mesh, uint32_t *n_turned, Error *error);
/* Around all vertices. */
Box3 mesh_bounds(const Mesh *mesh);
/* Divergence theorem over the triangles, double precision, relative to the mesh's centre. */
double mesh_volume(const Mesh *mesh);

/* Makers of closed meshes. */
/* A box between two opposite corners, in any order, whose edges are bevelled by `bevel` (0: a plain box of
 * 12 triangles) in `segments` steps, 1..256 (1: flat chamfers; more: rounded, with normals that are smooth
 * on the rounds and meet the flat faces' own at their borders). STATUS_SCENE when the box has no volume or
 * the bevel is more than half of its shortest side. */
ATTR_NODISCARD Status mesh_make_box(Vec3 from, Vec3 to, double bevel, unsigned segments, Mesh **mesh, Error *error);

#endif

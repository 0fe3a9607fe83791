/* implicit.h - closed meshes of what a function of space says is inside.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_IMPLICIT_H
#define MEN_IMPLICIT_H

#include "base/pool.h"
#include "mesh/mesh.h"

/* The points of a grid: origin + step * (i, j, k), i < n[0], j < n[1], k < n[2]. */
typedef struct Lattice {
    Vec3 origin, step;
    uint32_t n[3];
} Lattice;

static inline Vec3 lattice_point(const Lattice *lattice, uint32_t i, uint32_t j, uint32_t k)
{
    return vec3(lattice->origin.x + lattice->step.x * i, lattice->origin.y + lattice->step.y * j,
                lattice->origin.z + lattice->step.z * k);
}

/* A function that is positive inside, and continuous, but for jumps. The calls return false when they cannot go on; whoever gave the
 * field knows why. */
typedef struct ImplicitField {
    void *context;
    /* values[j * n[0] + i] of the points of layer k; of those whose wanted[] is 0 they stay what they are. NULL: all are */
    bool (*layer)(void *context, const Lattice *lattice, uint32_t k, const uint8_t *wanted, double *values);
    bool (*value)(void *context, Vec3 p, double *value);
    /* The same, asked by any thread, and false where it is value() that has to be asked. NULL: it always has to */
    bool (*shared_value)(void *context, Vec3 p, double *value);
    bool (*gradient)(void *context, Vec3 p, Vec3 *gradient); /* asked by any thread; NULL: by differences of values */
    /* What all values of a layer's points within the box are between; false where that is not known. Asked by any thread.
     * NULL: never known */
    bool (*bounds)(void *context, Box3 box, double *low, double *high);
} ImplicitField;

typedef struct ImplicitOptions {
    Box3 bounds;         /* what reaches beyond is cut off flat */
    double tolerance;    /* how far the surface may be from the triangles */
    uint32_t cells;      /* along the longest side of the bounds, to begin with: what is smaller can be missed */
    uint64_t max_points; /* of the finest grid */
    Pool *pool;          /* may be NULL */
} ImplicitOptions;

typedef struct ImplicitFound {
    double reached;                  /* how far the surface is from the triangles: 99 of 100 samples keep to that */
    bool jumps;                      /* the function jumps from inside to outside, */
    Vec3 jump_at;                    /* here as much as anywhere, */
    double inner_value, outer_value; /* from this to that */
} ImplicitFound;

/* Marching tetrahedra: cubes of a grid are cut into six tetrahedra each, of which neighbours share whole faces, so
 * that the mesh is closed and manifold whatever the function does. Vertices are moved onto the surface along their
 * edges, normals are those of the function, or of the triangles where it jumps. The grid is made finer until the tolerance is
 * reached, or max_points. STATUS_SCENE when nothing is inside, and without a text when a call of
 * the field returned false. */
ATTR_NODISCARD Status mesh_make_implicit(const ImplicitField *field, const ImplicitOptions *options, const char *what,
                                         Mesh **mesh, ImplicitFound *found, Error *error);

/* ---- blobs (blob.c) ---- */

/* Density strength * (1 - (d / radius)^2)^2 at distance d from a point (from = to) or a line, in a frame of its own. */
typedef struct BlobComponent {
    Affine to_world;
    Vec3 from, to;
    double radius, strength;
} BlobComponent;

/* Where the densities add up to more than the threshold. */
typedef struct BlobShape {
    const BlobComponent *components;
    size_t n;
    double threshold, tolerance; /* tolerance 0: a 4000th of its extent */
} BlobShape;
/* reached: the tolerance that is kept. */
ATTR_NODISCARD Status mesh_make_blob(const BlobShape *shape, Pool *pool, Mesh **mesh, double *reached, Error *error);

#endif

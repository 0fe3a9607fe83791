/* meshed.h - makers of closed solids that consist of triangles: as smooth as asked for, with normals.
 * Mistakes in what is to be made are STATUS_SCENE, with the place.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MESHED_H
#define MEN_MESHED_H

#include "base/pool.h"
#include "mesh/grower.h"
#include "shape/polygon.h"

/* ---- prisms (prism.c) ---- */

typedef struct PrismShape {
    double from, to;             /* heights, in any order */
    double scale_from, scale_to; /* of the outline at these heights, about the origin; one of them may be 0 */
    double bevel;                /* takes so much from the edges of both ends; only with equal scales of 1 */
    unsigned bevel_segments;     /* 1: flat; more: rounded */
} PrismShape;

/* Adds the solid over a clean outline (polygon_clean) in x and y, between two heights in z. */
ATTR_NODISCARD Status prism_add(Grower *grower, const Outline2 *outline, const PrismShape *shape, Error *error);

/* ---- sweeps (sweep.c) ---- */

typedef enum SweepCurve {
    SWEEP_LINEAR, /* straight, with mitres */
    SWEEP_CUBIC,  /* a Catmull-Rom spline through the path's points */
    SWEEP_NATURAL /* a curve through them whose curvature does not jump; open ends do not bend */
} SweepCurve;

typedef struct SweepShape {
    const Vec3 *path;
    size_t n_path;        /* at least 2; closed: at least 3 */
    const double *scales; /* n_scales: 1, or one for each point of the path; not negative */
    size_t n_scales;
    const Outline2 *outline; /* clean; its y towards `up` where the path begins. NULL: the circle of radius 1 */
    Vec3 up;
    SweepCurve curve;        /* of the path; the scales go from point to point likewise */
    bool closed, round_ends; /* round_ends: half balls; only without an outline */
    double twist;            /* degrees, from the path's begin to its end */
    double tolerance;
    unsigned segments; /* of the circle; 0: by the tolerance */
} SweepShape;

/* What there is to say of a sweep beside its mesh. */
typedef struct SweepFound {
    bool folds;  /* the path bends more than the outline allows: then there is an error, and no sweep */
    double fits; /* and so many times its size does not fold anywhere; 0: none does */
    double
        reached; /* above 0: it is round, and folds or runs into itself; its triangles are so far from the surface of the union */
} SweepFound;

/* An outline that is moved along a path, turned as little as possible: rotation minimizing frames by double reflection
 * (W. Wang, B. Juettler, D. Zheng, Y. Liu, "Computation of Rotation Minimizing Frames", ACM TOG 27(1), 2008). Round ones may bend as
 * they like, and run into themselves. STATUS_SCENE with the place where the path bends more than an outline allows. */
ATTR_NODISCARD Status mesh_make_sweep(const SweepShape *shape, Pool *pool, Mesh **mesh, SweepFound *found,
                                      Error *error);

/* ---- superellipsoids (superellipsoid.c) ---- */

/* (|x/a|^(2/e) + |y/b|^(2/e))^(e/n) + |z/c|^(2/n) <= 1 with radii (a, b, c), e and n in 0.01 .. 10. Points lie on it;
 * between them the surface stays within the tolerance, and they stand closer where it bends. */
ATTR_NODISCARD Status mesh_make_superellipsoid(double e, double n, Vec3 radii, double tolerance, Mesh **mesh,
                                               Error *error);

/* ---- height fields (height_field.c) ---- */

/* Heights over a grid of n_x times n_z points, row after row, x within a row, that fills 0 .. size.x and 0 .. size.z;
 * a height of 1 stands for size.y. */
typedef struct HeightField {
    const float *heights;
    uint32_t n_x, n_z;
    Vec3 size;
    double base; /* the height that its sides go down to, below all others */
    bool smooth; /* with normals of the surface through the points; else flat triangles */
} HeightField;
ATTR_NODISCARD Status mesh_make_height_field(const HeightField *field, Mesh **mesh, Error *error);

#endif

/* volume.h - a quantity that varies in space: values on a lattice, linear in between along each axis.
 *
 * The lattice is cut into bricks of 8 x 8 x 8 cells, each with all the values at its corners, so that a value is looked
 * up within one brick. A brick knows the smallest and the largest of its values, which bound what is between them: free
 * flights through a medium need such bounds, and take them brick by brick. A brick whose values are all the same has
 * none stored, so that the empty parts of a grid cost next to nothing.
 *
 * Lattice coordinates count values: value (i, j, k) is at (i, j, k), and the grid is the box from 0 to n - 1.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_VOLUME_H
#define MEN_VOLUME_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"
#include "base/vec3.h"

enum {
    VOLUME_BRICK = 8,
    VOLUME_EDGE = VOLUME_BRICK + 1,
    VOLUME_BRICK_VALUES = VOLUME_EDGE * VOLUME_EDGE * VOLUME_EDGE
};
#define VOLUME_UNIFORM UINT32_MAX

typedef struct VolumeBrick {
    float low, high, mean;
    uint32_t values; /* which of the blocks of values, x running fastest; VOLUME_UNIFORM: all are `low` */
} VolumeBrick;

typedef struct Volume {
    Affine to_lattice; /* from where the grid is placed to lattice coordinates */
    int32_t n_points[3];
    int32_t n_bricks[3];
    VolumeBrick *bricks; /* x running fastest */
    float *values;       /* blocks of VOLUME_BRICK_VALUES */
    uint32_t n_blocks;
    float outside; /* the value outside of the grid */
    float largest; /* anywhere */
} Volume;

/* Fills in the values of a brick whose first value is at (first[0], first[1], first[2]); of values outside of the grid
 * anything may be said. *uniform set: all are values[0]. What is not a Status of STATUS_OK ends the making. */
typedef Status VolumeFill(void *context, const int32_t first[3], float values[VOLUME_BRICK_VALUES], bool *uniform,
                          Error *error);

/* n_points: at least 2 along each axis. Values must be finite. most_bytes: of memory, no more than which is taken;
 * STATUS_NOMEM says how much it would have been as far as it came. what: for that message, "the grid 'density'". */
ATTR_NODISCARD Status volume_new(const int32_t n_points[3], VolumeFill *fill, void *context, float outside,
                                 size_t most_bytes, const char *what, Volume **out, Error *error);
void volume_free(Volume *volume); /* NULL is fine */
size_t volume_bytes(const Volume *volume);

/* Multiplies all values. factor >= 0. */
void volume_scale(Volume *volume, float factor);

/* The value at a place in lattice coordinates. */
float volume_at(const Volume *volume, Vec3 place);

/* A straight line through a volume, from piece to piece: what is before the grid, one brick after another, and what is
 * behind. Neighbouring pieces that are uniform and alike are one. */
typedef struct VolumeWalk {
    const Volume *volume;
    double origin[3], direction[3]; /* in lattice coordinates, per unit of t */
    double t_end;                   /* of the present piece; INFINITY in the last one */
    double t_leave;                 /* where the line leaves the grid */
    double next[3];                 /* where it leaves the present brick along each axis */
    float low, high;                /* bounds of the value in the present piece */
    int32_t cell[3];                /* the brick, and on which side of all of them where it is none */
    bool inside, left;
    size_t brick; /* of a piece whose value is not the same all through: those may be many bricks */
} VolumeWalk;

/* At t of a line; to_lattice maps the line's frame to lattice coordinates. */
void volume_walk_start(VolumeWalk *walk, const Volume *volume, const Affine *to_lattice, Vec3 origin, Vec3 direction,
                       double t);
/* On to the piece that begins at t_end. Not after the last one. */
void volume_walk_next(VolumeWalk *walk);
/* The value at a t of the present piece. */
float volume_walk_value(const VolumeWalk *walk, double t);

#endif

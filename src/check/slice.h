/* slice.h - a picture of a cross-section through a scene, coloured by what owns each place.
 * It is drawn from lines in the plane, traced exactly, so that nothing is missed for being thin: each pixel is the mean
 * over lines through it, and boundaries and gaps are drawn where lines in two directions cross them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SLICE_H
#define MEN_SLICE_H

#include "scene/compile.h"

/* A rectangle in space. */
typedef struct SlicePlane {
    Vec3 center, right, up; /* right and up are unit and at right angles */
    double width, height;   /* scene units */
} SlicePlane;

typedef struct SliceImage {
    uint32_t width, height;
    float *rgb;       /* as displayed, 0..1, row 0 at the top */
    uint32_t *owner;  /* the hull that owns the middle of each pixel; SCENE_NONE in the world's medium */
    uint32_t n_gaps;  /* pixels where a gap thinner than a pixel is marked */
    double least_gap; /* the thinnest of them; INFINITY */
    bool overlaps;    /* some place is hatched */
    bool opaque;      /* some place is within an opaque object */
} SliceImage;

/* Colours of what is not a medium. */
extern const float slice_opaque_color[3], slice_gap_color[3], slice_line_color[3];
/* The colour of a medium: the world's is white, the others' come in order of declaration. */
void slice_color(uint32_t medium, float rgb[3]);

/* The plane through a point at right angles to the normal (not zero), with the rectangle that holds what the hulls'
 * bounds have in it, and a margin. +y is up in the picture, or +z where the normal is along y. false when there are no
 * hulls; where none comes near the plane, the rectangle is around all of them all the same. */
bool slice_plane_make(const CompiledScene *compiled, Vec3 point, Vec3 normal, SlicePlane *plane);

/* The scene needs an order that holds everywhere: NEST_AUTOMATIC or NEST_PRIORITY. Same bits for any number of threads.
 */
ATTR_NODISCARD Status slice_draw(const CompiledScene *compiled, Pool *pool, const SlicePlane *plane, uint32_t width,
                                 uint32_t height, SliceImage *image, Error *error);
void slice_image_clear(SliceImage *image);

#endif

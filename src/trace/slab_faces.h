/* slab_faces.h - the flat faces between a place and a light, and looks that go by them; private to src/trace.
 * For slab_lamp.h, which knows in closed form in which direction light comes by given faces.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SLAB_FACES_H
#define MEN_SLAB_FACES_H

#include "optics/flat_way.h"
#include "trace/slab_look.h"

/* The faces of a way from a place to a light. */
typedef struct FaceWay {
    FlatFace faces[SLAB_FACES];
    uint64_t numbers[SLAB_FACES]; /* see slabs_face */
    uint32_t n;
    Vec3 leaving;   /* of a beam's way: towards its lamp from the last face, roughly; else 0 */
    bool disperses; /* the indices of some change with the wavelength */
    bool blocked;   /* something opaque stands in the straight way, */
    bool past;      /* which was looked past */
} FaceWay;

/* The faces on the look's ray, which ends at a light; false: something is in the way that no look goes through. past: only flat
 * bodies count. The look's list becomes that behind them. */
bool slab_find_faces(Path *look, bool past, FaceWay *way);
/* A hash of all of them, as SlabWay.steps. */
uint64_t slab_steps_of(const FaceWay *way);
/* A place right beside where a way began, on it: on what it began is known no more. */
Vec3 slab_right_beside(Vec3 from, Vec3 towards);
/* A look from such a place in a direction, as slab_start_look from the place itself; looker: the path's, which is lent. False when memory
 * ends. */
bool slab_start_beside(const Path *path, Tracer *looker, Vec3 beside, Vec3f direction, Path *look);

/* On to the next thing that it may go through; false: there is none. */
bool slab_look_goes_on(Path *look, Event *event);
/* By the faces of a way; false: they are not met in that order, or nothing is left of the light. */
bool slab_follow_faces(Path *look, const FaceWay *way);

#endif

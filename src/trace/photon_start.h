/* photon_start.h - where photons start; private to src/trace/photon*.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PHOTON_START_H
#define MEN_PHOTON_START_H

#include "trace/path_parts.h"
#include "trace/photon.h"

/* The start of a photon: a target's point, and a light that is seen from there. */
typedef struct PhotonStart {
    Vec3 point, normal; /* of the target's face */
    double size;        /* of the target */
    double beyond;      /* how far from all bounded things light from infinity starts: surfaces may reach there, too */
    uint32_t emitter;   /* that it was sent from; EMITTER_NONE: the light was chosen among all; */
    uint32_t attempt;   /* and with which of the path's numbers for that a place on it was found */
    LightSample light;
    Vec3f turned;       /* zero, or where the light is seen, if the light's direction is another one, beside it */
    float more;         /* see Photon; already taken off this: */
    float flux_times_n; /* what all photons together carry, if they all were like this one, by its radiance */
} PhotonStart;

/* Chooses a start; false: this one gives nothing. */
bool photon_choose_start(const PhotonTargets *targets, const Path *path, PhotonStart *start);
/* A light that is seen from a point, with its radiance: the start's emitter, if it has one, by the same random numbers as there; else
 * any at all. start NULL: any. */
void photon_choose_light(const Path *path, const PhotonStart *start, Vec3 from, Vec3f normal, LightSample *light);
/* Puts the path's ray at the light, on its way to the start's point, and the hulls around the light into its list. */
bool photon_leave_light(Path *path, const PhotonStart *start);

#endif

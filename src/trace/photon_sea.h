/* photon_sea.h - which parts of clear objects that are wide, or have no end, photons are sent to; private to src/trace/photon*.
 *
 * A sea goes on to the horizon, and a lake far beyond what a picture shows: photons that were spread over all of it would be too
 * few anywhere. So a few thousand of the camera's paths are followed through clear boundaries and off mirrors to the first place
 * that scatters, as photons are from the other side. Around these places the sea is split into tiles, and photons are sent to each
 * as its part of the picture and its area ask for: light that lands at a place has come through the box of a tile that holds the
 * place and the surface above.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PHOTON_SEA_H
#define MEN_PHOTON_SEA_H

#include "trace/photon.h"

/* What is split. */
typedef struct PhotonSea {
    const bool *objects; /* which of the scene's: those without end, or a wide one and what is in it */
    Box3 bounds;         /* of a wide one; empty: it has no end */
} PhotonSea;

/* A tile of a sea. */
typedef struct PhotonTile {
    Box3 box;
    double part; /* of the photons for the sea; all together: 1 */
    /* see Photon: the area for a part of the picture, by that which the nearer half of all has, less 1; or 0 */
    double more;
} PhotonTile;

/* Whether a bounded object is so much wider than deep that splitting it may help. */
bool photon_is_wide(Box3 bounds);

/* Returns the number of tiles in *n, at most PHOTON_TILES, which lie side by side; 0: the camera sees next to nothing by the sea, or
 * so much of a wide one that photons sent to all of its box alike do as well. *up: the axis that they all go along from the bottom
 * to the surface, 0 .. 2. The same for the same world. STATUS_NOMEM. */
ATTR_NODISCARD Status photon_sea_tiles(const World *world, const PhotonSea *sea, PhotonTile tiles[PHOTON_TILES],
                                       uint32_t *n, int *up, Error *error);

#endif

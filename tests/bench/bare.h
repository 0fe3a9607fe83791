/* bare.h - Embree by itself, as the measure of what is built on it.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_BARE_H
#define MEN_TEST_BARE_H

#include "geom/embree.h"
#include "mesh/mesh.h"

/* A scene of these triangles alone, robust as the renderer's own. The arrays are shared and must live as long. */
RTCScene bare_scene(RTCDevice device, const Vec3f *positions, size_t n_positions, const uint32_t (*triangles)[3],
                    size_t n_triangles);
RTCScene bare_mesh(RTCDevice device, const Mesh *mesh);

#endif

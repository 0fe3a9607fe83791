/* crossing.h - triangles that pass through each other: what the files that look for them share; private to src/geom.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CROSSING_H
#define MEN_CROSSING_H

#include "mesh/box_tree.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

#define TRIANGLE_LEFT_OUT UINT32_MAX /* a label */

FloatBox triangle_box(const Mesh *mesh, uint32_t triangle);
/* Of the triangles that have an area and are not left out. */
ATTR_NODISCARD Status triangle_tree_make(const Mesh *mesh, const uint32_t *labels, BoxTree *tree, Error *error);
/* Whether two triangles cross, see mesh_find_crossings, and then where. ids: of the vertices, by position. */
bool triangles_cross(const Mesh *mesh, const uint32_t *ids, uint32_t i, uint32_t j, Vec3f *place);

/* Labels, one for each triangle: those of one label, other than 0, are known not to cross each other. *labels is
 * malloc'd. */
ATTR_NODISCARD Status mesh_label_graphs(const Topology *topology, uint32_t **labels, Error *error);

#endif

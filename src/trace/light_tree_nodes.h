/* light_tree_nodes.h - the nodes of a tree of lights; private to src/trace/light_tree*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_TREE_NODES_H
#define MEN_LIGHT_TREE_NODES_H

#include "base/lanes.h"
#include "trace/light_tree.h"

/* What is below a node comes in up to four parts, side by side, so that one step down compares them all at once. */
typedef struct TreeNode {
    Lanes x, y, z; /* of the middles */
    Lanes radius2; /* of the balls around the boxes, squared */
    Lanes axis_x, axis_y, axis_z;
    Lanes cos_o, cos_e;
    Lanes two_sided;       /* 1 or 0 */
    Lanes power;           /* 0 where there is no part */
    uint32_t child[LANES]; /* a node, or a light's number and IS_LIGHT */
} TreeNode;
enum { PARTS = LANES };
#define IS_LIGHT 0x80000000U

struct LightTree {
    TreeNode *nodes;   /* [0] is the root */
    uint32_t *parent;  /* of each node: a place as below */
    uint32_t *leaf_of; /* of each light its place, PARTS * node + part; LIGHT_TREE_NONE for those left out */
    uint32_t n_lights; /* those that shine */
    double power;
};

#endif

/* box_tree.h - a tree of boxes: which of many lie in each other, or above a point.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BOX_TREE_H
#define MEN_BOX_TREE_H

#include <stdbool.h>

#include "base/status.h"
#include "base/vec3.h"

typedef struct FloatBox {
    float min[3], max[3];
} FloatBox;

FloatBox float_box_empty(void); /* min above max: it meets nothing, and grows to what is added */
void float_box_add(FloatBox *box, const FloatBox *other);
void float_box_add_point(FloatBox *box, Vec3f p);
static inline bool float_boxes_meet(const FloatBox *a, const FloatBox *b)
{
    return a->min[0] <= b->max[0] && b->min[0] <= a->max[0] && a->min[1] <= b->max[1] && b->min[1] <= a->max[1] &&
           a->min[2] <= b->max[2] && b->min[2] <= a->max[2];
}

enum { BOX_TREE_LEAF = 4 }; /* items */

typedef struct BoxTree {
    uint32_t n;
    uint32_t *items;   /* along a space-filling curve */
    FloatBox *boxes;   /* theirs */
    uint32_t *labels;  /* theirs; NULL without */
    FloatBox *nodes;   /* a heap: children of i are 2 i and 2 i + 1; leaves from n_leaves on */
    uint32_t *common;  /* of nodes: the label that all items in it have, or 0; NULL without labels */
    uint32_t n_leaves; /* a power of two */
} BoxTree;

/* Takes n items with their boxes, which must be finite, and labels (or NULL). Items of one label, other than 0, are not
 * of interest to each other. What was made is cleared also after a failure. */
ATTR_NODISCARD Status box_tree_make(const uint32_t *items, const FloatBox *boxes, const uint32_t *labels, uint32_t n,
                                    BoxTree *tree, Error *error);
void box_tree_clear(BoxTree *tree);

/* How many leaves hold items. */
uint32_t box_tree_leaves(const BoxTree *tree);
/* Calls visit for each pair of items whose boxes meet, where the one that comes first along the curve is in the leaves
 * from first to before end: each pair once. False when *pairs_left, from which every pair that was looked at is taken,
 * ran out; the rest is then left out. */
typedef void BoxTreePair(void *context, uint32_t item, uint32_t other);
bool box_tree_pairs(const BoxTree *tree, uint32_t first, uint32_t end, uint64_t *pairs_left, BoxTreePair *visit,
                    void *context);
/* Whether the test holds for any item whose box meets this one; asked until it does. */
typedef bool BoxTreeTest(void *context, uint32_t item);
bool box_tree_any(const BoxTree *tree, const FloatBox *box, BoxTreeTest *test, void *context);
/* Calls visit for each item whose box a ray from p towards +x meets. */
typedef void BoxTreeItem(void *context, uint32_t item);
void box_tree_ray(const BoxTree *tree, Vec3f p, BoxTreeItem *visit, void *context);

#endif

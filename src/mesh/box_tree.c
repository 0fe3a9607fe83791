/* box_tree.c - a tree of boxes, over items in the order of a space-filling curve.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/box_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CODE_BITS = 21,  /* of each coordinate */
    DIGIT_BITS = 11, /* of the radix sort */
    TREE_DEPTH = 32,
};

FloatBox float_box_empty(void)
{
    return (FloatBox){{HUGE_VALF, HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF}};
}

void float_box_add(FloatBox *box, const FloatBox *other)
{
    for (int k = 0; k < 3; k++) {
        if (other->min[k] < box->min[k]) box->min[k] = other->min[k];
        if (other->max[k] > box->max[k]) box->max[k] = other->max[k];
    }
}

void float_box_add_point(FloatBox *box, Vec3f p)
{
    FloatBox point = {{p.x, p.y, p.z}, {p.x, p.y, p.z}};
    float_box_add(box, &point);
}

/* ---- the curve ---- */

/* Two zero bits behind each of the lower 21. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffffU;
    x = (x | x << 16) & 0x1f0000ff0000ffU;
    x = (x | x << 8) & 0x100f00f00f00f00fU;
    x = (x | x << 4) & 0x10c30c30c30c30c3U;
    return (x | x << 2) & 0x1249249249249249U;
}

typedef struct Coded {
    uint64_t code;
    uint32_t place; /* among the items as they were given */
} Coded;

/* By code; equal codes stay in order. The result is in items. */
static void sort_by_code(Coded *items, Coded *spare, uint32_t n)
{
    for (int shift = 0; shift < 3 * CODE_BITS; shift += DIGIT_BITS) {
        uint32_t start[(1 << DIGIT_BITS) + 1] = {0};
        for (uint32_t i = 0; i < n; i++) start[(items[i].code >> shift & ((1 << DIGIT_BITS) - 1)) + 1]++;
        for (int d = 0; d < 1 << DIGIT_BITS; d++) start[d + 1] += start[d];
        for (uint32_t i = 0; i < n; i++) spare[start[items[i].code >> shift & ((1 << DIGIT_BITS) - 1)]++] = items[i];
        memcpy(items, spare, n * sizeof *items);
    }
}

/* *coded is malloc'd. */
static Status order_boxes(const FloatBox *boxes, uint32_t n, Coded **coded, Error *error)
{
    *coded = malloc((2 * (size_t)n + 1) * sizeof **coded);
    if (!*coded) return fail_memory(error, 2 * (size_t)n * sizeof **coded, "a tree of boxes");
    FloatBox all = float_box_empty();
    for (uint32_t i = 0; i < n; i++) float_box_add(&all, &boxes[i]);
    double scale[3];
    for (int k = 0; k < 3; k++) {
        double size = (double)all.max[k] - (double)all.min[k];
        scale[k] = size > 0 ? ((1 << CODE_BITS) - 1) / size : 0;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint64_t code = 0;
        for (int k = 0; k < 3; k++) {
            double middle = ((double)boxes[i].min[k] + (double)boxes[i].max[k]) / 2 - (double)all.min[k];
            code |= spread((uint64_t)(middle * scale[k])) << k;
        }
        (*coded)[i] = (Coded){code, i};
    }
    sort_by_code(*coded, *coded + n, n);
    return STATUS_OK;
}

/* ---- the tree ---- */

static void make_leaf(BoxTree *tree, uint32_t leaf)
{
    FloatBox *box = &tree->nodes[tree->n_leaves + leaf];
    uint64_t first = (uint64_t)leaf * BOX_TREE_LEAF;
    *box = float_box_empty();
    for (uint64_t k = first; k < first + BOX_TREE_LEAF && k < tree->n; k++) float_box_add(box, &tree->boxes[k]);
    if (!tree->labels) return;
    uint32_t label = first < tree->n ? tree->labels[first] : 0;
    for (uint64_t k = first; k < first + BOX_TREE_LEAF && k < tree->n; k++)
        if (tree->labels[k] != label) label = 0;
    tree->common[tree->n_leaves + leaf] = label;
}

static void make_nodes(BoxTree *tree)
{
    for (uint32_t i = 0; i < tree->n_leaves; i++) make_leaf(tree, i);
    for (size_t i = tree->n_leaves - 1; i > 0; i--) {
        tree->nodes[i] = tree->nodes[2 * i];
        float_box_add(&tree->nodes[i], &tree->nodes[2 * i + 1]);
        if (!tree->labels) continue;
        bool empty = tree->nodes[2 * i + 1].min[0] > tree->nodes[2 * i + 1].max[0];
        tree->common[i] = empty || tree->common[2 * i] == tree->common[2 * i + 1] ? tree->common[2 * i] : 0;
    }
}

Status box_tree_make(const uint32_t *items, const FloatBox *boxes, const uint32_t *labels, uint32_t n, BoxTree *tree,
                     Error *error)
{
    *tree = (BoxTree){.n = n, .n_leaves = 1};
    while ((uint64_t)tree->n_leaves * BOX_TREE_LEAF < n) tree->n_leaves *= 2;
    Coded *coded;
    TRY(order_boxes(boxes, n, &coded, error));
    size_t room = (size_t)n + 1, n_nodes = 2 * (size_t)tree->n_leaves;
    tree->items = malloc(room * sizeof *tree->items);
    tree->boxes = malloc(room * sizeof *tree->boxes);
    tree->nodes = malloc(n_nodes * sizeof *tree->nodes);
    if (labels) {
        tree->labels = malloc(room * sizeof *tree->labels);
        tree->common = malloc(n_nodes * sizeof *tree->common);
    }
    if (!tree->items || !tree->boxes || !tree->nodes || (labels && (!tree->labels || !tree->common))) {
        free(coded);
        return fail_memory(error, room * sizeof *tree->boxes + n_nodes * sizeof *tree->nodes, "a tree of boxes");
    }
    for (uint32_t i = 0; i < n; i++) {
        tree->items[i] = items[coded[i].place];
        tree->boxes[i] = boxes[coded[i].place];
        if (labels) tree->labels[i] = labels[coded[i].place];
    }
    free(coded);
    make_nodes(tree);
    return STATUS_OK;
}

void box_tree_clear(BoxTree *tree)
{
    free(tree->items);
    free(tree->boxes);
    free(tree->labels);
    free(tree->nodes);
    free(tree->common);
    *tree = (BoxTree){0};
}

uint32_t box_tree_leaves(const BoxTree *tree)
{
    return (uint32_t)(((uint64_t)tree->n + BOX_TREE_LEAF - 1) / BOX_TREE_LEAF);
}

/* ---- questions ---- */

static uint32_t leaf_end(const BoxTree *tree, uint32_t leaf)
{
    uint64_t end = ((uint64_t)leaf + 1) * BOX_TREE_LEAF;
    return end < tree->n ? (uint32_t)end : tree->n;
}

static void visit_leaves(const BoxTree *tree, uint32_t leaf, uint32_t other, BoxTreePair *visit, void *context)
{
    uint32_t end = leaf_end(tree, leaf), other_end = leaf_end(tree, other);
    for (uint32_t i = leaf * BOX_TREE_LEAF; i < end; i++)
        for (uint32_t j = leaf == other ? i + 1 : other * BOX_TREE_LEAF; j < other_end; j++) {
            if (tree->labels && tree->labels[i] && tree->labels[i] == tree->labels[j]) continue;
            if (float_boxes_meet(&tree->boxes[i], &tree->boxes[j])) visit(context, tree->items[i], tree->items[j]);
        }
}

/* Everything that meets the leaf's box, of this leaf and those behind it. */
static bool pairs_of_leaf(const BoxTree *tree, uint32_t leaf, uint64_t *pairs_left, BoxTreePair *visit, void *context)
{
    const FloatBox *box = &tree->nodes[tree->n_leaves + leaf];
    uint32_t label = tree->common ? tree->common[tree->n_leaves + leaf] : 0;
    uint32_t stack[TREE_DEPTH + 1], n = 0;
    stack[n++] = 1;
    while (n) {
        uint32_t node = stack[--n];
        if (!float_boxes_meet(box, &tree->nodes[node]) || (label && tree->common[node] == label)) continue;
        if (node >= tree->n_leaves) {
            if (*pairs_left < BOX_TREE_LEAF * BOX_TREE_LEAF) return false;
            *pairs_left -= BOX_TREE_LEAF * BOX_TREE_LEAF;
            visit_leaves(tree, leaf, node - tree->n_leaves, visit, context);
            continue;
        }
        for (uint32_t child = 2 * node + 2; child-- > 2 * node;) { /* the nearer to the front is taken first */
            uint32_t last = child;
            while (last < tree->n_leaves) last = 2 * last + 1;
            if (last - tree->n_leaves >= leaf) stack[n++] = child;
        }
    }
    return true;
}

bool box_tree_pairs(const BoxTree *tree, uint32_t first, uint32_t end, uint64_t *pairs_left, BoxTreePair *visit,
                    void *context)
{
    for (uint32_t leaf = first; leaf < end && leaf < box_tree_leaves(tree); leaf++)
        if (!pairs_of_leaf(tree, leaf, pairs_left, visit, context)) return false;
    return true;
}

bool box_tree_any(const BoxTree *tree, const FloatBox *box, BoxTreeTest *test, void *context)
{
    uint32_t stack[TREE_DEPTH + 1], n = 0;
    stack[n++] = 1;
    while (n) {
        uint32_t node = stack[--n];
        if (!float_boxes_meet(&tree->nodes[node], box)) continue;
        if (node < tree->n_leaves) {
            stack[n++] = 2 * node + 1;
            stack[n++] = 2 * node;
            continue;
        }
        uint32_t leaf = node - tree->n_leaves, end = leaf_end(tree, leaf);
        for (uint32_t i = leaf * BOX_TREE_LEAF; i < end; i++)
            if (float_boxes_meet(&tree->boxes[i], box) && test(context, tree->items[i])) return true;
    }
    return false;
}

typedef struct RayVisit {
    BoxTreeItem *visit;
    void *context;
} RayVisit;

static bool visit_and_go_on(void *context, uint32_t item)
{
    const RayVisit *ray = context;
    ray->visit(ray->context, item);
    return false;
}

void box_tree_ray(const BoxTree *tree, Vec3f p, BoxTreeItem *visit, void *context)
{
    const FloatBox ahead = {{p.x, p.y, p.z}, {INFINITY, p.y, p.z}};
    RayVisit ray = {visit, context};
    (void)box_tree_any(tree, &ahead, visit_and_go_on, &ray);
}

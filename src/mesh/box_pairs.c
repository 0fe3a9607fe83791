/* box_pairs.c - pairs of boxes that meet, from a balanced tree over their centres.
 * Every node halves its boxes by their number, across the axis along which their centres reach furthest, so that
 * neither a box far away from all others nor boxes in a line or a plane make it any deeper. All leaves are at one
 * depth, which lets nodes be numbered as in a heap: the children of k are 2k + 1 and 2k + 2.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/box_pairs.h"

#include <stdlib.h>

#include "base/hash.h"

enum { LEAF = 8 }; /* boxes of a leaf, at most */

typedef struct Item {
    double centre[3];
    uint32_t number;
} Item;

typedef struct Tree {
    Item *items;
    Box3 *nodes;
    uint32_t n, depth; /* of the leaves */
    BoxAt *box_at;
    BoxPairVisit *visit;
    void *context;
    Error *error;
} Tree;

/* A node and its items: begin .. end - 1. */
typedef struct Node {
    uint32_t number, level, begin, end;
} Node;

static Node child_of(const Node *node, uint32_t i)
{
    uint32_t middle = node->begin + (node->end - node->begin) / 2;
    return i ? (Node){2 * node->number + 2, node->level + 1, middle, node->end}
             : (Node){2 * node->number + 1, node->level + 1, node->begin, middle};
}

/* ---- building ---- */

/* The middle one of three values, taken from places that no order of the boxes is likely to be made for. */
static double choose_pivot(const Item *items, int64_t begin, int64_t end, int axis)
{
    double value[3];
    for (uint64_t i = 0; i < 3; i++)
        value[i] =
            items[begin + (int64_t)(hash_u64((uint64_t)(3 * end + begin) + i) % (uint64_t)(end - begin))].centre[axis];
    return fmax(fmin(value[0], value[1]), fmin(fmax(value[0], value[1]), value[2]));
}

/* Reorders items begin .. end - 1 so that none before `middle` is further along the axis than any from there on
 * (Hoare's selection). */
static void select_middle(Item *items, int64_t begin, int64_t end, int64_t middle, int axis)
{
    while (end - begin > 1) {
        double pivot = choose_pivot(items, begin, end, axis);
        int64_t low = begin, high = end - 1;
        while (low <= high) {
            while (items[low].centre[axis] < pivot) low++;
            while (items[high].centre[axis] > pivot) high--;
            if (low > high) break;
            Item item = items[low];
            items[low++] = items[high];
            items[high--] = item;
        }
        if (middle <= high)
            end = high + 1;
        else if (middle >= low)
            begin = low;
        else
            return; /* all between the two are at the pivot */
    }
}

static int longest_axis(const Item *items, uint32_t begin, uint32_t end)
{
    double least[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, most[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    int longest = 0;
    for (uint32_t i = begin; i < end; i++)
        for (int axis = 0; axis < 3; axis++) {
            double c = items[i].centre[axis];
            if (c < least[axis]) least[axis] = c;
            if (c > most[axis]) most[axis] = c;
        }
    for (int axis = 1; axis < 3; axis++)
        if (most[axis] - least[axis] > most[longest] - least[longest]) longest = axis;
    return longest;
}

static Box3 build(Tree *tree, Node node)
{
    Box3 box = box3_empty();
    if (node.level == tree->depth) {
        for (uint32_t i = node.begin; i < node.end; i++)
            box = box3_union(box, tree->box_at(tree->context, tree->items[i].number));
    } else {
        Node low = child_of(&node, 0), high = child_of(&node, 1);
        select_middle(tree->items, node.begin, node.end, high.begin, longest_axis(tree->items, node.begin, node.end));
        box = build(tree, low);
        box = box3_union(box, build(tree, high));
    }
    return tree->nodes[node.number] = box;
}

/* ---- pairs ---- */

static Status visit_items(const Tree *tree, uint32_t i, uint32_t k)
{
    uint32_t a = tree->items[i].number, b = tree->items[k].number;
    return tree->visit(tree->context, a < b ? a : b, a < b ? b : a, tree->error);
}

static Status pairs_of_leaves(const Tree *tree, const Node *a, const Node *b)
{
    Box3 boxes[LEAF];
    for (uint32_t k = b->begin; k < b->end; k++)
        boxes[k - b->begin] = tree->box_at(tree->context, tree->items[k].number);
    for (uint32_t i = a->begin; i < a->end; i++) {
        Box3 box = tree->box_at(tree->context, tree->items[i].number);
        for (uint32_t k = a->number == b->number ? i + 1 : b->begin; k < b->end; k++)
            if (box3_meets(box, boxes[k - b->begin])) TRY(visit_items(tree, i, k));
    }
    return STATUS_OK;
}

/* Pairs of one box in a and one in b, which are of one level and have no box in common. */
static Status pairs_between(const Tree *tree, Node a, Node b)
{
    if (!box3_meets(tree->nodes[a.number], tree->nodes[b.number])) return STATUS_OK;
    if (a.level == tree->depth) return pairs_of_leaves(tree, &a, &b);
    for (uint32_t i = 0; i < 4; i++) TRY(pairs_between(tree, child_of(&a, i / 2), child_of(&b, i % 2)));
    return STATUS_OK;
}

static Status pairs_within(const Tree *tree, Node node)
{
    if (node.level == tree->depth) return pairs_of_leaves(tree, &node, &node);
    Node low = child_of(&node, 0), high = child_of(&node, 1);
    TRY(pairs_within(tree, low));
    TRY(pairs_within(tree, high));
    return pairs_between(tree, low, high);
}

Status box_pairs_visit(uint32_t n, BoxAt *box_at, BoxPairVisit *visit, void *context, Error *error)
{
    Tree tree = {.box_at = box_at, .visit = visit, .context = context, .error = error};
    tree.items = malloc(((size_t)n + 1) * sizeof *tree.items);
    if (!tree.items) return fail_memory(error, n * sizeof *tree.items, "pairs of objects");
    for (uint32_t i = 0; i < n; i++) {
        Box3 box = box_at(context, i);
        if (box3_is_empty(box)) continue;
        Vec3 centre = vec3_scale(vec3_add(box.min, box.max), 0.5);
        tree.items[tree.n++] = (Item){{centre.x, centre.y, centre.z}, i};
    }
    while (tree.n && ((tree.n - 1) >> tree.depth) + 1 > LEAF) tree.depth++;
    size_t n_nodes = ((size_t)2 << tree.depth) - 1;
    tree.nodes = malloc(n_nodes * sizeof *tree.nodes);
    Status status = tree.nodes ? STATUS_OK : fail_memory(error, n_nodes * sizeof *tree.nodes, "pairs of objects");
    Node root = {0, 0, 0, tree.n};
    if (status == STATUS_OK) build(&tree, root);
    if (status == STATUS_OK) status = pairs_within(&tree, root);
    free(tree.items);
    free(tree.nodes);
    return status;
}

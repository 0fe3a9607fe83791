/* light_tree_build.c - the building of a tree of lights, by several threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "trace/light_tree_nodes.h"

static const float pi_f = 3.14159265358979f;

typedef struct Cone {
    Vec3f axis;
    float cos_o;
} Cone;

/* [CK18] algorithm 1: the smallest cone around two cones. */
static Cone cone_union(Cone a, Cone b)
{
    if (b.cos_o > a.cos_o) {
        Cone swap = a;
        a = b;
        b = swap;
    }
    /* now b is the wider one */
    if (b.cos_o <= -1) return b;
    float cosine = vec3f_dot(a.axis, b.axis);
    cosine = cosine > 1 ? 1 : cosine < -1 ? -1 : cosine;
    /* inside already: the angle is no more than the difference of the two; without an arc cosine, as it is the usual
     * case */
    if (cosine >= b.cos_o * a.cos_o + sqrtf((1 - b.cos_o * b.cos_o) * (1 - a.cos_o * a.cos_o))) return b;
    float angle = acosf(cosine), narrow = acosf(a.cos_o), wide = acosf(b.cos_o);
    float half = 0.5f * (wide + angle + narrow);
    if (half >= pi_f) return (Cone){b.axis, -1};
    /* the axis turned from b's towards a's */
    float turn = half - wide, sine = sinf(angle);
    if (sine < 1e-6f) return cosine > 0 ? (Cone){b.axis, cosf(half + 1e-3f)} : (Cone){b.axis, -1};
    Vec3f axis = vec3f_along(vec3f_scale(b.axis, sinf(angle - turn) / sine), sinf(turn) / sine, a.axis);
    /* wider by what rounding may take */
    return (Cone){vec3f_normalize(axis), cosf(half < pi_f - 1e-4f ? half + 1e-4f : pi_f)};
}

static Vec3f vec3f_least(Vec3f a, Vec3f b)
{
    return vec3f(a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z);
}
static Vec3f vec3f_most(Vec3f a, Vec3f b)
{
    return vec3f(a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z);
}
static Cone cone_of(const LightBounds *b)
{
    return (Cone){b->axis, b->cos_o};
}
static Vec3f middle(const LightBounds *b)
{
    return vec3f_scale(vec3f_add(b->low, b->high), 0.5f);
}
static float component(Vec3f v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* power 0: nothing so far */
static LightBounds bounds_union(const LightBounds *a, const LightBounds *b)
{
    if (!(a->power > 0)) return *b;
    if (!(b->power > 0)) return *a;
    Cone cone = cone_union(cone_of(a), cone_of(b));
    return (LightBounds){.low = vec3f_least(a->low, b->low),
                         .high = vec3f_most(a->high, b->high),
                         .axis = cone.axis,
                         .cos_o = cone.cos_o,
                         .cos_e = a->cos_e < b->cos_e ? a->cos_e : b->cos_e,
                         .power = a->power + b->power,
                         .two_sided = a->two_sided || b->two_sided};
}

/* [CK18] eq. 1 and 2: power, times the measure of directions, times the area of the box. The measure is
 * 1 - cos(o) + (2 w sin(o) - cos(o - 2 w) - 2 o sin(o) + cos(o)) / 4 with w = o + e or pi. */
static double cost_of(const LightBounds *b)
{
    const double pi = 3.14159265358979323846;
    double cos_o = b->two_sided ? -1 : (double)b->cos_o, cos_e = (double)b->cos_e,
           sin_o = sqrt(fmax(1 - cos_o * cos_o, 0));
    double omega = 1 - cos_o;
    if (cos_o > -cos_e) {
        double e = cos_e == 0 ? 0.5 * pi : acos(cos_e), cos_2e = 2 * cos_e * cos_e - 1,
               sin_2e = 2 * cos_e * sqrt(fmax(1 - cos_e * cos_e, 0));
        omega += 0.25 * (2 * e * sin_o - (cos_o * cos_2e - sin_o * sin_2e) + cos_o);
    } else if (cos_o > -1) {
        omega += 0.5 * (pi - acos(cos_o)) * sin_o;
    }
    Vec3f d = vec3f_sub(b->high, b->low);
    double x = (double)d.x, y = (double)d.y, z = (double)d.z, diagonal2 = x * x + y * y + z * z;
    /* lights in a line or at a point have no area; the square of what extent there is stands in */
    return (double)b->power * omega * (x * y + y * z + z * x + 1e-3 * diagonal2);
}

enum { N_BINS = 12 };

/* A light on its way to its place; they are sorted into the tree's order as it grows. */
typedef struct Item {
    LightBounds bounds;
    uint32_t light;
} Item;

typedef struct Builder {
    LightTree *tree;
    Item *items;
} Builder;

/* A stretch of the items that becomes a part of a node. */
typedef struct Stretch {
    uint32_t begin, end;
} Stretch;

static uint32_t length_of(Stretch s)
{
    return s.end - s.begin;
}

/* How many nodes a stretch takes at most: each has PARTS parts, but for those that two or three lights are left for. */
static uint32_t most_nodes(uint32_t n_lights)
{
    return n_lights < 2 ? 0 : (uint32_t)((2 * (uint64_t)n_lights - 1) / 3);
}

static int bin_of(const LightBounds *light, int axis, float low, float scale)
{
    int bin = (int)((component(middle(light), axis) - low) * scale);
    return bin < 0 ? 0 : bin >= N_BINS ? N_BINS - 1 : bin;
}

/* Where to cut along one axis: the last bin of the first half. Returns the cost. */
static double best_cut(const Builder *b, Stretch s, int axis, float low, float scale, int *cut)
{
    LightBounds bins[N_BINS] = {0};
    for (uint32_t i = s.begin; i < s.end; i++) {
        const LightBounds *light = &b->items[i].bounds;
        LightBounds *bin = &bins[bin_of(light, axis, low, scale)];
        *bin = bounds_union(bin, light);
    }
    double behind[N_BINS];
    LightBounds sum = {0};
    for (int i = N_BINS - 1; i > 0; i--) { /* an empty bin changes nothing */
        bool empty = !(bins[i].power > 0);
        sum = bounds_union(&sum, &bins[i]);
        behind[i] = !(sum.power > 0) ? -1 : empty ? behind[i + 1] : cost_of(&sum);
    }
    double best = HUGE_VAL;
    sum = (LightBounds){0};
    for (int i = 0; i + 1 < N_BINS; i++) {
        if (!(bins[i].power > 0) || behind[i + 1] < 0) continue;
        sum = bounds_union(&sum, &bins[i]);
        double cost = cost_of(&sum) + behind[i + 1];
        if (cost >= best) continue;
        best = cost;
        *cut = i;
    }
    return best;
}

/* Sorts the stretch into two and returns where the second begins. Where lights are many, only the longest axis is
 * looked at, which is nearly always the best; the regularizer of [CK18] for thin boxes is then not needed. */
static uint32_t split(const Builder *b, Stretch s)
{
    enum { ALL_AXES_BELOW = 4096 };
    Item *items = b->items;
    Vec3f low = middle(&items[s.begin].bounds), high = low;
    for (uint32_t i = s.begin + 1; i < s.end; i++) {
        Vec3f at = middle(&items[i].bounds);
        low = vec3f_least(low, at);
        high = vec3f_most(high, at);
    }
    Vec3f extent = vec3f_sub(high, low);
    int longest = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    uint32_t n = length_of(s), half = s.begin + n / 2;
    double best = HUGE_VAL;
    int axis = longest, cut = 0;
    for (int i = 0; i < 3 && n > 2; i++) {
        float length = component(extent, i);
        int at = 0;
        if (!(length > 0) || (i != longest && (n >= ALL_AXES_BELOW || length < 0.1f * component(extent, longest))))
            continue;
        double cost =
            best_cut(b, s, i, component(low, i), N_BINS / length, &at) * (double)(component(extent, longest) / length);
        if (cost >= best) continue;
        best = cost;
        axis = i;
        cut = at;
    }
    if (!(best < HUGE_VAL)) return half;
    float start = component(low, axis), scale = N_BINS / component(extent, axis);
    uint32_t first = s.begin;
    for (uint32_t i = s.begin; i < s.end; i++) {
        if (bin_of(&items[i].bounds, axis, start, scale) > cut) continue;
        Item item = items[i];
        items[i] = items[first];
        items[first++] = item;
    }
    return first > s.begin && first < s.end ? first : half;
}

/* Sorts the stretch into PARTS, or as many as it has lights, always cutting the one with the most lights. Deep down it
 * is cut in the middle, so that no arrangement of lights makes the tree too deep. Returns the number. */
static int split_in_parts(const Builder *b, Stretch s, int depth, Stretch parts[PARTS])
{
    enum { DEEP = 64 };
    int n = 1;
    parts[0] = s;
    while (n < PARTS) {
        int most = 0;
        for (int i = 1; i < n; i++)
            if (length_of(parts[i]) > length_of(parts[most])) most = i;
        Stretch part = parts[most];
        if (length_of(part) < 2) break;
        uint32_t at = depth < DEEP ? split(b, part) : part.begin + length_of(part) / 2;
        parts[most].end = at;
        parts[n++] = (Stretch){at, part.end};
    }
    return n;
}

static void fill_part(TreeNode *node, int part, const LightBounds *b)
{
    Vec3f half = vec3f_scale(vec3f_sub(b->high, b->low), 0.5f), centre = middle(b);
    lanes_set(&node->x, part, centre.x);
    lanes_set(&node->y, part, centre.y);
    lanes_set(&node->z, part, centre.z);
    lanes_set(&node->radius2, part, vec3f_dot(half, half) * 1.00001f);
    lanes_set(&node->axis_x, part, b->axis.x);
    lanes_set(&node->axis_y, part, b->axis.y);
    lanes_set(&node->axis_z, part, b->axis.z);
    lanes_set(&node->cos_o, part, b->cos_o);
    lanes_set(&node->cos_e, part, b->cos_e);
    lanes_set(&node->two_sided, part, b->two_sided ? 1 : 0);
    lanes_set(&node->power, part, b->power);
}

/* Where the nodes of each part begin that has more than one light; known from their numbers alone, so that parts can be
 * built by several threads. A part of one light is that light. */
static void link_parts(const Builder *b, uint32_t node, const Stretch *parts, int n)
{
    uint32_t next = node + 1;
    for (int i = 0; i < n; i++) {
        uint32_t place = PARTS * node + (uint32_t)i, light = b->items[parts[i].begin].light;
        if (length_of(parts[i]) == 1) {
            b->tree->nodes[node].child[i] = light | IS_LIGHT;
            b->tree->leaf_of[light] = place;
            continue;
        }
        b->tree->nodes[node].child[i] = next;
        b->tree->parent[next] = place;
        next += most_nodes(length_of(parts[i]));
    }
}

/* Builds a node and all below it. Returns the bounds of its lights. */
static LightBounds build(const Builder *b, uint32_t node, Stretch s, int depth)
{
    Stretch parts[PARTS];
    int n = split_in_parts(b, s, depth, parts);
    link_parts(b, node, parts, n);
    LightBounds all = {0};
    for (int i = 0; i < n; i++) {
        LightBounds bounds = length_of(parts[i]) == 1 ? b->items[parts[i].begin].bounds
                                                      : build(b, b->tree->nodes[node].child[i], parts[i], depth + 1);
        fill_part(&b->tree->nodes[node], i, &bounds);
        all = bounds_union(&all, &bounds);
    }
    return all;
}

/* ---- by several threads ---- */

/* The upper levels are split level by level, a task for each node; then each of the nodes at their ends is built whole.
 * The branches that come from number i are PARTS * i + 1 and the next. */
enum { UPPER_LEVELS = 3, N_UPPER = 1 + 4 + 16, N_BRANCHES = N_UPPER + 64, WHOLE_BELOW = 4096 };

typedef struct Branch {
    Stretch lights;
    uint32_t node;
    int n_parts; /* 0: built whole, or of one light */
    LightBounds bounds;
} Branch;

typedef struct UpperTree {
    const Builder *builder;
    Branch branches[N_BRANCHES];
    uint32_t first; /* of this level */
} UpperTree;

static void grow_branch(void *context, uint32_t index, unsigned worker)
{
    (void)worker;
    UpperTree *upper = context;
    const Builder *b = upper->builder;
    uint32_t number = upper->first + index;
    Branch *branch = &upper->branches[number];
    int depth = number == 0 ? 0 : number < 1 + 4 ? 1 : number < N_UPPER ? 2 : 3;
    uint32_t n = length_of(branch->lights);
    if (!n) return;
    if (n == 1 && number) {
        branch->bounds = b->items[branch->lights.begin].bounds;
        return;
    }
    if (number >= N_UPPER || n < WHOLE_BELOW) {
        branch->bounds = build(b, branch->node, branch->lights, depth);
        return;
    }
    Stretch parts[PARTS];
    branch->n_parts = split_in_parts(b, branch->lights, depth, parts);
    link_parts(b, branch->node, parts, branch->n_parts);
    for (int i = 0; i < branch->n_parts; i++)
        upper->branches[PARTS * number + 1 + (uint32_t)i] =
            (Branch){.lights = parts[i], .node = b->tree->nodes[branch->node].child[i]};
}

static void run_level(UpperTree *upper, Pool *pool, uint32_t first, uint32_t n)
{
    upper->first = first;
    pool_run(pool, n, grow_branch, upper);
}

static void build_all(const Builder *b, uint32_t n, Pool *pool)
{
    UpperTree upper = {.builder = b, .branches = {{.lights = {0, n}}}};
    uint32_t first = 0, width = 1;
    for (int level = 0; level <= UPPER_LEVELS; level++, first += width, width *= PARTS)
        run_level(&upper, pool, first, width);
    for (uint32_t number = N_UPPER; number-- > 0;) {
        Branch *branch = &upper.branches[number];
        for (int i = 0; i < branch->n_parts; i++) {
            const LightBounds *bounds = &upper.branches[PARTS * number + 1 + (uint32_t)i].bounds;
            fill_part(&b->tree->nodes[branch->node], i, bounds);
            branch->bounds = bounds_union(&branch->bounds, bounds);
        }
    }
}

Status light_tree_new(const LightBounds *lights, uint32_t n, Pool *pool, LightTree **tree, Error *error)
{
    LightTree *made = calloc(1, sizeof *made);
    if (!made) return fail_memory(error, sizeof *made, "a tree of lights");
    for (uint32_t i = 0; i < n; i++) made->n_lights += lights[i].power > 0;
    size_t n_nodes = most_nodes(made->n_lights) + 1UL;
    Item *items = malloc((made->n_lights + 1UL) * sizeof *items);
    made->leaf_of = malloc((n + 1UL) * sizeof *made->leaf_of);
    made->parent = malloc(n_nodes * sizeof *made->parent);
    made->nodes = calloc(n_nodes, sizeof *made->nodes);
    if (!items || !made->leaf_of || !made->parent || !made->nodes) {
        free(items);
        light_tree_free(made);
        return fail_memory(error, n_nodes * sizeof *made->nodes, "a tree of lights");
    }
    uint32_t n_items = 0;
    for (uint32_t i = 0; i < n; i++) {
        made->leaf_of[i] = LIGHT_TREE_NONE;
        if (!(lights[i].power > 0)) continue;
        items[n_items++] = (Item){lights[i], i};
        made->power += (double)lights[i].power;
    }
    Builder b = {made, items};
    if (n_items) build_all(&b, n_items, pool);
    free(items);
    *tree = made;
    return STATUS_OK;
}

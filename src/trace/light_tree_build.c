/* light_tree_build.c - the building of a tree of lights, by several threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "base/angle.h"
#include "trace/light_tree_nodes.h"

static const float pi_f = (float)MEN_PI;

/* A LightBounds side by side, of one light or of several: what is least of two stands together, and what is greatest. */
typedef struct Bounds {
    Lanes least; /* low, and cos_e */
    Lanes most;  /* high, and two_sided: 1 or 0 */
    Lanes cone;  /* axis, and cos_o */
    float power; /* 0: nothing so far */
    uint32_t light;
} Bounds;

static Bounds bounds_of_light(const LightBounds *b, uint32_t light)
{
    return (Bounds){.least = lanes(b->low.x, b->low.y, b->low.z, b->cos_e),
                    .most = lanes(b->high.x, b->high.y, b->high.z, b->two_sided ? 1 : 0),
                    .cone = lanes(b->axis.x, b->axis.y, b->axis.z, b->cos_o),
                    .power = b->power,
                    .light = light};
}

static Lanes middle(const Bounds *b)
{
    return lanes_scale(lanes_add(b->least, b->most), 0.5f);
}

static bool is_two_sided(const Bounds *b)
{
    return lanes_get(b->most, 3) > 0;
}

/* A single direction is the usual case. */
static float half_angle(float cos_o)
{
    return cos_o == 1 ? 0 : acosf(cos_o);
}

/* [CK18] algorithm 1: the smallest cone around two cones, of which b is the wider one. `cosine` of the angle between
 * their axes. */
static Lanes cone_around(Lanes a, Lanes b, float cosine)
{
    float angle = acosf(cosine), narrow = half_angle(lanes_get(a, 3)), wide = half_angle(lanes_get(b, 3));
    float half = 0.5f * (wide + angle + narrow);
    if (half >= pi_f) return lanes(lanes_get(b, 0), lanes_get(b, 1), lanes_get(b, 2), -1);
    /* the axis turned from b's towards a's */
    float turn = half - wide, sine = sinf(angle);
    if (sine < 1e-6f) {
        lanes_set(&b, 3, cosine > 0 ? cosf(half + 1e-3f) : -1);
        return b;
    }
    Lanes both = lanes_add(lanes_scale(b, sinf(angle - turn) / sine), lanes_scale(a, sinf(turn) / sine));
    Vec3f axis = vec3f_normalize(vec3f(lanes_get(both, 0), lanes_get(both, 1), lanes_get(both, 2)));
    /* wider by what rounding may take */
    return lanes(axis.x, axis.y, axis.z, cosf(half < pi_f - 1e-4f ? half + 1e-4f : pi_f));
}

static Lanes cone_union(Lanes a, Lanes b)
{
    float cos_a = lanes_get(a, 3), cos_b = lanes_get(b, 3);
    if (cos_b <= -1) return b;
    if (cos_a <= -1) return a;
    Lanes product = lanes_mul(a, b);
    float cosine = lanes_get(product, 0) + lanes_get(product, 1) + lanes_get(product, 2);
    cosine = float_max(float_min(cosine, 1), -1);
    /* inside already: the angle is no more than the difference of the two; without an arc cosine, as it is the usual
     * case */
    float least = lanes_get(product, 3) + sqrtf((1 - cos_a * cos_a) * (1 - cos_b * cos_b));
    if (cosine >= least) return cos_b > cos_a ? a : b;
    return cos_b > cos_a ? cone_around(b, a, cosine) : cone_around(a, b, cosine);
}

static void bounds_add(Bounds *sum, const Bounds *b)
{
    if (!(sum->power > 0)) {
        *sum = *b;
        return;
    }
    sum->least = lanes_lesser(sum->least, b->least);
    sum->most = lanes_greater(sum->most, b->most);
    sum->cone = cone_union(sum->cone, b->cone);
    sum->power += b->power;
}

/* [CK18] eq. 1 and 2: power, times the measure of directions, times the area of the box. The measure is
 * 1 - cos(o) + (2 w sin(o) - cos(o - 2 w) - 2 o sin(o) + cos(o)) / 4 with w = o + e or pi. */
static double cost_of(const Bounds *b)
{
    Lanes d = lanes_sub(b->most, b->least);
    double x = (double)lanes_get(d, 0), y = (double)lanes_get(d, 1), z = (double)lanes_get(d, 2);
    double cos_o = is_two_sided(b) ? -1 : (double)lanes_get(b->cone, 3), cos_e = (double)lanes_get(b->least, 3),
           sin_o = sqrt(fmax(1 - cos_o * cos_o, 0));
    double omega = 1 - cos_o;
    if (cos_o > -cos_e) {
        double e = cos_e == 0 ? 0.5 * MEN_PI : acos(cos_e), cos_2e = 2 * cos_e * cos_e - 1,
               sin_2e = 2 * cos_e * sqrt(fmax(1 - cos_e * cos_e, 0));
        omega += 0.25 * (2 * e * sin_o - (cos_o * cos_2e - sin_o * sin_2e) + cos_o);
    } else if (cos_o > -1) {
        omega += 0.5 * (MEN_PI - acos(cos_o)) * sin_o;
    }
    double diagonal2 = x * x + y * y + z * z;
    /* lights in a line or at a point have no area; the square of what extent there is stands in */
    return (double)b->power * omega * (x * y + y * z + z * x + 1e-3 * diagonal2);
}

enum { N_BINS = 12 };

typedef struct Builder {
    LightTree *tree;
    Bounds *items; /* lights on their way to their places: they are sorted into the tree's order as it grows */
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

static int bin_of(const Bounds *light, int axis, float low, float scale)
{
    float bin = ((lanes_get(light->least, axis) + lanes_get(light->most, axis)) * 0.5f - low) * scale;
    return bin >= N_BINS ? N_BINS - 1 : bin > 0 ? (int)bin : 0; /* the scale of an extent near 0 is infinite */
}

/* Where to cut along one axis: the last bin of the first half. Returns the cost. */
static double best_cut(const Builder *b, Stretch s, int axis, float low, float scale, int *cut)
{
    Bounds bins[N_BINS], sum;
    for (int i = 0; i < N_BINS; i++) bins[i].power = 0;
    for (uint32_t i = s.begin; i < s.end; i++) {
        const Bounds *light = &b->items[i];
        bounds_add(&bins[bin_of(light, axis, low, scale)], light);
    }
    double behind[N_BINS], cost = -1;
    sum.power = 0;
    for (int i = N_BINS - 1; i > 0; i--) {
        if (bins[i].power > 0) {
            bounds_add(&sum, &bins[i]);
            cost = cost_of(&sum);
        }
        behind[i] = cost;
    }
    double best = HUGE_VAL;
    sum.power = 0;
    for (int i = 0; i + 1 < N_BINS; i++) {
        if (!(bins[i].power > 0) || behind[i + 1] < 0) continue;
        bounds_add(&sum, &bins[i]);
        cost = cost_of(&sum) + behind[i + 1];
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
    Bounds *items = b->items;
    uint32_t n = length_of(s), half = s.begin + n / 2;
    if (n == 2) return half;
    Lanes low = middle(&items[s.begin]), high = low;
    for (uint32_t i = s.begin + 1; i < s.end; i++) {
        Lanes at = middle(&items[i]);
        low = lanes_lesser(low, at);
        high = lanes_greater(high, at);
    }
    Lanes extent = lanes_sub(high, low);
    float x = lanes_get(extent, 0), y = lanes_get(extent, 1), z = lanes_get(extent, 2),
          most = float_max(float_max(x, y), z);
    int longest = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    double best = HUGE_VAL;
    int axis = longest, cut = 0;
    for (int i = 0; i < 3; i++) {
        float length = lanes_get(extent, i);
        int at = 0;
        if (!(length > 0) || (i != longest && (n >= ALL_AXES_BELOW || length < 0.1f * most))) continue;
        double cost = best_cut(b, s, i, lanes_get(low, i), N_BINS / length, &at) * (double)(most / length);
        if (cost >= best) continue;
        best = cost;
        axis = i;
        cut = at;
    }
    if (!(best < HUGE_VAL)) return half;
    float start = lanes_get(low, axis), scale = N_BINS / lanes_get(extent, axis);
    uint32_t first = s.begin;
    for (uint32_t i = s.begin; i < s.end; i++) {
        if (bin_of(&items[i], axis, start, scale) > cut) continue;
        Bounds item = items[i];
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

static void fill_part(TreeNode *node, int part, const Bounds *b)
{
    Lanes half = lanes_scale(lanes_sub(b->most, b->least), 0.5f), centre = middle(b), squares = lanes_mul(half, half);
    lanes_set(&node->x, part, lanes_get(centre, 0));
    lanes_set(&node->y, part, lanes_get(centre, 1));
    lanes_set(&node->z, part, lanes_get(centre, 2));
    lanes_set(&node->radius2, part, (lanes_get(squares, 0) + lanes_get(squares, 1) + lanes_get(squares, 2)) * 1.00001f);
    lanes_set(&node->axis_x, part, lanes_get(b->cone, 0));
    lanes_set(&node->axis_y, part, lanes_get(b->cone, 1));
    lanes_set(&node->axis_z, part, lanes_get(b->cone, 2));
    lanes_set(&node->cos_o, part, lanes_get(b->cone, 3));
    lanes_set(&node->cos_e, part, lanes_get(b->least, 3));
    lanes_set(&node->two_sided, part, lanes_get(b->most, 3));
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
static Bounds build(const Builder *b, uint32_t node, Stretch s, int depth)
{
    Stretch parts[PARTS];
    int n = split_in_parts(b, s, depth, parts);
    link_parts(b, node, parts, n);
    Bounds all = {.power = 0};
    for (int i = 0; i < n; i++) {
        Bounds bounds = length_of(parts[i]) == 1 ? b->items[parts[i].begin]
                                                 : build(b, b->tree->nodes[node].child[i], parts[i], depth + 1);
        fill_part(&b->tree->nodes[node], i, &bounds);
        bounds_add(&all, &bounds);
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
    Bounds bounds;
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
        branch->bounds = b->items[branch->lights.begin];
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
            const Bounds *bounds = &upper.branches[PARTS * number + 1 + (uint32_t)i].bounds;
            fill_part(&b->tree->nodes[branch->node], i, bounds);
            bounds_add(&branch->bounds, bounds);
        }
    }
}

Status light_tree_new(const LightBounds *lights, uint32_t n, Pool *pool, LightTree **tree, Error *error)
{
    LightTree *made = calloc(1, sizeof *made);
    if (!made) return fail_memory(error, sizeof *made, "a tree of lights");
    for (uint32_t i = 0; i < n; i++) made->n_lights += lights[i].power > 0;
    size_t n_nodes = most_nodes(made->n_lights) + 1UL;
    Bounds *items = malloc((made->n_lights + 1UL) * sizeof *items);
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
        items[n_items++] = bounds_of_light(&lights[i], i);
        made->power += (double)lights[i].power;
    }
    Builder b = {made, items};
    if (n_items) build_all(&b, n_items, pool);
    free(items);
    *tree = made;
    return STATUS_OK;
}

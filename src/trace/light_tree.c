/* light_tree.c - see light_tree.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/light_tree.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "base/lanes.h"

static const float pi_f = 3.14159265358979f;

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

/* ---- importance ---- */

/* cos and sin of the angle a - b, or of 0 where b is larger; both angles in 0 .. pi. */
static inline Lanes cos_difference(Lanes sin_a, Lanes cos_a, Lanes sin_b, Lanes cos_b)
{
    Lanes cosine = lanes_add(lanes_mul(cos_a, cos_b), lanes_mul(sin_a, sin_b));
    return lanes_select_less(cos_b, cos_a, lanes_all(1), cosine);
}
static inline Lanes sin_difference(Lanes sin_a, Lanes cos_a, Lanes sin_b, Lanes cos_b)
{
    Lanes sine = lanes_sub(lanes_mul(sin_a, cos_b), lanes_mul(cos_a, sin_b));
    return lanes_select_less(cos_b, cos_a, lanes_all(0), sine);
}
static inline Lanes at_least(Lanes a, float low)
{
    return lanes_select_less(lanes_all(low), a, a, lanes_all(low));
}
static inline Lanes sine_of(Lanes cosine)
{
    return lanes_sqrt(at_least(lanes_rest(lanes_mul(cosine, cosine)), 0));
}
static inline Lanes dot(Lanes ax, Lanes ay, Lanes az, Lanes bx, Lanes by, Lanes bz)
{
    return lanes_add(lanes_add(lanes_mul(ax, bx), lanes_mul(ay, by)), lanes_mul(az, bz));
}

/* How much of their light a node's parts may send along directions whose lengths are 1 / inverse, as far as their normals
 * tell; sin_b and cos_b: half of the angle under which the part's ball is seen. */
static inline Lanes sent(const TreeNode *node, Lanes x, Lanes y, Lanes z, Lanes inverse, Lanes sin_b, Lanes cos_b)
{
    Lanes cos_w = lanes_mul(dot(node->axis_x, node->axis_y, node->axis_z, x, y, z), lanes_sub(lanes_all(0), inverse));
    Lanes other = lanes_mul(cos_w, lanes_sub(lanes_all(1), lanes_add(node->two_sided, node->two_sided)));
    cos_w = lanes_select_less(cos_w, other, other, cos_w);
    Lanes sin_w = sine_of(cos_w), sin_o = sine_of(node->cos_o);
    Lanes cos_x = cos_difference(sin_w, cos_w, sin_o, node->cos_o);
    Lanes sin_x = sin_difference(sin_w, cos_w, sin_o, node->cos_o);
    Lanes cosine = cos_difference(sin_x, cos_x, sin_b, cos_b);
    Lanes part = lanes_select_less(node->cos_e, cosine, at_least(cosine, FLT_MIN), lanes_all(0));
    return lanes_select_less(lanes_all(-1), node->cos_o, part, lanes_all(1));
}

/* [CK18] eq. 3: what the lights of each part may give to a place at most, roughly: power over squared distance, times the
 * cosines at both ends as far as the bounds allow them. The distance is at least the radius of the ball around the
 * bounds, as within it the middle says little: lights there may be anywhere, and face anywhere. */
static inline Lanes importance(const TreeNode *node, Vec3f place, Vec3f normal, bool has_normal)
{
    Lanes x = lanes_sub(node->x, lanes_all(place.x)), y = lanes_sub(node->y, lanes_all(place.y)),
          z = lanes_sub(node->z, lanes_all(place.z));
    Lanes distance2 = dot(x, y, z, x, y, z);
    Lanes nearest2 = lanes_select_less(distance2, node->radius2, node->radius2, distance2);
    Lanes value = lanes_div(node->power, at_least(nearest2, FLT_MIN));
    Lanes inverse2 = lanes_div(lanes_all(1), distance2), inverse = lanes_sqrt(inverse2);
    Lanes sin_b2 = lanes_mul(node->radius2, inverse2);
    Lanes sin_b = lanes_sqrt(sin_b2), cos_b = lanes_sqrt(at_least(lanes_rest(sin_b2), 0));
    Lanes given = lanes_mul(value, sent(node, x, y, z, inverse, sin_b, cos_b));
    if (has_normal) {
        Lanes cos_i = lanes_mul(dot(lanes_all(normal.x), lanes_all(normal.y), lanes_all(normal.z), x, y, z), inverse);
        given = lanes_mul(given, at_least(cos_difference(sine_of(cos_i), cos_i, sin_b, cos_b), 0));
    }
    return lanes_select_less(node->radius2, distance2, given, value);
}

/* A node's parts as seen from the place of a line that is nearest to each. */
typedef struct Beside {
    Lanes x, y, z; /* from there to their middles */
    Lanes along;   /* how far along the line the middles are, the line being without end */
} Beside;

static inline Beside beside(const TreeNode *node, const LightLine *line)
{
    Lanes dx = lanes_all(line->direction.x), dy = lanes_all(line->direction.y), dz = lanes_all(line->direction.z);
    Lanes begin = lanes_all(line->begin), end = lanes_all(line->end);
    Lanes x = lanes_sub(node->x, lanes_all(line->origin.x)), y = lanes_sub(node->y, lanes_all(line->origin.y)),
          z = lanes_sub(node->z, lanes_all(line->origin.z));
    Lanes along = dot(x, y, z, dx, dy, dz);
    Lanes nearest = lanes_select_less(along, begin, begin, lanes_select_less(end, along, end, along));
    return (Beside){lanes_sub(x, lanes_mul(nearest, dx)), lanes_sub(y, lanes_mul(nearest, dy)),
                    lanes_sub(z, lanes_mul(nearest, dz)), along};
}

/* The integral of power over squared distance along a line, as from the middle of the bounds and no nearer than their
 * radius: [KF12] section 3. Which way the lights face counts as seen from the line's nearest place, but never excludes them. */
static inline Lanes importance_along(const TreeNode *node, const LightLine *line)
{
    const float least = 0.1f;
    Beside at = beside(node, line);
    Lanes begin = lanes_sub(lanes_all(line->begin), at.along), end = lanes_sub(lanes_all(line->end), at.along);
    Lanes beyond = at_least(begin, 0);
    beyond = lanes_add(beyond, at_least(lanes_sub(lanes_all(0), end), 0)); /* of the line's ends, seen along it */
    Lanes to2 = dot(at.x, at.y, at.z, at.x, at.y, at.z);
    Lanes distance2 =
        lanes_add(at_least(lanes_sub(to2, lanes_mul(beyond, beyond)), 0), at_least(node->radius2, FLT_MIN));
    Lanes distance = lanes_sqrt(distance2), across = lanes_mul(distance, lanes_sub(end, begin));
    Lanes angle = lanes_add(distance2, lanes_mul(end, begin));
    for (int i = 0; i < LANES; i++) lanes_set(&angle, i, atan2f(lanes_get(across, i), lanes_get(angle, i)));
    Lanes inverse = lanes_sqrt(lanes_div(lanes_all(1), at_least(to2, FLT_MIN)));
    Lanes part = at_least(sent(node, at.x, at.y, at.z, inverse, lanes_all(0), lanes_all(1)), least);
    return lanes_mul(lanes_div(lanes_mul(node->power, angle), distance), part);
}

static bool is_set(Vec3f v)
{
    return v.x != 0 || v.y != 0 || v.z != 0;
}

/* In double: a sum of floats that are far apart in size keeps the share of each. */
static inline double sum_of(Lanes a)
{
    return ((double)lanes_get(a, 0) + (double)lanes_get(a, 1)) + ((double)lanes_get(a, 2) + (double)lanes_get(a, 3));
}

/* Who chooses: a place, or all places of a line. */
typedef struct Seeker {
    Vec3f place, normal;
    bool has_normal;
    const LightLine *line; /* NULL: the place */
} Seeker;

static inline Seeker seeker_at(Vec3 place, Vec3f normal)
{
    return (Seeker){.place = vec3f_from(place), .normal = normal, .has_normal = is_set(normal)};
}

static inline Lanes importance_for(const TreeNode *node, const Seeker *seeker)
{
    return seeker->line ? importance_along(node, seeker->line)
                        : importance(node, seeker->place, seeker->normal, seeker->has_normal);
}

static inline uint32_t choose_for(const LightTree *tree, const Seeker *seeker, double *digits, float *probability)
{
    double u = *digits;
    *probability = 0;
    if (!tree->n_lights) return LIGHT_TREE_NONE;
    const TreeNode *node = &tree->nodes[0];
    double chosen = 1;
    for (;;) {
        Lanes parts = importance_for(node, seeker);
        double sum = sum_of(parts);
        if (!(sum > 0)) return LIGHT_TREE_NONE;
        double left = u * sum, part = 0;
        int which = 0;
        for (int i = 0; i < PARTS; i++) {
            double next = (double)lanes_get(parts, i);
            if (!(next > 0)) continue;
            if (part > 0) {
                if (left < part) break;
                left -= part;
            }
            which = i;
            part = next;
        }
        chosen *= part / sum;
        u = left / part;
        if (!(u < 1)) u = 1 - DBL_EPSILON;
        uint32_t child = node->child[which];
        if (child & IS_LIGHT) {
            *probability = (float)chosen;
            *digits = u;
            return child & ~IS_LIGHT;
        }
        node = &tree->nodes[child];
    }
}

static inline float probability_for(const LightTree *tree, uint32_t light, const Seeker *seeker)
{
    uint32_t at = tree->leaf_of[light];
    if (at == LIGHT_TREE_NONE) return 0;
    double chosen = 1;
    for (;; at = tree->parent[at / PARTS]) {
        Lanes parts = importance_for(&tree->nodes[at / PARTS], seeker);
        double sum = sum_of(parts);
        if (!(sum > 0)) return 0;
        chosen *= (double)lanes_get(parts, (int)(at % PARTS)) / sum;
        if (at < PARTS) return (float)chosen;
    }
}

uint32_t light_tree_choose(const LightTree *tree, Vec3 place, Vec3f normal, double *u, float *probability)
{
    Seeker seeker = seeker_at(place, normal);
    return choose_for(tree, &seeker, u, probability);
}

float light_tree_probability(const LightTree *tree, uint32_t light, Vec3 place, Vec3f normal)
{
    Seeker seeker = seeker_at(place, normal);
    return probability_for(tree, light, &seeker);
}

uint32_t light_tree_choose_along(const LightTree *tree, const LightLine *line, double *u, float *probability)
{
    Seeker seeker = {.line = line};
    if (tree->n_lights != 1) return choose_for(tree, &seeker, u, probability);
    *probability = 1;
    return tree->nodes[0].child[0] & ~IS_LIGHT;
}

float light_tree_probability_along(const LightTree *tree, uint32_t light, const LightLine *line)
{
    Seeker seeker = {.line = line};
    if (tree->n_lights != 1) return probability_for(tree, light, &seeker);
    return tree->leaf_of[light] == LIGHT_TREE_NONE ? 0 : 1;
}

float light_tree_nearest(const LightTree *tree, const LightLine *line)
{
    if (!tree->n_lights) return INFINITY;
    const TreeNode *node = &tree->nodes[0];
    Beside at = beside(node, line);
    Lanes distance = lanes_sub(lanes_sqrt(dot(at.x, at.y, at.z, at.x, at.y, at.z)), lanes_sqrt(node->radius2));
    float nearest = INFINITY;
    for (int i = 0; i < LANES; i++)
        if (lanes_get(node->power, i) > 0) nearest = float_min(nearest, lanes_get(distance, i));
    return nearest > 0 ? nearest : 0;
}

Vec3f light_tree_middle(const LightTree *tree, uint32_t light)
{
    uint32_t at = tree->leaf_of[light];
    const TreeNode *node = &tree->nodes[at / PARTS];
    int part = (int)(at % PARTS);
    return vec3f(lanes_get(node->x, part), lanes_get(node->y, part), lanes_get(node->z, part));
}

/* ---- building ---- */

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
    /* inside already: the angle is no more than the difference of the two; without an arc cosine, as it is the usual case */
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

/* Sorts the stretch into two and returns where the second begins. Where lights are many, only the longest axis is looked
 * at, which is nearly always the best; the regularizer of [CK18] for thin boxes is then not needed. */
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

/* Sorts the stretch into PARTS, or as many as it has lights, always cutting the one with the most lights. Deep down it is
 * cut in the middle, so that no arrangement of lights makes the tree too deep. Returns the number. */
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

/* The upper levels are split level by level, a task for each node; then each of the nodes at their ends is built whole. The
 * branches that come from number i are PARTS * i + 1 and the next. */
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

void light_tree_free(LightTree *tree)
{
    if (!tree) return;
    free(tree->nodes);
    free(tree->parent);
    free(tree->leaf_of);
    free(tree);
}

double light_tree_power(const LightTree *tree)
{
    return tree->power;
}

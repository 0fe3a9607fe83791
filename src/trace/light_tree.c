/* light_tree.c - see light_tree.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/light_tree.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static const float pi_f = 3.14159265358979f;

/* Children stand side by side, so that a step down touches one stretch of memory. */
typedef struct TreeNode {
    Vec3f centre;
    float radius2; /* of the ball around the box, squared */
    Vec3f axis;
    float cos_o, sin_o, cos_e;
    float power;
    uint32_t parent;
    uint32_t child; /* the first of the two; of a leaf the light's number */
    bool leaf, two_sided;
} TreeNode;

struct LightTree {
    TreeNode *nodes; /* [0] is the root */
    uint32_t n_nodes;
    uint32_t *leaf_of; /* the node of each light; LIGHT_TREE_NONE for those left out */
    double power;
};

/* ---- importance ---- */

/* cos and sin of the angle a - b, or of 0 where b is larger; both angles in 0 .. pi. */
static inline float cos_difference(float sin_a, float cos_a, float sin_b, float cos_b)
{
    return cos_a > cos_b ? 1 : cos_a * cos_b + sin_a * sin_b;
}
static inline float sin_difference(float sin_a, float cos_a, float sin_b, float cos_b)
{
    return cos_a > cos_b ? 0 : sin_a * cos_b - cos_a * sin_b;
}
static inline float sine_of(float cosine)
{
    float square = 1 - cosine * cosine;
    return square > 0 ? sqrtf(square) : 0;
}

/* [CK18] eq. 3: what the lights of a node may give to a place at most, roughly: power over squared distance, times the
 * cosines at both ends as far as the bounds allow them. The distance is at least the radius of the ball around the
 * bounds, as within it the middle says little. */
static inline float importance(const TreeNode *node, Vec3f place, Vec3f normal, bool has_normal)
{
    Vec3f to = vec3f_sub(node->centre, place);
    float distance2 = vec3f_dot(to, to);
    bool within = distance2 <= node->radius2;
    float nearest2 = within ? node->radius2 : distance2;
    float value = node->power / (nearest2 > FLT_MIN ? nearest2 : FLT_MIN);
    if (within) return value; /* may be anywhere, and face anywhere */
    float inverse = 1 / sqrtf(distance2);
    float sin_b2 = node->radius2 / distance2; /* b: half of the angle under which the ball is seen */
    float sin_b = sqrtf(sin_b2), cos_b = sqrtf(1 - sin_b2);
    if (node->cos_o > -1) {
        float cos_w = -vec3f_dot(node->axis, to) * inverse;
        if (node->two_sided) cos_w = fabsf(cos_w);
        float sin_w = sine_of(cos_w);
        float cos_x = cos_difference(sin_w, cos_w, node->sin_o, node->cos_o);
        float sin_x = sin_difference(sin_w, cos_w, node->sin_o, node->cos_o);
        float cosine = cos_difference(sin_x, cos_x, sin_b, cos_b);
        if (cosine <= node->cos_e) return 0;
        value *= cosine > 0 ? cosine : FLT_MIN;
    }
    if (has_normal) {
        float cos_i = vec3f_dot(normal, to) * inverse;
        float cosine = cos_difference(sine_of(cos_i), cos_i, sin_b, cos_b);
        if (cosine <= 0) return 0;
        value *= cosine;
    }
    return value;
}

static bool is_set(Vec3f v)
{
    return v.x != 0 || v.y != 0 || v.z != 0;
}

uint32_t light_tree_choose(const LightTree *tree, Vec3 place, Vec3f normal, double *digits, float *probability)
{
    double u = *digits;
    *probability = 0;
    if (!tree->n_nodes) return LIGHT_TREE_NONE;
    Vec3f at = vec3f_from(place);
    bool has_normal = is_set(normal);
    const TreeNode *node = &tree->nodes[0];
    double chosen = 1;
    if (node->leaf && !(importance(node, at, normal, has_normal) > 0)) return LIGHT_TREE_NONE;
    while (!node->leaf) {
        const TreeNode *child = &tree->nodes[node->child];
        double a = (double)importance(&child[0], at, normal, has_normal),
               sum = a + (double)importance(&child[1], at, normal, has_normal);
        if (!(sum > 0)) return LIGHT_TREE_NONE;
        double first = a / sum;
        if (u < first) {
            u /= first;
            chosen *= first;
            node = &child[0];
        } else {
            u = (u - first) / (1 - first);
            chosen *= 1 - first;
            node = &child[1];
        }
        if (!(u < 1)) u = 1 - DBL_EPSILON;
    }
    *probability = (float)chosen;
    *digits = u;
    return node->child;
}

float light_tree_probability(const LightTree *tree, uint32_t light, Vec3 place, Vec3f normal)
{
    uint32_t at = tree->leaf_of[light];
    if (at == LIGHT_TREE_NONE) return 0;
    Vec3f from = vec3f_from(place);
    bool has_normal = is_set(normal);
    double chosen = 1;
    if (at == 0) return importance(&tree->nodes[0], from, normal, has_normal) > 0 ? 1 : 0;
    while (at != 0) {
        uint32_t parent = tree->nodes[at].parent, first = tree->nodes[parent].child;
        double a = (double)importance(&tree->nodes[first], from, normal, has_normal),
               sum = a + (double)importance(&tree->nodes[first + 1], from, normal, has_normal);
        double share = a / sum;
        if (!(sum > 0)) return 0;
        chosen *= at == first ? share : 1 - share;
        at = parent;
    }
    return (float)chosen;
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

/* [CK18] eq. 1 and 2: power, times the measure of directions, times the area of the box. */
static double cost_of(const LightBounds *b)
{
    if (!(b->power > 0)) return 0;
    double o = acos((double)b->cos_o), e = acos((double)b->cos_e), w = fmin(o + e, 3.14159265358979323846);
    if (b->two_sided) o = 3.14159265358979323846, w = o;
    double omega = 1 - cos(o) + 0.25 * (2 * w * sin(o) - cos(o - 2 * w) - 2 * o * sin(o) + cos(o));
    Vec3f d = vec3f_sub(b->high, b->low);
    double x = (double)d.x, y = (double)d.y, z = (double)d.z, diagonal = sqrt(x * x + y * y + z * z);
    /* lights in a line or at a point have no area; the square of what extent there is stands in */
    return (double)b->power * omega * (x * y + y * z + z * x + 1e-3 * diagonal * diagonal);
}

enum { N_BINS = 12 };

typedef struct Builder {
    LightTree *tree;
    const LightBounds *lights;
    uint32_t *order; /* numbers of the lights, sorted into the tree's order as it grows */
} Builder;

/* A stretch of the order that becomes a node. */
typedef struct Stretch {
    uint32_t begin, end, node;
} Stretch;

static int bin_of(const LightBounds *light, int axis, float low, float scale)
{
    int bin = (int)((component(middle(light), axis) - low) * scale);
    return bin < 0 ? 0 : bin >= N_BINS ? N_BINS - 1 : bin;
}

/* Where to cut along one axis: the last bin of the first half. Returns the cost. */
static double best_cut(const Builder *b, const Stretch *s, int axis, float low, float scale, int *cut)
{
    LightBounds bins[N_BINS] = {0};
    for (uint32_t i = s->begin; i < s->end; i++) {
        const LightBounds *light = &b->lights[b->order[i]];
        LightBounds *bin = &bins[bin_of(light, axis, low, scale)];
        *bin = bounds_union(bin, light);
    }
    double behind[N_BINS];
    LightBounds sum = {0};
    for (int i = N_BINS - 1; i > 0; i--) {
        sum = bounds_union(&sum, &bins[i]);
        behind[i] = sum.power > 0 ? cost_of(&sum) : -1;
    }
    double best = HUGE_VAL;
    sum = (LightBounds){0};
    for (int i = 0; i + 1 < N_BINS; i++) {
        sum = bounds_union(&sum, &bins[i]);
        if (!(sum.power > 0) || behind[i + 1] < 0) continue;
        double cost = cost_of(&sum) + behind[i + 1];
        if (cost >= best) continue;
        best = cost;
        *cut = i;
    }
    return best;
}

/* Sorts the stretch into two and returns where the second begins. Where lights are many, only the longest axis is looked
 * at, which is nearly always the best; the regularizer of [CK18] for thin boxes is then not needed. */
static uint32_t split(Builder *b, const Stretch *s)
{
    enum { ALL_AXES_BELOW = 4096 };
    Vec3f low = middle(&b->lights[b->order[s->begin]]), high = low;
    for (uint32_t i = s->begin + 1; i < s->end; i++) {
        low = vec3f_least(low, middle(&b->lights[b->order[i]]));
        high = vec3f_most(high, middle(&b->lights[b->order[i]]));
    }
    Vec3f extent = vec3f_sub(high, low);
    int longest = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    uint32_t n = s->end - s->begin, half = s->begin + n / 2;
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
    uint32_t first = s->begin;
    for (uint32_t i = s->begin; i < s->end; i++) {
        uint32_t light = b->order[i];
        if (bin_of(&b->lights[light], axis, start, scale) > cut) continue;
        b->order[i] = b->order[first];
        b->order[first++] = light;
    }
    return first > s->begin && first < s->end ? first : half;
}

static void fill_node(TreeNode *node, const LightBounds *b)
{
    Vec3f half = vec3f_scale(vec3f_sub(b->high, b->low), 0.5f);
    node->centre = vec3f_scale(vec3f_add(b->low, b->high), 0.5f);
    node->radius2 = vec3f_dot(half, half) * 1.00001f;
    node->axis = b->axis;
    node->cos_o = b->cos_o;
    node->sin_o = sine_of(b->cos_o);
    node->cos_e = b->cos_e;
    node->power = b->power;
    node->two_sided = b->two_sided;
}

/* Nodes from the root down; each stretch lies in its parent's, so that a stack of one per level of the larger halves is
 * enough: the smaller half is done first. */
static void build(Builder *b, uint32_t n)
{
    LightTree *tree = b->tree;
    Stretch stack[64];
    int depth = 0;
    stack[depth++] = (Stretch){0, n, 0};
    tree->n_nodes = 1;
    while (depth) {
        Stretch s = stack[--depth];
        TreeNode *node = &tree->nodes[s.node];
        if (s.end - s.begin == 1) {
            node->leaf = true;
            node->child = b->order[s.begin];
            tree->leaf_of[node->child] = s.node;
            continue;
        }
        uint32_t middle_at = split(b, &s), child = tree->n_nodes;
        tree->n_nodes += 2;
        node->child = child;
        tree->nodes[child].parent = tree->nodes[child + 1].parent = s.node;
        Stretch first = {s.begin, middle_at, child}, second = {middle_at, s.end, child + 1};
        bool first_is_larger = first.end - first.begin > second.end - second.begin;
        stack[depth++] = first_is_larger ? first : second;
        stack[depth++] = first_is_larger ? second : first;
    }
}

/* Bounds of all nodes, from the leaves up: a child always comes behind its parent. */
static void bound(Builder *b, LightBounds *bounds)
{
    LightTree *tree = b->tree;
    for (uint32_t i = tree->n_nodes; i-- > 0;) {
        TreeNode *node = &tree->nodes[i];
        bounds[i] = node->leaf ? b->lights[node->child] : bounds_union(&bounds[node->child], &bounds[node->child + 1]);
        fill_node(node, &bounds[i]);
    }
}

Status light_tree_new(const LightBounds *lights, uint32_t n, LightTree **tree, Error *error)
{
    LightTree *made = calloc(1, sizeof *made);
    uint32_t *order = malloc((n + 1UL) * sizeof *order), n_shining = 0;
    if (made) made->leaf_of = malloc((n + 1UL) * sizeof *made->leaf_of);
    for (uint32_t i = 0; made && made->leaf_of && order && i < n; i++) {
        made->leaf_of[i] = LIGHT_TREE_NONE;
        if (!(lights[i].power > 0)) continue;
        order[n_shining++] = i;
        made->power += (double)lights[i].power;
    }
    size_t n_nodes = n_shining ? 2UL * n_shining - 1 : 1;
    LightBounds *bounds = malloc(n_nodes * sizeof *bounds);
    if (made) made->nodes = calloc(n_nodes, sizeof *made->nodes);
    if (!made || !order || !bounds || !made->leaf_of || !made->nodes) {
        free(order);
        free(bounds);
        light_tree_free(made);
        return fail_memory(error, n_nodes * sizeof *made->nodes, "a tree of lights");
    }
    Builder b = {made, lights, order};
    if (n_shining) {
        build(&b, n_shining);
        bound(&b, bounds);
    }
    free(order);
    free(bounds);
    *tree = made;
    return STATUS_OK;
}

void light_tree_free(LightTree *tree)
{
    if (!tree) return;
    free(tree->nodes);
    free(tree->leaf_of);
    free(tree);
}

double light_tree_power(const LightTree *tree)
{
    return tree->power;
}

/* light_tree.c - see light_tree.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/light_tree_nodes.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

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
    return lanes_greater(a, lanes_all(low));
}
static inline Lanes sine_of(Lanes cosine)
{
    return lanes_sqrt(at_least(lanes_rest(lanes_mul(cosine, cosine)), 0));
}
static inline Lanes dot(Lanes ax, Lanes ay, Lanes az, Lanes bx, Lanes by, Lanes bz)
{
    return lanes_add(lanes_add(lanes_mul(ax, bx), lanes_mul(ay, by)), lanes_mul(az, bz));
}

/* How much of their light a node's parts may send along directions whose lengths are 1 / inverse, as far as their
 * normals tell; sin_b and cos_b: half of the angle under which the part's ball is seen. */
static inline Lanes sent(const TreeNode *node, Lanes x, Lanes y, Lanes z, Lanes inverse, Lanes sin_b, Lanes cos_b)
{
    Lanes cos_w = lanes_mul(dot(node->axis_x, node->axis_y, node->axis_z, x, y, z), lanes_sub(lanes_all(0), inverse));
    Lanes other = lanes_mul(cos_w, lanes_sub(lanes_all(1), lanes_add(node->two_sided, node->two_sided)));
    cos_w = lanes_greater(other, cos_w);
    Lanes sin_w = sine_of(cos_w), sin_o = sine_of(node->cos_o);
    Lanes cos_x = cos_difference(sin_w, cos_w, sin_o, node->cos_o);
    Lanes sin_x = sin_difference(sin_w, cos_w, sin_o, node->cos_o);
    Lanes cosine = cos_difference(sin_x, cos_x, sin_b, cos_b);
    Lanes part = lanes_select_less(node->cos_e, cosine, at_least(cosine, FLT_MIN), lanes_all(0));
    return lanes_select_less(lanes_all(-1), node->cos_o, part, lanes_all(1));
}

/* [CK18] eq. 3: what the lights of each part may give to a place at most, roughly: power over squared distance, times
 * the cosines at both ends as far as the bounds allow them. The distance is at least the radius of the ball around the
 * bounds, as within it the middle says little: lights there may be anywhere, and face anywhere. */
static inline Lanes importance(const TreeNode *node, Vec3f place, Vec3f normal, bool has_normal)
{
    Lanes x = lanes_sub(node->x, lanes_all(place.x)), y = lanes_sub(node->y, lanes_all(place.y)),
          z = lanes_sub(node->z, lanes_all(place.z));
    Lanes distance2 = dot(x, y, z, x, y, z);
    Lanes nearest2 = lanes_greater(node->radius2, distance2);
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

/* How much of their light a node's parts send to where the line is nearest to their axes: what shines into a narrow cone may cross it
 * there, and hardly does where the line is nearest to the lights. */
static inline Lanes sent_across(const TreeNode *node, const LightLine *line)
{
    Lanes dx = lanes_all(line->direction.x), dy = lanes_all(line->direction.y), dz = lanes_all(line->direction.z);
    Lanes x = lanes_sub(node->x, lanes_all(line->origin.x)), y = lanes_sub(node->y, lanes_all(line->origin.y)),
          z = lanes_sub(node->z, lanes_all(line->origin.z));
    Lanes slope = dot(dx, dy, dz, node->axis_x, node->axis_y, node->axis_z);
    Lanes along = dot(x, y, z, dx, dy, dz), height = dot(x, y, z, node->axis_x, node->axis_y, node->axis_z);
    Lanes place =
        lanes_div(lanes_sub(along, lanes_mul(slope, height)), at_least(lanes_rest(lanes_mul(slope, slope)), 1e-6f));
    place = lanes_greater(lanes_lesser(place, lanes_all(line->end)), lanes_all(line->begin));
    x = lanes_sub(x, lanes_mul(place, dx)), y = lanes_sub(y, lanes_mul(place, dy)),
    z = lanes_sub(z, lanes_mul(place, dz));
    Lanes distance2 = at_least(dot(x, y, z, x, y, z), FLT_MIN), inverse2 = lanes_div(lanes_all(1), distance2);
    Lanes sin_b2 = lanes_mul(node->radius2, inverse2);
    Lanes part =
        sent(node, x, y, z, lanes_sqrt(inverse2), lanes_sqrt(sin_b2), lanes_sqrt(at_least(lanes_rest(sin_b2), 0)));
    return lanes_select_less(node->radius2, distance2, part, lanes_all(1));
}

/* The integral of power over squared distance along a line, as from the middle of the bounds and no nearer than their
 * radius: [KF12] section 3. Which way the lights face counts as seen from the line's nearest place, but never excludes them; of those
 * that shine into cones alone, as seen from where the line is nearest to their axes, too. */
static inline Lanes importance_along(const TreeNode *node, const LightLine *line)
{
    const float least = 0.1f, narrow = 0.5f;
    Beside at = beside(node, line);
    Lanes begin = lanes_sub(lanes_all(line->begin), at.along), end = lanes_sub(lanes_all(line->end), at.along);
    Lanes beyond = at_least(begin, 0);
    beyond = lanes_add(beyond, at_least(lanes_sub(lanes_all(0), end), 0)); /* of the line's ends, seen along it */
    Lanes to2 = dot(at.x, at.y, at.z, at.x, at.y, at.z);
    Lanes distance2 =
        lanes_add(at_least(lanes_sub(to2, lanes_mul(beyond, beyond)), 0), at_least(node->radius2, FLT_MIN));
    Lanes distance = lanes_sqrt(distance2), across = lanes_mul(distance, lanes_sub(end, begin));
    Lanes angle = lanes_atan2(across, lanes_add(distance2, lanes_mul(end, begin)));
    Lanes inverse = lanes_sqrt(lanes_div(lanes_all(1), at_least(to2, FLT_MIN)));
    Lanes part = at_least(sent(node, at.x, at.y, at.z, inverse, lanes_all(0), lanes_all(1)), least);
    if (UNLIKELY(lanes_not_above(lanes_all(narrow), node->cos_e)))
        part = lanes_select_less(lanes_all(narrow), node->cos_e, lanes_greater(part, sent_across(node, line)), part);
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

bool light_tree_ball(const LightTree *tree, uint32_t light, Vec3 *middle, double *radius)
{
    uint32_t at = tree->leaf_of[light];
    if (at == LIGHT_TREE_NONE) return false;
    *middle = vec3_from_f(light_tree_middle(tree, light));
    *radius = sqrt((double)lanes_get(tree->nodes[at / PARTS].radius2, (int)(at % PARTS)));
    return true;
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

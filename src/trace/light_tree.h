/* light_tree.h - choosing one of many lights by how much light each may give to a place.
 * A tree of bounds after A. Conty Estevez, C. Kulla, "Importance Sampling of Many Lights with Adaptive Tree
 * Splitting", PACMCGIT 1(2) (2018), [CK18]: each node bounds the places, the directions and the power of the lights
 * below it, and a choice goes down by the importance of what is below. Theirs is binary; a node here has up to four
 * parts, which are compared at once. We choose a single light, without splitting.
 * The tree knows nothing of what the lights are.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_TREE_H
#define MEN_LIGHT_TREE_H

#include "base/pool.h"
#include "base/status.h"
#include "base/vec3.h"

/* Where a light is, which way it faces and how strong it is. Normals lie within the cone of angle o about the axis, and
 * light leaves within the angle e of a normal. */
typedef struct LightBounds {
    Vec3f low, high;
    Vec3f axis;         /* unit */
    float cos_o, cos_e; /* cos_o = -1: normals to all sides */
    float power;        /* any unit that all lights share; lights with 0 or less are left out */
    bool two_sided;     /* shines along the normals and against them */
} LightBounds;

typedef struct LightTree LightTree;

/* The most lights that there can be. */
#define LIGHT_TREE_MOST (UINT32_MAX / 4)
/* Bounds of n lights, numbered from 0, LIGHT_TREE_MOST at most; not kept. Built by the pool's threads, NULL: by this
 * one; the tree is the same. A tree of n lights takes at most 136 bytes for each. */
ATTR_NODISCARD Status light_tree_new(const LightBounds *lights, uint32_t n, Pool *pool, LightTree **tree, Error *error);
void light_tree_free(LightTree *tree); /* NULL is fine */
/* The sum of the lights' powers. */
double light_tree_power(const LightTree *tree);

#define LIGHT_TREE_NONE UINT32_MAX

/* Chooses a light for a place; *u uniform in [0, 1), with more digits than a float has where there are many lights, and
 * afterwards what is left of its digits, uniform again. normal: of a surface there that takes light from its one side
 * only, unit; zero where light may come from anywhere. Returns the light's number and the probability with which it is
 * chosen; LIGHT_TREE_NONE when none of them can shine to there. */
uint32_t light_tree_choose(const LightTree *tree, Vec3 place, Vec3f normal, double *u, float *probability);
/* The probability with which light_tree_choose chooses a light; 0 for lights that were left out. */
float light_tree_probability(const LightTree *tree, uint32_t light, Vec3 place, Vec3f normal);

/* A stretch of a line, from begin to end along its direction. */
typedef struct LightLine {
    Vec3f origin, direction;
    float begin, end;
} LightLine;
/* The same for all places of a line together, a medium that scatters a little being there. */
uint32_t light_tree_choose_along(const LightTree *tree, const LightLine *line, double *u, float *probability);
float light_tree_probability_along(const LightTree *tree, uint32_t light, const LightLine *line);
/* How far the nearest light is from a line, at least; INFINITY where there is none. */
float light_tree_nearest(const LightTree *tree, const LightLine *line);
/* The ball around a light's bounds; false: it was left out. */
bool light_tree_ball(const LightTree *tree, uint32_t light, Vec3 *middle, double *radius);
/* The middle of a light's bounds; of one that was not left out. */
Vec3f light_tree_middle(const LightTree *tree, uint32_t light);

#endif

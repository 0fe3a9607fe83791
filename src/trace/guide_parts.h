/* guide_parts.h - what a guide is made of; private to src/trace/guide*.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GUIDE_PARTS_H
#define MEN_GUIDE_PARTS_H

#include "trace/guide.h"
#include "trace/guide_fit.h"

/* Of a binary tree: children stand side by side. */
typedef struct GuideNode {
    float split;
    uint32_t axis;  /* GUIDE_KIND: by what is there; GUIDE_LEAF: of none */
    uint32_t first; /* child, or the cell of a leaf */
} GuideNode;
/* What lands on frosted glass is by itself: a wall behind it and the glass would share cells, of which neither could be
 * described well, for on the glass all is brighter by far. Of the root only; boundaries are the second child. */
enum { GUIDE_KIND = 3, GUIDE_LEAF = 4 };

/* Around what media scatter in a part of the tree, for lines that pass it by. */
typedef struct GuideBox {
    float low[3], high[3];
} GuideBox;

struct Guide {
    GuideNode *nodes;
    GuideBox *boxes; /* of the nodes */
    GuideCell *cells;
    GuideFour *fours;
    uint32_t n_nodes, n_cells, n_lobes, n_fours;
    uint32_t *begins; /* of each cell's photons, as guide_build has sorted them; the last is the end of all */
    uint32_t *visits; /* how often paths came to each cell while it was tried out; NULL: it was not */
    float threshold;  /* see guide_threshold */
    float most_looks; /* of any cell */
    double bright;    /* see guide_bright */
};

static inline Vec3f guide_cell_origin(const GuideCell *cell)
{
    return vec3f_scale(vec3f_add(cell->low, cell->high), 0.5f);
}

static inline float guide_coordinate(Vec3f p, uint32_t axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/* The cell of the tree that a place is in, or beside. */
static inline uint32_t guide_leaf(const Guide *guide, Vec3f p, bool at_boundary)
{
    const GuideNode *node = guide->nodes;
    if (node->axis == GUIDE_KIND) node = guide->nodes + node->first + at_boundary;
    while (node->axis != GUIDE_LEAF)
        node = guide->nodes + node->first + (guide_coordinate(p, node->axis) >= node->split);
    return node->first;
}

/* ---- guide.c ---- */

/* To be told when cells' shares were set. */
void guide_shares_are_set(Guide *guide);
/* Sets the nodes' boxes, when the cells are there. STATUS_NOMEM. */
ATTR_NODISCARD Status guide_set_boxes(Guide *guide, Error *error);

/* ---- guide_try.c ---- */

/* A promise that nothing but light behind glass makes which some pixels get: examples have 0.1 to 20, whatever they gain. */
#define GUIDE_GREAT_PROMISE 1000.0

typedef struct GuideWorth {
    double gain; /* expected: variance times work without it, over that with it */
    /* what photons say of the variance that it could take away, roughly and at most: of that without it */
    double promise;
    double rays_per_path; /* without it */
    /* what the cells scatter along a bright line through them: that of lines, weighted by itself; 0: no line */
    double bright;
    uint64_t rays; /* that this took */
} GuideWorth;

/* What a guide is tried out on, and what it was made of. */
typedef struct GuideTrial {
    const World *world;
    const GuideSettings *settings;
    uint32_t paths;        /* about so many of the camera's */
    const Photon *photons; /* that landed, as guide_build left them, */
    uint32_t followed;     /* and of how many */
} GuideTrial;

/* Follows those paths with the guide, of which the threshold is set, and throws them away. Sets the cells' shares so that variance
 * times work is least, and how often paths came to them. STATUS_NOMEM. */
ATTR_NODISCARD Status guide_try(Guide *guide, const GuideTrial *of, Pool *pool, GuideWorth *worth, Error *error);

/* ---- guide_build.c ---- */

/* A guide from the n photons that landed of those that were followed, of which at least one was looked around at; they are
 * put into another order. Half the places send probes until shares are chosen. STATUS_NOMEM. */
ATTR_NODISCARD Status guide_build(Photon *photons, uint32_t n, uint32_t followed, Pool *pool, Guide **out,
                                  Error *error);
/* The radiance that a white surface would send on for a path that has found the photon's light, by itself or by
 * probes: what a firefly is as bright as. */
float guide_sample_of(const Guide *guide, uint32_t cell, float share, const Photon *photon);

#endif

/* guide.c - looking up a guide, and choosing directions by it.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "trace/guide_parts.h"

void guide_free(Guide *guide)
{
    if (!guide) return;
    free(guide->nodes);
    free(guide->cells);
    free(guide->fours);
    free(guide->begins);
    free(guide->visits);
    free(guide);
}

GuideAt guide_find(const Guide *guide, Vec3 place, float color)
{
    Vec3f p = vec3f_from(place);
    const GuideCell *cell = &guide->cells[guide_leaf(guide, p)];
    if (p.x < cell->low.x || p.y < cell->low.y || p.z < cell->low.z || p.x > cell->high.x || p.y > cell->high.y ||
        p.z > cell->high.z)
        return (GuideAt){.share = 0};
    return (GuideAt){guide, cell, vec3f_along(p, -1, guide_cell_origin(cell)), color, cell->share, cell->share};
}

typedef struct Walk {
    const Guide *guide;
    double origin[3], direction[3];
    GuideVisitor *visit;
    void *context;
} Walk;

static void walk_cell(const Walk *walk, const GuideCell *cell, double begin, double end)
{
    const float low[3] = {cell->low.x, cell->low.y, cell->low.z}, high[3] = {cell->high.x, cell->high.y, cell->high.z};
    if (!(cell->scattered > 0)) return;
    for (int i = 0; i < 3; i++) {
        double d = walk->direction[i], a = (double)low[i] - walk->origin[i], b = (double)high[i] - walk->origin[i];
        if (d == 0 && (a > 0 || b < 0)) return;
        if (d == 0) continue;
        begin = double_max(begin, double_min(a / d, b / d));
        end = double_min(end, double_max(a / d, b / d));
    }
    if (begin < end) walk->visit(walk->context, cell, begin, end);
}

static void walk_node(const Walk *walk, const GuideNode *node, double begin, double end)
{
    if (node->axis == GUIDE_LEAF) {
        walk_cell(walk, &walk->guide->cells[node->first], begin, end);
        return;
    }
    const GuideNode *children = walk->guide->nodes + node->first;
    double to = (double)node->split - walk->origin[node->axis], d = walk->direction[node->axis];
    bool above = begin * d >= to, then_above = end * d >= to;
    if (above == then_above) {
        walk_node(walk, &children[above], begin, end);
        return;
    }
    double between = double_min(double_max(to / d, begin), end);
    walk_node(walk, &children[above], begin, between);
    walk_node(walk, &children[then_above], between, end);
}

void guide_walk(const Guide *guide, Vec3 origin, Vec3 direction, double begin, double end, GuideVisitor *visit,
                void *context)
{
    Walk walk = {guide, {origin.x, origin.y, origin.z}, {direction.x, direction.y, direction.z}, visit, context};
    walk_node(&walk, guide->nodes, begin, end);
}

Vec3f guide_sample(const GuideAt *at, float u, const float v[2])
{
    GuidePlace place = {at->offset, at->color};
    return guide_sample_lobes(at->guide->fours + at->cell->first_four, at->cell->n_lobes, place, u, v);
}

float guide_pdf(const GuideAt *at, Vec3f direction)
{
    GuidePlace place = {at->offset, at->color};
    return guide_lobes_pdf(at->guide->fours + at->cell->first_four, at->cell->n_lobes, place, direction);
}

float guide_threshold(const Guide *guide)
{
    return guide->threshold;
}

double guide_bright(const Guide *guide)
{
    return guide->bright;
}

float guide_most_looks(const Guide *guide)
{
    return guide->most_looks;
}

void guide_shares_are_set(Guide *guide)
{
    guide->most_looks = 0;
    for (uint32_t i = 0; i < guide->n_cells; i++)
        if (guide->cells[i].scattered > 0) guide->most_looks = float_max(guide->most_looks, guide->cells[i].looks);
}

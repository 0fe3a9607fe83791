/* guide.c - looking up a guide, and choosing directions by it.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "trace/guide_parts.h"

/* What a direction is taken to have at least along each axis, so that nothing is divided by 0. */
#define LEVEL 1e-30

void guide_free(Guide *guide)
{
    if (!guide) return;
    free(guide->nodes);
    free(guide->boxes);
    free(guide->cells);
    free(guide->fours);
    free(guide->begins);
    free(guide->visits);
    free(guide);
}

GuideAt guide_find(const Guide *guide, Vec3 place, bool at_boundary, float color)
{
    Vec3f p = vec3f_from(place);
    const GuideCell *cell = &guide->cells[guide_leaf(guide, p, at_boundary)];
    if (p.x < cell->low.x || p.y < cell->low.y || p.z < cell->low.z || p.x > cell->high.x || p.y > cell->high.y ||
        p.z > cell->high.z)
        return (GuideAt){.share = 0};
    return (GuideAt){guide, cell, vec3f_along(p, -1, guide_cell_origin(cell)), color, cell->share, cell->share};
}

typedef struct Walk {
    const Guide *guide;
    double origin[3], inverse[3]; /* of the direction */
    GuideVisitor *visit;
    void *context;
} Walk;

/* Cuts a stretch of the line to a box, which may be of nothing; false: nothing is left. */
static inline bool cut_to_box(const Walk *walk, const GuideBox *box, double *begin, double *end)
{
    if (box->low[0] > box->high[0]) return false;
    for (int i = 0; i < 3; i++) {
        double a = ((double)box->low[i] - walk->origin[i]) * walk->inverse[i],
               b = ((double)box->high[i] - walk->origin[i]) * walk->inverse[i];
        *begin = double_max(*begin, double_min(a, b));
        *end = double_min(*end, double_max(a, b));
    }
    return *begin < *end;
}

static void walk_node(const Walk *walk, uint32_t number, double begin, double end)
{
    const Guide *guide = walk->guide;
    const GuideNode *node = &guide->nodes[number];
    if (!cut_to_box(walk, &guide->boxes[number], &begin, &end)) return;
    if (node->axis == GUIDE_LEAF) {
        walk->visit(walk->context, &guide->cells[node->first], begin, end);
        return;
    }
    if (node->axis == GUIDE_KIND) { /* nothing on a boundary is in a medium */
        walk_node(walk, node->first, begin, end);
        return;
    }
    double inverse = walk->inverse[node->axis], at = ((double)node->split - walk->origin[node->axis]) * inverse;
    bool last_above = inverse > 0;
    if (begin < at) walk_node(walk, node->first + !last_above, begin, double_min(at, end));
    if (end > at) walk_node(walk, node->first + last_above, double_max(at, begin), end);
}

void guide_walk(const Guide *guide, Vec3 origin, Vec3 direction, double begin, double end, GuideVisitor *visit,
                void *context)
{
    const double d[3] = {direction.x, direction.y, direction.z};
    Walk walk = {.guide = guide, .origin = {origin.x, origin.y, origin.z}, .visit = visit, .context = context};
    for (int i = 0; i < 3; i++) walk.inverse[i] = 1 / (fabs(d[i]) > LEVEL ? d[i] : LEVEL);
    walk_node(&walk, 0, begin, end);
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

void guide_leads(const GuideAt *at, Vec3f direction, Leads *leads)
{
    GuidePlace place = {at->offset, at->color};
    guide_lobes_leads(at->guide->fours + at->cell->first_four, at->cell->n_lobes, place, direction, leads);
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

static GuideBox box_of_leaf(const GuideCell *cell)
{
    GuideBox box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    if (cell->scattered > 0)
        box = (GuideBox){{cell->low.x, cell->low.y, cell->low.z}, {cell->high.x, cell->high.y, cell->high.z}};
    return box;
}

Status guide_set_boxes(Guide *guide, Error *error)
{
    guide->boxes = malloc(guide->n_nodes * sizeof *guide->boxes);
    if (!guide->boxes) return fail_memory(error, guide->n_nodes * sizeof *guide->boxes, "caustics");
    for (uint32_t number = guide->n_nodes; number-- > 0;) { /* children first */
        const GuideNode *node = &guide->nodes[number];
        if (node->axis == GUIDE_LEAF) {
            guide->boxes[number] = box_of_leaf(&guide->cells[node->first]);
            continue;
        }
        const GuideBox *a = &guide->boxes[node->first], *b = a + 1;
        for (int i = 0; i < 3; i++) {
            guide->boxes[number].low[i] = float_min(a->low[i], b->low[i]);
            guide->boxes[number].high[i] = float_max(a->high[i], b->high[i]);
        }
    }
    return STATUS_OK;
}

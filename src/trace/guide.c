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

GuideAt guide_find(const Guide *guide, Vec3 place)
{
    Vec3f p = vec3f_from(place);
    const GuideCell *cell = &guide->cells[guide_leaf(guide, p)];
    if (p.x < cell->low.x || p.y < cell->low.y || p.z < cell->low.z || p.x > cell->high.x || p.y > cell->high.y ||
        p.z > cell->high.z)
        return (GuideAt){.share = 0};
    return (GuideAt){guide, cell, vec3f_along(p, -1, guide_cell_origin(cell)), cell->share};
}

Vec3f guide_sample(const GuideAt *at, float u, const float v[2])
{
    return guide_sample_lobes(at->guide->fours + at->cell->first_four, at->cell->n_lobes, at->offset, u, v);
}

float guide_pdf(const GuideAt *at, Vec3f direction)
{
    return guide_lobes_pdf(at->guide->fours + at->cell->first_four, at->cell->n_lobes, at->offset, direction);
}

float guide_threshold(const Guide *guide)
{
    return guide->threshold;
}

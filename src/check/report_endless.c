/* report_endless.c - media without end in which light wanders for ever: a path there is not done before it meets a wall by chance.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"
#include "check/sight_line.h"

/* So often may a path be scattered on the mean before it is absorbed, and be no slower than others: see many-scatterings. */
static const double many = 1000;
enum { DIRECTIONS = 64 };

/* Whether some of a medium has no end. */
static bool is_unbounded(const CompiledScene *compiled, uint32_t medium)
{
    bool unbounded = medium == NEST_WORLD_MEDIUM;
    for (uint32_t h = 0; h < compiled->n_hulls && !unbounded; h++)
        unbounded = compiled->unbounded[h] && compiled->order.top[h].medium == medium;
    return unbounded;
}

/* Whether lines from a camera come to that medium without end: in a closed room its walls end all of them. */
static bool is_open(const CompiledScene *compiled, Vec3 from, uint32_t medium)
{
    bool open = false;
    for (int i = 0; i < DIRECTIONS && !open; i++) {
        Ray ray = ray_make(from, vec3f_from(report_direction(i, DIRECTIONS, -1)));
        SightLine line;
        if (sight_line_find(compiled, &ray, &line, NULL) == STATUS_OK) {
            const SightStep *last = line.n ? &line.steps[line.n - 1] : NULL;
            open = last ? last->kind != SIGHT_OPAQUE && last->to == medium : line.start == medium;
        }
        sight_line_clear(&line);
    }
    return open;
}

void report_endless(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    for (uint32_t i = 0; i < scene->n_media; i++) {
        const SceneMedium *medium = &scene->media[i];
        if (!scene->n_cameras || !medium->scatters || medium->density || !is_unbounded(compiled, i) ||
            !(report_count_scatterings(medium, (double)INFINITY) > many) ||
            !is_open(compiled, scene->cameras[0].from, i))
            continue;
        Diagnostic *report = diag_report(diag, D_ENDLESS_SCATTERING, medium->span,
                                         "%s scatters light, has no end, and %s: paths wander in it for very long",
                                         medium->name, medium->absorbs ? "hardly absorbs any" : "absorbs none");
        diag_hint(diag, report,
                  "give it an absorption of a hundredth of its scattering, or an end, as the interior of a box that is "
                  "large enough");
    }
}

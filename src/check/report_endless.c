/* report_endless.c - media without end in which light wanders for ever: a path there is not done before it meets a wall by chance.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"
#include "check/sight_line.h"

/* So often may a path be scattered on the mean before it is absorbed, and be no slower than others: see many-scatterings. */
static const double many = 1000;
enum { DIRECTIONS = 64 };

/* How often light is scattered before it is absorbed, of the wavelength of which that is most; 0 where it is not, or where that
 * varies from place to place. */
static double count_scatterings(const SceneMedium *medium)
{
    double most = 0;
    if (!medium->scatters || medium->density) return 0;
    for (float nm = 450; nm <= 650; nm += 50) {
        double scattering = (double)spectrum_at_one(&medium->scattering, nm),
               absorption = (double)spectrum_at_one(&medium->absorption, nm);
        if (scattering > 0) most = fmax(most, scattering / absorption);
    }
    return most;
}

/* Whether lines from a camera come to that medium without end: in a closed room its walls end all of them. */
static bool is_open(const CompiledScene *compiled, Vec3 from, uint32_t medium)
{
    bool open = false;
    for (int i = 0; i < DIRECTIONS && !open; i++) {
        double y = 1 - 2 * (i + 0.5) / DIRECTIONS, turn = 2.399963229728653 * i, r = sqrt(1 - y * y);
        Ray ray = ray_make(from, vec3f_from(vec3(r * cos(turn), y, r * sin(turn))));
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
        if (!scene->n_cameras || !(count_scatterings(medium) > many) || !is_open(compiled, scene->cameras[0].from, i))
            continue;
        Diagnostic *report = diag_report(diag, D_ENDLESS_SCATTERING, medium->span,
                                         "%s scatters light, has no end, and %s: paths wander in it for very long",
                                         medium->name, medium->absorbs ? "hardly absorbs any" : "absorbs none");
        diag_hint(diag, report,
                  "give it an absorption of a hundredth of its scattering, or an end, as the interior of a box that is "
                  "large enough");
    }
}

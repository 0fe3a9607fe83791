/* report_scattering.c - media in which light is scattered so often that its paths take long, or for ever.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "base/num.h"
#include "check/report_parts.h"
#include "check/sight_line.h"

/* The mean length of lines through a body, of all directions: 4 V / S, S its surface. That is at least a ball's of its volume; about
 * as large a part of its box's as its volume is of the box's, which is so of balls, cylinders and cubes in theirs; and where it
 * is hollow, half of that at least. */
static double mean_chord(double volume, const Box3 *box)
{
    Vec3 d = vec3_sub(box->max, box->min);
    double of_ball = cbrt(36 * MEN_PI * volume * volume), of_box = 2 * (d.x * d.y + d.y * d.z + d.z * d.x);
    return 4 * volume / fmax(of_ball, of_box * fmax(volume / (d.x * d.y * d.z), 0.5));
}

/* How often light is scattered in a body before it has left or is absorbed, of the wavelength of which that is most; chord: the mean
 * length of lines through it, INFINITY where it has no end. Of a medium that is the same everywhere. What comes in evenly goes
 * 4 V / S in there on the mean, however often it is scattered (S. Blanco, R. Fournier, "An Invariance Property of Diffusive Random
 * Walks", Europhysics Letters 61(2) (2003)). */
static double count_scatterings(const SceneMedium *medium, double chord)
{
    const float wavelengths[] = {450, 500, 550, 600, 650};
    double most = 0;
    for (size_t i = 0; i < COUNT_OF(wavelengths); i++) {
        double scattering = (double)spectrum_at_one(&medium->scattering, wavelengths[i]),
               absorption = (double)spectrum_at_one(&medium->absorption, wavelengths[i]);
        most = fmax(most, scattering / (1 / chord + absorption));
    }
    return most;
}

/* ---- media without end ---- */

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
            !(count_scatterings(medium, (double)INFINITY) > many) || !is_open(compiled, scene->cameras[0].from, i))
            continue;
        Diagnostic *report = diag_report(diag, D_ENDLESS_SCATTERING, medium->span,
                                         "%s scatters light, has no end, and %s: paths wander in it for very long",
                                         medium->name, medium->absorbs ? "hardly absorbs any" : "absorbs none");
        diag_hint(diag, report,
                  "give it an absorption of a hundredth of its scattering, or an end, as the interior of a box that is "
                  "large enough");
    }
}

/* ---- bodies of them ---- */

/* In a body of a larger index than what is around it light is held back by total reflection, and goes further by the square of
 * that (R. Savo et al., "Observation of mean path length invariance in light-scattering media", Science 358 (2017)). */
static double index_squared(const Scene *scene, const SceneMedium *medium)
{
    double index = (double)spectrum_at_one(&medium->ior, SCENE_INDEX_NM) /
                   (double)spectrum_at_one(&scene->media[NEST_WORLD_MEDIUM].ior, SCENE_INDEX_NM);
    return fmax(index * index, 1);
}

static double mean_cosine(const Phase *phase)
{
    enum { STEPS = 20000 };
    double sum = 0, total = 0;
    if (!phase->table) return phase->weight * phase->lobes[0].g + (1 - phase->weight) * phase->lobes[1].g;
    for (int i = 0; i < STEPS; i++) {
        double cosine = -1 + (i + 0.5) * 2 / STEPS, sine = sqrt(1 - cosine * cosine);
        Vec3f direction = vec3f_from(vec3(sine, 0, cosine));
        double value = (double)lanes_get(phase_evaluate(phase, vec3f(0, 0, 1), direction, lanes_all(550)), 0);
        sum += value * cosine;
        total += value;
    }
    return sum / total;
}

/* How far a path goes from a place in a box before it comes out: a random walk between parallel faces a from the middle, x off it, goes
 * on for 3 (a^2 - x^2) / (2 l) on the mean, where l is how far it keeps its direction; three pairs of faces let out at once: from the
 * middle of a box as from that of a ball in it. */
static double way_from(Vec3 from, const Box3 *box, double scattering, double cosine)
{
    const double place[3] = {from.x, from.y, from.z}, low[3] = {box->min.x, box->min.y, box->min.z},
                 high[3] = {box->max.x, box->max.y, box->max.z};
    double rate = 0;
    for (int i = 0; i < 3; i++) rate += 1 / fmax((place[i] - low[i]) * (high[i] - place[i]), 1e-300);
    return 1.5 * scattering * (1 - cosine) / rate;
}

/* The longest such way of a camera that looks from within the hull; 0: none does. */
static double way_of_cameras(const CompiledScene *compiled, uint32_t hull, const SceneMedium *medium)
{
    const Scene *scene = compiled->scene;
    const Box3 *box = &compiled->hull_bounds[hull];
    double longest = 0, scattering = (double)spectrum_at_one(&medium->scattering, SCENE_INDEX_NM);
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    for (uint32_t i = 0; i < scene->n_cameras; i++) {
        Vec3 from = scene->cameras[i].from;
        if (box3_holds_point(*box, from) &&
            compiled_interior(compiled, vec3f_from(from), 0, &hits, &list, NULL) == STATUS_OK &&
            nest_has(&compiled->order, &list, hull) && &scene->media[nest_medium(&list)] == medium)
            longest = fmax(longest, way_from(from, box, scattering, mean_cosine(&medium->phase)));
    }
    hit_list_clear(&hits);
    nest_list_clear(&list);
    return longest;
}

static void report_many(const CompiledScene *compiled, uint32_t hull, double n, bool from_camera, Diag *diag)
{
    const SceneObject *object = report_object(compiled, hull);
    const SceneMedium *medium = &compiled->scene->media[object->medium];
    Diagnostic *report = diag_report(diag, D_MANY_SCATTERINGS, object->span,
                                     "light is scattered some %.0f times in %s %s, which takes a path as many steps",
                                     num_round_down(n, 2), object->name,
                                     from_camera ? "on its way to the camera in there" : "before it leaves");
    diag_note(diag, report, medium->span, "its medium is here");
    diag_hint(diag, report,
              "if no light is to be seen through it, a surface with an albedo takes one; else let light go farther "
              "between two of them");
}

void report_many_scatterings(const CompiledScene *compiled, double least, Diag *diag)
{
    ReportGroups groups;
    uint32_t n_found = 0;
    bool grouped = report_groups_init(&groups, compiled);
    for (uint32_t h = 0; grouped && h < compiled->n_hulls; h++) {
        const SceneMedium *medium = &compiled->scene->media[report_object(compiled, h)->medium];
        double volume = compiled->hulls[h].volume;
        if (!medium->scatters || medium->density || !isfinite(volume) || groups.items[groups.of_hull[h]].n > REPORT_FEW)
            continue;
        double squared = index_squared(compiled->scene, medium), from_camera = way_of_cameras(compiled, h, medium);
        double way = mean_chord(volume, &compiled->hull_bounds[h]);
        double n = count_scatterings(medium, fmax(way, from_camera) * squared);
        if (n >= least && ++n_found <= REPORT_MOST) report_many(compiled, h, n, from_camera > way, diag);
    }
    report_rest(diag, D_MANY_SCATTERINGS, n_found);
    report_groups_clear(&groups);
}

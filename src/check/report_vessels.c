/* report_vessels.c - liquids that leave a gap to the opaque vessel that holds them: the film of air is seen, as a mirror.
 * Gaps between clear objects are found when a scene is compiled, as rays need to know how these lie; opaque ones have no part
 * in that.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "check/report_parts.h"
#include "check/sight_line.h"

/* Of the liquid's size: a wider gap is as likely meant. */
static const double widest = 0.03;
/* Of the ends of lines within the liquid, those that are at such a gap at least: more than where a drop nearly touches a table. */
static const double least_part = 0.08;
enum { LEAST_ENDS = 6, LINES = 120 };
/* A vessel is around most of what it holds: a few lines find it, where drops by the thousand are in none. */
enum { FIRST_LINES = 6 };

/* What is known of a liquid and what it is in. */
typedef struct Fit {
    double size;
    uint32_t medium;
    uint32_t n_ends, n_near;
    uint32_t n_held; /* ends within the vessel, or at it: beside these a gap may well begin with nothing */
    double gap;      /* the least that was met */
    uint32_t vessel;
    Vec3 middle; /* of that gap, along the line that met it */
    Vec3 facing; /* the vessel's normal at the first end that was near */
    bool level;  /* it is the same at all of them */
} Fit;

/* What is thin is a skin, and a plane nothing to be filled. */
static bool is_vessel(const Scene *scene, uint32_t object)
{
    return !scene_is_thin(scene, object) && !scene_is_plane(scene, object);
}

static bool has_vessels(const CompiledScene *compiled)
{
    for (uint32_t i = 0; i < compiled->scene->n_objects; i++)
        if (compiled->hull_of_object[i] == SCENE_NONE && is_vessel(compiled->scene, scene_whole(compiled->scene, i)))
            return true;
    return false;
}

/* Liquids that something solid and clear holds, or that it is in. */
static void mark_held(const CompiledScene *compiled, bool *held)
{
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        uint32_t a = compiled->hull_of_object[pair->a], b = compiled->hull_of_object[pair->b];
        if (!pair->overlaps && !pair->touches) continue;
        held[a] |= compiled->hulls[b].state == NEST_SOLID;
        held[b] |= compiled->hulls[a].state == NEST_SOLID;
    }
}

/* From a place within the liquid to its end, and on. false when memory ends. */
static bool look_out(const CompiledScene *compiled, const Ray *ray, Fit *fit)
{
    SightLine line;
    if (sight_line_find(compiled, ray, &line, NULL) != STATUS_OK) return false;
    size_t end = 0;
    while (line.start == fit->medium && end < line.n && line.steps[end].to == fit->medium &&
           line.steps[end].kind != SIGHT_OPAQUE)
        end++;
    if (line.start == fit->medium && end < line.n) {
        const SightStep *step = &line.steps[end], *next = step + 1;
        bool open = step->kind == SIGHT_BOUNDARY && step->to == NEST_WORLD_MEDIUM && end + 1 < line.n;
        double gap = open ? next->distance - step->distance : 0;
        fit->n_ends++;
        fit->n_held += step->kind == SIGHT_OPAQUE && step->object == fit->vessel;
        if (open && next->kind == SIGHT_OPAQUE && gap <= widest * fit->size &&
            is_vessel(compiled->scene, next->object)) {
            Vec3 normal = vec3_from_f(next->normal);
            if (fit->n_near++ == 0) fit->facing = normal;
            fit->level = fit->level && vec3_dot(normal, fit->facing) > 1 - 1e-6;
            if (gap < fit->gap) {
                fit->gap = gap;
                fit->vessel = next->object;
                fit->middle = vec3_along(ray->origin, step->distance + gap / 2, vec3_from_f(ray->direction));
            }
        }
    }
    sight_line_clear(&line);
    return true;
}

/* Lines go through a gap aslant: how wide it is straight across, about. false when memory ends. */
static bool measure_across(const CompiledScene *compiled, Fit *fit)
{
    for (int code = 0; code < 13; code++) { /* half of the directions to the neighbours in a cube of 27 */
        Vec3 axis = vec3_normalize(vec3(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1));
        double sum = 0;
        for (int side = -1; side <= 1; side += 2) {
            Ray ray = ray_make(fit->middle, vec3f_from(vec3_scale(axis, side)));
            SightLine line;
            if (sight_line_find(compiled, &ray, &line, NULL) != STATUS_OK) return false;
            sum += line.n ? line.steps[0].distance : HUGE_VAL;
            sight_line_clear(&line);
        }
        fit->gap = fmin(fit->gap, sum);
    }
    return true;
}

static bool look_at(const CompiledScene *compiled, Probe *probe, uint32_t hull, uint32_t n_lines, Fit *fit)
{
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        line_set_begin(&set, compiled->hull_bounds[hull], direction, n_lines / LINE_DIRECTIONS, hull);
        while (probe_next_line(probe, compiled, &set, hull, &line)) {
            if (probe->out_of_memory) return false;
            uint32_t first = probe->first[hull];
            if (first == INTERVAL_NONE) continue;
            const Interval *in = &probe->intervals[first];
            Vec3 start = vec3_along(line.start, (in->begin + in->end) / 2, vec3_from_f(line.direction));
            for (int side = -1; side <= 1; side += 2) {
                Ray ray = ray_make(start, vec3f_from(vec3_scale(vec3_from_f(line.direction), side)));
                ray.time = line_time(compiled, &line);
                if (!look_out(compiled, &ray, fit)) return false;
            }
        }
    }
    return true;
}

static void report_gap(const CompiledScene *compiled, uint32_t hull, const Fit *fit, Diag *diag)
{
    const Scene *scene = compiled->scene;
    const SceneObject *liquid = report_object(compiled, hull), *vessel = &scene->objects[fit->vessel];
    Buf gap = {0};
    report_add_length(&gap, scene, fit->gap);
    Diagnostic *report =
        diag_report(diag, D_AIR_GAP, liquid->span,
                    "between %s and %s, which is opaque, is a gap of about %s, filled with the world's %s",
                    liquid->name, vessel->name, buf_text(&gap), scene->media[0].name);
    diag_note(diag, report, vessel->span, "%s is here", vessel->name);
    diag_hint(diag, report, "let %s reach into %s: what is inside of an opaque object is not seen", liquid->name,
              vessel->name);
    buf_clear(&gap);
}

/* Whether a liquid leaves a gap. false when memory ends, too. */
static bool find_gap(const CompiledScene *compiled, Probe *probe, uint32_t hull, uint32_t n_lines, Fit *fit)
{
    Box3 box = compiled->hull_bounds[hull];
    *fit = (Fit){.size = vec3_max_abs(vec3_sub(box.max, box.min)),
                 .medium = compiled->hulls[hull].medium,
                 .gap = HUGE_VAL,
                 .vessel = SCENE_NONE,
                 .level = true};
    if (!isfinite(fit->size) || !look_at(compiled, probe, hull, FIRST_LINES, fit) || fit->n_near == 0) return false;
    /* and now that there is a vessel to ask for */
    if (!look_at(compiled, probe, hull, n_lines, fit) || fit->n_held) return false;
    if (fit->n_near < LEAST_ENDS || fit->n_near < least_part * fit->n_ends) return false;
    /* the papers and tables of the library lie a little below what is to stand on them, so that glass does not touch them */
    if (fit->level && compiled->scene->objects[fit->vessel].of_library) return false;
    return measure_across(compiled, fit);
}

/* Where memory ends there is no warning: what needs more will say so. */
void report_vessels(const CompiledScene *compiled, Diag *diag)
{
    Probe probe;
    uint32_t n = 0, n_lines = report_lines_of_each(compiled->n_hulls);
    bool *held = has_vessels(compiled) ? calloc(compiled->n_hulls + 1, sizeof *held) : NULL;
    if (!held) return;
    if (n_lines > LINES) n_lines = LINES;
    mark_held(compiled, held);
    bool good = probe_init(&probe, compiled, NULL) == STATUS_OK;
    for (uint32_t h = 0; good && h < compiled->n_hulls; h++) {
        Fit fit;
        if (compiled->hulls[h].state != NEST_LIQUID || held[h] || !find_gap(compiled, &probe, h, n_lines, &fit))
            continue;
        if (++n <= REPORT_MOST) report_gap(compiled, h, &fit, diag);
    }
    if (n > REPORT_MOST)
        diag_report_nowhere(diag, D_AIR_GAP, "%u more liquids leave gaps to opaque objects",
                            (unsigned)(n - REPORT_MOST));
    probe_clear(&probe);
    free(held);
}

/* report_contact.c - clear solids that stand on opaque ones without a gap: they are in optical contact there, as if glued, which
 * real things that stand on each other hardly ever are.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"

/* A foot may be a small part of what stands on it: where a few lines end at something opaque, many more tell what it is. */
enum { LEAST_ENDS = 6, LINES = 240, MORE_LINES = 3000 };

/* Where lines leave a hull. */
typedef struct Contact {
    uint32_t n; /* at an opaque object's surface */
    uint32_t object;
    bool others; /* than that one, too */
    double area, rounding;
} Contact;

/* One end of a line within a hull; normal: outward, of the hull. area: for what the line stands. */
static void look_at_end(const CompiledScene *compiled, Vec3 place, double time, const Hit *hit, double area,
                        Contact *contact)
{
    SurfacesHere here;
    double cosine = fabs(hit->cos_normal);
    if (!(cosine > 1e-3)) return;
    compiled_surfaces_at(compiled, place, time, &here);
    for (uint32_t i = 0; i < here.n; i++) {
        const RtcSurface *surface = &here.items[i];
        if (!report_is_opaque(compiled, surface->object) || fabsf(vec3f_dot(surface->normal, hit->normal)) < 0.999f)
            continue;
        if (contact->n++ == 0) contact->object = surface->object;
        contact->others |= surface->object != contact->object;
        contact->area += area / cosine / LINE_DIRECTIONS;
        contact->rounding = fmax(contact->rounding, surface->rounding);
        return;
    }
}

static bool find_contact(const CompiledScene *compiled, Probe *probe, uint32_t hull, uint32_t n_lines, Contact *contact)
{
    *contact = (Contact){.object = SCENE_NONE};
    if (!isfinite(vec3_max_abs(vec3_sub(compiled->hull_bounds[hull].max, compiled->hull_bounds[hull].min))))
        return true;
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        line_set_begin(&set, compiled->hull_bounds[hull], direction, n_lines / LINE_DIRECTIONS, hull);
        while (probe_next_line(probe, compiled, &set, hull, &line)) {
            if (probe->out_of_memory) return false;
            Vec3 along = vec3_from_f(line.direction);
            double time = line_time(compiled, &line);
            for (uint32_t i = probe->first[hull]; i != INTERVAL_NONE; i = probe->intervals[i].next) {
                const Interval *in = &probe->intervals[i];
                if (in->enter)
                    look_at_end(compiled, vec3_along(line.start, in->begin, along), time, in->enter, line.area,
                                contact);
                if (in->leave)
                    look_at_end(compiled, vec3_along(line.start, in->end, along), time, in->leave, line.area, contact);
            }
        }
    }
    return true;
}

/* A gap that is told from none and not seen: a ten-thousandth of the object's size, as a power of ten. */
static double good_gap(const CompiledScene *compiled, uint32_t hull, double rounding)
{
    Vec3 sides = vec3_sub(compiled->hull_bounds[hull].max, compiled->hull_bounds[hull].min);
    double wanted = fmax(1e-4 * vec3_max_abs(sides), 10 * rounding) * compiled->scene->unit_m;
    return pow(10, ceil(log10(wanted) - 1e-6)) / compiled->scene->unit_m;
}

/* n: how many hulls the same place in the text is of, this one the first, that touch what another one is of. */
static void report_one(const CompiledScene *compiled, uint32_t hull, const Contact *contact, uint32_t n, Diag *diag)
{
    const SceneObject *object = report_object(compiled, hull), *opaque = &compiled->scene->objects[contact->object];
    Buf area = {0}, gap = {0};
    report_add_area(&area, compiled->scene, contact->area);
    report_add_length(&gap, compiled->scene, good_gap(compiled, hull, contact->rounding));
    Diagnostic *report =
        diag_report(diag, D_OPTICAL_CONTACT, object->span,
                    "%s touches the opaque %s%s over about %s without any air between, as if glued: it "
                    "looks darker there than what only stands on something",
                    object->name, opaque->name, contact->others ? " and others" : "", buf_text(&area));
    if (n > 1) diag_note_nowhere(diag, report, "and so do %u more that this line places", (unsigned)(n - 1));
    diag_note(diag, report, opaque->span, "%s is here", opaque->name);
    diag_hint(diag, report, "leave a gap of, say, %s", buf_text(&gap));
    buf_clear(&area);
    buf_clear(&gap);
}

/* Liquids wet what they touch, and gases have no surface, nor has what mixes. Where memory ends there is no remark. */
void report_contacts(const CompiledScene *compiled, Diag *diag)
{
    Probe probe;
    Contact groups[REPORT_MOST];
    ReportLikes likes = {.n = 0};
    uint32_t n_lines = report_lines_of_each(compiled->n_hulls);
    bool any = false, good = probe_init(&probe, compiled, NULL) == STATUS_OK;
    for (uint32_t i = 0; !any && i < compiled->scene->n_objects; i++) any = report_is_opaque(compiled, i);
    if (n_lines > LINES) n_lines = LINES;
    for (uint32_t h = 0; good && any && h < compiled->n_hulls; h++) {
        Contact contact;
        const NestHull *hull = &compiled->hulls[h];
        if (hull->state == NEST_LIQUID || hull->state == NEST_GAS || hull->mixes) continue;
        good = find_contact(compiled, &probe, h, n_lines, &contact);
        if (good && contact.n > 0 && contact.n < LEAST_ENDS)
            good = find_contact(compiled, &probe, h, MORE_LINES, &contact);
        if (contact.n < LEAST_ENDS) continue;
        uint32_t group =
            report_count_like(&likes, report_object(compiled, h), &compiled->scene->objects[contact.object], h);
        if (group < REPORT_MOST && likes.counts[group] == 1) groups[group] = contact;
    }
    for (uint32_t i = 0; i < likes.n; i++)
        report_one(compiled, (uint32_t)likes.first[i], &groups[i], likes.counts[i], diag);
    if (likes.n_others)
        diag_report_nowhere(diag, D_OPTICAL_CONTACT, "%u more clear objects touch opaque ones",
                            (unsigned)likes.n_others);
    probe_clear(&probe);
}

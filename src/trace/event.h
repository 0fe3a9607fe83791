/* event.h - what a path comes to next, and the lists of hulls in front of that and behind; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EVENT_H
#define MEN_EVENT_H

#include "trace/path_parts.h"

typedef enum EventKind {
    EVENT_LOST,
    EVENT_ESCAPE,
    EVENT_OPAQUE,
    EVENT_BOUNDARY,
    EVENT_SCATTER,
    EVENT_GIVE_UP
} EventKind;

/* What leads to the list behind an event's surfaces. */
typedef enum EventBehind {
    BEHIND_IN_NEXT,  /* it is tracer->next */
    BEHIND_AT_POINT, /* the event's step's point, from tracer->list: hulls are kept as bits */
    BEHIND_BY_STEP   /* the event's step */
} EventBehind;

struct Event {
    EventKind kind;
    Hit hit;          /* the surface to be shaded */
    size_t n_cluster; /* surfaces at that place: tracer->hits[0 .. n) */
    NestCrossing crossing;
    bool clear; /* of the reading of the surfaces there: it does not contradict the list */
    EventBehind behind;
    NestStep step;
    NestPoint before; /* where hulls are kept as bits and some were passed: in front of the surfaces */
    double t;         /* EVENT_SCATTER: how far along the ray, */
    uint32_t medium;  /* and what scatters there; else what fills the way to the surfaces */
};

/* tracer->list becomes the one behind the event's surfaces. */
static inline void path_go_behind(Tracer *tracer, const Event *event)
{
    if (LIKELY(event->behind == BEHIND_AT_POINT))
        tracer->list.point = event->step.point;
    else if (event->behind == BEHIND_BY_STEP)
        nest_step(&tracer->list, &event->step);
    else
        nest_list_swap(&tracer->list, &tracer->next);
}
/* The same list, made in another one. */
static inline Status path_copy_behind(const Tracer *tracer, const Event *event, NestList *list)
{
    if (event->behind == BEHIND_IN_NEXT) return nest_list_copy(list, &tracer->next);
    TRY(nest_list_copy(list, &tracer->list));
    if (event->behind == BEHIND_AT_POINT)
        list->point = event->step.point;
    else
        nest_step(list, &event->step);
    return STATUS_OK;
}

/* tracer->list is the one at a t of the path's ray, up to its next event, until path_turn_back is called; false when memory
 * ends, and then it is as before. Where *t is in the midst of several surfaces at one place, it becomes the end of that. */
bool path_turn_aside(Tracer *tracer, double *t);
void path_turn_back(Tracer *tracer);
/* Crosses the hulls among hits[0 .. n), all at one place. */
bool path_cross(Tracer *tracer, NestList *list, const Hit *hits, size_t n, NestCrossing *crossing);
/* tracer->next becomes the list behind the event's surfaces, from tracer->list on; false when memory ends, which the tracer is told. */
bool path_cross_into_next(Tracer *tracer, const Event *event);
/* Where light has gone straight through a thin sheet, event, that lies in a boundary between media: the event becomes the boundary's.
 * False: the sheet lies in none, or memory ends. */
bool path_passes_into_boundary(Path *path, Event *event);
/* The one of the hits at one place that stands for a boundary there, or for an opaque surface of hulls; before: the list in front. */
const Hit *path_boundary_hit(Tracer *tracer, const NestList *before, const Hit *hits, size_t n,
                             const NestCrossing *crossing);
/* Which of n surfaces at one place is painted, and seen whatever the media are; NULL: none. Paint shows where the point's
 * owner becomes another, even one of the same medium, and not where an operand has no surface of the whole. from, to: the levels
 * before and behind. */
const Hit *path_painted_hit(const World *world, const Hit *hits, size_t n, uint32_t from, uint32_t to);
/* Whether what goes on straight from there is in the medium that it came by: behind a sheet, or paint within one medium. */
static inline bool event_keeps_medium(const Event *event)
{
    return event->kind == EVENT_OPAQUE || event->crossing.medium_from == event->crossing.medium_to;
}
/* Follows the path's ray through silent crossings to its next event. Absorption goes into beta. At a boundary
 * tracer->list is the list before it; event->behind says what leads to the one behind it, and path_go_behind and path_copy_behind
 * make that. */
void path_next_event(Path *path, Event *event);
/* The list of a ray that starts at several surfaces which stand at one place but are not parallel, say where two
 * hulls' surfaces cross: each of them is crossed, or not, by where the ray starts and goes. */
bool path_cross_towards(Tracer *tracer, const Ray *ray, NestList *list);
/* Transmittance of a straight shadow ray from the path's place; false when something blocks it. Opaque
 * objects and visible boundaries block: light that crosses a boundary arrives by paths that are bent there.
 * tracer->shadow_list is then the list at its end. */
bool path_shadow(Path *path, Ray *ray, Lanes *transmittance, uint32_t *medium_at_light);
/* The same to a light's place on an operand's surface (LightSample.slack): false also where a path that comes along the ray would not
 * find the combination's surface there, or find it by another operand's. */
bool path_meets(Path *path, const LightSample *light, Ray *ray, Lanes *transmittance, uint32_t *medium_at_light);

#endif

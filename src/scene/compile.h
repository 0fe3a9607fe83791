/* compile.h - from a scene description to what rays are traced in: Embree geometry and the order of the
 * hulls, with all that was found out about how hulls lie to each other.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_COMPILE_H
#define MEN_COMPILE_H

#include "base/pool.h"
#include "diag/diag.h"
#include "geom/rtc.h"
#include "nest/cross.h"
#include "nest/share.h"
#include "scene/scene.h"

/* How two hulls that meet lie to each other, measured along lines through them. */
typedef struct HullPair {
    uint32_t a, b;               /* objects, a < b */
    bool overlaps;               /* share volume */
    NestRelation relation;       /* when they do */
    double overlap_volume;       /* estimate, cubic scene units */
    double overlap_volume_error; /* its standard error */
    double overlap_depth;        /* of a partial overlap: the largest thickness seen of what they share */
    bool touches;                /* faces at one place, to within rounding */
    double contact_area;         /* of those faces, estimate, square scene units */
    double contact_area_error;   /* its standard error */
    double contact_offset;       /* the largest distance seen between them */
    double gap;      /* the smallest distance across a gap seen between facing surfaces; INFINITY: none near */
    bool wedge;      /* the gap narrows to nothing, as far as lines can tell: the smallest distance is chance, */
    double gap_most; /* and this is the largest one seen that is still thin */
    double gap_area, gap_area_error; /* estimate of the gap's area, and its standard error */
} HullPair;

/* See Ray.pass_level and Ray.pass_alike. */
typedef struct CompiledPassing {
    uint32_t level, alike;
} CompiledPassing;

typedef struct CompiledScene {
    const Scene *scene;
    RtcScene *rtc;
    /* what crossing the object passes: a hull, or an operand of a combination, from n_hulls on; SCENE_NONE for opaque objects */
    uint32_t *hull_of_object;
    uint32_t *object_of_hull;
    NestHull *hulls;
    uint32_t n_hulls;
    Box3 *hull_bounds;  /* in the world; of hulls without end the part in which anything else is */
    Box3 *found_bounds; /* the same; but of combinations around what lines found of them: nearly all, by chance */
    bool *unbounded;    /* of hulls and operands: reach to infinity */
    uint32_t *planes;   /* objects that are half of space */
    uint32_t n_planes;
    HullPair *pairs; /* every pair that meets: overlaps, touches or leaves a small gap */
    size_t n_pairs;
    NestMeeting *meetings; /* hulls that are not known to be apart; for compiled_share_levels, which frees them */
    size_t n_meetings;
    NestOrder order;
    CompiledPassing *passing; /* by what a ray passes where a hull owns its start, or the world: by level */
    NestCsg csg;              /* the combinations, numbered with hulls and operands */
} CompiledScene;

/* The hull that an object is, or is an operand of; SCENE_NONE for what is opaque. */
uint32_t compiled_hull(const CompiledScene *compiled, uint32_t object);
/* How many members of a list do not reach to infinity. */
static inline uint32_t compiled_bounded_in(const CompiledScene *compiled, const NestList *list)
{
    uint32_t n = nest_list_count(list), bounded = n;
    for (uint32_t i = 0; compiled->n_planes && i < n; i++)
        bounded -= compiled->unbounded[nest_item(&compiled->order, list, i)];
    return bounded;
}
/* How many operands of combinations an interior list holds, in front of its hulls. */
uint32_t compiled_operands_in(const CompiledScene *compiled, const NestList *list);

/* Builds geometry and order. Reports go to diag (may be NULL): circles in the order, and cameras that
 * compile_check_camera refuses; these do not make it fail, so look at diag->n_errors. The scene must outlive it. */
ATTR_NODISCARD Status compile_scene(const Scene *scene, NestPolicy policy, Pool *pool, Diag *diag, CompiledScene **out,
                                    Error *error);
void compiled_scene_free(CompiledScene *compiled);
/* An object as geometry. */
RtcObject compiled_describe(const CompiledScene *compiled, uint32_t i);
/* The same scene, with the same numbers of objects and hulls, in which nothing is there but lights and what catches shadows;
 * it shares all else, which must outlive it. NULL where nothing catches them. STATUS_NOMEM. */
ATTR_NODISCARD Status compiled_bare_new(const CompiledScene *compiled, unsigned n_threads, CompiledScene **out,
                                        Error *error);
void compiled_bare_free(CompiledScene *bare);

/* Where there are many hulls, lets those that are apart and of one medium share a level of the order, if lists can keep them
 * as bits then: for renders, which need media, and hulls only where a medium varies or shines. `check` names hulls by
 * their levels, and does without. To be called once. */
ATTR_NODISCARD Status compiled_share_levels(CompiledScene *compiled, Error *error);

/* Media have classes, of which a ray can be said to start in one (Ray.stops): rtc_all then ends at objects that stop
 * light from there for certain. Only the first media have one; the world's is the first. */
enum { COMPILED_STOP_CLASSES = 32 };
static inline uint32_t compiled_stop_class(uint32_t medium)
{
    return medium < COMPILED_STOP_CLASSES ? 1U << medium : 0;
}
/* Whether the indices of two media differ at every wavelength, so that no straight ray of light goes from one into the
 * other. */
bool compiled_indices_differ(const Scene *scene, uint32_t medium_a, uint32_t medium_b);
/* Tells rtc which objects do, and which rays pass by them (compiled_let_pass), by the levels of the order; part of
 * compile_scene. */
ATTR_NODISCARD Status compiled_mark_stops(CompiledScene *compiled, Error *error);
/* Tells a ray that starts where the list holds which surfaces it passes by: those of hulls that rank below the owner there,
 * or are of its medium, as long as it does not leave the owner. To cross them is silent, whatever the list says of them. */
static inline void compiled_let_pass(const CompiledScene *compiled, const NestList *list, Ray *ray)
{
    const CompiledPassing *passing = &compiled->passing[list->point.top.level];
    ray->pass_level = passing->level;
    ray->pass_alike = passing->alike;
}

/* The hulls that hold a point at a time 0..1 of the shutter, found by tracing from outside of the scene to it along one
 * direction, again along another, and a third where they differ: list ends up with the owner last. *on_surface (may be
 * NULL) is set to the object whose surface the point is on (to within rounding), SCENE_NONE when on none. hits is the
 * caller's scratch. */
ATTR_NODISCARD Status compiled_interior(const CompiledScene *compiled, Vec3f point, double time, HitList *hits,
                                        NestList *list, uint32_t *on_surface);

/* The surfaces that a point is on, to within rounding, those of one object that face alike as one; too_many: there are more. */
typedef struct SurfacesHere {
    uint32_t n;
    bool too_many;
    RtcSurface items[6]; /* by the number of the object */
} SurfacesHere;
void compiled_surfaces_at(const CompiledScene *compiled, Vec3 point, double time, SurfacesHere *here);
/* Whether the surfaces here, at a point that the list is of, are all of operands, and none is a surface of its combination. */
ATTR_NODISCARD Status compiled_are_no_surfaces(const CompiledScene *compiled, const NestList *list,
                                               const SurfacesHere *here, bool *result);
/* Ends a report of what is on a surface: where that is, and by how much to move off it. */
void compiled_advise_off_surface(const CompiledScene *compiled, const RtcSurface *surface, Diagnostic *report,
                                 Diag *diag);

/* The hulls that hold a camera's centre, and the surface (may be NULL) that it is on, as by compiled_interior. A camera that
 * stands on the surface of an operand where its combination has none is moved off that, by some roundings, so that its rays
 * have it on one side. STATUS_NOMEM. */
ATTR_NODISCARD Status compiled_stand(const CompiledScene *compiled, SceneCamera *camera, NestList *list,
                                     uint32_t *on_surface, Error *error);
/* Reports a camera that is on a surface, or in other media than its `expect` says; STATUS_SCENE after that. */
ATTR_NODISCARD Status compile_check_camera(const CompiledScene *compiled, uint32_t camera, Diag *diag, Error *error);
/* Warns of lights that are on a surface of a clear object: without size, so that rounding decides on which side, or flat and in a
 * face that they shine into, which counts as inside; and of two lamps at one place, of which one hides the other. STATUS_NOMEM. */
ATTR_NODISCARD Status compile_check_lights(const CompiledScene *compiled, Diag *diag, Error *error);

#endif

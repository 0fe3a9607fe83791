/* rtc.h - the scene as Embree geometry, and the two questions that a renderer asks of it: which surfaces
 * stand nearest along a ray, and which stand anywhere along it.
 *
 * Embree proposes, double precision decides. Embree works in float and finds every triangle near the ray
 * (robust mode); whether a triangle is in front of the ray's start, how far it is and which way it is
 * crossed are then computed from the triangle's vertices in double, and within rounding of an edge which of its neighbours
 * the exact ray meets (rtc_edge.c). Analytic pieces are double throughout. A ray's
 * origin is double, too, and is the very point where the ray before it ended: nothing is moved off a surface. What
 * must not be hit again is known by its identity, the surfaces that the ray starts on. So there is no epsilon that
 * could lose a surface, and none that could jump over another one.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RTC_H
#define MEN_RTC_H

#include <stdint.h>

#include "base/status.h"
#include "base/vec3.h"
#include "mesh/mesh.h"
#include "shape/piece.h"

#define RTC_NO_OBJECT UINT32_MAX
#define RTC_NO_PASS UINT32_MAX

typedef struct RtcScene RtcScene;

/* One object of the scene: a mesh or a solid, placed. Meshes placed more than once (the same pointer) share their
 * geometry as Embree instances; a mesh placed once, or small, is baked. Neither mesh nor solid is owned; both
 * must live as long as the scene. */
typedef struct RtcObject {
    const Mesh *mesh;   /* or NULL */
    const Solid *solid; /* or NULL */
    Affine to_world;    /* of one that moves: at time 0 */
    const Affine *
        keys; /* NULL, or where it is at evenly spread times from 0 to 1: as many as rtc_scene_new is told; not owned */
    const Mesh *mesh_end; /* NULL, or the same triangles with the positions and normals at time 1; linear in between */
    bool hidden;          /* a ray with sight passes by it as if it were not there; of solids */
    bool opaque;          /* nothing is seen through it: a search for all surfaces along a ray may stop at it */
} RtcObject;

/* The objects keep their numbers. n_keys: of the objects that move, 2 .. RTC_MOST_KEYS, or 0 when none does. STATUS_SCENE
 * when a transform is singular at one of its times, or mirrors at one and not at another; STATUS_NOMEM. */
enum { RTC_MOST_KEYS = 129 };
ATTR_NODISCARD Status rtc_scene_new(const RtcObject *objects, uint32_t n_objects, uint32_t n_keys, unsigned n_threads,
                                    RtcScene **scene, Error *error);
/* The same where a list of all objects would cost too much: describe tells object number i, whenever it is asked. */
typedef RtcObject RtcDescribe(const void *context, uint32_t i);
ATTR_NODISCARD Status rtc_scene_new_from(RtcDescribe *describe, const void *context, uint32_t n_objects,
                                         uint32_t n_keys, unsigned n_threads, RtcScene **scene, Error *error);
void rtc_scene_free(RtcScene *scene);
/* The classes of straight rays that an object which is not opaque stops as well, whatever is on their way; see Ray.stops.
 * None unless set; not while rays are traced. */
void rtc_set_stops(RtcScene *scene, uint32_t object, uint32_t classes);
/* Which rays pass by an object; see Ray.pass_level and Ray.pass_alike. RTC_NO_PASS and RTC_NO_PASS unless set: none does. Not
 * while rays are traced. */
void rtc_set_passing(RtcScene *scene, uint32_t object, uint32_t level, uint32_t alike);
/* Around everything but unbounded planes; empty for an empty scene. */
Box3 rtc_scene_bounds(const RtcScene *scene);
/* Whether the object is a plane without end, which divides space: rays that stay on one side never tell which it is. */
bool rtc_is_plane(const RtcScene *scene, uint32_t object);
/* Whether a point is on the side of such an object that its normal does not point to. */
bool rtc_below_plane(const RtcScene *scene, uint32_t object, Vec3 point, double time);
/* Bytes that Embree holds for geometry and hierarchy. */
size_t rtc_scene_bytes(const RtcScene *scene);
/* "Embree 3.13.5 (isa ...)", for `version` and reports */
const char *rtc_library_version(void);

typedef struct Hit Hit;

/* A ray. One that starts at a surface is made by rtc_leave. */
typedef struct Ray {
    Vec3 origin;
    Vec3f direction;     /* unit to float precision */
    double time;         /* 0..1, of what moves */
    double t_min, t_max; /* surfaces at t_min < t <= t_max; t_min >= 0 */
    uint32_t target;     /* rtc_all: this object does not count, as it is what the ray is aimed at; RTC_NO_OBJECT */
    uint32_t target_primitive; /* of it only this primitive does not; RTC_NO_OBJECT: none of them */
    uint32_t pass_level;       /* rtc_nearest: objects of a lower level than this do not end the search, */
    uint32_t pass_alike;       /* nor do those of a higher one that are alike in this; RTC_NO_PASS: none are */
    uint32_t stops;  /* rtc_all with stop_at_opaque: ends at objects of these classes, too, but at ones it starts on */
    const Hit *left; /* the surfaces that the ray starts on, crossed already or turned away from; not owned */
    size_t n_left;
    /* the coordinates and lengths that the origin was computed from: its rounding is 2^-52 of them */
    double start_scale;
    Vec3 nudge;        /* a step of the origin's rounding from there to the side that the ray is on */
    float grain;       /* the largest coordinate of the triangles near the origin; 0: not known */
    float least_slope; /* the least cosine to a surface that it starts on; INFINITY: to none */
    bool sight;        /* rtc_nearest: it comes straight from a camera, to which some objects are hidden */
    bool at_edge;      /* the place at t_min, or an earlier one of its line, is within rounding of a triangle's edge, or
                              * of a surface that the ray before started on: Embree may miss what is there */
} Ray;

/* A ray that starts in free space. Set field by field: a whole one would be made aside and copied. */
static inline void ray_begin(Ray *ray, Vec3 origin, Vec3f direction)
{
    ray->origin = origin;
    ray->direction = direction;
    ray->time = ray->t_min = 0;
    ray->t_max = HUGE_VAL;
    ray->target = ray->target_primitive = RTC_NO_OBJECT;
    ray->pass_level = 0;
    ray->pass_alike = RTC_NO_PASS;
    ray->stops = 0;
    ray->left = NULL;
    ray->n_left = 0;
    ray->start_scale = 0;
    ray->nudge = vec3(0, 0, 0);
    ray->grain = 0;
    ray->least_slope = INFINITY;
    ray->sight = ray->at_edge = false;
}
static inline Ray ray_make(Vec3 origin, Vec3f direction)
{
    Ray ray;
    ray_begin(&ray, origin, direction);
    return ray;
}
static inline Vec3 ray_point(const Ray *ray, double t)
{
    return vec3_along(ray->origin, t, vec3_from_f(ray->direction));
}

/* One surface met by a ray. */
struct Hit {
    double t;
    uint32_t object;
    uint32_t primitive; /* triangle (see rtc_n_primitives), or piece of the solid */
    bool entering;      /* the ray goes against the geometric normal, into the object */
    Vec3f normal;       /* geometric, unit, outward (not turned towards the ray) */
    double cos_normal;  /* direction . normal, in double */
    double rounding;    /* what the coordinates hereabouts can be off by; see rtc_rounding */
    float u, v;         /* barycentric of the triangle; unused for pieces */
    bool inside,
        behind;  /* set by rtc_leave: whether the new ray starts inside of this hit's object, and whether it goes away
                            * from the surface there, and comes no more to one that is flat */
    bool smooth; /* the shading normal may be another than this one */
    bool clear;  /* so far from the triangle's edges that no rounding of float reaches them; true of pieces */
    float grain; /* the largest coordinate of the triangles near it; 0: not known */
};

/* A growing list of hits, one per worker, reused from ray to ray. */
typedef struct HitList {
    Hit *items;
    size_t n, capacity;
    bool out_of_memory;
    /* of rtc_nearest: the ray starts within rounding of an edge of an object that it does not start on; see rtc_beside */
    bool beside;
} HitList;
void hit_list_clear(HitList *list); /* frees */
/* False when memory ends. */
bool hit_list_copy(HitList *list, const Hit *hits, size_t n);

/* All surfaces that stand at the nearest distance, in increasing t: the first, and every further one that
 * is nearer to the one before it than the rounding of coordinates can tell (along the normal; see
 * rtc_rounding). Returns the number, 0 when the ray leaves the scene.
 * Surfaces that the ray passes by (pass_level, pass_alike) do not count. Those in front of the place go to `passed`, in
 * increasing t: what searches that stop at each of them, one after another, would have found. One that stands at the place
 * itself is among the hits. passed may be NULL for a ray that passes by nothing. */
size_t rtc_nearest(const RtcScene *scene, const Ray *ray, HitList *hits, HitList *passed);

/* Sends a ray on along its line, behind n >= 1 hits at one place. */
static inline void rtc_pass_on(Ray *ray, const Hit *hits, size_t n)
{
    ray->t_min = hits[n - 1].t;
    for (size_t i = 0; i < n; i++) ray->at_edge = ray->at_edge || !hits[i].clear;
}

/* The objects within rounding of whose triangles a ray starts, or so near to whose pieces that double does not tell, other than
 * those that it starts on clear of all edges; of these hits no more than the object is set, and whether the ray is inside of it
 * from its start on: as the first of the object's surfaces says that it comes to (along: a list to find them in). The ray before,
 * as Embree traced it, may have missed a sliver of such an object which the exact one comes into just there; or it has turned in a
 * corner so narrow that this start is on the wrong side of the piece which it turned at before. */
size_t rtc_beside(const RtcScene *scene, const Ray *ray, HitList *beside, HitList *along);

/* Where hits contradict what is known: the first surface before `end` by which the ray enters (leaves) an object, as all of its
 * triangles along the ray are asked in double; it becomes the only one in the list. Embree may miss one at whose corner or
 * silhouette the ray is aimed, or along which it runs. False, and the list as it was, where there is none, and for objects that
 * are not meshes. */
bool rtc_find_missed(const RtcScene *scene, const Ray *ray, uint32_t object, bool entering, double end,
                     HitList *missed);

/* Puts one hit more into a list, in its place. False when memory ends. */
bool rtc_add_hit(HitList *hits, const Hit *more);

/* How many of n >= 1 hits in increasing t stand at one place with the first. */
size_t rtc_cluster(const Hit *hits, size_t n);

/* Every surface along the ray in increasing t. With stop_at_opaque the search ends as soon as any opaque object, or
 * another that stops the ray, is found in the way, wherever: it returns false and the list holds nothing of use.
 * Otherwise true. */
bool rtc_all(const RtcScene *scene, const Ray *ray, bool stop_at_opaque, HitList *hits);

/* Whether no surface comes into a ball. False is said more often than it is true: of turned and of stretched pieces boxes count; and
 * always where anything moves. */
bool rtc_is_away(const RtcScene *scene, Vec3 centre, double radius);

/* A surface that a place is on: no farther from it than numbers tell apart there. */
typedef struct RtcSurface {
    uint32_t object;
    Vec3f normal;    /* geometric, unit, outward */
    double distance; /* 0 of a piece where double cannot tell the place from the surface */
    double rounding; /* >= distance: what numbers tell apart there, of the place and of the surface */
} RtcSurface;
/* Tells of all surfaces that a place is on, of some more than once, in any order. For single places: planes and the pieces of
 * scenes of few are all asked. */
typedef void RtcFound(void *context, const RtcSurface *surface);
void rtc_surfaces_at(const RtcScene *scene, Vec3 place, double time, RtcFound *found, void *context);

/* The distance that the coordinates of a point can be off by rounding: four units in the last place of its
 * largest coordinate in float. Surfaces nearer to each other than this stand at one place. 0 at the origin, where what is told
 * apart is up to the coordinates of what stands there. */
#define RTC_ROUNDING 0x1p-21
static inline double rtc_rounding(Vec3 p)
{
    return RTC_ROUNDING * vec3_max_abs(p);
}

/* The shading normal: unit, outward; on the geometric normal's side. It is that one deep in a wedge between surfaces.
 * rtc_smooth_normal: of a hit that is smooth. */
Vec3f rtc_smooth_normal(const RtcScene *scene, const Ray *ray, const Hit *hit);
static inline Vec3f rtc_shading_normal(const RtcScene *scene, const Ray *ray, const Hit *hit)
{
    return hit->smooth ? rtc_smooth_normal(scene, ray, hit) : hit->normal;
}

/* How far the curved surface that interpolated normals describe stands out over the one that was met, towards the side that the
 * ray comes from and along `up`, a unit vector on that side. [Hanika21]: the place is projected on the planes that touch the curved
 * surface at the corners of the triangle (at the ends of the band), where it is below them, and these points are interpolated as
 * the normals are. That is twice as high as a surface of even curvature is; this is half of it. 0 where the curved surface is
 * hollow, and of a hit that is not smooth. */
double rtc_bulge(const RtcScene *scene, const Ray *ray, const Hit *hit, Vec3f up);

/* Where on its object a surface was met, for textures: in the object's own frame, where it stays while the object moves or
 * its mesh deforms. */
typedef struct RtcCoordinates {
    Vec3 local;      /* of a mesh: as at time 0 */
    Affine to_local; /* at the ray's time */
    bool has_uv;     /* false: a mesh without any */
    float uv[2];     /* the mesh's, or PieceRoot's */
    Vec3 du, dv;     /* their gradients along the surface, in the object's frame; zero where there are none */
} RtcCoordinates;
/* with_uv: false leaves out all that is about u and v. */
void rtc_coordinates(const RtcScene *scene, const Ray *ray, const Hit *hit, bool with_uv, RtcCoordinates *coordinates);

/* How many primitives an object has: pieces of its solid, or triangles of its mesh. Those are in pairs, not in the mesh's
 * order; where one of a pair is missing, a triangle without area counts instead. */
uint32_t rtc_n_primitives(const RtcScene *scene, uint32_t object);
/* The corners of a mesh object's triangle in the world, as rays meet it: counter-clockwise seen from outside. */
void rtc_triangle(const RtcScene *scene, uint32_t object, uint32_t primitive, double time, Vec3 corner[3]);

/* A new ray in the given direction from the place where ray met the cluster hits[0 .. *n-1] (*n >= 1): from its far side
 * (through) or from the side that ray came from. Of several hits of one object only the last (first) is kept, and those of
 * triangles that have that very point in common, at an edge (hits and *n change); hits must live as long as the new ray. The
 * origin is the exact point of the last (first) surface. hits[i].inside says for each surface on which side of it the ray starts:
 * by the order along the ray before, and by the direction where the origin is on the surface itself; at an edge, for all of an
 * object's triangles alike, whether it starts inside of that. The new ray may take the old one's place: next == ray. */
void rtc_leave(const RtcScene *scene, const Ray *ray, Hit *hits, size_t *n, bool through, Vec3f direction, Ray *next);

#endif

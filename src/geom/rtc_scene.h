/* rtc_scene.h - what rtc_build.c makes and rtc.c traces; private to src/geom/rtc*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RTC_SCENE_H
#define MEN_RTC_SCENE_H

#include <stdatomic.h>

#include "base/lanes.h"
#include "geom/embree.h"
#include "geom/rtc.h"
#include "geom/rtc_grain.h"
#include "mesh/quads.h"

/* Two triangles, and all that is read of them when one is met: a line of memory. */
typedef struct RtcQuad {
    Vec3f corner[4]; /* in the world's frame where the mesh is baked, else in its own, at time 0 */
    MeshQuad vertex; /* their numbers */
} RtcQuad;

/* A mesh as Embree has it, wherever it is placed: as quads, for a search takes two triangles at once in the time of one.
 * Primitive 2 * q + h of its objects is triangle h of quad q. */
typedef struct RtcMesh {
    const Mesh *source, *end; /* end: NULL for one whose shape stays */
    RtcQuad *quads;           /* aligned; turned round where the mesh is baked and the transform mirrors */
    uint32_t n_quads;
    bool baked;               /* placed once, or small: it is traced in the world's frame, not as an instance */
    Vec3f *moved;             /* the vertices in the world's frame where it is baked; NULL where the source's are there */
} RtcMesh;

typedef struct RtcMaps {
    Affine to_world, to_local; /* at time 0 */
} RtcMaps;

/* Whether anything else reaches into an object; see rtc_lone.c. */
enum { RTC_NOT_LONE, RTC_PERHAPS_LONE, RTC_LONE };

/* One object, ready for tracing. There may be tens of millions: most are balls and instances that are only moved. */
typedef struct RtcPlaced {
    Vec3 place;
    double scale;        /* > 0; of a ball under a map of its own: that map's */
    const Solid *solid;
    bool opaque;
    bool ball;           /* of one piece, a sphere, that is always moved, turned and made larger evenly */
    bool mirrored;       /* the transform turns orientation round (instances: normals must be turned too) */
    atomic_uchar lone;   /* RTC_NOT_LONE and others */
    uint32_t stops;      /* the classes of rays that it stops, opaque or not */
    uint32_t pass_level, pass_alike; /* see Ray.pass_level */
    float reach;         /* not less than the largest coordinate of its mesh, wherever it moves; 0: it has none */
    uint32_t frame;      /* objects in a row that stand in one frame have the number of the first of them; of a mesh that may
                          * be lone its place in RtcScene.convex */
    const RtcMesh *mesh;
    const Affine *keys;  /* NULL for one that stands still; not owned */
    const RtcMaps *maps; /* NULL where it is moved and made larger evenly, by place and scale */
} RtcPlaced;

/* A ball in the world. */
typedef struct RtcBall {
    Vec3 centre;
    double radius;
} RtcBall;

/* A piece of a solid: all that a ray has to know that does not meet it, for of many little is in the cache. */
typedef struct RtcPiece {
    uint32_t object, piece; /* piece: RTC_BALL of an object that is a ball, and stands still */
    union {
        RtcBall ball;
        struct {
            const Piece *shape;
            uint32_t frame;   /* the object's */
            bool moving_ball; /* the object is a ball that moves */
        };
    };
} RtcPiece;
#define RTC_BALL UINT32_MAX
enum { RTC_SECTORS = 8, RTC_ALL_SECTORS = 8 };

/* A plane without end. Every ray is held against it, by no more than this where it stands still. */
typedef struct RtcPlane {
    uint32_t object;
    bool moves;
    Vec3 up, place; /* in the world: local y is up . (p - place) */
} RtcPlane;

/* Which eighth a point of the local frame is in: exactly one, by comparisons alone. */
static inline uint32_t rtc_sector(double x, double z)
{
    uint32_t quadrant = x >= 0 ? (z >= 0 ? 0 : 3) : (z >= 0 ? 1 : 2);
    return 2 * quadrant + (fabs(z) >= fabs(x));
}

/* The pieces of all solids that stand still, or of all that move: Embree's user geometry has one number of keys. Its primitives
 * are pieces, or eighths of them. Hollow ones are cut into eighths so that the boxes around them are hollow, too: a ray down
 * through a glass would else be tested against every band that it passes inside of. */
typedef struct RtcPieceSet {
    struct RtcScene *scene;
    RtcPiece *pieces;
    uint32_t first;          /* the place of the first of them in RtcScene.pieces */
    uint32_t n_whole, n_cut; /* those that are one primitive each, and behind them those that are eight */
    bool moving;
} RtcPieceSet;

/* What a primitive of the user geometry is. */
typedef struct RtcPart {
    uint32_t number, sector; /* of the piece in the set; 0 .. 7 about the axis, or RTC_ALL_SECTORS */
} RtcPart;
static inline RtcPart rtc_part(const RtcPieceSet *set, uint32_t primitive)
{
    if (primitive < set->n_whole) return (RtcPart){primitive, RTC_ALL_SECTORS};
    uint32_t eighth = primitive - set->n_whole;
    return (RtcPart){set->n_whole + eighth / RTC_SECTORS, eighth % RTC_SECTORS};
}
static inline uint32_t rtc_n_parts(const RtcPieceSet *set)
{
    return set->n_whole + RTC_SECTORS * set->n_cut;
}

/* The bounds of four pieces. */
typedef struct RtcFour {
    Lanes lower[3], upper[3];
} RtcFour;
/* So few pieces, a lamp over meshes, say, are not worth a hierarchy of their own, which every ray would have to go
 * through: rays are held against all their bounds. */
enum { RTC_FEW = 2 * LANES };
/* The bounds of one piece, without end in the last lane; where there are so few, that is quicker than four at once. */
typedef struct RtcOne {
    Lanes lower, upper;
} RtcOne;
enum { RTC_ALONE = 2 };

struct RtcScene {
    RTCDevice device;
    RTCScene world;
    RtcMesh *meshes;
    uint32_t n_meshes;
    _Atomic(struct RtcConvex *) *convex; /* of the mesh objects that may be lone, those that are known to be; see rtc_lone.c */
    uint32_t n_convex;
    RTCScene *shared; /* the scenes of meshes that are placed more than once */
    uint32_t n_shared;
    RtcPlaced *objects;
    uint32_t n_objects;
    RtcMaps *maps; /* of the objects that have them */
    uint32_t n_keys;
    RtcPiece *pieces;          /* of the two sets */
    RtcPieceSet still, moving; /* bounded ones */
    uint32_t n_few;            /* of the still ones, all if they are few, which Embree then does not know; else 0 */
    RtcFour few[RTC_FEW / LANES];
    RtcOne alone[RTC_ALONE]; /* the same bounds, where they are no more */
    RtcPlane *planes;          /* tested by themselves */
    uint32_t n_planes;
    Box3 bounds;
    double reach; /* the largest coordinate of the bounds */
    RtcGrain grain;
    atomic_llong bytes;
    Error error; /* the first that Embree reported */
};

/* The maps at time 0. The numbers of an even one are those that affine_invert gives. */
static inline Affine rtc_first_to_world(const RtcPlaced *object)
{
    if (object->maps) return object->maps->to_world;
    double s = object->scale;
    return (Affine){{{s, 0, 0}, {0, s, 0}, {0, 0, s}}, object->place};
}
static inline Affine rtc_first_to_local(const RtcPlaced *object)
{
    if (object->maps) return object->maps->to_local;
    double s = object->scale, i = s * s / (s * (s * s));
    Affine map = {{{i, 0, 0}, {0, i, 0}, {0, 0, i}}, {0, 0, 0}};
    map.t = vec3_scale(affine_vector(&map, object->place), -1);
    return map;
}

/* The numbers of the vertices of a mesh's primitive, counter-clockwise seen from outside where the mesh is baked. */
static inline void rtc_triangle_of(const RtcMesh *mesh, uint32_t primitive, uint32_t vertices[3])
{
    mesh_quad_triangle(mesh->quads[primitive / 2].vertex, primitive % 2, vertices);
}

/* Where a placed object is. */
static inline Affine rtc_to_world(const RtcScene *scene, const RtcPlaced *object, double time)
{
    const Affine *keys = object->keys;
    return keys ? affine_between(keys, scene->n_keys, time) : rtc_first_to_world(object);
}
static inline Affine rtc_to_local(const RtcScene *scene, const RtcPlaced *object, double time)
{
    if (!object->keys) return rtc_first_to_local(object);
    Affine map = affine_between(object->keys, scene->n_keys, time), inverse;
    return affine_invert(&map, &inverse) ? inverse : rtc_first_to_local(object); /* singular between two keys that are not */
}

/* Where an object is that is a ball. */
static inline Vec3 rtc_ball_centre(const RtcScene *scene, const RtcPlaced *object, double time)
{
    return object->keys ? affine_between(object->keys, scene->n_keys, time).t : object->place;
}
static inline RtcBall rtc_ball(const RtcScene *scene, const RtcPlaced *object, double time)
{
    double radius = object->solid->pieces[0].r0;
    if (!object->keys) return (RtcBall){object->place, object->scale * radius};
    Affine to_world = affine_between(object->keys, scene->n_keys, time);
    return (RtcBall){to_world.t, to_world.m[0][0] * radius};
}

/* The callbacks of rtc.c that rtc_build.c hands to Embree. */
void rtc_filter_nearest(const struct RTCFilterFunctionNArguments *arguments);
void rtc_filter_any(const struct RTCFilterFunctionNArguments *arguments);
void rtc_piece_bounds(const struct RTCBoundsFunctionArguments *arguments);
void rtc_piece_intersect(const struct RTCIntersectFunctionNArguments *arguments);
void rtc_piece_occluded(const struct RTCOccludedFunctionNArguments *arguments);

#endif

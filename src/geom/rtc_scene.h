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
    bool baked;   /* placed once, or small: it is traced in the world's frame, not as an instance */
    Vec3f *moved; /* the vertices in the world's frame where it is baked; NULL where the source's are there */
    _Atomic(struct RtcBoxes *) boxes; /* NULL: not asked for; see rtc_boxes.h */
} RtcMesh;

typedef struct RtcMaps {
    Affine to_world, to_local; /* at time 0 */
    double rounding; /* how many times what float rounds of coordinates is off that go into the frame and back */
} RtcMaps;

/* Whether anything else reaches into an object; see rtc_lone.c. */
enum { RTC_NOT_LONE, RTC_PERHAPS_LONE, RTC_LONE };

/* One object, ready for tracing, in one line of memory: there may be tens of millions, most of them balls and instances that
 * are only moved, of which a ray is to read no more than that. */
typedef struct RtcPlaced {
    Vec3 place; /* of the origin of its frame, at time 0 */
    union {
        const RtcMaps *maps; /* of one that is mapped */
        const Affine *keys;  /* of one that moves, as many as RtcScene.n_keys; not owned */
        double scale;        /* > 0; of all others */
    };
    union {
        const Solid *solid;  /* NULL for a combination, whose operands have the surfaces */
        const RtcMesh *mesh; /* of one that is a mesh */
    };
    union {
        double radius; /* of a ball that stands still */
        struct {
            /* objects in a row that stand in one frame have the number of the first of them; of a mesh that may be lone its
             * place in RtcScene.convex */
            uint32_t frame;
            /* of a mesh: not less than the coordinates that float rounds where it is met, but for the place's */
            float grain;
        };
    };
    uint32_t stops;                  /* the classes of rays that it stops, opaque or not */
    uint32_t pass_level, pass_alike; /* see Ray.pass_level */
    bool opaque : 1;
    bool hidden : 1;
    bool mirrored : 1; /* the transform turns orientation round (instances: normals must be turned too) */
    bool is_mesh : 1;
    bool moves : 1;
    bool mapped : 1;   /* it stands still, and more is done to it than moving it and making it larger evenly */
    bool ball : 1;     /* of one piece, a sphere, that is always moved, turned and made larger evenly */
    atomic_uchar lone; /* RTC_NOT_LONE and others */
} RtcPlaced;
enum { RTC_LINE = 64 };
_Static_assert(sizeof(RtcPlaced) <= RTC_LINE, "an object is one line of memory");

/* A piece of a solid that is no ball: all that a ray has to know that does not meet it, for of many little is in the cache. */
typedef struct RtcPiece {
    uint32_t object, piece;
    const Piece *shape;
    uint32_t frame; /* the object's */
} RtcPiece;
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
    uint32_t *balls; /* the objects that are balls, which are met without frames */
    RtcPiece *pieces;
    uint32_t first; /* the place of the first of them in RtcScene.pieces */
    uint32_t n_balls, n_whole,
        n_cut; /* primitives are the balls, behind them the pieces that are one each, and behind them
                                       * those that are eight */
    bool moving;
} RtcPieceSet;

/* What a primitive of the user geometry is that is no ball. */
typedef struct RtcPart {
    uint32_t number, sector; /* of the piece in the set; 0 .. 7 about the axis, or RTC_ALL_SECTORS */
} RtcPart;
static inline RtcPart rtc_part(const RtcPieceSet *set, uint32_t primitive)
{
    uint32_t place = primitive - set->n_balls;
    if (place < set->n_whole) return (RtcPart){place, RTC_ALL_SECTORS};
    uint32_t eighth = place - set->n_whole;
    return (RtcPart){set->n_whole + eighth / RTC_SECTORS, eighth % RTC_SECTORS};
}
static inline uint32_t rtc_n_parts(const RtcPieceSet *set)
{
    return set->n_balls + set->n_whole + RTC_SECTORS * set->n_cut;
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
    bool has_hidden; /* some objects are hidden to cameras */
    RtcMesh *meshes;
    uint32_t n_meshes;
    _Atomic(struct RtcConvex *)
        *convex; /* of the mesh objects that may be lone, those that are known to be; see rtc_lone.c */
    uint32_t n_convex;
    RTCScene *shared; /* the scenes of meshes that are placed more than once */
    uint32_t n_shared;
    RtcPlaced *objects;
    uint32_t n_objects;
    RtcMaps *maps; /* of the objects that have them */
    uint32_t n_keys;
    uint32_t *balls;           /* of the two sets */
    RtcPiece *pieces;          /* of the two sets */
    RtcPieceSet still, moving; /* bounded ones */
    uint32_t n_few;            /* of the still ones, all if they are few, which Embree then does not know; else 0 */
    RtcFour few[RTC_FEW / LANES];
    RtcOne alone[RTC_ALONE]; /* the same bounds, where they are no more */
    RtcPlane *planes;        /* tested by themselves */
    uint32_t n_planes;
    Box3 bounds;
    double reach; /* the largest coordinate of the bounds */
    /* the coordinate to which the boxes of pieces are made, and those of farther ones to their own */
    double piece_reach;
    RtcGrain grain;
    atomic_llong bytes;
    Error error; /* the first that Embree reported */
};

/* The maps at time 0. The numbers of an even one are those that affine_invert gives. */
static inline Affine rtc_first_to_world(const RtcPlaced *object)
{
    if (object->moves) return object->keys[0];
    if (object->mapped) return object->maps->to_world;
    double s = object->scale;
    return (Affine){{{s, 0, 0}, {0, s, 0}, {0, 0, s}}, object->place};
}
/* Of an object that stands still. */
static inline Affine rtc_still_to_local(const RtcPlaced *object)
{
    if (object->mapped) return object->maps->to_local;
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

/* The vertices of a mesh where Embree has them: in the world's frame if it is baked. */
static inline const Vec3f *rtc_positions(const RtcMesh *mesh)
{
    return mesh->moved ? mesh->moved : mesh->source->positions;
}

/* Where a placed object is. */
static inline Affine rtc_to_world(const RtcScene *scene, const RtcPlaced *object, double time)
{
    return object->moves ? affine_between(object->keys, scene->n_keys, time) : rtc_first_to_world(object);
}
static inline Affine rtc_to_local(const RtcScene *scene, const RtcPlaced *object, double time)
{
    if (!object->moves) return rtc_still_to_local(object);
    Affine map = affine_between(object->keys, scene->n_keys, time), inverse;
    if (affine_invert(&map, &inverse) || affine_invert(&object->keys[0], &inverse)) return inverse;
    return affine_identity(); /* not come to: it is singular between two keys, and not at them */
}

/* Where an object is that is a ball. */
static inline Vec3 rtc_ball_centre(const RtcScene *scene, const RtcPlaced *object, double time)
{
    return UNLIKELY(object->moves) ? affine_between(object->keys, scene->n_keys, time).t : object->place;
}
static inline Ball rtc_ball(const RtcScene *scene, const RtcPlaced *object, double time)
{
    if (LIKELY(!object->moves)) return (Ball){object->place, object->radius};
    Affine to_world = affine_between(object->keys, scene->n_keys, time);
    return (Ball){to_world.t, to_world.m[0][0] * object->solid->pieces[0].r0};
}

/* Finds how large the coordinates are, of the scene and from place to place: reach, piece_reach and grain; once all meshes are
 * there. */
void rtc_find_reach(RtcScene *scene);
/* What piece_reach is, by the scene's reach and what the sizes of pieces are on the whole. */
double rtc_piece_reach(double reach, double size);

/* The callbacks of rtc.c that rtc_build.c hands to Embree. */
void rtc_filter_nearest(const struct RTCFilterFunctionNArguments *arguments);
void rtc_filter_any(const struct RTCFilterFunctionNArguments *arguments);
void rtc_piece_bounds(const struct RTCBoundsFunctionArguments *arguments);
void rtc_piece_intersect(const struct RTCIntersectFunctionNArguments *arguments);
void rtc_piece_occluded(const struct RTCOccludedFunctionNArguments *arguments);

#endif

/* scene.h - the scene description: what is where, of what, and how it is looked at. Immutable once built.
 * It knows nothing of the language's text but the places (spans) that messages point at, so that another
 * front end could write it. Lengths are in scene units throughout (absorption per scene unit), angles here in radians.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SCENE_H
#define MEN_SCENE_H

#include <string.h>

#include "base/arena.h"
#include "base/exposure.h"
#include "base/hash.h"
#include "diag/source.h"
#include "mesh/mesh.h"
#include "shape/piece.h"
#include "nest/csg.h"
#include "nest/order.h"
#include "optics/bsdf_spec.h"
#include "optics/phase.h"
#include "optics/spectrum.h"
#include "optics/surface_texture.h"
#include "optics/texture.h"
#include "optics/volume.h"
#include "scene/aov.h"
#include "scene/light_groups.h"
#include "scene/scene_light.h"

#define SCENE_NONE UINT32_MAX
/* The wavelength of the one index that stands for a medium's where only one can: the middle of sodium's yellow lines. */
#define SCENE_INDEX_NM 589.3f

typedef struct SceneMedium {
    const char *name;
    Span span;
    Spectrum ior;                      /* of a crystal, that of its ordinary waves; */
    Spectrum extraordinary;            /* and the principal one of the others, see optics/crystal.h */
    Vec3 optic_axis;                   /* unit, in the world where it is an object's */
    Spectrum absorption;               /* per scene unit; of a crystal, of light that swings across its axis, */
    Spectrum extraordinary_absorption; /* and along it */
    Spectrum scattering;               /* per scene unit */
    Phase phase;
    bool absorbs;              /* absorption is not zero */
    bool scatters;             /* scattering is not zero */
    bool disperses;            /* an index depends on the wavelength */
    bool refracts_doubly;      /* its two indices differ */
    bool pleochroic;           /* and what it absorbs */
    const Volume *density;     /* a factor of all that; NULL: 1 everywhere */
    bool emits;                /* emission is not zero */
    Spectrum emission;         /* radiance gained per scene unit, as SceneLight's */
    const Volume *temperature; /* NULL, or in kelvin where emission is that of a black body of reference_k */
    double reference_k;
    uint32_t light_group; /* of what it shines, as SceneLight's */
    bool mixes;           /* adds to the medium that owns a place, see scene_mixing_state */
    bool models;          /* others are instances of it */
    uint32_t turned_from; /* SCENE_NONE; or the medium that this is, but for the direction of its optic axis */
    NestState state;
    bool has_priority;
    int32_t priority;
} SceneMedium;

/* A parameter of a surface that a texture says. */
typedef struct SurfaceTexture {
    const char *property;
    uint32_t texture; /* of scene->textures */
    bool color;       /* the parameter is a Spectrum of reflectances; else a float in least .. most */
    size_t offset;    /* in BsdfSpec */
    float least, most;
    float factor; /* of the texture's number */
} SurfaceTexture;

/* The state of matter by which media mix: one that does is where the owner of the place is of its own state. What states
 * none is taken for gas where it mixes, is the world's, or bends light as little as gases do. */
NestState scene_mixing_state(const SceneMedium *medium, bool is_world);
/* Whether it goes on without end in an object that does: its density does not end. */
static inline bool scene_medium_is_endless(const SceneMedium *medium)
{
    return !medium->density || medium->density->outside > 0;
}
/* Whether all light that it gives off arrives, from however far. */
static inline bool scene_medium_adds_up(const SceneMedium *medium)
{
    return medium->emits && !medium->absorbs && !medium->scatters;
}

/* The frame of an object whose medium varies from place to place: where its node's own coordinates are in the world. */
typedef struct SceneFrame {
    uint32_t object;
    uint32_t motion; /* of the frame, which of the scene's; SCENE_NONE when it stands still */
    Affine to_world;
} SceneFrame;

/* What is known of a volume beside its grid: where its own coordinates are in the frame. */
typedef struct SceneVolumePlace {
    Affine to_frame;
    uint32_t motion;  /* of that, as SceneFrame's */
    uint64_t content; /* of all that its values come from */
    Span span;
    bool from_file;
    bool has_box; /* both corners of a function's box are written, and not taken by default */
} SceneVolumePlace;

/* Along what the scratches of a brushed metal run: circles about the y axis of the object's shape, or one of its axes. */
typedef enum SceneGrain { GRAIN_AROUND, GRAIN_X, GRAIN_Y, GRAIN_Z } SceneGrain;

/* What an opaque object is covered with, or the boundary of a clear one. */
typedef struct SceneSurface {
    /* What every hit asks for comes first, side by side. */
    Spectrum albedo; /* diffuse reflectance, 0..1 */
    float roughness; /* of the boundary of a clear object; its alpha is the square */
    bool finished;   /* more than matte: has a spec */
    bool emits;      /* shines by itself, from both sides */
    bool mixed;      /* instead of all but emission: a part spec.mix_weight of surfaces[mix[1]], the rest of [mix[0]] */
    bool painted;    /* says what part of a clear object's boundary is clear, or a part of the mix does */
    bool catches;    /* shadows: straight before the camera it is only what other things change of its light */
    uint32_t n_textures;
    uint32_t bump;             /* SCENE_NONE, or a texture of heights, in units of bump_height */
    uint32_t normal_map;       /* SCENE_NONE, or a texture of vectors, each number 0..1 for -1..1 */
    BsdfSpec spec;             /* of a number that a texture says: the largest that it can be */
    Spectrum emission;         /* radiance, as SceneLight's; of one that a texture says, about its mean */
    uint32_t emission_texture; /* SCENE_NONE, or radiance from place to place, in units of: */
    float emission_factor;
    uint32_t light_group; /* of what it shines, as SceneLight's */
    uint32_t mix[2];
    const SurfaceTexture *textures;
    bool textures_use_uv;     /* some texture of it asks for the surface's own coordinates, */
    bool textures_use_object; /* or at least for the place on the object; else for that in the world alone */
    bool textures_use_normal; /* or for where it faces: of a smooth mesh as it is shaded, not triangle by triangle */
    bool thin;                /* light goes through it, or through a part of the mix */
    double bump_height;
    float normal_x, normal_y; /* factors of the normal map's slopes */
    SceneGrain grain;
    double grain_angle; /* radians */
    const char *name;
} SceneSurface;

typedef struct SceneMaterials { /* what a mesh file says that its parts are made of */
    const char *file, *names;   /* as it was given; "'glass', 'label' and 3 more" */
    uint32_t n;                 /* 1 where a part was asked for */
} SceneMaterials;

typedef struct SceneShape { /* geometry that objects share; one of the two */
    Mesh *mesh;
    Solid *solid;
    bool closed;     /* nothing but a camera within sees its inside */
    Mesh *mesh_end;  /* NULL, or what the mesh becomes while the shutter is open: the same triangles */
    MeshJoin join;   /* of a mesh that was open by the last bits, unless the scene asked for that */
    MeshParts parts; /* of a mesh whose bodies overlap; n_layers 0: of none, or not known. Where it holds a medium, its
                        * layers are used in its place: shapes that follow each other, see build_layers.c */
    uint32_t layer_of;               /* SCENE_NONE, or the mesh that this is a layer of */
    const SceneMaterials *materials; /* NULL, or what the mesh's file says of its parts, which is not taken */
} SceneShape;

/* A thing in the scene, or an operand of one that is a combination: those follow the combination's own row, which has
 * the medium or the surface but no shape. */
typedef struct SceneObject {
    const char *name; /* as declared, or made up: "sphere 12" */
    Span span;
    bool of_library;  /* placed by a macro of the standard library; span is of the call */
    uint32_t shape;   /* SCENE_NONE for a combination */
    uint32_t tree;    /* of a combination: which of the scene's; SCENE_NONE for others */
    uint32_t part_of; /* of an operand: the combination's row; SCENE_NONE for others */
    Affine to_world;
    uint32_t medium; /* of the interior: a hull; SCENE_NONE for an opaque object and for operands */
    uint32_t
        surface;    /* of an opaque object, or of an operand of one; of a hull one that makes it rough, or SCENE_NONE */
    uint32_t light; /* SCENE_NONE when it does not shine */
    uint32_t motion;        /* which of the scene's motions; SCENE_NONE when it stands still */
    uint32_t texture_frame; /* which of the scene's; SCENE_NONE where no texture needs it */
    uint64_t identity;      /* which object this is at another clock; see EvalNode.identity */
    int32_t priority;       /* the object's own, or its medium's, or 0 */
    double volume;          /* enclosed, in cubic scene units; 0 for a combination, see CompiledScene.hulls */
} SceneObject;

/* Where the textures on an object are: they stay with the frame that it was described in. */
typedef struct SceneTextureFrame {
    Affine from_shape; /* from the frame of the object's shape */
    bool moved;        /* that is not the identity */
    double inverse;    /* 1 / its determinant */
    uint32_t motion;   /* of from_shape, which of the scene's; SCENE_NONE when it is always the same */
    Box3 box;          /* around the shape, in its own frame: the sides of it stand for the uv of a mesh without any */
} SceneTextureFrame;

/* A union, intersection or difference of other objects; see nest/csg.h. Operands count from 0 through the scene. */
typedef struct SceneTree {
    uint32_t root;   /* of scene->parts */
    uint32_t object; /* the combination's row */
} SceneTree;

/* How places of the film become rays; the words of nodes.def, in its order. */
typedef enum SceneProjection {
    PROJECTION_PERSPECTIVE,
    PROJECTION_ORTHOGRAPHIC,
    PROJECTION_PANORAMA, /* by longitude and latitude */
    PROJECTION_FISHEYE,  /* by the angle from the middle */
    PROJECTION_COUNT
} SceneProjection;

/* What the lens of a camera is seen through: an opening between blades, as scene/iris.h makes it. */
typedef struct SceneIris {
    uint32_t blades; /* 0: none, a disc */
    double rotation, roundness;
    uint32_t n_corners;
    const float *corners; /* of each how far it is to the right and up, in units of the lens's radius */
} SceneIris;

typedef struct SceneCamera {
    const struct SceneCamera *keys; /* NULL, or n_keys of them: where it is while the shutter is open */
    uint64_t identity;
    const char *name;
    Span span;
    Vec3 from;
    Vec3 right, up, forward; /* orthonormal */
    SceneProjection projection;
    double half_width;  /* of the picture: perspective, at distance 1; orthographic, a length; others, radians */
    double shift[2];    /* of perspective: where at distance 1 the picture's middle is, to the right and up */
    double lens_radius; /* 0: pinhole; of a disc as large as the iris, where there is one */
    double lens_reach;  /* how far its points are from its middle: the same for a disc */
    SceneIris iris;
    /* the plane that is sharp: of its places, by how far from the camera's they are to the right, up and forward, the products with
     * these add up to 1 */
    double focus[3];
    const uint32_t *expect; /* media, outermost first, that the camera must be inside of; NULL: not stated */
    uint32_t n_expect;
    Span expect_span;
} SceneCamera;

typedef struct SceneFilm {
    uint32_t width, height;
    const char *const *outputs;
    uint32_t n_outputs;
    AovSet aovs;
    Exposure exposure;    /* of pictures for a display */
    double white_balance; /* the temperature of the light that these show as white, K; 0: colours are as they are */
    bool alpha;           /* such pictures keep their alpha, and are not over black */
    bool box; /* a pixel is the mean over its own area; else a tent, which reaches half over its neighbours */
} SceneFilm;

/* Whether light from small lights through clear objects is looked for before rendering. */
typedef enum SceneCaustics { CAUSTICS_AUTOMATIC, CAUSTICS_ON, CAUSTICS_OFF } SceneCaustics;
/* By its word; false: there is none. */
bool scene_caustics_from_text(const char *text, SceneCaustics *caustics);

/* Long ways end by chance; no path comes to so many. */
#define SCENE_BOUNCES_BY_CHANCE 4194304u

typedef struct SceneRender {
    SceneCaustics caustics;
    uint32_t samples;   /* per pixel; in the mean when it is adaptive, at most when there is a noise */
    bool samples_given; /* by the scene */
    bool adaptive;      /* pixels get samples as their errors need them */
    double noise;       /* error at which a pixel stops, as render/adapt.h has it; 0: none does */
    uint32_t bounces;   /* real boundaries and scatterings, not silent crossings; or SCENE_BOUNCES_BY_CHANCE */
    NestPolicy nesting;
    uint32_t seed;
    bool denoises; /* as render/denoise.h has it */
    bool spreads;  /* single bright samples, over what is around them, as render/spread.h has it */
} SceneRender;

/* What the animation node says. */
typedef struct SceneAnimation {
    uint32_t n_frames, first_frame;
    double fps;
    bool cyclic;
} SceneAnimation;

enum {
    SCENE_PART_OBJECTS,
    SCENE_PART_MEDIA,
    SCENE_PART_SURFACES,
    SCENE_PART_LIGHTS,
    SCENE_PART_CAMERAS,
    SCENE_PART_ENVIRONMENT,
    SCENE_PARTS
};

typedef struct Scene {
    /* holds everything but objects, meshes, solids, images and the environment, which scene_free frees too */
    Arena arena;
    SceneMedium *media; /* [0] is the world's */
    uint32_t n_media;
    SceneSurface *surfaces;
    uint32_t n_surfaces;
    Texture *textures;
    uint32_t n_textures;
    TextureImage **images; /* that textures refer to */
    uint32_t n_images;
    SceneTextureFrame *texture_frames;
    uint32_t n_texture_frames;
    Volume **volumes;                /* freed by scene_free */
    SceneVolumePlace *volume_places; /* of each */
    uint32_t n_volumes;
    SceneFrame *frames; /* in the order of objects */
    uint32_t n_frames;
    SceneShape *shapes;
    uint32_t n_shapes;
    SceneObject *objects;
    uint32_t n_objects;
    double shutter;           /* how long it is open, in frames; 0: not to speak of */
    uint32_t n_keys;          /* of each motion, at evenly spread times while the shutter is open; 0: nothing moves */
    Affine *motions;          /* n_keys for each motion: of what to the world, where it is not said to be another map */
    SceneCamera *camera_keys; /* n_keys for each camera, also for those that stand still; NULL without a shutter */
    uint32_t n_motions;
    SceneTree *trees;
    uint32_t n_trees;
    NestPart *parts; /* of the trees; operands are numbers into: */
    uint32_t n_parts;
    uint32_t *operands; /* rows of objects */
    uint32_t n_operands;
    SceneLight *lights;
    uint32_t n_lights;
    SceneCamera *cameras;
    uint32_t n_cameras;
    Environment *environment;    /* NULL: black */
    Affine world_to_environment; /* rotation */
    bool environment_hidden;     /* the camera, looking straight at it, sees nothing */
    uint32_t environment_group;  /* as SceneLight's */
    LightGroups light_groups;
    SceneFilm film;
    SceneRender render;
    SceneAnimation animation;
    uint32_t frame; /* of the animation, that the scene is at */
    bool is_still;  /* nothing in its texts asks for the clock, the frame or the time */
    double unit_m;
    bool has_unit;            /* the scene's header names it; else they are metres */
    const char *const *files; /* everything that was read: scene files, meshes, images */
    uint32_t n_files;
    uint64_t hash;                     /* of the meaning: equal for scenes that render the same */
    uint64_t part_hashes[SCENE_PARTS]; /* the same of parts, to say where two differ; what moves is not in them */
} Scene;

void scene_free(Scene *scene); /* NULL is fine */
/* Whether the boundary of a clear object that has it only bends and mirrors: it is smooth, and clear in all parts. */
static inline bool surface_is_clear(const SceneSurface *surface)
{
    return !(surface->roughness > 0) && !surface->painted;
}
/* Whether anything of a surface depends on the place. */
static inline bool surface_has_relief(const SceneSurface *surface)
{
    return surface->bump != SCENE_NONE || surface->normal_map != SCENE_NONE;
}
static inline bool
surface_has_textures(const SceneSurface *surface) /* for its Bsdf; itself, not those that it is a mix of */
{
    return surface->n_textures > 0 || surface_has_relief(surface);
}
/* The row of the combination that an object is an operand of, or its own. */
static inline uint32_t scene_whole(const Scene *scene, uint32_t object)
{
    uint32_t whole = scene->objects[object].part_of;
    return whole == SCENE_NONE ? object : whole;
}
/* Whether an object's surface gives light; a lamp, see SceneObject.light, has none. */
static inline bool scene_surface_shines(const Scene *scene, uint32_t object)
{
    uint32_t surface = scene->objects[object].surface;
    return surface != SCENE_NONE && scene->surfaces[surface].emits;
}
/* Whether an object gives light by itself: its surface, or what fills it. */
static inline bool scene_shines(const Scene *scene, uint32_t object)
{
    uint32_t medium = scene->objects[object].medium;
    return scene_surface_shines(scene, object) || (medium != SCENE_NONE && scene->media[medium].emits);
}
/* Whether an object catches shadows. */
static inline bool scene_is_catcher(const Scene *scene, uint32_t object)
{
    uint32_t surface = scene->objects[object].surface;
    return surface != SCENE_NONE && scene->surfaces[surface].catches;
}
/* Whether light goes through an object that has no interior. */
static inline bool scene_is_thin(const Scene *scene, uint32_t object)
{
    uint32_t surface = scene->objects[object].surface;
    return surface != SCENE_NONE && scene->objects[object].medium == SCENE_NONE && scene->surfaces[surface].thin;
}
/* Whether a clear object's boundary can be seen even between media of one index. */
static inline bool scene_is_painted(const Scene *scene, uint32_t object)
{
    uint32_t surface = scene->objects[object].surface;
    return surface != SCENE_NONE && scene->surfaces[surface].painted;
}
/* A combination is none, whatever its operands are. */
static inline bool scene_is_plane(const Scene *scene, uint32_t object)
{
    uint32_t shape = scene->objects[object].shape;
    const Solid *solid = shape == SCENE_NONE ? NULL : scene->shapes[shape].solid;
    return solid && solid->pieces[0].kind == PIECE_PLANE;
}
/* Whether it is a smooth sheet, without relief, that lets some light straight on, here and there at least. */
static inline bool surface_is_pane(const SceneSurface *surface)
{
    if (!surface->thin || !surface->finished || surface->mixed || surface->emits || surface_has_relief(surface))
        return false;
    bool clear = surface->spec.transmission_weight > 0;
    for (uint32_t i = 0; i < surface->n_textures; i++) {
        if (surface->textures[i].offset == offsetof(BsdfSpec, specular_roughness)) return false;
        clear |= surface->textures[i].offset == offsetof(BsdfSpec, transmission_weight);
    }
    return clear && surface->spec.specular_roughness < 0.03f;
}
/* Whether light of the environment is said to come in through some opening. */
bool scene_has_portal(const Scene *scene);
/* Whether some surface catches shadows. */
bool scene_catches(const Scene *scene);
/* Whether a surface, or a part of what it is a mix of, is a pane. */
bool scene_surface_has_pane(const Scene *scene, uint32_t surface);
/* Whether rays towards lights go through an object that has no interior: through panes, and holes in sheets, which are
 * panes in a mix. */
static inline bool scene_is_pane(const Scene *scene, uint32_t object)
{
    return scene_is_thin(scene, object) && scene->objects[object].light == SCENE_NONE &&
           scene_surface_has_pane(scene, scene->objects[object].surface);
}
/* What tells an object from others where textures vary: its name, which neither layout nor objects behind it change; an
 * operand has that of the whole. */
uint64_t scene_texture_identity(const Scene *scene, uint32_t object);
/* The maps of a motion at the times of the scene's keys; NULL for SCENE_NONE. */
static inline const Affine *scene_motion(const Scene *scene, uint32_t motion)
{
    return motion == SCENE_NONE ? NULL : scene->motions + (size_t)motion * scene->n_keys;
}
/* A volume's row among the scene's; SCENE_NONE: it has none, as NULL. */
uint32_t scene_volume_row(const Scene *scene, const Volume *volume);
/* Where a moving object is at the times of the scene's keys; NULL for one that stands still. */
static inline const Affine *scene_keys(const Scene *scene, const SceneObject *object)
{
    return scene_motion(scene, object->motion);
}
/* Where a thing with these keys (NULL: it stands still) is at a time 0..1 of the shutter; room is for one that moves. */
static inline const Affine *scene_place_at(const Scene *scene, const Affine *keys, const Affine *still, double time,
                                           Affine *room)
{
    if (!keys) return still;
    *room = affine_between(keys, scene->n_keys, time);
    return room;
}
static inline const Affine *scene_object_place(const Scene *scene, const SceneObject *object, double time, Affine *room)
{
    return scene_place_at(scene, scene_keys(scene, object), &object->to_world, time, room);
}
/* Where a moving light is at the times of the scene's keys; NULL for one that stands still. */
const Affine *light_keys(const Scene *scene, const SceneLight *light);
/* The camera at a time 0..1 of the shutter. */
SceneCamera scene_camera_at(const Scene *scene, const SceneCamera *camera, double time);
/* Where the rays start, without a lens, at a place of the film: from -1, left, and -1, below, to 1 and 1. */
Vec3 scene_camera_place(const Scene *scene, const SceneCamera *camera, double x, double y);
/* Some of those places, spread evenly over the film: 0 .. SCENE_CAMERA_PLACES - 1. */
enum { SCENE_CAMERA_PLACES = 256 };
Vec3 scene_camera_some_place(const Scene *scene, const SceneCamera *camera, uint32_t number);
/* Around all of them. */
Box3 scene_camera_bounds(const Scene *scene, const SceneCamera *camera);
/* The smallest box around an object wherever it moves, moved by `after` (NULL: not); empty for one without any surface,
 * without end for planes. Of a combination it is what follows from the boxes of its operands: there may be less of it. */
Box3 scene_object_bounds(const Scene *scene, const SceneObject *object, const Affine *after);
/* The same box without an `after`, for many objects in turn: *known, {0} at first, keeps what the next one of the same
 * shape can use. */
typedef struct SceneShapeBox {
    const SceneShape *shape;
    Box3 box; /* of its mesh */
} SceneShapeBox;
Box3 scene_next_bounds(const Scene *scene, const SceneObject *object, SceneShapeBox *known);
/* A box around it that may be larger: of a mesh that is turned, from the corners of the box of its shape, without a look at
 * each vertex. */
Box3 scene_next_box_around(const Scene *scene, const SceneObject *object, SceneShapeBox *known);
/* The smallest box around a shape in its own frame, mesh_end included. */
Box3 scene_shape_bounds(const SceneShape *shape);

#endif

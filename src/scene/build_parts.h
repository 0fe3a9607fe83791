/* build_parts.h - what the files that build a scene share; private to src/scene/build*.c.
 *
 * A Builder lives for one call of scene_build. Everything that stays goes into the scene's arena or, for
 * meshes and solids, into its table of shapes as soon as it exists, so that scene_free finds it whenever
 * memory ends.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BUILD_PARTS_H
#define MEN_BUILD_PARTS_H

#include "lang/formula.h"
#include "mesh/mesh_file.h"
#include "scene/build.h"

/* Coordinates and lengths beyond this are refused: Embree takes 1.8e18 at most, and squares of lengths must
 * stay far inside of what a float can hold. */
#define SCENE_REACH 1e15

/* From bytes to numbers; open addressing. The keys belong to the caller. */
typedef struct MapSlot {
    uint64_t hash;
    const void *key; /* NULL: free */
    size_t length;
    uint32_t value;
} MapSlot;
typedef struct Map {
    MapSlot *slots;
    size_t n, capacity;
} Map;
/* The value of the key; NULL when it is not there. */
const uint32_t *map_seek(const Map *map, const void *key, size_t length);
/* The value of the key; a new key gets the value given. */
uint32_t *map_find(Arena *arena, Map *map, const void *key, size_t length, uint32_t value_if_new);
/* An arena array with room for one more than n; the old one is left to the arena. */
void *room_for_one(Arena *arena, void *items, uint32_t n, uint32_t *capacity, size_t size);

/* What was found out about a shape, beside the SceneShape of the same number. */
typedef struct ShapeFacts {
    double volume; /* in the shape's own frame */
    Box3 bounds;
    bool closed, consistent, finite;
    bool turned;          /* triangles of a mesh that looked the wrong way; it is reported */
    bool many_parts;      /* a mesh of several parts, which may overlap */
    uint32_t first_layer; /* see build_layers.c; 0: not looked for so far */
    bool reported_open;
    /* of a body between planes: these, and where its frame is in theirs (build_convex.c) */
    const struct HalfSpace *spaces;
    uint32_t n_spaces;
    Vec3 centre;
    double file_unit_m; /* 0: not known */
    double to_scene;    /* how long the file's unit is in scene units */
    uint32_t n_open_edges, n_non_manifold;
    struct {
        Vec3f a, b;
    } open[4], non_manifold[4]; /* the first of such edges */
} ShapeFacts;

/* What values a texture can take, as numbers, and what a look-up costs. */
typedef struct TextureFacts {
    double least, most; /* of numbers; of light about the mean luminance, twice */
    unsigned cost, depth;
    bool uses_uv;     /* looks at the surface's own coordinates */
    bool uses_object; /* looks at the place on the object, not only at the one in the world */
    bool uses_normal; /* looks at where the surface faces, which changes smoothly over a smooth mesh */
    bool open;        /* least and most are not known: a function's own values are among it */
    bool formula;     /* a function is among it */
    const EvalProp *function;
} TextureFacts;

/* A texture with functions, as a property has it: to be looked at where the surface turns out to be. */
typedef struct OpenTexture {
    uint32_t row;
    const EvalProp *user;
    bool failed; /* a mistake of it has been reported */
} OpenTexture;

typedef struct Builder {
    Scene *scene;
    Arena *arena; /* the scene's */
    Diag *diag;
    const SceneOptions *options;
    EvalOptions eval_options;
    EvalResult result;
    SceneInstant instant;
    ShapeFacts *facts;
    uint64_t where;                  /* identity of the node being built, with those of the groups around it */
    struct Combination *combination; /* that the nodes being built are operands of; NULL outside of any */
    uint32_t media_capacity, surfaces_capacity, shapes_capacity, facts_capacity, lights_capacity, cameras_capacity,
        files_capacity, volumes_capacity, frames_capacity, operands_capacity, parts_capacity, trees_capacity;
    size_t objects_capacity;
    const char **file_table;                   /* the scene's files, not const */
    Map media, surfaces, shapes, names, files; /* media, surfaces: by the address of their node */
    Map nameless_media;                        /* by their values */
    const PhaseTable **phase_tables;           /* of spheres, each of another recipe */
    uint32_t n_phase_tables, phase_tables_capacity;
    Map textures, pictures;
    TextureFacts *texture_facts; /* of scene->textures */
    OpenTexture *open_textures;
    uint32_t n_open_textures, open_textures_capacity;
    uint32_t n_formula_objects; /* that have been looked at for them */
    uint32_t texture_facts_capacity, textures_capacity, pictures_capacity, texture_frames_capacity;
    double picture_bytes;
    const EvalProp *texture_user; /* the property that textures are being built for */
    Affine node_to_world;         /* of the node being built: the frame that it is described in */
    Map volumes;                  /* by the address of their node */
    Map mesh_files;               /* shapes by the address of the first mesh node that has them */
    uint32_t black;               /* the surface of lights; SCENE_NONE until there is one */
    uint32_t grey;                /* the surface of a ground that names none */
    uint64_t environment_hash;
    MeshKept kept_mesh; /* the file that the last part of a mesh was taken from */
    enum { SHUTTER_UNKNOWN, SHUTTER_NONE, SHUTTER_OPENS } shutter_known; /* of the scene's cameras */
    void *scratch;                                                       /* of build_convex.c */
    size_t scratch_bytes;
    bool only_shapes; /* for geometry.c: what objects are made of does not matter */
    Status status;    /* a failure that is no mistake in the scene */
    Error *error;
} Builder;

/* build.c */
/* The row of a table that was made of a node; a new one gets the row given. */
uint32_t *build_row_of(Builder *b, Map *map, const EvalNode *node, uint32_t row_if_new, bool *found);
/* scene_build_from without what moves. */
ATTR_NODISCARD Status build_at_moment(const SceneText *text, const SceneOptions *options, Diag *diag, Scene **scene,
                                      Buf *printed, SceneInstant *instant, Error *error);
/* Builds a placed node, and what is in it; without lights and cameras when only_shapes is set. */
void build_visit(Builder *b, const EvalNode *node, const Affine *parent);
/* What a node was called in the scene, for good; NULL: nothing. */
const char *build_word(Builder *b, const EvalNode *node);
/* A name of its own for every thing: as declared, or the word with a number. */
const char *build_name(Builder *b, const EvalNode *node, const char *word);
/* Notes a file that was read. */
void build_note_file(Builder *b, const char *path);
/* A file of text, which messages can quote even when there is no scene in the end. */
typedef struct BuildText {
    const char *text; /* terminated */
    size_t length;
    uint32_t source;
} BuildText;
/* Finds it, reads it whole and notes it; false after a report: of not_text, say, where it holds a byte 0. */
bool build_text_file(Builder *b, Span span, const char *name, size_t most_bytes, DiagCode not_text, BuildText *file);
/* Reports unless every coordinate of the box is finite and within reach. */
bool build_check_reach(Builder *b, Span span, const char *what, Box3 bounds);
/* Reports a map that flattens or is not finite. */
bool build_check_transform(Builder *b, const EvalNode *node, const Affine *map);
/* Where the author of the scene wrote what the node is, for reports of what comes of it. */
Span build_author_place(const Builder *b, const EvalNode *node);
/* The span of the property where it is set, else of the node. */
Span build_span(const EvalNode *node, const char *property);
/* Reports when both are set; word says what the pair means. Returns true when all is well. */
bool build_exclude(Builder *b, const EvalNode *node, const char *property, const char *other);
/* Reports when the grid of a surface that a function describes could not be made fine enough; NULL: it could (build_implicit.c). */
Diagnostic *build_check_reached(Builder *b, const EvalNode *node, double reached, double tolerance);
/* Reports a property that has no effect without another, or with another value of it; returns the report, NULL where the
 * property is not set. */
Diagnostic *build_needs(Builder *b, const EvalNode *node, const char *property, const char *needed);
/* The same where another property is not set, or false. A number that is 0 is meant so: by a parameter, or at the beginning of an
 * animation. */
Diagnostic *build_needs_other(Builder *b, const EvalNode *node, const char *property, const char *other,
                              const char *without);

/* build_media.c */
uint32_t build_medium(Builder *b, const EvalNode *node);
/* The same, of what fills an object: without a name of its own it is named after the first one. */
uint32_t build_medium_of(Builder *b, const EvalNode *node, const char *owner);
/* Gives an object, which has its surface, its medium; the optic axis of a crystal is turned as the frame of the object is. */
void build_fill_object(Builder *b, const EvalProp *interior, uint32_t number, const Affine *frame);
/* Whether a radiance can be rendered; reports when not. */
bool build_is_bearable(Builder *b, Span span, double radiance);
/* Emission: the colour of a property (NULL: white) times a factor; false after reporting. */
bool build_emission(Builder *b, const EvalNode *node, const char *property, double factor, Spectrum *out);

/* Room for a tabulated spectrum, in the scene's arena. */
float *build_new_table(Builder *b);

/* build_phase.c */
/* In which directions a medium scatters whose index is known. */
void build_phase(Builder *b, const EvalProp *prop, SceneMedium *medium);

/* build_surface.c */
uint32_t build_surface(Builder *b, const EvalNode *node);
/* Whether a surface suits an object that is clear, or one that is opaque; reports when not. */
bool build_surface_fits(Builder *b, const EvalProp *surface, bool clear);
/* What a surface has otherwise than another, from one to the next: the property's name; NULL: nothing more. *n is 0 at first.
 * What the textures of both make of theirs does not matter. */
const char *build_next_change(const SceneSurface *a, const SceneSurface *b, unsigned *n);
/* NULL: none says that property. */
const SurfaceTexture *build_texture_of(const SceneSurface *surface, const char *property);
/* Says of the largest values that the surface's textures can come to those of a later moment, too. */
void build_widen_surface(SceneSurface *surface, const SceneSurface *later);
uint32_t build_black_surface(Builder *b);
uint32_t build_grey_surface(Builder *b);

/* build_texture.c */
typedef enum TextureUse { TEXTURE_OF_NUMBERS, TEXTURE_OF_COLORS, TEXTURE_OF_VECTORS, TEXTURE_OF_LIGHT } TextureUse;
/* Whether the scene is built for a moment after the shutter opens, to be compared. */
static inline bool build_is_later(const Builder *b)
{
    return b->options->moment.later > 0;
}
/* Whether textures matter to what is being built. */
bool build_textures_wanted(const Builder *b);
/* The row of the texture that a property has instead of a value; reports values outside of the property's range. *least,
 * *most: what a texture of numbers can come to. */
uint32_t build_texture(Builder *b, const EvalProp *prop, TextureUse use, double *least, double *most);
/* Cubes of two reflectances in turn, in the world, as a surface's pattern = checker has them. */
uint32_t build_world_checker(Builder *b, const double rgb[3], const double other[3], double size);
/* Whether a surface, or one that it is mixed of, has the texture of that row itself. */
bool build_surface_includes(const Scene *scene, uint32_t surface, uint32_t row, unsigned depth);
/* Whether a row, or one that it refers to, looks at the surface's own coordinates. */
/* A surface gets that texture: what of places it has to know for it. */
void build_texture_place(const Builder *b, uint32_t row, SceneSurface *surface);
/* The row of a texture's node. */
uint32_t build_texture_row(Builder *b, const EvalNode *node, TextureUse use);
/* Says where the textures on an object are, if it has any: in the frame of the node that its surface was given to. */
void build_texture_frame(Builder *b, uint32_t object_row, const Affine *node_to_world);

/* build_formula.c */
/* Reads a formula node into a texture. */
void build_formula(Builder *b, const EvalNode *node, TextureUse use, Texture *texture, TextureFacts *facts);
/* Asks the functions among the textures of an object at places all over it; reports the first without a fair value. */
void build_check_formulas(Builder *b, uint32_t object_row);

/* build_picture.c */
/* The picture of an image node; NULL after reporting. *source: another number where it is of another file, or read in
 * another way. */
const TextureImage *build_texture_image(Builder *b, const EvalNode *node, TextureUse use, uint64_t *source);
/* build_field.c */
/* A function of a point, to be asked at very many of them. */
typedef struct SceneField {
    const EvalFunctionValue *function;
    const Program *program; /* the same, compiled; NULL where only the evaluation can do it */
    Pool *pool;
} SceneField;
/* Memory is the arena's that is gone when the scene is built. */
SceneField build_field(const Builder *b, const EvalFunctionValue *function);
/* False after a report. Not from within a task. */
bool build_field_value(const SceneField *field, Vec3 p, double *value);
/* From any thread: false where build_field_value has to be asked. */
bool build_field_shared_value(const SceneField *field, Vec3 p, double *value);
/* What its values at the points of a box are between; false where that is not known. */
bool build_field_bounds(const SceneField *field, Box3 box, double *low, double *high);
/* Points (i, j) of layer k of a grid, i < n[0], j < n[1]. */
typedef struct FieldLayer {
    const void *context;
    Vec3 (*point)(const void *context, uint32_t i, uint32_t j, uint32_t k);
    uint32_t n[2], k;
    const uint8_t *wanted; /* those that are asked; NULL: all. The values of the others are left as they are, finite */
} FieldLayer;
/* values[j * n[0] + i], by all threads; false after a report, of the first point that has no value. */
bool build_field_layer(const SceneField *field, const FieldLayer *layer, double *values);

/* build_volume.c */
/* The volume that a property says, if it is set; NULL after reporting. */
const Volume *build_volume(Builder *b, const EvalNode *node, const char *property);
/* Notes the frame of the object that was added last, where its medium needs one. */
void build_note_frame(Builder *b, uint32_t object);

/* build_spectrum.c */
/* What a property's spectrum() says, its factor included; false after reporting. most: the largest value that can be
 * used, where the property's row has no smaller one. */
bool build_spectrum(Builder *b, const EvalProp *prop, double most, Spectrum *out);
/* The rows of a term's table, two numbers each, in place or from its file, unchecked; false after reporting. row_is: what a row should
 * be. */
bool build_pairs(Builder *b, const EvalProp *prop, DiagCode code, const char *row_is, const double **pairs, size_t *n);
/* The same of a light, whose lines stay as narrow as they are. */
bool build_light_spectrum(Builder *b, const EvalProp *prop, double most, Spectrum *out);

/* build_shape.c */
void build_box(Builder *b, const EvalNode *node, const Affine *to_world);
void build_plane(Builder *b, const EvalNode *node, const Affine *to_world);
void build_ground(Builder *b, const EvalNode *node, const Affine *to_world);
/* What an object is made of: an interior, a surface, or an interior that has a rough surface; false after reporting. */
bool build_matter(Builder *b, const EvalNode *node, uint32_t shape, const EvalProp **interior,
                  const EvalProp **surface);
/* Places a shape as a hull or as an opaque thing, whichever the node says, or as an operand of the combination around
 * it. */
void build_object(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world);
/* An object without interior: opaque. The shape may be SCENE_NONE. */
uint32_t build_add_object(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world);
/* The same with a name that was given out before. */
uint32_t build_add_named(Builder *b, const EvalNode *node, const char *name, uint32_t shape, const Affine *to_world);
/* A new and empty shape. */
uint32_t build_new_shape(Builder *b);
/* The shape of that key: *found says whether it exists already; else it is new and empty, to be filled. The key
 * is copied. */
uint32_t build_shape_of(Builder *b, const void *key, size_t length, bool *found);
/* A solid from a single open piece, for grounds and lights. */
uint32_t build_piece_shape(Builder *b, const Piece *piece);
uint32_t build_sphere_shape(Builder *b, double radius);
/* What came of making the solid of a new shape: fills in its facts, or reports and returns false. A failed shape stays in
 * the table, empty: the scene is thrown away in the end. */
bool build_keep_solid(Builder *b, uint32_t shape, Status status, const Error *error, Span span);
/* Reports a shape that cannot be; of several of one place, as in a loop, the first. NULL: that has been reported. */
Diagnostic *build_report_shape(Builder *b, Span span, const Error *error);
/* false (after reporting a scene mistake at span, or noting a failure) unless status is STATUS_OK. */
bool build_succeeded(Builder *b, Status status, const Error *error, Span span);
/* A right-handed frame at `origin` whose y axis is the unit vector y. */
Affine build_frame(Vec3 origin, Vec3 y);

/* build_csg.c */
void build_union(Builder *b, const EvalNode *node, const Affine *to_world);
void build_intersection(Builder *b, const EvalNode *node, const Affine *to_world);
void build_difference(Builder *b, const EvalNode *node, const Affine *to_world);
/* The children of the node as one part of the present combination. */
void build_part(Builder *b, const EvalNode *node, const Affine *to_world, NestOperation operation);
/* A shape as an operand of the present combination. */
void build_operand(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world);

/* A mesh whose parts overlap, as an object: a union of its layers, whose row comes first. False, and nothing is added,
 * for everything else. */
bool build_layered(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world, uint32_t surface);

/* build_convex.c */
/* Puts one convex body in the place of the planes and boxes among the children of an intersection or a difference that has just
 * been built, in that frame, where there are some and it can be done. Its operands are the last ones; the row of the first of
 * them is n_objects. A part of which nothing else is left becomes that operand. */
void build_merge_planes(Builder *b, const EvalNode *node, const Affine *to_world, uint32_t part, uint32_t n_objects);

/* build_layers.c */
/* Shapes, one behind another. */
typedef struct Layers {
    uint32_t first, n;
} Layers;
/* What a shape consists of where it encloses something: itself, or layers. */
Layers build_layers(Builder *b, uint32_t shape);
/* Lets go of meshes that only their layers are used of. */
void build_drop_layered(Builder *b);

/* build_round.c */
void build_sphere(Builder *b, const EvalNode *node, const Affine *to_world);
void build_ellipsoid(Builder *b, const EvalNode *node, const Affine *to_world);
void build_torus(Builder *b, const EvalNode *node, const Affine *to_world);
void build_cylinder(Builder *b, const EvalNode *node, const Affine *to_world);
void build_capsule(Builder *b, const EvalNode *node, const Affine *to_world);
void build_cone(Builder *b, const EvalNode *node, const Affine *to_world);
void build_lathe(Builder *b, const EvalNode *node, const Affine *to_world);

/* build_mesh.c */
void build_mesh(Builder *b, const EvalNode *node, const Affine *to_world);
/* Inspects and mends the mesh of a new shape, and fills in its facts; false after reporting. */
bool build_finish_mesh(Builder *b, const EvalNode *node, uint32_t shape);
void build_report_open(Builder *b, Span span, const char *name, uint32_t shape);

/* build_meshed.c */
void build_prism(Builder *b, const EvalNode *node, const Affine *to_world);
void build_sweep(Builder *b, const EvalNode *node, const Affine *to_world);
void build_superellipsoid(Builder *b, const EvalNode *node, const Affine *to_world);
void build_height_field(Builder *b, const EvalNode *node, const Affine *to_world);
/* Makes the mesh of a node. STATUS_SCENE with a text, or with an empty one when it has been reported; *span is where
 * the text points to, the node unless it is changed. */
typedef Status BuildMaker(Builder *b, const EvalNode *node, Mesh **mesh, Span *span, Error *error);
/* Places the shape that the maker makes of the node's PROP_SHAPE properties (and of the bytes of `more`, such as a
 * path): made once for nodes that say the same. */
void build_made(Builder *b, const EvalNode *node, const Affine *to_world, BuildMaker *make, const void *more,
                size_t n_more);

/* build_implicit.c */
void build_blob(Builder *b, const EvalNode *node, const Affine *to_world);
void build_isosurface(Builder *b, const EvalNode *node, const Affine *to_world);

/* build_text.c */
void build_text(Builder *b, const EvalNode *node, const Affine *to_world);

/* build_light.c, build_environment.c, build_view.c */
void build_light(Builder *b, const EvalNode *node, const Affine *to_world);
#define BUILD_SUNS_ANGLE 0.53 /* degrees, the whole disc */
void build_add_light(Builder *b, const SceneLight *light);
/* The group of lights that a node which shines is one of, of the scene's light_groups; reports names that cannot be. */
uint32_t build_light_group(Builder *b, const EvalNode *node);
/* build_profile.c: a light's profile, from the file that the property names; false after reporting. */
bool build_profile(Builder *b, const EvalProp *prop, SceneLight *light);
void build_environment(Builder *b, const EvalNode *node);
void build_camera(Builder *b, const EvalNode *node, const Affine *to_world);
void build_film(Builder *b, const EvalNode *node);
void build_render(Builder *b, const EvalNode *node);

/* scene_hash.c */
/* Of everything that affects the picture; environment_hash: of what the environment was made from. */
/* scene->hash, and all that moves while the shutter is open. */
uint64_t scene_hash_with_motion(const Scene *scene);
uint64_t scene_shape_hash(const SceneShape *shape);
uint64_t scene_medium_hash(const SceneMedium *medium);
/* Of how bright a light is and to what sides it shines, in its own frame; of a distant one also from where. */
uint64_t scene_light_hash(const SceneLight *light);
/* Sets the hashes of the scene's parts, too. */
uint64_t scene_hash(Scene *scene, uint64_t environment_hash, Arena *scratch);

#endif

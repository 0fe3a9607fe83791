/* import_parts.h - what the files share that write a scene from a mesh file; private to src/import.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_IMPORT_PARTS_H
#define MEN_IMPORT_PARTS_H

#include "base/vec3.h"
#include "import/import.h"

#define IMPORT_NONE UINT32_MAX
enum { IMPORT_MOST_OBJECTS = 1000, IMPORT_CREASE_DEGREES = 40 };

/* Triangles that become one object of the scene. */
typedef struct ImportItem {
    const char *called; /* by the file; "": nothing */
    char *name;         /* in the scene; owned */
    const uint32_t *parts;
    uint32_t n_parts;   /* of the source, those of its first run; 0: all there is, or all of a material */
    uint32_t material;  /* of the source's; IMPORT_NONE: none */
    uint32_t first_run; /* of the source's: the order of the file */
    size_t n_triangles;
    bool closed, is_floor;
    bool rounded; /* and without normals: shaded in facets, unless it gets some */
    uint32_t n_open_edges;
    double volume, area; /* of the file's units */
    Box3 box;            /* in scene units, y upward */
} ImportItem;

/* What becomes of a material. Names are owned; NULL: nothing needs it. */
typedef struct ImportMaterial {
    const MeshMaterial *said; /* NULL: what has none in the file */
    char *medium, *boundary;  /* of closed objects that are clear: the surface, where they are rough or painted */
    char *surface;            /* of all others */
    bool clear, thin;         /* light goes through; through what is closed, too, as through a pane */
    double chord_m;           /* the mean way through the objects that are of its medium */
} ImportMaterial;

/* A name of the scene, owned, and what has it. */
typedef struct ImportName {
    char *text;
    const char *kind;
    unsigned long n_same; /* the last number behind it, of others that wanted it */
} ImportName;

typedef struct Importer {
    const ImportOptions *options;
    const MeshSource *source;
    const Mesh *mesh;
    Import *out;
    Error *error;
    Buf *text;     /* of out */
    double file_m; /* the unit of the file, and of the scene */
    double scene_m;
    const char *unit; /* the scene's */
    bool guessed_unit;
    double step; /* to which coordinates are rounded, in scene units */
    ImportItem *items;
    size_t n_items;
    ImportMaterial *materials; /* as the source's, and one more for what has none */
    ImportName *names;         /* that are taken */
    size_t n_names, name_capacity;
    Box3 all, shown;     /* everything; what the camera is to show: without a floor */
    const char *subject; /* what notes are about: "material 'Glass'"; NULL: the file */
    Buf comment;         /* lines for the next node */
    const char *owner;   /* the name of the surface that is written */
    Buf lets;            /* values that have names, for before the next node */
    bool failed;         /* memory ended */
    double exposure;     /* stops, where the lights of the file are far from what a picture needs */
    bool dark, paper;    /* there are to be lights of the studio, and its floor */
    bool room;           /* and around them its room with windows */
    char model[32];      /* the name of the file's name; "": it is written out */
    bool stem_is_read;   /* a picture that the scene reads is called as its own would be */
    bool by_material;    /* there are too many objects, and those of one material are one */
} Importer;

/* import_text.c: nodes, properties, numbers, comments, names */

typedef struct NodeText {
    Importer *im;
    Buf line;
    size_t n_props, line_begin, prop_begin;
    bool value; /* it is one, and stays on its line */
} NodeText;

/* A name of the scene like that of the file: new, and none of the language's words. malloc'd. unspelt: for what
 * has no letters. kind: what has it, which is put behind it where something else has the name already, or before it where it begins
 * with no letter. */
char *import_name(Importer *im, const char *called, const char *unspelt, const char *kind);
/* A node, whose properties follow; name may be NULL. */
NodeText node_begin(Importer *im, const char *type, const char *name);
/* The next property: its value is to be added to what is returned. */
Buf *node_prop(NodeText *node, const char *key);
void node_number(NodeText *node, const char *key, double value);
void node_color(NodeText *node, const char *key, const double rgb[3]);
void node_point(NodeText *node, const char *key, Vec3 p);
void node_word(NodeText *node, const char *key, const char *word);
void node_length(NodeText *node, const char *key, double metres);
/* Writes the comment that has been gathered, if any, and the node. */
void node_end(NodeText *node);
/* Adds it to the value of a property of another one. */
void node_end_value(NodeText *node, Buf *out);
/* A line of the comment of what comes next; a note is also for who runs the program. */
void import_say(Importer *im, const char *format, ...) ATTR_PRINTF(2, 3);
void import_note(Importer *im, const char *format, ...) ATTR_PRINTF(2, 3);
void import_write_comment(Importer *im);
void import_begin_section(Importer *im, const char *title);
void add_number(Buf *out, double value);                         /* four digits */
void add_color(Buf *out, const double rgb[3]);                   /* 0.8, or rgb(0.8, 0.1, 0.1) */
void add_coordinate(const Importer *im, Buf *out, double value); /* in scene units, rounded */
void add_point(const Importer *im, Buf *out, Vec3 p);
/* A text of the file for comments: one line, not too long. */
void add_shown(Buf *out, const char *text);
/* Whether it is text that a string can hold as it is, and not too long. */
bool text_is_plain(const char *text);

/* import_items.c: what becomes an object */
ATTR_NODISCARD Status import_list_items(Importer *im);
/* The value of `part` that is just this item; nothing where the file is all of it. */
void import_ask_for(const Importer *im, const ImportItem *item, Buf *out);

/* import_materials.c, import_surfaces.c */
void import_prepare_materials(Importer *im);
/* Whether the object is filled with its material's medium; else it is covered with its surface. */
ImportMaterial *import_material_of(const Importer *im, const ImportItem *item);
bool import_is_filled(const Importer *im, const ImportItem *item);
/* The properties by which it is. */
void import_add_matter(const Importer *im, const ImportItem *item, NodeText *node);
void import_write_materials(Importer *im);
void import_write_surface(Importer *im, const ImportMaterial *material);
void import_write_boundary(Importer *im, const ImportMaterial *material);
/* Notes what has no place in a medium and its boundary. */
void import_note_filled(Importer *im, const MeshMaterial *said);
/* Held to 0..1. */
double import_fraction(const MeshMaterial *said, MaterialFact fact);
/* How much of the light that is not mirrored goes through; said may be NULL. */
double import_transmission(const MeshMaterial *said);
double import_index(const MeshMaterial *said);
/* Whether a film lies on what it fills. */
bool import_boundary_has_film(const MeshMaterial *said);
/* Whether it gives off light for others, too. */
bool import_shines(const MeshMaterial *said);

/* import_pictures.c: a texture as a value of the language, malloc'd; NULL where the picture cannot be taken, which is noted.
 * key: the property that it is for; props: what else stands in the node, or "". */
char *import_picture(Importer *im, const MeshPicture *picture, const char *key, const char *props);
bool import_picture_has_alpha(const Importer *im, const MeshPicture *picture);

/* import_view.c */
/* Whether the file has light, and something to stand on. */
void import_choose_lights(Importer *im);
void import_write_lights(Importer *im);
void import_write_cameras(Importer *im);

#endif

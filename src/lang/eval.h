/* eval.h - from scene text to a tree of checked nodes.
 * The tree holds no expressions, loops or names any more: only nodes with property values that have
 * the type, range and unit that the schema asks for. A NULL tree means that errors were reported.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EVAL_H
#define MEN_EVAL_H

#include "base/status.h"
#include "base/vec3.h"
#include "diag/diag.h"
#include "lang/schema.h"

typedef struct EvalNode EvalNode;

/* A colour is linear, in the scene's working space. */
typedef struct EvalTerm {
    const TermType *type;
    unsigned n_args;
    double args[8];
    const char *text;    /* TERM_TABLE: the name of a file, or NULL and pairs */
    const double *pairs; /* n_pairs vectors of 2 */
    size_t n_pairs;
    double scale; /* TERM_SCALES: the factor, else 1 */
    Span span;    /* of the call, wherever the value is used */
} EvalTerm;

/* A function of the scene, which can be called as long as the arena of the evaluation lives. */
typedef struct EvalFunctionValue EvalFunctionValue;
/* The function at a point. false when it has no number there, after a report; calls count as steps of the evaluation. */
bool eval_function_at(const EvalFunctionValue *function, Vec3 p, double *value);

typedef enum SpectrumForm { SPECTRUM_NUMBER, SPECTRUM_COLOR, SPECTRUM_VECTOR, SPECTRUM_TERM } SpectrumForm;

/* A property after checking. Which member of the union holds depends on type->kind. */
typedef struct EvalProp {
    const PropType *type;
    Span span;     /* of the value's expression */
    bool textured; /* PROP_TEXTURE: as.node, whatever the kind */
    union {
        double number; /* PROP_NUMBER, PROP_INTEGER */
        bool truth;
        const char *text; /* PROP_STRING, PROP_CHOICE */
        double vector[3]; /* PROP_VECTOR2, PROP_VECTOR3, PROP_COLOR */
        struct {
            SpectrumForm form;
            union {
                double rgb[3];        /* NUMBER: rgb[0]; COLOR, VECTOR: all three */
                const EvalTerm *term; /* TERM */
            };
        } spectrum; /* PROP_SPECTRUM, PROP_NUMBER_OR_TERM, PROP_TERM */
        const EvalNode *node;
        const EvalFunctionValue *function; /* PROP_FUNCTION */
        struct {
            size_t n;
            union {
                const double *numbers; /* PROP_NUMBERS n, PROP_VECTORS2 2n, PROP_VECTORS3 and PROP_VECTOR3_OR_LIST 3n */
                const char *const *texts; /* PROP_STRINGS */
                const EvalNode *const *nodes;
            };
            size_t n_lists;        /* PROP_NUMBER_LISTS, PROP_VECTOR2_LISTS: n and numbers are of all together.
                                         * PROP_RAMP: how many of the n values are colours; numbers: 4n, a position
                                         * 0..1 in ascending order and three channels (all the same of a number) */
            const size_t *lengths; /* n_lists; not of PROP_RAMP */
        } list;
    } as;
} EvalProp;

struct EvalNode {
    const NodeType *type;
    const char *name;       /* as declared, NULL when it has none */
    Span span;              /* of the type's or prototype's word */
    const DiagChain *chain; /* includes and macros around it */
    Affine transform;       /* to the parent; of an instance: the prototype's, then its own */
    const EvalNode
        *prototype;  /* the node that this is an instance of, with PROP_SHAPE properties unchanged; else NULL */
    EvalProp *props; /* the ones that were set (an instance: the prototype's, overridden), in table order */
    size_t n_props;
    EvalNode **children; /* in order of the text */
    size_t n_children;
    uint64_t
        identity;   /* of the place in the text and the calls and turns of loops around it: the same at another clock */
    unsigned depth; /* of children and prototypes within each other, at most LIMIT_NODE_DEPTH */
};

/* How long a name is without two underscores and a number at its end, by which a flat text tells apart what a scene calls the same. */
size_t eval_word_length(const char *name);

/* What an evaluation may use up, so that no scene can run for ever or fill the memory. 0: the default, of limits.def. */
typedef struct EvalLimits {
    uint64_t steps; /* turns of loops and calls */
    uint64_t nodes;
    uint64_t memory;     /* bytes */
    uint64_t file_bytes; /* of one text; never more than the default */
    uint32_t files;      /* that a scene reads as scene text */
    uint32_t calls;      /* nested */
} EvalLimits;

/* A scene text that is built into the program. */
typedef struct EvalLibraryFile {
    const char *name; /* "std/glassware.mns" */
    const char *text; /* a 0 byte stands behind it */
    size_t length;
} EvalLibraryFile;
typedef struct EvalLibrary {
    const EvalLibraryFile *files;
    size_t n_files;
} EvalLibrary;

/* One place on a surface that a ray meets. */
typedef struct EvalHit {
    Vec3 point;
    Vec3 normal;     /* of the surface as it is, unit, outward: not turned towards the ray */
    double distance; /* from the ray's start */
} EvalHit;

/* What a scene may ask of the shape of a node (builtin_geometry.c). The language knows no shapes: the layer above answers,
 * in the frame that the node would be placed in. Mistakes within the node go to diag. All but open and close return
 * STATUS_OK; STATUS_SCENE when there is no answer, and why: the error's text, empty when diag has it; or what failed. */
typedef struct EvalGeometry {
    /* What is remembered from one question to the next; NULL when there is no memory for it. Work is added to *steps: a
     * step for a ray, many for what is built. unit_m: the scene's unit of length, for files that have one of their own. */
    void *(*open)(const void *context, double unit_m, Diag *diag, uint64_t *steps);
    void (*close)(void *state);
    Status (*bounds)(void *state, const EvalNode *node, Box3 *box, Error *error);
    Status (*volume)(void *state, const EvalNode *node, double *volume, Error *error);
    Status (*inside)(void *state, const EvalNode *node, Vec3 point, bool *inside, Error *error);
    /* The surfaces along a ray in order of their distance, or no more than the first. direction: unit. *hits stays valid until
     * the next question. */
    Status (*hits)(void *state, const EvalNode *node, Vec3 from, Vec3 direction, bool all, const EvalHit **hits,
                   size_t *n, Error *error);
    /* A place on the surface: a function of the seed, evenly distributed by area. */
    Status (*scatter)(void *state, const EvalNode *node, uint64_t seed, EvalHit *place, Error *error);
} EvalGeometry;

/* What a scene is evaluated with. Zero is a fair default for all but the schema. */
typedef struct EvalOptions {
    const Schema *schema;
    const char *const *defines; /* "name=expression" of -D */
    size_t n_defines;
    const char *const *overrides; /* "node.property=expression" of --set */
    size_t n_overrides;
    const char *const *include_folders; /* -I */
    size_t n_include_folders;
    const char *confine; /* NULL, or the folder that every file must be under */
    const char *preset;
    double clock;
    int frame, frames; /* of an animation; frames 0: the only frame, 1 */
    double time;       /* seconds */
    bool beyond; /* numbers that a property does not take are the nearest that it does: the moment only blurs a frame */
    double srgb_to_working[9];    /* row-major, linear sRGB to the working space; all 0: identity */
    const EvalLibrary *library;   /* what `use` finds where no file of the scene's has the name; NULL: nothing */
    const EvalGeometry *geometry; /* NULL: nothing can be asked of shapes */
    const void *geometry_context; /* for geometry->open */
    Arena *arena; /* takes all that running the scene makes, the nodes of the result among it; it jumps where that of
                        * diag does. NULL: that of diag */
    EvalLimits limits;
} EvalOptions;

typedef struct EvalParam {
    const char *name, *doc;
    Span span;
    const char *value; /* as text */
    const char *type;  /* "a number" */
    const char *range; /* "5..60", "[1, 2]"; NULL: any */
    PropUnit measure;  /* of the numbers in value and range, as its literals say; UNIT_NONE: they do not say */
} EvalParam;

/* A call of a macro below defaults that say an interior or a surface: where the macro itself is written above them, or elsewhere,
 * they do not reach into it. */
typedef struct EvalPassedBy {
    const struct EvalPassedBy *next; /* of an earlier call */
    Span call, defaults;             /* defaults: of its type's word */
    const NodeType *type;
    const char *macro;
} EvalPassedBy;

typedef struct EvalResult {
    EvalNode **
        nodes; /* at top level, in order of the text: placed nodes, NODE_SINGLE settings (merged, one each), and named declarations */
    size_t n_nodes;
    EvalNode **settings; /* the NODE_SINGLE ones, also when errors were reported: what was understood of them */
    size_t n_settings;
    double unit_m;            /* metres per scene unit */
    bool has_unit;            /* the scene's header names it */
    bool is_still;            /* nothing in the texts asks for the clock, the frame or the time */
    const char *const *files; /* paths that were read, the scene first */
    size_t n_files;
    EvalParam *params;
    size_t n_params;
    const EvalPassedBy *passed_by; /* NULL: none */
    uint64_t steps;                /* that it took; see EvalLimits */
    Buf printed;                   /* what print() said; buf_clear it */
} EvalResult;

/* Reads path ("-": standard input) and everything it includes, parses, evaluates, checks.
 * STATUS_OK, STATUS_SCENE with reports in diag, or STATUS_INPUT (the scene file itself cannot be
 * read) with *error. All memory is the arena's of diag, which must be guarded by the caller, and of options. */
ATTR_NODISCARD Status eval_scene(const char *path, const EvalOptions *options, Diag *diag, EvalResult *result,
                                 Error *error);
/* The same for text in memory (0-terminated), under a name for messages. */
ATTR_NODISCARD Status eval_text(const char *name, const char *text, size_t length, const EvalOptions *options,
                                Diag *diag, EvalResult *result, Error *error);

/* The property of that name, NULL when it was not set. The name must be in the node's table. */
const EvalProp *eval_prop(const EvalNode *node, const char *name);
/* Whether it was set, or has a default. */
bool eval_has_value(const EvalNode *node, const char *name);
/* The property's value, or else (also where a texture stands for it) the default text of its table row, read as a number
 * or truth. */
double eval_number(const EvalNode *node, const char *name);
bool eval_truth(const EvalNode *node, const char *name);
/* PROP_STRING, PROP_CHOICE: the value, else the default text, else NULL. */
const char *eval_word(const EvalNode *node, const char *name);
/* PROP_VECTOR2/3, PROP_COLOR: the value, else the default text ("<0, 0, 0>"). */
Vec3 eval_vector(const EvalNode *node, const char *name);

/* Resolves a file that a property names: beside the file in which span stands, then the include
 * folders, then MENISCUS_PATH and the data directory; honours confinement. NULL when there is none,
 * after reporting D_FILE_NOT_FOUND (or D_OUTSIDE_CONFINE) at span. The path is the arena's. */
const char *eval_find_file(const EvalOptions *options, Diag *diag, Span span, const char *name);
/* The same without a report: for names that may also be found elsewhere. */
const char *eval_seek_file(const EvalOptions *options, Diag *diag, Span span, const char *name);

#endif

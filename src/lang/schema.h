/* schema.h - the form of the tables by which the language knows nodes. The language itself knows no
 * node by name: the layer above hands it a Schema, and the checker, did-you-mean, the manual and the
 * editor files all read the same rows.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SCHEMA_H
#define MEN_SCHEMA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum PropKind {
    PROP_NUMBER,
    PROP_INTEGER, /* a number that must be whole */
    PROP_BOOL,
    PROP_STRING,
    PROP_CHOICE, /* a bare word or a string out of `choices` */
    PROP_VECTOR2,
    PROP_VECTOR3,
    PROP_COLOR,    /* a number becomes grey */
    PROP_SPECTRUM, /* a number, a colour, a vector of 3 (per unit, red green blue), or a term such as cauchy() */
    PROP_NUMBER_OR_TERM,
    PROP_TERM,    /* only a term, such as hg(.85) */
    PROP_NODE,    /* a node of type `choices` */
    PROP_NUMBERS, /* lists of these */
    PROP_VECTORS2,
    PROP_VECTORS3,
    PROP_VECTOR3_OR_LIST, /* one is as good as a list of one */
    PROP_NUMBER_LISTS,    /* a list of lists of numbers */
    PROP_VECTOR2_LISTS,   /* a list of vectors, or a list of such lists */
    PROP_STRINGS,         /* or bare words, when `choices` lists them */
    PROP_NODES,
    PROP_RAMP,    /* a list of numbers and colours, or of [position, number or colour] */
    PROP_FUNCTION /* the name of a def that is a function of a point: f(p), or f(x, y, z) */
} PropKind;

typedef enum PropUnit {
    UNIT_NONE,
    UNIT_LENGTH,
    UNIT_ANGLE,
    UNIT_TIME,
    UNIT_PER_LENGTH,
    UNIT_KELVIN,
    UNIT_ANY /* whatever the value is for */
} PropUnit;

enum PropFlags {
    PROP_REQUIRED = 1,
    PROP_SHAPE = 2,    /* changes the geometry: an instance that sets it shares nothing */
    PROP_OPEN_MIN = 4, /* min itself is not allowed */
    PROP_OPEN_MAX = 8,
    PROP_TEXTURE =
        16,         /* a node of a type with NODE_TEXTURE may stand in place of the value, or the name of a function */
    PROP_PLACE = 32 /* of a function: takes a place on a surface */
};

typedef struct PropType {
    const char *name;
    PropKind kind;
    PropUnit unit;
    unsigned flags;
    double min, max;          /* of a number, or of each element; -INFINITY, INFINITY for none */
    const char *choices;      /* "solid|liquid|gas", or the node type's name, or NULL */
    const char *default_text; /* in the language's own words; NULL: none, unset means absent */
    const char *doc;          /* one sentence, lower case, no full stop */
} PropType;

enum NodeFlags {
    NODE_PLACED = 1,     /* places something when it stands as a statement (sphere); else it only declares */
    NODE_TRANSFORMS = 2, /* takes transform statements (rotate, translate, ...) */
    NODE_CHILDREN = 4,   /* takes child nodes (group, union) */
    NODE_SINGLE = 8, /* settings: at most one per file; a later one adds to and overrides the earlier (render, film) */
    NODE_NAMED = 16, /* must be declared with a name (medium) */
    NODE_TEXTURE = 32, /* a value that depends on the place */
    NODE_FORMULA = 64  /* the texture whose first property is a function: what the name of one stands for */
};

typedef struct NodeType {
    const char *name;
    const PropType *props;
    size_t n_props;
    unsigned flags;
    const char *child_types; /* "a|b" for NODE_CHILDREN, NULL for any placed node */
    const char *doc;
} NodeType;

enum TermFlags {
    TERM_TABLE = 1, /* takes a list of vectors of 2, or the name of a file, instead of numbers: spectrum("file") */
    TERM_SCALES = 2 /* can be multiplied and divided by numbers */
};

/* A constructor of values that the language passes through unread: cauchy(a, b), hg(g), blackbody(k). */
typedef struct TermType {
    const char *name;
    unsigned min_args, max_args; /* numbers, at most 8 */
    unsigned flags;
    const char *doc;
} TermType;

typedef struct Schema {
    const NodeType *nodes;
    size_t n_nodes;
    const TermType *terms;
    size_t n_terms;
    /* scene text without header, evaluated first: `medium air { ... }`; its names may be shadowed */
    const char *prelude;
} Schema;

#endif

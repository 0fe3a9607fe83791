/* value.h - what an expression evaluates to. Values are small and copied; lists, texts, transforms and nodes behind
 * them never change once made, so sharing is safe. All memory is the arena's.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_VALUE_H
#define MEN_VALUE_H

#include "base/buf.h"
#include "lang/eval.h"

typedef enum ValueKind {
    VALUE_UNSET,  /* of a name whose declaration has not been reached; never the value of an expression */
    VALUE_POISON, /* its mistake has been reported: whatever is computed from it stays silent */
    VALUE_NONE,
    VALUE_NUMBER,
    VALUE_BOOL,
    VALUE_STRING,
    VALUE_VECTOR2,
    VALUE_VECTOR3,
    VALUE_VECTOR4,
    VALUE_COLOR,
    VALUE_TRANSFORM,
    VALUE_LIST,
    VALUE_RANGE,
    VALUE_NODE,
    VALUE_TERM,
    VALUE_RECORD
} ValueKind;

typedef struct Value Value;
typedef struct List List;
typedef struct Record Record;

/* first + i * step for i = 0 .. n - 1: never drifts */
typedef struct Range {
    double first, step;
    uint64_t n;
} Range;

struct Value {
    ValueKind kind;
    union {
        double number;
        bool truth;
        double v[4];
        Range range;
        const char *text;
        const List *list;
        const Affine *transform;
        const EvalNode *node;
        const EvalTerm *term;
        const Record *record;
    } as;
};

/* What a function gives back that has more than one answer: numbers and vectors of 3 under names. */
enum { RECORD_MAX_FIELDS = 4 };
typedef struct RecordType {
    const char *name;
    unsigned n_fields;
    struct {
        const char *name;
        ValueKind kind; /* VALUE_NUMBER or VALUE_VECTOR3 */
    } fields[RECORD_MAX_FIELDS];
} RecordType;
struct Record {
    const RecordType *type;
    double numbers[]; /* of one field after the other */
};
typedef enum RecordKind { RECORD_HIT, RECORD_PLACE, RECORD_BOUNDS, RECORD_COUNT } RecordKind;

/* Lists whose elements are all numbers, or all vectors of one size, or all colours are stored as plain doubles. */
struct List {
    size_t n;
    ValueKind element; /* of plain doubles; VALUE_NONE: items */
    unsigned width;    /* doubles per element */
    unsigned depth;    /* of lists within lists: 1 when there are none; what walks over values relies on its limit */
    const double *numbers;
    const Value *items;
    struct ListRoom *room; /* where they lie, with room for more; NULL: as many as there are */
};

static inline Value value_number(double x)
{
    return (Value){.kind = VALUE_NUMBER, .as.number = x};
}
static inline Value value_truth(bool x)
{
    return (Value){.kind = VALUE_BOOL, .as.truth = x};
}
static inline Value value_text(const char *x)
{
    return (Value){.kind = VALUE_STRING, .as.text = x};
}
static inline Value value_poison(void)
{
    return (Value){.kind = VALUE_POISON};
}
static inline Value value_none(void)
{
    return (Value){.kind = VALUE_NONE};
}
static inline Value value_vector3(double x, double y, double z)
{
    return (Value){.kind = VALUE_VECTOR3, .as.v = {x, y, z, 0}};
}
static inline Value value_color(double r, double g, double b)
{
    return (Value){.kind = VALUE_COLOR, .as.v = {r, g, b, 0}};
}
/* The number of doubles in a number, vector or colour; 0 for all else. */
static inline unsigned value_width(ValueKind kind)
{
    switch (kind) {
    case VALUE_NUMBER: return 1;
    case VALUE_VECTOR2: return 2;
    case VALUE_VECTOR3:
    case VALUE_COLOR: return 3;
    case VALUE_VECTOR4: return 4;
    default: return 0;
    }
}
static inline ValueKind value_vector_kind(unsigned width)
{
    return (ValueKind)(VALUE_VECTOR2 + (int)width - 2);
}

/* "a number", "a vector of 3", "a sphere" for messages */
const char *value_kind_text(ValueKind kind);
const char *value_describe(Arena *arena, const Value *value);

/* The elements of a list or range. */
size_t value_count(const Value *value);
Value value_element(const Value *value, size_t index);

/* The elements of both, which must be plain doubles of one kind or items; else false. What is behind the first one's, where nobody
 * else went on, is written there: a list that grows by an element at a time takes time and memory in proportion to its length. */
bool list_join(Arena *arena, const List *a, const List *b, Value *both);

/* A list that grows; begun zeroed. Plain doubles as long as the elements allow. */
typedef struct ListBuilder {
    Arena *arena;
    List list;
    double *numbers; /* capacity * width */
    Value *items;
    size_t capacity;
} ListBuilder;
void list_builder_add(ListBuilder *builder, const Value *value);
Value list_builder_finish(ListBuilder *builder);

/* A new record; numbers: those of all fields in a row. */
Value record_new(Arena *arena, RecordKind kind, const double *numbers);
/* false when the record has no such field */
bool record_field(const Record *record, const char *name, Value *field);
/* Does any type of record have such a field? */
bool record_knows(const char *name);

/* Of the same kind and equal in all; lists element by element, ranges as lists, nodes only where they are one. */
bool value_equal(const Value *a, const Value *b);
/* Appends the value as text, exactly, unless it is VALUE_ROUNDED for people, as print() does, without the noise of
 * rounding; VALUE_QUOTED: a text stands in quotes, as those within lists always do. */
enum { VALUE_QUOTED = 1, VALUE_ROUNDED = 2 };
void value_print(Buf *out, const Value *value, unsigned form);
/* A string of the language, in quotes and with its escapes. */
void value_print_text(Buf *out, const char *text);
bool value_is_finite(const Value *value);

#endif

/* value.c - lists, equality and text of values.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/value.h"

#include <math.h>
#include <string.h>

#include "base/num.h"

const char *value_kind_text(ValueKind kind)
{
    static const char *const texts[] = {
        [VALUE_UNSET] = "nothing yet",     [VALUE_POISON] = "a mistake",      [VALUE_NONE] = "none",
        [VALUE_NUMBER] = "a number",       [VALUE_BOOL] = "true or false",    [VALUE_STRING] = "a string",
        [VALUE_VECTOR2] = "a vector of 2", [VALUE_VECTOR3] = "a vector of 3", [VALUE_VECTOR4] = "a vector of 4",
        [VALUE_COLOR] = "a colour",        [VALUE_TRANSFORM] = "a transform", [VALUE_LIST] = "a list",
        [VALUE_RANGE] = "a range",         [VALUE_NODE] = "a node",           [VALUE_TERM] = "a term",
        [VALUE_RECORD] = "a record",
    };
    return texts[kind];
}

static bool starts_with_vowel(const char *word)
{
    return *word && strchr("aeiou", *word);
}

const char *value_describe(Arena *arena, const Value *value)
{
    const char *name = NULL;
    if (value->kind == VALUE_NODE) name = value->as.node->type->name;
    if (value->kind == VALUE_RECORD) return arena_format(arena, "what %s() found", value->as.record->type->name);
    if (value->kind == VALUE_TERM) return arena_format(arena, "%s(...)", value->as.term->type->name);
    if (!name) return value_kind_text(value->kind);
    return arena_format(arena, "%s %s", starts_with_vowel(name) ? "an" : "a", name);
}

/* ---- lists ---- */

size_t value_count(const Value *value)
{
    if (value->kind == VALUE_RANGE) return value->as.range.n;
    return value->kind == VALUE_LIST ? value->as.list->n : 0;
}

Value value_element(const Value *value, size_t index)
{
    if (value->kind == VALUE_RANGE) return value_number(value->as.range.first + (double)index * value->as.range.step);
    const List *list = value->as.list;
    if (list->element == VALUE_NONE) return list->items[index];
    Value element = {.kind = list->element};
    memcpy(element.as.v, list->numbers + index * list->width, list->width * sizeof(double));
    return element;
}

/* plain doubles become values, because an element of another kind came */
static void make_general(ListBuilder *builder)
{
    List *list = &builder->list;
    Value *items = ARENA_ARRAY(builder->arena, Value, builder->capacity);
    Value whole = {.kind = VALUE_LIST, .as.list = list};
    list->numbers = builder->numbers;
    for (size_t i = 0; i < list->n; i++) items[i] = value_element(&whole, i);
    list->element = VALUE_NONE;
    list->width = 0;
    builder->items = items;
}

static void grow_list(ListBuilder *builder)
{
    List *list = &builder->list;
    size_t capacity = builder->capacity ? builder->capacity * 2 : 8;
    if (list->element == VALUE_NONE) {
        Value *items = ARENA_ARRAY(builder->arena, Value, capacity);
        if (list->n) memcpy(items, builder->items, list->n * sizeof *items);
        builder->items = items;
    } else {
        double *numbers = ARENA_ARRAY(builder->arena, double, capacity * list->width);
        if (list->n) memcpy(numbers, builder->numbers, list->n * list->width * sizeof *numbers);
        builder->numbers = numbers;
    }
    builder->capacity = capacity;
}

void list_builder_add(ListBuilder *builder, const Value *value)
{
    List *list = &builder->list;
    if (list->n == 0) {
        list->width = value_width(value->kind);
        list->element = list->width ? value->kind : VALUE_NONE;
    }
    if (list->n == builder->capacity) grow_list(builder);
    if (value->kind == VALUE_LIST && value->as.list->depth > list->depth) list->depth = value->as.list->depth;
    if (list->element != VALUE_NONE && list->element != value->kind) make_general(builder);
    if (list->element == VALUE_NONE)
        builder->items[list->n++] = *value;
    else
        memcpy(builder->numbers + list->n++ * list->width, value->as.v, list->width * sizeof(double));
}

Value list_builder_finish(ListBuilder *builder)
{
    List *list = ARENA_NEW(builder->arena, List);
    *list = builder->list;
    list->numbers = builder->numbers;
    list->items = builder->items;
    list->depth++;
    return (Value){.kind = VALUE_LIST, .as.list = list};
}

/* What lists that begin alike have in common. */
typedef struct ListRoom {
    size_t used, capacity;
} ListRoom;

static size_t element_size(const List *list)
{
    return list->element == VALUE_NONE ? sizeof(Value) : list->width * sizeof(double);
}

/* Room for n elements, and twice as many for a list that has been joined before. */
static char *make_room(Arena *arena, const List *list, size_t n, ListRoom **room)
{
    *room = ARENA_NEW(arena, ListRoom);
    (*room)->capacity = list->room ? 2 * n : n;
    size_t size = (*room)->capacity * element_size(list);
    return list->element == VALUE_NONE ? (char *)ARENA_ARRAY(arena, Value, (*room)->capacity)
                                       : (char *)ARENA_ARRAY(arena, double, size / sizeof(double));
}

static const void *elements_of(const List *list)
{
    return list->element == VALUE_NONE ? (const void *)list->items : (const void *)list->numbers;
}

bool list_join(Arena *arena, const List *a, const List *b, Value *both)
{
    if (a->n == 0 || b->n == 0 || a->element != b->element) return false;
    size_t size = element_size(a), n = a->n + b->n;
    ListRoom *room = a->room;
    bool goes_on = room && room->used == a->n && room->capacity >= n;
    char *elements = goes_on ? (char *)(uintptr_t)elements_of(a) : make_room(arena, a, n, &room);
    if (!goes_on) memcpy(elements, elements_of(a), a->n * size);
    memcpy(elements + a->n * size, elements_of(b), b->n * size);
    room->used = n;
    List *list = ARENA_NEW(arena, List);
    *list = *a;
    list->n = n;
    if (b->depth > list->depth) list->depth = b->depth;
    if (a->element == VALUE_NONE)
        list->items = (const Value *)(void *)elements;
    else
        list->numbers = (const double *)(void *)elements;
    list->room = room;
    *both = (Value){.kind = VALUE_LIST, .as.list = list};
    return true;
}

/* ---- records ---- */

static const RecordType record_types[RECORD_COUNT] = {
    [RECORD_HIT] = {"hit", 3, {{"point", VALUE_VECTOR3}, {"normal", VALUE_VECTOR3}, {"distance", VALUE_NUMBER}}},
    [RECORD_PLACE] = {"scatter", 2, {{"point", VALUE_VECTOR3}, {"normal", VALUE_VECTOR3}}},
    [RECORD_BOUNDS] =
        {"bounds",
         4,
         {{"min", VALUE_VECTOR3}, {"max", VALUE_VECTOR3}, {"center", VALUE_VECTOR3}, {"size", VALUE_VECTOR3}}},
};

static size_t record_width(const RecordType *type)
{
    size_t n = 0;
    for (unsigned i = 0; i < type->n_fields; i++) n += value_width(type->fields[i].kind);
    return n;
}

Value record_new(Arena *arena, RecordKind kind, const double *numbers)
{
    size_t bytes = record_width(&record_types[kind]) * sizeof *numbers;
    Record *record = arena_alloc(arena, sizeof *record + bytes);
    record->type = &record_types[kind];
    memcpy(record->numbers, numbers, bytes);
    return (Value){.kind = VALUE_RECORD, .as.record = record};
}

/* The i-th field, whose numbers begin at `at`. */
static Value field_value(const Record *record, unsigned i, size_t at)
{
    Value field = {.kind = record->type->fields[i].kind};
    memcpy(field.as.v, record->numbers + at, value_width(field.kind) * sizeof(double));
    return field;
}

bool record_field(const Record *record, const char *name, Value *field)
{
    size_t at = 0;
    for (unsigned i = 0; i < record->type->n_fields; i++) {
        if (strcmp(record->type->fields[i].name, name) == 0) {
            *field = field_value(record, i, at);
            return true;
        }
        at += value_width(record->type->fields[i].kind);
    }
    return false;
}

bool record_knows(const char *name)
{
    for (unsigned kind = 0; kind < RECORD_COUNT; kind++)
        for (unsigned i = 0; i < record_types[kind].n_fields; i++)
            if (strcmp(record_types[kind].fields[i].name, name) == 0) return true;
    return false;
}

/* ---- comparison ---- */

static bool equal_numbers(const double *a, const double *b, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!(a[i] == b[i])) return false;
    return true;
}

static bool equal_affine(const Affine *a, const Affine *b)
{
    return equal_numbers(&a->m[0][0], &b->m[0][0], 9) && a->t.x == b->t.x && a->t.y == b->t.y && a->t.z == b->t.z;
}

static bool equal_terms(const EvalTerm *a, const EvalTerm *b)
{
    if (a->type != b->type || a->n_args != b->n_args || !equal_numbers(a->args, b->args, a->n_args)) return false;
    if (a->scale != b->scale || a->n_pairs != b->n_pairs || !equal_numbers(a->pairs, b->pairs, 2 * a->n_pairs))
        return false;
    return a->text == b->text || (a->text && b->text && strcmp(a->text, b->text) == 0);
}

static bool equal_lists(const Value *a, const Value *b)
{
    size_t n = value_count(a);
    if (n != value_count(b)) return false;
    if (a->kind == VALUE_RANGE && b->kind == VALUE_RANGE) /* may be far too long to walk through */
        return n == 0 || (a->as.range.first == b->as.range.first && (n == 1 || a->as.range.step == b->as.range.step));
    for (size_t i = 0; i < n; i++) {
        Value element_a = value_element(a, i), element_b = value_element(b, i);
        if (!value_equal(&element_a, &element_b)) return false;
    }
    return true;
}

bool value_equal(const Value *a, const Value *b)
{
    bool sequences =
        (a->kind == VALUE_LIST || a->kind == VALUE_RANGE) && (b->kind == VALUE_LIST || b->kind == VALUE_RANGE);
    if (sequences) return equal_lists(a, b);
    if (a->kind != b->kind) return false;
    switch (a->kind) {
    case VALUE_BOOL: return a->as.truth == b->as.truth;
    case VALUE_STRING: return strcmp(a->as.text, b->as.text) == 0;
    case VALUE_TRANSFORM: return equal_affine(a->as.transform, b->as.transform);
    case VALUE_NODE: return a->as.node == b->as.node;
    case VALUE_TERM: return equal_terms(a->as.term, b->as.term);
    case VALUE_RECORD:
        return a->as.record->type == b->as.record->type &&
               equal_numbers(a->as.record->numbers, b->as.record->numbers, record_width(a->as.record->type));
    case VALUE_NONE: return true;
    default: return equal_numbers(a->as.v, b->as.v, value_width(a->kind));
    }
}

bool value_is_finite(const Value *value)
{
    unsigned width = value_width(value->kind);
    for (unsigned i = 0; i < width; i++)
        if (!isfinite(value->as.v[i])) return false;
    return true;
}

/* ---- text ---- */

static void print_number(Buf *out, double number, unsigned form)
{
    char text[NUM_TEXT_SIZE];
    buf_add_bytes(out, text, form & VALUE_ROUNDED ? num_print_rounded(number, text) : num_print(number, text));
}

static void print_numbers(Buf *out, const char *opening, const double *numbers, size_t n, const char *closing,
                          unsigned form)
{
    buf_add(out, opening);
    for (size_t i = 0; i < n; i++) {
        if (i) buf_add(out, ", ");
        print_number(out, numbers[i], form);
    }
    buf_add(out, closing);
}

void value_print_text(Buf *out, const char *text)
{
    buf_add(out, "\"");
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') buf_add(out, "\\");
        if (*text == '\n')
            buf_add(out, "\\n");
        else if (*text == '\t')
            buf_add(out, "\\t");
        else if ((unsigned char)*text < ' ' || *text == 0x7f)
            buf_format(out, "\\u{%x}", (unsigned)(unsigned char)*text);
        else
            buf_add_bytes(out, text, 1);
    }
    buf_add(out, "\"");
}

static void print_transform(Buf *out, const Affine *a, unsigned form)
{
    double numbers[12];
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++) numbers[column * 3 + row] = a->m[row][column];
    numbers[9] = a->t.x;
    numbers[10] = a->t.y;
    numbers[11] = a->t.z;
    print_numbers(out, "matrix(", numbers, 12, ")", form);
}

static void print_term(Buf *out, const EvalTerm *term, unsigned form)
{
    buf_add(out, term->type->name);
    if (term->text) {
        buf_add(out, "(");
        value_print_text(out, term->text);
        buf_add(out, ")");
    } else if (term->pairs) {
        for (size_t i = 0; i < term->n_pairs; i++) {
            buf_add(out, i ? ", " : "([");
            print_numbers(out, "<", term->pairs + 2 * i, 2, ">", form);
        }
        buf_add(out, "])");
    } else {
        print_numbers(out, "(", term->args, term->n_args, ")", form);
    }
    if (term->scale == 1) return;
    buf_add(out, " * ");
    print_number(out, term->scale, form);
}

static void print_record(Buf *out, const Record *record, unsigned form)
{
    size_t at = 0;
    buf_format(out, "%s(", record->type->name);
    for (unsigned i = 0; i < record->type->n_fields; i++) {
        Value field = field_value(record, i, at);
        buf_format(out, "%s%s = ", i ? ", " : "", record->type->fields[i].name);
        value_print(out, &field, form | VALUE_QUOTED);
        at += value_width(field.kind);
    }
    buf_add(out, ")");
}

static void print_list(Buf *out, const Value *value, unsigned form)
{
    size_t n = value_count(value);
    buf_add(out, "[");
    for (size_t i = 0; i < n; i++) {
        Value element = value_element(value, i);
        if (i) buf_add(out, ", ");
        value_print(out, &element, form | VALUE_QUOTED);
    }
    buf_add(out, "]");
}

void value_print(Buf *out, const Value *value, unsigned form)
{
    switch (value->kind) {
    case VALUE_UNSET:
    case VALUE_POISON: buf_add(out, "?"); break;
    case VALUE_NONE: buf_add(out, "none"); break;
    case VALUE_NUMBER: print_number(out, value->as.number, form); break;
    case VALUE_BOOL: buf_add(out, value->as.truth ? "true" : "false"); break;
    case VALUE_STRING:
        if (form & VALUE_QUOTED)
            value_print_text(out, value->as.text);
        else
            buf_add(out, value->as.text);
        break;
    case VALUE_VECTOR2:
    case VALUE_VECTOR3:
    case VALUE_VECTOR4: print_numbers(out, "<", value->as.v, value_width(value->kind), ">", form); break;
    case VALUE_COLOR: print_numbers(out, "rgb(", value->as.v, 3, ")", form); break;
    case VALUE_TRANSFORM: print_transform(out, value->as.transform, form); break;
    case VALUE_LIST: print_list(out, value, form); break;
    case VALUE_RANGE: {
        const Range *range = &value->as.range;
        print_number(out, range->first, form);
        buf_add(out, "..");
        print_number(out, range->n ? range->first + (double)(range->n - 1) * range->step : range->first, form);
        if (range->step != 1) {
            buf_add(out, " by ");
            print_number(out, range->step, form);
        }
        break;
    }
    case VALUE_NODE:
        buf_add(out, value->as.node->type->name);
        if (value->as.node->name) buf_format(out, " %s", value->as.node->name);
        break;
    case VALUE_TERM: print_term(out, value->as.term, form); break;
    case VALUE_RECORD: print_record(out, value->as.record, form); break;
    }
}

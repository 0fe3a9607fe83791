/* flat.c - writes an evaluated scene as text.
 *
 * Nodes that something refers to get a name: media, prototypes, a surface that two objects share. They are written
 * just before the first statement that needs them. A prototype is written without its place, and each placing of it as an
 * instance with the whole transform, which was composed when the scene ran: composing it anew could round it
 * differently. Nodes that nothing refers to are written where they stand. Functions that are values become defs.
 * What is placed is called as in the scene, so that it varies as it does there: several of one name are told apart by numbers
 * that count for nothing (eval.h), and an instance whose name comes from a prototype between gets that one, too.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/flat.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "lang/flat_function.h"
#include "lang/resolve.h"
#include "lang/value.h"

enum { LINE_WIDTH = 110, INDENT = 2, DEEPEST_BLOCK = 90 };

/* A prototype under another name, which only its instances have. */
typedef struct Alias {
    const char *declared, *name; /* in the scene, and here */
    struct Alias *next;
} Alias;

/* A node that something refers to. */
typedef struct Shared {
    const EvalNode *node;
    const char *name; /* NULL: it stands at the only place that refers to it */
    uint32_t references;
    bool prototype; /* something is an instance of it */
    bool stands;    /* as a statement at the top of the scene */
    bool written;
    Alias *aliases;
} Shared;

typedef struct Flat {
    const FlatOptions *options;
    Diag *diag;
    Arena *arena;
    Buf *out;
    Shared *shared; /* open addressing by the node's address; NULL node: free */
    size_t n_shared, capacity;
    FlatFunctions functions;
    SymbolTable symbols; /* names that are taken have a binding in it */
    unsigned depth;      /* of blocks around */
    bool too_deep;
} Flat;

/* ---- what refers to what ---- */

static Shared *shared_slot(Shared *table, size_t capacity, const EvalNode *node)
{
    size_t at = (size_t)hash_u64((uint64_t)(uintptr_t)node) & (capacity - 1);
    while (table[at].node && table[at].node != node) at = (at + 1) & (capacity - 1);
    return &table[at];
}

static Shared *shared_find(const Flat *flat, const EvalNode *node)
{
    if (!flat->capacity) return NULL;
    Shared *shared = shared_slot(flat->shared, flat->capacity, node);
    return shared->node ? shared : NULL;
}

static Shared *shared_add(Flat *flat, const EvalNode *node)
{
    if (flat->n_shared * 2 >= flat->capacity) {
        size_t capacity = flat->capacity ? flat->capacity * 2 : 64;
        Shared *table = ARENA_ARRAY(flat->arena, Shared, capacity);
        for (size_t i = 0; i < flat->capacity; i++)
            if (flat->shared[i].node) *shared_slot(table, capacity, flat->shared[i].node) = flat->shared[i];
        flat->shared = table;
        flat->capacity = capacity;
    }
    Shared *shared = shared_slot(flat->shared, flat->capacity, node);
    if (!shared->node) {
        shared->node = node;
        flat->n_shared++;
    }
    return shared;
}

static const EvalNode *origin_of(const EvalNode *node)
{
    while (node->prototype) node = node->prototype;
    return node;
}

/* Whether a property's value is one node. */
static bool is_node(const EvalProp *prop)
{
    return prop->textured || prop->type->kind == PROP_NODE;
}

static void collect(Flat *flat, const EvalNode *node);

static void collect_reference(Flat *flat, const EvalNode *node, bool prototype)
{
    Shared *shared = shared_add(flat, node);
    shared->prototype |= prototype;
    if (shared->references++ == 0) collect(flat, node);
}

static void collect(Flat *flat, const EvalNode *node)
{
    for (size_t i = 0; i < node->n_props; i++) {
        const EvalProp *prop = &node->props[i];
        if (is_node(prop)) collect_reference(flat, prop->as.node, false);
        for (size_t k = 0; prop->type->kind == PROP_NODES && k < prop->as.list.n; k++)
            collect_reference(flat, prop->as.list.nodes[k], false);
    }
    if (node->prototype) {
        collect_reference(flat, origin_of(node), true);
        return; /* its children are the prototype's */
    }
    for (size_t i = 0; i < node->n_children; i++) collect(flat, node->children[i]);
}

/* ---- names ---- */

/* A symbol of the table is taken when its binding is not NULL; which binding does not matter. */
static Binding taken_mark;

static void take_name(Flat *flat, const char *name)
{
    symbol_of(&flat->symbols, name, strlen(name))->binding = &taken_mark;
}

static bool is_prelude(const Flat *flat, const EvalNode *node)
{
    const Source *source = &flat->options->sources->sources[node->span.source];
    return !source->path && node->name && strcmp(source->name, "prelude") == 0;
}

/* What a name must not hide: words of the language, and what the prelude declares. */
static void take_words(Flat *flat)
{
    const char *word;
    for (size_t i = 0; (word = language_word_at(flat->options->eval->schema, i)) != NULL; i++) take_name(flat, word);
    for (size_t i = 0; i < flat->capacity; i++)
        if (flat->shared[i].node && is_prelude(flat, flat->shared[i].node)) take_name(flat, flat->shared[i].node->name);
}

/* The name itself, or with the first number behind it that makes it new. */
static const char *new_name(Flat *flat, const char *wanted)
{
    const char *name = wanted;
    for (unsigned n = 2;; n++) {
        if (!symbol_of(&flat->symbols, name, strlen(name))->binding) break;
        name = arena_format(flat->arena, "%.*s__%u", (int)eval_word_length(wanted), wanted, n);
    }
    take_name(flat, name);
    return name;
}

static const char *new_def_name(void *context, const char *wanted)
{
    return new_name(context, wanted);
}

/* In order of the text, so that the first of a name keeps it; what was declared comes before what only is used. */
static void name_shared(Flat *flat, const EvalNode *node)
{
    Shared *shared = shared_find(flat, node);
    if (!shared || shared->name) return;
    if (is_prelude(flat, node)) {
        shared->name = node->name;
        shared->written = true;
    } else if (node->name || shared->references > 1 || shared->prototype) {
        shared->name = new_name(flat, node->name ? node->name : node->type->name);
    }
}

static bool is_same_word(const char *a, const char *b)
{
    size_t length = eval_word_length(a);
    return length == eval_word_length(b) && memcmp(a, b, length) == 0;
}

/* What an instance without a name is called after, where that is neither the node that all of it comes from nor its type; else NULL. */
static const char *word_between(const EvalNode *node)
{
    const EvalNode *origin = origin_of(node), *named = node;
    while (named != origin && !named->name) named = named->prototype;
    if (node->name || named == origin || (origin->name && is_same_word(named->name, origin->name))) return NULL;
    return named->name;
}

static const Alias *find_alias(const Shared *origin, const char *declared)
{
    const Alias *alias = origin->aliases;
    while (alias && strcmp(alias->declared, declared) != 0) alias = alias->next;
    return alias;
}

/* ---- values ---- */

static void print_value(Buf *out, Value value)
{
    value_print(out, &value, VALUE_QUOTED);
}

static void print_vector(Buf *out, ValueKind kind, const double *numbers)
{
    Value value = {.kind = kind};
    memcpy(value.as.v, numbers, value_width(kind) * sizeof(double));
    print_value(out, value);
}

static size_t line_start(const Buf *out)
{
    size_t at = out->length;
    while (at > 0 && out->text[at - 1] != '\n') at--;
    return at;
}

/* Of the present line, in steps. */
static unsigned line_depth(const Buf *out)
{
    size_t at = line_start(out), begin = at;
    while (at < out->length && out->text[at] == ' ') at++;
    return (unsigned)(at - begin) / INDENT;
}

static bool behind_brace(const Buf *out)
{
    return out->text[out->length - 1] == '{';
}

static void new_line(Flat *flat, unsigned depth)
{
    buf_add(flat->out, "\n");
    buf_add_repeat(flat->out, ' ', (size_t)depth * INDENT);
}

/* "[a, b, c]", in lines */
static void print_numbers(Flat *flat, const double *numbers, size_t n, ValueKind kind)
{
    unsigned width = value_width(kind);
    size_t line = line_start(flat->out);
    unsigned depth = line_depth(flat->out) + 1;
    buf_add(flat->out, "[");
    for (size_t i = 0; i < n; i++) {
        if (i > 0) buf_add(flat->out, ",");
        if (flat->out->length - line > LINE_WIDTH) {
            new_line(flat, depth);
            line = flat->out->length;
        } else if (i > 0) {
            buf_add(flat->out, " ");
        }
        print_vector(flat->out, kind, numbers + i * width);
    }
    buf_add(flat->out, "]");
}

static void print_number_lists(Flat *flat, const EvalProp *prop, ValueKind kind)
{
    const double *numbers = prop->as.list.numbers;
    unsigned depth = line_depth(flat->out) + 1;
    buf_add(flat->out, "[");
    for (size_t i = 0; i < prop->as.list.n_lists; i++) {
        if (i > 0) {
            buf_add(flat->out, ",");
            new_line(flat, depth);
        }
        print_numbers(flat, numbers, prop->as.list.lengths[i], kind);
        numbers += prop->as.list.lengths[i] * value_width(kind);
    }
    buf_add(flat->out, "]");
}

/* The whole path of a file that the scene names, so that the text can be kept anywhere. */
static void print_file(Flat *flat, Span span, const char *name)
{
    const char *found = eval_find_file(flat->options->eval, flat->diag, span, name);
    char *whole = found ? file_real_path(found) : NULL;
    print_value(flat->out, value_text(whole ? whole : name));
    free(whole);
}

static bool is_file(const Flat *flat, const PropType *type)
{
    for (const char *const *name = flat->options->files; *name; name++)
        if (strcmp(*name, type->name) == 0) return true;
    return false;
}

static void print_spectrum(Flat *flat, const EvalProp *prop)
{
    Buf *out = flat->out;
    switch (prop->as.spectrum.form) {
    case SPECTRUM_NUMBER: print_value(out, value_number(prop->as.spectrum.rgb[0])); return;
    case SPECTRUM_COLOR: print_vector(out, VALUE_COLOR, prop->as.spectrum.rgb); return;
    case SPECTRUM_VECTOR: print_vector(out, VALUE_VECTOR3, prop->as.spectrum.rgb); return;
    case SPECTRUM_TERM: break;
    }
    const EvalTerm *term = prop->as.spectrum.term;
    if (!term->text) {
        print_value(out, (Value){.kind = VALUE_TERM, .as.term = term});
        return;
    }
    buf_format(out, "%s(", term->type->name);
    print_file(flat, term->span, term->text);
    buf_add(out, ")");
    if (term->scale == 1) return;
    buf_add(out, " * ");
    print_value(out, value_number(term->scale));
}

static void print_ramp(Flat *flat, const EvalProp *prop)
{
    buf_add(flat->out, "[");
    for (size_t i = 0; i < prop->as.list.n; i++) {
        const double *stop = prop->as.list.numbers + 4 * i;
        bool grey = stop[1] == stop[2] && stop[1] == stop[3];
        buf_add(flat->out, i > 0 ? ", [" : "[");
        print_value(flat->out, value_number(stop[0]));
        buf_add(flat->out, ", ");
        print_vector(flat->out, prop->as.list.n_lists > 0 || !grey ? VALUE_COLOR : VALUE_NUMBER, stop + 1);
        buf_add(flat->out, "]");
    }
    buf_add(flat->out, "]");
}

static bool is_identity(const Affine *map);
static void print_transform(Flat *flat, const Affine *map);
static void print_body(Flat *flat, const EvalNode *node, const EvalNode *origin, bool placed);

/* A node as a value: its name, or what it is an instance of, or all of it. What has a name is declared without its
 * place. */
static void print_reference(Flat *flat, const EvalNode *node)
{
    const Shared *shared = shared_find(flat, node);
    if (!shared->name) {
        const EvalNode *origin = node->prototype ? origin_of(node) : NULL;
        buf_add(flat->out, origin ? shared_find(flat, origin)->name : node->type->name);
        print_body(flat, node, origin, true);
        return;
    }
    buf_add(flat->out, shared->name);
    if (is_identity(&node->transform)) return;
    buf_add(flat->out, " {");
    print_transform(flat, &node->transform);
    buf_add(flat->out, " }");
}

static void print_list(Flat *flat, const EvalProp *prop)
{
    buf_add(flat->out, "[");
    for (size_t i = 0; i < prop->as.list.n; i++) {
        if (i > 0) buf_add(flat->out, ", ");
        if (prop->type->kind == PROP_NODES)
            print_reference(flat, prop->as.list.nodes[i]);
        else
            print_value(flat->out, value_text(prop->as.list.texts[i]));
    }
    buf_add(flat->out, "]");
}

static void print_prop_value(Flat *flat, const EvalProp *prop)
{
    Buf *out = flat->out;
    const char *name;
    if (prop->textured) {
        print_reference(flat, prop->as.node);
        return;
    }
    switch (prop->type->kind) {
    case PROP_NUMBER:
    case PROP_INTEGER: print_value(out, value_number(prop->as.number)); break;
    case PROP_BOOL: print_value(out, value_truth(prop->as.truth)); break;
    case PROP_STRING:
        if (is_file(flat, prop->type))
            print_file(flat, prop->span, prop->as.text);
        else
            print_value(out, value_text(prop->as.text));
        break;
    case PROP_CHOICE: buf_add(out, prop->as.text); break;
    case PROP_VECTOR2: print_vector(out, VALUE_VECTOR2, prop->as.vector); break;
    case PROP_VECTOR3: print_vector(out, VALUE_VECTOR3, prop->as.vector); break;
    case PROP_COLOR: print_vector(out, VALUE_COLOR, prop->as.vector); break;
    case PROP_SPECTRUM:
    case PROP_NUMBER_OR_TERM:
    case PROP_TERM: print_spectrum(flat, prop); break;
    case PROP_NODE: print_reference(flat, prop->as.node); break;
    case PROP_NUMBERS: print_numbers(flat, prop->as.list.numbers, prop->as.list.n, VALUE_NUMBER); break;
    case PROP_VECTORS2: print_numbers(flat, prop->as.list.numbers, prop->as.list.n, VALUE_VECTOR2); break;
    case PROP_VECTORS3:
    case PROP_VECTOR3_OR_LIST: print_numbers(flat, prop->as.list.numbers, prop->as.list.n, VALUE_VECTOR3); break;
    case PROP_FUNCTION:
        name = flat_function(&flat->functions, prop->as.function); /* written before, by declare_functions */
        buf_add(out, name ? name : "none");
        break;
    case PROP_NUMBER_LISTS: print_number_lists(flat, prop, VALUE_NUMBER); break;
    case PROP_VECTOR2_LISTS: print_number_lists(flat, prop, VALUE_VECTOR2); break;
    case PROP_RAMP: print_ramp(flat, prop); break;
    case PROP_STRINGS:
    case PROP_NODES: print_list(flat, prop); break;
    }
}

/* ---- nodes ---- */

static const EvalProp *find_prop(const EvalNode *node, const PropType *type)
{
    for (size_t i = 0; i < node->n_props; i++)
        if (node->props[i].type == type) return &node->props[i];
    return NULL;
}

/* An instance takes a value over with the place in the text where it was written. */
static bool inherited(const EvalProp *prop, const EvalNode *origin)
{
    const EvalProp *same = origin ? find_prop(origin, prop->type) : NULL;
    return same && span_equal(same->span, prop->span);
}

/* depth: of a line within the node. */
static void print_prop_name(Flat *flat, const char *name, unsigned depth, size_t *line)
{
    if (flat->out->length - *line > LINE_WIDTH && !behind_brace(flat->out)) {
        new_line(flat, depth);
        *line = line_start(flat->out);
    } else {
        buf_add(flat->out, behind_brace(flat->out) ? " " : "  ");
    }
    buf_format(flat->out, "%s = ", name);
}

static void print_props(Flat *flat, const EvalNode *node, const EvalNode *origin, unsigned depth)
{
    size_t line = line_start(flat->out);
    for (size_t i = 0; i < node->n_props; i++) {
        if (inherited(&node->props[i], origin)) continue;
        print_prop_name(flat, node->props[i].type->name, depth, &line);
        print_prop_value(flat, &node->props[i]);
        line = line_start(flat->out);
    }
    for (size_t i = 0; origin && i < origin->n_props; i++) { /* unset with none */
        if (find_prop(node, origin->props[i].type)) continue;
        print_prop_name(flat, origin->props[i].type->name, depth, &line);
        buf_add(flat->out, "none");
    }
}

static bool is_identity(const Affine *map)
{
    Affine identity = affine_identity();
    return memcmp(map->m, identity.m, sizeof map->m) == 0 && map->t.x == 0 && map->t.y == 0 && map->t.z == 0;
}

static void print_transform(Flat *flat, const Affine *map)
{
    Affine identity = affine_identity();
    if (is_identity(map)) return;
    buf_add(flat->out, behind_brace(flat->out) ? " " : "  ");
    const double t[3] = {map->t.x, map->t.y, map->t.z};
    if (memcmp(map->m, identity.m, sizeof map->m) == 0) {
        buf_add(flat->out, "translate(");
    } else {
        buf_add(flat->out, "matrix(");
        for (int i = 0; i < 3; i++) {
            const double column[3] = {map->m[0][i], map->m[1][i], map->m[2][i]};
            print_vector(flat->out, VALUE_VECTOR3, column);
            buf_add(flat->out, ", ");
        }
    }
    print_vector(flat->out, VALUE_VECTOR3, t);
    buf_add(flat->out, ")");
}

static void print_statement(Flat *flat, const EvalNode *node);

/* Behind word [name]: "{ ... }". origin: what word stands for when it is a prototype; placed: with the transform. */
static void print_body(Flat *flat, const EvalNode *node, const EvalNode *origin, bool placed)
{
    /* of the line that the brace is on: a value may begin on a line that goes on with another node */
    unsigned depth = line_depth(flat->out);
    buf_add(flat->out, " {");
    print_props(flat, node, origin, depth + 1);
    if (placed) print_transform(flat, &node->transform);
    flat->depth++;
    if (flat->depth > DEEPEST_BLOCK) flat->too_deep = true;
    for (size_t i = 0; !origin && !flat->too_deep && i < node->n_children; i++) {
        new_line(flat, depth + 1);
        print_statement(flat, node->children[i]);
    }
    flat->depth--;
    if (!origin && node->n_children)
        new_line(flat, depth);
    else
        buf_add(flat->out, " ");
    buf_add(flat->out, "}");
}

static void print_node(Flat *flat, const EvalNode *node, const char *word, const char *name)
{
    buf_add(flat->out, word);
    if (name) buf_format(flat->out, " %s", name);
    print_body(flat, node, NULL, true);
}

/* A node that is placed, or that only sets something. */
static void print_statement(Flat *flat, const EvalNode *node)
{
    const Shared *own = shared_find(flat, node), *origin = node->prototype ? shared_find(flat, origin_of(node)) : NULL;
    if (origin || (own && own->prototype)) {
        const Shared *word = origin ? origin : own;
        const char *between = origin ? word_between(node) : NULL;
        buf_add(flat->out, between ? find_alias(word, between)->name : word->name);
        if (node->name)
            buf_format(flat->out, " %s", own && origin && own->name ? own->name : new_name(flat, node->name));
        print_body(flat, node, word->node, true);
        return;
    }
    print_node(flat, node, node->type->name,
               own && own->name ? own->name
               : node->name     ? new_name(flat, node->name)
                                : NULL);
}

/* ---- what must stand before a statement ---- */

static void declare_needs(Flat *flat, const EvalNode *node, bool whole);
static void declare_functions(Flat *flat, const EvalNode *node);

static void declare(Flat *flat, const EvalNode *node)
{
    name_shared(flat, node);
    Shared *shared = shared_find(flat, node);
    if (shared->written) return;
    shared->written = true; /* before its own needs: nothing refers to itself */
    declare_needs(flat, node, shared->name != NULL);
    declare_functions(flat, node);
    if (!shared->name) return; /* it stands where it is needed */
    bool declares = (shared->stands || !shared->prototype) && node->type->flags & NODE_NAMED;
    if (declares)
        buf_format(flat->out, "%s %s", node->type->name, shared->name);
    else
        buf_format(flat->out, "let %s = %s", shared->name, node->type->name);
    print_body(flat, node, NULL, false);
    buf_add(flat->out, "\n");
}

/* Also under the name between, where an instance that is placed has its name from there. */
static void declare_origin(Flat *flat, const EvalNode *node, bool placed)
{
    declare(flat, origin_of(node));
    const char *between = placed ? word_between(node) : NULL;
    Shared *origin = shared_find(flat, origin_of(node));
    if (!between || find_alias(origin, between)) return;
    Alias *alias = ARENA_ARRAY(flat->arena, Alias, 1);
    *alias = (Alias){between, new_name(flat, between), origin->aliases};
    origin->aliases = alias;
    buf_format(flat->out, "let %s = %s { }\n", alias->name, origin->name);
}

/* whole: with all of its properties and children, and not as an instance of a prototype. */
static void declare_needs(Flat *flat, const EvalNode *node, bool whole)
{
    for (size_t i = 0; i < node->n_props; i++) {
        const EvalProp *prop = &node->props[i];
        if (is_node(prop)) declare(flat, prop->as.node);
        for (size_t k = 0; prop->type->kind == PROP_NODES && k < prop->as.list.n; k++)
            declare(flat, prop->as.list.nodes[k]);
    }
    if (node->prototype && !whole) {
        declare_origin(flat, node, node->type->flags & NODE_PLACED);
        return;
    }
    for (size_t i = 0; i < node->n_children; i++) declare_needs(flat, node->children[i], false);
}

/* Once all nodes are declared that it needs: theirs come first when the text is read again, too. */
static void declare_functions(Flat *flat, const EvalNode *node)
{
    for (size_t i = 0; i < node->n_props; i++)
        if (node->props[i].type->kind == PROP_FUNCTION)
            (void)flat_function(&flat->functions, node->props[i].as.function);
    for (size_t i = 0; !node->prototype && i < node->n_children; i++) declare_functions(flat, node->children[i]);
}

static void print_top(Flat *flat, const EvalNode *node)
{
    const Shared *shared = shared_find(flat, node);
    bool placed = node->type->flags & (NODE_PLACED | NODE_SINGLE);
    if (is_prelude(flat, node)) return;
    if (shared && (placed ? shared->prototype : (node->type->flags & NODE_NAMED) != 0)) declare(flat, node);
    if (!placed && shared) return; /* it only declares: that is done, or will be where it is needed first */
    declare_needs(flat, node, false);
    declare_functions(flat, node);
    print_statement(flat, node);
    buf_add(flat->out, "\n");
}

/* ---- all ---- */

Status flat_print(const EvalResult *scene, const FlatOptions *options, Diag *diag, Buf *out, Error *error)
{
    Buf statements = {0}; /* all functions stand before them */
    Flat flat = {.options = options, .diag = diag, .arena = diag->arena, .out = &statements};
    uint32_t n_errors = diag->n_errors;
    flat.functions = (FlatFunctions){.diag = diag, .out = out, .new_name = new_def_name, .context = &flat};
    symbol_table_init(&flat.symbols, flat.arena);
    const unsigned stands = NODE_PLACED | NODE_SINGLE;
    for (size_t i = 0; i < scene->n_nodes; i++)
        if (scene->nodes[i]->type->flags & stands) collect(&flat, scene->nodes[i]);
    for (size_t i = 0; i < scene->n_nodes; i++) /* what only declares counts where it is referred to, if it is */
        if (!(scene->nodes[i]->type->flags & stands) && !shared_find(&flat, scene->nodes[i]))
            collect(&flat, scene->nodes[i]);
    for (size_t i = 0; i < scene->n_nodes; i++) {
        Shared *shared = shared_find(&flat, scene->nodes[i]);
        if (shared) shared->stands = true;
    }
    take_words(&flat);
    for (size_t i = 0; i < scene->n_nodes; i++) name_shared(&flat, scene->nodes[i]);
    buf_format(out, "meniscus 1.0 unit %s\n", unit_of_length(scene->unit_m));
    for (size_t i = 0; i < scene->n_nodes && !flat.too_deep && !statements.failed; i++)
        print_top(&flat, scene->nodes[i]);
    buf_add_bytes(out, buf_text(&statements), statements.length);
    if (statements.failed) out->failed = true;
    buf_clear(&statements);
    if (out->failed) return fail(error, STATUS_NOMEM, "out of memory");
    if (flat.too_deep)
        return fail(error, STATUS_SCENE, "nodes within nodes, deeper than %d levels: too deep for a text",
                    DEEPEST_BLOCK);
    return diag->n_errors > n_errors ? fail(error, STATUS_SCENE, "the scene has errors") : STATUS_OK;
}

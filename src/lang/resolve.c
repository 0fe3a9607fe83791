/* resolve.c - scopes, files and statements.
 * A scope is a stack of declarations; each symbol points at its innermost one, so that looking a name up takes no
 * search. Files are resolved one after the other, those that a file imports before itself, each seeing only the
 * predeclared names and those of the prelude from outside.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/file.h"
#include "lang/resolve.h"

#include <math.h>
#include <string.h>

#include "base/suggest.h"
#include "lang/builtin.h"
#include "lang/habits.h"
#include "lang/schema_find.h"

const char *const predeclared_names[PREDECLARED_COUNT] = {"clock", "frame", "frames", "time", "x", "y", "z", "pi"};

const char *language_word_at(const Schema *schema, size_t i)
{
    if (i < schema->n_nodes) return schema->nodes[i].name;
    i -= schema->n_nodes;
    if (i < schema->n_terms) return schema->terms[i].name;
    i -= schema->n_terms;
    if (i < builtin_count()) return builtin_at(i)->name;
    i -= builtin_count();
    if (i < PREDECLARED_COUNT) return predeclared_names[i];
    i -= PREDECLARED_COUNT;
    if (i == 0) return "preset";
    return keyword_at(i - 1) ? keyword_at(i - 1)->word : NULL;
}

struct Scope {
    Scope *outer;
    Binding *bindings;
    Stmt *at; /* being resolved */
};

/* ---- scopes ---- */

void scope_begin(Resolver *resolver)
{
    Scope *scope = ARENA_NEW(resolver->arena, Scope);
    scope->outer = resolver->scope;
    resolver->scope = scope;
}

void binding_use(Binding *binding)
{
    binding->used = true;
    if (binding->import) binding->import->as.import.used = true;
}

/* A file at whose top nothing is placed, set or run is there for others, which use its functions and set its parameters. */
static bool is_library(const Schema *schema, const File *file)
{
    for (const Stmt *stmt = file->block->first; stmt; stmt = stmt->next) {
        const NodeExpr *node = stmt->kind == STMT_NODE ? stmt->as.node : NULL;
        const NodeType *type = node && node->path.n == 1 ? schema_node(schema, node->path.names[0]->text) : NULL;
        bool declares = type ? !(type->flags & (NODE_PLACED | NODE_SINGLE))
                             : stmt->kind == STMT_EMPTY || stmt->kind == STMT_BIND || stmt->kind == STMT_PARAM ||
                                   stmt->kind == STMT_DEF || stmt->kind == STMT_DEFAULTS ||
                                   (stmt->kind == STMT_IMPORT && !stmt->as.import.include);
        if (!declares) return false;
    }
    return true;
}

/* Of a file of which nothing is used. */
static void report_unused_file(Resolver *resolver, Stmt *import)
{
    const char *text = import->as.import.text;
    const Symbol *name = import->as.import.name;
    Diagnostic *report =
        name ? diag_report(resolver->diag, D_UNUSED_NAME, import->as.import.name_span, "'%s' is never used", name->text)
             : diag_report(resolver->diag, D_UNUSED_NAME, import->as.import.text_span,
                           "nothing that \"%s\" declares is used", text);
    if (!is_library(resolver->schema, import->as.import.file))
        diag_hint(resolver->diag, report, "'use' brings names alone; to place what the file places: include \"%s\"",
                  text);
    import->as.import.used = true; /* it is one mistake, of however many names */
}

/* The property by which objects take a node of the type, as interior = glass. */
static const char *taker_of(const Schema *schema, const NodeType *type)
{
    for (size_t i = 0; i < schema->n_nodes; i++) {
        const NodeType *placed = &schema->nodes[i];
        for (size_t k = 0; (placed->flags & NODE_PLACED) && k < placed->n_props; k++) {
            const PropType *prop = &placed->props[k];
            if (prop->kind == PROP_NODE && prop->choices && choice_allows(prop->choices, type->name)) return prop->name;
        }
    }
    return NULL;
}

static void report_unused(Resolver *resolver, const Binding *binding)
{
    const char *name = binding->symbol->text;
    const Binding *outer = binding->shadowed;
    if (binding->import) {
        if (!binding->import->as.import.used) report_unused_file(resolver, binding->import);
        return;
    }
    if (binding->param) {
        diag_report(resolver->diag, D_UNUSED_NAME, binding->span, "param '%s' is never used: to set it changes nothing",
                    name);
        return;
    }
    Diagnostic *report = diag_report(resolver->diag, D_UNUSED_NAME, binding->span, "'%s' is never used", name);
    const char *taker = binding->declares ? taker_of(resolver->schema, binding->declares) : NULL;
    if (taker) diag_hint(resolver->diag, report, "what is to be of it says so: %s = %s", taker, name);
    if (binding->prototype)
        diag_hint(resolver->diag, report, "behind 'let' it is a prototype; to place it write: %s { }", name);
    if (!outer || !outer->has_span || outer->kind != BINDING_SLOT || outer->span.source != binding->span.source) return;
    diag_hint(resolver->diag, report,
              "to change the '%s' outside of this block write: var %s = ... there, %s := ... here", name, name, name);
}

void scope_end(Resolver *resolver)
{
    for (Binding *binding = resolver->scope->bindings; binding; binding = binding->next_in_scope) {
        binding->symbol->binding = binding->shadowed;
        bool meant = binding->used || binding->symbol->sought || binding->symbol->text[0] == '_';
        if (binding->warns && !meant) report_unused(resolver, binding);
    }
    resolver->scope = resolver->scope->outer;
}

static void report_again(Resolver *resolver, const Binding *old, Span span)
{
    Diagnostic *report =
        diag_report(resolver->diag, D_DUPLICATE_NAME, span, "'%s' is declared twice in this block", old->symbol->text);
    if (old->has_span) diag_note(resolver->diag, report, old->span, "first declared here");
    diag_hint(resolver->diag, report, "take another name: media, objects, values and functions share them");
}

/* Whatever else has the name. */
static Binding *scope_bind(Resolver *resolver, Symbol *symbol, BindingKind kind, Span span)
{
    Binding *old = symbol->binding;
    bool again = old && old->scope == resolver->scope;
    if (again) old->used = true;
    Binding *binding = ARENA_NEW(resolver->arena, Binding);
    *binding = (Binding){.shadowed = old,
                         .next_in_scope = resolver->scope->bindings,
                         .scope = resolver->scope,
                         .symbol = symbol,
                         .kind = kind,
                         .has_span = true,
                         .span = span,
                         .level = resolver->level,
                         .used = again};
    resolver->scope->bindings = binding;
    symbol->binding = binding;
    return binding;
}

static Binding *scope_declare(Resolver *resolver, Symbol *symbol, BindingKind kind, Span span)
{
    const Binding *old = symbol->binding;
    if (old && old->scope == resolver->scope) report_again(resolver, old, span);
    return scope_bind(resolver, symbol, kind, span);
}

static uint32_t new_slot(Resolver *resolver)
{
    return resolver->level == 0 ? resolver->n_globals++ : resolver->n_slots++;
}

Slot slot_of(const Resolver *resolver, const Binding *binding)
{
    Slot slot = {.kind = EXPR_GLOBAL, .index = binding->index};
    if (binding->level == 0) return slot;
    slot.hops = resolver->level - binding->level;
    slot.kind = slot.hops ? EXPR_OUTER : EXPR_LOCAL;
    return slot;
}

Slot scope_declare_slot(Resolver *resolver, Symbol *symbol, Span span)
{
    Binding *binding = scope_declare(resolver, symbol, BINDING_SLOT, span);
    binding->index = new_slot(resolver);
    return slot_of(resolver, binding);
}

/* what a statement declares; NULL when it declares nothing */
static Symbol *declared_by(const Stmt *stmt, Span *span)
{
    switch (stmt->kind) {
    case STMT_BIND:
    case STMT_PARAM: *span = stmt->as.bind.name_span; return stmt->as.bind.name;
    case STMT_NODE: *span = stmt->as.node->name_span; return stmt->as.node->name;
    case STMT_IMPORT: *span = stmt->as.import.name_span; return stmt->as.import.name;
    default: return NULL;
    }
}

bool note_later_declaration(Resolver *resolver, Diagnostic *report, const Symbol *symbol)
{
    Span span;
    for (const Scope *scope = resolver->scope; scope; scope = scope->outer)
        for (Stmt *stmt = scope->at; stmt; stmt = stmt->next) {
            Symbol *declared = declared_by(stmt, &span);
            if (declared != symbol) continue;
            declared->sought = true;
            diag_note(resolver->diag, report, span, "it is declared only here: names are known from there on");
            return true;
        }
    return false;
}

void suggest_later(Resolver *resolver, Diagnostic *report, const Symbol *wrong)
{
    Span span;
    for (const Scope *scope = resolver->scope; scope; scope = scope->outer)
        for (const Stmt *stmt = scope->at; stmt; stmt = stmt->next) {
            Symbol *symbol = declared_by(stmt, &span);
            const char *text = symbol ? symbol->text : NULL;
            if (!text || !suggest_nearest(wrong->text, &text, 1)) continue;
            symbol->sought = true;
            diag_hint(resolver->diag, report, "did you mean '%s'?", symbol->text);
            diag_note(resolver->diag, report, span, "it is declared only here");
            return;
        }
}

/* ---- statements ---- */

static void resolve_stmts(Resolver *resolver, Stmt *first);

/* Is this in a block, and not at the top of a file? */
static bool is_within(const Resolver *resolver)
{
    return resolver->scope->outer && resolver->scope->outer->outer;
}

/* Whether what is declared here and not used is reported. What stands at the top of a file may be meant for others. */
static bool warns_here(const Resolver *resolver, bool of_library)
{
    if (is_within(resolver)) return true;
    return resolver->warns_unused && !(of_library && resolver->library_itself);
}

static void declare_defs(Resolver *resolver, Stmt *first)
{
    for (Stmt *stmt = first; stmt; stmt = stmt->next) {
        if (stmt->kind != STMT_DEF) continue;
        Binding *binding = scope_declare(resolver, stmt->as.def->name, BINDING_DEF, stmt->as.def->span);
        binding->def = stmt->as.def;
        binding->warns = warns_here(resolver, true);
        stmt->as.def->level = resolver->level;
    }
}

void resolve_block(Resolver *resolver, Block *block)
{
    if (!block) return;
    scope_begin(resolver);
    resolve_stmts(resolver, block->first);
    scope_end(resolver);
}

static void resolve_bind(Resolver *resolver, Stmt *stmt)
{
    if (stmt->as.bind.value) resolve_expr(resolver, stmt->as.bind.value);
    if (stmt->as.bind.range) resolve_expr(resolver, stmt->as.bind.range);
    stmt->as.bind.slot = scope_declare_slot(resolver, stmt->as.bind.name, stmt->as.bind.name_span);
    Binding *binding = stmt->as.bind.name->binding;
    binding->variable = stmt->as.bind.variable;
    binding->constant = stmt->kind == STMT_BIND && !stmt->as.bind.variable;
    binding->param = stmt->kind == STMT_PARAM;
    binding->warns = warns_here(resolver, binding->param);
    const Expr *value = stmt->as.bind.value;
    const NodeType *type = value && value->kind == EXPR_NODE ? value->as.node->type : NULL;
    binding->prototype = type && type->flags & NODE_PLACED;
    stmt->as.bind.at_top = !is_within(resolver);
}

static void resolve_assign(Resolver *resolver, Stmt *stmt)
{
    resolve_expr(resolver, stmt->as.bind.value);
    const Symbol *symbol = stmt->as.bind.name;
    Binding *binding = symbol->binding;
    Diag *diag = resolver->diag;
    if (!binding) {
        Diagnostic *report = diag_report(diag, D_UNKNOWN_NAME, stmt->span, "unknown name '%s'", symbol->text);
        suggest_visible(resolver, report, symbol, false, false);
        stmt->kind = STMT_EMPTY;
    } else if (binding->poison) {
        stmt->kind = STMT_EMPTY;
        resolver->n_unchanged++;
    } else if (binding->kind != BINDING_SLOT || !binding->variable) {
        Diagnostic *report = diag_report(diag, D_NOT_ASSIGNABLE, stmt->span, "'%s' is no var", symbol->text);
        if (binding->constant) diag_hint(diag, report, "declare it by: var %s = ...", symbol->text);
        if (binding->has_span) diag_note(diag, report, binding->span, "declared here");
        stmt->kind = STMT_EMPTY;
        resolver->n_unchanged++;
    } else {
        stmt->as.bind.slot = slot_of(resolver, binding);
    }
}

/* May the property hold bare words? Then they stay names until it is checked. */
static bool takes_words(const PropType *prop)
{
    return !prop || prop->kind == PROP_CHOICE || (prop->kind == PROP_STRINGS && prop->choices);
}

static void resolve_word(Resolver *resolver, Expr *expr)
{
    Symbol *symbol = expr->as.name.symbol;
    if (symbol->binding && symbol->binding->kind == BINDING_SLOT)
        resolve_expr(resolver, expr);
    else
        expr->as.name.nearest = nearest_visible(resolver, symbol);
}

/* The name is declared all the same: that it is unknown further down would be the same mistake. */
static void declare_poison(Resolver *resolver, Symbol *symbol, Span span)
{
    if (symbol->binding && symbol->binding->has_span) return; /* else it would be one that the language declares */
    scope_declare_slot(resolver, symbol, span);
    symbol->binding->poison = true;
}

/* "medium = glass { ... }" and "glass = medium { ... }"; false: neither. */
static bool report_free_node(Resolver *resolver, const Stmt *stmt)
{
    const Expr *value = stmt->as.prop.value;
    Symbol *left = stmt->as.prop.name;
    if (value->kind != EXPR_NODE || value->as.node->path.n != 1 || left->binding) return false;
    Symbol *right = value->as.node->path.names[0];
    bool type_first = schema_node(resolver->schema, left->text) && !schema_node(resolver->schema, right->text);
    bool type_last = schema_node(resolver->schema, right->text) && !schema_node(resolver->schema, left->text);
    if (!type_last && (!type_first || right->binding)) return false;
    Symbol *name = type_first ? right : left;
    Diagnostic *report =
        diag_report(resolver->diag, D_MISPLACED, stmt->span, "a node has its name behind its type, without '='");
    diag_hint(resolver->diag, report, "write: %s %s { ... }", (type_first ? left : right)->text, name->text);
    declare_poison(resolver, name, stmt->span);
    return true;
}

/* Whether it is in the block of what takes none, which is told so as a whole. */
static bool is_in_refused_block(const Resolver *resolver)
{
    if (!resolver->call) return false;
    const Expr *call = resolver->call->as.call.call;
    return call->kind != EXPR_CALL_DEF || !call->as.call.to.def->block;
}

/* Often a declaration, or a change of a var, as other languages write them. */
static void report_free_property(Resolver *resolver, const Stmt *stmt)
{
    if (is_in_refused_block(resolver)) {
        declare_poison(resolver, stmt->as.prop.name, stmt->span);
        return;
    }
    if (report_free_node(resolver, stmt)) return;
    const char *name = stmt->as.prop.name->text;
    const Binding *binding = stmt->as.prop.name->binding;
    Diagnostic *report = diag_report(resolver->diag, D_MISPLACED, stmt->span, "property '%s' outside of a node", name);
    declare_poison(resolver, stmt->as.prop.name, stmt->span);
    if (binding && binding->kind == BINDING_SLOT && binding->variable)
        diag_hint(resolver->diag, report, "a var is changed by %s := ...", name);
    else if (binding && binding->poison)
        diag_hint(resolver->diag, report, "a name that changes is declared by var %s = ..., and changed by %s := ...",
                  name, name);
    else if (binding && binding->constant)
        diag_hint(resolver->diag, report,
                  "'%s' does not change; declare it by var %s = ..., and change it by %s := ...", name, name, name);
    else if (resolver->call)
        diag_hint(resolver->diag, report, "a macro takes it as an argument, if it has one for it: %s(%s = ...)",
                  resolver->call->as.call.path.names[resolver->call->as.call.path.n - 1]->text, name);
    else
        diag_hint(resolver->diag, report, "a name is declared by let %s = ...", name);
}

/* A name that is none. */
static bool is_unknown_word(const Expr *value)
{
    return value->kind == EXPR_NAME && !value->as.name.symbol->binding;
}

/* Is "p" one of its words? */
static bool names_point(const char *text, size_t length)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
    for (size_t i = 0; i < length; i++)
        if (text[i] == 'p' && (i == 0 || !strchr(letters, text[i - 1])) &&
            (i + 1 == length || !strchr(letters, text[i + 1])))
            return true;
    return false;
}

/* What stands where only the name of a function does: a computation, as a function's body would be, or a call of one. */
static bool report_formula(Resolver *resolver, const PropType *prop, const Expr *value)
{
    enum { LONGEST_FORMULA = 60 };
    bool call = value->kind == EXPR_CALL;
    if (!call && (value->kind < EXPR_NEGATE || value->kind > EXPR_OR)) return false;
    Span span = value->span;
    const char *text = resolver->diag->sources->sources[span.source].text + span.begin;
    size_t length = span.end - span.begin;
    const Symbol *callee =
        call && value->as.call.callee->kind == EXPR_NAME ? value->as.call.callee->as.name.symbol : NULL;
    Diagnostic *report = diag_report(resolver->diag, D_WRONG_TYPE, span, "'%s' wants the name of a function, not %s",
                                     prop->name, call ? "a call" : "a computation");
    if (callee && callee->binding && callee->binding->kind == BINDING_DEF)
        diag_hint(resolver->diag, report, "write: %s = %s", prop->name, callee->text);
    else if (callee && !builtin_find(callee->text))
        diag_hint(resolver->diag, report, "write: def %s(x, y, z) = ..., further up, and %s = %s", callee->text,
                  prop->name, callee->text);
    else if (length > LONGEST_FORMULA || memchr(text, '\n', length))
        diag_hint(resolver->diag, report, "write: def f(x, y, z) = ..., further up, and %s = f", prop->name);
    else
        diag_hint(resolver->diag, report, "write: def f(%s) = %.*s, further up, and %s = f",
                  names_point(text, length) ? "p" : "x, y, z", (int)length, text, prop->name);
    return true;
}

static void resolve_function_prop(Resolver *resolver, const PropType *prop, Expr *value)
{
    Symbol *symbol = value->kind == EXPR_NAME ? value->as.name.symbol : NULL;
    bool only = prop->kind == PROP_FUNCTION, unknown = symbol && !symbol->binding && !symbol->unknown;
    if (only && report_formula(resolver, prop, value)) {
        value->kind = EXPR_POISON;
        return;
    }
    resolve_function(resolver, value);
    if (!only || !unknown || !symbol->unknown) return;
    if (builtin_find(symbol->text))
        diag_hint(resolver->diag, symbol->unknown, "write: def f(x, y, z) = %s(x), further up, and %s = f",
                  symbol->text, prop->name);
    else if (!symbol->unknown->hint)
        diag_hint(resolver->diag, symbol->unknown, "write: def %s(x, y, z) = ..., further up", symbol->text);
}

/* The property of the node that another one wants, by which it takes a function: density = volume { function = f }; NULL:
 * none. */
static const PropType *function_within(const Resolver *resolver, const PropType *prop)
{
    const NodeType *wanted =
        prop && prop->kind == PROP_NODE && prop->choices ? schema_node(resolver->schema, prop->choices) : NULL;
    for (size_t i = 0; wanted && i < wanted->n_props; i++)
        if (wanted->props[i].kind == PROP_FUNCTION) return &wanted->props[i];
    return NULL;
}

/* The name of a function, most likely meant for a pattern, where all is of one colour, or for a node that takes one. */
static bool report_pattern(Resolver *resolver, const NodeType *type, const PropType *prop, Expr *value)
{
    const char *pattern = prop ? habit_pattern(type->name, prop->name) : NULL;
    const PropType *within = function_within(resolver, prop);
    const Symbol *symbol = value->kind == EXPR_NAME ? value->as.name.symbol : NULL;
    Binding *binding = symbol ? symbol->binding : NULL;
    if ((!pattern && !within) || !binding || binding->kind != BINDING_DEF || !binding->def->body) return false;
    const char *wants = pattern ? "the same everywhere" : arena_format(resolver->arena, "wants a %s", prop->choices);
    Diagnostic *report = diag_report(resolver->diag, D_WRONG_TYPE, value->span, "'%s' is a function, and '%s' %s",
                                     symbol->text, prop->name, wants);
    if (pattern)
        diag_hint(resolver->diag, report, "%s", habit_fill(resolver->arena, pattern, symbol->text));
    else
        diag_hint(resolver->diag, report, "write: %s = %s { %s = %s }", prop->name, prop->choices, within->name,
                  symbol->text);
    binding_use(binding);
    value->kind = EXPR_POISON;
    return true;
}

/* "exposure = auto" of a node that has an auto_exposure */
static bool report_automatic(Resolver *resolver, const NodeType *type, const PropType *prop, Expr *value)
{
    const char *word = is_unknown_word(value) ? value->as.name.symbol->text : "";
    if (!prop || (strcmp(word, "auto") != 0 && strcmp(word, "automatic") != 0)) return false;
    const PropType *automatic = schema_prop(type, arena_format(resolver->arena, "auto_%s", prop->name));
    if (!automatic) return false;
    Diagnostic *report = diag_report(resolver->diag, D_UNKNOWN_NAME, value->span, "unknown name '%s'", word);
    diag_hint(resolver->diag, report, "write: %s = true", automatic->name);
    value->kind = EXPR_POISON;
    return true;
}

static void resolve_prop(Resolver *resolver, Stmt *stmt)
{
    Expr *value = stmt->as.prop.value;
    const NodeType *type = resolver->context_type;
    const PropType *prop = NULL;
    if (resolver->context == CONTEXT_FREE) {
        report_free_property(resolver, stmt);
        resolver->n_unchanged++;
    } else if (resolver->context == CONTEXT_NODE && type) {
        prop = schema_prop(type, stmt->as.prop.name->text);
        if (!prop) {
            report_unknown_property(resolver->diag, stmt->span, type, stmt->as.prop.name->text, value, false);
            resolver->context_node->has_unknown = true;
        }
    }
    bool misplaced = resolver->context == CONTEXT_FREE || (type && !prop);
    bool words = resolver->context == CONTEXT_NODE && !misplaced && takes_words(prop);
    if (resolver->context == CONTEXT_NODE && prop && (prop->kind == PROP_FUNCTION || prop->flags & PROP_TEXTURE)) {
        resolver->for_texture = prop->flags & PROP_TEXTURE;
        resolve_function_prop(resolver, prop, value);
        resolver->for_texture = false;
    } else if (resolver->context == CONTEXT_NODE &&
               (report_pattern(resolver, type, prop, value) || report_automatic(resolver, type, prop, value))) {
        /* reported */
    } else if (misplaced && is_unknown_word(value)) {
        value->kind = EXPR_POISON; /* "pattern = checker", where there is no such property: most likely a word of it */
    } else if (words && value->kind == EXPR_NAME) {
        resolve_word(resolver, value);
    } else if (words && value->kind == EXPR_LIST) {
        for (uint32_t i = 0; i < value->as.list.n; i++) {
            Expr *item = value->as.list.items[i];
            if (item->kind == EXPR_NAME)
                resolve_word(resolver, item);
            else
                resolve_expr(resolver, item);
        }
    } else {
        const bool name_for_text = prop && prop->kind == PROP_STRING && value->kind == EXPR_NAME;
        resolver->word_prop = words || name_for_text ? prop : NULL;
        resolve_expr(resolver, value);
        resolver->word_prop = NULL;
    }
    if (misplaced) stmt->kind = STMT_EMPTY;
}

static void resolve_call_stmt(Resolver *resolver, Stmt *stmt)
{
    resolve_expr(resolver, stmt->as.call.call);
    if (!stmt->as.call.block) return;
    NodeContext context = resolver->context;
    const NodeType *type = resolver->context_type;
    const Stmt *outer = resolver->call;
    resolver->call = stmt;
    resolver->context = CONTEXT_FREE;
    resolver->context_type = NULL;
    resolve_block(resolver, stmt->as.call.block);
    resolver->call = outer;
    resolver->context = context;
    resolver->context_type = type;
}

static void resolve_formals(Resolver *resolver, Def *def)
{
    for (uint32_t i = 0; i < def->n_formals; i++) {
        Formal *formal = &def->formals[i];
        if (formal->fallback) resolve_expr(resolver, formal->fallback);
        formal->slot = scope_declare_slot(resolver, formal->name, formal->span);
    }
}

static void resolve_def(Resolver *resolver, Def *def)
{
    Resolver outer = *resolver;
    resolver->level++;
    resolver->n_slots = 0;
    resolver->def = def;
    resolver->context = CONTEXT_FREE;
    resolver->context_type = NULL;
    Binding *binding = def->name->binding;
    bool used = binding && binding->used;
    scope_begin(resolver);
    resolve_formals(resolver, def);
    if (def->body) resolve_expr(resolver, def->body);
    if (def->block) resolve_stmts(resolver, def->block->first);
    scope_end(resolver);
    if (binding) binding->used = used; /* that it calls itself does not count */
    def->n_slots = resolver->n_slots;
    resolver->level = outer.level;
    resolver->n_slots = outer.n_slots;
    resolver->def = outer.def;
    resolver->context = outer.context;
    resolver->context_type = outer.context_type;
}

static bool is_number(const Expr *expr, double *number)
{
    if (expr->kind == EXPR_NEGATE && is_number(expr->as.op.a, number)) {
        *number = -*number;
        return true;
    }
    if (expr->kind != EXPR_CONSTANT || expr->as.constant.value.kind != VALUE_NUMBER) return false;
    *number = expr->as.constant.value.as.number;
    return true;
}

/* "5..1", written so: a range goes up where nothing else is said. */
static void warn_of_empty_range(Resolver *resolver, const Expr *range)
{
    double first, last;
    if (range->kind != EXPR_RANGE || range->as.op.c || !is_number(range->as.op.a, &first) ||
        !is_number(range->as.op.b, &last) || first <= last)
        return;
    Diagnostic *report =
        diag_report(resolver->diag, D_EMPTY_RANGE, range->span, "a range from %g up to %g is empty", first, last);
    diag_hint(resolver->diag, report, "write: %g..%g by -1", first, last);
}

static void resolve_for(Resolver *resolver, Stmt *stmt)
{
    warn_of_empty_range(resolver, stmt->as.loop.source);
    resolve_expr(resolver, stmt->as.loop.source);
    scope_begin(resolver);
    stmt->as.loop.slot = scope_declare_slot(resolver, stmt->as.loop.name, stmt->as.loop.name_span);
    resolve_stmts(resolver, stmt->as.loop.block->first);
    scope_end(resolver);
}

/* A chain of else-ifs is walked in a loop: it may be long. */
static void resolve_branch(Resolver *resolver, Stmt *stmt)
{
    for (;;) {
        resolve_expr(resolver, stmt->as.branch.condition);
        resolve_block(resolver, stmt->as.branch.then);
        Block *otherwise = stmt->as.branch.otherwise;
        if (!otherwise) return;
        if (!otherwise->first || otherwise->first->kind != STMT_IF || otherwise->first->next) {
            resolve_block(resolver, otherwise);
            return;
        }
        stmt = otherwise->first;
    }
}

/* A loop in which something was to change and does not would run for ever: it is not run. */
static void resolve_while(Resolver *resolver, Stmt *stmt)
{
    unsigned n_unchanged = resolver->n_unchanged;
    resolve_expr(resolver, stmt->as.branch.condition);
    resolve_block(resolver, stmt->as.branch.then);
    if (resolver->n_unchanged > n_unchanged) stmt->kind = STMT_EMPTY;
}

static Symbol *defaults_symbol(Resolver *resolver, const NodeType *type)
{
    Symbol **symbol = &resolver->defaults[type - resolver->schema->nodes];
    const char *name = arena_format(resolver->arena, "defaults %s", type->name);
    if (!*symbol) *symbol = symbol_of(resolver->symbols, name, strlen(name));
    return *symbol;
}

void resolve_defaults_of(Resolver *resolver, NodeExpr *node)
{
    const Symbol *symbol = resolver->defaults[node->type - resolver->schema->nodes];
    const Binding *binding = symbol ? symbol->binding : NULL;
    if (!binding) return;
    node->has_defaults = true;
    node->defaults = slot_of(resolver, binding);
}

static bool says_matter(const NodeExpr *defaults)
{
    for (const Stmt *stmt = defaults->block->first; stmt; stmt = stmt->next)
        if (stmt->kind == STMT_PROP &&
            (strcmp(stmt->as.prop.name->text, "interior") == 0 || strcmp(stmt->as.prop.name->text, "surface") == 0))
            return true;
    return false;
}

void resolve_passed_by(Resolver *resolver, Span call, const Def *macro)
{
    for (size_t row = 0; row < resolver->schema->n_nodes; row++) {
        const Symbol *symbol = resolver->defaults[row];
        const Binding *binding = symbol ? symbol->binding : NULL;
        while (binding && !says_matter(binding->defaults)) binding = binding->shadowed;
        if (!binding) continue;
        EvalPassedBy *passed = ARENA_NEW(resolver->arena, EvalPassedBy);
        *passed = (EvalPassedBy){.next = resolver->passed_by,
                                 .call = call,
                                 .defaults = binding->defaults->path.span,
                                 .type = &resolver->schema->nodes[row],
                                 .macro = macro->name->text};
        resolver->passed_by = passed;
    }
}

/* Of what stands behind 'defaults': a name of the scene, or one that is not known. */
static void report_no_type(Resolver *resolver, Span span, const Symbol *name)
{
    Diag *diag = resolver->diag;
    const Binding *binding = name->binding;
    if (!binding || !binding->has_span) {
        Diagnostic *report = diag_report(diag, D_UNKNOWN_NODE, span, "unknown node type '%s'", name->text);
        suggest_visible(resolver, report, name, false, true);
        return;
    }
    const Def *def = binding->kind == BINDING_DEF ? binding->def : NULL;
    Diagnostic *report = diag_report(diag, D_UNKNOWN_NODE, span, "'%s' is %s, not a type of nodes", name->text,
                                     def && def->block ? "a macro" : "a name");
    if (def && def->block && def->n_formals)
        diag_hint(diag, report, "the parameters of a macro have their defaults in its def: def %s(%s = ...)",
                  name->text, def->formals[0].name->text);
    else
        diag_hint(diag, report, "defaults are of types, such as sphere; what is declared says itself what it is");
    diag_note(diag, report, binding->span, "'%s' is declared here", name->text);
}

/* The values are kept in a slot of a name that no scene can write; each later node of the type in the block refers
 * to it. A second defaults in the same block starts from the first. */
static void resolve_defaults(Resolver *resolver, Stmt *stmt)
{
    NodeExpr *node = stmt->as.node;
    Symbol *type = node->path.names[0];
    const NodeType *node_type = schema_node(resolver->schema, type->text);
    if (!node_type) {
        report_no_type(resolver, node->path.span, type);
        stmt->kind = STMT_EMPTY;
        return;
    }
    resolve_node(resolver, node, true);
    Symbol *symbol = defaults_symbol(resolver, node_type);
    Binding *binding = ARENA_NEW(resolver->arena, Binding);
    *binding = (Binding){.shadowed = symbol->binding,
                         .next_in_scope = resolver->scope->bindings,
                         .scope = resolver->scope,
                         .symbol = symbol,
                         .kind = BINDING_SLOT,
                         .level = resolver->level,
                         .defaults = node,
                         .used = true};
    binding->index = new_slot(resolver);
    resolver->scope->bindings = binding;
    symbol->binding = binding;
    node->prototype = slot_of(resolver, binding);
}

/* ---- files in use ---- */

/* What already has the name of an export in this block, and is something else; NULL: nothing. */
static const Binding *rival_of(const Resolver *resolver, const Export *export)
{
    const Binding *target = export->binding, *old = export->symbol->binding;
    if (!old || old->scope != resolver->scope) return NULL;
    bool same = old->kind == target->kind && old->index == target->index && old->def == target->def &&
                old->module == target->module && old->level == target->level;
    return same ? NULL : old; /* the same thing may come by two ways */
}

/* "'v', 'w' and 3 more": the exports whose rival is from that file */
static const char *list_rivals(const Resolver *resolver, const File *file, const File *rival, Arena *arena)
{
    enum { MOST_NAMED = 3 };
    const char *list = "";
    uint32_t n = 0;
    for (uint32_t i = file->n_exports; i-- > 0;) {
        const Binding *old = rival_of(resolver, &file->exports[i]);
        if (!old || old->from != rival || n++ >= MOST_NAMED) continue;
        list = arena_format(arena, "%s%s'%s'", list, *list ? ", " : "", file->exports[i].symbol->text);
    }
    return n > MOST_NAMED ? arena_format(arena, "%s and %u more", list, n - MOST_NAMED) : list;
}

/* A name for the file: that of its text, where it is free. */
static const char *module_name(const Resolver *resolver, const char *path)
{
    const char *name = file_name(path);
    size_t n = strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_-0123456789");
    bool plain = n > 0 && strcmp(name + n, ".mns") == 0 && !strchr("-0123456789", name[0]);
    char *word = arena_copy_text(resolver->arena, name, n);
    for (char *at = word; *at; at++)
        if (*at == '-') *at = '_';
    const Symbol *symbol = plain ? symbol_of(resolver->symbols, word, n) : NULL;
    return symbol && !symbol->binding && !symbol->keyword ? symbol->text : "NAME";
}

/* Files that share names share many: one report for each two of them. */
static void report_rivals(Resolver *resolver, const Stmt *stmt, const File *file)
{
    for (uint32_t i = file->n_exports; i-- > 0;) {
        const Binding *old = rival_of(resolver, &file->exports[i]);
        bool known = !old || !old->from;
        for (uint32_t k = i + 1; k < file->n_exports && !known; k++) {
            const Binding *other = rival_of(resolver, &file->exports[k]);
            known = other && other->from == old->from;
        }
        if (known) continue;
        const char *text = stmt->as.import.text;
        const char *other = resolver->diag->sources->sources[old->span.source].text + old->span.begin;
        Diagnostic *report = diag_report(
            resolver->diag, D_DUPLICATE_NAME, stmt->as.import.text_span, "\"%s\" declares %s, and so does %.*s", text,
            list_rivals(resolver, file, old->from, resolver->arena), (int)(old->span.end - old->span.begin), other);
        diag_note(resolver->diag, report, old->span, "which is used here");
        const char *name = module_name(resolver, text);
        diag_hint(resolver->diag, report, "give it a name: use \"%s\" as %s, and write %s.%s", text, name, name,
                  file->exports[i].symbol->text);
    }
}

static void declare_alias(Resolver *resolver, const Export *export, Stmt *stmt)
{
    Span span = stmt->as.import.text_span;
    const Binding *target = export->binding, *old = export->symbol->binding, *rival = rival_of(resolver, export);
    if (!rival && old && old->scope == resolver->scope) return;
    if (rival && !rival->from) report_again(resolver, rival, span);
    Binding *binding = scope_bind(resolver, export->symbol, target->kind, span);
    binding->level = target->level;
    binding->index = target->index;
    binding->variable = target->variable;
    binding->def = target->def;
    binding->declares = target->declares;
    binding->module = target->module;
    binding->poison = target->poison;
    binding->from = stmt->as.import.file;
    binding->import = stmt->as.import.include ? NULL : stmt;
    binding->warns = binding->import && warns_here(resolver, false);
}

static void resolve_import(Resolver *resolver, Stmt *stmt)
{
    File *file = stmt->as.import.file;
    if (!file) {
        stmt->kind = STMT_EMPTY;
        return;
    }
    if (stmt->as.import.name) {
        Binding *binding = scope_declare(resolver, stmt->as.import.name, BINDING_MODULE, stmt->as.import.name_span);
        binding->module = file;
        binding->import = stmt;
        binding->warns = warns_here(resolver, false);
        return;
    }
    report_rivals(resolver, stmt, file);
    for (uint32_t i = 0; i < file->n_exports; i++) declare_alias(resolver, &file->exports[i], stmt);
}

static void resolve_kids(Resolver *resolver, Stmt *stmt)
{
    if (!resolver->def || !resolver->def->block) {
        diag_report(resolver->diag, D_MISPLACED, stmt->span, "children() outside of a macro");
        stmt->kind = STMT_EMPTY;
    } else if (stmt->as.kids.n) {
        diag_report(resolver->diag, D_WRONG_ARGUMENT, stmt->as.kids.items[0].value->span,
                    "children() takes no arguments");
    } else {
        resolver->def->calls_children = true;
    }
}

static void resolve_preset(Resolver *resolver, Stmt *stmt)
{
    if (resolver->level > 0 || resolver->scope->outer->outer) {
        diag_report(resolver->diag, D_MISPLACED, stmt->span, "a preset stands at the top of a file");
        stmt->kind = STMT_EMPTY;
    }
    resolve_block(resolver, stmt->as.node->block);
}

static void resolve_node_stmt(Resolver *resolver, Stmt *stmt)
{
    NodeExpr *node = stmt->as.node;
    resolve_node(resolver, node, false);
    if (node->name) { /* declared behind its own block: it cannot contain itself */
        node->name_slot = scope_declare_slot(resolver, node->name, node->name_span);
        Binding *binding = node->name->binding;
        binding->declares = node->declares;
        binding->warns = binding->declares && warns_here(resolver, true);
    }
}

static void resolve_stmt(Resolver *resolver, Stmt *stmt)
{
    switch (stmt->kind) {
    case STMT_EMPTY: break;
    case STMT_BIND:
    case STMT_PARAM: resolve_bind(resolver, stmt); break;
    case STMT_ASSIGN: resolve_assign(resolver, stmt); break;
    case STMT_PROP: resolve_prop(resolver, stmt); break;
    case STMT_CALL: resolve_call_stmt(resolver, stmt); break;
    case STMT_NODE: resolve_node_stmt(resolver, stmt); break;
    case STMT_KIDS: resolve_kids(resolver, stmt); break;
    case STMT_DEF: resolve_def(resolver, stmt->as.def); break;
    case STMT_DEFAULTS: resolve_defaults(resolver, stmt); break;
    case STMT_IF: resolve_branch(resolver, stmt); break;
    case STMT_FOR: resolve_for(resolver, stmt); break;
    case STMT_WHILE: resolve_while(resolver, stmt); break;
    case STMT_IMPORT: resolve_import(resolver, stmt); break;
    case STMT_PRESET: resolve_preset(resolver, stmt); break;
    }
}

static void resolve_stmts(Resolver *resolver, Stmt *first)
{
    declare_defs(resolver, first);
    for (Stmt *stmt = first; stmt; stmt = stmt->next) {
        resolver->scope->at = stmt;
        resolve_stmt(resolver, stmt);
    }
}

/* ---- files ---- */

void resolver_init(Resolver *resolver, Diag *diag, SymbolTable *symbols, const Schema *schema,
                   const double *srgb_to_working)
{
    *resolver = (Resolver){.diag = diag, .arena = diag->arena, .symbols = symbols, .schema = schema};
    resolver->defaults = ARENA_ARRAY(diag->arena, Symbol *, schema->n_nodes);
    for (int i = 0; i < 9; i++)
        if (srgb_to_working[i] != 0) resolver->srgb_to_working = srgb_to_working;
    scope_begin(resolver);
    for (int i = 0; i < PREDECLARED_COUNT; i++) {
        Symbol *symbol = symbol_of(symbols, predeclared_names[i], strlen(predeclared_names[i]));
        scope_declare_slot(resolver, symbol, (Span){0, 0, 0});
        symbol->binding->has_span = false;
    }
}

bool resolver_uses(const Resolver *resolver, int name)
{
    for (const Binding *binding = resolver->scope->bindings; binding; binding = binding->next_in_scope)
        if (!binding->has_span && strcmp(binding->symbol->text, predeclared_names[name]) == 0) return binding->used;
    return false;
}

void resolve_prelude(Resolver *resolver, File *prelude)
{
    resolve_stmts(resolver, prelude->block->first);
    prelude->state = FILE_RESOLVED;
}

static void collect_exports(Resolver *resolver, File *file)
{
    uint32_t n = 0;
    for (const Binding *binding = resolver->scope->bindings; binding; binding = binding->next_in_scope) n++;
    file->exports = ARENA_ARRAY(resolver->arena, Export, n);
    for (Binding *binding = resolver->scope->bindings; binding; binding = binding->next_in_scope)
        if (!strchr(binding->symbol->text, ' ')) /* defaults do not reach beyond their file */
            file->exports[file->n_exports++] = (Export){binding->symbol, binding};
}

void resolve_file(Resolver *resolver, File *file, bool warns_unused)
{
    if (file->state == FILE_RESOLVED) return;
    file->state = FILE_RESOLVED;
    for (uint32_t i = 0; i < file->n_imports; i++)
        if (file->imports[i]->as.import.file) resolve_file(resolver, file->imports[i]->as.import.file, false);
    const DiagChain *chain = resolver->diag->chain;
    resolver->diag->chain = file->chain;
    resolver->warns_unused = warns_unused;
    resolver->library_itself = is_library(resolver->schema, file);
    scope_begin(resolver);
    resolve_stmts(resolver, file->block->first);
    for (size_t i = 0; warns_unused && i < resolver->n_late; i++) resolve_define(resolver, resolver->late[i]);
    collect_exports(resolver, file);
    scope_end(resolver);
    resolver->diag->chain = chain;
}

void resolve_define(Resolver *resolver, Expr *expr)
{
    if (expr->kind == EXPR_NAME && !expr->as.name.symbol->binding) return;
    resolve_expr(resolver, expr);
}

/* ---- colours ---- */

/* IEC 61966-2-1 */
double srgb_decode(double encoded)
{
    double magnitude = fabs(encoded);
    double linear = magnitude <= 0.04045 ? magnitude / 12.92 : pow((magnitude + 0.055) / 1.055, 2.4);
    return encoded < 0 ? -linear : linear;
}

void color_from_srgb(const double *m, double rgb[3])
{
    if (!m) return;
    double r = rgb[0], g = rgb[1], b = rgb[2];
    for (int row = 0; row < 3; row++) rgb[row] = m[row * 3] * r + m[row * 3 + 1] * g + m[row * 3 + 2] * b;
}

/* resolve_expr.c - names within expressions and nodes, and did-you-mean for those that are not known.
 * Operands on the left are followed in a loop, because chains of operators lean that way and may be long.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "base/buf.h"
#include "base/suggest.h"
#include "lang/builtin.h"
#include "lang/eval.h"
#include "lang/habits.h"
#include "lang/resolve.h"
#include "lang/schema_find.h"

/* ---- did you mean ---- */

enum { MOST_PLACES = 3 }; /* where the same unknown name stands, in one report */

typedef struct Words {
    const char **items;
    size_t n, capacity;
} Words;

static void add_word(Words *words, const char *word)
{
    if (ARRAY_ROOM(words->items, words->capacity, words->n)) words->items[words->n++] = word;
}

/* All names that are visible, by walking the buckets: only done for a message. */
static Words visible_words(const Resolver *resolver, bool functions, bool nodes)
{
    Words words = {0};
    const SymbolTable *table = resolver->symbols;
    for (uint32_t i = 0; i < table->n_buckets; i++)
        for (const Symbol *symbol = table->buckets[i]; symbol; symbol = symbol->next_in_bucket)
            if (symbol->binding && !strchr(symbol->text, ' ')) add_word(&words, symbol->text);
    for (size_t i = 0; functions && i < builtin_count(); i++) add_word(&words, builtin_at(i)->name);
    for (size_t i = 0; functions && i < resolver->schema->n_terms; i++)
        add_word(&words, resolver->schema->terms[i].name);
    for (size_t i = 0; nodes && i < resolver->schema->n_nodes; i++) add_word(&words, resolver->schema->nodes[i].name);
    return words;
}

/* ---- what the program's own library declares ---- */

/* What stands behind these two words at the begin of a line: ' ' or '('; NULL: they do not stand there. */
static const char *declaration(const EvalLibraryFile *file, const char *keyword, const char *name)
{
    size_t first = strlen(keyword), second = strlen(name);
    for (const char *at = file->text; at; at = strchr(at, '\n')) {
        at += *at == '\n';
        if (strncmp(at, keyword, first) != 0 || at[first] != ' ' || strncmp(at + first + 1, name, second) != 0)
            continue;
        const char *behind = at + first + 1 + second;
        if (*behind == ' ' || *behind == '(') return behind;
    }
    return NULL;
}

/* The name under which the scene uses that file; NULL: it does not. */
static const char *name_in_use(const Resolver *resolver, const EvalLibraryFile *file)
{
    const SymbolTable *table = resolver->symbols;
    for (uint32_t i = 0; i < table->n_buckets; i++)
        for (const Symbol *symbol = table->buckets[i]; symbol; symbol = symbol->next_in_bucket) {
            Binding *binding = symbol->binding;
            if (!binding || binding->kind != BINDING_MODULE) continue;
            if (strcmp(resolver->diag->sources->sources[binding->module->source].name, file->name) != 0) continue;
            binding_use(binding);
            return symbol->text;
        }
    return NULL;
}

bool hint_at_library(Resolver *resolver, Diagnostic *report, const char *name, bool medium)
{
    for (size_t i = 0; resolver->library && i < resolver->library->n_files; i++) {
        const EvalLibraryFile *file = &resolver->library->files[i];
        const char *value = medium ? declaration(file, "medium", name) : NULL, *def = declaration(file, "def", name);
        if (!value && !def) continue;
        const char *call = value ? "" : strncmp(def, "()", 2) == 0 ? "()" : "(...)";
        const char *known = name_in_use(resolver, file), *base = strrchr(file->name, '/');
        base = base ? base + 1 : file->name;
        const char *module = known ? known : arena_copy_text(resolver->arena, base, strcspn(base, "."));
        if (known)
            diag_hint(resolver->diag, report, "write: %s.%s%s", module, name, call);
        else
            diag_hint(resolver->diag, report, "write: %s.%s%s, with: use \"%s\" as %s", module, name, call, file->name,
                      module);
        return true;
    }
    return false;
}

static void suggest_word(Resolver *resolver, Diagnostic *report, const char *word, const char *otherwise)
{
    diag_hint(resolver->diag, report, "did you mean '%s'?%s", word, otherwise);
    Binding *binding = symbol_of(resolver->symbols, word, strlen(word))->binding;
    if (binding) binding_use(binding); /* that nothing uses it would be the same mistake */
    if (binding && binding->has_span && binding->span.source == report->span.source)
        diag_note(resolver->diag, report, binding->span, "'%s' is declared here", word);
}

/* The visible value whose name differs in nothing but the case of its letters; NULL: none, or several. */
static const char *same_but_case(const Resolver *resolver, const char *wrong)
{
    const char *found = NULL;
    Words words = visible_words(resolver, false, false);
    for (size_t i = 0; i < words.n; i++) {
        if (strcasecmp(words.items[i], wrong) != 0) continue;
        if (found) {
            found = NULL;
            break;
        }
        found = words.items[i];
    }
    free(words.items);
    return found;
}

/* The medium or other node that the scene gave a name that differs by a slip, and begins as that does; NULL: none. */
static const char *nearest_declared_node(Resolver *resolver, const Symbol *wrong)
{
    const char *nearest = nearest_visible(resolver, wrong);
    const Binding *binding = nearest ? symbol_of(resolver->symbols, nearest, strlen(nearest))->binding : NULL;
    return binding && binding->declares && binding->has_span && *nearest == *wrong->text ? nearest : NULL;
}

void suggest_visible(Resolver *resolver, Diagnostic *report, const Symbol *wrong, bool functions, bool nodes)
{
    const char *same = functions || nodes ? NULL : same_but_case(resolver, wrong->text);
    if (same) {
        suggest_word(resolver, report, same, "");
        return;
    }
    const char *node = nodes ? habit_node(wrong->text) : NULL, *word = nodes ? NULL : habit_word(wrong->text);
    bool vague = node && strstr(node, "use \"std/"); /* of a file, and not which of its macros */
    if ((!node || vague) && (functions || nodes) && hint_at_library(resolver, report, wrong->text, false)) return;
    const char *slip = word ? nearest_declared_node(resolver, wrong) : NULL;
    if (slip) { /* glass, where the scene has a medium glas */
        suggest_word(resolver, report, slip, arena_format(resolver->arena, " Else write: %s", word));
        return;
    }
    if (node || word) {
        diag_hint(resolver->diag, report, node ? "%s" : "write: %s", node ? node : word);
        return;
    }
    Words words = visible_words(resolver, functions, nodes);
    const char *nearest = suggest_nearest(wrong->text, words.items, words.n);
    free(words.items);
    if (nearest) suggest_word(resolver, report, nearest, "");
    if (!report->hint && !functions) suggest_later(resolver, report, wrong);
    if (!report->hint && !functions) hint_at_library(resolver, report, wrong->text, true);
}

const char *nearest_visible(Resolver *resolver, const Symbol *wrong)
{
    Words words = visible_words(resolver, false, false);
    const char *nearest = suggest_nearest(wrong->text, words.items, words.n);
    free(words.items);
    return nearest;
}

/* ---- names ---- */

static const Binding *find_export(const File *file, const Symbol *symbol)
{
    for (uint32_t i = 0; i < file->n_exports; i++)
        if (file->exports[i].symbol == symbol) return file->exports[i].binding;
    return NULL;
}

/* Of a name that is none of a file in use, with a member behind it: what it may be meant for, or else what brings such a
 * file into use, one of the program's own, where there is one. */
static void hint_at_use(Resolver *resolver, Diagnostic *report, Symbol *symbol, const Symbol *member)
{
    static const char endings[] = "exr png jpg jpeg hdr obj ply stl gltf glb nvdb ies ttf otf pfb txt csv mns";
    const char *folder = "", *name = symbol->text;
    if (habit_is_one_of(endings, member->text)) {
        diag_hint(resolver->diag, report, "the name of a file stands in quotes: \"%s.%s\"", name, member->text);
        return;
    }
    if (member->binding && member->binding->has_span) { /* by a use without 'as' */
        binding_use(member->binding);
        diag_hint(resolver->diag, report, "write: %s, without '%s.'", member->text, name);
        return;
    }
    if (note_later_declaration(resolver, report, symbol)) {
        diag_hint(resolver->diag, report, "a file can be used behind its 'use': move that up");
        return;
    }
    suggest_visible(resolver, report, symbol, false, false);
    if (report->hint) return;
    if (strcmp(name, "std") == 0) {
        diag_hint(resolver->diag, report,
                  "write: use \"std/media.mns\" as media, and media.NAME; 'meniscus help std' lists such files");
        return;
    }
    for (size_t i = 0; resolver->library && i < resolver->library->n_files; i++) {
        const char *file = resolver->library->files[i].name, *last = strrchr(file, '/');
        size_t length = strlen(name);
        if (last && strncmp(last + 1, name, length) == 0 && strcmp(last + 1 + length, ".mns") == 0) folder = "std/";
    }
    diag_hint(resolver->diag, report, "write: use \"%s%s.mns\" as %s", folder, *folder ? name : "NAME", name);
}

/* Of a def whose name stands as a value. */
static void hint_at_call(Resolver *resolver, Diagnostic *report, const Def *def, const char *name)
{
    const char *args = def->n_formals ? "..." : "";
    if (def->body)
        diag_hint(resolver->diag, report, "write: %s(%s)", name, args);
    else
        diag_hint(resolver->diag, report, "it places nodes, as a statement: %s(%s)", name, args);
}

/* What a path with dots leads to through modules; NULL after a report, or for a single name that is not known. */
static Binding *resolve_path(Resolver *resolver, const Path *path)
{
    Binding *binding = path->names[0]->binding;
    if (binding) binding_use(binding);
    for (uint32_t i = 1; i < path->n; i++) {
        if (!binding || binding->kind != BINDING_MODULE) {
            Diagnostic *report = diag_report(resolver->diag, D_UNKNOWN_NAME, path->span, "'%s' is no file in use",
                                             path->names[i - 1]->text);
            if (!binding) hint_at_use(resolver, report, path->names[0], path->names[i]);
            return NULL;
        }
        const Binding *found = find_export(binding->module, path->names[i]);
        if (!found) {
            report_not_exported(resolver, path->span, binding->module, path->names[i]);
            return NULL;
        }
        Binding *copy = ARENA_NEW(resolver->arena, Binding);
        *copy = *found;
        binding = copy;
    }
    return binding;
}

static void make_variable(const Resolver *resolver, Expr *expr, const Binding *binding, Symbol *symbol)
{
    Slot slot = slot_of(resolver, binding);
    expr->kind = slot.kind;
    expr->as.variable.slot = slot;
    expr->as.variable.symbol = symbol;
}

/* A name that is missing everywhere is one mistake: further places are notes of its report. */
static bool known_to_be_unknown(Resolver *resolver, Symbol *symbol, Span span)
{
    Diagnostic *report = symbol->unknown;
    if (!report) return false;
    if (symbol->n_unknown++ < MOST_PLACES) diag_note(resolver->diag, report, span, "it is used here, too");
    return true;
}

/* The property of a choice that has the word: the one whose value is resolved, else the first that there is; NULL: none. */
static const PropType *choice_with(const Resolver *resolver, const char *word)
{
    const PropType *sought = resolver->word_prop;
    if (sought && sought->choices && choice_allows(sought->choices, word)) return sought;
    for (size_t i = 0; i < resolver->schema->n_nodes; i++)
        for (size_t k = 0; k < resolver->schema->nodes[i].n_props; k++) {
            const PropType *prop = &resolver->schema->nodes[i].props[k];
            bool chooses = prop->kind == PROP_CHOICE || (prop->kind == PROP_STRINGS && prop->choices);
            if (chooses && choice_allows(prop->choices, word)) return prop;
        }
    return NULL;
}

static void hint_at_word(Resolver *resolver, Diagnostic *report, const PropType *prop, const char *word)
{
    diag_hint(resolver->diag, report,
              "write: \"%s\"; the words of a choice stand without quotes only right behind '=', %s = %s", word,
              prop->name, word);
}

static void resolve_name(Resolver *resolver, Expr *expr)
{
    Symbol *symbol = expr->as.name.symbol;
    Binding *binding = symbol->binding;
    if (binding) binding_use(binding);
    if (binding && binding->kind == BINDING_SLOT && !binding->poison) {
        make_variable(resolver, expr, binding, symbol);
        return;
    }
    expr->kind = EXPR_POISON;
    if (binding && binding->poison) return;
    if (binding) {
        Diagnostic *report =
            diag_report(resolver->diag, D_WRONG_TYPE, expr->span, "'%s' is %s, not a value", symbol->text,
                        binding->kind == BINDING_MODULE ? "a file in use"
                        : binding->def->body            ? "a function"
                                                        : "a macro");
        if (binding->kind == BINDING_DEF)
            hint_at_call(resolver, report, binding->def, symbol->text);
        else
            diag_hint(resolver->diag, report, "write: %s.NAME, of what it declares", symbol->text);
        return;
    }
    if (known_to_be_unknown(resolver, symbol, expr->span)) return;
    Diagnostic *report = diag_report(resolver->diag, D_UNKNOWN_NAME, expr->span, "unknown name '%s'", symbol->text);
    symbol->unknown = report;
    const PropType *choice = choice_with(resolver, symbol->text), *sought = resolver->word_prop;
    if (sought && sought->kind == PROP_STRING && !nearest_visible(resolver, symbol))
        diag_hint(resolver->diag, report, "a text stands in quotes: %s = \"%s\"", sought->name, symbol->text);
    else if (choice && choice == sought)
        hint_at_word(resolver, report, choice, symbol->text);
    else if (builtin_find(symbol->text))
        diag_hint(resolver->diag, report, "'%s' is a function: write '%s(...)'", symbol->text, symbol->text);
    else if (unit_of(symbol->text, symbol->length) && symbol->length > 1) /* 5 / cm; single letters are names, too */
        diag_hint(resolver->diag, report, "a unit stands behind a number: 1%s", symbol->text);
    else if (schema_node(resolver->schema, symbol->text)) /* let s = sphere ball { ... } */
        diag_hint(resolver->diag, report, "write: %s { ... }, as a value without a name of its own", symbol->text);
    else if (!note_later_declaration(resolver, report, symbol)) {
        if (choice && !habit_word(symbol->text))
            hint_at_word(resolver, report, choice, symbol->text);
        else
            suggest_visible(resolver, report, symbol, false, false);
    }
}

/* ---- members ---- */

/* The module that an expression names, or NULL. */
static const File *module_of(Resolver *resolver, const Expr *expr)
{
    if (expr->kind == EXPR_NAME) {
        Binding *binding = expr->as.name.symbol->binding;
        if (!binding || binding->kind != BINDING_MODULE) return NULL;
        binding_use(binding);
        return binding->module;
    }
    if (expr->kind != EXPR_MEMBER) return NULL;
    const File *outer = module_of(resolver, expr->as.member.base);
    const Binding *found = outer ? find_export(outer, expr->as.member.name) : NULL;
    return found && found->kind == BINDING_MODULE ? found->module : NULL;
}

/* "gw.tumbler" as it is written */
static const char *text_of_member(const Resolver *resolver, const Expr *expr)
{
    const Expr *base = expr->as.member.base;
    const char *name = expr->as.member.name->text;
    return base->kind == EXPR_NAME ? arena_format(resolver->arena, "%s.%s", base->as.name.symbol->text, name) : name;
}

static int component_of(char c, const char *set)
{
    const char *found = c ? strchr(set, c) : NULL;
    return found ? (int)(found - set) : -1;
}

static bool read_swizzle(Expr *expr)
{
    const char *text = expr->as.member.name->text;
    size_t n = strlen(text);
    if (n < 1 || n > 4) return false;
    const char *set = component_of(text[0], "xyzw") >= 0 ? "xyzw" : "rgb";
    for (size_t i = 0; i < n; i++) {
        int component = component_of(text[i], set);
        if (component < 0) return false;
        expr->as.member.component[i] = (uint8_t)component;
    }
    expr->as.member.n = (uint8_t)n;
    return true;
}

/* Of a name that is not known, with a member that no value has: a file was meant. */
static bool report_no_module(Resolver *resolver, const Expr *expr)
{
    const Expr *base = expr->as.member.base;
    if (base->kind != EXPR_NAME || base->as.name.symbol->binding) return false;
    Symbol *symbol = base->as.name.symbol;
    if (known_to_be_unknown(resolver, symbol, base->span)) return true;
    Diagnostic *report =
        diag_report(resolver->diag, D_UNKNOWN_NAME, base->span, "'%s' is no file in use, nor a value", symbol->text);
    symbol->unknown = report;
    hint_at_use(resolver, report, symbol, expr->as.member.name);
    return true;
}

void hint_at_reading(Diag *diag, Diagnostic *report, const char *property)
{
    diag_hint(diag, report,
              "properties are not read: give the value a name before, let %s = ..., and use that in both places",
              property);
}

static bool is_property(const Schema *schema, const char *name)
{
    for (size_t i = 0; i < schema->n_nodes; i++)
        if (schema_prop(&schema->nodes[i], name)) return true;
    return false;
}

/* returns the base that is left to be resolved, or NULL */
static Expr *resolve_member(Resolver *resolver, Expr *expr)
{
    const File *module = module_of(resolver, expr->as.member.base);
    Symbol *name = expr->as.member.name;
    if (module) {
        const Binding *found = find_export(module, name);
        if (found && found->kind == BINDING_SLOT && !found->poison) {
            make_variable(resolver, expr, found, name);
            return NULL;
        }
        if (!found) {
            report_not_exported(resolver, expr->as.member.name_span, module, name);
        } else if (!found->poison) {
            Diagnostic *report = diag_report(resolver->diag, D_WRONG_TYPE, expr->as.member.name_span,
                                             "'%s' is %s, not a value", name->text,
                                             found->kind == BINDING_MODULE ? "a file in use"
                                             : found->def->body            ? "a function"
                                                                           : "a macro");
            if (found->kind == BINDING_DEF) hint_at_call(resolver, report, found->def, text_of_member(resolver, expr));
        }
        expr->kind = EXPR_POISON;
        return NULL;
    }
    if (record_knows(name->text)) {
        expr->kind = EXPR_FIELD;
        return expr->as.member.base;
    }
    if (!read_swizzle(expr)) {
        if (report_no_module(resolver, expr)) {
            expr->kind = EXPR_POISON;
            return NULL;
        }
        Diagnostic *report =
            diag_report(resolver->diag, D_UNKNOWN_NAME, expr->as.member.name_span, "'.%s' is no component", name->text);
        if (habit_is_one_of("length size count", name->text))
            diag_hint(resolver->diag, report,
                      "how many elements there are is len(list), how long a vector is length(v)");
        else if (is_property(resolver->schema, name->text))
            hint_at_reading(resolver->diag, report, name->text);
        else
            diag_hint(resolver->diag, report, "the components are x y z w, or r g b of a colour, one or more of them");
        Expr *base = expr->as.member.base;
        expr->kind = EXPR_POISON;
        return base;
    }
    return expr->as.member.base;
}

/* ---- calls ---- */

static void resolve_args(Resolver *resolver, Args *args)
{
    for (uint32_t i = 0; i < args->n; i++) resolve_expr(resolver, args->items[i].value);
}

static void no_names(Resolver *resolver, const Args *args, const char *function)
{
    for (uint32_t i = 0; i < args->n; i++) {
        if (!args->items[i].name) continue;
        Diagnostic *report = diag_report(resolver->diag, D_WRONG_ARGUMENT, args->items[i].name_span,
                                         "the arguments of '%s' have no names", function);
        if (schema_node(resolver->schema, function)) /* noise is a pattern, too */
            diag_hint(resolver->diag, report, "a node's properties stand in braces: %s { ... }", function);
    }
}

static void check_count(Resolver *resolver, Expr *expr, unsigned min, unsigned max)
{
    const Args *args = &expr->as.call.args;
    const char *name = expr->as.call.name;
    no_names(resolver, args, name);
    if (args->n >= min && args->n <= max) return;
    const char *wanted = min == max               ? arena_format(resolver->arena, "%u", min)
                         : max < BUILTIN_MAX_ARGS ? arena_format(resolver->arena, "%u to %u", min, max)
                         : args->n < min          ? arena_format(resolver->arena, "at least %u", min)
                                                  : arena_format(resolver->arena, "at most %u", max);
    Diagnostic *report =
        diag_report(resolver->diag, args->n < min ? D_MISSING_ARGUMENT : D_WRONG_ARGUMENT, expr->span,
                    "'%s' takes %s argument%s, not %u", name, wanted, min == max && min == 1 ? "" : "s", args->n);
    if (args->n == 3 && (strcmp(name, "translate") == 0 || strcmp(name, "rotate") == 0 || strcmp(name, "scale") == 0))
        diag_hint(resolver->diag, report, "write: %s(<x, y, z>)", name);
    else if (args->n == 2 && (strcmp(name, "translate") == 0 || strcmp(name, "scale") == 0))
        diag_hint(resolver->diag, report, "write: ball { %s(<x, y, z>) }, in what is to be moved", name);
    expr->kind = EXPR_POISON;
}

static void report_no_function(Resolver *resolver, const Expr *callee, const Binding *binding, bool no_arguments)
{
    if (callee->kind != EXPR_NAME) {
        const char *name = callee->kind == EXPR_MEMBER ? callee->as.member.name->text : NULL;
        bool builtin = name && builtin_find(name); /* Math.sqrt(2) */
        if (name && !builtin && report_no_module(resolver, callee)) return;
        Diagnostic *report = diag_report(resolver->diag, D_UNKNOWN_FUNCTION, callee->span, "this cannot be called");
        if (builtin)
            diag_hint(resolver->diag, report, "write: %s(...)", name);
        else if (name && habit_word(name)) /* list.append(3) */
            diag_hint(resolver->diag, report, "write: %s", habit_word(name));
        return;
    }
    const Symbol *symbol = callee->as.name.symbol;
    if (binding) {
        Diagnostic *report =
            diag_report(resolver->diag, D_UNKNOWN_FUNCTION, callee->span, "'%s' is no function", symbol->text);
        if (binding->has_span) diag_note(resolver->diag, report, binding->span, "declared here");
        if (symbol->declared == SYMBOL_TRANSFORM)
            diag_hint(resolver->diag, report, "write: transform(%s)", symbol->text);
        else if (binding->declares && no_arguments)
            diag_hint(resolver->diag, report, "write: %s, without brackets", symbol->text);
        return;
    }
    Diagnostic *report =
        diag_report(resolver->diag, D_UNKNOWN_FUNCTION, callee->span, "unknown function '%s'", symbol->text);
    if (schema_node(resolver->schema, symbol->text))
        diag_hint(resolver->diag, report, "'%s' is a node: write '%s { ... }'", symbol->text, symbol->text);
    else if (habit_word(symbol->text))
        diag_hint(resolver->diag, report, "write: %s", habit_word(symbol->text));
    else
        suggest_visible(resolver, report, symbol, true, true);
}

/* The binding that a callee names, through modules; *silent when a mistake has been reported. */
static const Binding *callee_binding(Resolver *resolver, const Expr *callee, bool *silent)
{
    *silent = false;
    if (callee->kind == EXPR_NAME) {
        Binding *binding = callee->as.name.symbol->binding;
        if (binding) binding_use(binding);
        return binding;
    }
    if (callee->kind != EXPR_MEMBER) return NULL;
    const File *module = module_of(resolver, callee->as.member.base);
    if (!module) return NULL;
    const Binding *found = find_export(module, callee->as.member.name);
    if (!found) {
        report_not_exported(resolver, callee->span, module, callee->as.member.name);
        *silent = true;
    }
    return found;
}

static void call_def(const Resolver *resolver, Expr *expr, ExprKind kind, Def *def)
{
    expr->kind = kind;
    expr->as.call.name = def->name->text;
    expr->as.call.to.def = def;
    expr->as.call.hops = def->level ? resolver->level - def->level : 0;
}

void resolve_function(Resolver *resolver, Expr *expr)
{
    bool silent;
    const Binding *binding = callee_binding(resolver, expr, &silent);
    if (silent)
        expr->kind = EXPR_POISON;
    else if (binding && binding->kind == BINDING_DEF && binding->def->body)
        call_def(resolver, expr, EXPR_FUNCTION, binding->def);
    else
        resolve_expr(resolver, expr);
}

/* Is pi, which no name of the scene hides, a factor of it, and no unit of an angle? */
static bool has_factor_pi(const Expr *expr)
{
    const Expr *a = expr->as.op.a, *b = expr->as.op.b;
    switch (expr->kind) {
    case EXPR_NAME: {
        const Binding *binding = expr->as.name.symbol->binding;
        return binding && !binding->has_span && strcmp(expr->as.name.symbol->text, "pi") == 0;
    }
    case EXPR_NEGATE:
    case EXPR_DIVIDE: return has_factor_pi(a);
    case EXPR_MULTIPLY:
        if ((a->kind == EXPR_CONSTANT && a->as.constant.unit) || (b->kind == EXPR_CONSTANT && b->as.constant.unit))
            return false;
        return has_factor_pi(a) || has_factor_pi(b);
    case EXPR_ADD:
    case EXPR_SUBTRACT: return has_factor_pi(a) || has_factor_pi(b);
    case EXPR_VECTOR:
        for (uint32_t i = 0; i < expr->as.list.n; i++)
            if (has_factor_pi(expr->as.list.items[i])) return true;
        return false;
    default: return false;
    }
}

/* In other languages angles are in radians there, and nothing else would tell. */
static void warn_of_radians(Resolver *resolver, const Expr *call)
{
    static const char *const functions[] = {"sin", "cos", "tan", "rotate"};
    const Expr *callee = call->as.call.callee;
    uint32_t n = call->as.call.args.n;
    if (callee->kind != EXPR_NAME || callee->as.name.symbol->binding || n == 0) return;
    const Expr *angle = call->as.call.args.items[n - 1].value; /* rotate(y, pi / 2) */
    for (size_t i = 0; i < COUNT_OF(functions); i++) {
        if (strcmp(callee->as.name.symbol->text, functions[i]) != 0 || !has_factor_pi(angle)) continue;
        Diagnostic *report = diag_report(resolver->diag, D_RADIANS, angle->span,
                                         "'%s' takes degrees, and this has pi as a factor", functions[i]);
        diag_hint(resolver->diag, report, "write 180 for pi, or multiply by 1rad");
    }
}

/* <r * cos(a), 0, r * sin(a)>: of one angle, which may be at random, for both. */
static bool is_circular(const Symbol *symbol)
{
    return strcmp(symbol->text, "sin") == 0 || strcmp(symbol->text, "cos") == 0;
}

/* The first call of rnd() in an expression that has not been resolved yet, up to some depth, but of angles; NULL: there is none. */
static const Expr *find_random(const Expr *expr, int depth)
{
    const Expr *found = NULL;
    if (!expr || depth == 0) return NULL;
    if (expr->kind == EXPR_CALL) {
        const Expr *callee = expr->as.call.callee;
        const Symbol *symbol = callee->kind == EXPR_NAME ? callee->as.name.symbol : NULL;
        if (symbol && !symbol->binding && strcmp(symbol->text, "rnd") == 0) return expr;
        if (symbol && !symbol->binding && is_circular(symbol)) return NULL;
        for (uint32_t i = 0; !found && i < expr->as.call.args.n; i++)
            found = find_random(expr->as.call.args.items[i].value, depth - 1);
    } else if (expr->kind >= EXPR_NEGATE && expr->kind <= EXPR_POWER) {
        found = find_random(expr->as.op.a, depth - 1);
        if (!found) found = find_random(expr->as.op.b, depth - 1);
    }
    return found;
}

/* Whether it is a part of a circle, whose radius is the same in two coordinates: (9 + rnd(i)) * cos(a). */
static bool is_part_of_circle(const Expr *expr, int depth)
{
    if (!expr || depth == 0) return false;
    if (expr->kind == EXPR_CALL) {
        const Expr *callee = expr->as.call.callee;
        return callee->kind == EXPR_NAME && is_circular(callee->as.name.symbol);
    }
    return expr->kind >= EXPR_NEGATE && expr->kind <= EXPR_POWER &&
           (is_part_of_circle(expr->as.op.a, depth - 1) || is_part_of_circle(expr->as.op.b, depth - 1));
}

/* <rnd(i), rnd(i), rnd(i)>: where numbers at random have a state, these are three, and here they are one. */
static void warn_of_same_random(Resolver *resolver, const Expr *vector)
{
    enum { DEPTH = 6 };
    const Expr *first = NULL;
    for (uint32_t i = 0; i < vector->as.list.n; i++) {
        const Expr *call = find_random(vector->as.list.items[i], DEPTH);
        if (!call || is_part_of_circle(vector->as.list.items[i], DEPTH)) continue;
        const char *text = resolver->diag->sources->sources[call->span.source].text;
        uint32_t length = call->span.end - call->span.begin;
        if (first && first->span.end - first->span.begin == length &&
            memcmp(text + first->span.begin, text + call->span.begin, length) == 0) {
            Diagnostic *report =
                diag_report(resolver->diag, D_SAME_RANDOM, call->span, "'%.*s' is the same number as before",
                            (int)(length < 40 ? length : 40), text + call->span.begin);
            diag_hint(resolver->diag, report,
                      "one that differs has another argument more: rnd(i, 1), rnd(i, 2), rnd(i, 3); "
                      "where it is meant to be the same, let r = rnd(...) before says so");
            return;
        }
        if (!first) first = call;
    }
}

static bool is_literal_number(const Expr *expr)
{
    return expr->kind == EXPR_CONSTANT && expr->literal && expr->as.constant.value.kind == VALUE_NUMBER;
}

/* aperture = f / 2.8, as photographers write it */
static void resolve_quotient(Resolver *resolver, Expr *expr)
{
    Expr *a = expr->as.op.a, *b = expr->as.op.b;
    const Symbol *f = a->kind == EXPR_NAME && is_literal_number(b) && strcmp(a->as.name.symbol->text, "f") == 0
                          ? a->as.name.symbol
                          : NULL;
    resolve_expr(resolver, a);
    resolve_expr(resolver, b);
    if (f && !f->binding && f->unknown && !f->unknown->hint)
        diag_hint(resolver->diag, f->unknown, "%s", habit_advice("camera", "f_number"));
}

/* str(x, 0, 2) is POV-Ray's for what text() does: here it would put the two numbers behind x. */
static void warn_of_format(Resolver *resolver, const Expr *call)
{
    const Expr *callee = call->as.call.callee;
    const Arg *args = call->as.call.args.items;
    if (callee->kind != EXPR_NAME || callee->as.name.symbol->binding || call->as.call.args.n != 3 ||
        strcmp(callee->as.name.symbol->text, "str") != 0)
        return;
    if (!is_literal_number(args[1].value) || !is_literal_number(args[2].value)) return;
    double digits = args[2].value->as.constant.value.as.number; /* -1: as many as there are */
    Diagnostic *report = diag_report(resolver->diag, D_JOINED_NUMBERS, call->span,
                                     "'str' puts its arguments in a row, also these numbers");
    if (digits >= 0)
        diag_hint(resolver->diag, report, "for %g digits behind the point: text(x, %g)", digits, digits);
    else
        diag_hint(resolver->diag, report, "leave them out: str(x)");
}

static void resolve_call(Resolver *resolver, Expr *expr)
{
    Expr *callee = expr->as.call.callee;
    warn_of_radians(resolver, expr);
    warn_of_format(resolver, expr);
    resolve_args(resolver, &expr->as.call.args);
    bool silent;
    const Binding *binding = callee_binding(resolver, callee, &silent);
    if (binding && binding->kind == BINDING_DEF) {
        call_def(resolver, expr, EXPR_CALL_DEF, binding->def);
        if (binding->def->block) resolve_passed_by(resolver, expr->span, binding->def);
        return;
    }
    const char *name = callee->kind == EXPR_NAME ? callee->as.name.symbol->text : NULL;
    const Builtin *builtin = name ? builtin_find(name) : NULL;
    const TermType *term = name ? schema_term(resolver->schema, name) : NULL;
    expr->as.call.name = name;
    if (builtin) {
        expr->kind = EXPR_CALL_BUILTIN;
        expr->as.call.to.builtin = builtin;
        check_count(resolver, expr, builtin->min_args, builtin->max_args);
    } else if (term) {
        expr->kind = EXPR_CALL_TERM;
        expr->as.call.to.term = term;
        check_count(resolver, expr, term->min_args, term->max_args);
    } else {
        expr->kind = EXPR_POISON;
        if (!silent) report_no_function(resolver, callee, binding, expr->as.call.args.n == 0);
    }
}

/* ---- nodes ---- */

static void report_no_node(Resolver *resolver, const NodeExpr *node)
{
    const Symbol *symbol = node->path.names[0];
    Diagnostic *report =
        diag_report(resolver->diag, D_UNKNOWN_NODE, node->path.span, "unknown node '%s'", symbol->text);
    /* what is a pattern there may be something else where objects stand */
    const char *pattern =
        resolver->for_texture ? habit_node(arena_format(resolver->arena, "%s_pattern", symbol->text)) : NULL;
    if (note_later_declaration(resolver, report, symbol)) return;
    if (pattern)
        diag_hint(resolver->diag, report, "%s", pattern);
    else
        suggest_visible(resolver, report, symbol, false, true);
}

static void find_node(Resolver *resolver, NodeExpr *node)
{
    const Binding *binding = resolve_path(resolver, &node->path);
    if (node->path.n == 1) node->type = schema_node(resolver->schema, node->path.names[0]->text);
    if (binding && binding->poison) {
        node->type = NULL;
    } else if (binding && binding->kind == BINDING_SLOT) {
        node->has_prototype = true;
        node->prototype = slot_of(resolver, binding);
        node->prototype_span = binding->has_span ? binding->span : node->path.span;
        node->declares = binding->declares;
    } else if (binding && binding->kind == BINDING_DEF) {
        node->def = binding->def;
        if (node->def->block) resolve_passed_by(resolver, node->path.span, node->def);
        node->type = NULL;
        node->def_hops = binding->def->level ? resolver->level - binding->def->level : 0;
    } else if (!node->type && (node->path.n == 1 || binding)) {
        report_no_node(resolver, node);
    } else if (node->type && !(node->type->flags & (NODE_PLACED | NODE_SINGLE))) {
        node->declares = node->type;
    }
    if (node->type) resolve_defaults_of(resolver, node);
}

/* 'h', and in the next line 'group { ... }': h was to be placed, and no group of that name. It goes on with the group. */
static void split_bare_placement(Resolver *resolver, NodeExpr *node)
{
    if (!node->name || !(node->name->binding || schema_node(resolver->schema, node->name->text))) return;
    SourceSet *sources = resolver->diag->sources;
    uint32_t line = source_position(sources, node->path.span.source, node->path.span.begin).line;
    if (source_position(sources, node->name_span.source, node->name_span.begin).line == line) return;
    const char *text = node->path.names[node->path.n - 1]->text;
    Diagnostic *report = diag_report(resolver->diag, D_MISPLACED, node->path.span, "'%s' stands alone", text);
    diag_hint(resolver->diag, report, "to place it write: %s { }", text);
    resolve_path(resolver, &node->path);
    node->path = (Path){.names = {node->name}, .n = 1, .span = node->name_span};
    node->name = NULL;
}

/* As it is written: the file's name before the macro's. */
static const char *path_text(const Resolver *resolver, const Path *path)
{
    const char *text = path->names[0]->text;
    for (uint32_t i = 1; i < path->n; i++) text = arena_format(resolver->arena, "%s.%s", text, path->names[i]->text);
    return text;
}

void resolve_node(Resolver *resolver, NodeExpr *node, bool expression)
{
    split_bare_placement(resolver, node);
    find_node(resolver, node);
    resolver->for_texture = false;
    if (node->def && (expression || !node->def->block)) {
        const char *name = node->def->name->text, *path = path_text(resolver, &node->path);
        const bool function = node->def->body != NULL;
        Diagnostic *report = diag_report(resolver->diag, D_NOT_A_MACRO, node->path.span,
                                         !function    ? "a macro places nodes; it is no value"
                                         : expression ? "'%s' is a function: its arguments stand in round brackets"
                                                      : "'%s' is a function, not a macro",
                                         name);
        if (expression && node->def->block)
            diag_hint(resolver->diag, report, "a group of what it places is one: group { %s { ... } }", path);
        else if (function)
            hint_at_call(resolver, report, node->def, path);
        if (node->path.n == 1 && schema_node(resolver->schema, name)) {
            diag_note(resolver->diag, report, node->def->span, "declared here");
            diag_hint(resolver->diag, report, "it hides the node of that name: call it otherwise");
        }
        node->def = NULL;
    }
    NodeContext context = resolver->context;
    const NodeType *type = resolver->context_type;
    NodeExpr *outer = resolver->context_node;
    resolver->context_node = node;
    resolver->context = node->def ? CONTEXT_MACRO : CONTEXT_NODE;
    /* a name in scope may turn out to be a prototype of another type */
    resolver->context_type = node->has_prototype ? NULL : node->type;
    resolve_block(resolver, node->block);
    resolver->context = context;
    resolver->context_type = type;
    resolver->context_node = outer;
}

/* ---- expressions ---- */

static void resolve_let(Resolver *resolver, Expr *expr)
{
    Args *bindings = &expr->as.let.bindings;
    expr->as.let.slots = ARENA_ARRAY(resolver->arena, Slot, bindings->n);
    scope_begin(resolver);
    for (uint32_t i = 0; i < bindings->n; i++) {
        resolve_expr(resolver, bindings->items[i].value);
        expr->as.let.slots[i] = scope_declare_slot(resolver, bindings->items[i].name, bindings->items[i].name_span);
        bindings->items[i].name->binding->warns = true;
    }
    resolve_expr(resolver, expr->as.let.body);
    scope_end(resolver);
}

static void resolve_each(Resolver *resolver, Expr *expr)
{
    resolve_expr(resolver, expr->as.each.source);
    scope_begin(resolver);
    if (expr->kind == EXPR_EACH)
        expr->as.each.slot = scope_declare_slot(resolver, expr->as.each.name, expr->as.each.name_span);
    resolve_expr(resolver, expr->as.each.body);
    scope_end(resolver);
}

/* '#rrggbb' was kept as written, because the parser does not know the working space. */
static void resolve_color(const Resolver *resolver, Expr *expr)
{
    if (!expr->literal || expr->as.constant.value.kind != VALUE_COLOR) return;
    double *rgb = expr->as.constant.value.as.v;
    for (int i = 0; i < 3; i++) rgb[i] = srgb_decode(rgb[i]);
    color_from_srgb(resolver->srgb_to_working, rgb);
    expr->literal = false;
}

/* Resolves expr but for one operand on its left, which is returned to go on with. */
static Expr *resolve_step(Resolver *resolver, Expr *expr)
{
    switch (expr->kind) {
    case EXPR_NAME: resolve_name(resolver, expr); return NULL;
    case EXPR_CONSTANT: resolve_color(resolver, expr); return NULL;
    case EXPR_VECTOR:
    case EXPR_LIST:
        if (expr->kind == EXPR_VECTOR) warn_of_same_random(resolver, expr);
        for (uint32_t i = 0; i < expr->as.list.n; i++) resolve_expr(resolver, expr->as.list.items[i]);
        return NULL;
    case EXPR_CALL: resolve_call(resolver, expr); return NULL;
    case EXPR_MEMBER: return resolve_member(resolver, expr);
    case EXPR_LET: resolve_let(resolver, expr); return NULL;
    case EXPR_EACH:
    case EXPR_WHEN: resolve_each(resolver, expr); return NULL;
    case EXPR_NODE: resolve_node(resolver, expr->as.node, true); return NULL;
    case EXPR_POISON:
    case EXPR_GLOBAL:
    case EXPR_LOCAL:
    case EXPR_OUTER:
    case EXPR_FUNCTION:
    case EXPR_CALL_DEF:
    case EXPR_CALL_BUILTIN:
    case EXPR_CALL_TERM:
    case EXPR_FIELD: return NULL;
    case EXPR_DIVIDE: resolve_quotient(resolver, expr); return NULL;
    default:
        if (expr->as.op.b) resolve_expr(resolver, expr->as.op.b);
        if (expr->as.op.c) resolve_expr(resolver, expr->as.op.c);
        return expr->as.op.a;
    }
}

void resolve_expr(Resolver *resolver, Expr *expr)
{
    while (expr) expr = resolve_step(resolver, expr);
}

/* schema.c - rows of the node tables, and the check of a value against its row.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/num.h"
#include "base/suggest.h"
#include "lang/evaluator.h"
#include "lang/habits.h"
#include "lang/lex.h"

/* ---- looking up ---- */

const NodeType *schema_node(const Schema *schema, const char *name)
{
    for (size_t i = 0; i < schema->n_nodes; i++)
        if (strcmp(schema->nodes[i].name, name) == 0) return &schema->nodes[i];
    return NULL;
}

const PropType *schema_prop(const NodeType *type, const char *name)
{
    for (size_t i = 0; i < type->n_props; i++)
        if (strcmp(type->props[i].name, name) == 0) return &type->props[i];
    return NULL;
}

const TermType *schema_term(const Schema *schema, const char *name)
{
    for (size_t i = 0; i < schema->n_terms; i++)
        if (strcmp(schema->terms[i].name, name) == 0) return &schema->terms[i];
    return NULL;
}

bool choice_allows(const char *choices, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = choices; at; at = strchr(at, '|') ? strchr(at, '|') + 1 : NULL)
        if (length > 0 && strncmp(at, word, length) == 0 && (at[length] == '|' || at[length] == 0)) return true;
    return false;
}

/* "a|b|c" as words, for suggestions and messages; returns how many of them there are (at most max are kept). */
static size_t choice_words(Arena *arena, const char *choices, const char **words, size_t max)
{
    size_t n = 0;
    for (const char *at = choices; at;) {
        const char *end = strchr(at, '|');
        if (n < max) words[n++] = arena_copy_text(arena, at, end ? (size_t)(end - at) : strlen(at));
        at = end ? end + 1 : NULL;
    }
    return n;
}

enum { MAX_CHOICES = 64 };

const char *choice_text(Arena *arena, const char *choices)
{
    const char *words[MAX_CHOICES];
    return suggest_list(arena, words, choice_words(arena, choices, words, MAX_CHOICES), "or");
}

const char *with_article(Arena *arena, const char *name)
{
    bool vowel = *name && strchr("aeiou", *name) && strncmp(name, "uni", 3) != 0; /* a union */
    return arena_format(arena, "%s %s", vowel ? "an" : "a", name);
}

/* What a property takes in place of a word of another program, be it in capital letters; NULL: nothing that is known. */
static const char *choice_meant(Arena *arena, const PropType *type, const char *word)
{
    char *small = arena_copy_text(arena, word, strlen(word));
    for (char *at = small; *at; at++)
        if (*at >= 'A' && *at <= 'Z') *at = (char)(*at - 'A' + 'a');
    const char *meant = choice_allows(type->choices, small) ? small : habit_choice(type->name, small);
    return meant && choice_allows(type->choices, meant) ? meant : NULL;
}

/* The word that an expression consists of, if it is one. */
static const char *word_of(const Expr *expr)
{
    if (expr->kind == EXPR_NAME) return expr->as.name.symbol->text;
    bool variable = expr->kind == EXPR_GLOBAL || expr->kind == EXPR_LOCAL || expr->kind == EXPR_OUTER;
    return variable ? expr->as.variable.symbol->text : NULL;
}

static const char *word_or_text(const Expr *value)
{
    bool text = value && value->kind == EXPR_CONSTANT && value->as.constant.value.kind == VALUE_STRING;
    return text ? value->as.constant.value.as.text : value ? word_of(value) : NULL;
}

/* Of an advice that is a transform, what --set can do about it; else NULL. */
static const char *advice_for_set(Arena *arena, const char *advice)
{
    static const struct {
        const char *transform, *param, *call, *define;
    } ways[] = {{"translate", "place = <0, 0, 0>", "translate(place)", "place='<1, 2, 3>'"},
                {"rotate", "turn = 0", "rotate(y, turn)", "turn=45"},
                {"scale", "factor = 1", "scale(factor)", "factor=2"},
                {"align", "axis = y", "align(y, axis)", "axis='<0, 0, 1>'"},
                {"matrix", "shear = 0", "matrix(<1, 0, 0>, <shear, 1, 0>, <0, 0, 1>, <0, 0, 0>)", "shear=.5"}};
    static const char begin[] = "write: ";
    if (strncmp(advice, begin, sizeof begin - 1) != 0) return NULL;
    const char *word = advice + sizeof begin - 1;
    size_t length = strcspn(word, "(");
    for (size_t i = 0; i < COUNT_OF(ways); i++)
        if (strlen(ways[i].transform) == length && strncmp(word, ways[i].transform, length) == 0)
            return arena_format(
                arena, "--set sets no transforms; write in the scene: param %s, in the node: %s, and set it by -D %s",
                ways[i].param, ways[i].call, ways[i].define);
    return NULL;
}

void report_unknown_property(Diag *diag, Span span, const NodeType *type, const char *name, const Expr *value,
                             bool by_set)
{
    const char **words = ARENA_ARRAY(diag->arena, const char *, type->n_props);
    for (size_t i = 0; i < type->n_props; i++) words[i] = type->props[i].name;
    Diagnostic *report = diag_report(diag, D_UNKNOWN_PROPERTY, span, "'%s' has no property '%s'", type->name, name);
    const char *other, *word = word_or_text(value);
    for (unsigned i = 0; (other = habit_property(type->name, name, i)); i++) {
        const PropType *prop = schema_prop(type, arena_copy_text(diag->arena, other, strcspn(other, " ")));
        if (!prop) continue;
        bool chooses = prop->kind == PROP_CHOICE && !strchr(other, '=');
        const char *choice = word && chooses ? choice_meant(diag->arena, prop, word) : NULL;
        diag_hint(diag, report, "write: %s%s%s", habit_assignment(diag->arena, other, choice ? choice : "..."),
                  chooses && !choice ? ", which is " : "",
                  chooses && !choice ? choice_text(diag->arena, prop->choices) : "");
        return;
    }
    const char *advice = habit_advice(type->name, name);
    if (advice) {
        const char *for_set = by_set ? advice_for_set(diag->arena, advice) : NULL;
        diag_hint(diag, report, "%s", for_set ? for_set : advice);
        return;
    }
    diag_suggest(diag, report, name, words, type->n_props);
    if (!report->hint && type->n_props)
        diag_note_nowhere(diag, report, "%s has %s", with_article(diag->arena, type->name),
                          suggest_list(diag->arena, words, type->n_props, "and"));
}

/* ---- messages ---- */

static const char *plain_kind_text(Arena *arena, const PropType *type)
{
    switch (type->kind) {
    case PROP_NUMBER: return "a number";
    case PROP_INTEGER: return "a whole number";
    case PROP_BOOL: return "true or false";
    case PROP_STRING: return "a string";
    case PROP_CHOICE: return choice_text(arena, type->choices);
    case PROP_VECTOR2: return "a vector of 2";
    case PROP_VECTOR3: return "a vector of 3";
    case PROP_COLOR: return "a colour";
    case PROP_SPECTRUM: return "a number, a colour, a vector of 3 or a term";
    case PROP_NUMBER_OR_TERM: return "a number or a term such as cauchy()";
    case PROP_TERM: return "a term";
    case PROP_NODE: return type->choices ? with_article(arena, choice_text(arena, type->choices)) : "a node";
    case PROP_NUMBERS: return "a list of numbers";
    case PROP_VECTORS2: return "a list of vectors of 2";
    case PROP_VECTORS3: return "a list of vectors of 3";
    case PROP_VECTOR3_OR_LIST: return "a vector of 3, or a list of such";
    case PROP_NUMBER_LISTS: return "a list of lists of numbers";
    case PROP_VECTOR2_LISTS: return "a list of vectors of 2, or a list of such lists";
    case PROP_FUNCTION: return "the name of a function, declared as def f(p) = ...";
    case PROP_STRINGS: return "a list of strings";
    case PROP_RAMP: return "a list of numbers or colours, or of [position, number or colour]";
    case PROP_NODES: break;
    }
    return type->choices ? arena_format(arena, "a list of %s nodes", choice_text(arena, type->choices))
                         : "a list of nodes";
}

const char *prop_kind_text(Arena *arena, const PropType *type)
{
    const char *text = plain_kind_text(arena, type);
    return type->flags & PROP_TEXTURE ? arena_format(arena, "%s or a texture", text) : text;
}

static const char *number_text(Arena *arena, double number)
{
    char text[NUM_TEXT_SIZE];
    return arena_copy_text(arena, text, num_print_rounded(number, text));
}

static bool number_allowed(const PropType *type, double number)
{
    if (!isfinite(number)) return false;
    if (type->flags & PROP_OPEN_MIN ? number <= type->min : number < type->min) return false;
    return !(type->flags & PROP_OPEN_MAX ? number >= type->max : number > type->max);
}

/* One property at one place while it is checked. */
typedef struct Check {
    Evaluator *evaluator;
    const PropType *type;
    Expr *expr;
    size_t element; /* from 1, of a list; 0: the value itself */
} Check;

static bool node_allowed(const PropType *type, const Value *value)
{
    return value->kind == VALUE_NODE && (!type->choices || choice_allows(type->choices, value->as.node->type->name));
}

static bool is_name(const char *text)
{
    static const char digits[] = "0123456789",
                      letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_.0123456789";
    return *text && !strchr(digits, *text) && !text[strspn(text, letters)];
}

enum { LONGEST = 40 }; /* of what is written, in a hint */

static void hint_measure(const Check *check, PropUnit found, Diagnostic *report)
{
    const NodeType *owner = check->evaluator->target ? check->evaluator->target->type : NULL;
    const char *hint = owner ? habit_measure(owner->name, check->type->name, found) : NULL;
    const char *written = eval_written(check->evaluator, check->expr->span, LONGEST, "\n", "...");
    if (hint) diag_hint(check->evaluator->diag, report, "%s", habit_fill(check->evaluator->diag->arena, hint, written));
}

/* A node that another property is for, a colour for a node that has one, and a name in quotation marks. */
static void hint_node(const Check *check, const Value *value, Diagnostic *report)
{
    Diag *diag = check->evaluator->diag;
    const NodeType *owner = check->evaluator->target ? check->evaluator->target->type : NULL;
    const NodeType *wanted = check->type->choices ? schema_node(check->evaluator->schema, check->type->choices) : NULL;
    for (size_t i = 0; owner && value->kind == VALUE_NODE && i < owner->n_props; i++)
        if (owner->props[i].kind == PROP_NODE && owner->props[i].choices && node_allowed(&owner->props[i], value))
            diag_hint(diag, report, "write: %s = ...", owner->props[i].name);
    for (size_t i = 0; wanted && value->kind == VALUE_COLOR && !report->hint && i < wanted->n_props; i++)
        if (wanted->props[i].kind == PROP_COLOR)
            diag_hint(diag, report, "write: %s { %s = ... }", wanted->name, wanted->props[i].name);
    bool texture = value->kind == VALUE_NODE && value->as.node->type->flags & NODE_TEXTURE;
    for (size_t i = 0; wanted && texture && !report->hint && i < wanted->n_props; i++)
        if (wanted->props[i].flags & PROP_TEXTURE)
            diag_hint(diag, report, "write: %s { %s = %s { ... } }", wanted->name, wanted->props[i].name,
                      value->as.node->type->name);
    for (size_t i = 0; wanted && texture && !report->hint && i < wanted->n_props; i++)
        if (wanted->props[i].kind == PROP_FUNCTION) /* density = gradient { } */
            diag_hint(diag, report, "write: %s = %s { %s = f }, with: def f(p) = ... of a place", check->type->name,
                      wanted->name, wanted->props[i].name);
    if (value->kind == VALUE_NUMBER) hint_measure(check, UNIT_NONE, report);
    if (value->kind == VALUE_LIST && wanted && strcmp(wanted->name, "medium") == 0)
        diag_hint(
            diag, report,
            "one medium fills an object; further ones are of objects of their own in the same place, of which one is "
            "on top, or which add to it by mixes = true");
    /* a bare number is most likely what such a node has first: the index of a medium, the albedo of a surface */
    bool number = value->kind == VALUE_NUMBER && wanted && wanted->n_props > 0;
    if (number && (wanted->props[0].kind == PROP_NUMBER_OR_TERM || wanted->props[0].kind == PROP_COLOR))
        diag_hint(diag, report, "write: %s { %s = %s }", wanted->name, wanted->props[0].name,
                  number_allowed(&wanted->props[0], value->as.number) ? number_text(diag->arena, value->as.number)
                                                                      : "...");
    const char *color = value->kind == VALUE_STRING ? habit_word(value->as.text) : NULL;
    if (color && strncmp(color, "rgb(", 4) == 0 && wanted && wanted->n_props > 0 && wanted->props[0].kind == PROP_COLOR)
        diag_hint(diag, report, "write: %s { %s = %.*s }", wanted->name, wanted->props[0].name,
                  (int)strcspn(color, ")") + 1, color);
    else if (value->kind == VALUE_STRING && is_name(value->as.text))
        diag_hint(diag, report, "write: %s, without quotation marks", value->as.text);
}

/* A texture where all is of one colour, or a vector where a number is for all axes. */
static void hint_texture(const Check *check, const Value *value, Diagnostic *report)
{
    Diag *diag = check->evaluator->diag;
    const NodeType *owner = check->evaluator->target ? check->evaluator->target->type : NULL;
    const NodeType *found = value->kind == VALUE_NODE ? value->as.node->type : NULL;
    bool is_texture = found && (found->flags & NODE_TEXTURE || strcmp(found->name, "volume") == 0);
    if (!owner || (!is_texture && value->kind != VALUE_VECTOR3)) return;
    const char *pattern = habit_pattern(owner->name, check->type->name);
    const char *texture = is_texture ? arena_format(diag->arena, "%s { ... }", found->name) : "<x, y, z>";
    if (pattern) diag_hint(diag, report, "%s", habit_fill(diag->arena, pattern, texture));
}

static bool is_color_kind(PropKind kind)
{
    return kind == PROP_COLOR || kind == PROP_SPECTRUM;
}

static bool is_number_kind(PropKind kind)
{
    return kind == PROP_NUMBER || kind == PROP_INTEGER || kind == PROP_NUMBER_OR_TERM;
}

/* Texts of what is wanted: "#f80", "red", "0.5", "yes" */
static void hint_text(const Check *check, const char *text, Diagnostic *report)
{
    Diag *diag = check->evaluator->diag;
    PropKind kind = check->type->kind;
    const char *word = habit_word(text);
    double number;
    bool digits = *text == '#' && text[1] && !text[1 + strspn(text + 1, "0123456789abcdefABCDEF")];
    size_t n_number = num_parse(text, strlen(text), &number), n_unit = strlen(text) - n_number;
    bool read = n_number > 0 && (n_unit == 0 || unit_of(text + n_number, n_unit)); /* "5", "5mm" */
    bool vector = kind == PROP_VECTOR3 && *text == '<';
    if ((is_color_kind(kind) && digits) || (is_number_kind(kind) && read) || vector)
        diag_hint(diag, report, "write: %s, without quotation marks", text);
    else if (is_color_kind(kind) && word && strncmp(word, "rgb(", 4) == 0)
        diag_hint(diag, report, "write: %s", word);
    else if (kind == PROP_BOOL)
        diag_hint(diag, report, "write: %s",
                  strcmp(text, "false") == 0 || (word && strcmp(word, "false") == 0) ? "false" : "true");
    else if (kind == PROP_VECTOR2)
        diag_hint(diag, report, "write: <x, y>, without quotation marks");
    else if (check->type->flags & PROP_TEXTURE && (strchr(text, '.') || !is_color_kind(kind)))
        diag_hint(diag, report, "of a picture write: image { file = \"...\" }");
    else if (is_color_kind(kind))
        diag_hint(diag, report, "a colour is written rgb(.5, .1, .1), or #802020 as on a screen%s",
                  check->type->flags & PROP_TEXTURE ? "; a picture is image { file = \"...\" }" : "");
}

static bool is_vector3(PropKind kind)
{
    return kind == PROP_VECTOR3 || kind == PROP_VECTOR3_OR_LIST;
}

/* Alone, or in a list. */
static bool takes_vector3(PropKind kind)
{
    return is_vector3(kind) || kind == PROP_VECTORS3;
}

/* Some numbers as a vector or a colour. */
static void hint_numbers(const Check *check, const Value *value, Diagnostic *report)
{
    Diag *diag = check->evaluator->diag;
    PropKind kind = check->type->kind;
    bool list = value->kind == VALUE_LIST && value->as.list->element == VALUE_NUMBER;
    size_t n = list ? value_count(value) : value_width(value->kind);
    const double *v = list ? value->as.list->numbers : value->as.v;
    /* an index of each colour, in the order of rgb() */
    if (kind == PROP_NUMBER_OR_TERM && n == 3)
        diag_hint(diag, report,
                  "of one that goes with the colour write: spectrum([<450, %g>, <550, %g>, <650, %g>]), or "
                  "cauchy(a, b)",
                  v[2], v[1], v[0]);
    if (!list && value->kind != VALUE_VECTOR3) return;
    if (is_color_kind(kind) && n == 3) diag_hint(diag, report, "write: rgb(%g, %g, %g)", v[0], v[1], v[2]);
    if (takes_vector3(kind) && n == 3) diag_hint(diag, report, "write: <%g, %g, %g>", v[0], v[1], v[2]);
    if (kind == PROP_VECTOR2 && n == 2) diag_hint(diag, report, "write: <%g, %g>", v[0], v[1]);
    if (kind == PROP_RAMP && n == 3) diag_hint(diag, report, "write: rgb(%g, %g, %g)", v[0], v[1], v[2]);
    if (kind == PROP_VECTORS2 && (!list || n == 2)) diag_hint(diag, report, "write: <%g, %g>", v[0], v[1]);
}

/* A colour where a number says how bright something of another property's colour is. */
static void hint_brightness(const Check *check, const Value *value, Diagnostic *report)
{
    static const char *const colors[] = {"color", "emission"};
    const NodeType *owner = check->evaluator->target ? check->evaluator->target->type : NULL;
    if (!owner || (value->kind != VALUE_COLOR && value->kind != VALUE_VECTOR3) ||
        !habit_is_one_of("radiance intensity power strength", check->type->name))
        return;
    for (size_t i = 0; i < COUNT_OF(colors) && !report->hint; i++) {
        const PropType *color = schema_prop(owner, colors[i]);
        if (color && is_color_kind(color->kind))
            diag_hint(check->evaluator->diag, report,
                      "the colour is one property, and how bright it is another: %s = %s  %s = 1", color->name,
                      eval_written(check->evaluator, check->expr->span, LONGEST, "\n", "..."), check->type->name);
    }
}

/* A term's only number, most likely. */
static void hint_term(const Check *check, double number, Diagnostic *report)
{
    Diag *diag = check->evaluator->diag;
    const NodeType *owner = check->evaluator->target ? check->evaluator->target->type : NULL;
    const char *hint = owner ? habit_measure(owner->name, check->type->name, UNIT_NONE) : NULL;
    const char *text = fabs(number) < 1 ? number_text(diag->arena, number) : "...";
    if (hint) diag_hint(diag, report, "%s", habit_fill(diag->arena, hint, text));
}

/* How a value of the wanted kind is written, where that is not plain from its name. */
static void hint_form(const Check *check, const Value *value, Diagnostic *report)
{
    Diag *diag = check->evaluator->diag;
    PropKind kind = check->type->kind;
    bool number = value->kind == VALUE_NUMBER, parts = number || value->kind == VALUE_LIST;
    if (kind == PROP_BOOL && number) diag_hint(diag, report, "write: %s", value->as.number != 0 ? "true" : "false");
    if (kind == PROP_CHOICE && value->kind == VALUE_BOOL) {
        const char *choice = habit_choice(check->type->name, value->as.truth ? "yes" : "no");
        if (choice && choice_allows(check->type->choices, choice)) diag_hint(diag, report, "write: %s", choice);
    }
    if (is_vector3(kind) && number && eval_hint_at_axis(check->evaluator, report, check->expr)) return;
    if (is_vector3(kind) && number) hint_measure(check, UNIT_NONE, report);
    if (kind == PROP_NUMBER) hint_brightness(check, value, report);
    if (kind == PROP_TERM && number) hint_term(check, value->as.number, report);
    if ((kind == PROP_TERM || kind == PROP_NUMBER_OR_TERM) && value->kind == VALUE_NODE &&
        strcmp(value->as.node->type->name, "medium") == 0)
        diag_hint(diag, report, "an object takes a whole medium: interior = %s",
                  eval_written(check->evaluator, check->expr->span, 40, "\n{", "NAME"));
    if (report->hint) return;
    if ((is_vector3(kind) || kind == PROP_VECTOR2) && number) {
        const char *axes = is_vector3(kind) ? "<x, y, z>" : "<x, y>";
        diag_hint(diag, report, "write: %s, or vec%d(%g) for the same of each", axes, is_vector3(kind) ? 3 : 2,
                  value->as.number);
        return;
    }
    if (kind == PROP_INTEGER && value->kind == VALUE_RANGE)
        diag_hint(diag, report, "write: %zu, as many as these are", value_count(value));
    if (is_vector3(kind) && value->kind == VALUE_NODE && value->as.node->type->flags & NODE_PLACED)
        diag_hint(diag, report, "write: bounds(%s).center, the middle of it",
                  eval_written(check->evaluator, check->expr->span, 32, "\n{", "NODE"));
    hint_numbers(check, value, report);
    if (report->hint) return;
    if (takes_vector3(kind) && parts) diag_hint(diag, report, "write: <x, y, z>");
    if ((kind == PROP_VECTOR2 || kind == PROP_VECTORS2) && parts) diag_hint(diag, report, "write: <x, y>");
    if (kind == PROP_NODE)
        hint_node(check, value, report);
    else
        hint_texture(check, value, report);
    if (value->kind == VALUE_STRING) hint_text(check, value->as.text, report);
}

static bool wrong_type(const Check *check, const Value *value)
{
    Arena *arena = check->evaluator->arena;
    const char *found = value_describe(arena, value), *kind = prop_kind_text(arena, check->type),
               *name = check->type->name;
    Diagnostic *report =
        check->element
            ? eval_error(check->evaluator, check->expr, D_WRONG_TYPE, "'%s' wants %s, but element %zu is %s", name,
                         kind, check->element - 1, found)
            : eval_error(check->evaluator, check->expr, D_WRONG_TYPE, "'%s' wants %s, not %s", name, kind, found);
    hint_form(check, value, report);
    return false;
}

const char *schema_bounds_text(Arena *arena, const PropType *type)
{
    bool has_min = isfinite(type->min), has_max = isfinite(type->max);
    const char *min = number_text(arena, type->min), *max = number_text(arena, type->max);
    bool open_min = type->flags & PROP_OPEN_MIN, open_max = type->flags & PROP_OPEN_MAX;
    if (!has_max) return arena_format(arena, "is not %s %s", open_min ? "greater than" : "at least", min);
    if (!has_min) return arena_format(arena, "is not %s %s", open_max ? "less than" : "at most", max);
    if (!open_min && !open_max) return arena_format(arena, "is outside %s..%s", min, max);
    return arena_format(arena, "is not %s %s and %s %s", open_min ? "greater than" : "at least", min,
                        open_max ? "less than" : "at most", max);
}

/* rgb(255, 128, 0) */
static bool are_bytes(const double *numbers, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (numbers[i] < 0 || numbers[i] > 255 || numbers[i] != floor(numbers[i])) return false;
    return n == 3;
}

static void hint_bytes(const Check *check, const double *numbers, size_t n, Diagnostic *report)
{
    if (!is_color_kind(check->type->kind) || !are_bytes(numbers, n)) return;
    if (numbers[0] == numbers[1] && numbers[1] == numbers[2] && numbers[0] < 8) { /* albedo = 2 */
        diag_hint(check->evaluator->diag, report, "it is a part of the light; 1 is all of it");
        return;
    }
    diag_hint(check->evaluator->diag, report, "of a screen's values from 0 to 255 write: #%02x%02x%02x",
              (unsigned)numbers[0], (unsigned)numbers[1], (unsigned)numbers[2]);
}

/* A roughness of 30: one that counts in hundredths? */
static void hint_hundredths(const Check *check, double number, Diagnostic *report)
{
    const PropType *type = check->type;
    if (type->kind != PROP_NUMBER || type->min != 0 || type->max != 1 || !(number >= 2) || number > 100) return;
    Diag *diag = check->evaluator->diag;
    diag_hint(diag, report, "where hundredths are meant, write: %s", number_text(diag->arena, number / 100));
}

static bool is_plain_literal(const Expr *expr)
{
    if (expr->kind == EXPR_DIVIDE) return is_plain_literal(expr->as.op.a) && is_plain_literal(expr->as.op.b); /* 1/50 */
    return expr->kind == EXPR_CONSTANT && expr->literal && !expr->as.constant.unit;
}

/* Right values that nobody means: the shutter of 1/50 degree, a light of rgb(255, 255, 255). */
static void warn_of_unlikely(const Check *check, const double *numbers, size_t n)
{
    Evaluator *evaluator = check->evaluator;
    const PropType *type = check->type;
    const NodeType *owner = evaluator->target ? evaluator->target->type : NULL;
    Expr *expr = check->expr;
    const char *what,
        *hint = owner && is_plain_literal(expr) ? habit_unlikely(owner->name, type->name, numbers[0], &what) : NULL;
    if (hint) {
        const char *text = arena_format(evaluator->arena, "%g", numbers[0]); /* 1/60 */
        Diagnostic *report =
            eval_error(evaluator, expr, D_UNLIKELY_VALUE, "'%s' is %s, and %s is hardly meant", type->name, what, text);
        diag_hint(evaluator->diag, report, "%s", habit_fill(evaluator->diag->arena, hint, text));
    }
    bool rgb = expr->kind == EXPR_CALL_BUILTIN && strcmp(expr->as.call.name, "rgb") == 0 && type->unit == UNIT_NONE;
    if (!rgb || !are_bytes(numbers, n)) return;
    double most = fmax(numbers[0], fmax(numbers[1], numbers[2]));
    if (most >= 64)
        hint_bytes(check, numbers, n,
                   eval_error(evaluator, expr, D_UNLIKELY_VALUE,
                              "the white of a screen is 1 for '%s', and %s is hardly meant", type->name,
                              number_text(evaluator->arena, most)));
}

/* A number that a property does not take, in all of its digits where it misses what is taken by a few of them. */
static const char *refused_text(Arena *arena, const PropType *type, double number)
{
    const char *text = number_text(arena, number);
    char exact[NUM_TEXT_SIZE];
    if (type->kind != PROP_INTEGER && strcmp(text, number_text(arena, type->min)) != 0 &&
        strcmp(text, number_text(arena, type->max)) != 0)
        return text;
    return arena_copy_text(arena, exact, num_print(number, exact));
}

static bool check_numbers(const Check *check, const double *numbers, size_t n)
{
    const PropType *type = check->type;
    for (size_t i = 0; i < n; i++) {
        if (number_allowed(type, numbers[i]) && (type->kind != PROP_INTEGER || numbers[i] == floor(numbers[i])))
            continue;
        Arena *arena = check->evaluator->arena;
        const char *text = refused_text(arena, type, numbers[i]);
        if (!isfinite(numbers[i]))
            eval_error(check->evaluator, check->expr, D_BAD_NUMBER, "'%s' is not finite", type->name);
        else if (!number_allowed(type, numbers[i])) {
            Diagnostic *report = eval_error(check->evaluator, check->expr, D_VALUE_OUT_OF_RANGE, "%s %s %s", type->name,
                                            text, schema_bounds_text(arena, type));
            hint_bytes(check, numbers, n, report);
            hint_hundredths(check, numbers[i], report);
        } else
            eval_error(check->evaluator, check->expr, D_WRONG_TYPE, "'%s' wants a whole number, not %s", type->name,
                       text);
        return false;
    }
    if (n > 0) warn_of_unlikely(check, numbers, n);
    return true;
}

/* ---- units of literals ---- */

/* "1/2mm", which is the half of one over a millimetre */
static bool check_quotient(const Check *check, Expr *expr)
{
    const Expr *a = expr->as.op.a, *b = expr->as.op.b;
    PropUnit wanted = check->type->unit;
    bool over = a->kind == EXPR_CONSTANT && !a->as.constant.unit && b->kind == EXPR_CONSTANT && b->as.constant.unit;
    if (!over || wanted == UNIT_NONE || wanted == UNIT_PER_LENGTH || wanted == UNIT_ANY) return true;
    const UnitType *unit = b->as.constant.unit;
    Diagnostic *report = eval_error(check->evaluator, expr, D_WRONG_UNIT, "'%s' is %s, not 1 over %s",
                                    check->type->name, unit_measure_text(wanted), unit_measure_text(unit->measure));
    if (unit->measure == wanted)
        diag_hint(check->evaluator->diag, report, "write: %s%s / %.*s",
                  eval_written(check->evaluator, a->span, 16, "\n", "1"), unit->name,
                  (int)(b->span.end - b->span.begin - strlen(unit->name)),
                  eval_written(check->evaluator, b->span, 16, "\n", "2"));
    else
        hint_measure(check, unit->measure, report);
    return false;
}

/* A literal says what it measures; the language does not follow units through computations. */
static bool check_unit(const Check *check, Expr *expr)
{
    PropUnit wanted = check->type->unit;
    PropKind kind = check->type->kind;
    if (kind == PROP_NODE || kind == PROP_NODES || kind == PROP_BOOL || kind == PROP_FUNCTION) return true;
    if (expr->kind == EXPR_DIVIDE) return check_quotient(check, expr);
    if (expr->kind == EXPR_VECTOR || expr->kind == EXPR_LIST) {
        for (uint32_t i = 0; i < expr->as.list.n; i++)
            if (!check_unit(check, expr->as.list.items[i])) return false;
        return true;
    }
    if (expr->kind != EXPR_CONSTANT || !expr->as.constant.unit) return true;
    PropUnit found = expr->as.constant.unit->measure;
    if (found == wanted || wanted == UNIT_ANY) return true;
    hint_measure(check, found,
                 eval_error(check->evaluator, expr, D_WRONG_UNIT, "'%s' is %s, not %s", check->type->name,
                            unit_measure_text(wanted), unit_measure_text(found)));
    return false;
}

/* ---- one value ---- */

static bool check_choice(const Check *check, const char *word, EvalProp *prop)
{
    Evaluator *evaluator = check->evaluator;
    const PropType *type = check->type;
    if (!choice_allows(type->choices, word)) {
        const char *words[MAX_CHOICES];
        size_t n = choice_words(evaluator->arena, type->choices, words, MAX_CHOICES);
        Diagnostic *report = eval_error(evaluator, check->expr, D_UNKNOWN_CHOICE, "'%s' is %s, not '%s'", type->name,
                                        choice_text(evaluator->arena, type->choices), word);
        const char *other = choice_meant(evaluator->arena, type, word);
        const char *instead = habit_instead(type->name, word);
        if (other || instead)
            diag_hint(evaluator->diag, report, other ? "write: %s" : "%s", other ? other : instead);
        else
            diag_suggest(evaluator->diag, report, word, words, n);
        return false;
    }
    prop->as.text = word;
    return true;
}

static bool check_vector(const Check *check, const Value *value, unsigned width, EvalProp *prop)
{
    if (value->kind != value_vector_kind(width)) return wrong_type(check, value);
    memcpy(prop->as.vector, value->as.v, width * sizeof(double));
    return check_numbers(check, value->as.v, width);
}

static bool check_color(const Check *check, const Value *value, EvalProp *prop)
{
    if (value->kind != VALUE_NUMBER && value->kind != VALUE_COLOR) return wrong_type(check, value);
    for (int i = 0; i < 3; i++) prop->as.vector[i] = value->as.v[value->kind == VALUE_NUMBER ? 0 : i];
    return check_numbers(check, prop->as.vector, 3);
}

static bool check_spectrum(const Check *check, const Value *value, EvalProp *prop)
{
    unsigned width = value_width(value->kind);
    if (value->kind == VALUE_TERM) {
        prop->as.spectrum.form = SPECTRUM_TERM;
        prop->as.spectrum.term = value->as.term;
        return true;
    }
    PropKind kind = check->type->kind;
    if (kind == PROP_TERM || (width != 1 && (width != 3 || kind == PROP_NUMBER_OR_TERM)))
        return wrong_type(check, value);
    prop->as.spectrum.form = value->kind == VALUE_NUMBER  ? SPECTRUM_NUMBER
                             : value->kind == VALUE_COLOR ? SPECTRUM_COLOR
                                                          : SPECTRUM_VECTOR;
    memcpy(prop->as.spectrum.rgb, value->as.v, width * sizeof(double));
    return check_numbers(check, value->as.v, width);
}

/* ---- lists ---- */

/* Numbers in each element of a list. */
static unsigned list_width(PropKind kind)
{
    if (kind == PROP_NUMBERS || kind == PROP_NUMBER_LISTS) return 1;
    return kind == PROP_VECTORS2 || kind == PROP_VECTOR2_LISTS ? 2 : 3;
}

static bool check_number_list(const Check *check, const Value *value, EvalProp *prop)
{
    Check element = *check;
    unsigned width = list_width(check->type->kind);
    ValueKind wanted = width == 1 ? VALUE_NUMBER : value_vector_kind(width);
    bool single =
        value->kind == wanted && (width == 1 || check->type->kind == PROP_VECTOR3_OR_LIST); /* a list of one */
    if (!single && value->kind != VALUE_LIST && value->kind != VALUE_RANGE) return wrong_type(check, value);
    size_t n = single ? 1 : value_count(value);
    if (value->kind == VALUE_LIST && value->as.list->element == wanted) {
        prop->as.list.n = n;
        prop->as.list.numbers = value->as.list->numbers;
        return check_numbers(check, prop->as.list.numbers, n * width);
    }
    if (!eval_reserve(check->evaluator, (double)n * width * sizeof(double), check->expr->span)) return false;
    double *numbers = ARENA_ARRAY(check->evaluator->arena, double, n *width);
    for (size_t i = 0; i < n; i++) {
        if (!eval_step(check->evaluator, check->expr->span)) return false;
        Value item = single ? *value : value_element(value, i);
        element.element = single ? 0 : i + 1;
        if (item.kind == VALUE_POISON) return false;
        if (item.kind != wanted) return wrong_type(&element, &item);
        memcpy(numbers + i * width, item.as.v, width * sizeof(double));
    }
    prop->as.list.n = n;
    prop->as.list.numbers = numbers;
    return check_numbers(check, numbers, n * width);
}

/* Lists of lists: the elements one behind the other, and the lengths. */
static bool check_number_lists(const Check *check, const Value *value, EvalProp *prop)
{
    Evaluator *evaluator = check->evaluator;
    unsigned width = list_width(check->type->kind);
    if (value->kind != VALUE_LIST) return wrong_type(check, value);
    size_t n_lists = value_count(value), n = 0;
    Value first = n_lists ? value_element(value, 0) : value_none();
    bool single = check->type->kind == PROP_VECTOR2_LISTS && first.kind == VALUE_VECTOR2;
    if (single) n_lists = 1;
    if (!eval_reserve(evaluator, (double)n_lists * sizeof(EvalProp), check->expr->span)) return false;
    EvalProp *parts = ARENA_ARRAY(evaluator->arena, EvalProp, n_lists);
    size_t *lengths = ARENA_ARRAY(evaluator->arena, size_t, n_lists);
    Check element = *check;
    for (size_t i = 0; i < n_lists; i++) {
        Value item = single ? *value : value_element(value, i);
        element.element = single ? 0 : i + 1;
        if (item.kind == VALUE_POISON) return false;
        if (item.kind != VALUE_LIST && item.kind != VALUE_RANGE) return wrong_type(&element, &item);
        element.element = 0;
        if (!check_number_list(&element, &item, &parts[i])) return false;
        lengths[i] = parts[i].as.list.n;
        n += lengths[i];
    }
    if (!eval_reserve(evaluator, (double)n * width * sizeof(double), check->expr->span)) return false;
    double *numbers = ARENA_ARRAY(evaluator->arena, double, n *width);
    prop->as.list.n = n;
    prop->as.list.numbers = numbers;
    prop->as.list.n_lists = n_lists;
    prop->as.list.lengths = lengths;
    for (size_t i = 0; i < n_lists; numbers += width * lengths[i], i++)
        if (lengths[i]) memcpy(numbers, parts[i].as.list.numbers, lengths[i] * width * sizeof *numbers);
    return true;
}

/* One value of a ramp: numbers gets its position and three channels. */
static bool check_stop(const Check *check, const Value *item, double place, double *numbers, bool *color)
{
    Value value = *item;
    if (item->kind == VALUE_LIST) {
        if (value_count(item) != 2) return wrong_type(check, item);
        Value position = value_element(item, 0);
        value = value_element(item, 1);
        if (position.kind == VALUE_POISON) return false;
        if (position.kind != VALUE_NUMBER) return wrong_type(check, item);
        place = position.as.number;
    }
    if (value.kind == VALUE_POISON) return false;
    if (value.kind != VALUE_NUMBER && value.kind != VALUE_COLOR) return wrong_type(check, item);
    *color = value.kind == VALUE_COLOR;
    numbers[0] = place;
    for (int i = 0; i < 3; i++) numbers[1 + i] = value.as.v[*color ? i : 0];
    if (isfinite(place) && place >= 0 && place <= 1) return check_numbers(check, numbers + 1, 3);
    eval_error(check->evaluator, check->expr, D_VALUE_OUT_OF_RANGE, "the position %g in '%s' is outside 0..1", place,
               check->type->name);
    return false;
}

static bool check_ramp(const Check *check, const Value *value, EvalProp *prop)
{
    Evaluator *evaluator = check->evaluator;
    size_t n = value->kind == VALUE_LIST ? value_count(value) : 0;
    if (n == 0) return wrong_type(check, value);
    if (!eval_reserve(evaluator, (double)n * 4 * sizeof(double), check->expr->span)) return false;
    double *numbers = ARENA_ARRAY(evaluator->arena, double, 4 * n);
    Check element = *check;
    size_t n_colors = 0, n_placed = 0;
    for (size_t i = 0; i < n; i++) {
        if (!eval_step(evaluator, check->expr->span)) return false;
        Value item = value_element(value, i);
        bool color = false;
        element.element = i + 1;
        if (item.kind == VALUE_POISON) return false;
        if (!check_stop(&element, &item, n > 1 ? (double)i / (double)(n - 1) : 0, numbers + 4 * i, &color))
            return false;
        n_colors += color;
        n_placed += item.kind == VALUE_LIST;
        if (n_placed != 0 && n_placed != i + 1) return wrong_type(&element, &item);
        if (i == 0 || numbers[4 * i] >= numbers[4 * i - 4]) continue;
        eval_error(evaluator, check->expr, D_VALUE_OUT_OF_RANGE, "positions in '%s' ascend, but %g stands behind %g",
                   check->type->name, numbers[4 * i], numbers[4 * i - 4]);
        return false;
    }
    prop->as.list.n = n;
    prop->as.list.n_lists = n_colors;
    prop->as.list.numbers = numbers;
    return true;
}

static bool check_string_list(const Check *check, const Value *value, EvalProp *prop)
{
    bool single = value->kind == VALUE_STRING;
    if (!single && value->kind != VALUE_LIST) return wrong_type(check, value);
    size_t n = single ? 1 : value_count(value);
    const char **texts = ARENA_ARRAY(check->evaluator->arena, const char *, n);
    Check element = *check;
    for (size_t i = 0; i < n; i++) {
        Value item = single ? *value : value_element(value, i);
        element.element = single ? 0 : i + 1;
        if (item.kind == VALUE_POISON) return false;
        if (item.kind != VALUE_STRING) return wrong_type(&element, &item);
        EvalProp word = {0};
        if (check->type->choices && !check_choice(&element, item.as.text, &word)) return false;
        texts[i] = item.as.text;
    }
    prop->as.list.n = n;
    prop->as.list.texts = texts;
    return true;
}

static bool check_node_list(const Check *check, const Value *value, EvalProp *prop)
{
    bool single = value->kind == VALUE_NODE;
    if (!single && value->kind != VALUE_LIST) return wrong_type(check, value);
    size_t n = single ? 1 : value_count(value);
    const EvalNode **nodes = ARENA_ARRAY(check->evaluator->arena, const EvalNode *, n);
    Check element = *check;
    for (size_t i = 0; i < n; i++) {
        Value item = single ? *value : value_element(value, i);
        element.element = single ? 0 : i + 1;
        if (item.kind == VALUE_POISON) return false;
        if (!node_allowed(check->type, &item)) return wrong_type(&element, &item);
        nodes[i] = item.as.node;
    }
    prop->as.list.n = n;
    prop->as.list.nodes = nodes;
    return true;
}

/* ---- all ---- */

static bool check_value(const Check *check, const Value *value, EvalProp *prop)
{
    const PropType *type = check->type;
    if (type->flags & PROP_TEXTURE && value->kind == VALUE_NODE && value->as.node->type->flags & NODE_TEXTURE) {
        prop->textured = true;
        prop->as.node = value->as.node;
        return true;
    }
    switch (type->kind) {
    case PROP_NUMBER:
    case PROP_INTEGER:
        if (value->kind != VALUE_NUMBER) return wrong_type(check, value);
        prop->as.number = value->as.number;
        return check_numbers(check, &value->as.number, 1);
    case PROP_BOOL:
        if (value->kind != VALUE_BOOL) return wrong_type(check, value);
        prop->as.truth = value->as.truth;
        return true;
    case PROP_STRING:
        if (value->kind != VALUE_STRING) return wrong_type(check, value);
        prop->as.text = value->as.text;
        return true;
    case PROP_CHOICE: /* none is a keyword, and yet a good word for a choice */
        if (value->kind == VALUE_NONE && choice_allows(type->choices, "none")) return check_choice(check, "none", prop);
        return value->kind == VALUE_STRING ? check_choice(check, value->as.text, prop) : wrong_type(check, value);
    case PROP_VECTOR2: return check_vector(check, value, 2, prop);
    case PROP_VECTOR3: return check_vector(check, value, 3, prop);
    case PROP_COLOR: return check_color(check, value, prop);
    case PROP_SPECTRUM:
    case PROP_NUMBER_OR_TERM:
    case PROP_TERM: return check_spectrum(check, value, prop);
    case PROP_NODE:
        if (!node_allowed(type, value)) return wrong_type(check, value);
        prop->as.node = value->as.node;
        return true;
    case PROP_NUMBERS:
    case PROP_VECTORS2:
    case PROP_VECTORS3:
    case PROP_VECTOR3_OR_LIST: return check_number_list(check, value, prop);
    case PROP_NUMBER_LISTS:
    case PROP_VECTOR2_LISTS: return check_number_lists(check, value, prop);
    case PROP_FUNCTION: return wrong_type(check, value);
    case PROP_STRINGS: return check_string_list(check, value, prop);
    case PROP_RAMP: return check_ramp(check, value, prop);
    case PROP_NODES: break;
    }
    return check_node_list(check, value, prop);
}

/* A list that may hold bare words: those of the choices are strings, whatever else bears the name. What is none of them,
 * a name or in quotes, is reported in its place. */
static bool words_to_strings(const Check *check, Expr *expr)
{
    for (uint32_t i = 0; expr->kind == EXPR_LIST && i < expr->as.list.n; i++) {
        Expr *item = expr->as.list.items[i];
        const char *word = word_of(item);
        Check of_item = {.evaluator = check->evaluator, .type = check->type, .expr = item};
        EvalProp prop = {0};
        bool is_variable = word && item->kind != EXPR_NAME;
        if (!word) word = word_or_text(item);
        if (!word || (is_variable && !choice_allows(check->type->choices, word))) continue;
        if (!check_choice(&of_item, word, &prop)) return false;
        item->kind = EXPR_CONSTANT;
        item->as.constant.value = value_text(word);
        item->as.constant.unit = NULL;
    }
    return true;
}

/* The name of a function stands for a texture of its values. */
static bool texture_of_function(const Check *check, EvalProp *prop)
{
    Evaluator *evaluator = check->evaluator;
    const NodeType *type = NULL;
    for (size_t i = 0; i < evaluator->schema->n_nodes; i++)
        if (evaluator->schema->nodes[i].flags & NODE_FORMULA) type = &evaluator->schema->nodes[i];
    const EvalFunctionValue *function = type ? eval_capture(evaluator, check->expr, true) : NULL;
    if (!function) return false;
    EvalNode *node = ARENA_NEW(evaluator->arena, EvalNode);
    *node =
        (EvalNode){.type = type, .span = check->expr->span, .transform = affine_identity(), .n_props = 1, .depth = 1};
    node->props = ARENA_NEW(evaluator->arena, EvalProp);
    *node->props = (EvalProp){.type = &type->props[0], .span = check->expr->span, .as.function = function};
    prop->textured = true;
    prop->as.node = node;
    return true;
}

/* The nearest to a number that the property takes. */
static double nearest_allowed(const PropType *type, double number)
{
    const double beside_open_end = 1e-6; /* of an end that is not taken itself: as good as there */
    if (number_allowed(type, number) || !isfinite(number)) return number;
    double low = type->min, high = type->max;
    if (type->flags & PROP_OPEN_MIN) low += beside_open_end * fmax(1, fabs(low));
    if (type->flags & PROP_OPEN_MAX) high -= beside_open_end * fmax(1, fabs(high));
    return number > low ? high : low;
}

/* A fade that ends with the clock goes on while the last frame's shutter is open, and nobody would say that it is wrong. */
static Value near_value(const PropType *type, const Value *value)
{
    Value near = *value;
    bool numbers = type->kind == PROP_NUMBER || type->kind == PROP_VECTOR2 || type->kind == PROP_VECTOR3 ||
                   type->kind == PROP_COLOR || type->kind == PROP_SPECTRUM || type->kind == PROP_NUMBER_OR_TERM;
    unsigned width = numbers ? value_width(value->kind) : 0;
    for (unsigned i = 0; i < width; i++) near.as.v[i] = nearest_allowed(type, near.as.v[i]);
    return near;
}

bool prop_check(Evaluator *evaluator, const PropType *type, Expr *expr, EvalProp *prop)
{
    Check check = {.evaluator = evaluator, .type = type, .expr = expr};
    *prop = (EvalProp){.type = type, .span = expr->span};
    if (type->kind == PROP_CHOICE) {
        const char *word = word_of(expr);
        if (word && (expr->kind == EXPR_NAME || choice_allows(type->choices, word)))
            return check_choice(&check, word, prop);
    }
    if (type->kind == PROP_STRINGS && type->choices) {
        const char *word = word_of(expr);
        if (word && choice_allows(type->choices, word)) {
            Value value = value_text(word);
            return check_string_list(&check, &value, prop);
        }
        if (!words_to_strings(&check, expr)) return false;
    }
    if (type->kind == PROP_FUNCTION && expr->kind == EXPR_FUNCTION) {
        prop->as.function = eval_capture(evaluator, expr, type->flags & PROP_PLACE);
        return prop->as.function != NULL;
    }
    if (type->flags & PROP_TEXTURE && expr->kind == EXPR_FUNCTION) return texture_of_function(&check, prop);
    if (!check_unit(&check, expr)) return false;
    Value room;
    const Value *value = eval_operand(evaluator, expr, &room);
    if (value->kind == VALUE_NONE) {
        if (type->kind == PROP_CHOICE && choice_allows(type->choices, "none"))
            prop->as.text = "none"; /* a word of the language, and of this property */
        else
            prop->type = NULL;
        return true;
    }
    if (value->kind == VALUE_POISON) return false;
    if (evaluator->options->beyond) {
        room = near_value(type, value);
        value = &room;
    }
    return check_value(&check, value, prop);
}

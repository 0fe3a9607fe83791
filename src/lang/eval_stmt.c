/* eval_stmt.c - running statements.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "lang/evaluator.h"
#include "lang/habits.h"
#include "lang/lex.h"

/* ---- transforms ---- */

static void eval_apply_transform(Evaluator *evaluator, const Affine *transform, Span span)
{
    Target *target = evaluator->target;
    bool fits = target && (target->def || (target->type && target->type->flags & NODE_TRANSFORMS));
    if (fits)
        target->transform = affine_compose(transform, &target->transform);
    else if (target && target->type) {
        Diagnostic *report = eval_report(evaluator, D_MISPLACED, span, "'%s' takes no transforms", target->type->name);
        const char *advice = habit_advice(target->type->name, "transforms");
        if (advice) diag_hint(evaluator->diag, report, "%s", advice);
    } else
        diag_hint(evaluator->diag, eval_report(evaluator, D_MISPLACED, span, "a transform outside of a node"),
                  "it stands in the block of what it moves, or in a group: group { NAME(...)  translate(...) }");
}

/* ---- calls ---- */

static void call_stmt(Evaluator *evaluator, Stmt *stmt)
{
    Expr *call = stmt->as.call.call;
    Block *block = stmt->as.call.block;
    if (call->kind == EXPR_CALL_DEF && call->as.call.to.def->block) {
        eval_call_macro(evaluator, call, block);
        return;
    }
    Value value;
    evaluator->newest_transform = NULL;
    eval_value(evaluator, call, &value);
    if (block && call->kind != EXPR_POISON) {
        Diagnostic *report = eval_report(evaluator, D_NOT_A_MACRO, call->span, "'%s' is no macro and takes no block",
                                         call->as.call.name);
        if (value.kind == VALUE_TRANSFORM)
            diag_hint(evaluator->diag, report, "write: group { %s(...)  ... }", call->as.call.name);
        else if (value.kind == VALUE_NODE)
            diag_hint(evaluator->diag, report, "write: let object = %s(...)  object { ... }", call->as.call.name);
    } else if (value.kind == VALUE_TRANSFORM) {
        eval_apply_transform(evaluator, value.as.transform, stmt->span);
        /* one that was made for this statement is of no more use: instances may be many */
        if (value.as.transform == evaluator->newest_transform) evaluator->free_transform = evaluator->newest_transform;
    } else if (value.kind == VALUE_NODE) {
        eval_place_value(evaluator, value.as.node, stmt->span);
    } else if (value.kind != VALUE_POISON && value.kind != VALUE_NONE) {
        Diagnostic *report =
            eval_error(evaluator, call, D_UNUSED_VALUE, "the value of '%s' is not used", call->as.call.name);
        const Source *source = &evaluator->diag->sources->sources[call->span.source];
        uint32_t at = call->span.begin;
        while (at > 0 && source->text[at - 1] == ' ') at--;
        if (at > 0 && at < call->span.begin && strchr("0123456789.)", source->text[at - 1])) /* radius = 1 + 2 sin(a) */
            diag_hint(evaluator->diag, report, "a product is written with '*': ... * %s(...)", call->as.call.name);
    }
}

static void kids_stmt(Evaluator *evaluator)
{
    Frame *frame = evaluator->frame;
    while (frame->def && !frame->def->block) frame = frame->lexical; /* not reached: functions hold no statements */
    if (!frame->children) return;
    Frame *here = evaluator->frame;
    Block *children = frame->children;
    evaluator->frame = frame->children_frame;
    eval_block(evaluator, children);
    evaluator->frame = here;
}

/* ---- names ---- */

static void bind_stmt(Evaluator *evaluator, Stmt *stmt)
{
    Value value;
    Expr *expr = stmt->as.bind.value;
    if (expr->kind == EXPR_NODE) evaluator->bind_name = stmt->as.bind.name->text;
    /* let red = dye(.5); what loops and macros make so again and again stays without a name, and one where it is the same */
    if (stmt->as.bind.at_top) eval_name_result(evaluator, expr, stmt->as.bind.name->text);
    eval_value(evaluator, expr, &value);
    *eval_slot(evaluator, stmt->as.bind.slot) = value;
}

static Define *define_of(Evaluator *evaluator, const char *name)
{
    for (size_t i = evaluator->n_defines; i-- > 0;)
        if (strcmp(evaluator->defines[i].name, name) == 0) return &evaluator->defines[i];
    return NULL;
}

/* The unit of what an expression of literals measures, by the first of them that has one; NULL: none, or it is not plain. */
static const UnitType *unit_of_literal(const Expr *expr)
{
    const UnitType *unit = NULL, *other;
    switch (expr->kind) {
    case EXPR_CONSTANT: return expr->as.constant.unit;
    case EXPR_NEGATE:
    case EXPR_PLUS: return unit_of_literal(expr->as.op.a);
    case EXPR_RANGE:
    case EXPR_ADD:
    case EXPR_SUBTRACT: unit = unit_of_literal(expr->as.op.a); return unit ? unit : unit_of_literal(expr->as.op.b);
    case EXPR_MULTIPLY:
        unit = unit_of_literal(expr->as.op.a), other = unit_of_literal(expr->as.op.b);
        return !unit ? other : other ? NULL : unit;
    case EXPR_VECTOR:
    case EXPR_LIST:
        for (uint32_t i = 0; !unit && i < expr->as.list.n; i++) unit = unit_of_literal(expr->as.list.items[i]);
        return unit;
    default: return NULL;
    }
}

/* A parameter measures what its default does, or its range. */
static const UnitType *unit_of_param(const Stmt *stmt)
{
    const UnitType *unit = unit_of_literal(stmt->as.bind.value);
    return unit || !stmt->as.bind.range ? unit : unit_of_literal(stmt->as.bind.range);
}

/* -D may not give it a unit of another kind. */
static bool unit_fits(Evaluator *evaluator, const Stmt *stmt, const Define *define)
{
    const UnitType *wanted = unit_of_param(stmt), *given = unit_of_literal(define->expr);
    if (!wanted || !given || wanted->measure == given->measure) return true;
    Diagnostic *report =
        eval_report(evaluator, D_WRONG_UNIT, define->expr->span, "parameter '%s' is %s, not %s",
                    stmt->as.bind.name->text, unit_measure_text(wanted->measure), unit_measure_text(given->measure));
    diag_note(evaluator->diag, report, stmt->as.bind.name_span, "declared here");
    return false;
}

/* NULL: it is not a single word. */
static const char *bare_word(const Expr *expr)
{
    if (expr->kind == EXPR_NAME) return expr->as.name.symbol->text;
    if (expr->kind != EXPR_CONSTANT) return NULL;
    const Value *value = &expr->as.constant.value;
    if (value->kind == VALUE_BOOL) return value->as.truth ? "true" : "false";
    return value->kind == VALUE_NONE ? "none" : NULL;
}

/* The value that -D gives. A bare word counts as a string when one is wanted: shells eat quotes. */
static bool take_define(Evaluator *evaluator, Stmt *stmt, Define *define, Value *value)
{
    define->used = true;
    Value given = define->value;
    const char *word = bare_word(define->expr);
    if (word && value->kind == VALUE_STRING)
        given = value_text(word);
    else if (define->expr->kind == EXPR_NAME)
        eval_value(evaluator, define->expr, &given);
    if (given.kind == VALUE_POISON || !unit_fits(evaluator, stmt, define)) return false;
    bool grey = given.kind == VALUE_NUMBER && value->kind == VALUE_COLOR;
    bool fits = given.kind == value->kind || grey || value->kind == VALUE_NONE || stmt->as.bind.type;
    if (!fits) {
        Diagnostic *report =
            eval_report(evaluator, D_WRONG_TYPE, define->span, "parameter '%s' is %s, not %s", stmt->as.bind.name->text,
                        value_describe(evaluator->arena, value), value_describe(evaluator->arena, &given));
        diag_note(evaluator->diag, report, stmt->as.bind.name_span, "declared here");
        if (value->kind == VALUE_BOOL && given.kind == VALUE_NUMBER)
            diag_hint(evaluator->diag, report, "write: %s", given.as.number != 0 ? "true" : "false");
        return false;
    }
    double number = given.as.number;
    *value = grey ? value_color(number, number, number) : given;
    return true;
}

static bool range_allows(const Value *range, const Value *value)
{
    if (range->kind == VALUE_RANGE) {
        double a = range->as.range.first,
               b = a + (double)(range->as.range.n ? range->as.range.n - 1 : 0) * range->as.range.step;
        unsigned width = value_width(value->kind);
        for (unsigned i = 0; i < width; i++)
            if (!(value->as.v[i] >= fmin(a, b) && value->as.v[i] <= fmax(a, b))) return false;
        return width > 0;
    }
    size_t n = value_count(range);
    for (size_t i = 0; i < n; i++) {
        Value element = value_element(range, i);
        if (value_equal(&element, value)) return true;
    }
    return false;
}

static const char *text_of(Evaluator *evaluator, const Value *value)
{
    Buf text = {0};
    value_print(&text, value, VALUE_QUOTED | VALUE_ROUNDED);
    const char *copy = arena_copy_text(evaluator->arena, buf_text(&text), text.length);
    buf_clear(&text);
    return copy;
}

/* The bounds that a range was written with: the last step of 0..1 by .4 is .8, but 1 is a fair value. */
static bool range_of_param(Evaluator *evaluator, Expr *expr, Value *range)
{
    if (expr->kind != EXPR_RANGE || expr->as.op.c) return eval_sequence(evaluator, expr, range);
    Value first, last;
    eval_value(evaluator, expr->as.op.a, &first);
    eval_value(evaluator, expr->as.op.b, &last);
    if (first.kind != VALUE_NUMBER || last.kind != VALUE_NUMBER) return eval_sequence(evaluator, expr, range);
    *range = (Value){.kind = VALUE_RANGE, .as.range = {first.as.number, last.as.number - first.as.number, 2}};
    return true;
}

static const char *with_unit(Evaluator *evaluator, const char *text, const char *unit)
{
    Buf out = {0};
    unit_add_behind_numbers(&out, text, unit);
    const char *copy = arena_copy_text(evaluator->arena, buf_text(&out), out.length);
    buf_clear(&out);
    return copy;
}

/* The range as text, "5..60" or "[1, 2]"; NULL when there is none, or it is a mistake. given: what -D says; NULL: nothing. */
static const char *check_param_range(Evaluator *evaluator, Stmt *stmt, const Value *value, const Define *given,
                                     Span span)
{
    Value range;
    if (!stmt->as.bind.range || !range_of_param(evaluator, stmt->as.bind.range, &range)) return NULL;
    const char *bounds = text_of(evaluator, &range);
    if (range.kind == VALUE_RANGE && stmt->as.bind.range->kind == EXPR_RANGE && range.as.range.n == 2)
        bounds =
            arena_format(evaluator->arena, "%g..%g", range.as.range.first, range.as.range.first + range.as.range.step);
    if (value->kind == VALUE_POISON || range_allows(&range, value)) return bounds;
    const UnitType *type = unit_of_param(stmt);
    if (!type && given) type = unit_of_literal(given->expr);
    const char *unit = type ? unit_of_measure(type->measure, evaluator->unit_m) : NULL;
    eval_report(evaluator, D_VALUE_OUT_OF_RANGE, span, "parameter '%s' is %s, outside of %s", stmt->as.bind.name->text,
                with_unit(evaluator, text_of(evaluator, value), unit), with_unit(evaluator, bounds, unit));
    return bounds;
}

static void record_param(Evaluator *evaluator, const Stmt *stmt, const Value *value, const char *range)
{
    if (!ARRAY_ROOM(evaluator->params, evaluator->param_capacity, evaluator->n_params)) return;
    const UnitType *unit = unit_of_param(stmt);
    evaluator->params[evaluator->n_params++] = (EvalParam){.name = stmt->as.bind.name->text,
                                                           .doc = stmt->as.bind.doc,
                                                           .span = stmt->as.bind.name_span,
                                                           .value = text_of(evaluator, value),
                                                           .type = value_describe(evaluator->arena, value),
                                                           .range = range,
                                                           .measure = unit ? unit->measure : UNIT_NONE};
}

static void param_stmt(Evaluator *evaluator, Stmt *stmt)
{
    Value value;
    Span span = stmt->as.bind.value->span;
    eval_value(evaluator, stmt->as.bind.value, &value);
    Define *define = evaluator->discard ? NULL : define_of(evaluator, stmt->as.bind.name->text);
    if (define && value.kind != VALUE_POISON) {
        if (take_define(evaluator, stmt, define, &value)) span = define->span;
    } else if (define) {
        define->used = true;
    }
    if (!eval_type_allows(evaluator, stmt->as.bind.type, stmt->as.bind.type_span, &value, span,
                          stmt->as.bind.name->text))
        value = value_poison();
    const char *range = check_param_range(evaluator, stmt, &value, define, span);
    if (!evaluator->discard) record_param(evaluator, stmt, &value, range);
    *eval_slot(evaluator, stmt->as.bind.slot) = value;
}

static void assign_stmt(Evaluator *evaluator, Stmt *stmt)
{
    Value value;
    eval_value(evaluator, stmt->as.bind.value, &value);
    Value *slot = eval_slot(evaluator, stmt->as.bind.slot);
    if (slot->kind == VALUE_UNSET && !stmt->reported) {
        stmt->reported = true;
        eval_report(evaluator, D_UNSET_NAME, stmt->span, "'%s' is changed before it has a value",
                    stmt->as.bind.name->text);
    }
    *slot = value;
}

/* ---- flow ---- */

static void for_stmt(Evaluator *evaluator, Stmt *stmt)
{
    Value source;
    if (!eval_sequence(evaluator, stmt->as.loop.source, &source)) return;
    size_t n = value_count(&source);
    uint64_t where = evaluator->where;
    for (size_t i = 0; i < n && eval_step(evaluator, stmt->span); i++) {
        *eval_slot(evaluator, stmt->as.loop.slot) = value_element(&source, i);
        evaluator->where = eval_within(where, stmt->span, i);
        eval_block(evaluator, stmt->as.loop.block);
    }
    evaluator->where = where;
}

static void while_stmt(Evaluator *evaluator, Stmt *stmt)
{
    bool poison;
    uint64_t where = evaluator->where, i = 0;
    while (eval_condition(evaluator, stmt->as.branch.condition, &poison) && eval_step(evaluator, stmt->span)) {
        evaluator->where = eval_within(where, stmt->span, i++);
        eval_block(evaluator, stmt->as.branch.then);
    }
    evaluator->where = where;
}

static void if_stmt(Evaluator *evaluator, Stmt *stmt)
{
    for (;;) {
        bool poison, truth = eval_condition(evaluator, stmt->as.branch.condition, &poison);
        if (poison) return;
        const Block *block = truth ? stmt->as.branch.then : stmt->as.branch.otherwise;
        if (!block) return;
        Stmt *next = block->first;
        if (truth || !next || next->kind != STMT_IF || next->next) {
            eval_block(evaluator, block);
            return;
        }
        stmt = next; /* else if */
    }
}

/* ---- files ---- */

static void run_file(Evaluator *evaluator, File *file, bool discard)
{
    Frame frame = {.caller = NULL, .chain = file->chain, .has_chain = true};
    Frame *here = evaluator->frame;
    Target *target = evaluator->target;
    bool discarded = evaluator->discard;
    evaluator->frame = &frame;
    evaluator->discard = discard || discarded;
    if (discard) evaluator->target = NULL;
    eval_block(evaluator, file->block);
    evaluator->frame = here;
    evaluator->discard = discarded;
    evaluator->target = target;
}

static void import_stmt(Evaluator *evaluator, Stmt *stmt)
{
    File *file = stmt->as.import.file;
    if (stmt->as.import.include) {
        run_file(evaluator, file, false);
    } else if (!file->evaluated) {
        file->evaluated = true;
        run_file(evaluator, file, true);
    }
}

static void preset_stmt(Evaluator *evaluator, Stmt *stmt)
{
    if (evaluator->discard) return;
    NodeExpr *node = stmt->as.node;
    for (size_t i = 0; i < evaluator->n_presets; i++)
        if (evaluator->presets[i].node->name == node->name) {
            Diagnostic *report = eval_report(evaluator, D_DUPLICATE_NAME, node->name_span,
                                             "preset '%s' stands here twice", node->name->text);
            diag_note(evaluator->diag, report, evaluator->presets[i].node->name_span, "first here");
            return;
        }
    if (ARRAY_ROOM(evaluator->presets, evaluator->preset_capacity, evaluator->n_presets))
        evaluator->presets[evaluator->n_presets++] = (Preset){node, evaluator->frame};
}

/* ---- all ---- */

static void eval_stmt(Evaluator *evaluator, Stmt *stmt)
{
    switch (stmt->kind) {
    case STMT_EMPTY:
    case STMT_DEF: break;
    case STMT_BIND: bind_stmt(evaluator, stmt); break;
    case STMT_PARAM: param_stmt(evaluator, stmt); break;
    case STMT_ASSIGN: assign_stmt(evaluator, stmt); break;
    case STMT_PROP: eval_prop_stmt(evaluator, stmt); break;
    case STMT_CALL: call_stmt(evaluator, stmt); break;
    case STMT_NODE: eval_node_stmt(evaluator, stmt); break;
    case STMT_KIDS: kids_stmt(evaluator); break;
    case STMT_DEFAULTS: eval_defaults_stmt(evaluator, stmt); break;
    case STMT_IF: if_stmt(evaluator, stmt); break;
    case STMT_FOR: for_stmt(evaluator, stmt); break;
    case STMT_WHILE: while_stmt(evaluator, stmt); break;
    case STMT_IMPORT: import_stmt(evaluator, stmt); break;
    case STMT_PRESET: preset_stmt(evaluator, stmt); break;
    }
}

void eval_block(Evaluator *evaluator, const Block *block)
{
    if (eval_stack_is_deep(evaluator, block->span)) return;
    for (Stmt *stmt = block->first; stmt && !evaluator->stop; stmt = stmt->next) eval_stmt(evaluator, stmt);
}

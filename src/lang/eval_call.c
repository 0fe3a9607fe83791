/* eval_call.c - calls of defs, builtin functions and terms.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/suggest.h"
#include "lang/evaluator.h"
#include "lang/habits.h"

/* ---- memory of frames: a stack in chunks that never move ---- */

struct SlotChunk {
    SlotChunk *below, *above;
    size_t used, capacity;
    Value values[];
};

enum { CHUNK_SLOTS = 4096, LONGEST_CALL = 40 };

static SlotChunk *new_chunk(Evaluator *evaluator, size_t n)
{
    size_t capacity = n > CHUNK_SLOTS ? n : CHUNK_SLOTS;
    SlotChunk *chunk = arena_alloc(evaluator->arena, sizeof(SlotChunk) + capacity * sizeof(Value));
    chunk->capacity = capacity;
    return chunk;
}

static Value *take_slots(Evaluator *evaluator, size_t n)
{
    SlotChunk *chunk = evaluator->chunks;
    if (!chunk || chunk->capacity - chunk->used < n) {
        SlotChunk *next = chunk ? chunk->above : NULL;
        if (!next || next->capacity < n) {
            next = new_chunk(evaluator, n);
            next->below = chunk;
            if (chunk) chunk->above = next;
        }
        next->used = 0;
        evaluator->chunks = chunk = next;
    }
    Value *slots = chunk->values + chunk->used;
    chunk->used += n;
    memset(slots, 0, n * sizeof *slots); /* VALUE_UNSET */
    return slots;
}

static void give_slots_back(Evaluator *evaluator, size_t n)
{
    SlotChunk *chunk = evaluator->chunks;
    chunk->used -= n;
    if (chunk->used == 0 && chunk->below) evaluator->chunks = chunk->below;
}

/* ---- types by name ---- */

static const struct {
    const char *name;
    ValueKind kind;
} type_names[] = {
    {"number", VALUE_NUMBER}, {"bool", VALUE_BOOL},    {"string", VALUE_STRING}, {"vec2", VALUE_VECTOR2},
    {"vec3", VALUE_VECTOR3},  {"vec4", VALUE_VECTOR4}, {"color", VALUE_COLOR},   {"transform", VALUE_TRANSFORM},
    {"list", VALUE_LIST},     {"range", VALUE_RANGE},  {"node", VALUE_NODE},
};

static void report_unknown_type(Evaluator *evaluator, const Symbol *type, Span type_span)
{
    const char *words[COUNT_OF(type_names)];
    for (size_t i = 0; i < COUNT_OF(type_names); i++) words[i] = type_names[i].name;
    Diagnostic *report = eval_report(evaluator, D_UNKNOWN_NAME, type_span, "unknown type '%s'", type->text);
    diag_suggest(evaluator->diag, report, type->text, words, COUNT_OF(words));
    if (!report->hint)
        diag_hint(evaluator->diag, report, "the types are %s, and those of nodes",
                  suggest_list(evaluator->arena, words, COUNT_OF(words), "and"));
}

bool eval_type_allows(Evaluator *evaluator, Symbol *type, Span type_span, const Value *value, Span span,
                      const char *name)
{
    if (!type || value->kind == VALUE_POISON) return true;
    bool fits = false, known = false;
    for (size_t i = 0; i < COUNT_OF(type_names); i++)
        if (strcmp(type->text, type_names[i].name) == 0) {
            known = true;
            fits = value->kind == type_names[i].kind ||
                   (value->kind == VALUE_RANGE && type_names[i].kind == VALUE_LIST) ||
                   (value->kind == VALUE_NUMBER && type_names[i].kind == VALUE_COLOR);
        }
    const NodeType *node = known ? NULL : schema_node(evaluator->schema, type->text);
    if (node) fits = value->kind == VALUE_NODE && value->as.node->type == node;
    if (!known && !node)
        report_unknown_type(evaluator, type, type_span);
    else if (!fits)
        eval_report(evaluator, D_WRONG_TYPE, span, "'%s' is declared as %s, not %s", name, type->text,
                    value_describe(evaluator->arena, value));
    return fits;
}

/* ---- defs ---- */

static int formal_of(const Def *def, const Symbol *name)
{
    for (uint32_t i = 0; i < def->n_formals; i++)
        if (def->formals[i].name == name) return (int)i;
    return -1;
}

/* diameter = 6, where there is a radius */
static const char *alike_formal(Arena *arena, const char *wrong, const char *const *words, size_t n)
{
    const char *other;
    for (unsigned number = 0; (other = habit_property("", wrong, number)); number++)
        for (size_t i = 0; i < n; i++)
            if (strlen(words[i]) == strcspn(other, " ") && strncmp(other, words[i], strlen(words[i])) == 0)
                return habit_assignment(arena, other, "...");
    return NULL;
}

/* Bit i: formal i, of the first 64, is named by an argument. */
static uint64_t named_formals(const Def *def, const Args *args)
{
    uint64_t named = 0;
    for (uint32_t i = 0; i < args->n; i++) {
        int index = args->items[i].name ? formal_of(def, args->items[i].name) : -1;
        if (index >= 0 && index < 64) named |= (uint64_t)1 << index;
    }
    return named;
}

void eval_report_formal(Evaluator *evaluator, const Def *def, uint64_t given, const char *wrong, Span span)
{
    const char *all[BUILTIN_MAX_ARGS], *words[BUILTIN_MAX_ARGS];
    size_t n_all = 0, n = 0;
    for (; n_all < def->n_formals && n_all < COUNT_OF(all); n_all++) {
        all[n_all] = def->formals[n_all].name->text;
        if (n_all >= 64 || !(given >> n_all & 1)) words[n++] = all[n_all];
    }
    Diagnostic *report =
        eval_report(evaluator, D_WRONG_ARGUMENT, span, "'%s' has no parameter '%s'", def->name->text, wrong);
    const char *advice = habit_formal(all, n_all, wrong);
    const char *habit = advice ? NULL : alike_formal(evaluator->diag->arena, wrong, words, n);
    if (advice || habit)
        diag_hint(evaluator->diag, report, habit ? "write: %s" : "%s", habit ? habit : advice);
    else
        diag_suggest(evaluator->diag, report, wrong, words, n);
    diag_note(evaluator->diag, report, def->span, "declared here");
}

/* Puts the arguments into the slots of the new frame; they are evaluated in the caller's. */
static bool bind_args(Evaluator *evaluator, Expr *expr, const Def *def, Value *slots)
{
    const Args *args = &expr->as.call.args;
    bool fine = true;
    uint32_t position = 0;
    for (uint32_t i = 0; i < args->n; i++) {
        const Arg *arg = &args->items[i];
        int index = arg->name ? formal_of(def, arg->name) : (int)position++;
        if (index < 0 && !expr->reported)
            eval_report_formal(evaluator, def, named_formals(def, args), arg->name->text, arg->name_span);
        if (index >= (int)def->n_formals) {
            Diagnostic *report = eval_error(evaluator, arg->value, D_WRONG_ARGUMENT, "'%s' takes %u argument%s, not %u",
                                            def->name->text, def->n_formals, def->n_formals == 1 ? "" : "s", args->n);
            diag_note(evaluator->diag, report, def->span, "declared here");
        }
        if (index < 0 || index >= (int)def->n_formals) {
            expr->reported = true;
            return false;
        }
        Value *slot = &slots[def->formals[index].slot.index];
        if (slot->kind != VALUE_UNSET) {
            eval_error(evaluator, arg->value, D_DUPLICATE_ARGUMENT, "'%s' is given twice",
                       def->formals[index].name->text);
            fine = false;
        }
        eval_value(evaluator, arg->value, slot);
    }
    return fine;
}

/* in the new frame: what was not given takes its default */
static bool bind_fallbacks(Evaluator *evaluator, const Def *def, Span call_span, bool *reported)
{
    bool fine = true;
    for (uint32_t i = 0; i < def->n_formals; i++) {
        const Formal *formal = &def->formals[i];
        Value *slot = &evaluator->frame->slots[formal->slot.index];
        if (slot->kind == VALUE_UNSET && formal->fallback) {
            Value value;
            eval_value(evaluator, formal->fallback, &value);
            *slot = value;
        }
        if (slot->kind == VALUE_UNSET) {
            slot->kind = VALUE_POISON;
            fine = false;
            if (*reported) continue;
            *reported = true;
            Frame *callee = evaluator->frame;
            evaluator->frame = callee->caller;
            Diagnostic *report = eval_report(evaluator, D_MISSING_ARGUMENT, call_span, "'%s' needs an argument '%s'",
                                             def->name->text, formal->name->text);
            diag_note(evaluator->diag, report, formal->span, "declared here");
            evaluator->frame = callee;
        } else if (formal->type &&
                   !eval_type_allows(evaluator, formal->type, formal->type_span, slot, call_span, formal->name->text)) {
            slot->kind = VALUE_POISON;
        }
    }
    return fine;
}

static bool call_begin(Evaluator *evaluator, Span span)
{
    if (!eval_step(evaluator, span) || eval_stack_is_deep(evaluator, span)) return false;
    if (evaluator->calls >= evaluator->limits.calls) {
        limit_hint(
            evaluator->diag,
            eval_report(evaluator, D_TOO_DEEP, span, "more than %u calls within each other", evaluator->limits.calls),
            OVER_CALLS);
        evaluator->stop = true;
        return false;
    }
    evaluator->calls++;
    return true;
}

static Frame frame_of_call(Evaluator *evaluator, const Def *def, uint32_t hops, Span span)
{
    Frame frame = {.def = def, .caller = evaluator->frame, .call_span = span};
    frame.slots = take_slots(evaluator, def->n_slots);
    frame.lexical = def->level ? eval_lexical(evaluator, hops) : NULL;
    return frame;
}

static void call_end(Evaluator *evaluator, const Frame *frame)
{
    give_slots_back(evaluator, frame->def->n_slots);
    evaluator->calls--;
}

void eval_name_result(Evaluator *evaluator, const Expr *expr, const char *name)
{
    if (expr->kind == EXPR_CALL_DEF) evaluator->call_name = name;
}

/* The body of a function that gives a medium and the like gets the name, or the function that it calls for it. */
static void name_body(Evaluator *evaluator, const Expr *body, const char *name)
{
    const NodeType *type = body->kind == EXPR_NODE ? body->as.node->type : NULL;
    if (type && type->flags & NODE_NAMED) evaluator->bind_name = name;
    eval_name_result(evaluator, body, name);
}

void eval_call_def(Evaluator *evaluator, Expr *expr, Value *result)
{
    const Def *def = expr->as.call.to.def;
    const char *name = evaluator->call_name;
    evaluator->call_name = NULL;
    result->kind = VALUE_POISON;
    if (!def->body) {
        Diagnostic *report = eval_error(evaluator, expr, D_NOT_A_MACRO,
                                        "'%s' is a macro: it places nodes and has no value", def->name->text);
        diag_hint(evaluator->diag, report, "a group of what it places is one: group { %s }",
                  eval_written(evaluator, expr->span, LONGEST_CALL, "\n",
                               arena_format(evaluator->arena, "%s(...)", def->name->text)));
        diag_note(evaluator->diag, report, def->span, "declared here");
        return;
    }
    if (!call_begin(evaluator, expr->span)) return;
    Frame frame = frame_of_call(evaluator, def, expr->as.call.hops, expr->span);
    if (bind_args(evaluator, expr, def, frame.slots)) {
        evaluator->frame = &frame;
        if (bind_fallbacks(evaluator, def, expr->span, &expr->reported)) {
            if (name) name_body(evaluator, def->body, name);
            eval_value(evaluator, def->body, result);
        }
        evaluator->frame = frame.caller;
    }
    call_end(evaluator, &frame);
}

static void run_macro(Evaluator *evaluator, Frame *frame)
{
    bool reported = false;
    uint64_t where = evaluator->where;
    evaluator->frame = frame;
    evaluator->where = eval_within(where, frame->call_span, 0);
    if (bind_fallbacks(evaluator, frame->def, frame->call_span, &reported)) eval_block(evaluator, frame->def->block);
    evaluator->where = where;
    evaluator->frame = frame->caller;
}

const char *eval_written(const Evaluator *evaluator, Span span, size_t longest, const char *without,
                         const char *otherwise)
{
    const char *text = evaluator->diag->sources->sources[span.source].text + span.begin;
    size_t n = span.end - span.begin;
    for (size_t i = 0; i < n; i++)
        if (n > longest || strchr(without, text[i])) return otherwise;
    return arena_copy_text(evaluator->arena, text, n);
}

/* Of a block behind a call of a macro that has no use for it: mostly it is to move what the macro places. */
static void hint_at_block(Evaluator *evaluator, Diagnostic *report, const Expr *call, const Block *block)
{
    const Def *def = call->as.call.to.def;
    const Args *args = &call->as.call.args;
    const char *text = evaluator->diag->sources->sources[call->span.source].text + call->span.begin, *list = "";
    const char *name = arena_copy_text(evaluator->arena, text, strcspn(text, "( \t\n")); /* gems.princess */
    const char *as_call =
        eval_written(evaluator, call->span, 40, "\n", arena_format(evaluator->arena, "%s(...)", name));
    if (!block->first) {
        diag_hint(evaluator->diag, report, "write: %s, without '{ }'", as_call);
        return;
    }
    for (uint32_t i = 0; i < args->n && i < def->n_formals; i++) { /* the place of a value may leave its brackets out */
        const Symbol *formal = args->items[i].name ? args->items[i].name : def->formals[i].name;
        list = arena_format(evaluator->arena, "%s%s = %s  ", list, formal->text,
                            eval_written(evaluator, args->items[i].value->span, 16, "()[]{}<>\n", "..."));
    }
    if (block->first->kind == STMT_CALL)
        diag_hint(evaluator->diag, report, "to move all that it places: group { %s  ... }, or %s { %s... }", as_call,
                  name, list);
    else
        diag_hint(evaluator->diag, report, "what is done to all that it places stands in a group: group { %s  ... }",
                  as_call);
}

void eval_call_macro(Evaluator *evaluator, Expr *expr, Block *block)
{
    const Def *def = expr->as.call.to.def;
    if (block && !def->calls_children) {
        Diagnostic *report =
            eval_error(evaluator, expr, D_WRONG_ARGUMENT, "'%s' places no children()", def->name->text);
        hint_at_block(evaluator, report, expr, block);
        diag_note(evaluator->diag, report, def->span, "declared here");
    }
    if (!call_begin(evaluator, expr->span)) return;
    Frame frame = frame_of_call(evaluator, def, expr->as.call.hops, expr->span);
    frame.children = block;
    frame.children_frame = evaluator->frame;
    if (bind_args(evaluator, expr, def, frame.slots)) run_macro(evaluator, &frame);
    call_end(evaluator, &frame);
}

void eval_call_macro_values(Evaluator *evaluator, const Def *def, uint32_t hops, const Value *args, Span span)
{
    if (!call_begin(evaluator, span)) return;
    Frame frame = frame_of_call(evaluator, def, hops, span);
    for (uint32_t i = 0; i < def->n_formals; i++) frame.slots[def->formals[i].slot.index] = args[i];
    run_macro(evaluator, &frame);
    call_end(evaluator, &frame);
}

/* ---- functions that are called when the evaluation is over ---- */

/* The frame and those around it in the text, with copies of their slots. */
static Frame *capture_frame(Evaluator *evaluator, const Frame *frame)
{
    if (!frame || !frame->def) return NULL;
    Frame *copy = ARENA_NEW(evaluator->arena, Frame);
    *copy = (Frame){.def = frame->def, .call_span = frame->call_span, .has_chain = true};
    copy->slots = ARENA_ARRAY(evaluator->arena, Value, frame->def->n_slots);
    if (frame->def->n_slots) memcpy(copy->slots, frame->slots, frame->def->n_slots * sizeof *copy->slots);
    copy->lexical = capture_frame(evaluator, frame->lexical);
    return copy;
}

/* Whether a function takes what its property gives it. */
static bool takes_arguments(Evaluator *evaluator, Expr *expr, const EvalFunctionValue *function, bool on_surface)
{
    const Def *def = function->def;
    const char *forms =
        on_surface ? "of a place on a surface, f(p), f(x, y, z) or f(u, v), with normal, uv or footprint beside"
                   : "of a point, f(p), or of f(x, y, z)";
    uint32_t n_needed = 0;
    for (uint32_t i = 0; i < def->n_formals; i++) n_needed += !def->formals[i].fallback;
    bool fits = def->n_formals >= 1 && def->n_formals <= LIMIT_ARGUMENTS;
    if (fits && (on_surface ? eval_takes_place(function) : function->by_coordinates || n_needed <= 1)) return true;
    Diagnostic *report = eval_error(evaluator, expr, D_WRONG_TYPE, "'%s' is no function %s", def->name->text, forms);
    diag_note(evaluator->diag, report, def->span, "declared here");
    return false;
}

const EvalFunctionValue *eval_capture(Evaluator *evaluator, Expr *expr, bool on_surface)
{
    const Def *def = expr->as.call.to.def;
    uint32_t n_needed = 0;
    for (uint32_t i = 0; i < def->n_formals; i++) n_needed += !def->formals[i].fallback;
    bool by_coordinates = def->n_formals >= 3 && n_needed == 3;
    if (!takes_arguments(evaluator, expr, &(EvalFunctionValue){.def = def, .by_coordinates = by_coordinates},
                         on_surface))
        return NULL;
    double bytes = (double)evaluator->n_globals * sizeof(Value) + sizeof(Evaluator);
    if (!eval_reserve(evaluator, bytes, expr->span)) return NULL;
    Evaluator *own = ARENA_NEW(evaluator->arena, Evaluator);
    *own = *evaluator;
    own->globals = ARENA_ARRAY(evaluator->arena, Value, evaluator->n_globals);
    memcpy(own->globals, evaluator->globals, evaluator->n_globals * sizeof *own->globals);
    own->frame = NULL;
    own->target = NULL;
    own->chunks = NULL;
    own->rooms = NULL;
    own->calls = 0;
    own->bind_name = NULL;
    own->call_name = NULL;
    own->printed = (Buf){0};
    EvalFunctionValue *function = ARENA_NEW(evaluator->arena, EvalFunctionValue);
    *function = (EvalFunctionValue){.evaluator = own, .def = def, .span = expr->span, .by_coordinates = by_coordinates};
    if (def->level) function->lexical = capture_frame(evaluator, eval_lexical(evaluator, expr->as.call.hops));
    return function;
}

static bool not_a_number(const EvalFunctionValue *function, Vec3 p, const Value *value)
{
    Evaluator *evaluator = function->evaluator;
    Frame top = {.has_chain = true};
    evaluator->frame = &top;
    if (value->kind != VALUE_POISON)
        eval_report(evaluator, D_WRONG_TYPE, function->span, "'%s' gives %s, not a number, at <%g, %g, %g>",
                    function->def->name->text, value_describe(evaluator->arena, value), p.x, p.y, p.z);
    evaluator->frame = NULL;
    evaluator->stop = true;
    return false;
}

bool eval_call_function(const EvalFunctionValue *function, const Value *args, Value *result)
{
    char here;
    Evaluator *evaluator = function->evaluator;
    const Def *def = function->def;
    Frame top = {.has_chain = true};
    *result = value_poison();
    evaluator->stack_base = (uintptr_t)&here;
    evaluator->frame = &top;
    if (evaluator->stop || !call_begin(evaluator, function->span)) return false;
    Frame frame = {.def = def, .caller = &top, .call_span = function->span, .lexical = function->lexical};
    frame.slots = take_slots(evaluator, def->n_slots);
    for (uint32_t i = 0; i < def->n_formals; i++) frame.slots[def->formals[i].slot.index] = args[i];
    bool reported = false;
    evaluator->frame = &frame;
    if (bind_fallbacks(evaluator, def, function->span, &reported)) eval_value(evaluator, def->body, result);
    evaluator->frame = &top;
    call_end(evaluator, &frame);
    evaluator->frame = NULL;
    return result->kind != VALUE_POISON && !evaluator->stop;
}

bool eval_function_at(const EvalFunctionValue *function, Vec3 p, double *value)
{
    Value args[LIMIT_ARGUMENTS], result;
    const double coordinates[3] = {p.x, p.y, p.z};
    for (uint32_t i = 0; i < function->def->n_formals; i++) {
        args[i] = (Value){.kind = VALUE_UNSET};
        if (function->by_coordinates && i < 3) args[i] = value_number(coordinates[i]);
    }
    if (!function->by_coordinates) args[0] = value_vector3(p.x, p.y, p.z);
    (void)eval_call_function(function, args, &result);
    *value = result.as.number;
    bool is_number = result.kind == VALUE_NUMBER || not_a_number(function, p, &result);
    return is_number && !function->evaluator->stop;
}

/* ---- builtins and terms ---- */

void eval_call_builtin(Evaluator *evaluator, Expr *expr, Value *result)
{
    const Builtin *builtin = expr->as.call.to.builtin;
    const Args *args = &expr->as.call.args;
    if (builtin->unary) {
        Value room;
        const Value *value = eval_operand(evaluator, args->items[0].value, &room);
        if (LIKELY(value->kind == VALUE_NUMBER)) {
            *result = value_number(builtin->unary(value->as.number));
            if (UNLIKELY(!value_is_finite(result))) {
                eval_error(evaluator, expr, D_BAD_NUMBER, "%s(%g) is no finite number", builtin->name,
                           value->as.number);
                result->kind = VALUE_POISON;
            }
            return;
        }
    }
    Value values[BUILTIN_MAX_ARGS];
    bool poison = eval_stack_is_deep(evaluator, expr->span);
    for (uint32_t i = 0; i < args->n && !evaluator->stop; i++) {
        eval_value(evaluator, args->items[i].value, &values[i]);
        poison |= values[i].kind == VALUE_POISON;
    }
    result->kind = VALUE_POISON;
    if (poison || evaluator->stop) return;
    builtin->run(&(BuiltinCall){evaluator, expr, values, args->n}, result);
}

/* A table of measured values: in place, or a file that the layer above reads. */
static bool take_table(Evaluator *evaluator, Expr *arg, const Value *value, EvalTerm *term)
{
    if (value->kind == VALUE_STRING) {
        term->text = value->as.text;
        return true;
    }
    bool list = value->kind == VALUE_LIST;
    if (list && value->as.list->n > 0 && value->as.list->element == VALUE_VECTOR2) {
        term->pairs = value->as.list->numbers;
        term->n_pairs = value->as.list->n;
        return true;
    }
    if (value->kind != VALUE_POISON)
        eval_error(evaluator, arg, D_WRONG_TYPE, "'%s' takes the name of a file or a list of vectors of 2, not %s",
                   term->type->name,
                   !list                   ? value_describe(evaluator->arena, value)
                   : value->as.list->n > 0 ? "a list of something else"
                                           : "an empty list");
    return false;
}

static bool take_number(Evaluator *evaluator, Expr *arg, const Value *value, EvalTerm *term)
{
    if (value->kind == VALUE_NUMBER) {
        term->args[term->n_args++] = value->as.number;
        return true;
    }
    if (value->kind != VALUE_POISON)
        eval_error(evaluator, arg, D_WRONG_TYPE, "'%s' takes numbers, not %s", term->type->name,
                   value_describe(evaluator->arena, value));
    return false;
}

void eval_call_term(Evaluator *evaluator, Expr *expr, Value *result)
{
    const TermType *type = expr->as.call.to.term;
    EvalTerm term = {.type = type, .scale = 1, .span = expr->span};
    bool fine = true;
    for (uint32_t i = 0; i < expr->as.call.args.n; i++) {
        Expr *arg = expr->as.call.args.items[i].value;
        Value room;
        const Value *value = eval_operand(evaluator, arg, &room);
        fine &= type->flags & TERM_TABLE ? take_table(evaluator, arg, value, &term)
                                         : take_number(evaluator, arg, value, &term);
    }
    result->kind = VALUE_POISON;
    if (!fine) return;
    EvalTerm *kept = ARENA_NEW(evaluator->arena, EvalTerm);
    *kept = term;
    *result = (Value){.kind = VALUE_TERM, .as.term = kept};
}

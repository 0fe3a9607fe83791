/* eval_expr.c - one function per kind of expression, reached through a table. Each writes its result through a
 * pointer; poison in gives poison out, without a word.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "lang/evaluator.h"
#include "lang/habits.h"
#include "lang/resolve.h"

static bool any_poison(const Value *a, const Value *b)
{
    return a->kind == VALUE_POISON || b->kind == VALUE_POISON;
}

static void eval_poison(Evaluator *evaluator, Expr *expr, Value *result)
{
    (void)evaluator;
    (void)expr;
    result->kind = VALUE_POISON;
}

static void eval_constant(Evaluator *evaluator, Expr *expr, Value *result)
{
    (void)evaluator;
    *result = expr->as.constant.value;
}

static void eval_bare_word(Evaluator *evaluator, Expr *expr, Value *result)
{
    Diagnostic *report = eval_error(evaluator, expr, D_UNKNOWN_NAME, "unknown name '%s'", expr->as.name.symbol->text);
    const char *word = habit_word(expr->as.name.symbol->text);
    if (word)
        diag_hint(evaluator->diag, report, "write: %s", word);
    else if (expr->as.name.nearest)
        diag_hint(evaluator->diag, report, "did you mean '%s'?", expr->as.name.nearest);
    result->kind = VALUE_POISON;
}

static void eval_variable(Evaluator *evaluator, Expr *expr, Value *result)
{
    const Value *value = eval_slot(evaluator, expr->as.variable.slot);
    if (value->kind != VALUE_UNSET) {
        *result = *value;
        return;
    }
    eval_error(evaluator, expr, D_UNSET_NAME, "'%s' is used before it has its value", expr->as.variable.symbol->text);
    result->kind = VALUE_POISON;
}

/* ---- arithmetic ---- */

static const char *operator_text(ExprKind kind)
{
    static const char *const texts[] = {"+", "-", "*", "/", "%", "^", "==", "!=", "<", "<=", ">", ">="};
    return texts[kind - EXPR_ADD];
}

static const char *hidden_axis(const Expr *expr)
{
    const char *axis;
    switch (expr->kind) {
    case EXPR_GLOBAL:
    case EXPR_LOCAL:
    case EXPR_OUTER: {
        const Slot *slot = &expr->as.variable.slot;
        const char *name = expr->as.variable.symbol->text;
        if (slot->kind == EXPR_GLOBAL && slot->index < PREDECLARED_COUNT) return NULL;
        return (*name == 'x' || *name == 'y' || *name == 'z') && !name[1] ? name : NULL;
    }
    case EXPR_ADD:
    case EXPR_SUBTRACT:
    case EXPR_MULTIPLY:
    case EXPR_DIVIDE: axis = hidden_axis(expr->as.op.a); return axis ? axis : hidden_axis(expr->as.op.b);
    case EXPR_NEGATE: return hidden_axis(expr->as.op.a);
    default: return NULL;
    }
}

bool eval_hint_at_axis(Evaluator *evaluator, Diagnostic *report, const Expr *expr)
{
    const char *axis = hidden_axis(expr);
    if (axis)
        diag_hint(evaluator->diag, report, "'%s' is a name of the scene here and hides the axis, which is <%d, %d, %d>",
                  axis, *axis == 'x', *axis == 'y', *axis == 'z');
    return axis != NULL;
}

static bool is_vector(ValueKind kind)
{
    return kind == VALUE_VECTOR2 || kind == VALUE_VECTOR3 || kind == VALUE_VECTOR4;
}

/* <1, 2, 3> + 1 */
static void hint_number_and_vector(Evaluator *evaluator, Diagnostic *report, const Expr *expr, const Value *a,
                                   const Value *b)
{
    enum { LONGEST = 32 };
    bool number_first = a->kind == VALUE_NUMBER;
    const Expr *number = number_first ? expr->as.op.a : expr->as.op.b;
    if (eval_hint_at_axis(evaluator, report, number) || expr->kind < EXPR_ADD || expr->kind > EXPR_POWER) return;
    unsigned width = value_width(number_first ? b->kind : a->kind);
    const char *a_text = eval_written(evaluator, expr->as.op.a->span, LONGEST, "\n", number_first ? "..." : "v"),
               *b_text = eval_written(evaluator, expr->as.op.b->span, LONGEST, "\n", number_first ? "v" : "...");
    const char *operation = operator_text(expr->kind);
    if (number_first)
        diag_hint(evaluator->diag, report, "write: vec%u(%s) %s %s", width, a_text, operation, b_text);
    else
        diag_hint(evaluator->diag, report, "write: %s %s vec%u(%s)", a_text, operation, width, b_text);
}

static void wrong_operands(Evaluator *evaluator, Expr *expr, const Value *a, const Value *b, Value *result)
{
    result->kind = VALUE_POISON;
    if (any_poison(a, b)) return;
    Diagnostic *report =
        eval_error(evaluator, expr, D_WRONG_TYPE, "'%s' does not work between %s and %s", operator_text(expr->kind),
                   value_describe(evaluator->arena, a), value_describe(evaluator->arena, b));
    if (expr->kind == EXPR_ADD && (a->kind == VALUE_STRING || b->kind == VALUE_STRING))
        diag_hint(evaluator->diag, report, "write: str(a, b), for texts and what becomes one");
    else if (a->kind == VALUE_NODE && b->kind == VALUE_NODE)
        diag_hint(evaluator->diag, report, "write: %s { a { }  b { } }",
                  expr->kind == EXPR_SUBTRACT   ? "difference"
                  : expr->kind == EXPR_MULTIPLY ? "intersection"
                                                : "union");
    else if (expr->kind == EXPR_MODULO && a->kind == VALUE_NUMBER &&
             b->kind == VALUE_NODE) /* 40%, and sphere { } below it */
        diag_hint(evaluator->diag, report, "it is the remainder of a division, not a hundredth; write: %g",
                  a->as.number / 100);
    else if (expr->kind == EXPR_ADD && a->kind == VALUE_LIST)
        diag_hint(evaluator->diag, report, "write: list + [element]");
    else if ((is_vector(a->kind) && b->kind == VALUE_NUMBER) || (a->kind == VALUE_NUMBER && is_vector(b->kind)))
        hint_number_and_vector(evaluator, report, expr, a, b);
}

static void not_finite(Evaluator *evaluator, Expr *expr, const char *what, Value *result)
{
    eval_error(evaluator, expr, D_BAD_NUMBER, "%s", what);
    result->kind = VALUE_POISON;
}

/* floored: the result has the sign of the divisor, so that angles and tiles go on smoothly below 0 */
static double modulo(double a, double b)
{
    double rest = fmod(a, b);
    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}

static double arithmetic(ExprKind kind, double a, double b)
{
    switch (kind) {
    case EXPR_ADD: return a + b;
    case EXPR_SUBTRACT: return a - b;
    case EXPR_MULTIPLY: return a * b;
    case EXPR_DIVIDE: return a / b;
    case EXPR_MODULO: return modulo(a, b);
    default: return pow(a, b);
    }
}

/* Vectors and colours work element by element; a number scales them; beside a colour it is grey. */
static bool spread(ExprKind kind, const Value *a, const Value *b, ValueKind *result)
{
    unsigned width_a = value_width(a->kind), width_b = value_width(b->kind);
    if (width_a == 0 || width_b == 0) return false;
    bool number_a = a->kind == VALUE_NUMBER, number_b = b->kind == VALUE_NUMBER;
    *result = number_a ? b->kind : a->kind;
    if (a->kind == b->kind || (number_b && a->kind == VALUE_COLOR) || (number_a && b->kind == VALUE_COLOR)) return true;
    if (number_b) return kind == EXPR_MULTIPLY || kind == EXPR_DIVIDE || kind == EXPR_POWER || kind == EXPR_MODULO;
    return number_a && kind == EXPR_MULTIPLY;
}

static void join_texts(Evaluator *evaluator, const Expr *expr, const Value *a, const Value *b, Value *result)
{
    if (!eval_text_fits(evaluator, strlen(a->as.text) + strlen(b->as.text), expr->span)) {
        result->kind = VALUE_POISON;
        return;
    }
    *result = value_text(arena_format(evaluator->arena, "%s%s", a->as.text, b->as.text));
}

static void compose_transforms(Evaluator *evaluator, const Value *a, const Value *b, Value *result)
{
    Affine *both = ARENA_NEW(evaluator->arena, Affine);
    *both = affine_compose(b->as.transform, a->as.transform); /* as written: a first */
    *result = (Value){.kind = VALUE_TRANSFORM, .as.transform = both};
}

static void join_lists(Evaluator *evaluator, const Expr *expr, const Value *a, const Value *b, Value *result)
{
    ListBuilder builder = {.arena = evaluator->arena};
    double bytes = ((double)value_count(a) + (double)value_count(b)) * (2 * sizeof(Value)); /* at most, with growth */
    if (!eval_reserve(evaluator, bytes, expr->span)) {
        result->kind = VALUE_POISON;
        return;
    }
    bool lists = a->kind == VALUE_LIST && b->kind == VALUE_LIST;
    if (lists && list_join(evaluator->arena, a->as.list, b->as.list, result)) return;
    for (const Value *list = a; list; list = list == a ? b : NULL) {
        size_t n = value_count(list);
        for (size_t i = 0; i < n && eval_step(evaluator, expr->span); i++) {
            Value element = value_element(list, i);
            list_builder_add(&builder, &element);
        }
    }
    *result = list_builder_finish(&builder);
}

static bool scales(const Value *value)
{
    return value->kind == VALUE_TERM && value->as.term->type->flags & TERM_SCALES;
}

static void scale_term(Evaluator *evaluator, Expr *expr, const EvalTerm *term, double factor, Value *result)
{
    EvalTerm *scaled = ARENA_NEW(evaluator->arena, EvalTerm);
    *scaled = *term;
    scaled->scale = arithmetic(expr->kind, term->scale, factor);
    *result = (Value){.kind = VALUE_TERM, .as.term = scaled};
    if (!isfinite(scaled->scale)) not_finite(evaluator, expr, "the result is not finite", result);
}

static bool is_sequence(const Value *value)
{
    return value->kind == VALUE_LIST || value->kind == VALUE_RANGE;
}

static void general_arithmetic(Evaluator *evaluator, Expr *expr, const Value *a, const Value *b, Value *result)
{
    ValueKind kind;
    Value out;
    if (spread(expr->kind, a, b, &kind)) {
        unsigned width = value_width(kind);
        for (unsigned i = 0; i < width; i++)
            out.as.v[i] = arithmetic(expr->kind, a->as.v[a->kind == VALUE_NUMBER ? 0 : i],
                                     b->as.v[b->kind == VALUE_NUMBER ? 0 : i]);
        out.kind = kind;
        if (!value_is_finite(&out)) {
            not_finite(evaluator, expr, "the result is not finite", &out);
        }
        *result = out;
    } else if (expr->kind == EXPR_ADD && a->kind == VALUE_STRING && b->kind == VALUE_STRING) {
        join_texts(evaluator, expr, a, b, result);
    } else if (expr->kind == EXPR_ADD && is_sequence(a) && is_sequence(b)) {
        join_lists(evaluator, expr, a, b, result);
    } else if (expr->kind == EXPR_MULTIPLY && a->kind == VALUE_TRANSFORM && b->kind == VALUE_TRANSFORM) {
        compose_transforms(evaluator, a, b, result);
    } else if ((expr->kind == EXPR_MULTIPLY || expr->kind == EXPR_DIVIDE) && scales(a) && b->kind == VALUE_NUMBER) {
        scale_term(evaluator, expr, a->as.term, b->as.number, result);
    } else if (expr->kind == EXPR_MULTIPLY && a->kind == VALUE_NUMBER && scales(b)) {
        scale_term(evaluator, expr, b->as.term, a->as.number, result);
    } else {
        wrong_operands(evaluator, expr, a, b, result);
    }
}

#define ARITHMETIC(name, formula)                                                                                      \
    static void name(Evaluator *evaluator, Expr *expr, Value *result)                                                  \
    {                                                                                                                  \
        Value room_a, room_b;                                                                                          \
        if (eval_stack_is_deep(evaluator, expr->span)) {                                                               \
            result->kind = VALUE_POISON;                                                                               \
            return;                                                                                                    \
        }                                                                                                              \
        const Value *a = eval_operand(evaluator, expr->as.op.a, &room_a);                                              \
        const Value *b = eval_operand(evaluator, expr->as.op.b, &room_b);                                              \
        if (LIKELY(a->kind == VALUE_NUMBER && b->kind == VALUE_NUMBER)) {                                              \
            double x = a->as.number, y = b->as.number;                                                                 \
            result->as.number = formula;                                                                               \
            result->kind = VALUE_NUMBER;                                                                               \
        } else {                                                                                                       \
            general_arithmetic(evaluator, expr, a, b, result);                                                         \
        }                                                                                                              \
    }

ARITHMETIC(eval_add, x + y)
ARITHMETIC(eval_subtract, x - y)
ARITHMETIC(eval_multiply, x *y)

/* division, remainder and power: the ones that leave the finite numbers by one step */
static void eval_divide(Evaluator *evaluator, Expr *expr, Value *result)
{
    Value room_a, room_b;
    if (eval_stack_is_deep(evaluator, expr->span)) {
        result->kind = VALUE_POISON;
        return;
    }
    const Value *a = eval_operand(evaluator, expr->as.op.a, &room_a);
    const Value *b = eval_operand(evaluator, expr->as.op.b, &room_b);
    if (b->kind == VALUE_NUMBER && b->as.number == 0 && expr->kind != EXPR_POWER && a->kind != VALUE_POISON) {
        not_finite(evaluator, expr, "division by zero", result);
    } else if (a->kind == VALUE_NUMBER && b->kind == VALUE_NUMBER) {
        double x = a->as.number, y = b->as.number, value = arithmetic(expr->kind, x, y);
        *result = value_number(value);
        if (!isfinite(value) && isfinite(x) && isfinite(y))
            not_finite(evaluator, expr,
                       arena_format(evaluator->arena, "%g %s %g is no finite number", x, operator_text(expr->kind), y),
                       result);
    } else {
        general_arithmetic(evaluator, expr, a, b, result);
    }
}

static void eval_sign(Evaluator *evaluator, Expr *expr, Value *result)
{
    Value room;
    const Value *a = eval_operand(evaluator, expr->as.op.a, &room);
    unsigned width = value_width(a->kind);
    if (width == 0) {
        if (a->kind != VALUE_POISON)
            eval_error(evaluator, expr, D_WRONG_TYPE, "%s has no sign", value_describe(evaluator->arena, a));
        result->kind = VALUE_POISON;
        return;
    }
    *result = *a;
    if (expr->kind == EXPR_NEGATE)
        for (unsigned i = 0; i < width; i++) result->as.v[i] = -result->as.v[i];
}

/* ---- truth ---- */

static void eval_compare(Evaluator *evaluator, Expr *expr, Value *result)
{
    Value room_a, room_b;
    const Value *a = eval_operand(evaluator, expr->as.op.a, &room_a);
    const Value *b = eval_operand(evaluator, expr->as.op.b, &room_b);
    int order;
    if (a->kind == VALUE_NUMBER && b->kind == VALUE_NUMBER) {
        order = (a->as.number > b->as.number) - (a->as.number < b->as.number);
    } else if (any_poison(a, b)) {
        result->kind = VALUE_POISON;
        return;
    } else if (expr->kind == EXPR_EQUAL || expr->kind == EXPR_NOT_EQUAL) {
        order = !value_equal(a, b);
    } else if (a->kind == VALUE_STRING && b->kind == VALUE_STRING) {
        order = strcmp(a->as.text, b->as.text);
    } else {
        wrong_operands(evaluator, expr, a, b, result);
        return;
    }
    result->kind = VALUE_BOOL;
    switch (expr->kind) {
    case EXPR_EQUAL: result->as.truth = order == 0; break;
    case EXPR_NOT_EQUAL: result->as.truth = order != 0; break;
    case EXPR_LESS: result->as.truth = order < 0; break;
    case EXPR_LESS_EQUAL: result->as.truth = order <= 0; break;
    case EXPR_GREATER: result->as.truth = order > 0; break;
    default: result->as.truth = order >= 0; break;
    }
}

void eval_hint_truth(Evaluator *evaluator, Diagnostic *report, const Expr *expr)
{
    Diag *diag = evaluator->diag;
    bool loose = expr->kind == EXPR_CONDITION;
    const char *text = eval_written(evaluator, expr->span, 40, "\n", "...");
    if (expr->kind == EXPR_CONSTANT)
        diag_hint(diag, report, "write a comparison, as n != 0, or true or false");
    else
        diag_hint(diag, report, "write: %s%s%s != 0", loose ? "(" : "", text, loose ? ")" : "");
}

bool eval_condition(Evaluator *evaluator, Expr *expr, bool *poison)
{
    Value room;
    const Value *value = eval_operand(evaluator, expr, &room);
    *poison = value->kind != VALUE_BOOL;
    if (!*poison) return value->as.truth;
    if (value->kind == VALUE_POISON) return false;
    Diagnostic *report = eval_error(evaluator, expr, D_WRONG_TYPE, "expected true or false, not %s",
                                    value_describe(evaluator->arena, value));
    if (value->kind == VALUE_NUMBER) eval_hint_truth(evaluator, report, expr);
    return false;
}

static void eval_not(Evaluator *evaluator, Expr *expr, Value *result)
{
    bool poison, truth = eval_condition(evaluator, expr->as.op.a, &poison);
    *result = poison ? value_poison() : value_truth(!truth);
}

/* 'and' and 'or': the right side is looked at only when it matters */
static void eval_logic(Evaluator *evaluator, Expr *expr, Value *result)
{
    if (eval_stack_is_deep(evaluator, expr->span)) {
        result->kind = VALUE_POISON;
        return;
    }
    bool poison, truth = eval_condition(evaluator, expr->as.op.a, &poison);
    if (!poison && truth == (expr->kind == EXPR_AND)) truth = eval_condition(evaluator, expr->as.op.b, &poison);
    *result = poison ? value_poison() : value_truth(truth);
}

static void eval_choice(Evaluator *evaluator, Expr *expr, Value *result)
{
    bool poison, truth = eval_condition(evaluator, expr->as.op.a, &poison);
    if (poison)
        result->kind = VALUE_POISON;
    else
        eval_value(evaluator, truth ? expr->as.op.b : expr->as.op.c, result);
}

/* ---- vectors, lists, ranges ---- */

static void eval_vector_expr(Evaluator *evaluator, Expr *expr, Value *result)
{
    Value out = {.kind = value_vector_kind(expr->as.list.n)};
    bool poison = false;
    for (uint32_t i = 0; i < expr->as.list.n; i++) {
        Value room;
        const Value *element = eval_operand(evaluator, expr->as.list.items[i], &room);
        if (element->kind == VALUE_NUMBER) {
            out.as.v[i] = element->as.number;
            continue;
        }
        if (element->kind != VALUE_POISON)
            eval_error(evaluator, expr->as.list.items[i], D_WRONG_TYPE, "an element of a vector is a number, not %s",
                       value_describe(evaluator->arena, element));
        poison = true;
    }
    *result = poison ? value_poison() : out;
}

static void add_elements(Evaluator *evaluator, Expr *expr, ListBuilder *builder);

static void add_each(Evaluator *evaluator, Expr *expr, ListBuilder *builder)
{
    Value source;
    if (!eval_sequence(evaluator, expr->as.each.source, &source)) return;
    size_t n = value_count(&source);
    for (size_t i = 0; i < n && eval_step(evaluator, expr->span); i++) {
        *eval_slot(evaluator, expr->as.each.slot) = value_element(&source, i);
        add_elements(evaluator, expr->as.each.body, builder);
    }
}

static void add_elements(Evaluator *evaluator, Expr *expr, ListBuilder *builder)
{
    if (expr->kind == EXPR_EACH) {
        add_each(evaluator, expr, builder);
    } else if (expr->kind == EXPR_WHEN) {
        bool poison;
        if (eval_condition(evaluator, expr->as.each.source, &poison))
            add_elements(evaluator, expr->as.each.body, builder);
    } else {
        Value room;
        list_builder_add(builder, eval_operand(evaluator, expr, &room));
    }
}

static void eval_list(Evaluator *evaluator, Expr *expr, Value *result)
{
    ListBuilder builder = {.arena = evaluator->arena};
    for (uint32_t i = 0; i < expr->as.list.n; i++) add_elements(evaluator, expr->as.list.items[i], &builder);
    *result = list_builder_finish(&builder);
    if (result->as.list->depth <= LIMIT_LIST_DEPTH) return;
    limit_hint(evaluator->diag,
               eval_error(evaluator, expr, D_TOO_DEEP, "lists within lists, deeper than %d levels", LIMIT_LIST_DEPTH),
               OVER_LIST_DEPTH);
    result->kind = VALUE_POISON;
}

static bool range_number(Evaluator *evaluator, Expr *expr, double *number)
{
    Value room;
    const Value *value = eval_operand(evaluator, expr, &room);
    if (value->kind == VALUE_NUMBER) {
        *number = value->as.number;
        return true;
    }
    if (value->kind != VALUE_POISON)
        eval_error(evaluator, expr, D_WRONG_TYPE, "a range goes between numbers, not %s",
                   value_describe(evaluator->arena, value));
    return false;
}

/* Steps that miss the end by less than this part of a step, as 0..1 by .1 may, still reach it. */
#define RANGE_SLACK 1e-9
#define LARGEST_RANGE 1e15

static void eval_range(Evaluator *evaluator, Expr *expr, Value *result)
{
    double first, last, step = 1;
    result->kind = VALUE_POISON;
    if (!range_number(evaluator, expr->as.op.a, &first) || !range_number(evaluator, expr->as.op.b, &last)) return;
    if (expr->as.op.c && !range_number(evaluator, expr->as.op.c, &step)) return;
    double turns = (last - first) / step;
    if (step == 0 || !isfinite(turns) || turns > LARGEST_RANGE) {
        eval_error(evaluator, expr, D_BAD_RANGE, "a range from %g to %g by %g has no end", first, last, step);
        return;
    }
    uint64_t n = 0;
    if (turns >= 0) {
        double whole = floor(turns + RANGE_SLACK);
        bool reaches_end = fabs(turns - whole) <= RANGE_SLACK;
        n = (uint64_t)whole + (expr->as.op.open && reaches_end ? 0 : 1);
    }
    *result = (Value){.kind = VALUE_RANGE, .as.range = {first, step, n}};
}

bool eval_sequence(Evaluator *evaluator, Expr *expr, Value *value)
{
    eval_value(evaluator, expr, value);
    if (is_sequence(value)) return true;
    if (value->kind != VALUE_POISON)
        eval_error(evaluator, expr, D_WRONG_TYPE, "expected a list or a range, not %s",
                   value_describe(evaluator->arena, value));
    return false;
}

/* ---- parts ---- */

static void eval_swizzle(Evaluator *evaluator, Expr *expr, Value *result)
{
    Value room, out;
    const Value *base = eval_operand(evaluator, expr->as.member.base, &room);
    unsigned width = base->kind == VALUE_NUMBER ? 0 : value_width(base->kind), n = expr->as.member.n;
    for (unsigned i = 0; i < n; i++) {
        unsigned component = expr->as.member.component[i];
        if (component >= width) {
            if (base->kind != VALUE_POISON)
                eval_error(evaluator, expr, D_WRONG_TYPE, "%s has no '.%s'", value_describe(evaluator->arena, base),
                           expr->as.member.name->text);
            result->kind = VALUE_POISON;
            return;
        }
        out.as.v[i] = base->as.v[component];
    }
    out.kind = n == 1 ? VALUE_NUMBER : base->kind == VALUE_COLOR && n == 3 ? VALUE_COLOR : value_vector_kind(n);
    *result = out;
}

static void eval_field(Evaluator *evaluator, Expr *expr, Value *result)
{
    Value room;
    const Value *base = eval_operand(evaluator, expr->as.member.base, &room);
    const char *name = expr->as.member.name->text;
    if (base->kind == VALUE_RECORD && record_field(base->as.record, name, result)) return;
    if (base->kind != VALUE_POISON) {
        Diagnostic *report =
            eval_error(evaluator, expr, D_WRONG_TYPE, "%s has no '.%s'", value_describe(evaluator->arena, base), name);
        if (base->kind == VALUE_NONE)
            diag_hint(evaluator->diag, report, "a ray that meets nothing gives none: ask for '!= none' first");
        else if (base->kind == VALUE_NODE && schema_prop(base->as.node->type, name))
            hint_at_reading(evaluator->diag, report, name);
    }
    result->kind = VALUE_POISON;
}

static void eval_index(Evaluator *evaluator, Expr *expr, Value *result)
{
    Value room_a, room_b;
    const Value *base = eval_operand(evaluator, expr->as.op.a, &room_a);
    const Value *index = eval_operand(evaluator, expr->as.op.b, &room_b);
    result->kind = VALUE_POISON;
    if (any_poison(base, index)) return;
    bool vector = base->kind != VALUE_NUMBER && value_width(base->kind) > 0;
    if (!vector && !is_sequence(base)) {
        eval_error(evaluator, expr, D_WRONG_TYPE, "%s has no elements", value_describe(evaluator->arena, base));
        return;
    }
    if (index->kind != VALUE_NUMBER) {
        eval_error(evaluator, expr, D_WRONG_TYPE, "an index is a number, not %s",
                   value_describe(evaluator->arena, index));
        return;
    }
    size_t n = vector ? value_width(base->kind) : value_count(base);
    double at = index->as.number;
    if (!(at >= 0 && at < (double)n && at == floor(at))) {
        Diagnostic *report =
            eval_error(evaluator, expr, D_BAD_INDEX, "index %g is no whole number from 0 to %.0f", at, (double)n - 1);
        if (at == -1) diag_hint(evaluator->diag, report, "the last element is list[len(list) - 1]");
    } else {
        *result = vector ? value_number(base->as.v[(size_t)at]) : value_element(base, (size_t)at);
    }
}

static void eval_let(Evaluator *evaluator, Expr *expr, Value *result)
{
    const Args *bindings = &expr->as.let.bindings;
    for (uint32_t i = 0; i < bindings->n; i++) {
        Value value;
        eval_value(evaluator, bindings->items[i].value, &value);
        *eval_slot(evaluator, expr->as.let.slots[i]) = value;
    }
    eval_value(evaluator, expr->as.let.body, result);
}

EvalFunction *const eval_functions[] = {
    [EXPR_POISON] = eval_poison,
    [EXPR_CONSTANT] = eval_constant,
    [EXPR_NAME] = eval_bare_word,
    [EXPR_GLOBAL] = eval_variable,
    [EXPR_LOCAL] = eval_variable,
    [EXPR_OUTER] = eval_variable,
    [EXPR_VECTOR] = eval_vector_expr,
    [EXPR_LIST] = eval_list,
    [EXPR_NEGATE] = eval_sign,
    [EXPR_PLUS] = eval_sign,
    [EXPR_NOT] = eval_not,
    [EXPR_ADD] = eval_add,
    [EXPR_SUBTRACT] = eval_subtract,
    [EXPR_MULTIPLY] = eval_multiply,
    [EXPR_DIVIDE] = eval_divide,
    [EXPR_MODULO] = eval_divide,
    [EXPR_POWER] = eval_divide,
    [EXPR_EQUAL] = eval_compare,
    [EXPR_NOT_EQUAL] = eval_compare,
    [EXPR_LESS] = eval_compare,
    [EXPR_LESS_EQUAL] = eval_compare,
    [EXPR_GREATER] = eval_compare,
    [EXPR_GREATER_EQUAL] = eval_compare,
    [EXPR_AND] = eval_logic,
    [EXPR_OR] = eval_logic,
    [EXPR_CONDITION] = eval_choice,
    [EXPR_LET] = eval_let,
    [EXPR_RANGE] = eval_range,
    [EXPR_CALL] = eval_poison,
    [EXPR_FUNCTION] = eval_poison, /* prop_check looks for it first */
    [EXPR_CALL_DEF] = eval_call_def,
    [EXPR_CALL_BUILTIN] = eval_call_builtin,
    [EXPR_CALL_TERM] = eval_call_term,
    [EXPR_MEMBER] = eval_swizzle,
    [EXPR_FIELD] = eval_field,
    [EXPR_INDEX] = eval_index,
    [EXPR_NODE] = eval_node_expr,
    [EXPR_EACH] = eval_poison,
    [EXPR_WHEN] = eval_poison,
};

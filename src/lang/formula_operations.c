/* formula_operations.c - operators, vectors, lists and conditions of functions that are compiled.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "lang/formula_parts.h"

/* ---- arithmetic ---- */

static bool has_width(const Form *form)
{
    return !form->list && value_width(form->kind) > 0;
}

/* As the evaluator has it: vectors and colours work element by element; a number scales them; beside a colour it is grey. */
static bool spread(ExprKind kind, const Form *a, const Form *b, ValueKind *result)
{
    if (!has_width(a) || !has_width(b)) return false;
    bool number_a = a->kind == VALUE_NUMBER, number_b = b->kind == VALUE_NUMBER;
    *result = number_a ? b->kind : a->kind;
    if (a->kind == b->kind || (number_b && a->kind == VALUE_COLOR) || (number_a && b->kind == VALUE_COLOR)) return true;
    if (number_b) return kind == EXPR_MULTIPLY || kind == EXPR_DIVIDE || kind == EXPR_POWER || kind == EXPR_MODULO;
    return number_a && kind == EXPR_MULTIPLY;
}

static Form wrong_operands(Compiler *c, const Expr *expr, const Form *a, const Form *b)
{
    if (!c->failed)
        eval_report(c->evaluator, D_WRONG_TYPE, expr->span, "this operator does not work between %s and %s",
                    form_describe(a), form_describe(b));
    return form_failed(c);
}

static Form arithmetic(Compiler *c, Expr *expr)
{
    static const ProgramOp ops[] = {PROGRAM_ADD,    PROGRAM_SUBTRACT, PROGRAM_MULTIPLY,
                                    PROGRAM_DIVIDE, PROGRAM_MODULO,   PROGRAM_POWER};
    Form a = formula_expr(c, expr->as.op.a), b = formula_expr(c, expr->as.op.b), result = {.known = false};
    if (c->failed) return form_failed(c);
    if (a.known && b.known) return form_folded(c, expr, &a, &b);
    if (!spread(expr->kind, &a, &b, &result.kind)) return wrong_operands(c, expr, &a, &b);
    for (unsigned i = 0; i < value_width(result.kind); i++) {
        uint16_t x = form_register(c, expr, &a, i), y = form_register(c, expr, &b, i);
        result.at[i] = formula_step(c, expr, ops[expr->kind - EXPR_ADD], x, y, 0);
    }
    return result;
}

static Form sign(Compiler *c, Expr *expr)
{
    Form a = formula_expr(c, expr->as.op.a), result = a;
    if (c->failed || a.known) return c->failed ? a : form_folded(c, expr, &a, NULL);
    if (!has_width(&a)) return form_refused(c, expr, "the sign of this");
    uint16_t zero = formula_constant(c, expr, 0);
    for (unsigned i = 0; expr->kind == EXPR_NEGATE && i < value_width(a.kind); i++)
        result.at[i] = formula_step(c, expr, PROGRAM_SUBTRACT, zero, a.at[i], 0);
    return result;
}

/* ---- truth ---- */

static Form truth(uint16_t at)
{
    return (Form){.kind = VALUE_BOOL, .at = {at}};
}

static Form compare(Compiler *c, Expr *expr)
{
    Form a = formula_expr(c, expr->as.op.a), b = formula_expr(c, expr->as.op.b);
    if (c->failed) return form_failed(c);
    if (a.known && b.known) return form_folded(c, expr, &a, &b);
    bool equality = expr->kind == EXPR_EQUAL || expr->kind == EXPR_NOT_EQUAL;
    bool numbers = a.kind == VALUE_NUMBER && b.kind == VALUE_NUMBER, alike = has_width(&a) && a.kind == b.kind;
    bool truths = a.kind == VALUE_BOOL && b.kind == VALUE_BOOL;
    if (!(equality ? alike || truths : numbers)) return wrong_operands(c, expr, &a, &b);
    uint16_t x = form_register(c, expr, &a, 0), y = form_register(c, expr, &b, 0), at;
    if (equality) {
        at = formula_step(c, expr, PROGRAM_EQUAL, x, y, 0);
        for (unsigned i = 1; i < value_width(a.kind); i++) {
            uint16_t xi = form_register(c, expr, &a, i), yi = form_register(c, expr, &b, i);
            at = formula_step(c, expr, PROGRAM_AND, at, formula_step(c, expr, PROGRAM_EQUAL, xi, yi, 0), 0);
        }
        return truth(expr->kind == EXPR_EQUAL ? at : formula_step(c, expr, PROGRAM_NOT, at, 0, 0));
    }
    bool strict = expr->kind == EXPR_LESS || expr->kind == EXPR_GREATER;
    bool swapped = expr->kind == EXPR_GREATER || expr->kind == EXPR_GREATER_EQUAL;
    return truth(
        formula_step(c, expr, strict ? PROGRAM_LESS : PROGRAM_LESS_EQUAL, swapped ? y : x, swapped ? x : y, 0));
}

static bool is_truth(Compiler *c, const Expr *expr, const Form *form)
{
    if (c->failed || form->kind == VALUE_BOOL) return !c->failed;
    Diagnostic *report =
        eval_report(c->evaluator, D_WRONG_TYPE, expr->span, "expected true or false, not %s", form_describe(form));
    if (form->kind == VALUE_NUMBER) eval_hint_truth(c->evaluator, report, expr);
    c->failed = true;
    return false;
}

static Form logic(Compiler *c, Expr *expr)
{
    bool both = expr->kind == EXPR_AND;
    Form a = formula_expr(c, expr->as.op.a);
    if (!is_truth(c, expr->as.op.a, &a)) return form_failed(c);
    if (a.known && a.value.as.truth != both) return a;
    Form b = formula_expr(c, expr->as.op.b);
    if (!is_truth(c, expr->as.op.b, &b)) return form_failed(c);
    if (a.known) return b;
    return truth(formula_step(c, expr, both ? PROGRAM_AND : PROGRAM_OR, a.at[0], form_register(c, expr, &b, 0), 0));
}

static Form negation(Compiler *c, Expr *expr)
{
    Form a = formula_expr(c, expr->as.op.a);
    if (!is_truth(c, expr->as.op.a, &a)) return form_failed(c);
    if (a.known) return form_folded(c, expr, &a, NULL);
    return truth(formula_step(c, expr, PROGRAM_NOT, a.at[0], 0, 0));
}

static Form condition(Compiler *c, Expr *expr)
{
    Form a = formula_expr(c, expr->as.op.a), result = {.known = false};
    if (!is_truth(c, expr->as.op.a, &a)) return form_failed(c);
    if (a.known) return formula_expr(c, a.value.as.truth ? expr->as.op.b : expr->as.op.c);
    Form yes = formula_expr(c, expr->as.op.b), no = formula_expr(c, expr->as.op.c);
    if (c->failed) return form_failed(c);
    bool truths = yes.kind == VALUE_BOOL && no.kind == VALUE_BOOL;
    bool grey =
        (yes.kind == VALUE_NUMBER && no.kind == VALUE_COLOR) || (yes.kind == VALUE_COLOR && no.kind == VALUE_NUMBER);
    if (!truths && !grey && !(has_width(&yes) && yes.kind == no.kind)) {
        eval_report(c->evaluator, D_WRONG_TYPE, expr->span, "this is %s or %s, as the place has it: both must be alike",
                    form_describe(&yes), form_describe(&no));
        return form_failed(c);
    }
    result.kind = grey ? VALUE_COLOR : yes.kind;
    unsigned width = truths ? 1 : value_width(result.kind);
    for (unsigned i = 0; i < width; i++) {
        uint16_t x = form_register(c, expr, &yes, i), y = form_register(c, expr, &no, i);
        result.at[i] = formula_step(c, expr, PROGRAM_SELECT, a.at[0], x, y);
    }
    return result;
}

/* ---- vectors and lists ---- */

static Form vector(Compiler *c, Expr *expr)
{
    Form result = {.kind = value_vector_kind(expr->as.list.n)};
    Value value = {.kind = result.kind};
    bool known = true;
    for (uint32_t i = 0; i < expr->as.list.n; i++) {
        Form element = formula_expr(c, expr->as.list.items[i]);
        if (c->failed) return form_failed(c);
        if (element.kind != VALUE_NUMBER) return form_refused(c, expr, "a vector of this");
        if (element.known) value.as.v[i] = element.value.as.number;
        known = known && element.known;
        result.at[i] = form_register(c, expr, &element, 0);
    }
    return known ? form_known(&value) : result;
}

typedef struct Items {
    Form *items;
    size_t n, capacity;
    bool known; /* all of them */
} Items;

static void add_item(Compiler *c, Items *items, const Form *form)
{
    ARENA_ROOM(c->evaluator->arena, items->items, items->capacity, items->n, 16);
    items->items[items->n++] = *form;
    items->known = items->known && form->known;
}

static void add_elements(Compiler *c, Expr *expr, Items *items)
{
    if (c->failed) return;
    if (expr->kind == EXPR_EACH) {
        Form source = formula_expr(c, expr->as.each.source);
        bool sequence = source.known && (source.kind == VALUE_LIST || source.kind == VALUE_RANGE);
        Form *slot = formula_slot(c, expr->as.each.slot);
        if (c->failed) return;
        if (!slot || !sequence) {
            (void)form_refused(c, expr->as.each.source, "over what a loop goes");
            return;
        }
        size_t n = value_count(&source.value);
        for (size_t i = 0; i < n && !c->failed; i++) {
            if (!eval_step(c->evaluator, expr->span)) c->failed = true;
            Value element = value_element(&source.value, i);
            *slot = form_known(&element);
            add_elements(c, expr->as.each.body, items);
        }
    } else if (expr->kind == EXPR_WHEN) {
        Form wanted = formula_expr(c, expr->as.each.source);
        if (!is_truth(c, expr->as.each.source, &wanted)) return;
        if (!wanted.known)
            (void)form_refused(c, expr->as.each.source, "whether a list has an element");
        else if (wanted.value.as.truth)
            add_elements(c, expr->as.each.body, items);
    } else {
        Form form = formula_expr(c, expr);
        if (!c->failed) add_item(c, items, &form);
    }
}

static Form list(Compiler *c, Expr *expr)
{
    Items items = {.known = true};
    for (uint32_t i = 0; i < expr->as.list.n; i++) add_elements(c, expr->as.list.items[i], &items);
    if (c->failed) return form_failed(c);
    if (items.known) {
        ListBuilder builder = {.arena = c->evaluator->arena};
        for (size_t i = 0; i < items.n; i++) list_builder_add(&builder, &items.items[i].value);
        Value value = list_builder_finish(&builder);
        return form_known(&value);
    }
    FormList *made = ARENA_NEW(c->evaluator->arena, FormList);
    *made = (FormList){items.n, items.items};
    return (Form){.kind = VALUE_LIST, .list = made};
}

/* An element of a known list by a number that depends on the place: the list becomes constants. */
static Form entry_of(Compiler *c, Expr *expr, const Value *list_value, uint16_t index)
{
    size_t n = value_count(list_value);
    Value first = n ? value_element(list_value, 0) : value_none();
    Form result = {.kind = first.kind};
    unsigned width = value_width(first.kind);
    if (width == 0 || n * width > PROGRAM_MOST_REGISTERS / 2) return form_refused(c, expr, "an element of this list");
    for (unsigned k = 0; k < width; k++) {
        if (c->n_constants + n > PROGRAM_MOST_REGISTERS) return form_refused(c, expr, "an element of so long a list");
        uint16_t table = (uint16_t)(FORMULA_CONSTANTS + c->n_constants);
        for (size_t i = 0; i < n; i++) {
            Value element = value_element(list_value, i);
            if (element.kind != first.kind) return form_refused(c, expr, "an element of a list of various things");
            formula_new_constant(c, element.as.v[k]);
        }
        result.at[k] = formula_step(c, expr, PROGRAM_ENTRY, index, table, formula_constant(c, expr, (double)n));
    }
    return result;
}

static Form element(Compiler *c, Expr *expr)
{
    Form base = formula_expr(c, expr->as.op.a), index = formula_expr(c, expr->as.op.b);
    if (c->failed) return form_failed(c);
    if (base.known && index.known) return form_folded(c, expr, &base, &index);
    if (index.kind != VALUE_NUMBER) return form_refused(c, expr, "an element by this");
    size_t n = base.list ? base.list->n : has_width(&base) ? value_width(base.kind) : 0;
    double at = index.known ? index.value.as.number : -1;
    if (base.known && base.kind == VALUE_LIST) return entry_of(c, expr, &base.value, form_register(c, expr, &index, 0));
    if (!index.known) return form_refused(c, expr, "which element of this is taken");
    if (!(at >= 0 && at < (double)n && at == floor(at))) {
        eval_report(c->evaluator, D_BAD_INDEX, expr->span, "there is no element %g of %zu", at, n);
        return form_failed(c);
    }
    return base.list ? base.list->items[(size_t)at] : form_number(base.at[(size_t)at]);
}

static Form swizzle(Compiler *c, Expr *expr)
{
    Form base = formula_expr(c, expr->as.member.base), result = {.kind = VALUE_NUMBER};
    if (c->failed) return form_failed(c);
    if (base.known) return form_folded(c, expr, &base, NULL);
    unsigned width = has_width(&base) ? value_width(base.kind) : 0, n = expr->as.member.n;
    for (unsigned i = 0; i < n; i++) {
        if (width < 2 || expr->as.member.component[i] >= width) {
            eval_report(c->evaluator, D_WRONG_TYPE, expr->span, "%s has no '%s'", form_describe(&base),
                        expr->as.member.name->text);
            return form_failed(c);
        }
        result.at[i] = base.at[expr->as.member.component[i]];
    }
    if (n > 1) result.kind = base.kind == VALUE_COLOR && n == 3 ? VALUE_COLOR : value_vector_kind(n);
    return result;
}

Form form_of_operation(Compiler *c, Expr *expr)
{
    switch (expr->kind) {
    case EXPR_VECTOR: return vector(c, expr);
    case EXPR_LIST: return list(c, expr);
    case EXPR_NEGATE:
    case EXPR_PLUS: return sign(c, expr);
    case EXPR_NOT: return negation(c, expr);
    case EXPR_AND:
    case EXPR_OR: return logic(c, expr);
    case EXPR_CONDITION: return condition(c, expr);
    case EXPR_MEMBER: return swizzle(c, expr);
    case EXPR_INDEX: return element(c, expr);
    case EXPR_RANGE: {
        Form a = formula_expr(c, expr->as.op.a), b = formula_expr(c, expr->as.op.b);
        Form step = expr->as.op.c ? formula_expr(c, expr->as.op.c) : a;
        if (c->failed) return form_failed(c);
        if (!a.known || !b.known || !step.known) return form_refused(c, expr, "a range");
        Expr copy = *expr, by = {.kind = EXPR_CONSTANT, .span = expr->span};
        by.as.constant.value = step.value;
        if (copy.as.op.c) copy.as.op.c = &by;
        return form_folded(c, &copy, &a, &b);
    }
    case EXPR_FIELD: {
        Form base = formula_expr(c, expr->as.member.base);
        return base.known && !c->failed ? form_folded(c, expr, &base, NULL) : form_refused(c, expr, "a part of this");
    }
    default: break;
    }
    if (expr->kind >= EXPR_ADD && expr->kind <= EXPR_POWER) return arithmetic(c, expr);
    if (expr->kind >= EXPR_EQUAL && expr->kind <= EXPR_GREATER_EQUAL) return compare(c, expr);
    return form_refused(c, expr, "this");
}

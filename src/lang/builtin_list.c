/* builtin_list.c - the functions of the language that make one value of a list, or order it.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lang/builtin_run.h"

static bool is_list(const BuiltinCall *call, Value *result)
{
    ValueKind kind = call->args[0].kind;
    if (kind == VALUE_LIST || kind == VALUE_RANGE) return true;
    builtin_wrong(call, 0, "a list", result);
    return false;
}

/* ---- sums and products ---- */

/* Element by element, for vectors and colours; `empty` is the result of an empty list. */
static void fold(const BuiltinCall *call, double (*join)(double, double), double empty, Value *result)
{
    if (!is_list(call, result)) return;
    Value total = value_number(empty);
    size_t n = value_count(&call->args[0]);
    for (size_t i = 0; i < n && eval_step(call->evaluator, call->expr->span); i++) {
        Value item = value_element(&call->args[0], i);
        unsigned width = value_width(item.kind);
        if (item.kind == VALUE_POISON) {
            *result = item;
            return;
        }
        if (i == 0) {
            total.kind = item.kind;
            for (unsigned k = 0; k < width; k++) total.as.v[k] = empty;
        }
        if (width == 0 || item.kind != total.kind) {
            builtin_wrong(call, 0, "a list of numbers, or of vectors of one size", result);
            return;
        }
        for (unsigned k = 0; k < width; k++) total.as.v[k] = join(total.as.v[k], item.as.v[k]);
    }
    *result = total;
    builtin_finite(call, result);
}

static double add(double a, double b)
{
    return a + b;
}
static double multiply(double a, double b)
{
    return a * b;
}

void run_sum(const BuiltinCall *call, Value *result)
{
    fold(call, add, 0, result);
}

void run_product(const BuiltinCall *call, Value *result)
{
    fold(call, multiply, 1, result);
}

/* ---- order ---- */

/* The elements of a list in an array of their own; NULL after a report. */
static Value *elements(const BuiltinCall *call, size_t n)
{
    if (!eval_reserve(call->evaluator, (double)n * (3 * sizeof(Value)), call->expr->span)) return NULL;
    Value *items = ARENA_ARRAY(call->evaluator->arena, Value, n);
    for (size_t i = 0; i < n; i++) {
        if (!eval_step(call->evaluator, call->expr->span)) return NULL;
        items[i] = value_element(&call->args[0], i);
    }
    return items;
}

static Value list_of(const BuiltinCall *call, const Value *items, size_t n)
{
    ListBuilder builder = {.arena = call->evaluator->arena};
    for (size_t i = 0; i < n; i++) list_builder_add(&builder, &items[i]);
    return list_builder_finish(&builder);
}

/* -0 before 0, so that equal lists are sorted alike by any qsort. */
static int compare_numbers(const void *a, const void *b)
{
    double x = ((const Value *)a)->as.number, y = ((const Value *)b)->as.number;
    if (x != y) return x < y ? -1 : 1;
    return (signbit(x) == 0) - (signbit(y) == 0);
}

static int compare_texts(const void *a, const void *b)
{
    return strcmp(((const Value *)a)->as.text, ((const Value *)b)->as.text);
}

/* What '<' compares: numbers with numbers, texts with texts. */
static bool can_be_sorted(const BuiltinCall *call, const Value *items, size_t n, Value *result)
{
    for (size_t i = 0; i < n; i++) {
        bool fine = items[i].kind == items[0].kind && (items[i].kind == VALUE_NUMBER || items[i].kind == VALUE_STRING);
        if (fine) continue;
        *result = value_poison();
        if (items[i].kind == VALUE_POISON) return false;
        eval_error(call->evaluator, call->expr->as.call.args.items[0].value, D_WRONG_TYPE,
                   "'sort' takes a list of numbers alone, or of strings alone, but element %zu is %s", i,
                   value_describe(call->evaluator->arena, &items[i]));
        return false;
    }
    return true;
}

void run_sort(const BuiltinCall *call, Value *result)
{
    if (!is_list(call, result)) return;
    size_t n = value_count(&call->args[0]);
    Value *items = elements(call, n);
    *result = value_poison();
    if (!items || !can_be_sorted(call, items, n, result)) return;
    if (n) qsort(items, n, sizeof *items, items[0].kind == VALUE_NUMBER ? compare_numbers : compare_texts);
    *result = list_of(call, items, n);
}

void run_reverse(const BuiltinCall *call, Value *result)
{
    if (!is_list(call, result)) return;
    size_t n = value_count(&call->args[0]);
    Value *items = elements(call, n);
    *result = value_poison();
    if (!items) return;
    for (size_t i = 0; i < n / 2; i++) {
        Value item = items[i];
        items[i] = items[n - 1 - i];
        items[n - 1 - i] = item;
    }
    *result = list_of(call, items, n);
}

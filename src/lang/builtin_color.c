/* builtin_color.c - the functions of the language that make colours.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "lang/builtin_run.h"
#include "lang/resolve.h"

static Value color_of_screen(const BuiltinCall *call, double v[3])
{
    for (int i = 0; i < 3; i++) v[i] = srgb_decode(v[i]);
    color_from_srgb(call->evaluator->srgb_to_working, v);
    return value_color(v[0], v[1], v[2]);
}

void run_rgb(const BuiltinCall *call, Value *result)
{
    double v[4];
    if (builtin_fill(call, 3, v, result)) *result = value_color(v[0], v[1], v[2]);
}

void run_srgb(const BuiltinCall *call, Value *result)
{
    double v[4];
    if (builtin_fill(call, 3, v, result)) *result = color_of_screen(call, v);
}

/* A hue, and two numbers from 0 to 1. What is beyond is most likely meant in per cent. */
static bool fits(const BuiltinCall *call, const char *last, Value *result)
{
    if (!builtin_numbers(call, result)) return false;
    for (uint32_t i = 1; i < 3; i++) {
        double part = call->args[i].as.number;
        if (part >= 0 && part <= 1) continue;
        Diagnostic *report = eval_error(call->evaluator, call->expr->as.call.args.items[i].value, D_VALUE_OUT_OF_RANGE,
                                        "the %s %g of '%s' is outside 0..1", i == 1 ? "saturation" : last, part,
                                        call->expr->as.call.name);
        if (part > 1 && part <= 100)
            diag_hint(call->evaluator->diag, report, "of %g per cent write: %g", part, part / 100);
        *result = value_poison();
        return false;
    }
    return true;
}

/* Red, green and blue rise and fall along straight lines with the hue, 120 degrees apart: each is `most` over a third of
 * the circle, and less by `chroma` over another. */
static Value color_of_hue(const BuiltinCall *call, double most, double chroma)
{
    static const double turned[3] = {5, 3, 1};
    double v[3];
    for (int i = 0; i < 3; i++) {
        double sixth = turned[i] + call->args[0].as.number / 60, k = sixth - 6 * floor(sixth / 6);
        v[i] = most - chroma * fmax(fmin(fmin(k, 4 - k), 1), 0);
    }
    return color_of_screen(call, v);
}

void run_hsv(const BuiltinCall *call, Value *result)
{
    if (!fits(call, "value", result)) return;
    double s = call->args[1].as.number, v = call->args[2].as.number;
    *result = color_of_hue(call, v, v * s);
}

void run_hsl(const BuiltinCall *call, Value *result)
{
    if (!fits(call, "lightness", result)) return;
    double s = call->args[1].as.number, l = call->args[2].as.number, half = s * fmin(l, 1 - l);
    *result = color_of_hue(call, l + half, 2 * half);
}

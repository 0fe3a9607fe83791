/* builtin.c - the functions of the language on numbers, vectors and texts.
 * Angles are degrees. rnd and noise hold no state and are specified bit for bit in terms of base/hash.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/builtin.h"

#include <math.h>
#include <string.h>

#include "base/angle.h"
#include "base/hash.h"
#include "base/noise.h"
#include "base/utf8.h"
#include "lang/builtin_run.h"

/* ---- numbers ---- */

static double radians(double degrees)
{
    return degrees * MEN_DEGREE;
}
static double degrees(double angle)
{
    return angle * (180 / MEN_PI);
}

/* Reduced in degrees, where it is exact, so that sin(180) is 0 and sin(30) is as good as sin(390). */
static double unary_sin(double x)
{
    double angle = fmod(x, 360);
    if (angle < 0) angle += 360;
    double sign = angle >= 180 ? -1 : 1;
    if (angle >= 180) angle -= 180;
    if (angle > 90) angle = 180 - angle;
    if (angle == 0) return 0;
    if (angle == 30) return sign * 0.5;
    if (angle == 90) return sign;
    return sign * (angle > 45 ? cos(radians(90 - angle)) : sin(radians(angle)));
}

static double unary_cos(double x)
{
    return unary_sin(fmod(x, 360) + 90);
}
static double unary_tan(double x)
{
    double c = unary_cos(x);
    return c == 0 ? (double)NAN : unary_sin(x) / c;
}
static double unary_asin(double x)
{
    return degrees(asin(x));
}
static double unary_acos(double x)
{
    return degrees(acos(x));
}
static double unary_atan(double x)
{
    return degrees(atan(x));
}
static double unary_sqrt(double x)
{
    return sqrt(x);
}
static double unary_abs(double x)
{
    return fabs(x);
}
static double unary_floor(double x)
{
    return floor(x);
}
static double unary_ceil(double x)
{
    return ceil(x);
}
static double unary_round(double x)
{
    return round(x);
}
static double unary_frac(double x)
{
    return x - floor(x);
}
static double unary_sign(double x)
{
    return (x > 0) - (x < 0);
}
static double unary_exp(double x)
{
    return exp(x);
}
static double unary_log(double x)
{
    return log(x);
}
static double unary_log10(double x)
{
    return log10(x);
}

/* ---- arguments ---- */

/* What was meant, where a list stands for a vector, a vector for a list, or a list for each of its elements. */
static void hint_at_brackets(const BuiltinCall *call, const Value *given, const char *wanted, Diagnostic *report)
{
    Diag *diag = call->evaluator->diag;
    const char *name = call->expr->as.call.name;
    bool is_list = given->kind == VALUE_LIST, is_text = given->kind == VALUE_STRING;
    if ((is_list || is_text) && strcmp(name, "length") == 0)
        diag_hint(diag, report, "len() is how many elements a list has, or characters a text");
    else if (is_list && strncmp(wanted, "a number", strlen("a number")) == 0 && strcmp(name, "scale") != 0)
        diag_hint(diag, report, "of each element of a list: [for (v in list) %s(v)]", name);
    else if (is_list && strstr(wanted, "vector"))
        diag_hint(diag, report, "a vector stands between '<' and '>': <1, 2, 3>");
    else if (given->kind >= VALUE_VECTOR2 && given->kind <= VALUE_VECTOR4 &&
             strncmp(wanted, "a list", strlen("a list")) == 0)
        diag_hint(diag, report, "a list stands between '[' and ']': [1, 2, 3]; parts of a vector are v.x, v.y and v.z");
}

/* Nodes are mixed by what they are made of. */
static void hint_at_mixed_node(const BuiltinCall *call, const Value *given, Diagnostic *report)
{
    if (given->kind != VALUE_NODE || strcmp(call->expr->as.call.name, "mix") != 0) return;
    Diag *diag = call->evaluator->diag;
    const char *type = given->as.node->type->name;
    if (strcmp(type, "surface") == 0) diag_hint(diag, report, "write: surface { mix = [a, b]  weight = .5 }");
    if (strcmp(type, "medium") == 0)
        diag_hint(diag, report, "write: medium { ior = mix(1.33, 1.5, .5) }, and so on for its other properties");
}

/* The axis that stands behind a number, as in rotate(90, x); where there is none, y. */
static const char *axis_behind(const BuiltinCall *call, uint32_t index)
{
    static const char *const names[] = {"x", "y", "z"};
    if (index + 1 >= call->n || call->args[index + 1].kind != VALUE_VECTOR3) return "y";
    const double *v = call->args[index + 1].as.v;
    for (int axis = 0; axis < 3; axis++)
        if (v[axis] == 1 && v[(axis + 1) % 3] == 0 && v[(axis + 2) % 3] == 0) return names[axis];
    return "y";
}

void builtin_wrong(const BuiltinCall *call, uint32_t index, const char *wanted, Value *result)
{
    const Args *args = &call->expr->as.call.args;
    Expr *expr = index < args->n ? args->items[index].value : call->expr;
    Diagnostic *report =
        eval_error(call->evaluator, expr, D_WRONG_TYPE, "'%s' takes %s, not %s", call->expr->as.call.name, wanted,
                   value_describe(call->evaluator->arena, &call->args[index]));
    bool number = call->args[index].kind == VALUE_NUMBER && strstr(wanted, "vector of 3");
    bool turns = strcmp(call->expr->as.call.name, "rotate") == 0,
         moves = strcmp(call->expr->as.call.name, "translate") == 0;
    const bool knows = number && !eval_hint_at_axis(call->evaluator, report, expr);
    if (knows && turns)
        diag_hint(call->evaluator->diag, report, "write: rotate(%s, %g)", axis_behind(call, index),
                  call->args[index].as.number);
    else if (knows && moves)
        diag_hint(call->evaluator->diag, report, "write: translate(<%g, 0, 0>)", call->args[index].as.number);
    else if (!number)
        hint_at_brackets(call, &call->args[index], wanted, report);
    hint_at_mixed_node(call, &call->args[index], report);
    result->kind = VALUE_POISON;
}

bool builtin_numbers(const BuiltinCall *call, Value *result)
{
    for (uint32_t i = 0; i < call->n; i++)
        if (call->args[i].kind != VALUE_NUMBER) {
            builtin_wrong(call, i, call->n == 1 ? "a number" : "numbers", result);
            return false;
        }
    return true;
}

bool builtin_finite(const BuiltinCall *call, Value *result)
{
    if (value_is_finite(result)) return true;
    eval_error(call->evaluator, call->expr, D_BAD_NUMBER, "the result of '%s' is not finite", call->expr->as.call.name);
    result->kind = VALUE_POISON;
    return false;
}

static void run_unary(const BuiltinCall *call, Value *result)
{
    const Builtin *builtin = call->expr->as.call.to.builtin;
    unsigned width = value_width(call->args[0].kind);
    if (width == 0) {
        builtin_wrong(call, 0, "a number, a vector or a colour", result);
        return;
    }
    *result = call->args[0];
    for (unsigned i = 0; i < width; i++) result->as.v[i] = builtin->unary(result->as.v[i]);
    builtin_finite(call, result);
}

static void run_atan2(const BuiltinCall *call, Value *result)
{
    if (builtin_numbers(call, result))
        *result = value_number(degrees(atan2(call->args[0].as.number, call->args[1].as.number)));
}

static void run_pow(const BuiltinCall *call, Value *result)
{
    if (!builtin_numbers(call, result)) return;
    *result = value_number(pow(call->args[0].as.number, call->args[1].as.number));
    builtin_finite(call, result);
}

static void run_mod(const BuiltinCall *call, Value *result)
{
    if (!builtin_numbers(call, result)) return;
    double a = call->args[0].as.number, b = call->args[1].as.number, rest = fmod(a, b);
    *result = value_number(rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest);
    builtin_finite(call, result);
}

/* Arguments that go together element by element: all of one kind, or numbers beside it. */
static bool common_kind(const BuiltinCall *call, ValueKind *kind, Value *result)
{
    *kind = VALUE_NUMBER;
    for (uint32_t i = 0; i < call->n; i++) {
        ValueKind found = call->args[i].kind;
        if (value_width(found) == 0 || (found != VALUE_NUMBER && *kind != VALUE_NUMBER && found != *kind)) {
            builtin_wrong(call, i, *kind == VALUE_NUMBER ? "numbers, vectors or colours" : "values of one kind",
                          result);
            return false;
        }
        if (found != VALUE_NUMBER) *kind = found;
    }
    return true;
}

static double element(const Value *value, unsigned i)
{
    return value->as.v[value->kind == VALUE_NUMBER ? 0 : i];
}

/* min and max of one list go over its elements */
static void extreme(const BuiltinCall *call, bool largest, Value *result)
{
    const Value *list = &call->args[0];
    bool sequence = call->n == 1 && (list->kind == VALUE_LIST || list->kind == VALUE_RANGE);
    ValueKind kind = VALUE_NUMBER;
    if (!sequence && !common_kind(call, &kind, result)) return;
    size_t n = sequence ? value_count(list) : call->n;
    if (n == 0) {
        eval_error(call->evaluator, call->expr, D_BAD_INDEX, "'%s' of an empty list", call->expr->as.call.name);
        result->kind = VALUE_POISON;
        return;
    }
    Value best = {.kind = kind};
    for (size_t i = 0; i < n; i++) {
        Value value = sequence ? value_element(list, i) : call->args[i];
        if (sequence && (value.kind != VALUE_NUMBER || !eval_step(call->evaluator, call->expr->span))) {
            builtin_wrong(call, 0, "a list of numbers", result);
            return;
        }
        for (unsigned k = 0; k < value_width(kind); k++) {
            double x = element(&value, k);
            if (i == 0 || (largest ? x > best.as.v[k] : x < best.as.v[k])) best.as.v[k] = x;
        }
    }
    *result = best;
}

static void run_min(const BuiltinCall *call, Value *result)
{
    extreme(call, false, result);
}
static void run_max(const BuiltinCall *call, Value *result)
{
    extreme(call, true, result);
}

static double mix(double a, double b, double t)
{
    return t == 1 ? b : a + (b - a) * t;
}
static double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}
static double smoothstep(double a, double b, double x)
{
    double t = a == b ? (x < a ? 0 : 1) : clamp((x - a) / (b - a), 0, 1);
    return t * t * (3 - 2 * t);
}

static void map_three(const BuiltinCall *call, double (*function)(double, double, double), Value *result)
{
    ValueKind kind;
    if (!common_kind(call, &kind, result)) return;
    Value out = {.kind = kind};
    for (unsigned i = 0; i < value_width(kind); i++)
        out.as.v[i] = function(element(&call->args[0], i), element(&call->args[1], i), element(&call->args[2], i));
    *result = out;
    builtin_finite(call, result);
}

static void run_clamp(const BuiltinCall *call, Value *result)
{
    map_three(call, clamp, result);
}
static void run_mix(const BuiltinCall *call, Value *result)
{
    map_three(call, mix, result);
}
static void run_smoothstep(const BuiltinCall *call, Value *result)
{
    map_three(call, smoothstep, result);
}

/* ---- vectors ---- */

static unsigned vector_width(const Value *value)
{
    return value->kind >= VALUE_VECTOR2 && value->kind <= VALUE_VECTOR4 ? value_width(value->kind) : 0;
}

static bool vectors_of_one_size(const BuiltinCall *call, Value *result)
{
    for (uint32_t i = 0; i < call->n; i++)
        if (vector_width(&call->args[i]) == 0 || call->args[i].kind != call->args[0].kind) {
            builtin_wrong(call, i, call->n == 1 ? "a vector" : "vectors of one size", result);
            return false;
        }
    return true;
}

static double dot(const double *a, const double *b, unsigned n)
{
    double sum = 0;
    for (unsigned i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static void run_length(const BuiltinCall *call, Value *result)
{
    if (!vectors_of_one_size(call, result)) return;
    const double *v = call->args[0].as.v;
    *result = value_number(sqrt(dot(v, v, vector_width(&call->args[0]))));
}

static void run_distance(const BuiltinCall *call, Value *result)
{
    if (!vectors_of_one_size(call, result)) return;
    double sum = 0;
    for (unsigned i = 0; i < vector_width(&call->args[0]); i++) {
        double d = call->args[0].as.v[i] - call->args[1].as.v[i];
        sum += d * d;
    }
    *result = value_number(sqrt(sum));
}

static void run_normalize(const BuiltinCall *call, Value *result)
{
    if (!vectors_of_one_size(call, result)) return;
    unsigned n = vector_width(&call->args[0]);
    *result = call->args[0];
    double length = sqrt(dot(result->as.v, result->as.v, n));
    for (unsigned i = 0; i < n; i++) result->as.v[i] /= length;
    builtin_finite(call, result);
}

static void run_dot(const BuiltinCall *call, Value *result)
{
    if (vectors_of_one_size(call, result))
        *result = value_number(dot(call->args[0].as.v, call->args[1].as.v, vector_width(&call->args[0])));
}

static void run_cross(const BuiltinCall *call, Value *result)
{
    for (uint32_t i = 0; i < 2; i++)
        if (call->args[i].kind != VALUE_VECTOR3) {
            builtin_wrong(call, i, "two vectors of 3", result);
            return;
        }
    const double *a = call->args[0].as.v, *b = call->args[1].as.v;
    *result = value_vector3(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
}

bool builtin_fill(const BuiltinCall *call, unsigned width, double v[4], Value *result)
{
    unsigned n = 0;
    for (uint32_t i = 0; i < call->n; i++) {
        unsigned more = value_width(call->args[i].kind);
        if (more == 0 || n + more > width) {
            builtin_wrong(call, i, arena_format(call->evaluator->arena, "%u numbers", width), result);
            return false;
        }
        memcpy(v + n, call->args[i].as.v, more * sizeof(double));
        n += more;
    }
    if (n == 1)
        for (; n < width; n++) v[n] = v[0];
    if (n == width) return true;
    eval_error(call->evaluator, call->expr, D_MISSING_ARGUMENT, "'%s' takes %u numbers, not %u",
               call->expr->as.call.name, width, n);
    result->kind = VALUE_POISON;
    return false;
}

static void make_vector(const BuiltinCall *call, unsigned width, Value *result)
{
    Value out = {.kind = value_vector_kind(width)};
    if (builtin_fill(call, width, out.as.v, result)) *result = out;
}

static void run_vec2(const BuiltinCall *call, Value *result)
{
    make_vector(call, 2, result);
}
static void run_vec3(const BuiltinCall *call, Value *result)
{
    make_vector(call, 3, result);
}
static void run_vec4(const BuiltinCall *call, Value *result)
{
    make_vector(call, 4, result);
}

/* ---- random numbers ---- */

/* "meniscus" in ASCII: not the start of noise(), so that they share no values */
const uint64_t builtin_rnd_start = 0x6d656e6973637573U;

static uint64_t bits_of(double x)
{
    uint64_t bits;
    x += 0.0; /* -0 is 0 */
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

bool builtin_hash(const BuiltinCall *call, uint32_t first, uint64_t *h, Value *result)
{
    for (uint32_t i = first; i < call->n; i++) {
        unsigned width = value_width(call->args[i].kind);
        if (width == 0) {
            builtin_wrong(call, i, "numbers", result);
            return false;
        }
        for (unsigned k = 0; k < width; k++) *h = hash_u64(*h ^ bits_of(call->args[i].as.v[k]));
    }
    return true;
}

static void run_rnd(const BuiltinCall *call, Value *result)
{
    uint64_t h = builtin_rnd_start;
    if (builtin_hash(call, 0, &h, result)) *result = value_number(hash_to_unit(h));
}

static void run_noise(const BuiltinCall *call, Value *result)
{
    double point[4];
    unsigned n = 0;
    for (uint32_t i = 0; i < call->n; i++) {
        unsigned width = value_width(call->args[i].kind);
        if (width == 0 || n + width > 3) {
            builtin_wrong(call, i, i ? "3 numbers at most, a vector being as many" : "1 to 3 numbers, or a vector",
                          result);
            return;
        }
        for (unsigned k = 0; k < width; k++) point[n++] = call->args[i].as.v[k];
    }
    for (unsigned i = 0; i < n; i++)
        if (!(fabs(point[i]) < NOISE_LARGEST_COORDINATE)) {
            eval_error(call->evaluator, call->expr, D_BAD_NUMBER, "noise at %g has no meaning", point[i]);
            result->kind = VALUE_POISON;
            return;
        }
    *result = value_number(noise_value(point, n));
}

/* ---- lists and texts ---- */

static void run_len(const BuiltinCall *call, Value *result)
{
    const Value *value = &call->args[0];
    size_t n = value_count(value);
    if (value->kind == VALUE_STRING) {
        size_t length = strlen(value->as.text);
        uint32_t code;
        for (size_t at = 0; at < length; n++) at += utf8_decode(value->as.text + at, length - at, &code);
    } else if (vector_width(value)) {
        n = vector_width(value);
    } else if (value->kind != VALUE_LIST && value->kind != VALUE_RANGE) {
        builtin_wrong(call, 0, "a list, a range, a vector or a string", result);
        return;
    }
    *result = value_number((double)n);
}

static void join(const BuiltinCall *call, uint32_t first, Buf *out)
{
    for (uint32_t i = first; i < call->n; i++) value_print(out, &call->args[i], VALUE_ROUNDED);
}

static const char *joined(const BuiltinCall *call, uint32_t first)
{
    Buf text = {0};
    join(call, first, &text);
    const char *copy = arena_copy_text(call->evaluator->arena, buf_text(&text), text.length);
    buf_clear(&text);
    return copy;
}

static void run_str(const BuiltinCall *call, Value *result)
{
    *result = value_text(joined(call, 0));
    if (!eval_text_fits(call->evaluator, strlen(result->as.text), call->expr->span)) result->kind = VALUE_POISON;
}

static void run_print(const BuiltinCall *call, Value *result)
{
    join(call, 0, &call->evaluator->printed);
    buf_add(&call->evaluator->printed, "\n");
    if (call->evaluator->printed.length > LIMIT_PRINTED_BYTES) {
        Diagnostic *report = eval_report(call->evaluator, D_LIMIT, call->expr->span,
                                         "the scene prints more than %d bytes", LIMIT_PRINTED_BYTES);
        limit_hint(call->evaluator->diag, report, OVER_PRINTED_BYTES);
        call->evaluator->stop = true;
    }
    result->kind = VALUE_NONE;
}

static void run_warn(const BuiltinCall *call, Value *result)
{
    eval_report(call->evaluator, D_SCENE_WARNING, call->expr->span, "%s", joined(call, 0));
    result->kind = VALUE_NONE;
}

static void run_assert(const BuiltinCall *call, Value *result)
{
    if (call->args[0].kind != VALUE_BOOL) {
        builtin_wrong(call, 0, "a condition first", result);
        return;
    }
    if (!call->args[0].as.truth)
        eval_report(call->evaluator, D_ASSERTION, call->expr->span, "%s",
                    call->n > 1 ? joined(call, 1) : "this does not hold");
    result->kind = VALUE_NONE;
}

/* ---- the table ---- */

static const Builtin builtin_table[] = {
#define UNARY(name, shape, doc) {#name, 1, 1, false, unary_##name, PROGRAM_SHAPE_##shape, run_unary, doc},
#define VALUE(name, min, max, doc) {#name, min, max, false, NULL, PROGRAM_SHAPE_UNKNOWN, run_##name, doc},
#define STATEMENT(name, min, max, doc) {#name, min, max, true, NULL, PROGRAM_SHAPE_UNKNOWN, run_##name, doc},
#include "lang/funcs.def"
#undef UNARY
#undef VALUE
#undef STATEMENT
};

size_t builtin_count(void)
{
    return COUNT_OF(builtin_table);
}
const Builtin *builtin_at(size_t index)
{
    return &builtin_table[index];
}

const Builtin *builtin_find(const char *name)
{
    for (size_t i = 0; i < COUNT_OF(builtin_table); i++)
        if (strcmp(builtin_table[i].name, name) == 0) return &builtin_table[i];
    return NULL;
}

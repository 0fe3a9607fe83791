/* formula_builtins.c - the language's functions within functions that are compiled, and numbering the registers.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "lang/builtin_run.h"
#include "lang/formula_parts.h"
#include "lang/resolve.h"

/* One call with arguments of which some depend on the place. */
typedef struct Call {
    Compiler *c;
    const Expr *expr;
    const Builtin *builtin;
    const Form *args;
    uint32_t n;
} Call;

static Form wrong(const Call *call, uint32_t i, const char *wanted)
{
    if (!call->c->failed)
        eval_report(call->c->evaluator, D_WRONG_TYPE, call->expr->as.call.args.items[i].value->span,
                    "'%s' takes %s, not %s", call->builtin->name, wanted, form_describe(&call->args[i]));
    return form_failed(call->c);
}

static uint16_t at(const Call *call, const Form *form, unsigned i)
{
    return form_register(call->c, call->expr, form, i);
}

static uint16_t step(const Call *call, ProgramOp op, uint16_t a, uint16_t b, uint16_t third)
{
    return formula_step(call->c, call->expr, op, a, b, third);
}

static uint16_t constant(const Call *call, double x)
{
    return formula_constant(call->c, call->expr, x);
}

static unsigned width_of(const Form *form)
{
    return form->list ? 0 : value_width(form->kind);
}

static bool is_vector(const Form *form)
{
    return !form->list && form->kind >= VALUE_VECTOR2 && form->kind <= VALUE_VECTOR4;
}

static double square_root(double x)
{
    return sqrt(x);
}

static uint16_t root(const Call *call, uint16_t x)
{
    return formula_unary(call->c, call->expr, square_root, PROGRAM_SHAPE_RISES, x);
}

static Form unary(const Call *call)
{
    Form result = call->args[0];
    if (width_of(&result) == 0) return wrong(call, 0, "a number, a vector or a colour");
    for (unsigned i = 0; i < width_of(&call->args[0]); i++)
        result.at[i] =
            formula_unary(call->c, call->expr, call->builtin->unary, call->builtin->shape, at(call, &call->args[0], i));
    return result;
}

/* ---- element by element ---- */

static bool common_kind(const Call *call, ValueKind *kind)
{
    *kind = VALUE_NUMBER;
    for (uint32_t i = 0; i < call->n; i++) {
        ValueKind found = call->args[i].kind;
        if (width_of(&call->args[i]) == 0 || (found != VALUE_NUMBER && *kind != VALUE_NUMBER && found != *kind)) {
            (void)wrong(call, i, *kind == VALUE_NUMBER ? "numbers, vectors or colours" : "values of one kind");
            return false;
        }
        if (found != VALUE_NUMBER) *kind = found;
    }
    return true;
}

/* x, but not beyond low and high */
static uint16_t clamped(const Call *call, uint16_t x, uint16_t low, uint16_t high)
{
    uint16_t above = step(call, PROGRAM_SELECT, step(call, PROGRAM_LESS, high, x, 0), high, x);
    return step(call, PROGRAM_SELECT, step(call, PROGRAM_LESS, x, low, 0), low, above);
}

static Form three(const Call *call)
{
    Form result = {.known = false};
    if (!common_kind(call, &result.kind)) return form_failed(call->c);
    for (unsigned i = 0; i < value_width(result.kind); i++) {
        uint16_t a = at(call, &call->args[0], i), b = at(call, &call->args[1], i), third = at(call, &call->args[2], i);
        result.at[i] = strcmp(call->builtin->name, "clamp") == 0 ? clamped(call, a, b, third)
                       : strcmp(call->builtin->name, "mix") == 0 ? step(call, PROGRAM_MIX, a, b, third)
                                                                 : step(call, PROGRAM_SMOOTH, a, b, third);
    }
    return result;
}

static Form extreme(const Call *call)
{
    ProgramOp op = strcmp(call->builtin->name, "min") == 0 ? PROGRAM_SMALLER : PROGRAM_LARGER;
    Call over = *call;
    if (call->n == 1 && call->args[0].list) {
        over.args = call->args[0].list->items;
        over.n = (uint32_t)call->args[0].list->n;
        for (uint32_t i = 0; i < over.n; i++)
            if (over.args[i].kind != VALUE_NUMBER) return wrong(call, 0, "a list of numbers");
    }
    Form result = {.kind = VALUE_NUMBER};
    if (over.args == call->args && !common_kind(call, &result.kind)) return form_failed(call->c);
    for (unsigned k = 0; k < value_width(result.kind); k++) {
        result.at[k] = at(call, &over.args[0], k);
        for (uint32_t i = 1; i < over.n; i++)
            result.at[k] = step(call, op, result.at[k], at(call, &over.args[i], k), 0);
    }
    return result;
}

static Form two_numbers(const Call *call)
{
    for (uint32_t i = 0; i < call->n; i++)
        if (call->args[i].kind != VALUE_NUMBER) return wrong(call, i, "numbers");
    ProgramOp op = strcmp(call->builtin->name, "atan2") == 0 ? PROGRAM_ATAN2
                   : strcmp(call->builtin->name, "pow") == 0 ? PROGRAM_POWER
                                                             : PROGRAM_MODULO;
    uint16_t a = at(call, &call->args[0], 0), b = at(call, &call->args[1], 0);
    return form_number(step(call, op, a, b, 0));
}

/* sum and product */
static Form total(const Call *call)
{
    const FormList *list = call->args[0].list;
    ProgramOp op = strcmp(call->builtin->name, "sum") == 0 ? PROGRAM_ADD : PROGRAM_MULTIPLY;
    if (!list || list->n == 0) return wrong(call, 0, "a list");
    Form result = {.kind = list->items[0].kind};
    for (unsigned k = 0; k < width_of(&list->items[0]); k++) {
        result.at[k] = at(call, &list->items[0], k);
        for (size_t i = 1; i < list->n; i++) {
            if (list->items[i].kind != result.kind)
                return wrong(call, 0, "a list of numbers, or of vectors of one size");
            result.at[k] = step(call, op, result.at[k], at(call, &list->items[i], k), 0);
        }
    }
    return value_width(result.kind) ? result : wrong(call, 0, "a list of numbers, or of vectors of one size");
}

static Form reversed(const Call *call)
{
    const FormList *list = call->args[0].list;
    if (!list) return wrong(call, 0, "a list");
    FormList *made = ARENA_NEW(call->c->evaluator->arena, FormList);
    *made = (FormList){list->n, ARENA_ARRAY(call->c->evaluator->arena, Form, list->n)};
    for (size_t i = 0; i < list->n; i++) made->items[i] = list->items[list->n - 1 - i];
    return (Form){.kind = VALUE_LIST, .list = made};
}

/* ---- vectors ---- */

static bool vectors(const Call *call)
{
    for (uint32_t i = 0; i < call->n; i++)
        if (!is_vector(&call->args[i]) || call->args[i].kind != call->args[0].kind) {
            (void)wrong(call, i, call->n == 1 ? "a vector" : "vectors of one size");
            return false;
        }
    return true;
}

static uint16_t dot_of(const Call *call, const uint16_t *a, const uint16_t *b, unsigned n)
{
    uint16_t result = constant(call, 0);
    for (unsigned i = 0; i < n; i++)
        result = step(call, PROGRAM_ADD, result, step(call, PROGRAM_MULTIPLY, a[i], b[i], 0), 0);
    return result;
}

static Form of_vectors(const Call *call)
{
    const char *name = call->builtin->name;
    uint16_t a[4] = {0}, b[4] = {0}, apart[4] = {0};
    if (!vectors(call)) return form_failed(call->c);
    unsigned n = width_of(&call->args[0]);
    for (unsigned i = 0; i < n; i++) {
        a[i] = at(call, &call->args[0], i);
        if (call->n > 1) b[i] = at(call, &call->args[1], i);
        if (strcmp(name, "distance") == 0) apart[i] = step(call, PROGRAM_SUBTRACT, a[i], b[i], 0);
    }
    if (strcmp(name, "dot") == 0) return form_number(dot_of(call, a, b, n));
    if (strcmp(name, "length") == 0) return form_number(root(call, dot_of(call, a, a, n)));
    if (strcmp(name, "distance") == 0) return form_number(root(call, dot_of(call, apart, apart, n)));
    Form result = {.kind = call->args[0].kind};
    if (strcmp(name, "normalize") == 0) {
        uint16_t length = root(call, dot_of(call, a, a, n));
        for (unsigned i = 0; i < n; i++) result.at[i] = step(call, PROGRAM_DIVIDE, a[i], length, 0);
        return result;
    }
    if (n != 3) return wrong(call, 0, "two vectors of 3"); /* cross */
    for (unsigned i = 0; i < 3; i++) {
        unsigned j = (i + 1) % 3, k = (i + 2) % 3;
        uint16_t first = step(call, PROGRAM_MULTIPLY, a[j], b[k], 0),
                 second = step(call, PROGRAM_MULTIPLY, a[k], b[j], 0);
        result.at[i] = step(call, PROGRAM_SUBTRACT, first, second, 0);
    }
    return result;
}

/* ---- colours ---- */

/* From values as screens show them, in registers, to the working space. */
static Form color_of_screen(const Call *call, const uint16_t screen[3])
{
    Form result = {.kind = VALUE_COLOR};
    const double *m = call->c->evaluator->srgb_to_working;
    uint16_t linear[3];
    for (int i = 0; i < 3; i++)
        linear[i] = formula_unary(call->c, call->expr, srgb_decode, PROGRAM_SHAPE_NEARLY_RISES, screen[i]);
    for (int row = 0; row < 3; row++) {
        result.at[row] = m ? constant(call, 0) : linear[row];
        for (int i = 0; m && i < 3; i++) {
            uint16_t factor = constant(call, m[3 * row + i]);
            uint16_t part = step(call, PROGRAM_MULTIPLY, factor, linear[i], 0);
            result.at[row] = step(call, PROGRAM_ADD, result.at[row], part, 0);
        }
    }
    return result;
}

/* vec2, vec3, vec4, rgb, and the values of srgb: numbers and vectors in a row, or one number */
static Form row(const Call *call)
{
    const char *name = call->builtin->name;
    bool color = strcmp(name, "rgb") == 0 || strcmp(name, "srgb") == 0;
    unsigned width = color ? 3 : (unsigned)(name[3] - '0'), n = 0;
    Form result = {.kind = color ? VALUE_COLOR : value_vector_kind(width)};
    for (uint32_t i = 0; i < call->n; i++) {
        unsigned more = width_of(&call->args[i]);
        if (more == 0 || n + more > width) return wrong(call, i, color ? "3 numbers" : "as many numbers as its size");
        for (unsigned k = 0; k < more; k++) result.at[n++] = at(call, &call->args[i], k);
    }
    if (n == 1)
        for (; n < width; n++) result.at[n] = result.at[0];
    return n == width ? result : wrong(call, 0, color ? "3 numbers" : "as many numbers as its size");
}

static Form srgb(const Call *call)
{
    Form screen = row(call);
    return call->c->failed ? screen : color_of_screen(call, screen.at);
}

/* One of red, green and blue, as builtin_color.c has it. */
static uint16_t of_hue(const Call *call, double turned, uint16_t hue, uint16_t most, uint16_t chroma)
{
    uint16_t zero = constant(call, 0), one = constant(call, 1), four = constant(call, 4), six = constant(call, 6);
    uint16_t offset = constant(call, turned), sixth = constant(call, 60);
    uint16_t turns = step(call, PROGRAM_DIVIDE, hue, sixth, 0);
    uint16_t k = step(call, PROGRAM_ADD, offset, turns, 0);
    k = step(call, PROGRAM_MODULO, k, six, 0);
    uint16_t falls = step(call, PROGRAM_SUBTRACT, four, k, 0);
    uint16_t low = step(call, PROGRAM_SMALLER, k, falls, 0);
    low = step(call, PROGRAM_SMALLER, low, one, 0);
    low = step(call, PROGRAM_LARGER, low, zero, 0);
    low = step(call, PROGRAM_MULTIPLY, chroma, low, 0);
    return step(call, PROGRAM_SUBTRACT, most, low, 0);
}

/* hsv and hsl; a saturation beyond 0 to 1, which only some places may have, counts as the nearest that there is */
static Form of_hues(const Call *call)
{
    for (uint32_t i = 0; i < call->n; i++)
        if (call->args[i].kind != VALUE_NUMBER) return wrong(call, i, "numbers");
    uint16_t zero = constant(call, 0), one = constant(call, 1), hue = at(call, &call->args[0], 0);
    uint16_t saturation = at(call, &call->args[1], 0), most = at(call, &call->args[2], 0), chroma;
    saturation = clamped(call, saturation, zero, one);
    most = clamped(call, most, zero, one);
    if (strcmp(call->builtin->name, "hsv") == 0) {
        chroma = step(call, PROGRAM_MULTIPLY, most, saturation, 0);
    } else {
        uint16_t two = constant(call, 2), rest = step(call, PROGRAM_SUBTRACT, one, most, 0);
        uint16_t half = step(call, PROGRAM_SMALLER, most, rest, 0);
        half = step(call, PROGRAM_MULTIPLY, saturation, half, 0);
        most = step(call, PROGRAM_ADD, most, half, 0);
        chroma = step(call, PROGRAM_MULTIPLY, two, half, 0);
    }
    uint16_t screen[3];
    for (int i = 0; i < 3; i++) screen[i] = of_hue(call, 5 - 2 * i, hue, most, chroma);
    return color_of_screen(call, screen);
}

/* ---- random numbers ---- */

static Form noise(const Call *call)
{
    static const ProgramOp ops[] = {PROGRAM_NOISE1, PROGRAM_NOISE2, PROGRAM_NOISE3};
    uint16_t point[3] = {0, 0, 0};
    unsigned n = 0;
    for (uint32_t i = 0; i < call->n; i++) {
        unsigned width = width_of(&call->args[i]);
        if (width == 0 || n + width > 3)
            return wrong(call, i, i ? "3 numbers at most, a vector being as many" : "1 to 3 numbers, or a vector");
        for (unsigned k = 0; k < width; k++) point[n++] = at(call, &call->args[i], k);
    }
    return form_number(step(call, ops[n - 1], point[0], point[1], point[2]));
}

static Form rnd(const Call *call)
{
    double start;
    memcpy(&start, &builtin_rnd_start, sizeof start);
    uint16_t state = constant(call, start);
    for (uint32_t i = 0; i < call->n; i++) {
        unsigned width = width_of(&call->args[i]);
        if (width == 0) return wrong(call, i, "numbers");
        for (unsigned k = 0; k < width; k++) state = step(call, PROGRAM_HASH, state, at(call, &call->args[i], k), 0);
    }
    return form_number(step(call, PROGRAM_UNIT, state, 0, 0));
}

static const struct {
    const char *name;
    Form (*make)(const Call *call);
} makers[] = {
    {"atan2", two_numbers},
    {"pow", two_numbers},
    {"mod", two_numbers},
    {"min", extreme},
    {"max", extreme},
    {"clamp", three},
    {"mix", three},
    {"smoothstep", three},
    {"length", of_vectors},
    {"distance", of_vectors},
    {"normalize", of_vectors},
    {"dot", of_vectors},
    {"cross", of_vectors},
    {"sum", total},
    {"product", total},
    {"reverse", reversed},
    {"vec2", row},
    {"vec3", row},
    {"vec4", row},
    {"rgb", row},
    {"srgb", srgb},
    {"hsv", of_hues},
    {"hsl", of_hues},
    {"rnd", rnd},
    {"noise", noise},
};

Form form_of_builtin(Compiler *c, Expr *expr)
{
    const Args *args = &expr->as.call.args;
    const Builtin *builtin = expr->as.call.to.builtin;
    Form forms[LIMIT_ARGUMENTS];
    Value values[LIMIT_ARGUMENTS];
    bool known = true;
    for (uint32_t i = 0; i < args->n; i++) {
        forms[i] = formula_expr(c, args->items[i].value);
        if (c->failed) return form_failed(c);
        known = known && forms[i].known;
        values[i] = forms[i].value;
    }
    if (known && !builtin->is_statement) {
        Value result;
        builtin->run(&(BuiltinCall){c->evaluator, expr, values, args->n}, &result);
        return result.kind == VALUE_POISON ? form_failed(c) : form_known(&result);
    }
    Call call = {c, expr, builtin, forms, args->n};
    if (builtin->unary) return unary(&call);
    for (size_t i = 0; i < COUNT_OF(makers); i++)
        if (strcmp(makers[i].name, builtin->name) == 0) return makers[i].make(&call);
    return form_refused(c, expr, arena_format(c->evaluator->arena, "'%s'", builtin->name));
}

/* ---- numbering ---- */

static uint16_t packed(const Compiler *c, uint16_t number)
{
    if (number >= FORMULA_CONSTANTS) return (uint16_t)(PROGRAM_INPUTS + (number - FORMULA_CONSTANTS));
    return number < PROGRAM_INPUTS ? number : (uint16_t)(number + c->n_constants);
}

bool formula_pack(const Compiler *c, Program *program, Arena *arena)
{
    if (c->n_registers + c->n_constants > PROGRAM_MOST_REGISTERS) return false;
    ProgramStep *steps = ARENA_ARRAY(arena, ProgramStep, c->n_steps + 1);
    double *constants = ARENA_ARRAY(arena, double, c->n_constants + 1);
    for (uint32_t i = 0; i < c->n_steps; i++) {
        steps[i] = c->steps[i];
        steps[i].to = packed(c, steps[i].to);
        steps[i].a = packed(c, steps[i].a);
        steps[i].b = packed(c, steps[i].b);
        steps[i].c = packed(c, steps[i].c);
    }
    if (c->n_constants) memcpy(constants, c->constants, c->n_constants * sizeof *constants);
    program->steps = steps;
    program->constants = constants;
    program->n_steps = c->n_steps;
    program->n_constants = c->n_constants;
    program->n_registers = c->n_registers + c->n_constants;
    for (uint32_t i = 0; i < program->n_outputs; i++) program->outputs[i] = packed(c, program->outputs[i]);
    return true;
}

/* program_bounds.c - what a program gives over a box of inputs, by interval arithmetic (R. E. Moore, "Interval Analysis",
 * 1966). The bounds are of the numbers that program_run() computes, and rounding is monotone: where an operation is rounded
 * once, the rounded ends bound the rounded values, and nothing needs to be added. What is computed in several operations, or
 * by the library of the system, gets a margin that is far beyond its rounding.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/noise.h"
#include "base/program.h"

typedef ProgramRange Range;

static const double margin = 1e-14; /* some 50 units in the last place */

static const Range anything = {-HUGE_VAL, HUGE_VAL}, truth = {0, 1};

bool program_range_is_known(ProgramRange range)
{
    return range.low > -HUGE_VAL && range.high < HUGE_VAL;
}

static bool is_point(Range range)
{
    return range.low == range.high;
}

/* Anything, where an end is no finite number. */
static Range between(double low, double high)
{
    return low > -HUGE_VAL && high < HUGE_VAL && low <= high ? (Range){low, high} : anything;
}

static Range widened(Range range, double by)
{
    const double tiny = 1e-300; /* relative margins vanish at 0 */
    return between(range.low - (margin * fabs(range.low) + by + tiny),
                   range.high + (margin * fabs(range.high) + by + tiny));
}

static Range both(Range a, Range b)
{
    return between(fmin(a.low, b.low), fmax(a.high, b.high));
}

static double largest(Range range)
{
    return fmax(-range.low, range.high);
}

static double value_at(const ProgramStep *step, double a, double b, double c)
{
    const ProgramStep alone = {.op = step->op, .to = PROGRAM_INPUTS, .a = 0, .b = 1, .c = 2, .unary = step->unary};
    const Program program = {
        .steps = &alone, .n_steps = 1, .n_registers = PROGRAM_INPUTS + 1, .n_outputs = 1, .outputs = {PROGRAM_INPUTS}};
    const double inputs[PROGRAM_INPUTS] = {a, b, c};
    double value;
    program_run(&program, inputs, &value);
    return value;
}

/* Of what has its extremes where each operand is at an end. */
static Range at_corners(const ProgramStep *step, Range a, Range b, Range c)
{
    Range range = {HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < 8; k++) {
        if ((k & 1 && is_point(a)) || (k & 2 && is_point(b)) || (k & 4 && is_point(c))) continue;
        double value = value_at(step, k & 1 ? a.high : a.low, k & 2 ? b.high : b.low, k & 4 ? c.high : c.low);
        if (!isfinite(value)) return anything;
        range.low = fmin(range.low, value);
        range.high = fmax(range.high, value);
    }
    return range;
}

/* ---- truth: 0 and 1 ---- */

static bool surely(Range a)
{
    return program_range_is_known(a) && (a.low > 0 || a.high < 0);
}

static bool never(Range a)
{
    return a.low == 0 && a.high == 0;
}

static Range truth_of(bool yes, bool no)
{
    return yes ? (Range){1, 1} : no ? (Range){0, 0} : truth;
}

static Range compare(ProgramOp op, Range a, Range b)
{
    if (!program_range_is_known(a) || !program_range_is_known(b)) return truth;
    if (op == PROGRAM_LESS) return truth_of(a.high < b.low, a.low >= b.high);
    if (op == PROGRAM_LESS_EQUAL) return truth_of(a.high <= b.low, a.low > b.high);
    return truth_of(is_point(a) && is_point(b) && a.low == b.low, a.high < b.low || b.high < a.low);
}

/* What wrote a register; NULL: it is an input or a constant. */
static const ProgramStep *writer_of(const Program *program, uint16_t number)
{
    uint32_t first = PROGRAM_INPUTS + program->n_constants;
    if (number < first || number - first >= program->n_steps) return NULL;
    const ProgramStep *step = &program->steps[number - first];
    return step->to == number ? step : NULL;
}

static Range common(Range a, Range b)
{
    return (Range){fmax(a.low, b.low), fmin(a.high, b.high)};
}

/* A register where another is known to be within a range: the same, or a choice of which it is a side. */
static Range given(const Program *program, const Range *r, uint16_t number, uint16_t other, Range range)
{
    const ProgramStep *choice = writer_of(program, number);
    if (number == other) return common(r[number], range);
    if (!choice || choice->op != PROGRAM_SELECT) return r[number];
    Range yes = choice->b == other ? common(r[other], range) : r[choice->b];
    Range no = choice->c == other ? common(r[other], range) : r[choice->c];
    return common(r[number], both(yes, no));
}

/* Where a comparison chooses between numbers that it compares, as to clamp them, each bounds the other. */
static Range side_of_choice(const Program *program, const Range *r, uint16_t condition, bool holds, uint16_t number)
{
    const ProgramStep *test = writer_of(program, condition);
    if (!test || (test->op != PROGRAM_LESS && test->op != PROGRAM_LESS_EQUAL)) return r[number];
    Range a = r[test->a], b = r[test->b];
    if (!program_range_is_known(a) || !program_range_is_known(b)) return r[number];
    Range of_a = holds ? (Range){-HUGE_VAL, b.high} : (Range){b.low, HUGE_VAL};
    Range of_b = holds ? (Range){a.low, HUGE_VAL} : (Range){-HUGE_VAL, a.high};
    return common(given(program, r, number, test->a, of_a), given(program, r, number, test->b, of_b));
}

static Range choose(const Program *program, const Range *r, const ProgramStep *step)
{
    if (surely(r[step->a])) return r[step->b];
    if (never(r[step->a])) return r[step->c];
    return both(side_of_choice(program, r, step->a, true, step->b),
                side_of_choice(program, r, step->a, false, step->c));
}

/* ---- arithmetic ---- */

static Range multiply(Range a, Range b)
{
    double w = a.low * b.low, x = a.low * b.high, y = a.high * b.low, z = a.high * b.high;
    return between(fmin(fmin(w, x), fmin(y, z)), fmax(fmax(w, x), fmax(y, z)));
}

static Range square(Range a)
{
    double x = a.low * a.low, y = a.high * a.high;
    return between(a.low < 0 && a.high > 0 ? 0 : fmin(x, y), fmax(x, y));
}

static Range divide(Range a, Range b)
{
    if (b.low <= 0 && b.high >= 0) return anything;
    double w = a.low / b.low, x = a.low / b.high, y = a.high / b.low, z = a.high / b.high;
    return between(fmin(fmin(w, x), fmin(y, z)), fmax(fmax(w, x), fmax(y, z)));
}

static Range modulo(const ProgramStep *step, Range a, Range b)
{
    if (b.low <= 0 && b.high >= 0) return anything;
    Range all = {fmin(b.low, 0), fmax(b.high, 0)};
    if (!is_point(b) || !(a.high - a.low < 0.9 * fabs(b.low))) return all;
    double first = value_at(step, a.low, b.low, 0), last = value_at(step, a.high, b.low, 0);
    return first <= last ? (Range){first, last} : all; /* less than a period: rising, unless it begins anew */
}

static Range power(const ProgramStep *step, Range a, Range b, Range zero)
{
    if (a.low >= 0) return widened(at_corners(step, a, b, zero), 0);
    if (!is_point(b) || b.low != floor(b.low)) return anything;
    if (b.low < 0 && a.high >= 0) return anything;
    bool even = fmod(b.low, 2) == 0;
    Range range = at_corners(step, a, b, zero);
    if (even && a.high > 0) range.low = b.low == 0 ? 1 : 0;
    return widened(range, 0);
}

/* The angle of a box is that of its corners, unless it has the middle in it, or where angles begin anew. */
static Range angle(const ProgramStep *step, Range y, Range x, Range zero)
{
    if (y.low <= 0 && y.high >= 0 && x.low <= 0) return (Range){-180 - 1e-9, 180 + 1e-9};
    return widened(at_corners(step, y, x, zero), 0);
}

static Range mix(const ProgramStep *step, Range a, Range b, Range c)
{
    return widened(at_corners(step, a, b, c), margin * (largest(a) + largest(b)) * (1 + largest(c)));
}

static Range smooth(const ProgramStep *step, Range a, Range b, Range c)
{
    double reach = largest(a) + largest(b) + largest(c);
    if (!(reach < 1e300)) return anything;
    if (!is_point(a) || !is_point(b)) return widened(truth, 0);
    return widened(at_corners(step, a, b, c), margin);
}

/* ---- noise ---- */

static Range noise(const Range *operands, unsigned n)
{
    const Range all = {-1, 1};
    Range range;
    double low[3], high[3];
    for (unsigned i = 0; i < n; i++) {
        if (!(largest(operands[i]) < NOISE_LARGEST_COORDINATE)) return anything;
        low[i] = operands[i].low;
        high[i] = operands[i].high;
    }
    if (!noise_bounds(low, high, n, &range.low, &range.high)) return all;
    return common(widened(range, 10 * margin), all);
}

/* ---- functions of one number ---- */

/* A sine with its peak at `peak` degrees; where numbers are large the place of a peak is not known well enough. */
static Range wave(const ProgramStep *step, Range a, double peak)
{
    Range range = {-1, 1};
    if (!(a.high - a.low < 360 && largest(a) < 1e9)) return range;
    double first = step->unary(a.low), last = step->unary(a.high);
    bool rises_to_peak = floor((a.high - peak) / 360) > floor((a.low - peak) / 360);
    bool falls_to_trough = floor((a.high - peak + 180) / 360) > floor((a.low - peak + 180) / 360);
    if (!rises_to_peak) range.high = fmin(fmax(first, last) + margin, 1);
    if (!falls_to_trough) range.low = fmax(fmin(first, last) - margin, -1);
    return range;
}

static Range unary(const ProgramStep *step, Range a)
{
    double first = step->unary(a.low), last = step->unary(a.high);
    switch ((ProgramShape)step->shape) {
    case PROGRAM_SHAPE_RISES: return between(first, last);
    case PROGRAM_SHAPE_NEARLY_RISES: return widened(between(first, last), 0);
    case PROGRAM_SHAPE_NEARLY_FALLS: return widened(between(last, first), margin);
    case PROGRAM_SHAPE_VALLEY:
        return a.low < 0 && a.high > 0 ? between(0, fmax(first, last)) : between(fmin(first, last), fmax(first, last));
    case PROGRAM_SHAPE_SAW: return floor(a.low) == floor(a.high) ? between(first, last) : truth;
    case PROGRAM_SHAPE_SINE: return wave(step, a, 90);
    case PROGRAM_SHAPE_COSINE: return wave(step, a, 0);
    case PROGRAM_SHAPE_UNKNOWN: break;
    }
    return anything;
}

/* ---- all ---- */

/* Of operations that give no number of an operand that is none, and anything of one that is anything. */
static Range of_numbers(const ProgramStep *step, const Range operands[3])
{
    const Range zero = {0, 0};
    Range a = operands[0], b = operands[1], c = operands[2];
    switch ((ProgramOp)step->op) {
    case PROGRAM_ADD: return between(a.low + b.low, a.high + b.high);
    case PROGRAM_SUBTRACT: return between(a.low - b.high, a.high - b.low);
    case PROGRAM_MULTIPLY: return step->a == step->b ? square(a) : multiply(a, b);
    case PROGRAM_DIVIDE: return divide(a, b);
    case PROGRAM_MODULO: return modulo(step, a, b);
    case PROGRAM_POWER: return power(step, a, b, zero);
    case PROGRAM_SMALLER: return (Range){fmin(a.low, b.low), fmin(a.high, b.high)};
    case PROGRAM_LARGER: return (Range){fmax(a.low, b.low), fmax(a.high, b.high)};
    case PROGRAM_ATAN2: return angle(step, a, b, zero);
    case PROGRAM_MIX: return mix(step, a, b, c);
    case PROGRAM_SMOOTH: return smooth(step, a, b, c);
    case PROGRAM_UNARY: return unary(step, a);
    case PROGRAM_NOISE1: return noise(operands, 1);
    case PROGRAM_NOISE2: return noise(operands, 2);
    case PROGRAM_NOISE3: return noise(operands, 3);
    default: return anything;
    }
}

static unsigned n_operands(ProgramOp op)
{
    switch (op) {
    case PROGRAM_UNARY:
    case PROGRAM_NOISE1: return 1;
    case PROGRAM_MIX:
    case PROGRAM_SMOOTH:
    case PROGRAM_NOISE3: return 3;
    default: return 2;
    }
}

static Range entry(const ProgramStep *step, const Range *r)
{
    Range at = r[step->a], n = r[step->c];
    if (!is_point(at) || !is_point(n) || !(at.low >= 0 && at.low < n.low && at.low == floor(at.low))) return anything;
    return r[step->b + (unsigned)at.low];
}

static Range bound_step(const Program *program, const ProgramStep *step, const Range *r)
{
    Range a = r[step->a], b = r[step->b];
    switch ((ProgramOp)step->op) {
    case PROGRAM_EQUAL:
    case PROGRAM_LESS:
    case PROGRAM_LESS_EQUAL: return compare((ProgramOp)step->op, a, b);
    case PROGRAM_AND: return truth_of(surely(a) && surely(b), never(a) || never(b));
    case PROGRAM_OR: return truth_of(surely(a) || surely(b), never(a) && never(b));
    case PROGRAM_NOT: return truth_of(never(a), surely(a));
    case PROGRAM_SELECT: return choose(program, r, step);
    case PROGRAM_HASH: return anything;
    case PROGRAM_UNIT: return truth;
    case PROGRAM_ENTRY: return entry(step, r);
    default: break;
    }
    const Range operands[3] = {a, b, r[step->c]};
    for (unsigned i = 0; i < n_operands((ProgramOp)step->op); i++)
        if (!program_range_is_known(operands[i])) return anything;
    return of_numbers(step, operands);
}

void program_bound(const Program *program, const ProgramRange inputs[PROGRAM_INPUTS], ProgramRange *outputs)
{
    Range registers[PROGRAM_MOST_REGISTERS];
    memcpy(registers, inputs, PROGRAM_INPUTS * sizeof *registers);
    for (uint32_t i = 0; i < program->n_constants; i++)
        registers[PROGRAM_INPUTS + i] = between(program->constants[i], program->constants[i]);
    for (uint32_t i = 0; i < program->n_steps; i++)
        registers[program->steps[i].to] = bound_step(program, &program->steps[i], registers);
    for (uint32_t i = 0; i < program->n_outputs; i++) outputs[i] = registers[program->outputs[i]];
}

/* program.c - running programs.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/program.h"

#include <math.h>
#include <string.h>

#include "base/angle.h"
#include "base/hash.h"
#include "base/noise.h"

static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static double from_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static double modulo(double a, double b)
{
    double rest = fmod(a, b);
    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}

static double smooth(double a, double b, double x)
{
    double t = a == b ? (x < a ? 0 : 1) : (x - a) / (b - a);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return t * t * (3 - 2 * t);
}

static double noise_at(const double *point, unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        if (!(fabs(point[i]) < NOISE_LARGEST_COORDINATE)) return (double)NAN;
    return noise_value(point, n);
}

static double entry(const double *table, unsigned n, double at)
{
    return at >= 0 && at < n && at == floor(at) ? table[(unsigned)at] : (double)NAN;
}

static double run_step(const ProgramStep *step, const double *r)
{
    double a = r[step->a], b = r[step->b], c = r[step->c];
    switch ((ProgramOp)step->op) {
    case PROGRAM_ADD: return a + b;
    case PROGRAM_SUBTRACT: return a - b;
    case PROGRAM_MULTIPLY: return a * b;
    case PROGRAM_DIVIDE: return a / b;
    case PROGRAM_MODULO: return modulo(a, b);
    case PROGRAM_POWER: return pow(a, b);
    case PROGRAM_EQUAL: return a == b;
    case PROGRAM_LESS: return a < b;
    case PROGRAM_LESS_EQUAL: return a <= b;
    case PROGRAM_AND: return a != 0 && b != 0;
    case PROGRAM_OR: return a != 0 || b != 0;
    case PROGRAM_NOT: return a == 0;
    case PROGRAM_SELECT: return a != 0 ? b : c;
    case PROGRAM_SMALLER: return b < a ? b : a;
    case PROGRAM_LARGER: return b > a ? b : a;
    case PROGRAM_ATAN2: return atan2(a, b) * (180 / MEN_PI);
    case PROGRAM_MIX: return c == 1 ? b : a + (b - a) * c;
    case PROGRAM_SMOOTH: return smooth(a, b, c);
    case PROGRAM_UNARY: return step->unary(a);
    case PROGRAM_NOISE1: return noise_at(&a, 1);
    case PROGRAM_NOISE2: return noise_at((const double[2]){a, b}, 2);
    case PROGRAM_NOISE3: return noise_at((const double[3]){a, b, c}, 3);
    case PROGRAM_HASH: return from_bits(hash_u64(bits_of(a) ^ bits_of(b + 0.0))); /* -0 is 0 */
    case PROGRAM_UNIT: return hash_to_unit(bits_of(a));
    case PROGRAM_ENTRY: return entry(r + step->b, (unsigned)c, a);
    }
    return 0;
}

/* With the constants in their registers. */
static void run_steps(const Program *program, double *registers, const double inputs[PROGRAM_INPUTS], double *outputs)
{
    memcpy(registers, inputs, PROGRAM_INPUTS * sizeof *registers);
    const ProgramStep *end = program->steps + program->n_steps;
    for (const ProgramStep *step = program->steps; step < end; step++) registers[step->to] = run_step(step, registers);
    for (uint32_t i = 0; i < program->n_outputs; i++) outputs[i] = registers[program->outputs[i]];
}

void program_run(const Program *program, const double inputs[PROGRAM_INPUTS], double *outputs)
{
    double registers[PROGRAM_MOST_REGISTERS];
    if (program->n_constants)
        memcpy(registers + PROGRAM_INPUTS, program->constants, program->n_constants * sizeof *registers);
    run_steps(program, registers, inputs, outputs);
}

void program_run_between(const Program *from, const Program *to, double part, const double inputs[PROGRAM_INPUTS],
                         double *outputs)
{
    double registers[PROGRAM_MOST_REGISTERS];
    for (uint32_t i = 0; i < from->n_constants; i++)
        registers[PROGRAM_INPUTS + i] = from->constants[i] + (to->constants[i] - from->constants[i]) * part;
    run_steps(from, registers, inputs, outputs);
}

uint64_t program_hash(const Program *program)
{
    const double x[] = {0.3, 17.25, -2.125};
    uint64_t h = hash_bytes(program->constants, program->n_constants * sizeof *program->constants, program->n_outputs);
    for (uint32_t i = 0; i < program->n_steps; i++) {
        const ProgramStep *step = &program->steps[i];
        const uint16_t words[] = {step->op, step->to, step->a, step->b, step->c};
        h = hash_bytes(words, sizeof words, h);
        /* functions are told apart by what they give: their addresses change from run to run */
        for (int k = 0; step->unary && k < 3; k++) h = hash_u64(h ^ bits_of(step->unary(x[k])));
    }
    return hash_bytes(program->outputs, program->n_outputs * sizeof *program->outputs, h);
}

/* program.h - arithmetic that is run very often: straight steps over doubles, with neither loops nor memory of its own.
 * What a step cannot compute, as a division by 0, gives what the machine gives, NaN or an infinity.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PROGRAM_H
#define MEN_PROGRAM_H

#include <stdbool.h>
#include <stdint.h>

#include "base/arena.h"

/* What programs know of a place on a surface: the first registers of each. */
enum {
    PROGRAM_POINT = 0,  /* x, y, z */
    PROGRAM_NORMAL = 3, /* outward, unit: x, y, z */
    PROGRAM_UV = 6,
    PROGRAM_FOOTPRINT = 8, /* details need not be smaller than this length */
    PROGRAM_INPUTS = 9
};

enum { PROGRAM_MOST_REGISTERS = 4096, PROGRAM_MOST_OUTPUTS = 3 };

typedef enum ProgramOp {
    PROGRAM_ADD, /* ORDER: program.c has a label for each */
    PROGRAM_SUBTRACT,
    PROGRAM_MULTIPLY,
    PROGRAM_DIVIDE,
    PROGRAM_MODULO, /* with the sign of b */
    PROGRAM_POWER,
    PROGRAM_EQUAL, /* 1 or 0 */
    PROGRAM_LESS,
    PROGRAM_LESS_EQUAL,
    PROGRAM_AND, /* of 1 and 0 */
    PROGRAM_OR,
    PROGRAM_NOT,
    PROGRAM_SELECT, /* a ? b : c */
    PROGRAM_SMALLER,
    PROGRAM_LARGER,
    PROGRAM_ATAN2,  /* degrees */
    PROGRAM_MIX,    /* a + (b - a) c, exactly b for c = 1 */
    PROGRAM_SMOOTH, /* from a to b, at c: t t (3 - 2 t) */
    PROGRAM_UNARY,  /* unary(a) */
    PROGRAM_NOISE1, /* noise_value() of a; of a and b; of all three */
    PROGRAM_NOISE2,
    PROGRAM_NOISE3,
    PROGRAM_HASH, /* hash_u64(the bits of a ^ those of b as a double) as bits */
    PROGRAM_UNIT, /* hash_to_unit() of the bits of a */
    PROGRAM_ENTRY /* of the registers from number b on, c of them, the one of whole number a; NaN beyond */
} ProgramOp;

/* How the values of a function of one number go, for its bounds. */
typedef enum ProgramShape {
    PROGRAM_SHAPE_UNKNOWN,
    PROGRAM_SHAPE_RISES,        /* never falls, as computed */
    PROGRAM_SHAPE_NEARLY_RISES, /* never falls, but for rounding */
    PROGRAM_SHAPE_NEARLY_FALLS,
    PROGRAM_SHAPE_VALLEY, /* falls to 0 at 0, and rises from there */
    PROGRAM_SHAPE_SAW,    /* x - floor(x) */
    PROGRAM_SHAPE_SINE,   /* of degrees */
    PROGRAM_SHAPE_COSINE
} ProgramShape;

typedef struct ProgramStep {
    uint16_t op, to, a, b, c; /* registers */
    uint16_t shape;           /* of unary: a ProgramShape */
    double (*unary)(double x);
} ProgramStep;

/* Registers are the inputs, then constants, then what steps write. */
typedef struct Program {
    const double *constants;
    const ProgramStep *steps;
    uint32_t n_constants, n_steps, n_registers; /* at most PROGRAM_MOST_REGISTERS */
    uint32_t n_outputs;                         /* 1: a number, 3: a colour */
    uint16_t outputs[PROGRAM_MOST_OUTPUTS];
} Program;

/* outputs: n_outputs of them. Allocates nothing; may run in any number of threads at once. */
void program_run(const Program *program, const double inputs[PROGRAM_INPUTS], double *outputs);

/* As a program would with constants that are `part` of the way from those of one to those of another that is aligned with it. */
void program_run_between(const Program *from, const Program *to, double part, const double inputs[PROGRAM_INPUTS],
                         double *outputs);
/* Whether n programs take the same steps with constants of their own. Then *aligned gets n that do what they do and have
 * their registers in common, in the arena (program_align.c). */
bool program_align(const Program *const *programs, uint32_t n, Arena *arena, const Program *const **aligned);

/* What a number is between, both ends included; from -HUGE_VAL to HUGE_VAL it can be anything, NaN too. */
typedef struct ProgramRange {
    double low, high;
} ProgramRange;

bool program_range_is_known(ProgramRange range); /* a finite number between finite ends */
/* What program_run() gives is within these for all inputs that are within theirs (program_bounds.c). */
void program_bound(const Program *program, const ProgramRange inputs[PROGRAM_INPUTS], ProgramRange *outputs);
uint64_t program_hash(const Program *program);

#endif

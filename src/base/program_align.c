/* program_align.c - programs that were made of one text at several times, with their constants in the same registers.
 *
 * A program holds each constant once, so that two of them may have fallen together at one time and not at another: what is
 * a constant of all together is what is looked up at the same places of the steps at all times.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/program.h"

#include <string.h>

typedef struct Aligner {
    const Program *const *programs;
    uint32_t n;        /* of them */
    double *constants; /* of them all: n for each constant so far */
    uint32_t n_constants, capacity;
    Arena *arena;
    bool as_they_are; /* constants keep their numbers */
} Aligner;

static bool is_constant(const Program *program, uint32_t number)
{
    return number >= PROGRAM_INPUTS && number < PROGRAM_INPUTS + program->n_constants;
}

static uint32_t find_constant(Aligner *a, const uint16_t *numbers)
{
    double *new = NULL;
    if (a->n_constants == a->capacity) {
        a->capacity = a->capacity ? 2 * a->capacity : 16;
        a->constants = arena_regrow(a->arena, a->constants, (size_t)a->n_constants * a->n, (size_t)a->capacity * a->n,
                                    sizeof *new);
    }
    new = a->constants + (size_t)a->n_constants * a->n;
    for (uint32_t k = 0; k < a->n; k++) new[k] = a->programs[k]->constants[numbers[k] - PROGRAM_INPUTS];
    for (uint32_t i = 0; i < a->n_constants; i++)
        if (memcmp(a->constants + (size_t)i * a->n, new, a->n * sizeof *new) == 0) return i;
    return a->n_constants++;
}

/* The register that stands for those, one of each program; shift: how many constants there are in all. false: they do not
 * stand for the same. */
static bool align(Aligner *a, const uint16_t *numbers, uint32_t shift, uint16_t *to)
{
    bool constant = is_constant(a->programs[0], numbers[0]);
    uint32_t first = numbers[0] - (numbers[0] < PROGRAM_INPUTS ? 0 : a->programs[0]->n_constants);
    for (uint32_t k = 1; k < a->n; k++) {
        if (a->as_they_are && numbers[k] != numbers[0]) return false;
        if (is_constant(a->programs[k], numbers[k]) != constant) return false;
        uint32_t other = numbers[k] - (numbers[k] < PROGRAM_INPUTS ? 0 : a->programs[k]->n_constants);
        if (!constant && other != first) return false;
    }
    uint32_t number = a->as_they_are           ? numbers[0]
                      : constant               ? PROGRAM_INPUTS + find_constant(a, numbers)
                      : first < PROGRAM_INPUTS ? first
                                               : first + shift;
    *to = (uint16_t)number;
    return number < PROGRAM_MOST_REGISTERS;
}

static bool align_step(Aligner *a, uint32_t i, uint16_t *numbers, uint32_t shift, ProgramStep *out)
{
    const ProgramStep *first = &a->programs[0]->steps[i];
    *out = *first;
    for (uint32_t k = 1; k < a->n; k++) {
        const ProgramStep *step = &a->programs[k]->steps[i];
        if (step->op != first->op || step->unary != first->unary) return false;
    }
    for (int field = 0; field < 4; field++) {
        for (uint32_t k = 0; k < a->n; k++) {
            const ProgramStep *step = &a->programs[k]->steps[i];
            const uint16_t fields[] = {step->to, step->a, step->b, step->c};
            numbers[k] = fields[field];
        }
        uint16_t *const fields[] = {&out->to, &out->a, &out->b, &out->c};
        if (!align(a, numbers, shift, fields[field])) return false;
    }
    return true;
}

static bool align_all(Aligner *a, uint16_t *numbers, uint32_t shift, ProgramStep *steps, uint16_t *outputs)
{
    const Program *first = a->programs[0];
    for (uint32_t i = 0; i < first->n_steps; i++)
        if (!align_step(a, i, numbers, shift, &steps[i])) return false;
    for (uint32_t i = 0; i < first->n_outputs; i++) {
        for (uint32_t k = 0; k < a->n; k++) numbers[k] = a->programs[k]->outputs[i];
        if (!align(a, numbers, shift, &outputs[i])) return false;
    }
    return true;
}

bool program_align(const Program *const *programs, uint32_t n, Arena *arena, const Program *const **aligned)
{
    const Program *first = programs[0];
    bool tables = false, as_many = true;
    for (uint32_t i = 0; i < first->n_steps; i++) tables = tables || first->steps[i].op == PROGRAM_ENTRY;
    for (uint32_t k = 1; k < n; k++) {
        if (programs[k]->n_steps != first->n_steps || programs[k]->n_outputs != first->n_outputs) return false;
        as_many = as_many && programs[k]->n_constants == first->n_constants;
    }
    if (tables && !as_many) return false; /* a table's constants stand side by side */
    Aligner a = {.programs = programs, .n = n, .arena = arena, .as_they_are = tables};
    ProgramStep *steps = ARENA_ARRAY(arena, ProgramStep, first->n_steps + 1);
    uint16_t *numbers = ARENA_ARRAY(arena, uint16_t, n), outputs[PROGRAM_MOST_OUTPUTS] = {0};
    if (!align_all(&a, numbers, 0, steps, outputs)) return false;
    if (!align_all(&a, numbers, a.n_constants, steps, outputs)) return false; /* now that they are counted */
    uint32_t n_constants = tables ? first->n_constants : a.n_constants;
    Program *made = ARENA_ARRAY(arena, Program, n);
    const Program **rows = ARENA_ARRAY(arena, const Program *, n);
    for (uint32_t k = 0; k < n; k++) {
        double *constants = ARENA_ARRAY(arena, double, n_constants + 1);
        for (uint32_t i = 0; i < n_constants; i++)
            constants[i] = tables ? programs[k]->constants[i] : a.constants[(size_t)i * n + k];
        made[k] = *first;
        made[k].steps = steps;
        made[k].constants = constants;
        made[k].n_constants = n_constants;
        made[k].n_registers = first->n_registers - first->n_constants + n_constants;
        memcpy(made[k].outputs, outputs, sizeof outputs);
        rows[k] = &made[k];
    }
    *aligned = rows;
    return true;
}

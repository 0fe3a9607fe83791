/* formula.h - functions of the scene that are asked at very many places: compiled to programs.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FORMULA_H
#define MEN_FORMULA_H

#include "base/program.h"
#include "lang/eval.h"

/* The function as a program over a place on a surface, with all that does not depend on the place worked out. It gives a
 * number or a colour. NULL after a report: it uses what only the evaluation of the scene can do, as lists that depend on the
 * place. Memory is the arena's. */
const Program *formula_compile(const EvalFunctionValue *function, Arena *arena);
/* The same of a function of a point, with the arguments that eval_function_at gives it; of the inputs it takes the first
 * three. NULL without a report where the evaluation has to do it. */
const Program *formula_compile_at_points(const EvalFunctionValue *function, Arena *arena);
/* Asks the function itself, as the evaluation would: false after a report that says where and why it has no value there,
 * or when it is of another kind than the program. */
bool formula_evaluate(const EvalFunctionValue *function, const double inputs[PROGRAM_INPUTS],
                      double outputs[PROGRAM_MOST_OUTPUTS]);

#endif

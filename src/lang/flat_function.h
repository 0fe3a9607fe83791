/* flat_function.h - functions that are values, as text again: each a def at the top of the scene.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FLAT_FUNCTION_H
#define MEN_FLAT_FUNCTION_H

#include "diag/diag.h"
#include "lang/eval.h"

typedef struct FlatDef FlatDef;

/* Begun with all but the list. */
typedef struct FlatFunctions {
    Diag *diag;
    Buf *out; /* where defs are written */
    /* a name that nothing in the text has yet, made from one that is wanted */
    const char *(*new_name)(void *context, const char *wanted);
    void *context;
    FlatDef *defs; /* that are written */
} FlatFunctions;

/* Writes the function as defs, with those that it calls before it, unless that was done; the name by which the text has it.
 * What it sees of the scene around it stands in it as the values that were there. NULL after a report: not all values can
 * be written. Its memory is the diag's arena's. */
const char *flat_function(FlatFunctions *functions, const EvalFunctionValue *function);

#endif

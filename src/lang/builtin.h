/* builtin.h - the functions of the language that are written in C.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BUILTIN_H
#define MEN_BUILTIN_H

#include "base/program.h"
#include "lang/ast.h"

struct Evaluator;

/* One call: what a builtin sees. */
typedef struct BuiltinCall {
    struct Evaluator *evaluator;
    Expr *expr;
    const Value *args;
    uint32_t n;
} BuiltinCall;

struct Builtin {
    const char *name;
    unsigned min_args, max_args;
    bool is_statement;         /* print, warn, assert: has no value */
    double (*unary)(double x); /* a function of a number that also works on each element of a vector or colour */
    ProgramShape shape;        /* of that function */
    void (*run)(const BuiltinCall *call, Value *result);
    const char *doc;
};

enum { BUILTIN_MAX_ARGS = LIMIT_ARGUMENTS };

const Builtin *builtin_find(const char *name); /* NULL when there is none */
size_t builtin_count(void);
const Builtin *builtin_at(size_t index);

#endif

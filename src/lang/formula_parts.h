/* formula_parts.h - what the files of the compiler of functions share; private to src/lang/formula*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FORMULA_PARTS_H
#define MEN_FORMULA_PARTS_H

#include "base/program.h"
#include "lang/evaluator.h"

enum {
    FORMULA_MOST_CALLS = 200,
    FORMULA_CONSTANTS = 0x8000 /* while registers are counted, constants are told by numbers from here on */
};

typedef struct FormList FormList;

/* A value while a function is compiled. */
typedef struct Form {
    ValueKind kind;
    bool known; /* value is it; else it is in registers */
    Value value;
    uint16_t at[4];       /* a number or truth: the first */
    const FormList *list; /* of elements that are not all known; kind VALUE_LIST */
} Form;

struct FormList {
    size_t n;
    Form *items;
};

/* The slots of a def that is being compiled. */
typedef struct Scope Scope;
struct Scope {
    Form *slots;
    const Scope *lexical;
};

typedef struct Compiler {
    Evaluator *evaluator;
    const EvalFunctionValue *function;
    const Scope *scope;
    ProgramStep *steps;
    double *constants;
    uint32_t n_steps, n_constants, n_registers, step_capacity, constant_capacity;
    unsigned depth;
    bool failed; /* after a report */
} Compiler;

/* What an expression comes to: its value where that is known, else registers, after the steps that fill them. Once something
 * has failed all of these give form_failed's, without a report of their own. */
Form formula_expr(Compiler *c, Expr *expr);
Form form_of_operation(Compiler *c, Expr *expr); /* operators, vectors, lists, conditions */
Form form_of_builtin(Compiler *c, Expr *expr);   /* calls of the language's functions */

Form form_known(const Value *value);
Form form_failed(Compiler *c);     /* the compiler's end: something was reported */
Form form_number(uint16_t number); /* what is in a register */
/* After a report that `what`, as "a string", cannot be worked out at each place. */
Form form_refused(Compiler *c, const Expr *expr, const char *what);
/* What the evaluator makes of the expression with operands that are known; b may be NULL. */
Form form_folded(Compiler *c, Expr *expr, const Form *a, const Form *b);
const char *form_describe(const Form *form); /* "a number", "a list" */
/* The register of an element; of a number whichever is asked for. This, and all that adds a step, stands in a statement of
 * its own and not twice among the arguments of a call: compilers differ in which they evaluate first, and the numbers of
 * registers go into the scene's hash. */
uint16_t form_register(Compiler *c, const Expr *expr, const Form *form, unsigned i);
Form *formula_slot(const Compiler *c, Slot slot); /* NULL: it is not of a def that is being compiled */

/* The register that holds the result; 0 after a report that the function is too long. What was asked for before is not
 * computed twice. */
uint16_t formula_constant(Compiler *c, const Expr *expr, double x);
uint16_t formula_new_constant(Compiler *c, double x); /* behind all others; whoever calls it keeps to the limit */
uint16_t formula_step(Compiler *c, const Expr *expr, ProgramOp op, uint16_t a, uint16_t b, uint16_t third);
uint16_t formula_unary(Compiler *c, const Expr *expr, double (*unary)(double), ProgramShape shape, uint16_t a);
/* Numbers the registers as programs do; outputs too. false: there are too many. */
bool formula_pack(const Compiler *c, Program *program, Arena *arena);

#endif

/* formula.c - from functions of the scene to programs: the tree of the function is walked once with values that are either
 * known, and then the evaluator's own functions work on them, or registers of the program. Calls, loops over known lists
 * and known conditions are gone afterwards; of a condition that depends on the place both sides are computed.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/formula.h"

#include <math.h>
#include <string.h>

#include "lang/formula_parts.h"

/* ---- registers ---- */

static void refuse_size(Compiler *c, const Expr *expr)
{
    if (!c->failed)
        eval_report(c->evaluator, D_LIMIT, expr->span, "this function takes more than %d steps at each place",
                    PROGRAM_MOST_REGISTERS);
    c->failed = true;
}

static uint16_t new_register(Compiler *c, const Expr *expr)
{
    if (c->n_registers < PROGRAM_MOST_REGISTERS) return (uint16_t)c->n_registers++;
    refuse_size(c, expr);
    return 0;
}

uint16_t formula_new_constant(Compiler *c, double x)
{
    ARENA_ROOM(c->evaluator->arena, c->constants, c->constant_capacity, c->n_constants, 16);
    c->constants[c->n_constants] = x;
    return (uint16_t)(FORMULA_CONSTANTS + c->n_constants++);
}

uint16_t formula_constant(Compiler *c, const Expr *expr, double x)
{
    for (uint32_t i = 0; i < c->n_constants; i++)
        if (memcmp(&c->constants[i], &x, sizeof x) == 0) return (uint16_t)(FORMULA_CONSTANTS + i);
    if (c->n_constants == PROGRAM_MOST_REGISTERS) {
        refuse_size(c, expr);
        return 0;
    }
    return formula_new_constant(c, x);
}

static void add_step(Compiler *c, ProgramStep step)
{
    if (c->failed) return;
    ARENA_ROOM(c->evaluator->arena, c->steps, c->step_capacity, c->n_steps, 32);
    c->steps[c->n_steps++] = step;
}

uint16_t formula_step(Compiler *c, const Expr *expr, ProgramOp op, uint16_t a, uint16_t b, uint16_t third)
{
    for (uint32_t i = 0; i < c->n_steps; i++) { /* once is enough */
        const ProgramStep *step = &c->steps[i];
        if (op != PROGRAM_UNARY && step->op == op && step->a == a && step->b == b && step->c == third) return step->to;
    }
    uint16_t to = new_register(c, expr);
    add_step(c, (ProgramStep){.op = (uint16_t)op, .to = to, .a = a, .b = b, .c = third});
    return to;
}

uint16_t formula_unary(Compiler *c, const Expr *expr, double (*unary)(double), ProgramShape shape, uint16_t a)
{
    uint16_t to = new_register(c, expr);
    add_step(c, (ProgramStep){.op = PROGRAM_UNARY, .to = to, .a = a, .shape = (uint16_t)shape, .unary = unary});
    return to;
}

/* ---- values ---- */

Form form_known(const Value *value)
{
    Form form = {.kind = value->kind, .known = true, .value = *value};
    return form;
}

Form form_failed(Compiler *c)
{
    c->failed = true;
    Value poison = value_poison();
    return form_known(&poison);
}

Form form_number(uint16_t number)
{
    return (Form){.kind = VALUE_NUMBER, .at = {number}};
}

uint16_t form_register(Compiler *c, const Expr *expr, const Form *form, unsigned i)
{
    if (form->kind == VALUE_NUMBER || form->kind == VALUE_BOOL) i = 0;
    if (!form->known) return form->at[i];
    if (form->kind == VALUE_BOOL) return formula_constant(c, expr, form->value.as.truth);
    return formula_constant(c, expr, form->value.as.v[i]);
}

Form form_refused(Compiler *c, const Expr *expr, const char *what)
{
    if (!c->failed) {
        Diagnostic *report =
            eval_report(c->evaluator, D_WRONG_TYPE, expr->span, "%s cannot be worked out anew at each place", what);
        diag_hint(c->evaluator->diag, report,
                  "numbers, vectors and colours can; lists, strings and nodes must not depend on the place");
    }
    return form_failed(c);
}

const char *form_describe(const Form *form)
{
    return form->list ? "a list" : value_kind_text(form->kind);
}

/* Lets the evaluator work on operands that are known. */
Form form_folded(Compiler *c, Expr *expr, const Form *a, const Form *b)
{
    Expr operands[2] = {{.kind = EXPR_CONSTANT, .span = expr->span}, {.kind = EXPR_CONSTANT, .span = expr->span}};
    Expr copy = *expr;
    if (a) operands[0].as.constant.value = a->value;
    if (b) operands[1].as.constant.value = b->value;
    if (expr->kind == EXPR_MEMBER || expr->kind == EXPR_FIELD) {
        copy.as.member.base = &operands[0];
    } else {
        copy.as.op.a = &operands[0];
        copy.as.op.b = &operands[1];
    }
    Value result;
    eval_value(c->evaluator, &copy, &result);
    return result.kind == VALUE_POISON ? form_failed(c) : form_known(&result);
}

/* ---- names ---- */

static const Scope *scope_outward(const Compiler *c, uint32_t hops)
{
    const Scope *scope = c->scope;
    for (; hops > 0 && scope; hops--) scope = scope->lexical;
    return scope;
}

Form *formula_slot(const Compiler *c, Slot slot)
{
    const Scope *scope = scope_outward(c, slot.hops);
    return scope ? &scope->slots[slot.index] : NULL;
}

static Form form_of_name(Compiler *c, const Expr *expr)
{
    Slot slot = expr->as.variable.slot;
    Form *form = slot.kind == EXPR_GLOBAL ? NULL : formula_slot(c, slot);
    if (form && (!form->known || form->kind != VALUE_UNSET)) return *form;
    const Value *value = slot.kind == EXPR_GLOBAL ? &c->evaluator->globals[slot.index] : NULL;
    if (value && value->kind == VALUE_POISON) return form_failed(c);
    if (value && value->kind != VALUE_UNSET) return form_known(value);
    if (!c->failed)
        eval_report(c->evaluator, D_UNSET_NAME, expr->span, "'%s' is used before it has its value",
                    expr->as.variable.symbol->text);
    return form_failed(c);
}

/* The slots around a def, as they were when the function was taken. */
static const Scope *scope_of_frame(Compiler *c, const Frame *frame)
{
    if (!frame || !frame->def) return NULL;
    Scope *scope = ARENA_NEW(c->evaluator->arena, Scope);
    scope->slots = ARENA_ARRAY(c->evaluator->arena, Form, frame->def->n_slots + 1);
    for (uint32_t i = 0; i < frame->def->n_slots; i++) scope->slots[i] = form_known(&frame->slots[i]);
    scope->lexical = scope_of_frame(c, frame->lexical);
    return scope;
}

static Scope scope_of_def(Compiler *c, const Def *def, const Scope *lexical)
{
    Scope scope = {.slots = ARENA_ARRAY(c->evaluator->arena, Form, def->n_slots + 1), .lexical = lexical};
    for (uint32_t i = 0; i < def->n_slots; i++) scope.slots[i] = form_known(&(Value){.kind = VALUE_UNSET});
    return scope;
}

/* ---- calls ---- */

static bool fill_fallbacks(Compiler *c, const Def *def, const Expr *expr)
{
    for (uint32_t i = 0; i < def->n_formals && !c->failed; i++) {
        const Formal *formal = &def->formals[i];
        Form *form = &c->scope->slots[formal->slot.index];
        bool unset = form->known && form->kind == VALUE_UNSET;
        if (unset && formal->fallback) {
            *form = formula_expr(c, formal->fallback);
        } else if (unset) {
            eval_report(c->evaluator, D_MISSING_ARGUMENT, expr->span, "'%s' needs an argument '%s'", def->name->text,
                        formal->name->text);
            c->failed = true;
        }
        Value like = form->known ? form->value : (Value){.kind = form->kind};
        if (!c->failed && formal->type && !form->list &&
            !eval_type_allows(c->evaluator, formal->type, formal->type_span, &like, expr->span, formal->name->text))
            c->failed = true;
    }
    return !c->failed;
}

static bool fill_arguments(Compiler *c, Expr *expr, const Def *def, Scope *scope)
{
    const Args *args = &expr->as.call.args;
    uint32_t position = 0;
    for (uint32_t i = 0; i < args->n && !c->failed; i++) {
        uint32_t index = position;
        if (args->items[i].name)
            for (index = 0; index < def->n_formals && def->formals[index].name != args->items[i].name;) index++;
        else
            position++;
        if (index >= def->n_formals) {
            eval_report(c->evaluator, D_WRONG_ARGUMENT, args->items[i].value->span, "'%s' has no such parameter",
                        def->name->text);
            c->failed = true;
            return false;
        }
        scope->slots[def->formals[index].slot.index] = formula_expr(c, args->items[i].value);
    }
    return !c->failed;
}

static Form form_of_call(Compiler *c, Expr *expr)
{
    const Def *def = expr->as.call.to.def;
    if (!def->body) return form_refused(c, expr, "a macro");
    if (c->depth >= FORMULA_MOST_CALLS || !eval_step(c->evaluator, expr->span)) {
        if (!c->failed) {
            Diagnostic *report = eval_report(c->evaluator, D_TOO_DEEP, expr->span,
                                             "more than %d calls within each other, at each place", FORMULA_MOST_CALLS);
            diag_hint(c->evaluator->diag, report, "whether a call calls itself again must not depend on the place");
        }
        return form_failed(c);
    }
    Scope scope = scope_of_def(c, def, def->level ? scope_outward(c, expr->as.call.hops) : NULL);
    const Scope *here = c->scope;
    if (!fill_arguments(c, expr, def, &scope)) return form_failed(c);
    c->scope = &scope;
    c->depth++;
    Form result = fill_fallbacks(c, def, expr) ? formula_expr(c, def->body) : form_failed(c);
    c->depth--;
    c->scope = here;
    return result;
}

static Form form_of_let(Compiler *c, Expr *expr)
{
    for (uint32_t i = 0; i < expr->as.let.bindings.n && !c->failed; i++) {
        Form form = formula_expr(c, expr->as.let.bindings.items[i].value),
             *slot = formula_slot(c, expr->as.let.slots[i]);
        if (!slot) return form_refused(c, expr, "this name");
        *slot = form;
    }
    return c->failed ? form_failed(c) : formula_expr(c, expr->as.let.body);
}

/* ---- all ---- */

Form formula_expr(Compiler *c, Expr *expr)
{
    if (c->failed || eval_stack_is_deep(c->evaluator, expr->span)) return form_failed(c);
    switch (expr->kind) {
    case EXPR_CONSTANT: return form_known(&expr->as.constant.value);
    case EXPR_GLOBAL:
    case EXPR_LOCAL:
    case EXPR_OUTER: return form_of_name(c, expr);
    case EXPR_LET: return form_of_let(c, expr);
    case EXPR_CALL_DEF: return form_of_call(c, expr);
    case EXPR_CALL_BUILTIN: return form_of_builtin(c, expr);
    case EXPR_CALL_TERM: return form_refused(c, expr, expr->as.call.name);
    case EXPR_NODE: return form_refused(c, expr, "a node");
    case EXPR_POISON: return form_failed(c);
    case EXPR_NAME: {
        Value value; /* reports that it is not known */
        eval_value(c->evaluator, expr, &value);
        return form_failed(c);
    }
    default: return form_of_operation(c, expr);
    }
}

/* What each parameter of a function of a place is given: the number of its first input; -1: its default. */
static bool find_roles(const EvalFunctionValue *function, int roles[LIMIT_ARGUMENTS], ValueKind kinds[LIMIT_ARGUMENTS])
{
    const Def *def = function->def;
    int n_plain = 0, at = 0;
    if (def->n_formals > LIMIT_ARGUMENTS) return false;
    for (uint32_t i = 0; i < def->n_formals; i++) {
        const char *name = def->formals[i].name->text;
        kinds[i] = VALUE_NUMBER;
        roles[i] = -1;
        if (strcmp(name, "normal") == 0)
            roles[i] = PROGRAM_NORMAL, kinds[i] = VALUE_VECTOR3;
        else if (strcmp(name, "uv") == 0)
            roles[i] = PROGRAM_UV, kinds[i] = VALUE_VECTOR2;
        else if (strcmp(name, "footprint") == 0)
            roles[i] = PROGRAM_FOOTPRINT;
        else if (!def->formals[i].fallback)
            n_plain++;
    }
    if (n_plain > 3) return false;
    for (uint32_t i = 0; i < def->n_formals; i++) {
        if (roles[i] >= 0 || def->formals[i].fallback) continue;
        roles[i] = n_plain == 2 ? PROGRAM_UV + at++ : PROGRAM_POINT + at++;
        if (n_plain == 1) kinds[i] = VALUE_VECTOR3;
    }
    return true;
}

bool eval_takes_place(const EvalFunctionValue *function)
{
    int roles[LIMIT_ARGUMENTS];
    ValueKind kinds[LIMIT_ARGUMENTS];
    return find_roles(function, roles, kinds);
}

static const Program *finish_program(Compiler *c, const Expr *body, const Form *result, Arena *arena)
{
    bool color = result->kind == VALUE_COLOR;
    if (c->failed) return NULL;
    if (!color && result->kind != VALUE_NUMBER) {
        Diagnostic *report =
            eval_report(c->evaluator, D_WRONG_TYPE, body->span, "'%s' gives %s, not a number or a colour",
                        c->function->def->name->text, form_describe(result));
        if (result->kind == VALUE_VECTOR3 && !result->list)
            diag_hint(c->evaluator->diag, report, "rgb(v) makes a colour of a vector");
        if (result->kind == VALUE_BOOL) diag_hint(c->evaluator->diag, report, "write: condition ? 1 : 0");
        return NULL;
    }
    Program *program = ARENA_NEW(arena, Program);
    program->n_outputs = color ? 3 : 1;
    for (uint32_t i = 0; i < program->n_outputs; i++) program->outputs[i] = form_register(c, body, result, i);
    if (c->failed || !formula_pack(c, program, arena)) {
        refuse_size(c, body);
        return NULL;
    }
    return program;
}

static void begin(Compiler *c, const EvalFunctionValue *function, Frame *top, char *here)
{
    *c = (Compiler){.evaluator = function->evaluator, .function = function, .n_registers = PROGRAM_INPUTS};
    c->evaluator->stack_base = (uintptr_t)here;
    c->evaluator->frame = top;
}

/* What each parameter is given. */
typedef struct Roles {
    int inputs[LIMIT_ARGUMENTS]; /* the number of its first input; -1: its default */
    ValueKind kinds[LIMIT_ARGUMENTS];
} Roles;

static const Program *compile(const EvalFunctionValue *function, const Roles *roles, Arena *arena)
{
    char here;
    Compiler compiler, *c = &compiler;
    Frame top = {.has_chain = true};
    const Def *def = function->def;
    begin(c, function, &top, &here);
    Scope scope = scope_of_def(c, def, scope_of_frame(c, function->lexical));
    for (uint32_t i = 0; i < def->n_formals; i++) {
        if (roles->inputs[i] < 0) continue;
        Form form = {.kind = roles->kinds[i]};
        for (int k = 0; k < 3; k++) form.at[k] = (uint16_t)(roles->inputs[i] + k);
        scope.slots[def->formals[i].slot.index] = form;
    }
    c->scope = &scope;
    Expr call = {.kind = EXPR_CONSTANT, .span = function->span};
    Form result = fill_fallbacks(c, def, &call) ? formula_expr(c, def->body) : form_failed(c);
    const Program *program = finish_program(c, def->body, &result, arena);
    c->evaluator->frame = NULL;
    return program;
}

const Program *formula_compile(const EvalFunctionValue *function, Arena *arena)
{
    Roles roles;
    if (function->evaluator->stop || !find_roles(function, roles.inputs, roles.kinds)) return NULL;
    return compile(function, &roles, arena);
}

const Program *formula_compile_at_points(const EvalFunctionValue *function, Arena *arena)
{
    Evaluator *evaluator = function->evaluator;
    Roles roles;
    if (evaluator->stop || function->def->n_formals > LIMIT_ARGUMENTS) return NULL;
    for (uint32_t i = 0; i < function->def->n_formals; i++) {
        bool given = function->by_coordinates ? i < 3 : i == 0;
        roles.inputs[i] = given ? PROGRAM_POINT + (int)i : -1;
        roles.kinds[i] = function->by_coordinates ? VALUE_NUMBER : VALUE_VECTOR3;
    }
    evaluator->quiet = true;
    const Program *program = compile(function, &roles, arena);
    evaluator->quiet = false;
    evaluator->stop = false; /* the evaluation comes to the same limit, and says so */
    return program && program->n_outputs == 1 ? program : NULL;
}

bool formula_evaluate(const EvalFunctionValue *function, const double inputs[PROGRAM_INPUTS],
                      double outputs[PROGRAM_MOST_OUTPUTS])
{
    int roles[LIMIT_ARGUMENTS];
    ValueKind kinds[LIMIT_ARGUMENTS];
    Value values[LIMIT_ARGUMENTS], result;
    if (!find_roles(function, roles, kinds)) return false;
    for (uint32_t i = 0; i < function->def->n_formals; i++) {
        values[i] = (Value){.kind = roles[i] < 0 ? VALUE_UNSET : kinds[i]};
        for (unsigned k = 0; roles[i] >= 0 && k < value_width(kinds[i]); k++)
            values[i].as.v[k] = inputs[roles[i] + (int)k];
    }
    if (!eval_call_function(function, values, &result)) return false;
    for (unsigned i = 0; i < PROGRAM_MOST_OUTPUTS; i++) outputs[i] = result.as.v[result.kind == VALUE_COLOR ? i : 0];
    return result.kind == VALUE_COLOR || result.kind == VALUE_NUMBER;
}

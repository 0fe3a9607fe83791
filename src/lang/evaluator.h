/* evaluator.h - the state of an evaluation, and what the files of the evaluator share.
 * A frame holds the slots of one running def; code at the top of files uses the globals. Frames never outlive their
 * calls, because functions are not values: a block given to a macro is run in the frame of its text while that frame
 * waits below.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EVALUATOR_H
#define MEN_EVALUATOR_H

#include "base/hash.h"
#include "lang/ast.h"
#include "lang/builtin.h"
#include "lang/schema_find.h"

typedef struct Frame Frame;
struct Frame {
    Value *slots;
    Frame *lexical; /* of the def around this one in the text; NULL at the top of a file */
    Frame *caller;
    const Def *def; /* NULL: the top of a file */
    Span call_span;
    Block *children;        /* the block behind the call; NULL */
    Frame *children_frame;  /* in which it runs */
    const DiagChain *chain; /* made when first needed */
    bool has_chain;
};

/* How a property of the node in the making came to its value. */
typedef enum PropState { PROP_UNSET, PROP_INHERITED, PROP_SET, PROP_BAD } PropState;

typedef struct NodeList {
    EvalNode **items;
    size_t n, capacity;
} NodeList;

/* What statements add to: a node in the making, the arguments of a macro that is used like a node, or just a list. */
typedef struct Target Target;
typedef struct PropRoom PropRoom;
struct Target {
    const NodeType *type; /* NULL: no node */
    const Def *def;       /* the macro whose arguments are collected; NULL */
    const EvalNode *base; /* prototype or defaults that values are inherited from; NULL */
    const char *name;     /* for messages */
    Span span;
    PropRoom *room;  /* NULL until a property is set; holds the next three */
    EvalProp *props; /* by row of the type's table */
    PropState *states;
    Span *set_spans;
    Value *args; /* of def, by formal */
    Affine transform;
    NodeList children;
    bool shape_changed;
    const NodeType
        *hidden;      /* the node whose name the scene gave to what this is an instance of, and that it was meant for
                                * by all that can be: of no use where it stands. Or NULL */
    bool has_unknown; /* a property has been reported as unknown */
    bool collects;    /* takes any placed node: the nodes that a macro places */
};

typedef struct Define {
    const char *name;
    Span span;
    Expr *expr;
    Value value;
    bool used;
} Define;

/* node: a declared name, or a type. */
typedef struct Override {
    const char *node, *prop;
    Span node_span, prop_span;
    Expr *expr;
    bool used, reported;
} Override;

typedef struct Preset {
    NodeExpr *node;
    Frame *frame;
} Preset;

typedef struct SlotChunk SlotChunk;

typedef struct Evaluator {
    Diag *diag;
    Arena *arena;
    const EvalOptions *options;
    const Schema *schema;
    EvalLimits limits;
    const double *srgb_to_working;
    double unit_m; /* metres per scene unit */
    Value *globals;
    uint32_t n_globals;
    Frame *frame;
    Target *target;           /* NULL: the top of the scene */
    SlotChunk *chunks;        /* memory of frames */
    PropRoom *rooms;          /* free ones */
    Affine *newest_transform; /* that a builtin made; NULL: none since the present statement began */
    Affine *free_transform;   /* memory for the next one; NULL */
    uint64_t steps, n_nodes;
    uint64_t next_look; /* the step at which limits are looked at again */
    uint32_t calls;     /* now running */
    uint64_t where;     /* a hash of the calls and turns of loops that are running: see EvalNode.identity */
    uintptr_t stack_base;
    bool stop;    /* a limit was reached: unwind */
    bool discard; /* a file in use is run for its names: its nodes are not placed */
    bool in_preset;
    NodeList top;
    EvalNode **singles; /* by row of the schema */
    uint32_t *single_sources;
    Define *defines;
    size_t n_defines;
    Override *overrides;
    size_t n_overrides;
    bool in_override;
    const char *bind_name; /* of the let or var whose value is about to be made; NULL */
    const char *call_name; /* the same, where a function that is about to be called makes it */
    Preset *presets;
    size_t n_presets, preset_capacity;
    EvalParam *params;
    size_t n_params, param_capacity;
    Buf printed;
    void *geometry;     /* of options->geometry; NULL until a question is asked */
    bool quiet;         /* something is tried that may fail: no reports */
    Diagnostic scratch; /* takes the hints of reports that are not made */
} Evaluator;

/* A step down: into turn i of the loop, or the call, that stands at the span. */
static inline uint64_t eval_within(uint64_t where, Span span, uint64_t i)
{
    return hash_u64(hash_u64(where + span.begin) + ((uint64_t)span.source << 48) + i);
}

/* A function that is called when the evaluation is over. */
struct EvalFunctionValue {
    Evaluator *evaluator; /* of its own: the names of the scene as they were */
    const Def *def;
    Frame *lexical;
    Span span;
    bool by_coordinates; /* takes x, y, z, not a point */
};

/* ---- reports (eval.c) ---- */

Diagnostic *eval_report(Evaluator *evaluator, DiagCode code, Span span, const char *format, ...) ATTR_PRINTF(4, 5);
/* The same at an expression: once for each, however often it runs. */
Diagnostic *eval_error(Evaluator *evaluator, Expr *expr, DiagCode code, const char *format, ...) ATTR_PRINTF(4, 5);
/* What stands there in the text, if it is short and without any of the characters; else otherwise. */
const char *eval_written(const Evaluator *evaluator, Span span, size_t longest, const char *without,
                         const char *otherwise);
void eval_hint_truth(Evaluator *evaluator, Diagnostic *report, const Expr *expr); /* a number where a truth is wanted */
/* Of a number where a vector of 3 should stand: whether a name of the scene is in it that hides an axis, which is said. */
bool eval_hint_at_axis(Evaluator *evaluator, Diagnostic *report, const Expr *expr);
const DiagChain *frame_chain(Evaluator *evaluator, Frame *frame);
/* Counts n steps; false, with evaluator->stop, when there were too many or memory is used up. */
bool eval_step(Evaluator *evaluator, Span span);
bool eval_stack_is_deep(Evaluator *evaluator, Span span);
/* Is there room for so many bytes more? false, with evaluator->stop, when not. For what a scene can make large at once. */
bool eval_reserve(Evaluator *evaluator, double bytes, Span span);
bool eval_text_fits(Evaluator *evaluator, size_t length, Span span);

/* ---- expressions (eval_expr.c) ---- */

typedef void EvalFunction(Evaluator *evaluator, Expr *expr, Value *result);
extern EvalFunction *const eval_functions[];

static inline void eval_value(Evaluator *evaluator, Expr *expr, Value *result)
{
    eval_functions[expr->kind](evaluator, expr, result);
}

static inline Frame *eval_lexical(const Evaluator *evaluator, uint32_t hops)
{
    Frame *frame = evaluator->frame;
    for (; hops > 0; hops--) frame = frame->lexical;
    return frame;
}

static inline Value *eval_slot(const Evaluator *evaluator, Slot slot)
{
    if (slot.kind == EXPR_GLOBAL) return &evaluator->globals[slot.index];
    return &eval_lexical(evaluator, slot.hops)->slots[slot.index];
}

/* The value of expr without a copy where it stands somewhere already; else in *room. */
static inline const Value *eval_operand(Evaluator *evaluator, Expr *expr, Value *room)
{
    const Value *value = NULL;
    if (expr->kind == EXPR_CONSTANT) return &expr->as.constant.value;
    if (expr->kind == EXPR_LOCAL)
        value = &evaluator->frame->slots[expr->as.variable.slot.index];
    else if (expr->kind == EXPR_GLOBAL)
        value = &evaluator->globals[expr->as.variable.slot.index];
    if (value && value->kind != VALUE_UNSET) return value;
    eval_value(evaluator, expr, room);
    return room;
}

/* A condition; false (and *poison) when it has no truth. */
bool eval_condition(Evaluator *evaluator, Expr *expr, bool *poison);
/* The list or range to loop over; false after a report. */
bool eval_sequence(Evaluator *evaluator, Expr *expr, Value *value);

/* ---- calls (eval_call.c) ---- */

EvalFunction eval_call_def, eval_call_builtin, eval_call_term;
/* The medium or the like that a function makes is named so, if the expression, which is evaluated next, is a call of one. */
void eval_name_result(Evaluator *evaluator, const Expr *expr, const char *name);
/* That a def has no parameter of that name. given: bit i where formal i, of the first 64, has its argument already, so that it is
 * not the one that is meant. */
void eval_report_formal(Evaluator *evaluator, const Def *def, uint64_t given, const char *wrong, Span span);
/* The function that an EXPR_FUNCTION names, with all that is visible in it as it is now; NULL after a report.
 * on_surface: it is asked for places on a surface, not for points. */
const EvalFunctionValue *eval_capture(Evaluator *evaluator, Expr *expr, bool on_surface);
/* Whether it is a function of a place on a surface (formula.c). */
bool eval_takes_place(const EvalFunctionValue *function);
/* Calls it when the evaluation is over, with an argument for each parameter, VALUE_UNSET for its default; false after a
 * report. */
bool eval_call_function(const EvalFunctionValue *function, const Value *args, Value *result);
/* Calls a macro with the arguments of expr; block: its children. */
void eval_call_macro(Evaluator *evaluator, Expr *expr, Block *block);
/* Calls a macro with ready arguments (VALUE_UNSET: not given). */
void eval_call_macro_values(Evaluator *evaluator, const Def *def, uint32_t hops, const Value *args, Span span);
/* Does value have the type that a formal or param asks for? type: its name. Reports when not. */
bool eval_type_allows(Evaluator *evaluator, Symbol *type, Span type_span, const Value *value, Span span,
                      const char *name);

/* ---- statements (eval_stmt.c) ---- */

void eval_block(Evaluator *evaluator, const Block *block);

/* ---- nodes (eval_node.c) ---- */

EvalFunction eval_node_expr;
void eval_node_stmt(Evaluator *evaluator, Stmt *stmt);
void eval_defaults_stmt(Evaluator *evaluator, Stmt *stmt);
void eval_prop_stmt(Evaluator *evaluator, Stmt *stmt);
/* Settings that the scene does not write but --set changes. */
void eval_missing_overrides(Evaluator *evaluator);
/* Places an instance of a node that a function returned. */
void eval_place_value(Evaluator *evaluator, const EvalNode *node, Span span);

/* ---- properties (schema.c) ---- */

/* Checks the value of expr for a property and converts it. False after a report, or for poison. The value none leaves
 * a property unset: prop->type is NULL then. */
bool prop_check(Evaluator *evaluator, const PropType *type, Expr *expr, EvalProp *prop);

/* ---- files (find.c) ---- */

/* Like eval_find_file, but also finds the built-in texts, before the data directory: then the result is NULL and
 * *library set. A built-in text finds others before any file, so that a scene cannot get between them. */
const char *find_import(const EvalOptions *options, Diag *diag, Span span, const char *name,
                        const EvalLibraryFile **library);

#endif

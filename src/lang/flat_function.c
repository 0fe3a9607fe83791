/* flat_function.c - see flat_function.h.
 *
 * A function is written from its tree: names of its own stay as they are, names of the scene around it become the values
 * that they had when the property took the function, and functions that it calls become defs of their own. A def that two
 * properties take, or that is the same wherever it is called, is written once.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/flat_function.h"

#include <string.h>

#include "lang/builtin.h"
#include "lang/evaluator.h"

/* A def, as it is seen from one place: the values around it belong to it. */
struct FlatDef {
    FlatDef *next;
    const Def *def;
    const Frame *lexical;
    const Evaluator *evaluator;
    const char *name, *text; /* text: behind the name; NULL while it is being made */
};

/* How tightly an expression holds together; what is looser than its place asks for stands in parentheses. */
typedef enum Bond {
    BOND_LOOSE,
    BOND_CONDITION,
    BOND_OR,
    BOND_AND,
    BOND_NOT,
    BOND_COMPARE,
    BOND_ADD,
    BOND_MULTIPLY,
    BOND_UNARY,
    BOND_POWER,
    BOND_POST
} Bond;

/* The writing of one def. */
typedef struct Writer {
    FlatFunctions *functions;
    const EvalFunctionValue *value;
    const Frame *lexical; /* around the def */
    Buf *out;
    unsigned depth;
    bool failed;
} Writer;

enum { DEEPEST = 400 };

static const char *def_name(FlatFunctions *functions, const EvalFunctionValue *value, const Def *def,
                            const Frame *lexical, unsigned depth);
static void write_expr(Writer *writer, const Expr *expr, Bond bond);

static void refuse(Writer *writer, const char *what)
{
    if (!writer->failed)
        diag_report(writer->functions->diag, D_NOT_FLAT, writer->value->span,
                    "'%s' uses %s, and a flat function has none", writer->value->def->name->text, what);
    writer->failed = true;
}

static Bond bond_of_value(const Value *value)
{
    if (value->kind == VALUE_NUMBER && (value->as.number < 0 || (value->as.number == 0 && 1 / value->as.number < 0)))
        return BOND_UNARY;
    return value->kind == VALUE_RANGE ? BOND_LOOSE : BOND_POST;
}

/* A value that a text can have; its lists hold nothing else either. */
static bool can_be_written(const Value *value)
{
    switch (value->kind) {
    case VALUE_NONE:
    case VALUE_NUMBER:
    case VALUE_BOOL:
    case VALUE_STRING:
    case VALUE_VECTOR2:
    case VALUE_VECTOR3:
    case VALUE_VECTOR4:
    case VALUE_COLOR:
    case VALUE_RANGE: return value_is_finite(value);
    case VALUE_LIST:
        for (size_t i = 0; i < value_count(value); i++) {
            Value element = value_element(value, i);
            if (!can_be_written(&element)) return false;
        }
        return true;
    default: return false;
    }
}

static void write_value(Writer *writer, const Value *value, Bond bond)
{
    if (!can_be_written(value)) {
        refuse(writer, value->kind == VALUE_UNSET ? "a name whose declaration has not been reached"
                                                  : value_describe(writer->functions->diag->arena, value));
        return;
    }
    bool aside = bond_of_value(value) < bond;
    if (aside) buf_add(writer->out, "(");
    value_print(writer->out, value, VALUE_QUOTED);
    if (aside) buf_add(writer->out, ")");
}

static void write_args(Writer *writer, const Args *args)
{
    for (uint32_t i = 0; i < args->n; i++) {
        if (i) buf_add(writer->out, ", ");
        if (args->items[i].name) buf_format(writer->out, "%s = ", args->items[i].name->text);
        write_expr(writer, args->items[i].value, BOND_LOOSE);
    }
}

static void write_items(Writer *writer, const Expr *expr, const char *open, const char *close, Bond bond)
{
    buf_add(writer->out, open);
    for (uint32_t i = 0; i < expr->as.list.n; i++) {
        if (i) buf_add(writer->out, ", ");
        write_expr(writer, expr->as.list.items[i], bond);
    }
    buf_add(writer->out, close);
}

typedef struct Infix {
    Bond own, left, right;
    const char *text;
} Infix;

static bool infix_of(const Expr *expr, Infix *infix)
{
    static const Infix of[] = {
        [EXPR_ADD] = {BOND_ADD, BOND_ADD, BOND_MULTIPLY, " + "},
        [EXPR_SUBTRACT] = {BOND_ADD, BOND_ADD, BOND_MULTIPLY, " - "},
        [EXPR_MULTIPLY] = {BOND_MULTIPLY, BOND_MULTIPLY, BOND_UNARY, " * "},
        [EXPR_DIVIDE] = {BOND_MULTIPLY, BOND_MULTIPLY, BOND_UNARY, " / "},
        [EXPR_MODULO] = {BOND_MULTIPLY, BOND_MULTIPLY, BOND_UNARY, " % "},
        [EXPR_POWER] = {BOND_POWER, BOND_POST, BOND_UNARY, " ^ "},
        [EXPR_EQUAL] = {BOND_COMPARE, BOND_ADD, BOND_ADD, " == "},
        [EXPR_NOT_EQUAL] = {BOND_COMPARE, BOND_ADD, BOND_ADD, " != "},
        [EXPR_LESS] = {BOND_COMPARE, BOND_ADD, BOND_ADD, " < "},
        [EXPR_LESS_EQUAL] = {BOND_COMPARE, BOND_ADD, BOND_ADD, " <= "},
        [EXPR_GREATER] = {BOND_COMPARE, BOND_ADD, BOND_ADD, " > "},
        [EXPR_GREATER_EQUAL] = {BOND_COMPARE, BOND_ADD, BOND_ADD, " >= "},
        [EXPR_AND] = {BOND_AND, BOND_AND, BOND_NOT, " and "},
        [EXPR_OR] = {BOND_OR, BOND_OR, BOND_AND, " or "},
        [EXPR_RANGE] = {BOND_LOOSE, BOND_CONDITION, BOND_CONDITION, ".."},
    };
    if ((size_t)expr->kind >= sizeof of / sizeof *of || !of[expr->kind].text) return false;
    *infix = of[expr->kind];
    if (expr->kind == EXPR_RANGE && expr->as.op.open) infix->text = "..<";
    return true;
}

static Bond bond_of(const Expr *expr)
{
    Infix infix;
    if (infix_of(expr, &infix)) return infix.own;
    switch (expr->kind) {
    case EXPR_LET: return BOND_LOOSE;
    case EXPR_CONDITION: return BOND_CONDITION;
    case EXPR_NOT: return BOND_NOT;
    case EXPR_NEGATE:
    case EXPR_PLUS: return BOND_UNARY;
    default: return BOND_POST; /* of values: see write_value */
    }
}

static void write_call(Writer *writer, const Expr *expr)
{
    const char *name = expr->as.call.name;
    if (expr->kind == EXPR_CALL_BUILTIN) name = expr->as.call.to.builtin->name;
    if (expr->kind == EXPR_CALL_DEF) {
        const Def *def = expr->as.call.to.def;
        const Frame *lexical = writer->lexical; /* a function has no frames of defs within it */
        if (def->level && expr->as.call.hops == 0) {
            refuse(writer, "a function within it");
            return;
        }
        for (uint32_t hops = expr->as.call.hops; def->level && hops > 1; hops--) lexical = lexical->lexical;
        name = def_name(writer->functions, writer->value, def, def->level ? lexical : NULL, writer->depth);
        if (!name) {
            writer->failed = true;
            return;
        }
    }
    buf_format(writer->out, "%s(", name);
    write_args(writer, &expr->as.call.args);
    buf_add(writer->out, ")");
}

static void write_outer(Writer *writer, const Expr *expr, Bond bond)
{
    const Slot *slot = &expr->as.variable.slot;
    const Value *value = &writer->value->evaluator->globals[slot->index];
    if (expr->kind == EXPR_OUTER) {
        const Frame *frame = writer->lexical;
        for (uint32_t hops = slot->hops; hops > 1; hops--) frame = frame->lexical;
        value = &frame->slots[slot->index];
    }
    write_value(writer, value, bond);
}

static void write_operators(Writer *writer, const Expr *expr)
{
    Infix infix;
    Buf *out = writer->out;
    if (infix_of(expr, &infix)) {
        write_expr(writer, expr->as.op.a, infix.left);
        buf_add(out, infix.text);
        write_expr(writer, expr->as.op.b, infix.right);
        if (expr->kind != EXPR_RANGE || !expr->as.op.c) return;
        buf_add(out, " by ");
        write_expr(writer, expr->as.op.c, BOND_CONDITION);
    } else if (expr->kind == EXPR_CONDITION) {
        write_expr(writer, expr->as.op.a, BOND_OR);
        buf_add(out, " ? ");
        write_expr(writer, expr->as.op.b, BOND_LOOSE);
        buf_add(out, " : ");
        write_expr(writer, expr->as.op.c, BOND_LOOSE);
    } else {
        buf_add(out, expr->kind == EXPR_NOT ? "not " : expr->kind == EXPR_NEGATE ? "-" : "+");
        write_expr(writer, expr->as.op.a, expr->kind == EXPR_NOT ? BOND_NOT : BOND_UNARY);
    }
}

static void write_bare(Writer *writer, const Expr *expr)
{
    Buf *out = writer->out;
    switch (expr->kind) {
    case EXPR_LOCAL: buf_add(out, expr->as.variable.symbol->text); break;
    case EXPR_NAME: buf_add(out, expr->as.name.symbol->text); break;
    case EXPR_VECTOR: write_items(writer, expr, "<", ">", BOND_ADD); break;
    case EXPR_LIST: write_items(writer, expr, "[", "]", BOND_LOOSE); break;
    case EXPR_LET:
        buf_add(out, "let (");
        write_args(writer, &expr->as.let.bindings);
        buf_add(out, ") ");
        write_expr(writer, expr->as.let.body, BOND_LOOSE);
        break;
    case EXPR_CALL_DEF:
    case EXPR_CALL_BUILTIN:
    case EXPR_CALL_TERM: write_call(writer, expr); break;
    case EXPR_MEMBER:
    case EXPR_FIELD:
        write_expr(writer, expr->as.member.base, BOND_POST);
        buf_format(out, ".%s", expr->as.member.name->text);
        break;
    case EXPR_INDEX:
        write_expr(writer, expr->as.op.a, BOND_POST);
        buf_add(out, "[");
        write_expr(writer, expr->as.op.b, BOND_LOOSE);
        buf_add(out, "]");
        break;
    case EXPR_EACH: buf_format(out, "for (%s in ", expr->as.each.name->text); goto element;
    case EXPR_WHEN:
        buf_add(out, "if (");
    element:
        write_expr(writer, expr->as.each.source, BOND_LOOSE);
        buf_add(out, ") ");
        write_expr(writer, expr->as.each.body, BOND_LOOSE);
        break;
    case EXPR_NODE: refuse(writer, "a node"); break;
    default: write_operators(writer, expr); break;
    }
}

static void write_expr(Writer *writer, const Expr *expr, Bond bond)
{
    if (writer->failed) return;
    if (expr->kind == EXPR_CONSTANT) {
        write_value(writer, &expr->as.constant.value, bond);
    } else if (expr->kind == EXPR_GLOBAL || expr->kind == EXPR_OUTER) {
        write_outer(writer, expr, bond);
    } else if (++writer->depth > DEEPEST) {
        refuse(writer, "more than 400 operations within each other");
    } else {
        bool aside = bond_of(expr) < bond;
        if (aside) buf_add(writer->out, "(");
        write_bare(writer, expr);
        if (aside) buf_add(writer->out, ")");
        writer->depth--;
    }
}

/* "(a, b = 2) = a + b" */
static void write_def(Writer *writer, const Def *def)
{
    buf_add(writer->out, "(");
    for (uint32_t i = 0; i < def->n_formals; i++) {
        const Formal *formal = &def->formals[i];
        buf_format(writer->out, i ? ", %s" : "%s", formal->name->text);
        if (formal->type) buf_format(writer->out, ": %s", formal->type->text);
        if (!formal->fallback) continue;
        buf_add(writer->out, " = ");
        write_expr(writer, formal->fallback, BOND_LOOSE);
    }
    buf_add(writer->out, ") = ");
    write_expr(writer, def->body, BOND_LOOSE);
}

static const char *def_name(FlatFunctions *functions, const EvalFunctionValue *value, const Def *def,
                            const Frame *lexical, unsigned depth)
{
    for (const FlatDef *known = functions->defs; known; known = known->next)
        if (known->def == def && known->lexical == lexical && known->evaluator == value->evaluator) return known->name;
    Arena *arena = functions->diag->arena;
    FlatDef *own = ARENA_NEW(arena, FlatDef);
    *own = (FlatDef){functions->defs,
                     def,
                     lexical,
                     value->evaluator,
                     functions->new_name(functions->context, def->name->text),
                     NULL};
    functions->defs = own;
    Buf text = {0};
    Writer writer = {.functions = functions, .value = value, .lexical = lexical, .out = &text, .depth = depth};
    write_def(&writer, def);
    functions->out->failed |= text.failed;
    own->text = writer.failed || text.failed ? NULL : arena_format(arena, "%s", buf_text(&text));
    buf_clear(&text);
    if (!own->text) return NULL;
    for (const FlatDef *known = own->next; known; known = known->next)
        if (known->def == def && known->text && strcmp(known->text, own->text) == 0) return own->name = known->name;
    buf_format(functions->out, "def %s%s\n", own->name, own->text);
    return own->name;
}

const char *flat_function(FlatFunctions *functions, const EvalFunctionValue *function)
{
    return def_name(functions, function, function->def, function->lexical, 0);
}

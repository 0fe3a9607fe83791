/* ast.h - the tree of a file. The parser writes it, the resolver turns names into slots in place, and the evaluator
 * walks it. All of it lives in the arena.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_AST_H
#define MEN_AST_H

#include "lang/lex.h"
#include "diag/limits.h"
#include "lang/value.h"

typedef struct Expr Expr;
typedef struct Stmt Stmt;
typedef struct Block Block;
typedef struct Def Def;
typedef struct File File;
typedef struct Builtin Builtin;

typedef enum ExprKind {
    EXPR_POISON, /* its mistake has been reported */
    EXPR_CONSTANT,
    EXPR_NAME,   /* before resolving; afterwards only a bare word that is no name */
    EXPR_GLOBAL, /* a slot of a file */
    EXPR_LOCAL,  /* a slot of the running def */
    EXPR_OUTER,  /* a slot of a def around the running one */
    EXPR_VECTOR,
    EXPR_LIST,
    EXPR_NEGATE,
    EXPR_PLUS,
    EXPR_NOT,
    EXPR_ADD, /* ORDER ARITHMETIC: EXPR_ADD .. EXPR_POWER, EXPR_EQUAL .. EXPR_GREATER_EQUAL */
    EXPR_SUBTRACT,
    EXPR_MULTIPLY,
    EXPR_DIVIDE,
    EXPR_MODULO,
    EXPR_POWER,
    EXPR_EQUAL,
    EXPR_NOT_EQUAL,
    EXPR_LESS,
    EXPR_LESS_EQUAL,
    EXPR_GREATER,
    EXPR_GREATER_EQUAL,
    EXPR_AND,
    EXPR_OR,
    EXPR_CONDITION, /* a ? b : c */
    EXPR_LET,
    EXPR_RANGE,
    EXPR_CALL,     /* before resolving */
    EXPR_FUNCTION, /* the name of a function as the value of a property; in as.call */
    EXPR_CALL_DEF,
    EXPR_CALL_BUILTIN,
    EXPR_CALL_TERM,
    EXPR_MEMBER, /* before resolving; afterwards a swizzle */
    EXPR_FIELD,  /* a member of a record */
    EXPR_INDEX,
    EXPR_NODE,
    EXPR_EACH, /* elements of a list only: for (name in list) element */
    EXPR_WHEN  /* elements of a list only: if (condition) element */
} ExprKind;

/* Which slot a name stands for. hops: how many defs outward, for EXPR_OUTER. */
typedef struct Slot {
    ExprKind kind; /* EXPR_GLOBAL, EXPR_LOCAL, EXPR_OUTER */
    uint32_t index, hops;
} Slot;

typedef struct Arg {
    Symbol *name; /* NULL for a positional one */
    Span name_span;
    Expr *value;
} Arg;

typedef struct Args {
    Arg *items;
    uint32_t n;
} Args;

/* a name with dots, as far as it was written */
typedef struct Path {
    Symbol *names[4];
    uint32_t n;
    Span span;
} Path;

typedef struct NodeExpr NodeExpr;
struct NodeExpr {
    Path path;
    Symbol *name; /* declared; NULL */
    Span name_span;
    Block *block;
    const NodeType *type;     /* resolved: the built-in type, NULL when only a prototype or macro can be meant */
    const NodeType *declares; /* resolved: what it is of, where that is nowhere by itself, as a medium; else NULL */
    bool has_prototype;
    Slot prototype;      /* resolved: the slot that may hold a prototype */
    Span prototype_span; /* and where its name is declared */
    Def *def;            /* resolved: the macro that is used like a node */
    uint32_t def_hops;
    Slot name_slot;   /* resolved: of the declared name */
    bool has_unknown; /* a property has been reported as unknown: it may be one that is missing */
    bool has_defaults;
    Slot defaults; /* resolved: the slot of the defaults that are in force for type */
};

struct Expr {
    ExprKind kind;
    bool reported; /* a mistake of this expression has been reported: once is enough, also in a loop */
    bool literal;  /* EXPR_CONSTANT as written, not a name or a computed value */
    Span span;
    union {
        struct {
            Value value;
            const UnitType *unit; /* of a literal number */
        } constant;
        struct {
            Symbol *symbol;
            const char *nearest; /* resolved: did-you-mean for a bare word that is no name */
        } name;
        struct {
            Slot slot;
            Symbol *symbol;
        } variable;
        struct {
            Expr *a, *b, *c; /* operands; of a range: first, last, step or NULL */
            bool open;       /* of a range: ..< */
        } op;
        struct {
            Expr **items;
            uint32_t n;
        } list; /* EXPR_VECTOR, EXPR_LIST */
        struct {
            Args args;
            Expr *callee; /* before resolving */
            const char *name;
            union {
                Def *def;
                const Builtin *builtin;
                const TermType *term;
            } to;
            uint32_t hops;
        } call;
        struct {
            Expr *base;
            Symbol *name;
            Span name_span;
            uint8_t n, component[4];
        } member;
        struct {
            Args bindings;
            Slot *slots;
            Expr *body;
        } let;
        struct {
            Symbol *name; /* EXPR_EACH */
            Span name_span;
            Slot slot;
            Expr *source; /* the list, or the condition */
            Expr *body;
        } each;
        NodeExpr *node;
    } as;
};

typedef enum StmtKind {
    STMT_EMPTY, /* also what a mistake leaves */
    STMT_BIND,
    STMT_ASSIGN,
    STMT_PROP,
    STMT_CALL,
    STMT_NODE,
    STMT_KIDS,
    STMT_PARAM,
    STMT_DEF,
    STMT_DEFAULTS,
    STMT_IF,
    STMT_FOR,
    STMT_WHILE,
    STMT_IMPORT,
    STMT_PRESET
} StmtKind;

typedef struct Formal {
    Symbol *name, *type;
    Span span, type_span;
    Expr *fallback; /* NULL: the argument must be given */
    Slot slot;
} Formal;

struct Def {
    Symbol *name;
    Span span;
    Formal *formals;
    uint32_t n_formals;
    Expr *body;   /* of a function */
    Block *block; /* of a macro */
    uint32_t n_slots;
    uint32_t level; /* of the def itself: 0 at the top of a file */
    bool calls_children;
    bool declared; /* while resolving: the statement itself has been reached */
};

/* a name that a file offers to others */
typedef struct Export {
    Symbol *symbol;
    struct Binding *binding;
} Export;

struct Block {
    Stmt *first;
    Span span; /* of the '{' */
};

/* A STMT_PROP or STMT_NODE has no more memory than its own member needs (stmt_size in parse.c): it may become
 * STMT_EMPTY, and nothing larger. */
struct Stmt {
    StmtKind kind;
    bool reported;
    Span span; /* of its first word */
    Stmt *next;
    union {
        struct {
            Symbol *name, *type;
            Span name_span, type_span;
            bool variable; /* var */
            bool at_top;   /* of a file, and so there once */
            Slot slot;
            Expr *value;
            Expr *range;     /* of a param */
            const char *doc; /* of a param */
        } bind;              /* STMT_BIND, STMT_ASSIGN, STMT_PARAM */
        struct {
            Symbol *name;
            Expr *value;
            const NodeType *node_type; /* the type for which prop was last looked up */
            const PropType *prop;
        } prop;
        struct {
            Path path;
            Expr *call; /* EXPR_CALL and what it becomes */
            Block *block;
        } call;
        NodeExpr *node; /* STMT_NODE, STMT_DEFAULTS, STMT_PRESET */
        Def *def;
        Args kids;
        struct {
            Expr *condition;
            Block *then, *otherwise;
        } branch; /* STMT_IF, STMT_WHILE */
        struct {
            Symbol *name;
            Span name_span;
            Slot slot;
            Expr *source;
            Block *block;
        } loop;
        struct {
            const char *text;
            Span text_span;
            Symbol *name; /* use ... as name */
            Span name_span;
            bool include;
            bool used;  /* something that it brought is */
            File *file; /* NULL after a mistake */
        } import;
    } as;
};

/* a file once it is read */
struct File {
    File *next;
    uint32_t source;
    const char *path; /* NULL for texts that are no files */
    Arena *arena; /* for its tree; NULL: that of the reports. Of its own for only_starts: it is reset again and again */
    Block *block;
    double version;
    bool has_unit;
    Span unit_span;
    double unit_m;
    Stmt **imports; /* in order of the text, wherever they stand */
    uint32_t n_imports, capacity;
    bool only_starts; /* asks the parser for the next two, and no tree; starts is malloc'd */
    uint32_t *starts; /* the first byte of each statement, in order of the text */
    size_t n_starts, starts_capacity;
    int state; /* FILE_NEW ... */
    const DiagChain *chain;
    Export *exports;
    uint32_t n_exports;
    bool evaluated; /* by a use */
};
enum { FILE_NEW, FILE_OPEN, FILE_RESOLVED };

#endif

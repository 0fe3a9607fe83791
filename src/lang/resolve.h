/* resolve.h - names to slots, before anything runs. After this no name is looked up by its letters any more.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RESOLVE_H
#define MEN_RESOLVE_H

#include "lang/ast.h"

typedef enum BindingKind { BINDING_SLOT, BINDING_DEF, BINDING_MODULE } BindingKind;

typedef struct Binding Binding;
typedef struct Scope Scope;

/* One declaration while names are resolved. */
struct Binding {
    Binding *shadowed; /* what the symbol meant before */
    Binding *next_in_scope;
    const Scope *scope;
    Symbol *symbol;
    BindingKind kind;
    bool has_span, variable, used, warns;
    bool constant; /* declared by let */
    bool param;
    bool poison; /* by a statement that was wrong: whatever uses it is silent */
    Span span;
    uint32_t level, index; /* BINDING_SLOT */
    Def *def;
    File *module;
    const NodeType *declares; /* as a NodeExpr does */
    bool prototype;           /* of what is placed, by let */
    const NodeExpr *defaults; /* of a type's defaults; else NULL */
    const File *from;         /* that a use without a name brought it from; NULL: declared here */
    Stmt *import;             /* that brought it: by its name, or one of its names; NULL: declared here */
};

/* Which slots the predeclared names have: the first of the globals. */
enum {
    PREDECLARED_CLOCK,
    PREDECLARED_FRAME,
    PREDECLARED_FRAMES,
    PREDECLARED_TIME,
    PREDECLARED_X,
    PREDECLARED_Y,
    PREDECLARED_Z,
    PREDECLARED_PI,
    PREDECLARED_COUNT
};
extern const char *const predeclared_names[PREDECLARED_COUNT];
/* The words that mean something in every scene, which no name should hide: types, terms, functions, keywords and predeclared names.
 * NULL behind the last. */
const char *language_word_at(const Schema *schema, size_t i);

/* What a statement stands in, as far as the text says. */
typedef enum NodeContext { CONTEXT_FREE, CONTEXT_NODE, CONTEXT_MACRO } NodeContext;

typedef struct Resolver {
    Diag *diag;
    Arena *arena;
    SymbolTable *symbols;
    const Schema *schema;
    const double *srgb_to_working; /* 9, or NULL for the identity */
    Scope *scope;
    uint32_t level;   /* how many defs around */
    uint32_t n_slots; /* of the def being resolved */
    uint32_t n_globals;
    Def *def; /* the innermost macro or function */
    NodeContext context;
    const NodeType *context_type; /* CONTEXT_NODE: NULL when it is not known before running */
    NodeExpr *context_node;       /* CONTEXT_NODE: the node around the statement */
    /* the property whose value is resolved, where it takes words of a choice, or a text and gets a name; else NULL */
    const PropType *word_prop;
    bool for_texture;  /* what is resolved is the value of a property that takes textures */
    const Stmt *call;  /* the call of a macro in whose block it is; NULL: in none */
    Symbol **defaults; /* by row of the schema: the name of the slot of a type's defaults; NULL until there are any */
    const struct EvalLibrary *library; /* files of the program, for hints; NULL: none */
    bool warns_unused;                 /* of names at the top of the present file */
    bool library_itself;               /* it only declares, for others */
    Expr **late;                       /* expressions that see all that the scene declares at its top (--set) */
    size_t n_late;
    const struct EvalPassedBy *passed_by; /* calls that defaults do not reach into */
    unsigned n_unchanged;                 /* statements that were to change something, and were refused */
} Resolver;

void resolver_init(Resolver *resolver, Diag *diag, SymbolTable *symbols, const Schema *schema,
                   const double *srgb_to_working);
/* Whether anything asks for that predeclared name, of all that has been resolved. */
bool resolver_uses(const Resolver *resolver, int name);
/* The prelude first; its names stay visible for all files. */
void resolve_prelude(Resolver *resolver, File *prelude);
/* Files that it imports first. warns_unused: the file itself is the scene. */
void resolve_file(Resolver *resolver, File *file, bool warns_unused);
/* An expression outside of all files (-D): only predeclared names and the prelude's. A bare word that is no name
 * stays EXPR_NAME. */
void resolve_define(Resolver *resolver, Expr *expr);

/* Linear sRGB (decoded) to the working space of the scene, in place. */
void color_from_srgb(const double *srgb_to_working, double rgb[3]);
double srgb_decode(double encoded);

/* resolve_expr.c, for resolve.c */
void resolve_expr(Resolver *resolver, Expr *expr);
/* Where a property takes a function: the name of one, also of a file in use; all else as resolve_expr does. */
void resolve_function(Resolver *resolver, Expr *expr);
void resolve_node(Resolver *resolver, NodeExpr *node, bool expression);
void resolve_block(Resolver *resolver, Block *block);
void scope_begin(Resolver *resolver);
void scope_end(Resolver *resolver);
void binding_use(Binding *binding); /* notes that something uses it */
Slot scope_declare_slot(Resolver *resolver, Symbol *symbol, Span span);
Slot slot_of(const Resolver *resolver, const Binding *binding);
void resolve_defaults_of(Resolver *resolver, NodeExpr *node);
/* Notes which defaults stand above a call of a macro, all of which pass it by. */
void resolve_passed_by(Resolver *resolver, Span call, const Def *macro);
void suggest_visible(Resolver *resolver, Diagnostic *report, const Symbol *wrong, bool functions, bool nodes);
/* Notes where an unknown name is declared after all, further down; false when it is not. */
bool note_later_declaration(Resolver *resolver, Diagnostic *report, const Symbol *symbol);
/* A hint at a name like the wrong one that is declared behind the place, with a note on where. */
void suggest_later(Resolver *resolver, Diagnostic *report, const Symbol *wrong);
const char *nearest_visible(Resolver *resolver, const Symbol *wrong);
/* Hints at the name where a file of the library has it; medium: as a value, before its macros and functions. */
bool hint_at_library(Resolver *resolver, Diagnostic *report, const char *name, bool medium);
/* A file in use has no such name: the report, with what may be meant. */
void report_not_exported(Resolver *resolver, Span span, const File *file, const Symbol *symbol);

/* What to write in place of "ball.radius". */
void hint_at_reading(Diag *diag, Diagnostic *report, const char *property);

#endif

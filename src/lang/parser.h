/* parser.h - what parse.c and parse_expr.c share. Each function is named after the nonterminal that it reads.
 * The parser looks one token ahead. After a mistake it is in panic: it reports nothing more until the statement loop
 * of a block has found a place to go on from.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PARSER_H
#define MEN_PARSER_H

#include "lang/parse.h"

/* Nesting of blocks and of brackets together; bounds the C stack of the parser and of everything that walks the tree. */
enum { DEEPEST_NESTING = 200 };

typedef struct Parser {
    Lexer lexer;
    Token token; /* the next one, not yet consumed */
    Diag *diag;
    Arena *arena;
    File *file;
    double unit_m;
    int depth;    /* of nesting */
    int brackets; /* open ( [ < of the statement */
    bool panic;
    bool fatal;   /* gave up on this file */
} Parser;

void parser_init(Parser *parser, File *file, uint32_t source, double unit_m, Diag *diag, SymbolTable *symbols);

/* -- tokens -- */
void advance(Parser *parser);
bool accept(Parser *parser, TokenKind kind);
/* Consumes a token of that kind, or reports that it is expected behind the previous token. */
bool expect(Parser *parser, TokenKind kind, const char *context);
/* Consumes a closing bracket, or reports it as missing with a note on the opening one. */
bool expect_close(Parser *parser, TokenKind kind, Span opening, const char *expected);
bool expect_name(Parser *parser, const char *context, Symbol **name, Span *span);
Token peek(const Parser *parser); /* the token behind the next one */
Span token_span(const Parser *parser);
Span span_from(const Parser *parser, Span begin); /* from begin to the end of the last consumed token */
/* Starts panic. NULL when in panic already: there is nothing to add a hint to. */
Diagnostic *syntax_error(Parser *parser, Span span, const char *format, ...) ATTR_PRINTF(3, 4);
Diagnostic *expected_error(Parser *parser, const char *expected);
/* Counts one level of nesting; false, and the end of this file, when it is too deep. Pairs with leave. */
bool enter(Parser *parser);
void leave(Parser *parser);

/* -- nonterminals -- */
Block *parse_block(Parser *parser);
Expr *parse_expr(Parser *parser);
Expr *parse_tern(Parser *parser);
Args parse_args(Parser *parser, Span opening); /* behind the '(' */
Path parse_path(Parser *parser);
Expr *expr_new(Parser *parser, ExprKind kind, Span span);

#endif

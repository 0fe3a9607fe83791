/* parser.h - the state of a parser, and what its files share. Functions that read a nonterminal are named after it.
 * The parser looks one token ahead. After a mistake it is in panic: it reports nothing more until the statement loop
 * of a block has found a place to go on from.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PARSER_H
#define MEN_PARSER_H

#include "diag/limits.h"
#include "lang/parse.h"

/* What indentation says of braces: kept on the way, and believed only when they do not match. */
typedef struct Indents {
    bool missing, extra; /* is there such a place? */
    Span opening;        /* of a block behind which a statement stands as far left as the block itself */
    uint32_t missing_at; /* where its '}' seems to be missing */
    Span extra_close;    /* a '}' behind which the lines go on as if it were not there */
} Indents;

typedef struct Parser {
    Lexer lexer;
    Token token; /* the next one, not yet consumed */
    Diag *diag;
    Arena *arena;
    File *file;
    double unit_m;
    int depth;          /* of nesting */
    int brackets;       /* open ( and [ of the statement */
    int panic_brackets; /* of them, at the mistake */
    int calm;           /* tokens consumed since the last report, of whatever kind */
    uint32_t n_errors;  /* seen so far */
    int blocks;         /* open { of statements */
    TokenKind previous; /* of the last consumed token */
    const char *node;   /* the word of the node whose block is being read; NULL at
                           the top of a file and in a def */
    bool panic;
    bool fatal;          /* gave up on this file */
    bool swallowed;      /* the last consumed token is a string that goes on to the end of its line */
    bool no_blocks;      /* a '{' belongs to the statement, not to the expression: 'if a {' */
    bool comma_reported; /* in this block */
    bool mirror_told;    /* that POV-Ray's z points the other way */
    int directives;      /* open ones of POV-Ray */
    int looks;           /* far ahead */
    Indents indents;
} Parser;

void parser_init(Parser *parser, File *file, uint32_t source, double unit_m, Diag *diag, SymbolTable *symbols);

/* -- tokens -- */
void consume(Parser *parser);
bool consume_if(Parser *parser, TokenKind kind);
/* Consumes a token of that kind, or reports that it is expected behind the previous token. */
bool expect(Parser *parser, TokenKind kind, const char *context);
/* Consumes a closing bracket, or reports it as missing with a note on the opening one. */
bool expect_close(Parser *parser, TokenKind kind, Span opening, const char *expected);
/* What the elements of a vector have no room for, since '>' ends them; and what is said of it. */
bool begins_comparison(TokenKind kind);
#define WITHIN_VECTOR "within < > a comparison, '?', 'and' or 'or' stands in parentheses"
bool expect_name(Parser *parser, const char *context, Symbol **name, Span *span);
bool begins_value(TokenKind kind); /* a constant or a list: a name may begin something else */
bool starts_value(const Parser *parser);
void skip_brackets(Parser *parser); /* the next token is the opening one, of whatever kind */
bool first_on_line(const Parser *parser);
bool begins_line(const Parser *parser, uint32_t at); /* do only blanks stand in front of that byte, on its line? */
uint32_t consumed_end(const Parser *parser);         /* where the last consumed token ends */
const char *found_text(const Parser *parser);        /* the next token, for a message */
Span token_span(const Parser *parser);
Span span_from(const Parser *parser, Span begin); /* from begin to the end of the last consumed token */
/* Starts panic. NULL when in panic already: there is nothing to add a hint to. */
Diagnostic *syntax_error(Parser *parser, Span span, const char *format, ...) ATTR_PRINTF(3, 4);
Diagnostic *limit_error(Parser *parser, Limit limit); /* a syntax error, at the next token */
void calm_down(Parser *parser);                       /* what comes next is a mistake of its own */
/* A report of the parser; a scratch one that is not kept so near behind another that it is most likely about the same. */
Diagnostic *parser_report(Parser *parser, DiagCode code, Span span, const char *text);
Diagnostic *expected_error(Parser *parser, const char *expected);
/* Counts one level of nesting, of blocks and brackets together, which bounds the C stack of the parser and of all that
 * walks the tree; false, and the end of this file, when it is too deep. Pairs with leave. */
bool enter(Parser *parser);
void leave(Parser *parser);

/* Skips to where a statement of the present block may begin. brackets: how many were open at the mistake;
 * statement_begin: of the statement with the mistake. */
void synchronize(Parser *parser, int brackets, uint32_t statement_begin);

/* -- looking ahead without reporting -- */
enum { NEAR_LOOK = 4096 }; /* bytes to look ahead for a closing bracket */

/* A lexer that begins behind the next token. */
typedef struct Look {
    Lexer lexer;
    Diag mute;
} Look;

void look_from(const Parser *parser, Look *look);
Token peek(const Parser *parser); /* the token behind the next one */

/* -- nonterminals -- */
Stmt *parse_stmt(Parser *parser);
Stmt *parse_stmts(Parser *parser, TokenKind end); /* up to the end token */
Block *parse_block(Parser *parser);
Block *parse_node_block(Parser *parser, const char *node); /* of a node of that word; NULL: of no node */
/* Behind the word 'def'; reports_body: a body that is missing is a mistake of its own. */
Stmt *parse_def(Parser *parser, Span begin, bool reports_body);
Expr *parse_expr(Parser *parser);
Expr *parse_tern(Parser *parser);
Expr *parse_prim(Parser *parser);
Expr *parse_unary(Parser *parser);
Expr *parse_add(Parser *parser);
Args parse_args(Parser *parser, Span opening); /* behind the '(' */
Expr *expr_new(Parser *parser, ExprKind kind, Span span);

#endif

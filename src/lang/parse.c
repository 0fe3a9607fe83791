/* parse.c - statements and blocks: one function per nonterminal, its line of the grammar above it; and the way back
 * from a mistake to the next statement.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/parse.h"

#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "lang/parser.h"

/* ---- tokens ---- */

void parser_init(Parser *parser, File *file, uint32_t source, double unit_m, Diag *diag, SymbolTable *symbols)
{
    *parser = (Parser){.diag = diag, .arena = diag->arena, .file = file, .unit_m = unit_m};
    lexer_init(&parser->lexer, diag, symbols, source);
    parser->token = lexer_next(&parser->lexer);
}

void advance(Parser *parser)
{
    if (!parser->fatal) parser->token = lexer_next(&parser->lexer);
}

bool accept(Parser *parser, TokenKind kind)
{
    if (parser->panic || parser->token.kind != kind) return false;
    advance(parser);
    return true;
}

Token peek(const Parser *parser)
{
    Lexer ahead = parser->lexer;
    return lexer_next(&ahead);
}

Span token_span(const Parser *parser)
{
    return (Span){parser->lexer.source, parser->token.begin, parser->token.end};
}

/* where the last consumed token ends */
static uint32_t consumed_end(const Parser *parser)
{
    return parser->token.kind == TOKEN_END ? parser->lexer.last_end : parser->lexer.previous_end;
}

Span span_from(const Parser *parser, Span begin)
{
    uint32_t end = consumed_end(parser);
    return (Span){begin.source, begin.begin, end > begin.begin ? end : begin.end};
}

Diagnostic *syntax_error(Parser *parser, Span span, const char *format, ...)
{
    if (parser->panic) return NULL;
    parser->panic = true;
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return diag_report(parser->diag, D_SYNTAX, span, "%s", text);
}

static const char *found_text(const Parser *parser)
{
    const Token *token = &parser->token;
    if (token->kind == TOKEN_NAME) return arena_format(parser->arena, "'%s'", token->as.symbol->text);
    return token_text(token->kind);
}

Diagnostic *expected_error(Parser *parser, const char *expected)
{
    uint32_t end = consumed_end(parser);
    return syntax_error(parser, (Span){parser->lexer.source, end, end}, "expected %s, found %s", expected,
                        found_text(parser));
}

bool expect(Parser *parser, TokenKind kind, const char *context)
{
    if (accept(parser, kind)) return true;
    if (!parser->panic) expected_error(parser, arena_format(parser->arena, "%s %s", token_text(kind), context));
    return false;
}

bool expect_close(Parser *parser, TokenKind kind, Span opening, const char *expected)
{
    if (accept(parser, kind)) return true;
    if (parser->panic) return false;
    parser->panic = true;
    uint32_t end = consumed_end(parser);
    Diagnostic *report = diag_report(parser->diag, D_UNCLOSED_BRACKET, (Span){parser->lexer.source, end, end},
                                     "expected %s, found %s", expected, found_text(parser));
    diag_note(parser->diag, report, opening, "to close this");
    return false;
}

bool expect_name(Parser *parser, const char *context, Symbol **name, Span *span)
{
    if (!parser->panic && parser->token.kind == TOKEN_NAME) {
        *name = parser->token.as.symbol;
        *span = token_span(parser);
        advance(parser);
        return true;
    }
    if (!parser->panic) {
        const Token *token = &parser->token;
        Diagnostic *report = expected_error(parser, arena_format(parser->arena, "a name %s", context));
        if (report && token->kind >= TOKEN_AND)
            diag_hint(parser->diag, report, "%s is a word of the language and cannot be a name", token_text(token->kind));
    }
    return false;
}

bool enter(Parser *parser)
{
    if (parser->depth < DEEPEST_NESTING) {
        parser->depth++;
        return true;
    }
    if (!parser->fatal && !parser->panic)
        diag_report(parser->diag, D_TOO_DEEP, token_span(parser), "nested deeper than %d levels", DEEPEST_NESTING);
    parser->panic = parser->fatal = true;
    parser->token.kind = TOKEN_END;
    return false;
}

void leave(Parser *parser) { parser->depth--; }

/* ---- the way back from a mistake ---- */

static bool first_on_line(const Parser *parser)
{
    const char *text = parser->lexer.text;
    uint32_t at = parser->token.begin;
    while (at > 0 && (text[at - 1] == ' ' || text[at - 1] == '\t')) at--;
    return at == 0 || text[at - 1] == '\n' || text[at - 1] == '\r';
}

static bool starts_statement(const Parser *parser, int brackets)
{
    bool fresh_line = first_on_line(parser);
    switch (parser->token.kind) {
    case TOKEN_LET:
    case TOKEN_VAR:
    case TOKEN_PARAM:
    case TOKEN_DEF:
    case TOKEN_DEFAULTS:
    case TOKEN_WHILE:
    case TOKEN_USE:
    case TOKEN_INCLUDE:
    case TOKEN_FOR:
    case TOKEN_IF: return fresh_line || brackets == 0;
    case TOKEN_NAME: {
        TokenKind next = peek(parser).kind;
        if (next == TOKEN_ASSIGN || next == TOKEN_CHANGE) return fresh_line || brackets == 0;
        return fresh_line && (next == TOKEN_BRACE_OPEN || next == TOKEN_NAME || next == TOKEN_PAREN_OPEN ||
                              next == TOKEN_DOT);
    }
    default: return false;
    }
}

/* Skips to where a statement of the present block may begin. brackets: how many were open at the mistake. */
static void synchronize(Parser *parser, int brackets, uint32_t statement_begin)
{
    int braces = 0;
    parser->panic = parser->fatal;
    while (parser->token.kind != TOKEN_END) {
        TokenKind kind = parser->token.kind;
        if (braces == 0) {
            if (kind == TOKEN_BRACE_CLOSE) return;
            if (parser->token.begin > statement_begin && starts_statement(parser, brackets)) return;
        }
        advance(parser);
        if (kind == TOKEN_PAREN_OPEN || kind == TOKEN_BRACKET_OPEN) brackets++;
        if ((kind == TOKEN_PAREN_CLOSE || kind == TOKEN_BRACKET_CLOSE) && brackets > 0) brackets--;
        if (kind == TOKEN_SEMICOLON && braces == 0) return;
        if (kind == TOKEN_BRACE_OPEN) braces++;
        if (kind == TOKEN_BRACE_CLOSE && --braces == 0) return;
    }
}

/* ---- statements ---- */

static Stmt *parse_stmt(Parser *parser);

static Stmt *stmt_new(Parser *parser, StmtKind kind, Span span)
{
    Stmt *stmt = ARENA_NEW(parser->arena, Stmt);
    stmt->kind = kind;
    stmt->span = span;
    return stmt;
}

static void remember_start(File *file, const Token *token)
{
    if (!file->keeps_starts || token->kind == TOKEN_SEMICOLON) return;
    if (ARRAY_ROOM(file->starts, file->starts_capacity, file->n_starts)) file->starts[file->n_starts++] = token->begin;
}

/* Statements up to (not including) the end token; each mistake is one report. */
static Stmt *parse_stmts(Parser *parser, TokenKind end)
{
    Stmt *first = NULL, **tail = &first;
    int brackets = parser->brackets;
    while (parser->token.kind != end && parser->token.kind != TOKEN_END) {
        uint32_t begin = parser->token.begin;
        parser->brackets = 0;
        remember_start(parser->file, &parser->token);
        Stmt *stmt = parse_stmt(parser);
        if (parser->panic) {
            synchronize(parser, parser->brackets, begin);
        }
        if (stmt && stmt->kind != STMT_EMPTY) {
            *tail = stmt;
            tail = &stmt->next;
        }
        if (parser->fatal) break;
    }
    parser->brackets = brackets;
    return first;
}

/* block = "{" { stmt } "}" ; */
Block *parse_block(Parser *parser)
{
    Block *block = ARENA_NEW(parser->arena, Block);
    block->span = token_span(parser);
    if (!expect(parser, TOKEN_BRACE_OPEN, "to begin a block")) return block;
    if (!enter(parser)) return block;
    block->first = parse_stmts(parser, TOKEN_BRACE_CLOSE);
    leave(parser);
    expect_close(parser, TOKEN_BRACE_CLOSE, block->span, "'}'");
    return block;
}

/* bind = ( "let" | "var" ) name "=" expr ; */
static Stmt *parse_bind(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_BIND, token_span(parser));
    stmt->as.bind.variable = parser->token.kind == TOKEN_VAR;
    advance(parser);
    if (!expect_name(parser, "to declare", &stmt->as.bind.name, &stmt->as.bind.name_span)) return NULL;
    if (parser->token.kind == TOKEN_CHANGE) {
        Diagnostic *report = expected_error(parser, "'=' behind the name");
        if (report) diag_hint(parser->diag, report, "':=' changes a var that is declared already");
    }
    expect(parser, TOKEN_ASSIGN, "behind the name");
    stmt->as.bind.value = parse_expr(parser); /* poison after a mistake: the name is declared all the same */
    return stmt;
}

static void parse_type(Parser *parser, Symbol **type, Span *span)
{
    if (!accept(parser, TOKEN_COLON)) return;
    expect_name(parser, "of a type", type, span);
}

/* param = "param" name [ ":" name ] "=" tern [ "in" expr ] [ string ] ; */
static Stmt *parse_param(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_PARAM, token_span(parser));
    advance(parser);
    if (!expect_name(parser, "to declare", &stmt->as.bind.name, &stmt->as.bind.name_span)) return NULL;
    parse_type(parser, &stmt->as.bind.type, &stmt->as.bind.type_span);
    expect(parser, TOKEN_ASSIGN, "and a default behind the name");
    stmt->as.bind.value = parse_tern(parser);
    if (accept(parser, TOKEN_IN)) stmt->as.bind.range = parse_expr(parser);
    if (!parser->panic && parser->token.kind == TOKEN_STRING) {
        stmt->as.bind.doc = parser->token.as.text;
        advance(parser);
    }
    return stmt;
}

/* formal = name [ ":" name ] [ "=" expr ] ; */
static bool parse_formal(Parser *parser, Formal *formal)
{
    *formal = (Formal){0};
    if (!expect_name(parser, "of a parameter", &formal->name, &formal->span)) return false;
    parse_type(parser, &formal->type, &formal->type_span);
    if (accept(parser, TOKEN_ASSIGN)) formal->fallback = parse_expr(parser);
    return !parser->panic;
}

static void parse_formals(Parser *parser, Def *def, Span opening)
{
    uint32_t capacity = 0;
    parser->brackets++;
    while (!parser->panic && parser->token.kind != TOKEN_PAREN_CLOSE) {
        Formal formal;
        if (!parse_formal(parser, &formal)) break;
        if (def->n_formals == capacity) {
            capacity = capacity ? capacity * 2 : 4;
            Formal *formals = ARENA_ARRAY(parser->arena, Formal, capacity);
            if (def->n_formals) memcpy(formals, def->formals, def->n_formals * sizeof *formals);
            def->formals = formals;
        }
        def->formals[def->n_formals++] = formal;
        if (!accept(parser, TOKEN_COMMA)) break;
    }
    expect_close(parser, TOKEN_PAREN_CLOSE, opening, "',' or ')'");
    parser->brackets--;
}

/* def = "def" name "(" [ formal { "," formal } [ "," ] ] ")" ( "=" expr | block ) ; */
static Stmt *parse_def(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_DEF, token_span(parser));
    Def *def = stmt->as.def = ARENA_NEW(parser->arena, Def);
    advance(parser);
    if (!expect_name(parser, "to declare", &def->name, &def->span)) return NULL;
    Span opening = token_span(parser);
    if (expect(parser, TOKEN_PAREN_OPEN, "and parameters behind the name")) parse_formals(parser, def, opening);
    if (accept(parser, TOKEN_ASSIGN))
        def->body = parse_expr(parser);
    else if (parser->panic || parser->token.kind == TOKEN_BRACE_OPEN)
        def->block = parse_block(parser);
    else
        expected_error(parser, "'=' or '{' behind the parameters");
    return stmt;
}

static void parse_condition(Parser *parser, Expr **condition, const char *context)
{
    Span opening = token_span(parser);
    *condition = NULL;
    if (!expect(parser, TOKEN_PAREN_OPEN, context)) return;
    parser->brackets++;
    *condition = parse_expr(parser);
    expect_close(parser, TOKEN_PAREN_CLOSE, opening, "')'");
    parser->brackets--;
}

/* ifs = "if" "(" expr ")" block [ "else" ( block | ifs ) ] ; */
static Stmt *parse_ifs(Parser *parser)
{
    Stmt *first = NULL, **link = &first;
    Block **otherwise = NULL;
    for (;;) { /* else if is a loop here and nested blocks in the tree, within the limit of nesting */
        Stmt *stmt = stmt_new(parser, STMT_IF, token_span(parser));
        *link = stmt;
        advance(parser);
        parse_condition(parser, &stmt->as.branch.condition, "behind 'if'");
        stmt->as.branch.then = parse_block(parser);
        if (!accept(parser, TOKEN_ELSE)) break;
        otherwise = &stmt->as.branch.otherwise;
        if (parser->token.kind != TOKEN_IF) {
            *otherwise = parse_block(parser);
            break;
        }
        *otherwise = ARENA_NEW(parser->arena, Block);
        (*otherwise)->span = token_span(parser);
        link = &(*otherwise)->first;
    }
    return first;
}

/* flow = ifs | "for" "(" name "in" expr ")" block | "while" "(" expr ")" block ; */
static Stmt *parse_flow(Parser *parser)
{
    if (parser->token.kind == TOKEN_IF) return parse_ifs(parser);
    bool loop = parser->token.kind == TOKEN_FOR;
    Stmt *stmt = stmt_new(parser, loop ? STMT_FOR : STMT_WHILE, token_span(parser));
    advance(parser);
    if (!loop) {
        parse_condition(parser, &stmt->as.branch.condition, "behind 'while'");
        stmt->as.branch.then = parse_block(parser);
        return stmt;
    }
    Span opening = token_span(parser);
    if (!expect(parser, TOKEN_PAREN_OPEN, "behind 'for'")) return NULL;
    parser->brackets++;
    if (!expect_name(parser, "of the loop", &stmt->as.loop.name, &stmt->as.loop.name_span)) return NULL;
    expect(parser, TOKEN_IN, "behind the name of the loop");
    stmt->as.loop.source = parse_expr(parser);
    expect_close(parser, TOKEN_PAREN_CLOSE, opening, "')'");
    parser->brackets--;
    stmt->as.loop.block = parse_block(parser);
    return stmt;
}

static void remember_import(Parser *parser, Stmt *stmt)
{
    File *file = parser->file;
    if (file->n_imports == file->capacity) {
        uint32_t capacity = file->capacity ? file->capacity * 2 : 8;
        Stmt **imports = ARENA_ARRAY(parser->arena, Stmt *, capacity);
        if (file->n_imports) memcpy(imports, file->imports, file->n_imports * sizeof(Stmt *));
        file->imports = imports;
        file->capacity = capacity;
    }
    file->imports[file->n_imports++] = stmt;
}

/* import = "use" string [ "as" name ] | "include" string ; */
static Stmt *parse_import(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_IMPORT, token_span(parser));
    stmt->as.import.include = parser->token.kind == TOKEN_INCLUDE;
    advance(parser);
    if (parser->token.kind != TOKEN_STRING) {
        expected_error(parser, "the name of a file in quotes");
        return NULL;
    }
    bool bad = parser->token.bad;
    stmt->as.import.text = parser->token.as.text;
    stmt->as.import.text_span = token_span(parser);
    advance(parser);
    if (!stmt->as.import.include && accept(parser, TOKEN_AS))
        expect_name(parser, "behind 'as'", &stmt->as.import.name, &stmt->as.import.name_span);
    if (bad || parser->panic) return NULL;
    remember_import(parser, stmt);
    return stmt;
}

/* defaults = "defaults" name block ; */
static Stmt *parse_defaults(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_DEFAULTS, token_span(parser));
    NodeExpr *node = stmt->as.node = ARENA_NEW(parser->arena, NodeExpr);
    advance(parser);
    if (!expect_name(parser, "of a node type", &node->path.names[0], &node->path.span)) return NULL;
    node->path.n = 1;
    node->block = parse_block(parser);
    return stmt;
}

/* kids = "children" "(" args ")" ; */
static Stmt *parse_kids(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_KIDS, token_span(parser));
    advance(parser);
    Span opening = token_span(parser);
    if (expect(parser, TOKEN_PAREN_OPEN, "behind 'children'")) stmt->as.kids = parse_args(parser, opening);
    return stmt;
}

/* path = name [ "." name [ "." name [ "." name ] ] ] ; */
Path parse_path(Parser *parser)
{
    Path path = {.span = token_span(parser)};
    Span span;
    do {
        if (path.n == LONGEST_PATH) {
            syntax_error(parser, token_span(parser), "more than %d names in a row", LONGEST_PATH);
            break;
        }
        if (!expect_name(parser, "behind '.'", &path.names[path.n], &span)) break;
        path.n++;
        path.span.end = span.end;
    } while (accept(parser, TOKEN_DOT));
    return path;
}

/* call = path "(" args ")" [ block ] ; */
static Stmt *parse_call_stmt(Parser *parser, Path path)
{
    Stmt *stmt = stmt_new(parser, STMT_CALL, path.span);
    Span opening = token_span(parser);
    Expr *callee = expr_new(parser, EXPR_NAME, path.span);
    callee->as.name.symbol = path.names[0];
    for (uint32_t i = 1; i < path.n; i++) {
        Expr *member = expr_new(parser, EXPR_MEMBER, path.span);
        member->as.member.base = callee;
        member->as.member.name = path.names[i];
        member->as.member.name_span = path.span;
        callee = member;
    }
    stmt->as.call.path = path;
    stmt->as.call.call = expr_new(parser, EXPR_CALL, path.span);
    stmt->as.call.call->as.call.callee = callee;
    advance(parser);
    stmt->as.call.call->as.call.args = parse_args(parser, opening);
    stmt->as.call.call->span = span_from(parser, path.span);
    if (!parser->panic && parser->token.kind == TOKEN_BRACE_OPEN) stmt->as.call.block = parse_block(parser);
    return stmt;
}

/* node = path [ name ] block ; */
static Stmt *parse_node(Parser *parser, Path path)
{
    bool preset = path.n == 1 && strcmp(path.names[0]->text, "preset") == 0 && parser->token.kind == TOKEN_NAME;
    Stmt *stmt = stmt_new(parser, preset ? STMT_PRESET : STMT_NODE, path.span);
    NodeExpr *node = stmt->as.node = ARENA_NEW(parser->arena, NodeExpr);
    node->path = path;
    if (parser->token.kind == TOKEN_NAME) expect_name(parser, "", &node->name, &node->name_span);
    node->block = parse_block(parser);
    return stmt;
}

/* Two names and no '{': often a word of the language that is not spelled right. */
static Stmt *report_two_names(Parser *parser, Path path)
{
    static const char *const words[] = {"let", "var", "param", "def", "defaults", "use", "include"};
    advance(parser);
    Diagnostic *report = expected_error(parser, "'{'");
    if (report) diag_suggest(parser->diag, report, path.names[0]->text, words, COUNT_OF(words));
    return NULL;
}

/* assign = name ":=" expr ;   prop = name "=" expr ;   and call, node */
static Stmt *parse_named(Parser *parser)
{
    Path path = parse_path(parser);
    if (parser->panic) return NULL;
    switch (parser->token.kind) {
    case TOKEN_PAREN_OPEN: return parse_call_stmt(parser, path);
    case TOKEN_BRACE_OPEN: return parse_node(parser, path);
    case TOKEN_NAME:
        if (peek(parser).kind == TOKEN_BRACE_OPEN) return parse_node(parser, path);
        return report_two_names(parser, path);
    case TOKEN_ASSIGN:
    case TOKEN_CHANGE:
        if (path.n == 1) break;
        syntax_error(parser, path.span, "only a plain name can be set");
        return NULL;
    default: expected_error(parser, "'=', ':=', '(' or '{' behind the name"); return NULL;
    }
    bool assign = parser->token.kind == TOKEN_CHANGE;
    Stmt *stmt = stmt_new(parser, assign ? STMT_ASSIGN : STMT_PROP, path.span);
    advance(parser);
    Expr *value = parse_expr(parser);
    if (assign) {
        stmt->as.bind.name = path.names[0];
        stmt->as.bind.name_span = path.span;
        stmt->as.bind.value = value;
    } else {
        stmt->as.prop.name = path.names[0];
        stmt->as.prop.value = value;
    }
    return stmt;
}

/* stmt = ";" | bind | param | def | flow | import | defaults | assign | prop | call | node | kids ; */
static Stmt *parse_stmt(Parser *parser)
{
    switch (parser->token.kind) {
    case TOKEN_SEMICOLON: advance(parser); return NULL;
    case TOKEN_LET:
    case TOKEN_VAR: return parse_bind(parser);
    case TOKEN_PARAM: return parse_param(parser);
    case TOKEN_DEF: return parse_def(parser);
    case TOKEN_IF:
    case TOKEN_FOR:
    case TOKEN_WHILE: return parse_flow(parser);
    case TOKEN_USE:
    case TOKEN_INCLUDE: return parse_import(parser);
    case TOKEN_DEFAULTS: return parse_defaults(parser);
    case TOKEN_CHILDREN: return parse_kids(parser);
    case TOKEN_NAME: return parse_named(parser);
    case TOKEN_ELSE: syntax_error(parser, token_span(parser), "'else' without an 'if' before it"); return NULL;
    default: syntax_error(parser, token_span(parser), "expected a statement, found %s", found_text(parser)); return NULL;
    }
}

/* ---- files ---- */

enum { LANGUAGE_MAJOR = 1, LANGUAGE_MINOR = 0 };

static bool token_is_word(const Token *token, const char *word)
{
    return token->kind == TOKEN_NAME && strcmp(token->as.symbol->text, word) == 0;
}

/* A macro or a property may be called unit, too. */
static bool begins_statement(const Parser *parser)
{
    switch (peek(parser).kind) {
    case TOKEN_BRACE_OPEN:
    case TOKEN_PAREN_OPEN:
    case TOKEN_DOT:
    case TOKEN_ASSIGN:
    case TOKEN_CHANGE: return true;
    default: return false;
    }
}

/* "meniscus" number [ "unit" unit ] */
static void parse_header(Parser *parser, double unit_m)
{
    File *file = parser->file;
    file->unit_m = unit_m > 0 ? unit_m : 1;
    if (!token_is_word(&parser->token, "meniscus")) {
        Span span = token_span(parser);
        Diagnostic *report = diag_report(parser->diag, D_MISSING_HEADER, span, "the file does not begin with its header");
        diag_hint(parser->diag, report, "let the first line be: meniscus 1.0 unit mm");
        return;
    }
    advance(parser);
    Span version_span = token_span(parser);
    file->version = parser->token.number;
    if (!expect(parser, TOKEN_NUMBER, "(the version of the language) behind 'meniscus'")) return;
    if (file->version < LANGUAGE_MAJOR || file->version >= LANGUAGE_MAJOR + 1)
        diag_report(parser->diag, D_UNSUPPORTED_VERSION, version_span,
                    "the file is in version %g of the language; this program reads %d.%d", file->version, LANGUAGE_MAJOR,
                    LANGUAGE_MINOR);
    if (!token_is_word(&parser->token, "unit") || begins_statement(parser)) return;
    advance(parser);
    file->unit_span = token_span(parser);
    const UnitType *unit = NULL;
    if (parser->token.kind == TOKEN_NAME || parser->token.kind == TOKEN_IN)
        unit = unit_of(parser->token.as.symbol->text, parser->token.as.symbol->length);
    if (!unit || unit->measure != UNIT_LENGTH) {
        diag_report(parser->diag, D_UNKNOWN_UNIT, file->unit_span,
                    "expected a unit of length: nm um mm cm m km in ft, found %s", found_text(parser));
        if (parser->token.kind == TOKEN_NAME) advance(parser);
        return;
    }
    file->has_unit = true;
    file->unit_m = unit->size;
    advance(parser);
}

/* file = "meniscus" number [ "unit" unit ] { stmt } ; */
void parse_file(File *file, bool has_header, double unit_m, Diag *diag, SymbolTable *symbols)
{
    Parser parser;
    parser_init(&parser, file, file->source, unit_m > 0 ? unit_m : 1, diag, symbols);
    file->block = ARENA_NEW(parser.arena, Block);
    file->block->span = (Span){file->source, 0, 0};
    file->unit_m = parser.unit_m;
    if (has_header) {
        parse_header(&parser, unit_m);
        if (parser.panic) synchronize(&parser, 0, 0);
        parser.unit_m = file->unit_m;
    }
    Stmt **tail = &file->block->first;
    for (;;) {
        *tail = parse_stmts(&parser, TOKEN_BRACE_CLOSE);
        while (*tail) tail = &(*tail)->next;
        if (parser.token.kind != TOKEN_BRACE_CLOSE || parser.fatal) break;
        diag_report(diag, D_SYNTAX, token_span(&parser), "this '}' closes nothing");
        advance(&parser);
    }
}

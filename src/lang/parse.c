/* parse.c - statements and blocks: one function per nonterminal, its line of the grammar above it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/parse.h"

#include <string.h>

#include "base/array.h"
#include "base/suggest.h"
#include "lang/habits.h"
#include "lang/parse_habits.h"
#include "lang/parser.h"

/* ---- statements ---- */

/* Texts may have millions of statements, most of them properties and nodes: memory for what their kind has, and no
 * more. */
static size_t stmt_size(StmtKind kind)
{
    const Stmt *stmt = NULL;
    switch (kind) {
    case STMT_PROP: return offsetof(Stmt, as) + sizeof stmt->as.prop;
    case STMT_NODE:
    case STMT_DEFAULTS:
    case STMT_PRESET: return offsetof(Stmt, as) + sizeof stmt->as.node;
    default: return sizeof *stmt;
    }
}

static Stmt *stmt_new(Parser *parser, StmtKind kind, Span span)
{
    Stmt *stmt = arena_alloc(parser->arena, stmt_size(kind));
    stmt->kind = kind;
    stmt->span = span;
    return stmt;
}

static void remember_start(File *file, const Token *token)
{
    if (!file->only_starts || token->kind == TOKEN_SEMICOLON) return;
    if (ARRAY_ROOM(file->starts, file->starts_capacity, file->n_starts)) file->starts[file->n_starts++] = token->begin;
}

/* ---- what indentation says ---- */

enum { LONGEST_LINE = 1000 };

/* Columns of blanks in front of the line that byte at stands on; a tab counts as one, like any blank. 0 for very long
 * lines. */
static uint32_t line_indent(const Parser *parser, uint32_t at)
{
    const char *text = parser->lexer.text;
    for (uint32_t end = at; at > 0 && text[at - 1] != '\n'; at--)
        if (end - at > LONGEST_LINE) return 0;
    uint32_t begin = at;
    while (text[at] == ' ' || text[at] == '\t') at++;
    return at - begin;
}

/* A statement of a block that begins its line: where does it stand, compared with the block? */
static void watch_indent(Parser *parser, const Block *block, uint32_t *siblings, uint32_t *begun)
{
    Indents *indents = &parser->indents;
    uint32_t column = line_indent(parser, parser->token.begin);
    if (block && !*begun && column <= line_indent(parser, block->span.begin)) {
        *begun = consumed_end(parser);
    } else if (parser->previous == TOKEN_BRACE_CLOSE && column > *siblings && *siblings != UINT32_MAX &&
               !indents->extra) {
        indents->extra = true;
        uint32_t end = consumed_end(parser);
        indents->extra_close = (Span){parser->lexer.source, end - 1, end};
    }
    if (*siblings == UINT32_MAX) *siblings = column;
}

/* Statements up to (not including) the end token; each mistake is one report. block: whose they are; NULL at the
 * top. */
static Stmt *parse_statements(Parser *parser, TokenKind end, const Block *block)
{
    Stmt *first = NULL, **tail = &first;
    int brackets = parser->brackets;
    bool comma_reported = parser->comma_reported, no_blocks = parser->no_blocks;
    uint32_t siblings = UINT32_MAX, left_at = 0;
    parser->comma_reported = parser->no_blocks = false;
    while (parser->token.kind != end && parser->token.kind != TOKEN_END) {
        uint32_t begin = parser->token.begin;
        parser->brackets = 0;
        remember_start(parser->file, &parser->token);
        if (first_on_line(parser)) watch_indent(parser, block, &siblings, &left_at);
        Stmt *stmt = parse_stmt(parser);
        if (parser->panic) synchronize(parser, parser->panic_brackets, begin);
        if (parser->depth == 0 && parser->file->only_starts) {
            arena_reset(parser->arena);
        } else if (stmt && stmt->kind != STMT_EMPTY) {
            *tail = stmt;
            tail = &stmt->next;
        }
        if (parser->fatal) break;
    }
    bool in_place = parser->token.kind == end && first_on_line(parser) && block &&
                    line_indent(parser, parser->token.begin) == line_indent(parser, block->span.begin);
    if (left_at && !in_place && !parser->indents.missing) {
        parser->indents.missing = true;
        parser->indents.opening = block->span;
        parser->indents.missing_at = left_at;
    }
    parser->brackets = brackets;
    parser->comma_reported = comma_reported;
    parser->no_blocks = no_blocks;
    return first;
}

Stmt *parse_stmts(Parser *parser, TokenKind end)
{
    return parse_statements(parser, end, NULL);
}

/* The '}' of a block is missing: at the end of the file, or where the indentation says so. */
static void report_missing_close(Parser *parser, Span opening)
{
    const Indents *indents = &parser->indents;
    if (parser->token.kind != TOKEN_END || !indents->missing || parser->panic) {
        expect_close(parser, TOKEN_BRACE_CLOSE, opening, "'}'");
        return;
    }
    parser->panic = parser->fatal = true; /* the blocks around it miss theirs for the same reason */
    Diagnostic *report = diag_report(parser->diag, D_UNCLOSED_BRACKET,
                                     (Span){parser->lexer.source, indents->missing_at, indents->missing_at},
                                     "expected '}', by the indentation of what follows");
    diag_note(parser->diag, report, indents->opening, "to close this");
}

/* block = "{" { stmt } "}" ; */
Block *parse_block(Parser *parser)
{
    Block *block = ARENA_NEW(parser->arena, Block);
    block->span = token_span(parser);
    if (!consume_if(parser, TOKEN_BRACE_OPEN)) {
        if (!parser->panic) parse_bare_block(parser, block);
        return block;
    }
    if (!enter(parser)) return block;
    parser->blocks++;
    block->first = parse_statements(parser, TOKEN_BRACE_CLOSE, block);
    parser->blocks--;
    leave(parser);
    if (!consume_if(parser, TOKEN_BRACE_CLOSE)) report_missing_close(parser, block->span);
    return block;
}

Block *parse_node_block(Parser *parser, const char *node)
{
    const char *outer = parser->node;
    parser->node = node;
    Block *block = parse_block(parser);
    parser->node = outer;
    return block;
}

/* What hints can say of a name by the look of its value. */
static SymbolUse use_of_value(const Expr *value)
{
    if (value->kind == EXPR_NODE) return SYMBOL_NODE;
    const Expr *callee = value->kind == EXPR_CALL ? value->as.call.callee : NULL;
    bool transform =
        callee && callee->kind == EXPR_NAME &&
        habit_is_one_of("rotate translate scale matrix transform inverse align", callee->as.name.symbol->text);
    return transform ? SYMBOL_TRANSFORM : SYMBOL_FREE;
}

/* bind = ( "let" | "var" ) name "=" expr ; */
static Stmt *parse_bind(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_BIND, token_span(parser));
    stmt->as.bind.variable = parser->token.kind == TOKEN_VAR;
    consume(parser);
    if (parser->token.kind == TOKEN_PAREN_OPEN) { /* let (a = 1, b = 2), as before a value */
        Diagnostic *report = expected_error(parser, "a name to declare");
        if (report) diag_hint(parser->diag, report, "write: let a = ..., and the next name in a let of its own");
        return NULL;
    }
    if (!expect_name(parser, "to declare", &stmt->as.bind.name, &stmt->as.bind.name_span)) return NULL;
    if (parser->token.kind == TOKEN_COMMA) {
        parse_names_together(parser, stmt->as.bind.name);
        return NULL;
    }
    const char *word = stmt->as.bind.variable ? "var" : "let", *value = stmt->as.bind.variable ? "0" : "...";
    if (parse_declared_change(parser, stmt->as.bind.name, word)) return NULL;
    stmt->as.bind.name->is_variable |= stmt->as.bind.variable;
    if (parser->token.kind == TOKEN_CHANGE) {
        Diagnostic *report = expected_error(parser, "'=' behind the name");
        if (report) diag_hint(parser->diag, report, "':=' changes a var that is declared already");
    } else if (parser->token.kind == TOKEN_NAME && !first_on_line(parser)) { /* let medium water = ... */
        Diagnostic *report = expected_error(parser, "'=' behind the name");
        if (report) diag_hint(parser->diag, report, "write: let %s = ...", parser->token.as.symbol->text);
    } else if (parser->token.kind == TOKEN_PAREN_OPEN) { /* let f(x) = ... */
        Diagnostic *report = expected_error(parser, "'=' behind the name");
        if (report) diag_hint(parser->diag, report, "a function: def %s(...) = ...", stmt->as.bind.name->text);
    }
    const char *whole = arena_format(parser->arena, "%s %s = %s", word, stmt->as.bind.name->text, value);
    if (parse_no_value(parser, "'=' behind the name", whole)) return NULL;
    if (!expect(parser, TOKEN_ASSIGN, "behind the name") && starts_value(parser)) parser->panic = false;
    Expr *arrow = parse_arrow_function(parser, stmt->as.bind.name->text, true);
    stmt->as.bind.value =
        arrow ? arrow : parse_whole_value(parser); /* poison after a mistake: it is declared all the same */
    SymbolUse use = use_of_value(stmt->as.bind.value);
    if (use != SYMBOL_FREE) stmt->as.bind.name->declared = use;
    return stmt;
}

static void parse_type(Parser *parser, Symbol **type, Span *span)
{
    if (!consume_if(parser, TOKEN_COLON)) return;
    expect_name(parser, "of a type", type, span);
}

/* param = "param" name [ ":" name ] "=" tern [ "in" expr ] [ string ] ; */
static Stmt *parse_param(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_PARAM, token_span(parser));
    consume(parser);
    if (!expect_name(parser, "to declare", &stmt->as.bind.name, &stmt->as.bind.name_span)) return NULL;
    parse_type(parser, &stmt->as.bind.type, &stmt->as.bind.type_span);
    if (parse_no_value(parser, "'=' and a default behind the name",
                       arena_format(parser->arena, "param %s = 1", stmt->as.bind.name->text)))
        return NULL;
    expect(parser, TOKEN_ASSIGN, "and a default behind the name");
    stmt->as.bind.value = parse_tern(parser);
    if (consume_if(parser, TOKEN_IN)) stmt->as.bind.range = parse_expr(parser);
    if (!parser->panic && parser->token.kind == TOKEN_STRING) {
        stmt->as.bind.doc = parser->token.as.text;
        consume(parser);
    }
    return stmt;
}

/* formal = name [ ":" name ] [ "=" expr ] ; */
static bool parse_formal(Parser *parser, Formal *formal)
{
    *formal = (Formal){0};
    if (!expect_name(parser, "for a parameter", &formal->name, &formal->span)) return false;
    if (parser->token.kind == TOKEN_NAME && !first_on_line(parser)) { /* float x */
        Diagnostic *report = expected_error(parser, "',' or ')'");
        diag_hint(parser->diag, report, "a type stands behind its name: x: number");
        parser->panic = false;
        consume(parser);
    }
    parse_type(parser, &formal->type, &formal->type_span);
    if (consume_if(parser, TOKEN_ASSIGN)) formal->fallback = parse_expr(parser);
    return !parser->panic;
}

static void parse_formals(Parser *parser, Def *def, Span opening)
{
    uint32_t capacity = 0;
    parser->brackets++;
    while (!parser->panic && parser->token.kind != TOKEN_PAREN_CLOSE) {
        Formal formal;
        if (!parse_formal(parser, &formal)) break;
        ARENA_ROOM(parser->arena, def->formals, capacity, def->n_formals, 4);
        def->formals[def->n_formals++] = formal;
        if (!consume_if(parser, TOKEN_COMMA)) break;
    }
    expect_close(parser, TOKEN_PAREN_CLOSE, opening, "',' or ')'");
    parser->brackets--;
}

/* 'def n = 3': what has no parameters is a name of a value. */
static void report_no_formals(Parser *parser, const Def *def)
{
    Diagnostic *report = expected_error(parser, "'(' and parameters behind the name");
    if (report)
        diag_hint(parser->diag, report, "write: let %s = ..., for a value; def %s(x) = ... is a function",
                  def->name->text, def->name->text);
}

/* def = "def" name "(" [ formal { "," formal } [ "," ] ] ")" ( "=" expr | block ) ; */
Stmt *parse_def(Parser *parser, Span begin, bool reports_body)
{
    Stmt *stmt = stmt_new(parser, STMT_DEF, begin);
    Def *def = stmt->as.def = ARENA_NEW(parser->arena, Def);
    if (!expect_name(parser, "to declare", &def->name, &def->span)) return NULL;
    def->name->declared = SYMBOL_DEF;
    Span opening = token_span(parser);
    if (parser->token.kind == TOKEN_ASSIGN && !parser->panic)
        report_no_formals(parser, def);
    else if (expect(parser, TOKEN_PAREN_OPEN, "and parameters behind the name"))
        parse_formals(parser, def, opening);
    const char *head = quote(parser, def->span.begin, consumed_end(parser));
    if (!parser->panic) parse_result_type(parser, head);
    if (consume_if(parser, TOKEN_ASSIGN))
        def->body = parser->token.kind == TOKEN_BRACE_OPEN ? parse_names_and_value(parser, head) : parse_expr(parser);
    else if (!parser->panic && parser->token.kind == TOKEN_BRACE_OPEN && (def->body = parse_braced_body(parser, def)))
        return stmt;
    else if (parser->panic || parser->token.kind == TOKEN_BRACE_OPEN)
        def->block = parse_node_block(parser, NULL);
    else
        def->body = parse_bodiless_def(parser, head, reports_body);
    return stmt;
}

/* 'if a {': goes on as if the brackets were there */
static void parse_without_brackets(Parser *parser, const char *context)
{
    if (parser->panic) return;
    Diagnostic *report = expected_error(parser, arena_format(parser->arena, "'(' %s", context));
    if (report) diag_hint(parser->diag, report, "a condition stands in brackets: (...)");
    parser->panic = false;
    bool no_blocks = parser->no_blocks;
    parser->no_blocks = true;
    parse_expr(parser);
    parser->no_blocks = no_blocks;
    consume_if(parser, TOKEN_PAREN_CLOSE);
}

static void parse_condition(Parser *parser, Expr **condition, const char *context)
{
    Span opening = token_span(parser);
    *condition = NULL;
    if (!consume_if(parser, TOKEN_PAREN_OPEN)) {
        parse_without_brackets(parser, context);
        return;
    }
    parser->brackets++;
    *condition = parse_expr(parser);
    if (!parser->panic && parser->token.kind == TOKEN_ASSIGN) {
        Diagnostic *report = expected_error(parser, "')'");
        diag_hint(parser->diag, report, "write '==' to compare");
        parser->panic = false;
        consume(parser);
        parse_expr(parser);
    }
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
        consume(parser);
        parse_condition(parser, &stmt->as.branch.condition, "behind 'if'");
        stmt->as.branch.then = parse_block(parser);
        if (!consume_if(parser, TOKEN_ELSE)) break;
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

/* '1:9' and 'of' are read as they are meant; returns what is written here, for a hint. bare: there are no brackets, of which
 * the caller's hint says all. */
static const char *parse_loop_source(Parser *parser, Stmt *stmt, bool bare)
{
    bool of = parser->token.kind == TOKEN_COLON || (bare && parser->token.kind == TOKEN_ASSIGN) ||
              (parser->token.kind == TOKEN_NAME && peek(parser).kind != TOKEN_ASSIGN);
    Diagnostic *report = NULL;
    if (!consume_if(parser, TOKEN_IN) && !parser->panic)
        report = expected_error(parser, "'in' behind the name of the loop");
    if (report && of) {
        parser->panic = false;
        consume(parser);
    }
    uint32_t begin = parser->token.begin;
    stmt->as.loop.source = parse_expr(parser);
    if (parser->panic) return "...";
    const char *range = parse_range_habit(parser, begin, bare, !bare && !report);
    if (!range) range = quote(parser, begin, consumed_end(parser));
    if (report && !bare)
        diag_hint(parser->diag, report, "write: for (%s in %s) { ... }", stmt->as.loop.name->text, range);
    return range;
}

/* "(" name "in" expr ")" */
static void parse_loop_head(Parser *parser, Stmt *stmt)
{
    Span opening = token_span(parser);
    bool bare = !consume_if(parser, TOKEN_PAREN_OPEN), no_blocks = parser->no_blocks;
    Diagnostic *report = bare && !parser->panic ? expected_error(parser, "'(' behind 'for'") : NULL;
    if (bare) parser->panic = false; /* go on as if it were there */
    if (!bare && parse_counting_loop(parser)) return;
    parser->brackets += !bare;
    parser->no_blocks |= bare;
    parse_loop_type(parser);
    if (expect_name(parser, "for the loop", &stmt->as.loop.name, &stmt->as.loop.name_span)) {
        const char *source = parse_loop_source(parser, stmt, bare);
        if (!parser->panic) parse_loop_step(parser);
        if (!bare && parser->token.kind == TOKEN_COMMA) parse_second_variable(parser, stmt->as.loop.name->text);
        if (report && !parser->panic)
            diag_hint(parser->diag, report, "write: for (%s in %s) { ... }", stmt->as.loop.name->text, source);
        if (bare)
            consume_if(parser, TOKEN_PAREN_CLOSE);
        else
            expect_close(parser, TOKEN_PAREN_CLOSE, opening, "')'");
    }
    parser->no_blocks = no_blocks;
    parser->brackets -= !bare;
    if (bare && report) parser->calm = 0; /* that braces are missing, too, is the same mistake */
}

/* flow = ifs | "for" "(" name "in" expr ")" block | "while" "(" expr ")" block ; */
static Stmt *parse_flow(Parser *parser)
{
    if (parser->token.kind == TOKEN_IF) return parse_ifs(parser);
    bool loop = parser->token.kind == TOKEN_FOR;
    Stmt *stmt = stmt_new(parser, loop ? STMT_FOR : STMT_WHILE, token_span(parser));
    consume(parser);
    if (!loop) {
        parse_condition(parser, &stmt->as.branch.condition, "behind 'while'");
        stmt->as.branch.then = parse_block(parser);
        return stmt;
    }
    parse_loop_head(parser, stmt);
    stmt->as.loop.block = parse_block(parser);
    return stmt;
}

static void remember_import(Parser *parser, Stmt *stmt)
{
    File *file = parser->file;
    ARENA_ROOM(parser->arena, file->imports, file->capacity, file->n_imports, 8);
    file->imports[file->n_imports++] = stmt;
}

/* import = "use" string [ "as" name ] | "include" string ; */
static Stmt *parse_import(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_IMPORT, token_span(parser));
    stmt->as.import.include = parser->token.kind == TOKEN_INCLUDE;
    consume(parser);
    if (parser->token.kind != TOKEN_STRING) {
        parse_unquoted_file(parser, stmt->as.import.include ? "include" : "use");
        return NULL;
    }
    bool bad = parser->token.bad;
    stmt->as.import.text = parser->token.as.text;
    stmt->as.import.text_span = token_span(parser);
    consume(parser);
    if (!stmt->as.import.include && consume_if(parser, TOKEN_AS))
        expect_name(parser, "behind 'as'", &stmt->as.import.name, &stmt->as.import.name_span);
    if (bad || parser->panic) return NULL;
    if (!parser->file->only_starts) remember_import(parser, stmt);
    return stmt;
}

/* defaults = "defaults" name block ; */
static Stmt *parse_defaults(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_DEFAULTS, token_span(parser));
    NodeExpr *node = stmt->as.node = ARENA_NEW(parser->arena, NodeExpr);
    consume(parser);
    if (!expect_name(parser, "of a node type", &node->path.names[0], &node->path.span)) return NULL;
    node->path.n = 1;
    node->block = parse_node_block(parser, node->path.names[0]->text);
    return stmt;
}

/* kids = "children" "(" args ")" ; */
static Stmt *parse_kids(Parser *parser)
{
    Stmt *stmt = stmt_new(parser, STMT_KIDS, token_span(parser));
    consume(parser);
    Span opening = token_span(parser);
    if (expect(parser, TOKEN_PAREN_OPEN, "behind 'children'")) stmt->as.kids = parse_args(parser, opening);
    return stmt;
}

/* path = name [ "." name [ "." name [ "." name ] ] ] ; */
static Path parse_path(Parser *parser)
{
    Path path = {.span = token_span(parser)};
    Span span;
    do {
        if (path.n == LIMIT_PATH_NAMES) {
            limit_error(parser, OVER_PATH_NAMES);
            break;
        }
        if (!expect_name(parser, "behind '.'", &path.names[path.n], &span)) break;
        path.n++;
        path.span.end = span.end;
    } while (consume_if(parser, TOKEN_DOT));
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
    consume(parser);
    stmt->as.call.call->as.call.args = parse_args(parser, opening);
    stmt->as.call.call->span = span_from(parser, path.span);
    if (!parser->panic && parser->token.kind == TOKEN_BRACE_OPEN) stmt->as.call.block = parse_node_block(parser, NULL);
    if (!parser->panic && parser->token.kind == TOKEN_ASSIGN && parse_function_habit(parser, path)) return NULL;
    return stmt;
}

/* node = path [ name ] block ; */
static Stmt *parse_node(Parser *parser, Path path)
{
    if (parse_block_habit(parser, path)) return NULL;
    bool preset = path.n == 1 && strcmp(path.names[0]->text, "preset") == 0 && parser->token.kind == TOKEN_NAME;
    Stmt *stmt = stmt_new(parser, preset ? STMT_PRESET : STMT_NODE, path.span);
    NodeExpr *node = stmt->as.node = ARENA_NEW(parser->arena, NodeExpr);
    node->path = path;
    if (parser->token.kind == TOKEN_NAME && expect_name(parser, "", &node->name, &node->name_span))
        node->name->declared = SYMBOL_NODE;
    node->block = parse_node_block(parser, preset ? NULL : path.names[path.n - 1]->text);
    return stmt;
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
        if (parse_lone_word(parser, path)) return NULL;
        if (peek(parser).kind == TOKEN_BRACE_OPEN) return parse_node(parser, path);
        parse_two_names(parser, path);
        return NULL;
    case TOKEN_ASSIGN:
    case TOKEN_CHANGE:
        if (path.n == 1) break;
        parse_member_change(parser, path);
        return NULL;
    default:
        if (!parse_name_habit(parser, path))
            expected_error(
                parser, arena_format(parser->arena, "'=', ':=', '(' or '{' behind '%s'", path.names[path.n - 1]->text));
        return NULL;
    }
    bool assign = parser->token.kind == TOKEN_CHANGE;
    Stmt *stmt = stmt_new(parser, assign ? STMT_ASSIGN : STMT_PROP, path.span);
    consume(parser);
    Expr *arrow = parse_arrow_function(parser, path.names[0]->text, false);
    Expr *value = arrow ? arrow : parse_whole_value(parser);
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

static bool token_is_word(const Token *token, const char *word)
{
    return token->kind == TOKEN_NAME && strcmp(token->as.symbol->text, word) == 0;
}

/* "meniscus 1.0" */
static bool at_header(const Parser *parser)
{
    return token_is_word(&parser->token, "meniscus") && peek(parser).kind == TOKEN_NUMBER;
}

static void skip_line(Parser *parser)
{
    do consume(parser);
    while (parser->token.kind != TOKEN_END && !first_on_line(parser));
}

/* Behind something else, or the second one of files that were put together. */
static bool parse_late_header(Parser *parser)
{
    if (!at_header(parser)) return false;
    bool second = parser->file->version > 0;
    Diagnostic *report = diag_report(parser->diag, second ? D_SYNTAX : D_MISSING_HEADER, token_span(parser),
                                     "this is the header of a file, which stands at its top and nowhere else");
    diag_hint(parser->diag, report, "%s",
              second ? "leave it out: this file has one" : "let it be the first line, in front of all but comments");
    skip_line(parser);
    return true;
}

/* stmt = ";" | bind | param | def | flow | import | defaults | assign | prop | call | node | kids ; */
Stmt *parse_stmt(Parser *parser)
{
    switch (parser->token.kind) {
    case TOKEN_SEMICOLON: consume(parser); return NULL;
    case TOKEN_LET:
    case TOKEN_VAR: return parse_bind(parser);
    case TOKEN_PARAM: return parse_param(parser);
    case TOKEN_DEF: {
        Span begin = token_span(parser);
        consume(parser);
        return parse_def(parser, begin, true);
    }
    case TOKEN_IF:
    case TOKEN_FOR:
    case TOKEN_WHILE: return parse_flow(parser);
    case TOKEN_USE:
    case TOKEN_INCLUDE: return parse_import(parser);
    case TOKEN_DEFAULTS: return parse_defaults(parser);
    case TOKEN_CHILDREN: return parse_kids(parser);
    case TOKEN_NAME:
        if (parse_do_loop(parser) || parse_switch(parser) || parse_late_header(parser)) return NULL;
        return parse_foreach(parser) ? parse_flow(parser) : parse_named(parser);
    case TOKEN_ELSE: syntax_error(parser, token_span(parser), "'else' without an 'if' before it"); return NULL;
    case TOKEN_DIRECTIVE: parse_directive(parser); return NULL;
    default:
        if (!parse_comma_habit(parser) && !parse_brace_habit(parser) && !parse_value_habit(parser))
            syntax_error(parser, token_span(parser), "expected a statement, found %s", found_text(parser));
        return NULL;
    }
}

/* ---- files ---- */

enum { LANGUAGE_MAJOR = 1, LANGUAGE_MINOR = 0 };

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

/* A length's unit that is the present token, else NULL. */
static const UnitType *header_unit(const Parser *parser)
{
    const Token *token = &parser->token;
    if (token->kind != TOKEN_NAME && token->kind != TOKEN_IN) return NULL;
    const UnitType *unit = unit_of(token->as.symbol->text, token->as.symbol->length);
    return unit && unit->measure == UNIT_LENGTH ? unit : NULL;
}

static void set_unit(File *file, Span span, const UnitType *unit)
{
    file->has_unit = true;
    file->unit_span = span;
    file->unit_m = unit->size;
}

/* The scene is read in the unit of length that was meant; NULL: none was found. */
static void report_header_unit(Parser *parser, Span span, const char *what, const UnitType *unit)
{
    Diagnostic *report = diag_report(parser->diag, D_SYNTAX, span, "%s", what);
    diag_hint(parser->diag, report, "let the first line be: meniscus 1.0 unit %s", unit ? unit->name : "mm");
    if (unit) set_unit(parser->file, span, unit);
}

/* [ "unit" unit ], and what is written in its place by mistake. */
static void parse_header_unit(Parser *parser)
{
    bool is_word = token_is_word(&parser->token, "unit"), is_plural = token_is_word(&parser->token, "units");
    bool same_line = !first_on_line(parser);
    if ((begins_statement(parser) && !(is_word && same_line)) || (!same_line && !is_word)) return;
    Span span = token_span(parser);
    if (is_word || is_plural) consume(parser);
    bool assigned = (is_word || is_plural) && (parser->token.kind == TOKEN_ASSIGN || parser->token.kind == TOKEN_COLON);
    if (assigned) consume(parser);
    const UnitType *unit = header_unit(parser);
    if (assigned && unit) {
        report_header_unit(parser, span, "the unit stands directly behind the word 'unit'", unit);
    } else if (is_plural) {
        report_header_unit(parser, span, "the word is 'unit'", unit);
    } else if (is_word && unit) {
        set_unit(parser->file, token_span(parser), unit);
    } else if (is_word) {
        Diagnostic *report =
            diag_report(parser->diag, D_UNKNOWN_UNIT, token_span(parser), "expected a unit of length: %s, found %s",
                        unit_list(parser->arena, UNIT_LENGTH), found_text(parser));
        const char *text = parser->token.kind == TOKEN_STRING ? parser->token.as.text : "";
        if (unit_of(text, strlen(text))) diag_hint(parser->diag, report, "write: %s, without quotation marks", text);
        if (parser->token.kind == TOKEN_NAME) consume(parser);
    } else if (unit) {
        report_header_unit(parser, span, "the word 'unit' stands in front of the unit", unit);
    }
    if (unit) consume(parser);
}

/* Whether the header stands behind that of POV-Ray's scenes, as where a scene is carried over line by line. */
static bool report_no_header(Parser *parser)
{
    Span span = token_span(parser);
    bool version = span.end - span.begin == 8 && memcmp(parser->lexer.text + span.begin, "#version", 8) == 0;
    Diagnostic *report = diag_report(parser->diag, D_MISSING_HEADER, span, "the file does not begin with its header");
    bool directive = parser->token.kind == TOKEN_DIRECTIVE;
    if (version) skip_line(parser);
    bool below = version && at_header(parser);
    if (below) {
        diag_hint(parser->diag, report, "leave this out, so that the header is the first line");
        diag_note(parser->diag, report, token_span(parser), "the header is here");
    } else {
        diag_hint(parser->diag, report, "let the first line be: meniscus 1.0 unit mm");
    }
    if (directive)
        diag_note_nowhere(parser->diag, report, "meniscus-povray(7) says how scenes of POV-Ray are written here");
    return below;
}

/* "Meniscus 1.0" and "menicsus 1.0": the rest of the line is the header all the same. */
static bool is_misspelled_header(const Parser *parser)
{
    const char *const word = "meniscus";
    return parser->token.kind == TOKEN_NAME && peek(parser).kind == TOKEN_NUMBER &&
           !token_is_word(&parser->token, word) && suggest_nearest(parser->token.as.symbol->text, &word, 1);
}

/* "meniscus" number [ "unit" unit ] */
static void parse_header(Parser *parser, double unit_m)
{
    File *file = parser->file;
    file->unit_m = unit_m > 0 ? unit_m : 1;
    if (is_misspelled_header(parser)) {
        Diagnostic *report = diag_report(parser->diag, D_MISSING_HEADER, token_span(parser),
                                         "the header of a file begins with 'meniscus'");
        diag_hint(parser->diag, report, "did you mean 'meniscus'?");
    } else if (!token_is_word(&parser->token, "meniscus")) {
        if (!report_no_header(parser)) return;
    }
    consume(parser);
    Span version_span = token_span(parser);
    file->version = parser->token.number;
    const UnitType *version_unit = parser->token.unit;
    if (parser->token.kind != TOKEN_NUMBER) {
        Diagnostic *report = expected_error(parser, "a number (the version of the language) behind 'meniscus'");
        if (report) diag_hint(parser->diag, report, "let the first line be: meniscus 1.0 unit mm");
        return;
    }
    consume(parser);
    if (file->version < LANGUAGE_MAJOR || file->version >= LANGUAGE_MAJOR + 1)
        diag_report(parser->diag, D_UNSUPPORTED_VERSION, version_span,
                    "the file is in version %g of the language; this program reads %d.%d", file->version,
                    LANGUAGE_MAJOR, LANGUAGE_MINOR);
    if (version_unit) {
        report_header_unit(parser, version_span, "the version of the language has no unit",
                           version_unit->measure == UNIT_LENGTH ? version_unit : NULL);
        return;
    }
    parse_header_unit(parser);
}

/* The surplus '}' may be one further up, behind which the indentation goes on as if it were not there. */
static void report_stray_close(Parser *parser)
{
    Indents *indents = &parser->indents;
    if (!indents->extra) {
        diag_report(parser->diag, D_SYNTAX, token_span(parser), "this '}' closes nothing");
        return;
    }
    Diagnostic *report = diag_report(parser->diag, D_SYNTAX, indents->extra_close,
                                     "there is a '}' too many, this one by the indentation of what follows");
    diag_note(parser->diag, report, token_span(parser), "so that this one closes nothing");
    indents->extra = false;
}

/* Old files have carriage returns alone for line ends: a comment would take in all that is behind it. */
static bool has_lines(const File *file, Diag *diag)
{
    const Source *source = &diag->sources->sources[file->source];
    const char *text = source->text, *end = text + source->length, *at = text;
    while ((at = memchr(at, '\r', (size_t)(end - at)))) {
        const char *first = at;
        while (*at == '\r') at++;
        if (*at == '\n' || at == end) continue;
        uint32_t begin = (uint32_t)(first - text);
        Diagnostic *report = diag_report(diag, D_INVALID_CHARACTER, (Span){file->source, begin, begin + 1},
                                         "a carriage return without a line feed behind it ends no line");
        diag_hint(diag, report, "save the file with line feeds, or: tr '\\r' '\\n' < old.mns > new.mns");
        return false;
    }
    return true;
}

/* Pictures, meshes and texts in UTF-16 have zeros among their first bytes: one report for all of that. */
static bool is_text(const File *file, Diag *diag)
{
    const Source *source = &diag->sources->sources[file->source];
    size_t length = source->length < NEAR_LOOK ? source->length : NEAR_LOOK;
    const char *text = source->text;
    if (!memchr(text, 0, length) || strstr(text, "meniscus")) return true;
    Diagnostic *report = diag_report(diag, D_INVALID_UTF8, (Span){file->source, 0, 0}, "the file is no text in UTF-8");
    bool wide = memcmp(text, "\xff\xfe", 2) == 0 || memcmp(text, "\xfe\xff", 2) == 0;
    diag_hint(
        diag, report,
        wide ? "it is in UTF-16: save it as UTF-8"
             : "meniscus info says what pictures, meshes and grids hold, and meniscus import makes a scene of a mesh");
    return false;
}

/* Scenes of other programs, and meshes: one report for all that stands in them. */
static bool is_ours(const File *file, Diag *diag)
{
    const char *text = diag->sources->sources[file->source].text, *at = text + strspn(text, " \t\r\n");
    while ((at[0] == '#' && at[1] == ' ') || at[0] == ';') { /* their comments */
        at += strcspn(at, "\n");
        at += strspn(at, " \t\r\n");
    }
    const char *hint = habit_file(at);
    if (!hint) return true;
    uint32_t begin = (uint32_t)(at - text), length = (uint32_t)strcspn(at, " \t\r\n");
    Diagnostic *report = diag_report(diag, D_MISSING_HEADER, (Span){file->source, begin, begin + length},
                                     "the file does not begin with its header");
    diag_hint(diag, report, "%s", hint);
    return false;
}

/* file = "meniscus" number [ "unit" unit ] { stmt } ; */
void parse_file(File *file, bool has_header, double unit_m, Diag *diag, SymbolTable *symbols)
{
    Parser parser;
    file->block = ARENA_NEW(diag->arena, Block); /* stays when the tree does not */
    file->block->span = (Span){file->source, 0, 0};
    file->unit_m = unit_m > 0 ? unit_m : 1;
    if (has_header && !(is_text(file, diag) && has_lines(file, diag) && is_ours(file, diag))) return;
    parser_init(&parser, file, file->source, file->unit_m, diag, symbols);
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
        report_stray_close(&parser);
        consume(&parser);
    }
}

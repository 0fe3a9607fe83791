/* parser.c - the state of a parser: its tokens, its reports, looking ahead, and the way back from a mistake to the next
 * statement.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/parser.h"

#include <stdio.h>

/* ---- tokens ---- */

/* Tokens that must have been read behind a mistake before another one on its line counts, as in yacc. */
enum { CALM_AFTER = 2 };

void parser_init(Parser *parser, File *file, uint32_t source, double unit_m, Diag *diag, SymbolTable *symbols)
{
    *parser = (Parser){
        .diag = diag, .arena = file && file->arena ? file->arena : diag->arena, .file = file, .unit_m = unit_m};
    lexer_init(&parser->lexer, diag, symbols, source);
    calm_down(parser);
    parser->token = lexer_next(&parser->lexer);
}

void consume(Parser *parser)
{
    if (parser->fatal) return;
    parser->previous = parser->token.kind;
    parser->swallowed = parser->token.kind == TOKEN_STRING && parser->token.bad &&
                        parser->lexer.text[parser->token.begin] == '"' &&
                        parser->lexer.text[parser->token.end - 1] != '"';
    parser->calm = parser->diag->n_errors == parser->n_errors ? parser->calm + 1 : 0;
    parser->n_errors = parser->diag->n_errors;
    parser->token = lexer_next(&parser->lexer);
    if (parser->calm < CALM_AFTER && first_on_line(parser)) calm_down(parser);
}

void calm_down(Parser *parser)
{
    parser->calm = CALM_AFTER;
    parser->n_errors = parser->diag->n_errors;
}

Diagnostic *parser_report(Parser *parser, DiagCode code, Span span, const char *text)
{
    bool fresh = parser->diag->n_errors != parser->n_errors || parser->calm < CALM_AFTER;
    if (parser->diag->n_errors > 0 && fresh) return ARENA_NEW(parser->arena, Diagnostic);
    return diag_report(parser->diag, code, span, "%s", text);
}

bool consume_if(Parser *parser, TokenKind kind)
{
    if (parser->panic || parser->token.kind != kind) return false;
    consume(parser);
    return true;
}

Span token_span(const Parser *parser)
{
    return (Span){parser->lexer.source, parser->token.begin, parser->token.end};
}

uint32_t consumed_end(const Parser *parser)
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
    parser->panic_brackets = parser->brackets;
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return parser_report(parser, D_SYNTAX, span, text);
}

Diagnostic *limit_error(Parser *parser, Limit limit)
{
    const LimitRow *row = limit_row(limit);
    Diagnostic *report = syntax_error(parser, token_span(parser), "more than %.0f %s", row->number, row->what);
    if (report) limit_hint(parser->diag, report, limit);
    return report;
}

const char *found_text(const Parser *parser)
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
    if (consume_if(parser, kind)) return true;
    if (!parser->panic) expected_error(parser, arena_format(parser->arena, "%s %s", token_text(kind), context));
    return false;
}

/* ---- looking ahead without reporting ---- */

/* Words that begin a statement and nothing else; 'let', 'for' and 'if' stand within expressions, too. */
static bool begins_only_statements(TokenKind kind)
{
    switch (kind) {
    case TOKEN_VAR:
    case TOKEN_PARAM:
    case TOKEN_DEF:
    case TOKEN_DEFAULTS:
    case TOKEN_WHILE:
    case TOKEN_USE:
    case TOKEN_INCLUDE: return true;
    default: return false;
    }
}

void look_from(const Parser *parser, Look *look)
{
    look->lexer = parser->lexer;
    look->mute = (Diag){.arena = parser->diag->arena, .sources = parser->diag->sources};
    look->lexer.diag = &look->mute;
}

Token peek(const Parser *parser)
{
    Look look;
    look_from(parser, &look);
    return lexer_next(&look.lexer);
}

/* Are so many open ones closed before the statement ends? */
static bool brackets_close_ahead(const Parser *parser, int brackets)
{
    Look look;
    look_from(parser, &look);
    int braces = 0;
    for (Token token = parser->token;; token = lexer_next(&look.lexer)) {
        switch (token.kind) {
        case TOKEN_PAREN_OPEN:
        case TOKEN_BRACKET_OPEN: brackets++; break;
        case TOKEN_PAREN_CLOSE:
        case TOKEN_BRACKET_CLOSE:
            if (--brackets == 0) return true;
            break;
        case TOKEN_BRACE_OPEN: braces++; break;
        case TOKEN_BRACE_CLOSE:
            if (--braces < 0) return false;
            break;
        case TOKEN_END: return false;
        default:
            if (braces == 0 && (token.kind == TOKEN_SEMICOLON || begins_only_statements(token.kind))) return false;
            break;
        }
        if (token.begin > parser->token.begin + NEAR_LOOK) return false;
    }
}

/* ---- closing brackets ---- */

bool begins_comparison(TokenKind kind)
{
    return kind == TOKEN_LESS || kind == TOKEN_LESS_EQUAL || kind == TOKEN_GREATER_EQUAL || kind == TOKEN_EQUAL ||
           kind == TOKEN_NOT_EQUAL || kind == TOKEN_QUESTION || kind == TOKEN_AND || kind == TOKEN_OR;
}

bool expect_close(Parser *parser, TokenKind kind, Span opening, const char *expected)
{
    if (consume_if(parser, kind)) return true;
    if (parser->panic) return false;
    parser->panic = true;
    parser->panic_brackets = parser->brackets; /* where this one is closed further on, something else is missing */
    if (parser->brackets > 0 && !brackets_close_ahead(parser, parser->brackets)) parser->panic_brackets--;
    if (parser->swallowed) return false; /* by a string that is not closed: that is reported */
    uint32_t end = consumed_end(parser);
    Diagnostic *report =
        parser_report(parser, D_UNCLOSED_BRACKET, (Span){parser->lexer.source, end, end},
                      arena_format(parser->arena, "expected %s, found %s", expected, found_text(parser)));
    diag_note(parser->diag, report, opening, "to close this");
    if (kind == TOKEN_GREATER && begins_comparison(parser->token.kind)) diag_hint(parser->diag, report, WITHIN_VECTOR);
    return false;
}

bool expect_name(Parser *parser, const char *context, Symbol **name, Span *span)
{
    if (!parser->panic && parser->token.kind == TOKEN_NAME) {
        *name = parser->token.as.symbol;
        *span = token_span(parser);
        consume(parser);
        return true;
    }
    if (!parser->panic) {
        const Token *token = &parser->token;
        Diagnostic *report = expected_error(parser, arena_format(parser->arena, "a name %s", context));
        if (report && token->kind >= TOKEN_AND)
            diag_hint(parser->diag, report, "%s is a word of the language and cannot be a name",
                      token_text(token->kind));
    }
    return false;
}

bool enter(Parser *parser)
{
    if (parser->depth < LIMIT_NESTING) {
        parser->depth++;
        return true;
    }
    if (!parser->fatal && !parser->panic)
        limit_hint(
            parser->diag,
            diag_report(parser->diag, D_TOO_DEEP, token_span(parser), "nested deeper than %d levels", LIMIT_NESTING),
            OVER_NESTING);
    parser->panic = parser->fatal = true;
    parser->token.kind = TOKEN_END;
    return false;
}

void leave(Parser *parser)
{
    parser->depth--;
}

bool first_on_line(const Parser *parser)
{
    return begins_line(parser, parser->token.begin);
}

bool begins_line(const Parser *parser, uint32_t at)
{
    const char *text = parser->lexer.text;
    while (at > 0 && (text[at - 1] == ' ' || text[at - 1] == '\t')) at--;
    return at == 0 || text[at - 1] == '\n' || text[at - 1] == '\r';
}

bool begins_value(TokenKind kind)
{
    switch (kind) {
    case TOKEN_NUMBER:
    case TOKEN_STRING:
    case TOKEN_COLOR:
    case TOKEN_LESS:
    case TOKEN_MINUS:
    case TOKEN_BRACKET_OPEN:
    case TOKEN_TRUE:
    case TOKEN_FALSE:
    case TOKEN_NONE: return true;
    default: return false;
    }
}

bool starts_value(const Parser *parser)
{
    return begins_value(parser->token.kind);
}

void skip_brackets(Parser *parser)
{
    int depth = 0;
    do {
        TokenKind kind = parser->token.kind;
        depth += kind == TOKEN_BRACE_OPEN || kind == TOKEN_PAREN_OPEN || kind == TOKEN_BRACKET_OPEN;
        depth -= kind == TOKEN_BRACE_CLOSE || kind == TOKEN_PAREN_CLOSE || kind == TOKEN_BRACKET_CLOSE;
        if (kind == TOKEN_END) return;
        consume(parser);
    } while (depth > 0);
}

/* ---- the way back from a mistake ---- */

static bool starts_statement(const Parser *parser, int brackets)
{
    bool fresh_line = first_on_line(parser);
    TokenKind kind = parser->token.kind, next = kind == TOKEN_NAME ? peek(parser).kind : TOKEN_END;
    if (begins_only_statements(kind) || kind == TOKEN_LET || kind == TOKEN_FOR || kind == TOKEN_IF ||
        next == TOKEN_ASSIGN || next == TOKEN_CHANGE)
        return fresh_line || brackets == 0;
    return fresh_line &&
           (next == TOKEN_BRACE_OPEN || next == TOKEN_NAME || next == TOKEN_PAREN_OPEN || next == TOKEN_DOT);
}

void synchronize(Parser *parser, int brackets, uint32_t statement_begin)
{
    int braces = 0;
    bool closes = brackets > 0 && brackets_close_ahead(parser, brackets);
    parser->panic = parser->fatal;
    while (parser->token.kind != TOKEN_END) {
        TokenKind kind = parser->token.kind;
        if (braces == 0 && !(closes && brackets > 0)) {
            if (kind == TOKEN_BRACE_CLOSE) return;
            if (parser->token.begin > statement_begin && starts_statement(parser, brackets)) return;
        }
        consume(parser);
        if (kind == TOKEN_PAREN_OPEN || kind == TOKEN_BRACKET_OPEN) brackets++;
        if ((kind == TOKEN_PAREN_CLOSE || kind == TOKEN_BRACKET_CLOSE) && brackets > 0) brackets--;
        if (kind == TOKEN_SEMICOLON && braces == 0) return;
        if (kind == TOKEN_BRACE_OPEN) braces++;
        if (kind == TOKEN_BRACE_CLOSE && --braces == 0) return;
    }
}

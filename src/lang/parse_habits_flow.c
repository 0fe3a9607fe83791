/* parse_habits_flow.c - loops and choices in the way of other languages: reported with what is written here, and then read as
 * they were meant.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/parse_habits.h"

#include <string.h>

#include "lang/habits.h"

static bool at_word(const Parser *parser, const char *word)
{
    return parser->token.kind == TOKEN_NAME && strcmp(parser->token.as.symbol->text, word) == 0;
}

/* ---- loops ---- */

/* for (i, c in list), at the comma */
static bool parse_numbered_element(Parser *parser, Diagnostic *report, const char *number)
{
    Look look;
    look_from(parser, &look);
    Token element = lexer_next(&look.lexer);
    if (element.kind != TOKEN_NAME || lexer_next(&look.lexer).kind != TOKEN_IN) return false;
    for (int i = 0; i < 3; i++) consume(parser);
    const char *list = quote_read(parser, parse_expr);
    if (parser->panic) return true;
    diag_hint(parser->diag, report, "write: for (%s in 0..<len(%s)) { let %s = %s[%s] ... }", number, list,
              element.as.symbol->text, list, number);
    consume_if(parser, TOKEN_PAREN_CLOSE);
    return true;
}

/* for (i, 0, 10), behind the '(' */
static bool parse_listed_loop(Parser *parser)
{
    if (parser->token.kind != TOKEN_NAME || peek(parser).kind != TOKEN_COMMA) return false;
    const char *variable = parser->token.as.symbol->text, *parts[3] = {NULL, NULL, NULL};
    Diagnostic *report = report_at(parser, token_span(parser), "a loop runs over a list or a range");
    consume(parser);
    if (parse_numbered_element(parser, report, variable)) return true;
    for (unsigned n = 0; parser->token.kind == TOKEN_COMMA && n < COUNT_OF(parts); n++) {
        consume(parser);
        parts[n] = quote_read(parser, parse_expr);
        if (parser->panic) return true;
    }
    diag_hint(parser->diag, report, "write: for (%s in %s..%s%s%s) { ... }", variable, parts[0] ? parts[0] : "1",
              parts[1] ? parts[1] : "10", parts[2] ? " by " : "", parts[2] ? parts[2] : "");
    consume_if(parser, TOKEN_PAREN_CLOSE);
    return true;
}

bool parse_foreach(Parser *parser)
{
    const Symbol *word = parser->token.as.symbol;
    if (strcmp(word->text, "foreach") != 0 || word->declared != SYMBOL_FREE || peek(parser).kind != TOKEN_PAREN_OPEN)
        return false;
    hint_write(parser, report_at(parser, token_span(parser), "there is no statement 'foreach'"),
               "for (i in list) { ... }");
    parser->token.kind = TOKEN_FOR;
    return true;
}

/* "do { ... } while (n < 10)" and "do { ... } until (n == 10)", and "repeat" in its place */
bool parse_do_loop(Parser *parser)
{
    const Symbol *word = parser->token.as.symbol;
    bool loop = strcmp(word->text, "do") == 0 || strcmp(word->text, "repeat") == 0;
    if (!loop || word->declared != SYMBOL_FREE || peek(parser).kind != TOKEN_BRACE_OPEN) return false;
    Diagnostic *report = report_at(parser, token_span(parser), "there is no statement '%s'", word->text);
    consume(parser);
    parse_block(parser);
    const char *condition = "...";
    bool until = at_word(parser, "until");
    if (!parser->panic && (until || parser->token.kind == TOKEN_WHILE) && peek(parser).kind == TOKEN_PAREN_OPEN) {
        consume(parser);
        uint32_t begin = parser->token.end;
        skip_brackets(parser);
        condition = quote(parser, begin, consumed_end(parser) - 1);
    }
    diag_hint(parser->diag, report, "write: while (%s%s%s) { ... }, which is asked before each turn",
              until ? "not (" : "", condition, until ? ")" : "");
    return true;
}

/* Where the last of the tokens ends that stand in front of the ')' of what is open. */
static uint32_t end_of_bracket(const Token *tokens, size_t n)
{
    int depth = 0;
    uint32_t end = tokens[0].end;
    for (size_t i = 0; i < n; i++) {
        depth += (tokens[i].kind == TOKEN_PAREN_OPEN) - (tokens[i].kind == TOKEN_PAREN_CLOSE);
        if (depth < 0) break;
        end = tokens[i].end;
    }
    return end;
}

/* "5 step 2" as it is written here, up to that ')' */
static const char *last_and_step(Parser *parser, const Token *tokens, size_t n)
{
    uint32_t end = end_of_bracket(tokens, n);
    for (size_t i = 1; i + 1 < n && tokens[i].begin < end; i++)
        if (tokens[i].kind == TOKEN_NAME && strcmp(tokens[i].as.symbol->text, "step") == 0)
            return arena_format(parser->arena, "%s by %s", quote(parser, tokens[0].begin, tokens[i - 1].end),
                                quote(parser, tokens[i + 1].begin, end));
    return quote(parser, tokens[0].begin, end);
}

/* for (int i = 0; i < 10; i++), behind the '(' */
bool parse_counting_loop(Parser *parser)
{
    if (parse_listed_loop(parser)) return true;
    Look look;
    look_from(parser, &look);
    Token name = parser->token, next = lexer_next(&look.lexer);
    bool has_type = name.kind == TOKEN_NAME || name.kind == TOKEN_LET || name.kind == TOKEN_VAR;
    if (has_type && next.kind == TOKEN_NAME) {
        name = next;
        next = lexer_next(&look.lexer);
    }
    if (name.kind != TOKEN_NAME || next.kind != TOKEN_ASSIGN) return false;
    Token tokens[64];
    size_t n = 0, semicolons[2] = {0, 0}, n_semicolons = 0;
    for (; n < COUNT_OF(tokens); n++) {
        tokens[n] = lexer_next(&look.lexer);
        if (tokens[n].kind == TOKEN_END) break;
        if (tokens[n].kind == TOKEN_SEMICOLON && n_semicolons < 2) semicolons[n_semicolons++] = n;
        if (n_semicolons == 2) break;
    }
    Diagnostic *report = report_at(parser, token_span(parser), "a loop runs over a list or a range");
    size_t to = 1;
    while (to < n && !(tokens[to].kind == TOKEN_NAME && strcmp(tokens[to].as.symbol->text, "to") == 0)) to++;
    size_t a = semicolons[0], b = semicolons[1];
    const char *variable = name.as.symbol->text,
               *hint = arena_format(parser->arena, "for (%s in 1..10) { ... }", variable);
    if (n_semicolons == 0 && to + 1 < n) /* i = 1 to 5 step 2 */
        hint = arena_format(parser->arena, "for (%s in %s..%s) { ... }", variable,
                            quote(parser, tokens[0].begin, tokens[to - 1].end),
                            last_and_step(parser, tokens + to + 1, n - to - 1));
    if (n > 4 && tokens[0].kind == TOKEN_BRACKET_OPEN && tokens[2].kind == TOKEN_COLON) /* i = [0:5] */
        hint =
            arena_format(parser->arena, "for (%s in %s..%s) { ... }", variable,
                         quote(parser, tokens[1].begin, tokens[1].end), quote(parser, tokens[3].begin, tokens[3].end));
    if (n_semicolons == 2 && a > 0 && b > a + 3 &&
        (tokens[a + 2].kind == TOKEN_LESS || tokens[a + 2].kind == TOKEN_LESS_EQUAL))
        hint = arena_format(
            parser->arena, "for (%s in %s%s%s) { ... }", variable, quote(parser, tokens[0].begin, tokens[a - 1].end),
            tokens[a + 2].kind == TOKEN_LESS ? "..<" : "..", quote(parser, tokens[a + 3].begin, tokens[b - 1].end));
    hint_write(parser, report, hint);
    int depth = 1; /* to behind the ')' */
    while (depth > 0 && parser->token.kind != TOKEN_END && parser->token.kind != TOKEN_BRACE_OPEN) {
        depth += (parser->token.kind == TOKEN_PAREN_OPEN) - (parser->token.kind == TOKEN_PAREN_CLOSE);
        consume(parser);
    }
    return true;
}

/* for (x in a, y in b), at the comma */
void parse_second_variable(Parser *parser, const char *first)
{
    Look look;
    look_from(parser, &look);
    Token name = lexer_next(&look.lexer);
    if (name.kind != TOKEN_NAME || lexer_next(&look.lexer).kind != TOKEN_IN) return;
    Diagnostic *report = report_at(parser, token_span(parser), "a loop has one variable");
    diag_hint(parser->diag, report, "write: for (%s in ...) { for (%s in ...) { ... } }", first, name.as.symbol->text);
    while (parser->token.kind == TOKEN_COMMA) {
        consume(parser);
        if (!consume_if(parser, TOKEN_NAME) || !consume_if(parser, TOKEN_IN)) return;
        parse_expr(parser);
    }
}

void parse_loop_type(Parser *parser)
{
    bool binds = parser->token.kind == TOKEN_LET || parser->token.kind == TOKEN_VAR;
    if (!binds && (parser->token.kind != TOKEN_NAME || !habit_is_type(parser->token.as.symbol->text))) return;
    Token next = peek(parser);
    if (next.kind != TOKEN_NAME) return;
    Diagnostic *report = report_at(parser, token_span(parser), "the name of a loop has no %s in front of it",
                                   binds ? token_text(parser->token.kind) : "type");
    diag_hint(parser->diag, report, "write: for (%s in ...) { ... }", next.as.symbol->text);
    consume(parser);
}

void parse_loop_step(Parser *parser)
{
    if (!at_word(parser, "step") && !at_word(parser, "stride")) return;
    Diagnostic *report =
        report_at(parser, token_span(parser), "expected ')', found '%s'", parser->token.as.symbol->text);
    consume(parser);
    const char *step = quote_read(parser, parse_expr);
    if (!parser->panic) diag_hint(parser->diag, report, "write: by %s", step);
}

/* How a range goes on behind a word of other languages; NULL: it does not. */
static const char *range_points(const Parser *parser)
{
    if (parser->token.kind == TOKEN_COLON) return "..";
    if (parser->token.kind != TOKEN_NAME) return NULL;
    const char *word = parser->token.as.symbol->text;
    if (habit_is_one_of("to upto thru through", word)) return "..";
    return habit_is_one_of("until till", word) ? "..<" : NULL;
}

const char *parse_range_habit(Parser *parser, uint32_t begin, bool with_steps, bool reports)
{
    const char *points = range_points(parser), *range = quote(parser, begin, consumed_end(parser));
    if (!points && !(with_steps && at_word(parser, "step"))) return NULL;
    Diagnostic *report = reports ? expected_error(parser, "'..'") : NULL;
    parser->panic = false;
    if (points) {
        consume(parser);
        range = arena_format(parser->arena, "%s%s%s", range, points, quote_read(parser, parse_expr));
    }
    if (!parser->panic && (parser->token.kind == TOKEN_BY || at_word(parser, "step"))) {
        consume(parser);
        range = arena_format(parser->arena, "%s by %s", range, quote_read(parser, parse_expr));
    }
    if (report && !parser->panic) diag_hint(parser->diag, report, "write: %s", range);
    if (report && parser->panic) diag_hint(parser->diag, report, "a range is written 1..9");
    return range;
}

void parse_three_points(Parser *parser, const Expr *first)
{
    Span points = {parser->lexer.source, parser->token.begin, parser->token.end + 1};
    if (parser->lexer.text[parser->token.end] != '.') return;
    Token last = peek(parser);
    Diagnostic *report = report_at(parser, points, "a range has two points, and not three");
    diag_hint(parser->diag, report, "write: %s..%s", quote(parser, first->span.begin, first->span.end),
              last.kind == TOKEN_NUMBER ? quote(parser, last.begin + 1, last.end) : "n");
}

/* ---- choices ---- */

bool parse_switch(Parser *parser)
{
    const Symbol *word = parser->token.as.symbol;
    bool choice = at_word(parser, "switch") || at_word(parser, "match") || at_word(parser, "select");
    if (!choice || word->declared != SYMBOL_FREE || peek(parser).kind != TOKEN_PAREN_OPEN) return false;
    Diagnostic *report = report_at(parser, token_span(parser), "there is no statement '%s'", word->text);
    consume(parser);
    uint32_t begin = parser->token.end;
    skip_brackets(parser);
    const char *subject = quote(parser, begin, consumed_end(parser) - 1);
    diag_hint(parser->diag, report, "write: if (%s == 1) { ... } else if (%s == 2) { ... } else { ... }", subject,
              subject);
    if (parser->token.kind == TOKEN_BRACE_OPEN) skip_brackets(parser);
    return true;
}

/* parse_habits_block.c - blocks in the way of other languages, or with a brace left out: reported with what is written here, and
 * then read as they were meant, or passed over.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/parse_habits.h"

#include <string.h>

#include "lang/habits.h"

enum {
    LONGEST_LOOK = 1 << 18, /* bytes to look ahead for a closing brace */
    MOST_LOOKS = 64         /* of those, for one file */
};

/* ---- blocks with a brace too few or too many ---- */

/* How many blocks stay open to the end of the text; -1: there is a '}' too many, so that a '{' must be missing. */
static long blocks_at_end(Parser *parser)
{
    if (++parser->looks > MOST_LOOKS) return 0;
    Look look;
    look_from(parser, &look);
    long open = parser->blocks;
    for (Token token = parser->token; token.kind != TOKEN_END && open >= 0; token = lexer_next(&look.lexer)) {
        if (token.begin > parser->token.begin + LONGEST_LOOK) return 0;
        open += (token.kind == TOKEN_BRACE_OPEN) - (token.kind == TOKEN_BRACE_CLOSE);
    }
    return open;
}

bool lacks_opening_brace(Parser *parser)
{
    return blocks_at_end(parser) < 0;
}

bool parse_brace_habit(Parser *parser)
{
    if (parser->token.kind != TOKEN_BRACE_OPEN) return false;
    report_at(parser, token_span(parser), "expected a statement, found '{'");
    if (blocks_at_end(parser) > 0)
        consume(parser);
    else
        parse_block(parser);
    return true;
}

void block_without_opening(Parser *parser, const char *node)
{
    /* as any block: else its statements would pass for those at the top, whose trees are not kept */
    if (!enter(parser)) return;
    const char *outer = parser->node;
    parser->node = node;
    parser->blocks++;
    parse_stmts(parser, TOKEN_BRACE_CLOSE);
    parser->blocks--;
    parser->node = outer;
    leave(parser);
    consume_if(parser, TOKEN_BRACE_CLOSE);
}

/* ---- blocks that are POV-Ray's ---- */

/* Is what stands between the braces, of which the next token is the opening one, nothing that the grammar allows,
 * and without any '='? Then it is a block of POV-Ray's. */
static bool block_is_foreign(Parser *parser)
{
    Look look;
    look_from(parser, &look);
    int braces = 1, brackets = 0;
    bool foreign = false, named = false;
    TokenKind before = TOKEN_BRACE_OPEN;
    while (braces > 0) {
        Token token = lexer_next(&look.lexer);
        TokenKind kind = token.kind;
        if (kind == TOKEN_END || kind == TOKEN_ASSIGN || kind == TOKEN_CHANGE ||
            token.begin > parser->token.begin + LONGEST_LOOK)
            return false;
        bool value = kind == TOKEN_NUMBER || kind == TOKEN_LESS || kind == TOKEN_STRING;
        if (brackets == 0) {
            foreign |= value && (before == TOKEN_NAME || before == TOKEN_BRACE_OPEN);
            foreign |= before == TOKEN_NAME && (kind == TOKEN_COMMA || kind == TOKEN_BRACE_CLOSE);
            foreign |= kind >= TOKEN_PLUS && kind <= TOKEN_CARET; /* x ^ 2 + y ^ 2 */
            foreign |= named && kind != TOKEN_BRACE_OPEN;         /* two names, and no block behind them */
        }
        named = brackets == 0 && before == TOKEN_NAME && kind == TOKEN_NAME;
        braces += (kind == TOKEN_BRACE_OPEN) - (kind == TOKEN_BRACE_CLOSE);
        brackets += (kind == TOKEN_PAREN_OPEN || kind == TOKEN_BRACKET_OPEN);
        brackets -= (kind == TOKEN_PAREN_CLOSE || kind == TOKEN_BRACKET_CLOSE) && brackets > 0;
        before = kind;
    }
    return foreign;
}

bool parse_block_habit(Parser *parser, Path path)
{
    const char *text = path.n == 1 ? habit_block(path.names[0]->text) : NULL;
    if (!text || parser->token.kind != TOKEN_BRACE_OPEN || !block_is_foreign(parser)) return false;
    const char *word = path.names[0]->text, *ours = strstr(text, word); /* "write: lathe { ... }" */
    bool known = ours && ours[strlen(word)] == ' ' && ours[strlen(word) + 1] == '{';
    Diagnostic *report =
        report_at(parser, path.span,
                  known ? "what stands in this '%s' is POV-Ray's" : "'%s' and what stands in it are POV-Ray's", word);
    diag_hint(parser->diag, report, "%s", text);
    skip_brackets(parser);
    return true;
}

/* ---- blocks that end at a word, or are one statement ---- */

/* Does no '{' follow what stands in brackets here, behind the word 'if' or the like? */
static bool lacks_block(Lexer lexer)
{
    Token token = lexer_next(&lexer);
    int brackets = 0;
    do {
        brackets += (token.kind == TOKEN_PAREN_OPEN) - (token.kind == TOKEN_PAREN_CLOSE);
        token = lexer_next(&lexer);
    } while (brackets > 0 && token.kind != TOKEN_END);
    return token.kind != TOKEN_BRACE_OPEN;
}

static bool is_end_word(const Parser *parser, const Token *token, Lexer behind)
{
    if (token->kind != TOKEN_NAME || strcmp(token->as.symbol->text, "end") != 0) return false;
    Token next = lexer_next(&behind);
    return begins_line(parser, token->begin) &&
           (next.kind == TOKEN_END || next.kind == TOKEN_BRACE_CLOSE || begins_line(parser, next.begin));
}

/* Where the word 'end' closes what is being read, alone on its line, as in POV-Ray and in languages without braces; 0:
 * nowhere. */
static uint32_t end_word_ahead(Parser *parser)
{
    if (++parser->looks > MOST_LOOKS) return 0;
    Look look;
    look_from(parser, &look);
    int braces = 0, open = 1;
    TokenKind before = TOKEN_END;
    for (Token token = parser->token; token.kind != TOKEN_END && braces >= 0; token = lexer_next(&look.lexer)) {
        if (token.begin > parser->token.begin + LONGEST_LOOK || token.kind == TOKEN_DEF) return 0;
        bool opens =
            (token.kind == TOKEN_IF && before != TOKEN_ELSE) || token.kind == TOKEN_FOR || token.kind == TOKEN_WHILE;
        before = token.kind;
        braces += (token.kind == TOKEN_BRACE_OPEN) - (token.kind == TOKEN_BRACE_CLOSE);
        if (braces > 0) continue;
        open += opens && begins_line(parser, token.begin) && lacks_block(look.lexer);
        open -= is_end_word(parser, &token, look.lexer);
        if (open == 0) return token.begin;
    }
    return 0;
}

/* Statements up to behind the word that begins there, or to an 'else'. */
static void parse_to_end_word(Parser *parser, uint32_t end)
{
    if (!enter(parser)) return;
    while (parser->token.begin < end && parser->token.kind != TOKEN_END && parser->token.kind != TOKEN_ELSE) {
        uint32_t begin = parser->token.begin;
        parse_stmt(parser);
        if (parser->panic) synchronize(parser, parser->panic_brackets, begin);
        if (parser->token.begin == begin) break;
    }
    if (parser->token.begin == end) consume(parser);
    leave(parser);
}

/* "return x * 2" or "x * 2", up to behind the word that begins there: its text; NULL: there are statements. */
static const char *value_to_end_word(Parser *parser, uint32_t end)
{
    TokenKind next = peek(parser).kind;
    bool name = parser->token.kind == TOKEN_NAME,
         returns = name && strcmp(parser->token.as.symbol->text, "return") == 0;
    bool computed = starts_value(parser) || (name && next >= TOKEN_PLUS && next <= TOKEN_CARET);
    if (!returns && !computed) return NULL;
    if (returns) consume(parser);
    uint32_t begin = parser->token.begin;
    while (parser->token.begin < end && parser->token.kind != TOKEN_END) consume(parser);
    const char *value = quote(parser, begin, consumed_end(parser));
    consume(parser);
    return value;
}

Expr *parse_bodiless_def(Parser *parser, const char *head, bool reports)
{
    uint32_t end = end_word_ahead(parser);
    Expr *body = expr_new(parser, EXPR_POISON, token_span(parser));
    Diagnostic *report = reports || !end ? expected_error(parser, "'=' or '{' behind the parameters") : NULL;
    if (end) {
        parser->panic = false;
        const char *value = value_to_end_word(parser, end);
        if (report && value)
            diag_hint(parser->diag, report, "write: def %s = %s", head, value);
        else if (report)
            diag_hint(parser->diag, report, "a block stands in braces: { ... }");
        if (value) return body;
        parse_to_end_word(parser, end);
        return NULL;
    }
    TokenKind next = peek(parser).kind;
    bool expression = parser->token.kind == TOKEN_NAME && next != TOKEN_BRACE_OPEN && next != TOKEN_NAME &&
                      next != TOKEN_ASSIGN && next != TOKEN_CHANGE;
    if (expression || starts_value(parser) || !lacks_opening_brace(parser)) return body;
    parser->panic = false;
    block_without_opening(parser, NULL);
    return NULL;
}

void parse_bare_block(Parser *parser, Block *block)
{
    Diagnostic *report = expected_error(parser, "'{' to begin a block");
    if (!report || parser->token.kind == TOKEN_BRACE_CLOSE || parser->token.kind == TOKEN_END) return;
    parser->panic = false;
    uint32_t end = end_word_ahead(parser);
    if (!end && lacks_opening_brace(parser)) {
        block_without_opening(parser, parser->node);
        return;
    }
    diag_hint(parser->diag, report, "a block stands in braces%s: { ... }", end ? "" : ", even if it is one statement");
    if (end) {
        parse_to_end_word(parser, end);
        return;
    }
    if (!enter(parser)) return;
    block->first = parse_stmt(parser);
    leave(parser);
}

/* parse_directives.c - POV-Ray's directives, '#declare' and the like: reported, and read over as far as they go.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "lang/habits.h"
#include "lang/parse_habits.h"

/* (I, 1, 9): what stands between the brackets, as a range */
static const char *loop_text(const Parser *parser, const char *inner)
{
    const char *comma = strchr(inner, ','), *second = comma ? strchr(comma + 1, ',') : NULL;
    if (!second) return "i in 1..9";
    int length = (int)(second - comma) - 1;
    const char *first = comma + 1 + strspn(comma + 1, " "), *last = second + 1 + strspn(second + 1, " ");
    const char *third = strchr(last, ',');
    int last_length = third ? (int)(third - last) : (int)strlen(last);
    const char *step = third ? arena_format(parser->arena, " by%s", third + 1) : "";
    return arena_format(parser->arena, "%.*s in %.*s..%.*s%s", (int)(comma - inner), inner,
                        length - (int)(first - comma - 1), first, last_length, last, step);
}

/* A condition of POV-Ray's, in which '=' compares. */
static const char *with_equality(const Parser *parser, const char *text)
{
    const char *sign = strchr(text, '=');
    if (!sign || sign == text || strchr("<>!=", sign[-1]) || sign[1] == '=') return text;
    return arena_format(parser->arena, "%.*s=%s", (int)(sign - text), text, sign);
}

/* The text behind the directive as the pattern wants it; the parser stands behind what was read. */
static const char *directive_rest(Parser *parser, DirectiveForm form)
{
    uint32_t begin = parser->token.begin;
    if (form == DIRECTIVE_BIND && parser->token.kind == TOKEN_NAME) {
        Span name = token_span(parser);
        consume(parser);
        if (!consume_if(parser, TOKEN_ASSIGN)) return "NAME = VALUE";
        parse_expr(parser);
        uint32_t end = consumed_end(parser);
        return memchr(parser->lexer.text + begin, '{', end - begin)
                   ? arena_format(parser->arena, "%s = ...", quote(parser, name.begin, name.end))
                   : quote(parser, begin, end);
    }
    if (form == DIRECTIVE_OPENS || form == DIRECTIVE_LOOP) {
        if (parser->token.kind == TOKEN_NAME) consume(parser); /* of a macro */
        uint32_t inner = parser->token.end;
        if (parser->token.kind == TOKEN_PAREN_OPEN) skip_brackets(parser);
        uint32_t end = consumed_end(parser);
        if (form == DIRECTIVE_OPENS) return with_equality(parser, quote(parser, begin, end));
        return loop_text(parser, quote(parser, inner, end > inner ? end - 1 : inner));
    }
    if (form == DIRECTIVE_LINE)
        while (!first_on_line(parser) && parser->token.kind != TOKEN_END && parser->token.kind != TOKEN_BRACE_CLOSE)
            parser->token.kind == TOKEN_BRACE_OPEN ? skip_brackets(parser) : consume(parser);
    return "...";
}

static bool holds_word(const char *text, const char *word)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
    for (size_t length; *text; text += length ? length : 1) {
        length = strspn(text, letters);
        if (length > 0 && length == strlen(word) && memcmp(text, word, length) == 0) return true;
    }
    return false;
}

/* What takes the place of a file that comes with POV-Ray; name: in quotes. NULL: it is another one. */
static const char *in_place_of(const Parser *parser, const char *name)
{
    size_t length = strlen(name), around = strlen("\"") + strlen(".inc\"");
    if (length <= around || strcmp(name + length - 5, ".inc\"") != 0) return NULL;
    return habit_library(arena_format(parser->arena, "%.*s", (int)(length - around), name + 1));
}

/* What a directive becomes by what stands around it, and by what it names; NULL: what the table says. */
static const char *special_pattern(const Parser *parser, DirectiveForm form, const char *word, const char *name,
                                   const char *rest)
{
    const char *value = rest + strlen(name) + strspn(rest + strlen(name), " =");
    const bool binds = form == DIRECTIVE_BIND && strlen(rest) > strlen(name);
    if (binds && holds_word(value, name)) /* N = N + 1 */
        return arena_format(parser->arena, "%s := %s, and var %s where it is declared", name, value, name);
    if (binds && parser->directives > 0 && strcmp(word, "declare") == 0)
        return arena_format(parser->arena,
                            "let %s = %s, or, where it is used behind this block, "
                            "var %s = ... before that and %s := %s here",
                            name, value, name, name, value);
    return NULL;
}

void parse_directive(Parser *parser)
{
    Span span = token_span(parser);
    const char *word = quote(parser, span.begin + 1, span.end), *pattern = habit_directive_pattern(word);
    DirectiveForm form = habit_directive(word, strlen(word));
    bool inner = parser->directives > 0 && (form == DIRECTIVE_MIDDLE || form == DIRECTIVE_END);
    Diagnostic *report = NULL; /* the opening one has said it */
    if (!inner) report = report_at(parser, span, "'#%s' is POV-Ray's", word);
    consume(parser);
    parser->directives += (form == DIRECTIVE_OPENS || form == DIRECTIVE_LOOP);
    parser->directives -= inner && form == DIRECTIVE_END;
    if (form == DIRECTIVE_MIDDLE && parser->token.kind == TOKEN_PAREN_OPEN) skip_brackets(parser);
    uint32_t name_end = parser->token.end, name_begin = parser->token.begin;
    const char *rest = directive_rest(parser, form), *name = quote(parser, name_begin, name_end);
    const char *special = special_pattern(parser, form, word, name, rest);
    if (special) pattern = special;
    const char *instead = strcmp(word, "include") == 0 ? in_place_of(parser, name) : NULL;
    if (!report || parser->panic) return;
    if (instead)
        diag_hint(parser->diag, report, "%s", instead);
    else if (pattern)
        hint_write(parser, report, habit_fill(parser->arena, pattern, rest));
}

/* parse_habits_expr.c - the same within expressions: colours, lists, functions, operators and units in the way of other
 * languages.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/num.h"
#include "lang/builtin.h"
#include "lang/habits.h"
#include "lang/parse_habits.h"

/* ---- colours ---- */

/* Does a vector begin here, and not a comparison: is there a comma before the '>'? In brackets commas may also end what a
 * comparison is the last part of: [a < b, c > d]; then nothing follows the '>' that it could compare with. */
static bool vector_ahead(const Parser *parser)
{
    Look look;
    look_from(parser, &look);
    int brackets = 0;
    bool comma = false;
    for (Token token = lexer_next(&look.lexer); token.begin < parser->token.begin + NEAR_LOOK;
         token = lexer_next(&look.lexer)) {
        comma |= brackets == 0 && token.kind == TOKEN_COMMA;
        if (comma && parser->brackets == 0) return true;
        if (comma && brackets == 0 && token.kind == TOKEN_GREATER) {
            TokenKind next = lexer_next(&look.lexer).kind;
            return !begins_value(next) && next != TOKEN_NAME && next != TOKEN_PAREN_OPEN;
        }
        brackets += token.kind == TOKEN_PAREN_OPEN || token.kind == TOKEN_BRACKET_OPEN;
        brackets -= token.kind == TOKEN_PAREN_CLOSE || token.kind == TOKEN_BRACKET_CLOSE;
        if (brackets < 0 || token.kind == TOKEN_GREATER || token.kind == TOKEN_ASSIGN ||
            token.kind == TOKEN_BRACE_OPEN || token.kind == TOKEN_BRACE_CLOSE || token.kind == TOKEN_END)
            return false;
    }
    return false;
}

/* What may stand between a comparison and its '?', outside of brackets. */
static bool is_in_condition(TokenKind kind)
{
    return kind == TOKEN_NAME || kind == TOKEN_NUMBER || kind == TOKEN_DOT || kind == TOKEN_AND || kind == TOKEN_OR ||
           (kind >= TOKEN_PLUS && kind <= TOKEN_CARET);
}

/* Does a '>' compare with what follows, on the way to a '?'? Behind a vector no name or number could stand. */
static bool compares_ahead(const Parser *parser)
{
    Look look;
    look_from(parser, &look);
    Token token = lexer_next(&look.lexer);
    bool may = token.kind == TOKEN_NAME || token.kind == TOKEN_NUMBER;
    bool another = false; /* behind 'and' and 'or' there may be a second one */
    int brackets = 0;
    while (may && (brackets > 0 || token.kind != TOKEN_QUESTION)) {
        bool opens = token.kind == TOKEN_PAREN_OPEN || token.kind == TOKEN_BRACKET_OPEN;
        bool closes = token.kind == TOKEN_PAREN_CLOSE || token.kind == TOKEN_BRACKET_CLOSE;
        bool second = another && token.kind == TOKEN_GREATER;
        may = opens || second || (brackets > 0 ? token.kind != TOKEN_END : is_in_condition(token.kind));
        if (brackets == 0) another = !second && (another || token.kind == TOKEN_AND || token.kind == TOKEN_OR);
        brackets += opens - closes;
        if (token.begin > parser->token.begin + NEAR_LOOK) return false;
        token = lexer_next(&look.lexer);
    }
    return may;
}

bool parse_vector_comparison(Parser *parser)
{
    if (parser->panic || !compares_ahead(parser)) return false;
    diag_hint(parser->diag, report_at(parser, token_span(parser), "'>' ends the vector here"), WITHIN_VECTOR);
    do { /* and is read on as if it stood there in parentheses */
        consume(parser);
        parse_add(parser);
    } while (!parser->panic && (begins_comparison(parser->token.kind) || parser->token.kind == TOKEN_COLON ||
                                (parser->token.kind == TOKEN_GREATER && compares_ahead(parser))));
    return true;
}

/* "rgb 1", "rgb <1, .5, 0>" and "color rgb ...", behind the first word */
bool parse_color_habit(Parser *parser, const char *word)
{
    if (!is_color_word(word) || first_on_line(parser)) return false;
    if (parser->token.kind == TOKEN_NAME) {
        TokenKind next = peek(parser).kind;
        if (!is_color_word(parser->token.as.symbol->text) || (next != TOKEN_NUMBER && next != TOKEN_LESS)) return false;
    } else if (parser->token.kind != TOKEN_NUMBER && !(parser->token.kind == TOKEN_LESS && vector_ahead(parser))) {
        return false;
    }
    Diagnostic *report =
        report_at(parser, behind_last(parser), "expected '(' behind '%s', found %s", word, found_text(parser));
    if (parser->token.kind == TOKEN_NAME) word = parser->token.as.symbol->text, consume(parser);
    bool vector = parser->token.kind == TOKEN_LESS, encoded = strcmp(word, "srgb") == 0;
    uint32_t begin = parser->token.begin;
    parse_prim(parser);
    if (parser->panic) return true;
    const char *value = quote(parser, begin + vector, consumed_end(parser) - vector);
    hint_write(parser, report, vector ? arena_format(parser->arena, encoded ? "srgb(%s)" : "rgb(%s)", value) : value);
    calm_down(parser);
    return true;
}

/* ---- values of POV-Ray's ---- */

/* "array[3] {1, 2, 3}" and "array {1, 2, 3}", and functions in braces, "function(x) { 2 * x }", behind the word */
bool parse_array_habit(Parser *parser, const char *word, Span span)
{
    bool array = strcmp(word, "array") == 0, function = strcmp(word, "function") == 0;
    TokenKind opening = array ? TOKEN_BRACKET_OPEN : TOKEN_PAREN_OPEN,
              closing = array ? TOKEN_BRACKET_CLOSE : TOKEN_PAREN_CLOSE;
    if ((!array && !function) || parser->no_blocks) return false;
    Look look;
    look_from(parser, &look);
    Token token = parser->token;
    for (int depth = 0; (depth > 0 || token.kind == opening) && token.kind != TOKEN_END;
         token = lexer_next(&look.lexer))
        depth += (token.kind == opening) - (token.kind == closing);
    bool bare = token.begin == parser->token.begin; /* nothing in front of the '{' */
    if (token.kind != TOKEN_BRACE_OPEN || (bare && (function || lexer_next(&look.lexer).kind == TOKEN_NAME)))
        return false;
    Diagnostic *report = report_at(parser, span, "'%s' is POV-Ray's", word);
    uint32_t formals = parser->token.begin;
    while (parser->token.kind == opening) skip_brackets(parser);
    uint32_t begin = parser->token.begin, behind = consumed_end(parser);
    skip_brackets(parser);
    const char *inner = quote(parser, begin, consumed_end(parser));
    char *list = arena_copy_text(parser->arena, inner, strlen(inner));
    for (char *c = list; *c; c++) *c = *c == '{' ? '[' : *c == '}' ? ']' : *c;
    size_t length = strlen(list);
    if (array)
        hint_write(parser, report, length > 3 ? list : "[1, 2, 3]");
    else
        diag_hint(parser->diag, report, "write: def f%s = ..., in place of let", quote(parser, formals, behind));
    return true;
}

/* "7 mod 3", behind the 7 */
bool parse_operator_habit(Parser *parser, Span operand)
{
    if (parser->token.kind != TOKEN_NAME || first_on_line(parser)) return false;
    const char *word = parser->token.as.symbol->text;
    bool mod = strcmp(word, "mod") == 0, div = strcmp(word, "div") == 0;
    if (!mod && !div) return false;
    Look look;
    look_from(parser, &look);
    TokenKind next = lexer_next(&look.lexer).kind;
    if (next == TOKEN_NAME) {
        next = lexer_next(&look.lexer).kind;
        if (next == TOKEN_BRACE_OPEN || next == TOKEN_ASSIGN) return false;
    } else if (next != TOKEN_NUMBER) {
        return false;
    }
    Diagnostic *report = report_at(parser, token_span(parser), "'%s' is no operator", word);
    consume(parser);
    const char *a = quote(parser, operand.begin, operand.end), *b = quote_read(parser, parse_unary);
    hint_write(parser, report, arena_format(parser->arena, mod ? "%s %% %s" : "floor(%s / %s)", a, b));
    return true;
}

/* May a value end with that token? */
static bool ends_value(TokenKind kind)
{
    return kind == TOKEN_NUMBER || kind == TOKEN_NAME || kind == TOKEN_PAREN_CLOSE || kind == TOKEN_BRACKET_CLOSE ||
           kind == TOKEN_SEMICOLON;
}

/* Is what stands in the braces here a row of lets, and then the word 'return', or a value that begins with a name: with one of
 * those that the lets declare, alone, or with any that is computed with? */
static bool returns_value(const Parser *parser)
{
    enum { MOST = 8 };
    const Symbol *names[MOST];
    size_t n = 0;
    int brackets = 0; /* a list may have what looks like that: [for (i in a) i + 1] */
    Look look;
    look_from(parser, &look);
    Token token = lexer_next(&look.lexer);
    if (token.kind != TOKEN_LET) return false;
    for (TokenKind before = TOKEN_BRACE_OPEN, next; token.kind != TOKEN_END && token.kind != TOKEN_BRACE_OPEN;) {
        if (token.kind == TOKEN_BRACE_CLOSE) break;
        const Symbol *symbol = token.kind == TOKEN_NAME ? token.as.symbol : NULL;
        if (symbol && strcmp(symbol->text, "return") == 0) return true;
        if (symbol && before == TOKEN_LET && n < MOST) names[n++] = symbol;
        Token following = lexer_next(&look.lexer);
        next = following.kind;
        bool unit = symbol && before == TOKEN_NUMBER && unit_of(symbol->text, symbol->length);
        brackets += token.kind == TOKEN_PAREN_OPEN || token.kind == TOKEN_BRACKET_OPEN;
        brackets -= token.kind == TOKEN_PAREN_CLOSE || token.kind == TOKEN_BRACKET_CLOSE;
        if (symbol && brackets == 0 && ends_value(before) && !unit) {
            bool declared = false;
            for (size_t i = 0; i < n; i++) declared |= names[i] == symbol;
            return next == TOKEN_BRACE_CLOSE ? declared : next >= TOKEN_PLUS && next <= TOKEN_CARET;
        }
        before = token.kind;
        token = following;
    }
    return false;
}

/* "{ let h = p.x  return h + 1 }" at its brace, as the body of a def */
Expr *parse_names_and_value(Parser *parser, const char *head)
{
    Span brace = token_span(parser);
    Diagnostic *report = report_at(parser, brace, "a value stands behind '=', statements stand in braces");
    Expr *body = expr_new(parser, EXPR_LET, brace);
    Args *bindings = &body->as.let.bindings;
    uint32_t capacity = 0;
    const char *names = "";
    consume(parser);
    while (!parser->panic && consume_if(parser, TOKEN_LET)) {
        Arg arg = {0};
        if (!expect_name(parser, "to declare", &arg.name, &arg.name_span)) break;
        if (!expect(parser, TOKEN_ASSIGN, "and a value behind the name")) break;
        uint32_t begin = parser->token.begin;
        arg.value = parse_expr(parser);
        ARENA_ROOM(parser->arena, bindings->items, capacity, bindings->n, 4);
        bindings->items[bindings->n++] = arg;
        names = arena_format(parser->arena, "%s%s%s = %s", names, *names ? ", " : "", arg.name->text,
                             quote(parser, begin, consumed_end(parser)));
        consume_if(parser, TOKEN_SEMICOLON);
    }
    if (!parser->panic && consume_if(parser, TOKEN_BRACE_CLOSE)) {
        diag_hint(parser->diag, report, "write: def %s { ... } for a macro, which places nodes and has no value", head);
        body->as.let.body = expr_new(parser, EXPR_POISON, brace);
        return body;
    }
    bool word = parser->token.kind == TOKEN_NAME && strcmp(parser->token.as.symbol->text, "return") == 0;
    if (word && !parser->panic) consume(parser);
    uint32_t begin = parser->token.begin;
    body->as.let.body = parse_expr(parser);
    const char *value = quote(parser, begin, consumed_end(parser));
    if (bindings->n > 0) value = arena_format(parser->arena, "let (%s) %s", names, value);
    if (!parser->panic) diag_hint(parser->diag, report, "write: def %s = %s", head, value);
    consume_if(parser, TOKEN_SEMICOLON);
    if (!parser->panic) expect_close(parser, TOKEN_BRACE_CLOSE, brace, "'}'");
    body->span = span_from(parser, brace);
    return body;
}

/* "let h = p.x in h + 1", at the h */
Expr *parse_bare_let(Parser *parser, Span begin)
{
    if (parser->token.kind != TOKEN_NAME || peek(parser).kind != TOKEN_ASSIGN) return NULL;
    Diagnostic *report = report_at(parser, token_span(parser), "expected '(' behind 'let' in an expression, found %s",
                                   found_text(parser));
    Expr *expr = expr_new(parser, EXPR_LET, begin);
    expr->as.let.bindings = (Args){ARENA_NEW(parser->arena, Arg), 1};
    Arg *arg = expr->as.let.bindings.items;
    if (!expect_name(parser, "to declare", &arg->name, &arg->name_span)) return expr;
    consume(parser);
    uint32_t value = parser->token.begin;
    arg->value = parse_expr(parser);
    const char *binding =
        arena_format(parser->arena, "let (%s = %s)", arg->name->text, quote(parser, value, consumed_end(parser)));
    if (parser->panic || !consume_if(parser, TOKEN_IN)) {
        if (!parser->panic) hint_write(parser, report, arena_format(parser->arena, "%s ...", binding));
        expr->as.let.body = arg->value;
        return expr;
    }
    uint32_t body = parser->token.begin;
    expr->as.let.body = parse_expr(parser);
    expr->span = span_from(parser, begin);
    hint_write(parser, report,
               arena_format(parser->arena, "%s %s", binding, quote(parser, body, consumed_end(parser))));
    return expr;
}

static const char *choice_text(Parser *parser);

/* A value of a choice: another choice, what stands in braces, or a value. */
static const char *chosen_text(Parser *parser)
{
    if (parser->token.kind == TOKEN_IF) return choice_text(parser);
    if (parser->token.kind != TOKEN_BRACE_OPEN) return quote_read(parser, parse_tern);
    uint32_t begin = peek(parser).begin;
    skip_brackets(parser);
    uint32_t end = consumed_end(parser);
    while (end > begin && strchr("} \t\n", parser->lexer.text[end - 1])) end--;
    return quote(parser, begin, end);
}

/* "if (a) b else c" and "if a then b else c", from the 'if' on, as it is written here; what is not there is "...". */
static const char *choice_text(Parser *parser)
{
    if (!enter(parser)) return "...";
    consume(parser);
    bool bracketed = parser->token.kind == TOKEN_PAREN_OPEN;
    uint32_t begin = bracketed ? peek(parser).begin : parser->token.begin;
    (bracketed ? parse_prim : parse_tern)(parser);
    const char *condition = quote(parser, begin, consumed_end(parser) - bracketed), *yes = "...", *no = "...";
    if (parser->token.kind == TOKEN_NAME && strcmp(parser->token.as.symbol->text, "then") == 0) consume(parser);
    if (!parser->panic) yes = chosen_text(parser);
    if (!parser->panic && consume_if(parser, TOKEN_ELSE)) no = chosen_text(parser);
    leave(parser);
    return arena_format(parser->arena, "%s ? %s : %s", condition, yes, no);
}

/* Does "if ... else" without a block stand there, behind a value and on its line? */
static bool is_choice_behind(const Parser *parser)
{
    if (parser->panic || parser->token.kind != TOKEN_IF || first_on_line(parser)) return false;
    Look look;
    look_from(parser, &look);
    for (Token token = lexer_next(&look.lexer); token.kind != TOKEN_END; token = lexer_next(&look.lexer)) {
        if (token.kind == TOKEN_ELSE) return true;
        if (token.kind == TOKEN_BRACE_OPEN || token.kind == TOKEN_BRACE_CLOSE || begins_line(parser, token.begin))
            break;
    }
    return false;
}

/* 1 if a else 2 */
static void parse_choice_behind(Parser *parser, const Expr *yes)
{
    Diagnostic *report =
        report_at(parser, token_span(parser), "'if' chooses no value, a value is chosen by '?' and ':'");
    consume(parser);
    const char *condition = quote_read(parser, parse_tern), *no = "...";
    if (!parser->panic && consume_if(parser, TOKEN_ELSE)) no = quote_read(parser, parse_expr);
    hint_write(
        parser, report,
        arena_format(parser->arena, "%s ? %s : %s", condition, quote(parser, yes->span.begin, yes->span.end), no));
}

/* The comment on the line of a value that has just been read: "7 // 2" is a division of whole numbers in Python. */
static void warn_of_comment(const Parser *parser, const Expr *value)
{
    bool number =
        parser->previous == TOKEN_NUMBER || parser->previous == TOKEN_NAME || parser->previous == TOKEN_PAREN_CLOSE;
    if (parser->panic || !number) return;
    uint32_t end = consumed_end(parser), at = end;
    const char *text = parser->lexer.text;
    uint32_t before = (uint32_t)strspn(text + at, " ");
    at += before;
    if (before > 1 || strncmp(text + at, "//", 2) != 0 || strspn(text + at + 2, " ") != before) return;
    uint32_t begin = at, digits = at + 2 + before;
    at = digits + (uint32_t)strspn(text + digits, "0123456789");
    if (at == digits || !strchr("\r\n", text[at])) return; /* or the 0 */
    Span span = {parser->lexer.source, begin, at};
    Diagnostic *report =
        diag_report(parser->diag, D_COMMENT_DIVIDES, span, "'//' begins a comment, and divides nothing");
    bool plain = value->kind == EXPR_CONSTANT || value->kind == EXPR_NAME || value->kind == EXPR_CALL;
    diag_hint(parser->diag, report, "a division of whole numbers is: floor(%s / %.*s)",
              plain ? quote(parser, value->span.begin, end) : "...", (int)(at - digits), text + digits);
}

Expr *parse_whole_value(Parser *parser)
{
    Expr *value = parse_expr(parser);
    if (is_choice_behind(parser))
        parse_choice_behind(parser, value);
    else
        warn_of_comment(parser, value);
    return value;
}

/* Where the '>' of an arrow ends that follows names, in parentheses or one alone; 0: it is none. */
static uint32_t arrow_ahead(const Parser *parser, uint32_t *names_end)
{
    Look look;
    look_from(parser, &look);
    Token token = parser->token;
    bool brackets = token.kind == TOKEN_PAREN_OPEN;
    if (!brackets && token.kind != TOKEN_NAME) return 0;
    while (brackets && token.kind != TOKEN_PAREN_CLOSE) {
        token = lexer_next(&look.lexer);
        if (token.kind != TOKEN_NAME && token.kind != TOKEN_COMMA && token.kind != TOKEN_PAREN_CLOSE) return 0;
    }
    *names_end = token.end;
    Token minus = lexer_next(&look.lexer), greater = lexer_next(&look.lexer);
    bool arrow = minus.kind == TOKEN_MINUS && greater.kind == TOKEN_GREATER && greater.begin == minus.end;
    return arrow ? greater.end : 0;
}

/* The value behind what begins a function without a name of its own: in braces that begin a line, or as it is; its text. */
static Expr *parse_function_value(Parser *parser, const char **text)
{
    uint32_t begin = parser->token.begin;
    bool braces = parser->token.kind == TOKEN_BRACE_OPEN;
    if (braces) skip_brackets(parser);
    Expr *value = braces ? expr_new(parser, EXPR_POISON, token_span(parser)) : parse_expr(parser);
    *text = braces ? "..." : quote(parser, begin, consumed_end(parser));
    return value;
}

/* "def(x) = x * 2", "def(x) x * 2" and "def(x) { ... }", at the 'def': up to the value, names are the parameters in their brackets */
static Diagnostic *parse_nameless_def(Parser *parser, const char **names)
{
    Diagnostic *report = report_at(parser, token_span(parser), "a function has a name, and a statement of its own");
    consume(parser);
    uint32_t begin = parser->token.begin;
    skip_brackets(parser);
    *names = quote(parser, begin, consumed_end(parser));
    consume_if(parser, TOKEN_ASSIGN);
    return report;
}

Expr *parse_arrow_function(Parser *parser, const char *name, bool declared)
{
    uint32_t names_end, begin = parser->token.begin, end = arrow_ahead(parser, &names_end);
    bool nameless = parser->token.kind == TOKEN_DEF && peek(parser).kind == TOKEN_PAREN_OPEN;
    if (!end && !nameless) return NULL;
    const char *names = end ? quote(parser, begin, names_end) : NULL, *body;
    Diagnostic *report = nameless ? parse_nameless_def(parser, &names)
                                  : report_at(parser, (Span){parser->lexer.source, end - 2, end},
                                              "'->' has no meaning here: a function is a def");
    while (parser->token.begin < end) consume(parser);
    Expr *value = parse_function_value(parser, &body);
    const char *open = *names == '(' ? "" : "(", *close = *open ? ")" : "";
    if (!parser->panic)
        diag_hint(parser->diag, report, "write: def %s%s%s%s = %s%s", declared ? name : "f", open, names, close, body,
                  declared ? "" : arena_format(parser->arena, ", further up, and %s = f", name));
    value->kind = EXPR_POISON;
    return value;
}

void parse_if_value(Parser *parser)
{
    Diagnostic *report = report_at(parser, token_span(parser), "'if' places nodes, a value is chosen by '?' and ':'");
    const char *text = choice_text(parser);
    if (!parser->panic) hint_write(parser, report, text);
}

void parse_else_of_element(Parser *parser, const Expr *element)
{
    const Expr *condition = element->as.each.source, *yes = element->as.each.body;
    Diagnostic *report =
        report_at(parser, token_span(parser), "'if' leaves elements of a list out, it has no 'else' there");
    consume(parser);
    const char *no = chosen_text(parser);
    if (parser->panic) return;
    hint_write(parser, report,
               arena_format(parser->arena, "%s ? %s : %s", quote(parser, condition->span.begin, condition->span.end),
                            quote(parser, yes->span.begin, yes->span.end), no));
}

/* "def f(x) { x * 2 }": what stands in the braces is neither a statement nor a block */
Expr *parse_braced_body(Parser *parser, const Def *def)
{
    const char *head = quote(parser, def->span.begin, consumed_end(parser));
    if (returns_value(parser)) return parse_names_and_value(parser, head);
    Look look;
    look_from(parser, &look);
    Token token = lexer_next(&look.lexer);
    bool computed = token.kind == TOKEN_NUMBER || token.kind == TOKEN_MINUS;
    if (!computed && (token.kind != TOKEN_NAME || habit_setting(NULL, token.as.symbol->text))) return NULL;
    int brackets = 0;
    for (TokenKind before = TOKEN_BRACE_OPEN; token.kind != TOKEN_BRACE_CLOSE; token = lexer_next(&look.lexer)) {
        TokenKind kind = token.kind;
        bool two = kind == TOKEN_NAME && (before == TOKEN_NAME || before == TOKEN_PAREN_CLOSE);
        if (kind == TOKEN_BRACE_OPEN || kind == TOKEN_ASSIGN || kind == TOKEN_CHANGE || kind == TOKEN_END || two)
            return NULL;
        computed |= brackets == 0 && kind >= TOKEN_PLUS && kind <= TOKEN_CARET;
        brackets += (kind == TOKEN_PAREN_OPEN) - (kind == TOKEN_PAREN_CLOSE);
        before = kind;
    }
    return computed ? parse_names_and_value(parser, head) : NULL;
}

/* ---- units ---- */

/* The unit that the name at the present token is, "3 mm", where it is not what begins something else; NULL. */
static const char *apart_unit(Parser *parser)
{
    const Symbol *word = parser->token.as.symbol;
    const char *unit = unit_of(word->text, word->length) ? word->text : habit_unit(word->text);
    if (!unit || first_on_line(parser)) return NULL;
    Look look;
    look_from(parser, &look);
    Token next = lexer_next(&look.lexer);
    switch (next.kind) {
    case TOKEN_NAME:
        return !begins_line(parser, next.begin) && lexer_next(&look.lexer).kind == TOKEN_BRACE_OPEN ? NULL : unit;
    case TOKEN_ASSIGN:
    case TOKEN_CHANGE:
    case TOKEN_DOT:
    case TOKEN_PAREN_OPEN:
    case TOKEN_BRACE_OPEN: return NULL;
    default: return unit;
    }
}

/* Whether that name is meant for a unit that there is not, "3 kg": a short word right behind the number, and no value behind it that it
 * could be the name of. */
static bool is_no_unit(Parser *parser, Span number)
{
    enum { SHORTEST = 2, LONGEST = 3 };
    const Symbol *word = parser->token.as.symbol;
    if (word->length < SHORTEST || word->length > LONGEST || parser->token.begin > number.end + 1 ||
        first_on_line(parser) || builtin_find(word->text) || (parser->node && habit_advice(parser->node, word->text)))
        return false;
    Look look;
    look_from(parser, &look);
    Token next = lexer_next(&look.lexer);
    switch (next.kind) {
    case TOKEN_NAME: return begins_line(parser, next.begin) || lexer_next(&look.lexer).kind == TOKEN_ASSIGN;
    case TOKEN_COMMA:
    case TOKEN_PAREN_CLOSE:
    case TOKEN_BRACE_CLOSE:
    case TOKEN_GREATER:
    case TOKEN_END: return true;
    default: return false;
    }
}

void parse_apart_unit(Parser *parser, Span number)
{
    const char *unit = apart_unit(parser);
    if (!unit) {
        if (!is_no_unit(parser, number)) return;
        lexer_report_unit(&parser->lexer, parser->token.begin, parser->token.end);
        consume(parser);
        return;
    }
    Diagnostic *report = report_at(parser, token_span(parser), "a unit stands directly behind its number");
    uint32_t begin = number.begin; /* 1/2 cm is no 1/2cm */
    const char *text = parser->lexer.text;
    while (begin > 0 && strchr("0123456789./ ", text[begin - 1])) begin--;
    while (text[begin] == ' ') begin++;
    const bool fraction = memchr(text + begin, '/', number.begin - begin) != NULL;
    diag_hint(parser->diag, report, fraction ? "write: %s * 1%s" : "write: %s%s",
              quote(parser, fraction ? begin : number.begin, number.end), unit);
    consume(parser);
}

void parse_vector_unit(Parser *parser)
{
    const char *unit = apart_unit(parser);
    if (!unit) return;
    Diagnostic *report = report_at(parser, token_span(parser), "a unit stands directly behind a number");
    diag_hint(parser->diag, report, "write: <1%s, 2%s, 3%s>, or <1, 2, 3> * 1%s", unit, unit, unit, unit);
    consume(parser);
}

/* A percent sign behind a number, and nothing behind it that the number could be divided by. */
bool parse_percent_habit(Parser *parser, const Expr *number)
{
    if (parser->token.kind != TOKEN_PERCENT || number->kind != EXPR_CONSTANT || !number->literal ||
        number->as.constant.value.kind != VALUE_NUMBER)
        return false;
    Look look;
    look_from(parser, &look);
    switch (lexer_next(&look.lexer).kind) {
    case TOKEN_NAME: {
        TokenKind next = lexer_next(&look.lexer).kind;
        if (next != TOKEN_ASSIGN && next != TOKEN_NAME) return false;
        break;
    }
    case TOKEN_LET:
        if (lexer_next(&look.lexer).kind == TOKEN_PAREN_OPEN) return false;
        break;
    case TOKEN_VAR:
    case TOKEN_PARAM:
    case TOKEN_DEF:
    case TOKEN_FOR:
    case TOKEN_IF:
    case TOKEN_WHILE:
    case TOKEN_BRACE_CLOSE:
    case TOKEN_BRACKET_CLOSE:
    case TOKEN_PAREN_CLOSE:
    case TOKEN_COMMA:
    case TOKEN_SEMICOLON:
    case TOKEN_END: break;
    default: return false;
    }
    Diagnostic *report = report_at(parser, token_span(parser), "'%%' is the remainder of a division, not a hundredth");
    char text[NUM_TEXT_SIZE];
    size_t length = num_print(number->as.constant.value.as.number / 100, text);
    diag_hint(parser->diag, report, "write: %.*s", (int)length, text);
    consume(parser);
    return true;
}

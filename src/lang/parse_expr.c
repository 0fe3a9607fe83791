/* parse_expr.c - expressions: one function per nonterminal, its line of the grammar above it.
 * Literal vectors and lists of numbers become constants here; long lists of plain numbers do not even become tokens.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "lang/parse_habits.h"
#include "lang/parser.h"

Expr *expr_new(Parser *parser, ExprKind kind, Span span)
{
    Expr *expr = ARENA_NEW(parser->arena, Expr);
    expr->kind = kind;
    expr->span = span;
    return expr;
}

static Expr *poison_expr(Parser *parser)
{
    return expr_new(parser, EXPR_POISON, token_span(parser));
}

static Expr *constant_expr(Parser *parser, Span span, Value value, const UnitType *unit)
{
    Expr *expr = expr_new(parser, EXPR_CONSTANT, span);
    expr->literal = true;
    expr->as.constant.value = value;
    expr->as.constant.unit = unit;
    return expr;
}

/* begin: where the number, which is not of scene units yet, stands in the text. */
static double in_scene_units(const Parser *parser, double number, const UnitType *unit, uint32_t begin)
{
    const Lexer *lexer = &parser->lexer;
    double own = unit && unit->measure == UNIT_LENGTH ? parser->unit_m : 1;
    return !unit || unit->size == own ? number : unit_value(lexer->text + begin, lexer->length - begin, unit, own);
}

static Expr *binary_expr(Parser *parser, ExprKind kind, Expr *a, Expr *b)
{
    Expr *expr = expr_new(parser, kind, span_from(parser, a->span));
    expr->as.op.a = a;
    expr->as.op.b = b;
    return expr;
}

/* ---- lists of plain numbers ---- */

typedef struct PlainList {
    double *numbers;
    size_t n, capacity; /* doubles */
    unsigned width;     /* per element, 0 before the first */
    const UnitType *unit;
    uint32_t rest; /* where the first element that is not plain begins */
    bool complete;
} PlainList;

static bool plain_number(Parser *parser, PlainList *list)
{
    double number;
    const UnitType *unit;
    uint32_t begin = parser->lexer.at;
    if (!lexer_plain_number(&parser->lexer, &number, &unit)) return false;
    if (unit && list->unit && unit->measure != list->unit->measure) return false;
    if (unit) list->unit = unit;
    if (list->n == list->capacity && !ARRAY_ROOM(list->numbers, list->capacity, list->n)) return false;
    list->numbers[list->n++] = in_scene_units(parser, number, unit, begin);
    return true;
}

/* number, or "<" number "," number [ "," number [ "," number ] ] ">" */
static bool plain_element(Parser *parser, PlainList *list)
{
    Lexer *lexer = &parser->lexer;
    unsigned width = 1;
    if (lexer->text[lexer->at] != '<') {
        if (!plain_number(parser, list)) return false;
    } else {
        lexer->at++;
        for (width = 0; width < 4;) {
            lexer_skip_blanks(lexer);
            if (!plain_number(parser, list)) return false;
            width++;
            lexer_skip_blanks(lexer);
            char c = lexer->text[lexer->at++];
            if (c == '>') break;
            if (c != ',' || width == 4) return false;
        }
        if (width < 2) return false;
    }
    if (!list->width) list->width = width;
    return list->width == width;
}

/* Reads as many plain elements as there are behind a '['. */
static PlainList plain_list(Parser *parser)
{
    Lexer *lexer = &parser->lexer;
    PlainList list = {.rest = lexer->at};
    for (;;) {
        size_t n = list.n;
        lexer_skip_blanks(lexer);
        if (list.n > 0 && lexer->text[lexer->at] == ']') { /* behind a last comma */
            list.complete = true;
            break;
        }
        list.rest = lexer->at;
        if (!plain_element(parser, &list)) {
            list.n = n;
            break;
        }
        lexer_skip_blanks(lexer);
        char c = lexer->text[lexer->at];
        if (c != ',' && c != ']') {
            list.n = n;
            break;
        }
        if (c == ']') {
            list.complete = true;
            break;
        }
        list.rest = ++lexer->at;
    }
    if (!list.complete) lexer->at = list.rest;
    return list;
}

static Expr *plain_list_expr(Parser *parser, Span opening, const PlainList *plain)
{
    List *list = ARENA_NEW(parser->arena, List);
    double *numbers = ARENA_ARRAY(parser->arena, double, plain->n);
    memcpy(numbers, plain->numbers, plain->n * sizeof *numbers);
    list->n = plain->n / plain->width;
    list->width = plain->width;
    list->element = plain->width == 1 ? VALUE_NUMBER : value_vector_kind(plain->width);
    list->numbers = numbers;
    list->depth = 1;
    opening.end = parser->lexer.at + 1;
    return constant_expr(parser, opening, (Value){.kind = VALUE_LIST, .as.list = list}, plain->unit);
}

typedef struct ExprList {
    Expr **items;
    uint32_t n, capacity;
} ExprList;

static void expr_list_add(Parser *parser, ExprList *list, Expr *expr)
{
    ARENA_ROOM(parser->arena, list->items, list->capacity, list->n, 4);
    list->items[list->n++] = expr;
}

static void add_plain_elements(Parser *parser, ExprList *list, Span span, const PlainList *plain)
{
    for (size_t i = 0; i < plain->n; i += plain->width) {
        Value value = {.kind = plain->width == 1 ? VALUE_NUMBER : value_vector_kind(plain->width)};
        for (unsigned k = 0; k < plain->width; k++) value.as.v[k] = plain->numbers[i + k];
        expr_list_add(parser, list, constant_expr(parser, span, value, plain->unit));
    }
}

/* The comma between elements. Where it is missing in front of another value, that is all that is reported. */
static bool accept_comma(Parser *parser, const char *expected, bool over_lines)
{
    if (consume_if(parser, TOKEN_COMMA)) return true;
    if (parser->panic) return false;
    TokenKind kind = parser->token.kind;
    bool value = kind == TOKEN_NUMBER || kind == TOKEN_STRING || kind == TOKEN_COLOR;
    bool fresh = first_on_line(parser);
    if (kind == TOKEN_NAME && !fresh) {
        TokenKind next = peek(parser).kind;
        value =
            next == TOKEN_COMMA || next == TOKEN_PAREN_CLOSE || next == TOKEN_BRACKET_CLOSE || next == TOKEN_GREATER;
    }
    if (!value || (fresh && !over_lines)) return false;
    Diagnostic *report = expected_error(parser, expected);
    if (report) diag_hint(parser->diag, report, "is a ',' missing?");
    parser->panic = false;
    return true;
}

/* elem = "for" "(" name "in" expr ")" elem | "if" "(" expr ")" elem | expr ; */
static Expr *parse_elem(Parser *parser)
{
    Span begin = token_span(parser);
    bool each = parser->token.kind == TOKEN_FOR;
    if (!each && parser->token.kind != TOKEN_IF) return parse_expr(parser);
    if (!enter(parser)) return poison_expr(parser);
    consume(parser);
    Expr *expr = expr_new(parser, each ? EXPR_EACH : EXPR_WHEN, begin);
    Span opening = token_span(parser);
    expect(parser, TOKEN_PAREN_OPEN, each ? "behind 'for'" : "behind 'if'");
    parser->brackets++;
    if (each) {
        expect_name(parser, "of the loop", &expr->as.each.name, &expr->as.each.name_span);
        expect(parser, TOKEN_IN, "behind the name of the loop");
    }
    uint32_t source = parser->token.begin;
    expr->as.each.source = parse_expr(parser);
    if (each && !parser->panic) parse_range_habit(parser, source, false, true);
    expect_close(parser, TOKEN_PAREN_CLOSE, opening, "')'");
    parser->brackets--;
    expr->as.each.body = parse_elem(parser);
    expr->span = span_from(parser, begin);
    if (!each && !parser->panic && parser->token.kind == TOKEN_ELSE) parse_else_of_element(parser, expr);
    leave(parser);
    return expr;
}

/* "[" [ elem { "," elem } [ "," ] ] "]" */
static Expr *parse_list(Parser *parser)
{
    Span opening = token_span(parser);
    PlainList plain = plain_list(parser);
    if (plain.complete) {
        Expr *expr = plain_list_expr(parser, opening, &plain);
        free(plain.numbers);
        consume(parser); /* the ']' becomes the next token */
        consume(parser);
        return expr;
    }
    ExprList list = {0};
    add_plain_elements(parser, &list, opening, &plain);
    free(plain.numbers);
    consume(parser);
    parser->brackets++;
    while (!parser->panic && parser->token.kind != TOKEN_BRACKET_CLOSE) {
        expr_list_add(parser, &list, parse_elem(parser));
        if (!accept_comma(parser, "',' or ']'", true)) break;
    }
    expect_close(parser, TOKEN_BRACKET_CLOSE, opening, "',' or ']'");
    parser->brackets--;
    Expr *expr = expr_new(parser, EXPR_LIST, span_from(parser, opening));
    expr->as.list.items = list.items;
    expr->as.list.n = list.n;
    return expr;
}

/* ---- operands ---- */

static Expr *fold_vector(Parser *parser, Span span, const ExprList *list)
{
    Value value = {.kind = value_vector_kind(list->n)};
    const UnitType *unit = NULL;
    for (uint32_t i = 0; i < list->n; i++) {
        const Expr *item = list->items[i];
        if (item->kind != EXPR_CONSTANT || !item->literal || item->as.constant.value.kind != VALUE_NUMBER) return NULL;
        value.as.v[i] = item->as.constant.value.as.number;
        const UnitType *own = item->as.constant.unit;
        if (own && unit && own->measure != unit->measure) return NULL;
        if (own) unit = own;
    }
    return constant_expr(parser, span, value, unit);
}

/* A vector of plain numbers, behind its '<', without a token for each of them; NULL, and back behind the '<', when it
 * holds anything else. */
static Expr *plain_vector(Parser *parser, Span span)
{
    Lexer *lexer = &parser->lexer;
    uint32_t begin = lexer->at;
    double numbers[4];
    const UnitType *unit = NULL, *own;
    unsigned width = 0;
    for (char c = ','; c == ',' && width < 4; width++) {
        lexer_skip_blanks(lexer);
        uint32_t number_begin = lexer->at;
        if (!lexer_plain_number(lexer, &numbers[width], &own)) break;
        if (own && unit && own->measure != unit->measure) break;
        if (own) unit = own;
        numbers[width] = in_scene_units(parser, numbers[width], own, number_begin);
        lexer_skip_blanks(lexer);
        c = lexer->text[lexer->at];
        if (c == '>' && width > 0 && lexer->text[lexer->at + 1] != '=') {
            Value value = {.kind = value_vector_kind(width + 1)};
            memcpy(value.as.v, numbers, (width + 1) * sizeof *numbers);
            span.end = lexer->at + 1;
            consume(parser); /* the '>' becomes the next token */
            consume(parser);
            return constant_expr(parser, span, value, unit);
        }
        lexer->at += c == ',';
    }
    lexer->at = begin;
    return NULL;
}

/* "<" add "," add [ "," add [ "," add ] ] ">" */
static Expr *parse_elements(Parser *parser)
{
    Span opening = token_span(parser);
    Expr *plain = plain_vector(parser, opening);
    if (plain) return plain;
    ExprList list = {0};
    consume(parser);
    do {
        expr_list_add(parser, &list, parse_add(parser));
        if (parser->token.kind == TOKEN_GREATER) parse_vector_comparison(parser);
    } while (!parser->panic && accept_comma(parser, "',' or '>'", false) && list.n < 64);
    expect_close(parser, TOKEN_GREATER, opening, "',' or '>'");
    Span span = span_from(parser, opening);
    if (!parser->panic && (list.n < 2 || list.n > 4)) {
        diag_report(parser->diag, D_SYNTAX, span, "a vector has 2 to 4 elements, not %u", list.n);
        return expr_new(parser, EXPR_POISON, span);
    }
    if (parser->panic) return expr_new(parser, EXPR_POISON, span);
    Expr *constant = fold_vector(parser, span, &list);
    if (constant) return constant;
    Expr *expr = expr_new(parser, EXPR_VECTOR, span);
    expr->as.list.items = list.items;
    expr->as.list.n = list.n;
    return expr;
}

static Expr *parse_vector(Parser *parser)
{
    Expr *vector = parse_elements(parser);
    if (parser->token.kind == TOKEN_NAME && !parser->panic) parse_vector_unit(parser);
    return vector;
}

static Expr *parse_number(Parser *parser)
{
    Token token = parser->token;
    Span span = token_span(parser);
    consume(parser);
    if (token.bad) return expr_new(parser, EXPR_POISON, span);
    if (parser->token.kind == TOKEN_NAME && !token.unit) parse_apart_unit(parser, span);
    return constant_expr(parser, span, value_number(in_scene_units(parser, token.number, token.unit, token.begin)),
                         token.unit);
}

static Expr *parse_string(Parser *parser)
{
    Token token = parser->token;
    Span span = token_span(parser);
    consume(parser);
    if (token.bad) return expr_new(parser, EXPR_POISON, span);
    return constant_expr(parser, span, value_text(token.as.text), NULL);
}

/* Kept encoded as sRGB; the resolver converts it once the working space is known. */
static Expr *parse_color(Parser *parser)
{
    Token token = parser->token;
    Span span = token_span(parser);
    consume(parser);
    if (token.bad) return expr_new(parser, EXPR_POISON, span);
    uint32_t rgb = token.as.rgb;
    return constant_expr(
        parser, span, value_color((rgb >> 16 & 0xff) / 255.0, (rgb >> 8 & 0xff) / 255.0, (rgb & 0xff) / 255.0), NULL);
}

static Expr *parse_word(Parser *parser, Value value)
{
    Span span = token_span(parser);
    consume(parser);
    return constant_expr(parser, span, value, NULL);
}

/* "(" expr ")" */
static Expr *parse_parens(Parser *parser)
{
    Span opening = token_span(parser);
    consume(parser);
    parser->brackets++;
    bool no_blocks = parser->no_blocks;
    parser->no_blocks = false;
    Expr *expr = parse_expr(parser);
    if (!parser->panic && parser->token.kind == TOKEN_COMMA) {
        Diagnostic *report = expected_error(parser, "')'");
        diag_hint(parser->diag, report, "a vector stands in '<' and '>', a list in '[' and ']'");
        parser->panic = false;
        while (consume_if(parser, TOKEN_COMMA)) parse_expr(parser);
    }
    expect_close(parser, TOKEN_PAREN_CLOSE, opening, "')'");
    parser->no_blocks = no_blocks;
    parser->brackets--;
    return expr;
}

/* path block | name ; the names behind dots are taken here as far as a block may still follow them */
static Expr *parse_name(Parser *parser)
{
    Span begin = token_span(parser);
    Path path = {.names = {parser->token.as.symbol}, .n = 1, .span = begin};
    Expr *expr = expr_new(parser, EXPR_NAME, begin);
    expr->as.name.symbol = parser->token.as.symbol;
    consume(parser);
    const char *word = path.names[0]->text;
    if (parse_color_habit(parser, word) || parse_array_habit(parser, word, begin)) return poison_expr(parser);
    while (parser->token.kind == TOKEN_DOT && path.n < LIMIT_PATH_NAMES) {
        consume(parser);
        Expr *member = expr_new(parser, EXPR_MEMBER, begin);
        member->as.member.base = expr;
        if (!expect_name(parser, "behind '.'", &member->as.member.name, &member->as.member.name_span))
            return poison_expr(parser);
        path.names[path.n++] = member->as.member.name;
        path.span = member->span = span_from(parser, begin);
        expr = member;
    }
    if (parser->token.kind != TOKEN_BRACE_OPEN || parser->no_blocks) return expr;
    if (parse_block_habit(parser, path)) return poison_expr(parser);
    Expr *node = expr_new(parser, EXPR_NODE, path.span);
    node->as.node = ARENA_NEW(parser->arena, NodeExpr);
    node->as.node->path = path;
    node->as.node->block = parse_node_block(parser, path.names[path.n - 1]->text);
    return node;
}

/* "surface = { albedo = .5 }": the present token is the '{'. */
static bool begins_properties(const Parser *parser)
{
    Look look;
    look_from(parser, &look);
    return lexer_next(&look.lexer).kind == TOKEN_NAME && lexer_next(&look.lexer).kind == TOKEN_ASSIGN;
}

/* "{1, 2, 3}" and a node without its type are read over; a '{' that no value stands behind may begin a block. */
static Expr *parse_braced_list(Parser *parser)
{
    TokenKind first = peek(parser).kind;
    bool properties = begins_properties(parser);
    bool list = first == TOKEN_NUMBER || first == TOKEN_STRING || first == TOKEN_LESS || first == TOKEN_MINUS;
    Diagnostic *report = expected_error(parser, "an expression");
    if (report && (list || properties) && !parser->no_blocks) {
        diag_hint(parser->diag, report,
                  list ? "a vector stands in '<' and '>', a list in '[' and ']'"
                       : "a node begins with its type: surface = surface { ... }, interior = medium { ... }");
        parser->panic = false;
        skip_brackets(parser);
    }
    return poison_expr(parser);
}

/* prim = number | string | hexcol | "true" | "false" | "none" | "(" expr ")" | path block | name | "<" add "," add [
 * "," add [ "," add ] ] ">" | "[" [ elem { "," elem } [ "," ] ] "]" ; */
Expr *parse_prim(Parser *parser)
{
    switch (parser->token.kind) {
    case TOKEN_NUMBER: return parse_number(parser);
    case TOKEN_STRING: return parse_string(parser);
    case TOKEN_COLOR: return parse_color(parser);
    case TOKEN_TRUE: return parse_word(parser, value_truth(true));
    case TOKEN_FALSE: return parse_word(parser, value_truth(false));
    case TOKEN_NONE: return parse_word(parser, value_none());
    case TOKEN_PAREN_OPEN: return parse_parens(parser);
    case TOKEN_NAME: return parse_name(parser);
    case TOKEN_LESS: return parse_vector(parser);
    case TOKEN_BRACKET_OPEN: return parse_list(parser);
    case TOKEN_BRACE_OPEN: return parse_braced_list(parser);
    case TOKEN_IF: parse_if_value(parser); return poison_expr(parser);
    default: expected_error(parser, "an expression"); return poison_expr(parser);
    }
}

/* arg = [ name "=" ] expr ; */
static Arg parse_arg(Parser *parser)
{
    Arg arg = {0};
    if (parser->token.kind == TOKEN_NAME && peek(parser).kind == TOKEN_ASSIGN) {
        arg.name = parser->token.as.symbol;
        arg.name_span = token_span(parser);
        consume(parser);
        consume(parser);
    }
    arg.value = parse_expr(parser);
    return arg;
}

/* args = [ arg { "," arg } [ "," ] ] ; */
Args parse_args(Parser *parser, Span opening)
{
    Args args = {0};
    uint32_t capacity = 0;
    parser->brackets++;
    while (!parser->panic && parser->token.kind != TOKEN_PAREN_CLOSE) {
        Arg arg = parse_arg(parser);
        ARENA_ROOM(parser->arena, args.items, capacity, args.n, 4);
        args.items[args.n++] = arg;
        if (!accept_comma(parser, "',' or ')'", false)) break;
    }
    expect_close(parser, TOKEN_PAREN_CLOSE, opening, "',' or ')'");
    parser->brackets--;
    return args;
}

static Expr *parse_member(Parser *parser, Expr *base)
{
    Expr *expr = expr_new(parser, EXPR_MEMBER, base->span);
    consume(parser);
    expr->as.member.base = base;
    if (!expect_name(parser, "behind '.'", &expr->as.member.name, &expr->as.member.name_span))
        return poison_expr(parser);
    expr->span = span_from(parser, base->span);
    return expr;
}

static Expr *parse_index(Parser *parser, Expr *base)
{
    Span opening = token_span(parser);
    Expr *expr = expr_new(parser, EXPR_INDEX, base->span);
    consume(parser);
    parser->brackets++;
    expr->as.op.a = base;
    expr->as.op.b = parse_expr(parser);
    expect_close(parser, TOKEN_BRACKET_CLOSE, opening, "']'");
    parser->brackets--;
    expr->span = span_from(parser, base->span);
    return expr;
}

static Expr *parse_call(Parser *parser, Expr *callee)
{
    Span opening = token_span(parser);
    Expr *expr = expr_new(parser, EXPR_CALL, callee->span);
    consume(parser);
    expr->as.call.callee = callee;
    expr->as.call.args = parse_args(parser, opening);
    expr->span = span_from(parser, callee->span);
    return expr;
}

/* post = prim { "." name | "[" expr "]" | "(" args ")" } ; */
static Expr *parse_post(Parser *parser)
{
    Expr *expr = parse_prim(parser);
    for (int links = 0; !parser->panic; links++) {
        TokenKind kind = parser->token.kind;
        if (kind != TOKEN_DOT && kind != TOKEN_BRACKET_OPEN && kind != TOKEN_PAREN_OPEN) break;
        if (links == LIMIT_LINKS) { /* the chain is walked by recursion later */
            limit_error(parser, OVER_LINKS);
            break;
        }
        expr = kind == TOKEN_DOT            ? parse_member(parser, expr)
               : kind == TOKEN_BRACKET_OPEN ? parse_index(parser, expr)
                                            : parse_call(parser, expr);
    }
    return expr;
}

/* ---- operators, from the tightest to the loosest ---- */

/* unary = ( "-" | "+" ) unary | post [ "^" unary ] ; */
Expr *parse_unary(Parser *parser)
{
    Span begin = token_span(parser);
    if (parser->panic || !enter(parser)) return poison_expr(parser); /* in panic nothing more is consumed */
    Expr *expr;
    TokenKind kind = parser->token.kind;
    if (kind == TOKEN_MINUS || kind == TOKEN_PLUS) {
        consume(parser);
        Expr *operand = parse_unary(parser);
        if (operand->kind == EXPR_CONSTANT && operand->literal && operand->as.constant.value.kind == VALUE_NUMBER) {
            if (kind == TOKEN_MINUS) operand->as.constant.value.as.number *= -1;
            expr = operand;
        } else {
            expr = expr_new(parser, kind == TOKEN_MINUS ? EXPR_NEGATE : EXPR_PLUS, begin);
            expr->as.op.a = operand;
        }
        expr->span = span_from(parser, begin);
    } else {
        expr = parse_post(parser);
        if (consume_if(parser, TOKEN_CARET)) expr = binary_expr(parser, EXPR_POWER, expr, parse_unary(parser));
    }
    leave(parser);
    return expr;
}

/* A chain of operators is a tree that leans left; deeper than the limit the walks over it would use too much stack. */
static bool chain_too_long(Parser *parser, int links)
{
    if (links < LIMIT_OPERATORS) return false;
    limit_error(parser, OVER_OPERATORS);
    return true;
}

/* mul = unary { ( "*" | "/" | "%" ) unary } ; */
static Expr *parse_mul(Parser *parser)
{
    Expr *expr = parse_unary(parser);
    for (int links = 0; !parser->panic; links++) {
        if (parse_percent_habit(parser, expr) || parse_operator_habit(parser, expr->span)) continue;
        TokenKind kind = parser->token.kind;
        if (kind != TOKEN_STAR && kind != TOKEN_SLASH && kind != TOKEN_PERCENT) break;
        if (chain_too_long(parser, links)) break;
        consume(parser);
        if (kind == TOKEN_STAR && parser->token.kind == TOKEN_STAR) {
            Diagnostic *report = expected_error(parser, "an expression");
            diag_hint(parser->diag, report, "a power is written a ^ b");
            parser->panic = false;
            consume(parser);
        }
        expr = binary_expr(parser,
                           kind == TOKEN_STAR    ? EXPR_MULTIPLY
                           : kind == TOKEN_SLASH ? EXPR_DIVIDE
                                                 : EXPR_MODULO,
                           expr, parse_unary(parser));
        expr->span = span_from(parser, expr->as.op.a->span);
    }
    return expr;
}

/* add = mul { ( "+" | "-" ) mul } ; */
Expr *parse_add(Parser *parser)
{
    Expr *expr = parse_mul(parser);
    for (int links = 0; !parser->panic; links++) {
        TokenKind kind = parser->token.kind;
        if (kind != TOKEN_PLUS && kind != TOKEN_MINUS) break;
        if (chain_too_long(parser, links)) break;
        consume(parser);
        expr = binary_expr(parser, kind == TOKEN_PLUS ? EXPR_ADD : EXPR_SUBTRACT, expr, parse_mul(parser));
        expr->span = span_from(parser, expr->as.op.a->span);
    }
    return expr;
}

static bool comparison_kind(TokenKind token, ExprKind *kind)
{
    switch (token) {
    case TOKEN_EQUAL: *kind = EXPR_EQUAL; return true;
    case TOKEN_NOT_EQUAL: *kind = EXPR_NOT_EQUAL; return true;
    case TOKEN_LESS: *kind = EXPR_LESS; return true;
    case TOKEN_LESS_EQUAL: *kind = EXPR_LESS_EQUAL; return true;
    case TOKEN_GREATER: *kind = EXPR_GREATER; return true;
    case TOKEN_GREATER_EQUAL: *kind = EXPR_GREATER_EQUAL; return true;
    default: return false;
    }
}

/* not = "not" not | add [ ( "==" | "!=" | "<" | "<=" | ">" | ">=" ) add ] ; */
static Expr *parse_not(Parser *parser)
{
    Span begin = token_span(parser);
    if (parser->token.kind == TOKEN_NOT) {
        if (!enter(parser)) return poison_expr(parser);
        consume(parser);
        Expr *expr = expr_new(parser, EXPR_NOT, begin);
        expr->as.op.a = parse_not(parser);
        expr->span = span_from(parser, begin);
        leave(parser);
        return expr;
    }
    Expr *expr = parse_add(parser);
    ExprKind kind, second;
    if (parser->panic || !comparison_kind(parser->token.kind, &kind)) return expr;
    consume(parser);
    if (kind == EXPR_LESS && parser->token.kind == TOKEN_GREATER) {
        Diagnostic *report = expected_error(parser, "an expression");
        if (report) diag_hint(parser->diag, report, "write '!=' for what is not equal");
        parser->panic = false;
        consume(parser);
    }
    Expr *b = parse_add(parser);
    expr = binary_expr(parser, kind, expr, b);
    if (!parser->panic && comparison_kind(parser->token.kind, &second)) {
        Diagnostic *report = syntax_error(parser, token_span(parser), "comparisons do not chain");
        if (report) diag_hint(parser->diag, report, "write a < b and b < c");
    }
    return expr;
}

/* and = not { "and" not } ; */
static Expr *parse_and(Parser *parser)
{
    Expr *expr = parse_not(parser);
    for (int links = 0; !parser->panic && parser->token.kind == TOKEN_AND && !chain_too_long(parser, links); links++) {
        consume(parser);
        expr = binary_expr(parser, EXPR_AND, expr, parse_not(parser));
    }
    return expr;
}

/* or = and { "or" and } ; */
static Expr *parse_or(Parser *parser)
{
    Expr *expr = parse_and(parser);
    for (int links = 0; !parser->panic && parser->token.kind == TOKEN_OR && !chain_too_long(parser, links); links++) {
        consume(parser);
        expr = binary_expr(parser, EXPR_OR, expr, parse_and(parser));
    }
    return expr;
}

/* tern = or [ "?" expr ":" expr ] ; */
Expr *parse_tern(Parser *parser)
{
    Expr *condition = parse_or(parser);
    if (parser->panic || parser->token.kind != TOKEN_QUESTION) return condition;
    if (!enter(parser)) return poison_expr(parser);
    consume(parser);
    Expr *expr = expr_new(parser, EXPR_CONDITION, condition->span);
    expr->as.op.a = condition;
    expr->as.op.b = parse_expr(parser);
    expect(parser, TOKEN_COLON, "between the two values of '?'");
    expr->as.op.c = parse_expr(parser);
    expr->span = span_from(parser, condition->span);
    leave(parser);
    return expr;
}

static Expr *parse_let(Parser *parser)
{
    Span begin = token_span(parser);
    if (!enter(parser)) return poison_expr(parser);
    consume(parser);
    Expr *expr = parse_bare_let(parser, begin);
    if (expr) {
        leave(parser);
        return expr;
    }
    expr = expr_new(parser, EXPR_LET, begin);
    Span opening = token_span(parser);
    if (expect(parser, TOKEN_PAREN_OPEN, "behind 'let' in an expression"))
        expr->as.let.bindings = parse_args(parser, opening);
    for (uint32_t i = 0; i < expr->as.let.bindings.n; i++)
        if (!expr->as.let.bindings.items[i].name && !parser->panic)
            syntax_error(parser, expr->as.let.bindings.items[i].value->span, "expected name = value in 'let (...)'");
    expr->as.let.body = parse_expr(parser);
    expr->span = span_from(parser, begin);
    leave(parser);
    return expr;
}

/* expr = "let" "(" [ bound { "," bound } [ "," ] ] ")" expr | tern [ ( ".." | "..<" ) tern [ "by" tern ] ] ; */
Expr *parse_expr(Parser *parser)
{
    if (parser->token.kind == TOKEN_LET) return parse_let(parser);
    Expr *first = parse_tern(parser);
    bool open = parser->token.kind == TOKEN_RANGE_OPEN;
    if (parser->panic || (!open && parser->token.kind != TOKEN_RANGE)) return first;
    if (!open) parse_three_points(parser, first);
    consume(parser);
    Expr *expr = binary_expr(parser, EXPR_RANGE, first, parse_tern(parser));
    expr->as.op.open = open;
    if (consume_if(parser, TOKEN_BY)) expr->as.op.c = parse_tern(parser);
    expr->span = span_from(parser, first->span);
    return expr;
}

Expr *parse_expression(uint32_t source, double unit_m, Diag *diag, SymbolTable *symbols)
{
    Parser parser;
    parser_init(&parser, NULL, source, unit_m, diag, symbols);
    Expr *expr = parse_expr(&parser);
    if (!parser.panic && parser.token.kind != TOKEN_END) {
        bool comma = parser.token.kind == TOKEN_COMMA; /* pos=1,2,3 */
        Diagnostic *report = expected_error(&parser, "the end of the expression");
        if (report && comma)
            diag_hint(diag, report, "a vector stands in '<' and '>', in quotes for the shell: 'pos=<1, 2, 3>'");
    }
    return parser.panic ? poison_expr(&parser) : expr;
}

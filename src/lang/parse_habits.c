/* parse_habits.c - statements in the way of other languages: each is reported with what is written here, and then read
 * as it was meant, so that the text behind it is checked and nothing is reported twice.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/parse_habits.h"

#include <string.h>

#include "base/suggest.h"
#include "lang/builtin.h"
#include "lang/habits.h"

enum {
    LONGEST_QUOTE = 60, /* bytes of the scene in a hint */
    MOST_VALUES = 8     /* values without a name that a hint names */
};

const char *quote(const Parser *parser, uint32_t begin, uint32_t end)
{
    const char *text = parser->lexer.text + begin;
    size_t length = end > begin ? end - begin : 0;
    bool whole = length <= LONGEST_QUOTE && !memchr(text, '\n', length);
    return whole ? arena_copy_text(parser->arena, text, length) : "...";
}

const char *quote_read(Parser *parser, Expr *(*parse)(Parser *))
{
    uint32_t begin = parser->token.begin;
    parse(parser);
    return quote(parser, begin, consumed_end(parser));
}

Diagnostic *report_at(Parser *parser, Span span, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const char *text = arena_format_list(parser->arena, format, args);
    va_end(args);
    return parser_report(parser, D_SYNTAX, span, text);
}

Span behind_last(const Parser *parser)
{
    uint32_t end = consumed_end(parser);
    return (Span){parser->lexer.source, end, end};
}

void hint_write(Parser *parser, Diagnostic *report, const char *text)
{
    diag_hint(parser->diag, report, "write: %s", text);
}

static void advise(Parser *parser, Diagnostic *report, const char *word)
{
    const char *advice = parser->node ? habit_advice(parser->node, word) : NULL;
    if (report && advice) diag_hint(parser->diag, report, "%s", advice);
}

/* ---- values without '=', or without a name ---- */

bool is_color_word(const char *word)
{
    static const char *const words[] = {"rgb", "rgbf", "rgbt", "rgbft", "srgb", "color", "colour"};
    for (size_t i = 0; i < COUNT_OF(words); i++)
        if (strcmp(words[i], word) == 0) return true;
    return false;
}

static bool at_color_word(const Parser *parser)
{
    return parser->token.kind == TOKEN_NAME && is_color_word(parser->token.as.symbol->text);
}

/* "color rgb <1, 0, 0>" up to the value itself, where that is one. */
static void skip_color_words(Parser *parser)
{
    while (at_color_word(parser)) {
        TokenKind next = peek(parser).kind;
        if (next != TOKEN_LESS && next != TOKEN_NUMBER && next != TOKEN_STRING && next != TOKEN_NAME) return;
        consume(parser);
    }
}

static bool is_number_text(const char *text)
{
    text += *text == '-';
    text += *text == '.';
    return *text >= '0' && *text <= '9';
}

/* One number, for which a vector is wanted, as that. */
static const char *vector_text(Arena *arena, const char *value)
{
    bool one = is_number_text(value) && !strpbrk(value, " ,*+/");
    return one ? arena_format(arena, "<%s, %s, %s>", value, value, value) : value;
}

/* A value of POV-Ray's, and the others that follow it behind commas: its text, for a hint. */
static const char *foreign_value(Parser *parser, bool color)
{
    color |= at_color_word(parser);
    skip_color_words(parser);
    bool vector = parser->token.kind == TOKEN_LESS;
    const char *value = quote_read(parser, parse_add); /* "<0, 0, 0> <1, 1, 1>" compares nothing */
    const char *word = habit_word(value);
    if (parser->panic || !color) return value;
    return vector && strcmp(value, "...") != 0
               ? arena_format(parser->arena, "rgb(%.*s)", (int)strlen(value) - 2, value + 1)
           : word ? word
                  : value;
}

/* Does another value follow, behind a comma, or of a transform behind a blank? "rotate y 45" */
static bool has_further_value(const Parser *parser, bool call)
{
    if (parser->token.kind == TOKEN_COMMA) return begins_value(peek(parser).kind);
    return call && starts_value(parser) && !first_on_line(parser);
}

/* "matrix <1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0>", behind the word: more in '<' and '>' than a vector has */
static bool parse_matrix_habit(Parser *parser, const char *word)
{
    if (strcmp(word, "matrix") != 0 || parser->token.kind != TOKEN_LESS) return false;
    Look look;
    look_from(parser, &look);
    int commas = 0;
    for (Token token = lexer_next(&look.lexer); token.kind != TOKEN_GREATER; token = lexer_next(&look.lexer)) {
        commas += token.kind == TOKEN_COMMA;
        if (token.kind == TOKEN_END || token.begin > parser->token.begin + NEAR_LOOK) return false;
    }
    if (commas < 4) return false;
    Diagnostic *report = report_at(parser, behind_last(parser), "expected '(' behind 'matrix', found '<'");
    consume(parser);
    uint32_t begin = parser->token.begin;
    do parse_add(parser);
    while (!parser->panic && consume_if(parser, TOKEN_COMMA));
    if (parser->panic) return true;
    diag_hint(parser->diag, report, "write: matrix(%s)", quote(parser, begin, consumed_end(parser)));
    consume_if(parser, TOKEN_GREATER);
    calm_down(parser);
    return true;
}

/* A transform whose brackets are missing; n values. What POV-Ray turns or moves it does in mirrored space: said once of a file, at
 * the first vector, which is how it writes them. */
static void hint_at_transform(Parser *parser, Diagnostic *report, const char *word, const char *value, int n)
{
    const char *mirrored = "";
    bool moves = strcmp(word, "rotate") == 0 || strcmp(word, "translate") == 0;
    if (moves && n == 1 && strpbrk(value, "<xyz") && !parser->mirror_told && report->text) {
        parser->mirror_told = true;
        mirrored =
            "; where the scene is POV-Ray's, z points the other way: turn the sign of z round everywhere, and that of "
            "rotations about x and y";
    }
    diag_hint(parser->diag, report, n == 3 ? "write: %s(<%s>)%s" : "write: %s(%s)%s", word, value, mirrored);
}

/* name value */
static void value_behind_name(Parser *parser, Path path)
{
    const char *word = path.names[path.n - 1]->text, *advice = NULL;
    if (path.n == 1 && parse_matrix_habit(parser, word)) return;
    const char *pattern = habit_setting(parser->node, word);
    if (path.n == 1 && parser->node) advice = habit_advice(parser->node, word);
    const char *other = parser->node && !pattern ? habit_property_of(parser->node, word) : NULL;
    bool call = path.n == 1 && builtin_find(word) && !(parser->node && pattern);
    Diagnostic *report = report_at(parser, behind_last(parser), "expected '%s' behind '%s', found %s", call ? "(" : "=",
                                   word, found_text(parser));
    const char *value = foreign_value(parser, !call && is_color_word(word));
    int n = 1;
    while (parser->node && !parser->panic &&
           has_further_value(parser, call)) { /* area_light <1, 0, 0>, <0, 0, 1>, 3, 3 */
        consume_if(parser, TOKEN_COMMA);
        value = arena_format(parser->arena, "%s, %s", value, foreign_value(parser, false));
        n++;
    }
    if (parser->panic) return;
    if (pattern && strstr(pattern, "@*") && n == 3 && !strchr(value, '<')) /* center 1, 2, 3 */
        value = arena_format(parser->arena, "<%s>", value);
    if (call) /* translate 1, 2, 3 */
        hint_at_transform(parser, report, word, value, n);
    else if (advice)
        advise(parser, report, word);
    else if (pattern && strstr(pattern, "@*"))
        hint_write(parser, report, habit_fill(parser->arena, pattern, vector_text(parser->arena, value)));
    else
        hint_write(parser, report,
                   pattern ? habit_fill(parser->arena, pattern, value)
                           : habit_assignment(parser->arena, other ? other : word, value));
    calm_down(parser);
}

/* "hollow no_shadow": words of POV-Ray that have no value. Does the next one begin something of its own? "right x*1.3" goes on. */
static bool parse_flag_habit(Parser *parser, Path path)
{
    const char *word = path.names[0]->text, *second = parser->token.as.symbol->text;
    if (path.n > 1 || !parser->node || !habit_advice(parser->node, word) || builtin_find(word)) return false;
    TokenKind next = peek(parser).kind;
    bool value = next >= TOKEN_PLUS && next <= TOKEN_CARET; /* x*1.3, and clock by itself */
    bool truth = strcmp(second, "on") == 0 || strcmp(second, "off") == 0;
    if (value || next == TOKEN_DOT || (strchr("xyzuvt", *second) && !second[1])) return false;
    advise(parser, expected_error(parser, arena_format(parser->arena, "'=' and a value behind '%s'", word)), word);
    parser->panic = false;
    if (truth) consume(parser);
    calm_down(parser);
    return true;
}

/* The next word of names ("center* radius"), behind which *names moves; *mark: '*' or '+', if it has one. */
static const char *next_value_name(Arena *arena, const char **names, char *mark)
{
    size_t length = strcspn(*names, " *+");
    const char *name = arena_copy_text(arena, *names, length);
    *mark = (*names)[length] == '*' || (*names)[length] == '+' ? (*names)[length] : 0;
    *names += length + (*mark != 0);
    *names += strspn(*names, " ");
    return length ? name : "PROPERTY";
}

/* aperture = f2.8, of which .8 is left when the name f2 has been read */
static bool is_f_number(const Parser *parser)
{
    const char *text = parser->lexer.text;
    uint32_t end = parser->token.begin, begin = end;
    while (begin > 0 && text[begin - 1] >= '0' && text[begin - 1] <= '9') begin--;
    return parser->previous == TOKEN_NAME && text[end] == '.' && begin < end && begin > 0 && text[begin - 1] == 'f';
}

/* value, value ... in the block of a node; the first one may have been read as a name already */
static void values_without_names(Parser *parser, const Path *first)
{
    const char *node = parser->node, *known = habit_values(node), *names = known ? known : "", *hint = NULL;
    Span span = first ? first->span : token_span(parser);
    bool f_number = !first && strcmp(node, "camera") == 0 && is_f_number(parser);
    Diagnostic *report = report_at(parser, span, "a value of '%s' has no name", node);
    for (int i = 0; i < MOST_VALUES && !parser->panic; i++) {
        bool over = known && !*names;
        char mark;
        const char *name = next_value_name(parser->arena, &names, &mark);
        const char *value = i == 0 && first ? quote(parser, span.begin, span.end)
                                            : foreign_value(parser, known && strcmp(name, "color") == 0);
        if (parser->panic) break;
        if (mark == '*') value = vector_text(parser->arena, value);
        bool pair = mark == '+' && (consume_if(parser, TOKEN_COMMA) || starts_value(parser)); /* film { 640, 480 } */
        if (pair) value = arena_format(parser->arena, "<%s, %s>", value, foreign_value(parser, false));
        if (!over) hint = arena_format(parser->arena, "%s%s%s = %s", hint ? hint : "", hint ? "  " : "", name, value);
        if (!consume_if(parser, TOKEN_COMMA) && !(starts_value(parser) && known)) break;
    }
    if (f_number)
        diag_hint(parser->diag, report, "%s", habit_advice("camera", "f_number"));
    else if (hint)
        hint_write(parser, report, hint);
    if (!parser->panic) calm_down(parser);
}

/* center = <0, a > b ? 1 : 2, 0>: the comparison's sign has ended the vector. */
static bool is_cut_vector(Parser *parser)
{
    Look look;
    look_from(parser, &look);
    if (parser->previous != TOKEN_GREATER || lexer_next(&look.lexer).kind != TOKEN_QUESTION) return false;
    Diagnostic *report = syntax_error(parser, token_span(parser), "'>' has ended the vector before this");
    diag_hint(parser->diag, report, "a comparison within '<' and '>' stands in brackets: <0, (a > b ? 1 : 2), 0>");
    return true;
}

bool parse_value_habit(Parser *parser)
{
    if (!parser->node || !starts_value(parser)) return false;
    if (is_cut_vector(parser)) return true;
    values_without_names(parser, NULL);
    return true;
}

bool parse_comma_habit(Parser *parser)
{
    if (parser->token.kind != TOKEN_COMMA) return false;
    Look look;
    look_from(parser, &look);
    Token next = lexer_next(&look.lexer);
    bool decimal = parser->previous == TOKEN_NUMBER && next.kind == TOKEN_NUMBER &&
                   consumed_end(parser) == parser->token.begin && next.begin == parser->token.end;
    Look beyond = look;
    if (decimal && lexer_next(&beyond.lexer).kind == TOKEN_COMMA) decimal = false; /* 0,5,0 is no decimal */
    if (decimal) {
        Diagnostic *report = report_at(parser, token_span(parser), "expected a statement, found ','");
        diag_hint(parser->diag, report, "decimals stand behind a point");
        consume(parser);
        consume(parser);
        return true;
    }
    if (!parser->comma_reported) {
        Diagnostic *report = report_at(parser, token_span(parser), "no comma stands between statements or properties");
        bool vector = parser->previous == TOKEN_NUMBER && (next.kind == TOKEN_NUMBER || next.kind == TOKEN_MINUS);
        bool name = !parser->node && next.kind == TOKEN_NAME && lexer_next(&look.lexer).kind == TOKEN_ASSIGN;
        if (name) /* let a = 1, b = 2 */
            diag_hint(parser->diag, report, "each name has a statement of its own: let %s = ...", next.as.symbol->text);
        else
            diag_hint(parser->diag, report,
                      vector ? "a vector stands in '<' and '>': <1, 2, 3>" : "remove it; a blank is enough");
    }
    parser->comma_reported = true;
    consume(parser);
    return true;
}

bool parse_function_habit(Parser *parser, Path path)
{
    if (path.n > 1 || first_on_line(parser)) return false;
    const char *head = quote(parser, path.span.begin, consumed_end(parser)), *advice = habit_block(path.names[0]->text);
    Diagnostic *report = expected_error(parser, "a statement");
    parser->panic = false;
    consume(parser);
    const char *value = quote_read(parser, parse_expr);
    if (parser->node && advice)
        diag_hint(parser->diag, report, "%s", advice);
    else
        hint_write(parser, report,
                   arena_format(parser->arena, "def %s = %s%s", head, value, parser->node ? ", before the node" : ""));
    return true;
}

/* ---- changes of names, and of parts of values ---- */

/* Of "+=", "++" and their like, at the first character: the second one; TOKEN_END: it is none of them. */
static Token second_of_change(const Parser *parser)
{
    TokenKind kind = parser->token.kind;
    Token none = {.kind = TOKEN_END};
    if (kind != TOKEN_PLUS && kind != TOKEN_MINUS && kind != TOKEN_STAR && kind != TOKEN_SLASH) return none;
    Token next = peek(parser);
    bool one = next.kind == kind && (kind == TOKEN_PLUS || kind == TOKEN_MINUS);
    return next.begin == parser->token.end && (one || next.kind == TOKEN_ASSIGN) ? next : none;
}

/* Whether a value would be torn apart behind that sign. */
static bool needs_brackets(char sign, ExprKind kind)
{
    if (kind >= EXPR_EQUAL && kind <= EXPR_RANGE) return true;
    if (kind == EXPR_ADD || kind == EXPR_SUBTRACT) return sign != '+';
    return sign == '/' && kind >= EXPR_MULTIPLY && kind <= EXPR_MODULO;
}

/* "(a + b)", and not "(a) + (b)" */
static bool is_in_brackets(const char *text)
{
    int depth = 0;
    for (const char *at = text; *at; at++) {
        depth += (*at == '(') - (*at == ')');
        if (depth == 0) return at > text && !at[1];
    }
    return false;
}

/* What "+=" adds, for behind a sign. */
static const char *read_operand(Parser *parser, char sign)
{
    uint32_t begin = parser->token.begin;
    const Expr *operand = parse_expr(parser);
    const char *text = quote(parser, begin, consumed_end(parser));
    bool whole = !needs_brackets(sign, operand->kind) || is_in_brackets(text);
    return whole ? text : arena_format(parser->arena, "(%s)", text);
}

/* At the first character, next being the second; word: what declares a name and stands before it, or NULL. */
static void read_change(Parser *parser, const Symbol *symbol, Token next, const char *word)
{
    const char *name = symbol->text;
    bool one = next.kind == parser->token.kind;
    char sign = parser->lexer.text[parser->token.begin];
    Span span = {parser->lexer.source, parser->token.begin, next.end};
    Diagnostic *report = report_at(parser, span, "there is no '%c%c' here", sign, one ? sign : '=');
    consume(parser);
    consume(parser);
    const char *value = one ? "1" : read_operand(parser, sign);
    const char *without = word ? arena_format(parser->arena, ", without '%s'", word) : "";
    const char *declared =
        symbol->is_variable ? "" : arena_format(parser->arena, ", and var %s = ... where it is declared", name);
    diag_hint(parser->diag, report, "write: %s := %s %c %s%s%s", name, name, sign, value, without, declared);
}

static bool parse_change(Parser *parser, Path path)
{
    Token next = second_of_change(parser);
    if (next.kind == TOKEN_END) return false;
    if (path.n > 1)
        parse_member_change(parser, path);
    else
        read_change(parser, path.names[0], next, NULL);
    return true;
}

bool parse_declared_change(Parser *parser, const Symbol *name, const char *word)
{
    Token next = second_of_change(parser);
    if (next.kind == TOKEN_END) return false;
    read_change(parser, name, next, word);
    return true;
}

/* What stands behind the "[...]" at the present token; *n: how many of them; *inner: what the first one holds. */
static Token behind_indices(Parser *parser, int *n, const char **inner)
{
    Look look;
    look_from(parser, &look);
    Token token = parser->token, first = {0}, last = {0};
    int depth = 0;
    *n = 0;
    do {
        depth += token.kind == TOKEN_BRACKET_OPEN;
        depth -= token.kind == TOKEN_BRACKET_CLOSE;
        *n += token.kind == TOKEN_BRACKET_OPEN && depth == 1;
        if (depth == 0 && last.end == 0) last = token;
        token = lexer_next(&look.lexer);
        if (first.end == 0) first = token;
    } while ((depth > 0 || token.kind == TOKEN_BRACKET_OPEN) && token.kind != TOKEN_END &&
             token.kind != TOKEN_BRACE_CLOSE);
    *inner = quote(parser, first.begin, last.begin);
    return token;
}

/* "objs[0] { }" and "objs[0]", behind the name: an instance of what a list holds */
static void parse_indexed_instance(Parser *parser, Path path)
{
    while (parser->token.kind == TOKEN_BRACKET_OPEN) skip_brackets(parser);
    uint32_t end = consumed_end(parser);
    Diagnostic *report = report_at(parser, (Span){parser->lexer.source, path.span.begin, end},
                                   "an instance begins with a name, not with a value");
    const char *value = quote(parser, path.span.begin, end);
    uint32_t begin = parser->token.begin;
    const char *block = "{ }";
    if (parser->token.kind == TOKEN_BRACE_OPEN) {
        parse_node_block(parser, NULL);
        block = quote(parser, begin, consumed_end(parser));
        if (*block != '{') block = "{ ... }";
    }
    diag_hint(parser->diag, report, "write: let object = %s  object %s", value, block);
}

/* Can a statement be over in front of that token? */
static bool is_behind_statement(const Parser *parser, const Token *token)
{
    return token->kind == TOKEN_SEMICOLON || token->kind == TOKEN_BRACE_CLOSE || token->kind == TOKEN_END ||
           begins_line(parser, token->begin);
}

/* "a[0] = 5", "a[0] += 5" and "a[0] { }", behind the name */
static bool parse_element_habit(Parser *parser, Path path)
{
    if (parser->token.kind != TOKEN_BRACKET_OPEN || first_on_line(parser)) return false;
    int groups;
    const char *index;
    Token token = behind_indices(parser, &groups, &index);
    bool adjacent = parser->token.begin == consumed_end(parser); /* "size [1, 2]" lacks a '=' */
    if (token.kind == TOKEN_BRACE_OPEN || (adjacent && is_behind_statement(parser, &token) && !strchr(index, ','))) {
        parse_indexed_instance(parser, path);
        return true;
    }
    bool change =
        token.kind == TOKEN_PLUS || token.kind == TOKEN_MINUS || token.kind == TOKEN_STAR || token.kind == TOKEN_SLASH;
    change &= parser->lexer.text[token.end] == '=';
    if (path.n > 1 || (!change && token.kind != TOKEN_ASSIGN && token.kind != TOKEN_CHANGE)) return false;
    const char *name = path.names[0]->text;
    Diagnostic *report = report_at(parser, path.span, "the elements of a list do not change");
    while (parser->token.kind == TOKEN_BRACKET_OPEN) skip_brackets(parser);
    consume(parser);
    if (change) consume(parser);
    const char *value = quote_read(parser, parse_expr);
    if (parser->panic) return true;
    if (change) value = arena_format(parser->arena, "%s[i] %c %s", name, parser->lexer.text[token.begin], value);
    hint_write(parser, report,
               groups == 1 ? arena_format(parser->arena, "%s := [for (i in 0..<len(%s)) i == %s ? %s : %s[i]]", name,
                                          name, index, value, name)
                           : arena_format(parser->arena, "%s := [...], a new list", name));
    return true;
}

/* "a.x := 5", behind the path: what a is to become instead, or where its property stands. */
void parse_member_change(Parser *parser, Path path)
{
    static const char *const vector[] = {"x", "y", "z"}, *const color[] = {"r", "g", "b"};
    const char *name = path.names[0]->text, *member = path.names[path.n - 1]->text;
    Diagnostic *report = report_at(parser, path.span, "the parts of a value do not change");
    TokenKind kind = parser->token.kind;
    bool change = kind != TOKEN_ASSIGN && kind != TOKEN_CHANGE, one = change && peek(parser).kind == kind;
    char sign = parser->lexer.text[parser->token.begin];
    consume(parser);
    if (change) consume(parser);
    const char *value = one ? "1" : quote_read(parser, parse_expr), *parts[3];
    if (parser->panic) return;
    if (change) value = arena_format(parser->arena, "%s.%s %c %s", name, member, sign, value);
    bool known = false, is_color = false;
    for (int i = 0; i < 3; i++) {
        is_color |= strcmp(member, color[i]) == 0;
        known |= strcmp(member, vector[i]) == 0 || is_color;
    }
    for (int i = 0; i < 3; i++) {
        const char *part = is_color ? color[i] : vector[i];
        parts[i] = strcmp(member, part) == 0 ? value : arena_format(parser->arena, "%s.%s", name, part);
    }
    if (!known && path.n == 2 && (!member[strspn(member, "xyzw")] || !member[strspn(member, "rgb")]))
        diag_hint(parser->diag, report, "write: %s := ..., a new %s", name,
                  strchr("rgb", *member) ? "colour" : "vector");
    else if (known && path.n == 2)
        diag_hint(parser->diag, report, is_color ? "write: %s := rgb(%s, %s, %s)" : "write: %s := <%s, %s, %s>", name,
                  parts[0], parts[1], parts[2]);
    else
        diag_hint(parser->diag, report, "a property stands in the block of its node: NODE %s { %s = %s }", name, member,
                  value);
}

/* ---- files, and names of nodes ---- */

/* The name of a file from the present token up to the next blank; NULL: there is none. */
static const char *unquoted_file(Parser *parser)
{
    const char *text = parser->lexer.text + parser->token.begin;
    bool angles = *text == '<';
    size_t length = strcspn(text + angles, " \t\r\n;<>\"{}");
    const char *name = arena_copy_text(parser->arena, text + angles, length);
    if (length == 0) return NULL;
    parser->lexer.at = parser->token.begin + angles + (uint32_t)length;
    parser->lexer.at += parser->lexer.text[parser->lexer.at] == '>';
    consume(parser);
    return strchr(name, '.') ? name : arena_format(parser->arena, "%s.mns", name);
}

/* " as NAME" where that stands, or "". */
static const char *import_name(Parser *parser)
{
    if (parser->token.kind != TOKEN_AS || first_on_line(parser)) return "";
    consume(parser);
    if (parser->token.kind != TOKEN_NAME) return " as NAME";
    const char *name = parser->token.as.symbol->text;
    consume(parser);
    return arena_format(parser->arena, " as %s", name);
}

void parse_unquoted_file(Parser *parser, const char *word)
{
    Diagnostic *report = expected_error(parser, "the name of a file in quotes");
    bool begins = parser->token.kind == TOKEN_NAME || parser->token.kind == TOKEN_LESS ||
                  parser->token.kind == TOKEN_DOT || parser->token.kind == TOKEN_RANGE ||
                  parser->token.kind == TOKEN_SLASH;
    if (!report || !begins) return;
    parser->panic = false;
    const char *file = unquoted_file(parser);
    if (file) hint_write(parser, report, arena_format(parser->arena, "%s \"%s\"%s", word, file, import_name(parser)));
}

/* "import "x" as y" and "import x", behind the first word */
static bool parse_foreign_import(Parser *parser, Path path)
{
    bool text = parser->token.kind == TOKEN_STRING, name = parser->token.kind == TOKEN_NAME;
    if (path.n > 1 || parser->node || first_on_line(parser) || (!text && !name)) return false;
    if (!habit_is_import(path.names[0]->text)) return false;
    Diagnostic *report = report_at(parser, path.span, "'%s' begins nothing here", path.names[0]->text);
    const char *file = text ? parser->token.as.text : unquoted_file(parser);
    if (text) consume(parser);
    if (file && !strchr(file, '.')) file = arena_format(parser->arena, "%s.mns", file);
    diag_hint(parser->diag, report, "write: use \"%s\"%s", file ? file : "NAME.mns", import_name(parser));
    while (!first_on_line(parser) && parser->token.kind != TOKEN_END) consume(parser); /* from "x" import y */
    return true;
}

/* "medium red = glass { ior = 1.6 }": a variety of a prototype, behind the type; outside of nodes, where no property can be meant,
 * also "medium head = media.foam()" and "medium red = glass" */
static bool parse_typed_instance(Parser *parser, Path path)
{
    Look look;
    if (path.n != 1 || first_on_line(parser)) return false;
    look_from(parser, &look);
    if (lexer_next(&look.lexer).kind != TOKEN_ASSIGN) return false;
    Token last = lexer_next(&look.lexer), behind = lexer_next(&look.lexer);
    uint32_t begin = last.begin;
    if (last.kind == TOKEN_NAME && behind.kind == TOKEN_DOT) {
        last = lexer_next(&look.lexer);
        behind = lexer_next(&look.lexer);
    }
    bool block = behind.kind == TOKEN_BRACE_OPEN;
    if (last.kind != TOKEN_NAME || !(block || (!parser->node && !lacks_opening_brace(parser)))) return false;
    const char *name = parser->token.as.symbol->text, *prototype = quote(parser, begin, last.end);
    consume(parser);
    Diagnostic *report = expected_error(parser, "'{'");
    parser->panic = false;
    diag_hint(parser->diag, report, "write: let %s = %s%s", name, prototype,
              block                             ? " { ... }"
              : behind.kind == TOKEN_PAREN_OPEN ? "(...)"
                                                : "");
    consume(parser);
    parse_expr(parser);
    return true;
}

/* "medium "glass" { }", at the string */
static bool parse_quoted_name(Parser *parser, Path path)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789";
    if (parser->token.kind != TOKEN_STRING || parser->token.bad || peek(parser).kind != TOKEN_BRACE_OPEN) return false;
    const char *text = parser->token.as.text;
    char *name = arena_copy_text(parser->arena, text, strlen(text));
    for (char *at = name + strspn(name, letters); *at; at += strspn(at, letters)) *at = '_';
    Diagnostic *report = report_at(parser, token_span(parser), "a name stands without quotes");
    diag_hint(parser->diag, report, "write: %s %s { ... }", path.names[path.n - 1]->text, *name ? name : "NAME");
    consume(parser);
    parse_node_block(parser, path.names[path.n - 1]->text);
    return true;
}

/* A name that is declared, alone: "union { a; b { } }", "sphere { t }" */
static bool parse_bare_instance(Parser *parser, Path path)
{
    SymbolUse declared = path.names[0]->declared;
    const char *name = quote(parser, path.span.begin, path.span.end);
    if (declared == SYMBOL_FREE && path.n == 1) return false;
    if (declared == SYMBOL_TRANSFORM && path.n == 1) {
        hint_write(parser, report_at(parser, path.span, "a transform that has a name is applied by 'transform'"),
                   arena_format(parser->arena, "transform(%s)", name));
        calm_down(parser);
        return true;
    }
    Diagnostic *report = expected_error(
        parser, arena_format(parser->arena, "%s behind '%s'", declared == SYMBOL_DEF ? "'('" : "'{'", name));
    if (report && declared == SYMBOL_DEF && path.n == 1)
        diag_hint(parser->diag, report, "write: %s()", name);
    else if (report && parser->node && !habit_holds_nodes(parser->node))
        diag_hint(parser->diag, report, "write: PROPERTY = %s to use it, %s { } to place it", name, name);
    else if (report)
        diag_hint(parser->diag, report, "write: %s { }", name);
    parser->panic = false;
    calm_down(parser);
    return true;
}

bool parse_lone_word(Parser *parser, Path path)
{
    const char *word = path.names[0]->text, *hint = path.n == 1 ? habit_statement(word) : NULL;
    if (!hint || !is_behind_statement(parser, &parser->token) || path.names[0]->declared != SYMBOL_FREE) return false;
    diag_hint(parser->diag, report_at(parser, path.span, "there is no statement '%s'", word), "%s", hint);
    return true;
}

/* ---- a name, and what cannot follow it ---- */

/* "a - b" of solids, behind the first name */
static bool parse_solids(Parser *parser, Path path)
{
    TokenKind kind = parser->token.kind;
    bool operates = kind == TOKEN_PLUS || kind == TOKEN_MINUS || kind == TOKEN_STAR;
    if (!operates || first_on_line(parser) || path.n != 1 || path.names[0]->declared != SYMBOL_NODE) return false;
    Token other = peek(parser);
    if (other.kind != TOKEN_NAME || other.as.symbol->declared != SYMBOL_NODE) return false;
    Diagnostic *report = report_at(parser, token_span(parser), "'%s' does not work between nodes",
                                   quote(parser, parser->token.begin, parser->token.end));
    diag_hint(parser->diag, report, "write: %s { %s { }  %s { } }",
              kind == TOKEN_MINUS  ? "difference"
              : kind == TOKEN_STAR ? "intersection"
                                   : "union",
              path.names[0]->text, other.as.symbol->text);
    consume(parser);
    parse_expr(parser);
    return true;
}

bool parse_name_habit(Parser *parser, Path path)
{
    const char *word = path.names[path.n - 1]->text;
    if (parse_solids(parser, path)) return true;
    if (parse_change(parser, path) || parse_foreign_import(parser, path) || parse_quoted_name(parser, path))
        return true;
    if (parser->token.kind == TOKEN_COLON) {
        Diagnostic *report = expected_error(parser, arena_format(parser->arena, "'=' behind '%s'", word));
        parser->panic = false;
        consume(parser);
        const char *value = quote_read(parser, parse_expr);
        if (!parser->panic)
            diag_hint(parser->diag, report, "write: %s%s = %s", parser->node ? "" : "let ", word, value);
        return true;
    }
    if (parse_element_habit(parser, path)) return true;
    bool fresh = first_on_line(parser);
    if (is_behind_statement(parser, &parser->token) && parse_bare_instance(parser, path)) return true;
    if (parse_lone_word(parser, path)) return true;
    if (parser->node && parser->token.kind == TOKEN_COMMA && path.n == 1) {
        values_without_names(parser, &path);
        return true;
    }
    if (starts_value(parser) && !fresh) {
        value_behind_name(parser, path);
        return true;
    }
    if (parser->node && (fresh || parser->token.kind == TOKEN_BRACE_CLOSE)) { /* hollow */
        advise(parser, expected_error(parser, arena_format(parser->arena, "'=' and a value behind '%s'", word)), word);
        parser->panic = false;
        return true;
    }
    return false;
}

/* "sphere ball = {" and "sphere ball = sphere {" */
static bool parse_assigned_block(Parser *parser, Path path)
{
    Look look;
    look_from(parser, &look);
    if (lexer_next(&look.lexer).kind != TOKEN_ASSIGN) return false;
    Token behind = lexer_next(&look.lexer);
    bool again = behind.kind == TOKEN_NAME && behind.as.symbol == path.names[0];
    if (again) behind = lexer_next(&look.lexer);
    if (behind.kind != TOKEN_BRACE_OPEN) return false;
    const char *name = parser->token.as.symbol->text;
    consume(parser);
    Diagnostic *report = expected_error(parser, "'{'");
    parser->panic = false;
    diag_hint(parser->diag, report, "write: %s %s { ... }", path.names[0]->text, name);
    consume(parser);
    if (again) consume(parser);
    const char *outer = parser->node;
    parser->node = path.names[0]->text;
    parse_block(parser);
    parser->node = outer;
    return true;
}

/* name name, without a '{' behind them */
void parse_two_names(Parser *parser, Path path)
{
    static const char *const words[] = {"let", "var", "param", "def", "defaults", "use", "include"};
    const char *first = path.names[0]->text, *second = parser->token.as.symbol->text;
    const char *nearest = path.n == 1 ? suggest_nearest(first, words, COUNT_OF(words)) : NULL;
    TokenKind next = peek(parser).kind;
    SymbolUse declared = path.names[0]->declared;
    bool placed =
        declared != SYMBOL_FREE && (first_on_line(parser) || parser->token.as.symbol->declared != SYMBOL_FREE);
    if (parse_assigned_block(parser, path) || parse_foreign_import(parser, path)) return;
    if (!nearest && parse_typed_instance(parser, path)) return;
    if (placed && next != TOKEN_ASSIGN && parse_bare_instance(parser, path)) return;
    if (declared == SYMBOL_TRANSFORM && parser->node && parse_bare_instance(parser, path)) return;
    if (parse_flag_habit(parser, path)) return;
    if (next == TOKEN_PAREN_OPEN && habit_is_function(first)) {
        Diagnostic *report = report_at(parser, path.span, "'%s' begins nothing here", first);
        const Stmt *stmt = parse_def(parser, path.span, false);
        bool block = !stmt || !stmt->as.def->body;
        diag_hint(parser->diag, report, "write: def %s(...) %s", second, block ? "{ ... }" : "= ...");
        return;
    }
    if (next == TOKEN_ASSIGN && (habit_is_type(first) || nearest) && !lacks_opening_brace(parser)) {
        consume(parser);
        Diagnostic *report = expected_error(parser, "'{'");
        parser->panic = false;
        if (habit_is_type(first))
            diag_hint(parser->diag, report, "write: let %s = ...", second);
        else
            diag_hint(parser->diag, report, "did you mean '%s'?", nearest);
        consume(parser);
        parse_expr(parser);
        return;
    }
    bool fresh = first_on_line(parser);
    if (nearest || (next != TOKEN_ASSIGN && next != TOKEN_NAME && !fresh && !parser->node)) {
        bool value = !nearest && (builtin_find(first) || habit_setting(parser->node, first));
        if (value) {
            value_behind_name(parser, path);
            return;
        }
        consume(parser);
        Diagnostic *report = expected_error(parser, "'{'");
        if (report && nearest) diag_hint(parser->diag, report, "did you mean '%s'?", nearest);
        return;
    }
    if (lacks_opening_brace(parser)) {
        if (next == TOKEN_NAME) consume(parser);
        expected_error(parser, "'{'");
        parser->panic = false;
        block_without_opening(parser, first);
    } else if (fresh || next == TOKEN_ASSIGN || next == TOKEN_BRACE_OPEN || !parser->node) {
        advise(parser, expected_error(parser, arena_format(parser->arena, "'=', ':=', '(' or '{' behind '%s'", first)),
               first);
        parser->panic = false; /* the second name begins a statement of its own */
    } else {
        value_behind_name(parser, path);
    }
}

/* ---- declarations ---- */

void parse_names_together(Parser *parser, const Symbol *first)
{
    enum { MOST = 8 };
    const char *names[MOST] = {first->text}, *hint = "";
    size_t n = 1, n_values = 0;
    Diagnostic *report = report_at(parser, token_span(parser), "each name has a statement of its own");
    while (consume_if(parser, TOKEN_COMMA) && parser->token.kind == TOKEN_NAME) {
        if (n < MOST) names[n++] = parser->token.as.symbol->text;
        consume(parser);
    }
    bool assigned = consume_if(parser, TOKEN_ASSIGN);
    for (; assigned && !parser->panic; n_values++) {
        const char *value = quote_read(parser, parse_tern);
        if (n_values < n)
            hint = arena_format(parser->arena, "%s%slet %s = %s", hint, *hint ? "  " : "", names[n_values], value);
        if (!consume_if(parser, TOKEN_COMMA)) {
            n_values++;
            break;
        }
    }
    if (!parser->panic && n_values == n) hint_write(parser, report, hint);
    if (!parser->panic && n_values != n) diag_hint(parser->diag, report, "write: let %s = ...", first->text);
    parser->panic = false;
    calm_down(parser);
}

bool parse_no_value(Parser *parser, const char *expected, const char *hint)
{
    if (parser->panic || parser->token.kind == TOKEN_ASSIGN || !is_behind_statement(parser, &parser->token))
        return false;
    hint_write(parser, expected_error(parser, expected), hint);
    parser->panic = false;
    calm_down(parser);
    return true;
}

void parse_result_type(Parser *parser, const char *head)
{
    TokenKind kind = parser->token.kind;
    Look look;
    look_from(parser, &look);
    Token type = lexer_next(&look.lexer);
    bool arrow = kind == TOKEN_MINUS && type.kind == TOKEN_GREATER && type.begin == parser->token.end;
    if (!arrow && kind != TOKEN_COLON) return;
    if (arrow) type = lexer_next(&look.lexer);
    TokenKind behind = lexer_next(&look.lexer).kind;
    if (type.kind != TOKEN_NAME || (behind != TOKEN_ASSIGN && behind != TOKEN_BRACE_OPEN)) return;
    Diagnostic *report = report_at(parser, token_span(parser), "the value of a def has no type to be told");
    diag_hint(parser->diag, report, "write: def %s = ...", head);
    for (int i = arrow ? 3 : 2; i > 0; i--) consume(parser);
}

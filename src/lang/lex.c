/* lex.c - the lexer. One switch on the first byte of a token; everything that is not ASCII goes one way.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/lex.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/num.h"
#include "base/utf8.h"
#include "diag/limits.h"
#include "lang/habits.h"

enum { LONGEST_UNIT = 4 };

/* 180 / pi, of which two digits stand in front of the point: no double that is written with fewer than some 50 digits is so near
 * to the middle of two others that more would matter. */
#define DEGREES_PER_RADIAN "57295779513082320876798154814105170332405472466564321549160243861202847148321553"

/* clang-format off */
static const UnitType unit_table[] = {
    {"nm", UNIT_LENGTH, 1e-9, NULL, -9},
    {"um", UNIT_LENGTH, 1e-6, NULL, -6},
    {"mm", UNIT_LENGTH, 1e-3, NULL, -3},
    {"cm", UNIT_LENGTH, 1e-2, NULL, -2},
    {"m", UNIT_LENGTH, 1, NULL, 0},
    {"km", UNIT_LENGTH, 1e3, NULL, 3},
    {"in", UNIT_LENGTH, 25.4e-3, "254", -4},
    {"ft", UNIT_LENGTH, 0.3048, "3048", -4},
    {"deg", UNIT_ANGLE, 1, NULL, 0},
    {"rad", UNIT_ANGLE, 57.29577951308232, DEGREES_PER_RADIAN, 2 - (int)sizeof DEGREES_PER_RADIAN + 1},
    {"turn", UNIT_ANGLE, 360, "360", 0},
    {"ms", UNIT_TIME, 1e-3, NULL, -3},
    {"s", UNIT_TIME, 1, NULL, 0},
    {"K", UNIT_KELVIN, 1, NULL, 0},
};
/* clang-format on */

const UnitType *unit_of(const char *text, size_t length)
{
    for (size_t i = 0; i < COUNT_OF(unit_table); i++)
        if (strlen(unit_table[i].name) == length && memcmp(unit_table[i].name, text, length) == 0)
            return &unit_table[i];
    return NULL;
}

const UnitType *unit_at(size_t index)
{
    return index < COUNT_OF(unit_table) ? &unit_table[index] : NULL;
}

const char *unit_list(Arena *arena, PropUnit measure)
{
    const char *list = "";
    for (size_t i = 0; i < COUNT_OF(unit_table); i++)
        if (measure == UNIT_ANY || unit_table[i].measure == measure)
            list = arena_format(arena, "%s%s%s", list, *list ? " " : "", unit_table[i].name);
    return list;
}

static const UnitType *length_unit(double size_m)
{
    for (size_t i = 0; i < COUNT_OF(unit_table); i++)
        if (unit_table[i].measure == UNIT_LENGTH && unit_table[i].size == size_m) return &unit_table[i];
    return NULL;
}

const char *unit_of_length(double size_m)
{
    const UnitType *unit = length_unit(size_m);
    return unit ? unit->name : NULL;
}

/* The number is multiplied in its text, and rounded once: 92mm would not be 9.2cm, as no power of ten below 1 is a double. */
double unit_value(const char *text, size_t length, const UnitType *unit, double unit_m)
{
    static const UnitType base = {.size = 1};
    const UnitType *scene = unit->measure == UNIT_LENGTH ? length_unit(unit_m) : &base;
    assert(scene);
    NumScale scale = {.power = unit->power - scene->power};
    if (unit->count != scene->count) scale.times = unit->count;
    for (const char *digit = scene->count; digit && unit->count != scene->count && *digit; digit++)
        scale.over = scale.over * 10 + (unsigned)(*digit - '0');
    double number;
    num_parse_scaled(text, length, scale, &number);
    return number;
}

const char *unit_of_measure(PropUnit measure, double unit_m)
{
    switch (measure) {
    case UNIT_LENGTH: return unit_of_length(unit_m);
    case UNIT_ANGLE: return "deg";
    case UNIT_TIME: return "s";
    case UNIT_KELVIN: return "K";
    default: return NULL;
    }
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

void unit_add_behind_numbers(Buf *out, const char *text, const char *unit)
{
    for (const char *c = text; *c; c++) {
        buf_format(out, "%c", *c);
        bool goes_on = is_digit(c[1]) || c[1] == 'e' || (c[1] == '.' && is_digit(c[2]));
        if (unit && is_digit(*c) && !goes_on) buf_add(out, unit);
    }
}

const char *unit_measure_text(PropUnit measure)
{
    static const char *const texts[] = {
        [UNIT_NONE] = "a plain number", [UNIT_LENGTH] = "a length",         [UNIT_ANGLE] = "an angle",
        [UNIT_TIME] = "a time",         [UNIT_PER_LENGTH] = "1 per length", [UNIT_KELVIN] = "a temperature",
        [UNIT_ANY] = "of any unit",
    };
    return texts[measure];
}

const char *token_text(TokenKind kind)
{
    static const char *const texts[] = {
#define TOKEN(name, text) text,
#define KEYWORD(name, word, example) "'" word "'",
#include "lang/token.def"
#undef TOKEN
#undef KEYWORD
    };
    return texts[kind];
}

const KeywordType *keyword_at(size_t index)
{
    static const KeywordType table[] = {
#define TOKEN(name, text)
#define KEYWORD(name, word, example) {word, example},
#include "lang/token.def"
#undef TOKEN
#undef KEYWORD
    };
    return index < COUNT_OF(table) ? &table[index] : NULL;
}

/* ---- character classes ---- */

enum { CLASS_BLANK = 1, CLASS_LETTER = 2, CLASS_DIGIT = 4, CLASS_HIGH = 8 };

static unsigned class_of(char character)
{
    unsigned char c = (unsigned char)character;
    if (c == ' ' || c == '\t' || c == '\n' || c == '\r') return CLASS_BLANK;
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_') return CLASS_LETTER;
    if (c >= '0' && c <= '9') return CLASS_DIGIT;
    return c >= 0x80 ? CLASS_HIGH : 0;
}

/* Beyond ASCII every letter of every script may stand in a name, so whatever is no blank, punctuation or control is
 * taken for one: a table of all scripts would say no more to a reader of a message. */
bool lexer_is_letter(uint32_t code)
{
    if (code == UTF8_INVALID || code < 0xc0) return code == 0xaa || code == 0xb5 || code == 0xba;
    return !(code == 0xd7 || code == 0xf7 || (code >= 0x2000 && code <= 0x2bff) || (code >= 0x2e00 && code <= 0x2e7f) ||
             (code >= 0x3000 && code <= 0x3004) || (code >= 0x3008 && code <= 0x3020) || code == 0xfeff ||
             (code >= 0xe000 && code <= 0xf8ff) || (code >= 0xfe10 && code <= 0xfe6f) ||
             (code >= 0xfff0 && code <= 0xffff) || (code >= 0xff01 && code <= 0xff0f) ||
             (code >= 0x1f000 && code <= 0x1faff) || code >= 0xe0000);
}

static int hex_value(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

static Diagnostic *lex_error_at(Lexer *lexer, DiagCode code, uint32_t begin, uint32_t end, const char *text)
{
    return diag_report(lexer->diag, code, (Span){lexer->source, begin, end}, "%s", text);
}

static void report_byte(Lexer *lexer, uint32_t begin, uint32_t end)
{
    diag_hint(lexer->diag, lex_error_at(lexer, D_INVALID_UTF8, begin, end, "this byte is not text in UTF-8"),
              "save the file in UTF-8, or: iconv -f latin1 -t utf-8 old.mns > new.mns");
}

void lexer_init(Lexer *lexer, Diag *diag, SymbolTable *symbols, uint32_t source)
{
    const Source *from = &diag->sources->sources[source];
    *lexer = (Lexer){.diag = diag, .symbols = symbols, .source = source, .text = from->text, .length = from->length};
    lexer->at = (uint32_t)utf8_mark_length(lexer->text, lexer->length);
}

/* ---- blanks and comments ---- */

static void skip_block_comment(Lexer *lexer)
{
    uint32_t begin = lexer->at, at = begin + 2;
    int depth = 1;
    while (depth > 0 && at < lexer->length) {
        const char *p = lexer->text + at;
        if (p[0] == '*' && p[1] == '/') {
            depth--;
            at += 2;
        } else if (p[0] == '/' && p[1] == '*') {
            depth++;
            at += 2;
        } else {
            at++;
        }
    }
    lexer->at = at;
    if (depth > 0) lex_error_at(lexer, D_UNTERMINATED_COMMENT, begin, begin + 2, "this comment is not closed");
}

void lexer_skip_blanks(Lexer *lexer)
{
    for (;;) {
        const char *p = lexer->text + lexer->at;
        if (class_of(*p) == CLASS_BLANK) {
            lexer->at++;
        } else if (p[0] == '/' && p[1] == '/') {
            const char *end = memchr(p, '\n', lexer->length - lexer->at);
            lexer->at = end ? (uint32_t)(end - lexer->text) : lexer->length;
        } else if (p[0] == '/' && p[1] == '*') {
            skip_block_comment(lexer);
        } else {
            return;
        }
    }
}

/* ---- names ---- */

/* the end of the name that starts at begin, begin itself when none does */
static uint32_t name_end(const Lexer *lexer, uint32_t begin)
{
    uint32_t at = begin;
    for (;;) {
        unsigned class = class_of(lexer->text[at]);
        if (class == CLASS_LETTER || (class == CLASS_DIGIT && at > begin)) {
            at++;
        } else if (class == CLASS_HIGH) {
            uint32_t code;
            size_t n = utf8_decode(lexer->text + at, lexer->length - at, &code);
            if (!lexer_is_letter(code)) return at;
            at += (uint32_t)n;
        } else {
            return at;
        }
    }
}

static void read_name(Lexer *lexer, Token *token)
{
    uint32_t end = name_end(lexer, lexer->at), length = end - lexer->at;
    if (length > LIMIT_NAME_BYTES) {
        Diagnostic *report = diag_report(lexer->diag, D_LIMIT, (Span){lexer->source, lexer->at, lexer->at + 1},
                                         "this name has %u bytes; the limit is %d", length, LIMIT_NAME_BYTES);
        limit_hint(lexer->diag, report, OVER_NAME_BYTES);
        length = LIMIT_NAME_BYTES;
    }
    token->as.symbol = symbol_of(lexer->symbols, lexer->text + lexer->at, length);
    token->kind = token->as.symbol->keyword ? (TokenKind)token->as.symbol->keyword : TOKEN_NAME;
    lexer->at = end;
}

/* ---- numbers ---- */

void lexer_report_unit(Lexer *lexer, uint32_t begin, uint32_t end)
{
    const char *names[COUNT_OF(unit_table)];
    for (size_t i = 0; i < COUNT_OF(unit_table); i++) names[i] = unit_table[i].name;
    const char *wrong = arena_copy_text(lexer->diag->arena, lexer->text + begin, end - begin);
    Diagnostic *report =
        diag_report(lexer->diag, D_UNKNOWN_UNIT, (Span){lexer->source, begin, end}, "unknown unit '%s'", wrong);
    uint32_t number = begin;
    while (number > 0 && (class_of(lexer->text[number - 1]) == CLASS_DIGIT || lexer->text[number - 1] == '.')) number--;
    bool hexadecimal = begin == number + 1 && lexer->text[number] == '0' && (wrong[0] == 'x' || wrong[0] == 'X');
    bool two = wrong[0] == 'x' && wrong[1] && !wrong[1 + strspn(wrong + 1, "0123456789")]; /* 640x480 */
    if (hexadecimal)
        diag_hint(lexer->diag, report, "numbers are decimal; a colour is #rrggbb");
    else if (two)
        diag_hint(lexer->diag, report, "two numbers are a vector: <%.*s, %s>", (int)(begin - number),
                  lexer->text + number, wrong + 1);
    else if (wrong[0] == '_' && !wrong[strspn(wrong, "_0123456789")]) /* 1_000_000 */
        diag_hint(lexer->diag, report, "the digits of a number stand together, or write it as 1e6");
    else if (habit_is_one_of("min mins minute minutes h hr hour hours", wrong))
        diag_hint(lexer->diag, report, "write a number of seconds: 10 * 60s");
    else if (habit_is_one_of("W mW kW watt watts lm lumen cd", wrong))
        diag_hint(lexer->diag, report, "power is in watts, and radiance in W/(m^2 sr), without a unit");
    else if (strcmp(wrong, "\xc2\xb5m") == 0 || strcmp(wrong, "\xce\xbcm") == 0) /* the sign, and the letter */
        diag_hint(lexer->diag, report, "write: %.*sum", (int)(begin - number), lexer->text + number);
    else if (habit_unit(wrong))
        diag_hint(lexer->diag, report, "write '%s'", habit_unit(wrong));
    else if (!habit_is_one_of("kg g mg t lb oz", wrong)) /* of another kind than any that is like it */
        diag_suggest(lexer->diag, report, wrong, names, COUNT_OF(names));
    bool letter = !wrong[1] && !strchr("efEF", wrong[0]); /* 2r, as it is written on paper; 2e, 2f are of other kinds */
    if (!report->hint && letter)
        diag_hint(lexer->diag, report, "the units are %s; a product is written %.*s * %s",
                  unit_list(lexer->diag->arena, UNIT_ANY), (int)(begin - number), lexer->text + number, wrong);
    if (!report->hint) diag_hint(lexer->diag, report, "the units are %s", unit_list(lexer->diag->arena, UNIT_ANY));
}

static void read_number(Lexer *lexer, Token *token)
{
    uint32_t begin = lexer->at;
    token->kind = TOKEN_NUMBER;
    lexer->at += (uint32_t)num_parse(lexer->text + begin, lexer->length - begin, &token->number);
    if (isinf(token->number)) {
        lex_error_at(lexer, D_INVALID_NUMBER, begin, lexer->at, "this number is too large");
        token->number = 0;
        token->bad = true;
    }
    uint32_t unit_begin = lexer->at, unit_end = name_end(lexer, unit_begin);
    if (unit_end > unit_begin) {
        token->unit = unit_of(lexer->text + unit_begin, unit_end - unit_begin);
        if (!token->unit) {
            lexer_report_unit(lexer, unit_begin, unit_end);
            token->bad = true;
        }
        lexer->at = unit_end;
    } else if (lexer->text[unit_begin] == '.' && class_of(lexer->text[unit_begin + 1]) == CLASS_DIGIT) {
        double rest;
        lexer->at += (uint32_t)num_parse(lexer->text + unit_begin, lexer->length - unit_begin, &rest);
        lex_error_at(lexer, D_INVALID_NUMBER, begin, lexer->at, "this number has two points");
        token->bad = true;
    }
}

bool lexer_plain_number(Lexer *lexer, double *number, const UnitType **unit)
{
    const char *p = lexer->text + lexer->at;
    char first = p[*p == '-' || *p == '+'];
    if (class_of(first) != CLASS_DIGIT && first != '.') return false;
    size_t n = num_parse(p, lexer->length - lexer->at, number);
    if (n == 0 || isinf(*number)) return false;
    *unit = NULL;
    unsigned class = class_of(p[n]);
    if (class == CLASS_LETTER || class == CLASS_HIGH) {
        size_t length = name_end(lexer, lexer->at + (uint32_t)n) - lexer->at - n;
        *unit = unit_of(p + n, length);
        if (!*unit) return false;
        n += length;
    } else if (p[n] == '.' && p[n + 1] != '.') {
        return false;
    }
    lexer->at += (uint32_t)n;
    return true;
}

/* ---- strings and colours ---- */

/* Decodes the escape at *at (behind the backslash); false after a report. */
static bool read_escape(Lexer *lexer, uint32_t *at, Buf *out)
{
    uint32_t begin = *at - 1;
    char c = lexer->text[(*at)++];
    if (c == '"' || c == '\\') {
        buf_add_bytes(out, &c, 1);
        return true;
    }
    if (c == 'n' || c == 't') {
        buf_add(out, c == 'n' ? "\n" : "\t");
        return true;
    }
    if (c == 'u' && lexer->text[*at] == '{') {
        uint32_t code = 0, digits = 0;
        int value;
        for (++*at; (value = hex_value(lexer->text[*at])) >= 0; ++*at, digits++)
            if (code <= 0x10ffff) code = code * 16 + (uint32_t)value;
        bool closed = lexer->text[*at] == '}';
        if (closed) ++*at;
        if (closed && digits > 0 && code > 0 && code <= 0x10ffff && !(code >= 0xd800 && code <= 0xdfff)) {
            char bytes[4];
            buf_add_bytes(out, bytes, utf8_encode(code, bytes));
            return true;
        }
        lex_error_at(lexer, D_INVALID_ESCAPE, begin, *at, "this is no code point; write \\u{1F378}");
        return false;
    }
    if (c == '\n' || *at > lexer->length)
        --*at; /* the string itself is not closed: that is reported */
    else
        diag_hint(lexer->diag,
                  lex_error_at(lexer, D_INVALID_ESCAPE, begin, *at,
                               "unknown escape; the escapes are \\\" \\\\ \\n \\t \\u{...}"),
                  "write '/' between the folders of a path, and \\\\ for a '\\'");
    return false;
}

static void read_string(Lexer *lexer, Token *token)
{
    uint32_t begin = lexer->at, at = begin + 1;
    Buf value = {0};
    bool bad = false;
    token->kind = TOKEN_STRING;
    while (lexer->text[at] != '"') {
        char c = lexer->text[at];
        if (c == '\n' || (c == 0 && at >= lexer->length)) {
            lex_error_at(lexer, D_UNTERMINATED_STRING, begin, at, "this string is not closed on its line");
            bad = true;
            break;
        }
        if (c == '\\') {
            at++;
            bad |= !read_escape(lexer, &at, &value);
            continue;
        }
        uint32_t code;
        uint32_t n = (uint32_t)utf8_decode(lexer->text + at, lexer->length - at, &code);
        if (code == UTF8_INVALID || code == 0) {
            if (!bad) report_byte(lexer, at, at + 1);
            bad = true;
        } else if (value.length <= LIMIT_STRING_BYTES) { /* the rest is only looked through */
            buf_add_bytes(&value, lexer->text + at, n);
        }
        at += n;
    }
    if (lexer->text[at] == '"') at++;
    if (value.length > LIMIT_STRING_BYTES && !bad) {
        Diagnostic *report = diag_report(lexer->diag, D_LIMIT, (Span){lexer->source, begin, begin + 1},
                                         "this string has %u bytes; the limit is %d", at - begin, LIMIT_STRING_BYTES);
        limit_hint(lexer->diag, report, OVER_STRING_BYTES);
        bad = true;
    }
    token->as.text = bad ? "" : arena_copy_text(lexer->diag->arena, buf_text(&value), value.length);
    token->bad = bad || value.failed;
    buf_clear(&value);
    lexer->at = at;
}

/* A '#' in front of a word that POV-Ray knows, or in front of a comment of other languages. */
static bool read_directive(Lexer *lexer, Token *token)
{
    uint32_t begin = lexer->at, end = name_end(lexer, begin + 1);
    if (habit_directive(lexer->text + begin + 1, end - begin - 1) == DIRECTIVE_NONE) return false;
    token->kind = TOKEN_DIRECTIVE;
    lexer->at = end;
    return true;
}

static void read_color(Lexer *lexer, Token *token)
{
    uint32_t begin = lexer->at, end = name_end(lexer, begin + 1);
    while (class_of(lexer->text[end]) == CLASS_DIGIT || name_end(lexer, end) > end) end = end + 1;
    token->kind = TOKEN_COLOR;
    uint32_t digits = end - begin - 1, rgb = 0;
    bool hexadecimal = true;
    for (uint32_t at = begin + 1; at < end; at++) {
        int value = hex_value(lexer->text[at]);
        hexadecimal &= value >= 0;
        rgb = rgb << 4 | ((uint32_t)value & 0xf);
        if (digits == 3) rgb = rgb << 4 | ((uint32_t)value & 0xf);
    }
    if (!hexadecimal || (digits != 3 && digits != 6)) {
        lex_error_at(lexer, D_INVALID_COLOR, begin, end, "a colour is '#' with 3 or 6 hexadecimal digits");
        token->bad = true;
        rgb = 0;
    }
    token->as.rgb = rgb;
    lexer->at = end;
}

/* ---- the rest ---- */

/* Blanks that are none here, and characters that cannot be seen: texts from the web and from word processors are full
 * of them, so that they are one mistake of their file. */
static bool skip_foreign_blank(Lexer *lexer, uint32_t code, uint32_t n)
{
    static const struct {
        uint32_t first, last;
        const char *name;
        bool blank;
    } rows[] = {{0xa0, 0xa0, "a no-break space", true},      {0xad, 0xad, "a soft hyphen", false},
                {0x2000, 0x200a, "a printer's space", true}, {0x200b, 0x200f, "a mark without width", false},
                {0x2028, 0x2029, "a line separator", true},  {0x202f, 0x202f, "a narrow no-break space", true},
                {0x205f, 0x205f, "a printer's space", true}, {0x2060, 0x2060, "a mark without width", false},
                {0x3000, 0x3000, "a wide space", true},      {0xfeff, 0xfeff, "a byte order mark", false}};
    size_t row = 0;
    while (row < COUNT_OF(rows) && (code < rows[row].first || code > rows[row].last)) row++;
    if (row == COUNT_OF(rows)) return false;
    const char *p = lexer->text + lexer->at;
    if (!lexer->has_foreign_blank) {
        size_t others = 0;
        for (const char *at = p + n; at + n <= lexer->text + lexer->length; at++) others += memcmp(at, p, n) == 0;
        Diagnostic *report =
            diag_report(lexer->diag, D_INVALID_CHARACTER, (Span){lexer->source, lexer->at, lexer->at + n},
                        "U+%04X, %s, has no meaning here", (unsigned)code, rows[row].name);
        const char *cure = rows[row].blank ? "write a plain blank" : "leave it out";
        if (others)
            diag_hint(lexer->diag, report, "%s, here and in %zu other place%s", cure, others, others == 1 ? "" : "s");
        else
            diag_hint(lexer->diag, report, "%s", cure);
    }
    lexer->has_foreign_blank = true;
    lexer->at += n;
    return true;
}

/* A run of characters that mean nothing is one mistake. */
static void skip_unknown(Lexer *lexer)
{
    uint32_t begin = lexer->at, code;
    uint32_t n = (uint32_t)utf8_decode(lexer->text + begin, lexer->length - begin, &code);
    Span span = {lexer->source, begin, begin + n};
    if (skip_foreign_blank(lexer, code, n)) return;
    lexer->at += n;
    if (code == UTF8_INVALID) {
        while (lexer->at < lexer->length && utf8_decode(lexer->text + lexer->at, lexer->length - lexer->at, &code) &&
               code == UTF8_INVALID)
            lexer->at++;
        report_byte(lexer, span.begin, span.end);
        return;
    }
    const char *shown = arena_copy_text(lexer->diag->arena, lexer->text + begin, n);
    Diagnostic *report;
    if (code < 0x20 || code == 0x7f)
        report = diag_report(lexer->diag, D_INVALID_CHARACTER, span, "control character U+%04X", (unsigned)code);
    else
        report = diag_report(lexer->diag, D_INVALID_CHARACTER, span, "'%s' has no meaning here", shown);
    if (code == 0x201c || code == 0x201d || code == '\'') diag_hint(lexer->diag, report, "strings stand in '\"'");
    if (code == 0xb0) diag_hint(lexer->diag, report, "write 'deg'");
    const char *name = lexer->text + begin + 1;
    if (code == '$' && class_of(*name) == CLASS_LETTER) {
        bool facets = name[0] == 'f' && name[1] && strchr("nas", name[1]); /* $fn, $fa, $fs of OpenSCAD */
        diag_hint(lexer->diag, report,
                  facets ? "leave it out: what is round is exactly so, or as fine as 'tolerance' says"
                         : "names have no mark before them");
    }
    if (code == 0xb2 || code == 0xb3) diag_hint(lexer->diag, report, "write '^ %c'", code == 0xb2 ? '2' : '3');
    while (code != 0 && lexer->at + n <= lexer->length && memcmp(lexer->text + lexer->at, shown, n) == 0)
        lexer->at += n;
}

/* "# text": a comment in other languages */
static bool skip_hash_comment(Lexer *lexer)
{
    uint32_t begin = lexer->at;
    if (class_of(lexer->text[begin + 1]) != CLASS_BLANK && lexer->text[begin + 1] != '!') return false;
    Diagnostic *report = lex_error_at(lexer, D_INVALID_CHARACTER, begin, begin + 1, "'#' begins no comment");
    diag_hint(lexer->diag, report, "comments begin with '//'");
    const char *end = memchr(lexer->text + begin, '\n', lexer->length - begin);
    lexer->at = end ? (uint32_t)(end - lexer->text) : lexer->length;
    return true;
}

enum { LONGEST_FOREIGN_STRING = 80 };

/* 'text' and the quotes of word processors: a string, with a report */
static bool read_foreign_string(Lexer *lexer, Token *token)
{
    const char *p = lexer->text + lexer->at;
    static const struct {
        const char *open, *close;
    } quotes[] = {{"'", "'"},
                  {"\xe2\x80\x9c", "\xe2\x80\x9d"},
                  {"\xe2\x80\x98", "\xe2\x80\x99"},
                  {"\xe2\x80\x9e", "\xe2\x80\x9c"},
                  {"\xc2\xab", "\xc2\xbb"},
                  {"`", "`"}};
    for (size_t i = 0; i < COUNT_OF(quotes); i++) {
        size_t n = strlen(quotes[i].open);
        if (strncmp(p, quotes[i].open, n) != 0) continue;
        size_t length = 0, n_close = strlen(quotes[i].close);
        while (p[n + length] && p[n + length] != '\n' && strncmp(p + n + length, quotes[i].close, n_close) != 0)
            if (++length > LONGEST_FOREIGN_STRING) return false;
        if (p[n + length] == 0 || p[n + length] == '\n') return false;
        uint32_t begin = lexer->at;
        lexer->at += (uint32_t)(n + length + n_close);
        Diagnostic *report =
            lex_error_at(lexer, D_INVALID_CHARACTER, begin, lexer->at, "these quotes have no meaning here");
        diag_hint(lexer->diag, report, "write: \"%s\"", arena_copy_text(lexer->diag->arena, p + n, length));
        *token = (Token){.kind = TOKEN_STRING, .bad = true, .begin = begin, .as.text = ""};
        return true;
    }
    return false;
}

static TokenKind punctuation(const char *p, uint32_t *n)
{
    *n = 1;
    switch (p[0]) {
    case '{': return TOKEN_BRACE_OPEN;
    case '}': return TOKEN_BRACE_CLOSE;
    case '(': return TOKEN_PAREN_OPEN;
    case ')': return TOKEN_PAREN_CLOSE;
    case '[': return TOKEN_BRACKET_OPEN;
    case ']': return TOKEN_BRACKET_CLOSE;
    case ';': return TOKEN_SEMICOLON;
    case ',': return TOKEN_COMMA;
    case '?': return TOKEN_QUESTION;
    case '+': return TOKEN_PLUS;
    case '-': return TOKEN_MINUS;
    case '*': return TOKEN_STAR;
    case '/': return TOKEN_SLASH;
    case '%': return TOKEN_PERCENT;
    case '^': return TOKEN_CARET;
    case '<': *n += p[1] == '='; return p[1] == '=' ? TOKEN_LESS_EQUAL : TOKEN_LESS;
    case '>': *n += p[1] == '='; return p[1] == '=' ? TOKEN_GREATER_EQUAL : TOKEN_GREATER;
    case '=': *n += p[1] == '='; return p[1] == '=' ? TOKEN_EQUAL : TOKEN_ASSIGN;
    case ':': *n += p[1] == '='; return p[1] == '=' ? TOKEN_CHANGE : TOKEN_COLON;
    case '!': *n = 2; return p[1] == '=' ? TOKEN_NOT_EQUAL : TOKEN_END;
    case '.':
        if (p[1] != '.') return TOKEN_DOT;
        *n = p[2] == '<' ? 3 : 2;
        return p[2] == '<' ? TOKEN_RANGE_OPEN : TOKEN_RANGE;
    default: return TOKEN_END;
    }
}

/* &&, ×, ≤ and the like go on as what they mean */
static bool read_foreign_operator(Lexer *lexer, Token *token)
{
    static const struct {
        const char *text;
        TokenKind kind;
    } operators[] = {{"&&", TOKEN_AND},
                     {"||", TOKEN_OR},
                     {"&", TOKEN_AND},
                     {"|", TOKEN_OR},
                     {"!", TOKEN_NOT},
                     {"\xc3\x97", TOKEN_STAR},
                     {"\xc2\xb7", TOKEN_STAR},
                     {"\xc3\xb7", TOKEN_SLASH},
                     {"\xe2\x80\x90", TOKEN_MINUS}, /* U+2010 to U+2015: hyphens and dashes */
                     {"\xe2\x80\x91", TOKEN_MINUS},
                     {"\xe2\x80\x92", TOKEN_MINUS},
                     {"\xe2\x80\x93", TOKEN_MINUS},
                     {"\xe2\x80\x94", TOKEN_MINUS},
                     {"\xe2\x80\x95", TOKEN_MINUS},
                     {"\xe2\x88\x92", TOKEN_MINUS},
                     {"\xe2\x89\xa4", TOKEN_LESS_EQUAL},
                     {"\xe2\x89\xa5", TOKEN_GREATER_EQUAL},
                     {"\xe2\x89\xa0", TOKEN_NOT_EQUAL},
                     {"\xe2\x80\xa6", TOKEN_RANGE},
                     {"=>", TOKEN_ASSIGN}};                          /* no expression begins with a '>' */
    enum { FIRST_WIDE = 0xff01, LAST_WIDE = 0xff5e, WIDE = 0xfee0 }; /* ASCII for lines of Chinese */
    const char *p = lexer->text + lexer->at;
    uint32_t n = 0, plain, code;
    for (size_t i = 0; i < COUNT_OF(operators) && n == 0; i++) {
        token->kind = operators[i].kind;
        size_t length = strlen(operators[i].text);
        if (strncmp(p, operators[i].text, length) == 0) n = (uint32_t)length;
    }
    if (n == 0) {
        n = (uint32_t)utf8_decode(p, lexer->length - lexer->at, &code);
        const char ascii[2] = {code >= FIRST_WIDE && code <= LAST_WIDE ? (char)(code - WIDE) : 0, 0};
        token->kind = *ascii ? punctuation(ascii, &plain) : TOKEN_END;
    }
    if (token->kind == TOKEN_END) return false;
    Diagnostic *report = diag_report(lexer->diag, D_INVALID_CHARACTER, (Span){lexer->source, lexer->at, lexer->at + n},
                                     "'%.*s' has no meaning here", (int)n, p);
    if (token->kind == TOKEN_ASSIGN && *p == '=')
        diag_hint(lexer->diag, report, "write '=', or '>=' to compare; a function is def f(x) = ...");
    else
        diag_hint(lexer->diag, report, "write %s", token_text(token->kind));
    lexer->at += n;
    return true;
}

Token lexer_next(Lexer *lexer)
{
    Token token = {.kind = TOKEN_END};
    lexer->previous_end = lexer->last_end;
    for (;;) {
        lexer_skip_blanks(lexer);
        token.begin = lexer->at;
        if (lexer->at >= lexer->length) break;
        const char *p = lexer->text + lexer->at;
        unsigned class = class_of(*p);
        if (class == CLASS_LETTER || (class == CLASS_HIGH && name_end(lexer, lexer->at) > lexer->at)) {
            read_name(lexer, &token);
            break;
        }
        if (class == CLASS_DIGIT || (*p == '.' && class_of(p[1]) == CLASS_DIGIT)) {
            read_number(lexer, &token);
            break;
        }
        if (*p == '"') {
            read_string(lexer, &token);
            break;
        }
        if (*p == '#') {
            if (skip_hash_comment(lexer)) continue;
            if (!read_directive(lexer, &token)) read_color(lexer, &token);
            break;
        }
        uint32_t n;
        token.kind = punctuation(p, &n);
        if (token.kind != TOKEN_END && !(p[0] == '=' && p[1] == '>')) {
            lexer->at += n;
            break;
        }
        if (read_foreign_operator(lexer, &token) || read_foreign_string(lexer, &token)) break;
        skip_unknown(lexer);
    }
    token.end = lexer->at;
    lexer->last_end = token.kind == TOKEN_END ? lexer->last_end : token.end;
    return token;
}

/* lex.h - from text to tokens, one at a time, with no copy of the text.
 * A mistake in a token is reported here, once; the token is marked bad, and what is built from it stays silent.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LEX_H
#define MEN_LEX_H

#include "diag/diag.h"
#include "lang/schema.h"
#include "lang/symbol.h"

typedef enum TokenKind {
#define TOKEN(name, text) TOKEN_##name,
#define KEYWORD(name, word, example) TOKEN_##name,
#include "lang/token.def"
#undef TOKEN
#undef KEYWORD
    TOKEN_COUNT
} TokenKind;

/* A unit of the language: what it measures, and its size in metres, degrees, seconds or kelvin, which is count times a
 * power of ten. */
typedef struct UnitType {
    const char *name;
    PropUnit measure;
    double size;
    const char *count; /* as digits; NULL: 1 */
    int power;
} UnitType;

typedef struct Token {
    TokenKind kind;
    bool bad;             /* its mistake has been reported */
    uint32_t begin, end;  /* bytes of the source */
    double number;        /* TOKEN_NUMBER as written, before its unit */
    const UnitType *unit; /* NULL when there is none */
    union {
        Symbol *symbol;   /* TOKEN_NAME and keywords */
        const char *text; /* TOKEN_STRING */
        uint32_t rgb;     /* TOKEN_COLOR, 0xrrggbb */
    } as;
} Token;

typedef struct Lexer {
    Diag *diag;
    SymbolTable *symbols;
    uint32_t source;
    const char *text; /* a 0 byte stands at text[length] */
    uint32_t length, at;
    uint32_t previous_end; /* where the token before the last one read ends */
    uint32_t last_end;
    bool has_foreign_blank; /* one has been reported */
} Lexer;

void lexer_init(Lexer *lexer, Diag *diag, SymbolTable *symbols, uint32_t source);
/* Whether a name may have it, beyond ASCII. */
bool lexer_is_letter(uint32_t code);
/* The next token; TOKEN_END for ever at the end. */
Token lexer_next(Lexer *lexer);

/* For the parser's short way through lists of plain numbers: */
void lexer_skip_blanks(Lexer *lexer);
/* Reads [-+] number [unit] at the present byte, moves behind it and returns true; else stays and returns false,
 * with nothing reported. */
bool lexer_plain_number(Lexer *lexer, double *number, const UnitType **unit);

/* Says of what stands from begin up to end, behind a number, that it is no unit. */
void lexer_report_unit(Lexer *lexer, uint32_t begin, uint32_t end);

const UnitType *unit_of(const char *text, size_t length); /* NULL when there is no such unit */
const UnitType *unit_at(size_t index);                    /* NULL behind the last */
/* The number at the start of text, which is of that unit, in metres per scene unit of unit_m (lengths), degrees, seconds or
 * kelvin: the double that is nearest to it. */
double unit_value(const char *text, size_t length, const UnitType *unit, double unit_m);
const char *unit_list(Arena *arena, PropUnit measure); /* "nm um mm ..."; UNIT_ANY: all */
const char *unit_of_length(double size_m);             /* "mm" for .001; NULL when there is none */
const char *token_text(TokenKind kind);                /* "'{'", "a name", "'while'" */
/* The words that are no names, by their number; NULL beyond the last. */
typedef struct KeywordType {
    const char *word, *example;
} KeywordType;
const KeywordType *keyword_at(size_t index);
const char *unit_measure_text(PropUnit measure); /* "a length" */
/* What the numbers of a scene are in whose unit is unit_m, as "cm" or "deg"; NULL: nothing says so. */
const char *unit_of_measure(PropUnit measure, double unit_m);
/* A value as text with the unit behind each number, as -D takes it: "<10mm, 2mm>", "5mm..60mm". NULL: without. */
void unit_add_behind_numbers(Buf *out, const char *text, const char *unit);

#endif

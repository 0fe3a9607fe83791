/* symbol.c - the hash table of names.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/symbol.h"

#include <string.h>

#include "lang/lex.h"

enum { FIRST_BUCKETS = 1024 };

static uint32_t hash_of(const char *text, size_t length)
{
    uint32_t h = 0x811c9dc5U; /* FNV-1a, 32 bits */
    for (size_t i = 0; i < length; i++) h = (h ^ (unsigned char)text[i]) * 0x01000193U;
    return h ^ h >> 15;
}

static void grow(SymbolTable *table)
{
    uint32_t n = table->n_buckets * 4;
    Symbol **buckets = ARENA_ARRAY(table->arena, Symbol *, n);
    for (uint32_t i = 0; i < table->n_buckets; i++)
        for (Symbol *symbol = table->buckets[i]; symbol;) {
            Symbol *next = symbol->next_in_bucket;
            symbol->next_in_bucket = buckets[symbol->hash & (n - 1)];
            buckets[symbol->hash & (n - 1)] = symbol;
            symbol = next;
        }
    table->buckets = buckets;
    table->n_buckets = n;
}

Symbol *symbol_of(SymbolTable *table, const char *text, size_t length)
{
    uint32_t hash = hash_of(text, length);
    for (Symbol *symbol = table->buckets[hash & (table->n_buckets - 1)]; symbol; symbol = symbol->next_in_bucket)
        if (symbol->hash == hash && symbol->length == length && memcmp(symbol->text, text, length) == 0) return symbol;
    if (table->n_symbols > 2 * table->n_buckets) grow(table);
    Symbol *symbol = ARENA_NEW(table->arena, Symbol);
    symbol->hash = hash;
    symbol->length = (uint32_t)length;
    symbol->text = arena_copy_text(table->arena, text, length);
    Symbol **bucket = &table->buckets[hash & (table->n_buckets - 1)];
    symbol->next_in_bucket = *bucket;
    *bucket = symbol;
    table->n_symbols++;
    return symbol;
}

void symbol_table_init(SymbolTable *table, Arena *arena)
{
    static const struct {
        const char *word;
        TokenKind kind;
    } keywords[] = {
#define TOKEN(name, text)
#define KEYWORD(name, word, example) {word, TOKEN_##name},
#include "lang/token.def"
#undef TOKEN
#undef KEYWORD
    };
    *table = (SymbolTable){.arena = arena, .n_buckets = FIRST_BUCKETS};
    table->buckets = ARENA_ARRAY(arena, Symbol *, FIRST_BUCKETS);
    for (size_t i = 0; i < COUNT_OF(keywords); i++)
        symbol_of(table, keywords[i].word, strlen(keywords[i].word))->keyword = (int)keywords[i].kind;
}

/* symbol.h - names made unique, so that two names are equal when their pointers are.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SYMBOL_H
#define MEN_SYMBOL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"

/* What the texts that were read so far declare a name as, somewhere: for hints of the parser, which knows no scopes. */
typedef enum SymbolUse { SYMBOL_FREE, SYMBOL_NODE, SYMBOL_TRANSFORM, SYMBOL_DEF } SymbolUse;

typedef struct Symbol Symbol;
struct Symbol {
    Symbol *next_in_bucket;
    uint32_t hash, length;
    int keyword; /* the TokenKind of a keyword, 0 for a name */
    SymbolUse declared;
    bool is_variable;        /* the same of a var */
    struct Binding *binding; /* the innermost declaration that is visible while names are resolved */
    const char *text;
    struct Diagnostic *unknown; /* the report that nothing of that name is visible, and how often it was added to */
    uint32_t n_unknown;
    bool sought; /* a report says that it may be meant: that nothing uses it is the same mistake */
};

typedef struct SymbolTable {
    Arena *arena;
    Symbol **buckets;
    uint32_t n_buckets, n_symbols;
} SymbolTable;

/* With the keywords of the language in it. */
void symbol_table_init(SymbolTable *table, Arena *arena);
Symbol *symbol_of(SymbolTable *table, const char *text, size_t length);

#endif

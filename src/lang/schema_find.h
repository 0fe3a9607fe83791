/* schema_find.h - looking up rows of a Schema, and what messages say about them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SCHEMA_FIND_H
#define MEN_SCHEMA_FIND_H

#include "diag/diag.h"
#include "lang/ast.h"
#include "lang/schema.h"

const NodeType *schema_node(const Schema *schema, const char *name);
const PropType *schema_prop(const NodeType *type, const char *name);
const TermType *schema_term(const Schema *schema, const char *name);

/* Is word one of "a|b|c"? */
bool choice_allows(const char *choices, const char *word);
/* "a, b or c" */
const char *choice_text(Arena *arena, const char *choices);

/* "is outside 0..1", or as the ends of a property's range have it, of a number that is */
const char *schema_bounds_text(Arena *arena, const PropType *type);
/* "a number", "the name of a function ...": what a property takes */
const char *prop_kind_text(Arena *arena, const PropType *type);
/* Reports an unknown property with the nearest one, and with the value (may be NULL) that this takes where another word is
 * one for it. by_set: --set names it, which takes no transforms. */
void report_unknown_property(Diag *diag, Span span, const NodeType *type, const char *name, const Expr *value,
                             bool by_set);

/* "sphere" -> "a sphere", "environment" -> "an environment" */
const char *with_article(Arena *arena, const char *name);

#endif

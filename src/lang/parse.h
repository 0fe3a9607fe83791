/* parse.h - from tokens to the tree of a file.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PARSE_H
#define MEN_PARSE_H

#include "lang/ast.h"

/* Parses a source with its header (or without: the prelude) into file, whose source is set. Mistakes go to diag;
 * what was wrong is left out of the tree or is EXPR_POISON in it. unit_m: metres per scene unit for the literals;
 * <= 0: what the header says (1 when it says nothing). */
void parse_file(File *file, bool has_header, double unit_m, Diag *diag, SymbolTable *symbols);

/* Parses an expression that makes up a whole source ("-D"). */
Expr *parse_expression(uint32_t source, double unit_m, Diag *diag, SymbolTable *symbols);

#endif

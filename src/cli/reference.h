/* reference.h - the nodes of the scene language, their properties, its functions, and the diagnostics, for help and the
 * manual.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_REFERENCE_H
#define MEN_REFERENCE_H

#include "base/buf.h"
#include "diag/diag.h"
#include "lang/builtin.h"
#include "lang/schema.h"

/* "number, a length, above 0" */
void reference_print_type(const PropType *type, Buf *out);
/* NULL when there is no node of that name. */
const NodeType *reference_node(const char *name);
/* NULL when there is no term of that name. */
const TermType *reference_term(const char *name);
/* D_COUNT when there is no diagnostic of that code. */
DiagCode reference_diagnostic(const char *slug);
/* As plain text, for help. */
void reference_print_node(const NodeType *node, Buf *out);
/* A property's name, whatever the node; and what each node that has it says of it. */
bool reference_is_property(const char *name);
void reference_print_property(const char *name, Buf *out);
/* What that node says of it; false: it has none of that name. */
bool reference_print_property_of(const NodeType *node, const char *name, Buf *out);
void reference_print_diagnostic(DiagCode code, Buf *out);
void reference_print_function(const Builtin *function, Buf *out);
void reference_print_term(const TermType *term, Buf *out);

#endif

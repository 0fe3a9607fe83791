/* library_doc.h - what the standard library offers, read from the comments of its texts, for help and the manual.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIBRARY_DOC_H
#define MEN_LIBRARY_DOC_H

#include "base/buf.h"
#include "lang/eval.h"

/* The text of that name, "std/glassware" or "std/glassware.mns"; NULL when there is none. */
const EvalLibraryFile *library_named(const char *topic);
/* As plain text: the list of all texts, and what one of them has. */
void library_print_overview(Buf *out);
void library_print_file(const EvalLibraryFile *file, Buf *out);
/* What texts have under a name, as acrylic or media.acrylic; nothing where none has it. */
void library_print_named(const char *topic, Buf *out);
/* All of them in the language of manual pages. */
void library_print_manual(Buf *out);

#endif

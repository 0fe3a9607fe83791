/* format.h - a scene text laid out in one way: indentation, blanks, blank lines.
 * Line breaks are the author's, and so are comments; tokens are copied as they are written. What is left out are
 * semicolons, which mean nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FORMAT_H
#define MEN_FORMAT_H

#include "base/status.h"
#include "diag/diag.h"

/* Appends the text laid out to *out. Formatting what was formatted changes nothing, and both texts have the same
 * tokens and comments. STATUS_SCENE with reports in diag (and nothing appended) when the text is not in the language.
 * name: for the reports. Memory is the arena's of diag, which must be guarded by the caller. */
ATTR_NODISCARD Status format_text(const char *name, const char *text, size_t length, Diag *diag, Buf *out,
                                  Error *error);

#endif

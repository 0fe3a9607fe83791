/* bare_text.h - texts without their quotes as values of -D and --set: shells take quotes away.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BARE_TEXT_H
#define MEN_BARE_TEXT_H

#include "lang/evaluator.h"

/* Where the value of a parameter or a property that is a text was found wrong, and has no quotes: says so in place of what
 * was reported of it as an expression. */
void bare_text_of_define(Diag *diag, const File *scene, const Define *define);
void bare_text_of_override(Diag *diag, const Schema *schema, const Override *override);

#endif

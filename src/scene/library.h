/* library.h - the standard library: the texts of src/std, built into the program.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIBRARY_H
#define MEN_LIBRARY_H

#include "lang/eval.h"

/* In order of their names; made from the files of src/std by src/std/embed.sh at build time. */
extern const EvalLibrary std_library;

#endif

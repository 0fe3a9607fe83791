/* flat.h - an evaluated scene as text again: no names but those of nodes and of
 * functions that properties take, no macros, loops or includes.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FLAT_H
#define MEN_FLAT_H

#include "lang/eval.h"

typedef struct FlatOptions {
    const EvalOptions *eval; /* that the scene was evaluated with */
    const SourceSet *sources;
    const char *const
        *files; /* properties that name files to read, which are written with their whole path; ends with NULL */
} FlatOptions;

/* Appends the scene. It is a scene itself, and builds to the same: numbers are written so that they read back as the
 * same double, nodes that share something still do. Files that are not found are reported to diag. Memory is its
 * arena's, which must be guarded by the caller. STATUS_SCENE after reports. */
ATTR_NODISCARD Status flat_print(const EvalResult *scene, const FlatOptions *options, Diag *diag, Buf *out,
                                 Error *error);

#endif

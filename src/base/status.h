/* status.h - how functions report that something outside the program went wrong.
 * A function that can fail returns a Status and fills the caller's Error with one line of text:
 *     return fail(error, STATUS_INPUT, "cannot read '%s': %s", path, strerror(errno));
 * Mistakes in a scene's text go to the diagnostics sink (diag/diag.h) instead, because they have
 * a place and there can be many of them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_STATUS_H
#define MEN_STATUS_H

#include <stddef.h>

#include "base/attr.h"

typedef enum Status {
#define STATUS(name, exit_status, text) STATUS_##name,
#include "base/status.def"
#undef STATUS
} Status;

/* What went wrong, for a person. Lower case, no full stop, names the thing and the value. */
typedef struct Error {
    Status status;
    char text[1024];
} Error;

/* The exit status of the program for a status (0 1 2 3 4 5 75). */
int status_exit_code(Status status);
/* A short text for a status that came without an Error. */
const char *status_text(Status status);

/* Fills *error (which may be NULL) and returns status, so that a failure is one line. */
Status fail(Error *error, Status status, const char *format, ...) ATTR_PRINTF(3, 4);
/* The same for memory: says how much was wanted and what for. */
Status fail_memory(Error *error, size_t bytes, const char *what);

/* Returns the status of expr from the calling function unless it is STATUS_OK. The only macro
 * here that hides a return. */
#define TRY(expr)                                                                                                      \
    do {                                                                                                               \
        Status try_status_ = (expr);                                                                                   \
        if (try_status_ != STATUS_OK) return try_status_;                                                              \
    } while (0)

#endif

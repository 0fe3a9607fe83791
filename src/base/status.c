/* status.c - the table of status codes and the one-line failure report.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>

static const struct {
    int exit_code;
    const char *text;
} status_table[] = {
#define STATUS(name, exit_status, text) {exit_status, text},
#include "base/status.def"
#undef STATUS
};

int status_exit_code(Status status)
{
    return status_table[status].exit_code;
}

const char *status_text(Status status)
{
    return status_table[status].text;
}

Status fail(Error *error, Status status, const char *format, ...)
{
    if (error) {
        error->status = status;
        va_list args;
        va_start(args, format);
        vsnprintf(error->text, sizeof error->text, format, args);
        va_end(args);
    }
    return status;
}

Status fail_memory(Error *error, size_t bytes, const char *what)
{
    return fail(error, STATUS_NOMEM, "out of memory: %zu bytes for %s", bytes, what);
}

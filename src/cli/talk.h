/* talk.h - what the program says: messages on standard error, data on standard output.
 * Everything that people read goes through here, as text or, with --log-format json, as one JSON object per line.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TALK_H
#define MEN_TALK_H

#include "base/buf.h"
#include "base/json.h"
#include "cli/options.h"

typedef struct Talk {
    const char *command; /* for the front of messages; NULL before it is known */
    bool json, color, quiet, verbose;
} Talk;

/* The options may be NULL: then as with none. */
void talk_init(Talk *talk, const Options *options);
void talk_error(const Talk *talk, const Error *error);
void talk_hint(const Talk *talk, const char *format, ...) ATTR_PRINTF(2, 3);
void talk_warning(const Talk *talk, const char *format, ...) ATTR_PRINTF(2, 3);
void talk_remark(const Talk *talk, const char *format, ...) ATTR_PRINTF(2, 3); /* not with -q */
void talk_note(const Talk *talk, const char *format, ...) ATTR_PRINTF(2, 3);   /* only with -v */
/* A plain line, or an event with a message. */
void talk_event(const Talk *talk, const char *event, const char *format, ...) ATTR_PRINTF(3, 4);
/* Writes a text that is complete to standard error at once; memory that ran out in between is said, too. */
void talk_write(const Buf *text);
/* How many lines were written so, since the program began. */
uint64_t talk_lines(void);
/* With --log-format json: begins and ends a line {"event": ..., ...}. */
JsonWriter talk_event_begin(Buf *line, const char *event);
void talk_event_end(JsonWriter *json);

/* A whole text to standard output, flushed. STATUS_OUTPUT, STATUS_NOMEM when the text is not complete. */
ATTR_NODISCARD Status print_out(const Buf *text, Error *error);

/* Standard error is a terminal that understands cursor movements. */
bool terminal_is_capable(void);
/* Columns of the terminal on standard error, 80 when not known. */
unsigned terminal_columns(void);
/* What a noun ends with behind a number: "", or "s". */
const char *plural(uint64_t n);
/* A path as it can be typed after a command. */
void add_for_shell(Buf *line, const char *path);
/* "12.3 s", "2m05s", "1h02m" */
void seconds_print(double seconds, char text[32]);

#endif

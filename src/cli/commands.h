/* commands.h - the commands of the program, a file each. Each returns what became of it; main makes the
 * exit status and the message from that. STATUS_SCENE without a text: the reports were printed.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_COMMANDS_H
#define MEN_COMMANDS_H

#include "cli/talk.h"

ATTR_NODISCARD Status cmd_render(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_check(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_editor(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_dump(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_fmt(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_params(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_merge(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_view(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_compare(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_info(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_import(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_bench(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_completion(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_help(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_manual(const Options *options, const Talk *talk, Error *error);
ATTR_NODISCARD Status cmd_version(const Options *options, const Talk *talk, Error *error);

/* Wraps text (with `...` shown as '...') at 80 columns, each line indented. column: where the first word goes when
 * something stands on its line already. */
void help_wrap(Buf *out, const char *text, size_t indent, size_t column);
/* Help for one command: a line per option and examples, or everything. */
void help_print(Command command, bool full, Buf *out);
/* All options of that name, without their two hyphens, each with the commands that have it; nothing where there is none. */
void help_print_option(const char *name, Buf *out);
/* The list of commands. */
void help_print_overview(Buf *out);

/* Every command, option and exit status as JSON. */
void help_print_json(Buf *out);

#endif

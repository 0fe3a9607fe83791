/* file_reads.h - which files the program has read, as they were then: not to write over them by mistake, and to know when
 * they change. From any thread.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FILE_READS_H
#define MEN_FILE_READS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/stat.h>

#include "base/attr.h"

/* Notes that the file was read, and what it was like, unless it is noted already. False: memory ran out. */
bool file_note_read(const char *path, const struct stat *info) ATTR_NODISCARD;
/* Notes that a file was looked for that is not there. Where memory runs out it is not. */
void file_note_missing(const char *path);
/* Is it a file that file_read has read, under whatever name, since the program began or file_forget_reads? */
bool file_was_read(const char *path);
/* How many were read; the missing ones do not count. */
size_t file_count_reads(void);
/* The path of one of these by its number, in the order in which they were read first; NULL: there are not as many. Good until
 * file_forget_reads. */
const char *file_read_path(size_t number);
/* The path of the first of them that is another file now, larger, newer, or gone; or there at last. NULL: all are as they were.
 * Good until file_forget_reads. */
const char *file_find_changed(void);
/* Notes all of them as they are now. Was any of them another one? */
bool file_renote_reads(void);
/* Those that are noted are those of the future. */
void file_forget_reads(void);

#endif

/* file.h - whole files in, atomic files out. Messages name the path and the system's reason.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FILE_H
#define MEN_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/status.h"

/* STATUS_INPUT, with why: an errno; and where there is no such file the name of one that may be meant. */
Status file_cannot_read(const char *path, int reason, Error *error);
/* Reads a whole file into malloc'd memory with a 0 byte behind it (not counted in *length).
 * path "-" is standard input. STATUS_INPUT when it is missing, a directory, unreadable, or larger
 * than limit bytes (0: no limit). What is read is noted, see file_reads.h. */
ATTR_NODISCARD Status file_read(const char *path, size_t limit, char **bytes, size_t *length, Error *error);

/* Of a text without a newline, in place: every carriage return becomes one, as the first Macintosh, and spreadsheets asked for
 * its kind of text, end lines so. */
void file_end_lines(char *text, size_t length);

/* FILE_OTHER: a pipe, a device or a socket, of which nobody knows whether it ends. */
typedef enum FileKind { FILE_NONE, FILE_REGULAR, FILE_FOLDER, FILE_OTHER } FileKind;

FileKind file_kind(const char *path); /* links are followed */
bool file_exists(const char *path);   /* and is no directory */
/* Do both name one file, however they spell it, or would they, once written? Links are followed. Of pipes and devices only equal
 * spellings do. */
bool file_same(const char *a, const char *b);

/* A file that bears its name only once it is whole: written beside its place under a temporary
 * name, flushed to disk, and renamed by file_commit. */
typedef struct FileOut {
    FILE *stream;
    char *path, *temporary; /* owned */
    bool plain;             /* "-", or a device such as /dev/full: written in place, no rename */
} FileOut;

/* How many names are tried for a temporary file. Each has the number of the process in it: more than the first are needed only
 * where another process of that number was killed and left its files. */
enum { FILE_TEMPORARY_TRIES = 16 };
/* The names of temporary files for a path, the attempts from 0 on, of which the first that is free is used: in its folder, or that of
 * the file that it links to. malloc'd; NULL when memory ends. */
char *file_temporary_name(const char *path, int attempt);
ATTR_NODISCARD Status file_create(FileOut *out, const char *path, Error *error);
/* Flush, sync, close, rename. On failure the temporary file is gone, and what stood under the name
 * before is as it was. STATUS_OUTPUT. */
ATTR_NODISCARD Status file_commit(FileOut *out, Error *error);
/* A whole file so: STATUS_OUTPUT. */
ATTR_NODISCARD Status file_write(const char *path, const void *bytes, size_t length, Error *error);
void file_abandon(FileOut *out); /* close and delete; safe after a failed create or commit */

/* malloc'd folder of path with the trailing '/', "" when it has none; NULL when memory ends */
char *file_folder(const char *path);
/* malloc'd absolute path without symbolic links, "." and ".."; NULL when there is no such file */
char *file_real_path(const char *path);
/* whether there is such a file in the folder ("": the current one) or below, with all links followed */
bool file_lies_in(const char *path, const char *folder);
/* the path without its folder */
const char *file_name(const char *path);
/* the extension without its dot, in the path's own letters; "" when it has none */
const char *file_extension(const char *path);
/* where a number would stand by the ways of C, as "%03d" in "frame%03d.png", or of other programs, "$F3" or "<frame>", and how
 * many bytes that is; NULL: nowhere */
const char *file_number_mark(const char *path, size_t *length);
/* how many bytes of the path stand in front of the extension and its dot */
size_t file_stem_length(const char *path);

#endif

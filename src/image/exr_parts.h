/* exr_parts.h - the bytes behind an EXR file, and opening one; private to src/image/exr*.c. The only file that includes
 * OpenEXR.
 * All reading and writing of bytes goes through our own functions: so a file bears its name only once it is whole,
 * standard input and output work, and every reason comes back as text instead of going to standard error.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EXR_PARTS_H
#define MEN_EXR_PARTS_H

#include <openexr.h>
#include <stdio.h>

#include "image/image.h"

enum { EXR_MAX_SIDE = 65536 }; /* pixels of a picture, each way */

/* The first reason that the library gave for a failure. */
typedef struct ExrReason {
    char text[512];
} ExrReason;

/* The bytes behind a context. */
typedef struct ExrBytes {
    int file;           /* reading a regular file */
    const char *memory; /* reading something else, whole in memory */
    uint64_t size;      /* of what is read */
    FILE *stream;       /* writing */
    uint64_t position;  /* of stream */
    ExrReason reason;
} ExrBytes;

/* A file that is read. */
typedef struct ExrFile {
    const char *path;
    exr_context_t context;
    ExrBytes bytes;
    char *memory; /* owned: what came from a pipe */
} ExrFile;

/* How a context reads and writes those bytes. The thread's errors go to them, until exr_report_to says otherwise. */
exr_context_initializer_t exr_initializer(ExrBytes *bytes);
/* Where the library's errors on this thread go from now on; NULL: nowhere. Returns where they went before. */
ExrReason *exr_report_to(ExrReason *reason);
/* What the library said of the bytes, or what it says of such a failure in general. */
const char *exr_reason(const ExrBytes *bytes, exr_result_t code);
ATTR_NODISCARD Status exr_fail_read(const char *path, const ExrBytes *bytes, exr_result_t code, Error *error);
/* Opens and reads the header; "-" is standard input. exr_file_close(file) in any case. */
ATTR_NODISCARD Status exr_file_open(const char *path, ExrFile *file, Error *error);
void exr_file_close(ExrFile *file);

/* exr_read.c: whether all pixels of the first part are there, as far as the places and sizes of its scan lines or tiles say;
 * of other kinds nothing is known. */
ATTR_NODISCARD Status exr_file_check_whole(const ExrFile *file, Error *error);

#endif

/* exr.c - EXR files, through OpenEXR's C library: the bytes behind them, and opening them for reading.
 * SPDX-License-Identifier: Apache-2.0 */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "image/exr_parts.h"

/* Where this thread's errors go. The library reports on the calling thread, sometimes with the context locked,
 * so that asking the context for its user data would wait for ever. */
static _Thread_local ExrReason *reporting;

ExrReason *exr_report_to(ExrReason *reason)
{
    ExrReason *before = reporting;
    reporting = reason;
    return before;
}

/* The library prefixes "path: (EXR_ERR_NAME) ", which our messages say in their own way. */
static void keep_reason(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    ExrReason *reason = reporting;
    if (!reason || reason->text[0]) return;
    const char *text = message ? message : exr_get_default_error_message(code);
    const char *name = strstr(text, "(EXR_ERR_");
    const char *end = name ? strstr(name, ") ") : NULL;
    snprintf(reason->text, sizeof reason->text, "%s", end ? end + 2 : text);
}

static int64_t read_bytes(exr_const_context_t context, void *user_data, void *buffer, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t report)
{
    ExrBytes *bytes = user_data;
    if (offset > bytes->size) offset = bytes->size;
    if (size > bytes->size - offset) size = bytes->size - offset;
    if (bytes->memory) {
        memcpy(buffer, bytes->memory + offset, (size_t)size);
        return (int64_t)size;
    }
    uint64_t done = 0;
    while (done < size) {
        ssize_t n = pread(bytes->file, (char *)buffer + done, (size_t)(size - done), (off_t)(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) {
            (void)report(context, EXR_ERR_READ_IO, "%s", strerror(errno));
            return -1;
        }
        if (n == 0) break;
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

static int64_t size_of_bytes(exr_const_context_t context, void *user_data)
{
    (void)context;
    const ExrBytes *bytes = user_data;
    return (int64_t)bytes->size;
}

static int64_t write_bytes(exr_const_context_t context, void *user_data, const void *buffer, uint64_t size,
                           uint64_t offset, exr_stream_error_func_ptr_t report)
{
    ExrBytes *bytes = user_data;
    if ((offset != bytes->position && fseeko(bytes->stream, (off_t)offset, SEEK_SET) != 0) ||
        fwrite(buffer, 1, (size_t)size, bytes->stream) != size) {
        (void)report(context, EXR_ERR_WRITE_IO, "%s", strerror(errno));
        return -1;
    }
    bytes->position = offset + size;
    return (int64_t)size;
}

exr_context_initializer_t exr_initializer(ExrBytes *bytes)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.error_handler_fn = keep_reason;
    initializer.user_data = bytes;
    initializer.read_fn = read_bytes;
    initializer.size_fn = size_of_bytes;
    initializer.write_fn = write_bytes;
    initializer.max_image_width = initializer.max_image_height = EXR_MAX_SIDE;
    initializer.max_tile_width = initializer.max_tile_height = EXR_MAX_SIDE;
    /* a file cut short is refused at once, not searched for what is left of it */
    initializer.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_report_to(&bytes->reason);
    return initializer;
}

const char *exr_reason(const ExrBytes *bytes, exr_result_t code)
{
    return bytes->reason.text[0] ? bytes->reason.text : exr_get_default_error_message(code);
}

Status exr_fail_read(const char *path, const ExrBytes *bytes, exr_result_t code, Error *error)
{
    if (code == EXR_ERR_OUT_OF_MEMORY) /* which is also what the library says of sizes that are a lie */
        return fail(error, STATUS_INPUT, "cannot read '%s': the EXR file is damaged or too large for the memory", path);
    return fail(error, STATUS_INPUT, "cannot read '%s': the EXR file is damaged or cut short (%s)", path,
                exr_reason(bytes, code));
}

void exr_file_close(ExrFile *file)
{
    if (file->context) exr_finish(&file->context);
    exr_report_to(NULL);
    if (file->bytes.file >= 0) close(file->bytes.file);
    free(file->memory);
    *file = (ExrFile){.bytes.file = -1};
}

static Status open_bytes(ExrFile *file, Error *error)
{
    struct stat facts;
    if (strcmp(file->path, "-") != 0) {
        file->bytes.file = open(file->path, O_RDONLY | O_CLOEXEC);
        if (file->bytes.file < 0 || fstat(file->bytes.file, &facts) != 0)
            return file_cannot_read(file->path, errno, error);
        if (S_ISDIR(facts.st_mode)) return fail(error, STATUS_INPUT, "cannot read '%s': it is a directory", file->path);
        if (S_ISREG(facts.st_mode)) {
            file->bytes.size = (uint64_t)facts.st_size;
            return STATUS_OK;
        }
        close(file->bytes.file);
        file->bytes.file = -1;
    }
    size_t length;
    TRY(file_read(file->path, 0, &file->memory, &length, error));
    file->bytes.memory = file->memory;
    file->bytes.size = length;
    return STATUS_OK;
}

Status exr_file_open(const char *path, ExrFile *file, Error *error)
{
    *file = (ExrFile){.path = path, .bytes.file = -1};
    TRY(open_bytes(file, error));
    if (file->bytes.size == 0) return fail(error, STATUS_INPUT, "cannot read '%s': the file is empty", path);
    char magic[4] = {0};
    if (read_bytes(NULL, &file->bytes, magic, sizeof magic, 0, NULL) != sizeof magic ||
        memcmp(magic, "\x76\x2f\x31\x01", sizeof magic) != 0)
        return fail(error, STATUS_INPUT, "cannot read '%s': it is not an EXR file", path);
    exr_context_initializer_t initializer = exr_initializer(&file->bytes);
    exr_result_t result = exr_start_read(&file->context, path, &initializer);
    if (result != EXR_ERR_SUCCESS) return exr_fail_read(path, &file->bytes, result, error);
    return STATUS_OK;
}

/* file.c - reading whole files, and writing files that appear under their name only when whole.
 * SPDX-License-Identifier: Apache-2.0 */
#define _XOPEN_SOURCE 700 /* realpath */
#include "base/file.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/attr.h"
#include "base/file_reads.h"
#include "base/near_file.h"

enum { FIRST_READ = 64 * 1024, TEMPORARY_SUFFIX_ROOM = 40, LONGEST_NAME = 255 };

/* ---- which file it is ---- */

static bool are_one(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/* Of the folders that two paths begin with. */
static bool folders_are_one(const char *a, const char *b)
{
    char *folders[2] = {file_folder(a), file_folder(b)};
    struct stat info[2];
    bool found = folders[0] && folders[1];
    for (int i = 0; i < 2; i++) found = found && stat(*folders[i] ? folders[i] : ".", &info[i]) == 0;
    for (int i = 0; i < 2; i++) free(folders[i]);
    return found && are_one(&info[0], &info[1]);
}

bool file_same(const char *a, const char *b)
{
    struct stat info[2];
    if (strcmp(a, b) == 0) return true;
    if (strcmp(a, "-") == 0 || strcmp(b, "-") == 0) return false;
    bool there[2] = {stat(a, &info[0]) == 0, stat(b, &info[1]) == 0};
    if (there[0] && there[1]) return S_ISREG(info[0].st_mode) && are_one(&info[0], &info[1]);
    return !there[0] && !there[1] && strcmp(file_name(a), file_name(b)) == 0 && folders_are_one(a, b);
}

/* ---- reading ---- */

Status file_cannot_read(const char *path, int reason, Error *error)
{
    char *near = reason == ENOENT ? file_near(path) : NULL;
    fail(error, STATUS_INPUT, "cannot read '%s': %s%s%s%s", path, strerror(reason), near ? "; did you mean '" : "",
         near ? near : "", near ? "'?" : "");
    free(near);
    return STATUS_INPUT;
}

static Status too_large(Error *error, const char *path, size_t limit)
{
    return fail(error, STATUS_INPUT, "'%s' is larger than the limit of %zu bytes", path, limit);
}

static Status read_all(int descriptor, const char *path, size_t expected, size_t limit, char **bytes, size_t *length,
                       Error *error)
{
    char *text = NULL;
    size_t n = 0, capacity = 0;
    if (!array_reserve(&text, &capacity, expected + 2, 1)) return fail_memory(error, expected + 2, path);
    for (;;) {
        if (!array_reserve(&text, &capacity, n + 2, 1)) {
            free(text);
            return fail_memory(error, n + 2, path);
        }
        ssize_t got = read(descriptor, text + n, capacity - n - 1);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            free(text);
            return file_cannot_read(path, errno, error);
        }
        if (got == 0) break;
        n += (size_t)got;
        if (limit && n > limit) {
            free(text);
            return too_large(error, path, limit);
        }
    }
    text[n] = 0;
    *bytes = text;
    *length = n;
    return STATUS_OK;
}

Status file_read(const char *path, size_t limit, char **bytes, size_t *length, Error *error)
{
    if (strcmp(path, "-") == 0) return read_all(STDIN_FILENO, "<stdin>", FIRST_READ, limit, bytes, length, error);
    int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        (void)file_cannot_read(path, errno, error);
        file_note_missing(path);
        return STATUS_INPUT;
    }
    struct stat info;
    Status status;
    if (fstat(descriptor, &info) != 0)
        status = file_cannot_read(path, errno, error);
    else if (S_ISDIR(info.st_mode))
        status = file_cannot_read(path, EISDIR, error);
    else if (limit && S_ISREG(info.st_mode) && (uintmax_t)info.st_size > limit)
        status = too_large(error, path, limit);
    else if (!file_note_read(path, &info))
        status = fail_memory(error, strlen(path) + 1, path);
    else
        status = read_all(descriptor, path, S_ISREG(info.st_mode) ? (size_t)info.st_size : FIRST_READ, limit, bytes,
                          length, error);
    close(descriptor);
    return status;
}

void file_end_lines(char *text, size_t length)
{
    if (memchr(text, '\n', length)) return;
    for (char *at = text; (at = memchr(at, '\r', length - (size_t)(at - text)));) *at = '\n';
}

FileKind file_kind(const char *path)
{
    struct stat info;
    if (stat(path, &info) != 0) return FILE_NONE;
    return S_ISREG(info.st_mode) ? FILE_REGULAR : S_ISDIR(info.st_mode) ? FILE_FOLDER : FILE_OTHER;
}

bool file_exists(const char *path)
{
    FileKind kind = file_kind(path);
    return kind != FILE_NONE && kind != FILE_FOLDER;
}

/* ---- names ---- */

char *file_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) + 1 : 0;
    char *folder = malloc(length + 1);
    if (!folder) return NULL;
    memcpy(folder, path, length);
    folder[length] = 0;
    return folder;
}

bool file_lies_in(const char *path, const char *folder)
{
    char *real = file_real_path(path), *real_folder = file_real_path(*folder ? folder : ".");
    size_t n = real_folder ? strlen(real_folder) : 0;
    bool inside = real && real_folder && strncmp(real, real_folder, n) == 0 &&
                  (real[n] == '/' || (n && real_folder[n - 1] == '/'));
    free(real);
    free(real_folder);
    return inside;
}

const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

const char *file_extension(const char *path)
{
    const char *name = file_name(path);
    const char *dot = strrchr(name, '.');
    return dot && dot != name ? dot + 1 : "";
}

const char *file_number_mark(const char *path, size_t *length)
{
    static const char *const words[] = {"<frame>", "{frame}"};
    static const char digits[] = "0123456789";
    for (const char *mark = path; *mark; mark++) {
        *length = 2 + strspn(mark + 1, digits);
        if (*mark == '%' && mark[*length - 1] == 'd') return mark;
        bool letter = mark[0] == '$' && mark[1] == 'F';
        *length = 2 + (letter ? strspn(mark + 2, digits) : 0);
        if (letter && !isalpha((unsigned char)mark[*length])) return mark;
        for (size_t i = 0; i < COUNT_OF(words); i++) {
            *length = strlen(words[i]);
            if (strncmp(mark, words[i], *length) == 0) return mark;
        }
    }
    return NULL;
}

size_t file_stem_length(const char *path)
{
    const char *extension = file_extension(path);
    return strlen(path) - (*extension ? strlen(extension) + 1 : 0);
}

char *file_real_path(const char *path)
{
    return realpath(path, NULL);
}

/* ---- writing ---- */

static Status cannot_write(Error *error, const char *path, int reason)
{
    char *folder = reason == ENOENT ? file_folder(path) : NULL; /* with its '/' */
    bool folder_lacks = folder && *folder && access(folder, F_OK) != 0;
    if (folder_lacks)
        fail(error, STATUS_OUTPUT, "cannot write '%s': there is no folder '%.*s'", path, (int)strlen(folder) - 1,
             folder);
    free(folder);
    if (folder_lacks) return STATUS_OUTPUT;
    if (strcmp(path, "-") == 0)
        return fail(error, STATUS_OUTPUT, "cannot write to standard output: %s", strerror(reason));
    return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, strerror(reason));
}

/* Devices, pipes and standard output have no name to be renamed to. */
static bool is_plain(const char *path)
{
    return strcmp(path, "-") == 0 || file_kind(path) == FILE_OTHER;
}

/* The file that a symbolic link leads to, so that a commit replaces the file and not the link. */
static char *followed(const char *path)
{
    struct stat info;
    if (lstat(path, &info) == 0 && S_ISLNK(info.st_mode)) {
        char *target = file_real_path(path);
        if (target) return target;
    }
    return strdup(path);
}

/* NAME.PROCESS-ATTEMPT.tmp, of a name that leaves no room for that its beginning, up to a whole character of UTF-8. */
char *file_temporary_name(const char *path, int attempt)
{
    char *target = followed(path), suffix[TEMPORARY_SUFFIX_ROOM];
    if (!target) return NULL;
    int suffix_length = snprintf(suffix, sizeof suffix, ".%ld-%d.tmp", (long)getpid(), attempt);
    const char *name = file_name(target);
    size_t length = strlen(name), most = (size_t)(LONGEST_NAME - suffix_length);
    if (length > most)
        for (length = most; length > 0 && ((unsigned char)name[length] & 0xc0) == 0x80;) length--;
    size_t size = (size_t)(name - target) + length + sizeof suffix;
    char *temporary = malloc(size);
    if (temporary) snprintf(temporary, size, "%.*s%s", (int)((size_t)(name - target) + length), target, suffix);
    free(target);
    return temporary;
}

/* Makes an empty file under a temporary name that nothing else has. */
static Status create_beside(const char *path, char **temporary, int *descriptor, Error *error)
{
    for (int attempt = 0; attempt < FILE_TEMPORARY_TRIES; attempt++) {
        *temporary = file_temporary_name(path, attempt);
        if (!*temporary) return fail_memory(error, strlen(path), "a file name");
        *descriptor = open(*temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (*descriptor >= 0) return STATUS_OK;
        int reason = errno;
        free(*temporary);
        *temporary = NULL;
        errno = reason;
        if (reason != EEXIST) break;
    }
    return cannot_write(error, path, errno);
}

/* The rename itself is on disk only when its folder is. A folder that cannot be opened is no failure: the file
 * is there for every process, only not yet safe from a power cut. */
static void sync_folder(const char *path)
{
    char *folder = file_folder(path);
    if (!folder) return;
    int descriptor = open(*folder ? folder : ".", O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0) {
        fsync(descriptor);
        close(descriptor);
    }
    free(folder);
}

static Status rename_followed(const char *temporary, const char *path, Error *error)
{
    char *target = followed(path);
    if (!target) return fail_memory(error, strlen(path) + 1, "a file name");
    Status status = STATUS_OK;
    struct stat old;
    if (stat(target, &old) == 0 && S_ISREG(old.st_mode) && chmod(temporary, old.st_mode & 07777) != 0)
        status = cannot_write(error, path, errno);
    else if (rename(temporary, target) != 0)
        status = cannot_write(error, path, errno);
    else
        sync_folder(target);
    free(target);
    return status;
}

Status file_create(FileOut *out, const char *path, Error *error)
{
    *out = (FileOut){.plain = is_plain(path), .path = strdup(path)};
    if (!out->path) return fail_memory(error, strlen(path) + 1, "a file name");
    int descriptor = -1;
    if (strcmp(path, "-") == 0) {
        descriptor = dup(STDOUT_FILENO);
    } else if (out->plain) {
        descriptor = open(path, O_WRONLY | O_CLOEXEC);
    } else {
        Status status = create_beside(path, &out->temporary, &descriptor, error);
        if (status != STATUS_OK) {
            file_abandon(out);
            return status;
        }
    }
    int reason = errno;
    if (descriptor >= 0) {
        out->stream = fdopen(descriptor, "wb");
        reason = errno;
        if (!out->stream) close(descriptor);
    }
    if (out->stream) return STATUS_OK;
    file_abandon(out);
    return cannot_write(error, path, reason);
}

Status file_commit(FileOut *out, Error *error)
{
    errno = 0;
    bool failed = ferror(out->stream) || fflush(out->stream) != 0;
    if (!failed && !out->plain) failed = fsync(fileno(out->stream)) != 0;
    int reason = errno ? errno : EIO;
    if (fclose(out->stream) != 0 && !failed) {
        failed = true;
        reason = errno;
    }
    out->stream = NULL;
    Status status = STATUS_OK;
    if (failed)
        status = cannot_write(error, out->path, reason);
    else if (!out->plain)
        status = rename_followed(out->temporary, out->path, error);
    if (status == STATUS_OK) {
        free(out->temporary);
        out->temporary = NULL; /* it bears its name now: nothing to delete */
    }
    file_abandon(out);
    return status;
}

void file_abandon(FileOut *out)
{
    if (out->stream) fclose(out->stream);
    if (out->temporary) unlink(out->temporary);
    free(out->temporary);
    free(out->path);
    *out = (FileOut){0};
}

Status file_write(const char *path, const void *bytes, size_t length, Error *error)
{
    FileOut file;
    TRY(file_create(&file, path, error));
    if (fwrite(bytes, 1, length, file.stream) != length) {
        int reason = errno;
        file_abandon(&file);
        return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, strerror(reason));
    }
    return file_commit(&file, error);
}

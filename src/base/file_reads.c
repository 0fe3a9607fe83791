/* file_reads.c - a list, for there are few: textures and meshes by the hundred, and pipes and devices are not among them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/file_reads.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* What tells two versions of a file. Editors write a new file beside the old one and rename it, or into the old one. */
typedef struct FileVersion {
    bool there;
    dev_t device;
    ino_t inode;
    off_t size;
    struct timespec changed;
} FileVersion;

typedef struct FileRead {
    char *path;
    FileVersion version;
} FileRead;

static struct {
    pthread_mutex_t lock;
    FileRead *items;
    size_t n, capacity;
} reads = {.lock = PTHREAD_MUTEX_INITIALIZER};

static FileVersion version_of(const struct stat *info)
{
    return (FileVersion){true, info->st_dev, info->st_ino, info->st_size, info->st_mtim};
}

static FileVersion version_now(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 ? version_of(&info) : (FileVersion){0};
}

static bool are_one_file(const FileVersion *a, const FileVersion *b)
{
    return a->there && b->there && a->device == b->device && a->inode == b->inode;
}

static bool are_equal(const FileVersion *a, const FileVersion *b)
{
    if (!a->there && !b->there) return true;
    return are_one_file(a, b) && a->size == b->size && a->changed.tv_sec == b->changed.tv_sec &&
           a->changed.tv_nsec == b->changed.tv_nsec;
}

/* With the lock held. */
static bool is_noted(const FileVersion *version, const char *path)
{
    for (size_t i = 0; i < reads.n; i++)
        if (version->there ? are_one_file(&reads.items[i].version, version) : strcmp(reads.items[i].path, path) == 0)
            return true;
    return false;
}

static bool note(const char *path, FileVersion version)
{
    pthread_mutex_lock(&reads.lock);
    bool noted = is_noted(&version, path);
    size_t size = strlen(path) + 1;
    char *copy = noted ? NULL : malloc(size);
    if (copy && ARRAY_ROOM(reads.items, reads.capacity, reads.n)) {
        memcpy(copy, path, size);
        reads.items[reads.n++] = (FileRead){copy, version};
        copy = NULL;
        noted = true;
    }
    pthread_mutex_unlock(&reads.lock);
    free(copy);
    return noted;
}

bool file_note_read(const char *path, const struct stat *info)
{
    return !S_ISREG(info->st_mode) || note(path, version_of(info));
}

void file_note_missing(const char *path)
{
    bool noted = note(path, (FileVersion){0});
    (void)noted;
}

bool file_was_read(const char *path)
{
    FileVersion version = version_now(path);
    if (!version.there) return false;
    pthread_mutex_lock(&reads.lock);
    bool noted = is_noted(&version, path);
    pthread_mutex_unlock(&reads.lock);
    return noted;
}

size_t file_count_reads(void)
{
    pthread_mutex_lock(&reads.lock);
    size_t n = 0;
    for (size_t i = 0; i < reads.n; i++) n += reads.items[i].version.there;
    pthread_mutex_unlock(&reads.lock);
    return n;
}

const char *file_read_path(size_t number)
{
    const char *path = NULL;
    pthread_mutex_lock(&reads.lock);
    for (size_t i = 0; i < reads.n && !path; i++)
        if (reads.items[i].version.there && number-- == 0) path = reads.items[i].path;
    pthread_mutex_unlock(&reads.lock);
    return path;
}

const char *file_find_changed(void)
{
    const char *changed = NULL;
    pthread_mutex_lock(&reads.lock);
    for (size_t i = 0; i < reads.n && !changed; i++) {
        FileVersion now = version_now(reads.items[i].path);
        if (!are_equal(&now, &reads.items[i].version)) changed = reads.items[i].path;
    }
    pthread_mutex_unlock(&reads.lock);
    return changed;
}

bool file_renote_reads(void)
{
    bool changed = false;
    pthread_mutex_lock(&reads.lock);
    for (size_t i = 0; i < reads.n; i++) {
        FileVersion now = version_now(reads.items[i].path);
        changed = changed || !are_equal(&now, &reads.items[i].version);
        reads.items[i].version = now;
    }
    pthread_mutex_unlock(&reads.lock);
    return changed;
}

void file_forget_reads(void)
{
    pthread_mutex_lock(&reads.lock);
    for (size_t i = 0; i < reads.n; i++) free(reads.items[i].path);
    free(reads.items);
    reads.items = NULL;
    reads.n = reads.capacity = 0;
    pthread_mutex_unlock(&reads.lock);
}

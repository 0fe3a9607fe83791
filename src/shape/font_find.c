/* font_find.c - fonts by the names of their files, in the folders where systems keep them.
 * SPDX-License-Identifier: Apache-2.0 */
#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "shape/glyphs.h"

static const char *const folders[] = {"/usr/share/fonts", "/usr/local/share/fonts", "/Library/Fonts",
                                      "/System/Library/Fonts"};
enum { DEEPEST = 6, MOST_FOLDERS = 20000 };

const char *font_folders(void)
{
    return "/usr/share/fonts and /usr/local/share/fonts";
}

typedef struct FontSearch {
    const char *name;
    char *found;
    size_t n_folders;
    bool out_of_memory;
} FontSearch;

/* The file's name, with or without one of the usual extensions. */
static bool is_named(const char *file, const char *name)
{
    static const char *const extensions[] = {"", ".ttf", ".otf", ".ttc", ".pfb"};
    size_t length = strlen(name);
    if (strncmp(file, name, length) != 0) return false;
    for (size_t i = 0; i < COUNT_OF(extensions); i++)
        if (strcmp(file + length, extensions[i]) == 0) return true;
    return false;
}

static int compare_names(const void *left, const void *right)
{
    char *const *a = left, *const *b = right;
    return strcmp(*a, *b);
}

static char *join(const char *folder, const char *name)
{
    size_t n = strlen(folder), m = strlen(name);
    char *path = malloc(n + m + 2);
    if (!path) return NULL;
    memcpy(path, folder, n);
    path[n] = '/';
    memcpy(path + n + 1, name, m + 1);
    return path;
}

/* Paths in a folder, in the order of names, so that the same files are found on every run. */
static char **list_folder(FontSearch *search, const char *folder, size_t *n)
{
    char **paths = NULL;
    size_t capacity = 0;
    *n = 0;
    DIR *stream = opendir(folder);
    if (!stream) return NULL;
    for (const struct dirent *entry; (entry = readdir(stream));) {
        if (entry->d_name[0] == '.') continue;
        char *path = join(folder, entry->d_name);
        if (!path || !ARRAY_ROOM(paths, capacity, *n)) {
            free(path);
            search->out_of_memory = true;
            break;
        }
        paths[(*n)++] = path;
    }
    closedir(stream);
    if (*n) qsort(paths, *n, sizeof *paths, compare_names);
    return paths;
}

static void search_folder(FontSearch *search, const char *folder, int depth)
{
    if (search->found || depth > DEEPEST || search->n_folders++ > MOST_FOLDERS) return;
    size_t n;
    char **paths = list_folder(search, folder, &n);
    for (size_t i = 0; i < n; i++) {
        if (search->found || search->out_of_memory) break;
        if (!file_exists(paths[i])) {
            search_folder(search, paths[i], depth + 1);
        } else if (is_named(paths[i] + strlen(folder) + 1, search->name)) {
            search->found = paths[i];
            paths[i] = NULL;
        }
    }
    for (size_t i = 0; i < n; i++) free(paths[i]);
    free(paths);
}

Status font_find(const char *name, char **path, Error *error)
{
    FontSearch search = {.name = name};
    *path = NULL;
    if (!*name || strchr(name, '/')) return STATUS_OK;
    for (size_t i = 0; i < COUNT_OF(folders); i++) search_folder(&search, folders[i], 0);
    if (search.out_of_memory) {
        free(search.found);
        return fail_memory(error, 0, "the search for a font");
    }
    *path = search.found;
    return STATUS_OK;
}

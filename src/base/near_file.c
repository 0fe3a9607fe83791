/* near_file.c - the names in a folder, and which of them is like another.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/near_file.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "base/suggest.h"

enum { MOST_NAMES = 20000 }; /* more are not worth the time */

typedef struct Names {
    char **items;
    size_t n, capacity;
} Names;

static void read_names(const char *folder, Names *names)
{
    DIR *stream = opendir(*folder ? folder : ".");
    if (!stream) return;
    for (struct dirent *entry; names->n < MOST_NAMES && (entry = readdir(stream));) {
        if (entry->d_name[0] == '.' || strcmp(file_extension(entry->d_name), "tmp") == 0) continue;
        if (!array_reserve(&names->items, &names->capacity, names->n + 1, sizeof *names->items)) break;
        char *copy = strdup(entry->d_name);
        if (!copy) break;
        names->items[names->n++] = copy;
    }
    closedir(stream);
}

/* Whether a name is another's with the number of a frame in it, or instead of its '#'. */
static bool is_frame_of(const char *name, const char *whole)
{
    const char *mark = strchr(whole, '#'), *rest = mark ? mark + strspn(mark, "#") : whole + file_stem_length(whole);
    size_t before = (size_t)((mark ? mark : rest) - whole);
    if (strncmp(name, whole, before) != 0 || !*rest) return false;
    const char *number = name + before;
    if (!mark && *number++ != '.') return false;
    size_t n_digits = strspn(number, "0123456789");
    return n_digits > 0 && strcmp(number + n_digits, rest) == 0;
}

static const char *first_frame(const Names *names, const char *whole)
{
    const char *first = NULL;
    for (size_t i = 0; i < names->n; i++)
        if (is_frame_of(names->items[i], whole) && (!first || strcmp(names->items[i], first) < 0))
            first = names->items[i];
    return first;
}

char *file_near(const char *path)
{
    const char *name = file_name(path);
    char *folder = file_folder(path), *near = NULL;
    Names names = {0};
    if (folder && *name) read_names(folder, &names);
    const char *found = first_frame(&names, name);
    if (!found) found = suggest_nearest(name, (const char *const *)names.items, names.n);
    size_t length = (size_t)(name - path), size = found ? strlen(found) + 1 : 0;
    if (found) near = malloc(length + size);
    if (near) {
        memcpy(near, path, length);
        memcpy(near + length, found, size);
    }
    for (size_t i = 0; i < names.n; i++) free(names.items[i]);
    free(names.items);
    free(folder);
    return near;
}

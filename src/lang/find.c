/* find.c - where files that a scene names are sought, and that they stay within the folder of --confine.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "lang/evaluator.h"

#ifndef MEN_DATA_FOLDER
#define MEN_DATA_FOLDER "/usr/local/share/meniscus"
#endif

typedef struct Search {
    const EvalOptions *options;
    Diag *diag;
    Span span;
    const char *name;
    bool outside; /* found, but not within the confinement */
} Search;

static bool is_within(const char *path, const char *folder)
{
    char *real_path = file_real_path(path), *real_folder = file_real_path(folder);
    bool within = false;
    if (real_path && real_folder) {
        size_t length = strlen(real_folder);
        if (length > 0 && real_folder[length - 1] == '/') length--; /* the root */
        within = strncmp(real_path, real_folder, length) == 0 && real_path[length] == '/';
    }
    free(real_path);
    free(real_folder);
    return within;
}

/* folder/name when there is such a file that may be read */
static const char *try_folder(Search *search, const char *folder, size_t length)
{
    const char *slash = length > 0 && folder[length - 1] != '/' ? "/" : "";
    const char *path = arena_format(search->diag->arena, "%.*s%s%s", (int)length, folder, slash, search->name);
    if (!file_exists(path)) return NULL;
    if (!search->options->confine || is_within(path, search->options->confine)) return path;
    search->outside = true;
    return NULL;
}

static const char *try_path_list(Search *search, const char *list)
{
    while (list && *list) {
        size_t length = strcspn(list, ":");
        const char *path = length ? try_folder(search, list, length) : NULL;
        if (path) return path;
        list += length + (list[length] == ':');
    }
    return NULL;
}

static const char *search_file(Search *search)
{
    if (search->name[0] == 0) return NULL;
    if (search->name[0] == '/') return try_folder(search, "", 0);
    const Source *source = &search->diag->sources->sources[search->span.source];
    const char *slash = source->path ? strrchr(source->path, '/') : NULL;
    const char *path = try_folder(search, source->path ? source->path : "", slash ? (size_t)(slash - source->path) + 1 : 0);
    for (size_t i = 0; !path && i < search->options->n_include_folders; i++)
        path = try_folder(search, search->options->include_folders[i], strlen(search->options->include_folders[i]));
    if (!path) path = try_path_list(search, getenv("MENISCUS_PATH"));
    if (!path) path = try_folder(search, MEN_DATA_FOLDER, strlen(MEN_DATA_FOLDER));
    return path;
}

static void report_missing(const Search *search)
{
    if (search->outside)
        diag_report(search->diag, D_OUTSIDE_CONFINE, search->span, "'%s' is outside of '%s', to which the scene is confined",
                    search->name, search->options->confine);
    else
        diag_report(search->diag, D_FILE_NOT_FOUND, search->span, "no file '%s'", search->name);
}

const char *eval_find_file(const EvalOptions *options, Diag *diag, Span span, const char *name)
{
    Search search = {options, diag, span, name, false};
    const char *path = search_file(&search);
    if (!path) report_missing(&search);
    return path;
}

const char *find_import(const EvalOptions *options, Diag *diag, Span span, const char *name, const char **library)
{
    Search search = {options, diag, span, name, false};
    const char *path = search_file(&search);
    *library = NULL;
    if (!path && options->library) *library = options->library(name);
    if (!path && !*library) report_missing(&search);
    return path;
}

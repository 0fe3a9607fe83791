/* find.c - where files that a scene names are sought, and that they stay within the folder of --confine.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/file_reads.h"
#include "base/near_file.h"
#include "base/suggest.h"
#include "lang/evaluator.h"

#ifndef MEN_DATA_FOLDER
#define MEN_DATA_FOLDER "/usr/local/share/meniscus"
#endif

typedef struct Search {
    const EvalOptions *options;
    Diag *diag;
    Span span;
    const char *name;
    bool imports;        /* what is sought is a text to import, and the library has some */
    bool outside;        /* where it would be is not within the confinement */
    const char *skipped; /* a folder of -I or MENISCUS_PATH that is not; NULL: none */
    const char *other;   /* found, but a folder, a pipe or a device: the last of them; NULL: none */
    FileKind kind;       /* of it */
} Search;

/* The path without "." and without "name/..", so that it leads to its place and nowhere else on the way. */
static const char *direct_path(Arena *arena, const char *path)
{
    Buf direct = {0};
    if (path[0] == '/') buf_add(&direct, "/");
    size_t fixed = direct.length; /* the root, and what leads out of the current folder */
    for (size_t length; *path; path += length) {
        path += strspn(path, "/");
        length = strcspn(path, "/");
        bool up = length == 2 && strncmp(path, "..", 2) == 0;
        if (length == 0 || (length == 1 && path[0] == '.') || (up && fixed == 1 && direct.length == 1)) continue;
        if (up && direct.length > fixed) {
            while (direct.length > fixed && direct.text[direct.length - 1] != '/') direct.length--;
            if (direct.length > fixed) direct.length--;
            continue;
        }
        if (direct.length > 0 && direct.text[direct.length - 1] != '/') buf_add(&direct, "/");
        buf_add_bytes(&direct, path, length);
        if (up) fixed = direct.length;
    }
    const char *text =
        arena_copy_text(arena, direct.length ? buf_text(&direct) : ".", direct.length ? direct.length : 1);
    buf_clear(&direct);
    return text;
}

/* Whether the folder holds the path, or would if it were there: of what is outside it must not show whether it exists. */
static bool is_within(Arena *arena, const char *path, const char *folder)
{
    char *real_folder = file_real_path(folder), *real_path = NULL, *at = arena_copy_text(arena, path, strlen(path));
    /* the nearest folder above that exists */
    while (!(real_path = file_real_path(at))) {
        char *slash = strrchr(at, '/');
        if (slash == at ? at[1] == 0 : !slash && strcmp(at, ".") == 0) break;
        if (slash)
            slash[slash == at] = 0;
        else
            at = arena_copy_text(arena, ".", 1);
    }
    bool within = false;
    if (real_path && real_folder) {
        size_t length = strlen(real_folder);
        if (length > 0 && real_folder[length - 1] == '/') length--; /* the root */
        within = strncmp(real_path, real_folder, length) == 0 && (real_path[length] == '/' || real_path[length] == 0);
    }
    free(real_path);
    free(real_folder);
    return within;
}

/* folder/name when there is such a file that may be read; pipes and devices may never end, or never begin. chosen: the
 * folder was not chosen by the scene, but by whoever runs it. */
static const char *try_folder(Search *search, const char *folder, size_t length, bool chosen)
{
    Arena *arena = search->diag->arena;
    const char *slash = length > 0 && folder[length - 1] != '/' ? "/" : "", *confine = search->options->confine;
    const char *path = arena_format(arena, "%.*s%s%s", (int)length, folder, slash, search->name);
    if (confine) {
        path = direct_path(arena, path);
        if (!is_within(arena, path, confine)) {
            search->outside |= !chosen;
            if (chosen && !search->skipped) search->skipped = arena_copy_text(arena, folder, length);
            return NULL;
        }
    }
    FileKind kind = file_kind(path);
    if (kind == FILE_NONE) return NULL;
    if (kind == FILE_REGULAR) return path;
    search->other = path;
    search->kind = kind;
    return NULL;
}

static const char *try_path_list(Search *search, const char *list)
{
    while (list && *list) {
        size_t length = strcspn(list, ":");
        const char *path = length ? try_folder(search, list, length, true) : NULL;
        if (path) return path;
        list += length + (list[length] == ':');
    }
    return NULL;
}

/* The text of the library that has the name, NULL where none has. */
static const EvalLibraryFile *library_file(const EvalOptions *options, const char *name)
{
    for (size_t i = 0; options->library && i < options->library->n_files; i++)
        if (strcmp(options->library->files[i].name, name) == 0) return &options->library->files[i];
    return NULL;
}

/* library: not NULL where texts of the program will do as well. They come before what may lie in the data folder from
 * another version. */
static const char *search_file(Search *search, const EvalLibraryFile **library)
{
    if (library) *library = NULL;
    if (search->name[0] == 0) return NULL;
    if (search->name[0] == '/') return try_folder(search, "", 0, false);
    const Source *source = &search->diag->sources->sources[search->span.source];
    const char *slash = source->path ? strrchr(source->path, '/') : NULL;
    const char *path =
        try_folder(search, source->path ? source->path : "", slash ? (size_t)(slash - source->path) + 1 : 0, false);
    for (size_t i = 0; !path && i < search->options->n_include_folders; i++)
        path =
            try_folder(search, search->options->include_folders[i], strlen(search->options->include_folders[i]), true);
    if (!path) path = try_path_list(search, getenv("MENISCUS_PATH"));
    if (!path && library) *library = library_file(search->options, search->name);
    if (path || (library && *library)) return path;
    const char *skipped = search->skipped; /* the data folder is not worth a word */
    path = try_folder(search, MEN_DATA_FOLDER, strlen(MEN_DATA_FOLDER), true);
    search->skipped = skipped;
    return path;
}

/* "glassware" of std/glassware.mns: what all of them begin and end with makes nothing alike. */
static const char *library_stem(Arena *arena, const char *name)
{
    size_t length = strlen(name), folder = strncmp(name, "std/", 4) == 0 ? 4 : 0;
    size_t end = length > folder + 4 && strcmp(name + length - 4, ".mns") == 0 ? length - 4 : length;
    return arena_copy_text(arena, name + folder, end - folder);
}

static void suggest_library(const Search *search, Diagnostic *report)
{
    const EvalLibrary *library = search->options->library;
    Diag *diag = search->diag;
    if (!library) return;
    const char **stems = ARENA_ARRAY(diag->arena, const char *, library->n_files);
    for (size_t i = 0; i < library->n_files; i++) stems[i] = library_stem(diag->arena, library->files[i].name);
    const char *near = suggest_nearest(library_stem(diag->arena, search->name), stems, library->n_files);
    for (size_t i = 0; near && i < library->n_files; i++)
        if (stems[i] == near) diag_hint(diag, report, "did you mean '%s'?", library->files[i].name);
}

/* Where it is looked for first. */
static const char *first_place(const Search *search)
{
    const Source *source = &search->diag->sources->sources[search->span.source];
    const char *slash = source->path && search->name[0] != '/' ? strrchr(source->path, '/') : NULL;
    int length = slash ? (int)(slash - source->path) + 1 : 0;
    return arena_format(search->diag->arena, "%.*s%s", length, slash ? source->path : "", search->name);
}

/* A file beside it whose name is like it, in the scene's words. */
static void hint_near_file(const Search *search, const char *place, Diagnostic *report)
{
    char *near = file_near(place);
    if (near) diag_hint(search->diag, report, "did you mean '%s'?", near + strlen(place) - strlen(search->name));
    free(near);
}

/* A name for a message: "C:\textures" has become one with a tab in it. */
static const char *shown_name(Arena *arena, const char *name)
{
    Buf shown = {0};
    for (const char *at = name; *at; at++) {
        if (*at == '\n' || *at == '\t')
            buf_add(&shown, *at == '\n' ? "\\n" : "\\t");
        else
            buf_add_bytes(&shown, at, 1);
    }
    const char *text = arena_copy_text(arena, buf_text(&shown), shown.length);
    buf_clear(&shown);
    return text;
}

/* What an import's name stands for that lacks its end, or the library's folder: "std/media", "media.mns", "media"; NULL: nothing. */
static const char *whole_name(const Search *search)
{
    static const struct {
        const char *folder, *end;
    } lacking[] = {{"", ".mns"}, {"std/", ""}, {"std/", ".mns"}};
    for (size_t i = 0; i < COUNT_OF(lacking); i++) {
        const EvalLibraryFile *library;
        Search whole = *search;
        whole.name = arena_format(search->diag->arena, "%s%s%s", lacking[i].folder, search->name, lacking[i].end);
        if (search_file(&whole, &library) || library) return whole.name;
    }
    return NULL;
}

static void report_missing(const Search *search)
{
    Diag *diag = search->diag;
    if (search->outside) {
        diag_report(diag, D_OUTSIDE_CONFINE, search->span, "'%s' is outside of '%s', to which the scene is confined",
                    search->name, search->options->confine);
        return;
    }
    if (search->other) {
        diag_report(diag, D_FILE_UNREADABLE, search->span, "'%s' is %s", search->other,
                    search->kind == FILE_FOLDER ? "a folder, not a file"
                                                : "not a regular file, but a pipe or a device");
        return;
    }
    const char *place = first_place(search);
    file_note_missing(place); /* whoever waits for changes waits for it to be there */
    Diagnostic *report =
        diag_report(diag, D_FILE_NOT_FOUND, search->span, "no file '%s'", shown_name(diag->arena, search->name));
    if (strpbrk(search->name, "\n\t\\")) diag_hint(diag, report, "write '/' between the folders of a path");
    const char *whole = search->imports ? whole_name(search) : NULL;
    size_t length = strlen(search->name);
    if (length > 4 && strcmp(search->name + length - 4, ".inc") == 0)
        diag_hint(diag, report, "files of POV-Ray's are not read; meniscus help std lists what stands in their place");
    else if (whole)
        diag_hint(diag, report, "did you mean '%s'?", whole);
    else if (!report->hint && search->imports)
        suggest_library(search, report);
    if (!report->hint && strncmp(search->name, "std/", 4) == 0)
        diag_hint(diag, report, "meniscus help std lists what the library has");
    if (!report->hint && search->skipped)
        diag_hint(diag, report,
                  "the folder '%s' is not searched: it is outside of '%s', to which the scene is confined",
                  search->skipped, search->options->confine);
    if (!report->hint) hint_near_file(search, place, report);
    if (!report->hint && search->name[0] && search->name[0] != '/')
        diag_hint(diag, report,
                  "files are sought beside the one that names them, and in the folders of -I and MENISCUS_PATH");
}

const char *eval_find_file(const EvalOptions *options, Diag *diag, Span span, const char *name)
{
    Search search = {.options = options, .diag = diag, .span = span, .name = name};
    const char *path = search_file(&search, NULL);
    if (!path) report_missing(&search);
    return path;
}

const char *eval_seek_file(const EvalOptions *options, Diag *diag, Span span, const char *name)
{
    Search search = {.options = options, .diag = diag, .span = span, .name = name};
    return search_file(&search, NULL);
}

const char *find_import(const EvalOptions *options, Diag *diag, Span span, const char *name,
                        const EvalLibraryFile **library)
{
    Search search = {.options = options, .diag = diag, .span = span, .name = name, .imports = true};
    const Source *source = &diag->sources->sources[span.source];
    *library = NULL;
    if (!source->path && library_file(options, source->name)) /* the texts of the library belong together */
        *library = library_file(options, name);
    const char *path = *library ? NULL : search_file(&search, library);
    if (!path && !*library) report_missing(&search);
    return path;
}

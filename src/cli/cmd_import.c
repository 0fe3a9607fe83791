/* cmd_import.c - the command import: a scene of a mesh file, with its materials, lights and cameras.
 * All files that are to be written are looked at before the first is.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "cli/commands.h"
#include "cli/output.h"
#include "import/import.h"
#include "lang/format.h"
#include "lang/lex.h"

enum { MOST_NOTES = 12, MOST_STEPS_UP = 4 };

/* What becomes of one file. */
typedef struct Importing {
    const Options *options;
    const Talk *talk;
    const char *path;
    char *scene;                      /* the output; owned, as what follows */
    char *scene_folder, *mesh_folder; /* with a '/' behind, or "" */
    char *file, *folder, *stem;       /* see ImportOptions */
    MeshSource source;
    Mesh *mesh;
    Import import;
    Buf text;         /* laid out */
    bool *is_written; /* of each picture: it is there already, as it would be written */
} Importing;

/* ---- names ---- */

static char *without_extension(const char *path)
{
    const char *name = file_name(path);
    size_t length = file_stem_length(name);
    return length ? strndup(name, length) : strdup("scene");
}

static char *joined(const char *folder, const char *name)
{
    Buf path = {0};
    buf_format(&path, "%s%s", folder, name);
    if (!path.failed && path.text) return path.text;
    buf_clear(&path);
    return NULL;
}

/* The folder without symbolic links and with a '/' behind. */
static char *real_folder(const char *folder)
{
    char *real = file_real_path(*folder ? folder : "."), *with_slash;
    if (!real || strcmp(real, "/") == 0) return real;
    with_slash = joined(real, "/");
    free(real);
    return with_slash;
}

/* How a folder is written from another one: "", "models/", "../models/"; whole where they have nothing in common, or little. */
static char *from_folder_to(const char *from, const char *to)
{
    size_t common = 0, up = 0;
    for (size_t i = 0; from[i] && from[i] == to[i]; i++)
        if (from[i] == '/') common = i + 1;
    for (const char *c = from + common; *c; c++) up += *c == '/';
    Buf path = {0};
    if (common > 1 && up <= MOST_STEPS_UP)
        for (size_t i = 0; i < up; i++) buf_add(&path, "../");
    else
        common = 0;
    buf_add(&path, to + common);
    if (path.failed) buf_clear(&path);
    return path.text ? path.text : strdup("");
}

static Status choose_names(Importing *importing, Error *error)
{
    const char *output = option_text(importing->options, OPTION_IMPORT_OUTPUT, NULL);
    if (output) TRY(output_check_name(output, error));
    if (output && !output_is_stream(output) && strcmp(file_extension(output), "mns") != 0)
        return fail(error, STATUS_USAGE, "option '--output': '%s' must end in .mns", output);
    char *own = without_extension(importing->path);
    bool stream = output && output_is_stream(output);
    Buf name = {0};
    buf_format(&name, "%s.mns", own ? own : "");
    importing->scene = output ? strdup(output) : name.text ? strdup(name.text) : NULL;
    buf_clear(&name);
    importing->stem = output && !stream ? without_extension(output) : own ? strdup(own) : NULL;
    free(own);
    importing->scene_folder = importing->scene && !stream ? file_folder(importing->scene) : strdup("");
    importing->mesh_folder = file_folder(importing->path);
    char *from = importing->scene_folder ? real_folder(importing->scene_folder) : NULL,
         *to = importing->mesh_folder ? real_folder(importing->mesh_folder) : NULL;
    if (from && to) importing->folder = from_folder_to(from, to);
    bool no_folder = importing->scene_folder && !from;
    free(from);
    free(to);
    if (importing->folder) importing->file = joined(importing->folder, file_name(importing->path));
    if (no_folder)
        return fail(error, STATUS_OUTPUT, "cannot write '%s': there is no folder '%s'", importing->scene,
                    importing->scene_folder);
    if (importing->scene && importing->stem && importing->file) return STATUS_OK;
    return fail_memory(error, strlen(importing->path), "the names of files");
}

/* ---- making ---- */

static double unit_asked_for(const Options *options)
{
    const char *name = option_text(options, OPTION_UNIT, NULL);
    const UnitType *unit = name ? unit_of(name, strlen(name)) : NULL;
    return unit ? unit->size : 0;
}

static ImportOptions import_options(const Importing *importing)
{
    const Options *options = importing->options;
    bool stl = strcasecmp(file_extension(importing->path), "stl") == 0;
    ImportOptions wanted = {
        .path = importing->path,
        .file = importing->file,
        .folder = importing->folder,
        .real_folder = importing->mesh_folder,
        .stem = importing->stem,
        .unit_m = unit_asked_for(options),
        .up_z = option_given(options, OPTION_UP) ? option_is(options, OPTION_UP, "z") : stl,
    };
    if (option_is(options, OPTION_FLOOR, "on")) wanted.floor = FLOOR_ON;
    if (option_is(options, OPTION_FLOOR, "off")) wanted.floor = FLOOR_OFF;
    return wanted;
}

typedef struct Layout {
    SceneInput *input;
    Importing *importing;
    Error *error;
    Status status;
} Layout;

static void lay_out(void *context)
{
    Layout *layout = context;
    const Buf *text = &layout->importing->import.text;
    layout->status = format_text("scene", buf_text(text), text->length, &layout->input->diag, &layout->importing->text,
                                 layout->error);
}

/* As fmt would; what is not in the language is a mistake of this program. */
static Status format(Importing *importing, Error *error)
{
    SceneInput input;
    scene_input_init(&input, importing->options, importing->talk);
    input.path = importing->scene;
    Layout layout = {.input = &input, .importing = importing, .error = error};
    Status status = scene_input_guard(&input, lay_out, &layout, error);
    if (status == STATUS_OK) status = layout.status;
    if (status == STATUS_SCENE) status = scene_input_print_reports(&input, error);
    scene_input_close(&input);
    return status;
}

/* ---- writing ---- */

static bool holds(const char *path, const char *bytes, size_t length)
{
    char *there = NULL;
    size_t n = 0;
    Error unused;
    bool same = file_read(path, length + 1, &there, &n, &unused) == STATUS_OK && n == length &&
                memcmp(there, bytes, length) == 0;
    free(there);
    return same;
}

/* The names of pictures are the file's: what has one may be no link to elsewhere, either. */
static Status look_at_picture(Importing *importing, size_t i, const char *path, Error *error)
{
    const ImportPicture *picture = &importing->import.pictures[i];
    bool force = option_given(importing->options, OPTION_FORCE), there = file_kind(path) == FILE_REGULAR;
    if (there && !file_lies_in(path, importing->scene_folder))
        return fail(error, STATUS_OUTPUT, "'%s' is a link to another folder, where no picture is written", path);
    if (!there || force) return output_probe(path, error);
    importing->is_written[i] = holds(path, picture->bytes, picture->length);
    if (importing->is_written[i]) return STATUS_OK;
    return fail(error, STATUS_OUTPUT,
                "'%s' is there already, and is not the picture of that name in '%s': '-o OTHER.mns' writes others, "
                "'--force' replaces it",
                path, importing->path);
}

/* Whether all can be written, and nothing is lost by it. */
static Status look_at_outputs(Importing *importing, Error *error)
{
    bool force = option_given(importing->options, OPTION_FORCE);
    Import *import = &importing->import;
    const char *scene = importing->scene;
    if (!force && !output_is_stream(scene) && file_kind(scene) == FILE_REGULAR)
        return fail(
            error, STATUS_OUTPUT,
            "'%s' is there already, and may have work of yours in it: '-o OTHER.mns' writes another scene, '--force' "
            "replaces this one",
            scene);
    TRY(output_probe(scene, error));
    importing->is_written = calloc(import->n_pictures + 1, sizeof *importing->is_written);
    if (!importing->is_written) return fail_memory(error, import->n_pictures, "the pictures of a scene");
    for (size_t i = 0; i < import->n_pictures; i++) {
        char *path = joined(importing->scene_folder, import->pictures[i].name);
        if (!path) return fail_memory(error, strlen(import->pictures[i].name), "the name of a picture");
        Status status = look_at_picture(importing, i, path, error);
        free(path);
        TRY(status);
    }
    return STATUS_OK;
}

/* What was written is added to *written, with commas. */
static Status write_all(const Importing *importing, Buf *written, Error *error)
{
    const Import *import = &importing->import;
    bool printed = strcmp(importing->scene, "-") == 0;
    for (size_t i = 0; i < import->n_pictures; i++) {
        const ImportPicture *picture = &import->pictures[i];
        if (importing->is_written[i]) continue;
        char *path = joined(importing->scene_folder, picture->name);
        if (!path) return fail_memory(error, strlen(picture->name), "the name of a picture");
        Status status = file_write(path, picture->bytes, picture->length, error);
        buf_format(written, "%s%s", written->length ? ", " : "", path);
        free(path);
        TRY(status);
    }
    if (printed) return print_out(&importing->text, error);
    buf_format(written, "%s%s", written->length ? " and " : "", importing->scene);
    return file_write(importing->scene, buf_text(&importing->text), importing->text.length, error);
}

/* Number and noun. */
static void add_count(Buf *line, size_t n, const char *one, const char *several)
{
    if (n) buf_format(line, "%s%zu %s", line->length ? ", " : "", n, n == 1 ? one : several);
}

static void report(const Importing *importing, const Buf *written)
{
    const Import *import = &importing->import;
    const Talk *talk = importing->talk;
    bool printed = strcmp(importing->scene, "-") == 0;
    size_t shown = import->n_notes <= MOST_NOTES ? import->n_notes : MOST_NOTES;
    for (size_t i = 0; i < shown; i++) talk_warning(talk, "%s", import->notes[i]);
    if (shown < import->n_notes)
        talk_warning(talk, "and %zu more, which comments of the scene tell", import->n_notes - shown);
    if (!written->length || talk->quiet) return;
    Buf counts = {0}, command = {0};
    add_count(&counts, import->n_objects, "object", "objects");
    add_count(&counts, import->n_media, "medium", "media");
    add_count(&counts, import->n_surfaces, "surface", "surfaces");
    add_count(&counts, import->n_lights, "light", "lights");
    add_count(&counts, import->n_cameras, "camera", "cameras");
    add_for_shell(&command, importing->scene);
    if (printed)
        talk_event(talk, "done", "wrote %s", buf_text(written));
    else
        talk_event(talk, "done", "wrote %s: %s; to see it: meniscus %s", buf_text(written), buf_text(&counts),
                   buf_text(&command));
    buf_clear(&counts);
    buf_clear(&command);
}

static void importing_clear(Importing *importing)
{
    import_clear(&importing->import);
    mesh_source_clear(&importing->source);
    mesh_free(importing->mesh);
    buf_clear(&importing->text);
    free(importing->scene);
    free(importing->scene_folder);
    free(importing->mesh_folder);
    free(importing->file);
    free(importing->folder);
    free(importing->stem);
    free(importing->is_written);
}

Status cmd_import(const Options *options, const Talk *talk, Error *error)
{
    Importing importing = {.options = options, .talk = talk, .path = options->operands[0], .source = {.whole = true}};
    const char *path = importing.path;
    if (strcasecmp(file_extension(path), "mns") == 0) return fail(error, STATUS_USAGE, "'%s' is a scene already", path);
    Status status = mesh_load(path, &importing.source, &importing.mesh, error);
    if (status == STATUS_OK) status = choose_names(&importing, error);
    if (status == STATUS_OK) {
        ImportOptions wanted = import_options(&importing);
        status = import_scene(&wanted, &importing.source, importing.mesh, &importing.import, error);
    }
    if (status == STATUS_OK) status = format(&importing, error);
    if (status == STATUS_OK) status = look_at_outputs(&importing, error);
    Buf written = {0};
    if (status == STATUS_OK) status = write_all(&importing, &written, error);
    if (status == STATUS_OK) report(&importing, &written);
    buf_clear(&written);
    importing_clear(&importing);
    return status;
}

/* diag_files_test.c - every broken scene in tests/diag reports exactly what its marks say, in exactly the words of the
 * file NAME.expected beside it, and every code of diags.def is shown by one of them.
 * Marks: "// error: slug, slug" and "// warning: slug" mean their own line; "// error-in NAME: slug" and
 * "// error-nowhere: slug" stand for reports in another text and for those without a place; "// warning-in" and
 * "// warning-nowhere" likewise; "// option: ..." sets define, set, preset, confine, or a limit: steps, nodes, memory,
 * files, calls, file_bytes; "remarks on" asks for the remarks, too, which "// remark: slug" expects.
 * The scenes in tests/diag are read with the schema of the tests, so that they do not change with the program's nodes;
 * those in tests/diag/scene are built and compiled as by `meniscus check`.
 * DIAG_ACCEPT=1 in the environment writes the .expected files anew: read them before they are kept.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <dirent.h>

#include "base/file.h"
#include "image/image.h"
#include "lang_fixture.h"
#include "scene/build.h"
#include "check/report.h"

#define FOLDER "tests/diag/"
#define SCENE_FOLDER "tests/diag/scene/"
#define CLI_FOLDER "tests/cli/"

enum { MAX_MARKS = 256, MAX_FILES = 512, MAX_DEFINES = 8 };

typedef struct Mark {
    char file[128]; /* as a report names it; "" for nowhere */
    unsigned line;  /* 0: any */
    DiagSeverity severity;
    char slug[64];
    bool met;
} Mark;

typedef struct Expectation {
    Mark marks[MAX_MARKS];
    size_t n;
    const char *defines[MAX_DEFINES], *overrides[MAX_DEFINES];
} Expectation;

/* What all files add up to. */
typedef struct Tally {
    size_t scenes, planted, missed, invented, differing;
} Tally;

static Tally tally;
static bool with_remarks; /* of the scene that is being checked */
static bool slug_seen[D_COUNT];

static void add_marks(Expectation *expected, const char *file, unsigned line, DiagSeverity severity, const char *slugs)
{
    while (*slugs) {
        slugs += strspn(slugs, " ,");
        size_t length = strspn(slugs, "abcdefghijklmnopqrstuvwxyz0123456789-");
        if (length == 0) break;
        assert_true(expected->n < MAX_MARKS && length < 64);
        Mark *mark = &expected->marks[expected->n++];
        memset(mark, 0, sizeof *mark);
        snprintf(mark->file, sizeof mark->file, "%s", file);
        mark->line = line;
        mark->severity = severity;
        memcpy(mark->slug, slugs, length);
        slugs += length;
        if (*slugs != ',') break;
    }
}

static void read_option(Run *run, Expectation *expected, const char *text)
{
    char word[32], value[128];
    if (sscanf(text, "%31s %127s", word, value) != 2) return;
    const char *kept = arena_copy_text(&run->arena, value, strlen(value));
    if (strcmp(word, "define") == 0) {
        assert_true(run->options.n_defines < MAX_DEFINES);
        expected->defines[run->options.n_defines++] = kept;
        run->options.defines = expected->defines;
    } else if (strcmp(word, "set") == 0) {
        assert_true(run->options.n_overrides < MAX_DEFINES);
        expected->overrides[run->options.n_overrides++] = kept;
        run->options.overrides = expected->overrides;
    } else if (strcmp(word, "remarks") == 0) {
        with_remarks = strcmp(value, "on") == 0;
    } else if (strcmp(word, "preset") == 0) {
        run->options.preset = kept;
    } else if (strcmp(word, "confine") == 0) {
        run->options.confine = kept;
    } else {
        uint64_t number = strtoull(value, NULL, 10);
        if (strcmp(word, "steps") == 0) run->options.limits.steps = number;
        if (strcmp(word, "nodes") == 0) run->options.limits.nodes = number;
        if (strcmp(word, "memory") == 0) run->options.limits.memory = number;
        if (strcmp(word, "files") == 0) run->options.limits.files = (uint32_t)number;
        if (strcmp(word, "calls") == 0) run->options.limits.calls = (uint32_t)number;
        if (strcmp(word, "file_bytes") == 0) run->options.limits.file_bytes = number;
    }
}

static void read_mark(Run *run, Expectation *expected, const char *path, unsigned line, const char *comment)
{
    char severity[32], file[128];
    int used = 0;
    if (strncmp(comment, "// option: ", 11) == 0) {
        read_option(run, expected, comment + 11);
    } else if (sscanf(comment, "// %31[a-z]%n", severity, &used) == 1 &&
               (strcmp(severity, "error") == 0 || strcmp(severity, "warning") == 0 ||
                strcmp(severity, "remark") == 0)) {
        DiagSeverity kind = *severity == 'e' ? DIAG_ERROR : *severity == 'w' ? DIAG_WARNING : DIAG_REMARK;
        const char *rest = comment + used;
        int behind = 0;
        if (strncmp(rest, ": ", 2) == 0) {
            add_marks(expected, path, line, kind, rest + 2);
        } else if (strncmp(rest, "-nowhere: ", 10) == 0) {
            add_marks(expected, "", 0, kind, rest + 10);
        } else if (sscanf(rest, "-in %100[^:]: %n", file, &behind) == 1 && behind > 0) {
            char full[256];
            snprintf(full, sizeof full, "%s%s", *file == '-' ? "" : FOLDER, file);
            full[127] = 0;
            add_marks(expected, full, 0, kind, rest + behind);
        }
    }
}

static void read_marks(Run *run, Expectation *expected, const char *path)
{
    char *text;
    size_t length;
    assert_int_equal(file_read(path, 0, &text, &length, NULL), STATUS_OK);
    unsigned line = 1;
    for (char *at = text; *at; line++) {
        size_t n = strcspn(at, "\n");
        bool last = at[n] == 0;
        at[n] = 0;
        for (char *comment = strstr(at, "// "); comment; comment = strstr(comment + 3, "// "))
            read_mark(run, expected, path, line, comment);
        if (last) break;
        at += n + 1;
    }
    free(text);
}

static bool meets(Run *run, Mark *mark, const Diagnostic *report)
{
    if (mark->met || mark->severity != report->severity || strcmp(mark->slug, diag_slug(report->code)) != 0)
        return false;
    if (!report->has_span) return mark->file[0] == 0;
    if (strcmp(mark->file, run->sources.sources[report->span.source].name) != 0) return false;
    return mark->line == 0 ||
           mark->line == source_position(&run->sources, report->span.source, report->span.begin).line;
}

static void compare_marks(Run *run, Expectation *expected)
{
    for (const Diagnostic *report = run->diag.first; report; report = report->next) {
        bool found = false;
        slug_seen[report->code] = true;
        for (size_t i = 0; i < expected->n && !found; i++)
            if (meets(run, &expected->marks[i], report)) found = expected->marks[i].met = true;
        tally.invented += !found;
    }
    for (size_t i = 0; i < expected->n; i++) {
        const Mark *mark = &expected->marks[i];
        tally.planted++;
        if (mark->met) continue;
        tally.missed++;
        print_error("%s:%u: expected %s, which was not reported\n", mark->file, mark->line, mark->slug);
    }
}

/* ---- the printed text ---- */

/* Is reports what NAME.expected says? With DIAG_ACCEPT, it becomes so. */
static bool is_expected_text(const char *path, const char *reports)
{
    char name[256], *text = NULL;
    size_t length;
    snprintf(name, sizeof name, "%.*sexpected", (int)(strlen(path) - 3), path);
    if (getenv("DIAG_ACCEPT")) {
        FILE *file = fopen(name, "w");
        assert_non_null(file);
        fputs(reports, file);
        fclose(file);
        return true;
    }
    if (!file_exists(name)) {
        print_error("%s: there is no %s\n", path, name);
        return false;
    }
    assert_int_equal(file_read(name, 0, &text, &length, NULL), STATUS_OK);
    bool same = strcmp(text, reports) == 0;
    if (!same) print_error("%s: the printed text differs from %s, which says:\n%s\n", path, name, text);
    free(text);
    return same;
}

/* ---- running ---- */

static Status load_image(void *context, const char *path, const char *space, float **rgb, uint32_t *width,
                         uint32_t *height, Error *error)
{
    (void)context, (void)space, (void)width, (void)height;
    Image image = {0};
    *rgb = NULL;
    TRY(image_read(path, &image, error));
    image_clear(&image);
    return (fail)(error, STATUS_INPUT, "'%s' is not for this test", path);
}

/* as `meniscus check` does */
static void scene_task(void *context)
{
    Run *run = context;
    SceneOptions options = {.eval = run->options, .load_image = load_image};
    options.eval.frame = options.eval.frames = 1;
    Scene *scene = NULL;
    CompiledScene *compiled = NULL;
    run->status = scene_build(run->path, &options, &run->diag, &scene, NULL, &run->error);
    if (run->status == STATUS_OK)
        run->status = compile_scene(scene, scene->render.nesting, NULL, &run->diag, &compiled, &run->error);
    if (run->status == STATUS_OK && run->diag.n_errors == 0) {
        report_warnings(compiled, NULL, &run->diag);
        run->status = report_mesh_crossings(compiled, NULL, &run->diag, &run->error);
        if (with_remarks) report_remarks(compiled, &run->diag);
    }
    compiled_scene_free(compiled);
    scene_free(scene);
}

static void check_file(const char *path)
{
    Run run;
    static Expectation expected;
    memset(&expected, 0, sizeof expected);
    run_open(&run);
    run.diag.limit = MAX_MARKS;
    with_remarks = false;
    read_marks(&run, &expected, path);
    run.path = path;
    if (strncmp(path, SCENE_FOLDER, strlen(SCENE_FOLDER)) == 0)
        run.out_of_memory = !arena_guard(&run.arena, scene_task, &run);
    else
        run_go(&run);
    assert_false(run.out_of_memory);
    Tally before = tally;
    compare_marks(&run, &expected);
    char *reports = run_reports(&run);
    tally.scenes++;
    tally.differing += !is_expected_text(path, reports);
    if (tally.missed + tally.invented + tally.differing > before.missed + before.invented + before.differing)
        print_error("%s reported:\n%s\n", path, reports);
    free(reports);
    run_close(&run);
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void check_folder(const char *name)
{
    DIR *folder = opendir(name);
    if (!folder) fail_msg("run this from the top of the source tree: there is no %s", name);
    static char *paths[MAX_FILES];
    size_t n = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (strcmp(file_extension(entry->d_name), "mns") != 0) continue;
        assert_true(n < MAX_FILES);
        size_t size = strlen(name) + strlen(entry->d_name) + 1;
        paths[n] = malloc(size);
        assert_non_null(paths[n]);
        snprintf(paths[n++], size, "%s%s", name, entry->d_name);
    }
    closedir(folder);
    qsort(paths, n, sizeof paths[0], compare_names);
    for (size_t i = 0; i < n; i++) {
        check_file(paths[i]);
        free(paths[i]);
    }
}

static void test_all_files(void **state)
{
    (void)state;
    check_folder(FOLDER);
    check_folder(SCENE_FOLDER);
    printf("%zu broken scenes with %zu planted mistakes: %zu missed, %zu "
           "invented, %zu of the texts differ\n",
           tally.scenes, tally.planted, tally.missed, tally.invented, tally.differing);
    assert_true(tally.scenes >= 100);
    assert_int_equal(tally.missed, 0);
    assert_int_equal(tally.invented, 0);
    assert_int_equal(tally.differing, 0);
}

/* Does a test of the command line ask for the code, as "[slug]"? */
static bool shown_by_command_line(DiagCode code)
{
    DIR *folder = opendir(CLI_FOLDER);
    assert_non_null(folder);
    char path[512], wanted[80];
    snprintf(wanted, sizeof wanted, "[%s]", diag_slug(code));
    bool found = false;
    for (struct dirent *entry; !found && (entry = readdir(folder));) {
        if (strcmp(file_extension(entry->d_name), "sh") != 0) continue;
        char *text;
        size_t length;
        snprintf(path, sizeof path, CLI_FOLDER "%s", entry->d_name);
        assert_int_equal(file_read(path, 0, &text, &length, NULL), STATUS_OK);
        found = strstr(text, wanted) != NULL;
        free(text);
    }
    closedir(folder);
    return found;
}

/* Every code occurs in some broken scene, or in a test of the command line where it takes more than a scene. */
static void test_all_codes(void **state)
{
    (void)state;
    int missing = 0;
    for (int code = 0; code < D_COUNT; code++)
        if (!slug_seen[code] && !shown_by_command_line((DiagCode)code)) {
            print_error("no scene in " FOLDER " or " SCENE_FOLDER " shows %s, nor does a test in " CLI_FOLDER "\n",
                        diag_slug((DiagCode)code));
            missing++;
        }
    assert_int_equal(missing, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_files),
        cmocka_unit_test(test_all_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

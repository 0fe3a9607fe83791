/* diag_files_test.c - every broken scene in tests/diag reports exactly what its marks say.
 * Marks: "// error: slug, slug" and "// warning: slug" mean their own line; "// error-in NAME: slug" and
 * "// error-nowhere: slug" stand for reports in another text and for those without a place; "// option: ..." sets
 * define, preset, confine, steps, nodes or memory. Where NAME.expected stands beside NAME.mns, the whole printed text
 * must match as well.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <dirent.h>

#include "base/file.h"
#include "lang_fixture.h"

#define FOLDER "tests/diag/"

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
    const char *defines[MAX_DEFINES];
} Expectation;

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
    } else if (strcmp(word, "preset") == 0) {
        run->options.preset = kept;
    } else if (strcmp(word, "confine") == 0) {
        run->options.confine = kept;
    } else {
        uint64_t number = strtoull(value, NULL, 10);
        if (strcmp(word, "steps") == 0) run->options.limits.steps = number;
        if (strcmp(word, "nodes") == 0) run->options.limits.nodes = number;
        if (strcmp(word, "memory") == 0) run->options.limits.memory = number;
    }
}

static void read_mark(Run *run, Expectation *expected, const char *path, unsigned line, const char *comment)
{
    char file[128];
    int used = 0;
    if (strncmp(comment, "// error: ", 10) == 0) {
        add_marks(expected, path, line, DIAG_ERROR, comment + 10);
    } else if (strncmp(comment, "// warning: ", 12) == 0) {
        add_marks(expected, path, line, DIAG_WARNING, comment + 12);
    } else if (strncmp(comment, "// error-nowhere: ", 18) == 0) {
        add_marks(expected, "", 0, DIAG_ERROR, comment + 18);
    } else if (sscanf(comment, "// error-in %100[^:]: %n", file, &used) == 1 && used > 0) {
        char full[256];
        snprintf(full, sizeof full, "%s%s", strcmp(file, "-D") == 0 ? "" : FOLDER, file);
        full[127] = 0;
        add_marks(expected, full, 0, DIAG_ERROR, comment + used);
    } else if (strncmp(comment, "// option: ", 11) == 0) {
        read_option(run, expected, comment + 11);
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
    if (mark->met || mark->severity != report->severity || strcmp(mark->slug, diag_slug(report->code)) != 0) return false;
    if (!report->has_span) return mark->file[0] == 0;
    if (strcmp(mark->file, run->sources.sources[report->span.source].name) != 0) return false;
    return mark->line == 0 || mark->line == source_position(&run->sources, report->span.source, report->span.begin).line;
}

static int compare_marks(Run *run, Expectation *expected)
{
    int wrong = 0;
    for (const Diagnostic *report = run->diag.first; report; report = report->next) {
        bool found = false;
        slug_seen[report->code] = true;
        for (size_t i = 0; i < expected->n && !found; i++)
            if (meets(run, &expected->marks[i], report)) found = expected->marks[i].met = true;
        if (!found) wrong++;
    }
    return wrong;
}

static char *read_expected(const char *path)
{
    char name[256], *text;
    size_t length;
    snprintf(name, sizeof name, "%.*sexpected", (int)(strlen(path) - 3), path);
    if (!file_exists(name)) return NULL;
    assert_int_equal(file_read(name, 0, &text, &length, NULL), STATUS_OK);
    return text;
}

static int check_file(const char *path)
{
    Run run;
    static Expectation expected;
    memset(&expected, 0, sizeof expected);
    run_open(&run);
    run.diag.limit = MAX_MARKS;
    read_marks(&run, &expected, path);
    run.path = path;
    run_go(&run);
    int wrong = compare_marks(&run, &expected);
    for (size_t i = 0; i < expected.n; i++)
        if (!expected.marks[i].met) {
            wrong++;
            print_error("%s:%u: expected %s, which was not reported\n", expected.marks[i].file, expected.marks[i].line,
                        expected.marks[i].slug);
        }
    char *reports = run_reports(&run), *text = read_expected(path);
    if (text && strcmp(text, reports) != 0) {
        wrong++;
        print_error("%s: the printed text differs from its .expected\n", path);
    }
    if (wrong) print_error("%s reported:\n%s\n", path, reports);
    free(text);
    free(reports);
    run_close(&run);
    return wrong;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void test_all_files(void **state)
{
    (void)state;
    DIR *folder = opendir(FOLDER);
    if (!folder) fail_msg("run this from the top of the source tree: there is no %s", FOLDER);
    static char *paths[MAX_FILES];
    size_t n = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (strcmp(file_extension(entry->d_name), "mns") != 0) continue;
        assert_true(n < MAX_FILES);
        size_t size = strlen(FOLDER) + strlen(entry->d_name) + 1;
        paths[n] = malloc(size);
        assert_non_null(paths[n]);
        snprintf(paths[n++], size, "%s%s", FOLDER, entry->d_name);
    }
    closedir(folder);
    qsort(paths, n, sizeof paths[0], compare_names);
    assert_true(n >= 30);
    int wrong = 0;
    for (size_t i = 0; i < n; i++) {
        wrong += check_file(paths[i]);
        free(paths[i]);
    }
    assert_int_equal(wrong, 0);
}

/* The codes of the language itself must all occur in some file; those of the scene are for its own tests. */
static void test_all_codes(void **state)
{
    (void)state;
    int missing = 0;
    for (int code = 0; code < D_OPEN_MESH; code++)
        if (!slug_seen[code] && code != D_FILE_UNREADABLE) {
            print_error("no file in %s shows %s\n", FOLDER, diag_slug((DiagCode)code));
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

/* mutation_test.c - one small slip in a right scene is reported once, and near the slip. Each token of the examples
 * is dropped, written twice, swapped with its neighbour, or misspelt. What the mistake costs is counted: how many
 * reports there are (more than one are a cascade), and whether the first one, or a note of it, stands near the slip.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <dirent.h>

#include "base/file.h"
#include "base/hash.h"
#include "lang/lex.h"
#include "lang_fixture.h"
#include "scene/build.h"

enum { MOST_TOKENS = 20000, PER_KIND = 400, NEAR_LINES = 1 };

typedef enum Mutation { DROP, DOUBLE, SWAP, MISSPELL, BRACKET, N_MUTATIONS } Mutation;

static const char *const mutation_names[N_MUTATIONS] = {"a token dropped", "a token doubled", "two tokens swapped",
                                                        "a word misspelt", "a bracket dropped"};

typedef struct Figures {
    unsigned made, refused, reports, one, many, near;
} Figures;

static Figures figures[N_MUTATIONS];

typedef struct Text {
    char *bytes;
    size_t length;
    Token tokens[MOST_TOKENS];
    size_t n;
} Text;

static void quiet_run(Run *run, const char *text)
{
    run_open(run);
    run->options.schema = scene_schema();
    run->options.limits = (EvalLimits){.steps = 2000000, .nodes = 200000, .memory = 200 << 20};
    run->diag.limit = 1000;
    run->text = text;
    run_go(run);
}

static void read_tokens(Text *text, const char *path)
{
    Run run;
    assert_int_equal(file_read(path, 0, &text->bytes, &text->length, NULL), STATUS_OK);
    run_open(&run);
    SymbolTable symbols;
    symbol_table_init(&symbols, &run.arena);
    uint32_t source = source_add(&run.sources, path, path, text->bytes, text->length);
    Lexer lexer;
    lexer_init(&lexer, &run.diag, &symbols, source);
    for (text->n = 0; text->n < MOST_TOKENS; text->n++)
        if ((text->tokens[text->n] = lexer_next(&lexer)).kind == TOKEN_END) break;
    run_close(&run);
}

static unsigned line_at(const char *text, size_t at)
{
    unsigned line = 1;
    for (size_t i = 0; i < at; i++) line += text[i] == '\n';
    return line;
}

static bool is_bracket(const Token *token)
{
    return token->kind >= TOKEN_BRACE_OPEN && token->kind <= TOKEN_BRACKET_CLOSE;
}

static bool is_near(Run *run, bool has_span, Span span, unsigned wanted)
{
    unsigned line = has_span ? source_position(&run->sources, span.source, span.begin).line : 0;
    return line + NEAR_LINES >= wanted && line <= wanted + NEAR_LINES;
}

/* The text with token i mutated, malloc'd; NULL when that mutation does not apply. */
static char *mutate(const Text *text, Mutation kind, size_t i, uint64_t random)
{
    const Token *token = &text->tokens[i], *next = &text->tokens[i + 1];
    size_t begin = token->begin, end = token->end, length = end - begin;
    Buf out = {0};
    if ((kind == BRACKET) != is_bracket(token) && (kind == BRACKET || kind == DROP)) return NULL;
    if (kind == MISSPELL && (token->kind != TOKEN_NAME || length < 4)) return NULL;
    if (kind == SWAP && i + 2 > text->n) return NULL;
    buf_add_bytes(&out, text->bytes, begin);
    switch (kind) {
    case DOUBLE:
        buf_add_bytes(&out, text->bytes + begin, length);
        buf_add(&out, " ");
        buf_add_bytes(&out, text->bytes + begin, length);
        break;
    case SWAP:
        buf_add_bytes(&out, text->bytes + next->begin, next->end - next->begin);
        buf_add_bytes(&out, text->bytes + end, next->begin - end);
        buf_add_bytes(&out, text->bytes + begin, length);
        end = next->end;
        break;
    case MISSPELL: { /* without one of its letters, not the first */
        size_t letter = 1 + (size_t)(random % (length - 1));
        buf_add_bytes(&out, text->bytes + begin, letter);
        buf_add_bytes(&out, text->bytes + begin + letter + 1, length - letter - 1);
        break;
    }
    default: buf_add(&out, " "); break;
    }
    buf_add_bytes(&out, text->bytes + end, text->length - end);
    assert_false(out.failed);
    return out.text;
}

static void measure(const Text *text, Mutation kind, size_t i, uint64_t random)
{
    char *mutated = mutate(text, kind, i, random);
    if (!mutated) return;
    Run run;
    quiet_run(&run, mutated);
    Figures *sum = &figures[kind];
    sum->made++;
    if (run.diag.n_errors) {
        diag_sort(&run.diag);
        unsigned wanted = line_at(text->bytes, text->tokens[i].begin), n = run.diag.n_errors;
        bool near = false;
        for (const Diagnostic *report = run.diag.first; report && !near; report = report->next) {
            if (report->severity != DIAG_ERROR) continue;
            near = is_near(&run, report->has_span, report->span, wanted);
            for (const DiagNote *note = report->notes; note && !near; note = note->next)
                near = is_near(&run, note->has_span, note->span, wanted);
            break;
        }
        sum->refused++;
        sum->reports += n;
        sum->one += n == 1;
        sum->many += n > 3;
        sum->near += near;
        const char *show = getenv("MUTATION_SHOW"); /* to look at the worst */
        if (show && ((*show == 'f' && !near) || (*show == 'm' && n > 1))) {
            char *reports = run_reports(&run);
            printf("---- %s: %.*s, line %u: %u reports\n%.1500s\n", mutation_names[kind],
                   (int)(text->tokens[i].end - text->tokens[i].begin), text->bytes + text->tokens[i].begin, wanted, n,
                   reports);
            free(reports);
        }
    }
    run_close(&run);
    free(mutated);
}

static void measure_scene(const char *path)
{
    static Text text;
    Run run;
    read_tokens(&text, path);
    quiet_run(&run, text.bytes);
    bool fine = run.status == STATUS_OK && !run.diag.n_errors && text.n < MOST_TOKENS;
    run_close(&run);
    for (int kind = 0; fine && kind < N_MUTATIONS; kind++)
        for (uint32_t k = 0; k < PER_KIND; k++) {
            uint64_t random = hash_u64(((uint64_t)kind << 32) + k);
            measure(&text, (Mutation)kind, 2 + (size_t)(random % (text.n - 2)), random >> 20); /* behind the header */
        }
    free(text.bytes);
}

static void test_mutations(void **state)
{
    (void)state;
    DIR *folder = opendir("examples");
    if (!folder) fail_msg("run this from the top of the source tree");
    char path[512];
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (strcmp(file_extension(entry->d_name), "mns") != 0) continue;
        snprintf(path, sizeof path, "examples/%s", entry->d_name);
        measure_scene(path);
    }
    closedir(folder);
    Figures all = {0};
    for (int kind = 0; kind < N_MUTATIONS; kind++) {
        const Figures *f = &figures[kind];
        assert_true(f->refused > 0);
        printf("%-19s %5u refused of %5u; %.2f reports each; one: %3.0f %%; over "
               "3: %2.0f %%; first within %d line: %3.0f %%\n",
               mutation_names[kind], f->refused, f->made, (double)f->reports / f->refused, 100.0 * f->one / f->refused,
               100.0 * f->many / f->refused, NEAR_LINES, 100.0 * f->near / f->refused);
        all.refused += f->refused;
        all.reports += f->reports;
        all.one += f->one;
        all.near += f->near;
    }
    printf("all: %.2f reports each; one: %.0f %%; first within %d line: %.0f %%\n", (double)all.reports / all.refused,
           100.0 * all.one / all.refused, NEAR_LINES, 100.0 * all.near / all.refused);
    assert_true(all.reports <= 1.15 * all.refused);
    assert_true(all.near >= .97 * all.refused);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_mutations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* resolve_exports.c - names that a file in use does not have, and which of its names may be meant.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/suggest.h"
#include "lang/habits.h"
#include "lang/resolve.h"

enum { MOST_LISTED = 12, MOST_HOLDERS = 6 };

typedef struct Exports {
    Resolver *resolver;
    Diagnostic *report;
    const char *file; /* "std/media.mns" */
    const char **names;
    size_t n;
} Exports;

static bool is_of_library(const Exports *exports)
{
    return strncmp(exports->file, "std/", 4) == 0;
}

/* Is the word a whole part of the name, as glass is of clear_glass? */
static bool is_part(const char *name, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = strstr(name, word); at; at = strstr(at + 1, word))
        if ((at == name || at[-1] == '_') && (at[length] == 0 || at[length] == '_')) return true;
    return false;
}

static bool holds(const char *name, const char *word)
{
    return strstr(name, word) != NULL;
}

static bool is_same(const char *name, const char *word)
{
    return strcmp(name, word) == 0;
}

/* Hints at all names that are so to the word, where they are few. */
static bool hint_at_names(const Exports *exports, const char *word, bool (*fits)(const char *name, const char *word))
{
    const char *found[MOST_HOLDERS];
    size_t n = 0;
    for (size_t i = exports->n; i-- > 0;) { /* the last one declared is the first */
        if (!fits(exports->names[i], word)) continue;
        if (n == MOST_HOLDERS) return false;
        found[n++] = arena_format(exports->resolver->arena, "'%s'", exports->names[i]);
    }
    if (n == 0) return false;
    diag_hint(exports->resolver->diag, exports->report, "did you mean %s?",
              suggest_list(exports->resolver->arena, found, n, "or"));
    return true;
}

/* Other words for what a file of the library has. */
static bool hint_at_synonym(const Exports *exports, const char *word)
{
    const char *names = is_of_library(exports) ? habit_export(exports->file, word) : NULL;
    if (!names) return false;
    const char *quoted[MOST_HOLDERS];
    size_t n = 0;
    for (; *names && n < MOST_HOLDERS; names += strspn(names, " ")) {
        size_t length = strcspn(names, " ");
        quoted[n++] = arena_format(exports->resolver->arena, "'%.*s'", (int)length, names);
        names += length;
    }
    diag_hint(exports->resolver->diag, exports->report, "did you mean %s?",
              suggest_list(exports->resolver->arena, quoted, n, "or"));
    return true;
}

static bool hint_at_nearest(const Exports *exports, const char *word)
{
    const char *nearest = suggest_nearest(word, exports->names, exports->n);
    if (nearest) diag_hint(exports->resolver->diag, exports->report, "did you mean '%s'?", nearest);
    return nearest != NULL;
}

/* The last word says what it is: a flower_vase is a vase. */
static bool hint_at_kind(const Exports *exports, const char *word)
{
    for (const char *end = strchr(word, '_'); end; end = strchr(end + 1, '_'))
        if (hint_at_synonym(exports, end + 1) || hint_at_names(exports, end + 1, is_same)) return true;
    const char *last = strrchr(word, '_');
    return last && hint_at_names(exports, last + 1, is_part);
}

/* What is none of this file: of another one of the library, or written in another way. */
static bool hint_elsewhere(const Exports *exports, const char *word)
{
    if (!is_of_library(exports)) return false;
    if (hint_at_library(exports->resolver, exports->report, word, true)) return true;
    const char *text = habit_word(word), *node = text ? NULL : habit_node(word);
    if (text) diag_hint(exports->resolver->diag, exports->report, "write: %s", text);
    if (node) diag_hint(exports->resolver->diag, exports->report, "%s", node);
    return text || node;
}

static void hint_at_all(const Exports *exports)
{
    const char *end = strrchr(exports->file, '.');
    Diag *diag = exports->resolver->diag;
    if (is_of_library(exports) && end) {
        diag_hint(diag, exports->report, "'meniscus help %.*s' lists what it has", (int)(end - exports->file),
                  exports->file);
    } else if (exports->n > 0 && exports->n <= MOST_LISTED) {
        diag_hint(diag, exports->report, "it has %s",
                  suggest_list(exports->resolver->arena, exports->names, exports->n, "and"));
    }
}

void report_not_exported(Resolver *resolver, Span span, const File *file, const Symbol *symbol)
{
    const char *name = resolver->diag->sources->sources[file->source].name, *word = symbol->text;
    Exports exports = {.resolver = resolver, .file = name, .n = file->n_exports};
    exports.report = diag_report(resolver->diag, D_UNKNOWN_NAME, span, "'%s' has no '%s'", name, word);
    exports.names = arena_alloc(resolver->arena, (exports.n + 1) * sizeof *exports.names);
    for (size_t i = 0; i < exports.n; i++) exports.names[i] = file->exports[i].symbol->text;
    if (!hint_at_synonym(&exports, word) && !hint_at_names(&exports, word, is_part) &&
        !hint_at_nearest(&exports, word) && !hint_at_kind(&exports, word) && !hint_at_names(&exports, word, holds) &&
        !hint_elsewhere(&exports, word))
        hint_at_all(&exports);
}

/* diag.c - the sink: keeps reports, drops repetitions, counts what is beyond the limit.
 * SPDX-License-Identifier: Apache-2.0 */
#include "diag/diag.h"

#include <stdio.h>
#include <string.h>

#include "diag/suggest.h"

enum { DEFAULT_LIMIT = 20 };

static const struct {
    DiagSeverity severity;
    const char *slug, *cause, *cure;
} diag_table[] = {
#define DIAG(name, severity, slug, cause, cure) {severity, slug, cause, cure},
#include "diag/diags.def"
#undef DIAG
};

void diag_init(Diag *diag, Arena *arena, SourceSet *sources)
{
    *diag = (Diag){.arena = arena, .sources = sources, .limit = DEFAULT_LIMIT};
}

const char *diag_slug(DiagCode code)
{
    return diag_table[code].slug;
}
const char *diag_cause(DiagCode code)
{
    return diag_table[code].cause;
}
const char *diag_cure(DiagCode code)
{
    return diag_table[code].cure;
}
DiagSeverity diag_severity(DiagCode code)
{
    return diag_table[code].severity;
}

const char *diag_severity_text(DiagSeverity severity)
{
    static const char *const texts[] = {"error", "warning", "remark"};
    return texts[severity];
}

static const char *format_text(Arena *arena, const char *format, va_list args) ATTR_PRINTF(2, 0);

static const char *format_text(Arena *arena, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, format, again);
    va_end(again);
    size_t size = (size_t)(length < 0 ? 0 : length) + 1;
    char *text = arena_alloc(arena, size);
    vsnprintf(text, size, format, args);
    return text;
}

static Diagnostic *find_repetition(const Diag *diag, const Diagnostic *wanted)
{
    for (Diagnostic *d = diag->first; d; d = d->next)
        if (d->code == wanted->code && d->has_span == wanted->has_span && d->span.source == wanted->span.source &&
            d->span.begin == wanted->span.begin && strcmp(d->text, wanted->text) == 0)
            return d;
    return NULL;
}

static Diagnostic *keep(Diag *diag, Diagnostic *report)
{
    report->severity = diag_table[report->code].severity;
    if (diag->warnings_are_errors && report->severity == DIAG_WARNING) report->severity = DIAG_ERROR;
    report->chain = diag->chain;
    if (find_repetition(diag, report)) return report; /* hints for it go to the copy that is not kept */
    uint32_t *const counts[] = {&diag->n_errors, &diag->n_warnings, &diag->n_remarks};
    uint32_t *count = counts[report->severity];
    if (++*count > diag->limit) return report;
    if (diag->last)
        diag->last->next = report;
    else
        diag->first = report;
    diag->last = report;
    return report;
}

Diagnostic *diag_report(Diag *diag, DiagCode code, Span span, const char *format, ...)
{
    Diagnostic *report = ARENA_NEW(diag->arena, Diagnostic);
    report->code = code;
    report->has_span = true;
    report->span = span;
    va_list args;
    va_start(args, format);
    report->text = format_text(diag->arena, format, args);
    va_end(args);
    return keep(diag, report);
}

Diagnostic *diag_report_nowhere(Diag *diag, DiagCode code, const char *format, ...)
{
    Diagnostic *report = ARENA_NEW(diag->arena, Diagnostic);
    report->code = code;
    va_list args;
    va_start(args, format);
    report->text = format_text(diag->arena, format, args);
    va_end(args);
    return keep(diag, report);
}

void diag_hint(Diag *diag, Diagnostic *report, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    report->hint = format_text(diag->arena, format, args);
    va_end(args);
}

static void add_note(Diagnostic *report, DiagNote *note)
{
    DiagNote **end = &report->notes;
    while (*end) end = &(*end)->next;
    *end = note;
}

void diag_note(Diag *diag, Diagnostic *report, Span span, const char *format, ...)
{
    DiagNote *note = ARENA_NEW(diag->arena, DiagNote);
    note->has_span = true;
    note->span = span;
    va_list args;
    va_start(args, format);
    note->text = format_text(diag->arena, format, args);
    va_end(args);
    add_note(report, note);
}

void diag_note_nowhere(Diag *diag, Diagnostic *report, const char *format, ...)
{
    DiagNote *note = ARENA_NEW(diag->arena, DiagNote);
    va_list args;
    va_start(args, format);
    note->text = format_text(diag->arena, format, args);
    va_end(args);
    add_note(report, note);
}

void diag_suggest(Diag *diag, Diagnostic *report, const char *wrong, const char *const *candidates, size_t n)
{
    const char *nearest = suggest_nearest(wrong, candidates, n);
    if (nearest) diag_hint(diag, report, "did you mean '%s'?", nearest);
}

static int compare_places(const Diagnostic *a, const Diagnostic *b)
{
    if (a->has_span != b->has_span) return a->has_span ? -1 : 1;
    if (a->span.source != b->span.source) return a->span.source < b->span.source ? -1 : 1;
    if (a->span.begin != b->span.begin) return a->span.begin < b->span.begin ? -1 : 1;
    return 0;
}

/* a stable merge sort of the list */
static Diagnostic *sorted(Diagnostic *list)
{
    if (!list || !list->next) return list;
    Diagnostic *slow = list;
    for (Diagnostic *fast = list->next; fast && fast->next; fast = fast->next->next) slow = slow->next;
    Diagnostic *b = slow->next, *head = NULL, **tail = &head;
    slow->next = NULL;
    Diagnostic *a = sorted(list);
    b = sorted(b);
    while (a && b) {
        Diagnostic **least = compare_places(b, a) < 0 ? &b : &a;
        *tail = *least;
        tail = &(*tail)->next;
        *least = (*least)->next;
    }
    *tail = a ? a : b;
    return head;
}

void diag_sort(Diag *diag)
{
    diag->first = sorted(diag->first);
    diag->last = diag->first;
    while (diag->last && diag->last->next) diag->last = diag->last->next;
}

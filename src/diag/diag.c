/* diag.c - the sink: keeps reports, drops repetitions, counts what is beyond the limit.
 * SPDX-License-Identifier: Apache-2.0 */
#include "diag/diag.h"

#include <string.h>

#include "diag/limits.h"
#include "base/suggest.h"

enum { MOST_LISTED = 12 }; /* words in a note of what there is */

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
    *diag = (Diag){.arena = arena, .sources = sources, .limit = LIMIT_ERRORS_SHOWN};
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

/* What one call leads to in the library follows from the first error there. */
static bool is_consequence(const Diagnostic *first, const Diagnostic *report)
{
    return first->in_library && report->in_library && first->severity == DIAG_ERROR && report->severity == DIAG_ERROR;
}

static Diagnostic *find_repetition(const Diag *diag, const Diagnostic *wanted)
{
    for (Diagnostic *d = diag->first; d; d = d->next)
        if (d->has_span == wanted->has_span && span_same_place(d->span, wanted->span) &&
            ((d->code == wanted->code && strcmp(d->text, wanted->text) == 0) || is_consequence(d, wanted)))
            return d;
    return NULL;
}

/* ---- places ---- */

Span diag_author_place(const SourceSet *sources, Span span, const DiagChain *chain)
{
    const DiagChain *link = chain;
    if (!sources->sources[span.source].library) return span;
    while (link && sources->sources[link->span.source].library) link = link->outer;
    return link ? link->span : span;
}

/* ---- frames ---- */

/* Frames come in rising order; runs with one step between them are one entry. */
static void add_frames(Arena *arena, Diagnostic *report, uint32_t first, uint32_t last, uint32_t step)
{
    DiagFrames *end = report->last_frames;
    if (end && first <= end->last) return;
    bool joins = end && step == 0 && (end->step == 0 || first - end->last == end->step);
    if (joins) {
        end->step = first - end->last;
        end->last = first;
        return;
    }
    DiagFrames *frames = ARENA_NEW(arena, DiagFrames);
    *frames = (DiagFrames){NULL, first, last, step};
    if (end)
        end->next = frames;
    else
        report->frames = frames;
    report->last_frames = frames;
}

/* ---- reporting ---- */

static uint32_t *count_of(Diag *diag, DiagSeverity severity)
{
    uint32_t *const counts[] = {&diag->n_errors, &diag->n_warnings, &diag->n_remarks};
    return counts[severity];
}

static const char *copy_text(Arena *arena, const char *text)
{
    return text ? arena_copy_text(arena, text, strlen(text)) : NULL;
}

static const DiagChain *copy_chain(Arena *arena, const DiagChain *chain)
{
    const DiagChain *copy = NULL, **end = &copy;
    for (const DiagChain *link = chain; link; link = link->outer) {
        DiagChain *own = ARENA_NEW(arena, DiagChain);
        *own = (DiagChain){NULL, link->span, copy_text(arena, link->what)};
        *end = own;
        end = &own->outer;
    }
    return copy;
}

/* Puts a report at the end unless there are too many already. */
static void append(Diag *diag, Diagnostic *report)
{
    uint32_t *count = count_of(diag, report->severity);
    if (++*count > diag->limit) return;
    if (diag->last)
        diag->last->next = report;
    else
        diag->first = report;
    diag->last = report;
}

static void move_to_author(Diag *diag, Diagnostic *report)
{
    Span met = report->span;
    report->span = diag_author_place(diag->sources, met, diag->chain);
    report->in_library = report->span.source != met.source;
    if (report->in_library) diag_note(diag, report, met, "met here, in the standard library");
}

static Diagnostic *keep(Diag *diag, Diagnostic *report)
{
    report->severity = diag_table[report->code].severity;
    if (diag->warnings_are_errors && report->severity == DIAG_WARNING) report->severity = DIAG_ERROR;
    if (diag->in_frame) add_frames(diag->arena, report, diag->frame, diag->frame, 0);
    if (report->has_span) move_to_author(diag, report);
    if (find_repetition(diag, report)) return report; /* hints for it go to the copy that is not kept */
    if (*count_of(diag, report->severity) < diag->limit) report->chain = copy_chain(diag->arena, diag->chain);
    append(diag, report);
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
    report->text = arena_format_list(diag->arena, format, args);
    va_end(args);
    return keep(diag, report);
}

Diagnostic *diag_report_nowhere(Diag *diag, DiagCode code, const char *format, ...)
{
    Diagnostic *report = ARENA_NEW(diag->arena, Diagnostic);
    report->code = code;
    va_list args;
    va_start(args, format);
    report->text = arena_format_list(diag->arena, format, args);
    va_end(args);
    return keep(diag, report);
}

void diag_hint(Diag *diag, Diagnostic *report, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    report->hint = arena_format_list(diag->arena, format, args);
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
    note->text = arena_format_list(diag->arena, format, args);
    va_end(args);
    add_note(report, note);
}

void diag_note_nowhere(Diag *diag, Diagnostic *report, const char *format, ...)
{
    DiagNote *note = ARENA_NEW(diag->arena, DiagNote);
    va_list args;
    va_start(args, format);
    note->text = arena_format_list(diag->arena, format, args);
    va_end(args);
    add_note(report, note);
}

void diag_suggest(Diag *diag, Diagnostic *report, const char *wrong, const char *const *candidates, size_t n)
{
    const char *nearest = suggest_nearest(wrong, candidates, n);
    if (nearest) diag_hint(diag, report, "did you mean '%s'?", nearest);
}

void diag_suggest_or_list(Diag *diag, Diagnostic *report, const char *wrong, const char *const *candidates, size_t n,
                          const char *what)
{
    diag_suggest(diag, report, wrong, candidates, n);
    if (report->hint || n > MOST_LISTED) return;
    diag_note_nowhere(diag, report, "its %s: %s", what, n ? suggest_list(diag->arena, candidates, n, "and") : "none");
}

static int compare_places(const Diagnostic *a, const Diagnostic *b)
{
    if (a->has_span != b->has_span) return a->has_span ? -1 : 1;
    return span_compare(a->span, b->span);
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

/* Puts those reports of which that holds behind the others. */
static Diagnostic *put_last(const Diag *diag, Diagnostic *list, bool (*is_last)(const Diag *, const Diagnostic *))
{
    Diagnostic *others = NULL, **end = &others, *last = NULL, **last_end = &last;
    for (Diagnostic *report = list, *next; report; report = next) {
        Diagnostic ***where = is_last(diag, report) ? &last_end : &end;
        next = report->next;
        report->next = NULL;
        **where = report;
        *where = &report->next;
    }
    *end = last;
    return others;
}

/* What stands on the command line, as -D does, is read before the scene, of which mistakes may follow from it. */
static bool is_of_scene(const Diag *diag, const Diagnostic *report)
{
    const Source *source = report->has_span ? &diag->sources->sources[report->span.source] : NULL;
    return !source || source->path || source->name[0] != '-';
}

/* Where there are errors many names that nothing uses follow from these, and push them down. */
static bool is_unused(const Diag *diag, const Diagnostic *report)
{
    (void)diag;
    return report->code == D_UNUSED_NAME;
}

void diag_sort(Diag *diag)
{
    diag->first = put_last(diag, sorted(diag->first), is_of_scene);
    if (diag->n_errors) diag->first = put_last(diag, diag->first, is_unused);
    diag->last = diag->first;
    while (diag->last && diag->last->next) diag->last = diag->last->next;
}

/* ---- several evaluations ---- */

DiagMark diag_mark(const Diag *diag)
{
    return (DiagMark){diag->last, diag->n_errors, diag->n_warnings, diag->n_remarks, diag->sources->n};
}

void diag_rewind(Diag *diag, DiagMark mark)
{
    if (mark.last)
        mark.last->next = NULL;
    else
        diag->first = NULL;
    diag->last = mark.last;
    diag->n_errors = mark.n_errors;
    diag->n_warnings = mark.n_warnings;
    diag->n_remarks = mark.n_remarks;
    diag->sources->n = mark.n_sources;
}

static Diagnostic *copy_report(Arena *arena, const Diagnostic *report)
{
    Diagnostic *copy = ARENA_NEW(arena, Diagnostic);
    *copy = *report;
    copy->next = NULL;
    copy->text = copy_text(arena, report->text);
    copy->hint = copy_text(arena, report->hint);
    copy->notes = NULL;
    copy->frames = copy->last_frames = NULL;
    DiagNote **note_end = &copy->notes;
    for (const DiagNote *note = report->notes; note; note = note->next) {
        *note_end = ARENA_NEW(arena, DiagNote);
        **note_end = (DiagNote){NULL, note->has_span, note->span, copy_text(arena, note->text)};
        note_end = &(*note_end)->next;
    }
    copy->chain = copy_chain(arena, report->chain);
    return copy;
}

/* The same mistake: the same words, or else the same code at the same place, as words can name a frame's numbers. */
static Diagnostic *find_mistake(const Diag *diag, const Diagnostic *wanted)
{
    Diagnostic *found = find_repetition(diag, wanted);
    for (Diagnostic *d = diag->first; d && !found && wanted->has_span; d = d->next)
        if (d->code == wanted->code && d->has_span && span_same_place(d->span, wanted->span)) found = d;
    return found;
}

void diag_merge(Diag *into, const Diag *from)
{
    for (const Diagnostic *report = from->first; report; report = report->next) {
        Diagnostic *here = find_mistake(into, report);
        if (!here) {
            here = copy_report(into->arena, report);
            append(into, here);
        }
        for (const DiagFrames *frames = report->frames; frames; frames = frames->next)
            add_frames(into->arena, here, frames->first, frames->last, frames->step);
    }
    if (from->n_errors > into->n_errors) into->n_errors = from->n_errors; /* those beyond the limit */
    if (from->n_warnings > into->n_warnings) into->n_warnings = from->n_warnings;
    if (from->n_remarks > into->n_remarks) into->n_remarks = from->n_remarks;
}

bool diag_has(const Diag *diag, DiagCode code)
{
    const Diagnostic *report = diag->first;
    while (report && report->code != code) report = report->next;
    return report != NULL;
}

void diag_drop_source(Diag *diag, uint32_t source)
{
    Diagnostic **end = &diag->first;
    diag->last = NULL;
    for (Diagnostic *report = diag->first; report; report = report->next) {
        if (report->has_span && report->span.source == source) {
            --*count_of(diag, report->severity);
            continue;
        }
        *end = diag->last = report;
        end = &report->next;
    }
    *end = NULL;
}

void diag_drop_known(Diag *diag, const Diag *known)
{
    Diagnostic **end = &diag->first;
    diag->last = NULL;
    for (Diagnostic *report = diag->first; report; report = report->next) {
        if (report->severity != DIAG_ERROR && find_mistake(known, report)) {
            --*count_of(diag, report->severity);
            continue;
        }
        *end = diag->last = report;
        end = &report->next;
    }
    *end = NULL;
}

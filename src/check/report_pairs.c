/* report_pairs.c - the text of the report: where objects meet, and what they do there.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check/report_parts.h"

typedef enum LineKind { LINE_INSIDE, LINE_OVERLAP, LINE_TOUCH, LINE_GAP } LineKind;

/* One thing to say about one pair. */
typedef struct PairLine {
    LineKind kind;
    const HullPair *pair;
    ReportVerdict verdict;
    uint32_t top_group, bottom_group;
    size_t number, run; /* its own place, and that of the first of its like */
    bool summed;        /* with others of its like */
    bool follows;       /* from others: it is of what is around something that is around the inner object */
    uint32_t n_around;  /* that are left out for that, and said here */
} PairLine;

static int compare_likeness(const void *left, const void *right)
{
    const PairLine *a = left, *b = right;
    const uint32_t x[] = {a->kind, a->verdict.kind, a->verdict.rule, a->top_group, a->bottom_group};
    const uint32_t y[] = {b->kind, b->verdict.kind, b->verdict.rule, b->top_group, b->bottom_group};
    for (size_t i = 0; i < COUNT_OF(x); i++)
        if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
    return 0;
}

static int compare_lines(const void *left, const void *right)
{
    const PairLine *a = left, *b = right;
    int order = compare_likeness(a, b);
    return order ? order : a->number < b->number ? -1 : a->number > b->number;
}

static int compare_runs(const void *left, const void *right)
{
    const PairLine *a = left, *b = right;
    if (a->run != b->run) return a->run < b->run ? -1 : 1;
    return a->number < b->number ? -1 : a->number > b->number;
}

static size_t collect_lines(const CompiledScene *compiled, const ReportGroups *groups, PairLine *lines)
{
    size_t n = 0;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        PairLine line = {.pair = pair, .verdict = report_verdict(compiled, pair)};
        line.top_group = groups->of_hull[line.verdict.top];
        line.bottom_group = groups->of_hull[line.verdict.bottom];
        line.kind = !pair->overlaps ? LINE_TOUCH : pair->relation == NEST_PARTIAL ? LINE_OVERLAP : LINE_INSIDE;
        if (pair->overlaps || pair->touches) {
            line.number = n;
            lines[n++] = line;
        }
        line.kind = LINE_GAP;
        line.number = n;
        if (isfinite(pair->gap)) lines[n++] = line;
    }
    qsort(lines, n, sizeof *lines, compare_lines);
    for (size_t i = 0; i < n; i++)
        lines[i].run = i && compare_likeness(&lines[i], &lines[i - 1]) == 0 ? lines[i - 1].run : lines[i].number;
    qsort(lines, n, sizeof *lines, compare_runs);
    return n;
}

/* ---- what is around what is around ---- */

enum { FOLLOWING_STEPS = 20000000 }; /* about a tenth of a second */

static uint32_t inner_of(const HullPair *pair)
{
    return pair->relation == NEST_A_IN_B ? pair->a : pair->b;
}

static uint32_t outer_of(const HullPair *pair)
{
    return pair->relation == NEST_A_IN_B ? pair->b : pair->a;
}

static int compare_inner(const void *left, const void *right)
{
    const PairLine *a = *(PairLine *const *)left, *b = *(PairLine *const *)right;
    uint32_t x = inner_of(a->pair), y = inner_of(b->pair);
    if (x == y) x = outer_of(a->pair), y = outer_of(b->pair);
    return x < y ? -1 : x > y;
}

/* The lines of one kind, "a inside b", by the inner object: those of object k from first[k] to before first[k + 1]. */
typedef struct Insides {
    PairLine **lines;
    size_t n;
    size_t *first;
    uint8_t *around; /* of each object, for one inner one: 1 is around it, 2 is around something that is, too */
    size_t steps_left;
} Insides;

/* Only what is on top as it is the inner one, which is what one expects. */
static bool is_plain(const CompiledScene *compiled, const PairLine *line)
{
    return line->verdict.kind == VERDICT_RULE && line->verdict.rule == NEST_BY_CONTAINMENT &&
           compiled->object_of_hull[line->verdict.top] == inner_of(line->pair);
}

static void mark_following(const CompiledScene *compiled, Insides *insides, uint32_t object)
{
    size_t begin = insides->first[object], end = insides->first[object + 1];
    for (size_t i = begin; i < end; i++) insides->around[outer_of(insides->lines[i]->pair)] = 1;
    for (size_t i = begin; i < end; i++) {
        uint32_t between = outer_of(insides->lines[i]->pair);
        for (size_t k = insides->first[between]; k < insides->first[between + 1] && insides->steps_left; k++) {
            insides->steps_left--;
            uint32_t outer = outer_of(insides->lines[k]->pair);
            if (insides->around[outer]) insides->around[outer] = 2;
        }
    }
    for (size_t i = begin; i < end; i++) {
        PairLine *line = insides->lines[i];
        uint8_t *around = &insides->around[outer_of(line->pair)];
        line->follows = *around == 2 && is_plain(compiled, line);
        *around = 0;
    }
}

/* Of the lines that are not summed up. The first of the rest says how many those of its inner object are. */
static void leave_out_following(Insides *insides, uint32_t object)
{
    PairLine *kept = NULL;
    uint32_t n = 0;
    for (size_t i = insides->first[object]; i < insides->first[object + 1]; i++) {
        n += insides->lines[i]->follows;
        if (!kept && !insides->lines[i]->follows && !insides->lines[i]->summed) kept = insides->lines[i];
    }
    if (kept) kept->n_around = n;
    for (size_t i = insides->first[object]; !kept && i < insides->first[object + 1]; i++)
        insides->lines[i]->follows = false;
}

static void find_following(const CompiledScene *compiled, PairLine *lines, size_t n)
{
    uint32_t n_objects = compiled->scene->n_objects;
    Insides insides = {.lines = calloc(n + 1, sizeof *insides.lines),
                       .first = calloc(n_objects + 2, sizeof *insides.first),
                       .around = calloc(n_objects + 1, 1),
                       .steps_left = FOLLOWING_STEPS};
    if (insides.lines && insides.first && insides.around) {
        for (size_t i = 0; i < n; i++)
            if (lines[i].kind == LINE_INSIDE) insides.lines[insides.n++] = &lines[i];
        qsort(insides.lines, insides.n, sizeof *insides.lines, compare_inner);
        for (size_t i = 0; i < insides.n; i++) insides.first[inner_of(insides.lines[i]->pair) + 1] = i + 1;
        for (uint32_t k = 0; k < n_objects; k++)
            if (insides.first[k + 1] < insides.first[k]) insides.first[k + 1] = insides.first[k];
        for (uint32_t k = 0; k < n_objects; k++) mark_following(compiled, &insides, k);
        for (size_t i = 0; i < insides.n; i++)
            if (insides.lines[i]->summed) insides.lines[i]->follows = false;
        for (uint32_t k = 0; k < n_objects; k++) leave_out_following(&insides, k);
    }
    free(insides.lines);
    free(insides.first);
    free(insides.around);
}

/* ---- one line ---- */

/* ": X on top, by volume". */
static void add_reason(const CompiledScene *compiled, const ReportVerdict *verdict, const char *top, Buf *out)
{
    const Scene *scene = compiled->scene;
    uint32_t above = compiled->hulls[verdict->top].medium, below = compiled->hulls[verdict->bottom].medium;
    switch (verdict->kind) {
    case VERDICT_MERGE: buf_format(out, ": both %s, they merge\n", scene->media[above].name); return;
    case VERDICT_MIX:
        if (scene->media[above].mixes || report_adds(scene, below, above))
            buf_format(out, ": %s and %s add up\n", scene->media[below].name, scene->media[above].name);
        else
            buf_format(out, ": there is no %s in %s\n", scene->media[below].name, scene->media[above].name);
        return;
    case VERDICT_ENTERED: buf_add(out, ": the one that a ray enters last is on top\n"); return;
    case VERDICT_NO_NESTING: buf_add(out, ": each is bounded by the world's medium\n"); return;
    case VERDICT_CIRCLE: buf_format(out, ": %s on top, by volume within a circle\n", top); return;
    case VERDICT_RULE: buf_format(out, ": %s on top, by %s\n", top, nest_rule_text(verdict->rule)); return;
    }
}

/* " by 3.2 cm³"; an estimate that is not good to a tenth says so. */
static void add_overlap(const CompiledScene *compiled, double volume, double standard_error, double depth, Buf *out)
{
    buf_add(out, standard_error > 0.1 * volume ? " by about " : " by ");
    report_add_volume(out, compiled->scene, volume);
    if (!(depth > 0)) return;
    buf_add(out, ", up to ");
    report_add_length(out, compiled->scene, depth);
    buf_add(out, " thick");
}

/* " over 3.2 cm²", where it is more than a point or a line. */
static void add_area(const CompiledScene *compiled, double area, double standard_error, Buf *out)
{
    if (!(area > 2 * standard_error)) return;
    buf_add(out, standard_error > 0.1 * area ? " over about " : " over ");
    report_add_area(out, compiled->scene, area);
}

static void print_pair(const CompiledScene *compiled, const PairLine *line, Buf *out)
{
    const HullPair *pair = line->pair;
    const SceneObject *objects = compiled->scene->objects;
    const char *top = report_object(compiled, line->verdict.top)->name,
               *bottom = report_object(compiled, line->verdict.bottom)->name;
    buf_add(out, "  ");
    switch (line->kind) {
    case LINE_INSIDE:
        buf_format(out, "%s inside %s", objects[inner_of(pair)].name, objects[outer_of(pair)].name);
        if (line->n_around) buf_format(out, ", and %u more around that", (unsigned)line->n_around);
        break;
    case LINE_OVERLAP:
        buf_format(out, "%s overlaps %s", top, bottom);
        add_overlap(compiled, pair->overlap_volume, pair->overlap_volume_error, pair->overlap_depth, out);
        break;
    case LINE_TOUCH:
        buf_format(out, "%s touches %s", top, bottom);
        add_area(compiled, pair->contact_area, pair->contact_area_error, out);
        buf_add(out, "\n");
        return;
    case LINE_GAP:
        buf_format(out, "%s and %s leave a gap %s", top, bottom, pair->wedge ? "that narrows to nothing from " : "of ");
        report_add_length(out, compiled->scene, pair->wedge ? pair->gap_most : pair->gap);
        add_area(compiled, pair->gap_area, pair->gap_area_error, out);
        buf_add(out, "\n");
        return;
    }
    if (pair->touches && pair->contact_area > 2 * pair->contact_area_error) {
        buf_add(out, ", with common faces");
        add_area(compiled, pair->contact_area, pair->contact_area_error, out);
    }
    add_reason(compiled, &line->verdict, top, out);
}

static void add_group(const CompiledScene *compiled, const ReportGroup *group, Buf *out)
{
    if (group->n == 1) {
        buf_add(out, report_object(compiled, group->first.hull)->name);
        return;
    }
    buf_add_bytes(out, group->first.word, group->first.length);
    buf_format(out, " (%s)", compiled->scene->media[group->first.medium].name);
}

/* Volumes and areas added up, and the smallest gap. */
static HullPair sum_up(const PairLine *lines, size_t n)
{
    HullPair all = {.gap = HUGE_VAL};
    double volume_variance = 0, contact_variance = 0;
    for (size_t i = 0; i < n; i++) {
        const HullPair *pair = lines[i].pair;
        all.overlap_volume += pair->overlap_volume;
        all.contact_area += pair->contact_area;
        volume_variance += pair->overlap_volume_error * pair->overlap_volume_error;
        contact_variance += pair->contact_area_error * pair->contact_area_error;
        all.gap = fmin(all.gap, pair->gap);
        all.wedge = all.wedge || pair->wedge;
    }
    all.overlap_volume_error = sqrt(volume_variance);
    all.contact_area_error = sqrt(contact_variance);
    return all;
}

/* n pairs of one kind between the same two groups. */
static void print_like_pairs(const CompiledScene *compiled, const ReportGroups *groups, const PairLine *lines, size_t n,
                             Buf *out)
{
    const PairLine *first = &lines[0];
    const ReportGroup *top = &groups->items[first->top_group], *bottom = &groups->items[first->bottom_group];
    HullPair all = sum_up(lines, n);
    /* in a pair whose inner hull is not on top the words change places */
    bool top_inside = compiled->hull_of_object[inner_of(first->pair)] == first->verdict.top;
    const ReportGroup *subject = first->kind == LINE_INSIDE && !top_inside ? bottom : top;
    const ReportGroup *object = subject == top ? bottom : top;
    bool one = subject->n == 1; /* that meets many: they are what is counted */
    buf_add(out, "  ");
    if (!one) buf_format(out, "%zu × ", n);
    add_group(compiled, subject, out);
    buf_add(out, first->kind == LINE_INSIDE    ? " inside "
                 : first->kind == LINE_OVERLAP ? " overlaps "
                 : first->kind == LINE_TOUCH   ? " touches "
                                               : " leaves a gap to ");
    if (one) buf_format(out, "%zu × ", n);
    add_group(compiled, object, out);
    switch (first->kind) {
    case LINE_INSIDE: break;
    case LINE_OVERLAP:
        add_overlap(compiled, all.overlap_volume, all.overlap_volume_error, 0, out);
        buf_add(out, " together");
        break;
    case LINE_GAP:
        buf_add(out, all.wedge ? " that narrows to nothing" : " of at least ");
        if (!all.wedge) report_add_length(out, compiled->scene, all.gap);
        buf_add(out, "\n");
        return;
    case LINE_TOUCH:
        add_area(compiled, all.contact_area, all.contact_area_error, out);
        buf_add(out, "\n");
        return;
    }
    Buf name = {0};
    if (top->n == 1)
        buf_add(&name, report_object(compiled, top->first.hull)->name);
    else if (top == bottom)
        buf_format(&name, "one");
    else
        buf_format(&name, "the %.*s%s", (int)top->first.length, top->first.word,
                   top->first.length && strchr("sxz", top->first.word[top->first.length - 1]) ? "es" : "s");
    if (name.failed) out->failed = true;
    add_reason(compiled, &first->verdict, buf_text(&name), out);
    buf_clear(&name);
}

void report_others(Diag *diag, DiagCode code, uint32_t n)
{
    if (n) diag_report_nowhere(diag, code, "%u more of the same kind", (unsigned)n);
}

uint32_t report_count_places(ReportLikes *likes, Span a, Span b, size_t item)
{
    uint32_t i = 0;
    while (i < likes->n && !(span_same_place(likes->places[i][0], a) && span_same_place(likes->places[i][1], b))) i++;
    if (i == REPORT_MOST) {
        likes->n_others++;
        return i;
    }
    if (i == likes->n) {
        likes->first[i] = item;
        likes->places[i][0] = a;
        likes->places[i][1] = b;
        likes->counts[likes->n++] = 0;
    }
    likes->counts[i]++;
    return i;
}

/* How many lines from i on are of one kind. */
static size_t like_lines(const PairLine *lines, size_t n, size_t i)
{
    size_t count = 1;
    while (i + count < n && lines[i + count].run == lines[i].run) count++;
    return count;
}

void report_print_pairs(const CompiledScene *compiled, const ReportGroups *groups, Buf *out)
{
    buf_add(out, "\nWhere they meet\n");
    if (compiled->n_pairs == 0) {
        buf_add(out, "  no clear object meets another\n");
        return;
    }
    PairLine *lines = calloc(2 * compiled->n_pairs, sizeof *lines);
    if (!lines) {
        out->failed = true;
        return;
    }
    size_t n = collect_lines(compiled, groups, lines);
    for (size_t i = 0, count; i < n; i += count) {
        count = like_lines(lines, n, i);
        for (size_t k = i; k < i + count; k++) lines[k].summed = count > REPORT_FEW;
    }
    find_following(compiled, lines, n);
    for (size_t i = 0, count; i < n; i += count) {
        count = like_lines(lines, n, i);
        if (lines[i].summed)
            print_like_pairs(compiled, groups, &lines[i], count, out);
        else
            for (size_t k = i; k < i + count; k++)
                if (!lines[k].follows) print_pair(compiled, &lines[k], out);
    }
    free(lines);
}

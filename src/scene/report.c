/* report.c - what `check` says about how the objects of a scene lie: warnings, a text for people, JSON.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/report.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/num.h"
#include "base/utf8.h"
#include "scene/report_parts.h"

/* ---- numbers and words ---- */

/* Three significant digits, without exponents where people would not use them. */
static void add_figure(Buf *out, double x)
{
    double size = fabs(x);
    if (size >= 1e7 || (size > 0 && size < 1e-4))
        buf_format(out, "%.2e", x);
    else if (size >= 99.95)
        buf_format(out, "%.0f", x);
    else if (size >= 9.995)
        buf_format(out, "%.1f", x);
    else if (size >= 0.9995 || size == 0)
        buf_format(out, "%.2f", x);
    else
        buf_format(out, "%.3g", x);
}

void report_add_volume(Buf *out, const Scene *scene, double volume)
{
    static const struct {
        double from, unit; /* in cubic metres */
        const char *name;
    } units[] = {{1e-2, 1, "m³"}, {1e-7, 1e-6, "cm³"}, {1e-13, 1e-9, "mm³"}, {0, 1e-18, "µm³"}};
    double m3 = volume * scene->unit_m * scene->unit_m * scene->unit_m;
    size_t i = 0;
    while (i + 1 < COUNT_OF(units) && !(m3 >= units[i].from)) i++;
    if (m3 == 0) i = 1;
    add_figure(out, m3 / units[i].unit);
    buf_format(out, " %s", units[i].name);
}

void report_add_length(Buf *out, const Scene *scene, double length)
{
    static const struct {
        double from, unit; /* in metres */
        const char *name;
    } units[] = {{1, 1, "m"}, {1e-5, 1e-3, "mm"}, {1e-7, 1e-6, "µm"}, {0, 1e-9, "nm"}};
    double m = length * scene->unit_m;
    size_t i = 0;
    while (i + 1 < COUNT_OF(units) && !(m >= units[i].from)) i++;
    add_figure(out, m / units[i].unit);
    buf_format(out, " %s", units[i].name);
}

static const char *state_text(NestState state)
{
    static const char *const texts[] = {"", "liquid", "gas", "solid"};
    return texts[state];
}

/* The length of a name without the number behind it: "sphere" of "sphere 12". */
static size_t word_length(const char *name)
{
    size_t n = strlen(name), k = n;
    while (k > 0 && isdigit((unsigned char)name[k - 1])) k--;
    return k < n && k > 1 && name[k - 1] == ' ' ? k - 1 : n;
}

/* ---- groups of like objects ---- */

static int compare_words(const void *left, const void *right)
{
    const ReportMember *a = left, *b = right;
    if (a->medium != b->medium) return a->medium < b->medium ? -1 : 1;
    if (a->length != b->length) return a->length < b->length ? -1 : 1;
    int order = memcmp(a->word, b->word, a->length);
    return order ? order : a->hull < b->hull ? -1 : a->hull > b->hull;
}

bool report_groups_init(ReportGroups *groups, const CompiledScene *compiled)
{
    uint32_t n = compiled->n_hulls;
    *groups = (ReportGroups){.of_hull = calloc(n ? n : 1, sizeof *groups->of_hull),
                             .items = calloc(n ? n : 1, sizeof *groups->items)};
    ReportMember *members = calloc(n ? n : 1, sizeof *members);
    if (!groups->of_hull || !groups->items || !members) {
        free(members);
        return false;
    }
    for (uint32_t h = 0; h < n; h++) {
        const char *name = compiled->scene->objects[compiled->object_of_hull[h]].name;
        members[h] = (ReportMember){name, word_length(name), compiled->hulls[h].medium, h};
    }
    qsort(members, n, sizeof *members, compare_words);
    for (uint32_t i = 0; i < n; i++) {
        const ReportMember *m = &members[i], *before = i ? &members[i - 1] : NULL;
        bool same = before && before->medium == m->medium && before->length == m->length &&
                    memcmp(before->word, m->word, m->length) == 0;
        if (!same) groups->items[groups->n++] = (ReportGroup){.first = *m, .least = HUGE_VAL};
        ReportGroup *group = &groups->items[groups->n - 1];
        double volume = compiled->hulls[m->hull].volume;
        group->n++;
        group->least = fmin(group->least, volume);
        group->most = fmax(group->most, volume);
        group->sum += volume;
        groups->of_hull[m->hull] = groups->n - 1;
    }
    free(members);
    return true;
}

void report_groups_clear(ReportGroups *groups)
{
    free(groups->of_hull);
    free(groups->items);
    *groups = (ReportGroups){0};
}

/* ---- which of a pair is on top, and why ---- */

ReportVerdict report_verdict(const CompiledScene *compiled, const HullPair *pair)
{
    uint32_t a = compiled->hull_of_object[pair->a], b = compiled->hull_of_object[pair->b];
    const NestHull *hulls = compiled->hulls;
    const NestOrder *order = &compiled->order;
    ReportVerdict verdict = {.top = b, .bottom = a};
    if (order->policy == NEST_NONE || order->policy == NEST_ENTERED) {
        if (pair->relation == NEST_A_IN_B) verdict = (ReportVerdict){.top = a, .bottom = b};
        verdict.kind = order->policy == NEST_NONE ? VERDICT_NO_NESTING : VERDICT_ENTERED;
        return verdict;
    }
    bool a_on_top = order->rank[a] > order->rank[b];
    verdict = (ReportVerdict){.top = a_on_top ? a : b, .bottom = a_on_top ? b : a, .kind = VERDICT_RULE};
    if (hulls[a].medium == hulls[b].medium) {
        verdict.kind = VERDICT_MERGE;
    } else if (order->policy == NEST_PRIORITY) {
        verdict.rule = hulls[a].priority != hulls[b].priority ? NEST_BY_PRIORITY : NEST_BY_DECLARATION;
    } else {
        NestOverlap overlap = {a, b, pair->relation};
        NestDecision decision = nest_decide(hulls, &overlap);
        verdict.rule = decision.rule;
        if (decision.top != verdict.top) verdict.kind = VERDICT_CIRCLE;
    }
    return verdict;
}

/* ---- the text: a table ---- */

static unsigned text_width(const char *text)
{
    unsigned width = 0;
    for (size_t n = strlen(text); n > 0;) {
        uint32_t code;
        size_t used = utf8_decode(text, n, &code);
        width += utf8_width(code);
        text += used;
        n -= used;
    }
    return width;
}

/* Rows of cells; the columns are as wide as their widest cell. */
enum { COLUMNS_MAX = 6 };
typedef struct Table {
    Buf *cells; /* rows * n_columns */
    size_t n_rows, capacity;
    unsigned n_columns;
    bool right[COLUMNS_MAX]; /* flush right */
    Buf spare[COLUMNS_MAX];  /* the row when memory has ended */
    bool failed;
} Table;

static Buf *table_row(Table *table)
{
    size_t n = (table->n_rows + 1) * table->n_columns;
    if (n > table->capacity) {
        size_t capacity = 2 * n;
        Buf *grown = realloc(table->cells, capacity * sizeof *grown);
        if (!grown) {
            table->failed = true;
            return table->spare;
        }
        table->cells = grown;
        table->capacity = capacity;
    }
    Buf *row = table->cells + table->n_rows++ * table->n_columns;
    for (unsigned i = 0; i < table->n_columns; i++) row[i] = (Buf){0};
    return row;
}

static void table_print(Table *table, Buf *out)
{
    unsigned width[COLUMNS_MAX] = {0};
    for (size_t i = 0; i < table->n_rows * table->n_columns; i++) {
        unsigned w = text_width(buf_text(&table->cells[i])), column = (unsigned)(i % table->n_columns);
        if (w > width[column]) width[column] = w;
    }
    for (size_t row = 0; row < table->n_rows; row++) {
        size_t pending = 2; /* blanks are written only before text, so that lines do not end in them */
        for (unsigned column = 0; column < table->n_columns; column++) {
            Buf *cell = &table->cells[row * table->n_columns + column];
            unsigned blank = width[column] - text_width(buf_text(cell));
            if (cell->length) {
                buf_add_repeat(out, ' ', pending + (table->right[column] ? blank : 0));
                buf_add(out, buf_text(cell));
                pending = table->right[column] ? 0 : blank;
            } else {
                pending += width[column];
            }
            if (width[column]) pending += 2;
            buf_clear(cell);
        }
        buf_add(out, "\n");
    }
    if (table->failed) out->failed = true;
    for (unsigned i = 0; i < COLUMNS_MAX; i++) buf_clear(&table->spare[i]);
    free(table->cells);
}

/* ---- the text: media and hulls ---- */

static void print_medium(const Scene *scene, uint32_t i, Buf *row)
{
    const SceneMedium *medium = &scene->media[i];
    buf_add(&row[0], medium->name);
    buf_format(&row[1], "index %.4g", (double)spectrum_at_one(&medium->ior, 589.3f));
    if (medium->disperses)
        buf_format(&row[2], "%.4g .. %.4g, 700 to 400 nm", (double)spectrum_at_one(&medium->ior, 700),
                   (double)spectrum_at_one(&medium->ior, 400));
    buf_add(&row[3], state_text(medium->state));
    if (medium->absorbs) {
        static const struct {
            const char *name;
            float nm;
        } lights[] = {{"red", 620}, {"green", 540}, {"blue", 450}};
        size_t most = 0;
        for (size_t k = 1; k < COUNT_OF(lights); k++)
            if (spectrum_at_one(&medium->absorption, lights[k].nm) >
                spectrum_at_one(&medium->absorption, lights[most].nm))
                most = k;
        double coefficient = (double)spectrum_at_one(&medium->absorption, lights[most].nm);
        buf_add(&row[4], "absorbs");
        if (coefficient > 0) {
            bool grey = spectrum_is_constant(&medium->absorption);
            buf_format(&row[4], " half of %s light within ", grey ? "all" : lights[most].name);
            report_add_length(&row[4], scene, 0.6931471805599453 / coefficient);
        }
    }
    if (medium->has_priority) buf_format(&row[5], "priority %d", (int)medium->priority);
    if (i == 0) buf_format(&row[5], "%sthe world", row[5].length ? ", " : "");
}

static void print_media(const Scene *scene, Buf *out)
{
    Table table = {.n_columns = 6};
    buf_add(out, "Media\n");
    for (uint32_t i = 0; i < scene->n_media; i++) {
        bool used = i == 0;
        for (uint32_t k = 0; k < scene->n_objects && !used; k++) used = scene->objects[k].medium == i;
        if (used) print_medium(scene, i, table_row(&table));
    }
    table_print(&table, out);
}

static void add_place(Buf *out, SourceSet *sources, Span span)
{
    if (!sources || span.source >= sources->n) return;
    SourcePosition place = source_position(sources, span.source, span.begin);
    buf_format(out, "%s:%u", sources->sources[span.source].name, (unsigned)place.line);
}

static void print_hull(const CompiledScene *compiled, SourceSet *sources, uint32_t hull, Buf *row)
{
    const SceneObject *object = &compiled->scene->objects[compiled->object_of_hull[hull]];
    buf_add(&row[1], object->name);
    buf_add(&row[2], compiled->scene->media[object->medium].name);
    report_add_volume(&row[3], compiled->scene, object->volume);
    if (object->priority) buf_format(&row[4], "priority %d", (int)object->priority);
    add_place(&row[5], sources, object->span);
}

static void print_hull_group(const CompiledScene *compiled, const ReportGroup *group, Buf *row)
{
    buf_format(&row[0], "%u ×", (unsigned)group->n);
    buf_add_bytes(&row[1], group->first.word, group->first.length);
    buf_add(&row[2], compiled->scene->media[group->first.medium].name);
    report_add_volume(&row[3], compiled->scene, group->sum);
    buf_add(&row[4], "together");
}

static void print_hulls(const CompiledScene *compiled, const ReportGroups *groups, SourceSet *sources, Buf *out)
{
    Table table = {.n_columns = 6, .right = {[0] = true, [3] = true}};
    uint32_t n = compiled->n_hulls;
    uint32_t *by_rank = calloc(n ? n : 1, sizeof *by_rank);
    bool *done = calloc(groups->n ? groups->n : 1, sizeof *done);
    if (!by_rank || !done) out->failed = true;
    NestPolicy policy = compiled->order.policy;
    bool ordered = policy == NEST_AUTOMATIC || policy == NEST_PRIORITY;
    buf_format(out, "\nClear objects%s, nesting = %s\n", ordered ? " from top to bottom" : "",
               nest_policy_text(policy));
    if (n == 0) buf_add(out, "  none\n");
    for (uint32_t h = 0; by_rank && h < n; h++) by_rank[n - 1 - compiled->order.rank[h]] = h;
    for (uint32_t i = 0; by_rank && done && i < n; i++) {
        uint32_t hull = ordered ? by_rank[i] : i, number = groups->of_hull[hull];
        const ReportGroup *group = &groups->items[number];
        if (group->n <= REPORT_FEW)
            print_hull(compiled, sources, hull, table_row(&table));
        else if (!done[number])
            print_hull_group(compiled, group, table_row(&table));
        done[number] = true;
    }
    free(by_rank);
    free(done);
    table_print(&table, out);
}

/* ---- the text: pairs ---- */

typedef enum LineKind { LINE_INSIDE, LINE_OVERLAP, LINE_TOUCH, LINE_GAP } LineKind;

/* One thing to say about one pair. */
typedef struct PairLine {
    LineKind kind;
    const HullPair *pair;
    ReportVerdict verdict;
    uint32_t top_group, bottom_group;
    size_t number, run; /* its own place, and that of the first of its like */
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

/* ": X on top, by volume". */
static void add_reason(const CompiledScene *compiled, const ReportVerdict *verdict, const char *top, Buf *out)
{
    switch (verdict->kind) {
    case VERDICT_MERGE:
        buf_format(out, ": both %s, they merge\n", compiled->scene->media[compiled->hulls[verdict->top].medium].name);
        return;
    case VERDICT_ENTERED: buf_add(out, ": the one that a ray enters last is on top\n"); return;
    case VERDICT_NO_NESTING: buf_add(out, ": each is bounded by the world's medium\n"); return;
    case VERDICT_CIRCLE: buf_format(out, ": %s on top, by volume within a circle\n", top); return;
    case VERDICT_RULE: buf_format(out, ": %s on top, by %s\n", top, nest_rule_text(verdict->rule)); return;
    }
}

static const char *object_name(const CompiledScene *compiled, uint32_t hull)
{
    return compiled->scene->objects[compiled->object_of_hull[hull]].name;
}

/* "by 3.2 cm³"; an estimate that is not good to a tenth says so. */
static void add_overlap(const CompiledScene *compiled, double volume, double standard_error, Buf *out)
{
    buf_add(out, standard_error > 0.1 * volume ? " by about " : " by ");
    report_add_volume(out, compiled->scene, volume);
}

static void print_pair(const CompiledScene *compiled, const PairLine *line, Buf *out)
{
    const HullPair *pair = line->pair;
    uint32_t inner = pair->relation == NEST_A_IN_B ? pair->a : pair->b, outer = inner == pair->a ? pair->b : pair->a;
    const char *top = object_name(compiled, line->verdict.top), *bottom = object_name(compiled, line->verdict.bottom);
    buf_add(out, "  ");
    switch (line->kind) {
    case LINE_INSIDE:
        buf_format(out, "%s inside %s", compiled->scene->objects[inner].name, compiled->scene->objects[outer].name);
        break;
    case LINE_OVERLAP:
        buf_format(out, "%s overlaps %s", top, bottom);
        add_overlap(compiled, pair->overlap_volume, pair->overlap_volume_error, out);
        break;
    case LINE_TOUCH: buf_format(out, "%s touches %s\n", top, bottom); return;
    case LINE_GAP:
        buf_format(out, "%s and %s leave a gap of ", top, bottom);
        report_add_length(out, compiled->scene, pair->gap);
        buf_add(out, "\n");
        return;
    }
    add_reason(compiled, &line->verdict, top, out);
}

static void add_group(const CompiledScene *compiled, const ReportGroup *group, Buf *out)
{
    if (group->n == 1) {
        buf_add(out, object_name(compiled, group->first.hull));
        return;
    }
    buf_add_bytes(out, group->first.word, group->first.length);
    buf_format(out, " (%s)", compiled->scene->media[group->first.medium].name);
}

/* n pairs of one kind between the same two groups. */
static void print_like_pairs(const CompiledScene *compiled, const ReportGroups *groups, const PairLine *lines, size_t n,
                             Buf *out)
{
    const PairLine *first = &lines[0];
    const ReportGroup *top = &groups->items[first->top_group], *bottom = &groups->items[first->bottom_group];
    double volume = 0, variance = 0, gap = HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        volume += lines[i].pair->overlap_volume;
        variance += lines[i].pair->overlap_volume_error * lines[i].pair->overlap_volume_error;
        gap = fmin(gap, lines[i].pair->gap);
    }
    /* in a pair whose inner hull is not on top the words change places */
    uint32_t inner = first->pair->relation == NEST_A_IN_B ? first->pair->a : first->pair->b;
    bool top_inside = compiled->hull_of_object[inner] == first->verdict.top;
    const ReportGroup *subject = first->kind == LINE_INSIDE && !top_inside ? bottom : top;
    const ReportGroup *object = subject == top ? bottom : top;
    buf_format(out, "  %zu × ", n);
    add_group(compiled, subject, out);
    buf_add(out, first->kind == LINE_INSIDE    ? " inside "
                 : first->kind == LINE_OVERLAP ? " overlaps "
                 : first->kind == LINE_TOUCH   ? " touches "
                                               : " leaves a gap to ");
    add_group(compiled, object, out);
    if (first->kind == LINE_GAP) {
        buf_add(out, " of at least ");
        report_add_length(out, compiled->scene, gap);
    }
    if (first->kind == LINE_OVERLAP) {
        add_overlap(compiled, volume, sqrt(variance), out);
        buf_add(out, " together");
    }
    if (first->kind == LINE_TOUCH || first->kind == LINE_GAP) {
        buf_add(out, "\n");
        return;
    }
    Buf name = {0};
    if (top->n == 1)
        buf_add(&name, object_name(compiled, top->first.hull));
    else if (top == bottom)
        buf_format(&name, "one");
    else
        buf_format(&name, "the %.*s%s", (int)top->first.length, top->first.word,
                   top->first.length && strchr("sxz", top->first.word[top->first.length - 1]) ? "es" : "s");
    if (name.failed) out->failed = true;
    add_reason(compiled, &first->verdict, buf_text(&name), out);
    buf_clear(&name);
}

static void print_pairs(const CompiledScene *compiled, const ReportGroups *groups, Buf *out)
{
    buf_add(out, "\nWhere they meet\n");
    if (compiled->n_pairs == 0) {
        buf_add(out, "  nowhere\n");
        return;
    }
    PairLine *lines = calloc(2 * compiled->n_pairs, sizeof *lines);
    if (!lines) {
        out->failed = true;
        return;
    }
    size_t n = collect_lines(compiled, groups, lines);
    for (size_t i = 0, count; i < n; i += count) {
        for (count = 1; i + count < n && lines[i + count].run == lines[i].run;) count++;
        if (count > REPORT_FEW)
            print_like_pairs(compiled, groups, &lines[i], count, out);
        else
            for (size_t k = 0; k < count; k++) print_pair(compiled, &lines[i + k], out);
    }
    free(lines);
}

void report_print(const CompiledScene *compiled, SourceSet *sources, Buf *out)
{
    ReportGroups groups;
    if (report_groups_init(&groups, compiled)) {
        print_media(compiled->scene, out);
        print_hulls(compiled, &groups, sources, out);
        print_pairs(compiled, &groups, out);
    } else {
        out->failed = true;
    }
    report_groups_clear(&groups);
}

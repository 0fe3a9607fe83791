/* report.c - what `check` says about how the objects of a scene lie: warnings, a text for people, JSON.
 * SPDX-License-Identifier: Apache-2.0 */
#include "check/report.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check/report_parts.h"

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

/* A unit and the least amount that it is used for, in metres to the power that the quantity has. */
typedef struct Unit {
    double from, size;
    const char *name;
} Unit;

/* The last of the units is for everything below; `zero` for nothing at all. */
static void add_amount(Buf *out, double amount, const Unit *units, size_t n, size_t zero)
{
    size_t i = 0;
    while (i + 1 < n && !(amount >= units[i].from)) i++;
    if (amount == 0) i = zero;
    add_figure(out, amount / units[i].size);
    buf_format(out, " %s", units[i].name);
}

void report_add_volume(Buf *out, const Scene *scene, double volume)
{
    static const Unit units[] = {{1e-2, 1, "m³"}, {1e-7, 1e-6, "cm³"}, {1e-13, 1e-9, "mm³"}, {0, 1e-18, "µm³"}};
    if (isinf(volume)) {
        buf_add(out, "no end");
        return;
    }
    add_amount(out, volume * scene->unit_m * scene->unit_m * scene->unit_m, units, COUNT_OF(units), 1);
}

void report_add_area(Buf *out, const Scene *scene, double area)
{
    static const Unit units[] = {{1e-1, 1, "m²"}, {1e-5, 1e-4, "cm²"}, {1e-9, 1e-6, "mm²"}, {0, 1e-12, "µm²"}};
    add_amount(out, area * scene->unit_m * scene->unit_m, units, COUNT_OF(units), 1);
}

void report_add_length(Buf *out, const Scene *scene, double length)
{
    static const Unit units[] = {{1, 1, "m"}, {1e-5, 1e-3, "mm"}, {1e-7, 1e-6, "µm"}, {0, 1e-9, "nm"}};
    add_amount(out, length * scene->unit_m, units, COUNT_OF(units), COUNT_OF(units) - 1);
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

const SceneObject *report_object(const CompiledScene *compiled, uint32_t hull)
{
    return &compiled->scene->objects[compiled->object_of_hull[hull]];
}

/* ---- which of a pair is on top, and why ---- */

bool report_adds(const Scene *scene, uint32_t mixing, uint32_t owner)
{
    return scene_mixing_state(&scene->media[mixing], false) == scene_mixing_state(&scene->media[owner], owner == 0);
}

bool report_goes_on_in(const CompiledScene *compiled, const HullPair *pair, uint32_t hull)
{
    const uint32_t a = compiled->hull_of_object[pair->a], b = compiled->hull_of_object[pair->b];
    const NestHull *hulls = compiled->hulls;
    if (!pair->overlaps || hulls[a].medium != hulls[b].medium) return false;
    if (pair->relation == (hull == a ? NEST_A_IN_B : NEST_B_IN_A)) return true;
    /* of hulls that coincide neither is said to be within the other one; what they share is an estimate */
    return hulls[a].volume == hulls[b].volume &&
           memcmp(&compiled->hull_bounds[a], &compiled->hull_bounds[b], sizeof compiled->hull_bounds[a]) == 0 &&
           pair->overlap_volume + 4 * pair->overlap_volume_error >= hulls[a].volume;
}

ReportVerdict report_verdict(const CompiledScene *compiled, const HullPair *pair)
{
    uint32_t a = compiled->hull_of_object[pair->a], b = compiled->hull_of_object[pair->b];
    const NestHull *hulls = compiled->hulls;
    const NestOrder *order = &compiled->order;
    ReportVerdict verdict = {.top = b, .bottom = a};
    if (hulls[a].mixes || hulls[b].mixes)
        return hulls[a].mixes ? (ReportVerdict){.top = b, .bottom = a, .kind = VERDICT_MIX}
                              : (ReportVerdict){.top = a, .bottom = b, .kind = VERDICT_MIX};
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

/* ---- the text: media and hulls ---- */

/* Of gases, by which light is bent by how much they differ from 1, with more digits. */
static void add_index(Buf *row, double index)
{
    buf_format(row, "index %.*g", fabs(index - 1) < 0.01 ? 7 : 4, index);
}

static void print_medium(const Scene *scene, uint32_t i, Buf *row)
{
    const SceneMedium *medium = &scene->media[i];
    buf_add(&row[0], medium->name);
    if (medium->mixes)
        buf_add(&row[1], "mixes");
    else
        add_index(&row[1], (double)spectrum_at_one(&medium->ior, SCENE_INDEX_NM));
    if (medium->refracts_doubly)
        buf_format(&row[1], " and %.4g", (double)spectrum_at_one(&medium->extraordinary, SCENE_INDEX_NM));
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
        buf_add(&row[4], medium->pleochroic ? "pleochroic, absorbs" : "absorbs");
        if (coefficient > 0) {
            bool grey = spectrum_is_constant(&medium->absorption);
            buf_format(&row[4], " half of %s light within ", grey ? "all" : lights[most].name);
            report_add_length(&row[4], scene, 0.6931471805599453 / coefficient);
        }
    }
    if (medium->scatters) {
        buf_format(&row[4], "%sscatters", row[4].length ? ", " : "");
        double coefficient = (double)spectrum_at_one(&medium->scattering, 540);
        if (coefficient > 0) {
            buf_add(&row[4], " every ");
            report_add_length(&row[4], scene, 1 / coefficient);
        }
    }
    if (medium->emits) buf_format(&row[4], "%sshines", row[4].length ? ", " : "");
    if (medium->density) buf_format(&row[4], ", by a density up to %.3g", (double)medium->density->largest);
    if (medium->has_priority) buf_format(&row[5], "priority %d", (int)medium->priority);
    if (i == 0) buf_format(&row[5], "%sthe world", row[5].length ? ", " : "");
}

static void print_media(const Scene *scene, Buf *out)
{
    ReportTable table = {.n_columns = 6};
    bool *used = calloc(scene->n_media, sizeof *used);
    buf_add(out, "Media\n");
    if (!used) out->failed = true;
    for (uint32_t k = 0; used && k < scene->n_objects; k++) {
        const uint32_t row = scene->objects[k].medium;
        if (row == SCENE_NONE) continue;
        const uint32_t from = scene->media[row].turned_from; /* a crystal is said once, whichever ways it lies */
        used[from == SCENE_NONE ? row : from] = true;
    }
    for (uint32_t i = 0; used && i < scene->n_media; i++)
        if (i == 0 || used[i]) print_medium(scene, i, report_row(&table));
    free(used);
    report_print_table(&table, out);
}

void report_print(const CompiledScene *compiled, SourceSet *sources, Buf *out)
{
    ReportGroups groups;
    if (report_groups_init(&groups, compiled)) {
        print_media(compiled->scene, out);
        report_print_hulls(compiled, &groups, sources, out);
        report_print_pairs(compiled, &groups, out);
    } else {
        out->failed = true;
    }
    report_groups_clear(&groups);
}

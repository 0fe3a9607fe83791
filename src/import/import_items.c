/* import_items.c - what becomes an object of the scene: the triangles of one node (or object, group, solid) and one material.
 * Of each it is found out how large it is and whether it is closed, as it will be when the scene is built.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/array.h"
#include "import/import_parts.h"
#include "lang/value.h"

enum { KEY = 3 }; /* the last parts of a run say what it belongs to: object, mesh or group, and material */

typedef struct SortedRun {
    uint32_t key[KEY];
    uint32_t run;
} SortedRun;

static int compare_runs(const void *left, const void *right)
{
    const SortedRun *a = left, *b = right;
    for (int i = 0; i < KEY; i++)
        if (a->key[i] != b->key[i]) return a->key[i] < b->key[i] ? -1 : 1;
    return a->run < b->run ? -1 : a->run > b->run;
}

static bool same_key(const SortedRun *a, const SortedRun *b)
{
    return memcmp(a->key, b->key, sizeof a->key) == 0;
}

static bool is_of_kind(const Importer *im, uint32_t part, const char *kind)
{
    return part != IMPORT_NONE && strcmp(im->source->parts[part].kind, kind) == 0;
}

static SortedRun *sort_runs(const Importer *im, bool by_material)
{
    const MeshSource *source = im->source;
    SortedRun *sorted = malloc((source->n_runs + 1) * sizeof *sorted);
    for (size_t i = 0; sorted && i < source->n_runs; i++) {
        const MeshRun *run = &source->runs[i];
        const uint32_t *parts = &source->run_parts[run->first_part];
        sorted[i] = (SortedRun){{IMPORT_NONE, IMPORT_NONE, IMPORT_NONE}, (uint32_t)i};
        for (uint32_t k = 0; k < KEY && k < run->n_parts; k++) {
            uint32_t part = parts[run->n_parts - 1 - k];
            if (!by_material || is_of_kind(im, part, "material")) sorted[i].key[k] = part;
        }
    }
    if (sorted) qsort(sorted, source->n_runs, sizeof *sorted, compare_runs);
    return sorted;
}

static size_t count_items(const SortedRun *sorted, size_t n)
{
    size_t count = n > 0;
    for (size_t i = 1; i < n; i++) count += !same_key(&sorted[i], &sorted[i - 1]);
    return count;
}

/* The number of a part of that kind, or IMPORT_NONE. */
static uint32_t part_of_kind(const Importer *im, const uint32_t *parts, uint32_t n, const char *kind)
{
    for (uint32_t i = n; i > 0; i--)
        if (is_of_kind(im, parts[i - 1], kind)) return parts[i - 1];
    return IMPORT_NONE;
}

static const char *const owner_kinds[] = {"object", "group", "solid"};

/* What an item is called after. */
static uint32_t owner_of(const Importer *im, const ImportItem *item)
{
    for (size_t i = 0; i < COUNT_OF(owner_kinds); i++) {
        uint32_t part = part_of_kind(im, item->parts, item->n_parts, owner_kinds[i]);
        if (part != IMPORT_NONE) return part;
    }
    return IMPORT_NONE;
}

static uint32_t find_material_of(const Importer *im, const ImportItem *item)
{
    uint32_t part = part_of_kind(im, item->parts, item->n_parts, "material");
    if (part == IMPORT_NONE) return IMPORT_NONE;
    const MeshMaterial *material = mesh_source_material_of(im->source, &im->source->parts[part]);
    return material ? (uint32_t)(material - im->source->materials) : IMPORT_NONE;
}

/* ---- their triangles ---- */

typedef struct Gatherer {
    uint32_t *new_number; /* of the whole mesh's vertices; IMPORT_NONE: not in the item's */
    uint32_t *used;       /* those that are */
    uint32_t n_used;
    size_t *first_triangle; /* of each run */
} Gatherer;

static void gatherer_clear(Gatherer *gatherer)
{
    free(gatherer->new_number);
    free(gatherer->used);
    free(gatherer->first_triangle);
}

static bool gatherer_make(const Importer *im, Gatherer *gatherer)
{
    const MeshSource *source = im->source;
    size_t n = (size_t)im->mesh->n_vertices + 1;
    gatherer->new_number = malloc(n * sizeof *gatherer->new_number);
    gatherer->used = malloc(n * sizeof *gatherer->used);
    gatherer->first_triangle = malloc((source->n_runs + 1) * sizeof *gatherer->first_triangle);
    if (!gatherer->new_number || !gatherer->used || !gatherer->first_triangle) return false;
    memset(gatherer->new_number, 0xff, n * sizeof *gatherer->new_number);
    size_t at = 0;
    for (size_t i = 0; i < source->n_runs; at += (size_t)source->runs[i++].n_triangles)
        gatherer->first_triangle[i] = at;
    return true;
}

static void take_triangles(const Importer *im, Gatherer *gatherer, size_t first, size_t n, Mesh *mesh)
{
    for (size_t i = first; i < first + n; i++, mesh->n_triangles++)
        for (int k = 0; k < 3; k++) {
            uint32_t vertex = im->mesh->triangles[i][k], *number = &gatherer->new_number[vertex];
            if (*number == IMPORT_NONE) {
                *number = gatherer->n_used;
                gatherer->used[gatherer->n_used++] = vertex;
            }
            mesh->triangles[mesh->n_triangles][k] = *number;
        }
}

/* A mesh of the item's triangles alone, from the runs first to before end; without runs of all. */
static Status gather(const Importer *im, Gatherer *gatherer, const SortedRun *first, const SortedRun *end, size_t n,
                     Mesh **out)
{
    Mesh *mesh;
    gatherer->n_used = 0;
    TRY(mesh_new(1, (uint32_t)n, false, false, &mesh, im->error));
    mesh->n_triangles = 0;
    if (first == end) take_triangles(im, gatherer, 0, n, mesh);
    for (const SortedRun *run = first; run < end; run++)
        take_triangles(im, gatherer, gatherer->first_triangle[run->run], im->source->runs[run->run].n_triangles, mesh);
    free(mesh->positions);
    mesh->n_vertices = gatherer->n_used;
    mesh->positions = calloc((size_t)mesh->n_vertices + 1, sizeof *mesh->positions);
    for (uint32_t i = 0; i < gatherer->n_used; i++) {
        if (mesh->positions) mesh->positions[i] = im->mesh->positions[gatherer->used[i]];
        gatherer->new_number[gatherer->used[i]] = IMPORT_NONE;
    }
    *out = mesh;
    if (mesh->positions) return STATUS_OK;
    mesh_free(mesh);
    return fail_memory(im->error, gatherer->n_used * sizeof *mesh->positions, "a mesh");
}

/* Closed as it is, or by what the building of a scene mends. */
static Status inspect(const Importer *im, Mesh *mesh, ImportItem *item)
{
    MeshReport report;
    MeshJoin join;
    TRY(mesh_inspect_joined(mesh, &join, &report, im->error));
    if (!report.closed && !report.consistent && report.finite) {
        bool mended;
        TRY(mesh_orient(mesh, NULL, &mended, im->error));
        if (mended) TRY(mesh_inspect(mesh, NULL, &report, im->error));
    }
    if (!im->mesh->normals) TRY(mesh_is_rounded(mesh, IMPORT_CREASE_DEGREES * MEN_DEGREE, &item->rounded, im->error));
    item->closed = report.closed;
    item->n_open_edges = report.n_open_edges;
    item->volume = fabs(report.volume);
    item->area = report.area;
    item->box = report.bounds;
    return STATUS_OK;
}

static Status find_item(Importer *im, Gatherer *gatherer, const SortedRun *first, const SortedRun *end)
{
    ImportItem *item = &im->items[im->n_items++];
    *item = (ImportItem){.called = "", .material = IMPORT_NONE, .n_triangles = im->mesh->n_triangles};
    if (first < end) {
        const MeshRun *run = &im->source->runs[first->run];
        item->parts = &im->source->run_parts[run->first_part];
        item->n_parts = run->n_parts;
        item->n_triangles = 0;
        for (const SortedRun *at = first; at < end; at++) item->n_triangles += im->source->runs[at->run].n_triangles;
        item->material = find_material_of(im, item);
        uint32_t owner =
            im->by_material ? part_of_kind(im, item->parts, item->n_parts, "material") : owner_of(im, item);
        if (owner != IMPORT_NONE) item->called = im->source->parts[owner].name;
        item->first_run = first->run;
    }
    Mesh *mesh;
    TRY(gather(im, gatherer, first, end, item->n_triangles, &mesh));
    Status status = inspect(im, mesh, item);
    mesh_free(mesh);
    return status;
}

static int compare_items(const void *left, const void *right)
{
    const ImportItem *a = left, *b = right;
    return a->first_run < b->first_run ? -1 : a->first_run > b->first_run;
}

static Status find_items(Importer *im, const SortedRun *sorted)
{
    size_t n = im->source->n_runs, n_items = n ? count_items(sorted, n) : 1;
    Gatherer gatherer = {0};
    im->items = calloc(n_items, sizeof *im->items);
    Status status = im->items && gatherer_make(im, &gatherer)
                        ? STATUS_OK
                        : fail_memory(im->error, im->mesh->n_vertices * sizeof(uint32_t), "the objects of a scene");
    if (status == STATUS_OK && n == 0) status = find_item(im, &gatherer, sorted, sorted);
    for (size_t from = 0, to; status == STATUS_OK && from < n; from = to) {
        for (to = from + 1; to < n && same_key(&sorted[to], &sorted[from]);) to++;
        status = find_item(im, &gatherer, sorted + from, sorted + to);
    }
    gatherer_clear(&gatherer);
    if (status == STATUS_OK) qsort(im->items, im->n_items, sizeof *im->items, compare_items); /* as in the file */
    return status;
}

Status import_list_items(Importer *im)
{
    uint64_t n_triangles = 0;
    for (size_t i = 0; i < im->source->n_runs; i++) n_triangles += im->source->runs[i].n_triangles;
    if (im->source->n_runs && n_triangles != im->mesh->n_triangles)
        return fail_memory(im->error, im->source->n_runs * sizeof(MeshRun), "the parts of a mesh");
    SortedRun *sorted = sort_runs(im, false);
    if (sorted && count_items(sorted, im->source->n_runs) > IMPORT_MOST_OBJECTS) {
        im->by_material = true;
        free(sorted);
        sorted = sort_runs(im, true);
    }
    if (!sorted) return fail_memory(im->error, im->source->n_runs * sizeof *sorted, "the objects of a scene");
    Status status = find_items(im, sorted);
    free(sorted);
    return status;
}

/* ---- what `part` selects them ---- */

typedef struct Asked {
    char *items[4];
    size_t n;
} Asked;

static void asked_clear(Asked *asked)
{
    for (size_t i = 0; i < asked->n; i++) free(asked->items[i]);
    asked->n = 0;
}

static void ask(Asked *asked, const char *kind, const char *name)
{
    Buf text = {0};
    buf_format(&text, "%s%s%s", kind, *kind ? ":" : "", name);
    if (text.text) asked->items[asked->n++] = text.text;
}

static bool selects(const Importer *im, const Asked *asked, const ImportItem *item)
{
    for (size_t i = 0; i < asked->n; i++)
        if (!mesh_parts_are(im->source, item->parts, item->n_parts, asked->items[i])) return false;
    return true;
}

/* Whether it is just this item. */
static bool is_exact(const Importer *im, const Asked *asked, const ImportItem *item)
{
    for (size_t i = 0; i < asked->n; i++)
        if (!text_is_plain(asked->items[i])) return false;
    for (size_t i = 0; i < im->n_items; i++)
        if (selects(im, asked, &im->items[i]) != (&im->items[i] == item)) return false;
    return asked->n > 0;
}

/* The object alone, by its number. */
static bool try_number(const Importer *im, const ImportItem *item, uint32_t owner, Asked *asked)
{
    char number[24];
    asked_clear(asked);
    snprintf(number, sizeof number, "#%zu", im->source->parts[owner].number);
    ask(asked, im->source->parts[owner].kind, number);
    return is_exact(im, asked, item);
}

static bool try_names(const Importer *im, const ImportItem *item, uint32_t owner, uint32_t material, bool kinds,
                      Asked *asked)
{
    const MeshPart *parts = im->source->parts;
    asked_clear(asked);
    if (owner != IMPORT_NONE) ask(asked, kinds ? parts[owner].kind : "", parts[owner].name);
    if (material != IMPORT_NONE) ask(asked, kinds ? parts[material].kind : "", parts[material].name);
    return is_exact(im, asked, item);
}

/* By numbers, which leave no doubt. */
static void ask_numbers(const Importer *im, const ImportItem *item, Asked *asked)
{
    static const char *const kinds[] = {"object", "group", "solid", "material"};
    asked_clear(asked);
    for (size_t i = 0; i < COUNT_OF(kinds); i++) {
        uint32_t part = part_of_kind(im, item->parts, item->n_parts, kinds[i]);
        bool is_material = i + 1 == COUNT_OF(kinds);
        char number[24] = "";
        bool there = false; /* in the file at all */
        for (size_t k = 0; k < im->source->n_parts && !there; k++)
            there = strcmp(im->source->parts[k].kind, kinds[i]) == 0;
        if (part != IMPORT_NONE) snprintf(number, sizeof number, "#%zu", im->source->parts[part].number);
        if (there && (is_material || !im->by_material)) ask(asked, kinds[i], number);
    }
}

void import_ask_for(const Importer *im, const ImportItem *item, Buf *out)
{
    Asked asked = {{NULL}, 0};
    if (im->n_items == 1) return;
    uint32_t owner = im->by_material ? IMPORT_NONE : owner_of(im, item),
             material = part_of_kind(im, item->parts, item->n_parts, "material");
    bool found =
        !im->by_material && ((owner != IMPORT_NONE && try_names(im, item, owner, IMPORT_NONE, false, &asked)) ||
                             try_names(im, item, owner, material, false, &asked) ||
                             (owner != IMPORT_NONE && try_names(im, item, owner, IMPORT_NONE, true, &asked)) ||
                             try_names(im, item, owner, material, true, &asked) ||
                             (owner != IMPORT_NONE && try_number(im, item, owner, &asked)));
    if (im->by_material && material != IMPORT_NONE) found = try_names(im, item, owner, material, true, &asked);
    if (!found) ask_numbers(im, item, &asked);
    buf_add(out, asked.n > 1 ? "[" : "");
    for (size_t i = 0; i < asked.n; i++) {
        buf_add(out, i ? ", " : "");
        value_print_text(out, asked.items[i]);
    }
    buf_add(out, asked.n > 1 ? "]" : "");
    asked_clear(&asked);
}

/* parts.c - the parts of a mesh, which of them share some of their inside, and the mesh sorted into layers so that in
 * each of them no two do.
 *
 * A part is a set of triangles that are joined by their edges and closed by themselves. One that encloses negative
 * volume is a cavity, and belongs to the smallest body around it. Bodies overlap when their surfaces cross, or when one
 * is within the other and not in a cavity of it. Where boxes are apart nothing is looked at: pairs of triangles, and
 * what lies ahead of a point, come from a tree of the triangles of parts whose boxes meet. Layers are given out
 * as colours are to a map, to each body the first that none that it overlaps has, so that a heap of thousands of
 * bubbles becomes a handful of layers.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/hash.h"
#include "mesh/box_pairs.h"
#include "mesh/crossing.h"
#include "mesh/exact.h"

#define NO_PART UINT32_MAX
enum {
    MOST_OVERLAPS = 1 << 24, /* a quarter of a gigabyte */
    SAMPLES = 12,            /* points of a part from which it is judged what it is in */
};
static const uint64_t most_pairs = 2000000000;
static const char what[] = "the parts of a mesh";

typedef struct Part {
    uint32_t first, n; /* of members */
    FloatBox box;
    double volume; /* signed */
    uint32_t body; /* itself, or the body that it is a cavity of */
    bool near;     /* its box meets that of another part */
    bool crosses;  /* its surface crosses that of another part */
    bool within;   /* a body wholly inside of another */
} Part;

typedef struct Overlap {
    uint32_t a, b; /* parts; a < b */
} Overlap;

typedef struct Finder {
    const Mesh *mesh;
    uint32_t *part_of; /* of each triangle; NO_PART for those with two equal corners */
    uint32_t *members; /* triangles, part by part */
    Part *parts;
    uint32_t n_parts;
    const uint32_t *ids; /* vertices by position */
    BoxTree tree;        /* of the triangles of parts that are near others */
    Overlap *overlaps;   /* parts whose surfaces cross; then also bodies within bodies */
    size_t n_overlaps, overlaps_capacity;
    uint32_t *slots; /* 1 + the number of an overlap, by hash; 0: free */
    size_t n_slots;
    int32_t *net;  /* of each part: how often a ray leaves it more than it enters it */
    uint32_t *met; /* parts that the ray meets */
    size_t n_met, met_capacity;
    bool unclear;   /* the ray passes too near to an edge or starts too near to a triangle */
    Vec3f place;    /* on the first overlap */
    uint32_t asked; /* the part that the ray starts from */
    Vec3f from;
    Status status;
    bool gave_up;
} Finder;

/* ---- the parts ---- */

/* Sheets are joined by edges of exactly two triangles. At an edge of more, all sheets that do not come out even there
 * are one part: together they do. net: of each sheet, 0. */
static void join_sheets_at(const Edge *edge, const uint32_t *sheet, int32_t *net, uint32_t *parent)
{
    uint32_t odd = NO_PART;
    for (size_t i = 0; i < edge->n; i++) net[sheet[edge->uses[i].triangle]] += edge->uses[i].upward ? 1 : -1;
    for (size_t i = 0; i < edge->n; i++) {
        uint32_t triangle = edge->uses[i].triangle;
        if (net[sheet[triangle]] == 0) continue;
        if (odd == NO_PART) odd = triangle;
        set_unite(parent, odd, triangle);
    }
    for (size_t i = 0; i < edge->n; i++) net[sheet[edge->uses[i].triangle]] = 0;
}

static void join_pairs(const Topology *topology, uint32_t *parent)
{
    uint32_t low = 0;
    size_t at = 0;
    Edge edge;
    while (topology_next_edge(topology, &low, &at, &edge))
        if (edge.n == 2) set_unite(parent, edge.uses[0].triangle, edge.uses[1].triangle);
}

/* The sets of triangles that are parts. */
static Status join_triangles(const Topology *topology, uint32_t *parent, Error *error)
{
    uint32_t n = topology->mesh->n_triangles, low = 0;
    size_t at = 0;
    Edge edge;
    join_pairs(topology, parent);
    uint32_t *sheet = malloc((n + (size_t)1) * sizeof *sheet);
    int32_t *net = calloc(n + (size_t)1, sizeof *net);
    Status status = sheet && net ? STATUS_OK : fail_memory(error, n * sizeof *sheet, what);
    for (uint32_t i = 0; status == STATUS_OK && i < n; i++) sheet[i] = set_find(parent, i);
    while (status == STATUS_OK && topology_next_edge(topology, &low, &at, &edge))
        if (edge.n > 2) join_sheets_at(&edge, sheet, net, parent);
    free(sheet);
    free(net);
    return status;
}

static double volume_of(const Finder *f, const Part *part)
{
    const Mesh *mesh = f->mesh;
    Vec3 about = vec3_from_f(mesh->positions[mesh->triangles[f->members[part->first]][0]]);
    double sum = 0;
    for (uint32_t i = part->first; i < part->first + part->n; i++) {
        const uint32_t *t = mesh->triangles[f->members[i]];
        Vec3 a = vec3_sub(vec3_from_f(mesh->positions[t[0]]), about);
        Vec3 b = vec3_sub(vec3_from_f(mesh->positions[t[1]]), about);
        Vec3 c = vec3_sub(vec3_from_f(mesh->positions[t[2]]), about);
        sum += vec3_dot(a, vec3_cross(b, c));
    }
    return sum / 6;
}

/* Numbers the parts in the order of their first triangles; part_of has the roots of the sets so far. */
static Status number_parts(Finder *f, const Topology *topology, uint32_t *parent, Error *error)
{
    uint32_t n = f->mesh->n_triangles, ids[3];
    f->part_of = malloc((n + (size_t)1) * sizeof *f->part_of);
    f->members = malloc((n + (size_t)1) * sizeof *f->members);
    if (!f->part_of || !f->members) return fail_memory(error, n * sizeof *f->members, what);
    for (uint32_t i = 0; i < n; i++) {
        if (!topology_corners(topology, i, ids)) {
            f->part_of[i] = NO_PART;
            continue;
        }
        uint32_t root = set_find(parent, i); /* the first of its set */
        f->part_of[i] = root == i ? f->n_parts++ : f->part_of[root];
    }
    f->parts = calloc(f->n_parts + (size_t)1, sizeof *f->parts);
    if (!f->parts) return fail_memory(error, f->n_parts * sizeof *f->parts, what);
    for (uint32_t i = 0; i < n; i++)
        if (f->part_of[i] != NO_PART) f->parts[f->part_of[i]].n++;
    for (uint32_t k = 1; k < f->n_parts; k++) f->parts[k].first = f->parts[k - 1].first + f->parts[k - 1].n;
    for (uint32_t k = 0; k < f->n_parts; k++) f->parts[k].n = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (f->part_of[i] == NO_PART) continue;
        Part *part = &f->parts[f->part_of[i]];
        f->members[part->first + part->n++] = i;
    }
    return STATUS_OK;
}

/* Boxes of the parts where the mesh is now. */
static void measure_parts(Finder *f)
{
    for (uint32_t k = 0; k < f->n_parts; k++) {
        Part *part = &f->parts[k];
        part->near = false;
        part->box = float_box_empty();
        for (uint32_t i = part->first; i < part->first + part->n; i++) {
            FloatBox box = triangle_box(f->mesh, f->members[i]);
            float_box_add(&part->box, &box);
        }
    }
}

static Status make_parts(Finder *f, const Topology *topology, Error *error)
{
    uint32_t *parent = NULL;
    Status status = sets_new(f->mesh->n_triangles, &parent, error);
    if (status == STATUS_OK) status = join_triangles(topology, parent, error);
    if (status == STATUS_OK) status = number_parts(f, topology, parent, error);
    free(parent);
    for (uint32_t k = 0; status == STATUS_OK && k < f->n_parts; k++) {
        f->parts[k].volume = volume_of(f, &f->parts[k]);
        f->parts[k].body = k;
    }
    return status;
}

/* ---- what overlaps ---- */

static size_t slot_of(const Finder *f, uint32_t a, uint32_t b)
{
    size_t at = (size_t)hash_u64(a | (uint64_t)b << 32) & (f->n_slots - 1);
    for (uint32_t i; (i = f->slots[at]) != 0; at = (at + 1) & (f->n_slots - 1))
        if (f->overlaps[i - 1].a == a && f->overlaps[i - 1].b == b) break;
    return at;
}

static bool grow_slots(Finder *f)
{
    if (2 * (f->n_overlaps + 1) <= f->n_slots) return true;
    uint32_t *old = f->slots;
    f->n_slots = f->n_slots ? 2 * f->n_slots : 64;
    f->slots = calloc(f->n_slots, sizeof *f->slots);
    free(old);
    for (size_t i = 0; f->slots && i < f->n_overlaps; i++)
        f->slots[slot_of(f, f->overlaps[i].a, f->overlaps[i].b)] = (uint32_t)i + 1;
    return f->slots != NULL;
}

static bool is_known(const Finder *f, uint32_t a, uint32_t b)
{
    return f->n_slots && f->slots[a < b ? slot_of(f, a, b) : slot_of(f, b, a)];
}

static void add_overlap(Finder *f, uint32_t a, uint32_t b)
{
    if (f->gave_up || is_known(f, a, b)) return;
    if (f->n_overlaps >= MOST_OVERLAPS) {
        f->gave_up = true;
    } else if (!grow_slots(f) || !ARRAY_ROOM(f->overlaps, f->overlaps_capacity, f->n_overlaps)) {
        f->status = STATUS_NOMEM;
    } else {
        Overlap overlap = {a < b ? a : b, a < b ? b : a};
        f->slots[slot_of(f, overlap.a, overlap.b)] = (uint32_t)f->n_overlaps + 1;
        f->overlaps[f->n_overlaps++] = overlap;
    }
}

static Box3 part_box(const void *context, uint32_t number)
{
    const FloatBox *box = &((const Finder *)context)->parts[number].box;
    return (Box3){vec3((double)box->min[0], (double)box->min[1], (double)box->min[2]),
                  vec3((double)box->max[0], (double)box->max[1], (double)box->max[2])};
}

static Status mark_near(void *context, uint32_t a, uint32_t b, Error *error)
{
    Finder *f = context;
    (void)error;
    f->parts[a].near = f->parts[b].near = true;
    return STATUS_OK;
}

static Status make_tree(Finder *f, Error *error)
{
    uint32_t n = f->mesh->n_triangles;
    uint32_t *labels = malloc((n + (size_t)1) * sizeof *labels);
    if (!labels) return fail_memory(error, n * sizeof *labels, what);
    for (uint32_t i = 0; i < n; i++)
        labels[i] = f->part_of[i] != NO_PART && f->parts[f->part_of[i]].near ? 1 + f->part_of[i] : TRIANGLE_LEFT_OUT;
    box_tree_clear(&f->tree);
    Status status = triangle_tree_make(f->mesh, labels, &f->tree, error);
    free(labels);
    return status;
}

static void test_pair(void *context, uint32_t i, uint32_t j)
{
    Finder *f = context;
    uint32_t a = f->part_of[i], b = f->part_of[j];
    Vec3f place;
    if (is_known(f, a, b) || !triangles_cross(f->mesh, f->ids, i, j, &place)) return;
    f->parts[a].crosses = f->parts[b].crosses = true;
    if (!f->n_overlaps) f->place = place;
    add_overlap(f, a, b);
}

/* ---- what is within what ---- */

/* A triangle of another part that the ray may meet. */
static void count_triangle(void *context, uint32_t triangle)
{
    Finder *f = context;
    uint32_t part = f->part_of[triangle];
    if (part == f->asked || f->unclear || is_known(f, part, f->asked)) return;
    const uint32_t *t = f->mesh->triangles[triangle];
    Vec3f a = f->mesh->positions[t[0]], b = f->mesh->positions[t[1]], c = f->mesh->positions[t[2]];
    int turn = exact_pierce_along_x(a, b, c, f->from, &f->unclear);
    if (turn == 0) return;
    Vec3 start = vec3_from_f(a);
    Vec3 normal = vec3_cross(vec3_sub(vec3_from_f(b), start), vec3_sub(vec3_from_f(c), start));
    Vec3 way = vec3_sub(vec3_from_f(f->from), start);
    const double close = 1e-5; /* of what the two measure: faces in contact, and the point's own rounding */
    if (fabs(vec3_dot(normal, way)) <= close * vec3_length(normal) * vec3_length(way)) {
        f->unclear = true;
        return;
    }
    /* it faces +x when its turn is positive, and is ahead when the point is then below it */
    if (exact_side_of_plane(a, b, c, f->from) != -turn) return;
    if (f->net[part] == 0) {
        if (!ARRAY_ROOM(f->met, f->met_capacity, f->n_met)) {
            f->status = STATUS_NOMEM;
            return;
        }
        f->met[f->n_met++] = part;
    }
    f->net[part] += turn;
}

static void forget_ray(Finder *f)
{
    for (size_t i = 0; i < f->n_met; i++) f->net[f->met[i]] = 0;
    f->n_met = 0;
}

/* What a part is in, by how often a ray from a place on it leaves the others: net[] of those in met[]; parts whose
 * surfaces cross its own are left out. Nothing where every place is unclear: it then fills a cavity. */
static void look_around(Finder *f, uint32_t asked)
{
    const Part *part = &f->parts[asked];
    const Mesh *mesh = f->mesh;
    f->asked = asked;
    f->unclear = true;
    for (uint32_t s = 0; s < SAMPLES && f->unclear; s++) {
        uint32_t member = part->first + (uint32_t)((uint64_t)s * part->n / SAMPLES);
        const uint32_t *t = mesh->triangles[f->members[member]];
        /* off the middle, so that meshes of equal meshes do not meet edge to edge */
        Vec3 p = vec3_scale(vec3_from_f(mesh->positions[t[0]]), 0.4391);
        p = vec3_along(p, 0.3307, vec3_from_f(mesh->positions[t[1]]));
        p = vec3_along(p, 0.2302, vec3_from_f(mesh->positions[t[2]]));
        f->from = vec3f_from(p);
        f->unclear = false;
        forget_ray(f);
        box_tree_ray(&f->tree, f->from, count_triangle, f);
    }
    if (f->unclear) forget_ray(f);
}

/* A place on a part. */
static Vec3f place_on(const Finder *f, uint32_t part)
{
    return f->mesh->positions[f->mesh->triangles[f->members[f->parts[part].first]][0]];
}

/* The smallest body around each cavity; where there is none, one that it breaks through. */
static void find_bodies(Finder *f)
{
    for (uint32_t k = 0; k < f->n_parts; k++) {
        Part *part = &f->parts[k];
        if (part->volume >= 0 || !part->near) continue;
        look_around(f, k);
        for (size_t i = 0; i < f->n_met; i++) {
            uint32_t other = f->met[i];
            if (f->net[other] <= 0 || f->parts[other].volume < 0) continue;
            bool smaller = part->body == k || f->parts[other].volume < f->parts[part->body].volume;
            if (smaller) part->body = other;
        }
    }
    for (size_t i = 0; i < f->n_overlaps; i++) {
        uint32_t a = f->overlaps[i].a, b = f->overlaps[i].b;
        if (f->parts[a].volume < 0 && f->parts[b].volume >= 0 && f->parts[a].body == a) f->parts[a].body = b;
        if (f->parts[b].volume < 0 && f->parts[a].volume >= 0 && f->parts[b].body == b) f->parts[b].body = a;
    }
    forget_ray(f);
}

/* Bodies within bodies that are not in a cavity of theirs. */
static void find_within(Finder *f)
{
    for (uint32_t k = 0; k < f->n_parts && f->status == STATUS_OK; k++) {
        Part *part = &f->parts[k];
        if (part->volume < 0 || !part->near) continue;
        look_around(f, k);
        for (size_t i = 0; i < f->n_met; i++) /* a cavity around it takes its body away again */
            if (f->parts[f->met[i]].volume < 0 && f->net[f->met[i]] < 0) f->net[f->parts[f->met[i]].body]--;
        for (size_t i = 0; i < f->n_met; i++) {
            uint32_t other = f->met[i];
            if (f->net[other] <= 0 || f->parts[other].volume < 0) continue;
            part->within = !part->crosses;
            if (!f->n_overlaps) f->place = place_on(f, k);
            add_overlap(f, k, other);
        }
        for (size_t i = 0; i < f->n_met; i++) f->net[f->parts[f->met[i]].body] = 0;
    }
    forget_ray(f);
}

/* What overlaps where the mesh is now. */
static Status find_overlaps(Finder *f, bool first, Error *error)
{
    measure_parts(f);
    TRY(box_pairs_visit(f->n_parts, part_box, mark_near, f, error));
    TRY(make_tree(f, error));
    if (!f->tree.n) return STATUS_OK;
    uint64_t pairs_left = most_pairs;
    f->gave_up |= !box_tree_pairs(&f->tree, 0, UINT32_MAX, &pairs_left, test_pair, f);
    if (first) find_bodies(f);
    find_within(f);
    return f->status == STATUS_OK ? STATUS_OK : fail_memory(error, f->n_overlaps * sizeof *f->overlaps, what);
}

/* ---- layers ---- */

/* The overlaps of each body with others: neighbours[first[k]] to before neighbours[first[k + 1]]. */
typedef struct Neighbours {
    size_t *first;
    uint32_t *of;
} Neighbours;

static Status list_neighbours(const Finder *f, Neighbours *list, Error *error)
{
    list->first = calloc(f->n_parts + (size_t)2, sizeof *list->first);
    list->of = malloc((2 * f->n_overlaps + 1) * sizeof *list->of);
    if (!list->first || !list->of) return fail_memory(error, f->n_overlaps * 2 * sizeof *list->of, what);
    size_t *next = list->first + 1; /* see list_edges of topology.c */
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < f->n_overlaps; i++) {
            uint32_t a = f->parts[f->overlaps[i].a].body, b = f->parts[f->overlaps[i].b].body;
            if (a == b) continue; /* a cavity that breaks through its wall, or into another: nothing to part */
            if (pass == 0) {
                next[a + 1]++;
                next[b + 1]++;
            } else {
                list->of[next[a]++] = b;
                list->of[next[b]++] = a;
            }
        }
        for (uint32_t k = 1; pass == 0 && k <= f->n_parts; k++) next[k] += next[k - 1];
    }
    return STATUS_OK;
}

/* The layer of each body, and how many there are. used: room for one of each part. */
static uint32_t color(const Finder *f, const Neighbours *list, uint32_t *layers, uint32_t *used, MeshParts *parts)
{
    uint32_t n_layers = 1;
    for (uint32_t k = 0; k < f->n_parts; k++) {
        layers[k] = 0;
        if (f->parts[k].body != k) continue;
        parts->n_bodies++;
        if (f->parts[k].within && parts->n_within++ == 0) parts->within_place = place_on(f, k);
        for (size_t i = list->first[k]; i < list->first[k + 1]; i++)
            if (list->of[i] < k) used[layers[list->of[i]]] = k + 1;
        if (list->first[k] != list->first[k + 1]) {
            parts->n_overlapping++;
            while (used[layers[k]] == k + 1) layers[k]++;
        }
        if (layers[k] >= n_layers) n_layers = layers[k] + 1;
    }
    return n_layers;
}

static Status sort_layers(const Finder *f, MeshParts *parts, Error *error)
{
    Neighbours list = {0};
    uint32_t *layers = malloc((f->n_parts + (size_t)1) * sizeof *layers);
    uint32_t *used = calloc(f->n_parts + (size_t)1, sizeof *used);
    Status status = layers && used ? STATUS_OK : fail_memory(error, f->n_parts * sizeof *layers, what);
    if (status == STATUS_OK) status = list_neighbours(f, &list, error);
    if (status == STATUS_OK) parts->n_layers = color(f, &list, layers, used, parts);
    if (status == STATUS_OK && parts->n_layers > 1) {
        uint32_t n = f->mesh->n_triangles;
        parts->layer = malloc((n + (size_t)1) * sizeof *parts->layer);
        if (!parts->layer) status = fail_memory(error, n * sizeof *parts->layer, what);
        for (uint32_t i = 0; parts->layer && i < n; i++)
            parts->layer[i] = f->part_of[i] == NO_PART ? 0 : layers[f->parts[f->part_of[i]].body];
    }
    free(list.first);
    free(list.of);
    free(layers);
    free(used);
    return status;
}

/* The same parts where the mesh is at another time. */
static Status find_later_overlaps(Finder *f, const Mesh *end, Error *error)
{
    uint32_t *ids = NULL;
    TRY(mesh_number_positions(end, NULL, &ids, error));
    const Mesh *mesh = f->mesh;
    const uint32_t *first_ids = f->ids;
    f->mesh = end;
    f->ids = ids;
    Status status = find_overlaps(f, false, error);
    f->mesh = mesh;
    f->ids = first_ids;
    free(ids);
    return status;
}

static Status find_parts(Finder *f, const Topology *topology, const Mesh *end, MeshParts *parts, Error *error)
{
    TRY(make_parts(f, topology, error));
    parts->n_bodies = f->n_parts;
    if (f->n_parts < 2) return STATUS_OK;
    f->ids = topology->position_id;
    f->net = calloc(f->n_parts, sizeof *f->net);
    if (!f->net) return fail_memory(error, f->n_parts * sizeof *f->net, what);
    TRY(find_overlaps(f, true, error));
    if (end) TRY(find_later_overlaps(f, end, error));
    parts->gave_up = f->gave_up;
    parts->place = f->place;
    parts->n_bodies = 0;
    return sort_layers(f, parts, error);
}

Status mesh_find_parts(const Mesh *mesh, const Mesh *end, MeshParts *parts, Error *error)
{
    *parts = (MeshParts){.n_layers = 1};
    Topology topology;
    Finder f = {.mesh = mesh};
    Status status = topology_make(mesh, NULL, &topology, error);
    if (status == STATUS_OK) status = find_parts(&f, &topology, end, parts, error);
    topology_clear(&topology);
    box_tree_clear(&f.tree);
    free(f.part_of);
    free(f.members);
    free(f.parts);
    free(f.overlaps);
    free(f.slots);
    free(f.net);
    free(f.met);
    return status;
}

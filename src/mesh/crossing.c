/* crossing.c - where a mesh passes through itself.
 *
 * Candidates are pairs of triangles whose boxes meet, from a tree of boxes over the triangles in the order of a
 * space-filling curve. Each pair is decided by the signs of exact determinants, so that neighbours, which touch, are
 * never taken for crossings, at any size of the mesh. Two triangles cross when they have a line in common that is more
 * than what they share as neighbours: each reaches to both sides of the other's plane. A corner that lies exactly in
 * the other's plane counts as outside, so parts that only touch from outside do not cross, and parts that touch from
 * within do. Triangles in one plane cross when they overlap and look the same way; where they look opposite ways they
 * are the common face of two parts, which encloses nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/crossing.h"

#include <stdlib.h>
#include <string.h>

#include "mesh/exact.h"
#include "mesh/topology.h"

enum { CHUNK = 512 };                          /* leaves that one task looks after */
static const uint64_t most_pairs = 2000000000; /* a few seconds */

typedef struct Search {
    const Mesh *mesh;
    const uint32_t *ids; /* vertices by position; see Topology */
    BoxTree tree;
    uint64_t pairs_per_task;
    MeshCrossings *found; /* one for each task */
} Search;

FloatBox triangle_box(const Mesh *mesh, uint32_t triangle)
{
    FloatBox box = float_box_empty();
    for (int k = 0; k < 3; k++) float_box_add_point(&box, mesh->positions[mesh->triangles[triangle][k]]);
    return box;
}

/* ---- the tree ---- */

/* Two of the coordinates: those that follow the dropped one in x, y, z, x, y; or these two swapped. */
static void flatten(const Vec3f corners[3], int drop, bool swap, Point2 flat[3])
{
    for (int k = 0; k < 3; k++) {
        const double all[3] = {(double)corners[k].x, (double)corners[k].y, (double)corners[k].z};
        double first = all[(drop + 1) % 3], second = all[(drop + 2) % 3];
        flat[k] = swap ? (Point2){second, first} : (Point2){first, second};
    }
}

static bool has_area(const Mesh *mesh, uint32_t triangle)
{
    const uint32_t *t = mesh->triangles[triangle];
    Vec3f a = mesh->positions[t[0]], b = mesh->positions[t[1]], c = mesh->positions[t[2]];
    const Vec3f corners[3] = {a, b, c};
    Point2 flat[3];
    for (int drop = 0; drop < 3; drop++) {
        flatten(corners, drop, false, flat);
        if (exact_turn(flat[0], flat[1], flat[2])) return true;
    }
    return false;
}

/* Room for n items of a tree. */
typedef struct Items {
    uint32_t *ids, *labels;
    FloatBox *boxes;
} Items;

static void items_clear(Items *items)
{
    free(items->ids);
    free(items->labels);
    free(items->boxes);
}

Status triangle_tree_make(const Mesh *mesh, const uint32_t *labels, BoxTree *tree, Error *error)
{
    *tree = (BoxTree){0};
    size_t room = (size_t)mesh->n_triangles + 1;
    Items items = {malloc(room * sizeof *items.ids), malloc(room * sizeof *items.labels),
                   malloc(room * sizeof *items.boxes)};
    if (!items.ids || !items.labels || !items.boxes) {
        items_clear(&items);
        return fail_memory(error, room * sizeof *items.boxes, "the search for crossings in a mesh");
    }
    uint32_t n = 0;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        if (labels[i] == TRIANGLE_LEFT_OUT || !has_area(mesh, i)) continue;
        items.ids[n] = i;
        items.labels[n] = labels[i];
        items.boxes[n++] = triangle_box(mesh, i);
    }
    Status status = box_tree_make(items.ids, items.boxes, items.labels, n, tree, error);
    items_clear(&items);
    return status;
}

/* ---- two triangles ---- */

typedef struct Pair {
    Vec3f a[3], b[3]; /* each turned so that shared corners come first */
    int n_shared;
} Pair;

/* Fills in the corners; those that are one position come first in both. */
static void take_pair(const Mesh *mesh, const uint32_t *ids, uint32_t i, uint32_t j, Pair *pair)
{
    const uint32_t *t = mesh->triangles[i], *u = mesh->triangles[j];
    int first_a = 0, first_b = 0;
    pair->n_shared = 0;
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
            if (topology_number(ids, t[k]) == topology_number(ids, u[l])) {
                pair->n_shared++;
                first_a = k;
                first_b = l;
            }
    for (int k = 0; k < 3; k++) {
        pair->a[k] = mesh->positions[t[(first_a + k) % 3]];
        pair->b[k] = mesh->positions[u[(first_b + k) % 3]];
    }
}

/* Whether an edge of the counter-clockwise triangle a has all of b on its outer side. */
static bool edge_parts(const Point2 a[3], const Point2 b[3])
{
    for (int k = 0; k < 3; k++) {
        bool parts = true;
        for (int l = 0; l < 3 && parts; l++) parts = exact_turn(a[k], a[(k + 1) % 3], b[l]) <= 0;
        if (parts) return true;
    }
    return false;
}

/* Triangles in one plane: overlapping, and turned the same way. */
static bool overlap_in_plane(const Pair *pair)
{
    Point2 a[3], b[3];
    for (int drop = 0; drop < 3; drop++) {
        flatten(pair->a, drop, false, a);
        int turn = exact_turn(a[0], a[1], a[2]);
        if (turn == 0) continue;
        flatten(pair->a, drop, turn < 0, a);
        flatten(pair->b, drop, turn < 0, b);
        if (exact_turn(b[0], b[1], b[2]) <= 0) return false;
        return !edge_parts(a, b) && !edge_parts(b, a);
    }
    return false;
}

/* Two triangles about one corner, the first of both. The line that their planes share runs through it; each triangle
 * meets that line on one side of the corner, and they cross when that is the same side. With planes' normals n and m,
 * the line along n x m: the first one's side is that of the sign of its second corner against m, the other's the
 * opposite of the sign of its second corner against n. */
static bool cross_at_corner(const Pair *pair)
{
    int a1 = exact_side_of_plane(pair->b[0], pair->b[1], pair->b[2], pair->a[1]);
    int a2 = exact_side_of_plane(pair->b[0], pair->b[1], pair->b[2], pair->a[2]);
    if (a1 == 0 && a2 == 0) return overlap_in_plane(pair);
    if (a1 * a2 >= 0) return false;
    int b1 = exact_side_of_plane(pair->a[0], pair->a[1], pair->a[2], pair->b[1]);
    int b2 = exact_side_of_plane(pair->a[0], pair->a[1], pair->a[2], pair->b[2]);
    return b1 * b2 < 0 && a1 == -b1;
}

/* Turns corners (and what is known of them) so that the first is alone on its side of the other's plane, and swaps the
 * other's last two when that is the negative side. False when all are on one side. */
static bool turn_to_lone(Vec3f corners[3], const int sides[3], Vec3f other[3], int sides_other[3])
{
    bool above[3] = {sides[0] >= 0, sides[1] >= 0, sides[2] >= 0}; /* in the plane is outside */
    if (above[0] == above[1] && above[1] == above[2]) return false;
    int lone = above[1] == above[2] ? 0 : above[0] == above[2] ? 1 : 2;
    const Vec3f turned[3] = {corners[lone], corners[(lone + 1) % 3], corners[(lone + 2) % 3]};
    memcpy(corners, turned, sizeof turned);
    if (above[lone]) return true;
    Vec3f corner = other[1];
    other[1] = other[2];
    other[2] = corner;
    int side = sides_other[1];
    sides_other[1] = sides_other[2];
    sides_other[2] = side;
    return true;
}

/* P. Guigue, O. Devillers, "Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates", Journal of
 * Graphics Tools 8(1) (2003): both triangles meet the line of their planes in an interval, and four corners tell
 * whether these overlap. */
static bool cross_apart(const Pair *pair)
{
    Vec3f a[3], b[3];
    memcpy(a, pair->a, sizeof a);
    memcpy(b, pair->b, sizeof b);
    int sides_a[3], sides_b[3];
    for (int k = 0; k < 3; k++) sides_b[k] = exact_side_of_plane(a[0], a[1], a[2], b[k]);
    if (sides_b[0] == sides_b[1] && sides_b[1] == sides_b[2]) return sides_b[0] == 0 && overlap_in_plane(pair);
    for (int k = 0; k < 3; k++) sides_a[k] = exact_side_of_plane(b[0], b[1], b[2], a[k]);
    if (!turn_to_lone(a, sides_a, b, sides_b)) return false;
    if (!turn_to_lone(b, sides_b, a, sides_a)) return false;
    return exact_side_of_plane(a[0], a[1], b[0], b[1]) < 0 && exact_side_of_plane(a[0], a[2], b[2], b[0]) < 0;
}

static Vec3 normal_of(const Vec3f corners[3])
{
    Vec3 a = vec3_from_f(corners[0]);
    return vec3_cross(vec3_sub(vec3_from_f(corners[1]), a), vec3_sub(vec3_from_f(corners[2]), a));
}

/* Where the triangle's edges pass through a plane, as an interval along a direction; with the points. */
typedef struct Interval {
    double from, to;
    Vec3 first, last;
} Interval;

static Interval interval_of(const Vec3f corners[3], Vec3 on_plane, Vec3 normal, Vec3 along)
{
    Interval interval = {HUGE_VAL, -HUGE_VAL, on_plane, on_plane};
    for (int k = 0; k < 3; k++) {
        Vec3 p = vec3_from_f(corners[k]), q = vec3_from_f(corners[(k + 1) % 3]);
        double d = vec3_dot(vec3_sub(p, on_plane), normal), e = vec3_dot(vec3_sub(q, on_plane), normal);
        if ((d > 0 && e > 0) || (d < 0 && e < 0)) continue;
        Vec3 at = d == e ? p : vec3_along(p, d / (d - e), vec3_sub(q, p));
        double t = vec3_dot(at, along);
        if (t < interval.from) {
            interval.from = t;
            interval.first = at;
        }
        if (t > interval.to) {
            interval.to = t;
            interval.last = at;
        }
    }
    return interval;
}

/* A point that the two have in common, rounded. */
static Vec3f place_of(const Pair *pair)
{
    Vec3 n = normal_of(pair->a), m = normal_of(pair->b), along = vec3_cross(n, m);
    if (vec3_length(along) > 1e-9 * vec3_length(n) * vec3_length(m)) {
        Interval a = interval_of(pair->a, vec3_from_f(pair->b[0]), m, along);
        Interval b = interval_of(pair->b, vec3_from_f(pair->a[0]), n, along);
        Vec3 first = a.from > b.from ? a.first : b.first, last = a.to < b.to ? a.last : b.last;
        return vec3f_from(vec3_scale(vec3_add(first, last), 0.5));
    }
    double middle[3];
    for (int k = 0; k < 3; k++) {
        double low = -HUGE_VAL, high = HUGE_VAL;
        for (int which = 0; which < 2; which++) {
            double least = HUGE_VAL, most = -HUGE_VAL;
            for (int corner = 0; corner < 3; corner++) {
                Vec3f p = which ? pair->b[corner] : pair->a[corner];
                double x = (double)(k == 0 ? p.x : k == 1 ? p.y : p.z);
                least = fmin(least, x);
                most = fmax(most, x);
            }
            low = fmax(low, least);
            high = fmin(high, most);
        }
        middle[k] = (low + high) / 2;
    }
    return vec3f_from(vec3(middle[0], middle[1], middle[2]));
}

/* ---- the search ---- */

static bool pair_crosses(const Pair *pair)
{
    if (pair->n_shared >= 2) return false; /* neighbours along an edge have nothing else in common, folded ones apart */
    return pair->n_shared == 1 ? cross_at_corner(pair) : cross_apart(pair);
}

bool triangles_cross(const Mesh *mesh, const uint32_t *ids, uint32_t i, uint32_t j, Vec3f *place)
{
    Pair pair;
    take_pair(mesh, ids, i, j, &pair);
    if (!pair_crosses(&pair)) return false;
    *place = place_of(&pair);
    return true;
}

/* What one task works with. */
typedef struct Task {
    const Search *search;
    MeshCrossings *found;
} Task;

static void test_pair(void *context, uint32_t i, uint32_t j)
{
    const Task *task = context;
    MeshCrossings *found = task->found;
    Vec3f place;
    if (!triangles_cross(task->search->mesh, task->search->ids, i, j, &place)) return;
    if (found->n < COUNT_OF(found->first)) {
        found->first[found->n].triangles[0] = i < j ? i : j;
        found->first[found->n].triangles[1] = i < j ? j : i;
        found->first[found->n].place = place;
    }
    found->n++;
}

static void search_chunk(void *context, uint32_t chunk, unsigned worker)
{
    const Search *search = context;
    (void)worker;
    Task task = {search, &search->found[chunk]};
    uint64_t pairs_left = search->pairs_per_task;
    task.found->gave_up =
        !box_tree_pairs(&search->tree, chunk * CHUNK, (chunk + 1) * CHUNK, &pairs_left, test_pair, &task);
}

/* Whether a place is so near to one of the first n that it says nothing new. */
static bool is_near(const MeshCrossings *found, size_t n, Vec3f place, double distance)
{
    for (size_t i = 0; i < n; i++)
        if (vec3_length(vec3_sub(vec3_from_f(found->first[i].place), vec3_from_f(place))) < distance) return true;
    return false;
}

/* Sums up, and keeps places that lie apart; the result depends on no thread. */
static void gather(const Search *search, uint32_t n_chunks, MeshCrossings *found)
{
    const FloatBox *root = &search->tree.nodes[1];
    double distance = 0;
    for (int k = 0; k < 3; k++) distance = fmax(distance, 0.05 * ((double)root->max[k] - (double)root->min[k]));
    size_t n_places = 0;
    for (uint32_t c = 0; c < n_chunks; c++) {
        const MeshCrossings *part = &search->found[c];
        found->n += part->n;
        found->gave_up = found->gave_up || part->gave_up;
        for (size_t i = 0; i < part->n && i < COUNT_OF(part->first) && n_places < COUNT_OF(found->first); i++)
            if (!is_near(found, n_places, part->first[i].place, distance)) found->first[n_places++] = part->first[i];
    }
    found->n_places = (uint32_t)n_places;
}

static Status run_search(Search *search, const uint32_t *labels, Pool *pool, MeshCrossings *found, Error *error)
{
    TRY(triangle_tree_make(search->mesh, labels, &search->tree, error));
    uint32_t n_chunks = (box_tree_leaves(&search->tree) + CHUNK - 1) / CHUNK;
    search->found = calloc(n_chunks + 1U, sizeof *search->found);
    if (!search->found)
        return fail_memory(error, n_chunks * sizeof *search->found, "the search for crossings in a mesh");
    search->pairs_per_task = most_pairs / (n_chunks + 1U);
    pool_run(pool, n_chunks, search_chunk, search);
    if (n_chunks) gather(search, n_chunks, found);
    return STATUS_OK;
}

Status mesh_find_crossings(const Mesh *mesh, Pool *pool, MeshCrossings *found, Error *error)
{
    *found = (MeshCrossings){0};
    Topology topology;
    uint32_t *labels = NULL;
    Search search = {.mesh = mesh};
    Status status = topology_make(mesh, pool, &topology, error);
    if (status == STATUS_OK) status = mesh_label_graphs(&topology, &labels, error);
    search.ids = topology.position_id;
    if (status == STATUS_OK) status = run_search(&search, labels, pool, found, error);
    topology_clear(&topology);
    free(labels);
    box_tree_clear(&search.tree);
    free(search.found);
    return status;
}

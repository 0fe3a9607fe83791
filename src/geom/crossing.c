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
#include <stdlib.h>
#include <string.h>

#include "geom/exact.h"
#include "geom/mesh.h"

enum {
    LEAF = 4,        /* triangles */
    CHUNK = 512,     /* leaves that one task looks after */
    CODE_BITS = 21,  /* of each coordinate */
    DIGIT_BITS = 11, /* of the radix sort */
    TREE_DEPTH = 32,
};
static const uint64_t most_pairs = 2000000000; /* a few seconds */

typedef struct FloatBox {
    float min[3], max[3];
} FloatBox;

typedef struct Search {
    const Mesh *mesh;
    const uint32_t *ids; /* vertices by position */
    uint32_t *order;     /* triangles along the curve; those without area left out */
    uint32_t n;
    FloatBox *boxes;   /* of the triangles in that order */
    FloatBox *nodes;   /* a heap: children of i are 2 i and 2 i + 1; leaves from n_leaves on */
    uint32_t n_leaves; /* a power of two */
    uint64_t pairs_per_task;
    MeshCrossings *found; /* one for each task */
} Search;

static void box_add(FloatBox *box, const FloatBox *other)
{
    for (int k = 0; k < 3; k++) {
        if (other->min[k] < box->min[k]) box->min[k] = other->min[k];
        if (other->max[k] > box->max[k]) box->max[k] = other->max[k];
    }
}

static inline bool boxes_meet(const FloatBox *a, const FloatBox *b)
{
    return a->min[0] <= b->max[0] && b->min[0] <= a->max[0] && a->min[1] <= b->max[1] && b->min[1] <= a->max[1] &&
           a->min[2] <= b->max[2] && b->min[2] <= a->max[2];
}

static const FloatBox empty_box = {{HUGE_VALF, HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF}};

static FloatBox triangle_box(const Mesh *mesh, uint32_t triangle)
{
    FloatBox box = empty_box;
    for (int k = 0; k < 3; k++) {
        Vec3f p = mesh->positions[mesh->triangles[triangle][k]];
        FloatBox point = {{p.x, p.y, p.z}, {p.x, p.y, p.z}};
        box_add(&box, &point);
    }
    return box;
}

/* ---- the tree ---- */

/* Two zero bits behind each of the lower 21. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffffU;
    x = (x | x << 16) & 0x1f0000ff0000ffU;
    x = (x | x << 8) & 0x100f00f00f00f00fU;
    x = (x | x << 4) & 0x10c30c30c30c30c3U;
    return (x | x << 2) & 0x1249249249249249U;
}

typedef struct Coded {
    uint64_t code;
    uint32_t triangle;
} Coded;

/* By code; equal codes stay in order. The result is in items. */
static void sort_by_code(Coded *items, Coded *spare, uint32_t n)
{
    for (int shift = 0; shift < 3 * CODE_BITS; shift += DIGIT_BITS) {
        uint32_t start[(1 << DIGIT_BITS) + 1] = {0};
        for (uint32_t i = 0; i < n; i++) start[(items[i].code >> shift & ((1 << DIGIT_BITS) - 1)) + 1]++;
        for (int d = 0; d < 1 << DIGIT_BITS; d++) start[d + 1] += start[d];
        for (uint32_t i = 0; i < n; i++) spare[start[items[i].code >> shift & ((1 << DIGIT_BITS) - 1)]++] = items[i];
        memcpy(items, spare, n * sizeof *items);
    }
}

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

static Status order_triangles(Search *search, Error *error)
{
    const Mesh *mesh = search->mesh;
    size_t n_all = mesh->n_triangles;
    Coded *items = malloc((2 * n_all + 1) * sizeof *items);
    search->order = malloc((n_all + 1) * sizeof *search->order);
    search->boxes = malloc((n_all + 1) * sizeof *search->boxes);
    if (!items || !search->order || !search->boxes) {
        free(items);
        return fail_memory(error, n_all * (2 * sizeof *items + sizeof *search->boxes),
                           "the search for crossings in a mesh");
    }
    FloatBox all = empty_box;
    for (uint32_t i = 0; i < n_all; i++) {
        FloatBox box = triangle_box(mesh, i);
        box_add(&all, &box);
    }
    double scale[3];
    for (int k = 0; k < 3; k++) {
        double size = (double)all.max[k] - (double)all.min[k];
        scale[k] = size > 0 ? ((1 << CODE_BITS) - 1) / size : 0;
    }
    uint32_t n = 0;
    for (uint32_t i = 0; i < n_all; i++) {
        if (!has_area(mesh, i)) continue;
        FloatBox box = triangle_box(mesh, i);
        uint64_t code = 0;
        for (int k = 0; k < 3; k++) {
            double middle = ((double)box.min[k] + (double)box.max[k]) / 2 - (double)all.min[k];
            code |= spread((uint64_t)(middle * scale[k])) << k;
        }
        items[n++] = (Coded){code, i};
    }
    sort_by_code(items, items + n, n);
    for (uint32_t i = 0; i < n; i++) {
        search->order[i] = items[i].triangle;
        search->boxes[i] = triangle_box(mesh, items[i].triangle);
    }
    search->n = n;
    free(items);
    return STATUS_OK;
}

static Status make_tree(Search *search, Error *error)
{
    TRY(order_triangles(search, error));
    search->n_leaves = 1;
    while ((uint64_t)search->n_leaves * LEAF < search->n) search->n_leaves *= 2;
    size_t bytes = 2 * (size_t)search->n_leaves * sizeof *search->nodes;
    search->nodes = malloc(bytes);
    if (!search->nodes) return fail_memory(error, bytes, "the search for crossings in a mesh");
    for (uint32_t i = 0; i < search->n_leaves; i++) {
        FloatBox *box = &search->nodes[search->n_leaves + i];
        *box = empty_box;
        for (uint64_t k = (uint64_t)i * LEAF; k < ((uint64_t)i + 1) * LEAF && k < search->n; k++)
            box_add(box, &search->boxes[k]);
    }
    for (uint32_t i = search->n_leaves - 1; i > 0; i--) {
        search->nodes[i] = search->nodes[2 * (size_t)i];
        box_add(&search->nodes[i], &search->nodes[2 * (size_t)i + 1]);
    }
    return STATUS_OK;
}

/* ---- two triangles ---- */

typedef struct Pair {
    Vec3f a[3], b[3]; /* each turned so that shared corners come first */
    int n_shared;
} Pair;

/* Fills in the corners; those that are one position come first in both. */
static void take_pair(const Search *search, uint32_t i, uint32_t j, Pair *pair)
{
    const uint32_t *t = search->mesh->triangles[i], *u = search->mesh->triangles[j];
    int first_a = 0, first_b = 0;
    pair->n_shared = 0;
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
            if (search->ids[t[k]] == search->ids[u[l]]) {
                pair->n_shared++;
                first_a = k;
                first_b = l;
            }
    for (int k = 0; k < 3; k++) {
        pair->a[k] = search->mesh->positions[t[(first_a + k) % 3]];
        pair->b[k] = search->mesh->positions[u[(first_b + k) % 3]];
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

static void test_pair(const Search *search, uint32_t i, uint32_t j, MeshCrossings *found)
{
    Pair pair;
    take_pair(search, i, j, &pair);
    if (pair.n_shared >= 2) return; /* neighbours along an edge have nothing else in common, folded ones apart */
    if (!(pair.n_shared == 1 ? cross_at_corner(&pair) : cross_apart(&pair))) return;
    if (found->n < COUNT_OF(found->first)) {
        found->first[found->n].triangles[0] = i < j ? i : j;
        found->first[found->n].triangles[1] = i < j ? j : i;
        found->first[found->n].place = place_of(&pair);
    }
    found->n++;
}

static void test_leaves(const Search *search, uint32_t leaf, uint32_t other, MeshCrossings *found)
{
    uint32_t end = (leaf + 1) * LEAF < search->n ? (leaf + 1) * LEAF : search->n;
    uint32_t other_end = (other + 1) * LEAF < search->n ? (other + 1) * LEAF : search->n;
    for (uint32_t i = leaf * LEAF; i < end; i++)
        for (uint32_t j = leaf == other ? i + 1 : other * LEAF; j < other_end; j++)
            if (boxes_meet(&search->boxes[i], &search->boxes[j]))
                test_pair(search, search->order[i], search->order[j], found);
}

/* Everything that meets the leaf's box, of this leaf and those behind it. */
static bool test_leaf(const Search *search, uint32_t leaf, uint64_t *pairs_left, MeshCrossings *found)
{
    const FloatBox *box = &search->nodes[search->n_leaves + leaf];
    uint32_t stack[TREE_DEPTH + 1], n = 0;
    stack[n++] = 1;
    while (n) {
        uint32_t node = stack[--n];
        if (!boxes_meet(box, &search->nodes[node])) continue;
        if (node >= search->n_leaves) {
            if (*pairs_left < LEAF * LEAF) return false;
            *pairs_left -= LEAF * LEAF;
            test_leaves(search, leaf, node - search->n_leaves, found);
            continue;
        }
        for (uint32_t child = 2 * node + 2;
             child-- > 2 * node;) { /* the nearer to the front last, so that it comes first */
            uint32_t last = child;
            while (last < search->n_leaves) last = 2 * last + 1;
            if (last - search->n_leaves >= leaf) stack[n++] = child;
        }
    }
    return true;
}

static void search_chunk(void *context, uint32_t chunk, unsigned worker)
{
    const Search *search = context;
    (void)worker;
    MeshCrossings *found = &search->found[chunk];
    uint64_t pairs_left = search->pairs_per_task;
    uint64_t end = ((uint64_t)chunk + 1) * CHUNK;
    for (uint32_t leaf = chunk * CHUNK; leaf < end && (uint64_t)leaf * LEAF < search->n; leaf++)
        if (!test_leaf(search, leaf, &pairs_left, found)) {
            found->gave_up = true;
            return;
        }
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
    const FloatBox *root = &search->nodes[1];
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

static Status run_search(Search *search, Pool *pool, MeshCrossings *found, Error *error)
{
    TRY(make_tree(search, error));
    uint32_t n_used = (uint32_t)(((uint64_t)search->n + LEAF - 1) / LEAF), n_chunks = (n_used + CHUNK - 1) / CHUNK;
    search->found = calloc(n_chunks + 1U, sizeof *search->found);
    if (!search->found)
        return fail_memory(error, n_chunks * sizeof *search->found, "the search for crossings in a mesh");
    search->pairs_per_task = most_pairs / (n_chunks + 1U);
    if (pool)
        pool_run(pool, n_chunks, search_chunk, search);
    else
        for (uint32_t chunk = 0; chunk < n_chunks; chunk++) search_chunk(search, chunk, 0);
    if (n_chunks) gather(search, n_chunks, found);
    return STATUS_OK;
}

Status mesh_find_crossings(const Mesh *mesh, Pool *pool, MeshCrossings *found, Error *error)
{
    *found = (MeshCrossings){0};
    uint32_t *ids = NULL;
    TRY(mesh_number_positions(mesh, &ids, error));
    Search search = {.mesh = mesh, .ids = ids};
    Status status = run_search(&search, pool, found, error);
    free(ids);
    free(search.order);
    free(search.boxes);
    free(search.nodes);
    free(search.found);
    return status;
}

/* implicit.c - closed meshes of what a function of space says is inside: marching tetrahedra.
 * The grid fills the bounds, with one more layer of points around them that counts as outside. Edges that lead out
 * there have their vertex at the point that they come from, so that what the bounds cut off ends flat.
 * Vertices stay on the edges that they belong to, so that every triangle stays in its own tetrahedron: no mesh crosses
 * itself. Where an edge is cut near its end this makes slivers, which are too small to be seen.
 * A function may jump from inside to outside: there the surface is where it jumps, found by halving alone. Its slope says
 * nothing there: the normals are those of the triangles, and how far these are off is found by asking on which side
 * places are. Edges between a jump and what is beside it are cut off by the grid, as all edges are.
 * Only two layers are kept in memory.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/implicit.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "mesh/grower.h"
#include "shape/implicit_blocks.h"

#define NO_VERTEX UINT32_MAX
#define CROSSING 0x80000000U /* no vertex yet: from here on the numbers of crossings */
enum { EDGES_PER_POINT = 8 /* the first is not used */, MAX_ROUNDS = 5, ROOT_STEPS = 12, SAMPLE_STRIDE = 7 };
/* A surface that is still crossed by this part of the values' difference when no shorter piece of the edge can be told apart, in so
 * many halvings, is a jump. */
#define JUMP_PART 1e-3
#define LEVEL_PART 1e-6 /* of an edge */
#define ROUNDING_PART 1e-9
/* Steps often stand at points of the grid. All edges that meet there have their vertex at the point itself then: places that differ by
 * rounding would make triangles that pass through each other. */
#define SNAP_PART 1e-5
enum { HALVINGS = 24 }; /* as fine as floats are */
/* A grid that is twice as fine as another takes eight times as long and cuts off half as much of the edges of steps: where a function
 * jumps, it is made so fine once less, and no finer where there are many steps already. */
enum { JUMP_POINTS_PART = 8, JUMP_TRIANGLES = 1000000 };
enum { CHUNK = 32 /* places on the surface that a thread takes at once */ };

/* Where the surface crosses an edge: all those of a layer are found, by all threads, before its triangles are made. */
typedef struct Crossing {
    Vec3 inner, outer;
    double inner_value, outer_value;
    Vec3 at, normal; /* found */
    bool jumps;      /* from this value to that */
    double before_jump, behind_jump;
} Crossing;

/* How far the surface is from the middle of a triangle. */
typedef struct Sample {
    Vec3 middle, normal; /* normal: of one where the function jumps, else zero */
    float distance;      /* found; HUGE_VALF: nothing can be said */
} Sample;

/* Of the points of a layer. */
typedef struct Layer {
    double *values;
    uint8_t *inside;    /* 1 where these are above 0, else 0 */
    uint32_t *vertices; /* on the edges that begin at a point: [point][direction] */
} Layer;

/* A point of the grid counts from 0 in the layer around, so that 1 .. n are the field's. */
typedef struct Marcher {
    const ImplicitField *field;
    Lattice lattice;
    size_t width, height; /* of a layer with what is around it */
    Layer layers[2];      /* k and k + 1 */
    Blocks blocks;
    double *row;
    uint8_t *wanted; /* of the row */
    Grower grower;
    struct Cube *cubes; /* of the layer at hand: those that the surface crosses, */
    size_t n_cubes, cubes_capacity;
    Crossing *crossings; /* and where it crosses their edges */
    size_t n_crossings, crossings_capacity;
    double most_change; /* of the function, along an edge that is crossed */
    Sample *samples;
    size_t n_samples, samples_capacity, n_seen;
    bool *jumps; /* of vertices, as far as any has been one where the function jumps */
    size_t n_jumps, jumps_capacity;
    ImplicitFound *found;
    Pool *pool;
    bool stopped;
} Marcher;

static double corner_value(const Marcher *marcher, size_t i, size_t j, unsigned layer)
{
    return marcher->layers[layer].values[j * marcher->width + i];
}

static Vec3 grid_point(const Marcher *marcher, size_t i, size_t j, size_t k)
{
    const Lattice *l = &marcher->lattice;
    return vec3(l->origin.x + l->step.x * ((double)i - 1), l->origin.y + l->step.y * ((double)j - 1),
                l->origin.z + l->step.z * ((double)k - 1));
}

static double shortest_step(const Marcher *marcher)
{
    Vec3 step = marcher->lattice.step;
    return fmin(step.x, fmin(step.y, step.z));
}

/* ---- asking the function ---- */

/* One who asks, until there is no answer. */
typedef struct Asker {
    const Marcher *marcher;
    bool (*value)(void *context, Vec3 p, double *value);
    bool stopped;
} Asker;

static double field_value(Asker *asker, Vec3 p)
{
    double value = -1;
    if (!asker->stopped && !asker->value(asker->marcher->field->context, p, &value)) asker->stopped = true;
    return value;
}

static Vec3 field_gradient(Asker *asker, Vec3 p)
{
    const ImplicitField *field = asker->marcher->field;
    Vec3 gradient = {0, 0, 0};
    if (field->gradient) {
        if (!asker->stopped && !field->gradient(field->context, p, &gradient)) asker->stopped = true;
        return gradient;
    }
    double h = 1e-3 * shortest_step(asker->marcher);
    gradient.x = field_value(asker, vec3(p.x + h, p.y, p.z)) - field_value(asker, vec3(p.x - h, p.y, p.z));
    gradient.y = field_value(asker, vec3(p.x, p.y + h, p.z)) - field_value(asker, vec3(p.x, p.y - h, p.z));
    gradient.z = field_value(asker, vec3(p.x, p.y, p.z + h)) - field_value(asker, vec3(p.x, p.y, p.z - h));
    return vec3_scale(gradient, 0.5 / h);
}

/* Things of which each asks for itself. */
typedef struct Asking {
    Marcher *marcher;
    void (*item)(Marcher *marcher, size_t index, Asker *asker);
    size_t n;
    atomic_bool unanswered;
} Asking;

static void task_of_chunk(void *context, uint32_t index, unsigned worker)
{
    (void)worker;
    Asking *asking = context;
    Asker asker = {asking->marcher, asking->marcher->field->shared_value, false};
    size_t first = (size_t)index * CHUNK;
    for (size_t i = first; i < first + CHUNK && i < asking->n; i++) asking->item(asking->marcher, i, &asker);
    if (asker.stopped) atomic_store(&asking->unanswered, true);
}

/* By all threads; where that is not possible, or one of them had no answer, one after the other. */
static void ask_all(Marcher *marcher, size_t n, void (*item)(Marcher *marcher, size_t index, Asker *asker))
{
    Asking asking = {.marcher = marcher, .item = item, .n = n};
    if (marcher->stopped) return;
    if (marcher->field->shared_value) {
        pool_run(n > CHUNK ? marcher->pool : NULL, (uint32_t)((n + CHUNK - 1) / CHUNK), task_of_chunk, &asking);
        if (!atomic_load(&asking.unanswered)) return;
    }
    Asker asker = {marcher, marcher->field->value, false};
    for (size_t i = 0; i < n && !asker.stopped; i++) item(marcher, i, &asker);
    marcher->stopped = asker.stopped;
}

/* A piece of the way from an inner to an outer point. */
typedef struct Bracket {
    double a, b, fa, fb; /* where it begins and ends, and what the function is there: fa > 0 >= fb */
} Bracket;

/* Halves the piece until the function hardly changes in it; whether it still does then, and so jumps. */
static bool is_jump(Asker *asker, const Crossing *crossing, Bracket *piece)
{
    Vec3 along = vec3_sub(crossing->outer, crossing->inner);
    double small = JUMP_PART * (crossing->inner_value - crossing->outer_value);
    for (int i = 0; i < HALVINGS && piece->fa - piece->fb > small && !asker->stopped; i++) {
        double t = 0.5 * (piece->a + piece->b), f = field_value(asker, vec3_along(crossing->inner, t, along));
        if (f > 0) {
            piece->a = t;
            piece->fa = f;
        } else {
            piece->b = t;
            piece->fb = f;
        }
    }
    return piece->fa - piece->fb > small;
}

/* Of a place where the function is the surface's, and where the piece was to end: whether it is so before that place, too. Then
 * the piece ends there. */
static bool is_level(Asker *asker, const Crossing *crossing, Bracket *piece)
{
    double t = piece->b - LEVEL_PART; /* where rounding cannot make it level */
    if (t <= piece->a) return false;
    double f = field_value(asker, vec3_along(crossing->inner, t, vec3_sub(crossing->outer, crossing->inner)));
    if (f > 0) return false;
    piece->b = t;
    piece->fb = f;
    return true;
}

/* The part of the way from an inner to an outer point, by the Illinois variant of regula falsi; where that does not come to an
 * end, it may be a jump. */
static double find_root(Asker *asker, Crossing *crossing)
{
    Bracket piece = {0, 1, crossing->inner_value, crossing->outer_value};
    double fa = piece.fa, fb = piece.fb, t = 0;
    Vec3 along = vec3_sub(crossing->outer, crossing->inner);
    double small = 1e-7 * (fa - fb);
    bool doubtful = true, level = false;
    int side = 0;
    for (int i = 0; i < ROOT_STEPS; i++) {
        t = fb < fa ? (piece.a * -fb + piece.b * fa) / (fa - fb) : 0.5 * (piece.a + piece.b);
        if (!(t > piece.a && t < piece.b)) t = 0.5 * (piece.a + piece.b);
        double f = field_value(asker, vec3_along(crossing->inner, t, along));
        bool at_end = fabs(f) <= small || asker->stopped;
        if (at_end && f != 0) {
            doubtful = false;
            break;
        }
        if (f > 0) {
            piece.a = t;
            piece.fa = fa = f;
            if (side == 1) fb *= 0.5;
            side = 1;
        } else {
            piece.b = t;
            piece.fb = fb = f;
            if (side == -1) fa *= 0.5;
            side = -1;
        }
        if (at_end) {
            doubtful = level = is_level(asker, crossing, &piece);
            break;
        }
    }
    /* edges that lie in the surface have values that are nothing but rounding */
    if (!doubtful || small < 1e-7 * ROUNDING_PART * asker->marcher->most_change) return t;
    crossing->jumps = is_jump(asker, crossing, &piece);
    if (crossing->jumps) {
        crossing->before_jump = piece.fa;
        crossing->behind_jump = piece.fb;
    }
    return crossing->jumps || level ? piece.b : t;
}

static void place_crossing(Marcher *marcher, size_t index, Asker *asker)
{
    Crossing *crossing = &marcher->crossings[index];
    double t = find_root(asker, crossing);
    crossing->at = vec3_along(crossing->inner, t, vec3_sub(crossing->outer, crossing->inner));
    if (crossing->jumps && t < SNAP_PART) crossing->at = crossing->inner;
    if (crossing->jumps && t > 1 - SNAP_PART) crossing->at = crossing->outer;
    crossing->normal = crossing->jumps ? vec3(0, 0, 0) : vec3_scale(field_gradient(asker, crossing->at), -1);
}

/* Goes from the middle of a triangle towards the surface, which is on the side where the function has the other sign. */
static double distance_along(Asker *asker, Vec3 middle, Vec3 normal, double most)
{
    bool inside = field_value(asker, middle) > 0;
    Vec3 along = inside ? normal : vec3_scale(normal, -1);
    double near = 0, far = 1e-4 * most;
    while (far < most && !asker->stopped && (field_value(asker, vec3_along(middle, far, along)) > 0) == inside) {
        near = far;
        far *= 2;
    }
    if (far >= most) return HUGE_VAL;
    for (int i = 0; i < 4; i++) {
        double t = 0.5 * (near + far);
        *((field_value(asker, vec3_along(middle, t, along)) > 0) == inside ? &near : &far) = t;
    }
    return far;
}

static void take_sample(Marcher *marcher, size_t index, Asker *asker)
{
    Sample *sample = &marcher->samples[index];
    if (vec3_dot(sample->normal, sample->normal) > 0) {
        double most = vec3_length(marcher->lattice.step);
        sample->distance = (float)distance_along(asker, sample->middle, sample->normal, most);
        return;
    }
    double slope = vec3_length(field_gradient(asker, sample->middle)), value = field_value(asker, sample->middle);
    double distance = fmin(fabs(value) / slope, vec3_length(marcher->lattice.step));
    sample->distance = slope > 0 ? (float)distance : HUGE_VALF;
}

/* ---- tetrahedra ---- */

/* Corners are numbers with one bit per axis; the corners of a tetrahedron are nested, as the numbers of a way
 * from 0 to 7. */
typedef struct Cube {
    size_t i, j, k; /* of corner 0 */
} Cube;

static bool is_around(const Marcher *marcher, const Cube *cube, unsigned corner)
{
    size_t i = cube->i + (corner & 1), j = cube->j + (corner >> 1 & 1), k = cube->k + (corner >> 2);
    return i == 0 || j == 0 || k == 0 || i > marcher->lattice.n[0] || j > marcher->lattice.n[1] ||
           k > marcher->lattice.n[2];
}

static Vec3 cube_point(const Marcher *marcher, const Cube *cube, unsigned corner)
{
    return grid_point(marcher, cube->i + (corner & 1), cube->j + (corner >> 1 & 1), cube->k + (corner >> 2));
}

/* What is on the edge between two corners: a vertex, or a crossing. */
static uint32_t *edge_place(const Marcher *marcher, const Cube *cube, unsigned one, unsigned other)
{
    unsigned low = one & other, direction = one ^ other;
    size_t i = cube->i + (low & 1), j = cube->j + (low >> 1 & 1);
    return &marcher->layers[low >> 2].vertices[(j * marcher->width + i) * EDGES_PER_POINT + direction];
}

static double value_at_corner(const Marcher *marcher, const Cube *cube, unsigned corner)
{
    return corner_value(marcher, cube->i + (corner & 1), cube->j + (corner >> 1 & 1), corner >> 2);
}

/* Notes where the surface crosses the edge between two corners. */
static void note_crossing(Marcher *marcher, const Cube *cube, unsigned inner, unsigned outer)
{
    uint32_t *place = edge_place(marcher, cube, inner, outer);
    if (*place != NO_VERTEX || is_around(marcher, cube, outer)) return;
    if (!ARRAY_ROOM(marcher->crossings, marcher->crossings_capacity, marcher->n_crossings)) {
        marcher->grower.out_of_memory = true;
        return;
    }
    marcher->crossings[marcher->n_crossings] = (Crossing){.inner = cube_point(marcher, cube, inner),
                                                          .outer = cube_point(marcher, cube, outer),
                                                          .inner_value = value_at_corner(marcher, cube, inner),
                                                          .outer_value = value_at_corner(marcher, cube, outer)};
    *place = CROSSING + (uint32_t)marcher->n_crossings++;
}

static void note_crossings(Marcher *marcher, const Cube *cube)
{
    for (unsigned high = 1; high < 8; high++)
        for (unsigned low = 0; low < high; low++) {
            if ((low & high) != low) continue; /* no edge of a tetrahedron */
            bool low_is_inside = value_at_corner(marcher, cube, low) > 0;
            if (low_is_inside == (value_at_corner(marcher, cube, high) > 0)) continue;
            note_crossing(marcher, cube, low_is_inside ? low : high, low_is_inside ? high : low);
        }
}

/* Remembers that the function jumps at a vertex, and where it does so most. */
static void note_jump(Marcher *marcher, uint32_t vertex, const Crossing *crossing)
{
    if (!array_reserve(&marcher->jumps, &marcher->jumps_capacity, (size_t)vertex + 1, sizeof *marcher->jumps)) {
        marcher->grower.out_of_memory = true;
        return;
    }
    while (marcher->n_jumps < vertex) marcher->jumps[marcher->n_jumps++] = false;
    marcher->jumps[vertex] = true;
    marcher->n_jumps = (size_t)vertex + 1;
    ImplicitFound *found = marcher->found;
    double jump = crossing->before_jump - crossing->behind_jump;
    if (found->jumps && jump <= found->inner_value - found->outer_value) return;
    found->jumps = true;
    found->jump_at = crossing->at;
    found->inner_value = crossing->before_jump;
    found->outer_value = crossing->behind_jump;
}

static bool jumps_at(const Marcher *marcher, uint32_t vertex)
{
    return vertex < marcher->n_jumps && marcher->jumps[vertex];
}

/* The vertex on the edge between two corners, one of which is inside. */
static uint32_t edge_vertex(Marcher *marcher, const Cube *cube, unsigned inner, unsigned outer)
{
    uint32_t *place = edge_place(marcher, cube, inner, outer);
    if (*place < CROSSING) return *place;
    size_t number = *place - CROSSING;
    const Crossing *crossing = number < marcher->n_crossings ? &marcher->crossings[number] : NULL;
    if (crossing)
        *place = grower_vertex(&marcher->grower, crossing->at, crossing->normal);
    else
        *place = grower_vertex(&marcher->grower, cube_point(marcher, cube, inner), vec3(0, 0, 0));
    if (*place >= CROSSING) marcher->grower.out_of_memory = true;
    if (crossing && crossing->jumps && !marcher->grower.out_of_memory) note_jump(marcher, *place, crossing);
    return *place;
}

static Vec3 grown_point(const Marcher *marcher, uint32_t vertex)
{
    return vec3_from_f(marcher->grower.positions[vertex]);
}

static void note_sample(Marcher *marcher, Vec3 a, Vec3 b, Vec3 c, bool jumps)
{
    if (!ARRAY_ROOM(marcher->samples, marcher->samples_capacity, marcher->n_samples)) {
        marcher->grower.out_of_memory = true;
        return;
    }
    Vec3 middle = vec3_scale(vec3_add(a, vec3_add(b, c)), 1.0 / 3);
    Vec3 normal = jumps ? vec3_cross(vec3_sub(b, a), vec3_sub(c, a)) : vec3(0, 0, 0);
    double length = vec3_length(normal);
    if (jumps && !(length > 0)) return;
    marcher->samples[marcher->n_samples++] =
        (Sample){.middle = middle, .normal = jumps ? vec3_scale(normal, 1 / length) : normal};
}

static int compare_samples(const void *left, const void *right)
{
    const Sample *a = left, *b = right;
    return a->distance < b->distance ? -1 : a->distance > b->distance;
}

/* The distance that all samples but one in a hundred keep to: where the surface meets itself at a point or an edge, the
 * function's slope says nothing, and no grid is fine enough. */
static double measured_distance(Marcher *marcher)
{
    if (!marcher->n_samples) return 0;
    qsort(marcher->samples, marcher->n_samples, sizeof *marcher->samples, compare_samples);
    size_t n = marcher->n_samples;
    while (n > 0 && marcher->samples[n - 1].distance == HUGE_VALF) n--;
    return n ? (double)marcher->samples[(n - 1) - n / 100].distance : 0;
}

static void add_triangle(Marcher *marcher, uint32_t a, uint32_t b, uint32_t c, bool flat)
{
    if (marcher->grower.out_of_memory) return;
    Vec3 pa = grown_point(marcher, a), pb = grown_point(marcher, b), pc = grown_point(marcher, c);
    if (flat) { /* where the bounds cut: vertices of its own */
        Vec3 normal = vec3_cross(vec3_sub(pb, pa), vec3_sub(pc, pa));
        a = grower_vertex(&marcher->grower, pa, normal);
        b = grower_vertex(&marcher->grower, pb, normal);
        c = grower_vertex(&marcher->grower, pc, normal);
    } else if (marcher->n_seen++ % SAMPLE_STRIDE == 0) {
        note_sample(marcher, pa, pb, pc, jumps_at(marcher, a) || jumps_at(marcher, b) || jumps_at(marcher, c));
    }
    grower_triangle(&marcher->grower, a, b, c);
}

/* positive: the steps from the first corner to the others make a right-handed frame. */
static void march_tetrahedron(Marcher *marcher, const Cube *cube, const unsigned corners[4], bool positive)
{
    unsigned order[4], n_inside = 0;
    bool flat = false, even = positive;
    int placed[4], n_placed = 0;
    for (int pass = 0; pass < 2; pass++) /* those inside first */
        for (int c = 0; c < 4; c++) {
            unsigned corner = corners[c];
            if ((value_at_corner(marcher, cube, corner) > 0) != (pass == 0)) continue;
            placed[n_placed] = c;
            order[n_placed++] = corner;
            n_inside += pass == 0;
        }
    if (n_inside == 0 || n_inside == 4) return;
    for (int a = 0; a < 4; a++)
        for (int b = a + 1; b < 4; b++)
            if (placed[a] > placed[b]) even = !even;
    for (int c = 0; c < 4; c++) flat = flat || is_around(marcher, cube, corners[c]);
    uint32_t v[4];
    if (n_inside == 2) {
        v[0] = edge_vertex(marcher, cube, order[0], order[2]);
        v[1] = edge_vertex(marcher, cube, order[0], order[3]);
        v[2] = edge_vertex(marcher, cube, order[1], order[3]);
        v[3] = edge_vertex(marcher, cube, order[1], order[2]);
        add_triangle(marcher, v[0], v[even ? 1 : 2], v[even ? 2 : 1], flat);
        add_triangle(marcher, v[0], v[even ? 2 : 3], v[even ? 3 : 2], flat);
        return;
    }
    for (int c = 0; c < 3; c++)
        v[c] = n_inside == 1 ? edge_vertex(marcher, cube, order[0], order[c + 1])
                             : edge_vertex(marcher, cube, order[c], order[3]);
    /* three inside: seen from the single one outside; moving it to the front is an odd exchange */
    add_triangle(marcher, v[0], v[even ? 1 : 2], v[even ? 2 : 1], flat);
}

static void march_cube(Marcher *marcher, const Cube *cube)
{
    static const struct {
        unsigned corners[4];
        bool positive; /* the three steps of the way from 0 to 7 make a right-handed frame */
    } tetrahedra[6] = {{{0, 1, 3, 7}, true},  {{0, 2, 6, 7}, true},  {{0, 4, 5, 7}, true},
                       {{0, 2, 3, 7}, false}, {{0, 4, 6, 7}, false}, {{0, 1, 5, 7}, false}};
    for (int t = 0; t < 6; t++) march_tetrahedron(marcher, cube, tetrahedra[t].corners, tetrahedra[t].positive);
}

/* ---- layers ---- */

/* Layer k of the grid with what is around it, into the place `at`. */
static void fill_layer(Marcher *marcher, size_t k, Layer *layer)
{
    size_t width = marcher->width, n_points = width * marcher->height;
    memset(layer->vertices, 0xff, n_points * EDGES_PER_POINT * sizeof *layer->vertices);
    memset(layer->inside, 0, n_points);
    for (size_t i = 0; i < n_points; i++) layer->values[i] = -1;
    if (k == 0 || k > marcher->lattice.n[2]) return;
    const uint8_t *wanted = marcher->blocks.sides ? marcher->wanted : NULL;
    if (wanted) blocks_of_layer(&marcher->blocks, &marcher->lattice, (uint32_t)(k - 1), marcher->wanted, marcher->row);
    if (!marcher->field->layer(marcher->field->context, &marcher->lattice, (uint32_t)(k - 1), wanted, marcher->row)) {
        marcher->stopped = true;
        return;
    }
    for (size_t j = 0; j < marcher->lattice.n[1]; j++) {
        const double *from = marcher->row + j * marcher->lattice.n[0];
        size_t to = (j + 1) * width + 1;
        memcpy(layer->values + to, from, marcher->lattice.n[0] * sizeof *from);
        for (size_t i = 0; i < marcher->lattice.n[0]; i++) layer->inside[to + i] = from[i] > 0;
    }
}

/* Whether all of the eight cubes from one on are on one side: cubes, say of a row of n points, at four rows of their corners. */
static bool are_eight_apart(const uint8_t *const rows[4], size_t i)
{
    uint64_t any = 0, all = UINT64_MAX;
    uint8_t any_behind = 0, all_behind = 1;
    for (int r = 0; r < 4; r++) {
        uint64_t eight;
        memcpy(&eight, rows[r] + i, sizeof eight);
        any |= eight;
        all &= eight;
        any_behind |= rows[r][i + 8];
        all_behind &= rows[r][i + 8];
    }
    return (any == 0 && !any_behind) || (all == 0x0101010101010101U && all_behind);
}

/* Notes the cubes of a row that the surface crosses, and where it crosses their edges. */
static void note_row(Marcher *marcher, size_t j, size_t k)
{
    size_t w = marcher->width, at = j * w;
    const uint8_t *low = marcher->layers[0].inside + at, *high = marcher->layers[1].inside + at;
    const uint8_t *const rows[4] = {low, low + w, high, high + w};
    for (size_t i = 0; i + 1 < w && !marcher->grower.out_of_memory; i++) {
        while (i + 8 < w && are_eight_apart(rows, i)) i += 8;
        int n = 0;
        for (int r = 0; r < 4 && i + 1 < w; r++) n += rows[r][i] + rows[r][i + 1];
        if (n == 0 || n == 8) continue;
        if (!ARRAY_ROOM(marcher->cubes, marcher->cubes_capacity, marcher->n_cubes)) {
            marcher->grower.out_of_memory = true;
            return;
        }
        Cube cube = {i, j, k};
        marcher->cubes[marcher->n_cubes++] = cube;
        note_crossings(marcher, &cube);
    }
}

static void march_layer(Marcher *marcher, size_t k)
{
    marcher->n_crossings = marcher->n_cubes = 0;
    for (size_t j = 0; j + 1 < marcher->height; j++) note_row(marcher, j, k);
    if (marcher->grower.out_of_memory) return;
    marcher->most_change = 0;
    for (size_t i = 0; i < marcher->n_crossings; i++) {
        const Crossing *crossing = &marcher->crossings[i];
        marcher->most_change = fmax(marcher->most_change, crossing->inner_value - crossing->outer_value);
    }
    ask_all(marcher, marcher->n_crossings, place_crossing);
    for (size_t i = 0; i < marcher->n_cubes && !marcher->stopped; i++) march_cube(marcher, &marcher->cubes[i]);
}

static void clear_marcher(Marcher *marcher)
{
    for (int i = 0; i < 2; i++) {
        free(marcher->layers[i].values);
        free(marcher->layers[i].inside);
        free(marcher->layers[i].vertices);
    }
    blocks_clear(&marcher->blocks);
    free(marcher->row);
    free(marcher->wanted);
    free(marcher->cubes);
    free(marcher->crossings);
    free(marcher->samples);
    free(marcher->jumps);
    grower_clear(&marcher->grower);
}

static Status march(Marcher *marcher, Error *error)
{
    size_t n_points = marcher->width * marcher->height;
    bool ready = true;
    for (int i = 0; i < 2; i++) {
        Layer *layer = &marcher->layers[i];
        layer->values = malloc(n_points * sizeof *layer->values);
        layer->inside = malloc(n_points);
        layer->vertices = malloc(n_points * EDGES_PER_POINT * sizeof *layer->vertices);
        ready = ready && layer->values && layer->inside && layer->vertices;
    }
    marcher->row = malloc(n_points * sizeof(double));
    marcher->wanted = malloc(n_points);
    if (!ready || !marcher->row || !marcher->wanted) return fail_memory(error, n_points * 100, "an implicit surface");
    TRY(blocks_make(marcher->field, &marcher->lattice, marcher->pool, &marcher->blocks, error));
    fill_layer(marcher, 0, &marcher->layers[0]);
    for (size_t k = 0; k <= marcher->lattice.n[2] && !marcher->stopped; k++) {
        fill_layer(marcher, k + 1, &marcher->layers[1]);
        march_layer(marcher, k);
        Layer done = marcher->layers[0];
        marcher->layers[0] = marcher->layers[1];
        marcher->layers[1] = done;
    }
    ask_all(marcher, marcher->n_samples, take_sample);
    return STATUS_OK;
}

static Lattice lattice_of(Box3 bounds, double step)
{
    Lattice lattice = {.origin = bounds.min};
    const double sides[3] = {bounds.max.x - bounds.min.x, bounds.max.y - bounds.min.y, bounds.max.z - bounds.min.z};
    for (int axis = 0; axis < 3; axis++) lattice.n[axis] = (uint32_t)fmin(fmax(ceil(sides[axis] / step), 1), 1e6) + 1;
    lattice.step = vec3(sides[0] / (lattice.n[0] - 1), sides[1] / (lattice.n[1] - 1), sides[2] / (lattice.n[2] - 1));
    return lattice;
}

static double n_points_of(const Lattice *lattice)
{
    return (double)lattice->n[0] * lattice->n[1] * lattice->n[2];
}

/* How many times as fine a grid may be; n_triangles: of its mesh, or 0. */
static double fineness_left(const ImplicitOptions *options, bool jumps, const Lattice *lattice, size_t n_triangles)
{
    double most = (double)options->max_points / (jumps ? JUMP_POINTS_PART : 1);
    double fineness = cbrt(most / n_points_of(lattice));
    return jumps && n_triangles ? fmin(fineness, sqrt(JUMP_TRIANGLES / (double)n_triangles)) : fineness;
}

/* By what the step is to be multiplied for the distance to become the tolerance. Chords are off by the square of their length; a little
 * more. But where they are off by much of a step, as where a sheet is about as thin, they do not follow the surface yet, and
 * how far they are off says nothing of finer ones: then it is halved, and looked at again. Steps of a function that jumps are never
 * followed. */
static double finer_step(double tolerance, double distance, double step, bool jumps)
{
    const double follows = 0.1, least = jumps || distance < follows * step ? 0.1 : 0.5;
    return fmin(fmax(0.85 * sqrt(tolerance / distance), least), 0.75);
}

Status mesh_make_implicit(const ImplicitField *field, const ImplicitOptions *options, const char *what, Mesh **mesh,
                          ImplicitFound *found, Error *error)
{
    Vec3 size = vec3_sub(options->bounds.max, options->bounds.min);
    double step = vec3_max_abs(size) / options->cells;
    *mesh = NULL;
    *found = (ImplicitFound){.jumps = false};
    for (int round = 0; round < MAX_ROUNDS; round++) {
        Marcher marcher = {
            .field = field, .lattice = lattice_of(options->bounds, step), .found = found, .pool = options->pool};
        double fineness = fineness_left(options, found->jumps, &marcher.lattice, 0);
        if (*mesh && fineness < 1) break;
        marcher.width = marcher.lattice.n[0] + 2;
        marcher.height = marcher.lattice.n[1] + 2;
        Status status = march(&marcher, error);
        if (status == STATUS_OK && marcher.stopped) status = STATUS_SCENE;
        Mesh *made = NULL;
        if (status == STATUS_OK && !marcher.grower.n_triangles && !marcher.grower.out_of_memory)
            status = fail(error, STATUS_SCENE, "%s has nothing inside", what);
        if (status == STATUS_OK) status = grower_finish(&marcher.grower, what, &made, error);
        double distance = measured_distance(&marcher);
        Lattice lattice = marcher.lattice;
        clear_marcher(&marcher);
        mesh_free(*mesh);
        *mesh = made;
        if (status != STATUS_OK) return status;
        found->reached = distance;
        if (distance <= options->tolerance) break;
        fineness = fineness_left(options, found->jumps, &lattice, made->n_triangles);
        if (found->jumps && fineness < 1) break;
        double finer =
            finer_step(options->tolerance, distance, step, found->jumps); /* and not beyond what is allowed */
        step *= fmax(finer, fmin(1 / fineness * 1.001, 0.97));
    }
    return STATUS_OK;
}

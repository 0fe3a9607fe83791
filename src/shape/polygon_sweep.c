/* polygon_sweep.c - what is inside of a set of edges, and its triangles.
 *
 * A line is swept over the plane, upwards and, at equal height, to the right (so no two points are level). It keeps
 * the edges that it cuts from left to right, and for each stretch between two of them, if that is inside, the part of
 * it that has no triangles yet. Such a part is monotone: its boundary goes up on the left and on the right. At a point
 * where two stretches become one, the two parts wait side by side; the next point that the stretch sees ends one of
 * them. At a point where one becomes two, the newest point of the stretch is joined to it. So every part stays
 * monotone, and is cut into triangles with a stack when it ends (M. de Berg et al., Computational Geometry, 3.3).
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/polygon_sweep.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"

#define NONE UINT32_MAX

typedef enum Side { LEFT, RIGHT } Side;

/* A point on the boundary of a part; the parts are linked lists in one array. */
typedef struct Link {
    uint32_t point, next;
    Side side;
} Link;

typedef struct Part {
    uint32_t head, tail, n;
} Part;

/* The stretch to the right of an edge. */
typedef struct Stretch {
    bool inside;
    uint32_t part, waiting; /* waiting: the right one of two parts; NONE */
} Stretch;

typedef struct Active {
    uint32_t edge;
    int32_t winding; /* on its right */
    Stretch right;
} Active;

typedef struct Sweep {
    const SweepInput *input;
    Active *line; /* the edges cut by the line, from left to right */
    size_t n_line, line_capacity;
    Link *links;
    size_t n_links, links_capacity;
    Part *parts;
    size_t n_parts, parts_capacity;
    Link *stack, *row;
    size_t stack_capacity, row_capacity;
    uint32_t (*triangles)[3];
    size_t n_triangles, triangles_capacity;
    bool wants_triangles, out_of_memory;
} Sweep;

static bool is_inside(FillRule rule, int32_t winding)
{
    return rule == FILL_EVEN_ODD ? (winding & 1) != 0 : winding != 0;
}

static int orient(const Sweep *sweep, uint32_t a, uint32_t b, uint32_t c)
{
    const Point2 *p = sweep->input->points;
    return exact_turn(p[a], p[b], p[c]);
}

/* ---- parts ---- */

static uint32_t add_link(Sweep *sweep, uint32_t point, Side side)
{
    if (!ARRAY_ROOM(sweep->links, sweep->links_capacity, sweep->n_links)) {
        sweep->out_of_memory = true;
        return NONE;
    }
    sweep->links[sweep->n_links] = (Link){point, NONE, side};
    return (uint32_t)sweep->n_links++;
}

static uint32_t begin_part(Sweep *sweep, uint32_t point)
{
    if (!sweep->wants_triangles || sweep->out_of_memory) return NONE;
    uint32_t link = add_link(sweep, point, LEFT);
    if (link == NONE || !ARRAY_ROOM(sweep->parts, sweep->parts_capacity, sweep->n_parts)) {
        sweep->out_of_memory = true;
        return NONE;
    }
    sweep->parts[sweep->n_parts] = (Part){link, link, 1};
    return (uint32_t)sweep->n_parts++;
}

static void extend_part(Sweep *sweep, uint32_t part, uint32_t point, Side side)
{
    if (part == NONE || sweep->out_of_memory) return;
    uint32_t link = add_link(sweep, point, side);
    if (link == NONE) return;
    sweep->links[sweep->parts[part].tail].next = link;
    sweep->parts[part].tail = link;
    sweep->parts[part].n++;
}

static void emit(Sweep *sweep, uint32_t a, uint32_t b, uint32_t c)
{
    if (!ARRAY_ROOM(sweep->triangles, sweep->triangles_capacity, sweep->n_triangles)) {
        sweep->out_of_memory = true;
        return;
    }
    uint32_t *t = sweep->triangles[sweep->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

/* The point faces the whole stack from the other side. */
static void emit_fan(Sweep *sweep, uint32_t point, size_t n_stack, Side side)
{
    for (size_t i = 0; i + 1 < n_stack; i++) {
        uint32_t a = sweep->stack[i].point, b = sweep->stack[i + 1].point;
        if (side == LEFT)
            emit(sweep, point, a, b);
        else
            emit(sweep, point, b, a);
    }
}

static void cut_part(Sweep *sweep, uint32_t n)
{
    Link *row = sweep->row, *stack = sweep->stack;
    stack[0] = row[0];
    stack[1] = row[1];
    size_t n_stack = 2;
    for (uint32_t i = 2; i + 1 < n; i++) {
        if (row[i].side != stack[n_stack - 1].side) {
            emit_fan(sweep, row[i].point, n_stack, row[i].side);
            stack[0] = row[i - 1];
            n_stack = 1;
        } else {
            int convex = row[i].side == RIGHT ? 1 : -1;
            while (n_stack > 1) {
                uint32_t top = stack[n_stack - 1].point, below = stack[n_stack - 2].point;
                if (orient(sweep, below, top, row[i].point) != convex) break;
                if (convex > 0)
                    emit(sweep, below, top, row[i].point);
                else
                    emit(sweep, below, row[i].point, top);
                n_stack--;
            }
        }
        stack[n_stack++] = row[i];
    }
    emit_fan(sweep, row[n - 1].point, n_stack, stack[n_stack - 1].side == LEFT ? RIGHT : LEFT);
}

/* The part ends at that point. */
static void end_part(Sweep *sweep, uint32_t part, uint32_t point)
{
    extend_part(sweep, part, point, LEFT);
    if (part == NONE || sweep->out_of_memory) return;
    uint32_t n = sweep->parts[part].n;
    if (n < 3) return;
    if (!array_reserve(&sweep->row, &sweep->row_capacity, n, sizeof *sweep->row) ||
        !array_reserve(&sweep->stack, &sweep->stack_capacity, n, sizeof *sweep->stack)) {
        sweep->out_of_memory = true;
        return;
    }
    uint32_t link = sweep->parts[part].head;
    for (uint32_t i = 0; i < n; i++, link = sweep->links[link].next) sweep->row[i] = sweep->links[link];
    cut_part(sweep, n);
}

/* ---- stretches ---- */

static const Stretch outside = {false, NONE, NONE};

static Stretch begin_stretch(Sweep *sweep, bool inside, uint32_t point)
{
    return (Stretch){inside, inside ? begin_part(sweep, point) : NONE, NONE};
}

/* The point is the next one on the stretch's left border. */
static void touch_left(Sweep *sweep, Stretch *stretch, uint32_t point)
{
    if (!stretch->inside) return;
    if (stretch->waiting != NONE) {
        end_part(sweep, stretch->part, point);
        stretch->part = stretch->waiting;
        stretch->waiting = NONE;
    }
    extend_part(sweep, stretch->part, point, LEFT);
}

static void touch_right(Sweep *sweep, Stretch *stretch, uint32_t point)
{
    if (!stretch->inside) return;
    if (stretch->waiting != NONE) {
        end_part(sweep, stretch->waiting, point);
        stretch->waiting = NONE;
    }
    extend_part(sweep, stretch->part, point, RIGHT);
}

static void end_stretch(Sweep *sweep, const Stretch *stretch, uint32_t point)
{
    if (!stretch->inside) return;
    end_part(sweep, stretch->part, point);
    if (stretch->waiting != NONE) end_part(sweep, stretch->waiting, point);
}

/* A point within the stretch, from which edges go up: what is left and right of them. */
static void split_stretch(Sweep *sweep, const Stretch *stretch, uint32_t point, Stretch *left, Stretch *right)
{
    *left = *right = (Stretch){stretch->inside, stretch->part, NONE};
    if (!stretch->inside || stretch->part == NONE || sweep->out_of_memory) return;
    if (stretch->waiting != NONE) {
        right->part = stretch->waiting;
    } else {
        const Link *newest = &sweep->links[sweep->parts[stretch->part].tail];
        Side side = newest->side;
        uint32_t other = begin_part(sweep, newest->point);
        if (side == LEFT)
            left->part = other;
        else
            right->part = other;
    }
    extend_part(sweep, left->part, point, RIGHT);
    extend_part(sweep, right->part, point, LEFT);
}

/* ---- the sweep ---- */

/* How many edges of the line have the point strictly on their right: the others follow. */
static size_t find_place(const Sweep *sweep, uint32_t point)
{
    size_t low = 0, high = sweep->n_line;
    while (low < high) {
        size_t middle = (low + high) / 2;
        const SweepEdge *edge = &sweep->input->edges[sweep->line[middle].edge];
        if (edge->high != point && orient(sweep, edge->low, edge->high, point) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Replaces n_old edges of the line from `place` on. */
static bool replace_edges(Sweep *sweep, size_t place, size_t n_old, size_t n_new)
{
    if (!array_reserve(&sweep->line, &sweep->line_capacity, sweep->n_line + n_new + 1, sizeof *sweep->line))
        return false;
    memmove(sweep->line + place + n_new, sweep->line + place + n_old,
            (sweep->n_line - place - n_old) * sizeof *sweep->line);
    sweep->n_line = sweep->n_line - n_old + n_new;
    return true;
}

/* The edges that go up from the point, numbers in `up`, from left to right. */
static void visit_point(Sweep *sweep, uint32_t point, const uint32_t *up, size_t n_up)
{
    const SweepInput *input = sweep->input;
    size_t place = find_place(sweep, point), end = place;
    while (end < sweep->n_line && input->edges[sweep->line[end].edge].high == point) end++;
    size_t n_down = end - place;
    Stretch left = place ? sweep->line[place - 1].right : outside;
    Stretch right = n_down ? sweep->line[end - 1].right : left;
    int32_t winding = place ? sweep->line[place - 1].winding : 0;
    for (size_t i = place; i + 1 < end; i++) end_stretch(sweep, &sweep->line[i].right, point);
    if (n_down) {
        touch_right(sweep, &left, point);
        touch_left(sweep, &right, point);
        if (!n_up) left.waiting = right.part; /* none or both are inside */
    } else if (n_up) {
        Stretch whole = left;
        split_stretch(sweep, &whole, point, &left, &right);
    }
    if (!replace_edges(sweep, place, n_down, n_up)) {
        sweep->out_of_memory = true;
        return;
    }
    if (place) sweep->line[place - 1].right = left;
    for (size_t i = 0; i < n_up; i++) {
        SweepEdge *edge = &input->edges[up[i]];
        edge->inside_left = is_inside(input->rule, winding);
        winding -= edge->winding; /* what is walked upwards has its inside on the left */
        edge->inside_right = is_inside(input->rule, winding);
        Active *active = &sweep->line[place + i];
        *active = (Active){up[i], winding, right};
        if (i + 1 < n_up) active->right = begin_stretch(sweep, edge->inside_right, point);
    }
}

typedef struct PointKey {
    Point2 at;
    uint32_t point;
} PointKey;

static int compare_points(const void *left, const void *right)
{
    const PointKey *a = left, *b = right;
    return sweep_before(a->at, b->at) ? -1 : sweep_before(b->at, a->at);
}

/* The edges by their lower ends, and around each from left to right. first[i] .. first[i + 1] are those of point i. */
static void sort_edges(const Sweep *sweep, uint32_t *first, uint32_t *sorted)
{
    const SweepInput *input = sweep->input;
    for (size_t i = 0; i < input->n_edges; i++) first[input->edges[i].low + 1]++;
    for (size_t i = 0; i < input->n_points; i++) first[i + 1] += first[i];
    for (size_t i = input->n_edges; i > 0; i--) { /* fills each group from its front, moving first[] to its end */
        const SweepEdge *edge = &input->edges[i - 1];
        uint32_t at = first[edge->low]++;
        sorted[at] = (uint32_t)(i - 1);
    }
    for (size_t i = input->n_points; i > 0; i--) first[i] = first[i - 1];
    first[0] = 0;
    for (size_t i = 0; i < input->n_points; i++) /* few to a point: by insertion */
        for (uint32_t k = first[i] + 1; k < first[i + 1]; k++)
            for (uint32_t j = k; j > first[i]; j--) {
                const SweepEdge *a = &input->edges[sorted[j - 1]], *b = &input->edges[sorted[j]];
                if (orient(sweep, a->low, a->high, b->high) <= 0) break; /* b is to the right, as it should be */
                uint32_t keep = sorted[j];
                sorted[j] = sorted[j - 1];
                sorted[j - 1] = keep;
            }
}

Status polygon_sweep(const SweepInput *input, uint32_t (**triangles)[3], size_t *n_triangles, Error *error)
{
    Sweep sweep = {.input = input, .wants_triangles = triangles != NULL};
    PointKey *order = malloc((input->n_points + 1) * sizeof *order);
    uint32_t *first = calloc(input->n_points + 2, sizeof *first);
    uint32_t *sorted = malloc((input->n_edges + 1) * sizeof *sorted);
    sweep.out_of_memory = !order || !first || !sorted;
    if (!sweep.out_of_memory) {
        for (size_t i = 0; i < input->n_points; i++) order[i] = (PointKey){input->points[i], (uint32_t)i};
        qsort(order, input->n_points, sizeof *order, compare_points);
        sort_edges(&sweep, first, sorted);
        for (size_t i = 0; i < input->n_points && !sweep.out_of_memory; i++) {
            uint32_t point = order[i].point;
            visit_point(&sweep, point, sorted + first[point], first[point + 1] - first[point]);
        }
    }
    free(order);
    free(first);
    free(sorted);
    free(sweep.line);
    free(sweep.links);
    free(sweep.parts);
    free(sweep.stack);
    free(sweep.row);
    if (sweep.out_of_memory) {
        free(sweep.triangles);
        return fail_memory(error, input->n_points * 128, "an outline");
    }
    if (triangles) {
        *triangles = sweep.triangles;
        *n_triangles = sweep.n_triangles;
    }
    return STATUS_OK;
}

/* slice.c - cross-sections, drawn from exact lines.
 *
 * Every row of pixels has LINES lines along it and every column as many. A line is cut into runs by the surfaces that
 * it crosses, and each run has one owner. Rows give the colours; rows and columns together give the boundaries, each
 * the ones that it crosses steeply.
 * SPDX-License-Identifier: Apache-2.0 */
#include "check/slice.h"

#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "scene/lines.h"

enum { LINES = 3 /* odd: one of them runs through the middle */, HATCH = 8, HATCH_STRIPE = 3 };
static const double line_width = 1.3, gap_width = 2.2; /* pixels */
static const double thin_gap = 1.5;                    /* pixels along a line: what is narrower is marked */

const float slice_opaque_color[3] = {0.36f, 0.33f, 0.31f};
const float slice_gap_color[3] = {0.88f, 0.04f, 0.10f};
const float slice_line_color[3] = {0.08f, 0.08f, 0.10f};

void slice_color(uint32_t medium, float rgb[3])
{
    static const float palette[][3] = {{0.68f, 0.85f, 0.80f}, {0.52f, 0.72f, 0.93f}, {0.97f, 0.76f, 0.45f},
                                       {0.78f, 0.72f, 0.93f}, {0.70f, 0.86f, 0.52f}, {0.96f, 0.66f, 0.70f},
                                       {0.93f, 0.90f, 0.52f}, {0.60f, 0.82f, 0.95f}, {0.86f, 0.76f, 0.64f},
                                       {0.86f, 0.62f, 0.86f}};
    for (int i = 0; i < 3; i++) {
        rgb[i] = medium == 0 ? 1.0f : palette[(medium - 1) % COUNT_OF(palette)][i];
        /* the second time around they are darker */
        if (medium > COUNT_OF(palette)) rgb[i] *= 1 - 0.15f * (float)((medium - 1) / COUNT_OF(palette) % 4);
    }
}

/* ---- the plane ---- */

/* Plain comparisons: gcc 12 for arm64 fails on fmin and fmax in such loops. */
static void widen(double *low, double *high, double x)
{
    if (x < *low) *low = x;
    if (x > *high) *high = x;
}

bool slice_plane_make(const CompiledScene *compiled, Vec3 point, Vec3 normal, SlicePlane *plane)
{
    const double margin = 0.05;
    normal = vec3_normalize(normal);
    bool level = fabs(normal.y) > 0.999;
    Vec3 up = level ? vec3(0, 0, 1) : vec3(0, 1, 0);
    up = vec3_normalize(vec3_along(up, -vec3_dot(up, normal), normal));
    Vec3 right = vec3_cross(up, normal);
    if (right.x + right.y + right.z < 0) right = vec3_scale(right, -1); /* x, or else z, grows to the right */
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int pass = 0; pass < 2 && !(low[0] <= high[0]); pass++)
        for (uint32_t h = 0; h < compiled->n_hulls; h++) {
            Box3 box = compiled->hull_bounds[h];
            double below = HUGE_VAL, above = -HUGE_VAL, l[2] = {HUGE_VAL, HUGE_VAL}, g[2] = {-HUGE_VAL, -HUGE_VAL};
            for (int corner = 0; corner < 8; corner++) {
                Vec3 p = vec3_sub(vec3(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                       corner & 4 ? box.max.z : box.min.z),
                                  point);
                double height = vec3_dot(p, normal), at[2] = {vec3_dot(p, right), vec3_dot(p, up)};
                widen(&below, &above, height);
                for (int i = 0; i < 2; i++) widen(&l[i], &g[i], at[i]);
            }
            if (pass == 0 && (below > 0 || above < 0)) continue;
            for (int i = 0; i < 2; i++) {
                low[i] = fmin(low[i], l[i]);
                high[i] = fmax(high[i], g[i]);
            }
        }
    if (!(low[0] <= high[0])) return false;
    double by = margin * fmax(high[0] - low[0], high[1] - low[1]);
    *plane =
        (SlicePlane){.right = right, .up = up, .width = high[0] - low[0] + 2 * by, .height = high[1] - low[1] + 2 * by};
    plane->center = vec3_along(vec3_along(point, (low[0] + high[0]) / 2, right), (low[1] + high[1]) / 2, up);
    return true;
}

/* ---- runs: what owns which stretch of a line ---- */

/* Where a hull, or an opaque object, begins or ends on a line. */
typedef struct Mark {
    double t;
    uint32_t hull; /* SCENE_NONE: something opaque */
    bool begins;
    const Hit *hit; /* NULL at the ends of the line */
} Mark;

typedef struct Run {
    double begin, end;
    uint32_t hull, below; /* the owner, and the hull right below it that overlaps it in part; SCENE_NONE */
    bool opaque;
    const Hit *from, *to;
} Run;

typedef struct Worker {
    Probe probe;
    HitList opaque;
    uint32_t *in_opaque; /* of each object on the present line: how often it has been entered; 0 in between */
    double *opened;      /* where */
    NestList operands;   /* of opaque combinations, at the present place of a line; empty in between */
    double *sheets;      /* where the line crosses open meshes */
    size_t n_sheets, sheets_capacity;
    Mark *marks;
    size_t n_marks, marks_capacity;
    uint32_t *active; /* the hulls at the present place, the owner last */
    uint32_t n_active;
    Run *runs;
    size_t n_runs, runs_capacity;
    uint32_t n_gaps;
    double least_gap;
    bool overlaps, met_opaque, out_of_memory;
} Worker;

enum { KIND_SOLID, KIND_SHEET, KIND_PLANE };

typedef struct Drawing {
    const CompiledScene *compiled;
    const SlicePlane *plane;
    SliceImage *image;
    float *ink[2], *gap[2]; /* of each pixel, from rows and from columns: how much of it is line, and mark of a gap */
    Worker *workers;
    double reach; /* beyond the scene from anywhere in the picture */
    bool has_opaque;
    uint8_t *kinds;   /* of each object, KIND_... */
    uint32_t *planes; /* the objects that are unbounded */
    uint32_t n_planes;
} Drawing;

static void add_mark(Worker *worker, double t, uint32_t hull, bool begins, const Hit *hit)
{
    if (!ARRAY_ROOM(worker->marks, worker->marks_capacity, worker->n_marks)) {
        worker->out_of_memory = true;
        return;
    }
    worker->marks[worker->n_marks++] = (Mark){t, hull, begins, hit};
}

static int compare_marks(const void *left, const void *right)
{
    const Mark *a = left, *b = right;
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->begins != b->begins) return a->begins ? 1 : -1;
    return a->hull < b->hull ? -1 : a->hull > b->hull;
}

/* The half space below an unbounded plane. */
static void mark_plane(const Drawing *d, Worker *worker, const Line *line, uint32_t object)
{
    Affine to_plane;
    if (!affine_invert(&d->compiled->scene->objects[object].to_world, &to_plane)) return;
    double height = affine_point(&to_plane, line->start).y;
    double slope = affine_vector(&to_plane, vec3_from_f(line->direction)).y;
    double crossing = slope != 0 ? -height / slope : -1;
    bool crosses = crossing > 0 && crossing < line->length;
    if (height < 0) add_mark(worker, 0, SCENE_NONE, true, NULL);
    if (crosses) add_mark(worker, crossing, SCENE_NONE, height >= 0, NULL);
    if ((height < 0) != crosses) add_mark(worker, line->length, SCENE_NONE, false, NULL);
}

static void add_sheet(Worker *worker, double t)
{
    if (ARRAY_ROOM(worker->sheets, worker->sheets_capacity, worker->n_sheets))
        worker->sheets[worker->n_sheets++] = t;
    else
        worker->out_of_memory = true;
}

/* The opaque thing that a surface bounds, and whether it is entered there; SCENE_NONE where there is none. What is thin
 * bounds nothing. */
static uint32_t opaque_crossed(const Drawing *d, Worker *worker, const Hit *hit, bool *entering)
{
    const CompiledScene *compiled = d->compiled;
    const NestCsg *csg = &compiled->csg;
    uint32_t pass = compiled->hull_of_object[hit->object];
    *entering = hit->entering;
    if (pass == SCENE_NONE) return scene_is_thin(compiled->scene, hit->object) ? SCENE_NONE : hit->object;
    if (pass < compiled->n_hulls || compiled_hull(compiled, hit->object) != SCENE_NONE) return SCENE_NONE;
    uint32_t tree = nest_csg_tree(csg, pass);
    bool before = nest_csg_holds(csg, tree, &worker->operands);
    if (nest_list_reserve(&worker->operands, 1) != STATUS_OK) worker->out_of_memory = true;
    if (worker->out_of_memory || !nest_csg_pass(csg, &worker->operands, pass, hit->entering)) return SCENE_NONE;
    *entering = nest_csg_holds(csg, tree, &worker->operands);
    uint32_t whole = compiled->scene->trees[tree].object;
    return *entering == before || scene_is_thin(compiled->scene, whole) ? SCENE_NONE : whole;
}

/* Opaque objects: from where one is entered to where it is left. A mesh that is open encloses nothing: it is a boundary
 * without an inside. */
static void mark_opaque(const Drawing *d, Worker *worker, const Line *line)
{
    for (uint32_t i = 0; i < d->n_planes; i++) mark_plane(d, worker, line, d->planes[i]);
    Ray ray = ray_make(vec3_along(line->start, -d->reach, vec3_from_f(line->direction)), line->direction);
    ray.t_max = 2 * d->reach + line->length;
    HitList *hits = &worker->opaque;
    rtc_all(d->compiled->rtc, &ray, false, hits);
    if (hits->out_of_memory) worker->out_of_memory = true;
    for (size_t i = 0; i < hits->n; i++) {
        const Hit *hit = &hits->items[i];
        double t = hit->t - d->reach;
        bool entering;
        if (hit_repeats(hits, i) || d->kinds[hit->object] == KIND_PLANE) continue;
        uint32_t object = opaque_crossed(d, worker, hit, &entering);
        if (object == SCENE_NONE) continue;
        if (d->kinds[object] == KIND_SHEET) {
            if (t > 0 && t < line->length) add_sheet(worker, t);
        } else if (entering) {
            if (worker->in_opaque[object]++ == 0) worker->opened[object] = t;
        } else if (worker->in_opaque[object] && --worker->in_opaque[object] == 0 && t > 0 &&
                   worker->opened[object] < line->length) {
            add_mark(worker, fmax(worker->opened[object], 0), SCENE_NONE, true, NULL);
            add_mark(worker, fmin(t, line->length), SCENE_NONE, false, NULL);
        }
    }
    for (size_t i = 0; i < hits->n; i++) {
        uint32_t whole = d->compiled->scene->objects[hits->items[i].object].part_of;
        worker->in_opaque[whole == SCENE_NONE ? hits->items[i].object : whole] = 0;
    }
    worker->operands.n = 0;
}

static void enter_hull(const CompiledScene *compiled, Worker *worker, uint32_t hull)
{
    uint32_t place = worker->n_active++;
    for (; place > 0 && compiled->order.rank[worker->active[place - 1]] > compiled->order.rank[hull]; place--)
        worker->active[place] = worker->active[place - 1];
    worker->active[place] = hull;
}

static void leave_hull(Worker *worker, uint32_t hull)
{
    uint32_t place = 0;
    while (place < worker->n_active && worker->active[place] != hull) place++;
    if (place == worker->n_active) return;
    worker->n_active--;
    for (; place < worker->n_active; place++) worker->active[place] = worker->active[place + 1];
}

/* Whether two hulls of different media overlap, and neither is inside of the other. Pairs are sorted by object. */
static bool overlap_in_part(const CompiledScene *compiled, uint32_t hull, uint32_t other)
{
    if (compiled->hulls[hull].medium == compiled->hulls[other].medium) return false;
    uint32_t a = compiled->object_of_hull[hull < other ? hull : other];
    uint32_t b = compiled->object_of_hull[hull < other ? other : hull];
    size_t low = 0, high = compiled->n_pairs;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        const HullPair *pair = &compiled->pairs[middle];
        if (pair->a < a || (pair->a == a && pair->b < b))
            low = middle + 1;
        else
            high = middle;
    }
    const HullPair *pair = &compiled->pairs[low];
    return low < compiled->n_pairs && pair->a == a && pair->b == b && pair->overlaps && pair->relation == NEST_PARTIAL;
}

/* A stretch between two surfaces that is nothing but rounding. */
static bool is_nothing(const Mark *from, const Mark *to)
{
    double length = to->t - from->t;
    if (!(length > 0)) return true;
    if (!from->hit || !to->hit) return false;
    return length * fmin(fabs(from->hit->cos_normal), fabs(to->hit->cos_normal)) <=
           fmax(from->hit->rounding, to->hit->rounding);
}

static void add_run(const CompiledScene *compiled, Worker *worker, const Mark *from, const Mark *to, bool opaque)
{
    if (is_nothing(from, to)) return;
    uint32_t n = worker->n_active, hull = n ? worker->active[n - 1] : SCENE_NONE, below = SCENE_NONE;
    for (uint32_t i = n > 1 ? n - 1 : 0; i-- > 0 && below == SCENE_NONE && n - i < 5;) /* four deep is enough to show */
        if (overlap_in_part(compiled, hull, worker->active[i])) below = worker->active[i];
    Run *last = worker->n_runs ? &worker->runs[worker->n_runs - 1] : NULL;
    if (last && last->opaque == opaque && (opaque || (last->hull == hull && last->below == below))) {
        last->end = to->t;
        last->to = to->hit;
        return;
    }
    double begin = last ? last->end : 0; /* no stretch is left out: rounding goes to the one behind it */
    if (!ARRAY_ROOM(worker->runs, worker->runs_capacity, worker->n_runs)) { /* from here on last is no more */
        worker->out_of_memory = true;
        return;
    }
    worker->runs[worker->n_runs++] =
        (Run){begin, to->t, opaque ? SCENE_NONE : hull, opaque ? SCENE_NONE : below, opaque, from->hit, to->hit};
}

static void find_runs(const Drawing *d, Worker *worker, const Line *line)
{
    const CompiledScene *compiled = d->compiled;
    Probe *probe = &worker->probe;
    worker->n_marks = worker->n_runs = worker->n_sheets = 0;
    worker->n_active = 0;
    probe_surfaces(probe, compiled, line, SCENE_NONE);
    probe_intervals(probe, compiled, line);
    for (size_t i = 0; i < probe->n_intervals; i++) {
        const Interval *interval = &probe->intervals[i];
        add_mark(worker, interval->begin, interval->hull, true, interval->enter);
        add_mark(worker, interval->end, interval->hull, false, interval->leave);
    }
    if (d->has_opaque) mark_opaque(d, worker, line);
    if (worker->n_marks > 1) qsort(worker->marks, worker->n_marks, sizeof *worker->marks, compare_marks);
    Mark from = {.t = 0};
    uint32_t n_opaque = 0;
    for (size_t i = 0; i < worker->n_marks; i++) {
        const Mark *mark = &worker->marks[i];
        add_run(compiled, worker, &from, mark, n_opaque > 0);
        if (mark->hull == SCENE_NONE)
            n_opaque = mark->begins ? n_opaque + 1 : n_opaque - (n_opaque > 0);
        else if (mark->begins)
            enter_hull(compiled, worker, mark->hull);
        else
            leave_hull(worker, mark->hull);
        if (mark->t >= from.t) from = *mark;
    }
    Mark end = {.t = line->length};
    add_run(compiled, worker, &from, &end, n_opaque > 0);
}

/* ---- from runs to pixels ---- */

static void run_color(const CompiledScene *compiled, const Run *run, uint32_t x, uint32_t y, float rgb[3])
{
    if (run->opaque) {
        for (int i = 0; i < 3; i++) rgb[i] = slice_opaque_color[i];
        return;
    }
    slice_color(run->hull == SCENE_NONE ? 0 : compiled->hulls[run->hull].medium, rgb);
    if (run->below == SCENE_NONE || (x + y) % HATCH >= HATCH_STRIPE) return;
    float other[3];
    slice_color(compiled->hulls[run->below].medium, other);
    for (int i = 0; i < 3; i++) rgb[i] = 0.72f * other[i];
}

/* Adds `amount` of each pixel's width that lies between two places of a line, to an array with the given stride. */
static void add_ink(float *pixels, size_t stride, uint32_t n, double begin, double end, float amount)
{
    begin = fmax(begin, 0);
    end = fmin(end, n);
    for (uint32_t i = begin < end ? (uint32_t)begin : n; i < n && (double)i < end; i++) {
        double part = fmin(end, (double)i + 1) - fmax(begin, (double)i);
        pixels[i * stride] += (float)part * amount;
    }
}

static uint32_t medium_of(const CompiledScene *compiled, const Run *run)
{
    return run->opaque ? SCENE_NONE : run->hull == SCENE_NONE ? 0 : compiled->hulls[run->hull].medium;
}

static void mark_gap(Worker *worker, float *gap, size_t stride, uint32_t n, const Run *run, double scale)
{
    if (run->hull != SCENE_NONE || run->opaque || (run->end - run->begin) * scale >= thin_gap) return;
    if (!run->from || !run->to) return;
    /* along each other, not in a corner */
    if (vec3f_dot(run->from->normal, run->to->normal) * (run->from->cos_normal > 0 ? 1.0f : -1.0f) *
            (run->to->cos_normal < 0 ? 1.0f : -1.0f) >
        -0.9f)
        return;
    double middle = (run->begin + run->end) / 2 * scale;
    double across = (run->end - run->begin) * fmax(fabs(run->from->cos_normal), fabs(run->to->cos_normal));
    add_ink(gap, stride, n, middle - gap_width / 2, middle + gap_width / 2, 1.0f / LINES);
    worker->n_gaps++;
    worker->least_gap = fmin(worker->least_gap, across);
}

/* Lines and marks of gaps along a row or a column. `scale` is in pixels per unit. */
static void draw_lines(const Drawing *d, Worker *worker, float *ink, float *gap, size_t stride, uint32_t n,
                       double scale)
{
    for (size_t i = 0; i < worker->n_sheets; i++) {
        double at = worker->sheets[i] * scale;
        add_ink(ink, stride, n, at - line_width, at + line_width, 1.0f / LINES);
    }
    for (size_t i = 0; i < worker->n_runs; i++) {
        const Run *run = &worker->runs[i];
        worker->overlaps = worker->overlaps || run->below != SCENE_NONE;
        worker->met_opaque = worker->met_opaque || run->opaque;
        if (i > 0 && i + 1 < worker->n_runs) mark_gap(worker, gap, stride, n, run, scale);
        if (i == 0 || medium_of(d->compiled, run) == medium_of(d->compiled, run - 1)) continue;
        double at = run->begin * scale;
        add_ink(ink, stride, n, at - line_width / 2, at + line_width / 2, 1.0f / LINES);
    }
}

static void task_of_row(void *context, uint32_t y, unsigned number)
{
    Drawing *d = context;
    Worker *worker = &d->workers[number];
    SliceImage *image = d->image;
    const SlicePlane *plane = d->plane;
    double scale = image->width / plane->width;
    Vec3 corner = vec3_along(plane->center, -plane->width / 2, plane->right);
    size_t row = (size_t)y * image->width;
    for (int k = 0; k < LINES; k++) {
        double height = plane->height * (0.5 - (y + (k + 0.5) / LINES) / image->height);
        Line line = {vec3_along(corner, height, plane->up), vec3f_from(plane->right), plane->width, 0, 0};
        find_runs(d, worker, &line);
        for (size_t i = 0; i < worker->n_runs; i++) {
            const Run *run = &worker->runs[i];
            double begin = fmax(run->begin * scale, 0), end = fmin(run->end * scale, image->width);
            for (uint32_t x = begin < end ? (uint32_t)begin : image->width; x < image->width && (double)x < end; x++) {
                float rgb[3];
                float part = (float)(fmin(end, (double)x + 1) - fmax(begin, (double)x)) / LINES;
                run_color(d->compiled, run, x, y, rgb);
                for (size_t c = 0; c < 3; c++) image->rgb[3 * (row + x) + c] += part * rgb[c];
                if (k == LINES / 2 && begin <= x + 0.5 && x + 0.5 < end) image->owner[row + x] = run->hull;
            }
        }
        draw_lines(d, worker, d->ink[0] + row, d->gap[0] + row, 1, image->width, scale);
    }
}

static void task_of_column(void *context, uint32_t x, unsigned number)
{
    Drawing *d = context;
    Worker *worker = &d->workers[number];
    const SliceImage *image = d->image;
    const SlicePlane *plane = d->plane;
    Vec3 top = vec3_along(plane->center, plane->height / 2, plane->up);
    for (int k = 0; k < LINES; k++) {
        double at = plane->width * ((x + (k + 0.5) / LINES) / image->width - 0.5);
        Line line = {vec3_along(top, at, plane->right), vec3f_from(vec3_scale(plane->up, -1)), plane->height, 0, 0};
        find_runs(d, worker, &line);
        draw_lines(d, worker, d->ink[1] + x, d->gap[1] + x, image->width, image->height, image->height / plane->height);
    }
}

/* Boundaries over the colours, and marks of gaps over the boundaries. */
static void lay_over(Drawing *d)
{
    size_t n = (size_t)d->image->width * d->image->height;
    for (size_t i = 0; i < n; i++) {
        float ink = fminf(fmaxf(d->ink[0][i], d->ink[1][i]), 1), gap = fminf(fmaxf(d->gap[0][i], d->gap[1][i]), 1);
        for (size_t c = 0; c < 3; c++) {
            float *value = &d->image->rgb[3 * i + c];
            *value += ink * (slice_line_color[c] - *value);
            *value += gap * (slice_gap_color[c] - *value);
        }
    }
}

/* ---- all together ---- */

/* Whether an opaque mesh has an inside. */
static Status find_mesh_kinds(Drawing *d, Error *error)
{
    const Scene *scene = d->compiled->scene;
    uint8_t *of_shape = calloc(scene->n_shapes + 1U, sizeof *of_shape); /* 1 + kind */
    Status status = of_shape ? STATUS_OK : fail_memory(error, scene->n_shapes, "a slice");
    for (uint32_t i = 0; status == STATUS_OK && i < scene->n_objects; i++) {
        uint32_t shape = scene->objects[i].shape;
        if (shape == SCENE_NONE || d->compiled->hull_of_object[i] != SCENE_NONE || !scene->shapes[shape].mesh) continue;
        if (!of_shape[shape]) {
            MeshReport report;
            status = mesh_inspect(scene->shapes[shape].mesh, NULL, &report, error);
            if (status == STATUS_OK) of_shape[shape] = 1 + (report.closed ? KIND_SOLID : KIND_SHEET);
        }
        if (status == STATUS_OK) d->kinds[i] = (uint8_t)(of_shape[shape] - 1);
    }
    free(of_shape);
    return status;
}

static Status find_kinds(Drawing *d, Error *error)
{
    const Scene *scene = d->compiled->scene;
    d->kinds = calloc(scene->n_objects + 1U, sizeof *d->kinds);
    d->planes = malloc((scene->n_objects + 1U) * sizeof *d->planes);
    if (!d->planes || !d->kinds) return fail_memory(error, scene->n_objects * sizeof *d->planes, "a slice");
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        d->has_opaque = d->has_opaque || compiled_hull(d->compiled, i) == SCENE_NONE;
        if (object->shape == SCENE_NONE || object->part_of != SCENE_NONE) continue;
        const Solid *solid = scene->shapes[object->shape].solid;
        if (!solid) continue;
        if (solid->pieces[0].kind == PIECE_RECT) d->kinds[i] = KIND_SHEET;
        if (solid->pieces[0].kind != PIECE_PLANE) continue;
        d->kinds[i] = KIND_PLANE;
        d->planes[d->n_planes++] = i;
    }
    return find_mesh_kinds(d, error);
}

static Status worker_init(const Drawing *d, Worker *worker, Error *error)
{
    size_t n_objects = d->compiled->scene->n_objects + 1U, n_hulls = d->compiled->n_hulls + 1U;
    worker->least_gap = HUGE_VAL;
    nest_list_init(&worker->operands);
    worker->in_opaque = calloc(n_objects, sizeof *worker->in_opaque);
    worker->opened = malloc(n_objects * sizeof *worker->opened);
    worker->active = malloc(n_hulls * sizeof *worker->active);
    TRY(probe_init(&worker->probe, d->compiled, error));
    if (!worker->in_opaque || !worker->opened || !worker->active)
        return fail_memory(error, n_objects * sizeof *worker->opened, "a slice");
    return STATUS_OK;
}

static void worker_clear(Worker *worker)
{
    probe_clear(&worker->probe);
    hit_list_clear(&worker->opaque);
    free(worker->in_opaque);
    free(worker->opened);
    free(worker->active);
    nest_list_clear(&worker->operands);
    free(worker->sheets);
    free(worker->marks);
    free(worker->runs);
}

static Status prepare(Drawing *d, uint32_t width, uint32_t height, unsigned n_workers, Error *error)
{
    size_t n = (size_t)width * height;
    *d->image = (SliceImage){.width = width, .height = height, .least_gap = HUGE_VAL};
    d->image->rgb = calloc(3 * n, sizeof *d->image->rgb);
    d->image->owner = malloc(n * sizeof *d->image->owner);
    d->workers = calloc(n_workers, sizeof *d->workers);
    if (!d->image->rgb || !d->image->owner || !d->workers) return fail_memory(error, 4 * n * sizeof(float), "a slice");
    for (size_t i = 0; i < n; i++) d->image->owner[i] = SCENE_NONE;
    for (int i = 0; i < 2; i++) {
        d->ink[i] = calloc(n, sizeof(float));
        d->gap[i] = calloc(n, sizeof(float));
        if (!d->ink[i] || !d->gap[i]) return fail_memory(error, 4 * n * sizeof(float), "a slice");
    }
    Box3 box = rtc_scene_bounds(d->compiled->rtc);
    box = box3_add_point(box, d->plane->center);
    d->reach = vec3_length(vec3_sub(box.max, box.min)) + d->plane->width + d->plane->height;
    TRY(find_kinds(d, error));
    for (unsigned i = 0; i < n_workers; i++) TRY(worker_init(d, &d->workers[i], error));
    return STATUS_OK;
}

Status slice_draw(const CompiledScene *compiled, Pool *pool, const SlicePlane *plane, uint32_t width, uint32_t height,
                  SliceImage *image, Error *error)
{
    unsigned n_workers = pool_threads(pool);
    Drawing d = {.compiled = compiled, .plane = plane, .image = image};
    Status status = prepare(&d, width, height, n_workers, error);
    if (status == STATUS_OK) {
        pool_run(pool, height, task_of_row, &d);
        pool_run(pool, width, task_of_column, &d);
        lay_over(&d);
    }
    for (unsigned i = 0; d.workers && i < n_workers; i++) {
        Worker *worker = &d.workers[i];
        if (status == STATUS_OK && (worker->out_of_memory || worker->probe.out_of_memory))
            status = fail_memory(error, 0, "a slice");
        image->n_gaps += worker->n_gaps;
        image->least_gap = fmin(image->least_gap, worker->least_gap);
        image->overlaps = image->overlaps || worker->overlaps;
        image->opaque = image->opaque || worker->met_opaque;
        worker_clear(worker);
    }
    for (int i = 0; i < 2; i++) {
        free(d.ink[i]);
        free(d.gap[i]);
    }
    free(d.workers);
    free(d.planes);
    free(d.kinds);
    if (status != STATUS_OK) slice_image_clear(image);
    return status;
}

void slice_image_clear(SliceImage *image)
{
    free(image->rgb);
    free(image->owner);
    *image = (SliceImage){0};
}

/* emitter_cells.c - see emitter_cells.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/emitter_cells.h"

#include <stdlib.h>

#include "trace/emitter_cut.h"
#include "trace/emitter_place.h"
#include "trace/texture_view.h"

/* Of all emitters together no more cells, of operands fewer, as what shows of them takes longer to find out; and of each no more and
 * no fewer a side. Each cell is looked at at four places. Where there are too many emitters for that, so many places of all together,
 * by their areas, tell how bright each is as a whole. */
enum {
    ALL_CELLS = 1 << 18,
    ALL_CUT_CELLS = 1 << 14,
    MOST_SIDE = 64,
    LEAST_SIDE = 8,
    PLACES = 4,
    ALL_PLACES = 1 << 20,
    MOST_PLACES = 256
};
/* What is given to all cells alike: bright spots that no look has found are found by it, with not much more noise than if all were
 * chosen alike. */
#define EVEN_PART 0.35
/* A spot reaches into cells in which it was not seen: they get this part of what their brightest neighbour has. */
#define NEAR_PART 0.25
/* Cells are kept that take away more of the variance than this; of a ball, which by itself is sampled where it is seen, more. */
#define WORTH_IT 1.3
#define WORTH_IT_BALL 3.0

/* ---- choosing ---- */

/* Which of n parts a number is in, how far it is in that, and how likely the part is. */
static uint32_t find_part(const float *sums, uint32_t n, float u, float *inside, float *probability)
{
    uint32_t low = 0, high = n - 1;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (u < sums[middle])
            high = middle;
        else
            low = middle + 1;
    }
    float before = low ? sums[low - 1] : 0;
    *probability = sums[low] - before;
    *inside = float_min(float_max((u - before) / *probability, 0), 0x1.fffffep-1f);
    return low;
}

float emitter_cells_choose(const EmitterCells *cells, const float u[2], float chosen[2])
{
    const uint32_t side = cells->side;
    float row_inside, column_inside, of_row, of_column, step = 1 / (float)side;
    uint32_t row = find_part(cells->sums, side, u[0], &row_inside, &of_row);
    uint32_t column = find_part(cells->sums + side + row * side, side, u[1], &column_inside, &of_column);
    const float at[2] = {((float)row + row_inside) * step, ((float)column + column_inside) * step};
    for (int i = 0; i < 2; i++)
        chosen[i] = float_min((float)(cells->window.low[i] + cells->window.size[i] * (double)at[i]), 0x1.fffffep-1f);
    return of_row * of_column * (float)(side * side / (cells->window.size[0] * cells->window.size[1]));
}

/* Of a part of the window, 0 to 1. */
static uint32_t cell_of(double part, uint32_t side)
{
    double cell = part * side;
    return !(cell > 0) ? 0 : cell < side ? (uint32_t)cell : side - 1;
}

static float probability_of(const float *sums, uint32_t i)
{
    return i ? sums[i] - sums[i - 1] : sums[0];
}

float emitter_cells_density(const EmitterCells *cells, const double u[2])
{
    const uint32_t side = cells->side;
    const EmitterWindow *window = &cells->window;
    double part[2];
    for (int i = 0; i < 2; i++) {
        double at = fmin(fmax(u[i], 0), 1); /* rounding alone leads beyond */
        part[i] = (at - window->low[i]) / window->size[i];
        if (part[i] < 0 || part[i] > 1) return 0;
    }
    const uint32_t row = cell_of(part[0], side), column = cell_of(part[1], side);
    return probability_of(cells->sums, row) * probability_of(cells->sums + side + row * side, column) *
           (float)(side * side / (window->size[0] * window->size[1]));
}

float emitter_cells_density_hit(const EmitterSet *set, const CompiledScene *compiled, const Emitter *emitter,
                                const Ray *ray, const Hit *hit)
{
    double u[2];
    emitter_place_of_hit(compiled, emitter, ray, hit, u);
    return emitter_cells_density(set->cells[emitter->cells - 1], u);
}

/* ---- looking ---- */

/* Looking at many emitters. */
typedef struct Job {
    const World *world;
    EmitterSet *set;
    const uint32_t *numbers;
    uint32_t side;
    double places_of_power;
    float *means;      /* at first their powers, if they were even */
    CutAsking *asking; /* of each thread, where it is about what shows; NULL: about textures */
    float *seen;       /* of each thread, room for what its cells are */
    EmitterCells **tables;
    bool *failed; /* of each thread */
} Job;

/* How bright an emitter is around a place, over a width, about as an eye has it. */
static double brightness(const Job *job, unsigned worker, const Emitter *emitter, double time, const double u[2],
                         double width)
{
    const World *world = job->world;
    if (job->asking) return emitter_cut_shows(&job->asking[worker], emitter, time, u);
    const Lanes wavelengths = lanes(460, 530, 575, 620), weights = lanes(0.1f, 0.35f, 0.35f, 0.2f);
    const SceneSurface *surface = &world->scene->surfaces[world->scene->objects[emitter->of].surface];
    Hit hit = {.t = 0};
    Vec3 place = emitter_place(world->compiled, emitter, time, u, &hit);
    Ray ray = ray_make(place, vec3f_negate(hit.normal));
    ray.time = time;
    Lanes radiance = texture_emission(world, surface, &ray, &hit, width, wavelengths);
    return (double)lanes_sum(lanes_mul(radiance, weights));
}

static double part_of_one(double x)
{
    return x - floor(x);
}

/* Of n places of an emitter the mean. */
static double mean_brightness(const Job *job, unsigned worker, const Emitter *emitter, uint32_t n)
{
    double sum = 0;
    for (uint32_t i = 0; i < n; i++) {
        double u[2], time = emitter_place_in_turn(job->world->scene, i, u);
        sum += brightness(job, worker, emitter, time, u, 0);
    }
    return sum / n;
}

static const double offsets[PLACES][2] = {{.125, .375}, {.375, .875}, {.625, .125}, {.875, .625}};

static void place_in_cell(const Job *job, const EmitterWindow *window, uint32_t row, uint32_t column, int i,
                          double u[2])
{
    u[0] = window->low[0] + window->size[0] * (row + offsets[i][0]) / job->side;
    u[1] = window->low[1] + window->size[1] * (column + offsets[i][1]) / job->side;
}

/* What each of a cell's places stands for: half of its longer side, so that a single bright pixel of a large picture is seen. */
static double width_of_place(const Job *job, const Emitter *emitter, const EmitterWindow *window, uint32_t row,
                             uint32_t column)
{
    Vec3 places[3];
    for (int i = 0; i < 3; i++) {
        double u[2];
        Hit hit = {.t = 0};
        place_in_cell(job, window, row, column, i, u);
        places[i] = emitter_place(job->world->compiled, emitter, 0, u, &hit);
    }
    return fmax(vec3_length(vec3_sub(places[1], places[0])), vec3_length(vec3_sub(places[2], places[0])));
}

/* Of each cell the mean of its places. */
static void look_at_cells(const Job *job, unsigned worker, const Emitter *emitter, const EmitterWindow *window,
                          float *cells)
{
    const uint32_t side = job->side;
    const bool moves = job->world->scene->n_keys > 0;
    for (uint32_t row = 0; row < side; row++)
        for (uint32_t column = 0; column < side; column++) {
            double sum = 0, width = job->asking ? 0 : width_of_place(job, emitter, window, row, column);
            for (int i = 0; i < PLACES; i++) {
                double u[2];
                place_in_cell(job, window, row, column, i, u);
                sum += brightness(job, worker, emitter, moves ? (i + 0.5) / PLACES : 0, u, width);
            }
            cells[row * side + column] = (float)(sum / PLACES);
        }
}

/* Around all places that are within the box of an operand's combination, which rays need not find out; false: there are none. */
static bool find_window(const Job *job, const Emitter *emitter, EmitterWindow *window)
{
    const Scene *scene = job->world->scene;
    const uint32_t n = 4 * job->side;
    Box3 box = scene_object_bounds(scene, &scene->objects[scene->objects[emitter->of].part_of], NULL);
    Vec3 more = vec3_scale(vec3_sub(box.max, box.min), 1e-6);
    uint32_t low[2] = {n, n}, high[2] = {0, 0};
    box = (Box3){vec3_sub(box.min, more), vec3_add(box.max, more)};
    for (uint32_t i = 0; i <= n; i++) /* poles, too */
        for (uint32_t k = 0; k <= n; k++) {
            double u[2] = {(double)i / n, (double)k / n}, time = part_of_one(0.54970047790197031 * (i + k));
            if (!box3_holds_point(box, emitter_place(job->world->compiled, emitter, scene->n_keys ? time : 0, u, NULL)))
                continue;
            low[0] = i < low[0] ? i : low[0], high[0] = i > high[0] ? i : high[0];
            low[1] = k < low[1] ? k : low[1], high[1] = k > high[1] ? k : high[1];
        }
    for (int i = 0; i < 2 && low[0] <= high[0]; i++) {
        uint32_t begin = low[i] ? low[i] - 1 : 0, end = high[i] < n ? high[i] + 1 : n;
        window->low[i] = (double)begin / n;
        window->size[i] = (double)(end - begin) / n;
    }
    return low[0] <= high[0];
}

/* ---- tables ---- */

static float brightest_near(const float *cells, uint32_t side, uint32_t row, uint32_t column)
{
    float brightest = 0;
    for (uint32_t r = row ? row - 1 : 0; r <= row + 1 && r < side; r++)
        for (uint32_t c = column ? column - 1 : 0; c <= column + 1 && c < side; c++)
            brightest = float_max(brightest, cells[r * side + c]);
    return brightest;
}

/* Sums numbers up to 1. */
static void sum_up(const double *numbers, uint32_t n, float *sums)
{
    double all = 0, sum = 0;
    for (uint32_t i = 0; i < n; i++) all += numbers[i];
    for (uint32_t i = 0; i < n; i++) sums[i] = (float)((sum += numbers[i]) / all);
    sums[n - 1] = 1;
}

static EmitterCells *make_table(const float *seen, uint32_t side, const EmitterWindow *window)
{
    EmitterCells *cells = malloc(sizeof *cells + (side + (size_t)side * side) * sizeof *cells->sums);
    if (!cells) return NULL;
    double rows[MOST_SIDE], numbers[MOST_SIDE], all = 0;
    cells->side = side;
    cells->window = *window;
    for (int pass = 0; pass < 2; pass++) /* how much it is in all, and then with a part of that for all alike */
        for (uint32_t row = 0; row < side; row++) {
            double even = pass ? EVEN_PART / (1 - EVEN_PART) * all / (side * side) : 0;
            rows[row] = 0;
            for (uint32_t column = 0; column < side; column++) {
                numbers[column] = fmax((double)seen[row * side + column],
                                       NEAR_PART * (double)brightest_near(seen, side, row, column)) +
                                  even;
                rows[row] += numbers[column];
            }
            if (pass)
                sum_up(numbers, side, cells->sums + side + row * side);
            else
                all += rows[row];
        }
    sum_up(rows, side, cells->sums);
    return cells;
}

/* How many times the variance is as large where all cells are chosen alike. */
static double worth_of(const float *cells, uint32_t n, double mean)
{
    double squares = 0;
    for (uint32_t i = 0; i < n; i++) squares += (double)cells[i] * (double)cells[i];
    return mean > 0 ? squares / (n * mean * mean) : 0;
}

/* ---- all of them ---- */

static void look_at_one(void *context, uint32_t index, unsigned worker)
{
    Job *job = context;
    Emitter *emitter = &job->set->emitters[job->numbers[index]];
    const uint32_t side = job->side;
    job->tables[index] = NULL;
    if (!side) {
        double n = fmin(fmax(job->places_of_power * (double)job->means[index], 1), MOST_PLACES);
        job->means[index] = (float)mean_brightness(job, worker, emitter, (uint32_t)n);
        return;
    }
    float *seen = job->seen + (size_t)worker * side * side;
    EmitterWindow window = {{0, 0}, {1, 1}};
    double sum = 0;
    if (job->asking && !find_window(job, emitter, &window)) {
        job->means[index] = 0;
        return;
    }
    look_at_cells(job, worker, emitter, &window, seen);
    for (uint32_t i = 0; i < side * side; i++) sum += (double)seen[i];
    double mean = sum / (side * side), part = window.size[0] * window.size[1];
    job->means[index] = (float)(mean * part);
    double least = emitter->kind == EMITTER_BALL ? WORTH_IT_BALL : WORTH_IT;
    if (!(worth_of(seen, side * side, mean) / part > least)) return;
    job->tables[index] = make_table(seen, side, &window);
    job->failed[worker] = job->failed[worker] || !job->tables[index];
}

/* As many cells as there may be: a power of two. */
static uint32_t side_for(uint32_t n, uint32_t all)
{
    uint32_t side = MOST_SIDE;
    while (side >= LEAST_SIDE && (uint64_t)side * side * n > all) side /= 2;
    return side >= LEAST_SIDE ? side : 0;
}

/* Gives the emitters their tables, in their order. */
static void hand_out(Job *job, uint32_t n)
{
    EmitterSet *set = job->set;
    for (uint32_t i = 0; i < n; i++) {
        if (!job->tables[i]) continue;
        Emitter *emitter = &set->emitters[job->numbers[i]];
        set->cells[set->n_cells++] = job->tables[i];
        emitter->cells = set->n_cells;
        if (emitter->kind == EMITTER_BALL) emitter->kind = EMITTER_PIECE;
    }
}

static Status run(Job *job, uint32_t n, Pool *pool, Error *error)
{
    const unsigned n_workers = pool_threads(pool);
    EmitterSet *set = job->set;
    job->seen = malloc(((size_t)job->side * job->side * n_workers + 1) * sizeof *job->seen);
    job->tables = malloc(n * sizeof *job->tables);
    job->failed = calloc(n_workers, sizeof *job->failed);
    EmitterCells **cells = realloc(set->cells, ((size_t)set->n_cells + n) * sizeof(EmitterCells *));
    if (cells) set->cells = cells;
    bool good = job->seen && job->tables && job->failed && cells;
    if (good) {
        pool_run(pool, n, look_at_one, job);
        hand_out(job, n);
        for (unsigned i = 0; i < n_workers; i++) good = good && !job->failed[i];
    }
    free(job->seen);
    free(job->tables);
    free(job->failed);
    return good ? STATUS_OK : fail_memory(error, n * sizeof(EmitterCells *), "surfaces that shine");
}

Status emitter_cells_find(const World *world, EmitterSet *set, const uint32_t *numbers, uint32_t n, Pool *pool,
                          float *means, Error *error)
{
    if (!n) return STATUS_OK;
    Job job = {.world = world, .set = set, .numbers = numbers, .side = side_for(n, ALL_CELLS), .means = means};
    double power = 0;
    for (uint32_t i = 0; i < n; i++) power += (double)means[i];
    job.places_of_power = ALL_PLACES / power;
    return run(&job, n, pool, error);
}

Status emitter_cells_find_cut(const World *world, EmitterSet *set, const uint32_t *numbers, uint32_t n, Pool *pool,
                              float *means, Error *error)
{
    const unsigned n_workers = pool_threads(pool);
    Job job = {
        .world = world, .set = set, .numbers = numbers, .side = n ? side_for(n, ALL_CUT_CELLS) : 0, .means = means};
    if (!job.side) return STATUS_OK;
    job.asking = malloc(n_workers * sizeof *job.asking);
    if (!job.asking) return fail_memory(error, n_workers * sizeof *job.asking, "combinations that shine");
    for (unsigned i = 0; i < n_workers; i++) emitter_cut_begin(&job.asking[i], world->compiled);
    Status status = run(&job, n, pool, error);
    for (unsigned i = 0; i < n_workers; i++) {
        if (job.asking[i].out_of_memory && status == STATUS_OK)
            status = fail_memory(error, sizeof(Hit), "combinations that shine");
        emitter_cut_end(&job.asking[i]);
    }
    free(job.asking);
    return status;
}

void emitter_cells_clear(EmitterSet *set)
{
    for (uint32_t i = 0; i < set->n_cells; i++) free(set->cells[i]);
    free(set->cells);
}

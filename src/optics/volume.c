/* volume.c - values on a lattice: making them, looking them up, and walking through their bricks.
 * The walk is that of J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics (1987),
 * but for the planes' places, which are computed from the brick's number each time, so that nothing drifts.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/volume.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* ---- making ---- */

typedef struct Maker {
    Volume *volume;
    size_t capacity; /* blocks */
    size_t most_bytes;
    const char *what;
} Maker;

static Status too_large(const Maker *maker, double bytes, Error *error)
{
    return fail(error, STATUS_NOMEM, "%s needs more than %.0f MB of memory, and %.0f MB is what a grid may have",
                maker->what, bytes / 1e6, (double)maker->most_bytes / 1e6);
}

static Status keep_block(Maker *maker, const float *values, VolumeBrick *brick, Error *error)
{
    Volume *volume = maker->volume;
    const size_t block = VOLUME_BRICK_VALUES * sizeof *values;
    size_t bytes = volume_bytes(volume) + block;
    if (bytes > maker->most_bytes || volume->n_blocks == VOLUME_UNIFORM - 1)
        return too_large(maker, (double)bytes, error);
    if (volume->n_blocks == maker->capacity) {
        size_t more = maker->capacity ? maker->capacity + maker->capacity / 2 : 64;
        float *grown = realloc(volume->values, more * block);
        if (!grown) return fail_memory(error, more * block, maker->what);
        volume->values = grown;
        maker->capacity = more;
    }
    memcpy(volume->values + (size_t)volume->n_blocks * VOLUME_BRICK_VALUES, values, block);
    brick->values = volume->n_blocks++;
    return STATUS_OK;
}

/* The bounds of the values within the grid: what is beyond its last ones is never looked at. */
static void bound_brick(const Volume *volume, const int32_t first[3], const float *values, VolumeBrick *brick)
{
    int32_t n[3];
    double sum = 0;
    brick->low = brick->high = values[0];
    for (int axis = 0; axis < 3; axis++) {
        int32_t rest = volume->n_points[axis] - first[axis];
        n[axis] = rest < VOLUME_EDGE ? rest : VOLUME_EDGE;
    }
    for (int32_t k = 0; k < n[2]; k++)
        for (int32_t j = 0; j < n[1]; j++)
            for (int32_t i = 0; i < n[0]; i++) {
                float value = values[(k * VOLUME_EDGE + j) * VOLUME_EDGE + i];
                if (value < brick->low) brick->low = value;
                if (value > brick->high) brick->high = value;
                sum += (double)value;
            }
    brick->mean = (float)(sum / ((double)n[0] * n[1] * n[2]));
}

static Status fill_bricks(Maker *maker, VolumeFill *fill, void *context, Error *error)
{
    Volume *volume = maker->volume;
    float values[VOLUME_BRICK_VALUES];
    size_t number = 0;
    for (int32_t k = 0; k < volume->n_bricks[2]; k++)
        for (int32_t j = 0; j < volume->n_bricks[1]; j++)
            for (int32_t i = 0; i < volume->n_bricks[0]; i++, number++) {
                const int32_t first[3] = {i * VOLUME_BRICK, j * VOLUME_BRICK, k * VOLUME_BRICK};
                VolumeBrick *brick = &volume->bricks[number];
                bool uniform = false;
                TRY(fill(context, first, values, &uniform, error));
                brick->values = VOLUME_UNIFORM;
                if (uniform)
                    brick->low = brick->high = brick->mean = values[0];
                else
                    bound_brick(volume, first, values, brick);
                if (brick->high > volume->largest) volume->largest = brick->high;
                if (brick->low != brick->high) TRY(keep_block(maker, values, brick, error));
            }
    return STATUS_OK;
}

Status volume_new(const int32_t n_points[3], VolumeFill *fill, void *context, float outside, size_t most_bytes,
                  const char *what, Volume **out, Error *error)
{
    double n_bricks = 1;
    *out = NULL;
    Volume *volume = calloc(1, sizeof *volume);
    if (!volume) return fail_memory(error, sizeof *volume, what);
    Maker maker = {.volume = volume, .most_bytes = most_bytes, .what = what};
    volume->to_lattice = affine_identity();
    volume->outside = volume->largest = outside;
    for (int axis = 0; axis < 3; axis++) {
        volume->n_points[axis] = n_points[axis];
        volume->n_bricks[axis] = (n_points[axis] - 2) / VOLUME_BRICK + 1;
        n_bricks *= volume->n_bricks[axis];
    }
    Status status = STATUS_OK;
    if (n_bricks * sizeof *volume->bricks > (double)most_bytes)
        status = too_large(&maker, n_bricks * sizeof *volume->bricks, error);
    else if (!(volume->bricks = calloc((size_t)n_bricks, sizeof *volume->bricks)))
        status = fail_memory(error, (size_t)n_bricks * sizeof *volume->bricks, what);
    if (status == STATUS_OK) status = fill_bricks(&maker, fill, context, error);
    if (status == STATUS_OK && volume->n_blocks) { /* what was reserved and is not needed goes back */
        float *fitted = realloc(volume->values, (size_t)volume->n_blocks * VOLUME_BRICK_VALUES * sizeof *fitted);
        if (fitted) volume->values = fitted;
    }
    if (status == STATUS_OK)
        *out = volume;
    else
        volume_free(volume);
    return status;
}

void volume_free(Volume *volume)
{
    if (!volume) return;
    free(volume->bricks);
    free(volume->values);
    free(volume);
}

static size_t count_bricks(const Volume *volume)
{
    return (size_t)volume->n_bricks[0] * (size_t)volume->n_bricks[1] * (size_t)volume->n_bricks[2];
}

size_t volume_bytes(const Volume *volume)
{
    return count_bricks(volume) * sizeof *volume->bricks +
           (size_t)volume->n_blocks * VOLUME_BRICK_VALUES * sizeof *volume->values;
}

void volume_scale(Volume *volume, float factor)
{
    size_t n_bricks = count_bricks(volume), n_values = (size_t)volume->n_blocks * VOLUME_BRICK_VALUES;
    for (size_t i = 0; i < n_bricks; i++) {
        volume->bricks[i].low *= factor;
        volume->bricks[i].high *= factor;
        volume->bricks[i].mean *= factor;
    }
    for (size_t i = 0; i < n_values; i++) volume->values[i] *= factor;
    volume->outside *= factor;
    volume->largest *= factor;
}

/* ---- values ---- */

/* The number of the brick at a place within the grid, and where in it. */
static size_t brick_at(const Volume *volume, const double place[3], float within[3])
{
    size_t number = 0;
    for (int axis = 2; axis >= 0; axis--) {
        double x = place[axis];
        int32_t brick = (int32_t)(x * (1.0 / VOLUME_BRICK));
        if (brick >= volume->n_bricks[axis]) brick = volume->n_bricks[axis] - 1;
        within[axis] = (float)(x - brick * VOLUME_BRICK);
        number = number * (size_t)volume->n_bricks[axis] + (size_t)brick;
    }
    return number;
}

static float mix(float a, float b, float t)
{
    return a + t * (b - a);
}

static float value_in_brick(const Volume *volume, const VolumeBrick *brick, const float within[3])
{
    if (brick->values == VOLUME_UNIFORM) return brick->low;
    int32_t cell[3];
    float t[3];
    for (int axis = 0; axis < 3; axis++) {
        cell[axis] = (int32_t)within[axis];
        if (cell[axis] > VOLUME_BRICK - 1) cell[axis] = VOLUME_BRICK - 1;
        t[axis] = within[axis] - (float)cell[axis];
    }
    const float *v = volume->values + (size_t)brick->values * VOLUME_BRICK_VALUES +
                     (size_t)((cell[2] * VOLUME_EDGE + cell[1]) * VOLUME_EDGE + cell[0]);
    enum { Y = VOLUME_EDGE, Z = VOLUME_EDGE * VOLUME_EDGE };
    float near = mix(mix(v[0], v[1], t[0]), mix(v[Y], v[Y + 1], t[0]), t[1]);
    float far = mix(mix(v[Z], v[Z + 1], t[0]), mix(v[Z + Y], v[Z + Y + 1], t[0]), t[1]);
    float value = mix(near, far, t[2]);
    /* rounding must not leave the bounds */
    return value < brick->low ? brick->low : value > brick->high ? brick->high : value;
}

float volume_at(const Volume *volume, Vec3 place)
{
    const double at[3] = {place.x, place.y, place.z};
    float within[3];
    for (int axis = 0; axis < 3; axis++)
        if (!(at[axis] >= 0 && at[axis] <= volume->n_points[axis] - 1)) return volume->outside;
    return value_in_brick(volume, &volume->bricks[brick_at(volume, at, within)], within);
}

/* ---- walking ---- */

static void point_of(const VolumeWalk *walk, double t, double place[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double x = walk->origin[axis] + t * walk->direction[axis];
        double most = walk->volume->n_points[axis] - 1;
        place[axis] = x > 0 ? (x < most ? x : most) : 0; /* rounding at the grid's sides */
    }
}

static void find_next(VolumeWalk *walk, int axis)
{
    double direction = walk->direction[axis];
    double plane = (double)((walk->cell[axis] + (direction > 0)) * VOLUME_BRICK);
    walk->next[axis] = direction == 0 ? HUGE_VAL : (plane - walk->origin[axis]) / direction;
}

static void find_brick(VolumeWalk *walk)
{
    const Volume *volume = walk->volume;
    walk->brick =
        ((size_t)walk->cell[2] * (size_t)volume->n_bricks[1] + (size_t)walk->cell[1]) * (size_t)volume->n_bricks[0] +
        (size_t)walk->cell[0];
}

static void go_outside(VolumeWalk *walk, double t_end)
{
    walk->inside = false;
    walk->low = walk->high = walk->volume->outside;
    walk->t_end = t_end;
}

static void go_behind(VolumeWalk *walk)
{
    walk->left = true;
    go_outside(walk, HUGE_VAL);
}

/* Into the next brick along the line; false: there is none. */
static bool step(VolumeWalk *walk)
{
    int axis = walk->next[0] < walk->next[1] ? (walk->next[0] < walk->next[2] ? 0 : 2)
                                             : (walk->next[1] < walk->next[2] ? 1 : 2);
    if (walk->next[axis] >= walk->t_leave) return false;
    walk->cell[axis] += walk->direction[axis] > 0 ? 1 : -1;
    if (walk->cell[axis] < 0 || walk->cell[axis] >= walk->volume->n_bricks[axis]) return false;
    find_next(walk, axis);
    return true;
}

static double brick_end(const VolumeWalk *walk)
{
    double end = walk->next[0] < walk->next[1] ? walk->next[0] : walk->next[1];
    if (walk->next[2] < end) end = walk->next[2];
    return end < walk->t_leave ? end : walk->t_leave;
}

/* Makes the brick at the cell the present piece, with those behind it that are as uniform. */
static void enter_brick(VolumeWalk *walk)
{
    const VolumeBrick *bricks = walk->volume->bricks;
    find_brick(walk);
    walk->inside = true;
    walk->low = bricks[walk->brick].low;
    walk->high = bricks[walk->brick].high;
    walk->t_end = brick_end(walk);
    while (walk->low == walk->high) {
        VolumeWalk ahead = *walk;
        if (!step(&ahead)) return;
        find_brick(&ahead);
        if (bricks[ahead.brick].low != walk->low || bricks[ahead.brick].high != walk->high) return;
        *walk = ahead;
        walk->t_end = brick_end(walk);
    }
}

static void enter_grid(VolumeWalk *walk, double t)
{
    double place[3];
    point_of(walk, t, place);
    for (int axis = 0; axis < 3; axis++) {
        int32_t brick = (int32_t)(place[axis] * (1.0 / VOLUME_BRICK));
        int32_t last = walk->volume->n_bricks[axis] - 1;
        walk->cell[axis] = brick < last ? brick : last;
        find_next(walk, axis);
        /* on a side between two bricks, going back: into the one behind */
        if (walk->next[axis] <= t && walk->direction[axis] < 0 && walk->cell[axis] > 0) {
            walk->cell[axis]--;
            find_next(walk, axis);
        }
    }
    enter_brick(walk);
}

void volume_walk_start(VolumeWalk *walk, const Volume *volume, const Affine *to_lattice, Vec3 origin, Vec3 direction,
                       double t)
{
    Vec3 from = affine_point(to_lattice, origin), along = affine_vector(to_lattice, direction);
    *walk = (VolumeWalk){.volume = volume,
                         .origin = {from.x, from.y, from.z},
                         .direction = {along.x, along.y, along.z},
                         .t_leave = HUGE_VAL};
    double enter = -HUGE_VAL;
    for (int axis = 0; axis < 3; axis++) {
        double most = volume->n_points[axis] - 1, o = walk->origin[axis], d = walk->direction[axis];
        if (d == 0) {
            if (o < 0 || o > most) walk->t_leave = -HUGE_VAL;
            continue;
        }
        double a = (d > 0 ? -o : most - o) / d, b = (d > 0 ? most - o : -o) / d;
        if (a > enter) enter = a;
        if (b < walk->t_leave) walk->t_leave = b;
    }
    if (!(enter < walk->t_leave) || t >= walk->t_leave)
        go_behind(walk);
    else if (t < enter)
        go_outside(walk, enter);
    else
        enter_grid(walk, t);
}

void volume_walk_next(VolumeWalk *walk)
{
    if (walk->left) return;
    if (!walk->inside)
        enter_grid(walk, walk->t_end);
    else if (step(walk))
        enter_brick(walk);
    else
        go_behind(walk);
}

float volume_walk_value(const VolumeWalk *walk, double t)
{
    if (walk->low == walk->high) return walk->low;
    double place[3];
    float within[3];
    point_of(walk, t, place);
    for (int axis = 0; axis < 3; axis++) {
        float x = (float)(place[axis] - walk->cell[axis] * VOLUME_BRICK);
        within[axis] = x > 0 ? (x < VOLUME_BRICK ? x : VOLUME_BRICK) : 0;
    }
    return value_in_brick(walk->volume, &walk->volume->bricks[walk->brick], within);
}

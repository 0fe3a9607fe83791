/* direction_grid.c - tables over directions.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/direction_grid.h"

#include "optics/sampling.h"

static float azimuth_of(Vec3f w)
{
    float x = fabsf(w.x), y = fabsf(w.y);
    return y / (x + y + 1e-20f);
}

/* At an azimuth's knot. */
static Vec3f horizontal_at(const DirectionGrid *grid, int row)
{
    float y = grid->azimuths[row];
    return vec3f_normalize(vec3f(1 - y, y, 0));
}

/* 0..1 from z = 0 to 1, mostly within the width of an edge. */
static float about_edge(float z, float edge, float width)
{
    float from = logf(1 + edge / width), to = logf(1 + (1 - edge) / width);
    float at = z < edge ? -logf(1 + (edge - z) / width) : logf(1 + (z - edge) / width);
    return (at + from) / (from + to);
}

/* Facets that tilt along x alone, by any angle, reflect all that is further from the plane of x and z than the critical
 * angle: so do those that tilt far, about. */
static float steep_edge(const DirectionEdge *edge, Vec3f along)
{
    float y = along.y * along.y / (along.x * along.x + along.y * along.y);
    float sine_square = 1 - edge->critical * edge->critical;
    return y > sine_square ? sqrtf(1 - sine_square / y) : 0;
}

/* What is to be even over the knots: a part each for all angles, grazing ones, and those about edges. */
static float cosine_position(const DirectionEdge edges[DIRECTION_EDGES], Vec3f along, float z)
{
    const float grazing = 0.03f;
    float sum = z + logf(1 + z / grazing) / logf(1 + 1 / grazing);
    for (int i = 0; i < DIRECTION_EDGES; i++) {
        if (edges[i].critical < 0) continue;
        const DirectionEdge *edge = &edges[i];
        float stretched = float_min(0.25f * (edge->alpha_x / edge->alpha_y - 1), 1);
        sum += 2 * about_edge(z, edge->critical, direction_edge_width(edge->alpha_x, edge->alpha_y, along));
        sum += stretched * about_edge(z, steep_edge(edge, along), 0.01f + 0.7f * edge->alpha_y);
    }
    return sum;
}

/* The same over the azimuths: a part each for all, those in which stretched facets are round, those between, and those about
 * where steep edges begin. */
static float azimuth_position(const DirectionEdge edges[DIRECTION_EDGES], float ratio, float at)
{
    float x = 1 - at, sum = at + at / (ratio * x + at) + at / (sqrtf(ratio) * x + at);
    for (int i = 0; i < DIRECTION_EDGES; i++) {
        if (edges[i].critical < 0) continue;
        float c = edges[i].critical, y = sqrtf(1 - c * c);
        sum += about_edge(at, y / (y + c), 0.03f);
    }
    return sum;
}

/* Where a function that rises from 0 at 0 has a value: bisection. */
typedef struct Rising {
    const DirectionEdge *edges;
    float ratio;
    Vec3f along; /* with z = 0: of the cosine at that azimuth; else of azimuths */
} Rising;

static float rising_at(const Rising *rising, float x)
{
    return rising->along.z == 0 ? cosine_position(rising->edges, rising->along, x)
                                : azimuth_position(rising->edges, rising->ratio, x);
}

/* Knot i of n, 0..1. */
static float knot_of(const Rising *rising, int i, int n)
{
    float from = rising_at(rising, 0), wanted = from + (rising_at(rising, 1) - from) * (float)i / (float)(n - 1);
    float low = 0, high = 1;
    if (i == 0 || i == n - 1) return i == 0 ? 0 : 1;
    for (int k = 0; k < 40; k++) {
        float middle = 0.5f * (low + high);
        *(rising_at(rising, middle) < wanted ? &low : &high) = middle;
    }
    return 0.5f * (low + high);
}

void direction_grid_init(DirectionGrid *grid, const DirectionEdge edges[DIRECTION_EDGES], float ratio,
                         int most_azimuths, int most_cosines)
{
    const float least = 1e-4f;
    bool edged = edges[0].critical >= 0 || edges[1].critical >= 0;
    enum { PLAIN_COSINES = 41 }; /* where there is no edge */
    int azimuths = 3 + (int)((edged ? 7.6f : 4.2f) * fabsf(log2f(ratio))),
        cosines = edged ? most_cosines : PLAIN_COSINES;
    *grid = (DirectionGrid){.n_azimuths = azimuths < most_azimuths ? azimuths : most_azimuths,
                            .n_cosines = cosines < most_cosines ? cosines : most_cosines};
    Rising azimuth = {edges, ratio, vec3f(0, 0, 1)};
    for (int row = 0; row < grid->n_azimuths; row++) {
        grid->azimuths[row] = knot_of(&azimuth, row, grid->n_azimuths);
        Rising cosine = {edges, ratio, horizontal_at(grid, row)};
        for (int i = 0; i < grid->n_cosines; i++)
            grid->cosines[row][i] = float_max(knot_of(&cosine, i, grid->n_cosines), least);
    }
}

Vec3f direction_grid_knot(const DirectionGrid *grid, int knot)
{
    int row = knot / grid->n_cosines;
    float z = grid->cosines[row][knot % grid->n_cosines], r = sqrtf(float_max((1 - z) * (1 + z), 0));
    Vec3f along = horizontal_at(grid, row);
    return vec3f(r * along.x, r * along.y, z);
}

DirectionPlace direction_grid_place(const DirectionGrid *grid, Vec3f w)
{
    float azimuth = azimuth_of(w), z = fabsf(w.z);
    int row = 0;
    for (int n = grid->n_azimuths - 1; n > 1;) { /* without branches, which could not be foretold */
        int half = n / 2;
        row += half * (grid->azimuths[row + half] <= azimuth);
        n -= half;
    }
    float past = (azimuth - grid->azimuths[row]) / (grid->azimuths[row + 1] - grid->azimuths[row]);
    past = float_min(float_max(past, 0), 1);
    const float *near = grid->cosines[row], *far = grid->cosines[row + 1];
    int low = 0;
    for (int n = grid->n_cosines - 1; n > 1;) {
        int half = n / 2, middle = low + half;
        low += half * (near[middle] + (far[middle] - near[middle]) * past <= z);
        n -= half;
    }
    const int high = low + 1;
    float from = near[low] + (far[low] - near[low]) * past, to = near[high] + (far[high] - near[high]) * past;
    return (DirectionPlace){row, low, past, float_min(float_max((z - from) / (to - from), 0), 1)};
}

float direction_grid_at(const DirectionGrid *grid, Vec3f w)
{
    DirectionPlace place = direction_grid_place(grid, w);
    const float *near = grid->values[place.azimuth] + place.cosine, *far = near + DIRECTION_COSINES;
    float first = near[0] + (near[1] - near[0]) * place.past_cosine;
    return first + (far[0] + (far[1] - far[0]) * place.past_cosine - first) * place.past_azimuth;
}

/* phase_table.c - see phase_table.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/phase_table.h"

#include <math.h>

#include "optics/sampling.h"
#include "optics/spectrum.h"

static const float per_first = 1000 / SPECTRUM_MIN_NM, per_last = 1000 / SPECTRUM_MAX_NM; /* per micrometre */

double phase_table_nm(uint32_t k)
{
    double part = (double)k / (PHASE_TABLE_WAVES - 1), first = (double)per_first, last = (double)per_last;
    return 1000 / (first + (last - first) * part);
}

PhaseTable *phase_table_new(Arena *arena, uint32_t n_nodes, uint32_t n_waves)
{
    PhaseTable *table = ARENA_NEW(arena, PhaseTable);
    table->n_nodes = n_nodes;
    table->n_waves = n_waves;
    table->nodes = ARENA_ARRAY(arena, float, n_nodes);
    table->values = ARENA_ARRAY(arena, float, (size_t)n_nodes *n_waves);
    table->shares = ARENA_ARRAY(arena, double, (size_t)n_nodes *n_waves);
    table->first = ARENA_ARRAY(arena, uint16_t, PHASE_TABLE_BUCKETS + 1);
    return table;
}

/* Its share of what all directions have, below each node; returns the whole. */
static double add_up(PhaseTable *table, uint32_t wave)
{
    double sum = 0, *shares = table->shares + (size_t)wave * table->n_nodes;
    for (uint32_t i = 0; i + 1 < table->n_nodes; i++) {
        const float *values = table->values + (size_t)i * table->n_waves + wave;
        double mean = 0.5 * ((double)values[0] + (double)values[table->n_waves]);
        shares[i] = sum;
        sum += 4 * (double)SAMPLING_PI * mean * ((double)table->nodes[i + 1] - (double)table->nodes[i]);
    }
    shares[table->n_nodes - 1] = sum;
    return sum;
}

void phase_table_finish(PhaseTable *table)
{
    for (uint32_t k = 0; k < table->n_waves; k++) {
        double *shares = table->shares + (size_t)k * table->n_nodes, scale = 1 / add_up(table, k);
        for (uint32_t i = 0; i < table->n_nodes; i++) {
            float *value = table->values + (size_t)i * table->n_waves + k;
            *value = (float)((double)*value * scale);
        }
        scale = 1 / add_up(table, k); /* rounding is in the values now */
        for (uint32_t i = 0; i < table->n_nodes; i++) shares[i] *= scale;
    }
    uint32_t node = 0;
    for (uint32_t bucket = 0; bucket <= PHASE_TABLE_BUCKETS; bucket++) {
        float begin = (float)bucket / PHASE_TABLE_BUCKETS, s = begin * begin;
        while (node + 2 < table->n_nodes && table->nodes[node + 1] <= s) node++;
        table->first[bucket] = (uint16_t)node;
    }
}

/* The last node that is not above s, and not the last of all. */
static inline uint32_t node_at(const PhaseTable *table, float s)
{
    uint32_t bucket = (uint32_t)(sqrtf(s) * PHASE_TABLE_BUCKETS);
    if (bucket >= PHASE_TABLE_BUCKETS) bucket = PHASE_TABLE_BUCKETS - 1;
    uint32_t low = table->first[bucket], high = table->first[bucket + 1] + 1U;
    while (low + 1 < high) {
        uint32_t middle = (low + high) / 2;
        if (table->nodes[middle] <= s)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Which waves a wavelength is between, and how near to the second. */
static inline Lanes waves_at(Lanes wavelength_nm, int32_t wave[LANES])
{
    const float scale = (PHASE_TABLE_WAVES - 1) / (per_first - per_last), last = PHASE_TABLE_WAVES - 1.0001f;
    Lanes per = lanes_div(lanes_all(1000), wavelength_nm);
    Lanes place = lanes_clamp(lanes_scale(lanes_sub(lanes_all(per_first), per), scale), 0, last);
    return lanes_split(place, wave);
}

Lanes phase_table_at(const PhaseTable *table, float s, Lanes wavelength_nm)
{
    uint32_t i = node_at(table, s);
    const float *low = table->values + (size_t)i * table->n_waves, *high = low + table->n_waves;
    float begin = table->nodes[i], along = float_min((s - begin) / (table->nodes[i + 1] - begin), 1);
    if (table->n_waves == 1) return lanes_all(low[0] + along * (high[0] - low[0]));
    int32_t wave[LANES];
    Lanes part = waves_at(wavelength_nm, wave), value = lanes_all(0);
    for (int lane = 0; lane < LANES; lane++) {
        int32_t k = wave[lane];
        float first = low[k] + along * (high[k] - low[k]), second = low[k + 1] + along * (high[k + 1] - low[k + 1]);
        lanes_set(&value, lane, first + lanes_get(part, lane) * (second - first));
    }
    return value;
}

float phase_table_sample(const PhaseTable *table, float u, float wavelength_nm)
{
    double share = (double)u;
    uint32_t wave = 0, low = 0, high = table->n_nodes - 1;
    if (table->n_waves > 1) { /* of the mixture of two, one of them */
        int32_t waves[LANES];
        double second = (double)lanes_get(waves_at(lanes_all(wavelength_nm), waves), 0);
        wave = (uint32_t)waves[0] + (share < second);
        share = share < second ? share / second : (share - second) / (1 - second);
    }
    const double *shares = table->shares + (size_t)wave * table->n_nodes;
    while (low + 1 < high) {
        uint32_t middle = (low + high) / 2;
        if (shares[middle] <= share)
            low = middle;
        else
            high = middle;
    }
    /* p t + (q - p) t^2 / 2 is v times its value at 1 */
    double p = (double)table->values[(size_t)low * table->n_waves + wave];
    double q = (double)table->values[(size_t)(low + 1) * table->n_waves + wave];
    double here = shares[high] - shares[low], v = here > 0 ? fmin(fmax((share - shares[low]) / here, 0), 1) : 0;
    double root = p + sqrt(fmax(p * p + v * (q * q - p * p), 0)), t = root > 0 ? (p + q) * v / root : v;
    double begin = (double)table->nodes[low];
    return (float)(begin + fmin(t, 1) * ((double)table->nodes[high] - begin));
}

/* microfacet.c - looking up the tables of microfacet.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/microfacet.h"

static float between(float a, float b, float fraction)
{
    return a + (b - a) * fraction;
}

static float bilinear(const uint16_t table[MICROFACET_ROUGHNESSES][MICROFACET_ANGLES], MicrofacetPlace roughness,
                      MicrofacetPlace angle)
{
    const uint16_t *near = &table[roughness.knot][angle.knot], *far = &table[roughness.knot + 1][angle.knot];
    return between(between((float)near[0], (float)near[1], angle.fraction),
                   between((float)far[0], (float)far[1], angle.fraction), roughness.fraction) *
               (1.0f / MICROFACET_ONE) -
           1;
}

MicrofacetIndex microfacet_index(float alpha_x, float alpha_y, Lanes eta)
{
    return microfacet_index_among(alpha_x, alpha_y, eta, MICROFACET_ROUGHNESSES, MICROFACET_INDICES);
}

MicrofacetIndex microfacet_index_among(float alpha_x, float alpha_y, Lanes eta, int n_roughnesses, int n_indices)
{
    float alpha = sqrtf(0.5f * (alpha_x * alpha_x + alpha_y * alpha_y));
    MicrofacetIndex index = {.roughness = microfacet_place(sqrtf(alpha), n_roughnesses),
                             .alpha = alpha,
                             .one_cell = true,
                             .fraction = lanes_all(0)};
    float mean = 0; /* of the indices, each the way around that is below 1 */
    for (int i = 0; i < LANES; i++) {
        float n = lanes_get(eta, i);
        mean += float_min(n, 1 / n) / LANES;
        MicrofacetPlace place = microfacet_place(sqrtf(sqrtf(2 * fabsf(n - 1) / (n + 1))), n_indices);
        index.side[i] = n < 1;
        if (n < 1) index.any_dense = true;
        index.cell[i] = (unsigned char)place.knot;
        lanes_set(&index.fraction, i, place.fraction);
        if (index.side[i] != index.side[0] || index.cell[i] != index.cell[0]) index.one_cell = false;
    }
    index.critical = microfacet_critical(mean);
    return index;
}

Lanes microfacet_lookup(const MicrofacetTable table, const MicrofacetIndex *index, bool behind, float z, float s)
{
    MicrofacetPlace place = {0, 0};
    int placed = -1; /* the side that place is for */
    Lanes result = lanes_all(0);
    int n = index->one_cell ? 1 : LANES;
    for (int i = 0; i < n; i++) {
        int side = index->side[i] ^ (int)behind, cell = index->cell[i];
        if (side != placed) {
            float angle = side ? microfacet_angle_within(z, s, index->critical, index->alpha) : microfacet_angle(z, s);
            place = microfacet_place(angle, MICROFACET_ANGLES);
            placed = side;
        }
        float near = bilinear(table[side][cell], index->roughness, place);
        float far = bilinear(table[side][cell + 1], index->roughness, place);
        if (index->one_cell) return lanes_add(lanes_all(near), lanes_scale(index->fraction, far - near));
        lanes_set(&result, i, between(near, far, lanes_get(index->fraction, i)));
    }
    return result;
}

Lanes microfacet_lookup_mean(const MicrofacetMeans means, const MicrofacetIndex *index, bool behind)
{
    Lanes result = lanes_all(0);
    int row = index->roughness.knot;
    for (int i = 0; i < LANES; i++) {
        int side = index->side[i] ^ (int)behind;
        const float *near = means[side][index->cell[i]], *far = means[side][index->cell[i] + 1];
        float first = between(near[row], near[row + 1], index->roughness.fraction);
        float second = between(far[row], far[row + 1], index->roughness.fraction);
        if (index->one_cell) return lanes_add(lanes_all(first), lanes_scale(index->fraction, second - first));
        lanes_set(&result, i, between(first, second, lanes_get(index->fraction, i)));
    }
    return result;
}

float microfacet_mirror(MicrofacetPlace roughness, float angle)
{
    MicrofacetPlace place = microfacet_place(angle, MICROFACET_ANGLES);
    const float *near = &microfacet_mirror_scaling[roughness.knot][place.knot];
    const float *far = &microfacet_mirror_scaling[roughness.knot + 1][place.knot];
    return between(between(near[0], near[1], place.fraction), between(far[0], far[1], place.fraction),
                   roughness.fraction);
}

float microfacet_mirror_albedo(MicrofacetPlace roughness)
{
    return between(microfacet_mirror_mean[roughness.knot], microfacet_mirror_mean[roughness.knot + 1],
                   roughness.fraction);
}

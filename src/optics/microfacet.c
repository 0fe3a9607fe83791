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
    const Lanes one = lanes_all(1), last = lanes_all((float)(n_indices - 2));
    float alpha = sqrtf(0.5f * (alpha_x * alpha_x + alpha_y * alpha_y));
    MicrofacetIndex index = {.roughness = microfacet_place(sqrtf(alpha), n_roughnesses), .alpha = alpha};
    Lanes part = lanes_scale(lanes_lesser(eta, lanes_div(one, eta)), 1.0f / LANES);
    /* a mean of the indices, each the way around that is below 1 */
    index.critical =
        microfacet_critical(lanes_get(part, 0) + lanes_get(part, 1) + lanes_get(part, 2) + lanes_get(part, 3));
    Lanes contrast =
        lanes_div(lanes_scale(lanes_abs(lanes_sub(eta, one)), 1 / MICROFACET_LARGEST_CONTRAST), lanes_add(eta, one));
    Lanes position = lanes_scale(lanes_sqrt(lanes_sqrt(contrast)), (float)(n_indices - 1));
    position = lanes_greater(position, lanes_all(0)); /* NaN gives 0 */
    Lanes held = lanes_lesser(position, last);
    int32_t cell[LANES];
    index.fraction = lanes_lesser(lanes_add(lanes_split(held, cell), lanes_sub(position, held)), one);
    unsigned dense = ~lanes_not_above(one, eta);
    index.any_dense = (dense & 0xf) != 0;
    index.one_cell = true;
    for (int i = 0; i < LANES; i++) {
        index.side[i] = dense >> i & 1;
        index.cell[i] = (unsigned char)cell[i];
        index.one_cell = index.one_cell && index.side[i] == index.side[0] && cell[i] == cell[0];
    }
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

/* stretched.c - looking up the tables of stretched.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/stretched.h"

static float between(float a, float b, float fraction)
{
    return a + (b - a) * fraction;
}

/* The weight of one of eight corners, and which knots it is at. */
static float corner(const StretchedPlace *place, MicrofacetPlace azimuth, int i, int knots[3])
{
    knots[0] = place->roughness.knot + (i & 1);
    knots[1] = place->ratio.knot + (i >> 1 & 1);
    knots[2] = azimuth.knot + (i >> 2);
    return (i & 1 ? place->roughness.fraction : 1 - place->roughness.fraction) *
           (i & 2 ? place->ratio.fraction : 1 - place->ratio.fraction) *
           (i & 4 ? azimuth.fraction : 1 - azimuth.fraction);
}

float stretched_lookup(const StretchedPlace *place, Vec3f w, float angle)
{
    MicrofacetPlace column = microfacet_place(angle, STRETCHED_ANGLES);
    MicrofacetPlace azimuth = microfacet_place(stretched_azimuth(w, place->along_y), STRETCHED_AZIMUTHS);
    float sum = 0;
    for (int i = 0; i < 8; i++) {
        int at[3];
        float part = corner(place, azimuth, i, at);
        const float *row = stretched_mirror[at[0]][at[1]][at[2]];
        if (part > 0) sum += part * between(row[column.knot], row[column.knot + 1], column.fraction);
    }
    return sum;
}

StretchedIndex stretched_index(float alpha_x, float alpha_y, Lanes eta)
{
    return (StretchedIndex){.place = stretched_place(alpha_x, alpha_y),
                            .index = microfacet_index(alpha_x, alpha_y, eta),
                            .among =
                                microfacet_index_among(alpha_x, alpha_y, eta, STRETCHED_ROUGHNESSES, STRETCHED_INDICES),
                            .alpha_x = alpha_x,
                            .alpha_y = alpha_y};
}

static float at_cell(const StretchedTable table, const StretchedPlace *place, int side, int cell,
                     MicrofacetPlace azimuth, MicrofacetPlace step)
{
    float sum = 0;
    for (int i = 0; i < 8; i++) {
        int at[3];
        float part = corner(place, azimuth, i, at);
        const uint16_t *row = table[side][cell][at[0]][at[1]][at[2]];
        if (part > 0) sum += part * between((float)row[step.knot], (float)row[step.knot + 1], step.fraction);
    }
    return sum * (1.0f / MICROFACET_ONE) - 1;
}

Lanes stretched_lookup_boundary(const MicrofacetTable round, const StretchedTable rest, const StretchedIndex *index,
                                bool behind, Vec3f w)
{
    const MicrofacetIndex *among = &index->among;
    MicrofacetIndex alike = index->index;
    float z = fabsf(w.z), alpha = alike.alpha = stretched_alpha(index->alpha_x, index->alpha_y, w);
    float s = stretched_slope(alpha, z);
    alike.roughness = microfacet_place(sqrtf(alpha), MICROFACET_ROUGHNESSES);
    MicrofacetPlace azimuth = microfacet_place(stretched_azimuth(w, index->place.along_y), STRETCHED_AZIMUTHS);
    Lanes result = microfacet_lookup(round, &alike, behind, z, s), more = lanes_all(0);
    for (int i = 0; i < LANES; i++) {
        int side = among->side[i] ^ (int)behind, cell = among->cell[i];
        float angle = side ? microfacet_angle_within(z, s, alike.critical, alpha) : microfacet_angle(z, s);
        MicrofacetPlace step = microfacet_place(angle, STRETCHED_STEPS);
        float near = at_cell(rest, &index->place, side, cell, azimuth, step);
        float far = at_cell(rest, &index->place, side, cell + 1, azimuth, step);
        if (among->one_cell) {
            more = lanes_add(lanes_all(near), lanes_scale(among->fraction, far - near));
            break;
        }
        lanes_set(&more, i, between(near, far, lanes_get(among->fraction, i)));
    }
    return lanes_add(result, more);
}

Lanes stretched_lookup_mean(const MicrofacetMeans round, const StretchedMeans rest, const StretchedIndex *index,
                            bool behind)
{
    Lanes result = microfacet_lookup_mean(round, &index->index, behind);
    const MicrofacetPlace *roughness = &index->place.roughness, *ratio = &index->place.ratio;
    for (int i = 0; i < LANES; i++) {
        int side = index->among.side[i] ^ (int)behind, cell = index->among.cell[i];
        float ends[2];
        for (int k = 0; k < 2; k++) {
            const float *near = rest[side][cell + k][roughness->knot], *far = near + STRETCHED_RATIOS;
            ends[k] = between(between(near[ratio->knot], near[ratio->knot + 1], ratio->fraction),
                              between(far[ratio->knot], far[ratio->knot + 1], ratio->fraction), roughness->fraction);
        }
        float more = between(ends[0], ends[1], lanes_get(index->among.fraction, i));
        lanes_set(&result, i, lanes_get(result, i) + more);
    }
    return result;
}

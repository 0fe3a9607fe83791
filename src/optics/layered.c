/* layered.c - looking up the tables of layered.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/layered.h"

static float between(const float row[LAYERED_ANGLES], MicrofacetPlace angle)
{
    return row[angle.knot] + (row[angle.knot + 1] - row[angle.knot]) * angle.fraction;
}

/* over the roughnesses of base and layer */
static float at_index(const LayeredTable table[], MicrofacetPlace base, MicrofacetPlace layer, int side, int cell,
                      MicrofacetPlace angle)
{
    float sum = 0;
    for (int i = 0; i <= 1; i++)
        for (int k = 0; k <= 1; k++) {
            float part = (i ? base.fraction : 1 - base.fraction) * (k ? layer.fraction : 1 - layer.fraction);
            if (part > 0) sum += part * between(table[base.knot + i][layer.knot + k][side][cell], angle);
        }
    return sum;
}

Lanes layered_lookup(const LayeredTable table[], MicrofacetPlace base, const MicrofacetIndex *index, float angle)
{
    MicrofacetPlace place = microfacet_place(angle, LAYERED_ANGLES);
    Lanes result = lanes_all(0);
    for (int i = 0; i < LANES; i++) {
        int side = index->side[i], cell = index->cell[i];
        float near = at_index(table, base, index->roughness, side, cell, place);
        float far = at_index(table, base, index->roughness, side, cell + 1, place);
        if (index->one_cell) return lanes_add(lanes_all(near), lanes_scale(index->fraction, far - near));
        lanes_set(&result, i, near + (far - near) * lanes_get(index->fraction, i));
    }
    return result;
}

float layered_lookup_fuzz(const LayeredFuzzTable table[], MicrofacetPlace base, MicrofacetPlace roughness, float share,
                          float angle)
{
    MicrofacetPlace place = microfacet_place(angle, LAYERED_ANGLES), covered = microfacet_place(share, LAYERED_SHARES);
    float sum = 0;
    for (int i = 0; i < 8; i++) {
        float part = (i & 1 ? base.fraction : 1 - base.fraction) *
                     (i & 2 ? roughness.fraction : 1 - roughness.fraction) *
                     (i & 4 ? covered.fraction : 1 - covered.fraction);
        const float *row = table[base.knot + (i & 1)][roughness.knot + (i >> 1 & 1)][covered.knot + (i >> 2)];
        if (part > 0) sum += part * between(row, place);
    }
    return sum;
}

float layered_fuzz(MicrofacetPlace roughness, float cosine)
{
    MicrofacetPlace angle = microfacet_place(sqrtf(cosine), LAYERED_ANGLES);
    float near = between(layered_fuzz_albedo[roughness.knot], angle);
    return near + (between(layered_fuzz_albedo[roughness.knot + 1], angle) - near) * roughness.fraction;
}

float stretched_lookup(const StretchedPlace *place, Vec3f w, float angle)
{
    MicrofacetPlace column = microfacet_place(angle, STRETCHED_ANGLES);
    MicrofacetPlace azimuth = microfacet_place(stretched_azimuth(w, place->along_y), STRETCHED_AZIMUTHS);
    float sum = 0;
    for (int i = 0; i < 8; i++) {
        float part = (i & 1 ? place->roughness.fraction : 1 - place->roughness.fraction) *
                     (i & 2 ? place->ratio.fraction : 1 - place->ratio.fraction) *
                     (i & 4 ? azimuth.fraction : 1 - azimuth.fraction);
        const float *row = stretched_mirror[place->roughness.knot + (i & 1)][place->ratio.knot + (i >> 1 & 1)]
                                           [azimuth.knot + (i >> 2)];
        if (part > 0) sum += part * (row[column.knot] + (row[column.knot + 1] - row[column.knot]) * column.fraction);
    }
    return sum;
}

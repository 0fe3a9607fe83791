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

Lanes layered_lookup(const LayeredTable table[], MicrofacetPlace base, const MicrofacetIndex *index,
                     const float angles[2])
{
    Lanes result = lanes_all(0);
    for (int i = 0; i < LANES; i++) {
        int side = index->side[i], cell = index->cell[i];
        MicrofacetPlace place = microfacet_place(angles[side], LAYERED_ANGLES);
        float near = at_index(table, base, index->roughness, side, cell, place);
        float far = at_index(table, base, index->roughness, side, cell + 1, place);
        if (index->one_cell) return lanes_add(lanes_all(near), lanes_scale(index->fraction, far - near));
        lanes_set(&result, i, near + (far - near) * lanes_get(index->fraction, i));
    }
    return result;
}

/* over roughnesses and angles */
static float returned_at(MicrofacetPlace roughness, int cell, MicrofacetPlace angle, int time)
{
    float sum = 0;
    for (int i = 0; i < 4; i++) {
        float part =
            (i & 1 ? roughness.fraction : 1 - roughness.fraction) * (i & 2 ? angle.fraction : 1 - angle.fraction);
        sum += part * layered_return[roughness.knot + (i & 1)][cell][angle.knot + (i >> 1)][time];
    }
    return sum;
}

void layered_returned(MicrofacetPlace roughness, const MicrofacetIndex *index, const float cosines[2], Lanes more[2])
{
    MicrofacetPlace angles[2];
    more[0] = more[1] = lanes_all(0);
    for (int k = 0; k < 2; k++) angles[k] = microfacet_place(cosines[k], LAYERED_RETURN_ANGLES);
    for (int time = 0; time < 2; time++)
        for (int i = 0; i < LANES; i++) {
            float ends[2] = {0, 0};
            for (int end = 0; end < 2; end++)
                for (int k = 0; k < 2; k++)
                    ends[end] += 0.5f * returned_at(roughness, index->cell[i] + end, angles[k], time);
            Lanes all = lanes_add(lanes_all(ends[0]), lanes_scale(index->fraction, ends[1] - ends[0]));
            if (index->one_cell && index->side[i] == 0) more[time] = all;
            if (index->one_cell) break;
            if (index->side[i] == 0) lanes_set(&more[time], i, lanes_get(all, i));
        }
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

Lanes layered_lookup_skin(MicrofacetPlace fuzz, MicrofacetPlace share, MicrofacetPlace roughness,
                          const MicrofacetIndex *index, float angle)
{
    MicrofacetPlace place = microfacet_place(angle, LAYERED_SKIN_ANGLES);
    Lanes result = lanes_all(0);
    for (int i = 0; i < LANES; i++) {
        float ends[2] = {0, 0};
        for (int k = 0; k < 8; k++) {
            float part = (k & 1 ? fuzz.fraction : 1 - fuzz.fraction) * (k & 2 ? share.fraction : 1 - share.fraction) *
                         (k & 4 ? roughness.fraction : 1 - roughness.fraction);
            const float(*rows)[LAYERED_SKIN_ANGLES] = layered_fuzz_skin[fuzz.knot + (k & 1)][share.knot + (k >> 1 & 1)]
                                                                       [roughness.knot + (k >> 2)][index->side[i]];
            for (int end = 0; end <= 1 && part > 0; end++) {
                const float *row = rows[index->cell[i] + end];
                ends[end] += part * (row[place.knot] + (row[place.knot + 1] - row[place.knot]) * place.fraction);
            }
        }
        if (index->one_cell) return lanes_add(lanes_all(ends[0]), lanes_scale(index->fraction, ends[1] - ends[0]));
        lanes_set(&result, i, ends[0] + (ends[1] - ends[0]) * lanes_get(index->fraction, i));
    }
    return result;
}

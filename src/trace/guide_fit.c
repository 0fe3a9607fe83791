/* guide_fit.c - lobes that describe from where the photons of a small region come.
 * A photon that was looked around at says from where its light comes at the places around it (trace/photon.h). All photons
 * together say how much comes by which way through the glass; and where several lobes know of one way, the nearest ones
 * are asked. What few or strange photons say is described broadly.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/guide_fit.h"

#include <math.h>

#include "optics/sampling.h"

/* The narrowest spread, in radians, beside the first order's: a tenth of the sun's. */
#define NARROWEST 3e-4f
/* Of what is not known. */
#define UNKNOWN 0.05f
/* Part of the directions that is chosen broadly. */
#define BROAD 0.15f
/* The cosine of half a radian: directions that are farther apart are not of one sheet of light. */
#define ONE_SHEET 0.88f

static GuideLobe lobe_of_photon(const Photon *photon, Vec3f origin)
{
    GuideLobe lobe = {.axis = photon->from, .weight = 0};
    Vec3f offset = vec3f_along(photon->position, -1, origin);
    sampling_basis(lobe.axis, &lobe.x, &lobe.y);
    if (photon->spread[0] > 0) {
        const float floor = NARROWEST * NARROWEST;
        lobe.slope_x = photon->slope[0], lobe.slope_y = photon->slope[1];
        lobe.mean_x = photon->mean[0] - vec3f_dot(lobe.slope_x, offset);
        lobe.mean_y = photon->mean[1] - vec3f_dot(lobe.slope_y, offset);
        lobe.xx = photon->spread[0] + floor, lobe.xy = photon->spread[1], lobe.yy = photon->spread[2] + floor;
    } else {
        lobe.xx = lobe.yy = UNKNOWN * UNKNOWN;
    }
    lobe.place = offset;
    return lobe;
}

/* A lobe around all directions. */
static GuideLobe lobe_of_all(const Photon *photons, uint32_t n)
{
    Vec3f sum = vec3f(0, 0, 0);
    float flux = 0, xx = 0, xy = 0, yy = 0;
    for (uint32_t i = 0; i < n; i++) {
        sum = vec3f_along(sum, photons[i].flux, photons[i].from);
        flux += photons[i].flux;
    }
    GuideLobe lobe = {.axis = vec3f_length(sum) > 1e-3f * flux ? vec3f_normalize(sum) : photons[0].from};
    sampling_basis(lobe.axis, &lobe.x, &lobe.y);
    for (uint32_t i = 0; i < n; i++) {
        float stretch = sqrtf(2 / float_max(1 + vec3f_dot(lobe.axis, photons[i].from), 1e-3f)),
              w = photons[i].flux / flux;
        float a = stretch * vec3f_dot(lobe.x, photons[i].from), b = stretch * vec3f_dot(lobe.y, photons[i].from);
        xx += w * a * a, xy += w * a * b, yy += w * b * b;
    }
    const float more = 0.02f * 0.02f;
    lobe.xx = 2 * xx + more, lobe.xy = 2 * xy, lobe.yy = 2 * yy + more;
    return lobe;
}

/* How wrong a lobe is by what others of its way, from its first to behind its last, say which stand near by. Where light is
 * folded, as beside the bright lines under waves, several sheets of it lie over each other, and most of the others are of
 * another one: the second least of six is of the lobe's own. It is then taken for twice as wrong, as that is a little less than
 * the middle one of those of one sheet. Where there are none, as wrong at the cell's end as what is not known. */
static float bend_of(const GuideLobe *lobes, const GuideFour *fours, const uint32_t way[2], uint32_t self, float size)
{
    enum { NEAREST = 6 };
    float distances[NEAREST], bends[NEAREST], least = INFINITY, second = INFINITY;
    uint32_t n_near = 0;
    for (uint32_t i = way[0]; i < way[1]; i++) {
        if (i == self) continue;
        Vec3f there = lobes[i].place, away = vec3f_along(there, -1, lobes[self].place);
        float distance = float_max(vec3f_dot(away, away), 1e-12f * size);
        if (n_near == NEAREST && distance >= distances[NEAREST - 1]) continue;
        Vec3f mine = guide_lobe_mean(fours, self, there), other = guide_lobe_mean(fours, i, there);
        uint32_t k = n_near < NEAREST ? n_near++ : NEAREST - 1;
        for (; k > 0 && distances[k - 1] > distance; k--) distances[k] = distances[k - 1], bends[k] = bends[k - 1];
        distances[k] = distance;
        bends[k] = vec3f_length(vec3f_along(mine, -1, other)) / distance;
    }
    if (n_near == 0) return UNKNOWN / size;
    for (uint32_t i = 0; i < n_near; i++) {
        second = float_min(second, float_max(least, bends[i]));
        least = float_min(least, bends[i]);
    }
    return 2 * (n_near == 1 ? least : second);
}

static void sort_by_way(Photon *photons, uint32_t n)
{
    for (uint32_t i = 1; i < n; i++) {
        Photon moved = photons[i];
        uint32_t k = i;
        for (; k > 0 && photons[k - 1].way > moved.way; k--) photons[k] = photons[k - 1];
        photons[k] = moved;
    }
}

/* Of the n sheets of light, each by the first photon that is known of it, that which a photon is of: of its way, the nearest by
 * direction; n: none. */
static uint32_t sheet_of(const Photon *photon, const Photon *known, const uint32_t *first, uint32_t n)
{
    uint32_t nearest = n;
    float most = -2;
    for (uint32_t k = 0; k < n; k++) {
        const Photon *sheet = &known[first[k]];
        float cosine = vec3f_dot(photon->from, sheet->from);
        if (sheet->way == photon->way && cosine > most) most = cosine, nearest = k;
    }
    return nearest;
}

/* Light of one way that comes from quite other directions is another sheet: through the top and through a side of the water in a
 * pool, which are one object. What is known of the side, which is level, is known better than what is known of the waves on
 * top, and would be asked in its place. Photons that are known become sorted by sheets; returns how many these are, and where
 * each begins. */
static uint32_t sort_by_sheet(Photon *known, uint32_t n, uint32_t *first)
{
    uint32_t n_sheets = 0, done = 0;
    sort_by_way(known, n);
    while (done < n) {
        first[n_sheets++] = done;
        const Photon leader = known[done];
        for (uint32_t i = done; i < n && known[i].way == leader.way; i++) {
            if (vec3f_dot(known[i].from, leader.from) < ONE_SHEET) continue;
            Photon moved = known[i];
            known[i] = known[done];
            known[done++] = moved;
        }
    }
    first[n_sheets] = n;
    return n_sheets;
}

uint32_t guide_fit(Photon *known, uint32_t n_known, const Photon *photons, uint32_t n, Vec3f origin, GuideLobe *lobes)
{
    uint32_t first[GUIDE_CELL_KNOWN + 1], n_sheets = sort_by_sheet(known, n_known, first);
    float flux[GUIDE_CELL_KNOWN], total = 0, lost = 0, sum = 0, size = 0;
    for (uint32_t i = 0; i < n_known; i++) {
        lobes[i] = lobe_of_photon(&known[i], origin);
        size = float_max(size, vec3f_dot(lobes[i].place, lobes[i].place));
    }
    for (uint32_t k = 0; k < n_sheets; k++) flux[k] = 0;
    GuideFour fours[GUIDE_CELL_FOURS];
    guide_lay_in_fours(lobes, n_known, fours);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = sheet_of(&photons[i], known, first, n_sheets);
        total += photons[i].flux;
        if (k < n_sheets)
            flux[k] += photons[i].flux;
        else
            lost += photons[i].flux;
    }
    float broad = BROAD + (1 - BROAD) * lost / total;
    for (uint32_t k = 0; k < n_sheets; k++) {
        float weight = total > lost ? flux[k] * (1 - broad) / (total - lost) : 0;
        sum += weight;
        for (uint32_t i = first[k]; i < first[k + 1]; i++) {
            lobes[i].weight = weight;
            lobes[i].cumulative = sum;
            lobes[i].n_way = first[k + 1] - first[k];
            lobes[i].bend = bend_of(lobes, fours, &first[k], i, float_max(size, 1e-30f));
        }
    }
    lobes[n_known] = lobe_of_all(photons, n);
    lobes[n_known].weight = broad;
    lobes[n_known].cumulative = sum + broad;
    lobes[n_known].n_way = 1;
    return n_known + 1;
}

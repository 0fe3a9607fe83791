/* guide_fit.c - lobes that describe from where the photons of a small region come.
 * A photon that was looked around at says from where its light comes at the places around it (trace/photon.h). All photons
 * together say how much comes by which way through the glass; and where several lobes know of one way, the nearest ones
 * are asked. What few or strange photons say is described broadly.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/guide_fit.h"

#include "optics/sampling.h"

/* The lobes' shape in units of their spread. An even disc of this radius, as wide as one that has the spread, and a little
 * wider; */
#define DISC 2.2f
#define DISC_PART 0.7f
/* and about it what falls off slowly, as what the photons say holds near by only: (1 + r^2 / 4)^-3 up to this r, of a spread
 * that is so many times as large. */
#define REACH 5.0f
#define TAIL (1 + REACH * REACH / 4)
#define TAIL_WIDER 2.0f
/* The narrowest spread, in radians, beside the first order's: a tenth of the sun's. */
#define NARROWEST 3e-4f
#define WIDEST 0.39f /* so that all of a lobe is on the sphere: 1.99 / REACH */
/* Of what is not known. */
#define UNKNOWN 0.05f
/* Part of the directions that is chosen broadly. */
#define BROAD 0.15f
/* Of the lobes of a way those count that are up to so many times as wide, squared, as its narrowest one at a place. Measured:
 * from 2 to all of them pictures have the same error. */
#define TOO_WIDE 4.0f

/* ---- lobes ---- */

/* A lobe at a place: how its directions spread in the plane at its mean. */
typedef struct LobeSpread {
    float xx, xy, yy, determinant;
    float tail_wider; /* how much wider the tail is */
} LobeSpread;

/* Its mean direction. */
static Vec3f lobe_mean(const GuideLobe *lobe, Vec3f offset)
{
    float px = lobe->mean_x + vec3f_dot(lobe->slope_x, offset), py = lobe->mean_y + vec3f_dot(lobe->slope_y, offset);
    float square = px * px + py * py;
    if (square > 2) { /* further than a right angle: held there */
        float shrink = sqrtf(2 / square);
        px *= shrink, py *= shrink, square = 2;
    }
    float sine = sqrtf(1 - 0.25f * square);
    Vec3f mean = vec3f_along(vec3f_scale(lobe->axis, 1 - 0.5f * square), px * sine, lobe->x);
    return vec3f_along(mean, py * sine, lobe->y);
}

/* Along the x axis of the frame at a mean direction; of any length. */
static Vec3f lobe_across(const GuideLobe *lobe, Vec3f mean)
{
    return vec3f_along(lobe->x, -vec3f_dot(lobe->x, mean), mean);
}

/* The square of how wrong a lobe is at a place. */
static float lobe_error(const GuideLobe *lobe, Vec3f offset)
{
    Vec3f away = vec3f_along(offset, -1, lobe->place);
    float error = lobe->bend * vec3f_dot(away, away);
    return error * error;
}

static LobeSpread lobe_spread(const GuideLobe *lobe, float error)
{
    const float narrow =
        1.99f / (REACH * TAIL_WIDER); /* the tail has room; the square of the largest spread is at most: */
    float xx = lobe->xx + error, xy = lobe->xy, yy = lobe->yy + error, tail_wider = TAIL_WIDER;
    if (xx + yy > narrow * narrow) {
        float widest = 0.5f * (xx + yy) + sqrtf(0.25f * (xx - yy) * (xx - yy) + xy * xy);
        if (widest > WIDEST * WIDEST) {
            float shrink = WIDEST * WIDEST / widest;
            xx *= shrink, xy *= shrink, yy *= shrink, widest *= shrink;
        }
        tail_wider = float_min(TAIL_WIDER, 1.99f / (REACH * sqrtf(widest)));
    }
    float product = xx * yy;
    return (LobeSpread){xx, xy, yy, float_max(product - xy * xy, 1e-4f * product), tail_wider};
}

static Vec3f sample_lobe(const GuideLobe *lobe, Vec3f offset, const float v[2])
{
    Vec3f mean = lobe_mean(lobe, offset), x = vec3f_normalize(lobe_across(lobe, mean)), y = vec3f_cross(mean, x);
    LobeSpread spread = lobe_spread(lobe, lobe_error(lobe, offset));
    bool tail = v[0] >= DISC_PART;
    float p, q, stretch = DISC;
    sampling_disc(tail ? (v[0] - DISC_PART) / (1 - DISC_PART) : v[0] / DISC_PART, v[1], &p, &q);
    if (tail) {
        float u = p * p + q * q; /* uniform: the part of the tail within r */
        /* of the tail within r is (1 - (1 + r^2/4)^-2) / (1 - TAIL^-2) */
        float rest = 1 - u * (1 - 1 / (TAIL * TAIL)), r = sqrtf(4 * float_max(1 / sqrtf(rest) - 1, 0));
        stretch = u > 0 ? spread.tail_wider * r / sqrtf(u) : 0;
    }
    p *= stretch, q *= stretch;
    /* by the Cholesky factor of the spread */
    float scale_x = sqrtf(spread.xx), scale_y = sqrtf(spread.determinant / spread.xx);
    float a = scale_x * p, b = spread.xy / scale_x * p + scale_y * q, square = float_min(a * a + b * b, 4);
    float sine = sqrtf(1 - 0.25f * square);
    Vec3f direction = vec3f_along(vec3f_scale(mean, 1 - 0.5f * square), a * sine, x);
    return vec3f_normalize(vec3f_along(direction, b * sine, y));
}

/* Nothing is divided, and no root drawn, before it is needed: this runs for every lobe that is near. */
static float lobe_pdf(const GuideLobe *lobe, float error, Vec3f offset, Vec3f direction)
{
    Vec3f mean = lobe_mean(lobe, offset);
    float cosine = vec3f_dot(mean, direction);
    /* the square of the largest spread is less than the sum of both */
    const float farthest = 0.5f * (REACH * TAIL_WIDER) * (REACH * TAIL_WIDER);
    if (1 - cosine > farthest * 1.0001f * (lobe->xx + lobe->yy + 2 * error) + 1e-6f) return 0;
    LobeSpread spread = lobe_spread(lobe, error);
    Vec3f x = lobe_across(lobe, mean);
    float a = vec3f_dot(x, direction), b = vec3f_dot(vec3f_cross(mean, x), direction);
    /* the square of how far the direction is from the mean, in spreads: by the projection, (a, b) is to be multiplied with
     * the root of 2 / (1 + cosine), over the length of x; and its square is a^2 / xx + (b - a xy / xx)^2 xx / determinant */
    float beside = b * spread.xx - a * spread.xy;
    float square = 2 * (a * a * spread.determinant + beside * beside) /
                   ((1 + cosine) * vec3f_dot(x, x) * (spread.xx * spread.determinant));
    float wider2 = spread.tail_wider * spread.tail_wider;
    if (!(square < DISC * DISC) && !(square < REACH * REACH * wider2)) return 0;
    float fall = wider2 + 0.25f * square, area = SAMPLING_PI * sqrtf(spread.determinant);
    float pdf = square < DISC * DISC ? DISC_PART / (DISC * DISC) : 0;
    if (square < REACH * REACH * wider2) /* the tail's: over wider^2 (1 + r^2 / 4)^3, r in its own spreads */
        pdf += (1 - DISC_PART) / (2 * (1 - 1 / (TAIL * TAIL))) * wider2 * wider2 / (fall * fall * fall);
    return pdf / area;
}

/* ---- fitting ---- */

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

/* How wrong a lobe is by what others of its way say, which stand near by: the middle one of three. Where there are none, as
 * wrong at the cell's end as what is not known. */
static float bend_of(const GuideLobe *way, uint32_t n, uint32_t self, float size)
{
    enum { NEAREST = 3 };
    float distances[NEAREST], bends[NEAREST];
    uint32_t n_near = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (i == self) continue;
        Vec3f away = vec3f_along(way[i].place, -1, way[self].place);
        float distance = float_max(vec3f_dot(away, away), 1e-12f * size);
        if (n_near == NEAREST && distance >= distances[NEAREST - 1]) continue;
        Vec3f mine = lobe_mean(&way[self], way[i].place), other = lobe_mean(&way[i], way[i].place);
        uint32_t k = n_near < NEAREST ? n_near++ : NEAREST - 1;
        for (; k > 0 && distances[k - 1] > distance; k--) distances[k] = distances[k - 1], bends[k] = bends[k - 1];
        distances[k] = distance;
        bends[k] = vec3f_length(vec3f_along(mine, -1, other)) / distance;
    }
    if (n_near == 0) return UNKNOWN / size;
    if (n_near < NEAREST) return bends[0];
    float low = float_min(bends[0], bends[1]), high = float_max(bends[0], bends[1]);
    return float_max(low, float_min(high, bends[2]));
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

uint32_t guide_fit(Photon *known, uint32_t n_known, const Photon *photons, uint32_t n, Vec3f origin, GuideLobe *lobes)
{
    uint32_t ways[GUIDE_CELL_KNOWN], first[GUIDE_CELL_KNOWN + 1], n_ways = 0;
    float flux[GUIDE_CELL_KNOWN], total = 0, lost = 0, sum = 0, size = 0;
    sort_by_way(known, n_known);
    for (uint32_t i = 0; i < n_known; i++) {
        lobes[i] = lobe_of_photon(&known[i], origin);
        size = float_max(size, vec3f_dot(lobes[i].place, lobes[i].place));
        if (i > 0 && known[i].way == known[i - 1].way) continue;
        ways[n_ways] = known[i].way, flux[n_ways] = 0;
        first[n_ways++] = i;
    }
    first[n_ways] = n_known;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = 0;
        while (k < n_ways && ways[k] != photons[i].way) k++;
        total += photons[i].flux;
        if (k < n_ways)
            flux[k] += photons[i].flux;
        else
            lost += photons[i].flux;
    }
    float broad = BROAD + (1 - BROAD) * lost / total;
    for (uint32_t k = 0; k < n_ways; k++) {
        float weight = total > lost ? flux[k] * (1 - broad) / (total - lost) : 0;
        sum += weight;
        for (uint32_t i = first[k]; i < first[k + 1]; i++) {
            lobes[i].weight = weight;
            lobes[i].cumulative = sum;
            lobes[i].n_way = first[k + 1] - first[k];
            lobes[i].bend = bend_of(lobes + first[k], lobes[i].n_way, i - first[k], float_max(size, 1e-30f));
        }
    }
    lobes[n_known] = lobe_of_all(photons, n);
    lobes[n_known].weight = broad;
    lobes[n_known].cumulative = sum + broad;
    lobes[n_known].n_way = 1;
    return n_known + 1;
}

/* ---- all lobes of a cell ---- */

/* How much each lobe of a way counts at a place, and how wrong it is there. Returns the sum. */
static float way_nearness(const GuideLobe *way, Vec3f offset, float error[], float nearness[])
{
    float narrowest = INFINITY, sum = 0;
    for (uint32_t k = 0; k < way->n_way; k++) {
        error[k] = lobe_error(&way[k], offset);
        nearness[k] = 0.5f * (way[k].xx + way[k].yy) + error[k]; /* the spread, so far */
        narrowest = float_min(narrowest, nearness[k]);
    }
    for (uint32_t k = 0; k < way->n_way; k++)
        sum += nearness[k] = nearness[k] <= TOO_WIDE * narrowest ? 1 / nearness[k] : 0;
    return sum;
}

Vec3f guide_sample_lobes(const GuideLobe *lobes, uint32_t n, Vec3f offset, float u, const float v[2])
{
    uint32_t i = 0, k = 0;
    float before = 0;
    while (i + lobes[i].n_way < n && u >= lobes[i].cumulative) before = lobes[i].cumulative, i += lobes[i].n_way;
    const GuideLobe *way = lobes + i;
    if (way->n_way > 1) {
        float error[GUIDE_CELL_LOBES], nearness[GUIDE_CELL_LOBES];
        float part = (u - before) / way->weight * way_nearness(way, offset, error, nearness);
        for (uint32_t next = 0; next < way->n_way; next++) {
            if (nearness[next] == 0) continue;
            k = next; /* the last one if rounding leaves something */
            if (part < nearness[k]) break;
            part -= nearness[k];
        }
    }
    return sample_lobe(&way[k], offset, v);
}

float guide_lobes_pdf(const GuideLobe *lobes, uint32_t n, Vec3f offset, Vec3f direction)
{
    float all = 0, error[GUIDE_CELL_LOBES], nearness[GUIDE_CELL_LOBES];
    for (uint32_t i = 0; i < n; i += lobes[i].n_way) {
        const GuideLobe *way = lobes + i;
        float sum = 0, near = way_nearness(way, offset, error, nearness);
        for (uint32_t k = 0; k < way->n_way; k++)
            if (nearness[k] > 0) sum += nearness[k] * lobe_pdf(&way[k], error[k], offset, direction);
        all += way->weight * sum / near;
    }
    return all;
}

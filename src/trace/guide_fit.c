/* guide_fit.c - lobes that describe from where the photons of a small region come.
 * Every photon says from where its light comes at the places around it (trace/photon.h). Photons that say the same are one
 * lobe: most of those that have come from one light by one way through the glass. What few or strange photons say is
 * described broadly.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/guide_fit.h"

#include "optics/sampling.h"

/* The lobes' shape in units of their spread: (1 + r^2 / 4)^-3 up to this r. It falls off slowly: what the photons say holds
 * near by only. */
#define REACH 5.0f
#define TAIL (1 + REACH * REACH / 4)
/* The narrowest spread, in radians, beside the first order's: a tenth of the sun's. */
#define NARROWEST 3e-4f
/* What is known to first order is taken for this much wider. */
#define WIDER 1.1f
#define WIDEST 0.39f /* so that all of a lobe is on the sphere: 1.99 / REACH */
/* Of what is not known. */
#define UNKNOWN 0.05f
/* Photons whose direction a lobe foretells to this many spreads are part of it. */
#define ALIKE 1.0f
/* Part of the directions that is chosen broadly. */
#define BROAD 0.15f

/* ---- lobes ---- */

/* Mean direction at a place, and the frame there. */
static Vec3f lobe_frame(const GuideLobe *lobe, Vec3f offset, Vec3f *x, Vec3f *y)
{
    float px = lobe->mean_x + vec3f_dot(lobe->slope_x, offset), py = lobe->mean_y + vec3f_dot(lobe->slope_y, offset);
    float square = px * px + py * py;
    if (square > 2) { /* further than a right angle: held there */
        float shrink = sqrtf(2 / square);
        px *= shrink, py *= shrink, square = 2;
    }
    float sine = sqrtf(1 - 0.25f * square);
    Vec3f mean = vec3f_along(vec3f_scale(lobe->axis, 1 - 0.5f * square), px * sine, lobe->x);
    mean = vec3f_along(mean, py * sine, lobe->y);
    *x = vec3f_normalize(vec3f_along(lobe->x, -vec3f_dot(lobe->x, mean), mean));
    *y = vec3f_cross(mean, *x);
    return mean;
}

Vec3f guide_lobe_sample(const GuideLobe *lobe, Vec3f offset, const float v[2])
{
    Vec3f x, y, mean = lobe_frame(lobe, offset, &x, &y);
    float p, q;
    sampling_disc(v[0], v[1], &p, &q);
    float u = p * p + q * q; /* uniform: the part of the lobe within r */
    /* of the lobe within r is (1 - (1 + r^2/4)^-2) / (1 - TAIL^-2) */
    float rest = 1 - u * (1 - 1 / (TAIL * TAIL)), r = sqrtf(4 * float_max(1 / sqrtf(rest) - 1, 0));
    float stretch = u > 0 ? r / sqrtf(u) : 0;
    p *= stretch, q *= stretch;
    float a = lobe->scale_x * p, b = lobe->shear * p + lobe->scale_y * q, square = float_min(a * a + b * b, 4);
    float sine = sqrtf(1 - 0.25f * square);
    return vec3f_normalize(vec3f_along(vec3f_along(vec3f_scale(mean, 1 - 0.5f * square), a * sine, x), b * sine, y));
}

/* How far a direction is from a lobe's mean, in its spreads, squared; more than REACH squared beyond it. */
static float lobe_distance(const GuideLobe *lobe, Vec3f offset, Vec3f direction)
{
    Vec3f x, y, mean = lobe_frame(lobe, offset, &x, &y);
    float cosine = vec3f_dot(mean, direction);
    if (cosine < lobe->cos_reach) return 2 * REACH * REACH;
    float stretch = sqrtf(2 / (1 + cosine));
    float a = stretch * vec3f_dot(x, direction) / lobe->scale_x;
    float b = (stretch * vec3f_dot(y, direction) - lobe->shear * a) / lobe->scale_y;
    return a * a + b * b;
}

float guide_lobe_pdf(const GuideLobe *lobe, Vec3f offset, Vec3f direction)
{
    float square = lobe_distance(lobe, offset, direction);
    if (square > REACH * REACH) return 0;
    float fall = 1 + 0.25f * square;
    return lobe->density / (fall * fall * fall);
}

/* ---- fitting ---- */

/* spread: xx, xy, yy */
static void set_spread(GuideLobe *lobe, float xx, float xy, float yy)
{
    float widest = 0.5f * (xx + yy) + sqrtf(0.25f * (xx - yy) * (xx - yy) + xy * xy);
    float shrink = widest > WIDEST * WIDEST ? WIDEST * WIDEST / widest : 1;
    xx *= shrink, xy *= shrink, yy *= shrink, widest *= shrink;
    lobe->scale_x = sqrtf(xx);
    lobe->shear = xy / lobe->scale_x;
    lobe->scale_y = sqrtf(float_max(yy - lobe->shear * lobe->shear, 1e-4f * yy));
    lobe->cos_reach = 1 - 0.5f * REACH * REACH * widest - 1e-6f;
    lobe->density = 1 / (2 * SAMPLING_PI * (1 - 1 / (TAIL * TAIL)) * lobe->scale_x * lobe->scale_y);
}

static GuideLobe lobe_of_photon(const Photon *photon, Vec3f origin)
{
    GuideLobe lobe = {.axis = photon->from, .weight = 0};
    Vec3f offset = vec3f_along(photon->position, -1, origin);
    sampling_basis(lobe.axis, &lobe.x, &lobe.y);
    if (photon->spread[0] > 0) {
        const float floor = NARROWEST * NARROWEST, wider = WIDER * WIDER;
        lobe.slope_x = photon->slope[0], lobe.slope_y = photon->slope[1];
        lobe.mean_x = photon->mean[0] - vec3f_dot(lobe.slope_x, offset);
        lobe.mean_y = photon->mean[1] - vec3f_dot(lobe.slope_y, offset);
        set_spread(&lobe, wider * photon->spread[0] + floor, wider * photon->spread[1],
                   wider * photon->spread[2] + floor);
    } else {
        set_spread(&lobe, UNKNOWN * UNKNOWN, 0, UNKNOWN * UNKNOWN);
    }
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
    set_spread(&lobe, 2 * xx + more, 2 * xy, 2 * yy + more);
    return lobe;
}

uint32_t guide_fit(const Photon *photons, uint32_t n, Vec3f origin, GuideLobe *lobes)
{
    uint32_t n_lobes = 0;
    float total = 0, lost = 0, sum = 0;
    for (uint32_t i = 0; i < n; i++) {
        const Photon *photon = &photons[i];
        Vec3f offset = vec3f_along(photon->position, -1, origin);
        uint32_t nearest = 0;
        float least = ALIKE * ALIKE;
        total += photon->flux;
        for (uint32_t k = 0; k < n_lobes; k++) {
            float distance = lobe_distance(&lobes[k], offset, photon->from);
            if (distance < least) least = distance, nearest = k + 1;
        }
        if (!nearest && n_lobes < GUIDE_CELL_LOBES - 1) {
            lobes[n_lobes++] = lobe_of_photon(photon, origin);
            nearest = n_lobes;
        }
        if (nearest)
            lobes[nearest - 1].weight += photon->flux;
        else
            lost += photon->flux;
    }
    float broad = BROAD + (1 - BROAD) * lost / total;
    for (uint32_t k = 0; k < n_lobes; k++) lobes[k].weight *= (1 - broad) / (total - lost);
    lobes[n_lobes] = lobe_of_all(photons, n);
    lobes[n_lobes++].weight = broad;
    for (uint32_t k = 0; k < n_lobes; k++) lobes[k].cumulative = sum += lobes[k].weight;
    return n_lobes;
}

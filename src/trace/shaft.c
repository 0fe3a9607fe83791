/* shaft.c - see shaft.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/shaft.h"

#include "optics/sampling.h"
#include "trace/airlight.h"
#include "trace/event.h"
#include "trace/probe.h"

/* Stretches of paths that media have scattered more often are not looked at: there are many of them, of little light each. */
#define MOST_SCATTERED 1
/* Nor are those through which less than this part of all flights comes: flights are scattered often enough there. */
#define LEAST_ALONE 0.05f
/* Looks on one stretch. */
#define MOST_TRIES 4

/* The stretch within a guide's cell that was chosen so far, and what the cells have to scatter on all of it. */
typedef struct Shaft {
    const GuideCell *cell;
    double begin, end;
    double all;          /* of all cells so far */
    double u;            /* uniform in [0, 1): what the choice has left of its number */
    const float *colors; /* of both paths of the sample, so that both look at the same places */
} Shaft;

/* How much more light of a colour there is in a cell than of others. */
static float of_color(const GuideCell *cell, float color)
{
    const float all = 0.35f, least = 0.05f; /* the spread of all colours */
    float off = (color - cell->color) / cell->color_spread, fall = 1 / (1 + off * off);
    return least + all / cell->color_spread * fall * fall;
}

/* What a cell scatters of light that is bent by these wavelengths. */
static float scattered_of(const GuideCell *cell, const float colors[2])
{
    if (!cell->parts_colors) return cell->scattered;
    return cell->scattered * 0.5f * (of_color(cell, colors[0]) + of_color(cell, colors[1]));
}

static void consider(void *context, const GuideCell *cell, double begin, double end)
{
    Shaft *shaft = context;
    double amount = (double)scattered_of(cell, shaft->colors) * (end - begin);
    if (!(amount > 0)) return;
    shaft->all += amount;
    double part = amount / shaft->all;
    if (shaft->u < part) {
        shaft->cell = cell;
        shaft->begin = begin;
        shaft->end = end;
        shaft->u /= part;
    } else {
        shaft->u = (shaft->u - part) / (1 - part);
    }
}

/* The density of looks for a place of a cell. */
static float look_density(const Path *path, const Airway *way, const GuideCell *cell)
{
    float part = (float)((double)scattered_of(cell, path->colors) / way->shaft_all);
    return way->shaft * cell->looks * part / (float)way->n_media;
}

/* One of the looks on a stretch. */
typedef struct ShaftLook {
    uint32_t number; /* of all of the path's, for its random numbers */
    GuideAt at;      /* the cell that was chosen, and */
    double t;        /* the place there */
} ShaftLook;

/* The path becomes as if it had been scattered at the place, a probe is sent, and it becomes what it was. */
static void send_from(Path *path, const FreeFlight *flight, const AirPlace *place, ShaftLook *look, Vec3f direction)
{
    GuideAt *guide = &look->at;
    enum { LOOKS = 1 << 21 }; /* its random numbers are not those of the path's own events and probes */
    const Lanes beta = path->beta, ratio = path->ratio;
    const uint32_t bounce = path->bounce;
    float density = airlight_flight_density(&path->way, place->coefficient, place->depth);
    if (!(density > 0)) return;
    Lanes arrived = lanes_mul(place->left, flight_attenuation(flight->absorbed));
    path->beta = lanes_mul(path->beta, lanes_mul(flight_lane_factor(flight), arrived));
    path->beta = lanes_mul(path->beta, lanes_scale(place->coefficient, 1 / density));
    path->ratio = path->way.ratio;
    path->bounce = LOOKS + look->number;
    guide->sent *= path_probe_part(path, &path->way, true); /* by flights that are scattered there */
    guide->share = guide->sent + look_density(path, &path->way, guide->cell) / density;
    Lanes pdf = phase_evaluate(place->phase, path->ray.direction, direction, path->wavelengths.nm);
    const ProbeWay way = {direction, false, pdf,
                          airlight_turn_density(&path->way, place->phase, place->coefficient, place->depth, pdf)};
    const SurfacePlace there = {.position = ray_point(&path->ray, look->t), .apart = true};
    path_send_probe(path, guide, &(LookPlace){NULL, &there, path_lights(path, false), vec3f(0, 0, 0)}, &way);
    path->beta = beta;
    path->ratio = ratio;
    path->bounce = bounce;
}

/* Goes through the cells of a stretch, and chooses one of them by u; sets what all scatter there. */
static Shaft walk_along(const Path *path, Airway *way, double u)
{
    const Guide *guide = path->tracer->world->guide;
    Shaft shaft = {.u = u, .colors = path->colors};
    guide_walk(guide, way->origin, vec3_from_f(way->direction), way->begin, way->end, consider, &shaft);
    way->shaft_all = double_max(shaft.all, guide_bright(guide));
    return shaft;
}

/* Chooses a cell of the stretch by u, and a place there by v; false: there is none. Sets what all cells scatter there. */
static bool choose_place(const Path *path, Airway *way, double u, float v, ShaftLook *look, double *all)
{
    Shaft shaft = walk_along(path, way, u);
    *all = shaft.all;
    if (!(shaft.all > 0)) return false;
    look->t = airlight_off_ends(path, shaft.begin + (double)v * (shaft.end - shaft.begin));
    look->at = guide_find(path->tracer->world->guide, ray_point(&path->ray, look->t), false, path->color);
    return look->at.cell == shaft.cell; /* but for rounding */
}

/* Takes one look, as often as that says; u: uniform in [0, 1). */
static void look_once(Path *path, const FlightStretch *stretch, ShaftLook *look, float often, float u)
{
    Tracer *tracer = path->tracer;
    if (u >= often) return;
    double rest = (double)u / (double)often;
    float v[2];
    AirPlace place;
    sampler_2d(&path->sampler, DIM_SHAFTS + 2 * look->number + 1, v);
    if (!airlight_place(path, stretch, look->t, &rest, &place)) return;
    path_is_guided(path, &look->at);
    Vec3f direction = guide_sample(&look->at, float_min((float)rest, 0x1.fffffep-1f), v);
    if (!path_turn_aside(tracer, &look->t)) {
        tracer->out_of_memory = true;
        return;
    }
    send_from(path, stretch->flight, &place, look, direction);
    path_turn_back(tracer);
}

void shaft_look(Path *path, const FlightStretch *stretch)
{
    Tracer *tracer = path->tracer;
    Airway *way = &path->way;
    const Guide *guide = tracer->world->guide;
    if (!guide || path->probing.is_probe || path->n_scattered > MOST_SCATTERED || way->alone < LEAST_ALONE) return;
    float u[2], part = way->carried * way->alone / (float)(1 + path->n_scattered), most = guide_most_looks(guide);
    if (!(most > 0)) return;
    way->shaft = part;
    way->shaft_all = -1;
    for (uint32_t i = 0, tries = 1; i < tries; i++) {
        ShaftLook look = {.number = MOST_TRIES * airlight_stretch(path, stretch->number) + i};
        double which = (double)sampler_3d(&path->sampler, DIM_SHAFTS + 2 * look.number, u) * 0x1p-32, all;
        if (i == 0 && LIKELY(!tracer->ledger) && u[1] >= most * part) return; /* by then there is one try */
        bool found = choose_place(path, way, which, u[0], &look, &all);
        if (!(all > 0)) return;
        if (i == 0) {
            part *= (float)(all / way->shaft_all);
            tries = part * most <= 1 ? 1 : part * most >= MOST_TRIES ? MOST_TRIES : (uint32_t)ceilf(part * most);
        }
        if (!found) continue;
        if (UNLIKELY(tracer->ledger) && !path->again)
            guide_note(tracer->ledger, &look.at, GUIDE_LOOK, part / (float)tries, (float)all);
        look_once(path, stretch, &look, look.at.cell->looks * part / (float)tries, u[1]);
    }
}

float shaft_rival(Path *path, const GuideAt *guide)
{
    Airway *way = &path->from;
    if (!(way->rarity > 0) || !(way->shaft > 0) || !guide->cell || !(guide->cell->scattered > 0)) return 0;
    if (way->shaft_all < 0) (void)walk_along(path, way, 0);
    return way->shaft_all > 0 ? way->rarity * look_density(path, way, guide->cell) : 0;
}

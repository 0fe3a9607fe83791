/* flight.c - flights through media that vary from place to place, shine, or mix.
 *
 * The way is cut into pieces in which the density of every medium there has known bounds, low and high: the bricks of
 * their grids. Within a piece the least density is flown through in closed form, and only what may be more is left to
 * chance (decomposition, [KHLN17] section 5): collisions are drawn at the rate
 *     low x the hero's scattering + (high - low) x the largest extinction of any lane,
 * at each the density is looked up, and the path is scattered or goes on. Collisions that are none multiply beta and
 * ratio of each lane by what it and the hero make of them. The rate of the second term is the same for all lanes, so that
 * the density with which a path would have been sampled by another lane is known in relation to the hero's, and the
 * balance heuristic over the wavelengths holds as everywhere ([MGJ19] section 5; path.c). Absorption is a weight.
 * A straight ray takes every such collision as a weight (ratio tracking).
 *
 * What media give off is gathered along the way: in closed form where nothing varies, else at one place of each piece,
 * up to where the path is scattered.
 *
 * [KHLN17] and [MGJ19] are named in full in src/README.md.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/flight.h"

#include "base/array.h"
#include "optics/sampling.h"
#include "trace/airlight.h"
#include "trace/probe.h"
#include "trace/shade.h"

/* A budget is never nothing: a flight that ended where it began, at a surface, would leave the next ray on that surface without
 * a word of which side of it it is on. One random number in 2^24 is 0; this is the mean of what it stands for. */
#define LEAST_BUDGET 0x1p-25f

static inline float draw_budget(float u)
{
    return float_max(-logf(1 - u), LEAST_BUDGET);
}

/* ---- even media ---- */

/* The field of an extraordinary wave is across its ray, in the plane of that and of the axis. What is unpolarized has begun in the
 * crystal, or was scattered there, and is taken as the mean over all directions. */
Lanes flight_pleochroic(const Path *path, const SceneMedium *medium, Lanes ordinary)
{
    const double cosine = vec3_dot(vec3_from_f(path->ray.direction), medium->optic_axis);
    const float along[] = {[CRYSTAL_UNPOLARIZED] = 1.0f / 3,
                           [CRYSTAL_ORDINARY] = 0,
                           [CRYSTAL_EXTRAORDINARY] = (float)fmax(1 - cosine * cosine, 0)};
    const float part = along[path->wave];
    return lanes_add(lanes_scale(ordinary, 1 - part),
                     lanes_scale(spectrum_at(&medium->extraordinary_absorption, path->wavelengths.nm), part));
}

void flight_draw(Path *path, FreeFlight *flight)
{
    flight->budget = draw_budget(sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_DISTANCE)));
    if (path->tracer->world->media.vary) flight->key = sampler_key(&path->sampler, DIM_FLIGHTS + 2 * path->bounce);
}

double flight_scatter_even(FreeFlight *flight, const SceneMedium *medium, double length, Lanes wavelength_nm)
{
    Lanes coefficient = spectrum_at(&medium->scattering, wavelength_nm);
    double hero = (double)lanes_get(coefficient, 0), reach = (double)flight->budget;
    bool scattered = hero * length > reach;
    if (scattered) length = reach / hero;
    flight->scattered = lanes_add(flight->scattered, lanes_scale(coefficient, flight_length(length)));
    flight->coefficient = coefficient;
    flight->budget = float_max(flight->budget - (float)(hero * length), LEAST_BUDGET);
    return length;
}

void flight_weigh(Path *path, const FreeFlight *flight, bool even)
{
    Lanes factor = flight_lane_factor(flight);
    if (even) factor = lanes_mul(factor, lanes_scale(flight->coefficient, 1 / lanes_get(flight->coefficient, 0)));
    path->beta = lanes_mul(path->beta, factor);
    path->ratio = lanes_mul(path->ratio, factor);
}

Lanes flight_depth(Path *path, uint32_t medium, double length)
{
    const SceneMedium *m = &path->tracer->world->scene->media[medium];
    if (!(length > 0) || (!m->absorbs && !m->scatters)) return lanes_all(0);
    Lanes extinction = flight_absorption(path, medium);
    if (m->scatters) extinction = lanes_add(extinction, spectrum_at(&m->scattering, path->wavelengths.nm));
    return lanes_scale(extinction, flight_length(length));
}

/* ---- what fills a place ---- */

static void add_part(Path *path, FlightParts *parts, const Ray *ray, double t, uint32_t hull, uint32_t number)
{
    const World *world = path->tracer->world;
    const SceneMedium *medium = &world->scene->media[number];
    Lanes nm = path->wavelengths.nm;
    if (!medium->absorbs && !medium->scatters && !medium->emits) return;
    FlightPart *part = &parts->items[parts->n++]; /* most of it is for what varies, and is set then */
    part->medium = medium;
    part->number = number;
    part->place = media_place(&world->media, world->compiled, hull);
    part->glow = NULL;
    part->absorption = flight_absorption(path, number);
    part->scattering = medium->scatters ? spectrum_at(&medium->scattering, nm) : lanes_all(0);
    part->emission = medium->emits ? spectrum_at(&medium->emission, nm) : lanes_all(0);
    part->bound = lanes_max(lanes_add(part->absorption, part->scattering));
    part->low = part->high = 1;
    part->t_end = HUGE_VAL;
    part->walks = false;
    if (!part->place) return;
    part->maps = media_maps(world->scene, part->place, ray->time, &part->moved);
    uint32_t glow = medium->emits ? world->media.glow_of_place[part->place - world->media.places] : SCENE_NONE;
    if (glow != SCENE_NONE && path->scatter_pdf >= 0) part->glow = &world->media.glows[glow];
    part->glow_choice = -1;
    if (!medium->density) return;
    volume_walk_start(&part->walk, medium->density, &part->maps->to_density, ray->origin, vec3_from_f(ray->direction),
                      t);
    part->walks = true;
    part->low = part->walk.low;
    part->high = part->walk.high;
    part->t_end = part->walk.t_end;
}

bool flight_next_mixing(const World *world, const NestList *list, uint32_t medium, uint32_t *i, uint32_t *hull)
{
    const CompiledScene *compiled = world->compiled;
    const NestState *state = world->media.mixing_state;
    const uint32_t *items = nest_list_items(list);
    while (*i < list->n && items[*i] >= compiled->order.n_hulls) ++*i;
    while (*i < list->n && nest_mixes(&compiled->order, items[*i])) {
        *hull = items[(*i)++];
        if (state[compiled->hulls[*hull].medium] == state[medium]) return true;
    }
    return false;
}

/* Sets tracer->parts to all that fills a place: the owner's medium, and those that mix with it. False when memory ends. */
ATTR_APART static bool find_parts(Path *path, const NestList *list, const Ray *ray, double t)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const NestOrder *order = &world->compiled->order;
    uint32_t owner = nest_owner(order, list), medium = nest_medium(list), i = 0;
    tracer->parts.n = 0;
    if (!array_reserve(&tracer->parts.items, &tracer->parts.capacity, list->n + 1U, sizeof *tracer->parts.items))
        return false;
    add_part(path, &tracer->parts, ray, t, owner, medium);
    for (uint32_t hull; flight_next_mixing(world, list, medium, &i, &hull);)
        add_part(path, &tracer->parts, ray, t, hull, world->compiled->hulls[hull].medium);
    return true;
}

/* A stretch of the way on which all bounds stay as they are. */
typedef struct FlightPiece {
    double begin, end;
    Lanes scattering, absorption; /* of the least densities together */
    float excess;                 /* the rate of collisions with what may be more than that, of any lane */
    bool shines;
} FlightPiece;

/* The piece that begins at t. */
static FlightPiece piece_at(FlightParts *parts, double t, double to)
{
    FlightPiece piece = {t, to, lanes_all(0), lanes_all(0), 0, false};
    for (uint32_t i = 0; i < parts->n; i++) {
        FlightPart *part = &parts->items[i];
        while (part->t_end <= t) {
            volume_walk_next(&part->walk);
            part->low = part->walk.low;
            part->high = part->walk.high;
            part->t_end = part->walk.t_end;
        }
        if (part->t_end < piece.end) piece.end = part->t_end;
        if (!(part->high > 0)) continue;
        piece.shines = piece.shines || part->medium->emits;
        piece.excess += (part->high - part->low) * part->bound;
        piece.scattering = lanes_add(piece.scattering, lanes_scale(part->scattering, part->low));
        piece.absorption = lanes_add(piece.absorption, lanes_scale(part->absorption, part->low));
    }
    return piece;
}

/* ---- light on the way ---- */

static Lanes emission_at(const FlightPart *part, const Ray *ray, double t, Lanes wavelength_nm)
{
    Lanes emission = part->emission;
    const Volume *temperature = part->medium->temperature;
    if (temperature) {
        float kelvin = volume_at(temperature, affine_point(&part->maps->to_temperature, ray_point(ray, t)));
        emission = lanes_mul(emission, media_planck_ratio(part->medium, kelvin, wavelength_nm));
    }
    return lanes_scale(emission, flight_part_density(part, t));
}

/* Against finding the place by light sampling. */
static float weight_of(const Path *path, FlightPart *part, double t)
{
    const World *world = path->tracer->world;
    if (!part->glow) return 1;
    uint32_t emitter = world->emitters.first_glow + (uint32_t)(part->glow - world->media.glows);
    if (part->glow_choice < 0)
        part->glow_choice =
            light_choice(world, path->scatter_lights, emitter, path->scatter_point, path->scatter_normal);
    Vec3 place = ray_point(&path->ray, t), to = vec3_sub(place, path->scatter_point);
    double density = glow_density(part->glow, part->maps, place);
    float pdf = light_pdf_glow(part->glow, 1, density, vec3_dot(to, to)), choices = part->glow_choice;
    if (path->from.rarity > 0 && pdf > 0) choices += airlight_rival_near(path, emitter, place);
    return sampling_balance(path->scatter_pdf, choices * pdf);
}

void flight_add_light(Path *path, const FreeFlight *flight, Lanes basic, uint32_t group)
{
    Lanes factor = flight_lane_factor(flight),
          beta = lanes_mul(lanes_mul(path->beta, factor), flight_attenuation(flight->absorbed));
    float mean_ratio = lanes_mean(lanes_mul(path->ratio, factor));
    if (!(mean_ratio > 0)) return;
    Lanes more = lanes_scale(lanes_mul(beta, basic), 1 / mean_ratio);
    path_add_found(path, more);
    if (UNLIKELY(path->tracer->grouped)) path_add_to_group(path, more, group);
}

static void add_light(Path *path, const FreeFlight *flight, const FlightPart *part, Lanes light)
{
    const World *world = path->tracer->world;
    uint32_t medium = nest_medium(&path->tracer->list);
    light = lanes_scale(light, path_found_part(path, INFINITY));
    light = path_basic_radiance(world, light, medium, path->wavelengths.nm);
    flight_add_light(path, flight, light, part->medium->light_group);
}

/* (1 - e^(-x length)) / x of each lane. */
static Lanes mean_way(Lanes extinction, float length)
{
    for (int i = 0; i < LANES; i++) {
        float x = lanes_get(extinction, i), depth = x * length;
        lanes_set(&extinction, i, depth > 1e-4f ? -expm1f(-depth) / x : length * (1 - 0.5f * depth));
    }
    return extinction;
}

static bool shines(const FlightPart *part)
{
    return part->medium->emits && part->high > 0;
}

/* Where nothing varies, and light sampling does not look there: all of the piece in closed form, in the place of what is
 * gathered before and after the path is scattered. */
static bool gather_even(Path *path, const FreeFlight *flight, const FlightPiece *piece)
{
    const FlightParts *parts = &path->tracer->parts;
    if (piece->excess > 0) return false;
    for (uint32_t i = 0; i < parts->n; i++) {
        const FlightPart *part = &parts->items[i];
        if (!shines(part)) continue;
        if (part->high > part->low || part->medium->temperature || part->glow) return false;
    }
    Lanes way = mean_way(lanes_add(piece->absorption, piece->scattering), flight_length(piece->end - piece->begin));
    for (uint32_t i = 0; i < parts->n; i++) {
        const FlightPart *part = &parts->items[i];
        if (shines(part)) add_light(path, flight, part, lanes_mul(lanes_scale(part->emission, part->low), way));
    }
    return true;
}

/* At one place of what is flown through of the piece. */
static void gather_at_place(Path *path, const FreeFlight *flight, const FlightPiece *piece, double length, float u)
{
    FlightParts *parts = &path->tracer->parts;
    FreeFlight up_to = *flight;
    double way = (double)u * length, t = piece->begin + way;
    up_to.scattered = lanes_add(up_to.scattered, lanes_scale(piece->scattering, (float)way));
    up_to.absorbed = lanes_add(up_to.absorbed, lanes_scale(piece->absorption, (float)way));
    for (uint32_t i = 0; i < parts->n; i++) {
        FlightPart *part = &parts->items[i];
        if (!shines(part)) continue;
        Lanes light = emission_at(part, &path->ray, t, path->wavelengths.nm);
        if (lanes_zero(light)) continue;
        add_light(path, &up_to, part, lanes_scale(light, weight_of(path, part, t) * (float)length));
    }
}

/* ---- flights ---- */

static float draw(uint32_t key, uint32_t *n_drawn)
{
    return hash_to_unit_f(hash_combine(key, (*n_drawn)++));
}

/* What all that may collide beyond the least density comes to at a place: scattering and extinction, of every lane. */
static void excess_at(const FlightParts *parts, double t, Lanes *scattering, Lanes *extinction)
{
    *scattering = *extinction = lanes_all(0);
    for (uint32_t i = 0; i < parts->n; i++) {
        const FlightPart *part = &parts->items[i];
        if (!(part->high > part->low)) continue;
        float more = flight_part_density(part, t) - part->low;
        *scattering = lanes_add(*scattering, lanes_scale(part->scattering, more));
        *extinction = lanes_add(*extinction, lanes_scale(lanes_add(part->scattering, part->absorption), more));
    }
}

/* Which of the media it is that scatters the hero at a place: by what each has a part of. */
static const FlightPart *scatterer(const FlightParts *parts, double t, float u)
{
    float sum = 0, before = 0;
    if (parts->n == 1) return &parts->items[0];
    for (uint32_t i = 0; i < parts->n; i++)
        sum += flight_part_density(&parts->items[i], t) * lanes_get(parts->items[i].scattering, 0);
    const FlightPart *last = NULL;
    for (uint32_t i = 0; i < parts->n; i++) {
        const FlightPart *part = &parts->items[i];
        float share = flight_part_density(part, t) * lanes_get(part->scattering, 0);
        if (!(share > 0)) continue;
        last = part;
        before += share;
        if (u * sum < before) break;
    }
    return last;
}

static void multiply(Path *path, Lanes beta, Lanes ratio)
{
    path->beta = lanes_mul(path->beta, beta);
    path->ratio = lanes_mul(path->ratio, ratio);
    path_keep_in_range(path);
}

/* At a collision: what scatters the path, or NULL where it goes on. */
static const FlightPart *collide(Path *path, FreeFlight *flight, const FlightPiece *piece, double t)
{
    const FlightParts *parts = &path->tracer->parts;
    float rate = lanes_get(piece->scattering, 0) + piece->excess, u = draw(flight->key, &flight->n_drawn) * rate;
    Lanes scattering = lanes_all(0), extinction = lanes_all(0);
    if (piece->excess > 0 && u >= lanes_get(piece->scattering, 0)) {
        excess_at(parts, t, &scattering, &extinction);
        float goes_on = piece->excess - lanes_get(scattering, 0);
        if (u >= lanes_get(piece->scattering, 0) + lanes_get(scattering, 0) && goes_on > 0) {
            Lanes all = lanes_all(piece->excess);
            multiply(path, lanes_scale(lanes_sub(all, extinction), 1 / goes_on),
                     lanes_scale(lanes_sub(all, scattering), 1 / goes_on));
            return NULL;
        }
    }
    /* one that mixes with others is chosen, and by other lanes would be, in proportion to its scattering */
    const FlightPart *by = scatterer(parts, t, parts->n > 1 ? draw(flight->key, &flight->n_drawn) : 0);
    if (!by) return NULL;
    Lanes factor = lanes_scale(by->scattering, 1 / lanes_get(by->scattering, 0));
    multiply(path, factor, factor);
    return by;
}

double flight_uneven(Path *path, FreeFlight *flight, double from, double length, uint32_t *medium)
{
    Tracer *tracer = path->tracer;
    double t = from, to = from + length;
    if (path->straight) {
        if (path->for_light)
            path->beta =
                lanes_mul(path->beta, flight_transmit(path, &path->ray, &tracer->list, t, to, &flight->n_drawn, NULL));
        return length;
    }
    if (flight->budget < 0) flight_draw(path, flight);
    if (!find_parts(path, &tracer->list, &path->ray, t)) {
        tracer->out_of_memory = true;
        return length;
    }
    bool gathered = false; /* the present piece, in closed form */
    for (FlightPiece piece = {.end = t}; t < to && !lanes_zero(path->beta);) {
        if (t >= piece.end) {
            piece = piece_at(&tracer->parts, t, to);
            gathered = piece.shines && gather_even(path, flight, &piece);
        }
        piece.begin = t;
        double rate = (double)(lanes_get(piece.scattering, 0) + piece.excess), step = piece.end - t;
        bool collides = rate > 0 && rate * step > (double)flight->budget;
        if (collides) step = (double)flight->budget / rate;
        if (piece.shines && !gathered && step > 0)
            gather_at_place(path, flight, &piece, step, draw(flight->key, &flight->n_drawn));
        float way = flight_length(step);
        flight->scattered = lanes_add(flight->scattered, lanes_scale(piece.scattering, way));
        flight->absorbed = lanes_add(flight->absorbed, lanes_scale(piece.absorption, way));
        t = collides ? t + step : piece.end;
        if (!collides) {
            if (rate > 0) flight->budget = float_max(flight->budget - (float)(rate * step), LEAST_BUDGET);
            continue;
        }
        const FlightPart *by = collide(path, flight, &piece, t);
        if (by) {
            *medium = by->number;
            flight->budget = LEAST_BUDGET;
            flight->coefficient = lanes_scale(by->scattering, flight_part_density(by, t));
            return t - from < length ? t - from : nextafter(length, 0);
        }
        flight->budget = draw_budget(draw(flight->key, &flight->n_drawn));
    }
    return length;
}

Lanes flight_transmit(Path *path, const Ray *ray, const NestList *list, double t, double to, uint32_t *n_drawn,
                      Lanes *scattered)
{
    const float faint = 0.01f, survival = 0.25f; /* what has become faint mostly ends */
    FlightParts *parts = &path->tracer->parts;
    Lanes depth = lanes_all(0), of_scattering = depth, left = lanes_all(1);
    uint32_t key = sampler_key(&path->sampler, DIM_FLIGHTS + 2 * path->bounce + 1);
    if (!find_parts(path, list, ray, t)) {
        path->tracer->out_of_memory = true;
        return left;
    }
    while (t < to) {
        FlightPiece piece = piece_at(parts, t, to);
        double rate = (double)piece.excess, at = t;
        while (rate > 0) {
            at += (double)-logf(1 - draw(key, n_drawn)) / rate;
            if (!(at < piece.end)) break;
            Lanes scattering, extinction;
            excess_at(parts, at, &scattering, &extinction);
            left = lanes_mul(left, lanes_rest(lanes_scale(extinction, 1 / piece.excess)));
            if (lanes_max(left) > faint) continue;
            if (lanes_zero(left) || draw(key, n_drawn) >= survival) return lanes_all(0);
            left = lanes_scale(left, 1 / survival);
        }
        Lanes even = lanes_add(piece.scattering, piece.absorption);
        depth = lanes_add(depth, lanes_scale(even, flight_length(piece.end - t)));
        of_scattering = lanes_add(of_scattering, lanes_scale(piece.scattering, flight_length(piece.end - t)));
        t = piece.end;
    }
    if (scattered) *scattered = of_scattering;
    return lanes_mul(left, flight_attenuation(depth));
}

/* airlight.c - see airlight.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/airlight.h"

#include "optics/sampling.h"
#include "trace/beam_ways.h"
#include "trace/event.h"
#include "trace/shade.h"
#include "trace/shaft.h"

/* A stretch that scatters less than this part of the light is looked at with a probability in proportion: what it adds to
 * the picture is little, and so is its noise. */
#define THIN 0.1f
/* Optical depths beyond which a stretch is not looked at: what e^-8 leaves is for flights. */
#define DEEP 8.0
/* In thick media a light is near up to this many mean free paths: closer to it than that, flights are too rare. */
#define NEAR 0.25
/* Lights that are closer to a stretch than its length are brighter there: looks are more, in proportion, up to this factor,
 * where the camera sees it, or sees it in a mirror or through glass. */
#define MOST_MORE 8.0f
/* Less than this part of the looks is none: weighing what flights find against them would take longer. */
#define FEW 0.05f
/* Of a grid's largest density, what it is taken to have in the mean: for how often to look only. */
#define TYPICAL 0.25f

/* ---- how often, and where ---- */

static LightLine line_of(const Airway *way)
{
    return (LightLine){vec3f_from(way->origin), way->direction, (float)way->begin, (float)way->end};
}

/* What there is to scatter sets how often the stretch is looked at; how much light there is, as well. */
static float share_of(const Airway *way, float brighter)
{
    return way->carried * float_min(way->scattered_part / THIN * brighter, 1);
}

/* Lights that are near in terms of the mean free path are worth a look in thick media, too: there the flights are many, but
 * few of them are close to the light. */
static float share_near(const Path *path, const Airway *way, uint32_t emitter)
{
    Vec3 to = vec3_sub(vec3_from_f(light_tree_middle(path->tracer->world->emitters.tree, emitter)), way->origin);
    Vec3 along = vec3_from_f(way->direction);
    double nearest = fmin(fmax(vec3_dot(to, along), way->begin), way->end);
    to = vec3_along(to, -nearest, along);
    double distance2 = vec3_dot(to, to), near2 = NEAR * NEAR * way->free_path * way->free_path;
    float near = distance2 > near2 ? (float)(near2 / distance2) : 1;
    double brighter = (way->end - way->begin) / fmax(sqrt(distance2), 1e-9 * (way->end - way->begin));
    return share_of(way, (float)fmin(fmax(brighter, 1), (double)way->most_more)) *
           (way->alone + (1 - way->alone) * (near < FEW ? 0 : near));
}

/* Whether there can be such lights. */
static bool any_near(const World *world, const Airway *way)
{
    LightLine line = line_of(way);
    return (double)light_tree_nearest(world->emitters.tree, &line) < NEAR * way->free_path / sqrt((double)FEW);
}

static float share_far(const Airway *way)
{
    return share_of(way, 1) * way->alone;
}

/* Places by the angle under which an emitter sees them. */
typedef struct Fall {
    double foot;       /* along the ray, what is nearest to the emitter */
    double begin, end; /* from there */
    double distance, angle;
} Fall;

/* False: the emitter does not shine on the stretch. */
static bool fall_about(const Path *path, const Airway *way, uint32_t emitter, const LightPivot *pivot, Fall *fall)
{
    double begin = way->begin, end = way->end;
    if (!light_reach(path->tracer->world, emitter, path->ray.time, way->origin, way->direction, &begin, &end))
        return false;
    Vec3 to = vec3_sub(pivot->place, way->origin), along = vec3_from_f(way->direction);
    double foot = vec3_dot(to, along), least = 1e-6 * (end - begin);
    Vec3 beside = vec3_along(to, -foot, along);
    *fall = (Fall){.foot = foot, .begin = begin - foot, .end = end - foot};
    fall->distance = sqrt(fmax(vec3_dot(beside, beside) + pivot->softening2, least * least));
    fall->angle = sampling_angle(fall->distance, fall->begin, fall->end);
    return fall->angle > 0;
}

static double fall_sample(const Fall *fall, double u)
{
    return fall->foot + sampling_equiangular(u, fall->distance, fall->begin, fall->end, fall->angle);
}

static float fall_density(const Fall *fall, double t)
{
    return (float)sampling_equiangular_pdf(t - fall->foot, fall->distance, fall->begin, fall->end, fall->angle);
}

/* Places by what is left of light that came so far. */
static float pass_density(const Airway *way, double t)
{
    return (float)sampling_exponential_pdf(t - way->begin, (double)way->extinction, way->end - way->begin);
}

static Lanes by_lane(const Airway *way, Lanes coefficient, Lanes depth)
{
    return lanes_mul(lanes_mul(way->ratio, flight_attenuation(depth)), coefficient);
}

float airlight_flight_density(const Airway *way, Lanes coefficient, Lanes depth)
{
    return lanes_mean(by_lane(way, coefficient, depth)) / lanes_mean(way->ratio);
}

float airlight_turn_density(const Airway *way, const Phase *phase, Lanes coefficient, Lanes depth, Lanes pdf_w)
{
    if (LIKELY(phase_is_grey(phase))) return lanes_get(pdf_w, 0);
    Lanes each = by_lane(way, coefficient, depth);
    float all = lanes_mean(each);
    return all > 0 ? lanes_mean(lanes_mul(each, pdf_w)) / all : 0;
}

bool airlight_place(Path *path, const FlightStretch *stretch, double t, double *which, AirPlace *place)
{
    const uint32_t medium = stretch->medium;
    Tracer *tracer = path->tracer;
    Airway *way = &path->way;
    if (!stretch->uneven) {
        const SceneMedium *m = &tracer->world->scene->media[medium];
        place->phase = &m->phase;
        way->n_media = 1;
        place->coefficient = spectrum_at(&m->scattering, path->wavelengths.nm);
        place->depth = lanes_scale(place->coefficient, flight_length(t - way->begin));
        place->left = flight_attenuation(flight_depth(path, medium, t - way->begin));
        return true;
    }
    uint32_t n_drawn = 1U << 31; /* numbers of its own */
    place->left = flight_transmit(path, &path->ray, &tracer->list, way->begin, t, &n_drawn, &place->depth);
    way->n_media = (uint32_t)tracer->parts.n;
    if (lanes_zero(place->left) || !way->n_media) return false;
    double choice = *which * way->n_media;
    uint32_t i = choice < way->n_media ? (uint32_t)choice : way->n_media - 1;
    const FlightPart *part = &tracer->parts.items[i];
    *which = choice - i;
    place->phase = &part->medium->phase;
    place->coefficient = lanes_scale(part->scattering, flight_part_density(part, t));
    return !lanes_zero(place->coefficient);
}

/* ---- the stretch ---- */

/* What a medium that fills the stretch adds; its absorption only where it is as dense everywhere. */
static void add_typical(Path *path, uint32_t medium, Lanes *scattering, Lanes *even)
{
    const SceneMedium *m = &path->tracer->world->scene->media[medium];
    if (!m->scatters && (m->density || !m->absorbs)) return;
    Lanes of_medium = m->scatters ? spectrum_at(&m->scattering, path->wavelengths.nm) : lanes_all(0);
    *scattering =
        lanes_add(*scattering, m->density ? lanes_scale(of_medium, TYPICAL * m->density->largest) : of_medium);
    if (!m->density) *even = lanes_add(*even, lanes_add(of_medium, flight_absorption(path, medium)));
}

/* What is there of every lane in the mean; false: nothing scatters. */
static bool typical(Path *path, uint32_t medium, bool uneven, Lanes *scattering, Lanes *even)
{
    *scattering = *even = lanes_all(0);
    if (!uneven && !path->tracer->world->scene->media[medium].scatters) return false;
    add_typical(path, medium, scattering, even);
    if (!uneven) return true;
    const World *world = path->tracer->world;
    for (uint32_t i = 0, hull; flight_next_mixing(world, &path->tracer->list, medium, &i, &hull);)
        add_typical(path, world->compiled->hulls[hull].medium, scattering, even);
    return !lanes_zero(*scattering);
}

/* Sets path->way but for its shares; false: nothing is scattered there, or nobody looks for it. */
static bool enter(Path *path, const FlightStretch *stretch, double begin, double length)
{
    const FreeFlight *flight = stretch->flight;
    const World *world = path->tracer->world;
    Airway *way = &path->way;
    Lanes scattering, even;
    way->share = way->rarity = way->shaft = way->beam = 0;
    way->lights = world_lights_in(world, stretch->medium);
    if ((!way->lights->n && !world->guide && !world->n_beam_ways) || !(length > 0) ||
        !typical(path, stretch->medium, stretch->uneven, &scattering, &even))
        return false;
    float mean = lanes_mean(scattering), of_even = lanes_mean(even), all = float_max(of_even, mean);
    double reach = fmin(length, 1e18);
    if (of_even > 0) reach = fmin(reach, DEEP / (double)of_even);
    way->origin = path->ray.origin;
    way->direction = path->ray.direction;
    way->begin = begin;
    way->end = begin + reach;
    way->extinction = all;
    way->free_path = 1 / (double)all;
    way->alone = expf(-mean * flight_length(length));
    Lanes factor = flight_lane_factor(flight);
    way->ratio = lanes_mul(path->ratio, factor);
    way->scattered = flight->scattered;
    way->carried = float_min(lanes_mean(lanes_mul(path->beta, factor)) / lanes_mean(way->ratio), 1);
    way->scattered_part = (1 - expf(-all * flight_length(reach))) * (mean / all);
    return way->carried > 0 && way->end > way->begin;
}

/* Sets how often lights are looked for; false: never. */
static bool is_looked_at(Path *path)
{
    Airway *way = &path->way;
    if (!way->lights->n) return false;
    if (way->alone < FEW) {
        way->alone = 0;
        if (!any_near(path->tracer->world, way)) return false;
    }
    way->most_more = path->scatter_pdf < 0 ? MOST_MORE : 1;
    way->share = share_of(way, way->most_more);
    return way->share > 0;
}

/* ---- a look ---- */

/* A place of the stretch, a light as seen from it, and the densities of ways to find both. */
typedef struct Look {
    double t;
    LightSample light; /* pdf_w: p */
    float here, there; /* q a(t); c */
} Look;

double airlight_off_ends(const Path *path, double t)
{
    const Airway *way = &path->way;
    Vec3 place = ray_point(&path->ray, t);
    double far = fmax(fmax(fabs(place.x), fabs(place.y)), fabs(place.z));
    double margin = fmin(1e-7 * far, 0.01 * (way->end - way->begin));
    return fmin(fmax(t, way->begin + margin), way->end - margin);
}

/* query: of which all is set but where from. */
static bool look_near(const Path *path, LightQuery *query, const float u[2], Look *look)
{
    const World *world = path->tracer->world;
    const Airway *way = &path->way;
    LightLine line = line_of(way);
    float of_tree;
    uint32_t emitter = light_tree_choose_along(world->emitters.tree, &line, &query->rest, &of_tree);
    if (emitter == LIGHT_TREE_NONE) return false;
    float share = share_near(path, way, emitter);
    if (u[0] >= share) return false;
    LightPivot pivot = light_pivot(world, emitter, query->time, query->rest, query->u);
    Fall fall;
    if (!fall_about(path, way, emitter, &pivot, &fall)) return false;
    look->t = airlight_off_ends(path, fall_sample(&fall, (double)u[1]));
    query->from = ray_point(&path->ray, look->t);
    light_sample_emitter(world, emitter, query, &look->light);
    look->here = way->lights->near * of_tree * share * fall_density(&fall, look->t);
    look->there = light_choice(world, way->lights, emitter, query->from, query->normal);
    return look->here > 0 && look->there > 0;
}

static bool look_far(const Path *path, const LightChoice *chosen, LightQuery *query, const float u[2], Look *look)
{
    const Airway *way = &path->way;
    float share = share_far(way);
    if (u[0] >= share) return false;
    double along = sampling_exponential((double)u[1], (double)way->extinction, way->end - way->begin);
    look->t = airlight_off_ends(path, way->begin + along);
    query->from = ray_point(&path->ray, look->t);
    light_sample_choice(path->tracer->world, chosen, query, &look->light);
    look->here = share * pass_density(way, look->t);
    look->there = 1;
    return true;
}

/* What one medium at the place makes of the light, over the densities of all ways to find it there. */
static Lanes scattered_by(const Path *path, const Look *look, const Phase *phase, Lanes coefficient, Lanes depth)
{
    const LightSample *light = &look->light;
    Lanes pdf = phase_evaluate(phase, path->ray.direction, light->direction, path->wavelengths.nm);
    float by_direction = light->delta ? 0 : airlight_turn_density(&path->way, phase, coefficient, depth, pdf);
    float by_flight = airlight_flight_density(&path->way, coefficient, depth);
    float density = look->here * light->pdf_w + by_flight * (look->there * light->pdf_w + by_direction);
    return density > 0 ? lanes_mul(coefficient, lanes_div(pdf, lanes_all(density))) : lanes_all(0);
}

/* The same of all that is there, and what is left of the light on its way to the beginning of the stretch. */
static Lanes scattered_at(Path *path, const Look *look, uint32_t medium, bool uneven)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const Airway *way = &path->way;
    if (!uneven) {
        const SceneMedium *m = &world->scene->media[medium];
        Lanes coefficient = spectrum_at(&m->scattering, path->wavelengths.nm);
        Lanes depth = lanes_scale(coefficient, flight_length(look->t - way->begin));
        Lanes all = flight_depth(path, medium, look->t - way->begin);
        return lanes_mul(scattered_by(path, look, &m->phase, coefficient, depth), flight_attenuation(all));
    }
    uint32_t n_drawn = 1U << 30; /* numbers of its own, as the straight ray to the light draws, too */
    Lanes depth, left = flight_transmit(path, &path->ray, &tracer->list, way->begin, look->t, &n_drawn, &depth);
    Lanes sum = lanes_all(0);
    if (lanes_zero(left)) return left;
    for (uint32_t i = 0; i < tracer->parts.n; i++) {
        const FlightPart *part = &tracer->parts.items[i];
        Lanes coefficient = lanes_scale(part->scattering, flight_part_density(part, look->t));
        if (!lanes_zero(coefficient))
            sum = lanes_add(sum, scattered_by(path, look, &part->medium->phase, coefficient, depth));
    }
    return lanes_mul(sum, left);
}

static void look(Path *path, const FlightStretch *stretch)
{
    const uint32_t number = airlight_stretch(path, stretch->number);
    float choice[2], u[2];
    sampler_2d(&path->sampler, airlight_dimension(number, AIRLIGHT_PLACE), u);
    if (u[0] >= path->way.share) return;
    sampler_2d(&path->sampler, airlight_dimension(number, AIRLIGHT_CHOICE), choice);
    LightQuery query = {.time = path->ray.time,
                        .rest = (double)choice[0] + (double)choice[1] * 0x1p-24,
                        .wavelength_nm = path->wavelengths.nm};
    sampler_2d(&path->sampler, airlight_dimension(number, AIRLIGHT_LIGHT), query.u);
    const LightChoice *chosen = light_choose(path->way.lights, &query.rest);
    Look look;
    if (!(chosen->light == LIGHT_NEAR ? look_near(path, &query, u, &look) : look_far(path, chosen, &query, u, &look)))
        return;
    if (!(look.light.pdf_w > 0)) return;
    Lanes factor = scattered_at(path, &look, stretch->medium, stretch->uneven), light;
    if (lanes_zero(factor)) return;
    if (!path_turn_aside(path->tracer, &look.t)) {
        path->tracer->out_of_memory = true;
        return;
    }
    Ray ray;
    ray_begin(&ray, ray_point(&path->ray, look.t), look.light.direction);
    ray.time = path->ray.time;
    bool arrives = path_light_arrives(path, &look.light, &ray, &light);
    path_turn_back(path->tracer);
    if (!arrives) return;
    flight_add_light(path, stretch->flight, lanes_mul(factor, light),
                     light_sample_group(path->tracer->world, &look.light));
}

void airlight_look(Path *path, const FlightStretch *stretch, double begin, double length)
{
    if (!enter(path, stretch, begin, length)) return;
    shaft_look(path, stretch);
    if (UNLIKELY(path->tracer->world->n_beam_ways)) beam_ways_look(path, stretch);
    if (is_looked_at(path)) look(path, stretch);
}

/* ---- weights ---- */

void airlight_note(Path *path, const FreeFlight *flight, bool uneven, double t)
{
    Airway *way = &path->way;
    if ((!(way->share > 0) && !(way->shaft > 0) && !(way->beam > 0)) || t > way->end) return;
    way->n_media = uneven ? (uint32_t)path->tracer->parts.n : 1;
    way->by_lane = by_lane(way, flight->coefficient, lanes_sub(flight->scattered, way->scattered));
    float density = lanes_mean(way->by_lane) / lanes_mean(way->ratio);
    way->t = t;
    way->rarity = density > 0 ? 1 / density : 0;
}

float airlight_rival_far(const Path *path)
{
    const Airway *way = &path->from;
    if (!(way->rarity > 0) || !(way->share > 0) || !(way->alone > 0)) return 0;
    return way->rarity * share_far(way) * pass_density(way, way->t);
}

float airlight_rival_near(const Path *path, uint32_t emitter, Vec3 place)
{
    const World *world = path->tracer->world;
    const Airway *way = &path->from;
    if (!(way->rarity > 0) || !(way->share > 0)) return 0;
    float share = share_near(path, way, emitter);
    if (!(share > 0)) return 0;
    LightLine line = line_of(way);
    float of_tree = light_tree_probability_along(world->emitters.tree, emitter, &line);
    if (!(of_tree > 0)) return 0;
    LightPivot pivot = light_pivot_at(world, emitter, path->ray.time, place);
    Fall fall;
    if (!fall_about(path, way, emitter, &pivot, &fall)) return 0;
    return way->rarity * way->lights->near * of_tree * share * fall_density(&fall, way->t);
}

float airlight_rival_sample(const Path *path, const LightSample *light)
{
    if (!(path->from.rarity > 0) || !(light->pdf_w > 0)) return 0;
    if (light->emitter == EMITTER_NONE) return airlight_rival_far(path) * light->pdf_w;
    Vec3 place = vec3_along(path->scatter_point, light->distance, vec3_from_f(light->direction));
    return airlight_rival_near(path, light->emitter, place) * (light->pdf_w / light->choice);
}

float airlight_rival_hit(const Path *path, const Hit *hit, float pdf_hit)
{
    const World *world = path->tracer->world;
    if (!(path->from.rarity > 0) || !(pdf_hit > 0)) return 0;
    uint32_t emitter = emitter_of_hit(&world->emitters, hit);
    float choice = light_choice(world, path->scatter_lights, emitter, path->scatter_point, path->scatter_normal);
    return airlight_rival_near(path, emitter, ray_point(&path->ray, hit->t)) * (pdf_hit / choice);
}

/* slab_sky.c - see slab_sky.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/slab_sky.h"

#include "optics/fresnel.h"
#include "optics/flat_way.h"
#include "trace/slab_look.h"

/* A direction in which light from infinity comes to a place, by which faces, and how many steradians outside come of one there. */
typedef struct SkyStart {
    FlatFace faces[2]; /* from the place on; where they are does not matter */
    uint32_t n;        /* 0: it comes as it is outside */
    Vec3f direction;
    double spread;
} SkyStart;

/* Where looks begin. */
typedef struct SkyPlace {
    Vec3 position;
    uint32_t medium;
} SkyPlace;

/* ---- directions ---- */

/* Whether light of each wavelength comes to a medium from another direction. */
static bool comes_apart(const Path *path, uint32_t medium)
{
    const World *world = path->tracer->world;
    return world_medium_disperses(world, medium) || world_medium_disperses(world, WORLD_MEDIUM);
}

static bool is_same_direction(Vec3f a, Vec3f b)
{
    const float apart = 1e-4f; /* what rounding makes of them at a dozen faces, some of them met at grazing angles */
    Vec3f between = vec3f_sub(a, b);
    return vec3f_dot(between, between) < apart * apart;
}

/* Of the light that is in a direction outside; false: none comes by there. exact: the direction. */
static bool bend(SkyStart *start, Vec3f outside, Vec3 *exact)
{
    if (!flat_way_leaving(start->faces, start->n, vec3_from_f(outside), exact, &start->spread)) return false;
    start->direction = vec3f_from(*exact);
    return true;
}

/* What comes to a place from a direction outside. */
typedef struct SkyQuery {
    Vec3 from;
    double eta; /* the index there over that outside */
    Vec3f outside;
} SkyQuery;

/* In through a face across an axis of a body; and where the mirror is another axis, totally mirrored at a face across that one. False:
 * nothing does, or not by there. */
static bool find_start(const SkyQuery *query, const SlabAxes *slab, uint32_t axis, uint32_t mirror, SkyStart *start)
{
    start->n = 0;
    if (mirror != axis)
        start->faces[start->n++] = (FlatFace){.normal = vec3_from_f(slab->axes[mirror]), .eta = 1, .mirrored = true};
    start->faces[start->n++] = (FlatFace){.normal = vec3_from_f(slab->axes[axis]), .eta = query->eta};
    Vec3 direction;
    if (!bend(start, query->outside, &direction)) return false;
    double cosine = vec3_dot(direction, start->faces[0].normal), total = 1 - 1 / (query->eta * query->eta);
    return (mirror == axis || cosine * cosine < total) &&
           slab_leaves_across(slab, axis, mirror, query->from, direction);
}

static bool is_new(const SkyStart *starts, uint32_t n, Vec3f direction)
{
    for (uint32_t i = 0; i < n; i++)
        if (is_same_direction(starts[i].direction, direction)) return false;
    return true;
}

/* In which directions looks for light from outside begin, whose index is another than a place's, by the indices that a path takes. */
static uint32_t find_starts(Path *path, const SkyPlace *place, Vec3f outside, SkyStart starts[SKY_LOOKS])
{
    const SlabAxes *around[SLABS_AROUND];
    const float there = lanes_get(path_ior(path, place->medium), 0), out = lanes_get(path_ior(path, WORLD_MEDIUM), 0);
    const SkyQuery query = {place->position, (double)there / (double)out, outside};
    uint32_t n_around = slabs_around(&path->tracer->world->slabs, place->position, around), n = 0;
    for (uint32_t i = 0; i < n_around; i++) {
        const SlabAxes *slab = around[i];
        for (uint32_t k = 0; k < slab->n * slab->n && n < SKY_LOOKS; k++)
            n += find_start(&query, slab, k % slab->n, k / slab->n, &starts[n]) &&
                 is_new(starts, n, starts[n].direction);
    }
    return n;
}

/* Whether a look from a place begins as what has left the scene did, or has come from there, in a direction outside. */
static bool is_looked_at(Path *path, const SkyPlace *place, Vec3f start, Vec3f outside, double *spread)
{
    SkyStart starts[SKY_LOOKS];
    *spread = 1;
    if (slab_is_as_outside(path, place->medium)) return is_same_direction(start, outside);
    if (comes_apart(path, place->medium) && path->index_lane < 0) return false;
    for (uint32_t i = find_starts(path, place, outside, starts); i-- > 0;) {
        *spread = starts[i].spread;
        if (is_same_direction(start, starts[i].direction)) return true;
    }
    return false;
}

/* ---- looks ---- */

/* A look, and those that it parts into. */
typedef struct Look {
    Path path;
    SkyStart start;
    uint32_t n_faces, n_mirrored;
} Look;

static Lanes follow(Look *look);

/* What comes by being mirrored at a face: as often as it reflects, by a look of its own. */
static Lanes follow_mirrored(const Look *look, const Event *event, const SlabFace *face)
{
    const Path *path = &look->path;
    float chosen = lanes_mean(face->reflectance);
    if (look->n_mirrored == SLAB_MIRRORED ||
        sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_LOBE)) >= chosen)
        return lanes_all(0);
    Tracer *tracer = path->tracer, *looker = tracer_lend(tracer);
    Look mirrored = *look;
    Event there = *event;
    if (!looker) return lanes_all(0);
    if (nest_list_copy(&looker->list, &tracer->list) != STATUS_OK ||
        !hit_list_copy(&looker->hits, tracer->hits.items, event->n_cluster)) {
        tracer->out_of_memory = true;
        return lanes_all(0);
    }
    mirrored.n_mirrored++;
    mirrored.path.tracer = looker;
    mirrored.path.beta = lanes_mul(path->beta, lanes_scale(face->reflectance, 1 / chosen));
    mirrored.path.bounce++;
    path_leave(&mirrored.path, &there, &face->place, false, reflect_direction(path->ray.direction, face->place.normal));
    Lanes arrives = follow(&mirrored);
    tracer_take_back(tracer);
    return arrives;
}

/* What arrives of light from infinity, by this look and all that it parts into. */
static Lanes follow(Look *look)
{
    Path *path = &look->path;
    Lanes arrives = lanes_all(0);
    for (; !lanes_zero(path->beta); path->bounce++) {
        Event event;
        SlabFace face;
        path_next_event(path, &event);
        if (event.kind == EVENT_LOST) path->tracer->out_of_memory = true;
        if (event.kind == EVENT_ESCAPE) {
            SkyStart back = look->start;
            Vec3 exact;
            bool same = slab_is_as_outside(path, nest_medium(&path->tracer->list)) &&
                        bend(&back, path->ray.direction, &exact) &&
                        is_same_direction(back.direction, look->start.direction);
            return same ? lanes_add(arrives, path->beta) : arrives;
        }
        if (event.kind == EVENT_SCATTER || path->n_counted++ >= path->tracer->world->max_bounces) break;
        if (event.kind == EVENT_OPAQUE) {
            if (!slab_cross_pane(path, &event)) break;
            continue;
        }
        if (event.kind != EVENT_BOUNDARY || ++look->n_faces > SLAB_FACES || !slab_look_at_face(path, &event, &face))
            break;
        arrives = lanes_add(arrives, follow_mirrored(look, &event, &face));
        if (!face.passes) break;
        path->beta = lanes_mul(path->beta, lanes_rest(face.reflectance));
        path_leave(path, &event, &face.place, true, face.refracted);
    }
    return arrives;
}

bool slab_shadow(Path *path, const Ray *ray, Lanes *transmittance)
{
    Tracer *tracer = path->tracer;
    if (!slabs_are_on_way(&tracer->world->slabs, ray->origin, ray->direction, HUGE_VAL)) return false;
    Tracer *looker = tracer_lend(tracer);
    if (!looker) return false;
    if (!path_cross_towards(tracer, ray, &looker->list)) {
        tracer->out_of_memory = true;
        return false;
    }
    if (!slab_is_as_outside(path, nest_medium(&looker->list))) return false;
    Look look = {.start = {.n = 0, .direction = ray->direction, .spread = 1}};
    slab_begin_look(path, looker, -1, &look.path); /* each wavelength has its own, whichever the path takes for all */
    look.path.ray = *ray;
    look.path.ray.t_max = HUGE_VAL;
    *transmittance = follow(&look);
    tracer_take_back(tracer);
    return !lanes_zero(*transmittance);
}

/* ---- from within ---- */

/* A look in one direction: the light becomes one that is there; false: nothing comes from there. */
static bool look_by(Path *path, const LookPlace *from, const SkyPlace *place, const SkyStart *start, LightSample *light,
                    Lanes *arrives)
{
    const World *world = path->tracer->world;
    Look look = {.start = *start};
    const Vec3f direction = start->direction;
    int lane = path->bent_apart ? path->index_lane : -1;
    if (!slab_is_in_front(from->normal, direction) || !slab_start_look(path, from, lane, direction, &look.path) ||
        nest_medium(&look.path.tracer->list) != place->medium)
        return false;
    look.path.ray.t_max = HUGE_VAL;
    Lanes transmittance = follow(&look), radiance = light_sample_radiance(world, light, path->wavelengths.nm);
    if (lanes_zero(transmittance)) return false;
    *arrives = lanes_mul(transmittance, path_basic_radiance(world, radiance, WORLD_MEDIUM, path->wavelengths.nm));
    light->direction = direction;
    light->pdf_w *= (float)start->spread;
    light->arrives = arrives;
    return true;
}

/* Looks by all ways into one medium, from number n on. Where each wavelength comes another way, and the path does not know yet by which
 * indices it goes, its sample's second path is to begin before. Returns up to which. */
static uint32_t look_from_within(Path *path, const LookPlace *from, const SkyPlace *place, const LightSample *light,
                                 LightLooks *looks, uint32_t n)
{
    SkyStart starts[SKY_LOOKS];
    if (!slab_is_in_front(from->normal, light->direction)) return n;
    if (comes_apart(path, place->medium)) {
        if (path->index_lane < 0) return n;
        path->bent_apart = true;
    }
    const uint32_t n_starts = find_starts(path, place, light->direction, starts);
    for (uint32_t i = 0; i < n_starts; i++) {
        LightSample bent = *light;
        if (!look_by(path, from, place, &starts[i], &bent, &looks->arrives[n])) continue;
        looks->lights[n++] = bent;
    }
    return n;
}

/* The media that a place takes light from: two where it lies between them, and takes light from both sides. */
static uint32_t media_of(Path *path, const LookPlace *from, Vec3f towards, uint32_t media[2])
{
    uint32_t n = 0;
    Ray ray;
    const Vec3f normal = from->place->geometric, sides[2] = {normal, vec3f_negate(normal)};
    const bool one_side = vec3f_dot(from->normal, from->normal) > 0;
    for (int i = 0; i < (from->event && !one_side ? 2 : 1); i++) {
        Vec3f direction = !from->event ? towards : one_side ? from->normal : sides[i];
        if (!slab_start_ray(path, from, direction, &ray)) break;
        uint32_t medium = nest_medium(&path->tracer->looker->list);
        if (n == 0 || media[0] != medium) media[n++] = medium;
    }
    return n;
}

void slab_look_at_sky(Path *path, const LookPlace *from, LightLooks *looks)
{
    const LightSample light = looks->lights[0];
    const World *world = path->tracer->world;
    const SlabAxes *around[SLABS_AROUND];
    uint32_t media[2];
    if (!(light.pdf_w > 0) || isfinite(light.distance) || !slabs_around(&world->slabs, from->place->position, around) ||
        !tracer_lend(path->tracer))
        return;
    const uint32_t n_media = media_of(path, from, light.direction, media);
    bool straight = false; /* it comes so, too, as from below to what is under the sea */
    for (uint32_t i = 0; i < n_media; i++)
        straight |= slab_is_as_outside(path, media[i]) || (world->reach[media[i]] & REACH_FAR);
    if (!straight) looks->lights[0].pdf_w = 0;
    uint32_t n = straight;
    for (uint32_t i = 0; i < n_media; i++) {
        const SkyPlace place = {from->place->position, media[i]};
        if (!slab_is_as_outside(path, media[i])) n = look_from_within(path, from, &place, &light, looks, n);
    }
    if (n > 0) looks->n = n;
    tracer_take_back(path->tracer);
}

/* ---- what looks would have found ---- */

void slab_leave_scene(Path *path)
{
    const SlabWay *way = &path->slab_way;
    const SkyPlace place = {path->scatter_point, way->medium};
    double spread;
    if (way->outside ? !slabs_are_on_way(&path->tracer->world->slabs, place.position, way->direction, HUGE_VAL)
                     : !slab_way_has_rival(path) || !slab_is_in_front(path->scatter_normal, path->ray.direction))
        return;
    if (!slab_is_as_outside(path, nest_medium(&path->tracer->list)) ||
        !is_looked_at(path, &place, way->direction, path->ray.direction, &spread))
        return;
    if (way->outside) {
        path->ray.direction = way->direction;
        path->from.rarity = way->rarity;
    }
    if (way->scatter_pdf >= 0) path->scatter_pdf = way->scatter_pdf / (float)spread;
    path->probing.bent = way->bent;
}

bool slab_sky_is_looked_at(Path *photon, Vec3f outward, Vec3 place, Vec3f normal)
{
    double spread;
    const World *world = photon->tracer->world;
    const SkyPlace there = {place, nest_medium(&photon->tracer->list)};
    bool looks = slab_is_as_outside(photon, there.medium) ? slabs_are_on_way(&world->slabs, place, outward, HUGE_VAL)
                                                          : (world->reach_through[there.medium] & REACH_FAR) != 0;
    return looks && slab_is_in_front(normal, outward) &&
           is_looked_at(photon, &there, vec3f_negate(photon->ray.direction), outward, &spread);
}

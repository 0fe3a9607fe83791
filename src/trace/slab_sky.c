/* slab_sky.c - see slab_sky.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/slab_sky.h"

#include "trace/slab_faces.h"

/* The way of light from infinity to a place. */
typedef struct SkyWay {
    FaceWay faces;
    Vec3 direction; /* from the place */
    double spread;  /* steradians outside for each there */
} SkyWay;

/* The way that looks would go, of a look whose ray and list are at a place: outward, in the direction that is outside. */
static bool find_way(Path *look, SkyWay *way)
{
    look->ray.t_max = HUGE_VAL;
    return slab_find_faces(look, true, &way->faces) && way->faces.n > 0 &&
           slab_is_as_outside(look, nest_medium(&look->tracer->list)) &&
           flat_way_leaving(way->faces.faces, way->faces.n, vec3_from_f(look->ray.direction), &way->direction,
                            &way->spread);
}

/* ---- looks ---- */

/* Of a look that was started. By whose indices it goes: where each wavelength comes another way, and the path does not know yet by which
 * it goes, its sample's second path is to begin before. False: it does not go. */
static bool find_way_by_indices(Path *path, const LookPlace *from, Vec3f outward, Path *look, SkyWay *way)
{
    if (!find_way(look, way)) return false;
    if (!way->faces.disperses) return true;
    if (path->index_lane < 0) return false;
    path->bent_apart = true;
    return slab_start_look(path, from, path->index_lane, outward, look) && find_way(look, way);
}

/* What arrives of a radiance that is known outside. */
static bool follow(Path *path, const LookPlace *from, const LightSample *light, const SkyWay *way, int lane,
                   Lanes *arrives)
{
    const World *world = path->tracer->world;
    Path look;
    Lanes transmittance;
    uint32_t medium;
    if (!slab_start_look(path, from, lane, vec3f_from(way->direction), &look) || !slab_follow_faces(&look, &way->faces))
        return false;
    look.ray.t_max = HUGE_VAL;
    if (!path_shadow(&look, &look.ray, &transmittance, &medium)) return false;
    Lanes radiance = light_sample_radiance(world, light, look.wavelengths.nm);
    *arrives = lanes_mul(lanes_mul(look.beta, transmittance),
                         path_basic_radiance(world, radiance, WORLD_MEDIUM, look.wavelengths.nm));
    return true;
}

/* The light becomes one in the direction of the way; false: nothing comes by it. look: started towards the light. */
static bool look_by(Path *path, const LookPlace *from, Path *look, LightSample *light, Lanes *arrives)
{
    SkyWay way;
    if (!slab_is_in_front(from->normal, light->direction) ||
        !find_way_by_indices(path, from, light->direction, look, &way))
        return false;
    Vec3f direction = vec3f_from(way.direction);
    if (!slab_is_in_front(from->normal, direction) || !follow(path, from, light, &way, look->index_lane, arrives))
        return false;
    light->direction = direction;
    light->pdf_w *= (float)way.spread;
    light->arrives = arrives;
    return true;
}

void slab_look_at_sky(Path *path, const LookPlace *from, LightLooks *looks)
{
    LightSample *light = &looks->lights[0];
    if (!(light->pdf_w > 0) || isfinite(light->distance) ||
        !slabs_are_on_way(&path->tracer->world->slabs, from->place->position, light->direction, HUGE_VAL) ||
        !tracer_lend(path->tracer))
        return;
    Path look;
    bool started = slab_start_look(path, from, path->bent_apart ? path->index_lane : -1, light->direction, &look);
    bool bends = started && !slab_is_as_outside(&look, nest_medium(&look.tracer->list));
    if (bends && !look_by(path, from, &look, light, &looks->arrives[0])) light->pdf_w = 0;
    tracer_take_back(path->tracer);
}

/* ---- what looks would have found ---- */

/* from: on a way through slabs that was gone, in front of the first face. */
static bool would_find(const Path *path, Vec3 from, Vec3f outward, SkyWay *way)
{
    const SlabWay *gone = &path->slab_way;
    Tracer *looker = gone->n_mirrored ? NULL : tracer_lend(path->tracer);
    if (!looker) return false;
    Path look;
    bool found = slab_start_beside(path, looker, from, outward, &look) &&
                 !slab_is_as_outside(&look, nest_medium(&looker->list)) && find_way(&look, way) &&
                 slab_steps_of(&way->faces) == gone->steps && (path->index_lane >= 0 || !way->faces.disperses);
    tracer_take_back(path->tracer);
    return found;
}

void slab_leave_for_sky(Path *path)
{
    const float same = 1e-3f;
    const SlabWay *gone = &path->slab_way;
    SkyWay way;
    if (!slab_way_has_rival(path) || !slab_is_in_front(path->scatter_normal, path->ray.direction) ||
        !slabs_are_on_way(&path->tracer->world->slabs, path->scatter_point, path->ray.direction, HUGE_VAL) ||
        !would_find(path, slab_right_beside(path->scatter_point, gone->first_face), path->ray.direction, &way))
        return;
    Vec3f apart = vec3f_sub(vec3f_from(way.direction), gone->direction);
    if (vec3f_dot(apart, apart) > same * same) return;
    if (gone->scatter_pdf >= 0) path->scatter_pdf = gone->scatter_pdf / (float)way.spread;
    path->probing.bent = gone->bent;
}

bool slab_sky_is_looked_at(const Path *photon, Vec3f outward, Vec3 place)
{
    SkyWay way;
    const World *world = photon->tracer->world;
    return (world->reach_through[nest_medium(&photon->tracer->list)] & REACH_FAR) &&
           slabs_are_on_way(&world->slabs, place, outward, HUGE_VAL) &&
           would_find(photon, slab_right_beside(place, photon->ray.origin), outward, &way);
}

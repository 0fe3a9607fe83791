/* crystal_cross.c - see crystal_cross.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/crystal_cross.h"

#include <string.h>

#include "optics/crystal.h"

CrystalSide path_crystal_side(Path *path, uint32_t medium, bool *bends_alike)
{
    const SceneMedium *row = &path->tracer->world->scene->media[medium];
    const Lanes ordinary = path_ior(path, medium), extraordinary = path_extraordinary(path, medium);
    *bends_alike = *bends_alike && lanes_uniform(ordinary) && lanes_uniform(extraordinary);
    return (CrystalSide){.ordinary = (double)lanes_get(ordinary, 0),
                         .extraordinary = (double)lanes_get(row->refracts_doubly ? extraordinary : ordinary, 0),
                         .axis = row->optic_axis};
}

/* What a path has in a crystal that has begun there, or was scattered: light of both kinds, alike. */
static CrystalWave wave_of(Path *path, const CrystalSide *side)
{
    if (crystal_is_isotropic(side)) return CRYSTAL_UNPOLARIZED;
    if (path->wave != CRYSTAL_UNPOLARIZED) return path->wave;
    return path_decide(path, 0.5f) ? CRYSTAL_ORDINARY : CRYSTAL_EXTRAORDINARY;
}

/* Whether each way is on the side of the surface that it should be on, which is the geometry's to say. */
static bool keep_sides(const CrystalWay *ways, uint32_t n, Vec3 geometric)
{
    for (uint32_t i = 0; i < n; i++)
        if ((vec3_dot(ways[i].direction, geometric) < 0) != ways[i].through) return false;
    return true;
}

uint32_t path_crystal_ways(Path *path, const Event *event, const SurfacePlace *place, CrystalWay ways[CRYSTAL_WAYS],
                           bool *bends_alike)
{
    *bends_alike = true;
    const CrystalSide from = path_crystal_side(path, event->crossing.medium_from, bends_alike),
                      to = path_crystal_side(path, event->crossing.medium_to, bends_alike);
    const CrystalWave wave = wave_of(path, &from);
    const Vec3 direction = vec3_normalize(vec3_from_f(path->ray.direction)),
               geometric = vec3_normalize(vec3_from_f(place->geometric)),
               normal = vec3_normalize(vec3_from_f(place->normal));
    const uint32_t n = crystal_meet(&from, &to, direction, wave, normal, ways);
    const bool good = keep_sides(ways, n, geometric);
    if (good && (ways[n - 1].through || path->total_reflections < PATH_MOST_TOTAL)) return n;
    CrystalWay flat[CRYSTAL_WAYS];
    const uint32_t n_flat = crystal_meet(&from, &to, direction, wave, geometric, flat);
    /* As at other boundaries, the face lets out what has long been within; where it would not, as in a ball that holds it for ever,
     * relief may. */
    if (good && !flat[n_flat - 1].through) return n;
    memcpy(ways, flat, n_flat * sizeof *flat);
    return n_flat;
}

static const CrystalWay *choose(Path *path, const CrystalWay *ways, uint32_t n)
{
    double left = 1;
    for (; n > 1; ways++, n--) {
        if (path_decide(path, (float)fmin(ways->part / left, 1))) return ways;
        left = fmax(left - ways->part, 1e-12);
    }
    return ways;
}

void path_cross_crystal(Path *path, Event *event, const SurfacePlace *place)
{
    bool bends_alike;
    CrystalWay ways[CRYSTAL_WAYS];
    const uint32_t n = path_crystal_ways(path, event, place, ways, &bends_alike);
    const CrystalWay *way = choose(path, ways, n);
    path->total_reflections = ways[n - 1].through ? 0 : path->total_reflections + 1;
    if (!bends_alike) { /* each wavelength goes another way: the path goes on for the hero alone */
        path->beta = lanes_mul(path->beta, lanes(1, 0, 0, 0));
        path->ratio = lanes_mul(path->ratio, lanes(1, 0, 0, 0));
    }
    path->scatter_pdf = -1;
    path->probing.bent = true;
    path_leave(path, event, place, way->through, vec3f_from(way->direction));
    path->wave = way->wave;
}

/* glow.c - media that shine, for light sampling: how much light comes from which part of them, and places in them.
 *
 * A medium with a grid of densities is divided into the grid's bricks, whose means are known. One that is as dense
 * everywhere fills cells of a box around its hull: how much of each is found by looking at places in it. A cell that
 * none of them hit, though the hull reaches into it, is not chosen, and its light is found by chance.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "base/angle.h"
#include "base/hash.h"
#include "trace/media.h"

/* The luminance of a black body over that at the reference, nearly: at the wavelength at which eyes see best. */
static double relative_luminance(const SceneMedium *medium, float kelvin)
{
    return (double)lanes_get(media_planck_ratio(medium, kelvin, lanes_all(570)), 0);
}

static Vec3 brick_size(const Glow *glow, const int32_t first[3])
{
    double size[3];
    for (int axis = 0; axis < 3; axis++) size[axis] = fmin(glow->edge, glow->n_edges[axis] - first[axis]);
    return vec3(size[0], size[1], size[2]);
}

static void brick_first(const Glow *glow, size_t brick, int32_t first[3])
{
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = (int32_t)(brick % (size_t)glow->n_along[axis]) * glow->edge;
        brick /= (size_t)glow->n_along[axis];
    }
}

/* How bright a brick of a density is in the mean, without the medium's own radiance. */
static double brick_brightness(const SceneMedium *medium, size_t number, Vec3 corner, Vec3 size)
{
    enum { SIDE = 4 };
    const Volume *density = medium->density;
    const VolumeBrick *brick = &density->bricks[number];
    if (!(brick->high > 0) || !medium->temperature) return (double)brick->mean;
    Affine to_frame, to_temperature;
    affine_invert(&density->to_lattice, &to_frame);
    to_temperature = affine_compose(&medium->temperature->to_lattice, &to_frame);
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        Vec3 place =
            vec3(corner.x + size.x * (i % SIDE + 0.5) / SIDE, corner.y + size.y * (i / SIDE % SIDE + 0.5) / SIDE,
                 corner.z + size.z * (i / (SIDE * SIDE) + 0.5) / SIDE);
        float kelvin = volume_at(medium->temperature, affine_point(&to_temperature, place));
        sum += (double)volume_at(density, place) * relative_luminance(medium, kelvin);
    }
    return sum / (SIDE * SIDE * SIDE);
}

/* Looks which part of a cell is in the hull, and how bright it is there. */
typedef struct CellLook {
    const CompiledScene *compiled;
    const WorldMedia *media;
    const MediumPlace *place;
    Affine to_world;
    HitList hits;
    NestList list;
} CellLook;

static Status cell_brightness(CellLook *look, Vec3 corner, uint64_t number, double *brightness, Error *error)
{
    enum { SIDE = 2 };
    const SceneMedium *medium = &look->compiled->scene->media[look->place->medium];
    *brightness = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        uint64_t random = hash_u64(number * SIDE * SIDE * SIDE + (uint64_t)i);
        double jitter[3];
        for (int axis = 0; axis < 3; axis++) jitter[axis] = (double)(random >> 21 * axis & 0x1fffff) * 0x1p-21;
        Vec3 place = affine_point(&look->to_world, vec3(corner.x + (i % SIDE + jitter[0]) / SIDE,
                                                        corner.y + (i / SIDE % SIDE + jitter[1]) / SIDE,
                                                        corner.z + (i / (SIDE * SIDE) + jitter[2]) / SIDE));
        if (compiled_interior(look->compiled, vec3f_from(place), 0, &look->hits, &look->list, NULL) != STATUS_OK)
            return fail_memory(error, look->hits.capacity * sizeof(Hit), "media that shine");
        if (!media_is_there(look->compiled, look->media, look->place, &look->list)) continue;
        double here = 1;
        if (medium->temperature)
            here = relative_luminance(
                medium, volume_at(medium->temperature, affine_point(&look->place->maps.to_temperature, place)));
        *brightness += here / (SIDE * SIDE * SIDE);
    }
    return STATUS_OK;
}

/* The mean brightness of all cells of a hull that shines as a whole. */
static Status look_at_cells(const CompiledScene *compiled, const WorldMedia *media, const Glow *glow, double *bright,
                            Error *error)
{
    CellLook look = {.compiled = compiled, .media = media, .place = glow->place};
    if (!affine_invert(&glow->place->maps.to_density, &look.to_world)) return STATUS_OK;
    nest_list_init(&look.list);
    Status status = STATUS_OK;
    for (size_t i = 0; i < glow->n_bricks && status == STATUS_OK; i++) {
        int32_t first[3];
        brick_first(glow, i, first);
        status = cell_brightness(&look, vec3(first[0], first[1], first[2]), i, &bright[i], error);
    }
    nest_list_clear(&look.list);
    hit_list_clear(&look.hits);
    return status;
}

/* From the brightness of each brick: shares by light, and a little for every brick that is not empty, as its light was only
 * sampled; the box around them, the way through them, and the sum of their light. */
static void find_shares(const SceneMedium *medium, Glow *glow)
{
    const double even_part = 0.02;
    double light = 0, space = 0, bright_space = 0, largest = 0, sum = 0;
    glow->box = box3_empty();
    for (size_t i = 0; i < glow->n_bricks; i++) {
        int32_t first[3];
        brick_first(glow, i, first);
        Vec3 size = brick_size(glow, first), corner = vec3(first[0], first[1], first[2]);
        double room = size.x * size.y * size.z;
        largest = fmax(largest, glow->shares[i]);
        light += glow->shares[i] * room;
        if (medium->density ? !(medium->density->bricks[i].high > 0) : !(glow->shares[i] > 0)) continue;
        space += room;
        glow->box = box3_add_point(box3_add_point(glow->box, corner), vec3_add(corner, size));
    }
    for (size_t i = 0; i < glow->n_bricks && light > 0; i++) {
        int32_t first[3];
        brick_first(glow, i, first);
        Vec3 size = brick_size(glow, first);
        double room = size.x * size.y * size.z;
        bool empty = medium->density ? !(medium->density->bricks[i].high > 0) : !(glow->shares[i] > 0);
        if (glow->shares[i] > 0.1 * largest) bright_space += room;
        sum += (1 - even_part) * glow->shares[i] * room / light + (empty ? 0 : even_part * room / space);
        glow->shares[i] = sum;
    }
    for (size_t i = 0; i < glow->n_bricks; i++) glow->shares[i] /= sum > 0 ? sum : 1;
    glow->across = cbrt(bright_space); /* of the lattice still */
    glow->power = light * spectrum_luminance(&medium->emission);
}

/* Whether light leaves the hull along straight lines anywhere: into the world's medium, or into that of a hull it meets. */
static bool lets_out(const CompiledScene *compiled, uint32_t hull)
{
    const Scene *scene = compiled->scene;
    const NestHull *hulls = compiled->hulls;
    if (hull == NEST_WORLD || hulls[hull].mixes) return true;
    const Lanes nm = lanes(450, 520, 590, 650);
    Lanes own = spectrum_at(&scene->media[hulls[hull].medium].ior, nm);
    if (lanes_zero(lanes_sub(own, spectrum_at(&scene->media[0].ior, nm)))) return true;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        uint32_t a = compiled->hull_of_object[compiled->pairs[i].a], b = compiled->hull_of_object[compiled->pairs[i].b];
        if (a != hull && b != hull) continue;
        const SceneMedium *other = &scene->media[hulls[a == hull ? b : a].medium];
        if (lanes_zero(lanes_sub(own, spectrum_at(&other->ior, nm)))) return true;
    }
    return false;
}

static void divide(const MediumPlace *place, const SceneMedium *medium, Glow *glow)
{
    *glow = (Glow){.place = place, .edge = medium->density ? VOLUME_BRICK : 1, .n_bricks = 1};
    for (int axis = 0; axis < 3; axis++) {
        glow->n_edges[axis] = medium->density ? medium->density->n_points[axis] - 1 : place->n_cells[axis];
        glow->n_along[axis] = medium->density ? medium->density->n_bricks[axis] : place->n_cells[axis];
        glow->n_bricks *= (size_t)glow->n_along[axis];
    }
}

static Status find_glow(const CompiledScene *compiled, WorldMedia *media, const MediumPlace *place, Error *error)
{
    const SceneMedium *medium = &compiled->scene->media[place->medium];
    Glow *glow = &media->glows[media->n_glows];
    if (!medium->emits || (medium->density ? medium->density->outside > 0 : !place->has_cells)) return STATUS_OK;
    if (!medium->density && !lets_out(compiled, place->hull)) return STATUS_OK;
    divide(place, medium, glow);
    glow->shares = calloc(glow->n_bricks, sizeof *glow->shares);
    if (!glow->shares) return fail_memory(error, glow->n_bricks * sizeof *glow->shares, "media that shine");
    if (!medium->density) TRY(look_at_cells(compiled, media, glow, glow->shares, error));
    for (size_t i = 0; medium->density && i < glow->n_bricks; i++) {
        int32_t first[3];
        brick_first(glow, i, first);
        glow->shares[i] = brick_brightness(medium, i, vec3(first[0], first[1], first[2]), brick_size(glow, first));
    }
    find_shares(medium, glow);
    glow->power *= 4 * MEN_PI / place->maps.stretch;
    glow->across /= cbrt(place->maps.stretch);
    if (glow->power > 0 && isfinite(glow->power) && glow->across > 0) {
        media->glow_of_place[place - media->places] = media->n_glows++;
    } else {
        free(glow->shares);
        glow->shares = NULL;
    }
    return STATUS_OK;
}

Status glows_find(const CompiledScene *compiled, WorldMedia *media, Error *error)
{
    media->glows = calloc(media->n_places + 1U, sizeof *media->glows);
    media->glow_of_place = malloc((media->n_places + 1U) * sizeof *media->glow_of_place);
    if (!media->glows || !media->glow_of_place)
        return fail_memory(error, media->n_places * sizeof *media->glows, "media that shine");
    for (uint32_t i = 0; i < media->n_places; i++) media->glow_of_place[i] = SCENE_NONE;
    for (uint32_t i = 0; i < media->n_places; i++) {
        Status status = find_glow(compiled, media, &media->places[i], error);
        if (status == STATUS_OK) continue;
        media->n_glows++; /* what it holds so far is freed with the others */
        return status;
    }
    return STATUS_OK;
}

Box3 glow_box(const Scene *scene, const Glow *glow, double time)
{
    MediumMaps room;
    const MediumMaps *maps = media_maps(scene, glow->place, time, &room);
    Affine inverse;
    const Affine *to_world = media_from_density(glow->place, maps, &inverse);
    return to_world ? affine_box(to_world, glow->box) : box3_empty();
}

/* The digits that have chosen a brick are used up; of what is left of them the first ones are evenly spread still, the last
 * ones are filled up. */
static double third_number(double left, const float u[2])
{
    uint64_t more = hash_u64((uint64_t)((double)u[0] * 0x1p24) << 32 | (uint64_t)((double)u[1] * 0x1p24));
    left += (double)(more >> 11) * 0x1p-53 * 0x1p-16;
    return left < 1 ? left : left - 1;
}

/* Of places in the brick, in lattice coordinates' cubes. */
static double density_in(const Glow *glow, size_t brick)
{
    int32_t first[3];
    brick_first(glow, brick, first);
    Vec3 size = brick_size(glow, first);
    double share = glow->shares[brick] - (brick ? glow->shares[brick - 1] : 0);
    return share / (size.x * size.y * size.z);
}

GlowPoint glow_sample(const Scene *scene, const Glow *glow, double time, double digits, const float u[2])
{
    const SceneMedium *medium = &scene->media[glow->place->medium];
    size_t low = 0, high = glow->n_bricks - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (glow->shares[middle] > digits)
            high = middle;
        else
            low = middle + 1;
    }
    double before = low ? glow->shares[low - 1] : 0, left = (digits - before) / (glow->shares[low] - before);
    int32_t first[3];
    brick_first(glow, low, first);
    Vec3 size = brick_size(glow, first);
    Vec3 at = vec3(first[0] + size.x * (double)u[0], first[1] + size.y * (double)u[1],
                   first[2] + size.z * third_number(left, u));
    MediumMaps room;
    const MediumMaps *maps = media_maps(scene, glow->place, time, &room);
    GlowPoint point = {.amount = medium->density ? volume_at(medium->density, at) : 1};
    Affine inverse;
    const Affine *to_world = media_from_density(glow->place, maps, &inverse);
    if (!to_world) return (GlowPoint){.amount = 0};
    point.position = affine_point(to_world, at);
    point.density = density_in(glow, low) * maps->stretch;
    if (medium->temperature)
        point.kelvin = volume_at(medium->temperature, affine_point(&maps->to_temperature, point.position));
    return point;
}

double glow_density(const Glow *glow, const MediumMaps *maps, Vec3 position)
{
    Vec3 at = affine_point(&maps->to_density, position);
    double coordinate[3] = {at.x, at.y, at.z};
    size_t brick = 0;
    for (int axis = 2; axis >= 0; axis--) {
        if (!(coordinate[axis] >= 0 && coordinate[axis] < glow->n_edges[axis])) return 0;
        brick = brick * (size_t)glow->n_along[axis] + (size_t)(coordinate[axis] / glow->edge);
    }
    return density_in(glow, brick) * maps->stretch;
}

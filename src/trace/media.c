/* media.c - where the volumes of media are, and how they shine.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/world.h"

#include <stdlib.h>

#include "base/hash.h"

/* ---- places ---- */

/* With the frame that the volumes stand in; no object is flat. */
static MediumMaps maps_of(const SceneMedium *medium, const Affine *frame_to_world)
{
    MediumMaps maps = {.stretch = 1};
    Affine to_frame;
    if (!affine_invert(frame_to_world, &to_frame)) to_frame = affine_identity();
    if (medium->temperature) maps.to_temperature = affine_compose(&medium->temperature->to_lattice, &to_frame);
    if (!medium->density) return maps;
    maps.to_density = affine_compose(&medium->density->to_lattice, &to_frame);
    maps.stretch = fabs(affine_determinant(&maps.to_density));
    return maps;
}

static MediumPlace place_of_frame(const CompiledScene *compiled, const SceneFrame *frame)
{
    const Scene *scene = compiled->scene;
    const SceneObject *object = &scene->objects[frame->object];
    MediumPlace place = {.hull = compiled->hull_of_object[frame->object],
                         .medium = object->medium,
                         .keys = scene_keys(scene, object),
                         .maps = maps_of(&scene->media[object->medium], &frame->to_world)};
    Affine to_object;
    if (affine_invert(&object->to_world, &to_object))
        place.frame_in_object = affine_compose(&to_object, &frame->to_world);
    return place;
}

static Status find_places(const CompiledScene *compiled, WorldMedia *media, Error *error)
{
    const Scene *scene = compiled->scene;
    size_t n_hulls = compiled->n_hulls;
    media->places = calloc(scene->n_frames + 1U, sizeof *media->places);
    media->place_of_hull = malloc((n_hulls + 1) * sizeof *media->place_of_hull);
    if (!media->places || !media->place_of_hull) return fail_memory(error, n_hulls * sizeof(uint32_t), "media");
    for (size_t h = 0; h <= n_hulls; h++) media->place_of_hull[h] = SCENE_NONE;
    for (uint32_t i = 0; i < scene->n_frames; i++) {
        MediumPlace *place = &media->places[media->n_places];
        *place = place_of_frame(compiled, &scene->frames[i]);
        media->place_of_hull[place->hull] = media->n_places++;
    }
    if (scene->media[0].density || scene->media[0].temperature) {
        const Affine world = affine_identity();
        media->places[media->n_places] = (MediumPlace){.hull = NEST_WORLD, .maps = maps_of(&scene->media[0], &world)};
        media->place_of_hull[n_hulls] = media->n_places++;
    }
    return STATUS_OK;
}

bool media_is_there(const World *world, const MediumPlace *place, const NestList *list)
{
    const NestOrder *order = &world->compiled->order;
    if (place->hull == NEST_WORLD || !nest_mixes(order, place->hull)) return nest_owner(order, list) == place->hull;
    const NestState *state = world->media.mixing_state;
    return nest_list_has(list, place->hull) && state[place->medium] == state[nest_medium(order, list)];
}

const MediumMaps *media_maps(const Scene *scene, const MediumPlace *place, double time, MediumMaps *room)
{
    if (!place->keys) return &place->maps;
    Affine to_world = affine_between(place->keys, scene->n_keys, time);
    to_world = affine_compose(&to_world, &place->frame_in_object);
    *room = maps_of(&scene->media[place->medium], &to_world);
    return room;
}

/* ---- light ---- */

/* Quotients of Planck's law, with negative exponents only: e^(a0 - a) (1 - e^-a0) / (1 - e^-a), a = h c / (k w T). */
Lanes media_planck_ratio(const SceneMedium *medium, float kelvin, Lanes wavelength_nm)
{
    const float second_constant_nm = 1.438776877e7f; /* h c / k, in nm K; CODATA 2018 */
    if (!(kelvin > 1)) return lanes_all(0);          /* colder is black in any float */
    Lanes per_kelvin = lanes_div(lanes_all(second_constant_nm), wavelength_nm);
    Lanes reference = lanes_scale(per_kelvin, 1 / (float)medium->reference_k),
          here = lanes_scale(per_kelvin, 1 / kelvin);
    Lanes zero = lanes_all(0);
    Lanes ratio = lanes_exp(lanes_sub(reference, here));
    return lanes_div(lanes_mul(ratio, lanes_rest(lanes_exp(lanes_sub(zero, reference)))),
                     lanes_rest(lanes_exp(lanes_sub(zero, here))));
}

/* The luminance of a black body over that at the reference, nearly: at the wavelength at which eyes see best. */
static double relative_luminance(const SceneMedium *medium, float kelvin)
{
    return (double)lanes_get(media_planck_ratio(medium, kelvin, lanes_all(570)), 0);
}

static Vec3 brick_size(const Volume *volume, const int32_t first[3])
{
    double size[3];
    for (int axis = 0; axis < 3; axis++) size[axis] = fmin(VOLUME_BRICK, volume->n_points[axis] - 1 - first[axis]);
    return vec3(size[0], size[1], size[2]);
}

static void brick_first(const Volume *volume, size_t brick, int32_t first[3])
{
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = (int32_t)(brick % (size_t)volume->n_bricks[axis]) * VOLUME_BRICK;
        brick /= (size_t)volume->n_bricks[axis];
    }
}

/* How bright a brick is in the mean, without the medium's own radiance. */
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

/* Fills in the shares: by light, and a little for every brick that is not empty, as its light was only sampled. */
static Status find_shares(const SceneMedium *medium, Glow *glow, Error *error)
{
    const double even_part = 0.02;
    const Volume *volume = medium->density;
    glow->n_bricks = (size_t)volume->n_bricks[0] * (size_t)volume->n_bricks[1] * (size_t)volume->n_bricks[2];
    glow->shares = malloc(glow->n_bricks * sizeof *glow->shares);
    if (!glow->shares) return fail_memory(error, glow->n_bricks * sizeof *glow->shares, "media that shine");
    double light = 0, space = 0, bright_space = 0, largest = 0;
    for (size_t i = 0; i < glow->n_bricks; i++) {
        int32_t first[3];
        brick_first(volume, i, first);
        Vec3 size = brick_size(volume, first);
        double room = size.x * size.y * size.z;
        double bright = brick_brightness(medium, i, vec3(first[0], first[1], first[2]), size);
        glow->shares[i] = bright * room;
        light += bright * room;
        if (volume->bricks[i].high > 0) space += room;
        largest = fmax(largest, bright);
    }
    if (!(light > 0)) return STATUS_OK;
    double sum = 0;
    for (size_t i = 0; i < glow->n_bricks; i++) {
        int32_t first[3];
        brick_first(volume, i, first);
        Vec3 size = brick_size(volume, first);
        double room = size.x * size.y * size.z;
        if (glow->shares[i] > 0.1 * largest * room) bright_space += room;
        sum += (1 - even_part) * glow->shares[i] / light + (volume->bricks[i].high > 0 ? even_part * room / space : 0);
        glow->shares[i] = sum;
    }
    for (size_t i = 0; i < glow->n_bricks; i++) glow->shares[i] /= sum;
    glow->across = cbrt(bright_space); /* of the lattice still */
    glow->power = light * spectrum_luminance(&medium->emission);
    return STATUS_OK;
}

static Status find_glow(const CompiledScene *compiled, WorldMedia *media, const MediumPlace *place, Error *error)
{
    const Scene *scene = compiled->scene;
    const SceneMedium *medium = &scene->media[place->medium];
    Glow *glow = &media->glows[media->n_glows];
    *glow = (Glow){.place = place};
    if (!medium->emits || !medium->density || medium->density->outside > 0) return STATUS_OK;
    TRY(find_shares(medium, glow, error));
    glow->power *= 4 * acos(-1) / place->maps.stretch;
    glow->across /= cbrt(place->maps.stretch);
    if (glow->power > 0 && isfinite(glow->power) && glow->across > 0)
        media->glow_of_place[place - media->places] = media->n_glows++;
    else
        free(glow->shares);
    return STATUS_OK;
}

static Status find_glows(const CompiledScene *compiled, WorldMedia *media, Error *error)
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
    double total = 0, cumulative = 0;
    for (uint32_t i = 0; i < media->n_glows; i++) total += media->glows[i].power;
    for (uint32_t i = 0; i < media->n_glows; i++) { /* half by power, half evenly, as lights */
        Glow *glow = &media->glows[i];
        double probability = 0.5 * glow->power / total + 0.5 / media->n_glows;
        cumulative += probability;
        glow->probability = (float)probability;
        glow->cumulative = (float)cumulative;
    }
    return STATUS_OK;
}

static double third_number(double digits, const float u[2])
{
    /* the digits that have chosen a brick are used up */
    uint64_t bits = (uint64_t)(digits * 0x1p53) ^
                    hash_u64((uint64_t)((double)u[0] * 0x1p24) << 32 | (uint64_t)((double)u[1] * 0x1p24));
    return (double)(hash_u64(bits) >> 11) * 0x1p-53;
}

GlowPoint glow_sample(const Scene *scene, const Glow *glow, double time, double digits, const float u[2])
{
    const SceneMedium *medium = &scene->media[glow->place->medium];
    const Volume *volume = medium->density;
    size_t low = 0, high = glow->n_bricks - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (glow->shares[middle] > digits)
            high = middle;
        else
            low = middle + 1;
    }
    int32_t first[3];
    brick_first(volume, low, first);
    Vec3 size = brick_size(volume, first);
    Vec3 at = vec3(first[0] + size.x * (double)u[0], first[1] + size.y * (double)u[1],
                   first[2] + size.z * third_number(digits, u));
    MediumMaps room;
    const MediumMaps *maps = media_maps(scene, glow->place, time, &room);
    Affine to_world;
    GlowPoint point = {.amount = volume_at(volume, at)};
    if (!affine_invert(&maps->to_density, &to_world)) return (GlowPoint){.amount = 0};
    point.position = affine_point(&to_world, at);
    point.density = glow_density(glow, volume, low, maps->stretch);
    if (medium->temperature)
        point.kelvin = volume_at(medium->temperature, affine_point(&maps->to_temperature, point.position));
    return point;
}

double glow_density(const Glow *glow, const Volume *volume, size_t brick, double stretch)
{
    int32_t first[3];
    brick_first(volume, brick, first);
    Vec3 size = brick_size(volume, first);
    double share = glow->shares[brick] - (brick ? glow->shares[brick - 1] : 0);
    return share / (size.x * size.y * size.z) * stretch;
}

/* ---- all of them ---- */

static bool any_vary(const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_media; i++)
        if (scene->media[i].density || scene->media[i].emits || scene->media[i].mixes) return true;
    return false;
}

Status media_find(const CompiledScene *compiled, WorldMedia *media, Error *error)
{
    const Scene *scene = compiled->scene;
    *media = (WorldMedia){.vary = any_vary(scene)};
    if (!media->vary) return STATUS_OK;
    media->varies = calloc(scene->n_media + 1U, sizeof *media->varies);
    media->mixing_state = calloc(scene->n_media + 1U, sizeof *media->mixing_state);
    if (!media->varies || !media->mixing_state) return fail_memory(error, scene->n_media, "media");
    for (uint32_t i = 0; i < scene->n_media; i++) {
        media->varies[i] = scene->media[i].density || scene->media[i].emits;
        media->mixing_state[i] = scene_mixing_state(&scene->media[i], i == 0);
    }
    TRY(find_places(compiled, media, error));
    return find_glows(compiled, media, error);
}

void media_clear(WorldMedia *media)
{
    for (uint32_t i = 0; i < media->n_glows; i++) free(media->glows[i].shares);
    free(media->varies);
    free(media->mixing_state);
    free(media->places);
    free(media->place_of_hull);
    free(media->glows);
    free(media->glow_of_place);
    *media = (WorldMedia){0};
}

/* media.c - where the volumes of media are, and what a temperature does to their light.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/world.h"

#include <stdlib.h>

/* ---- places ---- */

/* From a frame to a volume's lattice. The volume has these places in the frame while the shutter is open; NULL: it stands
 * still there. */
static Affine to_lattice_at(const Scene *scene, const Volume *volume, const Affine *keys, double time)
{
    Affine to_frame, to_own;
    if (!keys) return volume->to_lattice;
    to_frame = affine_between(keys, scene->n_keys, time);
    if (!affine_invert(&to_frame, &to_own)) return volume->to_lattice;
    Affine from_own = affine_compose(&volume->to_lattice, &keys[0]);
    return affine_compose(&from_own, &to_own);
}

/* With the frame that the volumes stand in; no object is flat. */
static MediumMaps maps_of(const Scene *scene, const MediumPlace *place, const Affine *frame_to_world, double time)
{
    MediumMaps maps = {.stretch = 1};
    const SceneMedium *medium = &scene->media[place->medium];
    Affine to_frame, to_lattice;
    if (!affine_invert(frame_to_world, &to_frame)) to_frame = affine_identity();
    if (medium->temperature) {
        to_lattice = to_lattice_at(scene, medium->temperature, place->temperature_keys, time);
        maps.to_temperature = affine_compose(&to_lattice, &to_frame);
    }
    if (!medium->density && !place->has_cells) return maps;
    to_lattice = medium->density ? to_lattice_at(scene, medium->density, place->density_keys, time) : place->to_cells;
    maps.to_density = affine_compose(&to_lattice, &to_frame);
    maps.stretch = fabs(affine_determinant(&maps.to_density));
    return maps;
}

/* Cells over the box around a hull that shines without a grid, nearly cubes. */
static void make_cells(const CompiledScene *compiled, MediumPlace *place, const Affine *frame_to_world)
{
    const double many = 512, most = 64;
    const SceneMedium *medium = &compiled->scene->media[place->medium];
    Affine to_frame;
    if (!medium->emits || medium->density || place->hull == NEST_WORLD || compiled->unbounded[place->hull] ||
        !affine_invert(frame_to_world, &to_frame))
        return;
    Box3 box = affine_box(&to_frame, compiled->hull_bounds[place->hull]);
    Vec3 size = vec3_sub(box.max, box.min);
    double edge = cbrt(size.x * size.y * size.z / many), extent[3] = {size.x, size.y, size.z}, scale[3];
    if (!(edge > 0) || !isfinite(edge)) return;
    for (int axis = 0; axis < 3; axis++) {
        place->n_cells[axis] = (int32_t)fmin(fmax(rint(extent[axis] / edge), 1), most);
        scale[axis] = place->n_cells[axis] / extent[axis];
    }
    place->to_cells = affine_identity();
    for (int axis = 0; axis < 3; axis++) place->to_cells.m[axis][axis] = scale[axis];
    place->to_cells.t = vec3(-box.min.x * scale[0], -box.min.y * scale[1], -box.min.z * scale[2]);
    place->has_cells = true;
}

static const Affine *volume_keys(const Scene *scene, const Volume *volume)
{
    uint32_t row = scene_volume_row(scene, volume);
    return row == SCENE_NONE ? NULL : scene_motion(scene, scene->volume_places[row].motion);
}

static void place_medium(const Scene *scene, MediumPlace *place)
{
    const SceneMedium *medium = &scene->media[place->medium];
    place->density_keys = volume_keys(scene, medium->density);
    place->temperature_keys = volume_keys(scene, medium->temperature);
    place->moves = place->keys || place->density_keys || place->temperature_keys;
    place->maps = maps_of(scene, place, &place->frame_to_world, 0);
}

static MediumPlace place_of_frame(const CompiledScene *compiled, const SceneFrame *frame)
{
    const Scene *scene = compiled->scene;
    MediumPlace place = {.hull = compiled->hull_of_object[frame->object],
                         .medium = scene->objects[frame->object].medium,
                         .keys = scene_motion(scene, frame->motion),
                         .frame_to_world = frame->to_world};
    make_cells(compiled, &place, &frame->to_world);
    place_medium(scene, &place);
    return place;
}

static Status find_places(const CompiledScene *compiled, WorldMedia *media, Error *error)
{
    const Scene *scene = compiled->scene;
    size_t n_hulls = compiled->n_hulls;
    media->places = calloc(scene->n_frames + n_hulls + 1U, sizeof *media->places);
    media->place_of_hull = malloc((n_hulls + 1) * sizeof *media->place_of_hull);
    if (!media->places || !media->place_of_hull) return fail_memory(error, n_hulls * sizeof(uint32_t), "media");
    for (size_t h = 0; h <= n_hulls; h++) media->place_of_hull[h] = SCENE_NONE;
    for (uint32_t i = 0; i < scene->n_frames; i++) {
        MediumPlace *place = &media->places[media->n_places];
        *place = place_of_frame(compiled, &scene->frames[i]);
        media->place_of_hull[place->hull] = media->n_places++;
    }
    for (uint32_t h = 0; h < n_hulls; h++) { /* what shines without a volume, its frame being its own or the world's */
        const SceneObject *object = &scene->objects[compiled->object_of_hull[h]];
        if (!scene->media[compiled->hulls[h].medium].emits || media->place_of_hull[h] != SCENE_NONE) continue;
        SceneFrame frame = {compiled->object_of_hull[h], object->motion, affine_identity()};
        if (scene_keys(scene, object)) frame.to_world = object->to_world;
        MediumPlace place = place_of_frame(compiled, &frame);
        if (!place.has_cells) continue;
        media->places[media->n_places] = place;
        media->place_of_hull[h] = media->n_places++;
    }
    if (scene->media[0].density || scene->media[0].temperature) {
        MediumPlace *place = &media->places[media->n_places];
        *place = (MediumPlace){.hull = NEST_WORLD, .frame_to_world = affine_identity()};
        place_medium(scene, place);
        media->place_of_hull[n_hulls] = media->n_places++;
    }
    return STATUS_OK;
}

bool media_is_there(const CompiledScene *compiled, const WorldMedia *media, const MediumPlace *place,
                    const NestList *list)
{
    const NestOrder *order = &compiled->order;
    if (place->hull == NEST_WORLD || !nest_mixes(order, place->hull)) return nest_owner(order, list) == place->hull;
    const NestState *state = media->mixing_state;
    return nest_has(order, list, place->hull) && state[place->medium] == state[nest_medium(list)];
}

const MediumMaps *media_maps(const Scene *scene, const MediumPlace *place, double time, MediumMaps *room)
{
    if (!place->moves) return &place->maps;
    Affine to_world;
    *room = maps_of(scene, place, scene_place_at(scene, place->keys, &place->frame_to_world, time, &to_world), time);
    return room;
}

const Affine *media_from_density(const MediumPlace *place, const MediumMaps *maps, Affine *room)
{
    if (maps == &place->maps) return place->has_inverse ? &place->from_density : NULL;
    return affine_invert(&maps->to_density, room) ? room : NULL;
}

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
    for (uint32_t i = 0; i < media->n_places; i++) {
        MediumPlace *place = &media->places[i];
        place->has_inverse = affine_invert(&place->maps.to_density, &place->from_density);
    }
    return glows_find(compiled, media, error);
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

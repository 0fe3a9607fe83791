/* photon_targets.c - boxes around all that bends or mirrors light, for photons to be sent to, and the lamps that shine into a cone.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/photon.h"

#include <stdlib.h>

#include "base/array.h"
#include "optics/color.h"
#include "trace/path_parts.h"
#include "trace/photon_sea.h"

/* Whether light is bent at its surface; the media around are not known yet, so that the world's stands for them. */
static bool bends(const World *world, uint32_t medium)
{
    const Lanes nm = lanes(430, 500, 580, 660);
    Lanes difference = lanes_sub(medium_ior(world, medium, nm), medium_ior(world, 0, nm));
    for (int i = 0; i < LANES; i++)
        if (fabsf(lanes_get(difference, i)) > 1e-4f) return true;
    return false;
}

/* Whether a surface, or a part of what it is a mix of, sends on light as a mirror does. */
static bool surface_mirrors(const Scene *scene, uint32_t number)
{
    const float smooth = 0.25f;
    const SceneSurface *surface = &scene->surfaces[number];
    const BsdfSpec *spec = &surface->spec;
    if (surface->mixed) return surface_mirrors(scene, surface->mix[0]) || surface_mirrors(scene, surface->mix[1]);
    return surface->finished && (spec->base_metalness > 0 || spec->transmission_weight > 0) &&
           spec->specular_roughness <= smooth;
}

static bool mirrors(const World *world, const SceneObject *object)
{
    return object->surface != SCENE_NONE && object->light == SCENE_NONE &&
           surface_mirrors(world->scene, object->surface);
}

/* Whether an object is clear, bends light and has no end. */
static bool is_sea(const World *world, uint32_t number)
{
    const CompiledScene *compiled = world->compiled;
    const SceneObject *object = &world->scene->objects[number];
    uint32_t hull = compiled->hull_of_object[number];
    return object->part_of == SCENE_NONE && object->medium != SCENE_NONE && hull < compiled->n_hulls &&
           compiled->unbounded[hull] && bends(world, object->medium);
}

/* The box of an object that photons should be sent to; false: none. seas: of objects, those that have tiles; NULL: none. */
static bool target_of(const World *world, const bool *seas, uint32_t number, Box3 *box)
{
    const CompiledScene *compiled = world->compiled;
    const SceneObject *object = &world->scene->objects[number];
    if (object->part_of != SCENE_NONE || (seas && seas[number])) return false;
    uint32_t hull = compiled->hull_of_object[number];
    if (object->medium != SCENE_NONE) {
        if (hull == SCENE_NONE || hull >= compiled->n_hulls || !bends(world, object->medium)) return false;
        *box = compiled->found_bounds[hull];
    } else {
        if (!mirrors(world, object)) return false;
        *box = scene_object_bounds(world->scene, object, NULL);
    }
    return !box3_is_empty(*box) && !box3_is_unbounded(*box);
}

static double box_area(Box3 box)
{
    Vec3 size = vec3_sub(box.max, box.min);
    return 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
}

/* A little more than what is in it, so that no surface lies in a face. */
static Box3 loosened(Box3 box)
{
    Vec3 slack = vec3_scale(vec3_sub(box.max, box.min), 1e-3);
    return (Box3){vec3_sub(box.min, slack), vec3_add(box.max, slack)};
}

/* Two boxes become one where that is no larger than both. */
static void join_boxes(PhotonTargets *targets)
{
    for (uint32_t a = 0; a < targets->n; a++)
        for (uint32_t b = a + 1; b < targets->n; b++) {
            Box3 both = box3_union(targets->boxes[a], targets->boxes[b]);
            if (box_area(both) > box_area(targets->boxes[a]) + box_area(targets->boxes[b])) continue;
            targets->boxes[a] = both;
            targets->boxes[b] = targets->boxes[--targets->n];
            b = a; /* the larger box may now join with others, looked at before too */
        }
}

/* Of many objects, one box for those whose centres are in the same of 4 x 4 x 4 parts of what they take up. */
static void join_by_place(const World *world, const bool *seas, Box3 all, PhotonTargets *targets)
{
    enum { PARTS = 4 };
    Box3 cells[PARTS * PARTS * PARTS], box;
    Vec3 size = vec3_sub(all.max, all.min);
    for (int i = 0; i < PARTS * PARTS * PARTS; i++) cells[i] = box3_empty();
    for (uint32_t i = 0; i < world->scene->n_objects; i++) {
        if (!target_of(world, seas, i, &box)) continue;
        Vec3 centre = vec3_sub(vec3_scale(vec3_add(box.min, box.max), 0.5), all.min);
        double along[3] = {centre.x, centre.y, centre.z}, sizes[3] = {size.x, size.y, size.z};
        int cell = 0;
        for (int axis = 0; axis < 3; axis++) {
            double part = sizes[axis] > 0 ? floor(along[axis] / sizes[axis] * PARTS) : 0;
            cell = PARTS * cell + (part > 0 ? (part < PARTS ? (int)part : PARTS - 1) : 0);
        }
        cells[cell] = box3_union(cells[cell], box);
    }
    targets->n = 0;
    for (int i = 0; i < PARTS * PARTS * PARTS; i++)
        if (!box3_is_empty(cells[i])) targets->boxes[targets->n++] = cells[i];
}

static Status find_lamps(const World *world, PhotonTargets *targets, Error *error)
{
    size_t capacity = 0;
    double sum = 0;
    for (uint32_t i = 0; i < world->emitters.n; i++) {
        const double extent = light_send_extent(world, i);
        if (!(extent > 0)) continue;
        double power = extent * spectrum_luminance(&light_of_emitter(world, i)->radiance);
        if (!(power > 0)) continue;
        sum += power;
        if (!array_reserve(&targets->lamps, &capacity, targets->n_lamps + 1, sizeof *targets->lamps))
            return fail_memory(error, (targets->n_lamps + 1) * sizeof *targets->lamps, "photons");
        targets->lamps[targets->n_lamps++] = (PhotonLamp){i, sum};
    }
    return STATUS_OK;
}

void photon_targets_clear(PhotonTargets *targets)
{
    free(targets->lamps);
}

/* Boxes of all but the seas that have tiles. */
static void find_boxes(const World *world, const bool *seas, PhotonTargets *targets)
{
    Box3 all = box3_empty(), box;
    bool many = false;
    for (uint32_t i = 0; i < world->scene->n_objects; i++) {
        if (!target_of(world, seas, i, &box)) continue;
        all = box3_union(all, box);
        many |= targets->n == PHOTON_TARGETS;
        if (!many) targets->boxes[targets->n++] = box;
    }
    if (many) join_by_place(world, seas, all, targets);
    join_boxes(targets);
    for (uint32_t i = 0; i < targets->n; i++) targets->boxes[i] = loosened(targets->boxes[i]);
}

/* By area; but tiles get photons by their part of these. Other boxes, which the camera may look at from near by, get them denser
 * than a sea, up to half of all; but not so dense that where they land they would be taken for all light that comes there. */
static void share_out(const PhotonTile *tiles, PhotonTargets *targets)
{
    const double densest = 24;
    double of_boxes = 0, of_tiles = 0, sum = 0;
    uint32_t n_boxes = targets->n - targets->n_tiles;
    for (uint32_t i = 0; i < targets->n; i++) {
        targets->more[i] = i < n_boxes ? 0 : tiles[i - n_boxes].more;
        *(i < n_boxes ? &of_boxes : &of_tiles) += box_area(targets->boxes[i]) / (1 + targets->more[i]);
    }
    double denser = 1;
    if (n_boxes && of_boxes < of_tiles) denser = fmin(0.5 * (of_boxes + of_tiles) / of_boxes, densest);
    double left = of_boxes + of_tiles - denser * of_boxes;
    for (uint32_t i = 0; i < targets->n; i++) {
        double area = box_area(targets->boxes[i]);
        targets->density[i] = i < n_boxes ? denser : left * tiles[i - n_boxes].part / area;
        sum += area * targets->density[i];
        targets->cumulative[i] = sum;
    }
}

/* Marks the objects of a scene that are a sea; false: there is none. Without one that has no end it is the largest wide object, and
 * all targets in its box. */
static bool find_sea(const World *world, bool *objects, PhotonSea *sea)
{
    const Scene *scene = world->scene;
    bool any = false;
    double largest = 0;
    Box3 box;
    *sea = (PhotonSea){objects, box3_empty()};
    for (uint32_t i = 0; i < scene->n_objects; i++) any |= objects[i] = is_sea(world, i);
    if (any) return true;
    for (uint32_t i = 0; i < scene->n_objects; i++)
        if (scene->objects[i].medium != SCENE_NONE && target_of(world, NULL, i, &box) && photon_is_wide(box) &&
            box_area(box) > largest) {
            largest = box_area(box);
            sea->bounds = loosened(box);
        }
    if (!(largest > 0)) return false;
    for (uint32_t i = 0; i < scene->n_objects; i++)
        objects[i] = target_of(world, NULL, i, &box) && box3_holds(sea->bounds, box);
    return true;
}

Status photon_targets(const World *world, PhotonTargets *targets, Error *error)
{
    PhotonTile tiles[PHOTON_TILES];
    PhotonSea sea;
    Status status = STATUS_OK;
    *targets = (PhotonTargets){.n = 0};
    bool *seas = calloc(world->scene->n_objects + 1U, sizeof *seas);
    if (!seas) return fail_memory(error, world->scene->n_objects, "photons");
    if (find_sea(world, seas, &sea))
        status = photon_sea_tiles(world, &sea, tiles, &targets->n_tiles, &targets->up, error);
    find_boxes(world, targets->n_tiles ? seas : NULL, targets);
    free(seas);
    for (uint32_t i = 0; i < targets->n_tiles; i++) targets->boxes[targets->n++] = tiles[i].box;
    share_out(tiles, targets);
    if (status == STATUS_OK) status = find_lamps(world, targets, error);
    if (status != STATUS_OK) photon_targets_clear(targets);
    return status;
}

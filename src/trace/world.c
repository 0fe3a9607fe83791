/* world.c - which lights there are, how often each is tried, and what surrounds the camera.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/beam_ways.h"
#include "trace/beams.h"
#include "trace/world.h"

#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "scene/ties.h"
#include "trace/backdrop.h"
#include "trace/light_reach.h"

/* What a distant light, or LIGHT_ENVIRONMENT, brings to the scene: by the circle around that. */
static double far_power(const World *world, uint32_t number)
{
    const Scene *scene = world->scene;
    Box3 bounds = rtc_scene_bounds(world->compiled->rtc);
    double radius = box3_is_empty(bounds) ? 1 : 0.5 * vec3_length(vec3_sub(bounds.max, bounds.min));
    double circle = MEN_PI * radius * radius;
    if (number == LIGHT_ENVIRONMENT) return (double)environment_power(scene->environment) * circle;
    const SceneLight *light = &scene->lights[number];
    return fmax(spectrum_luminance(&light->radiance), 0) * 2 * MEN_PI * (1 - light->cos_angle) * circle;
}

static void add_choice(LightChoices *choices, uint32_t light, double power, double *total)
{
    if (!(power > 0)) return;
    choices->items[choices->n++] = (LightChoice){.light = light, .probability = (float)power};
    *total += power;
}

/* Whether light is looked for in the environment's direction. One that is the same everywhere is found best by the
 * directions in which surfaces scatter: every one of them that leaves the scene comes to it, and with just the weight that
 * the surface gives it. Portals say where else to look. */
static bool seeks_environment(const Scene *scene)
{
    if (!scene->environment || environment_is_black(scene->environment)) return false;
    return environment_width(scene->environment) > 0 || scene_has_portal(scene);
}

/* Half of the samples by flux onto the scene, half evenly by the number of lights, so that a small light near a surface
 * is not starved. reach: the kinds to choose from. */
static Status choose_lights(World *world, unsigned reach, Error *error)
{
    const Scene *scene = world->scene;
    LightChoices *choices = &world->choices[reach];
    double total = 0;
    choices->items = calloc(scene->n_lights + 2U, sizeof *choices->items);
    choices->of_light = calloc(scene->n_lights + 1U, sizeof *choices->of_light);
    if (!choices->items || !choices->of_light)
        return fail_memory(error, scene->n_lights * sizeof *choices->items, "lights");
    if (reach & REACH_NEAR) add_choice(choices, LIGHT_NEAR, light_tree_power(world->emitters.tree), &total);
    for (uint32_t i = 0; i < scene->n_lights && reach & REACH_FAR; i++)
        if (scene->lights[i].kind == LIGHT_DISTANT) add_choice(choices, i, far_power(world, i), &total);
    if (reach & REACH_FAR && seeks_environment(scene))
        add_choice(choices, LIGHT_ENVIRONMENT, far_power(world, LIGHT_ENVIRONMENT), &total);
    uint32_t n_near = reach & REACH_NEAR ? world->emitters.n_sources : 0, n_sources = choices->n;
    if (n_near) n_sources += n_near - 1;
    double cumulative = 0;
    for (uint32_t i = 0; i < choices->n; i++) {
        LightChoice *choice = &choices->items[i];
        double sources = choice->light == LIGHT_NEAR ? n_near : 1;
        double probability = 0.5 * (double)choice->probability / total + 0.5 * sources / n_sources;
        choice->probability = (float)probability;
        cumulative += probability;
        choice->cumulative = (float)cumulative;
        if (choice->light == LIGHT_ENVIRONMENT)
            choices->environment = choice->probability;
        else if (choice->light == LIGHT_NEAR)
            choices->near = choice->probability;
        else
            choices->of_light[choice->light] = choice->probability;
    }
    return STATUS_OK;
}

enum { MOST_PORTAL_MAPS = 256 };

/* Whether a portal's frame is turned as one before it: then it has that one's map. */
static const PortalMap *map_of_like(const World *world, const WorldPortal *portal)
{
    for (uint32_t i = 0; i < world->n_portals; i++)
        if (memcmp(world->portals[i].to_frame.m, portal->to_frame.m, sizeof portal->to_frame.m) == 0)
            return world->portals[i].map;
    return NULL;
}

static Status add_portal(World *world, const SceneLight *light, Error *error)
{
    WorldPortal portal = {.light = light};
    if (!affine_invert(&light->to_world, &portal.to_frame)) return STATUS_OK; /* it is rigid */
    portal.map = map_of_like(world, &portal);
    if (!portal.map) {
        if (world->n_portal_maps == MOST_PORTAL_MAPS)
            return fail(error, STATUS_RENDER, "portals face more than %d different ways; each way takes 0.8 MB",
                        MOST_PORTAL_MAPS);
        Affine to_environment = affine_compose(&world->scene->world_to_environment, &light->to_world);
        PortalMap **map = &world->portal_maps[world->n_portal_maps];
        TRY(portal_map_new(world->scene->environment, &to_environment, map, error));
        portal.map = *map;
        world->n_portal_maps++;
    }
    world->portals[world->n_portals++] = portal;
    return STATUS_OK;
}

/* A portal stays where it is as the shutter opens: it says where to look for light, and light is found elsewhere, too. */
static Status find_portals(World *world, Error *error)
{
    const Scene *scene = world->scene;
    uint32_t n = 0;
    if (!scene->environment || environment_is_black(scene->environment)) return STATUS_OK;
    for (uint32_t i = 0; i < scene->n_lights; i++) n += scene->lights[i].kind == LIGHT_PORTAL;
    if (!n) return STATUS_OK;
    world->portals = calloc(n, sizeof *world->portals);
    world->portal_maps = calloc(n, sizeof *world->portal_maps);
    if (!world->portals || !world->portal_maps) return fail_memory(error, n * sizeof *world->portals, "portals");
    for (uint32_t i = 0; i < scene->n_lights; i++)
        if (scene->lights[i].kind == LIGHT_PORTAL) TRY(add_portal(world, &scene->lights[i], error));
    return STATUS_OK;
}

/* Whether there is nothing to choose among: not even a way to the environment, or a place in a medium that shines. */
static bool is_one_light(const World *world, const LightChoices *choices)
{
    const EmitterSet *near = &world->emitters;
    if (choices->n != 1) return false;
    if (choices->items[0].light == LIGHT_NEAR) return near->n == 1 && near->emitters[0].kind != EMITTER_GLOW;
    return choices->items[0].light != LIGHT_ENVIRONMENT || !world->n_portals;
}

/* Around all that an object has surfaces of that are passed, at any time of the shutter; of one without end, a part of that. Those
 * of operands reach beyond their combination, and lists tell of them there, too. */
static Box3 passed_bounds(const World *world, uint32_t object)
{
    uint32_t pass = world->compiled->hull_of_object[object];
    if (pass < world->compiled->n_hulls) return world->compiled->hull_bounds[pass];
    return scene_object_bounds(world->scene, &world->scene->objects[object], NULL);
}

/* Whether the hulls around the camera may be others at another time: it moves itself, or something that moves comes to
 * where it is. */
static bool camera_list_may_move(const World *world)
{
    const CompiledScene *compiled = world->compiled;
    if (world->camera.keys) return true;
    for (uint32_t i = 0; i < world->scene->n_objects; i++) {
        const SceneObject *object = &world->scene->objects[i];
        uint32_t hull = compiled->hull_of_object[i];
        if (hull == SCENE_NONE || object->shape == SCENE_NONE) continue;
        if (object->motion == SCENE_NONE && !world->scene->shapes[object->shape].mesh_end) continue;
        if (box3_holds_point(passed_bounds(world, i), world->camera.from)) return true;
    }
    return false;
}

static bool comes_near(Box3 box, Box3 places, double distance)
{
    Vec3 below = vec3_sub(places.min, box.max), above = vec3_sub(box.min, places.max);
    return vec3_length(vec3(fmax(fmax(below.x, above.x), 0), fmax(fmax(below.y, above.y), 0),
                            fmax(fmax(below.z, above.z), 0))) <= distance;
}

/* Whether a box reaches into the plane that an orthographic camera stands in: a film may be of any height. */
static bool reaches_into_plane(Box3 box, const SceneCamera *camera)
{
    Vec3 half = vec3_scale(vec3_sub(box.max, box.min), 0.5), f = camera->forward;
    double reach = fabs(f.x) * half.x + fabs(f.y) * half.y + fabs(f.z) * half.z;
    double rounding = rtc_rounding(box.min) + rtc_rounding(box.max) + rtc_rounding(camera->from);
    return fabs(vec3_dot(vec3_sub(box3_centre(box), camera->from), f)) <= reach + rounding;
}

/* Whether a surface that is passed may lie between the camera's centre and a point of its lens, or of its picture plane. */
static bool lens_may_cross(const World *world)
{
    const CompiledScene *compiled = world->compiled;
    const SceneCamera *camera = &world->camera;
    bool orthographic = camera->projection == PROJECTION_ORTHOGRAPHIC;
    Box3 places = box3_add_point(box3_empty(), camera->from);
    if (!orthographic && !(camera->lens_radius > 0)) return false;
    for (uint32_t k = 0; camera->keys && k < world->scene->n_keys; k++)
        places = box3_add_point(places, camera->keys[k].from);
    for (uint32_t i = 0; i < world->scene->n_objects; i++) {
        uint32_t pass = compiled->hull_of_object[i];
        if (pass == SCENE_NONE || world->scene->objects[i].shape == SCENE_NONE) continue;
        if (orthographic && (compiled->unbounded[pass] || camera->keys)) return true;
        Box3 box = passed_bounds(world, i);
        if (orthographic ? reaches_into_plane(box, camera) : comes_near(box, places, camera->lens_reach * 1.0001))
            return true;
    }
    return false;
}

/* Whether lines of the spectrum are a part of the scene's light, of all that shines in it. Lights, surfaces and media are in the order
 * of EmitterSet.powers. */
static Status find_lines(World *world, Error *error)
{
    const Scene *scene = world->scene;
    const double *powers = world->emitters.powers;
    size_t n = (size_t)scene->n_lights + scene->n_surfaces + scene->n_media, k = 0;
    LightOfScene *lights = malloc((n + 1) * sizeof *lights);
    if (!lights) return fail_memory(error, n * sizeof *lights, "the spectra of lights");
    for (uint32_t i = 0; i < scene->n_lights; i++, k++) {
        double far = scene->lights[i].kind == LIGHT_DISTANT ? far_power(world, i) : 0;
        lights[k] = (LightOfScene){&scene->lights[i].radiance, powers[k] + far};
    }
    for (uint32_t i = 0; i < scene->n_surfaces; i++, k++) {
        const SceneSurface *surface = &scene->surfaces[i];
        bool even = surface->emission_texture == SCENE_NONE;
        lights[k] = (LightOfScene){even ? &surface->emission : NULL, powers[k]};
    }
    for (uint32_t i = 0; i < scene->n_media; i++, k++) {
        const SceneMedium *medium = &scene->media[i];
        lights[k] = (LightOfScene){medium->temperature ? NULL : &medium->emission, powers[k]};
    }
    lights[k] = (LightOfScene){NULL, 0};
    if (scene->environment)
        lights[k] = (LightOfScene){environment_light(scene->environment), far_power(world, LIGHT_ENVIRONMENT)};
    Status status = wavelength_lines_new(lights, n + 1, &world->lines, error);
    free(lights);
    return status;
}

/* What is brighter than its backdrop, which is seen by paths that take it to be as bright as the mean. */
static Status find_beacons(World *world, Error *error)
{
    double backdrop = 1;
    beacons_find(world->compiled, backdrop, &world->beacons);
    if (!world->beacons.any) return STATUS_OK;
    TRY(backdrop_find(world, &backdrop, error));
    if (backdrop < 1) beacons_find(world->compiled, backdrop, &world->beacons);
    return STATUS_OK;
}

/* What shines, and how often each of it is tried. Emitters come first, as all else asks what they are. */
static Status init_lights(World *world, Pool *pool, Error *error)
{
    TRY(emitters_find(world, pool, &world->emitters, error));
    TRY(ties_find_yielding(world->scene, &world->yields, error));
    for (unsigned reach = 0; reach < REACHES; reach++) TRY(choose_lights(world, reach, error));
    TRY(slabs_find(world->compiled, &world->slabs, error));
    TRY(beams_find(world, error));
    TRY(light_reach_find(world, error));
    TRY(find_portals(world, error));
    for (unsigned reach = 0; reach < REACHES; reach++)
        world->choices[reach].one = is_one_light(world, &world->choices[reach]);
    return find_lines(world, error);
}

/* What there is at all in the scene, so that paths need not ask for what there is not. Lights are known. */
static void note_traits(World *world)
{
    const Scene *scene = world->scene;
    world->moves = scene->n_keys > 0;
    for (uint32_t i = 0; i < scene->n_lights; i++) world->has_distant |= scene->lights[i].kind == LIGHT_DISTANT;
    for (uint32_t i = 0; i < scene->n_media; i++) {
        world->scatters |= scene->media[i].scatters;
        world->disperses |= world_medium_disperses(world, i);
    }
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        world->has_panes |= scene_is_pane(scene, i);
        world->has_paint |= scene_is_painted(scene, i);
        world->has_parts |= world->looks[i].thing != world->looks[world->looks[i].whole].thing;
    }
    world->seeks_airlight = world->scatters && world_lights(world)->n;
}

/* What surrounds the camera, and its lens. It is known whether anything moves. */
static Status stand_camera(World *world, Error *error)
{
    TRY(compiled_stand(world->compiled, &world->camera, &world->camera_list, NULL, error));
    world->camera_list_moves = world->moves && camera_list_may_move(world);
    world->lens_crosses = lens_may_cross(world);
    if (world->lens_crosses && !world->moves) TRY(lens_new(world->compiled, &world->camera, &world->lens, error));
    return STATUS_OK;
}

/* Beams' ways and beacons come last: to find them, paths are traced in the world, which has to be complete but for these. */
static Status init_parts(World *world, uint32_t camera, Pool *pool, Error *error)
{
    const bool looks = world->scene->n_cameras > 0; /* else no picture is made, and rays begin anywhere */
    if (looks && camera >= world->scene->n_cameras)
        return fail(error, STATUS_RENDER, "the scene has no camera number %u", camera + 1);
    if (looks) world->camera = world->scene->cameras[camera];
    TRY(media_find(world->compiled, &world->media, error));
    TRY(looks_find(world->scene, &world->looks, error));
    TRY(balances_new(world->scene, &world->balances, error));
    TRY(init_lights(world, pool, error));
    note_traits(world);
    if (looks) TRY(stand_camera(world, error));
    reflected_color_init(&world->reflected);
    TRY(beam_ways_find(world, error));
    return find_beacons(world, error);
}

Status world_init(World *world, const CompiledScene *compiled, uint32_t camera, uint32_t max_bounces,
                  bool no_absorption, Pool *pool, Error *error)
{
    *world = (World){.compiled = compiled,
                     .scene = compiled->scene,
                     .no_absorption = no_absorption,
                     .max_bounces = max_bounces,
                     .width = compiled->scene->film.width,
                     .height = compiled->scene->film.height};
    nest_list_init(&world->camera_list);
    Status status = init_parts(world, camera, pool, error);
    if (status != STATUS_OK) world_clear(world);
    return status;
}

Status world_find_mesh_boxes(World *world, Error *error)
{
    const Scene *scene = world->scene;
    size_t size = (size_t)scene->n_shapes * sizeof *world->mesh_boxes;
    world->mesh_boxes = malloc(size ? size : 1);
    if (!world->mesh_boxes) return fail_memory(error, size, "the boxes around meshes");
    for (uint32_t i = 0; i < scene->n_shapes; i++) {
        const Mesh *mesh = scene->shapes[i].mesh;
        world->mesh_boxes[i] = mesh && !mesh->uvs ? mesh_bounds(mesh) : box3_empty();
    }
    return STATUS_OK;
}

void world_leave_to_chance(World *world)
{
    world->seeks_airlight = false;
    world->n_beam_ways = 0;
    for (unsigned reach = 0; reach < REACHES; reach++) {
        LightChoices *choices = &world->choices[reach];
        choices->n = 0;
        choices->near = choices->environment = 0;
        for (uint32_t i = 0; i < world->scene->n_lights; i++) choices->of_light[i] = 0;
    }
}

void world_clear(World *world)
{
    emitters_clear(&world->emitters);
    free(world->yields);
    for (uint32_t i = 0; i < world->n_portal_maps; i++) portal_map_free(world->portal_maps[i]);
    free(world->portal_maps);
    free(world->portals);
    media_clear(&world->media);
    slabs_clear(&world->slabs);
    free(world->beams);
    free(world->beam_looks);
    free(world->beam_ways);
    balances_free(world->balances);
    lens_free(world->lens);
    wavelength_lines_free(world->lines);
    for (unsigned reach = 0; reach < REACHES; reach++) {
        free(world->choices[reach].items);
        free(world->choices[reach].of_light);
    }
    free(world->reach);
    free(world->reach_through);
    free(world->mesh_boxes);
    free(world->looks);
    nest_list_clear(&world->camera_list);
    *world = (World){0};
    nest_list_init(&world->camera_list);
}

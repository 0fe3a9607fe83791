/* world.c - which lights there are, how often each is tried, and what surrounds the camera.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/world.h"

#include <stdlib.h>

/* Flux of a light onto the scene, roughly: enough to divide the samples between the lights. */
static double light_power(const SceneLight *light, double radius)
{
    double rgb[3];
    color_from_spectrum(&light->radiance, rgb);
    float rgb_float[3] = {(float)rgb[0], (float)rgb[1], (float)rgb[2]};
    double luminance = fmax((double)color_luminance(rgb_float), 0), pi = acos(-1);
    switch (light->kind) {
    case LIGHT_RECT: return luminance * pi * 4 * light->half_width * light->half_height;
    case LIGHT_DISC: return luminance * pi * pi * light->half_width * light->half_width;
    case LIGHT_SPHERE: return luminance * pi * 4 * pi * light->half_width * light->half_width;
    case LIGHT_DISTANT: return luminance * 2 * pi * (1 - light->cos_angle) * pi * radius * radius;
    }
    return 0;
}

/* Half of the samples by flux, half evenly, so that a small light near a surface is not starved. */
static Status choose_lights(World *world, Error *error)
{
    const Scene *scene = world->scene;
    Box3 bounds = rtc_scene_bounds(world->compiled->rtc);
    double radius = box3_is_empty(bounds) ? 1 : 0.5 * vec3_length(vec3_sub(bounds.max, bounds.min));
    world->choices = calloc(scene->n_lights + 1U, sizeof *world->choices);
    world->choice_of_light = calloc(scene->n_lights + 1U, sizeof *world->choice_of_light);
    if (!world->choices || !world->choice_of_light)
        return fail_memory(error, scene->n_lights * sizeof *world->choices, "lights");
    double total = 0;
    for (uint32_t i = 0; i < scene->n_lights; i++) {
        double power = light_power(&scene->lights[i], radius);
        if (!(power > 0)) continue;
        world->choices[world->n_choices++] = (LightChoice){.light = i, .probability = (float)power};
        total += power;
    }
    if (scene->environment && !environment_is_black(scene->environment)) {
        double power = (double)environment_power(scene->environment) * acos(-1) * radius * radius;
        world->choices[world->n_choices++] = (LightChoice){.light = LIGHT_ENVIRONMENT, .probability = (float)power};
        total += power;
    }
    double cumulative = 0;
    for (uint32_t i = 0; i < world->n_choices; i++) {
        LightChoice *choice = &world->choices[i];
        double probability = 0.5 * (double)choice->probability / total + 0.5 / world->n_choices;
        choice->probability = (float)probability;
        cumulative += probability;
        choice->cumulative = (float)cumulative;
        if (choice->light == LIGHT_ENVIRONMENT)
            world->environment_choice = choice->probability;
        else
            world->choice_of_light[choice->light] = choice->probability;
    }
    return STATUS_OK;
}

/* Whether the hulls around the camera may be others at another time: it moves itself, or something that moves comes to
 * where it is. */
static bool camera_list_may_move(const World *world)
{
    const CompiledScene *compiled = world->compiled;
    Vec3 p = world->camera->from;
    if (world->camera->keys) return true;
    for (uint32_t i = 0; i < world->scene->n_objects; i++) {
        const SceneObject *object = &world->scene->objects[i];
        uint32_t hull = compiled_hull(compiled, i);
        if (hull == SCENE_NONE || object->shape == SCENE_NONE) continue;
        if (object->motion == SCENE_NONE && !world->scene->shapes[object->shape].mesh_end) continue;
        Box3 box = compiled->hull_bounds[hull];
        if (p.x >= box.min.x && p.x <= box.max.x && p.y >= box.min.y && p.y <= box.max.y && p.z >= box.min.z &&
            p.z <= box.max.z)
            return true;
    }
    return false;
}

/* Whether a surface of some hull may lie between the camera's centre and a point of its lens. */
static bool lens_may_cross(const World *world)
{
    const SceneCamera *camera = world->camera;
    if (!(camera->lens_radius > 0)) return false;
    for (uint32_t h = 0; h < world->compiled->n_hulls; h++) {
        Box3 box = world->compiled->hull_bounds[h];
        Vec3 nearest =
            vec3(fmin(fmax(camera->from.x, box.min.x), box.max.x), fmin(fmax(camera->from.y, box.min.y), box.max.y),
                 fmin(fmax(camera->from.z, box.min.z), box.max.z));
        if (vec3_length(vec3_sub(nearest, camera->from)) <= camera->lens_radius * 1.0001) return true;
    }
    return false;
}

Status world_init(World *world, const CompiledScene *compiled, uint32_t camera, uint32_t max_bounces,
                  bool no_absorption, Error *error)
{
    *world = (World){
        .compiled = compiled, .scene = compiled->scene, .no_absorption = no_absorption, .max_bounces = max_bounces};
    nest_list_init(&world->camera_list);
    if (camera >= compiled->scene->n_cameras)
        return fail(error, STATUS_RENDER, "the scene has no camera number %u", camera + 1);
    world->camera = &compiled->scene->cameras[camera];
    Status status = choose_lights(world, error);
    if (status == STATUS_OK) {
        HitList hits = {0};
        uint32_t on_surface;
        status =
            compiled_interior(compiled, vec3f_from(world->camera->from), 0, &hits, &world->camera_list, &on_surface);
        if (status != STATUS_OK) fail_memory(error, hits.capacity * sizeof(Hit), "the camera's surroundings");
        hit_list_clear(&hits);
        world->moves = world->scene->n_keys > 0;
        for (uint32_t i = 0; i < world->scene->n_media; i++) world->scatters |= world->scene->media[i].scatters;
        world->camera_list_moves = world->moves && camera_list_may_move(world);
        world->lens_crosses = lens_may_cross(world);
    }
    if (status != STATUS_OK) world_clear(world);
    return status;
}

void world_clear(World *world)
{
    free(world->choices);
    free(world->choice_of_light);
    nest_list_clear(&world->camera_list);
    *world = (World){0};
    nest_list_init(&world->camera_list);
}

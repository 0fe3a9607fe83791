/* beams.c - see beams.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/beams.h"

#include <stdlib.h>

/* Whether a lamp's cone may come to a ball: by the cone whose tip is so far behind the lamp that it holds all of its cones. */
static bool comes_to_ball(const SceneLight *light, Vec3 middle, double radius)
{
    const double cosine = light->cos_none, sine = sqrt(1 - cosine * cosine);
    Vec3 axis = vec3_normalize(affine_vector(&light->to_world, vec3(0, 1, 0)));
    double size = light_is_flat(light) ? hypot(light->half_width, light->half_height) : 0;
    Vec3 to = vec3_along(vec3_sub(middle, light->to_world.t), size * cosine / sine, axis);
    double distance = vec3_length(to);
    if (!(cosine > 0) || !(sine > 0) || distance <= radius) return true;
    double between = acos(fmin(fmax(vec3_dot(to, axis) / distance, -1), 1));
    return between <= acos(cosine) + asin(radius / distance) + 1e-6;
}

static bool comes_to_slab(const World *world, const SceneLight *light)
{
    bool comes = world->scene->n_keys > 0; /* it may move */
    for (uint32_t i = 0; i < world->slabs.n_boxes && !comes; i++) {
        Box3 box = world->slabs.boxes[i];
        comes = comes_to_ball(light, box3_centre(box), 0.5 * vec3_length(vec3_sub(box.max, box.min)));
    }
    return comes;
}

Status beams_find(World *world, Error *error)
{
    const EmitterSet *set = &world->emitters;
    world->n_beams = 0;
    if (!world->slabs.n_boxes || !set->n) return STATUS_OK;
    world->beams = malloc(set->n * sizeof *world->beams);
    if (!world->beams) return fail_memory(error, set->n * sizeof *world->beams, "lights");
    for (uint32_t i = 0; i < set->n; i++) {
        if (set->emitters[i].kind != EMITTER_LIGHT) continue;
        const SceneLight *light = &world->scene->lights[set->emitters[i].of];
        if ((light->kind == LIGHT_POINT || light_is_focused(light)) && comes_to_slab(world, light))
            world->beams[world->n_beams++] = i;
    }
    return STATUS_OK;
}

bool beams_have(const World *world, uint32_t emitter)
{
    uint32_t low = 0, high = world->n_beams; /* they are in order */
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (world->beams[middle] < emitter)
            low = middle + 1;
        else
            high = middle;
    }
    return low < world->n_beams && world->beams[low] == emitter;
}

uint32_t beams_sample(const World *world, double time, uint32_t digits, const float u[2], Vec3 *place, double *area)
{
    uint32_t emitter = world->beams[(uint64_t)digits * world->n_beams >> 32];
    *place = light_even_place(world, emitter, time, u, area);
    return emitter;
}

double beams_density(const World *world, uint32_t emitter, double time)
{
    const float any[2] = {0.5f, 0.5f};
    double area;
    light_even_place(world, emitter, time, any, &area);
    return 1 / ((area > 0 ? area : 1) * world->n_beams);
}

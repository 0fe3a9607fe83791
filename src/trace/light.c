/* light.c - sampling and evaluating light sources.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/light.h"

#include "optics/sampling.h"

/* Where a light is at a time of the shutter; room is for a light that moves. */
static const Affine *light_place(const World *world, const SceneLight *light, double time, Affine *room)
{
    if (light->object == RTC_NO_OBJECT) return &light->to_world;
    const Affine *keys = scene_keys(world->scene, &world->scene->objects[light->object]);
    if (!keys) return &light->to_world;
    *room = affine_between(keys, world->scene->n_keys, time);
    return room;
}

/* Of a quad or disc; also its unit normal. Between two places that it moves through it may be squeezed. */
static double light_area(const SceneLight *light, const Affine *to_world, Vec3 *normal)
{
    double area = light->kind == LIGHT_DISC ? (double)SAMPLING_PI * light->half_width * light->half_width
                                            : 4 * light->half_width * light->half_height;
    if (to_world == &light->to_world) { /* rigid */
        *normal = affine_vector(to_world, vec3(0, 1, 0));
        return area;
    }
    Vec3 across = vec3_cross(affine_vector(to_world, vec3(0, 0, 1)), affine_vector(to_world, vec3(1, 0, 0)));
    double stretch = vec3_length(across);
    *normal = vec3_scale(across, 1 / stretch);
    return area * stretch;
}

/* A point on an area light, and its normal there. Uniform in area; a sphere is sampled by its visible
 * cone instead (sample_sphere). */
static Vec3 area_point(const SceneLight *light, const Affine *to_world, const float u[2], Vec3 *normal, double *area)
{
    Vec3 local = vec3(0, 0, 0);
    if (light->kind == LIGHT_DISC) {
        float x, z;
        sampling_disc(u[0], u[1], &x, &z);
        local = vec3((double)x * light->half_width, 0, (double)z * light->half_width);
    } else {
        local = vec3((2 * (double)u[0] - 1) * light->half_width, 0, (2 * (double)u[1] - 1) * light->half_height);
    }
    *area = light_area(light, to_world, normal);
    return affine_point(to_world, local);
}

/* 1 - cos of the half angle under which a sphere is seen whose centre is `to` away; precise for far and small ones. 2
 * from inside. */
static double sphere_cone(const SceneLight *light, Vec3 to)
{
    double sine2 = light->half_width * light->half_width / vec3_dot(to, to);
    return sine2 < 1 ? sine2 / (1 + sqrt(1 - sine2)) : 2;
}

static LightSample sample_sphere(const SceneLight *light, const Affine *to_world, Vec3 from, const float u[2])
{
    Vec3 to = vec3_sub(to_world->t, from);
    double cone = sphere_cone(light, to);
    if (cone >= 2) return (LightSample){.pdf_w = 0}; /* from inside, the light's own surface is opaque */
    double distance = vec3_length(to);
    Vec3f direction = sampling_cone(u[0], u[1], vec3f_from(vec3_scale(to, 1 / distance)), (float)cone);
    return (LightSample){.direction = direction,
                         .distance = distance + light->half_width,
                         .object = light->object,
                         .pdf_w = sampling_cone_pdf((float)cone)};
}

static LightSample sample_area(const SceneLight *light, const Affine *to_world, Vec3 from, const float u[2])
{
    Vec3 normal;
    double area;
    Vec3 to = vec3_sub(area_point(light, to_world, u, &normal, &area), from);
    double distance = vec3_length(to), cosine = -vec3_dot(to, normal) / distance;
    if (!(cosine > 0)) return (LightSample){.pdf_w = 0};
    return (LightSample){.direction = vec3f_from(vec3_scale(to, 1 / distance)),
                         /* a little behind the light: it is the ray's target and does not block it */
                         .distance = distance * (1 + 1e-5),
                         .object = light->object,
                         .pdf_w = (float)(distance * distance / (cosine * area))};
}

static LightSample sample_distant(const SceneLight *light, const float u[2])
{
    double cone = 1 - light->cos_angle;
    return (LightSample){.direction = sampling_cone(u[0], u[1], vec3f_from(light->towards), (float)cone),
                         .distance = HUGE_VAL,
                         .object = RTC_NO_OBJECT,
                         .pdf_w = sampling_cone_pdf((float)cone)};
}

static Vec3f to_environment(const World *world, Vec3f direction)
{
    return vec3f_normalize(vec3f_from(affine_vector(&world->scene->world_to_environment, vec3_from_f(direction))));
}

static LightSample sample_environment(const World *world, const float u[2], Lanes wavelength_nm)
{
    LightSample sample = {.distance = HUGE_VAL, .object = RTC_NO_OBJECT};
    Vec3f local = environment_sample(world->scene->environment, u[0], u[1], &sample.pdf_w);
    sample.radiance = environment_radiance(world->scene->environment, local, wavelength_nm);
    /* the map is a rotation: its transpose is its inverse */
    sample.direction =
        vec3f_normalize(vec3f_from(affine_normal(&world->scene->world_to_environment, vec3_from_f(local))));
    return sample;
}

LightSample light_sample(const World *world, Vec3 from, double time, float choice, const float u[2],
                         Lanes wavelength_nm)
{
    if (!world->n_choices) return (LightSample){.pdf_w = 0};
    uint32_t i = 0; /* few lights: a walk; many will want a tree */
    while (i + 1 < world->n_choices && choice >= world->choices[i].cumulative) i++;
    const LightChoice *chosen = &world->choices[i];
    LightSample sample;
    if (chosen->light == LIGHT_ENVIRONMENT) {
        sample = sample_environment(world, u, wavelength_nm);
    } else {
        const SceneLight *light = &world->scene->lights[chosen->light];
        Affine room;
        const Affine *to_world = light_place(world, light, time, &room);
        if (light->kind == LIGHT_SPHERE)
            sample = sample_sphere(light, to_world, from, u);
        else if (light->kind == LIGHT_DISTANT)
            sample = sample_distant(light, u);
        else
            sample = sample_area(light, to_world, from, u);
        sample.radiance = spectrum_at(&light->radiance, wavelength_nm);
    }
    sample.pdf_w *= chosen->probability;
    return sample;
}

float light_pdf_hit(const World *world, uint32_t index, Vec3 from, const Ray *ray, const Hit *hit)
{
    const SceneLight *light = &world->scene->lights[index];
    float choice = world->choice_of_light[index];
    Affine room;
    const Affine *to_world = light_place(world, light, ray->time, &room);
    if (light->kind == LIGHT_SPHERE) {
        double cone = sphere_cone(light, vec3_sub(to_world->t, from));
        return cone < 2 ? choice * sampling_cone_pdf((float)cone) : 0;
    }
    if (!hit->entering) return 0;
    Vec3 normal;
    double area = light_area(light, to_world, &normal);
    Vec3 to = vec3_sub(ray_point(ray, hit->t), from);
    return choice * (float)(vec3_dot(to, to) / (fabs(hit->cos_normal) * area));
}

Lanes light_radiance_hit(const World *world, uint32_t index, const Hit *hit, Lanes wavelength_nm)
{
    return hit->entering ? spectrum_at(&world->scene->lights[index].radiance, wavelength_nm) : lanes_all(0);
}

static float weight_against(float weight_pdf, float light_pdf)
{
    return weight_pdf < 0 ? 1 : sampling_balance(weight_pdf, light_pdf);
}

Lanes light_from_infinity(const World *world, Vec3f direction, float weight_pdf, Lanes wavelength_nm)
{
    const Scene *scene = world->scene;
    Lanes sum = lanes_all(0);
    if (scene->environment) {
        Vec3f local = to_environment(world, direction);
        float pdf = weight_pdf < 0 ? 0 : world->environment_choice * environment_pdf(scene->environment, local);
        sum = lanes_scale(environment_radiance(scene->environment, local, wavelength_nm),
                          weight_against(weight_pdf, pdf));
    }
    for (uint32_t i = 0; i < scene->n_lights; i++) {
        const SceneLight *light = &scene->lights[i];
        if (light->kind != LIGHT_DISTANT || vec3_dot(vec3_from_f(direction), light->towards) < light->cos_angle)
            continue;
        float pdf = world->choice_of_light[i] * sampling_cone_pdf((float)(1 - light->cos_angle));
        sum =
            lanes_add(sum, lanes_scale(spectrum_at(&light->radiance, wavelength_nm), weight_against(weight_pdf, pdf)));
    }
    return sum;
}

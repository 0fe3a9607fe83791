/* light_outside.c - light from infinitely far: the environment, by its own brightness and through portals, and distant
 * lights.
 *
 * One sample for the environment is drawn in one of several ways, and counts by the density of all of them together, which
 * is the balance heuristic of one sample (E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997,
 * 9.2.4). So light is counted once, wherever portals are, and whether or not light comes through them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/sampling.h"
#include "trace/light.h"

/* Where portals are seen, so many samples still go by the environment alone: for a place in the open that has a portal
 * before it all the same. */
static const double without_portals = 0.15;

static Vec3f to_environment(const World *world, Vec3f direction)
{
    return vec3f_normalize(vec3f_from(affine_vector(&world->scene->world_to_environment, vec3_from_f(direction))));
}

/* Whether something of a portal is on the normal's side of a place; there is none: it is. */
static bool is_before(const WorldPortal *portal, Vec3 from, Vec3f normal)
{
    Vec3 n = vec3_from_f(normal);
    if (!(vec3_dot(n, n) > 0)) return true;
    const Affine *map = &portal->light->to_world;
    Vec3 x = affine_vector(map, vec3(portal->light->half_width, 0, 0)),
         z = affine_vector(map, vec3(0, 0, portal->light->half_height));
    return vec3_dot(n, vec3_sub(map->t, from)) + fabs(vec3_dot(n, x)) + fabs(vec3_dot(n, z)) > 0;
}

/* All portals as they are seen from a place. What is seen of many is looked at anew each time. */
enum { VIEWS_KEPT = 16 };
typedef struct Views {
    const World *world;
    Vec3 from;
    Vec3f normal;
    PortalView kept[VIEWS_KEPT];
    double power; /* of all together */
} Views;

/* power 0: not seen */
static PortalView look_at(const Views *views, uint32_t i)
{
    const WorldPortal *portal = &views->world->portals[i];
    const SceneLight *light = portal->light;
    PortalView view;
    bool seen = is_before(portal, views->from, views->normal) &&
                portal_look(portal->map, light->half_width, light->half_height,
                            affine_point(&portal->to_frame, views->from), &view);
    return seen ? view : (PortalView){.power = 0};
}

static void look_at_all(Views *views, const World *world, Vec3 from, Vec3f normal)
{
    views->world = world;
    views->from = from;
    views->normal = normal;
    views->power = 0;
    for (uint32_t i = 0; i < world->n_portals; i++) {
        PortalView view = look_at(views, i);
        views->power += view.power;
        if (i < VIEWS_KEPT) views->kept[i] = view;
    }
}

static PortalView view_of(const Views *views, uint32_t i)
{
    return i < VIEWS_KEPT ? views->kept[i] : look_at(views, i);
}

/* The luminances that portals would choose a direction by, summed over all that it goes out by but `except` (or
 * UINT32_MAX): over the power of all it is the density of choosing a portal by its power and a direction by its map. */
static double portals_density(const Views *views, Vec3f direction, uint32_t except)
{
    double sum = 0;
    Vec3 d = vec3_from_f(direction);
    for (uint32_t i = 0; i < views->world->n_portals; i++) {
        PortalView view = view_of(views, i);
        const WorldPortal *portal = &views->world->portals[i];
        if (view.power > 0 && i != except)
            sum += portal_density(portal->map, &view, affine_vector(&portal->to_frame, d));
    }
    return sum;
}

static float density_of_both(const Views *views, double by_portals, float by_environment)
{
    if (!(views->power > 0)) return by_environment;
    return (float)(without_portals * (double)by_environment + (1 - without_portals) * by_portals / views->power);
}

/* Through the portal at which `share` of the power of all of them is reached. */
static void sample_portal(const Views *views, double share, const float u[2], LightSample *sample)
{
    const World *world = views->world;
    double wanted = share * views->power, density;
    uint32_t chosen = UINT32_MAX;
    PortalView view, chosen_view;
    for (uint32_t i = 0; i < world->n_portals && (chosen == UINT32_MAX || wanted >= 0); i++) {
        view = view_of(views, i);
        if (!(view.power > 0)) continue;
        chosen = i;
        chosen_view = view;
        wanted -= view.power;
    }
    const WorldPortal *portal = &world->portals[chosen];
    Vec3 outward = portal_sample(portal->map, &chosen_view, u[0], u[1], &density);
    *sample = (LightSample){.distance = HUGE_VAL, .object = RTC_NO_OBJECT};
    sample->direction = vec3f_normalize(vec3f_from(affine_vector(&portal->light->to_world, outward)));
    /* its own density as it was sampled: by the rounded direction it might be beside the opening */
    density += portals_density(views, sample->direction, chosen);
    Vec3f local = to_environment(world, sample->direction);
    float by_environment;
    sample->of_sky = true;
    sample->sky = environment_find(world->scene->environment, local, &by_environment);
    sample->pdf_w = density_of_both(views, density, by_environment);
}

void light_sample_environment(const World *world, const LightQuery *query, LightSample *sample)
{
    Views views;
    if (world->n_portals) {
        look_at_all(&views, world, query->from, query->normal);
        if (views.power > 0 && query->rest >= without_portals) {
            sample_portal(&views, (query->rest - without_portals) / (1 - without_portals), query->u, sample);
            return;
        }
    }
    *sample = (LightSample){.distance = HUGE_VAL, .object = RTC_NO_OBJECT, .of_sky = true};
    Vec3f local =
        environment_sample_place(world->scene->environment, query->u[0], query->u[1], &sample->pdf_w, &sample->sky);
    /* the map is a rotation: its transpose is its inverse */
    sample->direction =
        vec3f_normalize(vec3f_from(affine_normal(&world->scene->world_to_environment, vec3_from_f(local))));
    if (world->n_portals)
        sample->pdf_w = density_of_both(&views, portals_density(&views, sample->direction, UINT32_MAX), sample->pdf_w);
}

/* The density of light_sample_environment; by_environment: the environment's own. */
static float environment_density(const World *world, const LightRival *rival, Vec3f direction, float by_environment)
{
    if (!world->n_portals) return by_environment;
    Views views;
    look_at_all(&views, world, rival->from, rival->normal);
    return density_of_both(&views, portals_density(&views, direction, UINT32_MAX), by_environment);
}

static float weight_against(float weight_pdf, float light_pdf)
{
    return weight_pdf < 0 ? 1 : sampling_balance(weight_pdf, light_pdf);
}

/* Whether a direction is within a distant light's cone. The length of a unit vector of floats is not one to the digits
 * that tell the cosines of a small cone apart. */
static bool is_within(const SceneLight *light, Vec3f direction)
{
    Vec3 d = vec3_from_f(direction);
    double along = vec3_dot(d, light->towards);
    if (light->cos_angle < 0) return along >= light->cos_angle * vec3_length(d);
    return along > 0 && along * along >= light->cos_angle * light->cos_angle * vec3_dot(d, d);
}

static inline bool is_of(uint32_t group, uint32_t asked)
{
    return LIKELY(asked == LIGHT_GROUPS_ALL) || group == asked;
}

Lanes light_from_infinity(const World *world, const LightRival *rival, Vec3f direction, bool sight, uint32_t group,
                          Lanes wavelength_nm)
{
    const Scene *scene = world->scene;
    const LightChoices *choices = rival->choices;
    const float weight_pdf = rival->pdf_w;
    Lanes sum = lanes_all(0);
    if (scene->environment && !(sight && scene->environment_hidden) && is_of(scene->environment_group, group)) {
        bool weighed = weight_pdf >= 0 && choices->environment > 0;
        Vec3f local = environment_width(scene->environment) > 0 ? to_environment(world, direction) : direction;
        float pdf = 0;
        sum = weighed ? environment_look(scene->environment, local, wavelength_nm, &pdf)
                      : environment_radiance(scene->environment, local, wavelength_nm);
        if (weighed) pdf = choices->environment * environment_density(world, rival, direction, pdf);
        sum = lanes_scale(sum, weight_against(weight_pdf, pdf));
    }
    for (uint32_t i = 0; world->has_distant && i < scene->n_lights; i++) {
        const SceneLight *light = &scene->lights[i];
        if (light->kind != LIGHT_DISTANT || (sight && light->hidden) || !is_of(light->group, group) ||
            !is_within(light, direction))
            continue;
        float pdf = choices->of_light[i] * sampling_cone_pdf((float)(1 - light->cos_angle));
        sum =
            lanes_add(sum, lanes_scale(spectrum_at(&light->radiance, wavelength_nm), weight_against(weight_pdf, pdf)));
    }
    return sum;
}

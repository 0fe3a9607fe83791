/* beacons.c - see beacons.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/beacons.h"

#include <string.h>

#include "base/angle.h"
#include "optics/color.h"

/* What is more than `most` times brighter than the mean around what is clear counts as no brighter, as something may be in
 * between; what is hardly brighter than the backdrop is not worth looking for. */
static const double most_brightness = 64, least_brightness = 1.25;

/* A lamp: flat, with a normal; or round. */
typedef struct Lamp {
    bool flat, disc, far;
    Vec3 centre, normal, side[2]; /* side: to the edges; far: centre is the direction, of length 1 */
    double radius, luminance, given;
} Lamp;

enum { MOST = 4 * BEACON_GROUPS };
typedef struct Finder {
    Vec3 middle; /* of what is clear */
    Lamp flat[MOST], round[MOST];
    size_t n_flat, n_round;
    double given; /* integral of luminance over the directions from the middle */
} Finder;

/* Of the lamps that give most, the first n. */
static void keep(Lamp *lamps, size_t *n, const Lamp *lamp)
{
    size_t at = *n;
    while (at > 0 && lamps[at - 1].given < lamp->given) at--;
    if (at == MOST) return;
    if (*n < MOST) ++*n;
    memmove(lamps + at + 1, lamps + at, (*n - at - 1) * sizeof *lamps);
    lamps[at] = *lamp;
}

static void add(Finder *f, Lamp *lamp, double steradians)
{
    lamp->given = fmax(lamp->luminance, 0) * fmin(fmax(steradians, 0), 2 * MEN_PI);
    f->given += lamp->given;
    if (lamp->luminance > 0) keep(lamp->flat ? f->flat : f->round, lamp->flat ? &f->n_flat : &f->n_round, lamp);
}

static void add_round(Finder *f, Lamp *lamp)
{
    Vec3 to = vec3_sub(lamp->centre, f->middle);
    add(f, lamp, MEN_PI * lamp->radius * lamp->radius / vec3_dot(to, to));
}

static void add_light(Finder *f, const SceneLight *light)
{
    const Affine *map = &light->to_world;
    Lamp lamp = {.centre = map->t, .luminance = spectrum_luminance(&light->radiance), .radius = light->half_width};
    Vec3 to = vec3_sub(map->t, f->middle);
    double distance2 = vec3_dot(to, to), depth = light->kind == LIGHT_DISC ? light->half_width : light->half_height;
    switch (light->kind) {
    case LIGHT_RECT:
    case LIGHT_DISC:
        if (light_is_focused(light)) /* the frame is rigid: the transpose inverts it */
            lamp.luminance *= (double)light_shape(light, affine_normal(map, vec3_scale(to, -1 / sqrt(distance2))));
        lamp.flat = true;
        lamp.disc = light->kind == LIGHT_DISC;
        lamp.normal = affine_vector(map, vec3(0, 1, 0));
        lamp.side[0] = affine_vector(map, vec3(light->half_width, 0, 0));
        lamp.side[1] = affine_vector(map, vec3(0, 0, depth));
        add(f, &lamp,
            -vec3_dot(to, lamp.normal) * (lamp.disc ? MEN_PI : 4) * light->half_width * depth /
                (distance2 * sqrt(distance2)));
        break;
    case LIGHT_SPHERE: add_round(f, &lamp); break;
    case LIGHT_DISTANT:
        lamp.far = true;
        lamp.centre = light->towards;
        lamp.radius = light->cos_angle > 0 ? sqrt(1 - light->cos_angle * light->cos_angle) : 1;
        add(f, &lamp, 2 * MEN_PI * (1 - light->cos_angle));
        break;
    case LIGHT_POINT: /* met by no path */
    case LIGHT_PORTAL: break;
    }
}

/* The middle of all that is clear or thin, and bounded. */
static Vec3 find_middle(const CompiledScene *compiled)
{
    Box3 box = box3_empty();
    for (uint32_t h = 0; h < compiled->n_hulls; h++)
        if (compiled->order.top[h].medium < compiled->scene->n_media && !compiled->unbounded[h])
            box = box3_union(box, compiled->hull_bounds[h]);
    const Scene *scene = compiled->scene;
    SceneShapeBox known = {0};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        if (object->medium != SCENE_NONE || object->surface == SCENE_NONE || !scene->surfaces[object->surface].thin)
            continue;
        Box3 bounds = scene_next_bounds(scene, object, &known);
        if (!box3_is_unbounded(bounds)) box = box3_union(box, bounds);
    }
    return box3_is_empty(box) || box3_is_unbounded(box) ? vec3(0, 0, 0) : box3_centre(box);
}

static void set3(Lanes to[3], int lane, Vec3 from)
{
    lanes_set(&to[0], lane, (float)from.x);
    lanes_set(&to[1], lane, (float)from.y);
    lanes_set(&to[2], lane, (float)from.z);
}

/* In multiples of the backdrop. */
static float brightness_of(double luminance, const Beacons *beacons)
{
    double ratio = fmin(luminance / beacons->mean, most_brightness) / beacons->backdrop;
    return ratio >= least_brightness ? (float)ratio : 1;
}

static void set_flat(FlatBeacons *four, int lane, const Lamp *lamp, float brightness)
{
    double width = vec3_length(lamp->side[0]), depth = vec3_length(lamp->side[1]);
    set3(four->ball, lane, lamp->centre);
    lanes_set(&four->ball_radius, lane, (float)(lamp->disc ? fmax(width, depth) : hypot(width, depth)));
    set3(four->normal, lane, lamp->normal);
    lanes_set(&four->height, lane, (float)vec3_dot(lamp->normal, lamp->centre));
    for (int i = 0; i < 2; i++) {
        Vec3 side = vec3_scale(lamp->side[i], 1 / vec3_dot(lamp->side[i], lamp->side[i]));
        set3(four->side[i], lane, side);
        lanes_set(&four->middle[i], lane, (float)vec3_dot(side, lamp->centre));
    }
    lanes_set(&four->is_disc, lane, lamp->disc);
    lanes_set(&four->brightness, lane, brightness);
}

static void set_round(RoundBeacons *four, int lane, const Lamp *lamp, float brightness)
{
    set3(four->centre, lane, lamp->centre);
    lanes_set(&four->is_near, lane, !lamp->far);
    lanes_set(&four->radius2, lane, (float)(lamp->radius * lamp->radius));
    lanes_set(&four->brightness, lane, brightness);
}

static void set_lamps(const Finder *f, Beacons *beacons)
{
    uint32_t n_flat = 0, n_round = 0;
    for (size_t i = 0; i < f->n_flat; i++) {
        float brightness = brightness_of(f->flat[i].luminance, beacons);
        if (brightness > 1) set_flat(&beacons->flat[n_flat / LANES], (int)(n_flat % LANES), &f->flat[i], brightness);
        n_flat += brightness > 1;
    }
    for (size_t i = 0; i < f->n_round; i++) {
        float brightness = brightness_of(f->round[i].luminance, beacons);
        if (brightness > 1)
            set_round(&beacons->round[n_round / LANES], (int)(n_round % LANES), &f->round[i], brightness);
        n_round += brightness > 1;
    }
    beacons->n_flat = (n_flat + LANES - 1) / LANES;
    beacons->n_round = (n_round + LANES - 1) / LANES;
}

/* The lower half of an octahedron seen from above, folded out beyond its edges; and back. */
static inline void fold(float *x, float *y)
{
    float folded = (1 - fabsf(*y)) * copysignf(1, *x);
    *y = (1 - fabsf(*x)) * copysignf(1, *y);
    *x = folded;
}

/* The unit vector of a place of the map's square, 0 .. 1. */
static Vec3f from_octahedron(float u, float v)
{
    float x = 2 * u - 1, y = 2 * v - 1, z = 1 - fabsf(x) - fabsf(y);
    if (z < 0) fold(&x, &y);
    return vec3f_normalize(vec3f(x, y, z));
}

static void fill_map(const Scene *scene, Beacons *beacons)
{
    enum { SIDE = 4 }; /* places looked at of each cell */
    for (int y = 0; y < BEACON_MAP; y++)
        for (int x = 0; x < BEACON_MAP; x++) {
            double sum = 0;
            for (int i = 0; i < SIDE * SIDE; i++) {
                float u = ((float)x + ((float)(i % SIDE) + 0.5f) / SIDE) / BEACON_MAP;
                float v = ((float)y + ((float)(i / SIDE) + 0.5f) / SIDE) / BEACON_MAP;
                Vec3 local = affine_vector(&scene->world_to_environment, vec3_from_f(from_octahedron(u, v)));
                sum += (double)environment_luminance(scene->environment, vec3f_normalize(vec3f_from(local)));
            }
            beacons->map[y][x] = brightness_of(sum / (SIDE * SIDE), beacons);
            beacons->has_map = beacons->has_map || beacons->map[y][x] > 1;
        }
}

void beacons_find(const CompiledScene *compiled, double backdrop, Beacons *beacons)
{
    const Scene *scene = compiled->scene;
    Finder f = {.middle = find_middle(compiled)};
    *beacons = (Beacons){.backdrop = backdrop};
    for (uint32_t i = 0; i < scene->n_lights; i++)
        if (!light_keys(scene, &scene->lights[i])) add_light(&f, &scene->lights[i]);
    bool uneven = scene->environment && environment_width(scene->environment) > 0;
    if (scene->environment) f.given += (double)environment_power(scene->environment);
    beacons->mean = f.given / (4 * MEN_PI);
    if (!(beacons->mean > 0)) return;
    set_lamps(&f, beacons);
    if (uneven) fill_map(scene, beacons);
    beacons->any = beacons->n_flat || beacons->n_round || beacons->has_map;
}

static inline Lanes dot(const Lanes a[3], const Lanes b[3])
{
    return lanes_add(lanes_add(lanes_mul(a[0], b[0]), lanes_mul(a[1], b[1])), lanes_mul(a[2], b[2]));
}

/* A line's direction in two parts: one that both ways have in common, and one that is turned round for the second. */
typedef struct Ways {
    Lanes place[3], along[3], up[3];
} Ways;

/* Of lines that come so near to a point, and not all of that behind their starts, a number <= 0. It errs on that side. */
static inline Lanes missed_by(Lanes distance2, Lanes along, Lanes radius)
{
    const float rounding = 0x1p-18f;
    Lanes beside2 = lanes_sub(lanes_scale(distance2, 1 - rounding), lanes_mul(along, along));
    Lanes missed = lanes_sub(beside2, lanes_mul(radius, radius));
    return lanes_select_less(lanes_sub(lanes_all(0), along), radius, missed, lanes_all(1));
}

/* Whether either way comes through one of the balls around four lamps. */
static inline bool comes_near(const FlatBeacons *four, const Ways *ways)
{
    Lanes to[3];
    for (int i = 0; i < 3; i++) to[i] = lanes_sub(four->ball[i], ways->place[i]);
    Lanes along = dot(to, ways->along), up = dot(to, ways->up), distance2 = dot(to, to);
    Lanes missed = lanes_lesser(missed_by(distance2, lanes_add(along, up), four->ball_radius),
                                missed_by(distance2, lanes_sub(along, up), four->ball_radius));
    return lanes_not_above(missed, lanes_all(0)) != 0;
}

static inline Lanes met_flat(const FlatBeacons *four, Lanes height, Lanes cosine, const Lanes begin[2],
                             const Lanes step[2])
{
    Lanes none = lanes_all(1), nothing = lanes_all(0), t = lanes_div(height, cosine);
    Lanes x = lanes_add(begin[0], lanes_mul(t, step[0])), y = lanes_add(begin[1], lanes_mul(t, step[1]));
    Lanes x2 = lanes_mul(x, x), y2 = lanes_mul(y, y), larger = lanes_greater(x2, y2);
    Lanes across = lanes_add(larger, lanes_mul(four->is_disc, lanes_sub(lanes_add(x2, y2), larger)));
    Lanes met = lanes_select_less(across, none, four->brightness, none);
    met = lanes_select_less(nothing, t, met, none);
    return lanes_select_less(cosine, nothing, met, none); /* they shine to one side */
}

static inline void look_flat(const FlatBeacons *four, const Ways *ways, Lanes most[2])
{
    if (LIKELY(!comes_near(four, ways))) return;
    Lanes height = lanes_sub(four->height, dot(four->normal, ways->place)), begin[2], along[2], up[2], steps[2][2];
    Lanes normal_along = dot(four->normal, ways->along), normal_up = dot(four->normal, ways->up);
    for (int i = 0; i < 2; i++) {
        begin[i] = lanes_sub(dot(four->side[i], ways->place), four->middle[i]);
        along[i] = dot(four->side[i], ways->along);
        up[i] = dot(four->side[i], ways->up);
        steps[0][i] = lanes_add(along[i], up[i]);
        steps[1][i] = lanes_sub(along[i], up[i]);
    }
    most[0] = lanes_greater(met_flat(four, height, lanes_add(normal_along, normal_up), begin, steps[0]), most[0]);
    most[1] = lanes_greater(met_flat(four, height, lanes_sub(normal_along, normal_up), begin, steps[1]), most[1]);
}

static inline Lanes met_round(const RoundBeacons *four, Lanes distance2, Lanes along)
{
    Lanes none = lanes_all(1), beside2 = lanes_sub(distance2, lanes_mul(along, along));
    Lanes met = lanes_select_less(beside2, four->radius2, four->brightness, none);
    return lanes_select_less(lanes_all(0), along, met, none);
}

static inline void look_round(const RoundBeacons *four, const Ways *ways, Lanes most[2])
{
    Lanes to[3];
    for (int i = 0; i < 3; i++) to[i] = lanes_sub(four->centre[i], lanes_mul(four->is_near, ways->place[i]));
    Lanes along = dot(to, ways->along), up = dot(to, ways->up), distance2 = dot(to, to);
    most[0] = lanes_greater(met_round(four, distance2, lanes_add(along, up)), most[0]);
    most[1] = lanes_greater(met_round(four, distance2, lanes_sub(along, up)), most[1]);
}

static float look_up(const Beacons *beacons, Vec3f direction)
{
    float scale = 1 / (fabsf(direction.x) + fabsf(direction.y) + fabsf(direction.z));
    float x = direction.x * scale, y = direction.y * scale;
    if (direction.z < 0) fold(&x, &y);
    int column = (int)((x + 1) * (0.5f * BEACON_MAP)), row = (int)((y + 1) * (0.5f * BEACON_MAP));
    if (column < 0 || row < 0) return 1; /* NaN, too */
    return beacons->map[row < BEACON_MAP ? row : BEACON_MAP - 1][column < BEACON_MAP ? column : BEACON_MAP - 1];
}

void beacons_look(const Beacons *beacons, Vec3f place, Vec3f along, Vec3f up, float brightness[2])
{
    Ways ways = {{lanes_all(place.x), lanes_all(place.y), lanes_all(place.z)},
                 {lanes_all(along.x), lanes_all(along.y), lanes_all(along.z)},
                 {lanes_all(up.x), lanes_all(up.y), lanes_all(up.z)}};
    Lanes most[2] = {lanes_all(1), lanes_all(1)};
    for (uint32_t i = 0; i < beacons->n_flat; i++) look_flat(&beacons->flat[i], &ways, most);
    for (uint32_t i = 0; i < beacons->n_round; i++) look_round(&beacons->round[i], &ways, most);
    for (int i = 0; i < 2; i++) brightness[i] = lanes_max(most[i]);
    if (!beacons->has_map) return;
    brightness[0] = float_max(brightness[0], look_up(beacons, vec3f_add(along, up)));
    brightness[1] = float_max(brightness[1], look_up(beacons, vec3f_sub(along, up)));
}

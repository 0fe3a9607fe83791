/* photon_sea.c - see photon_sea.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/photon_sea.h"

#include <stdlib.h>

#include "trace/event.h"
#include "trace/path_parts.h"
#include "trace/shade.h"

enum { VIEWS = 1 << 13, LEAST_LANDINGS = 16, MOST_EVENTS = 64, MOST_LANDINGS = 4 /* of a path */ };
/* Tiles of what is seen; and around these, up to four of what things near by may mirror or cast onto them. */
enum { SEEN_TILES = PHOTON_TILES - 4 };
/* For those, if there are any. */
#define AROUND_PART 0.1
/* Of the picture, at each of the four borders: a few rays that go far towards the horizon do not say how far photons are to go. */
#define LEFT_OUT 0.0005
/* And of the landings, the deepest. */
#define TOO_DEEP 0.05
/* No pixel of a picture has these coordinates. */
enum { VIEW_PIXEL_X = 0x70736561, VIEW_PIXEL_Y = 0x76696577 };

/* Where a path of the camera is scattered that a sea's light may come to. */
typedef struct Landing {
    double along[3];
    double weight; /* what the path carries */
    double depth;  /* below the surface, see find_heights */
} Landing;

typedef struct Seas {
    const World *world;
    const bool *are;  /* of objects */
    int level[2], up; /* axes: those that tiles are laid along, and the one nearest to the normal of the surface */
    Landing *landings;
    uint32_t n;
} Seas;

typedef struct Leaf {
    uint32_t begin, end; /* of the landings */
    double low[2], high[2], weight;
} Leaf;

static void coordinates(Vec3 p, double along[3])
{
    along[0] = p.x, along[1] = p.y, along[2] = p.z;
}

/* ---- what is seen ---- */

static bool is_in_sea(const Seas *seas, const NestList *list)
{
    const CompiledScene *compiled = seas->world->compiled;
    uint32_t n = nest_list_count(list);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t hull = nest_item(&compiled->order, list, i);
        if (hull < compiled->n_hulls && seas->are[compiled->object_of_hull[hull]]) return true;
    }
    return false;
}

static bool is_surface_of_sea(const Seas *seas, uint32_t object)
{
    uint32_t hull = compiled_hull(seas->world->compiled, object);
    return hull != SCENE_NONE && seas->are[seas->world->compiled->object_of_hull[hull]];
}

/* Sends the path on from an event. false: it ends. *lands: it is scattered there, as light is that photons tell of. */
static bool pass_event(Path *path, Event *event, bool *lands)
{
    const Scene *scene = path->tracer->world->scene;
    *lands = event->kind == EVENT_SCATTER;
    if (*lands) {
        path_scatter_in_medium(path, event);
        return true;
    }
    if (event->kind == EVENT_BOUNDARY) {
        bool goes_on = path_cross_boundary(path, event);
        *lands = !goes_on || !path_went_straight(path);
        return goes_on;
    }
    const SceneObject *object = &scene->objects[event->hit.object];
    if (object->light != SCENE_NONE || object->surface == SCENE_NONE) return false;
    bool goes_on = path_shade_opaque(path, event);
    const SceneSurface *surface = &scene->surfaces[object->surface];
    *lands = !goes_on || !path_went_straight(path) || !(surface->finished || surface->mixed);
    return goes_on;
}

/* Follows a path of the camera, and notes where it is scattered after it came to a sea; not only the first time: from below, the
 * surface mirrors what comes from the bottom, and paths look for lights far around. */
static void follow_view(Seas *seas, Path *path)
{
    const float least = 1e-4f; /* of what it carries */
    bool by_sea = is_in_sea(seas, &path->tracer->list);
    int n = 0;
    for (int i = 0; i < MOST_EVENTS && n < MOST_LANDINGS; i++, path->bounce++) {
        Event event;
        path_next_event(path, &event);
        if (event.kind == EVENT_LOST) path->tracer->out_of_memory = true;
        if (event.kind == EVENT_LOST || event.kind == EVENT_ESCAPE || event.kind == EVENT_GIVE_UP) return;
        Landing landing;
        coordinates(ray_point(&path->ray, event.kind == EVENT_SCATTER ? event.t : event.hit.t), landing.along);
        float carried = lanes_mean(path_carried(path));
        if (!(carried > least && isfinite(carried))) return;
        landing.weight = (double)carried;
        by_sea = by_sea || (event.kind == EVENT_BOUNDARY && is_surface_of_sea(seas, event.hit.object));
        bool lands, goes_on = pass_event(path, &event, &lands);
        if (lands) n++;
        if (lands && by_sea) seas->landings[seas->n++] = landing;
        if (!goes_on) return;
    }
}

static Status find_landings(Seas *seas, Error *error)
{
    const World *world = seas->world;
    Tracer tracer;
    tracer_init(&tracer, world);
    for (uint32_t i = 0; i < VIEWS && !tracer.out_of_memory; i++) {
        Path path;
        path_init(&path, &tracer, sampler_make(0, VIEW_PIXEL_X, VIEW_PIXEL_Y, i));
        path.wavelengths = world_wavelengths(world, sampler_1d(&path.sampler, DIM_WAVELENGTH));
        path_is_of_light(&path, NULL); /* it asks for no light */
        float u[2];
        sampler_2d(&path.sampler, DIM_PIXEL, u);
        FilmPoint point = {(double)u[0] * world->width, (double)u[1] * world->height, world->width, world->height};
        if (!path_begin_at_camera(&path, point)) continue;
        follow_view(seas, &path);
    }
    bool enough = !tracer.out_of_memory;
    tracer_clear(&tracer);
    return enough ? STATUS_OK : fail(error, STATUS_NOMEM, "out of memory for a first look at a sea");
}

/* ---- the surface ---- */

/* A half of space that bounds a sea: points p with normal . p + offset < 0. */
static bool surface_of(const Seas *seas, uint32_t i, double normal[3], double *offset)
{
    const CompiledScene *compiled = seas->world->compiled;
    uint32_t object = compiled->planes[i];
    Affine inverse;
    if (!is_surface_of_sea(seas, object) || !affine_invert(&seas->world->scene->objects[object].to_world, &inverse))
        return false;
    for (int axis = 0; axis < 3; axis++) normal[axis] = inverse.m[1][axis];
    *offset = inverse.t.y;
    return true;
}

/* Tiles go all the way along the axis that is nearest to the surfaces' normals; false: no sea has a surface. */
static bool find_axes(Seas *seas)
{
    double sum[3] = {0}, normal[3], offset;
    bool any = false;
    for (uint32_t i = 0; i < seas->world->compiled->n_planes; i++) {
        if (!surface_of(seas, i, normal, &offset)) continue;
        double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        for (int axis = 0; axis < 3; axis++) sum[axis] += fabs(normal[axis]) / length;
        any = true;
    }
    seas->up = sum[1] >= sum[0] && sum[1] >= sum[2] ? 1 : sum[0] >= sum[2] ? 0 : 2;
    seas->level[0] = seas->up == 0 ? 1 : 0;
    seas->level[1] = seas->up == 2 ? 1 : 2;
    return any;
}

/* ---- tiles ---- */

/* All that differ have an order, so that it is the same by every library's qsort. */
static int compare_along(const Landing *a, const Landing *b, int axis)
{
    for (int i = 0; i < 3; i++, axis = (axis + 1) % 3)
        if (a->along[axis] != b->along[axis]) return a->along[axis] < b->along[axis] ? -1 : 1;
    return a->weight < b->weight ? -1 : a->weight > b->weight;
}
static int compare_x(const void *a, const void *b)
{
    return compare_along(a, b, 0);
}
static int compare_y(const void *a, const void *b)
{
    return compare_along(a, b, 1);
}
static int compare_z(const void *a, const void *b)
{
    return compare_along(a, b, 2);
}

static void sort_along(Landing *landings, uint32_t n, int axis)
{
    int (*const compare[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
    qsort(landings, n, sizeof *landings, compare[axis]);
}

static double weight_of(const Landing *landings, uint32_t n)
{
    double sum = 0;
    for (uint32_t i = 0; i < n; i++) sum += landings[i].weight;
    return sum;
}

/* How many of the sorted landings have up to a part of their weight together. */
static uint32_t count_of(const Landing *landings, uint32_t n, double part)
{
    double all = weight_of(landings, n), sum = 0;
    uint32_t i = 0;
    while (i < n && sum + landings[i].weight <= part * all) sum += landings[i++].weight;
    return i;
}

/* Leaves out those at the borders; the leaf is around what is left. */
static Leaf trim(Seas *seas)
{
    Leaf leaf = {0};
    for (int k = 0; k < 2; k++) {
        int axis = seas->level[k];
        sort_along(seas->landings, seas->n, axis);
        uint32_t begin = count_of(seas->landings, seas->n, LEFT_OUT),
                 end = count_of(seas->landings, seas->n, 1 - LEFT_OUT);
        if (end <= begin) continue;
        for (uint32_t i = begin; i < end; i++) seas->landings[i - begin] = seas->landings[i];
        seas->n = end - begin;
    }
    for (int k = 0; k < 2; k++) {
        leaf.low[k] = HUGE_VAL;
        leaf.high[k] = -HUGE_VAL;
        for (uint32_t i = 0; i < seas->n; i++) {
            leaf.low[k] = fmin(leaf.low[k], seas->landings[i].along[seas->level[k]]);
            leaf.high[k] = fmax(leaf.high[k], seas->landings[i].along[seas->level[k]]);
        }
    }
    leaf.end = seas->n;
    leaf.weight = weight_of(seas->landings, seas->n);
    return leaf;
}

/* Of a landing and the surfaces above it, the lowest and the highest. One that is outside, to which light comes off the surface,
 * counts as being there. */
static void heights_of(const Seas *seas, const Landing *landing, double heights[2])
{
    double normal[3], offset;
    const double *p = landing->along;
    heights[0] = HUGE_VAL;
    heights[1] = -HUGE_VAL;
    for (uint32_t i = 0; i < seas->world->compiled->n_planes; i++) {
        if (!surface_of(seas, i, normal, &offset)) continue;
        double height = normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2] + offset, slope = normal[seas->up];
        bool steep = fabs(slope) < 1e-3 * (fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]));
        double at_surface = steep ? p[seas->up] : p[seas->up] - height / slope;
        double here = height < 0 ? p[seas->up] : at_surface;
        heights[0] = fmin(heights[0], fmin(here, at_surface));
        heights[1] = fmax(heights[1], fmax(here, at_surface));
    }
}

static int compare_depths(const void *left, const void *right)
{
    const Landing *a = left, *b = right;
    return a->depth != b->depth ? (a->depth < b->depth ? -1 : 1) : compare_along(a, b, 0);
}

/* From the deepest landing, but for a few, to the surfaces above all of them: where a sea without a bottom scatters light, some paths
 * of the camera go a hundred times as deep as what is seen, and boxes for those would send next to no photons there. */
static void find_heights(Seas *seas, double heights[2])
{
    double here[2];
    for (uint32_t i = 0; i < seas->n; i++) {
        heights_of(seas, &seas->landings[i], here);
        seas->landings[i].depth = here[1] - here[0];
    }
    qsort(seas->landings, seas->n, sizeof *seas->landings, compare_depths);
    uint32_t n = count_of(seas->landings, seas->n, 1 - TOO_DEEP);
    heights[0] = HUGE_VAL;
    heights[1] = -HUGE_VAL;
    for (uint32_t i = 0; i <= n && i < seas->n; i++) {
        heights_of(seas, &seas->landings[i], here);
        heights[0] = fmin(heights[0], here[0]);
        heights[1] = fmax(heights[1], here[1]);
    }
}

static double leaf_area(const Leaf *leaf)
{
    return (leaf->high[0] - leaf->low[0]) * (leaf->high[1] - leaf->low[1]);
}

/* Splits a leaf across its longer side, where half of its weight is on either side; false: it cannot be. */
static bool split_leaf(const Seas *seas, Leaf *leaf, Leaf *other)
{
    int k = leaf->high[0] - leaf->low[0] < leaf->high[1] - leaf->low[1], axis = seas->level[k];
    Landing *landings = seas->landings + leaf->begin;
    uint32_t n = leaf->end - leaf->begin;
    sort_along(landings, n, axis);
    uint32_t middle = count_of(landings, n, 0.5);
    if (middle == 0 || middle >= n) return false;
    double at = 0.5 * (landings[middle - 1].along[axis] + landings[middle].along[axis]);
    if (!(at > leaf->low[k] && at < leaf->high[k])) return false;
    *other = *leaf;
    leaf->end = other->begin = leaf->begin + middle;
    leaf->high[k] = other->low[k] = at;
    leaf->weight = weight_of(landings, middle);
    other->weight = weight_of(landings + middle, n - middle);
    return true;
}

/* What the picture's squared error is like that a leaf makes if all are sent as many photons: its part, by their density there. */
static double leaf_need(const Leaf *leaf)
{
    return leaf->weight * leaf_area(leaf);
}

/* Photons that start in the faces between tiles come from others of them, and are none: tiles are to be wider than deep. */
static bool may_be_split(const Leaf *leaf, double depth)
{
    double longer = fmax(leaf->high[0] - leaf->low[0], leaf->high[1] - leaf->low[1]);
    return longer > 4 * depth && leaf->end - leaf->begin >= LEAST_LANDINGS;
}

static uint32_t split_all(const Seas *seas, double depth, Leaf leaves[SEEN_TILES])
{
    for (uint32_t n = 1;; n++) {
        uint32_t neediest = SEEN_TILES;
        for (uint32_t i = 0; i < n; i++)
            if (may_be_split(&leaves[i], depth) &&
                (neediest == SEEN_TILES || leaf_need(&leaves[i]) > leaf_need(&leaves[neediest])))
                neediest = i;
        if (n == SEEN_TILES || neediest == SEEN_TILES || !split_leaf(seas, &leaves[neediest], &leaves[n])) return n;
    }
}

static Box3 box_of(const Seas *seas, const double low[2], const double high[2], const double heights[2])
{
    double from[3], to[3];
    for (int k = 0; k < 2; k++) from[seas->level[k]] = low[k], to[seas->level[k]] = high[k];
    from[seas->up] = heights[0];
    to[seas->up] = heights[1];
    return (Box3){vec3(from[0], from[1], from[2]), vec3(to[0], to[1], to[2])};
}

static int compare_densities(const void *left, const void *right)
{
    const Leaf *a = *(const Leaf *const *)left, *b = *(const Leaf *const *)right;
    double of_a = a->weight / leaf_area(a), of_b = b->weight / leaf_area(b);
    return of_a > of_b ? -1 : of_a < of_b;
}

/* What the picture has of an area where that is much: half of the picture has more of it. */
static double usual_density(const Leaf *leaves, uint32_t n, double weights)
{
    const Leaf *sorted[SEEN_TILES];
    double sum = 0;
    uint32_t i = 0;
    for (uint32_t k = 0; k < n; k++) sorted[k] = &leaves[k];
    qsort(sorted, n, sizeof sorted[0], compare_densities);
    for (; i + 1 < n && sum + sorted[i]->weight < 0.5 * weights; i++) sum += sorted[i]->weight;
    return sorted[i]->weight / leaf_area(sorted[i]);
}

static PhotonTile tile_of(const Seas *seas, const Leaf *leaf, const double heights[2], double density, double part)
{
    return (PhotonTile){.box = box_of(seas, leaf->low, leaf->high, heights),
                        .part = part,
                        .more = fmax(density * leaf_area(leaf) / leaf->weight - 1, 0)};
}

/* Half of the photons by what is seen of the tiles, half as makes the sum of all errors least. */
static void share_out(const Seas *seas, const Leaf *leaves, uint32_t n, const double heights[2], double density,
                      PhotonTile *tiles)
{
    double weights = 0, roots = 0;
    for (uint32_t i = 0; i < n; i++) {
        weights += leaves[i].weight;
        roots += sqrt(leaf_need(&leaves[i]));
    }
    for (uint32_t i = 0; i < n; i++)
        tiles[i] = tile_of(seas, &leaves[i], heights, density,
                           0.5 * (leaves[i].weight / weights + sqrt(leaf_need(&leaves[i])) / roots));
}

/* Around what is seen, as far as things are near by that the sea may mirror light to, or that may stand in its way. */
static void add_around(const Seas *seas, const Leaf *whole, const double heights[2], double density, PhotonTile *tiles,
                       uint32_t *n)
{
    Box3 things = rtc_scene_bounds(seas->world->compiled->rtc);
    double from[3], to[3], low[2], high[2], area = 0;
    if (box3_is_empty(things)) return;
    coordinates(things.min, from);
    coordinates(things.max, to);
    for (int k = 0; k < 2; k++) {
        double margin = to[seas->up] - from[seas->up], size = whole->high[k] - whole->low[k];
        low[k] = fmax(fmin(from[seas->level[k]] - margin, whole->low[k]), whole->low[k] - size);
        high[k] = fmin(fmax(to[seas->level[k]] + margin, whole->high[k]), whole->high[k] + size);
    }
    Leaf strips[4] = {{.low = {low[0], low[1]}, .high = {whole->low[0], high[1]}},
                      {.low = {whole->high[0], low[1]}, .high = {high[0], high[1]}},
                      {.low = {whole->low[0], low[1]}, .high = {whole->high[0], whole->low[1]}},
                      {.low = {whole->low[0], whole->high[1]}, .high = {whole->high[0], high[1]}}};
    for (int i = 0; i < 4; i++) area += leaf_area(&strips[i]);
    if (!(area > 0)) return;
    for (uint32_t i = 0; i < *n; i++) tiles[i].part *= 1 - AROUND_PART;
    for (int i = 0; i < 4; i++) {
        double part = AROUND_PART * leaf_area(&strips[i]) / area;
        strips[i].weight = part * whole->weight;
        if (part > 0) tiles[(*n)++] = tile_of(seas, &strips[i], heights, density, part);
    }
}

static void lay_tiles(Seas *seas, PhotonTile tiles[PHOTON_TILES], uint32_t *n)
{
    Leaf leaves[SEEN_TILES];
    double heights[2];
    Leaf whole = trim(seas);
    find_heights(seas, heights);
    for (int k = 0; k < 2; k++) {
        double margin =
            0.1 * (heights[1] - heights[0]); /* waves send light aside, and a picture may show next to a point */
        whole.low[k] -= margin;
        whole.high[k] += margin;
    }
    if (!(leaf_area(&whole) > 0)) return;
    leaves[0] = whole;
    double slack = 1e-3 * fmax(heights[1] - heights[0], 1e-3 * sqrt(leaf_area(&whole)));
    heights[0] -= slack; /* so that no surface lies in a face */
    heights[1] += slack;
    *n = split_all(seas, heights[1] - heights[0], leaves);
    double density = usual_density(leaves, *n, whole.weight);
    share_out(seas, leaves, *n, heights, density, tiles);
    add_around(seas, &whole, heights, density, tiles, n);
}

Status photon_sea_tiles(const World *world, const bool *seas, PhotonTile tiles[PHOTON_TILES], uint32_t *n, int *up,
                        Error *error)
{
    Seas of = {.world = world, .are = seas};
    *n = 0;
    if (!find_axes(&of)) return STATUS_OK;
    *up = of.up;
    of.landings = malloc(MOST_LANDINGS * VIEWS * sizeof *of.landings);
    if (!of.landings) return fail_memory(error, MOST_LANDINGS * VIEWS * sizeof *of.landings, "a first look at a sea");
    Status status = find_landings(&of, error);
    if (status == STATUS_OK && of.n >= LEAST_LANDINGS) lay_tiles(&of, tiles, n);
    free(of.landings);
    return status;
}

/* photon_sea.c - see photon_sea.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/photon_sea.h"

#include <stdlib.h>

#include "trace/event.h"
#include "trace/path_parts.h"
#include "trace/photon_start.h"
#include "trace/shade.h"

enum { VIEWS = 1 << 13, LEAST_LANDINGS = 16, MOST_EVENTS = 64, MOST_LANDINGS = 4 /* of a path */ };
/* Tiles of what is seen; and around these, up to four of what things near by may mirror or cast onto them. */
enum { SEEN_TILES = PHOTON_TILES - 4 };
/* Of the photons, for those, at least. */
#define AROUND_PART 0.1
/* A wide object is so many times as long as deep. */
#define WIDE 4.0
/* Tiles are so many times as wide as deep at least: what would start in the faces between them comes from others, and is none. */
#define NARROWEST 0.5
/* Of what is seen by a sea, each tile has this part at least, though none of a few thousand paths came there. */
#define LEAST_SEEN 1e-3
/* What a sea mirrors or casts onto places that the camera sees by no sea, by what comes to those that it sees by it. */
#define CAST_ELSEWHERE 0.1
/* A wide object is split where that leaves less than this part of the squared error. */
#define WORTH_SPLITTING 0.5
/* Of the picture, at each of the four borders: a few rays that go far towards the horizon do not say how far photons are to go. */
#define LEFT_OUT 0.0005
/* And of the landings, the deepest. */
#define TOO_DEEP 0.05
/* No pixel of a picture has these coordinates. */
enum { VIEW_PIXEL_X = 0x70736561, VIEW_PIXEL_Y = 0x76696577 };

/* Where a path of the camera is scattered that a sea's light may come to. */
typedef struct Landing {
    double along[3]; /* where that light comes in, as high as where it lands */
    double weight;   /* what the path carries */
    double depth;    /* below the surface, see find_heights */
} Landing;

typedef struct Seas {
    const World *world;
    const bool *are; /* of objects */
    bool endless;
    double from[3], to[3]; /* the bounds, if they are not endless */
    int level[2], up;      /* axes: those that tiles are laid along, and the one nearest to the normal of the surface */
    Landing *landings;
    uint32_t n;
    double elsewhere;  /* the weight of those that the camera sees by no sea */
    LightSample light; /* the last one that is about as bright as */
    float brightest;   /* any was that a landing has chosen */
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

/* Of a landing and the surfaces above it, the lowest and the highest. One that is outside, to which light comes off the surface,
 * counts as being there. Of a wide object, those of its bounds. */
static void heights_of(const Seas *seas, const Landing *landing, double heights[2])
{
    double normal[3], offset;
    const double *p = landing->along;
    heights[0] = seas->endless ? HUGE_VAL : seas->from[seas->up];
    heights[1] = seas->endless ? -HUGE_VAL : seas->to[seas->up];
    for (uint32_t i = 0; seas->endless && i < seas->world->compiled->n_planes; i++) {
        if (!surface_of(seas, i, normal, &offset)) continue;
        double height = normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2] + offset, slope = normal[seas->up];
        bool steep = fabs(slope) < 1e-3 * (fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]));
        double at_surface = steep ? p[seas->up] : p[seas->up] - height / slope;
        double here = height < 0 ? p[seas->up] : at_surface;
        heights[0] = fmin(heights[0], fmin(here, at_surface));
        heights[1] = fmax(heights[1], fmax(here, at_surface));
    }
}

/* A small bright light comes to a landing aslant, by a place of the surface beside it, to which photons are to be sent: bent as by
 * level water. Where the landing chooses a light that is not bright, a sky, the last one that was stands for all. */
static void move_to_surface(Seas *seas, const Path *path, Landing *landing)
{
    const float bright = 0.1f; /* of the brightest */
    const double bent = 0.75;  /* the sine of an angle to the normal, in the water and above */
    double heights[2], toward[3];
    LightSample light;
    Vec3 place = vec3(landing->along[0], landing->along[1], landing->along[2]);
    photon_choose_light(path, NULL, place, vec3f(0, 0, 0), &light);
    float radiance = light.pdf_w > 0 && !light.delta ? lanes_mean(light.radiance) : 0;
    seas->brightest = fmaxf(seas->brightest, radiance);
    if (radiance > 0 && radiance >= bright * seas->brightest) seas->light = light;
    if (!(seas->brightest > 0) || isfinite(seas->light.distance)) return;
    heights_of(seas, landing, heights);
    coordinates(vec3_from_f(seas->light.direction), toward);
    double up = toward[seas->up], height = landing->along[seas->up],
           way = up > 0 ? heights[1] - height : height - heights[0];
    if (!(way > 0 && isfinite(way))) return;
    for (int k = 0; k < 2; k++)
        landing->along[seas->level[k]] += way * bent * toward[seas->level[k]] / sqrt(1 - bent * bent * (1 - up * up));
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
        if (lands && by_sea) {
            move_to_surface(seas, path, &landing);
            seas->landings[seas->n++] = landing;
        }
        if (lands && !by_sea) seas->elsewhere += landing.weight;
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

/* Along which a box is thinnest. */
static int thin_axis(const double from[3], const double to[3])
{
    int thin = 1; /* of two, the one along which there is more often a surface */
    for (int axis = 0; axis < 3; axis += 2)
        if (to[axis] - from[axis] < to[thin] - from[thin]) thin = axis;
    return thin;
}

/* Tiles go all the way along the axis that is nearest to the surfaces' normals, or along which a wide object is thinnest; false: no sea has a
 * surface. */
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
    if (!seas->endless) seas->up = thin_axis(seas->from, seas->to);
    seas->level[0] = seas->up == 0 ? 1 : 0;
    seas->level[1] = seas->up == 2 ? 1 : 2;
    return any || !seas->endless;
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

/* What lies beside a wide object is lit by what is at its border. */
static void clamp_to_bounds(Seas *seas)
{
    for (uint32_t i = 0; i < seas->n && !seas->endless; i++)
        for (int k = 0; k < 2; k++) {
            int axis = seas->level[k];
            seas->landings[i].along[axis] = fmin(fmax(seas->landings[i].along[axis], seas->from[axis]), seas->to[axis]);
        }
}

/* Leaves out those at the borders; the leaf is around what is left. */
static Leaf trim(Seas *seas)
{
    Leaf leaf = {0};
    clamp_to_bounds(seas);
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

/* What the picture's squared error is like that a leaf makes if all are sent as many photons: its part, by their density there. */
static double leaf_need(const Leaf *leaf)
{
    return leaf->weight * leaf_area(leaf);
}

/* Where the leaf is best split along one of the axes: so that the roots of both halves' needs have the least sum, which is as the root
 * of the squared error. *less: by how much that is less than the leaf's; 0: it cannot be split. */
static double best_split(const Seas *seas, const Leaf *leaf, int k, double narrowest, double *less)
{
    enum { BINS = 64 };
    double weights[BINS] = {0}, low = leaf->low[k], width = leaf->high[k] - low, sum = 0, best = low;
    *less = 0;
    if (leaf->end - leaf->begin < LEAST_LANDINGS || !(width > 2 * narrowest)) return best;
    for (uint32_t i = leaf->begin; i < leaf->end; i++) {
        double bin = (seas->landings[i].along[seas->level[k]] - low) / width * BINS;
        weights[bin > 0 ? (bin < BINS ? (int)bin : BINS - 1) : 0] += seas->landings[i].weight;
    }
    for (int i = 1; i < BINS; i++) {
        sum += weights[i - 1];
        double part = (double)i / BINS;
        if (fmin(part, 1 - part) * width < narrowest) continue;
        double roots = sqrt(sum * part) + sqrt(fmax(leaf->weight - sum, 0) * (1 - part)),
               saved = (sqrt(leaf->weight) - roots) * sqrt(leaf_area(leaf));
        if (saved > *less) *less = saved, best = low + part * width;
    }
    return best;
}

static void split_leaf(const Seas *seas, Leaf *leaf, Leaf *other, int k, double at)
{
    uint32_t middle = leaf->begin;
    for (uint32_t i = leaf->begin; i < leaf->end; i++) {
        if (!(seas->landings[i].along[seas->level[k]] < at)) continue;
        Landing below = seas->landings[i];
        seas->landings[i] = seas->landings[middle];
        seas->landings[middle++] = below;
    }
    *other = *leaf;
    leaf->end = other->begin = middle;
    leaf->high[k] = other->low[k] = at;
    leaf->weight = weight_of(seas->landings + leaf->begin, leaf->end - leaf->begin);
    other->weight = weight_of(seas->landings + other->begin, other->end - other->begin);
}

/* Splits what is gained the most by, again and again. */
static uint32_t split_all(const Seas *seas, double depth, Leaf leaves[SEEN_TILES])
{
    double at[SEEN_TILES][2], less[SEEN_TILES][2];
    for (uint32_t n = 1, changed[2] = {0, 0};; n++) {
        uint32_t best = 0;
        int axis = 0;
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 2; k++)
                at[changed[i]][k] = best_split(seas, &leaves[changed[i]], k, NARROWEST * depth, &less[changed[i]][k]);
        for (uint32_t i = 0; i < n; i++)
            for (int k = 0; k < 2; k++)
                if (less[i][k] > less[best][axis]) best = i, axis = k;
        if (n == SEEN_TILES || !(less[best][axis] > 0)) return n;
        split_leaf(seas, &leaves[best], &leaves[n], axis, at[best][axis]);
        changed[0] = best;
        changed[1] = n;
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

/* How far things are near by that the sea may mirror light to, or that may stand in its way. */
static void bounds_around(const Seas *seas, const Leaf *whole, double low[2], double high[2])
{
    Box3 things = rtc_scene_bounds(seas->world->compiled->rtc);
    double from[3], to[3];
    for (int k = 0; k < 2; k++) {
        low[k] = seas->endless ? whole->low[k] : seas->from[seas->level[k]];
        high[k] = seas->endless ? whole->high[k] : seas->to[seas->level[k]];
    }
    if (box3_is_empty(things) || !seas->endless) return;
    coordinates(things.min, from);
    coordinates(things.max, to);
    for (int k = 0; k < 2; k++) {
        double margin = to[seas->up] - from[seas->up], size = whole->high[k] - whole->low[k];
        low[k] = fmax(fmin(from[seas->level[k]] - margin, whole->low[k]), whole->low[k] - size);
        high[k] = fmin(fmax(to[seas->level[k]] + margin, whole->high[k]), whole->high[k] + size);
    }
}

/* Around what is seen, up to those bounds. around: the part of the photons. */
static void add_around(const Seas *seas, const Leaf *whole, const double heights[2], double density, double around,
                       PhotonTile *tiles, uint32_t *n)
{
    double low[2], high[2], area = 0;
    bounds_around(seas, whole, low, high);
    Leaf strips[4] = {{.low = {low[0], low[1]}, .high = {whole->low[0], high[1]}},
                      {.low = {whole->high[0], low[1]}, .high = {high[0], high[1]}},
                      {.low = {whole->low[0], low[1]}, .high = {whole->high[0], whole->low[1]}},
                      {.low = {whole->low[0], whole->high[1]}, .high = {whole->high[0], high[1]}}};
    for (int i = 0; i < 4; i++) area += leaf_area(&strips[i]);
    if (!(area > 0)) return;
    for (uint32_t i = 0; i < *n; i++) tiles[i].part *= 1 - around;
    for (int i = 0; i < 4; i++) {
        double part = around * leaf_area(&strips[i]) / area;
        strips[i].weight = part * whole->weight;
        if (part > 0) tiles[(*n)++] = tile_of(seas, &strips[i], heights, density, part);
    }
}

/* Which part of the photons is to go around the leaves of a wide object, so that the squared error of the picture is least; 0: it
 * is hardly less than if they went to all of it alike. That error is, where photons lie by a density, as one over it; of places
 * seen elsewhere, to which any part of the object may send light, that is the density around. */
static double part_around(const Seas *seas, const Leaf *leaves, uint32_t n, double weights)
{
    double roots = 0, all = weights + seas->elsewhere, area = 1;
    for (int k = 0; k < 2; k++) area *= seas->to[seas->level[k]] - seas->from[seas->level[k]];
    for (uint32_t i = 0; i < n; i++) roots += sqrt(leaf_need(&leaves[i]));
    double of_seen = roots / sqrt(all), of_elsewhere = sqrt(CAST_ELSEWHERE * seas->elsewhere / all * area);
    double part = fmax(of_elsewhere / (of_seen + of_elsewhere), AROUND_PART);
    double error = of_seen * of_seen / (1 - part) + of_elsewhere * of_elsewhere / part,
           alike = area * weights / all + of_elsewhere * of_elsewhere;
    return error < WORTH_SPLITTING * alike ? part : 0;
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
        if (seas->endless) continue;
        whole.low[k] = fmax(whole.low[k], seas->from[seas->level[k]]);
        whole.high[k] = fmin(whole.high[k], seas->to[seas->level[k]]);
    }
    if (!(leaf_area(&whole) > 0)) return;
    leaves[0] = whole;
    double slack = 1e-3 * fmax(heights[1] - heights[0], 1e-3 * sqrt(leaf_area(&whole)));
    heights[0] -= slack; /* so that no surface lies in a face */
    heights[1] += slack;
    *n = split_all(seas, heights[1] - heights[0], leaves);
    for (uint32_t i = 0; i < *n; i++) leaves[i].weight = fmax(leaves[i].weight, LEAST_SEEN * whole.weight);
    double around = seas->endless ? AROUND_PART : part_around(seas, leaves, *n, whole.weight);
    if (!(around > 0)) {
        *n = 0;
        return;
    }
    double density = usual_density(leaves, *n, whole.weight);
    share_out(seas, leaves, *n, heights, density, tiles);
    add_around(seas, &whole, heights, density, around, tiles, n);
}

bool photon_is_wide(Box3 bounds)
{
    Vec3 size = vec3_sub(bounds.max, bounds.min);
    return fmax(size.x, fmax(size.y, size.z)) > WIDE * fmin(size.x, fmin(size.y, size.z));
}

Status photon_sea_tiles(const World *world, const PhotonSea *sea, PhotonTile tiles[PHOTON_TILES], uint32_t *n, int *up,
                        Error *error)
{
    Seas of = {.world = world, .are = sea->objects, .endless = box3_is_empty(sea->bounds)};
    coordinates(sea->bounds.min, of.from);
    coordinates(sea->bounds.max, of.to);
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

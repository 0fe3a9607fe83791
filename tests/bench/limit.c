/* limit.c - how far a render is from the least that its rays can cost.
 *
 * The linker puts __wrap_rtc_nearest and __wrap_rtc_all in place of the two questions that a render asks of the
 * geometry (see the Makefile). They note the rays, in order. The rays are then cast again through bare rtcIntersect1 and
 * rtcOccluded1, robust as in the render, on triangles alone: no callback, no list, no double precision, nothing done
 * with the answer. Meshes are as they are in the scene, those that are placed again and again as instances; analytic pieces,
 * which Embree has no notion of, become triangles. So the replay is what a renderer would pay that does nothing but find the
 * surfaces of a tessellated scene. How many of the answers agree with the render's is printed, too: the replay is worth as much as
 * that; and what the same rays take when they are asked again as the render asks them, exactly and past silent surfaces, without
 * anything being done with the answers: what is beyond that is the list, shading, sampling, light and film. What the whole ratio
 * would be if the render cast its rays in packets of eight, all from different paths, and that made nothing else slower, is the
 * least that many paths in flight could come to (by free packets). Last come paths a second of one thread's time: the render's,
 * and what they would be if a renderer did nothing but cast these rays, one by one and in packets.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/attr.h"
#include "base/clock.h"
#include "measure.h"
#include "packets.h"

/* ---- noting rays ---- */

/* A question as the render asked it. */
typedef struct Question {
    Ray ray;
    Hit left[2]; /* what it starts on; rays that start on more are not kept, which are few */
    bool any, stop_at_opaque;
} Question;

typedef struct Notes {
    NotedRay *items;
    size_t n, capacity;
    Question *questions;
    size_t n_questions, questions_capacity, n_asked; /* n_asked: with those that are not kept */
    /* of each object: how far from its start a ray begins that leaves it, so as not to meet it again */
    const double *steps;
} Notes;

static Notes *notes; /* while a render is noted, by one thread */

size_t __real_rtc_nearest(const RtcScene *scene, const Ray *ray, HitList *hits, HitList *passed);
bool __real_rtc_all(const RtcScene *scene, const Ray *ray, bool stop_at_opaque, HitList *hits);
size_t __wrap_rtc_nearest(const RtcScene *scene, const Ray *ray, HitList *hits, HitList *passed);
bool __wrap_rtc_all(const RtcScene *scene, const Ray *ray, bool stop_at_opaque, HitList *hits);

static void note(const Ray *ray, bool any, double met)
{
    if (!array_reserve(&notes->items, &notes->capacity, notes->n + 1, sizeof *notes->items)) bench_fail("memory", NULL);
    double step = ray->t_min > 0 ? 1e-5 * ray->t_min : 0;
    for (size_t i = 0; i < ray->n_left; i++) step = fmax(step, notes->steps[ray->left[i].object]);
    /* a light is no obstacle itself */
    double far = ray->target == RTC_NO_OBJECT ? ray->t_max : ray->t_max * (1 - 1e-4) - notes->steps[ray->target];
    notes->items[notes->n++] = (NotedRay){{(float)ray->origin.x, (float)ray->origin.y, (float)ray->origin.z},
                                          {ray->direction.x, ray->direction.y, ray->direction.z},
                                          (float)(ray->t_min + step),
                                          (float)far,
                                          (float)met,
                                          (float)(0.02 * met + 4 * step),
                                          any};
}

static void keep_question(const Ray *ray, bool any, bool stop_at_opaque)
{
    Question question = {.ray = *ray, .any = any, .stop_at_opaque = stop_at_opaque};
    notes->n_asked++;
    if (ray->n_left > COUNT_OF(question.left)) return;
    if (!array_reserve(&notes->questions, &notes->questions_capacity, notes->n_questions + 1, sizeof question))
        bench_fail("memory", NULL);
    for (size_t i = 0; i < ray->n_left; i++) question.left[i] = ray->left[i];
    notes->questions[notes->n_questions++] = question;
}

size_t __wrap_rtc_nearest(const RtcScene *scene, const Ray *ray, HitList *hits, HitList *passed)
{
    if (notes) keep_question(ray, false, false);
    size_t n = __real_rtc_nearest(scene, ray, hits, passed);
    if (!notes) return n;
    /* what a ray passes by in one search is a ray from surface to surface to bare Embree */
    Ray part = *ray;
    for (size_t i = 0; passed && i < passed->n; i++) {
        note(&part, false, passed->items[i].t);
        part.t_min = passed->items[i].t;
    }
    note(&part, false, n ? hits->items[0].t : HUGE_VAL);
    return n;
}

bool __wrap_rtc_all(const RtcScene *scene, const Ray *ray, bool stop_at_opaque, HitList *hits)
{
    if (notes) keep_question(ray, true, stop_at_opaque);
    bool clear = __real_rtc_all(scene, ray, stop_at_opaque, hits);
    if (notes) note(ray, true, clear && hits->n == 0 ? HUGE_VAL : 0);
    return clear;
}

/* ---- the scene as triangles ---- */

/* A mesh that is placed again and again is one scene of Embree's. */
enum { MOST_COPIES = 8 };
typedef struct Placing {
    uint32_t shape;
    Affine to_world;
} Placing;

typedef struct Soup {
    Placing *placings;
    size_t n_placings, placings_capacity;
    Vec3f *vertices;
    uint32_t (*triangles)[3];
    size_t n_vertices, n_triangles, vertices_capacity, triangles_capacity;
    double reach;  /* how large the scene is */
    double *steps; /* of each object; see Notes */
    bool pieces;   /* some of it was analytic */
} Soup;

static uint32_t soup_vertex(Soup *soup, Vec3 p)
{
    if (!array_reserve(&soup->vertices, &soup->vertices_capacity, soup->n_vertices + 2, sizeof *soup->vertices))
        bench_fail("memory", NULL);
    soup->vertices[soup->n_vertices] = vec3f_from(p);
    return (uint32_t)soup->n_vertices++;
}

static void soup_triangle(Soup *soup, uint32_t a, uint32_t b, uint32_t c)
{
    if (!array_reserve(&soup->triangles, &soup->triangles_capacity, soup->n_triangles + 1, sizeof *soup->triangles))
        bench_fail("memory", NULL);
    uint32_t *triangle = soup->triangles[soup->n_triangles++];
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

static void add_mesh(Soup *soup, const Mesh *mesh, const Affine *to_world)
{
    uint32_t first = (uint32_t)soup->n_vertices;
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        soup_vertex(soup, affine_point(to_world, vec3_from_f(mesh->positions[i])));
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *t = mesh->triangles[i];
        soup_triangle(soup, first + t[0], first + t[1], first + t[2]);
    }
}

/* How many corners a piece has around its axis: fewer where it is small. */
static int corners_around(const Soup *soup, const Piece *piece, const Affine *to_world, double *radius)
{
    *radius = vec3_length(affine_vector(to_world, vec3(piece_bounds(piece).max.x, 0, 0)));
    double part = *radius / soup->reach;
    return piece->kind == PIECE_RECT ? 1 : part > 0.02 ? 192 : part > 0.002 ? 48 : 16;
}

/* A grid over the surface coordinates; pieces that share an edge share its corners. Returns how far its triangles can be
 * off the surface. */
static double add_piece(Soup *soup, const Piece *piece, const Affine *to_world)
{
    if (piece->kind == PIECE_PLANE) {
        double h = 1000 * soup->reach;
        uint32_t corner[4];
        for (int i = 0; i < 4; i++)
            corner[i] = soup_vertex(soup, affine_point(to_world, vec3(i & 1 ? h : -h, 0, i & 2 ? h : -h)));
        soup_triangle(soup, corner[0], corner[1], corner[2]);
        soup_triangle(soup, corner[1], corner[3], corner[2]);
        return 1e-7 * h;
    }
    double radius;
    bool straight = piece->kind == PIECE_BAND || piece->kind == PIECE_RECT;
    int around = corners_around(soup, piece, to_world, &radius);
    int along = straight ? 1 : piece->kind == PIECE_SPHERE || piece->kind == PIECE_TORUS ? around / 3 : 6;
    uint32_t first = (uint32_t)soup->n_vertices, row = (uint32_t)around + 1;
    for (int i = 0; i <= along; i++)
        for (int k = 0; k <= around; k++) {
            Vec3 normal;
            soup_vertex(soup,
                        affine_point(to_world, piece_sample(piece, (double)i / along, (double)k / around, &normal)));
        }
    for (uint32_t i = 0; i < (uint32_t)along; i++)
        for (uint32_t k = 0; k < (uint32_t)around; k++) {
            uint32_t a = first + i * row + k;
            soup_triangle(soup, a, a + 1, a + row);
            soup_triangle(soup, a + 1, a + row + 1, a + row);
        }
    return around > 1 ? radius * (1 - cos(3.14159 / around)) : 0;
}

/* The mesh of an object. */
static void place_mesh(Soup *soup, const CompiledScene *compiled, uint32_t object, const uint32_t *n_placed)
{
    const SceneObject *placed = &compiled->scene->objects[object];
    if (n_placed[placed->shape] <= MOST_COPIES) {
        add_mesh(soup, compiled->scene->shapes[placed->shape].mesh, &placed->to_world);
        return;
    }
    if (!array_reserve(&soup->placings, &soup->placings_capacity, soup->n_placings + 1, sizeof *soup->placings))
        bench_fail("memory", NULL);
    soup->placings[soup->n_placings++] = (Placing){placed->shape, placed->to_world};
}

static void soup_from_scene(Soup *soup, const CompiledScene *compiled)
{
    *soup = (Soup){0};
    uint32_t *n_placed = calloc(compiled->scene->n_shapes + 1U, sizeof *n_placed);
    Box3 bounds = rtc_scene_bounds(compiled->rtc);
    soup->reach = fmax(vec3_max_abs(bounds.min), vec3_max_abs(bounds.max));
    if (!isfinite(soup->reach)) soup->reach = 1;
    soup->steps = calloc(compiled->scene->n_objects, sizeof *soup->steps);
    if (!soup->steps || !n_placed) bench_fail("memory", NULL);
    for (uint32_t i = 0; i < compiled->scene->n_objects; i++)
        if (compiled->scene->objects[i].shape != SCENE_NONE) n_placed[compiled->scene->objects[i].shape]++;
    for (uint32_t i = 0; i < compiled->scene->n_objects; i++) {
        const SceneObject *object = &compiled->scene->objects[i];
        if (object->shape == SCENE_NONE) continue;
        const SceneShape *shape = &compiled->scene->shapes[object->shape];
        soup->steps[i] = 1e-5 * soup->reach;
        if (shape->mesh) place_mesh(soup, compiled, i, n_placed);
        for (uint32_t k = 0; shape->solid && k < shape->solid->n_pieces; k++) {
            double off = add_piece(soup, &shape->solid->pieces[k], &object->to_world);
            soup->steps[i] = fmax(soup->steps[i], 2 * off);
            soup->pieces = true;
        }
        /* a ray may be aimed at any point of a ball that shines, and ends before the ball */
        if (object->light != SCENE_NONE && compiled->scene->lights[object->light].kind == LIGHT_SPHERE)
            soup->steps[i] = 2 * compiled->scene->lights[object->light].half_width;
    }
    free(n_placed);
}

/* All of it in Embree. */
static RTCScene soup_scene(const Soup *soup, const CompiledScene *compiled, RTCDevice device)
{
    RTCScene world =
        bare_scene(device, soup->vertices, soup->n_vertices, (const uint32_t(*)[3])soup->triangles, soup->n_triangles);
    RTCScene *meshes = calloc(compiled->scene->n_shapes + 1U, sizeof(RTCScene));
    if (!meshes) bench_fail("memory", NULL);
    for (size_t i = 0; i < soup->n_placings; i++) {
        const Placing *placing = &soup->placings[i];
        RTCScene *mesh = &meshes[placing->shape];
        float map[12];
        for (int k = 0; k < 9; k++) map[k] = (float)placing->to_world.m[k % 3][k / 3];
        const Vec3 *t = &placing->to_world.t;
        map[9] = (float)t->x, map[10] = (float)t->y, map[11] = (float)t->z;
        if (!*mesh) *mesh = bare_mesh(device, compiled->scene->shapes[placing->shape].mesh);
        RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance, *mesh);
        rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, map);
        rtcCommitGeometry(instance);
        rtcAttachGeometry(world, instance);
        rtcReleaseGeometry(instance);
    }
    for (uint32_t i = 0; i < compiled->scene->n_shapes; i++)
        if (meshes[i]) rtcReleaseScene(meshes[i]); /* the instances hold them */
    free(meshes);
    rtcCommitScene(world);
    return world;
}

static void soup_clear(Soup *soup)
{
    free(soup->placings);
    free(soup->vertices);
    free(soup->triangles);
    free(soup->steps);
}

/* ---- casting them again ---- */

typedef struct Replay {
    RTCScene scene;
    const Notes *notes;
    unsigned n_threads;
    size_t agreed[64]; /* of each thread */
} Replay;

static struct RTCRay ray_again(const NotedRay *noted)
{
    return (struct RTCRay){.org_x = noted->origin[0],
                           .org_y = noted->origin[1],
                           .org_z = noted->origin[2],
                           .dir_x = noted->direction[0],
                           .dir_y = noted->direction[1],
                           .dir_z = noted->direction[2],
                           .tnear = noted->t_near,
                           .tfar = noted->t_far,
                           .mask = 0xffffffffU};
}

static void replay_share(void *context, uint32_t index, unsigned worker)
{
    (void)worker;
    Replay *replay = context;
    EmbreeContext embree;
    embree_init_context(&embree);
    size_t n = replay->notes->n, first = n * index / replay->n_threads, last = n * (index + 1) / replay->n_threads,
           agreed = 0;
    for (size_t i = first; i < last; i++) {
        const NotedRay *noted = &replay->notes->items[i];
        if (noted->any) {
            struct RTCRay ray = ray_again(noted);
            embree_occluded(replay->scene, &embree, &ray);
            agreed += (ray.tfar < 0) == (noted->met <= 0);
        } else {
            struct RTCRayHit ray = {.ray = ray_again(noted)};
            ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            embree_intersect(replay->scene, &embree, &ray);
            bool met = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
            agreed += met ? fabsf(ray.ray.tfar - noted->met) <= noted->tolerance : isinf(noted->met) != 0;
        }
    }
    replay->agreed[index] = agreed;
}

/* Seconds of the processor; the part of the answers that are the render's. */
static double replay_all(Replay *replay, Pool *pool, double *agreed)
{
    replay->n_threads = pool_threads(pool);
    double start = clock_cpu_s();
    pool_run(pool, replay->n_threads, replay_share, replay);
    double seconds = clock_cpu_s() - start;
    size_t sum = 0;
    for (unsigned i = 0; i < replay->n_threads; i++) sum += replay->agreed[i];
    *agreed = (double)sum / (double)(replay->notes->n ? replay->notes->n : 1);
    return seconds;
}

/* Seconds of the processor that the same questions take, by one thread; what is not kept counts like the rest. */
static double ask_again(const Notes *noted, const RtcScene *scene)
{
    HitList hits = {0}, passed = {0};
    double start = clock_cpu_s();
    for (size_t i = 0; i < noted->n_questions; i++) {
        Question *question = &noted->questions[i];
        question->ray.left = question->left;
        if (question->any)
            __real_rtc_all(scene, &question->ray, question->stop_at_opaque, &hits);
        else
            __real_rtc_nearest(scene, &question->ray, &hits, &passed);
    }
    double seconds = clock_cpu_s() - start;
    hit_list_clear(&hits);
    hit_list_clear(&passed);
    return seconds * (double)noted->n_asked / (double)(noted->n_questions ? noted->n_questions : 1);
}

/* ---- the figures ---- */

enum { WIDTH = 64, HEIGHT = 48, SAMPLES = 16 };

static void note_render(const CompiledScene *compiled, Notes *noted, Pool *one)
{
    notes = noted;
    RenderStats stats = render_at(compiled, WIDTH, HEIGHT, SAMPLES, one);
    notes = NULL;
    if (noted->n < stats.paths)
        bench_fail("the rays of a render were not noted: is the program linked with --wrap?", NULL);
}

static void limit_of(const char *path, RTCDevice device, Pool *pools[2])
{
    Made made;
    Soup soup;
    Notes noted = {0};
    made_from_file(&made, path);
    soup_from_scene(&soup, made.compiled);
    noted.steps = soup.steps;
    note_render(made.compiled, &noted, pools[0]);
    Replay replay = {.scene = soup_scene(&soup, made.compiled, device), .notes = &noted};
    Packets *packets = packets_new(noted.items, noted.n);
    if (!packets) bench_fail("memory", NULL);
    double ratio[2][RUNS], exact[RUNS], by_packets[RUNS], ray_ns[RUNS], rate[3][RUNS], agreed;
    RenderStats stats;
    for (int run = 0; run < RUNS; run++)
        for (int k = 0; k < 2; k++) {
            stats = render_at(made.compiled, WIDTH, HEIGHT, SAMPLES, pools[k]);
            double seconds = replay_all(&replay, pools[k], &agreed);
            ratio[k][run] = stats.cpu_seconds / seconds;
            if (k != 0) continue;
            ray_ns[run] = seconds / (double)noted.n * 1e9;
            exact[run] = ask_again(&noted, made.compiled->rtc) / seconds;
            double paths = (double)stats.paths * 1e-6, packed = packets_cast(packets, replay.scene);
            by_packets[run] = ratio[0][run] - 1 + packed / seconds;
            rate[0][run] = paths / stats.cpu_seconds;
            rate[1][run] = paths / seconds;
            rate[2][run] = paths / packed;
        }
    Quartiles one = spread_of(ratio[0], RUNS), two = spread_of(ratio[1], RUNS);
    printf("%-24s %-9s %6.2f (%.2f .. %.2f) %6.2f (%.2f .. %.2f) %6.2f %7.2f %6.2f %7.0f %7.1f %% %6.2f %6.2f %6.2f\n",
           file_name(path), soup.pieces ? "pieces" : "triangles", one.median, one.low, one.high, two.median, two.low,
           two.high, spread_of(exact, RUNS).median, spread_of(by_packets, RUNS).median,
           (double)noted.n / (double)stats.paths, spread_of(ray_ns, RUNS).median, 100 * agreed,
           spread_of(rate[0], RUNS).median, spread_of(rate[1], RUNS).median, spread_of(rate[2], RUNS).median);
    fflush(stdout);
    packets_free(packets);
    rtcReleaseScene(replay.scene);
    free(noted.items);
    free(noted.questions);
    soup_clear(&soup);
    made_clear(&made);
}

void bench_limit(char **paths, int n)
{
    RTCDevice device = rtcNewDevice(NULL);
    Pool *pools[2] = {pool_of(1), pool_of(2)};
    printf("a whole render in ratio to its own rays, replayed through bare Embree on triangles (goal: 1.5)\n");
    printf("%-24s %-9s %-22s %-22s %6s %7s %6s %7s %9s   million paths a second\n", "scene", "is of", "1 thread",
           "2 threads", "search", "by free", "rays", "ns", "answers");
    printf("%-24s %-9s %-22s %-22s %6s %7s %6s %7s %9s %6s %6s %6s\n", "", "", "", "", "alone", "packets", "a path",
           "replayed", "agree", "render", "bare", "by 8");
    for (int i = 0; i < n; i++) limit_of(paths[i], device, pools);
    pool_free(pools[0]);
    pool_free(pools[1]);
    rtcReleaseDevice(device);
}

void bench_paths(char **paths, int n)
{
    Pool *one = pool_of(1);
    printf("paths for each second of the processor\n");
    for (int i = 0; i < n; i++) {
        Made made;
        double rate[RUNS];
        RenderStats stats;
        made_from_file(&made, paths[i]);
        for (int run = 0; run < RUNS; run++) {
            const SceneFilm *film = &made.scene->film;
            stats = render_at(made.compiled, film->width, film->height, 4, one);
            rate[run] = (double)stats.paths / stats.cpu_seconds * 1e-6;
        }
        Quartiles spread = spread_of(rate, RUNS);
        printf("%-24s %6.3f million (%.3f .. %.3f), %.2f rays a path\n", file_name(paths[i]), spread.median, spread.low,
               spread.high, (double)stats.rays / (double)stats.paths);
        made_clear(&made);
    }
    pool_free(one);
}

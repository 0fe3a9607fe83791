/* rtc.c - tracing: Embree proposes, double precision decides.
 *
 * Each Embree call runs with a Query behind its context. Every candidate that Embree finds, in whatever order, goes
 * through consider_triangle() or consider_piece(), which compute its distance and direction in double and keep it when it may belong
 * to the answer. For the nearest cluster the search radius shrinks with the nearest candidate, but always
 * stays wider than everything that could stand at the same place as it.
 *
 * The ray that Embree sees starts a little behind the true one, so that a triangle right at the start is
 * proposed in spite of float rounding; whether it is in front of the start is then decided in double.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <stdlib.h>

#include "geom/rtc_scene.h"

/* A float has 24 bits. Coordinates are trusted to 4 units in the last place; Embree's distances to 16,
 * divided by the cosine; the start is moved back by 32,768, for surfaces that are left at a grazing angle. */
#define UNIT_ROUNDING 0x1p-23
#define TRUSTED_ULPS 4.0
#define EMBREE_NOISE 0x1p-20
#define START_BACK 0x1p-9
/* What double precision makes of a point on a surface. */
#define DOUBLE_NOISE 0x1p-42
/* Below this cosine a ray creeps along a curved surface, and is started off it by a step of double's rounding. */
#define CREEPING_COSINE 1e-4
/* Below this cosine the window for surfaces at one place grows no further. */
#define LEAST_COSINE 1e-4

typedef struct Query {
    EmbreeContext context; /* first: Embree hands it back by this address */
    const RtcScene *scene;
    const Ray *ray;
    Vec3 origin, direction;
    Vec3 line;      /* the origin of the float ray that Embree traces; the direction is the same */
    double back;    /* how far Embree's ray starts behind the true one */
    double scale;   /* coordinates of start and scene, for noise */
    double reach;   /* nearest query: candidates beyond do not matter any more */
    double least_window; /* nearest query: chains are followed at least that far */
    bool all, stop_at_opaque, blocked;
    HitList *hits;
    uint32_t cached_object; /* whose local ray is cached: pieces of one solid come in a row */
    Vec3 cached_origin, cached_direction;
    const Affine *cached_to_local; /* the object's own, or */
    Affine moved_to_local;
} Query;

void hit_list_clear(HitList *list)
{
    free(list->items);
    *list = (HitList){0};
}

static bool hit_list_room(HitList *list)
{
    if (LIKELY(list->n < list->capacity)) return true;
    size_t capacity = list->capacity ? list->capacity * 2 : 16;
    Hit *items = realloc(list->items, capacity * sizeof *items);
    if (!items) {
        list->out_of_memory = true;
        return false;
    }
    list->items = items;
    list->capacity = capacity;
    return true;
}

double rtc_rounding(Vec3 p)
{
    return TRUSTED_ULPS * UNIT_ROUNDING * vec3_max_abs(p);
}

/* How far behind a surface at distance t and cosine c another one can be and still be proposed by
 * Embree for a ray that must not lose it. */
static double window_behind(const Query *query, const Hit *hit)
{
    double cosine = fmax(fabs(hit->cos_normal), LEAST_COSINE);
    return fmax(query->least_window, (4 * hit->rounding + EMBREE_NOISE * (query->scale + hit->t)) / cosine);
}

/* The upper end of Embree's search, for what the true ray calls t. */
static float embree_t(const Query *query, double t)
{
    double far = t + query->back;
    far += EMBREE_NOISE * far;
    return far < (double)FLT_MAX ? (float)far : INFINITY;
}

/* Takes up a candidate that lies within the ray's range. Returns whether the search may now end at
 * query->reach (nearest) or at once (blocked). */
static bool keep(Query *query, const Hit *hit)
{
    if (query->all) {
        if (query->stop_at_opaque && query->scene->objects[hit->object].opaque) {
            const Ray *ray = query->ray;
            if (hit->object == ray->target &&
                (ray->target_primitive == RTC_NO_OBJECT || hit->primitive == ray->target_primitive))
                return false;
            query->blocked = true;
            return true;
        }
        if (hit_list_room(query->hits)) query->hits->items[query->hits->n++] = *hit;
        return false;
    }
    if (hit->t > query->reach) return false;
    if (hit_list_room(query->hits)) query->hits->items[query->hits->n++] = *hit;
    query->reach = fmin(query->reach, hit->t + window_behind(query, hit));
    return true;
}

/* Whether a candidate is the surface that the ray starts on: the same primitive, at the start to within the rounding of
 * double. The two crossings of a curved piece are told apart by their direction, however close they are. */
static bool is_left(const Query *query, uint32_t object, uint32_t primitive, double t, double cos_normal)
{
    for (size_t i = 0; i < query->ray->n_left; i++) {
        const Hit *left = &query->ray->left[i];
        if (left->object != object || left->primitive != primitive) continue;
        if (fabs(t * cos_normal) > DOUBLE_NOISE * (fmax(query->scale, query->ray->start_scale) + t)) continue;
        if (left->inside == (cos_normal < 0)) return true; /* entering where it is inside already */
    }
    return false;
}

static const uint32_t *triangle_of(const RtcPlaced *object, uint32_t primitive)
{
    return object->detail->triangles ? object->detail->triangles[primitive] : object->mesh->triangles[primitive];
}

static Vec3 local_corner(const RtcPlaced *object, uint32_t vertex, double time)
{
    Vec3 p = vec3_from_f(object->mesh->positions[vertex]);
    const Mesh *end = object->detail->mesh_end;
    return end ? vec3_add(vec3_scale(p, 1 - time), vec3_scale(vec3_from_f(end->positions[vertex]), time)) : p;
}

/* World-space corners in double; a mirrored instance has two of them swapped, so that the
 * counter-clockwise side is outside in any case. */
static void triangle_corners(const RtcScene *scene, const RtcPlaced *object, uint32_t primitive, double time, Vec3 corner[3])
{
    const uint32_t *triangle = triangle_of(object, primitive);
    const Vec3f *baked = object->detail->baked;
    if (baked) {
        for (int i = 0; i < 3; i++) corner[i] = vec3_from_f(baked[triangle[i]]);
    } else {
        Affine to_world = rtc_to_world(scene, object, time);
        for (int i = 0; i < 3; i++) corner[i] = affine_point(&to_world, local_corner(object, triangle[i], time));
    }
    if (!baked && object->mirrored) {
        Vec3 swap = corner[1];
        corner[1] = corner[2];
        corner[2] = swap;
    }
}

void rtc_triangle(const RtcScene *scene, uint32_t object, uint32_t primitive, double time, Vec3 corner[3])
{
    triangle_corners(scene, &scene->objects[object], primitive, time, corner);
}

/* Whether p, in the triangle's plane, is inside of it, edges included. */
static bool is_inside(const Vec3 corner[3], Vec3 normal, Vec3 p)
{
    for (int i = 0; i < 3; i++) {
        Vec3 edge = vec3_sub(corner[(i + 1) % 3], corner[i]);
        if (vec3_dot(vec3_cross(edge, vec3_sub(p, corner[i])), normal) < 0) return false;
    }
    return true;
}

/* Whether a plane is parallel to one that the ray starts on, as far as coordinates in float can tell. */
static bool is_parallel(const Ray *ray, Vec3 normal, double length)
{
    for (size_t i = 0; i < ray->n_left; i++) {
        Vec3 cross = vec3_cross(vec3_from_f(ray->left[i].normal), normal);
        if (vec3_dot(cross, cross) <= 1e-10 * length * length) return true;
    }
    return false;
}

/* Whether Embree's own line goes through the triangle. Embree accepts what is within its rounding of the edges, on
 * either side, which at a silhouette may let a surface be entered and not left. */
static bool line_hits(const Query *query, const Vec3 corner[3])
{
    Vec3 relative[3];
    for (int i = 0; i < 3; i++) relative[i] = vec3_sub(corner[i], query->line);
    double side[3];
    for (int i = 0; i < 3; i++) side[i] = vec3_dot(query->direction, vec3_cross(relative[i], relative[(i + 1) % 3]));
    return (side[0] >= 0 && side[1] >= 0 && side[2] >= 0) || (side[0] <= 0 && side[1] <= 0 && side[2] <= 0);
}

/* Where the ray starts in the very plane of a triangle, Embree's word for whether the triangle is met is not enough:
 * its float ray runs a little beside the exact one, and reaches that plane elsewhere. */
static bool consider_triangle(Query *query, uint32_t object_id, uint32_t primitive, float u, float v)
{
    const RtcPlaced *object = &query->scene->objects[object_id];
    Vec3 corner[3];
    triangle_corners(query->scene, object, primitive, query->ray->time, corner);
    Vec3 normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    double length = vec3_length(normal), slope = vec3_dot(normal, query->direction);
    if (!(length > 0) || slope == 0) return false; /* no area, or exactly in the ray's plane: not crossed */
    double t = vec3_dot(normal, vec3_sub(corner[0], query->origin)) / slope;
    if (!(t > query->ray->t_min && t <= query->ray->t_max)) return false;
    if (!query->all && t > query->reach) return false; /* keep() would refuse it; the rest costs more */
    if (query->ray->n_left && is_left(query, object_id, primitive, t, slope / length)) return false;
    double rounding = fmax(rtc_rounding(corner[0]), fmax(rtc_rounding(corner[1]), rtc_rounding(corner[2])));
    if (query->ray->n_left && t * fabs(slope / length) <= 2 * rounding && is_parallel(query->ray, normal, length) &&
        !is_inside(corner, normal, vec3_along(query->origin, t, query->direction)))
        return false;
    Hit hit = {.t = t, .object = object_id, .primitive = primitive, .entering = slope < 0,
               .normal = vec3f_from(vec3_scale(normal, 1 / length)), .cos_normal = slope / length,
               .rounding = rounding, .u = u, .v = v,
               .doubtful = object->detail->baked && !line_hits(query, corner)}; /* an instance is traced in its own frame */
    return keep(query, &hit);
}

static bool consider_piece(Query *query, RtcPiece which)
{
    const RtcPlaced *object = &query->scene->objects[which.object];
    const Piece *piece = &object->solid->pieces[which.piece];
    if (query->cached_object != which.object) {
        query->cached_object = which.object;
        if (object->maps && !object->detail->keys) {
            query->cached_to_local = &object->maps->to_local;
        } else {
            query->moved_to_local = rtc_to_local(query->scene, object, query->ray->time);
            query->cached_to_local = &query->moved_to_local;
        }
        query->cached_origin = affine_point(query->cached_to_local, query->origin);
        query->cached_direction = affine_vector(query->cached_to_local, query->direction);
    }
    double t[PIECE_MAX_ROOTS];
    double t_max = query->all ? query->ray->t_max : fmin(query->ray->t_max, query->reach);
    int n = piece_intersect(piece, query->cached_origin, query->cached_direction, query->ray->t_min, t_max, t);
    bool shrink = false;
    for (int i = 0; i < n; i++) {
        if (which.sector != RTC_ALL_SECTORS) {
            double x = query->cached_origin.x + t[i] * query->cached_direction.x;
            double z = query->cached_origin.z + t[i] * query->cached_direction.z;
            if (rtc_sector(x, z) != which.sector) continue;
        }
        Vec3 local = piece_normal(piece, query->cached_origin, query->cached_direction, t[i]);
        Vec3 normal = vec3_normalize(affine_normal(query->cached_to_local, local));
        double slope = vec3_dot(local, query->cached_direction); /* the sign that the piece itself sees */
        double cosine = vec3_dot(normal, query->direction);
        if (query->ray->n_left && is_left(query, which.object, which.piece, t[i], slope > 0 ? fabs(cosine) : -fabs(cosine))) continue;
        Vec3 p = vec3_along(query->origin, t[i], query->direction);
        Hit hit = {.t = t[i], .object = which.object, .primitive = which.piece, .entering = slope < 0,
                   .normal = vec3f_from(normal), .cos_normal = cosine,
                   .rounding = rtc_rounding(p) + 0x1p-44 * (query->scale + t[i])};
        shrink |= keep(query, &hit);
    }
    return shrink;
}

/* Only single rays are traced, so that Embree's arrays of N are these plain structs. */
static struct RTCRay *ray_of(struct RTCRayN *ray)
{
    return (struct RTCRay *)(void *)ray;
}

static bool consider_embree(Query *query, struct RTCHitN *embree_hit)
{
    const struct RTCHit *hit = (const struct RTCHit *)(const void *)embree_hit;
    uint32_t object = hit->instID[0] != RTC_INVALID_GEOMETRY_ID ? hit->instID[0] : hit->geomID;
    return consider_triangle(query, object, hit->primID, hit->u, hit->v);
}

void rtc_filter_nearest(const struct RTCFilterFunctionNArguments *arguments)
{
    Query *query = (Query *)(void *)arguments->context;
    if (consider_embree(query, arguments->hit))
        ray_of(arguments->ray)->tfar = embree_t(query, query->reach); /* accepted: the search goes on up to there */
    else
        arguments->valid[0] = 0;
}

void rtc_filter_any(const struct RTCFilterFunctionNArguments *arguments)
{
    if (!consider_embree((Query *)(void *)arguments->context, arguments->hit)) arguments->valid[0] = 0;
}

/* Around an eighth: the corners of its profile are extreme, as sine and cosine are monotonic in between. */
static Box3 sector_bounds(const Piece *piece, uint32_t sector)
{
    static const double half = 0.70710678118654757;
    static const double ends[RTC_SECTORS + 1][2] = {{1, 0}, {half, half}, {0, 1}, {-half, half}, {-1, 0},
                                                    {-half, -half}, {0, -1}, {half, -half}, {1, 0}};
    /* rtc_sector counts by quadrants and then by the larger coordinate: to the order of angles */
    static const uint32_t by_angle[RTC_SECTORS] = {0, 1, 3, 2, 4, 5, 7, 6};
    uint32_t k = by_angle[sector];
    HalfBox half_box = piece_half_bounds(piece);
    Box3 box = box3_empty();
    for (uint32_t end = k; end <= k + 1; end++) {
        box = box3_add_point(box, vec3(half_box.r0 * ends[end][0], half_box.y0, half_box.r0 * ends[end][1]));
        box = box3_add_point(box, vec3(half_box.r1 * ends[end][0], half_box.y1, half_box.r1 * ends[end][1]));
    }
    return box;
}

void rtc_piece_bounds(const struct RTCBoundsFunctionArguments *arguments)
{
    const RtcPieceSet *set = arguments->geometryUserPtr;
    const RtcScene *scene = set->scene;
    RtcPiece which = set->pieces[arguments->primID];
    const RtcPlaced *object = &scene->objects[which.object];
    const Piece *piece = &object->solid->pieces[which.piece];
    Box3 local = which.sector == RTC_ALL_SECTORS ? piece_bounds(piece) : sector_bounds(piece, which.sector);
    const Affine *keys = object->detail->keys;
    Affine to_world = keys ? keys[arguments->timeStep] : rtc_first_to_world(object);
    Box3 box = affine_box(&to_world, local);
    /* larger by more than Embree's float ray can run beside the exact one (rtc_leave) */
    double margin = 4 * TRUSTED_ULPS * UNIT_ROUNDING * scene->reach;
    arguments->bounds_o->lower_x = (float)(box.min.x - margin);
    arguments->bounds_o->lower_y = (float)(box.min.y - margin);
    arguments->bounds_o->lower_z = (float)(box.min.z - margin);
    arguments->bounds_o->upper_x = (float)(box.max.x + margin);
    arguments->bounds_o->upper_y = (float)(box.max.y + margin);
    arguments->bounds_o->upper_z = (float)(box.max.z + margin);
}

void rtc_piece_intersect(const struct RTCIntersectFunctionNArguments *arguments)
{
    Query *query = (Query *)(void *)arguments->context;
    const RtcPieceSet *set = arguments->geometryUserPtr;
    if (!arguments->valid[0]) return;
    if (consider_piece(query, set->pieces[arguments->primID])) {
        struct RTCRay *ray = &((struct RTCRayHit *)(void *)arguments->rayhit)->ray;
        ray->tfar = fminf(ray->tfar, embree_t(query, query->reach));
    } else {
        arguments->valid[0] = 0;
    }
}

void rtc_piece_occluded(const struct RTCOccludedFunctionNArguments *arguments)
{
    Query *query = (Query *)(void *)arguments->context;
    const RtcPieceSet *set = arguments->geometryUserPtr;
    if (!arguments->valid[0]) return;
    if (consider_piece(query, set->pieces[arguments->primID]))
        ray_of(arguments->ray)->tfar = -INFINITY;
    else
        arguments->valid[0] = 0;
}

/* Debian's Embree aborts on rays that are not finite or very far away. */
static bool usable(const Ray *ray)
{
    const double limit = 1e18;
    return vec3_max_abs(ray->origin) < limit && vec3_max_abs(vec3_from_f(ray->direction)) < limit &&
           vec3_is_finite(ray->origin) && vec3_is_finite(vec3_from_f(ray->direction)) && ray->t_min >= 0 && ray->t_min < limit;
}

static void query_init(Query *query, const RtcScene *scene, const Ray *ray, HitList *hits)
{
    embree_init_context(&query->context);
    query->scene = scene;
    query->ray = ray;
    query->origin = ray->origin;
    query->direction = vec3_from_f(ray->direction);
    query->scale = fmax(vec3_max_abs(query->origin), scene->reach);
    query->back = START_BACK * query->scale;
    query->reach = HUGE_VAL;
    query->least_window = 0;
    query->all = query->stop_at_opaque = query->blocked = false;
    query->hits = hits;
    query->cached_object = UINT32_MAX;
    hits->n = 0;
}

static void embree_ray(Query *query, struct RTCRay *ray)
{
    Vec3 origin = vec3_add(query->origin, query->ray->nudge);
    Vec3f start = vec3f_from(vec3_along(origin, -query->back, query->direction));
    query->line = vec3_from_f(start);
    ray->org_x = start.x;
    ray->org_y = start.y;
    ray->org_z = start.z;
    ray->dir_x = query->ray->direction.x;
    ray->dir_y = query->ray->direction.y;
    ray->dir_z = query->ray->direction.z;
    double near = query->ray->t_min > 0 ? query->ray->t_min * (1 - 16 * EMBREE_NOISE) - 16 * EMBREE_NOISE * query->scale : 0;
    ray->tnear = near > 0 ? (float)near : 0;
    ray->tfar = embree_t(query, fmin(query->ray->t_max, query->reach));
    ray->time = (float)query->ray->time;
    ray->mask = 0xffffffffU;
    ray->id = ray->flags = 0;
}

static int compare_hits(const void *left, const void *right)
{
    const Hit *a = left, *b = right;
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->object != b->object) return a->object < b->object ? -1 : 1;
    return a->primitive < b->primitive ? -1 : a->primitive > b->primitive;
}

/* By distance, then by number, so that the order does not depend on Embree's. */
static void sort_hits(HitList *hits)
{
    enum { FEW = 48 };
    if (hits->n > FEW) {
        qsort(hits->items, hits->n, sizeof *hits->items, compare_hits);
        return;
    }
    for (size_t i = 1; i < hits->n; i++) {
        Hit hit = hits->items[i];
        size_t place = i;
        while (place > 0 && compare_hits(&hits->items[place - 1], &hit) > 0) {
            hits->items[place] = hits->items[place - 1];
            place--;
        }
        hits->items[place] = hit;
    }
}

/* Each is nearer to the one before, along the normal, than coordinates can tell. Along the steeper normal, so that different
 * surfaces are kept apart; along the flatter one for the two sides of one object's edge, which the ray clips or misses
 * within rounding. */
size_t rtc_cluster(const Hit *hits, size_t n_hits)
{
    size_t n = n_hits ? 1 : 0;
    for (; n < n_hits; n++) {
        const Hit *a = &hits[n - 1], *b = &hits[n];
        double flat = fmin(fabs(a->cos_normal), fabs(b->cos_normal)), steep = fmax(fabs(a->cos_normal), fabs(b->cos_normal));
        bool edge = a->object == b->object && a->entering != b->entering;
        if ((b->t - a->t) * (edge ? fmax(flat, LEAST_COSINE) : steep) > fmax(a->rounding, b->rounding)) break;
    }
    return n;
}

/* Whether a hit is the crossing that the ray has just made, reported again by a neighbouring triangle: Embree's
 * float ray may pass on the other side of an edge than the exact one. It is within rounding of the plane that the ray
 * starts on, or the start is within rounding of its plane, and it enters (leaves) an object that the ray is already
 * inside (outside) of. To be asked of an object's first hit only: the next crossing goes the other way. */
static bool repeats_start(const Ray *ray, const Hit *hit)
{
    for (size_t i = 0; i < ray->n_left; i++) {
        const Hit *left = &ray->left[i];
        if (left->object != hit->object || left->inside != hit->entering) continue;
        double slope = vec3_dot(vec3_from_f(left->normal), vec3_from_f(ray->direction));
        if (hit->t * fmin(fabs(slope), fabs(hit->cos_normal)) <= 2 * hit->rounding) return true;
    }
    return false;
}

/* Takes such repetitions out of hits in increasing t; returns how many hits are left. */
static size_t drop_repeats(const Ray *ray, Hit *hits, size_t n)
{
    if (ray->t_min > 0) return n;
    for (size_t k = 0; k < ray->n_left; k++) {
        size_t first = 0;
        while (first < n && hits[first].object != ray->left[k].object) first++;
        if (first == n || !repeats_start(ray, &hits[first])) continue;
        n--;
        for (size_t i = first; i < n; i++) hits[i] = hits[i + 1];
    }
    return n;
}

size_t rtc_nearest(const RtcScene *scene, const Ray *ray, HitList *hits)
{
    Ray searched = *ray;
    Query query;
    query_init(&query, scene, &searched, hits);
    if (!usable(ray)) return 0;
    for (;;) {
        for (uint32_t i = 0; i < scene->n_planes; i++) consider_piece(&query, scene->planes[i]);
        struct RTCRayHit embree;
        embree_ray(&query, &embree.ray);
        embree.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        embree.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        embree_intersect(scene->world, &query.context, &embree);
        sort_hits(hits);
        size_t n = rtc_cluster(hits->items, hits->n);
        if (n == 0) return 0;
        /* A chain of surfaces may come near the end of the window; then look further. */
        const Hit *last = &hits->items[n - 1];
        double cosine = fmax(fabs(last->cos_normal), LEAST_COSINE);
        double end = last->t + 2 * last->rounding / cosine;
        if (n == 1 || end <= query.reach) {
            double behind = last->t;
            hits->n = drop_repeats(ray, hits->items, n);
            if (LIKELY(hits->n)) return hits->n;
            searched.t_min = behind; /* nothing but repetitions: look behind them */
            query_init(&query, scene, &searched, hits);
            continue;
        }
        double window = end - hits->items[0].t;
        query_init(&query, scene, &searched, hits);
        query.least_window = window;
    }
}

bool rtc_all(const RtcScene *scene, const Ray *ray, bool stop_at_opaque, HitList *hits)
{
    Query query;
    query_init(&query, scene, ray, hits);
    query.all = true;
    query.stop_at_opaque = stop_at_opaque;
    if (!usable(ray)) return true;
    for (uint32_t i = 0; i < scene->n_planes && !query.blocked; i++) consider_piece(&query, scene->planes[i]);
    if (query.blocked) return false;
    struct RTCRay embree;
    embree_ray(&query, &embree);
    embree_occluded(scene->world, &query.context, &embree);
    if (query.blocked) return false;
    sort_hits(hits);
    hits->n = drop_repeats(ray, hits->items, hits->n);
    return true;
}

bool rtc_is_plane(const RtcScene *scene, uint32_t object)
{
    const Solid *solid = scene->objects[object].solid;
    return solid && solid->pieces[0].kind == PIECE_PLANE;
}

bool rtc_below_plane(const RtcScene *scene, uint32_t object, Vec3 point, double time)
{
    Affine to_local = rtc_to_local(scene, &scene->objects[object], time);
    return affine_point(&to_local, point).y < 0;
}

static Vec3f interpolated_normal(const Mesh *mesh, const uint32_t triangle[3], const Hit *hit)
{
    Vec3f a = mesh->normals[triangle[0]], b = mesh->normals[triangle[1]], c = mesh->normals[triangle[2]];
    return vec3f_add(vec3f_scale(a, 1 - hit->u - hit->v), vec3f_add(vec3f_scale(b, hit->u), vec3f_scale(c, hit->v)));
}

/* Corner normals of the mesh interpolated, or the geometric normal where the mesh has none or where they point to the
 * other side. */
static Vec3f mesh_shading(const RtcPlaced *object, const Affine *to_local, double time, const Hit *hit)
{
    const Mesh *mesh = object->mesh;
    if (!mesh->normals) return hit->normal;
    const uint32_t *triangle = triangle_of(object, hit->primitive);
    Vec3f local = interpolated_normal(mesh, triangle, hit);
    const Mesh *mesh_end = object->detail->mesh_end;
    if (mesh_end && mesh_end->normals) {
        Vec3f end = interpolated_normal(mesh_end, triangle, hit);
        local = vec3f_add(vec3f_scale(local, 1 - (float)time), vec3f_scale(end, (float)time));
    }
    Vec3 world = affine_normal(to_local, vec3_from_f(local));
    double length = vec3_length(world);
    if (!(length > 0)) return hit->normal;
    Vec3f shading = vec3f_from(vec3_scale(world, 1 / length));
    return vec3f_dot(shading, hit->normal) > 0 ? shading : hit->normal;
}

void rtc_surface(const RtcScene *scene, const Ray *ray, const Hit *hit, HitSurface *surface)
{
    const RtcPlaced *object = &scene->objects[hit->object];
    Affine to_local = rtc_to_local(scene, object, ray->time);
    surface->position = ray_point(ray, hit->t);
    if (object->mesh) {
        surface->shading = mesh_shading(object, &to_local, ray->time, hit);
        surface->uv[0] = hit->u;
        surface->uv[1] = hit->v;
        return;
    }
    PieceRoot root;
    piece_surface(&object->solid->pieces[hit->primitive], affine_point(&to_local, ray->origin),
                  affine_vector(&to_local, vec3_from_f(ray->direction)), hit->t, &root);
    Vec3f shading = vec3f_from(vec3_normalize(affine_normal(&to_local, root.shading)));
    surface->shading = vec3f_dot(shading, hit->normal) > 0 ? shading : hit->normal;
    surface->uv[0] = (float)root.u;
    surface->uv[1] = (float)root.v;
}

/* p moved towards the middle of the triangle until it is `margin` away from every edge. */
static Vec3 triangle_inset(const RtcScene *scene, const Hit *hit, double time, Vec3 p, double margin)
{
    Vec3 corner[3];
    triangle_corners(scene, &scene->objects[hit->object], hit->primitive, time, corner);
    Vec3 normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    double area = vec3_length(normal), blend = 0;
    for (int i = 0; i < 3; i++) {
        Vec3 a = corner[(i + 1) % 3], edge = vec3_sub(corner[(i + 2) % 3], a);
        double edge_length = vec3_length(edge);
        double distance = vec3_dot(vec3_cross(edge, vec3_sub(p, a)), normal) / (edge_length * area);
        double middle = area / edge_length / 3; /* of the centroid from this edge */
        if (distance >= margin) continue;
        blend = fmax(blend, middle > margin ? (margin - distance) / (middle - distance) : 1);
    }
    if (!(blend > 0)) return p;
    Vec3 centroid = vec3_scale(vec3_add(corner[0], vec3_add(corner[1], corner[2])), 1.0 / 3);
    return vec3_along(p, fmin(blend, 1), vec3_sub(centroid, p));
}

/* Keeps the first hit of each object; returns how many. */
static size_t one_per_object(Hit *hits, size_t n)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        size_t k = 0;
        while (k < kept && hits[k].object != hits[i].object) k++;
        if (k == kept) hits[kept++] = hits[i];
    }
    return kept;
}

Ray rtc_leave(const RtcScene *scene, const Ray *ray, Hit *hits, size_t *n, bool through, Vec3f direction)
{
    if (*n > 1) *n = one_per_object(hits, *n);
    const Hit *hit = through ? &hits[*n - 1] : &hits[0];
    Ray next = ray_make(ray_point(ray, hit->t), direction);
    next.time = ray->time;
    next.left = hits;
    next.n_left = *n;
    next.start_scale = vec3_max_abs(ray->origin) + hit->t;
    /* Embree's float ray runs a little off the surface that the exact ray starts on, on the right side of the triangle
     * and of its neighbours, so that it meets what the exact ray meets. Pieces have their edges in double. */
    double margin = 0.5 * hit->rounding;
    for (size_t i = 0; i < *n; i++) {
        if (scene->objects[hits[i].object].mesh)
            next.origin = triangle_inset(scene, &hits[i], ray->time, next.origin, margin);
    }
    for (size_t i = 0; i < *n; i++) {
        Vec3 normal = vec3_from_f(hits[i].normal), from_surface = vec3_sub(next.origin, ray_point(ray, hits[i].t));
        double height = vec3_dot(from_surface, normal), slope = vec3_dot(normal, vec3_from_f(direction));
        bool on_surface = fabs(height) <= DOUBLE_NOISE * next.start_scale + UNIT_ROUNDING * vec3_length(from_surface);
        hits[i].inside = on_surface ? slope < 0 : height < 0;
    }
    Vec3 normal = vec3_from_f(hit->normal);
    next.nudge = vec3_scale(normal, hit->inside ? -margin : margin);
    /* The chord of a creeping ray may rise less above the surface than double can tell, and would then not be seen to
     * end. */
    if (scene->objects[hit->object].solid && fabs(vec3_dot(normal, vec3_from_f(direction))) < CREEPING_COSINE)
        next.origin = vec3_along(next.origin, (hit->inside ? -0.25 : 0.25) * DOUBLE_NOISE * next.start_scale, normal);
    return next;
}

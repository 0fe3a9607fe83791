/* rtc_hit.c - a hit in double precision: where it is, which way it is crossed, its surface, and the ray that leaves it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_query.h"

/* Below this cosine a ray creeps along a curved surface, and is started off it by a step of double's rounding. */
#define CREEPING_COSINE 1e-4
/* A ray that comes to a surface within so many roundings of where it left one is in a wedge between the two, and nearer to its edge
 * than their coordinates tell. */
#define WEDGE 16
/* What Embree's barycentric coordinates can be off by, of the ratio of a triangle's length, times the distance, to its
 * area as the ray sees it: some roundings of float. */
#define EDGE_NOISE 0x1p-19

/* Whether a candidate is the surface that the ray starts on: the same primitive, at the start to within the rounding of
 * double. The two crossings of a curved piece are told apart by their direction, however close they are. */
static inline bool is_left(const Query *query, uint32_t object, uint32_t primitive, double t, double cos_normal)
{
    const Ray *ray = query->ray;
    if (LIKELY(fabs(t * cos_normal) > DOUBLE_NOISE * (double_max(query->scale, ray->start_scale) + t))) return false;
    for (size_t i = 0; i < ray->n_left; i++) {
        const Hit *left = &ray->left[i];
        if (left->object != object || left->primitive != primitive) continue;
        if (left->inside == (cos_normal < 0)) return true; /* entering where it is inside already */
    }
    return false;
}

static Vec3 between(Vec3 begin, Vec3 end, double time)
{
    return vec3_add(vec3_scale(begin, 1 - time), vec3_scale(end, time));
}

static Vec3 local_corner(const RtcMesh *mesh, const RtcQuad *quad, uint32_t k, double time)
{
    Vec3 p = vec3_from_f(quad->corner[k]);
    if (!mesh->end) return p;
    return between(p, vec3_from_f(mesh->end->positions[quad->vertex[k]]), time);
}

/* In world space; a mirrored instance has two of them swapped, so that the counter-clockwise side is outside in any
 * case. */
typedef struct Corners {
    Vec3 a, b, c;
} Corners;

static Corners instance_corners(const RtcScene *scene, const RtcPlaced *object, const RtcQuad *quad, uint32_t half,
                                double time)
{
    Affine to_world = rtc_to_world(scene, object, time);
    Vec3 a = affine_point(&to_world, local_corner(object->mesh, quad, mesh_quad_corner(half, 0), time));
    Vec3 b = affine_point(&to_world, local_corner(object->mesh, quad, mesh_quad_corner(half, 1), time));
    Vec3 c = affine_point(&to_world, local_corner(object->mesh, quad, mesh_quad_corner(half, 2), time));
    return object->mirrored ? (Corners){a, c, b} : (Corners){a, b, c};
}

/* Corners are never an array where it is in a hurry: what is written to memory number by number and read in pairs has to be
 * waited for. */
static inline Corners triangle_corners(const RtcScene *scene, const RtcPlaced *object, uint32_t primitive, double time)
{
    const RtcQuad *quad = &object->mesh->quads[primitive / 2];
    uint32_t half = primitive % 2;
    if (UNLIKELY(!object->mesh->baked)) return instance_corners(scene, object, quad, half, time);
    return (Corners){vec3_from_f(quad->corner[mesh_quad_corner(half, 0)]),
                     vec3_from_f(quad->corner[mesh_quad_corner(half, 1)]),
                     vec3_from_f(quad->corner[mesh_quad_corner(half, 2)])};
}

uint32_t rtc_n_primitives(const RtcScene *scene, uint32_t object)
{
    const RtcPlaced *placed = &scene->objects[object];
    return placed->is_mesh ? 2 * placed->mesh->n_quads : placed->solid ? (uint32_t)placed->solid->n_pieces : 0;
}

void rtc_triangle(const RtcScene *scene, uint32_t object, uint32_t primitive, double time, Vec3 corner[3])
{
    Corners of_triangle = triangle_corners(scene, &scene->objects[object], primitive, time);
    corner[0] = of_triangle.a;
    corner[1] = of_triangle.b;
    corner[2] = of_triangle.c;
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

/* Whether a hit is so far from the triangle's edges that no rounding of float takes it to another one. Embree's own weights
 * tell it of nearly all. */
static inline bool is_clear(const Query *query, const Hit *hit, Vec3 edge1, Vec3 edge2, double slope, double scale)
{
    float least = hit->u < hit->v ? hit->u : hit->v, third = 1 - hit->u - hit->v;
    double nearest = (double)(third < least ? third : least);
    double length = fabs(edge1.x) + fabs(edge1.y) + fabs(edge1.z) + fabs(edge2.x) + fabs(edge2.y) + fabs(edge2.z);
    return LIKELY(nearest * fabs(slope) > EDGE_NOISE * length * scale) || rtc_line_is_clear(query, hit, scale);
}

/* A face whose coordinates are so many times as large as those of a place on it: see rtc_coordinate_across. */
#define LARGE_FACE 8

static double largest_of(double a, double b, double c)
{
    return double_max(fabs(a), double_max(fabs(b), fabs(c)));
}

/* The largest coordinates of three points along each axis, as far as an error there counts along the normal. */
static double largest_along(Vec3 normal, Vec3 a, Vec3 b, Vec3 c)
{
    return fabs(normal.x) * largest_of(a.x, b.x, c.x) + fabs(normal.y) * largest_of(a.y, b.y, c.y) +
           fabs(normal.z) * largest_of(a.z, b.z, c.z);
}

ATTR_COLD double rtc_coordinate_across(const RtcPlaced *object, uint32_t primitive, const Vec3 corner[3], Vec3 normal)
{
    const RtcMesh *mesh = object->mesh;
    if (mesh->end || object->moves) return (double)INFINITY;
    double across = largest_along(normal, corner[0], corner[1], corner[2]);
    if (mesh->moved || !mesh->baked) {
        Affine to_world = rtc_first_to_world(object);
        uint32_t of[3];
        rtc_triangle_of(mesh, primitive, of);
        const Vec3f *local = mesh->source->positions;
        across += largest_along(affine_normal(&to_world, normal), vec3_from_f(local[of[0]]), vec3_from_f(local[of[1]]),
                                vec3_from_f(local[of[2]]));
    }
    return across;
}

/* What a large triangle's plane is as coarse as about a place on it. */
ATTR_COLD static double coordinate_of_large(const RtcPlaced *object, const Hit *hit, const Corners *corner, Vec3 normal)
{
    const Vec3 corners[3] = {corner->a, corner->b, corner->c};
    return rtc_coordinate_across(object, hit->primitive, corners, normal);
}

/* Where the ray starts in the very plane of a triangle, Embree's word for whether the triangle is met is not enough:
 * its float ray runs a little beside the exact one, and reaches that plane elsewhere. */
static bool complete_triangle(Query *query, const RtcPlaced *object, Hit *hit)
{
    const Ray *ray = query->ray;
    const Corners corner = triangle_corners(query->scene, object, hit->primitive, ray->time);
    Vec3 edge1 = vec3_sub(corner.b, corner.a), edge2 = vec3_sub(corner.c, corner.a);
    Vec3 normal = vec3_cross(edge1, edge2);
    double length = vec3_length(normal), slope = vec3_dot(normal, query->direction);
    if (!(length > 0) || slope == 0) return false; /* no area, or exactly in the ray's plane: not crossed */
    double t = vec3_dot(normal, vec3_sub(corner.a, query->origin)) / slope, cosine = slope / length;
    double largest = double_max(vec3_max_abs(corner.a), double_max(vec3_max_abs(corner.b), vec3_max_abs(corner.c)));
    double scale = rtc_rounded_scale(query, object, largest, t);
    if (UNLIKELY(!(t > query->t_min && t <= ray->t_max))) {
        if (fabs((t - query->t_min) * cosine) <= 2 * rtc_rounding(corner.a) &&
            !is_clear(query, hit, edge1, edge2, slope, scale)) {
            query->unsure = true;
            if (query->t_min == 0 && ray->n_left && !rtc_starts_on(ray, hit->object)) query->hits->beside = true;
        }
        return false;
    }
    double here = vec3_max_abs(vec3_along(query->origin, t, query->direction)), coordinate = largest;
    if (UNLIKELY(largest > LARGE_FACE * here)) {
        double across = coordinate_of_large(object, hit, &corner, vec3_scale(normal, 1 / length));
        coordinate = double_min(largest, double_max(here, across));
    }
    double rounding = TRUSTED_ULPS * UNIT_ROUNDING * coordinate;
    if (ray->n_left) {
        if (is_left(query, hit->object, hit->primitive, t, cosine)) return false;
        if (UNLIKELY(t * fabs(cosine) <= 2 * rounding) && is_parallel(ray, normal, length) && !rtc_meets(query, hit))
            return false;
    }
    hit->t = t;
    hit->entering = slope < 0;
    hit->normal = vec3f_from(vec3_scale(normal, 1 / length));
    hit->cos_normal = cosine;
    hit->rounding = rounding;
    hit->inside = false;
    hit->smooth = object->mesh->source->normals != NULL;
    hit->clear = is_clear(query, hit, edge1, edge2, slope, scale);
    if (UNLIKELY(!hit->clear)) query->unsure = true;
    return true;
}

void rtc_enter_frame(Query *query, const RtcPlaced *object)
{
    LocalRay *local = &query->local;
    local->frame = object->frame;
    local->to_local = NULL;
    if (object->moves) {
        local->moved_to_local = rtc_to_local(query->scene, object, query->ray->time);
        local->to_local = &local->moved_to_local;
    } else if (object->mapped) {
        local->to_local = &object->maps->to_local;
    } else {
        double smaller = object->scale == 1 ? 1 : 1 / object->scale;
        local->line = piece_line(vec3_scale(vec3_sub(query->origin, object->place), smaller),
                                 vec3_scale(query->direction, smaller));
        return;
    }
    local->line =
        piece_line(affine_point(local->to_local, query->origin), affine_vector(local->to_local, query->direction));
}

/* What is the same for all pieces: normal and cosine are the world's; false where the ray starts there. */
static inline bool complete_curved(const Query *query, Hit *hit, Vec3 normal, double cosine, bool entering)
{
    if (query->ray->n_left &&
        is_left(query, hit->object, hit->primitive, hit->t, entering ? -fabs(cosine) : fabs(cosine)))
        return false;
    Vec3 p = vec3_along(query->origin, hit->t, query->direction);
    hit->entering = entering;
    hit->normal = vec3f_from(normal);
    hit->cos_normal = cosine;
    hit->rounding = rtc_rounding(p) + 0x1p-44 * (query->scale + hit->t);
    hit->u = hit->v = 0;
    hit->inside = false;
    hit->clear = true;
    return true;
}

static bool complete_ball(const Query *query, const RtcPlaced *object, Hit *hit)
{
    Vec3 origin = vec3_sub(query->origin, rtc_ball_centre(query->scene, object, query->ray->time));
    Vec3 normal = piece_ball_normal(origin, query->direction, hit->t, !hit->entering);
    hit->smooth = false;
    return complete_curved(query, hit, normal, vec3_dot(normal, query->direction), hit->entering);
}

static bool complete_piece(Query *query, const RtcPlaced *object, Hit *hit)
{
    rtc_need_frame(query, object);
    const LocalRay *local_ray = &query->local;
    const Piece *piece = &object->solid->pieces[hit->primitive];
    Vec3 local = piece_normal(piece, local_ray->line.org, local_ray->line.dir, hit->t);
    Vec3 normal = local_ray->to_local ? vec3_normalize(affine_normal(local_ray->to_local, local)) : local;
    double slope = vec3_dot(local, local_ray->line.dir); /* the sign that the piece itself sees */
    hit->smooth = piece_is_smoothed(piece);
    return complete_curved(query, hit, normal, vec3_dot(normal, query->direction), slope < 0);
}

bool rtc_complete_hit(Query *query, Hit *hit)
{
    const RtcPlaced *object = &query->scene->objects[hit->object];
    if (object->is_mesh) return complete_triangle(query, object, hit);
    return object->ball ? complete_ball(query, object, hit) : complete_piece(query, object, hit);
}

bool rtc_is_plane(const RtcScene *scene, uint32_t object)
{
    const RtcPlaced *placed = &scene->objects[object];
    return !placed->is_mesh && placed->solid && placed->solid->pieces[0].kind == PIECE_PLANE;
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

/* Corner normals of the mesh interpolated, or the geometric normal where they point to the other side. */
static Vec3f mesh_shading(const RtcScene *scene, const RtcPlaced *object, double time, const Hit *hit)
{
    const RtcMesh *mesh = object->mesh;
    uint32_t triangle[3];
    rtc_triangle_of(mesh, hit->primitive, triangle);
    Vec3f local = interpolated_normal(mesh->source, triangle, hit);
    if (mesh->end && mesh->end->normals) {
        Vec3f end = interpolated_normal(mesh->end, triangle, hit);
        local = vec3f_add(vec3f_scale(local, 1 - (float)time), vec3f_scale(end, (float)time));
    }
    Vec3 world = vec3_from_f(local);
    if (object->mapped || object->moves) {
        Affine to_local = rtc_to_local(scene, object, time);
        world = affine_normal(&to_local, world);
    }
    double length = vec3_length(world);
    if (!(length > 0)) return hit->normal;
    Vec3f shading = vec3f_from(vec3_scale(world, 1 / length));
    return vec3f_dot(shading, hit->normal) > 0 ? shading : hit->normal;
}

/* The normal of a piece that is smoothed, or the geometric one. */
static Vec3f piece_shading(const RtcScene *scene, const RtcPlaced *object, const Ray *ray, const Hit *hit)
{
    const Piece *piece = &object->solid->pieces[hit->primitive];
    Affine to_local = rtc_to_local(scene, object, ray->time);
    PieceRoot root;
    piece_surface(piece, affine_point(&to_local, ray->origin), affine_vector(&to_local, vec3_from_f(ray->direction)),
                  hit->t, &root);
    Vec3f shading = vec3f_from(vec3_normalize(affine_normal(&to_local, root.shading)));
    return vec3f_dot(shading, hit->normal) > 0 ? shading : hit->normal;
}

/* Between the sides of a wedge, which interpolated normals show as one surface, a mirrored ray would come to the edge in ever smaller
 * steps, and never turn back; by the sides' own it does. */
Vec3f rtc_smooth_normal(const RtcScene *scene, const Ray *ray, const Hit *hit)
{
    const RtcPlaced *object = &scene->objects[hit->object];
    if (UNLIKELY(hit->t <= WEDGE * hit->rounding) && ray->n_left) return hit->normal;
    return object->is_mesh ? mesh_shading(scene, object, ray->time, hit) : piece_shading(scene, object, ray, hit);
}

/* Twice rtc_bulge, as a vector in the mesh's own frame. */
static Vec3 mesh_bulge(const RtcMesh *mesh, double time, const Hit *hit)
{
    const Mesh *source = mesh->source, *end = mesh->end;
    const double weight[3] = {1 - (double)hit->u - (double)hit->v, (double)hit->u, (double)hit->v};
    double side = hit->entering ? 1 : -1;
    uint32_t of[3];
    rtc_triangle_of(mesh, hit->primitive, of);
    Vec3 corner[3], place = vec3(0, 0, 0), bulge = vec3(0, 0, 0);
    for (int i = 0; i < 3; i++) {
        corner[i] = vec3_from_f(source->positions[of[i]]);
        if (end) corner[i] = between(corner[i], vec3_from_f(end->positions[of[i]]), time);
        place = vec3_along(place, weight[i], corner[i]);
    }
    for (int i = 0; i < 3; i++) {
        Vec3 normal = vec3_from_f(source->normals[of[i]]);
        if (end && end->normals) normal = between(normal, vec3_from_f(end->normals[of[i]]), time);
        double height = side * vec3_dot(vec3_sub(corner[i], place), normal);
        if (height > 0) bulge = vec3_along(bulge, side * height * weight[i], normal);
    }
    return bulge;
}

double rtc_bulge(const RtcScene *scene, const Ray *ray, const Hit *hit, Vec3f up)
{
    if (!hit->smooth) return 0;
    const RtcPlaced *object = &scene->objects[hit->object];
    Affine to_world = rtc_to_world(scene, object, ray->time);
    Vec3 bulge;
    if (object->is_mesh) {
        bulge = mesh_bulge(object->mesh, ray->time, hit);
    } else {
        Affine to_local = rtc_to_local(scene, object, ray->time);
        Vec3 place = affine_point(&to_local, ray_point(ray, hit->t));
        bulge = piece_bulge(&object->solid->pieces[hit->primitive], place, hit->entering);
    }
    return 0.5 * vec3_dot(affine_vector(&to_world, bulge), vec3_from_f(up));
}

/* Keeps one hit of each object, the one nearest to where the new ray starts, and all triangles that have that very point in
 * common; returns how many. */
ATTR_COLD static size_t keep_at_start(const RtcScene *scene, const Ray *ray, Hit *hits, size_t n, bool through)
{
    double start = hits[through ? n - 1 : 0].t, noise = DOUBLE_NOISE * (vec3_max_abs(ray->origin) + start);
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        size_t other = through ? i + 1 : 0, end = through ? n : i;
        bool at_start = scene->objects[hits[i].object].is_mesh && fabs(hits[i].t - start) <= noise;
        while (!at_start && other < end && hits[other].object != hits[i].object) other++;
        if (at_start || other == end) hits[kept++] = hits[i];
    }
    return kept;
}

/* Says of a surface on which side of it the new ray starts. slope: of its direction along the normal. */
static inline void start_on_side(Hit *hit, bool inside, double slope)
{
    hit->inside = inside;
    hit->behind = inside == (slope < 0) && fabs(slope) > RTC_LEAST_COSINE;
}

/* Tells on which side of each of n surfaces the new ray starts, which it does on one of them: the others have all been
 * crossed, or none has. The ray's own direction decides where it starts on them, too. Returns whether all are clear. */
ATTR_COLD static bool find_sides(const Ray *ray, Hit *hits, size_t n, bool through, const Hit *start, Vec3 direction,
                                 double start_scale, double *least_slope)
{
    bool clear = true;
    Vec3 origin = ray_point(ray, start->t);
    for (size_t i = 0; i < n; i++) {
        Hit *hit = &hits[i];
        Vec3 normal = vec3_from_f(hit->normal), from_surface = vec3_sub(origin, ray_point(ray, hit->t));
        double height = vec3_dot(from_surface, normal), slope = vec3_dot(normal, direction);
        bool on_surface = hit == start || fabs(height) <= DOUBLE_NOISE * start_scale;
        start_on_side(hit, on_surface ? slope < 0 : hit->entering == through, slope);
        clear = clear && hit->clear;
        *least_slope = double_min(*least_slope, fabs(slope));
    }
    return clear;
}

/* Whether the edge between two triangles that meet is a reentrant one: seen from the first, the other rises. */
ATTR_COLD static bool is_reentrant(const RtcScene *scene, double time, const Hit *first, const Hit *other)
{
    Vec3 a[3], b[3];
    rtc_triangle(scene, first->object, first->primitive, time, a);
    rtc_triangle(scene, other->object, other->primitive, time, b);
    Vec3 normal = vec3_cross(vec3_sub(a[1], a[0]), vec3_sub(a[2], a[0]));
    double height = 0; /* of the corner farthest from the plane */
    for (int i = 0; i < 3; i++) {
        double above = vec3_dot(vec3_sub(b[i], a[0]), normal);
        if (fabs(above) > fabs(height)) height = above;
    }
    return height > 0;
}

/* Where several triangles of one object are left, the new ray starts on an edge of it, and the planes of both sides have their
 * say: it is inside of the object where it is below all of them; at a reentrant edge, where it is below any. */
ATTR_COLD static void agree_at_edges(const RtcScene *scene, double time, Hit *hits, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        size_t before = 0;
        bool inside = hits[i].inside;
        while (hits[before].object != hits[i].object) before++;
        if (before < i) continue; /* has been settled with that one */
        for (size_t k = i + 1; k < n; k++) {
            if (hits[k].object != hits[i].object) continue;
            bool reentrant = is_reentrant(scene, time, &hits[i], &hits[k]);
            inside = reentrant ? inside || hits[k].inside : inside && hits[k].inside;
        }
        for (size_t k = i; k < n; k++)
            if (hits[k].object == hits[i].object) hits[k].inside = inside;
    }
}

/* rtc_leave, once it is known how many hits there are at the start; for one alone, which is what nearly all are, it is less. */
static inline void leave_from(const RtcScene *scene, const Ray *ray, Hit *hits, size_t n, bool through, Vec3f direction,
                              Ray *next)
{
    const bool several = n > 1;
    Hit *hit = several && through ? &hits[n - 1] : hits;
    Vec3 normal = vec3_from_f(hit->normal), along = vec3_from_f(direction), origin = ray_point(ray, hit->t);
    double slope = vec3_dot(normal, along), start_scale = vec3_max_abs(ray->origin) + hit->t, time = ray->time;
    double least_slope = fabs(slope);
    bool clear = hit->clear;
    start_on_side(hit, slope < 0, slope); /* it starts on the surface itself */
    if (several) clear = find_sides(ray, hits, n, through, hit, along, start_scale, &least_slope);
    double outward = hit->inside ? -1 : 1; /* of that plane */
    if (several) agree_at_edges(scene, time, hits, n);
    /* The ray may end within rounding of a surface, too, that it has started on: in a wedge between two, or creeping. The
     * next one does not know of that surface any more, and Embree may miss it there. */
    clear = clear && (double)ray->least_slope * hit->t > 4 * hit->rounding;
    /* The chord of a creeping ray may rise less above the surface than double can tell, and would then not be seen to
     * end. */
    if (UNLIKELY(fabs(slope) < CREEPING_COSINE) && !scene->objects[hit->object].is_mesh)
        origin = vec3_along(origin, 0.25 * outward * DOUBLE_NOISE * start_scale, normal);
    ray_begin(next, origin, direction);
    next->time = time;
    next->left = hits;
    next->n_left = n;
    next->start_scale = start_scale;
    next->nudge = vec3_scale(normal, 0.5 * outward * double_min(hit->rounding, rtc_rounding(origin)));
    next->grain = hit->grain;
    next->at_edge = !clear;
    next->least_slope = (float)least_slope;
}

ATTR_COLD static void leave_several(const RtcScene *scene, const Ray *ray, Hit *hits, size_t *n, bool through,
                                    Vec3f direction, Ray *next)
{
    *n = keep_at_start(scene, ray, hits, *n, through);
    leave_from(scene, ray, hits, *n, through, direction, next);
}

void rtc_leave(const RtcScene *scene, const Ray *ray, Hit *hits, size_t *n, bool through, Vec3f direction, Ray *next)
{
    if (UNLIKELY(*n > 1))
        leave_several(scene, ray, hits, n, through, direction, next);
    else
        leave_from(scene, ray, hits, 1, through, direction, next);
}

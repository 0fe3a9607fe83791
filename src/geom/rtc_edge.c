/* rtc_edge.c - which triangles an exact ray meets where it comes within rounding of their edges.
 *
 * Embree's float ray runs a little beside the exact one, and at an edge it may meet the neighbour of the triangle that the
 * exact one meets, or pass by both. Then all triangles about the place are asked in double. Which side of an edge a line
 * passes on is computed alike for the two triangles that share it, but for the sign, so that the line slips
 * through between them as little as Embree's. So each surface is entered and left in turn, and in the order in which the
 * exact ray comes to it, also where the edges of several objects lie on each other.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_boxes.h"
#include "geom/rtc_query.h"

/* How far Embree's line may run beside the exact one, of the coordinates: the nudge of a quarter of that, and some roundings. */
#define LINE_NOISE 0x1p-20
/* What it rounds of a triangle's weights themselves, of that; it counts where an edge runs along the line. */
#define ALONG_LINE 0.25
/* The slope from one triangle of a quad to the other at which both are one plane. */
#define FLAT 0x1p-20
/* Below this cosine a ray that starts within rounding of a plane may meet it where Embree does not look. */
#define CREEPING 0x1p-10

static const int next[3] = {1, 2, 0};

/* The corners are moved along the line to the plane through its origin that is across its longest coordinate, as in S. Woop, C.
 * Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1) (2013), 3, here with weights of the same scale for all
 * lines. What is along the line would else drown small triangles far from the origin in rounding: any line seemed to meet them. */
bool rtc_line_meets(const Query *query, const Vec3 corner[3], double weight[3])
{
    const Vec3 *o = &query->origin, *d = &query->direction;
    const double origin[3] = {o->x, o->y, o->z}, direction[3] = {d->x, d->y, d->z};
    double x = fabs(d->x), y = fabs(d->y), z = fabs(d->z), across[3][2];
    int k = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2), i = next[k], j = next[i];
    double slope_i = direction[i] / direction[k], slope_j = direction[j] / direction[k];
    for (int c = 0; c < 3; c++) {
        const double at[3] = {corner[c].x, corner[c].y, corner[c].z};
        double along = at[k] - origin[k];
        across[c][0] = (at[i] - origin[i]) - slope_i * along;
        across[c][1] = (at[j] - origin[j]) - slope_j * along;
    }
    for (int c = 0; c < 3; c++) {
        const double *a = across[next[c]], *b = across[next[next[c]]];
        weight[c] = direction[k] * (a[0] * b[1] - a[1] * b[0]);
    }
    return (weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0) || (weight[0] <= 0 && weight[1] <= 0 && weight[2] <= 0);
}

bool rtc_meets(const Query *query, const Hit *hit)
{
    Vec3 corner[3];
    double weight[3];
    rtc_triangle(query->scene, hit->object, hit->primitive, query->ray->time, corner);
    return rtc_line_meets(query, corner, weight);
}

/* Whether the other triangle of a quad goes on in the plane of this one, so that their edge is none: a ray that meets this one
 * meets what stands there, and one that leaves it does not come to the other. That edge is the one from corner 1 to 2. */
static bool is_flat(const Query *query, const Hit *hit, const Vec3 corner[3])
{
    Vec3 twin[3];
    if (mesh_quad_is_single(query->scene->objects[hit->object].mesh->quads[hit->primitive / 2].vertex)) return false;
    rtc_triangle(query->scene, hit->object, hit->primitive ^ 1, query->ray->time, twin);
    Vec3 edge = vec3_sub(corner[2], corner[1]), out = vec3_sub(twin[0], corner[1]),
         normal = vec3_cross(edge, vec3_sub(corner[0], corner[1])), across = vec3_cross(out, edge);
    double slope = vec3_dot(normal, across);
    return slope > 0 && fabs(vec3_dot(normal, out)) * vec3_length(edge) <= FLAT * slope;
}

double rtc_edge_noise(const Query *query, Vec3 edge, double scale)
{
    double across = vec3_length(vec3_cross(query->direction, edge));
    return LINE_NOISE * scale * (across + ALONG_LINE * vec3_length(edge));
}

bool rtc_line_is_clear(const Query *query, const Hit *hit, double scale)
{
    Vec3 corner[3];
    double weight[3];
    rtc_triangle(query->scene, hit->object, hit->primitive, query->ray->time, corner);
    if (!rtc_line_meets(query, corner, weight)) return false;
    for (int i = 0; i < 3; i++) {
        Vec3 edge = vec3_sub(corner[(i + 2) % 3], corner[(i + 1) % 3]);
        if (fabs(weight[i]) <= rtc_edge_noise(query, edge, scale) && (i > 0 || !is_flat(query, hit, corner)))
            return false;
    }
    return true;
}

bool rtc_has_hit(const HitList *list, uint32_t object, uint32_t primitive)
{
    for (size_t i = 0; i < list->n; i++)
        if (list->items[i].object == object && list->items[i].primitive == primitive) return true;
    return false;
}

/* The triangles of an object that are asked about: first <= primitive < end; none where it is a piece. */
typedef struct Asked {
    uint32_t object, first, end;
} Asked;

static Asked triangles_asked(const RtcScene *scene, const struct RTCPointQueryFunctionArguments *arguments)
{
    uint32_t object = arguments->context->instStackSize ? arguments->context->instID[0] : arguments->geomID,
             quad = arguments->primID;
    if (object >= scene->n_objects) return (Asked){object, 0, 0};
    bool single = mesh_quad_is_single(scene->objects[object].mesh->quads[quad].vertex);
    return (Asked){object, 2 * quad, 2 * quad + (single ? 1 : 2)};
}

/* A triangle near a place in doubt: noted where the exact ray meets it. */
static void take_triangle(Query *query, uint32_t object, uint32_t primitive)
{
    HitList *list = rtc_passes(query, object) ? query->passed : query->hits;
    if (rtc_has_hit(list, object, primitive)) return;
    Vec3 corner[3];
    double weight[3];
    rtc_triangle(query->scene, object, primitive, query->ray->time, corner);
    if (!rtc_line_meets(query, corner, weight)) return;
    Hit *hit = rtc_hit_place(list);
    if (!hit) return;
    const RtcPlaced *placed = &query->scene->objects[object];
    bool turned = placed->mirrored && !placed->mesh->baked; /* the corners are, then; see rtc_triangle */
    double sum = weight[0] + weight[1] + weight[2];
    hit->object = object;
    hit->primitive = primitive;
    hit->grain = 0;
    hit->u = sum != 0 ? (float)(weight[turned ? 2 : 1] / sum) : 0;
    hit->v = sum != 0 ? (float)(weight[turned ? 1 : 2] / sum) : 0;
    if (!rtc_complete_hit(query, hit)) return;
    list->n++;
    if (list == query->hits && !query->all) rtc_shorten(query, hit);
}

/* What a line looks like from along it: see rtc_line_meets. */
typedef struct Sight {
    int along, i, j;
    double origin[3], slope_i, slope_j;
} Sight;

static Sight sight_of(const Query *query)
{
    const Vec3 *o = &query->origin, *d = &query->direction;
    const double direction[3] = {d->x, d->y, d->z};
    double x = fabs(d->x), y = fabs(d->y), z = fabs(d->z);
    int k = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2), i = next[k], j = next[i];
    return (Sight){k, i, j, {o->x, o->y, o->z}, direction[i] / direction[k], direction[j] / direction[k]};
}

/* Whether a line passes by all four corners of a quad on one side, as nearly all do that are asked about. */
static bool passes_by(const Sight *sight, const RtcQuad *quad)
{
    unsigned i_above = 0, i_below = 0, j_above = 0, j_below = 0;
    for (int c = 0; c < 4; c++) {
        const Vec3f *corner = &quad->corner[c];
        const double at[3] = {(double)corner->x, (double)corner->y, (double)corner->z};
        double along = at[sight->along] - sight->origin[sight->along];
        double i = (at[sight->i] - sight->origin[sight->i]) - sight->slope_i * along,
               j = (at[sight->j] - sight->origin[sight->j]) - sight->slope_j * along;
        i_above += i > 0;
        i_below += i < 0;
        j_above += j > 0;
        j_below += j < 0;
    }
    return i_above == 4 || i_below == 4 || j_above == 4 || j_below == 4;
}

/* Triangles of an object: first <= i < end, the first of them the first of its quad. */
static void take_triangles(Query *query, const Sight *sight, uint32_t object, uint32_t first, uint32_t end)
{
    const RtcMesh *mesh = query->scene->objects[object].mesh;
    for (uint32_t i = first; i < end; i += 2) {
        if (mesh->baked && passes_by(sight, &mesh->quads[i / 2])) continue;
        take_triangle(query, object, i);
        if (i + 1 < end) take_triangle(query, object, i + 1);
    }
}

typedef struct Taking {
    Query *query;
    const Sight *sight;
    uint32_t object;
} Taking;

static void take_along(void *context, uint32_t first, uint32_t end)
{
    const Taking *taking = context;
    take_triangles(taking->query, taking->sight, taking->object, first, end);
}

/* All triangles of an object along the ray. */
static void take_all(Query *query, const Sight *sight, uint32_t object)
{
    Taking taking = {query, sight, object};
    rtc_along(query->scene, object, query->origin, query->direction, query->ray->time, take_along, &taking);
}

/* Whether the ray runs along a triangle, so that Embree's may be on its other side for a long way. */
static bool creeps_along(const Query *query, uint32_t object, uint32_t primitive)
{
    Vec3 corner[3];
    rtc_triangle(query->scene, object, primitive, query->ray->time, corner);
    Vec3 normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    return fabs(vec3_dot(normal, query->direction)) <= CREEPING * vec3_length(normal);
}

/* More triangles than that about one place: there floats are so coarse that it takes less to ask those along the line, wherever
 * they are, and about the place only as far as Embree's line may run beside the exact one. */
enum { MANY = 200 };

typedef struct Around {
    Query *query;
    bool at_start;
    float least_radius; /* where there are many */
    uint32_t n;
    Sight sight;
} Around;

/* Triangles about a place. At the start: where that is at an edge of a face along which the ray creeps, it may come through that
 * face far away from there. */
static bool take_around(struct RTCPointQueryFunctionArguments *arguments)
{
    Around *around = arguments->userPtr;
    Query *query = around->query;
    Asked asked = triangles_asked(query->scene, arguments);
    if (asked.object == query->all_along || asked.first == asked.end) return false;
    bool shrink = false, edge = around->at_start && query->ray->at_edge, all = ++around->n > MANY;
    for (uint32_t i = asked.first; edge && !all && i < asked.end; i++) all = creeps_along(query, asked.object, i);
    if (UNLIKELY(all)) {
        shrink = around->n > MANY && arguments->query->radius > around->least_radius;
        if (around->n > MANY) around->n = 0;
        if (shrink) arguments->query->radius = around->least_radius;
        query->all_along = asked.object;
        take_all(query, &around->sight, asked.object);
        return shrink;
    }
    take_triangles(query, &around->sight, asked.object, asked.first, asked.end);
    return false;
}

/* Asks about all triangles whose boxes come that near to a place. */
static void ask_around(const RtcScene *scene, Vec3 place, double time, double radius, RTCPointQueryFunction ask,
                       void *asker)
{
    struct RTCPointQuery about = {
        .x = (float)place.x, .y = (float)place.y, .z = (float)place.z, .time = (float)time, .radius = (float)radius};
    struct RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene->world, &about, &context, ask, asker);
}

/* least_radius: where there are many triangles. */
static void look_around(Query *query, Vec3 place, bool at_start, double radius, double least_radius)
{
    Around around = {query, at_start, (float)least_radius, 0, sight_of(query)};
    ask_around(query->scene, place, query->ray->time, radius, take_around, &around);
}

void rtc_look_at(Query *query, const Hit *at)
{
    const Hit hit = *at; /* its list may grow */
    Vec3 corner[3], inside = {0, 0, 0}, place = ray_point(query->ray, hit.t);
    double weight[3], sum = 0, far = 0;
    rtc_triangle(query->scene, hit.object, hit.primitive, query->ray->time, corner);
    double largest = double_max(vec3_max_abs(corner[0]), double_max(vec3_max_abs(corner[1]), vec3_max_abs(corner[2])));
    double scale = rtc_rounded_scale(query, &query->scene->objects[hit.object], largest, hit.t);
    rtc_line_meets(query, corner, weight);
    double sign = weight[0] + weight[1] + weight[2] < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) weight[k] = double_max(sign * weight[k], 0), sum += weight[k];
    for (int k = 0; k < 3; k++) inside = vec3_along(inside, sum > 0 ? weight[k] / sum : 1.0 / 3, corner[k]);
    for (int k = 0; k < 3; k++) {
        Vec3 a = corner[(k + 1) % 3], edge = vec3_sub(corner[(k + 2) % 3], a);
        if (weight[k] > rtc_edge_noise(query, edge, scale)) continue;
        far = double_max(far, vec3_length(vec3_cross(vec3_sub(inside, a), edge)) / vec3_length(edge));
    }
    /* Where Embree's line runs beside the exact one, it comes to a flat surface that much earlier or later, a few faces away. */
    double along = 4 / double_max(fabs(hit.cos_normal), CREEPING);
    double near = far + 2 * vec3_length(vec3_sub(place, inside));
    look_around(query, inside, false, near + double_max(8, along) * hit.rounding, near + 2 * hit.rounding);
}

static void look_at_all(Query *query, HitList *hits)
{
    size_t kept = 0;
    for (size_t i = 0; i < hits->n; i++) /* those that are noted on the way, too */
        if (!hits->items[i].clear) rtc_look_at(query, &hits->items[i]);
    for (size_t i = 0; i < hits->n; i++)
        if (hits->items[i].clear || rtc_meets(query, &hits->items[i])) hits->items[kept++] = hits->items[i];
    hits->n = kept;
}

/* How far from the start triangles may be that Embree passes by there: where its line, which runs beside the exact one, comes
 * through a surface that the ray starts on, it is that much farther on along it as the ray is aslant; what it meets then instead
 * of a neighbour is dropped as the start. */
static double around_start(const Query *query, Vec3 start, double beside)
{
    const Ray *ray = query->ray;
    double most = 16 * rtc_rounding(start), slope = (double)ray->least_slope;
    if (query->t_min > 0 || !ray->n_left || !(slope > 0)) return double_max(most, beside);
    return double_max(double_min(most, (1 + 1 / slope) * LINE_NOISE * vec3_max_abs(start)), beside);
}

void rtc_look_closer(Query *query)
{
    Vec3 start = vec3_along(query->origin, query->t_min, query->direction);
    double beside =
        LINE_NOISE * query->start_scale; /* at the origin, too, where nothing is rounded of the place itself */
    look_around(query, start, true, around_start(query, start, beside), beside);
    look_at_all(query, query->hits);
    if (query->passes) look_at_all(query, query->passed);
}

typedef struct Beside {
    const RtcScene *scene;
    const Ray *ray;
    double radius;
    HitList *found;
} Beside;

/* Whether a point is within a distance of a triangle; at acute corners somewhat farther. */
static bool is_beside(const Vec3 corner[3], Vec3 p, double distance)
{
    Vec3 normal = vec3_normalize(vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0])));
    if (fabs(vec3_dot(normal, vec3_sub(p, corner[0]))) > distance) return false;
    for (int i = 0; i < 3; i++) {
        Vec3 inward = vec3_normalize(vec3_cross(normal, vec3_sub(corner[(i + 1) % 3], corner[i])));
        if (vec3_dot(inward, vec3_sub(p, corner[i])) < -distance) return false;
    }
    return true;
}

static Hit *hit_of_object(const HitList *list, uint32_t object)
{
    for (size_t i = 0; i < list->n; i++)
        if (list->items[i].object == object) return &list->items[i];
    return NULL;
}

/* Whether a ray starts on an object, clear of its edges: at one of them that may be the half of it, as far as Embree has told. */
static bool starts_clearly_on(const Ray *ray, uint32_t object)
{
    for (size_t i = 0; i < ray->n_left; i++)
        if (ray->left[i].object == object && ray->left[i].clear) return true;
    return false;
}

static bool find_beside(struct RTCPointQueryFunctionArguments *arguments)
{
    const Beside *beside = arguments->userPtr;
    Asked asked = triangles_asked(beside->scene, arguments);
    if (starts_clearly_on(beside->ray, asked.object) || hit_of_object(beside->found, asked.object)) return false;
    for (uint32_t i = asked.first; i < asked.end; i++) {
        Vec3 corner[3];
        rtc_triangle(beside->scene, asked.object, i, beside->ray->time, corner);
        if (!is_beside(corner, beside->ray->origin, beside->radius)) continue;
        Hit *hit = rtc_hit_place(beside->found);
        if (!hit) return false;
        hit->object = asked.object;
        beside->found->n++;
        break;
    }
    return false;
}

/* Solids that the ray's line crosses where double cannot tell it from the start. */
static void find_solids_beside(const Beside *beside, HitList *along)
{
    const Ray *ray = beside->ray;
    double noise = rtc_start_noise(double_max(vec3_max_abs(ray->origin), beside->scene->reach), ray);
    Ray across;
    ray_begin(&across, ray_point(ray, -noise), ray->direction);
    across.time = ray->time;
    across.t_max = 2 * noise;
    rtc_all(beside->scene, &across, false, along);
    for (size_t i = 0; i < along->n; i++) {
        uint32_t object = along->items[i].object;
        if (beside->scene->objects[object].is_mesh || rtc_starts_on(ray, object) ||
            hit_of_object(beside->found, object))
            continue;
        Hit *hit = rtc_hit_place(beside->found);
        if (!hit) return;
        hit->object = object;
        beside->found->n++;
    }
}

size_t rtc_beside(const RtcScene *scene, const Ray *ray, HitList *found, HitList *along)
{
    double radius = double_max(2 * rtc_rounding(ray->origin), DOUBLE_NOISE * ray->start_scale);
    Beside beside = {scene, ray, radius, found};
    found->n = 0;
    if (ray->n_left) {
        ask_around(scene, ray->origin, ray->time, beside.radius, find_beside, &beside);
        find_solids_beside(&beside, along);
    }
    if (!found->n) return 0;
    Ray onward = *ray;
    onward.t_min = 0;
    onward.t_max = HUGE_VAL;
    rtc_all(scene, &onward, false, along);
    for (size_t i = 0; i < found->n; i++) {
        const Hit *first = hit_of_object(along, found->items[i].object);
        found->items[i].inside = first && !first->entering;
    }
    return found->n;
}

/* rtc_lone.c - balls and convex meshes into which nothing else reaches: bubbles, drops, beads and gems.
 *
 * A ray that goes into one meets nothing but the other side of its surface, and need not be searched for. Whether an object is lone
 * is found out when a ray first goes into it, for most of very many never are: a question of everything near it, in double. All
 * stays away by a margin, so that nothing stands at one place with the object's surface either, where the ray meets that not too
 * much at a slant. A mesh may stand on planes: rays that start or leave there are searched for.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_convex.h"
#include "geom/rtc_query.h"
#include "shape/ball_side.h"

/* Everything is farther from the object than two surfaces at one place are from each other along a ray that leaves it at
 * RTC_LONE_COSINE or more, and than what is looked at about a start (rtc_look_closer). */
#define MARGIN (2 / RTC_LONE_COSINE)

/* What has more primitives near it is taken not to be lone: it would take longer to know than it gains. */
enum { MOST_ASKED = 256 };

typedef struct Asked {
    const RtcScene *scene;
    uint32_t object;
    RtcConvex *convex; /* NULL: a ball */
    Ball ball;         /* it, or around it, with the margin */
    double margin;
    uint32_t n; /* primitives asked about so far */
    bool lone;
} Asked;

/* Whether a ball keeps away from a surface that it is no farther from than that. */
static bool keeps_away(const Asked *asked, double distance)
{
    return distance > asked->ball.radius;
}

static double distance_to_box(struct RTCBounds box, Vec3 p)
{
    Vec3 away = vec3(double_max(double_max((double)box.lower_x - p.x, p.x - (double)box.upper_x), 0),
                     double_max(double_max((double)box.lower_y - p.y, p.y - (double)box.upper_y), 0),
                     double_max(double_max((double)box.lower_z - p.z, p.z - (double)box.upper_z), 0));
    return vec3_length(away);
}

/* Whether a convex mesh keeps away from a ball's surface, */
static bool is_apart_from_ball(const Asked *asked, const Ball *ball)
{
    return rtc_convex_is_apart(asked->convex, &ball->centre, 1, ball->radius + asked->margin) ||
           rtc_convex_is_within(asked->convex, ball, asked->margin);
}

/* and from a box. */
static bool is_apart_from_box(const Asked *asked, struct RTCBounds box)
{
    Vec3 corner[8];
    for (int i = 0; i < 8; i++)
        corner[i] = vec3((double)(i & 1 ? box.lower_x : box.upper_x), (double)(i & 2 ? box.lower_y : box.upper_y),
                         (double)(i & 4 ? box.lower_z : box.upper_z));
    return rtc_convex_is_apart(asked->convex, corner, 8, asked->margin);
}

static struct RTCBounds box_of_part(const RtcPieceSet *set, uint32_t primitive)
{
    struct RTCBounds box;
    struct RTCBoundsFunctionArguments arguments = {
        .geometryUserPtr = (void *)(uintptr_t)set, .primID = primitive, .bounds_o = &box};
    rtc_piece_bounds(&arguments);
    return box;
}

/* A ball that stands still, */
static bool is_away_from_ball(const Asked *asked, uint32_t object)
{
    if (object == asked->object) return true;
    Ball ball = rtc_ball(asked->scene, &asked->scene->objects[object], 0);
    if (asked->convex) return is_apart_from_ball(asked, &ball);
    return keeps_away(asked, fabs(vec3_length(vec3_sub(ball.centre, asked->ball.centre)) - ball.radius));
}

/* and any piece that does. */
static bool is_away_from_piece(const Asked *asked, uint32_t primitive)
{
    const RtcPieceSet *set = &asked->scene->still;
    Vec3 centre = asked->ball.centre;
    if (primitive < set->n_balls) return is_away_from_ball(asked, set->balls[primitive]);
    const RtcPiece *which = &set->pieces[rtc_part(set, primitive).number];
    if (which->object == asked->object) return true;
    const RtcPlaced *object = &asked->scene->objects[which->object];
    if (!object->mapped) {
        Vec3 local = vec3_scale(vec3_sub(centre, object->place), 1 / object->scale);
        if (keeps_away(asked, object->scale * piece_distance(which->shape, local))) return true;
        if (!asked->convex) return false;
    }
    struct RTCBounds box = box_of_part(set, primitive);
    return asked->convex ? is_apart_from_box(asked, box) : keeps_away(asked, distance_to_box(box, centre));
}

static bool is_away_from_triangle(const Asked *asked, const Vec3 corner[3])
{
    if (asked->convex) {
        Vec3 normal = vec3_normalize(vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0])));
        return rtc_convex_is_apart(asked->convex, corner, 3, asked->margin) ||
               rtc_convex_note_plane(asked->convex, normal, corner[0], asked->margin);
    }
    Vec3 from_centre[3];
    for (int k = 0; k < 3; k++) from_centre[k] = vec3_sub(corner[k], asked->ball.centre);
    return keeps_away(asked, sqrt(squared_to_triangle(from_centre)));
}

static bool is_away_from_quad(const Asked *asked, uint32_t object, uint32_t quad)
{
    const RtcMesh *mesh = asked->scene->objects[object].mesh;
    if (object == asked->object) return true;
    if (mesh->end) return false;
    for (uint32_t half = 0; half < (mesh_quad_is_single(mesh->quads[quad].vertex) ? 1 : 2); half++) {
        Vec3 corner[3];
        rtc_triangle(asked->scene, object, 2 * quad + half, 0, corner);
        if (!is_away_from_triangle(asked, corner)) return false;
    }
    return true;
}

static bool is_away_from_plane(const Asked *asked, const RtcPlane *plane)
{
    Vec3 normal = vec3_normalize(plane->up);
    if (asked->convex) return rtc_convex_note_plane(asked->convex, normal, plane->place, asked->margin);
    return keeps_away(asked, fabs(vec3_dot(normal, vec3_sub(asked->ball.centre, plane->place))));
}

static bool ask(struct RTCPointQueryFunctionArguments *arguments)
{
    Asked *asked = arguments->userPtr;
    uint32_t object = arguments->context->instStackSize ? arguments->context->instID[0] : arguments->geomID;
    bool away = object < asked->scene->n_objects ? is_away_from_quad(asked, object, arguments->primID)
                                                 : is_away_from_piece(asked, arguments->primID);
    if ((away && ++asked->n <= MOST_ASKED) || !asked->lone) return false;
    asked->lone = false;
    arguments->query->radius = 0; /* nothing more need be asked */
    return true;
}

/* What Embree does not know of. */
static void ask_others(Asked *asked)
{
    const RtcScene *scene = asked->scene;
    for (uint32_t i = 0; i < scene->n_few && asked->lone; i++) asked->lone = is_away_from_piece(asked, i);
    for (uint32_t i = 0; i < scene->n_planes && asked->lone; i++)
        asked->lone = is_away_from_plane(asked, &scene->planes[i]);
}

/* Whether nothing reaches into an object; ball: around it. */
static bool find_lone(const RtcScene *scene, uint32_t object, RtcConvex *convex, Ball ball)
{
    double scale = double_max(scene->reach, vec3_max_abs(ball.centre) + ball.radius),
           margin = MARGIN * TRUSTED_ULPS * UNIT_ROUNDING * scale;
    Asked asked = {scene, object, convex, {ball.centre, ball.radius + margin}, margin, 0, true};
    ask_others(&asked);
    if (!asked.lone) return false;
    struct RTCPointQuery about = {.x = (float)ball.centre.x,
                                  .y = (float)ball.centre.y,
                                  .z = (float)ball.centre.z,
                                  .radius = (float)(asked.ball.radius + 2 * UNIT_ROUNDING * scale)};
    struct RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene->world, &about, &context, ask, &asked);
    return asked.lone;
}

/* The planes of a lone mesh are kept; of several threads that make them the first one's. */
static bool find_lone_mesh(const RtcScene *scene, uint32_t object)
{
    RtcConvex *convex = rtc_convex_make(scene, object), *other = NULL;
    if (!convex) return false;
    bool lone = find_lone(scene, object, convex, rtc_convex_ball(convex));
    rtc_convex_trim(convex);
    if (!lone || !atomic_compare_exchange_strong(&scene->convex[scene->objects[object].frame], &other, convex))
        rtc_convex_free(convex);
    return lone;
}

bool rtc_find_lone(const RtcScene *scene, uint32_t object)
{
    RtcPlaced *placed = &scene->objects[object];
    bool lone =
        placed->ball ? find_lone(scene, object, NULL, rtc_ball(scene, placed, 0)) : find_lone_mesh(scene, object);
    atomic_store_explicit(&placed->lone, lone ? RTC_LONE : RTC_NOT_LONE, memory_order_release);
    return lone;
}

bool rtc_cross_lone_mesh(Query *query, uint32_t object)
{
    const Ray *ray = query->ray;
    RtcFace face;
    Hit *hit = rtc_hit_place(query->hits);
    const RtcScene *scene = query->scene;
    const RtcPlaced *placed = &scene->objects[object];
    const RtcConvex *convex = atomic_load_explicit(&scene->convex[placed->frame], memory_order_acquire);
    if (!hit || ray->at_edge || !rtc_convex_is_off(convex, query->origin) ||
        !rtc_convex_exit(convex, query->origin, ray->direction, &face))
        return false;
    hit->object = object;
    hit->grain = 0;
    for (uint32_t i = 0; i < face.n; i++) {
        Vec3 corner[3];
        double weight[3];
        hit->primitive = face.primitives[i];
        rtc_triangle(scene, object, hit->primitive, ray->time, corner);
        if (!rtc_line_meets(query, corner, weight)) continue;
        bool turned = placed->mirrored && !placed->mesh->baked; /* the corners are, then; see rtc_triangle */
        double sum = weight[0] + weight[1] + weight[2];
        hit->u = (float)(weight[turned ? 2 : 1] / sum);
        hit->v = (float)(weight[turned ? 1 : 2] / sum);
        bool there = rtc_complete_hit(query, hit) && hit->clear && rtc_convex_is_off(convex, ray_point(ray, hit->t));
        query->unsure = false; /* where it is not clear, it is searched for */
        query->hits->n = there;
        return there;
    }
    return false;
}

bool rtc_is_away(const RtcScene *scene, Vec3 centre, double radius)
{
    return !scene->n_keys && find_lone(scene, RTC_NO_OBJECT, NULL, (Ball){centre, radius});
}

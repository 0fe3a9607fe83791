/* rtc_lone.c - balls into which nothing else reaches: bubbles, drops and beads.
 *
 * A ray that goes into one meets nothing but the ball's other side, and need not be searched for. Whether a ball is lone is found
 * out when a ray first goes into it, for most of very many never are: a question of everything near it, by its distance in
 * double. It stays away by a margin, so that nothing stands at one place with the ball's surface either, where the ray meets that
 * not too much at a slant.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_query.h"
#include "shape/ball_side.h"

/* Everything is farther from the ball than two surfaces at one place are from each other along a ray that leaves it at
 * RTC_LONE_COSINE or more, and than what is looked at about a start (rtc_look_closer). */
#define MARGIN (2 / RTC_LONE_COSINE)

typedef struct Asked {
    const RtcScene *scene;
    uint32_t object;
    RtcBall ball; /* with the margin */
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

/* A piece that stands still. */
static bool is_away_from_piece(const Asked *asked, uint32_t primitive)
{
    const RtcPieceSet *set = &asked->scene->still;
    const RtcPiece *which = &set->pieces[rtc_part(set, primitive).number];
    Vec3 centre = asked->ball.centre;
    if (which->object == asked->object) return true;
    if (which->piece == RTC_BALL)
        return keeps_away(asked, fabs(vec3_length(vec3_sub(which->ball.centre, centre)) - which->ball.radius));
    const RtcPlaced *object = &asked->scene->objects[which->object];
    if (!object->maps) {
        Vec3 local = vec3_scale(vec3_sub(centre, object->place), 1 / object->scale);
        return keeps_away(asked, object->scale * piece_distance(which->shape, local));
    }
    struct RTCBounds box;
    struct RTCBoundsFunctionArguments arguments = {
        .geometryUserPtr = (void *)(uintptr_t)set, .primID = primitive, .bounds_o = &box};
    rtc_piece_bounds(&arguments);
    return keeps_away(asked, distance_to_box(box, centre));
}

static bool is_away_from_quad(const Asked *asked, uint32_t object, uint32_t quad)
{
    const RtcMesh *mesh = asked->scene->objects[object].mesh;
    if (mesh->end) return false;
    for (uint32_t half = 0; half < 2; half++) {
        Vec3 corner[3];
        rtc_triangle(asked->scene, object, 2 * quad + half, 0, corner);
        for (int k = 0; k < 3; k++) corner[k] = vec3_sub(corner[k], asked->ball.centre);
        if (!keeps_away(asked, sqrt(squared_to_triangle(corner)))) return false;
    }
    return true;
}

static bool ask(struct RTCPointQueryFunctionArguments *arguments)
{
    Asked *asked = arguments->userPtr;
    uint32_t object = arguments->context->instStackSize ? arguments->context->instID[0] : arguments->geomID;
    bool away = object < asked->scene->n_objects ? is_away_from_quad(asked, object, arguments->primID)
                                                 : is_away_from_piece(asked, arguments->primID);
    if (away || !asked->lone) return false;
    asked->lone = false;
    arguments->query->radius = 0; /* nothing more need be asked */
    return true;
}

/* What Embree does not know of. */
static void ask_others(Asked *asked)
{
    const RtcScene *scene = asked->scene;
    for (uint32_t i = 0; i < scene->n_few && asked->lone; i++) asked->lone = is_away_from_piece(asked, i);
    for (uint32_t i = 0; i < scene->n_planes && asked->lone; i++) {
        const RtcPlane *plane = &scene->planes[i];
        double height = vec3_dot(plane->up, vec3_sub(asked->ball.centre, plane->place)) / vec3_length(plane->up);
        asked->lone = keeps_away(asked, fabs(height));
    }
}

bool rtc_find_lone(const RtcScene *scene, uint32_t object)
{
    RtcPlaced *placed = &scene->objects[object];
    Asked asked = {scene, object, rtc_ball(scene, placed, 0), true};
    Vec3 centre = asked.ball.centre;
    double scale = double_max(scene->reach, vec3_max_abs(centre) + asked.ball.radius);
    asked.ball.radius += MARGIN * TRUSTED_ULPS * UNIT_ROUNDING * scale;
    ask_others(&asked);
    if (asked.lone) {
        struct RTCPointQuery about = {.x = (float)centre.x,
                                      .y = (float)centre.y,
                                      .z = (float)centre.z,
                                      .radius = (float)(asked.ball.radius + 2 * UNIT_ROUNDING * scale)};
        struct RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        rtcPointQuery(scene->world, &about, &context, ask, &asked);
    }
    atomic_store_explicit(&placed->lone, asked.lone ? RTC_LONE : RTC_NOT_LONE, memory_order_relaxed);
    return asked.lone;
}

/* rtc_here.c - the surfaces that a place is on, asked for by their distance from it: a ray to the tip of a cone, or to a corner,
 * may pass by both.
 *
 * What numbers tell apart there is what float keeps of the place's coordinates. A place at the origin has none, and there it is
 * what the surface's own come to: those of a triangle are floats, those of a piece doubles.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_query.h"
#include "shape/ball_side.h"

/* What double makes of a distance to a piece, of the numbers that it comes from. */
#define PIECE_NOISE 0x1p-46

typedef struct Here {
    const RtcScene *scene;
    Vec3 place;
    double time, rounding;
    RtcFound *found;
    void *context;
} Here;

static void tell(const Here *here, RtcSurface surface)
{
    if (surface.distance <= surface.rounding) here->found(here->context, &surface);
}

static void ask_triangle(const Here *here, uint32_t object, uint32_t primitive)
{
    Vec3 corner[3], from_place[3];
    const RtcPlaced *placed = &here->scene->objects[object];
    rtc_triangle(here->scene, object, primitive, here->time, corner);
    Vec3 normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    double length = vec3_length(normal), largest = 0;
    if (!(length > 0)) return; /* it has no area, and is never met */
    normal = vec3_scale(normal, 1 / length);
    for (int k = 0; k < 3; k++) {
        from_place[k] = vec3_sub(corner[k], here->place);
        largest = double_max(largest, vec3_max_abs(corner[k]));
    }
    double coordinate = double_min(largest, rtc_coordinate_across(placed, primitive, corner, normal));
    tell(here, (RtcSurface){.object = object,
                            .normal = vec3f_from(normal),
                            .distance = sqrt(squared_to_triangle(from_place)),
                            .rounding = double_max(here->rounding, UNIT_ROUNDING * coordinate)});
}

static double size_of(const Piece *piece)
{
    double most =
        double_max(double_max(fabs(piece->r0), fabs(piece->r1)), double_max(fabs(piece->y0), fabs(piece->y1)));
    if (piece->kind != PIECE_OUTER_ARC && piece->kind != PIECE_INNER_ARC) return most;
    return double_max(most, double_max(fabs(piece->centre_r), fabs(piece->centre_y)));
}

/* Which way the distance to a piece grows, by steps so small that they stay on one side of it. */
static Vec3 away_from(const Piece *piece, Vec3 p, double distance)
{
    double by = 0.5 * distance;
    Vec3 x = vec3(by, 0, 0), y = vec3(0, by, 0), z = vec3(0, 0, by);
    Vec3 grows = vec3(piece_distance(piece, vec3_add(p, x)) - piece_distance(piece, vec3_sub(p, x)),
                      piece_distance(piece, vec3_add(p, y)) - piece_distance(piece, vec3_sub(p, y)),
                      piece_distance(piece, vec3_add(p, z)) - piece_distance(piece, vec3_sub(p, z)));
    return vec3_scale(grows, 1 / distance);
}

/* In the world the distance to what is flat goes with the normal's length there, however the piece is stretched. */
static void ask_piece(const Here *here, uint32_t object, const Piece *piece)
{
    const RtcPlaced *placed = &here->scene->objects[object];
    Affine to_local = rtc_to_local(here->scene, placed, here->time),
           to_world = rtc_to_world(here->scene, placed, here->time);
    Vec3 local = affine_point(&to_local, here->place), across = vec3(1, 1, 1);
    double distance = piece_distance(piece, local), largest = vec3_max_abs(local) + size_of(piece),
           local_noise = PIECE_NOISE * (largest + affine_largest_stretch(&to_local) * vec3_max_abs(to_world.t));
    bool on_it = distance <= local_noise;
    Vec3 normal = vec3_normalize(affine_normal(&to_local, piece_normal(piece, local, across, 0)));
    double growth = on_it ? 1 : vec3_length(affine_normal(&to_local, away_from(piece, local, distance)));
    tell(here, (RtcSurface){.object = object,
                            .normal = vec3f_from(normal),
                            .distance = on_it        ? 0
                                        : growth > 0 ? distance / growth
                                                     : HUGE_VAL,
                            .rounding = here->rounding});
}

static void ask_part(const Here *here, const RtcPieceSet *set, uint32_t primitive)
{
    if (primitive < set->n_balls) {
        uint32_t object = set->balls[primitive];
        ask_piece(here, object, &here->scene->objects[object].solid->pieces[0]);
        return;
    }
    const RtcPiece *which = &set->pieces[rtc_part(set, primitive).number];
    ask_piece(here, which->object, which->shape);
}

static bool ask(struct RTCPointQueryFunctionArguments *arguments)
{
    const Here *here = arguments->userPtr;
    const RtcScene *scene = here->scene;
    uint32_t object = arguments->context->instStackSize ? arguments->context->instID[0] : arguments->geomID,
             primitive = arguments->primID;
    if (object >= scene->n_objects) {
        ask_part(here, object == scene->n_objects ? &scene->still : &scene->moving, primitive);
        return false;
    }
    bool single = mesh_quad_is_single(scene->objects[object].mesh->quads[primitive].vertex);
    ask_triangle(here, object, 2 * primitive);
    if (!single) ask_triangle(here, object, 2 * primitive + 1);
    return false;
}

void rtc_surfaces_at(const RtcScene *scene, Vec3 place, double time, RtcFound *found, void *context)
{
    Here here = {scene, place, time, rtc_rounding(place), found, context};
    /* what a triangle's own coordinates come to, and enough for the boxes of what is exact */
    double coarse = UNIT_ROUNDING * (double)rtc_grain_at(&scene->grain, place) + PIECE_NOISE * scene->reach;
    struct RTCPointQuery about = {.x = (float)place.x,
                                  .y = (float)place.y,
                                  .z = (float)place.z,
                                  .time = (float)time,
                                  .radius = (float)(2 * here.rounding + coarse)};
    struct RTCPointQueryContext of_query;
    rtcInitPointQueryContext(&of_query);
    rtcPointQuery(scene->world, &about, &of_query, ask, &here);
    for (uint32_t i = 0; i < scene->n_few; i++) ask_part(&here, &scene->still, i);
    for (uint32_t i = 0; i < scene->n_planes; i++) {
        uint32_t object = scene->planes[i].object;
        ask_piece(&here, object, &scene->objects[object].solid->pieces[0]);
    }
}

/* rtc_coordinates.c - where on an object a surface was met, for textures.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_scene.h"

/* The gradient along a triangle of what is a at its first corner and larger by `second` and `third` at the others. */
static Vec3 gradient(Vec3 edge_second, Vec3 edge_third, double second, double third)
{
    Vec3 normal = vec3_cross(edge_second, edge_third);
    double square = vec3_dot(normal, normal);
    if (!(square > 0)) return vec3(0, 0, 0);
    Vec3 sum = vec3_along(vec3_scale(vec3_cross(edge_third, normal), second), third, vec3_cross(normal, edge_second));
    return vec3_scale(sum, 1 / square);
}

static void mesh_coordinates(const RtcPlaced *object, const Hit *hit, bool with_uv, RtcCoordinates *coordinates)
{
    const Mesh *mesh = object->mesh->source;
    uint32_t triangle[3];
    Vec3 corner[3];
    rtc_triangle_of(object->mesh, hit->primitive, triangle);
    for (int i = 0; i < 3; i++) corner[i] = vec3_from_f(mesh->positions[triangle[i]]);
    Vec3 second = vec3_sub(corner[1], corner[0]), third = vec3_sub(corner[2], corner[0]);
    double b = (double)hit->u, c = (double)hit->v;
    coordinates->local = vec3_along(vec3_along(corner[0], b, second), c, third);
    coordinates->has_uv = mesh->uvs != NULL;
    if (!mesh->uvs || !with_uv) return;
    Vec3 gradients[2];
    for (int k = 0; k < 2; k++) {
        double at[3];
        for (int i = 0; i < 3; i++) at[i] = (double)mesh->uvs[2 * (size_t)triangle[i] + (size_t)k];
        coordinates->uv[k] = (float)(at[0] + b * (at[1] - at[0]) + c * (at[2] - at[0]));
        gradients[k] = gradient(second, third, at[1] - at[0], at[2] - at[0]);
    }
    coordinates->du = gradients[0];
    coordinates->dv = gradients[1];
}

void rtc_coordinates(const RtcScene *scene, const Ray *ray, const Hit *hit, bool with_uv, RtcCoordinates *coordinates)
{
    const RtcPlaced *object = &scene->objects[hit->object];
    coordinates->to_local = rtc_to_local(scene, object, ray->time);
    coordinates->uv[0] = coordinates->uv[1] = 0;
    coordinates->du = coordinates->dv = vec3(0, 0, 0);
    if (object->is_mesh) {
        mesh_coordinates(object, hit, with_uv, coordinates);
        return;
    }
    coordinates->local = affine_point(&coordinates->to_local, ray_point(ray, hit->t));
    coordinates->has_uv = true;
    if (!with_uv) return;
    const Piece *piece = &object->solid->pieces[hit->primitive];
    PieceRoot root;
    piece_surface(piece, affine_point(&coordinates->to_local, ray->origin),
                  affine_vector(&coordinates->to_local, vec3_from_f(ray->direction)), hit->t, &root);
    coordinates->uv[0] = (float)root.u;
    coordinates->uv[1] = (float)root.v;
    piece_gradients(piece, coordinates->local, &coordinates->du, &coordinates->dv);
}

/* texture_view.c - where on its object a hit is, for textures; what surfaces shine that have one for that.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/texture_view.h"

/* The uv of a mesh without any: each side of the box around it is 0..1, to the right and up seen from outside. */
static void uv_of_box(const Box3 *box, const RtcCoordinates *at, Vec3 outward, float uv[2], Vec3 *du, Vec3 *dv)
{
    Vec3 normal = affine_outward(&at->to_local, affine_determinant(&at->to_local) < 0, outward);
    Vec3 low = box->min, size = vec3_sub(box->max, box->min), p = vec3_sub(at->local, low);
    double ax = fabs(normal.x), ay = fabs(normal.y), az = fabs(normal.z);
    size = vec3(fmax(size.x, 1e-30), fmax(size.y, 1e-30), fmax(size.z, 1e-30));
    double u = p.x / size.x, v = p.y / size.y;
    *du = vec3(1 / size.x, 0, 0);
    *dv = vec3(0, 1 / size.y, 0);
    bool turned = normal.z < 0;
    if (ax >= ay && ax >= az) {
        u = p.z / size.z;
        *du = vec3(0, 0, 1 / size.z);
        turned = normal.x > 0;
    } else if (ay >= az) {
        bool up = normal.y > 0;
        v = up ? 1 - p.z / size.z : p.z / size.z;
        *dv = vec3(0, 0, (up ? -1 : 1) / size.z);
        turned = false;
    }
    uv[0] = (float)(turned ? 1 - u : u);
    uv[1] = (float)v;
    if (turned) *du = vec3_scale(*du, -1);
}

/* u and v, and their gradients in the textures' frame, to which they go as normals do. */
static void view_uv(const SceneTextureFrame *frame, const RtcCoordinates *at, Vec3 outward, TexturePlace *place)
{
    Vec3 du = at->du, dv = at->dv;
    if (at->has_uv)
        for (int i = 0; i < 2; i++) place->uv[i] = at->uv[i];
    else
        uv_of_box(&frame->box, at, outward, place->uv, &du, &dv);
    place->du = frame->moved ? vec3_scale(affine_area(&frame->from_shape, du), frame->inverse) : du;
    place->dv = frame->moved ? vec3_scale(affine_area(&frame->from_shape, dv), frame->inverse) : dv;
}

/* How many times longer lengths are behind a map: of its three directions a mean, exact where they are alike. */
static double stretch_of(const Affine *map)
{
    return affine_max_stretch(map) * 0.57735026918962576; /* 1 / sqrt(3) */
}

/* Where a pattern has a face where the surface is, what shows is the inside. */
static Vec3 beneath(Vec3 place, Vec3 normal)
{
    const double deep = 4e-6;
    return vec3_along(place, -deep * vec3_max_abs(place), normal);
}

/* The object moves otherwise than the node that it was described in. */
static SceneTextureFrame frame_at(const Scene *scene, const SceneTextureFrame *frame, double time)
{
    SceneTextureFrame now = *frame;
    now.from_shape = affine_between(scene_motion(scene, frame->motion), scene->n_keys, time);
    now.moved = true;
    now.inverse = 1 / affine_determinant(&now.from_shape);
    return now;
}

static Vec3 outward_of(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit)
{
    return vec3_from_f(surface->textures_use_normal ? rtc_shading_normal(world->compiled->rtc, ray, hit) : hit->normal);
}

static void view_object(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit, Vec3 outward,
                        double footprint, TextureView *view)
{
    const Scene *scene = world->scene;
    const SceneTextureFrame *frame = &scene->texture_frames[scene->objects[hit->object].texture_frame];
    SceneTextureFrame now;
    if (UNLIKELY(frame->motion != SCENE_NONE)) {
        now = frame_at(scene, frame, ray->time);
        frame = &now;
    }
    const RtcCoordinates *at = &view->coordinates;
    rtc_coordinates(world->compiled->rtc, ray, hit, surface->textures_use_uv, &view->coordinates);
    TexturePlace *place = &view->at;
    view->to_texture = &at->to_local;
    if (frame->moved) {
        view->composed = affine_compose(&frame->from_shape, &at->to_local);
        view->to_texture = &view->composed;
    }
    view->mirrored = affine_determinant(view->to_texture) < 0;
    Vec3 normal = affine_outward(view->to_texture, view->mirrored, outward);
    if (surface->textures_use_uv) {
        view_uv(frame, at, outward, place);
    } else {
        place->du = place->dv = vec3(0, 0, 0);
    }
    place->object = frame->moved ? affine_point(&frame->from_shape, at->local) : at->local;
    place->object_normal = vec3_scale(normal, 1 / vec3_length(normal));
    place->object = beneath(place->object, place->object_normal);
    place->footprint = footprint * stretch_of(view->to_texture);
}

void texture_view(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit, double footprint,
                  TextureView *view)
{
    TexturePlace *place = &view->at;
    place->uv[0] = place->uv[1] = 0;
    place->world_normal = outward_of(world, surface, ray, hit);
    if (surface->textures_use_object) view_object(world, surface, ray, hit, place->world_normal, footprint, view);
    place->world = beneath(ray_point(ray, hit->t), place->world_normal);
    place->world_footprint = footprint;
    place->time = ray->time;
    place->identity = world->looks[hit->object].identity;
}

void texture_uv(const World *world, const Ray *ray, const Hit *hit, float uv[2])
{
    RtcCoordinates at;
    rtc_coordinates(world->compiled->rtc, ray, hit, true, &at);
    if (!at.has_uv && world->mesh_boxes) {
        const SceneShape *shapes = world->scene->shapes;
        uint32_t shape = world->scene->objects[hit->object].shape, whole = shapes[shape].layer_of;
        uv_of_box(&world->mesh_boxes[whole == SCENE_NONE ? shape : whole], &at, vec3_from_f(hit->normal), at.uv, &at.du,
                  &at.dv);
    }
    uv[0] = at.uv[0];
    uv[1] = at.uv[1];
}

Lanes texture_emission(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit,
                       double footprint, Lanes wavelength_nm)
{
    TextureView view;
    texture_view(world, surface, ray, hit, footprint, &view);
    Lanes light = texture_at(world->scene->textures, surface->emission_texture, &view.at, wavelength_nm);
    return lanes_scale(lanes_clamp(light, 0, HUGE_VALF), surface->emission_factor);
}

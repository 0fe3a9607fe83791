/* texture_shade.c - what textures make of a surface at a hit: its parameters, and its shading normal.
 *
 * How small the details are that a look-up needs to tell apart comes from a cone around the path: [AM19], without the
 * curvature of surfaces. Instead of that, what is seen by way of boundaries and mirrors is told apart four times as
 * finely, as glass may magnify it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/texture_shade.h"

#include "optics/sampling.h"
#include "trace/texture_view.h"

void path_reach(Path *path, const Event *event)
{
    if (event->kind == EVENT_SCATTER)
        path->cone_width += path->cone_spread * (float)event->t;
    else if (event->kind == EVENT_OPAQUE || event->kind == EVENT_BOUNDARY)
        path->cone_width += path->cone_spread * (float)event->hit.t;
}

void path_widen(Path *path)
{
    /* of the angle that holds most of the directions that could have been taken: the next event is seen from one of many
     * paths, whose mean blurs it already */
    const float part = 0.125f, magnified = 0.25f;
    if (path->scatter_pdf > 0) {
        float spread = part * sqrtf(1 / (SAMPLING_PI * path->scatter_pdf));
        path->cone_spread = float_max(path->cone_spread, float_min(spread, part));
    } else if (!path->cone_bent) {
        path->cone_bent = true;
        path->cone_spread *= magnified;
        path->cone_width *= magnified;
    }
}

/* ---- relief ---- */

/* Two directions along a surface. */
static void tangents_of(Vec3 normal, Vec3 *first, Vec3 *second)
{
    Vec3f x, y;
    sampling_basis(vec3f_from(normal), &x, &y);
    *first = vec3_from_f(x);
    *second = vec3_from_f(y);
}

/* Over which length slopes are found at least: on a picture that floats of uv can tell apart; else a part of the relief's height, as
 * what is much finer than it is high would be all spikes, so far as coordinates tell it. */
static double least_step(const SceneSurface *surface, const TexturePlace *at)
{
    double far = vec3_max_abs(at->object), steep = fmax(vec3_length(at->du), vec3_length(at->dv));
    if (steep > 0) return fmin(1e-4 * far, 1e-4 / steep);
    return fmax(1e-7 * far, fmin(1e-4 * far, 0.01 * fabs(surface->bump_height)));
}

/* How fast the bump rises, along the surface, in the textures' frame. Heights are lengths of that frame. */
static Vec3 slope_of_bump(const World *world, const SceneSurface *surface, const TextureView *view)
{
    const TexturePlace *at = &view->at;
    Affine to_world;
    if (!affine_invert(view->to_texture, &to_world)) return vec3(0, 0, 0);
    double step = fmax(0.5 * at->footprint, fmax(least_step(surface, at), 1e-9));
    Vec3 along[2], slope = vec3(0, 0, 0);
    tangents_of(at->object_normal, &along[0], &along[1]);
    for (int i = 0; i < 2; i++) {
        Vec3 offset = vec3_scale(along[i], step), in_world = affine_vector(&to_world, offset);
        TexturePlace ahead = texture_place_moved(at, offset, in_world);
        TexturePlace behind = texture_place_moved(at, vec3_scale(offset, -1), vec3_scale(in_world, -1));
        double rise = (double)texture_number_at(world->scene->textures, surface->bump, &ahead) -
                      (double)texture_number_at(world->scene->textures, surface->bump, &behind);
        slope = vec3_along(slope, surface->bump_height * rise / (2 * step), along[i]);
    }
    return slope;
}

/* A normal map's normal about the shading normal n, in the textures' frame; n where the surface has no tangents. */
static Vec3 normal_of_map(const Scene *scene, const SceneSurface *surface, const TextureView *view, Vec3 n)
{
    Vec3f coded = texture_vector_at(&scene->textures[surface->normal_map], &view->at);
    double x = (double)(surface->normal_x * (2 * coded.x - 1)), y = (double)(surface->normal_y * (2 * coded.y - 1));
    double z = fmax((double)(2 * coded.z - 1), 1e-3);
    /* along u while v stays, at a right angle to n; the other way round for v */
    Vec3 u = vec3_cross(view->at.dv, n), v = vec3_cross(n, view->at.du);
    if (vec3_dot(u, view->at.du) < 0) { /* a mirrored map */
        u = vec3_scale(u, -1);
        v = vec3_scale(v, -1);
    }
    double long_u = vec3_length(u), long_v = vec3_length(v);
    if (!(long_u > 0) || !(long_v > 0)) return n;
    return vec3_normalize(vec3_along(vec3_along(vec3_scale(n, z), x / long_u, u), y / long_v, v));
}

/* [Keller17] A.3: a shading normal that would
 * send the mirrored direction into the surface is bent back, just so far that it does not. view: to where the path comes
 * from; both on the geometric normal's side. */
Vec3f path_bend_normal(Vec3f view, Vec3f geometric, Vec3f normal)
{
    /* how high over the surface the mirrored direction stays: never both low and lower than it came, or light within glass
     * would creep along its surface ever more closely */
    const float least = 0.05f;
    float cosine = vec3f_dot(view, normal), low = float_min(vec3f_dot(view, geometric), least);
    Vec3f mirrored = vec3f_along(vec3f_negate(view), 2 * cosine, normal);
    float height = vec3f_dot(mirrored, geometric);
    if (height >= low) return normal;
    mirrored = vec3f_along(mirrored, low - height, geometric);
    float length = vec3f_length(mirrored);
    if (!(length > 1e-6f)) return geometric;
    Vec3f half = vec3f_along(view, 1 / length, mirrored);
    length = vec3f_length(half);
    return length > 1e-6f ? vec3f_scale(half, 1 / length) : geometric;
}

static void add_relief(const Path *path, const Event *event, const SceneSurface *surface, const TextureView *view,
                       SurfacePlace *place)
{
    const World *world = path->tracer->world;
    bool front = event->hit.entering;
    Affine to_world;
    if (!affine_invert(view->to_texture, &to_world)) return;
    Vec3 outward = vec3_from_f(front ? place->normal : vec3f_negate(place->normal));
    Vec3 n = vec3_normalize(affine_outward(view->to_texture, view->mirrored, outward));
    if (surface->normal_map != SCENE_NONE) n = normal_of_map(world->scene, surface, view, n);
    if (surface->bump != SCENE_NONE) {
        Vec3 slope = slope_of_bump(world, surface, view);
        slope = vec3_along(slope, -vec3_dot(slope, n), n);
        n = vec3_sub(n, slope);
    }
    Vec3 turned = affine_normal(view->to_texture, n);
    double length = vec3_length(turned);
    if (!(length > 0) || !isfinite(length)) return;
    Vec3f normal = vec3f_from(vec3_scale(turned, (front ? 1 : -1) / length));
    place->normal = path_bend_normal(vec3f_negate(path->ray.direction), place->geometric, normal);
}

/* ---- parameters ---- */

void path_relief(const Path *path, const Event *event, const SceneSurface *surface, double footprint,
                 SurfacePlace *place)
{
    TextureView view;
    texture_view(path->tracer->world, surface, &path->ray, &event->hit, footprint, &view);
    add_relief(path, event, surface, &view, place);
}

static void read_color(const Scene *scene, const SurfaceTexture *texture, const TexturePlace *at, Lanes wavelength_nm,
                       Spectrum *out)
{
    Lanes value = lanes_clamp(texture_at(scene->textures, texture->texture, at, wavelength_nm), 0, 1);
    *out = (Spectrum){.kind = SPECTRUM_LANES, .scale = 1};
    for (int i = 0; i < LANES; i++) out->value[i] = lanes_get(value, i);
}

static float read_number(const Scene *scene, const SurfaceTexture *texture, const TexturePlace *at)
{
    return texture->factor *
           float_min(float_max(texture_number_at(scene->textures, texture->texture, at), texture->least),
                     texture->most);
}

float texture_mix_weight(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit,
                         double footprint)
{
    const SurfaceTexture *texture = surface->textures;
    const SurfaceTexture *end = texture + surface->n_textures;
    while (texture < end && texture->offset != offsetof(BsdfSpec, mix_weight)) texture++;
    if (texture == end) return surface->spec.mix_weight;
    TextureView view;
    texture_view(world, surface, ray, hit, footprint, &view);
    return read_number(world->scene, texture, &view.at);
}

static void read_spec(const Scene *scene, const SceneSurface *surface, const TexturePlace *at, Lanes wavelength_nm,
                      BsdfSpec *spec)
{
    if (surface->finished || surface->mixed || surface->painted || surface->roughness > 0)
        *spec = surface->spec;
    else
        spec->base_color = surface->spec.base_color; /* all that is asked of what is matte */
    for (uint32_t i = 0; i < surface->n_textures; i++) {
        const SurfaceTexture *texture = &surface->textures[i];
        void *target = (char *)spec + texture->offset;
        if (texture->color)
            read_color(scene, texture, at, wavelength_nm, target);
        else
            *(float *)target = read_number(scene, texture, at);
    }
}

void texture_read_spec(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit,
                       double footprint, Lanes wavelength_nm, BsdfSpec *spec)
{
    TextureView view;
    texture_view(world, surface, ray, hit, footprint, &view);
    read_spec(world->scene, surface, &view.at, wavelength_nm, spec);
}

void path_read_textures(const Path *path, const Event *event, const SceneSurface *surface, SurfacePlace *place,
                        Lanes wavelength_nm, BsdfSpec *spec)
{
    TextureView view;
    double footprint = path_footprint(path, surface_is_pane(surface));
    texture_view(path->tracer->world, surface, &path->ray, &event->hit, footprint, &view);
    read_spec(path->tracer->world->scene, surface, &view.at, wavelength_nm, spec);
    if (surface_has_relief(surface)) add_relief(path, event, surface, &view, place);
}

void path_read_albedos(const Path *path, const Event *event, const SceneSurface *surface,
                       const Lanes wavelength_nm[COLOR_FOURS], Lanes albedo[COLOR_FOURS])
{
    const World *world = path->tracer->world;
    uint32_t i = 0;
    while (i < surface->n_textures && surface->textures[i].offset != offsetof(BsdfSpec, base_color)) i++;
    const bool textured = i < surface->n_textures;
    if (!textured)
        for (int k = 0; k < COLOR_FOURS; k++) albedo[k] = spectrum_at(&surface->spec.base_color, wavelength_nm[k]);
    if (!textured && !surface->spec.measured_metal) return;
    const Wavelengths at = {COLOR_FOURS, wavelength_nm};
    BsdfSpec spec;
    TextureView view;
    texture_view(world, surface, &path->ray, &event->hit, (double)path->cone_width, &view);
    if (textured) texture_at_each(world->scene->textures, surface->textures[i].texture, &view.at, &at, albedo);
    for (int k = 0; k < COLOR_FOURS && textured; k++) albedo[k] = lanes_clamp(albedo[k], 0, 1);
    if (!surface->spec.measured_metal) return;
    read_spec(world->scene, surface, &view.at, wavelength_nm[0], &spec);
    bsdf_mix_metal(&spec, wavelength_nm, COLOR_FOURS, albedo);
}

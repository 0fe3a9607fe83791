/* gltf_views.c - the cameras and lights (KHR_lights_punctual) of a glTF file's nodes.
 * What is not made as it should be counts as not there.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/array.h"
#include "mesh/gltf_data.h"

static double number_or(const json_t *holder, const char *key, double otherwise)
{
    const json_t *item = json_object_get(holder, key);
    return json_is_number(item) ? json_number_value(item) : otherwise;
}

/* A copy of the thing's name, else of its node's. */
static char *name_of(const json_t *thing, const json_t *node)
{
    const char *name = json_string_value(json_object_get(node, "name"));
    if (!name) name = json_string_value(json_object_get(thing, "name"));
    return strdup(name ? name : "");
}

static void list_camera(const Gltf *gltf, const json_t *node, const Affine *to_world, MeshSource *source)
{
    const json_t *json = gltf_numbered(json_object_get(gltf->root, "cameras"), json_object_get(node, "camera"), NULL);
    const json_t *lens = json_object_get(json, "perspective"), *flat = json_object_get(json, "orthographic");
    MeshCamera camera = {.to_world = *to_world, .orthographic = !lens};
    camera.fov_y = number_or(lens, "yfov", 0);
    camera.width = lens ? number_or(lens, "aspectRatio", 0) : 2 * fabs(number_or(flat, "xmag", 0));
    camera.height = lens ? 1 : 2 * fabs(number_or(flat, "ymag", 0));
    bool fine =
        lens ? camera.fov_y > 0 && camera.fov_y < MEN_PI && camera.width >= 0 : camera.width > 0 && camera.height > 0;
    if (!fine || !ARRAY_ROOM(source->cameras, source->camera_capacity, source->n_cameras)) return;
    camera.name = name_of(json, node);
    source->cameras[source->n_cameras++] = camera;
}

static void list_light(const Gltf *gltf, const json_t *node, const Affine *to_world, MeshSource *source)
{
    static const char name[] = "KHR_lights_punctual";
    const json_t *of_node = json_object_get(json_object_get(node, "extensions"), name);
    const json_t *lights = json_object_get(json_object_get(json_object_get(gltf->root, "extensions"), name), "lights");
    const json_t *json = gltf_numbered(lights, json_object_get(of_node, "light"), NULL);
    const char *kind = json_string_value(json_object_get(json, "type"));
    if (!kind || !ARRAY_ROOM(source->lights, source->light_capacity, source->n_lights)) return;
    MeshLight light = {.to_world = *to_world, .kind = MESH_LIGHT_POINT};
    if (strcmp(kind, "directional") == 0) light.kind = MESH_LIGHT_DISTANT;
    if (strcmp(kind, "spot") == 0) light.kind = MESH_LIGHT_SPOT;
    const json_t *spot = json_object_get(json, "spot"), *color = json_object_get(json, "color");
    light.inner = number_or(spot, "innerConeAngle", 0);
    light.outer = number_or(spot, "outerConeAngle", MEN_PI / 4);
    light.intensity = number_or(json, "intensity", 1);
    for (size_t i = 0; i < 3; i++) {
        const json_t *part = json_array_get(color, i);
        light.color[i] = json_is_number(part) ? fmax(json_number_value(part), 0) : 1;
    }
    if (!(light.intensity >= 0) || !(light.outer > 0 && light.outer <= MEN_PI / 2 + 1e-6)) return;
    light.inner = fmin(fmax(light.inner, 0), light.outer);
    light.name = name_of(json, node);
    source->lights[source->n_lights++] = light;
}

void gltf_list_views(const Gltf *gltf, const json_t *node, const Affine *to_world, MeshSource *source)
{
    const Affine *m = to_world;
    double size = fabs(affine_determinant(m));
    if (!vec3_is_finite(m->t) || !(size > 0) || !isfinite(size)) return; /* it looks nowhere */
    if (json_object_get(node, "camera")) list_camera(gltf, node, to_world, source);
    list_light(gltf, node, to_world, source);
}

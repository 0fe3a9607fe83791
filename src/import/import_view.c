/* import_view.c - lights and cameras of a scene from a mesh file: those of the file, or such as show what is there.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/attr.h"
#include "import/import_parts.h"
#include "lang/value.h"

static const double azimuth = 30, elevation = 22, lens = 28; /* degrees: of the camera where the file has none */
static const double film_shape = 4.0 / 3;

static Vec3 to_scene(const Importer *im, const Affine *map, Vec3 p)
{
    return vec3_scale(affine_point(map, p), im->file_m / im->scene_m);
}

static Vec3 direction_of(const Affine *map, Vec3 d)
{
    return vec3_normalize(affine_vector(map, d));
}

static double size_of(Box3 box)
{
    Vec3 d = vec3_sub(box.max, box.min);
    return double_max(double_max(d.x, d.y), d.z);
}

/* Not larger than a number, and of one digit: 1, 2 or 5. */
static double round_down(double value)
{
    double power = pow(10, floor(log10(value))), digit = value / power;
    return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

/* ---- lights of the file ---- */

/* Candela, and lux, are 683 lumen to the watt: so Blender exports them unless told otherwise. */
static const double lumen_to_watt = 1.0 / 683;

static bool camera_is_near(const Importer *im, Vec3 at, double distance)
{
    for (size_t i = 0; i < im->source->n_cameras; i++) {
        Vec3 from = to_scene(im, &im->source->cameras[i].to_world, vec3(0, 0, 0));
        if (vec3_length(vec3_sub(from, at)) < distance) return true;
    }
    return false;
}

/* Within what a scene can have: coordinates, cones, radiances. */
static bool light_has_measure(const Importer *im, const MeshLight *light, double radius_m)
{
    const double farthest = 1e14, brightest = 1e29, least_area = 1e-5 /* of a distant light: steradians */;
    Vec3 at = to_scene(im, &light->to_world, vec3(0, 0, 0));
    double color = double_max(double_max(light->color[0], light->color[1]), double_max(light->color[2], 1));
    double area = light->kind == MESH_LIGHT_DISTANT ? least_area : MEN_PI * radius_m * radius_m;
    bool narrow = light->kind == MESH_LIGHT_SPOT && light->outer < 1e-5;
    return vec3_length(at) < farthest && light->intensity * lumen_to_watt * color < brightest * area && !narrow;
}

static void write_light(Importer *im, const MeshLight *light)
{
    static const char *const shapes[] = {"sphere", "disc", "distant"};
    double watts = light->intensity * lumen_to_watt; /* per steradian, or square metre */
    double radius = round_down(size_of(im->all) / 50);
    Vec3 at = to_scene(im, &light->to_world, vec3(0, 0, 0)), along = direction_of(&light->to_world, vec3(0, 0, -1));
    double away = size_of(im->all);
    if (!light_has_measure(im, light, radius * im->scene_m)) {
        import_note(im, "one of its lights is too far away, too narrow or too bright, and is left out");
        import_write_comment(im);
        return;
    }
    if (light->kind == MESH_LIGHT_SPOT && camera_is_near(im, at, radius)) {
        import_say(im, "It is moved back by its radius: a camera is where it was, and would be on its surface.");
        at = vec3_sub(at, vec3_scale(along, radius));
    }
    char *name = import_name(im, light->name, "lamp", "lamp");
    NodeText node = node_begin(im, "light", name);
    node_word(&node, "shape", shapes[light->kind]);
    if (light->kind == MESH_LIGHT_DISTANT) at = vec3_sub(box3_centre(im->shown), vec3_scale(along, 2 * away));
    node_point(&node, "from", at);
    if (light->kind == MESH_LIGHT_DISTANT)
        node_point(&node, "to", box3_centre(im->shown));
    else if (light->kind == MESH_LIGHT_SPOT)
        node_point(&node, "to", vec3_add(at, vec3_scale(along, away)));
    if (light->kind != MESH_LIGHT_DISTANT) add_coordinate(im, node_prop(&node, "radius"), radius);
    if (light->kind == MESH_LIGHT_SPOT) {
        double metres = radius * im->scene_m;
        node_number(&node, "angle", double_min(2 * light->outer / MEN_DEGREE, 180));
        node_number(&node, "blend", 1 - light->inner / light->outer);
        node_number(&node, "radiance", watts / (MEN_PI * metres * metres));
        import_say(
            im,
            "A spot of %.4g W in Blender, which counts what its cone keeps back, too: radiance is that of its disc.",
            4 * MEN_PI * watts);
    } else {
        node_number(&node, "power", light->kind == MESH_LIGHT_POINT ? 4 * MEN_PI * watts : watts);
    }
    if (light->color[0] != 1 || light->color[1] != 1 || light->color[2] != 1) node_color(&node, "color", light->color);
    if (light->kind != MESH_LIGHT_DISTANT) node_word(&node, "visible", "false");
    node_end(&node);
    free(name);
    im->out->n_lights++;
}

/* What falls on a square metre in the middle of what is shown, if nothing is in the way: W/m2. */
static double irradiance(const Importer *im)
{
    double sum = 0;
    for (size_t i = 0; i < im->source->n_lights; i++) {
        const MeshLight *light = &im->source->lights[i];
        double watts = light->intensity * lumen_to_watt;
        Vec3 along = direction_of(&light->to_world, vec3(0, 0, -1));
        Vec3 way = vec3_sub(box3_centre(im->shown), to_scene(im, &light->to_world, vec3(0, 0, 0)));
        double away = vec3_length(way) * im->scene_m;
        bool aside = light->kind == MESH_LIGHT_SPOT && vec3_dot(vec3_normalize(way), along) < cos(light->outer);
        if (light->kind == MESH_LIGHT_DISTANT)
            sum += watts;
        else if (away > 0 && !aside)
            sum += watts / (away * away);
    }
    return sum;
}

/* Stops by which the picture is to be brighter: none where what is white comes out somewhere between an eighth and eight, as it does
 * of Blender's watts; other programs have lamps of some candela and look at them for longer. */
static double choose_exposure(const Importer *im)
{
    const double wanted = 2; /* W/m2, of which white looks like 0.6 */
    double there = irradiance(im);
    if (!(there > 0) || !isfinite(there)) return 0;
    double stops = round(log2(wanted / there));
    return fabs(stops) <= 3 ? 0 : double_min(double_max(stops, -50), 50);
}

static bool any_shines(const Importer *im)
{
    for (size_t i = 0; i < im->n_items; i++)
        if (import_shines(import_material_of(im, &im->items[i])->said) && !import_is_filled(im, &im->items[i]))
            return true;
    return false;
}

/* ---- lights of the studio ---- */

static double azimuth_of_view(const Importer *im)
{
    if (!im->source->n_cameras) return azimuth;
    Vec3 along = direction_of(&im->source->cameras[0].to_world, vec3(0, 0, -1));
    return fabs(along.x) + fabs(along.z) > 0.01 ? atan2(-along.x, -along.z) / MEN_DEGREE : azimuth;
}

/* Glass alone is black but for its glints, however bright the lamps are: nothing is there that they light. */
static bool all_clear(const Importer *im)
{
    for (size_t i = 0; i < im->n_items; i++)
        if (!import_material_of(im, &im->items[i])->clear) return false;
    return im->n_items > 0;
}

static bool any_clear(const Importer *im)
{
    for (size_t i = 0; i < im->n_items; i++)
        if (import_material_of(im, &im->items[i])->clear) return true;
    return false;
}

static void write_studio(Importer *im)
{
    Box3 box = im->shown;
    Vec3 foot = box3_centre(box);
    foot.y = box.min.y;
    double size = size_of(box);
    if (im->dark && im->paper)
        import_say(im, "The file has no light: paper and lights of the standard library, around what it shows.");
    else if (im->dark)
        import_say(im, "The file has no light: lights of the standard library, around what it shows.");
    else if (all_clear(im))
        import_say(im,
                   "All that the file shows is clear, and there is nothing that its lights would fall on: paper of the "
                   "standard library, to stand on.");
    else
        import_say(im, "Paper of the standard library, to stand on.");
    import_write_comment(im);
    buf_add(im->text, "group {");
    if (im->paper) {
        buf_add(im->text, "\n  studio.sweep(");
        add_coordinate(im, im->text, size);
        buf_add(im->text, ", ");
        add_number(im->text, 1e-4 * size);
        buf_add(im->text, ")");
    }
    if (im->dark) {
        buf_add(im->text, "\n  studio.product_lights(");
        add_coordinate(im, im->text, size);
        buf_add(im->text, ")");
    }
    buf_add(im->text, "\n  rotate(y, ");
    add_number(im->text, round(azimuth_of_view(im)));
    buf_add(im->text, ")");
    if (foot.x != 0 || foot.y != 0 || foot.z != 0) {
        buf_add(im->text, "  translate(");
        add_point(im, im->text, foot);
        buf_add(im->text, ")");
    }
    buf_add(im->text, "\n}\n");
}

static bool has_floor(const Importer *im)
{
    for (size_t i = 0; i < im->n_items; i++)
        if (im->items[i].is_floor) return true;
    return false;
}

void import_choose_lights(Importer *im)
{
    ImportFloor floor = im->options->floor;
    im->exposure = choose_exposure(im);
    im->dark = im->source->n_lights == 0 && !any_shines(im);
    im->room = !im->dark && any_clear(im);
    im->paper = floor == FLOOR_ON || (floor == FLOOR_AUTO && (im->dark || all_clear(im)) && !has_floor(im));
}

/* What is around the things shown, of which mesh files say nothing. Glass shows it: where it is even, glass is seen by its rims
 * alone, so that it gets something to mirror. */
static void write_surrounding(Importer *im)
{
    const bool lit = im->source->n_lights > 0;
    if (im->room)
        import_say(im, "The light of a room with two windows, of which such a file says nothing: glass shows what is "
                       "around it.");
    else if (!im->dark)
        import_say(im,
                   "A little light from all around, of which such a file says nothing: metal shows what is around it.");
    NodeText around = node_begin(im, im->room ? "studio.room" : "environment", NULL);
    const double of_walls = lit ? 0.15 : 0.2, even = im->dark ? 0.23 : lit ? 0.05 : 0.2;
    node_number(&around, im->room ? "light" : "color",
                (im->room ? of_walls : even) * (lit ? pow(2, -im->exposure) : 1));
    if (im->room) buf_format(&around.line, "  rotate(y, %g)", round(azimuth_of_view(im)));
    node_end(&around);
}

void import_write_lights(Importer *im)
{
    const MeshSource *source = im->source;
    import_begin_section(im, "Light");
    if (source->n_lights)
        import_say(im, "Strengths are taken as candela and lux of 683 lumen to the watt, as Blender exports them "
                       "unless told otherwise, so that power is what it has there. Lights have a size here; theirs is "
                       "a guess, which makes shadows softer where it is larger and leaves power as it is.");
    import_write_comment(im);
    for (size_t i = 0; i < source->n_lights; i++) write_light(im, &source->lights[i]);
    if (im->dark || im->paper) write_studio(im);
    write_surrounding(im);
}

/* ---- cameras ---- */

/* The farthest that a direction goes to the side of the picture: a tangent. */
typedef struct Frame {
    double x, y;
} Frame;

/* How far from the middle of a box a camera that looks at it sees all of it, with some room around. */
static double distance_to_see(Box3 box, Vec3 back, Vec3 right, Vec3 up, Frame frame)
{
    const double room = 0.85;
    double distance = 0;
    Vec3 middle = box3_centre(box);
    for (int i = 0; i < 8; i++) {
        Vec3 corner = vec3(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
        Vec3 d = vec3_sub(corner, middle);
        double nearer = vec3_dot(d, back);
        distance = double_max(distance, nearer + fabs(vec3_dot(d, right)) / (frame.x * room));
        distance = double_max(distance, nearer + fabs(vec3_dot(d, up)) / (frame.y * room));
    }
    return distance;
}

static void write_own_camera(Importer *im)
{
    double a = azimuth * MEN_DEGREE, e = elevation * MEN_DEGREE, half = tan(lens / 2 * MEN_DEGREE);
    Vec3 back = vec3(cos(e) * sin(a), sin(e), cos(e) * cos(a)), right = vec3(cos(a), 0, -sin(a));
    Vec3 up = vec3_cross(back, right), middle = box3_centre(im->shown);
    double away = distance_to_see(im->shown, back, right, up, (Frame){half, half / film_shape});
    NodeText node = node_begin(im, "camera", NULL);
    import_say(im, "The file has no camera: this one sees all of it from above, to the right.");
    node_point(&node, "from", vec3_add(middle, vec3_scale(back, away)));
    node_point(&node, "to", middle);
    node_number(&node, "fov", lens);
    node_end(&node);
}

static double shape_of(const MeshCamera *camera)
{
    double shape = camera->width > 0 && camera->height > 0 ? camera->width / camera->height : film_shape;
    return double_min(double_max(shape, 0.05), 20);
}

static void write_camera(Importer *im, const MeshCamera *camera)
{
    Vec3 from = to_scene(im, &camera->to_world, vec3(0, 0, 0)), along = direction_of(&camera->to_world, vec3(0, 0, -1));
    Vec3 right = direction_of(&camera->to_world, vec3(1, 0, 0));
    double away = vec3_dot(vec3_sub(box3_centre(im->shown), from), along);
    if (!(away > 0)) away = size_of(im->all);
    char *name = import_name(im, camera->name, "view", "view");
    NodeText node = node_begin(im, "camera", name);
    if (camera->orthographic) node_word(&node, "projection", "orthographic");
    node_point(&node, "from", from);
    node_point(&node, "to", vec3_add(from, vec3_scale(along, away)));
    if (fabs(right.y) > 1e-4 || fabs(along.y) > 0.999)
        node_point(&node, "up",
                   vec3_scale(direction_of(&camera->to_world, vec3(0, 1, 0)), round_down(size_of(im->all))));
    const double widest = 1e14, least_fov = 0.01, most_fov = 179;
    double width = camera->width * im->file_m / im->scene_m,
           fov = 2 * atan(shape_of(camera) * tan(camera->fov_y / 2)) / MEN_DEGREE;
    if (camera->orthographic)
        add_coordinate(im, node_prop(&node, "width"), double_min(double_max(width, im->step), widest));
    else
        node_number(&node, "fov", double_min(double_max(fov, least_fov), most_fov));
    node_end(&node);
    free(name);
    im->out->n_cameras++;
}

/* The pictures that are rendered: called after the scene, but for what would be the number of a frame, and never as a picture that
 * the scene reads. */
static void add_outputs(const Importer *im, Buf *out)
{
    static const char *const endings[] = {".exr", ".png"};
    for (size_t i = 0; i < COUNT_OF(endings); i++) {
        Buf name = {0};
        buf_add(&name, im->options->stem);
        for (char *c = name.text; c && *c; c++)
            if (*c == '#' || *c == '%') *c = '_';
        if (im->stem_is_read) buf_add(&name, "-render");
        buf_add(&name, endings[i]);
        buf_add(out, i ? ", " : "[");
        value_print_text(out, buf_text(&name));
        buf_clear(&name);
    }
    buf_add(out, "]");
}

void import_write_cameras(Importer *im)
{
    const MeshSource *source = im->source;
    import_begin_section(im, "View");
    if (source->n_cameras > 1)
        import_say(im, "The picture is of the first of these cameras; --camera NAME takes another one.");
    import_write_comment(im);
    for (size_t i = 0; i < source->n_cameras; i++) write_camera(im, &source->cameras[i]);
    if (!source->n_cameras) write_own_camera(im);
    const double pixels = 640.0 * 480;
    double shape = source->n_cameras ? shape_of(&source->cameras[0]) : film_shape, width = round(sqrt(pixels * shape));
    NodeText film = node_begin(im, "film", NULL);
    if (im->exposure != 0) {
        import_note(im, "its lights are %s for a picture as they are: exposure makes up for that",
                    im->exposure > 0 ? "too dim" : "too bright");
        node_number(&film, "exposure", im->exposure);
    }
    buf_format(node_prop(&film, "size"), "<%.0f, %.0f>", width, round(width / shape));
    add_outputs(im, node_prop(&film, "output"));
    node_end(&film);
    NodeText render = node_begin(im, "render", NULL);
    node_number(&render, "samples", 256);
    node_end(&render);
}

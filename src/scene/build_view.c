/* build_view.c - cameras, the film, and how to render.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/angle.h"
#include "base/file.h"
#include "scene/build_parts.h"
#include "scene/iris.h"

static void expectation(Builder *b, const EvalNode *node, SceneCamera *camera)
{
    const EvalProp *prop = eval_prop(node, "expect");
    if (!prop) return;
    uint32_t *media = ARENA_ARRAY(b->arena, uint32_t, prop->as.list.n + 1); /* never NULL, even for an empty list */
    for (size_t i = 0; i < prop->as.list.n; i++) media[i] = build_medium(b, prop->as.list.nodes[i]);
    camera->expect = media;
    camera->n_expect = (uint32_t)prop->as.list.n;
    camera->expect_span = prop->span;
}

/* Turns the film upright, and moves it so that what the camera looks at stays in the middle, as large as it was. */
static bool stand_upright(Builder *b, const EvalNode *node, Vec3 along, Vec3 vertical, SceneCamera *camera)
{
    const double steepest = 80;
    double distance = vec3_length(along);
    Vec3 level = vec3_cross(vertical, camera->right);
    double depth = vec3_dot(along, level), angle = acos(double_min(depth / distance, 1)) / MEN_DEGREE;
    if (!(angle <= steepest)) {
        Diagnostic *report = diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "upright"),
                                         "an upright camera that looks %.3g degrees up or down: beyond %g all "
                                         "would be drawn out",
                                         angle, steepest);
        diag_hint(b->diag, report, "bring the heights of 'from' and 'to' nearer, or leave 'upright' out");
        return false;
    }
    camera->up = vertical;
    camera->forward = level;
    camera->shift[1] = vec3_dot(along, vertical) / depth;
    camera->half_width *= distance / depth;
    camera->focus[2] = 1 / depth;
    return true;
}

/* Moves the picture: of parallel lines of sight, where they start. */
static void shift(const EvalNode *node, SceneCamera *camera)
{
    Vec3 parts = eval_vector(node, "shift");
    double right = parts.x * 2 * camera->half_width, up = parts.y * 2 * camera->half_width;
    if (camera->projection == PROJECTION_ORTHOGRAPHIC) {
        camera->from = vec3_along(vec3_along(camera->from, right, camera->right), up, camera->up);
        return;
    }
    camera->shift[0] += right;
    camera->shift[1] += up;
}

/* The three axes. Right is forward x up: space is right-handed, as in mesh files. */
static bool orient(Builder *b, const EvalNode *node, const Affine *to_world, SceneCamera *camera)
{
    Vec3 to = affine_point(to_world, eval_vector(node, "to"));
    Vec3 up = affine_vector(to_world, eval_vector(node, "up"));
    Vec3 along = vec3_sub(to, camera->from);
    double distance = vec3_length(along);
    if (!(distance > 0) || !isfinite(distance)) {
        diag_report(b->diag, D_DEGENERATE_SHAPE, build_span(node, "to"),
                    "'from' and 'to' of this camera are the same point");
        return false;
    }
    camera->forward = vec3_scale(along, 1 / distance);
    camera->focus[2] = 1 / distance;
    Vec3 right = vec3_cross(camera->forward, up);
    const double parallel = 1e-9;
    if (!(vec3_length(right) > parallel * vec3_length(up))) {
        if (eval_prop(node, "up")) {
            diag_report(b->diag, D_DEGENERATE_SHAPE, build_span(node, "up"),
                        "'up' points along the view and does not say how to hold the camera");
            return false;
        }
        /* straight up or down: north is at the top, as on a map with x to the right */
        right = vec3_cross(camera->forward, affine_vector(to_world, vec3(0, 0, -1)));
    }
    camera->right = vec3_normalize(right);
    camera->up = vec3_cross(camera->right, camera->forward);
    return !eval_truth(node, "upright") || stand_upright(b, node, along, vec3_normalize(up), camera);
}

/* The plane through points, which are measured along the camera's axes: of one, facing it; of two, level with the picture; of three. */
static bool focus_on_plane(const Vec3 *points, size_t n, SceneCamera *camera)
{
    Vec3 normal = vec3(0, 0, 1);
    if (n > 1) {
        Vec3 one = vec3_sub(points[1], points[0]), other = n == 3 ? vec3_sub(points[2], points[0]) : vec3(1, 0, 0);
        normal = vec3_cross(one, other);
        if (!(vec3_length(normal) > 1e-9 * vec3_length(one) * vec3_length(other))) return false;
    }
    double offset = vec3_dot(normal, points[0]);
    bool edge_on = fabs(offset) <= 1e-9 * vec3_length(normal) * vec3_length(points[0]);
    bool never_met = camera->projection == PROJECTION_ORTHOGRAPHIC && fabs(normal.z) <= 1e-9 * vec3_length(normal);
    if (edge_on || never_met) return false;
    camera->focus[0] = normal.x / offset;
    camera->focus[1] = normal.y / offset;
    camera->focus[2] = normal.z / offset;
    return true;
}

static bool focus(Builder *b, const EvalNode *node, const Affine *to_world, SceneCamera *camera)
{
    enum { MOST = 3 };
    const EvalProp *prop = eval_prop(node, "focus");
    if (!prop) return true;
    build_needs_other(b, node, "focus", "aperture", "without an aperture");
    size_t n = prop->as.list.n;
    if (n == 0 || n > MOST) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span,
                    "the camera focuses on one point, or on the plane through two or three, not %zu", n);
        return false;
    }
    Vec3 points[MOST];
    for (size_t i = 0; i < n; i++) {
        const double *v = prop->as.list.numbers + 3 * i;
        Vec3 away = vec3_sub(affine_point(to_world, vec3(v[0], v[1], v[2])), camera->from);
        points[i] = vec3(vec3_dot(away, camera->right), vec3_dot(away, camera->up), vec3_dot(away, camera->forward));
        if (points[i].z > 0) continue;
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span, "the camera cannot focus on a point behind it");
        return false;
    }
    if (focus_on_plane(points, n, camera)) return true;
    Diagnostic *report =
        diag_report(b->diag, D_DEGENERATE_SHAPE, prop->span, "no plane that the camera sees goes through these points");
    diag_hint(b->diag, report,
              n == 2 ? "of two, one is behind or above the other, and they are not in one line of sight"
                     : "they are not all in one line, nor in one plane with the camera: focus = [front, back, top]");
    return false;
}

/* Blades that make a whole circle are none. */
static void iris(Builder *b, const EvalNode *node, SceneCamera *camera)
{
    const EvalProp *blades = eval_prop(node, "blades");
    static const char *const needy[] = {"blade_rotation", "blade_roundness"};
    for (size_t i = 0; i < COUNT_OF(needy); i++) build_needs_other(b, node, needy[i], "blades", "without blades");
    camera->lens_reach = camera->lens_radius;
    if (!blades) return;
    build_needs_other(b, node, "blades", "aperture", "without an aperture");
    SceneIris made = {.blades = (uint32_t)blades->as.number,
                      .rotation = eval_number(node, "blade_rotation"),
                      .roundness = eval_number(node, "blade_roundness")};
    if (camera->lens_radius == 0 || made.roundness == 1) return;
    made.corners =
        iris_corners(b->arena, made.blades, fmod(made.rotation, 360) * MEN_DEGREE, made.roundness, &made.n_corners);
    camera->lens_reach = camera->lens_radius * iris_reach(made.corners, made.n_corners);
    camera->iris = made;
}

/* All cameras of a scene share the time for which the shutter is open. */
static void open_shutter(Builder *b, const EvalNode *node)
{
    Scene *scene = b->scene;
    const EvalProp *prop = eval_prop(node, "shutter");
    double shutter = prop ? prop->as.number / 360 : 0;
    build_needs_other(b, node, "shutter_steps", "shutter", "without a shutter");
    if (shutter == 0) return;
    uint32_t n_keys = (uint32_t)eval_number(node, "shutter_steps") + 1;
    if (scene->shutter > 0 && (scene->shutter != shutter || scene->n_keys != n_keys)) {
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, prop->span,
                                         "the cameras of a scene have one shutter, and another camera has another");
        diag_hint(b->diag, report, "give them the same 'shutter' and 'shutter_steps', or set them for one alone");
    }
    scene->shutter = shutter;
    scene->n_keys = n_keys;
}

/* In the order of SceneProjection: its word, what a camera is with it, and its angle of view in degrees. */
static const struct {
    const char *word, *camera;
    double fov;
} projections[PROJECTION_COUNT] = {{"perspective", "a perspective camera", 45},
                                   {"orthographic", "an orthographic camera", 45},
                                   {"panorama", "a panorama", 360},
                                   {"fisheye", "a fisheye", 180}};

static double angle_of_view(const EvalNode *node, SceneProjection projection)
{
    const EvalProp *fov = eval_prop(node, "fov");
    return fov ? fov->as.number : projections[projection].fov;
}

/* On this kind of camera; the report, for a hint, or NULL. */
static Diagnostic *has_no_use(Builder *b, const EvalNode *node, const char *property, const SceneCamera *camera)
{
    char where[40];
    snprintf(where, sizeof where, "on %s", projections[camera->projection].camera);
    return build_needs(b, node, property, where);
}

/* The hint is as wide as what a perspective camera sees where it looks at. */
static bool measure_orthographic(Builder *b, const EvalNode *node, double scale, SceneCamera *camera)
{
    const EvalProp *width = eval_prop(node, "width");
    Diagnostic *report = has_no_use(b, node, "fov", camera);
    if (!report && !width)
        report = diag_report(b->diag, D_MISSING_PROPERTY, node->span, "an orthographic camera needs a 'width'");
    if (report) {
        double distance = vec3_length(vec3_sub(eval_vector(node, "to"), eval_vector(node, "from")));
        double fov = angle_of_view(node, PROJECTION_PERSPECTIVE);
        diag_hint(b->diag, report, "write: width = %.3g, which is seen across the picture%s",
                  2 * distance * (fov < 180 ? tan(fov / 2 * MEN_DEGREE) : 1),
                  eval_prop(node, "fov") ? ", as by this fov where 'to' is" : "");
        return false;
    }
    camera->half_width = width->as.number / 2 * scale;
    if (camera->half_width <= SCENE_REACH) return true;
    diag_report(b->diag, D_VALUE_OUT_OF_RANGE, width->span, "a width of %g is too large", 2 * camera->half_width);
    return false;
}

static bool measure_angle(Builder *b, const EvalNode *node, SceneCamera *camera)
{
    bool perspective = camera->projection == PROJECTION_PERSPECTIVE;
    double fov = angle_of_view(node, camera->projection);
    Diagnostic *report = has_no_use(b, node, "width", camera);
    if (report) {
        diag_hint(
            b->diag, report,
            "how much is seen is the angle fov = %g, or width with projection = orthographic; how many pixels there "
            "are, film { size = <640, 480> }",
            fov);
        return false;
    }
    camera->half_width = perspective ? tan(fov / 2 * MEN_DEGREE) : fov / 2 * MEN_DEGREE;
    if (!perspective && camera->lens_radius > 0) {
        has_no_use(b, node, "aperture", camera);
        return false;
    }
    if (!perspective) has_no_use(b, node, "shift", camera);
    if (!perspective || fov < 180) return true;
    report = diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "fov"),
                         "fov %g is not greater than 0 and less than 180", fov);
    diag_hint(b->diag, report, "up to 360 degrees are seen with projection = fisheye, or panorama");
    return false;
}

/* How much is seen. */
static bool measure_picture(Builder *b, const EvalNode *node, double scale, SceneCamera *camera)
{
    const char *word = eval_word(node, "projection");
    for (uint32_t i = 0; i < PROJECTION_COUNT; i++)
        if (strcmp(word, projections[i].word) == 0) camera->projection = (SceneProjection)i;
    if (camera->projection == PROJECTION_ORTHOGRAPHIC) return measure_orthographic(b, node, scale, camera);
    return measure_angle(b, node, camera);
}

void build_camera(Builder *b, const EvalNode *node, const Affine *to_world)
{
    if (b->only_shapes) return;
    Scene *scene = b->scene;
    const EvalProp *from = eval_prop(node, "from");
    SceneCamera camera = {
        .name = build_name(b, node, node->type->name), .span = build_author_place(b, node), .identity = b->where};
    camera.from = affine_point(to_world, vec3(from->as.vector[0], from->as.vector[1], from->as.vector[2]));
    /* the lens is round and pixels are square whatever the transforms: they grow with the mean scale */
    double scale = cbrt(fabs(affine_determinant(to_world)));
    camera.lens_radius = eval_number(node, "aperture") / 2 * scale;
    if (!measure_picture(b, node, scale, &camera)) return;
    if (!build_check_reach(b, from->span, "the camera", box3_add_point(box3_empty(), camera.from))) return;
    if (camera.projection != PROJECTION_PERSPECTIVE && eval_truth(node, "upright"))
        has_no_use(b, node, "upright", &camera);
    if (!orient(b, node, to_world, &camera)) return;
    shift(node, &camera);
    if (!focus(b, node, to_world, &camera)) return;
    iris(b, node, &camera);
    if (!(camera.lens_reach <= SCENE_REACH)) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "aperture"), "an aperture of %g is too large",
                    2 * camera.lens_radius);
        return;
    }
    expectation(b, node, &camera);
    open_shutter(b, node);
    scene->cameras = room_for_one(b->arena, scene->cameras, scene->n_cameras, &b->cameras_capacity, sizeof camera);
    scene->cameras[scene->n_cameras++] = camera;
}

/* The names are those of the table: see nodes.def. */
static void build_aovs(Builder *b, const EvalProp *aovs)
{
    for (size_t i = 0; aovs && i < aovs->as.list.n; i++) {
        const char *name = aovs->as.list.texts[i];
        b->scene->film.aovs |= (AovSet)1 << aov_named(name, strlen(name));
    }
}

static void check_output(Builder *b, Span span, const char *name)
{
    const char *extension = file_extension(name);
    if (!*name) {
        diag_report(b->diag, D_BAD_OUTPUT, span, "an output has no name");
    } else if (strcasecmp(extension, "exr") != 0 && strcasecmp(extension, "png") != 0) {
        Diagnostic *report =
            diag_report(b->diag, D_BAD_OUTPUT, span, "'%s' is no kind of file that can be written", name);
        diag_hint(b->diag, report, "end it in .exr for what comes after, or in .png to look at");
    }
    size_t length;
    const char *mark = file_number_mark(name, &length);
    if (!mark) return;
    Diagnostic *report =
        diag_report(b->diag, D_BAD_OUTPUT, span, "'%.*s' is no place for the number of a frame", (int)length, mark);
    diag_hint(b->diag, report, "write: \"%.*s####%s\"", (int)(mark - name), name, mark + length);
}

void build_film(Builder *b, const EvalNode *node)
{
    SceneFilm *film = &b->scene->film;
    Vec3 size = eval_vector(node, "size");
    if (size.x != floor(size.x) || size.y != floor(size.y))
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "size"),
                    "a film of %g x %g pixels: pixels are whole", size.x, size.y);
    film->width = (uint32_t)size.x;
    film->height = (uint32_t)size.y;
    film->box = strcmp(eval_word(node, "filter"), "box") == 0;
    film->exposure.stops = eval_number(node, "exposure");
    film->exposure.automatic = eval_truth(node, "auto_exposure");
    film->white_balance = eval_prop(node, "white_balance") ? eval_number(node, "white_balance") : 0;
    film->alpha = eval_truth(node, "alpha");
    build_aovs(b, eval_prop(node, "aovs"));
    const EvalProp *output = eval_prop(node, "output");
    if (!output) return;
    const char **outputs = ARENA_ARRAY(b->arena, const char *, output->as.list.n + 1);
    for (size_t i = 0; i < output->as.list.n; i++) {
        outputs[i] = arena_copy_text(b->arena, output->as.list.texts[i], strlen(output->as.list.texts[i]));
        check_output(b, output->span, outputs[i]);
    }
    film->outputs = outputs;
    film->n_outputs = (uint32_t)output->as.list.n;
}

static void leave_dispersion_out(Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_media; i++) {
        SceneMedium *medium = &scene->media[i];
        if (!medium->disperses) continue;
        medium->ior = spectrum_constant(spectrum_at_one(&medium->ior, SCENE_INDEX_NM));
        medium->extraordinary = spectrum_constant(spectrum_at_one(&medium->extraordinary, SCENE_INDEX_NM));
        medium->disperses = false;
    }
}

void build_render(Builder *b, const EvalNode *node)
{
    SceneRender *render = &b->scene->render;
    if (!eval_truth(node, "dispersion")) leave_dispersion_out(b->scene);
    render->samples = (uint32_t)eval_number(node, "samples");
    render->samples_given = eval_prop(node, "samples") != NULL;
    render->adaptive = eval_truth(node, "adaptive");
    render->noise = eval_number(node, "noise");
    render->bounces = eval_prop(node, "bounces") ? (uint32_t)eval_number(node, "bounces") : SCENE_BOUNCES_BY_CHANCE;
    render->seed = (uint32_t)eval_number(node, "seed");
    render->denoises = eval_truth(node, "denoise");
    render->spreads = strcmp(eval_word(node, "fireflies"), "spread") == 0;
    if (!scene_caustics_from_text(eval_word(node, "caustics"), &render->caustics))
        render->caustics = CAUSTICS_AUTOMATIC;
    if (!nest_policy_from_text(eval_word(node, "nesting"), &render->nesting)) render->nesting = NEST_AUTOMATIC;
}

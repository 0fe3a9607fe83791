/* viewpoint.c - see viewpoint.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "check/sight_line.h"
#include "cli/viewpoint.h"
#include "trace/path.h"

enum { LARGEST_SIDE = 65536, LOOKS_ALONG_A_SIDE = 24 };
_Static_assert(LOOKS_ALONG_A_SIDE *LOOKS_ALONG_A_SIDE == VIEWPOINT_PLACES, "a square of places");

Status viewpoint_size(const SceneInput *input, uint32_t *width, uint32_t *height, Error *error)
{
    const Options *options = input->options;
    const SceneFilm *film = &input->scene->film;
    const uint32_t *given = options->values[OPTION_SIZE].whole;
    bool sized = option_given(options, OPTION_SIZE);
    uint32_t *sides[2] = {width, height};
    uint32_t wanted[2] = {sized ? given[0] : film->width, sized ? given[1] : film->height};
    double scale = option_given(options, OPTION_SCALE) ? options->values[OPTION_SCALE].number : 1;
    for (int i = 0; i < 2; i++) {
        double side = fmax(1, floor(wanted[i] * scale + 0.5));
        if (side > LARGEST_SIDE)
            return fail(error, STATUS_USAGE, "option '--scale': a %s of %.0f pixels is beyond %d",
                        i ? "height" : "width", side, LARGEST_SIDE);
        *sides[i] = (uint32_t)side;
    }
    return STATUS_OK;
}

Status viewpoint_ray(const CompiledScene *compiled, uint32_t camera, const uint32_t pixel[2], uint32_t width,
                     uint32_t height, const char *option, Ray *ray, Error *error)
{
    if (pixel[0] >= width || pixel[1] >= height)
        return fail(error, STATUS_USAGE, "option '%s': %u,%u is no pixel of the picture, 0,0 to %u,%u", option,
                    pixel[0], pixel[1], width - 1, height - 1);
    FilmPoint point = {pixel[0] + 0.5, pixel[1] + 0.5, width, height};
    const float middle[2] = {0.5f, 0.5f};
    SceneCamera from = compiled->scene->cameras[camera];
    NestList list;
    nest_list_init(&list);
    Status status = compiled_stand(compiled, &from, &list, NULL, error);
    nest_list_clear(&list);
    TRY(status);
    Footprint footprint;
    if (camera_ray(&from, point, middle, ray, &footprint)) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '%s': %s sees nothing at %u,%u", option, from.name, pixel[0], pixel[1]);
}

typedef struct CameraReport {
    SceneInput *input;
    const char *wanted;
} CameraReport;

static void report_camera(void *context)
{
    CameraReport *report = context;
    Diag *diag = &report->input->diag;
    const Scene *scene = report->input->scene;
    const char **names = ARENA_ARRAY(diag->arena, const char *, scene->n_cameras + 1);
    size_t n = 0;
    for (uint32_t i = 0; i < scene->n_cameras; i++)
        if (scene->cameras[i].name) names[n++] = scene->cameras[i].name;
    Diagnostic *diagnostic =
        diag_report_nowhere(diag, D_UNKNOWN_CAMERA, "--camera: the scene has no camera '%s'", report->wanted);
    diag_suggest_or_list(diag, diagnostic, report->wanted, names, n, "cameras");
}

Status viewpoint_camera(SceneInput *input, uint32_t *camera, Error *error)
{
    const Scene *scene = input->scene;
    const char *wanted = option_text(input->options, OPTION_CAMERA, NULL);
    *camera = 0;
    if (!wanted) return STATUS_OK;
    for (uint32_t i = 0; i < scene->n_cameras; i++)
        if (scene->cameras[i].name && strcmp(scene->cameras[i].name, wanted) == 0) {
            *camera = i;
            return STATUS_OK;
        }
    CameraReport report = {input, wanted};
    TRY(scene_input_guard(input, report_camera, &report, error));
    error->text[0] = 0;
    return STATUS_SCENE;
}

static bool has_points(const Scene *scene)
{
    uint32_t i = 0;
    while (i < scene->n_lights && scene->lights[i].kind != LIGHT_POINT) i++;
    return i < scene->n_lights;
}

/* Something opaque that is seen straight on through a point of the film is one more place. false when memory ends. */
static bool look_through(const CompiledScene *compiled, const SceneCamera *camera, FilmPoint point, ReportView *view)
{
    const float middle[2] = {0.5f, 0.5f};
    Ray ray;
    Footprint footprint;
    SightLine line;
    view->n_lines++;
    if (!camera_ray(camera, point, middle, &ray, &footprint)) return true;
    bool found = sight_line_find(compiled, &ray, &line, NULL) == STATUS_OK;
    const SightStep *end = found ? sight_line_end(&line) : NULL;
    if (end) view->places[view->n++] = vec3_along(ray.origin, end->distance, vec3_from_f(ray.direction));
    sight_line_clear(&line);
    return found;
}

ReportView viewpoint_look(const SceneInput *input, uint32_t camera, uint32_t width, uint32_t height,
                          Vec3 places[VIEWPOINT_PLACES])
{
    const CompiledScene *compiled = input->compiled;
    ReportView view = {.places = places};
    NestList list;
    if (!has_points(input->scene) || !input->scene->n_cameras) return view;
    SceneCamera from = input->scene->cameras[camera];
    nest_list_init(&list);
    bool found = compiled_stand(compiled, &from, &list, NULL, NULL) == STATUS_OK;
    nest_list_clear(&list);
    while (found && view.n_lines < VIEWPOINT_PLACES) {
        double across = view.n_lines % LOOKS_ALONG_A_SIDE + 0.5, down = view.n_lines / LOOKS_ALONG_A_SIDE + 0.5;
        FilmPoint point = {across * width / LOOKS_ALONG_A_SIDE, down * height / LOOKS_ALONG_A_SIDE, width, height};
        found = look_through(compiled, &from, point, &view);
    }
    if (!found) view.n = 0;
    return view;
}

void viewpoint_add_options(const SceneInput *input, uint32_t width, uint32_t height, Buf *out)
{
    const char *camera = option_text(input->options, OPTION_CAMERA, NULL);
    if (camera) buf_format(out, " --camera %s", camera);
    if (option_given(input->options, OPTION_SIZE) || option_given(input->options, OPTION_SCALE))
        buf_format(out, " --size %ux%u", (unsigned)width, (unsigned)height);
}

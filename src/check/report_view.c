/* report_view.c - cameras that have nothing before them.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"

/* Whether a box is wholly beyond one of the planes around what a camera shows: before the camera, and between the sides of its film,
 * or a little outside of these. *behind: whether it is the first of these. */
static bool is_out_of_view(const SceneCamera *camera, const SceneFilm *film, Box3 box, bool *behind)
{
    const double slack = 1.1,
                 sides[2] = {slack * camera->half_width, slack * camera->half_width * film->height / film->width};
    bool flat = camera->projection == PROJECTION_ORTHOGRAPHIC;
    int n_beyond[5] = {0};
    for (int corner = 0; corner < 8; corner++) {
        Vec3 way = vec3_sub(box3_corner(box, corner), camera->from);
        double depth = vec3_dot(way, camera->forward), reach = flat ? 1 : depth;
        double across = vec3_dot(way, camera->right) - camera->shift[0] * depth,
               up = vec3_dot(way, camera->up) - camera->shift[1] * depth;
        n_beyond[0] += depth <= 0;
        n_beyond[1] += across > sides[0] * reach;
        n_beyond[2] += -across > sides[0] * reach;
        n_beyond[3] += up > sides[1] * reach;
        n_beyond[4] += -up > sides[1] * reach;
    }
    *behind = n_beyond[0] == 8;
    for (int i = 0; i < 5; i++)
        if (n_beyond[i] == 8) return true;
    return false;
}

/* A floor that is looked straight at is meant to be seen, as that which light falls on. */
static bool faces_plane(const Scene *scene, const SceneCamera *camera, uint32_t object)
{
    Vec3 normal = affine_vector(&scene->objects[object].to_world, vec3(0, 1, 0));
    return scene_is_plane(scene, object) && fabs(vec3_dot(normal, camera->forward)) > 0.7 * vec3_length(normal);
}

void report_empty_view(const CompiledScene *compiled, uint32_t number, Diag *diag)
{
    const Scene *scene = compiled->scene;
    const SceneCamera *camera = &scene->cameras[number];
    const SceneObject *nearest = NULL;
    double distance = HUGE_VAL;
    Vec3 place = camera->from;
    bool all_behind = true, endless = false;
    if (camera->keys || (camera->projection != PROJECTION_PERSPECTIVE && camera->projection != PROJECTION_ORTHOGRAPHIC))
        return;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        if (object->part_of != SCENE_NONE) continue;
        Box3 box = scene_object_bounds(scene, object, NULL);
        if (box3_is_empty(box)) continue;
        if (box3_is_unbounded(box)) {
            if (faces_plane(scene, camera, i)) return;
            endless = true;
            continue;
        }
        bool behind;
        if (!is_out_of_view(camera, &scene->film, box, &behind)) return;
        all_behind = all_behind && behind;
        double away = vec3_length(vec3_sub(box3_centre(box), camera->from));
        if (away >= distance) continue;
        distance = away;
        nearest = object;
        place = box3_centre(box);
    }
    if (!nearest || (endless && !all_behind)) return; /* a floor may be all that is meant to be seen */
    Vec3 f = camera->forward;
    Diagnostic *report = diag_report(diag, D_EMPTY_VIEW, camera->span, "no object is in view of %s%s", camera->name,
                                     all_behind ? ": all are behind it" : "");
    diag_note(diag, report, nearest->span, "the nearest, %s, is here", nearest->name);
    diag_hint(
        diag, report,
        "it looks along <%.3g, %.3g, %.3g>, and x goes to the right, y up and z towards the viewer; to look at %s: "
        "to = <%.4g, %.4g, %.4g>",
        f.x, f.y, f.z, nearest->name, place.x, place.y, place.z);
}

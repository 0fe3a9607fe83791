/* report_volumes.c - volumes that cover next to nothing of an object whose medium varies by them: the rest of it is empty, and
 * no other message says why the smoke cannot be seen.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"

/* Of the box around an object. What a box covers that is written in the scene is more likely meant. */
static const double little = 0.02, little_of_written = 0.001;

/* An object and the box of its medium's volume at one moment, in the volume's own frame, in which the box is given. */
typedef struct Cover {
    Box3 object, volume;
    double part; /* of the object's box that the volume's covers */
} Cover;

static double content_of(Box3 box)
{
    Vec3 size = vec3_sub(box.max, box.min);
    return box3_is_empty(box) ? 0 : size.x * size.y * size.z;
}

/* Around the grid, in its own frame. */
static Box3 box_of(const Volume *volume, const SceneVolumePlace *place)
{
    Affine to_lattice = affine_compose(&volume->to_lattice, &place->to_frame), from_lattice;
    Box3 lattice = {vec3(0, 0, 0), vec3(volume->n_points[0] - 1, volume->n_points[1] - 1, volume->n_points[2] - 1)};
    return affine_invert(&to_lattice, &from_lattice) ? affine_box(&from_lattice, lattice) : box3_empty();
}

/* At one of the times of the shutter. false: it cannot be told. */
static bool find_cover(const Scene *scene, const SceneFrame *frame, uint32_t volume, uint32_t key, SceneShapeBox *known,
                       Cover *cover)
{
    const SceneVolumePlace *place = &scene->volume_places[volume];
    const Affine *frames = scene_motion(scene, frame->motion), *places = scene_motion(scene, place->motion);
    Affine from_own =
        affine_compose(frames ? &frames[key] : &frame->to_world, places ? &places[key] : &place->to_frame);
    Affine to_own;
    if (!affine_invert(&from_own, &to_own)) return false;
    SceneObject object = scene->objects[frame->object];
    if (object.tree == SCENE_NONE) {
        const Affine *keys = scene_keys(scene, &object);
        object.to_world = affine_compose(&to_own, keys ? &keys[key] : &object.to_world);
        object.motion = SCENE_NONE;
        cover->object = scene_next_bounds(scene, &object, known);
    } else {
        cover->object = scene_object_bounds(scene, &object, &to_own);
    }
    cover->volume = box_of(scene->volumes[volume], place);
    double all = content_of(cover->object);
    cover->part = content_of(box3_intersection(cover->object, cover->volume)) / all;
    return !box3_is_unbounded(cover->object) && all > 0 && isfinite(all);
}

/* The boxes around a combination's operands are those of all times together. */
static bool is_moving_combination(const Scene *scene, const SceneFrame *frame)
{
    bool moves = frame->motion != SCENE_NONE;
    for (uint32_t i = frame->object + 1; i < scene->n_objects && scene->objects[i].part_of == frame->object; i++)
        moves |= scene->objects[i].motion != SCENE_NONE;
    return moves && scene->objects[frame->object].tree != SCENE_NONE;
}

/* Whether the volume covers little of the object at all times; cover: when the shutter opens. */
static bool covers_little(const Scene *scene, const SceneFrame *frame, uint32_t volume, SceneShapeBox *known,
                          Cover *cover)
{
    const SceneVolumePlace *place = &scene->volume_places[volume];
    const bool moves = frame->motion != SCENE_NONE || place->motion != SCENE_NONE ||
                       scene->objects[frame->object].motion != SCENE_NONE;
    if (is_moving_combination(scene, frame)) return false;
    for (uint32_t key = 0; key < (moves ? scene->n_keys : 1); key++) {
        Cover now;
        if (!find_cover(scene, frame, volume, key, known, &now)) return false;
        if (now.part > (place->has_box ? little_of_written : little)) return false;
        if (key == 0) *cover = now;
    }
    return true;
}

/* ---- the message ---- */

/* "2.00 mm x 2.00 mm x 2.00 mm": what a box in a frame measures in the world, along the frame's axes. */
static void add_size(Buf *out, const Scene *scene, const Affine *to_world, Box3 box)
{
    Vec3 size = vec3_sub(box.max, box.min);
    const double lengths[3] = {size.x, size.y, size.z};
    for (int axis = 0; axis < 3; axis++) {
        Vec3 edge = vec3(to_world->m[0][axis], to_world->m[1][axis], to_world->m[2][axis]);
        if (axis) buf_add(out, " x ");
        report_add_length(out, scene, lengths[axis] * vec3_length(edge));
    }
}

/* As it would be written; what is left of a 0 by rounding is a 0. */
static void add_corner(Buf *out, Vec3 corner, double size)
{
    double at[3] = {corner.x, corner.y, corner.z};
    for (int axis = 0; axis < 3; axis++)
        if (fabs(at[axis]) < 1e-9 * size) at[axis] = 0;
    buf_format(out, "<%.6g, %.6g, %.6g>", at[0], at[1], at[2]);
}

static void add_corners(Buf *out, const char *first, Box3 box, const char *second)
{
    double size = vec3_max_abs(vec3_sub(box.max, box.min));
    buf_add(out, first);
    add_corner(out, box.min, size);
    buf_add(out, second);
    add_corner(out, box.max, size);
}

static void add_hint(Buf *out, const SceneVolumePlace *place, const char *object, const Cover *cover)
{
    if (place->from_file) {
        add_corners(out, "the grid reaches from ", cover->volume, " to ");
        buf_format(out, ", and %s", object);
        add_corners(out, " from ", cover->object, " to ");
        buf_add(out, ": scale() and translate() in the volume bring them together");
        return;
    }
    add_corners(out, "write: from = ", cover->object, "  to = ");
    buf_format(out, ", the corners of %s in its own frame", object);
    if (!place->has_box) buf_add(out, "; unset, they are <-1, -1, -1> and <1, 1, 1>");
}

static void report_small(const Scene *scene, const SceneFrame *frame, uint32_t volume, const Cover *cover, Diag *diag)
{
    const SceneObject *object = &scene->objects[frame->object];
    const SceneVolumePlace *place = &scene->volume_places[volume];
    const Affine to_world = affine_compose(&frame->to_world, &place->to_frame);
    const bool is_density = scene->media[object->medium].density == scene->volumes[volume];
    Buf small = {0}, large = {0}, hint = {0};
    add_size(&small, scene, &to_world, cover->volume);
    add_size(&large, scene, &to_world, cover->object);
    add_hint(&hint, place, object->name, cover);
    Diagnostic *report =
        diag_report(diag, D_SMALL_VOLUME, place->span, "this %s is in a box of %s%s %s%s measures %s%s",
                    is_density ? "density" : "temperature", buf_text(&small),
                    cover->part > 0 ? ", and" : " that is nowhere in", object->name, cover->part > 0 ? "" : ", which",
                    buf_text(&large), cover->part > 0 ? ": the rest of it is empty" : "");
    diag_note(diag, report, object->span, "%s is here", object->name);
    diag_hint(diag, report, "%s", buf_text(&hint));
    buf_clear(&small);
    buf_clear(&large);
    buf_clear(&hint);
}

/* What a loop makes is at one place, and of that the first is told of. */
static bool is_told(const Span *told, uint32_t n, Span span)
{
    bool found = false;
    for (uint32_t i = 0; i < n; i++) found |= span_equal(told[i], span);
    return found;
}

void report_small_volumes(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    SceneShapeBox known = {0};
    Span told[REPORT_MOST];
    uint32_t n = 0;
    for (uint32_t i = 0; n <= REPORT_MOST && i < scene->n_frames; i++) {
        const SceneFrame *frame = &scene->frames[i];
        const SceneMedium *medium = &scene->media[scene->objects[frame->object].medium];
        const Volume *const volumes[2] = {medium->density, medium->temperature};
        for (int k = 0; k < 2 && n <= REPORT_MOST; k++) {
            uint32_t row = scene_volume_row(scene, volumes[k]);
            Cover cover = {0};
            if (row == SCENE_NONE || volumes[k]->outside > 0 || !(volumes[k]->largest > 0) ||
                is_told(told, n, scene->volume_places[row].span) || !covers_little(scene, frame, row, &known, &cover) ||
                ++n > REPORT_MOST)
                continue;
            told[n - 1] = scene->volume_places[row].span;
            report_small(scene, frame, row, &cover, diag);
        }
    }
    if (n > REPORT_MOST)
        diag_report_nowhere(diag, D_SMALL_VOLUME, "and more volumes cover next to nothing of what their media fill");
}

/* report_cover.c - what a place is inside of, of things that are opaque or need not be closed.
 * SPDX-License-Identifier: Apache-2.0 */
#include "check/report_parts.h"

bool report_is_plane(const Scene *scene, uint32_t object)
{
    return scene->objects[object].part_of == SCENE_NONE && scene_is_plane(scene, object);
}

static bool is_below(const SceneObject *plane, Vec3 place)
{
    Affine to_plane;
    return affine_invert(&plane->to_world, &to_plane) && affine_point(&to_plane, place).y < 0;
}

/* Whether a place is within an object that is no combination, by what a line from there meets. */
static bool leads_out(uint32_t object, const HitList *hits)
{
    int leaving = 0;
    for (size_t i = 0; i < hits->n; i++)
        if (hits->items[i].object == object && !hit_repeats(hits, i)) leaving += hits->items[i].entering ? -1 : 1;
    return leaving == 1;
}

static bool is_within_combination(const CompiledScene *compiled, Vec3 place, uint32_t tree, HitList *hits)
{
    NestList list;
    nest_list_init(&list);
    Status status = compiled_interior(compiled, vec3f_from(place), 0, hits, &list, NULL);
    bool within = status == STATUS_OK && nest_csg_holds(&compiled->csg, tree, &list);
    nest_list_clear(&list);
    return within;
}

/* As lines in three directions have it. */
bool report_is_within(const CompiledScene *compiled, Vec3 place, uint32_t object, HitList *hits)
{
    const Scene *scene = compiled->scene;
    uint32_t tree = scene->objects[object].tree;
    if (report_is_plane(scene, object)) return is_below(&scene->objects[object], place);
    if (tree != SCENE_NONE) return is_within_combination(compiled, place, tree, hits);
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        Ray ray = ray_make(place, vec3f_from(line_direction(direction)));
        rtc_all(compiled->rtc, &ray, false, hits);
        if (!leads_out(object, hits)) return false;
    }
    return true;
}

bool report_is_opaque(const CompiledScene *compiled, uint32_t object)
{
    const Scene *scene = compiled->scene;
    return compiled->hull_of_object[object] == SCENE_NONE && !scene_is_thin(scene, object) &&
           scene->objects[object].part_of == SCENE_NONE && scene->objects[object].light == SCENE_NONE;
}

/* Looked at are those that a line from there leaves. */
uint32_t report_body_around(const CompiledScene *compiled, Vec3 place, HitList *scratch)
{
    const Scene *scene = compiled->scene;
    HitList hits = {0};
    Ray ray = ray_make(place, vec3f_from(line_direction(0)));
    uint32_t cover = SCENE_NONE, last = SCENE_NONE;
    rtc_all(compiled->rtc, &ray, false, &hits);
    for (size_t i = 0; i < hits.n && cover == SCENE_NONE; i++) {
        uint32_t met = hits.items[i].object, object = scene_whole(scene, met);
        if (hits.items[i].entering || object == last || !report_is_opaque(compiled, object)) continue;
        last = object;
        if ((object != met || leads_out(object, &hits)) && report_is_within(compiled, place, object, scratch))
            cover = object;
    }
    hit_list_clear(&hits);
    return cover;
}

uint32_t report_cover(const CompiledScene *compiled, Vec3 place, HitList *hits)
{
    uint32_t cover = report_body_around(compiled, place, hits);
    for (uint32_t i = 0; i < compiled->scene->n_objects && cover == SCENE_NONE; i++)
        if (report_is_plane(compiled->scene, i) && report_is_opaque(compiled, i) &&
            report_is_within(compiled, place, i, hits))
            cover = i;
    return cover;
}

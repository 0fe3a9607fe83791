/* lens.c - the cells of a lens.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/lens.h"

#include <stdlib.h>

/* Cells each way, over the square around the lens, or the picture; and how many stretches of them there may be that hang together. */
enum { CELLS = 24, MOST_LISTS = 16, UNKNOWN = 0 };

struct Lens {
    const SceneCamera *camera;
    double half[2];                /* of all cells together, to the right and up */
    uint8_t list_of[CELLS][CELLS]; /* its number + 1 */
    uint32_t n_lists;
    NestList lists[MOST_LISTS];
};

static Vec3 middle_of(const Lens *lens, int x, int y)
{
    const SceneCamera *camera = lens->camera;
    double u = (2 * x + 1.0) / CELLS - 1, v = (2 * y + 1.0) / CELLS - 1;
    return vec3_along(vec3_along(camera->from, u * lens->half[0], camera->right), v * lens->half[1], camera->up);
}

/* The ball around a cell, and around what rounding makes of its middle. Balls of neighbours reach into each other, so that there
 * is no surface between these where neither has one. */
static bool is_free(const CompiledScene *compiled, const Lens *lens, int x, int y)
{
    Vec3 middle = middle_of(lens, x, y);
    double half = 1.01 * hypot(lens->half[0], lens->half[1]) / CELLS;
    return rtc_is_away(compiled->rtc, middle, half + 1e-6 * vec3_max_abs(middle));
}

static Status look_at_cell(const CompiledScene *compiled, Lens *lens, HitList *hits, int x, int y)
{
    if (!is_free(compiled, lens, x, y)) return STATUS_OK;
    uint8_t known = x > 0 ? lens->list_of[y][x - 1] : UNKNOWN;
    if (known == UNKNOWN && y > 0) known = lens->list_of[y - 1][x];
    if (known == UNKNOWN && lens->n_lists < MOST_LISTS) {
        NestList *list = &lens->lists[lens->n_lists];
        nest_list_init(list);
        known = (uint8_t)++lens->n_lists;
        TRY(compiled_interior(compiled, vec3f_from(middle_of(lens, x, y)), 0, hits, list, NULL));
    }
    lens->list_of[y][x] = known;
    return STATUS_OK;
}

/* The film is the scene's: where a picture is higher, its ends lie outside of all cells. Its filter reaches half a pixel beyond. */
static void measure(Lens *lens, const SceneFilm *film)
{
    const SceneCamera *camera = lens->camera;
    lens->half[0] = lens->half[1] = camera->lens_reach;
    if (camera->projection != PROJECTION_ORTHOGRAPHIC) return;
    double pixel = 2 * camera->half_width / film->width;
    lens->half[0] += 0.5 * pixel * (film->width + 1.0);
    lens->half[1] += 0.5 * pixel * (film->height + 1.0);
}

Status lens_new(const CompiledScene *compiled, const SceneCamera *camera, Lens **lens, Error *error)
{
    Lens *made = *lens = calloc(1, sizeof *made);
    Status status = made ? STATUS_OK : STATUS_NOMEM;
    HitList hits = {0};
    if (made) {
        made->camera = camera;
        measure(made, &compiled->scene->film);
    }
    for (int i = 0; status == STATUS_OK && i < CELLS * CELLS; i++)
        status = look_at_cell(compiled, made, &hits, i % CELLS, i / CELLS);
    hit_list_clear(&hits);
    if (status == STATUS_OK) return STATUS_OK;
    lens_free(made);
    *lens = NULL;
    return fail_memory(error, sizeof *made, "what the rays of the camera start in");
}

void lens_free(Lens *lens)
{
    for (uint32_t i = 0; lens && i < lens->n_lists; i++) nest_list_clear(&lens->lists[i]);
    free(lens);
}

const NestList *lens_list_at(const Lens *lens, Vec3 origin)
{
    if (!lens) return NULL;
    const SceneCamera *camera = lens->camera;
    Vec3 offset = vec3_sub(origin, camera->from);
    double x = 0.5 * CELLS * (1 + vec3_dot(offset, camera->right) / lens->half[0]),
           y = 0.5 * CELLS * (1 + vec3_dot(offset, camera->up) / lens->half[1]);
    if (!(x >= 0 && x < CELLS && y >= 0 && y < CELLS)) return NULL;
    uint8_t number = lens->list_of[(int)y][(int)x];
    return number == UNKNOWN ? NULL : &lens->lists[number - 1];
}

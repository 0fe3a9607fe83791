/* rtc_boxes.c - boxes around the triangles of a mesh, for questions about a whole line.
 *
 * Embree is asked by a float ray, and by balls about places. Where a ray creeps along faces the float ray may be on the wrong side
 * of them for any way, and all triangles have to be found that the line comes to, in double. So the quads are taken as they come,
 * sixteen at once, for neighbours in a mesh are mostly neighbours in its list; with a box around them, and boxes around eight boxes
 * each. That is less than a byte for a triangle, made in the time of looking at each once, and nothing is lost where a list is in no
 * order but time.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_boxes.h"

#include <float.h>
#include <stdlib.h>

#include "geom/rtc_query.h"

/* Quads in a box, boxes in the next larger one, and how often one can be within another: all that an uint32_t counts. */
enum { QUADS = 16, BOXES = 8, MOST_LEVELS = 11 };
/* What double may round on the way into a mesh's frame, and in it, of the coordinates; more than that. */
#define BOX_NOISE 0x1p-40

typedef struct FloatBox {
    float lower[3], upper[3];
} FloatBox;

struct RtcBoxes {
    FloatBox *level[MOST_LEVELS]; /* of quads at first, and one around all in the end */
    uint32_t n[MOST_LEVELS], n_levels, n_quads;
    double largest; /* coordinate */
    FloatBox boxes[];
};

static void begin_box(FloatBox *box)
{
    for (int axis = 0; axis < 3; axis++) {
        box->lower[axis] = FLT_MAX;
        box->upper[axis] = -FLT_MAX;
    }
}

static void add_to_box(FloatBox *box, const float lower[3], const float upper[3])
{
    for (int axis = 0; axis < 3; axis++) {
        box->lower[axis] = float_min(box->lower[axis], lower[axis]);
        box->upper[axis] = float_max(box->upper[axis], upper[axis]);
    }
}

/* A mesh that deforms has all places of a vertex between the first and the last one. */
static void add_quad(FloatBox *box, const RtcMesh *mesh, const RtcQuad *quad)
{
    for (int k = 0; k < 4; k++) {
        const Vec3f *p = &quad->corner[k];
        add_to_box(box, (const float[]){p->x, p->y, p->z}, (const float[]){p->x, p->y, p->z});
        if (!mesh->end) continue;
        p = &mesh->end->positions[quad->vertex[k]];
        add_to_box(box, (const float[]){p->x, p->y, p->z}, (const float[]){p->x, p->y, p->z});
    }
}

static void fill_boxes(RtcBoxes *boxes, const RtcMesh *mesh)
{
    for (uint32_t i = 0; i < boxes->n[0]; i++) begin_box(&boxes->level[0][i]);
    for (uint32_t i = 0; i < mesh->n_quads; i++) add_quad(&boxes->level[0][i / QUADS], mesh, &mesh->quads[i]);
    for (uint32_t level = 1; level < boxes->n_levels; level++) {
        const FloatBox *within = boxes->level[level - 1];
        for (uint32_t i = 0; i < boxes->n[level]; i++) begin_box(&boxes->level[level][i]);
        for (uint32_t i = 0; i < boxes->n[level - 1]; i++)
            add_to_box(&boxes->level[level][i / BOXES], within[i].lower, within[i].upper);
    }
    const FloatBox *all = &boxes->level[boxes->n_levels - 1][0];
    for (int axis = 0; axis < 3; axis++)
        boxes->largest =
            double_max(boxes->largest, double_max(fabs((double)all->lower[axis]), fabs((double)all->upper[axis])));
}

/* NULL where memory ends. */
static RtcBoxes *make_boxes(const RtcMesh *mesh)
{
    uint32_t n[MOST_LEVELS], n_levels = 1;
    size_t n_all = n[0] = (mesh->n_quads + QUADS - 1) / QUADS;
    for (; n[n_levels - 1] > 1; n_levels++) n_all += n[n_levels] = (n[n_levels - 1] + BOXES - 1) / BOXES;
    RtcBoxes *boxes = calloc(1, sizeof *boxes + n_all * sizeof *boxes->boxes);
    if (!boxes) return NULL;
    boxes->n_levels = n_levels;
    boxes->n_quads = mesh->n_quads;
    FloatBox *next = boxes->boxes;
    for (uint32_t level = 0; level < n_levels; next += n[level++]) {
        boxes->level[level] = next;
        boxes->n[level] = n[level];
    }
    fill_boxes(boxes, mesh);
    return boxes;
}

void rtc_boxes_free(RtcBoxes *boxes)
{
    free(boxes);
}

typedef struct Along {
    const RtcBoxes *boxes;
    Vec3 origin, direction;
    Vec3 steepness; /* |direction| by axis */
    double margin;
    RtcTake *take;
    void *context;
} Along;

/* Whether the line comes into a box, or as near to it as the margin: there is no axis across the line, of those that are across an
 * edge of the box, along which the two are apart. */
static bool meets_box(const Along *along, const FloatBox *box)
{
    Vec3 lower = vec3((double)box->lower[0], (double)box->lower[1], (double)box->lower[2]),
         upper = vec3((double)box->upper[0], (double)box->upper[1], (double)box->upper[2]),
         half = vec3_scale(vec3_sub(upper, lower), 0.5), d = along->steepness,
         apart = vec3_cross(along->direction, vec3_sub(vec3_scale(vec3_add(lower, upper), 0.5), along->origin));
    double x = half.x + along->margin, y = half.y + along->margin, z = half.z + along->margin;
    return fabs(apart.x) <= d.y * z + d.z * y && fabs(apart.y) <= d.z * x + d.x * z &&
           fabs(apart.z) <= d.x * y + d.y * x;
}

static void visit(const Along *along, uint32_t level, uint32_t i)
{
    const RtcBoxes *boxes = along->boxes;
    if (!meets_box(along, &boxes->level[level][i])) return;
    if (level > 0) {
        uint32_t end = boxes->n[level - 1] - BOXES * i < BOXES ? boxes->n[level - 1] : BOXES * (i + 1);
        for (uint32_t k = BOXES * i; k < end; k++) visit(along, level - 1, k);
        return;
    }
    uint32_t end = boxes->n_quads - QUADS * i < QUADS ? boxes->n_quads : QUADS * (i + 1);
    along->take(along->context, 2 * QUADS * i, 2 * end);
}

/* A mesh's boxes; of several threads that make them the first one's. */
static const RtcBoxes *boxes_of(RtcMesh *mesh)
{
    RtcBoxes *boxes = atomic_load_explicit(&mesh->boxes, memory_order_acquire), *made;
    if (boxes || !(made = make_boxes(mesh))) return boxes;
    if (atomic_compare_exchange_strong(&mesh->boxes, &boxes, made)) return made;
    rtc_boxes_free(made);
    return boxes;
}

void rtc_along(const RtcScene *scene, uint32_t object, Vec3 origin, Vec3 direction, double time, RtcTake *take,
               void *context)
{
    const RtcPlaced *placed = &scene->objects[object];
    uint32_t n = rtc_n_primitives(scene, object);
    const RtcBoxes *boxes = n > 2 * QUADS ? boxes_of(&scene->meshes[placed->mesh - scene->meshes]) : NULL;
    if (!boxes) {
        take(context, 0, n);
        return;
    }
    double coordinates = boxes->largest;
    if (!placed->mesh->baked) {
        Affine to_local = rtc_to_local(scene, placed, time);
        origin = affine_point(&to_local, origin);
        direction = affine_vector(&to_local, direction);
        coordinates += vec3_max_abs(to_local.t);
    }
    Along along = {.boxes = boxes,
                   .origin = origin,
                   .direction = direction,
                   .steepness = vec3(fabs(direction.x), fabs(direction.y), fabs(direction.z)),
                   .margin = BOX_NOISE * (vec3_max_abs(origin) + coordinates),
                   .take = take,
                   .context = context};
    visit(&along, boxes->n_levels - 1, 0);
}

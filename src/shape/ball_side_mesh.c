/* ball_side_mesh.c - balls and closed meshes: the distance of triangles, and how often a ray leaves the mesh.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "mesh/exact.h"
#include "shape/ball_side.h"

Status mesh_box_tree(const Mesh *mesh, BoxTree *tree, Error *error)
{
    uint32_t n = mesh->n_triangles;
    *tree = (BoxTree){0};
    uint32_t *items = malloc(((size_t)n + 1) * sizeof *items);
    FloatBox *boxes = malloc(((size_t)n + 1) * sizeof *boxes);
    Status status = items && boxes ? STATUS_OK : fail_memory(error, n * sizeof *boxes, "a tree of boxes");
    for (uint32_t i = 0; status == STATUS_OK && i < n; i++) {
        items[i] = i;
        boxes[i] = float_box_empty();
        for (int k = 0; k < 3; k++) float_box_add_point(&boxes[i], mesh->positions[mesh->triangles[i][k]]);
    }
    if (status == STATUS_OK) status = box_tree_make(items, boxes, NULL, n, tree, error);
    free(items);
    free(boxes);
    return status;
}

typedef struct Asked {
    const Mesh *mesh;
    Vec3 centre;
    double radius;
    Vec3f from; /* a point within the ball */
    int net;    /* how often a ray towards +x leaves the mesh, less how often it enters it */
    bool unclear;
} Asked;

static void corners_of(const Asked *asked, uint32_t triangle, Vec3f corners[3])
{
    for (int k = 0; k < 3; k++) corners[k] = asked->mesh->positions[asked->mesh->triangles[triangle][k]];
}

static double squared(Vec3 v)
{
    return vec3_dot(v, v);
}

/* From the origin to the line from a to b. */
static double squared_to_edge(Vec3 a, Vec3 b)
{
    Vec3 edge = vec3_sub(b, a);
    double length = squared(edge), at = length > 0 ? -vec3_dot(a, edge) / length : 0;
    return squared(vec3_along(a, double_max(0, double_min(at, 1)), edge));
}

double squared_to_triangle(const Vec3 p[3])
{
    Vec3 normal = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
    double least = HUGE_VAL;
    bool above = true;
    for (int k = 0; k < 3; k++) {
        Vec3 a = p[k], b = p[(k + 1) % 3];
        least = double_min(least, squared_to_edge(a, b));
        above = above && vec3_dot(vec3_cross(a, b), normal) >= 0; /* the origin's foot is to the left of the edge */
    }
    double height = vec3_dot(p[0], normal), area = squared(normal);
    return above && area > 0 ? height * height / area : least;
}

static bool is_near(void *context, uint32_t triangle)
{
    const Asked *asked = context;
    Vec3f corners[3];
    Vec3 p[3];
    corners_of(asked, triangle, corners);
    for (int k = 0; k < 3; k++) p[k] = vec3_sub(vec3_from_f(corners[k]), asked->centre);
    return !(squared_to_triangle(p) > asked->radius * asked->radius);
}

static void count_crossing(void *context, uint32_t triangle)
{
    Asked *asked = context;
    Vec3f p[3];
    corners_of(asked, triangle, p);
    int turn = exact_pierce_along_x(p[0], p[1], p[2], asked->from, &asked->unclear);
    if (turn != 0 && exact_side_of_plane(p[0], p[1], p[2], asked->from) == -turn) asked->net += turn; /* ahead */
}

BallSide mesh_ball_side(const Mesh *mesh, const BoxTree *tree, Vec3 centre, double radius)
{
    Asked asked = {.mesh = mesh, .centre = centre, .radius = radius};
    Vec3 reach = vec3(radius, radius, radius);
    if (!vec3_is_finite(centre) || !isfinite(radius)) return BALL_NEAR;
    Vec3f low = vec3f_from(vec3_sub(centre, reach)), high = vec3f_from(vec3_add(centre, reach));
    FloatBox box = {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
    for (int k = 0; k < 3; k++) { /* to nearest was perhaps inward */
        box.min[k] = nextafterf(box.min[k], -INFINITY);
        box.max[k] = nextafterf(box.max[k], INFINITY);
    }
    if (box_tree_any(tree, &box, is_near, &asked)) return BALL_NEAR;
    /* anywhere in the ball: off its centre, so that what stands in line with that is not in line with edges, too */
    asked.from = vec3f_from(vec3_along(centre, 0.5 * radius, vec3(0.617, 0.341, -0.457)));
    box_tree_ray(tree, asked.from, count_crossing, &asked);
    return asked.unclear ? BALL_NEAR : asked.net > 0 ? BALL_INSIDE : BALL_OUTSIDE;
}

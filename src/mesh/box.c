/* box.c - boxes as meshes, plain, chamfered, or with rounded edges and corners.
 * A bevelled box is six faces, twelve strips (parts of cylinders) and eight corner patches (octants of
 * spheres). Every point is computed by one function from its side and its direction on the round, so that
 * patches that meet compute the same bits, and welding closes the mesh exactly.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "mesh/mesh.h"

enum { MAX_SEGMENTS = 256, N_CORNERS = 8 };

typedef struct BoxMaker {
    double low[3], high[3], bevel;
    unsigned segments;
    Mesh *mesh;
    Vec3 *ideal; /* per vertex: the same point on the box from -3 to 3 with a bevel of 1 */
    uint32_t n_vertices, n_triangles;
    double sines[MAX_SEGMENTS + 1]; /* of k / segments of a right angle */
} BoxMaker;

/* sin(k / n of a right angle), exact at both ends */
static double quarter_sine(unsigned k, unsigned n)
{
    if (k == 0) return 0;
    if (k == n) return 1;
    return sin(0.5 * MEN_PI * k / n);
}

/* A point on the surface: on each axis the side (0 low, 1 high) and how far the direction leans to it, 0..1. */
static uint32_t add_vertex(BoxMaker *maker, const unsigned side[3], const double lean[3])
{
    float position[3], normal[3];
    for (int axis = 0; axis < 3; axis++) {
        double reach = lean[axis] == 1 ? 0 : maker->bevel - maker->bevel * lean[axis];
        position[axis] = (float)(side[axis] ? maker->high[axis] - reach : maker->low[axis] + reach);
        normal[axis] = (float)(side[axis] ? lean[axis] : 0 - lean[axis]); /* never -0 */
    }
    uint32_t i = maker->n_vertices++;
    maker->mesh->positions[i] = vec3f(position[0], position[1], position[2]);
    if (maker->mesh->normals) maker->mesh->normals[i] = vec3f(normal[0], normal[1], normal[2]);
    maker->ideal[i] = vec3(side[0] ? 2 + lean[0] : -2 - lean[0], side[1] ? 2 + lean[1] : -2 - lean[1],
                           side[2] ? 2 + lean[2] : -2 - lean[2]);
    return i;
}

/* The box is convex: a triangle faces away from its centre. Asked of the ideal box, because float can have
 * flattened a triangle of the real one. */
static void add_triangle(BoxMaker *maker, uint32_t a, uint32_t b, uint32_t c)
{
    Vec3 pa = maker->ideal[a];
    Vec3 normal = vec3_cross(vec3_sub(maker->ideal[b], pa), vec3_sub(maker->ideal[c], pa));
    bool outward = vec3_dot(normal, pa) > 0;
    uint32_t *t = maker->mesh->triangles[maker->n_triangles++];
    t[0] = a;
    t[1] = outward ? b : c;
    t[2] = outward ? c : b;
}

static void add_face(BoxMaker *maker, int axis, unsigned end)
{
    uint32_t corners[4];
    for (unsigned k = 0; k < 4; k++) {
        unsigned side[3];
        double lean[3] = {0, 0, 0};
        side[axis] = end;
        side[(axis + 1) % 3] = k & 1;
        side[(axis + 2) % 3] = k >> 1;
        lean[axis] = 1;
        corners[k] = add_vertex(maker, side, lean);
    }
    add_triangle(maker, corners[0], corners[1], corners[3]);
    add_triangle(maker, corners[0], corners[3], corners[2]);
}

/* The round along `axis`, between the faces of the two other axes at the given ends. */
static void add_strip(BoxMaker *maker, int axis, unsigned end1, unsigned end2)
{
    unsigned n = maker->segments;
    int axis1 = (axis + 1) % 3, axis2 = (axis + 2) % 3;
    uint32_t before[2] = {0, 0};
    for (unsigned k = 0; k <= n; k++) {
        uint32_t here[2];
        for (unsigned end = 0; end < 2; end++) {
            unsigned side[3];
            double lean[3];
            side[axis] = end;
            side[axis1] = end1;
            side[axis2] = end2;
            lean[axis] = 0;
            lean[axis1] = maker->sines[n - k];
            lean[axis2] = maker->sines[k];
            here[end] = add_vertex(maker, side, lean);
        }
        if (k > 0) {
            add_triangle(maker, before[0], before[1], here[1]);
            add_triangle(maker, before[0], here[1], here[0]);
        }
        before[0] = here[0];
        before[1] = here[1];
    }
}

/* An octant: rows from the pole on z to the equator, row i with i steps; its three borders are the ends of
 * three strips. */
static void add_corner(BoxMaker *maker, unsigned corner)
{
    unsigned n = maker->segments;
    unsigned side[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
    uint32_t above = 0; /* the first vertex of the row before */
    for (unsigned i = 0; i <= n; i++) {
        uint32_t row = maker->n_vertices;
        for (unsigned k = 0; k <= i; k++) {
            double c = i == 0 ? 1 : quarter_sine(i - k, i);
            double s = i == 0 ? 0 : quarter_sine(k, i);
            double lean[3] = {maker->sines[i] * c, maker->sines[i] * s, maker->sines[n - i]};
            add_vertex(maker, side, lean);
        }
        for (uint32_t k = 0; k < i; k++) {
            add_triangle(maker, above + k, row + k, row + k + 1);
            if (k + 1 < i) add_triangle(maker, above + k, row + k + 1, above + k + 1);
        }
        above = row;
    }
}

static bool same_place(Vec3f a, Vec3f b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Where the bevel uses up a side, or is too small for float, triangles have shrunk to lines. They are used
 * both ways along one edge, so leaving them out keeps the mesh closed. */
static void drop_shrunk_triangles(Mesh *mesh)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *t = mesh->triangles[i];
        Vec3f a = mesh->positions[t[0]], b = mesh->positions[t[1]], c = mesh->positions[t[2]];
        if (same_place(a, b) || same_place(b, c) || same_place(c, a)) continue;
        memmove(mesh->triangles[kept++], t, sizeof mesh->triangles[0]);
    }
    mesh->n_triangles = kept;
}

static Status check_box(const double from[3], const double to[3], double bevel, unsigned segments, Error *error)
{
    static const char names[] = "xyz";
    for (int axis = 0; axis < 3; axis++) {
        if (!(fabs(from[axis]) <= 1e15) || !(fabs(to[axis]) <= 1e15))
            return fail(error, STATUS_SCENE, "the box's corners are not within +-1e15: %c goes from %g to %g",
                        names[axis], from[axis], to[axis]);
        if ((float)from[axis] == (float)to[axis])
            return fail(error, STATUS_SCENE, "the box has no extent in %c: it goes from %g to %g", names[axis],
                        from[axis], to[axis]);
        double side = fabs(to[axis] - from[axis]);
        if (!(bevel >= 0) || bevel > 0.5 * side * (1 + 1e-12)) /* half of a side that was rounded is still half */
            return fail(error, STATUS_SCENE, "the bevel %g is not within 0..%g, half of the box's extent in %c", bevel,
                        0.5 * side, names[axis]);
    }
    if (bevel > 0 && (segments < 1 || segments > MAX_SEGMENTS))
        return fail(error, STATUS_SCENE, "the bevel's %u segments are not within 1..%d", segments, MAX_SEGMENTS);
    return STATUS_OK;
}

static void make_plain_box(BoxMaker *maker)
{
    for (unsigned corner = 0; corner < N_CORNERS; corner++) {
        const unsigned side[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
        const double lean[3] = {1, 1, 1};
        add_vertex(maker, side, lean);
    }
    for (unsigned axis = 0; axis < 3; axis++)
        for (uint32_t end = 0; end < 2; end++) {
            uint32_t a = end << axis;
            uint32_t b = a | 1U << (axis + 1) % 3, c = a | 1U << (axis + 2) % 3;
            add_triangle(maker, a, b, b | c);
            add_triangle(maker, a, b | c, c);
        }
}

static void make_bevelled_box(BoxMaker *maker)
{
    for (unsigned k = 0; k <= maker->segments; k++) maker->sines[k] = quarter_sine(k, maker->segments);
    for (int axis = 0; axis < 3; axis++)
        for (unsigned end = 0; end < 2; end++) add_face(maker, axis, end);
    for (int axis = 0; axis < 3; axis++)
        for (unsigned k = 0; k < 4; k++) add_strip(maker, axis, k & 1, k >> 1);
    for (unsigned corner = 0; corner < N_CORNERS; corner++) add_corner(maker, corner);
}

Status mesh_make_box(Vec3 from, Vec3 to, double bevel, unsigned segments, Mesh **mesh, Error *error)
{
    const double a[3] = {from.x, from.y, from.z}, b[3] = {to.x, to.y, to.z};
    TRY(check_box(a, b, bevel, segments, error));
    BoxMaker maker = {.bevel = bevel, .segments = segments};
    for (int axis = 0; axis < 3; axis++) {
        maker.low[axis] = fmin(a[axis], b[axis]);
        maker.high[axis] = fmax(a[axis], b[axis]);
        maker.bevel = fmin(maker.bevel, 0.5 * (maker.high[axis] - maker.low[axis]));
    }
    uint32_t n = segments;
    uint32_t n_vertices = bevel > 0 ? 24 + 24 * (n + 1) + 4 * (n + 1) * (n + 2) : 8;
    uint32_t n_triangles = bevel > 0 ? 12 + 24 * n + 8 * n * n : 12;
    TRY(mesh_new(n_vertices, n_triangles, bevel > 0 && n > 1, false, &maker.mesh, error));
    maker.ideal = malloc(n_vertices * sizeof *maker.ideal);
    Status status = maker.ideal ? STATUS_OK : fail_memory(error, n_vertices * sizeof *maker.ideal, "a box");
    if (status == STATUS_OK) {
        if (bevel > 0)
            make_bevelled_box(&maker);
        else
            make_plain_box(&maker);
        drop_shrunk_triangles(maker.mesh);
        status = mesh_weld(maker.mesh, NULL, error);
    }
    free(maker.ideal);
    if (status == STATUS_OK)
        *mesh = maker.mesh;
    else
        mesh_free(maker.mesh);
    return status;
}

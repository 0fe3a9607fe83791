/* height_field.c - a landscape of heights as a closed solid, with sides and a bottom.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "shape/meshed.h"

typedef struct FieldMaker {
    const float *heights;
    uint32_t n_x, n_z;
    Vec3 size;
    Mesh *mesh;
    uint32_t n_vertices, n_triangles;
} FieldMaker;

static double height_at(const FieldMaker *maker, uint32_t i, uint32_t k)
{
    return (double)maker->heights[(size_t)k * maker->n_x + i] * maker->size.y;
}

static Vec3 field_point(const FieldMaker *maker, uint32_t i, uint32_t k, double y)
{
    return vec3(maker->size.x * i / (maker->n_x - 1), y, maker->size.z * k / (maker->n_z - 1));
}

static uint32_t add_vertex(FieldMaker *maker, Vec3 at, Vec3 normal)
{
    uint32_t n = maker->n_vertices++;
    maker->mesh->positions[n] = vec3f_from(at);
    if (maker->mesh->normals) maker->mesh->normals[n] = vec3f_from(vec3_normalize(normal));
    return n;
}

static void add_triangle(FieldMaker *maker, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = maker->mesh->triangles[maker->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

/* Slopes by central differences, at the rim by those to the only neighbour. */
static double slope_at(double before, double here, double behind, double step)
{
    if (isnan(before)) return (behind - here) / step;
    if (isnan(behind)) return (here - before) / step;
    return (behind - before) / (2 * step);
}

static Vec3 surface_normal(const FieldMaker *maker, uint32_t i, uint32_t k)
{
    double y = height_at(maker, i, k), none = nan("");
    double x0 = i ? height_at(maker, i - 1, k) : none, x1 = i + 1 < maker->n_x ? height_at(maker, i + 1, k) : none;
    double z0 = k ? height_at(maker, i, k - 1) : none, z1 = k + 1 < maker->n_z ? height_at(maker, i, k + 1) : none;
    return vec3(-slope_at(x0, y, x1, maker->size.x / (maker->n_x - 1)), 1,
                -slope_at(z0, y, z1, maker->size.z / (maker->n_z - 1)));
}

static void add_surface(FieldMaker *maker)
{
    uint32_t n_x = maker->n_x;
    for (uint32_t k = 0; k < maker->n_z; k++)
        for (uint32_t i = 0; i < n_x; i++)
            add_vertex(maker, field_point(maker, i, k, height_at(maker, i, k)), surface_normal(maker, i, k));
    for (uint32_t k = 0; k + 1 < maker->n_z; k++)
        for (uint32_t i = 0; i + 1 < n_x; i++) {
            uint32_t a = k * n_x + i, b = a + 1, c = a + n_x, d = c + 1;
            /* cut along the diagonal that is less steep: crests and troughs stay whole */
            if (fabsf(maker->heights[a] - maker->heights[d]) <= fabsf(maker->heights[b] - maker->heights[c])) {
                add_triangle(maker, a, d, b);
                add_triangle(maker, a, c, d);
            } else {
                add_triangle(maker, a, c, b);
                add_triangle(maker, b, c, d);
            }
        }
}

/* One side: from point to point along the rim, with the outside on the left of the way, seen from above. */
static void add_side(FieldMaker *maker, uint32_t i, uint32_t k, int step_i, int step_k, uint32_t n, double base,
                     Vec3 normal, uint32_t centre)
{
    for (uint32_t j = 0; j < n; j++) {
        double y = height_at(maker, i, k);
        uint32_t top = add_vertex(maker, field_point(maker, i, k, y), normal);
        uint32_t bottom = add_vertex(maker, field_point(maker, i, k, base), normal);
        uint32_t under = add_vertex(maker, field_point(maker, i, k, base), vec3(0, -1, 0));
        if (j > 0) {
            add_triangle(maker, top, bottom - 3, top - 3);
            add_triangle(maker, top, bottom, bottom - 3);
            add_triangle(maker, under, centre, under - 3);
        }
        i = (uint32_t)((int64_t)i + step_i);
        k = (uint32_t)((int64_t)k + step_k);
    }
}

static Status check_field(const float *heights, uint32_t n_x, uint32_t n_z, double base, Error *error)
{
    enum { MOST_POINTS = 190000000 };
    if (n_x < 2 || n_z < 2)
        return fail(error, STATUS_SCENE, "a height field needs at least 2 x 2 heights; this one has %u x %u", n_x, n_z);
    if ((uint64_t)n_x * n_z > MOST_POINTS)
        return fail(error, STATUS_SCENE, "a height field of %u x %u heights is too large; the limit is %d in all", n_x,
                    n_z, MOST_POINTS);
    for (size_t i = 0; i < (size_t)n_x * n_z; i++)
        if (!((double)heights[i] > base))
            return fail(error, STATUS_SCENE, "the height %g in row %zu, column %zu is not above the base, %g",
                        (double)heights[i], i / n_x, i % n_x, base);
    return STATUS_OK;
}

Status mesh_make_height_field(const float *heights, uint32_t n_x, uint32_t n_z, Vec3 size, double base, bool smooth,
                              Mesh **mesh, Error *error)
{
    TRY(check_field(heights, n_x, n_z, base, error));
    FieldMaker maker = {.heights = heights, .n_x = n_x, .n_z = n_z, .size = size};
    uint32_t rim = 2 * (n_x + n_z), n_vertices = n_x * n_z + 3 * rim + 1;
    uint32_t n_triangles = 2 * (n_x - 1) * (n_z - 1) + 3 * (rim - 4);
    TRY(mesh_new(n_vertices, n_triangles, smooth, false, &maker.mesh, error));
    double bottom = base * size.y;
    add_surface(&maker);
    uint32_t centre = add_vertex(&maker, vec3(0.5 * size.x, bottom, 0.5 * size.z), vec3(0, -1, 0));
    add_side(&maker, 0, 0, 1, 0, n_x, bottom, vec3(0, 0, -1), centre);
    add_side(&maker, n_x - 1, 0, 0, 1, n_z, bottom, vec3(1, 0, 0), centre);
    add_side(&maker, n_x - 1, n_z - 1, -1, 0, n_x, bottom, vec3(0, 0, 1), centre);
    add_side(&maker, 0, n_z - 1, 0, -1, n_z, bottom, vec3(-1, 0, 0), centre);
    maker.mesh->grid_columns = n_x;
    *mesh = maker.mesh;
    return STATUS_OK;
}

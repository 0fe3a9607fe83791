/* height_field.c - a landscape of heights as a closed solid, with sides and a bottom.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "shape/meshed.h"

typedef struct FieldMaker {
    const HeightField *field;
    Mesh *mesh;
    uint32_t n_vertices, n_triangles, centre; /* centre: the vertex in the middle of the bottom */
} FieldMaker;

static double height_at(const HeightField *field, uint32_t i, uint32_t k)
{
    return (double)field->heights[(size_t)k * field->n_x + i] * field->size.y;
}

static Vec3 field_point(const HeightField *field, uint32_t i, uint32_t k, double y)
{
    return vec3(field->size.x * i / (field->n_x - 1), y, field->size.z * k / (field->n_z - 1));
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

static Vec3 surface_normal(const HeightField *field, uint32_t i, uint32_t k)
{
    double y = height_at(field, i, k), none = nan("");
    double x0 = i ? height_at(field, i - 1, k) : none, x1 = i + 1 < field->n_x ? height_at(field, i + 1, k) : none;
    double z0 = k ? height_at(field, i, k - 1) : none, z1 = k + 1 < field->n_z ? height_at(field, i, k + 1) : none;
    return vec3(-slope_at(x0, y, x1, field->size.x / (field->n_x - 1)), 1,
                -slope_at(z0, y, z1, field->size.z / (field->n_z - 1)));
}

static void add_surface(FieldMaker *maker)
{
    const HeightField *field = maker->field;
    const float *heights = field->heights;
    uint32_t n_x = field->n_x;
    for (uint32_t k = 0; k < field->n_z; k++)
        for (uint32_t i = 0; i < n_x; i++)
            add_vertex(maker, field_point(field, i, k, height_at(field, i, k)), surface_normal(field, i, k));
    for (uint32_t k = 0; k + 1 < field->n_z; k++)
        for (uint32_t i = 0; i + 1 < n_x; i++) {
            uint32_t a = k * n_x + i, b = a + 1, c = a + n_x, d = c + 1;
            /* cut along the diagonal that is less steep: crests and troughs stay whole */
            if (fabsf(heights[a] - heights[d]) <= fabsf(heights[b] - heights[c])) {
                add_triangle(maker, a, d, b);
                add_triangle(maker, a, c, d);
            } else {
                add_triangle(maker, a, c, b);
                add_triangle(maker, b, c, d);
            }
        }
}

static double bottom_of(const HeightField *field)
{
    return field->base * field->size.y;
}

/* One side: from point to point along the rim, with the outside on the left of the way, seen from above. */
static void add_side(FieldMaker *maker, uint32_t i, uint32_t k, int step_i, int step_k)
{
    const HeightField *field = maker->field;
    const Vec3 normal = vec3(step_k, 0, -step_i);
    const uint32_t n = step_i ? field->n_x : field->n_z;
    for (uint32_t j = 0; j < n; j++) {
        Vec3 base = field_point(field, i, k, bottom_of(field));
        uint32_t top = add_vertex(maker, field_point(field, i, k, height_at(field, i, k)), normal);
        uint32_t bottom = add_vertex(maker, base, normal);
        uint32_t under = add_vertex(maker, base, vec3(0, -1, 0));
        if (j > 0) {
            add_triangle(maker, top, bottom - 3, top - 3);
            add_triangle(maker, top, bottom, bottom - 3);
            add_triangle(maker, under, maker->centre, under - 3);
        }
        i = (uint32_t)((int64_t)i + step_i);
        k = (uint32_t)((int64_t)k + step_k);
    }
}

static Status check_field(const HeightField *field, Error *error)
{
    enum { MOST_POINTS = 190000000 };
    uint32_t n_x = field->n_x, n_z = field->n_z;
    if (n_x < 2 || n_z < 2)
        return fail(error, STATUS_SCENE, "a height field needs at least 2 x 2 heights; this one has %u x %u", n_x, n_z);
    if ((uint64_t)n_x * n_z > MOST_POINTS)
        return fail(error, STATUS_SCENE, "a height field of %u x %u heights is too large; the limit is %d in all", n_x,
                    n_z, MOST_POINTS);
    size_t lowest = 0, highest = 0; /* the lowest is named, so that a base below it is below all */
    for (size_t i = 1; i < (size_t)n_x * n_z; i++) {
        if (!(field->heights[i] >= field->heights[lowest])) lowest = i;
        if (field->heights[i] > field->heights[highest]) highest = i;
    }
    double least = (double)field->heights[lowest], range = (double)field->heights[highest] - least;
    if (least > field->base) return STATUS_OK;
    return fail(error, STATUS_SCENE,
                "the lowest height, %g in row %zu, column %zu, is not above the base, %g: write base = %.4g, or less",
                least, lowest / n_x, lowest % n_x, field->base, least - (range > 0 ? 0.2 * range : 0.1));
}

Status mesh_make_height_field(const HeightField *field, Mesh **mesh, Error *error)
{
    TRY(check_field(field, error));
    FieldMaker maker = {.field = field};
    uint32_t n_x = field->n_x, n_z = field->n_z, rim = 2 * (n_x + n_z);
    uint32_t n_vertices = n_x * n_z + 3 * rim + 1, n_triangles = 2 * (n_x - 1) * (n_z - 1) + 3 * (rim - 4);
    TRY(mesh_new(n_vertices, n_triangles, field->smooth, false, &maker.mesh, error));
    add_surface(&maker);
    Vec3 middle = vec3(0.5 * field->size.x, bottom_of(field), 0.5 * field->size.z);
    maker.centre = add_vertex(&maker, middle, vec3(0, -1, 0));
    add_side(&maker, 0, 0, 1, 0);
    add_side(&maker, n_x - 1, 0, 0, 1);
    add_side(&maker, n_x - 1, n_z - 1, -1, 0);
    add_side(&maker, 0, n_z - 1, 0, -1);
    maker.mesh->grid_columns = n_x;
    *mesh = maker.mesh;
    return STATUS_OK;
}

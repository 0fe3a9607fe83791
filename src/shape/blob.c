/* blob.c - blobs: bodies of balls and rods that flow into each other (J. F. Blinn, "A Generalization of Algebraic
 * Surface Drawing", ACM TOG 1(3), 1982), with the density that POV-Ray's have.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape/box_cells.h"
#include "shape/implicit.h"

enum { MAX_CELLS = 48, CELLS_PER_PART = 8 }; /* of the table of what is where: along an axis, in all */

typedef struct Part {
    Affine to_local;
    Vec3 from, along; /* along: from the begin to the end */
    double length2, inverse_radius, strength;
    Box3 bounds; /* outside of it the density is 0 */
} Part;

typedef struct Blob {
    Part *parts;
    size_t n_parts;
    double threshold;
    Box3 bounds;
    BoxCells cells; /* of the parts' bounds */
} Blob;

/* Distance over radius, squared, and the way from the axis. */
static double distance2(const Part *part, Vec3 p, Vec3 *local)
{
    Vec3 way = vec3_sub(affine_point(&part->to_local, p), part->from);
    if (part->length2 > 0) {
        double t = vec3_dot(way, part->along) / part->length2;
        way = vec3_along(way, -fmin(fmax(t, 0), 1), part->along);
    }
    *local = vec3_scale(way, part->inverse_radius);
    return vec3_dot(*local, *local);
}

static double density(const Part *part, Vec3 p)
{
    Vec3 local;
    double d2 = distance2(part, p, &local);
    return d2 < 1 ? part->strength * (1 - d2) * (1 - d2) : 0;
}

static bool blob_value(void *context, Vec3 p, double *value)
{
    const Blob *blob = context;
    uint32_t n;
    const uint32_t *parts = box_cells_at(&blob->cells, p, &n);
    *value = -blob->threshold;
    for (uint32_t i = 0; i < n; i++) *value += density(&blob->parts[parts[i]], p);
    return true;
}

static bool blob_gradient(void *context, Vec3 p, Vec3 *gradient)
{
    const Blob *blob = context;
    uint32_t n;
    const uint32_t *parts = box_cells_at(&blob->cells, p, &n);
    *gradient = vec3(0, 0, 0);
    for (uint32_t i = 0; i < n; i++) {
        const Part *part = &blob->parts[parts[i]];
        Vec3 local;
        double d2 = distance2(part, p, &local);
        if (d2 >= 1) continue;
        double factor = -4 * part->strength * (1 - d2) * part->inverse_radius;
        *gradient = vec3_along(*gradient, factor, affine_normal(&part->to_local, local));
    }
    return true;
}

/* The first and the last point of a row of the lattice between two places. */
static bool points_between(double low, double high, double origin, double step, uint32_t n, uint32_t *first,
                           uint32_t *last)
{
    double a = fmax(ceil((low - origin) / step), 0), b = fmin(floor((high - origin) / step), (double)n - 1);
    if (!(a <= b)) return false;
    *first = (uint32_t)a;
    *last = (uint32_t)b;
    return true;
}

/* Each part adds to the points that it reaches. */
static bool blob_layer(void *context, const Lattice *lattice, uint32_t k, const uint8_t *wanted, double *values)
{
    (void)wanted; /* it has no bounds */
    const Blob *blob = context;
    double z = lattice->origin.z + lattice->step.z * k;
    for (size_t i = 0; i < (size_t)lattice->n[0] * lattice->n[1]; i++) values[i] = -blob->threshold;
    for (size_t n = 0; n < blob->n_parts; n++) {
        const Part *part = &blob->parts[n];
        uint32_t i0, i1, j0, j1;
        if (z < part->bounds.min.z || z > part->bounds.max.z) continue;
        if (!points_between(part->bounds.min.x, part->bounds.max.x, lattice->origin.x, lattice->step.x, lattice->n[0],
                            &i0, &i1) ||
            !points_between(part->bounds.min.y, part->bounds.max.y, lattice->origin.y, lattice->step.y, lattice->n[1],
                            &j0, &j1))
            continue;
        for (uint32_t j = j0; j <= j1; j++)
            for (uint32_t i = i0; i <= i1; i++)
                values[(size_t)j * lattice->n[0] + i] += density(
                    part, vec3(lattice->origin.x + lattice->step.x * i, lattice->origin.y + lattice->step.y * j, z));
    }
    return true;
}

/* ---- making ---- */

static Status set_part(const BlobComponent *component, size_t number, Part *part, Error *error)
{
    if (!affine_invert(&component->to_world, &part->to_local))
        return fail(error, STATUS_SCENE, "the transforms of component %zu of the blob squash it flat", number);
    part->from = component->from;
    part->along = vec3_sub(component->to, component->from);
    part->length2 = vec3_dot(part->along, part->along);
    part->inverse_radius = 1 / component->radius;
    part->strength = component->strength;
    Box3 box = box3_add_point(box3_add_point(box3_empty(), component->from), component->to);
    Vec3 margin = vec3(component->radius, component->radius, component->radius);
    part->bounds = affine_box(&component->to_world, (Box3){vec3_sub(box.min, margin), vec3_add(box.max, margin)});
    return STATUS_OK;
}

static Status make_blob(Blob *blob, const BlobShape *shape, Pool *pool, Mesh **mesh, double *reached, Error *error)
{
    const BlobComponent *components = shape->components;
    double smallest = HUGE_VAL;
    blob->bounds = box3_empty();
    for (size_t i = 0; i < blob->n_parts; i++) {
        TRY(set_part(&components[i], i, &blob->parts[i], error));
        if (components[i].strength <= 0) continue; /* only takes away */
        Box3 box = blob->parts[i].bounds;
        blob->bounds = box3_union(blob->bounds, box);
        Vec3 size = vec3_sub(box.max, box.min);
        smallest = fmin(smallest, fmin(size.x, fmin(size.y, size.z)));
    }
    if (box3_is_empty(blob->bounds))
        return fail(error, STATUS_SCENE, "the blob has no component with a positive strength");
    const Part *parts = blob->parts;
    TRY(box_cells_make(&blob->cells, blob->bounds, CELLS_PER_PART, MAX_CELLS, &parts->bounds, sizeof *parts,
                       blob->n_parts, "the blob", error));
    double extent = vec3_max_abs(vec3_sub(blob->bounds.max, blob->bounds.min));
    const ImplicitField field = {blob, blob_layer, blob_value, blob_value, blob_gradient, NULL};
    const ImplicitOptions options = {.bounds = blob->bounds,
                                     .tolerance = shape->tolerance > 0 ? shape->tolerance : extent / 4000,
                                     .cells = (uint32_t)fmin(fmax(48, 10 * extent / smallest), 1000),
                                     .max_points = 20000000,
                                     .pool = pool};
    ImplicitFound found;
    Status status = mesh_make_implicit(&field, &options, "the blob", mesh, &found, error);
    *reached = found.reached;
    return status;
}

Status mesh_make_blob(const BlobShape *shape, Pool *pool, Mesh **mesh, double *reached, Error *error)
{
    Blob blob = {.n_parts = shape->n, .threshold = shape->threshold};
    if (shape->n == 0) return fail(error, STATUS_SCENE, "the blob has no components");
    blob.parts = malloc(shape->n * sizeof *blob.parts);
    if (!blob.parts) return fail_memory(error, shape->n * sizeof *blob.parts, "a blob");
    Status status = make_blob(&blob, shape, pool, mesh, reached, error);
    free(blob.parts);
    box_cells_clear(&blob.cells);
    return status;
}

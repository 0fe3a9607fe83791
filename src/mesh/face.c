/* face.c - triangles that cover a polygon of a mesh file.
 * A fan from one corner leaves a polygon that has hollows, as a star or a letter. Such a one is cut by its ears: corners whose
 * triangle with those beside them has nothing else of the outline in it (G. H. Meisters, "Polygons have ears", 1975). An ear that
 * is cut off makes ears of none but the corners beside it. Seen along the axis that its normal is nearest to; decided without
 * rounding.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/face.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/hash.h"

/* Puts the corners into a plane, counter-clockwise. false: it has no area. */
static bool flatten(FaceCut *cut)
{
    Vec3 first = vec3_from_f(cut->corners[0]), normal = vec3(0, 0, 0);
    for (uint32_t i = 2; i < cut->n; i++) {
        Vec3 a = vec3_sub(vec3_from_f(cut->corners[i - 1]), first), b = vec3_sub(vec3_from_f(cut->corners[i]), first);
        normal = vec3_add(normal, vec3_cross(a, b));
    }
    double x = fabs(normal.x), y = fabs(normal.y), z = fabs(normal.z), most = double_max(double_max(x, y), z);
    if (!(most > 0)) return false;
    bool upward = (most == z ? normal.z : most == y ? normal.y : normal.x) > 0;
    for (uint32_t i = 0; i < cut->n; i++) {
        Vec3 p = vec3_from_f(cut->corners[i]);
        Point2 at = most == z ? (Point2){p.x, p.y} : most == y ? (Point2){p.z, p.x} : (Point2){p.y, p.z};
        cut->at[i] = upward ? at : (Point2){at.y, at.x};
    }
    return true;
}

static bool fan_covers(const FaceCut *cut)
{
    for (uint32_t i = 2; i < cut->n; i++)
        if (exact_turn(cut->at[0], cut->at[i - 1], cut->at[i]) < 0) return false;
    return true;
}

static bool same_place(Point2 a, Point2 b)
{
    return a.x == b.x && a.y == b.y;
}

/* Only corners that are not convex can be in the way. */
static bool is_ear(const FaceCut *cut, uint32_t tip)
{
    const Point2 *at = cut->at;
    uint32_t before = cut->before[tip], behind = cut->behind[tip];
    Point2 a = at[before], b = at[tip], c = at[behind];
    if (exact_turn(a, b, c) <= 0) return false;
    for (uint32_t i = cut->behind[behind]; i != before; i = cut->behind[i]) {
        Point2 p = at[i];
        if (exact_turn(at[cut->before[i]], p, at[cut->behind[i]]) > 0) continue;
        if (same_place(p, a) || same_place(p, b) || same_place(p, c)) continue; /* where a hole is led to */
        if (exact_turn(a, b, p) >= 0 && exact_turn(b, c, p) >= 0 && exact_turn(c, a, p) >= 0) return false;
    }
    return true;
}

static void set_triangle(FaceCut *cut, uint32_t i, uint32_t a, uint32_t b, uint32_t c)
{
    cut->triangles[i][0] = a;
    cut->triangles[i][1] = b;
    cut->triangles[i][2] = c;
}

/* Cuts ears off until three corners are left, or no ear is. The number of those that are left; *at: one of them. */
static uint32_t cut_ears(FaceCut *cut, uint32_t *n_triangles, uint32_t *at)
{
    uint32_t left = cut->n, i = 0, passed = 0;
    for (uint32_t k = 0; k < cut->n; k++) {
        cut->before[k] = k ? k - 1 : cut->n - 1;
        cut->behind[k] = k + 1 < cut->n ? k + 1 : 0;
        cut->no_ear[k] = false;
    }
    while (left > 3 && passed < left) {
        uint32_t before = cut->before[i], behind = cut->behind[i];
        if (cut->no_ear[i] || !is_ear(cut, i)) {
            cut->no_ear[i] = true;
            passed++;
            i = behind;
            continue;
        }
        set_triangle(cut, (*n_triangles)++, before, i, behind);
        cut->behind[before] = behind;
        cut->before[behind] = before;
        cut->no_ear[before] = cut->no_ear[behind] = false;
        left--;
        passed = 0;
        i = cut->behind[behind]; /* not the next one, so that not all triangles share a corner */
    }
    *at = i;
    return left;
}

bool face_cut(FaceCut *cut)
{
    uint32_t n_triangles = 0, left = cut->n, first = 0;
    bool is_fan = !flatten(cut) || fan_covers(cut);
    if (!is_fan) left = cut_ears(cut, &n_triangles, &first);
    uint32_t last = is_fan ? 1 : cut->behind[first];
    for (; left > 2; left--) {
        uint32_t next = is_fan ? last + 1 : cut->behind[last];
        set_triangle(cut, n_triangles++, first, last, next);
        last = next;
    }
    return !is_fan;
}

Status mesh_cut_face(Mesh *mesh, size_t first, size_t n, FaceCut *cut, Error *error)
{
    uint32_t(*fan)[3] = mesh->triangles + first;
    if (n < 2) return STATUS_OK;
    cut->n = (uint32_t)n + 2;
    for (size_t k = 0; k < n + 2; k++) {
        cut->ring[k] = k < 2 ? fan[0][k] : fan[k - 2][2];
        cut->corners[k] = mesh->positions[cut->ring[k]];
    }
    if (!face_cut(cut)) return STATUS_OK;
    if (!ARRAY_ROOM(mesh->cuts, mesh->cuts_capacity, mesh->n_cuts))
        return fail_memory(error, 2 * mesh->n_cuts * sizeof *mesh->cuts, "the faces of a mesh");
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++) fan[i][k] = cut->ring[cut->triangles[i][k]];
    mesh->cuts[mesh->n_cuts++] = (MeshCut){(uint32_t)first, (uint32_t)n};
    return STATUS_OK;
}

/* The same for triangles that have the same border: edges within count once each way. */
static uint64_t border_hash(const Mesh *mesh, MeshCut cut)
{
    uint64_t sum = 0;
    for (uint32_t i = cut.first; i < cut.first + cut.n; i++)
        for (int k = 0; k < 3; k++) {
            uint64_t from = mesh->triangles[i][k], to = mesh->triangles[i][(k + 1) % 3];
            sum += hash_u64(from << 32 | to) - hash_u64(to << 32 | from);
        }
    return sum;
}

static void keep_cuts_of(const Mesh *list, const Mesh *mesh, Mesh *then)
{
    for (size_t i = 0; i < list->n_cuts; i++) {
        MeshCut cut = list->cuts[i];
        uint64_t end = (uint64_t)cut.first + cut.n;
        if (end > mesh->n_triangles || end > then->n_triangles || border_hash(mesh, cut) != border_hash(then, cut))
            continue;
        memcpy(then->triangles[cut.first], mesh->triangles[cut.first], cut.n * sizeof *mesh->triangles);
    }
}

void mesh_keep_cuts(const Mesh *mesh, Mesh *then)
{
    keep_cuts_of(mesh, mesh, then);
    keep_cuts_of(then, mesh, then);
}

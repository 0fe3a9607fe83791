/* closed.c - the mending of orientation: which triangles to turn so that neighbours agree, and the whole looks outward.
 * It rests on the edges of topology.h. There is no tolerance anywhere, so the size of the mesh does not matter.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "base/angle.h"
#include "mesh/topology.h"

/* A sheet is a set of triangles joined by edges of exactly two. */
typedef struct Sheets {
    uint32_t *sheet;   /* per triangle; NO_SHEET for those with two equal corners */
    bool *turned;      /* per triangle */
    uint32_t *members; /* triangles in the order of the flood, sheet by sheet */
    uint32_t *first;   /* per sheet: its first member; one more at the end */
    uint32_t n;
    Box3 *bounds; /* per sheet */
} Sheets;

static const uint32_t no_sheet = UINT32_MAX;

/* The triangles beyond the edges of one. */
typedef struct Neighbours {
    uint32_t triangle[3]; /* no_sheet: none, or an edge of more than two triangles */
    bool agrees[3];       /* runs along the edge the other way, as it should */
} Neighbours;

static void sheets_clear(Sheets *sheets)
{
    free(sheets->sheet);
    free(sheets->turned);
    free(sheets->members);
    free(sheets->first);
    free(sheets->bounds);
}

static void find_neighbours(const Topology *topology, Neighbours *neighbours)
{
    for (uint32_t i = 0; i < topology->mesh->n_triangles; i++)
        neighbours[i] = (Neighbours){{no_sheet, no_sheet, no_sheet}, {true, true, true}};
    uint32_t low = 0;
    size_t at = 0;
    Edge edge;
    while (topology_next_edge(topology, &low, &at, &edge)) {
        if (edge.n != 2) continue;
        for (int k = 0; k < 2; k++) {
            Neighbours *here = &neighbours[edge.uses[k].triangle];
            int slot = 0;
            while (here->triangle[slot] != no_sheet) slot++;
            here->triangle[slot] = edge.uses[1 - k].triangle;
            here->agrees[slot] = edge.n_upward == 1;
        }
    }
}

/* Floods one sheet from its first triangle. False when it has only one side. */
static bool flood_sheet(const Neighbours *neighbours, Sheets *sheets, uint32_t seed, uint32_t *n_members)
{
    uint32_t first = *n_members;
    uint32_t n_turned = 0;
    sheets->sheet[seed] = sheets->n;
    sheets->members[(*n_members)++] = seed;
    for (uint32_t at = first; at < *n_members; at++) {
        uint32_t here = sheets->members[at];
        n_turned += sheets->turned[here];
        for (int k = 0; k < 3; k++) {
            uint32_t there = neighbours[here].triangle[k];
            if (there == no_sheet) continue;
            bool wanted = sheets->turned[here] != !neighbours[here].agrees[k];
            if (sheets->sheet[there] == no_sheet) {
                sheets->sheet[there] = sheets->n;
                sheets->turned[there] = wanted;
                sheets->members[(*n_members)++] = there;
            } else if (sheets->turned[there] != wanted) {
                return false;
            }
        }
    }
    if (n_turned > (*n_members - first) / 2)
        for (uint32_t at = first; at < *n_members; at++)
            sheets->turned[sheets->members[at]] = !sheets->turned[sheets->members[at]];
    return true;
}

static Status make_sheets(const Topology *topology, Sheets *sheets, bool *orientable, Error *error)
{
    size_t n = topology->mesh->n_triangles;
    *sheets = (Sheets){.n = 0};
    Neighbours *neighbours = malloc((n + 1) * sizeof *neighbours);
    sheets->sheet = malloc((n + 1) * sizeof *sheets->sheet);
    sheets->turned = calloc(n + 1, sizeof *sheets->turned);
    sheets->members = malloc((n + 1) * sizeof *sheets->members);
    sheets->first = malloc((n + 2) * sizeof *sheets->first);
    if (!neighbours || !sheets->sheet || !sheets->turned || !sheets->members || !sheets->first) {
        free(neighbours);
        return fail_memory(error, (n + 1) * sizeof *neighbours, "the orientation of a mesh");
    }
    find_neighbours(topology, neighbours);
    for (size_t i = 0; i < n; i++) sheets->sheet[i] = no_sheet;
    uint32_t n_members = 0;
    *orientable = true;
    for (uint32_t i = 0; i < n && *orientable; i++) {
        uint32_t ids[3];
        if (sheets->sheet[i] != no_sheet || !topology_corners(topology, i, ids)) continue;
        sheets->first[sheets->n] = n_members;
        *orientable = flood_sheet(neighbours, sheets, i, &n_members);
        sheets->n++;
    }
    sheets->first[sheets->n] = n_members;
    free(neighbours);
    return STATUS_OK;
}

/* Every edge is used as often one way as the other (even), or, when that is not asked for, at least not
 * two times more. */
static bool edges_balance(const Topology *topology, const Sheets *sheets, bool even)
{
    uint32_t low = 0;
    size_t at = 0;
    Edge edge;
    while (topology_next_edge(topology, &low, &at, &edge)) {
        size_t n_upward = 0;
        for (size_t k = 0; k < edge.n; k++) n_upward += edge.uses[k].upward != sheets->turned[edge.uses[k].triangle];
        size_t n_downward = edge.n - n_upward;
        size_t more = n_upward > n_downward ? n_upward - n_downward : n_downward - n_upward;
        if (more > (even ? 0 : 1)) return false;
    }
    return true;
}

static void turn_sheet(Sheets *sheets, uint32_t which)
{
    for (uint32_t at = sheets->first[which]; at < sheets->first[which + 1]; at++)
        sheets->turned[sheets->members[at]] = !sheets->turned[sheets->members[at]];
}

static double sheet_volume(const Mesh *mesh, const Sheets *sheets, uint32_t which, Vec3 reference)
{
    double sum = 0;
    for (uint32_t at = sheets->first[which]; at < sheets->first[which + 1]; at++) {
        uint32_t i = sheets->members[at];
        sum +=
            sheets->turned[i] ? -mesh_triangle_volume6(mesh, i, reference) : mesh_triangle_volume6(mesh, i, reference);
    }
    return sum / 6;
}

/* The solid angle of a sheet seen from p, as a fraction of the sphere; A. van Oosterom, J. Strackee, "The
 * Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2) (1983). */
static double sheet_winding(const Mesh *mesh, const Sheets *sheets, uint32_t which, Vec3 p)
{
    double sum = 0;
    for (uint32_t at = sheets->first[which]; at < sheets->first[which + 1]; at++) {
        uint32_t i = sheets->members[at];
        const uint32_t *t = mesh->triangles[i];
        Vec3 a = vec3_sub(vec3_from_f(mesh->positions[t[0]]), p);
        Vec3 b = vec3_sub(vec3_from_f(mesh->positions[t[1]]), p);
        Vec3 c = vec3_sub(vec3_from_f(mesh->positions[t[2]]), p);
        double la = vec3_length(a), lb = vec3_length(b), lc = vec3_length(c);
        double y = vec3_dot(a, vec3_cross(b, c));
        double x = la * lb * lc + vec3_dot(a, b) * lc + vec3_dot(b, c) * la + vec3_dot(c, a) * lb;
        double angle = atan2(y, x);
        sum += sheets->turned[i] ? -angle : angle;
    }
    return sum * (1 / (2 * MEN_PI)); /* 2 angle / (4 pi) */
}

/* Whether a sheet lies inside what the others enclose, judged in the middle of one of its triangles, which
 * is off the others even where they share edges. Only those whose box holds its box can enclose it. */
static bool sheet_is_inside(const Mesh *mesh, const Sheets *sheets, uint32_t which)
{
    const uint32_t *t = mesh->triangles[sheets->members[sheets->first[which]]];
    Vec3 p = vec3(0, 0, 0);
    for (int k = 0; k < 3; k++) p = vec3_along(p, 1.0 / 3, vec3_from_f(mesh->positions[t[k]]));
    double winding = 0;
    for (uint32_t k = 0; k < sheets->n; k++)
        if (k != which && box3_holds(sheets->bounds[k], sheets->bounds[which]))
            winding += sheet_winding(mesh, sheets, k, p);
    return winding > 0.5;
}

/* Bounds of the sheets, and their volumes: *volumes is malloc'd, one for each. */
static Status measure_sheets(const Mesh *mesh, Sheets *sheets, double **volumes, Error *error)
{
    *volumes = calloc((size_t)sheets->n + 1, sizeof **volumes);
    sheets->bounds = malloc(((size_t)sheets->n + 1) * sizeof *sheets->bounds);
    if (!*volumes || !sheets->bounds) {
        free(*volumes);
        return fail_memory(error, sheets->n * sizeof *sheets->bounds, "the orientation of a mesh");
    }
    for (uint32_t k = 0; k < sheets->n; k++) {
        sheets->bounds[k] = box3_empty();
        for (uint32_t at = sheets->first[k]; at < sheets->first[k + 1]; at++)
            for (int corner = 0; corner < 3; corner++)
                sheets->bounds[k] = box3_add_point(
                    sheets->bounds[k], vec3_from_f(mesh->positions[mesh->triangles[sheets->members[at]][corner]]));
        (*volumes)[k] = sheet_volume(mesh, sheets, k, box3_centre(sheets->bounds[k]));
    }
    return STATUS_OK;
}

/* Decides which side of each sheet of a closed mesh is outside. */
static Status turn_outward(const Mesh *mesh, Sheets *sheets, Error *error)
{
    double *volumes, total = 0;
    TRY(measure_sheets(mesh, sheets, &volumes, error));
    for (uint32_t k = 0; k < sheets->n; k++) total += volumes[k];
    for (uint32_t k = 0; k < sheets->n && total < 0; k++) {
        turn_sheet(sheets, k);
        volumes[k] = -volumes[k];
    }
    for (uint32_t k = 0; k < sheets->n; k++)
        if (volumes[k] < 0 && !sheet_is_inside(mesh, sheets, k)) turn_sheet(sheets, k);
    free(volumes);
    return STATUS_OK;
}

/* Turns the triangles that were marked, and then the normals that point against their triangles. */
static void apply_turns(Mesh *mesh, const Sheets *sheets)
{
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        uint32_t *t = mesh->triangles[i], keep = t[1];
        if (!sheets->turned[i]) continue;
        t[1] = t[2];
        t[2] = keep;
    }
}

Status mesh_orient(Mesh *mesh, Pool *pool, bool *mended, Error *error)
{
    Topology topology;
    Sheets sheets = {.n = 0};
    *mended = false;
    bool orientable = false;
    Status status = topology_make(mesh, pool, &topology, error);
    if (status == STATUS_OK) status = make_sheets(&topology, &sheets, &orientable, error);
    if (status == STATUS_OK && orientable) {
        /* Whether it is closed is a matter of even counts, which turning does not change. */
        uint32_t low = 0;
        size_t at = 0;
        Edge edge;
        bool even = sheets.n > 0;
        while (even && topology_next_edge(&topology, &low, &at, &edge)) even = edge.n % 2 == 0;
        if (even) status = turn_outward(mesh, &sheets, error);
        if (status == STATUS_OK && edges_balance(&topology, &sheets, even)) {
            apply_turns(mesh, &sheets);
            *mended = true;
        }
    }
    sheets_clear(&sheets);
    topology_clear(&topology);
    return status;
}

Status mesh_turn_normals(Mesh *mesh, uint32_t *n_turned, Error *error)
{
    /* of both sides of a sheet that share their vertices, nothing is left but rounding */
    const float clear = 0.01f;
    *n_turned = 0;
    if (!mesh->normals) return STATUS_OK;
    float(*sums)[2] = calloc((size_t)mesh->n_vertices + 1, sizeof *sums); /* for and against, and how much of both */
    if (!sums) return fail_memory(error, mesh->n_vertices * sizeof *sums, "normals");
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *t = mesh->triangles[i];
        Vec3 normal = mesh_area_normal(mesh, i);
        for (int k = 0; k < 3; k++) {
            float agreement = (float)vec3_dot(normal, vec3_from_f(mesh->normals[t[k]]));
            sums[t[k]][0] += agreement;
            sums[t[k]][1] += fabsf(agreement);
        }
    }
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        if (!(sums[i][0] < -clear * sums[i][1])) continue;
        mesh->normals[i] = vec3f_negate(mesh->normals[i]);
        ++*n_turned;
    }
    free(sums);
    return STATUS_OK;
}

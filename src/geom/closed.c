/* closed.c - whether a mesh encloses anything: edges, components, volume; and the mending of orientation.
 * Everything rests on the edges of topology.h. There is no tolerance anywhere, so the size of the mesh does not matter.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "geom/topology.h"

static Box3 used_bounds(const Mesh *mesh, bool *finite)
{
    Box3 bounds = box3_empty();
    *finite = true;
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        for (int k = 0; k < 3; k++) {
            Vec3 p = vec3_from_f(mesh->positions[mesh->triangles[i][k]]);
            if (!vec3_is_finite(p)) *finite = false;
            bounds = box3_add_point(bounds, p);
        }
    return bounds;
}

static Vec3 box_centre(Box3 box)
{
    if (box3_is_empty(box)) return vec3(0, 0, 0);
    return vec3_scale(vec3_add(box.min, box.max), 0.5);
}

/* Six times the signed volume of the tetrahedron over a triangle with its tip in `centre`. */
static double triangle_volume6(const Mesh *mesh, uint32_t i, Vec3 centre)
{
    const uint32_t *t = mesh->triangles[i];
    Vec3 a = vec3_sub(vec3_from_f(mesh->positions[t[0]]), centre);
    Vec3 b = vec3_sub(vec3_from_f(mesh->positions[t[1]]), centre);
    Vec3 c = vec3_sub(vec3_from_f(mesh->positions[t[2]]), centre);
    return vec3_dot(a, vec3_cross(b, c));
}

double mesh_volume(const Mesh *mesh)
{
    bool finite;
    Vec3 centre = box_centre(used_bounds(mesh, &finite));
    double sum = 0;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) sum += triangle_volume6(mesh, i, centre);
    return sum / 6;
}

static void count_edges(const Topology *topology, uint32_t *parent, MeshReport *report, bool *repeated)
{
    uint32_t low = 0;
    size_t at = 0;
    Edge edge;
    report->consistent = true;
    *repeated = false;
    while (topology_next_edge(topology, &low, &at, &edge)) {
        size_t n_downward = edge.n - edge.n_upward;
        size_t more = edge.n_upward > n_downward ? edge.n_upward - n_downward : n_downward - edge.n_upward;
        if (edge.n_upward > 1 || n_downward > 1) *repeated = true;
        if (more > 1) report->consistent = false;
        if (edge.n > 2) {
            if (report->n_non_manifold_edges < COUNT_OF(report->non_manifold)) {
                report->non_manifold[report->n_non_manifold_edges].a = topology->mesh->positions[edge.low];
                report->non_manifold[report->n_non_manifold_edges].b = topology->mesh->positions[edge.high];
            }
            report->n_non_manifold_edges++;
        }
        if (more > 0) {
            if (report->n_open_edges < COUNT_OF(report->open)) {
                report->open[report->n_open_edges].a = topology->mesh->positions[edge.low];
                report->open[report->n_open_edges].b = topology->mesh->positions[edge.high];
            }
            report->n_open_edges++;
        }
        for (size_t k = 1; k < edge.n; k++) set_unite(parent, edge.uses[0].triangle, edge.uses[k].triangle);
    }
}

/* Triangles with the same corners in the same turning sense, beyond the first. */
static Status count_duplicates(const Topology *topology, uint32_t *count, Error *error)
{
    const Mesh *mesh = topology->mesh;
    size_t room = 16;
    while (room < 2 * (size_t)mesh->n_triangles) room *= 2;
    uint32_t(*table)[3] = calloc(room, sizeof *table); /* corners + 1, lowest first */
    if (!table) return fail_memory(error, room * sizeof *table, "the search for double triangles");
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        uint32_t ids[3];
        if (!topology_corners(topology, i, ids)) continue;
        int first = ids[0] < ids[1] ? (ids[0] < ids[2] ? 0 : 2) : (ids[1] < ids[2] ? 1 : 2);
        uint32_t key[3] = {ids[first] + 1, ids[(first + 1) % 3] + 1, ids[(first + 2) % 3] + 1};
        size_t slot = (size_t)hash_u64(hash_u64(key[0] | (uint64_t)key[1] << 32) ^ key[2]) & (room - 1);
        while (table[slot][0] && memcmp(table[slot], key, sizeof key) != 0) slot = (slot + 1) & (room - 1);
        if (table[slot][0])
            ++*count;
        else
            memcpy(table[slot], key, sizeof key);
    }
    free(table);
    return STATUS_OK;
}

static Status measure(const Topology *topology, uint32_t *parent, MeshReport *report, Error *error)
{
    const Mesh *mesh = topology->mesh;
    double *volumes = calloc((size_t)mesh->n_triangles + 1, sizeof *volumes); /* six times, at the leading triangle */
    if (!volumes) return fail_memory(error, mesh->n_triangles * sizeof *volumes, "the volumes of a mesh");
    Vec3 centre = box_centre(report->bounds);
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *t = mesh->triangles[i];
        Vec3 a = vec3_from_f(mesh->positions[t[0]]);
        Vec3 cross = vec3_cross(vec3_sub(vec3_from_f(mesh->positions[t[1]]), a),
                                vec3_sub(vec3_from_f(mesh->positions[t[2]]), a));
        double twice_area = vec3_length(cross);
        report->area += 0.5 * twice_area;
        report->volume += triangle_volume6(mesh, i, centre) / 6;
        uint32_t ids[3];
        bool proper = topology_corners(topology, i, ids);
        if (!proper || twice_area == 0) report->n_degenerate++;
        if (!proper) continue;
        uint32_t root = set_find(parent, i);
        if (root == i) report->n_components++;
        /* A closed part's volume does not depend on the reference; its own first corner keeps it exact
         * when the part is small and far from the centre. */
        volumes[root] += triangle_volume6(mesh, i, vec3_from_f(mesh->positions[mesh->triangles[root][0]]));
    }
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        if (volumes[i] < 0) report->n_inverted++;
    free(volumes);
    return STATUS_OK;
}

Status mesh_inspect(const Mesh *mesh, MeshReport *report, Error *error)
{
    memset(report, 0, sizeof *report);
    report->bounds = used_bounds(mesh, &report->finite);
    Topology topology;
    uint32_t *parent = NULL; /* triangles that share edges are one set */
    bool repeated = false;
    Status status = topology_make(mesh, &topology, error);
    if (status == STATUS_OK) status = sets_new(mesh->n_triangles, &parent, error);
    if (status == STATUS_OK) {
        count_edges(&topology, parent, report, &repeated);
        if (repeated) status = count_duplicates(&topology, &report->n_duplicate, error);
    }
    if (status == STATUS_OK) status = measure(&topology, parent, report, error);
    free(parent);
    topology_clear(&topology);
    report->closed = report->n_components > 0 && report->n_open_edges == 0 && report->consistent && report->finite;
    report->inside_out = report->volume < 0;
    return status;
}

/* Orientation. A sheet is a set of triangles joined by edges of exactly two. */
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
        sum += sheets->turned[i] ? -triangle_volume6(mesh, i, reference) : triangle_volume6(mesh, i, reference);
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
    return sum * 0.15915494309189535; /* 2 angle / (4 pi) */
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
        (*volumes)[k] = sheet_volume(mesh, sheets, k, box_centre(sheets->bounds[k]));
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
static Status apply_turns(Mesh *mesh, const Sheets *sheets, Error *error)
{
    float *agreement = mesh->normals ? calloc((size_t)mesh->n_vertices + 1, sizeof *agreement) : NULL;
    if (mesh->normals && !agreement) return fail_memory(error, mesh->n_vertices * sizeof *agreement, "normals");
    bool any = false;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        uint32_t *t = mesh->triangles[i];
        if (sheets->turned[i]) {
            uint32_t keep = t[1];
            t[1] = t[2];
            t[2] = keep;
            any = true;
        }
        if (!agreement) continue;
        Vec3 a = vec3_from_f(mesh->positions[t[0]]);
        Vec3 normal = vec3_cross(vec3_sub(vec3_from_f(mesh->positions[t[1]]), a),
                                 vec3_sub(vec3_from_f(mesh->positions[t[2]]), a));
        for (int k = 0; k < 3; k++) agreement[t[k]] += (float)vec3_dot(normal, vec3_from_f(mesh->normals[t[k]]));
    }
    for (uint32_t i = 0; any && agreement && i < mesh->n_vertices; i++)
        if (agreement[i] < 0) mesh->normals[i] = vec3f_negate(mesh->normals[i]);
    free(agreement);
    return STATUS_OK;
}

Status mesh_orient(Mesh *mesh, bool *mended, Error *error)
{
    Topology topology;
    Sheets sheets = {.n = 0};
    *mended = false;
    bool orientable = false;
    Status status = topology_make(mesh, &topology, error);
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
            status = apply_turns(mesh, &sheets, error);
            *mended = status == STATUS_OK;
        }
    }
    sheets_clear(&sheets);
    topology_clear(&topology);
    return status;
}

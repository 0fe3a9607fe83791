/* quads.c - triangles in pairs.
 *
 * Triangles announce their longest edges, one after another. One that finds its edge announced by another that is still
 * free is paired with that. Those that are left over announce their next edges, and so on. Meshes made of rectangles so
 * get them back, and of others few triangles stay alone: a matching along the longest edges, but for what the order of
 * the announcements makes of it, in the time of going through the mesh a few times.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/quads.h"

#include <stdlib.h>

/* Places at which an announcement is looked for and put, beginning with its own. */
enum { MOST_LOOKS = 16 };
#define NOBODY UINT32_MAX

typedef struct Pairing {
    const Mesh *mesh;
    uint32_t *announced; /* by place: 3 * triangle + edge, or NOBODY */
    uint32_t mask;       /* of the numbers of places, a power of two of them */
    uint32_t *mate;      /* of each triangle: NOBODY, or 3 * its partner + the edge of that which they share */
} Pairing;

static uint32_t from_of(const Pairing *p, uint32_t announcement)
{
    return p->mesh->triangles[announcement / 3][announcement % 3];
}

static uint32_t to_of(const Pairing *p, uint32_t announcement)
{
    return p->mesh->triangles[announcement / 3][(announcement % 3 + 1) % 3];
}

/* Edges of one kind in a mesh with some order, with the same difference of numbers, have their places in a row. */
static uint32_t place_of(const Pairing *p, uint32_t a, uint32_t b)
{
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    return (2 * low + 0x9e3779b1U * (high - low)) & p->mask;
}

static float half_area(const Mesh *mesh, const uint32_t *vertices, int n)
{
    Vec3f low = mesh->positions[vertices[0]], high = low;
    for (int i = 1; i < n; i++) {
        Vec3f at = mesh->positions[vertices[i]];
        low = (Vec3f){at.x < low.x ? at.x : low.x, at.y < low.y ? at.y : low.y, at.z < low.z ? at.z : low.z};
        high = (Vec3f){at.x > high.x ? at.x : high.x, at.y > high.y ? at.y : high.y, at.z > high.z ? at.z : high.z};
    }
    Vec3f d = vec3f_sub(high, low);
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

/* A hierarchy of boxes takes as long for a pair as for a single triangle, each by how often its box is met. */
static bool fit(const Pairing *p, uint32_t announcement, uint32_t other)
{
    const uint32_t *a = p->mesh->triangles[announcement / 3], *b = p->mesh->triangles[other / 3];
    const uint32_t both[6] = {a[0], a[1], a[2], b[0], b[1], b[2]};
    return half_area(p->mesh, both, 6) <= half_area(p->mesh, a, 3) + half_area(p->mesh, b, 3);
}

/* Pairs the triangle with one that has announced the same edge; else puts the announcement where nothing stands that still
 * counts, if there is such a place nearby. */
static void announce(Pairing *p, uint32_t announcement)
{
    uint32_t from = from_of(p, announcement), to = to_of(p, announcement), first = place_of(p, from, to);
    uint32_t *vacant = NULL;
    for (uint32_t look = 0; look < MOST_LOOKS; look++) {
        uint32_t *place = &p->announced[(first + look) & p->mask], other = *place;
        bool counts = other != NOBODY && p->mate[other / 3] == NOBODY;
        if (!counts && !vacant) vacant = place;
        if (other == NOBODY) break;
        if (!counts || from_of(p, other) != to || to_of(p, other) != from || !fit(p, announcement, other)) continue;
        p->mate[announcement / 3] = other;
        p->mate[other / 3] = announcement;
        return;
    }
    if (vacant) *vacant = announcement;
}

/* The edges of a triangle, the longest first. */
static void edges_by_length(const Mesh *mesh, const uint32_t *triangle, uint32_t order[3])
{
    float square[3];
    for (uint32_t i = 0; i < 3; i++) {
        Vec3f d = vec3f_sub(mesh->positions[triangle[(i + 1) % 3]], mesh->positions[triangle[i]]);
        square[i] = vec3f_dot(d, d);
        uint32_t place = i;
        for (; place > 0 && square[i] > square[order[place - 1]]; place--) order[place] = order[place - 1];
        order[place] = i;
    }
}

static void pair_all(Pairing *p)
{
    const Mesh *mesh = p->mesh;
    for (uint32_t round = 0; round < 3; round++)
        for (uint32_t i = 0; i < mesh->n_triangles; i++) {
            const uint32_t *corners = mesh->triangles[i];
            bool empty = corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
            if (p->mate[i] != NOBODY || empty) continue;
            uint32_t order[3];
            edges_by_length(mesh, corners, order);
            announce(p, 3 * i + order[round]);
        }
}

/* Whether a triangle begins a quad: it is alone, or its partner comes later. */
static bool begins_quad(const Pairing *p, uint32_t triangle)
{
    return p->mate[triangle] == NOBODY || p->mate[triangle] / 3 > triangle;
}

static void quad_of(const Pairing *p, uint32_t triangle, MeshQuad quad)
{
    const uint32_t *corners = p->mesh->triangles[triangle];
    uint32_t mate = p->mate[triangle], shared = mate == NOBODY ? 1 : p->mate[mate / 3] % 3;
    quad[0] = corners[(shared + 2) % 3];
    quad[1] = corners[shared];
    quad[3] = corners[(shared + 1) % 3];
    quad[2] = mate == NOBODY ? quad[3] : p->mesh->triangles[mate / 3][(mate % 3 + 2) % 3];
}

static void pairing_clear(Pairing *p)
{
    free(p->announced);
    free(p->mate);
}

static Status pairing_init(Pairing *p, const Mesh *mesh, Error *error)
{
    size_t n = mesh->n_triangles, places = 16;
    while (places < n + n / 2) places *= 2;
    *p = (Pairing){.mesh = mesh,
                   .announced = malloc(places * sizeof *p->announced),
                   .mask = (uint32_t)(places - 1),
                   .mate = malloc((n + 1) * sizeof *p->mate)};
    if (!p->announced || !p->mate) {
        pairing_clear(p);
        return fail_memory(error, (places + n) * sizeof *p->mate, "the pairs of a mesh's triangles");
    }
    for (size_t i = 0; i < places; i++) p->announced[i] = NOBODY;
    for (size_t i = 0; i < n; i++) p->mate[i] = NOBODY;
    return STATUS_OK;
}

Status mesh_pair_triangles(const Mesh *mesh, MeshQuad **quads, uint32_t *n, Error *error)
{
    enum { MOST_TRIANGLES = 1 << 30 };
    if (mesh->n_triangles > MOST_TRIANGLES)
        return fail(error, STATUS_NOMEM, "a mesh of %lu triangles is too large: %d is the most",
                    (unsigned long)mesh->n_triangles, MOST_TRIANGLES);
    Pairing p;
    TRY(pairing_init(&p, mesh, error));
    pair_all(&p);
    *n = 0;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) *n += begins_quad(&p, i);
    *quads = malloc((*n + (size_t)1) * sizeof **quads);
    if (*quads) {
        uint32_t at = 0;
        for (uint32_t i = 0; i < mesh->n_triangles; i++)
            if (begins_quad(&p, i)) quad_of(&p, i, (*quads)[at++]);
    }
    pairing_clear(&p);
    return *quads ? STATUS_OK : fail_memory(error, *n * sizeof **quads, "the pairs of a mesh's triangles");
}

/* rtc_fixture.h - meshes, solids and random rays for tests of src/geom.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef TEST_RTC_FIXTURE_H
#define TEST_RTC_FIXTURE_H

#include "base/hash.h"
#include "geom/rtc_query.h"
#include "test.h"

/* A box whose faces are cut into n x n squares. */
static inline Mesh *cut_box_mesh(Vec3 from, Vec3 to, uint32_t n)
{
    Mesh *mesh;
    uint32_t n_triangles = 0;
    const uint32_t step[3] = {1, n + 1, (n + 1) * (n + 1)};
    assert_int_equal(mesh_new(step[2] * (n + 1), 12 * n * n, false, false, &mesh, NULL), STATUS_OK);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) /* those within are of no triangle */
        mesh->positions[i] = vec3f((float)(from.x + (to.x - from.x) * (i % (n + 1)) / n),
                                   (float)(from.y + (to.y - from.y) * (i / step[1] % (n + 1)) / n),
                                   (float)(from.z + (to.z - from.z) * (i / step[2]) / n));
    for (uint32_t face = 0; face < 6; face++) {
        uint32_t axis = face / 2, u = step[(axis + 1 + face % 2) % 3], v = step[(axis + 2 - face % 2) % 3];
        for (uint32_t i = 0; i < n * n; i++) {
            uint32_t a = (face % 2 ? 0 : n * step[axis]) + i % n * u + i / n * v;
            memcpy(mesh->triangles[n_triangles++], ((uint32_t[]){a, a + u, a + u + v}), 3 * sizeof(uint32_t));
            memcpy(mesh->triangles[n_triangles++], ((uint32_t[]){a, a + u + v, a + v}), 3 * sizeof(uint32_t));
        }
    }
    return mesh;
}

static inline Mesh *box_mesh(Vec3 from, Vec3 to)
{
    return cut_box_mesh(from, to, 1);
}

/* A profile of radii and heights, turned round about the y axis in n steps; it begins and ends on the axis, and has its
 * inside on the left. */
static inline Mesh *lathe_mesh(const double (*profile)[2], uint32_t n_points, uint32_t n)
{
    Mesh *mesh;
    uint32_t n_triangles = 0, rings = n_points - 2;
    assert_int_equal(mesh_new(2 + rings * n, 2 * rings * n, false, false, &mesh, NULL), STATUS_OK);
    mesh->positions[0] = vec3f(0, (float)profile[0][1], 0);
    mesh->positions[1] = vec3f(0, (float)profile[n_points - 1][1], 0);
    for (uint32_t k = 0; k < rings; k++)
        for (uint32_t i = 0; i < n; i++) {
            double angle = 2 * acos(-1) * i / n, r = profile[k + 1][0];
            mesh->positions[2 + k * n + i] =
                vec3f((float)(r * cos(angle)), (float)profile[k + 1][1], (float)(r * sin(angle)));
        }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t next = (i + 1) % n, last = 2 + (rings - 1) * n;
        memcpy(mesh->triangles[n_triangles++], ((uint32_t[]){0, 2 + i, 2 + next}), 3 * sizeof(uint32_t));
        memcpy(mesh->triangles[n_triangles++], ((uint32_t[]){1, last + next, last + i}), 3 * sizeof(uint32_t));
        for (uint32_t k = 0; k + 1 < rings; k++) {
            uint32_t a = 2 + k * n + i, b = 2 + k * n + next;
            memcpy(mesh->triangles[n_triangles++], ((uint32_t[]){a, a + n, b}), 3 * sizeof(uint32_t));
            memcpy(mesh->triangles[n_triangles++], ((uint32_t[]){b, a + n, b + n}), 3 * sizeof(uint32_t));
        }
    }
    assert_int_equal(n_triangles, mesh->n_triangles);
    return mesh;
}

static inline Affine turned(double degrees, Vec3 axis, Vec3 move)
{
    Vec3 k = vec3_normalize(axis);
    double a = degrees * acos(-1) / 180, c = cos(a), s = sin(a);
    Affine m = {{{c + k.x * k.x * (1 - c), k.x * k.y * (1 - c) - k.z * s, k.x * k.z * (1 - c) + k.y * s},
                 {k.y * k.x * (1 - c) + k.z * s, c + k.y * k.y * (1 - c), k.y * k.z * (1 - c) - k.x * s},
                 {k.z * k.x * (1 - c) - k.y * s, k.z * k.y * (1 - c) + k.x * s, c + k.z * k.z * (1 - c)}},
                move};
    return m;
}

typedef struct TestScene {
    RtcObject objects[64];
    uint32_t n;
    Mesh *meshes[16];
    uint32_t n_meshes;
    Solid *solids[16];
    uint32_t n_solids;
    RtcScene *rtc;
    bool at_edges;              /* the rays are aimed at the edges of triangles */
    uint64_t crossings_a_fault; /* there, at least so many for each contradiction; 0: 500,000 */
    Vec3 up;                    /* not zero: walks start on that side of the origin */
    double from;                /* so far away from it; 0: four times the size of what they are aimed at */
    uint32_t n_keys;
    double time; /* of the rays */
} TestScene;

static inline void add(TestScene *s, const Mesh *mesh, const Solid *solid, Affine to_world)
{
    s->objects[s->n++] = (RtcObject){.mesh = mesh, .solid = solid, .to_world = to_world};
}

static inline Mesh *keep_mesh(TestScene *s, Mesh *mesh)
{
    return s->meshes[s->n_meshes++] = mesh;
}

static inline Solid *keep_solid(TestScene *s, Status status, Solid *solid)
{
    assert_int_equal(status, STATUS_OK);
    return s->solids[s->n_solids++] = solid;
}

static inline Solid *sphere(TestScene *s, double radius)
{
    Solid *solid;
    Status status = solid_make_sphere(radius, &solid, NULL);
    return keep_solid(s, status, solid);
}

static inline void build(TestScene *s)
{
    assert_int_equal(rtc_scene_new(s->objects, s->n, s->n_keys, 1, &s->rtc, NULL), STATUS_OK);
}

static inline void destroy(TestScene *s)
{
    rtc_scene_free(s->rtc);
    for (uint32_t i = 0; i < s->n_meshes; i++) mesh_free(s->meshes[i]);
    for (uint32_t i = 0; i < s->n_solids; i++) solid_free(s->solids[i]);
}

static inline double unit(uint64_t *random)
{
    *random = hash_u64(*random);
    return hash_to_unit(*random);
}

static inline Vec3 random_direction(uint64_t *random)
{
    for (;;) {
        Vec3 v = vec3(2 * unit(random) - 1, 2 * unit(random) - 1, 2 * unit(random) - 1);
        double length = vec3_length(v);
        if (length > 0.05 && length < 1) return vec3_scale(v, 1 / length);
    }
}

static inline Ray ray_through(Vec3 from, Vec3 aim, double time)
{
    Ray ray = ray_make(from, vec3f_from(vec3_normalize(vec3_sub(aim, from))));
    ray.time = time;
    return ray;
}

/* A place beside an edge of one of the scene's triangles, nearer than float can tell. */
static inline Vec3 place_at_edge(const TestScene *s, uint64_t *random)
{
    uint32_t object = (uint32_t)(unit(random) * s->n), k = (uint32_t)(3 * unit(random));
    Vec3 corner[3];
    rtc_triangle(s->rtc, object, (uint32_t)(unit(random) * rtc_n_primitives(s->rtc, object)), 0, corner);
    Vec3 place = vec3_along(corner[k], unit(random), vec3_sub(corner[(k + 1) % 3], corner[k]));
    return vec3_along(place, vec3_max_abs(place) * 0x1p-21, random_direction(random));
}

#endif

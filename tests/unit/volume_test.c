/* volume_test.c - values on a lattice, the walk through their bricks, and grids of NanoVDB files: values that are known,
 * and files that are broken in every way.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include "dice.h"
#include "optics/nanovdb.h"
#include "temporary.h"

enum { MB = 1000000 };

/* ---- lattices ---- */

/* Linear along each axis, so that it is met exactly in between. */
static double linear(double x, double y, double z)
{
    return 1 + 0.25 * x + 0.5 * y + 0.125 * z + 0.03125 * x * y * z;
}

/* Zero but in a corner. */
static double corner(double x, double y, double z)
{
    return x + y + z < 9 ? 9 - x - y - z : 0;
}

typedef double Field(double x, double y, double z);

static Status fill(void *context, const int32_t first[3], float values[VOLUME_BRICK_VALUES], bool *uniform,
                   Error *error)
{
    Field *const *field = context;
    (void)uniform;
    (void)error;
    for (int k = 0; k < VOLUME_EDGE; k++)
        for (int j = 0; j < VOLUME_EDGE; j++)
            for (int i = 0; i < VOLUME_EDGE; i++) *values++ = (float)(*field)(first[0] + i, first[1] + j, first[2] + k);
    return STATUS_OK;
}

static Volume *make(Field *field, int32_t nx, int32_t ny, int32_t nz, float outside)
{
    Volume *volume;
    Error error = {0};
    const int32_t n[3] = {nx, ny, nz};
    if (volume_new(n, fill, &field, outside, MB, "a test", &volume, &error) != STATUS_OK) fail_msg("%s", error.text);
    return volume;
}

static void looks_up(void **state)
{
    (void)state;
    Volume *volume = make(linear, 20, 9, 14, 7);
    Dice dice = {1};
    for (int i = 0; i < 20000; i++) {
        Vec3 p = vec3(19 * dice_unit(&dice), 8 * dice_unit(&dice), 13 * dice_unit(&dice));
        double expected = linear(p.x, p.y, p.z);
        if (fabs((double)volume_at(volume, p) - expected) > 1e-5 * expected) fail_msg("at %g %g %g", p.x, p.y, p.z);
    }
    assert_true(volume_at(volume, vec3(19, 8, 13)) == (float)linear(19, 8, 13));
    assert_true(volume_at(volume, vec3(0, 0, 0)) == 1);
    assert_true(volume_at(volume, vec3(-1e-9, 0, 0)) == 7);
    assert_true(volume_at(volume, vec3(3, 8.001, 3)) == 7);
    assert_true(volume->largest == (float)linear(19, 8, 13));
    volume_scale(volume, 2);
    assert_true(volume_at(volume, vec3(0, 0, 0)) == 2 && volume_at(volume, vec3(-1, 0, 0)) == 14);
    volume_free(volume);
}

/* Bricks that are all zero have no values stored. */
static void stores_little(void **state)
{
    (void)state;
    Volume *volume = make(corner, 65, 65, 65, 0);
    assert_int_equal(volume->n_blocks, 4); /* of 512: where x + y + z < 9, at 8 within brick 1 of each axis */
    volume_free(volume);
}

/* Every line: pieces that join, values within their bounds, the whole of the grid met. */
static void walk_line(const Volume *volume, const Affine *map, Vec3 origin, Vec3 direction, double from)
{
    VolumeWalk walk;
    double t = from, step = 0.37, next = from + step / 2;
    volume_walk_start(&walk, volume, map, origin, direction, from);
    for (int n = 0;; n++) {
        assert_true(n < 1000);
        assert_true(walk.t_end >= t - 1e-9 * (1 + fabs(t)));
        for (; next < walk.t_end && next < from + 60; next += step) {
            Vec3 place = affine_point(map, vec3_along(origin, next, direction));
            float value = volume_walk_value(&walk, next), expected = volume_at(volume, place);
            bool near_side = false; /* where rounding decides */
            const double at[3] = {place.x, place.y, place.z};
            for (int axis = 0; axis < 3; axis++)
                near_side = near_side || fabs(at[axis]) < 1e-6 || fabs(at[axis] - volume->n_points[axis] + 1) < 1e-6;
            if (value < walk.low || value > walk.high) fail_msg("%g is outside of its bounds", (double)value);
            if (!near_side && fabsf(value - expected) > 1e-4f) fail_msg("%g, not %g", (double)value, (double)expected);
            if (walk.inside && walk.low != walk.high)
                assert_true(value >= volume->bricks[walk.brick].low && value <= volume->bricks[walk.brick].high);
        }
        t = walk.t_end;
        if (isinf(t)) break;
        volume_walk_next(&walk);
    }
}

static void walks(void **state)
{
    (void)state;
    Volume *volumes[] = {make(linear, 20, 9, 14, 0.5f), make(corner, 30, 30, 17, 0)};
    Affine map = affine_identity();
    map.m[0][1] = 0.3;
    map.m[2][2] = 2;
    map.t = vec3(1, -2, 3);
    Dice dice = {7};
    for (int i = 0; i < 4000; i++) {
        Vec3 origin = vec3(40 * dice_unit(&dice) - 10, 40 * dice_unit(&dice) - 10, 40 * dice_unit(&dice) - 10);
        Vec3 along = vec3(dice_unit(&dice) - 0.5, dice_unit(&dice) - 0.5, dice_unit(&dice) - 0.5);
        if (i % 4 == 1) along.x = 0;
        if (i % 8 == 3) along.y = along.z = 0;
        if (i % 8 == 5) origin = vec3(8, 8, 16); /* on sides and edges of bricks */
        along = vec3_scale(along, 1 / vec3_length(along));
        walk_line(volumes[i & 1], i % 3 ? &map : &(Affine){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}}, origin, along,
                  i % 5 ? 0 : 3);
    }
    volume_free(volumes[0]);
    volume_free(volumes[1]);
}

static Status refuse(void *context, const int32_t first[3], float values[VOLUME_BRICK_VALUES], bool *uniform,
                     Error *error)
{
    (void)context, (void)first, (void)values, (void)uniform;
    return (fail)(error, STATUS_SCENE, "no");
}

static void refuses_what_is_too_large(void **state)
{
    (void)state;
    Volume *volume;
    Error error;
    Field *field = linear;
    assert_int_equal(volume_new((const int32_t[3]){100, 100, 100}, fill, &field, 0, MB, "a cloud", &volume, &error),
                     STATUS_NOMEM);
    assert_string_equal(error.text, "a cloud needs more than 1 MB of memory, and 1 MB is what a grid may have");
    assert_int_equal(volume_new((const int32_t[3]){INT32_MAX, INT32_MAX, INT32_MAX}, fill, &field, 0, MB, "a cloud",
                                &volume, &error),
                     STATUS_NOMEM);
    assert_int_equal(volume_new((const int32_t[3]){9, 9, 9}, refuse, NULL, 0, MB, "", &volume, &error), STATUS_SCENE);
}

/* ---- NanoVDB ----
 * voxels.nvdb (ZIP) and voxels_blosc.nvdb were written by the format's own library: voxels from (-2, 3, 5) to (9, 8, 12)
 * hold (x + 2 + 2 (y - 3) + 3 (z - 5) + 1) / 64, of size 0.5 and moved by (10, 20, 30). */

static const char *const zipped = "tests/unit/voxels.nvdb", *const bloscked = "tests/unit/voxels_blosc.nvdb";

static double voxel(int x, int y, int z)
{
    bool there = x >= -2 && x <= 9 && y >= 3 && y <= 8 && z >= 5 && z <= 12;
    return there ? (x + 2 + 2 * (y - 3) + 3 * (z - 5) + 1) / 64.0 : 0;
}

static void check_values(const char *path, const char *grid, double tolerance)
{
    Volume *volume;
    Error error = {0};
    if (nanovdb_read(path, grid, 100 * MB, &volume, &error) != STATUS_OK) fail_msg("%s: %s", grid, error.text);
    for (int z = 2; z <= 15; z++)
        for (int y = 0; y <= 11; y++)
            for (int x = -5; x <= 12; x++) {
                Vec3 world = vec3(10 + 0.5 * x, 20 + 0.5 * y, 30 + 0.5 * z);
                double value = (double)volume_at(volume, affine_point(&volume->to_lattice, world));
                if (fabs(value - voxel(x, y, z)) > tolerance)
                    fail_msg("%s at %d %d %d: %g, not %g", grid, x, y, z, value, voxel(x, y, z));
            }
    Vec3 between = affine_point(&volume->to_lattice, vec3(10.25, 22.25, 33.25)); /* voxels 0.5, 4.5, 6.5 */
    assert_true(fabs((double)volume_at(volume, between) - (0.5 + 2 + 3 + 4.5 + 1) / 64.0) <= tolerance);
    volume_free(volume);
}

static void reads_values(void **state)
{
    (void)state;
    check_values(zipped, "density", 0);
    check_values(zipped, "double", 0);
    check_values(zipped, "fp4", 0.04);
    check_values(zipped, "fp8", 0.002);
    check_values(zipped, "fp16", 1e-5);
    check_values(zipped, "fpn", 0.02);
    check_values(bloscked, "density", 0);
    check_values(bloscked, NULL, 0);
}

static void expect_failure(const char *path, const char *grid, const char *text)
{
    Volume *volume;
    Error error = {0};
    Status status = nanovdb_read(path, grid, 100 * MB, &volume, &error);
    if (status == STATUS_OK) volume_free(volume);
    assert_int_not_equal(status, STATUS_OK);
    if (!strstr(error.text, text)) fail_msg("'%s' says nothing of '%s'", error.text, text);
}

static void names_what_is_wrong(void **state)
{
    (void)state;
    expect_failure(
        zipped, "smoke",
        "'tests/unit/voxels.nvdb' has no grid 'smoke'; it has 'density', 'fp4', 'fp8', 'fp16', 'fpn', 'double', "
        "'surface', 'count'");
    expect_failure(zipped, NULL, "has several grids, so name one of them: 'density', 'fp4'");
    expect_failure(zipped, "surface", "grid 'surface' of 'tests/unit/voxels.nvdb' is a level set");
    expect_failure(zipped, "count", "grid 'count' of 'tests/unit/voxels.nvdb' holds no single numbers");
    expect_failure("tests/unit/volume_test.c", NULL, "is no NanoVDB file");
    expect_failure("tests/unit/missing.nvdb", NULL, "missing.nvdb");
    Volume *volume;
    Error error;
    assert_int_equal(nanovdb_read(bloscked, NULL, 200000, &volume, &error), STATUS_NOMEM);
    assert_non_null(strstr(error.text, "takes 1 MB of memory, and 0 MB is what it may have"));
}

/* The grid 'density' of the zipped file as an uncompressed file: *grid is where the grid begins. */
static unsigned char *plain_file(size_t *length, size_t *grid)
{
    char *bytes;
    Error error;
    size_t n;
    assert_int_equal(file_read(zipped, 0, &bytes, &n, &error), STATUS_OK);
    uint64_t grid_bytes, packed;
    uint16_t n_grids;
    memcpy(&n_grids, bytes + 12, 2);
    memcpy(&grid_bytes, bytes + 16, 8);
    size_t at = 16, name = 0;
    for (int i = 0; i < n_grids; i++) {
        uint32_t name_bytes;
        memcpy(&name_bytes, bytes + at + 136, 4);
        at += 176 + name_bytes;
        if (i == 0) name = at;
    }
    memcpy(&packed, bytes + at, 8);
    unsigned char *file = malloc(name + grid_bytes);
    memcpy(file, bytes, name);
    file[12] = 1, file[13] = 0, file[14] = 0, file[15] = 0; /* one grid, no codec */
    memcpy(file + 16 + 8, &grid_bytes, 8);
    uLongf unpacked = (uLongf)grid_bytes;
    assert_int_equal(uncompress(file + name, &unpacked, (const Bytef *)bytes + at + 8, (uLong)packed), Z_OK);
    free(bytes);
    *length = name + grid_bytes;
    *grid = name;
    return file;
}

static Status read_bytes(const unsigned char *bytes, size_t length, Error *error)
{
    Volume *volume;
    write_bytes(in_folder("grid.nvdb"), bytes, length);
    Status status = nanovdb_read(in_folder("grid.nvdb"), NULL, 100 * MB, &volume, error);
    if (status == STATUS_OK) volume_free(volume);
    return status;
}

/* Where a value of the grid lies in the file. */
static unsigned char *find_value(unsigned char *bytes, size_t length, float value)
{
    for (size_t i = length - sizeof value; i > 0; i--)
        if (memcmp(bytes + i, &value, sizeof value) == 0) return bytes + i;
    fail_msg("no value %g", (double)value);
    return NULL;
}

static void refuses_values(void **state)
{
    (void)state;
    size_t length, grid;
    unsigned char *file = plain_file(&length, &grid);
    Error error;
    assert_int_equal(read_bytes(file, length, &error), STATUS_OK);
    unsigned char *place = find_value(file + grid, length - grid, (float)voxel(1, 4, 6));
    const float wrong[] = {NAN, -1, INFINITY};
    const char *const said[] = {"nan at voxel ", "-1 at voxel ", "inf at voxel "};
    for (int i = 0; i < 3; i++) {
        memcpy(place, &wrong[i], sizeof wrong[i]);
        assert_int_equal(read_bytes(file, length, &error), STATUS_INPUT);
        if (!strstr(error.text, said[i])) fail_msg("'%s' does not say '%s'", error.text, said[i]);
    }
    free(file);
}

/* Cut short anywhere: never anything but a message. */
static void refuses_what_is_cut(void **state)
{
    (void)state;
    char *bytes;
    size_t length;
    Error error;
    assert_int_equal(file_read(bloscked, 0, &bytes, &length, &error), STATUS_OK);
    for (size_t n = 1; n < length; n += n < 300 ? 1 : 97)
        assert_int_equal(read_bytes((const unsigned char *)bytes, n, &error), STATUS_INPUT);
    free(bytes);
}

/* Bytes that are anything: a value more or less, or a message, and an end in time. Of the grid mostly those that say
 * where things are. */
static void survives_any_bytes(void **state)
{
    (void)state;
    size_t length, grid;
    unsigned char *file = plain_file(&length, &grid);
    unsigned char *copy = malloc(length);
    Dice dice = {99};
    unsigned n_read = 0;
    for (int i = 0; i < 600; i++) {
        memcpy(copy, file, length);
        size_t reach = i % 3 == 0 ? grid : i % 3 == 1 ? grid + 1000 : length;
        for (int n = 0; n < 1 + i % 4; n++)
            copy[(size_t)(dice_unit(&dice) * (double)reach)] = (unsigned char)dice_below(&dice, 256);
        Error error = {0};
        Status status = read_bytes(copy, length, &error);
        n_read += status == STATUS_OK;
        if (status != STATUS_OK && status != STATUS_INPUT && status != STATUS_NOMEM) fail_msg("status %d", (int)status);
        if (status != STATUS_OK && !error.text[0]) fail_msg("no message");
    }
    assert_true(n_read > 20 && n_read < 590);
    free(copy);
    free(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(looks_up),
        cmocka_unit_test(stores_little),
        cmocka_unit_test(walks),
        cmocka_unit_test(refuses_what_is_too_large),
        cmocka_unit_test(reads_values),
        cmocka_unit_test(names_what_is_wrong),
        cmocka_unit_test(refuses_values),
        cmocka_unit_test(refuses_what_is_cut),
        cmocka_unit_test(survives_any_bytes),
    };
    return cmocka_run_group_tests_name("volume", tests, make_folder, remove_folder);
}

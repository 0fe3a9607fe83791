/* box_pairs_test.c - pairs of boxes against trying them all, for boxes in all manner of arrangements.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "mesh/box_pairs.h"

enum { MOST = 1500 };

typedef struct Boxes {
    Box3 boxes[MOST];
    uint32_t n, n_found;
    uint8_t found[MOST][MOST];
    bool refuses;
} Boxes;

static Box3 box_at(const void *context, uint32_t number)
{
    return ((const Boxes *)context)->boxes[number];
}

static Status note(void *context, uint32_t a, uint32_t b, Error *error)
{
    Boxes *boxes = context;
    assert_true(a < b && b < boxes->n);
    boxes->found[a][b]++;
    boxes->n_found++;
    if (boxes->refuses) error->status = STATUS_RENDER;
    return boxes->refuses ? STATUS_RENDER : STATUS_OK;
}

static bool meet(Box3 a, Box3 b)
{
    Box3 common = box3_intersection(a, b);
    return common.min.x <= common.max.x && common.min.y <= common.max.y && common.min.z <= common.max.z;
}

static void compare_with_all(Boxes *boxes)
{
    Error error;
    memset(boxes->found, 0, sizeof boxes->found);
    boxes->n_found = 0;
    assert_int_equal(box_pairs_visit(boxes->n, box_at, note, boxes, &error), STATUS_OK);
    for (uint32_t a = 0; a < boxes->n; a++)
        for (uint32_t b = a + 1; b < boxes->n; b++)
            assert_int_equal(boxes->found[a][b], meet(boxes->boxes[a], boxes->boxes[b]));
}

/* Within a box of the given size; half of the boxes are points where size_of_each is 0. */
static void scatter(Boxes *boxes, uint32_t n, Vec3 size, double size_of_each)
{
    uint64_t state = n;
    boxes->n = n;
    for (uint32_t i = 0; i < n; i++) {
        double at[6];
        for (int k = 0; k < 6; k++) at[k] = hash_to_unit(state = hash_u64(state));
        Vec3 from = vec3(at[0] * size.x, at[1] * size.y, at[2] * size.z);
        Vec3 each = vec3_scale(vec3(at[3], at[4], at[5]), size_of_each);
        boxes->boxes[i] = (Box3){from, vec3_add(from, each)};
    }
}

static Boxes *boxes;

static void finds_every_pair(void **state)
{
    (void)state;
    for (uint32_t n = 0; n < 40; n++) {
        scatter(boxes, n, vec3(1, 1, 1), 0.5);
        compare_with_all(boxes);
    }
    scatter(boxes, MOST, vec3(1, 1, 1), 0.1);
    compare_with_all(boxes);
    assert_true(boxes->n_found > MOST / 2);
}

static void finds_them_in_lines_and_planes(void **state)
{
    (void)state;
    for (int axis = 0; axis < 6; axis++) {
        Vec3 size = vec3(axis % 3 == 0, axis % 3 == 1, axis % 3 == 2);
        scatter(boxes, 500, axis < 3 ? size : vec3_sub(vec3(1, 1, 1), size), 0.02);
        compare_with_all(boxes);
    }
}

static void takes_equal_empty_and_far_ones(void **state)
{
    (void)state;
    scatter(boxes, 200, vec3(0, 0, 0), 0);
    compare_with_all(boxes);
    assert_int_equal(boxes->n_found, 200 * 199 / 2);
    scatter(boxes, 300, vec3(1e-6, 1e-6, 1e-6), 1e-7);
    boxes->boxes[7] = box3_empty();
    boxes->boxes[50] = (Box3){vec3(1e15, 1e15, 1e15), vec3(1e15, 1e15, 1e15)};
    boxes->boxes[90] = (Box3){vec3(-1e15, -1, -1), vec3(1e15, 1, 1)};
    compare_with_all(boxes);
}

/* Tests of boxes, not time: a grid in a plane of which each box meets only its neighbours. */
typedef struct Count {
    uint32_t n_side, n_pairs;
    uint64_t n_asked;
} Count;

static Box3 square_at(const void *context, uint32_t number)
{
    Count *count = *(Count *const *)context;
    count->n_asked++;
    double x = number % count->n_side, y = number / count->n_side;
    return (Box3){vec3(x, y, 0), vec3(x + 0.9, y + 0.9, 0)};
}

static Status count_pair(void *context, uint32_t a, uint32_t b, Error *error)
{
    (void)a;
    (void)b;
    (void)error;
    (*(Count **)context)->n_pairs++;
    return STATUS_OK;
}

static void work_grows_with_the_boxes(void **state)
{
    (void)state;
    Error error;
    double asked[2];
    for (uint32_t i = 0; i < 2; i++) {
        Count count = {.n_side = i ? 400 : 100}, *pointer = &count;
        uint32_t n = count.n_side * count.n_side;
        assert_int_equal(box_pairs_visit(n, square_at, count_pair, &pointer, &error), STATUS_OK);
        assert_int_equal(count.n_pairs, 0);
        asked[i] = (double)count.n_asked / n;
    }
    assert_true(asked[1] < 1.5 * asked[0]);
}

static void stops_when_told(void **state)
{
    (void)state;
    Error error;
    scatter(boxes, 100, vec3(1, 1, 1), 1);
    boxes->n_found = 0;
    boxes->refuses = true;
    assert_int_equal(box_pairs_visit(boxes->n, box_at, note, boxes, &error), STATUS_RENDER);
    assert_int_equal(boxes->n_found, 1);
    boxes->refuses = false;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_every_pair),
        cmocka_unit_test(finds_them_in_lines_and_planes),
        cmocka_unit_test(takes_equal_empty_and_far_ones),
        cmocka_unit_test(work_grows_with_the_boxes),
        cmocka_unit_test(stops_when_told),
    };
    boxes = calloc(1, sizeof *boxes);
    if (!boxes) return 1;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    free(boxes);
    return failed;
}

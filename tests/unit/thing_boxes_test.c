/* thing_boxes_test.c - boxes of many things, against arrays.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/hash.h"
#include "render/thing_boxes.h"

enum { THINGS = 1000, PIXELS = 20000 };

/* Things have numbers from all over the range, and 0 among them. */
static uint32_t number_of(uint32_t i)
{
    return i == 0 ? 0 : i == 1 ? UINT32_MAX : hash_u32(i);
}

static void boxes_hold_what_was_added(void **state)
{
    (void)state;
    ThingBoxes boxes = {0};
    static ThingBox expected[THINGS];
    assert_null(thing_boxes_find(&boxes, 0));
    for (uint32_t k = 0; k < PIXELS; k++) {
        uint32_t i = hash_combine(1, k) % THINGS, x = hash_combine(2, k) % 500, y = hash_combine(3, k) % 300;
        ThingBox *box = &expected[i];
        if (!box->x1) *box = (ThingBox){number_of(i), x, y, x + 1, y + 1};
        box->x0 = x < box->x0 ? x : box->x0;
        box->y0 = y < box->y0 ? y : box->y0;
        box->x1 = x >= box->x1 ? x + 1 : box->x1;
        box->y1 = y >= box->y1 ? y + 1 : box->y1;
        assert_true(thing_boxes_add(&boxes, number_of(i), x, y));
    }
    for (uint32_t i = 0; i < THINGS; i++) {
        const ThingBox *found = thing_boxes_find(&boxes, number_of(i));
        assert_true((found != NULL) == (expected[i].x1 > 0));
        if (found) assert_memory_equal(found, &expected[i], sizeof *found);
    }
    assert_null(thing_boxes_find(&boxes, number_of(THINGS)));
    thing_boxes_clear(&boxes);
    assert_null(thing_boxes_find(&boxes, number_of(2)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(boxes_hold_what_was_added)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

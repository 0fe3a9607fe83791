/* thing_boxes.c - a hash table with places in a row (linear probing), doubled when it is half full.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/thing_boxes.h"

#include <stdlib.h>

#include "base/hash.h"

enum { FIRST_PLACES = 64 };

/* That of the thing, or the free one where it would be. */
static ThingBox *place_of(const ThingBoxes *boxes, uint32_t thing)
{
    size_t i = hash_u32(thing) & (boxes->capacity - 1);
    while (boxes->places[i].x1 && boxes->places[i].thing != thing) i = (i + 1) & (boxes->capacity - 1);
    return &boxes->places[i];
}

static bool make_room(ThingBoxes *boxes)
{
    ThingBoxes larger = {.n = boxes->n, .capacity = boxes->capacity ? 2 * boxes->capacity : FIRST_PLACES};
    if (2 * (boxes->n + 1) <= boxes->capacity) return true;
    larger.places = calloc(larger.capacity, sizeof *larger.places);
    if (!larger.places) return false;
    for (size_t i = 0; i < boxes->capacity; i++)
        if (boxes->places[i].x1) *place_of(&larger, boxes->places[i].thing) = boxes->places[i];
    free(boxes->places);
    *boxes = larger;
    return true;
}

bool thing_boxes_add(ThingBoxes *boxes, uint32_t thing, uint32_t x, uint32_t y)
{
    if (!make_room(boxes)) return false;
    ThingBox *box = place_of(boxes, thing);
    if (!box->x1) {
        *box = (ThingBox){thing, x, y, x + 1, y + 1};
        boxes->n++;
    }
    if (x < box->x0) box->x0 = x;
    if (y < box->y0) box->y0 = y;
    if (x >= box->x1) box->x1 = x + 1;
    if (y >= box->y1) box->y1 = y + 1;
    return true;
}

const ThingBox *thing_boxes_find(const ThingBoxes *boxes, uint32_t thing)
{
    const ThingBox *box = boxes->n ? place_of(boxes, thing) : NULL;
    return box && box->x1 ? box : NULL;
}

void thing_boxes_clear(ThingBoxes *boxes)
{
    free(boxes->places);
    *boxes = (ThingBoxes){0};
}

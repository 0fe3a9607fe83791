/* thing_boxes.h - where in a picture each thing is seen: in no pixel outside of its box.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_THING_BOXES_H
#define MEN_THING_BOXES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/attr.h"

/* Pixels from x0, y0 up to but without x1, y1. */
typedef struct ThingBox {
    uint32_t thing, x0, y0, x1, y1; /* x1 == 0: a free place of the table */
} ThingBox;

typedef struct ThingBoxes {
    ThingBox *places; /* a hash table, of which at most half is in use */
    size_t n, capacity;
} ThingBoxes;

/* One more pixel in which the thing is seen. false when memory ends. */
bool thing_boxes_add(ThingBoxes *boxes, uint32_t thing, uint32_t x, uint32_t y) ATTR_NODISCARD;
/* NULL: it is not seen. Good until the next one is added. */
const ThingBox *thing_boxes_find(const ThingBoxes *boxes, uint32_t thing);
void thing_boxes_clear(ThingBoxes *boxes);

#endif

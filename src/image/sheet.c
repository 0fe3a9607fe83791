/* sheet.c - how a contact sheet is laid out.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/sheet.h"

#include <string.h>

#include "image/font.h"

enum { LONGEST = 256 }; /* of a caption, in bytes: what is longer is cut there */
static const float paper = 0.16f, ink[3] = {0.8f, 0.8f, 0.8f};
static const double wanted_shape = 1.5; /* of a sheet, its width over its height */

/* Where things are, in pixels. */
typedef struct Layout {
    uint32_t columns, rows;
    uint32_t width, height; /* of each picture's place, */
    uint32_t gap, caption;  /* what is around it, and below it for its words */
    unsigned scale;         /* of the letters */
} Layout;

static double width_of(const Layout *at)
{
    return at->gap + (double)at->columns * (at->width + at->gap);
}

static double height_of(const Layout *at)
{
    return at->gap + (double)at->rows * (at->height + at->caption + at->gap);
}

static void divide(Layout *at, size_t n, uint32_t columns)
{
    at->columns = columns;
    at->rows = (uint32_t)((n + columns - 1) / columns);
}

static Layout lay_out(const SheetPicture *pictures, size_t n, uint32_t columns)
{
    Layout at = {0};
    for (size_t i = 0; i < n; i++) {
        if (pictures[i].image.width > at.width) at.width = pictures[i].image.width;
        if (pictures[i].image.height > at.height) at.height = pictures[i].image.height;
    }
    at.scale = 1 + at.width / 480;
    at.gap = 4 + at.width / 60;
    at.caption = (FONT_HEIGHT + 4) * at.scale;
    if (columns) {
        divide(&at, n, columns < n ? columns : (uint32_t)n);
        return at;
    }
    double nearest = HUGE_VAL;
    Layout best = at;
    for (uint32_t k = 1; k <= n; k++) {
        divide(&at, n, k);
        double off = fabs(log(width_of(&at) / height_of(&at) / wanted_shape));
        if (off >= nearest) continue;
        nearest = off;
        best = at;
    }
    return best;
}

static void put_picture(const Image *picture, Image *sheet, uint32_t left, uint32_t top)
{
    const int alpha = image_channel(picture, "A");
    for (uint32_t y = 0; y < picture->height; y++)
        for (uint32_t x = 0; x < picture->width; x++) {
            const float *from = image_at(picture, x, y);
            float *to = image_at(sheet, left + x, top + y), part = alpha < 0 ? 1 : from[alpha];
            for (int c = 0; c < 3; c++) to[c] = part * from[c] + (1 - part) * to[c];
        }
}

/* In the middle below a picture's place, as much of it as has room. */
static void put_caption(const char *caption, const Layout *at, Image *sheet, uint32_t left, uint32_t top)
{
    char text[LONGEST + 3];
    size_t length = strlen(caption);
    if (length > LONGEST) length = LONGEST;
    memcpy(text, caption, length);
    text[length] = 0;
    while (length > 0 && font_width(text, at->scale) > at->width) {
        do length--;
        while (length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80); /* within a character of UTF-8 */
        memcpy(text + length, "..", 3);
    }
    uint32_t width = font_width(text, at->scale);
    font_draw(sheet, left + (width < at->width ? (at->width - width) / 2 : 0), top + 3 * at->scale, at->scale, text,
              ink);
}

Status sheet_new(const SheetPicture *pictures, size_t n, uint32_t columns, Image *sheet, Error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    const double most = 65536;
    *sheet = (Image){0};
    Layout at = lay_out(pictures, n, columns);
    if (width_of(&at) > most || height_of(&at) > most)
        return fail(error, STATUS_INPUT,
                    "a sheet of %u by %u pictures would have %.0f by %.0f pixels, more than %.0f on a side", at.columns,
                    at.rows, width_of(&at), height_of(&at), most);
    TRY(image_new((uint32_t)width_of(&at), (uint32_t)height_of(&at), names, 3, sheet, error));
    for (size_t i = 0; i < (size_t)sheet->width * sheet->height * 3; i++) sheet->pixels[i] = paper;
    for (size_t i = 0; i < n; i++) {
        const Image *picture = &pictures[i].image;
        uint32_t column = (uint32_t)(i % at.columns), row = (uint32_t)(i / at.columns);
        uint32_t left = at.gap + column * (at.width + at.gap), top = at.gap + row * (at.height + at.caption + at.gap);
        top += (at.height - picture->height) / 2;
        put_picture(picture, sheet, left + (at.width - picture->width) / 2, top);
        put_caption(pictures[i].caption, &at, sheet, left, top + picture->height);
    }
    return STATUS_OK;
}

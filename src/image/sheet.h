/* sheet.h - pictures beside each other, with a word below each: a contact sheet.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SHEET_H
#define MEN_SHEET_H

#include "image/image.h"

typedef struct SheetPicture {
    Image image;         /* as a display shows it: R, G, B, and maybe A, in 0..1 */
    const char *caption; /* UTF-8; what is wider than the picture's place ends in ".." */
} SheetPicture;

/* The pictures in rows of so many, in the middle of places that are all as large as the largest of them; columns 0: as many as make the
 * sheet's shape most like 3 to 2. What is transparent lies over the sheet's own grey. R, G, B. STATUS_NOMEM, and STATUS_INPUT where the
 * sheet would be larger than pictures are. */
ATTR_NODISCARD Status sheet_new(const SheetPicture *pictures, size_t n, uint32_t columns, Image *sheet, Error *error);

#endif

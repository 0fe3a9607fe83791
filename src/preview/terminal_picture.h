/* terminal_picture.h - a picture as text for a terminal: in its own graphics where it has any, else in characters.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TERMINAL_PICTURE_H
#define MEN_TERMINAL_PICTURE_H

#include "base/buf.h"
#include "image/image.h"

/* TERMINAL_BEST: what the terminal is known to understand. */
typedef enum TerminalGraphics {
    TERMINAL_BEST,
    TERMINAL_SYMBOLS, /* characters that fill parts of their cell, in two colours */
    TERMINAL_SIXEL,
    TERMINAL_KITTY,
    TERMINAL_ITERM2
} TerminalGraphics;

typedef struct TerminalSize {
    unsigned columns, rows;           /* that the picture may take */
    unsigned cell_width, cell_height; /* of a character, in pixels; 0: not known */
} TerminalSize;

/* false: there is no graphics of that name */
bool terminal_graphics_from_text(const char *text, TerminalGraphics *graphics);

typedef struct TerminalPicture {
    Buf text;      /* empty before; cleared by the caller, in any case */
    unsigned rows; /* lines that it covers */
    bool
        is_graphics; /* it begins at the cursor, which may end anywhere; else each line but the last ends with a line break */
} TerminalPicture;
/* A picture (RGB, as a display shows it, 0..1), as large as it may be and in its proportions. environment: of the process
 * ("TERM=xterm"). STATUS_NOMEM. */
ATTR_NODISCARD Status terminal_picture_draw(const Image *shown, const TerminalSize *size, TerminalGraphics graphics,
                                            char **environment, TerminalPicture *picture, Error *error);

#endif

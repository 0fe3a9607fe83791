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

/* Adds the picture (RGB, as a display shows it, 0..1) to *text, as large as it may be and in its proportions; *rows is the number
 * of lines that it covers. Where the terminal has graphics the picture begins at the cursor, which may end anywhere; where it has
 * not each line but the last one ends with a line break. environment: of the process ("TERM=xterm"). STATUS_NOMEM. */
ATTR_NODISCARD Status terminal_picture_draw(const Image *shown, const TerminalSize *size, TerminalGraphics graphics,
                                            char **environment, Buf *text, unsigned *rows, bool *is_graphics,
                                            Error *error);

#endif

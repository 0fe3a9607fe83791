/* terminal_preview.h - a picture in the terminal on standard error, drawn again in its place.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TERMINAL_PREVIEW_H
#define MEN_TERMINAL_PREVIEW_H

#include "preview/terminal_picture.h"

typedef struct TerminalPreview {
    TerminalGraphics graphics;
    unsigned rows;  /* that the picture covers, above the line of the cursor; 0: none was drawn yet */
    uint64_t lines; /* that had been said when it was drawn: whatever is said then moves it */
} TerminalPreview;

/* STATUS_USAGE where standard error is no terminal that can move its cursor. */
ATTR_NODISCARD Status terminal_preview_check(Error *error);
/* shown: RGB, as a display shows it. The cursor is on the line below it then. STATUS_NOMEM. */
ATTR_NODISCARD Status terminal_preview_show(TerminalPreview *preview, const Image *shown, Error *error);

#endif

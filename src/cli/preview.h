/* preview.h - where pictures are shown while they are made: a file that a viewer watches, the terminal, or tev.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PREVIEW_H
#define MEN_PREVIEW_H

#include "cli/output.h"
#include "cli/terminal_preview.h"
#include "preview/tev.h"

typedef enum PreviewKind { PREVIEW_NONE, PREVIEW_FILE, PREVIEW_TERMINAL, PREVIEW_TEV } PreviewKind;

typedef struct Preview {
    PreviewKind kind;
    Output file; /* path NULL: none */
    TerminalPreview terminal;
    Tev *tev;
} Preview;

/* Reads what --preview says, NULL for nothing, and tries it: the file, the terminal, the connection. name: of the picture in tev.
 * STATUS_USAGE, STATUS_OUTPUT. preview_close is due in every case. */
ATTR_NODISCARD Status preview_open(const char *where, const char *name, Preview *preview, Error *error);
void preview_close(Preview *preview);
/* Does it show pictures as a display does? */
bool preview_is_for_display(const Preview *preview);
/* color, look: as of output_write; tev gets the light as it is. */
ATTR_NODISCARD Status preview_show(Preview *preview, const Image *image, Pool *pool, const ColorConfig *color,
                                   const ColorLook *look, Error *error);

#endif

/* output.h - the files that a render writes: their names, whether they can be written, and the writing.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_OUTPUT_H
#define MEN_OUTPUT_H

#include "cli/scene_input.h"
#include "image/image.h"

typedef struct Output {
    char *path; /* "-": standard output */
    bool png;
} Output;

typedef struct OutputList {
    Output *items;
    size_t n;
    bool has_png;
} OutputList;

/* From -o, else the scene's film, else the scene's name; frame replaces rows of '#'. STATUS_USAGE where a name
 * cannot be (unknown extension, twice the same, a picture to a terminal). outputs_clear is due in every case. */
ATTR_NODISCARD Status outputs_collect(OutputList *list, const Options *options, const Scene *scene, unsigned frame,
                                      Error *error);
void outputs_clear(OutputList *list);
/* Tries each one as writing it will, and leaves no trace. STATUS_OUTPUT. */
ATTR_NODISCARD Status outputs_probe(const OutputList *list, Error *error);
/* The same for one path, also of other files than pictures. */
ATTR_NODISCARD Status output_probe(const char *path, Error *error);
/* color is NULL when no output is a PNG file. display, view: NULL for the defaults. */
ATTR_NODISCARD Status output_write(const Output *output, const Image *image, const ExrOptions *exr,
                                   const ColorConfig *color, const char *display, const char *view, Error *error);
/* The colours of an image under a display and view, as RGB for a PNG file. factor brightens before. */
ATTR_NODISCARD Status image_for_display(const Image *image, double factor, const ColorConfig *color, const char *display,
                                        const char *view, Image *shown, Error *error);

#endif

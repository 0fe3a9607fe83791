/* glyphs.h - text as outlines, by the glyphs of a font file; and where fonts are kept.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GLYPHS_H
#define MEN_GLYPHS_H

#include "shape/polygon.h"

/* The file of that name ("DejaVuSans", "DejaVuSans.ttf") in the system's folders for fonts, which are walked in the
 * order of names; *path is malloc'd, NULL when there is none. */
ATTR_NODISCARD Status font_find(const char *name, char **path, Error *error);
/* The folders, for messages. */
const char *font_folders(void);

typedef enum GlyphAlign { ALIGN_LEFT, ALIGN_CENTER, ALIGN_RIGHT } GlyphAlign;

typedef struct GlyphText {
    const char *text;      /* UTF-8; '\n' ends a line */
    const char *font;      /* the path of a TrueType, OpenType or Type 1 file with outlines */
    double size;           /* of the font's em */
    double letter_spacing; /* added between glyphs */
    double line_spacing;   /* a factor of the font's own distance of lines */
    GlyphAlign align;
    double tolerance; /* how far chords may be from the curves */
} GlyphText;

enum { GLYPHS_MAX = 100000 };

/* Draws into a clean outline (polygon_clean): the first line's baseline begins, has its middle, or ends at <0, 0>.
 * Pairs are kerned where the font has a table of them. Whatever overlaps is united. STATUS_SCENE for a glyph that the
 * font does not have, text that is no UTF-8 or shows nothing; STATUS_INPUT for a font that cannot be used. */
ATTR_NODISCARD Status glyphs_draw(const GlyphText *text, Outline2 *outline, Error *error);

#endif

/* glyphs.c - text as outlines; the only file that includes FreeType.
 * Glyphs are taken as the font has them, without fitting to pixels.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/glyphs.h"

#include <stdlib.h>
#include <string.h>

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_ADVANCES_H
#include FT_OUTLINE_H

#include "base/file.h"
#include "base/utf8.h"
#include "shape/contour.h"

typedef struct Writer {
    const GlyphText *text;
    FT_Face face;
    Pen pen;
    double scale, x, y; /* from font units to lengths; where the glyph's origin is */
    bool open;          /* a loop was begun */
} Writer;

/* ---- the outline of a glyph ---- */

static Point2 place(const Writer *writer, const FT_Vector *v)
{
    return (Point2){writer->x + writer->scale * (double)v->x, writer->y + writer->scale * (double)v->y};
}

static void end_loop(Writer *writer)
{
    if (writer->open) pen_end(&writer->pen);
    writer->open = false;
}

static int move_to(const FT_Vector *to, void *context)
{
    Writer *writer = context;
    end_loop(writer);
    pen_begin(&writer->pen, place(writer, to));
    writer->open = true;
    return writer->pen.failed;
}

static int line_to(const FT_Vector *to, void *context)
{
    Writer *writer = context;
    pen_line(&writer->pen, place(writer, to));
    return writer->pen.failed;
}

/* A parabola is a cubic whose controls are two thirds of the way to its own. */
static int conic_to(const FT_Vector *control, const FT_Vector *to, void *context)
{
    Writer *writer = context;
    Point2 from = writer->pen.at, c = place(writer, control), end = place(writer, to);
    Point2 first = {from.x + (c.x - from.x) * 2 / 3, from.y + (c.y - from.y) * 2 / 3};
    Point2 second = {end.x + (c.x - end.x) * 2 / 3, end.y + (c.y - end.y) * 2 / 3};
    pen_cubic(&writer->pen, first, second, end);
    return writer->pen.failed;
}

static int cubic_to(const FT_Vector *control1, const FT_Vector *control2, const FT_Vector *to, void *context)
{
    Writer *writer = context;
    pen_cubic(&writer->pen, place(writer, control1), place(writer, control2), place(writer, to));
    return writer->pen.failed;
}

static Status draw_glyph(Writer *writer, FT_UInt glyph, Error *error)
{
    static const FT_Outline_Funcs functions = {move_to, line_to, conic_to, cubic_to, 0, 0};
    if (FT_Load_Glyph(writer->face, glyph, FT_LOAD_NO_SCALE) || writer->face->glyph->format != FT_GLYPH_FORMAT_OUTLINE)
        return fail(error, STATUS_INPUT, "the font '%s' has a glyph that is damaged or has no outline",
                    writer->text->font);
    FT_Error failed = FT_Outline_Decompose(&writer->face->glyph->outline, &functions, writer);
    end_loop(writer);
    if (writer->pen.failed)
        return writer->pen.outline->n_points < POLYGON_MAX_POINTS
                   ? fail_memory(error, 0, "a text")
                   : fail(error, STATUS_SCENE, "the text has more than %d points; make its tolerance larger",
                          POLYGON_MAX_POINTS);
    if (failed) return fail(error, STATUS_INPUT, "the font '%s' has a damaged outline", writer->text->font);
    return STATUS_OK;
}

/* ---- lines ---- */

/* One line, from x on, or only measured; *width is that of its advances. */
static Status write_line(Writer *writer, const char *line, size_t length, bool draw, double *width, Error *error)
{
    FT_UInt before = 0;
    double x = 0;
    for (size_t i = 0; i < length;) {
        uint32_t code;
        size_t n = utf8_decode(line + i, length - i, &code);
        if (code == UTF8_INVALID) return fail(error, STATUS_SCENE, "the text is not UTF-8");
        FT_UInt glyph = FT_Get_Char_Index(writer->face, code);
        if (!glyph)
            return fail(error, STATUS_SCENE, "the font '%s' has no glyph for '%.*s' (U+%04X)", writer->text->font,
                        (int)n, line + i, (unsigned)code);
        FT_Vector kerning = {0, 0};
        if (before && FT_HAS_KERNING(writer->face))
            if (FT_Get_Kerning(writer->face, before, glyph, FT_KERNING_UNSCALED, &kerning)) kerning.x = 0;
        if (i) x += writer->text->letter_spacing + writer->scale * (double)kerning.x;
        double start = writer->x;
        writer->x += x;
        Status status = draw ? draw_glyph(writer, glyph, error) : STATUS_OK;
        writer->x = start;
        if (status != STATUS_OK) return status;
        FT_Fixed advance;
        if (FT_Get_Advance(writer->face, glyph, FT_LOAD_NO_SCALE, &advance))
            return fail(error, STATUS_INPUT, "the font '%s' has a damaged glyph", writer->text->font);
        x += writer->scale * (double)advance;
        before = glyph;
        i += n;
    }
    *width = x;
    return STATUS_OK;
}

static Status write_lines(Writer *writer, Error *error)
{
    const GlyphText *text = writer->text;
    double distance = text->line_spacing * writer->scale * (double)writer->face->height;
    if (strlen(text->text) > GLYPHS_MAX)
        return fail(error, STATUS_SCENE, "a text of %zu bytes is too long; the limit is %d", strlen(text->text),
                    GLYPHS_MAX);
    for (const char *line = text->text; line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL) {
        size_t length = strcspn(line, "\n");
        double width = 0, ignored;
        TRY(write_line(writer, line, length, false, &width, error));
        writer->x = text->align == ALIGN_LEFT ? 0 : text->align == ALIGN_RIGHT ? -width : -0.5 * width;
        TRY(write_line(writer, line, length, true, &ignored, error));
        writer->y -= distance;
    }
    return STATUS_OK;
}

static Status use_face(Writer *writer, Error *error)
{
    if (!FT_IS_SCALABLE(writer->face) || !writer->face->units_per_EM)
        return fail(error, STATUS_INPUT, "the font '%s' has no outlines", writer->text->font);
    writer->scale = writer->text->size / writer->face->units_per_EM;
    TRY(write_lines(writer, error));
    TRY(polygon_clean(writer->pen.outline, FILL_NONZERO, error));
    if (writer->pen.outline->n_points == 0) return fail(error, STATUS_SCENE, "the text shows nothing");
    return STATUS_OK;
}

Status glyphs_draw(const GlyphText *text, Outline2 *outline, Error *error)
{
    Writer writer = {.text = text, .pen = {.outline = outline, .tolerance = text->tolerance, .smooth_degrees = 3}};
    FT_Library library;
    char *font; /* as long as the library is there */
    size_t length;
    TRY(file_read(text->font, 0, &font, &length, error));
    if (FT_Init_FreeType(&library)) {
        free(font);
        return fail(error, STATUS_NOMEM, "FreeType cannot be started");
    }
    FT_Error failed = FT_New_Memory_Face(library, (const FT_Byte *)font, (FT_Long)length, 0, &writer.face);
    Status status;
    if (failed == FT_Err_Out_Of_Memory)
        status = fail_memory(error, 0, "a font");
    else if (failed)
        status = fail(error, STATUS_INPUT, "'%s' is no font that can be read", text->font);
    else
        status = use_face(&writer, error);
    FT_Done_FreeType(library); /* and its faces */
    free(font);
    return status;
}

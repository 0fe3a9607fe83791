/* build_text.c - text as solids.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "shape/glyphs.h"
#include "shape/meshed.h"
#include "scene/build_parts.h"

static const char default_font[] = "DejaVuSans.ttf";

/* The path of the font, which is the arena's; NULL after reporting. A file of the scene's comes before the system's. */
static const char *find_font(Builder *b, const EvalNode *node)
{
    const EvalProp *font = eval_prop(node, "font");
    const char *name = font ? font->as.text : default_font;
    const char *path = font ? eval_seek_file(&b->eval_options, b->diag, font->span, name) : NULL;
    if (path) {
        build_note_file(b, path);
        return path;
    }
    char *found;
    Error error;
    Status status = font_find(name, &found, &error);
    if (!build_succeeded(b, status, &error, node->span)) return NULL;
    if (found) {
        path = arena_copy_text(b->arena, found, strlen(found));
        free(found);
        return path;
    }
    Diagnostic *report = diag_report(b->diag, D_FILE_NOT_FOUND, font ? font->span : node->span, "no font '%s'", name);
    diag_hint(
        b->diag, report,
        font ? "without a font it is DejaVuSans; fonts are sought like other files, and by the names of their files "
               "under %s"
             : "name one that there is under %s: font = \"...\", or install the package fonts-dejavu-core",
        font_folders());
    return NULL;
}

static Status make_text(Builder *b, const EvalNode *node, Mesh **mesh, Span *span, Error *error)
{
    const char *align = eval_word(node, "align");
    const EvalProp *depth = eval_prop(node, "depth"), *tolerance = eval_prop(node, "tolerance");
    double size = eval_number(node, "size");
    GlyphText text = {.text = eval_word(node, "text"),
                      .font = find_font(b, node),
                      .size = size,
                      .letter_spacing = eval_number(node, "letter_spacing"),
                      .line_spacing = eval_number(node, "line_spacing"),
                      .align = strcmp(align, "right") == 0    ? ALIGN_RIGHT
                               : strcmp(align, "center") == 0 ? ALIGN_CENTER
                                                              : ALIGN_LEFT,
                      .tolerance = tolerance ? tolerance->as.number : size / 2000};
    PrismShape shape = {.from = depth ? -depth->as.number : -size / 5,
                        .to = 0,
                        .scale_from = 1,
                        .scale_to = 1,
                        .bevel = eval_number(node, "bevel"),
                        .bevel_segments = (unsigned)eval_number(node, "bevel_segments")};
    if (!text.font) return STATUS_SCENE; /* reported */
    Outline2 outline = {0};
    Grower grower = {0};
    Status status = glyphs_draw(&text, &outline, error);
    *span = build_span(node, status == STATUS_INPUT ? "font" : "text");
    if (status == STATUS_OK) {
        *span = build_span(node, shape.bevel > 0 ? "bevel" : "text");
        status = prism_add(&grower, &outline, &shape, error);
    }
    if (status == STATUS_OK) status = grower_finish(&grower, "the text", mesh, error);
    grower_clear(&grower);
    outline2_clear(&outline);
    return status == STATUS_INPUT ? STATUS_SCENE : status;
}

void build_text(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_needs_other(b, node, "bevel_segments", "bevel", "without a bevel");
    const char *font = find_font(b, node);
    if (font) build_made(b, node, to_world, make_text, font, strlen(font));
}

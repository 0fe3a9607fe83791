/* terminal_picture.c - by Chafa, which knows the terminals; the only file that includes it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "preview/terminal_picture.h"

#include <chafa.h>
#include <math.h>
#include <string.h>

/* of characters, where a terminal does not say */
enum { USUAL_CELL_WIDTH = 8, USUAL_CELL_HEIGHT = 16 };

bool terminal_graphics_from_text(const char *text, TerminalGraphics *graphics)
{
    static const char *const names[] = {[TERMINAL_SYMBOLS] = "symbols",
                                        [TERMINAL_SIXEL] = "sixel",
                                        [TERMINAL_KITTY] = "kitty",
                                        [TERMINAL_ITERM2] = "iterm2"};
    for (size_t i = TERMINAL_SYMBOLS; i < sizeof names / sizeof *names; i++)
        if (strcmp(text, names[i]) == 0) {
            *graphics = (TerminalGraphics)i;
            return true;
        }
    return false;
}

static ChafaPixelMode best_mode(const ChafaTermInfo *info)
{
    if (chafa_term_info_have_seq(info, CHAFA_TERM_SEQ_BEGIN_KITTY_IMMEDIATE_IMAGE_V1)) return CHAFA_PIXEL_MODE_KITTY;
    if (chafa_term_info_have_seq(info, CHAFA_TERM_SEQ_BEGIN_ITERM2_IMAGE)) return CHAFA_PIXEL_MODE_ITERM2;
    if (chafa_term_info_have_seq(info, CHAFA_TERM_SEQ_BEGIN_SIXELS)) return CHAFA_PIXEL_MODE_SIXELS;
    return CHAFA_PIXEL_MODE_SYMBOLS;
}

static ChafaPixelMode mode_of(TerminalGraphics graphics, const ChafaTermInfo *info)
{
    switch (graphics) {
    case TERMINAL_BEST: break;
    case TERMINAL_SYMBOLS: return CHAFA_PIXEL_MODE_SYMBOLS;
    case TERMINAL_SIXEL: return CHAFA_PIXEL_MODE_SIXELS;
    case TERMINAL_KITTY: return CHAFA_PIXEL_MODE_KITTY;
    case TERMINAL_ITERM2: return CHAFA_PIXEL_MODE_ITERM2;
    }
    return best_mode(info);
}

static ChafaCanvasMode colors_of(const ChafaTermInfo *info)
{
    if (chafa_term_info_have_seq(info, CHAFA_TERM_SEQ_SET_COLOR_FGBG_DIRECT)) return CHAFA_CANVAS_MODE_TRUECOLOR;
    if (chafa_term_info_have_seq(info, CHAFA_TERM_SEQ_SET_COLOR_FGBG_256)) return CHAFA_CANVAS_MODE_INDEXED_240;
    if (chafa_term_info_have_seq(info, CHAFA_TERM_SEQ_SET_COLOR_FGBG_16)) return CHAFA_CANVAS_MODE_INDEXED_16;
    return CHAFA_CANVAS_MODE_FGBG;
}

typedef struct Cells {
    unsigned columns, rows, width, height; /* width, height: of one, in pixels */
} Cells;

/* As large as there is room for; no larger than the picture where its pixels are shown as such. */
static Cells fit(const Image *shown, const TerminalSize *size, bool pixels)
{
    Cells cells = {.width = size->cell_width ? size->cell_width : USUAL_CELL_WIDTH,
                   .height = size->cell_height ? size->cell_height : USUAL_CELL_HEIGHT};
    double scale =
        fmin((double)size->columns * cells.width / shown->width, (double)size->rows * cells.height / shown->height);
    if (pixels) scale = fmin(scale, 1);
    cells.columns = (unsigned)fmax(1, fmin(size->columns, round(scale * shown->width / cells.width)));
    cells.rows = (unsigned)fmax(1, fmin(size->rows, round(scale * shown->height / cells.height)));
    return cells;
}

static unsigned char *bytes_of(const Image *shown)
{
    size_t n = (size_t)shown->width * shown->height;
    unsigned char *bytes = g_try_malloc(3 * n);
    for (size_t i = 0; bytes && i < n; i++)
        for (size_t c = 0; c < 3; c++)
            bytes[3 * i + c] = (unsigned char)image_byte(shown->pixels[i * shown->n_channels + c]);
    return bytes;
}

static ChafaCanvasConfig *configure(const Cells *cells, ChafaPixelMode mode, ChafaCanvasMode colors)
{
    ChafaCanvasConfig *config = chafa_canvas_config_new();
    ChafaSymbolMap *symbols = chafa_symbol_map_new();
    chafa_symbol_map_add_by_tags(symbols, CHAFA_SYMBOL_TAG_BLOCK | CHAFA_SYMBOL_TAG_SPACE);
    chafa_canvas_config_set_symbol_map(config, symbols);
    chafa_symbol_map_unref(symbols);
    chafa_canvas_config_set_geometry(config, (gint)cells->columns, (gint)cells->rows);
    chafa_canvas_config_set_cell_geometry(config, (gint)cells->width, (gint)cells->height);
    chafa_canvas_config_set_pixel_mode(config, mode);
    chafa_canvas_config_set_canvas_mode(config,
                                        mode == CHAFA_PIXEL_MODE_SYMBOLS ? colors : CHAFA_CANVAS_MODE_TRUECOLOR);
    /* it would raise the contrast where there are few colours, and this is about the picture as it is */
    chafa_canvas_config_set_preprocessing_enabled(config, FALSE);
    return config;
}

/* What the terminal understands; of graphics that somebody asks for, what all that have them do. */
static ChafaTermInfo *terminal_of(TerminalGraphics graphics, char **environment)
{
    ChafaTermDb *known = chafa_term_db_get_default();
    ChafaTermInfo *info = chafa_term_db_detect(known, environment);
    if (graphics != TERMINAL_BEST && graphics != TERMINAL_SYMBOLS) {
        ChafaTermInfo *usual = chafa_term_db_get_fallback_info(known);
        chafa_term_info_supplement(info, usual);
        chafa_term_info_unref(usual);
    }
    return info;
}

Status terminal_picture_draw(const Image *shown, const TerminalSize *size, TerminalGraphics graphics,
                             char **environment, TerminalPicture *picture, Error *error)
{
    unsigned char *bytes = bytes_of(shown);
    if (!bytes) return fail_memory(error, 3 * (size_t)shown->width * shown->height, "a picture for the terminal");
    ChafaTermInfo *info = terminal_of(graphics, environment);
    ChafaPixelMode mode = mode_of(graphics, info);
    picture->is_graphics = mode != CHAFA_PIXEL_MODE_SYMBOLS;
    Cells cells = fit(shown, size, picture->is_graphics);
    ChafaCanvasConfig *config = configure(&cells, mode, colors_of(info));
    ChafaCanvas *canvas = chafa_canvas_new(config);
    chafa_canvas_draw_all_pixels(canvas, CHAFA_PIXEL_RGB8, bytes, (gint)shown->width, (gint)shown->height,
                                 (gint)(3 * shown->width));
    GString *drawn = chafa_canvas_print(canvas, info);
    buf_add_bytes(&picture->text, drawn->str, drawn->len);
    picture->rows = cells.rows;
    g_string_free(drawn, TRUE);
    chafa_canvas_unref(canvas);
    chafa_canvas_config_unref(config);
    chafa_term_info_unref(info);
    g_free(bytes);
    return picture->text.failed ? fail_memory(error, picture->text.length, "a picture for the terminal") : STATUS_OK;
}

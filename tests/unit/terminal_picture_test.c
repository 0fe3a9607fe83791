/* terminal_picture_test.c - pictures as text for terminals: their size, their colours, and which graphics are chosen.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "preview/terminal_picture.h"

static char xterm[] = "TERM=xterm-256color", many_colors[] = "COLORTERM=truecolor", kitty_term[] = "TERM=xterm-kitty",
            linux_term[] = "TERM=linux";
static char *plain[] = {xterm, many_colors, NULL}, *kitty[] = {kitty_term, NULL}, *simple[] = {linux_term, NULL};

/* red on the left, blue on the right */
static void make_image(uint32_t width, uint32_t height, Image *image)
{
    static const char *const names[] = {"R", "G", "B"};
    Error error;
    assert_int_equal(image_new(width, height, names, 3, image, &error), STATUS_OK);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            float *rgb = image_at(image, x, y);
            rgb[0] = x < width / 2 ? 1.7f : 0; /* beyond what a display has */
            rgb[1] = -.1f;
            rgb[2] = x < width / 2 ? 0 : 1;
        }
}

static TerminalPicture draw(uint32_t width, uint32_t height, TerminalSize size, TerminalGraphics graphics,
                            char **environment)
{
    TerminalPicture drawn = {.rows = 0};
    Image image;
    Error error;
    make_image(width, height, &image);
    assert_int_equal(terminal_picture_draw(&image, &size, graphics, environment, &drawn, &error), STATUS_OK);
    image_clear(&image);
    return drawn;
}

static unsigned count(const TerminalPicture *drawn, char byte)
{
    unsigned n = 0;
    for (size_t i = 0; i < drawn->text.length; i++) n += drawn->text.text[i] == byte;
    return n;
}

static void characters_keep_proportions(void **state)
{
    (void)state;
    /* 2:1, in cells of 1:2: 80 columns and 20 rows */
    TerminalPicture wide = draw(400, 200, (TerminalSize){80, 40, 8, 16}, TERMINAL_SYMBOLS, plain);
    assert_int_equal(wide.rows, 20);
    assert_int_equal(count(&wide, '\n'), wide.rows - 1);
    assert_false(wide.is_graphics);
    /* as high as there is room, and small pictures are made larger */
    TerminalPicture high = draw(20, 20, (TerminalSize){80, 10, 0, 0}, TERMINAL_SYMBOLS, plain);
    assert_int_equal(high.rows, 10);
    TerminalPicture tiny = draw(1000, 10, (TerminalSize){40, 40, 8, 16}, TERMINAL_SYMBOLS, plain);
    assert_int_equal(tiny.rows, 1);
    buf_clear(&wide.text);
    buf_clear(&high.text);
    buf_clear(&tiny.text);
}

static void colors_are_the_pictures(void **state)
{
    (void)state;
    TerminalPicture drawn = draw(64, 64, (TerminalSize){16, 8, 8, 16}, TERMINAL_SYMBOLS, plain);
    assert_non_null(strstr(drawn.text.text, "255;0;0")); /* held to what a display has */
    assert_non_null(strstr(drawn.text.text, "0;0;255"));
    buf_clear(&drawn.text);
    drawn = draw(64, 64, (TerminalSize){16, 8, 8, 16}, TERMINAL_SYMBOLS, simple);
    assert_null(strstr(drawn.text.text, ";2;255")); /* it is not known to have so many colours */
    buf_clear(&drawn.text);
}

static void graphics_are_chosen(void **state)
{
    (void)state;
    const TerminalSize size = {80, 24, 10, 20};
    TerminalPicture own = draw(100, 100, size, TERMINAL_BEST, kitty), none = draw(100, 100, size, TERMINAL_BEST, plain);
    assert_true(own.is_graphics);
    assert_non_null(strstr(own.text.text, "\033_G"));
    assert_int_equal(own.rows, 5); /* no larger than its pixels */
    assert_false(none.is_graphics);
    TerminalPicture sixel = draw(100, 100, size, TERMINAL_SIXEL, plain),
                    iterm2 = draw(100, 100, size, TERMINAL_ITERM2, plain),
                    kitty_asked = draw(100, 100, size, TERMINAL_KITTY, plain);
    assert_non_null(strstr(sixel.text.text, "\033P"));
    assert_non_null(strstr(iterm2.text.text, "\033]1337;"));
    assert_non_null(strstr(kitty_asked.text.text, "\033_G"));
    TerminalPicture *all[] = {&own, &none, &sixel, &iterm2, &kitty_asked};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) buf_clear(&all[i]->text);
}

static void names_of_graphics(void **state)
{
    (void)state;
    TerminalGraphics graphics = TERMINAL_BEST;
    assert_true(terminal_graphics_from_text("sixel", &graphics));
    assert_int_equal(graphics, TERMINAL_SIXEL);
    assert_false(terminal_graphics_from_text("ascii", &graphics));
    assert_false(terminal_graphics_from_text("", &graphics));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(characters_keep_proportions),
        cmocka_unit_test(colors_are_the_pictures),
        cmocka_unit_test(graphics_are_chosen),
        cmocka_unit_test(names_of_graphics),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

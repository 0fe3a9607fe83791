/* sheet_test.c - where pictures and their names are on a contact sheet.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "image/font.h"
#include "image/sheet.h"

enum { MOST = 12 };

static SheetPicture picture(uint32_t width, uint32_t height, float value, const char *caption)
{
    static const char *const names[] = {"R", "G", "B"};
    SheetPicture made = {.caption = caption};
    Error error;
    assert_int_equal(image_new(width, height, names, 3, &made.image, &error), STATUS_OK);
    for (size_t i = 0; i < (size_t)width * height * 3; i++) made.image.pixels[i] = value;
    return made;
}

static size_t count(const Image *sheet, float value, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1)
{
    size_t n = 0;
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) n += image_at(sheet, x, y)[1] == value;
    return n;
}

/* Two in a row: every pixel of each is there, at its place. */
static void pictures_stand_in_rows(void **state)
{
    (void)state;
    Error error;
    Image sheet;
    SheetPicture pictures[3] = {picture(120, 60, 1, "a"), picture(60, 30, 0.5f, "b"), picture(120, 60, 0.25f, "c")};
    assert_int_equal(sheet_new(pictures, 3, 2, &sheet, &error), STATUS_OK);
    const uint32_t gap = 4 + 120 / 60, line = FONT_HEIGHT + 4;
    assert_int_equal(sheet.width, 2 * 120 + 3 * gap);
    assert_int_equal(sheet.height, 2 * (60 + line) + 3 * gap);
    assert_int_equal(count(&sheet, 1, gap, gap, gap + 120, gap + 60), 120 * 60);
    assert_int_equal(count(&sheet, 0.5f, 2 * gap + 150, gap + 15, 2 * gap + 210, gap + 45), 60 * 30);
    assert_int_equal(count(&sheet, 0.5f, 0, 0, sheet.width, sheet.height), 60 * 30);
    assert_int_equal(count(&sheet, 0.25f, gap, 2 * gap + 60 + line, gap + 120, 2 * gap + 120 + line), 120 * 60);
    assert_true(count(&sheet, 0.8f, 0, 0, sheet.width, sheet.height) > 20); /* letters */
    image_clear(&sheet);
    assert_int_equal(sheet_new(pictures, 3, 9, &sheet, &error), STATUS_OK); /* no more columns than pictures */
    assert_int_equal(sheet.width, 3 * 120 + 4 * gap);
    image_clear(&sheet);
    for (int i = 0; i < 3; i++) image_clear(&pictures[i].image);
}

/* Left to itself a sheet is neither a tower nor a strip. */
static void a_sheet_has_a_good_shape(void **state)
{
    (void)state;
    Error error;
    const uint32_t sizes[][2] = {{40, 30}, {160, 20}, {20, 160}};
    for (size_t k = 0; k < COUNT_OF(sizes); k++) {
        SheetPicture pictures[MOST];
        for (size_t i = 0; i < MOST; i++) pictures[i] = picture(sizes[k][0], sizes[k][1], 1, "name");
        for (size_t n = 6; n <= MOST; n++) {
            Image sheet;
            assert_int_equal(sheet_new(pictures, n, 0, &sheet, &error), STATUS_OK);
            double shape = (double)sheet.width / sheet.height;
            assert_true(shape > 0.7 && shape < 3);
            assert_int_equal(count(&sheet, 1, 0, 0, sheet.width, sheet.height), n * sizes[k][0] * sizes[k][1]);
            image_clear(&sheet);
        }
        for (size_t i = 0; i < MOST; i++) image_clear(&pictures[i].image);
    }
}

/* What has no room is cut, between characters; what is transparent lets the sheet through. */
static void names_are_cut_and_alpha_is_laid_over(void **state)
{
    (void)state;
    static const char *const names[] = {"R", "G", "B", "A"};
    Error error;
    Image sheet;
    char longest[2000];
    memset(longest, 'w', sizeof longest - 1);
    longest[sizeof longest - 1] = 0;
    SheetPicture pictures[3] = {
        picture(60, 30, 1,
                "\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc"),
        picture(60, 30, 1, longest),
        {.caption = ""}};
    assert_int_equal(image_new(60, 30, names, 4, &pictures[2].image, &error), STATUS_OK);
    for (size_t i = 0; i < 60 * 30; i++) pictures[2].image.pixels[4 * i] = pictures[2].image.pixels[4 * i + 1] = 1;
    assert_int_equal(sheet_new(pictures, 3, 3, &sheet, &error), STATUS_OK);
    const uint32_t gap = 5;
    for (uint32_t column = 0; column < 4; column++) /* no letter beside its picture */
        assert_int_equal(count(&sheet, 0.8f, column * (60 + gap), 0, column * (60 + gap) + gap, sheet.height), 0);
    const float *paper = image_at(&sheet, 0, 0), *through = image_at(&sheet, 2 * (60 + gap) + gap + 30, gap + 15);
    assert_memory_equal(paper, through, 3 * sizeof(float));
    image_clear(&sheet);
    for (int i = 0; i < 3; i++) image_clear(&pictures[i].image);
}

static void sheets_that_are_too_large_are_refused(void **state)
{
    (void)state;
    Error error;
    Image sheet;
    SheetPicture pictures[2] = {picture(65536, 1, 1, "a"), picture(65536, 1, 1, "b")};
    assert_int_equal(sheet_new(pictures, 2, 2, &sheet, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "a sheet of 2 by 1 pictures"));
    assert_null(sheet.pixels);
    for (int i = 0; i < 2; i++) image_clear(&pictures[i].image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_stand_in_rows),
        cmocka_unit_test(a_sheet_has_a_good_shape),
        cmocka_unit_test(names_are_cut_and_alpha_is_laid_over),
        cmocka_unit_test(sheets_that_are_too_large_are_refused),
    };
    return cmocka_run_group_tests_name("sheet", tests, NULL, NULL);
}

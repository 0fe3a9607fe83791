/* jpeg_test.c - JPEG files: colours within the quality, grey and progressive ones, damage, what is not read.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <jpeglib.h>
#include <math.h>

#include "base/attr.h"
#include "base/file.h"
#include "image/exif.h"
#include "temporary.h"

enum { WIDTH = 40, HEIGHT = 24 };

static unsigned char value_at(unsigned x, unsigned y, unsigned c)
{
    return (unsigned char)(40 + 3 * x + (c + 1) * y);
}

static void write_with(const char *path, J_COLOR_SPACE space, int channels, bool progressive,
                       const unsigned char *notes, unsigned n_notes)
{
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_stdio_dest(&jpeg, file);
    jpeg.image_width = WIDTH;
    jpeg.image_height = HEIGHT;
    jpeg.input_components = channels;
    jpeg.in_color_space = space;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 98, TRUE);
    if (progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    if (n_notes) jpeg_write_marker(&jpeg, JPEG_APP0 + 1, notes, n_notes);
    while (jpeg.next_scanline < jpeg.image_height) {
        unsigned char row[WIDTH * 4], *rows = row;
        for (unsigned x = 0; x < WIDTH; x++)
            for (int c = 0; c < channels; c++)
                row[x * (unsigned)channels + (unsigned)c] = value_at(x, jpeg.next_scanline, (unsigned)c);
        jpeg_write_scanlines(&jpeg, &rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    assert_int_equal(fclose(file), 0);
}

static void write_picture(const char *path, J_COLOR_SPACE space, int channels, bool progressive)
{
    write_with(path, space, channels, progressive, NULL, 0);
}

static void pictures_come_back(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        bool grey = kind & 1, encoded = false;
        Image image;
        Error error;
        write_picture(in_folder("picture.jpg"), grey ? JCS_GRAYSCALE : JCS_RGB, grey ? 1 : 3, kind & 2);
        assert_int_equal(image_read_as(in_folder("picture.jpg"), &image, &encoded, &error), STATUS_OK);
        assert_true(encoded);
        assert_int_equal(image.width, WIDTH);
        assert_int_equal(image.height, HEIGHT);
        assert_int_equal(image.n_channels, 3);
        double squares = 0;
        for (unsigned i = 0; i < WIDTH * HEIGHT * 3; i++) {
            double wanted = value_at(i / 3 % WIDTH, i / 3 / WIDTH, grey ? 0 : i % 3) / 255.0;
            squares += pow((double)image.pixels[i] - wanted, 2) / (WIDTH * HEIGHT * 3);
        }
        assert_true(sqrt(squares) < 0.015);
        image_clear(&image);
    }
}

static void refused(const char *name, const char *why)
{
    Image image;
    Error error;
    assert_int_equal(jpeg_read(in_folder(name), &image, &error), STATUS_INPUT);
    assert_null(image.pixels);
    if (!strstr(error.text, name) || !strstr(error.text, why)) fail_msg("%s", error.text);
}

/* Cut anywhere, with any byte another, it is read or refused, and never made up. */
static void damage_is_found(void **state)
{
    (void)state;
    write_picture(in_folder("whole.jpg"), JCS_RGB, 3, false);
    char *bytes;
    size_t n;
    Error error;
    assert_int_equal(file_read(in_folder("whole.jpg"), 0, &bytes, &n, &error), STATUS_OK);
    for (size_t length = 0; length < n - 2; length += 1 + length / 16) {
        write_bytes(in_folder("cut.jpg"), bytes, length);
        refused("cut.jpg", "cannot read");
    }
    for (size_t i = 0; i < n; i += 3) {
        Image image;
        char kept = bytes[i];
        bytes[i] = (char)~kept;
        write_bytes(in_folder("odd.jpg"), bytes, n);
        if (jpeg_read(in_folder("odd.jpg"), &image, &error) == STATUS_OK) {
            for (size_t k = 0; k < (size_t)image.width * image.height * 3; k++)
                assert_true(image.pixels[k] >= 0 && image.pixels[k] <= 1);
            image_clear(&image);
        }
        bytes[i] = kept;
    }
    free(bytes);
    write_picture(in_folder("ink.jpg"), JCS_CMYK, 4, false);
    refused("ink.jpg", "of a kind that is not read");
    write_bytes(in_folder("text.jpg"), "hello", 5);
    refused("text.jpg", "damaged");
}

/* The sides at which the standard says that the first stored row and column are, from orientation 1 on. */
static const char row_sides[] = "TTBBLRRL", column_sides[] = "LRRLTTBB";

static uint32_t from_side(char side, char first, uint32_t n, uint32_t i)
{
    return side == first ? i : n - 1 - i;
}

static void stored_pixels_stand_upright(void **state)
{
    (void)state;
    static const char *const names[] = {"R", "G"};
    Error error;
    for (unsigned orientation = 1; orientation <= 8; orientation++) {
        Image image;
        assert_int_equal(image_new(WIDTH, HEIGHT, names, 2, &image, &error), STATUS_OK);
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
            memcpy(image.pixels + 2 * i, (float[]){(float)(i % WIDTH), (float)(i / WIDTH)}, 2 * sizeof(float));
        assert_int_equal(image_turn_upright(&image, orientation, &error), STATUS_OK);
        char row = row_sides[orientation - 1], column = column_sides[orientation - 1];
        bool level = row == 'T' || row == 'B';
        assert_int_equal(image.width, level ? WIDTH : HEIGHT);
        assert_int_equal(image.height, level ? HEIGHT : WIDTH);
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
            uint32_t u = i % WIDTH, v = i / WIDTH;
            uint32_t x = level ? from_side(column, 'L', WIDTH, u) : from_side(row, 'L', HEIGHT, v);
            uint32_t y = level ? from_side(row, 'T', HEIGHT, v) : from_side(column, 'T', WIDTH, u);
            const float *pixel = image_at(&image, x, y);
            assert_true(pixel[0] == (float)u && pixel[1] == (float)v);
        }
        image_clear(&image);
    }
}

/* A directory of two entries, the second of which is the orientation. */
enum { NOTES_SIZE = 6 + 8 + 2 + 2 * 12 };
static void make_notes(bool big_endian, unsigned orientation, unsigned char notes[NOTES_SIZE])
{
    const unsigned numbers[][2] = {{2, 42}, {4, 8},     {2, 2}, {2, 0x100}, {2, 3},           {4, 1},
                                   {4, 7},  {2, 0x112}, {2, 3}, {4, 1},     {2, orientation}, {2, 0}};
    unsigned char *to = notes + 8;
    memcpy(notes, big_endian ? "Exif\0\0MM" : "Exif\0\0II", 8);
    for (size_t i = 0; i < COUNT_OF(numbers); i++)
        for (unsigned k = 0; k < numbers[i][0]; k++)
            *to++ = (unsigned char)(numbers[i][1] >> 8 * (big_endian ? numbers[i][0] - 1 - k : k));
    assert_true(to == notes + NOTES_SIZE);
}

static void photographs_are_turned_as_their_cameras_note(void **state)
{
    (void)state;
    Error error;
    for (unsigned i = 0; i < 16; i++) {
        unsigned char notes[NOTES_SIZE];
        unsigned orientation = 1 + i % 8;
        Image upright, turned;
        make_notes(i >= 8, orientation, notes);
        write_picture(in_folder("upright.jpg"), JCS_RGB, 3, false);
        write_with(in_folder("turned.jpg"), JCS_RGB, 3, false, notes, NOTES_SIZE);
        assert_int_equal(jpeg_read(in_folder("upright.jpg"), &upright, &error), STATUS_OK);
        assert_int_equal(jpeg_read(in_folder("turned.jpg"), &turned, &error), STATUS_OK);
        assert_int_equal(image_turn_upright(&upright, orientation, &error), STATUS_OK);
        assert_int_equal(turned.width, upright.width);
        assert_memory_equal(turned.pixels, upright.pixels, (size_t)WIDTH * HEIGHT * 3 * sizeof(float));
        for (size_t n = 0; n < NOTES_SIZE; n++) /* cut, or with another byte, it is some number or none */
            assert_true(exif_orientation(notes, n) == (n < 6 + 8 + 2 + 12 + 10 ? 1 : orientation));
        for (size_t at = 0; at < NOTES_SIZE; at++) {
            notes[at] ^= 0xff;
            unsigned said = exif_orientation(notes, NOTES_SIZE);
            assert_true(said == 1 || said == orientation);
            notes[at] ^= 0xff;
        }
        image_clear(&upright);
        image_clear(&turned);
    }
    unsigned char notes[NOTES_SIZE];
    for (unsigned orientation = 0; orientation <= 9; orientation += 9) {
        make_notes(false, orientation, notes);
        assert_int_equal(exif_orientation(notes, NOTES_SIZE), 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pictures_come_back), cmocka_unit_test(damage_is_found),
                                       cmocka_unit_test(stored_pixels_stand_upright),
                                       cmocka_unit_test(photographs_are_turned_as_their_cameras_note)};
    return cmocka_run_group_tests_name("jpeg", tests, make_folder, remove_folder);
}

/* jpeg_test.c - JPEG files: colours within the quality, grey and progressive ones, damage, what is not read.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <jpeglib.h>
#include <math.h>

#include "base/attr.h"
#include "base/file.h"
#include "image/image.h"
#include "temporary.h"

enum { WIDTH = 40, HEIGHT = 24 };

static unsigned char value_at(unsigned x, unsigned y, unsigned c)
{
    return (unsigned char)(40 + 3 * x + (c + 1) * y);
}

static void write_picture(const char *path, J_COLOR_SPACE space, int channels, bool progressive)
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pictures_come_back), cmocka_unit_test(damage_is_found)};
    return cmocka_run_group_tests_name("jpeg", tests, make_folder, remove_folder);
}

/* png_test.c - PNG files: exact steps, dither, other programs' kinds, damage, failures that harm nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>
#include <png.h>

#include "base/file.h"
#include "image/image.h"
#include "temporary.h"

static const char *const rgba[] = {"R", "G", "B", "A"};

static Image new_image(uint32_t width, uint32_t height, uint32_t n_channels)
{
    Image image;
    Error error;
    assert_int_equal(image_new(width, height, rgba, n_channels, &image, &error), STATUS_OK);
    return image;
}

static Image write_and_read(const Image *image, unsigned bits)
{
    Image again;
    Error error = {0};
    assert_int_equal(png_write(in_folder("picture.png"), image, bits, &error), STATUS_OK);
    assert_int_equal(image_read(in_folder("picture.png"), &again, &error), STATUS_OK);
    assert_int_equal(again.width, image->width);
    assert_int_equal(again.height, image->height);
    return again;
}

/* What is a whole step comes back as it was, dither or not. */
static void whole_steps_are_exact(void **state)
{
    (void)state;
    static const unsigned depths[] = {8, 16};
    for (size_t d = 0; d < 2; d++)
        for (uint32_t n_channels = 3; n_channels <= 4; n_channels++) {
            Image image = new_image(37, 21, n_channels);
            size_t n = (size_t)37 * 21 * n_channels;
            unsigned top = (1U << depths[d]) - 1;
            for (size_t i = 0; i < n; i++) image.pixels[i] = (float)(i * 7919 % (top + 1)) / (float)top;
            Image again = write_and_read(&image, depths[d]);
            assert_int_equal(again.n_channels, n_channels);
            assert_memory_equal(image.pixels, again.pixels, n * sizeof(float));
            image_clear(&again);
            image_clear(&image);
        }
}

/* A value between two steps is both of them in the right proportion, in every 8 x 8 block alike. */
static void dither_keeps_the_mean(void **state)
{
    (void)state;
    for (int step = 0; step <= 64; step += 7) {
        Image image = new_image(16, 16, 3);
        float value = (100 + (float)step / 64) / 255;
        for (size_t i = 0; i < 16 * 16 * 3; i++) image.pixels[i] = value;
        Image again = write_and_read(&image, 8);
        double sum = 0;
        for (size_t i = 0; i < 16 * 16 * 3; i++) {
            assert_true(fabsf(again.pixels[i] - value) <= 1.0f / 255);
            sum += (double)again.pixels[i] * 255;
        }
        assert_true(fabs(sum / (16 * 16 * 3) - 100 - step / 64.0) < 0.017);
        image_clear(&again);
        image_clear(&image);
    }
}

static void values_outside_are_held(void **state)
{
    (void)state;
    static const float values[] = {-1, NAN, -INFINITY, 2, INFINITY, 1e30f};
    static const unsigned depths[] = {8, 16};
    for (size_t d = 0; d < 2; d++) {
        Image image = new_image(2, 1, 3);
        memcpy(image.pixels, values, sizeof values);
        Image again = write_and_read(&image, depths[d]);
        for (int i = 0; i < 6; i++) assert_true(again.pixels[i] == (i < 3 ? 0 : 1));
        image_clear(&again);
        image_clear(&image);
    }
}

static void srgb_is_said_and_undone(void **state)
{
    (void)state;
    Image image = new_image(1, 1, 3);
    image.pixels[0] = 0.5f;
    image.pixels[1] = 0.02f;
    image.pixels[2] = 1;
    Image again = write_and_read(&image, 16);
    image_decode_srgb(&again);
    assert_true(fabsf(again.pixels[0] - 0.214041f) < 1e-4f);
    assert_true(fabsf(again.pixels[1] - 0.02f / 12.92f) < 1e-5f);
    assert_true(again.pixels[2] == 1);
    char *bytes;
    size_t length;
    Error error;
    assert_int_equal(file_read(in_folder("picture.png"), 0, &bytes, &length, &error), STATUS_OK);
    assert_memory_equal(bytes + 37, "sRGB", 4);
    free(bytes);
    image_clear(&again);
    image_clear(&image);
}

/* Grey, grey with alpha, palette: all become RGB or RGBA. */
static void other_kinds_are_read(void **state)
{
    (void)state;
    static const struct {
        uint32_t format, n_channels;
    } kinds[] = {{PNG_FORMAT_GRAY, 3}, {PNG_FORMAT_GA, 4}, {PNG_FORMAT_RGB_COLORMAP, 3}, {PNG_FORMAT_RGBA, 4}};
    for (size_t k = 0; k < COUNT_OF(kinds); k++) {
        png_byte bytes[64], palette[6] = {10, 20, 30, 255, 255, 255};
        memset(bytes, 1, sizeof bytes);
        png_image file = {
            .version = PNG_IMAGE_VERSION, .width = 4, .height = 4, .format = kinds[k].format, .colormap_entries = 2};
        assert_true(png_image_write_to_file(&file, in_folder("kind.png"), 0, bytes, 0, palette));
        Image image;
        Error error = {0};
        assert_int_equal(png_read(in_folder("kind.png"), &image, &error), STATUS_OK);
        assert_int_equal(image.n_channels, kinds[k].n_channels);
        float expected = kinds[k].format == PNG_FORMAT_RGB_COLORMAP ? 1 : 1 / 255.0f;
        for (int c = 0; c < 3; c++) assert_true(image.pixels[c] == expected);
        image_clear(&image);
    }
}

static void failures_harm_nothing(void **state)
{
    (void)state;
    Error error = {0};
    Image image = new_image(300, 300, 3), again;
    for (size_t i = 0; i < (size_t)300 * 300 * 3; i++) image.pixels[i] = (float)(i * 7919 % 256) / 255;
    assert_int_equal(png_write("/dev/full", &image, 8, &error), STATUS_OUTPUT);
    assert_string_equal(error.text, "cannot write '/dev/full': No space left on device");
    write_bytes(in_folder("file"), "x", 1);
    assert_int_equal(png_write(in_folder("file/below.png"), &image, 8, &error), STATUS_OUTPUT);
    assert_int_equal(png_write(in_folder("old.png"), &image, 8, &error), STATUS_OK);
    assert_int_equal(png_write(in_folder("old.png"), &image, 12, &error), STATUS_USAGE);
    memcpy(image.names[0], "Q", 2);
    assert_int_equal(png_write(in_folder("old.png"), &image, 8, &error), STATUS_USAGE);
    assert_int_equal(image_read(in_folder("old.png"), &again, &error), STATUS_OK);
    assert_int_equal(again.width, 300);
    image_clear(&again);
    image_clear(&image);
}

static void damaged_files_are_refused_or_read(void **state)
{
    (void)state;
    Error error = {0};
    Image image = new_image(20, 20, 3), again;
    for (size_t i = 0; i < 1200; i++) image.pixels[i] = (float)(i % 256) / 255;
    char *bytes;
    size_t length;
    assert_int_equal(png_write(in_folder("whole.png"), &image, 8, &error), STATUS_OK);
    image_clear(&image);
    assert_int_equal(file_read(in_folder("whole.png"), 0, &bytes, &length, &error), STATUS_OK);
    for (size_t n = 0; n < length; n++) {
        write_bytes(in_folder("cut.png"), bytes, n);
        assert_int_equal(image_read(in_folder("cut.png"), &again, &error), STATUS_INPUT);
        assert_non_null(strstr(error.text, "cut.png"));
    }
    for (size_t i = 8; i < length; i++) {
        bytes[i] = (char)(bytes[i] ^ 0x7f);
        write_bytes(in_folder("spoilt.png"), bytes, length);
        bytes[i] = (char)(bytes[i] ^ 0x7f);
        Status status = image_read(in_folder("spoilt.png"), &again, &error);
        assert_true(status == STATUS_OK || status == STATUS_INPUT);
        image_clear(&again);
    }
    free(bytes);
    assert_int_equal(png_read(folder, &again, &error), STATUS_INPUT);
    assert_int_equal(png_read(in_folder("absent.png"), &again, &error), STATUS_INPUT);
    write_bytes(in_folder("empty.png"), "", 0);
    assert_int_equal(png_read(in_folder("empty.png"), &again, &error), STATUS_INPUT);
}

/* 60000 x 60000 pixels in a hundred bytes, with a right checksum. */
static void a_lying_header_is_refused(void **state)
{
    (void)state;
    static const unsigned char lie[] = "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\xea\x60\0\0\xea\x60\x08\x02\0\0\0"
                                       "\0\0\0\0"
                                       "\0\0\0\x04IDATxxxx\0\0\0\0";
    unsigned char copy[sizeof lie];
    memcpy(copy, lie, sizeof lie);
    uint32_t sum = 0xffffffffU; /* CRC-32 of the chunk */
    for (size_t i = 12; i < 29; i++) {
        sum ^= copy[i];
        for (int bit = 0; bit < 8; bit++) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320U : 0);
    }
    for (size_t i = 0; i < 4; i++) copy[29 + i] = (unsigned char)(~sum >> (24 - 8 * i));
    write_bytes(in_folder("lie.png"), copy, sizeof copy);
    Image image;
    Error error = {0};
    assert_int_equal(image_read(in_folder("lie.png"), &image, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "too short for the size"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_steps_are_exact),
        cmocka_unit_test(dither_keeps_the_mean),
        cmocka_unit_test(values_outside_are_held),
        cmocka_unit_test(srgb_is_said_and_undone),
        cmocka_unit_test(other_kinds_are_read),
        cmocka_unit_test(failures_harm_nothing),
        cmocka_unit_test(damaged_files_are_refused_or_read),
        cmocka_unit_test(a_lying_header_is_refused),
    };
    return cmocka_run_group_tests_name("png", tests, make_folder, remove_folder);
}

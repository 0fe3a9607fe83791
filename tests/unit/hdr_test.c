/* hdr_test.c - Radiance's pictures: flat, in old and new runs, in all eight orders; what their headers say; damage, and what
 * is not read.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/attr.h"
#include "base/buf.h"
#include "base/file.h"
#include "image/image.h"
#include "near.h"
#include "temporary.h"

typedef enum Coding { FLAT, OLD_RUNS, NEW_RUNS, CODINGS } Coding;

typedef struct Pixel {
    unsigned char byte[4];
} Pixel;

/* Stretches of one colour, some of them as long as it takes for runs of two digits, beside stretches that change. */
static Pixel pixel_at(uint32_t x, uint32_t y)
{
    unsigned char base = (unsigned char)(x / 37 % 2 ? 40 + x : 90);
    if (x > 300) base = 200;
    return (Pixel){{base, (unsigned char)(20 + 3 * y), (unsigned char)(255 - base), (unsigned char)(120 + y % 16)}};
}

static void put_old(Buf *file, const Pixel *line, uint32_t n)
{
    for (uint32_t i = 0, end; i < n; i = end) {
        for (end = i + 1; end < n && memcmp(&line[end], &line[i], 4) == 0;) end++;
        buf_add_bytes(file, (const char *)line[i].byte, 4);
        for (uint32_t left = end - i - 1; left; left >>= 8) {
            const unsigned char run[4] = {1, 1, 1, (unsigned char)(left & 255)};
            buf_add_bytes(file, (const char *)run, 4);
        }
    }
}

static void put_new(Buf *file, const Pixel *line, uint32_t n)
{
    const unsigned char head[4] = {2, 2, (unsigned char)(n >> 8), (unsigned char)(n & 255)};
    buf_add_bytes(file, (const char *)head, 4);
    for (int c = 0; c < 4; c++)
        for (uint32_t i = 0, end; i < n; i = end) {
            for (end = i + 1; end < n && end - i < 127 && line[end].byte[c] == line[i].byte[c];) end++;
            unsigned char code[2] = {(unsigned char)(128 + end - i), line[i].byte[c]};
            if (end - i < 3) code[0] = 1, end = i + 1; /* by itself */
            buf_add_bytes(file, (const char *)code, 2);
        }
}

/* The picture of width x height with a header, whose last line is its size in an order such as "-Y +X". */
static void write_picture(const char *name, const char *header, const char *order, uint32_t width, uint32_t height,
                          Coding coding)
{
    Buf file = {0};
    bool columns = order[1] == 'X';
    uint32_t n_lines = columns ? width : height, length = columns ? height : width;
    Pixel line[4096];
    buf_format(&file, "%s\n%.2s %u %s %u\n", header, order, n_lines, order + 3, length);
    for (uint32_t k = 0; k < n_lines; k++) {
        for (uint32_t i = 0; i < length; i++) {
            uint32_t first = order[0] == '-' ? n_lines - 1 - k : k, second = order[3] == '-' ? length - 1 - i : i;
            uint32_t x = columns ? first : second, up = columns ? second : first;
            line[i] = pixel_at(x, height - 1 - up);
        }
        if (coding == FLAT) buf_add_bytes(&file, (const char *)line, 4 * (size_t)length);
        if (coding == OLD_RUNS) put_old(&file, line, length);
        if (coding == NEW_RUNS) put_new(&file, line, length);
    }
    assert_false(file.failed);
    write_bytes(in_folder(name), buf_text(&file), file.length);
    buf_clear(&file);
}

static double wanted(uint32_t x, uint32_t y, int c)
{
    Pixel pixel = pixel_at(x, y);
    return (pixel.byte[c] + 0.5) / 256 * pow(2, pixel.byte[3] - 128);
}

#define HEADER "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n"

static void every_order_and_coding(void **state)
{
    (void)state;
    static const char *const orders[] = {"-Y +X", "+Y +X", "-Y -X", "+Y -X", "+X -Y", "+X +Y", "-X -Y", "-X +Y"};
    static const uint32_t sizes[][2] = {{700, 9}, {7, 3}, {1, 1}, {8, 40}};
    for (size_t size = 0; size < COUNT_OF(sizes); size++)
        for (size_t order = 0; order < COUNT_OF(orders); order++)
            for (Coding coding = FLAT; coding < CODINGS; coding++) {
                Image image;
                Error error;
                bool encoded = true;
                uint32_t width = sizes[size][0], height = sizes[size][1],
                         length = orders[order][1] == 'X' ? height : width;
                if (coding == NEW_RUNS && length < 8) continue;
                write_picture("picture.hdr", HEADER, orders[order], width, height, coding);
                if (image_read_as(in_folder("picture.hdr"), &image, &encoded, &error) != STATUS_OK)
                    fail_msg("%s", error.text);
                assert_false(encoded);
                assert_int_equal(image.width, width);
                assert_int_equal(image.height, height);
                assert_int_equal(image.n_channels, 3);
                for (uint32_t y = 0; y < height; y++)
                    for (uint32_t x = 0; x < width; x++)
                        for (int c = 0; c < 3; c++) assert_near((double)image_at(&image, x, y)[c], wanted(x, y, c), 0);
                image_clear(&image);
            }
}

/* The first pixel of a picture of 3 x 2 with that header. */
static void first_pixel(const char *header, double rgb[3])
{
    Image image;
    Error error;
    write_picture("first.hdr", header, "-Y +X", 3, 2, FLAT);
    if (hdr_read(in_folder("first.hdr"), &image, &error) != STATUS_OK) fail_msg("%s", error.text);
    for (int c = 0; c < 3; c++) rgb[c] = (double)image.pixels[c];
    image_clear(&image);
}

static void headers_are_heeded(void **state)
{
    (void)state;
    double rgb[3], plain[3];
    first_pixel("#?RGBE\r\nFORMAT=32-bit_rle_rgbe\r\n\r", plain); /* lines as Windows ends them */
    for (int c = 0; c < 3; c++) assert_near(plain[c], wanted(0, 0, c), 0);
    first_pixel("#?RADIANCE\npfilt -e +1\nSOFTWARE= x\nEXPOSURE=2\n\tEXPOSURE=7\nEXPOSURE= 4.0 \nCOLORCORR=1 .5 2\n",
                rgb);
    assert_near(rgb[0], plain[0] / 8, 1e-7 * plain[0]);
    assert_near(rgb[1], plain[1] / 4, 1e-7 * plain[0]);
    assert_near(rgb[2], plain[2] / 16, 1e-7 * plain[0]);
    /* Rec.709's own primaries change nothing, to the bit */
    first_pixel(HEADER "PRIMARIES=.64 .33 .3 .6 .15 .06 .3127 .329\n", rgb);
    for (int c = 0; c < 3; c++) assert_near(rgb[c], plain[c], 0);
}

/* The same colours by other primaries: grey stays grey, and the matrices are those that are published. */
static void primaries_become_those_of_rec709(void **state)
{
    (void)state;
    static const struct {
        const char *header;
        double matrix[3][3];
    } cases[] = {
        /* ITU-R BT.2087: from BT.2020 */
        {HEADER "PRIMARIES=.708 .292 .170 .797 .131 .046 .3127 .3290\n",
         {{1.660491, -0.587641, -0.072850}, {-0.124550, 1.132900, -0.008349}, {-0.018151, -0.100579, 1.118730}}},
        /* CIE XYZ by Bradford's matrix from E to D65, and by IEC 61966-2-1's to sRGB */
        {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n",
         {{3.1468, -1.6664, -0.4804}, {-0.9955, 1.9558, 0.0397}, {0.0636, -0.2146, 1.1510}}}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        double rgb[3];
        first_pixel(cases[i].header, rgb);
        for (int c = 0; c < 3; c++) {
            double expected = 0, most = 0;
            for (int k = 0; k < 3; k++) {
                expected += cases[i].matrix[c][k] * wanted(0, 0, k);
                most = fmax(most, wanted(0, 0, k));
            }
            assert_near(rgb[c], fmax(expected, 0), 2e-3 * most);
        }
    }
}

static void note(void *context, const char *name, const char *text)
{
    buf_format(context, "[%s|%s]", name, text);
}

static void headers_are_shown(void **state)
{
    (void)state;
    Buf seen = {0};
    Error error;
    write_picture("shown.hdr", HEADER "rpict -vf a=b\n\ttab=x\nEXPOSURE=1.5\nVIEW= -vth\n=\n", "-Y +X", 3, 2, FLAT);
    assert_int_equal(hdr_visit_header(in_folder("shown.hdr"), note, &seen, &error), STATUS_OK);
    assert_string_equal(buf_text(&seen), "[FORMAT|32-bit_rle_rgbe][rpict -vf a|b][EXPOSURE|1.5][VIEW| -vth]");
    buf_clear(&seen);
}

static void refused(const char *name, const char *why)
{
    Image image;
    Error error;
    if (hdr_read(in_folder(name), &image, &error) != STATUS_INPUT) fail_msg("%s is read", name);
    assert_null(image.pixels);
    assert_null(strchr(error.text, '\n'));
    if (!strstr(error.text, name) || !strstr(error.text, why)) fail_msg("'%s' lacks '%s'", error.text, why);
}

static void refused_text(const char *text, size_t length, const char *why)
{
    write_bytes(in_folder("bad.hdr"), text, length);
    refused("bad.hdr", why);
}
#define REFUSED(text, why) refused_text(text, sizeof(text) - 1, why)

static void what_is_not_read(void **state)
{
    (void)state;
    REFUSED("", "empty");
    REFUSED("hello", "not a Radiance picture");
    REFUSED("hello\n\n-Y 1 +X 1\n1234", "not a Radiance picture");
    REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", "cut short within its header");
    REFUSED("#?RADIANCE\n\n", "cut short before its size");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 1", "cut short before its size");
    REFUSED("#?RADIANCE\nFORMAT=Radiance_spectra\n\n-Y 1 +X 1\n1234", "FORMAT=Radiance_spectra, and only");
    REFUSED("#?RADIANCE\nFORMAT=a\x1b[31m\n\n-Y 1 +X 1\n1234", "FORMAT=a?[31m, and only");
    REFUSED("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n1234", "EXPOSURE=0, which leaves no picture");
    REFUSED("#?RADIANCE\nEXPOSURE=one\n\n-Y 1 +X 1\n1234", "EXPOSURE=one, not a number");
    REFUSED("#?RADIANCE\nCOLORCORR=1 1\n\n-Y 1 +X 1\n1234", "COLORCORR=1 1, not three numbers");
    REFUSED("#?RADIANCE\nPRIMARIES=1 1\n\n-Y 1 +X 1\n1234", "PRIMARIES=1 1, not eight numbers");
    REFUSED("#?RADIANCE\nPRIMARIES=1 1 1 1 1 1 1 1\n\n-Y 1 +X 1\n1234", "PRIMARIES that make no colours");
    REFUSED("#?RADIANCE\nPRIMARIES=.64 .33 .3 .6 .15 .06 .3 0\n\n-Y 1 +X 1\n1234", "PRIMARIES that make no colours");
    REFUSED("#?RADIANCE\nPRIMARIES=.64 .33 .3 .6 .15 .06 -9 .001\n\n-Y 1 +X 1\n1234", "PRIMARIES that make no colours");
    REFUSED("#?RADIANCE\n\n+X 1 -X 1\n1234", "has '+X 1 -X 1' where its size belongs");
    REFUSED("#?RADIANCE\n\n-Y 0 +X 1\n1234", "where its size belongs");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 1 1\n1234", "where its size belongs");
    REFUSED("#?RADIANCE\n\n-Y 1x +X 1\n1234", "where its size belongs");
    REFUSED("#?RADIANCE\n\n-Y1 +X 1\n1234", "where its size belongs");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 70000\n1234", "1 by 70000 pixels, outside 1..65536");
    REFUSED("#?RADIANCE\n\n-Y 60000 +X 60000\n1234", "too short for the size it claims");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 2\n1234123", "cut short");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 2\n\1\1\1\1"
            "1234",
            "does not end with its line");                                          /* a run of nothing */
    REFUSED("#?RADIANCE\n\n-Y 1 +X 2\n1234\1\1\1\2", "does not end with its line"); /* of too many */
    REFUSED("#?RADIANCE\n\n-Y 1 +X 8\n1234\1\1\1\0\1\1\1\0\1\1\1\0\1\1\1\0\1\1\1\1", "does not end with its line");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 8\n\2\2\0\7\210a\210a\210a\210a", "another length");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 8\n\2\2\0\10\211a\210a\210a\210a", "does not end with its line");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 8\n\2\2\0\10\200a\210a\210a\210a", "does not end with its line");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 8\n\2\2\0\10\210a\0a\210a\210a", "does not end with its line");
    REFUSED("#?RADIANCE\n\n-Y 1 +X 8\n\2\2\0\10\210a\210a\210a\7a", "cut short");
    REFUSED("#?RADIANCE\nEXPOSURE=1e-20\n\n-Y 1 +X 1\n\377\377\377\377", "too bright for its EXPOSURE");
}

/* Every length of a small file, and every byte of it another in turn: read or refused, never more. */
static void damage_is_found(void **state)
{
    (void)state;
    for (Coding coding = FLAT; coding < CODINGS; coding++) {
        char *bytes;
        size_t n;
        Error error;
        Image image;
        write_picture("whole.hdr", HEADER "EXPOSURE=2\n", "-Y +X", 48, 5, coding);
        assert_int_equal(file_read(in_folder("whole.hdr"), 0, &bytes, &n, &error), STATUS_OK);
        for (size_t length = 0; length < n; length++) {
            write_bytes(in_folder("cut.hdr"), bytes, length);
            refused("cut.hdr", "cannot read");
        }
        for (size_t i = 0; i < n; i++)
            for (int way = 0; way < 3; way++) {
                char kept = bytes[i];
                bytes[i] = (char)(way == 0 ? ~kept : way == 1 ? kept ^ 1 : kept ^ 0x80);
                write_bytes(in_folder("odd.hdr"), bytes, n);
                if (hdr_read(in_folder("odd.hdr"), &image, &error) == STATUS_OK) {
                    for (size_t k = 0; k < (size_t)image.width * image.height * 3; k++)
                        assert_true(isfinite(image.pixels[k]));
                    image_clear(&image);
                }
                bytes[i] = kept;
            }
        free(bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_order_and_coding),
        cmocka_unit_test(headers_are_heeded),
        cmocka_unit_test(primaries_become_those_of_rec709),
        cmocka_unit_test(headers_are_shown),
        cmocka_unit_test(what_is_not_read),
        cmocka_unit_test(damage_is_found),
    };
    return cmocka_run_group_tests_name("hdr", tests, make_folder, remove_folder);
}

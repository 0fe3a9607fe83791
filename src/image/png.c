/* png.c - PNG files, through libpng.
 * libpng reports an error by a jump; every jump stays inside one of the two functions that set it up, whose
 * locals that change after the set-up live in a struct outside.
 * SPDX-License-Identifier: Apache-2.0 */
#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "image/image.h"

enum { MAX_SIDE = 65536, BEST_RATIO = 1100 /* zlib's is 1032 */ };

/* What a run of libpng needs and what it leaves behind, also after a jump. */
typedef struct PngJob {
    png_structp png;
    png_infop info;
    char reason[160];
    png_bytep row;     /* owned: one row to write */
    png_bytep pixels;  /* owned: the whole picture, read */
    png_bytepp rows;   /* owned: into pixels */
    const char *bytes; /* what is read */
    size_t n_bytes, position;
    uint32_t width, height, channels;
} PngJob;

static void clear_job(PngJob *job, bool reading)
{
    if (reading)
        png_destroy_read_struct(&job->png, &job->info, NULL);
    else
        png_destroy_write_struct(&job->png, &job->info);
    free(job->row);
    free(job->pixels);
    free(job->rows);
}

static void on_error(png_structp png, png_const_charp message)
{
    PngJob *job = png_get_error_ptr(png);
    snprintf(job->reason, sizeof job->reason, "%s", message);
    png_longjmp(png, 1);
}

/* Warnings are about chunks that do not matter here. */
static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

/* --- writing --- */

/* The 8 x 8 threshold matrix of Bayer (1973), by its recursion: bit pairs of x ^ y and y, the lowest weighing most. */
static float dither_threshold(uint32_t x, uint32_t y)
{
    uint32_t value = 0;
    for (unsigned bit = 0; bit < 3; bit++) value = value << 2 | ((x ^ y) >> bit & 1) << 1 | (y >> bit & 1);
    return ((float)value + 0.5f) / 64;
}

static float held(float v)
{
    return v > 0 ? (v < 1 ? v : 1) : 0; /* not a number: 0 */
}

/* A value of 0, 255 or any whole step between them is exact: thresholds are within (0, 1). Alpha is not dithered. */
static void fill_row_8(const Image *image, const int *channels, uint32_t n, uint32_t y, png_bytep row)
{
    const float *line = image->pixels + (size_t)y * image->width * image->n_channels;
    for (uint32_t x = 0; x < image->width; x++) {
        float threshold = dither_threshold(x & 7, y & 7);
        for (uint32_t c = 0; c < n; c++) {
            float v = held(line[(size_t)x * image->n_channels + (size_t)channels[c]]) * 255;
            *row++ = (png_byte)(v + (c == 3 ? 0.5f : threshold));
        }
    }
}

static void fill_row_16(const Image *image, const int *channels, uint32_t n, uint32_t y, png_bytep row)
{
    const float *line = image->pixels + (size_t)y * image->width * image->n_channels;
    for (uint32_t x = 0; x < image->width; x++)
        for (uint32_t c = 0; c < n; c++) {
            unsigned v = (unsigned)(held(line[(size_t)x * image->n_channels + (size_t)channels[c]]) * 65535 + 0.5f);
            *row++ = (png_byte)(v >> 8);
            *row++ = (png_byte)(v & 255);
        }
}

/* In place of libpng's own, which knows no reason but "Write Error". */
static void put_bytes(png_structp png, png_bytep from, size_t n)
{
    if (fwrite(from, 1, n, png_get_io_ptr(png)) != n) png_error(png, strerror(errno));
}

static void flush_bytes(png_structp png)
{
    (void)png; /* file_commit flushes */
}

static void write_into(PngJob *job, const Image *image, const int *channels, uint32_t n, unsigned bits, FILE *stream)
{
    png_set_write_fn(job->png, stream, put_bytes, flush_bytes);
    png_set_compression_level(job->png, 4);
    png_set_IHDR(job->png, job->info, image->width, image->height, (int)bits,
                 n == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(job->png, job->info, PNG_sRGB_INTENT_RELATIVE);
    png_write_info(job->png, job->info);
    for (uint32_t y = 0; y < image->height; y++) {
        if (bits == 16)
            fill_row_16(image, channels, n, y, job->row);
        else
            fill_row_8(image, channels, n, y, job->row);
        png_write_row(job->png, job->row);
    }
    png_write_end(job->png, job->info);
}

/* false when libpng failed, with the reason in job. */
static bool run_writer(PngJob *job, const Image *image, const int *channels, uint32_t n, unsigned bits, FILE *stream)
{
    job->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    job->row = malloc((size_t)image->width * n * (bits / 8));
    if (!job->info || !job->row) {
        snprintf(job->reason, sizeof job->reason, "out of memory");
        return false;
    }
    if (setjmp(png_jmpbuf(job->png))) return false;
    write_into(job, image, channels, n, bits, stream);
    return true;
}

Status png_write(const char *path, const Image *image, unsigned bits, Error *error)
{
    if (bits != 8 && bits != 16)
        return fail(error, STATUS_USAGE, "a PNG picture has 8 or 16 bits per channel, not %u", bits);
    int channels[4];
    if (!image_rgb(image, channels))
        return fail(error, STATUS_USAGE, "cannot write '%s': the picture has no channels R, G and B", path);
    channels[3] = image_channel(image, "A");
    uint32_t n = channels[3] >= 0 ? 4 : 3;
    FileOut out;
    TRY(file_create(&out, path, error));
    PngJob job = {0};
    bool whole = run_writer(&job, image, channels, n, bits, out.stream);
    clear_job(&job, false);
    if (whole) return file_commit(&out, error);
    file_abandon(&out);
    return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, job.reason);
}

/* --- reading --- */

static void take_bytes(png_structp png, png_bytep to, size_t n)
{
    PngJob *job = png_get_io_ptr(png);
    if (n > job->n_bytes - job->position) png_error(png, "the file is cut short");
    memcpy(to, job->bytes + job->position, n);
    job->position += n;
}

/* Whatever the file has becomes 8 or 16 bit RGB or RGBA. */
static void expand_pixels(PngJob *job)
{
    png_structp png = job->png;
    png_byte kind = png_get_color_type(png, job->info);
    if (kind == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
    if (png_get_bit_depth(png, job->info) < 8) png_set_expand(png);
    if (png_get_valid(png, job->info, PNG_INFO_tRNS)) png_set_tRNS_to_alpha(png);
    if (kind == PNG_COLOR_TYPE_GRAY || kind == PNG_COLOR_TYPE_GRAY_ALPHA) png_set_gray_to_rgb(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, job->info);
    job->channels = png_get_channels(png, job->info);
}

static void read_into(PngJob *job)
{
    png_structp png = job->png;
    png_set_read_fn(png, job, take_bytes);
    png_set_user_limits(png, MAX_SIDE, MAX_SIDE);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_QUIET_USE);
    png_read_info(png, job->info);
    job->width = png_get_image_width(png, job->info);
    job->height = png_get_image_height(png, job->info);
    double packed = (double)png_get_rowbytes(png, job->info) * job->height;
    if (packed > 1e6 + BEST_RATIO * (double)job->n_bytes)
        png_error(png, "the file is too short for the size it claims");
    expand_pixels(job);
    size_t row_bytes = png_get_rowbytes(png, job->info);
    job->pixels = calloc(job->height, row_bytes);
    job->rows = calloc(job->height, sizeof *job->rows);
    if (!job->pixels || !job->rows) png_error(png, "out of memory");
    for (uint32_t y = 0; y < job->height; y++) job->rows[y] = job->pixels + y * row_bytes;
    png_read_image(png, job->rows);
    png_read_end(png, NULL);
}

static bool run_reader(PngJob *job)
{
    job->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    if (!job->info) {
        snprintf(job->reason, sizeof job->reason, "out of memory");
        return false;
    }
    if (setjmp(png_jmpbuf(job->png))) return false;
    read_into(job);
    return true;
}

static Status image_of_job(const PngJob *job, Image *image, Error *error)
{
    static const char *const names[4] = {"R", "G", "B", "A"};
    TRY(image_new(job->width, job->height, names, job->channels, image, error));
    bool deep = png_get_bit_depth(job->png, job->info) == 16;
    float *to = image->pixels;
    for (uint32_t y = 0; y < job->height; y++) {
        png_const_bytep from = job->rows[y];
        for (size_t i = 0; i < (size_t)job->width * job->channels; i++)
            *to++ = deep ? (float)(from[2 * i] << 8 | from[2 * i + 1]) / 65535 : (float)from[i] / 255;
    }
    return STATUS_OK;
}

Status png_read(const char *path, Image *image, Error *error)
{
    *image = (Image){0};
    char *bytes;
    size_t n_bytes;
    TRY(file_read(path, 0, &bytes, &n_bytes, error));
    PngJob job = {.bytes = bytes, .n_bytes = n_bytes};
    Status status;
    if (n_bytes == 0)
        status = fail(error, STATUS_INPUT, "cannot read '%s': the file is empty", path);
    else if (n_bytes < 8 || png_sig_cmp((png_const_bytep)bytes, 0, 8) != 0)
        status = fail(error, STATUS_INPUT, "cannot read '%s': it is not a PNG file", path);
    else if (!run_reader(&job))
        status =
            fail(error, STATUS_INPUT, "cannot read '%s': the PNG file is damaged or cut short (%s)", path, job.reason);
    else
        status = image_of_job(&job, image, error);
    clear_job(&job, true);
    free(bytes);
    return status;
}

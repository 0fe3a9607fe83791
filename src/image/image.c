/* image.c - pictures in memory, and reading a picture whatever its format.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/image.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/file_reads.h"
#include "base/memory.h"

enum { MAX_SIDE = 65536, MAX_CHANNELS = 1024 };

Status image_new(uint32_t width, uint32_t height, const char *const *names, uint32_t n_channels, Image *image,
                 Error *error)
{
    *image = (Image){0};
    if (width < 1 || width > MAX_SIDE || height < 1 || height > MAX_SIDE)
        return fail(error, STATUS_NOMEM, "a picture of %lu x %lu pixels is outside 1..%d on a side",
                    (unsigned long)width, (unsigned long)height, MAX_SIDE);
    if (n_channels < 1 || n_channels > MAX_CHANNELS)
        return fail(error, STATUS_NOMEM, "a picture with %lu channels is outside 1..%d", (unsigned long)n_channels,
                    MAX_CHANNELS);
    /* at most 2^32 * 2^10 * 4 = 2^44 bytes: no overflow where size_t has 64 bits */
    uint64_t bytes = (uint64_t)width * height * n_channels * sizeof(float);
    /* Memory that is not there is promised all the same, and then ends the program. */
    double machine = memory_of_machine();
    if (machine > 0 && (double)bytes > machine)
        return fail(
            error, STATUS_NOMEM, "a picture of %lu x %lu pixels and %lu channels needs %.0f GB, and there are %.0f",
            (unsigned long)width, (unsigned long)height, (unsigned long)n_channels, (double)bytes / 1e9, machine / 1e9);
    if (bytes > SIZE_MAX / 2) return fail_memory(error, SIZE_MAX, "a picture");
    image->names = calloc(n_channels, sizeof *image->names);
    image->pixels = calloc((size_t)bytes, 1);
    if (!image->names || !image->pixels) {
        image_clear(image);
        return fail(error, STATUS_NOMEM, "out of memory: %llu bytes for a picture of %lu x %lu pixels and %lu channels",
                    (unsigned long long)bytes, (unsigned long)width, (unsigned long)height, (unsigned long)n_channels);
    }
    image->width = width;
    image->height = height;
    image->n_channels = n_channels;
    for (uint32_t i = 0; i < n_channels; i++) {
        size_t length = strlen(names[i]);
        if (length == 0 || length >= sizeof image->names[i]) {
            image_clear(image);
            return fail(error, STATUS_INPUT, "the channel name '%.80s' is not 1 to %zu bytes long", names[i],
                        sizeof image->names[i] - 1);
        }
        memcpy(image->names[i], names[i], length + 1);
    }
    return STATUS_OK;
}

void image_clear(Image *image)
{
    free(image->names);
    free(image->pixels);
    *image = (Image){0};
}

void image_crop(Image *image, const uint32_t crop[4])
{
    size_t row = (size_t)(crop[2] - crop[0]) * image->n_channels;
    for (uint32_t y = crop[1]; y < crop[3]; y++)
        memmove(image->pixels + (y - crop[1]) * row, image_at(image, crop[0], y), row * sizeof *image->pixels);
    image->width = crop[2] - crop[0];
    image->height = crop[3] - crop[1];
}

Status image_new_like(const Image *like, uint32_t width, uint32_t height, Image *image, Error *error)
{
    const char **names = malloc(like->n_channels * sizeof *names);
    if (!names) return fail_memory(error, like->n_channels * sizeof *names, "the names of channels");
    for (uint32_t i = 0; i < like->n_channels; i++) names[i] = like->names[i];
    Status status = image_new(width, height, names, like->n_channels, image, error);
    free(names);
    return status;
}

Status image_expand(Image *image, const ImagePlace *place, Error *error)
{
    Image whole;
    TRY(image_new_like(image, place->width, place->height, &whole, error));
    const size_t row = (size_t)image->width * image->n_channels * sizeof *image->pixels;
    for (uint32_t y = 0; y < image->height; y++)
        memcpy(image_at(&whole, place->x, place->y + y), image_at(image, 0, y), row);
    image_clear(image);
    *image = whole;
    return STATUS_OK;
}

void image_copy_channels(const Image *from, uint32_t first, uint32_t n, Image *to, uint32_t at)
{
    for (uint32_t y = 0; y < from->height; y++)
        for (uint32_t x = 0; x < from->width; x++)
            memcpy(image_at(to, x, y) + at, image_at(from, x, y) + first, n * sizeof(float));
}

int image_channel(const Image *image, const char *name)
{
    for (uint32_t i = 0; i < image->n_channels; i++)
        if (strcmp(image->names[i], name) == 0) return (int)i;
    return -1;
}

/* The channels layer.R, layer.G, layer.B of the first layer that has all three. */
static bool find_layer_rgb(const Image *image, int rgb[3])
{
    for (uint32_t i = 0; i < image->n_channels; i++) {
        const char *dot = strrchr(image->names[i], '.');
        if (!dot || strcmp(dot, ".R") != 0) continue;
        char name[sizeof *image->names];
        memcpy(name, image->names[i], sizeof name);
        char *letter = name + (dot - image->names[i]) + 1;
        rgb[0] = (int)i;
        *letter = 'G';
        rgb[1] = image_channel(image, name);
        *letter = 'B';
        rgb[2] = image_channel(image, name);
        if (rgb[1] >= 0 && rgb[2] >= 0) return true;
    }
    return false;
}

bool image_rgb(const Image *image, int rgb[3])
{
    static const char *const names[3] = {"R", "G", "B"};
    for (int i = 0; i < 3; i++) rgb[i] = image_channel(image, names[i]);
    if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) return true;
    if (find_layer_rgb(image, rgb)) return true;
    int grey = image_channel(image, "Y");
    rgb[0] = rgb[1] = rgb[2] = grey;
    return grey >= 0;
}

void image_decode_srgb(Image *image)
{
    int rgb[3];
    if (!image_rgb(image, rgb)) return;
    int n_colors = rgb[0] == rgb[1] ? 1 : 3;
    size_t n_pixels = (size_t)image->width * image->height;
    for (size_t i = 0; i < n_pixels; i++) {
        float *pixel = image->pixels + i * image->n_channels;
        for (int c = 0; c < n_colors; c++) {
            float v = pixel[rgb[c]];
            pixel[rgb[c]] = v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
        }
    }
}

typedef enum Format { FORMAT_UNKNOWN, FORMAT_EXR, FORMAT_PNG, FORMAT_JPEG, FORMAT_HDR } Format;

static Format format_of_bytes(const unsigned char *bytes, size_t length)
{
    static const unsigned char exr_magic[4] = {0x76, 0x2f, 0x31, 0x01};
    static const unsigned char png_magic[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    if (length >= sizeof exr_magic && memcmp(bytes, exr_magic, sizeof exr_magic) == 0) return FORMAT_EXR;
    if (length >= sizeof png_magic && memcmp(bytes, png_magic, sizeof png_magic) == 0) return FORMAT_PNG;
    if (length >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff) return FORMAT_JPEG;
    if (length >= 2 && bytes[0] == '#' && bytes[1] == '?') return FORMAT_HDR;
    return FORMAT_UNKNOWN;
}

/* exr_read takes its file in pieces and notes nothing, as checkpoints are read to be written again. */
static Status read_exr(const char *path, Image *image, Error *error)
{
    struct stat facts;
    bool there = stat(path, &facts) == 0;
    if (there && S_ISREG(facts.st_mode) && !file_note_read(path, &facts))
        return fail_memory(error, strlen(path) + 1, path);
    Status status = exr_read(path, image, error);
    if (!there && strcmp(path, "-") != 0) file_note_missing(path);
    return status;
}

Status image_read_as(const char *path, Image *image, bool *encoded, Error *error)
{
    *image = (Image){0};
    /* Only a regular file can be looked at twice; the others go by their name, and standard input is EXR. */
    struct stat facts;
    Format format = FORMAT_UNKNOWN;
    if (strcmp(path, "-") == 0) {
        format = FORMAT_EXR;
    } else if (stat(path, &facts) == 0 && S_ISREG(facts.st_mode)) {
        unsigned char head[8] = {0};
        int file = open(path, O_RDONLY | O_CLOEXEC);
        if (file < 0) return file_cannot_read(path, errno, error);
        ssize_t length = read(file, head, sizeof head);
        close(file);
        if (length == 0) return fail(error, STATUS_INPUT, "cannot read '%s': the file is empty", path);
        if (length > 0) format = format_of_bytes(head, (size_t)length);
    }
    if (format == FORMAT_UNKNOWN) {
        const char *extension = file_extension(path);
        if (strcasecmp(extension, "exr") == 0) format = FORMAT_EXR;
        if (strcasecmp(extension, "png") == 0) format = FORMAT_PNG;
        if (strcasecmp(extension, "hdr") == 0) format = FORMAT_HDR;
        if (strcasecmp(extension, "jpg") == 0 || strcasecmp(extension, "jpeg") == 0) format = FORMAT_JPEG;
    }
    if (encoded) *encoded = format == FORMAT_PNG || format == FORMAT_JPEG;
    switch (format) {
    case FORMAT_EXR: return read_exr(path, image, error);
    case FORMAT_PNG: return png_read(path, image, error);
    case FORMAT_JPEG: return jpeg_read(path, image, error);
    case FORMAT_HDR: return hdr_read(path, image, error);
    case FORMAT_UNKNOWN: break;
    }
    if (stat(path, &facts) != 0) return file_cannot_read(path, errno, error);
    if (S_ISDIR(facts.st_mode)) return fail(error, STATUS_INPUT, "cannot read '%s': it is a directory", path);
    return fail(error, STATUS_INPUT,
                "cannot read '%s': it is neither an EXR nor a PNG, JPEG or Radiance picture (.hdr)", path);
}

Status image_read(const char *path, Image *image, Error *error)
{
    return image_read_as(path, image, NULL, error);
}

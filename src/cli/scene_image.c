/* scene_image.c - reads the images that a scene names, as linear colours of the working space.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "cli/scene_input.h"

static Status copy_colors(const char *path, const Image *image, float **rgb, Error *error)
{
    int channels[3];
    if (!image_rgb(image, channels)) return fail(error, STATUS_INPUT, "'%s' has no colour channels", path);
    size_t n = (size_t)image->width * image->height, size = n * 3 * sizeof **rgb;
    *rgb = malloc(size);
    if (!*rgb) return fail_memory(error, size, path);
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++)
            (*rgb)[3 * i + (size_t)c] = image->pixels[i * image->n_channels + (size_t)channels[c]];
    return STATUS_OK;
}

Status image_read_linear(const char *path, Image *image, Error *error)
{
    bool encoded;
    TRY(image_read_as(path, image, &encoded, error));
    if (encoded) image_decode_srgb(image);
    return STATUS_OK;
}

/* Three times the alpha. */
static Status copy_alpha(const char *path, const Image *image, float **rgb, Error *error)
{
    int alpha = image_channel(image, "A");
    size_t n = (size_t)image->width * image->height, size = n * 3 * sizeof **rgb;
    *rgb = malloc(size);
    if (!*rgb) return fail_memory(error, size, path);
    for (size_t i = 0; i < 3 * n; i++)
        (*rgb)[i] = alpha < 0 ? 1 : image->pixels[i / 3 * image->n_channels + (size_t)alpha];
    return STATUS_OK;
}

/* SCENE_SPACE_DATA leaves values as they are. Without a named space an EXR file is linear in the working space already,
 * and PNG and JPEG files are sRGB. */
Status load_scene_image(void *context, const char *path, const char *space, float **rgb, uint32_t *width,
                        uint32_t *height, Error *error)
{
    ColorSource *color = context;
    Image image = {0};
    *rgb = NULL;
    Status status = space ? image_read(path, &image, error) : image_read_linear(path, &image, error);
    bool alpha = space && strcmp(space, SCENE_SPACE_ALPHA) == 0;
    if (status == STATUS_OK) status = (alpha ? copy_alpha : copy_colors)(path, &image, rgb, error);
    bool convert = space && !alpha && strcmp(space, SCENE_SPACE_DATA) != 0;
    if (status == STATUS_OK && convert) status = color_source_open(color, error);
    if (status == STATUS_OK && convert)
        status = color_to_working(color->config, space, *rgb, (size_t)image.width * image.height, error);
    *width = image.width;
    *height = image.height;
    image_clear(&image);
    if (status != STATUS_OK) {
        free(*rgb);
        *rgb = NULL;
    }
    return status;
}

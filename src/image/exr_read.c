/* exr_read.c - the reading of EXR files: flat pictures of any compression but DWA, in lines or tiles, into the display
 * window. What a header says is checked against the size of the file before memory is asked for.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "image/exr_parts.h"

enum {
    MAX_CHANNELS = 1024,
    BEST_RATIO = 2000 /* no compressor of the format exceeds it (zlib 1032, PIZ's run lengths about 500) */
};

/* What the first part is, as far as reading it needs. Windows are inclusive. */
typedef struct ExrPart {
    exr_storage_t storage;
    exr_compression_t compression;
    exr_attr_box2i_t data, display, wanted; /* wanted: what is read */
    const exr_attr_chlist_t *channels;
} ExrPart;

/* Before memory is asked for: a header can lie, and a small file cannot hold a huge picture. */
static Status check_windows(const ExrFile *file, const ExrPart *part, double pixel_bytes, bool whole, Error *error)
{
    const exr_attr_box2i_t *windows[2] = {&part->data, &part->display};
    const double most = 1e6 + BEST_RATIO * (double)file->bytes.size;
    double width[2], height[2];
    for (int i = 0; i < 2; i++) {
        width[i] = (double)windows[i]->max.x - windows[i]->min.x + 1;
        height[i] = (double)windows[i]->max.y - windows[i]->min.y + 1;
        if (!(width[i] >= 1 && width[i] <= EXR_MAX_SIDE && height[i] >= 1 && height[i] <= EXR_MAX_SIDE))
            return fail(error, STATUS_INPUT, "cannot read '%s': its header says %.0f x %.0f pixels; the limit is %d",
                        file->path, width[i], height[i], EXR_MAX_SIDE);
    }
    if (width[0] * height[0] * pixel_bytes > most)
        return fail(error, STATUS_INPUT,
                    "cannot read '%s': its header says %.0f x %.0f pixels, for which the file is too short", file->path,
                    width[0], height[0]);
    if (whole && width[1] * height[1] * pixel_bytes > most)
        return fail(error, STATUS_INPUT,
                    "cannot read '%s': it holds %.0f x %.0f pixels of a picture of %.0f x %.0f, most of which would be "
                    "empty; 'meniscus merge' puts such parts together",
                    file->path, width[0], height[0], width[1], height[1]);
    return STATUS_OK;
}

/* whole: all of the display window is to be read. */
static Status check_part(const ExrFile *file, const ExrPart *part, bool whole, Error *error)
{
    if (part->storage != EXR_STORAGE_SCANLINE && part->storage != EXR_STORAGE_TILED)
        return fail(error, STATUS_INPUT, "cannot read '%s': it holds deep data, not a flat picture", file->path);
    if (part->compression == EXR_COMPRESSION_DWAA || part->compression == EXR_COMPRESSION_DWAB)
        return fail(error, STATUS_INPUT,
                    "cannot read '%s': DWA compression is not supported (convert it, for example with: "
                    "oiiotool in.exr --compression zip -o out.exr)",
                    file->path);
    int n_channels = part->channels->num_channels;
    if (n_channels < 1 || n_channels > MAX_CHANNELS)
        return fail(error, STATUS_INPUT, "cannot read '%s': %d channels are outside 1..%d", file->path, n_channels,
                    MAX_CHANNELS);
    double pixel_bytes = 0;
    for (int c = 0; c < n_channels; c++) {
        const exr_attr_chlist_entry_t *channel = &part->channels->entries[c];
        if (channel->x_sampling != 1 || channel->y_sampling != 1)
            return fail(error, STATUS_INPUT, "cannot read '%s': its channel '%s' is subsampled", file->path,
                        channel->name.str);
        if ((size_t)channel->name.length >= sizeof *((Image *)NULL)->names)
            return fail(error, STATUS_INPUT, "cannot read '%s': the channel name '%.40s...' is too long", file->path,
                        channel->name.str);
        pixel_bytes += channel->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    }
    return check_windows(file, part, pixel_bytes, whole, error);
}

static Status describe_part(const ExrFile *file, ExrPart *part, bool whole, Error *error)
{
    exr_result_t result = exr_get_storage(file->context, 0, &part->storage);
    if (result == EXR_ERR_SUCCESS) result = exr_get_compression(file->context, 0, &part->compression);
    if (result == EXR_ERR_SUCCESS) result = exr_get_data_window(file->context, 0, &part->data);
    if (result == EXR_ERR_SUCCESS) result = exr_get_display_window(file->context, 0, &part->display);
    if (result == EXR_ERR_SUCCESS) result = exr_get_channels(file->context, 0, &part->channels);
    if (result != EXR_ERR_SUCCESS) return exr_fail_read(file->path, &file->bytes, result, error);
    return check_part(file, part, whole, error);
}

/* The decoding of one part's chunks, one after another, into the image. */
typedef struct ExrDecoder {
    const ExrFile *file;
    const ExrPart *part;
    Image *image;
    exr_decode_pipeline_t pipeline;
    bool started;
    float *staging; /* one chunk, a plane for each channel */
    size_t staging_size;
} ExrDecoder;

/* Staging, whose first pixel is (x, y) of the file's coordinates, to where it lies in what is wanted. */
static void place_chunk(const ExrDecoder *decoder, int64_t x, int64_t y, int32_t width, int32_t height)
{
    Image *image = decoder->image;
    x -= decoder->part->wanted.min.x;
    y -= decoder->part->wanted.min.y;
    int64_t first = x < 0 ? -x : 0;
    int64_t last = x + width > image->width ? (int64_t)image->width - x : width;
    if (first >= last) return;
    size_t plane = (size_t)width * (size_t)height, n = (size_t)(last - first), stride = image->n_channels;
    for (int64_t line = 0; line < height; line++) {
        if (y + line < 0 || y + line >= image->height) continue;
        float *to = image->pixels + ((size_t)(y + line) * image->width + (size_t)(x + first)) * stride;
        const float *from = decoder->staging + (size_t)line * (size_t)width + (size_t)first;
        for (size_t c = 0; c < stride; c++)
            for (size_t i = 0; i < n; i++) to[i * stride + c] = from[c * plane + i];
    }
}

/* OpenEXR 3.1's own way to interleave four channels of halfs turns their order round; so it is done in place_chunk. */
static exr_result_t decode_chunk(ExrDecoder *decoder, const exr_chunk_info_t *chunk, int64_t x, int64_t y)
{
    exr_context_t context = decoder->file->context;
    exr_decode_pipeline_t *pipeline = &decoder->pipeline;
    uint32_t n_channels = decoder->image->n_channels;
    size_t size = (size_t)chunk->width * (size_t)chunk->height * n_channels * sizeof(float);
    if (size > decoder->staging_size) {
        free(decoder->staging);
        decoder->staging = malloc(size);
        decoder->staging_size = decoder->staging ? size : 0;
        if (!decoder->staging) return EXR_ERR_OUT_OF_MEMORY;
    }
    exr_result_t result = decoder->started ? exr_decoding_update(context, 0, chunk, pipeline)
                                           : exr_decoding_initialize(context, 0, chunk, pipeline);
    if (result != EXR_ERR_SUCCESS) return result;
    for (int c = 0; c < pipeline->channel_count; c++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[c];
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_pixel_stride = sizeof(float);
        channel->user_line_stride = (int32_t)((uint32_t)chunk->width * sizeof(float));
        size_t plane = (size_t)chunk->width * (size_t)chunk->height; /* both lists are in the file's order */
        channel->decode_to_ptr = (uint8_t *)(decoder->staging + (size_t)c * plane);
    }
    if (!decoder->started) result = exr_decoding_choose_default_routines(context, 0, pipeline);
    decoder->started = true;
    if (result == EXR_ERR_SUCCESS) result = exr_decoding_run(context, 0, pipeline);
    if (result == EXR_ERR_SUCCESS) place_chunk(decoder, x, y, chunk->width, chunk->height);
    return result;
}

static exr_result_t decode_lines(ExrDecoder *decoder)
{
    const exr_attr_box2i_t *data = &decoder->part->data;
    int32_t lines;
    exr_result_t result = exr_get_scanlines_per_chunk(decoder->file->context, 0, &lines);
    for (int64_t y = data->min.y; result == EXR_ERR_SUCCESS && y <= data->max.y; y += lines) {
        exr_chunk_info_t chunk;
        result = exr_read_scanline_chunk_info(decoder->file->context, 0, (int)y, &chunk);
        if (result == EXR_ERR_SUCCESS) result = decode_chunk(decoder, &chunk, data->min.x, y);
    }
    return result;
}

static exr_result_t decode_tiles(ExrDecoder *decoder)
{
    const exr_attr_box2i_t *data = &decoder->part->data;
    int32_t width, height;
    exr_result_t result = exr_get_tile_sizes(decoder->file->context, 0, 0, 0, &width, &height);
    if (result != EXR_ERR_SUCCESS) return result;
    int column = 0, row = 0;
    for (int64_t y = data->min.y; y <= data->max.y; y += height, row++) {
        column = 0;
        for (int64_t x = data->min.x; x <= data->max.x; x += width, column++) {
            exr_chunk_info_t chunk;
            result = exr_read_tile_chunk_info(decoder->file->context, 0, column, row, 0, 0, &chunk);
            if (result == EXR_ERR_SUCCESS) result = decode_chunk(decoder, &chunk, x, y);
            if (result != EXR_ERR_SUCCESS) return result;
        }
    }
    return EXR_ERR_SUCCESS;
}

/* The place of the last chunk is asked for before memory is: so a file that was cut off costs nothing. */
static exr_result_t find_last_chunk(const ExrFile *file, const ExrPart *part)
{
    exr_chunk_info_t chunk;
    if (part->storage == EXR_STORAGE_SCANLINE)
        return exr_read_scanline_chunk_info(file->context, 0, part->data.max.y, &chunk);
    int32_t width, height;
    exr_result_t result = exr_get_tile_sizes(file->context, 0, 0, 0, &width, &height);
    if (result != EXR_ERR_SUCCESS) return result;
    int64_t column = ((int64_t)part->data.max.x - part->data.min.x) / width;
    int64_t row = ((int64_t)part->data.max.y - part->data.min.y) / height;
    return exr_read_tile_chunk_info(file->context, 0, (int)column, (int)row, 0, 0, &chunk);
}

static exr_result_t find_lines(const ExrFile *file, const exr_attr_box2i_t *data)
{
    int32_t lines;
    exr_chunk_info_t chunk;
    exr_result_t result = exr_get_scanlines_per_chunk(file->context, 0, &lines);
    for (int64_t y = data->min.y; result == EXR_ERR_SUCCESS && y <= data->max.y; y += lines)
        result = exr_read_scanline_chunk_info(file->context, 0, (int)y, &chunk);
    return result;
}

static exr_result_t find_tiles(const ExrFile *file, const exr_attr_box2i_t *data)
{
    int32_t width, height;
    exr_chunk_info_t chunk;
    exr_result_t result = exr_get_tile_sizes(file->context, 0, 0, 0, &width, &height);
    if (result != EXR_ERR_SUCCESS) return result;
    int64_t columns = ((int64_t)data->max.x - data->min.x) / width + 1;
    int64_t rows = ((int64_t)data->max.y - data->min.y) / height + 1;
    for (int64_t i = 0; result == EXR_ERR_SUCCESS && i < columns * rows; i++)
        result = exr_read_tile_chunk_info(file->context, 0, (int)(i % columns), (int)(i / columns), 0, 0, &chunk);
    return result;
}

Status exr_file_check_whole(const ExrFile *file, Error *error)
{
    ExrPart part = {0};
    exr_result_t result = exr_get_storage(file->context, 0, &part.storage);
    if (result == EXR_ERR_SUCCESS) result = exr_get_data_window(file->context, 0, &part.data);
    if (result == EXR_ERR_SUCCESS && part.storage == EXR_STORAGE_SCANLINE) result = find_lines(file, &part.data);
    if (result == EXR_ERR_SUCCESS && part.storage == EXR_STORAGE_TILED) result = find_tiles(file, &part.data);
    return result == EXR_ERR_SUCCESS ? STATUS_OK : exr_fail_read(file->path, &file->bytes, result, error);
}

static Status image_for_part(const ExrPart *part, Image *image, Error *error)
{
    const char *names[MAX_CHANNELS];
    for (int c = 0; c < part->channels->num_channels; c++) names[c] = part->channels->entries[c].name.str;
    return image_new((uint32_t)(part->wanted.max.x - part->wanted.min.x + 1),
                     (uint32_t)(part->wanted.max.y - part->wanted.min.y + 1), names,
                     (uint32_t)part->channels->num_channels, image, error);
}

static int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static int32_t smaller(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

/* What both windows have. */
static Status want_common(const ExrFile *file, ExrPart *part, ImagePlace *place, Error *error)
{
    const exr_attr_box2i_t *data = &part->data, *display = &part->display;
    part->wanted.min.x = larger(data->min.x, display->min.x);
    part->wanted.min.y = larger(data->min.y, display->min.y);
    part->wanted.max.x = smaller(data->max.x, display->max.x);
    part->wanted.max.y = smaller(data->max.y, display->max.y);
    if (part->wanted.min.x > part->wanted.max.x || part->wanted.min.y > part->wanted.max.y)
        return fail(error, STATUS_INPUT, "cannot read '%s': its pixels lie outside of its picture", file->path);
    *place = (ImagePlace){.x = (uint32_t)((int64_t)part->wanted.min.x - display->min.x),
                          .y = (uint32_t)((int64_t)part->wanted.min.y - display->min.y),
                          .width = (uint32_t)((int64_t)display->max.x - display->min.x + 1),
                          .height = (uint32_t)((int64_t)display->max.y - display->min.y + 1)};
    return STATUS_OK;
}

/* place: NULL, and all of the display window is read; or only what there is of it, and where that lies. */
static Status read_open_file(const ExrFile *file, Image *image, ImagePlace *place, Error *error)
{
    ExrPart part;
    TRY(describe_part(file, &part, !place, error));
    part.wanted = part.display;
    if (place) TRY(want_common(file, &part, place, error));
    exr_result_t result = find_last_chunk(file, &part);
    if (result != EXR_ERR_SUCCESS) return exr_fail_read(file->path, &file->bytes, result, error);
    TRY(image_for_part(&part, image, error));
    ExrDecoder decoder = {.file = file, .part = &part, .image = image};
    result = part.storage == EXR_STORAGE_TILED ? decode_tiles(&decoder) : decode_lines(&decoder);
    exr_decoding_destroy(file->context, &decoder.pipeline);
    free(decoder.staging);
    if (result == EXR_ERR_SUCCESS) return STATUS_OK;
    image_clear(image);
    return exr_fail_read(file->path, &file->bytes, result, error);
}

static Status read_file(const char *path, Image *image, ImagePlace *place, Error *error)
{
    *image = (Image){0};
    ExrFile file;
    Status status = exr_file_open(path, &file, error);
    if (status == STATUS_OK) status = read_open_file(&file, image, place, error);
    exr_file_close(&file);
    return status;
}

Status exr_read(const char *path, Image *image, Error *error)
{
    return read_file(path, image, NULL, error);
}

Status exr_read_part(const char *path, Image *image, ImagePlace *place, Error *error)
{
    return read_file(path, image, place, error);
}

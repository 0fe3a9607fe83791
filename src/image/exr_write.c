/* exr_write.c - the writing of EXR files: chunks are compressed by many threads, and written in their order.
 * SPDX-License-Identifier: Apache-2.0 */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "image/exr_parts.h"

enum { SHORT_NAME = 31 }; /* longer names need the format's long-name flag, which the oldest readers refuse */

static const float half_max = 65504.0f;

static Status fail_write(const char *path, const ExrBytes *bytes, exr_result_t code, Error *error)
{
    return fail(error, code == EXR_ERR_OUT_OF_MEMORY ? STATUS_NOMEM : STATUS_OUTPUT, "cannot write '%s': %s", path,
                exr_reason(bytes, code));
}

static bool is_color(const char *name)
{
    return name[0] && !name[1] && strchr("RGBA", name[0]);
}

/* Attributes that OpenEXR defines as float; readers refuse them in another type. */
static bool is_standard_float(const char *name)
{
    static const char *const names[] = {"whiteLuminance", "xDensity",  "expTime",  "aperture", "isoSpeed",
                                        "focus",          "longitude", "latitude", "altitude", "utcOffset"};
    for (size_t i = 0; i < COUNT_OF(names); i++)
        if (strcmp(names[i], name) == 0) return true;
    return false;
}

static exr_result_t set_attribute(exr_context_t context, const ImageAttribute *attribute)
{
    switch (attribute->type) {
    case ATTRIBUTE_TEXT: return exr_attr_set_string(context, 0, attribute->name, attribute->text);
    case ATTRIBUTE_INT: return exr_attr_set_int(context, 0, attribute->name, attribute->whole);
    case ATTRIBUTE_FLOAT:
        if (is_standard_float(attribute->name))
            return exr_attr_set_float(context, 0, attribute->name, (float)attribute->number);
        return exr_attr_set_double(context, 0, attribute->name, attribute->number);
    }
    return EXR_ERR_INVALID_ARGUMENT;
}

static bool needs_long_names(const Image *image, const ExrOptions *options)
{
    for (uint32_t i = 0; i < image->n_channels; i++)
        if (strlen(image->names[i]) > SHORT_NAME) return true;
    for (size_t i = 0; i < options->n_attributes; i++)
        if (strlen(options->attributes[i].name) > SHORT_NAME) return true;
    return false;
}

/* The library would add a second channel of a name and then write for ever. */
static Status check_names(const char *path, const Image *image, Error *error)
{
    for (uint32_t i = 0; i < image->n_channels; i++)
        if (image_channel(image, image->names[i]) != (int)i)
            return fail(error, STATUS_OUTPUT, "cannot write '%s': two channels are named '%s'", path, image->names[i]);
    return STATUS_OK;
}

/* The data window is what there are pixels of, the display window the whole. */
static exr_result_t write_windows(exr_context_t context, const Image *image, const ExrOptions *options)
{
    const ImagePlace whole = {.width = image->width, .height = image->height};
    const ImagePlace *place = options->place ? options->place : &whole;
    const exr_attr_v2f_t center = {.x = 0, .y = 0};
    exr_attr_box2i_t display = {.max = {.x = (int32_t)place->width - 1, .y = (int32_t)place->height - 1}}, data;
    data.min.x = (int32_t)place->x;
    data.min.y = (int32_t)place->y;
    data.max.x = data.min.x + (int32_t)image->width - 1;
    data.max.y = data.min.y + (int32_t)image->height - 1;
    return exr_initialize_required_attr(context, 0, &display, &data,
                                        options->pixel_aspect > 0 ? options->pixel_aspect : 1, &center, 1,
                                        EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIPS);
}

static exr_result_t write_header(exr_context_t context, const Image *image, const ExrOptions *options)
{
    static const float rec709[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
    int part;
    exr_result_t result = exr_set_longname_support(context, needs_long_names(image, options));
    if (result == EXR_ERR_SUCCESS) result = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (result == EXR_ERR_SUCCESS) result = write_windows(context, image, options);
    /* a render's noise compresses to the same size, within 2 %, by every level of ZIP, ZIPS and PIZ; the time differs by up
     * to 2.6 times, and lines that stand alone are many tasks for many threads */
    if (result == EXR_ERR_SUCCESS) result = exr_set_zip_compression_level(context, 0, 1);
    const float *xy = options->chromaticities ? options->chromaticities : rec709;
    exr_attr_chromaticities_t chromaticities = {xy[0], xy[1], xy[2], xy[3], xy[4], xy[5], xy[6], xy[7]};
    if (result == EXR_ERR_SUCCESS) result = exr_attr_set_chromaticities(context, 0, "chromaticities", &chromaticities);
    for (uint32_t i = 0; result == EXR_ERR_SUCCESS && i < image->n_channels; i++) {
        bool half = options->half && is_color(image->names[i]);
        result = exr_add_channel(context, 0, image->names[i], half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                                 EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    }
    for (size_t i = 0; result == EXR_ERR_SUCCESS && i < options->n_attributes; i++)
        result = set_attribute(context, &options->attributes[i]);
    return result == EXR_ERR_SUCCESS ? exr_write_header(context) : result;
}

/* The writing of a part's chunks: compressed by many threads, written in their order. */
typedef struct ExrWriter {
    exr_context_t context;
    const Image *image;
    uint32_t lines;              /* of a chunk */
    uint32_t first_line;         /* of the data window */
    uint32_t n_staged;           /* channels that are changed on their way out: */
    int staged_at[4];            /* where in a pixel they are, */
    int *stage_of;               /* and of each channel, which of them it is; -1: none */
    struct ExrEncoder *encoders; /* of each worker */
    ExrBytes *bytes;
    pthread_mutex_t mutex; /* of what follows */
    pthread_cond_t turned;
    uint32_t turn;       /* the chunk to be written next */
    exr_result_t result; /* the first failure, in the order of chunks */
} ExrWriter;

/* The encoding of chunks by one worker. */
typedef struct ExrEncoder {
    ExrWriter *writer;
    uint32_t chunk;
    bool is_set_up;
    exr_encode_pipeline_t pipeline;
    exr_result_t (*compress)(exr_encode_pipeline_t *pipeline); /* the library's, while ours stands in its place */
    int *at;                                                   /* in a pixel, of each channel in the file's order */
    float *staging;                                            /* staged channels of one chunk, interleaved */
    ExrReason reason;
} ExrEncoder;

/* Copies what goes out as half, held to half's range: a bright lamp is not infinite. Not-a-numbers and infinities that
 * were there stay, for whoever looks for them. */
static void stage_lines(const ExrWriter *writer, uint32_t y, uint32_t n_lines, float *staging)
{
    const Image *image = writer->image;
    size_t n = (size_t)n_lines * image->width, stride = image->n_channels;
    const float *source = image->pixels + (size_t)y * image->width * stride;
    for (size_t i = 0; i < n; i++, source += stride)
        for (uint32_t c = 0; c < writer->n_staged; c++) {
            float v = source[writer->staged_at[c]];
            *staging++ = isfinite(v) ? fmaxf(-half_max, fminf(half_max, v)) : v;
        }
}

/* A chunk whose stored size is its full size is read as not compressed, but OpenEXR 3.1 (with ZIP at least) also
 * writes it so when the compressed bytes happen to be exactly that many; such a chunk is stored plain. */
static exr_result_t compress_or_store(exr_encode_pipeline_t *pipeline)
{
    const ExrEncoder *encoder = pipeline->encoding_user_data;
    exr_result_t result = encoder->compress(pipeline);
    if (result == EXR_ERR_SUCCESS && pipeline->compressed_buffer &&
        pipeline->compressed_bytes == pipeline->packed_bytes)
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->compressed_bytes);
    return result;
}

/* Until all chunks before this one are written. Chunks are begun in their order, so that these are on their way. */
static void wait_for_turn(const ExrEncoder *encoder)
{
    ExrWriter *writer = encoder->writer;
    pthread_mutex_lock(&writer->mutex);
    while (writer->turn != encoder->chunk) pthread_cond_wait(&writer->turned, &writer->mutex);
    pthread_mutex_unlock(&writer->mutex);
}

/* The library's call before it writes. */
static exr_result_t yield_until_turn(exr_encode_pipeline_t *pipeline)
{
    const ExrEncoder *encoder = pipeline->encoding_user_data;
    wait_for_turn(encoder);
    /* of one's own turn, none but oneself writes the result; what the library is told of an earlier failure is not kept */
    return encoder->writer->result == EXR_ERR_SUCCESS ? EXR_ERR_SUCCESS : EXR_ERR_WRITE_IO;
}

static void point_at_pixels(ExrEncoder *encoder, uint32_t y)
{
    const ExrWriter *writer = encoder->writer;
    const Image *image = writer->image;
    const float *lines = image->pixels + (size_t)y * image->width * image->n_channels;
    for (int c = 0; c < encoder->pipeline.channel_count; c++) {
        exr_coding_channel_info_t *channel = &encoder->pipeline.channels[c];
        int at = encoder->at[c], stage = writer->stage_of[at];
        size_t n_channels = stage < 0 ? image->n_channels : writer->n_staged;
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_pixel_stride = (int32_t)(n_channels * sizeof(float));
        channel->user_line_stride = (int32_t)(image->width * n_channels * sizeof(float));
        channel->encode_from_ptr = (const uint8_t *)(stage < 0 ? lines + at : encoder->staging + stage);
    }
}

static bool find_channels(ExrEncoder *encoder)
{
    const exr_encode_pipeline_t *pipeline = &encoder->pipeline;
    encoder->at = malloc((size_t)pipeline->channel_count * sizeof *encoder->at);
    for (int c = 0; c < pipeline->channel_count && encoder->at; c++)
        encoder->at[c] = image_channel(encoder->writer->image, pipeline->channels[c].channel_name);
    return encoder->at != NULL;
}

/* The chunk that begins with line y of the picture; the pipeline is set up by a worker's first. */
static exr_result_t encode_chunk(ExrEncoder *encoder, uint32_t y)
{
    exr_context_t context = encoder->writer->context;
    exr_encode_pipeline_t *pipeline = &encoder->pipeline;
    exr_chunk_info_t chunk;
    exr_result_t result = exr_write_scanline_chunk_info(context, 0, (int)(encoder->writer->first_line + y), &chunk);
    if (result != EXR_ERR_SUCCESS) return result;
    result = encoder->is_set_up ? exr_encoding_update(context, 0, &chunk, pipeline)
                                : exr_encoding_initialize(context, 0, &chunk, pipeline);
    if (result != EXR_ERR_SUCCESS) return result;
    if (!encoder->at && !find_channels(encoder)) return EXR_ERR_OUT_OF_MEMORY;
    point_at_pixels(encoder, y);
    if (!encoder->is_set_up) {
        result = exr_encoding_choose_default_routines(context, 0, pipeline);
        if (result != EXR_ERR_SUCCESS) return result;
        encoder->compress = pipeline->compress_fn;
        pipeline->encoding_user_data = encoder;
        pipeline->compress_fn = compress_or_store;
        pipeline->yield_until_ready_fn = yield_until_turn;
        encoder->is_set_up = true;
    }
    return exr_encoding_run(context, 0, pipeline);
}

/* The next chunk's turn. The first failure stays, and its reason becomes the file's. */
static void end_turn(ExrEncoder *encoder, exr_result_t result)
{
    ExrWriter *writer = encoder->writer;
    wait_for_turn(encoder);
    pthread_mutex_lock(&writer->mutex);
    if (writer->result == EXR_ERR_SUCCESS && result != EXR_ERR_SUCCESS) {
        writer->result = result;
        writer->bytes->reason = encoder->reason;
    }
    writer->turn++;
    pthread_cond_broadcast(&writer->turned);
    pthread_mutex_unlock(&writer->mutex);
}

static bool has_failed(ExrWriter *writer)
{
    pthread_mutex_lock(&writer->mutex);
    bool failed = writer->result != EXR_ERR_SUCCESS;
    pthread_mutex_unlock(&writer->mutex);
    return failed;
}

static void task_of_chunk(void *context, uint32_t index, unsigned worker)
{
    ExrWriter *writer = context;
    ExrEncoder *encoder = &writer->encoders[worker];
    const Image *image = writer->image;
    uint32_t y = index * writer->lines;
    exr_result_t result = EXR_ERR_SUCCESS;
    encoder->writer = writer;
    encoder->chunk = index;
    if (!has_failed(writer)) {
        ExrReason *before = exr_report_to(&encoder->reason);
        if (writer->n_staged && !encoder->staging)
            encoder->staging = malloc((size_t)writer->lines * image->width * writer->n_staged * sizeof(float));
        if (writer->n_staged && !encoder->staging) {
            result = EXR_ERR_OUT_OF_MEMORY;
        } else {
            stage_lines(writer, y, image->height - y < writer->lines ? image->height - y : writer->lines,
                        encoder->staging);
            result = encode_chunk(encoder, y);
        }
        exr_report_to(before);
    }
    end_turn(encoder, result);
}

static exr_result_t write_pixels(ExrWriter *writer, const ExrOptions *options)
{
    const Image *image = writer->image;
    int32_t lines;
    exr_result_t result = exr_get_scanlines_per_chunk(writer->context, 0, &lines);
    if (result != EXR_ERR_SUCCESS) return result;
    unsigned n_workers = pool_threads(options->pool);
    writer->lines = (uint32_t)lines;
    writer->encoders = calloc(n_workers, sizeof *writer->encoders);
    writer->stage_of = malloc(image->n_channels * sizeof *writer->stage_of);
    if (!writer->encoders || !writer->stage_of) {
        result = EXR_ERR_OUT_OF_MEMORY;
    } else {
        for (uint32_t c = 0; c < image->n_channels; c++) {
            bool staged = options->half && is_color(image->names[c]);
            writer->stage_of[c] = staged ? (int)writer->n_staged : -1;
            if (staged) writer->staged_at[writer->n_staged++] = (int)c;
        }
        pthread_mutex_init(&writer->mutex, NULL);
        pthread_cond_init(&writer->turned, NULL);
        pool_run(options->pool, (image->height + writer->lines - 1) / writer->lines, task_of_chunk, writer);
        pthread_cond_destroy(&writer->turned);
        pthread_mutex_destroy(&writer->mutex);
        result = writer->result;
        for (unsigned i = 0; i < n_workers; i++) {
            exr_encoding_destroy(writer->context, &writer->encoders[i].pipeline);
            free(writer->encoders[i].staging);
            free(writer->encoders[i].at);
        }
    }
    free(writer->encoders);
    free(writer->stage_of);
    return result;
}

/* The whole file into stream, which can seek. */
static Status write_stream(const char *path, const Image *image, const ExrOptions *options, FILE *stream, Error *error)
{
    ExrBytes bytes = {.file = -1, .stream = stream};
    exr_context_initializer_t initializer = exr_initializer(&bytes);
    exr_context_t context = NULL;
    exr_result_t result = exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &initializer);
    if (result == EXR_ERR_SUCCESS) {
        result = write_header(context, image, options);
        ExrWriter writer = {.context = context,
                            .image = image,
                            .first_line = options->place ? options->place->y : 0,
                            .bytes = &bytes,
                            .result = EXR_ERR_SUCCESS};
        if (result == EXR_ERR_SUCCESS) result = write_pixels(&writer, options);
        exr_result_t finished = exr_finish(&context); /* writes the table of chunks */
        if (result == EXR_ERR_SUCCESS) result = finished;
    }
    exr_report_to(NULL);
    if (result != EXR_ERR_SUCCESS) return fail_write(path, &bytes, result, error);
    if (!options->append) return STATUS_OK;
    if (fseeko(stream, 0, SEEK_END) != 0)
        return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, strerror(errno));
    return options->append(options->append_context, stream, error);
}

static Status copy_stream(const char *path, FILE *from, FILE *to, Error *error)
{
    char block[65536];
    size_t n;
    rewind(from);
    while ((n = fread(block, 1, sizeof block, from)) > 0)
        if (fwrite(block, 1, n, to) != n)
            return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, strerror(errno));
    if (ferror(from)) return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, strerror(errno));
    return STATUS_OK;
}

/* A pipe cannot seek back to the table of chunks: the file is made elsewhere and copied when whole. */
static Status write_through_spool(const char *path, const Image *image, const ExrOptions *options, FILE *stream,
                                  Error *error)
{
    FILE *spool = tmpfile();
    if (!spool) return fail(error, STATUS_OUTPUT, "cannot write '%s': no temporary file: %s", path, strerror(errno));
    Status status = write_stream(path, image, options, spool, error);
    if (status == STATUS_OK) status = copy_stream(path, spool, stream, error);
    fclose(spool);
    return status;
}

Status exr_write(const char *path, const Image *image, const ExrOptions *options, Error *error)
{
    static const ExrOptions defaults = {0};
    if (!options) options = &defaults;
    FileOut out;
    TRY(check_names(path, image, error));
    TRY(file_create(&out, path, error));
    Status status = out.plain ? write_through_spool(path, image, options, out.stream, error)
                              : write_stream(path, image, options, out.stream, error);
    if (status != STATUS_OK) {
        file_abandon(&out);
        return status;
    }
    return file_commit(&out, error);
}

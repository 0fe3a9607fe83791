/* exr.c - EXR files, through OpenEXR's C library. The only file that includes OpenEXR.
 * All reading and writing of bytes goes through our own functions: so a file bears its name only once it is whole,
 * standard input and output work, and every reason comes back as text instead of going to standard error.
 * SPDX-License-Identifier: Apache-2.0 */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <openexr.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/num.h"
#include "image/image.h"

enum {
    MAX_SIDE = 65536,
    MAX_CHANNELS = 1024,
    SHORT_NAME = 31,  /* longer names need the format's long-name flag, which the oldest readers refuse */
    BEST_RATIO = 2000 /* no compressor of the format exceeds it (zlib 1032, PIZ's run lengths about 500) */
};

static const float half_max = 65504.0f;

/* The first reason that the library gave for a failure. */
typedef struct ExrReason {
    char text[512];
} ExrReason;

/* The bytes behind a context. */
typedef struct ExrBytes {
    int file;           /* reading a regular file */
    const char *memory; /* reading something else, whole in memory */
    uint64_t size;      /* of what is read */
    FILE *stream;       /* writing */
    uint64_t position;  /* of stream */
    ExrReason reason;
} ExrBytes;

/* Where this thread's errors go. The library reports on the calling thread, sometimes with the context locked,
 * so that asking the context for its user data would wait for ever. */
static _Thread_local ExrReason *reporting;

/* The library prefixes "path: (EXR_ERR_NAME) ", which our messages say in their own way. */
static void keep_reason(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    ExrReason *reason = reporting;
    if (!reason || reason->text[0]) return;
    const char *text = message ? message : exr_get_default_error_message(code);
    const char *name = strstr(text, "(EXR_ERR_");
    const char *end = name ? strstr(name, ") ") : NULL;
    snprintf(reason->text, sizeof reason->text, "%s", end ? end + 2 : text);
}

static int64_t read_bytes(exr_const_context_t context, void *user_data, void *buffer, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t report)
{
    ExrBytes *bytes = user_data;
    if (offset > bytes->size) offset = bytes->size;
    if (size > bytes->size - offset) size = bytes->size - offset;
    if (bytes->memory) {
        memcpy(buffer, bytes->memory + offset, (size_t)size);
        return (int64_t)size;
    }
    uint64_t done = 0;
    while (done < size) {
        ssize_t n = pread(bytes->file, (char *)buffer + done, (size_t)(size - done), (off_t)(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) {
            (void)report(context, EXR_ERR_READ_IO, "%s", strerror(errno));
            return -1;
        }
        if (n == 0) break;
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

static int64_t size_of_bytes(exr_const_context_t context, void *user_data)
{
    (void)context;
    const ExrBytes *bytes = user_data;
    return (int64_t)bytes->size;
}

static int64_t write_bytes(exr_const_context_t context, void *user_data, const void *buffer, uint64_t size,
                           uint64_t offset, exr_stream_error_func_ptr_t report)
{
    ExrBytes *bytes = user_data;
    if ((offset != bytes->position && fseeko(bytes->stream, (off_t)offset, SEEK_SET) != 0) ||
        fwrite(buffer, 1, (size_t)size, bytes->stream) != size) {
        (void)report(context, EXR_ERR_WRITE_IO, "%s", strerror(errno));
        return -1;
    }
    bytes->position = offset + size;
    return (int64_t)size;
}

/* And sends the thread's errors to bytes, until the caller sets reporting to NULL. */
static exr_context_initializer_t initializer_of(ExrBytes *bytes)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.error_handler_fn = keep_reason;
    initializer.user_data = bytes;
    initializer.read_fn = read_bytes;
    initializer.size_fn = size_of_bytes;
    initializer.write_fn = write_bytes;
    initializer.max_image_width = initializer.max_image_height = MAX_SIDE;
    initializer.max_tile_width = initializer.max_tile_height = MAX_SIDE;
    /* a file cut short is refused at once, not searched for what is left of it */
    initializer.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    reporting = &bytes->reason;
    return initializer;
}

static Status fail_read(const char *path, const ExrBytes *bytes, exr_result_t code, Error *error)
{
    if (code == EXR_ERR_OUT_OF_MEMORY) /* which is also what the library says of sizes that are a lie */
        return fail(error, STATUS_INPUT, "cannot read '%s': the EXR file is damaged or too large for the memory", path);
    return fail(error, STATUS_INPUT, "cannot read '%s': the EXR file is damaged or cut short (%s)", path,
                bytes->reason.text[0] ? bytes->reason.text : exr_get_default_error_message(code));
}

/* --- writing --- */

static Status fail_write(const char *path, const ExrBytes *bytes, exr_result_t code, Error *error)
{
    return fail(error, code == EXR_ERR_OUT_OF_MEMORY ? STATUS_NOMEM : STATUS_OUTPUT, "cannot write '%s': %s", path,
                bytes->reason.text[0] ? bytes->reason.text : exr_get_default_error_message(code));
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

static exr_result_t write_header(exr_context_t context, const Image *image, const ExrOptions *options)
{
    static const float rec709[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
    int part;
    exr_result_t result = exr_set_longname_support(context, needs_long_names(image, options));
    if (result == EXR_ERR_SUCCESS) result = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (result == EXR_ERR_SUCCESS)
        result = exr_initialize_required_attr_simple(context, 0, (int32_t)image->width, (int32_t)image->height,
                                                     EXR_COMPRESSION_ZIPS);
    /* a render's noise compresses to the same size, within 2 %, by every level of ZIP, ZIPS and PIZ; the time differs by up
     * to 2.6 times, and lines that stand alone are many tasks for many threads */
    if (result == EXR_ERR_SUCCESS) result = exr_set_zip_compression_level(context, 0, 1);
    if (result == EXR_ERR_SUCCESS && options->pixel_aspect > 0)
        result = exr_set_pixel_aspect_ratio(context, 0, options->pixel_aspect);
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

/* The chunk that begins with line y; the pipeline is set up by a worker's first. */
static exr_result_t encode_chunk(ExrEncoder *encoder, uint32_t y)
{
    exr_context_t context = encoder->writer->context;
    exr_encode_pipeline_t *pipeline = &encoder->pipeline;
    exr_chunk_info_t chunk;
    exr_result_t result = exr_write_scanline_chunk_info(context, 0, (int)y, &chunk);
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
        ExrReason *before = reporting;
        reporting = &encoder->reason;
        if (writer->n_staged && !encoder->staging)
            encoder->staging = malloc((size_t)writer->lines * image->width * writer->n_staged * sizeof(float));
        if (writer->n_staged && !encoder->staging) {
            result = EXR_ERR_OUT_OF_MEMORY;
        } else {
            stage_lines(writer, y, image->height - y < writer->lines ? image->height - y : writer->lines,
                        encoder->staging);
            result = encode_chunk(encoder, y);
        }
        reporting = before;
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
    exr_context_initializer_t initializer = initializer_of(&bytes);
    exr_context_t context = NULL;
    exr_result_t result = exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &initializer);
    if (result == EXR_ERR_SUCCESS) {
        result = write_header(context, image, options);
        ExrWriter writer = {.context = context, .image = image, .bytes = &bytes, .result = EXR_ERR_SUCCESS};
        if (result == EXR_ERR_SUCCESS) result = write_pixels(&writer, options);
        exr_result_t finished = exr_finish(&context); /* writes the table of chunks */
        if (result == EXR_ERR_SUCCESS) result = finished;
    }
    reporting = NULL;
    if (result != EXR_ERR_SUCCESS) return fail_write(path, &bytes, result, error);
    if (!options->append) return STATUS_OK;
    if (fseeko(stream, 0, SEEK_END) != 0) return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, strerror(errno));
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

/* --- reading --- */

typedef struct ExrFile {
    const char *path;
    exr_context_t context;
    ExrBytes bytes;
    char *memory; /* owned: what came from a pipe */
} ExrFile;

static void close_file(ExrFile *file)
{
    if (file->context) exr_finish(&file->context);
    reporting = NULL;
    if (file->bytes.file >= 0) close(file->bytes.file);
    free(file->memory);
    *file = (ExrFile){.bytes.file = -1};
}

static Status open_bytes(ExrFile *file, Error *error)
{
    struct stat facts;
    if (strcmp(file->path, "-") != 0) {
        file->bytes.file = open(file->path, O_RDONLY | O_CLOEXEC);
        if (file->bytes.file < 0 || fstat(file->bytes.file, &facts) != 0)
            return fail(error, STATUS_INPUT, "cannot read '%s': %s", file->path, strerror(errno));
        if (S_ISDIR(facts.st_mode)) return fail(error, STATUS_INPUT, "cannot read '%s': it is a directory", file->path);
        if (S_ISREG(facts.st_mode)) {
            file->bytes.size = (uint64_t)facts.st_size;
            return STATUS_OK;
        }
        close(file->bytes.file);
        file->bytes.file = -1;
    }
    size_t length;
    TRY(file_read(file->path, 0, &file->memory, &length, error));
    file->bytes.memory = file->memory;
    file->bytes.size = length;
    return STATUS_OK;
}

/* Opens and reads the header. close_file(file) in any case. */
static Status open_file(const char *path, ExrFile *file, Error *error)
{
    *file = (ExrFile){.path = path, .bytes.file = -1};
    TRY(open_bytes(file, error));
    if (file->bytes.size == 0) return fail(error, STATUS_INPUT, "cannot read '%s': the file is empty", path);
    char magic[4] = {0};
    if (read_bytes(NULL, &file->bytes, magic, sizeof magic, 0, NULL) != sizeof magic ||
        memcmp(magic, "\x76\x2f\x31\x01", sizeof magic) != 0)
        return fail(error, STATUS_INPUT, "cannot read '%s': it is not an EXR file", path);
    exr_context_initializer_t initializer = initializer_of(&file->bytes);
    exr_result_t result = exr_start_read(&file->context, path, &initializer);
    if (result != EXR_ERR_SUCCESS) return fail_read(path, &file->bytes, result, error);
    return STATUS_OK;
}

/* What the first part is, as far as reading it needs. Windows are inclusive. */
typedef struct ExrPart {
    exr_storage_t storage;
    exr_compression_t compression;
    exr_attr_box2i_t data, display;
    const exr_attr_chlist_t *channels;
} ExrPart;

static Status check_part(const ExrFile *file, const ExrPart *part, Error *error)
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
    const exr_attr_box2i_t *windows[2] = {&part->data, &part->display};
    for (int i = 0; i < 2; i++) {
        double width = (double)windows[i]->max.x - windows[i]->min.x + 1;
        double height = (double)windows[i]->max.y - windows[i]->min.y + 1;
        if (!(width >= 1 && width <= MAX_SIDE && height >= 1 && height <= MAX_SIDE))
            return fail(error, STATUS_INPUT, "cannot read '%s': its header says %.0f x %.0f pixels; the limit is %d",
                        file->path, width, height, MAX_SIDE);
        /* before memory is asked for: a header can lie, and a small file cannot hold a huge picture */
        if (width * height * pixel_bytes > 1e6 + BEST_RATIO * (double)file->bytes.size)
            return fail(error, STATUS_INPUT,
                        "cannot read '%s': its header says %.0f x %.0f pixels, for which the file is too short",
                        file->path, width, height);
    }
    return STATUS_OK;
}

static Status describe_part(const ExrFile *file, ExrPart *part, Error *error)
{
    exr_result_t result = exr_get_storage(file->context, 0, &part->storage);
    if (result == EXR_ERR_SUCCESS) result = exr_get_compression(file->context, 0, &part->compression);
    if (result == EXR_ERR_SUCCESS) result = exr_get_data_window(file->context, 0, &part->data);
    if (result == EXR_ERR_SUCCESS) result = exr_get_display_window(file->context, 0, &part->display);
    if (result == EXR_ERR_SUCCESS) result = exr_get_channels(file->context, 0, &part->channels);
    if (result != EXR_ERR_SUCCESS) return fail_read(file->path, &file->bytes, result, error);
    return check_part(file, part, error);
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

/* Staging, whose first pixel is (x, y) of the file's coordinates, to where it lies in the display window. */
static void place_chunk(const ExrDecoder *decoder, int64_t x, int64_t y, int32_t width, int32_t height)
{
    Image *image = decoder->image;
    x -= decoder->part->display.min.x;
    y -= decoder->part->display.min.y;
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

static Status image_for_part(const ExrPart *part, Image *image, Error *error)
{
    const char *names[MAX_CHANNELS];
    for (int c = 0; c < part->channels->num_channels; c++) names[c] = part->channels->entries[c].name.str;
    return image_new((uint32_t)(part->display.max.x - part->display.min.x + 1),
                     (uint32_t)(part->display.max.y - part->display.min.y + 1), names,
                     (uint32_t)part->channels->num_channels, image, error);
}

static Status read_open_file(const ExrFile *file, Image *image, Error *error)
{
    ExrPart part;
    TRY(describe_part(file, &part, error));
    exr_result_t result = find_last_chunk(file, &part);
    if (result != EXR_ERR_SUCCESS) return fail_read(file->path, &file->bytes, result, error);
    TRY(image_for_part(&part, image, error));
    ExrDecoder decoder = {.file = file, .part = &part, .image = image};
    result = part.storage == EXR_STORAGE_TILED ? decode_tiles(&decoder) : decode_lines(&decoder);
    exr_decoding_destroy(file->context, &decoder.pipeline);
    free(decoder.staging);
    if (result == EXR_ERR_SUCCESS) return STATUS_OK;
    image_clear(image);
    return fail_read(file->path, &file->bytes, result, error);
}

Status exr_read(const char *path, Image *image, Error *error)
{
    *image = (Image){0};
    ExrFile file;
    Status status = open_file(path, &file, error);
    if (status == STATUS_OK) status = read_open_file(&file, image, error);
    close_file(&file);
    return status;
}

/* --- attributes --- */

/* The shortest text that reads back as the same float: 0.1, not 0.100000001. */
static void print_floats(Buf *text, const float *numbers, int n)
{
    for (int i = 0; i < n; i++) {
        char digits[40];
        double value = 0;
        for (int precision = 6; precision <= 9; precision++) {
            int length = snprintf(digits, sizeof digits, "%.*g", precision, (double)numbers[i]);
            if (num_parse(digits, (size_t)length, &value) && (float)value == numbers[i]) break;
        }
        buf_format(text, "%s%s", i ? " " : "", digits);
    }
}

static void print_doubles(Buf *text, const double *numbers, int n)
{
    char digits[NUM_TEXT_SIZE];
    for (int i = 0; i < n; i++) {
        num_print(numbers[i], digits);
        buf_format(text, "%s%s", i ? " " : "", digits);
    }
}

static void print_channels(Buf *text, const exr_attr_chlist_t *channels)
{
    static const char *const types[] = {"uint", "half", "float"};
    for (int i = 0; i < channels->num_channels; i++) {
        const exr_attr_chlist_entry_t *channel = &channels->entries[i];
        buf_format(text, "%s%s %s", i ? ", " : "", channel->name.str,
                   (unsigned)channel->pixel_type < COUNT_OF(types) ? types[channel->pixel_type] : "unknown");
    }
}

static const char *enumerated(unsigned value, const char *const *names, size_t n)
{
    return value < n ? names[value] : "unknown";
}

/* The compound types; false for those that have no short text. */
static bool print_compound(Buf *text, const exr_attribute_t *attribute)
{
    switch (attribute->type) {
    case EXR_ATTR_BOX2I:
        buf_format(text, "%ld %ld  %ld %ld", (long)attribute->box2i->min.x, (long)attribute->box2i->min.y,
                   (long)attribute->box2i->max.x, (long)attribute->box2i->max.y);
        return true;
    case EXR_ATTR_BOX2F:
        print_floats(text, attribute->box2f->min.arr, 2);
        buf_add(text, "  ");
        print_floats(text, attribute->box2f->max.arr, 2);
        return true;
    case EXR_ATTR_CHLIST: print_channels(text, attribute->chlist); return true;
    case EXR_ATTR_CHROMATICITIES: {
        const exr_attr_chromaticities_t *c = attribute->chromaticities;
        const float xy[8] = {c->red_x, c->red_y, c->green_x, c->green_y, c->blue_x, c->blue_y, c->white_x, c->white_y};
        print_floats(text, xy, 8);
        return true;
    }
    case EXR_ATTR_V2I: buf_format(text, "%ld %ld", (long)attribute->v2i->x, (long)attribute->v2i->y); return true;
    case EXR_ATTR_V3I:
        buf_format(text, "%ld %ld %ld", (long)attribute->v3i->x, (long)attribute->v3i->y, (long)attribute->v3i->z);
        return true;
    case EXR_ATTR_V2F: print_floats(text, attribute->v2f->arr, 2); return true;
    case EXR_ATTR_V3F: print_floats(text, attribute->v3f->arr, 3); return true;
    case EXR_ATTR_V2D: print_doubles(text, attribute->v2d->arr, 2); return true;
    case EXR_ATTR_V3D: print_doubles(text, attribute->v3d->arr, 3); return true;
    case EXR_ATTR_M33F: print_floats(text, attribute->m33f->m, 9); return true;
    case EXR_ATTR_M44F: print_floats(text, attribute->m44f->m, 16); return true;
    case EXR_ATTR_RATIONAL:
        buf_format(text, "%ld/%lu", (long)attribute->rational->num, (unsigned long)attribute->rational->denom);
        return true;
    default: return false;
    }
}

static void print_attribute(Buf *text, const exr_attribute_t *attribute)
{
    static const char *const compressions[] = {"none",  "rle", "zips", "zip",  "piz",
                                               "pxr24", "b44", "b44a", "dwaa", "dwab"};
    static const char *const orders[] = {"increasing y", "decreasing y", "random"};
    static const char *const maps[] = {"latlong", "cube"};
    switch (attribute->type) {
    case EXR_ATTR_STRING:
        if (attribute->string->length > 0)
            buf_add_bytes(text, attribute->string->str, (size_t)attribute->string->length);
        return;
    case EXR_ATTR_INT: buf_format(text, "%ld", (long)attribute->i); return;
    case EXR_ATTR_FLOAT: print_floats(text, &attribute->f, 1); return;
    case EXR_ATTR_DOUBLE: print_doubles(text, &attribute->d, 1); return;
    case EXR_ATTR_COMPRESSION: buf_add(text, enumerated(attribute->uc, compressions, COUNT_OF(compressions))); return;
    case EXR_ATTR_LINEORDER: buf_add(text, enumerated(attribute->uc, orders, COUNT_OF(orders))); return;
    case EXR_ATTR_ENVMAP: buf_add(text, enumerated(attribute->uc, maps, COUNT_OF(maps))); return;
    default:
        if (!print_compound(text, attribute)) buf_format(text, "(%s)", attribute->type_name);
        return;
    }
}

static bool has_text(const exr_attribute_t *attribute)
{
    return attribute->type == EXR_ATTR_STRING || attribute->type == EXR_ATTR_INT || attribute->type == EXR_ATTR_FLOAT ||
           attribute->type == EXR_ATTR_DOUBLE;
}

Status exr_read_attribute(const char *path, const char *name, char **text, Error *error)
{
    *text = NULL;
    ExrFile file;
    Status status = open_file(path, &file, error);
    const exr_attribute_t *attribute;
    if (status == STATUS_OK && exr_get_attribute_by_name(file.context, 0, name, &attribute) == EXR_ERR_SUCCESS &&
        has_text(attribute)) {
        Buf buf = {0};
        buf_add(&buf, ""); /* an empty text is not the same as none */
        print_attribute(&buf, attribute);
        if (buf.failed) {
            buf_clear(&buf);
            status = fail_memory(error, buf.capacity, "an attribute");
        }
        *text = buf.text;
    }
    close_file(&file);
    return status;
}

Status exr_visit_attributes(const char *path, void (*visit)(void *context, const char *name, const char *text),
                            void *context, Error *error)
{
    ExrFile file;
    Status status = open_file(path, &file, error);
    int32_t n = 0;
    if (status == STATUS_OK && exr_get_attribute_count(file.context, 0, &n) != EXR_ERR_SUCCESS) n = 0;
    for (int32_t i = 0; status == STATUS_OK && i < n; i++) {
        const exr_attribute_t *attribute;
        if (exr_get_attribute_by_index(file.context, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute) != EXR_ERR_SUCCESS)
            continue;
        Buf buf = {0};
        print_attribute(&buf, attribute);
        if (buf.failed)
            status = fail_memory(error, buf.capacity, "an attribute");
        else
            visit(context, attribute->name, buf_text(&buf));
        buf_clear(&buf);
    }
    close_file(&file);
    return status;
}

/* exr_test.c - EXR files: what is written reads back, other programs' files read, and a failure harms nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <openexr.h> /* to write what other programs do and we do not */

#include "base/file.h"
#include "image/image.h"
#include "temporary.h"

/* A picture of every kind of number, with more channels than the library's small stash. */
static Image sample_image(uint32_t width, uint32_t height)
{
    static const char *const names[] = {"R",         "G", "B", "A", "N.X", "a channel with quite a long name, over 31",
                                        "variance.R"};
    Image image;
    Error error;
    assert_int_equal(image_new(width, height, names, COUNT_OF(names), &image, &error), STATUS_OK);
    for (size_t i = 0; i < (size_t)width * height * image.n_channels; i++)
        image.pixels[i] = ldexpf((float)(i * 2654435761U % 100003) - 50000, (int)(i % 31) - 20);
    image.pixels[4] = 1e30f;
    image.pixels[5] = -INFINITY;
    image.pixels[6] = 0x1p-149f;
    return image;
}

static void assert_same_image(const Image *a, const Image *b)
{
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->n_channels, b->n_channels);
    size_t n_pixels = (size_t)a->width * a->height;
    for (uint32_t c = 0; c < a->n_channels; c++) {
        int other = image_channel(b, a->names[c]);
        assert_true(other >= 0);
        for (size_t i = 0; i < n_pixels; i++)
            assert_memory_equal(a->pixels + i * a->n_channels + c, b->pixels + i * b->n_channels + (uint32_t)other,
                                sizeof(float));
    }
}

static void floats_come_back_bit_for_bit(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {7, 3}, {33, 100}, {300, 17}};
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        Error error = {0};
        Image image = sample_image(sizes[i][0], sizes[i][1]), again;
        assert_int_equal(exr_write(in_folder("float.exr"), &image, NULL, &error), STATUS_OK);
        assert_int_equal(exr_read(in_folder("float.exr"), &again, &error), STATUS_OK);
        assert_same_image(&image, &again);
        image_clear(&again);
        image_clear(&image);
    }
}

static void not_a_number_comes_back(void **state)
{
    (void)state;
    static const char *const names[] = {"id"};
    Error error;
    Image image, again;
    assert_int_equal(image_new(5, 1, names, 1, &image, &error), STATUS_OK);
    image.pixels[2] = NAN;
    assert_int_equal(exr_write(in_folder("nan.exr"), &image, NULL, &error), STATUS_OK);
    assert_int_equal(exr_read(in_folder("nan.exr"), &again, &error), STATUS_OK);
    assert_true(isnan(again.pixels[2]));
    assert_true(again.pixels[1] == 0);
    image_clear(&again);
    image_clear(&image);
}

/* Among them are chunks that compression makes exactly as long as they were; OpenEXR 3.1 by itself writes some of
 * these so that none can read them. */
static void small_pictures_come_back(void **state)
{
    (void)state;
    static const char *const names[] = {"Y", "id"};
    Error error = {0};
    for (uint32_t width = 1; width <= 40; width += 4)
        for (uint32_t kind = 0; kind < 8; kind++) {
            Image image, again;
            assert_int_equal(image_new(width, 1 + kind % 3, names, 1 + kind % 2, &image, &error), STATUS_OK);
            size_t n = (size_t)width * (1 + kind % 3) * (1 + kind % 2);
            for (size_t i = 0; i < n; i += 1 + kind / 2) image.pixels[i] = (float)(i * 7919 % 1000) / 17;
            assert_int_equal(exr_write(in_folder("small.exr"), &image, NULL, &error), STATUS_OK);
            assert_int_equal(exr_read(in_folder("small.exr"), &again, &error), STATUS_OK);
            assert_same_image(&image, &again);
            image_clear(&again);
            image_clear(&image);
        }
}

static void half_rounds_colors_only(void **state)
{
    (void)state;
    Error error = {0};
    Image image = sample_image(50, 70), again;
    for (size_t i = 0; i < (size_t)50 * 70; i++)
        for (int c = 0; c < 4; c++) image.pixels[i * image.n_channels + (size_t)c] = (float)(i + 1) * 0.01f;
    image.pixels[0] = 1e6f; /* a lamp: held, not infinite */
    ExrOptions options = {.half = true};
    assert_int_equal(exr_write(in_folder("half.exr"), &image, &options, &error), STATUS_OK);
    assert_int_equal(exr_read(in_folder("half.exr"), &again, &error), STATUS_OK);
    int red = image_channel(&again, "R"), variance = image_channel(&again, "variance.R");
    assert_true(again.pixels[red] == 65504);
    for (size_t i = 1; i < (size_t)50 * 70; i++) {
        float a = image.pixels[i * image.n_channels], b = again.pixels[i * again.n_channels + (size_t)red];
        assert_true(fabsf(a - b) <= a * 4.9e-4f);
        assert_memory_equal(image.pixels + i * image.n_channels + 6,
                            again.pixels + i * again.n_channels + (size_t)variance, sizeof(float));
    }
    image_clear(&again);
    image_clear(&image);
}

/* Files of one to four channels, all of them half: libraries have ways of their own for these. */
static void halfs_alone_stay_in_order(void **state)
{
    (void)state;
    static const char *const names[] = {"R", "G", "B", "A"};
    for (uint32_t n = 1; n <= 4; n++)
        for (uint32_t width = 5; width <= 41; width += 9) {
            Error error = {0};
            Image image, again;
            ExrOptions options = {.half = true};
            assert_int_equal(image_new(width, 37, names, n, &image, &error), STATUS_OK);
            for (uint32_t i = 0; i < width * 37 * n; i++) image.pixels[i] = (float)(i % 2039);
            assert_int_equal(exr_write(in_folder("halfs.exr"), &image, &options, &error), STATUS_OK);
            assert_int_equal(exr_read(in_folder("halfs.exr"), &again, &error), STATUS_OK);
            assert_int_equal(again.n_channels, n);
            for (uint32_t c = 0; c < n; c++) {
                int channel = image_channel(&again, names[c]);
                assert_true(channel >= 0);
                for (uint32_t i = 0; i < width * 37; i++)
                    assert_true(again.pixels[i * n + (uint32_t)channel] == image.pixels[i * n + c]);
            }
            image_clear(&again);
            image_clear(&image);
        }
}

static void assert_attribute(const char *path, const char *name, const char *expected)
{
    Error error = {0};
    char *text = NULL;
    assert_int_equal(exr_read_attribute(path, name, &text, &error), STATUS_OK);
    if (!expected) {
        assert_null(text);
    } else {
        assert_non_null(text);
        assert_string_equal(text, expected);
    }
    free(text);
}

static void count_attribute(void *context, const char *name, const char *text)
{
    int *found = context;
    if (strcmp(name, "compression") == 0) assert_string_equal(text, "zips");
    if (strcmp(name, "dataWindow") == 0) assert_string_equal(text, "0 0  3 1");
    if (strcmp(name, "chromaticities") == 0) assert_string_equal(text, "0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329");
    if (strcmp(name, "channels") == 0) assert_non_null(strstr(text, "B half, G half, N.X float"));
    ++*found;
}

static void attributes_come_back(void **state)
{
    (void)state;
    static char manifest[100000];
    memset(manifest, 'm', sizeof manifest - 1);
    const ImageAttribute attributes[] = {
        {.name = "meniscus/scene", .type = ATTRIBUTE_TEXT, .text = "glass \"élan\"\nline two"},
        {.name = "meniscus/empty", .type = ATTRIBUTE_TEXT, .text = ""},
        {.name = "meniscus/manifest of a great many objects, long", .type = ATTRIBUTE_TEXT, .text = manifest},
        {.name = "meniscus/samples", .type = ATTRIBUTE_INT, .whole = -7},
        {.name = "meniscus/noise", .type = ATTRIBUTE_FLOAT, .number = 0.1},
        {.name = "expTime", .type = ATTRIBUTE_FLOAT, .number = 0.02},
    };
    ExrOptions options = {
        .half = true, .attributes = attributes, .n_attributes = COUNT_OF(attributes), .pixel_aspect = 2};
    Error error = {0};
    Image image = sample_image(4, 2);
    const char *path = in_folder("attributes.exr");
    assert_int_equal(exr_write(path, &image, &options, &error), STATUS_OK);
    image_clear(&image);
    for (size_t i = 0; i < 3; i++) assert_attribute(path, attributes[i].name, attributes[i].text);
    assert_attribute(path, "meniscus/samples", "-7");
    assert_attribute(path, "meniscus/noise", "0.1");
    assert_attribute(path, "expTime", "0.02");
    assert_attribute(path, "pixelAspectRatio", "2");
    assert_attribute(path, "absent", NULL);
    assert_attribute(path, "channels", NULL);
    int found = 0;
    assert_int_equal(exr_visit_attributes(path, count_attribute, &found, &error), STATUS_OK);
    assert_true(found >= 14);
}

static void bad_attributes_and_names_are_refused(void **state)
{
    (void)state;
    Error error = {0};
    Image image = sample_image(4, 2);
    memcpy(image.names[1], "R", 2);
    assert_int_equal(exr_write(in_folder("twice.exr"), &image, NULL, &error), STATUS_OUTPUT);
    assert_non_null(strstr(error.text, "twice.exr"));
    assert_false(file_exists(in_folder("twice.exr")));
    image_clear(&image);
}

/* Number of files in the folder whose name starts with prefix. */
static int count_files(const char *prefix)
{
    char command[400];
    snprintf(command, sizeof command, "ls '%s' | grep -c '^%s'", folder, prefix);
    FILE *pipe = popen(command, "r");
    int n = -1;
    assert_int_equal(fscanf(pipe, "%d", &n), 1);
    pclose(pipe);
    return n;
}

static void a_failed_write_leaves_the_old_file(void **state)
{
    (void)state;
    Error error = {0};
    Image good = sample_image(20, 20), bad = sample_image(20, 20), again;
    const char *path = in_folder("old.exr");
    assert_int_equal(exr_write(path, &good, NULL, &error), STATUS_OK);
    memcpy(bad.names[1], "R", 2); /* fails after the file was begun */
    assert_int_equal(exr_write(path, &bad, NULL, &error), STATUS_OUTPUT);
    assert_int_equal(exr_read(path, &again, &error), STATUS_OK);
    assert_same_image(&good, &again);
    assert_int_equal(count_files("old.exr"), 1); /* and no temporary file */
    image_clear(&again);
    image_clear(&bad);
    image_clear(&good);
}

static void full_disks_and_missing_folders_are_reported(void **state)
{
    (void)state;
    Image image = sample_image(200, 200);
    Error error = {0};
    assert_int_equal(exr_write("/dev/full", &image, NULL, &error), STATUS_OUTPUT);
    assert_non_null(strstr(error.text, "/dev/full"));
    assert_non_null(strstr(error.text, "No space"));
    write_bytes(in_folder("file"), "x", 1);
    assert_int_equal(exr_write(in_folder("file/below.exr"), &image, NULL, &error), STATUS_OUTPUT);
    assert_non_null(strstr(error.text, "Not a directory"));
    assert_int_equal(exr_write(in_folder("absent/below.exr"), &image, NULL, &error), STATUS_OUTPUT);
    image_clear(&image);
}

/* The file is the same byte for byte, whoever compresses its lines; also one with fewer lines than threads. */
static void threads_write_the_same_file(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {40, 3}, {123, 200}};
    for (size_t i = 0; i < COUNT_OF(sizes); i++)
        for (int half = 0; half < 2; half++) {
            Error error = {0};
            Image image = sample_image(sizes[i][0], sizes[i][1]);
            ExrOptions options = {.half = half};
            size_t length, length_again;
            char *bytes, *again;
            assert_int_equal(exr_write(in_folder("one.exr"), &image, &options, &error), STATUS_OK);
            assert_int_equal(file_read(in_folder("one.exr"), 0, &bytes, &length, &error), STATUS_OK);
            for (unsigned n = 1; n <= 7; n += 2) {
                assert_int_equal(pool_new(n, &options.pool, &error), STATUS_OK);
                assert_int_equal(exr_write(in_folder("many.exr"), &image, &options, &error), STATUS_OK);
                pool_free(options.pool);
                assert_int_equal(file_read(in_folder("many.exr"), 0, &again, &length_again, &error), STATUS_OK);
                assert_int_equal(length, length_again);
                assert_memory_equal(bytes, again, length);
                free(again);
            }
            free(bytes);
            image_clear(&image);
        }
}

/* Wherever in a file the disk is full, the reason is told, and what stood there before stays. */
static void a_disk_that_fills_up_harms_nothing(void **state)
{
    (void)state;
    Error error = {0};
    Image image = sample_image(300, 150), old = sample_image(9, 9), again;
    const char *path = in_folder("fills.exr");
    struct rlimit limit, small;
    ExrOptions options = {0};
    assert_int_equal(exr_write(path, &old, NULL, &error), STATUS_OK);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    signal(SIGXFSZ, SIG_IGN);
    for (unsigned n = 1; n <= 4; n += 3) {
        assert_int_equal(pool_new(n, &options.pool, &error), STATUS_OK);
        for (rlim_t bytes = 0; bytes < 600000; bytes += 150001) {
            small = limit;
            small.rlim_cur = bytes;
            error = (Error){0};
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
            Status status = exr_write(path, &image, &options, &error);
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
            assert_int_equal(status, STATUS_OUTPUT);
            assert_non_null(strstr(error.text, "fills.exr"));
            assert_non_null(strstr(error.text, strerror(EFBIG)));
            assert_int_equal(count_files("fills.exr"), 1); /* and no temporary file */
        }
        assert_int_equal(exr_write("/dev/full", &image, &options, &error), STATUS_OUTPUT);
        assert_non_null(strstr(error.text, "No space"));
        pool_free(options.pool);
    }
    assert_int_equal(exr_read(path, &again, &error), STATUS_OK);
    assert_same_image(&old, &again);
    image_clear(&again);
    image_clear(&old);
    image_clear(&image);
}

static void standard_output_is_a_whole_file(void **state)
{
    (void)state;
    Error error = {0};
    Image image = sample_image(40, 40), again;
    fflush(stdout);
    int kept = dup(STDOUT_FILENO);
    char command[300];
    snprintf(command, sizeof command, "cat > '%s'", in_folder("stdout.exr"));
    FILE *pipe = popen(command, "w"); /* a pipe cannot seek */
    dup2(fileno(pipe), STDOUT_FILENO);
    Status status = exr_write("-", &image, NULL, &error);
    fflush(stdout);
    dup2(kept, STDOUT_FILENO);
    close(kept);
    pclose(pipe);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(exr_read(in_folder("stdout.exr"), &again, &error), STATUS_OK);
    assert_same_image(&image, &again);
    image_clear(&again);
    image_clear(&image);
}

/* A part of a picture is read as such, and as the whole, which is 0 beyond it. */
static void a_part_lies_in_its_picture(void **state)
{
    (void)state;
    enum { X = 7, Y = 2, WIDTH = 5, HEIGHT = 3, WHOLE_WIDTH = 20, WHOLE_HEIGHT = 11 };
    static const char *const names[] = {"G", "R"};
    const ImagePlace place = {X, Y, WHOLE_WIDTH, WHOLE_HEIGHT};
    const char *path = in_folder("part.exr");
    Image part, whole, expanded;
    ImagePlace found;
    Error error;
    assert_int_equal(image_new(WIDTH, HEIGHT, names, 2, &part, &error), STATUS_OK);
    for (uint32_t i = 0; i < 2 * WIDTH * HEIGHT; i++) part.pixels[i] = (float)i + 1;
    assert_int_equal(exr_write(path, &part, &(ExrOptions){.place = &place}, &error), STATUS_OK);
    assert_int_equal(exr_read_part(path, &expanded, &found, &error), STATUS_OK);
    assert_memory_equal(&found, &place, sizeof place);
    assert_true(expanded.width == WIDTH && expanded.height == HEIGHT);
    assert_memory_equal(expanded.pixels, part.pixels, sizeof(float) * 2 * WIDTH * HEIGHT);
    assert_int_equal(exr_read(path, &whole, &error), STATUS_OK);
    assert_true(whole.width == WHOLE_WIDTH && whole.height == WHOLE_HEIGHT);
    for (uint32_t y = 0; y < WHOLE_HEIGHT; y++)
        for (uint32_t x = 0; x < WHOLE_WIDTH; x++) {
            bool inside = x >= X && x < X + WIDTH && y >= Y && y < Y + HEIGHT;
            float expected = inside ? *image_at(&part, x - X, y - Y) : 0;
            assert_true(*image_at(&whole, x, y) == expected);
        }
    assert_int_equal(image_expand(&expanded, &place, &error), STATUS_OK);
    assert_memory_equal(expanded.pixels, whole.pixels, sizeof(float) * 2 * WHOLE_WIDTH * WHOLE_HEIGHT);
    image_clear(&expanded);
    image_clear(&whole);
    const ImagePlace beyond = {WHOLE_WIDTH + X, Y, WHOLE_WIDTH, WHOLE_HEIGHT};
    assert_int_equal(exr_write(path, &part, &(ExrOptions){.place = &beyond}, &error), STATUS_OK);
    assert_int_equal(exr_read_part(path, &expanded, &found, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "outside of its picture"));
    image_clear(&part);
}

/* A tiled file of uint "id" = 1000 x + y and half "R" = x / 64, whose
 * data window begins at (-3, 2) and whose display window is 20 x 10 from the origin. */
static void write_tiles(const char *path, exr_compression_t compression)
{
    enum { WIDTH = 30, HEIGHT = 13, TILE = 8 };
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t file;
    int part;
    exr_attr_box2i_t data = {{{{-3, 2}}}, {{{-3 + WIDTH - 1, 2 + HEIGHT - 1}}}}, display = {{{{0, 0}}}, {{{19, 9}}}};
    exr_attr_v2f_t center = {{{0, 0}}};
    assert_int_equal(exr_start_write(&file, path, EXR_WRITE_FILE_DIRECTLY, &initializer), 0);
    assert_int_equal(exr_add_part(file, "tiles", EXR_STORAGE_TILED, &part), 0);
    assert_int_equal(
        exr_initialize_required_attr(file, 0, &display, &data, 1, &center, 1, EXR_LINEORDER_INCREASING_Y, compression),
        0);
    assert_int_equal(exr_set_tile_descriptor(file, 0, TILE, TILE, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN), 0);
    assert_int_equal(exr_add_channel(file, 0, "id", EXR_PIXEL_UINT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1), 0);
    assert_int_equal(exr_add_channel(file, 0, "R", EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1), 0);
    assert_int_equal(exr_write_header(file), 0);
    for (int row = 0; row * TILE < HEIGHT; row++)
        for (int column = 0; column * TILE < WIDTH; column++) {
            uint32_t ids[TILE * TILE];
            float reds[TILE * TILE];
            for (int i = 0; i < TILE * TILE; i++) {
                int x = column * TILE + i % TILE - 3, y = row * TILE + i / TILE + 2;
                ids[i] = (uint32_t)(1000 * (x + 3) + y);
                reds[i] = (float)x / 64;
            }
            exr_chunk_info_t chunk;
            exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
            assert_int_equal(exr_write_tile_chunk_info(file, 0, column, row, 0, 0, &chunk), 0);
            assert_int_equal(exr_encoding_initialize(file, 0, &chunk, &pipeline), 0);
            for (int c = 0; c < 2; c++) {
                bool id = strcmp(pipeline.channels[c].channel_name, "id") == 0;
                pipeline.channels[c].user_data_type = id ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
                pipeline.channels[c].user_bytes_per_element = 4;
                pipeline.channels[c].user_pixel_stride = 4;
                pipeline.channels[c].user_line_stride = 4 * TILE;
                pipeline.channels[c].encode_from_ptr = id ? (const uint8_t *)ids : (const uint8_t *)reds;
            }
            assert_int_equal(exr_encoding_choose_default_routines(file, 0, &pipeline), 0);
            assert_int_equal(exr_encoding_run(file, 0, &pipeline), 0);
            exr_encoding_destroy(file, &pipeline);
        }
    assert_int_equal(exr_finish(&file), 0);
}

static void tiles_and_windows_are_read(void **state)
{
    (void)state;
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_ZIP, EXR_COMPRESSION_PIZ};
    for (size_t i = 0; i < COUNT_OF(compressions); i++) {
        Image image;
        Error error = {0};
        write_tiles(in_folder("tiles.exr"), compressions[i]);
        if (image_read(in_folder("tiles.exr"), &image, &error) != STATUS_OK) fail_msg("%s", error.text);
        assert_true(image.width == 20 && image.height == 10 && image.n_channels == 2);
        int id = image_channel(&image, "id"), red = image_channel(&image, "R");
        for (int y = 0; y < 10; y++)
            for (int x = 0; x < 20; x++) {
                const float *pixel = image.pixels + 2 * (20 * y + x);
                assert_true(pixel[id] == (float)(y < 2 ? 0 : 1000 * (x + 3) + y));
                assert_true(pixel[red] == (y < 2 ? 0 : (float)x / 64));
            }
        image_clear(&image);
    }
}

static void colors_are_found(void **state)
{
    (void)state;
    static const char *const plain[] = {"A", "B", "G", "R"}, *const layer[] = {"Z", "view.B", "view.G", "view.R"},
                             *const grey[] = {"A", "Y", "id", "x"}, *const none[] = {"A", "u", "v", "R"};
    static const struct {
        const char *const *names;
        bool found;
        int rgb[3];
    } cases[] = {{plain, true, {3, 2, 1}}, {layer, true, {3, 2, 1}}, {grey, true, {1, 1, 1}}, {none, false, {0}}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Image image;
        Error error;
        int rgb[3];
        assert_int_equal(image_new(1, 1, cases[i].names, 4, &image, &error), STATUS_OK);
        assert_true(image_rgb(&image, rgb) == cases[i].found);
        if (cases[i].found) assert_memory_equal(rgb, cases[i].rgb, sizeof rgb);
        image_clear(&image);
    }
}

static void sizes_outside_the_limits_are_refused(void **state)
{
    (void)state;
    static const char *const names[] = {"R"}, *const empty[] = {""},
                             *const endless[] = {"a name of more than the sixty-three bytes that there is room for"};
    Image image;
    Error error;
    assert_int_equal(image_new(0, 1, names, 1, &image, &error), STATUS_NOMEM);
    assert_int_equal(image_new(1, 65537, names, 1, &image, &error), STATUS_NOMEM);
    assert_int_equal(image_new(1, 1, names, 0, &image, &error), STATUS_NOMEM);
    assert_int_equal(image_new(1, 1, empty, 1, &image, &error), STATUS_INPUT);
    assert_int_equal(image_new(1, 1, endless, 1, &image, &error), STATUS_INPUT);
    assert_null(image.pixels);
}

static void assert_refused(const char *path, const char *fragment)
{
    Image image;
    Error error = {0};
    assert_int_equal(image_read(path, &image, &error), STATUS_INPUT);
    assert_null(image.pixels);
    assert_non_null(strstr(error.text, path));
    assert_null(strchr(error.text, '\n'));
    if (!strstr(error.text, fragment)) fail_msg("'%s' lacks '%s'", error.text, fragment);
}

static void what_is_no_picture_is_refused(void **state)
{
    (void)state;
    assert_refused(folder, "directory");
    assert_refused(in_folder("nothing.exr"), "No such file");
    write_bytes(in_folder("empty.exr"), "", 0);
    assert_refused(in_folder("empty.exr"), "empty");
    write_bytes(in_folder("text.exr"), "hello, world, this is text", 26);
    assert_refused(in_folder("text.exr"), "not an EXR");
    write_bytes(in_folder("text.gif"), "hello, world", 12);
    assert_refused(in_folder("text.gif"), "neither an EXR nor a PNG");
    write_bytes(in_folder("magic.exr"), "\x76\x2f\x31\x01\x02\0\0\0", 8);
    assert_refused(in_folder("magic.exr"), "damaged or cut short");
}

static void see_nothing(void *context, const char *name, const char *text)
{
    (void)context, (void)name, (void)text;
}

/* Every length of a small file, and every byte of it spoilt in turn: a status, never a crash. */
static void damaged_files_are_refused_or_read(void **state)
{
    (void)state;
    Error error = {0};
    Image image = sample_image(9, 40), again;
    const char *whole = in_folder("whole.exr");
    char *bytes;
    size_t length;
    assert_int_equal(exr_write(whole, &image, NULL, &error), STATUS_OK);
    image_clear(&image);
    assert_int_equal(file_read(whole, 0, &bytes, &length, &error), STATUS_OK);
    for (size_t n = 0; n < length; n += n < 600 ? 1 : 97) {
        write_bytes(in_folder("cut.exr"), bytes, n);
        assert_int_equal(image_read(in_folder("cut.exr"), &again, &error), STATUS_INPUT);
        assert_int_equal(exr_visit_attributes(in_folder("cut.exr"), see_nothing, NULL, &error), STATUS_INPUT);
    }
    for (size_t i = 4; i < length; i += i < 900 ? 1 : 53) {
        char kept = bytes[i];
        bytes[i] = (char)(kept ^ (i % 2 ? 0x7f : 0xff));
        write_bytes(in_folder("spoilt.exr"), bytes, length);
        bytes[i] = kept;
        Status status = image_read(in_folder("spoilt.exr"), &again, &error);
        assert_true(status == STATUS_OK || status == STATUS_INPUT || status == STATUS_NOMEM);
        image_clear(&again);
    }
    free(bytes);
}

/* Another size in the header of a small file must not be believed. */
static void a_lying_header_is_refused(void **state)
{
    (void)state;
    Error error = {0};
    Image image = sample_image(9, 9);
    const char *whole = in_folder("honest.exr");
    char *bytes;
    size_t length;
    assert_int_equal(exr_write(whole, &image, NULL, &error), STATUS_OK);
    image_clear(&image);
    assert_int_equal(file_read(whole, 0, &bytes, &length, &error), STATUS_OK);
    static const char *const windows[] = {"dataWindow", "displayWindow"};
    static const int32_t sizes[] = {60000, 2000000000};
    for (size_t s = 0; s < COUNT_OF(sizes); s++) {
        char *copy = malloc(length);
        memcpy(copy, bytes, length);
        for (size_t w = 0; w < 2; w++)
            for (size_t i = 0; i + 40 < length; i++)
                if (memcmp(copy + i, windows[w], strlen(windows[w]) + 1) == 0) {
                    char *box = copy + i + strlen(windows[w]) + 1 + sizeof "box2i" + 4;
                    memcpy(box + 8, &sizes[s], 4);
                    memcpy(box + 12, &sizes[s], 4);
                }
        write_bytes(in_folder("lie.exr"), copy, length);
        assert_refused(in_folder("lie.exr"), "");
        free(copy);
    }
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floats_come_back_bit_for_bit),
        cmocka_unit_test(not_a_number_comes_back),
        cmocka_unit_test(small_pictures_come_back),
        cmocka_unit_test(half_rounds_colors_only),
        cmocka_unit_test(halfs_alone_stay_in_order),
        cmocka_unit_test(attributes_come_back),
        cmocka_unit_test(bad_attributes_and_names_are_refused),
        cmocka_unit_test(a_failed_write_leaves_the_old_file),
        cmocka_unit_test(full_disks_and_missing_folders_are_reported),
        cmocka_unit_test(threads_write_the_same_file),
        cmocka_unit_test(a_disk_that_fills_up_harms_nothing),
        cmocka_unit_test(standard_output_is_a_whole_file),
        cmocka_unit_test(a_part_lies_in_its_picture),
        cmocka_unit_test(tiles_and_windows_are_read),
        cmocka_unit_test(colors_are_found),
        cmocka_unit_test(sizes_outside_the_limits_are_refused),
        cmocka_unit_test(what_is_no_picture_is_refused),
        cmocka_unit_test(damaged_files_are_refused_or_read),
        cmocka_unit_test(a_lying_header_is_refused),
    };
    return cmocka_run_group_tests_name("exr", tests, make_folder, remove_folder);
}

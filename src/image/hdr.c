/* hdr.c - Radiance's pictures (.hdr): a header of text, then lines of pixels with three mantissas and one exponent, flat or
 * in runs of the old or the new kind. G. Ward, "Real Pixels", Graphics Gems II (1991), and "The RADIANCE Picture File Format".
 * Strict: whatever does not agree with the header ends the reading.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/num.h"
#include "base/vec3.h"
#include "image/image.h"

enum {
    MAX_SIDE = 65536,
    BEST_RATIO = 1024, /* pixels to a byte: of one colour, 8192 of them wide, in old runs; new ones have 16 */
    LONGEST_TOLD = 60, /* of what a message quotes */
    NEW_LEAST = 8,     /* how long lines in new runs are, at least and at most */
    NEW_MOST = 32767,
    EXPONENT_OFFSET = 128 + 8
};

/* Red, green, blue and white. */
typedef struct Primaries {
    double xy[8];
} Primaries;

static const Primaries rec709 = {{0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290}};
/* Of files that hold X, Y and Z: equal amounts are white. */
static const Primaries of_xyz = {{1, 0, 0, 1, 0, 0, 1. / 3, 1. / 3}};

typedef struct HdrFile {
    const char *path;
    const unsigned char *at, *end; /* what is left of it */
    double exposure[3];            /* what values were multiplied by */
    bool converts;                 /* from other primaries, and to white that is D65's */
    Affine to_rec709;
    bool by_columns;                /* a line of the file is one of the picture's columns, */
    bool first_falls, second_falls; /* lines, and places in a line, are from the larger x or y to the smaller */
    uint32_t n_lines, length;
    Error *error;
} HdrFile;

static Status refuse(const HdrFile *file, const char *why)
{
    return fail(file->error, STATUS_INPUT, "cannot read '%s': the Radiance picture %s", file->path, why);
}

/* ---- colours ---- */

/* To X, Y and Z, white with Y = 1; false where the primaries make no colours. */
static bool matrix_to_xyz(const Primaries *primaries, Affine *matrix)
{
    Affine columns = affine_identity(), inverse;
    const double *xy = primaries->xy;
    for (int i = 0; i < 3; i++) {
        columns.m[0][i] = xy[2 * i];
        columns.m[1][i] = xy[2 * i + 1];
        columns.m[2][i] = 1 - xy[2 * i] - xy[2 * i + 1];
    }
    if (!(fabs(affine_determinant(&columns)) > 1e-6) || !(xy[7] > 1e-3) || !affine_invert(&columns, &inverse))
        return false;
    Vec3 white = vec3(xy[6] / xy[7], 1, (1 - xy[6] - xy[7]) / xy[7]), amounts = affine_vector(&inverse, white);
    const double amount[3] = {amounts.x, amounts.y, amounts.z};
    *matrix = columns;
    for (int i = 0; i < 3; i++)
        for (int row = 0; row < 3; row++) matrix->m[row][i] *= amount[i];
    return true;
}

/* White becomes white, by Bradford's matrix (K. M. Lam, 1985), as ICC profiles have it. */
static bool matrix_to_rec709(const Primaries *primaries, Affine *matrix)
{
    static const Affine bradford = {{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}},
                                    {0, 0, 0}};
    Affine from, to, adapt, back, cones;
    if (!matrix_to_xyz(primaries, &from) || !matrix_to_xyz(&rec709, &to)) return false;
    cones = affine_compose(&bradford, &from);
    Affine wanted = affine_compose(&bradford, &to);
    Vec3 ones = vec3(1, 1, 1), is = affine_vector(&cones, ones), becomes = affine_vector(&wanted, ones);
    if (!(is.x > 1e-6 && is.y > 1e-6 && is.z > 1e-6)) return false;
    adapt = affine_identity();
    adapt.m[0][0] = becomes.x / is.x;
    adapt.m[1][1] = becomes.y / is.y;
    adapt.m[2][2] = becomes.z / is.z;
    cones = affine_compose(&adapt, &cones);
    if (!affine_invert(&wanted, &back)) return false;
    *matrix = affine_compose(&back, &cones);
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < 3; i++)
            if (!(fabs(matrix->m[row][i]) < 1e3)) return false;
    return true;
}

static Status take_primaries(HdrFile *file, const Primaries *primaries)
{
    double farthest = 0;
    for (int i = 0; i < 8; i++) farthest = fmax(farthest, fabs(primaries->xy[i] - rec709.xy[i]));
    file->converts = farthest > 1e-3;
    if (file->converts && !matrix_to_rec709(primaries, &file->to_rec709))
        return refuse(file, "has PRIMARIES that make no colours");
    return STATUS_OK;
}

/* ---- the header ---- */

typedef struct Line {
    const char *text;
    size_t length;
} Line;

static bool next_line(HdrFile *file, Line *line)
{
    const unsigned char *newline = memchr(file->at, '\n', (size_t)(file->end - file->at));
    if (!newline) return false;
    *line = (Line){(const char *)file->at, (size_t)(newline - file->at)};
    while (line->length && line->text[line->length - 1] == '\r') line->length--;
    file->at = newline + 1;
    return true;
}

static Line without_blanks(Line line)
{
    while (line.length && (*line.text == ' ' || *line.text == '\t')) {
        line.text++;
        line.length--;
    }
    return line;
}

/* As a message can show it. */
typedef struct Told {
    char text[LONGEST_TOLD + 1];
} Told;

static Told told(Line line)
{
    Told shown = {{0}};
    for (size_t i = 0; i < line.length && i < LONGEST_TOLD; i++)
        shown.text[i] = line.text[i] >= ' ' && line.text[i] <= '~' ? line.text[i] : '?';
    return shown;
}

/* What stands behind "NAME=" of a line; false where the line is another one. */
static bool value_of(const Line *line, const char *name, Line *value)
{
    size_t length = strlen(name);
    if (line->length <= length || memcmp(line->text, name, length) != 0 || line->text[length] != '=') return false;
    *value = without_blanks((Line){line->text + length + 1, line->length - length - 1});
    while (value->length && value->text[value->length - 1] == ' ') value->length--;
    return true;
}

/* n numbers with blanks between them, and nothing else. */
static bool numbers_of(Line value, double *numbers, int n)
{
    for (int i = 0; i < n; i++) {
        value = without_blanks(value);
        size_t used = num_parse(value.text, value.length, &numbers[i]);
        if (!used || !isfinite(numbers[i])) return false;
        value.text += used;
        value.length -= used;
    }
    return without_blanks(value).length == 0;
}

static Status bad_value(const HdrFile *file, const char *name, const Line *value, const char *wanted)
{
    return fail(file->error, STATUS_INPUT, "cannot read '%s': the Radiance picture has %s=%s, %s", file->path, name,
                told(*value).text, wanted);
}

/* Factors of all lines count together. */
static Status take_exposure(HdrFile *file, const char *name, const Line *value, int n)
{
    double factors[3];
    if (!numbers_of(*value, factors, n))
        return bad_value(file, name, value, n == 1 ? "not a number" : "not three numbers");
    for (int i = 0; i < 3; i++) {
        file->exposure[i] *= factors[n == 1 ? 0 : i];
        if (!(file->exposure[i] >= 1e-30 && file->exposure[i] <= 1e30))
            return bad_value(file, name, value, "which leaves no picture: factors are in 1e-30..1e30");
    }
    return STATUS_OK;
}

static Status take_line(HdrFile *file, const Line *line, Primaries *primaries, bool *holds_xyz)
{
    Line value;
    if (value_of(line, "FORMAT", &value)) {
        static const char rgb[] = "32-bit_rle_rgbe", xyz[] = "32-bit_rle_xyze";
        *holds_xyz = value.length == sizeof xyz - 1 && memcmp(value.text, xyz, value.length) == 0;
        if (*holds_xyz || (value.length == sizeof rgb - 1 && memcmp(value.text, rgb, value.length) == 0))
            return STATUS_OK;
        return bad_value(file, "FORMAT", &value,
                         "and only 32-bit_rle_rgbe and 32-bit_rle_xyze are read: save it as one of these, or as .exr");
    }
    if (value_of(line, "EXPOSURE", &value)) return take_exposure(file, "EXPOSURE", &value, 1);
    if (value_of(line, "COLORCORR", &value)) return take_exposure(file, "COLORCORR", &value, 3);
    if (value_of(line, "PRIMARIES", &value) && !numbers_of(value, primaries->xy, 8))
        return bad_value(file, "PRIMARIES", &value, "not eight numbers");
    return STATUS_OK;
}

/* A sign, an axis and how many: "-Y 512". */
static bool take_axis(Line *line, char *sign, char *axis, uint32_t *n)
{
    *line = without_blanks(*line);
    const char *text = line->text, *end = text + line->length;
    if (end - text < 4 || (text[0] != '+' && text[0] != '-') || (text[1] != 'X' && text[1] != 'Y') || text[2] != ' ')
        return false;
    *sign = text[0];
    *axis = text[1];
    text += 2;
    while (text < end && *text == ' ') text++;
    uint64_t number = 0;
    const char *digits = text;
    for (; text < end && *text >= '0' && *text <= '9' && text - digits < 9; text++)
        number = 10 * number + (uint64_t)(*text - '0');
    *n = (uint32_t)number;
    *line = (Line){text, (size_t)(end - text)};
    return text > digits && (text == end || *text == ' ');
}

static Status take_resolution(HdrFile *file)
{
    Line line, rest;
    char signs[2], axes[2];
    uint32_t n[2];
    if (!next_line(file, &line)) return refuse(file, "is cut short before its size");
    rest = line;
    bool fine = take_axis(&rest, &signs[0], &axes[0], &n[0]) && take_axis(&rest, &signs[1], &axes[1], &n[1]);
    if (!fine || without_blanks(rest).length || axes[0] == axes[1] || n[0] == 0 || n[1] == 0)
        return fail(file->error, STATUS_INPUT,
                    "cannot read '%s': the Radiance picture has '%s' where its size belongs, as -Y 512 +X 1024",
                    file->path, told(line).text);
    if (n[0] > MAX_SIDE || n[1] > MAX_SIDE)
        return fail(file->error, STATUS_INPUT,
                    "cannot read '%s': the Radiance picture is of %u by %u pixels, outside 1..%d on a side", file->path,
                    n[0], n[1], MAX_SIDE);
    file->n_lines = n[0];
    file->length = n[1];
    file->by_columns = axes[0] == 'X';
    file->first_falls = signs[0] == '-';
    file->second_falls = signs[1] == '-';
    return STATUS_OK;
}

/* Shows a line "NAME=VALUE". */
static Status show_line(const HdrFile *file, const Line *line, HdrVisit *visit, void *context)
{
    const char *equals = memchr(line->text, '=', line->length);
    if (!equals || equals == line->text || line->text[0] == '\t' || line->text[0] == '#') return STATUS_OK;
    Buf name = {0}, value = {0};
    buf_add_bytes(&name, line->text, (size_t)(equals - line->text));
    buf_add_bytes(&value, equals + 1, (size_t)(line->text + line->length - equals - 1));
    bool fine = !name.failed && !value.failed;
    if (fine) visit(context, buf_text(&name), buf_text(&value));
    buf_clear(&name);
    buf_clear(&value);
    return fine ? STATUS_OK : fail_memory(file->error, line->length, "a header");
}

/* visit: NULL, or what is to see the header. */
static Status read_header(HdrFile *file, HdrVisit *visit, void *context)
{
    Line line;
    Primaries primaries = rec709;
    bool holds_xyz = false;
    if (!next_line(file, &line) || line.length < 2 || memcmp(line.text, "#?", 2) != 0)
        return fail(file->error, STATUS_INPUT, "cannot read '%s': it is not a Radiance picture", file->path);
    for (;;) {
        if (!next_line(file, &line)) return refuse(file, "is cut short within its header");
        if (line.length == 0) break;
        TRY(take_line(file, &line, &primaries, &holds_xyz));
        if (visit) TRY(show_line(file, &line, visit, context));
    }
    TRY(take_primaries(file, holds_xyz ? &of_xyz : &primaries));
    return take_resolution(file);
}

/* ---- lines of pixels ---- */

/* Runs of one mantissa or of the exponents at a time: a count above 128 and what stands there count - 128 times, or a count and so
 * many bytes. */
static Status read_new_runs(HdrFile *file, unsigned char (*line)[4])
{
    for (int c = 0; c < 4; c++)
        for (uint32_t i = 0; i < file->length;) {
            if (file->end - file->at < 2) return refuse(file, "is cut short");
            uint32_t count = *file->at++;
            bool run = count > 128;
            if (run) count -= 128;
            if (count == 0 || count > file->length - i)
                return refuse(file, "is damaged: a run does not end with its line");
            if (!run && (size_t)(file->end - file->at) < count) return refuse(file, "is cut short");
            for (uint32_t k = 0; k < count; k++) line[i++][c] = file->at[run ? 0 : k];
            file->at += run ? 1 : count;
        }
    return STATUS_OK;
}

/* Pixels one by one; a pixel of three times 1 says how often the one before it stands there once more, and several of them in a row
 * are the digits of that, to the base 256, the last one first. */
static Status read_old_runs(HdrFile *file, unsigned char (*line)[4])
{
    unsigned shift = 0;
    for (uint32_t i = 0; i < file->length;) {
        if (file->end - file->at < 4) return refuse(file, "is cut short");
        const unsigned char *pixel = file->at;
        file->at += 4;
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
            memcpy(line[i++], pixel, 4);
            shift = 0;
            continue;
        }
        uint64_t count = shift < 32 ? (uint64_t)pixel[3] << shift : UINT32_MAX;
        if (i == 0 || count > file->length - i) return refuse(file, "is damaged: a run does not end with its line");
        for (uint64_t k = 0; k < count; k++, i++) memcpy(line[i], line[i - 1], 4);
        shift += 8;
    }
    return STATUS_OK;
}

static Status read_line(HdrFile *file, unsigned char (*line)[4])
{
    const unsigned char *head = file->at;
    bool is_new = file->length >= NEW_LEAST && file->length <= NEW_MOST && file->end - head >= 4 && head[0] == 2 &&
                  head[1] == 2 && head[2] < 128;
    if (!is_new) return read_old_runs(file, line);
    if ((uint32_t)(head[2] << 8 | head[3]) != file->length)
        return refuse(file, "is damaged: a line has another length than the picture");
    file->at += 4;
    return read_new_runs(file, line);
}

/* Mantissas were cut off, and stand for the middle of what they were cut from, as Radiance reads them. */
static bool decode_pixel(const HdrFile *file, const unsigned char pixel[4], float rgb[3])
{
    double unit = pixel[3] ? ldexp(1, pixel[3] - EXPONENT_OFFSET) : 0, value[3];
    for (int c = 0; c < 3; c++) value[c] = unit * (pixel[c] + 0.5) / file->exposure[c];
    if (file->converts) {
        Vec3 made = affine_vector(&file->to_rec709, vec3(value[0], value[1], value[2]));
        value[0] = fmax(made.x, 0);
        value[1] = fmax(made.y, 0);
        value[2] = fmax(made.z, 0);
    }
    for (int c = 0; c < 3; c++) {
        if (!(value[c] <= (double)FLT_MAX)) return false;
        rgb[c] = (float)value[c];
    }
    return true;
}

static Status place_line(const HdrFile *file, uint32_t number, unsigned char (*line)[4], const Image *image)
{
    for (uint32_t i = 0; i < file->length; i++) {
        uint32_t first = file->first_falls ? file->n_lines - 1 - number : number;
        uint32_t second = file->second_falls ? file->length - 1 - i : i;
        uint32_t x = file->by_columns ? first : second, y = file->by_columns ? second : first; /* y: upwards */
        if (!decode_pixel(file, line[i], image_at(image, x, image->height - 1 - y)))
            return refuse(file, "has pixels that are too bright for its EXPOSURE or COLORCORR");
    }
    return STATUS_OK;
}

static Status read_pixels(HdrFile *file, Image *image)
{
    static const char *const names[3] = {"R", "G", "B"};
    if ((double)file->n_lines * file->length > 1e6 + BEST_RATIO * (double)(file->end - file->at))
        return refuse(file, "is too short for the size it claims");
    TRY(image_new(file->by_columns ? file->n_lines : file->length, file->by_columns ? file->length : file->n_lines,
                  names, 3, image, file->error));
    unsigned char(*line)[4] = malloc(file->length * sizeof *line);
    if (!line) return fail_memory(file->error, file->length * sizeof *line, "a picture");
    Status status = STATUS_OK;
    for (uint32_t i = 0; i < file->n_lines && status == STATUS_OK; i++) {
        status = read_line(file, line);
        if (status == STATUS_OK) status = place_line(file, i, line, image);
    }
    free(line);
    return status;
}

/* image: NULL, or what is read. */
static Status read_file(const char *path, Image *image, HdrVisit *visit, void *context, Error *error)
{
    char *bytes;
    size_t n_bytes;
    TRY(file_read(path, 0, &bytes, &n_bytes, error));
    HdrFile file = {.path = path,
                    .at = (const unsigned char *)bytes,
                    .end = (const unsigned char *)bytes + n_bytes,
                    .exposure = {1, 1, 1},
                    .error = error};
    Status status = n_bytes ? read_header(&file, visit, context)
                            : fail(error, STATUS_INPUT, "cannot read '%s': the file is empty", path);
    if (status == STATUS_OK && image) status = read_pixels(&file, image);
    free(bytes);
    if (status != STATUS_OK && image) image_clear(image);
    return status;
}

Status hdr_read(const char *path, Image *image, Error *error)
{
    *image = (Image){0};
    return read_file(path, image, NULL, NULL, error);
}

Status hdr_visit_header(const char *path, HdrVisit *visit, void *context, Error *error)
{
    return read_file(path, NULL, visit, context, error);
}

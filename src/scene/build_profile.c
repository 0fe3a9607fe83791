/* build_profile.c - photometric files of lamps: ANSI/IES LM-63 of 1986 to 2002, type C with TILT=NONE.
 * A line of format and lines of [KEYWORDS] are passed over up to TILT=; what follows are numbers with blanks, commas and
 * ends of line between them: 13 about the lamp, the vertical angles, the horizontal ones, and the candela values.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/num.h"
#include "scene/build_parts.h"

enum { LARGEST_FILE = 64 << 20, MOST_ANGLES = 20000, MOST_VALUES = 4000000 };

typedef struct Reader {
    Builder *b;
    const char *text;
    size_t length, at;
    uint32_t source;
} Reader;

static Span word_span(const Reader *r)
{
    size_t end = r->at;
    while (end < r->length && !strchr(" \t\r\n,", r->text[end])) end++;
    return (Span){r->source, (uint32_t)r->at, (uint32_t)end};
}

ATTR_PRINTF(2, 3) static bool refuse(const Reader *r, const char *format, ...)
{
    char text[200];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    diag_report(r->b->diag, D_BAD_PROFILE, word_span(r), "%s", text);
    return false;
}

static void skip_gaps(Reader *r)
{
    while (r->at < r->length && strchr(" \t\r\n,", r->text[r->at])) r->at++;
}

/* Up to the first number behind TILT=NONE. */
static bool skip_head(Reader *r)
{
    for (size_t next; r->at < r->length; r->at = next + 1) {
        next = r->at + strcspn(r->text + r->at, "\n");
        if (strncmp(r->text + r->at, "TILT=", 5) != 0) continue;
        r->at += 5;
        if (strncmp(r->text + r->at, "NONE", 4) != 0 || !strchr(" \t\r\n", r->text[r->at + 4]))
            return refuse(r, "only TILT=NONE is read: the lamp's tilt is that of the light");
        r->at = next;
        return true;
    }
    r->at = 0;
    return refuse(r, "there is no line TILT=NONE: this is no photometric file of LM-63");
}

static bool read_number(Reader *r, const char *what, double least, double most, double *value)
{
    skip_gaps(r);
    if (r->at >= r->length) return refuse(r, "the file ends where %s should be", what);
    size_t length = num_parse(r->text + r->at, r->length - r->at, value);
    if (!length || (r->at + length < r->length && !strchr(" \t\r\n,", r->text[r->at + length])))
        return refuse(r, "%s should be here, and this is no number", what);
    if (!(*value >= least && *value <= most))
        return refuse(r, "%s of %g is outside of %g .. %g", what, *value, least, most);
    r->at += length;
    return true;
}

static bool read_angles(Reader *r, const char *what, uint32_t n, double most, float *angles)
{
    for (uint32_t i = 0; i < n; i++) {
        double value;
        skip_gaps(r);
        Reader here = *r;
        if (!read_number(r, what, 0, most, &value)) return false;
        angles[i] = (float)value;
        if (i && !(angles[i] > angles[i - 1]))
            return refuse(&here, "%s of %g does not come after %g", what, value, (double)angles[i - 1]);
    }
    return true;
}

/* The angles about the axis that a file can give: 0; 0 to 90, 180 or 360; 90 to 270. */
static bool check_range(const Reader *r, const float *angles, uint32_t n)
{
    float first = angles[0], last = angles[n - 1];
    bool fine = (first == 0 && (n == 1 || last == 90 || last == 180 || last == 360)) || (first == 90 && last == 270);
    return fine || refuse(r, "horizontal angles go from %g to %g: 0, 0 to 90, 180 or 360, or 90 to 270 are possible",
                          (double)first, (double)last);
}

static bool read_head(Reader *r, double *factor, uint32_t *n_vertical, uint32_t *n_horizontal)
{
    double ignored, multiplier, vertical, horizontal, type, ballast;
    if (!read_number(r, "the number of lamps", 0, 1e9, &ignored) ||
        !read_number(r, "lumens per lamp", -1, 1e30, &ignored) ||
        !read_number(r, "the multiplier", 0, 1e20, &multiplier) ||
        !read_number(r, "the number of vertical angles", 2, MOST_ANGLES, &vertical) ||
        !read_number(r, "the number of horizontal angles", 1, MOST_ANGLES, &horizontal))
        return false;
    skip_gaps(r);
    Reader here = *r;
    if (!read_number(r, "the photometric type", 1, 3, &type)) return false;
    if (type != 1) return refuse(&here, "photometry of type %s is not read, only type C", type == 2 ? "B" : "A");
    for (int i = 0; i < 4; i++) /* units, width, length, height of the opening */
        if (!read_number(r, "the size of the lamp", -1e9, 1e9, &ignored)) return false;
    if (!read_number(r, "the ballast factor", 0, 1e6, &ballast) || !read_number(r, "a number", -1e9, 1e9, &ignored) ||
        !read_number(r, "the input watts", -1e9, 1e9, &ignored))
        return false;
    if (vertical * horizontal > MOST_VALUES)
        return refuse(&here, "%g times %g values are too many", vertical, horizontal);
    *factor = multiplier * ballast;
    *n_vertical = (uint32_t)vertical;
    *n_horizontal = (uint32_t)horizontal;
    return vertical == *n_vertical && horizontal == *n_horizontal
               ? true
               : refuse(&here, "the numbers of angles are not whole");
}

static bool read_profile(Reader *r, SceneLight *light)
{
    const double lumens_per_watt = 683, degree = 3.14159265358979323846 / 180;
    Arena *arena = r->b->arena;
    uint32_t n_vertical = 0, n_horizontal = 0;
    double factor = 0, reach = 0;
    if (!skip_head(r) || !read_head(r, &factor, &n_vertical, &n_horizontal)) return false;
    size_t n = (size_t)n_vertical * n_horizontal;
    if (n > r->length) return refuse(r, "the file is too short for %zu values", n);
    float *vertical = ARENA_ARRAY(arena, float, n_vertical), *horizontal = ARENA_ARRAY(arena, float, n_horizontal);
    float *intensity = ARENA_ARRAY(arena, float, n);
    if (!read_angles(r, "a vertical angle", n_vertical, 180, vertical)) return false;
    skip_gaps(r);
    Reader here = *r;
    if (!read_angles(r, "a horizontal angle", n_horizontal, 360, horizontal) ||
        !check_range(&here, horizontal, n_horizontal))
        return false;
    for (size_t i = 0; i < n; i++) {
        double value;
        if (!read_number(r, "an intensity", 0, 1e20, &value)) return false;
        intensity[i] = (float)fmin(value * factor / lumens_per_watt, 1e30);
        uint32_t row = (uint32_t)(i % n_vertical);
        if (intensity[i] > 0) reach = fmax(reach, (double)vertical[row + 1 < n_vertical ? row + 1 : row]);
    }
    LightProfile *profile = ARENA_NEW(arena, LightProfile);
    *profile = (LightProfile){vertical, horizontal, intensity, n_vertical, n_horizontal};
    light->profile = profile;
    light->cos_none = reach < 180 ? cos(reach * degree) : -1;
    r->at = r->length;
    return reach > 0 || refuse(r, "all intensities are 0");
}

bool build_profile(Builder *b, const EvalProp *prop, SceneLight *light)
{
    const char *path = eval_find_file(&b->eval_options, b->diag, prop->span, prop->as.text);
    if (!path) return false;
    char *bytes;
    size_t length;
    Error error;
    Status status = file_read(path, LARGEST_FILE, &bytes, &length, &error);
    if (status == STATUS_NOMEM) return build_succeeded(b, status, &error, prop->span);
    if (status != STATUS_OK) {
        diag_report(b->diag, D_FILE_UNREADABLE, prop->span, "%s", error.text);
        return false;
    }
    const char *text = arena_copy_text(b->arena, bytes, length);
    bool is_text = !memchr(bytes, 0, length);
    free(bytes);
    build_note_file(b, path);
    if (!is_text) {
        diag_report(b->diag, D_BAD_PROFILE, prop->span, "'%s' is no text", prop->as.text);
        return false;
    }
    Reader reader = {
        .b = b, .text = text, .length = length, .source = source_add(b->diag->sources, path, path, text, length)};
    return read_profile(&reader, light);
}

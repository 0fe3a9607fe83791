/* build_profile.c - photometric files of lamps: ANSI/IES LM-63 of 1986 to 2019.
 * A line of format and lines of [KEYWORDS] are passed over up to TILT=; what follows are numbers with blanks, commas and
 * ends of line between them: with TILT=INCLUDE how the lamp's output depends on how it is tilted, 13 about the lamp, the
 * vertical angles, the horizontal ones, and the candela values.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "base/angle.h"
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

static bool read_angles(Reader *r, const char *what, uint32_t n, double least, double most, float *angles)
{
    for (uint32_t i = 0; i < n; i++) {
        double value;
        skip_gaps(r);
        Reader here = *r;
        if (!read_number(r, what, least, most, &value)) return false;
        angles[i] = (float)value;
        if (i && !(angles[i] > angles[i - 1]))
            return refuse(&here, "%s of %g does not come after %g", what, value, (double)angles[i - 1]);
    }
    return true;
}

/* ---- the tilt ---- */

static bool is_line_end(const Reader *r, size_t at)
{
    return at >= r->length || strchr("\r\n", r->text[at]) != NULL;
}

/* A word in capitals or not. */
static bool is_word(const char *text, size_t length, const char *word)
{
    size_t i = 0;
    for (; i < length && word[i]; i++)
        if ((text[i] & ~0x20) != word[i]) return false;
    return i == length && !word[i];
}

/* How much of its light the lamp gives when it is tilted by so many degrees from where it points straight down: four
 * things, how the lamp sits in the luminaire (which the angles allow for), the number of angles, the angles, and a factor
 * for each. Angles beyond 90 count back from 180 where the table ends at 90. */
static bool read_tilt(Reader *r, double tilt, double *factor)
{
    enum { MOST_TILTS = 1000 };
    double geometry, n, low_angle = 0, low_factor = 1;
    float *angles = NULL;
    if (!read_number(r, "how the lamp sits in the luminaire (1, 2 or 3)", 1, 3, &geometry) ||
        !read_number(r, "the number of tilt angles", 1, MOST_TILTS, &n))
        return false;
    if (n != floor(n) || geometry != floor(geometry)) return refuse(r, "the numbers of the tilt are not whole");
    angles = ARENA_ARRAY(r->b->arena, float, (size_t)n);
    if (!read_angles(r, "a tilt angle", (uint32_t)n, 0, 180, angles)) return false;
    if (angles[(uint32_t)n - 1] <= 90 && tilt > 90) tilt = 180 - tilt;
    for (uint32_t i = 0; i < (uint32_t)n; i++) {
        double value, angle = (double)angles[i];
        if (!read_number(r, "a factor of the tilt", 0, 1e6, &value)) return false;
        if (i == 0 || angle <= tilt)
            *factor = value;
        else if (low_angle < tilt)
            *factor = low_factor + (value - low_factor) * (tilt - low_angle) / (angle - low_angle);
        low_angle = angle;
        low_factor = value;
    }
    return true;
}

static bool open_text(Builder *b, Span span, const char *name, Reader *reader);

/* Up to the first number about the lamp. */
static bool read_head(Reader *r, double tilt, double *factor)
{
    *factor = 1;
    for (size_t next; r->at < r->length; r->at = next + 1) {
        next = r->at + strcspn(r->text + r->at, "\n");
        if (next < r->at + 4 || !is_word(r->text + r->at, 4, "TILT")) continue;
        size_t at = r->at + 4;
        while (strchr(" \t", r->text[at]) && r->text[at]) at++;
        if (r->text[at] != '=') continue;
        for (at++; strchr(" \t", r->text[at]) && r->text[at];) at++;
        size_t end = at;
        while (!is_line_end(r, end)) end++;
        while (end > at && strchr(" \t", r->text[end - 1])) end--;
        r->at = at;
        if (end == at) return refuse(r, "NONE, INCLUDE, or the name of a file should be here");
        Span span = {r->source, (uint32_t)at, (uint32_t)end};
        const char *name = arena_copy_text(r->b->arena, r->text + at, end - at);
        r->at = next;
        if (is_word(name, end - at, "NONE")) return true;
        if (is_word(name, end - at, "INCLUDE")) return read_tilt(r, tilt, factor);
        Reader other;
        return open_text(r->b, span, name, &other) && read_tilt(&other, tilt, factor);
    }
    r->at = 0;
    return refuse(r, "there is no line TILT=NONE: this is no photometric file of LM-63");
}

/* ---- the lamp ---- */

/* Up to the standard of 1991 the ballast factor was followed by another factor, later by something else. */
static bool is_old(const Reader *r)
{
    return strncmp(r->text, "IES", 3) != 0 || strncmp(r->text, "IESNA91", 7) == 0;
}

/* What a file says about its lamp. */
typedef struct Lamp {
    double factor; /* of its candelas */
    ProfileType type;
    uint32_t n_vertical, n_horizontal;
} Lamp;

static bool read_lamp(Reader *r, Lamp *lamp)
{
    static const ProfileType types[] = {PROFILE_C, PROFILE_B, PROFILE_A};
    double ignored, multiplier, vertical, horizontal, type, ballast, photometric;
    if (!read_number(r, "the number of lamps", 0, 1e9, &ignored) ||
        !read_number(r, "lumens per lamp", -1, 1e30, &ignored) ||
        !read_number(r, "the multiplier", 0, 1e20, &multiplier) ||
        !read_number(r, "the number of vertical angles", 2, MOST_ANGLES, &vertical) ||
        !read_number(r, "the number of horizontal angles", 1, MOST_ANGLES, &horizontal))
        return false;
    skip_gaps(r);
    Reader here = *r;
    if (!read_number(r, "the photometric type (1 for C, 2 for B, 3 for A)", 1, 3, &type)) return false;
    if (type != floor(type)) return refuse(&here, "a photometric type of %g: it is 1 for C, 2 for B, 3 for A", type);
    for (int i = 0; i < 4; i++) /* units, width, length, height of the opening */
        if (!read_number(r, "the size of the lamp", -1e9, 1e9, &ignored)) return false;
    if (!read_number(r, "the ballast factor", 0, 1e6, &ballast) ||
        !read_number(r, "a number", -1e9, 1e9, &photometric) || !read_number(r, "the input watts", -1e9, 1e9, &ignored))
        return false;
    if (vertical * horizontal > MOST_VALUES)
        return refuse(&here, "%g times %g values are too many", vertical, horizontal);
    *lamp = (Lamp){multiplier * ballast, types[(int)type - 1], (uint32_t)vertical, (uint32_t)horizontal};
    if (is_old(r) && photometric > 0) lamp->factor *= photometric;
    return vertical == lamp->n_vertical && horizontal == lamp->n_horizontal
               ? true
               : refuse(&here, "the numbers of angles are not whole");
}

/* The angles about the axis that a file of type C can give: 0; 0 to 90, 180 or 360; 90 to 270. Of types A and B both
 * kinds of angles go from -90 or 0 to 90 (and horizontal ones may be but one, 0). */
static bool check_range(const Reader *r, ProfileType type, bool horizontal, const float *angles, uint32_t n)
{
    double first = (double)angles[0], last = (double)angles[n - 1];
    const char *what = horizontal ? "horizontal" : "vertical";
    if (type != PROFILE_C) {
        bool fine = (last == 90 && (first == -90 || first == 0)) || (horizontal && n == 1 && first == 0);
        return fine || refuse(r, "%s angles go from %g to %g: for types A and B, -90 to 90 or 0 to 90 are possible",
                              what, first, last);
    }
    if (!horizontal) return true;
    bool fine = (first == 0 && (n == 1 || last == 90 || last == 180 || last == 360)) || (first == 90 && last == 270);
    return fine || refuse(r, "horizontal angles go from %g to %g: 0, 0 to 90, 180 or 360, or 90 to 270 are possible",
                          first, last);
}

static bool read_both_angles(Reader *r, const Lamp *lamp, float *vertical, float *horizontal)
{
    bool c = lamp->type == PROFILE_C;
    skip_gaps(r);
    Reader here = *r;
    if (!read_angles(r, "a vertical angle", lamp->n_vertical, c ? 0 : -90, c ? 180 : 90, vertical) ||
        !check_range(&here, lamp->type, false, vertical, lamp->n_vertical))
        return false;
    skip_gaps(r);
    here = *r;
    return read_angles(r, "a horizontal angle", lamp->n_horizontal, c ? 0 : -90, c ? 360 : 90, horizontal) &&
           check_range(&here, lamp->type, true, horizontal, lamp->n_horizontal);
}

/* Degrees that the light's axis is away from straight down. */
static double tilt_of(const SceneLight *light)
{
    double y = light->to_world.m[1][1];
    return acos(fmin(fmax(-y, -1), 1)) * 180 / MEN_PI;
}

static bool read_profile(Reader *r, SceneLight *light)
{
    const double lumens_per_watt = 683;
    Arena *arena = r->b->arena;
    Lamp lamp = {0};
    double factor = 1, reach = 0;
    bool shines = false;
    if (!read_head(r, tilt_of(light), &factor) || !read_lamp(r, &lamp)) return false;
    size_t n = (size_t)lamp.n_vertical * lamp.n_horizontal;
    if (n > r->length) return refuse(r, "the file is too short for %zu values", n);
    float *vertical = ARENA_ARRAY(arena, float, lamp.n_vertical);
    float *horizontal = ARENA_ARRAY(arena, float, lamp.n_horizontal), *intensity = ARENA_ARRAY(arena, float, n);
    if (!read_both_angles(r, &lamp, vertical, horizontal)) return false;
    factor *= lamp.factor / lumens_per_watt;
    for (size_t i = 0; i < n; i++) {
        double value;
        if (!read_number(r, "an intensity", 0, 1e20, &value)) return false;
        intensity[i] = (float)fmin(value * factor, 1e30);
        uint32_t row = (uint32_t)(i % lamp.n_vertical);
        shines = shines || intensity[i] > 0;
        if (intensity[i] > 0) reach = fmax(reach, fabs((double)vertical[row + 1 < lamp.n_vertical ? row + 1 : row]));
    }
    LightProfile *profile = ARENA_NEW(arena, LightProfile);
    *profile = (LightProfile){lamp.type, vertical, horizontal, intensity, lamp.n_vertical, lamp.n_horizontal};
    light->profile = profile;
    light->cos_none = lamp.type != PROFILE_C ? -1e-6 : reach < 180 ? cos(reach * MEN_DEGREE) : -1;
    r->at = r->length;
    return shines || refuse(r, "all intensities are 0");
}

/* Finds a file of text, reads it whole, and lets messages quote it. */
static bool open_text(Builder *b, Span span, const char *name, Reader *reader)
{
    BuildText file;
    if (!build_text_file(b, span, name, LARGEST_FILE, D_BAD_PROFILE, &file)) return false;
    *reader = (Reader){.b = b, .text = file.text, .length = file.length, .source = file.source};
    return true;
}

bool build_profile(Builder *b, const EvalProp *prop, SceneLight *light)
{
    Reader reader;
    return open_text(b, prop->span, prop->as.text, &reader) && read_profile(&reader, light);
}

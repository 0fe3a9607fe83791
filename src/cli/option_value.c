/* option_value.c - reads the values of options, without the locale, and checks their form and range.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/num.h"
#include "cli/options.h"
#include "base/suggest.h"

enum { MOST_CHOICES = 16, CHOICE_SIZE = 32 };

/* Digits only: a sign, blanks or a fraction make no count. Returns how many bytes were read, 0 for none. */
static size_t read_whole(const char *text, uint32_t *whole)
{
    uint64_t value = 0;
    size_t n = 0;
    while (text[n] >= '0' && text[n] <= '9') {
        value = value * 10 + (uint64_t)(text[n] - '0');
        if (value > UINT32_MAX) return 0;
        n++;
    }
    if (n) *whole = (uint32_t)value;
    return n;
}

static bool in_range(const OptionRow *row, double number)
{
    return number >= row->low && number <= row->high;
}

static Status read_count(const OptionRow *row, const char *spelled, const char *text, OptionValue *value, Error *error)
{
    size_t n = read_whole(text, &value->whole[0]);
    if (n == 0 || text[n] || !in_range(row, value->whole[0]))
        return fail(error, STATUS_USAGE, "option '%s': '%s' is not a whole number from %.0f to %.0f", spelled, text,
                    row->low, row->high);
    return STATUS_OK;
}

/* Says which option there is for "--exposure auto"; false: none. */
static bool automatic_of(const OptionRow *row, Error *error)
{
    for (int key = 0; key < OPTION_COUNT; key++) {
        const char *name = option_row((OptionKey)key)->name;
        if (!name || strncmp(name, "auto-", 5) != 0 || strcmp(name + 5, row->name) != 0) continue;
        (void)fail(error, STATUS_USAGE, "option '--%s' is a number; write: --%s on", row->name, name);
        return true;
    }
    return false;
}

static Status read_number(const OptionRow *row, const char *spelled, const char *text, OptionValue *value, Error *error)
{
    size_t n = num_parse(text, strlen(text), &value->number);
    if (n && row->kind == KIND_FRACTION && text[n] == '%') {
        value->number /= 100;
        n++;
    }
    if (strncmp(text, "auto", 4) == 0 && automatic_of(row, error)) return STATUS_USAGE;
    if (n == 0 || text[n])
        return fail(error, STATUS_USAGE, "option '%s': '%s' is not a number%s", spelled, text,
                    row->kind == KIND_FRACTION ? ", such as 0.5 or 50%" : "");
    if (!in_range(row, value->number))
        return fail(error, STATUS_USAGE, "option '%s': %s is outside of %g to %g%s", spelled, text, row->low, row->high,
                    row->kind == KIND_FRACTION && text[n - 1] != '%' ? "; hundredths have a '%', as 50%" : "");
    return STATUS_OK;
}

/* 90, 90s, 10m, 1h30m, 1.5h: each unit once, in falling order. */
static bool duration_from_text(const char *text, double *seconds)
{
    static const struct {
        char unit;
        double seconds;
    } units[] = {{'h', 3600}, {'m', 60}, {'s', 1}};
    size_t next = 0;
    *seconds = 0;
    if (!*text) return false;
    while (*text) {
        double number;
        size_t n = num_parse(text, strlen(text), &number);
        if (n == 0 || !isfinite(number) || number < 0) return false;
        text += n;
        if (!*text && next == 0) {
            *seconds = number;
            return true;
        }
        while (next < COUNT_OF(units) && units[next].unit != *text) next++;
        if (next == COUNT_OF(units)) return false;
        *seconds += number * units[next].seconds;
        next++;
        text++;
    }
    return true;
}

static Status read_duration(const char *spelled, const char *text, OptionValue *value, Error *error)
{
    if (!duration_from_text(text, &value->number) || value->number <= 0)
        return fail(error, STATUS_USAGE, "option '%s': '%s' is not a time, such as 90s, 10m or 1h30m", spelled, text);
    return STATUS_OK;
}

static Status read_kelvin(const OptionRow *row, const char *spelled, const char *text, OptionValue *value, Error *error)
{
    value->number = 0;
    if (strcmp(text, "off") == 0) return STATUS_OK;
    size_t n = num_parse(text, strlen(text), &value->number);
    n += n && text[n] == 'K';
    if (n && !text[n] && in_range(row, value->number)) return STATUS_OK;
    return fail(error, STATUS_USAGE,
                "option '%s': '%s' is not a temperature from %g to %g kelvin, such as 2700, or off", spelled, text,
                row->low, row->high);
}

static Status read_size(const OptionRow *row, const char *spelled, const char *text, OptionValue *value, Error *error)
{
    size_t n = read_whole(text, &value->whole[0]);
    size_t m = n && (text[n] == 'x' || text[n] == 'X') ? read_whole(text + n + 1, &value->whole[1]) : 0;
    if (m == 0 || text[n + 1 + m])
        return fail(error, STATUS_USAGE, "option '%s': '%s' is not a width and a height, such as 640x480", spelled,
                    text);
    for (int i = 0; i < 2; i++)
        if (!in_range(row, value->whole[i]))
            return fail(error, STATUS_USAGE, "option '%s': the %s of %s is outside of %.0f to %.0f", spelled,
                        i ? "height" : "width", text, row->low, row->high);
    return STATUS_OK;
}

/* Pixels, or percent of a side. Returns how many bytes were read, 0 for none. */
static size_t read_place(const char *text, uint32_t *whole, double *part)
{
    *part = -1;
    size_t n = read_whole(text, whole);
    if (n && text[n] != '%' && text[n] != '.') return n;
    n = num_parse(text, strlen(text), part);
    *part /= 100;
    return n && text[n] == '%' && *part >= 0 && *part <= 1 ? n + 1 : 0;
}

/* What is in pixels and in percent is compared when the size of the picture is known. */
static Status read_crop(const char *spelled, const char *text, OptionValue *value, Error *error)
{
    const char *p = text;
    for (int i = 0; i < 4; i++) {
        size_t n = read_place(p, &value->whole[i], &value->parts[i]);
        if (n == 0 || p[n] != (i < 3 ? ',' : 0))
            return fail(
                error, STATUS_USAGE,
                "option '%s': '%s' is not four whole numbers, such as 10,20,110,120, or percent up to 100, such "
                "as 30%%,10%%,60%%,50%%",
                spelled, text);
        p += n + 1;
    }
    for (int i = 0; i < 2; i++) {
        bool alike = (value->parts[i] < 0) == (value->parts[i + 2] < 0);
        double first = value->parts[i] < 0 ? value->whole[i] : value->parts[i],
               end = value->parts[i] < 0 ? value->whole[i + 2] : value->parts[i + 2];
        if (alike && first >= end)
            return fail(error, STATUS_USAGE,
                        "option '%s': %s holds no pixel: X0 must be less than X1, and Y0 less than Y1", spelled, text);
    }
    return STATUS_OK;
}

/* The rest of a text behind the separator, NULL where it does not go on so; a whole number goes to *whole. */
static const char *read_behind(const char *text, const char *separator, uint32_t *whole)
{
    size_t length = strlen(separator);
    if (strncmp(text, separator, length) != 0) return NULL;
    size_t n = read_whole(text + length, whole);
    return n ? text + length + n : NULL;
}

static Status read_pixel(const char *spelled, const char *text, OptionValue *value, Error *error)
{
    size_t n = read_whole(text, &value->whole[0]);
    const char *end = n ? read_behind(text + n, ",", &value->whole[1]) : NULL;
    if (end && !*end) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '%s': '%s' is not X,Y, two whole numbers, such as 320,240", spelled, text);
}

/* Others write a range with a hyphen or a colon, 1-120: told how it is written here. STATUS_OK: it is none. */
static Status refuse_other_range(const char *spelled, const char *text, Error *error)
{
    uint32_t first, last;
    const char *separator = read_behind(text, "", &first);
    const char *end = separator && strchr("-:", *separator) ? read_behind(separator + 1, "", &last) : NULL;
    if (!end || *end) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '%s': '%s' is no range here; write %u..%u", spelled, text, first, last);
}

static Status read_frames(const char *spelled, const char *text, OptionValue *value, Error *error)
{
    uint32_t *first = &value->whole[0], *last = &value->whole[1], *step = &value->whole[2];
    *step = 0;
    if (strcmp(text, "all") == 0) return STATUS_OK;
    const char *rest = read_behind(text, "", first);
    *step = 1;
    *last = *first;
    if (rest && *rest) {
        rest = read_behind(rest, "..", last);
        if (rest && *rest) rest = read_behind(rest, "/", step);
    }
    TRY(refuse_other_range(spelled, text, error));
    if (!rest || *rest || *step == 0)
        return fail(error, STATUS_USAGE,
                    "option '%s': '%s' is not all, a frame or a range of frames, such as 12, 1..120 or 1..120/2",
                    spelled, text);
    if (*last >= *first) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '%s': %s holds no frame: the last one comes before the first", spelled,
                text);
}

static Status read_shard(const char *spelled, const char *text, OptionValue *value, Error *error)
{
    const char *rest = read_behind(text, "", &value->whole[0]);
    rest = rest ? read_behind(rest, "/", &value->whole[1]) : NULL;
    if (!rest || *rest)
        return fail(error, STATUS_USAGE, "option '%s': '%s' is not two whole numbers, such as 1/4", spelled, text);
    if (value->whole[0] >= 1 && value->whole[0] <= value->whole[1]) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '%s': %s: shards are counted from 1 to their number", spelled, text);
}

static Status read_range(const OptionRow *row, const char *spelled, const char *text, OptionValue *value, Error *error)
{
    const char *rest = read_behind(text, "", &value->whole[0]);
    rest = rest ? read_behind(rest, "..", &value->whole[1]) : NULL;
    TRY(refuse_other_range(spelled, text, error));
    if (!rest || *rest)
        return fail(error, STATUS_USAGE, "option '%s': '%s' is not two whole numbers, such as 1..64", spelled, text);
    if (value->whole[0] > value->whole[1])
        return fail(error, STATUS_USAGE, "option '%s': %s holds nothing: the last one comes before the first", spelled,
                    text);
    if (in_range(row, value->whole[0]) && in_range(row, value->whole[1])) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '%s': %s is outside of %.0f..%.0f", spelled, text, row->low, row->high);
}

const char *choice_next(const char **rest, char *word, size_t size)
{
    if (!*rest) return NULL;
    const char *bar = strchr(*rest, '|');
    size_t length = bar ? (size_t)(bar - *rest) : strlen(*rest);
    snprintf(word, size, "%.*s", (int)length, *rest);
    *rest = bar ? bar + 1 : NULL;
    return word;
}

static Status read_choice(const OptionRow *row, const char *spelled, const char *text, OptionValue *value, Error *error)
{
    char words[MOST_CHOICES][CHOICE_SIZE], list[256] = "";
    const char *pointers[MOST_CHOICES], *rest = row->choices;
    size_t n = 0;
    if (row == option_row(OPTION_UNIT) && text[0] == '1' && text[1]) text++; /* as a scene has it: unit = 1m */
    while (n < MOST_CHOICES && choice_next(&rest, words[n], CHOICE_SIZE)) {
        if (strcmp(words[n], text) == 0) {
            value->text = text;
            return STATUS_OK;
        }
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%.*s", n ? (rest ? ", " : " or ") : "", CHOICE_SIZE - 1, words[n]);
        pointers[n] = words[n];
        n++;
    }
    const char *near = suggest_nearest(text, pointers, n);
    return fail(error, STATUS_USAGE, "option '%s': '%s' is not one of %s%s%s%s", spelled, text, list,
                near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

static Status read_text(const char *spelled, const char *text, OptionValue *value, Error *error)
{
    if (!*text) return fail(error, STATUS_USAGE, "option '%s': the value is empty", spelled);
    value->text = text;
    return STATUS_OK;
}

Status option_value_read(const OptionRow *row, const char *spelled, const char *text, OptionValue *value, Error *error)
{
    switch (row->kind) {
    case KIND_FLAG: break;
    case KIND_COUNT: return read_count(row, spelled, text, value, error);
    case KIND_NUMBER:
    case KIND_FRACTION: return read_number(row, spelled, text, value, error);
    case KIND_DURATION: return read_duration(spelled, text, value, error);
    case KIND_KELVIN: return read_kelvin(row, spelled, text, value, error);
    case KIND_SIZE: return read_size(row, spelled, text, value, error);
    case KIND_CROP: return read_crop(spelled, text, value, error);
    case KIND_PIXEL: return read_pixel(spelled, text, value, error);
    case KIND_FRAMES: return read_frames(spelled, text, value, error);
    case KIND_SHARD: return read_shard(spelled, text, value, error);
    case KIND_RANGE: return read_range(row, spelled, text, value, error);
    case KIND_CHOICE: return read_choice(row, spelled, text, value, error);
    case KIND_TEXT:
    case KIND_FILE:
    case KIND_FOLDER:
    case KIND_OPTIONAL_FILE:
    case KIND_LIST:
    case KIND_FOLDERS: return read_text(spelled, text, value, error);
    case KIND_DEFINES:
        if (strchr(text, '=') && text[0] != '=') return STATUS_OK;
        if (*text == '\0' || *text == '=')
            return fail(error, STATUS_USAGE, "option '%s': '%s' is not NAME=VALUE", spelled, text);
        return fail(error, STATUS_USAGE, "option '%s': '%s' is not NAME=VALUE, as %s=true is", spelled, text, text);
    }
    return STATUS_OK;
}

Status option_crop(const Options *options, OptionKey key, uint32_t width, uint32_t height, uint32_t crop[4],
                   Error *error)
{
    const OptionValue *value = &options->values[key];
    for (int i = 0; i < 4; i++)
        crop[i] = value->parts[i] < 0 ? value->whole[i] : (uint32_t)(value->parts[i] * (i % 2 ? height : width) + 0.5);
    if (crop[2] > width || crop[3] > height)
        return fail(error, STATUS_USAGE, "option '--crop': %u,%u is outside of the picture of %u x %u", crop[2],
                    crop[3], width, height);
    if (crop[0] < crop[2] && crop[1] < crop[3]) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '--crop': %u,%u,%u,%u of the picture of %u x %u holds no pixel", crop[0],
                crop[1], crop[2], crop[3], width, height);
}

/* check_slice.c - the picture of a cross-section that `check --slice` makes: its options, its legend, its file.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/check_slice.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/num.h"
#include "cli/output.h"
#include "image/font.h"
#include "image/image.h"
#include "check/report.h"

enum { LONG_SIDE = 800, SHORT_SIDE = 320, NAMES_SHOWN = 5, LEGEND_TEXT = 240 };

/* ---- options ---- */

static Status read_plane(CheckSlice *slice, const char *text, Error *error)
{
    double p[3] = {0}, n[3] = {0};
    if (*text && strchr("xyz", *text) && text[1] == '=') {
        double at;
        const char *end = num_parse_list(text + 2, &at, 1);
        slice->normal = vec3(*text == 'x', *text == 'y', *text == 'z');
        slice->point = vec3_scale(slice->normal, at);
        if (end && !*end) return STATUS_OK;
    }
    const char *end = num_parse_list(text, p, 3);
    if (end && !*end)
        return fail(error, STATUS_USAGE,
                    "option '--slice': '%s' is a point: write its plane's normal behind it, as %s:0,1,0", text, text);
    if (end && *end == ':') end = num_parse_list(end + 1, n, 3);
    slice->point = vec3(p[0], p[1], p[2]);
    slice->normal = vec3(n[0], n[1], n[2]);
    if (!end || *end)
        return fail(error, STATUS_USAGE,
                    "option '--slice': '%s' is not a plane, such as x=0, or 0,5,0:1,0,1 for a point and a normal, in "
                    "the scene's unit",
                    text);
    if (!(vec3_length(slice->normal) > 0))
        return fail(error, STATUS_USAGE, "option '--slice': the normal of '%s' is 0", text);
    return STATUS_OK;
}

static Status read_region(CheckSlice *slice, const char *text, Error *error)
{
    const char *end = num_parse_list(text, slice->region, 4);
    if (!end || *end)
        return fail(error, STATUS_USAGE, "option '--slice-region': '%s' is not four numbers, such as -40,0,40,90",
                    text);
    if (!(slice->region[0] < slice->region[2]) || !(slice->region[1] < slice->region[3]))
        return fail(error, STATUS_USAGE, "option '--slice-region': %s is empty: it is left,bottom,right,top", text);
    slice->has_region = true;
    return STATUS_OK;
}

/* dir/glass.mns gives glass-slice.png, in the current folder. */
static char *default_path(const char *scene_path)
{
    const char *name = file_name(scene_path);
    Buf path = {0};
    if (strcmp(scene_path, "-") == 0)
        buf_add(&path, "scene");
    else
        buf_add_bytes(&path, name, file_stem_length(name));
    buf_add(&path, "-slice.png");
    if (!path.failed) return path.text;
    buf_clear(&path);
    return NULL;
}

Status check_slice_init(CheckSlice *slice, const Options *options, Error *error)
{
    *slice = (CheckSlice){0};
    const char *plane = option_text(options, OPTION_SLICE, NULL),
               *region = option_text(options, OPTION_SLICE_REGION, NULL);
    const char *path = option_text(options, OPTION_SLICE_OUTPUT, NULL);
    bool sized = option_given(options, OPTION_SLICE_SIZE);
    if (!plane) {
        if (!region && !path && !sized) return STATUS_OK;
        return fail(error, STATUS_USAGE, "option '--slice-%s' means nothing without '--slice'",
                    region ? "region"
                    : path ? "output"
                           : "size");
    }
    slice->wanted = true;
    TRY(read_plane(slice, plane, error));
    if (region) TRY(read_region(slice, region, error));
    if (sized) {
        slice->width = options->values[OPTION_SLICE_SIZE].whole[0];
        slice->height = options->values[OPTION_SLICE_SIZE].whole[1];
    }
    slice->path = path ? strdup(path) : default_path(options->operands[0]);
    if (!slice->path) return fail_memory(error, 0, "the name of the slice");
    if (path) TRY(output_check_name(path, error));
    if (path && strcmp(file_extension(path), "png") != 0)
        return fail(error, STATUS_USAGE, "option '--slice-output': '%s' must end in .png", path);
    return STATUS_OK;
}

void check_slice_clear(CheckSlice *slice)
{
    free(slice->path);
    slice_image_clear(&slice->image);
    *slice = (CheckSlice){0};
}

/* ---- the legend ---- */

/* What one colour means. */
typedef struct LegendLine {
    float rgb[3];
    bool hatched;
    char medium[LEGEND_TEXT / 4];
    char text[LEGEND_TEXT];
} LegendLine;

typedef struct Legend {
    LegendLine *lines;
    size_t n;
} Legend;

static size_t word_length(const char *name)
{
    size_t n = strlen(name), k = n;
    while (k > 0 && isdigit((unsigned char)name[k - 1])) k--;
    return k < n && k > 1 && name[k - 1] == ' ' ? k - 1 : n;
}

static void add_word(char *text, size_t size, const char *word, size_t length, unsigned *n)
{
    for (const char *p = text; *p;) { /* once each */
        size_t m = strcspn(p, ",");
        if (m == length && strncmp(p, word, m) == 0) return;
        p += m + (p[m] ? 2 : 0);
    }
    if (++*n > NAMES_SHOWN + 1) return;
    size_t used = strlen(text);
    if (*n == NAMES_SHOWN + 1)
        snprintf(text + used, size - used, ", ...");
    else
        snprintf(text + used, size - used, "%s%.*s", used ? ", " : "", (int)length, word);
}

static void add_line(Legend *legend, const float rgb[3], bool hatched, const char *medium, const char *text)
{
    LegendLine *line = &legend->lines[legend->n++];
    for (int i = 0; i < 3; i++) line->rgb[i] = rgb[i];
    line->hatched = hatched;
    snprintf(line->medium, sizeof line->medium, "%s", medium);
    snprintf(line->text, sizeof line->text, "%s", text);
}

/* The hulls that own some pixel, or NULL. */
static bool *hulls_seen(const CheckSlice *slice, const CompiledScene *compiled)
{
    bool *seen = calloc(compiled->n_hulls + 1U, sizeof *seen);
    size_t n = (size_t)slice->image.width * slice->image.height;
    for (size_t i = 0; seen && i < n; i++)
        if (slice->image.owner[i] != SCENE_NONE) seen[slice->image.owner[i]] = true;
    return seen;
}

static bool legend_make(const CheckSlice *slice, const CompiledScene *compiled, Legend *legend)
{
    const Scene *scene = compiled->scene;
    bool *seen = hulls_seen(slice, compiled);
    const uint32_t n_nm = slice->rays->n ? slice->rays->n_nm : 0;
    *legend = (Legend){.lines = calloc(scene->n_media + 3U + n_nm, sizeof *legend->lines)};
    for (uint32_t m = 0; seen && legend->lines && m < scene->n_media; m++) {
        char names[LEGEND_TEXT] = "";
        unsigned n = 0;
        float rgb[3];
        if (m == 0) add_word(names, sizeof names, "the world", strlen("the world"), &n);
        for (uint32_t h = 0; h < compiled->n_hulls; h++) {
            const char *name = scene->objects[compiled->object_of_hull[h]].name;
            if (seen[h] && compiled->hulls[h].medium == m) add_word(names, sizeof names, name, word_length(name), &n);
        }
        slice_color(m, rgb);
        if (n) add_line(legend, rgb, false, scene->media[m].name, names);
    }
    bool ready = seen && legend->lines;
    static const float hatch_color[3] = {0.55f, 0.55f, 0.55f};
    if (ready && slice->image.opaque) add_line(legend, slice_opaque_color, false, "", "opaque");
    if (ready && slice->image.overlaps)
        add_line(legend, hatch_color, true, "", "overlap: the stripes are of what is below");
    if (ready && slice->image.n_gaps) {
        Buf gap = {0};
        buf_add(&gap, "a gap about as thin as a pixel, or thinner; the thinnest is ");
        report_add_length(&gap, scene, slice->image.least_gap);
        add_line(legend, slice_gap_color, false, "", buf_text(&gap));
        buf_clear(&gap);
    }
    for (uint32_t i = 0; ready && i < n_nm; i++) {
        char text[LEGEND_TEXT];
        float rgb[3];
        check_rays_color(slice->rays, slice->rays->nm[i], rgb);
        snprintf(text, sizeof text, "light of %g nm", slice->rays->nm[i]);
        add_line(legend, rgb, false, "", text);
    }
    free(seen);
    return ready;
}

static void color_text(const float rgb[3], char text[8])
{
    snprintf(text, 8, "#%02x%02x%02x", image_byte(rgb[0]), image_byte(rgb[1]), image_byte(rgb[2]));
}

/* ---- the picture ---- */

enum { SCALE = 2, PAD = 8, SWATCH = 24, LINE = FONT_HEIGHT * SCALE + PAD, ROW_LEAST = 10 /* letters */ };

static void fill(Image *image, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, const float rgb[3], bool hatched)
{
    for (uint32_t y = y0; y < y1 && y < image->height; y++)
        for (uint32_t x = x0; x < x1 && x < image->width; x++)
            for (size_t c = 0; c < 3; c++)
                image->pixels[3 * ((size_t)y * image->width + x) + c] = hatched && (x + y) % 8 >= 3 ? 0.92f : rgb[c];
}

/* 1, 2 or 5 times a power of ten: a length that fits into a quarter of the picture. */
static double bar_length(double width)
{
    double power = pow(10, floor(log10(width / 4)));
    return width / 4 >= 5 * power ? 5 * power : width / 4 >= 2 * power ? 2 * power : power;
}

/* How long the bar is, and what it says. */
typedef struct ScaleBar {
    char text[40];
    uint32_t pixels, width; /* of the bar; of the wider of both */
} ScaleBar;

static ScaleBar bar_make(const CheckSlice *slice, const Scene *scene)
{
    static const char *const names[] = {"m", "cm", "mm", "um", "nm"};
    static const double sizes[] = {1, 1e-2, 1e-3, 1e-6, 1e-9};
    double length = bar_length(slice->plane.width * scene->unit_m);
    size_t i = 0;
    while (i + 1 < COUNT_OF(sizes) && length < sizes[i] * 0.999) i++;
    ScaleBar bar = {.pixels = (uint32_t)(length / scene->unit_m / slice->plane.width * slice->image.width)};
    snprintf(bar.text, sizeof bar.text, "%.4g %s", length / sizes[i], names[i]);
    uint32_t width = font_width(bar.text, SCALE);
    bar.width = width > bar.pixels ? width : bar.pixels;
    return bar;
}

static void draw_bar(const ScaleBar *bar, Image *image, uint32_t y)
{
    uint32_t right = image->width - PAD, left = bar->pixels < right ? right - bar->pixels : 0;
    uint32_t width = font_width(bar->text, SCALE);
    fill(image, left, y, right, y + 3, slice_line_color, false);
    font_draw(image, width < right ? right - width : 0, y + 7, SCALE, bar->text, slice_line_color);
}

/* How many bytes of a text go into a row: up to a blank, or all that fit; all where next to nothing does, to be cut. */
static size_t row_length(const char *text, uint32_t width)
{
    uint32_t most = width / (FONT_ADVANCE * SCALE), n = 0;
    size_t i = 0, blank = 0;
    if (most < ROW_LEAST) return strlen(text);
    while (text[i] && n < most) {
        if (text[i] == ' ') blank = i;
        for (i++; ((unsigned char)text[i] & 0xc0) == 0x80;) i++;
        n++;
    }
    return !text[i] || text[i] == ' ' || !blank ? i : blank;
}

/* Draws a line in as many rows as it takes, the first at y; without an image it only counts them. */
static uint32_t draw_line(const LegendLine *line, uint32_t width, Image *image, uint32_t y)
{
    char text[2 * LEGEND_TEXT];
    const uint32_t left = PAD + SWATCH + PAD, room = width > left + PAD ? width - left - PAD : 0;
    uint32_t rows = 0;
    snprintf(text, sizeof text, "%s%s%s", line->medium, *line->medium ? ": " : "", line->text);
    if (image) {
        fill(image, PAD - 1, y - 1, PAD + SWATCH + 1, y + FONT_HEIGHT * SCALE + 1, slice_line_color, false);
        fill(image, PAD, y, PAD + SWATCH, y + FONT_HEIGHT * SCALE, line->rgb, line->hatched);
    }
    for (const char *rest = text; *rest; rows++) {
        char row[sizeof text];
        size_t n = row_length(rest, room);
        snprintf(row, sizeof row, "%.*s", (int)n, rest);
        if (image) font_draw(image, left, y + rows * LINE, SCALE, row, slice_line_color);
        for (rest += n; *rest == ' ';) rest++;
    }
    return rows;
}

/* Whether the bar fits beside the first line, to its right. */
static bool bar_fits(const ScaleBar *bar, const Legend *legend, uint32_t width)
{
    if (legend->n == 0) return true;
    const LegendLine *line = &legend->lines[0];
    uint32_t text = font_width(line->medium, SCALE) + font_width(": ", SCALE) + font_width(line->text, SCALE);
    return PAD + SWATCH + PAD + text + PAD + bar->width + PAD <= width;
}

static Status compose(const CheckSlice *slice, const Scene *scene, const Legend *legend, Image *image, Error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    static const float paper[3] = {0.97f, 0.97f, 0.97f};
    const SliceImage *drawn = &slice->image;
    ScaleBar bar = bar_make(slice, scene);
    bool beside = bar_fits(&bar, legend, drawn->width);
    uint32_t rows = 0;
    for (size_t i = 0; i < legend->n; i++) rows += draw_line(&legend->lines[i], drawn->width, NULL, 0);
    uint32_t bar_row = beside ? 0 : rows, n_rows = beside ? rows : rows + 1;
    TRY(image_new(drawn->width, drawn->height + (n_rows > 2 ? n_rows : 2) * LINE + PAD, names, 3, image, error));
    memcpy(image->pixels, drawn->rgb, 3 * (size_t)drawn->width * drawn->height * sizeof(float));
    fill(image, 0, drawn->height, drawn->width, image->height, paper, false);
    fill(image, 0, drawn->height, drawn->width, drawn->height + 1, slice_line_color, false);
    rows = 0;
    for (size_t i = 0; i < legend->n; i++)
        rows += draw_line(&legend->lines[i], drawn->width, image, drawn->height + PAD + rows * LINE);
    draw_bar(&bar, image, drawn->height + PAD + bar_row * LINE);
    return STATUS_OK;
}

/* The region as asked for, widened to the shape of the picture; the picture as the region wants it, where no size is
 * given. */
static void fit(CheckSlice *slice)
{
    SlicePlane *plane = &slice->plane;
    if (slice->has_region) {
        const double *r = slice->region;
        plane->width = r[2] - r[0];
        plane->height = r[3] - r[1];
        plane->center =
            vec3_along(vec3_along(slice->point, (r[0] + r[2]) / 2, plane->right), (r[1] + r[3]) / 2, plane->up);
    }
    if (!slice->width) {
        double longer = fmax(plane->width, plane->height);
        slice->width = (uint32_t)fmax(SHORT_SIDE, floor(LONG_SIDE * plane->width / longer + 0.5));
        slice->height = (uint32_t)fmax(SHORT_SIDE, floor(LONG_SIDE * plane->height / longer + 0.5));
    }
    double aspect = (double)slice->width / slice->height;
    if (plane->width < plane->height * aspect)
        plane->width = plane->height * aspect;
    else
        plane->height = plane->width / aspect;
}

Status check_slice_make(CheckSlice *slice, const CompiledScene *compiled, const CheckRays *rays, Pool *pool,
                        Error *error)
{
    slice->rays = rays;
    TRY(output_probe(slice->path, error)); /* not before the scene was read: it is not to be written over */
    NestPolicy policy = compiled->order.policy;
    if (policy != NEST_AUTOMATIC && policy != NEST_PRIORITY)
        return fail(error, STATUS_USAGE, "option '--slice': under the policy %s what owns a place depends on the ray",
                    nest_policy_text(policy));
    if (!slice_plane_make(compiled, slice->point, slice->normal, &slice->plane))
        return fail(error, STATUS_USAGE, "option '--slice': the scene has no clear objects to cut");
    if (!slice->has_region) check_rays_widen(rays, &slice->plane);
    fit(slice);
    TRY(slice_draw(compiled, pool, &slice->plane, slice->width, slice->height, &slice->image, error));
    check_rays_draw(rays, &slice->plane, &slice->image);
    Legend legend;
    Image image = {0};
    Status status = legend_make(slice, compiled, &legend) ? compose(slice, compiled->scene, &legend, &image, error)
                                                          : fail_memory(error, 0, "a slice");
    if (status == STATUS_OK) status = png_write(slice->path, &image, 8, error);
    image_clear(&image);
    free(legend.lines);
    return status;
}

void check_slice_print(const CheckSlice *slice, const CompiledScene *compiled, Buf *out)
{
    Legend legend;
    buf_format(out, "\nThe slice %s, %u x %u pixels, %.4g x %.4g units\n", slice->path, slice->width, slice->height,
               slice->plane.width, slice->plane.height);
    if (legend_make(slice, compiled, &legend)) {
        for (size_t i = 0; i < legend.n; i++) {
            const LegendLine *line = &legend.lines[i];
            char color[8];
            color_text(line->rgb, color);
            buf_format(out, "  %s  %s%s%s\n", line->hatched ? "hatched" : color, line->medium,
                       *line->medium ? ": " : "", line->text);
        }
    } else {
        out->failed = true;
    }
    free(legend.lines);
}

static void add_vector(JsonWriter *json, const char *key, Vec3 v)
{
    json_add_numbers(json, key, (const double[3]){v.x, v.y, v.z}, 3);
}

void check_slice_print_json(const CheckSlice *slice, const CompiledScene *compiled, JsonWriter *json)
{
    Legend legend;
    json_key(json, "slice");
    json_begin_object(json);
    json_add_text(json, "file", slice->path);
    json_add_whole(json, "width", slice->width);
    json_add_whole(json, "height", slice->height);
    add_vector(json, "center", slice->plane.center);
    add_vector(json, "right", vec3_scale(slice->plane.right, slice->plane.width));
    add_vector(json, "up", vec3_scale(slice->plane.up, slice->plane.height));
    json_add_number(json, "least_gap", slice->image.least_gap); /* infinite: null */
    json_key(json, "colors");
    json_begin_array(json);
    if (!legend_make(slice, compiled, &legend)) json->out->failed = true;
    for (size_t i = 0; i < legend.n; i++) {
        char color[8];
        color_text(legend.lines[i].rgb, color);
        if (legend.lines[i].hatched) continue;
        json_begin_object(json);
        json_add_text(json, "color", color);
        json_add_text(json, "medium", *legend.lines[i].medium ? legend.lines[i].medium : NULL);
        json_add_text(json, "objects", legend.lines[i].text);
        json_end(json);
    }
    json_end(json);
    json_end(json);
    free(legend.lines);
}

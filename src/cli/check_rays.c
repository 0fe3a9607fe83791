/* check_rays.c - the rays of light that `check --ray` follows: their options, what is said of them, and how they are drawn.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/check_rays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/num.h"
#include "check/report.h"
#include "check/report_table.h"
#include "cli/viewpoint.h"
#include "optics/color.h"

enum { RAYS_IN_RANGE = 9, RAYS_MOST = 10000, ENDS_SHOWN = 100, WAYS_SHOWN = 20 };

/* ---- options ---- */

static Status refuse(const char *text, const char *why, Error *error)
{
    return fail(
        error, STATUS_USAGE,
        "option '--ray': '%s' %s: write a pixel, as 320,240, or a place and a direction, as -50,0,0:1,0,0, in the "
        "scene's unit; of several rays the first and the last, as -50,-9,0..-50,9,0:1,0,0/19",
        text, why);
}

/* A vector, or the first and the last of several; NULL: it is none. */
static const char *read_ends(const char *text, Vec3 ends[2], bool *range)
{
    double numbers[2][3];
    const char *end = num_parse_list(text, numbers[0], 3);
    bool several = end && strncmp(end, "..", 2) == 0;
    if (several) end = num_parse_list(end + 2, numbers[1], 3);
    for (int i = 0; end && i < 2; i++) {
        const double *v = numbers[several ? i : 0];
        ends[i] = vec3(v[0], v[1], v[2]);
    }
    *range = *range || several;
    return end;
}

static Status read_wish(const char *text, RayWish *wish, Error *error)
{
    *wish = (RayWish){.text = text, .n = 1};
    const char *end = num_parse_list(text, wish->pixel, 2);
    if (end && !*end) {
        wish->through_pixel = true;
        bool whole = true;
        for (int i = 0; i < 2; i++)
            whole =
                whole && wish->pixel[i] == floor(wish->pixel[i]) && wish->pixel[i] >= 0 && wish->pixel[i] <= UINT32_MAX;
        if (whole) return STATUS_OK;
        return refuse(text, "is no pixel", error);
    }
    bool range = false;
    end = read_ends(text, wish->from, &range);
    if (!end || *end != ':') return refuse(text, end && !*end ? "has no direction" : "is no ray", error);
    end = read_ends(end + 1, wish->along, &range);
    if (!end) return refuse(text, "has no direction", error);
    if (range) wish->n = RAYS_IN_RANGE;
    if (*end == '/') {
        double n;
        end = num_parse_list(end + 1, &n, 1);
        if (!end || *end || n != floor(n) || n < 1 || n > RAYS_MOST)
            return refuse(text, "does not say how many, from 1 to 10000", error);
        if (!range && n > 1) return refuse(text, "has several rays, but only one place and one direction", error);
        wish->n = (uint32_t)n;
    }
    if (*end) return refuse(text, "is no ray", error);
    for (int i = 0; i < 2; i++)
        if (!(vec3_length(wish->along[i]) > 0)) return refuse(text, "has a direction of 0", error);
    return STATUS_OK;
}

static Status read_wavelengths(CheckRays *rays, const char *text, Error *error)
{
    const double least = (double)SPECTRUM_MIN_NM, most = (double)SPECTRUM_MAX_NM;
    for (const char *at = text;; at++) {
        double *nm = &rays->nm[rays->n_nm];
        if (rays->n_nm == RAY_WAVELENGTHS)
            return fail(error, STATUS_USAGE, "option '--ray-wavelength': '%s' has more than %d wavelengths", text,
                        RAY_WAVELENGTHS);
        at = num_parse_list(at, nm, 1);
        if (!at || (*at && *at != ',') || *nm < least || *nm > most)
            return fail(error, STATUS_USAGE,
                        "option '--ray-wavelength': '%s' is not a wavelength in nm, from %.0f to %.0f, or several, as "
                        "656.3,587.6,486.1",
                        text, least, most);
        rays->n_nm++;
        if (!*at) return STATUS_OK;
    }
}

Status check_rays_init(CheckRays *rays, const Options *options, Error *error)
{
    const double sodium_nm = 589.3, usual_least = 0.1;
    const OptionValue *wishes = &options->values[OPTION_RAY];
    const char *wavelengths = option_text(options, OPTION_RAY_WAVELENGTH, NULL);
    bool limited = option_given(options, OPTION_RAY_LEAST);
    *rays = (CheckRays){.least = limited ? options->values[OPTION_RAY_LEAST].number : usual_least};
    if (!wishes->n_items) {
        if (!wavelengths && !limited) return STATUS_OK;
        return fail(error, STATUS_USAGE, "option '--ray-%s' means nothing without '--ray'",
                    wavelengths ? "wavelength" : "least");
    }
    rays->wishes = calloc(wishes->n_items, sizeof *rays->wishes);
    if (!rays->wishes) return fail_memory(error, wishes->n_items * sizeof *rays->wishes, "rays");
    rays->nm[0] = sodium_nm;
    if (wavelengths)
        TRY(read_wavelengths(rays, wavelengths, error));
    else
        rays->n_nm = 1;
    for (; rays->n_wishes < wishes->n_items; rays->n_wishes++) {
        RayWish *wish = &rays->wishes[rays->n_wishes];
        TRY(read_wish(wishes->items[rays->n_wishes], wish, error));
        rays->n += wish->n * (size_t)rays->n_nm;
    }
    if (rays->n <= RAYS_MOST) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '--ray': these are %zu rays, and %d are the most", rays->n, RAYS_MOST);
}

void check_rays_clear(CheckRays *rays)
{
    for (size_t i = 0; rays->items && i < rays->n; i++) light_ways_clear(&rays->items[i].ways);
    free(rays->items);
    free(rays->wishes);
    *rays = (CheckRays){0};
}

/* ---- where they go ---- */

static Vec3 between(const Vec3 ends[2], double part)
{
    return vec3_along(ends[0], part, vec3_sub(ends[1], ends[0]));
}

static Status make_ray(const RayWish *wish, uint32_t number, const World *world, RayView view, Ray *ray, Error *error)
{
    if (!wish->through_pixel) {
        double part = wish->n > 1 ? (double)number / (wish->n - 1) : 0;
        Vec3 along = vec3_normalize(between(wish->along, part));
        *ray = ray_make(vec3_rounded(between(wish->from, part)), vec3f_from(along));
        if (vec3_length(along) > 0) return STATUS_OK;
        return fail(error, STATUS_USAGE, "option '--ray': '%s': direction %u of %u is 0", wish->text, number + 1,
                    wish->n);
    }
    const uint32_t pixel[2] = {(uint32_t)wish->pixel[0], (uint32_t)wish->pixel[1]};
    return viewpoint_ray(world->compiled, view.camera, pixel, view.width, view.height, "--ray", ray, error);
}

static Status follow(CheckRays *rays, const World *world, RayView view, Error *error)
{
    size_t n = 0;
    for (size_t i = 0; i < rays->n_wishes; i++)
        for (uint32_t k = 0; k < rays->wishes[i].n; k++)
            for (uint32_t w = 0; w < rays->n_nm; w++) {
                CheckRay *item = &rays->items[n++];
                Error own = {0};
                item->nm = (float)rays->nm[w];
                TRY(make_ray(&rays->wishes[i], k, world, view, &item->ray, error));
                Status status = light_ways_find(world, &item->ray, item->nm, (float)rays->least, &item->ways, &own);
                if (status == STATUS_OK) continue;
                Vec3 at = item->ray.origin;
                return fail(error, status, "option '--ray': at %g, %g, %g: %s", at.x, at.y, at.z, own.text);
            }
    return STATUS_OK;
}

Status check_rays_find(CheckRays *rays, const CompiledScene *compiled, RayView view, Pool *pool, Error *error)
{
    if (!rays->n) return STATUS_OK;
    rays->items = calloc(rays->n, sizeof *rays->items);
    if (!rays->items) return fail_memory(error, rays->n * sizeof *rays->items, "rays");
    World world;
    TRY(world_init(&world, compiled, view.camera, compiled->scene->render.bounces, false, pool, error));
    Status status = follow(rays, &world, view, error);
    world_clear(&world);
    return status;
}

/* ---- what is said of them ---- */

static void add_vector(Buf *out, Vec3 v)
{
    buf_format(out, "%.6g, %.6g, %.6g", v.x, v.y, v.z);
}

static void add_direction(Buf *out, Vec3f v)
{
    const double tidy = 1e-6; /* what rounding leaves of 0 */
    double c[3] = {(double)v.x, (double)v.y, (double)v.z};
    for (int i = 0; i < 3; i++) c[i] = fabs(c[i]) < tidy ? 0 : c[i];
    buf_format(out, "%.5g, %.5g, %.5g", c[0], c[1], c[2]);
}

static void add_part(Buf *out, float part)
{
    buf_format(out, "%.3g %%", 100 * (double)part);
}

static double degrees(double radians)
{
    return radians / MEN_DEGREE;
}

/* Directions are of single precision: what is less than they hold is no angle. */
static void add_angle(Buf *out, double radians)
{
    double angle = degrees(radians);
    buf_format(out, "%.4g\u00b0", angle < 2e-5 ? 0 : angle);
}

static void print_step(const CompiledScene *compiled, const LightStep *step, uint32_t number, Buf *row)
{
    const Scene *scene = compiled->scene;
    const char *medium = scene->media[step->medium].name;
    buf_format(&row[0], "%u", number);
    if (isfinite(step->length)) report_add_length(&row[1], scene, step->length);
    if (step->object != SCENE_NONE) buf_add(&row[2], scene->objects[step->object].name);
    add_part(&row[5], step->carried);
    switch (step->turn) {
    case LIGHT_ENDS: buf_add(&row[3], "ends there"); return;
    case LIGHT_LEAVES:
        buf_add(&row[3], "leaves the scene along ");
        add_direction(&row[3], step->direction);
        return;
    case LIGHT_DROPPED: buf_format(&row[3], "after %u surfaces it is followed no farther", number - 1); return;
    case LIGHT_TOTAL: buf_format(&row[3], "mirrored totally, in %s", medium); break;
    case LIGHT_MIRRORED:
        buf_format(&row[3], "mirrored, in %s: ", medium);
        add_part(&row[3], step->part);
        break;
    case LIGHT_PASSES:
        if (step->to == step->medium)
            buf_add(&row[3], "goes through: ");
        else
            buf_format(&row[3], "from %s to %s: ", medium, scene->media[step->to].name);
        add_part(&row[3], step->part);
        break;
    }
    if (step->wave != CRYSTAL_UNPOLARIZED) buf_format(&row[3], ", %s", crystal_wave_name(step->wave));
    if (step->scatters) buf_add(&row[3], ", spread around this way");
    add_angle(&row[4], (double)step->angle);
    if (step->turn == LIGHT_PASSES) {
        buf_add(&row[4], " to ");
        add_angle(&row[4], (double)step->on);
    }
}

static double turned_by(const CheckRay *ray, const LightStep *last)
{
    return vec3_angle(vec3_from_f(ray->ray.direction), vec3_from_f(last->direction));
}

static const LightStep *last_step(const LightWays *ways, const LightWay *way)
{
    return &ways->steps[way->first + way->n - 1];
}

static void print_way(const CompiledScene *compiled, const CheckRay *ray, uint32_t number, Buf *out)
{
    const LightWay *way = &ray->ways.ways[number];
    const LightStep *last = last_step(&ray->ways, way);
    ReportTable table = {.n_columns = 6, .right = {[0] = true, [1] = true, [5] = true}};
    if (way->from != SCENE_NONE)
        buf_format(out, "\nWay %u, which parts from way %u at its surface %u\n", number + 1, way->from + 1,
                   way->depth + 1);
    for (uint32_t k = 0; k < way->n; k++)
        print_step(compiled, &ray->ways.steps[way->first + k], way->depth + k + 1, report_row(&table));
    report_print_table(&table, out);
    if (last->turn == LIGHT_LEAVES && way->depth + way->n == 1) {
        buf_add(out, "  it meets nothing\n");
        return;
    }
    buf_add(out, "  turned by ");
    add_angle(out, turned_by(ray, last));
    buf_add(out, " in all; the optical path ");
    if (last->turn == LIGHT_LEAVES) buf_add(out, "up to the last surface ");
    buf_add(out, "is ");
    report_add_length(out, compiled->scene, way->optical);
    buf_add(out, "\n");
}

/* One ray, with all that it meets. */
static void print_ray(const CompiledScene *compiled, const CheckRay *ray, double least, Buf *out)
{
    const LightWays *ways = &ray->ways;
    buf_format(out, "Light of %g nm from ", (double)ray->nm);
    add_vector(out, ray->ray.origin);
    buf_format(out, ", in %s, along ", compiled->scene->media[ways->start].name);
    add_direction(out, ray->ray.direction);
    buf_add(out, "\n");
    for (uint32_t i = 0; i < ways->n_ways && i < WAYS_SHOWN; i++) print_way(compiled, ray, i, out);
    if (ways->n_ways > WAYS_SHOWN)
        buf_format(out, "\nand %zu ways more: '--json' lists them all\n", ways->n_ways - WAYS_SHOWN);
    if (ways->cut) buf_format(out, "There are more than %d ways of at least %g %%.\n", LIGHT_WAYS, 100 * least);
}

/* What a way does at one surface after another: p passes, m is mirrored. */
static void add_turns(const LightWays *ways, uint32_t way, Buf *out)
{
    enum { MOST = 24 };
    const LightWay *own = &ways->ways[way];
    uint32_t n = own->depth + own->n - 1;
    for (uint32_t k = 0; k < n && k < MOST; k++)
        buf_add(out, light_ways_step(ways, way, k)->turn == LIGHT_PASSES ? "p" : "m");
    if (n > MOST) buf_add(out, "...");
}

static void print_end(const CompiledScene *compiled, const CheckRays *rays, size_t number, uint32_t way, Buf *row)
{
    const CheckRay *ray = &rays->items[number];
    const LightStep *last = last_step(&ray->ways, &ray->ways.ways[way]);
    if (way == 0) {
        buf_format(&row[0], "%zu", number / rays->n_nm + 1);
        if (rays->n_nm > 1) buf_format(&row[1], "%g nm", (double)ray->nm);
    }
    add_turns(&ray->ways, way, &row[2]);
    if (last->turn == LIGHT_ENDS) {
        buf_format(&row[3], "%s at ", compiled->scene->objects[last->object].name);
        add_vector(&row[3], last->place);
    } else if (last->turn == LIGHT_LEAVES) {
        buf_add(&row[3], "leaves along ");
        add_direction(&row[3], last->direction);
    } else {
        buf_add(&row[3], "is followed no farther");
    }
    add_angle(&row[4], turned_by(ray, last));
    add_part(&row[5], last->carried);
}

/* Of several rays, where they end. */
static void print_ends(const CompiledScene *compiled, const CheckRays *rays, Buf *out)
{
    size_t n_ways = 0;
    bool cut = false;
    ReportTable table = {.n_columns = 6, .right = {[0] = true, [1] = true, [4] = true, [5] = true}};
    buf_format(
        out,
        "Where %zu rays of light end: how each passes (p) or is mirrored (m), by what it is turned in all, and what "
        "of it comes there\n",
        rays->n);
    for (size_t i = 0; i < rays->n; i++) {
        const LightWays *ways = &rays->items[i].ways;
        cut = cut || ways->cut;
        for (uint32_t w = 0; w < ways->n_ways; w++)
            if (n_ways++ < ENDS_SHOWN) print_end(compiled, rays, i, w, report_row(&table));
    }
    report_print_table(&table, out);
    if (n_ways > ENDS_SHOWN) buf_format(out, "  and %zu more: '--json' lists them all\n", n_ways - ENDS_SHOWN);
    if (cut) buf_format(out, "  Some rays have more than %d ways of at least %g %%.\n", LIGHT_WAYS, 100 * rays->least);
}

void check_rays_print(const CheckRays *rays, const CompiledScene *compiled, Buf *out)
{
    buf_add(out, "\n");
    if (rays->n == 1)
        print_ray(compiled, &rays->items[0], rays->least, out);
    else
        print_ends(compiled, rays, out);
}

static void add_json_direction(JsonWriter *json, const char *key, Vec3f v)
{
    const float c[3] = {v.x, v.y, v.z};
    json_key(json, key);
    json_begin_array(json);
    for (int i = 0; i < 3; i++) json_float(json, c[i]);
    json_end(json);
}

static void print_step_json(const Scene *scene, const LightStep *step, JsonWriter *json)
{
    static const char *const turns[] = {"passes", "mirrored", "total", "ends", "leaves", "dropped"};
    json_begin_object(json);
    json_add_text(json, "turn", turns[step->turn]);
    json_add_number(json, "length", step->length); /* infinite: null */
    json_add_numbers(json, "place", (const double[3]){step->place.x, step->place.y, step->place.z}, 3);
    add_json_direction(json, "direction", step->direction);
    json_add_text(json, "object", step->object == SCENE_NONE ? NULL : scene->objects[step->object].name);
    json_add_text(json, "medium", scene->media[step->medium].name);
    json_add_float(json, "index", step->index);
    json_add_text(json, "to", step->turn == LIGHT_PASSES ? scene->media[step->to].name : NULL);
    json_add_number(json, "angle", degrees((double)step->angle));
    /* 0 would be an angle: null */
    json_add_number(json, "angle_on", step->turn == LIGHT_PASSES ? degrees((double)step->on) : HUGE_VAL);
    json_add_text(json, "wave", crystal_wave_name(step->wave));
    json_add_float(json, "part", step->part);
    json_add_float(json, "transmitted", step->transmitted);
    json_add_float(json, "mirrored", step->mirrored);
    json_add_float(json, "carried", step->carried);
    json_add_truth(json, "scatters", step->scatters);
    json_end(json);
}

static void print_way_json(const Scene *scene, const CheckRay *ray, const LightWay *way, JsonWriter *json)
{
    json_begin_object(json);
    json_key(json, "from_way");
    if (way->from == SCENE_NONE)
        json_text(json, NULL);
    else
        json_whole(json, way->from);
    json_add_whole(json, "from_step", way->depth);
    json_add_number(json, "turned", degrees(turned_by(ray, last_step(&ray->ways, way))));
    json_add_number(json, "optical_length", way->optical);
    json_key(json, "steps");
    json_begin_array(json);
    for (uint32_t k = 0; k < way->n; k++) print_step_json(scene, &ray->ways.steps[way->first + k], json);
    json_end(json);
    json_end(json);
}

void check_rays_print_json(const CheckRays *rays, const CompiledScene *compiled, JsonWriter *json)
{
    const Scene *scene = compiled->scene;
    json_key(json, "rays");
    json_begin_array(json);
    for (size_t i = 0; i < rays->n; i++) {
        const CheckRay *ray = &rays->items[i];
        const Vec3 from = ray->ray.origin;
        json_begin_object(json);
        json_add_float(json, "wavelength", ray->nm);
        json_add_numbers(json, "from", (const double[3]){from.x, from.y, from.z}, 3);
        add_json_direction(json, "along", ray->ray.direction);
        json_add_text(json, "start", scene->media[ray->ways.start].name);
        json_add_truth(json, "complete", !ray->ways.cut);
        json_key(json, "ways");
        json_begin_array(json);
        for (size_t w = 0; w < ray->ways.n_ways; w++) print_way_json(scene, ray, &ray->ways.ways[w], json);
        json_end(json);
        json_end(json);
    }
    json_end(json);
}

/* ---- how they are drawn ---- */

void check_rays_color(const CheckRays *rays, double nm, float rgb[3])
{
    static const float alone[3] = {0.72f, 0, 0.5f};
    const double darkest = 0.85, gamma = 1 / 2.4;
    for (int i = 0; i < 3; i++) rgb[i] = alone[i];
    if (rays->n_nm == 1) return; /* a yellow line would hardly be seen */
    WavelengthSample wavelengths = {lanes_all((float)nm), lanes_all(1)};
    color_from_lanes(lanes_all(1), &wavelengths, rgb);
    float largest = fmaxf(fmaxf(rgb[0], rgb[1]), fmaxf(rgb[2], 1e-12f));
    for (int i = 0; i < 3; i++) rgb[i] = (float)(darkest * pow(fmax((double)(rgb[i] / largest), 0), gamma));
}

typedef struct PlanePoint {
    double x, y;
} PlanePoint;

static PlanePoint on_plane(const SlicePlane *plane, Vec3 place)
{
    Vec3 at = vec3_sub(place, plane->center);
    return (PlanePoint){vec3_dot(at, plane->right), vec3_dot(at, plane->up)};
}

void check_rays_widen(const CheckRays *rays, SlicePlane *plane)
{
    const double most = 0.75, margin = 0.05,
                 on = 0.3; /* to each side, of the longer one; so much of what leaves is shown */
    double longer = fmax(plane->width, plane->height);
    double low[2] = {-plane->width / 2, -plane->height / 2}, high[2] = {plane->width / 2, plane->height / 2};
    for (size_t i = 0; i < rays->n; i++) {
        const LightWays *ways = &rays->items[i].ways;
        for (size_t k = 0; k <= ways->n_steps; k++) {
            const LightStep *step = k ? &ways->steps[k - 1] : NULL;
            Vec3 place = step ? step->place : rays->items[i].ray.origin;
            if (step && step->turn == LIGHT_LEAVES)
                place = vec3_along(place, on * longer, vec3_from_f(step->direction));
            PlanePoint at = on_plane(plane, place);
            const double c[2] = {at.x, at.y}, half[2] = {plane->width / 2, plane->height / 2};
            for (int axis = 0; axis < 2; axis++) {
                double limit = half[axis] + most * longer, by = margin * longer;
                if (c[axis] - by < low[axis]) low[axis] = fmax(c[axis] - by, -limit);
                if (c[axis] + by > high[axis]) high[axis] = fmin(c[axis] + by, limit);
            }
        }
    }
    plane->center =
        vec3_along(vec3_along(plane->center, (low[0] + high[0]) / 2, plane->right), (low[1] + high[1]) / 2, plane->up);
    plane->width = high[0] - low[0];
    plane->height = high[1] - low[1];
}

/* In pixels, from the upper left corner. */
static PlanePoint in_picture(const SlicePlane *plane, const SliceImage *image, Vec3 place)
{
    PlanePoint at = on_plane(plane, place);
    return (PlanePoint){(at.x / plane->width + 0.5) * image->width, (0.5 - at.y / plane->height) * image->height};
}

/* Cuts a line to the picture, and what ink reaches beyond; false: none of it is there. */
static bool cut_line(const SliceImage *image, double reach, PlanePoint *a, PlanePoint *b)
{
    double from = 0, to = 1;
    const double start[2] = {a->x, a->y}, step[2] = {b->x - a->x, b->y - a->y};
    const double size[2] = {image->width, image->height};
    for (int axis = 0; axis < 2; axis++) {
        double low = -reach - start[axis], high = size[axis] + reach - start[axis];
        if (step[axis] == 0) {
            if (low > 0 || high < 0) return false;
            continue;
        }
        double first = low / step[axis], last = high / step[axis];
        from = fmax(from, fmin(first, last));
        to = fmin(to, fmax(first, last));
    }
    if (!(from <= to)) return false;
    *b = (PlanePoint){start[0] + to * step[0], start[1] + to * step[1]};
    *a = (PlanePoint){start[0] + from * step[0], start[1] + from * step[1]};
    return true;
}

static void blend(SliceImage *image, int64_t x, int64_t y, double ink, const float rgb[3])
{
    if (x < 0 || y < 0 || x >= image->width || y >= image->height || !(ink > 0)) return;
    float *pixel = image->rgb + 3 * ((size_t)y * image->width + (size_t)x);
    for (int c = 0; c < 3; c++) pixel[c] += (float)fmin(ink, 1) * (rgb[c] - pixel[c]);
}

/* One column of pixels after another, or row where the line is steep: each gets ink on both sides of the line, by how far it is. */
static void draw_line(SliceImage *image, PlanePoint a, PlanePoint b, double ink, const float rgb[3])
{
    const double half_width = 0.75;
    if (!cut_line(image, 2 * half_width, &a, &b)) return;
    bool steep = fabs(b.y - a.y) > fabs(b.x - a.x);
    double along[2] = {steep ? a.y : a.x, steep ? b.y : b.x}, across[2] = {steep ? a.x : a.y, steep ? b.x : b.y};
    if (along[0] == along[1]) return;
    double slope = (across[1] - across[0]) / (along[1] - along[0]), narrow = sqrt(1 + slope * slope);
    double first = fmin(along[0], along[1]), last = fmax(along[0], along[1]);
    for (int64_t i = (int64_t)floor(first); (double)i < last; i++) {
        double covered = fmin(last, (double)i + 1) - fmax(first, (double)i);
        double middle = across[0] + slope * ((double)i + 0.5 - along[0]), reach = (half_width + 0.5) * narrow;
        for (int64_t k = (int64_t)floor(middle - reach); (double)k <= middle + reach; k++) {
            double distance = fabs((double)k + 0.5 - middle) / narrow;
            double part = fmin(half_width + 0.5 - distance, 1) * fmin(covered, 1) * ink;
            blend(image, steep ? k : i, steep ? i : k, part, rgb);
        }
    }
}

/* Weak ones are paler, but can still be seen. */
static double ink_of(float carried)
{
    return fmin(fmax(cbrt((double)carried), 0.2), 1);
}

void check_rays_draw(const CheckRays *rays, const SlicePlane *plane, SliceImage *image)
{
    for (size_t i = 0; i < rays->n; i++) {
        const CheckRay *ray = &rays->items[i];
        float rgb[3];
        check_rays_color(rays, (double)ray->nm, rgb);
        for (size_t w = ray->ways.n_ways; w-- > 0;) { /* the first way over all others */
            const LightWay *way = &ray->ways.ways[w];
            const LightStep *steps = ray->ways.steps + way->first;
            for (uint32_t k = 0; k < way->n; k++) {
                if (k == 0 && way->from != SCENE_NONE) continue; /* the way to there is the other one's */
                Vec3 from = k ? steps[k - 1].place : ray->ray.origin, to = steps[k].place;
                if (!isfinite(steps[k].length)) {
                    double far = 4 * (plane->width + plane->height + vec3_length(vec3_sub(from, plane->center)));
                    to = vec3_along(from, far, vec3_from_f(steps[k].direction));
                }
                draw_line(image, in_picture(plane, image, from), in_picture(plane, image, to), ink_of(steps[k].carried),
                          rgb);
            }
        }
    }
}

/* cmd_compare.c - the command compare: how much two pictures differ.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "cli/commands.h"
#include "cli/output.h"
#include "image/compare.h"

static void print_text(const Comparison *c, bool flip, Buf *out)
{
    if (c->white != 1) buf_format(out, "white           %.6g\n", c->white);
    buf_format(out, "rmse            %.6g\n", c->rmse);
    buf_format(out, "relative mse    %.6g\n", c->relative_mse);
    buf_format(out, "relative error  %.6g\n", c->relative_error);
    buf_format(out, "largest         %.6g at %u,%u\n", c->max_difference, c->max_x, c->max_y);
    buf_format(out, "mean of A       %.6g %.6g %.6g\n", c->mean_a[0], c->mean_a[1], c->mean_a[2]);
    buf_format(out, "mean of B       %.6g %.6g %.6g\n", c->mean_b[0], c->mean_b[1], c->mean_b[2]);
    if (flip) buf_format(out, "flip            %.6g\n", c->flip);
    if (c->n_not_finite) buf_format(out, "not finite      %llu\n", (unsigned long long)c->n_not_finite);
}

static void add_numbers(JsonWriter *json, const char *key, const double numbers[3])
{
    json_key(json, key);
    json_begin_array(json);
    for (int i = 0; i < 3; i++) json_number(json, numbers[i]);
    json_end(json);
}

static void print_json(const Comparison *c, bool flip, Buf *out)
{
    JsonWriter json = json_writer(out, true);
    json_begin_object(&json);
    json_add_number(&json, "white", c->white);
    json_add_number(&json, "rmse", c->rmse);
    json_add_number(&json, "relativeMse", c->relative_mse);
    json_add_number(&json, "relativeError", c->relative_error);
    json_add_number(&json, "maxDifference", c->max_difference);
    json_add_whole(&json, "maxX", c->max_x);
    json_add_whole(&json, "maxY", c->max_y);
    add_numbers(&json, "meanA", c->mean_a);
    add_numbers(&json, "meanB", c->mean_b);
    if (flip) json_add_number(&json, "flip", c->flip);
    json_add_whole(&json, "notFinite", c->n_not_finite);
    json_end(&json);
    buf_add(out, "\n");
}

static Status judge(const Options *options, const Comparison *comparison, Error *error)
{
    if (!option_given(options, OPTION_MAX_RMSE)) return STATUS_OK;
    double limit = options->values[OPTION_MAX_RMSE].number;
    if (comparison->n_not_finite)
        return fail(error, STATUS_RENDER, "%llu values are not finite", (unsigned long long)comparison->n_not_finite);
    if (comparison->rmse <= limit) return STATUS_OK;
    return fail(error, STATUS_RENDER, "the root mean square error %.6g is above %.6g", comparison->rmse, limit);
}

/* What a view makes of light, decoding sRGB does not undo. */
static Status read_both(const Options *options, const Talk *talk, Image *a, Image *b, Error *error)
{
    Image *const images[2] = {a, b};
    bool encoded[2];
    for (int i = 0; i < 2; i++) {
        TRY(image_read_as(options->operands[i], images[i], &encoded[i], error));
        if (encoded[i]) image_decode_srgb(images[i]);
    }
    if (encoded[0] == encoded[1]) return STATUS_OK;
    const char *shown = options->operands[encoded[0] ? 0 : 1], *linear = options->operands[encoded[0] ? 1 : 0];
    talk_remark(
        talk,
        "%s is made for a display, and %s has light as it is: where a view lies between, that differs by itself; "
        "to compare what a display shows: meniscus view %s -o FILE.png",
        shown, linear, linear);
    return STATUS_OK;
}

/* What a display shows white of the reference: where its film brightens it, less than 1. */
static double white_of(const char *path, const Image *image)
{
    ColorLook look = output_read_look(path);
    return exp2(-output_look_for(image, &look).exposure.stops);
}

/* Pictures of other sizes are left as they are, for the comparison to refuse them. */
static Status compare_part(const Options *options, Image *a, Image *b, double white, Comparison *comparison,
                           Error *error)
{
    uint32_t crop[4] = {0};
    if (option_given(options, OPTION_COMPARE_CROP) && a->width == b->width && a->height == b->height) {
        TRY(option_crop(options, OPTION_COMPARE_CROP, a->width, a->height, crop, error));
        image_crop(a, crop);
        image_crop(b, crop);
    }
    TRY(image_compare(a, b, white, option_given(options, OPTION_FLIP), comparison, error));
    comparison->max_x += crop[0];
    comparison->max_y += crop[1];
    return STATUS_OK;
}

Status cmd_compare(const Options *options, const Talk *talk, Error *error)
{
    Image a = {0}, b = {0};
    Comparison comparison = {0};
    Buf out = {0};
    bool flip = option_given(options, OPTION_FLIP);
    Status status = read_both(options, talk, &a, &b, error);
    double white = status == STATUS_OK ? white_of(options->operands[1], &b) : 1;
    if (status == STATUS_OK) status = compare_part(options, &a, &b, white, &comparison, error);
    if (status == STATUS_OK) {
        if (option_given(options, OPTION_JSON))
            print_json(&comparison, flip, &out);
        else if (!talk->quiet)
            print_text(&comparison, flip, &out);
        status = print_out(&out, error);
    }
    if (status == STATUS_OK) status = judge(options, &comparison, error);
    buf_clear(&out);
    image_clear(&a);
    image_clear(&b);
    return status;
}

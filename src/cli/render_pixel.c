/* render_pixel.c - --pixel: one pixel of the picture, its values printed.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "cli/render_run.h"

Status render_merge_pixel(RenderRun *run, Error *error)
{
    const Options *options = run->options;
    RenderSettings *settings = &run->settings;
    const uint32_t *at = options->values[OPTION_RENDER_PIXEL].whole;
    if (!option_given(options, OPTION_RENDER_PIXEL)) return STATUS_OK;
    if (option_given(options, OPTION_CROP))
        return fail(error, STATUS_USAGE,
                    "'--pixel' renders one pixel, and '--crop' those of a rectangle: one of them is too many");
    if (at[0] >= settings->width || at[1] >= settings->height)
        return fail(error, STATUS_USAGE, "option '--pixel': %u,%u is no pixel of the picture, 0,0 to %u,%u", at[0],
                    at[1], settings->width - 1, settings->height - 1);
    const uint32_t crop[4] = {at[0], at[1], at[0] + 1, at[1] + 1};
    for (int i = 0; i < 4; i++) settings->crop[i] = crop[i];
    settings->spreads = settings->denoises = false; /* there is nothing around it */
    return STATUS_OK;
}

/* "#8a5c1f" */
static Status print_shown(const RenderRun *run, const float *values, Buf *out, Error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    Image pixel, shown;
    int rgb[3];
    ColorLook look = render_look(run);
    if (!image_rgb(&run->image, rgb) || look.exposure.automatic)
        return STATUS_OK; /* the whole picture would say by how much */
    TRY(image_new(1, 1, names, 3, &pixel, error));
    for (int c = 0; c < 3; c++) pixel.pixels[c] = values[rgb[c]];
    look.alpha = false;
    Status status = image_for_display(&pixel, run->input.color.config, &look, &shown, error);
    if (status == STATUS_OK) {
        buf_add(out, "display #");
        for (int c = 0; c < 3; c++) buf_format(out, "%02x", image_byte(shown.pixels[c]));
        buf_add(out, "\n");
    }
    image_clear(&shown);
    image_clear(&pixel);
    return status;
}

Status render_print_pixel(const RenderRun *run, Error *error)
{
    const uint32_t *at = run->options->values[OPTION_RENDER_PIXEL].whole;
    if (!option_given(run->options, OPTION_RENDER_PIXEL)) return STATUS_OK;
    Buf out = {0};
    const float *values = run->image.pixels; /* it is the only one */
    if (run->plan.numbered) buf_format(&out, "frame %u\n", run->input.scene->frame);
    buf_format(&out, "pixel %u,%u\nsamples %u\n", at[0], at[1], run->stats.most_samples);
    for (uint32_t c = 0; c < run->image.n_channels; c++)
        buf_format(&out, "%s %.6g\n", run->image.names[c], (double)values[c]);
    Status status = print_shown(run, values, &out, error);
    if (status == STATUS_OK) status = print_out(&out, error);
    buf_clear(&out);
    return status;
}

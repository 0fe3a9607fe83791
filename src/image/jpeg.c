/* jpeg.c - JPEG files, through libjpeg-turbo.
 * libjpeg reports an error by a call that must not return; it jumps back into run_reader, whose state lives in a struct
 * outside.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>

#include <jpeglib.h>

#include "base/file.h"
#include "image/exif.h"
#include "image/image.h"

enum { BEST_RATIO = 512, EXIF_MARKER = JPEG_APP0 + 1, LONGEST_MARKER = 0xffff };

typedef struct JpegJob {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    jmp_buf escape;
    char reason[JMSG_LENGTH_MAX];
    unsigned char *bytes; /* what is read */
    size_t n_bytes;
    unsigned char *row; /* owned */
    Image *image;
    Error *error;
    Status status;
} JpegJob;

static void on_error(j_common_ptr jpeg)
{
    JpegJob *job = jpeg->client_data;
    jpeg->err->format_message(jpeg, job->reason);
    longjmp(job->escape, 1);
}

static void on_message(j_common_ptr jpeg)
{
    (void)jpeg;
}

/* What libjpeg goes on after, with pixels that it has made up, ends the reading here. */
static void on_warning(j_common_ptr jpeg, int level)
{
    if (level < 0) on_error(jpeg);
}

/* Others than the camera's notes may stand in such a segment as well. */
static unsigned orientation_of(const struct jpeg_decompress_struct *jpeg)
{
    unsigned orientation = 1;
    for (jpeg_saved_marker_ptr marker = jpeg->marker_list; marker && orientation == 1; marker = marker->next)
        orientation = exif_orientation(marker->data, marker->data_length);
    return orientation;
}

static void read_rows(JpegJob *job)
{
    static const char *const names[3] = {"R", "G", "B"};
    struct jpeg_decompress_struct *jpeg = &job->jpeg;
    jpeg_mem_src(jpeg, job->bytes, (unsigned long)job->n_bytes);
    jpeg_save_markers(jpeg, EXIF_MARKER, LONGEST_MARKER);
    jpeg_read_header(jpeg, TRUE);
    /* each block of 8 by 8 pixels takes at least a bit */
    if ((double)jpeg->image_width * jpeg->image_height > 1e6 + BEST_RATIO * (double)job->n_bytes) {
        snprintf(job->reason, sizeof job->reason, "the file is too short for the size it claims");
        longjmp(job->escape, 1);
    }
    jpeg->out_color_space = JCS_RGB; /* libjpeg refuses what has no way there, such as CMYK */
    jpeg_start_decompress(jpeg);
    job->status = image_new(jpeg->output_width, jpeg->output_height, names, 3, job->image, job->error);
    job->row = malloc((size_t)jpeg->output_width * 3);
    if (job->status == STATUS_OK && !job->row)
        job->status = fail_memory(job->error, (size_t)jpeg->output_width * 3, "a picture");
    if (job->status != STATUS_OK) return;
    float *to = job->image->pixels;
    while (jpeg->output_scanline < jpeg->output_height) {
        jpeg_read_scanlines(jpeg, &job->row, 1);
        for (size_t i = 0; i < (size_t)jpeg->output_width * 3; i++) *to++ = (float)job->row[i] / 255;
    }
    job->status = image_turn_upright(job->image, orientation_of(jpeg), job->error);
    if (job->status == STATUS_OK) jpeg_finish_decompress(jpeg);
}

/* false after a jump: job->reason says why. */
static bool run_reader(JpegJob *job)
{
    job->jpeg.err = jpeg_std_error(&job->errors);
    job->jpeg.client_data = job;
    job->errors.error_exit = on_error;
    job->errors.output_message = on_message;
    job->errors.emit_message = on_warning;
    if (setjmp(job->escape)) return false;
    jpeg_create_decompress(&job->jpeg);
    read_rows(job);
    return true;
}

Status jpeg_read(const char *path, Image *image, Error *error)
{
    *image = (Image){0};
    char *bytes;
    size_t n_bytes;
    TRY(file_read(path, 0, &bytes, &n_bytes, error));
    JpegJob *job = calloc(1, sizeof *job);
    if (!job) {
        free(bytes);
        return fail_memory(error, sizeof *job, "a picture");
    }
    job->bytes = (unsigned char *)bytes;
    job->n_bytes = n_bytes;
    job->image = image;
    job->error = error;
    if (!run_reader(job))
        job->status = fail(error, STATUS_INPUT,
                           "cannot read '%s': the JPEG file is damaged, cut short or of a kind that is not read (%s)",
                           path, job->reason);
    Status status = job->status;
    jpeg_destroy_decompress(&job->jpeg);
    free(job->row);
    free(job);
    free(bytes);
    if (status != STATUS_OK) image_clear(image);
    return status;
}

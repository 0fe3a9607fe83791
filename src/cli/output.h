/* output.h - the files that a render writes: their names, whether they can be written, and the writing.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_OUTPUT_H
#define MEN_OUTPUT_H

#include "cli/scene_input.h"
#include "image/attributes.h"

typedef struct Output {
    char *path; /* "-": standard output */
    bool png;
} Output;

typedef struct OutputList {
    Output *items;
    size_t n;
} OutputList;

/* What the files of all frames are called. */
typedef struct OutputPlan {
    char **names; /* with rows of '#' for the frame's number */
    size_t n;
    bool has_png, has_exr, numbered;
} OutputPlan;

/* From -o, else the scene's film, else the scene's name; none for a single pixel without -o. numbered: a name without '#' gets a
 * row of it, unless it is a device; the number of the last frame says how long. STATUS_USAGE for an unknown extension, or a
 * picture to a terminal. outputs_plan_clear is due in every case. */
ATTR_NODISCARD Status outputs_plan(OutputPlan *plan, const Options *options, const Scene *scene, bool numbered,
                                   Error *error);
void outputs_plan_clear(OutputPlan *plan);
/* name with a row of '#' before its extension, unless it has one somewhere; malloc'd, NULL when memory ends. */
char *output_numbered(const char *name, uint32_t last_frame);
/* name with the frame's number for each row of '#'; the same. */
char *output_of_frame(const char *name, uint32_t frame);

/* The files of one frame. outputs_clear is due in every case. */
ATTR_NODISCARD Status outputs_of_frame(OutputList *list, const OutputPlan *plan, uint32_t frame, Error *error);
void outputs_clear(OutputList *list);
/* Tries each one as writing it will, and leaves no trace. STATUS_OUTPUT; STATUS_USAGE for a file that was read. */
ATTR_NODISCARD Status outputs_probe(const OutputList *list, Error *error);
/* Standard output or a device: it takes a picture once. */
bool output_is_stream(const char *path);
/* Is there one, and are all of them there, as files? */
bool outputs_exist(const OutputList *list);
/* ".exr" is an ending without a name. STATUS_USAGE. */
ATTR_NODISCARD Status output_check_name(const char *path, Error *error);
/* What a file's extension says of it; devices take EXR. STATUS_USAGE. */
ATTR_NODISCARD Status output_choose_format(const char *path, bool *png, Error *error);
/* One file cannot be two things. */
typedef struct OutputClaim {
    const char *path; /* NULL: there is none */
    const char *what; /* "the checkpoint" */
} OutputClaim;
/* STATUS_USAGE where two have one file, under whatever names. */
ATTR_NODISCARD Status output_check_claims(const OutputClaim *claims, size_t n, Error *error);
/* As outputs_probe, for one path, also of other files than pictures. STATUS_USAGE for a file that was read. */
ATTR_NODISCARD Status output_probe(const char *path, Error *error);
/* What --display, --view, --exposure, --auto-exposure, --white-balance and --alpha say; own: what the scene's film or the picture's
 * file says of all but the first two, where they say nothing. */
ColorLook output_look(const Options *options, const ColorLook *own);
/* What a film says is noted in the header of its EXR files, for those who show them later. */
void output_note_look(const ColorLook *look, Attributes *attributes);
/* Takes that from an attribute, if it is one of those; value: its number. */
void output_find_look(ColorLook *look, const char *name, double value);
/* What a file of a picture has noted of it; what comes by a pipe is read once, for the picture. */
ColorLook output_read_look(const char *path);
/* The look of this picture: an automatic exposure in stops. */
ColorLook output_look_for(const Image *image, const ColorLook *look);
/* For those who want it again. Nothing where it is not automatic. */
void output_say_exposure(const Talk *talk, const Image *image, const ColorLook *look);
/* color is NULL when no output is a PNG file. */
ATTR_NODISCARD Status output_write(const Output *output, const Image *image, const ExrOptions *exr,
                                   const ColorConfig *color, const ColorLook *look, Error *error);
/* The colours of an image as they are shown, for a PNG file: as RGB; as RGBA where the look keeps alpha and there is one, colours
 * not multiplied by it. */
ATTR_NODISCARD Status image_for_display(const Image *image, const ColorConfig *color, const ColorLook *look,
                                        Image *shown, Error *error);

#endif

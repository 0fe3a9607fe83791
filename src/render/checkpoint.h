/* checkpoint.h - files from which a render goes on: a picture in EXR, and behind it the state of the render.
 *
 * Any viewer of EXR files shows the picture. What follows it are blocks of bytes, each with its length and a hash: first a head,
 * with the settings, then a block for each row of pixels, then those of the search for caustics if it has begun, then a footer
 * that says where they begin. Numbers and structs are as in the memory of the machine; files of another byte order, or of a build
 * that keeps other numbers, are refused. The same form serves for checkpoints and for slices of a render that are to be merged. It
 * is read and written row by row.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CHECKPOINT_H
#define MEN_CHECKPOINT_H

#include <stdio.h>

#include "image/attributes.h"
#include "render/render.h"

/* The attribute of the picture that says that there is a state. */
#define CHECKPOINT_ATTRIBUTE "meniscus/state"

/* Something that has to be the same for a render to go on, or for slices to be of one render. A text that begins with '#' is
 * a hash that tells people nothing; one with "##" is of all that others are of, too. */
typedef struct CheckpointFact {
    const char *name, *text;
} CheckpointFact;

enum { CHECKPOINT_MOST_FACTS = 32, CHECKPOINT_MOST_ATTRIBUTES = ATTRIBUTES_MOST };

/* What is known of a state besides itself. */
typedef struct CheckpointNotes {
    uint32_t samples;                  /* of the whole render */
    uint32_t first_sample, end_sample; /* of this slice of it; 0 and samples: it is the whole */
    double noise;                      /* at which it ends before; 0: never */
    uint32_t n_facts, n_attributes;
    CheckpointFact facts[CHECKPOINT_MOST_FACTS];
    ImageAttribute attributes[CHECKPOINT_MOST_ATTRIBUTES]; /* of the picture that will be made of it */
} CheckpointNotes;

/* As exr_write has it, with exr's own attributes and CHECKPOINT_ATTRIBUTE for the picture. */
ATTR_NODISCARD Status checkpoint_write(const char *path, const RenderState *state, const CheckpointNotes *notes,
                                       const Image *image, const ExrOptions *exr, Error *error);

/* A file that is being read. */
typedef struct Checkpoint {
    const char *path;
    FILE *stream;
    uint64_t left; /* bytes before the footer */
    char *head;    /* owned: what notes point into */
    CheckpointNotes notes;
    ImagePlace place; /* of the film in the frame */
    uint32_t film_width, film_height;
    uint32_t least_samples, most_samples; /* that pixels have */
    AovSet aovs;
    LightGroups light_groups;    /* of AOV_LIGHTS */
    double unit;                 /* of the AOVs' lengths */
    bool catches;                /* its scene has shadow catchers */
    bool spreads, guides, wants; /* holds bright samples; what a denoiser is guided by; is amid a plan of adapt.h */
    PathCounters counters;
    uint64_t saturated_samples;
    uint32_t guide_samples;
    bool has_search, searching; /* for caustics; it is not done: there are photons and no samples */
    char *row;                  /* owned */
    uint64_t row_capacity;
} Checkpoint;

/* Opens the file and reads its head. STATUS_INPUT says what it is instead of a checkpoint. checkpoint_close is due in any case.
 * path must live as long. */
ATTR_NODISCARD Status checkpoint_open(const char *path, Checkpoint *file, Error *error);
void checkpoint_close(Checkpoint *file);
/* An empty state for what the file holds; height: 0 for all of it, or how many rows of pixels there is to be room for. */
ATTR_NODISCARD Status checkpoint_make_state(const Checkpoint *file, uint32_t height, RenderState *state, Error *error);
/* The next row of pixels, to row y of a state that checkpoint_make_state has made. */
ATTR_NODISCARD Status checkpoint_read_row(Checkpoint *file, RenderState *state, uint32_t y, Error *error);
/* All of it. *state is clear, or whole. */
ATTR_NODISCARD Status checkpoint_read(Checkpoint *file, RenderState *state, Error *error);

/* What differs between two lists, as "seed: 7 in a, 0 in b; the lights"; an empty text: nothing. */
void checkpoint_compare(const CheckpointNotes *a, const char *name_a, const CheckpointNotes *b, const char *name_b,
                        Buf *text);

#endif

/* attributes.h - what is noted in the header of a file, as a list that owns its texts.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ATTRIBUTES_H
#define MEN_ATTRIBUTES_H

#include "image/image.h"

enum { ATTRIBUTES_MOST = 64 };

typedef struct Attributes {
    ImageAttribute items[ATTRIBUTES_MOST];
    size_t n;
    char *owned[3 * ATTRIBUTES_MOST]; /* names, texts, and texts that were set */
    size_t n_owned;
} Attributes;

/* A copy of one, or one of a name. What there is no room or no memory for is left out; a text of NULL is, too. */
void attributes_add(Attributes *attributes, const ImageAttribute *attribute);
void attributes_add_text(Attributes *attributes, const char *name, const char *text);
void attributes_add_whole(Attributes *attributes, const char *name, int whole);
void attributes_add_number(Attributes *attributes, const char *name, double number);
/* As a text: it can be beyond the format's integers of 32 bits. */
void attributes_add_count(Attributes *attributes, const char *name, uint64_t count);
/* NULL: there is none of that name. */
ImageAttribute *attributes_find(Attributes *attributes, const char *name);
/* Of one that is there. */
void attributes_set_count(Attributes *attributes, const char *name, uint64_t count);
void attributes_clear(Attributes *attributes);

#endif

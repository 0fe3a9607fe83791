/* attributes.c - copies of names and texts.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/attributes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* NULL when memory ends, or the room for texts. */
static const char *own(Attributes *attributes, const char *text)
{
    if (attributes->n_owned == COUNT_OF(attributes->owned)) return NULL;
    char *copy = strdup(text);
    if (copy) attributes->owned[attributes->n_owned++] = copy;
    return copy;
}

void attributes_add(Attributes *attributes, const ImageAttribute *attribute)
{
    ImageAttribute copy = *attribute;
    if (attributes->n == ATTRIBUTES_MOST) return;
    copy.name = own(attributes, attribute->name);
    copy.text = attribute->text ? own(attributes, attribute->text) : NULL;
    if (copy.name && !copy.text == !attribute->text) attributes->items[attributes->n++] = copy;
}

void attributes_add_text(Attributes *attributes, const char *name, const char *text)
{
    if (text) attributes_add(attributes, &(ImageAttribute){.name = name, .type = ATTRIBUTE_TEXT, .text = text});
}

void attributes_add_whole(Attributes *attributes, const char *name, int whole)
{
    attributes_add(attributes, &(ImageAttribute){.name = name, .type = ATTRIBUTE_INT, .whole = whole});
}

void attributes_add_number(Attributes *attributes, const char *name, double number)
{
    attributes_add(attributes, &(ImageAttribute){.name = name, .type = ATTRIBUTE_FLOAT, .number = number});
}

/* The digits of a count. */
typedef struct Digits {
    char text[24];
} Digits;

static Digits digits_of(uint64_t count)
{
    Digits digits;
    snprintf(digits.text, sizeof digits.text, "%llu", (unsigned long long)count);
    return digits;
}

void attributes_add_count(Attributes *attributes, const char *name, uint64_t count)
{
    attributes_add_text(attributes, name, digits_of(count).text);
}

ImageAttribute *attributes_find(Attributes *attributes, const char *name)
{
    for (size_t i = 0; i < attributes->n; i++)
        if (strcmp(attributes->items[i].name, name) == 0) return &attributes->items[i];
    return NULL;
}

void attributes_set_count(Attributes *attributes, const char *name, uint64_t count)
{
    ImageAttribute *attribute = attributes_find(attributes, name);
    const char *text = attribute ? own(attributes, digits_of(count).text) : NULL;
    if (text) attribute->text = text;
}

void attributes_clear(Attributes *attributes)
{
    for (size_t i = 0; i < attributes->n_owned; i++) free(attributes->owned[i]);
    *attributes = (Attributes){.n = 0};
}

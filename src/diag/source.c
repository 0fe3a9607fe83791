/* source.c - the texts of a scene and their line tables.
 * SPDX-License-Identifier: Apache-2.0 */
#include "diag/source.h"

#include <string.h>

#include "base/utf8.h"

uint32_t source_add(SourceSet *set, const char *name, const char *path, const char *text, size_t length)
{
    ARENA_ROOM(set->arena, set->sources, set->capacity, set->n, 8);
    set->sources[set->n] = (Source){
        .name = arena_copy_text(set->arena, name, strlen(name)),
        .path = path ? arena_copy_text(set->arena, path, strlen(path)) : NULL,
        .text = text,
        .length = (uint32_t)length,
    };
    return set->n++;
}

static void make_line_table(SourceSet *set, Source *source)
{
    uint32_t n = 1;
    for (uint32_t i = 0; i < source->length; i++) n += source->text[i] == '\n';
    uint32_t *starts = ARENA_ARRAY(set->arena, uint32_t, n);
    uint32_t line = 1;
    for (uint32_t i = 0; i < source->length; i++)
        if (source->text[i] == '\n') starts[line++] = i + 1;
    source->line_starts = starts;
    source->n_lines = n;
}

SourceLine source_line(SourceSet *set, uint32_t source_index, uint32_t byte)
{
    Source *source = &set->sources[source_index];
    if (!source->line_starts) make_line_table(set, source);
    if (byte > source->length) byte = source->length;
    uint32_t low = 0, high = source->n_lines; /* the last line that starts at byte or before it */
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (source->line_starts[middle] <= byte)
            low = middle;
        else
            high = middle;
    }
    uint32_t begin = source->line_starts[low];
    uint32_t end = low + 1 < source->n_lines ? source->line_starts[low + 1] - 1 : source->length;
    if (end > begin && source->text[end - 1] == '\r') end--;
    return (SourceLine){.number = low + 1, .begin = begin, .end = end};
}

SourcePosition source_position(SourceSet *set, uint32_t source_index, uint32_t byte)
{
    const Source *source = &set->sources[source_index];
    SourceLine line = source_line(set, source_index, byte);
    if (byte > source->length) byte = source->length;
    uint32_t column = 1, at = line.begin;
    while (at < byte) {
        uint32_t code;
        at += (uint32_t)utf8_decode(source->text + at, byte - at, &code);
        column++;
    }
    return (SourcePosition){.line = line.number, .column = column};
}

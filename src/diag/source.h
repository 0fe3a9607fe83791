/* source.h - the texts of a scene, kept in memory so that every message can quote its line.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SOURCE_H
#define MEN_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"

/* A stretch of one source: bytes begin (included) to end (excluded). */
typedef struct Span {
    uint32_t source; /* index into the SourceSet */
    uint32_t begin, end;
} Span;

/* Whether two things are of one place in the text, as the turns of a loop are. */
static inline bool span_same_place(Span a, Span b)
{
    return a.source == b.source && a.begin == b.begin;
}
static inline bool span_equal(Span a, Span b)
{
    return span_same_place(a, b) && a.end == b.end;
}
/* In the order of the text: < 0, 0, > 0. */
static inline int span_compare(Span a, Span b)
{
    if (a.source != b.source) return a.source < b.source ? -1 : 1;
    return a.begin < b.begin ? -1 : a.begin > b.begin;
}

typedef struct Source {
    const char *name; /* as shown to people: the path, "<stdin>", "std/glassware.mns", "-D" */
    const char *path; /* where it was read, NULL for text that is no file */
    const char *text; /* a 0 byte stands behind it */
    uint32_t length;
    bool library;          /* built into the program: nobody mends a scene there */
    uint32_t *line_starts; /* made on first use by source_position */
    uint32_t n_lines;
} Source;

typedef struct SourceSet {
    Arena *arena;
    Source *sources;
    uint32_t n, capacity;
} SourceSet;

/* Adds a text (not copied: it must live as long as the arena); returns its index. */
uint32_t source_add(SourceSet *set, const char *name, const char *path, const char *text, size_t length);

/* Line and column from 1; the column counts code points. */
typedef struct SourcePosition {
    uint32_t line, column;
} SourcePosition;
SourcePosition source_position(SourceSet *set, uint32_t source, uint32_t byte);

/* The line that holds a byte: its number from 1, and where its text begins and ends (without the line end). */
typedef struct SourceLine {
    uint32_t number, begin, end;
} SourceLine;
SourceLine source_line(SourceSet *set, uint32_t source, uint32_t byte);

#endif

/* sight_line.h - what stands along a line through a compiled scene, and what each surface there does.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SIGHT_LINE_H
#define MEN_SIGHT_LINE_H

#include "base/json.h"
#include "scene/compile.h"

typedef enum SightKind {
    SIGHT_BOUNDARY, /* light is bent and reflected */
    SIGHT_SILENT,   /* another hull is on top on both sides */
    SIGHT_MERGED,   /* the hulls on top before and behind are of one medium */
    SIGHT_ALIKE,    /* of two media that have one index of refraction */
    SIGHT_PAINTED,  /* one of these two, but the boundary is seen by its paint */
    SIGHT_OPAQUE    /* the line ends */
} SightKind;

/* The surfaces at one place of the line. */
typedef struct SightStep {
    double distance;
    SightKind kind;
    uint32_t object;   /* the first of them: a row of the scene's objects, of a combination its own */
    uint32_t n;        /* how many objects' surfaces are there */
    uint32_t from, to; /* media that own the line before and behind */
    uint32_t top;      /* SIGHT_SILENT: the hull on top */
    bool entering;     /* the first object is entered */
    uint32_t operand;  /* the same, or what of that combination has the surface; */
    Vec3f normal;      /* outward there */
} SightStep;

typedef struct SightLine {
    uint32_t start; /* the medium that owns the line's start */
    SightStep *steps;
    size_t n, capacity;
} SightLine;

/* The line goes straight on through every boundary, up to the first opaque surface. STATUS_NOMEM. */
ATTR_NODISCARD Status sight_line_find(const CompiledScene *compiled, const Ray *ray, SightLine *line, Error *error);
void sight_line_clear(SightLine *line);
/* The opaque surface that it ends at; NULL: none. */
const SightStep *sight_line_end(const SightLine *line);
/* For people, and for programs (an array). */
void sight_line_print(const CompiledScene *compiled, const SightLine *line, Buf *out);
void sight_line_print_json(const CompiledScene *compiled, const SightLine *line, JsonWriter *json);

#endif

/* lines.h - finding out how hulls lie by looking along lines: evenly spread lines through a box, and where
 * along a line each hull begins and ends. For compiling, and for src/check.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LINES_H
#define MEN_LINES_H

#include "scene/compile.h"

enum { LINE_DIRECTIONS = 3 };
/* Three unit vectors at right angles to each other, none of them near an axis or a diagonal, where scenes
 * have edges and faces in line. */
Vec3 line_direction(int i);

/* A stretch of a line: from start along the direction, as far as length. */
typedef struct Line {
    Vec3 start;
    Vec3f direction;
    double length;
    double time; /* of the shutter, 0..1: lines are spread over it, too */
    double area; /* of the cross-section that this line stands for */
} Line;

/* When a line is looked along; of a scene in which nothing moves there is one moment only. */
static inline double line_time(const CompiledScene *compiled, const Line *line)
{
    return compiled->scene->n_keys ? line->time : 0;
}

/* Lines of one direction through a box (made wider by what rounding needs), evenly spread over the box's silhouette:
 * about n, at least one for each of the three faces where they enter. */
typedef struct LineSet {
    Box3 box;
    Vec3 direction;
    double face_area[3]; /* seen along the direction */
    uint32_t n_face[3];
    uint32_t face, i; /* the next line */
    double offset[2];
} LineSet;
void line_set_begin(LineSet *set, Box3 box, int direction, uint32_t n, uint64_t seed);
/* false when there are no more */
bool line_set_next(LineSet *set, Line *line);
/* How many there are in all, and going on to the n-th from here. */
uint32_t line_set_size(const LineSet *set);
void line_set_skip(LineSet *set, uint32_t n);

/* Whether hit i is the same crossing as one before it: the edge of a hull, reported by both its faces. */
bool hit_repeats(const HitList *hits, size_t i);

/* Where a hull lies on a line. */
typedef struct Interval {
    uint32_t hull;
    double begin, end;
    const Hit *enter, *leave; /* NULL where the line itself begins or ends inside */
    uint32_t next;            /* the same hull's next one, INTERVAL_NONE */
} Interval;
#define INTERVAL_NONE UINT32_MAX

/* The memory of one worker. */
typedef struct Probe {
    HitList forward, backward;
    Interval *intervals;
    size_t n_intervals, intervals_capacity;
    int32_t *depth;    /* of each hull and operand at the start of a line: 0 in between */
    uint32_t *first;   /* each hull's first interval on the present line, INTERVAL_NONE */
    NestList operands; /* of combinations, that the line is inside of; empty in between */
    double look_back; /* how far back from a line's start to look for what it is inside of: to the far end of every hull
                         * that can be there, at least. HUGE_VAL, which probe_init sets, always does */
    bool out_of_memory; /* sticks */
} Probe;
ATTR_NODISCARD Status probe_init(Probe *probe, const CompiledScene *compiled, Error *error);
void probe_clear(Probe *probe);

/* Collects the surfaces of hulls along the line into probe->forward; false when there are none of hull
 * `must` (SCENE_NONE: any). */
bool probe_surfaces(Probe *probe, const CompiledScene *compiled, const Line *line, uint32_t must);
/* After that: looks back from the line's start for what the start is inside of, and fills in the intervals, in order
 * of their beginnings, and each hull's chain of them. */
void probe_intervals(Probe *probe, const CompiledScene *compiled, const Line *line);
/* The next line of the set that meets the hull, with its surfaces and intervals; false when there are no more. */
bool probe_next_line(Probe *probe, const CompiledScene *compiled, LineSet *set, uint32_t hull, Line *line);

#endif

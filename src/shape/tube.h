/* tube.h - where a line meets a circle that is turned about the y axis: a torus, or a part of one between two of the
 * circle's points (a rounded rim, a fillet, a zone of a sphere). Private to piece.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TUBE_H
#define MEN_TUBE_H

#include <stdbool.h>

#include "shape/piece.h"

enum { TUBE_MAX_CROSSINGS = 4 };

typedef enum TubePart {
    TUBE_WHOLE, /* the whole circle; where it reaches over the axis, the union of both sides (a spindle torus without
                   void) */
    TUBE_OUTER, /* r >= centre_r; what is nearer to the axis than that counts as inside */
    TUBE_INNER  /* r <= centre_r; what is farther from the axis than that counts as inside */
} TubePart;

/* A circle in the half plane (r, y). centre_r < 0 is allowed for TUBE_OUTER. */
typedef struct Tube {
    TubePart part;
    double centre_r, centre_y;
    double squared; /* of its radius */
} Tube;

/* The part of the line that counts, t from a to b (either may be infinite), and whether its ends are inside of the
 * tube, which the caller knows better than rounding does. */
typedef struct TubeSpan {
    double a, b;
    bool inside_a, inside_b;
} TubeSpan;

typedef struct TubeCrossings {
    int n;
    double t[TUBE_MAX_CROSSINGS];
    bool first_enters; /* the first goes into the tube; from there on they alternate */
} TubeCrossings;

/* The crossings of a line with t_min < t <= t_max, in increasing t. Without a span (NULL) the line starts and ends
 * outside. With one the number of crossings is odd if and only if its ends differ, whatever rounding does, and none is
 * beyond the ends. A crossing that is found does not depend on t_min and t_max. start is as of piece_cross, but says on which
 * side of the tube the line is. */
void tube_cross(const Tube *tube, const PieceLine *piece_line, const TubeSpan *span, double t_min, double t_max,
                PieceStart start, TubeCrossings *out);

#endif

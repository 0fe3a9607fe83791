/* contour.h - closed curves in a plane, from lines and curves to points that keep their directions.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CONTOUR_H
#define MEN_CONTOUR_H

#include "shape/polygon.h"

/* Draws loops into an outline. Curves become chords that stay within the tolerance and turn by at most 5 degrees.
 * Corners that turn by less than smooth_degrees are smoothed in their directions. Begun with the first three set. */
typedef struct Pen {
    Outline2 *outline;
    double tolerance, smooth_degrees;
    Point2 start, at, arrive;
    size_t first;
    uint32_t source; /* given to the points drawn from here on */
    bool failed;     /* memory ended, or there are more than POLYGON_MAX_POINTS points */
} Pen;

void pen_begin(Pen *pen, Point2 at);
void pen_line(Pen *pen, Point2 to);
void pen_cubic(Pen *pen, Point2 control1, Point2 control2, Point2 to);
/* Back to where the loop began. A loop without two different points is left out. */
void pen_end(Pen *pen);

typedef enum ContourKind {
    CONTOUR_LINEAR, /* corners */
    CONTOUR_CUBIC,  /* a smooth curve through all points: Catmull-Rom */
    CONTOUR_NATURAL, /* the same, with a curvature that does not jump, but at points that stand there twice, which are corners */
    CONTOUR_BEZIER /* in threes: a point on the curve and the two controls behind it */
} ContourKind;

/* One closed loop through n points, whose numbers count from pen->source. STATUS_SCENE for what cannot be a loop. */
ATTR_NODISCARD Status contour_draw(Pen *pen, ContourKind kind, const double *xy, size_t n, Error *error);

#endif

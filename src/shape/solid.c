/* solid.c - closed solids made of analytic pieces: storage, sphere, torus, capsule, cone; volumes.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/angle.h"
#include "shape/piece.h"

void solid_free(Solid *solid)
{
    free(solid);
}

Status solid_new(uint32_t n_pieces, Solid **solid, Error *error)
{
    size_t size = sizeof(Solid) + n_pieces * sizeof(Piece);
    Solid *made = calloc(1, size);
    if (!made) return fail_memory(error, size, "a solid");
    made->n_pieces = n_pieces;
    *solid = made;
    return STATUS_OK;
}

Piece piece_make_band(double r0, double y0, double r1, double y1)
{
    double nr = y1 - y0;
    double ny = r0 - r1;
    double length = hypot(nr, ny);
    float unit_r = (float)(nr / length);
    float unit_y = (float)(ny / length);
    return (Piece){.kind = PIECE_BAND,
                   .r0 = r0,
                   .y0 = y0,
                   .r1 = r1,
                   .y1 = y1,
                   .nr0 = unit_r,
                   .ny0 = unit_y,
                   .nr1 = unit_r,
                   .ny1 = unit_y,
                   .v0 = 0,
                   .v1 = 1};
}

/* A part of a sphere about (0, centre_y) from one point to another, v from 0 to 1. */
static Piece make_zone(double centre_y, double r0, double y0, double r1, double y1)
{
    return (Piece){.kind = PIECE_OUTER_ARC,
                   .r0 = r0,
                   .y0 = y0,
                   .r1 = r1,
                   .y1 = y1,
                   .centre_r = 0,
                   .centre_y = centre_y,
                   .v0 = 0,
                   .v1 = 1};
}

/* The integral of r^2 over the height, along the arc of a circle about (c, 0) up to (c + side * s, h). */
static double arc_integral(double c, double side, double squared, double s, double h)
{
    return (c * c + squared) * h - h * h * h / 3 + side * c * (h * s + squared * atan2(h, s));
}

double piece_volume(const Piece *piece)
{
    double r0 = piece->r0;
    double r1 = piece->r1;
    if (piece->kind == PIECE_BAND)
        return MEN_PI / 3 * (r0 * r0 + r0 * r1 + r1 * r1) * (piece->y1 - piece->y0); /* a frustum */
    double c = piece->centre_r, side = piece->kind == PIECE_OUTER_ARC ? 1 : -1;
    double s0 = fabs(r0 - c), h0 = piece->y0 - piece->centre_y;
    double s1 = fabs(r1 - c), h1 = piece->y1 - piece->centre_y, squared = s0 * s0 + h0 * h0;
    return MEN_PI * (arc_integral(c, side, squared, s1, h1) - arc_integral(c, side, squared, s0, h0));
}

Status solid_make_sphere(double radius, Solid **solid, Error *error)
{
    if (!(radius > 0) || !(radius <= 1e15))
        return fail(error, STATUS_SCENE, "a sphere's radius must be greater than 0 and at most 1e15; it is %g", radius);
    TRY(solid_new(1, solid, error));
    (*solid)->pieces[0] = (Piece){.kind = PIECE_SPHERE, .r0 = radius};
    (*solid)->volume = 4 * MEN_PI / 3 * radius * radius * radius;
    return STATUS_OK;
}

Status solid_make_torus(double radius, double tube, Solid **solid, Error *error)
{
    if (!(radius > 0) || !(tube > 0) || !(radius <= 1e15) || !(tube <= 1e15))
        return fail(error, STATUS_SCENE, "a torus's radii must be greater than 0 and at most 1e15; they are %g and %g",
                    radius, tube);
    TRY(solid_new(1, solid, error));
    (*solid)->pieces[0] = (Piece){.kind = PIECE_TORUS, .r0 = radius, .r1 = tube};
    if (tube <= radius) {
        (*solid)->volume = 2 * MEN_PI * MEN_PI * radius * tube * tube;
        return STATUS_OK;
    }
    /* the outer half, less the dimples at both poles */
    double pole = sqrt((tube - radius) * (tube + radius));
    const Piece outer = {
        .kind = PIECE_OUTER_ARC, .r0 = radius, .y0 = -tube, .r1 = radius, .y1 = tube, .centre_r = radius};
    const Piece dimple = {.kind = PIECE_INNER_ARC, .r0 = 0, .y0 = pole, .r1 = radius, .y1 = tube, .centre_r = radius};
    (*solid)->volume = piece_volume(&outer) - 2 * piece_volume(&dimple);
    return STATUS_OK;
}

Status solid_make_capsule(double radius, double height, Solid **solid, Error *error)
{
    if (!(radius > 0) || !(radius <= 1e15))
        return fail(error, STATUS_SCENE, "a capsule's radius must be greater than 0 and at most 1e15; it is %g",
                    radius);
    if (!(height > 0) || !(height <= 1e15))
        return fail(error, STATUS_SCENE, "a capsule's length must be greater than 0 and at most 1e15; it is %g",
                    height);
    TRY(solid_new(3, solid, error));
    Piece *pieces = (*solid)->pieces;
    pieces[0] = make_zone(0, 0, -radius, radius, 0);
    pieces[1] = piece_make_band(radius, 0, radius, height);
    pieces[2] = make_zone(height, radius, height, 0, height + radius);
    double cap = MEN_PI / 2 * radius, whole = 2 * cap + height;
    pieces[0].v1 = pieces[1].v0 = (float)(cap / whole);
    pieces[1].v1 = pieces[2].v0 = (float)((cap + height) / whole);
    (*solid)->volume = MEN_PI * radius * radius * (4.0 / 3 * radius + height);
    return STATUS_OK;
}

double solid_cone_rounding(double radius0, double radius1, double height)
{
    /* an arc takes its radius times the tangent of half the turn off both edges, at a tip of the whole turn */
    double turn0 = atan2(height, radius1 - radius0), turn1 = MEN_PI - turn0;
    double part0 = tan(radius0 > 0 ? turn0 / 2 : turn0), part1 = tan(radius1 > 0 ? turn1 / 2 : turn1);
    double limit = hypot(radius1 - radius0, height) / (part0 + part1);
    if (radius0 > 0) limit = fmin(limit, radius0 / part0);
    if (radius1 > 0) limit = fmin(limit, radius1 / part1);
    return limit;
}

Status solid_make_cone(double radius0, double radius1, double height, double rounding, Solid **solid, Error *error)
{
    if (!(radius0 >= 0) || !(radius1 >= 0) || !(radius0 <= 1e15) || !(radius1 <= 1e15))
        return fail(error, STATUS_SCENE, "a cone's radii must be from 0 to 1e15; they are %g and %g", radius0, radius1);
    if (radius0 == 0 && radius1 == 0)
        return fail(error, STATUS_SCENE, "both radii of a cone are 0; one must be greater");
    if (!(height > 0) || !(height <= 1e15))
        return fail(error, STATUS_SCENE, "a cone's height must be greater than 0 and at most 1e15; it is %g", height);
    radius0 += 0.0; /* -0 becomes 0 */
    radius1 += 0.0;
    if (rounding > 0) {
        const double profile[4][2] = {
            {0, 0}, {radius0, 0}, {radius1, height}, {0, height}}; /* a tip is dropped as a repetition */
        const double round[4] = {radius0 > 0 ? 0 : rounding, rounding, rounding, radius1 > 0 ? 0 : rounding};
        return solid_make_lathe(profile, 4, round, false, solid, error);
    }
    TRY(solid_new(1U + (radius0 > 0) + (radius1 > 0), solid, error));
    Piece *pieces = (*solid)->pieces;
    double side = hypot(radius1 - radius0, height);
    double length = radius0 + side + radius1;
    uint32_t n = 0;
    if (radius0 > 0) pieces[n++] = piece_make_band(0, 0, radius0, 0);
    pieces[n++] = piece_make_band(radius0, 0, radius1, height);
    if (radius1 > 0) pieces[n++] = piece_make_band(radius1, height, 0, height);
    double along = 0;
    for (uint32_t i = 0; i < n; i++) {
        pieces[i].v0 = (float)(along / length);
        along += hypot(pieces[i].r1 - pieces[i].r0, pieces[i].y1 - pieces[i].y0);
        pieces[i].v1 = (float)fmin(along / length, 1);
        (*solid)->volume += piece_volume(&pieces[i]);
    }
    return STATUS_OK;
}

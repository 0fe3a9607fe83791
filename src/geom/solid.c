/* solid.c - closed solids made of analytic pieces: storage, sphere, cone.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "geom/piece.h"

static const double pi = 3.14159265358979323846;

void solid_free(Solid *solid)
{
    if (!solid) return;
    free(solid->pieces);
    free(solid);
}

Status solid_new(uint32_t n_pieces, Solid **solid, Error *error)
{
    Solid *made = calloc(1, sizeof *made);
    if (!made) return fail_memory(error, sizeof *made, "a solid");
    made->pieces = calloc(n_pieces ? n_pieces : 1, sizeof *made->pieces);
    if (!made->pieces) {
        free(made);
        return fail_memory(error, n_pieces * sizeof *made->pieces, "the pieces of a solid");
    }
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
    return (Piece){.kind = PIECE_BAND, .r0 = r0, .y0 = y0, .r1 = r1, .y1 = y1,
                   .nr0 = unit_r, .ny0 = unit_y, .nr1 = unit_r, .ny1 = unit_y, .v0 = 0, .v1 = 1};
}

double piece_band_volume(const Piece *piece)
{
    double r0 = piece->r0;
    double r1 = piece->r1;
    return pi / 3 * (r0 * r0 + r0 * r1 + r1 * r1) * (piece->y1 - piece->y0); /* a frustum */
}

Status solid_make_sphere(double radius, Solid **solid, Error *error)
{
    if (!(radius > 0) || !(radius <= 1e15))
        return fail(error, STATUS_SCENE, "a sphere's radius must be greater than 0 and at most 1e15; it is %g", radius);
    TRY(solid_new(1, solid, error));
    (*solid)->pieces[0] = (Piece){.kind = PIECE_SPHERE, .r0 = radius};
    (*solid)->volume = 4 * pi / 3 * radius * radius * radius;
    return STATUS_OK;
}

Status solid_make_cone(double radius0, double radius1, double height, Solid **solid, Error *error)
{
    if (!(radius0 >= 0) || !(radius1 >= 0) || !(radius0 <= 1e15) || !(radius1 <= 1e15))
        return fail(error, STATUS_SCENE, "a cone's radii must be from 0 to 1e15; they are %g and %g", radius0, radius1);
    if (radius0 == 0 && radius1 == 0)
        return fail(error, STATUS_SCENE, "both radii of a cone are 0; one must be greater");
    if (!(height > 0) || !(height <= 1e15))
        return fail(error, STATUS_SCENE, "a cone's height must be greater than 0 and at most 1e15; it is %g", height);
    radius0 += 0.0; /* -0 becomes 0 */
    radius1 += 0.0;
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
        (*solid)->volume += piece_band_volume(&pieces[i]);
    }
    return STATUS_OK;
}

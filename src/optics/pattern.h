/* pattern.h - numbers from 0 to 1 that depend on the place: what solid textures are made of.
 * Every pattern is a function of a point, without state, and defined everywhere.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PATTERN_H
#define MEN_PATTERN_H

#include <stdbool.h>

#include "base/noise.h"

typedef enum PatternKind {
    PATTERN_CHECKER,  /* unit cubes, 0 and 1 in turn */
    PATTERN_BRICK,    /* courses along y, bricks along x: 0 in the mortar, 1 in the bricks */
    PATTERN_HEXAGON,  /* prisms along y over hexagons with sides of 1 in x and z: 0, 1/2, 1 */
    PATTERN_GRADIENT, /* a wave of a distance or an angle */
    PATTERN_NOISE,
    PATTERN_WOOD, /* rings about the z axis */
    PATTERN_GRANITE,
    PATTERN_CRACKLE, /* cells around points that are strewn about, one to a unit cube */
    PATTERN_SPOTS,   /* balls around the same points */
    PATTERN_AGATE
} PatternKind;

typedef enum GradientShape {
    GRADIENT_LINEAR,     /* x */
    GRADIENT_RADIAL,     /* turns about the y axis, counter-clockwise seen from above, from +x */
    GRADIENT_SPHERICAL,  /* distance from the origin */
    GRADIENT_CYLINDRICAL /* distance from the y axis */
} GradientShape;

typedef enum PatternWave {
    WAVE_RAMP,     /* from 0 up to 1, again and again */
    WAVE_TRIANGLE, /* up and down */
    WAVE_SINE,     /* (1 - cos) / 2 */
    WAVE_SCALLOP,  /* |sin|: round humps with sharp valleys between */
    WAVE_ONCE      /* from 0 up to 1, and 0 and 1 beyond */
} PatternWave;

typedef enum NoiseStyle {
    NOISE_SMOOTH,     /* clouds */
    NOISE_TURBULENCE, /* of absolute values: flames, creases */
    NOISE_RIDGED      /* sharp crests */
} NoiseStyle;

typedef enum CrackleValue {
    CRACKLE_BORDER,   /* how far from the border to the next cell: 0 there */
    CRACKLE_DISTANCE, /* from the cell's point: 0 there */
    CRACKLE_CELL      /* a number of each cell's own */
} CrackleValue;

enum { PATTERN_MOST_OCTAVES = 16 };

/* A kind, and what it needs to know. */
typedef struct Pattern {
    PatternKind kind;
    uint64_t seed; /* of noise, wood, granite, crackle, spots, agate */
    Vec3 size;     /* BRICK: of a brick with its mortar */
    double mortar; /* BRICK: its width, less than size */
    double bevel;  /* BRICK: over which length the edge of a brick rises from 0 to 1; 0: sharp */
    double bond;   /* BRICK: by which part of a brick each course is shifted against the one below */
    GradientShape shape;
    PatternWave wave;
    double frequency, phase; /* GRADIENT: waves per unit, or per turn, and a shift in waves */
    NoiseStyle style;
    unsigned octaves;        /* NOISE, 1 .. PATTERN_MOST_OCTAVES */
    double lacunarity, gain; /* NOISE: frequency and weight of each octave, by the one before */
    double grain;            /* WOOD: the part of the fine fibres, 0..1 */
    CrackleValue value;
    double radius, blur; /* SPOTS: of the balls, and over which length their edge is soft */
} Pattern;

/* A place, in the pattern's own coordinates. */
typedef struct PatternPlace {
    Vec3 p;
    Vec3 normal; /* of the surface, unit; zero: none. The mortar of a brick wall runs across the surface only */
    /* what is smaller than this need not be resolved: a box of this width on the surface is averaged over */
    double footprint;
} PatternPlace;

/* Of a footprint, which part of it has which value, 0..1; the parts add up to 1. What is continuous within a small
 * footprint is one part. A point beyond NOISE_LARGEST_COORDINATE, or that is not finite, is taken as the origin. */
enum { PATTERN_MOST_PARTS = 8 };
typedef struct PatternParts {
    int n;
    double value[PATTERN_MOST_PARTS], part[PATTERN_MOST_PARTS];
} PatternParts;
void pattern_parts(const Pattern *pattern, const PatternPlace *place, PatternParts *parts);
/* A wave of period 1; 0..1. */
double pattern_wave(PatternWave wave, double x);
/* Noise that moves a point about: three noises of that many octaves, each of half the size and weight of the one before;
 * none where there is no noise. */
Vec3 pattern_turbulence(Vec3 p, unsigned octaves, double footprint, uint64_t seed);

/* The points that crackle and spots are made of. */
typedef struct PatternCells {
    double nearest, second;     /* distances */
    double border;              /* distance to the plane between the two */
    uint64_t cell, second_cell; /* hashes of their own */
} PatternCells;
PatternCells pattern_cells(Vec3 p, uint64_t seed);

#endif

/* pattern.c - numbers from 0 to 1 that depend on the place.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/pattern.h"

#include <stdlib.h>

#include "base/hash.h"

static const double pi = 3.14159265358979323846;

static double clamp_unit(double x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}
static double fraction(double x)
{
    return x - floor(x);
}
static double smooth_step(double t)
{
    t = clamp_unit(t);
    return t * t * (3 - 2 * t);
}

double pattern_wave(PatternWave wave, double x)
{
    double t = fraction(x);
    switch (wave) {
    case WAVE_RAMP: break;
    case WAVE_TRIANGLE: return 1 - fabs(2 * t - 1);
    case WAVE_SINE: return clamp_unit(0.5 - 0.5 * cos(2 * pi * t));
    case WAVE_SCALLOP: return clamp_unit(fabs(sin(pi * t)));
    case WAVE_ONCE: return clamp_unit(x);
    }
    return t;
}

/* ---- cells ---- */

static double checker(Vec3 p)
{
    return fmod(floor(p.x) + floor(p.y) + floor(p.z), 2) != 0 ? 1 : 0;
}

/* How far into a brick along one axis, from 0 at the mortar's edge; the mortar lies half on either side of whole numbers
 * of `size`. */
static double depth_in_brick(double x, double size, double mortar)
{
    double in_cell = size * fraction(x / size);
    return fmin(in_cell, size - in_cell) - 0.5 * mortar;
}

static double brick(const Pattern *pattern, const PatternPlace *place)
{
    /* A joint that runs along the surface is not seen as one: the surface is the bricks' face. */
    const double along = 0.9;
    Vec3 p = place->p, size = pattern->size;
    double course = floor(p.y / size.y), shift = pattern->bond * course * size.x;
    double depth = HUGE_VAL;
    if (fabs(place->normal.y) < along) depth = fmin(depth, depth_in_brick(p.y, size.y, pattern->mortar));
    if (fabs(place->normal.x) < along) depth = fmin(depth, depth_in_brick(p.x - shift, size.x, pattern->mortar));
    if (fabs(place->normal.z) < along) depth = fmin(depth, depth_in_brick(p.z, size.z, pattern->mortar));
    if (!(depth > 0)) return 0;
    return depth < pattern->bevel ? smooth_step(depth / pattern->bevel) : 1;
}

/* Hexagons in axial coordinates (q, r), rounded to the nearest; neighbours differ in (q - r) modulo 3. */
static double hexagon(Vec3 p)
{
    double q = 2.0 / 3 * p.x, r = p.z / sqrt(3.0) - p.x / 3, s = -q - r;
    double whole_q = floor(q + 0.5), whole_r = floor(r + 0.5), whole_s = floor(s + 0.5);
    double off_q = fabs(whole_q - q), off_r = fabs(whole_r - r), off_s = fabs(whole_s - s);
    if (off_q > off_r && off_q > off_s)
        whole_q = -whole_r - whole_s;
    else if (off_r > off_s)
        whole_r = -whole_q - whole_s;
    double colour = fmod(whole_q - whole_r, 3);
    return (colour < 0 ? colour + 3 : colour) / 2;
}

/* Looks at the point of one cell. */
static void consider_cell(Vec3 p, const double cell[3], uint64_t seed, double *nearest, double *second, uint64_t *hash)
{
    uint64_t h = hash_u64(seed);
    for (int i = 0; i < 3; i++) h = hash_u64(h ^ (uint64_t)(int64_t)cell[i]);
    const double unit = 1.0 / 2097152; /* 21 bits for each coordinate */
    Vec3 point = vec3(cell[0] + unit * (double)(h & 0x1fffff), cell[1] + unit * (double)(h >> 21 & 0x1fffff),
                      cell[2] + unit * (double)(h >> 42 & 0x1fffff));
    Vec3 apart = vec3_sub(point, p);
    double square = vec3_dot(apart, apart);
    if (square < *nearest) {
        *second = *nearest;
        *nearest = square;
        *hash = h;
    } else if (square < *second) {
        *second = square;
    }
}

PatternCells pattern_cells(Vec3 p, uint64_t seed)
{
    const double at[3] = {floor(p.x), floor(p.y), floor(p.z)};
    const double in[3] = {p.x - at[0], p.y - at[1], p.z - at[2]};
    double nearest = HUGE_VAL, second = HUGE_VAL;
    uint64_t hash = 0;
    /* The cells around the point's own; then, if what was found is not surely nearer, those around these. */
    for (int reach = 1; reach <= 2; reach++) {
        for (int x = -reach; x <= reach; x++)
            for (int y = -reach; y <= reach; y++)
                for (int z = -reach; z <= reach; z++) {
                    if (reach == 2 && abs(x) < 2 && abs(y) < 2 && abs(z) < 2) continue;
                    double cell[3] = {at[0] + x, at[1] + y, at[2] + z}, square = 0;
                    const int step[3] = {x, y, z};
                    for (int i = 0; i < 3; i++) {
                        double away = step[i] > 0 ? step[i] - in[i] : step[i] < 0 ? in[i] - (step[i] + 1) : 0;
                        square += away * away;
                    }
                    if (square < second) consider_cell(p, cell, seed, &nearest, &second, &hash);
                }
        double rim = 1;
        for (int i = 0; i < 3; i++) rim = fmin(rim, 1 + fmin(in[i], 1 - in[i]));
        if (second <= rim * rim) break;
    }
    return (PatternCells){sqrt(nearest), sqrt(second), hash_u64(hash)};
}

static double crackle(const Pattern *pattern, Vec3 p)
{
    PatternCells cells = pattern_cells(p, pattern->seed);
    if (pattern->value == CRACKLE_CELL) return hash_to_unit(cells.cell);
    return clamp_unit(pattern->value == CRACKLE_BORDER ? cells.second - cells.nearest : cells.nearest);
}

static double spots(const Pattern *pattern, Vec3 p)
{
    double inside = pattern->radius - pattern_cells(p, pattern->seed).nearest;
    if (!(pattern->blur > 0)) return inside > 0 ? 1 : 0;
    return smooth_step(0.5 + inside / pattern->blur);
}

/* ---- noise ---- */

/* The root mean square and the mean absolute value of noise_gradient, measured. */
static const double noise_rms = 0.27, noise_mean_size = 0.22;

/* How much of an octave of that frequency a footprint lets through: nothing when a period is no larger than it. */
static double seen(double frequency, double footprint)
{
    return clamp_unit(2 - 2 * frequency * footprint);
}

/* Another part of the same noise for each octave, so that their lattices do not meet at the origin. */
static Vec3 octave_point(Vec3 p, double frequency, unsigned octave)
{
    double shift = 17.31 * octave;
    return vec3(p.x * frequency + shift, p.y * frequency + shift, p.z * frequency + shift);
}

static double noise(const Pattern *pattern, const PatternPlace *place)
{
    const double crest = 1 - 2 * noise_mean_size + noise_rms * noise_rms; /* the mean of (1 - |noise|)^2 */
    /* beyond it there is no noise */
    const double most = 0.5 * NOISE_LARGEST_COORDINATE / (1 + vec3_max_abs(place->p));
    double sum = 0, weight = 1, weights = 0, squares = 0, frequency = 1;
    for (unsigned i = 0; i < pattern->octaves; i++) {
        double part = frequency < most ? seen(frequency, place->footprint) : 0, value = 0;
        if (part > 0) value = noise_gradient(octave_point(place->p, frequency, i), pattern->seed);
        if (pattern->style == NOISE_SMOOTH)
            sum += weight * part * value;
        else if (pattern->style == NOISE_TURBULENCE)
            sum += weight * (part * fabs(value) + (1 - part) * noise_mean_size);
        else
            sum += weight * (part * (1 - fabs(value)) * (1 - fabs(value)) + (1 - part) * crest);
        weights += weight;
        squares += weight * weight;
        weight *= pattern->gain;
        frequency *= pattern->lacunarity;
    }
    /* two standard deviations reach from the middle to either end */
    if (pattern->style == NOISE_SMOOTH) return clamp_unit(0.5 + 0.25 * sum / (noise_rms * sqrt(squares)));
    return clamp_unit(pattern->style == NOISE_TURBULENCE ? sum / weights / (2.5 * noise_mean_size) : sum / weights);
}

/* Octaves multiply coordinates by less than this, those of noise() but for one whose lacunarity is large. */
#define LARGEST_FACTOR 0x1p20

static bool is_usable(Vec3 p)
{
    return vec3_max_abs(p) < NOISE_LARGEST_COORDINATE / LARGEST_FACTOR && vec3_is_finite(p);
}

Vec3 pattern_turbulence(Vec3 p, unsigned octaves, double footprint, uint64_t seed)
{
    Vec3 sum = vec3(0, 0, 0);
    double weight = 1, frequency = 1;
    if (!is_usable(p)) return sum;
    for (unsigned i = 0; i < octaves; i++, weight *= 0.5, frequency *= 2) {
        double part = seen(frequency, footprint);
        if (!(part > 0)) break;
        sum = vec3_along(sum, weight * part, noise_gradient3(octave_point(p, frequency, i), seed));
    }
    return sum;
}

/* One year's ring: it darkens slowly in summer, and ends at once. */
static double ring(double distance)
{
    const double summer = 0.85;
    double t = fraction(distance);
    return t < summer ? smooth_step(t / summer) : 1 - smooth_step((t - summer) / (1 - summer));
}

static double wood(const Pattern *pattern, const PatternPlace *place)
{
    Vec3 p = place->p;
    double rings = ring(sqrt(p.x * p.x + p.y * p.y));
    double part = pattern->grain * seen(24, place->footprint);
    if (!(part > 0)) return rings;
    double fibre = noise_gradient(vec3(p.x * 24, p.y * 24, p.z * 0.7), pattern->seed);
    return clamp_unit(rings + part * fibre / noise_rms * 0.5);
}

static double granite(const Pattern *pattern, const PatternPlace *place)
{
    double sum = 0, weight = 1, frequency = 4;
    for (unsigned i = 0; i < 6; i++, weight *= 0.5, frequency *= 2) {
        double part = seen(frequency, place->footprint), value = 0;
        if (part > 0) value = fabs(noise_gradient(octave_point(place->p, frequency, i), pattern->seed));
        sum += weight * (part * value + (1 - part) * noise_mean_size);
    }
    return clamp_unit(sum);
}

static double agate(const Pattern *pattern, const PatternPlace *place)
{
    Vec3 p = place->p;
    double twist = 0, weight = 1, frequency = 1;
    for (unsigned i = 0; i < 5; i++, weight *= 0.5, frequency *= 2)
        twist +=
            weight * seen(frequency, place->footprint) * noise_gradient(octave_point(p, frequency, i), pattern->seed);
    return pow(pattern_wave(WAVE_SINE, 1.1 * p.z + 1.3 * twist), 0.77);
}

static double gradient(const Pattern *pattern, Vec3 p)
{
    double along = p.x;
    switch (pattern->shape) {
    case GRADIENT_LINEAR: break;
    case GRADIENT_RADIAL: along = p.x == 0 && p.z == 0 ? 0 : fraction(atan2(-p.z, p.x) / (2 * pi)); break;
    case GRADIENT_SPHERICAL: along = vec3_length(p); break;
    case GRADIENT_CYLINDRICAL: along = sqrt(p.x * p.x + p.z * p.z); break;
    }
    return pattern_wave(pattern->wave, along * pattern->frequency + pattern->phase);
}

double pattern_at(const Pattern *pattern, const PatternPlace *given)
{
    PatternPlace place = *given;
    if (!is_usable(place.p)) place.p = vec3(0, 0, 0);
    switch (pattern->kind) {
    case PATTERN_CHECKER: return checker(place.p);
    case PATTERN_BRICK: return brick(pattern, &place);
    case PATTERN_HEXAGON: return hexagon(place.p);
    case PATTERN_GRADIENT: return gradient(pattern, place.p);
    case PATTERN_NOISE: return noise(pattern, &place);
    case PATTERN_WOOD: return wood(pattern, &place);
    case PATTERN_GRANITE: return granite(pattern, &place);
    case PATTERN_CRACKLE: return crackle(pattern, place.p);
    case PATTERN_SPOTS: return spots(pattern, place.p);
    case PATTERN_AGATE: return agate(pattern, &place);
    }
    return 0;
}

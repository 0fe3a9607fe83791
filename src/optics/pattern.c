/* pattern.c - numbers from 0 to 1 that depend on the place.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/pattern_areas.h"

#include <stdlib.h>

#include "base/angle.h"
#include "base/attr.h"
#include "base/hash.h"

double pattern_wave(PatternWave wave, double x)
{
    double t = fraction(x);
    switch (wave) {
    case WAVE_RAMP: break;
    case WAVE_TRIANGLE: return 1 - fabs(2 * t - 1);
    case WAVE_SINE: return clamp_unit(0.5 - 0.5 * cos(2 * MEN_PI * t));
    case WAVE_SCALLOP: return clamp_unit(fabs(sin(MEN_PI * t)));
    case WAVE_ONCE: return clamp_unit(x);
    }
    return t;
}

typedef struct FoundCells {
    double nearest, second; /* squares of distances */
    Vec3 nearest_point, second_point;
    uint64_t cell, second_cell;
} FoundCells;

/* Looks at the point of one cell; h: its hash. */
static void consider_cell(Vec3 p, Vec3 cell, uint64_t h, FoundCells *found)
{
    const double unit = 1.0 / 2097152; /* 21 bits for each coordinate */
    Vec3 point = vec3(cell.x + unit * (double)(h & 0x1fffff), cell.y + unit * (double)(h >> 21 & 0x1fffff),
                      cell.z + unit * (double)(h >> 42 & 0x1fffff));
    Vec3 apart = vec3_sub(point, p);
    double square = vec3_dot(apart, apart);
    if (square < found->nearest) {
        found->second = found->nearest;
        found->second_point = found->nearest_point;
        found->second_cell = found->cell;
        found->nearest = square;
        found->nearest_point = point;
        found->cell = h;
    } else if (square < found->second) {
        found->second = square;
        found->second_point = point;
        found->second_cell = h;
    }
}

enum { FARTHEST_CELL = 2 };

/* The cells along an axis up to so many away, the nearest first, beginning with the point's own. */
typedef struct CellAxis {
    double cells[2 * FARTHEST_CELL + 1], away[2 * FARTHEST_CELL + 1]; /* the square of how far the point is from each */
    double rim; /* how far it is from what is beyond the own one's neighbours */
} CellAxis;

static inline CellAxis axis_at(double coordinate, int reach)
{
    CellAxis axis;
    double low = floor(coordinate), in = coordinate - low;
    const int near = in < 0.5 ? -1 : 1;
    for (int i = 0; i <= 2 * reach; i++) {
        int step = (i % 2 == 1 ? near : -near) * ((i + 1) / 2);
        double away = step > 0 ? step - in : step < 0 ? in - (step + 1) : 0;
        axis.cells[i] = low + step;
        axis.away[i] = away * away;
    }
    axis.rim = 1 + fmin(in, 1 - in);
    return axis;
}

static uint64_t hash_on(uint64_t h, double cell)
{
    return hash_u64(h ^ (uint64_t)(int64_t)cell);
}

/* Looks at the cells up to `reach` away along some axis, but not at those that a smaller reach has, as far as they may hold a
 * nearer point than the second one found. Returns how far what is beyond the point's neighbours is. */
static inline double consider_cells(Vec3 p, uint64_t h, int reach, FoundCells *found)
{
    const int n = 2 * reach + 1, inner = reach == 1 ? 0 : n - 2;
    const CellAxis x = axis_at(p.x, reach), y = axis_at(p.y, reach), z = axis_at(p.z, reach);
    for (int i = 0; i < n && x.away[i] < found->second; i++) {
        uint64_t hash_x = hash_on(h, x.cells[i]);
        for (int k = 0; k < n && x.away[i] + y.away[k] < found->second; k++) {
            uint64_t hash_y = hash_on(hash_x, y.cells[k]);
            for (int l = i < inner && k < inner ? inner : 0; l < n; l++) {
                if (!(x.away[i] + y.away[k] + z.away[l] < found->second)) break;
                consider_cell(p, vec3(x.cells[i], y.cells[k], z.cells[l]), hash_on(hash_y, z.cells[l]), found);
            }
        }
    }
    return fmin(fmin(x.rim, y.rim), z.rim);
}

PatternCells pattern_cells(Vec3 p, uint64_t seed)
{
    FoundCells found = {.nearest = HUGE_VAL, .second = HUGE_VAL};
    /* The cells around the point's own; then, if what was found is not surely nearer, those around these. */
    const uint64_t start = hash_u64(seed);
    double rim = consider_cells(p, start, 1, &found);
    if (found.second > rim * rim) consider_cells(p, start, FARTHEST_CELL, &found);
    double apart = vec3_length(vec3_sub(found.nearest_point, found.second_point));
    double border = apart > 0 ? 0.5 * (found.second - found.nearest) / apart : 0;
    return (PatternCells){sqrt(found.nearest), sqrt(found.second), border, hash_u64(found.cell),
                          hash_u64(found.second_cell)};
}

static double seen(double frequency, double footprint);

/* The part of a box of that width that is on this side of an edge. */
static double beside(double distance, double width)
{
    return width > 1e-9 ? clamp_unit(0.5 + distance / width) : distance > 0 ? 1 : 0;
}

/* What there is of a value all over, where only a part of it is seen: the means of its lowest seventh, the next, and so on. */
enum { SEVENTHS = 7 };
static void value_or_any(double value, double part, const double sevenths[SEVENTHS], PatternParts *parts)
{
    add_part(parts, value, part);
    for (int i = 0; i < SEVENTHS && part < 1; i++) add_part(parts, sevenths[i], (1 - part) / SEVENTHS);
}
_Static_assert((int)PATTERN_MOST_PARTS > (int)SEVENTHS, "a part for each of them, and one for the value");

static void crackle(const Pattern *pattern, const PatternPlace *place, PatternParts *parts)
{
    /* measured at two million places */
    static const double borders[SEVENTHS] = {0.0187, 0.0591, 0.1051, 0.1592, 0.2256, 0.3156, 0.4926},
                        distances[SEVENTHS] = {0.2446, 0.3768, 0.4565, 0.5241, 0.5899, 0.6639, 0.7868};
    PatternCells cells = pattern_cells(place->p, pattern->seed);
    double near = seen(1, place->footprint);
    if (pattern->value == CRACKLE_CELL) {
        double here = beside(cells.border, place->footprint);
        add_part(parts, hash_to_unit(cells.cell), near * here);
        add_part(parts, hash_to_unit(cells.second_cell), near * (1 - here));
        for (int i = 0; i < 4; i++) add_part(parts, (i + 0.5) / 4, (1 - near) / 4);
    } else if (pattern->value == CRACKLE_BORDER) {
        value_or_any(clamp_unit(cells.second - cells.nearest), near, borders, parts);
    } else {
        value_or_any(clamp_unit(cells.nearest), near, distances, parts);
    }
}

/* The part of space within a distance of a point, measured at each eighth. */
static double spots_cover(double radius)
{
    static const double covers[] = {0, 0.0082, 0.0641, 0.2091, 0.4477, 0.7158, 0.9078, 0.9852, 0.9992, 1, 1};
    double at = fmin(8 * radius, 9);
    int i = (int)at;
    return covers[i] + (covers[i + 1] - covers[i]) * (at - i);
}

static void spots(const Pattern *pattern, const PatternPlace *place, PatternParts *parts)
{
    double inside = pattern->radius - pattern_cells(place->p, pattern->seed).nearest, width = place->footprint;
    double near = clamp_unit(2 - width / fmax(fmin(pattern->radius, 0.5), 1e-9));
    double all = (1 - near) * spots_cover(pattern->radius);
    if (!(pattern->blur > 0))
        two_parts(parts, near * beside(inside, width) + all);
    else
        one_part(parts, near * smooth_step(0.5 + inside / hypot(pattern->blur, width)) + all);
}

/* ---- noise ---- */

/* The root mean square and the mean absolute value of noise_gradient, measured. */
static const double noise_rms = 0.27, noise_mean_size = 0.22;
/* Of what an octave of each style adds: the variance. That of crests is that of (1 - |x|)^2 for a normal x. */
static double octave_variance(NoiseStyle style)
{
    if (style == NOISE_SMOOTH) return noise_rms * noise_rms;
    return style == NOISE_TURBULENCE ? noise_rms * noise_rms - noise_mean_size * noise_mean_size : 0.047;
}

/* How much of an octave of that frequency a footprint lets through: nothing when a period is no larger than it. */
static double seen(double frequency, double footprint)
{
    return clamp_unit(2 - 2 * frequency * footprint);
}

/* Another part of the same noise for each octave, so that their lattices do not meet. Noise is 0 where these have points, and its
 * slopes along them are alike: on a floor that lies in a plane of them squares are seen. So they are turned, about <1, 1, 1> by 60
 * degrees, and no axis of the pattern is one of theirs. */
static Vec3 octave_point(Vec3 p, double frequency, unsigned octave)
{
    const double third = frequency / 3, shift = 5.17 + 17.31 * octave;
    return vec3((2 * p.x - p.y + 2 * p.z) * third + shift, (2 * p.x + 2 * p.y - p.z) * third + shift,
                (2 * p.y + 2 * p.z - p.x) * third + shift);
}

/* What is around a value by that deviation, as a normal distribution has it, in parts of one size: a step of a ramp is to have as
 * much of a footprint on either side as it has of the pattern. */
static void normal_parts(double value, double deviation, PatternParts *parts)
{
    /* the middles of eighths, so far apart that their variance is 1 */
    static const double quantiles[] = {-1.663, -0.962, -0.530, -0.170, 0.170, 0.530, 0.962, 1.663};
    const double least = 0.02;
    if (deviation <= least) {
        one_part(parts, clamp_unit(value));
        return;
    }
    for (size_t i = 0; i < COUNT_OF(quantiles); i++)
        add_part(parts, clamp_unit(value + deviation * quantiles[i]), 1.0 / COUNT_OF(quantiles));
}
_Static_assert(PATTERN_MOST_PARTS >= 8, "a part for each of them");

static void noise(const Pattern *pattern, const PatternPlace *place, PatternParts *parts)
{
    const double crest = 1 - 2 * noise_mean_size + noise_rms * noise_rms; /* the mean of (1 - |noise|)^2 */
    /* beyond it there is no noise */
    const double most = 0.5 * NOISE_LARGEST_COORDINATE / (1 + vec3_max_abs(place->p));
    double sum = 0, weight = 1, weights = 0, squares = 0, hidden = 0, frequency = 1;
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
        hidden += weight * weight * (1 - part * part);
        weight *= pattern->gain;
        frequency *= pattern->lacunarity;
    }
    /* two standard deviations reach from the middle to either end */
    const bool smooth = pattern->style == NOISE_SMOOTH;
    double scale = smooth                               ? 0.25 / (noise_rms * sqrt(squares))
                   : pattern->style == NOISE_TURBULENCE ? 1 / (weights * 2.5 * noise_mean_size)
                                                        : 1 / weights;
    normal_parts((smooth ? 0.5 : 0) + scale * sum, scale * sqrt(hidden * octave_variance(pattern->style)), parts);
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

/* ---- waves over a width ---- */

static double wave_integral(PatternWave wave, double x)
{
    double t = fraction(x), whole = floor(x);
    switch (wave) {
    case WAVE_RAMP: break;
    case WAVE_TRIANGLE: return 0.5 * whole + (t < 0.5 ? t * t : 0.5 - (1 - t) * (1 - t));
    case WAVE_SINE: return 0.5 * whole + 0.5 * t - sin(2 * MEN_PI * t) / (4 * MEN_PI);
    case WAVE_SCALLOP: return (2 * whole + 1 - cos(MEN_PI * t)) / MEN_PI;
    case WAVE_ONCE: return x < 0 ? 0 : x < 1 ? 0.5 * x * x : x - 0.5;
    }
    return 0.5 * (whole + t * t);
}

/* One year's ring: it darkens slowly in summer, and ends at once. */
static const double summer = 0.85;

static double ring(double distance)
{
    double t = fraction(distance);
    return t < summer ? smooth_step(t / summer) : 1 - smooth_step((t - summer) / (1 - summer));
}

static double ring_integral(double distance)
{
    double t = fraction(distance), rest = 1 - summer;
    double up = summer * rise_integral(fmin(t / summer, 1), 1), past = fmax(t - summer, 0);
    return 0.5 * floor(distance) + up + past - rest * rise_integral(past / rest, 1);
}

/* What has a value at x and an integral. */
typedef struct Wave {
    const Pattern *pattern; /* GRADIENT; NULL: rings */
    double more;            /* is added to each value */
} Wave;

static double wave_mean(const Wave *wave, double x, double width)
{
    double value;
    if (!is_extended(width, x)) {
        value = wave->pattern ? pattern_wave(wave->pattern->wave, x) : ring(x);
    } else {
        double low = x - 0.5 * width, high = x + 0.5 * width;
        value = wave->pattern ? wave_integral(wave->pattern->wave, high) - wave_integral(wave->pattern->wave, low)
                              : ring_integral(high) - ring_integral(low);
        value /= width;
    }
    return clamp_unit(value + wave->more);
}

/* n parts of the wave from x on, with that weight in all. */
static void wave_stretch(const Wave *wave, double x, double width, int n, double weight, PatternParts *parts)
{
    for (int i = 0; i < n; i++) add_part(parts, wave_mean(wave, x + width * (i + 0.5) / n, width / n), weight / n);
}

/* In several parts, where colours that values stand for may change within the width. Of many periods one stands for all. */
static void wave_parts(const Wave *wave, double x, double width, PatternParts *parts)
{
    const double least = 0.02, from = x - 0.5 * width;
    const bool repeats = !wave->pattern || wave->pattern->wave != WAVE_ONCE;
    if (width <= 1 || !repeats) {
        wave_stretch(wave, from, width, width > least ? PATTERN_MOST_PARTS : 1, 1, parts);
        return;
    }
    double whole = floor(width), rest = width - whole;
    int of_rest = whole < 4 ? 3 : 1;
    wave_stretch(wave, from, 1, PATTERN_MOST_PARTS - of_rest, whole / width, parts);
    wave_stretch(wave, from + whole, rest, of_rest, rest / width, parts);
}

/* How fast a distance from the origin, or from an axis, changes along the footprint. */
static double width_outward(const PatternPlace *place, Vec3 from_origin, double length)
{
    return length > 0 ? width_along(place, vec3_scale(from_origin, 1 / length)) : place->footprint;
}

static void wood(const Pattern *pattern, const PatternPlace *place, PatternParts *parts)
{
    Vec3 p = place->p;
    double distance = sqrt(p.x * p.x + p.y * p.y), part = pattern->grain * seen(24, place->footprint);
    Wave wave = {.more = 0};
    if (part > 0)
        wave.more = part * noise_gradient(vec3(p.x * 24, p.y * 24, p.z * 0.7), pattern->seed) / noise_rms * 0.5;
    wave_parts(&wave, distance, width_outward(place, vec3(p.x, p.y, 0), distance), parts);
}

static void gradient(const Pattern *pattern, const PatternPlace *place, PatternParts *parts)
{
    Vec3 p = place->p, aside = vec3(p.x, 0, p.z);
    double along = p.x, width = width_along(place, vec3(1, 0, 0)), radius = vec3_length(aside);
    switch (pattern->shape) {
    case GRADIENT_LINEAR: break;
    case GRADIENT_RADIAL:
        along = radius > 0 ? fraction(atan2(-p.z, p.x) / (2 * MEN_PI)) : 0;
        width =
            radius > 0 ? fmin(width_along(place, vec3(-p.z / radius, 0, p.x / radius)) / (2 * MEN_PI * radius), 1) : 0;
        break;
    case GRADIENT_SPHERICAL:
        along = vec3_length(p);
        width = width_outward(place, p, along);
        break;
    case GRADIENT_CYLINDRICAL:
        along = radius;
        width = width_outward(place, aside, radius);
        break;
    }
    wave_parts(&(Wave){.pattern = pattern}, along * pattern->frequency + pattern->phase,
               width * fabs(pattern->frequency), parts);
}

static void granite(const Pattern *pattern, const PatternPlace *place, PatternParts *parts)
{
    /* measured at two million places */
    static const double sevenths[SEVENTHS] = {0.1832, 0.2786, 0.3474, 0.4138, 0.4865, 0.5780, 0.7444};
    const double near = seen(4, place->footprint);
    double sum = 0, weight = 1, frequency = 4, hidden = 0;
    for (unsigned i = 0; i < 6; i++, weight *= 0.5, frequency *= 2) {
        double part = seen(frequency, place->footprint), value = 0;
        if (part > 0) value = fabs(noise_gradient(octave_point(place->p, frequency, i), pattern->seed));
        sum += weight * (part * value + (1 - part) * noise_mean_size);
        hidden += weight * weight * (1 - part * part);
    }
    if (near < 1)
        value_or_any(clamp_unit(sum), near, sevenths, parts);
    else
        normal_parts(sum, sqrt(hidden * octave_variance(NOISE_TURBULENCE)), parts);
}

static void agate(const Pattern *pattern, const PatternPlace *place, PatternParts *parts)
{
    /* of such a wave, at the middles of sevenths of its rise */
    static const double bands[SEVENTHS] = {0.03432286945951352, 0.1815836766825379, 0.378393997121226,
                                           0.5864174746159393,  0.7739673440155534, 0.9149012204519817,
                                           0.9903332583169479};
    Vec3 p = place->p;
    double twist = 0, weight = 1, frequency = 1;
    for (unsigned i = 0; i < 5; i++, weight *= 0.5, frequency *= 2)
        twist +=
            weight * seen(frequency, place->footprint) * noise_gradient(octave_point(p, frequency, i), pattern->seed);
    double band = pow(pattern_wave(WAVE_SINE, 1.1 * p.z + 1.3 * twist), 0.77);
    value_or_any(band, seen(1.1, width_along(place, vec3(0, 0, 1))), bands, parts);
}

void pattern_parts(const Pattern *pattern, const PatternPlace *given, PatternParts *parts)
{
    PatternPlace place = *given;
    if (!is_usable(place.p)) place.p = vec3(0, 0, 0);
    parts->n = 0;
    switch (pattern->kind) {
    case PATTERN_CHECKER: pattern_checker(&place, parts); break;
    case PATTERN_BRICK: pattern_brick(pattern, &place, parts); break;
    case PATTERN_HEXAGON: pattern_hexagon(&place, parts); break;
    case PATTERN_GRADIENT: gradient(pattern, &place, parts); break;
    case PATTERN_NOISE: noise(pattern, &place, parts); break;
    case PATTERN_WOOD: wood(pattern, &place, parts); break;
    case PATTERN_GRANITE: granite(pattern, &place, parts); break;
    case PATTERN_CRACKLE: crackle(pattern, &place, parts); break;
    case PATTERN_SPOTS: spots(pattern, &place, parts); break;
    case PATTERN_AGATE: agate(pattern, &place, parts); break;
    }
}

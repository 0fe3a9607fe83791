/* crystal.c - see crystal.h.
 * Directions are in the frame of the boundary: x along what the wave's phase does on it, z through it. A wave vector has the length of
 * its index.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/crystal.h"

#include <math.h>
#include <stddef.h>

/* ---- complex numbers ---- */

typedef struct Complex {
    double re, im;
} Complex;

typedef struct Vec3c {
    Complex x, y, z;
} Vec3c;

static Complex real(double re)
{
    return (Complex){re, 0};
}

static Complex subtract(Complex a, Complex b)
{
    return (Complex){a.re - b.re, a.im - b.im};
}

static Complex multiply(Complex a, Complex b)
{
    return (Complex){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static Complex scale(Complex a, double s)
{
    return (Complex){a.re * s, a.im * s};
}

static double square_of(Complex a)
{
    return a.re * a.re + a.im * a.im;
}

static Complex divide(Complex a, Complex b)
{
    return scale(multiply(a, (Complex){b.re, -b.im}), 1 / square_of(b));
}

static Vec3c cross(Vec3c a, Vec3c b)
{
    return (Vec3c){subtract(multiply(a.y, b.z), multiply(a.z, b.y)), subtract(multiply(a.z, b.x), multiply(a.x, b.z)),
                   subtract(multiply(a.x, b.y), multiply(a.y, b.x))};
}

static Complex dot(Vec3c a, Vec3 b)
{
    return (Complex){a.x.re * b.x + a.y.re * b.y + a.z.re * b.z, a.x.im * b.x + a.y.im * b.y + a.z.im * b.z};
}

static Vec3c from_real(Vec3 a)
{
    return (Vec3c){real(a.x), real(a.y), real(a.z)};
}

const char *crystal_wave_name(CrystalWave wave)
{
    static const char *const names[] = {NULL, "ordinary", "extraordinary"};
    return names[wave];
}

/* ---- waves ---- */

/* One side, with its axis in the boundary's frame. */
typedef struct Side {
    double ordinary, extraordinary; /* squares of the indices */
    bool isotropic;
    Vec3 axis;
} Side;

typedef struct Wave {
    Vec3c vector;
    Vec3c electric, magnetic;
    bool goes; /* else it fades away from the boundary, and takes no energy along */
} Wave;

/* What of a wave's energy goes through the boundary, upwards. */
static double flow(const Wave *wave)
{
    const Vec3c *e = &wave->electric, *h = &wave->magnetic;
    return e->x.re * h->y.re + e->x.im * h->y.im - e->y.re * h->x.re - e->y.im * h->x.im;
}

static void scale_vector(Vec3c *v, double s)
{
    v->x = scale(v->x, s);
    v->y = scale(v->y, s);
    v->z = scale(v->z, s);
}

/* The electric field of one of two waves: of an extraordinary one along (k . c) k - n_o^2 c, of an ordinary one across k and the axis c.
 * Both have any polarization along the axis, and in what is isotropic: then the first is across the plane of incidence. */
static Vec3c electric_of(const Side *side, bool extraordinary, Vec3c k)
{
    const Vec3c c = from_real(side->axis), y = {real(0), real(1), real(0)};
    const Vec3c across = cross(k, c);
    const double least = 1e-20 * side->ordinary;
    if (side->isotropic || square_of(across.x) + square_of(across.y) + square_of(across.z) < least)
        return extraordinary ? cross(k, y) : y;
    if (!extraordinary) return across;
    const Complex along = dot(k, side->axis);
    return (Vec3c){subtract(multiply(along, k.x), scale(c.x, side->ordinary)),
                   subtract(multiply(along, k.y), scale(c.y, side->ordinary)),
                   subtract(multiply(along, k.z), scale(c.z, side->ordinary))};
}

static Wave wave_of(const Side *side, bool extraordinary, Vec3c k, bool goes)
{
    Wave wave = {.vector = k, .electric = electric_of(side, extraordinary, k), .goes = goes};
    const Vec3c *e = &wave.electric;
    scale_vector(&wave.electric, 1 / sqrt(square_of(e->x) + square_of(e->y) + square_of(e->z)));
    wave.magnetic = cross(k, wave.electric);
    return wave;
}

/* The surface of extraordinary waves is k . A k = 1, with A = 1 / n_e^2 + (1 / n_o^2 - 1 / n_e^2) c c; their light goes along A k. */
static Vec3 surface_normal(const Side *side, Vec3 k)
{
    const double all = 1 / side->extraordinary, more = 1 / side->ordinary - all;
    return vec3_along(vec3_scale(k, all), more * vec3_dot(side->axis, k), side->axis);
}

/* The wave that leaves the boundary with this phase along x, upwards or downwards. */
static Wave leaving(const Side *side, bool extraordinary, double phase, bool upwards)
{
    const double sign = upwards ? 1 : -1;
    double middle = 0, square = side->ordinary - phase * phase, divisor = 1;
    if (extraordinary && !side->isotropic) {
        const Vec3 of_x = surface_normal(side, vec3(1, 0, 0)), of_z = surface_normal(side, vec3(0, 0, 1));
        const double b = of_x.z * phase, c = of_x.x * phase * phase - 1;
        divisor = of_z.z;
        middle = -b / divisor;
        square = b * b - divisor * c;
    }
    const double root = sign * sqrt(fabs(square)) / divisor;
    const bool goes = square > 0;
    const Complex z = goes ? real(middle + root) : (Complex){middle, root};
    return wave_of(side, extraordinary, (Vec3c){real(phase), real(0), z}, goes);
}

static Vec3 ray_of(const Side *side, bool extraordinary, const Wave *wave)
{
    const Vec3 k = vec3(wave->vector.x.re, wave->vector.y.re, wave->vector.z.re);
    return vec3_normalize(extraordinary && !side->isotropic ? surface_normal(side, k) : k);
}

/* ---- a boundary ---- */

enum { WAVES = 4 };
/* A part that is this by rounding alone. */
static const double nothing = 1e-14;
/* What less of a wave goes through the boundary than this goes along it. */
static const double grazing = 1e-9;

/* The components of fields along the boundary. */
static void put_components(const Wave *wave, double sign, Complex column[WAVES])
{
    column[0] = scale(wave->electric.x, sign);
    column[1] = scale(wave->electric.y, sign);
    column[2] = scale(wave->magnetic.x, sign);
    column[3] = scale(wave->magnetic.y, sign);
}

/* Amplitudes of four waves, by columns of their components, for up to two sums of these. The columns are used up. */
static void solve(Complex columns[WAVES][WAVES], Complex sums[2][WAVES], uint32_t n_sums)
{
    const int n = WAVES + (int)n_sums;
    for (int i = 0; i < WAVES; i++) {
        int largest = i;
        for (int row = i + 1; row < WAVES; row++)
            if (square_of(columns[i][row]) > square_of(columns[i][largest])) largest = row;
        for (int k = 0; k < n; k++) {
            Complex *column = k < WAVES ? columns[k] : sums[k - WAVES], swapped = column[i];
            column[i] = column[largest];
            column[largest] = swapped;
        }
        for (int row = i + 1; row < WAVES; row++) {
            const Complex factor = divide(columns[i][row], columns[i][i]);
            for (int k = i + 1; k < n; k++) {
                Complex *column = k < WAVES ? columns[k] : sums[k - WAVES];
                column[row] = subtract(column[row], multiply(factor, column[i]));
            }
        }
    }
    for (uint32_t k = 0; k < n_sums; k++)
        for (int i = WAVES - 1; i >= 0; i--) {
            for (int known = i + 1; known < WAVES; known++)
                sums[k][i] = subtract(sums[k][i], multiply(columns[known][i], sums[k][known]));
            sums[k][i] = divide(sums[k][i], columns[i][i]);
        }
}

typedef struct Frame {
    Vec3 x, y, z;
} Frame;

static Vec3 into(const Frame *frame, Vec3 v)
{
    return vec3(vec3_dot(frame->x, v), vec3_dot(frame->y, v), vec3_dot(frame->z, v));
}

static Vec3 out_of(const Frame *frame, Vec3 v)
{
    return vec3_along(vec3_along(vec3_scale(frame->x, v.x), v.y, frame->y), v.z, frame->z);
}

double crystal_ray_index(const CrystalSide *side, CrystalWave wave, Vec3 direction)
{
    if (wave != CRYSTAL_EXTRAORDINARY) return side->ordinary;
    const double o = side->ordinary * side->ordinary, e = side->extraordinary * side->extraordinary,
                 cosine = vec3_dot(side->axis, direction);
    return sqrt(e + (o - e) * cosine * cosine);
}

/* k of a ray: of an extraordinary one along A^-1 s = n_e^2 s + (n_o^2 - n_e^2) (c . s) c. */
static Vec3 vector_of_ray(const CrystalSide *side, CrystalWave wave, Vec3 direction)
{
    if (wave != CRYSTAL_EXTRAORDINARY) return vec3_scale(direction, side->ordinary);
    const double o = side->ordinary * side->ordinary, e = side->extraordinary * side->extraordinary;
    Vec3 k = vec3_along(vec3_scale(direction, e), (o - e) * vec3_dot(side->axis, direction), side->axis);
    return vec3_scale(k, 1 / crystal_ray_index(side, wave, direction));
}

static Frame frame_of(Vec3 k, Vec3 normal)
{
    const Vec3 z = vec3_scale(normal, -1), along = vec3_along(k, -vec3_dot(k, z), z);
    Vec3 x = along;
    if (!(vec3_dot(x, x) > 1e-24)) x = vec3_cross(z, fabs(z.x) < 0.5 ? vec3(1, 0, 0) : vec3(0, 1, 0));
    x = vec3_normalize(x);
    return (Frame){x, vec3_cross(z, x), z};
}

static Side side_in(const Frame *frame, const CrystalSide *side)
{
    return (Side){side->ordinary * side->ordinary, side->extraordinary * side->extraordinary,
                  crystal_is_isotropic(side), into(frame, side->axis)};
}

/* Light that goes along the boundary, to rounding, stays on its side. */
static uint32_t mirror(Vec3 direction, CrystalWave wave, Vec3 normal, CrystalWay *way)
{
    *way = (CrystalWay){
        .wave = wave, .direction = vec3_along(direction, -2 * vec3_dot(direction, normal), normal), .part = 1};
    return 1;
}

uint32_t crystal_meet(const CrystalSide *from, const CrystalSide *to, Vec3 direction, CrystalWave wave, Vec3 normal,
                      CrystalWay ways[CRYSTAL_WAYS])
{
    const Vec3 world_k = vector_of_ray(from, wave, direction);
    const Frame frame = frame_of(world_k, normal);
    const Side sides[2] = {side_in(&frame, from), side_in(&frame, to)};
    const Vec3c k = from_real(into(&frame, world_k));
    /* two polarizations of unpolarized light, or a wave of one */
    const uint32_t n_coming = wave == CRYSTAL_UNPOLARIZED ? 2 : 1;
    Wave coming[2], left[WAVES];
    Complex columns[WAVES][WAVES], amplitudes[2][WAVES];
    for (uint32_t i = 0; i < n_coming; i++) {
        coming[i] = wave_of(&sides[0], n_coming == 2 ? i == 1 : wave == CRYSTAL_EXTRAORDINARY, k, true);
        put_components(&coming[i], -1, amplitudes[i]);
        if (!(flow(&coming[i]) > grazing)) return mirror(direction, wave, normal, ways);
    }
    for (uint32_t i = 0; i < WAVES; i++) {
        const bool through = i >= 2;
        left[i] = leaving(&sides[through], i % 2 == 1, k.x.re, through);
        put_components(&left[i], through ? -1 : 1, columns[i]);
    }
    solve(columns, amplitudes, n_coming);
    uint32_t n = 0;
    for (uint32_t i = 0; i < WAVES; i++) {
        const Side *side = &sides[i >= 2];
        double part = 0;
        for (uint32_t c = 0; c < n_coming; c++)
            part += square_of(amplitudes[c][i]) * fabs(flow(&left[i]) / flow(&coming[c])) / n_coming;
        if (!left[i].goes || !(part > nothing)) continue;
        if (side->isotropic && i % 2 == 1 && n > 0 && ways[n - 1].through == (i >= 2)) {
            ways[n - 1].part += part; /* both polarizations go there */
            continue;
        }
        ways[n++] = (CrystalWay){.wave = side->isotropic ? CRYSTAL_UNPOLARIZED
                                         : i % 2 == 1    ? CRYSTAL_EXTRAORDINARY
                                                         : CRYSTAL_ORDINARY,
                                 .through = i >= 2,
                                 .direction = out_of(&frame, ray_of(side, i % 2 == 1, &left[i])),
                                 .part = part};
    }
    return n > 0 ? n : mirror(direction, wave, normal, ways);
}

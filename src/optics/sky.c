/* sky.c - see sky.h. Lengths are in kilometres.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/sky.h"

#include <stdlib.h>
#include <string.h>

enum { BANDS = ENVIRONMENT_BANDS, WIDTH = 256, HEIGHT = 128, STEPS = 40 };

static const double pi = 3.14159265358979323846;
static const double earth = 6371, top = 6471; /* radii */
static const double rayleigh_height = 8.4, aerosol_height = 1.2;
static const double ozone_middle = 25, ozone_reach = 15;
static const float aerosol_g = 0.76f;
static const float aerosol_albedo = 0.93f; /* of what aerosol takes from a ray, so much is scattered */
/* Of that, so much goes so nearly straight on that further scattering cannot tell it from light that was not scattered:
 * g squared (J. H. Joseph, W. J. Wiscombe, J. A. Weinman, "The Delta-Eddington Approximation for Radiative Flux Transfer",
 * Journal of the Atmospheric Sciences 33 (1976)). */
static const float aerosol_ahead = 0.76f * 0.76f;
static const float aerosol_whole = 0.93f / (1 - 0.93f * 0.76f * 0.76f); /* all that it scatters, over what is left */

/* How much of a substance is along a line, as lengths at the ground's density (ozone: at its densest). */
typedef struct Columns {
    float rayleigh, aerosol, ozone;
} Columns;

enum { COLUMN_HEIGHTS = 48, COLUMN_ANGLES = 128, SECOND_HEIGHTS = 12, SECOND_ANGLES = 12 };

typedef struct Sky {
    float rayleigh[BANDS], aerosol[BANDS], ozone[BANDS]; /* extinction per km at the ground (ozone: at its densest) */
    float ground[BANDS];
    double sine; /* of the sun's elevation */
    Vec3 sun;
    Columns columns[COLUMN_HEIGHTS][COLUMN_ANGLES]; /* up to space, by height and by angle above the horizon there */
    float second[SECOND_HEIGHTS][SECOND_ANGLES][BANDS]; /* all further scattering: radiance from everywhere, per sun */
    double second_low, second_high;                     /* range of the sun's cosine */
} Sky;

static double band_um(int band)
{
    return 1e-3 * ((double)SPECTRUM_MIN_NM + band * ((double)SPECTRUM_MAX_NM - (double)SPECTRUM_MIN_NM) / (BANDS - 1));
}

/* Cross section of ozone in 1e-21 cm^2, rounded, after V. Gorshelev et al., "High spectral resolution ozone absorption
 * cross-sections", Atmospheric Measurement Techniques 7 (2014): every 20 nm from 400 nm. */
static double ozone_cross_section(double um)
{
    static const double values[] = {0.01, 0.03, 0.12, 0.35, 0.7,  1.2, 1.8,  2.9, 3.9, 4.7,  5.1,
                                    4.0,  2.9,  2.1,  1.4,  0.88, 0.6, 0.42, 0.3, 0.2, 0.12, 0.1};
    double at = (1e3 * um - 400) / 20;
    if (at < 0) return values[0];
    int i = (int)at;
    if (i >= (int)(sizeof values / sizeof *values) - 1) return values[sizeof values / sizeof *values - 1];
    return values[i] + (at - i) * (values[i + 1] - values[i]);
}

static double rayleigh_depth(double um)
{
    double w = 1 / (um * um);
    return 0.008569 * w * w * (1 + 0.0113 * w + 0.00013 * w * w);
}

/* Extinction per km where each substance is densest, at any wavelength. */
static void extinctions(double turbidity, double um, double *rayleigh, double *aerosol, double *ozone)
{
    const double molecules = 8.07e18; /* per cm^2, 300 Dobson units */
    *rayleigh = rayleigh_depth(um) / rayleigh_height;
    *aerosol = (turbidity - 1) * rayleigh_depth(0.55) * pow(um / 0.55, -1.3) / aerosol_height;
    *ozone =
        molecules * 1e-21 * ozone_cross_section(um) / ozone_reach; /* the layer is a triangle: its area is the reach */
}

/* ---- what is along a line ---- */

static Columns density_at(double height)
{
    double ozone = 1 - fabs(height - ozone_middle) / ozone_reach;
    return (Columns){(float)exp(-height / rayleigh_height), (float)exp(-height / aerosol_height),
                     (float)fmax(ozone, 0)};
}

/* From a radius along a direction of that cosine against the vertical to a sphere around the earth; the far crossing. */
static double distance_to(double sphere, double radius, double cosine)
{
    return -radius * cosine + sqrt(fmax(sphere * sphere - radius * radius * (1 - cosine * cosine), 0));
}

static bool meets_ground(double radius, double cosine)
{
    return cosine < 0 && radius * radius * (1 - cosine * cosine) < earth * earth;
}

static Columns columns_up(double radius, double cosine)
{
    enum { FINE = 160 };
    double length = distance_to(top, radius, cosine), rayleigh = 0, aerosol = 0, ozone = 0;
    for (int i = 0; i < FINE; i++) {
        double a = (double)i / FINE, b = (i + 1.0) / FINE; /* steps grow with the square */
        double step = length * (b * b - a * a), at = length * 0.5 * (a * a + b * b);
        double here = sqrt(radius * radius + at * at + 2 * radius * at * cosine);
        Columns density = density_at(here - earth);
        rayleigh += step * (double)density.rayleigh;
        aerosol += step * (double)density.aerosol;
        ozone += step * (double)density.ozone;
    }
    return (Columns){(float)rayleigh, (float)aerosol, (float)ozone};
}

static double horizon_cosine(double radius)
{
    double ratio = earth / radius;
    return ratio < 1 ? -sqrt(1 - ratio * ratio) : 0;
}

static void fill_columns(Sky *sky)
{
    for (int h = 0; h < COLUMN_HEIGHTS; h++)
        for (int a = 0; a < COLUMN_ANGLES; a++) {
            double up = (double)h / (COLUMN_HEIGHTS - 1), radius = earth + up * up * (top - earth);
            double horizon = horizon_cosine(radius), part = (double)a / (COLUMN_ANGLES - 1);
            sky->columns[h][a] = columns_up(radius, horizon + part * part * (1 - horizon));
        }
}

static Columns mix_columns(Columns a, Columns b, float t)
{
    return (Columns){a.rayleigh + t * (b.rayleigh - a.rayleigh), a.aerosol + t * (b.aerosol - a.aerosol),
                     a.ozone + t * (b.ozone - a.ozone)};
}

/* false in the earth's shadow */
static bool columns_to_sun(const Sky *sky, double radius, double cosine, Columns *columns)
{
    double horizon = horizon_cosine(radius);
    if (cosine < horizon) return false;
    double y = sqrt(fmin(fmax((radius - earth) / (top - earth), 0), 1)) * (COLUMN_HEIGHTS - 1);
    double x = sqrt((cosine - horizon) / (1 - horizon)) * (COLUMN_ANGLES - 1);
    int row = y < COLUMN_HEIGHTS - 2 ? (int)y : COLUMN_HEIGHTS - 2,
        column = x < COLUMN_ANGLES - 2 ? (int)x : COLUMN_ANGLES - 2;
    const Columns *below = &sky->columns[row][column], *above = &sky->columns[row + 1][column];
    float across = (float)(x - column);
    *columns =
        mix_columns(mix_columns(below[0], below[1], across), mix_columns(above[0], above[1], across), (float)(y - row));
    return true;
}

/* ---- scattering ---- */

static float rayleigh_phase(float cosine)
{
    return 3 / (16 * (float)pi) * (1 + cosine * cosine);
}

static float aerosol_phase(float cosine)
{
    float g = aerosol_g, base = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) / (4 * (float)pi * base * sqrtf(base));
}

/* What a line of sight gathers: light that is scattered into it once, by the phase functions given, for a sun of
 * irradiance 1; and how much of what is even in all directions it would gather (spread). */
typedef struct Sight {
    float radiance[BANDS], spread[BANDS], transmittance[BANDS];
} Sight;

static const float *second_at(const Sky *sky, double height, double cosine, float room[BANDS])
{
    double y = sqrt(fmin(fmax(height / (top - earth), 0), 1)) * (SECOND_HEIGHTS - 1);
    double x = (cosine - sky->second_low) / (sky->second_high - sky->second_low) * (SECOND_ANGLES - 1);
    x = fmin(fmax(x, 0), SECOND_ANGLES - 1);
    int row = y < SECOND_HEIGHTS - 2 ? (int)y : SECOND_HEIGHTS - 2,
        column = x < SECOND_ANGLES - 2 ? (int)x : SECOND_ANGLES - 2;
    float down = (float)(y - row), across = (float)(x - column);
    for (int b = 0; b < BANDS; b++) {
        float low =
            sky->second[row][column][b] + across * (sky->second[row][column + 1][b] - sky->second[row][column][b]);
        float high = sky->second[row + 1][column][b] +
                     across * (sky->second[row + 1][column + 1][b] - sky->second[row + 1][column][b]);
        room[b] = low + down * (high - low);
    }
    return room;
}

/* From a place along a unit direction. even: all scattering counts as even in all directions, once; else by the phase
 * functions, and with all further scattering. */
static void look(const Sky *sky, Vec3 from, Vec3 direction, bool even, int n_steps, Sight *sight)
{
    double radius = vec3_length(from), cosine = vec3_dot(from, direction) / radius;
    bool ground = meets_ground(radius, cosine);
    double length = ground ? -radius * cosine - sqrt(earth * earth - radius * radius * (1 - cosine * cosine))
                           : distance_to(top, radius, cosine);
    float toward = (float)vec3_dot(direction, sky->sun), isotropic = 1 / (4 * (float)pi);
    float molecules = even ? isotropic : rayleigh_phase(toward), haze = even ? isotropic : aerosol_phase(toward);
    float depth[BANDS] = {0};
    memset(sight, 0, sizeof *sight);
    for (int i = 0; i < n_steps; i++) {
        double a = (double)i / n_steps, b = (i + 1.0) / n_steps;
        double step = length * (b * b - a * a), at = length * 0.5 * (a * a + b * b);
        Vec3 here = vec3_along(from, at, direction);
        double here_radius = vec3_length(here), sun_cosine = vec3_dot(here, sky->sun) / here_radius;
        Columns density = density_at(here_radius - earth), up;
        bool lit = columns_to_sun(sky, here_radius, sun_cosine, &up);
        float room[BANDS];
        const float *second = even ? NULL : second_at(sky, here_radius - earth, sun_cosine, room);
        for (int k = 0; k < BANDS; k++) {
            float scattering_r = sky->rayleigh[k] * density.rayleigh;
            float extinction_a = sky->aerosol[k] * density.aerosol, whole_a = aerosol_whole * extinction_a;
            float scattering_a = (1 - aerosol_ahead) * whole_a, once_a = even ? scattering_a : whole_a;
            float piece = (float)step * (scattering_r + extinction_a + sky->ozone[k] * density.ozone);
            float seen = expf(-depth[k] - 0.5f * piece) * (float)step;
            if (lit)
                sight->radiance[k] +=
                    seen * (scattering_r * molecules + once_a * haze) *
                    expf(-(sky->rayleigh[k] * up.rayleigh + sky->aerosol[k] * up.aerosol + sky->ozone[k] * up.ozone));
            if (second) sight->radiance[k] += seen * (scattering_r + scattering_a) * second[k];
            sight->spread[k] += seen * (scattering_r + scattering_a);
            depth[k] += piece;
        }
    }
    for (int k = 0; k < BANDS; k++) sight->transmittance[k] = expf(-depth[k]);
    Vec3 end = vec3_along(from, length, direction);
    double sun_cosine = vec3_dot(end, sky->sun) / vec3_length(end);
    Columns up;
    if (!ground || !even || sun_cosine <= 0 || !columns_to_sun(sky, earth, sun_cosine, &up)) return;
    for (int k = 0; k < BANDS; k++)
        sight->radiance[k] +=
            sight->transmittance[k] * sky->ground[k] / (float)pi * (float)sun_cosine *
            expf(-(sky->rayleigh[k] * up.rayleigh + sky->aerosol[k] * up.aerosol + sky->ozone[k] * up.ozone));
}

/* Hillaire's eq. 5 to 9: the light of second order, taken as even, and of all further ones as a geometric series. */
static void fill_second(Sky *sky)
{
    enum { DIRECTIONS = 32, FEW = 14 };
    Vec3 sun = sky->sun;
    sky->second_low = fmax(sky->sine - 0.25, -1);
    sky->second_high = fmin(sky->sine + 0.25, 1);
    for (int h = 0; h < SECOND_HEIGHTS; h++)
        for (int a = 0; a < SECOND_ANGLES; a++) {
            double up = (double)h / (SECOND_HEIGHTS - 1), radius = earth + 1e-3 + up * up * (top - earth - 1e-2);
            double cosine = sky->second_low + (sky->second_high - sky->second_low) * a / (SECOND_ANGLES - 1);
            sky->sun = vec3(0, cosine, sqrt(1 - cosine * cosine));
            double sum[BANDS] = {0}, spread[BANDS] = {0};
            for (int i = 0; i < DIRECTIONS; i++) {
                double y = 1 - (2 * i + 1.0) / DIRECTIONS, turn = 2.399963229728653 * i, r = sqrt(1 - y * y);
                Sight sight;
                look(sky, vec3(0, radius, 0), vec3(r * cos(turn), y, r * sin(turn)), true, FEW, &sight);
                for (int k = 0; k < BANDS; k++) {
                    sum[k] += (double)sight.radiance[k] / DIRECTIONS;
                    spread[k] += (double)sight.spread[k] / DIRECTIONS;
                }
            }
            for (int k = 0; k < BANDS; k++) sky->second[h][a][k] = (float)(sum[k] / (1 - fmin(spread[k], 0.98)));
        }
    sky->sun = sun;
}

/* ---- the picture ---- */

static Vec3 texel_direction(int row, int column)
{
    double polar = pi * (row + 0.5) / HEIGHT, turn = 2 * pi * ((column + 0.5) / WIDTH - 0.5);
    return vec3(sin(polar) * sin(turn), cos(polar), -sin(polar) * cos(turn));
}

/* The sky above, whose halves mirror each other, and what falls from it on level ground. */
static void fill_upper(const Sky *sky, float *values, double level[BANDS])
{
    Vec3 from = vec3(0, earth + 1e-3, 0);
    for (int row = 0; row < HEIGHT / 2; row++) {
        double low = cos(pi * row / HEIGHT), high = cos(pi * (row + 1) / HEIGHT);
        double projected = 0.5 * (low * low - high * high) * 2 * pi / WIDTH; /* cosine times solid angle */
        for (int column = 0; column < WIDTH / 2; column++) {
            Sight sight;
            look(sky, from, texel_direction(row, column), false, STEPS, &sight);
            float *texel = values + ((size_t)row * WIDTH + (size_t)column) * BANDS;
            float *other = values + ((size_t)row * WIDTH + (size_t)(WIDTH - 1 - column)) * BANDS;
            for (int k = 0; k < BANDS; k++) {
                texel[k] = other[k] = sight.radiance[k];
                level[k] += 2 * projected * (double)sight.radiance[k];
            }
        }
    }
}

static void fill_lower(const Sky *sky, float *values, const double level[BANDS])
{
    for (size_t i = (size_t)WIDTH * HEIGHT / 2; i < (size_t)WIDTH * HEIGHT; i++)
        for (int k = 0; k < BANDS; k++) values[i * BANDS + (size_t)k] = sky->ground[k] * (float)(level[k] / pi);
}

/* What is left of the sun's light, at one wavelength. */
static double sun_transmittance(const SkyModel *model, Columns columns, double um)
{
    double rayleigh, aerosol, ozone;
    extinctions(model->turbidity, um, &rayleigh, &aerosol, &ozone);
    return exp(
        -(rayleigh * (double)columns.rayleigh + aerosol * (double)columns.aerosol + ozone * (double)columns.ozone));
}

static void prepare(Sky *sky, const SkyModel *model)
{
    for (int k = 0; k < BANDS; k++) {
        double rayleigh, aerosol, ozone;
        extinctions(model->turbidity, band_um(k), &rayleigh, &aerosol, &ozone);
        sky->rayleigh[k] = (float)rayleigh;
        sky->aerosol[k] = (1 - aerosol_albedo * aerosol_ahead) * (float)aerosol;
        sky->ozone[k] = (float)ozone;
        sky->ground[k] = spectrum_at_one(model->ground, (float)(1e3 * band_um(k)));
    }
    sky->sine = sin(model->elevation);
    sky->sun = vec3(0, sky->sine, cos(model->elevation));
    fill_columns(sky);
    fill_second(sky);
}

Status sky_new(const SkyModel *model, Environment **environment, float sun[SPECTRUM_SAMPLES], Error *error)
{
    const double illuminance = 133.3 / 100 * pi; /* above the air, 100 klx counting as pi */
    Sky *sky = calloc(1, sizeof *sky);
    float *values = malloc((size_t)WIDTH * HEIGHT * BANDS * sizeof *values);
    Status status = STATUS_OK;
    if (sky && values) {
        prepare(sky, model);
        Spectrum above = spectrum_blackbody(5778, sun);
        double scale = model->strength * illuminance / spectrum_luminance(&above);
        double level[BANDS] = {0};
        Columns columns = columns_up(earth + 1e-3, sky->sine);
        fill_upper(sky, values, level);
        for (int k = 0; k < BANDS && sky->sine > 0; k++)
            level[k] += sky->sine * sun_transmittance(model, columns, band_um(k));
        fill_lower(sky, values, level);
        for (int i = 0; i < SPECTRUM_SAMPLES; i++) sun[i] = (float)(scale * (double)sun[i]);
        status = environment_new_bands(values, WIDTH, HEIGHT, sun, environment, error);
        for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
            double um = 1e-3 * ((double)SPECTRUM_MIN_NM + i * SPECTRUM_STEP_NM);
            sun[i] *= (float)(sky->sine > 0 ? sun_transmittance(model, columns, um) : 0);
        }
    } else {
        status = fail_memory(error, (size_t)WIDTH * HEIGHT * BANDS * sizeof *values, "a sky");
    }
    free(sky);
    free(values);
    return status;
}

Status sky_new_overcast(const SkyModel *model, Environment **environment, Error *error)
{
    /* of level ground, 100 klx counting as pi; the gradient's mean under the cosine is 7/9 of the zenith's */
    const double level = (0.3 + 21 * sin(model->elevation)) / 100 * pi * model->strength, zenith = level / pi * 9 / 7;
    float *values = malloc((size_t)WIDTH * HEIGHT * BANDS * sizeof *values), white[SPECTRUM_SAMPLES], ground[BANDS];
    if (!values) return fail_memory(error, (size_t)WIDTH * HEIGHT * BANDS * sizeof *values, "a sky");
    for (int i = 0; i < SPECTRUM_SAMPLES; i++)
        white[i] = lanes_get(white_at(lanes_all(SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM))), 0);
    for (int k = 0; k < BANDS; k++)
        ground[k] = (float)(level / pi) * spectrum_at_one(model->ground, (float)(1e3 * band_um(k)));
    for (int row = 0; row < HEIGHT; row++) {
        float radiance = (float)(zenith * (1 + 2 * cos(pi * (row + 0.5) / HEIGHT)) / 3);
        for (int i = 0; i < WIDTH * BANDS; i++)
            values[(size_t)row * WIDTH * BANDS + (size_t)i] = row < HEIGHT / 2 ? radiance : ground[i % BANDS];
    }
    Status status = environment_new_bands(values, WIDTH, HEIGHT, white, environment, error);
    free(values);
    return status;
}

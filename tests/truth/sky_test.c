/* sky_test.c - the computed sky against random walks of light through the same air around the same earth, of all orders of
 * scattering, without the sky's approximations: no truncated phase function, no table, no sum of harmonics. Lengths are in
 * kilometres, light is in units of the sun's irradiance above the air.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#include <stdlib.h>

#include "base/pool.h"
#include "dice.h"
#include "optics/sky.h"

static const double earth = 6371, top = 6471, pi = TRUTH_PI;
static const double ground_albedo = 0.2, aerosol_albedo = 0.93, aerosol_g = 0.76;

/* Extinction per km where each substance is densest, at one wavelength. */
typedef struct Air {
    double rayleigh, aerosol, ozone;
} Air;

/* Cross sections of ozone in 1e-21 cm^2 at the wavelengths asked for (Gorshelev et al. 2014, as in sky.c). */
enum { BLUE, GREEN, RED, COLORS };
static const struct {
    int band;
    double ozone;
} colors[COLORS] = {{3, 0.281}, {6, 3.3}, {9, 2.82}};

static double nm_of(int color)
{
    return 360 + colors[color].band * 470.0 / (ENVIRONMENT_BANDS - 1);
}

static Air air_of(int color, double turbidity)
{
    double um = 1e-3 * nm_of(color), w = 1 / (um * um);
    const double depth = 0.008569 * w * w * (1 + 0.0113 * w + 0.00013 * w * w), at_550 = 0.0973;
    return (Air){depth / 8.4, (turbidity - 1) * at_550 * pow(um / 0.55, -1.3) / 1.2,
                 8.07e18 * 1e-21 * colors[color].ozone / 15};
}

/* Extinctions per km at a place. */
static Air air_at(const Air *air, double radius)
{
    double height = fmax(radius - earth, 0);
    return (Air){air->rayleigh * exp(-height / 8.4), air->aerosol * exp(-height / 1.2),
                 air->ozone * fmax(1 - fabs(height - 25) / 15, 0)};
}

static double whole(Air air)
{
    return air.rayleigh + air.aerosol + air.ozone;
}

static double scattering(Air air)
{
    return air.rayleigh + aerosol_albedo * air.aerosol;
}

/* ---- straight lines ---- */

typedef struct Line {
    Vec3 from, direction;
    double length; /* to the ground, or out of the air */
    bool ground;
} Line;

static Line line_of(Vec3 from, Vec3 direction)
{
    double r2 = vec3_dot(from, from), along = vec3_dot(from, direction), miss = r2 - along * along;
    bool ground = along < 0 && miss < earth * earth;
    return (Line){from, direction,
                  ground ? fmax(-along - sqrt(earth * earth - miss), 0) : -along + sqrt(fmax(top * top - miss, 0)),
                  ground};
}

/* Optical depth from a to b along a line that only rises from a. */
static double depth_rising(const Air *air, const Line *line, double a, double b, int steps)
{
    double sum = 0, r2 = vec3_dot(line->from, line->from), along = vec3_dot(line->from, line->direction);
    for (int i = 0; i < steps; i++) { /* steps grow with the distance */
        double u = (i + 0.5) / steps, at = a + (b - a) * u * u;
        sum += whole(air_at(air, sqrt(r2 + at * at + 2 * at * along))) * 2 * u / steps;
    }
    return sum * fabs(b - a);
}

/* From the line's beginning to a distance. */
static double depth_to(const Air *air, const Line *line, double distance, int steps)
{
    double lowest = -vec3_dot(line->from, line->direction);
    if (lowest <= 0) return depth_rising(air, line, 0, distance, steps);
    if (lowest >= distance) return depth_rising(air, line, distance, 0, steps);
    return depth_rising(air, line, lowest, 0, steps) + depth_rising(air, line, lowest, distance, steps);
}

/* ---- one wavelength, one sun, one direction ---- */

typedef struct Walk {
    Air air;
    Vec3 sun;
    Dice dice;
} Walk;

/* What of the sun's light reaches a place. */
static double sun_at(const Walk *walk, Vec3 place)
{
    Line line = line_of(place, walk->sun);
    return line.ground ? 0 : exp(-depth_to(&walk->air, &line, line.length, 64));
}

static double rayleigh_phase(double cosine)
{
    return 3 / (16 * pi) * (1 + cosine * cosine);
}

static double aerosol_phase(double cosine)
{
    const double g = aerosol_g;
    return (1 - g * g) / (4 * pi * pow(1 + g * g - 2 * g * cosine, 1.5));
}

static Vec3 turned(Vec3 direction, double cosine, double turn)
{
    Vec3 side = vec3_normalize(vec3_cross(direction, fabs(direction.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
    Vec3 other = vec3_cross(direction, side);
    double sine = sqrt(fmax(1 - cosine * cosine, 0));
    Vec3 result = vec3_along(vec3_scale(direction, cosine), sine * cos(turn), side);
    return vec3_normalize(vec3_along(result, sine * sin(turn), other));
}

static double scattered(bool molecule, double u)
{
    const double g = aerosol_g;
    if (molecule) {
        double b = 4 * u - 2, root = sqrt(b * b + 1);
        return cbrt(b + root) - cbrt(root - b);
    }
    double fraction = (1 - g * g) / (1 - g + 2 * g * u);
    return (1 + g * g - fraction * fraction) / (2 * g);
}

/* The distance of a free flight, or infinity: by the densest air on the line, of which most is nothing. */
static double flight(Walk *walk, const Line *line)
{
    double radius = vec3_length(line->from), along = vec3_dot(line->from, line->direction);
    double lowest = line->ground ? earth : along < 0 ? sqrt(radius * radius - along * along) : radius;
    Air bound = air_at(&walk->air, lowest);
    bound.ozone = walk->air.ozone;
    for (double at = 0;;) {
        at -= log(1 - dice_unit(&walk->dice)) / whole(bound);
        if (at >= line->length) return INFINITY;
        double here = sqrt(radius * radius + at * at + 2 * at * along);
        if (dice_unit(&walk->dice) * whole(bound) < whole(air_at(&walk->air, here))) return at;
    }
}

/* Where the light of a view was scattered last, by a number from 0 to 1. Returns the distance; *weight gets the factor. */
static double first_step(Walk *walk, const Line *line, double u, double *weight)
{
    double at = u * u * u * line->length;
    Air here = air_at(&walk->air, vec3_length(vec3_along(line->from, at, line->direction)));
    *weight = scattering(here) * exp(-depth_to(&walk->air, line, at, 48)) * 3 * u * u * line->length;
    return at;
}

/* Where light was scattered last on its way along a line, by one of two rules: as free flights end, or anywhere; thin air
 * high up may be all that is lit. Returns the distance, or infinity for the ground; *weight gets the factor. */
static double step(Walk *walk, const Line *line, double *weight)
{
    bool free = dice_unit(&walk->dice) < 0.5;
    double u = dice_unit(&walk->dice), at = free ? flight(walk, line) : u * u * line->length;
    if (at > line->length) {
        *weight *= line->ground ? 2 : 0;
        return INFINITY;
    }
    Air here = air_at(&walk->air, vec3_length(vec3_along(line->from, at, line->direction)));
    double through = exp(-depth_to(&walk->air, line, at, 32));
    double density = 0.5 * whole(here) * through + 0.25 / sqrt(fmax(at * line->length, 1e-12));
    *weight *= scattering(here) * through / density;
    return at;
}

/* The radiance from a direction above the horizon; first: where the walk begins, 0 to 1. */
static double radiance(Walk *walk, Vec3 from, Vec3 direction, double first)
{
    double weight = 1, sum = 0, start = 1;
    for (int order = 1; weight > 0; order++) {
        Line line = line_of(from, direction);
        double at = order > 1 ? step(walk, &line, &weight) : first_step(walk, &line, first, &weight);
        if (!(weight > 0)) break;
        from = vec3_along(from, isinf(at) ? line.length : at, direction);
        if (isinf(at)) {
            double radius = vec3_length(from), cosine = vec3_dot(from, walk->sun) / radius;
            from = vec3_scale(from, (earth + 1e-9) / radius);
            weight *= ground_albedo;
            if (cosine > 0) sum += weight * cosine / pi * sun_at(walk, from);
            double up = sqrt(dice_unit(&walk->dice)), turn = 2 * pi * dice_unit(&walk->dice);
            direction = turned(vec3_scale(from, 1 / vec3_length(from)), up, turn);
        } else {
            Air here = air_at(&walk->air, vec3_length(from));
            double molecules = here.rayleigh / scattering(here), toward = vec3_dot(direction, walk->sun);
            double phase = molecules * rayleigh_phase(toward) + (1 - molecules) * aerosol_phase(toward);
            sum += weight * phase * sun_at(walk, from);
            bool molecule = dice_unit(&walk->dice) < molecules;
            double u = dice_unit(&walk->dice);
            direction = turned(direction, scattered(molecule, u), 2 * pi * dice_unit(&walk->dice));
        }
        if (order == 1) start = weight;
        if (weight < 0.3 * start) { /* roulette */
            double kept = fmax(weight / (0.3 * start), 0.05);
            if (dice_unit(&walk->dice) >= kept) break;
            weight /= kept;
        }
    }
    return sum;
}

/* ---- days ---- */

typedef struct View {
    double height, azimuth; /* degrees; from the sun. height above 90: all that falls on level ground */
} View;

static const View views[] = {{2, 0}, {2, 90}, {2, 180}, {15, 20}, {15, 180}, {40, 90}, {90, 0}, {99, 0}};
enum { VIEWS = COUNT_OF(views), BATCHES = 16 };

typedef struct Day {
    double elevation, turbidity;
    Estimate truth[COLORS][VIEWS];
    unsigned walks;
} Day;

static Vec3 towards(double height, double azimuth)
{
    return vec3(cos(height) * sin(azimuth), sin(height), cos(height) * cos(azimuth));
}

static void walk_of_day(void *context, uint32_t index, unsigned worker)
{
    (void)worker;
    Day *day = context;
    int color = (int)(index / VIEWS), v = (int)(index % VIEWS);
    double elevation = day->elevation * pi / 180, batches[BATCHES] = {0};
    Walk walk = {air_of(color, day->turbidity), towards(elevation, 0), {1000003ULL * index}};
    for (unsigned i = 0; i < BATCHES * day->walks; i++) {
        View view = views[v];
        bool level = view.height > 90;
        double height = level ? asin(sqrt(dice_unit(&walk.dice))) : view.height * pi / 180;
        double azimuth = level ? 2 * pi * dice_unit(&walk.dice) : view.azimuth * pi / 180;
        double first = (i / BATCHES + dice_unit(&walk.dice)) / day->walks;
        batches[i % BATCHES] +=
            radiance(&walk, vec3(0, earth + 1e-9, 0), towards(height, azimuth), first) * (level ? pi : 1) / day->walks;
    }
    day->truth[color][v] = truth_estimate(batches, BATCHES);
}

static double of_sky(const Environment *sky, View view, double nm)
{
    enum { SIDE = 60 };
    double sum = 0;
    bool level = view.height > 90;
    for (int i = 0; i < (level ? SIDE * SIDE : 1); i++) {
        double height = level ? asin(sqrt((i / SIDE + 0.5) / SIDE)) : view.height * pi / 180;
        Vec3 direction = towards(height, level ? 2 * pi * (i % SIDE + 0.5) / SIDE : view.azimuth * pi / 180);
        sum += (double)lanes_get(environment_radiance(sky, vec3f_from(direction), lanes_all((float)nm)), 0);
    }
    return level ? sum * pi / (SIDE * SIDE) : sum;
}

/* Of one day: single views to a tolerance and three standard errors, and their mean, weighted by how well it is known. */
static void one_day(double elevation, double turbidity, double of_view, double of_mean, Pool *pool)
{
    const char *more = getenv("MENISCUS_SKY_WALKS");
    Day day = {.elevation = elevation, .turbidity = turbidity, .walks = more ? (unsigned)atoi(more) : 200};
    pool_run(pool, COLORS * VIEWS, walk_of_day, &day);
    Spectrum ground = spectrum_constant((float)ground_albedo);
    SkyModel model = {elevation * pi / 180, turbidity, &ground, 1, pool};
    float sun[SPECTRUM_SAMPLES], table[SPECTRUM_SAMPLES];
    Environment *sky;
    Error error;
    assert_int_equal(sky_new(&model, &sky, sun, &error), STATUS_OK);
    Spectrum above = spectrum_blackbody(5778, table);
    double sum = 0, weights = 0;
    bool right = true;
    for (int color = 0; color < COLORS; color++) {
        double nm = nm_of(color), unit = (double)spectrum_at_one(&above, (float)nm) * 1.333 * pi;
        print_message("  sun at %3.0f degrees, turbidity %.1f, %.0f nm:", elevation, turbidity, nm);
        for (size_t v = 0; v < VIEWS; v++) {
            Estimate truth = day.truth[color][v];
            double off = of_sky(sky, views[v], nm) / (unit * truth.mean) - 1, doubt = truth.error / truth.mean;
            print_message(" %+5.1f+-%3.1f", 100 * off, 100 * doubt);
            right = right && fabs(off) < of_view + 3 * doubt;
            double weight = 1 / (doubt * doubt + 1e-4);
            sum += weight * off;
            weights += weight;
        }
        print_message("\n");
    }
    print_message("  in the mean %+.1f %%\n", 100 * sum / weights);
    environment_free(sky);
    assert_true(right && fabs(sum / weights) < of_mean);
}

static void skies(void **state)
{
    (void)state;
    static const struct {
        double elevation, turbidity, of_view, of_mean;
    } days[] = {{20, 1, 0.03, 0.02},  {20, 4, 0.15, 0.05},  {10, 4, 0.15, 0.05},  {6, 2.2, 0.08, 0.03},
                {3, 2.2, 0.08, 0.04}, {1, 2.2, 0.08, 0.04}, {-2, 2.2, 0.1, 0.05}, {-4, 1, 0.1, 0.06}};
    Pool *pool = NULL;
    Error error;
    if (pool_new(0, &pool, &error) != STATUS_OK) fail_msg("%s", error.text);
    print_message("  sky over walks, %% of difference, by height and azimuth from the sun:");
    for (size_t v = 0; v + 1 < VIEWS; v++) print_message(" (%.0f,%.0f)", views[v].height, views[v].azimuth);
    print_message("; on level ground\n");
    for (size_t d = 0; d < COUNT_OF(days); d++)
        one_day(days[d].elevation, days[d].turbidity, days[d].of_view, days[d].of_mean, pool);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(skies)};
    return cmocka_run_group_tests_name("sky", tests, NULL, NULL);
}

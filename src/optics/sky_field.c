/* sky_field.c - see sky_field.h.
 *
 * Directions are those from which light comes. They are given in the frame of a place: the angle from the vertical, and the
 * azimuth from the sun's, on either side of which all is the same.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/sky_field.h"

#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/lanes.h"

enum {
    BANDS = AIR_BANDS,
    HEIGHTS = 16,
    SUNS = 22,
    FEW_SUNS = 10, /* at day */
    PLACES = HEIGHTS * SUNS,
    POLAR = 12, /* cells of directions to gather light from, by Gauss's rule, below the horizon and above it; ... */
    AZIMUTHS = 8,
    GATHERED = POLAR * AZIMUTHS,
    UP_DOWN = 17, /* ... and evenly spread directions to look up at what is scattered into them */
    AROUND = 11,
    LOOKED_UP = UP_DOWN * AROUND,
    MOST_ORDERS = 60,
    MOST_STEPS = 128, /* of a line: twice what the longest one takes */
    PARTS = 4         /* of a cell, along each side, to take means over */
};

static const double reach = 12;           /* of the suns, to both sides, in degrees */
static const double dusk = 85, dark = 98; /* degrees from the vertical between which suns stand closer, ... */
static const double closer = 4;           /* ... so many times as close */
static const double enough = 0.02;        /* as precisely as the sum of all orders is to be known */
/* Of what a line gathers, steps are so long in relation to what the air changes over. */
static const double coarse = 0.8, fine = 0.3;

/* What air scatters from all around into each of the LOOKED_UP directions, over its scattering coefficient. */
typedef struct Scattered {
    float radiance[PLACES][LOOKED_UP][BANDS];
} Scattered;

/* Neighbours on an even grid. */
typedef struct Between {
    int low;
    float part;
} Between;

/* What is the same for any sun and any azimuth along a straight line. */
typedef struct LineStep {
    double at, radius;     /* along it, and from the middle of the earth */
    Between height, polar; /* where to look up what is scattered there */
    float molecules[BANDS],
        aerosol[BANDS]; /* of light there, what they send along the line, over their phase functions */
} LineStep;

typedef struct Line {
    double radius, cosine, length; /* where it begins, against the vertical */
    bool ground;                   /* it ends there, */
    float through[BANDS];          /* and so much of it is seen */
    int n;
    LineStep steps[MOST_STEPS];
} Line;

struct SkyField {
    const Air *air;
    float ground[BANDS]; /* albedo */
    int n_suns;
    double suns_first, suns_step; /* warped angles from the vertical */
    Scattered all, last;
    float level[SUNS][BANDS];                /* the last order's irradiance of the ground */
    float gathered[PLACES][GATHERED][BANDS]; /* and its radiance */
    Line lines[HEIGHTS][POLAR];              /* along which it is gathered */
    /* Phase functions, of light from cells, times their solid angle. */
    float of_molecules[LOOKED_UP][GATHERED], of_aerosol[LOOKED_UP][GATHERED];
};

/* ---- directions ---- */

/* Gauss's rule from 0 to 1: cosines of the angles from the vertical, and the cells that they stand for. */
static const double gauss_cosines[] = {0.0337652428984240, 0.1693953067668677, 0.3806904069584015,
                                       0.6193095930415985, 0.8306046932331323, 0.9662347571015760};
static const double gauss_ends[] = {
    0, 0.0856622461895852, 0.2660430327586544, 0.5, 0.7339569672413456, 0.9143377538104148, 1};

static double cell_cosine(int polar)
{
    return polar < POLAR / 2 ? -gauss_cosines[polar] : gauss_cosines[polar - POLAR / 2];
}

/* On both sides of the sun. */
static double cell_solid_angle(int polar)
{
    int i = polar % (POLAR / 2);
    return (gauss_ends[i + 1] - gauss_ends[i]) * 2 * MEN_PI / AZIMUTHS;
}

static Vec3 direction_at(double cosine, double azimuth)
{
    double sine = sqrt(fmax(1 - cosine * cosine, 0));
    return vec3(sine * sin(azimuth), cosine, sine * cos(azimuth));
}

static float rayleigh_phase(float cosine)
{
    return 3 / (16 * (float)MEN_PI) * (1 + cosine * cosine);
}

static float aerosol_phase(float cosine)
{
    float g = (float)air_aerosol_g, base = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) / (4 * (float)MEN_PI * base * sqrtf(base));
}

/* Means over a cell, on both sides. */
typedef struct Phases {
    float molecules, aerosol;
} Phases;

static Phases phases_of_cell(int cell, Vec3 direction)
{
    Phases sum = {0, 0};
    int polar = cell / AZIMUTHS, azimuth = cell % AZIMUTHS, i = polar % (POLAR / 2);
    for (int p = 0; p < PARTS; p++)
        for (int a = 0; a < 2 * PARTS; a++) {
            double cosine = gauss_ends[i] + (gauss_ends[i + 1] - gauss_ends[i]) * (p + 0.5) / PARTS;
            double turn = MEN_PI / AZIMUTHS * (azimuth + (a / 2 + 0.5) / PARTS);
            Vec3 part = direction_at(polar < POLAR / 2 ? -cosine : cosine, a % 2 ? turn : -turn);
            float toward = (float)vec3_dot(direction, part);
            sum.molecules += rayleigh_phase(toward) / (2 * PARTS * PARTS);
            sum.aerosol += aerosol_phase(toward) / (2 * PARTS * PARTS);
        }
    return sum;
}

static void prepare_phases(SkyField *field)
{
    for (int i = 0; i < LOOKED_UP; i++) {
        Vec3 direction = direction_at(cos(MEN_PI * (i / AROUND) / (UP_DOWN - 1)), MEN_PI * (i % AROUND) / (AROUND - 1));
        float molecules = 0, aerosol = 0;
        for (int cell = 0; cell < GATHERED; cell++) {
            Phases phases = phases_of_cell(cell, direction);
            float solid_angle = (float)cell_solid_angle(cell / AZIMUTHS);
            molecules += field->of_molecules[i][cell] = phases.molecules * solid_angle;
            aerosol += field->of_aerosol[i][cell] = phases.aerosol * solid_angle;
        }
        for (int cell = 0; cell < GATHERED; cell++) { /* no light is lost to parts that are too large */
            field->of_molecules[i][cell] /= molecules;
            field->of_aerosol[i][cell] /= aerosol;
        }
    }
}

/* ---- places ---- */

static double height_of(int h)
{
    double part = (double)h / (HEIGHTS - 1);
    return part * part * part * (air_top - air_ground);
}

/* Angles of the sun from the vertical, in degrees, stretched where light falls off fast. */
static double warped(double angle)
{
    return angle + (closer - 1) * (fmin(fmax(angle, dusk), dark) - dusk);
}

static double unwarped(double value)
{
    double behind = (dark - dusk) * closer;
    return value < dusk ? value : value < dusk + behind ? dusk + (value - dusk) / closer : value - behind + dark - dusk;
}

static double zenith_of(const SkyField *field, int sun)
{
    return unwarped(field->suns_first + sun * field->suns_step) * MEN_DEGREE;
}

static Between between(double at, int n)
{
    int low = at > 0 ? (int)fmin(at, n - 2) : 0;
    return (Between){low, (float)fmin(fmax(at - low, 0), 1)};
}

static Between between_suns(const SkyField *field, double sun_cosine)
{
    double angle = acos(fmin(fmax(sun_cosine, -1), 1)) / MEN_DEGREE;
    return between((warped(angle) - field->suns_first) / field->suns_step, field->n_suns);
}

/* toward: the cosine of the angle between the line and the sun. */
static void look_up(const SkyField *field, const Scattered *scattered, const LineStep *step, double cosine,
                    double sun_cosine, double toward, Lanes values[BANDS / LANES])
{
    double sines = sqrt(fmax((1 - cosine * cosine) * (1 - sun_cosine * sun_cosine), 1e-12));
    double azimuth = acos(fmin(fmax((toward - cosine * sun_cosine) / sines, -1), 1));
    Between sun = between_suns(field, sun_cosine), around = between(azimuth / MEN_PI * (AROUND - 1), AROUND);
    for (int k = 0; k < BANDS / LANES; k++) values[k] = lanes_all(0);
    for (int corner = 0; corner < 8; corner++) {
        int h = corner & 1, s = corner >> 1 & 1, p = corner >> 2;
        float weight = (h ? step->height.part : 1 - step->height.part) * (s ? sun.part : 1 - sun.part) *
                       (p ? step->polar.part : 1 - step->polar.part);
        const float(*there)[BANDS] =
            &scattered
                 ->radiance[(step->height.low + h) * SUNS + sun.low + s][(step->polar.low + p) * AROUND + around.low];
        Lanes first = lanes_all(weight * (1 - around.part)), second = lanes_all(weight * around.part);
        for (int k = 0; k < BANDS / LANES; k++) {
            Lanes sum = lanes_mul(first, lanes_load(there[0] + k * LANES));
            values[k] = lanes_add(values[k], lanes_add(sum, lanes_mul(second, lanes_load(there[1] + k * LANES))));
        }
    }
}

static void level_at(const SkyField *field, double sun_cosine, float values[BANDS])
{
    Between sun = between_suns(field, sun_cosine);
    for (int k = 0; k < BANDS; k++)
        values[k] = (1 - sun.part) * field->level[sun.low][k] + sun.part * field->level[sun.low + 1][k];
}

/* ---- lines ---- */

/* What a line gathers: light that is scattered once; light that was scattered before; both, of all orders. */
typedef enum Gather { FIRST, FURTHER, ALL } Gather;

/* exp for what is not above 0, to 3e-6 of it, and 2^-120 for less; a loop of it runs in lanes. */
static inline float exp_falling(float x)
{
    float scaled = fmaxf(x * 1.44269504f, -120);
    int32_t whole = (int32_t)(scaled - 1);
    float power = (scaled - (float)whole - 0.5f) * 0.69314718f; /* up to half of log 2, either way */
    float value =
        1 + power * (1 + power * (0.5f + power * (0.16666667f + power * (0.041666667f + power * 0.0083333f))));
    union {
        int32_t bits;
        float value;
    } scale = {(whole + 127) * (1 << 23)};
    return 1.41421356f * value * scale.value;
}

static void sunlight(const SkyField *field, double radius, double sun_cosine, float values[BANDS])
{
    Columns up;
    if (!air_columns(field->air, radius, sun_cosine, &up)) {
        memset(values, 0, BANDS * sizeof *values);
        return;
    }
    for (int k = 0; k < BANDS; k++)
        values[k] = exp_falling(-(field->air->rayleigh[k] * up.rayleigh + field->air->aerosol[k] * up.aerosol +
                                  field->air->ozone[k] * up.ozone));
}

static double step_at(double height, double cosine, double precision)
{
    double scale = fmin(1.2 + 0.3 * fmax(height, 0), 10);
    return precision * scale / sqrt(cosine * cosine + 2 * scale / air_ground);
}

static void add_ground(const SkyField *field, Gather gather, double sun_cosine, const float through[BANDS],
                       float radiance[BANDS])
{
    float light[BANDS];
    if (gather == FIRST && sun_cosine > 0) {
        sunlight(field, air_ground, sun_cosine, light);
        for (int k = 0; k < BANDS; k++) light[k] *= (float)sun_cosine;
    } else if (gather == FURTHER) {
        level_at(field, sun_cosine, light);
    } else {
        return;
    }
    for (int k = 0; k < BANDS; k++) radiance[k] += through[k] * light[k] * field->ground[k] / (float)MEN_PI;
}

static void make_line(const Air *air, double radius, double cosine, double precision, Line *line)
{
    const float whole = (float)air_aerosol_albedo;
    double along = radius * cosine, height = radius - air_ground;
    *line = (Line){.radius = radius, .cosine = cosine};
    line->ground = air_line(radius, cosine, &line->length);
    for (int k = 0; k < BANDS; k++) line->through[k] = 1;
    for (double at = 0; at < line->length; line->n++) {
        double length = fmin(step_at(height, cosine, precision), line->length - at), middle = at + 0.5 * length;
        if (line->n == MOST_STEPS - 1) length = line->length - at;
        double here = sqrt(radius * radius + middle * middle + 2 * middle * along);
        Columns density = air_density(here - air_ground);
        LineStep *step = &line->steps[line->n];
        step->at = middle;
        step->radius = here;
        step->height = between(cbrt(fmax(here - air_ground, 0) / (air_top - air_ground)) * (HEIGHTS - 1), HEIGHTS);
        double polar = acos(fmin(fmax((along + middle) / here, -1), 1));
        step->polar = between(polar / MEN_PI * (UP_DOWN - 1), UP_DOWN);
        for (int k = 0; k < BANDS; k++) {
            float molecules = air->rayleigh[k] * density.rayleigh, aerosol = air->aerosol[k] * density.aerosol;
            float extinction = molecules + aerosol + air->ozone[k] * density.ozone + 1e-12f;
            float kept = exp_falling(-extinction * (float)length);
            float reaches = line->through[k] * ((1 - kept) / extinction);
            step->molecules[k] = molecules * reaches;
            step->aerosol[k] = whole * aerosol * reaches;
            line->through[k] *= kept;
        }
        at += length;
        height = sqrt(radius * radius + at * at + 2 * at * along) - air_ground;
        cosine = (along + at) / (height + air_ground);
    }
}

/* What arrives along a line. sun_cosine: the sun's against the vertical at its beginning; toward: against the line; phases:
 * of the sun's light. */
static void gather_along(const SkyField *field, Gather gather, const Line *line, double sun_cosine, double toward,
                         Phases phases, float radiance[BANDS])
{
    const Scattered *scattered = gather == ALL ? &field->all : &field->last;
    float light[BANDS];
    memset(radiance, 0, BANDS * sizeof *radiance);
    for (int i = 0; i < line->n; i++) {
        const LineStep *step = &line->steps[i];
        double sun = (line->radius * sun_cosine + step->at * toward) / step->radius;
        if (gather != FURTHER) {
            sunlight(field, step->radius, sun, light);
            for (int k = 0; k < BANDS; k++)
                radiance[k] += (step->molecules[k] * phases.molecules + step->aerosol[k] * phases.aerosol) * light[k];
        }
        if (gather == FIRST) continue;
        Lanes again[BANDS / LANES];
        look_up(field, scattered, step, (line->radius * line->cosine + step->at) / step->radius, sun, toward, again);
        for (int k = 0; k < BANDS; k += LANES) {
            Lanes part = lanes_add(lanes_load(step->molecules + k), lanes_load(step->aerosol + k));
            lanes_store(lanes_add(lanes_load(radiance + k), lanes_mul(part, again[k / LANES])), radiance + k);
        }
    }
    double end = sqrt(line->radius * line->radius + line->length * line->length +
                      2 * line->length * line->radius * line->cosine);
    if (line->ground)
        add_ground(field, gather, (line->radius * sun_cosine + line->length * toward) / end, line->through, radiance);
}

/* ---- orders ---- */

static void prepare_lines(SkyField *field)
{
    for (int h = 0; h < HEIGHTS; h++)
        for (int polar = 0; polar < POLAR; polar++)
            make_line(field->air, air_ground + fmin(fmax(height_of(h), 1e-3), air_top - air_ground - 1e-3),
                      cell_cosine(polar), coarse, &field->lines[h][polar]);
}

typedef struct Order {
    SkyField *field;
    Gather gather;
} Order;

static void gather_place(void *context, uint32_t place, unsigned worker)
{
    (void)worker;
    Order *order = context;
    SkyField *field = order->field;
    if ((int)place % SUNS >= field->n_suns) return;
    Vec3 sun = direction_at(cos(zenith_of(field, (int)place % SUNS)), 0);
    for (int cell = 0; cell < GATHERED; cell++) {
        const Line *line = &field->lines[place / SUNS][cell / AZIMUTHS];
        Vec3 direction = direction_at(line->cosine, MEN_PI * (cell % AZIMUTHS + 0.5) / AZIMUTHS);
        Phases phases = order->gather == FIRST ? phases_of_cell(cell, sun) : (Phases){0, 0};
        gather_along(field, order->gather, line, sun.y, vec3_dot(direction, sun), phases, field->gathered[place][cell]);
    }
}

/* What the light around a place is scattered to. */
static void scatter_place(void *context, uint32_t place, unsigned worker)
{
    (void)worker;
    Order *order = context;
    SkyField *field = order->field;
    if ((int)place % SUNS >= field->n_suns) return;
    Columns density = air_density(height_of((int)place / SUNS));
    float part[BANDS]; /* by aerosol */
    for (int k = 0; k < BANDS; k++) {
        float molecules = field->air->rayleigh[k] * density.rayleigh;
        float aerosol = (float)air_aerosol_albedo * field->air->aerosol[k] * density.aerosol;
        part[k] = aerosol / (molecules + aerosol + 1e-30f);
    }
    for (int i = 0; i < LOOKED_UP; i++) {
        Lanes molecules[BANDS / LANES], aerosol[BANDS / LANES];
        for (int k = 0; k < BANDS / LANES; k++) molecules[k] = aerosol[k] = lanes_all(0);
        for (int cell = 0; cell < GATHERED; cell++) {
            const float *light = field->gathered[place][cell];
            Lanes to_molecules = lanes_all(field->of_molecules[i][cell]),
                  to_aerosol = lanes_all(field->of_aerosol[i][cell]);
            for (int k = 0; k < BANDS / LANES; k++) {
                Lanes band = lanes_load(light + k * LANES);
                molecules[k] = lanes_add(molecules[k], lanes_mul(to_molecules, band));
                aerosol[k] = lanes_add(aerosol[k], lanes_mul(to_aerosol, band));
            }
        }
        for (int k = 0; k < BANDS / LANES; k++) {
            Lanes more = lanes_mul(lanes_load(part + k * LANES), lanes_sub(aerosol[k], molecules[k]));
            lanes_store(lanes_add(molecules[k], more), field->last.radiance[place][i] + k * LANES);
        }
    }
}

static void light_ground(SkyField *field)
{
    memset(field->level, 0, sizeof field->level);
    for (int sun = 0; sun < SUNS; sun++)
        for (int cell = GATHERED / 2; cell < GATHERED; cell++) {
            int polar = cell / AZIMUTHS;
            float projected = (float)(cell_solid_angle(polar) * cell_cosine(polar));
            for (int k = 0; k < BANDS; k++) field->level[sun][k] += projected * field->gathered[sun][cell][k];
        }
}

/* Of all places and bands: the sums of an order over all directions, and their parts of the order before. */
typedef struct Fall {
    float sum[PLACES][BANDS], ratio[PLACES][BANDS];
} Fall;

/* Notes how the last order falls; returns how much of all light the further ones may be mistaken by, if they fall on in the
 * same way: by how much the ratio has changed. */
static double note_fall(const SkyField *field, Fall *fall)
{
    double doubt = 0;
    for (int place = 0; place < PLACES; place++)
        for (int k = 0; k < BANDS; k++) {
            float sum = 0, all = 1e-30f, was = fall->ratio[place][k];
            for (int i = 0; i < LOOKED_UP; i++) {
                sum += field->last.radiance[place][i][k];
                all += field->all.radiance[place][i][k];
            }
            float ratio = fminf(sum / (fall->sum[place][k] + 1e-30f), 0.98f);
            float tail = sum * ratio / (1 - ratio), then = sum * was / (1 - was);
            double change = (double)(fabsf(tail - then) / (all + sum + tail));
            if (change > doubt) doubt = change; /* gcc 12 for arm64 fails on fmax here */
            fall->sum[place][k] = sum;
            fall->ratio[place][k] = ratio;
        }
    return doubt;
}

/* Adds the last order, and with it the sum of all further ones, if they are to be known. */
static void add_order(SkyField *field, const Fall *fall, bool further)
{
    for (int place = 0; place < PLACES; place++)
        for (int i = 0; i < LOOKED_UP; i++)
            for (int k = 0; k < BANDS; k++)
                field->all.radiance[place][i][k] +=
                    field->last.radiance[place][i][k] / (further ? 1 - fall->ratio[place][k] : 1);
}

static void follow_orders(SkyField *field, Fall *fall, Pool *pool)
{
    Order order = {field, FIRST};
    for (int n = 1; n <= MOST_ORDERS; n++) {
        pool_run(pool, PLACES, gather_place, &order);
        light_ground(field);
        pool_run(pool, PLACES, scatter_place, &order);
        bool known = note_fall(field, fall) < enough || n == MOST_ORDERS;
        add_order(field, fall, known && n > 2);
        if (known && n > 2) break;
        order.gather = FURTHER;
    }
}

Status sky_field_new(const Air *air, const float ground[AIR_BANDS], double elevation_rad, Pool *pool, SkyField **result,
                     Error *error)
{
    SkyField *field = calloc(1, sizeof *field);
    Fall *fall = calloc(1, sizeof *fall);
    *result = NULL;
    if (!field || !fall) {
        free(field);
        free(fall);
        return fail_memory(error, sizeof *field + sizeof *fall, "a sky");
    }
    field->air = air;
    memcpy(field->ground, ground, sizeof field->ground);
    double zenith = 90 - elevation_rad / MEN_DEGREE;
    field->suns_first = warped(fmax(zenith - reach, 0));
    field->n_suns = zenith + reach < dusk ? FEW_SUNS : SUNS;
    field->suns_step = (warped(zenith + reach) - field->suns_first) / (field->n_suns - 1);
    prepare_phases(field);
    prepare_lines(field);
    follow_orders(field, fall, pool);
    free(fall);
    *result = field;
    return STATUS_OK;
}

void sky_field_free(SkyField *field)
{
    free(field);
}

void sky_field_radiance(const SkyField *field, double height, double cosine, Vec3 sun, const Vec3 *directions, size_t n,
                        float *radiance)
{
    Line line;
    make_line(field->air, air_ground + height, cosine, fine, &line);
    for (size_t i = 0; i < n; i++) {
        double toward = vec3_dot(directions[i], sun);
        Phases phases = {rayleigh_phase((float)toward), aerosol_phase((float)toward)};
        gather_along(field, ALL, &line, sun.y, toward, phases, radiance + i * BANDS);
    }
}

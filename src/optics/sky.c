/* sky.c - see sky.h. Lengths are in kilometres.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/sky.h"

#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "optics/sky_field.h"

/* The horizon is in the middle of the middle row, which is of the sky. */
enum { BANDS = AIR_BANDS, WIDTH = 256, HEIGHT = 127, FIRST_LAND = HEIGHT / 2 + 1 /* row */ };

static const double eye_height = 1e-3;

typedef struct Sky {
    Air air;
    SkyField *field;
    Vec3 sun;
    float *values; /* the picture */
} Sky;

/* The sky above, whose halves mirror each other. */
static void fill_row(void *context, uint32_t row, unsigned worker)
{
    (void)worker;
    const Sky *sky = context;
    float *values = sky->values + (size_t)row * WIDTH * BANDS;
    double polar = MEN_PI * (row + 0.5) / HEIGHT;
    Vec3 directions[WIDTH / 2];
    for (unsigned column = 0; column < WIDTH / 2; column++)
        directions[column] = environment_pixel_direction(WIDTH, HEIGHT, column, row);
    sky_field_radiance(sky->field, eye_height, cos(polar), sky->sun, directions, WIDTH / 2, values);
    for (int column = 0; column < WIDTH / 2; column++)
        memcpy(values + (WIDTH - 1 - column) * BANDS, values + column * BANDS, BANDS * sizeof *values);
}

/* What falls from the sky on level ground. */
static void sum_upper(const float *values, double level[BANDS])
{
    for (int row = 0; row < FIRST_LAND; row++) {
        double low = cos(MEN_PI * row / HEIGHT), high = fmax(cos(MEN_PI * (row + 1) / HEIGHT), 0);
        double projected = 0.5 * (low * low - high * high) * 2 * MEN_PI / WIDTH; /* cosine times solid angle */
        for (int i = 0; i < WIDTH * BANDS; i++)
            level[i % BANDS] += projected * (double)values[(size_t)row * WIDTH * BANDS + (size_t)i];
    }
}

/* What is below the horizon. */
static void fill_lower(const float ground[BANDS], float *values, const double level[BANDS])
{
    for (size_t i = (size_t)FIRST_LAND * WIDTH; i < (size_t)WIDTH * HEIGHT; i++)
        for (int k = 0; k < BANDS; k++) values[i * BANDS + (size_t)k] = ground[k] * (float)(level[k] / MEN_PI);
}

/* All of it, per irradiance of the sun above the air. */
static Status fill_picture(Sky *sky, const SkyModel *model, Error *error)
{
    float ground[BANDS];
    double level[BANDS] = {0}, sine = sin(model->elevation);
    for (int k = 0; k < BANDS; k++) ground[k] = spectrum_at_one(model->ground, (float)air_band_nm(k));
    sky->sun = vec3(0, sine, cos(model->elevation));
    air_init(&sky->air, model->turbidity);
    TRY(sky_field_new(&sky->air, ground, model->elevation, model->pool, &sky->field, error));
    pool_run(model->pool, FIRST_LAND, fill_row, sky);
    sum_upper(sky->values, level);
    for (int k = 0; k < BANDS && sine > 0; k++)
        level[k] += sine * air_sun_transmittance(model->turbidity, model->elevation, air_band_nm(k));
    fill_lower(ground, sky->values, level);
    return STATUS_OK;
}

Status sky_new(const SkyModel *model, Environment **environment, float sun[SPECTRUM_SAMPLES], Error *error)
{
    const double illuminance = 133.3 / 100 * MEN_PI; /* above the air, 100 klx counting as pi */
    Sky *sky = calloc(1, sizeof *sky);
    float *values = malloc((size_t)WIDTH * HEIGHT * BANDS * sizeof *values);
    Status status =
        sky && values ? STATUS_OK : fail_memory(error, (size_t)WIDTH * HEIGHT * BANDS * sizeof *values, "a sky");
    if (status == STATUS_OK) {
        sky->values = values;
        status = fill_picture(sky, model, error);
    }
    if (status == STATUS_OK) {
        Spectrum above = spectrum_blackbody(5778, sun);
        double scale = model->strength * illuminance / spectrum_luminance(&above);
        for (int i = 0; i < SPECTRUM_SAMPLES; i++) sun[i] = (float)(scale * (double)sun[i]);
        status = environment_new_bands(values, WIDTH, HEIGHT, sun, model->pool, environment, error);
        for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
            double nm = (double)SPECTRUM_MIN_NM + i * SPECTRUM_STEP_NM;
            sun[i] *= (float)(model->elevation > 0 ? air_sun_transmittance(model->turbidity, model->elevation, nm) : 0);
        }
    }
    if (sky) sky_field_free(sky->field);
    free(sky);
    free(values);
    return status;
}

Status sky_new_overcast(const SkyModel *model, Environment **environment, Error *error)
{
    /* of level ground, 100 klx counting as pi; the gradient's mean under the cosine is 7/9 of the zenith's */
    const double level = (0.3 + 21 * sin(model->elevation)) / 100 * MEN_PI * model->strength,
                 zenith = level / MEN_PI * 9 / 7;
    float *values = malloc((size_t)WIDTH * HEIGHT * BANDS * sizeof *values), white[SPECTRUM_SAMPLES], ground[BANDS];
    if (!values) return fail_memory(error, (size_t)WIDTH * HEIGHT * BANDS * sizeof *values, "a sky");
    for (int i = 0; i < SPECTRUM_SAMPLES; i++)
        white[i] = lanes_get(white_at(lanes_all(SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM))), 0);
    for (int k = 0; k < BANDS; k++)
        ground[k] = (float)(level / MEN_PI) * spectrum_at_one(model->ground, (float)air_band_nm(k));
    for (int row = 0; row < HEIGHT; row++) {
        float radiance = (float)(zenith * (1 + 2 * fmax(cos(MEN_PI * (row + 0.5) / HEIGHT), 0)) / 3);
        for (int i = 0; i < WIDTH * BANDS; i++)
            values[(size_t)row * WIDTH * BANDS + (size_t)i] = row < FIRST_LAND ? radiance : ground[i % BANDS];
    }
    Status status = environment_new_bands(values, WIDTH, HEIGHT, white, model->pool, environment, error);
    free(values);
    return status;
}

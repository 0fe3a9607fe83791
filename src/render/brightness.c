/* brightness.c - see brightness.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/brightness.h"

#include <math.h>

#include "base/luminance.h"

void brightness_note(Brightness *brightness, double luminance)
{
    double band = luminance > 0 ? floor(BRIGHTNESS_BANDS_OF_STOP * (log2(luminance) + BRIGHTNESS_STOPS)) : 0;
    brightness->n_of[(size_t)fmin(fmax(band, 0), BRIGHTNESS_BANDS - 1)]++;
    brightness->mean += (luminance - brightness->mean) / (double)++brightness->n;
}

Brightness brightness_find(const Image *image, double stops)
{
    Brightness brightness = {0};
    double factor = exp2(stops);
    int channels[3], alpha = image_channel(image, "A");
    if (!image_rgb(image, channels)) return brightness;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        const float *pixel = &image->pixels[i * image->n_channels];
        const float rgb[3] = {pixel[channels[0]], pixel[channels[1]], pixel[channels[2]]};
        float luminance = color_luminance(rgb);
        if (isfinite(luminance) && !(alpha >= 0 && pixel[alpha] == 0))
            brightness_note(&brightness, factor * (double)luminance);
    }
    return brightness;
}

/* The stops above a luminance of 1 at which a band begins. */
static double stops_of(int band)
{
    return (double)band / BRIGHTNESS_BANDS_OF_STOP - BRIGHTNESS_STOPS;
}

static int band_at(const Brightness *brightness, double part)
{
    size_t below = 0;
    int band = 0;
    while (band + 1 < BRIGHTNESS_BANDS && (double)(below += brightness->n_of[band]) <= part * (double)brightness->n)
        band++;
    return band;
}

double brightness_at(const Brightness *brightness, double part)
{
    return exp2(stops_of(band_at(brightness, part)));
}

/* The part of the pixels in the bands from one to before another. */
static double part_in(const Brightness *brightness, int from, int to)
{
    size_t n = 0;
    for (int band = from > 0 ? from : 0; band < to; band++) n += brightness->n_of[band];
    return (double)n / (double)brightness->n;
}

double brightness_stops(const Brightness *brightness)
{
    enum { DARK = 5, RANGE = 14 }; /* stops below white; and below the highlights, where nothing is seen */
    const double white = 0.02, worth = 0.15;
    int high = brightness->n ? band_at(brightness, 1 - white) : 0;
    if (high == 0) return 0;
    const int lowest = high - RANGE * BRIGHTNESS_BANDS_OF_STOP;
    int limit = high + 1; /* the first band that is white */
    while (worth * part_in(brightness, lowest > 1 ? lowest : 1, limit - DARK * BRIGHTNESS_BANDS_OF_STOP) >
           part_in(brightness, limit - 1, BRIGHTNESS_BANDS))
        limit--;
    return -stops_of(limit);
}

double brightness_white(const Brightness *brightness, Exposure exposure)
{
    return exp2(-exposure.stops - (exposure.automatic ? brightness_stops(brightness) : 0));
}

/* truth.h - what the tests against closed forms share: a scene from text, pictures of it, estimates with an honest
 * standard error, and one form of line for every figure.
 *
 * A pixel's own samples are stratified, so that the spread among them says too much about the error of their mean
 * (the channel variance.Y gives an upper bound). Where all pixels have the same expectation, the spread from pixel to
 * pixel says more, and it is what truth_mean uses: neighbours err in opposite directions on purpose, so that it is an
 * upper bound, too, but a close one for all that takes more than a few random numbers.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TRUTH_H
#define MEN_TRUTH_H

#include "test.h"

#include <math.h>

#include "near.h"
#include "render/render.h"
#include "scene_fixture.h"

#define TRUTH_PI 3.14159265358979323846

/* A mean and the standard error of it. */
typedef struct Estimate {
    double mean, error;
} Estimate;

typedef struct Picture {
    Image image;
    RenderStats stats;
} Picture;

/* Where a scene comes from, and what is done to it. */
typedef struct TruthInput {
    const char *text, *file;             /* one of the two */
    const char *const *defines;          /* "name=expression", ended by NULL; or NULL */
    double (*sky)(double elevation_rad); /* radiance of every image = that the scene asks for; NULL: 1 */
    NestPolicy policy;
    bool furnace; /* take away all that is opaque or shines, put a sky of radiance 1 around the rest */
} TruthInput;

/* An image that is surely there to be asked for; what it shows is the input's sky. */
#define TRUTH_SKY " environment { image = \"" __FILE__ "\" } "
#define TRUTH_WHITE_SKY " environment { color = 1 } "

/* Builds and compiles a scene, which must be right. */
void truth_open(Fixture *scene, TruthInput input);
/* The same scene with the input's policy. */
void truth_compile_again(Fixture *scene, const TruthInput *input);

/* Whether a file only defines things for others to use: all that it lacks is a camera. */
bool truth_is_library(const char *file);

/* Square pictures with enough bounces for any path to end by itself; change what is to be otherwise. */
RenderSettings truth_settings(uint32_t width, uint32_t samples);
/* threads 0: one per processor. No sample may be lost: neither bad, nor saturated, nor given up. */
void truth_render(const Fixture *scene, const RenderSettings *settings, unsigned threads, Picture *picture);
/* The largest difference of a furnace's pixels from those of the white sky alone, rendered the same way. */
double truth_difference_from_empty(const RenderSettings *settings, const Picture *picture);
void truth_clear(Picture *picture);

/* Of one pixel: luminance, channel (0 red .. 2 blue), and the standard error by the film (an upper bound). */
double truth_luminance(const Picture *picture, uint32_t x, uint32_t y);
double truth_channel(const Picture *picture, uint32_t x, uint32_t y, int channel);
double truth_film_error(const Picture *picture, uint32_t x, uint32_t y);

/* The largest difference between the luminances of two pictures' pixels. */
double truth_largest_difference(const Picture *a, const Picture *b);

/* Mean of n values and its standard error by their spread. */
Estimate truth_estimate(const double *values, size_t n);
/* Mean over all pixels of a picture that has the same expectation everywhere; channel -1: luminance. */
Estimate truth_mean(const Picture *picture, int channel);

/* Sum over all pixels, whatever they show, with the film's own errors: an upper bound. */
Estimate truth_total(const Picture *picture);

/* One figure as a line; error 0: it has none. */
void truth_figure(const char *what, double expected, double measured, double error);
/* Fails beyond `sigmas` standard errors, or when the standard error is above `resolution` times the expected value: an
 * estimate too noisy to see a mistake proves nothing. The rounding of float (1e-6) is always granted. */
void truth_check(const char *what, double expected, Estimate measured, double sigmas, double resolution);
/* Both. */
void truth_expect(const char *what, double expected, Estimate measured, double sigmas, double resolution);
/* The same of two estimates that are independent of each other. */
void truth_alike(const char *what, Estimate expected, Estimate measured, double sigmas, double resolution);
/* Looked for and by chance there is the same light, whatever that is. */
void truth_found_alike(const char *what, const char *text, uint32_t chance, double resolution);
/* a / b of such ones, with the error that follows. */
Estimate truth_ratio(Estimate a, Estimate b);

/* Crossings of all renders so far, for the faults per million. */
typedef struct FaultCount {
    uint64_t crossings, silent, faults;
} FaultCount;
void truth_count(FaultCount *count, const RenderStats *stats);
void truth_add(FaultCount *sum, const FaultCount *more);
void truth_print_faults(const char *what, const FaultCount *count);

/* Unpolarized Fresnel reflectance of a smooth boundary, cosine of incidence against the normal, in double and
 * independent of the renderer's: Born and Wolf, Principles of Optics, section 1.5.2. */
double truth_fresnel(double cosine, double ior_from, double ior_to);
/* What a clear pane lets through: of each polarization the sum over all its reflections within. */
double truth_pane(double cosine, double ior);

/* A bright sky above a dim one, by the elevation. */
double truth_two_skies(double elevation);
/* The text under two skies, with as many bounces as it takes; its nesting must be without faults. */
Picture truth_render_text(const char *text, uint32_t width, uint32_t samples);
/* A picture of the text, which is to be 1 everywhere, within tolerance and three standard errors of the mean; that. */
double truth_white(const char *what, const char *text, uint32_t width, uint32_t samples, double tolerance);
/* The pattern with value in place of its "%s". */
void truth_fill(char *text, size_t size, const char *pattern, const char *value);
/* The mean of a small picture of the text, which shows the same everywhere. sky: NULL, or of its image. */
Estimate truth_measure(const char *text, double (*sky)(double), uint32_t samples, bool by_chance);
/* The same, rendered in a way of one's own: truth_small's, and what is changed of it. */
Estimate truth_measure_as(const char *text, double (*sky)(double), const RenderSettings *settings);
/* And of any input. */
Estimate truth_measure_input(TruthInput input, const RenderSettings *settings);
RenderSettings truth_small(uint32_t samples);

#endif

/* aov_film.c - sums of what the samples of each pixel see first, and what they mean.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/aov_film.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/memory.h"

/* A length takes two sums: of its lower bits, and of what is above those. So 2^31 samples of it can be added up. */
enum { LENGTH_BITS = 31, LENGTH_SUMS = 2 };

/* What is added up for each pixel. */
enum {
    SUM_MET,
    SUM_ALBEDO,
    SUM_NORMAL = SUM_ALBEDO + 3,
    SUM_DISTANCE = SUM_NORMAL + 3,
    SUM_POSITION = SUM_DISTANCE + LENGTH_SUMS,
    SUM_UV = SUM_POSITION + 3 * LENGTH_SUMS,
    SUM_OBJECT = SUM_UV + 2,
    SUM_MEDIUM = SUM_OBJECT + 3,
    SUM_DEPTH = SUM_MEDIUM + 3, /* the three of AOV_NESTING stand in a row, in the order of its channels */
    SUM_SILENT,
    SUM_FAULTS,
    SUM_LOOKS, /* for the denoiser alone: how many samples there are of what follows */
    SUM_PASSED,
    AOV_SUMS = SUM_PASSED + 3,
    SUM_WAY = SUM_SILENT /* of what is seen behind clear surfaces: a length */
};

/* The bands of AOV_SPECTRUM: for each of them the sum of radiances, and of their weights. */
enum { BANDS = 31 };
static const float first_band_nm = 400, band_step_nm = 10;

enum { RANKS = 6 };
static const float nothing_met = 1e30f;

/* What there are mattes of: the rows of AovFilm.tallies. */
enum { OBJECTS, MATERIALS, BEHIND_OBJECTS, BEHIND_MATERIALS, BEHIND_MEDIA };
_Static_assert(BEHIND_MEDIA + 1 == AOV_TALLIES, "all tallies");

static bool has(AovSet set, Aov aov)
{
    return (set >> aov & 1) != 0;
}

static bool has_behind(const AovFilm *film)
{
    return (film->set & AOV_SET_BEHIND) != 0;
}

/* Where a pixel's sums of the spectrum begin, which follow all others: behind those of what is seen behind clear surfaces. */
static size_t sums_before_spectrum(const AovFilm *film)
{
    return has_behind(film) ? 2 * AOV_SUMS : AOV_SUMS;
}

/* And those of AOV_LIGHTS, behind these: three of each group. */
static size_t sums_before_lights(const AovFilm *film)
{
    return sums_before_spectrum(film) + (has(film->set, AOV_SPECTRUM) ? 2 * BANDS : 0);
}

static size_t sums_of_pixel(const AovFilm *film)
{
    return sums_before_lights(film) + (has(film->set, AOV_LIGHTS) ? 3 * (size_t)film->groups.n : 0);
}

/* ---- names, hashes, colours ---- */

static uint32_t rotate(uint32_t x, int by)
{
    return x << by | x >> (32 - by);
}

uint32_t aov_hash(const char *name)
{
    const uint8_t *bytes = (const uint8_t *)name;
    const uint32_t length = (uint32_t)strlen(name), c1 = 0xcc9e2d51U, c2 = 0x1b873593U;
    uint32_t hash = 0, at = 0;
    for (; at + 4 <= length; at += 4) {
        uint32_t block =
            bytes[at] | (uint32_t)bytes[at + 1] << 8 | (uint32_t)bytes[at + 2] << 16 | (uint32_t)bytes[at + 3] << 24;
        hash ^= rotate(block * c1, 15) * c2;
        hash = rotate(hash, 13) * 5 + 0xe6546b64U;
    }
    uint32_t rest = 0;
    for (uint32_t i = length; i > at; i--) rest = rest << 8 | bytes[i - 1];
    if (length > at) hash ^= rotate(rest * c1, 15) * c2;
    hash ^= length;
    hash = (hash ^ hash >> 16) * 0x85ebca6bU;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35U;
    return hash ^ hash >> 16;
}

uint32_t aov_id(const char *name)
{
    uint32_t hash = aov_hash(name), exponent = hash >> 23 & 255;
    return exponent == 0 || exponent == 255 ? hash ^ 1U << 23 : hash;
}

float aov_id_float(uint32_t id)
{
    float value;
    memcpy(&value, &id, sizeof value);
    return value;
}

static void id_color(const char *name, float rgb[3])
{
    uint32_t hash = aov_hash(name);
    for (int i = 0; i < 3; i++) rgb[i] = 0.1f + 0.9f * (float)(hash >> 8 * i & 255) / 255;
}

static const char *object_name(const Scene *scene, uint32_t object)
{
    const char *name = scene->objects[object].name;
    return name ? name : "object";
}

/* Media, then surfaces. */
static uint32_t material_of(const Scene *scene, uint32_t object)
{
    const SceneObject *o = &scene->objects[object];
    if (o->medium != SCENE_NONE) return o->medium;
    return o->surface != SCENE_NONE ? scene->n_media + o->surface : SCENE_NONE;
}

static const char *material_name(const Scene *scene, uint32_t material)
{
    const char *name =
        material < scene->n_media ? scene->media[material].name : scene->surfaces[material - scene->n_media].name;
    return name ? name : "surface";
}

/* ---- adding up ---- */

double aov_film_unit(const World *world)
{
    /* 2^-36 of the scene's size, so that lengths of up to 2^26 times that size can be added up */
    Box3 box = box3_union(rtc_scene_bounds(world->compiled->rtc), scene_camera_bounds(world->scene, &world->camera));
    double size = fmax(fmax(vec3_max_abs(box.min), vec3_max_abs(box.max)), 1e-30);
    int exponent;
    (void)frexp(size, &exponent);
    return ldexp(1, exponent - 36);
}

Status aov_film_init(AovFilm *film, AovSet set, const LightGroups *groups, bool guides, double unit, uint32_t width,
                     uint32_t height, Error *error)
{
    *film = (AovFilm){.set = set, .groups = *groups, .guides = guides, .unit = unit, .width = width, .height = height};
    size_t n = (size_t)width * height;
    bool film_has_all = !(set & ~((AovSet)1 << AOV_SAMPLES | (AovSet)1 << AOV_VARIANCE));
    if (film_has_all && !guides) return STATUS_OK;
    size_t n_sums = n * sums_of_pixel(film);
    film->sums = memory_sparse(n_sums, sizeof *film->sums);
    bool ready = film->sums != NULL;
    for (int i = 0; i < AOV_TALLIES; i++) {
        if (!has(set, i < BEHIND_OBJECTS ? AOV_CRYPTOMATTE : AOV_BEHIND_CRYPTOMATTE)) continue;
        film->tallies[i] = calloc(n, sizeof *film->tallies[i]);
        ready = ready && film->tallies[i];
    }
    if (!ready) return fail_memory(error, n_sums * sizeof *film->sums, "the film's further channels");
    return STATUS_OK;
}

void aov_film_clear(AovFilm *film)
{
    size_t n = (size_t)film->width * film->height;
    for (int i = 0; i < AOV_TALLIES; i++) tallies_free(film->tallies[i], n);
    memory_sparse_free(film->sums, n * sums_of_pixel(film) * sizeof *film->sums);
    *film = (AovFilm){0};
}

static int64_t whole(double value, double unit, double largest)
{
    double units = value / unit;
    return isfinite(units) ? llrint(fmax(-largest, fmin(largest, units))) : 0;
}

static void add_length(int64_t sums[LENGTH_SUMS], double length, double unit)
{
    const int64_t radix = INT64_C(1) << LENGTH_BITS;
    int64_t units = whole(length, unit, 0x1p62), low = units & (radix - 1);
    sums[0] += low;
    sums[1] += (units - low) / radix;
}

/* As film.c has it: one more sample does not overflow. */
static int64_t held(int64_t sum)
{
    const int64_t largest = INT64_C(1) << 62;
    return sum > largest ? largest : sum < -largest ? -largest : sum;
}

static void add_floats(int64_t *sums, const float *values, int n)
{
    for (int i = 0; i < n; i++) sums[i] = held(sums[i] + whole((double)values[i], FILM_UNIT, 0x1p44));
}

static void add_id(int64_t *sums, const char *name)
{
    float color[3];
    id_color(name, color);
    add_floats(sums, color, 3);
}

/* What both kinds of sights have. */
static void add_sight(AovFilm *film, int64_t *sums, const FirstSight *sight)
{
    const double position[3] = {sight->position.x, sight->position.y, sight->position.z};
    const float normal[3] = {sight->normal.x, sight->normal.y, sight->normal.z};
    sums[SUM_MET]++;
    add_length(sums + SUM_DISTANCE, sight->distance, film->unit);
    for (int i = 0; i < 3; i++) add_length(sums + SUM_POSITION + i * LENGTH_SUMS, position[i], film->unit);
    add_floats(sums + SUM_ALBEDO, sight->albedo, 3);
    add_floats(sums + SUM_NORMAL, normal, 3);
    add_floats(sums + SUM_UV, sight->uv, 2);
    if (film->set & ((AovSet)1 << AOV_OBJECT | (AovSet)1 << AOV_BEHIND_OBJECT))
        add_id(sums + SUM_OBJECT, object_name(film->world->scene, sight->object));
}

static void add_medium(const AovFilm *film, int64_t *sums, uint32_t medium)
{
    if (medium != SCENE_NONE) add_id(sums + SUM_MEDIUM, film->world->scene->media[medium].name);
}

static void add_to_matte(AovFilm *film, Tally *tallies, size_t pixel, const char *name)
{
    if (!tally_add(&tallies[pixel], aov_id(name), 1)) film->out_of_memory = true;
}

static void add_to_mattes(AovFilm *film, Tally *const tallies[2], size_t pixel, const FirstSight *sight)
{
    if (!sight->met || !tallies[0]) return;
    const Scene *scene = film->world->scene;
    uint32_t material = sight->scatters ? sight->medium : material_of(scene, sight->object);
    add_to_matte(film, tallies[0], pixel, object_name(scene, sight->object));
    if (material != SCENE_NONE) add_to_matte(film, tallies[1], pixel, material_name(scene, material));
}

static void add_behind(AovFilm *film, size_t pixel, const FirstSight *behind)
{
    int64_t *sums = film->sums + pixel * sums_of_pixel(film) + AOV_SUMS;
    if (behind->met) add_sight(film, sums, behind);
    add_length(sums + SUM_WAY, behind->way, film->unit);
    add_medium(film, sums, behind->through);
    add_to_mattes(film, film->tallies + BEHIND_OBJECTS, pixel, behind);
    if (film->tallies[BEHIND_MEDIA] && behind->through != SCENE_NONE)
        add_to_matte(film, film->tallies[BEHIND_MEDIA], pixel, film->world->scene->media[behind->through].name);
}

/* Of light, as bright as the film holds. */
static void add_amount(int64_t *sum, float amount)
{
    *sum = held(*sum + whole((double)amount, FILM_UNIT, 0x1p61));
}

/* A mean over a band is one of radiances, each weighted by how much of the spectrum its wavelength stands for: that has far less noise
 * than what they add up to, as that many samples fall into one band only in the mean. */
static void add_light(int64_t *sums, const SampleLight *light)
{
    for (int i = 0; i < LANES; i++) {
        int band = (int)floorf((lanes_get(light->wavelengths.nm, i) - first_band_nm) / band_step_nm + 0.5f);
        if (band < 0 || band >= BANDS) continue;
        float weight = 1 / (lanes_get(light->wavelengths.pdf, i) * (BANDS * band_step_nm));
        add_amount(&sums[2 * band], lanes_get(light->radiance, i) * weight);
        add_amount(&sums[2 * band + 1], weight);
    }
}

static void add_groups(const AovFilm *film, int64_t *sums, const Tracer *tracer)
{
    for (uint32_t i = 0; i < film->groups.n; i++, sums += 3) {
        float rgb[3];
        color_from_lanes(tracer->grouped[i], &tracer->light.wavelengths, rgb);
        for (int k = 0; k < 3; k++) add_amount(&sums[k], rgb[k]);
    }
}

void aov_film_add(AovFilm *film, uint32_t x, uint32_t y, const Tracer *tracer, const PathCounters *before)
{
    size_t pixel = (size_t)y * film->width + x;
    int64_t *sums = film->sums + pixel * sums_of_pixel(film);
    const FirstSight *sight = &tracer->first_sight;
    const PathCounters *after = &tracer->counters;
    sums[SUM_SILENT] += (int64_t)(after->silent_crossings - before->silent_crossings);
    sums[SUM_FAULTS] += (int64_t)(after->nesting_faults - before->nesting_faults);
    if (has(film->set, AOV_SPECTRUM)) add_light(sums + sums_before_spectrum(film), &tracer->light);
    if (has(film->set, AOV_LIGHTS)) add_groups(film, sums + sums_before_lights(film), tracer);
    if (has_behind(film)) add_behind(film, pixel, &tracer->behind);
    if (film->guides && tracer->notes_behind) {
        sums[SUM_LOOKS]++;
        add_floats(sums + SUM_PASSED, tracer->behind.passed, 3);
    }
    if (!sight->met) return;
    add_sight(film, sums, sight);
    sums[SUM_DEPTH] += sight->n_hulls;
    if (has(film->set, AOV_MEDIUM)) add_medium(film, sums, sight->medium);
    add_to_mattes(film, film->tallies, pixel, sight);
}

/* ---- as bytes ---- */

static int64_t *sums_at(const AovFilm *film, uint32_t x, uint32_t y)
{
    return film->sums + ((size_t)y * film->width + x) * sums_of_pixel(film);
}

size_t aov_film_pixel_size(void)
{
    return AOV_SUMS * sizeof(int64_t);
}

static size_t bytes_of_row(const AovFilm *film)
{
    return film->width * sums_of_pixel(film) * sizeof *film->sums;
}

void aov_film_save_row(const AovFilm *film, uint32_t y, Buf *out)
{
    if (!film->sums) return;
    buf_add_bytes(out, (const char *)sums_at(film, 0, y), bytes_of_row(film));
    for (size_t x = 0; x < film->width; x++)
        for (int i = 0; i < AOV_TALLIES; i++)
            if (film->tallies[i]) tally_save(&film->tallies[i][(size_t)y * film->width + x], out);
}

bool aov_film_load_row(AovFilm *film, uint32_t y, BufReader *in)
{
    if (!film->sums) return true;
    bool good = buf_take(in, sums_at(film, 0, y), bytes_of_row(film));
    for (size_t x = 0; x < film->width; x++)
        for (int i = 0; i < AOV_TALLIES; i++)
            good = good && (!film->tallies[i] || tally_load(&film->tallies[i][(size_t)y * film->width + x], in));
    return good;
}

bool aov_film_join_row(AovFilm *film, uint32_t y, const AovFilm *next, uint32_t next_y)
{
    if (!film->sums) return true;
    int64_t *sums = sums_at(film, 0, y);
    const int64_t *others = sums_at(next, 0, next_y);
    /* those of damaged files are not to overflow */
    for (size_t i = 0; i < film->width * sums_of_pixel(film); i++)
        sums[i] = held((int64_t)((uint64_t)sums[i] + (uint64_t)others[i]));
    bool kept = true;
    for (size_t x = 0; x < film->width; x++) {
        size_t to = (size_t)y * film->width + x, from = (size_t)next_y * next->width + x;
        for (int i = 0; i < AOV_TALLIES; i++)
            kept = kept && (!film->tallies[i] || tally_join(&film->tallies[i][to], &next->tallies[i][from]));
    }
    return kept;
}

/* ---- what it means ---- */

/* The largest first; of two alike the one whose hash is the smaller float. */
static int compare_ranked(const void *left, const void *right)
{
    const TallyItem *a = left, *b = right;
    if (a->n != b->n) return a->n > b->n ? -1 : 1;
    float x = aov_id_float(a->id), y = aov_id_float(b->id);
    return x < y ? -1 : x > y;
}

/* Pairs of hash and coverage, the largest coverage first. */
static void put_ranks(const Tally *tally, uint32_t n_samples, float *out)
{
    TallyItem few[16], *ranked = tally->n <= COUNT_OF(few) ? few : malloc(tally->n * sizeof *ranked);
    uint32_t n = ranked ? tally->n : 0;
    if (n) memcpy(ranked, tally->items, n * sizeof *ranked);
    if (n > 1) qsort(ranked, n, sizeof *ranked, compare_ranked);
    for (uint32_t i = 0; i < RANKS; i++) {
        bool there = i < n && n_samples;
        out[2 * i] = there ? aov_id_float(ranked[i].id) : 0;
        out[2 * i + 1] = there ? (float)((double)ranked[i].n / n_samples) : 0;
    }
    if (ranked != few) free(ranked);
}

static float *put_means(const int64_t *sums, int n, double unit, double among, float *out)
{
    for (int i = 0; i < n; i++) *out++ = among > 0 ? (float)((double)sums[i] * unit / among) : 0;
    return out;
}

static float *put_lengths(const int64_t *sums, int n, double unit, double among, float *out)
{
    for (int i = 0; i < n; i++, sums += LENGTH_SUMS) {
        double sum = (double)sums[0] + ldexp((double)sums[1], LENGTH_BITS);
        *out++ = among > 0 ? (float)(sum * unit / among) : 0;
    }
    return out;
}

/* The channels of one AOV that both kinds of sights have; n: samples. */
static float *put_sight(const AovFilm *aovs, Aov aov, const int64_t *sums, double n, float *out)
{
    double met = (double)sums[SUM_MET];
    switch (aov) {
    case AOV_ALBEDO: return put_means(sums + SUM_ALBEDO, 3, FILM_UNIT, n, out);
    case AOV_NORMAL: return put_means(sums + SUM_NORMAL, 3, FILM_UNIT, met, out);
    case AOV_DEPTH:
        put_lengths(sums + SUM_DISTANCE, 1, aovs->unit, met, out);
        if (met == 0) *out = nothing_met;
        return out + 1;
    case AOV_POSITION: return put_lengths(sums + SUM_POSITION, 3, aovs->unit, met, out);
    case AOV_UV: return put_means(sums + SUM_UV, 2, FILM_UNIT, met, out);
    case AOV_OBJECT: return put_means(sums + SUM_OBJECT, 3, FILM_UNIT, n, out);
    case AOV_MEDIUM: return put_means(sums + SUM_MEDIUM, 3, FILM_UNIT, n, out);
    default: return out;
    }
}

static float *put_mattes(const AovFilm *aovs, int first, int end, size_t pixel, uint32_t n, float *out)
{
    for (int i = first; i < end; i++, out += 2 * RANKS) put_ranks(&aovs->tallies[i][pixel], n, out);
    return out;
}

/* Of a band without a sample, what is between those beside it that have some; 0 where none has. */
static float *put_spectrum(const int64_t *sums, float *out)
{
    int last = -1; /* with samples */
    for (int band = 0; band < BANDS; band++) {
        if (sums[2 * band + 1] <= 0) continue;
        out[band] = (float)((double)sums[2 * band] / (double)sums[2 * band + 1]);
        for (int k = last + 1; k < band; k++)
            out[k] =
                last < 0 ? out[band] : out[last] + (out[band] - out[last]) * (float)(k - last) / (float)(band - last);
        last = band;
    }
    for (int k = last + 1; k < BANDS; k++) out[k] = last < 0 ? 0 : out[last];
    return out + BANDS;
}

/* The channels of one AOV of one pixel. */
static float *put_aov(const AovFilm *aovs, const Film *film, size_t pixel, Aov aov, float *out)
{
    const FilmPixel *p = &film->pixels[pixel];
    const int64_t *sums = aovs->sums ? aovs->sums + pixel * sums_of_pixel(aovs) : NULL;
    double n = p->n, mean, standard_error;
    switch (aov) {
    case AOV_ALBEDO:
    case AOV_NORMAL:
    case AOV_DEPTH:
    case AOV_POSITION:
    case AOV_UV:
    case AOV_OBJECT:
    case AOV_MEDIUM: return put_sight(aovs, aov, sums, n, out);
    case AOV_NESTING: return put_means(sums + SUM_DEPTH, 3, 1, n, out);
    case AOV_SAMPLES: *out = (float)n; return out + 1;
    case AOV_VARIANCE:
        film_luminance(p, &mean, &standard_error);
        *out = standard_error > 0 ? (float)(standard_error * standard_error * n) : 0;
        return out + 1;
    case AOV_CRYPTOMATTE: return put_mattes(aovs, OBJECTS, BEHIND_OBJECTS, pixel, p->n, out);
    case AOV_LIGHTS: return put_means(sums + sums_before_lights(aovs), 3 * (int)aovs->groups.n, FILM_UNIT, n, out);
    case AOV_SPECTRUM: return put_spectrum(sums + sums_before_spectrum(aovs), out);
    case AOV_BEHIND_ALBEDO: return put_sight(aovs, AOV_ALBEDO, sums + AOV_SUMS, n, out);
    case AOV_BEHIND_NORMAL: return put_sight(aovs, AOV_NORMAL, sums + AOV_SUMS, n, out);
    case AOV_BEHIND_DEPTH: return put_sight(aovs, AOV_DEPTH, sums + AOV_SUMS, n, out);
    case AOV_BEHIND_POSITION: return put_sight(aovs, AOV_POSITION, sums + AOV_SUMS, n, out);
    case AOV_BEHIND_UV: return put_sight(aovs, AOV_UV, sums + AOV_SUMS, n, out);
    case AOV_BEHIND_OBJECT: return put_sight(aovs, AOV_OBJECT, sums + AOV_SUMS, n, out);
    case AOV_BEHIND_MEDIUM:
        out = put_sight(aovs, AOV_MEDIUM, sums + AOV_SUMS, n, out);
        return put_lengths(sums + AOV_SUMS + SUM_WAY, 1, aovs->unit, n, out);
    case AOV_BEHIND_CRYPTOMATTE: return put_mattes(aovs, BEHIND_OBJECTS, AOV_TALLIES, pixel, p->n, out);
    case AOV_COUNT: break;
    }
    return out;
}

double aov_film_guide(const AovFilm *aovs, const Film *film, size_t pixel, float guide[AOV_GUIDES])
{
    float *distance = put_aov(aovs, film, pixel, AOV_NORMAL, put_aov(aovs, film, pixel, AOV_ALBEDO, guide));
    put_aov(aovs, film, pixel, AOV_DEPTH, distance);
    *distance = logf(fmaxf(*distance, FLT_MIN));
    const int64_t *sums = aovs->sums + pixel * sums_of_pixel(aovs), *passed = sums + SUM_PASSED;
    const double looks = (double)sums[SUM_LOOKS];
    for (int i = 0; i < 3; i++) distance[1 + i] = (float)((double)passed[i] * FILM_UNIT / fmax(looks, 1));
    return looks;
}

/* The names of an AOV's channels, with that of a group of lights where it has one. Returns how many. */
static uint32_t names_of_aov(Aov aov, const char *group, char (*names)[IMAGE_NAME_SIZE])
{
    uint32_t n = 0;
    for (const char *rest = aov_channels(aov); *rest; n++) {
        size_t length = strcspn(rest, "|"), before = strcspn(rest, "*");
        if (before < length)
            snprintf(names[n], sizeof *names, "%.*s%s%.*s", (int)before, rest, group, (int)(length - before - 1),
                     rest + before + 1);
        else
            snprintf(names[n], sizeof *names, "%.*s", (int)length, rest);
        rest += length + (rest[length] != 0);
    }
    return n;
}

/* The names of all channels: of the film, then of the AOVs in the order of the table. Returns how many. */
static uint32_t channel_names(const AovFilm *aovs, const Image *plain, char (*names)[IMAGE_NAME_SIZE])
{
    uint32_t n = plain->n_channels;
    memcpy(names, plain->names, n * sizeof *names);
    for (Aov aov = 0; aov < AOV_COUNT; aov++)
        for (uint32_t i = 0; has(aovs->set, aov) && i < (aov == AOV_LIGHTS ? aovs->groups.n : 1); i++)
            n += names_of_aov(aov, aovs->groups.names[i], names + n);
    return n;
}

/* A picture, and the same with more channels. */
typedef struct Extension {
    const AovFilm *aovs;
    const Film *film;
    const Image *plain;
    Image *whole;
} Extension;

static void extend_row(void *context, uint32_t y, unsigned worker)
{
    const Extension *e = context;
    (void)worker;
    for (uint32_t x = 0; x < e->plain->width; x++) {
        float *out = image_at(e->whole, x, y);
        memcpy(out, image_at(e->plain, x, y), e->plain->n_channels * sizeof *out);
        out += e->plain->n_channels;
        for (Aov aov = 0; aov < AOV_COUNT; aov++)
            if (has(e->aovs->set, aov)) out = put_aov(e->aovs, e->film, (size_t)y * e->plain->width + x, aov, out);
    }
}

Status aov_film_resolve(const AovFilm *aovs, const Film *film, const Spread *spread, Pool *pool, Image *image,
                        Error *error)
{
    enum { MOST_CHANNELS = 160 + 3 * LIMIT_LIGHT_GROUPS };
    TRY(film_resolve(film, spread, pool, image, error));
    if (!aovs->set) return STATUS_OK;
    if (aovs->out_of_memory) return fail(error, STATUS_NOMEM, "out of memory for the film's further channels");
    char names[MOST_CHANNELS][IMAGE_NAME_SIZE];
    const char *pointers[MOST_CHANNELS];
    uint32_t n = channel_names(aovs, image, names);
    for (uint32_t i = 0; i < n; i++) pointers[i] = names[i];
    Image whole_image;
    Status status = image_new(image->width, image->height, pointers, n, &whole_image, error);
    Extension extension = {aovs, film, image, &whole_image};
    if (status == STATUS_OK) pool_run(pool, image->height, extend_row, &extension);
    image_clear(image);
    if (status == STATUS_OK) *image = whole_image;
    return status;
}

/* ---- attributes ---- */

typedef void Visit(void *context, const char *name, const char *text);

static int compare_names(const void *left, const void *right)
{
    return strcmp(*(const char *const *)left, *(const char *const *)right);
}

/* The names of all objects, or of all media and, where asked for, surfaces: sorted, each once. NULL when memory ends.
 */
static const char **all_names(const Scene *scene, bool objects, bool surfaces, uint32_t *n)
{
    uint32_t n_all = objects ? scene->n_objects : scene->n_media + (surfaces ? scene->n_surfaces : 0), kept = 0;
    const char **names = malloc((n_all + 1U) * sizeof *names);
    *n = 0;
    if (!names) return NULL;
    for (uint32_t i = 0; i < n_all; i++)
        if (!objects || scene->objects[i].part_of == SCENE_NONE)
            names[kept++] = objects ? object_name(scene, i) : material_name(scene, i);
    if (kept > 1) qsort(names, kept, sizeof *names, compare_names);
    for (uint32_t i = 0; i < kept; i++)
        if (i == 0 || strcmp(names[i], names[*n - 1]) != 0) names[(*n)++] = names[i];
    return names;
}

static void add_color(JsonWriter *json, const char *name)
{
    float rgb[3];
    id_color(name, rgb);
    json_key(json, name);
    json_begin_array(json);
    for (int i = 0; i < 3; i++) json_float(json, rgb[i]);
    json_end(json);
}

static void add_hash(JsonWriter *json, const char *name)
{
    char hash[16];
    snprintf(hash, sizeof hash, "%08x", (unsigned)aov_id(name));
    json_add_text(json, name, hash);
}

/* One attribute: an object with a member for each name. */
static void visit_names(const Scene *scene, bool objects, bool surfaces, void (*add)(JsonWriter *, const char *),
                        const char *attribute, Visit *visit, void *context)
{
    uint32_t n;
    const char **names = all_names(scene, objects, surfaces, &n);
    Buf text = {0};
    JsonWriter json = json_writer(&text, false);
    json_begin_object(&json);
    for (uint32_t i = 0; i < n; i++) add(&json, names[i]);
    json_end(&json);
    if (names && !text.failed) visit(context, attribute, buf_text(&text));
    buf_clear(&text);
    free(names);
}

/* The key of a layer is the first seven digits of its name's hash (Cryptomatte 1.2, "metadata"). */
static void visit_cryptomatte(const Scene *scene, const char *layer, bool objects, Visit *visit, void *context)
{
    static const char *const keys[] = {"name", "hash", "conversion"};
    const char *const values[] = {layer, "MurmurHash3_32", "uint32_to_float32"};
    char name[64], id[16];
    snprintf(id, sizeof id, "%08x", (unsigned)aov_hash(layer));
    for (size_t i = 0; i < COUNT_OF(keys); i++) {
        snprintf(name, sizeof name, "cryptomatte/%.7s/%s", id, keys[i]);
        visit(context, name, values[i]);
    }
    snprintf(name, sizeof name, "cryptomatte/%.7s/manifest", id);
    visit_names(scene, objects, true, add_hash, name, visit, context);
}

void aov_visit_attributes(AovSet set, const Scene *scene, Visit *visit, void *context)
{
    if (has(set, AOV_MEDIUM) || has(set, AOV_BEHIND_MEDIUM))
        visit_names(scene, false, false, add_color, "meniscus/media", visit, context);
    if (has(set, AOV_OBJECT) || has(set, AOV_BEHIND_OBJECT))
        visit_names(scene, true, false, add_color, "meniscus/objects", visit, context);
    if (has(set, AOV_SPECTRUM)) {
        visit(context, "spectralLayoutVersion", "1.0");
        visit(context, "emissiveUnits", "W.m^-2.sr^-1");
    }
    if (has(set, AOV_CRYPTOMATTE)) {
        visit_cryptomatte(scene, "CryptoObject", true, visit, context);
        visit_cryptomatte(scene, "CryptoMaterial", false, visit, context);
    }
    if (!has(set, AOV_BEHIND_CRYPTOMATTE)) return;
    visit_cryptomatte(scene, "CryptoObjectBehind", true, visit, context);
    visit_cryptomatte(scene, "CryptoMaterialBehind", false, visit, context);
    visit_cryptomatte(scene, "CryptoMediumBehind", false, visit, context);
}

/* bright.c - sorts the few brightest samples of a pixel as they come.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/bright.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Of one sample: one that chose among several ways may say more than 1. */
#define MOST_REFLECTED 4.0f
/* Of all samples of a render, in sum: far more than any can have, and so little that sums of sums of files stay in 64 bits. */
#define MOST_REFLECTED_SUM ((int64_t)1 << 48)

Status bright_film_init(BrightFilm *film, bool slice, uint32_t width, uint32_t height, Error *error)
{
    size_t n = (size_t)width * height, size = n * (sizeof(BrightPixel) + (slice ? sizeof(BrightSlice) : 0));
    *film = (BrightFilm){.width = width, .height = height, .pixels = memory_sparse(n, sizeof(BrightPixel))};
    if (slice) film->slices = memory_sparse(n, sizeof(BrightSlice));
    if (film->pixels && (film->slices || !slice)) return STATUS_OK;
    bright_film_clear(film);
    return fail_memory(error, size, "the brightest samples");
}

void bright_film_clear(BrightFilm *film)
{
    size_t n = (size_t)film->width * film->height;
    for (size_t i = 0; film->slices && i < n; i++) tally_clear(&film->slices[i].things);
    memory_sparse_free(film->slices, n * sizeof *film->slices);
    memory_sparse_free(film->pixels, n * sizeof *film->pixels);
    *film = (BrightFilm){0};
}

void bright_film_forget_row(BrightFilm *film, uint32_t y)
{
    const size_t begin = (size_t)y * film->width, end = begin + film->width;
    if (film->pixels) memset(&film->pixels[begin], 0, film->width * sizeof *film->pixels);
    for (size_t i = begin; film->slices && i < end; i++) {
        tally_clear(&film->slices[i].things);
        film->slices[i] = (BrightSlice){0};
    }
}

/* Returns its place among the others; < 0: it has none. */
ATTR_COLD static int keep(BrightPixel *pixel, const float rgb[3], uint32_t seen)
{
    float held[3], light; /* as the film holds it */
    for (int c = 0; c < 3; c++) held[c] = fminf(fmaxf(rgb[c], -(float)FILM_LARGEST), (float)FILM_LARGEST);
    light = bright_light(held);
    if (!(light > pixel->least)) return -1;
    int at = BRIGHT_KEPT - 1;
    for (; at > 0 && bright_light(pixel->rgb[at - 1]) < light; at--)
        memcpy(pixel->rgb[at], pixel->rgb[at - 1], sizeof held);
    memcpy(pixel->rgb[at], held, sizeof held);
    pixel->least = bright_light(pixel->rgb[BRIGHT_KEPT - 1]);
    uint32_t below = (1U << BRIGHT_SEEN_BITS * at) - 1;
    pixel->seen = (pixel->seen & below) | seen << BRIGHT_SEEN_BITS * at | (pixel->seen & ~below) << BRIGHT_SEEN_BITS;
    return at;
}

/* Samples that saw the thing: which of the pixel's things it is. */
static uint32_t count_seen(BrightPixel *pixel, uint32_t thing, uint32_t n)
{
    uint32_t seen = 0;
    while (seen < BRIGHT_THINGS && pixel->counts[seen] && pixel->things[seen] != thing) seen++;
    if (seen < BRIGHT_THINGS) {
        pixel->things[seen] = thing;
        pixel->counts[seen] += n;
    }
    return seen;
}

static void insert(uint32_t *items, int at, uint32_t item)
{
    memmove(items + at + 1, items + at, (size_t)(BRIGHT_KEPT - 1 - at) * sizeof *items);
    items[at] = item;
}

/* Alike for all channels, so that the colour stays. */
static void add_reflected(BrightPixel *pixel, const Reflected *reflected)
{
    float scale = BRIGHT_REFLECTED * fminf(1, MOST_REFLECTED / fmaxf(reflected->mean, MOST_REFLECTED));
    pixel->reflected += lrintf(reflected->mean * scale);
    for (int c = 0; c < 3; c++) pixel->reflected_rgb[c] += lrintf(reflected->rgb[c] * scale);
    pixel->n_reflected++;
}

void bright_film_add(BrightFilm *film, uint32_t x, uint32_t y, const float rgb[3], uint32_t thing,
                     const Reflected *reflected)
{
    if (thing == BRIGHT_NOTHING) return;
    size_t i = (size_t)y * film->width + x;
    BrightPixel *pixel = &film->pixels[i];
    uint32_t seen = count_seen(pixel, thing, 1);
    if (reflected->mean >= 0) add_reflected(pixel, reflected);
    if (UNLIKELY(film->slices != NULL) && !tally_add(&film->slices[i].things, thing, 1)) film->out_of_memory = true;
    float light = bright_light(rgb);
    if (LIKELY(!(light > pixel->least)) || light < (float)FILM_UNIT)
        return; /* less is not in the film's sums, either */
    int at = keep(pixel, rgb, seen);
    if (film->slices && at >= 0) insert(film->slices[i].kept, at, thing);
}

/* ---- as bytes ---- */

void bright_film_save_row(const BrightFilm *film, uint32_t y, Buf *out)
{
    if (!film->pixels) return;
    const size_t begin = (size_t)y * film->width, end = begin + film->width;
    buf_add_bytes(out, (const char *)&film->pixels[begin], film->width * sizeof *film->pixels);
    for (size_t i = begin; film->slices && i < end; i++) {
        buf_add_bytes(out, (const char *)film->slices[i].kept, sizeof film->slices[i].kept);
        tally_save(&film->slices[i].things, out);
    }
}

static bool can_be(const BrightPixel *pixel)
{
    bool good = pixel->reflected >= 0 && pixel->reflected <= MOST_REFLECTED_SUM;
    for (int c = 0; c < 3; c++)
        good = good && pixel->reflected_rgb[c] >= -MOST_REFLECTED_SUM && pixel->reflected_rgb[c] <= MOST_REFLECTED_SUM;
    for (int i = 0; i < BRIGHT_KEPT; i++) good = good && bright_light(pixel->rgb[i]) <= (float)FILM_LARGEST;
    return good;
}

bool bright_film_load_row(BrightFilm *film, uint32_t y, BufReader *in)
{
    if (!film->pixels) return true;
    const size_t begin = (size_t)y * film->width, end = begin + film->width;
    bool good = buf_take(in, &film->pixels[begin], film->width * sizeof *film->pixels);
    for (size_t i = begin; good && i < end; i++) good = can_be(&film->pixels[i]);
    for (size_t i = begin; good && film->slices && i < end; i++)
        good =
            buf_take(in, film->slices[i].kept, sizeof film->slices[i].kept) && tally_load(&film->slices[i].things, in);
    return good;
}

/* Both lists are sorted; of samples as bright as each other the earlier one stands first, as if they had come one by one. */
static void join_kept(BrightPixel *pixel, uint32_t *things, const BrightPixel *next, const uint32_t *next_things)
{
    BrightPixel own = *pixel;
    uint32_t own_things[BRIGHT_KEPT] = {0};
    if (things) memcpy(own_things, things, sizeof own_things);
    pixel->seen = 0;
    for (int k = 0, i = 0, j = 0; k < BRIGHT_KEPT; k++) {
        bool is_own = bright_light(own.rgb[i]) >= bright_light(next->rgb[j]);
        uint32_t seen = 0;
        if (is_own)
            seen = bright_seen(&own, i);
        else
            while (seen < BRIGHT_THINGS && !(pixel->counts[seen] && pixel->things[seen] == next_things[j])) seen++;
        memcpy(pixel->rgb[k], is_own ? own.rgb[i] : next->rgb[j], sizeof pixel->rgb[k]);
        pixel->seen |= seen << BRIGHT_SEEN_BITS * k;
        if (things) things[k] = is_own ? own_things[i] : next_things[j];
        if (is_own)
            i++;
        else
            j++;
    }
    pixel->least = bright_light(pixel->rgb[BRIGHT_KEPT - 1]);
}

bool bright_film_join_row(BrightFilm *film, uint32_t y, const BrightFilm *next, uint32_t next_y)
{
    for (size_t x = 0; film->pixels && x < film->width; x++) {
        size_t i = (size_t)y * film->width + x, from = (size_t)next_y * next->width + x;
        const BrightSlice *slice = &next->slices[from];
        BrightSlice *own = film->slices ? &film->slices[i] : NULL;
        for (uint32_t k = 0; k < slice->things.n; k++)
            (void)count_seen(&film->pixels[i], slice->things.items[k].id, slice->things.items[k].n);
        film->pixels[i].reflected += next->pixels[from].reflected;
        film->pixels[i].n_reflected += next->pixels[from].n_reflected;
        for (int c = 0; c < 3; c++) film->pixels[i].reflected_rgb[c] += next->pixels[from].reflected_rgb[c];
        join_kept(&film->pixels[i], own ? own->kept : NULL, &next->pixels[from], slice->kept);
        if (own && !tally_join(&own->things, &slice->things)) return false;
    }
    return true;
}

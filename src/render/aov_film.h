/* aov_film.h - what a picture holds besides its colours, added up in integers as the film is.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_AOV_FILM_H
#define MEN_AOV_FILM_H

#include "render/spread.h"
#include "render/tally.h"
#include "trace/path.h"

/* What keeps unlike things apart where a picture is denoised: albedo, normal, the logarithm of the distance, and which things are seen
 * behind what is clear. */
enum { AOV_GUIDES = 10, AOV_TALLIES = 5 };

typedef struct AovFilm {
    AovSet set;
    LightGroups groups; /* of lights, of AOV_LIGHTS */
    bool guides;        /* these are kept, whether they are in the set or not */
    const World *world; /* for aov_film_add; the others do not need it */
    uint32_t width, height;
    double unit;   /* of lengths: fine against the size of the scene, and a power of two */
    int64_t *sums; /* for each pixel AOV_SUMS of them, or twice as many, see aov_film.c; NULL when nothing is needed */
    Tally *tallies[AOV_TALLIES]; /* what the samples of each pixel saw, by the hashes of names; or NULL */
    bool out_of_memory;
} AovFilm;

/* With an empty set and without guides nothing is allocated, and the other functions do next to nothing. unit: see
 * aov_film_unit; groups: as the scene has them. */
ATTR_NODISCARD Status aov_film_init(AovFilm *film, AovSet set, const LightGroups *groups, bool guides, double unit,
                                    uint32_t width, uint32_t height, Error *error);
/* In which the lengths of a scene are added up. */
double aov_film_unit(const World *world);
void aov_film_clear(AovFilm *film);
/* Whether tracers must fill in what is met first. */
static inline bool aov_film_needs_sight(const AovFilm *film)
{
    return film->sums != NULL;
}
/* And how much light of each group of lights there is. */
static inline bool aov_film_needs_groups(const AovFilm *film)
{
    return (film->set >> AOV_LIGHTS & 1) != 0;
}
/* And what is seen behind clear surfaces, of a pixel's sample of that number: for guides alone, some are enough. The first digits of a
 * number say where in the pixel a sample is, so that they are not every so-manyth. */
static inline bool aov_film_needs_behind(const AovFilm *film, uint32_t index)
{
    return (film->set & AOV_SET_BEHIND) != 0 || (film->guides && index % 16 < 4);
}
/* The last sample of a tracer, whose counters were these before it. A pixel belongs to one thread at a time. */
void aov_film_add(AovFilm *film, uint32_t x, uint32_t y, const Tracer *tracer, const PathCounters *before);
/* Rows as bytes, and joining two, as film_save_row and its like have it. Those of films of one set and unit. false from joining
 * when memory ends. */
void aov_film_save_row(const AovFilm *film, uint32_t y, Buf *out);
bool aov_film_load_row(AovFilm *film, uint32_t y, BufReader *in);
bool aov_film_join_row(AovFilm *film, uint32_t y, const AovFilm *next, uint32_t next_y);
/* Of a row's bytes, without what tallies and what is seen behind clear surfaces add. */
size_t aov_film_pixel_size(void);
/* The whole picture: the film's channels, and these. spread, pool: see film_resolve. */
ATTR_NODISCARD Status aov_film_resolve(const AovFilm *aovs, const Film *film, const Spread *spread, Pool *pool,
                                       Image *image, Error *error);

/* Of a pixel, by its number in rows: of a film that keeps guides. How many of its samples have seen the last three. */
double aov_film_guide(const AovFilm *aovs, const Film *film, size_t pixel, float guide[AOV_GUIDES]);
/* The attributes of a file that holds these: name and text of each, for EXR. */
void aov_visit_attributes(AovSet set, const Scene *scene,
                          void (*visit)(void *context, const char *name, const char *text), void *context);

/* MurmurHash3_x86_32 (A. Appleby, public domain algorithm), seed 0: what Cryptomatte names things by. */
uint32_t aov_hash(const char *name);
/* The hash with an exponent of none of 0, denormals, infinity and NaN; and its bits as that float, as which it stands in
 * pictures (Cryptomatte 1.2, "hash conversion"). */
uint32_t aov_id(const char *name);
float aov_id_float(uint32_t id);

#endif

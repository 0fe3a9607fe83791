/* path.h - one path: from the film through the nested volumes to the lights, unidirectional, with next-event
 * estimation and multiple importance sampling.
 *
 * Radiance is carried as basic radiance, L / n^2, which no boundary changes but by its Fresnel
 * factors: the radiance scaling of refraction ([Veach97] section 5.2) is in the quantity itself. Light sources give
 * their radiance in their own medium and are divided by its n^2; the camera measures basic radiance, as one behind a
 * flat port would. So a closed uniform environment looks the same from everywhere, under water too.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PATH_H
#define MEN_PATH_H

#include "base/memory.h"
#include "trace/sampler.h"
#include "trace/world.h"

typedef struct PathCounters {
    uint64_t paths, rays, crossings, silent_crossings, nesting_faults, silent_limit, bad_samples;
} PathCounters;

static inline void path_counters_add(PathCounters *sum, const PathCounters *more)
{
    sum->paths += more->paths;
    sum->rays += more->rays;
    sum->crossings += more->crossings;
    sum->silent_crossings += more->silent_crossings;
    sum->nesting_faults += more->nesting_faults;
    sum->silent_limit += more->silent_limit;
    sum->bad_samples += more->bad_samples;
}

/* What a camera's ray meets first: the first surface that is there, behind silent ones. Or what it sees behind all that is clear: a
 * surface that is not, or a medium that scatters. */
typedef struct FirstSight {
    bool met;
    uint32_t object;  /* a combination's own row, not its operand's */
    uint32_t medium;  /* behind the surface; in front of it where it is opaque */
    uint32_t n_hulls; /* that hold the place there */
    double distance;
    Vec3 position;
    Vec3f normal; /* for shading, towards the camera */
    float uv[2], albedo[3];
    bool scatters; /* behind what is clear: a medium of the object is met, not its surface; */
    /* and that medium; else in which object's medium the way from the first surface to there is longest; SCENE_NONE: in none */
    uint32_t through;
    double way; /* the longest of these ways */
    /* which things it has passed and come to behind what is clear, as a sum of numbers for their materials */
    float passed[3];
} FirstSight;

/* One of the media that fill a place which a path flies through; see flight.c. */
typedef struct FlightPart {
    const SceneMedium *medium;
    uint32_t number;          /* of the medium */
    const MediumPlace *place; /* of its volumes; NULL: it has none */
    const Glow *glow;  /* NULL: light sampling does not look there, or not from where the path was scattered last; */
    float glow_choice; /* else how likely it chooses this one there; < 0: not known yet */
    Lanes absorption, scattering, emission; /* where its density is 1 */
    float bound;                            /* the largest extinction of any lane there */
    float low, high;                        /* bounds of its density, up to t_end of the ray */
    double t_end;
    bool walks; /* it varies: through these bricks */
    VolumeWalk walk;
    const MediumMaps *maps; /* of the place, or these: */
    MediumMaps moved;
} FlightPart;

typedef struct FlightParts {
    FlightPart *items;
    size_t capacity;
    uint32_t n;
} FlightParts;

/* The pixel that was sampled last: its random numbers, and what all of its samples have in common. */
typedef struct PixelSampler {
    bool made;
    uint32_t seed, x, y;
    Sampler sampler; /* of the sample that was made last */
    SamplerStream place, wavelength;
} PixelSampler;

/* Of light that came to a surface what went on from there: in the mean over wavelengths, and what is left of white. */
typedef struct Reflected {
    float mean, rgb[3];
} Reflected;

/* What a path from the camera finds at a shadow catcher, see catcher.h. */
typedef struct Catching {
    float part;  /* that it carries there; 0: it has come to none */
    bool alike;  /* nothing but the path's own light is known: bare is the same */
    Lanes front; /* what it has found before, */
    Lanes bare;  /* and what is found from there on where only lights and catchers are */
} Catching;

/* The same of a sample, as colours; lit: what is found from there on where all is. */
typedef struct CaughtSample {
    float part, lit[3], bare[3];
} CaughtSample;

/* The light that a sample found, before it is a colour. */
typedef struct SampleLight {
    Lanes radiance;
    WavelengthSample wavelengths;
} SampleLight;

/* What one thread needs; nothing is allocated per path but for lists that outgrow all before them. */
typedef struct Tracer {
    _Alignas(MEMORY_APART) const World *world;
    HitList hits, shadow_hits;
    HitList left;   /* the surfaces that the path's ray starts on; */
    HitList looked; /* and those of a ray that is sent out while the path waits at several */
    HitList beside; /* objects at whose edges it starts; see rtc_beside */
    HitList along;  /* for finding them, and for what was missed by a straight ray */
    HitList aimed;  /* where a straight ray comes to an operand that it is aimed at */
    HitList passed; /* silent crossings in front of those hits, found in the same search */
    NestList list, next, shadow_list;
    NestList before; /* behind what was passed */
    NestList aside;  /* of the two lists of path_turn_aside the one that is not in use */
    NestList forked; /* where the second path of a sample begins */
    NestList began;  /* where a look did, see slab_lamp.c */
    FlightParts parts;
    NestPass *passes;
    size_t passes_capacity;
    PathCounters counters;
    PixelSampler pixel;
    struct GuideLedger *ledger; /* of what a guide does that is tried out; NULL: none. Not owned */
    struct Backdrop *backdrop;  /* of what is seen past lamps, while that is found out; NULL: else. Not owned */
    struct Tracer *looker;      /* see tracer_lend; NULL: not yet needed */
    struct Tracer *barer;       /* of the world's bare one; NULL: not yet needed */
    Catching catching[2];       /* of both paths of the last sample, */
    CaughtSample caught;        /* and what that comes to; where the world has a bare one */
    SampleLight light;          /* of the last sample: nothing where it was bad */
    /* NULL, or the same of each of the scene's groups of lights: of the path that is on its way, and in the end of the sample */
    Lanes *grouped;
    Lanes groups[2][LIMIT_LIGHT_GROUPS]; /* of both paths of a sample */
    /* what the last path met first: the object, a combination's own row, or beyond these what scatters, also behind boundaries;
     * SCENE_NONE: nothing, or a light */
    uint32_t seen;
    /* in a scene with textures: at the opaque surface that the last path met first, behind boundaries, too; mean < 0: it met
     * none */
    Reflected reflected;
    bool out_of_memory;
    bool tells_groups; /* of each sample: grouped */
    bool notes_sight;  /* of each path: */
    FirstSight first_sight;
    bool notes_behind; /* and with that: */
    FirstSight behind;
} Tracer;

void tracer_init(Tracer *tracer, const World *world);
void tracer_clear(Tracer *tracer);
/* n of them, one per thread; NULL when memory ends. */
Tracer *tracers_new(const World *world, unsigned n);
/* tracers may be NULL. */
void tracers_free(Tracer *tracers, unsigned n);
/* One that works in a world while this one's path waits: *lent, made when it is first needed. It counts on from this one's counters.
 * NULL when memory ends, which this one is told. */
Tracer *tracer_lend_into(Tracer *tracer, const World *world, Tracer **lent);
/* Takes back what that has counted. */
void tracer_take_back_from(Tracer *tracer, const Tracer *lent);
/* The same of what is sent out in this one's own world. */
static inline Tracer *tracer_lend(Tracer *tracer)
{
    return tracer_lend_into(tracer, tracer->world, &tracer->looker);
}
static inline void tracer_take_back(Tracer *tracer)
{
    tracer_take_back_from(tracer, tracer->looker);
}

/* Where on the film: pixels from the top left corner, of a frame of width x height. */
typedef struct FilmPoint {
    double x, y;
    uint32_t width, height;
} FilmPoint;

/* Which sample of which pixel. */
typedef struct FilmSample {
    uint32_t x, y;          /* the pixel, from the top left corner of a frame of */
    uint32_t width, height; /* so many, */
    uint32_t seed;          /* of all random numbers, */
    uint32_t index;         /* and the sample's number among those of the pixel */
} FilmSample;

/* The first sample of the pixel in the middle of cell number i of side x side, by rows, that a frame is cut into. */
static inline FilmSample film_sample_in_cell(uint32_t i, uint32_t side, uint32_t width, uint32_t height)
{
    return (FilmSample){.x = (2 * (i % side) + 1) * width / (2 * side),
                        .y = (2 * (i / side) + 1) * height / (2 * side),
                        .width = width,
                        .height = height};
}

/* Radiance and coverage of one sample of a pixel. rgb: linear working space; alpha: 1 - what would come through of a picture behind
 * this one: 1 where an environment is seen, and anything that does not let light straight on; 0 where nothing is. Where chance decides
 * what a path meets, only its mean is between 0 and 1. What the path did and its faults are added to tracer->counters. */
void trace_sample(Tracer *tracer, const FilmSample *sample, float rgb[3], float *alpha);

/* Half of a pixel, as large as pixels are in the middle: where its ray starts, and how much more it is for each unit of the way. */
typedef struct Footprint {
    float width, spread;
} Footprint;

/* The camera's ray through a point of the film; false: nothing is to be seen there, beyond a fisheye's circle or a panorama's poles.
 * lens: uniform in [0,1)^2. An orthographic camera has a lens for each point, in the picture plane, and what is in focus is as
 * large as without. */
bool camera_ray(const SceneCamera *camera, FilmPoint point, const float lens[2], Ray *ray, Footprint *footprint);
/* The pixel of a pinhole or of a picture plane that a place is seen in, if nothing is in front of it; false: none, or another
 * projection. */
bool camera_pixel(const SceneCamera *camera, Vec3 place, uint32_t width, uint32_t height, uint32_t *x, uint32_t *y);

#endif

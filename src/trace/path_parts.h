/* path_parts.h - what a path carries along, for the files that follow it; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PATH_PARTS_H
#define MEN_PATH_PARTS_H

#include <stddef.h>
#include <string.h>

#include "optics/crystal.h"
#include "trace/guide.h"
#include "trace/light.h"
#include "trace/path.h"

/* What a path has looked up at its own wavelengths of media, for the next time: each at its number modulo PATH_MEDIA. */
enum { PATH_MEDIA = 4 };
typedef struct PathMedia {
    uint32_t absorption_of[PATH_MEDIA], ior_of[PATH_MEDIA]; /* the medium's number + 1; 0: of none yet */
    Lanes absorption[PATH_MEDIA], ior[PATH_MEDIA];
} PathMedia;

/* A stretch of a path's way on which light that media scatter was looked for, see airlight.h. */
typedef struct Airway {
    Vec3 origin;
    Vec3f direction;
    double begin, end;             /* along the ray */
    float carried, scattered_part; /* by the path; of the light on the stretch, roughly */
    float most_more;               /* by how much more often lights beside it are looked at, at most */
    float share,
        alone; /* how often it is looked at, at most; and how likely a flight goes through it without being scattered */
    float extinction; /* a mean */
    double free_path;
    const LightChoices *lights; /* that may come straight to there */
    Lanes ratio, scattered; /* at its beginning: the path's ratio, the optical depths that the flight had behind it */
    double t;               /* a place on it where a flight was scattered, */
    float rarity;           /* and 1 / the density of that; 0: there is none */
    float shaft;            /* see shaft.h: how often looks would be sent if all shares were 1; 0: there are none; */
    double shaft_all;       /* what the guide's cells scatter on the stretch; < 0: not known yet; */
    float beam;             /* see beam_ways.h: how often looks are sent where beams pass; 0: never; */
    uint32_t n_media;       /* and what fills the place, t */
    Lanes by_lane; /* the density of flights to there, of each lane in relation to the others; where rarity > 0 */
} Airway;

/* What a path is to know of the guide where it was scattered last, see probe.c. */
typedef struct PathProbing {
    GuideAt guide;      /* there; share 0: there is none */
    Vec3f direction;    /* that was chosen there, */
    float density;      /* its density, as a mean of the wavelengths, */
    float part;         /* and what light counts that it finds through glass; < 0: not known yet, */
    float ratio;        /* as the density of probes over that of the path itself is this */
    Turns turns;        /* since then; also of a photon, since its last rough surface */
    const Leads *leads; /* of a probe; else NULL */
    const Hopes *hopes; /* of a photon, */
    uint32_t step;      /* and its node of these */
    bool found;         /* what it adds next is such light */
    bool bent;          /* it has gone through a boundary since, or off a mirror */
    bool is_probe;      /* it was sent out by the guide, and looks for such light alone */
} PathProbing;

/* A way through bodies with parallel faces: see slab_look.h. */
#define SLAB_NOWHERE UINT32_MAX
typedef struct SlabWay {
    uint32_t bounce;              /* the path is on it as long as this is its own; SLAB_NOWHERE: it is not */
    uint32_t n_faces, n_mirrored; /* that it has met, and by which it was mirrored */
    uint32_t medium;              /* in front of it; */
    bool outside;                 /* that has the index of what is outside */
    bool to_and_fro;              /* all that it was mirrored by is parallel */
    Vec3f mirror;                 /* the normal of the first of that */
    uint64_t steps;               /* a hash of all faces, and of what it did there */
    Vec3 first_face;              /* where it has met that */
    Vec3f direction;              /* in front of it; and of the path, there: */
    float scatter_pdf, rarity;
    bool bent;
} SlabWay;

/* A random number by which boundaries decide, one after another. */
typedef struct Decision {
    double number; /* uniform in [0, 1), what former decisions have left of it */
    float left;    /* their probability; 0: there is no number yet, */
    bool of_pixel; /* and the first one goes with the place in the pixel */
} Decision;

typedef struct Path {
    Tracer *tracer;
    struct PathFork *fork; /* where the second path of its sample is to begin; NULL: it has none */
    Catching *catching;    /* what it finds if it comes to a shadow catcher; NULL: nobody asks, or it has come to one */
    Sampler sampler;
    WavelengthSample wavelengths;
    Lanes beta, ratio;
    Ray ray;
    Lanes radiance;                     /* from here on to `media` all is 0 at first */
    Vec3 scatter_point;                 /* where the ray's direction was last sampled */
    Vec3f scatter_normal;               /* the surface's there, if it scatters to its one side only; else zero */
    const LightChoices *scatter_lights; /* what was looked for there */
    float scatter_pdf; /* density of that per steradian; < 0: not sampled from a density (camera, boundary) */
    float sought;      /* how much denser directions such as that were chosen than by the surface alone; >= 1 */
    Decision decision; /* at the next boundary */
    uint32_t bounce;   /* events so far: each has random numbers of its own */
    uint32_t total_reflections; /* by which it came here, in a row */
    float cone_width,
        cone_spread; /* of a cone around the path: see texture_shade.c. Kept where the world has textures */
    bool cone_bent;  /* it has gone through a boundary, or off a mirror */
    /* what part of the light that it looks for is the backdrop's of the picture: see path_follow_from_camera */
    float open;
    bool straight;    /* media do not scatter it: it only looks what is there */
    bool for_light;   /* and what arrives: what they scatter counts as absorbed */
    bool looks;       /* for light that media scatter towards it */
    bool is_photon;   /* it comes from a lamp, and looks for none */
    bool bent_apart;  /* it has come to a boundary where each of its wavelengths would go on in another way, */
    bool again;       /* and this is the second path of its sample: see sample.c */
    float color;      /* of the wavelength by whose indices glass bends it, see guide_color; 0 where nobody asks */
    float colors[2];  /* those of both paths of its sample */
    int index_lane;   /* of the wavelength whose indices it takes for all of its own; < 0: each has its own */
    CrystalWave wave; /* in a crystal that refracts doubly, since it came in, or off a face of it */
    float in_front;   /* the most light that was looked for, and found, on a stretch in front of what it meets first, */
    uint32_t scatters_in_front; /* and the number of what scatters there, see Tracer.seen */
    uint32_t n_scattered;       /* in media, so far */
    uint32_t n_counted;         /* events that the scene's limit counts, the present one too: none within media */
    PathMedia media;
    PathProbing probing;
    SlabWay slab_way;
    Airway way, from; /* the present stretch; and the one that the path was scattered on last, if it was in a medium */
} Path;

/* A path that has not begun: it carries 1, and has no ray yet. What is not set here is written before it is read. */
static inline void path_init(Path *path, Tracer *tracer, Sampler sampler)
{
    memset(&path->radiance, 0, offsetof(Path, media) - offsetof(Path, radiance));
    memset(path->media.absorption_of, 0, sizeof path->media.absorption_of);
    memset(path->media.ior_of, 0, sizeof path->media.ior_of);
    path->way.share = path->way.rarity = path->way.shaft = path->way.beam = path->from.rarity = 0;
    path->tracer = tracer;
    path->sampler = sampler;
    path->beta = path->ratio = lanes_all(1);
    path->scatter_pdf = -1;
    path->sought = 1;
    path->scatter_lights = world_lights(tracer->world);
    path->probing.guide.share = 0;
    path->probing.leads = NULL;
    path->index_lane = -1;
    path->slab_way.bounce = SLAB_NOWHERE;
    path->fork = NULL;
    path->catching = NULL;
    path->probing.bent = path->probing.is_probe = path->probing.found = false;
}

/* It comes from a lamp. hopes: see turns.h; NULL: it has none. */
static inline void path_is_of_light(Path *path, const Hopes *hopes)
{
    path->is_photon = true;
    path->probing.turns = turns_none();
    path->probing.hopes = hopes;
    path->probing.step = 1;
}

/* A scattering whose density per steradian is above this sends light on almost as a smooth surface does: it is about that
 * of a roughness of 0.25. */
#define NEARLY_SMOOTH 20.0f
/* Whether the last scattering was one that guiding can find the way back through. */
static inline bool path_went_straight(const Path *path)
{
    return path->scatter_pdf < 0 || path->scatter_pdf > NEARLY_SMOOTH;
}

/* What counts of a radiance that it meets now. */
static inline Lanes path_carried(const Path *path)
{
    return lanes_scale(path->beta, 1 / lanes_mean(path->ratio));
}

/* Whether most of its light is from what scatters in front. */
static inline bool path_shows_front(const Path *path)
{
    return path->in_front > 0.5f * lanes_mean(path->radiance);
}

/* A lane that is denser than the hero at every event would leave the range of float in the end. Only the quotient of
 * both counts. */
static inline void path_keep_in_range(Path *path)
{
    const float large = 0x1p40f;
    if (LIKELY(lanes_max(path->ratio) < large)) return;
    path->beta = lanes_scale(path->beta, 1 / large);
    path->ratio = lanes_scale(path->ratio, 1 / large);
}

static inline Lanes medium_ior(const World *world, uint32_t medium, Lanes wavelength_nm)
{
    return spectrum_at(&world->scene->media[medium].ior, wavelength_nm);
}

/* The index that a path takes for its own wavelengths, looked up once. */
static inline Lanes path_ior(Path *path, uint32_t medium)
{
    const World *world = path->tracer->world;
    if (!world_medium_disperses(world, medium)) return medium_ior(world, medium, path->wavelengths.nm);
    PathMedia *kept = &path->media;
    uint32_t i = medium % PATH_MEDIA;
    if (kept->ior_of[i] != medium + 1) {
        kept->ior[i] = medium_ior(world, medium, path->wavelengths.nm);
        if (path->index_lane >= 0) kept->ior[i] = lanes_all(lanes_get(kept->ior[i], path->index_lane));
        kept->ior_of[i] = medium + 1;
    }
    return kept->ior[i];
}
/* The same of the extraordinary waves of a crystal. */
static inline Lanes path_extraordinary(const Path *path, uint32_t medium)
{
    const Lanes indices = spectrum_at(&path->tracer->world->scene->media[medium].extraordinary, path->wavelengths.nm);
    return path->index_lane >= 0 ? lanes_all(lanes_get(indices, path->index_lane)) : indices;
}

/* A density of directions that stands for those of all lanes. */
static inline float path_mean_density(const Path *path, Lanes pdf_w)
{
    return lanes_mean(lanes_mul(path->ratio, pdf_w)) / lanes_mean(path->ratio);
}
/* The same where a medium scatters. On a stretch on which light was looked for, too, lanes count as they do there, so that the weights of
 * all ways to find it add up: see airlight.h. */
static inline float path_phase_density(const Path *path, const Phase *phase, Lanes pdf_w)
{
    if (LIKELY(phase_is_grey(phase))) return lanes_get(pdf_w, 0);
    if (!(path->from.rarity > 0)) return path_mean_density(path, pdf_w);
    return lanes_mean(lanes_mul(path->from.by_lane, pdf_w)) / lanes_mean(path->from.by_lane);
}

typedef struct Event Event; /* what a path comes to: see event.h */

/* ---- path.c ---- */

/* Follows a path to its end, from where it is. */
void path_follow(Path *path);
/* The same from the camera. Where the path leaves the scene straight on, past nothing but panes and media, and no environment is to be
 * seen there, path->open is what it still carries, as a mean over wavelengths: so much would come through of another picture behind
 * this one. Else it is 0. */
void path_follow_from_camera(Path *path);
/* And from an event that it has come to. */
void path_follow_from_event(Path *path, Event *event);

/* ---- sample.c ---- */

/* Puts the path's ray at the camera, with the hulls that are around it there; false where there is nothing to look at, or when memory
 * ends, which the tracer is told. */
bool path_begin_at_camera(Path *path, FilmPoint point);
/* Keeps what the second path of its sample needs, in path->fork. */
void path_keep_fork(Path *path, const Event *event);

#endif

/* world.h - a compiled scene as the path tracer sees it: lights to choose from, the camera's own media.
 * Immutable while rendering; shared by all threads.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_WORLD_H
#define MEN_WORLD_H

#include "optics/spectral_lines.h"
#include "optics/portal.h"
#include "scene/compile.h"
#include "scene/slabs.h"
#include "trace/balances.h"
#include "trace/beacons.h"
#include "trace/emitter.h"
#include "trace/lens.h"
#include "trace/looks.h"
#include "trace/media.h"

/* What is first chosen for next-event estimation: a distant light (an entry of scene->lights), the environment, or all
 * that shines from a finite place together, among which the tree then chooses. */
#define LIGHT_ENVIRONMENT UINT32_MAX
#define LIGHT_NEAR (UINT32_MAX - 1)

/* What the radiance of light from infinity is given in, whatever it comes through: a sea may reach there, too. */
enum { WORLD_MEDIUM = NEST_WORLD_MEDIUM };

typedef struct LightChoice {
    uint32_t light;    /* index into scene->lights, LIGHT_ENVIRONMENT or LIGHT_NEAR */
    float probability; /* of being chosen */
    float cumulative;  /* of this and all before */
} LightChoice;

/* What there is to choose from for a place, by the kinds of light that may come straight to there; the probabilities of all
 * are 1 together, where there is anything. */
typedef struct LightChoices {
    LightChoice *items;
    uint32_t n;
    float *of_light;         /* probability of each distant light of the scene, */
    float environment, near; /* of the environment, and of choosing with the tree */
    bool one;                /* choosing takes no random number */
} LightChoices;
enum { REACH_FAR = 1, REACH_NEAR = 2, REACHES = 4 };

/* An opening that light of the environment comes in by. */
typedef struct WorldPortal {
    const SceneLight *light;
    Affine to_frame;      /* from the world into the opening's frame */
    const PortalMap *map; /* shared by all that are turned the same way */
} WorldPortal;

/* What is done otherwise than it always is, for tests and comparisons; all 0: nothing. */
typedef enum SamplePattern { PATTERN_SHARED, PATTERN_ALONE, PATTERN_INDEPENDENT } SamplePattern;
typedef struct Trial {
    SamplePattern pattern;      /* pixels do not share out the work: white noise; nor do the samples of one pixel */
    bool wavelengths_by_chance; /* those of one pixel are not evenly spread */
    bool choices_apart;         /* of ways, lights and lobes: no third coordinates to the places and directions */
    bool fresnel_alone;         /* boundaries reflect as often as they do, wherever lights are */
    bool frost_alone;           /* rough boundaries scatter into a body as ever, wherever lights are behind it */
    bool flights_alone;         /* media are not looked at where narrow beams go behind flat faces */
    bool hero_alone;            /* goes on where boundaries bend wavelengths apart */
    bool pairs_from_camera;     /* second paths begin there, not where wavelengths part */
    float roulette_below;       /* what paths carry that are left to chance */
} Trial;

typedef struct World {
    const CompiledScene *compiled;
    const Scene *scene;
    ObjectLook *looks;             /* of the scene's objects */
    LightChoices choices[REACHES]; /* for places that these kinds of light reach */
    /* of each medium: how far light may come straight into it, and through flat faces; see light_reach.h */
    uint8_t *reach, *reach_through;
    EmitterSet emitters;
    bool *yields; /* NULL, or of each object, whether it shines and may yield to another there; see scene/ties.h */
    WorldPortal *portals; /* where the scene has an environment that shines */
    uint32_t n_portals;
    PortalMap **portal_maps;
    uint32_t n_portal_maps;
    WorldMedia media;
    Beacons beacons;
    Slabs slabs;              /* where light from infinity is looked for */
    uint32_t *beams, n_beams; /* emitters, see beams.h; behind them in the same array */
    uint32_t *balls, n_balls;
    float *beam_looks;     /* of each beam, how often it is looked at of the times when it is chosen beside all ways */
    float mean_beam_looks; /* of all beams */
    struct BeamWay *beam_ways; /* where the narrow ones of these go, see beam_ways.h */
    uint32_t n_beam_ways;
    Balances *balances;          /* of surfaces; grows while rendering, by itself in order */
    struct World *bare;          /* NULL, or that of lights and shadow catchers alone, see catcher.h. Not owned */
    CompiledScene *own_compiled; /* of such a world; NULL: this is none */
    const struct Guide *guide;   /* to lights behind glass, see guide.h; NULL: none. Not owned */
    NestList camera_list;        /* the hulls around the camera's centre */
    bool moves;                  /* something does while the shutter is open */
    bool camera_list_moves;      /* and so the camera's hulls may be others at other times */
    /* some hull's bounds come near the lens, or the picture plane: look for each ray's real origin, */
    bool lens_crosses;
    Lens *lens;          /* but where this knows it; NULL: nowhere */
    bool has_distant;    /* a light that is infinitely far */
    bool disperses;      /* some medium does, */
    bool scatters;       /* and scatters */
    bool seeks_airlight; /* and light that it scatters is looked for, see airlight.h */
    bool no_absorption;
    Trial trial;
    bool has_panes; /* thin sheets that rays towards lights go through */
    bool has_parts; /* objects of which some parts have other surfaces */
    bool has_paint; /* boundaries that can be seen between media of one index */
    uint32_t max_bounces;
    Box3 *
        mesh_boxes; /* of each shape that is a mesh without coordinates, for texture_uv; NULL: they were not asked for */
    WavelengthLines *lines;   /* NULL: no light is one */
    ReflectedColor reflected; /* for the albedo that is seen first */
    uint32_t width, height;   /* of the picture: the film's, until render.c sets those that were asked for */
    SceneCamera camera;       /* of the scene, off the surfaces of operands that are none of their combinations */
} World;

/* pool: whose threads help, or NULL */
ATTR_NODISCARD Status world_init(World *world, const CompiledScene *compiled, uint32_t camera, uint32_t max_bounces,
                                 bool no_absorption, Pool *pool, Error *error);
/* No light is chosen any more, so that all of them are found by scattering alone; those without size are gone. */
void world_leave_to_chance(World *world);
ATTR_NODISCARD Status world_find_mesh_boxes(World *world, Error *error);
void world_clear(World *world);
/* Whether a medium's index changes with the wavelength. */
static inline bool world_medium_disperses(const World *world, uint32_t medium)
{
    return world->scene->media[medium].disperses;
}
/* Whether a boundary is a crystal's. */
static inline bool world_refracts_doubly(const World *world, uint32_t medium_from, uint32_t medium_to)
{
    const SceneMedium *media = world->scene->media;
    return media[medium_from].refracts_doubly || media[medium_to].refracts_doubly;
}
/* The wavelengths of a path, by u in [0, 1). */
static inline WavelengthSample world_wavelengths(const World *world, float u)
{
    return LIKELY(!world->lines) ? wavelengths_sample(u) : wavelength_lines_sample(world->lines, u);
}
/* What there is to choose from wherever a place is. */
static inline const LightChoices *world_lights(const World *world)
{
    return &world->choices[REACH_FAR | REACH_NEAR];
}
/* The same for a place that is in a medium, of what may come straight to there; */
static inline const LightChoices *world_lights_in(const World *world, uint32_t medium)
{
    return &world->choices[world->reach[medium]];
}
/* and of what may come there through flat faces, too. */
static inline const LightChoices *world_lights_through(const World *world, uint32_t medium)
{
    return &world->choices[world->reach_through[medium]];
}

#endif

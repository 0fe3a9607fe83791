/* path_parts.h - what the files of the path integrator share; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PATH_PARTS_H
#define MEN_PATH_PARTS_H

#include <stddef.h>
#include <string.h>

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
    uint32_t n_media;       /* and what fills the place, t */
    Lanes by_lane;          /* the density of flights to there, of each lane in relation to the others; where rarity > 0 */
} Airway;

/* What a path is to know of the guide where it was scattered last, see probe.c. */
typedef struct PathProbing {
    GuideAt guide;   /* there; share 0: there is none */
    Vec3f direction; /* that was chosen there, */
    float density;   /* its density, as a mean of the wavelengths, */
    float part;      /* and what light counts that it finds through glass; < 0: not known yet */
    bool found;      /* what it adds next is such light */
    bool bent;       /* it has gone through a boundary since, or off a mirror */
    bool is_probe;   /* it was sent out by the guide, and looks for such light alone */
} PathProbing;

/* A random number by which boundaries decide, one after another. */
typedef struct Decision {
    double number; /* uniform in [0, 1), what former decisions have left of it */
    float left;    /* their probability; 0: there is no number yet, */
    bool of_pixel; /* and the first one goes with the place in the pixel */
} Decision;

typedef struct Path {
    Tracer *tracer;
    struct PathFork *fork; /* where the second path of its sample is to begin; NULL: it has none */
    Sampler sampler;
    WavelengthSample wavelengths;
    Lanes beta, ratio;
    Ray ray;
    Lanes radiance;                     /* from here on to `media` all is 0 at first */
    Vec3 scatter_point;                 /* where the ray's direction was last sampled */
    Vec3f scatter_normal;               /* the surface's there, if it scatters to its one side only; else zero */
    const LightChoices *scatter_lights; /* what was looked for there */
    float scatter_pdf; /* density of that per steradian; < 0: not sampled from a density (camera, boundary) */
    Decision decision; /* at the next boundary */
    uint32_t bounce;   /* events so far: each has random numbers of its own */
    float cone_width,
        cone_spread; /* of a cone around the path: see texture_shade.c. Kept where the world has textures */
    bool cone_bent;  /* it has gone through a boundary, or off a mirror */
    float
        open; /* what part of the light that it looks for is the backdrop's of the picture: see path_follow_from_camera */
    bool straight;   /* media do not scatter it: it only looks what is there */
    bool looks;      /* for light that media scatter towards it */
    bool is_photon;  /* it comes from a lamp, and looks for none */
    bool bent_apart; /* it has come to a boundary where each of its wavelengths would go on in another way, */
    bool again;      /* and this is the second path of its sample: see sample.c */
    float color;     /* of the wavelength by whose indices glass bends it, see guide_color; 0 where nobody asks */
    float colors[2]; /* those of both paths of its sample */
    int index_lane;  /* of the wavelength whose indices it takes for all of its own; < 0: each has its own */
    float in_front;  /* the most light that was looked for, and found, on a stretch in front of what it meets first, */
    uint32_t scatters_in_front; /* and the number of what scatters there, see Tracer.seen */
    uint32_t n_scattered;       /* in media, so far */
    uint32_t n_counted;         /* of the events, the ones that the scene's limit counts: not scattering within media */
    PathMedia media;
    PathProbing probing;
    Airway way, from; /* the present stretch; and the one that the path was scattered on last, if it was in a medium */
} Path;

/* A path that has not begun: it carries 1, and has no ray yet. What is not set here is written before it is read. */
static inline void path_init(Path *path, Tracer *tracer, Sampler sampler)
{
    memset(&path->radiance, 0, offsetof(Path, media) - offsetof(Path, radiance));
    memset(path->media.absorption_of, 0, sizeof path->media.absorption_of);
    memset(path->media.ior_of, 0, sizeof path->media.ior_of);
    path->way.share = path->way.rarity = path->way.shaft = path->from.rarity = 0;
    path->tracer = tracer;
    path->sampler = sampler;
    path->beta = path->ratio = lanes_all(1);
    path->scatter_pdf = -1;
    path->scatter_lights = world_lights(tracer->world);
    path->probing.guide.share = 0;
    path->index_lane = -1;
    path->fork = NULL;
    path->probing.bent = path->probing.is_probe = path->probing.found = false;
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

typedef enum EventKind {
    EVENT_LOST,
    EVENT_ESCAPE,
    EVENT_OPAQUE,
    EVENT_BOUNDARY,
    EVENT_SCATTER,
    EVENT_GIVE_UP
} EventKind;

/* What leads to the list behind an event's surfaces. */
typedef enum EventBehind {
    BEHIND_IN_NEXT,  /* it is tracer->next */
    BEHIND_AT_POINT, /* the event's step's point, from tracer->list: hulls are kept as bits */
    BEHIND_BY_STEP   /* the event's step */
} EventBehind;

typedef struct Event {
    EventKind kind;
    Hit hit;          /* the surface to be shaded */
    size_t n_cluster; /* surfaces at that place: tracer->hits[0 .. n) */
    NestCrossing crossing;
    bool clear; /* of the reading of the surfaces there: it does not contradict the list */
    EventBehind behind;
    NestStep step;
    NestPoint before; /* where hulls are kept as bits and some were passed: in front of the surfaces */
    double t;         /* EVENT_SCATTER: how far along the ray, */
    uint32_t medium;  /* and what scatters there; else what fills the way to the surfaces */
} Event;

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

/* The boundary, of one surface, where a sample's first path comes to be bent apart, for the second one to go on from there: the path in
 * front of it, and the event; the list in front is tracer->forked. See sample.c. */
typedef struct PathFork {
    bool kept;
    Path path;
    Event event;
} PathFork;

/* ---- event.c ---- */

/* tracer->list becomes the one behind the event's surfaces. */
static inline void path_go_behind(Tracer *tracer, const Event *event)
{
    if (LIKELY(event->behind == BEHIND_AT_POINT))
        tracer->list.point = event->step.point;
    else if (event->behind == BEHIND_BY_STEP)
        nest_step(&tracer->list, &event->step);
    else
        nest_list_swap(&tracer->list, &tracer->next);
}
/* The same list, made in another one. */
static inline Status path_copy_behind(const Tracer *tracer, const Event *event, NestList *list)
{
    if (event->behind == BEHIND_IN_NEXT) return nest_list_copy(list, &tracer->next);
    TRY(nest_list_copy(list, &tracer->list));
    if (event->behind == BEHIND_AT_POINT)
        list->point = event->step.point;
    else
        nest_step(list, &event->step);
    return STATUS_OK;
}

/* tracer->list is the one at a t of the path's ray, up to its next event, until path_turn_back is called; false when memory
 * ends, and then it is as before. Where *t is in the midst of several surfaces at one place, it becomes the end of that. */
bool path_turn_aside(Tracer *tracer, double *t);
void path_turn_back(Tracer *tracer);
/* Crosses the hulls among hits[0 .. n), all at one place. */
bool path_cross(Tracer *tracer, NestList *list, const Hit *hits, size_t n, NestCrossing *crossing);
/* tracer->next becomes the list behind the event's surfaces, from tracer->list on; false when memory ends. */
bool path_cross_into_next(Tracer *tracer, const Event *event);
/* Follows the path's ray through silent crossings to its next event. Absorption goes into beta. At a boundary
 * tracer->list is the list before it and tracer->next the one behind it. */
void path_next_event(Path *path, Event *event);
/* The list of a ray that starts at several surfaces which stand at one place but are not parallel, say where two
 * hulls' surfaces cross: each of them is crossed, or not, by where the ray starts and goes. */
bool path_cross_towards(Tracer *tracer, const Ray *ray, NestList *list);
/* Transmittance of a straight shadow ray from the path's place; false when something blocks it. Opaque
 * objects and visible boundaries block: light that crosses a boundary arrives by paths that are bent there.
 * tracer->shadow_list is then the list at its end. */
bool path_shadow(Path *path, Ray *ray, Lanes *transmittance, uint32_t *medium_at_light);

/* ---- sight.c ---- */

/* What a path from the camera has come to. */
void sight_note(const Path *path, const Event *event, FirstSight *sight);
/* What the camera's ray would meet first if no medium scattered it, and what it sees behind what is clear, into the tracer's sights. The
 * path stays as it is, and nothing of it counts. */
void sight_look(const Path *path);

/* ---- shade.c ---- */

/* A surface by its number, or one of those that it is a mix of, by its weight. */
const SceneSurface *path_surface_of_mix(const Path *path, const Event *event, const SceneSurface *surface);
static inline const SceneSurface *path_surface(const Path *path, const Event *event, uint32_t number)
{
    const SceneSurface *surface = &path->tracer->world->scene->surfaces[number];
    return LIKELY(!surface->mixed) ? surface : path_surface_of_mix(path, event, surface);
}

/* Where a surface is met. Both normals are on the side that the path comes from. */
typedef struct SurfacePlace {
    Vec3 position;
    Vec3f normal, geometric; /* for shading: on the geometric one's side, and against the path's direction */
    bool apart; /* it is on the path's ray, in front of the surfaces that that has come to: rays start in free space */
} SurfacePlace;
SurfacePlace path_place_of(const World *world, const Ray *ray, const Hit *hit);
static inline SurfacePlace path_place(const Path *path, const Event *event)
{
    return path_place_of(path->tracer->world, &path->ray, &event->hit);
}
/* A light to look at from a place; choices, normal: as light_sample takes them. */
void path_choose_light(const Path *path, const LightChoices *choices, Vec3 from, Vec3f normal, LightSample *light);
/* What may be chosen where the path is scattered. any: whatever the medium: light may come from the other side of a surface, or
 * several surfaces are there. */
static inline const LightChoices *path_lights(const Path *path, bool any)
{
    const World *world = path->tracer->world;
    return any ? world_lights(world) : world_lights_in(world, nest_medium(&path->tracer->list));
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
/* What comes straight along the ray from a light, as basic radiance; false: nothing. The ray becomes aimed at the light. */
bool path_light_arrives(Path *path, const LightSample *light, Ray *ray, Lanes *basic);
/* Adds that, scattered by the factor, weighted against finding the light by a direction of density pdf_w, or by the guide. */
void path_add_direct_light(Path *path, const LightSample *light, Ray *ray, Lanes scattered, float pdf_w);
/* A ray from the place of an event's surfaces, through them (not where the place is apart) or back; next may be the path's own. Not
 * for the place of a boundary of several hulls: see path_cross_towards. */
static inline void path_start_ray(const Path *path, Event *event, const SurfacePlace *place, bool through,
                                  Vec3f direction, Ray *next)
{
    Tracer *tracer = path->tracer;
    if (UNLIKELY(place->apart)) {
        double time = path->ray.time;
        ray_begin(next, place->position, direction);
        next->time = time;
    } else {
        rtc_leave(tracer->world->compiled->rtc, &path->ray, tracer->hits.items, &event->n_cluster, through, direction,
                  next);
    }
}
/* Sends the path on from the surfaces that it has come to: through them, or back. */
void path_leave(Path *path, Event *event, const SurfacePlace *place, bool through, Vec3f direction);
/* Radiance given in a medium, as basic radiance. */
Lanes path_basic_radiance(const World *world, Lanes radiance, uint32_t medium, Lanes wavelength_nm);
/* Adds what reaches the camera of a radiance seen at the end of the path. */
void path_add_radiance(Path *path, Lanes factor, Lanes basic);
/* The reflectance of an opaque surface where it was hit, at all the wavelengths of a ReflectedColor. */
void path_albedos(const Path *path, const Event *event, const SceneSurface *surface,
                  const Lanes wavelength_nm[COLOR_FOURS], Lanes albedo[COLOR_FOURS]);
/* A place within a medium where the path is scattered. */
void path_scatter_in_medium(Path *path, const Event *event);

/* ---- probe.c ---- */

/* What part of a guide's probes a place is worth: as much as the path carries; the same for any hero. In a dense medium there are
 * many such places one after another, of which the first ones count most; and where it is one that is looked at, too, the
 * part is the same for the whole stretch, way, however the path comes there. */
static inline float path_probe_part(const Path *path, const Airway *way, bool in_medium)
{
    if (UNLIKELY(in_medium && way->shaft > 0)) return way->carried / (float)(1 + path->n_scattered);
    float part = float_min(lanes_mean(path->beta) / lanes_mean(path->ratio), 1);
    return in_medium ? part / (float)(1 + path->n_scattered) : part;
}
/* The guide of a place where the path is to be scattered, in a medium or not. */
static inline GuideAt path_guide(const Path *path, Vec3 place, bool in_medium)
{
    const Guide *guide = path->tracer->world->guide;
    if (LIKELY(!guide) || path->probing.is_probe) return (GuideAt){.share = 0};
    GuideAt at = guide_find(guide, place, path->color);
    float part = path_probe_part(path, &path->from, in_medium);
    if (UNLIKELY(path->tracer->ledger) && at.share > 0 && !path->again)
        guide_note(path->tracer->ledger, &at, GUIDE_VISIT, part, lanes_mean(path->beta) / lanes_mean(path->ratio));
    at.sent = at.share *= part;
    return at;
}
/* What comes now depends on the guide's directions, which may be others for the second path of the sample: it begins at the camera
 * then, unless it parted from this one before. */
static inline void path_is_guided(Path *path, const GuideAt *guide)
{
    path->bent_apart = path->bent_apart || guide->cell->parts_colors;
}
/* Whether a probe is to be sent out from there, and whereto. */
bool path_ask_guide(Path *path, const GuideAt *guide, Vec3f *direction);
/* Sends it, from the event's surfaces (through them, or back) or from a place in a medium (event NULL; the place is apart).
 * scattered: what is scattered from there, times the cosine; pdf_w: the density of the path's own choice, as a mean of the
 * wavelengths. */
void path_send_probe(Path *path, const GuideAt *guide, Event *event, const SurfacePlace *place, bool through,
                     Vec3f direction, Lanes scattered, float pdf_w);
/* The path goes on from a place where it was scattered, in a direction of that density. */
static inline void path_leave_guide(Path *path, const GuideAt *guide, Vec3f direction, float pdf_w)
{
    path->decision = (Decision){.left = 0};
    if (path->probing.is_probe) return;
    path->probing.guide.share = guide->share;
    if (UNLIKELY(guide->share > 0))
        path->probing = (PathProbing){.guide = *guide, .direction = direction, .density = pdf_w, .part = -1};
}
float path_weigh_probing(Path *path, float radiance);
void path_note_found(Path *path, Lanes light);
/* What light of a radiance (a mean of the wavelengths) counts that the path finds by itself, not by looking at it: against
 * finding it by a probe. */
static inline float path_found_part(Path *path, float radiance)
{
    return LIKELY(path->probing.guide.share == 0) ? 1 : path_weigh_probing(path, radiance);
}
/* Follows a path to its end, from where it is (path.c). */
void path_follow(Path *path);
/* The same from the camera. Where the path leaves the scene straight on, past nothing but panes and media, and no environment is to be
 * seen there, path->open is what it still carries, as a mean over wavelengths: so much would come through of another picture behind
 * this one. Else it is 0. */
void path_follow_from_camera(Path *path);
/* And from an event that it has come to. */
void path_follow_from_event(Path *path, Event *event);
/* Keeps what the second path of its sample needs, in path->fork (sample.c). */
void path_keep_fork(Path *path, const Event *event);
/* What an opaque surface that was hit shines by itself. */
void path_add_emission(Path *path, const Hit *hit);
/* A hit of an opaque surface. Returns whether the path goes on. */
bool path_shade_opaque(Path *path, Event *event);
/* A boundary between two dielectrics. Where it is smooth, one of the two ways is taken, with the probability of the
 * hero's Fresnel reflectance. Returns whether the path goes on. */
bool path_cross_boundary(Path *path, Event *event);

/* A direction mirrored by the surface as it is. */
static inline Vec3f path_mirror(const SurfacePlace *place, Vec3f direction)
{
    return vec3f_along(direction, -2 * vec3f_dot(direction, place->geometric), place->geometric);
}
/* Whether the shading normal is another than the geometric one. */
static inline bool path_is_bent(const SurfacePlace *place)
{
    return vec3f_dot(place->normal, place->geometric) < 0.999999f;
}

/* ---- texture_shade.c ---- */

/* The cone around the path, as wide as it is where the event is. */
void path_reach(Path *path, const Event *event);
/* Where the path goes on after an event: the cone around it widens with the directions that it could have taken. */
void path_widen(Path *path);
/* A shading normal such that nothing that comes from `view` is mirrored into the surface. */
Vec3f path_bend_normal(Vec3f view, Vec3f geometric, Vec3f normal);
/* What bumps and normal maps make of the shading normal; footprint: the size of what need not be told apart. At smooth
 * boundaries it is 0: a normal that depends on how far a path has come would let light into total reflections that it
 * never gets out of. */
void path_relief(const Path *path, const Event *event, const SceneSurface *surface, double footprint,
                 SurfacePlace *place);
/* The parameters that a surface with textures has where it was hit, for the four wavelengths given and no others; and
 * what path_relief does. */
void path_read_textures(const Path *path, const Event *event, const SceneSurface *surface, SurfacePlace *place,
                        Lanes wavelength_nm, BsdfSpec *spec);
/* path_albedos of a surface with textures. */
void path_read_albedos(const Path *path, const Event *event, const SceneSurface *surface,
                       const Lanes wavelength_nm[COLOR_FOURS], Lanes albedo[COLOR_FOURS]);

/* How bright it is where light would come from: mirrored at a boundary, and refracted by it, or straight on where both sides
 * are of index eta_i. It is taken that what the light then leaves by is parallel to the boundary, and leads to the world's
 * own medium. The same whatever wavelength is the hero. False: no difference between the two is known. */
bool path_look_ahead(Path *path, const SurfacePlace *place, Lanes eta_i, float brightness[2]);

/* ---- shade_bsdf.c ---- */

/* An opaque surface that is more than matte, and its parameters there; false: the path ends. *straight: it has gone
 * through a pane, as rays towards lights do. It counts as on its way from where it was scattered before, so that what it finds
 * is weighted against light sampling from there. */
bool path_shade_finished(Path *path, Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                         const SurfacePlace *place, bool *straight);
/* What the panes among n surfaces at one place leave of a straight ray; medium: around them. */
Lanes path_pass_panes(const Path *path, const Ray *ray, const Hit *hits, size_t n, uint32_t medium);
/* A boundary between two media that is rough, or not clear in all parts; false: the path ends. */
bool path_cross_rough(Path *path, Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                      const SurfacePlace *place, Lanes eta_i, Lanes eta_t);

#endif

/* shade_bsdf.c - surfaces that are more than matte, and boundaries that are rough.
 *
 * Directions are sampled for the hero; a Bsdf says for every lane how dense they would have been with that one as the
 * hero, which goes into the path's ratio. Against light sampling, directions count with the mean of these densities
 * over the lanes, by their ratios: with that the weights of both techniques add up to one for every wavelength.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/shade_bsdf.h"

#include "base/angle.h"
#include "optics/balance.h"
#include "optics/bsdf_spec.h"
#include "optics/sampling.h"
#include "scene/ties.h"
#include "trace/event.h"
#include "trace/probe.h"
#include "trace/texture_shade.h"

/* The local frame of a Bsdf about a normal. */
typedef struct Frame {
    Vec3f x, y, z;
} Frame;

static Frame frame_about(Vec3f normal)
{
    Frame frame = {.z = normal};
    sampling_basis(normal, &frame.x, &frame.y);
    return frame;
}

static Vec3f to_local(const Frame *frame, Vec3f v)
{
    return vec3f(vec3f_dot(v, frame->x), vec3f_dot(v, frame->y), vec3f_dot(v, frame->z));
}

static Vec3f from_local(const Frame *frame, Vec3f v)
{
    return vec3f_along(vec3f_along(vec3f_scale(frame->x, v.x), v.y, frame->y), v.z, frame->z);
}

/* The side of a surface that takes light from one side only; else zero. */
static Vec3f one_side(const Bsdf *bsdf, const SurfacePlace *place)
{
    return bsdf->transmits ? vec3f(0, 0, 0) : place->geometric;
}

/* What a Bsdf does with light between two directions, the second in the world. A lobe about the shading normal that reaches
 * through to the other side of the surface as it is, is mirrored back to its own: nothing leaks, and none of the light is
 * lost. So two of the lobe's directions come to one. */
static void evaluate(const Bsdf *bsdf, const SurfacePlace *place, const Frame *frame, Vec3f view, Vec3f direction,
                     Lanes *f_cos, Lanes *pdf_w)
{
    bool below = vec3f_dot(direction, place->geometric) < 0;
    *f_cos = *pdf_w = lanes_all(0);
    if (below && !bsdf->transmits) return;
    Vec3f local = to_local(frame, direction);
    if (below == (local.z < 0)) bsdf_evaluate(bsdf, view, local, f_cos, pdf_w);
    if (!path_is_bent(place)) return;
    local = to_local(frame, path_mirror(place, direction));
    if (below != (local.z < 0)) return;
    Lanes more, more_pdf;
    bsdf_evaluate(bsdf, view, local, &more, &more_pdf);
    *f_cos = lanes_add(*f_cos, more);
    *pdf_w = lanes_add(*pdf_w, more_pdf);
}

static void add_light(Path *path, Event *event, const Bsdf *bsdf, const SurfacePlace *place, const Frame *frame,
                      Vec3f view, bool keen, const LightSample *light)
{
    if (!(light->pdf_w > 0)) return;
    Lanes f_cos, pdf_w;
    evaluate(bsdf, place, frame, view, light->direction, &f_cos, &pdf_w);
    if (lanes_zero(f_cos)) return;
    bool below = vec3f_dot(light->direction, place->geometric) < 0;
    Ray ray;
    path_start_ray(path, event, place, below, light->direction, &ray);
    if (keen) f_cos = lanes_scale(f_cos, path_found_part(path, INFINITY));
    path_add_direct_light(path, light, &ray, f_cos, path_mean_density(path, pdf_w));
    path->probing.found = false;
}

/* keen: this is on the way from where the path was scattered last. *looks, of pdf_w 0, become those that were sent. */
static void look_at_light(Path *path, const LookPlace *from, const Bsdf *bsdf, const Frame *frame, Vec3f view,
                          bool keen, LightLooks *looks)
{
    if (bsdf->specular_only) return;
    path_look_at_light(path, from, looks);
    for (uint32_t i = 0; i < looks->n; i++)
        add_light(path, from->event, bsdf, from->place, frame, view, keen, &looks->lights[i]);
}

/* ---- light behind frosted glass ---- */

/* A light behind a body of rough boundaries is looked for at the far one, but which of the directions in the body lead to it from
 * there is known here, if the far boundary is taken to be parallel to this one and as rough: those in which light from there would
 * be sent on by this one, all being mirrored at its tangent plane. For the light that was looked at here, whichever that is, a part
 * of the directions are chosen so, and the others as ever. Each counts by the density of both together, which holds wherever the
 * boundaries are; where they are otherwise, there is no gain.
 *
 * Photons land on frosted glass, too, and where they do the guide knows in which directions the light is. Probes that pass it take
 * up to half of their directions from there, as they look for such light alone; paths whose probes look through it up to half as many
 * as the guide sends probes there, for they look for all else, too; and both the fewer, the less keen the guide is than the frost.
 * Of the whole picture of a small lamp in a globe above a floor the squared error is 0.16 to 0.29 of what it is without, after as
 * many samples and in 1 to 1.2 times the time, where the globe is frosted outside by 0.2 to 0.4; where it is on both sides, the same
 * at 0.1, and 0.63 at 0.2 and 0.35. Of a solid ball and block it is the same, where half of those paths' directions would make it
 * twice that, as half of the probes' would where globes are frosted on both sides by 0.1. */
typedef struct Aim {
    Vec3f view;    /* towards the light, mirrored, in the local frame; */
    float share;   /* how often directions are chosen by it, */
    GuideAt guide; /* and by this, its share */
} Aim;

static float aimed_share(const Aim *aim)
{
    return aim->share + aim->guide.share;
}

/* About that which the lobe of a rough boundary, its only one, fills. */
static float solid_angle(const Bsdf *bsdf)
{
    const BsdfFacets *facets = &bsdf->lobes[0].as.boundary.facets;
    return (float)MEN_PI * facets->alpha_x * facets->alpha_y;
}

static void aim_at_light(const Bsdf *bsdf, const SurfacePlace *place, const Frame *frame, const LightSample *light,
                         Aim *aim)
{
    const float most = 0.2f; /* of 0.5 a solid body, where it does not help, has a quarter more noise; of this 3 % */
    const BsdfLobe *lobe = &bsdf->lobes[0];
    if (!(light->pdf_w > 0) || !(lanes_get(lobe->as.boundary.eta_t, 0) > lanes_get(lobe->as.boundary.eta_i, 0))) return;
    Vec3f local = to_local(frame, light->direction);
    if (!(local.z < 0) || !(vec3f_dot(light->direction, place->geometric) < 0)) return;
    float spread = solid_angle(bsdf);
    aim->view = vec3f(local.x, local.y, -local.z);
    aim->share = light->delta ? most : most * light->pdf_w * spread / (1 + light->pdf_w * spread);
}

static void aim_by_guide(Path *path, const Bsdf *bsdf, const SurfacePlace *place, Aim *aim)
{
    const float most = 0.5f;
    const Guide *guide = path->tracer->world->guide;
    if (LIKELY(!guide) || !(path->probing.is_probe || path->probing.guide.share > 0)) return;
    GuideAt at = guide_find(guide, place->position, true, path->color);
    if (!(at.share > 0)) return;
    float keener = at.cell->keenness * solid_angle(bsdf);
    aim->guide = at;
    aim->guide.share = most * (path->probing.is_probe ? 1 : at.share) * keener / (1 + keener);
    path_is_guided(path, &at);
}

/* For what is rough and nothing else: all directions have densities then. keen: see is_keen. */
static void take_aim(Path *path, const Event *event, const Bsdf *bsdf, const SurfacePlace *place, const Frame *frame,
                     bool keen, const LightSample *light, Aim *aim)
{
    aim->share = aim->guide.share = 0;
    bool rough = event->kind == EVENT_BOUNDARY && bsdf->n_lobes == 1 && bsdf->lobes[0].kind == BSDF_BOUNDARY &&
                 !bsdf->specular_only && bsdf->coat_share == 0;
    if (!rough || path->is_photon || path->tracer->world->trial.frost_alone) return;
    aim_at_light(bsdf, place, frame, light, aim);
    if (keen) aim_by_guide(path, bsdf, place, aim);
}

static Vec3f mirrored_back(Vec3f v)
{
    return vec3f(-v.x, -v.y, v.z);
}

/* The density of bsdf_sample becomes that of all techniques; false: the direction leads nowhere. */
static bool weigh_aimed(const Bsdf *bsdf, const SurfacePlace *place, const Frame *frame, Vec3f view, const Aim *aim,
                        Vec3f direction, BsdfSample *sample, Lanes *own_pdf)
{
    Lanes f_cos, ignored, aimed = lanes_all(0);
    Vec3f local = to_local(frame, direction);
    bool below = vec3f_dot(direction, place->geometric) < 0;
    evaluate(bsdf, place, frame, view, direction, &f_cos, own_pdf);
    if (aim->share > 0 && below && local.z < 0) bsdf_evaluate(bsdf, aim->view, mirrored_back(local), &ignored, &aimed);
    Lanes pdf_w = lanes_add(lanes_scale(*own_pdf, 1 - aimed_share(aim)), lanes_scale(aimed, aim->share));
    if (aim->guide.share > 0) pdf_w = lanes_add(pdf_w, lanes_all(aim->guide.share * guide_pdf(&aim->guide, direction)));
    float hero = lanes_get(pdf_w, 0);
    if (!(hero > 0)) return false;
    sample->pdf_w = pdf_w;
    sample->weight = lanes_scale(f_cos, 1 / hero);
    return true;
}

/* Whether it sends light on almost as a smooth surface does, whatever the direction: photons go on behind it, and so do
 * probes. What goes through a boundary is bent, and so scattered less than what is mirrored. Of a lamp in a frosted globe, of a
 * roughness of 0.3, the squared error is a sixth for that with as many samples, and less than half after equal time; of a
 * roughness of 0.4 a quarter, and two thirds. */
static bool is_keen(const Bsdf *bsdf)
{
    const float mirror_alpha = 0.0625f, boundary_alpha = 0.17f;
    if (bsdf->specular_only) return true;
    if (bsdf->fuzz.share > 0 || bsdf->coat_share > 0) return false;
    for (uint32_t i = 0; i < bsdf->n_lobes; i++) {
        const BsdfLobe *lobe = &bsdf->lobes[i];
        const BsdfFacets *facets = lobe->kind == BSDF_CONDUCTOR  ? &lobe->as.conductor.facets
                                   : lobe->kind == BSDF_BOUNDARY ? &lobe->as.boundary.facets
                                   : lobe->kind == BSDF_SHEET    ? &lobe->as.sheet.facets
                                                                 : NULL;
        float most = lobe->kind == BSDF_BOUNDARY ? boundary_alpha : mirror_alpha;
        if (!facets || (!facets->smooth && float_max(facets->alpha_x, facets->alpha_y) > most)) return false;
    }
    return true;
}

/* Whether it is but passed on the way from where the path was scattered last, or from the camera; else *guide is what is known of it.
 * A keen boundary is where light is looked for only if no place further back has a guide, whose probes look through it. */
static bool passes_on(const Path *path, const Event *event, const Bsdf *bsdf, GuideAt *guide)
{
    const bool keen = is_keen(bsdf), looked_through = path->probing.is_probe || path->probing.guide.share > 0;
    if (keen && (bsdf->specular_only || event->kind != EVENT_BOUNDARY || looked_through)) return true;
    *guide = path_guide(path, ray_point(&path->ray, event->hit.t), event->kind);
    return keen && !(guide->share > 0);
}

/* A probe in a direction that the guide has chosen. */
static void send_probe(Path *path, const GuideAt *guide, const LookPlace *from, const Bsdf *bsdf, const Frame *frame,
                       Vec3f view, Vec3f direction)
{
    Event *event = from->event;
    const SurfacePlace *place = from->place;
    Lanes f_cos, pdf_w;
    bool through = vec3f_dot(direction, place->geometric) < 0;
    evaluate(bsdf, place, frame, view, direction, &f_cos, &pdf_w);
    if (lanes_zero(f_cos) || (through && event->kind == EVENT_OPAQUE && !path_cross_into_next(path->tracer, event)))
        return;
    path_send_probe(path, guide, from, &(ProbeWay){direction, through, f_cos, path_mean_density(path, pdf_w)});
}

/* A direction to go on in. *own_pdf: its density by the surface alone. false: into none. */
static bool choose_direction(Path *path, const Bsdf *bsdf, const SurfacePlace *place, const Frame *frame, Vec3f view,
                             const Aim *aim, BsdfSample *sample, Vec3f *direction, Lanes *own_pdf)
{
    float u[2];
    uint32_t digits = sampler_3d(&path->sampler, sampler_dimension(path->bounce, DIM_SCATTER), u);
    if (UNLIKELY(path->tracer->world->trial.choices_apart))
        digits = sampler_digits(&path->sampler, sampler_dimension(path->bounce, DIM_LOBE));
    float choice = hash_to_unit_f(digits);
    if (UNLIKELY(choice < aim->share)) {
        if (!bsdf_sample(bsdf, aim->view, choice / aim->share, u, sample) || !sample->transmitted) return false;
        *direction = vec3f_normalize(from_local(frame, mirrored_back(sample->direction)));
        if (!(vec3f_dot(*direction, place->geometric) < 0)) return false;
    } else if (UNLIKELY(choice < aimed_share(aim))) {
        *direction = guide_sample(&aim->guide, (choice - aim->share) / aim->guide.share, u);
        sample->specular = false;
        sample->transmitted = vec3f_dot(*direction, place->geometric) < 0;
    } else {
        choice = float_min((choice - aimed_share(aim)) / (1 - aimed_share(aim)), 0x1.fffffep-1f);
        if (!bsdf_sample(bsdf, view, choice, u, sample)) return false;
        *direction = vec3f_normalize(from_local(frame, sample->direction));
        /* which side the new ray is on is the geometry's to say */
        if ((vec3f_dot(*direction, place->geometric) < 0) != sample->transmitted)
            *direction = path_mirror(place, *direction);
    }
    if (UNLIKELY(aimed_share(aim) > 0)) return weigh_aimed(bsdf, place, frame, view, aim, *direction, sample, own_pdf);
    *own_pdf = sample->pdf_w;
    if (!sample->specular && path_is_bent(place)) {
        Lanes f_cos;
        evaluate(bsdf, place, frame, view, *direction, &f_cos, own_pdf);
    }
    return true;
}

/* Whether it goes on as if nothing were there: through a sheet, or past paint within one medium. */
static bool goes_straight(const Event *event, const BsdfSample *sample)
{
    return sample->specular && sample->transmitted && event_keeps_medium(event);
}

/* Light that has gone through a sheet is bent at the boundary in which that lies, and straight looks do not go there. */
static bool cross_behind_sheet(Path *path, Event *event)
{
    path->scatter_pdf = -1;
    path->probing.bent = true;
    path->bounce++; /* the boundary has random numbers of its own */
    path->slab_way.bounce = SLAB_NOWHERE;
    bool goes_on = path_cross_boundary(path, event);
    path->slab_way.bounce = SLAB_NOWHERE;
    return goes_on;
}

static bool scatter(Path *path, Event *event, Bsdf *bsdf, const SurfacePlace *place, const Frame *frame, bool *straight)
{
    Vec3f view = to_local(frame, vec3f_negate(path->ray.direction)), direction;
    const CrystalWave wave = path->wave;
    path->wave = CRYSTAL_UNPOLARIZED; /* of what is scattered here, and looked for from here */
    bsdf_look(bsdf, view);
    GuideAt guide = {.share = 0};
    const LightChoices *lights = path_lights(path, bsdf->transmits || event->n_cluster > 1);
    const LookPlace from = {event, place, lights, one_side(bsdf, place)};
    const bool keen = passes_on(path, event, bsdf, &guide);
    if (keen)
        path->probing.bent |= !bsdf->specular_only;
    else if (UNLIKELY(path_ask_guide(path, &guide, &direction)))
        send_probe(path, &guide, &from, bsdf, frame, view, direction);
    LightLooks looks;
    looks.lights[0].pdf_w = 0;
    if (LIKELY(keen || !path->probing.is_probe)) look_at_light(path, &from, bsdf, frame, view, keen, &looks);
    Aim aim;
    take_aim(path, event, bsdf, place, frame, keen, &looks.lights[0], &aim);
    BsdfSample sample;
    Lanes pdf_w;
    if (!choose_direction(path, bsdf, place, frame, view, &aim, &sample, &direction, &pdf_w) ||
        UNLIKELY(path->probing.is_probe && !keen && !sample.specular))
        return false;
    if (sample.transmitted && event->kind == EVENT_OPAQUE && !path_cross_into_next(path->tracer, event)) return false;
    float hero = lanes_get(sample.pdf_w, 0);
    if (!(hero > 0) || lanes_zero(sample.weight)) return false;
    bool on = sample.specular && sample.transmitted && event->kind == EVENT_OPAQUE;
    const bool sight = UNLIKELY(on) && path->ray.sight && vec3f_dot(direction, path->ray.direction) > 1 - 0x1p-16f;
    *straight = on && *straight;
    if (UNLIKELY(*straight)) {
        direction = path->ray.direction;
    } else {
        path->scatter_pdf = sample.specular ? -1 : path_mean_density(path, pdf_w);
        path->scatter_point = place->position;
        path->scatter_normal = from.normal;
        path->scatter_lights = lights;
        if (keen || sample.specular)
            path->probing.bent = true;
        else
            path_leave_guide(path, &guide, direction, path->scatter_pdf);
        if (LIKELY(!path->probing.is_probe)) path->sought = 1;
        if (UNLIKELY(aimed_share(&aim) > 0) && path->scatter_pdf > 0)
            path->sought *= float_max(path_mean_density(path, sample.pdf_w) / path->scatter_pdf, 1);
    }
    path->beta = lanes_mul(path->beta, sample.weight);
    path->ratio = lanes_mul(path->ratio, lanes_scale(sample.pdf_w, 1 / hero));
    if (UNLIKELY(on && event->n_cluster > 1) && path_passes_into_boundary(path, event)) {
        *straight = false;
        path->wave = wave;
        return cross_behind_sheet(path, event);
    }
    path_leave(path, event, place, sample.transmitted, direction);
    if (goes_straight(event, &sample)) path->wave = wave;
    path->ray.sight = sight;
    return true;
}

/* x across the scratches, as they tilt facets that way; any frame where there are none. */
static Frame frame_of(const Path *path, const Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                      const SurfacePlace *place)
{
    Frame frame = frame_about(place->normal);
    if (spec->specular_roughness_anisotropy == 0 && spec->coat_roughness_anisotropy == 0) return frame;
    RtcCoordinates at;
    Affine to_world;
    rtc_coordinates(path->tracer->world->compiled->rtc, &path->ray, &event->hit, false, &at);
    if (!affine_invert(&at.to_local, &to_world)) return frame;
    Vec3 along = surface->grain == GRAIN_AROUND
                     ? vec3(at.local.z, 0, -at.local.x)
                     : vec3(surface->grain == GRAIN_X, surface->grain == GRAIN_Y, surface->grain == GRAIN_Z);
    Vec3f scratch = vec3f_from(vec3_normalize(affine_vector(&to_world, along)));
    Vec3f across = vec3f_cross(scratch, frame.z);
    float length = vec3f_length(across);
    if (!(length > 1e-4f)) return frame; /* the axis of a lathe, or an end of a straight grain */
    across = vec3f_scale(across, 1 / length);
    Vec3f beside = vec3f_cross(frame.z, across);
    /* turned as seen from outside of the object as it was described: scratches stay where they are when they are looked at from
     * within, and a mirrored object is the mirror image */
    const bool mirrored = affine_determinant(&to_world) < 0;
    float c = (float)cos(surface->grain_angle),
          s = (float)sin(surface->grain_angle) * (event->hit.entering != mirrored ? 1.0f : -1.0f);
    frame.x = vec3f_along(vec3f_scale(across, c), s, beside);
    frame.y = vec3f_cross(frame.z, frame.x);
    return frame;
}

/* The index of what is around a surface. A rough one takes one for all wavelengths, the one that its balance is made for: what its
 * facets reflect is tabulated about one critical angle, and with four of them no wavelength would get back what it gives: white
 * skins in flint were 8 % too red and 7 % too dark in blue. What a skin reflects more or less by the index of another
 * wavelength is little: at 450 nm, in a glass of cauchy(1.7, .03), no difference was seen within a thousandth. */
static Lanes index_around(const World *world, uint32_t medium, const BsdfSpec *spec, Lanes nm)
{
    const bool rough = spec->specular_roughness > 0 || spec->coat_roughness > 0;
    return medium_ior(world, medium, rough && world_medium_disperses(world, medium) ? lanes_all(BALANCE_NM) : nm);
}

/* Returns the index of what is around. */
static inline Lanes make_finished(Path *path, const SceneSurface *surface, const BsdfSpec *spec, Bsdf *bsdf)
{
    const World *world = path->tracer->world;
    Lanes nm = path->wavelengths.nm;
    uint32_t medium = nest_medium(&path->tracer->list);
    Lanes around = index_around(world, medium, spec, nm);
    const BalanceCase met = {.surface = surface, .spec = spec, .medium_from = medium, .medium_to = medium};
    bsdf_from_spec(spec, nm, around, around, balances_find(world->balances, &met), bsdf);
    return around;
}

void path_bsdf_of_finished(Path *path, const SceneSurface *surface, const BsdfSpec *spec, Bsdf *bsdf)
{
    (void)make_finished(path, surface, spec, bsdf);
}

bool path_shade_finished(Path *path, Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                         const SurfacePlace *place, bool *straight)
{
    const World *world = path->tracer->world;
    Bsdf bsdf;
    Lanes around = make_finished(path, surface, spec, &bsdf);
    float brightness[2];
    if (surface->thin && world->beacons.any && !world->trial.fresnel_alone &&
        path_look_ahead(path, place, around, brightness))
        bsdf_set_brightness(&bsdf, brightness);
    Frame frame = frame_of(path, event, surface, spec, place);
    *straight = surface_is_pane(surface) && path_is_pane(world, event->hit.object, event->n_cluster);
    return scatter(path, event, &bsdf, place, &frame, straight);
}

/* What a pane, or the panes in a mix, leave of a straight ray that hits them at an angle of that cosine; sharp, see path_footprint. */
static Lanes pass_sheet(const Path *path, const Ray *ray, const Hit *hit, const SceneSurface *surface, Lanes around,
                        float cosine)
{
    const World *world = path->tracer->world;
    const SceneSurface *surfaces = world->scene->surfaces;
    if (surface->mixed) {
        float weight = texture_mix_weight(world, surface, ray, hit, 0);
        Lanes left = lanes_all(0);
        for (int i = 0; i < 2; i++) {
            float part = i ? weight : 1 - weight;
            if (!(part > 0) || !scene_surface_has_pane(world->scene, surface->mix[i])) continue;
            left = lanes_add(left,
                             lanes_scale(pass_sheet(path, ray, hit, &surfaces[surface->mix[i]], around, cosine), part));
        }
        return left;
    }
    if (!surface_is_pane(surface)) return lanes_all(0);
    const BsdfSpec *spec = &surface->spec;
    BsdfSpec textured;
    if (surface->n_textures) {
        texture_read_spec(world, surface, ray, hit, 0, path->wavelengths.nm, &textured);
        spec = &textured;
    }
    Bsdf bsdf;
    bsdf_from_spec(spec, path->wavelengths.nm, around, around, NULL, &bsdf);
    return bsdf_straight(&bsdf, cosine);
}

Lanes path_pass_panes(const Path *path, const Ray *ray, const Hit *hits, size_t n, uint32_t medium)
{
    const World *world = path->tracer->world;
    Lanes left = lanes_all(1), around = medium_ior(world, medium, path->wavelengths.nm);
    const Hit *met =
        n == 1 ? hits : ties_met(world->compiled, hits, n); /* as a path that comes here meets no other one */
    for (size_t i = 0; i < n; i++) {
        const Hit *hit = &hits[i];
        if (!met || hit->object != met->object) continue;
        bool again = false; /* an edge that two triangles share */
        for (size_t k = 0; k < i; k++) again |= hits[k].object == hit->object && hits[k].entering == hit->entering;
        if (again) continue;
        SurfacePlace place = path_place_of(world, ray, hit);
        const SceneSurface *surface = &world->scene->surfaces[world->scene->objects[hit->object].surface];
        float cosine = float_min(-vec3f_dot(ray->direction, place.normal), 1);
        left = cosine > 0 ? lanes_mul(left, pass_sheet(path, ray, hit, surface, around, cosine)) : lanes_all(0);
    }
    return left;
}

void path_bsdf_of_boundary(Path *path, const Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                           Lanes eta_i, Lanes eta_t, Bsdf *bsdf)
{
    const BalanceCase met = {.surface = surface,
                             .spec = spec,
                             .medium_from = event->crossing.medium_from,
                             .medium_to = event->crossing.medium_to,
                             .bare = !surface->painted};
    const BsdfKept *kept = balances_find(path->tracer->world->balances, &met);
    if (surface->painted) {
        bsdf_from_spec(spec, path->wavelengths.nm, eta_i, eta_t, kept, bsdf);
        return;
    }
    bsdf_begin(bsdf);
    bsdf_set_balance(bsdf, kept ? kept->balance : NULL);
    float alpha_x, alpha_y;
    bsdf_alphas(spec->specular_roughness, spec->specular_roughness_anisotropy, &alpha_x, &alpha_y);
    bsdf_add_boundary(bsdf, 1, eta_i, eta_t, alpha_x, alpha_y, NULL);
}

bool path_cross_rough(Path *path, Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                      const SurfacePlace *place, Lanes eta_i, Lanes eta_t)
{
    Bsdf bsdf;
    path_bsdf_of_boundary(path, event, surface, spec, eta_i, eta_t, &bsdf);
    Frame frame = frame_of(path, event, surface, spec, place);
    bool straight = false;
    return scatter(path, event, &bsdf, place, &frame, &straight);
}

/* probe.c - light behind glass is looked for by probes, where a guide says from where it comes.
 *
 * Where a path is scattered, a second ray may be sent in a direction of the guide's, and is followed through boundaries and
 * off mirrors, up to what scatters it broadly: a look for light through glass, as there is one for light that comes
 * straight. The path itself goes on as it would without a guide. Both may find the same light: light that comes to the
 * place by smooth surfaces only (or nearly: is_keen in shade_bsdf.c), and from a light that is brighter than the guide's
 * threshold. Such light is weighted by the balance heuristic ([Veach97] 9.2.2) between the density of the path's own
 * direction and that of the guide's, times how often probes are sent; whatever else a path finds counts in full, and what
 * else a probe finds, not at all. So guiding can never make anything noisier than it was: choosing some of the path's own
 * directions by the guide, as was tried, multiplies all other light by 1 / (1 - share) at every scattering, or takes it
 * away. Between walls that light each other the squared error was twelve times that without a guide, and is now less
 * than without; of a pool in the sun the variance fell to a twentieth. And the density of the guide is asked for only when
 * such light was found.
 *
 * What decides whether light is of that kind, and the weights, must not depend on which of the wavelengths is the hero.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/probe.h"

#include <stdlib.h>

#include "base/luminance.h"
#include "optics/color.h"
#include "optics/sampling.h"
#include "trace/event.h"
#include "trace/texture_shade.h"

/* A probe's events are numbered beyond those of all paths, so that it has random numbers of its own. */
enum { FIRST_BOUNCE = 1 << 24 };

bool path_ask_guide(Path *path, const GuideAt *guide, Vec3f *direction)
{
    if (LIKELY(guide->sent == 0)) return false;
    float u = sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_GUIDE)), v[2];
    if (u >= guide->sent) return false;
    path_is_guided(path, guide);
    sampler_2d(&path->sampler, DIM_PROBES + path->bounce, v);
    *direction = guide_sample(guide, u / guide->sent, v);
    return true;
}

/* Of a direction, and of what was done since at boundaries: how dense the path's own choice is, and that of probes, of which one may be
 * led. What a probe carries is over how often it was led there. */
static void find_part(PathProbing *probing)
{
    Leads found;
    const Leads *leads = probing->leads ? probing->leads : &found;
    if (!probing->leads) guide_leads(&probing->guide, probing->direction, &found);
    const float lift = leads_lift(leads, &probing->turns), probes = probing->guide.share * lift;
    probing->ratio = probes / probing->density;
    probing->part = sampling_balance(probing->density, probes);
    if (probing->leads) probing->part *= lift / leads->all;
}

float path_weigh_probing(Path *path, float radiance)
{
    PathProbing *probing = &path->probing;
    /* behind a nearly smooth surface the radiance is a weighted one */
    bool bright = path->scatter_pdf >= 0 || radiance > guide_threshold(probing->guide.guide);
    probing->found = probing->bent && bright;
    if (!probing->found) return probing->is_probe ? 0 : 1;
    path_is_guided(path, &probing->guide);
    if (probing->part < 0) find_part(probing);
    return probing->part;
}

void path_note_found(Path *path, Lanes light)
{
    PathProbing *probing = &path->probing;
    bool noted = probing->found && probing->part > 0 && !path->again; /* both paths of a sample find much the same */
    probing->found = false;
    if (!noted) return;
    float rgb[3];
    color_from_lanes(light, &path->wavelengths, rgb);
    guide_note(path->tracer->ledger, &probing->guide, GUIDE_FOUND, color_luminance(rgb), probing->ratio);
}

/* The list of hulls where the probe starts. */
static Status start_list(const Path *path, const Event *event, const SurfacePlace *place, bool through, const Ray *ray,
                         NestList *list)
{
    Tracer *tracer = path->tracer;
    if (!place->apart && event->n_cluster > 1) return path_cross_towards(tracer, ray, list) ? STATUS_OK : STATUS_NOMEM;
    if (place->apart || !through) return nest_list_copy(list, &tracer->list);
    return path_copy_behind(tracer, event, list);
}

void path_send_probe(Path *path, const GuideAt *guide, const LookPlace *from, const ProbeWay *way)
{
    Tracer *tracer = path->tracer, *prober;
    if (!(way->pdf_w > 0)) return;
    prober = tracer_lend(tracer);
    if (UNLIKELY(!prober)) return;
    Path probe = *path;
    probe.tracer = prober;
    probe.fork = NULL;
    path_start_ray(path, from->event, from->place, way->through, way->direction, &probe.ray);
    if (start_list(path, from->event, from->place, way->through, &probe.ray, &prober->list) != STATUS_OK) {
        tracer->out_of_memory = true;
        return;
    }
    probe.beta = lanes_mul(path->beta, lanes_scale(way->scattered, 1 / way->pdf_w));
    probe.radiance = lanes_all(0);
    probe.scatter_pdf = -1;
    probe.scatter_point = from->place->position;
    probe.scatter_normal = from->normal;
    probe.scatter_lights = from->choices;
    probe.from.rarity = 0;
    probe.looks = false;
    probe.decision = (Decision){.left = 0};
    Leads leads;
    guide_leads(guide, way->direction, &leads);
    probe.probing = (PathProbing){.guide = *guide,
                                  .direction = way->direction,
                                  .density = way->pdf_w,
                                  .part = -1,
                                  .turns = turns_none(),
                                  .leads = &leads,
                                  .is_probe = true};
    probe.bounce += FIRST_BOUNCE;
    if (tracer->world->scene->n_textures > 0) path_widen(&probe);
    uint64_t rays = prober->counters.rays;
    prober->ledger = tracer->ledger;
    prober->grouped = tracer->grouped;
    path_follow(&probe);
    if (UNLIKELY(tracer->ledger))
        guide_note(tracer->ledger, guide, GUIDE_SENT, (float)(prober->counters.rays - rays),
                   lanes_mean(way->scattered) * SAMPLING_PI);
    tracer_take_back(tracer);
    path->radiance = lanes_add(path->radiance, probe.radiance);
    path->bent_apart |= probe.bent_apart;
}

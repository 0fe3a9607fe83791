/* probe.h - where a path asks the guide for directions, and the probes that look there; private to src/trace. See probe.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PROBE_H
#define MEN_PROBE_H

#include "trace/shade.h"

/* What part of a guide's probes a place is worth: as much as the path carries; the same for any hero. In a dense medium there are
 * many such places one after another, of which the first ones count most; and where it is one that is looked at, too, the
 * part is the same for the whole stretch, way, however the path comes there. */
static inline float path_probe_part(const Path *path, const Airway *way, bool in_medium)
{
    if (UNLIKELY(in_medium && way->shaft > 0)) return way->carried / (float)(1 + path->n_scattered);
    float part = float_min(lanes_mean(path->beta) / lanes_mean(path->ratio), 1);
    return in_medium ? part / (float)(1 + path->n_scattered) : part;
}
/* The guide of a place where the path is to be scattered by such an event. */
static inline GuideAt path_guide(const Path *path, Vec3 place, EventKind kind)
{
    const Guide *guide = path->tracer->world->guide;
    if (LIKELY(!guide) || path->probing.is_probe) return (GuideAt){.share = 0};
    GuideAt at = guide_find(guide, place, kind == EVENT_BOUNDARY, path->color);
    float part = path_probe_part(path, &path->from, kind == EVENT_SCATTER);
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
/* Where a probe is sent, and what is scattered there. */
typedef struct ProbeWay {
    Vec3f direction; /* unit */
    bool through;    /* the event's surfaces; else back from them */
    Lanes scattered; /* from that direction towards the path, times the cosine */
    float pdf_w;     /* per steradian, the density of it by the path's own choice, as a mean of the wavelengths */
} ProbeWay;
/* Sends it from where lights are looked at, too. */
void path_send_probe(Path *path, const GuideAt *guide, const LookPlace *from, const ProbeWay *way);
/* The path goes on from a place where it was scattered, in a direction of that density. */
static inline void path_leave_guide(Path *path, const GuideAt *guide, Vec3f direction, float pdf_w)
{
    path->decision = (Decision){.left = 0};
    path->sought = 1;
    if (path->probing.is_probe) return;
    path->probing.guide.share = guide->share;
    if (UNLIKELY(guide->share > 0))
        path->probing =
            (PathProbing){.guide = *guide, .direction = direction, .density = pdf_w, .part = -1, .turns = turns_none()};
}
float path_weigh_probing(Path *path, float radiance);
void path_note_found(Path *path, Lanes light);
/* Of light that reaches the camera. */
static inline void path_add_found(Path *path, Lanes more)
{
    path->radiance = lanes_add(path->radiance, more);
    if (UNLIKELY(path->tracer->ledger)) path_note_found(path, more);
}
/* What light of a radiance (a mean of the wavelengths) counts that the path finds by itself, not by looking at it: against
 * finding it by a probe. */
static inline float path_found_part(Path *path, float radiance)
{
    return LIKELY(path->probing.guide.share == 0) ? 1 : path_weigh_probing(path, radiance);
}

#endif

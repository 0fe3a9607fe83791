/* animation.c - the frames of a scene, and a scene evaluated at one of them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/animation.h"

#include <string.h>

uint32_t scene_last_frame(const SceneAnimation *animation)
{
    return animation->first_frame + (animation->n_frames - 1);
}

/* The clock and time of a frame, which must be one of the animation's. */
static SceneInstant scene_instant(const SceneAnimation *animation, uint32_t frame)
{
    double n = animation->n_frames, before = (double)frame - animation->first_frame;
    double intervals = animation->cyclic ? n : n - 1;
    return (SceneInstant){.animation = *animation,
                          .frame = frame,
                          .clock = intervals > 0 ? before / intervals : 0,
                          .time = before / animation->fps};
}

static SceneInstant instant_of(const SceneAnimation *animation, const SceneMoment *moment)
{
    SceneInstant instant = scene_instant(animation, moment->has_frame ? moment->frame : animation->first_frame);
    double intervals = animation->cyclic ? animation->n_frames : animation->n_frames - 1.0;
    if (moment->has_clock) {
        instant.clock = moment->clock;
        instant.time = moment->clock * intervals / animation->fps;
    }
    instant.clock += moment->later / (intervals > 0 ? intervals : 1); /* a picture by itself lasts the whole clock */
    instant.time += moment->later / animation->fps;
    return instant;
}

static const EvalNode *find_animation(const EvalResult *result)
{
    for (size_t i = 0; i < result->n_settings; i++)
        if (strcmp(result->settings[i]->type->name, "animation") == 0) return result->settings[i];
    return NULL;
}

static SceneAnimation read_animation(const EvalNode *node)
{
    return (SceneAnimation){.n_frames = (uint32_t)eval_number(node, "frames"),
                            .first_frame = (uint32_t)eval_number(node, "first_frame"),
                            .fps = eval_number(node, "fps"),
                            .cyclic = eval_truth(node, "cyclic")};
}

static bool same_animation(const SceneAnimation *a, const SceneAnimation *b)
{
    return a->n_frames == b->n_frames && a->first_frame == b->first_frame && a->fps == b->fps && a->cyclic == b->cyclic;
}

/* Does a scene see the same clock, frame, frames and time? */
static bool same_instant(const SceneInstant *a, const SceneInstant *b)
{
    return a->animation.n_frames == b->animation.n_frames && a->frame == b->frame && a->clock == b->clock &&
           a->time == b->time;
}

static Status check_frame(const SceneMoment *moment, const EvalNode *node, const SceneAnimation *animation,
                          Error *error)
{
    uint32_t first = animation->first_frame, last = scene_last_frame(animation);
    if (!moment->has_frame || (moment->frame >= first && moment->frame <= last)) return STATUS_OK;
    if (!node)
        return fail(error, STATUS_USAGE,
                    "there is no frame %u: the scene has no animation, such as animation { frames = 120 }; "
                    "--set animation.frames=120 makes one",
                    moment->frame);
    return fail(error, STATUS_USAGE, "there is no frame %u: the scene's animation has the frames %u to %u",
                moment->frame, first, last);
}

static Status evaluate_once(const SceneText *text, EvalOptions *options, const SceneInstant *instant, Diag *diag,
                            EvalResult *result, Error *error)
{
    options->clock = instant->clock;
    options->time = instant->time;
    options->frame = (int)instant->frame;
    options->frames = (int)instant->animation.n_frames;
    return text->text ? eval_text(text->path, text->text, text->length, options, diag, result, error)
                      : eval_scene(text->path, options, diag, result, error);
}

static Status report_dependence(const EvalNode *node, Diag *diag, Error *error)
{
    const char *text = "the animation is another one at another clock, time or frame, which it cannot depend on";
    if (diag->n_errors == 0 && node) diag_report(diag, D_CLOCK_DEPENDENT, node->span, "%s", text);
    if (diag->n_errors == 0) diag_report_nowhere(diag, D_CLOCK_DEPENDENT, "%s", text);
    return fail(error, STATUS_SCENE, "the scene has errors");
}

static void note_frame(Diag *diag, const SceneInstant *instant, const SceneMoment *moment)
{
    diag->in_frame = instant->animation.n_frames > 1 && !moment->has_clock;
    diag->frame = instant->frame;
}

Status scene_evaluate(const SceneText *text, const EvalOptions *given, const SceneMoment *moment, Diag *diag,
                      EvalResult *result, SceneInstant *instant, Error *error)
{
    static const SceneAnimation still = {.n_frames = 1, .first_frame = 1, .fps = 24};
    EvalOptions options = *given;
    options.beyond = moment->later > 0;
    DiagMark mark = diag_mark(diag);
    bool guessed = !moment->animation;
    SceneAnimation animation = guessed ? still : *moment->animation;
    if (guessed && moment->has_frame) animation.first_frame = moment->frame;
    for (;;) {
        *instant = instant_of(&animation, moment);
        note_frame(diag, instant, moment);
        Status status = evaluate_once(text, &options, instant, diag, result, error);
        const EvalNode *node = find_animation(result);
        if ((status != STATUS_OK && status != STATUS_SCENE) || (status == STATUS_SCENE && !node)) return status;
        SceneAnimation said = node ? read_animation(node) : still;
        if (!guessed) return same_animation(&said, &animation) ? status : report_dependence(node, diag, error);
        Status there = check_frame(moment, node, &said, error);
        SceneInstant right = there == STATUS_OK ? instant_of(&said, moment) : *instant;
        bool same = same_instant(&right, instant);
        *instant = right;
        if (there == STATUS_OK && same) return status;
        diag_rewind(diag, mark);
        buf_clear(&result->printed);
        if (there != STATUS_OK) return there;
        animation = said;
        guessed = false;
    }
}

void scene_keep_one_frame(EvalResult *result, const SceneInstant *instant, Arena *arena)
{
    const EvalNode *found = find_animation(result);
    for (size_t i = 0; found && i < result->n_nodes; i++) {
        if (result->nodes[i] != found) continue;
        EvalNode *node = ARENA_NEW(arena, EvalNode);
        *node = *found;
        node->n_props = 0;
        node->props = ARENA_ARRAY(arena, EvalProp, node->type->n_props);
        for (size_t row = 0; row < node->type->n_props; row++) {
            const PropType *type = &node->type->props[row];
            const EvalProp *prop = eval_prop(found, type->name);
            double number = strcmp(type->name, "frames") == 0        ? 1
                            : strcmp(type->name, "first_frame") == 0 ? (double)instant->frame
                                                                     : -1; /* as it was */
            if (!prop && number < 0) continue;
            node->props[node->n_props] = prop ? *prop : (EvalProp){.type = type, .span = found->span};
            if (number >= 0) node->props[node->n_props].as.number = number;
            node->n_props++;
        }
        result->nodes[i] = node;
    }
}

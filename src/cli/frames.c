/* frames.c - the frames of an animation that the command line asks for.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/frames.h"

/* The option that says which frames, the later one of two; OPTION_COUNT when none does. */
static OptionKey deciding(const Options *options)
{
    unsigned frame = options->values[OPTION_FRAME].place, frames = options->values[OPTION_FRAMES].place;
    if (!frame && !frames) return OPTION_COUNT;
    return frame > frames ? OPTION_FRAME : OPTION_FRAMES;
}

static bool asks_for_all(const Options *options, OptionKey key)
{
    return key == OPTION_FRAMES && options->values[key].whole[2] == 0;
}

Status frames_moment(const Options *options, SceneMoment *moment, Error *error)
{
    OptionKey key = deciding(options);
    *moment =
        (SceneMoment){.has_clock = option_given(options, OPTION_CLOCK), .clock = options->values[OPTION_CLOCK].number};
    bool sharded = option_given(options, OPTION_SHARD);
    if (moment->has_clock && (key != OPTION_COUNT || sharded))
        return fail(error, STATUS_USAGE, "'--clock' is one picture, and '--%s' says which frames: give one of them",
                    sharded ? "shard" : option_row(key)->name);
    if (key == OPTION_COUNT || asks_for_all(options, key)) return STATUS_OK;
    moment->has_frame = true;
    moment->frame = options->values[key].whole[0];
    return STATUS_OK;
}

static Status check_last(const Options *options, const SceneAnimation *animation, uint32_t wanted, Error *error)
{
    uint32_t first = animation->first_frame, last = scene_last_frame(animation);
    if (wanted <= last) return STATUS_OK;
    uint32_t begin = options->values[OPTION_FRAMES].whole[0];
    if (animation->n_frames > 1)
        return fail(error, STATUS_USAGE, "option '--frames': %u..%u goes beyond the scene's frames, which are %u to %u",
                    begin, wanted, first, last);
    return fail(error, STATUS_USAGE,
                "option '--frames': %u..%u of a scene that is no animation; --set animation.frames=%u makes it one",
                begin, wanted, wanted - first + 1);
}

Status frames_choose(const Options *options, const SceneAnimation *animation, bool all, FrameList *list, Error *error)
{
    OptionKey key = deciding(options);
    bool one = option_given(options, OPTION_CLOCK) || (key == OPTION_COUNT && !all);
    uint32_t n = one ? 1 : animation->n_frames;
    *list = (FrameList){.first = animation->first_frame, .step = 1, .numbered = animation->n_frames > 1};
    if (option_given(options, OPTION_CLOCK)) list->numbered = false;
    if (key == OPTION_FRAME) {
        list->first = options->values[key].whole[0];
        n = 1;
    } else if (key == OPTION_FRAMES && !asks_for_all(options, key)) {
        const uint32_t *given = options->values[key].whole;
        TRY(check_last(options, animation, given[1], error));
        list->first = given[0];
        list->step = given[2];
        n = (given[1] - given[0]) / given[2] + 1;
    }
    if (option_given(options, OPTION_SHARD)) {
        const uint32_t *shard = options->values[OPTION_SHARD].whole;
        uint32_t before = shard[0] - 1;
        n = n > before ? (n - before - 1) / shard[1] + 1 : 0;
        list->first += before * list->step; /* not used where n is 0 */
        list->step *= shard[1];
    }
    list->n = n;
    return STATUS_OK;
}

uint32_t frames_at(const FrameList *list, uint32_t i)
{
    return list->first + i * list->step;
}

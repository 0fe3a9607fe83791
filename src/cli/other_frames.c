/* other_frames.c - what must be the same in all frames, looked at in the last two, which tell odd from even ones, and then
 * in as many others as are soon evaluated. To evaluate a scene takes little beside compiling and rendering it, but may take
 * long for a thousand frames. The last frame is looked at for mistakes, too, until its shutter closes: of what the clock
 * moves it has the farthest, and what it has wrong would be found when all others are rendered.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/other_frames.h"

#include <string.h>

#include "scene/motion.h"

/* What the frames between may take together, so that nobody waits for them: each of its steps, and by its memory what it
 * takes to read and to make. Counted, and not timed, so that the same frames are looked at on any machine. */
static const double most_work = 3e6, work_per_byte = 0.02;

typedef struct OtherFrame {
    SceneInput *from;
    SceneInput input;       /* of this frame alone */
    const EvalNode *film;   /* of this frame; NULL: it has none */
    const EvalProp *output; /* its output; NULL: not set */
    Diag late;              /* a mistake while its shutter is open */
} OtherFrame;

static const EvalNode *find_film(const EvalResult *result)
{
    for (size_t i = 0; i < result->n_settings; i++)
        if (strcmp(result->settings[i]->type->name, "film") == 0) return result->settings[i];
    return NULL;
}

static bool same_outputs(const SceneFilm *film, const EvalProp *output)
{
    size_t n = output ? output->as.list.n : 0;
    if (n != film->n_outputs) return false;
    for (size_t i = 0; i < n; i++)
        if (strcmp(film->outputs[i], output->as.list.texts[i]) != 0) return false;
    return true;
}

static void report_output(void *context)
{
    OtherFrame *other = context;
    const Span *span = other->output ? &other->output->span : other->film ? &other->film->span : NULL;
    const char *text = "the film's output is another one in this frame, and all files are tried before the first frame";
    Diag *diag = &other->input.diag;
    Diagnostic *report = span ? diag_report(diag, D_CLOCK_DEPENDENT, *span, "%s", text)
                              : diag_report_nowhere(diag, D_CLOCK_DEPENDENT, "%s", text);
    if (report) diag_hint(diag, report, "'#' stands for the number of the frame: output = \"name.####.png\"");
}

/* Reports point into texts by their number and place. */
static bool same_texts(const SourceSet *a, const SourceSet *b)
{
    bool same = a->n == b->n;
    for (uint32_t i = 0; same && i < a->n; i++) same = a->sources[i].length == b->sources[i].length;
    return same;
}

static void take_reports(void *context)
{
    OtherFrame *other = context;
    diag_merge(&other->from->diag, other->late.n_errors ? &other->late : &other->input.diag);
}

/* Takes over what the frame has reported, if it can be shown. */
static Status hand_over(OtherFrame *other, Error *error)
{
    if (!same_texts(&other->from->sources, &other->input.sources)) return STATUS_OK;
    TRY(scene_input_guard(other->from, take_reports, other, error));
    other->from->several_frames = true;
    return STATUS_SCENE;
}

static void open_frame(OtherFrame *other, SceneInput *from, uint32_t frame)
{
    *other = (OtherFrame){.from = from};
    scene_input_init(&other->input, from->options, from->talk);
    other->input.scene_options.pool = from->scene_options.pool;
    other->input.scene_options.no_picture = from->scene_options.no_picture;
    other->input.text = from->text;
    other->input.text_length = from->text_length;
    other->input.instant = from->instant;
    scene_input_next(&other->input, frame);
}

static void close_frame(OtherFrame *other)
{
    other->input.text = NULL; /* it is the other one's */
    scene_input_close(&other->input);
}

/* Mistakes of the frame count where it is the last; otherwise they are its own, and reported in its turn. Adds to *work what
 * it took. */
static Status look_at(SceneInput *from, uint32_t frame, bool outputs, bool last, double *work, Error *error)
{
    OtherFrame other;
    EvalResult result = {0};
    Error own = {0};
    open_frame(&other, from, frame);
    Status status = scene_input_evaluate(&other.input, &result, &own);
    buf_clear(&result.printed);
    *work += (double)result.steps + work_per_byte * (double)other.input.arena.total;
    other.film = find_film(&result);
    other.output = other.film ? eval_prop(other.film, "output") : NULL;
    bool differs = status == STATUS_OK && outputs && !same_outputs(&from->scene->film, other.output);
    bool wrong = last && status == STATUS_SCENE;
    status = differs ? scene_input_guard(&other.input, report_output, &other, error) : STATUS_OK;
    if (status == STATUS_OK && (wrong || diag_has(&other.input.diag, D_CLOCK_DEPENDENT)))
        status = hand_over(&other, error);
    close_frame(&other);
    return status;
}

static void report_late(void *context)
{
    OtherFrame *other = context;
    Diag *diag = &other->input.diag;
    diag_init(&other->late, diag->arena, diag->sources);
    other->late.in_frame = diag->in_frame;
    other->late.frame = diag->frame;
    scene_report_later(&other->late, diag, "the scene has errors", other->input.scene_options.moment.later,
                       other->input.instant.clock);
}

/* As the shutter closes, which is beyond the clock of any frame. */
static Status look_at_end(SceneInput *from, uint32_t frame, Error *error)
{
    OtherFrame other;
    EvalResult result = {0};
    Error own = {0};
    if (!(from->scene->shutter > 0)) return STATUS_OK;
    open_frame(&other, from, frame);
    other.input.scene_options.moment.later = from->scene->shutter;
    bool wrong = scene_input_evaluate(&other.input, &result, &own) == STATUS_SCENE;
    buf_clear(&result.printed);
    Status status = wrong ? scene_input_guard(&other.input, report_late, &other, error) : STATUS_OK;
    if (wrong && status == STATUS_OK) status = hand_over(&other, error);
    close_frame(&other);
    return status;
}

/* Between the first and the last two, coarsely at first, so that a change that lasts is met early: the odd multiples of
 * ever smaller steps. */
static Status look_between(SceneInput *input, const FrameList *frames, bool outputs, Error *error)
{
    double work = 0;
    uint64_t n = frames->n - 2, step = 1; /* 0 and those from n on are known */
    while (step * 2 < n) step *= 2;
    for (; step > 0; step /= 2)
        for (uint64_t i = step; i < n; i += 2 * step) {
            if (work > most_work) return STATUS_OK;
            TRY(look_at(input, frames_at(frames, (uint32_t)i), outputs, false, &work, error));
        }
    return STATUS_OK;
}

Status other_frames_check(SceneInput *input, const FrameList *frames, bool outputs, Error *error)
{
    double work = 0;
    for (uint32_t i = 0; i < 2 && i + 1 < frames->n; i++)
        TRY(look_at(input, frames_at(frames, frames->n - 1 - i), outputs, i == 0, &work, error));
    if (frames->n > 1) TRY(look_at_end(input, frames_at(frames, frames->n - 1), error));
    return frames->n > 3 ? look_between(input, frames, outputs, error) : STATUS_OK;
}

/* checkpoint.c - writes and reads the state of a render.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/checkpoint.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"

#define MAGIC "MNSSTATE"
/* The mark's last digit counts what heads and blocks have been. */
enum { BYTE_ORDER_MARK = 0x01020309, LARGEST_SIDE = 65536 };

/* What a block begins with. */
typedef struct Prefix {
    uint64_t length, hash;
} Prefix;

typedef struct Footer {
    char magic[8];
    uint64_t begin, end; /* of the blocks, in the file */
} Footer;

/* What the head begins with. Without gaps between members. */
typedef struct Head {
    uint32_t byte_order, head_size, film_pixel_size, bright_pixel_size, aov_pixel_size;
    uint32_t caught_pixel_size; /* 0: nothing in the scene catches shadows */
    ImagePlace place;
    uint32_t film_width, film_height;
    uint32_t samples, first_sample, end_sample, guide_samples, least_samples, most_samples;
    uint32_t aovs, spreads, guides, wants, n_facts, n_attributes, n_light_groups;
    uint32_t has_search, searching, none; /* none: 0 */
    double unit, noise;
    PathCounters counters;
    uint64_t saturated_samples;
} Head;
_Static_assert(sizeof(Head) == 28 * 4 + 16 + sizeof(PathCounters) + 8, "the head of a checkpoint as bytes");
_Static_assert(AOV_COUNT <= 32, "a set of AOVs in the head of a checkpoint");

/* ---- writing ---- */

typedef struct Writing {
    const char *path;
    const RenderState *state;
    const CheckpointNotes *notes;
} Writing;

static Status fail_write(const Writing *writing, Error *error)
{
    return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", writing->path, strerror(errno ? errno : EIO));
}

static bool write_bytes(void *stream, const void *bytes, size_t length)
{
    Prefix prefix = {length, length ? hash_bulk(bytes, length, 0) : 0};
    return fwrite(&prefix, sizeof prefix, 1, stream) == 1 &&
           (length == 0 || fwrite(bytes, 1, length, stream) == length);
}

static Status write_block(const Writing *writing, const Buf *block, FILE *stream, Error *error)
{
    if (block->failed) return fail(error, STATUS_NOMEM, "out of memory for the checkpoint '%s'", writing->path);
    errno = 0;
    return write_bytes(stream, block->text, block->length) ? STATUS_OK : fail_write(writing, error);
}

static Status write_search(const Writing *writing, FILE *stream, Error *error)
{
    bool written = true;
    errno = 0;
    if (guide_search_is_begun(writing->state->search))
        guide_search_write(writing->state->search, write_bytes, stream, &written);
    return written ? STATUS_OK : fail_write(writing, error);
}

/* With its end, and its length before it. */
static void add_text(Buf *out, const char *text)
{
    uint32_t size = (uint32_t)strlen(text) + 1;
    buf_add_bytes(out, (const char *)&size, sizeof size);
    buf_add_bytes(out, text, size);
}

static void add_head(const Writing *writing, Buf *out)
{
    const RenderState *state = writing->state;
    const CheckpointNotes *notes = writing->notes;
    Head head = {.byte_order = BYTE_ORDER_MARK,
                 .head_size = sizeof head,
                 .film_pixel_size = sizeof(FilmPixel),
                 .bright_pixel_size = sizeof(BrightPixel),
                 .aov_pixel_size = (uint32_t)aov_film_pixel_size(),
                 .caught_pixel_size = state->film.caught ? sizeof(FilmCaught) : 0,
                 .place = state->place,
                 .film_width = state->film.width,
                 .film_height = state->film.height,
                 .samples = notes->samples,
                 .first_sample = notes->first_sample,
                 .end_sample = notes->end_sample,
                 .guide_samples = state->guide_samples,
                 .aovs = (uint32_t)state->aovs.set,
                 .spreads = state->bright.pixels != NULL,
                 .guides = state->aovs.guides,
                 .wants = state->wanted != NULL,
                 .n_facts = notes->n_facts,
                 .n_attributes = notes->n_attributes,
                 .n_light_groups = state->aovs.groups.n,
                 .has_search = guide_search_is_begun(state->search),
                 .searching = guide_search_is_begun(state->search) && !guide_search_is_done(state->search),
                 .unit = state->aovs.unit,
                 .noise = notes->noise,
                 .counters = state->counters,
                 .saturated_samples = state->saturated_samples};
    uint64_t sum;
    film_count_samples(&state->film, &head.least_samples, &head.most_samples, &sum);
    buf_add_bytes(out, (const char *)&head, sizeof head);
    for (uint32_t i = 0; i < state->aovs.groups.n; i++) add_text(out, state->aovs.groups.names[i]);
    for (uint32_t i = 0; i < notes->n_facts; i++) {
        add_text(out, notes->facts[i].name);
        add_text(out, notes->facts[i].text);
    }
    for (uint32_t i = 0; i < notes->n_attributes; i++) {
        const ImageAttribute *attribute = &notes->attributes[i];
        uint32_t type = attribute->type;
        int32_t whole = attribute->whole;
        buf_add_bytes(out, (const char *)&type, sizeof type);
        buf_add_bytes(out, (const char *)&whole, sizeof whole);
        buf_add_bytes(out, (const char *)&attribute->number, sizeof attribute->number);
        add_text(out, attribute->name);
        add_text(out, attribute->text ? attribute->text : "");
    }
}

static void add_row(const RenderState *state, uint32_t y, Buf *out)
{
    const size_t width = state->film.width;
    film_save_row(&state->film, y, out);
    bright_film_save_row(&state->bright, y, out);
    aov_film_save_row(&state->aovs, y, out);
    if (state->wanted) buf_add_bytes(out, (const char *)(state->wanted + y * width), width * sizeof *state->wanted);
}

static Status append_state(void *context, FILE *stream, Error *error)
{
    const Writing *writing = context;
    const RenderState *state = writing->state;
    Footer footer = {.magic = MAGIC};
    off_t begin = ftello(stream);
    if (begin < 0) return fail_write(writing, error);
    footer.begin = (uint64_t)begin;
    Buf block = {0};
    add_head(writing, &block);
    Status status = write_block(writing, &block, stream, error);
    for (uint32_t y = 0; status == STATUS_OK && y < state->film.height; y++) {
        block.length = 0;
        add_row(state, y, &block);
        status = write_block(writing, &block, stream, error);
    }
    buf_clear(&block);
    if (status == STATUS_OK) status = write_search(writing, stream, error);
    if (status != STATUS_OK) return status;
    off_t end = ftello(stream);
    if (end < 0) return fail_write(writing, error);
    footer.end = (uint64_t)end;
    return fwrite(&footer, sizeof footer, 1, stream) == 1 ? STATUS_OK : fail_write(writing, error);
}

Status checkpoint_write(const char *path, const RenderState *state, const CheckpointNotes *notes, const Image *image,
                        const ExrOptions *exr, Error *error)
{
    Writing writing = {path, state, notes};
    ImageAttribute attributes[CHECKPOINT_MOST_ATTRIBUTES + 1];
    ExrOptions options = *exr;
    if (state->aovs.out_of_memory || state->bright.out_of_memory)
        return fail(error, STATUS_NOMEM, "out of memory for the checkpoint '%s'", path);
    if (exr->n_attributes > CHECKPOINT_MOST_ATTRIBUTES)
        return fail(error, STATUS_RENDER, "cannot write '%s': too many attributes", path);
    if (exr->n_attributes) memcpy(attributes, exr->attributes, exr->n_attributes * sizeof *attributes);
    attributes[exr->n_attributes] =
        (ImageAttribute){.name = CHECKPOINT_ATTRIBUTE, .type = ATTRIBUTE_TEXT, .text = "behind the picture"};
    options.attributes = attributes;
    options.n_attributes = exr->n_attributes + 1;
    options.place = &state->place;
    options.append = append_state;
    options.append_context = &writing;
    return exr_write(path, image, &options, error);
}

/* ---- reading ---- */

/* It has no state at its end. */
static Status fail_foreign(const char *path, Error *error)
{
    char *text;
    TRY(exr_read_attribute(path, CHECKPOINT_ATTRIBUTE, &text, error));
    bool had = text != NULL;
    free(text);
    if (had)
        return fail(error, STATUS_INPUT,
                    "cannot read '%s': the file is cut short, or another program wrote it anew and left the state of "
                    "the render out",
                    path);
    return fail(
        error, STATUS_INPUT,
        "cannot read '%s': it is a picture without the state of a render, neither a checkpoint nor a slice, which "
        "'render --checkpoint' and 'render --sample-range' write",
        path);
}

static Status fail_damaged(const Checkpoint *file, Error *error)
{
    return fail(error, STATUS_INPUT, "cannot read '%s': the state of the render in it is damaged", file->path);
}

/* The bytes of the next block, in *bytes, which grows; one byte more is there. */
static Status read_block(Checkpoint *file, char **bytes, uint64_t *capacity, uint64_t *length, Error *error)
{
    Prefix prefix;
    if (file->left < sizeof prefix || fread(&prefix, sizeof prefix, 1, file->stream) != 1)
        return fail_damaged(file, error);
    file->left -= sizeof prefix;
    if (prefix.length > file->left) return fail_damaged(file, error);
    if (prefix.length + 1 > *capacity) {
        free(*bytes);
        *capacity = 0;
        *bytes = malloc(prefix.length + 1);
        if (!*bytes) return fail_memory(error, prefix.length + 1, file->path);
        *capacity = prefix.length + 1;
    }
    if (fread(*bytes, 1, prefix.length, file->stream) != prefix.length) return fail_damaged(file, error);
    file->left -= prefix.length;
    *length = prefix.length;
#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION /* a fuzzer is to get beyond this */
    if (prefix.length && hash_bulk(*bytes, prefix.length, 0) != prefix.hash) return fail_damaged(file, error);
#endif
    return STATUS_OK;
}

static Status find_blocks(Checkpoint *file, Error *error)
{
    Footer footer;
    if (fseeko(file->stream, 0, SEEK_END) != 0)
        return fail(error, STATUS_INPUT, "cannot read '%s': a checkpoint has to be a file, not a pipe", file->path);
    off_t size = ftello(file->stream);
    bool there = size >= (off_t)sizeof footer && fseeko(file->stream, size - (off_t)sizeof footer, SEEK_SET) == 0 &&
                 fread(&footer, sizeof footer, 1, file->stream) == 1 &&
                 memcmp(footer.magic, MAGIC, sizeof footer.magic) == 0;
    if (!there) return fail_foreign(file->path, error);
    if (footer.end != (uint64_t)size - sizeof footer || footer.begin > footer.end ||
        fseeko(file->stream, (off_t)footer.begin, SEEK_SET) != 0)
        return fail_damaged(file, error);
    file->left = footer.end - footer.begin;
    return STATUS_OK;
}

static const char *take_text(BufReader *in)
{
    uint32_t size;
    const char *text = in->at;
    if (!buf_take(in, &size, sizeof size) || size == 0 || size > in->left) return NULL;
    text = in->at;
    in->at += size;
    in->left -= size;
    return text[size - 1] == 0 ? text : NULL;
}

static bool take_facts(BufReader *in, CheckpointNotes *notes)
{
    for (uint32_t i = 0; i < notes->n_facts; i++) {
        CheckpointFact *fact = &notes->facts[i];
        fact->name = take_text(in);
        fact->text = fact->name ? take_text(in) : NULL;
        if (!fact->text) return false;
    }
    for (uint32_t i = 0; i < notes->n_attributes; i++) {
        ImageAttribute *attribute = &notes->attributes[i];
        uint32_t type;
        int32_t whole;
        if (!buf_take(in, &type, sizeof type) || type > ATTRIBUTE_FLOAT || !buf_take(in, &whole, sizeof whole) ||
            !buf_take(in, &attribute->number, sizeof attribute->number))
            return false;
        attribute->type = (AttributeType)type;
        attribute->whole = whole;
        attribute->name = take_text(in);
        attribute->text = attribute->name ? take_text(in) : NULL;
        if (!attribute->text) return false;
    }
    return true;
}

static bool take_light_groups(BufReader *in, uint32_t n, LightGroups *groups)
{
    *groups = (LightGroups){.n = 0};
    while (groups->n < n) {
        const char *name = take_text(in);
        if (!name || !light_group_can_be(name) || light_groups_add(groups, name) + 1 != groups->n) return false;
    }
    return n > 0;
}

static bool head_can_be(const Head *head)
{
    const ImagePlace *place = &head->place;
    return place->width <= LARGEST_SIDE && place->height <= LARGEST_SIDE && head->film_width >= 1 &&
           head->film_height >= 1 && head->film_width <= place->width && head->film_height <= place->height &&
           place->x <= place->width - head->film_width && place->y <= place->height - head->film_height &&
           head->first_sample < head->end_sample && head->end_sample <= head->samples &&
           head->samples <= FILM_MOST_SAMPLES && head->least_samples <= head->most_samples &&
           head->most_samples <= FILM_MOST_SAMPLES && (AovSet)head->aovs < (AovSet)1 << AOV_COUNT && head->unit >= 0 &&
           head->n_facts <= CHECKPOINT_MOST_FACTS && head->n_attributes <= CHECKPOINT_MOST_ATTRIBUTES;
}

/* Before memory is asked for. */
static bool has_room(const Checkpoint *file, const Head *head)
{
    double pixels = (double)head->film_width * head->film_height;
    double bytes = sizeof(FilmPixel) + (double)head->caught_pixel_size + (head->spreads ? sizeof(BrightPixel) : 0);
    return pixels * bytes <= (double)file->left;
}

static Status take_head(Checkpoint *file, uint64_t length, Error *error)
{
    BufReader in = {file->head, length};
    Head head;
    CheckpointNotes *notes = &file->notes;
    if (!buf_take(&in, &head, sizeof head)) return fail_damaged(file, error);
    if (head.byte_order != BYTE_ORDER_MARK || head.head_size != sizeof head ||
        head.film_pixel_size != sizeof(FilmPixel) || head.bright_pixel_size != sizeof(BrightPixel) ||
        head.aov_pixel_size != aov_film_pixel_size() ||
        (head.caught_pixel_size && head.caught_pixel_size != sizeof(FilmCaught)))
        return fail(
            error, STATUS_INPUT,
            "cannot read '%s': another version of meniscus, or one for another machine, wrote the state of the render",
            file->path);
    if (!head_can_be(&head)) return fail_damaged(file, error);
    *notes = (CheckpointNotes){.samples = head.samples,
                               .first_sample = head.first_sample,
                               .end_sample = head.end_sample,
                               .noise = head.noise,
                               .n_facts = head.n_facts,
                               .n_attributes = head.n_attributes};
    if (!take_light_groups(&in, head.n_light_groups, &file->light_groups) || !take_facts(&in, notes) || in.left ||
        !has_room(file, &head))
        return fail_damaged(file, error);
    file->place = head.place;
    file->film_width = head.film_width;
    file->film_height = head.film_height;
    file->least_samples = head.least_samples;
    file->most_samples = head.most_samples;
    file->aovs = (AovSet)head.aovs;
    file->unit = head.unit;
    file->catches = head.caught_pixel_size > 0;
    file->spreads = head.spreads != 0;
    file->guides = head.guides != 0;
    file->wants = head.wants != 0;
    file->counters = head.counters;
    file->saturated_samples = head.saturated_samples;
    file->guide_samples = head.guide_samples;
    file->has_search = head.has_search != 0;
    file->searching = head.searching != 0;
    return STATUS_OK;
}

Status checkpoint_open(const char *path, Checkpoint *file, Error *error)
{
    *file = (Checkpoint){.path = path, .stream = fopen(path, "rb")};
    if (!file->stream) return file_cannot_read(path, errno, error);
    TRY(find_blocks(file, error));
    uint64_t capacity = 0, length;
    TRY(read_block(file, &file->head, &capacity, &length, error));
    return take_head(file, length, error);
}

void checkpoint_close(Checkpoint *file)
{
    if (file->stream) fclose(file->stream);
    free(file->head);
    free(file->row);
    *file = (Checkpoint){0};
}

Status checkpoint_make_state(const Checkpoint *file, uint32_t height, RenderState *state, Error *error)
{
    *state = (RenderState){
        .counters = file->counters, .saturated_samples = file->saturated_samples, .guide_samples = file->guide_samples};
    state->place = file->place;
    bool slice = file->notes.first_sample > 0;
    const uint32_t width = file->film_width;
    if (height == 0) height = file->film_height;
    Status status = film_init(&state->film, width, height, error);
    state->film.first_sample = file->notes.first_sample;
    if (status == STATUS_OK && file->catches) status = film_catch(&state->film, error);
    if (status == STATUS_OK && file->spreads) status = bright_film_init(&state->bright, slice, width, height, error);
    if (status == STATUS_OK)
        status = aov_film_init(&state->aovs, file->aovs, &file->light_groups, file->guides, file->unit, width, height,
                               error);
    const size_t n = (size_t)width * height;
    if (status == STATUS_OK && file->wants) {
        state->wanted = calloc(n, sizeof *state->wanted);
        if (!state->wanted) status = fail_memory(error, n * sizeof *state->wanted, "the noise of the picture");
    }
    if (status != STATUS_OK) render_state_clear(state);
    return status;
}

Status checkpoint_read_row(Checkpoint *file, RenderState *state, uint32_t y, Error *error)
{
    uint64_t length;
    const uint32_t width = file->film_width;
    TRY(read_block(file, &file->row, &file->row_capacity, &length, error));
    BufReader in = {file->row, length};
    bool good = film_load_row(&state->film, y, &in);
    for (uint32_t x = 0; good && x < width; x++) {
        uint32_t n = film_pixel(&state->film, x, y)->n;
        good = n >= file->least_samples && n <= file->most_samples;
    }
    good = good && bright_film_load_row(&state->bright, y, &in) && aov_film_load_row(&state->aovs, y, &in);
    if (good && file->wants) {
        uint32_t *wanted = state->wanted + (size_t)y * width;
        good = buf_take(&in, wanted, width * sizeof *wanted);
        for (uint32_t x = 0; good && x < width; x++) good = wanted[x] <= FILM_MOST_SAMPLES;
    }
    return good && in.left == 0 ? STATUS_OK : fail_damaged(file, error);
}

/* Behind the rows. */
static Status read_search(Checkpoint *file, RenderState *state, Error *error)
{
    GuideBytes parts[GUIDE_PARTS] = {{NULL, 0}};
    Status status = STATUS_OK;
    for (int i = 0; i < GUIDE_PARTS && status == STATUS_OK; i++) {
        char *bytes = NULL;
        uint64_t capacity = 0;
        status = read_block(file, &bytes, &capacity, &parts[i].length, error);
        parts[i].bytes = bytes;
    }
    if (status == STATUS_OK) return guide_search_read(parts, &state->search) ? STATUS_OK : fail_damaged(file, error);
    for (int i = 0; i < GUIDE_PARTS; i++) free(parts[i].bytes);
    return status;
}

Status checkpoint_read(Checkpoint *file, RenderState *state, Error *error)
{
    TRY(checkpoint_make_state(file, 0, state, error));
    Status status = STATUS_OK;
    for (uint32_t y = 0; status == STATUS_OK && y < file->film_height; y++)
        status = checkpoint_read_row(file, state, y, error);
    if (status == STATUS_OK && file->has_search) status = read_search(file, state, error);
    if (status == STATUS_OK && file->left) status = fail_damaged(file, error);
    if (status != STATUS_OK) render_state_clear(state);
    return status;
}

/* ---- comparing ---- */

static const char *text_of(const CheckpointNotes *notes, const char *name)
{
    for (uint32_t i = 0; i < notes->n_facts; i++)
        if (strcmp(notes->facts[i].name, name) == 0) return notes->facts[i].text;
    return "none";
}

/* A hash that begins with "##" is said only where no other differs. */
static void add_difference(const CheckpointFact *a, const char *name_a, const char *b, const char *name_b,
                           bool *some_hash, Buf *text)
{
    if (strcmp(a->text, b) == 0) return;
    bool is_hash = *a->text == '#' || *b == '#', is_last = strncmp(a->text, "##", 2) == 0;
    if (is_last && *some_hash) return;
    *some_hash = *some_hash || is_hash;
    buf_add(text, text->length ? "; " : "");
    if (is_hash)
        buf_add(text, a->name);
    else
        buf_format(text, "%s: %s in %s, %s in %s", a->name, a->text, name_a, b, name_b);
}

void checkpoint_compare(const CheckpointNotes *a, const char *name_a, const CheckpointNotes *b, const char *name_b,
                        Buf *text)
{
    bool some_hash = false;
    for (uint32_t i = 0; i < a->n_facts; i++)
        add_difference(&a->facts[i], name_a, text_of(b, a->facts[i].name), name_b, &some_hash, text);
}

/* checkpoint_test.c - states of renders as files: what was written is read, joins are what one film would have, and damage is
 * refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"
#include "render/merge.h"
#include "temporary.h"

enum { WIDTH = 7, HEIGHT = 3, SAMPLES = 75 };

/* A sample as a render might have it: a function of the pixel and its number. Few are bright, things are many. */
static void sample_at(uint32_t pixel, uint32_t number, float rgb[3], uint32_t *thing)
{
    uint32_t h = hash_combine(pixel, number);
    for (uint32_t i = 0; i < 3; i++) rgb[i] = hash_to_unit_f(hash_combine(h, i));
    if (h % 16 == 0) rgb[h / 16 % 3] *= (float)(1 << h / 64 % 20);
    *thing = h % 7 == 0 ? BRIGHT_NOTHING : hash_u32(h) % (1 + number / 8);
}

static void state_begin(RenderState *state, uint32_t first)
{
    Error error;
    *state = (RenderState){.place = {.x = 1, .width = WIDTH + 1, .height = HEIGHT}};
    assert_int_equal(film_init(&state->film, WIDTH, HEIGHT, &error), STATUS_OK);
    assert_int_equal(film_catch(&state->film, &error), STATUS_OK);
    assert_int_equal(bright_film_init(&state->bright, first > 0, WIDTH, HEIGHT, &error), STATUS_OK);
    AovSet set = (AovSet)1 << AOV_CRYPTOMATTE | (AovSet)1 << AOV_DEPTH | (AovSet)1 << AOV_LIGHTS;
    LightGroups groups = light_groups_none();
    assert_int_equal(light_groups_add(&groups, "key"), 1);
    assert_int_equal(aov_film_init(&state->aovs, set, &groups, false, 0x1p-20, WIDTH, HEIGHT, &error), STATUS_OK);
    state->film.first_sample = first;
}

static void state_make(RenderState *state, uint32_t first, uint32_t end)
{
    state_begin(state, first);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++)
            for (uint32_t i = first; i < end; i++) {
                float rgb[3];
                uint32_t thing, pixel = y * WIDTH + x;
                sample_at(pixel, i, rgb, &thing);
                (void)film_add(&state->film, x, y, rgb, 1);
                if (thing % 2) film_add_caught(&state->film, x, y, rgb, (float[]){rgb[1], rgb[2], rgb[0]}, rgb[0]);
                bright_film_add(&state->bright, x, y, rgb, thing, &(Reflected){.mean = -1});
                assert_true(tally_add(&state->aovs.tallies[0][pixel], thing, 1));
            }
    state->counters.paths = (uint64_t)(end - first) * WIDTH * HEIGHT;
}

static Status state_write(const char *path, const RenderState *state, uint32_t first, uint32_t end, const char *seed)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    CheckpointNotes notes = {
        .samples = SAMPLES, .first_sample = first, .end_sample = end, .n_facts = 2, .n_attributes = 1};
    notes.facts[0] = (CheckpointFact){"seed", seed};
    notes.facts[1] = (CheckpointFact){"the lights", "#17"};
    notes.attributes[0] = (ImageAttribute){.name = "one", .type = ATTRIBUTE_FLOAT, .number = 0.1};
    Image image;
    Error error = {0};
    assert_int_equal(image_new(WIDTH, HEIGHT, names, COUNT_OF(names), &image, &error), STATUS_OK);
    Status status = checkpoint_write(path, state, &notes, &image, &(ExrOptions){0}, &error);
    image_clear(&image);
    return status;
}

static void states_are_equal(const RenderState *a, const RenderState *b)
{
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            size_t i = (size_t)y * WIDTH + x;
            const BrightPixel *p = &a->bright.pixels[i], *q = &b->bright.pixels[i];
            assert_memory_equal(film_pixel(&a->film, x, y), film_pixel(&b->film, x, y), sizeof(FilmPixel));
            assert_memory_equal(&a->film.caught[i], &b->film.caught[i], sizeof(FilmCaught));
            assert_memory_equal(p->rgb, q->rgb, sizeof p->rgb);
            assert_memory_equal(p->things, q->things, sizeof p->things);
            assert_memory_equal(p->counts, q->counts, sizeof p->counts);
            for (int k = 0; k < BRIGHT_KEPT && bright_light(p->rgb[k]) > 0; k++)
                assert_int_equal(bright_seen(p, k), bright_seen(q, k));
            const Tally *s = &a->aovs.tallies[0][i], *t = &b->aovs.tallies[0][i];
            assert_int_equal(s->n, t->n);
            assert_memory_equal(s->items, t->items, s->n * sizeof *s->items);
        }
    assert_true(a->counters.paths == b->counters.paths);
}

static void what_was_written_is_read(void **context)
{
    (void)context;
    const char *path = in_folder("state.exr");
    Error error = {0};
    for (uint32_t first = 0; first < 40; first += 13) {
        RenderState state, again;
        Checkpoint file;
        state_make(&state, first, SAMPLES);
        state.wanted = calloc(WIDTH * HEIGHT, sizeof *state.wanted);
        state.wanted[5] = 99;
        assert_int_equal(state_write(path, &state, first, SAMPLES, "0"), STATUS_OK);
        assert_int_equal(checkpoint_open(path, &file, &error), STATUS_OK);
        assert_int_equal(file.notes.first_sample, first);
        assert_int_equal(file.least_samples, SAMPLES - first);
        assert_string_equal(file.notes.attributes[0].name, "one");
        assert_true(file.notes.attributes[0].number == 0.1);
        assert_int_equal(checkpoint_read(&file, &again, &error), STATUS_OK);
        states_are_equal(&state, &again);
        assert_int_equal(again.wanted[5], 99);
        checkpoint_close(&file);
        render_state_clear(&state);
        render_state_clear(&again);
        unlink(path);
    }
}

/* Also of slices that end at powers of two, next to them, and hold one sample. */
static void slices_join_to_the_whole(void **context)
{
    (void)context;
    static const uint32_t ends[][6] = {{75},
                                       {1, 2, 3, 4, 5, 75},
                                       {8, 16, 32, 64, 75},
                                       {7, 9, 31, 65, 75},
                                       {33, 75},
                                       {64, 75},
                                       {63, 64, 75},
                                       {1, 75},
                                       {74, 75},
                                       {2, 40, 66, 75}};
    char paths[6][256];
    Error error = {0};
    RenderState whole;
    state_make(&whole, 0, SAMPLES);
    for (size_t k = 0; k < COUNT_OF(ends); k++) {
        const char *names[6];
        size_t n = 0;
        for (uint32_t first = 0; first < SAMPLES; first = ends[k][n++]) {
            RenderState slice;
            char name[16];
            snprintf(name, sizeof name, "%zu.exr", n);
            snprintf(paths[n], sizeof paths[n], "%s", in_folder(name));
            state_make(&slice, first, ends[k][n]);
            assert_int_equal(state_write(paths[n], &slice, first, ends[k][n], "0"), STATUS_OK);
            render_state_clear(&slice);
        }
        for (size_t i = 0; i < n; i++) names[i] = paths[n - 1 - i];
        Merge merge;
        RenderState merged;
        uint32_t gap = 0, end;
        assert_int_equal(merge_open(names, n, &merge, &error), STATUS_OK);
        assert_false(merge_find_gap(&merge, &gap, &end));
        assert_int_equal(merge_read(&merge, &merged, &error), STATUS_OK);
        states_are_equal(&whole, &merged);
        render_state_clear(&merged);
        merge_clear(&merge);
        for (size_t i = 0; i < n; i++) unlink(paths[i]);
    }
    render_state_clear(&whole);
}

/* The file with one byte of its state changed, or without its end. */
static void damage_is_refused(void **context)
{
    (void)context;
    const char *path = in_folder("state.exr");
    Error error = {0};
    RenderState state;
    char *bytes;
    size_t length;
    uint64_t begin;
    state_make(&state, 0, 9);
    assert_int_equal(state_write(path, &state, 0, 9, "0"), STATUS_OK);
    render_state_clear(&state);
    assert_int_equal(file_read(path, 0, &bytes, &length, &error), STATUS_OK);
    memcpy(&begin, bytes + length - 16, sizeof begin);
    for (size_t i = begin; i < 2 * length - begin; i += 1 + i / 97) {
        bool cut = i >= length;
        if (!cut) bytes[i] ^= 64;
        write_bytes(path, bytes, cut ? i - (length - begin) : length);
        if (!cut) bytes[i] ^= 64;
        Checkpoint file;
        error.text[0] = 0;
        Status status = checkpoint_open(path, &file, &error);
        if (status == STATUS_OK) status = checkpoint_read(&file, &state, &error);
        assert_int_equal(status, STATUS_INPUT);
        assert_non_null(strstr(error.text, path));
        checkpoint_close(&file);
    }
    free(bytes);
    unlink(path);
}

static void differences_are_named(void **context)
{
    (void)context;
    CheckpointNotes a = {.n_facts = 4}, b = {.n_facts = 4};
    Buf text = {0};
    for (int i = 0; i < 4; i++) {
        a.facts[i] = (CheckpointFact){(const char *[]){"seed", "the lights", "size", "the scene"}[i],
                                      (const char *[]){"1", "#2", "3", "##4"}[i]};
        b.facts[i] = a.facts[i];
    }
    checkpoint_compare(&a, "A", &b, "B", &text);
    assert_int_equal(text.length, 0);
    b.facts[0].text = "5";
    b.facts[1].text = "#6";
    b.facts[3].text = "##7";
    checkpoint_compare(&a, "A", &b, "B", &text);
    assert_string_equal(text.text, "seed: 1 in A, 5 in B; the lights");
    buf_clear(&text);
    b.facts[1].text = "#2";
    checkpoint_compare(&a, "A", &b, "B", &text);
    assert_string_equal(text.text, "seed: 1 in A, 5 in B; the scene");
    buf_clear(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_was_written_is_read),
                                       cmocka_unit_test(slices_join_to_the_whole), cmocka_unit_test(damage_is_refused),
                                       cmocka_unit_test(differences_are_named)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

/* arena.c - blocks that double in size, and the jump out when memory ends.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/arena.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct ArenaBlock {
    ArenaBlock *next;
    max_align_t bytes[];
};

enum { FIRST_BLOCK = 16 * 1024, LARGEST_STEP = 64 * 1024 * 1024 };

void arena_init(Arena *arena)
{
    *arena = (Arena){0};
}

void arena_clear(Arena *arena)
{
    for (ArenaBlock *block = arena->blocks; block;) {
        ArenaBlock *next = block->next;
        free(block);
        block = next;
    }
    *arena = (Arena){.escape = arena->escape};
}

void arena_reset(Arena *arena)
{
    ArenaBlock *newest = arena->blocks;
    if (!newest) return;
    for (ArenaBlock *block = newest->next; block;) {
        ArenaBlock *next = block->next;
        free(block);
        block = next;
    }
    newest->next = NULL;
    arena->used = 0;
    arena->total = arena->capacity;
}

void arena_fail(Arena *arena)
{
    if (arena->escape) longjmp(*arena->escape, 1);
    fputs("meniscus: out of memory outside of any guard\n", stderr);
    abort();
}

void *arena_alloc(Arena *arena, size_t size)
{
    const size_t align = _Alignof(max_align_t);
    if (size > SIZE_MAX - align - sizeof(ArenaBlock)) arena_fail(arena);
    size = (size + align - 1) / align * align;
    if (size > arena->capacity - arena->used) {
        size_t capacity = arena->capacity ? arena->capacity * 2 : FIRST_BLOCK;
        if (capacity > LARGEST_STEP) capacity = LARGEST_STEP;
        if (capacity < size) capacity = size;
        ArenaBlock *block = malloc(sizeof(ArenaBlock) + capacity);
        if (!block) arena_fail(arena);
        block->next = arena->blocks;
        arena->blocks = block;
        arena->used = 0;
        arena->capacity = capacity;
        arena->total += capacity;
    }
    void *memory = (char *)arena->blocks->bytes + arena->used;
    arena->used += size;
    memset(memory, 0, size);
    return memory;
}

void *arena_array(Arena *arena, size_t count, size_t size)
{
    if (size && count > SIZE_MAX / size) arena_fail(arena);
    return arena_alloc(arena, count * size);
}

void *arena_regrow(Arena *arena, const void *items, size_t n, size_t capacity, size_t size)
{
    void *grown = arena_array(arena, capacity, size);
    if (n) memcpy(grown, items, n * size);
    return grown;
}

char *arena_copy_text(Arena *arena, const char *text, size_t length)
{
    char *copy = arena_alloc(arena, length + 1);
    memcpy(copy, text, length);
    return copy;
}

char *arena_format_list(Arena *arena, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, format, again);
    va_end(again);
    size_t size = (size_t)(length < 0 ? 0 : length) + 1;
    char *text = arena_alloc(arena, size);
    vsnprintf(text, size, format, args);
    return text;
}

char *arena_format(Arena *arena, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *text = arena_format_list(arena, format, args);
    va_end(args);
    return text;
}

bool arena_guard(Arena *arena, void (*task)(void *context), void *context)
{
    jmp_buf here;
    jmp_buf *volatile outer = arena->escape;
    Arena *volatile guarded = arena;
    if (setjmp(here)) {
        guarded->escape = outer;
        return false;
    }
    arena->escape = &here;
    task(context);
    arena->escape = outer;
    return true;
}

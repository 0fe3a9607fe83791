/* arena.h - memory that is freed all at once.
 * An arena has one owner thread. Running out of memory in an arena does not return: it jumps to the
 * boundary set by arena_guard, because a parser or a scene builder has nothing sensible to do with
 * half a tree. Where an array can be huge or lives elsewhere, use malloc and a Status instead.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ARENA_H
#define MEN_ARENA_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/attr.h"

typedef struct ArenaBlock ArenaBlock;

typedef struct Arena {
    ArenaBlock *blocks;
    size_t used;     /* bytes handed out in the newest block */
    size_t capacity; /* of the newest block */
    size_t total;    /* bytes of all blocks, for limits and statistics */
    jmp_buf *escape; /* where to jump when memory runs out; set by arena_guard */
} Arena;

void arena_init(Arena *arena);
void arena_clear(Arena *arena);
/* Forgets all that was handed out; the newest block stays, to be used again. */
void arena_reset(Arena *arena);

/* Zeroed memory, aligned for any type. Jumps to the guard when there is none. */
void *arena_alloc(Arena *arena, size_t size) ATTR_NODISCARD;
/* count * size with a check for overflow. */
void *arena_array(Arena *arena, size_t count, size_t size) ATTR_NODISCARD;
/* A terminated copy of length bytes. */
char *arena_copy_text(Arena *arena, const char *text, size_t length) ATTR_NODISCARD;
char *arena_format(Arena *arena, const char *format, ...) ATTR_PRINTF(2, 3);
char *arena_format_list(Arena *arena, const char *format, va_list args) ATTR_PRINTF(2, 0);

#define ARENA_NEW(arena, Type) ((Type *)arena_alloc(arena, sizeof(Type)))
#define ARENA_ARRAY(arena, Type, count) ((Type *)arena_array(arena, count, sizeof(Type)))

/* Room for one more of n items of an array in the arena: doubles, from first items on. The old array stays where it was. */
#define ARENA_ROOM(arena, items, capacity, n, first)                                                                   \
    do                                                                                                                 \
        if ((n) == (capacity)) {                                                                                       \
            (capacity) = (capacity) ? (capacity)*2 : (first);                                                          \
            (items) = arena_regrow((arena), (items), (n), (capacity), sizeof *(items));                                \
        }                                                                                                              \
    while (0)
/* An array of capacity items of size bytes, of which the first n are those of items. */
void *arena_regrow(Arena *arena, const void *items, size_t n, size_t capacity, size_t size) ATTR_NODISCARD;

/* Jumps to the guard, as arena_alloc does, when memory that belongs to the same work ends elsewhere. Does not return. */
void arena_fail(Arena *arena) ATTR_NORETURN;

/* Runs task(context) with the arena guarded; returns false when memory ran out, true otherwise.
 * Guards nest. No C++ frame and no Embree callback may stand between the guard and the jump. */
bool arena_guard(Arena *arena, void (*task)(void *context), void *context) ATTR_NODISCARD;

#endif

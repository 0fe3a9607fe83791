/* memory.h - memory that was freed, and goes back to the system; how much there is; and memory that threads do not get in each other's way at.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MEMORY_H
#define MEN_MEMORY_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if defined(__GLIBC__)
#include <malloc.h>
/* After work that needed much memory for a while. The GNU C library keeps up to 64 MB of what is freed, if not told. */
static inline void memory_give_back(void)
{
    (void)malloc_trim(0);
}
#else
static inline void memory_give_back(void) {}
#endif

/* In bytes, used or not; 0: not known. */
static inline double memory_of_machine(void)
{
#ifdef _SC_PHYS_PAGES
    double pages = (double)sysconf(_SC_PHYS_PAGES), page = (double)sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? pages * page : 0;
#else
    return 0;
#endif
}

/* n items of `size` bytes, all zero, of which many are never touched: these take no memory, and there may be more of them than the
 * machine has memory for. NULL when that ends. memory_sparse_free frees what had as many bytes; NULL is nothing. */
void *memory_sparse(size_t n, size_t size);
void memory_sparse_free(void *memory, size_t bytes);

/* What one thread writes stands so far from what others do: a line of 64 bytes that two threads write goes back and forth
 * between them, and processors fetch lines in pairs. Such a struct has its first member aligned to it. */
#define MEMORY_APART 128

/* n such structs of `size` bytes, all zero; NULL when memory ends. free() frees them. */
static inline void *memory_apart(size_t n, size_t size)
{
    void *memory = n > SIZE_MAX / size ? NULL : aligned_alloc(MEMORY_APART, n * size);
    if (memory) memset(memory, 0, n * size);
    return memory;
}

#endif

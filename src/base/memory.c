/* memory.c - memory of which most is never touched.
 * SPDX-License-Identifier: Apache-2.0 */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#endif
#include "base/memory.h"

#include <sys/mman.h>

/* calloc() is refused what is obviously more than there is, whether it will be touched or not. Below this it never is, and tools
 * that look for mistakes see what it gives. */
#define MAPPED_FROM ((size_t)1 << 30)

#if defined(MAP_ANONYMOUS) && defined(MAP_NORESERVE) && SIZE_MAX > UINT32_MAX
void *memory_sparse(size_t n, size_t size)
{
    if (size == 0 || n > SIZE_MAX / size) return NULL;
    if (n * size < MAPPED_FROM) return calloc(n, size);
    void *memory = mmap(NULL, n * size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

void memory_sparse_free(void *memory, size_t bytes)
{
    if (!memory || bytes < MAPPED_FROM)
        free(memory);
    else
        (void)munmap(memory, bytes);
}
#else
void *memory_sparse(size_t n, size_t size)
{
    return calloc(n, size);
}

void memory_sparse_free(void *memory, size_t bytes)
{
    (void)bytes;
    free(memory);
}
#endif

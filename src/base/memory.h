/* memory.h - memory that was freed, and goes back to the system.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MEMORY_H
#define MEN_MEMORY_H

#include <stdlib.h>

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

#endif

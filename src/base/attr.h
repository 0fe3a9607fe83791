/* attr.h - compiler attributes behind names, so that the code stays C11 elsewhere.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ATTR_H
#define MEN_ATTR_H

#if defined(__GNUC__)
#define ATTR_PRINTF(text, first) __attribute__((format(printf, text, first)))
#define ATTR_NODISCARD __attribute__((warn_unused_result))
#define ATTR_NORETURN __attribute__((noreturn))
/* Seldom called: kept out of the way of what is called often. */
#define ATTR_COLD __attribute__((cold, noinline))
/* Kept out of its callers, so that their short ways need not save registers for it. */
#define ATTR_APART __attribute__((noinline))
#define LIKELY(x) __builtin_expect(!!(x), 1)
#define UNLIKELY(x) __builtin_expect(!!(x), 0)
/* What is read soon: brought near meanwhile. Nothing is read there. */
#define PREFETCH(address) __builtin_prefetch(address)
/* The number of the highest bit that is set of 64, of which one is. */
#define HIGHEST_BIT(x) (63U - (unsigned)__builtin_clzll(x))
#else
#define ATTR_PRINTF(text, first)
#define ATTR_NODISCARD
#define ATTR_NORETURN
#define ATTR_COLD
#define ATTR_APART
#define LIKELY(x) (x)
#define UNLIKELY(x) (x)
#define PREFETCH(address) ((void)(address))
static inline unsigned attr_highest_bit(unsigned long long x)
{
    unsigned n = 0;
    while (x >>= 1) n++;
    return n;
}
#define HIGHEST_BIT(x) attr_highest_bit(x)
#endif

#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

#endif

/* aov.h - what a picture can hold besides its colours, by name; render/aov_film makes it.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_AOV_H
#define MEN_AOV_H

#include <stddef.h>
#include <stdint.h>

typedef enum Aov {
#define AOV(key, name, channels, doc) AOV_##key,
#include "scene/aov.def"
#undef AOV
    AOV_COUNT
} Aov;

/* Bit 1 << AOV_... for each. */
typedef uint32_t AovSet;
#define AOV_SET_ALL (((AovSet)1 << AOV_COUNT) - 1)
/* Those of what is seen behind clear surfaces. */
#define AOV_SET_BEHIND (AOV_SET_ALL & ~(((AovSet)1 << AOV_BEHIND_ALBEDO) - 1))

const char *aov_name(Aov aov); /* as --aov takes it */
const char *
aov_channels(Aov aov);        /* with '|' between them; of AOV_LIGHTS for each group of lights, with its name for '*' */
const char *aov_doc(Aov aov); /* one sentence for the manual */
/* AOV_COUNT when there is none of that name, of which `length` bytes count. */
Aov aov_named(const char *name, size_t length);

#endif

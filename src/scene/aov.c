/* aov.c - the table that aov.def spells out.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/aov.h"

#include <string.h>

static const struct {
    const char *name, *channels, *doc;
} table[] = {
#define AOV(key, name, channels, doc) {name, channels, doc},
#include "scene/aov.def"
#undef AOV
};

const char *aov_name(Aov aov)
{
    return table[aov].name;
}

const char *aov_channels(Aov aov)
{
    return table[aov].channels;
}

const char *aov_doc(Aov aov)
{
    return table[aov].doc;
}

Aov aov_named(const char *name, size_t length)
{
    Aov aov = 0;
    while (aov < AOV_COUNT && (strlen(table[aov].name) != length || strncmp(table[aov].name, name, length) != 0)) aov++;
    return aov;
}

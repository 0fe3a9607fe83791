/* light_groups.h - names of groups of lights, of which pictures are told apart: a layer for what each group lights.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_GROUPS_H
#define MEN_LIGHT_GROUPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "diag/limits.h"

enum { LIGHT_GROUP_NAME_SIZE = 32 }; /* with its end: a part of a channel's name */

/* The first group is LIGHT_GROUP_OTHER, of all that say none. */
typedef struct LightGroups {
    uint32_t n; /* 1 where no light is in a group */
    char names[LIMIT_LIGHT_GROUPS][LIGHT_GROUP_NAME_SIZE];
} LightGroups;
#define LIGHT_GROUP_OTHER "other"

LightGroups light_groups_none(void);
/* Letters, digits, '_' and '-', and not too many of them. */
bool light_group_can_be(const char *name);
/* The number of a group; a new one is added. groups->n where there is no room for another. */
uint32_t light_groups_add(LightGroups *groups, const char *name);

#endif

/* light_groups.c - a table of names.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/light_groups.h"

#include <string.h>

LightGroups light_groups_none(void)
{
    return (LightGroups){.n = 1, .names = {LIGHT_GROUP_OTHER}};
}

bool light_group_can_be(const char *name)
{
    static const char fit[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    size_t length = strlen(name);
    return length > 0 && length < LIGHT_GROUP_NAME_SIZE && strspn(name, fit) == length;
}

uint32_t light_groups_add(LightGroups *groups, const char *name)
{
    uint32_t i = 0;
    while (i < groups->n && strcmp(groups->names[i], name) != 0) i++;
    if (i < groups->n || groups->n == LIMIT_LIGHT_GROUPS) return i;
    memcpy(groups->names[groups->n++], name, strlen(name) + 1);
    return i;
}

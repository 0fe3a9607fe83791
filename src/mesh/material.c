/* material.c - what a mesh file says that parts of it are made of: its rows, and telling it in words.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/material.h"

#include <stdlib.h>
#include <string.h>

#include "base/attr.h"

enum { LONGEST_SHOWN = 100 }; /* of a picture's name */

static const MaterialRow rows[] = {
#define FACT(key, at, n, otherwise, what, outer, extension, name, statement)                                           \
    {false, FACT_##key, at, n, otherwise, what, outer, extension, name, statement},
#define PICTURE(key, what, outer, extension, name, statement)                                                          \
    {true, PICTURE_##key, 0, 0, 0, what, outer, extension, name, statement},
#include "mesh/material.def"
#undef FACT
#undef PICTURE
};

const MaterialRow *material_row(size_t i)
{
    return i < COUNT_OF(rows) ? &rows[i] : NULL;
}

MeshMaterial material_new(const char *name, size_t length)
{
    MeshMaterial material = {.name = strndup(name, length)};
    for (int i = 0; i < PICTURE_COUNT; i++) material.pictures[i] = (MeshPicture){.image = UINT32_MAX, .scale = {1, 1}};
    for (size_t i = 0; i < COUNT_OF(rows); i++)
        for (int k = 0; k < 3 && !rows[i].is_picture; k++) material.facts[rows[i].key][k] = rows[i].otherwise;
    return material;
}

void material_clear(MeshMaterial *material)
{
    for (int i = 0; i < PICTURE_COUNT; i++) free(material->pictures[i].file);
    free(material->name);
    free(material->left_out);
    *material = (MeshMaterial){.name = NULL};
}

void material_set(MeshMaterial *material, const MaterialRow *row, const double *numbers)
{
    for (int k = 0; k < row->n; k++) material->facts[row->key][k] = numbers[k];
    material->given |= (uint64_t)1 << row->key;
}

/* A colour may have an opacity behind it that says nothing. */
static bool is_worth_telling(const MeshMaterial *material, const MaterialRow *row)
{
    if (row->is_picture) return picture_is_given(&material->pictures[row->key]);
    if (!row->what || !material_says(material, (MaterialFact)row->key)) return false;
    return row->key != FACT_OPACITY || material->facts[FACT_OPACITY][0] < 1;
}

bool material_says_something(const MeshMaterial *material)
{
    bool says = material->unlit;
    for (size_t i = 0; i < COUNT_OF(rows); i++) says = says || is_worth_telling(material, &rows[i]);
    return says;
}

void material_describe(const MeshMaterial *material, Buf *out)
{
    size_t begin = out->length;
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        const MaterialRow *row = &rows[i];
        if (!is_worth_telling(material, row)) continue;
        buf_format(out, "%s%s", out->length > begin ? ", " : "", row->what);
        const MeshPicture *picture = &material->pictures[row->is_picture ? row->key : 0];
        if (row->is_picture) {
            buf_add(out, " ");
            buf_add_shown(out, picture->file ? picture->file : "within the file", LONGEST_SHOWN);
        }
        for (int k = 0; k < row->n; k++) buf_format(out, " %.4g", material->facts[row->key][k]);
    }
    if (material->unlit) buf_format(out, "%sunlit", out->length > begin ? ", " : "");
}

/* material.h - what a mesh file says that parts of it are made of.
 * Meshes of a scene take none of it; `info` tells it, and `import` makes media and surfaces of it.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MATERIAL_H
#define MEN_MATERIAL_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"

typedef enum MaterialFact {
#define FACT(key, at, n, otherwise, what, outer, extension, name, statement) FACT_##key,
#define PICTURE(key, what, outer, extension, name, statement)
#include "mesh/material.def"
#undef FACT
#undef PICTURE
    FACT_COUNT
} MaterialFact;

typedef enum MaterialPicture {
#define FACT(key, at, n, otherwise, what, outer, extension, name, statement)
#define PICTURE(key, what, outer, extension, name, statement) PICTURE_##key,
#include "mesh/material.def"
#undef FACT
#undef PICTURE
    PICTURE_COUNT
} MaterialPicture;

/* A row of material.def. */
typedef struct MaterialRow {
    bool is_picture;
    int key; /* a MaterialFact or a MaterialPicture */
    int at, n;
    double otherwise;
    const char *what, *outer, *extension, *name, *statement;
} MaterialRow;

/* Whether alpha, 1 for opaque, cuts holes or lets through. */
typedef enum MaterialAlpha { ALPHA_OPAQUE, ALPHA_MASK, ALPHA_BLEND } MaterialAlpha;
typedef enum PictureWrap { PICTURE_WRAP_REPEAT, PICTURE_WRAP_CLAMP, PICTURE_WRAP_MIRROR } PictureWrap;

/* A picture of a material: in a file, or within the mesh file. */
typedef struct MeshPicture {
    char *file;     /* beside the mesh file, or absolute; owned; NULL: none, or within the mesh file */
    uint32_t image; /* the number among the images of the source; UINT32_MAX: none */
    PictureWrap wrap;
    bool other_wrap_upward;             /* than that, which is to the sides */
    bool second_uvs;                    /* it lies on other coordinates than the first */
    double offset[2], scale[2], turned; /* of the coordinates, v downward, as KHR_texture_transform has it; radians */
} MeshPicture;

typedef struct MeshMaterial {
    char *name; /* "": it has none; owned */
    double facts[FACT_COUNT]
                [3]; /* SPECULAR 0: it mirrors nothing; FILTER: the colour of what is clear; as the file says, or as
                                  * follows from other things that it says */
    uint64_t given;  /* bits 1 << FACT_...: those that the file says itself */
    MeshPicture pictures[PICTURE_COUNT];
    MaterialAlpha alpha;
    char *left_out;     /* the names of extensions of glTF that are not known; owned; NULL: none */
    bool unlit, volume; /* it has those extensions of glTF */
    bool
        packed; /* roughness is the green and metal the blue of one picture, and colours are factors of pictures: glTF */
} MeshMaterial;

_Static_assert(FACT_COUNT <= 64, "facts are bits of a number");

/* All rows, in the order of the table; NULL behind the last. */
const MaterialRow *material_row(size_t i);
/* A material that says nothing; the name is copied, and NULL where memory ended. */
MeshMaterial material_new(const char *name, size_t length);
void material_clear(MeshMaterial *material);
static inline bool material_says(const MeshMaterial *material, MaterialFact fact)
{
    return material->given >> fact & 1;
}
void material_set(MeshMaterial *material, const MaterialRow *row, const double *numbers);
static inline bool picture_is_given(const MeshPicture *picture)
{
    return picture->file || picture->image != UINT32_MAX;
}
bool material_says_something(const MeshMaterial *material);
/* In words: "base colour 0.8 0.1 0.1, index 1.5"; nothing where it says nothing. */
void material_describe(const MeshMaterial *material, Buf *out);

#endif

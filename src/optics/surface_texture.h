/* surface_texture.h - values that depend on the place on a surface: patterns and pictures, their values, and mixtures of
 * them. A texture refers to others before it in the same table, so that there are no circles.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SURFACE_TEXTURE_H
#define MEN_SURFACE_TEXTURE_H

#include "base/program.h"
#include "optics/color.h"
#include "optics/pattern.h"
#include "optics/texture_image.h"

#define TEXTURE_NONE UINT32_MAX

typedef enum TextureKind {
    TEXTURE_CONSTANT, /* value */
    TEXTURE_PATTERN,
    TEXTURE_IMAGE,
    TEXTURE_MIX,       /* by another texture */
    TEXTURE_VARIATION, /* by the object */
    TEXTURE_FORMULA    /* a function of the scene */
} TextureKind;

typedef enum TextureProjection {
    PROJECTION_UV,
    PROJECTION_PLANAR,      /* x and y, along z */
    PROJECTION_BOX,         /* along the axis that the normal is nearest to; between two, a mixture */
    PROJECTION_CYLINDRICAL, /* u: about y, counter-clockwise seen from above, the picture's middle at -x; v: y */
    PROJECTION_SPHERICAL    /* the same; v: from the south pole to the north one */
} TextureProjection;

typedef struct TextureStop {
    float at; /* 0..1, ascending */
    Spectrum value;
} TextureStop;

/* A number is a spectrum that is the same at all wavelengths: one kind of texture serves for colours and numbers. */
typedef struct Texture {
    TextureKind kind;
    bool in_world; /* placed in the world, not on the object */
    bool placed;   /* to_pattern is not the identity */
    bool is_value; /* IMAGE, FORMULA: its colours or numbers themselves are the value */
    bool shines;   /* FORMULA: colours are of light, not of reflectances */
    TextureProjection projection;
    TextureWrap wrap;
    double turns;      /* IMAGE, around an axis: the part of a turn that the picture takes */
    Affine to_pattern; /* from the object (or the world) to the pattern's own coordinates */
    double shrink;     /* how much smaller lengths are there, or larger: a mean */
    double vary;       /* each object has it shifted by up to this */
    double turbulence;
    unsigned turbulence_octaves;
    uint64_t seed;
    Pattern pattern;
    const TextureImage *image; /* not owned */
    const Program *program;    /* FORMULA; not owned */
    uint32_t low, high;        /* textures at 0 and 1 of the pattern; or else: */
    const TextureStop *stops;
    uint32_t n_stops;
    uint32_t blend;  /* MIX: a texture of numbers */
    Spectrum value;  /* CONSTANT */
    uint64_t source; /* IMAGE: of the name of its file, and how that is read */
    /* NULL, or n_keys of them: what it is at evenly spread times while the shutter is open, of the same kind and with as
     * many steps and stops. Their to_pattern goes the other way, from the pattern. */
    struct Texture *keys;
    uint32_t n_keys;
    const struct Texture *later; /* of one between two keys: the second, and how near it is; else NULL */
    float part;
} Texture;

/* Where textures are looked up. Object: in the frame that the object was described in, where textures stand still on it. */
typedef struct TexturePlace {
    Vec3 object, world;
    Vec3 object_normal,
        world_normal; /* outward, unit; of a smooth mesh the geometric one, or where textures ask for it, the smooth one */
    float uv[2];
    Vec3 du, dv;      /* how fast u and v change, along the surface, per object length */
    double footprint; /* what is smaller than this length in the object's frame need not be told apart */
    double world_footprint;
    uint64_t identity; /* of the object */
    double time;       /* of the shutter */
} TexturePlace;

/* The value for each of the wavelengths. */
Lanes texture_at(const Texture *textures, uint32_t number, const TexturePlace *place, Lanes wavelength_nm);
/* The same at several, COLOR_FOURS at most: what does not depend on them is looked up once. */
void texture_at_each(const Texture *textures, uint32_t number, const TexturePlace *place, const Wavelengths *at,
                     Lanes *values);
/* A number. */
float texture_number_at(const Texture *textures, uint32_t number, const TexturePlace *place);
/* The three numbers of an image's pixel. */
Vec3f texture_vector_at(const Texture *texture, const TexturePlace *place);
/* What a formula is asked for at a place. */
void texture_formula_inputs(const Texture *texture, const TexturePlace *place, double inputs[PROGRAM_INPUTS]);
/* The same place, moved by a small offset along the surface: object_offset in the object's frame, world_offset the same in
 * the world. */
TexturePlace texture_place_moved(const TexturePlace *place, Vec3 object_offset, Vec3 world_offset);

#endif

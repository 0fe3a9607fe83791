/* bsdf_cases.h - surfaces of every kind, for the tests of bsdf.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BSDF_CASES_H
#define MEN_BSDF_CASES_H

#include <string.h>

#include "base/hash.h"
#include "optics/bsdf_spec.h"

typedef struct BsdfCase {
    const char *name;
    float roughness, other; /* other: index behind, metalness, diffuse roughness, ... */
    float spread;           /* of the indices over the wavelengths */
    float zoom;             /* angle about which the narrowest lobe is wide; > 0: straight on, < 0: mirrored; 0: wide */
} BsdfCase;

/* name, roughness, other, spread, zoom */
static const BsdfCase bsdf_cases[] = {
    {"boundary", 0.25f, 1.5f, 0, 0.3f},
    {"boundary", 0.5f, 1.5f, 0, 0},
    {"boundary", 1, 1.5f, 0, 0},
    {"boundary", 0.5f, 1.02f, 0, 0.1f},
    {"boundary", 0.9f, 2.42f, 0.05f, 0},
    {"boundary", 0.5f, 1.52f, 0.03f, 0},
    {"boundary in", 0.3f, 1.5f, 0, 0},
    {"boundary in", 0.7f, 1.33f, 0.01f, 0},
    {"boundary in", 1, 2.42f, 0.05f, 0},
    {"boundary in", 0.5f, 1.05f, 0, 0.4f},
    {"boundary crossing", 0.6f, 1, 0.02f, 0.1f},
    {"boundary aniso", 0.7f, 1.5f, 0, 0},
    {"boundary aniso", 0.9f, 1.52f, 0.02f, 0},
    {"boundary in aniso", 0.7f, 1.5f, 0, 0},
    {"boundary in aniso", 0.9f, 2.42f, 0.05f, 0},
    {"conductor", 0.25f, 0.2f, 1, -0.15f},
    {"conductor", 0.6f, 1.2f, 0.3f, 0},
    {"conductor aniso", 1, 0.2f, 1, 0},
    {"diffuse", 0, 0.5f, 0.3f, 0},
    {"diffuse", 1, 0.8f, 0.2f, 0},
    {"plastic", 0, 1.5f, 0.02f, 0},
    {"plastic", 0.4f, 1.5f, 0.02f, -0.5f},
    {"plastic", 1, 1.128f, 0.02f, 0},
    {"plastic", 0.5f, 0.9f, 0.01f, 0},
    {"plastic aniso", 0.7f, 1.5f, 0.02f, 0},
    {"plastic aniso", 0.6f, 0.9f, 0.01f, 0},
    {"plastic tinted", 0.3f, 1.5f, 0, 0},
    {"sheet", 0.4f, 1.5f, 0.02f, 0},
    {"sheet tinted", 0.8f, 1.5f, 0, 0},
    {"sheet aniso", 0.6f, 1.5f, 0, 0},
    {"sheet film", 0.5f, 1.33f, 0.01f, 0},
    {"translucent", 0.5f, 0, 0, 0},
    {"translucent", 0.2f, 0.8f, 0, 0},
    {"fuzz", 0.5f, 0.2f, 0, 0},
    {"fuzz metal", 0.6f, 0.9f, 0, 0},
    {"fuzz aniso", 0.7f, 0.4f, 0, 0},
    {"coated", 0.3f, 1.5f, 0.02f, -0.3f},
    {"coated", 0, 0.85f, 0.01f, 0},
    {"coated aniso", 0.7f, 1.5f, 0.02f, 0},
    {"coated metal aniso", 0.7f, 1.5f, 0.02f, 0},
    {"coated metal", 0.4f, 0.8f, 0.01f, 0},
    {"coated metal", 0.5f, 1.6f, 0.02f, 0},
    {"coated metal tinted", 0, 1.5f, 0.02f, 0},
    {"principled", 0.4f, 0.5f, 0.02f, 0},
    {"principled fuzzy", 0.4f, 0.5f, 0.02f, 0},
    {"principled", 0.8f, 0.3f, 0, 0},
    {"principled smooth", 0.5f, 0.4f, 0.02f, 0},
};
enum { BSDF_CASES = sizeof bsdf_cases / sizeof *bsdf_cases };

/* centre * (1 + spread * -1 .. 2), by a wavelength's number; the path's first is `hero` */
static inline Lanes case_lanes(float centre, float spread, int hero)
{
    Lanes result = lanes_all(0);
    for (int i = 0; i < LANES; i++) lanes_set(&result, i, centre * (1 + spread * (float)((i + hero) % LANES - 1)));
    return result;
}

/* phase: of a way to and fro in it, head on */
static inline ThinFilm case_film(Lanes ior, Lanes phase)
{
    return (ThinFilm){ior, lanes_div(phase, ior)};
}

/* behind: as seen from the other side. Returns n^2 of the medium in front; and of the one behind. */
static inline Lanes case_make(const BsdfCase *c, int hero, bool behind, Bsdf *bsdf, Lanes *square_behind)
{
    float alpha = c->roughness * c->roughness, alpha_y = alpha;
    if (strstr(c->name, "aniso")) alpha_y *= 0.3f;
    Lanes front = lanes_all(1), back = front, tint = lanes_all(1);
    if (strstr(c->name, "tinted")) tint = case_lanes(0.6f, 0.2f, hero);
    bsdf_begin(bsdf);
    if (!strncmp(c->name, "boundary", 8)) {
        back = case_lanes(c->other, c->spread, hero);
        bool swap = behind != (strstr(c->name, " in") != NULL);
        bsdf_add_boundary(bsdf, 1, swap ? back : front, swap ? front : back, alpha, alpha_y, NULL);
        Lanes square = lanes_mul(back, back);
        *square_behind = swap ? front : square;
        return swap ? square : front;
    }
    *square_behind = front;
    if (!strncmp(c->name, "conductor", 9))
        bsdf_add_conductor(bsdf, 1, case_lanes(c->other, 0.3f * c->spread, hero), case_lanes(3, 0.2f, hero), alpha,
                           alpha_y, NULL);
    else if (!strncmp(c->name, "diffuse", 7))
        bsdf_add_diffuse(bsdf, 1, case_lanes(c->other, c->spread, hero), c->roughness);
    else if (!strncmp(c->name, "plastic", 7))
        bsdf_add_plastic(bsdf, 1, case_lanes(c->other, c->spread, hero), alpha, alpha_y, tint,
                         case_lanes(0.6f, 0.3f, hero), 0.4f);
    else if (!strncmp(c->name, "sheet", 5)) {
        const ThinFilm film = case_film(case_lanes(c->other, c->spread, hero), case_lanes(9, 0.2f, hero));
        bsdf_add_sheet(bsdf, 1, film.ior, alpha, alpha_y, tint, strstr(c->name, "film") ? &film : NULL);
    } else if (!strncmp(c->name, "translucent", 11)) {
        bsdf_add_diffuse(bsdf, 0.4f, case_lanes(0.5f, 0.3f, hero), c->roughness);
        bsdf_add_translucent(bsdf, 0.6f, case_lanes(0.6f, 0.3f, hero));
        if (c->other > 0) bsdf_set_fuzz(bsdf, c->other, case_lanes(0.6f, 0.3f, hero), c->roughness);
    } else if (!strncmp(c->name, "fuzz", 4)) {
        Lanes color = case_lanes(0.7f, 0.2f, hero), eta = case_lanes(1.5f, 0.02f, hero);
        if (strstr(c->name, "metal"))
            bsdf_add_conductor(bsdf, 1, case_lanes(0.2f, 0.3f, hero), case_lanes(3, 0.2f, hero), alpha, alpha, NULL);
        else
            bsdf_add_plastic(bsdf, 1, eta, alpha, alpha_y, tint, color, 0.3f);
        bsdf_set_fuzz(bsdf, 0.9f, case_lanes(0.6f, 0.3f, hero), c->other);
    } else if (!strncmp(c->name, "coated", 6)) {
        Lanes color = case_lanes(0.6f, 0.3f, hero);
        bsdf_begin_coat(bsdf, case_lanes(c->other, c->spread, hero), alpha, alpha_y, tint);
        if (strstr(c->name, "metal"))
            bsdf_add_conductor(bsdf, 1, case_lanes(0.2f, 0.3f, hero), case_lanes(3, 0.2f, hero), 0.2f, 0.2f, NULL);
        else {
            bsdf_add_mirrors(bsdf, 0.1f, 0.3f, 0.1f);
            bsdf_add_diffuse(bsdf, 0.9f, color, 0.7f);
        }
        bsdf_end_coat(bsdf);
    } else {
        bool smooth = strstr(c->name, "smooth");
        Lanes eta = case_lanes(1.5f, c->spread, hero);
        bsdf_add_conductor(bsdf, 0.1f * c->other, lanes_all(0.2f), case_lanes(3, 0.2f, hero), alpha, alpha, NULL);
        bsdf_add_plastic(bsdf, 0.7f * c->other, eta, smooth ? 0 : alpha, smooth ? 0 : alpha_y, tint,
                         case_lanes(0.5f, 0.3f, hero), c->roughness);
        bsdf_begin_coat(bsdf, case_lanes(1.6f, c->spread, hero), smooth ? 0 : 0.05f, smooth ? 0 : 0.05f,
                        case_lanes(0.8f, 0.1f, hero));
        bsdf_add_conductor(bsdf, 0.2f * c->other, lanes_all(0.2f), case_lanes(3, 0.2f, hero), alpha, alpha, NULL);
        bsdf_add_diffuse(bsdf, 0.3f * (1 - c->other), case_lanes(0.5f, 0.3f, hero), 0.5f);
        bsdf_end_coat(bsdf);
        bsdf_add_sheet(bsdf, 0.7f * (1 - c->other), eta, alpha, alpha, tint, NULL);
        if (strstr(c->name, "fuzzy")) bsdf_set_fuzz(bsdf, 0.5f, case_lanes(0.8f, 0.1f, hero), 0.3f);
    }
    return front;
}

static inline float random_unit(uint32_t *state)
{
    return hash_to_unit_f(hash_u32(++*state));
}

/* Any surface that a scene can describe, number i; white: all that does not absorb. */
static inline void spec_at_random(uint32_t *state, int i, bool white, BsdfSpec *spec)
{
    bsdf_spec_init(spec);
    spec->base_color = spectrum_constant(white ? 1 : random_unit(state));
    spec->base_diffuse_roughness = random_unit(state);
    spec->base_metalness = i % 2 ? 0 : random_unit(state);
    spec->specular_ior = spectrum_constant(1.05f + 1.5f * random_unit(state));
    spec->specular_roughness = random_unit(state);
    spec->specular_roughness_anisotropy = i % 3 ? random_unit(state) : 0;
    spec->specular_weight = random_unit(state);
    spec->thin_walled = i % 4 == 1;
    spec->transmission_weight = i % 4 < 2 ? random_unit(state) : 0;
    spec->translucency = random_unit(state);
    if (i % 8 == 1) spec->film_thickness_nm = 900 * random_unit(state);
    spec->coat_weight = i % 5 < 2 ? 0 : random_unit(state);
    spec->coat_ior = spectrum_constant(1.1f + random_unit(state));
    spec->coat_roughness = random_unit(state);
    spec->coat_roughness_anisotropy = i % 3 == 1 ? random_unit(state) : 0;
    if (!white) spec->coat_color = spectrum_constant(random_unit(state));
    spec->fuzz_weight = i % 7 < 3 ? 0 : random_unit(state);
    spec->fuzz_roughness = random_unit(state);
    if (!white) spec->fuzz_color = spectrum_constant(random_unit(state));
}

/* What it is like, for messages. */
static inline void spec_print(const BsdfSpec *s, float medium)
{
    printf(
        "in %.2f: metal %.2f, ior %.2f, roughness %.2f, anisotropy %.2f, clear %.2f%s, coat %.2f of %.2f, rough %.2f, "
        "stretched %.2f, fuzz %.2f\n",
        (double)medium, (double)s->base_metalness, (double)s->specular_ior.value[0], (double)s->specular_roughness,
        (double)s->specular_roughness_anisotropy, (double)s->transmission_weight, s->thin_walled ? " thin" : "",
        (double)s->coat_weight, (double)s->coat_ior.value[0], (double)s->coat_roughness,
        (double)s->coat_roughness_anisotropy, (double)s->fuzz_weight);
}

static inline Vec3f direction_at(float z, float angle)
{
    float radius = sqrtf(float_max(0, 1 - z * z));
    return vec3f(radius * cosf(angle), radius * sinf(angle), z);
}

#endif

/* bsdf_spec.c - from the parameters of a surface to its lobes.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_spec.h"

#include "optics/fresnel.h"

/* Where something is asked at one wavelength that is the same at all. */
static const float any_nm = 550;

void bsdf_spec_init(BsdfSpec *spec)
{
    *spec = (BsdfSpec){
        .base_color = spectrum_constant(0.8f),
        .specular_weight = 1,
        .specular_roughness = 0.3f,
        .specular_ior = spectrum_constant(1.5f),
        .transmission_color = spectrum_constant(1),
        .coat_color = spectrum_constant(1),
        .coat_ior = spectrum_constant(1.6f),
        .fuzz_color = spectrum_constant(1),
        .fuzz_roughness = 0.5f,
        .film_ior = spectrum_constant(1.4f),
        .film_thickness_nm = -1,
    };
}

void bsdf_alphas(float roughness, float anisotropy, float *alpha_x, float *alpha_y)
{
    float alpha = roughness * roughness, across = 1 - anisotropy;
    *alpha_x = alpha * sqrtf(2 / (1 + across * across));
    *alpha_y = across * *alpha_x;
    *alpha_x = float_min(*alpha_x, 1);
}

/* The real index 1 and the imaginary part that reflect `reflectance` head on. */
static Lanes metal_of_reflectance(Lanes reflectance)
{
    /* head on, with n = 1: R = k^2 / (4 + k^2) */
    Lanes held = lanes_clamp(reflectance, 0, 0.9999f);
    return lanes_scale(lanes_sqrt(lanes_div(held, lanes_rest(held))), 2);
}

Lanes bsdf_weakened(Lanes eta, float weight)
{
    if (!(weight < 1)) return eta;
    Lanes root =
        lanes_scale(lanes_div(lanes_sub(eta, lanes_all(1)), lanes_add(eta, lanes_all(1))), sqrtf(float_max(weight, 0)));
    return lanes_div(lanes_add(lanes_all(1), root), lanes_rest(root));
}

/* What is asked of all lobes of one surface. */
typedef struct Making {
    const BsdfSpec *spec;
    const BsdfKept *kept;
    Bsdf *bsdf;
    Lanes nm, eta_i, base_color;
    float alpha_x, alpha_y;
} Making;

static Lanes at(const Making *m, const Spectrum *spectrum)
{
    return spectrum_at(spectrum, m->nm);
}

/* The surface's film, of that index, relative to a medium; NULL: it has none. */
static const ThinFilm *film_of(const Making *m, const Spectrum *ior, Lanes medium, ThinFilm *room)
{
    if (m->spec->film_thickness_nm < 0) return NULL;
    *room = thin_film_make(at(m, ior), medium, m->spec->film_thickness_nm, m->nm);
    return room;
}

static void add_metal(const Making *m, float share, Lanes above)
{
    Lanes n = lanes_all(1), k;
    if (m->spec->measured_metal) {
        n = lanes_div(at(m, &m->spec->metal_n), above);
        k = lanes_div(at(m, &m->spec->metal_k), above);
    } else {
        k = metal_of_reflectance(m->base_color);
    }
    ThinFilm film;
    bsdf_add_conductor(m->bsdf, share, n, k, m->alpha_x, m->alpha_y, film_of(m, &m->spec->film_ior, above, &film));
}

static void add_dielectric(const Making *m, float share)
{
    const BsdfSpec *spec = m->spec;
    if (m->kept->skin) {
        bsdf_add_plastic_kept(m->bsdf, share, m->kept->skin, m->base_color, spec->base_diffuse_roughness);
    } else if (spec->specular_weight > 0) {
        Lanes eta = bsdf_weakened(lanes_div(at(m, &spec->specular_ior), m->eta_i), spec->specular_weight);
        bsdf_add_plastic(m->bsdf, share, eta, m->alpha_x, m->alpha_y, lanes_all(1), m->base_color,
                         spec->base_diffuse_roughness);
    } else {
        bsdf_add_diffuse(m->bsdf, share, m->base_color, spec->base_diffuse_roughness);
    }
}

float bsdf_inner_reflectance(const BsdfSpec *spec, Lanes eta_i, Lanes wavelength_nm)
{
    if (!(spec->specular_weight > 0)) return 0;
    Lanes coat_ior = spectrum_at(&spec->coat_ior, wavelength_nm), eta = lanes_div(coat_ior, eta_i);
    Lanes base = lanes_div(spectrum_at(&spec->specular_ior, wavelength_nm), coat_ior);
    return lanes_mean(layer_inner_reflectance(eta, lanes_mul(bsdf_weakened(base, spec->specular_weight), eta)));
}

static void begin_coat(const Making *m, Lanes coat_ior)
{
    const BsdfSpec *spec = m->spec;
    float coat_x, coat_y;
    if (m->kept->coat) {
        bsdf_begin_coat_kept(m->bsdf, m->kept->coat);
        return;
    }
    bsdf_alphas(spec->coat_roughness, spec->coat_roughness_anisotropy, &coat_x, &coat_y);
    bsdf_begin_coat(m->bsdf, lanes_div(coat_ior, m->eta_i), coat_x, coat_y, at(m, &spec->coat_color));
}

/* All that a coat covers, where it does. */
static void add_coated(const Making *m, float metal, float dielectric)
{
    const BsdfSpec *spec = m->spec;
    bool inner_kept = m->kept->coat && m->kept->inner >= 0;
    float skin = 0;
    Lanes coat_ior = at(m, &spec->coat_ior);
    begin_coat(m, coat_ior);
    if (metal > 0) add_metal(m, metal, coat_ior);
    if (dielectric > 0) skin = inner_kept ? m->kept->inner : bsdf_inner_reflectance(spec, m->eta_i, m->nm);
    bsdf_add_mirrors(m->bsdf, dielectric * skin, m->alpha_x, m->alpha_y);
    bsdf_add_diffuse(m->bsdf, dielectric * (1 - skin), m->base_color, spec->base_diffuse_roughness);
    bsdf_end_coat(m->bsdf);
}

static void add_clear(const Making *m, float share, Lanes eta_t)
{
    const BsdfSpec *spec = m->spec;
    ThinFilm film;
    if (!spec->thin_walled) {
        bsdf_add_boundary(m->bsdf, share, m->eta_i, eta_t, m->alpha_x, m->alpha_y,
                          film_of(m, &spec->film_ior, lanes_all(1), &film));
        return;
    }
    Lanes eta = bsdf_weakened(lanes_div(at(m, &spec->specular_ior), m->eta_i), spec->specular_weight);
    const bool filmed = film_of(m, &spec->specular_ior, m->eta_i, &film);
    if (filmed)
        film = (ThinFilm){eta, lanes_mul(film.delay, lanes_div(film.ior, eta))}; /* weakened, as long on its way */
    bsdf_add_sheet(m->bsdf, share, eta, m->alpha_x, m->alpha_y, at(m, &spec->transmission_color),
                   filmed ? &film : NULL);
}

void bsdf_from_spec(const BsdfSpec *spec, Lanes wavelength_nm, Lanes eta_i, Lanes eta_t, const BsdfKept *kept,
                    Bsdf *bsdf)
{
    static const BsdfKept nothing = {.inner = -1};
    if (!kept) kept = &nothing;
    float metal = spec->base_metalness, clear = (1 - metal) * spec->transmission_weight, opaque = 1 - metal - clear;
    float translucent = spec->thin_walled ? opaque * spec->translucency : 0, coat = spec->coat_weight;
    Making m = {.spec = spec, .kept = kept, .bsdf = bsdf, .nm = wavelength_nm, .eta_i = eta_i};
    m.base_color = at(&m, &spec->base_color);
    bsdf_alphas(spec->specular_roughness, spec->specular_roughness_anisotropy, &m.alpha_x, &m.alpha_y);
    opaque -= translucent;
    bsdf_begin(bsdf);
    bsdf_set_balance(bsdf, kept->balance);
    if (metal * (1 - coat) > 0) add_metal(&m, metal * (1 - coat), eta_i);
    if (opaque * (1 - coat) > 0) add_dielectric(&m, opaque * (1 - coat));
    if (coat > 0 && metal + opaque > 0) add_coated(&m, metal * coat, opaque * coat);
    bsdf_add_translucent(bsdf, translucent, m.base_color);
    if (clear > 0) add_clear(&m, clear, eta_t);
    if (spec->fuzz_weight > 0)
        bsdf_set_fuzz(bsdf, spec->fuzz_weight, spectrum_at(&spec->fuzz_color, wavelength_nm), spec->fuzz_roughness);
}

bool bsdf_skin_look(const BsdfSpec *spec, float eta_i, LayerLook *look)
{
    if (!(spec->specular_weight > 0) || !spectrum_is_constant(&spec->specular_ior)) return false;
    float ior = spectrum_at_one(&spec->specular_ior, any_nm);
    *look = (LayerLook){.eta = lanes_get(bsdf_weakened(lanes_all(ior / eta_i), spec->specular_weight), 0), .tint = 1};
    bsdf_alphas(spec->specular_roughness, spec->specular_roughness_anisotropy, &look->alpha_x, &look->alpha_y);
    return true;
}

bool bsdf_coat_look(const BsdfSpec *spec, float eta_i, LayerLook *look)
{
    if (!(spec->coat_weight > 0) || !spectrum_is_constant(&spec->coat_ior) || !spectrum_is_constant(&spec->coat_color))
        return false;
    *look = (LayerLook){.eta = spectrum_at_one(&spec->coat_ior, any_nm) / eta_i,
                        .tint = spectrum_at_one(&spec->coat_color, any_nm)};
    bsdf_alphas(spec->coat_roughness, spec->coat_roughness_anisotropy, &look->alpha_x, &look->alpha_y);
    return true;
}

void bsdf_mix_metal(const BsdfSpec *spec, const Lanes *wavelength_nm, int n, Lanes *reflectance)
{
    const float part = spec->measured_metal ? spec->base_metalness : 0;
    for (int i = 0; i < n && part > 0; i++) {
        Lanes metal = fresnel_conductor(1, spectrum_at(&spec->metal_n, wavelength_nm[i]),
                                        spectrum_at(&spec->metal_k, wavelength_nm[i]));
        reflectance[i] = lanes_add(lanes_scale(reflectance[i], 1 - part), lanes_scale(metal, part));
    }
}

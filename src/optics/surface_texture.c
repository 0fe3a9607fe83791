/* surface_texture.c - looking up textures.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/surface_texture.h"

#include "base/angle.h"
#include "base/attr.h"
#include "base/hash.h"
#include "optics/color.h"

/* Wavelengths for textures of numbers, which do not depend on them. */
static Lanes any_wavelength(void)
{
    return lanes_all(550);
}

/* ---- when ---- */

static double mix(double a, double b, double part)
{
    return a + (b - a) * part;
}

static void mix_patterns(const Pattern *to, double part, Pattern *now)
{
    const Pattern from = *now;
    now->size = vec3_along(from.size, part, vec3_sub(to->size, from.size));
    now->mortar = mix(from.mortar, to->mortar, part);
    now->bevel = mix(from.bevel, to->bevel, part);
    now->bond = mix(from.bond, to->bond, part);
    now->frequency = mix(from.frequency, to->frequency, part);
    now->phase = mix(from.phase, to->phase, part);
    now->lacunarity = mix(from.lacunarity, to->lacunarity, part);
    now->gain = mix(from.gain, to->gain, part);
    now->grain = mix(from.grain, to->grain, part);
    now->radius = mix(from.radius, to->radius, part);
    now->blur = mix(from.blur, to->blur, part);
}

/* A texture that changes while the shutter is open, as it is at a time. Between keys it goes straight, its place as an
 * object's does. */
static void texture_between(const Texture *texture, double time, Texture *now)
{
    uint32_t last = texture->n_keys - 1;
    double place = time * last;
    uint32_t k = place < last - 1 ? (uint32_t)place : last - 1;
    const Texture *from = &texture->keys[k], *to = from + 1;
    double part = place - k;
    *now = *from;
    now->later = to;
    now->part = (float)part;
    now->vary = mix(from->vary, to->vary, part);
    now->turns = mix(from->turns, to->turns, part);
    now->turbulence = mix(from->turbulence, to->turbulence, part);
    if (texture->kind == TEXTURE_PATTERN) mix_patterns(&to->pattern, part, &now->pattern);
    if (!from->placed) return;
    const Affine ends[2] = {from->to_pattern, to->to_pattern};
    Affine from_pattern = affine_between(ends, 2, part);
    if (!affine_invert(&from_pattern, &now->to_pattern)) /* on its way to the other side it is flat for a moment */
        now->to_pattern = affine_identity();
    now->shrink = cbrt(fabs(affine_determinant(&now->to_pattern)));
}

/* ---- where ---- */

/* A place in a texture's own coordinates. */
typedef struct LocalPlace {
    Vec3 p, normal;
    double footprint;
    double unplaced; /* the footprint before the texture's place */
} LocalPlace;

static Vec3 shift_of_object(uint64_t identity, uint64_t seed, double vary)
{
    uint64_t h = hash_u64(hash_u64(identity) ^ seed);
    double shift[3];
    for (int i = 0; i < 3; i++, h = hash_u64(h)) shift[i] = vary * (2 * hash_to_unit(h) - 1);
    return vec3(shift[0], shift[1], shift[2]);
}

static LocalPlace local_place(const Texture *texture, const TexturePlace *place)
{
    LocalPlace local =
        texture->in_world
            ? (LocalPlace){.p = place->world, .normal = place->world_normal, .unplaced = place->world_footprint}
            : (LocalPlace){.p = place->object, .normal = place->object_normal, .unplaced = place->footprint};
    local.footprint = local.unplaced;
    if (texture->vary > 0) local.p = vec3_add(local.p, shift_of_object(place->identity, texture->seed, texture->vary));
    if (texture->placed) {
        local.p = affine_point(&texture->to_pattern, local.p);
        local.normal = affine_vector(&texture->to_pattern, local.normal);
        double length = vec3_length(local.normal);
        if (length > 0) local.normal = vec3_scale(local.normal, 1 / length);
        local.footprint *= texture->shrink;
    }
    return local;
}

/* How wide the footprint is along a direction of unit length in the texture's coordinates: however the texture is stretched
 * across that is no matter. */
static double width_along(const Texture *texture, const LocalPlace *local, Vec3 direction)
{
    if (texture->placed) direction = affine_normal(&texture->to_pattern, direction);
    return local->unplaced * vec3_length(direction);
}

static LocalPlace warped_place(const Texture *texture, const TexturePlace *place)
{
    LocalPlace local = local_place(texture, place);
    if (texture->turbulence != 0)
        local.p = vec3_along(local.p, texture->turbulence,
                             pattern_turbulence(local.p, texture->turbulence_octaves, local.footprint, ~texture->seed));
    return local;
}

static void parts_of_pattern(const Texture *texture, const TexturePlace *place, PatternParts *parts)
{
    LocalPlace local = warped_place(texture, place);
    PatternPlace at = {local.p, local.normal, local.footprint};
    pattern_parts(&texture->pattern, &at, parts);
}

static double pattern_part(const Texture *texture, const TexturePlace *place)
{
    PatternParts parts;
    parts_of_pattern(texture, place, &parts);
    double sum = 0;
    for (int i = 0; i < parts.n; i++) sum += parts.part[i] * parts.value[i];
    return sum;
}

/* ---- formulas ---- */

void texture_formula_inputs(const Texture *texture, const TexturePlace *place, double inputs[PROGRAM_INPUTS])
{
    LocalPlace local = warped_place(texture, place);
    Vec3 uv = vec3((double)place->uv[0], (double)place->uv[1], 0);
    if (texture->placed) uv = affine_point(&texture->to_pattern, uv);
    const double values[PROGRAM_INPUTS] = {local.p.x,      local.p.y, local.p.z, local.normal.x, local.normal.y,
                                           local.normal.z, uv.x,      uv.y,      local.footprint};
    for (int i = 0; i < PROGRAM_INPUTS; i++) inputs[i] = values[i];
}

/* What is no number counts as 0. Returns how many there are. */
static uint32_t run_formula(const Texture *texture, const TexturePlace *place, double outputs[PROGRAM_MOST_OUTPUTS])
{
    double inputs[PROGRAM_INPUTS];
    texture_formula_inputs(texture, place, inputs);
    if (texture->later)
        program_run_between(texture->program, texture->later->program, (double)texture->part, inputs, outputs);
    else
        program_run(texture->program, inputs, outputs);
    for (uint32_t i = 0; i < texture->program->n_outputs; i++)
        if (!isfinite(outputs[i])) outputs[i] = 0;
    return texture->program->n_outputs;
}

/* Red, green and blue as the spectrum that they stand for: of light, where the texture shines. */
static void spectrum_of_color(const Texture *texture, const double rgb[3], const Wavelengths *at, Lanes *values)
{
    float held[3], coefficients[3];
    for (int i = 0; i < 3; i++) held[i] = (float)fmax(rgb[i], 0);
    float scale = texture->shines ? upsample_light(held, coefficients) : upsample_reflectance(held, coefficients);
    for (int k = 0; k < at->n; k++) {
        Lanes nm = at->nm[k], value = lanes_scale(upsample_at(coefficients, nm), scale);
        values[k] = texture->shines ? lanes_mul(value, white_at(nm)) : value;
    }
}

static void formula_value(const Texture *texture, const TexturePlace *place, const Wavelengths *at, Lanes *values)
{
    double rgb[PROGRAM_MOST_OUTPUTS];
    bool number = run_formula(texture, place, rgb) == 1;
    if (number && !texture->shines) {
        for (int k = 0; k < at->n; k++) values[k] = lanes_all((float)rgb[0]);
        return;
    }
    if (number) rgb[1] = rgb[2] = rgb[0];
    spectrum_of_color(texture, rgb, at, values);
}

/* ---- pictures ---- */

enum { MOST_LOOKS = 3 };

static TextureLook look_by_uv(const Texture *texture, const TexturePlace *place)
{
    TextureLook look = {.u = (double)place->uv[0], .v = (double)place->uv[1], .wrap = texture->wrap};
    double width_u = vec3_length(place->du) * place->footprint, width_v = vec3_length(place->dv) * place->footprint;
    if (texture->vary > 0) {
        Vec3 shift = shift_of_object(place->identity, texture->seed, texture->vary);
        look.u += shift.x;
        look.v += shift.y;
    }
    if (texture->placed) {
        Vec3 p = affine_point(&texture->to_pattern, vec3(look.u, look.v, 0));
        Vec3 u = affine_vector(&texture->to_pattern, vec3(width_u, 0, 0)),
             v = affine_vector(&texture->to_pattern, vec3(0, width_v, 0));
        look.u = p.x;
        look.v = p.y;
        width_u = fmax(fabs(u.x), fabs(v.x));
        width_v = fmax(fabs(u.y), fabs(v.y));
    }
    look.width_u = (float)width_u;
    look.width_v = (float)width_v;
    return look;
}

/* Seen from outside a side's picture is upright and not mirrored. */
static int looks_of_box(const Texture *texture, const LocalPlace *local, TextureLook *looks, float *weights)
{
    /* sides whose part would be less than this are left out, so that most places need one look */
    const double least = 0.02;
    const double normal[3] = {local->normal.x, local->normal.y, local->normal.z};
    const double u[3] = {normal[0] > 0 ? -local->p.z : local->p.z, local->p.x,
                         normal[2] > 0 ? local->p.x : -local->p.x};
    const double v[3] = {local->p.y, normal[1] > 0 ? -local->p.z : local->p.z, local->p.y};
    double part[3], sum = 0;
    for (int i = 0; i < 3; i++) {
        double square = normal[i] * normal[i];
        part[i] = fmax(square * square - least, 0);
        sum += part[i];
    }
    int n = 0;
    for (int i = 0; i < 3; i++) {
        if (!(part[i] > 0)) continue;
        looks[n].u = u[i];
        looks[n].v = v[i];
        looks[n].width_u = (float)width_along(texture, local, i == 0 ? vec3(0, 0, 1) : vec3(1, 0, 0));
        looks[n].width_v = (float)width_along(texture, local, i == 1 ? vec3(0, 0, 1) : vec3(0, 1, 0));
        weights[n++] = (float)(part[i] / sum);
    }
    return n;
}

static TextureLook look_around(const Texture *texture, const LocalPlace *local)
{
    bool sphere = texture->projection == PROJECTION_SPHERICAL;
    Vec3 p = local->p;
    double r = sqrt(p.x * p.x + p.z * p.z), length = sphere ? vec3_length(p) : r;
    TextureLook look = {.u = r > 0 ? atan2(p.z, -p.x) / (2 * MEN_PI) / texture->turns + 0.5 : 0.5, .v = p.y};
    /* eastwards, and towards the north pole */
    Vec3 east = r > 0 ? vec3(-p.z / r, 0, p.x / r) : vec3(1, 0, 0), north = vec3(0, 1, 0);
    double width_v;
    if (sphere) {
        if (length > 0) north = vec3_scale(vec3_cross(p, east), 1 / length);
        look.v = length > 0 ? 0.5 + asin(fmin(fmax(p.y / length, -1), 1)) / MEN_PI : 0.5;
        width_v = length > 0 ? width_along(texture, local, north) / (MEN_PI * length) : 1;
    } else {
        width_v = width_along(texture, local, north);
    }
    double along = width_along(texture, local, east);
    /* half of the circle, beside the axis */
    double width_u = r * MEN_PI > along ? along / (2 * MEN_PI * r) : 0.5;
    look.width_u = (float)(width_u / texture->turns);
    look.width_v = (float)width_v;
    return look;
}

static int find_looks(const Texture *texture, const TexturePlace *place, TextureLook *looks, float *weights)
{
    weights[0] = 1;
    if (texture->projection == PROJECTION_UV) {
        looks[0] = look_by_uv(texture, place);
        return 1;
    }
    LocalPlace local = local_place(texture, place);
    int n = 1;
    switch (texture->projection) {
    case PROJECTION_UV:
    case PROJECTION_PLANAR:
        looks[0] = (TextureLook){.u = local.p.x,
                                 .v = local.p.y,
                                 .width_u = (float)width_along(texture, &local, vec3(1, 0, 0)),
                                 .width_v = (float)width_along(texture, &local, vec3(0, 1, 0))};
        break;
    case PROJECTION_BOX: n = looks_of_box(texture, &local, looks, weights); break;
    case PROJECTION_CYLINDRICAL:
    case PROJECTION_SPHERICAL: looks[0] = look_around(texture, &local); break;
    }
    for (int i = 0; i < n; i++) looks[i].wrap = texture->wrap;
    return n;
}

static void picture_color(const Texture *texture, const TexturePlace *place, const Wavelengths *at, Lanes *values)
{
    TextureLook looks[MOST_LOOKS];
    float weights[MOST_LOOKS];
    int n = find_looks(texture, place, looks, weights);
    for (int k = 0; k < at->n; k++) values[k] = lanes_all(0);
    for (int i = 0; i < n; i++) texture_image_add_color(texture->image, &looks[i], weights[i], at, values);
}

static void picture_value(const Texture *texture, const TexturePlace *place, const Wavelengths *at, Lanes *values)
{
    if (texture_image_channels(texture->image) == 3) {
        picture_color(texture, place, at, values);
        return;
    }
    const Lanes value = lanes_all(texture_vector_at(texture, place).x);
    for (int k = 0; k < at->n; k++) values[k] = value;
}

Vec3f texture_vector_at(const Texture *texture, const TexturePlace *place)
{
    Texture now;
    if (UNLIKELY(texture->keys != NULL)) {
        texture_between(texture, place->time, &now);
        texture = &now;
    }
    TextureLook looks[MOST_LOOKS];
    float weights[MOST_LOOKS], values[3] = {0, 0, 0};
    int n = find_looks(texture, place, looks, weights);
    Vec3f sum = vec3f(0, 0, 0);
    for (int i = 0; i < n; i++) {
        texture_image_numbers(texture->image, &looks[i], values);
        sum = vec3f_along(sum, weights[i], vec3f(values[0], values[1], values[2]));
    }
    return sum;
}

/* ---- what ---- */

static float mix_floats(float a, float b, float part)
{
    return a + (b - a) * part;
}

static Lanes mix_lanes(Lanes a, Lanes b, float part)
{
    return lanes_add(lanes_scale(a, 1 - part), lanes_scale(b, part));
}

static Lanes mix_spectra(const Spectrum *a, const Spectrum *b, float part, Lanes wavelength_nm)
{
    return mix_lanes(spectrum_at(a, wavelength_nm), spectrum_at(b, wavelength_nm), part);
}

/* Of a ramp between two keys: its stops and their values are, too. */
static Lanes at_moving_stops(const Texture *texture, float part, Lanes wavelength_nm)
{
    const TextureStop *from = texture->stops, *to = texture->later->stops;
    uint32_t low = 0, n = texture->n_stops;
    float before = 0, at = 0;
    for (; low < n; low++, before = at) {
        at = mix_floats(from[low].at, to[low].at, texture->part);
        if (at > part) break;
    }
    uint32_t first = low ? low - 1 : 0, second = low < n ? low : n - 1;
    Lanes value = mix_spectra(&from[first].value, &to[first].value, texture->part, wavelength_nm);
    if (first == second || low == 0) return value;
    return mix_lanes(value, mix_spectra(&from[second].value, &to[second].value, texture->part, wavelength_nm),
                     (part - before) / (at - before));
}

static Lanes at_stops(const Texture *texture, float part, Lanes wavelength_nm)
{
    if (texture->later) return at_moving_stops(texture, part, wavelength_nm);
    const TextureStop *stops = texture->stops;
    uint32_t low = 0, high = texture->n_stops; /* the first stop beyond the place */
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (stops[middle].at <= part)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == 0) return spectrum_at(&stops[0].value, wavelength_nm);
    if (low == texture->n_stops) return spectrum_at(&stops[low - 1].value, wavelength_nm);
    float t = (part - stops[low - 1].at) / (stops[low].at - stops[low - 1].at);
    return mix_spectra(&stops[low - 1].value, &stops[low].value, t, wavelength_nm);
}

static float part_of(const Texture *textures, const Texture *texture, const TexturePlace *place)
{
    double part = 0;
    switch (texture->kind) {
    case TEXTURE_CONSTANT: break;
    case TEXTURE_PATTERN: part = pattern_part(texture, place); break;
    case TEXTURE_IMAGE: part = (double)texture_vector_at(texture, place).x; break;
    case TEXTURE_MIX: part = (double)texture_number_at(textures, texture->blend, place); break;
    case TEXTURE_FORMULA: {
        double outputs[PROGRAM_MOST_OUTPUTS];
        (void)run_formula(texture, place, outputs);
        part = outputs[0];
        break;
    }
    case TEXTURE_VARIATION: part = hash_to_unit(hash_u64(hash_u64(place->identity) ^ texture->seed)); break;
    }
    return part > 0 ? part < 1 ? (float)part : 1 : 0;
}

/* What the parts stand for is averaged, not they: between red and blue there is no green. */
static Lanes at_parts(const Texture *texture, const PatternParts *parts, Lanes wavelength_nm)
{
    Lanes sum = lanes_all(0);
    for (int i = 0; i < parts->n; i++)
        sum = lanes_add(sum,
                        lanes_scale(at_stops(texture, (float)parts->value[i], wavelength_nm), (float)parts->part[i]));
    return sum;
}

static void steps_at(const Texture *textures, const Texture *texture, const TexturePlace *place, const Wavelengths *at,
                     Lanes *values)
{
    float part = part_of(textures, texture, place);
    if (texture->n_stops) {
        for (int k = 0; k < at->n; k++) values[k] = at_stops(texture, part, at->nm[k]);
        return;
    }
    Lanes high[COLOR_FOURS];
    if (part < 1) texture_at_each(textures, texture->low, place, at, values);
    if (part > 0) texture_at_each(textures, texture->high, place, at, part < 1 ? high : values);
    if (part <= 0 || part >= 1) return;
    for (int k = 0; k < at->n; k++) values[k] = mix_lanes(values[k], high[k], part);
}

/* One of n places spread evenly over what a look sees (the first points of a lattice of rank 1): of the picture as it is. */
static TextureLook look_within(const TextureLook *look, int i, int n)
{
    TextureLook one = *look;
    double u = (i + 0.5) / n, v = 3.0 * i / n + 0.5 / n;
    one.u += (double)look->width_u * (u - 0.5);
    one.v += (double)look->width_v * (v - floor(v) - 0.5);
    one.width_u = one.width_v = 0;
    return one;
}

/* What smaller versions of a picture have are means of what a ramp makes colours of: half of a net is no thread, and a step would
 * let all of it through. So what is far away is looked at as it is, at some places, which other samples have elsewhere. */
static void parts_of_picture(const Texture *texture, const TexturePlace *place, PatternParts *parts)
{
    TextureLook looks[MOST_LOOKS];
    float weights[MOST_LOOKS], numbers[3];
    int n = find_looks(texture, place, looks, weights);
    parts->n = 1;
    for (int i = 0; i < n; i++)
        if (texture_image_pixels_seen(texture->image, &looks[i]) > 1) parts->n = PATTERN_MOST_PARTS;
    for (int i = 0; i < parts->n; i++) {
        float part = 0;
        for (int j = 0; j < n; j++) {
            TextureLook one = parts->n > 1 ? look_within(&looks[j], i, parts->n) : looks[j];
            texture_image_numbers(texture->image, &one, numbers);
            part += weights[j] * numbers[0];
        }
        parts->value[i] = (double)float_min(float_max(part, 0), 1);
        parts->part[i] = 1.0 / parts->n;
    }
}

static void value_at(const Texture *textures, const Texture *texture, const TexturePlace *place, const Wavelengths *at,
                     Lanes *values)
{
    if (texture->is_value && texture->kind == TEXTURE_FORMULA) {
        formula_value(texture, place, at, values);
    } else if (texture->is_value) {
        picture_value(texture, place, at, values);
    } else if (texture->n_stops && (texture->kind == TEXTURE_PATTERN || texture->kind == TEXTURE_IMAGE)) {
        PatternParts parts;
        (texture->kind == TEXTURE_PATTERN ? parts_of_pattern : parts_of_picture)(texture, place, &parts);
        for (int k = 0; k < at->n; k++) values[k] = at_parts(texture, &parts, at->nm[k]);
    } else {
        steps_at(textures, texture, place, at, values);
    }
}

/* Of one that changes while the shutter is open. */
ATTR_COLD static void moving_at(const Texture *textures, const Texture *texture, const TexturePlace *place,
                                const Wavelengths *at, Lanes *values)
{
    Texture now;
    texture_between(texture, place->time, &now);
    if (now.kind != TEXTURE_CONSTANT) {
        value_at(textures, &now, place, at, values);
        return;
    }
    for (int k = 0; k < at->n; k++) values[k] = mix_spectra(&now.value, &now.later->value, now.part, at->nm[k]);
}

void texture_at_each(const Texture *textures, uint32_t number, const TexturePlace *place, const Wavelengths *at,
                     Lanes *values)
{
    const Texture *texture = &textures[number];
    if (UNLIKELY(texture->keys != NULL)) {
        moving_at(textures, texture, place, at, values);
    } else if (texture->kind == TEXTURE_CONSTANT) {
        for (int k = 0; k < at->n; k++) values[k] = spectrum_at(&texture->value, at->nm[k]);
    } else {
        value_at(textures, texture, place, at, values);
    }
}

Lanes texture_at(const Texture *textures, uint32_t number, const TexturePlace *place, Lanes wavelength_nm)
{
    Lanes value;
    texture_at_each(textures, number, place, &(Wavelengths){1, &wavelength_nm}, &value);
    return value;
}

float texture_number_at(const Texture *textures, uint32_t number, const TexturePlace *place)
{
    return lanes_get(texture_at(textures, number, place, any_wavelength()), 0);
}

TexturePlace texture_place_moved(const TexturePlace *place, Vec3 object_offset, Vec3 world_offset)
{
    TexturePlace moved = *place;
    moved.object = vec3_add(place->object, object_offset);
    moved.world = vec3_add(place->world, world_offset);
    moved.uv[0] += (float)vec3_dot(place->du, object_offset);
    moved.uv[1] += (float)vec3_dot(place->dv, object_offset);
    return moved;
}

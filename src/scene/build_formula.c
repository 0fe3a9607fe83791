/* build_formula.c - functions of the scene as textures: compiled, and asked at places on the surfaces that have them, so that
 * what they cannot say there is an error now and not a black spot in the picture.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "base/hash.h"
#include "lang/schema_find.h"
#include "scene/build_parts.h"

enum { PLACES = 512 }; /* on each object, and for the mean of light */

/* Whether it asks for any of n inputs from number `first` on. */
static bool uses_input(const Program *program, unsigned first, unsigned n)
{
    for (uint32_t i = 0; i < program->n_steps; i++) {
        const uint16_t operands[] = {program->steps[i].a, program->steps[i].b, program->steps[i].c};
        for (int k = 0; k < 3; k++)
            if (operands[k] >= first && operands[k] < first + n) return true;
    }
    for (uint32_t i = 0; i < program->n_outputs; i++)
        if (program->outputs[i] >= first && program->outputs[i] < first + n) return true;
    return false;
}

/* About the mean brightness of what shines by a function: over a cube around the origin. */
static double mean_light(const Program *program)
{
    double sum = 0;
    for (uint32_t i = 0; i < PLACES; i++) {
        double inputs[PROGRAM_INPUTS] = {0, 0, 0, 0, 1, 0}, outputs[PROGRAM_MOST_OUTPUTS];
        for (uint32_t k = 0; k < 3; k++)
            inputs[PROGRAM_POINT + k] = 2 * hash_to_unit(hash_u64(3 * (uint64_t)i + k)) - 1;
        for (uint32_t k = 0; k < 2; k++) inputs[PROGRAM_UV + k] = hash_to_unit(hash_u64(~(2 * (uint64_t)i + k)));
        program_run(program, inputs, outputs);
        for (uint32_t k = 0; k < program->n_outputs; k++)
            if (outputs[k] > 0 && isfinite(outputs[k])) sum += outputs[k] / program->n_outputs / PLACES;
    }
    return sum > 0 ? sum : 1;
}

void build_formula(Builder *b, const EvalNode *node, TextureUse use, Texture *texture, TextureFacts *facts)
{
    const EvalProp *function = eval_prop(node, "function");
    bool is_value = !eval_prop(node, "from") && !eval_prop(node, "to") && !eval_prop(node, "ramp");
    texture->kind = TEXTURE_FORMULA;
    texture->is_value = is_value;
    texture->shines = use == TEXTURE_OF_LIGHT;
    texture->program = formula_compile(function->as.function, b->arena);
    facts->function = function;
    facts->open = is_value && use == TEXTURE_OF_NUMBERS;
    if (!texture->program) return;
    facts->uses_uv = uses_input(texture->program, PROGRAM_UV, 2);
    facts->uses_normal = uses_input(texture->program, PROGRAM_NORMAL, 3);
    facts->cost += texture->program->n_steps / 16;
    if (texture->program->n_outputs == 3 && (use == TEXTURE_OF_NUMBERS || !is_value)) {
        Diagnostic *report =
            diag_report(b->diag, D_WRONG_TYPE, function->span, "this function gives a colour, and a number is wanted");
        diag_note(b->diag, report, b->texture_user->span, "'%s' takes the texture", b->texture_user->type->name);
    }
    if (is_value && texture->shines) facts->least = facts->most = mean_light(texture->program);
}

/* ---- checks ---- */

static Vec3 unit_or(Vec3 v, Vec3 other)
{
    double length = vec3_length(v);
    return length > 0 && isfinite(length) ? vec3_scale(v, 1 / length) : other;
}

/* Place number i on a shape, in its own frame; false when there is none. */
static bool place_on_shape(const SceneShape *shape, uint32_t i, Vec3 *p, Vec3 *normal, float uv[2])
{
    double u = hash_to_unit(hash_u64(2 * (uint64_t)i)), v = hash_to_unit(hash_u64(2 * (uint64_t)i + 1));
    uv[0] = (float)u;
    uv[1] = (float)v;
    if (shape->mesh) {
        const Mesh *mesh = shape->mesh;
        if (mesh->n_triangles == 0) return false;
        const uint32_t *triangle = mesh->triangles[(uint32_t)(((uint64_t)i * 2654435761u) % mesh->n_triangles)];
        Vec3 corners[3];
        for (int k = 0; k < 3; k++) corners[k] = vec3_from_f(mesh->positions[triangle[k]]);
        double root = sqrt(u), weights[3] = {1 - root, root * (1 - v), root * v};
        *p = vec3(0, 0, 0);
        for (int k = 0; k < 3; k++) *p = vec3_along(*p, weights[k], corners[k]);
        *normal = vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0]));
        for (int k = 0; mesh->uvs && k < 2; k++) {
            double sum = 0;
            for (int n = 0; n < 3; n++) sum += weights[n] * (double)mesh->uvs[2 * triangle[n] + (uint32_t)k];
            uv[k] = (float)sum;
        }
        return true;
    }
    if (!shape->solid || shape->solid->n_pieces == 0) return false;
    const Piece *piece = &shape->solid->pieces[i % shape->solid->n_pieces];
    if (piece_area(piece) > 0) {
        *p = piece_sample(piece, u, v, normal);
    } else { /* without end */
        *p = vec3(2 * u - 1, 0, 2 * v - 1);
        *normal = vec3(0, 1, 0);
    }
    return true;
}

static Diagnostic *report_value(Builder *b, const EvalProp *function, const PropType *user, const TexturePlace *at,
                                double value, const char *why)
{
    return diag_report(b->diag, D_VALUE_OUT_OF_RANGE, function->span, "%s by this function is %g at <%g, %g, %g>: %s",
                       user->name, value, at->object.x, at->object.y, at->object.z, why);
}

/* What a formula itself gives at a place; false after a report. */
static bool check_formula(Builder *b, uint32_t row, const PropType *user, const TexturePlace *at)
{
    const Texture *texture = &b->scene->textures[row];
    const EvalProp *function = b->texture_facts[row].function;
    double inputs[PROGRAM_INPUTS], outputs[PROGRAM_MOST_OUTPUTS], again[PROGRAM_MOST_OUTPUTS];
    texture_formula_inputs(texture, at, inputs);
    program_run(texture->program, inputs, outputs);
    for (uint32_t k = 0; k < texture->program->n_outputs; k++) {
        double x = outputs[k];
        if (!isfinite(x)) {
            size_t n_errors = b->diag->n_errors;
            (void)formula_evaluate(function->as.function, inputs, again); /* which knows what went wrong, and where */
            Diagnostic *report = NULL;
            if (b->diag->n_errors == n_errors) report = report_value(b, function, user, at, x, "that is no number");
            if (report) diag_hint(b->diag, report, "a function must have a value wherever the surface is");
            return false;
        }
        bool is_color = texture->is_value && user->kind != PROP_NUMBER && !texture->shines;
        if (is_color && !(x >= -1e-9 && x <= 1 + 1e-9)) {
            Diagnostic *report = report_value(b, function, user, at, x, "a colour of a surface is in 0..1");
            diag_hint(b->diag, report, "clamp(c, 0, 1) holds it there");
            return false;
        }
        if (texture->shines && x < 0) {
            (void)report_value(b, function, user, at, x, "there is no light below 0");
            return false;
        }
    }
    return true;
}

/* The formulas among a texture and those that it refers to; false after a report. */
static bool check_texture(Builder *b, uint32_t row, const PropType *user, const TexturePlace *at, unsigned depth)
{
    const Texture *texture = &b->scene->textures[row];
    const uint32_t others[] = {texture->low, texture->high, texture->blend};
    if (depth > 40) return true; /* too deep, and reported */
    if (texture->kind == TEXTURE_FORMULA && texture->program && !check_formula(b, row, user, at)) return false;
    for (size_t i = 0; texture->kind != TEXTURE_CONSTANT && i < COUNT_OF(others); i++)
        if (others[i] != TEXTURE_NONE && !check_texture(b, others[i], user, at, depth + 1)) return false;
    return true;
}

/* A texture of a property at a place: what its formulas give, and what it comes to. */
static bool check_user(Builder *b, uint32_t row, const EvalProp *user, const TexturePlace *at)
{
    if (!check_texture(b, row, user->type, at, 0)) return false;
    if (!b->texture_facts[row].open) return true;
    double value = (double)texture_number_at(b->scene->textures, row, at), slack = 1e-6;
    if (value >= user->type->min - slack && value <= user->type->max + slack) return true;
    Diagnostic *report =
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, user->span,
                    "%s reaches %g by this texture, at <%g, %g, %g>, which %s", user->type->name, value, at->object.x,
                    at->object.y, at->object.z, schema_bounds_text(b->diag->arena, user->type));
    if (isinf(user->type->max))
        diag_hint(b->diag, report, "max(x, %g) holds it there", user->type->min);
    else
        diag_hint(b->diag, report, "clamp(x, %g, %g) holds it there", user->type->min, user->type->max);
    return false;
}

/* Many objects share what is looked at: the first are looked at closely. */
static uint32_t places_on(Builder *b)
{
    const uint32_t closely = 1000, at_all = 100000;
    uint32_t n = b->n_formula_objects < at_all ? b->n_formula_objects++ : at_all;
    return n < closely ? PLACES : n < at_all ? PLACES / 32 : 0;
}

void build_check_formulas(Builder *b, uint32_t object_row)
{
    const SceneObject *object = &b->scene->objects[object_row];
    const SceneShape *shape = &b->scene->shapes[object->shape];
    const SceneTextureFrame *frame = &b->scene->texture_frames[object->texture_frame];
    bool failed = false;
    for (uint32_t n = 0; n < b->n_open_textures && !failed; n++) {
        OpenTexture *open = &b->open_textures[n];
        if (open->failed) continue; /* for another object: it is one mistake */
        if (!build_surface_includes(b->scene, object->surface, open->row, 0)) continue;
        uint32_t places = places_on(b);
        for (uint32_t i = 0; i < places && !failed; i++) {
            TexturePlace at = {.identity = object->identity};
            Vec3 p, normal;
            if (!place_on_shape(shape, i, &p, &normal, at.uv)) break;
            at.object = affine_point(&frame->from_shape, p);
            at.object_normal = unit_or(affine_normal(&frame->from_shape, normal), vec3(0, 1, 0));
            at.world = affine_point(&object->to_world, p);
            at.world_normal = unit_or(affine_normal(&object->to_world, normal), vec3(0, 1, 0));
            failed = open->failed = !check_user(b, open->row, open->user, &at);
        }
    }
}

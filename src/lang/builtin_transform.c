/* builtin_transform.c - the functions of the language that make and use transforms.
 * A positive angle turns x towards y about z, y towards z about x, and z towards x about y.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "lang/builtin_run.h"

static void give_transform(const BuiltinCall *call, const Affine *affine, Value *result)
{
    Affine inverse;
    if (!affine_invert(affine, &inverse)) {
        eval_error(call->evaluator, call->expr, D_SINGULAR_TRANSFORM,
                   "this transform squashes space flat or is not finite");
        result->kind = VALUE_POISON;
        return;
    }
    Evaluator *evaluator = call->evaluator;
    Affine *kept = evaluator->free_transform ? evaluator->free_transform : ARENA_NEW(evaluator->arena, Affine);
    *kept = *affine;
    evaluator->newest_transform = kept;
    evaluator->free_transform = NULL;
    *result = (Value){.kind = VALUE_TRANSFORM, .as.transform = kept};
}

static double sine(double degrees)
{
    return builtin_find("sin")->unary(degrees);
}
static double cosine(double degrees)
{
    return builtin_find("cos")->unary(degrees);
}

/* Rodrigues' formula; axis of length 1 */
static Affine rotation(Vec3 axis, double degrees)
{
    double s = sine(degrees), c = cosine(degrees), d = 1 - c;
    double x = axis.x, y = axis.y, z = axis.z;
    return (Affine){{{c + d * x * x, d * x * y - s * z, d * x * z + s * y},
                     {d * x * y + s * z, c + d * y * y, d * y * z - s * x},
                     {d * x * z - s * y, d * y * z + s * x, c + d * z * z}},
                    {0, 0, 0}};
}

static Vec3 vector_of(const Value *value)
{
    return vec3(value->as.v[0], value->as.v[1], value->as.v[2]);
}

void run_rotate(const BuiltinCall *call, Value *result)
{
    if (call->args[0].kind != VALUE_VECTOR3) {
        builtin_wrong(call, 0, "an axis and an angle, as (y, 45), or a vector of 3 angles", result);
        return;
    }
    Vec3 v = vector_of(&call->args[0]);
    Affine affine;
    if (call->n == 1) {
        Affine about_x = rotation(vec3(1, 0, 0), v.x), about_y = rotation(vec3(0, 1, 0), v.y);
        Affine about_z = rotation(vec3(0, 0, 1), v.z);
        affine = affine_compose(&about_y, &about_x);
        affine = affine_compose(&about_z, &affine);
    } else {
        if (call->args[1].kind != VALUE_NUMBER) {
            builtin_wrong(call, 1, "an axis and an angle", result);
            return;
        }
        affine = rotation(vec3_normalize(v), call->args[1].as.number);
    }
    give_transform(call, &affine, result);
}

void run_translate(const BuiltinCall *call, Value *result)
{
    if (call->args[0].kind != VALUE_VECTOR3) {
        builtin_wrong(call, 0, "a vector of 3", result);
        return;
    }
    Affine affine = affine_identity();
    affine.t = vector_of(&call->args[0]);
    give_transform(call, &affine, result);
}

void run_scale(const BuiltinCall *call, Value *result)
{
    const Value *by = &call->args[0];
    if (by->kind != VALUE_NUMBER && by->kind != VALUE_VECTOR3) {
        builtin_wrong(call, 0, "a number or a vector of 3", result);
        return;
    }
    Affine affine = affine_identity();
    for (int i = 0; i < 3; i++) affine.m[i][i] = by->as.v[by->kind == VALUE_NUMBER ? 0 : i];
    give_transform(call, &affine, result);
}

void run_matrix(const BuiltinCall *call, Value *result)
{
    double numbers[12];
    unsigned width = call->n == 12 ? 1 : 3;
    for (uint32_t i = 0; i < call->n; i++) {
        if ((call->n != 4 && call->n != 12) || call->args[i].kind != (width == 1 ? VALUE_NUMBER : VALUE_VECTOR3)) {
            builtin_wrong(call, i, "4 vectors of 3, or 12 numbers", result);
            return;
        }
        memcpy(numbers + i * width, call->args[i].as.v, width * sizeof(double));
    }
    Affine affine;
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++) affine.m[row][column] = numbers[column * 3 + row];
    affine.t = vec3(numbers[9], numbers[10], numbers[11]);
    give_transform(call, &affine, result);
}

void run_transform(const BuiltinCall *call, Value *result)
{
    Affine affine = affine_identity();
    for (uint32_t i = 0; i < call->n; i++) {
        if (call->args[i].kind != VALUE_TRANSFORM) {
            builtin_wrong(call, i, "transforms", result);
            return;
        }
        affine = affine_compose(call->args[i].as.transform, &affine);
    }
    give_transform(call, &affine, result);
}

void run_inverse(const BuiltinCall *call, Value *result)
{
    Affine inverse;
    if (call->args[0].kind != VALUE_TRANSFORM)
        builtin_wrong(call, 0, "a transform", result);
    else if (affine_invert(call->args[0].as.transform, &inverse))
        give_transform(call, &inverse, result);
    else
        give_transform(call, call->args[0].as.transform, result); /* reports */
}

/* Rodrigues' formula with the sine and cosine that the two directions have; exact for coordinate axes. */
static Affine turn_by_axis(Vec3 a, Vec3 b)
{
    Vec3 v = vec3_cross(a, b);
    double c = vec3_dot(a, b), k = 1 / (1 + c);
    return (Affine){{{c + k * v.x * v.x, k * v.x * v.y - v.z, k * v.x * v.z + v.y},
                     {k * v.x * v.y + v.z, c + k * v.y * v.y, k * v.y * v.z - v.x},
                     {k * v.x * v.z - v.y, k * v.y * v.z + v.x, c + k * v.z * v.z}},
                    {0, 0, 0}};
}

/* For directions that are nearly opposite: one reflection turns a round, a second one across the middle of a and b turns that
 * into b. Where they are opposite, every way is as short: the middle is any direction across. */
static Affine turn_by_reflections(Vec3 a, Vec3 b)
{
    Vec3 middle = vec3_add(a, b);
    if (vec3_dot(middle, middle) < 1e-24) {
        double x = fabs(a.x), y = fabs(a.y), z = fabs(a.z);
        middle = vec3_cross(a, x <= y && x <= z ? vec3(1, 0, 0) : y <= z ? vec3(0, 1, 0) : vec3(0, 0, 1));
    }
    middle = vec3_normalize(middle);
    Affine affine = affine_identity();
    for (int column = 0; column < 3; column++) {
        Vec3 axis = vec3(column == 0, column == 1, column == 2);
        Vec3 turned = vec3_along(axis, -2 * vec3_dot(axis, a), a);
        turned = vec3_along(turned, -2 * vec3_dot(turned, middle), middle);
        affine.m[0][column] = turned.x;
        affine.m[1][column] = turned.y;
        affine.m[2][column] = turned.z;
    }
    return affine;
}

void run_align(const BuiltinCall *call, Value *result)
{
    for (uint32_t i = 0; i < 2; i++)
        if (call->args[i].kind != VALUE_VECTOR3) {
            builtin_wrong(call, i, "two directions, vectors of 3", result);
            return;
        }
    Vec3 a = vec3_normalize(vector_of(&call->args[0])), b = vec3_normalize(vector_of(&call->args[1]));
    Affine affine = vec3_dot(a, b) > -0.5 ? turn_by_axis(a, b) : turn_by_reflections(a, b);
    give_transform(call, &affine, result);
}

void run_apply(const BuiltinCall *call, Value *result)
{
    if (call->args[0].kind != VALUE_TRANSFORM || call->args[1].kind != VALUE_VECTOR3) {
        builtin_wrong(call, call->args[0].kind == VALUE_TRANSFORM, "a transform and a point", result);
        return;
    }
    Vec3 p = affine_point(call->args[0].as.transform, vector_of(&call->args[1]));
    *result = value_vector3(p.x, p.y, p.z);
}

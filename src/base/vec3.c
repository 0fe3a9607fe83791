/* vec3.c - rounding to float, and the affine maps that are too long to inline.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/vec3.h"

Vec3 vec3_rounded(Vec3 a)
{
    volatile float x = (float)a.x, y = (float)a.y, z = (float)a.z;
    return vec3((double)x, (double)y, (double)z);
}

Affine affine_compose(const Affine *a, const Affine *b)
{
    Affine c;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            c.m[row][column] =
                a->m[row][0] * b->m[0][column] + a->m[row][1] * b->m[1][column] + a->m[row][2] * b->m[2][column];
    c.t = affine_point(a, b->t);
    return c;
}

double affine_determinant(const Affine *a)
{
    return a->m[0][0] * (a->m[1][1] * a->m[2][2] - a->m[1][2] * a->m[2][1]) -
           a->m[0][1] * (a->m[1][0] * a->m[2][2] - a->m[1][2] * a->m[2][0]) +
           a->m[0][2] * (a->m[1][0] * a->m[2][1] - a->m[1][1] * a->m[2][0]);
}

double affine_max_stretch(const Affine *a)
{
    double sum = 0; /* the Frobenius norm bounds the largest singular value */
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) sum += a->m[row][column] * a->m[row][column];
    return sqrt(sum);
}

bool box3_cut(const Box3 *box, Vec3 from, Vec3 direction, double *enter, double *leave)
{
    const double origin[3] = {from.x, from.y, from.z}, d[3] = {direction.x, direction.y, direction.z};
    const double low[3] = {box->min.x, box->min.y, box->min.z}, high[3] = {box->max.x, box->max.y, box->max.z};
    *enter = -HUGE_VAL;
    *leave = HUGE_VAL;
    for (int i = 0; i < 3; i++) {
        bool level = d[i] == 0, within = origin[i] > low[i] && origin[i] < high[i];
        double a = level ? (within ? -HUGE_VAL : HUGE_VAL) : (low[i] - origin[i]) / d[i];
        double b = level ? HUGE_VAL : (high[i] - origin[i]) / d[i];
        *enter = double_max(*enter, double_min(a, b));
        *leave = double_min(*leave, double_max(a, b));
    }
    return *enter < *leave;
}

bool affine_invert(const Affine *a, Affine *inverse)
{
    double determinant = affine_determinant(a);
    if (determinant == 0 || !isfinite(determinant) || !isfinite(1 / determinant) || !vec3_is_finite(a->t)) return false;
    Affine b;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            int r1 = (column + 1) % 3, r2 = (column + 2) % 3, c1 = (row + 1) % 3, c2 = (row + 2) % 3;
            b.m[row][column] = (a->m[r1][c1] * a->m[r2][c2] - a->m[r1][c2] * a->m[r2][c1]) / determinant;
        }
    b.t = vec3(0, 0, 0);
    b.t = vec3_scale(affine_vector(&b, a->t), -1);
    *inverse = b;
    return true;
}

bool affine_is_identity(const Affine *a)
{
    Affine identity = affine_identity();
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            if (a->m[row][column] != identity.m[row][column]) return false;
    return a->t.x == 0 && a->t.y == 0 && a->t.z == 0;
}

double affine_even_scale(const Affine *a, double slack)
{
    Vec3 x = vec3(a->m[0][0], a->m[1][0], a->m[2][0]), y = vec3(a->m[0][1], a->m[1][1], a->m[2][1]),
         z = vec3(a->m[0][2], a->m[1][2], a->m[2][2]);
    double s = vec3_length(x), most = slack * s;
    bool even = fabs(vec3_length(y) - s) <= most && fabs(vec3_length(z) - s) <= most &&
                fabs(vec3_dot(x, y)) <= most * s && fabs(vec3_dot(y, z)) <= most * s &&
                fabs(vec3_dot(z, x)) <= most * s;
    return even ? s : 0;
}

Box3 affine_box(const Affine *a, Box3 b)
{
    Box3 image = box3_empty();
    for (int corner = 0; corner < 8; corner++)
        image =
            box3_add_point(image, affine_point(a, vec3(corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y,
                                                       corner & 4 ? b.max.z : b.min.z)));
    return image;
}

Affine affine_between(const Affine *keys, uint32_t n, double time)
{
    double place = time * (n - 1);
    uint32_t k = place < n - 2 ? (uint32_t)place : n - 2;
    double b = place - k, a = 1 - b;
    const Affine *from = &keys[k], *to = &keys[k + 1];
    Affine map = {.t = vec3_add(vec3_scale(from->t, a), vec3_scale(to->t, b))};
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            map.m[row][column] = a * from->m[row][column] + b * to->m[row][column];
    return map;
}

double affine_largest_stretch(const Affine *a)
{
    double largest = 0;
    for (int i = 0; i < 3; i++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) {
            double product = 0;
            for (int row = 0; row < 3; row++) product += a->m[row][i] * a->m[row][k];
            sum += fabs(product);
        }
        largest = double_max(largest, sum);
    }
    return sqrt(largest) * (1 + 1e-12);
}

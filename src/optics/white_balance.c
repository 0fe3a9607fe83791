/* white_balance.c - which light a picture shows as white.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/white_balance.h"

#include "base/vec3.h"
#include "optics/color.h"
#include "optics/observer.h"

/* Responses of cones from XYZ, all 1 for XYZ all 1. */
static const Affine cones_from_xyz = {{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}},
                                      {0, 0, 0}};

static Affine rgb_from_xyz(void)
{
    Affine affine = affine_identity();
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) affine.m[i][k] = observer_rgb_from_xyz[i][k];
    return affine;
}

static Vec3 color_of(const Spectrum *spectrum)
{
    double rgb[3] = {0, 0, 0};
    for (int node = 0; node < OBSERVER_NODES; node++) {
        double weight[3], radiance = (double)spectrum_at_one(spectrum, (float)observer_node(node));
        observer_node_rgb(node, weight);
        for (int c = 0; c < 3; c++) rgb[c] += weight[c] * radiance;
    }
    return vec3(rgb[0], rgb[1], rgb[2]);
}

void white_balance(double kelvin, float matrix[3][3])
{
    float table[SPECTRUM_SAMPLES];
    const Spectrum light = spectrum_blackbody(kelvin, table);
    const Affine to_rgb = rgb_from_xyz();
    Affine to_xyz, from_cones;
    bool regular = affine_invert(&to_rgb, &to_xyz) && affine_invert(&cones_from_xyz, &from_cones);
    const Vec3 lit = affine_vector(&to_xyz, color_of(&light)), white = affine_vector(&to_xyz, vec3(1, 1, 1));
    const Vec3 is = affine_vector(&cones_from_xyz, vec3_scale(lit, white.y / lit.y)),
               shall_be = affine_vector(&cones_from_xyz, white);
    for (int k = 0; k < 3; k++) {
        Vec3 column = affine_vector(&to_xyz, vec3(k == 0, k == 1, k == 2));
        Vec3 cones = affine_vector(&cones_from_xyz, column);
        cones = vec3(cones.x * shall_be.x / is.x, cones.y * shall_be.y / is.y, cones.z * shall_be.z / is.z);
        Vec3 rgb = affine_vector(&to_rgb, affine_vector(&from_cones, cones));
        const double values[3] = {rgb.x, rgb.y, rgb.z};
        for (int i = 0; i < 3; i++) matrix[i][k] = regular ? (float)values[i] : (float)(i == k);
    }
}

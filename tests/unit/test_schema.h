/* test_schema.h - a node table for the tests of the language, with the names of the example scenes but made for the
 * tests: it has a row of every kind, and need not follow the program's own table.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_SCHEMA_H
#define MEN_TEST_SCHEMA_H

#include <math.h>

#include "base/attr.h"
#include "lang/schema.h"

#define NO_MIN ((double)-INFINITY)
#define NO_MAX ((double)INFINITY)
#define ANY NO_MIN, NO_MAX

#define LOOK_ROWS                                                                                                      \
    {"interior", PROP_NODE, UNIT_NONE, 0, ANY, "medium", NULL, "what fills it"},                                       \
        {"surface", PROP_NODE, UNIT_NONE, 0, ANY, "surface", NULL, "what covers it"},                                  \
    {                                                                                                                  \
        "priority", PROP_INTEGER, UNIT_NONE, 0, ANY, NULL, NULL, "larger is on top"                                    \
    }

static const PropType medium_rows[] = {
    {"ior", PROP_SPECTRUM, UNIT_NONE, 0, 1, 4, NULL, "1", "refractive index"},
    {"tint", PROP_COLOR, UNIT_NONE, 0, 0, 1, NULL, NULL, "colour reached at depth"},
    {"depth", PROP_NUMBER, UNIT_LENGTH, PROP_OPEN_MIN, 0, NO_MAX, NULL, NULL, "where tint is reached"},
    {"absorption", PROP_SPECTRUM, UNIT_PER_LENGTH, 0, 0, NO_MAX, NULL, "0", "per length"},
    {"scattering", PROP_SPECTRUM, UNIT_PER_LENGTH, 0, 0, NO_MAX, NULL, "0", "per length"},
    {"phase", PROP_TERM, UNIT_NONE, 0, ANY, NULL, NULL, "phase function"},
    {"state", PROP_CHOICE, UNIT_NONE, 0, ANY, "solid|liquid|gas", NULL, "state of matter"},
    {"priority", PROP_INTEGER, UNIT_NONE, 0, ANY, NULL, NULL, "larger is on top"},
};
static const PropType surface_rows[] = {
    {"roughness", PROP_NUMBER, UNIT_NONE, 0, 0, 1, NULL, "0", "0 is smooth"},
    {"albedo", PROP_COLOR, UNIT_NONE, 0, 0, 1, NULL, ".5", "share of light that is sent back"},
    {"image", PROP_STRING, UNIT_NONE, 0, ANY, NULL, NULL, "a file"},
};
static const PropType sphere_rows[] = {
    LOOK_ROWS,
    {"center", PROP_VECTOR3, UNIT_LENGTH, 0, ANY, NULL, "<0, 0, 0>", "middle"},
    {"radius", PROP_NUMBER, UNIT_LENGTH, PROP_REQUIRED | PROP_SHAPE | PROP_OPEN_MIN, 0, NO_MAX, NULL, NULL, "radius"},
};
static const PropType box_rows[] = {
    LOOK_ROWS,
    {"size", PROP_VECTOR3, UNIT_LENGTH, PROP_SHAPE | PROP_OPEN_MIN, 0, NO_MAX, NULL, NULL, "edges"},
    {"from", PROP_VECTOR3, UNIT_LENGTH, PROP_SHAPE, ANY, NULL, NULL, "one corner"},
    {"to", PROP_VECTOR3, UNIT_LENGTH, PROP_SHAPE, ANY, NULL, NULL, "the other corner"},
    {"bevel", PROP_NUMBER, UNIT_LENGTH, PROP_SHAPE, 0, NO_MAX, NULL, "0", "rounding of the edges"},
};
static const PropType cylinder_rows[] = {
    LOOK_ROWS,
    {"from", PROP_VECTOR3, UNIT_LENGTH, PROP_REQUIRED | PROP_SHAPE, ANY, NULL, NULL, "one end"},
    {"to", PROP_VECTOR3, UNIT_LENGTH, PROP_REQUIRED | PROP_SHAPE, ANY, NULL, NULL, "other end"},
    {"radius", PROP_NUMBER, UNIT_LENGTH, PROP_REQUIRED | PROP_SHAPE | PROP_OPEN_MIN, 0, NO_MAX, NULL, NULL, "radius"},
};
static const PropType lathe_rows[] = {
    LOOK_ROWS,
    {"segments", PROP_INTEGER, UNIT_NONE, PROP_SHAPE, 3, 65536, NULL, "64", "around"},
    {"profile", PROP_VECTORS2, UNIT_LENGTH, PROP_SHAPE | PROP_REQUIRED, ANY, NULL, NULL, "outline"},
};
static const PropType mesh_rows[] = {
    LOOK_ROWS,
    {"file", PROP_STRING, UNIT_NONE, PROP_SHAPE, ANY, NULL, NULL, "a file"},
    {"closed", PROP_BOOL, UNIT_NONE, 0, ANY, NULL, "false", "must it be closed?"},
    {"vertices", PROP_VECTORS3, UNIT_LENGTH, PROP_SHAPE, ANY, NULL, NULL, "corners"},
    {"indices", PROP_NUMBERS, UNIT_NONE, PROP_SHAPE, 0, NO_MAX, NULL, NULL, "three for each face"},
};
static const PropType ground_rows[] = {
    {"y", PROP_NUMBER, UNIT_LENGTH, 0, ANY, NULL, "0", "height"},
    {"surface", PROP_NODE, UNIT_NONE, 0, ANY, "surface", NULL, "what covers it"},
};
static const PropType camera_rows[] = {
    {"from", PROP_VECTOR3, UNIT_LENGTH, PROP_REQUIRED, ANY, NULL, NULL, "eye"},
    {"to", PROP_VECTOR3, UNIT_LENGTH, PROP_REQUIRED, ANY, NULL, NULL, "what it looks at"},
    {"fov", PROP_NUMBER, UNIT_ANGLE, PROP_OPEN_MIN | PROP_OPEN_MAX, 0, 180, NULL, "40", "angle of view"},
    {"aperture", PROP_NUMBER, UNIT_LENGTH, 0, 0, NO_MAX, NULL, "0", "diameter of the lens"},
    {"focus", PROP_VECTOR3, UNIT_LENGTH, 0, ANY, NULL, NULL, "sharp point"},
    {"expect", PROP_NODES, UNIT_NONE, 0, ANY, "medium", NULL, "media around it"},
    {"shutter", PROP_NUMBER, UNIT_ANGLE, 0, 0, 360, NULL, "0", "open angle"},
};
static const PropType environment_rows[] = {
    {"image", PROP_STRING, UNIT_NONE, 0, ANY, NULL, NULL, "a file"},
    {"color", PROP_SPECTRUM, UNIT_NONE, 0, ANY, NULL, NULL, "radiance"},
};
static const PropType light_rows[] = {
    {"shape", PROP_CHOICE, UNIT_NONE, 0, ANY, "quad|disc|sphere|distant", NULL, "form"},
    {"size", PROP_VECTOR2, UNIT_LENGTH, PROP_OPEN_MIN, 0, NO_MAX, NULL, NULL, "edges"},
    {"from", PROP_VECTOR3, UNIT_LENGTH, PROP_REQUIRED, ANY, NULL, NULL, "where it stands"},
    {"to", PROP_VECTOR3, UNIT_LENGTH, 0, ANY, NULL, "<0, 0, 0>", "where it points"},
    {"angle", PROP_NUMBER, UNIT_ANGLE, 0, 0, 360, NULL, NULL, "apparent size"},
    {"color", PROP_SPECTRUM, UNIT_NONE, 0, ANY, NULL, "1", "colour"},
    {"power", PROP_NUMBER, UNIT_NONE, 0, 0, NO_MAX, NULL, "1", "power"},
};
static const PropType render_rows[] = {
    {"samples", PROP_INTEGER, UNIT_NONE, 0, 1, 1e9, NULL, "256", "per pixel"},
    {"noise", PROP_NUMBER, UNIT_NONE, 0, 0, 1, NULL, "0", "at which to stop"},
    {"bounces", PROP_INTEGER, UNIT_NONE, 0, 0, 10000, NULL, "16", "at most"},
    {"nesting", PROP_CHOICE, UNIT_NONE, 0, ANY, "automatic|entered|priority|none", "automatic", "order"},
};
static const PropType film_rows[] = {
    {"size", PROP_VECTOR2, UNIT_NONE, 0, 1, 65536, NULL, "<640, 480>", "pixels"},
    {"output", PROP_STRINGS, UNIT_NONE, 0, ANY, NULL, NULL, "files"},
    {"aovs", PROP_STRINGS, UNIT_NONE, 0, ANY, "albedo|normal|depth|medium|crypto_object", NULL, "more channels"},
};
static const PropType animation_rows[] = {
    {"frames", PROP_INTEGER, UNIT_NONE, 0, 1, 1e6, NULL, "1", "how many"},
    {"fps", PROP_NUMBER, UNIT_NONE, PROP_OPEN_MIN, 0, 1000, NULL, "24", "per second"},
    {"cyclic", PROP_BOOL, UNIT_NONE, 0, ANY, NULL, "false", "is the last frame followed by the first?"},
    {"length", PROP_NUMBER, UNIT_TIME, 0, 0, NO_MAX, NULL, NULL, "seconds"},
};
static const PropType group_rows[] = {{"priority", PROP_INTEGER, UNIT_NONE, 0, ANY, NULL, NULL, "larger is on top"}};
static const PropType union_rows[] = {LOOK_ROWS};

#define ROWS(name) name##_rows, sizeof name##_rows / sizeof name##_rows[0]
static const NodeType test_nodes[] = {
    {"medium", ROWS(medium), NODE_NAMED, NULL, "what light travels in"},
    {"surface", ROWS(surface), 0, NULL, "what covers a shape"},
    {"sphere", ROWS(sphere), NODE_PLACED | NODE_TRANSFORMS, NULL, "a ball"},
    {"box", ROWS(box), NODE_PLACED | NODE_TRANSFORMS, NULL, "a box"},
    {"cylinder", ROWS(cylinder), NODE_PLACED | NODE_TRANSFORMS, NULL, "a cylinder"},
    {"lathe", ROWS(lathe), NODE_PLACED | NODE_TRANSFORMS, NULL, "a turned shape"},
    {"mesh", ROWS(mesh), NODE_PLACED | NODE_TRANSFORMS, NULL, "triangles"},
    {"ground", ROWS(ground), NODE_PLACED, NULL, "a floor without end"},
    {"group", ROWS(group), NODE_PLACED | NODE_TRANSFORMS | NODE_CHILDREN, NULL, "nodes together"},
    {"union", ROWS(union), NODE_PLACED | NODE_TRANSFORMS | NODE_CHILDREN, "sphere|box|cylinder", "shapes as one"},
    {"camera", ROWS(camera), NODE_PLACED, NULL, "the eye"},
    {"light", ROWS(light), NODE_PLACED | NODE_TRANSFORMS, NULL, "a lamp"},
    {"environment", ROWS(environment), NODE_SINGLE | NODE_TRANSFORMS, NULL, "light from far away"},
    {"render", ROWS(render), NODE_SINGLE, NULL, "how to render"},
    {"film", ROWS(film), NODE_SINGLE, NULL, "what to make"},
    {"animation", ROWS(animation), NODE_SINGLE, NULL, "frames"},
};
static const TermType test_terms[] = {
    {"cauchy", 1, 3, 0, "index that falls with the wavelength"},
    {"hg", 1, 1, 0, "Henyey and Greenstein's phase function"},
    {"blackbody", 1, 1, TERM_SCALES, "glow of a hot body"},
    {"spectrum", 1, 1, TERM_TABLE | TERM_SCALES, "measured values"},
};

static const Schema test_schema = {
    .nodes = test_nodes,
    .n_nodes = sizeof test_nodes / sizeof test_nodes[0],
    .terms = test_terms,
    .n_terms = sizeof test_terms / sizeof test_terms[0],
    .prelude = "medium air { ior = 1  state = gas }",
};

#endif

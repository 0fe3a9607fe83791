/* geometry_models.h - what is remembered of nodes whose shape is asked of; private to src/scene/geometry*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GEOMETRY_MODELS_H
#define MEN_GEOMETRY_MODELS_H

#include "geom/rtc.h"
#include "lang/eval.h"
#include "nest/csg.h"
#include "scene/build.h"
#include "scene/scene.h"

/* What answers need of an object of the model. */
typedef struct Part {
    Affine to_shape;
    bool closed, plane;
    uint32_t operand; /* of a combination, the number of it; SCENE_NONE */
    int32_t net;      /* how often a ray left it, less how often it entered it: 0 between questions */
} Part;

typedef struct Model {
    const EvalNode *origin; /* the node without its transforms */
    Scene *scene;
    Part *parts;   /* beside the objects */
    NestCsg csg;   /* its operands begin with 0; hulls are the rows of combinations */
    NestList held; /* operands that hold the ray: empty between questions */
    RtcScene *rtc; /* NULL until a ray is asked for */
    Box3 bounds;
    uint32_t first_open, first_unbounded; /* objects; SCENE_NONE */
    bool mistaken;                        /* diag says why */
    bool measured;                        /* volume is known */
    double volume;
    size_t bytes;
} Model;

/* A node that was asked of. */
typedef struct Asked {
    const EvalNode *node;
    Model *model;
    Affine to_model;
    bool flat, has_bounds;
    Box3 bounds;
    size_t most_hits; /* scatter: of the rays that were tried; 0: none were */
} Asked;

typedef struct Table {
    void **items; /* Model or Asked: both begin with the node */
    size_t n, capacity;
} Table;

typedef struct Geometry {
    const SceneOptions *options;
    double unit_m; /* the scene's unit of length */
    Diag *diag;
    uint64_t *steps;
    Table models, asked;
    Asked *last;
    size_t bytes;
    HitList hits;
    EvalHit *found;
    size_t found_capacity;
} Geometry;

/* The state of scene_geometry: its open and its close. */
void *geometry_open(const void *context, double unit_m, Diag *diag, uint64_t *steps);
void geometry_close(void *state);
/* What is known of the node, which is built when it is asked of for the first time; good until the next call. STATUS_SCENE
 * where it has no shape, and with an empty text where diag has said why. */
ATTR_NODISCARD Status geometry_ask(Geometry *geometry, const EvalNode *node, Asked **out, Error *error);
/* Makes model->rtc, where it is not made yet. */
ATTR_NODISCARD Status geometry_need_rtc(Geometry *geometry, Model *model, Error *error);

#endif

/* builtin_geometry.c - the functions of the language that ask for the shape of a node. The answers come from the
 * EvalGeometry of the layer above; here arguments are checked and each ray is counted as a step.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/builtin_run.h"

/* "scatter" in ASCII: shares no values with rnd and noise */
static const uint64_t scatter_start = 0x73636174746572U;

static Vec3 vector_of(const Value *value)
{
    return vec3(value->as.v[0], value->as.v[1], value->as.v[2]);
}

/* Everything that can be asked of before the question; false, with poison, after a report. */
static bool begin(const BuiltinCall *call, Value *result)
{
    Evaluator *evaluator = call->evaluator;
    const EvalOptions *options = evaluator->options;
    result->kind = VALUE_POISON;
    if (call->args[0].kind != VALUE_NODE) {
        builtin_wrong(call, 0, "an object or a group first", result);
        return false;
    }
    if (!eval_step(evaluator, call->expr->span)) return false;
    if (!evaluator->geometry && options->geometry)
        evaluator->geometry =
            options->geometry->open(options->geometry_context, evaluator->unit_m, evaluator->diag, &evaluator->steps);
    if (evaluator->geometry) return true;
    eval_error(evaluator, call->expr, D_NO_GEOMETRY, "nothing is known of shapes here");
    return false;
}

/* Reports why there is no answer. */
static bool answered(const BuiltinCall *call, Status status, const Error *error)
{
    if (status == STATUS_OK) return true;
    Evaluator *evaluator = call->evaluator;
    const EvalNode *node = call->args[0].as.node;
    if (status != STATUS_SCENE) {
        if (!evaluator->stop) eval_report(evaluator, D_LIMIT, call->expr->span, "%s", error->text);
        evaluator->stop = true;
    } else if (error->text[0]) {
        Diagnostic *report = eval_error(evaluator, call->expr, D_NO_GEOMETRY, "%s", error->text);
        diag_note(evaluator->diag, report, node->span, "this %s is asked", node->type->name);
    }
    return false;
}

void run_bounds(const BuiltinCall *call, Value *result)
{
    if (!begin(call, result)) return;
    Error error = {0};
    Box3 box;
    Evaluator *evaluator = call->evaluator;
    Status status = evaluator->options->geometry->bounds(evaluator->geometry, call->args[0].as.node, &box, &error);
    if (!answered(call, status, &error)) return;
    Vec3 size = vec3_sub(box.max, box.min), center = vec3_along(box.min, 0.5, size);
    *result = record_new(evaluator->arena, RECORD_BOUNDS,
                         (double[]){box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z, center.x,
                                    center.y, center.z, size.x, size.y, size.z});
}

void run_volume(const BuiltinCall *call, Value *result)
{
    if (!begin(call, result)) return;
    Error error = {0};
    double volume;
    Evaluator *evaluator = call->evaluator;
    Status status = evaluator->options->geometry->volume(evaluator->geometry, call->args[0].as.node, &volume, &error);
    if (!answered(call, status, &error)) return;
    *result = value_number(volume);
    builtin_finite(call, result);
}

void run_inside(const BuiltinCall *call, Value *result)
{
    if (!begin(call, result)) return;
    if (call->args[1].kind != VALUE_VECTOR3) {
        builtin_wrong(call, 1, "a node and a point", result);
        return;
    }
    Error error = {0};
    bool inside;
    Evaluator *evaluator = call->evaluator;
    Status status = evaluator->options->geometry->inside(evaluator->geometry, call->args[0].as.node,
                                                         vector_of(&call->args[1]), &inside, &error);
    if (answered(call, status, &error)) *result = value_truth(inside);
}

/* ---- rays ---- */

static Value value_of_hit(Evaluator *evaluator, const EvalHit *hit)
{
    return record_new(evaluator->arena, RECORD_HIT,
                      (double[]){hit->point.x, hit->point.y, hit->point.z, hit->normal.x, hit->normal.y, hit->normal.z,
                                 hit->distance});
}

static bool trace(const BuiltinCall *call, bool all, const EvalHit **hits, size_t *n, Value *result)
{
    if (!begin(call, result)) return false;
    for (uint32_t i = 1; i < 3; i++)
        if (call->args[i].kind != VALUE_VECTOR3) {
            builtin_wrong(call, i, "a node, a point and a direction", result);
            return false;
        }
    Vec3 direction = vec3_normalize(vector_of(&call->args[2]));
    if (!vec3_is_finite(direction)) {
        eval_error(call->evaluator, call->expr, D_BAD_NUMBER, "a direction of length 0 leads nowhere");
        return false;
    }
    Error error = {0};
    Evaluator *evaluator = call->evaluator;
    Status status = evaluator->options->geometry->hits(evaluator->geometry, call->args[0].as.node,
                                                       vector_of(&call->args[1]), direction, all, hits, n, &error);
    return answered(call, status, &error);
}

void run_hit(const BuiltinCall *call, Value *result)
{
    const EvalHit *hits;
    size_t n;
    if (!trace(call, false, &hits, &n, result)) return;
    *result = n ? value_of_hit(call->evaluator, &hits[0]) : value_none();
}

void run_hits(const BuiltinCall *call, Value *result)
{
    const EvalHit *hits;
    size_t n;
    if (!trace(call, true, &hits, &n, result)) return;
    ListBuilder list = {.arena = call->evaluator->arena};
    for (size_t i = 0; i < n && eval_step(call->evaluator, call->expr->span); i++) {
        Value hit = value_of_hit(call->evaluator, &hits[i]);
        list_builder_add(&list, &hit);
    }
    *result = list_builder_finish(&list);
}

void run_scatter(const BuiltinCall *call, Value *result)
{
    uint64_t seed = scatter_start;
    if (!begin(call, result) || !builtin_hash(call, 1, &seed, result)) return;
    Error error = {0};
    EvalHit place;
    Evaluator *evaluator = call->evaluator;
    Status status =
        evaluator->options->geometry->scatter(evaluator->geometry, call->args[0].as.node, seed, &place, &error);
    if (!answered(call, status, &error)) return;
    *result = record_new(
        evaluator->arena, RECORD_PLACE,
        (double[]){place.point.x, place.point.y, place.point.z, place.normal.x, place.normal.y, place.normal.z});
}

/* build_field.c - functions of the scene asked at the points of a grid: compiled where that is possible, and then by all
 * threads, line by line. What has no value there is asked of the evaluation, which knows what to say.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "scene/build_parts.h"

enum { STEPS_WORTH_SHARING = 50000 }; /* some tens of microseconds: fewer are done before other threads are awake */

SceneField build_field(const Builder *b, const EvalFunctionValue *function)
{
    return (SceneField){.function = function,
                        .program = formula_compile_at_points(function, b->eval_options.arena),
                        .pool = b->options->pool};
}

static double run(const Program *program, Vec3 p)
{
    double inputs[PROGRAM_INPUTS] = {p.x, p.y, p.z}, value;
    program_run(program, inputs, &value);
    return value;
}

bool build_field_shared_value(const SceneField *field, Vec3 p, double *value)
{
    if (!field->program) return false;
    *value = run(field->program, p);
    return isfinite(*value);
}

bool build_field_value(const SceneField *field, Vec3 p, double *value)
{
    return build_field_shared_value(field, p, value) || eval_function_at(field->function, p, value);
}

bool build_field_bounds(const SceneField *field, Box3 box, double *low, double *high)
{
    if (!field->program) return false;
    const ProgramRange inputs[PROGRAM_INPUTS] = {
        {box.min.x, box.max.x}, {box.min.y, box.max.y}, {box.min.z, box.max.z}};
    ProgramRange value;
    program_bound(field->program, inputs, &value);
    *low = value.low;
    *high = value.high;
    return program_range_is_known(value);
}

/* A layer in the making. */
typedef struct LayerTask {
    const SceneField *field;
    const FieldLayer *layer;
    double *values;
} LayerTask;

static void task_of_line(void *context, uint32_t j, unsigned worker)
{
    (void)worker;
    const LayerTask *task = context;
    const FieldLayer *layer = task->layer;
    double *values = task->values + (size_t)j * layer->n[0];
    const uint8_t *wanted = layer->wanted ? layer->wanted + (size_t)j * layer->n[0] : NULL;
    for (uint32_t i = 0; i < layer->n[0]; i++)
        if (!wanted || wanted[i]) values[i] = run(task->field->program, layer->point(layer->context, i, j, layer->k));
}

bool build_field_layer(const SceneField *field, const FieldLayer *layer, double *values)
{
    size_t n = (size_t)layer->n[0] * layer->n[1];
    LayerTask task = {field, layer, values};
    if (field->program) {
        bool shared = (double)n * field->program->n_steps > STEPS_WORTH_SHARING;
        pool_run(shared ? field->pool : NULL, layer->n[1], task_of_line, &task);
    }
    for (size_t i = 0; i < n; i++) {
        if ((layer->wanted && !layer->wanted[i]) || (field->program && isfinite(values[i]))) continue;
        Vec3 p = layer->point(layer->context, (uint32_t)(i % layer->n[0]), (uint32_t)(i / layer->n[0]), layer->k);
        if (!eval_function_at(field->function, p, &values[i])) return false;
    }
    return true;
}

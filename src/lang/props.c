/* props.c - reading the properties of a checked node; what was not set comes from the default text of its table row.
 * SPDX-License-Identifier: Apache-2.0 */
#include <assert.h>
#include <string.h>

#include "base/num.h"
#include "lang/eval.h"

const EvalProp *eval_prop(const EvalNode *node, const char *name)
{
    for (size_t i = 0; i < node->n_props; i++)
        if (strcmp(node->props[i].type->name, name) == 0) return &node->props[i];
    return NULL;
}

/* The default in the table's words; NULL when there is none. The row must be there. */
static const char *default_text(const EvalNode *node, const char *name)
{
    for (size_t i = 0; i < node->type->n_props; i++)
        if (strcmp(node->type->props[i].name, name) == 0) return node->type->props[i].default_text;
    assert(0 && "no such property in the node's table");
    return NULL;
}

bool eval_has_value(const EvalNode *node, const char *name)
{
    return eval_prop(node, name) || default_text(node, name);
}

/* The numbers in "3", "<0, 0, 0>": at most n; returns how many there were. */
static int read_numbers(const char *text, double *numbers, int n)
{
    int count = 0;
    while (*text && count < n) {
        size_t length = num_parse(text, strlen(text), &numbers[count]);
        if (length)
            count++;
        else
            length = 1;
        text += length;
    }
    return count;
}

double eval_number(const EvalNode *node, const char *name)
{
    const EvalProp *prop = eval_prop(node, name);
    if (prop && !prop->textured) return prop->as.number;
    const char *text = default_text(node, name);
    double number = 0;
    if (text) read_numbers(text, &number, 1);
    return number;
}

bool eval_truth(const EvalNode *node, const char *name)
{
    const EvalProp *prop = eval_prop(node, name);
    if (prop) return prop->as.truth;
    const char *text = default_text(node, name);
    return text && strcmp(text, "true") == 0;
}

const char *eval_word(const EvalNode *node, const char *name)
{
    const EvalProp *prop = eval_prop(node, name);
    return prop ? prop->as.text : default_text(node, name);
}

Vec3 eval_vector(const EvalNode *node, const char *name)
{
    const EvalProp *prop = eval_prop(node, name);
    if (prop && !prop->textured) return vec3(prop->as.vector[0], prop->as.vector[1], prop->as.vector[2]);
    const char *text = default_text(node, name);
    double numbers[3] = {0};
    if (text && read_numbers(text, numbers, 3) == 1) numbers[1] = numbers[2] = numbers[0]; /* a grey */
    return vec3(numbers[0], numbers[1], numbers[2]);
}

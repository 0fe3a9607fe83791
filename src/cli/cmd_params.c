/* cmd_params.c - the command params: what -D can set in a scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/commands.h"
#include "cli/scene_input.h"
#include "lang/lex.h"

static const char *unit_of_param(const EvalResult *result, const EvalParam *param)
{
    return unit_of_measure(param->measure, result->unit_m);
}

static void print_text(const EvalResult *result, Buf *out)
{
    size_t widest_name = 0, widest_value = 0;
    Buf value = {0}, rest = {0};
    for (int prints = 0; prints <= 1; prints++) /* after the widths are known */
        for (size_t i = 0; i < result->n_params; i++) {
            const EvalParam *param = &result->params[i];
            const char *unit = unit_of_param(result, param), *doc = param->doc ? param->doc : "";
            value.length = rest.length = 0;
            unit_add_behind_numbers(&value, param->value, unit);
            buf_add(&rest, doc);
            if (param->range) buf_format(&rest, "%sin ", *doc ? ", " : "");
            if (param->range) unit_add_behind_numbers(&rest, param->range, unit);
            if (strlen(param->name) > widest_name) widest_name = strlen(param->name);
            if (value.length > widest_value) widest_value = value.length;
            if (prints)
                buf_format(out, "%-*s = %-*s%s%s\n", (int)widest_name, param->name, rest.length ? (int)widest_value : 0,
                           buf_text(&value), rest.length ? "  " : "", rest.length ? buf_text(&rest) : "");
        }
    buf_clear(&value);
    buf_clear(&rest);
}

static void print_json(const EvalResult *result, Buf *out)
{
    JsonWriter json = json_writer(out, true);
    json_begin_object(&json);
    json_key(&json, "params");
    json_begin_array(&json);
    for (size_t i = 0; i < result->n_params; i++) {
        json_begin_object(&json);
        json_add_text(&json, "name", result->params[i].name);
        json_add_text(&json, "value", result->params[i].value);
        json_add_text(&json, "unit", unit_of_param(result, &result->params[i]));
        json_add_text(&json, "type", result->params[i].type);
        json_add_text(&json, "range", result->params[i].range);
        json_add_text(&json, "doc", result->params[i].doc);
        json_end(&json);
    }
    json_end(&json);
    json_end(&json);
    buf_add(out, "\n");
}

Status cmd_params(const Options *options, const Talk *talk, Error *error)
{
    SceneInput input;
    EvalResult result = {0};
    Buf out = {0};
    scene_input_init(&input, options, talk);
    Status status = scene_input_evaluate(&input, &result, error);
    Error report_error = {0};
    Status reported = scene_input_print_reports(&input, &report_error);
    if (status == STATUS_OK && reported != STATUS_OK) {
        status = reported;
        *error = report_error;
    }
    if (status == STATUS_OK) {
        if (option_given(options, OPTION_JSON))
            print_json(&result, &out);
        else
            print_text(&result, &out);
        status = print_out(&out, error);
    }
    buf_clear(&out);
    buf_clear(&result.printed);
    scene_input_close(&input);
    return status;
}

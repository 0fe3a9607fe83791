/* bare_text.c - texts without their quotes as values of -D and --set. wood.png is an expression, and dir/wood-2.png is one
 * with a unit: what is wrong with these helps nobody.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/bare_text.h"

#include <string.h>

#include "lang/schema_find.h"

/* A value that is read as it is meant, and not allowed. */
static bool is_of_value(DiagCode code)
{
    return code != D_VALUE_OUT_OF_RANGE && code != D_UNKNOWN_PARAM && code != D_UNKNOWN_PROPERTY &&
           code != D_UNKNOWN_NODE && code != D_UNKNOWN_CHOICE && code != D_LIMIT;
}

static bool has_mistake(const Diag *diag, uint32_t source)
{
    for (const Diagnostic *report = diag->first; report; report = report->next)
        if (report->has_span && report->span.source == source && report->severity == DIAG_ERROR &&
            is_of_value(report->code))
            return true;
    return false;
}

/* NULL where nothing is to be said. */
static Diagnostic *report_bare(Diag *diag, uint32_t source, const char *option)
{
    const char *text = diag->sources->sources[source].text, *value = strchr(text, '=');
    if (!value || strchr(value, '"') || !has_mistake(diag, source)) return NULL;
    size_t length = strlen(++value);
    Span span = {source, (uint32_t)(value - text), (uint32_t)(value - text + (long)length)};
    bool quoted = length >= 2 && value[0] == '\'' && value[length - 1] == '\'';
    int n = (int)(quoted ? length - 2 : length);
    diag_drop_source(diag, source);
    Diagnostic *report = diag_report(diag, D_SYNTAX, span, "a text is wanted here, and texts stand in double quotes");
    if (report && !memchr(value + quoted, '\'', (size_t)n) && !memchr(value, '\\', length))
        diag_hint(diag, report, "write: %s '%.*s\"%.*s\"'", option, (int)(value - text), text, n, value + quoted);
    return report;
}

static const Stmt *text_param(const File *scene, const char *name)
{
    for (const Stmt *stmt = scene->block->first; stmt; stmt = stmt->next) {
        if (stmt->kind != STMT_PARAM || strcmp(stmt->as.bind.name->text, name) != 0) continue;
        const Expr *value = stmt->as.bind.value;
        return value->kind == EXPR_CONSTANT && value->as.constant.value.kind == VALUE_STRING ? stmt : NULL;
    }
    return NULL;
}

void bare_text_of_define(Diag *diag, const File *scene, const Define *define)
{
    const Stmt *param = text_param(scene, define->name);
    Diagnostic *report = param ? report_bare(diag, define->span.source, "-D") : NULL;
    if (report) diag_note(diag, report, param->as.bind.name_span, "declared here");
}

/* Of a node that goes by its name it is not known here which type it has: of any that has the property. */
static bool is_text_property(const Schema *schema, const Override *override)
{
    const NodeType *type = schema_node(schema, override->node);
    bool text = false;
    for (size_t i = 0; i < schema->n_nodes; i++) {
        const PropType *prop = schema_prop(&schema->nodes[i], override->prop);
        if (!prop || (type && type != &schema->nodes[i])) continue;
        text = prop->kind == PROP_STRING || (prop->kind == PROP_STRINGS && !prop->choices);
        if (!text) return false;
    }
    return text;
}

void bare_text_of_override(Diag *diag, const Schema *schema, const Override *override)
{
    if (override->prop && is_text_property(schema, override)) report_bare(diag, override->node_span.source, "--set");
}

/* reference.c - nodes, properties and diagnostics in words.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/reference.h"

#include <math.h>
#include <string.h>

#include "base/num.h"
#include "cli/commands.h"
#include "lang/schema_find.h"
#include "scene/build.h"

enum { PROPERTY_COLUMN = 18 };

static const char *kind_text(PropKind kind)
{
    static const char *const texts[] = {
        [PROP_NUMBER] = "number",
        [PROP_INTEGER] = "whole number",
        [PROP_BOOL] = "true or false",
        [PROP_STRING] = "string",
        [PROP_CHOICE] = "one of",
        [PROP_VECTOR2] = "vector of 2",
        [PROP_VECTOR3] = "vector of 3",
        [PROP_COLOR] = "colour",
        [PROP_SPECTRUM] = "number, colour, vector of 3 or spectrum",
        [PROP_NUMBER_OR_TERM] = "number or spectrum",
        [PROP_TERM] = "term",
        [PROP_NODE] = "a",
        [PROP_NUMBERS] = "list of numbers",
        [PROP_VECTORS2] = "list of vectors of 2",
        [PROP_VECTORS3] = "list of vectors of 3",
        [PROP_VECTOR3_OR_LIST] = "vector of 3, or list of such",
        [PROP_NUMBER_LISTS] = "list of lists of numbers",
        [PROP_VECTOR2_LISTS] = "list of vectors of 2, or list of such lists",
        [PROP_FUNCTION] = "name of a function",
        [PROP_STRINGS] = "string or list of strings",
        [PROP_NODES] = "list of",
        [PROP_RAMP] = "list of numbers or colours, or of [position, number or colour]",
    };
    return texts[kind];
}

static const char *unit_text(PropUnit unit)
{
    static const char *const texts[] = {
        [UNIT_NONE] = "",
        [UNIT_LENGTH] = "length",
        [UNIT_ANGLE] = "angle in degrees",
        [UNIT_TIME] = "time",
        [UNIT_PER_LENGTH] = "per length",
        [UNIT_KELVIN] = "temperature in kelvin",
        [UNIT_ANY] = "as the property",
    };
    return texts[unit];
}

static void print_words(const char *words, const char *last_joint, Buf *out)
{
    while (*words) {
        size_t length = strcspn(words, "|");
        buf_add_bytes(out, words, length);
        words += length;
        if (!*words) break;
        words++;
        buf_add(out, strchr(words, '|') ? ", " : last_joint);
    }
}

static void print_range(const PropType *type, Buf *out)
{
    char low[NUM_TEXT_SIZE], high[NUM_TEXT_SIZE];
    num_print(type->min, low);
    num_print(type->max, high);
    bool has_low = isfinite(type->min), has_high = isfinite(type->max);
    if (has_low && has_high)
        buf_format(out, ", %s%s to %s%s", type->flags & PROP_OPEN_MIN ? "above " : "", low,
                   type->flags & PROP_OPEN_MAX ? "below " : "", high);
    else if (has_low)
        buf_format(out, type->flags & PROP_OPEN_MIN ? ", above %s" : ", at least %s", low);
    else if (has_high)
        buf_format(out, type->flags & PROP_OPEN_MAX ? ", below %s" : ", at most %s", high);
}

void reference_print_type(const PropType *type, Buf *out)
{
    buf_add(out, type->kind == PROP_STRINGS && type->choices ? "one or a list of" : kind_text(type->kind));
    if (type->kind == PROP_NODE && type->choices && strchr("aeiou", type->choices[0])) buf_add(out, "n");
    if (type->choices) {
        buf_add(out, " ");
        print_words(type->choices, " or ", out);
        if (type->kind == PROP_NODE || type->kind == PROP_NODES) buf_add(out, type->kind == PROP_NODE ? "" : " nodes");
    }
    if (type->unit != UNIT_NONE) buf_format(out, ", %s", unit_text(type->unit));
    print_range(type, out);
    if (type->flags & PROP_TEXTURE) buf_add(out, ", or a texture");
}

const NodeType *reference_node(const char *name)
{
    const Schema *schema = scene_schema();
    for (size_t i = 0; i < schema->n_nodes; i++)
        if (strcmp(schema->nodes[i].name, name) == 0) return &schema->nodes[i];
    return NULL;
}

const TermType *reference_term(const char *name)
{
    const Schema *schema = scene_schema();
    for (size_t i = 0; i < schema->n_terms; i++)
        if (strcmp(schema->terms[i].name, name) == 0) return &schema->terms[i];
    return NULL;
}

DiagCode reference_diagnostic(const char *slug)
{
    DiagCode code = 0;
    while (code < D_COUNT && strcmp(diag_slug(code), slug) != 0) code++;
    return code;
}

/* "the radius (number, length, above 0; default: `1`)" */
static void describe_property(const PropType *type, Buf *text)
{
    buf_format(text, "%s (", type->doc);
    reference_print_type(type, text);
    if (type->flags & PROP_REQUIRED)
        buf_add(text, "; required");
    else if (type->default_text)
        buf_format(text, "; default: `%s`", type->default_text);
    buf_add(text, ")");
}

void reference_print_node(const NodeType *node, Buf *out)
{
    buf_format(out, "%s - %s\n", node->name, node->doc);
    if (node->n_props) buf_add(out, "\nProperties:\n");
    for (size_t i = 0; i < node->n_props; i++) {
        const PropType *type = &node->props[i];
        Buf text = {0};
        describe_property(type, &text);
        size_t column = 2 + strlen(type->name);
        buf_format(out, "  %s", type->name);
        if (column >= PROPERTY_COLUMN) { /* no room beside it */
            buf_add(out, "\n");
            column = 0;
        }
        help_wrap(out, buf_text(&text), PROPERTY_COLUMN, column);
        buf_clear(&text);
    }
    buf_add(out, "\nManual: meniscus-scene(5)\n");
}

/* Whether two nodes say the same of a property. */
static bool same_property(const PropType *a, const PropType *b)
{
    Buf of_a = {0}, of_b = {0};
    describe_property(a, &of_a);
    describe_property(b, &of_b);
    bool same = strcmp(buf_text(&of_a), buf_text(&of_b)) == 0;
    buf_clear(&of_a);
    buf_clear(&of_b);
    return same;
}

bool reference_is_property(const char *name)
{
    const Schema *schema = scene_schema();
    for (size_t i = 0; i < schema->n_nodes; i++)
        if (schema_prop(&schema->nodes[i], name)) return true;
    return false;
}

void reference_print_property(const char *name, Buf *out)
{
    const Schema *schema = scene_schema();
    buf_format(out, "%s - a property of\n", name);
    for (size_t i = 0; i < schema->n_nodes; i++) {
        const PropType *type = schema_prop(&schema->nodes[i], name), *other = NULL;
        for (size_t k = 0; type && k < i; k++) {
            other = schema_prop(&schema->nodes[k], name);
            if (other && same_property(type, other)) break;
            other = NULL;
        }
        if (!type || other) continue; /* said already */
        Buf nodes = {0}, text = {0};
        for (size_t k = i; k < schema->n_nodes; k++) {
            other = schema_prop(&schema->nodes[k], name);
            if (other && same_property(type, other))
                buf_format(&nodes, "%s%s", nodes.length ? ", " : "", schema->nodes[k].name);
        }
        describe_property(type, &text);
        buf_add(out, "\n");
        help_wrap(out, buf_text(&nodes), 2, 0);
        help_wrap(out, buf_text(&text), 6, 0);
        buf_clear(&nodes);
        buf_clear(&text);
    }
    buf_add(out, "\nManual: meniscus-scene(5)\n");
}

bool reference_print_property_of(const NodeType *node, const char *name, Buf *out)
{
    const PropType *type = schema_prop(node, name);
    if (!type) return false;
    Buf text = {0};
    describe_property(type, &text);
    buf_format(out, "%s - a property of %s\n\n", name, node->name);
    help_wrap(out, buf_text(&text), 2, 0);
    buf_add(out, "\nManual: meniscus-scene(5)\n");
    buf_clear(&text);
    return true;
}

void reference_print_diagnostic(DiagCode code, Buf *out)
{
    buf_format(out, "%s (%s)\n\n", diag_slug(code), diag_severity_text(diag_severity(code)));
    help_wrap(out, diag_cause(code), 0, 0);
    help_wrap(out, diag_cure(code), 0, 0);
    buf_add(out, "\nManual: meniscus-diagnostics(7)\n");
}

/* Where the doc begins with the call, as noise(x, y, z): ..., the name is there already. */
static void print_call(const char *name, const char *doc, const char *page, Buf *out)
{
    Buf text = {0};
    size_t length = strlen(name);
    if (strncmp(doc, name, length) != 0 || doc[length] != '(') buf_format(&text, "%s: ", name);
    buf_add(&text, doc);
    help_wrap(out, buf_text(&text), 0, 0);
    buf_clear(&text);
    buf_format(out, "\nManual: %s\n", page);
}

void reference_print_function(const Builtin *function, Buf *out)
{
    print_call(function->name, function->doc, "meniscus-language(5)", out);
}

void reference_print_term(const TermType *term, Buf *out)
{
    print_call(term->name, term->doc, "meniscus-scene(5)", out);
}

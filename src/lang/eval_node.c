/* eval_node.c - making and placing nodes.
 * While the block of a node runs, its values are collected in a Target by row of the type's table; when it ends they
 * are packed in table order. An instance that sets nothing shares the prototype's values.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "lang/evaluator.h"

static void node_list_add(Evaluator *evaluator, NodeList *list, EvalNode *node)
{
    ARENA_ROOM(evaluator->arena, list->items, list->capacity, list->n, 4);
    list->items[list->n++] = node;
}

/* ---- properties ---- */

static size_t row_of(const NodeType *type, const PropType *prop)
{
    return (size_t)(prop - type->props);
}

/* Room for the values of one node in the making, by row; used again for the next one. */
struct PropRoom {
    PropRoom *next;
    EvalProp *props;
    PropState *states;
    Span *set_spans;
};

static PropRoom *take_room(Evaluator *evaluator, size_t n)
{
    PropRoom *room = evaluator->rooms;
    if (room) {
        evaluator->rooms = room->next;
        memset(room->states, 0, n * sizeof *room->states);
        return room;
    }
    size_t largest = 0;
    for (size_t i = 0; i < evaluator->schema->n_nodes; i++)
        if (evaluator->schema->nodes[i].n_props > largest) largest = evaluator->schema->nodes[i].n_props;
    room = ARENA_NEW(evaluator->arena, PropRoom);
    room->props = ARENA_ARRAY(evaluator->arena, EvalProp, largest);
    room->states = ARENA_ARRAY(evaluator->arena, PropState, largest);
    room->set_spans = ARENA_ARRAY(evaluator->arena, Span, largest);
    return room;
}

static void open_props(Evaluator *evaluator, Target *target)
{
    if (target->room) return;
    target->room = take_room(evaluator, target->type->n_props);
    target->props = target->room->props;
    target->states = target->room->states;
    target->set_spans = target->room->set_spans;
    for (size_t i = 0; target->base && i < target->base->n_props; i++) {
        size_t row = row_of(target->type, target->base->props[i].type);
        target->props[row] = target->base->props[i];
        target->states[row] = PROP_INHERITED;
    }
}

static void set_prop(Evaluator *evaluator, Stmt *stmt, Target *target)
{
    const PropType *prop = stmt->as.prop.prop;
    if (stmt->as.prop.node_type != target->type) {
        prop = schema_prop(target->type, stmt->as.prop.name->text);
        stmt->as.prop.node_type = target->type;
        stmt->as.prop.prop = prop;
        if (!prop && target->hidden && schema_prop(target->hidden, stmt->as.prop.name->text)) {
            target->has_unknown = true; /* settle reports what it all comes from */
        } else if (!prop) {
            evaluator->diag->chain = frame_chain(evaluator, evaluator->frame);
            report_unknown_property(evaluator->diag, stmt->span, target->type, stmt->as.prop.name->text,
                                    stmt->as.prop.value, false);
            evaluator->diag->chain = NULL;
            target->has_unknown = true;
        }
    }
    if (!prop) return;
    open_props(evaluator, target);
    size_t row = row_of(target->type, prop);
    if (target->states[row] >= PROP_SET && !stmt->reported) {
        stmt->reported = true;
        Diagnostic *report =
            eval_report(evaluator, D_DUPLICATE_PROPERTY, stmt->span, "property '%s' is set twice", prop->name);
        diag_note(evaluator->diag, report, target->set_spans[row], "first set here");
    }
    target->set_spans[row] = stmt->span;
    bool fine = prop_check(evaluator, prop, stmt->as.prop.value, &target->props[row]);
    target->states[row] = !fine ? PROP_BAD : target->props[row].type ? PROP_SET : PROP_UNSET;
    if (prop->flags & PROP_SHAPE) target->shape_changed = true;
}

static void set_macro_arg(Evaluator *evaluator, Stmt *stmt, Target *target)
{
    const Def *def = target->def;
    uint64_t given = 0;
    for (uint32_t i = 0; i < def->n_formals; i++) {
        if (target->args[i].kind != VALUE_UNSET && i < 64) given |= (uint64_t)1 << i;
        if (def->formals[i].name != stmt->as.prop.name) continue;
        if (target->args[i].kind != VALUE_UNSET && !stmt->reported) {
            stmt->reported = true;
            eval_report(evaluator, D_DUPLICATE_ARGUMENT, stmt->span, "'%s' is given twice", stmt->as.prop.name->text);
        }
        eval_value(evaluator, stmt->as.prop.value, &target->args[i]);
        return;
    }
    if (stmt->reported) return;
    stmt->reported = true;
    eval_report_formal(evaluator, def, given, stmt->as.prop.name->text, stmt->span);
}

void eval_prop_stmt(Evaluator *evaluator, Stmt *stmt)
{
    Target *target = evaluator->target;
    if (target && target->type)
        set_prop(evaluator, stmt, target);
    else if (target && target->def)
        set_macro_arg(evaluator, stmt, target);
}

/* ---- making ---- */

static void check_required(Evaluator *evaluator, const Target *target)
{
    const NodeType *type = target->type;
    for (size_t row = 0; row < type->n_props; row++) {
        const PropType *prop = &type->props[row];
        if (!(prop->flags & PROP_REQUIRED) || (target->states && target->states[row] != PROP_UNSET)) continue;
        bool inherited = false;
        for (size_t i = 0; target->base && i < target->base->n_props; i++)
            inherited |= target->base->props[i].type == prop;
        if (inherited) continue;
        Diagnostic *report = eval_report(evaluator, D_MISSING_PROPERTY, target->span, "%s lacks its property '%s'",
                                         with_article(evaluator->arena, type->name), prop->name);
        diag_hint(evaluator->diag, report, "write: %s = ..., %s", prop->name, prop_kind_text(evaluator->arena, prop));
    }
}

static void pack_props(Evaluator *evaluator, Target *target, EvalNode *node)
{
    if (!target->room) {
        if (target->base) {
            node->props = target->base->props;
            node->n_props = target->base->n_props;
        }
        return;
    }
    size_t n = 0;
    for (size_t row = 0; row < target->type->n_props; row++) {
        PropState state = target->states[row];
        if (state == PROP_INHERITED || state == PROP_SET) target->props[n++] = target->props[row];
    }
    node->n_props = n;
    node->props = ARENA_ARRAY(evaluator->arena, EvalProp, n);
    memcpy(node->props, target->props, n * sizeof(EvalProp));
    target->room->next = evaluator->rooms;
    evaluator->rooms = target->room;
    target->room = NULL;
}

static void join_children(Evaluator *evaluator, const NodeList *own, const EvalNode *prototype, EvalNode *node)
{
    node->children = own->items;
    node->n_children = own->n;
    if (!prototype || prototype->n_children == 0) return;
    node->children = prototype->children;
    node->n_children = prototype->n_children;
    if (own->n == 0) return;
    node->n_children += own->n;
    node->children = ARENA_ARRAY(evaluator->arena, EvalNode *, node->n_children);
    memcpy(node->children, prototype->children, prototype->n_children * sizeof(EvalNode *));
    memcpy(node->children + prototype->n_children, own->items, own->n * sizeof(EvalNode *));
}

static bool count_node(Evaluator *evaluator, Span span)
{
    if (++evaluator->n_nodes <= evaluator->limits.nodes) return true;
    if (!evaluator->stop)
        limit_hint(evaluator->diag,
                   eval_report(evaluator, D_LIMIT, span, "the scene makes more than %.0f nodes",
                               (double)evaluator->limits.nodes),
                   OVER_NODES);
    evaluator->stop = true;
    return false;
}

static EvalNode *new_node(Evaluator *evaluator, const NodeType *type, Span span)
{
    EvalNode *node = ARENA_NEW(evaluator->arena, EvalNode);
    node->type = type;
    node->span = span;
    node->chain = frame_chain(evaluator, evaluator->frame);
    node->transform = affine_identity();
    node->identity = eval_within(evaluator->where, span, 0);
    return node;
}

/* Whatever walks over the tree may do so by recursion. */
static void check_depth(Evaluator *evaluator, const NodeList *own, const EvalNode *prototype, EvalNode *node)
{
    unsigned depth = prototype ? prototype->depth + 1 : 0;
    for (size_t i = 0; i < own->n; i++)
        if (own->items[i]->depth >= depth) depth = own->items[i]->depth + 1;
    node->depth = depth;
    if (depth <= LIMIT_NODE_DEPTH || evaluator->stop) return;
    limit_hint(
        evaluator->diag,
        eval_report(evaluator, D_TOO_DEEP, node->span, "nodes within nodes, deeper than %d levels", LIMIT_NODE_DEPTH),
        OVER_NODE_DEPTH);
    evaluator->stop = true;
}

static EvalNode *finish_node(Evaluator *evaluator, Target *target, const EvalNode *prototype, const char *name)
{
    EvalNode *node = new_node(evaluator, target->type, target->span);
    node->name = name;
    pack_props(evaluator, target, node);
    join_children(evaluator, &target->children, prototype, node);
    check_depth(evaluator, &target->children, prototype, node);
    node->transform = target->transform;
    if (prototype) {
        node->transform = affine_compose(&target->transform, &prototype->transform);
        if (!target->shape_changed && target->children.n == 0) node->prototype = prototype;
    }
    return node;
}

/* The prototype that a node's word names; NULL (and no report) when it is a built-in type. */
static bool find_prototype(Evaluator *evaluator, NodeExpr *expr, const EvalNode **prototype)
{
    *prototype = NULL;
    if (!expr->has_prototype) return expr->type != NULL;
    const Value *value = eval_slot(evaluator, expr->prototype);
    if (value->kind == VALUE_NODE) {
        *prototype = value->as.node;
        return true;
    }
    if (expr->type) return true;
    const char *word = expr->path.names[expr->path.n - 1]->text;
    if (value->kind == VALUE_UNSET)
        eval_report(evaluator, D_UNSET_NAME, expr->path.span, "'%s' is used before it has its value", word);
    else if (value->kind != VALUE_POISON) {
        Diagnostic *report = eval_report(evaluator, D_WRONG_TYPE, expr->path.span, "'%s' is %s, not a node", word,
                                         value_describe(evaluator->arena, value));
        if (value->kind == VALUE_TRANSFORM)
            diag_hint(evaluator->diag, report, "write: transform(%s), in what it is to move", word);
    }
    return false;
}

/* ---- --set ---- */

/* A type stands for all nodes of that type; an instance takes part through its prototype, unless it sets the property
 * itself. */
static bool override_applies(const Override *override, const Target *target, const char *name, bool instance)
{
    if (name && strcmp(override->node, name) == 0) return true;
    if (strcmp(override->node, target->type->name) != 0) return false;
    const PropType *prop = schema_prop(target->type, override->prop);
    return !instance || (prop && target->states && target->states[row_of(target->type, prop)] >= PROP_SET);
}

static void apply_override(Evaluator *evaluator, Override *override, Target *target)
{
    const PropType *prop = schema_prop(target->type, override->prop);
    override->used = true;
    if (!prop) {
        if (!override->reported)
            report_unknown_property(evaluator->diag, override->prop_span, target->type, override->prop, override->expr,
                                    true);
        override->reported = true;
        return;
    }
    open_props(evaluator, target);
    size_t row = row_of(target->type, prop);
    bool fine = prop_check(evaluator, prop, override->expr, &target->props[row]);
    target->states[row] = !fine ? PROP_BAD : target->props[row].type ? PROP_SET : PROP_UNSET;
    target->set_spans[row] = override->prop_span;
    if (prop->flags & PROP_SHAPE) target->shape_changed = true;
}

/* A value may hold nodes itself: those are as it writes them. */
static void apply_overrides(Evaluator *evaluator, Target *target, const char *name, bool instance)
{
    if (evaluator->in_override) return;
    evaluator->in_override = true;
    for (size_t i = 0; i < evaluator->n_overrides; i++) {
        Override *override = &evaluator->overrides[i];
        if (override_applies(override, target, name, instance)) apply_override(evaluator, override, target);
    }
    evaluator->in_override = false;
}

/* The type of node that the word of an instance hides; or NULL. */
static const NodeType *hidden_node(const Evaluator *evaluator, const NodeExpr *expr)
{
    return expr->has_prototype && expr->path.n == 1 ? schema_node(evaluator->schema, expr->path.names[0]->text) : NULL;
}

/* NULL after a report. partial: defaults, which need not be complete. */
static EvalNode *make_node(Evaluator *evaluator, NodeExpr *expr, const char *name, bool partial)
{
    const EvalNode *prototype;
    if (!find_prototype(evaluator, expr, &prototype) || !count_node(evaluator, expr->path.span)) return NULL;
    const NodeType *type = prototype ? prototype->type : expr->type;
    Target target = {.type = type, .base = prototype, .name = type->name, .span = expr->path.span};
    target.transform = affine_identity();
    if (!name && !(type->flags & (NODE_SINGLE | NODE_PLACED))) target.hidden = hidden_node(evaluator, expr);
    if (!prototype && expr->has_defaults) {
        const Value *defaults = eval_slot(evaluator, expr->defaults);
        if (defaults->kind == VALUE_NODE) target.base = defaults->as.node;
    }
    Target *outer = evaluator->target;
    evaluator->target = &target;
    eval_block(evaluator, expr->block);
    evaluator->target = outer;
    if (evaluator->stop) return NULL;
    if (!partial && evaluator->n_overrides) apply_overrides(evaluator, &target, name, prototype != NULL);
    if (!partial && !expr->has_unknown && !target.has_unknown) check_required(evaluator, &target);
    return finish_node(evaluator, &target, prototype, name);
}

void eval_node_expr(Evaluator *evaluator, Expr *expr, Value *result)
{
    const char *name = evaluator->bind_name;
    evaluator->bind_name = NULL;
    EvalNode *node = make_node(evaluator, expr->as.node, name, false);
    *result = value_poison();
    if (node) *result = (Value){.kind = VALUE_NODE, .as.node = node};
}

void eval_defaults_stmt(Evaluator *evaluator, Stmt *stmt)
{
    EvalNode *node = make_node(evaluator, stmt->as.node, NULL, true);
    Value value = {.kind = node ? VALUE_NODE : VALUE_POISON, .as.node = node};
    *eval_slot(evaluator, stmt->as.node->prototype) = value;
}

/* ---- placing ---- */

static void merge_single(Evaluator *evaluator, EvalNode *node)
{
    size_t row = (size_t)(node->type - evaluator->schema->nodes);
    EvalNode *first = evaluator->singles[row];
    if (!first) {
        evaluator->singles[row] = node;
        evaluator->single_sources[row] = evaluator->in_preset ? UINT32_MAX : node->span.source;
        node_list_add(evaluator, &evaluator->top, node);
        return;
    }
    bool again = span_same_place(first->span, node->span); /* included twice */
    if (!evaluator->in_preset && !again && evaluator->single_sources[row] == node->span.source) {
        Diagnostic *report =
            eval_report(evaluator, D_DUPLICATE_NODE, node->span, "'%s' stands in this file twice", node->type->name);
        diag_note(evaluator->diag, report, first->span, "first here");
        return;
    }
    evaluator->single_sources[row] = evaluator->in_preset ? UINT32_MAX : node->span.source;
    Target merged = {.type = node->type, .base = first};
    open_props(evaluator, &merged);
    for (size_t i = 0; i < node->n_props; i++) {
        size_t prop = row_of(node->type, node->props[i].type);
        merged.props[prop] = node->props[i];
        merged.states[prop] = PROP_SET;
    }
    pack_props(evaluator, &merged, first);
    first->span = node->span;
    first->chain = node->chain;
}

static void place(Evaluator *evaluator, EvalNode *node)
{
    Target *target = evaluator->target;
    if (!target) {
        if (!evaluator->discard) node_list_add(evaluator, &evaluator->top, node);
    } else if (target->collects) {
        node_list_add(evaluator, &target->children, node);
    } else if (!target->type) {
        Diagnostic *report =
            eval_report(evaluator, D_MISPLACED, node->span, "a node among the arguments of '%s'", target->name);
        diag_hint(evaluator->diag, report, "give it as children: %s(...) { ... }", target->name);
    } else if (!(target->type->flags & NODE_CHILDREN)) {
        eval_report(evaluator, D_MISPLACED, node->span, "%s holds no other nodes",
                    with_article(evaluator->arena, target->type->name));
    } else if (target->type->child_types && !choice_allows(target->type->child_types, node->type->name)) {
        eval_report(evaluator, D_MISPLACED, node->span, "%s holds %s, not %s",
                    with_article(evaluator->arena, target->type->name),
                    choice_text(evaluator->arena, target->type->child_types),
                    with_article(evaluator->arena, node->type->name));
    } else {
        node_list_add(evaluator, &target->children, node);
    }
}

/* The property of the type that a node of the other one is for; NULL: none. */
static const PropType *prop_for_node(const NodeType *type, const NodeType *node)
{
    for (size_t i = 0; i < type->n_props; i++) {
        const PropType *prop = &type->props[i];
        bool holds = prop->kind == PROP_NODE && prop->choices && choice_allows(prop->choices, node->name);
        if (holds || (prop->flags & PROP_TEXTURE && node->flags & NODE_TEXTURE)) return prop;
    }
    return NULL;
}

/* Puts a finished node where the statement stands. expr: that it was made by; NULL: none of the scene's. */
static void settle(Evaluator *evaluator, EvalNode *node, const NodeExpr *expr)
{
    unsigned flags = node->type->flags;
    if (flags & NODE_SINGLE) {
        if (evaluator->target && !evaluator->target->collects)
            eval_report(evaluator, D_MISPLACED, node->span, "'%s' belongs at the top of the scene", node->type->name);
        else if (!evaluator->discard)
            merge_single(evaluator, node);
    } else if (flags & NODE_PLACED) {
        place(evaluator, node);
    } else if (!node->name) {
        const NodeType *outer = evaluator->target ? evaluator->target->type : NULL;
        const PropType *prop = outer ? prop_for_node(outer, node->type) : NULL;
        const NodeType *hidden = expr ? hidden_node(evaluator, expr) : NULL;
        Diagnostic *report = eval_report(evaluator, D_MISSING_NAME, node->span, "%s without a name does nothing",
                                         with_article(evaluator->arena, node->type->name));
        if (hidden)
            diag_note(evaluator->diag, report, expr->prototype_span,
                      "from here on '%s' is the name of %s and not of the node", hidden->name,
                      with_article(evaluator->arena, node->type->name));
        if (prop)
            diag_hint(evaluator->diag, report, "write: %s = %s { ... }", prop->name, node->type->name);
        else if (hidden)
            diag_hint(evaluator->diag, report, "it hides the node '%s': call it otherwise", hidden->name);
        else
            diag_hint(evaluator->diag, report, "name it: %s NAME { ... }", node->type->name);
    } else if (!evaluator->target && !evaluator->discard) {
        node_list_add(evaluator, &evaluator->top, node);
    }
}

void eval_place_value(Evaluator *evaluator, const EvalNode *prototype, Span span)
{
    if (!count_node(evaluator, span)) return;
    Target target = {.type = prototype->type, .base = prototype, .span = span};
    target.transform = affine_identity();
    settle(evaluator, finish_node(evaluator, &target, prototype, NULL), NULL);
}

void eval_missing_overrides(Evaluator *evaluator)
{
    for (size_t i = 0; i < evaluator->n_overrides && !evaluator->stop; i++) {
        const Override *override = &evaluator->overrides[i];
        const NodeType *type = override->used ? NULL : schema_node(evaluator->schema, override->node);
        if (!type || !(type->flags & NODE_SINGLE)) continue;
        Target target = {.type = type, .name = type->name, .span = override->node_span};
        target.transform = affine_identity();
        apply_overrides(evaluator, &target, NULL, false);
        check_required(evaluator, &target);
        evaluator->in_preset = true; /* what the scene says at another place is not the same thing twice */
        settle(evaluator, finish_node(evaluator, &target, NULL, NULL), NULL);
    }
}

/* The name came after the node was made. */
static void name_macro_node(Evaluator *evaluator, EvalNode *node, const char *name)
{
    node->name = name;
    Target renamed = {.type = node->type, .base = node};
    apply_overrides(evaluator, &renamed, name, node->prototype != NULL);
    pack_props(evaluator, &renamed, node);
    if (renamed.shape_changed) node->prototype = NULL;
}

static void report_name_of_many(Evaluator *evaluator, const NodeExpr *expr, const char *macro, size_t n)
{
    Diagnostic *report = eval_report(evaluator, D_WRONG_TYPE, expr->name_span,
                                     "'%s' places %zu nodes: a name can stand for one only", macro, n);
    if (n > 0)
        diag_hint(evaluator->diag, report,
                  "leave it out; or write: let %s = group { ... } around all of them, which %s { } places",
                  expr->name->text, expr->name->text);
}

/* A macro in the form of a node: its properties are the arguments, its transforms apply to all that it places. */
static void macro_node(Evaluator *evaluator, NodeExpr *expr)
{
    Target args = {.def = expr->def, .name = expr->def->name->text, .span = expr->path.span};
    args.args = ARENA_ARRAY(evaluator->arena, Value, expr->def->n_formals);
    args.transform = affine_identity();
    Target *outer = evaluator->target;
    evaluator->target = &args;
    eval_block(evaluator, expr->block);
    Target placed = {.collects = true, .name = args.name};
    evaluator->target = &placed;
    if (!evaluator->stop) eval_call_macro_values(evaluator, expr->def, expr->def_hops, args.args, expr->path.span);
    evaluator->target = outer;
    for (size_t i = 0; i < placed.children.n; i++) {
        EvalNode *node = placed.children.items[i];
        node->transform = affine_compose(&args.transform, &node->transform);
        if (expr->name && placed.children.n == 1) name_macro_node(evaluator, node, expr->name->text);
        place(evaluator, node);
    }
    if (!expr->name) return;
    Value value = value_poison();
    if (placed.children.n == 1)
        value = (Value){.kind = VALUE_NODE, .as.node = placed.children.items[0]};
    else if (!evaluator->stop)
        report_name_of_many(evaluator, expr, args.name, placed.children.n);
    *eval_slot(evaluator, expr->name_slot) = value;
}

void eval_node_stmt(Evaluator *evaluator, Stmt *stmt)
{
    NodeExpr *expr = stmt->as.node;
    if (expr->def) {
        macro_node(evaluator, expr);
        return;
    }
    EvalNode *node = make_node(evaluator, expr, expr->name ? expr->name->text : NULL, false);
    if (expr->name) {
        Value value = {.kind = node ? VALUE_NODE : VALUE_POISON, .as.node = node};
        *eval_slot(evaluator, expr->name_slot) = value;
    }
    if (node) settle(evaluator, node, expr);
}

size_t eval_word_length(const char *name)
{
    size_t length = strlen(name), digits = length;
    while (digits > 0 && name[digits - 1] >= '0' && name[digits - 1] <= '9') digits--;
    bool numbered = digits < length && digits > 2 && name[digits] != '0' && memcmp(name + digits - 2, "__", 2) == 0;
    return numbered ? digits - 2 : length;
}

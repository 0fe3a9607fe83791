/* eval.c - from files to the checked tree: reads a scene and what it imports, parses all of it, resolves names, runs it.
 * All texts are parsed before anything runs, so that all mistakes in the writing come out together.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/eval.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/array.h"
#include "base/file.h"
#include "lang/bare_text.h"
#include "lang/evaluator.h"
#include "lang/parse.h"
#include "lang/resolve.h"

enum {
    MEGABYTE = 1 << 20,
    STACK_BYTES = 6 * 1024 * 1024, /* of the C stack; systems give 8 MiB */
    STEPS_BETWEEN_LOOKS = 4096     /* at memory */
};

/* Reading: what is needed before there is anything to run. */
typedef struct Loader {
    Diag *diag;
    Arena *arena;
    const EvalOptions *options;
    EvalLimits limits;
    SymbolTable symbols;
    File *files;
    uint32_t n_files;
    double unit_m; /* of the scene, 0 until its header is read */
    bool in_frame; /* once the scene runs; what is wrong before is so in every frame */
    const char **paths;
    size_t n_paths, path_capacity;
} Loader;

/* ---- reports ---- */

static const char *call_text(Evaluator *evaluator, const Def *def)
{
    return arena_format(evaluator->arena, "in def '%s', called from", def->name->text);
}

const DiagChain *frame_chain(Evaluator *evaluator, Frame *frame)
{
    if (frame->has_chain) return frame->chain;
    frame->has_chain = true;
    frame->chain = frame->caller ? frame_chain(evaluator, frame->caller) : NULL;
    if (frame->def) {
        DiagChain *link = ARENA_NEW(evaluator->arena, DiagChain);
        *link = (DiagChain){frame->chain, frame->call_span, call_text(evaluator, frame->def)};
        frame->chain = link;
    }
    return frame->chain;
}

static Diagnostic *report_text(Evaluator *evaluator, DiagCode code, Span span, const char *format, va_list args)
    ATTR_PRINTF(4, 0);

static Diagnostic *no_report(Evaluator *evaluator)
{
    evaluator->scratch = (Diagnostic){0};
    return &evaluator->scratch;
}

static Diagnostic *report_text(Evaluator *evaluator, DiagCode code, Span span, const char *format, va_list args)
{
    char text[1024];
    if (evaluator->quiet) return no_report(evaluator);
    vsnprintf(text, sizeof text, format, args);
    evaluator->diag->chain = evaluator->frame ? frame_chain(evaluator, evaluator->frame) : NULL; /* none: after all */
    Diagnostic *report = diag_report(evaluator->diag, code, span, "%s", text);
    evaluator->diag->chain = NULL;
    if (evaluator->diag->n_errors > LIMIT_ERRORS) evaluator->stop = true;
    return report;
}

Diagnostic *eval_report(Evaluator *evaluator, DiagCode code, Span span, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    Diagnostic *report = report_text(evaluator, code, span, format, args);
    va_end(args);
    return report;
}

Diagnostic *eval_error(Evaluator *evaluator, Expr *expr, DiagCode code, const char *format, ...)
{
    if (expr->reported || evaluator->quiet) return no_report(evaluator);
    expr->reported = true;
    va_list args;
    va_start(args, format);
    Diagnostic *report = report_text(evaluator, code, expr->span, format, args);
    va_end(args);
    return report;
}

/* ---- limits ---- */

bool eval_reserve(Evaluator *evaluator, double bytes, Span span)
{
    size_t used = evaluator->arena->total;
    if (evaluator->arena != evaluator->diag->arena) used += evaluator->diag->arena->total;
    if ((double)used + bytes <= (double)evaluator->limits.memory) return true;
    if (!evaluator->stop)
        limit_hint(evaluator->diag,
                   eval_report(evaluator, D_LIMIT, span, "the scene needs more than %.0f MB of memory",
                               (double)evaluator->limits.memory / MEGABYTE),
                   OVER_MEMORY_MB);
    evaluator->stop = true;
    return false;
}

static bool over_limit(Evaluator *evaluator, Span span)
{
    if (!eval_reserve(evaluator, 0, span)) return true;
    evaluator->next_look = evaluator->limits.steps + 1;
    if (evaluator->next_look > evaluator->steps + STEPS_BETWEEN_LOOKS)
        evaluator->next_look = evaluator->steps + STEPS_BETWEEN_LOOKS;
    if (evaluator->steps <= evaluator->limits.steps) return false;
    if (!evaluator->stop)
        limit_hint(evaluator->diag,
                   eval_report(evaluator, D_LIMIT, span, "the scene takes more than %.0f steps",
                               (double)evaluator->limits.steps),
                   OVER_STEPS);
    evaluator->stop = true;
    return true;
}

bool eval_text_fits(Evaluator *evaluator, size_t length, Span span)
{
    if (length <= LIMIT_STRING_BYTES) return true;
    if (!evaluator->stop)
        limit_hint(
            evaluator->diag,
            eval_report(evaluator, D_LIMIT, span, "a string of %zu bytes; the limit is %d", length, LIMIT_STRING_BYTES),
            OVER_STRING_BYTES);
    evaluator->stop = true;
    return false;
}

bool eval_step(Evaluator *evaluator, Span span)
{
    if (UNLIKELY(evaluator->stop)) return false;
    if (LIKELY(++evaluator->steps < evaluator->next_look)) return true;
    return !over_limit(evaluator, span);
}

bool eval_stack_is_deep(Evaluator *evaluator, Span span)
{
    char here;
    uintptr_t at = (uintptr_t)&here, base = evaluator->stack_base;
    if (LIKELY((at < base ? base - at : at - base) < STACK_BYTES)) return false;
    if (!evaluator->stop)
        limit_hint(evaluator->diag, eval_report(evaluator, D_TOO_DEEP, span, "nested too deeply to be evaluated"),
                   OVER_CALLS);
    evaluator->stop = true;
    return true;
}

/* ---- reading ---- */

static EvalLimits limits_of(const EvalOptions *options)
{
    EvalLimits limits = options->limits;
    if (!limits.steps) limits.steps = LIMIT_STEPS;
    if (!limits.nodes) limits.nodes = LIMIT_NODES;
    if (!limits.memory) limits.memory = (uint64_t)LIMIT_MEMORY_MB * MEGABYTE;
    if (!limits.file_bytes || limits.file_bytes > LIMIT_FILE_BYTES) limits.file_bytes = LIMIT_FILE_BYTES;
    if (!limits.files) limits.files = LIMIT_FILES;
    if (!limits.calls) limits.calls = LIMIT_CALLS;
    return limits;
}

static File *new_file(Loader *loader, uint32_t source, const char *path)
{
    File *file = ARENA_NEW(loader->arena, File);
    file->source = source;
    file->path = path;
    file->next = loader->files;
    loader->files = file;
    loader->n_files++;
    if (path && ARRAY_ROOM(loader->paths, loader->path_capacity, loader->n_paths))
        loader->paths[loader->n_paths++] = path;
    return file;
}

/* A whole file into the arena, where the reports can quote it. */
static Status read_text(Loader *loader, const char *path, const char **text, size_t *length, Error *error)
{
    char *bytes;
    Status status = file_read(path, (size_t)loader->limits.file_bytes, &bytes, length, error);
    if (status != STATUS_OK) return status;
    *text = arena_copy_text(loader->arena, bytes, *length);
    free(bytes);
    return STATUS_OK;
}

static void load_imports(Loader *loader, File *file, int depth);

static void check_unit_of(Loader *loader, const File *file)
{
    if (!file->has_unit || file->unit_m == loader->unit_m) return;
    Diagnostic *report = diag_report(loader->diag, D_UNIT_MISMATCH, file->unit_span,
                                     "this file is in another unit than the scene that uses it");
    diag_hint(loader->diag, report, "leave the unit out here, and give each length its own: 5mm");
}

static File *find_loaded(const Loader *loader, const char *path, const char *library_name)
{
    for (File *file = loader->files; file; file = file->next) {
        if (path && file->path && strcmp(path, file->path) == 0) return file;
        const char *name = loader->diag->sources->sources[file->source].name;
        if (!path && !file->path && library_name && strcmp(name, library_name) == 0) return file;
    }
    return NULL;
}

static File *parse_import(Loader *loader, const Stmt *stmt, const char *path, const EvalLibraryFile *library, int depth)
{
    Diag *diag = loader->diag;
    Span span = stmt->as.import.text_span;
    const char *text = library ? library->text : NULL;
    size_t length = library ? library->length : 0;
    Error error;
    Status status = library ? STATUS_OK : read_text(loader, path, &text, &length, &error);
    if (status != STATUS_OK) {
        diag_report(diag, D_FILE_UNREADABLE, span, "%s", error.text);
        return NULL;
    }
    uint32_t source = source_add(diag->sources, library ? library->name : path, path, text, length);
    diag->sources->sources[source].library = library != NULL;
    File *file = new_file(loader, source, path);
    DiagChain *chain = ARENA_NEW(loader->arena, DiagChain);
    *chain = (DiagChain){diag->chain, span, stmt->as.import.include ? "included from" : "used from"};
    const DiagChain *outer = diag->chain;
    file->chain = diag->chain = chain;
    parse_file(file, true, loader->unit_m, diag, &loader->symbols);
    check_unit_of(loader, file);
    load_imports(loader, file, depth + 1);
    diag->chain = outer;
    return file;
}

static void load_import(Loader *loader, Stmt *stmt, int depth)
{
    Diag *diag = loader->diag;
    Span span = stmt->as.import.text_span;
    const EvalLibraryFile *library;
    const char *path = find_import(loader->options, diag, span, stmt->as.import.text, &library);
    if (!path && !library) return;
    File *file = find_loaded(loader, path, stmt->as.import.text);
    if (file && file->state == FILE_OPEN) {
        diag_report(diag, D_IMPORT_CIRCLE, span, "'%s' comes to itself again", stmt->as.import.text);
        return;
    }
    if (!file && depth >= LIMIT_IMPORT_DEPTH) {
        limit_hint(diag,
                   diag_report(diag, D_TOO_DEEP, span, "files are nested deeper than %d levels", LIMIT_IMPORT_DEPTH),
                   OVER_IMPORT_DEPTH);
        return;
    }
    if (!file && loader->n_files >= loader->limits.files) {
        limit_hint(diag, diag_report(diag, D_LIMIT, span, "the scene reads more than %u files", loader->limits.files),
                   OVER_FILES);
        return;
    }
    stmt->as.import.file = file ? file : parse_import(loader, stmt, path, library, depth);
}

static void load_imports(Loader *loader, File *file, int depth)
{
    file->state = FILE_OPEN;
    for (uint32_t i = 0; i < file->n_imports; i++) load_import(loader, file->imports[i], depth);
    file->state = FILE_NEW;
}

static File *load_prelude(Loader *loader)
{
    const char *text = loader->options->schema->prelude;
    if (!text) return NULL;
    File *file = new_file(loader, source_add(loader->diag->sources, "prelude", NULL, text, strlen(text)), NULL);
    parse_file(file, false, loader->unit_m, loader->diag, &loader->symbols);
    return file;
}

/* What stands at byte begin of a text of the command line; what is before it is blanked out, so that places stay right. */
static Expr *parse_expression_behind(Loader *loader, uint32_t source, const char *text, size_t begin)
{
    SourceSet *sources = loader->diag->sources;
    char *expression = arena_copy_text(loader->arena, text, strlen(text));
    memset(expression, ' ', begin);
    sources->sources[source].text = expression;
    Expr *expr = parse_expression(source, loader->unit_m, loader->diag, &loader->symbols);
    sources->sources[source].text = text;
    return expr;
}

/* How much of the text is no blank at its end. */
static size_t without_blanks(const char *text, size_t length)
{
    while (length > 0 && strchr(" \t", text[length - 1])) length--;
    return length;
}

/* "name=expression" */
static bool parse_define(Loader *loader, const char *text, Define *define)
{
    Diag *diag = loader->diag;
    const char *equal = strchr(text, '=');
    size_t length = without_blanks(text, equal ? (size_t)(equal - text) : strlen(text));
    uint32_t source = source_add(diag->sources, "-D", NULL, text, strlen(text));
    *define = (Define){.name = arena_copy_text(loader->arena, text, length), .span = {source, 0, (uint32_t)length}};
    if (!equal) {
        Diagnostic *report = diag_report(diag, D_SYNTAX, define->span, "-D takes NAME=VALUE");
        diag_hint(diag, report, "write -D %s=VALUE", define->name);
        return false;
    }
    define->expr = parse_expression_behind(loader, source, text, (size_t)(equal - text) + 1);
    return true;
}

/* "node.property=expression" */
static bool parse_override(Loader *loader, const char *text, Override *override)
{
    Diag *diag = loader->diag;
    size_t length = strlen(text), equal = strcspn(text, "="), end = without_blanks(text, equal), dot = equal;
    uint32_t source = source_add(diag->sources, "--set", NULL, text, length);
    for (size_t i = 0; i < equal; i++)
        if (text[i] == '.') dot = i; /* the last one: properties have no dots */
    *override = (Override){.node = arena_copy_text(loader->arena, text, dot),
                           .node_span = {source, 0, (uint32_t)dot},
                           .prop_span = {source, (uint32_t)dot + 1, (uint32_t)end}};
    if (equal == length || dot == equal || dot == 0 || dot + 1 >= end) {
        Span all = {source, 0, (uint32_t)length};
        Diagnostic *report = diag_report(diag, D_SYNTAX, all, "--set takes NODE.PROPERTY=VALUE");
        if (equal > 0 && equal < length && dot == equal)
            diag_hint(diag, report, "for instance --set camera.fov=30; a param of the scene is set by -D %s", text);
        else
            diag_hint(diag, report, "for instance --set camera.fov=30");
        return false;
    }
    override->prop = arena_copy_text(loader->arena, text + dot + 1, end - dot - 1);
    override->expr = parse_expression_behind(loader, source, text, equal + 1);
    return true;
}

/* ---- running ---- */

static void set_predeclared(Evaluator *evaluator)
{
    const EvalOptions *options = evaluator->options;
    double frames = options->frames > 0 ? options->frames : 1, frame = options->frames > 0 ? options->frame : 1;
    Value *globals = evaluator->globals;
    globals[PREDECLARED_CLOCK] = value_number(options->clock);
    globals[PREDECLARED_FRAME] = value_number(frame);
    globals[PREDECLARED_FRAMES] = value_number(frames);
    globals[PREDECLARED_TIME] = value_number(options->time);
    globals[PREDECLARED_X] = value_vector3(1, 0, 0);
    globals[PREDECLARED_Y] = value_vector3(0, 1, 0);
    globals[PREDECLARED_Z] = value_vector3(0, 0, 1);
    globals[PREDECLARED_PI] = value_number(MEN_PI);
}

static void run_defines(Evaluator *evaluator)
{
    for (size_t i = 0; i < evaluator->n_defines; i++) {
        Define *define = &evaluator->defines[i];
        if (define->expr->kind == EXPR_NAME)
            define->value = value_none(); /* a bare word: the parameter decides what it is */
        else
            eval_value(evaluator, define->expr, &define->value);
    }
}

static void report_unused_defines(Evaluator *evaluator)
{
    const char **names = ARENA_ARRAY(evaluator->arena, const char *, evaluator->n_params);
    for (size_t i = 0; i < evaluator->n_params; i++) names[i] = evaluator->params[i].name;
    for (size_t i = 0; i < evaluator->n_defines && !evaluator->stop; i++) {
        const Define *define = &evaluator->defines[i];
        if (define->used) continue;
        Diagnostic *report =
            eval_report(evaluator, D_UNKNOWN_PARAM, define->span, "the scene has no parameter '%s'", define->name);
        if (strcmp(define->name, "clock") == 0 || strcmp(define->name, "frame") == 0)
            diag_hint(evaluator->diag, report, "that of the frame is set by --%s", define->name);
        else
            diag_suggest_or_list(evaluator->diag, report, define->name, names, evaluator->n_params, "parameters");
    }
}

/* Nodes that --set can name: the types that are there, and what the scene declares at its top. Where two are near, one that
 * the scene declares is meant. */
static void report_unused_overrides(Evaluator *evaluator, const File *scene)
{
    const char **names = ARENA_ARRAY(evaluator->arena, const char *, evaluator->top.n + scene->n_exports);
    size_t n = 0, n_types = evaluator->top.n;
    for (; n < n_types; n++) names[n] = evaluator->top.items[n]->type->name;
    for (uint32_t i = 0; i < scene->n_exports; i++) {
        const Binding *binding = scene->exports[i].binding;
        if (binding->kind == BINDING_SLOT && evaluator->globals[binding->index].kind == VALUE_NODE)
            names[n++] = binding->symbol->text;
    }
    for (size_t i = 0; i < evaluator->n_overrides && !evaluator->stop; i++) {
        const Override *override = &evaluator->overrides[i];
        if (override->used) continue;
        Diagnostic *report =
            eval_report(evaluator, D_UNKNOWN_NODE, override->node_span, "the scene has no node '%s'", override->node);
        diag_suggest(evaluator->diag, report, override->node, names, n);
        if (!report->hint) diag_suggest(evaluator->diag, report, override->node, names + n_types, n - n_types);
    }
}

static void run_preset(Evaluator *evaluator)
{
    const char *wanted = evaluator->options->preset;
    if (!wanted || evaluator->stop) return;
    const char **names = ARENA_ARRAY(evaluator->arena, const char *, evaluator->n_presets);
    for (size_t i = 0; i < evaluator->n_presets; i++) {
        const NodeExpr *node = evaluator->presets[i].node;
        names[i] = node->name->text;
        if (strcmp(names[i], wanted) != 0) continue;
        evaluator->in_preset = true;
        eval_block(evaluator, node->block);
        return;
    }
    Diagnostic *report = diag_report_nowhere(evaluator->diag, D_UNKNOWN_PRESET, "the scene has no preset '%s'", wanted);
    diag_suggest_or_list(evaluator->diag, report, wanted, names, evaluator->n_presets, "presets");
}

static void run_scene(Evaluator *evaluator, File *prelude, File *scene)
{
    char here;
    Frame frame = {.has_chain = true};
    evaluator->stack_base = (uintptr_t)&here;
    evaluator->frame = &frame;
    set_predeclared(evaluator);
    if (prelude) eval_block(evaluator, prelude->block);
    run_defines(evaluator);
    eval_block(evaluator, scene->block);
    run_preset(evaluator);
    eval_missing_overrides(evaluator);
    report_unused_defines(evaluator);
    report_unused_overrides(evaluator, scene);
    evaluator->frame = NULL;
}

static void give_result(const Loader *loader, Evaluator *evaluator, const File *scene, EvalResult *result)
{
    Arena *arena = evaluator->arena;
    result->nodes = evaluator->top.items;
    result->n_nodes = evaluator->top.n;
    result->settings = ARENA_ARRAY(arena, EvalNode *, evaluator->top.n);
    for (size_t i = 0; i < evaluator->top.n; i++)
        if (evaluator->top.items[i]->type->flags & NODE_SINGLE)
            result->settings[result->n_settings++] = evaluator->top.items[i];
    result->unit_m = scene->unit_m;
    result->n_params = evaluator->n_params;
    result->params = ARENA_ARRAY(arena, EvalParam, evaluator->n_params);
    if (evaluator->n_params) memcpy(result->params, evaluator->params, evaluator->n_params * sizeof(EvalParam));
    const char **files = ARENA_ARRAY(arena, const char *, loader->n_paths);
    if (loader->n_paths) memcpy(files, loader->paths, loader->n_paths * sizeof *files);
    result->files = files;
    result->n_files = loader->n_paths;
    result->steps = evaluator->steps;
    result->printed = evaluator->printed;
}

/* Everything that is not the arena's. A jump out of the arena when memory ends leaks it, once, before the end. */
static void evaluator_clear(Evaluator *evaluator)
{
    if (evaluator->geometry) evaluator->options->geometry->close(evaluator->geometry);
    free(evaluator->params);
    free(evaluator->presets);
}

static Status evaluate(Loader *loader, File *prelude, File *scene, Define *defines, Override *overrides,
                       EvalResult *result)
{
    Diag *diag = loader->diag;
    const EvalOptions *options = loader->options;
    Resolver resolver;
    resolver_init(&resolver, diag, &loader->symbols, options->schema, options->srgb_to_working);
    resolver.library = options->library;
    if (prelude) resolve_prelude(&resolver, prelude);
    for (size_t i = 0; i < options->n_defines; i++) resolve_define(&resolver, defines[i].expr);
    resolver.late = ARENA_ARRAY(loader->arena, Expr *, options->n_overrides);
    for (; resolver.n_late < options->n_overrides; resolver.n_late++)
        resolver.late[resolver.n_late] = overrides[resolver.n_late].expr;
    resolve_file(&resolver, scene, true);
    result->is_still = !resolver_uses(&resolver, PREDECLARED_CLOCK) && !resolver_uses(&resolver, PREDECLARED_FRAME) &&
                       !resolver_uses(&resolver, PREDECLARED_TIME);
    result->passed_by = resolver.passed_by;
    Evaluator evaluator = {.diag = diag,
                           .arena = options->arena ? options->arena : loader->arena,
                           .options = options,
                           .schema = options->schema,
                           .limits = loader->limits,
                           .srgb_to_working = resolver.srgb_to_working,
                           .unit_m = scene->unit_m,
                           .defines = defines,
                           .n_defines = options->n_defines,
                           .overrides = overrides,
                           .n_overrides = options->n_overrides};
    evaluator.globals = ARENA_ARRAY(loader->arena, Value, resolver.n_globals);
    evaluator.n_globals = resolver.n_globals;
    evaluator.singles = ARENA_ARRAY(loader->arena, EvalNode *, options->schema->n_nodes);
    evaluator.single_sources = ARENA_ARRAY(loader->arena, uint32_t, options->schema->n_nodes);
    diag->in_frame = loader->in_frame;
    run_scene(&evaluator, prelude, scene);
    give_result(loader, &evaluator, scene, result);
    evaluator_clear(&evaluator);
    if (diag->n_errors == 0) return STATUS_OK;
    result->nodes = NULL;
    result->n_nodes = 0;
    return STATUS_SCENE;
}

static Status load_and_evaluate(Loader *loader, const char *name, const char *path, const char *text, size_t length,
                                EvalResult *result)
{
    Diag *diag = loader->diag;
    const EvalOptions *options = loader->options;
    symbol_table_init(&loader->symbols, loader->arena);
    File *scene = new_file(loader, source_add(diag->sources, name, path, text, length), path);
    parse_file(scene, true, 0, diag, &loader->symbols);
    loader->unit_m = scene->unit_m;
    load_imports(loader, scene, 0);
    File *prelude = load_prelude(loader);
    Define *defines = ARENA_ARRAY(loader->arena, Define, options->n_defines);
    for (size_t i = 0; i < options->n_defines; i++) parse_define(loader, options->defines[i], &defines[i]);
    Override *overrides = ARENA_ARRAY(loader->arena, Override, options->n_overrides);
    for (size_t i = 0; i < options->n_overrides; i++) parse_override(loader, options->overrides[i], &overrides[i]);
    result->unit_m = scene->unit_m;
    result->has_unit = scene->has_unit;
    Status status = diag->n_errors ? STATUS_SCENE : evaluate(loader, prelude, scene, defines, overrides, result);
    for (size_t i = 0; i < options->n_defines; i++) bare_text_of_define(diag, scene, &defines[i]);
    for (size_t i = 0; i < options->n_overrides; i++) bare_text_of_override(diag, options->schema, &overrides[i]);
    return status;
}

static Loader new_loader(const EvalOptions *options, Diag *diag, EvalResult *result)
{
    *result = (EvalResult){0};
    Loader loader = {.diag = diag, .arena = diag->arena, .options = options, .limits = limits_of(options)};
    loader.in_frame = diag->in_frame;
    diag->in_frame = false;
    loader.limits.memory += diag->arena->total; /* what is there already is not this scene's */
    if (options->arena) loader.limits.memory += options->arena->total;
    return loader;
}

Status eval_text(const char *name, const char *text, size_t length, const EvalOptions *options, Diag *diag,
                 EvalResult *result, Error *error)
{
    Loader loader = new_loader(options, diag, result);
    if (length > loader.limits.file_bytes)
        return fail(error, STATUS_INPUT, "'%s' has %zu bytes; the limit is %.0f", name, length,
                    (double)loader.limits.file_bytes);
    Status status = load_and_evaluate(&loader, name, NULL, text, length, result);
    free(loader.paths);
    return status == STATUS_SCENE ? fail(error, status, "the scene has errors") : status;
}

Status eval_scene(const char *path, const EvalOptions *options, Diag *diag, EvalResult *result, Error *error)
{
    Loader loader = new_loader(options, diag, result);
    const char *text;
    size_t length;
    bool standard_input = strcmp(path, "-") == 0;
    TRY(read_text(&loader, path, &text, &length, error));
    Status status = load_and_evaluate(&loader, standard_input ? "<stdin>" : path, standard_input ? NULL : path, text,
                                      length, result);
    free(loader.paths);
    return status == STATUS_SCENE ? fail(error, status, "the scene has errors") : status;
}

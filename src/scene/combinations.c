/* combinations.c - what combinations of objects enclose, and those of which nothing is left: both have no closed form, and
 * are found along evenly spread lines.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/combinations.h"

#include <stdlib.h>

#include "scene/lines.h"

/* ---- volumes ---- */

/* The measuring of a combination, in tasks that are always the same. */
enum {
    MEASURE_LINES = 6000 /* of each direction; the error is about 1e-3 of the volume for plain shapes */,
    MEASURE_TASKS = 8
};
typedef struct Measure {
    const CompiledScene *compiled;
    Probe *probes; /* of each worker */
    unsigned n_probes;
    uint32_t hull;
    double volume[LINE_DIRECTIONS * MEASURE_TASKS];
    Box3 found[LINE_DIRECTIONS *
               MEASURE_TASKS]; /* around what lines found of it, and as far as these are from each other */
} Measure;

static Box3 add_around(Box3 box, const Line *line, double t, double margin)
{
    Vec3 place = vec3_along(line->start, t, vec3_from_f(line->direction)), more = vec3(margin, margin, margin);
    return box3_union(box, (Box3){vec3_sub(place, more), vec3_add(place, more)});
}

static void task_of_measure(void *context, uint32_t number, unsigned worker)
{
    Measure *measure = context;
    Probe *probe = &measure->probes[worker];
    LineSet set;
    Line line;
    line_set_begin(&set, measure->compiled->hull_bounds[measure->hull], (int)(number / MEASURE_TASKS), MEASURE_LINES,
                   measure->hull);
    uint32_t n = line_set_size(&set), part = number % MEASURE_TASKS;
    uint32_t begin = n * part / MEASURE_TASKS, end = n * (part + 1) / MEASURE_TASKS;
    double volume = 0;
    Box3 found = box3_empty();
    line_set_skip(&set, begin);
    for (uint32_t i = begin; i < end && line_set_next(&set, &line); i++) {
        probe_surfaces(probe, measure->compiled, &line, SCENE_NONE);
        probe_intervals(probe, measure->compiled, &line);
        double apart = sqrt(line.area);
        for (uint32_t k = probe->first[measure->hull]; k != INTERVAL_NONE; k = probe->intervals[k].next) {
            double enter = probe->intervals[k].begin, leave = probe->intervals[k].end;
            volume += line.area * (leave - enter) / LINE_DIRECTIONS;
            found = add_around(add_around(found, &line, enter, apart), &line, leave, apart);
        }
    }
    measure->volume[number] = volume;
    measure->found[number] = found;
}

static double measure_combination(Measure *measure, Pool *pool, uint32_t hull, Box3 *bounds)
{
    double volume = 0;
    Box3 found = box3_empty();
    measure->hull = hull;
    pool_run(pool, COUNT_OF(measure->volume), task_of_measure, measure);
    for (size_t i = 0; i < COUNT_OF(measure->volume); i++) {
        volume += measure->volume[i];
        if (!box3_is_empty(measure->found[i])) found = box3_union(found, measure->found[i]);
    }
    if (!box3_is_empty(found)) *bounds = box3_intersection(*bounds, found);
    return volume;
}

static Status measure_init(Measure *measure, const CompiledScene *compiled, unsigned n_workers, Error *error)
{
    *measure = (Measure){.compiled = compiled, .probes = calloc(n_workers, sizeof *measure->probes)};
    if (!measure->probes) return fail_memory(error, n_workers * sizeof *measure->probes, "the volumes of combinations");
    while (measure->n_probes < n_workers) TRY(probe_init(&measure->probes[measure->n_probes++], compiled, error));
    return STATUS_OK;
}

/* Says whether memory lasted. */
static bool measure_clear(Measure *measure)
{
    bool lasted = true;
    for (unsigned i = 0; i < measure->n_probes; i++) {
        lasted = lasted && !measure->probes[i].out_of_memory;
        probe_clear(&measure->probes[i]);
    }
    free(measure->probes);
    return lasted;
}

/* The mesh that a combination is all layers of, or SCENE_NONE. */
static uint32_t layered_mesh(const Scene *scene, const SceneTree *tree)
{
    const NestPart *root = &scene->parts[tree->root];
    const SceneObject *first = root->n_children ? &scene->objects[scene->operands[root->begin]] : NULL;
    if (!first || first->shape == SCENE_NONE || scene->shapes[first->shape].layer_of == SCENE_NONE) return SCENE_NONE;
    uint32_t mesh = scene->shapes[first->shape].layer_of;
    bool whole = root->operation == NEST_UNION && root->n_children == scene->shapes[mesh].parts.n_layers &&
                 root->end - root->begin == root->n_children;
    for (uint32_t i = root->begin; whole && i < root->end; i++)
        whole = scene->shapes[scene->objects[scene->operands[i]].shape].layer_of == mesh;
    return whole ? mesh : SCENE_NONE;
}

/* What a combination encloses has no closed form: it is measured along evenly spread lines; once for all that are the
 * same mesh. */
Status combinations_measure(CompiledScene *compiled, Pool *pool, Error *error)
{
    const Scene *scene = compiled->scene;
    Measure measure;
    double *of_mesh = calloc(scene->n_shapes + 1U, sizeof *of_mesh); /* in the mesh's own frame; 0: not known */
    if (!of_mesh) return fail_memory(error, scene->n_shapes * sizeof *of_mesh, "the volumes of combinations");
    Status status = measure_init(&measure, compiled, pool_threads(pool), error);
    for (uint32_t t = 0; status == STATUS_OK && t < compiled->csg.n_trees; t++) {
        uint32_t hull = compiled->csg.trees[t].hull, mesh = layered_mesh(scene, &scene->trees[t]);
        if (hull == NEST_OPAQUE || compiled->unbounded[hull] || box3_is_empty(compiled->hull_bounds[hull])) continue;
        uint32_t first = scene->operands[scene->parts[scene->trees[t].root].begin];
        double scale = fabs(affine_determinant(&scene->objects[first].to_world));
        double volume = mesh == SCENE_NONE ? 0 : of_mesh[mesh] * scale;
        if (!(volume > 0)) volume = measure_combination(&measure, pool, hull, &compiled->found_bounds[hull]);
        if (mesh != SCENE_NONE) of_mesh[mesh] = volume / scale;
        compiled->hulls[hull].volume = volume;
    }
    if (!measure_clear(&measure) && status == STATUS_OK) status = fail_memory(error, 0, "the volumes of combinations");
    free(of_mesh);
    return status;
}

/* ---- what is left ---- */

/* Looking for the inside of an opaque combination, which is no hull. */
typedef struct Search {
    const CompiledScene *compiled;
    uint32_t tree;
    HitList hits;
    NestList held; /* operands that hold the place on the line */
    int32_t *net;  /* of each operand, how often the line leaves it less how often it enters it: 0 between lines */
} Search;

static bool is_operand(const Search *search, uint32_t object)
{
    uint32_t pass = search->compiled->hull_of_object[object];
    return pass != SCENE_NONE && pass >= search->compiled->n_hulls &&
           nest_csg_tree(&search->compiled->csg, pass) == search->tree;
}

/* The operands that the line begins in: those that it leaves more often than it enters, and halves of space. */
static void hold_start(Search *search, const Line *line)
{
    const CompiledScene *compiled = search->compiled;
    const NestCsg *csg = &compiled->csg;
    search->held.n = 0;
    for (uint32_t i = 0; i < compiled->n_planes; i++)
        if (is_operand(search, compiled->planes[i]) &&
            rtc_below_plane(compiled->rtc, compiled->planes[i], line->start, line_time(compiled, line)))
            nest_csg_pass(csg, &search->held, compiled->hull_of_object[compiled->planes[i]], true);
    for (size_t i = 0; i < search->hits.n; i++) {
        const Hit *hit = &search->hits.items[i];
        if (!hit_repeats(&search->hits, i) && !rtc_is_plane(compiled->rtc, hit->object))
            search->net[compiled->hull_of_object[hit->object] - csg->first_operand] += hit->entering ? -1 : 1;
    }
    for (size_t i = 0; i < search->hits.n; i++) {
        uint32_t operand = compiled->hull_of_object[search->hits.items[i].object];
        int32_t *net = &search->net[operand - csg->first_operand];
        if (*net > 0) nest_csg_pass(csg, &search->held, operand, true);
        *net = 0;
    }
}

/* Whether any of the line, from its start on, is inside of the combination. */
static bool meets_inside(Search *search, const Line *line)
{
    const CompiledScene *compiled = search->compiled;
    HitList *hits = &search->hits;
    Ray ray = ray_make(line->start, line->direction);
    ray.time = line_time(compiled, line);
    rtc_all(compiled->rtc, &ray, false, hits);
    size_t kept = 0;
    for (size_t i = 0; i < hits->n; i++)
        if (is_operand(search, hits->items[i].object)) hits->items[kept++] = hits->items[i];
    hits->n = kept;
    hold_start(search, line);
    bool inside = nest_csg_holds(&compiled->csg, search->tree, &search->held);
    double begin = 0;
    for (size_t i = 0; i < hits->n; i++) {
        const Hit *hit = &hits->items[i];
        if (inside && (hit->t - begin) * fabs(hit->cos_normal) > hit->rounding) return true;
        nest_csg_pass(&compiled->csg, &search->held, compiled->hull_of_object[hit->object], hit->entering);
        bool still = nest_csg_holds(&compiled->csg, search->tree, &search->held);
        if (still && !inside) begin = hit->t;
        inside = still;
    }
    return inside;
}

/* Few lines find what is plain, more of them what is thin. */
static bool is_left(Search *search, Box3 box)
{
    static const uint32_t n_lines[] = {4, 64, 1000, MEASURE_LINES};
    if (box3_is_empty(box)) return false;
    for (size_t i = 0; i < COUNT_OF(n_lines); i++)
        for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
            LineSet set;
            Line line;
            line_set_begin(&set, box, direction, n_lines[i], search->tree);
            while (line_set_next(&set, &line))
                if (meets_inside(search, &line)) return true;
        }
    return false;
}

static void report_empty(const SceneObject *object, Diag *diag)
{
    diag_hint(diag, diag_report(diag, D_NOTHING_LEFT, object->span, "nothing is left of %s", object->name),
              "do its operands meet, and is not all of it taken away?");
}

Status combinations_report_empty(const CompiledScene *compiled, Diag *diag, Error *error)
{
    const NestCsg *csg = &compiled->csg;
    Search search = {.compiled = compiled, .net = calloc(csg->n_operands, sizeof *search.net)};
    nest_list_init(&search.held);
    bool enough = search.net && nest_list_reserve(&search.held, csg->n_operands) == STATUS_OK;
    for (uint32_t t = 0; enough && t < csg->n_trees; t++) {
        const SceneObject *object = &compiled->scene->objects[compiled->scene->trees[t].object];
        uint32_t hull = csg->trees[t].hull;
        search.tree = t;
        if (hull != NEST_OPAQUE) {
            if (!(compiled->hulls[hull].volume > 0)) report_empty(object, diag);
            continue;
        }
        Box3 box = scene_object_bounds(compiled->scene, object, NULL);
        if (!box3_is_unbounded(box) && !is_left(&search, box)) report_empty(object, diag);
        enough = !search.hits.out_of_memory;
    }
    free(search.net);
    nest_list_clear(&search.held);
    hit_list_clear(&search.hits);
    return enough ? STATUS_OK : fail_memory(error, csg->n_operands * sizeof(int32_t), "what is left of combinations");
}

/* build_phase.c - phase functions of media: lobes in closed form, spheres of many sizes, and measured ones.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/angle.h"
#include "optics/spheres.h"
#include "scene/build_parts.h"

static bool is_within(Builder *b, const EvalProp *prop, const char *what, double value, double least, double most)
{
    if (value >= least && value <= most) return true;
    diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span, "%s of %s() is %g, outside of %g .. %g", what,
                prop->as.spectrum.term->type->name, value, least, most);
    return false;
}

/* ---- lobes ---- */

static Phase lobe_of(Builder *b, const EvalProp *prop)
{
    const char *name = prop->as.spectrum.term->type->name;
    const double *args = prop->as.spectrum.term->args, most = PHASE_MOST_G;
    if (strcmp(name, "rayleigh") == 0) return phase_draine(0, 1);
    if (strcmp(name, "hg") == 0) {
        if (is_within(b, prop, "the mean cosine", args[0], -most, most)) return phase_hg(args[0]);
    } else if (strcmp(name, "draine") == 0) {
        if (is_within(b, prop, "g", args[0], -most, most) && is_within(b, prop, "alpha", args[1], 0, 1e6))
            return phase_draine(args[0], args[1]);
    } else if (strcmp(name, "two_hg") == 0) {
        if (is_within(b, prop, "g1", args[0], -most, most) && is_within(b, prop, "g2", args[1], -most, most) &&
            is_within(b, prop, "the weight", args[2], 0, 1))
            return phase_two_hg(args[0], args[1], args[2]);
    } else {
        diag_report(b->diag, D_WRONG_TYPE, prop->span,
                    "'phase' is hg(g), draine(g, alpha), two_hg(g1, g2, weight), rayleigh(), droplets(diameter), "
                    "bubbles(diameter), spheres(diameter, ior) or measured(rows), not %s()",
                    name);
    }
    return phase_isotropic();
}

/* ---- spheres ---- */

static const double least_um = 0.1, most_um = 5000;

static bool is_diameter(Builder *b, const EvalProp *prop, double micrometres)
{
    double of_length = micrometres * b->result.unit_m * 1e6; /* were it a length, which is in the scene's unit */
    const char *name = prop->as.spectrum.term->type->name;
    if (!(micrometres < least_um && of_length >= 0.999 * least_um && of_length <= 1.001 * most_um))
        return is_within(b, prop, "the diameter in micrometres", micrometres, least_um, most_um);
    Diagnostic *report = diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span,
                                     "the diameter of %s() is a number of micrometres, without a unit", name);
    const EvalTerm *term = prop->as.spectrum.term;
    if (term->n_args > 1)
        diag_hint(b->diag, report, "write: %s(%g, ...)", name, of_length);
    else
        diag_hint(b->diag, report, "write: %s(%g)", name, of_length);
    return false;
}

/* The index around the spheres: of the medium that they are in, where it has one of its own. */
static double index_around(const SceneMedium *medium, bool bubbles, double nm)
{
    if (!medium->mixes) return (double)spectrum_at_one(&medium->ior, (float)nm);
    return bubbles ? spheres_water_index(nm) : 1;
}

static bool is_seen(Builder *b, const EvalProp *prop, const SceneMedium *medium, const Spheres *spheres)
{
    for (uint32_t k = 0; k < PHASE_TABLE_WAVES; k++) {
        double index = spheres->index[k], inside = index * spheres->around[k];
        if (index >= SPHERES_LEAST_INDEX && index <= SPHERES_MOST_INDEX && fabs(index - 1) >= SPHERES_LEAST_CONTRAST)
            continue;
        Diagnostic *report = diag_report(b->diag, D_BAD_PHASE, prop->span,
                                         fabs(index - 1) < SPHERES_LEAST_CONTRAST
                                             ? "spheres of an index of %g within one of %g hardly scatter, at %.0f nm"
                                             : "spheres of an index of %g within one of %g are too unlike, at %.0f nm",
                                         inside, spheres->around[k], phase_table_nm(k));
        if (medium->mixes)
            diag_hint(b->diag, report, "around them is air, as the medium mixes");
        else
            diag_hint(b->diag, report, "around them is the medium's own ior; mixes = true puts them into the air");
        return false;
    }
    return true;
}

/* Equal spheres are computed once; for a moment of which only the differences are asked, not at all. */
static const PhaseTable *table_of(Builder *b, const Spheres *spheres)
{
    if (b->only_shapes || build_is_later(b)) return spheres_stand_in(b->arena, spheres);
    for (uint32_t i = 0; i < b->n_phase_tables; i++)
        if (memcmp(b->phase_tables[i]->recipe, spheres, sizeof *spheres) == 0) return b->phase_tables[i];
    const PhaseTable *table = spheres_table(b->arena, spheres, b->options->pool);
    if (!table) arena_fail(b->arena);
    ARENA_ROOM(b->arena, b->phase_tables, b->phase_tables_capacity, b->n_phase_tables, 4U);
    return b->phase_tables[b->n_phase_tables++] = table;
}

static Phase spheres_of(Builder *b, const EvalProp *prop, const SceneMedium *medium)
{
    const EvalTerm *term = prop->as.spectrum.term;
    bool bubbles = strcmp(term->type->name, "bubbles") == 0, of_any = strcmp(term->type->name, "spheres") == 0;
    unsigned n_fixed = of_any ? 2 : 1;
    Spheres spheres = {.diameter_um = term->args[0],
                       .width = term->n_args > n_fixed ? term->args[n_fixed] : SPHERES_WIDTH};
    if (!is_diameter(b, prop, spheres.diameter_um) ||
        (of_any && !is_within(b, prop, "the index", term->args[1], 0.5, 4)) ||
        !is_within(b, prop, "the relative width", spheres.width, SPHERES_LEAST_WIDTH, SPHERES_MOST_WIDTH))
        return phase_isotropic();
    for (uint32_t k = 0; k < PHASE_TABLE_WAVES; k++) {
        double nm = phase_table_nm(k), inside = of_any ? term->args[1] : bubbles ? 1 : spheres_water_index(nm);
        spheres.around[k] = index_around(medium, bubbles, nm);
        spheres.index[k] = inside / spheres.around[k];
    }
    if (!is_seen(b, prop, medium, &spheres)) return phase_isotropic();
    return phase_of_table(table_of(b, &spheres));
}

/* ---- measured ---- */

typedef struct Measured {
    const double *pairs; /* degrees, value */
    size_t n;
} Measured;

static bool check_measured(Builder *b, const EvalProp *prop, const Measured *rows)
{
    Diag *diag = b->diag;
    double most = 0;
    Diagnostic *report = NULL;
    for (size_t i = 0; i < rows->n && !report; i++) {
        const double *pair = rows->pairs + 2 * i;
        if (!(pair[0] >= 0 && pair[0] <= 180))
            report = diag_report(diag, D_BAD_PHASE, prop->span, "%g degrees is no angle of 0 .. 180 (row %zu of %zu)",
                                 pair[0], i + 1, rows->n);
        else if (i > 0 && !(pair[0] > pair[-2]))
            report = diag_report(diag, D_BAD_PHASE, prop->span, "%g degrees does not come after %g (row %zu of %zu)",
                                 pair[0], pair[-2], i + 1, rows->n);
        else if (!(pair[1] >= 0 && pair[1] <= 1e12))
            report = diag_report(diag, D_BAD_PHASE, prop->span, "a value of %g at %g degrees is outside of 0 .. 1e12",
                                 pair[1], pair[0]);
        most = fmax(most, pair[1]);
    }
    if (!report && rows->n < 2)
        report =
            diag_report(diag, D_BAD_PHASE, prop->span, "a phase function needs two rows or more, not %zu", rows->n);
    if (!report && !(most > 0))
        report = diag_report(diag, D_BAD_PHASE, prop->span, "a phase function of 0 everywhere scatters nowhere");
    if (!report && rows->n > 20000)
        report = diag_report(diag, D_BAD_PHASE, prop->span, "%zu rows are more than the 20000 that are kept", rows->n);
    if (report) diag_hint(diag, report, "a row is an angle in degrees, 0 straight on, and how much goes there: <0, 9>");
    return !report;
}

static double measured_at(const Measured *rows, size_t *row, double degrees)
{
    while (*row + 2 < rows->n && rows->pairs[2 * (*row + 1)] <= degrees) ++*row;
    const double *pair = rows->pairs + 2 * *row;
    double along = (degrees - pair[0]) / (pair[2] - pair[0]);
    return pair[1] + fmin(fmax(along, 0), 1) * (pair[3] - pair[1]);
}

/* Linear in the angle, by steps of a quarter of a degree and less. */
static Phase measured_of(Builder *b, const EvalProp *prop)
{
    enum { STEPS = 720 };
    Measured rows;
    if (!build_pairs(b, prop, D_BAD_PHASE, "a row is an angle in degrees and a value", &rows.pairs, &rows.n) ||
        !check_measured(b, prop, &rows))
        return phase_isotropic();
    PhaseTable *table = phase_table_new(b->arena, (uint32_t)(STEPS + 1 + rows.n), 1);
    uint32_t n = 0;
    size_t next = 0, row = 0;
    for (int step = 0; step <= STEPS;) {
        double degrees = 180.0 * step / STEPS, s;
        if (next < rows.n && rows.pairs[2 * next] <= degrees)
            degrees = rows.pairs[2 * next++];
        else
            step++;
        s = pow(sin(0.5 * degrees * MEN_DEGREE), 2);
        if (n > 0 && !((float)s > table->nodes[n - 1])) continue;
        table->nodes[n] = (float)s;
        table->values[n++] = (float)measured_at(&rows, &row, degrees);
    }
    table->nodes[n - 1] = 1;
    table->n_nodes = n;
    phase_table_finish(table);
    table->recipe = rows.pairs;
    table->recipe_size = 2 * rows.n * sizeof *rows.pairs;
    return phase_of_table(table);
}

void build_phase(Builder *b, const EvalProp *prop, SceneMedium *medium)
{
    static const char *const of_spheres[] = {"droplets", "bubbles", "spheres"};
    const EvalTerm *term = prop->as.spectrum.term;
    for (size_t i = 0; i < COUNT_OF(of_spheres); i++) {
        if (strcmp(term->type->name, of_spheres[i]) != 0) continue;
        medium->phase = spheres_of(b, prop, medium);
        return;
    }
    medium->phase = strcmp(term->type->name, "measured") == 0 ? measured_of(b, prop) : lobe_of(b, prop);
}

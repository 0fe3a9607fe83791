/* guide_keep.c - a search for caustics as parts of bytes, and made of these again.
 * What is read may have been damaged: whatever leads from one place to another is looked at before it is used.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/guide_keep.h"

#include <stdlib.h>
#include <string.h>

/* The parts, in order. Counts of the guide and of the survey stand before what they count. */
enum { PART_FACTS, PART_LANDED, PART_COUNTS, PART_NODES, PART_CELLS, PART_FOURS, PART_BEGINS, PART_VISITS };
enum { PART_SURVEY_NODES = PART_VISITS + 1, PART_SURVEY_VISITS };
_Static_assert(PART_SURVEY_VISITS + 1 == GUIDE_PARTS, "the parts of a search");

typedef struct Counts {
    uint32_t nodes, cells, lobes, fours, survey_nodes, survey_cells;
    float threshold;
    uint32_t has_visits;
} Counts;

Status guide_search_new(GuideSearch **search, Error *error)
{
    *search = calloc(1, sizeof **search);
    return *search ? STATUS_OK : fail_memory(error, sizeof **search, "caustics");
}

void guide_search_clear(GuideSearch *search)
{
    free(search->landed);
    guide_free(search->guide);
    guide_free(search->survey);
    search->facts = (GuideFacts){0};
    search->landed = NULL;
    search->capacity = 0;
    search->guide = search->survey = NULL;
}

void guide_search_free(GuideSearch *search)
{
    if (search) guide_search_clear(search);
    free(search);
}

bool guide_search_is_begun(const GuideSearch *search)
{
    return search && search->facts.step != GUIDE_STEP_BEGIN;
}

bool guide_search_is_done(const GuideSearch *search)
{
    return search && search->facts.step == GUIDE_STEP_DONE;
}

const Guide *guide_search_result(const GuideSearch *search)
{
    return guide_search_is_done(search) ? search->guide : NULL;
}

/* ---- to bytes ---- */

void guide_search_write(const GuideSearch *search, bool (*write)(void *context, const void *bytes, size_t length),
                        void *context, bool *written)
{
    static const Guide none;
    const Guide *guide = search->guide ? search->guide : &none, *survey = search->survey ? search->survey : &none;
    Counts counts = {guide->n_nodes,  guide->n_cells,  guide->n_lobes,   guide->n_fours,
                     survey->n_nodes, survey->n_cells, guide->threshold, guide->visits != NULL};
    const struct {
        const void *bytes;
        size_t length;
    } parts[GUIDE_PARTS] = {
        [PART_FACTS] = {&search->facts, sizeof search->facts},
        [PART_LANDED] = {search->landed, search->landed ? search->facts.n * sizeof *search->landed : 0},
        [PART_COUNTS] = {&counts, sizeof counts},
        [PART_NODES] = {guide->nodes, guide->n_nodes * sizeof *guide->nodes},
        [PART_CELLS] = {guide->cells, guide->n_cells * sizeof *guide->cells},
        [PART_FOURS] = {guide->fours, guide->n_fours * sizeof *guide->fours},
        [PART_BEGINS] = {guide->begins, guide->begins ? (guide->n_cells + 2ul) * sizeof *guide->begins : 0},
        [PART_VISITS] = {guide->visits, guide->visits ? guide->n_cells * sizeof *guide->visits : 0},
        [PART_SURVEY_NODES] = {survey->nodes, survey->n_nodes * sizeof *survey->nodes},
        [PART_SURVEY_VISITS] = {survey->visits, survey->n_cells * sizeof *survey->visits}};
    *written = true;
    for (int i = 0; i < GUIDE_PARTS && *written; i++) *written = write(context, parts[i].bytes, parts[i].length);
}

/* ---- from bytes ---- */

/* Every child stands behind its parent, so that no way goes round. */
static bool nodes_can_be(const GuideNode *nodes, uint32_t n_nodes, uint32_t n_cells)
{
    for (uint32_t i = 0; i < n_nodes; i++) {
        const GuideNode *node = &nodes[i];
        bool leaf = node->axis == GUIDE_LEAF;
        uint32_t last_axis = i == 0 ? GUIDE_KIND : 2;
        if (leaf ? node->first >= n_cells : node->axis > last_axis || node->first <= i || node->first >= n_nodes - 1)
            return false;
    }
    return n_nodes > 0;
}

/* Sheet after sheet, up to the last lobe. */
static bool cell_can_be(const Guide *guide, const GuideCell *cell)
{
    uint32_t n = cell->n_lobes;
    if (n == 0) return cell->low.x > cell->high.x; /* nobody is ever in it */
    if (n > GUIDE_CELL_LOBES || cell->first_four > guide->n_fours ||
        guide_fours_of(n) > guide->n_fours - cell->first_four)
        return false;
    uint32_t first = 0;
    while (first < n) {
        uint32_t n_sheet = guide->fours[cell->first_four + first / LANES].n_sheet[first % LANES];
        if (n_sheet == 0 || n_sheet > n - first) return false;
        first += n_sheet;
    }
    return true;
}

static bool guide_can_be(const Guide *guide, uint64_t n_photons, bool done)
{
    if (!nodes_can_be(guide->nodes, guide->n_nodes, guide->n_cells)) return false;
    for (uint32_t i = 0; i < guide->n_cells; i++)
        if (!cell_can_be(guide, &guide->cells[i])) return false;
    if (done) return true;
    for (uint32_t i = 0; i < guide->n_cells; i++)
        if (guide->begins[i] > guide->begins[i + 1]) return false;
    return guide->begins[guide->n_cells] <= n_photons;
}

/* What follows from the bytes is there, too. */
static bool is_made_whole(Guide *guide, uint64_t n_photons, bool done)
{
    Error error;
    return guide_can_be(guide, n_photons, done) && guide_set_boxes(guide, &error) == STATUS_OK;
}

static bool facts_can_be(const GuideFacts *facts)
{
    return facts->step > GUIDE_STEP_BEGIN && facts->step <= GUIDE_STEP_DONE && facts->followed <= GUIDE_MOST_PHOTONS &&
           facts->n <= facts->followed && facts->round_begin <= facts->n && facts->round_end <= GUIDE_MOST_PHOTONS &&
           (facts->step != GUIDE_STEP_FOLLOW || facts->followed < facts->round_end);
}

/* Takes the bytes of a part if they are as many as they should be. */
static bool take(GuideBytes *part, uint64_t length, void *to)
{
    if (part->length != length) return false;
    memcpy(to, &part->bytes, sizeof part->bytes);
    part->bytes = NULL;
    return true;
}

static bool take_parts(GuideSearch *search, GuideBytes parts[GUIDE_PARTS])
{
    Counts counts;
    GuideFacts *facts = &search->facts;
    if (parts[PART_FACTS].length != sizeof *facts || parts[PART_COUNTS].length != sizeof counts) return false;
    memcpy(facts, parts[PART_FACTS].bytes, sizeof *facts);
    memcpy(&counts, parts[PART_COUNTS].bytes, sizeof counts);
    if (!facts_can_be(facts)) return false;
    bool done = facts->step == GUIDE_STEP_DONE;
    if (done && counts.nodes == 0) return true; /* none was of use */
    Guide *guide = search->guide = calloc(1, sizeof *guide), *survey = NULL;
    if (!done) survey = search->survey = calloc(1, sizeof *survey);
    if (!guide || (!done && !survey)) return false;
    guide->n_nodes = counts.nodes, guide->n_cells = counts.cells;
    guide->n_lobes = counts.lobes, guide->n_fours = counts.fours;
    guide->threshold = counts.threshold;
    if (!take(&parts[PART_NODES], counts.nodes * sizeof *guide->nodes, &guide->nodes) ||
        !take(&parts[PART_CELLS], counts.cells * sizeof *guide->cells, &guide->cells) ||
        !take(&parts[PART_FOURS], counts.fours * sizeof *guide->fours, &guide->fours))
        return false;
    guide->bright = facts->worth.bright;
    guide_shares_are_set(guide);
    if (done) return is_made_whole(guide, 0, true);
    survey->n_nodes = counts.survey_nodes, survey->n_cells = counts.survey_cells;
    search->capacity = facts->n;
    if (!take(&parts[PART_LANDED], facts->n * sizeof *search->landed, &search->landed) ||
        !take(&parts[PART_BEGINS], (counts.cells + 2ul) * sizeof *guide->begins, &guide->begins) ||
        !take(&parts[PART_SURVEY_NODES], counts.survey_nodes * sizeof *survey->nodes, &survey->nodes) ||
        !take(&parts[PART_SURVEY_VISITS], counts.survey_cells * sizeof *survey->visits, &survey->visits) ||
        (counts.has_visits && !take(&parts[PART_VISITS], counts.cells * sizeof *guide->visits, &guide->visits)))
        return false;
    return is_made_whole(guide, facts->n, false) && nodes_can_be(survey->nodes, survey->n_nodes, survey->n_cells);
}

bool guide_search_read(GuideBytes parts[GUIDE_PARTS], GuideSearch **search)
{
    *search = calloc(1, sizeof **search);
    bool good = *search && take_parts(*search, parts);
    for (int i = 0; i < GUIDE_PARTS; i++) {
        free(parts[i].bytes);
        parts[i].bytes = NULL;
    }
    if (good) return true;
    guide_search_free(*search);
    *search = NULL;
    return false;
}

/* guide_fit.c - lobes that describe from where the photons of a small region come.
 * A photon that was looked around at says from where its light comes at the places around it (trace/photon.h). Light of one
 * way through the glass may come in several sheets: through the top and through a side of the water in a pool, which are one
 * object, and by two parts of a wall that is bent. All photons together say how much comes by each, and how well lobes foretell
 * their directions; where several lobes know of one sheet, the best are asked. What few or strange photons say is described
 * broadly.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/guide_fit.h"

#include <math.h>

#include "optics/sampling.h"

/* The narrowest spread, in radians, beside the first order's: drops show the sun as small as that. (With a tenth of the sun's, a rainbow
 * of one drop in a beam of a tenth of a degree had four times the squared error, and other pictures the same.) */
#define NARROWEST 3e-5f
/* Of what is not known. */
#define UNKNOWN 0.05f
/* Part of the directions that is chosen broadly. */
#define BROAD 0.15f
/* The same of the lobe for all, where others are broad, too. */
#define LEAST_BROAD 0.1f
/* Where colours go farther apart than this, in radians, as behind a prism, lobes are not trusted by what photons of other colours
 * say: errors there were a fifth larger with that. The colours of water are nearer. */
#define PARTED 0.01f
/* Photons of a sheet, of many, that lobes are held to; and how many are enough to say that a lobe is right. */
enum { HELD_TO = 48, MOST_HELD = 4 * HELD_TO, ENOUGH = 16 };
/* Directions that are farther from what is known of a sheet are not of it, in radians. Its bends over a cell are less; two
 * sheets through one glass were seen 0.17 apart, and the fainter one was asked for all of the light. */
#define ONE_SHEET 0.1f

/* Where a photon is, in its cell. */
static GuidePlace place_of(const Photon *photon, Vec3f origin)
{
    return (GuidePlace){vec3f_along(photon->position, -1, origin), photon->color};
}

static GuideLobe lobe_of_photon(const Photon *photon, Vec3f origin)
{
    GuideLobe lobe = {.axis = photon->from, .weight = 0, .color = photon->color, .turns = photon->turns};
    Vec3f offset = vec3f_along(photon->position, -1, origin);
    sampling_basis(lobe.axis, &lobe.x, &lobe.y);
    if (photon->spread[0] > 0) {
        const float floor = NARROWEST * NARROWEST;
        lobe.slope_x = photon->slope[0], lobe.slope_y = photon->slope[1];
        lobe.hue_x = photon->hue[0], lobe.hue_y = photon->hue[1], lobe.hue_bend = photon->hue_bend;
        lobe.mean_x = photon->mean[0] - vec3f_dot(lobe.slope_x, offset) - lobe.hue_x * photon->color;
        lobe.mean_y = photon->mean[1] - vec3f_dot(lobe.slope_y, offset) - lobe.hue_y * photon->color;
        lobe.xx = photon->spread[0] + floor, lobe.xy = photon->spread[1], lobe.yy = photon->spread[2] + floor;
    } else {
        lobe.xx = lobe.yy = UNKNOWN * UNKNOWN;
    }
    lobe.place = offset;
    return lobe;
}

/* How widely a photon tells of directions, squared; where nothing is known of its neighbours, most widely. */
static float breadth_of(const Photon *photon)
{
    return photon->spread[0] > 0 ? photon->spread[0] + photon->spread[2] : INFINITY;
}

/* A direction in the lobe's plane. */
static void in_plane(const GuideLobe *lobe, Vec3f direction, float p[2])
{
    float stretch = sqrtf(2 / float_max(1 + vec3f_dot(lobe->axis, direction), 1e-3f));
    p[0] = stretch * vec3f_dot(lobe->x, direction);
    p[1] = stretch * vec3f_dot(lobe->y, direction);
}

/* Directions that a lobe is laid around: first all of them are added up, and then, as they are again, their spreads. */
typedef struct Bundle {
    GuideLobe lobe;
    Vec3f sum;
    float flux;
} Bundle;

static void bundle_add(Bundle *bundle, const Photon *photon, float flux)
{
    bundle->sum = vec3f_along(bundle->sum, flux, photon->from);
    bundle->flux += flux;
}

/* All are added; any: one of them. */
static void bundle_turn(Bundle *bundle, const Photon *any)
{
    bool has_middle = vec3f_length(bundle->sum) > 1e-3f * bundle->flux;
    bundle->lobe = (GuideLobe){.axis = has_middle ? vec3f_normalize(bundle->sum) : any->from, .turns = TURNS_UNTOLD};
    sampling_basis(bundle->lobe.axis, &bundle->lobe.x, &bundle->lobe.y);
}

static void bundle_spread(Bundle *bundle, const Photon *photon, float flux)
{
    float w = flux / bundle->flux, p[2];
    in_plane(&bundle->lobe, photon->from, p);
    bundle->lobe.xx += w * p[0] * p[0];
    bundle->lobe.xy += w * p[0] * p[1];
    bundle->lobe.yy += w * p[1] * p[1];
}

/* wider: than they spread, squared. */
static GuideLobe bundle_lobe(const Bundle *bundle, float wider)
{
    const float more = 0.02f * 0.02f;
    GuideLobe lobe = bundle->lobe;
    lobe.xx = wider * lobe.xx + more, lobe.xy *= wider, lobe.yy = wider * lobe.yy + more;
    return lobe;
}

/* A lobe around all directions. */
static GuideLobe lobe_of_all(const Photon *photons, uint32_t n)
{
    Bundle bundle = {.flux = 0};
    for (uint32_t i = 0; i < n; i++) bundle_add(&bundle, &photons[i], photon_flux_there(&photons[i]));
    bundle_turn(&bundle, photons);
    for (uint32_t i = 0; i < n; i++) bundle_spread(&bundle, &photons[i], photon_flux_there(&photons[i]));
    return bundle_lobe(&bundle, 2);
}

/* ---- sheets ---- */

/* What all photons of a cell say of a sheet. */
typedef struct Sheet {
    uint32_t first, end;            /* of its lobes */
    float flux, near_flux, n_near;  /* of the cell's photons; of a mean cell near by, and how many they are there */
    const Photon *photons[HELD_TO]; /* the first ones of it */
    uint32_t n;
} Sheet;

/* How far a direction is from the lobe's mean at a place: squared, in the plane. */
static float apart_squared(const GuideLobe *lobe, GuidePlace place, Vec3f direction)
{
    float p[2];
    in_plane(lobe, direction, p);
    float a = p[0] - lobe->mean_x - vec3f_dot(lobe->slope_x, place.offset) - lobe->hue_x * place.color;
    float b = p[1] - lobe->mean_y - vec3f_dot(lobe->slope_y, place.offset) - lobe->hue_y * place.color;
    return a * a + b * b;
}

/* Whether a photon is of the sheet that another one, whose lobe it is, tells of. */
static bool is_foretold(const Photon *photon, const Photon *known, const GuideLobe *lobe, Vec3f origin)
{
    return photon->way == known->way &&
           apart_squared(lobe, place_of(photon, origin), photon->from) < ONE_SHEET * ONE_SHEET;
}

/* Brings known photons of one sheet together, each behind the one of its way that tells most narrowly. Returns how many sheets
 * there are. */
static uint32_t sort_by_sheet(GuidePhotons *cell, Sheet *sheets)
{
    uint32_t n_sheets = 0, done = 0, n = cell->n_known;
    GuideKnown *known = cell->known;
    while (done < n) {
        uint32_t first = done, best = done;
        for (uint32_t i = done + 1; i < n; i++)
            if (breadth_of(known[i].photon) < breadth_of(known[best].photon)) best = i;
        const GuideKnown leader = known[best];
        GuideLobe lobe = lobe_of_photon(leader.photon, cell->origin);
        known[best] = known[done];
        known[done++] = leader;
        for (uint32_t i = done; i < n; i++) {
            if (!is_foretold(known[i].photon, leader.photon, &lobe, cell->origin)) continue;
            const GuideKnown moved = known[i];
            known[i] = known[done];
            known[done++] = moved;
        }
        Sheet *sheet = &sheets[n_sheets++];
        sheet->first = first, sheet->end = done;
        sheet->flux = sheet->near_flux = sheet->n_near = 0;
        sheet->n = 0;
    }
    return n_sheets;
}

/* The lobes of a cell's known photons, and by which way each came. */
typedef struct KnownLobes {
    Vec3f origin;
    uint32_t n, ways[GUIDE_CELL_LOBES];
    GuideFour fours[GUIDE_CELL_FOURS];
} KnownLobes;

static void lay_known(const GuidePhotons *cell, GuideLobe *lobes, KnownLobes *known)
{
    known->origin = cell->origin;
    known->n = cell->n_known;
    for (uint32_t i = 0; i < known->n; i++) {
        lobes[i] = lobe_of_photon(cell->known[i].photon, cell->origin);
        known->ways[i] = cell->known[i].photon->way;
    }
    guide_lay_in_fours(lobes, known->n, known->fours);
}

/* The lobe that foretells a photon best; known->n: none does. */
static uint32_t best_lobe_for(const KnownLobes *known, const Photon *photon)
{
    uint32_t best = known->n;
    float least = ONE_SHEET * ONE_SHEET, apart[LANES];
    GuidePlace place = place_of(photon, known->origin);
    for (uint32_t first = 0; first < known->n; first += LANES) {
        lanes_store(guide_lobes_apart_squared(&known->fours[first / LANES], place, photon->from), apart);
        for (uint32_t i = first; i < known->n && i < first + LANES; i++)
            if (known->ways[i] == photon->way && apart[i - first] < least) least = apart[i - first], best = i;
    }
    return best;
}

/* ---- what others know ---- */

static float flux_of(const Photon *photons, uint32_t n)
{
    float sum = 0;
    for (uint32_t i = 0; i < n; i++) sum += photon_flux_there(&photons[i]);
    return sum;
}

/* Light of a sheet of which nothing is known in a cell. */
typedef struct Unknown {
    const Photon *photon; /* the first one of it */
    GuideLobe lobe;
    float flux, n; /* of its photons, in sum, and how many they are */
    bool own;      /* some landed in the cell */
} Unknown;

/* Adds what n photons, each of which counts as `part`, say of it to n_unknown that are there; returns how many are then. */
static uint32_t add_unknown(const KnownLobes *known, const Photon *photons, uint32_t n, float part, bool own,
                            Unknown *unknown, uint32_t n_unknown)
{
    for (const Photon *photon = photons; photon < photons + n; photon++) {
        if (best_lobe_for(known, photon) < known->n) continue;
        uint32_t k = 0;
        while (k < n_unknown && !is_foretold(photon, unknown[k].photon, &unknown[k].lobe, known->origin)) k++;
        if (k == GUIDE_CELL_LENT) continue; /* so many parts that none is much */
        if (k == n_unknown)
            unknown[n_unknown++] =
                (Unknown){.photon = photon, .lobe = lobe_of_photon(photon, known->origin), .own = own};
        unknown[k].flux += part * photon_flux_there(photon);
        unknown[k].n += part;
    }
    return n_unknown;
}

/* Whether a sheet that nothing came by may be there all the same: there are so few photons that none of them is chance, and it would
 * bring a part of the light that is worth a lobe. */
static bool may_be_missed(const Unknown *unknown, float total)
{
    const float chance = 3, worth = 0.06f;
    return unknown->n < chance && unknown->flux > worth * total;
}

static uint32_t find_unknown(const GuidePhotons *cell, Unknown *unknown)
{
    GuideLobe lobes[GUIDE_CELL_KNOWN];
    KnownLobes known;
    lay_known(cell, lobes, &known);
    uint32_t n_all = add_unknown(&known, cell->photons, cell->n, 1, true, unknown, 0), n = 0;
    for (int side = 0; side < 2; side++)
        n_all =
            add_unknown(&known, cell->near[side].photons, cell->near[side].n, cell->near_part, false, unknown, n_all);
    float total = flux_of(cell->photons, cell->n);
    for (uint32_t i = 0; i < n_all; i++)
        if (unknown[i].own || may_be_missed(&unknown[i], total)) unknown[n++] = unknown[i];
    return n;
}

/* Makes those of n others that foretell a photon known, up to `most`, the nearest to the cell. */
static void borrow_for(GuidePhotons *cell, const Photon *photon, const Photon *others, uint32_t n, uint32_t most)
{
    float distances[GUIDE_CELL_LENT];
    GuideKnown *nearest = cell->known + cell->n_known;
    uint32_t n_near = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (others[i].way != photon->way || !(others[i].spread[0] > 0)) continue;
        Vec3f away = vec3f_along(others[i].position, -1, cell->origin);
        float distance = vec3f_dot(away, away);
        if (n_near == most && distance >= distances[most - 1]) continue;
        GuideLobe lobe = lobe_of_photon(&others[i], cell->origin);
        if (!is_foretold(photon, &others[i], &lobe, cell->origin)) continue;
        uint32_t k = n_near < most ? n_near++ : most - 1;
        for (; k > 0 && distances[k - 1] > distance; k--) distances[k] = distances[k - 1], nearest[k] = nearest[k - 1];
        distances[k] = distance;
        nearest[k] = (GuideKnown){&others[i], true};
    }
    cell->n_known += n_near;
}

void guide_borrow(GuidePhotons *cell, const Photon *others, uint32_t n)
{
    enum { OF_EACH = 4 };
    Unknown unknown[GUIDE_CELL_LENT];
    uint32_t n_unknown = find_unknown(cell, unknown), full = cell->n_known + GUIDE_CELL_LENT;
    for (; n_unknown > 0 && cell->n_known < full; n_unknown--) {
        uint32_t left = (full - cell->n_known + n_unknown - 1) / n_unknown, most = 0; /* for each */
        for (uint32_t k = 1; k < n_unknown; k++)
            if (unknown[k].flux > unknown[most].flux) most = k;
        borrow_for(cell, unknown[most].photon, others, n, left < OF_EACH ? left : OF_EACH);
        unknown[most] = unknown[n_unknown - 1];
    }
}

/* ---- a cell's lobes ---- */

static float wrong_by_color(const GuideLobe *lobe, float color)
{
    return lobe->hue_bend * (color - lobe->color) * (color - lobe->color);
}

/* How wrong lobe number `self` is by what others of its sheet, of which there are some, say that stand near by. Where light is
 * folded, as beside the bright lines under waves, several sheets of it lie over each other whose directions do not tell them
 * apart, and most of the others are of another one: the second least of six is of the lobe's own. It is then taken for
 * twice as wrong, as that is a little less than the middle one of those of one sheet. */
static float bend_by_lobes(const GuideLobe *lobes, const GuideFour *fours, const Sheet *sheet, uint32_t self,
                           float size)
{
    enum { NEAREST = 6 };
    float distances[NEAREST], bends[NEAREST], least = INFINITY, second = INFINITY;
    uint32_t n_near = 0;
    for (uint32_t i = sheet->first; i < sheet->end; i++) {
        if (i == self) continue;
        Vec3f there = lobes[i].place, away = vec3f_along(there, -1, lobes[self].place);
        float distance = float_max(vec3f_dot(away, away), 1e-12f * size);
        if (n_near == NEAREST && distance >= distances[NEAREST - 1]) continue;
        GuidePlace place = {there, lobes[i].color};
        Vec3f mine = guide_lobe_mean(fours, self, place), other = guide_lobe_mean(fours, i, place);
        uint32_t k = n_near < NEAREST ? n_near++ : NEAREST - 1;
        for (; k > 0 && distances[k - 1] > distance; k--) distances[k] = distances[k - 1], bends[k] = bends[k - 1];
        distances[k] = distance;
        float apart = vec3f_length(vec3f_along(mine, -1, other)) - wrong_by_color(&lobes[self], place.color);
        bends[k] = float_max(apart, 0) / distance;
    }
    for (uint32_t i = 0; i < n_near; i++) {
        second = float_min(second, float_max(least, bends[i]));
        least = float_min(least, bends[i]);
    }
    return 2 * (n_near == 1 ? least : second);
}

/* The same by the cell's photons, which tell less well, of a sheet's only lobe, or of one that is lent: by how far their directions
 * are beyond its own spread, of this part of them less; twice that. Where there are none, as wrong at the cell's end as what is
 * not known. */
static float bend_by_photons(const GuidePhotons *cell, const GuideLobe *lobes, const Sheet *sheet, uint32_t self,
                             float size, float part)
{
    const GuideLobe *lobe = &lobes[self];
    float bends[HELD_TO];
    uint32_t n = 0;
    for (uint32_t i = 0; i < sheet->n; i++) {
        const Photon *photon = sheet->photons[i];
        if (photon->number == cell->known[self].photon->number) continue;
        GuidePlace there = place_of(photon, cell->origin);
        Vec3f away = vec3f_along(there.offset, -1, lobe->place);
        float beyond = float_max(apart_squared(lobe, there, photon->from) - 2 * (lobe->xx + lobe->yy), 0);
        float apart = float_max(sqrtf(beyond) - wrong_by_color(lobe, photon->color), 0);
        float bend = apart / float_max(vec3f_dot(away, away), 1e-12f * size);
        uint32_t k = n++;
        for (; k > 0 && bends[k - 1] > bend; k--) bends[k] = bends[k - 1];
        bends[k] = bend;
    }
    return n > 0 ? 2 * bends[(uint32_t)(part * (float)n)] : UNKNOWN / size;
}

/* How wrong a lobe is away from its place. What others of its sheet say is noise where they all stand close together, in a corner of
 * a cell that was foreseen when they were looked around at: their means differ by a tenth of the sun, and a little of that on a short
 * way is much on a long one. So where nearly all photons of the sheet, from anywhere in the cell, are where the lobe has them, it is
 * right. (Without this there were dark rectangles on the even floor of a pool, of few samples that were far too bright.) */
static float bend_of(const GuidePhotons *cell, const GuideLobe *lobes, const GuideFour *fours, const Sheet *sheet,
                     uint32_t self, float size)
{
    const float few = 1.0f / 3, nearly_all = 0.8f;
    if (lobes[self].n_sheet == 1 || cell->known[self].lent) return bend_by_photons(cell, lobes, sheet, self, size, few);
    float bend = bend_by_lobes(lobes, fours, sheet, self, size);
    bool parts_colors = fabsf(lobes[self].hue_x) + fabsf(lobes[self].hue_y) + lobes[self].hue_bend > PARTED;
    if (sheet->n < ENOUGH || parts_colors) return bend;
    return float_min(bend, bend_by_photons(cell, lobes, sheet, self, size, nearly_all));
}

/* The sheet whose lobes foretell a photon best; NULL: none does. */
static Sheet *sheet_of(const KnownLobes *known, const Photon *photon, Sheet *sheets)
{
    uint32_t best = best_lobe_for(known, photon);
    if (best == known->n) return NULL;
    while (best >= sheets->end) sheets++;
    return sheets;
}

/* Gives each photon to its sheet; returns the light that is of none. */
static float deal_out(const GuidePhotons *cell, const KnownLobes *known, Sheet *sheets)
{
    float lost = 0;
    for (const Photon *photon = cell->photons; photon < cell->photons + cell->n; photon++) {
        Sheet *sheet = sheet_of(known, photon, sheets);
        if (!sheet) {
            lost += photon_flux_there(photon);
            continue;
        }
        sheet->flux += photon_flux_there(photon);
        if (sheet->n < HELD_TO) sheet->photons[sheet->n++] = photon;
    }
    return lost;
}

/* Gives them those of cells near by, too, which say as well how good their lobes are. Of a sheet that none of the cell's tells of,
 * the light is what of n photons in a mean cell near by may be missing by chance: n / (n + 1) of one of them, the mean of a gamma
 * distribution. Returns the light of all sheets. */
static float deal_out_near(const GuidePhotons *cell, const KnownLobes *known, Sheet *sheets, uint32_t n_sheets)
{
    float sum = 0;
    for (int side = 0; side < 2; side++)
        for (uint32_t i = 0; i < cell->near[side].n; i++) {
            const Photon *photon = &cell->near[side].photons[i];
            Sheet *sheet = sheet_of(known, photon, sheets);
            if (!sheet) continue;
            sheet->near_flux += cell->near_part * photon_flux_there(photon);
            sheet->n_near += cell->near_part;
            if (sheet->n < HELD_TO) sheet->photons[sheet->n++] = photon;
        }
    for (Sheet *sheet = sheets; sheet < sheets + n_sheets; sheet++) {
        if (!(sheet->flux > 0)) sheet->flux = sheet->near_flux / (sheet->n_near + 1);
        sum += sheet->flux;
    }
    return sum;
}

/* ---- what is narrow of it ---- */

/* Photons that say how good the cell's lobes are: those of which none is made, and each of the others for the lobes but its own. */
typedef struct Held {
    const Photon *photons[MOST_HELD];
    float flux[MOST_HELD];
    uint32_t n, n_lobes, lobes[HELD_TO]; /* of the first n_lobes: the numbers of their own lobes */
    float radius;                        /* of the cell */
} Held;

/* The cell's own of which lobes are made. Where all are, photons from beside it alone would judge lobes that hold for places within:
 * one cell in a hundred of a lake bed in the sun, behind rippled ice, was a dark rectangle for that, with few samples that were far
 * too bright. */
static void hold_known(Held *held, const GuidePhotons *cell)
{
    for (uint32_t i = 0; i < cell->n_known && held->n < HELD_TO; i++) {
        if (cell->known[i].lent) continue;
        held->photons[held->n] = cell->known[i].photon;
        held->flux[held->n] = photon_flux_there(cell->known[i].photon);
        held->lobes[held->n++] = i;
    }
    held->n_lobes = held->n;
}

/* Some of n more, each of which counts as `part`: those that are not farther from the origin. */
static void hold(Held *held, const Photon *photons, uint32_t n, float part, Vec3f origin, float farthest)
{
    uint32_t full = held->n + HELD_TO;
    for (uint32_t i = 0; i < n && held->n < full; i++) {
        if (photons[i].lobe || vec3f_length(vec3f_along(photons[i].position, -1, origin)) > farthest) continue;
        held->photons[held->n] = &photons[i];
        held->flux[held->n++] = part * photon_flux_there(&photons[i]);
    }
}

/* From a cell and those beside it: what the tree has near by may be far away, and knows nothing of the cell. (Cells of a wall behind a
 * chandelier held lobes of its bulbs to few strong photons that had landed on its ring, and chose these for nine of ten directions.) */
static void hold_all(Held *held, const GuidePhotons *cell)
{
    enum { FEW_OTHERS = 8 };
    const float beside = 6; /* of its own radius */
    uint32_t n_others = 0;
    for (uint32_t i = 0; i < cell->n; i++) n_others += !cell->photons[i].lobe;
    if (n_others < FEW_OTHERS) hold_known(held, cell);
    for (uint32_t i = 0; i < cell->n; i++)
        held->radius = float_max(held->radius, vec3f_length(vec3f_along(cell->photons[i].position, -1, cell->origin)));
    hold(held, cell->photons, cell->n, 1, cell->origin, held->radius);
    for (int side = 0; side < 2; side++)
        hold(held, cell->near[side].photons, cell->near[side].n, cell->near_part, cell->origin, beside * held->radius);
}

/* What comes by one way, that of photon number `first`. */
typedef struct Way {
    uint32_t first, n;
    float flux;
} Way;

/* The ways by which most light comes, of those of enough photons. None by rough surfaces: what a photon says holds for one way by their
 * facets there, and with lobes around all, a wall behind a lamp in frosted glass had dark rectangles, of few samples that were
 * far too bright. */
static uint32_t find_ways(const Held *held, Way ways[GUIDE_CELL_WAYS])
{
    enum { FEWEST = 8 };
    bool told[MOST_HELD] = {false};
    uint32_t n_ways = 0;
    for (uint32_t i = 0; i < held->n; i++) {
        Way way = {.first = i};
        for (uint32_t k = i; k < held->n && !told[i] && held->photons[i]->way % 2 == 0; k++) {
            if (held->photons[k]->way != held->photons[i]->way) continue;
            told[k] = k > i;
            way.flux += held->flux[k];
            way.n++;
        }
        if (way.n < FEWEST) continue;
        uint32_t at = n_ways; /* the brightest first */
        for (; at > 0 && ways[at - 1].flux < way.flux; at--)
            if (at < GUIDE_CELL_WAYS) ways[at] = ways[at - 1];
        if (at < GUIDE_CELL_WAYS) ways[at] = way;
        n_ways += n_ways < GUIDE_CELL_WAYS;
    }
    return n_ways;
}

static GuideLobe lobe_of_way(const Held *held, const Way *way)
{
    const uint32_t number = held->photons[way->first]->way;
    Bundle bundle = {.flux = 0};
    for (uint32_t i = way->first; i < held->n; i++)
        if (held->photons[i]->way == number) bundle_add(&bundle, held->photons[i], held->flux[i]);
    bundle_turn(&bundle, held->photons[way->first]);
    for (uint32_t i = way->first; i < held->n; i++)
        if (held->photons[i]->way == number) bundle_spread(&bundle, held->photons[i], held->flux[i]);
    GuideLobe lobe = bundle_lobe(&bundle, 1.3f + 4 / (float)way->n); /* few say less of how far it goes */
    lobe.turns = held->photons[way->first]->turns;
    return lobe;
}

/* What directions are chosen by: a cell's narrow lobes together, those of ways, and the one for all. */
enum { NARROW, FIRST_BROAD, CHOICES = FIRST_BROAD + GUIDE_CELL_WAYS + 1 };

/* The density that each of these has, chosen alone, of the direction of a held photon, the own lobe of which is far away for that.
 * narrow: the narrow ones, of which there are n_narrow; broad: the n_broad others. */
static void densities_of(const Held *held, uint32_t i, Vec3f origin, GuideFour *narrow, uint32_t n_narrow,
                         const GuideFour *broad, uint32_t n_broad, float pdf[CHOICES])
{
    const float far_away = 1e4f; /* radii */
    const Vec3f direction = held->photons[i]->from;
    const GuidePlace place = place_of(held->photons[i], origin);
    const uint32_t own = i < held->n_lobes ? held->lobes[i] : UINT32_MAX, lane = own % LANES;
    float there = 0;
    if (own < n_narrow) {
        Lanes *where = &narrow[own / LANES].place.x;
        there = lanes_get(*where, (int)lane);
        lanes_set(where, (int)lane, there + far_away * held->radius);
    }
    pdf[NARROW] = n_narrow > 0 ? guide_lobes_pdf(narrow, n_narrow, place, direction) : 0;
    if (own < n_narrow) lanes_set(&narrow[own / LANES].place.x, (int)lane, there);
    for (uint32_t k = 0; k < n_broad; k++) pdf[FIRST_BROAD + k] = guide_lobes_pdf(&broad[k], 1, place, direction);
}

/* How often each is to be chosen, so that they foretell the held photons best: by expectation maximisation (A. P. Dempster, N. M.
 * Laird, D. B. Rubin, "Maximum Likelihood from Incomplete Data via the EM Algorithm", 1977). parts: where it begins, and ends. */
static void find_parts(const Held *held, float pdf[][CHOICES], uint32_t n, float parts[CHOICES])
{
    enum { ROUNDS = 12 };
    for (int round = 0; round < ROUNDS; round++) {
        float sums[CHOICES] = {0}, flux = 0;
        for (uint32_t i = 0; i < held->n; i++) {
            float whole = 1e-20f;
            for (uint32_t k = 0; k < n; k++) whole += parts[k] * pdf[i][k];
            for (uint32_t k = 0; k < n; k++) sums[k] += held->flux[i] * parts[k] * pdf[i][k] / whole;
            flux += held->flux[i];
        }
        for (uint32_t k = 0; k < n; k++) parts[k] = sums[k] / flux;
    }
}

/* Gives narrow lobes, whose weights are those among themselves, and n_broad behind them their parts of all. */
static void weigh(GuideLobe *lobes, uint32_t n_narrow, uint32_t n_broad, const float parts[CHOICES])
{
    float sum = n_narrow > 0 ? parts[NARROW] : 0;
    for (uint32_t i = 0; i < n_narrow; i++) lobes[i].weight *= parts[NARROW], lobes[i].cumulative *= parts[NARROW];
    for (uint32_t k = 0; k < n_broad; k++) {
        lobes[n_narrow + k].weight = parts[FIRST_BROAD + k];
        lobes[n_narrow + k].cumulative = sum += parts[FIRST_BROAD + k];
    }
}

/* Light of a large lamp that comes through waves, or by ways of which a cell has met few, is mostly not where narrow lobes have it: each
 * of these holds for a small part of the lamp. Then lobes around all that comes by one way are chosen, too. (The squared error of
 * sand under waves in the light of a tank's lamp is half of what it was; where narrow lobes are right, as in the sun, others make
 * it larger by a tenth.) Lays these lobes behind n_narrow narrow ones, whose weights are those among
 * themselves; broad: what the lobe for all has of all by the rule above. Returns how many lobes there are. */
static uint32_t add_broad(const GuidePhotons *cell, uint32_t n_narrow, float broad, GuideLobe *lobes)
{
    const float right = 0.4f;
    GuideFour narrow[GUIDE_CELL_FOURS], alone[GUIDE_CELL_WAYS + 1];
    GuideLobe *others = lobes + n_narrow;
    Held held = {.n = 0};
    Way ways[GUIDE_CELL_WAYS];
    float pdf[MOST_HELD][CHOICES], parts[CHOICES] = {1 - broad};
    hold_all(&held, cell);
    uint32_t n_ways = find_ways(&held, ways), n_broad = n_ways + 1;
    for (uint32_t k = 0; k < n_ways; k++) others[k] = lobe_of_way(&held, &ways[k]);
    others[n_ways] = lobe_of_all(cell->photons, cell->n);
    for (uint32_t k = 0; k < n_broad; k++) {
        others[k].weight = others[k].cumulative = 1;
        others[k].n_sheet = 1;
        parts[FIRST_BROAD + k] = broad / (float)n_broad;
        guide_lay_in_fours(&others[k], 1, &alone[k]);
    }
    if (n_ways > 0) {
        if (n_narrow > 0) guide_lay_in_fours(lobes, n_narrow, narrow);
        for (uint32_t i = 0; i < held.n; i++)
            densities_of(&held, i, cell->origin, narrow, n_narrow, alone, n_broad, pdf[i]);
        find_parts(&held, pdf, FIRST_BROAD + n_broad, parts);
    }
    if (n_ways == 0 || parts[NARROW] > right) {
        others[0] = others[n_ways];
        n_broad = 1;
        parts[NARROW] = 1 - broad;
        parts[FIRST_BROAD] = broad;
    } else {
        for (uint32_t k = 0; k < FIRST_BROAD + n_broad; k++) parts[k] *= 1 - LEAST_BROAD;
        parts[n_broad] += LEAST_BROAD;
    }
    weigh(lobes, n_narrow, n_broad, parts);
    return n_narrow + n_broad;
}

uint32_t guide_fit(GuidePhotons *cell, GuideLobe *lobes)
{
    Sheet sheets[GUIDE_CELL_LOBES];
    KnownLobes known;
    const uint32_t n_known = cell->n_known, n_sheets = sort_by_sheet(cell, sheets);
    float total = 0, sum = 0, size = 1e-30f;
    lay_known(cell, lobes, &known);
    for (uint32_t i = 0; i < n_known; i++) size = float_max(size, vec3f_dot(lobes[i].place, lobes[i].place));
    float lost = deal_out(cell, &known, sheets);
    total = flux_of(cell->photons, cell->n);
    float broad = BROAD + (1 - BROAD) * lost / total, of_sheets = deal_out_near(cell, &known, sheets, n_sheets);
    for (const Sheet *sheet = sheets; sheet < sheets + n_sheets; sheet++) {
        float weight = of_sheets > 0 ? sheet->flux / of_sheets : 0;
        sum += weight;
        for (uint32_t i = sheet->first; i < sheet->end; i++) {
            lobes[i].weight = weight;
            lobes[i].cumulative = sum;
            lobes[i].n_sheet = sheet->end - sheet->first;
            lobes[i].bend = bend_of(cell, lobes, known.fours, sheet, i, size);
        }
    }
    return add_broad(cell, n_known, broad, lobes);
}

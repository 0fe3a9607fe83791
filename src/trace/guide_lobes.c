/* guide_lobes.c - choosing directions by a cell's lobes, and the density of that.
 * Which lobe of a sheet is asked depends on the place: those that know it best. What is decided for that is computed in one
 * way for sampling and for densities, four lobes at a time, so that both always agree.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/guide_lobes.h"

#include "optics/sampling.h"

/* The lobes' shape in units of their spread. An even disc of this radius, as wide as one that has the spread, and a little
 * wider; */
#define DISC 2.2f
#define DISC_PART 0.7f
/* and about it what falls off slowly, as what the photons say holds near by only: (1 + r^2 / 4)^-3 up to this r, of a spread
 * that is so many times as large, or more where a lobe may be wrong. */
#define REACH 5.0f
#define TAIL (1 + REACH * REACH / 4)
#define TAIL_WIDER 2.0f
#define WIDEST 0.39f /* so that all of a lobe is on the sphere: 1.99 / REACH */
/* A spread up to here leaves room for the whole tail. */
#define NARROW (1.99f / (REACH * TAIL_WIDER))
/* The square of how far a mean goes from its axis, in the plane: almost a right angle. */
#define FARTHEST_MEAN 1.9f
/* Of the lobes of a sheet those count in full that are up to so many times as wide, squared, as its narrowest one at a place; and in
 * part those that are not wider by far. Beside a fold of the light the narrow ones may be wrong, and a wider one know better:
 * without these there were small dark places beside the bright lines on the floor of a pool, with few samples that were
 * hundreds of times too bright. To count them in full costs more elsewhere. */
#define WIDE 4.0f
#define TOO_WIDE 64.0f
#define WIDE_PART 0.2f
/* How wrong a lobe is away from its place is found by few and noisy means, and may be a hundred times too much. So the disc takes no
 * more of it than this, in radians, and the tail all. With all of it in both, a glass's shadow in the sun had small dark squares,
 * whose light came as few samples that were far too bright. */
#define MOST_WRONG 0.02f
/* How often what comes by a lobe is led as its light went; else it goes by chance, as light may have come by other ways. */
#define LED_PART 0.85f

void guide_lay_in_fours(const GuideLobe *lobes, uint32_t n, GuideFour *fours)
{
    for (uint32_t i = 0; i < guide_fours_of(n) * LANES; i++) {
        const GuideLobe *lobe = &lobes[i < n ? i : n - 1]; /* what fills the last four up is never chosen */
        GuideFour *four = &fours[i / LANES];
        int lane = (int)(i % LANES);
        const Vec3f vectors[] = {lobe->place, lobe->axis, lobe->x, lobe->y, lobe->slope_x, lobe->slope_y};
        LanesVec3 *const to[] = {&four->place, &four->axis, &four->x, &four->y, &four->slope_x, &four->slope_y};
        for (size_t k = 0; k < COUNT_OF(vectors); k++) {
            lanes_set(&to[k]->x, lane, vectors[k].x);
            lanes_set(&to[k]->y, lane, vectors[k].y);
            lanes_set(&to[k]->z, lane, vectors[k].z);
        }
        lanes_set(&four->mean_x, lane, lobe->mean_x);
        lanes_set(&four->mean_y, lane, lobe->mean_y);
        lanes_set(&four->xx, lane, lobe->xx);
        lanes_set(&four->xy, lane, lobe->xy);
        lanes_set(&four->yy, lane, lobe->yy);
        lanes_set(&four->bend, lane, lobe->bend);
        lanes_set(&four->color, lane, lobe->color);
        lanes_set(&four->hue_x, lane, lobe->hue_x);
        lanes_set(&four->hue_y, lane, lobe->hue_y);
        lanes_set(&four->hue_bend, lane, lobe->hue_bend);
        four->weight[lane] = lobe->weight;
        four->cumulative[lane] = lobe->cumulative;
        four->n_sheet[lane] = lobe->n_sheet;
        four->turns[lane] = lobe->turns;
    }
}

/* ---- which lobes know a place ---- */

/* What each lobe of a cell is at a place. */
typedef struct CellParts {
    float error[GUIDE_CELL_FOURS * LANES];    /* the square of how wrong it is there */
    float nearness[GUIDE_CELL_FOURS * LANES]; /* how much it counts, of all of its sheet; 0: not at all */
} CellParts;

static LanesVec3 from_each(const LanesVec3 *a, Vec3f b)
{
    return (LanesVec3){lanes_sub(lanes_all(b.x), a->x), lanes_sub(lanes_all(b.y), a->y),
                       lanes_sub(lanes_all(b.z), a->z)};
}

static Lanes dots(const LanesVec3 *a, const LanesVec3 *b)
{
    return lanes_add(lanes_mul(a->x, b->x), lanes_add(lanes_mul(a->y, b->y), lanes_mul(a->z, b->z)));
}

static Lanes dots_with(const LanesVec3 *a, Vec3f b)
{
    return lanes_add(lanes_scale(a->x, b.x), lanes_add(lanes_scale(a->y, b.y), lanes_scale(a->z, b.z)));
}

/* The lobes' errors, and one over their spreads with that: of the fours with the lobes first .. end - 1. */
static void look_at_fours(const GuideFour *fours, uint32_t first, uint32_t end, GuidePlace place, CellParts *parts)
{
    for (uint32_t i = first / LANES; i < guide_fours_of(end); i++) {
        LanesVec3 away = from_each(&fours[i].place, place.offset);
        Lanes hue = lanes_sub(lanes_all(place.color), fours[i].color);
        Lanes error = lanes_mul(fours[i].bend, dots(&away, &away));
        error = lanes_add(error, lanes_mul(fours[i].hue_bend, lanes_mul(hue, hue)));
        error = lanes_mul(error, error);
        Lanes spread = lanes_add(lanes_scale(lanes_add(fours[i].xx, fours[i].yy), 0.5f), error);
        lanes_store(error, parts->error + LANES * i);
        lanes_store(lanes_div(lanes_all(1), spread), parts->nearness + LANES * i);
    }
}

/* How much each lobe of a sheet counts, of what look_at_fours has said. Returns the sum. */
static float choose_near(float nearness[], uint32_t n)
{
    float nearest = 0, sum = 0;
    for (uint32_t k = 0; k < n; k++) nearest = float_max(nearest, nearness[k]);
    for (uint32_t k = 0; k < n; k++)
        sum += nearness[k] *= nearness[k] * WIDE >= nearest ? 1 : nearness[k] * TOO_WIDE >= nearest ? WIDE_PART : 0;
    return sum;
}

/* ---- means and spreads at a place ---- */

/* The mean directions of four lobes. */
static LanesVec3 means_of(const GuideFour *four, GuidePlace place)
{
    Lanes px = lanes_add(four->mean_x, dots_with(&four->slope_x, place.offset));
    Lanes py = lanes_add(four->mean_y, dots_with(&four->slope_y, place.offset));
    px = lanes_add(px, lanes_scale(four->hue_x, place.color));
    py = lanes_add(py, lanes_scale(four->hue_y, place.color));
    Lanes square = lanes_add(lanes_mul(px, px), lanes_mul(py, py));
    if (UNLIKELY(lanes_max(square) > FARTHEST_MEAN)) {
        Lanes shrink = lanes_sqrt(lanes_div(lanes_all(FARTHEST_MEAN), lanes_greater(square, lanes_all(FARTHEST_MEAN))));
        px = lanes_mul(px, shrink), py = lanes_mul(py, shrink);
        square = lanes_lesser(square, lanes_all(FARTHEST_MEAN));
    }
    Lanes sine = lanes_sqrt(lanes_rest(lanes_scale(square, 0.25f))), along = lanes_rest(lanes_scale(square, 0.5f));
    px = lanes_mul(px, sine), py = lanes_mul(py, sine);
#define SUM(c) lanes_add(lanes_mul(four->axis.c, along), lanes_add(lanes_mul(four->x.c, px), lanes_mul(four->y.c, py)))
    return (LanesVec3){SUM(x), SUM(y), SUM(z)};
#undef SUM
}

Lanes guide_lobes_apart_squared(const GuideFour *four, GuidePlace place, Vec3f direction)
{
    Lanes along = lanes_add(lanes_all(1), dots_with(&four->axis, direction));
    Lanes stretch = lanes_sqrt(lanes_div(lanes_all(2), lanes_greater(along, lanes_all(1e-3f))));
    Lanes x = lanes_sub(lanes_mul(stretch, dots_with(&four->x, direction)), four->mean_x);
    Lanes y = lanes_sub(lanes_mul(stretch, dots_with(&four->y, direction)), four->mean_y);
    x = lanes_sub(lanes_sub(x, dots_with(&four->slope_x, place.offset)), lanes_scale(four->hue_x, place.color));
    y = lanes_sub(lanes_sub(y, dots_with(&four->slope_y, place.offset)), lanes_scale(four->hue_y, place.color));
    return lanes_add(lanes_mul(x, x), lanes_mul(y, y));
}

static Vec3f vector_in(const LanesVec3 *four, int lane)
{
    return (Vec3f){lanes_get(four->x, lane), lanes_get(four->y, lane), lanes_get(four->z, lane)};
}

Vec3f guide_lobe_mean(const GuideFour *fours, uint32_t lobe, GuidePlace place)
{
    LanesVec3 means = means_of(&fours[lobe / LANES], place);
    return vector_in(&means, (int)(lobe % LANES));
}

/* How the directions of four lobes at a place spread in the plane at their means. */
typedef struct FourSpreads {
    Lanes xx, xy, yy, determinant;
    Lanes tail_wider; /* how much wider the tails are: as all of the error asks for, of which the discs have a part */
} FourSpreads;

/* The sum of the two spreads of each. */
static inline Lanes whole_spread(const GuideFour *four, Lanes error)
{
    return lanes_add(lanes_add(four->xx, four->yy), lanes_add(error, error));
}

static FourSpreads spreads_of(const GuideFour *four, Lanes error)
{
    Lanes trusted = lanes_lesser(error, lanes_all(MOST_WRONG * MOST_WRONG));
    Lanes sum = whole_spread(four, trusted), whole = whole_spread(four, error); /* the discs', the tails' */
    FourSpreads s = {.xx = lanes_add(four->xx, trusted),
                     .xy = four->xy,
                     .yy = lanes_add(four->yy, trusted),
                     .tail_wider = lanes_scale(lanes_sqrt(lanes_div(whole, sum)), TAIL_WIDER)};
    if (lanes_max(whole) > NARROW * NARROW) {
        const Lanes most = lanes_all(WIDEST * WIDEST);
        Lanes difference = lanes_scale(lanes_sub(s.xx, s.yy), 0.5f);
        Lanes root = lanes_sqrt(lanes_add(lanes_mul(difference, difference), lanes_mul(s.xy, s.xy)));
        Lanes widest = lanes_add(lanes_scale(sum, 0.5f), root), held = lanes_lesser(widest, most);
        Lanes shrink = lanes_div(held, widest);
        s.xx = lanes_mul(s.xx, shrink), s.xy = lanes_mul(s.xy, shrink), s.yy = lanes_mul(s.yy, shrink);
        s.tail_wider = lanes_lesser(s.tail_wider, lanes_div(lanes_all(1.99f / REACH), lanes_sqrt(held)));
    }
    Lanes product = lanes_mul(s.xx, s.yy);
    s.determinant = lanes_greater(lanes_sub(product, lanes_mul(s.xy, s.xy)), lanes_scale(product, 1e-4f));
    return s;
}

/* ---- sampling ---- */

static Vec3f sample_lobe(const GuideFour *fours, uint32_t lobe, float error, GuidePlace place, const float v[2])
{
    const GuideFour *four = &fours[lobe / LANES];
    const int lane = (int)(lobe % LANES);
    FourSpreads spreads = spreads_of(four, lanes_all(error));
    float xx = lanes_get(spreads.xx, lane), xy = lanes_get(spreads.xy, lane);
    Vec3f mean = guide_lobe_mean(fours, lobe, place), of_lobe = vector_in(&four->x, lane);
    Vec3f x = vec3f_normalize(vec3f_along(of_lobe, -vec3f_dot(of_lobe, mean), mean)), y = vec3f_cross(mean, x);
    bool tail = v[0] >= DISC_PART;
    float p, q, stretch = DISC;
    sampling_disc(tail ? (v[0] - DISC_PART) / (1 - DISC_PART) : v[0] / DISC_PART, v[1], &p, &q);
    if (tail) {
        float u = p * p + q * q; /* uniform: the part of the tail within r */
        /* of the tail within r is (1 - (1 + r^2/4)^-2) / (1 - TAIL^-2) */
        float rest = 1 - u * (1 - 1 / (TAIL * TAIL)), r = sqrtf(4 * float_max(1 / sqrtf(rest) - 1, 0));
        stretch = u > 0 ? lanes_get(spreads.tail_wider, lane) * r / sqrtf(u) : 0;
    }
    p *= stretch, q *= stretch;
    /* by the Cholesky factor of the spread */
    float scale_x = sqrtf(xx), scale_y = sqrtf(lanes_get(spreads.determinant, lane) / xx);
    float a = scale_x * p, b = xy / scale_x * p + scale_y * q, square = float_min(a * a + b * b, 4);
    float sine = sqrtf(1 - 0.25f * square);
    Vec3f direction = vec3f_along(vec3f_scale(mean, 1 - 0.5f * square), a * sine, x);
    return vec3f_normalize(vec3f_along(direction, b * sine, y));
}

Vec3f guide_sample_lobes(const GuideFour *fours, uint32_t n, GuidePlace place, float u, const float v[2])
{
    CellParts parts;
    uint32_t first = 0, n_sheet;
    float before = 0;
    while (n_sheet = fours[first / LANES].n_sheet[first % LANES],
           first + n_sheet < n && u >= fours[first / LANES].cumulative[first % LANES])
        before = fours[first / LANES].cumulative[first % LANES], first += n_sheet;
    look_at_fours(fours, first, first + n_sheet, place, &parts);
    uint32_t chosen = first;
    if (n_sheet > 1) {
        float sum = choose_near(parts.nearness + first, n_sheet);
        float part = (u - before) / fours[first / LANES].weight[first % LANES] * sum;
        for (uint32_t next = first; next < first + n_sheet; next++) {
            if (parts.nearness[next] == 0) continue;
            chosen = next; /* the last one if rounding leaves something */
            if (part < parts.nearness[chosen]) break;
            part -= parts.nearness[chosen];
        }
    }
    return sample_lobe(fours, chosen, parts.error[chosen], place, v);
}

/* ---- densities ---- */

/* The densities of four lobes; 0 where their weight is 0. */
static Lanes densities(const GuideFour *four, Lanes weight, Lanes error, GuidePlace place, Vec3f direction)
{
    const Lanes none = lanes_all(0);
    LanesVec3 mean = means_of(four, place);
    Lanes cosine = dots_with(&mean, direction);
    /* the square of the largest spread is less than the sum of both */
    const float farthest = 0.5f * (REACH * TAIL_WIDER) * (REACH * TAIL_WIDER);
    Lanes reach = lanes_scale(whole_spread(four, error), farthest * 1.0001f);
    Lanes away = lanes_sub(lanes_all(1 - 1e-6f), cosine);
    weight = lanes_select_less(reach, away, none, weight);
    if (lanes_zero(weight)) return none;
    FourSpreads s = spreads_of(four, error);
    /* the direction in the frame at the mean, of which x is the lobe's, less what of it lies along the mean */
    Lanes tilt = dots(&four->x, &mean), length = lanes_rest(lanes_mul(tilt, tilt)); /* its square */
    Lanes a = lanes_sub(dots_with(&four->x, direction), lanes_mul(tilt, cosine));
    LanesVec3 across = {lanes_sub(lanes_scale(mean.y, direction.z), lanes_scale(mean.z, direction.y)),
                        lanes_sub(lanes_scale(mean.z, direction.x), lanes_scale(mean.x, direction.z)),
                        lanes_sub(lanes_scale(mean.x, direction.y), lanes_scale(mean.y, direction.x))};
    Lanes b = lanes_sub(none, dots(&across, &four->x)); /* direction . (mean x x) = -x . (mean x direction) */
    /* the square of how far the direction is from the mean, in spreads: by the projection, (a, b) is to be multiplied with
     * the root of 2 / (1 + cosine), over the length of x; and its square is a^2 / xx + (b - a xy / xx)^2 xx / determinant */
    Lanes beside = lanes_sub(lanes_mul(b, s.xx), lanes_mul(a, s.xy));
    Lanes up = lanes_add(lanes_mul(lanes_mul(a, a), s.determinant), lanes_mul(beside, beside));
    Lanes rise = lanes_greater(lanes_add(lanes_all(1), cosine), lanes_all(1e-7f));
    Lanes square = lanes_div(lanes_add(up, up), lanes_mul(lanes_mul(rise, length), lanes_mul(s.xx, s.determinant)));
    Lanes wider2 = lanes_mul(s.tail_wider, s.tail_wider), fall = lanes_add(wider2, lanes_scale(square, 0.25f));
    Lanes disc = lanes_select_less(square, lanes_all(DISC * DISC), lanes_all(DISC_PART / (DISC * DISC)), none);
    /* the tail's: over wider^2 (1 + r^2 / 4)^3, r in its own spreads */
    const float tail_scale = (1 - DISC_PART) / (2 * (1 - 1 / (TAIL * TAIL)));
    Lanes tail = lanes_div(lanes_scale(lanes_mul(wider2, wider2), tail_scale), lanes_mul(fall, lanes_mul(fall, fall)));
    tail = lanes_select_less(square, lanes_scale(wider2, REACH * REACH), tail, none);
    Lanes area = lanes_scale(lanes_sqrt(s.determinant), SAMPLING_PI);
    return lanes_mul(weight, lanes_div(lanes_add(disc, tail), area));
}

/* How much each lobe of a cell counts at a place: parts->nearness. */
static void weigh_lobes(const GuideFour *fours, uint32_t n, GuidePlace place, CellParts *parts)
{
    look_at_fours(fours, 0, n, place, parts);
    for (uint32_t i = n; i % LANES != 0; i++) parts->nearness[i] = 0;
    for (uint32_t first = 0, n_sheet; first < n; first += n_sheet) {
        n_sheet = fours[first / LANES].n_sheet[first % LANES];
        float scale = fours[first / LANES].weight[first % LANES] / choose_near(parts->nearness + first, n_sheet);
        for (uint32_t k = first; k < first + n_sheet; k++) parts->nearness[k] *= scale;
    }
}

float guide_lobes_pdf(const GuideFour *fours, uint32_t n, GuidePlace place, Vec3f direction)
{
    CellParts parts;
    Lanes sum = lanes_all(0);
    weigh_lobes(fours, n, place, &parts);
    for (uint32_t i = 0; i < n; i += LANES) {
        Lanes weight = lanes_load(parts.nearness + i);
        if (lanes_zero(weight)) continue;
        sum = lanes_add(sum, densities(&fours[i / LANES], weight, lanes_load(parts.error + i), place, direction));
    }
    return lanes_sum(sum);
}

static void add_lead(Leads *leads, uint32_t turns, float density)
{
    uint32_t i = 0;
    leads->all += density;
    if (turns != TURNS_UNTOLD)
        while (i < leads->n && leads->turns[i] != turns) i++;
    if (turns == TURNS_UNTOLD || i == LEADS) {
        leads->unled += density;
        return;
    }
    leads->unled += (1 - LED_PART) * density;
    if (i == leads->n) leads->turns[leads->n] = turns, leads->density[leads->n++] = 0;
    leads->density[i] += LED_PART * density;
}

void guide_lobes_leads(const GuideFour *fours, uint32_t n, GuidePlace place, Vec3f direction, Leads *leads)
{
    CellParts parts;
    *leads = (Leads){.n = 0};
    weigh_lobes(fours, n, place, &parts);
    for (uint32_t i = 0; i < n; i += LANES) {
        Lanes weight = lanes_load(parts.nearness + i);
        if (lanes_zero(weight)) continue;
        float density[LANES];
        lanes_store(densities(&fours[i / LANES], weight, lanes_load(parts.error + i), place, direction), density);
        for (int lane = 0; lane < LANES; lane++)
            if (density[lane] > 0) add_lead(leads, fours[i / LANES].turns[lane], density[lane]);
    }
}

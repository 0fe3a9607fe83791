/* light_density_test.c - every kind of light as light_sample draws it, against the densities that light_pdf_hit and
 * light_from_infinity say: Pearson's chi-square over bins of direction, and each sample's own density.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "near.h"
#include "scene_fixture.h"
#include "trace/light.h"

static const double pi = 3.14159265358979323846;

/* What the lights are seen in: a cone of directions, with bins even in solid angle. */
enum { ROWS = 12, COLUMNS = 24, FINE = 24, SAMPLES = 120000 };
typedef struct Bins {
    Vec3 x, y, axis;
    double cap; /* 1 - cos of the half angle */
} Bins;

static Bins bins_about(Vec3 from, Vec3 to, double half_angle)
{
    Bins bins = {.axis = vec3_normalize(vec3_sub(to, from)), .cap = 1 - cos(half_angle)};
    Vec3 other = fabs(bins.axis.x) < 0.5 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    bins.x = vec3_normalize(vec3_cross(other, bins.axis));
    bins.y = vec3_cross(bins.axis, bins.x);
    return bins;
}

static Vec3f direction_in(const Bins *bins, double row, double column)
{
    double cosine = 1 - bins->cap * row / ROWS, sine = sqrt(fmax(1 - cosine * cosine, 0)),
           turn = 2 * pi * column / COLUMNS;
    Vec3 d =
        vec3_along(vec3_along(vec3_scale(bins->axis, cosine), sine * cos(turn), bins->x), sine * sin(turn), bins->y);
    return vec3f_from(vec3_normalize(d));
}

static int bin_of(const Bins *bins, Vec3f direction)
{
    Vec3 d = vec3_from_f(direction);
    double x = vec3_dot(d, bins->x), y = vec3_dot(d, bins->y), along = vec3_dot(d, bins->axis), square = x * x + y * y;
    double height = along > 0 ? square / (1 + along) : 1 - along; /* 1 - cos, precise for small angles */
    double turn = atan2(y, x) / (2 * pi);
    int row = (int)(height / bins->cap * ROWS), column = (int)((turn < 0 ? turn + 1 : turn) * COLUMNS);
    if (row < 0 || row >= ROWS) return -1;
    return row * COLUMNS + (column < COLUMNS ? column : COLUMNS - 1);
}

/* ---- densities ---- */

static Lanes some_wavelengths(void)
{
    return lanes(450, 520, 590, 650);
}

/* What light_from_infinity weighs light with, found from the weight: w / (w + pdf). */
static double density_outside(const World *world, Vec3 from, Vec3f normal, Vec3f direction)
{
    const LightRival none = {world_lights(world), from, normal, -1}, one = {world_lights(world), from, normal, 1};
    Lanes all = light_from_infinity(world, &none, direction, false, LIGHT_GROUPS_ALL, some_wavelengths());
    Lanes weighted = light_from_infinity(world, &one, direction, false, LIGHT_GROUPS_ALL, some_wavelengths());
    if (lanes_zero(all)) return 0;
    return (double)lanes_get(all, 0) / (double)lanes_get(weighted, 0) - 1;
}

/* Towards the rim of what is round, the density per steradian grows beyond bounds, and no quadrature finds all of it: what
 * is seen under less than this cosine is left out, of the densities and of the samples. */
static const double grazing = 0.05;

/* Of everything in a direction, whether something else hides it or not. */
static double density_at(const World *world, Vec3 from, Vec3f normal, Vec3f direction, double time, HitList *hits)
{
    Ray ray = ray_make(from, direction);
    ray.time = time;
    rtc_all(world->compiled->rtc, &ray, false, hits);
    double sum = density_outside(world, from, normal, direction);
    for (size_t i = 0; i < hits->n; i++) {
        Lanes radiance;
        if (fabs(hits->items[i].cos_normal) > grazing &&
            light_radiance_hit(world, &ray, &hits->items[i], 0, some_wavelengths(), &radiance))
            sum += (double)light_pdf_hit(world, world_lights(world), from, normal, &ray, &hits->items[i]);
    }
    return sum;
}

typedef enum Verdict { AS_EVALUATED, NOT_SO, GRAZING } Verdict;

/* The density that a sample says, against that of the place it is aimed at. */
static Verdict judge(const World *world, Vec3 from, Vec3f normal, const LightSample *sample, double time, HitList *hits)
{
    double best = HUGE_VAL, cosine = 1;
    if (isinf(sample->distance)) {
        best = density_outside(world, from, normal, sample->direction) / (double)sample->pdf_w - 1;
    } else {
        Ray ray = ray_make(from, sample->direction);
        ray.time = time;
        rtc_all(world->compiled->rtc, &ray, false, hits);
        for (size_t i = 0; i < hits->n; i++) {
            const Hit *hit = &hits->items[i];
            if (sample->object != RTC_NO_OBJECT && hit->object != sample->object) continue;
            if (sample->primitive != RTC_NO_OBJECT && hit->primitive != sample->primitive) continue;
            double off =
                (double)light_pdf_hit(world, world_lights(world), from, normal, &ray, hit) / (double)sample->pdf_w - 1;
            if (fabs(off) >= fabs(best)) continue;
            best = off;
            cosine = fabs(hit->cos_normal);
        }
    }
    return cosine <= grazing ? GRAZING : fabs(best) < 0.01 ? AS_EVALUATED : NOT_SO;
}

/* ---- the test ---- */

typedef struct Case {
    const char *what, *scene;
    Vec3 from;
    Vec3f normal;
    Vec3 towards; /* the middle of the bins */
    double half_angle;
    double least; /* of samples that lead somewhere */
} Case;

static Status load_picture(void *context, const char *path, const char *space, float **rgb, uint32_t *width,
                           uint32_t *height, Error *error)
{
    (void)context;
    (void)path;
    (void)space;
    *width = 32;
    *height = 16;
    *rgb = malloc(32 * 16 * 3 * sizeof **rgb);
    if (!*rgb) return fail_memory(error, 1, "a picture");
    for (uint32_t i = 0; i < 32 * 16; i++)
        for (uint32_t c = 0; c < 3; c++)
            (*rgb)[3 * i + c] = (float)(i % 7 == 3 ? 20 : 1 + i % 5) * (1 + 0.2f * (float)c);
    return STATUS_OK;
}

/* Of the bins: what the densities come to, with the variance of the quadrature, and how many samples fell there. */
typedef struct Table {
    double expected[ROWS * COLUMNS], uncertain[ROWS * COLUMNS];
    int counted[ROWS * COLUMNS];
    double inside, inside_variance; /* sums of the first two */
    int n_good, n_beside, n_odd;    /* samples: with a density, of those outside of all bins, with another density */
} Table;

static void integrate(const World *world, const Case *c, const Bins *bins, Dice *dice, Table *table)
{
    HitList hits = {0};
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        double sum = 0, last = 0, squares = 0;
        for (int k = 0; k < FINE * FINE; k++) {
            double row = i / COLUMNS + (k / FINE + dice_unit(dice)) / FINE,
                   column = i % COLUMNS + (k % FINE + dice_unit(dice)) / FINE;
            double density = density_at(world, c->from, c->normal, direction_in(bins, row, column), 0, &hits);
            sum += density;
            if (k % FINE) squares += 0.5 * pow(density - last, 2); /* from one stratum to the next */
            last = density;
        }
        const double n = FINE * FINE, solid_angle = 2 * pi * bins->cap / (ROWS * COLUMNS);
        table->expected[i] = sum / n * solid_angle;
        table->uncertain[i] = squares / (FINE * (FINE - 1)) / n * solid_angle * solid_angle;
        table->inside += table->expected[i];
        table->inside_variance += table->uncertain[i];
    }
    hit_list_clear(&hits);
}

static void draw(const World *world, const Case *c, const Bins *bins, Dice *dice, Table *table)
{
    HitList hits = {0};
    for (int i = 0; i < SAMPLES; i++) {
        LightQuery query = {.from = c->from, .normal = c->normal, .wavelength_nm = some_wavelengths()};
        for (int k = 0; k < 2; k++) query.u[k] = (float)fmin(dice_unit(dice), 1 - 0x1p-24);
        query.rest = dice_unit(dice);
        LightSample sample;
        light_sample(world, world_lights(world), &query, &sample);
        if (!(sample.pdf_w > 0)) continue;
        assert_false(sample.delta);
        assert_near((double)vec3f_length(sample.direction), 1, 1e-6);
        Verdict verdict = judge(world, c->from, c->normal, &sample, 0, &hits);
        if (verdict == GRAZING) continue;
        table->n_good++;
        table->n_odd += verdict == NOT_SO;
        int bin = bin_of(bins, sample.direction);
        if (bin < 0)
            table->n_beside++;
        else
            table->counted[bin]++;
    }
    hit_list_clear(&hits);
}

/* What is expected in few samples makes up one bin together. */
static double chi_square(const Table *table, double *n_bins)
{
    double chi = 0, rest_expected = 0, rest_uncertain = 0, rest_counted = 0;
    *n_bins = 0;
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        double mean = table->expected[i] * SAMPLES, uncertain = table->uncertain[i] * SAMPLES * SAMPLES;
        if (mean < 8) {
            rest_expected += mean;
            rest_uncertain += uncertain;
            rest_counted += table->counted[i];
            continue;
        }
        chi += pow(table->counted[i] - mean, 2) / (mean + uncertain);
        ++*n_bins;
    }
    if (rest_expected <= 8) return chi;
    ++*n_bins;
    return chi + pow(rest_counted - rest_expected, 2) / (rest_expected + rest_uncertain);
}

static void run_case(const Case *c)
{
    static Table table;
    char text[2000];
    Fixture f;
    snprintf(text, sizeof text, "meniscus 1.0 unit mm camera { from = <0, 0, 900>  to = <0, 0, 0> }\n%s\n", c->scene);
    SceneOptions options = {.eval = {.frames = 1, .frame = 1}, .load_image = load_picture};
    fixture_build(&f, text, &options);
    if (f.status != STATUS_OK) fixture_print(&f);
    assert_int_equal(f.status, STATUS_OK);
    assert_int_equal(compile_scene(f.scene, f.scene->render.nesting, NULL, &f.diag, &f.compiled, &f.error), STATUS_OK);
    World world;
    assert_int_equal(world_init(&world, f.compiled, 0, 8, false, NULL, &f.error), STATUS_OK);
    Bins bins = bins_about(c->from, c->towards, c->half_angle);
    Dice dice = {11};
    table = (Table){.n_good = 0};
    integrate(&world, c, &bins, &dice, &table);
    draw(&world, c, &bins, &dice, &table);
    double n_bins, chi = chi_square(&table, &n_bins), n_inside = table.n_good - table.n_beside;
    if (!(n_bins > 0)) { /* nothing is sampled, and nothing has a density */
        assert_int_equal(table.n_good, 0);
        assert_true(c->least <= 0);
        n_bins = 1;
    }
    double z = (cbrt(chi / n_bins) - (1 - 2 / (9 * n_bins))) / sqrt(2 / (9 * n_bins)); /* Wilson and Hilferty */
    printf("%-42s chi-square %6.1f over %3.0f bins, %5.2f standard deviations; density %.4f, samples %.4f\n", c->what,
           chi, n_bins, z, table.inside, n_inside / SAMPLES);
    assert_true(z < 4);
    assert_true(table.n_odd <= 0.002 * table.n_good); /* at edges, which rounding of the direction may miss */
    assert_true((double)table.n_good / SAMPLES >= c->least);
    assert_near(table.inside, n_inside / SAMPLES, 4 * sqrt(table.inside_variance + 0.25 / SAMPLES));
    world_clear(&world);
    fixture_clear(&f);
}

#define GLOW "surface = surface { albedo = 0  emission = 1  radiance = 2 }"
#define ORIGIN                                                                                                         \
    {                                                                                                                  \
        0, 0, 0                                                                                                        \
    }
/* the normal: where light may come from */
#define UP                                                                                                             \
    {                                                                                                                  \
        0, 1, 0                                                                                                        \
    }
#define ANYWHERE                                                                                                       \
    {                                                                                                                  \
        0, 0, 0                                                                                                        \
    }

static const Case lamps[] = {
    {"quad", "light { from = <3, 20, 0>  to = <0, 0, 4>  size = <30, 12> }", ORIGIN, UP, {3, 20, 0}, 1.0, 0.99},
    {"quad, near and aslant",
     "light { from = <3, 2, 0>  to = <-9, 0, 4>  size = <3, 12> }",
     ORIGIN,
     UP,
     {3, 2, 0},
     1.6,
     0.4},
    {"disc",
     "light { shape = disc  from = <-3, 20, 0>  to = <0, 0, 4>  radius = 9 }",
     ORIGIN,
     UP,
     {-3, 20, 0},
     0.6,
     0.99},
    {"quad into a cone",
     "light { from = <3, 20, 0>  to = <3, 0, 2>  size = <50, 40>  angle = 50 }",
     ORIGIN,
     UP,
     {0, 20, -2},
     0.6,
     0.7},
    {"disc into a cone, seen at its border",
     "light { shape = disc  from = <8, 20, 0>  to = <8, 0, 4>  radius = 9  angle = 30  blend = 1 }",
     ORIGIN,
     UP,
     {2, 20, -4},
     0.4,
     0.3},
    {"sphere", "light { shape = sphere  from = <4, 20, 1>  radius = 9 }", ORIGIN, UP, {4, 20, 1}, 0.5, 0.99},
    {"sphere, far",
     "light { shape = sphere  from = <4, 20000, 1>  radius = 9 }",
     ORIGIN,
     UP,
     {4, 20000, 1},
     6e-4,
     0.99},
    {"sphere, its surface very near",
     "light { shape = sphere  from = <0, 10, 0>  radius = 9.99 }",
     ORIGIN,
     UP,
     {0, 10, 0},
     1.6,
     0.97},
    {"distant, wide",
     "light { shape = distant  from = <4, 9, 2>  to = <0, 0, 0>  angle = 70deg }",
     ORIGIN,
     UP,
     {4, 9, 2},
     0.7,
     0.99},
    {"distant, the sun",
     "light { shape = distant  from = <4, 9, 2>  to = <0, 0, 0> }",
     ORIGIN,
     UP,
     {4, 9, 2},
     0.006,
     0.99},
    {"three lights, in a medium",
     "light { from = <3, 20, 0>  to = <0, 0, 4>  size = <30, 12> } light { shape = disc  from = <-30, 3, 0>  to = "
     "<0, 0, 4>  radius = 9  radiance = 3 } light { shape = sphere  from = <4, -20, 9>  radius = 5 }",
     ORIGIN,
     ANYWHERE,
     {1, 0, 0},
     3.14159,
     0.99}};

static void lights(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(lamps); i++) run_case(&lamps[i]);
}

/* Every kind of a solid's pieces, and meshes; turned, stretched and mirrored. */
static const Case shining[] = {
    {"ball", "sphere { center = <4, 20, 1>  radius = 9 " GLOW " }", ORIGIN, UP, {4, 20, 1}, 0.5, 0.99},
    {"ball, mirrored",
     "sphere { radius = 1  scale(<9, -9, 9>)  translate(<4, 20, 1>) " GLOW " }",
     ORIGIN,
     UP,
     {4, 20, 1},
     0.5,
     0.99},
    {"ball from inside: found by chance", "sphere { radius = 50 " GLOW " }", ORIGIN, UP, {4, 20, 1}, 3.14159, 0},
    {"ellipsoid",
     "ellipsoid { center = <5, 18, 3>  radii = <12, 3, 6>  rotate(z, 30deg) " GLOW " }",
     ORIGIN,
     ANYWHERE,
     {0, 18, 3},
     1.2,
     0.3},
    {"box", "box { from = <-5, 9, -5>  to = <5, 12, 9>  rotate(y, 20deg) " GLOW " }", ORIGIN, UP, {0, 10, 1}, 1.0, 0.2},
    {"box, mirrored and stretched",
     "box { from = <-5, 9, -5>  to = <5, 12, 9>  scale(<-2, 1, .5>) " GLOW " }",
     ORIGIN,
     UP,
     {0, 10, 1},
     1.2,
     0.2},
    {"cylinder, aslant",
     "cylinder { from = <-10, 12, 4>  to = <12, 20, -3>  radius = 3 " GLOW " }",
     ORIGIN,
     UP,
     {1, 16, 0},
     1.0,
     0.2},
    {"cone, stretched",
     "cone { from = <0, 9, 0>  to = <4, 25, 4>  radius_from = 8  radius_to = 2  scale(<1, 1, .4>) " GLOW " }",
     ORIGIN,
     ANYWHERE,
     {1, 12, 0},
     1.0,
     0.2},
    {"torus",
     "torus { radius = 8  tube = 3  rotate(x, 70deg)  translate(<3, 14, -4>) " GLOW " }",
     ORIGIN,
     UP,
     {3, 14, -4},
     1.3,
     0.2},
    {"lathe with arcs",
     "lathe { profile = [<0, 20>, <12, 12>, <11, 10>, <0, 17>]  rounding = [0, .5, .4, 0] " GLOW " }",
     ORIGIN,
     UP,
     {0, 15, 0},
     1.2,
     0.2},
    {"a mesh of eight triangles",
     "mesh { positions = [<9, 20, 0>, <-9, 20, 0>, <0, 29, 0>, <0, 11, 0>, <0, 20, 9>, <0, 20, -9>]  triangles = "
     "[<0, 2, 4>, <2, 1, 4>, <1, 3, 4>, <3, 0, 4>, <2, 0, 5>, <1, 2, 5>, <3, 1, 5>, <0, 3, 5>] " GLOW " }",
     ORIGIN,
     UP,
     {0, 20, 0},
     0.7,
     0.3},
    {"an open sheet, from behind",
     "mesh { positions = [<-15, 20, -6>, <15, 20, -6>, <15, 22, 6>]  triangles = [<0, 1, 2>] " GLOW " }",
     ORIGIN,
     UP,
     {3, 20, -2},
     0.9,
     0.99},
    {"many tubes",
     "sweep { outline = [for (i in 0..<8) <1.5 * cos(45 * i), 1.5 * sin(45 * i)>]\n"
     "path = [for (i in 0..24) <7 * cos(30 * i), 10 + .5 * i, 7 * sin(30 * i)>] " GLOW " }",
     ORIGIN,
     UP,
     {0, 16, 0},
     0.9,
     0.4},
    {"surfaces, lights and a sky",
     "sphere { center = <4, 20, 1>  radius = 4 " GLOW " } box { from = <-9, 9, -9>  to = <-5, 12, -3> " GLOW " }\n"
     "light { from = <9, 8, 0>  to = <0, 0, 4>  size = <6, 6> } environment { }",
     ORIGIN,
     ANYWHERE,
     {0, 1, 0},
     3.14159,
     0.7}};

/* Of the whole surfaces of operands, what of them is buried, too. */
static const Case cut[] = {
    {"half a ball",
     "difference { sphere { center = <4, 20, 1>  radius = 9 } box { from = <-9, 20, -9>  to = <20, 40, 20> " GLOW
     " } }",
     ORIGIN,
     UP,
     {4, 20, 1},
     0.6,
     0.4},
    {"a bowl, of which the inside shines",
     "difference { sphere { center = <4, 20, 1>  radius = 9 } sphere { center = <4, 18, 1>  radius = 9 " GLOW
     " } surface = surface { } }",
     ORIGIN,
     UP,
     {4, 20, 1},
     0.6,
     0.2},
    {"a bowl of triangles, mirrored",
     "difference { box { from = <-9, 9, -5>  to = <5, 14, 9> } prism { outline = [<-5, -5>, <5, -4>, <4, 8>]  from = 8 "
     " to "
     "= 12 " GLOW " } surface = surface { }  scale(<-1, 1, 1>) }",
     ORIGIN,
     UP,
     {0, 10, 1},
     1.0,
     0.2},
    {"a cylinder that is taken out, of pieces",
     "difference { box { from = <-9, 9, -5>  to = <5, 14, 9> } cylinder { from = <0, 8, 0>  to = <1, 12, 2>  radius = "
     "4 " GLOW " } surface = surface { } }",
     ORIGIN,
     ANYWHERE,
     {0, 10, 1},
     1.0,
     0.2},
    {"two balls and a lamp",
     "union { sphere { center = <4, 20, 1>  radius = 4 } sphere { center = <9, 20, 1>  radius = 6 } " GLOW " }\n"
     "light { from = <9, 8, 0>  to = <0, 0, 4>  size = <6, 6> }",
     ORIGIN,
     UP,
     {5, 20, 1},
     1.2,
     0.9}};

static void operands_that_shine(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cut); i++) run_case(&cut[i]);
}

/* Every kind again, bright in a part alone. */
#define SPOT "def spot(p) = p.x > .3 * p.z + 1 ? 3 : .02\n"
#define SPOTTED "surface = surface { albedo = 0  emission = spot  radiance = 2 }"
static const Case spotted[] = {
    {"ball with a spot",
     "def cap(p) = p.x - p.y > 9 ? 3 : 0\n"
     "sphere { radius = 9  surface = surface { emission = cap  radiance = 2 }  translate(<4, 20, 1>) }",
     ORIGIN,
     UP,
     {4, 20, 1},
     0.5,
     0.3},
    {"ellipsoid with a spot",
     SPOT "ellipsoid { radii = <12, 3, 6>  " SPOTTED "  rotate(z, 30deg)  translate(<5, 18, 3>) }",
     ORIGIN,
     ANYWHERE,
     {0, 18, 3},
     1.2,
     0.2},
    {"box with bright parts",
     SPOT "box { from = <-5, 9, -5>  to = <5, 12, 9>  " SPOTTED " }",
     ORIGIN,
     UP,
     {0, 10, 1},
     1.0,
     0.2},
    {"cylinder with bright parts",
     SPOT "cylinder { from = <-10, 12, 4>  to = <12, 20, -3>  radius = 3  " SPOTTED " }",
     ORIGIN,
     UP,
     {1, 16, 0},
     1.0,
     0.2},
    {"cone with bright parts, stretched",
     SPOT "cone { from = <0, 9, 0>  to = <4, 25, 4>  radius_from = 8  radius_to = 2  " SPOTTED "  scale(<1, 1, .4>) }",
     ORIGIN,
     ANYWHERE,
     {1, 12, 0},
     1.0,
     0.2},
    {"torus with bright parts",
     SPOT "torus { radius = 8  tube = 3  " SPOTTED "  rotate(x, 70deg)  translate(<3, 14, -4>) }",
     ORIGIN,
     UP,
     {3, 14, -4},
     1.3,
     0.2},
    {"torus that reaches over its axis",
     SPOT "torus { radius = 3  tube = 5  " SPOTTED "  rotate(x, 70deg)  translate(<3, 14, -4>) }",
     ORIGIN,
     UP,
     {3, 14, -4},
     1.3,
     0.05},
    {"lathe with arcs, with bright parts",
     SPOT "lathe { profile = [<0, 20>, <12, 12>, <11, 10>, <0, 17>]  rounding = [0, .5, .4, 0]  " SPOTTED " }",
     ORIGIN,
     UP,
     {0, 15, 0},
     1.2,
     0.2},
    {"an open sheet with a spot, from behind",
     SPOT "mesh { positions = [<-15, 20, -6>, <15, 20, -6>, <15, 22, 6>]  triangles = [<0, 1, 2>]  " SPOTTED " }",
     ORIGIN,
     UP,
     {3, 20, -2},
     0.9,
     0.9},
    {"a bowl with a spot inside",
     SPOT "difference { sphere { center = <4, 20, 1>  radius = 9 } sphere { center = <4, 18, 1>  radius = 9  " SPOTTED
          " } surface = surface { } }",
     ORIGIN,
     UP,
     {4, 20, 1},
     0.6,
     0.2}};

static void textures_that_shine(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(spotted); i++) run_case(&spotted[i]);
}

static void surfaces_that_shine(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(shining); i++) run_case(&shining[i]);
}

#define WINDOW(z) "light { shape = portal  from = <30, 20, " z ">  to = <0, 20, 0>  size = <20, 30> }"

static const Case skies[] = {
    {"the same from everywhere: left to chance", "environment { color = 2 }", ORIGIN, UP, {0, 1, 0}, 3.14159, 0},
    {"an image, turned",
     "environment { image = \"" __FILE__ "\"  rotate(x, 40deg)  rotate(y, 70deg) }",
     ORIGIN,
     UP,
     {0, 1, 0},
     3.14159,
     0.99},
    {"a sky", "environment { sky = clear  disc = false }", ORIGIN, UP, {0, 1, 0}, 3.14159, 0.99},
    {"an overcast sky", "environment { sky = overcast }", ORIGIN, UP, {0, 1, 0}, 3.14159, 0.99},
    {"through a window", "environment { color = 2 } " WINDOW("0"), ORIGIN, ANYWHERE, {30, 20, 0}, 0.6, 0.99},
    {"through a window, beyond it too",
     "environment { color = 2 } " WINDOW("0"),
     ORIGIN,
     ANYWHERE,
     {30, 20, 0},
     3.14159,
     0.99},
    {"through a window, an image",
     "environment { image = \"" __FILE__ "\"  rotate(x, 40deg) } " WINDOW("0"),
     ORIGIN,
     UP,
     {30, 20, 0},
     0.6,
     0.99},
    {"through a window, a sky",
     "environment { sky = clear  disc = false  azimuth = 70deg } " WINDOW("0"),
     ORIGIN,
     UP,
     {30, 20, 0},
     0.6,
     0.99},
    {"two windows, side by side",
     "environment { color = 2 } " WINDOW("-12") WINDOW("12"),
     ORIGIN,
     UP,
     {30, 20, 0},
     0.9,
     0.99},
    {"windows of two walls, that overlap",
     "environment { image = \"" __FILE__ "\" } " WINDOW("-4")
         WINDOW("4") "light { shape = portal  from = <0, 20, 30>  to = <0, 20, 0>  size = <20, 30> }",
     ORIGIN,
     UP,
     {30, 20, 20},
     1.2,
     0.99},
    {"very near to a window",
     "environment { color = 2 } " WINDOW("0"),
     {29.9, 20, 3},
     ANYWHERE,
     {30, 20, 0},
     1.6,
     0.99},
    {"a window behind the surface",
     "environment { color = 2 } " WINDOW("0"),
     {0, 90, 0},
     UP,
     {0, 200, 0},
     3.14159,
     0.99},
    {"from outside of a window",
     "environment { color = 2 } " WINDOW("0"),
     {60, 20, 0},
     ANYWHERE,
     {30, 20, 0},
     3.14159,
     0.99},
    {"a window far away",
     "environment { color = 2 } " WINDOW("0"),
     {-60000, 20, 0},
     ANYWHERE,
     {30, 20, 0},
     4e-4,
     0.99}};

static void outside(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(skies); i++) run_case(&skies[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lights), cmocka_unit_test(surfaces_that_shine),
                                       cmocka_unit_test(operands_that_shine), cmocka_unit_test(textures_that_shine),
                                       cmocka_unit_test(outside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

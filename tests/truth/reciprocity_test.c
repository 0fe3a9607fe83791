/* reciprocity_test.c - the boundaries along a line are the same from both of its ends, under `automatic` and `priority`;
 * under `entered` they need not be ([WR19] lists it as a limitation). Straight lines through compiled scenes, with the
 * renderer's own search for surfaces and its own crossings, but no bending.
 * SPDX-License-Identifier: Apache-2.0 */
#include "arrangements.h"
#include "base/hash.h"
#include "truth.h"

enum { LINES = 100000, MOST = 512 };

typedef struct Boundary {
    double t;
    uint32_t from, to; /* media */
} Boundary;

typedef struct Walk {
    Boundary boundaries[MOST];
    size_t n;
    uint64_t crossings, silent, faults;
} Walk;

static HitList hits;

/* Crosses what stands at one place; returns whether that is a boundary. */
static bool cross(const CompiledScene *compiled, NestList *list, size_t n, Walk *walk, NestCrossing *crossing)
{
    NestPass passes[64];
    assert_true(n <= COUNT_OF(passes));
    for (size_t i = 0; i < n; i++)
        passes[i] = (NestPass){compiled->hull_of_object[hits.items[i].object], hits.items[i].entering};
    assert_int_equal(nest_cross(list, &compiled->order, passes, (uint32_t)n, crossing), STATUS_OK);
    walk->crossings += n;
    walk->faults += crossing->n_faults;
    return crossing->medium_from != crossing->medium_to;
}

/* From outside of everything that has an end, through the whole scene. */
static void walk_line(const CompiledScene *compiled, Vec3 origin, Vec3f direction, double length, Walk *walk)
{
    Ray ray = ray_make(origin, direction);
    NestList list;
    NestCrossing crossing;
    nest_list_init(&list);
    if (compiled->n_planes)
        assert_int_equal(compiled_interior(compiled, vec3f_from(origin), 0, &hits, &list, NULL), STATUS_OK);
    ray.t_max = length;
    walk->n = 0;
    for (size_t n; (n = rtc_nearest(compiled->rtc, &ray, &hits, NULL)) > 0; ray.t_min = hits.items[n - 1].t) {
        if (!cross(compiled, &list, n, walk, &crossing)) {
            walk->silent++;
            continue;
        }
        assert_true(walk->n < MOST);
        walk->boundaries[walk->n++] = (Boundary){hits.items[0].t, crossing.medium_from, crossing.medium_to};
    }
    if (compiled_bounded_in(compiled, &list)) walk->faults++; /* what was entered was left */
    nest_list_clear(&list);
}

static bool same_backwards(const Walk *there, const Walk *back, double length, double slack)
{
    if (there->n != back->n) return false;
    for (size_t i = 0; i < there->n; i++) {
        const Boundary *a = &there->boundaries[i], *b = &back->boundaries[there->n - 1 - i];
        if (a->from != b->to || a->to != b->from || fabs(a->t + b->t - length) > slack) return false;
    }
    return true;
}

/* A point on the sphere of this radius about the scene, and a direction from it to another such point. */
static void random_line(uint32_t i, Vec3 middle, double radius, Vec3 *from, Vec3f *direction, double *length)
{
    Vec3 end[2];
    for (uint32_t k = 0; k < 2; k++) {
        double z = 2 * (double)hash_to_unit_f(hash_combine(hash_combine(17, i), 2 * k)) - 1;
        double angle = 2 * TRUTH_PI * (double)hash_to_unit_f(hash_combine(hash_combine(17, i), 2 * k + 1));
        double r = sqrt(1 - z * z);
        end[k] = vec3_along(middle, radius, vec3(r * cos(angle), r * sin(angle), z));
    }
    Vec3 along = vec3_sub(end[1], end[0]);
    *length = vec3_length(along);
    *direction = vec3f_from(vec3_scale(along, 1 / *length));
    *from = end[0];
}

typedef struct Outcome {
    uint32_t lines, differ; /* of lines that meet a boundary */
    FaultCount faults;
} Outcome;

static Outcome walk_lines(const Fixture *scene)
{
    static Walk there, back;
    const CompiledScene *compiled = scene->compiled;
    Box3 bounds = rtc_scene_bounds(compiled->rtc);
    Vec3 middle = vec3_scale(vec3_add(bounds.min, bounds.max), 0.5);
    double radius = 0.51 * vec3_length(vec3_sub(bounds.max, bounds.min));
    Outcome outcome = {0};
    there = back = (Walk){0};
    for (uint32_t i = 0; i < LINES; i++) {
        Vec3 from;
        Vec3f direction;
        double length;
        random_line(i, middle, radius, &from, &direction, &length);
        walk_line(compiled, from, direction, length, &there);
        walk_line(compiled, vec3_along(from, length, vec3_from_f(direction)), vec3f_negate(direction), length, &back);
        if (!there.n && !back.n) continue;
        outcome.lines++;
        outcome.differ += !same_backwards(&there, &back, length, 1e-4 * radius);
    }
    outcome.faults =
        (FaultCount){there.crossings + back.crossings, there.silent + back.silent, there.faults + back.faults};
    return outcome;
}

static Outcome ranked, entered;

static void check(const Arrangement *arrangement, const char *fit, NestPolicy policy)
{
    char what[120];
    const char *defines[] = {fit, NULL};
    Fixture scene;
    TruthInput input = {.text = arrangement->text, .defines = fit ? defines : NULL, .policy = policy, .furnace = true};
    truth_open(&scene, input);
    Outcome outcome = walk_lines(&scene);
    fixture_clear(&scene);
    snprintf(what, sizeof what, "%s%s%s, %s", arrangement->name, fit ? ", " : "", fit ? fit : "",
             nest_policy_text(policy));
    printf("  %-58s %u of %u lines differ from the other end\n", what, outcome.differ, outcome.lines);
    Outcome *sum = policy == NEST_ENTERED ? &entered : &ranked;
    sum->differ += outcome.differ;
    sum->lines += outcome.lines;
    truth_add(&sum->faults, &outcome.faults);
}

static void lines_are_the_same_from_both_ends(void **state)
{
    (void)state;
    static const NestPolicy policies[] = {NEST_AUTOMATIC, NEST_PRIORITY, NEST_ENTERED};
    for (size_t i = 0; i < COUNT_OF(arrangements); i++)
        for (size_t k = 0; k < (arrangements[i].fits ? COUNT_OF(arrangement_fits) : 1); k++)
            for (size_t p = 0; p < COUNT_OF(policies); p++)
                check(&arrangements[i], arrangements[i].fits ? arrangement_fits[k] : NULL, policies[p]);
    hit_list_clear(&hits);
    printf("  %u of %u lines differ under automatic and priority, %u of %u under entered\n", ranked.differ,
           ranked.lines, entered.differ, entered.lines);
    truth_print_faults("lines under automatic and priority", &ranked.faults);
    truth_print_faults("lines under entered", &entered.faults);
    assert_int_equal(ranked.differ, 0);
    assert_true(entered.differ > 0);
    assert_int_equal(ranked.faults.faults + entered.faults.faults, 0);
}

/* ---- surfaces ---- */

#define SLAB(medium, z0, z1, more)                                                                                     \
    "box { interior = " medium "  from = <-500, -500, " z0 ">  to = <500, 500, " z1 ">  " more " }\n"
#define PART(z0, z1, more) "box { from = <-500, -500, " z0 ">  to = <500, 500, " z1 ">  " more " }\n"
#define COATED "surface = surface { film = 120nm  film_ior = 2.4 }"
#define PAINTED(part) "surface = surface { albedo = 0  transmission = " part " }"
#define STATED "priority = 1"

/* What comes straight through slabs that one looks at from an end. */
static Estimate seen_from(const char *slabs, int end)
{
    char text[2000];
    snprintf(text, sizeof text,
             "meniscus 1.0 unit mm\nmedium a { ior = 1.5  state = solid } medium b { ior = 1.33  state = liquid }\n"
             "medium c { ior = 1.7 } medium d { ior = 2  state = gas } medium smoke { mixes = true }\n%s"
             "def f(p) = p.z * %d < 0 ? 1 : 0\nenvironment { function = f }\n"
             "camera { from = <0, 0, %d>  to = <0, 0, 0>  fov = .01 }\n",
             slabs, end, 40 * end);
    return truth_measure(text, NULL, 256, false);
}

/* Where faces are at one place, the film on one of them is there from both ends, or from neither: as if the slabs overlapped by a
 * little, and the one on top had its own face there. */
static void surfaces_are_the_same_from_both_ends(void **state)
{
    (void)state;
    static const struct {
        const char *what, *coincident, *overlapping;
    } cases[] = {
        {"a coated slab on a thicker one", SLAB("a", "0", "5", COATED) SLAB("c", "-10", "0", ""),
         SLAB("a", "0", "5", COATED) SLAB("c", "-10", ".001", "")},
        {"a slab on a thicker one that is coated", SLAB("a", "0", "5", "") SLAB("c", "-10", "0", COATED),
         SLAB("a", "0", "5", "") SLAB("c", "-10", ".001", COATED)},
        {"water on coated glass, by state of matter", SLAB("a", "-10", "0", COATED) SLAB("b", "0", "5", ""),
         SLAB("a", "-10", "0", COATED) SLAB("b", "-.001", "5", "")},
        {"the same in smoke", SLAB("smoke", "-20", "20", "") SLAB("a", "0", "5", "") SLAB("c", "-10", "0", COATED),
         SLAB("smoke", "-20", "20", "") SLAB("a", "0", "5", "") SLAB("c", "-10", ".001", COATED)},
        {"one on top of a coated one in a third",
         SLAB("c", "0", "5", STATED) SLAB("a", "0", "10", COATED) SLAB("d", "-10", "10", ""),
         SLAB("c", "-.001", "5", STATED) SLAB("a", "0", "10", COATED) SLAB("d", "-10", "9.999", "")},
        {"a coated one below all of another",
         SLAB("a", "-10", "10", STATED) SLAB("b", "-10", "-5", COATED) SLAB("d", "5", "10", COATED "  priority = 2"),
         SLAB("a", "-10", "9.999", STATED) SLAB("b", "-9.999", "-5", COATED)
             SLAB("d", "5", "10", COATED "  priority = 2")},
        {"a painted one on top of one painted more, in a third",
         SLAB("c", "0", "5", STATED "  " PAINTED(".9")) SLAB("a", "0", "10", PAINTED(".5")) SLAB("d", "-10", "10", ""),
         SLAB("c", "-.001", "5", STATED "  " PAINTED(".9")) SLAB("a", "0", "10", PAINTED(".5"))
             SLAB("d", "-10", "9.999", "")},
        {"the same the other way round",
         SLAB("a", "0", "10", PAINTED(".5")) SLAB("d", "-10", "10", PAINTED(".7"))
             SLAB("c", "0", "5", STATED "  " PAINTED(".9")),
         SLAB("a", "0", "10", PAINTED(".5")) SLAB("d", "-10", "9.999", PAINTED(".7"))
             SLAB("c", "-.001", "5", STATED "  " PAINTED(".9"))},
        {"a union of two, one coated", "union { interior = a  " PART("0", "5", COATED) PART("0", "9", "") "}\n",
         "union { interior = a  " PART("0", "5", COATED) PART("-.001", "9", "") "}\n"},
        {"a coated part of two", "intersection { interior = a  " PART("0", "9", "") PART("0", "5", COATED) "}\n",
         "intersection { interior = a  " PART("-.001", "9", "") PART("0", "5", COATED) "}\n"},
        {"a combination on a coated slab",
         "intersection { interior = a  " PART("0", "7", "") PART("-3", "5", "") "}\n" SLAB("c", "-10", "0", COATED),
         "intersection { interior = a  " PART("0", "7", "") PART("-3", "5", "") "}\n" SLAB("c", "-10", ".001", COATED)},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Estimate overlapping = seen_from(cases[i].overlapping, 1);
        for (int end = -1; end <= 1; end += 2)
            truth_alike(cases[i].what, overlapping, seen_from(cases[i].coincident, end), 4, 0.003 / overlapping.mean);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lines_are_the_same_from_both_ends),
                                       cmocka_unit_test(surfaces_are_the_same_from_both_ends)};
    return cmocka_run_group_tests_name("reciprocity", tests, NULL, NULL);
}

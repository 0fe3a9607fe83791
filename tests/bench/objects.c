/* objects.c - very many objects: what a ray costs among them, and what time and memory they take.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "check/report.h"
#include "measure.h"

/* A soda with ever more, ever smaller bubbles, that fill the same part of it: what a ray costs should grow as the depth
 * of the hierarchy does, what a scene costs as the number of bubbles. */
static void bench_bubbles(const char *name, const char *bubble)
{
    enum { SIZES = 5, TURNS = 3 };
    double first_ns = 0;
    Pool *one = pool_of(1);
    printf("%s in a soda: for each ray, in ratio to 10 of them; building, compiling, and checking the scene\n", name);
    for (unsigned k = 0, n = 10; k < SIZES; k++, n *= 10) {
        char text[2000];
        Made made;
        double ns[TURNS];
        RenderStats stats = {0};
        snprintf(text, sizeof text, SODA, n, bubble);
        made_from_text(&made, text);
        for (int i = 0; i < TURNS; i++) {
            stats = render_at(made.compiled, 96, 72, 16, one);
            ns[i] = stats.cpu_seconds / (double)stats.rays * 1e9;
        }
        double ray_ns = spread_of(ns, TURNS).median;
        double start = clock_cpu_s();
        Buf out = {0};
        report_warnings(made.compiled, NULL, &made.diag);
        report_remarks(made.compiled, &made.diag);
        report_print(made.compiled, &made.sources, &out);
        double check_s = clock_cpu_s() - start;
        buf_clear(&out);
        if (k == 0) first_ns = ray_ns;
        printf("  %7u %9.0f ns a ray %6.2f x %7.1f rays a path %8.3f s to build %8.3f s to compile %8.3f s to check, "
               "%llu faults\n",
               n, ray_ns, ray_ns / first_ns, (double)stats.rays / (double)stats.paths, made.build_s, made.compile_s,
               check_s, (unsigned long long)stats.nesting_faults);
        made_clear(&made);
    }
    pool_free(one);
}

/* The soda of measure.h in a drink that is a mesh. */
#define MESH_SODA                                                                                                      \
    "meniscus 1.0 unit mm medium soda { ior = 1.33 state = liquid } environment { } "                                  \
    "camera { from = <0, 90, -240> to = <0, 45, 0> fov = 24 } "                                                        \
    "superellipsoid drink { interior = soda exponents = <.6, .7> radius = <40, 45, 40> translate(45 * y) } "           \
    "let n = %u let size = 16 / n ^ (1 / 3) "                                                                          \
    "for (i in 1..n) { let r = 34 * sqrt(rnd(i, 2)) let a = 360 * rnd(i, 1) "                                          \
    "%s translate(<r * cos(a), 14 + 60 * rnd(i, 4), r * sin(a)>) } }"

/* What it takes to find out that each bubble is in the drink, or where it leaves it. */
static void bench_growth(const char *name, bool is_mesh)
{
    double us[2];
    for (unsigned k = 0, n = 100000; k < 2; k++, n *= 10) {
        char text[2000];
        Made made;
        static const char *const bubble = "sphere { interior = air radius = size * (.3 + .5 * rnd(i, 3))";
        if (is_mesh)
            snprintf(text, sizeof text, MESH_SODA, n, bubble);
        else
            snprintf(text, sizeof text, SODA, n, bubble);
        made_from_text(&made, text);
        us[k] = made.compile_s / n * 1e6;
        printf("%7u bubbles in %s: %6.2f us each to compile, %zu pairs\n", n, name, us[k], made.compiled->n_pairs);
        made_clear(&made);
    }
    printf("  ten times as many: %.1f times the time\n", 10 * us[1] / us[0]);
}

/* Every one of them overlaps every other one. */
static void bench_shells(void)
{
    printf("boxes, each inside of all before it, in a lathe's room\n");
    for (unsigned n = 250; n <= 1000; n *= 2) {
        char text[1000];
        Made made;
        snprintf(
            text, sizeof text,
            "meniscus 1.0 unit mm medium glass { ior = 1.5 state = solid } medium soda { ior = 1.33 state = liquid } "
            "lathe { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] } "
            "camera { from = <0, 90, -240> to = <0, 45, 0> } environment { } let n = %u "
            "for (i in 1..n) { box { interior = i %% 2 == 0 ? soda : glass size = vec3(50 * (n + 1 - i) / n) "
            "translate(50 * y) } }",
            n);
        made_from_text(&made, text);
        printf("  %7u %9zu pairs %8.3f s to compile\n", n, made.compiled->n_pairs, made.compile_s);
        made_clear(&made);
    }
}

/* Cubes of a grid, each of which touches 26 others with a face, an edge or a corner. */
static void bench_grid(void)
{
    for (unsigned n = 10; n <= 40; n *= 2) {
        char text[1000];
        Made made;
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit cm medium glass { ior = 1.5 } camera { from = <0, 90, -240> to = <0, 45, 0> } "
                 "environment { } let cube = box { interior = glass from = <0, 0, 0> to = <1, 1, 1> } let n = %u "
                 "for (i in 1..n) { for (j in 1..n) { for (k in 1..n) { cube { translate(<i, j, k>) } } } }",
                 n);
        made_from_text(&made, text);
        printf("%7u cubes face to face: %6.2f us each to compile, %zu pairs\n", n * n * n,
               made.compile_s / (n * n * n) * 1e6, made.compiled->n_pairs);
        made_clear(&made);
    }
}

/* Memory of the program so far at its largest, in bytes. */
static double most_memory(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * (double)usage.ru_maxrss;
}

/* Objects spread evenly in a cube, a tenth of a unit in radius; each kind in a program of its own, as the system knows
 * only of the most memory that a program ever had. MENISCUS_BENCH_OBJECTS: how many, if not a million. */
static void bench_many(const char *name, const char *object)
{
    const char *wanted = getenv("MENISCUS_BENCH_OBJECTS");
    unsigned n = wanted ? (unsigned)strtoul(wanted, NULL, 10) : 1000000;
    fflush(stdout);
    pid_t child = fork();
    if (child < 0) exit(1);
    if (child > 0) {
        int status;
        if (waitpid(child, &status, 0) != child || status != 0) exit(1);
        return;
    }
    char text[1000];
    Made made;
    snprintf(text, sizeof text,
             "meniscus 1.0 unit cm medium gas { ior = 1 state = gas } environment { } "
             "camera { from = <50, 50, 300> to = <50, 50, 50> } let b = %s "
             "for (i in 1..%u) { b { translate(<100 * rnd(1, i), 100 * rnd(2, i), 100 * rnd(3, i)>) } }",
             object, n);
    double before = most_memory();
    made_from_text(&made, text);
    printf(
        "%u %s: %.0f bytes each at the most, %.0f of them Embree's; %.2f us to build, %.2f us to compile; %zu pairs\n",
        n, name, (most_memory() - before) / n, (double)rtc_scene_bytes(made.compiled->rtc) / n, made.build_s / n * 1e6,
        made.compile_s / n * 1e6, made.compiled->n_pairs);
    fflush(stdout);
    _exit(0);
}

void bench_objects(void)
{
    bench_many("spheres", "sphere { interior = gas radius = .1 }");
    bench_many("instances of a mesh, apart from each other", "box { interior = gas size = <.01, .01, .01> }");
    bench_bubbles("spheres", "sphere { interior = air radius = size * (.3 + .5 * rnd(i, 3))");
    bench_bubbles("ellipsoids", "sphere { interior = air radius = size * (.3 + .5 * rnd(i, 3)) scale(<1, 1.2, 1>)");
    bench_growth("a drink of revolution", false);
    bench_growth("a drink that is a mesh", true);
    bench_shells();
    bench_grid();
}

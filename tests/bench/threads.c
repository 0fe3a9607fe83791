/* threads.c - what a second thread brings, where the rest goes, and how soon there is a picture.
 *
 * The clock on the wall tells the truth on an idle machine only. So the program's own threads are watched as well: the
 * linker puts __wrap_pool_run in place of pool_run (see the Makefile), which takes the processor's time of every task and
 * of what runs between the jobs. From these a schedule is made: tasks go, in their order, to whichever of two workers is
 * free first, as the pool does it, and what lies between jobs is done by one alone. That is how long two idle processors
 * would take; what the threads cost each other, by caches, locks and counters that they share, is in the times of the
 * tasks.
 * SPDX-License-Identifier: Apache-2.0 */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/array.h"
#include "base/clock.h"
#include "measure.h"

/* ---- watching the pool ---- */

typedef void Task(void *context, uint32_t index, unsigned worker);
void __real_pool_run(Pool *pool, uint32_t n, Task *task, void *context);
void __wrap_pool_run(Pool *pool, uint32_t n, Task *task, void *context);

typedef struct Watch {
    bool on;
    double *seconds; /* of each task of the present job */
    size_t capacity;
    Task *task;
    void *context;
    double in_tasks, ideal;     /* all tasks; the jobs' schedules for two workers */
    double caller_in_tasks;     /* of the thread that runs the jobs, */
    double caller_start, start; /* and its time, and the whole program's, at the beginning */
} Watch;
static Watch watch;

static double thread_cpu_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void watched_task(void *context, uint32_t index, unsigned worker)
{
    Watch *w = context;
    double start = thread_cpu_s();
    w->task(w->context, index, worker);
    w->seconds[index] = thread_cpu_s() - start;
}

/* Two workers, each of whom takes the next task when it is free. */
static double schedule(const double *seconds, uint32_t n)
{
    double busy[2] = {0, 0};
    for (uint32_t i = 0; i < n; i++) busy[busy[1] < busy[0]] += seconds[i];
    return busy[0] > busy[1] ? busy[0] : busy[1];
}

void __wrap_pool_run(Pool *pool, uint32_t n, Task *task, void *context)
{
    if (!watch.on) {
        __real_pool_run(pool, n, task, context);
        return;
    }
    if (!array_reserve(&watch.seconds, &watch.capacity, n, sizeof *watch.seconds)) bench_fail("memory", NULL);
    watch.task = task;
    watch.context = context;
    double start = thread_cpu_s();
    __real_pool_run(pool, n, watched_task, &watch);
    watch.caller_in_tasks += thread_cpu_s() - start;
    for (uint32_t i = 0; i < n; i++) watch.in_tasks += watch.seconds[i];
    watch.ideal += schedule(watch.seconds, n);
}

static void watch_begin(void)
{
    watch = (Watch){.on = true,
                    .seconds = watch.seconds,
                    .capacity = watch.capacity,
                    .caller_start = thread_cpu_s(),
                    .start = clock_cpu_s()};
}

/* What was watched, in seconds. */
typedef struct Watched {
    double cpu;   /* of all threads */
    double alone; /* of the one thread, between jobs */
    double ends;  /* lost at the ends of jobs, where one worker waits for the other */
    double ideal; /* on two idle processors */
} Watched;

static Watched watch_end(void)
{
    double cpu = clock_cpu_s() - watch.start, caller = thread_cpu_s() - watch.caller_start;
    double alone = caller - watch.caller_in_tasks;
    double others = cpu - alone - watch.in_tasks; /* Embree's own threads, which share out what they do */
    if (others < 0) others = 0;
    watch.on = false;
    return (Watched){cpu, alone, watch.ideal - watch.in_tasks / 2, alone + watch.ideal + others / 2};
}

/* ---- renders ---- */

static void print_spread(double *values, int n)
{
    Quartiles spread = spread_of(values, n);
    printf("  %5.2f (%.2f .. %.2f)", spread.median, spread.low, spread.high);
}

static void print_load(void)
{
    double load[1] = {0};
    FILE *file = fopen("/proc/loadavg", "r");
    if (file && fscanf(file, "%lf", load) != 1) load[0] = -1;
    if (file) fclose(file);
    printf("load of the machine in the last minute, with this program's part in it: %.2f\n", load[0]);
}

static void threads_of(const char *path, Pool *one, Pool *two)
{
    Made made;
    double wall[RUNS], path_time[RUNS], ideal[RUNS], alone[RUNS], ends[RUNS];
    made_from_file(&made, path);
    for (int run = 0; run < RUNS; run++) {
        Watched watched[2];
        double seconds[2];
        for (int k = 0; k < 2; k++) {
            double start = clock_now_s();
            watch_begin();
            render_at(made.compiled, 160, 120, 16, k ? two : one);
            watched[k] = watch_end();
            seconds[k] = clock_now_s() - start;
        }
        wall[run] = seconds[0] / seconds[1];
        path_time[run] = watched[1].cpu / watched[0].cpu;
        ideal[run] = watched[0].cpu / watched[1].ideal;
        alone[run] = 100 * watched[1].alone / watched[1].ideal;
        ends[run] = 100 * watched[1].ends / watched[1].ideal;
    }
    printf("%-20s", file_name(path));
    print_spread(ideal, RUNS);
    print_spread(wall, RUNS);
    print_spread(path_time, RUNS);
    printf("  %6.2f %%  %6.2f %%\n", spread_of(alone, RUNS).median, spread_of(ends, RUNS).median);
    fflush(stdout);
    made_clear(&made);
}

/* ---- from the file to the picture ---- */

/* When the first picture was shown; nothing is rendered after it. */
typedef struct FirstPicture {
    double wall_s, cpu_s; /* since the start */
    sig_atomic_t stop;
} FirstPicture;

static void note_first_picture(void *context, const Image *image)
{
    FirstPicture *first = context;
    (void)image;
    if (first->stop) return;
    first->wall_s += clock_now_s();
    first->cpu_s += clock_cpu_s();
    first->stop = 1;
}

/* Of 640 x 480, from the compiled scene, with photons where the scene has use for them. Lights and the camera's surroundings
 * are a part of it. */
static FirstPicture first_picture(const CompiledScene *compiled, Pool *pool)
{
    FirstPicture first = {-clock_now_s(), -clock_cpu_s(), 0};
    RenderSettings settings = {.width = 640, .height = 480, .samples = 1, .bounces = compiled->scene->render.bounces};
    RenderEvents events = {.context = &first, .stop = &first.stop, .picture = note_first_picture};
    Error error = {0};
    Image image;
    RenderStats stats;
    if (render_image(compiled, &settings, pool, &events, &image, &stats, &error) != STATUS_OK)
        bench_fail("render", &error);
    image_clear(&image);
    return first;
}

enum { STAGE_RUNS = 3 };

typedef struct Stage {
    const char *name;
    Watched watched[STAGE_RUNS];
} Stage;

static void print_stage(Stage *stage)
{
    double ideal[STAGE_RUNS], faster[STAGE_RUNS], alone[STAGE_RUNS];
    for (int run = 0; run < STAGE_RUNS; run++) {
        ideal[run] = 1e3 * stage->watched[run].ideal;
        faster[run] = stage->watched[run].cpu / stage->watched[run].ideal;
        alone[run] = 1e3 * stage->watched[run].alone;
    }
    printf("  %-44s", stage->name);
    print_spread(ideal, STAGE_RUNS);
    print_spread(faster, STAGE_RUNS);
    printf("  %8.2f\n", spread_of(alone, STAGE_RUNS).median);
}

static void stages_of(const char *path, Pool *two)
{
    Stage stages[] = {{.name = "the scene, from its text and files"},
                      {.name = "hierarchy, and how the objects lie"},
                      {.name = "photons, and a picture of 640 x 480, 1 sample"},
                      {.name = "the same without photons"},
                      {.name = "the picture to an EXR file"}};
    double shown[STAGE_RUNS], half[STAGE_RUNS];
    char file[] = "/tmp/meniscus-bench-XXXXXX";
    int descriptor = mkstemp(file);
    if (descriptor < 0) bench_fail(file, NULL);
    close(descriptor);
    for (int run = 0; run < STAGE_RUNS; run++) {
        Error error = {0};
        Made made;
        Image image;
        RenderStats stats;
        Watched *at[COUNT_OF(stages)];
        for (size_t i = 0; i < COUNT_OF(stages); i++) at[i] = &stages[i].watched[run];
        watch_begin();
        made_begin(&made, path, NULL, two);
        *at[0] = watch_end();
        watch_begin();
        made_compile(&made, path, two);
        *at[1] = watch_end();
        for (int caustics = 1; caustics >= 0; caustics--) {
            RenderSettings settings = {.width = 640,
                                       .height = 480,
                                       .samples = 1,
                                       .bounces = made.scene->render.bounces,
                                       .caustics = caustics ? CAUSTICS_AUTOMATIC : CAUSTICS_OFF};
            watch_begin();
            if (render_image(made.compiled, &settings, two, NULL, &image, &stats, &error) != STATUS_OK)
                bench_fail(path, &error);
            *at[caustics ? 2 : 3] = watch_end();
            if (caustics) image_clear(&image);
        }
        watch_begin();
        if (exr_write(file, &image, &(ExrOptions){.pool = two}, &error) != STATUS_OK) bench_fail(path, &error);
        *at[4] = watch_end();
        image_clear(&image);
        FirstPicture picture = first_picture(made.compiled, two);
        shown[run] = 1e3 * picture.wall_s;
        half[run] = 1e3 * picture.cpu_s / 2;
        made_clear(&made);
    }
    remove(file);
    printf("%s\n", file_name(path));
    for (size_t i = 0; i < COUNT_OF(stages); i++) print_stage(&stages[i]);
    printf("  %-44s  %5.2f by half of the processors' time (goal: 300), %.2f by the clock on the wall\n",
           "until a picture of 640 x 480 can be shown", spread_of(half, STAGE_RUNS).median,
           spread_of(shown, STAGE_RUNS).median);
    fflush(stdout);
}

void bench_threads(char **paths, int n)
{
    printf("the processors' time for a path beside another process that renders the same, over that alone\n%-20s  %-21s"
           "  %-21s\n",
           "scene", "memory in common", "each its own");
    for (int i = 0; i < n; i++) processes_of(paths[i]);
    Pool *one = pool_of(1), *two = pool_of(2);
    printf(
        "what two threads do in the time of one (goal: 1.95): by the processors' time and the schedule of the tasks,\n"
        "as on two idle processors; by the clock on the wall; the processors' time for a path with two over one; and "
        "of\n"
        "the ideal time, what one thread does alone, and what is lost at the ends of passes\n");
    print_load();
    printf("%-20s  %-20s  %-20s  %-20s  %8s  %8s\n", "scene", "ideal", "wall", "time for a path", "alone", "ends");
    for (int i = 0; i < n; i++) threads_of(paths[i], one, two);
    print_load();
    printf("from the file to the first picture: milliseconds on two idle processors; over what one would take; of it, "
           "one\n"
           "thread alone\n");
    for (int i = 0; i < n; i++) stages_of(paths[i], two);
    pool_free(one);
    pool_free(two);
    free(watch.seconds);
    watch = (Watch){0};
}

/* signals.c - the handler, and the names of the temporary files that a second signal has to remove.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/signals.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"

/* timeout(1) sends each signal twice, to the process and to its group; nobody means that as a second one. */
static const double one_signal_s = 0.1;

static const int handled[] = {SIGINT, SIGTERM, SIGHUP};

static volatile sig_atomic_t received, stop, wish;
static struct timespec received_at;
static struct sigaction before[COUNT_OF(handled)];
static bool begun;
static const char *announcement;
/* Names under which base/file.c may write; only those that nobody else had when the render began. */
static char **temporaries;
static volatile sig_atomic_t n_temporaries;

static void write_text(const char *text)
{
    ssize_t n = write(STDERR_FILENO, text, strlen(text));
    (void)n; /* there is nobody left to tell */
}

static void end_by(int number)
{
    struct sigaction plain = {.sa_handler = SIG_DFL};
    sigset_t set;
    sigaction(number, &plain, NULL);
    sigemptyset(&set);
    sigaddset(&set, number);
    sigprocmask(SIG_UNBLOCK, &set, NULL);
    raise(number);
    _exit(128 + number); /* not reached */
}

static void handle(int number)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (!received) {
        received_at = now;
        received = number;
        stop = 1;
        write_text(announcement);
        return;
    }
    double since = (double)(now.tv_sec - received_at.tv_sec) + 1e-9 * (double)(now.tv_nsec - received_at.tv_nsec);
    if (since < one_signal_s) return;
    for (sig_atomic_t i = 0; i < n_temporaries; i++) unlink(temporaries[i]);
    end_by(number);
}

static void remember_temporaries(const char *output)
{
    for (int attempt = 0; attempt < FILE_TEMPORARY_TRIES; attempt++) {
        char *name = file_temporary_name(output, attempt);
        if (!name) break; /* only tidiness after a second signal is lost */
        struct stat info;
        if (stat(name, &info) == 0)
            free(name);
        else
            temporaries[n_temporaries++] = name;
    }
}

Status signals_begin(const char *const *outputs, size_t n_outputs, bool json, SignalsKeep keep, Error *error)
{
    static const char *const announcements[2][3] = {
        {"\nmeniscus: stopping; this frame is not written (again to stop at once)\n",
         "\nmeniscus: stopping; of this frame a checkpoint is kept (again to stop at once)\n",
         "\nmeniscus: stopping; writing what there is (again to stop at once)\n"},
        {"{\"event\": \"stopping\", \"message\": \"this frame is not written; again to stop at once\"}\n",
         "{\"event\": \"stopping\", \"message\": \"of this frame a checkpoint is kept; again to stop at once\"}\n",
         "{\"event\": \"stopping\", \"message\": \"writing what there is; again to stop at once\"}\n"}};
    announcement = announcements[json][keep];
    size_t size = (n_outputs * FILE_TEMPORARY_TRIES + 1) * sizeof *temporaries;
    temporaries = malloc(size);
    if (!temporaries) return fail_memory(error, size, "the names of outputs");
    for (size_t i = 0; i < n_outputs; i++) remember_temporaries(outputs[i]);
    struct sigaction action = {.sa_handler = handle, .sa_flags = SA_RESTART};
    sigfillset(&action.sa_mask); /* one at a time */
    for (size_t i = 0; i < COUNT_OF(handled); i++) {
        sigaction(handled[i], NULL, &before[i]);
        if (before[i].sa_handler != SIG_IGN) sigaction(handled[i], &action, NULL);
    }
    begun = true;
    return STATUS_OK;
}

const volatile sig_atomic_t *signals_flag(void)
{
    return &received;
}

volatile sig_atomic_t *signals_stop(void)
{
    return &stop;
}

static void take_wish(int number)
{
    (void)number;
    wish = 1;
}

void signals_take_wishes(void)
{
    struct sigaction action = {.sa_handler = take_wish, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(SIGUSR1, &action, NULL);
}

volatile sig_atomic_t *signals_wish(void)
{
    return &wish;
}

void signals_end(void)
{
    if (begun)
        for (size_t i = 0; i < COUNT_OF(handled); i++) sigaction(handled[i], &before[i], NULL);
    begun = false;
    sig_atomic_t n = n_temporaries;
    n_temporaries = 0;
    for (sig_atomic_t i = 0; i < n; i++) free(temporaries[i]);
    free(temporaries);
    temporaries = NULL;
}

void signals_raise_again(void)
{
    if (received) end_by(received);
}

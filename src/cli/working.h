/* working.h - says what takes the time before a render begins, once it takes a while.
 * A thread of its own waits beside what is read, built and compiled, and is woken when that is done.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_WORKING_H
#define MEN_WORKING_H

#include <pthread.h>

#include "cli/progress.h"

enum { WORKING_WHAT_SIZE = 160 };

typedef struct Working {
    ProgressForm form;
    double begin_s;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t end;
    bool watches, ended, shown; /* shown: on the terminal's last line */
    char what[WORKING_WHAT_SIZE];
} Working;

/* Where no thread is to be had, nothing is said. */
void working_begin(Working *working, ProgressForm form, const char *what);
/* For SceneOptions; context is a Working. name: NULL for none. */
void working_at_node(void *context, const char *type, const char *name);
/* Takes what is shown off the terminal. */
void working_end(Working *working);

#endif

/* signals.h - stopping a render by a signal without losing what was rendered.
 * The first INT, TERM or HUP says so at once and sets a flag; the second one ends the process at once, and the
 * temporary files of the outputs with it. In both cases the process ends by the signal, so that the shell sees it.
 * Two within a tenth of a second are one. Signals that were ignored when the process began (nohup) stay ignored.
 * USR1 is a wish to have what there is so far, and changes nothing else.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SIGNALS_H
#define MEN_SIGNALS_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

/* What is kept after the first signal. */
typedef enum SignalsKeep { SIGNALS_KEEP_NOTHING, SIGNALS_KEEP_CHECKPOINT, SIGNALS_KEEP_PICTURE } SignalsKeep;

/* From here on signals are held. outputs: paths that will be written; not needed afterwards. json: the form of
 * what is said. */
ATTR_NODISCARD Status signals_begin(const char *const *outputs, size_t n_outputs, bool json, SignalsKeep keep,
                                    Error *error);
/* Not 0 after the first signal: its number. */
const volatile sig_atomic_t *signals_flag(void);
/* Not 0 after the first signal, or after somebody has set it, for another reason: what goes on is to end. */
volatile sig_atomic_t *signals_stop(void);
/* From here on, to the end of the process, USR1 sets signals_wish. */
void signals_take_wishes(void);
/* Not 0 after USR1, until somebody sets it to 0. */
volatile sig_atomic_t *signals_wish(void);
/* Signals act as they did before; what signals_begin keeps is freed. Safe without signals_begin. */
void signals_end(void);
/* Ends the process by the signal that was received; returns when there was none. */
void signals_raise_again(void);

#endif

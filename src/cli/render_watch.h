/* render_watch.h - --watch: a scene is rendered anew whenever one of its files changes.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RENDER_WATCH_H
#define MEN_RENDER_WATCH_H

#include "cli/talk.h"

/* What renders the scene once. */
typedef Status RenderOnce(const Options *options, const Talk *talk, Error *error);

/* Renders, waits for a change of what was read for it, and renders anew, until a signal comes. Ends where the first render fails
 * for its options, or before any file was read; of other failures it says what they are, and goes on waiting. */
ATTR_NODISCARD Status render_watch(const Options *options, const Talk *talk, RenderOnce *render, Error *error);
/* A render that goes on is to stop because a file has changed: once that is so, signals_stop is set. For progress callbacks. */
void render_watch_look(void);

#endif

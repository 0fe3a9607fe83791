/* sight.h - what the camera's rays meet first, and what they see behind what is clear; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SIGHT_H
#define MEN_SIGHT_H

#include "trace/event.h"

/* What a path from the camera has come to. */
void sight_note(const Path *path, const Event *event, FirstSight *sight);
/* What the camera's ray would meet first from t on, up to which the tracer's list has come, if no medium scattered it, and what it sees
 * behind what is clear, into the tracer's sights. The path stays as it is, and nothing of it counts. */
void sight_look(const Path *path, double t);

#endif

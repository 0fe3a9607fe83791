/* catcher.h - surfaces that are in the picture only as what other things change of their light: shadow catchers; private
 * to src/trace, but for the bare world.
 *
 * Where the camera looks straight at one, a second path starts by the same random numbers in a world in which there are
 * only lights and catchers: the bare world. It is this world with other geometry, and chooses lights by the same numbers,
 * also where these then turn out to be gone. So both paths find the same light, to the bit, until one of them comes to
 * something that is not there for the other; what they find together has no noise in common quotients and differences
 * (render/caught.h), and light that catchers throw on each other is in both. Objects and media that shine are things as
 * all others are: their light comes to the picture that lies behind, whereas that of lights and of the environment is in
 * it already.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CATCHER_H
#define MEN_CATCHER_H

#include "trace/light.h"
#include "trace/path.h"

/* The world of a scene that has catchers, with nothing but these and lights; *bare is NULL where it has none. To be made
 * when the world is complete but for its guide, and freed before it. STATUS_NOMEM. */
ATTR_NODISCARD Status catcher_world_new(const World *world, unsigned n_threads, World **bare, Error *error);
void catcher_world_free(World *bare);
/* Whether a light that was chosen is one of those, or comes from infinity. */
bool catcher_world_has(const World *bare, const LightSample *light);

typedef struct Path Path;
typedef struct Event Event;
/* The path, which sees and catches, has come straight from the camera to an event. If that is at a catcher,
 * path->catching and path->radiance become those of what it finds from there on. */
void catcher_meet(Path *path, const Event *event);

#endif

/* tev.h - pictures so far, sent to the viewer tev (github.com/Tom94/tev), which takes them over TCP.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEV_H
#define MEN_TEV_H

#include "image/image.h"

#define TEV_HOST "127.0.0.1"
#define TEV_PORT "14158"

typedef struct Tev Tev;

/* Connects to a tev that runs. name: of the picture there. STATUS_OUTPUT when there is none, or it does not answer within a few
 * seconds. */
ATTR_NODISCARD Status tev_open(const char *host, const char *port, const char *name, Tev **tev, Error *error);
/* Shows all channels of the picture, scene-linear; one of another size or with other channels than before takes its place.
 * STATUS_OUTPUT when the connection is lost, or tev takes nothing for some seconds. */
ATTR_NODISCARD Status tev_show(Tev *tev, const Image *image, Error *error);
/* What was shown stays there. NULL is fine. */
void tev_close(Tev *tev);

#endif

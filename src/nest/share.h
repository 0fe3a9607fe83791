/* share.h - hulls that never hold a point together, and so need but one bit of a list between them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SHARE_H
#define MEN_SHARE_H

#include "nest/order.h"

#define NEST_ALONE UINT32_MAX /* the kind of a hull that shares with none */

/* Two hulls that may hold a point together, or come within rounding of each other. */
typedef struct NestMeeting {
    uint32_t a, b;
} NestMeeting;

/* Where an order has too many hulls for lists that keep them as bits, lets hulls of one kind that do not meet share a
 * level, if so few levels are enough then; else all stays as it is. kind: of each hull, a number of the caller's, one
 * medium each, or NEST_ALONE. meetings: all of them, in any order, a pair once or twice; n <= UINT32_MAX, or nothing is
 * shared. Of two hulls that meet, and of two that are alone, the same one is on top as before, so that the medium of every
 * point stays what it was. But nest_owner and nest_item then name one of the hulls that share a level, whichever it is that
 * holds the point. O(n + m). STATUS_NOMEM. */
ATTR_NODISCARD Status nest_order_share(NestOrder *order, const uint32_t *kind, const NestMeeting *meetings, size_t n,
                                       Error *error);

#endif

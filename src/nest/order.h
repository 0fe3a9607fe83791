/* order.h - which of two overlapping hulls is on top.
 * A hull is a closed object with a medium inside. Hulls are numbered 0 .. n - 1 in order of declaration;
 * media are numbered by the caller, NEST_WORLD_MEDIUM is the world's (outside of all hulls). Where several
 * hulls hold a point, the one on top owns it. Sources: [WR19] for the order of entry, [SB02] for priorities,
 * the automatic order is ours; see meniscus-nesting(7).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ORDER_H
#define MEN_ORDER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"
#include "nest/csg.h"

#define NEST_WORLD UINT32_MAX /* "owner" of a point that no hull holds */

typedef enum NestPolicy {
    NEST_AUTOMATIC, /* an order computed from the scene: the same from every direction, no work for the artist */
    NEST_ENTERED,   /* [WR19]: the hull entered last is on top */
    NEST_PRIORITY,  /* [SB02]: the larger stated priority is on top */
    NEST_NONE       /* no nesting at all: every surface lies between its medium and the world's */
} NestPolicy;

/* State of matter, larger on top. */
typedef enum NestState { NEST_STATE_UNKNOWN, NEST_LIQUID, NEST_GAS, NEST_SOLID } NestState;

typedef struct NestHull {
    uint32_t medium;
    int32_t priority; /* 0 unless stated; larger is on top */
    NestState state;
    double volume; /* enclosed, compared to a millionth; INFINITY for a half-space */
    bool mixes;    /* never owns a point, but adds to whatever does: its crossings are silent */
} NestHull;

typedef enum NestRelation { NEST_PARTIAL, NEST_A_IN_B, NEST_B_IN_A } NestRelation;

/* Two hulls that share volume. */
typedef struct NestOverlap {
    uint32_t a, b;
    NestRelation relation;
} NestOverlap;

/* What decided between two hulls, first that applies. */
typedef enum NestRule {
    NEST_BY_PRIORITY,
    NEST_BY_CONTAINMENT,
    NEST_BY_STATE,
    NEST_BY_VOLUME,
    NEST_BY_DECLARATION /* the later one is on top, as with paint */
} NestRule;

typedef struct NestDecision {
    uint32_t top, bottom;
    NestRule rule;
} NestDecision;

/* The rules (a) to (e) applied to one pair. */
NestDecision nest_decide(const NestHull *hulls, const NestOverlap *overlap);
const char *nest_rule_text(NestRule rule); /* "priority", "containment", ... */
const char *nest_policy_text(NestPolicy policy);
/* false when the word names no policy */
bool nest_policy_from_text(const char *text, NestPolicy *policy);

/* A strict total order of all hulls, ready for crossing. Immutable; shared by all threads. */
typedef struct NestOrder {
    NestPolicy policy;
    uint32_t n_hulls;
    uint32_t *rank;     /* of each hull, 0 .. n - 1, larger on top; a permutation */
    uint32_t n_mixing;  /* hulls that mix: the lowest ranks are theirs */
    uint32_t n_circles; /* groups of hulls whose pairwise answers ran in a circle */
    uint32_t *circle;   /* of each hull: 0, or the number of its circle from 1 */
    /* of each hull: its rank + 1, unless hulls share levels (share.h), and its medium; level 0 and the world's medium of
     * one that mixes, and of operands of combinations, which own nothing */
    NestTop *top;
    uint32_t *hull_at;  /* of each level 0 .. n, one of those that share it; NEST_WORLD at 0 */
    const NestCsg *csg; /* how hulls are combined from operands; NULL: none is */
    bool sorted; /* every list is sorted by rank, of hulls that neither mix nor are combined: what most scenes are */
    bool narrow; /* and of so few levels that lists keep them as bits: NEST_NARROW at most */
    uint8_t *narrow_level;               /* then the level of each hull, */
    NestTop narrow_top[NEST_NARROW + 1]; /* and what each level says, closer at hand */
} NestOrder;

/* Builds the order. Under NEST_AUTOMATIC the pairwise answers are made into one order (topological, ties by
 * volume, then declaration); inside a circle the smaller volume, then the later declaration, is on top.
 * Under NEST_PRIORITY it is priority, then declaration; ENTERED and NONE need no ranks, which are then by
 * declaration. overlaps may name a pair twice. O((n + m) log n). STATUS_NOMEM. */
ATTR_NODISCARD Status nest_order_build(NestOrder *order, NestPolicy policy, const NestHull *hulls, uint32_t n_hulls,
                                       const NestOverlap *overlaps, size_t n_overlaps, Error *error);
/* Whose a point is, by the hulls around it in a row, the owner last. */
static inline NestTop nest_top_of_row(const NestOrder *order, const uint32_t *items, uint32_t n)
{
    return n ? order->top[items[n - 1]] : (NestTop){0, NEST_WORLD_MEDIUM};
}
/* Takes a list that was made up of hulls in a row, the owner last, to how the order keeps it. */
void nest_order_settle(const NestOrder *order, NestList *list);
/* Whether a hull, or an operand, is in a list, or one that shares its level; and the one of number i < nest_list_count in
 * it, the owner last. */
bool nest_has(const NestOrder *order, const NestList *list, uint32_t hull);
uint32_t nest_item(const NestOrder *order, const NestList *list, uint32_t i);
/* Whether a hull mixes; false for operands of combinations. */
static inline bool nest_mixes(const NestOrder *order, uint32_t hull)
{
    return UNLIKELY(order->n_mixing) && hull < order->n_hulls && order->rank[hull] < order->n_mixing;
}
/* Tells the order of combinations; csg->first_operand is the number of hulls. csg is not owned. STATUS_NOMEM. */
ATTR_NODISCARD Status nest_order_combine(NestOrder *order, const NestCsg *csg, Error *error);
/* Makes lists keep hulls as bits, by the levels in order->top: NEST_NARROW at most. */
void nest_order_narrow(NestOrder *order);
void nest_order_clear(NestOrder *order);

#endif

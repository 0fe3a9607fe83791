/* csg.h - solids combined from others: union, intersection, difference.
 * No surface is ever cut. A ray's interior list also holds the operands that the ray is inside, and whether a point is
 * inside of the combination is a function of those. Crossing an operand is crossing the combination's hull where that
 * function's value flips, and nothing elsewhere.
 *
 * Hulls are numbered 0 .. first_operand - 1, operands follow. All functions here are false for a point inside of no
 * operand, so that only the operands in the list need to be looked at.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CSG_H
#define MEN_CSG_H

#include "nest/list.h"

#define NEST_OPAQUE UINT32_MAX /* "hull" of a combination that is opaque, and so never in a list */

typedef enum NestOperation {
    NEST_OPERAND,      /* a leaf: inside of that one */
    NEST_UNION,        /* inside of any */
    NEST_INTERSECTION, /* inside of all */
    NEST_DIFFERENCE    /* inside of the first and of none of the others */
} NestOperation;

/* A part of a combination. Its operands are a range of numbers, its children stand side by side in order of them. */
typedef struct NestPart {
    NestOperation operation;
    uint32_t begin, end;              /* operands */
    uint32_t first_child, n_children; /* parts; none for an operand */
} NestPart;

typedef struct NestTree {
    uint32_t root; /* a part */
    uint32_t hull; /* or NEST_OPAQUE */
} NestTree;

typedef struct NestCsg {
    uint32_t first_operand; /* the number of hulls */
    uint32_t n_operands, n_trees, n_parts;
    NestPart *parts;
    NestTree *trees;
    uint32_t *tree_of_operand; /* counted from first_operand */
} NestCsg;

static inline uint32_t nest_csg_tree(const NestCsg *csg, uint32_t operand)
{
    return csg->tree_of_operand[operand - csg->first_operand];
}
/* Whether a point inside of the hulls and operands of the list is inside of the combination. Operands stand first in a
 * list, in increasing order. O(d log k) for d operands of the list among k. */
bool nest_csg_holds(const NestCsg *csg, uint32_t tree, const NestList *list);
/* Enters or leaves an operand; false, with the list as it was, when the list says that the ray is there already. The
 * list must have room. */
bool nest_csg_pass(const NestCsg *csg, NestList *list, uint32_t operand, bool entering);
/* Whether an operand is taken away from its combination, so that where it shows it is seen from its inside. */
bool nest_csg_takes(const NestCsg *csg, uint32_t operand);
/* Whether a place of an operand's surface, where the list holds, is on the surface of the combination; on which side of the
 * operand the list has the place does not matter. The list must have room for one more, and is as it was afterwards. */
bool nest_csg_shows(const NestCsg *csg, NestList *list, uint32_t operand);

#endif

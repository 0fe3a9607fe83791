/* upsample_solve.h - the sigmoid spectrum that has a given colour, found by iteration. For single
 * colours, and for the generator of upsample.c's table. For src/optics only.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_UPSAMPLE_SOLVE_H
#define MEN_UPSAMPLE_SOLVE_H

#include "optics/observer.h"

/* The quadrature of observer.h under white: rgb of a reflectance is the sum of weight * reflectance. */
typedef struct UpsampleSolver {
    double position[OBSERVER_NODES]; /* w in 0..1 */
    double weight[OBSERVER_NODES][3];
} UpsampleSolver;

void upsample_solver_init(UpsampleSolver *solver);

/* Improves coefficients (c0, c1, c2 of c0 + c1 w + c2 w^2) until the reflectance has the colour rgb,
 * channels in 0..1; returns the largest error of a channel that is left. A poor start can end in a
 * poor place; see upsample_solve. */
double upsample_improve(const UpsampleSolver *solver, const double rgb[3], double coefficients[3]);

/* The same from nothing, by continuation from grey. */
double upsample_solve(const UpsampleSolver *solver, const double rgb[3], double coefficients[3]);

/* Improves coefficients, or takes those from nothing where that ends in a better place; returns the error. */
double upsample_solve_near(const UpsampleSolver *solver, const double rgb[3], double coefficients[3]);

/* The constant reflectance: S(c0) = value. Saturates at 0 and 1. */
double upsample_constant(double value);

#endif

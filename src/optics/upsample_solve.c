/* upsample_solve.c - Gauss-Newton for the coefficients of [JH19], W. Jakob, J. Hanika, "A
 * Low-Dimensional Function Space for Efficient Spectral Upsampling" (2019), section 3.
 * Two deviations. The error is measured in linear RGB, not in CIELAB: where a colour can be met both
 * are zero at the same place, and linear RGB is what the renderer is held to. And the step is damped
 * (Levenberg-Marquardt), because saturated colours lie where the sigmoid is flat.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/upsample_solve.h"

#include <math.h>

/* Coefficients beyond this change nothing that a float can hold: S(1e4) is 1 - 3e-9. */
static const double saturated = 1e4;

void upsample_solver_init(UpsampleSolver *solver)
{
    for (int node = 0; node < OBSERVER_NODES; node++) {
        double nm = observer_node(node), range = (double)(SPECTRUM_MAX_NM - SPECTRUM_MIN_NM);
        float fraction;
        int row = observer_row((float)nm, 2 * SPECTRUM_STEP_NM, &fraction);
        double t = (double)fraction;
        double white = ((1 - t) * (double)observer_d65[row] + t * (double)observer_d65[row + 1]) * OBSERVER_WHITE_SCALE;
        solver->position[node] = (nm - (double)SPECTRUM_MIN_NM) / range;
        observer_node_rgb(node, solver->weight[node]);
        for (int c = 0; c < 3; c++) solver->weight[node][c] *= white;
    }
}

double upsample_constant(double value)
{
    if (value <= 0) return -saturated;
    if (value >= 1) return saturated;
    return fmin(fmax((value - 0.5) / sqrt(value * (1 - value)), -saturated), saturated);
}

/* residual = colour of the coefficients - rgb; jacobian[c][i] = d colour_c / d coefficient_i. Returns the
 * sum of squares. */
static double evaluate(const UpsampleSolver *solver, const double rgb[3], const double coefficients[3],
                       double residual[3], double jacobian[3][3])
{
    for (int c = 0; c < 3; c++) {
        residual[c] = -rgb[c];
        for (int i = 0; i < 3; i++) jacobian[c][i] = 0;
    }
    for (int node = 0; node < OBSERVER_NODES; node++) {
        double w = solver->position[node];
        double x = coefficients[0] + w * (coefficients[1] + w * coefficients[2]);
        double inverse = 1 / sqrt(1 + x * x);
        double sigmoid = 0.5 + 0.5 * x * inverse, slope = 0.5 * inverse * inverse * inverse;
        for (int c = 0; c < 3; c++) {
            double weight = solver->weight[node][c];
            residual[c] += weight * sigmoid;
            jacobian[c][0] += weight * slope;
            jacobian[c][1] += weight * slope * w;
            jacobian[c][2] += weight * slope * w * w;
        }
    }
    return residual[0] * residual[0] + residual[1] * residual[1] + residual[2] * residual[2];
}

/* Solves the symmetric 3 x 3 system m x = b by Cramer's rule; false when it is singular. */
static bool solve_symmetric(double m[3][3], const double b[3], double x[3])
{
    double c00 = m[1][1] * m[2][2] - m[1][2] * m[2][1], c01 = m[1][2] * m[2][0] - m[1][0] * m[2][2];
    double c02 = m[1][0] * m[2][1] - m[1][1] * m[2][0];
    double determinant = m[0][0] * c00 + m[0][1] * c01 + m[0][2] * c02;
    if (!(fabs(determinant) > 1e-300)) return false;
    double c11 = m[0][0] * m[2][2] - m[0][2] * m[2][0], c12 = m[0][1] * m[2][0] - m[0][0] * m[2][1];
    double c22 = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    x[0] = (c00 * b[0] + c01 * b[1] + c02 * b[2]) / determinant;
    x[1] = (c01 * b[0] + c11 * b[1] + c12 * b[2]) / determinant;
    x[2] = (c02 * b[0] + c12 * b[1] + c22 * b[2]) / determinant;
    return true;
}

/* Until the sum of squared errors is no more than `enough`; returns the largest error. */
static double improve(const UpsampleSolver *solver, const double rgb[3], double enough, double coefficients[3])
{
    enum { LIMIT = 200 };
    double residual[3], jacobian[3][3], damping = 1e-4;
    double error = evaluate(solver, rgb, coefficients, residual, jacobian);
    for (int step = 0; step < LIMIT && error > enough && damping < 1e12; step++) {
        double normal[3][3], gradient[3], change[3], tried[3];
        for (int i = 0; i < 3; i++) {
            gradient[i] = 0;
            for (int c = 0; c < 3; c++) gradient[i] -= jacobian[c][i] * residual[c];
            for (int j = 0; j < 3; j++) {
                normal[i][j] = 0;
                for (int c = 0; c < 3; c++) normal[i][j] += jacobian[c][i] * jacobian[c][j];
            }
        }
        for (int i = 0; i < 3; i++) normal[i][i] *= 1 + damping;
        double new_residual[3], new_jacobian[3][3], new_error = HUGE_VAL;
        if (solve_symmetric(normal, gradient, change)) {
            double largest = 0;
            for (int i = 0; i < 3; i++) {
                tried[i] = coefficients[i] + change[i];
                largest = fmax(largest, fabs(tried[i]));
            }
            if (largest < 4 * saturated) new_error = evaluate(solver, rgb, tried, new_residual, new_jacobian);
        }
        if (!(new_error < error)) {
            damping *= 8;
            continue;
        }
        damping = fmax(damping * 0.1, 1e-12);
        error = new_error;
        for (int c = 0; c < 3; c++) {
            coefficients[c] = tried[c];
            residual[c] = new_residual[c];
            for (int i = 0; i < 3; i++) jacobian[c][i] = new_jacobian[c][i];
        }
    }
    return fmax(fabs(residual[0]), fmax(fabs(residual[1]), fabs(residual[2])));
}

double upsample_improve(const UpsampleSolver *solver, const double rgb[3], double coefficients[3])
{
    return improve(solver, rgb, 1e-20, coefficients);
}

double upsample_solve(const UpsampleSolver *solver, const double rgb[3], double coefficients[3])
{
    enum { STEPS = 8 };
    double grey = (rgb[0] + rgb[1] + rgb[2]) / 3, error = 0;
    coefficients[0] = upsample_constant(fmin(fmax(grey, 1e-3), 1 - 1e-3));
    coefficients[1] = coefficients[2] = 0;
    for (int step = 1; step <= STEPS; step++) {
        double t = (double)step / STEPS, target[3];
        for (int c = 0; c < 3; c++) target[c] = grey + t * (rgb[c] - grey);
        error =
            improve(solver, target, step < STEPS ? 1e-5 : 1e-20, coefficients); /* on the way it need not be exact */
    }
    return error;
}

double upsample_solve_near(const UpsampleSolver *solver, const double rgb[3], double coefficients[3])
{
    double error = upsample_improve(solver, rgb, coefficients);
    if (error < 1e-7) return error;
    double fresh[3], fresh_error = upsample_solve(solver, rgb, fresh);
    if (fresh_error >= error) return error;
    for (int i = 0; i < 3; i++) coefficients[i] = fresh[i];
    return fresh_error;
}

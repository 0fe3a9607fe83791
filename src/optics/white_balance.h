/* white_balance.h - which light a picture shows as white.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_WHITE_BALANCE_H
#define MEN_WHITE_BALANCE_H

/* Linear colours of the working space, as seen by eyes that have adapted to the light of a black body of that temperature (K):
 * that light becomes grey, (1,1,1) where it was as bright as white. By scaling the responses of "Bradford" cones: K. M. Lam's
 * transform, linearized, as in ICC.1:2022 annex E; M. D. Fairchild, "Color Appearance Models", 3rd ed., chapter 9. matrix[row][column]. */
void white_balance(double kelvin, float matrix[3][3]);

#endif

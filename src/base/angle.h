/* angle.h - pi, and a degree in radians.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ANGLE_H
#define MEN_ANGLE_H

#define MEN_PI 3.14159265358979323846
#define MEN_DEGREE (MEN_PI / 180)

#endif

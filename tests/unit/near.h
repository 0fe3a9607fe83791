/* near.h - an assertion for doubles; cmocka 1.1 has one for floats only.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_NEAR_H
#define MEN_TEST_NEAR_H

#include <math.h>

/* |actual - expected| <= tolerance; NaN never is */
#define assert_near(actual, expected, tolerance)                                                                       \
    do {                                                                                                               \
        double near_actual_ = (actual), near_expected_ = (expected);                                                   \
        if (!(fabs(near_actual_ - near_expected_) <= (tolerance)))                                                     \
            fail_msg("%s is %.17g, not %.17g", #actual, near_actual_, near_expected_);                                 \
    } while (0)

#endif

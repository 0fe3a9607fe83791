/* test.h - what every cmocka test includes, in the order that cmocka wants; before all headers of the program.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_H
#define MEN_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/status.h" /* its fail() must be declared before cmocka makes a macro of that name */

#include <cmocka.h>

#endif

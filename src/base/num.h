/* num.h - doubles to and from text, without the C library's locale.
 * Both ways are exact: reading rounds correctly (half to even) for any number of digits, and what is printed is
 * the shortest text that reads back as the same double.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_NUM_H
#define MEN_NUM_H

#include <stddef.h>

/* Room for any printed double and its final 0 byte. */
enum { NUM_TEXT_SIZE = 32 };

/* Reads [+-] (digits [. [digits]] | . digits) [(e|E) [+-] digits] from the start of text, of which length bytes
 * are readable. Returns the number of bytes read, 0 (and *value as it was) where no number starts. A '.' that is
 * followed by another '.' is not part of the number ("1..5" reads 1), and neither is an 'e' without digits.
 * Too large gives INFINITY, too small 0. */
size_t num_parse(const char *text, size_t length, double *value);
/* The same, times what stands here, and rounded once: "92" with a power of -1 is 9.2. */
typedef struct NumScale {
    int power;         /* of ten */
    const char *times; /* a whole number of at most 80 digits; NULL: 1 */
    unsigned over;     /* a whole number below 10^8; 0: 1 */
} NumScale;
size_t num_parse_scaled(const char *text, size_t length, NumScale scale, double *value);
/* n finite numbers with commas between them; returns where reading stopped, NULL when there are not as many. */
const char *num_parse_list(const char *text, double *numbers, int n);

/* Writes value, terminated, and returns its length: "0.1", "-3", "1e+20" is "1e20", "inf", "-inf", "nan". */
size_t num_print(double value, char out[NUM_TEXT_SIZE]);
/* The shortest text that reads back as the same float: 1.34f is 1.34, and not 1.340000033378601. */
size_t num_print_float(float value, char out[NUM_TEXT_SIZE]);
/* The same for people, without the noise of rounding behind the 15th digit: 0.1 + 0.2 is 0.3, and not
 * 0.30000000000000004. */
size_t num_print_rounded(double value, char out[NUM_TEXT_SIZE]);
/* A number above 0 in so many digits, and not more than it is: for limits that somebody may write down. */
double num_round_down(double value, int digits);

#endif

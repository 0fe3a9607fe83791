/* num.c - reading and printing of doubles.
 * Numbers of up to 19 digits with small exponents, which is nearly all that scenes and meshes hold, take one of
 * two short exact ways: a product or quotient of two exact doubles (Clinger 1990), or one division of 128 by 64
 * bits. The rest goes through a decimal of many digits that is shifted by powers of two, slow and exact.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/num.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* ---- the decimal of many digits: 0.d[0]d[1]... * 10^point ---- */

enum { DECIMAL_DIGITS = 800 }; /* a double needs at most 767 to be told from its neighbours' midpoint */
enum { MANTISSA_BITS = 52, LARGEST_SHIFT = 59 };

typedef struct Decimal {
    int n, point;
    bool truncated; /* digits other than 0 were lost behind the last */
    unsigned char d[DECIMAL_DIGITS];
} Decimal;

static void decimal_trim(Decimal *a)
{
    while (a->n > 0 && a->d[a->n - 1] == 0) a->n--;
    if (a->n == 0) a->point = 0;
}

static void decimal_set(Decimal *a, uint64_t value)
{
    unsigned char reversed[20];
    int n = 0;
    for (; value; value /= 10) reversed[n++] = (unsigned char)(value % 10);
    a->n = a->point = n;
    a->truncated = false;
    for (int i = 0; i < n; i++) a->d[i] = reversed[n - 1 - i];
    decimal_trim(a);
}

static void decimal_shift_right(Decimal *a, int k)
{
    int read = 0, write = 0;
    uint64_t n = 0, mask = ((uint64_t)1 << k) - 1;
    for (; n >> k == 0; read++) {
        if (read >= a->n) {
            if (n == 0) {
                a->n = a->point = 0;
                return;
            }
            for (; n >> k == 0; read++) n *= 10;
            break;
        }
        n = n * 10 + a->d[read];
    }
    a->point -= read - 1;
    for (; read < a->n; read++) {
        a->d[write++] = (unsigned char)(n >> k);
        n = (n & mask) * 10 + a->d[read];
    }
    while (n > 0) {
        unsigned char digit = (unsigned char)(n >> k);
        n = (n & mask) * 10;
        if (write < DECIMAL_DIGITS)
            a->d[write++] = digit;
        else if (digit)
            a->truncated = true;
    }
    a->n = write;
    decimal_trim(a);
}

static void decimal_shift_left(Decimal *a, int k)
{
    unsigned char head[20];
    int n_head = 0;
    uint64_t carry = 0;
    for (int i = a->n - 1; i >= 0; i--) {
        uint64_t sum = ((uint64_t)a->d[i] << k) + carry;
        a->d[i] = (unsigned char)(sum % 10);
        carry = sum / 10;
    }
    for (; carry; carry /= 10) head[n_head++] = (unsigned char)(carry % 10);
    int kept = a->n + n_head > DECIMAL_DIGITS ? DECIMAL_DIGITS - n_head : a->n;
    for (int i = kept; i < a->n; i++)
        if (a->d[i]) a->truncated = true;
    memmove(a->d + n_head, a->d, (size_t)kept);
    for (int i = 0; i < n_head; i++) a->d[i] = head[n_head - 1 - i];
    a->n = kept + n_head;
    a->point += n_head;
    decimal_trim(a);
}

/* Times a whole number, of at most MOST_TIMES digits. */
enum { MOST_TIMES = 80 };
static void decimal_times(Decimal *a, const char *number)
{
    unsigned char product[DECIMAL_DIGITS + MOST_TIMES];
    int n_times = (int)strlen(number), n = a->n + n_times, first = 0;
    if (a->n == 0) return;
    unsigned carry = 0;
    for (int place = n - 1; place >= 0; place--) { /* of digits i and j, for which i + j + 1 is the place */
        unsigned sum = carry;
        for (int j = 0; j < n_times; j++) {
            int i = place - 1 - j;
            if (i >= 0 && i < a->n) sum += (unsigned)(a->d[i] * (number[j] - '0'));
        }
        product[place] = (unsigned char)(sum % 10);
        carry = sum / 10;
    }
    while (product[first] == 0) first++;
    a->point += n_times - first;
    n -= first;
    a->n = n < DECIMAL_DIGITS ? n : DECIMAL_DIGITS;
    memcpy(a->d, product + first, (size_t)a->n);
    for (int i = a->n; i < n; i++)
        if (product[first + i]) a->truncated = true;
    decimal_trim(a);
}

/* Divides by a whole number below 10^8. */
static void decimal_divide(Decimal *a, uint32_t divisor)
{
    unsigned char quotient[DECIMAL_DIGITS];
    int n = 0, read = 0, point = a->point;
    uint64_t rest = 0;
    if (a->n == 0 || divisor == 1) return;
    while (n < DECIMAL_DIGITS && (read < a->n || rest)) {
        rest = rest * 10 + (read < a->n ? a->d[read] : 0);
        read++;
        if (n == 0 && rest < divisor)
            point--;
        else
            quotient[n++] = (unsigned char)(rest / divisor);
        rest %= divisor;
    }
    if (rest || read < a->n) a->truncated = true; /* the last digit of a decimal is not 0 */
    memcpy(a->d, quotient, (size_t)n);
    a->n = n;
    a->point = point;
    decimal_trim(a);
}

/* multiplies by 2^k */
static void decimal_shift(Decimal *a, int k)
{
    if (a->n == 0) return;
    for (; k > LARGEST_SHIFT; k -= LARGEST_SHIFT) decimal_shift_left(a, LARGEST_SHIFT);
    for (; k < -LARGEST_SHIFT; k += LARGEST_SHIFT) decimal_shift_right(a, LARGEST_SHIFT);
    if (k > 0) decimal_shift_left(a, k);
    if (k < 0) decimal_shift_right(a, -k);
}

/* would rounding to n digits, half to even, go up? */
static bool decimal_rounds_up(const Decimal *a, int n)
{
    if (n < 0 || n >= a->n) return false;
    if (a->d[n] == 5 && n + 1 == a->n) return a->truncated || (n > 0 && a->d[n - 1] % 2);
    return a->d[n] >= 5;
}

static uint64_t decimal_to_integer(const Decimal *a)
{
    uint64_t value = 0;
    for (int i = 0; i < a->point; i++) value = value * 10 + (i < a->n ? a->d[i] : 0);
    return value + decimal_rounds_up(a, a->point);
}

static double decimal_to_double(Decimal *a)
{
    /* how far to shift so that so many decimal digits go away but no more */
    static const int steps[] = {1, 3, 6, 9, 13, 16, 19, 23, 26};
    const int n_steps = (int)(sizeof steps / sizeof steps[0]);
    if (a->n == 0 || a->point < -330) return 0;
    if (a->point > 310) return (double)INFINITY;
    int exponent = 0;
    while (a->point > 0) {
        int k = a->point >= n_steps ? 27 : steps[a->point];
        decimal_shift(a, -k);
        exponent += k;
    }
    while (a->point < 0 || (a->point == 0 && a->d[0] < 5)) {
        int k = -a->point >= n_steps ? 27 : steps[-a->point];
        decimal_shift(a, k);
        exponent -= k;
    }
    exponent--; /* 0.5 <= a < 1 became 1 <= mantissa < 2 */
    if (exponent < -1022) {
        decimal_shift(a, exponent + 1022);
        exponent = -1022;
    }
    decimal_shift(a, MANTISSA_BITS + 1);
    return ldexp((double)decimal_to_integer(a), exponent - MANTISSA_BITS);
}

/* ---- reading ---- */

typedef struct Scan {
    uint64_t mantissa; /* the first 19 significant digits */
    int exponent;      /* of ten, for mantissa */
    bool more;         /* there were more significant digits */
} Scan;

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static const double exact_powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
enum { LARGEST_EXACT_POWER = 22, LARGEST_INTEGER_POWER = 19, KEPT_DIGITS = 19 };

static uint64_t integer_power(int k)
{
    uint64_t power = 1;
    while (k-- > 0) power *= 10;
    return power;
}

/* floor(u * 2^64 / v) for u < v and v >= 2^63; *inexact when a remainder is left. Two steps of schoolbook
 * division with digits of 32 bits (Knuth, vol. 2, 4.3.1, algorithm D). */
static uint64_t divide_wide(uint64_t u, uint64_t v, bool *inexact)
{
    uint64_t v1 = v >> 32, v0 = v & 0xffffffffU, quotient = 0;
    for (int step = 0; step < 2; step++) {
        uint64_t q = u / v1, r = u % v1;
        while (q >> 32 || q * v0 > r << 32) {
            q--;
            r += v1;
            if (r >> 32) break;
        }
        u = (u << 32) - q * v;
        quotient = quotient << 32 | q;
    }
    *inexact = u != 0;
    return quotient;
}

/* The double nearest to (mantissa + sticky) * 2^shift, for a mantissa whose top bit is set and results in the
 * normal range. */
static double round_bits(uint64_t mantissa, bool sticky, int shift)
{
    uint64_t rest = mantissa & 0x7ff, top = mantissa >> 11;
    if (rest > 0x400 || (rest == 0x400 && (sticky || top % 2))) top++;
    return ldexp((double)top, shift + 11);
}

/* mantissa / 10^k for 0 < k <= 19, correctly rounded */
static double divide_exactly(uint64_t mantissa, int k)
{
    uint64_t divisor = integer_power(k);
    int shift = 0;
    for (; !(divisor >> 63); shift++) divisor <<= 1;
    for (; !(mantissa >> 63); shift--) mantissa <<= 1;
    bool low = mantissa & 1; /* halving makes mantissa < divisor sure; its lost bit is looked at below */
    bool inexact;
    if (mantissa < divisor) {
        uint64_t quotient = divide_wide(mantissa, divisor, &inexact);
        for (; !(quotient >> 63); shift--) { /* at most once, and then the last bit is not known */
            if (inexact) return (double)NAN;
            quotient <<= 1;
        }
        return round_bits(quotient, inexact, shift - 64);
    }
    if (low) return (double)NAN;
    uint64_t quotient = divide_wide(mantissa >> 1, divisor, &inexact);
    if (!(quotient >> 63)) return (double)NAN;
    return round_bits(quotient, inexact, shift + 1 - 64);
}

static double slow_value(const char *text, size_t length, int exponent, const NumScale *scale)
{
    Decimal a = {0};
    bool point = false;
    int lost = 0; /* digits in front of the point that did not fit */
    for (size_t i = 0; i < length; i++) {
        if (text[i] == '.') {
            point = true;
            continue;
        }
        if (!is_digit(text[i])) break;
        unsigned char digit = (unsigned char)(text[i] - '0');
        if (a.n == 0 && digit == 0) {
            if (point) a.point--;
            continue;
        }
        if (a.n < DECIMAL_DIGITS) {
            a.d[a.n++] = digit;
            if (!point) a.point++;
        } else {
            if (digit) a.truncated = true;
            if (!point && lost < 100000) lost++;
        }
    }
    a.point += lost + exponent;
    int point_of_digits = a.point;
    decimal_trim(&a);
    if (a.n) a.point = point_of_digits;
    if (scale->times) decimal_times(&a, scale->times);
    if (scale->over) decimal_divide(&a, scale->over);
    return decimal_to_double(&a);
}

static double value_of(const Scan *scan, const char *text, size_t length, int written_exponent, const NumScale *scale)
{
    if (scan->mantissa == 0) return 0;
    if (!scan->more && !scale->times && !scale->over) {
        int e = scan->exponent;
        if (scan->mantissa <= (uint64_t)1 << 53) {
            if (e >= 0 && e <= LARGEST_EXACT_POWER) return (double)scan->mantissa * exact_powers[e];
            if (e < 0 && e >= -LARGEST_EXACT_POWER) return (double)scan->mantissa / exact_powers[-e];
        } else if (e == 0) {
            return (double)scan->mantissa;
        } else if (e < 0 && e >= -LARGEST_INTEGER_POWER) {
            double value = divide_exactly(scan->mantissa, -e);
            if (!isnan(value)) return value;
        }
    }
    return slow_value(text, length, written_exponent, scale);
}

static size_t scan_exponent(const char *text, size_t length, int *exponent)
{
    size_t i = 1;
    bool negative = false;
    if (i < length && (text[i] == '+' || text[i] == '-')) negative = text[i++] == '-';
    if (i >= length || !is_digit(text[i])) return 0;
    int e = 0;
    for (; i < length && is_digit(text[i]); i++)
        if (e < 100000) e = e * 10 + (text[i] - '0');
    *exponent = negative ? -e : e;
    return i;
}

size_t num_parse(const char *text, size_t length, double *value)
{
    return num_parse_scaled(text, length, (NumScale){.power = 0}, value);
}

size_t num_parse_scaled(const char *text, size_t length, NumScale scale, double *value)
{
    size_t i = 0;
    bool negative = false;
    if (i < length && (text[i] == '+' || text[i] == '-')) negative = text[i++] == '-';
    size_t first = i;
    Scan scan = {0};
    int n_kept = 0, n_digits = 0;
    bool point = false;
    for (; i < length; i++) {
        char c = text[i];
        if (c == '.') {
            if (point || (i + 1 < length && text[i + 1] == '.')) break;
            point = true;
            continue;
        }
        if (!is_digit(c)) break;
        n_digits++;
        if (n_kept < KEPT_DIGITS) {
            scan.mantissa = scan.mantissa * 10 + (uint64_t)(c - '0');
            if (scan.mantissa) n_kept++;
            if (point && scan.exponent > -100000) scan.exponent--;
        } else {
            if (c != '0') scan.more = true;
            if (!point && scan.exponent < 100000) scan.exponent++;
        }
    }
    if (n_digits == 0) return 0;
    size_t end_of_digits = i;
    int written_exponent = 0;
    if (i < length && (text[i] == 'e' || text[i] == 'E')) i += scan_exponent(text + i, length - i, &written_exponent);
    written_exponent += scale.power;
    scan.exponent += written_exponent;
    double result = value_of(&scan, text + first, end_of_digits - first, written_exponent, &scale);
    *value = negative ? -result : result;
    return i;
}

/* ---- printing ---- */

static void decimal_round_down(Decimal *a, int n)
{
    if (n >= 0 && n < a->n) {
        a->n = n;
        decimal_trim(a);
    }
}

static void decimal_round_up(Decimal *a, int n)
{
    if (n < 0 || n >= a->n) return;
    for (int i = n - 1; i >= 0; i--)
        if (a->d[i] < 9) {
            a->d[i]++;
            a->n = i + 1;
            return;
        }
    a->d[0] = 1; /* all were 9 */
    a->n = 1;
    a->point++;
}

/* What a number is stored in. */
typedef struct Format {
    int mantissa_bits;  /* without the leading 1 */
    int least_exponent; /* of numbers that have one */
} Format;
static const Format format_of_double = {MANTISSA_BITS, -1022}, format_of_float = {23, -126};

/* Shortens a, the exact value of mantissa * 2^(exponent - mantissa_bits), to the fewest digits that still lie between the
 * midpoints to its neighbours (Steele & White 1990, in the digit-by-digit form). */
static void decimal_shorten(Decimal *a, uint64_t mantissa, int exponent, const Format *format)
{
    Decimal upper, lower;
    decimal_set(&upper, mantissa * 2 + 1);
    decimal_shift(&upper, exponent - format->mantissa_bits - 1);
    if (mantissa > (uint64_t)1 << format->mantissa_bits || exponent == format->least_exponent) {
        decimal_set(&lower, mantissa * 2 - 1);
        decimal_shift(&lower, exponent - format->mantissa_bits - 1);
    } else { /* below a power of two the neighbours are twice as near */
        decimal_set(&lower, mantissa * 4 - 1);
        decimal_shift(&lower, exponent - format->mantissa_bits - 2);
    }
    bool inclusive = mantissa % 2 == 0; /* ties round to even, so the midpoints read back as this one */
    int above = 0; /* how far upper is known to lie above the digits so far: 0 equal, 1 by one unit, 2 more */
    for (int i = 0;; i++) {
        int middle = i - upper.point + a->point, low = i - upper.point + lower.point;
        if (middle >= a->n) return;
        int l = low >= 0 && low < lower.n ? lower.d[low] : 0;
        int m = middle >= 0 ? a->d[middle] : 0;
        int u = i < upper.n ? upper.d[i] : 0;
        bool down_ok = l != m || (inclusive && low + 1 == lower.n);
        if (above == 0 && m != u)
            above = m + 1 < u ? 2 : 1;
        else if (above == 1 && (m != 9 || u != 0))
            above = 2;
        bool up_ok = above > 0 && (inclusive || above > 1 || i + 1 < upper.n);
        if (!down_ok && !up_ok) continue;
        if (down_ok && (!up_ok || !decimal_rounds_up(a, middle + 1)))
            decimal_round_down(a, middle + 1);
        else
            decimal_round_up(a, middle + 1);
        return;
    }
}

static size_t print_integer(uint64_t value, char *out)
{
    char reversed[20];
    size_t n = 0;
    do reversed[n++] = (char)('0' + value % 10);
    while (value /= 10);
    for (size_t i = 0; i < n; i++) out[i] = reversed[n - 1 - i];
    return n;
}

static size_t print_digits(const Decimal *a, char *out)
{
    char *to = out;
    if (a->point > -5 && a->point <= 0) {
        *to++ = '0';
        *to++ = '.';
        for (int i = a->point; i < 0; i++) *to++ = '0';
        for (int i = 0; i < a->n; i++) *to++ = (char)('0' + a->d[i]);
    } else if (a->point > 0 && a->point <= 17) {
        for (int i = 0; i < a->n || i < a->point; i++) {
            if (i == a->point) *to++ = '.';
            *to++ = (char)('0' + (i < a->n ? a->d[i] : 0));
        }
    } else {
        for (int i = 0; i < a->n; i++) {
            if (i == 1) *to++ = '.';
            *to++ = (char)('0' + a->d[i]);
        }
        *to++ = 'e';
        int exponent = a->point - 1;
        if (exponent < 0) *to++ = '-';
        to += print_integer((uint64_t)(exponent < 0 ? -exponent : exponent), to);
    }
    return (size_t)(to - out);
}

/* A decimal number of 15 digits comes out of a double as it was; what a few computations add to a round one stands behind
 * those, and in front of it there are zeros or nines. */
static void decimal_drop_noise(Decimal *a)
{
    enum { SAFE_DIGITS = 15, ROUND_DIGITS = 12 };
    Decimal rounded = *a;
    if (decimal_rounds_up(a, SAFE_DIGITS))
        decimal_round_up(&rounded, SAFE_DIGITS);
    else
        decimal_round_down(&rounded, SAFE_DIGITS);
    if (rounded.n <= ROUND_DIGITS) *a = rounded;
}

static size_t print_number(double value, const Format *format, bool noise, char out[NUM_TEXT_SIZE])
{
    size_t n = 0;
    if (isnan(value)) {
        memcpy(out, "nan", 4);
        return 3;
    }
    if (signbit(value)) out[n++] = '-';
    value = fabs(value);
    if (isinf(value)) {
        memcpy(out + n, "inf", 4);
        return n + 3;
    }
    if (value < ldexp(2, format->mantissa_bits) && value == (double)(uint64_t)value) {
        n += print_integer((uint64_t)value, out + n);
    } else {
        int exponent = ilogb(value);
        if (exponent < format->least_exponent) exponent = format->least_exponent;
        uint64_t mantissa = (uint64_t)ldexp(value, format->mantissa_bits - exponent);
        Decimal a;
        decimal_set(&a, mantissa);
        decimal_shift(&a, exponent - format->mantissa_bits);
        decimal_shorten(&a, mantissa, exponent, format);
        if (!noise) decimal_drop_noise(&a);
        n += print_digits(&a, out + n);
    }
    out[n] = 0;
    return n;
}

size_t num_print(double value, char out[NUM_TEXT_SIZE])
{
    return print_number(value, &format_of_double, true, out);
}

size_t num_print_float(float value, char out[NUM_TEXT_SIZE])
{
    return print_number((double)value, &format_of_float, true, out);
}

size_t num_print_rounded(double value, char out[NUM_TEXT_SIZE])
{
    return print_number(value, &format_of_double, false, out);
}

const char *num_parse_list(const char *text, double *numbers, int n)
{
    for (int i = 0; i < n; i++) {
        size_t used = num_parse(text, strlen(text), &numbers[i]);
        if (!used || !isfinite(numbers[i])) return NULL;
        text += used;
        if (i + 1 < n && *text++ != ',') return NULL;
    }
    return text;
}

double num_round_down(double value, int digits)
{
    if (!(value > 0) || !isfinite(value)) return value;
    double unit = pow(10, floor(log10(value)) - (digits - 1));
    return floor(value / unit) * unit;
}

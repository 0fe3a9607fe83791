/* utf8_test.c - decoding and encoding of UTF-8, and the columns of code points.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/attr.h"
#include "base/utf8.h"

static void test_codes(void **state)
{
    static const struct {
        const char *text;
        size_t length, taken;
        uint32_t code;
    } cases[] = {
        {"a", 1, 1, 'a'},
        {"\xc3\xa9", 2, 2, 0xe9},
        {"\xe2\x82\xac", 3, 3, 0x20ac},
        {"\xf0\x9f\x8d\xb8", 4, 4, 0x1f378},
        {"\xc3\xa9", 1, 1, UTF8_INVALID},
        {"\xc0\x80", 2, 1, UTF8_INVALID},         /* overlong */
        {"\xed\xa0\x80", 3, 1, UTF8_INVALID},     /* a surrogate */
        {"\xf4\x90\x80\x80", 4, 1, UTF8_INVALID}, /* beyond the last */
        {"\x80", 1, 1, UTF8_INVALID},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        uint32_t code;
        char bytes[4];
        assert_int_equal(utf8_decode(cases[i].text, cases[i].length, &code), cases[i].taken);
        assert_int_equal(code, cases[i].code);
        if (code == UTF8_INVALID) continue;
        assert_int_equal(utf8_encode(code, bytes), cases[i].taken);
        assert_memory_equal(bytes, cases[i].text, cases[i].taken);
    }
}

static void test_widths(void **state)
{
    static const struct {
        const char *what;
        uint32_t first, last;
        unsigned width;
    } cases[] = {
        {"ASCII", ' ', '~', 1},
        {"Latin letters", 0xc0, 0x24f, 1},
        {"combining marks", 0x300, 0x36f, 0},
        {"a zero-width space", 0x200b, 0x200b, 0},
        {"Japanese letters", 0x3041, 0x3096, 2},
        {"combining marks among those", 0x3099, 0x309a, 0},
        {"Chinese characters", 0x4e00, 0x9fff, 2},
        {"reserved for more of them", 0x3fffd, 0x3fffd, 2},
        {"Hangul syllables", 0xac00, 0xd7a3, 2},
        {"what stands behind those", 0xd7a4, 0xd7fb, 1},
        {"full-width letters", 0xff01, 0xff60, 2},
        {"half-width ones", 0xff61, 0xffdc, 1},
        {"a cocktail glass", 0x1f378, 0x1f378, 2},
        {"faces", 0x1f600, 0x1f64f, 2},
        {"a plate that is text first", 0x1f37d, 0x1f37d, 1},
        {"unassigned among Greek letters", 0x378, 0x379, 1},
        {"Kawi letters, of a later version", 0x11f04, 0x11f10, 1},
        {"for private use", 0xe000, 0xf8ff, 1},
        {"the last", 0x10ffff, 0x10ffff, 1},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++)
        for (uint32_t code = cases[i].first; code <= cases[i].last; code++)
            if (utf8_width(code) != cases[i].width)
                fail_msg("%s, %x: %u columns, not %u", cases[i].what, (unsigned)code, utf8_width(code), cases[i].width);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_codes), cmocka_unit_test(test_widths)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

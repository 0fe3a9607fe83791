/* memory_test.c - memory of which most is never touched.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/memory.h"

static void sparse_memory_is_zero_and_can_be_written(void **state)
{
    (void)state;
    static const size_t sizes[] = {64, (size_t)1 << 20, (size_t)3 << 29};
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        if (sizes[i] > SIZE_MAX / 2) continue;
        unsigned char *memory = memory_sparse(sizes[i] / 4, 4);
        assert_non_null(memory);
        for (size_t at = 0; at < sizes[i]; at += sizes[i] / 16) {
            assert_int_equal(memory[at], 0);
            memory[at] = 7;
        }
        assert_int_equal(memory[sizes[i] - 1], 0);
        memory_sparse_free(memory, sizes[i]);
    }
    memory_sparse_free(NULL, 100);
}

static void what_no_address_space_holds_is_refused(void **state)
{
    (void)state;
    assert_null(memory_sparse(SIZE_MAX / 2, 4));
    assert_null(memory_sparse(SIZE_MAX / 8, 4));
}

static void the_machine_has_memory(void **state)
{
    (void)state;
    double bytes = memory_of_machine();
    assert_true(bytes == 0 || bytes > 1e7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sparse_memory_is_zero_and_can_be_written),
        cmocka_unit_test(what_no_address_space_holds_is_refused),
        cmocka_unit_test(the_machine_has_memory),
    };
    return cmocka_run_group_tests_name("memory", tests, NULL, NULL);
}

/* temporary.h - a folder of a test program's own, made before its tests and removed after them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_TEMPORARY_H
#define MEN_TEST_TEMPORARY_H

static char folder[] = "/tmp/meniscus-test-XXXXXX";

/* The path of a file in the folder; the text stays until the second call after this one. */
static inline const char *in_folder(const char *name)
{
    static char path[2][256];
    static int turn;
    turn = !turn;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

/* The group's set-up and tear-down. */
static inline int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static inline int remove_folder(void **state)
{
    (void)state;
    char command[300];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

static inline void write_bytes(const char *path, const void *bytes, size_t length)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, length, stream), length);
    assert_int_equal(fclose(stream), 0);
}

#endif

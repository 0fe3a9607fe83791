/* file_test.c - whole reads, and writes that appear whole or not at all.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/file_reads.h"
#include "temporary.h"

static size_t count_entries(void)
{
    size_t n = 0;
    DIR *open_folder = opendir(folder);
    assert_non_null(open_folder);
    for (struct dirent *entry; (entry = readdir(open_folder));) n += entry->d_name[0] != '.';
    closedir(open_folder);
    return n;
}

static void write_text(const char *path, const char *text)
{
    FileOut out;
    Error error;
    assert_int_equal(file_create(&out, path, &error), STATUS_OK);
    assert_true(fputs(text, out.stream) >= 0);
    assert_int_equal(file_commit(&out, &error), STATUS_OK);
}

static void expect_text(const char *path, const char *text)
{
    char *bytes;
    size_t length;
    Error error;
    assert_int_equal(file_read(path, 0, &bytes, &length, &error), STATUS_OK);
    assert_int_equal(length, strlen(text));
    assert_string_equal(bytes, text); /* and a 0 byte behind it */
    free(bytes);
}

static void test_write_and_read(void **state)
{
    (void)state;
    write_text(in_folder("a.txt"), "one\n");
    expect_text(in_folder("a.txt"), "one\n");
    write_text(in_folder("a.txt"), "two");
    expect_text(in_folder("a.txt"), "two");
    write_text(in_folder("empty"), "");
    expect_text(in_folder("empty"), "");
    assert_int_equal(count_entries(), 2);
    assert_true(file_exists(in_folder("a.txt")));
    assert_false(file_exists(folder));
}

static void test_abandon(void **state)
{
    FileOut out;
    Error error;
    (void)state;
    write_text(in_folder("kept"), "old");
    assert_int_equal(file_create(&out, in_folder("kept"), &error), STATUS_OK);
    fputs("new", out.stream);
    expect_text(in_folder("kept"), "old"); /* nothing to be seen before the commit */
    file_abandon(&out);
    file_abandon(&out);
    expect_text(in_folder("kept"), "old");
    unlink(in_folder("kept"));
    assert_int_equal(count_entries(), 2);
}

static void test_link_and_mode(void **state)
{
    (void)state;
    char target[128];
    struct stat info;
    snprintf(target, sizeof target, "%s", in_folder("a.txt"));
    assert_int_equal(chmod(target, 0640), 0);
    assert_int_equal(symlink(target, in_folder("link")), 0);
    write_text(in_folder("link"), "through the link");
    assert_int_equal(lstat(in_folder("link"), &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    expect_text(target, "through the link");
    assert_int_equal(stat(target, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);
    unlink(in_folder("link"));
}

static void test_read_failures(void **state)
{
    char *bytes;
    size_t length;
    Error error;
    (void)state;
    assert_int_equal(file_read(in_folder("none"), 0, &bytes, &length, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "none"));
    assert_int_equal(file_read(folder, 0, &bytes, &length, &error), STATUS_INPUT);
    write_text(in_folder("long"), "0123456789");
    assert_int_equal(file_read(in_folder("long"), 9, &bytes, &length, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "9 bytes"));
    assert_int_equal(file_read("/dev/zero", 100000, &bytes, &length, &error), STATUS_INPUT);
    unlink(in_folder("long"));
}

static void test_write_failures(void **state)
{
    FileOut out;
    Error error;
    (void)state;
    assert_int_equal(file_create(&out, "/no/such/folder/file", &error), STATUS_OUTPUT);
    file_abandon(&out);
    assert_int_equal(file_create(&out, "/dev/full", &error), STATUS_OK);
    assert_true(out.plain);
    fputs("does not fit", out.stream);
    assert_int_equal(file_commit(&out, &error), STATUS_OUTPUT);
    assert_non_null(strstr(error.text, "/dev/full"));
}

static void test_names(void **state)
{
    (void)state;
    char *name = file_folder("a/b/c.mns");
    assert_string_equal(name, "a/b/");
    free(name);
    name = file_folder("c.mns");
    assert_string_equal(name, "");
    free(name);
    assert_string_equal(file_extension("a.b/c.EXR"), "EXR");
    assert_string_equal(file_extension("a.b/c"), "");
    assert_string_equal(file_extension(".hidden"), "");
}

/* The name of the temporary file is longer than that of the file, and must not be too long. */
static void test_long_names(void **state)
{
    (void)state;
    for (size_t length = 235; length <= 255; length++) {
        char name[256] = "", path[300];
        for (size_t i = 0; i + 2 <= length; i += 2) memcpy(name + i, "\xc3\xa9", 3);
        if (length % 2) strcat(name, "x");
        snprintf(path, sizeof path, "%s/%s", folder, name);
        write_text(path, "long");
        expect_text(path, "long");
        assert_int_equal(unlink(path), 0);
    }
    char *first = file_temporary_name("a/b.exr", 3), *second = file_temporary_name("b.exr", 0);
    assert_int_equal(strncmp(first, "a/b.exr.", 8), 0);
    assert_string_equal(first + strlen(first) - 6, "-3.tmp");
    assert_int_equal(strncmp(second, "b.exr.", 6), 0);
    free(first);
    free(second);
}

/* Written over, by another file or in place; gone and there again; missed and there at last. */
static void test_changes(void **state)
{
    (void)state;
    char *bytes, once[256], late[256];
    size_t length;
    Error error;
    snprintf(once, sizeof once, "%s", in_folder("once"));
    snprintf(late, sizeof late, "%s", in_folder("late"));
    file_forget_reads();
    write_text(once, "one");
    expect_text(once, "one");
    assert_true(file_was_read(once));
    assert_int_equal(file_count_reads(), 1);
    assert_null(file_find_changed());
    write_text(once, "one"); /* the same text, but who knows */
    assert_string_equal(file_find_changed(), once);
    assert_true(file_renote_reads());
    assert_false(file_renote_reads());
    assert_null(file_find_changed());
    write_bytes(once, "longer", 6);
    assert_string_equal(file_find_changed(), once);
    file_forget_reads();
    assert_false(file_was_read(once));
    expect_text(once, "longer");
    assert_int_equal(unlink(once), 0);
    assert_string_equal(file_find_changed(), once);
    file_forget_reads();
    assert_int_equal(file_read(late, 0, &bytes, &length, &error), STATUS_INPUT);
    assert_int_equal(file_count_reads(), 0);
    assert_null(file_find_changed());
    write_text(late, "here");
    assert_string_equal(file_find_changed(), late);
    file_forget_reads();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write_and_read), cmocka_unit_test(test_abandon),
        cmocka_unit_test(test_link_and_mode),  cmocka_unit_test(test_read_failures),
        cmocka_unit_test(test_write_failures), cmocka_unit_test(test_names),
        cmocka_unit_test(test_changes),        cmocka_unit_test(test_long_names),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

/* file_test.c - whole reads, and writes that appear whole or not at all.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/meniscus-file-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char path[512];
    DIR *open_folder = opendir(folder);
    for (struct dirent *entry; open_folder && (entry = readdir(open_folder));) {
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        unlink(path);
    }
    if (open_folder) closedir(open_folder);
    return rmdir(folder);
}

static const char *path_of(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

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
    write_text(path_of("a.txt"), "one\n");
    expect_text(path_of("a.txt"), "one\n");
    write_text(path_of("a.txt"), "two");
    expect_text(path_of("a.txt"), "two");
    write_text(path_of("empty"), "");
    expect_text(path_of("empty"), "");
    assert_int_equal(count_entries(), 2);
    assert_true(file_exists(path_of("a.txt")));
    assert_false(file_exists(folder));
}

static void test_abandon(void **state)
{
    FileOut out;
    Error error;
    (void)state;
    write_text(path_of("kept"), "old");
    assert_int_equal(file_create(&out, path_of("kept"), &error), STATUS_OK);
    fputs("new", out.stream);
    expect_text(path_of("kept"), "old"); /* nothing to be seen before the commit */
    file_abandon(&out);
    file_abandon(&out);
    expect_text(path_of("kept"), "old");
    unlink(path_of("kept"));
    assert_int_equal(count_entries(), 2);
}

static void test_link_and_mode(void **state)
{
    (void)state;
    char target[128];
    struct stat info;
    snprintf(target, sizeof target, "%s", path_of("a.txt"));
    assert_int_equal(chmod(target, 0640), 0);
    assert_int_equal(symlink(target, path_of("link")), 0);
    write_text(path_of("link"), "through the link");
    assert_int_equal(lstat(path_of("link"), &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    expect_text(target, "through the link");
    assert_int_equal(stat(target, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);
    unlink(path_of("link"));
}

static void test_read_failures(void **state)
{
    char *bytes;
    size_t length;
    Error error;
    (void)state;
    assert_int_equal(file_read(path_of("none"), 0, &bytes, &length, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "none"));
    assert_int_equal(file_read(folder, 0, &bytes, &length, &error), STATUS_INPUT);
    write_text(path_of("long"), "0123456789");
    assert_int_equal(file_read(path_of("long"), 9, &bytes, &length, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "9 bytes"));
    assert_int_equal(file_read("/dev/zero", 100000, &bytes, &length, &error), STATUS_INPUT);
    unlink(path_of("long"));
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

static void test_halves(void **state)
{
    char *temporary;
    Error error;
    (void)state;
    assert_int_equal(file_temporary_path(path_of("half"), &temporary, &error), STATUS_OK);
    assert_string_not_equal(temporary, path_of("half"));
    FILE *stream = fopen(temporary, "wb");
    assert_non_null(stream);
    fputs("half", stream);
    fclose(stream);
    assert_false(file_exists(path_of("half")));
    assert_int_equal(file_rename_into_place(temporary, path_of("half"), &error), STATUS_OK);
    expect_text(path_of("half"), "half");
    free(temporary);
    assert_int_equal(file_temporary_path("/dev/null", &temporary, &error), STATUS_OK);
    assert_string_equal(temporary, "/dev/null");
    assert_int_equal(file_rename_into_place(temporary, "/dev/null", &error), STATUS_OK);
    free(temporary);
    unlink(path_of("half"));
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write_and_read), cmocka_unit_test(test_abandon),
        cmocka_unit_test(test_link_and_mode),  cmocka_unit_test(test_read_failures),
        cmocka_unit_test(test_write_failures), cmocka_unit_test(test_halves),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

/* mesh_reader.h - what the tests of mesh readers share: a file in the test's folder, loaded, refused, or spoilt.
 * The name of the file, with its extension, is in mesh_name.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_MESH_READER_H
#define MEN_TEST_MESH_READER_H

#include "base/hash.h"
#include "mesh/mesh_file.h"
#include "temporary.h"

static const char *mesh_name;

static inline Mesh *load_bytes(const void *bytes, size_t length)
{
    Mesh *mesh = NULL;
    Error error = {STATUS_OK, ""};
    write_bytes(in_folder(mesh_name), bytes, length);
    if (mesh_load(in_folder(mesh_name), NULL, &mesh, &error) != STATUS_OK) fail_msg("%s", error.text);
    return mesh;
}

static inline Mesh *load(const char *text)
{
    return load_bytes(text, strlen(text));
}

/* What is of all of these parts of the file that is there. */
static inline Mesh *load_parts(const char *const *parts, size_t n)
{
    Mesh *mesh = NULL;
    Error error = {STATUS_OK, ""};
    MeshSource source = {.asked = parts, .n_asked = n};
    if (mesh_load(in_folder(mesh_name), &source, &mesh, &error) != STATUS_OK) fail_msg("%s", error.text);
    mesh_source_clear(&source);
    return mesh;
}

static inline Mesh *load_part(const char *part)
{
    return load_parts(&part, part != NULL);
}

/* The file that is there must be refused, with its name and this text. */
static inline void refuse_parts(const char *const *parts, size_t n, const char *reason)
{
    Mesh *mesh = NULL;
    Error error = {STATUS_OK, ""};
    MeshSource source = {.asked = parts, .n_asked = n};
    assert_int_equal(mesh_load(in_folder(mesh_name), &source, &mesh, &error), STATUS_INPUT);
    assert_null(mesh);
    mesh_source_clear(&source);
    if (!strstr(error.text, in_folder(mesh_name)) || !strstr(error.text, reason))
        fail_msg("'%s' does not say '%s'", error.text, reason);
}

static inline void refuse_part(const char *part, const char *reason)
{
    refuse_parts(&part, part != NULL, reason);
}

static inline void refuse_bytes(const void *bytes, size_t length, const char *reason)
{
    write_bytes(in_folder(mesh_name), bytes, length);
    refuse_part(NULL, reason);
}

static inline void refuse(const char *text, const char *reason)
{
    refuse_bytes(text, strlen(text), reason);
}

/* A mesh that was read must hold what the rest of the program takes for
 * granted. */
static inline void assert_usable(const Mesh *mesh)
{
    MeshReport report;
    assert_true(mesh->n_triangles > 0);
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        for (int k = 0; k < 3; k++) assert_true(mesh->triangles[i][k] < mesh->n_vertices);
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    assert_true(report.finite);
}

/* Spoils a few bytes of a good file, and cuts some copies short: what comes of
 * it is a usable mesh or a message. */
static inline void spoil(const void *bytes, size_t length, uint32_t rounds)
{
    unsigned char *copy = malloc(length);
    uint32_t n_read = 0;
    for (uint32_t round = 0; round < rounds; round++) {
        memcpy(copy, bytes, length);
        for (uint32_t k = 0; k < 1 + round % 4; k++) {
            uint64_t h = hash_u64(round * 4 + k);
            static const char likely[] = "0123456789 -/.\n\"[]{},\0\xff\x7f\x80"; /* half of all are of these
                                                                                   */
            copy[h % length] =
                h >> 40 & 1 ? (unsigned char)likely[(h >> 48) % sizeof likely] : (unsigned char)(h >> 48);
        }
        write_bytes(in_folder(mesh_name), copy, round % 5 ? length : length - hash_u64(round) % length);
        Mesh *mesh = NULL;
        Error error = {STATUS_OK, ""};
        Status status = mesh_load(in_folder(mesh_name), NULL, &mesh, &error);
        assert_true(status == STATUS_OK || status == STATUS_INPUT || status == STATUS_NOMEM);
        if (status == STATUS_OK) {
            assert_usable(mesh);
            n_read++;
        } else {
            assert_true(error.text[0] != 0 && strchr(error.text, '\n') == NULL);
        }
        mesh_free(mesh);
    }
    assert_true(n_read < rounds);
    free(copy);
}

#endif

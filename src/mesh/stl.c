/* stl.c - reads meshes in the STL format (3D Systems, 1988): binary little-endian, and text.
 * Both kinds may start with the word 'solid', so a file is binary when its length is what a binary file's count
 * of triangles says, and only then is its beginning looked at. Facet normals and attributes are passed over: what is
 * outside follows from the order of the corners.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "base/file.h"
#include "base/num.h"
#include "mesh/mesh_file.h"

enum {
    HEADER_BYTES = 80,
    COUNT_BYTES = 4,
    FACET_BYTES = 50, /* normal, three corners, attribute */
    CORNERS_AT = 12,
    MAX_TRIANGLES = 1431655764, /* three vertices each, which are numbered in 32 bits */
    SEARCHED_FOR_FACET = 1024
};

typedef struct Stl {
    const char *path;
    MeshSource *source;
    Error *error;
    const char *at, *end;
    uint32_t line;
    uint32_t solid; /* its part; UINT32_MAX: none */
    Vec3f *corners;
    size_t n_corners, capacity;
} Stl;

static float load_float(const char *at)
{
    uint32_t bits = load_le32(at);
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Every corner is a vertex of its own until they are welded. */
static Status finish(Mesh *made, Mesh **mesh, Error *error)
{
    for (uint32_t i = 0; i < made->n_triangles; i++)
        for (uint32_t k = 0; k < 3; k++) made->triangles[i][k] = 3 * i + k;
    Status status = mesh_weld(made, NULL, error);
    if (status == STATUS_OK)
        *mesh = made;
    else
        mesh_free(made);
    return status;
}

static Status read_binary(const Stl *stl, uint32_t n, Mesh **mesh)
{
    size_t length = (size_t)(stl->end - stl->at);
    if (n > MAX_TRIANGLES)
        return fail(stl->error, STATUS_INPUT, "'%s' says that it has %lu triangles; %d can be read", stl->path,
                    (unsigned long)n, MAX_TRIANGLES);
    uint64_t needed = HEADER_BYTES + COUNT_BYTES + (uint64_t)FACET_BYTES * n;
    if (length < needed)
        return fail(stl->error, STATUS_INPUT, "'%s' ends too early: %lu triangles take %llu bytes, and there are %zu",
                    stl->path, (unsigned long)n, (unsigned long long)needed, length);
    if (n == 0 || (stl->source && stl->source->n_asked)) return mesh_source_nothing(stl->source, stl->path, stl->error);
    Mesh *made;
    TRY(mesh_new(3 * n, n, false, false, &made, stl->error));
    const char *facet = stl->at + HEADER_BYTES + COUNT_BYTES;
    for (uint32_t i = 0; i < n; i++, facet += FACET_BYTES)
        for (uint32_t k = 0; k < 3; k++) {
            const char *corner = facet + CORNERS_AT + k * 12;
            Vec3f p = vec3f(load_float(corner), load_float(corner + 4), load_float(corner + 8));
            made->positions[3 * i + k] = p;
            if (LIKELY(isfinite(p.x) && isfinite(p.y) && isfinite(p.z))) continue;
            mesh_free(made);
            return fail(stl->error, STATUS_INPUT,
                        "'%s': triangle %lu of %lu has a coordinate that is not finite: <%g, %g, %g>", stl->path,
                        (unsigned long)i, (unsigned long)n, (double)p.x, (double)p.y, (double)p.z);
        }
    return finish(made, mesh, stl->error);
}

/* ---- text ---- */

static void skip_space(Stl *stl)
{
    for (; stl->at < stl->end && ((unsigned char)*stl->at <= ' '); stl->at++) stl->line += *stl->at == '\n';
}

/* The word that comes next, and goes behind it when it is the one wanted. */
static bool take(Stl *stl, const char *word)
{
    skip_space(stl);
    size_t n = strlen(word), left = (size_t)(stl->end - stl->at);
    if (left < n || strncasecmp(stl->at, word, n) != 0) return false;
    if (left > n && (unsigned char)stl->at[n] > ' ') return false;
    stl->at += n;
    return true;
}

static Status unexpected(Stl *stl, const char *wanted)
{
    skip_space(stl);
    if (stl->at == stl->end)
        return fail(stl->error, STATUS_INPUT, "'%s':%u: the file ends where %s should be", stl->path, stl->line,
                    wanted);
    int shown = mesh_text_shown(stl->at, stl->end);
    return fail(stl->error, STATUS_INPUT, "'%s':%u: '%.*s' stands where %s should be", stl->path, stl->line, shown,
                stl->at, wanted);
}

static Status number(Stl *stl, float *x)
{
    skip_space(stl);
    double value;
    size_t n = num_parse(stl->at, (size_t)(stl->end - stl->at), &value);
    if (n == 0 || (stl->at + n < stl->end && (unsigned char)stl->at[n] > ' '))
        return unexpected(stl, "a finite number");
    *x = (float)value;
    if (!isfinite(*x)) return unexpected(stl, "a finite number");
    stl->at += n;
    return STATUS_OK;
}

static Status facet(Stl *stl)
{
    /* normals are not needed, and writers put nan there */
    if (!take(stl, "normal")) return unexpected(stl, "'normal'");
    for (int i = 0; i < 3; i++) {
        skip_space(stl);
        while (stl->at < stl->end && (unsigned char)*stl->at > ' ') stl->at++;
    }
    if (!take(stl, "outer") || !take(stl, "loop")) return unexpected(stl, "'outer loop'");
    if (stl->n_corners >= 3 * (size_t)MAX_TRIANGLES)
        return fail(stl->error, STATUS_INPUT, "'%s':%u: more than %d triangles", stl->path, stl->line, MAX_TRIANGLES);
    if (!array_reserve(&stl->corners, &stl->capacity, stl->n_corners + 3, sizeof *stl->corners))
        return fail_memory(stl->error, 2 * stl->n_corners * sizeof *stl->corners, "the triangles of a mesh");
    for (size_t k = 0; k < 3; k++) {
        Vec3f *p = &stl->corners[stl->n_corners + k];
        if (!take(stl, "vertex")) return unexpected(stl, "'vertex'");
        TRY(number(stl, &p->x));
        TRY(number(stl, &p->y));
        TRY(number(stl, &p->z));
    }
    if (!take(stl, "endloop")) return unexpected(stl, "'endloop'; a facet has three corners");
    if (!take(stl, "endfacet")) return unexpected(stl, "'endfacet'");
    if (mesh_source_wants(stl->source, &stl->solid, 1, 1)) stl->n_corners += 3;
    return STATUS_OK;
}

static Status solid_name(Stl *stl)
{
    const char *newline = memchr(stl->at, '\n', (size_t)(stl->end - stl->at));
    const char *from = stl->at, *to = newline ? newline : stl->end;
    stl->at = to;
    while (from < to && (unsigned char)*from <= ' ') from++;
    while (from < to && (unsigned char)to[-1] <= ' ') to--;
    stl->solid = UINT32_MAX;
    if (!stl->source || from == to) return STATUS_OK;
    stl->solid = mesh_source_part(stl->source, "solid", from, (size_t)(to - from));
    return stl->solid == UINT32_MAX ? fail_memory(stl->error, (size_t)(to - from), "a name") : STATUS_OK;
}

static Status read_text(Stl *stl, Mesh **mesh)
{
    stl->line = 1;
    for (skip_space(stl); stl->at < stl->end; skip_space(stl)) {
        if (!take(stl, "solid")) return unexpected(stl, "'solid'");
        TRY(solid_name(stl));
        while (take(stl, "facet")) TRY(facet(stl));
        if (!take(stl, "endsolid")) return unexpected(stl, "'facet' or 'endsolid'");
        const char *newline = memchr(stl->at, '\n', (size_t)(stl->end - stl->at));
        stl->at = newline ? newline : stl->end; /* its name again */
    }
    if (stl->n_corners == 0) return mesh_source_nothing(stl->source, stl->path, stl->error);
    Mesh *made;
    TRY(mesh_new((uint32_t)stl->n_corners, (uint32_t)(stl->n_corners / 3), false, false, &made, stl->error));
    memcpy(made->positions, stl->corners, stl->n_corners * sizeof *stl->corners);
    return finish(made, mesh, stl->error);
}

/* Whether the file reads as a text: 'solid', and soon after it 'facet' or the end of an empty one. */
static bool looks_like_text(const Stl *stl)
{
    Stl probe = *stl;
    if (!take(&probe, "solid")) return false;
    size_t n = (size_t)(probe.end - probe.at);
    if (n > SEARCHED_FOR_FACET) n = SEARCHED_FOR_FACET;
    for (size_t i = 0; i + 5 <= n; i++)
        if (strncasecmp(probe.at + i, "facet", 5) == 0 || (i + 8 <= n && strncasecmp(probe.at + i, "endsolid", 8) == 0))
            return true;
    return false;
}

Status mesh_load_stl(const char *path, MeshSource *source, Mesh **mesh, Error *error)
{
    char *bytes = NULL;
    size_t length = 0;
    TRY(file_read(path, 0, &bytes, &length, error));
    Stl stl = {.path = path, .source = source, .error = error, .at = bytes, .end = bytes + length, .solid = UINT32_MAX};
    bool has_count = length >= HEADER_BYTES + COUNT_BYTES;
    uint32_t n = has_count ? load_le32(bytes + HEADER_BYTES) : 0;
    bool exact = has_count && length == HEADER_BYTES + COUNT_BYTES + (uint64_t)FACET_BYTES * n;
    Status status;
    if (!exact && looks_like_text(&stl))
        status = read_text(&stl, mesh);
    else if (has_count)
        status = read_binary(&stl, n, mesh);
    else
        status = fail(error, STATUS_INPUT,
                      "'%s' is not an STL file: it has no 'solid', and no room for a binary header", path);
    free(stl.corners);
    free(bytes);
    return status;
}

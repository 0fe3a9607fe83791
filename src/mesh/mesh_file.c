/* mesh_file.c - the choice of a reader, and the parts that a file names.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/mesh_file.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "base/buf.h"
#include "base/file.h"
#include "base/hash.h"
#include "diag/suggest.h"

static const struct {
    const char *extension;
    Status (*load)(const char *path, MeshSource *source, Mesh **mesh, Error *error);
} readers[] = {
    {"ply", mesh_load_ply},   {"obj", mesh_load_obj},  {"stl", mesh_load_stl},
    {"gltf", mesh_load_gltf}, {"glb", mesh_load_gltf},
};

enum { LONGEST_NAME = 255, MOST_NAMES_SHOWN = 8, MOST_MATERIALS = 4096, MOST_BYTES_SHOWN = 20 };

int mesh_text_shown(const char *at, const char *end)
{
    int shown = 0;
    while (shown < MOST_BYTES_SHOWN && at + shown < end && (unsigned char)at[shown] > ' ' && at[shown] != 0x7f) shown++;
    return shown;
}

bool mesh_has_reader(const char *extension)
{
    for (size_t i = 0; i < COUNT_OF(readers); i++)
        if (strcasecmp(extension, readers[i].extension) == 0) return true;
    return false;
}

Status mesh_load(const char *path, MeshSource *source, Mesh **mesh, Error *error)
{
    const char *extension = file_extension(path);
    Buf known = {0};
    for (size_t i = 0; i < COUNT_OF(readers); i++) {
        if (strcasecmp(extension, readers[i].extension) == 0) {
            buf_clear(&known);
            return readers[i].load(path, source, mesh, error);
        }
        buf_format(&known, "%s.%s", i == 0 ? "" : i + 1 < COUNT_OF(readers) ? ", " : " and ", readers[i].extension);
    }
    Status status =
        fail(error, STATUS_INPUT, "cannot tell what kind of mesh '%s' is; %s can be read", path, buf_text(&known));
    buf_clear(&known);
    return status;
}

void mesh_source_clear(MeshSource *source)
{
    for (size_t i = 0; i < source->n_parts; i++) free(source->parts[i].name);
    for (size_t i = 0; i < source->n_materials; i++) {
        free(source->materials[i].name);
        free(source->materials[i].said);
    }
    free(source->materials);
    free(source->parts);
    free(source->table);
    *source = (MeshSource){.part = source->part};
}

static size_t part_slot(const MeshSource *source, const char *kind, const char *name, size_t length)
{
    uint64_t hash = hash_u64((uint64_t)(unsigned char)kind[0]);
    for (size_t i = 0; i < length; i++) hash = hash_u64(hash ^ (unsigned char)name[i]);
    size_t slot = (size_t)hash & (source->table_room - 1);
    for (; source->table[slot]; slot = (slot + 1) & (source->table_room - 1)) {
        const MeshPart *part = &source->parts[source->table[slot] - 1];
        if (strcmp(part->kind, kind) == 0 && strlen(part->name) == length && memcmp(part->name, name, length) == 0)
            break;
    }
    return slot;
}

/* Keeps the table less than half full. */
static bool table_has_room(MeshSource *source)
{
    if (2 * (source->n_parts + 1) < source->table_room) return true;
    size_t room = source->table_room ? 2 * source->table_room : 64;
    uint32_t *table = calloc(room, sizeof *table);
    if (!table) return false;
    free(source->table);
    source->table = table;
    source->table_room = room;
    for (size_t i = 0; i < source->n_parts; i++) {
        const MeshPart *part = &source->parts[i];
        table[part_slot(source, part->kind, part->name, strlen(part->name))] = (uint32_t)i + 1;
    }
    return true;
}

uint32_t mesh_source_part(MeshSource *source, const char *kind, const char *name, size_t length)
{
    const char *zero = memchr(name, 0, length);
    if (zero) length = (size_t)(zero - name);
    if (length > LONGEST_NAME) length = LONGEST_NAME;
    if (!table_has_room(source) || source->n_parts >= UINT32_MAX - 1) return UINT32_MAX;
    size_t slot = part_slot(source, kind, name, length);
    if (source->table[slot]) return source->table[slot] - 1;
    if (!ARRAY_ROOM(source->parts, source->part_capacity, source->n_parts)) return UINT32_MAX;
    char *copy = malloc(length + 1);
    if (!copy) return UINT32_MAX;
    memcpy(copy, name, length);
    copy[length] = 0;
    source->parts[source->n_parts++] = (MeshPart){kind, copy, 0};
    source->table[slot] = (uint32_t)source->n_parts;
    return (uint32_t)source->n_parts - 1;
}

const char *mesh_source_said(const MeshSource *source, const char *material)
{
    for (size_t i = 0; i < source->n_materials; i++)
        if (strcmp(source->materials[i].name, material) == 0) return source->materials[i].said;
    return NULL;
}

void mesh_source_material(MeshSource *source, const char *name, size_t length, char *said)
{
    if (length > LONGEST_NAME) length = LONGEST_NAME;
    char *copy = said && *said && source->n_materials < MOST_MATERIALS ? strndup(name, length) : NULL;
    bool is_new = copy && (!*copy || !mesh_source_said(source, copy));
    if (is_new && ARRAY_ROOM(source->materials, source->material_capacity, source->n_materials)) {
        source->materials[source->n_materials++] = (MeshMaterial){copy, said};
        return;
    }
    free(copy);
    free(said);
}

bool mesh_source_wants(MeshSource *source, const uint32_t *parts, size_t n, uint64_t n_triangles)
{
    if (!source) return true;
    bool wanted = source->part == NULL;
    for (size_t i = 0; i < n; i++) {
        bool again = false; /* a node and one below it may have one name */
        for (size_t k = 0; k < i; k++) again = again || parts[k] == parts[i];
        if (parts[i] == UINT32_MAX || again) continue;
        MeshPart *part = &source->parts[parts[i]];
        part->n_triangles += n_triangles;
        wanted = wanted || strcmp(part->name, source->part) == 0;
    }
    return wanted;
}

Status mesh_source_nothing(const MeshSource *source, const char *path, Error *error)
{
    if (!source || !source->part) return fail(error, STATUS_INPUT, "'%s' has no faces", path);
    if (!source->n_parts)
        return fail(error, STATUS_INPUT, "'%s' names no parts, so there is no part '%s'", path, source->part);
    for (size_t i = 0; i < source->n_parts; i++)
        if (strcmp(source->parts[i].name, source->part) == 0)
            return fail(error, STATUS_INPUT, "'%s': the %s '%s' has no faces", path, source->parts[i].kind,
                        source->part);
    const char **names = malloc(source->n_parts * sizeof *names);
    for (size_t i = 0; names && i < source->n_parts; i++) names[i] = source->parts[i].name;
    const char *nearest = names ? suggest_nearest(source->part, names, source->n_parts) : NULL;
    free(names);
    if (nearest)
        return fail(error, STATUS_INPUT, "'%s' has no part '%s'; did you mean '%s'?", path, source->part, nearest);
    Buf list = {0};
    for (size_t i = 0; i < source->n_parts && i < MOST_NAMES_SHOWN; i++)
        buf_format(&list, "%s%s '%s'", i ? ", " : "", source->parts[i].kind, source->parts[i].name);
    if (source->n_parts > MOST_NAMES_SHOWN) buf_format(&list, " and %zu more", source->n_parts - MOST_NAMES_SHOWN);
    Status status = fail(error, STATUS_INPUT, "'%s' has no part '%s'; it has %s", path, source->part, buf_text(&list));
    buf_clear(&list);
    return status;
}

/* mesh_file.c - the choice of a reader, and the parts that a file names.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/mesh_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "base/buf.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/suggest.h"

static const struct {
    const char *extension;
    Status (*load)(const char *path, MeshSource *source, Mesh **mesh, Error *error);
} readers[] = {
    {"ply", mesh_load_ply},   {"obj", mesh_load_obj},  {"stl", mesh_load_stl},
    {"gltf", mesh_load_gltf}, {"glb", mesh_load_gltf}, {"asc", mesh_load_gemcad},
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

/* What of other programs' files becomes one that can be read. */
static const struct {
    const char *extensions, *way;
} foreign[] = {
    {"blend", "Blender exports glTF 2.0 (.glb) of it"},
    {"fbx dae usd usda usdc usdz abc x3d wrl 3ds", "read it into Blender and export it as glTF 2.0 (.glb)"},
    {"max ma mb c4d skp 3dm lwo ksp bip", "the program that made it exports .glb or .obj of it"},
    {"step stp iges igs brep brp fcstd 3mf sldprt", "FreeCAD and other programs for design export .glb or .stl of it"},
    {"scad", "openscad -o part.stl makes an .stl of it"},
    {"pov inc", "meniscus-povray(7) says how scenes of POV-Ray are written here"},
};

static const char *foreign_way(const char *extension)
{
    size_t length = strlen(extension);
    for (size_t i = 0; i < COUNT_OF(foreign); i++)
        for (const char *word = foreign[i].extensions; *word;) {
            size_t n = strcspn(word, " ");
            if (n == length && strncasecmp(word, extension, n) == 0) return foreign[i].way;
            word += n + strspn(word + n, " ");
        }
    return NULL;
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
    const char *way = foreign_way(extension);
    Status status = fail(error, STATUS_INPUT,
                         way ? "'%s' is no mesh that can be read, as %s are: %s"
                             : "cannot tell what kind of mesh '%s' is; %s can be read",
                         path, buf_text(&known), way);
    buf_clear(&known);
    return status;
}

void mesh_source_clear(MeshSource *source)
{
    for (size_t i = 0; i < source->n_parts; i++) free(source->parts[i].name);
    for (size_t i = 0; i < source->n_materials; i++) material_clear(&source->materials[i]);
    for (size_t i = 0; i < source->n_cameras; i++) free(source->cameras[i].name);
    for (size_t i = 0; i < source->n_lights; i++) free(source->lights[i].name);
    for (size_t i = 0; i < source->n_images; i++) {
        free(source->images[i].name);
        free(source->images[i].bytes);
    }
    free(source->materials);
    free(source->parts);
    free(source->table);
    free(source->runs);
    free(source->run_parts);
    free(source->cameras);
    free(source->lights);
    free(source->images);
    free(source->lost_library);
    *source =
        (MeshSource){.asked = source->asked, .n_asked = source->n_asked, .kept = source->kept, .whole = source->whole};
}

/* ---- parts ---- */

/* What a part is known by. */
typedef struct PartKey {
    const char *kind, *name;
    size_t length;
    bool by_number;
    size_t number;
} PartKey;

static bool part_has(const MeshPart *part, const PartKey *key)
{
    if (strcmp(part->kind, key->kind) != 0 || part->by_number != key->by_number) return false;
    if (key->by_number) return part->number == key->number;
    return strlen(part->name) == key->length && memcmp(part->name, key->name, key->length) == 0;
}

static size_t part_slot(const MeshSource *source, const PartKey *key)
{
    uint64_t hash = hash_u64((uint64_t)(unsigned char)key->kind[0] ^ (key->by_number ? key->number << 8 : 0));
    for (size_t i = 0; i < key->length && !key->by_number; i++) hash = hash_u64(hash ^ (unsigned char)key->name[i]);
    size_t slot = (size_t)hash & (source->table_room - 1);
    while (source->table[slot] && !part_has(&source->parts[source->table[slot] - 1], key))
        slot = (slot + 1) & (source->table_room - 1);
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
        PartKey key = {part->kind, part->name, strlen(part->name), part->by_number, part->number};
        table[part_slot(source, &key)] = (uint32_t)i + 1;
    }
    return true;
}

/* What stands behind "KIND:" in what is asked for; NULL: it begins with something else. */
static const char *behind_kind(const char *asked, const char *kind)
{
    size_t length = strlen(kind);
    return strncmp(asked, kind, length) == 0 && asked[length] == ':' ? asked + length + 1 : NULL;
}

/* Whether it means a number, or what has none of a kind, and never a name. */
static bool asks_no_name(const char *asked)
{
    static const char *const kinds[] = {"object", "group", "solid", "node", "mesh", "material"};
    for (size_t i = 0; i < COUNT_OF(kinds); i++) {
        const char *rest = behind_kind(asked, kinds[i]);
        if (rest && (!*rest || (*rest == '#' && rest[1 + strspn(rest + 1, "0123456789")] == 0))) return true;
    }
    return false;
}

static bool is_asked_for(const MeshPart *part, const char *asked)
{
    char number[24];
    const char *rest = behind_kind(asked, part->kind);
    snprintf(number, sizeof number, "#%zu", part->number);
    if (asks_no_name(asked)) return rest && strcmp(number, rest) == 0;
    return strcmp(part->name, asked) == 0 || (rest && strcmp(part->name, rest) == 0);
}

static size_t count_of_kind(const MeshSource *source, const char *kind)
{
    for (size_t i = source->n_parts; i > 0; i--) /* the last has the largest number */
        if (strcmp(source->parts[i - 1].kind, kind) == 0) return source->parts[i - 1].number + 1;
    return 0;
}

static uint32_t part_of(MeshSource *source, PartKey key)
{
    if (!table_has_room(source) || source->n_parts >= UINT32_MAX - 1) return UINT32_MAX;
    size_t slot = part_slot(source, &key);
    if (source->table[slot]) return source->table[slot] - 1;
    if (!ARRAY_ROOM(source->parts, source->part_capacity, source->n_parts)) return UINT32_MAX;
    char *copy = malloc(key.length + 1);
    if (!copy) return UINT32_MAX;
    memcpy(copy, key.name, key.length);
    copy[key.length] = 0;
    MeshPart part = {.kind = key.kind, .name = copy, .by_number = key.by_number};
    part.number = key.by_number ? key.number : count_of_kind(source, key.kind);
    for (size_t i = 0; i < source->n_asked && i < MESH_MOST_ASKED; i++)
        if (is_asked_for(&part, source->asked[i])) part.asked |= (uint32_t)1 << i;
    source->parts[source->n_parts++] = part;
    source->table[slot] = (uint32_t)source->n_parts;
    return (uint32_t)source->n_parts - 1;
}

uint32_t mesh_source_part(MeshSource *source, const char *kind, const char *name, size_t length)
{
    const char *zero = memchr(name, 0, length);
    if (zero) length = (size_t)(zero - name);
    if (length > LONGEST_NAME) length = LONGEST_NAME;
    return part_of(source, (PartKey){.kind = kind, .name = name, .length = length});
}

uint32_t mesh_source_numbered_part(MeshSource *source, const char *kind, size_t number, const char *name)
{
    char unnamed[24];
    snprintf(unnamed, sizeof unnamed, "#%zu", number);
    if (!name || !*name) name = unnamed;
    size_t length = strlen(name);
    if (length > LONGEST_NAME) length = LONGEST_NAME;
    return part_of(source, (PartKey){kind, name, length, true, number});
}

const MeshPart *mesh_source_find_numbered(const MeshSource *source, const char *kind, size_t number)
{
    PartKey key = {.kind = kind, .by_number = true, .number = number};
    uint32_t found = source->table_room ? source->table[part_slot(source, &key)] : 0;
    return found ? &source->parts[found - 1] : NULL;
}

/* ---- materials ---- */

const MeshMaterial *mesh_source_find_material(const MeshSource *source, const char *name)
{
    for (size_t i = 0; i < source->n_materials; i++)
        if (strcmp(source->materials[i].name, name) == 0) return &source->materials[i];
    return NULL;
}

const MeshMaterial *mesh_source_material_of(const MeshSource *source, const MeshPart *part)
{
    if (strcmp(part->kind, "material") != 0) return NULL;
    if (!part->by_number) return mesh_source_find_material(source, part->name);
    return part->number < source->n_materials ? &source->materials[part->number] : NULL;
}

void mesh_source_material(MeshSource *source, MeshMaterial *material)
{
    if (material->name && source->n_materials < MOST_MATERIALS &&
        ARRAY_ROOM(source->materials, source->material_capacity, source->n_materials)) {
        if (strlen(material->name) > LONGEST_NAME) material->name[LONGEST_NAME] = 0;
        source->materials[source->n_materials++] = *material;
    } else {
        source->left_out |= 1U << MESH_LEFT_MATERIALS;
        material_clear(material);
    }
    *material = (MeshMaterial){.name = NULL};
}

/* ---- triangles ---- */

/* Notes whose the next triangles of the mesh are. Without memory the rest is nobody's. */
static void add_run(MeshSource *source, const uint32_t *parts, size_t n, uint64_t n_triangles)
{
    if (source->n_runs) {
        MeshRun *last = &source->runs[source->n_runs - 1];
        if (last->n_parts == n && memcmp(&source->run_parts[last->first_part], parts, n * sizeof *parts) == 0) {
            last->n_triangles += n_triangles;
            return;
        }
    }
    if (!ARRAY_ROOM(source->runs, source->run_capacity, source->n_runs) ||
        !array_reserve(&source->run_parts, &source->run_part_capacity, source->n_run_parts + n + 1, sizeof *parts))
        return;
    memcpy(&source->run_parts[source->n_run_parts], parts, n * sizeof *parts);
    source->runs[source->n_runs++] = (MeshRun){source->n_run_parts, (uint32_t)n, n_triangles};
    source->n_run_parts += n;
}

/* Whether it means what has none of a kind, and they have none. */
static bool are_without(const MeshSource *source, const uint32_t *parts, size_t n, const char *asked)
{
    size_t length = strlen(asked);
    if (length == 0 || asked[length - 1] != ':') return false;
    for (size_t i = 0; i < n; i++)
        if (parts[i] != UINT32_MAX && behind_kind(asked, source->parts[parts[i]].kind)) return false;
    return true;
}

bool mesh_parts_are(const MeshSource *source, const uint32_t *parts, size_t n, const char *asked)
{
    for (size_t i = 0; i < n; i++)
        if (parts[i] != UINT32_MAX && is_asked_for(&source->parts[parts[i]], asked)) return true;
    return are_without(source, parts, n, asked);
}

bool mesh_source_wants(MeshSource *source, const uint32_t *parts, size_t n, uint64_t n_triangles)
{
    if (!source) return true;
    uint32_t asked = 0, all = source->n_asked >= 32 ? UINT32_MAX : ((uint32_t)1 << source->n_asked) - 1;
    for (size_t i = 0; i < n; i++) {
        bool again = false; /* a node and one below it may have one name */
        for (size_t k = 0; k < i; k++) again = again || parts[k] == parts[i];
        if (parts[i] == UINT32_MAX || again) continue;
        source->parts[parts[i]].n_triangles += n_triangles;
        asked |= source->parts[parts[i]].asked;
    }
    for (size_t i = 0; asked != all && i < source->n_asked; i++)
        if (are_without(source, parts, n, source->asked[i])) asked |= (uint32_t)1 << i;
    if (asked != all) return false;
    if (source->whole) add_run(source, parts, n, n_triangles);
    return true;
}

static const char *nearest_part(const MeshSource *source, const char *asked)
{
    const char **names = malloc(source->n_parts * sizeof *names);
    for (size_t i = 0; names && i < source->n_parts; i++) names[i] = source->parts[i].name;
    const char *nearest = names ? suggest_nearest(asked, names, source->n_parts) : NULL;
    free(names);
    return nearest;
}

Status mesh_source_nothing(const MeshSource *source, const char *path, Error *error)
{
    if (!source || !source->n_asked) return fail(error, STATUS_INPUT, "'%s' has no faces", path);
    const char *asked = source->asked[0];
    if (!source->n_parts)
        return fail(error, STATUS_INPUT, "'%s' names no parts, so there is no part '%s'", path, asked);
    uint32_t known = 0;
    for (size_t i = 0; i < source->n_parts; i++) known |= source->parts[i].asked;
    size_t unknown = 0;
    while (unknown < source->n_asked && known >> unknown & 1) unknown++;
    for (size_t i = 0; unknown == source->n_asked && i < source->n_parts; i++)
        if (source->n_asked == 1 && source->parts[i].asked)
            return fail(error, STATUS_INPUT, "'%s': the %s '%s' has no faces", path, source->parts[i].kind,
                        source->parts[i].name);
    if (unknown == source->n_asked)
        return fail(error, STATUS_INPUT, "'%s': no face is of '%s' and of '%s' at once", path, asked,
                    source->asked[source->n_asked - 1]);
    asked = source->asked[unknown];
    const char *nearest = nearest_part(source, asked);
    if (nearest) return fail(error, STATUS_INPUT, "'%s' has no part '%s'; did you mean '%s'?", path, asked, nearest);
    Buf list = {0};
    for (size_t i = 0; i < source->n_parts && i < MOST_NAMES_SHOWN; i++)
        buf_format(&list, "%s%s '%s'", i ? ", " : "", source->parts[i].kind, source->parts[i].name);
    if (source->n_parts > MOST_NAMES_SHOWN) buf_format(&list, " and %zu more", source->n_parts - MOST_NAMES_SHOWN);
    Status status = fail(error, STATUS_INPUT, "'%s' has no part '%s'; it has %s", path, asked, buf_text(&list));
    buf_clear(&list);
    return status;
}

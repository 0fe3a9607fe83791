/* obj.c - reads meshes in Wavefront's OBJ format: v, vt, vn and f. Polygons become triangles (mesh/face.h);
 * o, g and usemtl name parts, and what mtllib names is listed; lines, points and free-form surfaces are passed over.
 * A corner of a face names its position, texture coordinate and normal separately; a vertex is made for
 * every combination that occurs.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/num.h"
#include "base/utf8.h"
#include "mesh/face.h"
#include "mesh/mesh_file.h"

/* Numbers from 1; 0: none. */
typedef struct ObjCorner {
    uint32_t position, uv, normal;
} ObjCorner;

/* What names a part: the statement, and what a message calls it. */
enum { N_PART_KINDS = 3, MOST_LIBRARIES = 16 };
static const struct {
    const char *statement, *kind;
} part_kinds[N_PART_KINDS] = {{"o", "object"}, {"g", "group"}, {"usemtl", "material"}};

typedef struct Obj {
    const char *path;
    MeshSource *source;
    uint32_t parts[N_PART_KINDS]; /* those that hold now; UINT32_MAX: none */
    Error *error;
    const char *at, *end;
    uint32_t line;
    Vec3f *positions;
    size_t n_positions, position_capacity;
    Vec3f *normals;
    size_t n_normals, normal_capacity;
    struct {
        float u, v;
    } * uvs;
    size_t n_uvs, uv_capacity;
    ObjCorner *corners; /* three per triangle */
    size_t n_corners, corner_capacity;
    uint32_t *lines; /* per triangle, where its face begins: that of no other face */
    size_t n_lines, line_capacity;
    bool uses_uvs, uses_normals;
    unsigned n_libraries; /* of materials, that were looked at */
} Obj;

static const size_t most_items = UINT32_MAX / 2;

static bool at_blank(const Obj *obj)
{
    return obj->at < obj->end && (*obj->at == ' ' || *obj->at == '\t' || *obj->at == '\r');
}

/* Goes over blanks, and over line ends behind a backslash. */
static void skip_blanks(Obj *obj)
{
    for (;;) {
        while (at_blank(obj)) obj->at++;
        size_t left = (size_t)(obj->end - obj->at);
        size_t n = left >= 2 && memcmp(obj->at, "\\\n", 2) == 0     ? 2
                   : left >= 3 && memcmp(obj->at, "\\\r\n", 3) == 0 ? 3
                                                                    : 0;
        if (n == 0) return;
        obj->at += n;
        obj->line++;
    }
}

static bool at_line_end(const Obj *obj)
{
    return obj->at >= obj->end || *obj->at == '\n' || *obj->at == '#';
}

static void skip_line(Obj *obj)
{
    const char *newline = memchr(obj->at, '\n', (size_t)(obj->end - obj->at));
    /* A comment that ends in a backslash ends all the same. */
    obj->at = newline ? newline + 1 : obj->end;
    obj->line++;
}

static Status bad_word(const Obj *obj, const char *wanted)
{
    int shown = mesh_text_shown(obj->at, obj->end);
    if (shown == 0)
        return fail(obj->error, STATUS_INPUT, "'%s':%u: the line ends where %s should be", obj->path, obj->line,
                    wanted);
    return fail(obj->error, STATUS_INPUT, "'%s':%u: '%.*s' stands where %s should be", obj->path, obj->line, shown,
                obj->at, wanted);
}

/* n floats, of which the last n - n_needed may be left out and are 0. */
static Status read_floats(Obj *obj, int n, int n_needed, float values[3])
{
    for (int i = 0; i < n; i++) {
        skip_blanks(obj);
        values[i] = 0;
        if (i >= n_needed && at_line_end(obj)) continue;
        double value = 0;
        size_t length = num_parse(obj->at, (size_t)(obj->end - obj->at), &value);
        const char *behind = obj->at + length;
        if (length == 0 || (behind < obj->end && (unsigned char)*behind > ' ' && *behind != '\\' && *behind != '#'))
            return bad_word(obj, "a number");
        obj->at = behind;
        values[i] = (float)value;
        if (!isfinite(values[i]))
            return fail(obj->error, STATUS_INPUT, "'%s':%u: the number %g is too large", obj->path, obj->line, value);
    }
    return STATUS_OK;
}

static Status too_many(const Obj *obj, const char *what)
{
    return fail(obj->error, STATUS_INPUT, "'%s':%u: more than %zu %s cannot be read", obj->path, obj->line, most_items,
                what);
}

/* Whether there are three numbers more, which some writers put behind a position. */
static bool colors_follow(const Obj *obj)
{
    Obj ahead = *obj;
    for (int i = 0; i < 3; i++) {
        double unused;
        skip_blanks(&ahead);
        size_t length = num_parse(ahead.at, (size_t)(ahead.end - ahead.at), &unused);
        if (length == 0) return false;
        ahead.at += length;
    }
    return true;
}

static Status read_position(Obj *obj)
{
    float v[3];
    TRY(read_floats(obj, 3, 3, v));
    if (obj->source && obj->n_positions == 0 && colors_follow(obj)) obj->source->left_out |= 1U << MESH_LEFT_COLORS;
    if (obj->n_positions >= most_items) return too_many(obj, "positions");
    if (!ARRAY_ROOM(obj->positions, obj->position_capacity, obj->n_positions))
        return fail_memory(obj->error, obj->n_positions * 2 * sizeof *obj->positions, "the vertices of a mesh");
    obj->positions[obj->n_positions++] = vec3f(v[0], v[1], v[2]);
    return STATUS_OK;
}

static Status read_normal(Obj *obj)
{
    float v[3];
    TRY(read_floats(obj, 3, 3, v));
    if (obj->n_normals >= most_items) return too_many(obj, "normals");
    if (!ARRAY_ROOM(obj->normals, obj->normal_capacity, obj->n_normals))
        return fail_memory(obj->error, obj->n_normals * 2 * sizeof *obj->normals, "the normals of a mesh");
    obj->normals[obj->n_normals++] = vec3f(v[0], v[1], v[2]);
    return STATUS_OK;
}

static Status read_uv(Obj *obj)
{
    float v[3];
    TRY(read_floats(obj, 2, 1, v));
    if (obj->n_uvs >= most_items) return too_many(obj, "texture coordinates");
    if (!ARRAY_ROOM(obj->uvs, obj->uv_capacity, obj->n_uvs))
        return fail_memory(obj->error, obj->n_uvs * 2 * sizeof *obj->uvs, "the texture coordinates of a mesh");
    obj->uvs[obj->n_uvs].u = v[0];
    obj->uvs[obj->n_uvs++].v = v[1];
    return STATUS_OK;
}

/* A number from 1, or from the end of what was read so far when negative. What lies ahead is allowed; the
 * end of the file tells. */
static Status read_number(Obj *obj, size_t n_so_far, uint32_t *number)
{
    const char *start = obj->at;
    bool negative = obj->at < obj->end && *obj->at == '-';
    if (negative) obj->at++;
    uint64_t value = 0;
    const char *digits = obj->at;
    for (; obj->at < obj->end && *obj->at >= '0' && *obj->at <= '9'; obj->at++)
        if (value <= most_items) value = value * 10 + (uint64_t)(*obj->at - '0');
    if (obj->at == digits || value == 0) {
        obj->at = start;
        return bad_word(obj, "a vertex number other than 0");
    }
    if (value > most_items || (negative && value > n_so_far))
        return fail(obj->error, STATUS_INPUT, "'%s':%u: the vertex number %.*s is out of range; %zu were read so far",
                    obj->path, obj->line, (int)(obj->at - start < 20 ? obj->at - start : 20), start, n_so_far);
    *number = (uint32_t)(negative ? n_so_far + 1 - value : value);
    return STATUS_OK;
}

/* 7, 7/1, 7//3 or 7/1/3 */
static Status read_corner(Obj *obj, ObjCorner *corner)
{
    *corner = (ObjCorner){0, 0, 0};
    TRY(read_number(obj, obj->n_positions, &corner->position));
    if (obj->at < obj->end && *obj->at == '/') {
        obj->at++;
        if (obj->at < obj->end && *obj->at != '/') TRY(read_number(obj, obj->n_uvs, &corner->uv));
    }
    if (obj->at < obj->end && *obj->at == '/') {
        obj->at++;
        TRY(read_number(obj, obj->n_normals, &corner->normal));
    }
    if (obj->at < obj->end && (unsigned char)*obj->at > ' ' && *obj->at != '\\' && *obj->at != '#')
        return bad_word(obj, "a vertex number");
    obj->uses_uvs |= corner->uv != 0;
    obj->uses_normals |= corner->normal != 0;
    return STATUS_OK;
}

static Status add_triangle(Obj *obj, uint32_t line, ObjCorner a, ObjCorner b, ObjCorner c)
{
    if (!mesh_source_wants(obj->source, obj->parts, N_PART_KINDS, 1)) return STATUS_OK;
    if (obj->n_lines >= most_items) return too_many(obj, "triangles");
    if (!array_reserve(&obj->corners, &obj->corner_capacity, obj->n_corners + 3, sizeof *obj->corners) ||
        !ARRAY_ROOM(obj->lines, obj->line_capacity, obj->n_lines))
        return fail_memory(obj->error, obj->n_corners * 2 * sizeof *obj->corners, "the triangles of a mesh");
    obj->corners[obj->n_corners++] = a;
    obj->corners[obj->n_corners++] = b;
    obj->corners[obj->n_corners++] = c;
    obj->lines[obj->n_lines++] = line;
    return STATUS_OK;
}

/* As a fan: it is cut when all positions are known. */
static Status read_face(Obj *obj)
{
    const uint32_t line = obj->line;
    ObjCorner first = {0, 0, 0}, last = {0, 0, 0};
    size_t n = 0;
    for (;; n++) {
        skip_blanks(obj);
        if (at_line_end(obj)) break;
        ObjCorner corner;
        TRY(read_corner(obj, &corner));
        if (n >= 2) TRY(add_triangle(obj, line, first, last, corner));
        if (n == 0) first = corner;
        last = corner;
    }
    if (n < 3)
        return fail(obj->error, STATUS_INPUT, "'%s':%u: a face has %zu corners; it needs 3", obj->path, obj->line, n);
    return STATUS_OK;
}

static bool keyword(Obj *obj, const char *word)
{
    size_t n = strlen(word);
    if ((size_t)(obj->end - obj->at) <= n || memcmp(obj->at, word, n) != 0) return false;
    if (obj->at[n] != ' ' && obj->at[n] != '\t') return false;
    obj->at += n;
    return true;
}

/* The rest of the line, without blanks around it: a name may have blanks within. */
static const char *rest_of_line(const Obj *obj, size_t *length)
{
    const char *newline = memchr(obj->at, '\n', (size_t)(obj->end - obj->at));
    const char *from = obj->at, *to = newline ? newline : obj->end;
    while (from < to && (unsigned char)*from <= ' ') from++;
    while (from < to && (unsigned char)to[-1] <= ' ') to--;
    *length = (size_t)(to - from);
    return from;
}

static Status read_part(Obj *obj, int kind)
{
    size_t length;
    const char *name = rest_of_line(obj, &length);
    if (!obj->source) return STATUS_OK;
    obj->parts[kind] = mesh_source_part(obj->source, part_kinds[kind].kind, name, length);
    return obj->parts[kind] == UINT32_MAX ? fail_memory(obj->error, length, "a name") : STATUS_OK;
}

static bool read_library(const Obj *obj, const char *from, size_t length)
{
    char *name = strndup(from, length);
    bool there = name && mesh_list_mtl(obj->path, name, obj->source);
    free(name);
    return there;
}

/* The names of several, or one that has blanks within. Exporters say it again for every object. */
static void read_libraries(Obj *obj)
{
    size_t length, lost_length = 0;
    const char *from = rest_of_line(obj, &length), *end = from + length, *lost = NULL;
    if (!obj->source || length == 0 || obj->n_libraries++ >= MOST_LIBRARIES) return;
    if (read_library(obj, from, length)) return;
    bool any = false;
    for (const char *at = from, *next; at < end; at = next) {
        for (next = at; next < end && (unsigned char)*next > ' ';) next++;
        size_t n = (size_t)(next - at);
        bool there = n < length && read_library(obj, at, n);
        any = any || there;
        if (!there && !lost) lost = at, lost_length = n;
        while (next < end && (unsigned char)*next <= ' ') next++;
    }
    if (any && !lost) return;
    if (!obj->source->lost_library)
        obj->source->lost_library = any ? strndup(lost, lost_length) : strndup(from, length);
}

static Status read_lines(Obj *obj)
{
    for (int kind = 0; kind < N_PART_KINDS; kind++) obj->parts[kind] = UINT32_MAX;
    for (obj->line = 1; obj->at < obj->end; skip_line(obj)) {
        skip_blanks(obj);
        if (keyword(obj, "v"))
            TRY(read_position(obj));
        else if (keyword(obj, "vn"))
            TRY(read_normal(obj));
        else if (keyword(obj, "vt"))
            TRY(read_uv(obj));
        else if (keyword(obj, "f"))
            TRY(read_face(obj));
        else if (keyword(obj, "mtllib"))
            read_libraries(obj);
        else
            for (int kind = 0; kind < N_PART_KINDS; kind++)
                if (keyword(obj, part_kinds[kind].statement)) TRY(read_part(obj, kind));
    }
    if (obj->n_corners == 0) return mesh_source_nothing(obj->source, obj->path, obj->error);
    for (size_t i = 0; i < obj->n_corners; i++) {
        ObjCorner c = obj->corners[i];
        const char *what = c.position > obj->n_positions ? "position"
                           : c.uv > obj->n_uvs           ? "texture coordinate"
                           : c.normal > obj->n_normals   ? "normal"
                                                         : NULL;
        if (!what) continue;
        size_t number = c.position > obj->n_positions ? c.position : c.uv > obj->n_uvs ? c.uv : c.normal;
        size_t there = c.position > obj->n_positions ? obj->n_positions
                       : c.uv > obj->n_uvs           ? obj->n_uvs
                                                     : obj->n_normals;
        return fail(obj->error, STATUS_INPUT, "'%s':%u: a face uses %s %zu; there are %zu", obj->path,
                    obj->lines[i / 3], what, number, there);
    }
    return STATUS_OK;
}

/* Faces that use positions alone: the vertices are the positions. */
static Status make_plain_mesh(Obj *obj, Mesh **mesh)
{
    TRY(mesh_new((uint32_t)obj->n_positions, (uint32_t)obj->n_lines, false, false, mesh, obj->error));
    memcpy((*mesh)->positions, obj->positions, obj->n_positions * sizeof *obj->positions);
    for (size_t i = 0; i < obj->n_corners; i++) (*mesh)->triangles[i / 3][i % 3] = obj->corners[i].position - 1;
    return STATUS_OK;
}

/* Replaces each corner's position by the number of its vertex, and puts the vertices' corners into `unique`. */
static Status number_vertices(Obj *obj, ObjCorner **unique, size_t *n_unique)
{
    size_t room = 64, capacity = 0;
    while (room < 2 * obj->n_corners) room *= 2;
    uint32_t *table = calloc(room, sizeof *table); /* vertex + 1, 0: free */
    if (!table) return fail_memory(obj->error, room * sizeof *table, "the vertices of a mesh");
    *n_unique = 0;
    for (size_t i = 0; i < obj->n_corners; i++) {
        ObjCorner corner = obj->corners[i];
        size_t slot =
            (size_t)hash_u64(hash_u64(corner.position | (uint64_t)corner.uv << 32) ^ corner.normal) & (room - 1);
        while (table[slot] && memcmp(&(*unique)[table[slot] - 1], &corner, sizeof corner) != 0)
            slot = (slot + 1) & (room - 1);
        if (!table[slot]) {
            if (*n_unique >= most_items || !ARRAY_ROOM(*unique, capacity, *n_unique)) {
                free(table);
                return *n_unique >= most_items
                           ? too_many(obj, "vertices")
                           : fail_memory(obj->error, *n_unique * 2 * sizeof corner, "the vertices of a mesh");
            }
            (*unique)[(*n_unique)++] = corner;
            table[slot] = (uint32_t)*n_unique;
        }
        obj->corners[i].position = table[slot];
    }
    free(table);
    return STATUS_OK;
}

static Status make_full_mesh(Obj *obj, Mesh **mesh)
{
    ObjCorner *unique = NULL;
    size_t n_unique = 0;
    Mesh *made = NULL;
    Status status = number_vertices(obj, &unique, &n_unique);
    if (status == STATUS_OK)
        status =
            mesh_new((uint32_t)n_unique, (uint32_t)obj->n_lines, obj->uses_normals, obj->uses_uvs, &made, obj->error);
    for (size_t i = 0; status == STATUS_OK && i < n_unique; i++) {
        made->positions[i] = obj->positions[unique[i].position - 1];
        if (unique[i].normal) made->normals[i] = obj->normals[unique[i].normal - 1];
        if (unique[i].uv) {
            made->uvs[2 * i] = obj->uvs[unique[i].uv - 1].u;
            made->uvs[2 * i + 1] = obj->uvs[unique[i].uv - 1].v;
        }
    }
    for (size_t i = 0; status == STATUS_OK && i < obj->n_corners; i++)
        made->triangles[i / 3][i % 3] = obj->corners[i].position - 1;
    free(unique);
    if (status == STATUS_OK)
        *mesh = made;
    else
        mesh_free(made);
    return status;
}

/* Its triangles are fans, one for each face. */
static Status cut_faces(const Obj *obj, Mesh *mesh)
{
    FaceCut *cut = NULL;
    Status status = STATUS_OK;
    for (size_t i = 0, n; i < obj->n_lines && status == STATUS_OK; i += n) {
        for (n = 1; i + n < obj->n_lines && obj->lines[i + n] == obj->lines[i];) n++;
        if (n == 1 || n + 2 > FACE_MOST_CORNERS) continue;
        if (!cut) cut = malloc(sizeof *cut);
        status = cut ? mesh_cut_face(mesh, i, n, cut, obj->error)
                     : fail_memory(obj->error, sizeof *cut, "the faces of a mesh");
    }
    free(cut);
    return status;
}

static Status make_mesh(Obj *obj, Mesh **mesh)
{
    TRY(obj->uses_uvs || obj->uses_normals ? make_full_mesh(obj, mesh) : make_plain_mesh(obj, mesh));
    Status status = cut_faces(obj, *mesh);
    if (status == STATUS_OK) status = mesh_normalize_normals(*mesh, obj->error);
    if (status == STATUS_OK) return status;
    mesh_free(*mesh);
    *mesh = NULL;
    return status;
}

Status mesh_load_obj(const char *path, MeshSource *source, Mesh **mesh, Error *error)
{
    char *bytes = NULL;
    size_t length = 0;
    TRY(file_read(path, 0, &bytes, &length, error));
    file_end_lines(bytes, length);
    Obj obj = {.path = path, .source = source, .error = error, .end = bytes + length};
    obj.at = bytes + utf8_mark_length(bytes, length);
    Status status = read_lines(&obj);
    free(bytes);
    if (status == STATUS_OK) status = make_mesh(&obj, mesh);
    free(obj.positions);
    free(obj.normals);
    free(obj.uvs);
    free(obj.corners);
    free(obj.lines);
    return status;
}

/* ply.c - reads meshes in the Polygon File Format (G. Turk, Stanford, 1994): text, binary little-endian,
 * binary big-endian. The file is read whole; a header's promises are held against the bytes that are there
 * before memory is taken.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "base/num.h"
#include "mesh/face.h"
#include "mesh/mesh_file.h"

enum {
    MAX_ELEMENTS = 32,
    MAX_PROPERTIES = 256, /* of all elements together */
    MAX_WORD = 64,
    MAX_CORNERS = 255
};

typedef enum PlyType { PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32, PLY_F64, PLY_NO_TYPE } PlyType;

static const struct {
    const char *name, *other_name;
    size_t size;
} ply_types[] = {
    {"char", "int8", 1}, {"uchar", "uint8", 1}, {"short", "int16", 2},   {"ushort", "uint16", 2},
    {"int", "int32", 4}, {"uint", "uint32", 4}, {"float", "float32", 4}, {"double", "float64", 8},
};

typedef enum PlyRole {
    ROLE_NONE = -1,
    ROLE_X,
    ROLE_Y,
    ROLE_Z,
    ROLE_NX,
    ROLE_NY,
    ROLE_NZ,
    ROLE_U,
    ROLE_V,
    N_VERTEX_ROLES,
    ROLE_CORNERS
} PlyRole;

static const struct {
    const char *name;
    PlyRole role;
} vertex_roles[] = {
    {"x", ROLE_X},         {"y", ROLE_Y},         {"z", ROLE_Z},         {"nx", ROLE_NX},       {"ny", ROLE_NY},
    {"nz", ROLE_NZ},       {"u", ROLE_U},         {"v", ROLE_V},         {"s", ROLE_U},         {"t", ROLE_V},
    {"texture_u", ROLE_U}, {"texture_v", ROLE_V}, {"texture_s", ROLE_U}, {"texture_t", ROLE_V},
};

typedef struct PlyProperty {
    PlyType type, count_type; /* count_type: PLY_NO_TYPE for a plain value */
    PlyRole role;
} PlyProperty;

typedef enum PlyElementKind { PLY_VERTEX, PLY_FACE, PLY_OTHER } PlyElementKind;

typedef struct PlyElement {
    char name[MAX_WORD];
    PlyElementKind kind;
    uint64_t count;
    uint32_t first, n; /* its properties */
    size_t least_size; /* bytes of one in a binary file, with empty lists */
    bool has_lists;
} PlyElement;

typedef enum PlyFormat { PLY_NO_FORMAT, PLY_TEXT, PLY_LITTLE, PLY_BIG } PlyFormat;

typedef struct Ply {
    const char *path;
    Error *error;
    const char *at, *end;
    PlyFormat format;
    bool swap; /* the file's byte order is not the machine's */
    PlyElement elements[MAX_ELEMENTS];
    uint32_t n_elements;
    PlyProperty properties[MAX_PROPERTIES];
    uint32_t n_properties;
    uint64_t roles; /* a bit per role found among the vertex properties */
    uint64_t n_vertices;
    Mesh *mesh;
    size_t n_triangles, triangle_capacity;
    bool has_vertices; /* they were read */
    unsigned left_out; /* as MeshSource has it */
    FaceCut cut;
} Ply;

/* The next word of the header's line; "" at its end. Too long a word is cut, which matches no keyword. */
static void header_word(Ply *ply, char word[MAX_WORD])
{
    size_t n = 0;
    while (ply->at < ply->end && (*ply->at == ' ' || *ply->at == '\t' || *ply->at == '\r')) ply->at++;
    for (; ply->at < ply->end && (unsigned char)*ply->at > ' '; ply->at++)
        if (n + 1 < MAX_WORD) word[n++] = *ply->at;
    word[n] = 0;
}

/* Goes behind the line's end. False when the file ends first. */
static bool next_line(Ply *ply)
{
    while (ply->at < ply->end && *ply->at != '\n') ply->at++;
    if (ply->at == ply->end) return false;
    ply->at++;
    return true;
}

static PlyType type_named(const char *name)
{
    for (size_t i = 0; i < COUNT_OF(ply_types); i++)
        if (strcmp(name, ply_types[i].name) == 0 || strcmp(name, ply_types[i].other_name) == 0) return (PlyType)i;
    return PLY_NO_TYPE;
}

static Status header_format(Ply *ply)
{
    char word[MAX_WORD];
    header_word(ply, word);
    if (strcmp(word, "ascii") == 0)
        ply->format = PLY_TEXT;
    else if (strcmp(word, "binary_little_endian") == 0)
        ply->format = PLY_LITTLE;
    else if (strcmp(word, "binary_big_endian") == 0)
        ply->format = PLY_BIG;
    else
        return fail(ply->error, STATUS_INPUT, "'%s': the PLY header's format is '%s', which is unknown", ply->path,
                    word);
    const uint16_t one = 1;
    bool machine_is_little = *(const unsigned char *)&one == 1;
    ply->swap = ply->format == (machine_is_little ? PLY_BIG : PLY_LITTLE);
    return STATUS_OK;
}

static Status header_element(Ply *ply)
{
    if (ply->n_elements == MAX_ELEMENTS)
        return fail(ply->error, STATUS_INPUT, "'%s': the PLY header has more than %d elements", ply->path,
                    MAX_ELEMENTS);
    PlyElement *element = &ply->elements[ply->n_elements++];
    char count[MAX_WORD];
    header_word(ply, element->name);
    header_word(ply, count);
    element->first = ply->n_properties;
    element->kind = strcmp(element->name, "vertex") == 0 ? PLY_VERTEX
                    : strcmp(element->name, "face") == 0 ? PLY_FACE
                                                         : PLY_OTHER;
    uint64_t n = 0;
    const char *digit = count;
    for (; *digit >= '0' && *digit <= '9' && n < UINT64_MAX / 16; digit++) n = n * 10 + (uint64_t)(*digit - '0');
    if (digit == count || *digit)
        return fail(ply->error, STATUS_INPUT, "'%s': the number of elements '%s' in the PLY header is '%s'", ply->path,
                    element->name, count);
    if (element->kind != PLY_OTHER && n >= UINT32_MAX)
        return fail(ply->error, STATUS_INPUT,
                    "'%s': the PLY header promises %s of element '%s'; more than 4294967294 cannot be read", ply->path,
                    count, element->name);
    for (uint32_t i = 0; i + 1 < ply->n_elements; i++)
        if (element->kind != PLY_OTHER && ply->elements[i].kind == element->kind)
            return fail(ply->error, STATUS_INPUT, "'%s': the PLY header has element '%s' twice", ply->path,
                        element->name);
    element->count = n;
    return STATUS_OK;
}

static Status header_property(Ply *ply)
{
    if (ply->n_elements == 0)
        return fail(ply->error, STATUS_INPUT, "'%s': the PLY header has a property before the first element",
                    ply->path);
    if (ply->n_properties == MAX_PROPERTIES)
        return fail(ply->error, STATUS_INPUT, "'%s': the PLY header has more than %d properties", ply->path,
                    MAX_PROPERTIES);
    PlyElement *element = &ply->elements[ply->n_elements - 1];
    PlyProperty *property = &ply->properties[ply->n_properties++];
    *property = (PlyProperty){PLY_NO_TYPE, PLY_NO_TYPE, ROLE_NONE};
    char word[MAX_WORD], count_word[MAX_WORD] = "", name[MAX_WORD];
    header_word(ply, word);
    bool list = strcmp(word, "list") == 0;
    if (list) {
        header_word(ply, count_word);
        header_word(ply, word);
        property->count_type = type_named(count_word);
    }
    property->type = type_named(word);
    header_word(ply, name);
    if (property->type == PLY_NO_TYPE ||
        (list && (property->count_type == PLY_NO_TYPE || property->count_type >= PLY_F32)))
        return fail(ply->error, STATUS_INPUT,
                    "'%s': property '%s' of element '%s' in the PLY header has an unknown type '%s%s%s'", ply->path,
                    name, element->name, count_word, list ? " " : "", word);
    element->n++;
    element->has_lists |= list;
    element->least_size += ply_types[list ? property->count_type : property->type].size;
    for (size_t i = 0; !list && element->kind == PLY_VERTEX && i < COUNT_OF(vertex_roles); i++)
        if (strcmp(name, vertex_roles[i].name) == 0) property->role = vertex_roles[i].role;
    if (element->kind == PLY_VERTEX && (strcmp(name, "red") == 0 || strcmp(name, "diffuse_red") == 0))
        ply->left_out |= 1U << MESH_LEFT_COLORS;
    if (list && element->kind == PLY_FACE && strcmp(name, "texcoord") == 0) ply->left_out |= 1U << MESH_LEFT_FACE_UVS;
    if (list && element->kind == PLY_FACE &&
        (strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0)) {
        if (property->type >= PLY_F32)
            return fail(ply->error, STATUS_INPUT, "'%s': the vertex numbers of faces are of type '%s'", ply->path,
                        word);
        property->role = ROLE_CORNERS;
    }
    if (property->role == ROLE_NONE) return STATUS_OK;
    if (ply->roles >> property->role & 1)
        return fail(ply->error, STATUS_INPUT, "'%s': the PLY header has two properties that mean '%s'", ply->path,
                    name);
    ply->roles |= UINT64_C(1) << property->role;
    return STATUS_OK;
}

static Status read_header(Ply *ply)
{
    char word[MAX_WORD];
    header_word(ply, word);
    if (strcmp(word, "ply") != 0 || !next_line(ply))
        return fail(ply->error, STATUS_INPUT, "'%s' is not a PLY file; it does not start with 'ply'", ply->path);
    for (unsigned line = 2;; line++) {
        header_word(ply, word);
        if (strcmp(word, "format") == 0)
            TRY(header_format(ply));
        else if (strcmp(word, "element") == 0)
            TRY(header_element(ply));
        else if (strcmp(word, "property") == 0)
            TRY(header_property(ply));
        else if (strcmp(word, "end_header") != 0 && strcmp(word, "comment") != 0 && strcmp(word, "obj_info") != 0 &&
                 word[0])
            return fail(ply->error, STATUS_INPUT, "'%s':%u: unknown word '%s' in the PLY header", ply->path, line,
                        word);
        bool more = next_line(ply);
        if (strcmp(word, "end_header") == 0) break;
        if (!more) return fail(ply->error, STATUS_INPUT, "'%s' ends inside its PLY header", ply->path);
    }
    if (ply->format == PLY_NO_FORMAT)
        return fail(ply->error, STATUS_INPUT, "'%s': the PLY header does not say the format", ply->path);
    return STATUS_OK;
}

/* Whether all bits of a group of roles were found. */
static bool has_roles(const Ply *ply, PlyRole first, PlyRole last)
{
    for (int role = first; role <= (int)last; role++)
        if (!(ply->roles >> role & 1)) return false;
    return true;
}

/* The header's promises against each other and against the size of the file. */
static Status check_header(Ply *ply)
{
    uint64_t n_faces = 0, left = (uint64_t)(ply->end - ply->at);
    for (uint32_t i = 0; i < ply->n_elements; i++) {
        const PlyElement *element = &ply->elements[i];
        if (element->kind == PLY_VERTEX) ply->n_vertices = element->count;
        if (element->kind == PLY_FACE) n_faces = element->count;
        /* In a text every value takes a digit and a space, but for the last. */
        uint64_t least = ply->format == PLY_TEXT ? 2 * (uint64_t)element->n : element->least_size;
        uint64_t slack = ply->format == PLY_TEXT;
        if (least > 0 && element->count > (left + slack) / least)
            return fail(ply->error, STATUS_INPUT,
                        "'%s': the PLY header promises %llu of element '%s', at least %llu bytes each, but only %llu "
                        "bytes are left",
                        ply->path, (unsigned long long)element->count, element->name, (unsigned long long)least,
                        (unsigned long long)left);
        left -= least * element->count > left ? left : least * element->count;
    }
    if (ply->n_vertices == 0) return fail(ply->error, STATUS_INPUT, "'%s' has no vertices", ply->path);
    if (n_faces == 0) return fail(ply->error, STATUS_INPUT, "'%s' has no faces", ply->path);
    if (!has_roles(ply, ROLE_X, ROLE_Z))
        return fail(ply->error, STATUS_INPUT, "'%s': the vertices in the PLY header lack one of x, y and z", ply->path);
    if (!(ply->roles >> ROLE_CORNERS & 1))
        return fail(ply->error, STATUS_INPUT, "'%s': the faces in the PLY header have no list 'vertex_indices'",
                    ply->path);
    bool normals = has_roles(ply, ROLE_NX, ROLE_NZ);
    bool uvs = has_roles(ply, ROLE_U, ROLE_V);
    TRY(mesh_new((uint32_t)ply->n_vertices, (uint32_t)n_faces, normals, uvs, &ply->mesh, ply->error));
    ply->mesh->n_triangles = 0;
    ply->triangle_capacity = (size_t)n_faces;
    return STATUS_OK;
}

static inline uint16_t load_u16(const char *at, bool swap)
{
    uint16_t x;
    memcpy(&x, at, sizeof x);
    if (swap) x = (uint16_t)(x << 8 | x >> 8);
    return x;
}

static inline uint32_t load_u32(const char *at, bool swap)
{
    uint32_t x;
    memcpy(&x, at, sizeof x);
    return swap ? x << 24 | (x << 8 & 0xff0000U) | (x >> 8 & 0xff00U) | x >> 24 : x;
}

static inline double load_float(const char *at, bool swap)
{
    uint32_t bits = load_u32(at, swap);
    float x;
    memcpy(&x, &bits, sizeof x);
    return (double)x;
}

static inline double load_double(const char *at, bool swap)
{
    uint32_t first = load_u32(at, swap);
    uint32_t second = load_u32(at + 4, swap);
    uint32_t words[2] = {swap ? second : first, swap ? first : second};
    double x;
    memcpy(&x, words, sizeof x);
    return x;
}

static inline double load_value(const char *at, PlyType type, bool swap)
{
    switch (type) {
    case PLY_I8: return (signed char)*at;
    case PLY_U8: return (unsigned char)*at;
    case PLY_I16: return (int16_t)load_u16(at, swap);
    case PLY_U16: return load_u16(at, swap);
    case PLY_I32: return (int32_t)load_u32(at, swap);
    case PLY_U32: return load_u32(at, swap);
    case PLY_F32: return load_float(at, swap);
    case PLY_F64: return load_double(at, swap);
    case PLY_NO_TYPE: break;
    }
    return 0;
}

static Status ends_inside(const Ply *ply, const PlyElement *element, uint64_t index)
{
    return fail(ply->error, STATUS_INPUT, "'%s' ends inside %s %llu of %llu", ply->path, element->name,
                (unsigned long long)index, (unsigned long long)element->count);
}

/* The next value of a text file. */
static Status text_value(Ply *ply, const PlyElement *element, uint64_t index, double *value)
{
    while (ply->at < ply->end && (unsigned char)*ply->at <= ' ' && *ply->at) ply->at++;
    if (ply->at == ply->end) return ends_inside(ply, element, index);
    size_t n = num_parse(ply->at, (size_t)(ply->end - ply->at), value);
    const char *behind = ply->at + n;
    if (n == 0 || (behind < ply->end && (unsigned char)*behind > ' ')) {
        int shown = mesh_text_shown(ply->at, ply->end);
        return fail(ply->error, STATUS_INPUT, "'%s': %s %llu of %llu has '%.*s' where a number should be", ply->path,
                    element->name, (unsigned long long)index, (unsigned long long)element->count, shown, ply->at);
    }
    ply->at = behind;
    return STATUS_OK;
}

/* The next value of either kind of file. */
static inline Status next_value(Ply *ply, const PlyElement *element, uint64_t index, PlyType type, double *value)
{
    if (ply->format == PLY_TEXT) return text_value(ply, element, index, value);
    size_t size = ply_types[type].size;
    if ((size_t)(ply->end - ply->at) < size) return ends_inside(ply, element, index);
    *value = load_value(ply->at, type, ply->swap);
    ply->at += size;
    return STATUS_OK;
}

static inline Status list_length(Ply *ply, const PlyElement *element, uint64_t index, PlyType type, uint64_t *length)
{
    double value = 0;
    TRY(next_value(ply, element, index, type, &value));
    if (!(value >= 0) || value > 4294967295.0 || value != floor(value))
        return fail(ply->error, STATUS_INPUT, "'%s': %s %llu of %llu has a list of %g values", ply->path, element->name,
                    (unsigned long long)index, (unsigned long long)element->count, value);
    *length = (uint64_t)value;
    return STATUS_OK;
}

static Status skip_values(Ply *ply, const PlyElement *element, uint64_t index, PlyType type, uint64_t n)
{
    if (ply->format != PLY_TEXT) {
        size_t left = (size_t)(ply->end - ply->at);
        if (n > left / ply_types[type].size) return ends_inside(ply, element, index);
        ply->at += n * ply_types[type].size;
        return STATUS_OK;
    }
    double ignored;
    for (; n > 0; n--) TRY(text_value(ply, element, index, &ignored));
    return STATUS_OK;
}

static Status skip_property(Ply *ply, const PlyElement *element, uint64_t index, const PlyProperty *property)
{
    uint64_t n = 1;
    if (property->count_type != PLY_NO_TYPE) TRY(list_length(ply, element, index, property->count_type, &n));
    return skip_values(ply, element, index, property->type, n);
}

static Status skip_element(Ply *ply, const PlyElement *element)
{
    if (element->n == 0) return STATUS_OK;
    if (!element->has_lists && ply->format != PLY_TEXT) {
        if ((uint64_t)(ply->end - ply->at) / element->least_size < element->count) return ends_inside(ply, element, 0);
        ply->at += element->least_size * element->count;
        return STATUS_OK;
    }
    for (uint64_t i = 0; i < element->count; i++)
        for (uint32_t k = 0; k < element->n; k++)
            TRY(skip_property(ply, element, i, &ply->properties[element->first + k]));
    return STATUS_OK;
}

static Status store_vertex(Ply *ply, const PlyElement *element, uint64_t i, const double values[N_VERTEX_ROLES])
{
    Mesh *mesh = ply->mesh;
    float kept[N_VERTEX_ROLES];
    for (int role = 0; role < N_VERTEX_ROLES; role++) {
        kept[role] = (float)values[role];
        if (isfinite(kept[role])) continue;
        bool used = role <= ROLE_Z || (role <= ROLE_NZ ? mesh->normals != NULL : mesh->uvs != NULL);
        if (used)
            return fail(ply->error, STATUS_INPUT, "'%s': vertex %llu of %llu has a coordinate that is not finite: %g",
                        ply->path, (unsigned long long)i, (unsigned long long)element->count, values[role]);
    }
    mesh->positions[i] = vec3f(kept[ROLE_X], kept[ROLE_Y], kept[ROLE_Z]);
    if (mesh->normals) mesh->normals[i] = vec3f(kept[ROLE_NX], kept[ROLE_NY], kept[ROLE_NZ]);
    if (mesh->uvs) {
        mesh->uvs[2 * i] = kept[ROLE_U];
        mesh->uvs[2 * i + 1] = kept[ROLE_V];
    }
    return STATUS_OK;
}

static Status read_vertices(Ply *ply, const PlyElement *element)
{
    double values[N_VERTEX_ROLES] = {0};
    for (uint64_t i = 0; i < element->count; i++) {
        for (uint32_t k = 0; k < element->n; k++) {
            const PlyProperty *property = &ply->properties[element->first + k];
            if (property->role == ROLE_NONE)
                TRY(skip_property(ply, element, i, property));
            else
                TRY(next_value(ply, element, i, property->type, &values[property->role]));
        }
        TRY(store_vertex(ply, element, i, values));
    }
    return STATUS_OK;
}

static inline Status add_triangle(Ply *ply, uint32_t a, uint32_t b, uint32_t c)
{
    Mesh *mesh = ply->mesh;
    if (ply->n_triangles == UINT32_MAX - 1)
        return fail(ply->error, STATUS_INPUT, "'%s' has more than 4294967294 triangles", ply->path);
    if (ply->n_triangles >= ply->triangle_capacity &&
        !ARRAY_ROOM(mesh->triangles, ply->triangle_capacity, ply->n_triangles))
        return fail_memory(ply->error, ply->n_triangles * 2 * sizeof *mesh->triangles, "the triangles of a mesh");
    uint32_t *t = mesh->triangles[ply->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return STATUS_OK;
}

/* One polygon. Of a file that has its faces first, a fan from its first corner. */
static Status read_polygon(Ply *ply, const PlyElement *element, uint64_t i, const PlyProperty *property)
{
    uint64_t n = 0;
    TRY(list_length(ply, element, i, property->count_type, &n));
    if (n < 3 || n > MAX_CORNERS)
        return fail(ply->error, STATUS_INPUT, "'%s': face %llu of %llu has %llu corners; 3 to %d can be read",
                    ply->path, (unsigned long long)i, (unsigned long long)element->count, (unsigned long long)n,
                    MAX_CORNERS);
    size_t size = ply_types[property->type].size;
    bool text = ply->format == PLY_TEXT;
    if (!text && (size_t)(ply->end - ply->at) < n * size) return ends_inside(ply, element, i);
    uint32_t first = 0, last = 0;
    for (uint64_t k = 0; k < n; k++) {
        double value = 0;
        if (text) {
            TRY(text_value(ply, element, i, &value));
        } else {
            value = load_value(ply->at, property->type, ply->swap);
            ply->at += size;
        }
        if (UNLIKELY(!(value >= 0) || value >= (double)ply->n_vertices || (text && value != floor(value))))
            return fail(ply->error, STATUS_INPUT, "'%s': face %llu of %llu uses vertex %.10g; there are %llu, from 0",
                        ply->path, (unsigned long long)i, (unsigned long long)element->count, value,
                        (unsigned long long)ply->n_vertices);
        uint32_t vertex = (uint32_t)value;
        if (k >= 2) TRY(add_triangle(ply, first, last, vertex));
        if (k == 0) first = vertex;
        last = vertex;
    }
    if (!ply->has_vertices) return STATUS_OK;
    return mesh_cut_face(ply->mesh, ply->n_triangles - (n - 2), n - 2, &ply->cut, ply->error);
}

static Status read_faces(Ply *ply, const PlyElement *element)
{
    for (uint64_t i = 0; i < element->count; i++)
        for (uint32_t k = 0; k < element->n; k++) {
            const PlyProperty *property = &ply->properties[element->first + k];
            if (property->role == ROLE_CORNERS)
                TRY(read_polygon(ply, element, i, property));
            else
                TRY(skip_property(ply, element, i, property));
        }
    return STATUS_OK;
}

static Status read_body(Ply *ply)
{
    bool vertices = false, faces = false;
    for (uint32_t i = 0; i < ply->n_elements && !(vertices && faces); i++) {
        const PlyElement *element = &ply->elements[i];
        switch (element->kind) {
        case PLY_VERTEX:
            TRY(read_vertices(ply, element));
            ply->has_vertices = vertices = true;
            break;
        case PLY_FACE:
            TRY(read_faces(ply, element));
            faces = true;
            break;
        case PLY_OTHER: TRY(skip_element(ply, element)); break;
        }
    }
    ply->mesh->n_triangles = (uint32_t)ply->n_triangles;
    return mesh_normalize_normals(ply->mesh, ply->error);
}

Status mesh_load_ply(const char *path, MeshSource *source, Mesh **mesh, Error *error)
{
    if (source && source->n_asked)
        return mesh_source_nothing(source, path, error); /* there is nothing to name parts with */
    char *bytes = NULL;
    size_t length = 0;
    TRY(file_read(path, 0, &bytes, &length, error));
    Ply *ply = calloc(1, sizeof *ply); /* some kilobytes: not for the stack of a small thread */
    if (!ply) {
        free(bytes);
        return fail_memory(error, sizeof *ply, "a PLY reader");
    }
    ply->path = path;
    ply->error = error;
    ply->at = bytes;
    ply->end = bytes + length;
    Status status = read_header(ply);
    if (status == STATUS_OK) status = check_header(ply);
    if (status == STATUS_OK) status = read_body(ply);
    if (source) source->left_out |= ply->left_out;
    if (status == STATUS_OK)
        *mesh = ply->mesh;
    else
        mesh_free(ply->mesh);
    free(ply);
    free(bytes);
    return status;
}

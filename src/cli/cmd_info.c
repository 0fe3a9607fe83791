/* cmd_info.c - the command info: what a picture, a mesh or a file of grids holds.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/file.h"
#include "base/num.h"
#include "cli/commands.h"
#include "mesh/mesh_file.h"
#include "image/image.h"
#include "optics/nanovdb.h"
#include "render/checkpoint.h"

/* Facts go out as "name  text" or as members of one JSON object. */
typedef struct Facts {
    bool as_json;
    size_t longest; /* of the texts: the names of hundreds of objects would fill a terminal; 0: as long as they are */
    JsonWriter json;
    Buf *out;
} Facts;

enum { NAME_COLUMNS = 28, LONGEST_ON_TERMINAL = 240 };

/* As many bytes as there are up to `most`, without a part of a character of UTF-8. */
static size_t text_head(const char *text, size_t most)
{
    while (most > 0 && ((unsigned char)text[most] & 0xc0) == 0x80) most--;
    return most;
}

static void add_fact(void *context, const char *name, const char *text)
{
    Facts *facts = context;
    size_t length = strlen(text);
    if (facts->as_json)
        json_add_text(&facts->json, name, text);
    else if (facts->longest && length > facts->longest)
        buf_format(facts->out, "%-*s %.*s... (%zu bytes; --json has all)\n", NAME_COLUMNS, name,
                   (int)text_head(text, facts->longest), text, length);
    else
        buf_format(facts->out, "%-*s %s\n", NAME_COLUMNS, name, text);
}

static void add_number(Facts *facts, const char *name, double number)
{
    char text[NUM_TEXT_SIZE];
    num_print(number, text);
    if (facts->as_json)
        json_add_number(&facts->json, name, number);
    else
        add_fact(facts, name, text);
}

static void add_float(Facts *facts, const char *name, float number)
{
    char text[NUM_TEXT_SIZE];
    num_print_float(number, text);
    if (facts->as_json)
        json_add_float(&facts->json, name, number);
    else
        add_fact(facts, name, text);
}

static void add_truth(Facts *facts, const char *name, bool truth)
{
    if (facts->as_json)
        json_add_truth(&facts->json, name, truth);
    else
        add_fact(facts, name, truth ? "yes" : "no");
}

/* A node that has nothing below it is the same object. */
static bool is_the_same_again(const MeshSource *source, const MeshPart *part)
{
    if (strcmp(part->kind, "object") != 0 || !part->by_number) return false;
    const MeshPart *node = mesh_source_find_numbered(source, "node", part->number);
    return node && node->n_triangles == part->n_triangles;
}

/* What `part` of a mesh can be. */
static void describe_parts(const MeshSource *source, Facts *facts)
{
    if (!source->n_parts) return;
    if (facts->as_json) {
        json_key(&facts->json, "parts");
        json_begin_array(&facts->json);
    }
    for (size_t i = 0; i < source->n_parts; i++) {
        const MeshPart *part = &source->parts[i];
        if (is_the_same_again(source, part)) continue;
        Buf said = {0};
        const MeshMaterial *material = mesh_source_material_of(source, part);
        if (material) material_describe(material, &said);
        if (facts->as_json) {
            json_begin_object(&facts->json);
            json_add_text(&facts->json, "kind", part->kind);
            json_add_text(&facts->json, "name", part->name);
            json_add_number(&facts->json, "triangles", (double)part->n_triangles);
            if (said.length) json_add_text(&facts->json, "material", buf_text(&said));
            json_end(&facts->json);
        } else {
            buf_format(facts->out, "%-*s '", NAME_COLUMNS, part->kind);
            buf_add_shown(facts->out, part->name, SIZE_MAX);
            buf_format(facts->out, "', %llu triangles%s%s\n", (unsigned long long)part->n_triangles,
                       said.length ? ": " : "", buf_text(&said));
        }
        buf_clear(&said);
    }
    if (facts->as_json) json_end(&facts->json);
}

/* Meshes of a scene do not take materials, which nobody would see before the picture. */
static void describe_materials(const char *path, const MeshSource *source, Facts *facts)
{
    size_t n = 0;
    for (size_t i = 0; i < source->n_materials; i++) n += material_says_something(&source->materials[i]);
    if (!n) return;
    add_number(facts, "materials", (double)n);
    Buf text = {0};
    buf_add(&text, "meniscus import ");
    add_for_shell(&text, path);
    add_fact(facts, "a scene that has them", buf_text(&text));
    buf_clear(&text);
}

static Status describe_mesh(const char *path, Facts *facts, Error *error)
{
    Mesh *mesh = NULL;
    MeshReport report;
    MeshSource source = {0};
    Status status = mesh_load(path, &source, &mesh, error);
    MeshCrossings crossings = {0};
    MeshParts parts = {0};
    MeshJoin join = {0};
    if (status == STATUS_OK) status = mesh_inspect_joined(mesh, &join, &report, error);
    if (status == STATUS_OK) status = mesh_find_crossings(mesh, NULL, &crossings, error);
    if (status == STATUS_OK && report.closed) status = mesh_find_parts(mesh, NULL, &parts, error);
    if (status == STATUS_OK) {
        describe_parts(&source, facts);
        describe_materials(path, &source, facts);
        if (source.unit_m > 0) add_number(facts, "unit in metres", source.unit_m);
        add_number(facts, "vertices", mesh->n_vertices);
        add_number(facts, "triangles", mesh->n_triangles);
        add_truth(facts, "normals", mesh->normals != NULL);
        add_truth(facts, "texture coordinates", mesh->uvs != NULL);
        add_truth(facts, "closed", report.closed);
        add_number(facts, "open edges", report.n_open_edges);
        add_number(facts, "vertices joined to close it", join.n_joined);
        add_number(facts, "edges of more than two faces", report.n_non_manifold_edges);
        add_truth(facts, "faces agree on outside", report.consistent);
        add_truth(facts, "inside out", report.inside_out);
        add_number(facts, "connected pieces", report.n_components);
        add_number(facts, "pieces turned inward", report.n_inverted);
        add_number(facts, "pieces within pieces", parts.n_within);
        add_number(facts, parts.gave_up ? "pieces that overlap, at least" : "pieces that overlap", parts.n_overlapping);
        add_number(facts, crossings.gave_up ? "faces that cross, at least" : "faces that cross", (double)crossings.n);
        add_number(facts, "faces without area", report.n_degenerate);
        add_number(facts, "faces that occur twice", report.n_duplicate);
        add_number(facts, "volume", report.volume);
        add_number(facts, "area", report.area);
        add_float(facts, "x from", (float)report.bounds.min.x);
        add_float(facts, "x to", (float)report.bounds.max.x);
        add_float(facts, "y from", (float)report.bounds.min.y);
        add_float(facts, "y to", (float)report.bounds.max.y);
        add_float(facts, "z from", (float)report.bounds.min.z);
        add_float(facts, "z to", (float)report.bounds.max.z);
    }
    mesh_parts_clear(&parts);
    mesh_source_clear(&source);
    mesh_free(mesh);
    return status;
}

static Status describe_picture(const char *path, Facts *facts, Error *error)
{
    Image image = {0};
    TRY(image_read(path, &image, error));
    add_number(facts, "width", image.width);
    add_number(facts, "height", image.height);
    Buf channels = {0};
    for (uint32_t i = 0; i < image.n_channels; i++) buf_format(&channels, "%s%s", i ? " " : "", image.names[i]);
    add_fact(facts, "channels", buf_text(&channels));
    buf_clear(&channels);
    image_clear(&image);
    return STATUS_OK;
}

static void describe_grid(void *context, const NanovdbGrid *grid)
{
    Facts *facts = context;
    const Box3 *box = &grid->box;
    Buf text = {0};
    buf_format(&text, "%d x %d x %d", (int)grid->n[0], (int)grid->n[1], (int)grid->n[2]);
    if (facts->as_json) json_begin_object(&facts->json);
    add_fact(facts, facts->as_json ? "name" : "grid", grid->name);
    add_fact(facts, "type", grid->type);
    add_truth(facts, "can be a volume", grid->readable);
    add_fact(facts, "spans voxels", buf_text(&text));
    add_number(facts, "voxels that are set", (double)grid->n_voxels);
    add_number(facts, "bytes in memory", (double)grid->n_bytes);
    add_number(facts, "size of a voxel", grid->voxel[0]);
    add_number(facts, "x from", box->min.x);
    add_number(facts, "x to", box->max.x);
    add_number(facts, "y from", box->min.y);
    add_number(facts, "y to", box->max.y);
    add_number(facts, "z from", box->min.z);
    add_number(facts, "z to", box->max.z);
    if (facts->as_json) json_end(&facts->json);
    buf_clear(&text);
}

static Status describe_grids(const char *path, Facts *facts, Error *error)
{
    if (facts->as_json) {
        json_key(&facts->json, "grids");
        json_begin_array(&facts->json);
    }
    Status status = nanovdb_visit(path, describe_grid, facts, error);
    if (facts->as_json) json_end(&facts->json);
    return status;
}

/* What a checkpoint or a slice adds to its picture. */
static Status describe_state(const char *path, Facts *facts, Error *error)
{
    char *mark, text[64];
    TRY(exr_read_attribute(path, CHECKPOINT_ATTRIBUTE, &mark, error));
    bool has_state = mark != NULL;
    free(mark);
    if (!has_state) return STATUS_OK;
    Checkpoint file;
    Status status = checkpoint_open(path, &file, error);
    if (status == STATUS_OK) {
        const CheckpointNotes *notes = &file.notes;
        snprintf(text, sizeof text, "%u..%u of %u", notes->first_sample + 1, notes->end_sample, notes->samples);
        add_fact(facts, "state: samples", text);
        if (notes->noise > 0) {
            snprintf(text, sizeof text, "%.3g %%", 100 * notes->noise);
            add_fact(facts, "state: noise to come to", text);
        }
        if (file.has_search) add_fact(facts, "state: photons for caustics", file.searching ? "on their way" : "done");
        add_number(facts, "state: done, at least", file.least_samples);
        add_number(facts, "state: done, at most", file.most_samples);
        for (uint32_t i = 0; i < notes->n_facts; i++) {
            snprintf(text, sizeof text, "state: %s", notes->facts[i].name);
            if (notes->facts[i].text[0] != '#') add_fact(facts, text, notes->facts[i].text);
        }
    }
    checkpoint_close(&file);
    return status;
}

static Status describe_exr(const char *path, Facts *facts, Error *error)
{
    TRY(exr_visit_attributes(path, add_fact, facts, error));
    return strcmp(path, "-") == 0 ? STATUS_OK : describe_state(path, facts, error);
}

static Status describe_hdr(const char *path, Facts *facts, Error *error)
{
    TRY(hdr_visit_header(path, add_fact, facts, error));
    return describe_picture(path, facts, error);
}

static Status describe(const char *path, Facts *facts, Error *error)
{
    const char *extension = file_extension(path);
    if (mesh_has_reader(extension)) return describe_mesh(path, facts, error);
    if (strcasecmp(extension, "nvdb") == 0) return describe_grids(path, facts, error);
    if (strcasecmp(extension, "exr") == 0) return describe_exr(path, facts, error);
    if (strcasecmp(extension, "hdr") == 0) return describe_hdr(path, facts, error);
    if (strcasecmp(extension, "mns") == 0)
        return fail(error, STATUS_USAGE, "'%s' is a scene; 'meniscus check %s' says what it holds", path, path);
    return describe_picture(path, facts, error);
}

/* One of several files has its name in front. */
static Status describe_one(const char *path, bool alone, Facts *facts, Error *error)
{
    if (facts->as_json) json_begin_object(&facts->json);
    if (!alone) add_fact(facts, "file", path);
    Status status = describe(path, facts, error);
    if (facts->as_json) json_end(&facts->json);
    return status;
}

Status cmd_info(const Options *options, const Talk *talk, Error *error)
{
    (void)talk;
    Buf out = {0};
    Facts facts = {.as_json = option_given(options, OPTION_JSON), .json = json_writer(&out, true), .out = &out};
    if (isatty(STDOUT_FILENO)) facts.longest = LONGEST_ON_TERMINAL;
    const bool alone = options->n_operands == 1, is_list = facts.as_json && !alone;
    Status status = STATUS_OK;
    if (is_list) json_begin_array(&facts.json);
    for (size_t i = 0; i < options->n_operands && status == STATUS_OK; i++) {
        if (i > 0 && !facts.as_json) buf_add(&out, "\n");
        status = describe_one(options->operands[i], alone, &facts, error);
    }
    if (is_list) json_end(&facts.json);
    if (facts.as_json) buf_add(&out, "\n");
    if (status == STATUS_OK) status = print_out(&out, error);
    buf_clear(&out);
    return status;
}

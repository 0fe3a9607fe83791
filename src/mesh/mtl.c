/* mtl.c - reads what a library of materials says, Wavefront's .mtl beside an .obj: colour, picture, index, opacity, and what
 * later exporters add for metals.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/num.h"
#include "mesh/mesh_file.h"

static const size_t largest_library = (size_t)1 << 24;

typedef struct Line {
    const char *at, *end;
} Line;

static Line next_word(Line *line)
{
    while (line->at < line->end && (unsigned char)*line->at <= ' ') line->at++;
    Line word = {line->at, line->at};
    while (word.end < line->end && (unsigned char)*word.end > ' ') word.end++;
    line->at = word.end;
    return word;
}

static bool is_word(Line word, const char *text)
{
    size_t length = (size_t)(word.end - word.at);
    return strlen(text) == length && memcmp(word.at, text, length) == 0;
}

/* What the library that is read has so far. */
typedef struct Library {
    MeshSource *source;
    const char *folder; /* of the library, from that of the OBJ file: "" or "maps/" */
    MeshMaterial material;
    bool begun;
    bool by_blender; /* which counts shininess up to 1000 */
} Library;

/* The name of a file behind options, if there are any: "-bm 1 wax.png"; it may have blanks where there are none. */
static char *file_behind(Line rest, const char *folder)
{
    Line word = next_word(&rest), last = word;
    if (word.at < word.end && *word.at == '-')
        for (; word.at < word.end; word = next_word(&rest)) last = word;
    else
        last.end = rest.end;
    if (last.at >= last.end) return NULL;
    Buf path = {0};
    bool absolute = *last.at == '/' || *last.at == '\\' || (last.end - last.at > 1 && last.at[1] == ':');
    buf_format(&path, "%s%.*s", absolute ? "" : folder, (int)(last.end - last.at), last.at);
    for (char *c = path.text; c && *c; c++)
        if (*c == '\\') *c = '/'; /* as Windows has it */
    return path.text;
}

static void read_numbers(Line rest, const MaterialRow *row, MeshMaterial *material)
{
    double numbers[3];
    Line word = next_word(&rest);
    int n = 0;
    for (; n < row->n && word.at < word.end; n++, word = next_word(&rest))
        if (num_parse(word.at, (size_t)(word.end - word.at), &numbers[n]) == 0 || !isfinite(numbers[n])) break;
    if (n == 0) return;
    for (; n < row->n; n++) numbers[n] = numbers[n - 1]; /* green and blue are as red where they are left out */
    material_set(material, row, numbers);
}

/* What a line says; what is not understood says nothing. */
static void read_line(Library *library, Line word, Line rest)
{
    const MaterialRow *row;
    MeshMaterial *material = &library->material;
    if (is_word(word, "bump") || is_word(word, "map_bump")) word = (Line){"map_Bump", strchr("map_Bump", 0)};
    for (size_t i = 0; (row = material_row(i)) != NULL; i++) {
        if (!row->statement || !is_word(word, row->statement)) continue;
        if (!row->is_picture) {
            read_numbers(rest, row, material);
        } else if (!material->pictures[row->key].file) {
            material->pictures[row->key].file = file_behind(rest, library->folder);
        }
        return;
    }
    double clear;
    Line number = next_word(&rest);
    if (!is_word(word, "Tr") || num_parse(number.at, (size_t)(number.end - number.at), &clear) == 0) return;
    material->facts[FACT_OPACITY][0] = 1 - clear;
    material->given |= (uint64_t)1 << FACT_OPACITY;
}

static double mean_of(const double numbers[3])
{
    return (numbers[0] + numbers[1] + numbers[2]) / 3;
}

/* How much goes through. The format has no word for it: it shows in the model of illumination, whose numbers 4, 6, 7 and 9 are of
 * glass, or in an index beside an opacity below 1; Blender writes it as a grey filter. What is more clear than not is all clear. */
static void find_transmission(const Library *library, MeshMaterial *material)
{
    double *transmission = material->facts[FACT_TRANSMISSION], opacity = material->facts[FACT_OPACITY][0];
    int model = (int)fmin(fmax(material->facts[FACT_ILLUMINATION][0], 0), 99);
    bool refracts = material_says(material, FACT_INDEX) && material->facts[FACT_INDEX][0] > 1.01;
    if (library->by_blender && material_says(material, FACT_FILTER))
        *transmission = mean_of(material->facts[FACT_FILTER]);
    else if (model == 4 || model == 6 || model == 7 || model == 9)
        *transmission = 1;
    if (*transmission == 0 && opacity < 1 && refracts) *transmission = opacity <= 0.5 ? 1 : 1 - opacity;
    *transmission = fmin(fmax(*transmission, 0), 1);
    bool holes = opacity < 1 || picture_is_given(&material->pictures[PICTURE_OPACITY]);
    if (holes && *transmission == 0) material->alpha = ALPHA_BLEND;
}

/* The colour of what is clear: the filter, else the base colour's hue, for its brightness is that of something opaque. */
static void find_filter(const Library *library, MeshMaterial *material)
{
    double *filter = material->facts[FACT_FILTER];
    const double *base = material->facts[FACT_BASE_COLOR];
    double most = fmax(fmax(base[0], base[1]), base[2]);
    if (!library->by_blender && material_says(material, FACT_FILTER) && mean_of(filter) > 0) return;
    for (int i = 0; i < 3; i++) filter[i] = most > 0 ? base[i] / most : 1;
}

/* From Phong's exponent, whose usual range ends at 1000: that is meant as polished. */
static void find_roughness(const Library *library, MeshMaterial *material)
{
    const double most = 1000;
    double *roughness = material->facts[FACT_ROUGHNESS], shininess = fmax(material->facts[FACT_SHININESS][0], 0);
    if (material_says(material, FACT_ROUGHNESS)) return;
    if (!material_says(material, FACT_SHININESS))
        *roughness = material->facts[FACT_TRANSMISSION][0] > 0 ? 0 : 0.5;
    else if (shininess >= most)
        *roughness = 0;
    else
        *roughness = library->by_blender ? 1 - sqrt(shininess / most) : pow(2 / (shininess + 2), 0.25);
}

/* What the material has besides what it says itself. Of libraries that give a name twice, the first counts. */
static void end_material(Library *library)
{
    MeshMaterial *material = &library->material;
    if (library->begun && material->name && !mesh_source_find_material(library->source, material->name)) {
        find_transmission(library, material);
        if (!material_says(material, FACT_BASE_COLOR))
            for (int i = 0; i < 3; i++) material->facts[FACT_BASE_COLOR][i] = 0.8;
        find_filter(library, material);
        if (!material_says(material, FACT_METAL)) material->facts[FACT_METAL][0] = 0;
        if (material_says(material, FACT_REFLECTION) && mean_of(material->facts[FACT_REFLECTION]) == 0)
            material->facts[FACT_SPECULAR][0] = 0;
        find_roughness(library, material);
        mesh_source_material(library->source, material);
    }
    material_clear(material);
    library->begun = false;
}

static void read_lines(const char *bytes, size_t length, const char *folder, MeshSource *source)
{
    Library library = {.source = source, .folder = folder};
    library.by_blender = length > 9 && memcmp(bytes, "# Blender", 9) == 0;
    for (const char *at = bytes, *end = bytes + length; at < end;) {
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        Line line = {at, newline ? newline : end};
        at = newline ? newline + 1 : end;
        while (line.at < line.end && (unsigned char)line.end[-1] <= ' ') line.end--;
        Line word = next_word(&line);
        if (!is_word(word, "newmtl")) {
            if (library.begun) read_line(&library, word, line);
            continue;
        }
        end_material(&library);
        Line name = next_word(&line);
        name.end = line.end;
        library.material = material_new(name.at, name.end > name.at ? (size_t)(name.end - name.at) : 0);
        library.begun = true;
    }
    end_material(&library);
}

void mesh_list_mtl(const char *obj_path, const char *name, MeshSource *source)
{
    Error unused;
    char *folder = file_folder(obj_path), *beside = file_folder(name), *bytes = NULL;
    Buf path = {0};
    size_t length = 0;
    buf_format(&path, "%s%s", folder ? folder : "", name);
    bool there =
        folder && !path.failed && file_kind(buf_text(&path)) == FILE_REGULAR && file_lies_in(buf_text(&path), folder);
    if (there && file_read(buf_text(&path), largest_library, &bytes, &length, &unused) == STATUS_OK)
        read_lines(bytes, length, beside ? beside : "", source);
    free(bytes);
    buf_clear(&path);
    free(beside);
    free(folder);
}

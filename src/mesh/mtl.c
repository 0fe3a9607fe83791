/* mtl.c - reads what a library of materials says, Wavefront's .mtl beside an .obj: colour, picture, index, opacity, and what
 * later exporters add for metals.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/attr.h"
#include "base/buf.h"
#include "base/file.h"
#include "base/num.h"
#include "base/utf8.h"
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
    double strength; /* of its bumps */
    bool begun;
    bool by_blender; /* which counts shininess up to 1000 */
} Library;

/* ---- pictures ---- */

/* What may stand before a picture's name, and how many words it has at most; those of numbers may have fewer. */
static const struct PictureOption {
    const char *name;
    int most_words;
    bool numbers;
} picture_options[] = {{"-s", 3, true},       {"-o", 3, true},     {"-t", 3, true},      {"-bm", 1, true},
                       {"-mm", 2, true},      {"-boost", 1, true}, {"-texres", 1, true}, {"-blendu", 1, false},
                       {"-blendv", 1, false}, {"-cc", 1, false},   {"-clamp", 1, false}, {"-imfchan", 1, false},
                       {"-type", 1, false}};

/* Where the option's numbers go, if anywhere. They move v upward, and those of a MeshPicture downward: see read_picture_line. */
static double *numbers_for(const char *option, MeshPicture *picture, double *strength)
{
    if (strcmp(option, "-s") == 0) return picture->scale;
    if (strcmp(option, "-o") == 0) return picture->offset;
    return strcmp(option, "-bm") == 0 ? strength : NULL;
}

/* Goes past an option at the begin of the line; false: there is none that is known. */
static bool take_option(Line *rest, MeshPicture *picture, double *strength)
{
    Line behind = *rest, word = next_word(&behind);
    const struct PictureOption *option = NULL;
    for (size_t i = 0; i < COUNT_OF(picture_options) && !option; i++)
        if (is_word(word, picture_options[i].name)) option = &picture_options[i];
    if (!option) return false;
    *rest = behind;
    double *numbers = numbers_for(option->name, picture, strength);
    for (int i = 0; i < option->most_words; i++) {
        double number;
        word = next_word(&behind);
        size_t length = (size_t)(word.end - word.at);
        bool is_number = length && num_parse(word.at, length, &number) == length && isfinite(number);
        if (option->numbers && !is_number) break;
        if (option->numbers && numbers && i < (numbers == strength ? 1 : 2)) numbers[i] = number;
        if (strcmp(option->name, "-clamp") == 0 && is_word(word, "on")) picture->wrap = PICTURE_WRAP_CLAMP;
        *rest = behind;
    }
    return true;
}

/* A picture behind its options: "-s 2 2 1 -bm 1 old wax.png". Behind one that is not known, the last word is the name. */
static void read_picture_line(Line rest, const char *folder, MeshPicture *picture, double *strength)
{
    while (take_option(&rest, picture, strength)) continue;
    Line word = next_word(&rest), last = word;
    if (word.at < word.end && *word.at == '-')
        for (; word.at < word.end; word = next_word(&rest)) last = word;
    else
        last.end = rest.end;
    if (last.at >= last.end) return;
    Buf path = {0};
    bool absolute = *last.at == '/' || *last.at == '\\' || (last.end - last.at > 1 && last.at[1] == ':');
    buf_format(&path, "%s%.*s", absolute ? "" : folder, (int)(last.end - last.at), last.at);
    for (char *c = path.text; c && *c; c++)
        if (*c == '\\') *c = '/'; /* as Windows has it */
    picture->file = path.text;
    picture->offset[1] = 1 - picture->scale[1] - picture->offset[1];
}

/* ---- lines ---- */

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
            read_picture_line(rest, library->folder, &material->pictures[row->key], &library->strength);
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

/* What Blender writes as bumps are normals: it exports the picture of its node Normal Map. */
static void find_normals(const Library *library, MeshMaterial *material)
{
    MeshPicture *bumps = &material->pictures[PICTURE_BUMP], *normals = &material->pictures[PICTURE_NORMAL];
    if (library->by_blender && bumps->file && !normals->file) {
        *normals = *bumps;
        bumps->file = NULL;
    }
    material->facts[FACT_NORMAL_STRENGTH][0] = library->strength;
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
        find_normals(library, material);
        mesh_source_material(library->source, material);
    }
    material_clear(material);
    library->begun = false;
}

static void read_lines(const char *bytes, size_t length, const char *folder, MeshSource *source)
{
    Library library = {.source = source, .folder = folder};
    const char *end = bytes + length, *at = bytes + utf8_mark_length(bytes, length);
    library.by_blender = end - at > 9 && memcmp(at, "# Blender", 9) == 0;
    while (at < end) {
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
        library.strength = 1;
        library.begun = true;
    }
    end_material(&library);
}

bool mesh_list_mtl(const char *obj_path, const char *name, MeshSource *source)
{
    Error unused;
    char *folder = file_folder(obj_path), *beside = file_folder(name), *bytes = NULL;
    Buf path = {0};
    size_t length = 0;
    buf_format(&path, "%s%s", folder ? folder : "", name);
    bool there =
        folder && !path.failed && file_kind(buf_text(&path)) == FILE_REGULAR && file_lies_in(buf_text(&path), folder);
    there = there && file_read(buf_text(&path), largest_library, &bytes, &length, &unused) == STATUS_OK;
    if (there) {
        file_end_lines(bytes, length);
        read_lines(bytes, length, beside ? beside : "", source);
    }
    free(bytes);
    buf_clear(&path);
    free(beside);
    free(folder);
    return there;
}

/* mtl.c - reads what a library of materials says, Wavefront's .mtl beside an .obj: colour, picture, index, opacity, and what
 * later exporters add for metals. Only to be told: a scene gives its own surfaces and media.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/num.h"
#include "mesh/mesh_file.h"

static const size_t largest_library = (size_t)1 << 24;

/* What a statement says, as how many numbers, or the name of a file. */
enum { A_FILE = 0 };
static const struct {
    const char *statement, *what;
    int n;
} rows[] = {
    {"Kd", "base colour", 3},  {"map_Kd", "picture", A_FILE}, {"Ni", "index", 1},    {"d", "opacity", 1},
    {"Tr", "transparency", 1}, {"Tf", "filter", 3},           {"Ke", "emission", 3}, {"Pm", "metal", 1},
    {"Pr", "roughness", 1},
};

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

/* Adds what a line says, in words; what is not understood adds nothing. */
static void add_line(Buf *said, Line word, Line rest)
{
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (!is_word(word, rows[i].statement)) continue;
        Buf value = {0};
        Line next = next_word(&rest);
        double number;
        for (int k = 0; k < rows[i].n && next.at < next.end; k++, next = next_word(&rest)) {
            if (num_parse(next.at, (size_t)(next.end - next.at), &number) == 0) break;
            buf_format(&value, " %.3g", number);
        }
        if (rows[i].n == A_FILE && next.at < next.end) { /* behind options, if any */
            Line last = next;
            if (*next.at == '-')
                for (; next.at < next.end; next = next_word(&rest)) last = next;
            else
                last.end = rest.end;
            buf_format(&value, " %.*s", (int)(last.end - last.at), last.at);
        }
        if (value.length) buf_format(said, "%s%s%s", said->length ? ", " : "", rows[i].what, buf_text(&value));
        buf_clear(&value);
        return;
    }
}

static void end_material(MeshSource *source, Line name, Buf *said)
{
    if (name.at && said->length)
        mesh_source_material(source, name.at, (size_t)(name.end - name.at), strdup(buf_text(said)));
    buf_clear(said);
}

static void read_lines(const char *bytes, size_t length, MeshSource *source)
{
    Buf said = {0};
    Line name = {NULL, NULL};
    for (const char *at = bytes, *end = bytes + length; at < end;) {
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        Line line = {at, newline ? newline : end};
        at = newline ? newline + 1 : end;
        while (line.at < line.end && (unsigned char)line.end[-1] <= ' ') line.end--;
        Line word = next_word(&line);
        if (!is_word(word, "newmtl")) {
            add_line(&said, word, line);
            continue;
        }
        end_material(source, name, &said);
        name = next_word(&line);
        name.end = line.end;
    }
    end_material(source, name, &said);
}

void mesh_list_mtl(const char *obj_path, const char *name, MeshSource *source)
{
    Error unused;
    char *folder = file_folder(obj_path), *bytes = NULL;
    Buf path = {0};
    size_t length = 0;
    buf_format(&path, "%s%s", folder ? folder : "", name);
    bool there =
        folder && !path.failed && file_kind(buf_text(&path)) == FILE_REGULAR && file_lies_in(buf_text(&path), folder);
    if (there && file_read(buf_text(&path), largest_library, &bytes, &length, &unused) == STATUS_OK)
        read_lines(bytes, length, source);
    free(bytes);
    buf_clear(&path);
    free(folder);
}

/* library_doc.c - reads the comments of the standard library: the one at the head of a text, headings, and the one
 * above each medium, def and let. Names that begin with '_' are the text's own.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/library_doc.h"

#include <string.h>

#include "cli/commands.h"
#include "cli/mdoc.h"
#include "scene/library.h"

enum { DOC_INDENT = 6 };

const EvalLibraryFile *library_named(const char *topic)
{
    for (size_t i = 0; i < std_library.n_files; i++) {
        const EvalLibraryFile *file = &std_library.files[i];
        size_t length = strlen(file->name), stem = length - strlen(".mns");
        if (strcmp(topic, file->name) == 0 || (strlen(topic) == stem && strncmp(topic, file->name, stem) == 0))
            return file;
    }
    return NULL;
}

/* ---- reading ---- */

typedef enum DocKind { DOC_HEAD, DOC_HEADING, DOC_ENTRY } DocKind;

/* Takes one thing after the other, in order of the text. signature: of an entry; text: without marks of comments. */
typedef void DocPrinter(DocKind kind, const char *signature, const char *text, Buf *out);

static size_t line_length(const char *line)
{
    return strcspn(line, "\n");
}

/* The text of a comment goes on; an empty line of it begins a paragraph. */
static void add_comment(Buf *doc, const char *text, size_t length)
{
    while (length > 0 && *text == ' ') text++, length--;
    if (length == 0) {
        buf_add(doc, "\n");
        return;
    }
    if (doc->length > 0 && doc->text[doc->length - 1] != '\n') buf_add(doc, " ");
    buf_add_bytes(doc, text, length);
}

/* The name behind a word, and the arguments of a def, on one line; empty for names of the text's own. */
static void read_signature(const char *at, Buf *out)
{
    if (*at == '_') return;
    size_t n = strcspn(at, " (\n");
    int depth = 0;
    if (at[n] == '(') {
        do {
            depth += (at[n] == '(') - (at[n] == ')');
            n++;
        } while (depth > 0 && at[n]);
    }
    for (size_t i = 0; i < n; i++) {
        bool blank = at[i] == ' ' || at[i] == '\n';
        bool again = i > 0 && (at[i - 1] == ' ' || at[i - 1] == '\n');
        if (!blank)
            buf_add_bytes(out, at + i, 1);
        else if (!again)
            buf_add(out, " ");
    }
}

/* Whether a signature, as tumbler(radius = 38mm), is of that name. */
static bool is_of_name(const char *signature, const char *name)
{
    size_t length = strcspn(signature, "(");
    return strlen(name) == length && strncmp(signature, name, length) == 0;
}

/* wanted: the name of the only one that is printed; NULL: any. */
static void read_declaration(const char *line, const Buf *doc, const char *wanted, DocPrinter *print, Buf *out)
{
    static const char *const words[] = {"medium ", "def ", "let "};
    for (size_t i = 0; i < COUNT_OF(words); i++) {
        if (strncmp(line, words[i], strlen(words[i])) != 0) continue;
        Buf signature = {0};
        read_signature(line + strlen(words[i]), &signature);
        if (signature.length > 0 && (!wanted || is_of_name(buf_text(&signature), wanted)))
            print(DOC_ENTRY, buf_text(&signature), doc->length > 0 ? doc->text : "", out);
        buf_clear(&signature);
    }
}

/* wanted: the name of the only entry that is printed, and nothing beside it; NULL: all. */
static void read_library(const EvalLibraryFile *file, const char *wanted, DocPrinter *print, Buf *out)
{
    static const char heading[] = "// ---- ";
    Buf doc = {0};
    bool head = false;
    for (const char *line = file->text; *line; line += line_length(line) + (line[line_length(line)] == '\n')) {
        size_t length = line_length(line);
        if (strncmp(line, heading, sizeof heading - 1) == 0) {
            buf_clear(&doc);
            buf_add_bytes(&doc, line + sizeof heading - 1, length - (sizeof heading - 1) - strlen(" ----"));
            if (!wanted) print(DOC_HEADING, NULL, buf_text(&doc), out);
            buf_clear(&doc);
        } else if (strncmp(line, "//", 2) == 0) {
            add_comment(&doc, line + 2, length - 2);
        } else {
            if (length > 0) read_declaration(line, &doc, wanted, print, out);
            if (length == 0 && doc.length > 0 && !head && !wanted) {
                print(DOC_HEAD, file->name, doc.text, out);
                head = true;
            }
            buf_clear(&doc);
        }
    }
    buf_clear(&doc);
}

/* ---- printing ---- */

/* Of "glassware.mns - glasses to drink from." the part behind the name, and all behind it. */
static const char *behind_name(const char *text)
{
    const char *dash = strstr(text, " - ");
    return dash ? dash + 3 : text;
}

static void print_use(const char *name, Buf *out)
{
    const char *stem = strchr(name, '/') + 1;
    buf_format(out, "use \"%s\" as %.*s", name, (int)strcspn(stem, "."), stem);
}

static void print_summary(DocKind kind, const char *signature, const char *text, Buf *out)
{
    enum { NAME_COLUMN = 22 };
    if (kind != DOC_HEAD) return;
    Buf summary = {0};
    text = behind_name(text);
    buf_add_bytes(&summary, text, line_length(text));
    buf_format(out, "  %s", signature);
    help_wrap(out, buf_text(&summary), NAME_COLUMN, 2 + strlen(signature));
    buf_clear(&summary);
}

static void print_plain(DocKind kind, const char *signature, const char *text, Buf *out)
{
    if (kind == DOC_HEAD) {
        buf_format(out, "%s - ", signature);
        help_wrap(out, behind_name(text), 0, strlen(signature) + 3);
        buf_add(out, "\n  ");
        print_use(signature, out);
        buf_add(out, "\n");
    } else if (kind == DOC_HEADING) {
        buf_format(out, "\n%s:\n", text);
    } else {
        buf_add(out, "  ");
        help_wrap(out, signature, 2, 2);
        help_wrap(out, text, DOC_INDENT, 0);
    }
}

static void print_mdoc(DocKind kind, const char *signature, const char *text, Buf *out)
{
    if (kind == DOC_HEAD) {
        Buf line = {0};
        buf_format(out, ".Ss %s\n", signature);
        print_use(signature, &line);
        mdoc_example(out, buf_text(&line), line.length);
        mdoc_sentence(out, behind_name(text));
        buf_clear(&line);
    } else if (kind == DOC_HEADING) {
        buf_format(out, ".Pp\n.Sy %s\n", text);
    } else {
        buf_add(out, ".Bl -tag -width Ds\n.It Li ");
        mdoc_escape(out, signature, strlen(signature), true);
        buf_add(out, "\n");
        mdoc_text(out, text);
        buf_add(out, ".El\n");
    }
}

void library_print_overview(Buf *out)
{
    buf_add(out, "The standard library is built into the program; a scene takes what it needs:\n\n"
                 "  use \"std/glassware.mns\" as glassware\n  glassware.tumbler { radius = 40mm }\n\n");
    for (size_t i = 0; i < std_library.n_files; i++) read_library(&std_library.files[i], NULL, print_summary, out);
    buf_add(out, "\n'meniscus help std/glassware' explains one, 'meniscus help std/glassware.mns' prints its text.\n"
                 "Manual: meniscus-std(7)\n");
}

void library_print_file(const EvalLibraryFile *file, Buf *out)
{
    read_library(file, NULL, print_plain, out);
    buf_add(out, "\nManual: meniscus-std(7)\n");
}

/* The name of an entry in a file, as acrylic or media.acrylic; NULL: that of another file. */
static const char *name_within(const EvalLibraryFile *file, const char *topic)
{
    const char *stem = strchr(file->name, '/') + 1, *dot = strchr(topic, '.');
    if (!dot) return topic;
    return strcspn(stem, ".") == (size_t)(dot - topic) && strncmp(stem, topic, (size_t)(dot - topic)) == 0 ? dot + 1
                                                                                                           : NULL;
}

void library_print_named(const char *topic, Buf *out)
{
    Buf found = {0};
    for (size_t i = 0; i < std_library.n_files; i++) {
        const EvalLibraryFile *file = &std_library.files[i];
        const char *name = name_within(file, topic);
        size_t before = found.length;
        if (name) read_library(file, name, print_plain, &found);
        if (found.length == before) continue;
        buf_add(&found, "\n  ");
        print_use(file->name, &found);
        buf_add(&found, "\n\n");
    }
    if (found.length > 0)
        buf_format(out, "%sIn the standard library:\n\n%sManual: meniscus-std(7)\n", out->length ? "\n" : "",
                   buf_text(&found));
    buf_clear(&found);
}

void library_print_manual(Buf *out)
{
    for (size_t i = 0; i < std_library.n_files; i++) read_library(&std_library.files[i], NULL, print_mdoc, out);
}

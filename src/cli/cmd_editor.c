/* cmd_editor.c - the hidden command editor: files for editors and for fuzzing, from the tables of the language.
 * man/refresh.sh keeps what it prints.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/commands.h"
#include "lang/builtin.h"
#include "lang/resolve.h"
#include "scene/build.h"

/* ---- words ---- */

/* Words in order, each once: many properties stand in several nodes. */
enum { MOST_WORDS = 512 };
typedef struct Words {
    const char *items[MOST_WORDS];
    size_t lengths[MOST_WORDS];
    size_t n;
} Words;

static void add_word(Words *words, const char *word, size_t length)
{
    for (size_t i = 0; i < words->n; i++)
        if (words->lengths[i] == length && memcmp(words->items[i], word, length) == 0) return;
    if (words->n == MOST_WORDS || length == 0) return;
    words->items[words->n] = word;
    words->lengths[words->n++] = length;
}

static void add_text(Words *words, const char *word)
{
    add_word(words, word, strlen(word));
}

static bool is_constant(TokenKind kind)
{
    return kind == TOKEN_TRUE || kind == TOKEN_FALSE || kind == TOKEN_NONE;
}

/* Keywords; those that are values, when constants is true. */
static void add_keywords(Words *words, bool constants)
{
    for (TokenKind kind = TOKEN_AND; kind < TOKEN_COUNT; kind++) {
        const char *quoted = token_text(kind); /* 'and' */
        if (is_constant(kind) == constants) add_word(words, quoted + 1, strlen(quoted) - 2);
    }
}

static void add_choices(Words *words, const char *choices)
{
    while (choices && *choices) {
        size_t length = strcspn(choices, "|");
        add_word(words, choices, length);
        choices += length + (choices[length] == '|');
    }
}

typedef struct Vocabulary {
    Words keywords, constants, nodes, properties, choices, functions, units;
} Vocabulary;

static void collect(Vocabulary *all)
{
    const Schema *schema = scene_schema();
    add_keywords(&all->keywords, false);
    add_keywords(&all->constants, true);
    for (size_t i = 0; i < PREDECLARED_COUNT; i++) add_text(&all->constants, predeclared_names[i]);
    for (size_t i = 0; i < schema->n_nodes; i++) {
        const NodeType *node = &schema->nodes[i];
        add_text(&all->nodes, node->name);
        for (size_t k = 0; k < node->n_props; k++) {
            const PropType *prop = &node->props[k];
            add_text(&all->properties, prop->name);
            if (prop->kind == PROP_CHOICE || prop->kind == PROP_STRINGS) add_choices(&all->choices, prop->choices);
        }
    }
    add_text(&all->nodes, "preset");
    for (size_t i = 0; i < builtin_count(); i++) add_text(&all->functions, builtin_at(i)->name);
    for (size_t i = 0; i < schema->n_terms; i++) add_text(&all->functions, schema->terms[i].name);
    for (size_t i = 0; unit_at(i); i++) add_text(&all->units, unit_at(i)->name);
}

static void print_words(const Words *words, const char *between, Buf *out)
{
    for (size_t i = 0; i < words->n; i++) {
        if (i > 0) buf_add(out, between);
        buf_add_bytes(out, words->items[i], words->lengths[i]);
    }
}

/* ---- Vim ---- */

static void vim_keywords(const char *group, const Words *words, Buf *out)
{
    buf_format(out, "syntax keyword %s ", group);
    print_words(words, " ", out);
    buf_add(out, "\n");
}

static void print_vim(const Vocabulary *all, Buf *out)
{
    buf_add(out, "\" meniscus.vim - the scene language of meniscus, for Vim. Made from the tables: make man.\n"
                 "\" Copy it to ~/.vim/syntax/ and have: autocmd BufRead,BufNewFile *.mns setfiletype meniscus\n"
                 "if exists('b:current_syntax')\n  finish\nendif\n"
                 "syntax case match\n"
                 "syntax iskeyword @,48-57,_,192-255\n");
    vim_keywords("meniscusKeyword", &all->keywords, out);
    vim_keywords("meniscusConstant", &all->constants, out);
    /* a keyword would win over a match: sphere is a choice, and a node */
    buf_add(out, "syntax match meniscusChoice /\\<\\%(");
    print_words(&all->choices, "\\|", out);
    buf_add(out, "\\)\\>/\nsyntax match meniscusFunction /\\<\\%(");
    print_words(&all->functions, "\\|", out);
    buf_add(out, "\\)\\ze\\s*(/\nsyntax match meniscusNode /\\<\\%(");
    print_words(&all->nodes, "\\|", out);
    buf_add(out, "\\)\\>\\ze\\%(\\s\\+\\k\\+\\)\\=\\s*{/\nsyntax match meniscusProperty /\\<\\%(");
    print_words(&all->properties, "\\|", out);
    buf_add(out, "\\)\\>\\ze\\s*=[^=]/\n"
                 "syntax match meniscusHeader /\\%^\\_s*meniscus\\s\\+[0-9.]\\+\\%(\\s\\+unit\\s\\+\\k\\+\\)\\=/\n"
                 "syntax match meniscusNumber "
                 "/\\%(\\<\\d\\+\\%(\\.\\.\\@!\\d*\\)\\=\\|\\.\\@1<!\\.\\d\\+\\)\\%([eE][-+]\\=\\d\\+\\)\\=\\%(");
    print_words(&all->units, "\\|", out);
    buf_add(out, "\\)\\=\\k\\@!/\n"
                 "syntax match meniscusColor /#\\x\\{6}\\|#\\x\\{3}/\n"
                 "syntax match meniscusEscape /\\\\\\%([\"\\\\nt]\\|u{\\x\\+}\\)/ contained\n"
                 "syntax region meniscusString start=/\"/ skip=/\\\\./ end=/\"/ oneline contains=meniscusEscape\n"
                 "syntax match meniscusComment ;//.*$;\n"
                 "syntax region meniscusComment start=;/\\*; end=;\\*/; contains=meniscusComment\n");
    static const char *const links[][2] = {
        {"Header", "PreProc"},    {"Keyword", "Statement"},  {"Constant", "Constant"},   {"Choice", "Constant"},
        {"Function", "Function"}, {"Node", "Type"},          {"Property", "Identifier"}, {"Number", "Number"},
        {"Color", "Number"},      {"Escape", "SpecialChar"}, {"String", "String"},       {"Comment", "Comment"},
    };
    for (size_t i = 0; i < COUNT_OF(links); i++)
        buf_format(out, "highlight default link meniscus%s %s\n", links[i][0], links[i][1]);
    buf_add(out, "let b:current_syntax = 'meniscus'\n");
}

/* ---- TextMate ---- */

static void textmate_match(JsonWriter *json, const char *name, const char *match)
{
    json_begin_object(json);
    json_add_text(json, "name", name);
    json_add_text(json, "match", match);
    json_end(json);
}

static void textmate_words(JsonWriter *json, const char *name, const Words *words, const char *behind)
{
    Buf match = {0};
    buf_add(&match, "\\b(?:");
    print_words(words, "|", &match);
    buf_format(&match, ")\\b%s", behind);
    textmate_match(json, name, buf_text(&match));
    buf_clear(&match);
}

static void textmate_strings(JsonWriter *json)
{
    json_begin_object(json);
    json_add_text(json, "name", "string.quoted.double.meniscus");
    json_add_text(json, "begin", "\"");
    json_add_text(json, "end", "\"|$");
    json_key(json, "patterns");
    json_begin_array(json);
    textmate_match(json, "constant.character.escape.meniscus", "\\\\(?:[\"\\\\nt]|u\\{[0-9A-Fa-f]+\\})");
    json_end(json);
    json_end(json);
}

static void textmate_block_comment(JsonWriter *json)
{
    json_begin_object(json);
    json_add_text(json, "name", "comment.block.meniscus");
    json_add_text(json, "begin", "/\\*");
    json_add_text(json, "end", "\\*/");
    json_key(json, "patterns");
    json_begin_array(json);
    json_begin_object(json);
    json_add_text(json, "include", "#comment");
    json_end(json);
    json_end(json);
    json_end(json);
}

static void textmate_patterns(JsonWriter *json, const Vocabulary *all)
{
    Buf number = {0};
    buf_add(&number, "(?:\\b[0-9]+(?:\\.(?!\\.)[0-9]*)?|(?<!\\.)\\.[0-9]+)(?:[eE][-+]?[0-9]+)?(?:");
    print_words(&all->units, "|", &number);
    buf_add(&number, ")?(?![A-Za-z0-9_])");
    json_begin_object(json);
    json_add_text(json, "include", "#comment");
    json_end(json);
    textmate_match(json, "comment.line.double-slash.meniscus", "//.*$");
    textmate_strings(json);
    textmate_match(json, "keyword.control.header.meniscus", "^\\s*meniscus\\s+[0-9.]+(?:\\s+unit\\s+\\w+)?");
    textmate_match(json, "constant.other.color.meniscus", "#(?:[0-9A-Fa-f]{6}|[0-9A-Fa-f]{3})\\b");
    textmate_match(json, "constant.numeric.meniscus", buf_text(&number));
    textmate_words(json, "keyword.control.meniscus", &all->keywords, "");
    textmate_words(json, "entity.name.type.meniscus", &all->nodes, "(?=(?:\\s+\\w+)?\\s*\\{)");
    textmate_words(json, "variable.other.property.meniscus", &all->properties, "(?=\\s*=[^=])");
    textmate_words(json, "support.function.meniscus", &all->functions, "(?=\\s*\\()");
    textmate_words(json, "constant.language.meniscus", &all->constants, "");
    textmate_words(json, "support.constant.meniscus", &all->choices, "");
    buf_clear(&number);
}

static void print_textmate(const Vocabulary *all, Buf *out)
{
    JsonWriter json = json_writer(out, true);
    json_begin_object(&json);
    json_add_text(&json, "comment", "Made from the tables: make man");
    json_add_text(&json, "name", "meniscus");
    json_add_text(&json, "scopeName", "source.meniscus");
    json_key(&json, "fileTypes");
    json_begin_array(&json);
    json_text(&json, "mns");
    json_end(&json);
    json_key(&json, "patterns");
    json_begin_array(&json);
    textmate_patterns(&json, all);
    json_end(&json);
    json_key(&json, "repository");
    json_begin_object(&json);
    json_key(&json, "comment");
    textmate_block_comment(&json);
    json_end(&json);
    json_end(&json);
    buf_add(out, "\n");
}

/* ---- fuzzing ---- */

static void dictionary_words(const Words *words, Buf *out)
{
    for (size_t i = 0; i < words->n; i++) {
        buf_add(out, "\"");
        buf_add_bytes(out, words->items[i], words->lengths[i]);
        buf_add(out, "\"\n");
    }
}

static void print_dictionary(const Vocabulary *all, Buf *out)
{
    buf_add(out, "# meniscus.dict - the words of the language, for libFuzzer and AFL. "
                 "Made from the tables: make man.\n");
    for (TokenKind kind = TOKEN_BRACE_OPEN; kind < TOKEN_AND; kind++) {
        const char *quoted = token_text(kind);
        buf_format(out, "\"%.*s\"\n", (int)strlen(quoted) - 2, quoted + 1);
    }
    buf_add(out, "\"meniscus 1.0 unit mm\"\n\"\\\"\"\n\"//\"\n\"/*\"\n\"*/\"\n\"#fff\"\n");
    const Words *lists[] = {&all->keywords, &all->constants, &all->nodes, &all->properties,
                            &all->choices,  &all->functions, &all->units};
    Words once = {.n = 0};
    for (size_t i = 0; i < COUNT_OF(lists); i++)
        for (size_t k = 0; k < lists[i]->n; k++) add_word(&once, lists[i]->items[k], lists[i]->lengths[k]);
    dictionary_words(&once, out);
}

Status cmd_editor(const Options *options, const Talk *talk, Error *error)
{
    (void)talk;
    Vocabulary all = {.keywords = {.n = 0}};
    Buf out = {0};
    const char *kind = options->operands[0];
    collect(&all);
    if (strcmp(kind, "vim") == 0)
        print_vim(&all, &out);
    else if (strcmp(kind, "textmate") == 0)
        print_textmate(&all, &out);
    else if (strcmp(kind, "dictionary") == 0)
        print_dictionary(&all, &out);
    else
        return fail(error, STATUS_USAGE, "'%s' is none of vim, textmate, dictionary", kind);
    Status status = print_out(&out, error);
    buf_clear(&out);
    return status;
}

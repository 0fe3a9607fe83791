/* format.c - lays out a scene text.
 *
 * The text is cut into items: tokens and comments, each with the line breaks and the column it was written with. What
 * stands between two items follows from their kinds, from the brackets that are open, and from where the parser saw
 * statements begin. Meaning is safe because nothing but the blanks between items is ever written anew; at the end the
 * new text is cut up, too, and compared item by item.
 *
 * People align things in columns. Blanks beyond the rule stay where the line above or below has the same kind of token
 * in the same column. That a gap closes can move what stands behind it out of its column, so the text is laid out again
 * until nothing changes.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/format.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/utf8.h"
#include "lang/parse.h"

enum { ITEM_LINE_COMMENT = TOKEN_COUNT, ITEM_BLOCK_COMMENT };
enum { INDENT = 2, MOST_PASSES = 10, TAB = 8 };
enum { LONGEST_ROW = 1000 }; /* items of a line that may be a row of a table: each is sought in the lines around it */

/* Small, as a text may have many millions. */
typedef struct Item {
    uint32_t begin, end;
    uint32_t line;   /* from 0, on which it begins */
    uint32_t column; /* from 0, in columns of a terminal */
    uint32_t gap;    /* columns of blanks before it, within its line */
    uint32_t placed; /* the column that it is written in */
    uint16_t breaks; /* line breaks before it, MOST_BREAKS for more */
    uint8_t kind;    /* TOKEN_..., ITEM_... */
    bool starts;     /* a statement */
} Item;
enum { MOST_BREAKS = 1000 };
_Static_assert(ITEM_BLOCK_COMMENT <= UINT8_MAX, "kinds of items");

typedef struct ItemList {
    Item *items;
    size_t n, capacity;
} ItemList;

/* ---- cutting up ---- */

typedef struct Cutter {
    const char *text;
    uint32_t length;
    uint32_t at, line, column;
    ItemList *list;
} Cutter;

/* One byte, and one column. */
static bool is_plain(char c)
{
    return c >= ' ' && c <= '~';
}

static void move_to(Cutter *cutter, uint32_t end)
{
    while (cutter->at < end) {
        if (is_plain(cutter->text[cutter->at])) {
            cutter->at++;
            cutter->column++;
            continue;
        }
        uint32_t code;
        size_t n = utf8_decode(cutter->text + cutter->at, cutter->length - cutter->at, &code);
        if (code == '\n') {
            cutter->line++;
            cutter->column = 0;
        } else if (code == '\t') {
            cutter->column += TAB - cutter->column % TAB;
        } else {
            cutter->column += utf8_width(code);
        }
        cutter->at += (uint32_t)n;
    }
}

/* begin is behind blanks only, so that the breaks and columns since the last item are the gap. */
static void add_item(Cutter *cutter, int kind, uint32_t begin, uint32_t end)
{
    ItemList *list = cutter->list;
    uint32_t line = cutter->line, column = cutter->column;
    move_to(cutter, begin);
    if (!ARRAY_ROOM(list->items, list->capacity, list->n)) return;
    uint32_t breaks = cutter->line - line;
    list->items[list->n++] = (Item){.begin = begin,
                                    .end = end,
                                    .line = cutter->line,
                                    .column = cutter->column,
                                    .gap = breaks ? 0 : cutter->column - column,
                                    .breaks = (uint16_t)(breaks < MOST_BREAKS ? breaks : MOST_BREAKS),
                                    .kind = (uint8_t)kind};
    move_to(cutter, end);
}

static uint32_t block_comment_end(const char *text, uint32_t at)
{
    for (int depth = 0;;) {
        int step = text[at] == '/' && text[at + 1] == '*' ? 1 : text[at] == '*' && text[at + 1] == '/' ? -1 : 0;
        at += step ? 2 : 1;
        depth += step;
        if (depth == 0) return at;
    }
}

/* The comments between two tokens. */
static void cut_gap(Cutter *cutter, uint32_t at, uint32_t end)
{
    const char *text = cutter->text;
    while (at < end) {
        uint32_t begin = at;
        if (text[at] == '/' && text[at + 1] == '/') {
            const char *newline = memchr(text + at, '\n', end - at);
            at = newline ? (uint32_t)(newline - text) : end;
            uint32_t last = at;
            while (last > begin && (text[last - 1] == ' ' || text[last - 1] == '\t' || text[last - 1] == '\r')) last--;
            add_item(cutter, ITEM_LINE_COMMENT, begin, last);
        } else if (text[at] == '/') {
            at = block_comment_end(text, at);
            add_item(cutter, ITEM_BLOCK_COMMENT, begin, at);
        } else {
            at++;
        }
    }
}

/* The items of a text that has been parsed without a mistake. */
static void cut(const char *text, size_t length, uint32_t source, Diag *diag, SymbolTable *symbols, ItemList *list)
{
    Cutter cutter = {.text = text, .length = (uint32_t)length, .list = list};
    Lexer lexer;
    lexer_init(&lexer, diag, symbols, source);
    list->n = 0;
    uint32_t end = lexer.at; /* behind a byte order mark */
    move_to(&cutter, end);
    cutter.column = 0;
    for (;;) {
        Token token = lexer_next(&lexer);
        cut_gap(&cutter, end, token.kind == TOKEN_END ? cutter.length : token.begin);
        if (token.kind == TOKEN_END) break;
        add_item(&cutter, (int)token.kind, token.begin, token.end);
        end = token.end;
    }
}

static void mark_starts(ItemList *list, const File *file)
{
    size_t next = 0;
    for (size_t i = 0; i < list->n && next < file->n_starts; i++) {
        if (list->items[i].begin != file->starts[next]) continue;
        list->items[i].starts = true;
        next++;
    }
}

/* ---- laying out ---- */

typedef struct Bracket {
    int kind;
    size_t indent; /* of the line that it opens on */
    size_t depth;  /* indentation of what stands within it */
    const Item *opener;
    const Item *first;  /* behind it on its line; NULL when the line ends there */
    unsigned questions; /* '?' that wait for their ':' */
    bool header;        /* of an if, for, while or let: what follows its end begins something */
    bool broken;        /* a line break follows it */
} Bracket;

typedef struct Layout {
    const char *text;
    ItemList *list;
    Buf *out;
    bool keeps_columns;
    Bracket *brackets;
    size_t n_brackets, capacity;
    size_t line_indent;       /* of the present line */
    size_t closed_indent;     /* of the line that the bracket closed last opened on */
    const Item *last;         /* the last one written; NULL at the start */
    const Item *token;        /* the last token written */
    bool value_ends;          /* the last token can end a value: what follows is a binary operator, an index, a call */
    bool sign;                /* the last token is a sign, not an operator between two values */
    size_t column;            /* where the present line ends */
    const size_t *line_items; /* the first item of each line, and one more */
    uint32_t n_lines;
} Layout;

static Bracket *innermost(Layout *layout)
{
    return &layout->brackets[layout->n_brackets - 1];
}

static bool in_block(Layout *layout)
{
    int kind = innermost(layout)->kind;
    return kind == TOKEN_BRACE_OPEN || kind == TOKEN_END;
}

static bool is_comment(const Item *item)
{
    return item->kind >= TOKEN_COUNT;
}

static bool closes(Layout *layout, const Item *item)
{
    switch (item->kind) {
    case TOKEN_BRACE_CLOSE:
    case TOKEN_PAREN_CLOSE:
    case TOKEN_BRACKET_CLOSE: return true;
    case TOKEN_GREATER: return innermost(layout)->kind == TOKEN_LESS; /* elements of vectors hold no bare '>' */
    default: return false;
    }
}

/* '<' stands for a vector where a value begins. */
static bool opens(const Layout *layout, const Item *item)
{
    switch (item->kind) {
    case TOKEN_BRACE_OPEN:
    case TOKEN_PAREN_OPEN:
    case TOKEN_BRACKET_OPEN: return true;
    case TOKEN_LESS: return !layout->value_ends;
    default: return false;
    }
}

static bool ends_value(Layout *layout, const Item *item)
{
    switch (item->kind) {
    case TOKEN_NAME:
    case TOKEN_NUMBER:
    case TOKEN_STRING:
    case TOKEN_COLOR:
    case TOKEN_TRUE:
    case TOKEN_FALSE:
    case TOKEN_NONE:
    case TOKEN_CHILDREN:
    case TOKEN_BRACE_CLOSE:
    case TOKEN_BRACKET_CLOSE: return true;
    case TOKEN_PAREN_CLOSE: return !innermost(layout)->header;
    case TOKEN_GREATER: return closes(layout, item);
    default: return false;
    }
}

static bool is_header(const Layout *layout)
{
    if (!layout->token) return false;
    int kind = layout->token->kind;
    return kind == TOKEN_IF || kind == TOKEN_FOR || kind == TOKEN_WHILE || kind == TOKEN_LET;
}

/* Ranges are written without blanks, but for where the points would run together: 1. .. 2, 0 .. <1, 2> */
static unsigned range_gap(const Layout *layout, const Item *left, const Item *right)
{
    const char *text = layout->text;
    if (right->kind == TOKEN_RANGE || right->kind == TOKEN_RANGE_OPEN) return text[left->end - 1] == '.';
    return text[right->begin] == '.' || text[right->begin] == '<';
}

static bool is_range(const Item *item)
{
    return item->kind == TOKEN_RANGE || item->kind == TOKEN_RANGE_OPEN;
}

/* Blanks between two items of one line; 2 between statements. */
static unsigned rule_gap(Layout *layout, const Item *left, const Item *right)
{
    if (right->kind == ITEM_LINE_COMMENT) return 2;
    bool bracket = left->kind == TOKEN_PAREN_OPEN || left->kind == TOKEN_BRACKET_OPEN ||
                   (left->kind == TOKEN_LESS && innermost(layout)->kind == TOKEN_LESS);
    if (is_comment(left) || is_comment(right)) return bracket ? 0 : 1;
    if (right->starts) return left->kind == TOKEN_BRACE_OPEN ? 1 : 2;
    if (left->kind == TOKEN_NUMBER && right->kind == TOKEN_DOT) return 1; /* or the point would be the number's */
    if (bracket || left->kind == TOKEN_DOT || right->kind == TOKEN_DOT) return 0;
    switch (right->kind) {
    case TOKEN_COMMA:
    case TOKEN_PAREN_CLOSE:
    case TOKEN_BRACKET_CLOSE: return 0;
    case TOKEN_COLON: return innermost(layout)->questions > 0;
    case TOKEN_PAREN_OPEN:
    case TOKEN_BRACKET_OPEN:
        if (layout->value_ends) return 0;
        break;
    case TOKEN_GREATER:
        if (closes(layout, right)) return 0;
        break;
    default: break;
    }
    if (is_range(left) || is_range(right)) return range_gap(layout, left, right);
    return layout->sign ? 0 : 1;
}

static bool same_text(const Layout *layout, const Item *a, const Item *b)
{
    uint32_t length = a->end - a->begin;
    return b->end - b->begin == length && memcmp(layout->text + a->begin, layout->text + b->begin, length) == 0;
}

static bool is_row(const Layout *layout, uint32_t line)
{
    return layout->line_items[line + 1] - layout->line_items[line] <= LONGEST_ROW;
}

/* Does a neighbouring line have a token of this kind (or with exact, the same token) in this column, too? */
static bool stands_in_column(const Layout *layout, const Item *item, bool exact)
{
    for (int step = -1; step <= 1; step += 2) {
        int64_t line = (int64_t)item->line + step;
        if (line < 0 || line >= (int64_t)layout->n_lines || !is_row(layout, (uint32_t)line)) continue;
        for (size_t i = layout->line_items[line]; i < layout->line_items[line + 1]; i++) {
            const Item *other = &layout->list->items[i];
            if (other->column != item->column || other->kind != item->kind || other->gap == 0) continue;
            if (!exact || same_text(layout, other, item)) return true;
        }
    }
    return false;
}

/* Does a statement further on in the line stand in a column? To leave out a cell of a table moves nothing behind it. */
static bool holds_column(const Layout *layout, const Item *item)
{
    if (!item->starts && item->kind != TOKEN_BRACE_CLOSE) return false;
    const Item *end = layout->list->items + layout->list->n;
    for (const Item *later = item; later < end && later->line == item->line; later++)
        if (later->starts && later->gap > 0 && stands_in_column(layout, later, true)) return true;
    return false;
}

static unsigned gap_of(Layout *layout, const Item *item)
{
    unsigned rule = rule_gap(layout, layout->last, item);
    if (!layout->keeps_columns || item->gap <= rule || rule == 0) return rule;
    if (item->kind == ITEM_LINE_COMMENT) /* off to the side: it stays there */
        return item->column > layout->column + rule ? (unsigned)(item->column - layout->column) : rule;
    if (!is_row(layout, item->line)) return rule;
    return stands_in_column(layout, item, false) || holds_column(layout, item) ? item->gap : rule;
}

/* ---- lines ---- */

static const Item *next_token(const Layout *layout, const Item *item)
{
    const Item *end = layout->list->items + layout->list->n;
    while (item < end && is_comment(item)) item++;
    return item < end ? item : NULL;
}

/* What item, the first of its line, stands under in the line above: something within the same bracket. */
static const Item *hangs_from(Layout *layout, const Item *item)
{
    if (item->breaks != 1 || item->line == 0) return NULL;
    const Bracket *bracket = innermost(layout);
    for (size_t i = layout->line_items[item->line - 1]; i < layout->line_items[item->line]; i++) {
        const Item *above = &layout->list->items[i];
        if (above->column == item->column && !above->starts && (!bracket->opener || above > bracket->opener))
            return above;
    }
    return NULL;
}

/* Of a line that begins with item. What stood right under the first thing behind the bracket, or a step further in,
 * still does, and so does a line that goes on with a statement under a thing of the line above. */
static size_t indent_of(Layout *layout, const Item *item)
{
    const Bracket *bracket = innermost(layout);
    if (!is_comment(item) && closes(layout, item)) return bracket->indent;
    for (unsigned more = 0; layout->keeps_columns && bracket->first && more <= INDENT; more += INDENT)
        if (bracket->first->column + more == item->column) return bracket->first->placed + more;
    const Item *token = next_token(layout, item);
    bool fresh = !token || token->starts || token->kind == TOKEN_BRACE_CLOSE || token->kind == TOKEN_ELSE;
    const Item *above = layout->keeps_columns && !(fresh && in_block(layout)) ? hangs_from(layout, item) : NULL;
    if (above) return above->placed;
    if (!in_block(layout)) return bracket->depth;
    return bracket->depth + (fresh || !layout->token ? 0 : INDENT);
}

/* How many line breaks stand before item. */
static unsigned breaks_before(Layout *layout, const Item *item)
{
    if (!layout->last) return 0;
    unsigned breaks = item->breaks > 2 ? 2 : item->breaks;
    bool closing = !is_comment(item) && closes(layout, item);
    if (item->kind == TOKEN_BRACE_CLOSE && innermost(layout)->broken && breaks == 0) breaks = 1;
    bool opened = layout->last == layout->token && layout->n_brackets > 1 && layout->last->kind == TOKEN_BRACE_OPEN;
    if ((closing || opened) && breaks > 1) breaks = 1;
    return breaks;
}

static void write_blanks(Layout *layout, Item *item)
{
    unsigned breaks = breaks_before(layout, item);
    if (!layout->last || breaks > 0) {
        buf_add_repeat(layout->out, '\n', breaks);
        layout->line_indent = indent_of(layout, item);
        buf_add_repeat(layout->out, ' ', layout->line_indent);
        layout->column = layout->line_indent;
    } else {
        unsigned gap = gap_of(layout, item);
        buf_add_repeat(layout->out, ' ', gap);
        layout->column += gap;
    }
    item->placed = (uint32_t)layout->column;
}

static void write_bytes(Layout *layout, const Item *item)
{
    for (uint32_t at = item->begin; at < item->end;) {
        uint32_t plain_end = at;
        while (plain_end < item->end && is_plain(layout->text[plain_end])) plain_end++;
        if (plain_end > at) {
            buf_add_bytes(layout->out, layout->text + at, plain_end - at);
            layout->column += plain_end - at;
            at = plain_end;
            continue;
        }
        uint32_t code;
        uint32_t n = (uint32_t)utf8_decode(layout->text + at, item->end - at, &code);
        if (code != '\r') { /* in a comment, at the end of its line */
            buf_add_bytes(layout->out, layout->text + at, n);
            layout->column = code == '\n'   ? 0
                             : code == '\t' ? layout->column + TAB - layout->column % TAB
                                            : layout->column + utf8_width(code);
        }
        at += n;
    }
}

static void open_bracket(Layout *layout, const Item *item, bool header)
{
    bool last = item + 1 == layout->list->items + layout->list->n, broken = !last && item[1].breaks > 0;
    /* a block behind arguments that took several lines belongs to the line where those began */
    bool behind_args = item->kind == TOKEN_BRACE_OPEN && layout->token && layout->token->kind == TOKEN_PAREN_CLOSE;
    size_t indent = behind_args ? layout->closed_indent : layout->line_indent;
    Bracket bracket = {.kind = item->kind,
                       .indent = indent,
                       .depth = indent + INDENT,
                       .opener = item,
                       .first = last || broken ? NULL : item + 1,
                       .header = header,
                       .broken = broken};
    if (ARRAY_ROOM(layout->brackets, layout->capacity, layout->n_brackets))
        layout->brackets[layout->n_brackets++] = bracket;
}

static void write_token(Layout *layout, const Item *item)
{
    bool closing = closes(layout, item), opening = !closing && opens(layout, item), header = is_header(layout);
    bool value_ends = ends_value(layout, item);
    bool plus_minus = item->kind == TOKEN_PLUS || item->kind == TOKEN_MINUS;
    layout->sign = plus_minus && !layout->value_ends;
    if (item->starts) innermost(layout)->questions = 0;
    write_bytes(layout, item);
    if (item->kind == TOKEN_QUESTION) innermost(layout)->questions++;
    if (item->kind == TOKEN_COLON && innermost(layout)->questions > 0) innermost(layout)->questions--;
    if (closing && layout->n_brackets > 1) layout->closed_indent = layout->brackets[--layout->n_brackets].indent;
    if (opening) open_bracket(layout, item, header && item->kind == TOKEN_PAREN_OPEN);
    layout->value_ends = value_ends;
    layout->token = item;
}

/* A run of line numbers without items has empty stretches. */
static size_t *index_lines(const ItemList *list, uint32_t *n_lines)
{
    *n_lines = list->n ? list->items[list->n - 1].line + 1 : 0;
    size_t *first = calloc((size_t)*n_lines + 1, sizeof *first);
    if (!first) return NULL;
    size_t item = 0;
    for (uint32_t line = 0; line <= *n_lines; line++) {
        while (item < list->n && list->items[item].line < line) item++;
        first[line] = item;
    }
    return first;
}

static void lay_out(const char *text, ItemList *list, bool keeps_columns, Buf *out)
{
    Layout layout = {.text = text, .list = list, .out = out, .keeps_columns = keeps_columns};
    size_t *line_items = index_lines(list, &layout.n_lines);
    Bracket top = {.kind = TOKEN_END};
    if (!line_items || !ARRAY_ROOM(layout.brackets, layout.capacity, 0)) {
        out->failed = true;
    } else {
        layout.line_items = line_items;
        layout.brackets[layout.n_brackets++] = top;
        for (size_t i = 0; i < list->n; i++) {
            Item *item = &list->items[i];
            write_blanks(&layout, item);
            if (is_comment(item))
                write_bytes(&layout, item);
            else
                write_token(&layout, item);
            layout.last = item;
        }
        if (list->n) buf_add(out, "\n");
    }
    free(line_items);
    free(layout.brackets);
}

/* ---- all ---- */

/* One text on its way: parsed, and cut into items. */
typedef struct Stage {
    const char *name;
    Diag *diag;
    SymbolTable *symbols;
    ItemList list;
} Stage;

static bool read_items(Stage *stage, const char *text, size_t length)
{
    Diag *diag = stage->diag;
    Arena tree; /* only where statements begin is of interest */
    arena_init(&tree);
    tree.escape = diag->arena->escape;
    File file = {
        .source = source_add(diag->sources, stage->name, NULL, text, length), .arena = &tree, .only_starts = true};
    uint32_t n_errors = diag->n_errors;
    parse_file(&file, true, 0, diag, stage->symbols);
    arena_clear(&tree);
    bool fine = diag->n_errors == n_errors;
    if (fine) {
        cut(text, length, file.source, diag, stage->symbols, &stage->list);
        mark_starts(&stage->list, &file);
    }
    free(file.starts);
    return fine;
}

/* A semicolon may have carried line breaks. */
static void drop_semicolons(ItemList *list)
{
    size_t n = 0;
    uint32_t breaks = 0;
    while (n < list->n && list->items[n].kind != TOKEN_SEMICOLON) n++; /* mostly there are none */
    for (size_t i = n; i < list->n; i++) {
        Item item = list->items[i];
        breaks += item.breaks;
        if (item.kind == TOKEN_SEMICOLON) continue;
        item.breaks = (uint16_t)(breaks < MOST_BREAKS ? breaks : MOST_BREAKS);
        breaks = 0;
        list->items[n++] = item;
    }
    list->n = n;
}

static bool same_bytes(const char *a, const Item *x, const char *b, const Item *y)
{
    uint32_t i = x->begin, k = y->begin;
    for (;;) {
        while (i < x->end && a[i] == '\r') i++;
        while (k < y->end && b[k] == '\r') k++;
        if (i == x->end || k == y->end) return i == x->end && k == y->end;
        if (a[i++] != b[k++]) return false;
    }
}

static bool same_items(const char *a, const ItemList *x, const char *b, const ItemList *y)
{
    if (x->n != y->n) return false;
    for (size_t i = 0; i < x->n; i++)
        if (x->items[i].kind != y->items[i].kind || !same_bytes(a, &x->items[i], b, &y->items[i])) return false;
    return true;
}

/* Lays out until nothing changes; *text, *length: the last text, the arena's. */
static Status settle(Stage *stage, const char **text, size_t *length, Error *error)
{
    for (int pass = 0; pass <= MOST_PASSES; pass++) {
        Buf next = {0};
        drop_semicolons(&stage->list);
        lay_out(*text, &stage->list, pass < MOST_PASSES, &next);
        bool same = next.length == *length && memcmp(buf_text(&next), *text, *length) == 0;
        bool failed = next.failed;
        size_t next_length = next.length;
        const char *copy = same || failed ? *text : arena_copy_text(stage->diag->arena, buf_text(&next), next.length);
        buf_clear(&next);
        if (failed) return fail(error, STATUS_NOMEM, "out of memory");
        if (same) return STATUS_OK;
        *text = copy;
        *length = next_length;
        if (!read_items(stage, *text, *length)) break;
    }
    return STATUS_OK;
}

/* Whether the last items are those of the first text, which is `source`. */
static bool means_the_same(const Stage *stage, const char *text, size_t length, uint32_t source, const char *laid_out)
{
    ItemList first = {0};
    cut(text, length, source, stage->diag, stage->symbols, &first);
    drop_semicolons(&first);
    bool same = same_items(text, &first, laid_out, &stage->list);
    free(first.items);
    return same;
}

Status format_text(const char *name, const char *text, size_t length, Diag *diag, Buf *out, Error *error)
{
    SymbolTable symbols;
    symbol_table_init(&symbols, diag->arena);
    Stage stage = {.name = name, .diag = diag, .symbols = &symbols};
    const char *laid_out = text;
    size_t laid_out_length = length;
    uint32_t source = diag->sources->n;
    Status status = STATUS_OK;
    if (!read_items(&stage, text, length)) status = fail(error, STATUS_SCENE, "the scene has errors");
    if (status == STATUS_OK) status = settle(&stage, &laid_out, &laid_out_length, error);
    if (status == STATUS_OK && laid_out != text && !means_the_same(&stage, text, length, source, laid_out))
        status = fail(error, STATUS_RENDER, "'%s' would not mean the same when laid out; this is a mistake of meniscus",
                      name);
    if (status == STATUS_OK) buf_add_bytes(out, laid_out, laid_out_length);
    free(stage.list.items);
    return status;
}

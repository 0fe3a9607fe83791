/* diag_print.c - reports as text: the message, the source line, a caret under the place, hints and notes.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/utf8.h"
#include "diag/diag.h"

enum {
    TAB_WIDTH = 8,
    LINE_WIDTH = 100,  /* columns of source text shown at most */
    LEFT_CONTEXT = 30, /* of them, in front of the caret, when the line is cut there */
    CHAIN_SHOWN = 8,
    FRAMES_SHOWN = 8,
    REPLACEMENT = 0xfffd
};

#define CUT_MARK "..."

typedef struct Style {
    const char *bold, *error, *warning, *note, *caret, *gutter, *plain;
} Style;

static const Style without_color = {"", "", "", "", "", "", ""};
static const Style with_color = {"\033[1m",    "\033[1;31m", "\033[1;35m", "\033[1;36m",
                                 "\033[1;32m", "\033[34m",   "\033[0m"};

/* One source line as columns, so that carets stand under what they mean. */
typedef struct LineView {
    const char *text;
    size_t length;
    unsigned first_column, last_column; /* shown, of the expanded line */
    bool cut_left, cut_right;
} LineView;

static size_t next_character(const LineView *view, size_t at, unsigned column, uint32_t *code, unsigned *width)
{
    size_t n = utf8_decode(view->text + at, view->length - at, code);
    if (*code == '\t') {
        *width = TAB_WIDTH - column % TAB_WIDTH;
    } else {
        if (*code == UTF8_INVALID || *code < 0x20 || (*code >= 0x7f && *code < 0xa0)) *code = REPLACEMENT;
        *width = utf8_width(*code);
    }
    return n;
}

static unsigned column_of(const LineView *view, size_t byte)
{
    unsigned column = 0, width;
    uint32_t code;
    for (size_t at = 0; at < byte && at < view->length;) {
        at += next_character(view, at, column, &code, &width);
        column += width;
    }
    return column;
}

/* chooses the columns to show of a line that may be too long, around begin .. end */
static void cut_line(LineView *view, unsigned begin, unsigned end, unsigned total)
{
    view->first_column = 0;
    view->last_column = total;
    if (total <= LINE_WIDTH) return;
    if (end > LINE_WIDTH) view->first_column = begin > LEFT_CONTEXT ? begin - LEFT_CONTEXT : 0;
    if (total - view->first_column > LINE_WIDTH) view->last_column = view->first_column + LINE_WIDTH;
    view->cut_left = view->first_column > 0;
    view->cut_right = view->last_column < total;
}

static void add_line_text(Buf *out, const LineView *view)
{
    unsigned column = 0, width;
    uint32_t code;
    if (view->cut_left) buf_add(out, CUT_MARK);
    for (size_t at = 0; at < view->length && column < view->last_column; column += width) {
        at += next_character(view, at, column, &code, &width);
        if (column + width <= view->first_column && view->first_column > 0) continue;
        if (code == '\t' || column < view->first_column) { /* a wide character cut in half becomes blanks, too */
            unsigned from = column > view->first_column ? column : view->first_column;
            buf_add_repeat(out, ' ', column + width - from);
        } else {
            char bytes[4];
            buf_add_bytes(out, bytes, utf8_encode(code, bytes));
        }
    }
    if (view->cut_right) buf_add(out, CUT_MARK);
}

static void add_quote(Diag *diag, Buf *out, Span span, const Style *style, const char *mark_color)
{
    const Source *source = &diag->sources->sources[span.source];
    SourceLine line = source_line(diag->sources, span.source, span.begin);
    LineView view = {.text = source->text + line.begin, .length = line.end - line.begin};
    size_t begin_byte = span.begin - line.begin, end_byte = span.end > span.begin ? span.end - line.begin : begin_byte;
    unsigned total = column_of(&view, view.length);
    unsigned begin = column_of(&view, begin_byte), end = column_of(&view, end_byte);
    if (end <= begin) end = begin + 1;
    cut_line(&view, begin, end, total);
    if (view.cut_right && end > view.last_column) end = view.last_column;

    buf_format(out, "%s%5u |%s", style->gutter, line.number, style->plain);
    if (view.length) buf_add(out, " ");
    add_line_text(out, &view);
    buf_format(out, "\n%s      |%s ", style->gutter, style->plain);
    if (view.cut_left) buf_add_repeat(out, ' ', sizeof CUT_MARK - 1);
    buf_add_repeat(out, ' ', begin - view.first_column);
    buf_format(out, "%s^", mark_color);
    if (end > begin + 1) buf_add_repeat(out, '~', end - begin - 1);
    buf_format(out, "%s\n", style->plain);
}

static void add_place(Diag *diag, Buf *out, Span span)
{
    SourcePosition position = source_position(diag->sources, span.source, span.begin);
    buf_format(out, "%s:%u:%u", diag->sources->sources[span.source].name, position.line, position.column);
}

static void add_chain(Diag *diag, Buf *out, const DiagChain *chain, const Style *style)
{
    int shown = 0, hidden = 0;
    for (const DiagChain *link = chain; link; link = link->outer) {
        if (shown == CHAIN_SHOWN && link->outer) {
            hidden++;
            continue;
        }
        if (hidden) buf_format(out, "%s      =%s and %d more, up to\n", style->gutter, style->plain, hidden);
        hidden = 0;
        shown += shown < CHAIN_SHOWN;
        buf_format(out, "%s      =%s %s ", style->gutter, style->plain, link->what);
        add_place(diag, out, link->span);
        buf_add(out, "\n");
    }
}

/* "in frame 37", "in frames 1 to 9, 12, 20 to 40 by 2" */
static void add_frames(Buf *out, const DiagFrames *frames, const Style *style)
{
    if (!frames) return;
    bool one = !frames->next && frames->step == 0;
    buf_format(out, "%s      =%s in frame%s ", style->gutter, style->plain, one ? "" : "s");
    int shown = 0;
    for (; frames && shown < FRAMES_SHOWN; frames = frames->next, shown++) {
        bool two = frames->step && frames->last - frames->first == frames->step;
        buf_format(out, "%s%u", shown ? ", " : "", frames->first);
        if (frames->step) buf_format(out, "%s%u", two ? ", " : " to ", frames->last);
        if (frames->step > 1 && !two) buf_format(out, " by %u", frames->step);
    }
    buf_add(out, frames ? " and others\n" : "\n");
}

static void add_report(Diag *diag, Buf *out, const Diagnostic *report, const Style *style)
{
    const char *const colors[] = {style->error, style->warning, style->note};
    buf_add(out, style->bold);
    if (report->has_span)
        add_place(diag, out, report->span);
    else
        buf_add(out, "meniscus");
    buf_format(out, ": %s%s:%s%s %s%s [%s]\n", colors[report->severity], diag_severity_text(report->severity),
               style->plain, style->bold, report->text, style->plain, diag_slug(report->code));
    if (report->has_span) add_quote(diag, out, report->span, style, style->caret);
    if (report->hint) buf_format(out, "%s      =%s hint: %s\n", style->gutter, style->plain, report->hint);
    for (const DiagNote *note = report->notes; note; note = note->next) {
        bool same_place = note->has_span && report->has_span &&
                          span_same_place(note->span, report->span); /* the line stands there already */
        if (!note->has_span || same_place) {
            buf_format(out, "%s      =%s note: %s\n", style->gutter, style->plain, note->text);
            continue;
        }
        buf_add(out, style->bold);
        add_place(diag, out, note->span);
        buf_format(out, ": %snote:%s %s\n", style->note, style->plain, note->text);
        add_quote(diag, out, note->span, style, style->note);
    }
    add_chain(diag, out, report->chain, style);
    add_frames(out, report->frames, style);
}

void diag_print(Diag *diag, Buf *out, bool color)
{
    diag_sort(diag);
    for (const Diagnostic *report = diag->first; report; report = report->next)
        add_report(diag, out, report, color ? &with_color : &without_color);
    if (diag->n_errors > diag->limit)
        buf_format(out, "... and %u more errors, which are not shown\n", diag->n_errors - diag->limit);
    if (diag->n_warnings > diag->limit)
        buf_format(out, "... and %u more warnings, which are not shown\n", diag->n_warnings - diag->limit);
    if (diag->n_remarks > diag->limit)
        buf_format(out, "... and %u more remarks, which are not shown\n", diag->n_remarks - diag->limit);
}

/* ---- JSON ---- */

static void add_json_text(Buf *out, const char *text)
{
    size_t length = strlen(text);
    buf_add(out, "\"");
    for (size_t at = 0; at < length;) {
        uint32_t code;
        size_t n = utf8_decode(text + at, length - at, &code);
        if (code == '"' || code == '\\')
            buf_format(out, "\\%c", (char)code);
        else if (code < 0x20)
            buf_format(out, "\\u%04x", (unsigned)code);
        else if (code == UTF8_INVALID)
            buf_add(out, "\\ufffd");
        else
            buf_add_bytes(out, text + at, n);
        at += n;
    }
    buf_add(out, "\"");
}

static void add_json_place(Diag *diag, Buf *out, Span span)
{
    SourcePosition begin = source_position(diag->sources, span.source, span.begin);
    SourcePosition end = source_position(diag->sources, span.source, span.end);
    buf_add(out, "\"file\": ");
    add_json_text(out, diag->sources->sources[span.source].name);
    buf_format(out, ", \"line\": %u, \"column\": %u, \"end_line\": %u, \"end_column\": %u, \"begin\": %u, \"end\": %u",
               begin.line, begin.column, end.line, end.column, span.begin, span.end);
}

static void add_json_report(Diag *diag, Buf *out, const Diagnostic *report)
{
    buf_format(out, "{\"severity\": \"%s\", \"code\": \"%s\", ", diag_severity_text(report->severity),
               diag_slug(report->code));
    if (report->has_span) {
        add_json_place(diag, out, report->span);
        buf_add(out, ", ");
    }
    buf_add(out, "\"message\": ");
    add_json_text(out, report->text);
    if (report->hint) {
        buf_add(out, ", \"hint\": ");
        add_json_text(out, report->hint);
    }
    if (report->notes) {
        buf_add(out, ", \"notes\": [");
        for (const DiagNote *note = report->notes; note; note = note->next) {
            buf_add(out, "{");
            if (note->has_span) {
                add_json_place(diag, out, note->span);
                buf_add(out, ", ");
            }
            buf_add(out, "\"message\": ");
            add_json_text(out, note->text);
            buf_add(out, note->next ? "}, " : "}");
        }
        buf_add(out, "]");
    }
    if (report->chain) {
        buf_add(out, ", \"chain\": [");
        for (const DiagChain *link = report->chain; link; link = link->outer) {
            buf_add(out, "{");
            add_json_place(diag, out, link->span);
            buf_add(out, ", \"message\": ");
            add_json_text(out, link->what);
            buf_add(out, link->outer ? "}, " : "}");
        }
        buf_add(out, "]");
    }
    if (report->frames) {
        buf_add(out, ", \"frames\": [");
        for (const DiagFrames *frames = report->frames; frames; frames = frames->next)
            buf_format(out, "{\"first\": %u, \"last\": %u, \"step\": %u}%s", frames->first, frames->last,
                       frames->step ? frames->step : 1, frames->next ? ", " : "");
        buf_add(out, "]");
    }
    buf_add(out, "}");
}

void diag_print_json(Diag *diag, Buf *out)
{
    diag_sort(diag);
    buf_add(out, "[");
    for (const Diagnostic *report = diag->first; report; report = report->next) {
        buf_add(out, report == diag->first ? "\n  " : ",\n  ");
        add_json_report(diag, out, report);
    }
    buf_add(out, diag->first ? "\n]\n" : "]\n");
}

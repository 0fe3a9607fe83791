/* diag.h - the sink for mistakes in a scene, and the one printer for them.
 * Everything that checks a scene reports here and goes on, so that one run shows all mistakes.
 * The codes stand in diags.def with severity, cause and cure; the literal message stays at the call.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_DIAG_H
#define MEN_DIAG_H

#include <stdarg.h>

#include "base/buf.h"
#include "diag/source.h"

typedef enum DiagSeverity {
    DIAG_ERROR,
    DIAG_WARNING,
    DIAG_REMARK /* worth a look, and as likely meant: only `check` makes them, and --werror leaves them alone */
} DiagSeverity;

typedef enum DiagCode {
#define DIAG(name, severity, slug, cause, cure) D_##name,
#include "diag/diags.def"
#undef DIAG
    D_COUNT
} DiagCode;

/* Where a node or a call came from besides its own place: the includes and macros around it. */
typedef struct DiagChain DiagChain;
struct DiagChain {
    const DiagChain *outer;
    Span span;        /* of the call or the include */
    const char *what; /* "in def 'pour', called from", "included from" */
};

typedef struct DiagNote DiagNote;
struct DiagNote {
    DiagNote *next;
    bool has_span;
    Span span;
    const char *text;
};

/* Frames of an animation, in rising order. */
typedef struct DiagFrames DiagFrames;
struct DiagFrames {
    DiagFrames *next;
    uint32_t first, last, step; /* step: 0 for a single frame */
};

typedef struct Diagnostic Diagnostic;
struct Diagnostic {
    Diagnostic *next;
    DiagCode code;
    DiagSeverity severity;
    bool has_span;
    Span span;
    bool in_library; /* met there, and reported at the call that led there */
    const char *text;
    const char *hint; /* NULL, or an edit: "did you mean 'ior'?" */
    DiagNote *notes;
    const DiagChain *chain;
    DiagFrames *frames, *last_frames; /* in which it was found; NULL: the scene is no animation, or it is not known */
};

typedef struct Diag {
    Arena *arena;
    SourceSet *sources;
    Diagnostic *first, *last;
    uint32_t n_errors, n_warnings, n_remarks;
    uint32_t limit;           /* kept of each severity; more are counted only */
    bool warnings_are_errors; /* --werror */
    const DiagChain *chain;   /* the present chain, set by the evaluator; each report has a copy */
    bool in_frame;            /* reports are of a frame of an animation: the next */
    uint32_t frame;
} Diag;

void diag_init(Diag *diag, Arena *arena, SourceSet *sources);
/* Where the author of a scene can mend what is at span: there, or, in the standard library, at the call that led into it. */
Span diag_author_place(const SourceSet *sources, Span span, const DiagChain *chain);
/* Reports at a place; severity is the code's own. Returns the report so that hints and notes can
 * be added; never NULL (past the limit it is a scratch report that is not kept). A second report of
 * the same code at the same place and text is dropped. What is met in the standard library is reported at the author's
 * place, with a note of where; of several errors that one call leads to there, the first. */
Diagnostic *diag_report(Diag *diag, DiagCode code, Span span, const char *format, ...) ATTR_PRINTF(4, 5);
/* The same for mistakes without a place in a text. */
Diagnostic *diag_report_nowhere(Diag *diag, DiagCode code, const char *format, ...) ATTR_PRINTF(3, 4);
void diag_hint(Diag *diag, Diagnostic *report, const char *format, ...) ATTR_PRINTF(3, 4);
void diag_note(Diag *diag, Diagnostic *report, Span span, const char *format, ...) ATTR_PRINTF(4, 5);
void diag_note_nowhere(Diag *diag, Diagnostic *report, const char *format, ...) ATTR_PRINTF(3, 4);
/* "did you mean 'X'?" when exactly one of the candidates is near enough to the wrong word. */
void diag_suggest(Diag *diag, Diagnostic *report, const char *wrong, const char *const *candidates, size_t n);
/* The same, and where none is near, a note of what there is: "its cameras: left and right". */
void diag_suggest_or_list(Diag *diag, Diagnostic *report, const char *wrong, const char *const *candidates, size_t n,
                          const char *what);

/* A sink and its sources as they are, to come back to: what is added after diag_mark is forgotten by diag_rewind. */
typedef struct DiagMark {
    Diagnostic *last;
    uint32_t n_errors, n_warnings, n_remarks, n_sources;
} DiagMark;
DiagMark diag_mark(const Diag *diag);
void diag_rewind(Diag *diag, DiagMark mark);

/* Takes over copies of the reports of another evaluation of the same texts; of a mistake that is here already (by its
 * code and place) only the frames are added. Frames must come in rising order. */
void diag_merge(Diag *into, const Diag *from);
/* Whether there is a report of that kind. */
bool diag_has(const Diag *diag, DiagCode code);
/* Takes back what was reported in a text. */
void diag_drop_source(Diag *diag, uint32_t source);
/* Forgets the warnings and remarks of mistakes that known holds, too. */
void diag_drop_known(Diag *diag, const Diag *known);

/* All reports as text, in order of place (source, byte): "file:line:col: error: text [slug]", the
 * source line with a gutter, the caret line, hint, notes and chain; then "N errors, M warnings" is
 * NOT part of it. Tabs are expanded, wide characters take two columns, long lines are cut around
 * the caret. color adds SGR codes. */
void diag_print(Diag *diag, Buf *out, bool color);
/* The same facts as one JSON array. */
void diag_print_json(Diag *diag, Buf *out);
/* Puts the reports in the order in which they are printed: by place, with unused names behind what else there is if there are errors. */
void diag_sort(Diag *diag);

/* The columns of diags.def. */
const char *diag_slug(DiagCode code);
const char *diag_cause(DiagCode code);
const char *diag_cure(DiagCode code);
DiagSeverity diag_severity(DiagCode code);
const char *diag_severity_text(DiagSeverity severity); /* "error", "warning", "remark" */

#endif

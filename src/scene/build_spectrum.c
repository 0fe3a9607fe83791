/* build_spectrum.c - measured spectra: wavelengths and values, in place or from
 * a text file, checked and brought to the wavelengths that spectra are kept at.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "base/num.h"
#include "base/utf8.h"
#include "optics/spectral_lines.h"
#include "scene/build_parts.h"

enum { LARGEST_FILE = 64 << 20 };

/* The rows of one spectrum() and where each is written. */
typedef struct Rows {
    Builder *b;
    const EvalProp *prop;
    double *pairs;     /* wavelength, value */
    const Span *spans; /* of the rows of a file; NULL in place */
    size_t n;
    double least, most; /* of values, the factor included */
    DiagCode code;      /* of what is wrong with a row of a file, */
    const char *row_is; /* and what it should be */
} Rows;

/* ---- files ---- */

static bool is_gap(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == ',' || c == ';';
}

static const char *skip_gap(const char *at, const char *end)
{
    while (at < end && is_gap(*at)) at++;
    return at;
}

/* Two numbers, and nothing behind them. */
static bool read_row(const char *at, const char *end, double pair[2])
{
    for (int i = 0; i < 2; i++) {
        size_t length = num_parse(at, (size_t)(end - at), &pair[i]);
        const char *next = at + length;
        if (length == 0 || (next < end && !is_gap(*next))) return false;
        at = skip_gap(next, end);
    }
    return at == end;
}

/* Spreadsheets write a line of words above the numbers. */
static bool is_heading(const char *at, const char *end)
{
    double number;
    return num_parse(at, (size_t)(end - at), &number) == 0;
}

static bool read_rows(Rows *rows, uint32_t source, const char *text, size_t length)
{
    Builder *b = rows->b;
    size_t n_lines = 1;
    bool first = true;
    for (size_t i = 0; i < length; i++) n_lines += text[i] == '\n';
    rows->pairs = ARENA_ARRAY(b->arena, double, 2 * n_lines);
    Span *spans = ARENA_ARRAY(b->arena, Span, n_lines);
    rows->spans = spans;
    for (size_t at = utf8_mark_length(text, length), next; at < length; at = next + 1) {
        next = at + strcspn(text + at, "\n");
        const char *end = text + at + strcspn(text + at, "#\n"), *begin = skip_gap(text + at, end);
        while (end > begin && is_gap(end[-1])) end--;
        if (begin == end) continue;
        Span span = {source, (uint32_t)(begin - text), (uint32_t)(end - text)};
        bool heading = first && is_heading(begin, end);
        first = false;
        if (heading) continue;
        if (!read_row(begin, end, rows->pairs + 2 * rows->n)) {
            diag_report(b->diag, rows->code, span, "%s", rows->row_is);
            return false;
        }
        spans[rows->n++] = span;
    }
    return true;
}

static bool read_file(Rows *rows, const EvalTerm *term)
{
    BuildText file;
    return build_text_file(rows->b, term->span, term->text, LARGEST_FILE, rows->code, &file) &&
           read_rows(rows, file.source, file.text, file.length);
}

/* ---- checks ---- */

static Span span_of_row(const Rows *rows, size_t i)
{
    return rows->spans ? rows->spans[i] : rows->prop->as.spectrum.term->span;
}

static const char *place_of_row(const Rows *rows, size_t i)
{
    return rows->spans ? "" : arena_format(rows->b->arena, " (row %zu of %zu)", i + 1, rows->n);
}

static bool check_row(const Rows *rows, size_t i)
{
    const double *pair = rows->pairs + 2 * i;
    double scale = rows->prop->as.spectrum.term->scale, value = pair[1] * scale;
    Diag *diag = rows->b->diag;
    Span span = span_of_row(rows, i);
    if (!(pair[0] > 0) || !isfinite(pair[0])) {
        diag_report(diag, D_BAD_SPECTRUM, span, "%g nm is no wavelength%s", pair[0], place_of_row(rows, i));
    } else if (i > 0 && !(pair[0] > pair[-2])) {
        diag_report(diag, D_BAD_SPECTRUM, span, "%g nm does not come after %g nm%s", pair[0], pair[-2],
                    place_of_row(rows, i));
    } else if (!(value >= rows->least) || !(value <= rows->most)) {
        Diagnostic *report =
            diag_report(diag, D_VALUE_OUT_OF_RANGE, span, "'%s' of %g at %g nm is outside of %g .. %g%s",
                        rows->prop->type->name, value, pair[0], rows->least, rows->most, place_of_row(rows, i));
        if (scale != 1) diag_hint(diag, report, "the value is %g times %g", pair[1], scale);
    } else {
        return true;
    }
    return false;
}

static bool check_rows(const Rows *rows)
{
    Diag *diag = rows->b->diag;
    Span span = rows->prop->as.spectrum.term->span;
    for (size_t i = 0; i < rows->n; i++)
        if (!check_row(rows, i)) return false;
    if (rows->n < 2) {
        diag_report(diag, D_BAD_SPECTRUM, span, "a spectrum needs two rows or more, not %zu", rows->n);
        return false;
    }
    double first = rows->pairs[0], last = rows->pairs[2 * rows->n - 2];
    if (last > (double)SPECTRUM_MIN_NM && first < (double)SPECTRUM_MAX_NM) return true;
    Diagnostic *report = diag_report(diag, D_BAD_SPECTRUM, span,
                                     "the spectrum is of %g to %g nm: nothing of it is visible", first, last);
    if (last < 100) diag_hint(diag, report, "wavelengths are in nanometres, not in micrometres");
    return false;
}

static bool take_rows(Rows *rows)
{
    const EvalTerm *term = rows->prop->as.spectrum.term;
    if (term->text) return read_file(rows, term);
    rows->n = term->n_pairs;
    rows->pairs = ARENA_ARRAY(rows->b->arena, double, 2 * rows->n);
    memcpy(rows->pairs, term->pairs, 2 * rows->n * sizeof *rows->pairs);
    return true;
}

bool build_pairs(Builder *b, const EvalProp *prop, DiagCode code, const char *row_is, const double **pairs, size_t *n)
{
    Rows rows = {.b = b, .prop = prop, .code = code, .row_is = row_is};
    if (!take_rows(&rows)) return false;
    *pairs = rows.pairs;
    *n = rows.n;
    return true;
}

static bool read_spectrum(Builder *b, const EvalProp *prop, double most, Rows *rows)
{
    const EvalTerm *term = prop->as.spectrum.term;
    *rows = (Rows){.b = b,
                   .prop = prop,
                   .least = prop->type->min,
                   .most = fmin(prop->type->max, most),
                   .code = D_BAD_SPECTRUM,
                   .row_is = "a row is a wavelength in nm and a value"};
    if (!take_rows(rows) || !check_rows(rows)) return false;
    for (size_t i = 0; i < rows->n; i++) rows->pairs[2 * i + 1] *= term->scale;
    return true;
}

bool build_spectrum(Builder *b, const EvalProp *prop, double most, Spectrum *out)
{
    Rows rows;
    if (!read_spectrum(b, prop, most, &rows)) return false;
    *out = spectrum_from_rows(rows.pairs, rows.n, ARENA_ARRAY(b->arena, float, SPECTRUM_SAMPLES));
    return true;
}

/* Lines are kept as they are, as paths are given their wavelengths. Of what shines in all colours means serve better, that any
 * path finds. */
bool build_light_spectrum(Builder *b, const EvalProp *prop, double most, Spectrum *out)
{
    Rows rows;
    if (!read_spectrum(b, prop, most, &rows)) return false;
    if (spectrum_rows_are_fine(rows.pairs, rows.n)) {
        SpectrumRows *kept = ARENA_NEW(b->arena, SpectrumRows);
        bool lines = false;
        Error error;
        kept->row = ARENA_ARRAY(b->arena, SpectrumRow, rows.n + 2);
        *out = spectrum_from_fine_rows(rows.pairs, rows.n, kept);
        if (!build_succeeded(b, spectrum_find_lines(out, &lines, &error), &error, prop->span)) return false;
        if (!lines) *out = spectrum_smoothed(out);
    } else {
        *out = spectrum_from_rows(rows.pairs, rows.n, ARENA_ARRAY(b->arena, float, SPECTRUM_SAMPLES));
    }
    return true;
}

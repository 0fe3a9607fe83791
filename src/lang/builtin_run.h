/* builtin_run.h - what the files of builtin functions share.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BUILTIN_RUN_H
#define MEN_BUILTIN_RUN_H

#include "lang/evaluator.h"

/* Reports that argument index has a wrong type; the result becomes poison. */
void builtin_wrong(const BuiltinCall *call, uint32_t index, const char *wanted, Value *result);
/* Are all arguments numbers? false after a report. */
bool builtin_numbers(const BuiltinCall *call, Value *result);
/* Numbers and vectors in a row: true when they fill v to width, or when one number fills it; false after a report. */
bool builtin_fill(const BuiltinCall *call, unsigned width, double v[4], Value *result);
/* Is the result finite? false after a report. */
bool builtin_finite(const BuiltinCall *call, Value *result);
/* What rnd() is made of: for each number from argument `first` on, h = hash_u64(h ^ bits of the double). Vectors count as their
 * elements. false after a report. rnd() starts with the ASCII of "meniscus" and gives hash_to_unit(h). */
bool builtin_hash(const BuiltinCall *call, uint32_t first, uint64_t *h, Value *result);

/* What rnd() starts its hash with. */
extern const uint64_t builtin_rnd_start;

/* builtin_transform.c */
void run_rotate(const BuiltinCall *call, Value *result);
void run_translate(const BuiltinCall *call, Value *result);
void run_scale(const BuiltinCall *call, Value *result);
void run_matrix(const BuiltinCall *call, Value *result);
void run_transform(const BuiltinCall *call, Value *result);
void run_inverse(const BuiltinCall *call, Value *result);
void run_apply(const BuiltinCall *call, Value *result);

void run_align(const BuiltinCall *call, Value *result);

/* builtin_color.c */
void run_rgb(const BuiltinCall *call, Value *result);
void run_srgb(const BuiltinCall *call, Value *result);
void run_hsv(const BuiltinCall *call, Value *result);
void run_hsl(const BuiltinCall *call, Value *result);

/* builtin_list.c */
void run_sum(const BuiltinCall *call, Value *result);
void run_product(const BuiltinCall *call, Value *result);
void run_sort(const BuiltinCall *call, Value *result);
void run_reverse(const BuiltinCall *call, Value *result);

/* builtin_geometry.c */
void run_bounds(const BuiltinCall *call, Value *result);
void run_inside(const BuiltinCall *call, Value *result);
void run_hit(const BuiltinCall *call, Value *result);
void run_hits(const BuiltinCall *call, Value *result);
void run_scatter(const BuiltinCall *call, Value *result);
void run_volume(const BuiltinCall *call, Value *result);

/* builtin_curve.c */
void run_spline(const BuiltinCall *call, Value *result);
void run_natural_spline(const BuiltinCall *call, Value *result);
void run_angle(const BuiltinCall *call, Value *result);
void run_text(const BuiltinCall *call, Value *result);

#endif

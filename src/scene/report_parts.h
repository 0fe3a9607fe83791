/* report_parts.h - what the files of the report share; private to src/scene/report*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_REPORT_PARTS_H
#define MEN_REPORT_PARTS_H

#include "scene/report.h"

enum { REPORT_FEW = 4 }; /* more like objects or pairs than this are summed up */

/* A hull by what it is called without its number, and its medium. */
typedef struct ReportMember {
    const char *word;
    size_t length;
    uint32_t medium, hull;
} ReportMember;

/* Like hulls: the same word, the same medium. */
typedef struct ReportGroup {
    ReportMember first;
    uint32_t n;
    double least, most, sum; /* volumes */
} ReportGroup;

typedef struct ReportGroups {
    uint32_t *of_hull;
    ReportGroup *items;
    uint32_t n;
} ReportGroups;
bool report_groups_init(ReportGroups *groups,
                        const CompiledScene *compiled); /* false when memory ends; clear it all the same */
void report_groups_clear(ReportGroups *groups);

/* What happens where two hulls overlap. */
typedef enum VerdictKind {
    VERDICT_RULE,    /* top is on top, by the rule */
    VERDICT_CIRCLE,  /* the rule's answer is part of a circle; volume decided */
    VERDICT_MERGE,   /* one medium: there is no boundary */
    VERDICT_ENTERED, /* depends on the ray */
    VERDICT_NO_NESTING
} VerdictKind;
typedef struct ReportVerdict {
    VerdictKind kind;
    NestRule rule;
    uint32_t top, bottom; /* hulls */
} ReportVerdict;
ReportVerdict report_verdict(const CompiledScene *compiled, const HullPair *pair);

/* In units that suit people: "3.20 cm³", "0.1 mm". */
void report_add_volume(Buf *out, const Scene *scene, double volume);
void report_add_length(Buf *out, const Scene *scene, double length);

#endif

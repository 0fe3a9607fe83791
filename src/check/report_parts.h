/* report_parts.h - what the files of the report share; private to src/check/report*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_REPORT_PARTS_H
#define MEN_REPORT_PARTS_H

#include <math.h>

#include "scene/lines.h"
#include "check/report.h"
#include "check/report_table.h"

enum {
    REPORT_FEW = 4,  /* more like objects or pairs than this are summed up */
    REPORT_MOST = 10 /* messages of a kind; the rest are counted */
};

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
    VERDICT_NO_NESTING,
    VERDICT_MIX /* bottom adds to top, or is displaced by it: see report_adds */
} VerdictKind;
typedef struct ReportVerdict {
    VerdictKind kind;
    NestRule rule;
    uint32_t top, bottom; /* hulls */
} ReportVerdict;
ReportVerdict report_verdict(const CompiledScene *compiled, const HullPair *pair);
/* Whether a hull of a pair is of the other one's medium, and all of it within that. */
bool report_goes_on_in(const CompiledScene *compiled, const HullPair *pair, uint32_t hull);
/* By how much of the larger one their volumes differ. What is closer may be turned over by a small change. */
#define REPORT_CLOSE_VOLUMES 0.05
double report_volumes_differ(const CompiledScene *compiled, const ReportVerdict *verdict);
/* Whether a medium that mixes is there where another one is on top. */
bool report_adds(const Scene *scene, uint32_t mixing, uint32_t owner);

/* Which hulls have to do with each other, and who is on top of whom there. */
typedef struct ReportOrder {
    uint32_t *cluster; /* of each hull: hulls that overlap, and those that overlap them, have the same number */
    uint32_t *level; /* of each hull: 1, or one more than the largest of those on top of it; 0 where nothing overlaps it
                        or where the policy gives no order */
    uint32_t n_clusters;
} ReportOrder;
bool report_order_init(ReportOrder *order,
                       const CompiledScene *compiled); /* false when memory ends; clear it all the same */
void report_order_clear(ReportOrder *order);

/* What can be seen of a hull, found by looking along n_lines lines through it. */
typedef enum ReportSight {
    REPORT_NOT_MET,     /* no line meets it */
    REPORT_HIDDEN,      /* it owns nothing: others that are on top of it cover it */
    REPORT_INDIFFERENT, /* what it owns would be of the same medium without it */
    REPORT_SEEN
} ReportSight;
ReportSight report_look_at(const CompiledScene *compiled, Probe *probe, uint32_t hull, uint32_t n_lines);
/* A stretch of a hull's interval that no hull of higher rank covers; the surfaces at its ends are NULL where the line itself ends. */
typedef struct ReportStretch {
    double begin, end;
    const Hit *from, *until;
} ReportStretch;
/* What to go on from to the first one; */
static inline ReportStretch report_stretch_before(const Interval *own)
{
    return (ReportStretch){own->begin, own->begin, own->enter, own->enter};
}
/* and the next one that is longer than rounding; false: there is none. */
bool report_next_seen(const CompiledScene *compiled, const Probe *probe, const Interval *own, ReportStretch *stretch);
/* How many lines each of n hulls gets. */
uint32_t report_lines_of_each(uint32_t n);
/* A plane that is an object of its own. */
bool report_is_plane(const Scene *scene, uint32_t object);
/* Closed or not, thin things, operands and lights left out. */
bool report_is_opaque(const CompiledScene *compiled, uint32_t object);
/* Whether a place is within an object, which need not be closed; of planes: below. hits: room for some. */
bool report_is_within(const CompiledScene *compiled, Vec3 place, uint32_t object, HitList *hits);
/* The first opaque object that a place is inside of; SCENE_NONE. The second looks at planes, too: at each object of the scene. */
uint32_t report_body_around(const CompiledScene *compiled, Vec3 place, HitList *hits);
uint32_t report_cover(const CompiledScene *compiled, Vec3 place, HitList *hits);
/* Warns of liquids with a thin gap to the opaque vessel that they are in. */
void report_vessels(const CompiledScene *compiled, Diag *diag);

/* Remarks on liquids that come out through the wall of the solid that holds them. */
void report_leaks(const CompiledScene *compiled, Diag *diag);

/* And on those that stand higher than its rim. */
void report_brims(const CompiledScene *compiled, Diag *diag);

/* Remarks on objects that are wholly inside of an opaque one; see report_enclosed_lights for what shines. */
void report_enclosed(const CompiledScene *compiled, Diag *diag);

/* Remarks on clear solids that touch opaque objects. */
void report_contacts(const CompiledScene *compiled, Diag *diag);

/* Remarks on clear solids of which much is within something opaque. */
void report_buried(const CompiledScene *compiled, Diag *diag);

/* Remarks on thin opaque sheets, as labels, that lie in clear solids just below their surface. */
void report_sunken(const CompiledScene *compiled, Diag *diag);

/* Remarks on lines of the text that place several equal objects at one place. bounds: of each object. */
void report_copies(const CompiledScene *compiled, const Box3 *bounds, Diag *diag);

/* Remarks on portals that glass closes. */
void report_portals(const CompiledScene *compiled, Diag *diag);

/* Number i of n directions that are even over those whose y is least_y or more. */
Vec3 report_direction(int i, int n, double least_y);

/* Parts of the text. */
void report_print_hulls(const CompiledScene *compiled, const ReportGroups *groups, SourceSet *sources, Buf *out);
void report_print_pairs(const CompiledScene *compiled, const ReportGroups *groups, Buf *out);

const SceneObject *report_object(const CompiledScene *compiled, uint32_t hull);
/* Pairs of what one place in the text is of and what another one is of: one report of each. */
typedef struct ReportLikes {
    Span places[REPORT_MOST][2];
    size_t first[REPORT_MOST];       /* the first item of each group, */
    uint32_t counts[REPORT_MOST], n; /* and how many it has */
    uint32_t n_others;               /* for whose groups there was no room */
} ReportLikes;
/* Counts an item more; returns its group, which is new where the count is 1, or REPORT_MOST: it is one of the others. */
uint32_t report_count_places(ReportLikes *likes, Span a, Span b, size_t item);
static inline uint32_t report_count_like(ReportLikes *likes, const SceneObject *a, const SceneObject *b, size_t item)
{
    return report_count_places(likes, a->span, b->span, item);
}
/* Of n items that there was no room for; nothing of none. */
void report_others(Diag *diag, DiagCode code, uint32_t n);
/* Of n items, of which the first few were reported. */
static inline void report_rest(Diag *diag, DiagCode code, uint32_t n)
{
    report_others(diag, code, n > REPORT_MOST ? n - REPORT_MOST : 0);
}
/* An estimate, rounded. */
static inline double report_two_digits(double x)
{
    double step = pow(10, floor(log10(x)) - 1);
    return x > 0 ? round(x / step) * step : 0;
}
/* In units that suit people: "3.20 cm³", "0.1 mm". */
void report_add_area(Buf *out, const Scene *scene, double area);
void report_add_volume(Buf *out, const Scene *scene, double volume);

#endif

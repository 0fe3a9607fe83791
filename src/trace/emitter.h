/* emitter.h - everything of a scene that shines from a finite place, as parts that can be sampled one by one: lights,
 * triangles and analytic pieces of objects whose surface shines, hulls whose medium does. A tree chooses among them.
 * Of a union, an intersection or a difference the operands' own surfaces are sampled, wherever they are; a look at such a place
 * finds out whether the combination's surface is there (path_meets), and else there is no light.
 * Not among them, and so found by chance only: planes without end, and media that shine without end, or out of hulls whose
 * boundaries bend all light.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EMITTER_H
#define MEN_EMITTER_H

#include "scene/compile.h"
#include "trace/light_tree.h"
#include "trace/media.h"

#define EMITTER_NONE UINT32_MAX

typedef enum EmitterKind {
    EMITTER_LIGHT,    /* `of` is one of scene->lights */
    EMITTER_TRIANGLE, /* of the object `of`, its mesh's triangle `part` */
    EMITTER_PIECE,    /* of the object `of`, its solid's piece `part` */
    EMITTER_BALL,     /* the same, a sphere that is still round where it stands */
    EMITTER_GLOW      /* `of` is one of the media's glows */
} EmitterKind;

typedef struct Emitter {
    uint32_t of, part;
    EmitterKind kind;
    bool cut;       /* the object is an operand, whose surface need not be there */
    bool inward;    /* and is taken away from the others: its surface shines to where it was */
    uint32_t cells; /* by which places on it are chosen: of the set's, from 1 on; 0: they are spread evenly */
} Emitter;

typedef struct EmitterCells EmitterCells; /* see emitter_cells.h */
struct World;

typedef struct EmitterSet {
    Emitter *emitters;
    uint32_t n;
    uint32_t *first_of_object; /* of objects that shine themselves or as lights; EMITTER_NONE for others */
    uint32_t first_glow;       /* all glows stand in their order */
    LightTree *tree;
    uint32_t n_sources; /* lights, objects and glows that emitters belong to */
    /* What all of them give by each light of the scene, then by each surface, then by each medium: luminance in all directions,
     * W / m^2 times square scene units. */
    double *powers;
    EmitterCells **cells;
    uint32_t n_cells;
} EmitterSet;

/* Of a world whose media and looks are known. pool: whose threads help, or NULL */
ATTR_NODISCARD Status emitters_find(const struct World *world, Pool *pool, EmitterSet *set, Error *error);
void emitters_clear(EmitterSet *set);

/* The emitter that a hit is on; EMITTER_NONE where there is none. */
static inline uint32_t emitter_of_hit(const EmitterSet *set, const Hit *hit)
{
    uint32_t first = set->first_of_object[hit->object];
    return first == EMITTER_NONE || set->emitters[first].kind == EMITTER_LIGHT ? first : first + hit->primitive;
}

#endif

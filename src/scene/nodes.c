/* nodes.c - the Schema that nodes.def spells out.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "base/attr.h"
#include "scene/build.h"

#define NO_MIN (-HUGE_VAL)
#define NO_MAX HUGE_VAL
#define SHAPE (NODE_PLACED | NODE_TRANSFORMS)

/* What every object that can have an inside is made of. */
#define MATTER                                                                                                         \
    PROP(interior, NODE, UNIT_NONE, 0, NO_MIN, NO_MAX, "medium", NULL,                                                 \
         "the medium that fills it; the object is then clear, and bounded by smooth surfaces")                         \
    PROP(surface, NODE, UNIT_NONE, 0, NO_MIN, NO_MAX, "surface", NULL,                                                 \
         "what it is covered with; the object is then opaque; instead of interior")                                    \
    PROP(priority, INTEGER, UNIT_NONE, 0, -1000000, 1000000, NULL, NULL,                                               \
         "instead of its medium's priority: where objects overlap, the larger is on top")

#define BEVEL_OF_ENDS                                                                                                  \
    PROP(bevel, NUMBER, UNIT_LENGTH, PROP_SHAPE, 0, NO_MAX, NULL, "0",                                                 \
         "how far from the edges of both ends the bevel begins; 0: sharp edges")                                       \
    PROP(bevel_segments, INTEGER, UNIT_NONE, PROP_SHAPE, 1, 64, NULL, "4",                                             \
         "steps of the bevel: 1 is a flat chamfer, more are rounded")
#define STRENGTH                                                                                                       \
    PROP(strength, NUMBER, UNIT_NONE, PROP_SHAPE, NO_MIN, NO_MAX, NULL, "1",                                           \
         "in a blob only: the density in its middle, which falls to 0 at the radius; below 0 it takes away")
#define TOLERANCE(doc) PROP(tolerance, NUMBER, UNIT_LENGTH, PROP_SHAPE | PROP_OPEN_MIN, 0, NO_MAX, NULL, NULL, doc)

/* What every texture says: its values, and where it is. */
#define TEXTURE (NODE_TEXTURE | NODE_TRANSFORMS)
#define TEXTURE_VALUES                                                                                                 \
    PROP(from, SPECTRUM, UNIT_ANY, PROP_TEXTURE, NO_MIN, NO_MAX, NULL, "0",                                            \
         "the value where the pattern is 0: a number or a colour, or another texture")                                 \
    PROP(to, SPECTRUM, UNIT_ANY, PROP_TEXTURE, NO_MIN, NO_MAX, NULL, "1",                                              \
         "the value where it is 1; in between, a mixture")
#define TEXTURE_RAMP                                                                                                   \
    PROP(ramp, RAMP, UNIT_ANY, 0, NO_MIN, NO_MAX, NULL, NULL,                                                          \
         "instead of from and to: values, evenly spread from 0 to 1 or each with its position, as [[0, #fff], [.3, "   \
         "#000]]")
#define TEXTURE_PLACE                                                                                                  \
    PROP(space, CHOICE, UNIT_NONE, 0, NO_MIN, NO_MAX, "object|world", "object",                                        \
         "object: it moves with what it is on; world: it stays where it is")                                           \
    PROP(vary, NUMBER, UNIT_LENGTH, 0, 0, NO_MAX, NULL, "0",                                                           \
         "each object has it shifted by a vector of its own, up to this far along each axis")
#define TEXTURE_WARP(amount)                                                                                           \
    PROP(turbulence, NUMBER, UNIT_NONE, 0, NO_MIN, NO_MAX, NULL, amount,                                               \
         "how far noise moves the places where it is looked up, in units of the pattern")                              \
    PROP(turbulence_octaves, INTEGER, UNIT_NONE, 0, 1, 16, NULL, "4",                                                  \
         "octaves of that noise, each half the size of the last")
#define TEXTURE_SEED PROP(seed, INTEGER, UNIT_NONE, 0, 0, 4294967295.0, NULL, "0", "another seed is another pattern")

/* The names of optics/metal.h; a test compares them. */
#define METALS                                                                                                         \
    "aluminium|brass|bronze|chromium|copper|gold|green_gold|iron|nickel|palladium|platinum|rhodium|silver|stainless_"  \
    "steel|titanium"

/* First the tables of properties ... */
#define NODE(name, flags, child_types, doc) static const PropType name##_props[] = {
#define PROP(name, kind, unit, flags, min, max, choices, default_text, doc)                                            \
    {#name, PROP_##kind, unit, flags, min, max, choices, default_text, doc},
#define END(name)                                                                                                      \
    }                                                                                                                  \
    ;
#define BARE(name, flags, child_types, doc)
#define TERM(name, fewest, most, flags, doc)
#include "scene/nodes.def"
#undef NODE
#undef PROP
#undef END
#undef BARE
#undef TERM

/* ... then the table of nodes ... */
#define NODE(name, flags, child_types, doc) {#name, name##_props, COUNT_OF(name##_props), flags, child_types, doc},
#define PROP(name, kind, unit, flags, min, max, choices, default_text, doc)
#define END(name)
#define BARE(name, flags, child_types, doc) {#name, NULL, 0, flags, child_types, doc},
#define TERM(name, fewest, most, flags, doc)
static const NodeType nodes[] = {
#include "scene/nodes.def"
};
#undef NODE
#undef BARE
#undef TERM

/* ... and that of terms. */
#define NODE(name, flags, child_types, doc)
#define BARE(name, flags, child_types, doc)
#define TERM(name, fewest, most, flags, doc) {#name, fewest, most, flags, doc},
static const TermType terms[] = {
#include "scene/nodes.def"
};

static const Schema schema = {
    .nodes = nodes,
    .n_nodes = COUNT_OF(nodes),
    .terms = terms,
    .n_terms = COUNT_OF(terms),
    .prelude = "medium air { ior = 1  state = gas }\n",
};

const Schema *scene_schema(void)
{
    return &schema;
}

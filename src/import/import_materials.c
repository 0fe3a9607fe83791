/* import_materials.c - media and surfaces for the materials of a mesh file: which of the two an object needs, and the media.
 * SPDX-License-Identifier: Apache-2.0 */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "import/import_parts.h"

double import_fraction(const MeshMaterial *said, MaterialFact fact)
{
    return double_min(double_max(said->facts[fact][0], 0), 1);
}

double import_transmission(const MeshMaterial *said)
{
    if (!said || said->unlit) return 0;
    double part = import_fraction(said, FACT_TRANSMISSION) * (1 - import_fraction(said, FACT_METAL));
    return part < 0.005 ? 0 : part;
}

double import_index(const MeshMaterial *said)
{
    double index = said ? said->facts[FACT_INDEX][0] : 1.5;
    if (index < 1.001 && import_transmission(said) == 0) index = 1.5; /* says nothing of what is opaque */
    return double_min(double_max(index, 1), 4);
}

/* ---- what an object needs ---- */

ImportMaterial *import_material_of(const Importer *im, const ImportItem *item)
{
    size_t i = item->material == IMPORT_NONE ? im->source->n_materials : item->material;
    return &im->materials[i];
}

bool import_is_filled(const Importer *im, const ImportItem *item)
{
    const ImportMaterial *material = import_material_of(im, item);
    return material->clear && !material->thin && item->closed;
}

/* A boundary that is smooth, clear and plain needs no surface. */
static bool has_boundary(const MeshMaterial *said)
{
    const double *facts = said->facts[FACT_ROUGHNESS];
    bool rough = facts[0] >= 0.005 || picture_is_given(&said->pictures[PICTURE_ROUGHNESS]);
    bool painted = import_transmission(said) < 1 || picture_is_given(&said->pictures[PICTURE_TRANSMISSION]);
    return rough || painted || import_boundary_has_film(said) || picture_is_given(&said->pictures[PICTURE_NORMAL]);
}

void import_prepare_materials(Importer *im)
{
    size_t n = im->source->n_materials;
    for (size_t i = 0; i < n; i++) {
        const MeshMaterial *said = &im->source->materials[i];
        bool thin = (said->volume && !(said->facts[FACT_THICKNESS][0] > 0)) || said->facts[FACT_TRANSLUCENCY][0] > 0;
        im->materials[i] = (ImportMaterial){.said = said, .clear = import_transmission(said) > 0, .thin = thin};
    }
    for (size_t i = 0; i < im->n_items; i++) {
        const ImportItem *item = &im->items[i];
        ImportMaterial *material = import_material_of(im, item);
        const char *called = material->said ? material->said->name : "plain";
        if (import_is_filled(im, item)) {
            double chord = item->area > 0 ? 4 * item->volume / item->area * im->file_m : 0;
            material->chord_m = double_max(material->chord_m, chord);
            if (!material->medium) material->medium = import_name(im, called, "material", "medium");
            if (!material->boundary && has_boundary(material->said)) {
                Buf name = {0};
                buf_format(&name, "%s_boundary", material->medium ? material->medium : "");
                material->boundary = import_name(im, buf_text(&name), "boundary", "surface");
                buf_clear(&name);
            }
        } else if (!material->surface) {
            material->surface = import_name(im, called, "material", "surface");
        }
    }
}

void import_add_matter(const Importer *im, const ImportItem *item, NodeText *node)
{
    const ImportMaterial *material = import_material_of(im, item);
    if (!import_is_filled(im, item)) {
        node_word(node, "surface", material->surface ? material->surface : "");
        return;
    }
    node_word(node, "interior", material->medium ? material->medium : "");
    if (material->boundary) node_word(node, "surface", material->boundary);
}

/* ---- media ---- */

static bool has_word(const char *name, const char *const *words)
{
    for (; *words; words++)
        for (const char *at = name; *at; at++) {
            size_t i = 0;
            while ((*words)[i] && tolower((unsigned char)at[i]) == (*words)[i]) i++;
            bool begins = at == name || !isalpha((unsigned char)at[-1]) ||
                          (islower((unsigned char)at[-1]) && isupper((unsigned char)at[0]));
            if (!(*words)[i] && begins) return true;
        }
    return false;
}

/* Liquids give way to solids, gases are on top of liquids; a file does not say what is which. */
static const char *state_of(const MeshMaterial *said)
{
    static const char *const solids[] = {"ice", "glass", "plastic", "crystal", "gem", NULL};
    static const char *const liquids[] = {
        "water",    "liquid",   "fluid", "drink",   "wine",    "whisky", "whiskey", "beer",
        "juice",    "oil",      "tea",   "coffee",  "milk",    "soda",   "cola",    "syrup",
        "honey",    "rum",      "vodka", "gin",     "cognac",  "brandy", "bourbon", "champagne",
        "cocktail", "lemonade", "ink",   "alcohol", "perfume", "sea",    "ocean",   NULL};
    static const char *const gases[] = {"air", "bubble", "gas", "foam", NULL};
    double index = import_index(said);
    if (has_word(said->name, gases) || index < 1.05) return "gas";
    if (has_word(said->name, liquids)) return "liquid";
    if (has_word(said->name, solids)) return "solid";
    return index > 1.325 && index < 1.345 ? "liquid" : "solid";
}

/* Cauchy's two numbers for an index in yellow light and Abbe's number, of which KHR_materials_dispersion has 20 over it; nothing has
 * less than 10. */
static void add_index(NodeText *node, const MeshMaterial *said)
{
    const double d = 0.58756, f = 0.48613, c = 0.65627; /* micrometres */
    double index = import_index(said), dispersion = said->facts[FACT_DISPERSION][0];
    Buf *out = node_prop(node, "ior");
    if (!(dispersion > 0) || index < 1.001) {
        add_number(out, index);
        return;
    }
    double spread = (index - 1) * double_min(dispersion, 2) / 20, b = spread / (1 / (f * f) - 1 / (c * c));
    buf_add(out, "cauchy(");
    add_number(out, index - b / (d * d));
    buf_add(out, ", ");
    add_number(out, b);
    buf_add(out, ")");
}

static bool is_white(const double rgb[3])
{
    return rgb[0] >= 0.999 && rgb[1] >= 0.999 && rgb[2] >= 0.999;
}

/* Two digits are enough for what is a mean. */
static double round_length(double length)
{
    double step = pow(10, floor(log10(length)) - 1);
    return round(length / step) * step;
}

/* What the medium absorbs: what the file says of a distance, and the colour of what goes through, which is that at each boundary
 * there, as that of the mean way through. */
static void add_tint(Importer *im, NodeText *node, const ImportMaterial *material)
{
    const MeshMaterial *said = material->said;
    double tint[3], depth = said->facts[FACT_ATTENUATION_DISTANCE][0];
    const double *filter = said->facts[FACT_FILTER];
    bool attenuates = isfinite(depth) && depth > 0 && !is_white(said->facts[FACT_ATTENUATION]);
    bool filters = !is_white(filter) && material->chord_m > 0 && isfinite(material->chord_m);
    if (!attenuates && !filters) return;
    double chord = filters ? round_length(material->chord_m) : 0;
    if (!attenuates) depth = chord;
    for (int i = 0; i < 3; i++) {
        tint[i] = attenuates ? double_min(double_max(said->facts[FACT_ATTENUATION][i], 0), 1) : 1;
        if (filters) tint[i] *= pow(double_min(double_max(filter[i], 1e-4), 1), depth / chord);
    }
    if (filters)
        import_note(
            im, "its colour is taken as that after the mean way through the object; a smaller depth makes it stronger");
    node_color(node, "tint", tint);
    node_length(node, "depth", depth);
}

static void describe(Importer *im, const ImportMaterial *material)
{
    Buf text = {0}, name = {0};
    add_shown(&name, material->said->name);
    material_describe(material->said, &text);
    const char *called = *buf_text(&name) ? buf_text(&name) : "a material without a name";
    import_say(im, "%s%s%s", called, text.length ? ": " : "", buf_text(&text));
    buf_clear(&text);
    buf_clear(&name);
    if (!material->said->left_out) return;
    add_shown(&name, material->said->left_out);
    import_note(im, "what it says by %s is not taken", buf_text(&name));
    buf_clear(&name);
}

static void write_medium(Importer *im, const ImportMaterial *material)
{
    const MeshMaterial *said = material->said;
    describe(im, material);
    NodeText node = node_begin(im, "medium", material->medium);
    add_index(&node, said);
    node_word(&node, "state", state_of(said));
    add_tint(im, &node, material);
    if (said->facts[FACT_EMISSION_COLOR][0] + said->facts[FACT_EMISSION_COLOR][1] +
            said->facts[FACT_EMISSION_COLOR][2] >
        0)
        import_note(im, "what is clear does not shine by its surface: its emission is not taken");
    import_note_filled(im, said);
    if (picture_is_given(&said->pictures[PICTURE_BASE_COLOR]))
        import_note(im, "a medium is of one colour: the picture of its colour is not taken");
    node_end(&node);
    im->out->n_media++;
    if (material->boundary) import_write_boundary(im, material);
}

/* ---- all ---- */

void import_write_materials(Importer *im)
{
    size_t n_media = 0;
    for (size_t i = 0; i < im->source->n_materials; i++) n_media += im->materials[i].medium != NULL;
    import_begin_section(im, "Materials");
    if (n_media > 1)
        import_say(im, "Which media are solid and which liquid was guessed by name and index: where a solid and a "
                       "liquid overlap, the solid is there.");
    import_write_comment(im);
    for (size_t i = 0; i <= im->source->n_materials; i++) {
        ImportMaterial *material = &im->materials[i];
        Buf subject = {0};
        buf_add(&subject, "material '");
        add_shown(&subject, material->said ? material->said->name : "");
        buf_add(&subject, "'");
        im->subject = material->said ? buf_text(&subject) : NULL;
        if (material->medium || material->surface) buf_add(im->text, "\n");
        if (material->medium) write_medium(im, material);
        if (material->surface) {
            if (material->said)
                describe(im, material);
            else
                import_say(im, "For what has no material in the file.");
            import_write_surface(im, material);
        }
        im->subject = NULL;
        buf_clear(&subject);
    }
}

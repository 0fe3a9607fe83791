/* import_surfaces.c - surfaces for the materials of a mesh file.
 * The model of glTF, of metals and of a matte base under a skin, is a part of that of the language.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "import/import_parts.h"

static void fractions(const double from[3], double to[3])
{
    for (int i = 0; i < 3; i++) to[i] = double_min(double_max(from[i], 0), 1);
}

static double largest(const double rgb[3])
{
    return double_max(double_max(rgb[0], rgb[1]), rgb[2]);
}

static bool has_picture(const MeshMaterial *said, MaterialPicture picture)
{
    return picture_is_given(&said->pictures[picture]);
}

/* ---- parts ---- */

/* A number that may be a picture: one channel of it, times the number. Nothing where it is what it is anyway. Returns whether it is one. */
static bool add_fraction(NodeText *node, const MeshMaterial *said, const char *key, double value,
                         MaterialPicture picture, const char *channel, double anyway)
{
    Importer *im = node->im;
    Buf props = {0};
    if (has_picture(said, picture)) {
        if (channel) buf_format(&props, "  channel = %s", channel);
        if (value < 1) {
            buf_add(&props, "  to = ");
            add_number(&props, value);
        }
        char *image = import_picture(im, &said->pictures[picture], key, buf_text(&props));
        buf_clear(&props);
        if (image) {
            node_word(node, key, image);
            free(image);
            return true;
        }
    }
    if (value != anyway) node_number(node, key, value);
    return false;
}

/* The colour, or its picture. */
static void add_albedo(NodeText *node, const MeshMaterial *said, const char *key)
{
    Importer *im = node->im;
    double rgb[3];
    fractions(said->facts[FACT_BASE_COLOR], rgb);
    char *image = NULL;
    if (has_picture(said, PICTURE_BASE_COLOR))
        image = import_picture(im, &said->pictures[PICTURE_BASE_COLOR], "colour", "");
    if (!image) {
        node_color(node, key, rgb);
        return;
    }
    double grey = largest(rgb);
    bool factor = grey < 0.999 && material_says(said, FACT_BASE_COLOR);
    bool coloured = grey - double_min(double_min(rgb[0], rgb[1]), rgb[2]) > 0.01;
    if (said->packed && coloured)
        import_note(im, "its picture is taken without the colour %.3g %.3g %.3g that it is multiplied by", rgb[0],
                    rgb[1], rgb[2]);
    Buf *out = node_prop(node, key);
    if (said->packed && factor) /* an .mtl file has a colour for programs that do not take the picture */ {
        buf_format(out, "mix { from = 0  to = %s  blend = ", image);
        add_number(out, grey);
        buf_add(out, " }");
    } else {
        buf_add(out, image);
    }
    free(image);
}

static void add_relief(NodeText *node, const MeshMaterial *said)
{
    Importer *im = node->im;
    double strength = double_min(double_max(said->facts[FACT_NORMAL_STRENGTH][0], 0), 100);
    if (has_picture(said, PICTURE_NORMAL)) {
        char *image = import_picture(im, &said->pictures[PICTURE_NORMAL], "normals", "");
        if (image) node_word(node, "normal_map", image);
        if (image && strength != 1) node_number(node, "normal_strength", strength);
        free(image);
    } else if (has_picture(said, PICTURE_BUMP)) {
        char *image = import_picture(im, &said->pictures[PICTURE_BUMP], "bump", "");
        double size = vec3_length(vec3_sub(im->all.max, im->all.min)) * im->scene_m;
        if (image) {
            import_note(im, "how high its bumps are is not said by the file: bump_height is a guess");
            node_word(node, "bump", image);
            node_length(node, "bump_height", size / 500);
        }
        free(image);
    }
}

/* How much its skin mirrors of what its index makes it mirror: the mean of the channels. */
static double skin_factor(const MeshMaterial *said)
{
    const double *color = said->facts[FACT_SPECULAR_COLOR];
    double grey = (double_max(color[0], 0) + double_max(color[1], 0) + double_max(color[2], 0)) / 3;
    return import_fraction(said, FACT_SPECULAR) * double_min(grey, 1);
}

static void add_skin(NodeText *node, const MeshMaterial *said, bool metal)
{
    Importer *im = node->im;
    const double *color = said->facts[FACT_SPECULAR_COLOR];
    double specular = skin_factor(said);
    bool skin = specular > 0;
    if (skin && !metal) node_number(node, "ior", import_index(said));
    if (skin && !metal && specular < 1) node_number(node, "specular", specular);
    if (!metal && skin && (fabs(color[0] - color[1]) > 0.02 || fabs(color[1] - color[2]) > 0.02))
        import_note(im, "the colour of what its skin mirrors is not taken");
    if (skin || metal)
        add_fraction(node, said, "roughness", import_fraction(said, FACT_ROUGHNESS), PICTURE_ROUGHNESS,
                     said->packed ? "green" : NULL, 0);
    double anisotropy = import_fraction(said, FACT_ANISOTROPY);
    if (anisotropy > 0 && (skin || metal)) {
        node_number(node, "anisotropy", anisotropy);
        import_say(im, "How its scratches run is for you to say: grain = around, x, y or z.");
    }
}

/* lets_all_through: nothing of it is opaque. */
static void add_layers(NodeText *node, const MeshMaterial *said, bool lets_all_through)
{
    double coat = import_fraction(said, FACT_COAT), sheen = largest(said->facts[FACT_SHEEN_COLOR]);
    if (coat > 0 && lets_all_through) {
        import_note(node->im,
                    "a coat is over what is opaque, and all of this is clear or translucent: its coat is not taken");
    } else if (coat > 0) {
        add_fraction(node, said, "coat", import_fraction(said, FACT_COAT), PICTURE_COAT, "red", 0);
        add_fraction(node, said, "coat_roughness", import_fraction(said, FACT_COAT_ROUGHNESS), PICTURE_COAT_ROUGHNESS,
                     "green", 0);
        if (has_picture(said, PICTURE_COAT_NORMAL))
            import_note(node->im, "the coat has no relief of its own: its picture of normals is not taken");
    }
    if (sheen > 0) {
        double color[3];
        for (int i = 0; i < 3; i++) color[i] = double_max(said->facts[FACT_SHEEN_COLOR][i], 0) / sheen;
        node_number(node, "fuzz", double_min(sheen, 1));
        if (color[0] < 1 || color[1] < 1 || color[2] < 1) node_color(node, "fuzz_color", color);
        node_number(node, "fuzz_roughness", import_fraction(said, FACT_SHEEN_ROUGHNESS));
    }
}

static double brightness(const MeshMaterial *said)
{
    double strength = double_max(said->facts[FACT_EMISSION][0], 0);
    return double_min(strength * double_max(largest(said->facts[FACT_EMISSION_COLOR]), 0), 1e9);
}

bool import_shines(const MeshMaterial *said)
{
    return said && !said->unlit && brightness(said) > 0;
}

static void add_light_color(NodeText *node, const MeshMaterial *said, const char *key)
{
    double color[3], most = largest(said->facts[FACT_EMISSION_COLOR]);
    if (said->unlit) {
        add_albedo(node, said, key);
        return;
    }
    char *image = NULL;
    if (has_picture(said, PICTURE_EMISSION))
        image = import_picture(node->im, &said->pictures[PICTURE_EMISSION], "emission", "");
    for (int i = 0; i < 3; i++) color[i] = double_max(said->facts[FACT_EMISSION_COLOR][i], 0) / most;
    if (image)
        node_word(node, key, image);
    else
        node_color(node, key, color);
    if (image && (color[0] < 0.99 || color[1] < 0.99 || color[2] < 0.99))
        import_note(node->im, "its picture of emission is taken without the colour that it is multiplied by");
    free(image);
}

/* weight: which part of the surface is there, where it has holes, which do not shine; NULL: all of it. */
static void add_emission(NodeText *node, const MeshMaterial *said, const char *weight)
{
    double radiance = said->unlit ? 1 : brightness(said);
    if (!(radiance > 0)) return;
    if (said->unlit) import_say(node->im, "It is shown as it is in the file, not lit: so it shines by itself here.");
    if (weight) {
        NodeText part = node_begin(node->im, "mix", NULL);
        part.value = true;
        node_number(&part, "from", 0);
        add_light_color(&part, said, "to");
        node_word(&part, "blend", weight);
        node_end_value(&part, node_prop(node, "emission"));
    } else {
        add_light_color(node, said, "emission");
    }
    if (radiance != 1) node_number(node, "radiance", radiance);
}

/* ---- films ---- */

/* On what is filled. */
bool import_boundary_has_film(const MeshMaterial *said)
{
    const double smooth = 0.005;
    return import_fraction(said, FACT_FILM) > 0 && import_fraction(said, FACT_ROUGHNESS) < smooth &&
           !picture_is_given(&said->pictures[PICTURE_ROUGHNESS]);
}

/* On what is opaque. */
static bool metal_has_film(const MeshMaterial *said)
{
    return import_fraction(said, FACT_FILM) > 0 && import_fraction(said, FACT_METAL) > 0;
}

/* lies: on something; else it is a thin surface itself, of its own index. */
static void add_film(NodeText *node, const MeshMaterial *said, bool lies)
{
    const double thickest_nm = 40000;
    Buf *out = node_prop(node, "film");
    add_number(out, double_min(double_max(said->facts[FACT_FILM_THICKNESS][0], 0), thickest_nm));
    buf_add(out, "nm");
    if (lies) node_number(node, "film_ior", double_min(double_max(said->facts[FACT_FILM_INDEX][0], 1), 4));
}

/* What has no place in a surface, so that nobody waits for it in the picture. */
static void note_left_out(Importer *im, const MeshMaterial *said, bool filmed)
{
    double film = import_fraction(said, FACT_FILM), metal = import_fraction(said, FACT_METAL);
    if (film > 0 && !filmed)
        import_note(
            im,
            "films lie on metals, on what is smooth and filled, or are thin surfaces: its iridescence is not taken");
    else if (film > 0 && film < 0.999)
        import_note(im, "its iridescence is taken whole, of which the file has %.3g", film);
    static const struct {
        MaterialPicture picture;
        const char *what;
    } rows[] = {{PICTURE_SPECULAR, "specular"},
                {PICTURE_SPECULAR_COLOR, "specular colour"},
                {PICTURE_SHEEN, "sheen"},
                {PICTURE_FILM, "iridescence"},
                {PICTURE_ANISOTROPY, "anisotropy"}};
    for (size_t i = 0; i < COUNT_OF(rows); i++)
        if (has_picture(said, rows[i].picture)) import_note(im, "its picture of %s is not taken", rows[i].what);
    if (!said->unlit && metal > 0.005 && import_fraction(said, FACT_TRANSMISSION) > 0.005)
        import_note(im, "metal lets no light through: of its transmission %.3g is left, as metallicFactor is %.3g%s",
                    import_transmission(said), metal,
                    material_says(said, FACT_METAL) ? "" : " where the file does not say it");
}

void import_note_filled(Importer *im, const MeshMaterial *said)
{
    note_left_out(im, said, import_boundary_has_film(said));
    if (import_fraction(said, FACT_COAT) > 0) import_note(im, "what is filled has no coat: its coat is not taken");
    if (largest(said->facts[FACT_SHEEN_COLOR]) > 0)
        import_note(im, "what is filled has no fuzz: its sheen is not taken");
    if (fabs(skin_factor(said) - 1) > 0.01)
        import_note(im, "what is filled mirrors by its index alone: its specular is not taken");
    if (said->alpha == ALPHA_BLEND && import_fraction(said, FACT_OPACITY) < 0.999)
        import_note(im, "what is filled has no holes: its opacity is not taken");
}

/* ---- surfaces ---- */

/* A pane, which light goes through, or a leaf. Returns whether nothing of it is opaque. */
static bool add_thin(NodeText *node, const MeshMaterial *said)
{
    const double whole = 0.9999; /* is written as 1 beyond that */
    bool lets_all_through = false;
    double tint[3], translucency = import_fraction(said, FACT_TRANSLUCENCY), clear = import_transmission(said);
    fractions(said->facts[FACT_FILTER], tint);
    node_word(node, "thin", "true");
    if (clear < 1) add_albedo(node, said, "albedo");
    if (clear > 0) {
        node_number(node, "ior", import_index(said));
        lets_all_through =
            !add_fraction(node, said, "transmission", clear, PICTURE_TRANSMISSION, "red", 0) && clear > whole;
        if (tint[0] < 1 || tint[1] < 1 || tint[2] < 1) node_color(node, "tint", tint);
        add_fraction(node, said, "roughness", import_fraction(said, FACT_ROUGHNESS), PICTURE_ROUGHNESS,
                     said->packed ? "green" : NULL, 0);
    }
    if (translucency > 0) {
        bool varies = add_fraction(node, said, "translucency", translucency, PICTURE_TRANSLUCENCY, "alpha", 0);
        lets_all_through = lets_all_through || (!varies && translucency > whole);
    }
    if (import_fraction(said, FACT_FILM) > 0 && clear > 0) add_film(node, said, false);
    return lets_all_through;
}

static void add_opaque(NodeText *node, const MeshMaterial *said)
{
    double metal = import_fraction(said, FACT_METAL);
    bool picture =
        has_picture(said, PICTURE_METAL) || (has_picture(said, PICTURE_ROUGHNESS) && metal > 0 && said->packed);
    add_albedo(node, said, "albedo");
    if (picture) {
        bool own = has_picture(said, PICTURE_METAL);
        add_fraction(node, said, "metalness", import_fraction(said, FACT_METAL),
                     own ? PICTURE_METAL : PICTURE_ROUGHNESS, own ? NULL : "blue", 0);
    } else if (metal > 0) {
        node_number(node, "metalness", metal);
    }
    add_skin(node, said, metal == 1 && !picture);
    if (metal_has_film(said)) add_film(node, said, true);
}

/* What covers what is not filled, but for its holes and its light. */
static void add_cover(NodeText *node, const ImportMaterial *material)
{
    const MeshMaterial *said = material->said;
    double black[3] = {0, 0, 0};
    bool thin = material->clear || said->facts[FACT_TRANSLUCENCY][0] > 0;
    if (said->unlit) {
        node_color(node, "albedo", black);
        return;
    }
    bool lets_all_through = thin && add_thin(node, said);
    if (!thin) add_opaque(node, said);
    add_relief(node, said);
    add_layers(node, said, lets_all_through);
    note_left_out(node->im, said, thin ? material->clear : metal_has_film(said));
}

/* Where a mask or an opacity below 1 makes holes: which part of it is there. false: all of it. */
static bool opacity_of(Importer *im, const MeshMaterial *said, Buf *out)
{
    double opacity = import_fraction(said, FACT_OPACITY), cutoff = import_fraction(said, FACT_CUTOFF);
    bool of_mtl = has_picture(said, PICTURE_OPACITY), masks = said->alpha == ALPHA_MASK;
    const MeshPicture *picture = &said->pictures[of_mtl ? PICTURE_OPACITY : PICTURE_BASE_COLOR];
    if (said->alpha == ALPHA_OPAQUE) return false;
    Buf props = {0};
    bool hidden = masks && opacity < cutoff;
    if (!hidden && (of_mtl || (picture_is_given(picture) && import_picture_has_alpha(im, picture)))) {
        double at = opacity > 0 ? cutoff / opacity : 1;
        if (!of_mtl) buf_add(&props, "  channel = alpha");
        if (masks) buf_format(&props, "  ramp = [[0, 0], [%.3g, 0], [%.3g, 1], [1, 1]]", at, at);
        if (!masks && opacity < 1) buf_format(&props, "  to = %.3g", opacity);
        char *image = import_picture(im, picture, "mask", buf_text(&props));
        buf_clear(&props);
        if (image) buf_add(out, image);
        free(image);
        if (out->length) return true;
    }
    if (masks ? !hidden : opacity >= 0.999) return false;
    add_number(out, masks ? 0 : opacity);
    return true;
}

static void write_with_holes(Importer *im, const ImportMaterial *material, const char *weight)
{
    NodeText node = node_begin(im, "surface", material->surface), cover = node_begin(im, "surface", NULL);
    cover.value = true;
    add_cover(&cover, material);
    Buf *out = node_prop(&node, "mix");
    buf_add(out, "[surface { thin = true  ior = 1  transmission = 1  specular = 0 },\n    ");
    node_end_value(&cover, out);
    buf_add(out, "]");
    node_word(&node, "weight", weight);
    add_emission(&node, material->said, weight);
    import_say(im, "The first of the two is nothing, where the second is not.");
    node_end(&node);
}

void import_write_surface(Importer *im, const ImportMaterial *material)
{
    const MeshMaterial *said = material->said;
    const double grey[3] = {0.8, 0.8, 0.8};
    im->out->n_surfaces++;
    im->owner = material->surface;
    if (!said) {
        NodeText plain = node_begin(im, "surface", material->surface);
        node_color(&plain, "albedo", grey);
        node_number(&plain, "ior", 1.5);
        node_number(&plain, "roughness", 0.4);
        node_end(&plain);
        return;
    }
    if (material->clear && material->thin && said->volume)
        import_say(im, "The file has it without thickness: a pane. To fill an object with it, write a medium and "
                       "interior = in place of surface =.");
    Buf weight = {0};
    if (opacity_of(im, said, &weight) && !material->clear) {
        write_with_holes(im, material, buf_text(&weight));
    } else {
        NodeText node = node_begin(im, "surface", material->surface);
        add_cover(&node, material);
        add_emission(&node, said, NULL);
        node_end(&node);
    }
    buf_clear(&weight);
}

void import_write_boundary(Importer *im, const ImportMaterial *material)
{
    const MeshMaterial *said = material->said;
    NodeText node = node_begin(im, "surface", material->boundary);
    im->owner = material->boundary;
    bool painted = import_transmission(said) < 1 || has_picture(said, PICTURE_TRANSMISSION);
    if (painted) {
        import_say(im, "What is not clear of %s is painted.", material->medium);
        add_fraction(&node, said, "transmission", import_transmission(said), PICTURE_TRANSMISSION, "red", 1);
        add_albedo(&node, said, "albedo");
        node_number(&node, "ior", import_index(said));
    }
    if (import_boundary_has_film(said))
        add_film(&node, said, true);
    else
        add_fraction(&node, said, "roughness", import_fraction(said, FACT_ROUGHNESS), PICTURE_ROUGHNESS,
                     said->packed ? "green" : NULL, 0);
    add_relief(&node, said);
    node_end(&node);
    im->out->n_surfaces++;
}

/* import.c - the text of a scene from a mesh file, from its head to its end.
 * SPDX-License-Identifier: Apache-2.0 */
#include "import/import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "base/file.h"
#include "import/import_parts.h"
#include "lang/value.h"

/* ---- units ---- */

static const struct {
    const char *name;
    double metres, most; /* of what is shown, whose size is most of a hundred to a thousand of these */
} units[] = {{"um", 1e-6, 3e-3}, {"mm", 1e-3, 1.5}, {"cm", 1e-2, 15}, {"m", 1, 15e3}, {"km", 1e3, HUGE_VAL}};

/* The file's unit, and one in which the numbers of the scene are handy. */
static void choose_units(Importer *im, double size)
{
    const ImportOptions *options = im->options;
    bool stl = strcasecmp(file_extension(options->path), "stl") == 0;
    im->guessed_unit = !(options->unit_m > 0) && !(im->source->unit_m > 0);
    im->file_m = options->unit_m > 0      ? options->unit_m
                 : im->source->unit_m > 0 ? im->source->unit_m
                 : stl || size > 10       ? 1e-3 /* what is printed or milled is in millimetres */
                                          : 1;
    size_t i = 0;
    while (size * im->file_m > units[i].most) i++;
    im->scene_m = units[i].metres;
    im->unit = units[i].name;
}

static Box3 turned(const Importer *im, Box3 box)
{
    double s = im->file_m / im->scene_m;
    Affine map = im->options->up_z ? (Affine){{{s, 0, 0}, {0, 0, s}, {0, -s, 0}}, {0, 0, 0}}
                                   : (Affine){{{s, 0, 0}, {0, s, 0}, {0, 0, s}}, {0, 0, 0}};
    return affine_box(&map, box);
}

static Status measure(Importer *im)
{
    Box3 all = box3_empty();
    for (size_t i = 0; i < im->n_items; i++) all = box3_union(all, im->items[i].box);
    Vec3 d = vec3_sub(all.max, all.min);
    double size = vec3_length(d);
    if (!(size > 0) || !isfinite(size) || size > 1e30)
        return fail(im->error, STATUS_INPUT, "'%s': what it holds has a size of %g; nothing can be seen of that",
                    im->options->path, size);
    choose_units(im, size);
    im->all = box3_empty();
    for (size_t i = 0; i < im->n_items; i++) {
        im->items[i].box = turned(im, im->items[i].box);
        im->all = box3_union(im->all, im->items[i].box);
    }
    im->step = pow(10, floor(log10(size * im->file_m / im->scene_m)) - 4);
    return STATUS_OK;
}

/* ---- what others stand on ---- */

static Box3 box_of_others(const Importer *im, size_t but)
{
    Box3 box = box3_empty();
    for (size_t i = 0; i < im->n_items; i++)
        if (i != but && !im->items[i].is_floor) box = box3_union(box, im->items[i].box);
    return box;
}

/* Something opaque below all else, and as wide: a table, a floor. */
static void find_floors(Importer *im)
{
    for (size_t i = 0; i < im->n_items; i++) {
        const Box3 *box = &im->items[i].box;
        Box3 others = box_of_others(im, i);
        double height = others.max.y - others.min.y;
        if (box3_is_empty(others) || import_is_filled(im, &im->items[i])) continue;
        im->items[i].is_floor = box->max.y <= others.min.y + 0.1 * height && box->min.x <= others.min.x &&
                                box->max.x >= others.max.x && box->min.z <= others.min.z && box->max.z >= others.max.z;
    }
    im->shown = box_of_others(im, im->n_items);
    if (box3_is_empty(im->shown) || !(vec3_length(vec3_sub(im->shown.max, im->shown.min)) > 0)) im->shown = im->all;
}

/* ---- text ---- */

/* Libraries that an OBJ file names, and materials that none of them describes. */
static void note_lost_materials(Importer *im)
{
    const MeshSource *source = im->source;
    Buf name = {0};
    size_t n = 0;
    if (source->lost_library) {
        add_shown(&name, source->lost_library);
        import_note(im, "its library of materials %s is not beside it, or cannot be read", buf_text(&name));
        buf_clear(&name);
    }
    for (size_t i = 0; i < source->n_parts; i++) {
        const MeshPart *part = &source->parts[i];
        if (strcmp(part->kind, "material") != 0 || mesh_source_material_of(source, part)) continue;
        if (n++ == 0) add_shown(&name, part->name);
    }
    if (n == 1) import_note(im, "its material %s is described nowhere, and plain here", buf_text(&name));
    if (n > 1)
        import_note(im, "its material %s and %zu more are described nowhere, and plain here", buf_text(&name), n - 1);
    buf_clear(&name);
}

static void write_head(Importer *im)
{
    const MeshSource *source = im->source;
    Buf file = {0};
    add_shown(&file, file_name(im->options->path));
    buf_format(im->text, "meniscus 1.0 unit %s\n\n", im->unit);
    import_say(im, "From %s. How its clear objects lie in each other: meniscus check, with the name of this scene.",
               buf_text(&file));
    buf_clear(&file);
    if (im->guessed_unit)
        import_note(im, "the file does not say how long its unit is: a %s is assumed; --unit says otherwise",
                    im->file_m == 1 ? "metre" : "millimetre");
    static const char *const left_out[MESH_LEFT_COUNT] = {
        [MESH_LEFT_MOTION] = "what moves in the file, is bent by bones or changes its shape stands still here",
        [MESH_LEFT_COLORS] = "colours of vertices are not taken: a picture can have them",
        [MESH_LEFT_FACE_UVS] = "texture coordinates of faces are not taken: export them as those of vertices",
        [MESH_LEFT_LINES] = "its points and lines have no surface, and are left out",
        [MESH_LEFT_INSTANCES] = "its instances (EXT_mesh_gpu_instancing) are left out: export them as objects",
        [MESH_LEFT_DISPERSION] =
            "it says one index of refraction for all colours: stones of std/media have their fire, too",
        [MESH_LEFT_MATERIALS] = "it has more materials than are read: the last ones are plain here",
    };
    for (int i = 0; i < MESH_LEFT_COUNT; i++)
        if (source->left_out >> i & 1) import_note(im, "%s", left_out[i]);
    note_lost_materials(im);
    if (im->by_material)
        import_note(im, "it has more than %d objects: those of one material are one object here", IMPORT_MOST_OBJECTS);
    import_write_comment(im);
    if (im->dark || im->paper || im->room) buf_add(im->text, "\nuse \"std/studio.mns\" as studio\n");
    if (!*im->model) return;
    buf_format(im->text, "\nlet %s = ", im->model);
    value_print_text(im->text, im->options->file);
    buf_add(im->text, "\n");
}

/* Only where the file does not say it itself. */
static void add_unit(Importer *im, NodeText *node)
{
    double said = im->source->unit_m > 0 ? im->source->unit_m : im->scene_m;
    if (fabs(said / im->file_m - 1) < 1e-12) return;
    Buf *out = node_prop(node, "unit");
    for (size_t i = 0; i < COUNT_OF(units); i++)
        if (fabs(units[i].metres / im->file_m - 1) < 1e-12) {
            buf_format(out, "1%s", units[i].name);
            return;
        }
    add_number(out, im->file_m * 1e3); /* inches and feet */
    buf_add(out, "mm");
}

static void write_item(Importer *im, ImportItem *item)
{
    Buf part = {0}, subject = {0};
    const ImportMaterial *material = import_material_of(im, item);
    buf_format(&subject, "object '%s'", item->name ? item->name : "");
    im->subject = buf_text(&subject);
    if (material->clear && !material->thin && !item->closed)
        import_note(
            im,
            "its mesh is not closed (%lu open edges), so nothing can fill it: it is taken as thin. Close it, and "
            "give it an interior",
            (unsigned long)item->n_open_edges);
    im->subject = NULL;
    import_ask_for(im, item, &part);
    NodeText node = node_begin(im, "mesh", item->name);
    if (*im->model)
        node_word(&node, "file", im->model);
    else
        value_print_text(node_prop(&node, "file"), im->options->file);
    if (part.length) node_word(&node, "part", buf_text(&part));
    add_unit(im, &node);
    if (im->options->up_z) node_word(&node, "up", "z");
    if (item->rounded) buf_format(node_prop(&node, "crease"), "%ddeg", IMPORT_CREASE_DEGREES);
    import_add_matter(im, item, &node);
    node_end(&node);
    buf_clear(&part);
    buf_clear(&subject);
    im->out->n_objects++;
}

static void say_what_is_smoothed(Importer *im)
{
    bool rounded = false;
    for (size_t i = 0; i < im->n_items; i++) rounded |= im->items[i].rounded;
    if (rounded)
        import_say(
            im, "The file has no normals: with crease, what looks curved is shaded smoothly across edges that turn by "
                "less. Without it there are facets.");
}

/* A file that is one closed object without a material is likely to become something clear. */
static void say_what_it_could_be(Importer *im)
{
    const ImportItem *item = &im->items[0];
    if (im->n_items > 1 || item->material != IMPORT_NONE) return;
    if (item->closed)
        import_say(
            im,
            "It is closed. To make it of glass: use \"std/media.mns\" as media, and interior = media.clear_glass in "
            "place of surface.");
    else
        import_say(im, "It has %lu open edges, so it cannot be filled with glass; closed, it could.",
                   (unsigned long)item->n_open_edges);
}

static void write_text(Importer *im)
{
    if (im->n_items > 1) {
        char *name = import_name(im, "model", "model", "file");
        if (name && strlen(name) < sizeof im->model) memcpy(im->model, name, strlen(name) + 1);
        free(name);
    }
    import_prepare_materials(im);
    find_floors(im);
    import_choose_lights(im);
    for (size_t i = 0; i < im->n_items; i++) {
        const char *called = *im->items[i].called ? im->items[i].called : im->options->stem;
        im->items[i].name = import_name(im, called, "object", "object");
    }
    write_head(im);
    import_write_materials(im);
    import_begin_section(im, "Objects");
    say_what_it_could_be(im);
    say_what_is_smoothed(im);
    for (size_t i = 0; i < im->n_items; i++) write_item(im, &im->items[i]);
    import_write_lights(im);
    import_write_cameras(im);
}

static void clear(Importer *im)
{
    for (size_t i = 0; i < im->n_items; i++) free(im->items[i].name);
    for (size_t i = 0; im->materials && i <= im->source->n_materials; i++) {
        free(im->materials[i].medium);
        free(im->materials[i].boundary);
        free(im->materials[i].surface);
    }
    for (size_t i = 0; i < im->n_names; i++) free(im->names[i].text);
    free(im->names);
    free(im->items);
    free(im->materials);
    buf_clear(&im->comment);
    buf_clear(&im->lets);
}

Status import_scene(const ImportOptions *options, const MeshSource *source, const Mesh *mesh, Import *out, Error *error)
{
    *out = (Import){.n_notes = 0};
    Importer im = {.options = options, .source = source, .mesh = mesh, .out = out, .error = error, .text = &out->text};
    im.materials = calloc(source->n_materials + 1, sizeof *im.materials);
    Status status = im.materials ? import_list_items(&im) : fail_memory(error, source->n_materials, "a scene");
    if (status == STATUS_OK) status = measure(&im);
    if (status == STATUS_OK) write_text(&im);
    if (status == STATUS_OK && (im.failed || out->text.failed))
        status = fail_memory(error, out->text.length, "a scene");
    clear(&im);
    return status;
}

void import_clear(Import *import)
{
    for (size_t i = 0; i < import->n_pictures; i++) free(import->pictures[i].name);
    for (size_t i = 0; i < import->n_notes; i++) free(import->notes[i]);
    free(import->pictures);
    free(import->notes);
    buf_clear(&import->text);
    *import = (Import){.n_notes = 0};
}

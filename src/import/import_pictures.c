/* import_pictures.c - textures from the pictures of a mesh file: those beside it by their names, those within it under names that
 * they get beside the scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/angle.h"
#include "base/array.h"
#include "base/file.h"
#include "import/import_parts.h"
#include "lang/value.h"

/* The extension that a picture's first bytes ask for; NULL: it is of a kind that cannot be read. */
static const char *extension_of(const char *bytes, size_t length)
{
    if (length > 24 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0) return "png";
    return length > 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0 ? "jpg" : NULL;
}

static bool can_be_read(const char *path)
{
    static const char *const extensions[] = {"png", "jpg", "jpeg", "exr", "hdr"};
    for (size_t i = 0; i < COUNT_OF(extensions); i++)
        if (strcasecmp(file_extension(path), extensions[i]) == 0) return true;
    return false;
}

/* ---- within the file ---- */

/* "drink-label.png": letters, digits, '-' and '_' alone, so that it is a name everywhere. */
static void add_file_name(Buf *out, const Importer *im, const MeshImage *image, const char *extension, unsigned number)
{
    enum { LONGEST = 60 };
    const char *name = file_name(image->name);
    size_t stem = *name ? file_stem_length(name) : 0;
    if (!*name) name = "picture";
    if (stem == 0) stem = strlen(name);
    buf_format(out, "%s-", im->options->stem);
    for (size_t i = 0; i < stem && i < LONGEST; i++) {
        unsigned char c = (unsigned char)name[i];
        buf_add_bytes(out, c < 0x80 && (isalnum(c) || c == '_' || c == '-') ? &name[i] : "_", 1);
    }
    if (number > 1) buf_format(out, "-%u", number);
    buf_format(out, ".%s", extension);
}

static bool is_free_name(const Importer *im, const char *name)
{
    for (size_t i = 0; i < im->out->n_pictures; i++)
        if (strcasecmp(im->out->pictures[i].name, name) == 0) return false;
    return true;
}

/* The name that the scene has for it; NULL after a note. */
static const char *picture_within(Importer *im, uint32_t number)
{
    Import *out = im->out;
    const MeshImage *image = number < im->source->n_images ? &im->source->images[number] : NULL;
    const char *extension = image && image->bytes ? extension_of(image->bytes, image->length) : NULL;
    if (!extension) {
        if (image && image->bytes)
            import_note(im, "one of its pictures is neither a PNG nor a JPEG picture, and is left out: convert it");
        else
            import_note(im, "one of its pictures is not in the file, and is left out");
        return NULL;
    }
    for (size_t i = 0; i < out->n_pictures; i++)
        if (out->pictures[i].bytes == image->bytes) return out->pictures[i].name;
    Buf name = {0};
    for (unsigned n = 1; n == 1 || (name.text && !is_free_name(im, name.text)); n++) {
        buf_clear(&name);
        add_file_name(&name, im, image, extension, n);
    }
    if (name.failed || !ARRAY_ROOM(out->pictures, out->picture_capacity, out->n_pictures)) {
        im->failed = true;
        buf_clear(&name);
        return NULL;
    }
    out->pictures[out->n_pictures++] = (ImportPicture){name.text, image->bytes, image->length};
    return name.text;
}

/* ---- beside the file ---- */

/* The name of the file from the working folder, as it is there, or in the mesh file's own folder whatever folder was said, as the
 * pictures of another machine often are. */
static bool find_beside(const Importer *im, const char *file, Buf *real, const char **found)
{
    for (int i = 0; i < 2; i++) {
        *found = i == 0 ? file : file_name(file);
        buf_clear(real);
        buf_format(real, "%s%s", **found == '/' ? "" : im->options->real_folder, *found);
        if (file_kind(buf_text(real)) == FILE_REGULAR) return true;
    }
    return false;
}

static bool has_stem(const char *name, const char *stem)
{
    size_t n = file_stem_length(name);
    return strlen(stem) == n && strncasecmp(name, stem, n) == 0;
}

/* Adds the name that the scene has for it; nothing after a note. */
static void picture_beside(Importer *im, const char *file, Buf *name)
{
    Buf real = {0}, shown = {0};
    const char *found;
    add_shown(&shown, file);
    if (!can_be_read(file))
        import_note(im, "its picture '%s' is of a kind that cannot be read, and is left out: convert it to PNG",
                    buf_text(&shown));
    else if (!find_beside(im, file, &real, &found))
        import_note(im, "its picture '%s' is not there, and is left out", buf_text(&shown));
    else
        buf_format(name, "%s%s", *found == '/' ? "" : im->options->folder, found);
    if (name->length && has_stem(file_name(name->text), im->options->stem)) im->stem_is_read = true;
    buf_clear(&shown);
    buf_clear(&real);
}

/* ---- textures ---- */

/* As KHR_texture_transform has it, whose v counts downward; a texture is moved, where there its coordinates are. */
static void add_transform(Importer *im, const MeshPicture *picture, Buf *out)
{
    const double most = 1e6; /* what is smaller or larger shows nothing of a picture */
    double sine = sin(picture->turned), cosine = cos(picture->turned);
    const double *scale = picture->scale;
    double x = picture->offset[0] + sine * scale[1], y = 1 - picture->offset[1] - cosine * scale[1];
    bool fine = fabs(x) <= most && fabs(y) <= most;
    for (int i = 0; i < 2; i++) fine = fine && fabs(scale[i]) >= 1 / most && fabs(scale[i]) <= most;
    if (!fine) {
        import_note(im, "its picture is scaled or moved so far that nothing is left of it: this is not taken");
        return;
    }
    if (fabs(x) > 1e-6 || fabs(y) > 1e-6) {
        buf_add(out, "  translate(<");
        add_number(out, -x);
        buf_add(out, ", ");
        add_number(out, -y);
        buf_add(out, ", 0>)");
    }
    if (fabs(picture->turned) > 1e-6) {
        buf_add(out, "  rotate(z, ");
        add_number(out, -picture->turned / MEN_DEGREE);
        buf_add(out, ")");
    }
    if (scale[0] != 1 || scale[1] != 1) {
        buf_add(out, "  scale(<");
        add_number(out, 1 / scale[0]);
        buf_add(out, ", ");
        add_number(out, 1 / scale[1]);
        buf_add(out, ", 1>)");
    }
}

/* Adds the name of the picture's file; nothing after a note. */
static void find_name(Importer *im, const MeshPicture *picture, Buf *name)
{
    if (picture->file) {
        picture_beside(im, picture->file, name);
    } else {
        const char *within = picture_within(im, picture->image);
        if (within) buf_add(name, within);
    }
    if (!name->length || text_is_plain(name->text)) return;
    import_note(im, "the name of its picture is no text in UTF-8, and it is left out: rename it");
    buf_clear(name);
}

/* A long value gets a name, by which it is known from then on. */
static char *named(Importer *im, const char *key, const Buf *text, const Buf *transform)
{
    Buf called = {0};
    buf_format(&called, "%s %s", im->owner, key);
    char *name = import_name(im, buf_text(&called), key, "texture");
    buf_format(&im->lets, "let %s = %s%s%s }\n", name ? name : "", buf_text(text), transform->length ? "\n " : "",
               buf_text(transform));
    buf_clear(&called);
    return name;
}

char *import_picture(Importer *im, const MeshPicture *picture, const char *key, const char *props)
{
    enum { LONGEST = 72 };
    Buf name = {0}, text = {0}, transform = {0};
    find_name(im, picture, &name);
    if (!name.length) return NULL;
    if (picture->second_uvs)
        import_note(im, "its picture lies on coordinates of their own in the file, and on the first ones here");
    if (picture->other_wrap_upward)
        import_note(
            im, "beyond its edges its picture goes on in another way upwards than to the sides: here as to the sides");
    buf_add(&text, "image { file = ");
    value_print_text(&text, name.text);
    if (picture->wrap == PICTURE_WRAP_CLAMP) buf_add(&text, "  wrap = clamp");
    if (picture->wrap == PICTURE_WRAP_MIRROR) buf_add(&text, "  wrap = mirror");
    buf_add(&text, props);
    add_transform(im, picture, &transform);
    im->failed |= text.failed || transform.failed;
    if (text.length + transform.length > LONGEST) {
        char *value = named(im, key, &text, &transform);
        buf_clear(&text);
        text.text = value;
    } else {
        buf_format(&text, "%s }", buf_text(&transform));
    }
    buf_clear(&name);
    buf_clear(&transform);
    return text.text;
}

/* ---- alpha ---- */

/* Of the first bytes of a PNG picture: the colour type has it, or a chunk before the pixels. */
static bool png_has_alpha(const char *bytes, size_t length)
{
    enum { COLOR_TYPE = 25, ALPHA = 4, FIRST_CHUNK = 33, MOST_BYTES = 65536 };
    if (length <= FIRST_CHUNK || !extension_of(bytes, length) || strcmp(extension_of(bytes, length), "png") != 0)
        return false;
    if (bytes[COLOR_TYPE] & ALPHA) return true;
    for (size_t i = FIRST_CHUNK; i + 4 < length && i < MOST_BYTES; i++) {
        if (memcmp(bytes + i, "tRNS", 4) == 0) return true;
        if (memcmp(bytes + i, "IDAT", 4) == 0) return false;
    }
    return false;
}

bool import_picture_has_alpha(const Importer *im, const MeshPicture *picture)
{
    enum { MOST_BYTES = 1 << 28 };
    if (!picture->file) {
        const MeshImage *image = picture->image < im->source->n_images ? &im->source->images[picture->image] : NULL;
        return image && image->bytes && png_has_alpha(image->bytes, image->length);
    }
    Buf real = {0};
    const char *found;
    char *bytes = NULL;
    size_t length;
    Error unused;
    bool alpha = false;
    if (strcasecmp(file_extension(picture->file), "png") == 0 && find_beside(im, picture->file, &real, &found) &&
        file_read(buf_text(&real), MOST_BYTES, &bytes, &length, &unused) == STATUS_OK)
        alpha = png_has_alpha(bytes, length);
    free(bytes);
    buf_clear(&real);
    return alpha;
}

/* exr_attributes.c - the attributes of EXR files, as text.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/buf.h"
#include "base/num.h"
#include "image/exr_parts.h"

/* The shortest text that reads back as the same float: 0.1, not 0.100000001. */
static void print_floats(Buf *text, const float *numbers, int n)
{
    for (int i = 0; i < n; i++) {
        char digits[40];
        double value = 0;
        for (int precision = 6; precision <= 9; precision++) {
            int length = snprintf(digits, sizeof digits, "%.*g", precision, (double)numbers[i]);
            if (num_parse(digits, (size_t)length, &value) && (float)value == numbers[i]) break;
        }
        buf_format(text, "%s%s", i ? " " : "", digits);
    }
}

static void print_doubles(Buf *text, const double *numbers, int n)
{
    char digits[NUM_TEXT_SIZE];
    for (int i = 0; i < n; i++) {
        num_print(numbers[i], digits);
        buf_format(text, "%s%s", i ? " " : "", digits);
    }
}

static void print_channels(Buf *text, const exr_attr_chlist_t *channels)
{
    static const char *const types[] = {"uint", "half", "float"};
    for (int i = 0; i < channels->num_channels; i++) {
        const exr_attr_chlist_entry_t *channel = &channels->entries[i];
        buf_format(text, "%s%s %s", i ? ", " : "", channel->name.str,
                   (unsigned)channel->pixel_type < COUNT_OF(types) ? types[channel->pixel_type] : "unknown");
    }
}

static const char *enumerated(unsigned value, const char *const *names, size_t n)
{
    return value < n ? names[value] : "unknown";
}

/* The compound types; false for those that have no short text. */
static bool print_compound(Buf *text, const exr_attribute_t *attribute)
{
    switch (attribute->type) {
    case EXR_ATTR_BOX2I:
        buf_format(text, "%ld %ld  %ld %ld", (long)attribute->box2i->min.x, (long)attribute->box2i->min.y,
                   (long)attribute->box2i->max.x, (long)attribute->box2i->max.y);
        return true;
    case EXR_ATTR_BOX2F:
        print_floats(text, attribute->box2f->min.arr, 2);
        buf_add(text, "  ");
        print_floats(text, attribute->box2f->max.arr, 2);
        return true;
    case EXR_ATTR_CHLIST: print_channels(text, attribute->chlist); return true;
    case EXR_ATTR_CHROMATICITIES: {
        const exr_attr_chromaticities_t *c = attribute->chromaticities;
        const float xy[8] = {c->red_x, c->red_y, c->green_x, c->green_y, c->blue_x, c->blue_y, c->white_x, c->white_y};
        print_floats(text, xy, 8);
        return true;
    }
    case EXR_ATTR_V2I: buf_format(text, "%ld %ld", (long)attribute->v2i->x, (long)attribute->v2i->y); return true;
    case EXR_ATTR_V3I:
        buf_format(text, "%ld %ld %ld", (long)attribute->v3i->x, (long)attribute->v3i->y, (long)attribute->v3i->z);
        return true;
    case EXR_ATTR_V2F: print_floats(text, attribute->v2f->arr, 2); return true;
    case EXR_ATTR_V3F: print_floats(text, attribute->v3f->arr, 3); return true;
    case EXR_ATTR_V2D: print_doubles(text, attribute->v2d->arr, 2); return true;
    case EXR_ATTR_V3D: print_doubles(text, attribute->v3d->arr, 3); return true;
    case EXR_ATTR_M33F: print_floats(text, attribute->m33f->m, 9); return true;
    case EXR_ATTR_M44F: print_floats(text, attribute->m44f->m, 16); return true;
    case EXR_ATTR_RATIONAL:
        buf_format(text, "%ld/%lu", (long)attribute->rational->num, (unsigned long)attribute->rational->denom);
        return true;
    default: return false;
    }
}

static void print_attribute(Buf *text, const exr_attribute_t *attribute)
{
    static const char *const compressions[] = {"none",  "rle", "zips", "zip",  "piz",
                                               "pxr24", "b44", "b44a", "dwaa", "dwab"};
    static const char *const orders[] = {"increasing y", "decreasing y", "random"};
    static const char *const maps[] = {"latlong", "cube"};
    switch (attribute->type) {
    case EXR_ATTR_STRING:
        if (attribute->string->length > 0)
            buf_add_bytes(text, attribute->string->str, (size_t)attribute->string->length);
        return;
    case EXR_ATTR_INT: buf_format(text, "%ld", (long)attribute->i); return;
    case EXR_ATTR_FLOAT: print_floats(text, &attribute->f, 1); return;
    case EXR_ATTR_DOUBLE: print_doubles(text, &attribute->d, 1); return;
    case EXR_ATTR_COMPRESSION: buf_add(text, enumerated(attribute->uc, compressions, COUNT_OF(compressions))); return;
    case EXR_ATTR_LINEORDER: buf_add(text, enumerated(attribute->uc, orders, COUNT_OF(orders))); return;
    case EXR_ATTR_ENVMAP: buf_add(text, enumerated(attribute->uc, maps, COUNT_OF(maps))); return;
    default:
        if (!print_compound(text, attribute)) buf_format(text, "(%s)", attribute->type_name);
        return;
    }
}

static bool has_text(const exr_attribute_t *attribute)
{
    return attribute->type == EXR_ATTR_STRING || attribute->type == EXR_ATTR_INT || attribute->type == EXR_ATTR_FLOAT ||
           attribute->type == EXR_ATTR_DOUBLE;
}

Status exr_read_attribute(const char *path, const char *name, char **text, Error *error)
{
    *text = NULL;
    ExrFile file;
    Status status = exr_file_open(path, &file, error);
    const exr_attribute_t *attribute;
    if (status == STATUS_OK && exr_get_attribute_by_name(file.context, 0, name, &attribute) == EXR_ERR_SUCCESS &&
        has_text(attribute)) {
        Buf buf = {0};
        buf_add(&buf, ""); /* an empty text is not the same as none */
        print_attribute(&buf, attribute);
        if (buf.failed) {
            buf_clear(&buf);
            status = fail_memory(error, buf.capacity, "an attribute");
        }
        *text = buf.text;
    }
    exr_file_close(&file);
    return status;
}

/* One attribute, and its text. */
typedef void Each(void *context, const exr_attribute_t *attribute, const char *text);

/* All of the first part, in the file's order; STATUS_INPUT, when all are visited, for a file that is cut short. */
static Status visit_all(const char *path, Each *each, void *context, Error *error)
{
    ExrFile file;
    Status status = exr_file_open(path, &file, error);
    int32_t n = 0;
    if (status == STATUS_OK && exr_get_attribute_count(file.context, 0, &n) != EXR_ERR_SUCCESS) n = 0;
    for (int32_t i = 0; status == STATUS_OK && i < n; i++) {
        const exr_attribute_t *attribute;
        if (exr_get_attribute_by_index(file.context, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute) != EXR_ERR_SUCCESS)
            continue;
        Buf buf = {0};
        print_attribute(&buf, attribute);
        if (buf.failed)
            status = fail_memory(error, buf.capacity, "an attribute");
        else
            each(context, attribute, buf_text(&buf));
        buf_clear(&buf);
    }
    if (status == STATUS_OK) status = exr_file_check_whole(&file, error);
    exr_file_close(&file);
    return status;
}

/* Whom the two functions below visit for. */
typedef struct Visitor {
    void (*text)(void *context, const char *name, const char *text);
    void (*own)(void *context, const ImageAttribute *attribute);
    void *context;
} Visitor;

static void give_text(void *context, const exr_attribute_t *attribute, const char *text)
{
    const Visitor *visitor = context;
    visitor->text(visitor->context, attribute->name, text);
}

Status exr_visit_attributes(const char *path, void (*visit)(void *context, const char *name, const char *text),
                            void *context, Error *error)
{
    Visitor visitor = {.text = visit, .context = context};
    return visit_all(path, give_text, &visitor, error);
}

static bool is_own(const exr_attribute_t *attribute)
{
    static const char *const of_all[] = {"type", "name", "pixelAspectRatio", "screenWindowWidth"};
    for (size_t i = 0; i < COUNT_OF(of_all); i++)
        if (strcmp(attribute->name, of_all[i]) == 0) return false;
    return has_text(attribute);
}

static void give_own(void *context, const exr_attribute_t *attribute, const char *text)
{
    const Visitor *visitor = context;
    ImageAttribute own = {.name = attribute->name};
    if (!is_own(attribute)) return;
    switch (attribute->type) {
    case EXR_ATTR_INT:
        own.type = ATTRIBUTE_INT;
        own.whole = attribute->i;
        break;
    case EXR_ATTR_FLOAT:
    case EXR_ATTR_DOUBLE:
        own.type = ATTRIBUTE_FLOAT;
        own.number = attribute->type == EXR_ATTR_DOUBLE ? attribute->d : (double)attribute->f;
        break;
    default: own.text = text; break;
    }
    visitor->own(visitor->context, &own);
}

Status exr_visit_own_attributes(const char *path, void (*visit)(void *context, const ImageAttribute *attribute),
                                void *context, Error *error)
{
    Visitor visitor = {.own = visit, .context = context};
    return visit_all(path, give_own, &visitor, error);
}

/* merge_tiles.c - which pixels parts of a picture have, and what their files say of the whole.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/merge_tiles.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What one part says, and which that the first one says otherwise. */
typedef struct Tile {
    Tiles *tiles;
    uint32_t crop[4]; /* 0: it does not say */
    bool first, has_crop, has_state;
    char differs[IMAGE_NAME_SIZE]; /* the name of an attribute that is to be the same in all, and is not; "": none */
} Tile;

/* Of these there is one in a picture. */
static const char *const common[] = {"meniscus/sceneHash", "meniscus/camera", "meniscus/frame", "meniscus/nesting"};
/* These are not of the whole. */
static const char *const of_parts[] = {TILE_ATTRIBUTE, "meniscus/noise", "meniscus/lightSpread",
                                       "meniscus/meanSamples"};
static const char *const counts[] = {"meniscus/crossings", "meniscus/nestingFaults"};

static bool is_one_of(const char *name, const char *const *names, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(name, names[i]) == 0) return true;
    return false;
}

static bool is_same(const ImageAttribute *a, const ImageAttribute *b)
{
    if (a->type != b->type || a->whole != b->whole) return false;
    return a->type != ATTRIBUTE_TEXT || strcmp(a->text, b->text) == 0;
}

/* What tells a part from a whole picture and from a slice. */
static void visit_kind(void *context, const ImageAttribute *attribute)
{
    Tile *tile = context;
    uint32_t *c = tile->crop;
    if (strcmp(attribute->name, CHECKPOINT_ATTRIBUTE) == 0) tile->has_state = true;
    if (strcmp(attribute->name, TILE_ATTRIBUTE) != 0) return;
    tile->has_crop = true;
    if (!attribute->text || sscanf(attribute->text, "%u,%u,%u,%u", &c[0], &c[1], &c[2], &c[3]) != 4) c[2] = 0;
}

bool tile_is(const char *path)
{
    Error error;
    Tile tile = {.first = true};
    return strcmp(path, "-") != 0 && exr_visit_own_attributes(path, visit_kind, &tile, &error) == STATUS_OK &&
           tile.has_crop && !tile.has_state;
}

static void visit(void *context, const ImageAttribute *attribute)
{
    Tile *tile = context;
    Tiles *tiles = tile->tiles;
    const char *name = attribute->name;
    visit_kind(context, attribute);
    for (size_t i = 0; i < COUNT_OF(counts); i++)
        if (strcmp(name, counts[i]) == 0 && attribute->text) tiles->counts[i] += strtoull(attribute->text, NULL, 10);
    if (is_one_of(name, of_parts, COUNT_OF(of_parts))) return;
    if (tile->first) {
        attributes_add(&tiles->attributes, attribute);
        return;
    }
    ImageAttribute *whole = attributes_find(&tiles->attributes, name);
    if (whole && strcmp(name, "meniscus/samples") == 0 && attribute->whole < whole->whole)
        whole->whole = attribute->whole;
    if (is_one_of(name, common, COUNT_OF(common)) && !(whole && is_same(whole, attribute)))
        snprintf(tile->differs, sizeof tile->differs, "%s", name);
}

/* Whether a part has the size and the channels of the whole. */
static bool is_alike(const Image *a, const Image *b, const ImagePlace *place)
{
    bool alike = a->width == place->width && a->height == place->height && a->n_channels == b->n_channels;
    for (uint32_t i = 0; alike && i < a->n_channels; i++) alike = strcmp(a->names[i], b->names[i]) == 0;
    return alike;
}

/* Black, and nothing covered. */
static Status begin(Tiles *tiles, const Image *part, const ImagePlace *place, Error *error)
{
    const size_t n = (size_t)place->width * place->height;
    tiles->covered = calloc(n, sizeof *tiles->covered);
    if (!tiles->covered) return fail_memory(error, n, "which pixels there are");
    return image_new_like(part, place->width, place->height, &tiles->image, error);
}

static void paste(Tiles *tiles, const Image *part, const ImagePlace *place, const uint32_t crop[4])
{
    for (uint32_t y = crop[1]; y < crop[3]; y++)
        for (uint32_t x = crop[0]; x < crop[2]; x++) {
            bool *covered = &tiles->covered[(size_t)y * place->width + x];
            if (!*covered)
                memcpy(image_at(&tiles->image, x, y), image_at(part, x - place->x, y - place->y),
                       part->n_channels * sizeof(float));
            *covered = true;
        }
}

static Status read_tile(const char *const *paths, size_t number, Tiles *tiles, Image *part, Error *error)
{
    const char *path = paths[number];
    Tile tile = {.tiles = tiles, .first = number == 0};
    TRY(exr_visit_own_attributes(path, visit, &tile, error));
    if (!tile.has_crop || tile.has_state)
        return fail(error, STATUS_INPUT, "'%s' is not a part of a picture by 'render --crop', as '%s' is", path,
                    paths[0]);
    ImagePlace place;
    TRY(exr_read_part(path, part, &place, error));
    const uint32_t *c = tile.crop;
    if (c[0] >= c[2] || c[1] >= c[3] || c[0] < place.x || c[1] < place.y || c[2] - place.x > part->width ||
        c[3] - place.y > part->height)
        return fail(error, STATUS_INPUT, "'%s' does not say which part of its picture it is", path);
    if (tile.differs[0])
        return fail(error, STATUS_INPUT, "'%s' and '%s' are not of one picture, as there differs: %s", paths[0], path,
                    tile.differs);
    if (number == 0) TRY(begin(tiles, part, &place, error));
    if (!is_alike(&tiles->image, part, &place))
        return fail(error, STATUS_INPUT, "'%s' and '%s' are not of one picture: they differ in size, or in channels",
                    paths[0], path);
    paste(tiles, part, &place, c);
    return STATUS_OK;
}

Status tiles_read(const char *const *paths, size_t n, Tiles *tiles, Error *error)
{
    *tiles = (Tiles){.covered = NULL};
    Status status = STATUS_OK;
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        Image part = {0};
        status = read_tile(paths, i, tiles, &part, error);
        image_clear(&part);
    }
    for (size_t i = 0; i < COUNT_OF(counts); i++) attributes_set_count(&tiles->attributes, counts[i], tiles->counts[i]);
    return status;
}

bool tiles_take_gap(Tiles *tiles, uint32_t gap[4])
{
    const uint32_t width = tiles->image.width, height = tiles->image.height;
    size_t at = 0, n = (size_t)width * height;
    while (at < n && tiles->covered[at]) at++;
    if (at == n) return false;
    uint32_t x0 = (uint32_t)(at % width), y0 = (uint32_t)(at / width), x1 = x0, y1 = y0;
    while (x1 < width && !tiles->covered[(size_t)y0 * width + x1]) x1++;
    for (bool free_row = true; free_row && y1 < height; y1 += free_row)
        for (uint32_t x = x0; free_row && x < x1; x++) free_row = !tiles->covered[(size_t)y1 * width + x];
    for (uint32_t y = y0; y < y1; y++) memset(tiles->covered + (size_t)y * width + x0, true, x1 - x0);
    gap[0] = x0;
    gap[1] = y0;
    gap[2] = x1;
    gap[3] = y1;
    return true;
}

void tiles_clear(Tiles *tiles)
{
    attributes_clear(&tiles->attributes);
    image_clear(&tiles->image);
    free(tiles->covered);
    *tiles = (Tiles){.covered = NULL};
}

/* nanovdb.c - reads NanoVDB files: the only file that knows their format.
 *
 * A file is a row of segments: a header, what its grids are called and how long they are, and the grids themselves,
 * whose bytes are as they lie in memory: a root, two levels of inner nodes and leaves of 8 x 8 x 8 values, which refer to
 * each other by distances in bytes. Nothing in a file is taken on trust: lengths are held against what there is before
 * anything is allocated, and all that is read of a grid goes through PNanoVDB with its checks of bounds, which read
 * zeros beyond the end.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/nanovdb.h"

#include <blosc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define PNANOVDB_C
#define PNANOVDB_BUF_BOUNDS_CHECK
#include <nanovdb/PNanoVDB.h>

#include "base/file.h"

/* "NanoVDB0"; files and grids of later minor versions say "NanoVDB2" and "NanoVDB1". */
static const char file_magics[2][9] = {"NanoVDB0", "NanoVDB2"};
static const char grid_magics[2][9] = {"NanoVDB0", "NanoVDB1"};

enum { HEADER_BYTES = 16, META_BYTES = 176, MAJOR_VERSION = 32, TILES_MOST = 1000 };
static const double MOST_WORK = 4e9;
enum { CODEC_NONE, CODEC_ZIP, CODEC_BLOSC };

/* What a segment says of a grid. */
typedef struct GridEntry {
    const char *name;
    size_t name_length;
    uint64_t grid_bytes, file_bytes; /* in memory, in the file */
    uint16_t codec;
    const unsigned char *meta, *payload;
} GridEntry;

typedef struct Reader {
    const char *path;
    const unsigned char *bytes;
    size_t length;
    size_t most_bytes;
    Error *error;
} Reader;

static uint64_t number_at(const unsigned char *bytes, size_t n)
{
    uint64_t number = 0;
    for (size_t i = n; i-- > 0;) number = number << 8 | bytes[i];
    return number;
}

static Status broken(const Reader *r, const char *how)
{
    return fail(r->error, STATUS_INPUT, "'%s' is broken: %s", r->path, how);
}

/* ---- what is in the file ---- */

typedef void EntryVisitor(void *context, const GridEntry *entry);

static Status read_entry(const Reader *r, size_t *at, uint16_t codec, GridEntry *entry)
{
    if (r->length - *at < META_BYTES) return broken(r, "it ends within the list of its grids");
    const unsigned char *meta = r->bytes + *at;
    *entry = (GridEntry){
        .grid_bytes = number_at(meta, 8), .file_bytes = number_at(meta + 8, 8), .codec = codec, .meta = meta};
    uint32_t name_bytes = (uint32_t)number_at(meta + 136, 4);
    *at += META_BYTES;
    if (name_bytes > r->length - *at) return broken(r, "it ends within the name of a grid");
    entry->name = (const char *)r->bytes + *at;
    const char *end = memchr(entry->name, 0, name_bytes);
    entry->name_length = end ? (size_t)(end - entry->name) : name_bytes;
    *at += name_bytes;
    return STATUS_OK;
}

static Status check_header(const Reader *r, size_t at)
{
    const unsigned char *header = r->bytes + at;
    if (r->length - at < HEADER_BYTES) return broken(r, "it ends within a header");
    if (memcmp(header, file_magics[0], 8) != 0 && memcmp(header, file_magics[1], 8) != 0) {
        if (at) return broken(r, "something that is no grid follows its grids");
        return fail(r->error, STATUS_INPUT, "'%s' is no NanoVDB file", r->path);
    }
    uint32_t version = (uint32_t)number_at(header + 8, 4);
    if (version >> 21 != MAJOR_VERSION)
        return fail(r->error, STATUS_INPUT, "'%s' is of version %u of NanoVDB's format, and %d is what can be read",
                    r->path, (unsigned)(version >> 21), (int)MAJOR_VERSION);
    return STATUS_OK;
}

/* Visits the grids of all segments of the file. */
static Status visit_entries(const Reader *r, EntryVisitor *visit, void *context)
{
    for (size_t at = 0; at < r->length;) {
        TRY(check_header(r, at));
        size_t n_grids = (size_t)number_at(r->bytes + at + 12, 2);
        uint16_t codec = (uint16_t)number_at(r->bytes + at + 14, 2);
        size_t list = at += HEADER_BYTES;
        GridEntry entry;
        for (size_t i = 0; i < n_grids; i++) TRY(read_entry(r, &at, codec, &entry)); /* at: the first payload */
        for (size_t i = 0; i < n_grids; i++) {
            TRY(read_entry(r, &list, codec, &entry));
            if (entry.file_bytes > r->length - at) return broken(r, "it ends within a grid");
            entry.payload = r->bytes + at;
            at += (size_t)entry.file_bytes;
            visit(context, &entry);
        }
    }
    return STATUS_OK;
}

typedef struct Search {
    const char *wanted; /* NULL: any */
    GridEntry found;
    size_t n_found, n_listed;
    char names[600];
} Search;

static void look(void *context, const GridEntry *entry)
{
    Search *search = context;
    size_t used = strlen(search->names), room = sizeof search->names - used;
    if (search->n_listed++ < 12 && entry->name_length + 8 < room) {
        char *to = search->names + used;
        if (used) *to++ = ',', *to++ = ' ';
        *to++ = '\'';
        for (size_t i = 0; i < entry->name_length; i++)
            *to++ = (unsigned char)entry->name[i] < ' ' ? '?' : entry->name[i];
        *to++ = '\'';
        *to = 0;
    } else if (room > 5 && (used < 3 || strcmp(search->names + used - 3, "...") != 0)) {
        memcpy(search->names + used, " ...", 5);
    }
    bool named = search->wanted && strlen(search->wanted) == entry->name_length &&
                 memcmp(search->wanted, entry->name, entry->name_length) == 0;
    if (search->wanted && !named) return;
    if (search->n_found++ == 0) search->found = *entry;
}

static Status find_grid(const Reader *r, const char *wanted, GridEntry *entry)
{
    Search search = {.wanted = wanted};
    TRY(visit_entries(r, look, &search));
    if (!search.n_listed) return fail(r->error, STATUS_INPUT, "'%s' holds no grids", r->path);
    if (!search.n_found)
        return fail(r->error, STATUS_INPUT, "'%s' has no grid '%s'; it has %s", r->path, wanted, search.names);
    if (search.n_found > 1 && !wanted)
        return fail(r->error, STATUS_INPUT, "'%s' has several grids, so name one of them: %s", r->path, search.names);
    *entry = search.found;
    return STATUS_OK;
}

/* ---- unpacking ---- */

static Status unpack_zip(const Reader *r, const GridEntry *entry, unsigned char *grid)
{
    if (entry->file_bytes < 8 || number_at(entry->payload, 8) > entry->file_bytes - 8)
        return broken(r, "a ZIP stream is longer than its grid");
    uLongf length = (uLongf)entry->grid_bytes;
    int result = uncompress(grid, &length, entry->payload + 8, (uLong)number_at(entry->payload, 8));
    return result == Z_OK && length == entry->grid_bytes ? STATUS_OK : broken(r, "a ZIP stream cannot be unpacked");
}

static Status unpack_blosc(const Reader *r, const GridEntry *entry, unsigned char *grid)
{
    uint64_t at = 0, done = 0;
    while (done < entry->grid_bytes) {
        if (entry->file_bytes - at < 8 + BLOSC_MIN_HEADER_LENGTH) return broken(r, "a BLOSC chunk is cut off");
        uint64_t bytes = number_at(entry->payload + at, 8);
        const unsigned char *chunk = entry->payload + at + 8;
        size_t unpacked = 0;
        if (bytes < BLOSC_MIN_HEADER_LENGTH || bytes > entry->file_bytes - at - 8 ||
            blosc_cbuffer_validate(chunk, (size_t)bytes, &unpacked) < 0 || !unpacked ||
            unpacked > entry->grid_bytes - done)
            return broken(r, "a BLOSC chunk is not as long as it says");
        if (blosc_decompress_ctx(chunk, grid + done, unpacked, 1) != (int)unpacked)
            return broken(r, "a BLOSC chunk cannot be unpacked");
        done += unpacked;
        at += 8 + bytes;
    }
    return STATUS_OK;
}

/* The grid as it lies in memory, aligned for PNanoVDB; free() it. */
static Status unpack(const Reader *r, const GridEntry *entry, uint32_t **grid)
{
    /* no codec makes more than this of a byte; DEFLATE's most is 1032 */
    const uint64_t most_ratio = 4096;
    if (entry->grid_bytes < PNANOVDB_GRID_SIZE || entry->grid_bytes / most_ratio > entry->file_bytes)
        return broken(r, "a grid is not as long as it says");
    if (entry->codec == CODEC_NONE && entry->grid_bytes != entry->file_bytes)
        return broken(r, "a grid is not as long as it says");
    if (entry->codec > CODEC_BLOSC)
        return fail(r->error, STATUS_INPUT, "'%s' is compressed in a way that is not known, number %u", r->path,
                    (unsigned)entry->codec);
    if (entry->grid_bytes > r->most_bytes)
        return fail(r->error, STATUS_NOMEM, "a grid of '%s' takes %.0f MB of memory, and %.0f MB is what it may have",
                    r->path, (double)entry->grid_bytes / 1e6, (double)r->most_bytes / 1e6);
    *grid = malloc((size_t)entry->grid_bytes + 8);
    if (!*grid) return fail_memory(r->error, (size_t)entry->grid_bytes, "a grid");
    unsigned char *bytes = (unsigned char *)*grid;
    Status status = STATUS_OK;
    if (entry->codec == CODEC_NONE)
        memcpy(bytes, entry->payload, (size_t)entry->grid_bytes);
    else
        status = entry->codec == CODEC_ZIP ? unpack_zip(r, entry, bytes) : unpack_blosc(r, entry, bytes);
    if (status != STATUS_OK) {
        free(*grid);
        *grid = NULL;
    }
    return status;
}

/* ---- values ---- */

typedef struct Grid {
    const Reader *reader;
    const char *name;
    size_t name_length;
    pnanovdb_buf_t buf;
    pnanovdb_grid_handle_t grid;
    pnanovdb_root_handle_t root;
    pnanovdb_grid_type_t type;
    int32_t first[3]; /* voxel of the lattice's origin */
    pnanovdb_readaccessor_t accessor;
    bool bad_bits;
} Grid;

static float read_value(Grid *g, pnanovdb_address_t address, const pnanovdb_coord_t *ijk, pnanovdb_uint32_t level)
{
    switch (g->type) {
    case PNANOVDB_GRID_TYPE_DOUBLE: return (float)pnanovdb_read_double(g->buf, address);
    case PNANOVDB_GRID_TYPE_FP4: return pnanovdb_root_fp4_read_float(g->buf, address, ijk, level);
    case PNANOVDB_GRID_TYPE_FP8: return pnanovdb_root_fp8_read_float(g->buf, address, ijk, level);
    case PNANOVDB_GRID_TYPE_FP16: return pnanovdb_root_fp16_read_float(g->buf, address, ijk, level);
    case PNANOVDB_GRID_TYPE_FPN:
        /* the number of bits is the file's to say */
        if (level == 0 && pnanovdb_read_uint32(g->buf, pnanovdb_address_offset_neg(
                                                           address, PNANOVDB_LEAF_TABLE_NEG_OFF_BBOX_DIF_AND_FLAGS)) >>
                              29 > 4) {
            g->bad_bits = true;
            return 0;
        }
        return pnanovdb_root_fpn_read_float(g->buf, address, ijk, level);
    default: return pnanovdb_read_float(g->buf, address);
    }
}

static float value_of(Grid *g, int32_t x, int32_t y, int32_t z, pnanovdb_uint32_t *level)
{
    const pnanovdb_coord_t ijk = {x, y, z};
    pnanovdb_address_t address =
        pnanovdb_readaccessor_get_value_address_and_level(g->type, g->buf, &g->accessor, &ijk, level);
    return read_value(g, address, &ijk, *level);
}

static Status refuse_value(const Grid *g, float value, const int32_t at[3], Error *error)
{
    return fail(error, STATUS_INPUT, "grid '%.*s' of '%s' is %g at voxel %d, %d, %d: values must be 0 or more",
                (int)g->name_length, g->name, g->reader->path, (double)value, (int)at[0], (int)at[1], (int)at[2]);
}

/* Whether no leaf reaches into the brick, whose values then are those of at most eight tiles: *value is that of all if
 * they are alike. */
static bool is_uniform(Grid *g, const int32_t voxel[3], float *value)
{
    for (int corner = 0; corner < 8; corner++) {
        pnanovdb_uint32_t level;
        float here = value_of(g, voxel[0] + (corner & 1) * VOLUME_BRICK, voxel[1] + (corner >> 1 & 1) * VOLUME_BRICK,
                              voxel[2] + (corner >> 2) * VOLUME_BRICK, &level);
        if (level == 0 || (corner && here != *value)) return false;
        *value = here;
    }
    return true;
}

static Status fill_brick(void *context, const int32_t first[3], float values[VOLUME_BRICK_VALUES], bool *uniform,
                         Error *error)
{
    Grid *g = context;
    int32_t voxel[3];
    for (int axis = 0; axis < 3; axis++) voxel[axis] = g->first[axis] + first[axis];
    *uniform = is_uniform(g, voxel, &values[0]);
    if (*uniform) return values[0] >= 0 && isfinite(values[0]) ? STATUS_OK : refuse_value(g, values[0], voxel, error);
    size_t n = 0;
    for (int32_t k = 0; k < VOLUME_EDGE; k++)
        for (int32_t j = 0; j < VOLUME_EDGE; j++)
            for (int32_t i = 0; i < VOLUME_EDGE; i++) {
                const int32_t at[3] = {voxel[0] + i, voxel[1] + j, voxel[2] + k};
                pnanovdb_uint32_t level;
                float value = value_of(g, at[0], at[1], at[2], &level);
                if (!(value >= 0) || !isfinite(value)) return refuse_value(g, value, at, error);
                values[n++] = value;
            }
    return g->bad_bits ? broken(g->reader, "a leaf has values of an unknown number of bits") : STATUS_OK;
}

/* Of those with single numbers. */
static bool is_readable(uint32_t type)
{
    return type == PNANOVDB_GRID_TYPE_FLOAT || type == PNANOVDB_GRID_TYPE_DOUBLE ||
           (type >= PNANOVDB_GRID_TYPE_FP4 && type <= PNANOVDB_GRID_TYPE_FPN);
}

static Status check_type(const Reader *r, const GridEntry *entry, const Grid *g)
{
    if (!is_readable(g->type))
        return fail(r->error, STATUS_INPUT,
                    "grid '%.*s' of '%s' holds no single numbers (float, double, Fp4, Fp8, Fp16, FpN)",
                    (int)entry->name_length, entry->name, r->path);
    if (pnanovdb_grid_get_grid_class(g->buf, g->grid) == PNANOVDB_GRID_CLASS_LEVEL_SET)
        return fail(r->error, STATUS_INPUT,
                    "grid '%.*s' of '%s' is a level set: it holds distances from a surface, and no density; vdb_tool "
                    "-sdf2fog makes one of it",
                    (int)entry->name_length, entry->name, r->path);
    return STATUS_OK;
}

/* The tree within the unpacked bytes. */
static Status open_grid(const Reader *r, const GridEntry *entry, uint32_t *bytes, Grid *g)
{
    *g = (Grid){.reader = r, .name = entry->name, .name_length = entry->name_length};
    g->buf = pnanovdb_make_buf(bytes, entry->grid_bytes / sizeof *bytes);
    if (memcmp(bytes, grid_magics[0], 8) != 0 && memcmp(bytes, grid_magics[1], 8) != 0)
        return broken(r, "a grid does not begin as grids do");
    if (pnanovdb_grid_get_version(g->buf, g->grid) >> 21 != MAJOR_VERSION)
        return broken(r, "a grid is of another version than its file");
    g->type = pnanovdb_grid_get_grid_type(g->buf, g->grid);
    TRY(check_type(r, entry, g));
    g->root = pnanovdb_tree_get_root(g->buf, pnanovdb_grid_get_tree(g->buf, g->grid));
    if (g->root.address.byte_offset >= entry->grid_bytes) return broken(r, "a tree has no root");
    if (pnanovdb_root_get_tile_count(g->buf, g->root) > TILES_MOST) return broken(r, "a root has too many tiles");
    pnanovdb_readaccessor_init(&g->accessor, g->root);
    return STATUS_OK;
}

/* From the file's own lengths to voxels: the inverse of its map. */
static Status map_of(const Reader *r, const Grid *g, Affine *to_voxels)
{
    pnanovdb_map_handle_t map = pnanovdb_grid_get_map(g->buf, g->grid);
    Affine to_world;
    for (unsigned i = 0; i < 9; i++) to_world.m[i / 3][i % 3] = pnanovdb_map_get_matd(g->buf, map, i);
    to_world.t = vec3(pnanovdb_map_get_vecd(g->buf, map, 0), pnanovdb_map_get_vecd(g->buf, map, 1),
                      pnanovdb_map_get_vecd(g->buf, map, 2));
    bool finite = vec3_is_finite(to_world.t);
    for (int i = 0; i < 9; i++) finite = finite && isfinite(to_world.m[i / 3][i % 3]);
    if (!finite || !affine_invert(&to_world, to_voxels) || !vec3_is_finite(to_voxels->t))
        return broken(r, "the map of a grid flattens it, or is not finite");
    return STATUS_OK;
}

/* Whole bricks around everything that is not the background, and the voxels around that, to which values fall off. */
static Status bricks_around(const Reader *r, const Grid *g, int32_t first[3], int32_t n_points[3])
{
    pnanovdb_coord_t low = pnanovdb_root_get_bbox_min(g->buf, g->root),
                     high = pnanovdb_root_get_bbox_max(g->buf, g->root);
    const int64_t lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
    for (int axis = 0; axis < 3; axis++) {
        const int64_t reach = 1 << 29, size = VOLUME_BRICK;
        if (lows[axis] > highs[axis])
            return fail(r->error, STATUS_INPUT, "grid '%.*s' of '%s' is empty", (int)g->name_length, g->name, r->path);
        if (lows[axis] < -reach || highs[axis] > reach) return broken(r, "a grid is larger than voxels can be counted");
        int64_t from = lows[axis] - 1, to = highs[axis] + 1;
        from = (from >= 0 ? from : from - (size - 1)) / size * size;
        first[axis] = (int32_t)from;
        n_points[axis] = (int32_t)((to - from + size - 1) / size * size + 1);
    }
    return STATUS_OK;
}

static Status make_volume(const Reader *r, const GridEntry *entry, uint32_t *bytes, Volume **out)
{
    Grid g;
    Affine to_voxels;
    int32_t n_points[3];
    char what[200];
    TRY(open_grid(r, entry, bytes, &g));
    TRY(map_of(r, &g, &to_voxels));
    TRY(bricks_around(r, &g, g.first, n_points));
    /* every brick asks at all its corners, and mostly by way of the root */
    double asked = (double)n_points[0] * n_points[1] * n_points[2] / (VOLUME_BRICK * VOLUME_BRICK * VOLUME_BRICK);
    if (asked * (pnanovdb_root_get_tile_count(g.buf, g.root) + 1.0) > MOST_WORK)
        return fail(r->error, STATUS_INPUT, "grid '%.*s' of '%s' is too large to be read: it spans %d x %d x %d voxels",
                    (int)g.name_length, g.name, r->path, (int)n_points[0], (int)n_points[1], (int)n_points[2]);
    pnanovdb_uint32_t level;
    int32_t beyond = 1 << 30;
    float background = value_of(&g, beyond, beyond, beyond, &level);
    if (!(background >= 0) || !isfinite(background))
        return refuse_value(&g, background, (const int32_t[3]){beyond, beyond, beyond}, r->error);
    snprintf(what, sizeof what, "grid '%.*s'", (int)(entry->name_length < 150 ? entry->name_length : 150), entry->name);
    TRY(volume_new(n_points, fill_brick, &g, background, r->most_bytes, what, out, r->error));
    (*out)->to_lattice = to_voxels;
    (*out)->to_lattice.t = vec3_sub(to_voxels.t, vec3(g.first[0], g.first[1], g.first[2]));
    return STATUS_OK;
}

Status nanovdb_read(const char *path, const char *grid, size_t most_bytes, Volume **out, Error *error)
{
    char *bytes = NULL;
    Reader r = {.path = path, .most_bytes = most_bytes, .error = error};
    *out = NULL;
    TRY(file_read(path, most_bytes, &bytes, &r.length, error));
    r.bytes = (const unsigned char *)bytes;
    GridEntry entry = {0};
    uint32_t *unpacked = NULL;
    Status status = find_grid(&r, grid, &entry);
    if (status == STATUS_OK) status = unpack(&r, &entry, &unpacked);
    if (status == STATUS_OK) status = make_volume(&r, &entry, unpacked, out);
    free(unpacked);
    free(bytes);
    return status;
}

/* ---- what there is ---- */

typedef struct Visit {
    void (*visit)(void *context, const NanovdbGrid *grid);
    void *context;
    size_t n;
} Visit;

static double double_at(const unsigned char *bytes)
{
    uint64_t bits = number_at(bytes, 8);
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static void describe(void *context, const GridEntry *entry)
{
    /* in the order of PNANOVDB_GRID_TYPE_* */
    static const char *const types[] = {"?",     "float", "double", "int16",  "int32", "int64", "Vec3f",
                                        "Vec3d", "mask",  "half",   "uint32", "bool",  "RGBA8", "Fp4",
                                        "Fp8",   "Fp16",  "FpN",    "Vec4f",  "Vec4d"};
    Visit *visit = context;
    const unsigned char *meta = entry->meta;
    uint32_t type = (uint32_t)number_at(meta + 32, 4), class = (uint32_t)number_at(meta + 36, 4);
    char name[256];
    size_t length = entry->name_length < sizeof name - 1 ? entry->name_length : sizeof name - 1;
    for (size_t i = 0; i < length; i++) name[i] = (unsigned char)entry->name[i] < ' ' ? '?' : entry->name[i];
    name[length] = 0;
    NanovdbGrid grid = {.name = name,
                        .type = type < sizeof types / sizeof *types ? types[type] : "?",
                        .readable = is_readable(type) && class != PNANOVDB_GRID_CLASS_LEVEL_SET,
                        .n_voxels = number_at(meta + 24, 8),
                        .n_bytes = entry->grid_bytes,
                        .box = {vec3(double_at(meta + 40), double_at(meta + 48), double_at(meta + 56)),
                                vec3(double_at(meta + 64), double_at(meta + 72), double_at(meta + 80))}};
    for (size_t axis = 0; axis < 3; axis++) {
        uint32_t low = (uint32_t)number_at(meta + 88 + 4 * axis, 4),
                 high = (uint32_t)number_at(meta + 100 + 4 * axis, 4);
        grid.n[axis] = (int32_t)((high - low + 1) & 0x7fffffff);
        grid.voxel[axis] = double_at(meta + 112 + 8 * axis);
    }
    visit->visit(visit->context, &grid);
    visit->n++;
}

Status nanovdb_visit(const char *path, void (*visit)(void *context, const NanovdbGrid *grid), void *context,
                     Error *error)
{
    char *bytes = NULL;
    Reader r = {.path = path, .error = error};
    Visit what = {.visit = visit, .context = context};
    TRY(file_read(path, 0, &bytes, &r.length, error));
    r.bytes = (const unsigned char *)bytes;
    Status status = visit_entries(&r, describe, &what);
    if (status == STATUS_OK && what.n == 0) status = fail(error, STATUS_INPUT, "'%s' holds no grids", path);
    free(bytes);
    return status;
}

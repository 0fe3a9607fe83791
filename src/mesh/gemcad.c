/* gemcad.c - reads cut stones from the cutting instructions of GemCad, .asc, as they are passed on among gem cutters.
 *
 * A line of text is a record, whose first letter says what it is: `g` the teeth of the index wheel and the index at the bottom of
 * the view from above, `I` the refractive index, `a` a tier of facets, with their angle to the girdle's plane, how far they are
 * from the middle, and the index of each; `n` and a name may follow an index, and `G` and a note end a tier. Pavilions have
 * angles below 0, which a culet says as -0, or by its distance. `y`, the symmetry, says nothing: indices are all there. `H` and
 * `F` are titles and notes. Lines that begin with none of these go on with a tier. The middle of the stone stays at the origin,
 * its axis becomes y.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/angle.h"
#include "base/array.h"
#include "base/file.h"
#include "base/num.h"
#include "mesh/half_spaces.h"
#include "mesh/mesh_file.h"

/* Stones are about 2 units wide, and files say no unit: 10 mm. */
#define UNIT_M 0.005
enum { MOST_TEETH = 1000 };

/* The facets that one record describes. */
typedef struct Tier {
    uint32_t line; /* 0: there is none yet */
    double angle, distance;
    uint32_t n;
    bool noted; /* what follows is for people */
} Tier;

typedef struct Gem {
    const char *path;
    Error *error;
    const char *at, *end; /* the rest of the line */
    uint32_t line;
    double teeth, bottom; /* teeth below 0: they count the other way round */
    double index;         /* of refraction; 0: it is not said */
    Tier tier;
    HalfSpace *spaces;
    size_t n_spaces, capacity;
} Gem;

static void skip_blanks(Gem *gem)
{
    while (gem->at < gem->end && (unsigned char)*gem->at <= ' ') gem->at++;
}

static Status unexpected(Gem *gem, const char *wanted)
{
    int shown = mesh_text_shown(gem->at, gem->end);
    if (shown == 0)
        return fail(gem->error, STATUS_INPUT, "'%s':%lu: the line ends where %s should be", gem->path,
                    (unsigned long)gem->line, wanted);
    return fail(gem->error, STATUS_INPUT, "'%s':%lu: '%.*s' stands where %s should be", gem->path,
                (unsigned long)gem->line, shown, gem->at, wanted);
}

static Status read_number(Gem *gem, const char *wanted, double *value)
{
    skip_blanks(gem);
    size_t length = num_parse(gem->at, (size_t)(gem->end - gem->at), value);
    bool whole = length && (gem->at + length == gem->end || (unsigned char)gem->at[length] <= ' ');
    if (!whole || !isfinite(*value)) return unexpected(gem, wanted);
    gem->at += length;
    return STATUS_OK;
}

/* ---- facets ---- */

/* Where angle and distance of the tier put it, turned to an index. */
static Status add_facet(Gem *gem, double index)
{
    Tier *tier = &gem->tier;
    const double angle = tier->angle * MEN_PI / 180,
                 turn = 2 * MEN_PI * (index - gem->bottom) / (gem->teeth != 0 ? gem->teeth : 1);
    const bool is_flat = tier->angle == 0, below = signbit(tier->angle) || (is_flat && tier->distance < 0);
    if (!ARRAY_ROOM(gem->spaces, gem->capacity, gem->n_spaces))
        return fail_memory(gem->error, gem->n_spaces * sizeof *gem->spaces, "the facets of a stone");
    tier->n++;
    gem->spaces[gem->n_spaces++] =
        (HalfSpace){.normal = is_flat ? vec3(0, below ? -1 : 1, 0)
                                      : vec3(sin(fabs(angle)) * sin(turn), below ? -cos(angle) : cos(angle),
                                             sin(fabs(angle)) * cos(turn)),
                    .distance = is_flat ? fabs(tier->distance) : tier->distance};
    return STATUS_OK;
}

/* A table has no index, or one that says nothing. */
static Status end_tier(Gem *gem)
{
    Tier *tier = &gem->tier;
    if (tier->line == 0 || tier->n) return STATUS_OK;
    if (tier->angle == 0) return add_facet(gem, 0);
    return fail(gem->error, STATUS_INPUT, "'%s':%lu: the facets have no index", gem->path, (unsigned long)tier->line);
}

/* What follows angle and distance, on lines of its own, too. */
static Status read_indices(Gem *gem)
{
    for (skip_blanks(gem); gem->at < gem->end && !gem->tier.noted; skip_blanks(gem)) {
        const char word = *gem->at;
        const bool alone = gem->at + 1 == gem->end || (unsigned char)gem->at[1] <= ' ';
        if (word == 'G') {
            gem->tier.noted = true;
        } else if (word == 'n' && alone) {
            gem->at++;
            skip_blanks(gem);
            while (gem->at < gem->end && (unsigned char)*gem->at > ' ') gem->at++;
        } else {
            double index;
            TRY(read_number(gem, "an index of the facets", &index));
            if (gem->teeth == 0 && gem->tier.angle != 0)
                return fail(gem->error, STATUS_INPUT,
                            "'%s':%lu: an index before the line 'g' that says how many teeth the wheel has", gem->path,
                            (unsigned long)gem->line);
            TRY(add_facet(gem, index));
        }
    }
    return STATUS_OK;
}

static Status read_tier(Gem *gem)
{
    gem->tier = (Tier){.line = gem->line};
    const char *angle = gem->at;
    TRY(read_number(gem, "the angle of facets", &gem->tier.angle));
    if (!(fabs(gem->tier.angle) <= 90)) {
        gem->at = angle;
        skip_blanks(gem);
        return unexpected(gem, "an angle from -90 to 90 degrees");
    }
    TRY(read_number(gem, "their distance from the middle", &gem->tier.distance));
    return read_indices(gem);
}

/* ---- records ---- */

static Status read_wheel(Gem *gem)
{
    TRY(read_number(gem, "the number of teeth", &gem->teeth));
    if (!(fabs(gem->teeth) >= 1 && fabs(gem->teeth) <= MOST_TEETH))
        return fail(gem->error, STATUS_INPUT, "'%s':%lu: an index wheel of %g teeth; it can have 1 to %d", gem->path,
                    (unsigned long)gem->line, gem->teeth, MOST_TEETH);
    skip_blanks(gem);
    return gem->at < gem->end ? read_number(gem, "the index at the bottom", &gem->bottom) : STATUS_OK;
}

/* What of people wrote behind it is not looked at. */
static Status read_index(Gem *gem)
{
    TRY(read_number(gem, "the refractive index", &gem->index));
    if (gem->index >= 1 && gem->index <= 10) return STATUS_OK;
    return fail(gem->error, STATUS_INPUT, "'%s':%lu: a refractive index of %g; it can be 1 to 10", gem->path,
                (unsigned long)gem->line, gem->index);
}

static Status read_record(Gem *gem)
{
    skip_blanks(gem);
    if (gem->at == gem->end) return STATUS_OK;
    const char word = *gem->at, next = gem->at + 1 < gem->end ? gem->at[1] : ' ';
    const bool with_number = (unsigned char)next <= ' ' || (next >= '0' && next <= '9') || strchr("+-.", next);
    if (word == 'H' || word == 'F' || word == ';' || (word == 'y' && with_number)) return STATUS_OK;
    if (!strchr("gIa", word) || !with_number) return gem->tier.line ? read_indices(gem) : unexpected(gem, "a record");
    gem->at++;
    if (word == 'g') return read_wheel(gem);
    if (word == 'I') return read_index(gem);
    TRY(end_tier(gem));
    return read_tier(gem);
}

/* Lines end with a line feed, a carriage return, or both. */
static Status read_lines(Gem *gem, const char *text, const char *end)
{
    static const char mark[] = "\xef\xbb\xbf", first[] = "GemCad"; /* the mark of UTF-8 */
    if (end - text >= 3 && memcmp(text, mark, 3) == 0) text += 3;
    if ((size_t)(end - text) < sizeof first - 1 || strncasecmp(text, first, sizeof first - 1) != 0)
        return fail(gem->error, STATUS_INPUT, "'%s' does not begin with 'GemCad': no cutting instructions of a stone",
                    gem->path);
    for (gem->line = 1; text < end; gem->line++) {
        gem->at = gem->end = text;
        while (gem->end < end && *gem->end != '\n' && *gem->end != '\r') gem->end++;
        text = gem->end + (gem->end + 1 < end && gem->end[0] == '\r' && gem->end[1] == '\n' ? 2 : 1);
        if (gem->line > 1) TRY(read_record(gem));
    }
    return end_tier(gem);
}

/* ---- the stone ---- */

/* The material that the stone is of, where its index is said: it is clear. */
static Status add_material(const Gem *gem, MeshSource *source, uint32_t *part)
{
    static const char name[] = "stone";
    if (!source) return STATUS_OK;
    *part = mesh_source_part(source, "material", name, sizeof name - 1);
    if (*part == UINT32_MAX) return fail_memory(gem->error, sizeof name, "a name");
    source->unit_m = UNIT_M;
    if (gem->index == 0 || mesh_source_find_material(source, name)) return STATUS_OK;
    source->left_out |= 1U << MESH_LEFT_DISPERSION;
    MeshMaterial material = material_new(name, sizeof name - 1);
    for (size_t i = 0; material_row(i); i++) {
        const MaterialRow *row = material_row(i);
        const double clear = 1, smooth = 0;
        if (row->is_picture) continue;
        if (row->key == FACT_INDEX) material_set(&material, row, &gem->index);
        if (row->key == FACT_TRANSMISSION) material_set(&material, row, &clear);
        if (row->key == FACT_ROUGHNESS || row->key == FACT_METAL) material_set(&material, row, &smooth);
    }
    mesh_source_material(source, &material);
    return STATUS_OK;
}

static Status make_stone(const Gem *gem, MeshSource *source, Mesh **mesh)
{
    Mesh *stone = NULL;
    Vec3 middle;
    uint32_t part = UINT32_MAX;
    if (gem->n_spaces > HALF_SPACES_MOST)
        return fail(gem->error, STATUS_INPUT, "'%s' has %zu facets; %d can be read", gem->path, gem->n_spaces,
                    HALF_SPACES_MOST);
    TRY(half_spaces_mesh(gem->spaces, (uint32_t)gem->n_spaces, &stone, &middle, gem->error));
    if (!stone)
        return fail(gem->error, STATUS_INPUT, "'%s': its %zu facets enclose no stone: %s", gem->path, gem->n_spaces,
                    gem->n_spaces < 4 ? "that takes 4 at least" : "it is open at a side, or cut away whole");
    for (uint32_t i = 0; i < stone->n_vertices; i++)
        stone->positions[i] = vec3f_from(vec3_add(vec3_from_f(stone->positions[i]), middle));
    Status status = add_material(gem, source, &part);
    if (status == STATUS_OK && !mesh_source_wants(source, &part, 1, stone->n_triangles))
        status = mesh_source_nothing(source, gem->path, gem->error);
    if (status == STATUS_OK)
        *mesh = stone;
    else
        mesh_free(stone);
    return status;
}

Status mesh_load_gemcad(const char *path, MeshSource *source, Mesh **mesh, Error *error)
{
    char *bytes = NULL;
    size_t length = 0;
    TRY(file_read(path, 0, &bytes, &length, error));
    Gem gem = {.path = path, .error = error};
    Status status = read_lines(&gem, bytes, bytes + length);
    if (status == STATUS_OK) status = make_stone(&gem, source, mesh);
    free(gem.spaces);
    free(bytes);
    return status;
}

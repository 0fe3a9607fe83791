/* balances.c - keeping the balances of a scene's surfaces, and their layers.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/balances.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>

#include "base/hash.h"

enum { BUCKETS = 256 };
/* Where a scene's layers look in more ways than these none is kept: their tables would be read from far away in memory. */
enum { MOST_LOOKS = 256 };

/* What is kept is of that. */
typedef struct BalanceKey {
    uint32_t surface, medium_from, medium_to;
    uint32_t steps; /* of the numbers that textures say */
    bool bare;
} BalanceKey;

/* Never changed once it is ready. */
typedef struct Node Node;
struct Node {
    BalanceKey key;
    Balance *balance; /* NULL: none is wanted, or there is no memory for it */
    BsdfKept kept;
    atomic_bool ready; /* else the thread that put it there is making it */
    Node *next;
};

/* Layers that look alike are one, whatever surfaces have them. */
typedef struct LayerNode LayerNode;
struct LayerNode {
    KeptLayer layer;
    LayerNode *next;
};

/* Of a surface. */
typedef struct Need {
    bool any;            /* something may be kept: */
    bool balance;        /* a balance may be wanted */
    bool skin, coat;     /* these layers are the same at all hits, in a medium that is the same at all wavelengths */
    uint32_t n_textured; /* numbers that textures say, of those that matter */
} Need;

struct Balances {
    const Scene *scene;
    Need *needs; /* of each surface */
    pthread_mutex_t lock;
    pthread_cond_t made;
    LayerNode *layers; /* for who has the lock; as is the right to add to a bucket */
    _Atomic(Node *) buckets[BUCKETS];
};

static float index_of(const Spectrum *ior)
{
    return spectrum_at_one(ior, BALANCE_NM);
}

static bool matters(const SurfaceTexture *texture)
{
    return !texture->color && texture->offset != offsetof(BsdfSpec, film_thickness_nm) &&
           texture->offset != offsetof(BsdfSpec, mix_weight) && texture->offset != offsetof(BsdfSpec, translucency);
}

static Need need_of(const Scene *scene, const SceneSurface *surface)
{
    const BsdfSpec *spec = &surface->spec; /* of a number that a texture says: the largest */
    Need need = {0};
    for (uint32_t i = 0; i < surface->n_textures; i++) need.n_textured += matters(&surface->textures[i]);
    float densest = 1;
    for (uint32_t i = 0; i < scene->n_media; i++) densest = fmaxf(densest, index_of(&scene->media[i].ior));
    bool stretched = spec->specular_roughness_anisotropy > 0 || spec->coat_roughness_anisotropy > 0;
    bool low =
        index_of(&spec->specular_ior) < densest || (spec->coat_weight > 0 && index_of(&spec->coat_ior) < densest);
    const uint32_t most_textured = 3;
    need.balance = need.n_textured <= most_textured && (stretched || (surface->finished && low));
    LayerLook look;
    bool even = surface->finished && !need.n_textured;
    need.skin = even && bsdf_skin_look(spec, 1, &look);
    need.coat = even && bsdf_coat_look(spec, 1, &look);
    for (uint32_t i = 0; i < surface->n_textures; i++)
        if (surface->textures[i].offset == offsetof(BsdfSpec, coat_color)) need.coat = false;
    need.any = need.balance || need.skin || need.coat;
    return need;
}

/* How layers look that there are in a scene, each once, and all in a vacuum. */
typedef struct LayerLooks {
    LayerLook items[MOST_LOOKS];
    uint32_t n;
    bool too_many;
} LayerLooks;

static bool same_look(const LayerLook *a, const LayerLook *b)
{
    return a->eta == b->eta && a->alpha_x == b->alpha_x && a->alpha_y == b->alpha_y && a->tint == b->tint;
}

static void note_look(LayerLooks *looks, const LayerLook *look)
{
    for (uint32_t i = looks->n; i > 0; i--)
        if (same_look(&looks->items[i - 1], look)) return;
    looks->too_many = looks->n == MOST_LOOKS;
    if (!looks->too_many) looks->items[looks->n++] = *look;
}

/* No layer is kept where there are too many: which ones would go by who comes first. */
static void limit_layers(const Scene *scene, Need *needs)
{
    LayerLooks looks = {.n = 0};
    LayerLook look;
    for (uint32_t i = 0; i < scene->n_surfaces && !looks.too_many; i++) {
        const BsdfSpec *spec = &scene->surfaces[i].spec;
        if (needs[i].skin && bsdf_skin_look(spec, 1, &look)) note_look(&looks, &look);
        if (needs[i].coat && !looks.too_many && bsdf_coat_look(spec, 1, &look)) note_look(&looks, &look);
    }
    for (uint32_t i = 0; i < scene->n_surfaces && looks.too_many; i++) {
        needs[i].skin = needs[i].coat = false;
        needs[i].any = needs[i].balance;
    }
}

Status balances_new(const Scene *scene, Balances **balances, Error *error)
{
    Balances *b = *balances = calloc(1, sizeof *b);
    Need *needs = calloc(scene->n_surfaces + 1U, sizeof *needs);
    bool locks = b && needs && pthread_mutex_init(&b->lock, NULL) == 0;
    if (!locks || pthread_cond_init(&b->made, NULL) != 0) {
        if (locks) pthread_mutex_destroy(&b->lock);
        free(b);
        free(needs);
        *balances = NULL;
        return fail_memory(error, scene->n_surfaces * sizeof *needs, "surfaces");
    }
    b->scene = scene;
    b->needs = needs;
    for (uint32_t i = 0; i < scene->n_surfaces; i++) needs[i] = need_of(scene, &scene->surfaces[i]);
    limit_layers(scene, needs);
    return STATUS_OK;
}

void balances_free(Balances *balances)
{
    if (!balances) return;
    for (int i = 0; i < BUCKETS; i++)
        for (Node *node = atomic_load(&balances->buckets[i]), *next; node; node = next) {
            next = node->next;
            free(node->balance);
            free(node);
        }
    for (LayerNode *layer = balances->layers, *next; layer; layer = next) {
        next = layer->next;
        free(layer);
    }
    pthread_cond_destroy(&balances->made);
    pthread_mutex_destroy(&balances->lock);
    free(balances->needs);
    free(balances);
}

/* Which step each number of a texture is at; *spec gets what they stand for. */
static uint32_t step_numbers(const SceneSurface *surface, uint32_t n_textured, BsdfSpec *spec)
{
    static const uint32_t steps[] = {0, 32, 8, 4};
    uint32_t all = 0;
    for (uint32_t i = 0; i < surface->n_textures && n_textured; i++) {
        const SurfaceTexture *texture = &surface->textures[i];
        if (!matters(texture)) continue;
        float *number = (float *)(void *)((char *)spec + texture->offset), n = (float)steps[n_textured];
        float step = roundf(fminf(fmaxf(*number, 0), 1) * n);
        *number = step / n;
        all = all * (steps[n_textured] + 1) + (uint32_t)step;
    }
    return all;
}

static Node *look_up(Balances *balances, uint32_t bucket, const BalanceKey *key)
{
    for (Node *node = atomic_load_explicit(&balances->buckets[bucket], memory_order_acquire); node; node = node->next)
        if (node->key.surface == key->surface && node->key.medium_from == key->medium_from &&
            node->key.medium_to == key->medium_to && node->key.steps == key->steps && node->key.bare == key->bare)
            return node;
    return NULL;
}

/* NULL: there is no memory for it. */
static const BsdfLayer *find_layer(Balances *balances, const LayerLook *look)
{
    for (const LayerNode *node = balances->layers; node; node = node->next)
        if (same_look(&node->layer.look, look)) return &node->layer.layer;
    LayerNode *node = malloc(sizeof *node);
    if (!node) return NULL;
    kept_layer_make(look, &node->layer);
    node->next = balances->layers;
    balances->layers = node;
    return &node->layer.layer;
}

static void keep_layers(Balances *balances, const BalanceKey *key, const BsdfSpec *spec, BsdfKept *kept)
{
    const Need *need = &balances->needs[key->surface];
    const Spectrum *ior = &balances->scene->media[key->medium_from].ior;
    LayerLook look;
    if (!spectrum_is_constant(ior)) return;
    float eta_i = index_of(ior);
    if (need->skin && bsdf_skin_look(spec, eta_i, &look)) kept->skin = find_layer(balances, &look);
    if (!need->coat || !bsdf_coat_look(spec, eta_i, &look)) return;
    kept->coat = find_layer(balances, &look);
    if (need->skin) kept->inner = bsdf_inner_reflectance(spec, lanes_all(eta_i), lanes_all(BALANCE_NM));
}

/* NULL: there is no memory for it. With the lock. */
static Node *add(Balances *balances, uint32_t bucket, const BalanceKey *key)
{
    Node *node = calloc(1, sizeof *node);
    if (!node) return NULL;
    node->key = *key;
    node->next = atomic_load_explicit(&balances->buckets[bucket], memory_order_relaxed);
    atomic_store_explicit(&balances->buckets[bucket], node, memory_order_release);
    return node;
}

/* A balance takes a while: others are made meanwhile, and only who needs this one waits for it. With the lock before and
 * after. */
static void make(Balances *balances, Node *node, const BsdfSpec *spec)
{
    const SceneMedium *media = balances->scene->media;
    const BalanceKey *key = &node->key;
    float eta_i = index_of(&media[key->medium_from].ior), eta_t = index_of(&media[key->medium_to].ior);
    pthread_mutex_unlock(&balances->lock);
    bool wanted = balances->needs[key->surface].balance && balance_is_wanted(spec, eta_i, eta_t);
    if (wanted && balance_new(spec, eta_i, eta_t, &node->balance) != STATUS_OK) node->balance = NULL;
    pthread_mutex_lock(&balances->lock);
    node->kept = (BsdfKept){.balance = node->balance, .inner = -1};
    if (!wanted && !key->bare) keep_layers(balances, key, spec, &node->kept);
    atomic_store_explicit(&node->ready, true, memory_order_release);
    pthread_cond_broadcast(&balances->made);
}

static bool is_ready(const Node *node)
{
    return atomic_load_explicit(&node->ready, memory_order_acquire);
}

const BsdfKept *balances_find(Balances *balances, const BalanceCase *at)
{
    uint32_t number = (uint32_t)(at->surface - balances->scene->surfaces);
    const Need *need = &balances->needs[number];
    if (!need->any || (at->bare && !need->balance)) return NULL;
    BsdfSpec stepped;
    BalanceKey key = {number, at->medium_from, at->medium_to, 0, at->bare};
    if (need->n_textured) {
        stepped = *at->spec;
        key.steps = step_numbers(at->surface, need->n_textured, &stepped);
    }
    uint32_t places = hash_combine(hash_combine(number, key.medium_from), key.medium_to);
    uint32_t bucket = hash_combine(places, key.steps) % BUCKETS;
    Node *node = look_up(balances, bucket, &key);
    if (node && is_ready(node)) return &node->kept;
    if (!need->n_textured) stepped = *at->spec;
    if (at->bare) {
        stepped.transmission_weight = 1;
        stepped.base_metalness = stepped.coat_weight = stepped.fuzz_weight = 0;
        stepped.thin_walled = false;
    }
    pthread_mutex_lock(&balances->lock);
    node = look_up(balances, bucket, &key);
    if (!node && (node = add(balances, bucket, &key))) make(balances, node, &stepped);
    while (node && !is_ready(node)) pthread_cond_wait(&balances->made, &balances->lock);
    pthread_mutex_unlock(&balances->lock);
    return node ? &node->kept : NULL;
}

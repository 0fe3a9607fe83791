/* nest_test.c - the core alone: sequences with known answers, an independent model of the printed stack,
 * reversal, depth, and the order of hulls. No geometry.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/hash.h"
#include "nest/cross.h"

enum { A, B, C, WORLD = NEST_WORLD_MEDIUM };

/* A sequence of single crossings, "+A +B -A -B", against the expected media after each: "A B . 0", '.' for a
 * silent crossing. Hull A has medium 1, and so on; media may be overridden. */
typedef struct Fixture {
    NestHull hulls[4];
    uint32_t n_hulls;
    NestOverlap overlaps[8];
    size_t n_overlaps;
} Fixture;

static void make_order(NestOrder *order, NestPolicy policy, const Fixture *f)
{
    assert_int_equal(nest_order_build(order, policy, f->hulls, f->n_hulls, f->overlaps, f->n_overlaps, NULL),
                     STATUS_OK);
}

static void assert_same_list(const NestOrder *order, const NestList *list, const NestOrder *other_order,
                             const NestList *other)
{
    uint32_t n = nest_list_count(list);
    assert_int_equal(nest_list_count(other), n);
    assert_int_equal(other->point.top.level, list->point.top.level);
    for (uint32_t i = 0; i < n; i++) assert_int_equal(nest_item(other_order, other, i), nest_item(order, list, i));
}

/* The list as one in a row. */
static void spell_out(const NestOrder *order, const NestList *list, const NestOrder *in_a_row, NestList *row)
{
    assert_int_equal(nest_list_reserve(row, nest_list_count(list)), STATUS_OK);
    for (uint32_t i = 0; i < nest_list_count(list); i++) nest_list_insert(row, i, nest_item(order, list, i));
    nest_order_settle(in_a_row, row);
}

/* But for the owners. */
static void assert_same_crossing(const NestCrossing *a, const NestCrossing *b)
{
    assert_true(a->medium_from == b->medium_from && a->medium_to == b->medium_to);
    assert_true(a->n_faults == b->n_faults && a->opaque == b->opaque);
}

/* Crossings of one place both ways where there are two: with lists as bits, and in a row. They must agree. */
static Status cross(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n, NestCrossing *crossing)
{
    if (!order->narrow) return nest_cross(list, order, passes, n, crossing);
    NestOrder in_a_row = *order;
    NestList row;
    NestCrossing other;
    in_a_row.narrow = false;
    nest_list_init(&row);
    spell_out(order, list, &in_a_row, &row);
    Status status = nest_cross(list, order, passes, n, crossing);
    assert_int_equal(nest_cross(&row, &in_a_row, passes, n, &other), status);
    assert_same_list(order, list, &in_a_row, &row);
    assert_same_crossing(crossing, &other);
    assert_true(other.owner_from == crossing->owner_from && other.owner_to == crossing->owner_to);
    nest_list_clear(&row);
    return status;
}

/* One crossing as one of many, and as the one that it is; each with lists as bits and in a row, where there are both. They
 * must agree. */
static Status cross_one(NestList *list, const NestOrder *order, NestPass pass, NestCrossing *crossing)
{
    NestOrder in_a_row = *order;
    NestList other, row;
    NestCrossing alone, alone_in_row;
    in_a_row.narrow = false;
    nest_list_init(&other);
    nest_list_init(&row);
    spell_out(order, list, &in_a_row, &row);
    assert_int_equal(nest_list_copy(&other, list), STATUS_OK);
    Status status = cross(list, order, &pass, 1, crossing);
    assert_int_equal(nest_cross_one(&other, order, pass, &alone), status);
    assert_int_equal(nest_cross_one(&row, &in_a_row, pass, &alone_in_row), status);
    assert_same_list(order, list, order, &other);
    assert_same_list(order, list, &in_a_row, &row);
    assert_int_equal(nest_owner(order, list), crossing->owner_to);
    assert_same_crossing(crossing, &alone);
    assert_same_crossing(crossing, &alone_in_row);
    nest_list_clear(&other);
    nest_list_clear(&row);
    return status;
}

static void check_sequence(const NestOrder *order, const char *crossings, const char *expected)
{
    NestList list;
    nest_list_init(&list);
    for (const char *c = crossings, *e = expected; *c; c += 3, e += 2) {
        NestPass pass = {(uint32_t)(c[1] - 'A'), c[0] == '+'};
        NestCrossing crossing;
        assert_int_equal(cross_one(&list, order, pass, &crossing), STATUS_OK);
        assert_int_equal(crossing.n_faults, 0);
        char seen = crossing.medium_from == crossing.medium_to ? '.'
                    : crossing.medium_to == WORLD              ? '0'
                                                               : (char)('A' + crossing.medium_to - 1);
        if (seen != *e)
            fail_msg("%s under %s: after '%.2s' saw %c, expected %c", crossings, nest_policy_text(order->policy), c,
                     seen, *e);
        if (!c[2]) break;
    }
    nest_list_clear(&list);
}

static void sequence(NestPolicy policy, const Fixture *f, const char *crossings, const char *expected)
{
    NestOrder order;
    make_order(&order, policy, f);
    check_sequence(&order, crossings, expected);
    nest_order_clear(&order);
}

static Fixture two(double volume_a, double volume_b, int priority_a, int priority_b, NestRelation relation)
{
    return (Fixture){
        .hulls = {{1, priority_a, NEST_STATE_UNKNOWN, volume_a}, {2, priority_b, NEST_STATE_UNKNOWN, volume_b}},
        .n_hulls = 2,
        .overlaps = {{A, B, relation}},
        .n_overlaps = 1};
}

static void test_table_partial_overlap(void **state)
{
    (void)state;
    Fixture f = two(2, 1, 0, 0, NEST_PARTIAL); /* B is the smaller: on top */
    sequence(NEST_ENTERED, &f, "+A +B -A -B", "A B . 0");
    sequence(NEST_ENTERED, &f, "+B +A -B -A", "B A . 0");
    sequence(NEST_AUTOMATIC, &f, "+A +B -A -B", "A B . 0");
    sequence(NEST_AUTOMATIC, &f, "+B +A -B -A", "B . A 0");
    Fixture a_over_b = two(2, 1, 5, 1, NEST_PARTIAL), b_over_a = two(2, 1, 1, 5, NEST_PARTIAL);
    sequence(NEST_PRIORITY, &a_over_b, "+A +B -A -B", "A . B 0");
    sequence(NEST_PRIORITY, &a_over_b, "+B +A -B -A", "B A . 0");
    sequence(NEST_PRIORITY, &b_over_a, "+A +B -A -B", "A B . 0");
    sequence(NEST_PRIORITY, &b_over_a, "+B +A -B -A", "B . A 0");
}

static void test_table_nested(void **state)
{
    (void)state;
    Fixture f = two(2, 1, 0, 0, NEST_B_IN_A);
    sequence(NEST_ENTERED, &f, "+A +B -B -A", "A B A 0");
    sequence(NEST_AUTOMATIC, &f, "+A +B -B -A", "A B A 0");
    Fixture mistake = two(2, 1, 1, 0, NEST_B_IN_A); /* the artist's mistake hides B */
    sequence(NEST_PRIORITY, &mistake, "+A +B -B -A", "A . . 0");
    Fixture air = f; /* a bubble of the world's own medium */
    air.hulls[B].medium = WORLD;
    sequence(NEST_ENTERED, &air, "+A +B -B -A", "A 0 A 0");
    sequence(NEST_AUTOMATIC, &air, "+A +B -B -A", "A 0 A 0");
}

static void test_table_three(void **state)
{
    (void)state;
    Fixture f = {.hulls = {{1, 1, 0, 3}, {2, 2, 0, 2}, {3, 3, 0, 1}},
                 .n_hulls = 3,
                 .overlaps = {{A, B, NEST_PARTIAL}, {B, C, NEST_PARTIAL}, {A, C, NEST_PARTIAL}},
                 .n_overlaps = 3};
    sequence(NEST_ENTERED, &f, "+A +B +C -A -B -C", "A B C . . 0");
    sequence(NEST_PRIORITY, &f, "+A +B +C -A -B -C", "A B C . . 0");
    sequence(NEST_PRIORITY, &f, "+C +B +A -C -B -A", "C . . B A 0");
    sequence(NEST_AUTOMATIC, &f, "+C +B +A -C -B -A", "C . . B A 0");
}

static void test_table_floating_ice(void **state)
{
    (void)state;
    /* A: ice, B: water. Ice is solid, so that it wins although its volume is the larger here */
    Fixture f = {.hulls = {{1, 3, NEST_SOLID, 9, false}, {2, 1, NEST_LIQUID, 2, false}},
                 .n_hulls = 2,
                 .overlaps = {{B, A, NEST_PARTIAL}},
                 .n_overlaps = 1};
    sequence(NEST_ENTERED, &f, "+A +B -A -B", "A B . 0");
    sequence(NEST_PRIORITY, &f, "+A +B -A -B", "A . B 0");
    sequence(NEST_AUTOMATIC, &f, "+A +B -A -B", "A . B 0");
    for (int policy = NEST_AUTOMATIC; policy <= NEST_PRIORITY; policy++)
        sequence((NestPolicy)policy, &f, "+B +A -B -A", policy == NEST_ENTERED ? "B A . 0" : "B A . 0");
}

static void test_table_one_medium(void **state)
{
    (void)state;
    Fixture f = two(2, 1, 0, 0, NEST_PARTIAL);
    f.hulls[B].medium = 1;
    for (int policy = NEST_AUTOMATIC; policy <= NEST_PRIORITY; policy++)
        sequence((NestPolicy)policy, &f, "+A +B -A -B", "A . . 0");
}

static void test_none_knows_the_world_only(void **state)
{
    (void)state;
    Fixture f = two(2, 1, 0, 0, NEST_B_IN_A);
    NestOrder order;
    make_order(&order, NEST_NONE, &f);
    NestList list;
    nest_list_init(&list);
    NestPass passes[] = {{A, true}, {B, true}, {B, false}, {A, false}};
    uint32_t from[] = {WORLD, WORLD, 2, 1}, to[] = {1, 2, WORLD, WORLD};
    for (int i = 0; i < 4; i++) {
        NestCrossing crossing;
        assert_int_equal(cross_one(&list, &order, passes[i], &crossing), STATUS_OK);
        assert_int_equal(crossing.medium_from, from[i]);
        assert_int_equal(crossing.medium_to, to[i]);
    }
    nest_list_clear(&list);
    nest_order_clear(&order);
}

/* Touching faces and edges: several surfaces at one distance. */
static void test_together(void **state)
{
    (void)state;
    Fixture f = two(2, 1, 1, 2, NEST_PARTIAL);
    for (int policy = NEST_AUTOMATIC; policy <= NEST_PRIORITY; policy++)
        for (int swap = 0; swap < 2; swap++) {
            NestOrder order;
            make_order(&order, (NestPolicy)policy, &f);
            NestList list;
            nest_list_init(&list);
            NestPass in_a = {A, true}, both[2] = {{A, false}, {B, true}};
            if (swap) {
                both[0] = (NestPass){B, true};
                both[1] = (NestPass){A, false};
            }
            NestCrossing crossing;
            assert_int_equal(cross_one(&list, &order, in_a, &crossing), STATUS_OK);
            assert_int_equal(cross(&list, &order, both, 2, &crossing), STATUS_OK);
            assert_int_equal(crossing.medium_from, 1);
            assert_int_equal(crossing.medium_to, 2);
            assert_int_equal(crossing.n_faults, 0);
            assert_int_equal(nest_list_count(&list), 1);
            /* through an edge of A, in and out at once, twice reported: nothing happens */
            NestPass edge[] = {{A, false}, {A, true}, {A, true}};
            assert_int_equal(cross(&list, &order, edge, 3, &crossing), STATUS_OK);
            assert_int_equal(crossing.n_faults, 0);
            assert_int_equal(nest_list_count(&list), 1);
            /* a ripple that is left, entered and left again within rounding: it is left */
            NestPass ripple[] = {{B, false}, {B, true}, {B, false}}, in_b = {B, true};
            assert_int_equal(cross(&list, &order, ripple, 3, &crossing), STATUS_OK);
            assert_int_equal(crossing.n_faults, 0);
            assert_int_equal(nest_list_count(&list), 0);
            assert_int_equal(cross_one(&list, &order, in_b, &crossing), STATUS_OK);
            /* one edge reported by both its triangles counts once */
            NestPass twice[] = {{B, false}, {B, false}};
            assert_int_equal(cross(&list, &order, twice, 2, &crossing), STATUS_OK);
            assert_int_equal(crossing.n_faults, 0);
            assert_int_equal(crossing.medium_to, WORLD);
            nest_list_clear(&list);
            nest_order_clear(&order);
        }
}

static void test_faults_heal(void **state)
{
    (void)state;
    Fixture f = two(2, 1, 0, 0, NEST_PARTIAL);
    NestOrder order;
    make_order(&order, NEST_AUTOMATIC, &f);
    NestList list;
    nest_list_init(&list);
    NestPass leave = {A, false}, enter = {A, true};
    NestCrossing crossing;
    assert_int_equal(cross_one(&list, &order, leave, &crossing), STATUS_OK);
    assert_int_equal(crossing.n_faults, 1);
    assert_int_equal(nest_list_count(&list), 0);
    assert_int_equal(cross_one(&list, &order, enter, &crossing), STATUS_OK);
    assert_int_equal(cross_one(&list, &order, enter, &crossing), STATUS_OK);
    assert_int_equal(crossing.n_faults, 1);
    assert_int_equal(nest_list_count(&list), 1);
    nest_list_clear(&list);
    nest_order_clear(&order);
}

/* ---- An independent model: the stack of [WR19], chapter 11, with the listings' slips mended. ----
 * Entries are pushed for every crossing, with parity; a crossing that leaves takes both its entries
 * off again. Identity is the hull (mending 1, 8, 9), both entries go in every case (2, 6), nothing overflows (3 to
 * 5), and leaving is what the parity says. */
typedef struct StackEntry {
    uint32_t hull;
    bool odd_parity, topmost;
} StackEntry;
typedef struct PrintedStack {
    StackEntry entry[64];
    int top; /* -1: empty */
} PrintedStack;

static void printed_cross(PrintedStack *stack, uint32_t hull, const uint32_t *medium, uint32_t *incident,
                          uint32_t *outgoing)
{
    int same = stack->top;
    while (same >= 0 && stack->entry[same].hull != hull) same--;
    bool odd = true;
    if (same >= 0) {
        stack->entry[same].topmost = false;
        odd = !stack->entry[same].odd_parity;
    }
    int below = stack->top;
    while (below >= 0 &&
           !(stack->entry[below].hull != hull && stack->entry[below].odd_parity && stack->entry[below].topmost))
        below--;
    uint32_t below_medium = below >= 0 ? medium[stack->entry[below].hull] : WORLD;
    stack->entry[++stack->top] = (StackEntry){hull, odd, true};
    if (odd) {
        *incident = below_medium;
        *outgoing = medium[hull];
        return;
    }
    *outgoing = below_medium;
    *incident = below < same ? medium[hull] : *outgoing;
    /* transmitted while leaving: the pushed entry and its partner go */
    stack->top--;
    for (int i = same; i < stack->top; i++) stack->entry[i] = stack->entry[i + 1];
    stack->top--;
}

static void test_entered_is_the_printed_stack(void **state)
{
    (void)state;
    enum { HULLS = 7, SEQUENCES = 1000000, LENGTH = 14 };
    NestHull hulls[HULLS];
    uint32_t medium[HULLS];
    NestOrder order;
    uint64_t crossings = 0, random = 1;
    for (uint32_t s = 0; s < SEQUENCES; s++) {
        if (s % 1000 == 0) {
            if (s) nest_order_clear(&order);
            for (uint32_t h = 0; h < HULLS; h++) {
                random = hash_u64(random);
                medium[h] = random % 5 == 0 ? WORLD : (uint32_t)(random % 4) + 1;
                hulls[h] = (NestHull){medium[h], 0, NEST_STATE_UNKNOWN, 1, false};
            }
            assert_int_equal(nest_order_build(&order, NEST_ENTERED, hulls, HULLS, NULL, 0, NULL), STATUS_OK);
        }
        NestList list;
        nest_list_init(&list);
        PrintedStack stack = {.top = -1};
        for (int i = 0; i < LENGTH; i++) {
            random = hash_u64(random);
            uint32_t hull = (uint32_t)(random % HULLS), incident, outgoing;
            NestPass pass = {hull, !nest_has(&order, &list, hull)};
            NestCrossing crossing;
            if (cross_one(&list, &order, pass, &crossing) != STATUS_OK) fail();
            printed_cross(&stack, hull, medium, &incident, &outgoing);
            crossings++;
            bool visible = crossing.medium_from != crossing.medium_to;
            if (visible != (incident != outgoing) || crossing.medium_to != outgoing ||
                (visible && crossing.medium_from != incident) || nest_list_count(&list) != (uint32_t)(stack.top + 1))
                fail_msg("sequence %u differs at crossing %d", s, i);
        }
        nest_list_clear(&list);
    }
    nest_order_clear(&order);
    printf("entered: %d random sequences, %llu crossings agree with the printed stack\n", SEQUENCES,
           (unsigned long long)crossings);
}

/* The boundaries along a line, as pairs of media; returns how many. */
static int boundaries(const NestOrder *order, const NestPass *passes, int n, bool backwards, uint32_t (*out)[2],
                      int *where)
{
    NestList list;
    nest_list_init(&list);
    int count = 0;
    for (int k = 0; k < n; k++) {
        int i = backwards ? n - 1 - k : k;
        NestPass pass = {passes[i].hull, passes[i].entering != backwards};
        NestCrossing crossing;
        if (cross_one(&list, order, pass, &crossing) != STATUS_OK) fail();
        if (crossing.medium_from == crossing.medium_to) continue;
        out[count][0] = crossing.medium_from;
        out[count][1] = crossing.medium_to;
        where[count++] = i;
    }
    nest_list_clear(&list);
    return count;
}

static bool reversible(const NestOrder *order, const NestPass *passes, int n)
{
    uint32_t there[64][2], back[64][2];
    int where_there[64], where_back[64];
    int count = boundaries(order, passes, n, false, there, where_there);
    if (boundaries(order, passes, n, true, back, where_back) != count) return false;
    for (int i = 0; i < count; i++) {
        int j = count - 1 - i;
        if (there[i][0] != back[j][1] || there[i][1] != back[j][0] || where_there[i] != where_back[j]) return false;
    }
    return true;
}

/* All orderings of "+X -X" for n hulls, each X entered before it is left. */
static void all_orderings(const NestOrder *order, uint32_t n, NestPass *passes, uint32_t length, uint32_t *total,
                          uint32_t *differ)
{
    if (length == 2 * n) {
        ++*total;
        *differ += !reversible(order, passes, (int)length);
        return;
    }
    for (uint32_t h = 0; h < n; h++) {
        int seen = 0;
        for (uint32_t i = 0; i < length; i++) seen += passes[i].hull == h;
        if (seen == 2) continue;
        passes[length] = (NestPass){h, seen == 0};
        all_orderings(order, n, passes, length + 1, total, differ);
    }
}

static void test_reversal(void **state)
{
    (void)state;
    NestHull hulls[4];
    for (uint32_t h = 0; h < 4; h++) hulls[h] = (NestHull){h + 1, (int)h, NEST_STATE_UNKNOWN, 4.0 - h, false};
    NestOverlap overlaps[6];
    size_t n_overlaps = 0;
    for (uint32_t a = 0; a < 4; a++)
        for (uint32_t b = a + 1; b < 4; b++) overlaps[n_overlaps++] = (NestOverlap){a, b, NEST_PARTIAL};
    static const uint32_t expected_total[] = {0, 1, 6, 90, 2520}, expected_entered[] = {0, 0, 2, 60, 2184};
    for (int policy = NEST_AUTOMATIC; policy <= NEST_PRIORITY; policy++) {
        NestOrder order;
        assert_int_equal(nest_order_build(&order, (NestPolicy)policy, hulls, 4, overlaps, n_overlaps, NULL), STATUS_OK);
        for (uint32_t n = 1; n <= 4; n++) {
            NestPass passes[8];
            uint32_t total = 0, differ = 0;
            all_orderings(&order, n, passes, 0, &total, &differ);
            printf("%s: %u of %u orderings of %u hulls differ when reversed\n", nest_policy_text(order.policy), differ,
                   total, n);
            assert_int_equal(total, expected_total[n]);
            assert_int_equal(differ, policy == NEST_ENTERED ? expected_entered[n] : 0);
        }
        nest_order_clear(&order);
    }
}

static void test_thousand_shells(void **state)
{
    (void)state;
    enum { N = 1000 };
    static NestHull hulls[N];
    static NestOverlap overlaps[N];
    for (uint32_t h = 0; h < N; h++) hulls[h] = (NestHull){h + 1, 0, NEST_STATE_UNKNOWN, (double)(N - h), false};
    for (uint32_t h = 0; h + 1 < N; h++) overlaps[h] = (NestOverlap){h, h + 1, NEST_B_IN_A};
    for (int policy = NEST_AUTOMATIC; policy <= NEST_PRIORITY; policy++) {
        NestOrder order;
        assert_int_equal(nest_order_build(&order, (NestPolicy)policy, hulls, N, overlaps, N - 1, NULL), STATUS_OK);
        NestList list, copy;
        nest_list_init(&list);
        nest_list_init(&copy);
        for (uint32_t i = 0; i < 2 * N; i++) {
            uint32_t hull = i < N ? i : 2 * N - 1 - i;
            NestPass pass = {hull, i < N};
            NestCrossing crossing;
            assert_int_equal(nest_list_copy(&copy, &list), STATUS_OK);
            assert_int_equal(nest_cross(&copy, &order, &pass, 1, &crossing), STATUS_OK);
            NestList swap = list;
            list = copy;
            copy = swap;
            uint32_t inner = hull + 1, outer = hull;
            assert_int_equal(crossing.n_faults, 0);
            assert_int_equal(crossing.medium_from, i < N ? outer : inner);
            assert_int_equal(crossing.medium_to, i < N ? inner : outer);
        }
        assert_int_equal(nest_list_count(&list), 0);
        nest_list_clear(&list);
        nest_list_clear(&copy);
        nest_order_clear(&order);
    }
}

static void test_rules(void **state)
{
    (void)state;
    NestHull hulls[] = {{1, 0, NEST_SOLID, 116, false}, {2, 0, NEST_LIQUID, 93, false}};
    NestOverlap partial = {0, 1, NEST_PARTIAL}, contained = {0, 1, NEST_A_IN_B};
    NestDecision decision = nest_decide(hulls, &partial); /* pouring: less whisky than glass */
    assert_int_equal(decision.top, 0);
    assert_int_equal(decision.rule, NEST_BY_STATE);
    hulls[0].state = NEST_STATE_UNKNOWN;
    decision = nest_decide(hulls, &partial);
    assert_int_equal(decision.top, 1);
    assert_int_equal(decision.rule, NEST_BY_VOLUME);
    hulls[1].volume = 116 * (1 - 1e-5);
    assert_int_equal(nest_decide(hulls, &partial).rule, NEST_BY_VOLUME);
    for (int sign = -1; sign <= 1; sign++) { /* the same thing, turned round */
        hulls[1].volume = 116 * (1 + sign * 1e-12);
        decision = nest_decide(hulls, &partial);
        assert_int_equal(decision.top, 1);
        assert_int_equal(decision.rule, NEST_BY_DECLARATION);
    }
    decision = nest_decide(hulls, &contained);
    assert_int_equal(decision.top, 0);
    assert_int_equal(decision.rule, NEST_BY_CONTAINMENT);
    hulls[1].priority = 1;
    decision = nest_decide(hulls, &contained);
    assert_int_equal(decision.top, 1);
    assert_int_equal(decision.rule, NEST_BY_PRIORITY);
    hulls[1] = hulls[0];
    decision = nest_decide(hulls, &partial);
    assert_int_equal(decision.top, 1);
    assert_int_equal(decision.rule, NEST_BY_DECLARATION);
    NestHull matter[] = {{1, 0, NEST_GAS, 9, false}, {2, 0, NEST_LIQUID, 1, false}, {3, 0, NEST_SOLID, 99, false}};
    NestOverlap gas_liquid = {0, 1, NEST_PARTIAL}, gas_solid = {0, 2, NEST_PARTIAL};
    assert_int_equal(nest_decide(matter, &gas_liquid).top, 0);
    assert_int_equal(nest_decide(matter, &gas_solid).top, 2);
}

/* A solid over a liquid over a small unknown over the solid: a circle. */
static void test_circle_falls_back_to_volume(void **state)
{
    (void)state;
    NestHull hulls[] = {{1, 0, NEST_SOLID, 10, false},
                        {2, 0, NEST_LIQUID, 4, false},
                        {3, 0, NEST_STATE_UNKNOWN, 6, false},
                        {4, 0, NEST_SOLID, 1, false}};
    /* 0 over 1 by state, 1 over 2 by volume, 2 over 0 by volume; 3 stands apart */
    NestOverlap overlaps[] = {{0, 1, NEST_PARTIAL}, {1, 2, NEST_PARTIAL}, {0, 2, NEST_PARTIAL}};
    for (int turn = 0; turn < 3; turn++) { /* however the pairs are listed */
        NestOverlap turned[] = {overlaps[turn], overlaps[(turn + 1) % 3], overlaps[(turn + 2) % 3]};
        NestOrder order;
        assert_int_equal(nest_order_build(&order, NEST_AUTOMATIC, hulls, 4, turned, 3, NULL), STATUS_OK);
        assert_int_equal(order.n_circles, 1);
        assert_int_equal(order.circle[0], 1);
        assert_int_equal(order.circle[1], 1);
        assert_int_equal(order.circle[2], 1);
        assert_int_equal(order.circle[3], 0);
        assert_true(order.rank[1] > order.rank[2] && order.rank[2] > order.rank[0]);
        nest_order_clear(&order);
    }
}

/* Random scenes: the order is a permutation and agrees with every pair outside of circles. */
static void test_order_respects_pairs(void **state)
{
    (void)state;
    enum { N = 40, M = 80 };
    uint64_t random = 7;
    uint32_t circles = 0;
    for (int scene = 0; scene < 2000; scene++) {
        NestHull hulls[N];
        NestOverlap overlaps[M];
        for (uint32_t h = 0; h < N; h++) {
            random = hash_u64(random);
            hulls[h] = (NestHull){h, scene % 3 ? 0 : (int32_t)(random % 3), (NestState)(random >> 8 & 3),
                                  (double)(random >> 32 & 15), false};
        }
        for (uint32_t i = 0; i < M; i++) {
            random = hash_u64(random);
            uint32_t a = (uint32_t)(random % N), b = (uint32_t)((a + 1 + (random >> 20) % (N - 1)) % N);
            overlaps[i] = (NestOverlap){a, b, NEST_PARTIAL};
        }
        NestOrder order;
        assert_int_equal(nest_order_build(&order, NEST_AUTOMATIC, hulls, N, overlaps, M, NULL), STATUS_OK);
        bool used[N] = {false};
        for (uint32_t h = 0; h < N; h++) {
            assert_true(order.rank[h] < N && !used[order.rank[h]]);
            used[order.rank[h]] = true;
        }
        for (uint32_t i = 0; i < M; i++) {
            NestDecision decision = nest_decide(hulls, &overlaps[i]);
            bool one_circle = order.circle[decision.top] && order.circle[decision.top] == order.circle[decision.bottom];
            if (!one_circle) assert_true(order.rank[decision.top] > order.rank[decision.bottom]);
        }
        circles += order.n_circles;
        nest_order_clear(&order);
    }
    assert_true(circles > 0); /* the test would say little otherwise */
}

/* Hulls that mix change nothing for the others, under any policy, and are members of the list where they should be. */
static void test_mixing_owns_nothing(void **state)
{
    (void)state;
    enum { OTHERS = 5, ALL = 8, STEPS = 40 };
    uint64_t random = 11;
    for (int sequence = 0; sequence < 4000; sequence++) {
        NestPolicy policy = (NestPolicy)(sequence % 4);
        NestHull hulls[ALL];
        NestOrder order, without;
        for (uint32_t h = 0; h < ALL; h++) { /* those that mix stand among the others, with priorities like theirs */
            random = hash_u64(random);
            hulls[h] = (NestHull){h < OTHERS ? (uint32_t)(random % 3) + 1 : 9, (int32_t)(random >> 8 & 3),
                                  NEST_STATE_UNKNOWN, (double)(random >> 16 & 7), h >= OTHERS};
        }
        assert_int_equal(nest_order_build(&order, policy, hulls, ALL, NULL, 0, NULL), STATUS_OK);
        assert_int_equal(nest_order_build(&without, policy, hulls, OTHERS, NULL, 0, NULL), STATUS_OK);
        NestList list, plain;
        nest_list_init(&list);
        nest_list_init(&plain);
        bool inside[ALL] = {false};
        for (int i = 0; i < STEPS; i++) {
            random = hash_u64(random);
            uint32_t hull = (uint32_t)(random % ALL);
            NestPass pass = {hull, !inside[hull]};
            NestCrossing crossing, expected;
            inside[hull] = !inside[hull];
            assert_int_equal(cross_one(&list, &order, pass, &crossing), STATUS_OK);
            if (hull < OTHERS) {
                assert_int_equal(nest_cross(&plain, &without, &pass, 1, &expected), STATUS_OK);
                assert_true(crossing.medium_from == expected.medium_from && crossing.medium_to == expected.medium_to &&
                            crossing.owner_from == expected.owner_from && crossing.owner_to == expected.owner_to &&
                            crossing.n_faults == expected.n_faults && crossing.opaque == expected.opaque);
            } else {
                assert_int_equal(crossing.medium_from, crossing.medium_to);
                assert_int_equal(crossing.n_faults, 0);
                assert_int_equal(nest_has(&order, &list, hull), inside[hull]);
            }
            assert_int_equal(nest_owner(&order, &list), nest_owner(&without, &plain));
            assert_int_equal(nest_medium(&list), nest_medium(&plain));
            for (uint32_t k = 1; k < list.n; k++) /* at the front */
                assert_true(nest_list_items(&list)[k] < OTHERS || nest_list_items(&list)[k - 1] >= OTHERS);
        }
        nest_list_clear(&list);
        nest_list_clear(&plain);
        nest_order_clear(&order);
        nest_order_clear(&without);
    }
}

/* As many hulls as lists keep as bits, and one more: random surfaces, one or several at a place, some of them twice and
 * some against what the list says. */
static void test_bits_and_rows(void **state)
{
    (void)state;
    enum { MOST = NEST_NARROW + 1, STEPS = 60000 };
    NestHull hulls[MOST];
    uint64_t random = 5, n_faults = 0;
    for (uint32_t h = 0; h < MOST; h++) {
        random = hash_u64(random);
        hulls[h] =
            (NestHull){(uint32_t)(random % 5), (int32_t)(random >> 8 & 3), NEST_STATE_UNKNOWN, 1 + (double)h, false};
    }
    for (uint32_t n = MOST - 1; n <= MOST; n++) {
        NestOrder order;
        NestList list;
        assert_int_equal(nest_order_build(&order, NEST_PRIORITY, hulls, n, NULL, 0, NULL), STATUS_OK);
        assert_true(order.sorted && order.narrow == (n <= NEST_NARROW));
        nest_list_init(&list);
        for (int i = 0; i < STEPS && n; i++) {
            NestPass passes[3];
            NestCrossing crossing;
            uint32_t n_passes = 1 + (uint32_t)(i % 3);
            for (uint32_t k = 0; k < n_passes; k++) {
                random = hash_u64(random);
                uint32_t hull = k && random >> 60 == 0 ? passes[0].hull : (uint32_t)(random % n);
                passes[k] = (NestPass){hull, nest_has(&order, &list, hull) == ((random >> 32 & 31) == 0)};
            }
            assert_int_equal(n_passes > 1 ? cross(&list, &order, passes, n_passes, &crossing)
                                          : cross_one(&list, &order, passes[0], &crossing),
                             STATUS_OK);
            n_faults += crossing.n_faults;
            assert_int_equal(crossing.medium_to, nest_medium(&list));
            uint32_t count = nest_list_count(&list);
            assert_int_equal(nest_owner(&order, &list), count ? nest_item(&order, &list, count - 1) : NEST_WORLD);
        }
        nest_list_clear(&list);
        nest_order_clear(&order);
    }
    assert_true(n_faults > 1000 || NEST_NARROW == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bits_and_rows),
        cmocka_unit_test(test_table_partial_overlap),
        cmocka_unit_test(test_table_nested),
        cmocka_unit_test(test_table_three),
        cmocka_unit_test(test_table_floating_ice),
        cmocka_unit_test(test_table_one_medium),
        cmocka_unit_test(test_none_knows_the_world_only),
        cmocka_unit_test(test_together),
        cmocka_unit_test(test_faults_heal),
        cmocka_unit_test(test_entered_is_the_printed_stack),
        cmocka_unit_test(test_reversal),
        cmocka_unit_test(test_thousand_shells),
        cmocka_unit_test(test_rules),
        cmocka_unit_test(test_circle_falls_back_to_volume),
        cmocka_unit_test(test_order_respects_pairs),
        cmocka_unit_test(test_mixing_owns_nothing),
    };
    return cmocka_run_group_tests_name("nest", tests, NULL, NULL);
}

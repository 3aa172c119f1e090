// SPDX-License-Identifier: MIT
/* tolerance.c - draws, quantiles and shares of sagitta/tolerance.h: tolerance LENS
 *
 * Edits keep what the tolerances of a lens mean, or are refused.
 *
 * Binomial sums are held against the same in long double by logarithms of factorials, which the library does
 * not use. */
#include <sagitta/edit.h>
#include <sagitta/tolerance.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int faults;

#define EXPECT(holds, ...) \
    ((holds) ? 0 : (faults++, printf("line %d: ", __LINE__), printf(__VA_ARGS__), puts("")))

/* P(B >= k) of n and p. */
static double at_least(size_t n, double p, size_t k)
{
    long double sum = 0;
    for (size_t i = k; i <= n; i++)
        sum += expl(lgammal(n + 1.0L) - lgammal(i + 1.0L) - lgammal((long double)(n - i) + 1) +
                    (long double)i * logl(p) + (long double)(n - i) * log1pl(-(long double)p));
    return (double)sum;
}

static bool nearly(double x, double wanted) { return fabs(x - wanted) <= 1e-10 * fabs(wanted); }

static void try_shares(void)
{
    static const size_t sizes[] = {1, 2, 7, 50, 1000, 20000};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (size_t part = 0; part <= 10; part++) {
            const size_t n = sizes[s], k = n * part / 10;
            const sgt_confidence q = sgt_share(k, n, 0.9);
            EXPECT(q.estimate == (double)k / (double)n, "estimate of %zu in %zu", k, n);
            EXPECT(k ? nearly(at_least(n, q.lower, k), 0.05) : q.lower == 0, "%zu in %zu: lower %g", k, n,
                   q.lower);
            EXPECT(k < n ? nearly(1 - at_least(n, q.upper, k + 1), 0.05) : q.upper == 1,
                   "%zu in %zu: upper %g", k, n, q.upper);
        }
    EXPECT(isnan(sgt_share(1, 0, 0.9).estimate) && isnan(sgt_share(3, 2, 0.9).estimate), "no share");
}

/* Of the numbers 1 ... n the value is the rank. */
static void try_quantiles(void)
{
    static const size_t sizes[] = {1, 5, 30, 59, 1000, 20000};
    static const double shares[] = {0.001, 0.1, 0.5, 0.95, 0.999};
    double *rank = malloc(20000 * sizeof *rank);
    for (size_t i = 0; rank && i < 20000; i++) rank[i] = (double)(i + 1);
    for (size_t s = 0; rank && s < sizeof sizes / sizeof *sizes; s++)
        for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) {
            const size_t n = sizes[s];
            const double p = shares[k], half = 0.025;
            const sgt_confidence q = sgt_quantile(n, rank, p, 1 - 2 * half);
            EXPECT(q.estimate == fmax(1, ceil((double)n * p)), "%zu, %g: estimate %g", n, p, q.estimate);
            const size_t r = isnan(q.lower) ? 0 : (size_t)q.lower,
                         u = isnan(q.upper) ? n + 1 : (size_t)q.upper;
            /* the greatest r of P(B < r) <= half, the least u of P(B >= u) <= half */
            EXPECT(r == 0 || 1 - at_least(n, p, r) <= half, "%zu, %g: lower %zu", n, p, r);
            EXPECT(r == n || 1 - at_least(n, p, r + 1) > half, "%zu, %g: lower %zu is not the greatest", n, p,
                   r);
            EXPECT(u == n + 1 || at_least(n, p, u) <= half, "%zu, %g: upper %zu", n, p, u);
            EXPECT(u == 1 || at_least(n, p, u - 1) > half, "%zu, %g: upper %zu is not the least", n, p, u);
        }
    free(rank);
    EXPECT(isnan(sgt_quantile(0, NULL, 0.5, 0.95).estimate), "of nothing");
}

typedef struct seen {
    size_t count;
    double figure[8], value[8][16];
    size_t entries;
} seen;

static void see(void *context, const sgt_trial *trial)
{
    seen *s = context;
    s->figure[s->count] = trial->figure;
    memcpy(s->value[s->count++], trial->value, s->entries * sizeof(double));
}

/* A trial is its draw; the lens of its point has its figure; the box is what the file says. */
static void try_lens(const sgt_lens *lens)
{
    const sgt_tolerance *entry;
    const size_t n = sgt_lens_tolerances(lens, &entry);
    const sgt_pattern pattern = SGT_PATTERN_HEXAPOLAR;
    const sgt_study_options study = {.pattern = &pattern, .rays = 2};
    const sgt_tolerancing_options options = {.study = &study};
    const uint64_t first = (1ull << 40) + 5;
    sgt_error e = {.line = 0};
    seen s = {.entries = n};
    double value[16], figure;
    sgt_tolerancing *t = sgt_tolerancing_new(lens, &options, &e);
    EXPECT(t && n == 13, "%zu tolerances: %s", n, e.words);
    if (!t || n > 16) return;
    EXPECT(sgt_tolerancing_trials(t, 7, first, 8, see, &s, &e) && s.count == 8, "trials: %s", e.words);
    for (size_t i = 0; i < s.count; i++) {
        sgt_tolerancing_draw(t, 7, first + i, value);
        for (size_t k = 0; k < n; k++) {
            EXPECT(value[k] >= entry[k].lower && value[k] <= entry[k].upper, "out of the box");
            EXPECT(entry[k].compensator || value[k] == s.value[i][k], "trial %zu, entry %zu", i, k);
        }
        EXPECT(sgt_tolerancing_at(t, value, &figure, &e) && figure == s.figure[i], "trial %zu: %g", i,
               figure);
        EXPECT(memcmp(value, s.value[i], n * sizeof *value) == 0, "trial %zu: compensators", i);
        sgt_lens *built = sgt_tolerancing_lens(t, value, &e);
        sgt_tolerancing *again = built ? sgt_tolerancing_new(built, &options, &e) : NULL;
        EXPECT(again && sgt_tolerancing_nominal(again) == figure, "trial %zu: its lens: %s", i, e.words);
        EXPECT(built && sgt_lens_tolerances(built, NULL) == 0, "a lens that is built has tolerances");
        sgt_tolerancing_free(again);
        sgt_lens_free(built);
    }
    sgt_tolerancing_free(t);
    const sgt_tolerancing_options later = {.reserved_ = {1}};
    EXPECT(!sgt_tolerancing_new(lens, &later, &e), "a later version's member");
}

/* What an edit of the lens makes of them: the surfaces of tolerance `at` and its upper end. */
static void try_edit(const sgt_lens *lens, sgt_edit edit, size_t at, size_t first, size_t last, double upper)
{
    sgt_error e = {.line = 0};
    const sgt_tolerance *entry;
    sgt_lens *other = sgt_lens_copy(lens, &e);
    if (!other) exit(2);
    const bool fine = sgt_lens_edit(other, 1, &edit, &e);
    if (first == 0)
        EXPECT(!fine && strstr(e.words, "tolerances["), "not refused: %s", e.words);
    else {
        EXPECT(fine, "%s: %s", e.key, e.words);
        const size_t n = sgt_lens_tolerances(other, &entry);
        EXPECT(at < n && entry[at].first == first && entry[at].last == last && entry[at].upper == upper,
               "%s: %zu: %zu to %zu, %g", edit.path ? edit.path : "", at, entry[at].first, entry[at].last,
               entry[at].upper);
    }
    sgt_lens_free(other);
}

static void try_edits(const sgt_lens *lens)
{
    const char plane[] = "{type: plane, thickness: 1}";
    const sgt_edit front = {.kind = SGT_EDIT_INSERT, .path = "surfaces[1]", .text = plane},
                   middle = {.kind = SGT_EDIT_INSERT,
                             .path = "surfaces[4]",
                             .text = "{type: break, thickness: 0}"},
                   gone = {.kind = SGT_EDIT_REMOVE, .path = "surfaces[4]"},
                   entry = {.kind = SGT_EDIT_REMOVE, .path = "tolerances[1]"},
                   larger = {.kind = SGT_EDIT_SCALE, .number = 2},
                   turned = {.kind = SGT_EDIT_REVERSE, .path = "surfaces[3]", .text = "surfaces[4]"};
    /* 0: radius of surface 1; 1: fringes of surface 2; 8, 9: surfaces 3 to 4 decentred, tilted */
    try_edit(lens, front, 0, 2, 2, 0.02);
    try_edit(lens, front, 8, 4, 5, 0.01);
    try_edit(lens, middle, 8, 3, 4, 0.01);
    try_edit(lens, entry, 0, 2, 2, 4);
    try_edit(lens, larger, 0, 1, 1, 0.04);
    try_edit(lens, larger, 1, 2, 2, 4);
    try_edit(lens, larger, 9, 3, 4, 0.02);
    try_edit(lens, gone, 0, 0, 0, 0);
    try_edit(lens, turned, 0, 0, 0, 0);
}

/* An allocator that has so many blocks to give. */
typedef struct giver {
    long left, held;
} giver;

static void *give(void *context, void *block, size_t size)
{
    giver *g = context;
    if (size == 0) {
        g->held -= block != NULL;
        free(block);
        return NULL;
    }
    if (g->left-- <= 0) return NULL;
    g->held += block == NULL;
    return realloc(block, size);
}

/* Without memory, wherever it ends, there is an error that says so, and nothing is kept. */
static void try_no_memory(const char *file, const char *compensator)
{
    giver g = {.left = 1L << 40};
    const sgt_allocator a = {give, &g};
    const sgt_lens_options reading = {.allocator = &a};
    const sgt_pattern pattern = SGT_PATTERN_HEXAPOLAR;
    const sgt_study_options study = {.allocator = &a, .pattern = &pattern, .rays = 1};
    const sgt_tolerancing_options options = {.study = &study};
    sgt_error e;
    sgt_lens *lens = sgt_lens_read(file, &reading, &e);
    if (!lens || !sgt_lens_set_text(lens, "tolerances[13].compensator", compensator, &e)) exit(2);
    const long with_lens = g.held;
    sgt_sensitivity row[16];
    size_t count, tries = 0;
    for (long most = 0, step = 1; tries < 10000; most += step, step += most / 50, tries++) {
        seen s = {.entries = 13};
        g.left = most, e = (sgt_error){.line = 0};
        sgt_tolerancing *t = sgt_tolerancing_new(lens, &options, &e);
        const bool fine = t && sgt_tolerancing_trials(t, 1, 0, 2, see, &s, &e) &&
                          sgt_tolerancing_sensitivity(t, &count, row, NULL, &e);
        sgt_tolerancing_free(t);
        EXPECT(g.held == with_lens, "%ld blocks: %ld are kept", most, g.held - with_lens);
        if (fine) break;
        EXPECT(strstr(e.words, "no memory"), "%ld blocks: %s: %s", most, e.key, e.words);
    }
    EXPECT(tries > 20 && tries < 10000, "%zu tries", tries);
    g.left = 1L << 40;
    sgt_lens_free(lens);
    EXPECT(g.held == 0, "%ld blocks are kept", g.held);
}

int main(int argc, char *argv[])
{
    sgt_error e;
    sgt_lens *lens = argc == 2 ? sgt_lens_read(argv[1], NULL, &e) : NULL;
    if (!lens) return 2;
    try_shares();
    try_quantiles();
    try_lens(lens);
    try_edits(lens);
    try_no_memory(argv[1], "paraxial");
    try_no_memory(argv[1], "figure");
    sgt_lens_free(lens);
    return faults ? 1 : 0;
}

// SPDX-License-Identifier: MIT
/* checksum.h - one number for the answers about a surface: to the last bit, a NaN as a NaN, whichever. */
#ifndef TESTS_BATCH_CHECKSUM_H
#define TESTS_BATCH_CHECKSUM_H

#include "../ends.h"
#include "hostile.h"

#include <sagitta/sensitivity.h>

static uint64_t sum_of_part;
static size_t rays_of_part;
static bool listed;

static void add_bits(uint64_t bits)
{
    sum_of_part = (sum_of_part ^ bits) * 0x9e3779b97f4a7c15u;
    sum_of_part ^= sum_of_part >> 32;
}

static void add_number(double x) { add_bits(x == x ? bits_of(x) : 0x7ff8000000000000u); }
static void add_vector(sgt_vec3 v) { add_number(v.x), add_number(v.y), add_number(v.z); }

static void add_hit(const sgt_hit *h)
{
    add_bits((uint64_t)(h->status - SGT_INVALID) << 32 | (uint64_t)h->evals);
    const double numbers[] = {h->t, h->t_err, h->t_lo, h->lo, h->hi, h->f, h->p_err};
    for (size_t i = 0; i < COUNT_OF(numbers); i++) add_number(numbers[i]);
    add_vector(h->p), add_vector(h->n);
}

static void list_ray(const sgt_ray *ray, const char *how)
{
    rays_of_part++;
    if (listed) printf("%016llx %s\n", (unsigned long long)sum_of_part, how), print_ray(ray);
}

/* ---------------------------------------------------------------- batches */

enum { BATCH = 300 };
static sgt_ray rays[BATCH];
static double in[8][BATCH];

static sgt_rays as_arrays(size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (int j = 0; j < 8; j++) in[j][i] = j == 7 ? end_of(&rays[i]) : *component(&rays[i], j);
    return (sgt_rays){{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, in[6], in[7]};
}

typedef struct hit_arrays {
    sgt_status status[BATCH];
    int evals[BATCH];
    double number[10][BATCH];
} hit_arrays;

static sgt_hits pointers(hit_arrays *a)
{
    return (sgt_hits){.status = a->status,
                      .evals = a->evals,
                      .t = a->number[0],
                      .t_err = a->number[1],
                      .t_lo = a->number[2],
                      .p_err = a->number[3],
                      .p = {a->number[4], a->number[5], a->number[6]},
                      .n = {a->number[7], a->number[8], a->number[9]}};
}

static void add_arrays(const hit_arrays *a, size_t i)
{
    add_bits((uint64_t)(a->status[i] - SGT_INVALID) << 32 | (uint64_t)a->evals[i]);
    for (int j = 0; j < 10; j++) add_number(a->number[j][i]);
}

/* Of all that there is some: what a batch works out depends on what is wanted. */
static sgt_hits some_of(sgt_hits all)
{
    static unsigned turn;
    switch (turn++ % 4) {
    case 0: return (sgt_hits){.t = all.t};
    case 1: all.evals = NULL; return all;
    case 2:
        return (sgt_hits){.status = all.status,
                          .t = all.t,
                          .t_err = all.t_err,
                          .p = {all.p[0], all.p[1], all.p[2]},
                          .n = {all.n[0], all.n[1], all.n[2]}};
    default: return (sgt_hits){.status = all.status, .evals = all.evals, .p_err = all.p_err};
    }
}

/* The derivatives of the hits of a batch: by o and by the first parameters; of some rays alone, by all; the
 * change that all of them make together. */
static void add_derivatives(sgt_surface s, size_t n, sgt_hits hits)
{
    enum { FEW = 6, LONGEST = 8192 };
    static double by_o[21][BATCH], by_a[7][FEW][BATCH], changed[7][BATCH], da[LONGEST];
    static double *lists[7][LONGEST];
    static sgt_change alone_by_a[LONGEST];
    size_t count = sgt_parameters(s);
    if (count > LONGEST) return;
    for (int k = 0; k < 7; k++)
        for (size_t j = 0; j < count; j++) lists[k][j] = j < FEW ? by_a[k][j] : NULL;
    sgt_jacobian out = {.t_by_a = lists[0],
                        .p_by_a = {lists[1], lists[2], lists[3]},
                        .n_by_a = {lists[4], lists[5], lists[6]}};
    for (int k = 0; k < 3; k++) {
        out.t_by_o[k] = by_o[k];
        for (int j = 0; j < 3; j++)
            out.p_by_o[k][j] = by_o[3 + 3 * k + j], out.n_by_o[k][j] = by_o[12 + 3 * k + j];
    }
    add_bits((uint64_t)sgt_differentiate_batch(s, n, as_arrays(n), hits, out));
    for (size_t j = 0; j < count; j++) da[j] = j % 3 ? 1e-3 / (double)j : 0;
    sgt_rays change = {.o = {in[3], in[4], in[5]}, .d = {in[0], in[1], in[2]}};
    sgt_changes changes = {
        changed[0], {changed[1], changed[2], changed[3]}, {changed[4], changed[5], changed[6]}};
    add_bits((uint64_t)sgt_differentiate_forward(s, n, as_arrays(n), hits, change, da, changes));
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 21; k++) add_number(by_o[k][i]);
        for (int k = 0; k < 7; k++) {
            add_number(changed[k][i]);
            for (size_t j = 0; j < FEW && j < count; j++) add_number(by_a[k][j][i]);
        }
        list_ray(&rays[i], "its derivatives");
        if (i % 16) continue;
        sgt_change alone_by_o[3];
        const sgt_hit hit = {.status = (sgt_status)hits.status[i],
                             .t = hits.t[i],
                             .p = {hits.p[0][i], hits.p[1][i], hits.p[2][i]},
                             .n = {hits.n[0][i], hits.n[1][i], hits.n[2][i]}};
        add_bits((uint64_t)sgt_differentiate(s, &rays[i], &hit, alone_by_o, alone_by_a));
        for (size_t j = 0; j < 3 + count; j++) {
            const sgt_change *by = j < 3 ? &alone_by_o[j] : &alone_by_a[j - 3];
            add_number(by->t), add_vector(by->p), add_vector(by->n);
        }
        list_ray(&rays[i], "its derivatives alone");
    }
}

/* Each ray alone, all its roots, and all in a batch, of which everything is wanted, or some. */
static void add_surface(sgt_surface s, size_t n, const sgt_options *opt)
{
    static hit_arrays out, some;
    sgt_hit all[4];
    for (size_t i = 0; i < n; i++) {
        sgt_hit hit = sgt_intersect(s, rays[i], opt);
        add_hit(&hit);
        if (i % 4 == 0) {
            int entries = sgt_intersect_all(s, rays[i], 4, all, opt);
            add_bits((uint64_t)entries);
            for (int j = 0; j < entries && j < 4; j++) add_hit(&all[j]);
        }
        list_ray(&rays[i], "alone");
    }
    memset(&some, 0, sizeof some);
    add_bits(sgt_intersect_batch(s, n, as_arrays(n), pointers(&out), opt));
    add_bits(sgt_intersect_batch(s, n, as_arrays(n), some_of(pointers(&some)), opt));
    for (size_t i = 0; i < n; i++) {
        add_arrays(&out, i);
        list_ray(&rays[i], "in a batch");
        add_arrays(&some, i);
        list_ray(&rays[i], "in a batch, not all wanted");
    }
    add_derivatives(s, n, pointers(&out));
}

/* ------------------------------------------------------------------------- parts */

static bool begin(const char *part, int argc, char **argv)
{
    sum_of_part = 0, rays_of_part = 0, listed = argc > 1;
    return argc < 2 || !strcmp(argv[1], part);
}

static void end(const char *part)
{
    if (!listed) printf("%-16s %7zu rays  %016llx\n", part, rays_of_part, (unsigned long long)sum_of_part);
}

#endif

// SPDX-License-Identifier: MIT
/* shard.c - one shard of a run, or all of them joined (shard.h). */
#include "shard.h"

#include "fail.h"
#include "input.h"
#include "memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static struct {
    part_of_run own;            /* of a shard; of who joins that of the parts, with number 0; of 0: none */
    const char *path;
    bool resume;
    run_part *part;                 /* [own.of]: those that are joined, in their order */
} shard;

bool shard_is(void) { return shard.own.number; }
bool shard_joins(void) { return shard.own.of && !shard.own.number; }
size_t shard_number(void) { return (size_t)shard.own.number; }
size_t shard_count(void) { return (size_t)shard.own.of; }
const part_of_run *shard_joined(void) { return &shard.own; }

/* "sagitta spot lens.yaml --cells 100" */
static const char *said(const part_of_run *of)
{
    const char *all = "sagitta";
    for (const char *at = of->arguments; at < of->arguments + of->length; at += strlen(at) + 1)
        all = memory_print("%s %s", all, at);
    return all;
}

static bool same_arguments(const part_of_run *a, const part_of_run *b)
{
    return a->length == b->length && memcmp(a->arguments, b->arguments, a->length) == 0;
}

/* ------------------------------------------------------------------------ a shard */

void shard_be(const shard_options *o, const char *path, const char *arguments, size_t length)
{
    if (!path) fail_usage("--shard goes with --output PART");
    shard.own = (part_of_run){.number = (uint64_t)o->number, .of = (uint64_t)o->of, .arguments = arguments,
                              .length = length};
    shard.path = path, shard.resume = o->resume;
}

/* Is the part there, and whole?  One that is not is made anew; of another run it is an error. */
static bool is_whole(void)
{
    struct stat is;
    run_part p;
    if (stat(shard.path, &is) != 0) return false;
    const char *fault = part_read(shard.path, &p);
    if (fault) {
        note("--resume: %s: %s; it is made anew", shard.path, fault);
        return false;
    }
    if (p.of.number != shard.own.number || p.of.of != shard.own.of || !same_arguments(&p.of, &shard.own))
        fail_input("--resume: %s is part %zu of %zu of another run: %s", shard.path, (size_t)p.of.number,
                   (size_t)p.of.of, said(&p.of));
    if (p.of.digest != shard.own.digest)
        fail_input("--resume: %s was made of another lens, or of other rays", shard.path);
    return true;
}

void shard_begin(void)
{
    const uint64_t digest = shard.own.digest = input_digest();
    for (size_t i = 0; shard_joins() && i < shard.own.of; i++)
        if (shard.part[i].of.digest != digest)
            fail_input("%s: made of another lens, or of other rays, than there are now", shard.part[i].path);
    if (!shard_is()) return;
    output_check("output", shard.path);
    if (shard.resume && is_whole()) {
        note("--resume: %s is whole", shard.path);
        exit(EXIT_DECIDED);
    }
    part_begin(shard.path, &shard.own);
}

void shard_end(void)
{
    if (shard_is()) part_end();
}

bool shard_write(void *context, size_t size, const void *bytes)
{
    (void)context;
    part_put(bytes, size);
    return true;
}

/* ----------------------------------------------------------------------- joining */

static void take_part(const run_part *p)
{
    const run_part *first = NULL;
    for (size_t i = 0; i < shard.own.of && !first; i++)
        if (shard.part[i].path) first = &shard.part[i];
    if (first && p->of.of != shard.own.of)
        fail_input("%s is part %zu of %zu, and %s is one of %zu", p->path, (size_t)p->of.number,
                   (size_t)p->of.of, first->path, (size_t)shard.own.of);
    if (first && !same_arguments(&p->of, &shard.own))
        fail_input("%s is a part of another run than %s: %s; not %s", p->path, first->path, said(&p->of),
                   said(&shard.own));
    if (first && p->of.digest != first->of.digest)
        fail_input("%s was made of another lens, or of other rays, than %s", p->path, first->path);
    if (!first) {
        shard.own = p->of, shard.own.number = 0;
        shard.part = memory_take((size_t)p->of.of, sizeof *shard.part);
    }
    run_part *to = &shard.part[p->of.number - 1];
    if (to->path) fail_input("%s and %s are both part %zu", to->path, p->path, (size_t)p->of.number);
    *to = *p;
}

void shard_join(int count, char *const path[])
{
    for (int i = 0; i < count; i++) {
        run_part p;
        const char *fault = part_read(path[i], &p);
        if (fault) fail_input("%s: %s", path[i], fault);
        if (p.of.of > INT32_MAX) fail_input("%s: damaged", path[i]);
        take_part(&p);
    }
    for (size_t i = 0; i < shard.own.of; i++)
        if (!shard.part[i].path)
            fail_input("part %zu of %zu is missing; %s is another one of this run", i + 1, shard_count(),
                       path[0]);
}

/* Records are read one after another. */
bool shard_read(void *context, size_t number, size_t size, void *bytes)
{
    run_part *p = &shard.part[number - 1];
    size_t length;
    const void *record = part_record(p, p->next, &length);
    (void)context;
    if (!record || length != size) fail_input("%s: not a part of this run", p->path);
    memcpy(bytes, record, size);
    p->next++;
    return true;
}

/* ------------------------------------------------------------------------- tiles */

static shard_range range_at(size_t all, size_t k)
{
    const size_t n = shard_count(), each = all / n, rest = all % n;
    return (shard_range){each * (k - 1) + rest * (k - 1) / n, each * k + rest * k / n};
}

shard_range shard_range_of(size_t all)
{
    return shard_is() ? range_at(all, shard_number()) : (shard_range){0, all};
}

static size_t tile_size(const tiling *of) { return of->most ? of->most : TILE_RAYS; }

tiling shard_tiling(tiling of)
{
    const size_t size = tile_size(&of), all = of.rays / size + (of.rays % size != 0);
    if (!shard_count()) return of;
    const shard_range own = shard_range_of(all);
    of.fixed = true, of.skip = own.first * size;
    const size_t end = own.end * size < of.rays ? own.end * size : of.rays;
    of.rays = end > of.skip ? end - of.skip : 0;
    return of;
}

const void *shard_tile(const tiling *of, size_t pass, const tile *t, size_t *size)
{
    const size_t each = tile_size(of), all = of->rays / each + (of->rays % each != 0), i = t->first / each;
    size_t k = i * shard_count() / all + 1;
    while (range_at(all, k).end <= i) k++;
    const shard_range has = range_at(all, k);
    const run_part *p = &shard.part[k - 1];
    const void *record = part_record(p, pass * (has.end - has.first) + i - has.first, size);
    if (!record) fail_input("%s: not a part of this run", p->path);
    return record;
}

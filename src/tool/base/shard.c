// SPDX-License-Identifier: MIT
/* shard.c - one shard of a run, or all of them joined (shard.h). */
#include "shard.h"

#include "fail.h"
#include "input.h"
#include "memory.h"
#include "progress.h"
#include "ranks.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* RANKS.  A pass of a study, and a run of tiles, has at most SHARES shares, however many ranks there are: so
 * another number of them can go on (--resume).  It is a compromise: the last rank of a pass is waited for by
 * at most the others' time for a share; each share costs a file. */
enum { SHARES = 256 };

static struct {
    part_of_run own;            /* of a shard; of who joins that of the parts, with number 0; of 0: none */
    const char *path;
    bool resume;
    run_part *part;                 /* [own.of]: those that are joined, in their order */
    /* Of ranks: their folder; whether this one works on shares now; the pass; the part that is being written,
     * its path; that which is read now, of the pass that is done. */
    const char *folder;
    bool works;
    size_t pass, read_pass, rays; /* rays: of a run of tiles */
    char *writing;
    run_part open;
} shard;

bool shard_ranks(void) { return shard.folder; }
bool shard_is(void) { return shard.folder ? shard.works || ranks_here() : shard.own.number; }
bool shard_joins(void) { return shard.own.of && !shard_is(); }
size_t shard_number(void) { return (size_t)(shard.folder ? ranks_here() : (int)shard.own.number); }
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
static bool is_whole(const char *path, const part_of_run *own)
{
    struct stat is;
    run_part p;
    if (stat(path, &is) != 0) return false;
    const char *fault = part_read(path, &p);
    if (fault) {
        note("--resume: %s: %s; it is made anew", path, fault);
        return false;
    }
    if (p.of.number != own->number || p.of.of != own->of || !same_arguments(&p.of, own))
        fail_input("--resume: %s is part %zu of %zu of another run: %s", path, (size_t)p.of.number,
                   (size_t)p.of.of, said(&p.of));
    if (p.of.digest != own->digest)
        fail_input("--resume: %s was made of another lens, or of other rays", path);
    part_leave(&p);
    return true;
}

/* ------------------------------------------------------------------------ ranks */

void shard_be_rank(const char *path, bool resume, const char *arguments, size_t length)
{
    if (resume && !path) fail_usage("--resume goes with --output FILE: parts are kept in FILE.parts");
    shard.own = (part_of_run){.of = SHARES, .arguments = arguments, .length = length};
    shard.path = path, shard.resume = resume, shard.folder = path ? memory_print("%s.parts", path) : "";
}

/* Removes the parts in the folder: all, or only those that are not finished. */
static void remove_parts(bool all)
{
    static const char *const ends[] = {".unfinished", ".part"};
    DIR *folder = opendir(shard.folder);
    for (struct dirent *e; folder && (e = readdir(folder));)
        for (int i = 0; i < 1 + all; i++) {
            const size_t length = strlen(e->d_name), end = strlen(ends[i]);
            if (length > end && strcmp(e->d_name + length - end, ends[i]) == 0)
                remove(memory_print("%s/%s", shard.folder, e->d_name));
        }
    if (folder) closedir(folder);
}

static void begin_ranks(void)
{
    long process = (long)getpid();
    ranks_meet(shard.own.digest);
    ranks_tell(&process, sizeof process);
    if (!shard.path) shard.folder = memory_print("sagitta-mpi.%ld.parts", process);
    if (!ranks_here() && mkdir(shard.folder, 0777) != 0 && errno != EEXIST)
        fail_input("%s: %s", shard.folder, strerror(errno));
    if (!ranks_here()) remove_parts(!shard.resume);
    ranks_wait();
}

void shard_clear(void)
{
    if (!shard.folder || ranks_here()) return;
    remove_parts(true);
    rmdir(shard.folder);
}

bool shard_keeps(void) { return shard.resume; }
void shard_forget(void) { remove_parts(true); }

static char *part_path(size_t pass, size_t k)
{
    return memory_print("%s/%zu-%zu.part", shard.folder, pass, k);
}

size_t shard_next(void *context, size_t of)
{
    (void)context;
    if (shard.writing) part_end();
    shard.works = true;
    for (size_t k; (k = ranks_next() + 1) <= of;) {
        part_of_run own = shard.own;
        own.number = k, own.of = of;
        memory_drop(shard.writing);
        shard.writing = part_path(shard.pass, k);
        if (!ranks_here()) progress_share(shard.pass, k, of, shard.rays);
        if (shard.resume && is_whole(shard.writing, &own)) continue;
        part_begin(shard.writing, &own, true);
        return k;
    }
    memory_drop(shard.writing);
    shard.writing = NULL, shard.works = false;
    ranks_wait();
    if (!ranks_here()) progress_share(shard.pass, of + 1, of, shard.rays);
    shard.read_pass = shard.pass++;
    part_leave(&shard.open);
    return 0;
}

/* Part k of the pass that is done. */
static run_part *open_part(size_t k)
{
    run_part *p = &shard.open;
    if (p->path && p->of.number == k) return p;
    memory_drop((char *)(uintptr_t)p->path);
    part_leave(p);
    const char *path = part_path(shard.read_pass, k), *fault = part_read(path, p);
    if (fault) fail_input("%s: %s", path, fault);
    if (p->of.number != k || p->of.digest != shard.own.digest || !same_arguments(&p->of, &shard.own))
        fail_input("%s: not a part of this run", path);
    return p;
}

/* ------------------------------------------------------------------------ both */

void shard_begin(void)
{
    const uint64_t digest = shard.own.digest = input_digest();
    if (shard.folder) begin_ranks();
    if (shard.folder) return;
    for (size_t i = 0; shard_joins() && i < shard.own.of; i++)
        if (shard.part[i].of.digest != digest)
            fail_input("%s: made of another lens, or of other rays, than there are now", shard.part[i].path);
    if (!shard_is()) return;
    output_check("output", shard.path);
    if (shard.resume && is_whole(shard.path, &shard.own)) {
        note("--resume: %s is whole", shard.path);
        exit(EXIT_DECIDED);
    }
    part_begin(shard.path, &shard.own, false);
}

void shard_end(void)
{
    if (!shard.folder && shard_is()) part_end();
}

bool shard_write(void *context, size_t size, const void *bytes)
{
    (void)context;
    part_put(bytes, size);
    ranks_serve();
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
    run_part *p = shard.folder ? open_part(number) : &shard.part[number - 1];
    size_t length;
    const void *record = part_record(p, p->next, &length);
    (void)context;
    if (!record || length != size) fail_input("%s: not a part of this run", p->path);
    memcpy(bytes, record, size);
    p->next++;
    return true;
}

/* ------------------------------------------------------------------------- tiles */

/* The first of all tiles that share k of n has. */
static size_t first_at(size_t all, size_t k, size_t n) { return all / n * (k - 1) + all % n * (k - 1) / n; }

static size_t tile_size(const tiling *of) { return of->most ? of->most : TILE_RAYS; }

static size_t tile_count(const tiling *of)
{
    return of->rays / tile_size(of) + (of->rays % tile_size(of) != 0);
}

/* The tiles of share k of n. */
static tiling tiling_of(tiling of, size_t k, size_t n)
{
    const size_t size = tile_size(&of), all = tile_count(&of), end = first_at(all, k + 1, n) * size;
    of.fixed = true, of.skip = first_at(all, k, n) * size;
    of.rays = end < of.rays ? end : of.rays;
    of.rays = of.rays > of.skip ? of.rays - of.skip : 0;
    return of;
}

tiling shard_tiling(tiling of)
{
    if (!shard_count()) return of;
    return shard.own.number ? tiling_of(of, shard_number(), shard_count()) : tiling_of(of, 1, 1);
}

void shard_run(const tiling *whole, void *data, void (*work)(void *data, const tile *),
               void (*take)(void *data, const tile *))
{
    const size_t all = tile_count(whole), of = all < SHARES ? all : SHARES;
    tiling own = shard_tiling(*whole);
    if (!shard.folder) tiles_run(&own, data, work, take);
    if (!shard.folder) return;
    shard.rays = whole->rays;
    for (size_t k; (k = shard_next(NULL, of)) != 0;)
        own = tiling_of(*whole, k, of), tiles_run(&own, data, work, take);
    for (size_t k = 1; k <= of && shard_joins(); k++) {
        own = tiling_of(*whole, k, of);
        open_part(k), tiles_run(&own, data, work, take);
    }
}

const void *shard_tile(const tiling *of, size_t pass, const tile *t, size_t *size)
{
    const size_t all = tile_count(of), i = t->first / tile_size(of);
    const size_t n = shard.folder ? (size_t)shard.open.of.of : shard_count();
    size_t k = i * n / all + 1;
    while (first_at(all, k + 1, n) <= i) k++;
    const size_t first = first_at(all, k, n), each = first_at(all, k + 1, n) - first;
    const run_part *p = shard.folder ? &shard.open : &shard.part[k - 1];
    const void *record = part_record(p, (shard.folder ? 0 : pass * each) + i - first, size);
    if (!record) fail_input("%s: not a part of this run", p->path);
    return record;
}

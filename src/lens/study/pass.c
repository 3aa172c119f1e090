// SPDX-License-Identifier: MIT
/* pass.c - the rays of many cells, in blocks.
 *
 * BLOCKS.  What a ray does depends on that ray alone.  So blocks of PUPIL_PART points may be traced in any
 * thread; what is made of a block is made there, too, and then taken in order.  A block is a run of numbers
 * of points: which rays it has depends neither on threads nor on machines.
 *
 * SUMS of blocks are merged in a tree of their numbers (tree.h), so that neither have these a part in them.
 *
 * SHARES (sgt_shard).  Of each pass a share works on a run of its tasks, and writes what `take` would get: of
 * a pass that merges only the branches of each cell, so that it does not grow with the rays.  Who joins reads
 * these in place of tracing, in the same order; all that follows is what it is in one run.  What later passes
 * depend on (`before`) every share computes whole, and the first one writes it.  Programs that take shares as
 * they become free (`next`) divide that, too, and each of them joins it.
 *
 * AIMED RAYS of a cell of 256 rays or more begin at a map of the pupil (optics/aim_map.c).  It is made before
 * the first round that has a block of the cell, and kept until the last.  That of a beam of the study is kept
 * longer, for later passes and for image surfaces that are moved: it hangs on the beam and on the elements up
 * to the stop, nothing else.  So neither blocks, nor threads, nor passes change a bit of it. */
#include "study.h"
#include "tree.h"

#include <stdatomic.h>
#include <string.h>

enum { ROOMS = 16 };

/* Of a block: its rays, their fates, and the first that is lost. */
typedef struct block {
    size_t count;
    sgt_fates fates;
    double lost_x, lost_y;
    bool placed;
    sgt_error fault;            /* if it is not placed; of no use to who joins */
} block_of_rays;

/* maps: of the cells mapped ... mapped + maps - 1, if rays are aimed and a cell is worth it.  fresh: which of
 * them are to be made. */
typedef struct passing {
    const pass *p;
    size_t blocks, tasks, slot; /* of a cell; of all cells; bytes of a slot */
    size_t end;                 /* of the tasks that are worked on here */
    size_t shares;              /* 0: the study is not divided */
    bool tells, writes;         /* what is taken is told; is written for who joins */
    sgt_fates fates;            /* of the cell so far, and where its first lost ray was */
    double lost_x, lost_y;
    sum_tree tree;
    sgt_aim_nodes *nodes;
    sgt_aim_map *map;
    size_t mapped, maps, *fresh;
    _Atomic(sgt_ends_room *) room[ROOMS]; /* those that no block uses now */
} passing;

/* Room for a block: one that lies there, or a new one.  NULL: no memory. */
static sgt_ends_room *room_taken(passing *now)
{
    for (size_t i = 0; i < ROOMS; i++) {
        sgt_ends_room *room = atomic_exchange(&now->room[i], NULL);
        if (room) return room;
    }
    return sgt_ends_room_new(now->p->ask->from, PUPIL_PART, now->p->wanted, PUPIL_PART);
}

static void room_given_back(passing *now, sgt_ends_room *room)
{
    for (size_t i = 0; i < ROOMS; i++) {
        sgt_ends_room *none = NULL;
        if (atomic_compare_exchange_strong(&now->room[i], &none, room)) return;
    }
    sgt_ends_room_free(now->p->ask->from, room);
}

/* Of a slot: where its sum begins, and the ends behind that, if they are taken. */
static size_t sum_at(void) { return (sizeof(block_of_rays) + 63) / 64 * 64; }
static size_t ends_at(const pass *p) { return sum_at() + (p->size + p->spare + 63) / 64 * 64; }

/* The bytes of a slot behind sum_at() that a block uses. */
static size_t used_of(const passing *now, size_t nth)
{
    const pass *p = now->p;
    const size_t left = p->points->count - nth * PUPIL_PART;
    if (!p->takes_ends) return p->size;
    return ends_at(p) - sum_at() + (left < PUPIL_PART ? left : PUPIL_PART) * sizeof(sgt_ray_end);
}

/* Does `take` get this block of a cell? */
static bool is_taken(const pass *p, size_t nth) { return p->take && (!p->merge || nth < p->shown); }

static bool work_block(void *data, size_t i, void *slot)
{
    passing *now = data;
    const pass *p = now->p;
    const size_t of = i / now->blocks, nth = i % now->blocks, first = nth * PUPIL_PART;
    const size_t left = p->points->count - first;
    block_of_rays *b = slot;
    void *sum = (char *)slot + sum_at();
    sgt_pupil_point at[PUPIL_PART];
    cell c = {.beam = NULL};
    if (now->writes && (!p->merge || is_taken(p, nth)))
        memset(slot, 0, sum_at() + used_of(now, nth)); /* what is written has no bytes that nothing set */
    b->count = left < PUPIL_PART ? left : PUPIL_PART;
    b->fates = (sgt_fates){.rays = 0};
    memset(sum, 0, p->size);
    b->placed = p->place(p, of, &c, &b->fault);
    if (!b->placed) return true;
    sgt_pupil_part(p->points, first, b->count, at);
    sgt_ends_room *room = room_taken(now);
    if (!room) return false;
    const sgt_aim_map *map = now->nodes ? &now->map[of - now->mapped] : NULL;
    const sgt_colour_beam beam = {p->ask->from, c.beam, c.element, c.before, map};
    sgt_ray_end *end = sgt_trace_ends(&beam, room, b->count, at, p->ask->study->opt.solver,
                                      p->takes_ends ? (void *)((char *)slot + ends_at(p)) : NULL);
    for (size_t k = 0; k < b->count; k++) {
        const size_t lost = b->fates.lost;
        sgt_fates_count(&b->fates, &end[k]);
        if (b->fates.lost > lost && lost == 0) b->lost_x = end[k].px, b->lost_y = end[k].py;
    }
    if (p->block) p->block(p, of, b->count, end, sum);
    room_given_back(now, room);
    return true;
}

/* ------------------------------------------------------------------------ shares */

/* What a share writes of a cell whose blocks are merged; each branch, and its sum, come behind it. */
typedef struct cell_record { sgt_fates fates; double lost_x, lost_y; uint64_t branches; } cell_record;

static void write_cell(passing *now)
{
    sgt_asking *a = now->p->ask;
    const sum_tree *t = &now->tree;
    const cell_record r = {now->fates, now->lost_x, now->lost_y, t->branches};
    sgt_shard_put(a, sizeof r, &r);
    for (size_t i = 0; i < t->branches; i++) {
        sgt_shard_put(a, sizeof *t->branch, &t->branch[i]);
        sgt_shard_put(a, t->size, sgt_tree_sum(t, i));
    }
}

/* The tasks of share number k, from 1. */
typedef struct task_range { size_t first, end; } task_range;

static task_range range_of(const passing *now, size_t k)
{
    const bool whole = now->p->before && !now->p->ask->study->opt.shard->next;
    if (whole) return (task_range){k == 1 ? 0 : now->tasks, now->tasks};
    return (task_range){sgt_shard_begin(now->tasks, k, now->shares),
                        sgt_shard_begin(now->tasks, k + 1, now->shares)};
}

/* Counts the fates of rays of a cell, the first lost of which was sent through x, y. */
static void count_fates(passing *now, size_t of, const sgt_fates *more, double x, double y)
{
    sgt_asking *a = now->p->ask;
    if (more->lost && now->fates.lost == 0) now->lost_x = x, now->lost_y = y;
    if (a->counts && more->lost && a->total.fates.lost == 0) {
        now->p->lost(now->p, of, &a->total.lost);
        a->total.lost.px = x, a->total.lost.py = y;
    }
    if (a->counts) sgt_fates_add(&a->total.fates, more);
    sgt_fates_add(&now->fates, more);
}

/* A slot, without what is of no use. */
static void write_slot(const passing *now, size_t nth, const void *slot)
{
    sgt_asking *a = now->p->ask;
    sgt_shard_put(a, offsetof(block_of_rays, fault), slot);
    sgt_shard_put(a, used_of(now, nth), (const char *)slot + sum_at());
}

static bool read_slot(const passing *now, size_t k, size_t nth, void *slot)
{
    sgt_asking *a = now->p->ask;
    return sgt_shard_get(a, k, offsetof(block_of_rays, fault), slot) &&
           sgt_shard_get(a, k, used_of(now, nth), (char *)slot + sum_at());
}

static void tell_block(const passing *now, size_t i, const void *slot)
{
    const pass *p = now->p;
    const block_of_rays *b = slot;
    const void *end = p->takes_ends ? (const char *)slot + ends_at(p) : NULL;
    if (is_taken(p, i % now->blocks))
        p->take(p, i / now->blocks, b->count, end, (const char *)slot + sum_at());
}

static void tell_cell(passing *now, size_t of)
{
    const pass *p = now->p;
    void *sum = p->merge ? sgt_tree_end(&now->tree) : NULL;
    if (p->end) p->end(p, of, &now->fates, sum);
}

static void take_block(void *data, size_t i, void *slot)
{
    passing *now = data;
    const pass *p = now->p;
    sgt_asking *a = p->ask;
    const size_t of = i / now->blocks, nth = i % now->blocks;
    const bool last = nth + 1 == now->blocks;
    const block_of_rays *b = slot;
    if (!b->placed) {
        a->failed = true;
        if (a->error) *a->error = b->fault;
        return;
    }
    if (nth == 0) now->fates = (sgt_fates){.rays = 0};
    count_fates(now, of, &b->fates, b->lost_x, b->lost_y);
    if (p->merge) sgt_tree_put(&now->tree, (sum_branch){0, nth}, (const char *)slot + sum_at());
    if (now->writes && (!p->merge || is_taken(p, nth))) write_slot(now, nth, slot);
    if (now->writes && p->merge && (last || i + 1 == now->end)) write_cell(now);
    if (now->tells) tell_block(now, i, slot);
    if (now->tells && last) tell_cell(now, of);
    if (last || i + 1 == now->end) now->tree.branches = 0, now->fates = (sgt_fates){.rays = 0};
}

/* A map that is kept, and what it is of. */
struct kept_map { const sgt_field_beam *beam; const sgt_element *element; double before; sgt_aim_map of;
};

/* The map of a cell that is kept; NULL: there is none. */
static const sgt_aim_map *kept_map_of(const sgt_asking *a, const cell *c)
{
    const size_t front = (a->lens->stop + 1) * sizeof *c->element;
    for (size_t i = 0; i < a->kept_maps; i++) {
        const kept_map *k = &a->kept_map[i];
        if (k->beam == c->beam && k->before == c->before &&
            (k->element == c->element || memcmp(k->element, c->element, front) == 0))
            return &k->of;
    }
    return NULL;
}

/* Keeps the map of a cell of a beam that lasts, if there is room. */
static void keep_map_of(sgt_asking *a, const cell *c, const sgt_aim_map *of)
{
    if (c->beam == &c->own || a->kept_maps == a->fields * a->bands) return;
    if (!a->kept_map) a->kept_map = sgt_ask_room(a, a->fields * a->bands, sizeof *a->kept_map);
    if (!a->failed) a->kept_map[a->kept_maps++] = (kept_map){c->beam, c->element, c->before, *of};
}

static bool map_cell(void *data, size_t i, void *slot)
{
    const passing *now = data;
    const pass *p = now->p;
    cell c = {.beam = NULL};
    sgt_aim_map *out = slot;
    sgt_error unsaid; /* its block will say so */
    *out = (sgt_aim_map){.home = 0};
    if (!p->place(p, now->fresh[i], &c, &unsaid)) return true;
    const sgt_colour_beam beam = {p->ask->from, c.beam, c.element, c.before, NULL};
    return sgt_aim_map_of(&beam, now->nodes, out);
}

static void take_map(void *data, size_t i, void *slot)
{
    passing *now = data;
    memcpy(&now->map[now->fresh[i] - now->mapped], slot, sizeof *now->map);
}

/* Keeps the map of the cell that both rounds have a part of, takes those that are kept, makes the others. */
static bool prepare_maps(void *data, size_t first, size_t tasks)
{
    passing *now = data;
    sgt_asking *a = now->p->ask;
    const size_t low = first / now->blocks, high = (first + tasks - 1) / now->blocks;
    const bool again = now->maps && low < now->mapped + now->maps;
    size_t fresh = 0;
    sgt_error unsaid;
    if (again && low > now->mapped) now->map[0] = now->map[low - now->mapped];
    now->mapped = low, now->maps = high - low + 1;
    for (size_t of = low + again; of <= high; of++) {
        cell c = {.beam = NULL};
        const bool lasts = now->p->place(now->p, of, &c, &unsaid) && c.beam != &c.own;
        const sgt_aim_map *known = lasts ? kept_map_of(a, &c) : NULL;
        if (known) now->map[of - low] = *known;
        else now->fresh[fresh++] = of;
    }
    const rounds r = {.tasks = fresh, .size = sizeof *now->map, .data = now, .work = map_cell,
                      .take = take_map};
    if (!sgt_ask_rounds(a, &r)) return false;
    for (size_t i = 0; i < fresh; i++) {
        cell c = {.beam = NULL};
        if (now->p->place(now->p, now->fresh[i], &c, &unsaid))
            keep_map_of(a, &c, &now->map[now->fresh[i] - low]);
    }
    return !a->failed;
}

/* Reads the branches of a cell that one share wrote; false: they are not what they should be. */
static bool read_cell(passing *now, size_t of, size_t k)
{
    sgt_asking *a = now->p->ask;
    sum_tree *t = &now->tree;
    cell_record r;
    void *sum = sgt_tree_sum(t, t->most - 1);
    if (!sgt_shard_get(a, k, sizeof r, &r)) return false;
    count_fates(now, of, &r.fates, r.lost_x, r.lost_y);
    for (size_t i = 0; i < r.branches; i++) {
        sum_branch branch;
        if (!sgt_shard_get(a, k, sizeof branch, &branch) || !sgt_shard_get(a, k, t->size, sum)) return false;
        if (t->branches + 1 >= t->most) return sgt_shard_wrong(a, k);
        sgt_tree_put(t, branch, sum);
    }
    return true;
}

static sgt_shard_of_pass head_of(const passing *now)
{
    return (sgt_shard_of_pass){now->p->cells, now->blocks, now->slot};
}

/* Works on the tasks of share k, and writes what they make. */
static bool work_share(passing *now, const rounds *whole, size_t k)
{
    const task_range own = range_of(now, k);
    rounds r = *whole;
    now->writes = own.first < own.end;
    if (!now->tells) r.first = own.first, r.tasks = own.end - own.first, now->end = own.end;
    return sgt_shard_head(now->p->ask, 0, head_of(now)) && sgt_ask_rounds(now->p->ask, &r);
}

/* Works on those shares that no other program has, until all are written; they are counted when they are
 * joined. */
static bool work_free_shares(passing *now, const rounds *r)
{
    sgt_asking *a = now->p->ask;
    const sgt_shard *s = a->study->opt.shard;
    const bool counts = a->counts;
    a->counts = false;
    for (size_t k; !a->failed && (k = s->next(s->context, now->shares)) != 0;) work_share(now, r, k);
    a->counts = counts;
    return !a->failed;
}

/* What the shares wrote, in the order of the tasks, in place of tracing. */
static bool join_pass(passing *now, char *slot)
{
    const pass *p = now->p;
    sgt_asking *a = p->ask;
    now->tells = true, now->writes = false, now->end = now->tasks;
    for (size_t k = 1, i = 0; k <= now->shares; k++) {
        const task_range r = range_of(now, k);
        if (!sgt_shard_head(a, k, head_of(now))) return false;
        for (; i < r.end; i++) {
            const size_t c = i / now->blocks, nth = i % now->blocks;
            const bool last = nth + 1 == now->blocks;
            if (!p->merge || is_taken(p, nth))
                if (!read_slot(now, k, nth, slot)) return false;
            if (!p->merge) take_block(now, i, slot);
            else if (is_taken(p, nth)) tell_block(now, i, slot);
            if (a->failed) return false;
            if (!p->merge) continue;
            if ((last || i + 1 == r.end) && !read_cell(now, c, k)) return false;
            if (last) tell_cell(now, c), now->fates = (sgt_fates){.rays = 0};
        }
    }
    return true;
}

/* Room for what is merged; false: no memory. */
static bool grow_tree(passing *now)
{
    const pass *p = now->p;
    const size_t apart = sgt_tree_apart(p->size);
    now->tree = (sum_tree){.size = p->size, .apart = apart, .exact = p->exact, .merge = p->merge, .data = p};
    now->tree.most = sgt_tree_most(now->blocks);
    now->tree.branch = sgt_ask_room(p->ask, now->tree.most, sizeof *now->tree.branch);
    now->tree.sums = sgt_ask_room(p->ask, now->tree.most, apart);
    return !p->ask->failed;
}

bool sgt_ask_pass(const pass *p)
{
    enum { WORTH = 256 }; /* rays of a cell: of fewer a fitted map saves less than it costs */
    sgt_asking *a = p->ask;
    const sgt_shard *shard = p->alone ? NULL : a->study->opt.shard;
    if (p->alone && sgt_ask_shards(a)) return !a->failed; /* who joins does it */
    passing now = {.p = p, .blocks = (p->points->count + PUPIL_PART - 1) / PUPIL_PART};
    now.tasks = now.end = p->cells * now.blocks;
    now.slot = ends_at(p) + (p->takes_ends ? PUPIL_PART * sizeof(sgt_ray_end) : 0);
    rounds r = {.tasks = now.tasks, .data = &now, .work = work_block, .take = take_block, .size = now.slot};
    const bool joins = shard && (!shard->number || (shard->next && p->before));
    char *slot = joins ? sgt_ask_room(a, 1, now.slot) : NULL;
    now.shares = shard ? sgt_shard_shares(a, now.tasks) : 0;
    now.tells = !shard || (p->before && !shard->next);
    if (joins && !slot) return false;
    if (p->merge && !grow_tree(&now)) return false;
    if (joins && !shard->next) return join_pass(&now, slot);
    if (a->from->aim != SGT_LENS_AIM_PUPIL && p->points->count >= WORTH) {
        now.map = sgt_ask_room(a, ROUND_MOST / now.blocks + 2, sizeof *now.map);
        now.nodes = sgt_ask_room(a, 1, sizeof *now.nodes);
        now.fresh = sgt_ask_room(a, ROUND_MOST / now.blocks + 2, sizeof *now.fresh);
        if (a->failed) return false;
        sgt_aim_nodes_set(now.nodes);
        r.prepare = prepare_maps;
    }
    const bool fine = !shard        ? sgt_ask_rounds(a, &r)
                      : shard->next ? work_free_shares(&now, &r)
                                    : work_share(&now, &r, shard->number);
    for (size_t i = 0; i < ROOMS; i++) sgt_ends_room_free(a->from, atomic_load(&now.room[i]));
    return fine && (!joins || join_pass(&now, slot));
}

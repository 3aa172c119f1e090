// SPDX-License-Identifier: MIT
/* shard.c - what a share of a study writes, and what is read of all of them to join them. */
#include "study.h"

#include <string.h>

bool sgt_shard_wrong(sgt_asking *a, size_t k)
{
    return sgt_ask_fail(a, "", "shard %zu of %zu is not one of this study", k, a->study->opt.shard->of);
}

bool sgt_shard_put(sgt_asking *a, size_t size, const void *bytes)
{
    const sgt_shard *s = a->study->opt.shard;
    if (a->failed || s->write(s->context, size, bytes)) return !a->failed;
    return sgt_ask_fail(a, "", "shard %zu of %zu could not be written", s->number, s->of);
}

bool sgt_shard_get(sgt_asking *a, size_t k, size_t size, void *bytes)
{
    const sgt_shard *s = a->study->opt.shard;
    return !a->failed && (s->read(s->context, k, size, bytes) || sgt_shard_wrong(a, k));
}

/* floor(tasks (k - 1) / of), without an overflow. */
size_t sgt_shard_begin(size_t tasks, size_t k, size_t of)
{
    return tasks / of * (k - 1) + tasks % of * (k - 1) / of;
}

size_t sgt_shard_shares(const sgt_asking *a, size_t tasks)
{
    const sgt_shard *s = a->study->opt.shard;
    return s->next && tasks < s->of ? tasks : s->of;
}

bool sgt_shard_head(sgt_asking *a, size_t k, sgt_shard_of_pass head)
{
    sgt_shard_of_pass other;
    if (!k) return sgt_shard_put(a, sizeof head, &head);
    if (!sgt_shard_get(a, k, sizeof other, &other)) return false;
    const bool same = other.cells == head.cells && other.blocks == head.blocks && other.size == head.size;
    return same || sgt_shard_wrong(a, k);
}

/* Of one share: its tasks, whose slots are shard_written where they would be taken. */
typedef struct shard_written { sgt_asking *ask; const rounds *of; } shard_written;

static bool work_shared(void *data, size_t i, void *slot)
{
    const shard_written *w = data;
    memset(slot, 0, w->of->size); /* what is shard_written has no bytes that nothing set */
    return w->of->work(w->of->data, i, slot);
}

static void write_task(void *data, size_t i, void *slot)
{
    const shard_written *w = data;
    (void)i;
    sgt_shard_put(w->ask, w->of->size, slot);
}

static bool work_rounds(sgt_asking *a, const rounds *r, size_t k, size_t of)
{
    shard_written w = {a, r};
    const size_t first = sgt_shard_begin(r->tasks, k, of);
    const rounds own = {.first = first, .tasks = sgt_shard_begin(r->tasks, k + 1, of) - first,
                        .size = r->size, .data = &w, .work = work_shared, .take = write_task};
    return sgt_shard_head(a, 0, (sgt_shard_of_pass){r->tasks, 1, r->size}) && sgt_ask_rounds(a, &own);
}

bool sgt_shard_rounds(sgt_asking *a, const rounds *r)
{
    const sgt_shard *s = a->study->opt.shard;
    if (!s) return sgt_ask_rounds(a, r);
    const size_t of = sgt_shard_shares(a, r->tasks);
    for (size_t k; s->next && (k = s->next(s->context, of)) != 0;)
        if (!work_rounds(a, r, k, of)) return false;
    if (s->number) return s->next || work_rounds(a, r, s->number, of);
    void *slot = sgt_ask_room(a, 1, r->size);
    for (size_t k = 1, i = 0; k <= of && slot; k++) {
        if (!sgt_shard_head(a, k, (sgt_shard_of_pass){r->tasks, 1, r->size})) return false;
        for (; i < sgt_shard_begin(r->tasks, k + 1, of); i++) {
            if (!sgt_shard_get(a, k, r->size, slot)) return false;
            r->take(r->data, i, slot);
            if (a->failed) return false;
        }
    }
    return slot;
}

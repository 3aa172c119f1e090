// SPDX-License-Identifier: MIT
/* study_threads.c - the bytes of every analysis for any number of threads and shards: study_threads LENS...
 *
 * Each analysis of the library's own table is asked of each lens, with its default rays and with more, aimed
 * as the lens says and at the real stop.  It is asked without threads first.  Then tasks go backward, and
 * into 1 to 7 threads, of which the one that asks works, or only waits.  All that the sink is given has to be
 * the same bytes, and to come from the thread that asks.
 *
 * Each question is also asked in 1, 3 or 7 shards, whose bytes are kept in memory, and joined of these; and
 * by three programs, here threads, that take shares as they become free.
 *
 * A proof knows nothing of aims and of rays across: each is asked once of a lens.
 *
 * Of the fourteen ways with threads every third is tried of a question, other ones of the next: each analysis
 * meets all of them.  With SAGITTA_TEST_SCALE=1 or more each question is asked in each way, below 0.1 every
 * second question in one. */
#define _POSIX_C_SOURCE 200809L /* pthread_barrier_t */

#include <sagitta/prove.h>
#include <sagitta/study.h>

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THREADS = 7, ACROSS = 64 };

/* What a sink was given. */
typedef struct told {
    const sgt_analysis *of;
    size_t size, room, rows;
    char *bytes;
    pthread_t asker;
} told;

static void keep(told *t, const void *from, size_t size)
{
    if (!pthread_equal(pthread_self(), t->asker)) {
        printf("%s: told in another thread\n", t->of->name);
        exit(1);
    }
    if (t->size + size > t->room) {
        t->room = 2 * (t->size + size);
        t->bytes = realloc(t->bytes, t->room);
        if (!t->bytes) exit(2);
    }
    memcpy(t->bytes + t->size, from, size);
    t->size += size;
}

static bool is_int(sgt_column_kind kind)
{
    return kind == SGT_COLUMN_FATE || kind == SGT_COLUMN_VERDICT || kind == SGT_COLUMN_QUANTITY;
}

/* The cells of a row, without the gaps between them. */
static void keep_row(void *context, const void *row)
{
    told *t = context;
    const sgt_column *c;
    t->rows++;
    for (size_t i = 0; (c = sgt_analysis_column(t->of, i)); i++)
        keep(t, (const char *)row + c->offset, is_int(c->kind) ? sizeof(int) : sizeof(double));
}

static void keep_sentence(void *context, sgt_remark_of_study kind, const char *sentence)
{
    keep(context, &kind, sizeof kind);
    keep(context, sentence, strlen(sentence));
}

static void keep_ends(void *context, size_t field, size_t surface, size_t wavelength, size_t count,
                      const sgt_ray_end end[])
{
    const size_t where[] = {field, surface, wavelength, count};
    keep(context, where, sizeof where);
    for (size_t i = 0; i < count; i++) {
        const sgt_ray_end *e = &end[i];
        const double numbers[] = {e->px, e->py, e->weight, e->p.x, e->p.y, e->p.z, e->d.x, e->d.y, e->d.z,
                                  e->opl, e->p_err, e->opl_err, e->t_err, e->condition};
        const int counts[] = {e->fate, e->status, e->aimed, e->evals, e->folded, e->proven};
        keep(context, numbers, sizeof numbers), keep(context, counts, sizeof counts);
    }
}

/* Tasks that several threads take one after another. */
typedef struct shared_tasks {
    pthread_mutex_t lock;
    size_t next, all;
    void (*task)(void *data, size_t i);
    void *data;
} shared_tasks;

static void *work(void *context)
{
    shared_tasks *s = context;
    for (;;) {
        pthread_mutex_lock(&s->lock);
        const size_t i = s->next++;
        pthread_mutex_unlock(&s->lock);
        if (i >= s->all) return NULL;
        s->task(s->data, i);
    }
}

/* How: so many threads; without the one that asks; or backward in it alone. */
typedef struct way { int threads; bool others, backward; } way;

static void run(void *context, size_t tasks, void (*task)(void *data, size_t i), void *data)
{
    const way *w = context;
    pthread_t other[THREADS];
    int begun = 0;
    shared_tasks s = {.all = tasks, .task = task, .data = data};
    for (size_t i = tasks; w->backward && i-- > 0;) task(data, i);
    if (w->backward) return;
    pthread_mutex_init(&s.lock, NULL);
    for (int i = w->others ? 0 : 1; i < w->threads; i++)
        if (pthread_create(&other[begun], NULL, work, &s) == 0) begun++;
    if (!w->others || !begun) work(&s);
    for (int i = 0; i < begun; i++) pthread_join(other[i], NULL);
    pthread_mutex_destroy(&s.lock);
}

/* Few boxes do here.  A sample is held against the proof in one run. */
static bool is_whole_run(const sgt_analysis *of) { return strcmp(of->name, "prove_samples") == 0; }
static bool is_proof(const sgt_analysis *of) { return strncmp(of->name, "prove", 5) == 0; }

static const void *few_boxes(const sgt_analysis *of)
{
    static const sgt_prove_options few = {.boxes = 80, .limit = "spot < 0.02; rms < 0.01"};
    static const sgt_prove_options between = {.boxes = 20, .limit = "spot < 0.02"};
    if (strncmp(of->name, "prove_between", 13) == 0) return &between;
    return is_proof(of) ? &few : NULL;
}

static told ask(const sgt_lens *lens, const sgt_analysis *of, sgt_study_options how, way *w)
{
    told t = {.of = of, .asker = pthread_self()};
    sgt_error error = {.line = 0};
    sgt_study_total total = {.fates = {.rays = 0}};
    const sgt_sink sink = {.context = &t, .row = keep_row, .say = keep_sentence, .ends = keep_ends};
    if (w) how.run = run, how.context = w;
    sgt_study *study = sgt_study_new(lens, &how, &error);
    if (!study || !sgt_study_run(study, of, few_boxes(of), &sink, &total, &error))
        keep(&t, error.words, strlen(error.words));
    const sgt_fates *f = &total.fates;
    const size_t counts[] = {f->rays, f->passed, f->missed, f->clipped, f->tir, f->lost, f->none, f->unfound,
                             f->folded, f->proven, f->evanescent};
    keep(&t, counts, sizeof counts), keep(&t, &total.lost.px, sizeof(double));
    sgt_study_free(study);
    return t;
}

/* What shards have written, and how much of each was read. */
enum { SHARDS = 7 };
typedef struct kept_shards {
    size_t now, size[SHARDS], room[SHARDS], read[SHARDS];
    char *bytes[SHARDS];
} kept_shards;

static bool write_shard(void *context, size_t size, const void *bytes)
{
    kept_shards *k = context;
    const size_t i = k->now;
    if (k->size[i] + size > k->room[i]) {
        k->room[i] = 2 * (k->size[i] + size);
        k->bytes[i] = realloc(k->bytes[i], k->room[i]);
        if (!k->bytes[i]) exit(2);
    }
    memcpy(k->bytes[i] + k->size[i], bytes, size);
    k->size[i] += size;
    return true;
}

static bool read_shard(void *context, size_t number, size_t size, void *bytes)
{
    kept_shards *k = context;
    const size_t i = number - 1;
    if (k->size[i] - k->read[i] < size) return false;
    memcpy(bytes, k->bytes[i] + k->read[i], size);
    k->read[i] += size;
    return true;
}

/* The last shard first, each in another number of threads. */
static told ask_in_shards(const sgt_lens *lens, const sgt_analysis *of, sgt_study_options how, size_t count)
{
    kept_shards kept = {.now = 0};
    sgt_shard shard = {.of = count, .context = &kept, .write = write_shard, .read = read_shard};
    how.shard = &shard;
    for (shard.number = count; shard.number > 0; shard.number--) {
        way w = {.threads = 1 + (int)shard.number % 3};
        kept.now = shard.number - 1;
        told t = ask(lens, of, how, &w);
        if (t.rows) printf("%s: a shard tells rows\n", of->name), exit(1);
        free(t.bytes);
    }
    told joined = ask(lens, of, how, NULL);
    for (size_t i = 0; i < count; i++) {
        if (kept.read[i] != kept.size[i]) printf("%s: not all of a shard is read\n", of->name), exit(1);
        free(kept.bytes[i]);
    }
    return joined;
}

/* Several programs, here threads, which take shares of each pass as they become free (sgt_shard.next). */
enum { PROGRAMS = 3, FREE_SHARES = 16, PASSES = 16 };
typedef struct pool {
    kept_shards pass[PASSES][FREE_SHARES / SHARDS + 1];
    size_t given[PASSES];
    pthread_mutex_t lock;
    pthread_barrier_t all;
} pool;
typedef struct program {
    pool *of;
    size_t pass, own, read[FREE_SHARES]; /* own: the share that is written; read: how much of each */
    sgt_shard shard;
    const sgt_lens *lens;
    const sgt_analysis *analysis;
    sgt_study_options how;
    told told;
} program;

/* What is kept of a share, from 1, of a pass. */
static kept_shards *share_of(pool *p, size_t pass, size_t number)
{
    kept_shards *k = &p->pass[pass][(number - 1) / SHARDS];
    k->now = (number - 1) % SHARDS;
    return k;
}

static bool write_own(void *context, size_t size, const void *bytes)
{
    program *p = context;
    pthread_mutex_lock(&p->of->lock);
    write_shard(share_of(p->of, p->pass, p->own), size, bytes);
    pthread_mutex_unlock(&p->of->lock);
    return true;
}

static bool read_any(void *context, size_t number, size_t size, void *bytes)
{
    program *p = context;
    pthread_mutex_lock(&p->of->lock);
    const kept_shards *k = share_of(p->of, p->pass - 1, number);
    const bool fine = k->size[k->now] - p->read[number - 1] >= size;
    if (fine) memcpy(bytes, k->bytes[k->now] + p->read[number - 1], size);
    p->read[number - 1] += size;
    pthread_mutex_unlock(&p->of->lock);
    return fine;
}

static size_t next_share(void *context, size_t of)
{
    program *p = context;
    pthread_mutex_lock(&p->of->lock);
    p->own = ++p->of->given[p->pass];
    pthread_mutex_unlock(&p->of->lock);
    if (p->own <= of) return p->own;
    pthread_barrier_wait(&p->of->all);
    memset(p->read, 0, sizeof p->read);
    if (++p->pass == PASSES) exit(2);
    return 0;
}

static void *run_program(void *data)
{
    program *p = data;
    p->shard = (sgt_shard){.number = p->shard.number, .of = FREE_SHARES, .context = p, .write = write_own,
                           .read = read_any, .next = next_share};
    p->how.shard = &p->shard;
    way w = {.threads = 1 + (int)p->shard.number};
    p->told = ask(p->lens, p->analysis, p->how, &w);
    return NULL;
}

static told ask_programs(const sgt_lens *lens, const sgt_analysis *of, sgt_study_options how)
{
    static pool all;
    program one[PROGRAMS];
    pthread_t thread[PROGRAMS];
    memset(&all, 0, sizeof all);
    pthread_mutex_init(&all.lock, NULL), pthread_barrier_init(&all.all, NULL, PROGRAMS);
    for (size_t i = 0; i < PROGRAMS; i++) {
        one[i] = (program){.of = &all, .shard = {.number = i}, .lens = lens, .analysis = of, .how = how};
        if (pthread_create(&thread[i], NULL, run_program, &one[i]) != 0) exit(2);
    }
    for (size_t i = 0; i < PROGRAMS; i++) pthread_join(thread[i], NULL);
    for (size_t i = 1; i < PROGRAMS; i++) {
        if (one[i].told.rows) printf("%s: program %zu tells rows\n", of->name, i), exit(1);
        free(one[i].told.bytes);
    }
    for (size_t pass = 0; pass < PASSES; pass++)
        for (size_t k = 1; k <= FREE_SHARES; k++) free(share_of(&all, pass, k)->bytes[(k - 1) % SHARDS]);
    pthread_barrier_destroy(&all.all), pthread_mutex_destroy(&all.lock);
    return one[0].told;
}

static size_t compare(const char *name, const sgt_lens *lens, const sgt_analysis *of,
                      const sgt_study_options *how, int nth)
{
    const char *scale = getenv("SAGITTA_TEST_SCALE");
    const double cases = scale ? atof(scale) : 0.5;
    const int each = cases >= 1 ? 1 : cases >= 0.1 ? 3 : 2 * THREADS;
    size_t faults = 0;
    told first = ask(lens, of, *how, NULL);
    for (int i = -1; i < 2 * THREADS; i++) {
        if (i >= 0 && (i + nth) % each) continue;
        way w = {.threads = 1 + i / 2, .others = i % 2, .backward = i < 0};
        told other = ask(lens, of, *how, &w);
        if (other.size != first.size || memcmp(other.bytes, first.bytes, first.size) != 0) {
            printf("%s %s: other bytes, %d threads%s\n", name, of->name, w.threads,
                   w.backward ? ", backward" : w.others ? ", beside that which asks" : "");
            faults++;
        }
        free(other.bytes);
    }
    if (is_whole_run(of)) {
        free(first.bytes);
        return faults;
    }
    const size_t shards = (const size_t[]){1, 3, SHARDS}[nth % 3];
    told joined = ask_in_shards(lens, of, *how, shards);
    if (joined.size != first.size || memcmp(joined.bytes, first.bytes, first.size) != 0)
        printf("%s %s: other bytes, %zu shards\n", name, of->name, shards), faults++;
    free(joined.bytes);
    joined = ask_programs(lens, of, *how);
    if (joined.size != first.size || memcmp(joined.bytes, first.bytes, first.size) != 0)
        printf("%s %s: other bytes, by %d programs\n", name, of->name, PROGRAMS), faults++;
    free(joined.bytes);
    if (!first.rows && !how->across) printf("%s %s: no rows\n", name, of->name);
    free(first.bytes);
    return faults;
}

int main(int argc, char *argv[])
{
    const sgt_lens_aim stop = SGT_LENS_AIM_REAL_STOP;
    size_t faults = 0, asked = 0;
    const char *scale = getenv("SAGITTA_TEST_SCALE");
    const bool few = scale && atof(scale) < 0.1;
    for (int i = 1; i < argc; i++) {
        sgt_error error;
        sgt_lens *lens = sgt_lens_read(argv[i], NULL, &error);
        const sgt_analysis *of;
        if (!lens) {
            printf("%s: %s\n", argv[i], error.words);
            return 1;
        }
        for (size_t k = 0; (of = sgt_analysis_at(k)); k++)
            for (int more = 0; more < 4; more++) {
                sgt_study_options how = {.aim = more & 2 ? &stop : NULL,
                                         .across = more & 1 && !of->no_rays && !of->no_fields ? ACROSS : 0};
                if (of->no_fields && more & 2) continue; /* far fields: minutes of proofs */
                if (is_proof(of) && more != (int)(k % 4)) continue;
                if (few && (k + (size_t)more) % 2) continue;
                faults += compare(argv[i], lens, of, &how, (int)asked++);
            }
        sgt_lens_free(lens);
    }
    printf("%zu questions, %zu faults\n", asked, faults);
    return faults || !asked;
}

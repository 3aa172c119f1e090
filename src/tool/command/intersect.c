// SPDX-License-Identifier: MIT
/* intersect.c - sagitta intersect: one surface, many rays. */
#include "commands.h"
#include "explain.h"
#include "record.h"
#include "watch.h"
#include "../base/input.h"
#include "../base/memory.h"
#include "../base/progress.h"
#include "../job/options.h"
#include "../read/earth.h"
#include "../read/rays.h"
#include "../read/surface.h"
#include "../base/tiles.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Under the table for people: what has a unit.  Of the columns that are shown; a line has two at most. */
static const struct { const char *columns, *words; int line; } legend[] = {
    {" t t_err ", "t, t_err: in lengths of the ray's direction.", 0},
    {" x y z ", "x y z: the point, in the unit of the surface.", 0},
    {" nx ny nz ", "nx ny nz: the gradient of F there.", 1},
    {" evals ", "evals: evaluations of F.", 1},
    {" lat lon height ",
     "lat, lon: degrees north and east.  height: metres over the ellipsoid (a geoid lies N over it).", 2},
};

/* asked: the columns with commas between, NULL: all.  The last entry is for places on the Earth. */
static const char *legend_of(const char *asked, bool earth)
{
    const char *text = "";
    int line = -1;
    for (size_t i = 0; i < sizeof legend / sizeof *legend - (earth ? 0 : 1); i++) {
        bool shown = !asked;
        for (const char *at = asked; at && *at; at += strcspn(at, ","), at += *at == ',')
            if (strstr(legend[i].columns, memory_print(" %.*s ", (int)strcspn(at, ","), at))) shown = true;
        if (!shown) continue;
        const char *between = line < 0 ? "" : line == legend[i].line ? "  " : "\n";
        text = memory_print("%s%s%s", text, between, legend[i].words);
        line = legend[i].line;
    }
    return line < 0 ? "" : memory_print("%s\n", text);
}

static const column intersect_head[] = {
    {"ray", COLUMN_COUNT}, {"root", COLUMN_INTEGER}, {"status", COLUMN_CODE},
    {"t", COLUMN_NUMBER}, {"t_err", COLUMN_ERROR},
    {"x", COLUMN_NUMBER}, {"y", COLUMN_NUMBER}, {"z", COLUMN_NUMBER},
    {"nx", COLUMN_NUMBER}, {"ny", COLUMN_NUMBER}, {"nz", COLUMN_NUMBER},
    {"evals", COLUMN_INTEGER},
};
static const column intersect_id = {"id", COLUMN_WORD},
                    left[] = {{"lo", COLUMN_NUMBER}, {"hi", COLUMN_NUMBER}},
                    earth_head[] = {{"lat", COLUMN_NUMBER}, {"lon", COLUMN_NUMBER},
                                    {"height", COLUMN_NUMBER}};
enum { HEAD_COUNT = sizeof intersect_head / sizeof intersect_head[0], COLUMNS_MOST = HEAD_COUNT + 6 };

typedef struct intersect_arguments {
    shared_options shared;
    const char *surface, *file;
    ray_list rays;
    bool all, skip_bad, single;
    watch_options watched;
} intersect_arguments;

static void take_ray(void *into, const option_row *row, const char *value)
{
    (void)row;
    rays_parse(&((intersect_arguments *)into)->rays, value);
}

static void take_from(void *into, const option_row *row, const char *value)
{
    (void)row;
    rays_from(&((intersect_arguments *)into)->rays, value);
}

static void take_look(void *into, const option_row *row, const char *value)
{
    (void)row;
    rays_look(&((intersect_arguments *)into)->rays, value);
}

static const option_row intersect_rows[] = {
    {"surface", "SPEC",
     "the surface, in YAML: '{type: sphere, radius: 20, semi_diameter: 2}'\n"
     "Or '{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 8}'.  docs/lens_file.md has every\n"
     "type and its keys",
     OPTION_TEXT, .to = offsetof(intersect_arguments, surface)},
    {"rays", "FILE",
     "rays from csv with a header row: ox,oy,oz,dx,dy,dz and optionally tmin,tmax,id\n"
     "FILE may be - for standard input; or an array of NumPy, NAME.npy, or a folder with an\n"
     "array for each column",
     OPTION_TEXT, .to = offsetof(intersect_arguments, file)},
    {"ray", "\"...\"",
     "a ray: six numbers in quotes, ox oy oz dx dy dz.  May be repeated\n"
     "Or eight, with tmin tmax at the end",
     OPTION_TAKE, .take = take_ray},
    {"from", "\"...\"",
     "on a surface about the Earth: where rays begin, lat lon height in quotes\n"
     "Degrees north, degrees east, metres over the ellipsoid; for each --look after it.  A file of\n"
     "--rays may have the columns lat,lon,height,az,el instead of ox,oy,oz,dx,dy,dz",
     OPTION_TAKE, .take = take_from},
    {"look", "\"...\"",
     "a ray from the place of --from: az el in quotes.  May be repeated\n"
     "Degrees clockwise from north, and degrees above the horizontal; -90 is down.  Or four numbers,\n"
     "with tmin tmax at the end",
     OPTION_TAKE, .take = take_look},
    {"skip-bad", NULL, "skip bad rows of the file, and say how many", OPTION_FLAG,
     .to = offsetof(intersect_arguments, skip_bad)},
    {"all", NULL,
     "every root\n"
     "A stretch of the ray that could not be decided has a row too: its t is the middle, its\n"
     "t_err half the length",
     OPTION_FLAG, .to = offsetof(intersect_arguments, all)},
    {"single", NULL,
     "rays and answers in single precision: faster on planes, conics and even aspheres\n"
     "Rays are rounded to floats; t, t_err, the point and the gradient are of the rounded ray, and\n"
     "t_err is some 1e-7 of t.  evals is empty.  Without --all, --watch",
     OPTION_FLAG, .to = offsetof(intersect_arguments, single)},
    {"watch", "FILE",
     "write the evaluations of each ray that is undecided, as csv\n"
     "The columns are those of sagitta diagnose",
     OPTION_TEXT, .to = offsetof(intersect_arguments, watched.path)},
    WATCH_RAY_OPTION(intersect_arguments),
    {0},
};
static const option_row intersect_search_rows[] = {
    PICK_OPTION("which root: first or near-seed\n"
                "first (the default): the accepted root of the smallest t; near-seed: on a sag, the root\n"
                "that belongs to the ray's crossing of the vertex plane"),
    PROOF_OPTION("what must be proven before a ray is a hit: estimate, root or first\n"
                 "estimate (the default): a root lies within t_err of t; root: and it is the only one\n"
                 "there; first: and no accepted root comes before it; with --pick near-seed, no other\n"
                 "root on the ray is accepted.  A ray for which this is not proven is unproven"),
    {0},
};
static const option_group intersect_own = {OPTIONS_OWN, "Options", .row = intersect_rows},
                          intersect_search = {OPTIONS_SHARED, "The search", .row = intersect_search_rows};

static exit_status intersect_run(const command *c, int argc, char *argv[]);

static const char intersect_all[] =
    "Columns\n"
    "  ray                the ray, counted from 0: data rows of the file, or --ray options\n"
    "  root               the root, counted from 0 along the ray; -1: there is none\n"
    "  status             hit; graze: the ray touches, as far as can be told; miss; or, undecided:\n"
    "                     unproven, undefined (F is NaN there), exhausted (--max-evals)\n"
    "  t, t_err           place on the ray, and a bound on its error (in lengths of the direction)\n"
    "  x, y, z            the point (length)\n"
    "  nx, ny, nz         the gradient of F there, not scaled to length 1\n"
    "  evals              evaluations of F\n"
    "  id                 as the file gives it, if it has this column\n"
    "  lo, hi             with --proof root or first, csv and json only: of an undecided row, the\n"
    "                     stretch of the ray still in doubt (like t)\n"
    "  lat, lon, height   on a surface about the Earth: degrees north, degrees east (above -180 and\n"
    "                     up to 180), metres over the ellipsoid, that of the surface or WGS84\n";

static const char *intersect_words(const void *context)
{
    (void)context;
    return "ray root status t t_err x y z nx ny nz evals id lo hi lat lon height";
}

const command command_intersect = {
    .name = "intersect", .usage = "--surface SPEC (--rays FILE | --ray \"ox oy oz dx dy dz\") [options]",
    .brief = "one surface, many rays",
    .what = "Where do rays meet a surface F(x, y, z) = 0?  Prints a row for each ray; with --all, for "
            "each root. Lengths have any unit; the surface and the rays share it.  A root is accepted "
            "if it lies between tmin and tmax and within semi_diameter, and is not the ray's own start.",
    .often = "surface ray rays from look all proof pick columns format output",
    .examples = "  sagitta intersect --surface '{type: sphere, radius: 20}' --ray '0 3 -5 0 0 1'\n"
                "  sagitta intersect --surface '{type: conic, radius: 20, conic: -1}' --rays FILE --all\n",
    .docs = "docs/tour.md, docs/lens_file_surfaces.md (every type of surface)", .all = intersect_all,
    .columns = intersect_words,
    .group = {&intersect_own, &intersect_search, &options_solver, &options_in_threads, &options_shards,
              &options_rows},
    .run = intersect_run,
};

static intersect_arguments intersect_arguments_of(const command *c, int argc, char *argv[])
{
    intersect_arguments a = {.surface = NULL};
    command_read(c, &a, NULL, &a.shared, argc, argv);
    if (optind < argc)
        fail_usage("unexpected argument \"%s\"; give the surface by --surface, rays by --rays or --ray",
                   argv[optind]);
    if (!a.surface) fail_usage("--surface is missing; for example --surface '{type: sphere, radius: 20}'");
    if (a.all && a.shared.solver.pick) fail_usage("give --pick or --all, not both");
    if (a.single && a.all) fail_usage("give --single or --all, not both; --single finds one root of a ray");
    if (a.single && a.watched.path) fail_usage("give --single or --watch, not both; --watch is of doubles");
    if (a.single && a.skip_bad) fail_usage("--skip-bad: not with --single; leave out rays that do not fit");
    a.shared.target.single = a.single;
    if (a.rays.begun && !a.rays.places) fail_usage("--from without --look; add --look \"az el\"");
    if (!a.file == !a.rays.count)
        fail_usage(a.file ? "give --rays or --ray, not both"
                          : "no rays; give --rays FILE or --ray \"ox oy oz dx dy dz\"");
    options_shard(&a.shared, a.watched.path);
    if (shard_is() && a.watched.path) fail_usage("--watch: not with --shard; it is of one run");
    a.rays.threads = options_threads(&a.shared), a.rays.parts = true, a.rays.some = shard_is();
    a.rays.earth = true;
    if (a.file) rays_read(&a.rays, a.file, a.skip_bad);
    return a;
}

/* ------------------------------------------------------------------ tiles */

enum { STATUS_COUNT = SGT_GRAZE - SGT_INVALID + 1 };

/* What the verdict needs: how many rows there are of each status, the first ray that missed, and the first
 * rays that are undecided. */
typedef struct findings {
    size_t count[STATUS_COUNT];
    bool any_missed;
    launch missed, undecided[UNDECIDED_SHOWN];
    int shown;
} findings;

/* The room of a tile: its rays and their answers by column, its rows of the table, and its findings. */
typedef struct intersect_room {
    ray_block rays;
    double number[8][TILE_RAYS];               /* t, t_err, p, n */
    double lo[TILE_RAYS], hi[TILE_RAYS];
    float single[16][TILE_RAYS];               /* of --single: o, d, tmin, tmax, and what is in `number` */
    double *spot[3];                           /* [spots] each: latitudes, longitudes, heights */
    int spots;
    sgt_status status[TILE_RAYS];
    int evals[TILE_RAYS], root[TILE_RAYS];
    sgt_hit *hit;                              /* [capacity], for --all: the roots of one ray */
    int *place;                                /* [capacity]: 0, 1, 2 ... */
    int capacity;
    table *rows;
    bytes kept;                                /* of a shard: for who joins */
    findings found;
} intersect_room;

typedef struct intersect_work {
    const intersect_arguments *asked;
    sgt_surface surface;
    intersect_room *room;
    table *table;
    watch *watch;                              /* NULL: none */
    bool stretches;                            /* there are columns lo and hi */
    bool earth;                                /* there are columns lat, lon and height, over */
    sgt_geodetic_height over;                  /* this */
    bool prints;                               /* of ranks: each prints its own rows */
    size_t rays;
    tiling whole;                              /* of all shards together */
    findings found;
} intersect_work;

static const char *answer_word(int code) { return sgt_status_text((sgt_status)code); }

/* What the verdict needs of an answer. */
static void note_status(findings *f, sgt_status status, const ray_block *b, size_t i)
{
    f->count[status - SGT_INVALID]++;
    if (status == SGT_MISS && !f->any_missed) f->any_missed = true, f->missed = rays_launch(b, i);
    if (status < 0 && f->shown < UNDECIDED_SHOWN) f->undecided[f->shown++] = rays_launch(b, i);
}

/* A miss and an invalid ray have root -1; an undecided stretch is numbered as a root. */
static int root_of(sgt_status status, int root)
{
    return status == SGT_MISS || status == SGT_INVALID ? -1 : root;
}

/* Rows with the columns of intersect_head, and those of the others that are wanted. */
static void put_answers(const intersect_work *w, intersect_room *r, size_t count,
                        const table_values head[HEAD_COUNT], table_values id, table_values lo,
                        table_values hi)
{
    table_values all[COLUMNS_MOST];
    size_t n = HEAD_COUNT;
    memcpy(all, head, sizeof(table_values[HEAD_COUNT]));
    if (w->asked->rays.named) all[n++] = id;
    if (w->stretches) all[n++] = lo, all[n++] = hi;
    for (int k = 0; k < 3 && w->earth; k++) all[n++] = (table_values){r->spot[k], sizeof(double), NULL};
    table_block(r->rows, count, all);
}

/* What was found of the rays of a tile, one answer for each. */
static void record_each(keeping *to, intersect_room *r)
{
    const size_t count = r->rays.count;
    RECORD(to, r->status, count), RECORD(to, r->evals, count);
    for (int k = 0; k < 8; k++) RECORD(to, r->number[k], count);
}

static void room_for_spots(const intersect_work *w, intersect_room *r, int count)
{
    if (!w->earth || count <= r->spots) return;
    for (int k = 0; k < 3; k++) r->spot[k] = memory_grow(r->spot[k], (size_t)count, sizeof *r->spot[k]);
    r->spots = count;
}

/* Rays are rounded to floats before any answer is asked. */
static void round_to_floats(ray_block *b)
{
    static const char *const name[] = {"ox", "oy", "oz", "dx", "dy", "dz"};
    for (size_t i = 0; i < b->count; i++) {
        for (int c = 0; c < 8; c++) {
            const double x = b->number[c][i];
            const bool fits = fabs(x) <= (double)FLT_MAX;
            if (!fits && c < 6)
                fail_input("ray %lld: %s: %g does not fit in single precision", b->ray[i], name[c], x);
            b->number[c][i] = fits ? (double)(float)x : copysign(HUGE_VAL, x);
        }
        if (b->number[3][i] == 0 && b->number[4][i] == 0 && b->number[5][i] == 0)
            fail_input("ray %lld: its direction is 0 in single precision", b->ray[i]);
    }
}

/* Asks for the answers of a block by floats. */
static void intersect_single(const intersect_work *w, intersect_room *r)
{
    const size_t count = r->rays.count;
    float(*own)[TILE_RAYS] = r->single, (*to)[TILE_RAYS] = r->single + 8;
    const bool ended = r->rays.ended;
    for (int c = 0; c < (ended ? 8 : 6); c++)
        for (size_t i = 0; i < count; i++) own[c][i] = (float)r->rays.number[c][i];
    sgt_intersect_batch_f(w->surface, count,
                          (sgt_rays_f){.o = {own[0], own[1], own[2]}, .d = {own[3], own[4], own[5]},
                                       .tmin = ended ? own[6] : NULL, .tmax = ended ? own[7] : NULL},
                          (sgt_hits_f){.status = r->status, .t = to[0], .t_err = to[1],
                                       .p = {to[2], to[3], to[4]}, .n = {to[5], to[6], to[7]}},
                          &w->asked->shared.solver);
    for (int c = 0; c < 8; c++)
        for (size_t i = 0; i < count; i++) r->number[c][i] = (double)to[c][i];
    memset(r->evals, 0, count * sizeof *r->evals);
}

/* The answers of a batch; only an undecided one has lo and hi, which a batch does not give. */
static void find_one_each(const intersect_work *w, intersect_room *r, keeping *keep)
{
    const ray_block *b = &r->rays;
    const sgt_options *opt = &w->asked->shared.solver;
    const double no = (double)NAN;
    double(*n)[TILE_RAYS] = r->number;
    const sgt_hits hits = {.status = r->status, .evals = r->evals, .t = n[0], .t_err = n[1],
                           .p = {n[2], n[3], n[4]}, .n = {n[5], n[6], n[7]}};
    if (!shard_joins() && w->asked->single) intersect_single(w, r);
    else if (!shard_joins()) sgt_intersect_batch(w->surface, b->count, rays_columns(b), hits, opt);
    if (shard_count() && !w->prints) record_each(keep, r);
    if (shard_is() && !w->prints) return;
    for (size_t i = 0; i < b->count; i++) {
        const sgt_status status = r->status[i];
        note_status(&r->found, status, b, i);
        r->root[i] = root_of(status, 0), r->lo[i] = r->hi[i] = no;
        if (status == SGT_HIT && !w->watch) continue;
        for (int k = 2; k < 8 && status <= 0; k++) n[k][i] = no;
        if (status >= 0 && !w->watch) continue;
        const launch l = rays_launch(b, i);
        if (w->stretches && status < 0) {
            const sgt_hit h = sgt_intersect(w->surface, l.ray, opt);
            r->lo[i] = h.lo, r->hi[i] = h.hi;
        }
        watch_intersect(w->watch, (size_t)(r - w->room), w->surface, &l, opt, false, status < 0);
    }
    const table_values rows[HEAD_COUNT] = {
        TABLE_VALUES(b->ray), TABLE_VALUES(r->root), {r->status, 1, answer_word}, TABLE_VALUES(n[0]),
        TABLE_VALUES(n[1]), TABLE_VALUES(n[2]), TABLE_VALUES(n[3]), TABLE_VALUES(n[4]), TABLE_VALUES(n[5]),
        TABLE_VALUES(n[6]), TABLE_VALUES(n[7]), {w->asked->single ? NULL : r->evals, sizeof *r->evals, NULL},
    };
    room_for_spots(w, r, TILE_RAYS);
    if (w->earth)
        earth_places(&w->over, b->count, (const double *const[]){n[2], n[3], n[4]}, r->spot);
    const table_values id = TABLE_VALUES(b->id), lo = TABLE_VALUES(r->lo), hi = TABLE_VALUES(r->hi);
    put_answers(w, r, b->count, rows, id, lo, hi);
}

static void room_for_hits(intersect_room *r, int count)
{
    const int had = r->capacity;
    if (count <= had) return;
    r->capacity = count;
    r->hit = memory_grow(r->hit, (size_t)count, sizeof *r->hit);
    r->place = memory_grow(r->place, (size_t)count, sizeof *r->place);
    for (int i = had; i < count; i++) r->place[i] = i;
}

/* Every root of a ray; for a ray without one, its status and evaluations.  Returns how many. */
static int find_roots(const intersect_work *w, intersect_room *r, const launch *l)
{
    const sgt_options *opt = &w->asked->shared.solver;
    int count;
    room_for_hits(r, 1);
    while ((count = sgt_intersect_all(w->surface, l->ray, r->capacity, r->hit, opt)) > r->capacity)
        room_for_hits(r, count);
    if (count > 0) return count;
    *r->hit = sgt_intersect(w->surface, l->ray, opt);
    return 1;
}

static void find_places(const intersect_work *w, intersect_room *r, int count)
{
    room_for_spots(w, r, count);
    for (int k = 0; k < count && w->earth; k++) {
        const sgt_vec3 *p = &r->hit[k].p;
        earth_places(&w->over, 1, (const double *const[]){&p->x, &p->y, &p->z},
                     (double *const[]){r->spot[0] + k, r->spot[1] + k, r->spot[2] + k});
    }
}

static void find_all(const intersect_work *w, intersect_room *r, keeping *keep)
{
    const ray_block *b = &r->rays;
    const sgt_options *opt = &w->asked->shared.solver;
    for (size_t i = 0; i < b->count; i++) {
        const launch l = rays_launch(b, i);
        const long long number = b->ray[i];
        const int none = -1;
        int count = shard_joins() ? 0 : find_roots(w, r, &l);
        bool lost = false;
        if (shard_count() && !w->prints) {
            RECORD(keep, &count, 1);
            room_for_hits(r, count);
            RECORD(keep, r->hit, (size_t)count);
        }
        if (shard_is() && !w->prints) continue;
        for (int k = 0; k < count; k++) {
            sgt_hit *h = &r->hit[k];
            const double no = (double)NAN;
            const sgt_vec3 nowhere = {no, no, no};
            note_status(&r->found, h->status, b, i);
            if (h->status <= 0) h->p = h->n = nowhere;
            if (h->status >= 0) h->lo = h->hi = no;
            lost = lost || h->status < 0;
        }
        find_places(w, r, count);
        sgt_hit *h = r->hit;
        const int *root = root_of(h->status, 0) < 0 ? &none : r->place;
        const size_t step = sizeof *h;
        const table_values rows[HEAD_COUNT] = {
            {.at = &number}, TABLE_VALUES(root), {&h->status, step, answer_word}, {&h->t, step, NULL},
            {&h->t_err, step, NULL}, {&h->p.x, step, NULL}, {&h->p.y, step, NULL}, {&h->p.z, step, NULL},
            {&h->n.x, step, NULL}, {&h->n.y, step, NULL}, {&h->n.z, step, NULL}, {&h->evals, step, NULL},
        };
        table_gap(r->rows);
        put_answers(w, r, (size_t)count, rows, (table_values){.at = &b->id[i]},
                    (table_values){&h->lo, step, NULL}, (table_values){&h->hi, step, NULL});
        watch_intersect(w->watch, (size_t)(r - w->room), w->surface, &l, opt, true, lost);
    }
}

static void find(void *data, const tile *t)
{
    const intersect_work *w = data;
    intersect_room *r = &w->room[t->place];
    keeping keep = {.put = shard_is() ? &r->kept : NULL};
    if (shard_joins()) {
        size_t size;
        keep.at = shard_tile(&w->whole, 0, t, &size), keep.end = keep.at + size;
    }
    if (!w->prints || !shard_joins()) {
        rays_part(&w->asked->rays, t->first, t->count, &r->rays);
        if (w->asked->single) round_to_floats(&r->rays);
        (w->asked->all ? find_all : find_one_each)(w, r, &keep);
    }
    if (!w->prints) return;
    RECORD(&keep, r->found.count, STATUS_COUNT);
    if (!w->asked->shared.target.placed) record_rows(&keep, r->rows);
}

static void intersect_take(void *data, const tile *t)
{
    intersect_work *w = data;
    intersect_room *r = &w->room[t->place];
    if (shard_is()) {
        shard_write(NULL, r->kept.length, r->kept.at);
        if (w->asked->shared.target.placed) table_place(w->table, r->rows, t->first);
        r->kept.length = 0;
        r->found = (findings){.shown = 0};
        progress_add(t->count);
        return;
    }
    table_join(w->table, r->rows);
    watch_take(w->watch, t->place);
    w->rays += r->rays.count;
    progress_add(t->count);
    findings *all = &w->found, *f = &r->found;
    for (int s = 0; s < STATUS_COUNT; s++) all->count[s] += f->count[s];
    if (f->any_missed && !all->any_missed) all->any_missed = true, all->missed = f->missed;
    for (int i = 0; i < f->shown && all->shown < UNDECIDED_SHOWN; i++)
        all->undecided[all->shown++] = f->undecided[i];
    *f = (findings){.shown = 0};
}

/* ---------------------------------------------------------------- verdict */

/* "3 hits proven to be the first", "1 miss proven"; without --proof "3 hit", "1 miss". */
static int print_count(char *text, size_t size, const intersect_work *w, sgt_status status, size_t n)
{
    const sgt_options *asked = &w->asked->shared.solver;
    if (asked->proof && status == SGT_HIT) {
        bool near_seed = options_near_seed(&w->asked->shared, w->surface, SGT_FIRST);
        const char *proven = w->asked->all
                                 ? n > 1 ? "proven to be single roots" : "proven to be a single root"
                                 : explain_proof(asked, near_seed, n > 1);
        return snprintf(text, size, "%zu hit%s %s", n, n > 1 ? "s" : "", proven);
    }
    if (asked->proof && status == SGT_GRAZE)
        return snprintf(text, size, "%zu graze%s (touches, as far as can be told)", n, n > 1 ? "s" : "");
    if (asked->proof && status == SGT_MISS)
        return snprintf(text, size, "%zu miss%s proven", n, n > 1 ? "es" : "");
    return snprintf(text, size, "%zu %s", n, sgt_status_text(status));
}

/* "5 rays: 3 hit, 2 miss.  Every answer is certain." */
static void write_verdict(const intersect_work *w, size_t undecided)
{
    table *t = w->table;
    const intersect_arguments *a = w->asked;
    char text[400] = "", rows[60] = "";
    size_t length = 0, all = 0, rays = w->rays;
    for (int s = SGT_GRAZE; s >= SGT_INVALID; s--) {
        size_t n = w->found.count[s - SGT_INVALID];
        if (n == 0) continue;
        all += n;
        length += (size_t)snprintf(text + length, sizeof text - length, "%s ", length ? "," : "");
        length += (size_t)print_count(text + length, sizeof text - length, w, (sgt_status)s, n);
    }
    if (a->all) snprintf(rows, sizeof rows, ", %zu row%s", all, all == 1 ? "" : "s");
    bool fast = options_fast(&a->shared, w->surface);
    table_line(t, "%zu ray%s%s:%s.%s", rays, rays == 1 ? "" : "s", rows, rays ? text : " nothing to decide",
               undecided || fast || rays == 0 || a->shared.solver.proof ? "" : "  Every answer is certain.");
    if (a->single) table_line(t, "All of the rays as they are rounded to single precision.");
    if (undecided && a->all) {
        table_line(t,
                   "In an undecided row, t +- t_err is a stretch that may hold roots, or none.  To see why,");
        table_line(t, "run sagitta diagnose on the ray with the ends of the stretch as tmin and tmax.");
    } else if (w->found.shown == UNDECIDED_SHOWN && undecided > UNDECIDED_SHOWN) {
        table_line(t, "%zu more undecided: sagitta diagnose shows why.", undecided - UNDECIDED_SHOWN);
    }
    if (fast) table_line(t, "%s", explain_fast);
}

static void write_undecided(const intersect_work *w)
{
    const intersect_arguments *a = w->asked;
    for (int i = 0; i < w->found.shown && !a->all; i++) {
        char who[40];
        const sgt_ray ray = w->found.undecided[i].ray;
        const sgt_hit hit = sgt_intersect(w->surface, ray, &a->shared.solver);
        const sgt_element alone = {.surface = w->surface};
        const sgt_search s = options_search(&a->shared, &alone, SGT_FIRST, ray, &hit);
        snprintf(who, sizeof who, "Ray %zu: ", w->found.undecided[i].number);
        options_say_undecided(w->table, who, &s);
    }
}

/* The columns, with id, lo and hi only if they are wanted. */
static size_t intersect_columns_of(const intersect_work *w, column to[COLUMNS_MOST])
{
    size_t n = HEAD_COUNT;
    memcpy(to, intersect_head, sizeof intersect_head);
    if (w->asked->rays.named) to[n++] = intersect_id;
    if (w->stretches) to[n++] = left[0], to[n++] = left[1];
    for (int k = 0; k < 3 && w->earth; k++) to[n++] = earth_head[k];
    return n;
}

/* A ray that does not fit in floats ends the command before anything is written; of a shard, before its rows
 * are. */
static void check_singles(const intersect_arguments *a)
{
    ray_block *b = memory_take(1, sizeof *b);
    for (size_t i = 0; i < a->rays.count && !a->rays.some; i += TILE_RAYS) {
        const size_t rest = a->rays.count - i;
        rays_part(&a->rays, i, rest < TILE_RAYS ? rest : TILE_RAYS, b);
        round_to_floats(b);
    }
}

static exit_status intersect_run(const command *c, int argc, char *argv[])
{
    intersect_arguments a = intersect_arguments_of(c, argc, argv);
    const bool text = a.shared.target.format == TABLE_TEXT;
    intersect_work w = {.asked = &a, .surface = surface_parse("--surface", a.surface),
                        .stretches = a.shared.solver.proof && (!text || a.shared.target.columns)};
    column columns[COLUMNS_MOST];
    w.earth = earth_rays(w.surface, &a.rays, &w.over);
    if (a.rays.places)
        fail_usage("a place (--from, lat) needs a surface about the Earth: '{type: geodetic_height}' is the "
                   "ellipsoid of WGS84; or level_gravity, geoid");
    if (a.single && w.earth)
        fail_usage("--single: not about the Earth; in single precision a place is known to half a metre");
    if (a.single) check_singles(&a);
    options_note_unread(&a.shared, 1, &(sgt_element){.surface = w.surface});
    a.shared.target.word_size = a.rays.longest_id;
    tiling in = {.rays = a.rays.count, .threads = a.rays.threads, .share = SHARE_MOST};
    watch_tiling(&in, a.watched.path, &a.shared.solver);
    w.whole = in, in = shard_tiling(w.whole);
    shard_begin();
    const bool array = a.rays.table != NULL;
    w.prints = options_print(&a.shared, !array || !a.rays.named, !a.all && !(a.skip_bad && array),
                             a.rays.count);
    size_t places = tiles_places(&in), undecided = 0;
    w.watch = watch_begin(&a.watched, a.shared.target.hexadecimal, places, 0);
    w.table = table_begin(&a.shared.target, intersect_columns_of(&w, columns), columns);
    w.room = memory_take(places, sizeof *w.room);
    for (size_t i = 0; i < places; i++) w.room[i].rows = table_part(w.table);
    progress_begin(in.rays, !a.shared.target.path, a.shared.progress);
    shard_run(&w.whole, &w, find, intersect_take);
    table_placed(w.table);
    input_check();
    progress_end();
    shard_end();
    if (shard_is()) return EXIT_DECIDED;
    for (int s = SGT_INVALID; s < 0; s++) undecided += w.found.count[s - SGT_INVALID];
    if (text) {
        if (w.rays) table_line(w.table, "%s", legend_of(a.shared.target.columns, w.earth));
        if (w.found.any_missed)
            explain_miss(w.table, w.found.missed.number, w.surface, &w.found.missed.ray);
        write_undecided(&w);
        write_verdict(&w, undecided);
    }
    table_end(w.table);
    watch_end(w.watch);
    return undecided ? EXIT_UNDECIDED : EXIT_DECIDED;
}

// SPDX-License-Identifier: MIT
/* trace.c - sagitta trace: rays through a lens. */
#include "commands.h"
#include "record.h"
#include "watch.h"
#include "watched.h"
#include "../show/frame.h"
#include "../base/input.h"
#include "../job/job.h"
#include "../base/memory.h"
#include "../base/progress.h"
#include "../draw/pictures.h"
#include "../read/surface.h"
#include "../base/tiles.h"

#include <math.h>
#include <stdio.h>
#include <limits.h>
#include <string.h>

static const column trace_head[] = {
    {"ray", COLUMN_COUNT}, {"element", COLUMN_INTEGER}, {"fate", COLUMN_CODE}, {"status", COLUMN_CODE},
    {"x", COLUMN_NUMBER}, {"y", COLUMN_NUMBER}, {"z", COLUMN_NUMBER},
    {"l", COLUMN_NUMBER}, {"m", COLUMN_NUMBER}, {"n", COLUMN_NUMBER},
    {"t", COLUMN_NUMBER}, {"t_err", COLUMN_ERROR}, {"opl", COLUMN_NUMBER}, {"evals", COLUMN_INTEGER},
};
static const column launch_head[] = {
    {"field", COLUMN_INTEGER}, {"wavelength", COLUMN_EXACT}, {"px", COLUMN_NUMBER}, {"py", COLUMN_NUMBER},
};
static const column trace_id = {"id", COLUMN_WORD}, left[] = {{"lo", COLUMN_NUMBER}, {"hi", COLUMN_NUMBER}};
enum {
    HEAD_COUNT = sizeof trace_head / sizeof trace_head[0],
    LAUNCH_COUNT = sizeof launch_head / sizeof launch_head[0],
    COLUMNS_MOST = HEAD_COUNT + LAUNCH_COUNT + 3
};

typedef struct trace_arguments {
    shared_options shared;
    job_options job;
    int global;
    bool last;
    pictures pictures;
    watch_options watched;
} trace_arguments;

static const option_row trace_rows[] = {
    {"last", NULL, "only the last row of each ray: where it ended", OPTION_FLAG,
     .to = offsetof(trace_arguments, last)},
    {"frame", "F",
     "the frame of points and directions: local or global\n"
     "local (the default): each surface's own; global: that of the first vertex",
     OPTION_WORD, .to = offsetof(trace_arguments, global), .words = "local global"},
    {"watch", "FILE",
     "write the evaluations of each ray that is lost, as csv\n"
     "The columns are those of sagitta diagnose, and wavelength",
     OPTION_TEXT, .to = offsetof(trace_arguments, watched.path)},
    WATCH_RAY_OPTION(trace_arguments),
    {"watch-element", "J", "with --watch: only at element J, counted from 1", OPTION_WHOLE,
     .to = offsetof(trace_arguments, watched.element), 1, INT_MAX},
    {"ray", "I", "--ray: give the rays of a lens as a file, --rays FILE, or on standard input, --rays -",
     .kind = OPTION_REFUSED}, /* else getopt would take it for --rays */
    {0},
};
static const option_row trace_picture_rows[] = {
    {"picture", "FILE", "draw the lens with the rays: svg, png or pdf, by the ending of the name",
     OPTION_TEXT,
     .to = offsetof(trace_arguments, pictures.file)},
    {"plane", "P",
     "of the picture: yz, xz or 3d\n"
     "yz (the default) and xz are sections; 3d is a view in space.  The rays of a fan lie in\n"
     "yz; --cross N sends as many in xz",
     OPTION_WORD, .to = offsetof(trace_arguments, pictures.plane), .least = 1, .words = "yz xz 3d"},
    {"svg", "FILE", "--svg FILE is now --picture FILE; the ending .svg, .png or .pdf says what is drawn",
     .kind = OPTION_REFUSED},
    {0},
};
static const option_row trace_search_rows[] = {
    PICK_OPTION("which root: near-seed or first\n"
                "near-seed (the default): the root near the surface's vertex; first: the first root on\n"
                "the line of the ray"),
    PROOF_OPTION("what must be proven at each element: estimate, root or first\n"
                 "estimate (the default): a root lies within t_err of t; root: and it is the only one\n"
                 "there; first: and no other root lies within the clear aperture; with --pick first,\n"
                 "and on a level set, no root lies before it.  A ray for which this is not proven is\n"
                 "lost, and its status is unproven"),
    {0},
};
static const option_group trace_own = {OPTIONS_OWN, "Options", .row = trace_rows},
                          trace_pictures = {OPTIONS_OWN, "Pictures", .row = trace_picture_rows},
                          trace_search = {OPTIONS_SHARED, "The search", .row = trace_search_rows};

static exit_status trace_run(const command *c, int argc, char *argv[]);

static const char trace_all[] =
    "Columns\n"
    "  ray, element       the ray, counted from 0, field after field; the surface, counted from 1\n"
    "  fate               of the ray there: passed; missed; clipped by the clear aperture; tir: total\n"
    "                     internal reflection; evanescent: the order of its phase does not exist for\n"
    "                     this ray; lost: it could not be decided\n"
    "  status             of the search for the root: hit; graze: the ray touches, as far as can be\n"
    "                     told; miss; or why it is undecided: unproven, undefined, exhausted\n"
    "  x, y, z            the point (length), in the surface's own frame; see --frame\n"
    "  l, m, n            the direction behind the surface (length 1), in the same frame\n"
    "  t, t_err           the length along the ray from the element before, or from its start at\n"
    "                     element 1, and a bound on its error (length)\n"
    "  opl                optical path length since the start of the ray (length).  The rays of a\n"
    "                     field start at the object, or on one wavefront if that is at infinity\n"
    "  evals              evaluations of the surface's equation\n"
    "  field, wavelength  csv and json, and text if there are several wavelengths: the field, counted\n"
    "                     from 1; the wavelength in micrometres; empty where there is none\n"
    "  px, py             with them: where the ray was sent through the pupil, in radii of it\n"
    "  id                 as the file of rays gives it, if it has this column\n"
    "  lo, hi             with --proof root or first, csv and json only: of an undecided row, the\n"
    "                     stretch of the ray still in doubt (like t)\n"
    "\n"
    "A lens file is YAML.  docs/lens_file.md has every key, examples/lenses has complete files.\n"
    "  file:     name, units, wavelengths: [micrometres], makers: [of glasses],\n"
    "            object: {distance, slope, index or glass}, pupil: {semi_diameter, distance},\n"
    "            fields: [degrees], surfaces: [...]\n"
    "  surface:  type, radius or curvature, conic, coefficients, semi_diameter,\n"
    "            thickness (to the next vertex), index or glass (of the medium behind it),\n"
    "            mirror, stop, decenter and tilt: [x, y, z]; or origin and tilt in every surface\n";

static const char *trace_words(const void *context)
{
    (void)context;
    return "ray element fate status x y z l m n t t_err opl evals field wavelength px py id lo hi";
}

const command command_trace = {
    .name = "trace", .usage = "LENS [options]", .brief = "rays through a lens file, surface by surface",
    .what = "Traces rays through a lens file.  Prints a row for each ray and each element it reached: "
            "what became of the ray there, the point, the direction behind it, and a bound on the "
            "error.",
    .often = "field fan grid rays wavelength configuration "
             "picture last frame proof format output", .rays = "--fan 5",
    .examples = "  sagitta trace examples/lenses/ftheta.yaml --field 20 --fan 3\n"
                "  sagitta trace examples/lenses/cooke_triplet.yaml --fan 7 --picture triplet.svg\n",
    .docs = "docs/lens_file.md (every key of a lens file), docs/rays.md", .all = trace_all,
    .columns = trace_words,
    .group = {&trace_own, &trace_pictures, JOB_GROUPS,
              &trace_search, &options_solver, &options_in_threads, &options_shards, &options_rows},
    .run = trace_run,
};

static trace_arguments trace_arguments_of(const command *c, int argc, char *argv[])
{
    trace_arguments a = {.job = {.several = true, .parts = true}};
    command_read(c, &a, &a.job, &a.shared, argc, argv);
    a.job.lens = command_file(c, "lens file", argc, argv);
    pictures_check(&a.pictures);
    options_shard(&a.shared, a.watched.path);
    if (shard_is() && a.watched.path) fail_usage("--watch: not with --shard; it is of one run");
    return a;
}

/* ------------------------------------------------------------------ tiles */

/* How many rays ended at an element, by fate. */
typedef struct losses {
    size_t clipped, tir, evanescent, missed, lost[SGT_HIT - SGT_INVALID + 1]; /* lost: by status */
} losses;

static void count_loss(losses *l, sgt_fate fate, sgt_status status)
{
    if (fate == SGT_CLIPPED) l->clipped++;
    else if (fate == SGT_TIR) l->tir++;
    else if (fate == SGT_EVANESCENT) l->evanescent++;
    else if (fate == SGT_MISSED) l->missed++;
    else l->lost[(status < 0 ? (int)status : 0) - SGT_INVALID]++;
}

enum { RECORDS_MOST = 1 << 16 }; /* the most rays times elements in a tile */

/* Rows of the table by column: how rays met elements.  With --last, the row of each ray
 * of a tile: the library writes how the last element was met right here. */
typedef struct element_rows {
    size_t count, ray[TILE_RAYS];  /* which ray of the tile */
    long long number[TILE_RAYS];
    int element[TILE_RAYS], evals[TILE_RAYS], field[TILE_RAYS];
    sgt_fate fate[TILE_RAYS];
    sgt_status status[TILE_RAYS];
    double value[9][TILE_RAYS];    /* p, direction, t, t_err, opl */
    double px[TILE_RAYS], py[TILE_RAYS], lo[TILE_RAYS], hi[TILE_RAYS];
    const char *id[TILE_RAYS];
} element_rows;

/* The room of a tile: its rays, what became of them, and its rows of the table. */
typedef struct trace_room {
    ray_block rays;
    double end[6][TILE_RAYS];      /* where each ended, o and d */
    sgt_fate fate[TILE_RAYS];
    int passed[TILE_RAYS];
    size_t capacity;               /* rays in a passage */
    sgt_passages *passages;        /* [elements]: how each was met; NULL until they are needed */
    sgt_passages *last;            /* [elements]: only of the last, point into rows; NULL: all are needed */
    sgt_passage *alone;            /* [elements], for a ray traced by itself to get lo and hi */
    element_rows rows;
    table *table;
    bytes kept;                    /* of a shard: for who joins */
} trace_room;

typedef struct trace_work {
    const trace_arguments *asked;
    const job *job;
    trace_room *room;
    table *table;
    scene *picture;                /* NULL: none */
    watch *watch;                  /* NULL: none */
    bool alone;                    /* there is one thread: rows need not wait for their turn */
    bool text, every;              /* every: it matters how each element was met, not only the last row */
    const job_lens *at;             /* the lens at the wavelength that is being traced */
    bool launches;                 /* there are the columns of launch_head */
    bool stretches;                /* there are columns lo and hi */
    bool prints;                   /* of ranks: each prints its own rows */
    tiling whole;                  /* of all shards together */
    size_t rays, passed, proven, undecided; /* how many rays; proven: passed and grazed no element */
    struct { launch ray; const job_lens *at; } lost[UNDECIDED_SHOWN];
    int shown;
    struct {
        launch ray;
        const job_lens *at;
        size_t element;
        const char *why;
    } ended[UNDECIDED_SHOWN];
    size_t ended_shown, ended_count;
    size_t *back;                  /* [elements]: how many rays came to it at t < 0 */
    struct { size_t rays, passed, first, last; } *field; /* [fields]: and where the others ended */
    losses *loss;                  /* [elements] */
    sgt_vec3 *point;               /* [elements + 1] */
} trace_work;

/* number: for each of p, direction, t, t_err, opl an array, so many numbers apart. */
static sgt_passages passages_into(sgt_status *status, int *evals, double *number, size_t apart)
{
    double *n[9];
    for (size_t k = 0; k < 9; k++) n[k] = number + k * apart;
    return (sgt_passages){.hits = {.status = status, .evals = evals, .p = {n[0], n[1], n[2]}, .t = n[6],
                                   .t_err = n[7]},
                          .direction = {n[3], n[4], n[5]}, .opl = n[8]};
}

static void need_passages(const trace_work *w, trace_room *r)
{
    const size_t count = w->job->lens.count, rays = r->capacity;
    if (r->passages) return;
    r->passages = memory_take(count, sizeof *r->passages);
    sgt_status *status = memory_take(count, rays * sizeof *status);
    int *evals = memory_take(count, rays * sizeof *evals);
    double *number = memory_take(count, 9 * rays * sizeof *number);
    for (size_t i = 0; i < count; i++)
        r->passages[i] = passages_into(status + i * rays, evals + i * rays, number + 9 * i * rays, rays);
}

static void make_room(const trace_work *w, trace_room *r, size_t rays)
{
    const size_t count = w->job->lens.count;
    r->capacity = rays, r->table = w->alone ? w->table : table_part(w->table);
    if (w->stretches) r->alone = memory_take(count, sizeof *r->alone);
    if (w->every) return;
    r->last = memory_take(count, sizeof *r->last);
    r->last[count - 1] = passages_into(r->rows.status, r->rows.evals, r->rows.value[0], TILE_RAYS);
}

static sgt_vec3 vector_at(double *const n[3], size_t i) { return (sgt_vec3){n[0][i], n[1][i], n[2][i]}; }

/* Traces a ray by itself, for the lo and hi that a batch does not give.  Returns the hit where it ended. */
static const sgt_hit *ended(const trace_work *w, const launch *l, sgt_passage alone[], size_t element)
{
    sgt_ray ray = l->ray;
    sgt_trace(element + 1, w->at->element, w->at->lens.index_before, &ray, alone, NULL,
              &w->asked->shared.solver);
    return &alone[element].hit;
}

static const char *fate_word(int code) { return sgt_fate_text((sgt_fate)code); }
static const char *status_word(int code) { return sgt_status_text((sgt_status)code); }

/* What a row has besides what the library tells. */
static void finish_row(const trace_work *w, trace_room *r, size_t k)
{
    element_rows *o = &r->rows;
    const ray_block *b = &r->rays;
    const size_t i = o->ray[k], element = (size_t)o->element[k] - 1;
    double(*n)[TILE_RAYS] = o->value;
    /* NaN: the point of a miss, the direction of a ray that ended here */
    for (int c = 0; c < 3 && o->status[k] <= 0; c++) n[c][k] = (double)NAN;
    for (int c = 3; c < 6 && o->fate[k] != SGT_PASSED; c++) n[c][k] = (double)NAN;
    if (w->asked->global) {
        const sgt_pose *pose = &w->at->element[element].pose;
        const sgt_vec3 p = frame_point_out(pose, (sgt_vec3){n[0][k], n[1][k], n[2][k]}),
                       d = frame_direction_out(pose, (sgt_vec3){n[3][k], n[4][k], n[5][k]});
        n[0][k] = p.x, n[1][k] = p.y, n[2][k] = p.z, n[3][k] = d.x, n[4][k] = d.y, n[5][k] = d.z;
    }
    o->number[k] = b->ray[i], o->px[k] = b->px[i], o->py[k] = b->py[i], o->id[k] = b->id[i];
    if (w->job->fields) o->field[k] = (int)w->job->field_number[b->field[i]] + 1;
    if (!w->stretches) return;
    const launch l = rays_launch(b, i);
    const sgt_hit *hit = o->status[k] < 0 ? ended(w, &l, r->alone, element) : NULL;
    o->lo[k] = hit ? hit->lo : (double)NAN, o->hi[k] = hit ? hit->hi : (double)NAN;
}

/* Gives the table the rows so far. */
static void put_rows(const trace_work *w, trace_room *r)
{
    element_rows *o = &r->rows;
    double(*n)[TILE_RAYS] = o->value;
    const double *um = &w->at->lens.wavelength;
    const bool beam = w->job->fields > 0;
    size_t c = HEAD_COUNT;
    table_values all[COLUMNS_MOST] = {
        TABLE_VALUES(o->number), TABLE_VALUES(o->element), {o->fate, 1, fate_word},
        {o->status, 1, status_word}, TABLE_VALUES(n[0]), TABLE_VALUES(n[1]), TABLE_VALUES(n[2]),
        TABLE_VALUES(n[3]), TABLE_VALUES(n[4]), TABLE_VALUES(n[5]), TABLE_VALUES(n[6]), TABLE_VALUES(n[7]),
        TABLE_VALUES(n[8]), TABLE_VALUES(o->evals),
    };
    const table_values launched[LAUNCH_COUNT] = {TABLE_VALUES(o->field), {.at = um}, TABLE_VALUES(o->px),
                                                 TABLE_VALUES(o->py)};
    for (int k = 0; w->launches && k < LAUNCH_COUNT; k++)
        all[c++] = (k == 1 ? !isnan(*um) : beam) ? launched[k] : (table_values){.at = NULL};
    if (w->job->rays.named) all[c++] = (table_values)TABLE_VALUES(o->id);
    const table_values ends[] = {TABLE_VALUES(o->lo), TABLE_VALUES(o->hi)};
    for (int k = 0; w->stretches && k < 2; k++) all[c++] = ends[k];
    for (size_t k = 0; k < o->count; k++) finish_row(w, r, k);
    table_block(r->table, o->count, all);
    o->count = 0;
}

/* Makes the row k: of the ray i at an element, which the passages have at the place `at`. */
static void copy_row(trace_room *r, size_t k, size_t i, size_t element, sgt_fate fate, size_t at)
{
    element_rows *o = &r->rows;
    const sgt_passages *p = &r->passages[element];
    const sgt_hits *h = &p->hits;
    const double *from[9] = {h->p[0], h->p[1], h->p[2], p->direction[0], p->direction[1], p->direction[2],
                             h->t, h->t_err, p->opl};
    for (int c = 0; c < 9; c++) o->value[c][k] = from[c][at];
    o->ray[k] = i, o->element[k] = (int)element + 1, o->fate[k] = fate;
    o->status[k] = h->status[at], o->evals[k] = h->evals[at];
}

static void trace_columns(const trace_work *w, size_t n, sgt_rays rays, sgt_traced out,
                          const sgt_passages passages[])
{
    sgt_trace_batch(w->job->lens.count, w->at->element, w->at->lens.index_before, n, rays, out, passages,
                    &w->asked->shared.solver);
}

/* The last row of each ray.  Those that ended before the last element are traced again, with passages of all
 * elements. */
static void last_rows(const trace_work *w, trace_room *r)
{
    element_rows *o = &r->rows;
    double(*n)[TILE_RAYS] = r->end; /* where they ended is not wanted */
    size_t again = 0, at = 0;
    o->count = r->rays.count;
    for (size_t i = 0; i < o->count; i++) {
        o->ray[i] = i, o->fate[i] = r->fate[i], o->element[i] = (int)w->job->lens.count;
        if (o->element[i] - r->passed[i] <= 1) continue;
        for (int k = 0; k < 6; k++) n[k][again] = r->rays.number[k][i];
        again++;
    }
    if (!again) return;
    need_passages(w, r);
    trace_columns(w, again, (sgt_rays){.o = {n[0], n[1], n[2]}, .d = {n[3], n[4], n[5]}},
                  (sgt_traced){.fate = NULL}, r->passages);
    for (size_t i = 0; i < o->count; i++)
        if (o->element[i] - r->passed[i] > 1) copy_row(r, i, i, (size_t)r->passed[i], r->fate[i], at++);
}

/* The rows of each ray, with gaps between rays. */
static void every_row(const trace_work *w, trace_room *r)
{
    for (size_t i = 0; i < r->rays.count; i++) {
        const size_t passed = (size_t)r->passed[i], end = passed + (r->fate[i] != SGT_PASSED);
        if (!w->asked->last) table_gap(r->table);
        for (size_t k = w->asked->last ? end - 1 : 0; k < end; k++) {
            if (r->rows.count == TILE_RAYS) put_rows(w, r);
            copy_row(r, r->rows.count++, i, k, k < passed ? SGT_PASSED : r->fate[i], i);
        }
        if (w->text && !w->asked->last) put_rows(w, r); /* before the next gap */
    }
}

/* How many rays of a tile there are, and those that are not. */
static void record_lost(keeping *to, ray_block *b)
{
    RECORD(to, &b->count, 1), RECORD(to, &b->lost_count, 1), RECORD(to, &b->folded, 1);
    if (b->lost_room < b->lost_count)
        b->lost_room = b->lost_count, b->lost = memory_grow(b->lost, b->lost_room, sizeof *b->lost);
    RECORD(to, b->lost, b->lost_count);
}

/* The rays that were launched for a tile: aimed ones take as long as tracing. */
static void record_rays(keeping *to, ray_block *b)
{
    record_lost(to, b);
    for (int k = 0; k < 6; k++) RECORD(to, b->number[k], b->count);
    RECORD(to, b->ray, b->count), RECORD(to, b->field, b->count);
    RECORD(to, b->px, b->count), RECORD(to, b->py, b->count);
}

static void record_passages(keeping *to, const sgt_passages *p, size_t count)
{
    const sgt_hits *h = &p->hits;
    double *const number[] = {h->p[0], h->p[1], h->p[2], p->direction[0], p->direction[1], p->direction[2],
                              h->t, h->t_err, p->opl};
    RECORD(to, h->status, count), RECORD(to, h->evals, count);
    for (int k = 0; k < 9; k++) RECORD(to, number[k], count);
}

/* What became of them. */
static void record_traced(keeping *to, const trace_work *w, trace_room *r)
{
    const size_t count = r->rays.count, elements = w->job->lens.count;
    RECORD(to, r->fate, count), RECORD(to, r->passed, count);
    for (int k = 0; k < 6 && w->picture; k++) RECORD(to, r->end[k], count);
    for (size_t i = w->every ? 0 : elements - 1; i < elements; i++)
        record_passages(to, w->every ? &r->passages[i] : &r->last[i], count);
}

/* The rays of a tile, traced: here, or by a shard. */
static void trace_tile(const trace_work *w, trace_room *r, const tile *t, keeping *keep)
{
    const bool made = w->at->plan.fields, keeps = shard_count() && !w->prints;
    if (!shard_joins() || !made) job_part(w->at, t->first, t->count, &r->rays);
    if (keeps && made) record_rays(keep, &r->rays);
    sgt_traced out = {.fate = r->fate, .passed = r->passed};
    for (int k = 0; k < 3 && w->picture; k++) out.o[k] = r->end[k], out.d[k] = r->end[3 + k];
    if (w->every) need_passages(w, r);
    if (!shard_joins())
        trace_columns(w, r->rays.count, rays_columns(&r->rays), out, w->every ? r->passages : r->last);
    if (keeps) record_traced(keep, w, r);
}

/* The rows of a tile that its rank has printed, and what is counted. */
static void record_printed(keeping *to, const trace_work *w, trace_room *r)
{
    record_lost(to, &r->rays);
    RECORD(to, r->fate, r->rays.count);
    if (!w->asked->shared.target.placed) record_rows(to, r->table);
}

static void send(void *data, const tile *t)
{
    const trace_work *w = data;
    trace_room *r = &w->room[t->place];
    keeping keep = {.put = shard_is() ? &r->kept : NULL};
    if (shard_joins()) {
        size_t size;
        keep.at = shard_tile(&w->whole, (size_t)(w->at - w->job->at), t, &size), keep.end = keep.at + size;
    }
    if (!w->prints || !shard_joins()) {
        trace_tile(w, r, t, &keep);
        if (shard_is() && !w->prints) return;
        (w->every ? every_row : last_rows)(w, r);
        put_rows(w, r);
    }
    if (w->prints) record_printed(&keep, w, r);
    for (size_t i = 0; i < r->rays.count && w->watch; i++) {
        const launch l = rays_launch(&r->rays, i);
        watch_trace(w->watch, t->place, w->at, &l, &w->asked->shared.solver, r->fate[i] < 0);
    }
}

enum { DRAWN = 20000 }; /* so many rays of each wavelength are in the picture, the first */

static void draw(trace_work *w, const trace_room *r, const launch *l, size_t i)
{
    sgt_fate fate = r->fate[i];
    size_t met = (size_t)r->passed[i] + (fate == SGT_CLIPPED || fate == SGT_TIR || fate == SGT_EVANESCENT);
    w->point[0] = l->ray.o;
    for (size_t k = 0; k < met; k++)
        w->point[k + 1] = frame_point_out(&w->at->element[k].pose, vector_at(r->passages[k].hits.p, i));
    scene_add(w->picture, l->field, (size_t)(w->at - w->job->at), met + 1, w->point, fate,
              (sgt_vec3){r->end[3][i], r->end[4][i], r->end[5][i]});
}

/* Was it a hit at every element?  A graze is not proven. */
static bool crossed_all(const trace_work *w, const trace_room *r, size_t i)
{
    for (size_t k = 0; k < w->job->lens.count; k++)
        if (r->passages[k].hits.status[i] != SGT_HIT) return false;
    return true;
}

/* Keeps why the first rays ended. */
static void keep_ended(trace_work *w, const trace_room *r, const launch *l, size_t i)
{
    const size_t element = (size_t)r->passed[i];
    const lens *of = &w->at->lens;
    const sgt_element *e = &w->at->element[element], *before = element ? e - 1 : NULL;
    if (r->fate[i] < 0 || w->ended_count++ >= UNDECIDED_SHOWN) return;
    sgt_vec3 from = l->ray.o, d = l->ray.d;
    if (before) {
        from = frame_point_out(&before->pose, vector_at(r->passages[element - 1].hits.p, i));
        d = frame_direction_out(&before->pose, vector_at(r->passages[element - 1].direction, i));
    }
    char why[WHY_SIZE];
    const sgt_arrival a = arrival_of(of, element, from, d, vector_at(r->passages[element].hits.p, i));
    sgt_why_ended(e, (sgt_fate)r->fate[i], &a, sizeof why, why);
    size_t k = w->ended_shown++;
    w->ended[k].ray = *l, w->ended[k].at = w->at, w->ended[k].element = element;
    w->ended[k].why = memory_text(why, strlen(why));
}

static void count_field(trace_work *w, const launch *l, size_t passed)
{
    if (!w->job->fields) return;
    bool all = passed == w->job->lens.count;
    w->field[l->field].rays++, w->field[l->field].passed += all;
    if (all) return;
    if (!w->field[l->field].first || passed + 1 < w->field[l->field].first)
        w->field[l->field].first = passed + 1;
    if (passed + 1 > w->field[l->field].last) w->field[l->field].last = passed + 1;
}

static void trace_take(void *data, const tile *t)
{
    trace_work *w = data;
    trace_room *r = &w->room[t->place];
    const ray_block *b = &r->rays;
    if (shard_is()) {
        shard_write(NULL, r->kept.length, r->kept.at);
        if (w->asked->shared.target.placed)
            table_place(w->table, r->table, (size_t)(w->at - w->job->at) * w->whole.rays + t->first);
        r->kept.length = 0;
        progress_add(t->count);
        return;
    }
    if (!w->alone) table_join(w->table, r->table);
    watch_take(w->watch, t->place);
    if (w->job->how) launch_take(w->job->how, b);
    w->rays += b->count;
    progress_add(t->count);
    for (size_t i = 0; i < b->count; i++) w->undecided += r->fate[i] < 0;
    for (size_t i = 0; i < b->count && w->every && !w->prints; i++) {
        int passed = r->passed[i];
        const launch one = rays_launch(b, i), *l = &one;
        if (r->fate[i] == SGT_PASSED) w->passed++, w->proven += crossed_all(w, r, i);
        else count_loss(&w->loss[passed], r->fate[i], r->passages[passed].hits.status[i]);
        if (r->fate[i] != SGT_PASSED) keep_ended(w, r, l, i);
        count_field(w, l, (size_t)passed);
        for (int k = 0; k < passed; k++) w->back[k] += r->passages[k].hits.t[i] < 0;
        if (r->fate[i] < 0 && r->passages[passed].hits.status[i] < 0 && w->shown < UNDECIDED_SHOWN)
            w->lost[w->shown].ray = *l, w->lost[w->shown++].at = w->at;
        if (w->picture && l->number < DRAWN) draw(w, r, l, i);
    }
}

/* ---------------------------------------------------------------- verdict */

static const char *trace_also(const char *text, size_t n, const char *what)
{
    return n ? memory_print("%s%s %zu %s", text, *text ? "," : "", n, what) : text;
}

/* Prints what is proven of the rays that passed. */
static void write_proof(const trace_work *w)
{
    const trace_arguments *a = w->asked;
    bool others = false, sets = false;
    if (!a->shared.solver.proof) return;
    for (size_t i = 0; i < w->job->lens.count; i++) {
        bool set = surface_is_level_set(w->job->element[i].surface);
        sets = sets || set, others = others || !set;
    }
    const char *what = a->shared.solver.proof == SGT_PROVE_ROOT        ? ""
                       : a->shared.solver.pick == SGT_FIRST || !others ? ", and none before it"
                       : sets ? ", and no other within the clear aperture (on a level set: none before it)"
                              : ", and no other within the clear aperture";
    table_line(w->table,
               "Proven for %zu of them: at each element one root, and only one, lies within t_err of t%s.",
               w->proven, what);
}

static void write_losses(table *t, const job *j, const losses loss[])
{
    for (size_t i = 0; i < j->lens.count; i++) {
        const char *text = trace_also("", loss[i].missed, "missed it");
        text = trace_also(text, loss[i].clipped, "clipped");
        text = trace_also(text, loss[i].tir, "totally reflected");
        text = trace_also(text, loss[i].evanescent, "evanescent");
        for (int s = 0; s >= SGT_INVALID; s--)
            if (loss[i].lost[s - SGT_INVALID])
                text = trace_also(text, loss[i].lost[s - SGT_INVALID],
                                  memory_print("lost (%s)", s ? sgt_status_text((sgt_status)s)
                                                              : "direction undecided"));
        if (*text) table_line(t, "element %zu (%s):%s", i + 1, j->lens.surface[i].type, text);
    }
}

/* "Ray 9 (field 2, px 0, py -0.33, 0.4861 um)" */
static const char *ray_name(const trace_work *w, const launch *l, const job_lens *at)
{
    if (!w->job->fields) return memory_print("Ray %zu", l->number);
    const bool coloured = w->job->wavelengths > 1 && !isnan(at->lens.wavelength);
    return memory_print("Ray %zu (field %zu, px %.4g, py %.4g%s)", l->number,
                        w->job->field_number[l->field] + 1,
                        l->px, l->py, coloured ? memory_print(", %.6g um", at->lens.wavelength) : "");
}

static void write_ended(const trace_work *w)
{
    for (size_t k = 0; k < w->ended_shown; k++)
        table_line(w->table, "%s at element %zu: %s.", ray_name(w, &w->ended[k].ray, w->ended[k].at),
                   w->ended[k].element + 1, w->ended[k].why);
    if (w->ended_count > w->ended_shown)
        table_line(w->table, "%zu more did not get through: sagitta diagnose LENS --ray N shows why.",
                   w->ended_count - w->ended_shown);
}

/* What is probably wrong with the lens, or with the rays that were sent. */
static void write_doubts(const trace_work *w)
{
    const job *j = w->job;
    const job_options *o = &w->asked->job;
    const bool aimed = o->aim_given ? o->aimed : j->lens.of->aim != SGT_LENS_AIM_PUPIL;
    for (size_t k = 1; k < j->lens.count; k++)
        if (w->back[k])
            table_line(
                w->table,
                "element %zu (%s): %zu ray%s came to it backwards (t < 0); behind a mirror a thickness is "
                "negative, else positive",
                k + 1, j->lens.surface[k].type, w->back[k], w->back[k] == 1 ? "" : "s");
    for (size_t f = 0; f < j->fields; f++) {
        if (!w->field[f].rays || w->field[f].passed) continue;
        const char *range = w->field[f].first < w->field[f].last
                                ? memory_print("elements %zu to %zu", w->field[f].first, w->field[f].last)
                                : memory_print("element %zu", w->field[f].first);
        table_line(w->table, "No ray of field %zu gets through: they end at %s%s",
                   j->field_number[f] + 1, range,
                   aimed ? "."
                         : ". --aim real sends them through the stop; --no-apertures clips none.");
    }
}

/* Under the table for people: what has a unit, and whose frame it is. */
static void write_legend(const trace_work *w)
{
    const char *units = w->job->lens.units, *primary = lens_primary(w->job->lens.of);
    table_line(w->table, "x y z, l m n: point and direction behind the element, in %s frame.  t, t_err: from",
               w->asked->global ? "the global" : "its own");
    table_line(
        w->table,
        "the element before, or the ray's start.  opl: optical path so far.  evals: evaluations.  Unit of "
        "length: %.20s.%s%s\n",
        *units ? units : "that of the lens", primary ? "\n" : "", primary ? primary : "");
}

/* Prints where and why the first lost rays were lost. */
static void write_lost(const trace_work *w)
{
    const job *j = w->job;
    sgt_passage *alone = memory_take(j->lens.count, sizeof *alone);
    for (int i = 0; i < w->shown; i++) {
        const shared_options *asked = &w->asked->shared;
        const job_lens *at = w->lost[i].at;
        sgt_ray ray = w->lost[i].ray.ray;
        size_t passed = sgt_trace(j->lens.count, at->element, at->lens.index_before, &ray, alone, NULL,
                                  &asked->solver);
        if (passed == j->lens.count) continue; /* never: a batch gives the same answers as single rays */
        const sgt_element *e = &at->element[passed];
        const sgt_search s = options_search(asked, e, SGT_NEAR_SEED, job_own_ray(&e->pose, &ray),
                                            &alone[passed].hit);
        const char *who = memory_print("%s at element %zu: ", ray_name(w, &w->lost[i].ray, at), passed + 1);
        options_say_undecided(w->table, who, &s);
    }
    if (w->undecided > (size_t)w->shown)
        table_line(w->table, "%zu more lost: sagitta diagnose shows why.", w->undecided - (size_t)w->shown);
}

static size_t trace_columns_of(const trace_work *w, column to[COLUMNS_MOST])
{
    size_t n = HEAD_COUNT;
    memcpy(to, trace_head, sizeof trace_head);
    for (int k = 0; w->launches && k < LAUNCH_COUNT; k++) to[n++] = launch_head[k];
    if (w->job->rays.named) to[n++] = trace_id;
    if (w->stretches) to[n++] = left[0], to[n++] = left[1];
    return n;
}

/* With --last: has each ray a row?  One that is aimed may not be there; a row of a file may be bad. */
static bool rows_known(const trace_arguments *a, const job *j)
{
    const sgt_lens_aim *aim = job_aim(&a->job, j->lens.of);
    if (!j->fields) return !(a->job.skip_bad && j->rays.table);
    return (aim ? *aim : j->lens.of->aim) == SGT_LENS_AIM_PUPIL;
}

/* ------------------------------------------------------------------ trace */

/* What the configurations share that are asked for.  Of one lens alone number is 0. */
typedef struct trace_shared {
    trace_arguments *asked;
    size_t number;               /* of the configuration that is traced, from 1 */
    const char *name;            /* its; "" for none */
    table *table;                /* NULL: it is not begun */
    bool launches;               /* as in trace_work; of the first */
    watch *watch;                /* of one lens; NULL: none */
} trace_shared;

/* Traces the rays of a lens.  *out and *j last as long as the picture. */
static exit_status trace_lens(trace_shared *shared, job *to, scene *out)
{
    trace_arguments a = *shared->asked;
    int threads = a.job.threads = options_threads(&a.shared);
    *to = job_read(&a.job);
    const job j = *to;
    if (shared->number < 2) options_note_unread(&a.shared, j.lens.count, j.element);
    const size_t count = j.lens.count;
    const bool text = a.shared.target.format == TABLE_TEXT, all = !text || a.shared.target.columns;
    /* A tile takes some 80 KB for each element.  At most 12 MB a thread: with many elements tiles have fewer
     * rays. */
    tiling in = {.rays = job_count(j.at), .threads = count > RECORDS_MOST ? 1 : threads,
                 .share = count < 16 ? SHARE_MOST : count < 128 ? 128 / count : 1,
                 .most = count > RECORDS_MOST               ? 1
                         : count > RECORDS_MOST / TILE_RAYS ? RECORDS_MOST / count
                                                            : TILE_RAYS};
    watch_tiling(&in, a.watched.path, &a.shared.solver);
    const tiling whole = in;
    in = shard_tiling(whole);
    const size_t places = tiles_places(&in);
    if (!shard_is() && !shared->table) pictures_reserve(&a.pictures, a.shared.target.path, to);
    *out = (scene){.job = to};
    if (a.pictures.file) *out = scene_begin(to, pictures_plane(&a.pictures));
    trace_work w = {.asked = &a,
                    .job = to,
                    .whole = whole,
                    .room = memory_take(places, sizeof *w.room),
                    .watch = watch_begin(&a.watched, a.shared.target.hexadecimal, places, count),
                    .picture = a.pictures.file ? out : NULL,
                    .text = text,
                    .alone = in.threads < 2,
                    .every = text || a.pictures.file || !a.last,
                    .launches = shared->table ? shared->launches : all || j.wavelengths > 1,
                    .stretches = all && a.shared.solver.proof,
                    .loss = memory_take(count, sizeof *w.loss),
                    .back = memory_take(count, sizeof *w.back),
                    .field = memory_take(j.fields, sizeof *w.field),
                    .point = memory_take(count + 1, sizeof *w.point)};
    column columns[COLUMNS_MOST];
    a.shared.target.word_size = j.rays.longest_id;
    if (!shared->table) shard_begin();
    const bool same = !w.picture && !(j.rays.table && j.rays.named);
    w.prints = options_print(&a.shared, same, a.last && rows_known(&a, &j), j.wavelengths * whole.rays);
    w.alone = w.alone && !w.prints;
    w.table = shared->table;
    if (!w.table) w.table = table_begin(&a.shared.target, trace_columns_of(&w, columns), columns);
    shared->table = w.table, shared->launches = w.launches;
    if (shared->number) {
        table_lead(w.table, shared->number);
        table_line(w.table, "%sConfiguration %zu%s%s.", shared->number > 1 ? "\n" : "", shared->number,
                   *shared->name ? ", " : "", shared->name);
    }
    for (size_t i = 0; i < places; i++) make_room(&w, &w.room[i], in.most);
    progress_begin(j.wavelengths * in.rays, !a.shared.target.path, a.shared.progress);
    for (size_t k = 0; k < j.wavelengths; k++) {
        w.at = &j.at[k];
        shard_run(&whole, &w, send, trace_take);
    }
    table_placed(w.table);
    input_check();
    progress_end();
    shard_end();
    if (shard_is()) return EXIT_DECIDED;
    if (a.pictures.file && job_count(j.at) > DRAWN)
        note("--picture: the first %d of %zu rays of each wavelength are drawn", DRAWN, job_count(j.at));
    job_end_parts(to);
    if (text) {
        if (w.rays) write_legend(&w);
        table_line(w.table, "%zu of %zu ray%s passed all %zu element%s.", w.passed, w.rays,
                   w.rays == 1 ? "" : "s", count, count == 1 ? "" : "s");
        write_proof(&w);
        write_losses(w.table, to, w.loss);
        write_ended(&w);
        write_doubts(&w);
        write_lost(&w);
    }
    shared->watch = w.watch;
    return w.undecided || to->undecided ? EXIT_UNDECIDED : EXIT_DECIDED;
}

/* What goes with one lens only. */
static void check_each(const trace_arguments *a)
{
    if (shard_count()) fail_usage("--configuration all: not in shards; give its number or name");
    if (a->watched.path) fail_usage("--watch: of one configuration; give its number or name");
    if (a->job.rays && strcmp(a->job.rays, "-") == 0)
        fail_usage("--rays -: can be read once only; give the number or name of one configuration");
}

/* "in colour configuration 1 wide, in grey 2 middle, 3 tele" */
static const char *picture_words(const lens_each *all)
{
    const char *text = "";
    for (size_t i = 0; i < all->count; i++)
        text = memory_print("%s%s%zu%s%s", text, i == 0 ? "in colour configuration " : i == 1 ? ", in grey "
                                                                                             : ", ",
                            i + 1, *all->name[i] ? " " : "", all->name[i]);
    return text;
}

static exit_status trace_run(const command *c, int argc, char *argv[])
{
    trace_arguments a = trace_arguments_of(c, argc, argv);
    const lens_each all = lens_open_each(a.job.lens);
    const size_t lenses = all.count ? all.count : 1;
    trace_shared shared = {.asked = &a};
    job *j = memory_take(lenses, sizeof *j);
    scene *picture = memory_take(lenses, sizeof *picture);
    exit_status worst = EXIT_DECIDED;
    if (all.count) check_each(&a);
    a.shared.target.leads = all.count;
    for (size_t i = 0; i < lenses; i++) {
        if (all.count) a.job.of = all.at[i], shared.number = i + 1, shared.name = all.name[i];
        const exit_status status = trace_lens(&shared, &j[i], &picture[i]);
        if (shard_is()) return status;
        if (status > worst) worst = status;
    }
    if (all.count) {
        table_line(shared.table, "\n%s", lens_each_line(&all));
        picture->others = picture + 1, picture->other_count = lenses - 1;
        picture->configurations = picture_words(&all);
    }
    table_end(shared.table);
    watch_end(shared.watch);
    pictures_write(&a.pictures, picture);
    return worst;
}

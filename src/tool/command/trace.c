/* trace.c - sagitta trace: rays through a lens. */
#include "commands.h"
#include "watch.h"
#include "watched.h"
#include "../show/frame.h"
#include "../base/input.h"
#include "../job/job.h"
#include "../base/memory.h"
#include "../base/progress.h"
#include "../draw/pictures.h"
#include "../read/surface.h"
#include "../show/profile.h"
#include "../base/tiles.h"

#include <math.h>
#include <stdio.h>
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
    const char *watch;
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
     OPTION_TEXT, .to = offsetof(trace_arguments, watch)},
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
    "                     internal reflection; lost: it could not be decided\n"
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
    "            object: {distance, index or glass}, pupil: {semi_diameter, distance},\n"
    "            fields: [degrees], surfaces: [...]\n"
    "  surface:  type, radius or curvature, conic, coefficients, semi_diameter,\n"
    "            thickness (to the next vertex), index or glass (of the medium behind it),\n"
    "            mirror, stop, decenter and tilt: [x, y, z]; or origin and tilt in every surface\n";

const command command_trace = {
    .name = "trace", .usage = "LENS [options]", .brief = "rays through a lens file, surface by surface",
    .what = "Traces rays through a lens file.  Prints a row for each ray and each element it reached: "
            "what became of the ray there, the point, the direction behind it, and a bound on the "
            "error.",
    .often = "field fan grid rays wavelength picture last frame proof format output", .rays = "--fan 5",
    .examples = "  sagitta trace examples/lenses/ftheta.yaml --field 20 --fan 3\n"
                "  sagitta trace examples/lenses/cooke_triplet.yaml --fan 7 --picture triplet.svg\n",
    .docs = "docs/lens_file.md (every key of a lens file)", .all = trace_all,
    .group = {&trace_own, &trace_pictures, JOB_GROUPS,
              &trace_search, &options_solver, &options_in_threads, &options_rows},
    .run = trace_run,
};

static trace_arguments trace_arguments_of(const command *c, int argc, char *argv[])
{
    trace_arguments a = {.job = {.several = true, .parts = true}};
    command_read(c, &a, &a.job, &a.shared, argc, argv);
    a.job.lens = command_file(c, "lens file", argc, argv);
    pictures_check(&a.pictures);
    return a;
}

/* ------------------------------------------------------------------ tiles */

/* How many rays ended at an element, by fate. */
typedef struct losses {
    size_t clipped, tir, missed, lost[SGT_HIT - SGT_INVALID + 1]; /* lost: by status */
} losses;

static void count_loss(losses *l, sgt_fate fate, sgt_status status)
{
    if (fate == SGT_CLIPPED) l->clipped++;
    else if (fate == SGT_TIR) l->tir++;
    else if (fate == SGT_MISSED) l->missed++;
    else l->lost[(status < 0 ? (int)status : 0) - SGT_INVALID]++;
}

enum { RECORDS_MOST = 1 << 16 }; /* the most rays times elements in a tile */

/* One element as the rays of a tile met it. */
typedef struct records {
    sgt_status *status;
    int *evals;
    double *number[9];             /* p, direction, t, t_err, opl */
} records;

/* The room of a tile: its rays, what became of them, and its rows of the table. */
typedef struct trace_room {
    launch room[TILE_RAYS];
    const launch *launch;          /* [TILE_RAYS], in `room` or in a list */
    size_t there;                  /* so many are traced; the others are not there */
    double ray[6][TILE_RAYS];      /* o, d; after the trace, where it ended */
    sgt_fate fate[TILE_RAYS];
    int passed[TILE_RAYS];
    records *record;               /* [elements] */
    sgt_passages *passages;        /* [elements], for the library: point into record */
    sgt_passage *alone;            /* [elements], for a ray traced by itself to get lo and hi */
    table *rows;
} trace_room;

typedef struct trace_work {
    const trace_arguments *asked;
    const job *job;
    trace_room *room;
    table *table;
    scene *picture;                /* NULL: none */
    watch *watch;                  /* NULL: none */
    const job_lens *at;             /* the lens at the wavelength that is being traced */
    bool launches;                 /* there are the columns of launch_head */
    bool stretches;                /* there are columns lo and hi */
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

static trace_room trace_room_for(const trace_work *w, size_t rays)
{
    size_t count = w->job->lens.count;
    trace_room r = {.record = memory_take(count, sizeof *r.record),
                    .passages = memory_take(count, sizeof *r.passages), .rows = table_part(w->table)};
    if (w->stretches) r.alone = memory_take(count, sizeof *r.alone);
    sgt_status *status = memory_take(count, rays * sizeof *status);
    int *evals = memory_take(count, rays * sizeof *evals);
    double *number = memory_take(count, 9 * rays * sizeof *number);
    for (size_t i = 0; i < count; i++) {
        records *to = &r.record[i];
        double **n = to->number;
        to->status = status + i * rays, to->evals = evals + i * rays;
        for (size_t k = 0; k < 9; k++) n[k] = number + (9 * i + k) * rays;
        r.passages[i] = (sgt_passages){.hits = {.status = to->status, .evals = to->evals,
                                                .p = {n[0], n[1], n[2]}, .t = n[6], .t_err = n[7]},
                                       .direction = {n[3], n[4], n[5]}, .opl = n[8]};
    }
    return r;
}

static sgt_vec3 vector_at(double *const n[3], size_t i) { return (sgt_vec3){n[0][i], n[1][i], n[2][i]}; }

static void write_vector(table *t, sgt_vec3 v)
{
    table_number(t, v.x);
    table_number(t, v.y);
    table_number(t, v.z);
}

/* Traces a ray by itself, for the lo and hi that a batch does not give.  Returns the hit where it ended. */
static const sgt_hit *ended(const trace_work *w, const launch *l, sgt_passage alone[], size_t element)
{
    sgt_ray ray = l->ray;
    sgt_trace(element + 1, w->at->element, w->at->lens.index_before, &ray, alone, NULL,
              &w->asked->shared.solver);
    return &alone[element].hit;
}

static void write_launch(const trace_work *w, table *t, const launch *l)
{
    bool beam = w->job->fields > 0;
    if (beam) table_count(t, (long long)w->job->field_number[l->field] + 1);
    else table_empty(t);
    if (isnan(w->at->lens.wavelength)) table_empty(t);
    else table_number(t, w->at->lens.wavelength);
    for (int k = 0; k < 2; k++)
        if (beam) table_number(t, k ? l->py : l->px);
        else table_empty(t);
}

static void trace_write_row(const trace_work *w, trace_room *own, const launch *l, size_t element,
                            sgt_fate fate, records *r, size_t i)
{
    /* NaN: the point of a miss, the direction of a ray that ended here */
    const sgt_vec3 nowhere = {(double)NAN, (double)NAN, (double)NAN};
    sgt_vec3 point = r->status[i] > 0 ? vector_at(r->number, i) : nowhere;
    sgt_vec3 direction = fate == SGT_PASSED ? vector_at(r->number + 3, i) : nowhere;
    const sgt_pose *pose = w->asked->global ? &w->at->element[element].pose : NULL;
    table *t = own->rows;
    table_count(t, (long long)l->number);
    table_count(t, (long long)element + 1);
    table_code(t, fate, sgt_fate_text(fate));
    table_code(t, r->status[i], sgt_status_text((sgt_status)r->status[i]));
    write_vector(t, pose ? frame_point_out(pose, point) : point);
    write_vector(t, pose ? frame_direction_out(pose, direction) : direction);
    table_number_within(t, r->number[6][i], r->number[7][i]);
    table_number(t, r->number[8][i]);
    table_count(t, r->evals[i]);
    if (w->launches) write_launch(w, t, l);
    if (w->job->rays.named) table_word(t, l->id);
    if (!w->stretches) return;
    const sgt_hit *hit = r->status[i] < 0 ? ended(w, l, own->alone, element) : NULL;
    table_number(t, hit ? hit->lo : (double)NAN);
    table_number(t, hit ? hit->hi : (double)NAN);
}

static void send(void *data, const tile *t)
{
    const trace_work *w = data;
    const job *j = w->job;
    trace_room *r = &w->room[t->place];
    const launch *l = r->launch = job_part(w->at, t->first, t->count, r->room, &r->there);
    for (size_t i = 0; i < r->there; i++) {
        const sgt_ray *ray = &l[i].ray;
        const double numbers[] = {ray->o.x, ray->o.y, ray->o.z, ray->d.x, ray->d.y, ray->d.z};
        for (int k = 0; k < 6; k++) r->ray[k][i] = numbers[k];
    }
    const sgt_rays rays = {.o = {r->ray[0], r->ray[1], r->ray[2]}, .d = {r->ray[3], r->ray[4], r->ray[5]}};
    const sgt_traced out = {.fate = r->fate, .passed = r->passed, .o = {r->ray[0], r->ray[1], r->ray[2]},
                            .d = {r->ray[3], r->ray[4], r->ray[5]}};
    sgt_trace_batch(j->lens.count, w->at->element, w->at->lens.index_before, r->there, rays, out, r->passages,
                    &w->asked->shared.solver);
    for (size_t i = 0; i < r->there; i++) {
        size_t passed = (size_t)r->passed[i];
        const size_t first = !w->asked->last ? 0 : r->fate[i] == SGT_PASSED ? passed - 1 : passed;
        if (!w->asked->last) table_gap(r->rows);
        for (size_t k = first; k < passed; k++) trace_write_row(w, r, &l[i], k, SGT_PASSED, &r->record[k], i);
        if (r->fate[i] != SGT_PASSED)
            trace_write_row(w, r, &l[i], passed, (sgt_fate)r->fate[i], &r->record[passed], i);
        if (r->fate[i] < 0) watch_trace(w->watch, t->place, w->at, &l[i], &w->asked->shared.solver);
    }
}

static void draw(trace_work *w, const trace_room *r, const launch *l, size_t i)
{
    sgt_fate fate = (sgt_fate)r->fate[i];
    size_t met = (size_t)r->passed[i] + (fate == SGT_CLIPPED || fate == SGT_TIR);
    w->point[0] = l->ray.o;
    for (size_t k = 0; k < met; k++)
        w->point[k + 1] = frame_point_out(&w->at->element[k].pose, vector_at(r->record[k].number, i));
    scene_add(w->picture, l->field, (size_t)(w->at - w->job->at), met + 1, w->point, fate,
              (sgt_vec3){r->ray[3][i], r->ray[4][i], r->ray[5][i]});
}

/* Was it a hit at every element?  A graze is not proven. */
static bool crossed_all(const trace_work *w, const trace_room *r, size_t i)
{
    for (size_t k = 0; k < w->job->lens.count; k++)
        if (r->record[k].status[i] != SGT_HIT) return false;
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
        from = frame_point_out(&before->pose, vector_at(r->record[element - 1].number, i));
        d = frame_direction_out(&before->pose, vector_at(r->record[element - 1].number + 3, i));
    }
    char why[WHY_SIZE];
    const sgt_arrival a = arrival_of(of, element, from, d, vector_at(r->record[element].number, i));
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
    table_join(w->table, r->rows);
    watch_take(w->watch, t->place);
    for (size_t i = 0; i < t->count && w->job->how; i++) launch_there(w->job->how, &r->launch[i]);
    w->rays += r->there;
    progress_add(t->count);
    for (size_t i = 0; i < r->there; i++) {
        int passed = r->passed[i];
        const launch *l = &r->launch[i];
        if (r->fate[i] == SGT_PASSED) w->passed++, w->proven += crossed_all(w, r, i);
        else count_loss(&w->loss[passed], (sgt_fate)r->fate[i], (sgt_status)r->record[passed].status[i]);
        if (r->fate[i] != SGT_PASSED) keep_ended(w, r, l, i);
        count_field(w, l, (size_t)passed);
        for (int k = 0; k < passed; k++) w->back[k] += r->record[k].number[6][i] < 0;
        if (r->fate[i] < 0) w->undecided++;
        if (r->fate[i] < 0 && r->record[passed].status[i] < 0 && w->shown < UNDECIDED_SHOWN)
            w->lost[w->shown].ray = *l, w->lost[w->shown++].at = w->at;
        if (w->picture) draw(w, r, l, i);
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
        for (int s = 0; s >= SGT_INVALID; s--)
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

/* ------------------------------------------------------------------ trace */

static exit_status trace_run(const command *c, int argc, char *argv[])
{
    trace_arguments a = trace_arguments_of(c, argc, argv);
    int threads = a.job.threads = options_threads(&a.shared);
    job j = job_read(&a.job);
    options_note_unread(&a.shared, j.lens.count, j.element);
    const size_t count = j.lens.count;
    const bool text = a.shared.target.format == TABLE_TEXT, all = !text || a.shared.target.columns;
    /* A tile takes some 60 KB for each element.  At most 16 MB a thread: with many elements tiles have fewer
     * rays. */
    tiling in = {.rays = job_count(j.at), .threads = count > RECORDS_MOST ? 1 : threads,
                       .share = count < 4     ? SHARE_MOST
                                : count < 128 ? 128 / count
                                              : 1,
                       .most = count > RECORDS_MOST               ? 1
                               : count > RECORDS_MOST / TILE_RAYS ? RECORDS_MOST / count
                                                                  : TILE_RAYS};
    watch_tiling(&in, a.watch, &a.shared.solver);
    const size_t places = tiles_places(&in);
    pictures_reserve(&a.pictures, a.shared.target.path, &j);
    scene picture = scene_begin(&j, pictures_plane(&a.pictures));
    trace_work w = {.asked = &a, .job = &j, .room = memory_take(places, sizeof *w.room),
                    .watch = watch_begin(a.watch, a.shared.target.hexadecimal, places, count),
                    .picture = a.pictures.file ? &picture : NULL, .launches = all || j.wavelengths > 1,
                    .stretches = all && a.shared.solver.proof,
                    .loss = memory_take(count, sizeof *w.loss), .back = memory_take(count, sizeof *w.back),
                    .field = memory_take(j.fields, sizeof *w.field),
                    .point = memory_take(count + 1, sizeof *w.point)};
    column columns[COLUMNS_MOST];
    a.shared.target.word_size = j.rays.longest_id;
    w.table = table_begin(&a.shared.target, trace_columns_of(&w, columns), columns);
    for (size_t i = 0; i < places; i++) w.room[i] = trace_room_for(&w, in.most);
    progress_begin(j.wavelengths * job_count(j.at), !a.shared.target.path, a.shared.progress);
    for (size_t k = 0; k < j.wavelengths; k++) {
        w.at = &j.at[k];
        in.rays = job_count(w.at);
        tiles_run(&in, &w, send, trace_take);
    }
    progress_end();
    job_end_parts(&j);
    if (text) {
        if (w.rays) write_legend(&w);
        table_line(w.table, "%zu of %zu ray%s passed all %zu element%s.", w.passed, w.rays,
                   w.rays == 1 ? "" : "s", count, count == 1 ? "" : "s");
        write_proof(&w);
        write_losses(w.table, &j, w.loss);
        write_ended(&w);
        write_doubts(&w);
        write_lost(&w);
    }
    table_end(w.table);
    watch_end(w.watch);
    pictures_write(&a.pictures, &picture);
    return w.undecided || j.undecided ? EXIT_UNDECIDED : EXIT_DECIDED;
}

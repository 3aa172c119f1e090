/* intersect.c - sagitta intersect: one surface, many rays. */
#include "commands.h"
#include "explain.h"
#include "memory.h"
#include "options.h"
#include "rays.h"
#include "surface.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "sagitta intersect --surface SPEC [--rays FILE] [--ray \"ox oy oz dx dy dz\"] [options]\n"
    "\n"
    "Where do rays meet a surface?  One row a ray: its number, the number of the root, the\n"
    "status, t (in lengths of the direction) and a bound on its error, the point, the\n"
    "gradient of F there (not normalised), and the evaluations spent.  root is -1 where\n"
    "there is none.  With --all: one row a root, counted from 0 along the ray.\n"
    "\n"
    "  --surface SPEC     YAML: '{type: conic, radius: -2.2136, conic: -0.6, semi_diameter: 2}'\n"
    "                     or '{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 8}';\n"
    "                     docs/lens_file.md has every type and its keys\n"
    "  --rays FILE        csv with a header: ox,oy,oz,dx,dy,dz and optionally tmin,tmax,id;\n"
    "                     - for standard input.  ray counts the data rows from 0\n"
    "  --ray \"...\"        a ray as six numbers, or eight with tmin tmax; may be repeated\n"
    "  --skip-bad         leave bad rows out, and say how many\n"
    "  --all              every root, and every stretch of the ray that could not be decided:\n"
    "                     its t and t_err are its middle and half its length\n"
    "  --pick P           first (the default): the smallest t that counts; near-seed, of\n"
    "                     a sag: the one the crossing of the vertex plane leads to\n";

static const column head[] = {
    {"ray", COLUMN_COUNT}, {"root", COLUMN_COUNT}, {"status", COLUMN_WORD},
    {"t", COLUMN_NUMBER}, {"t_err", COLUMN_ERROR},
    {"x", COLUMN_NUMBER}, {"y", COLUMN_NUMBER}, {"z", COLUMN_NUMBER},
    {"nx", COLUMN_NUMBER}, {"ny", COLUMN_NUMBER}, {"nz", COLUMN_NUMBER},
    {"evals", COLUMN_COUNT}, {"id", COLUMN_WORD},
};
enum { HEAD_COUNT = sizeof head / sizeof head[0] };

typedef struct arguments {
    shared_options shared;
    const char *surface;
    ray_list rays;
    bool all;
} arguments;

static arguments arguments_of(int argc, char *argv[])
{
    enum { SURFACE = OPTION_OWN, RAYS, RAY, SKIP_BAD, ALL, PROOF };
    static const struct option known[] = {
        {"surface", required_argument, NULL, SURFACE}, {"rays", required_argument, NULL, RAYS},
        {"ray", required_argument, NULL, RAY}, {"skip-bad", no_argument, NULL, SKIP_BAD},
        {"all", no_argument, NULL, ALL}, {"proof", required_argument, NULL, PROOF},
        SHARED_OPTIONS, {0},
    };
    arguments a = {.surface = NULL};
    const char *file = NULL;
    bool skip_bad = false;
    for (int code; (code = getopt_long(argc, argv, "h", known, NULL)) != -1;) {
        switch (code) {
        case SURFACE: a.surface = optarg; break;
        case RAYS: file = optarg; break;
        case RAY: rays_parse(&a.rays, optarg); break;
        case SKIP_BAD: skip_bad = true; break;
        case ALL: a.all = true; break;
        case PROOF: fail_usage("--proof: this version gives no proofs");
        default: options_take(&a.shared, code, help);
        }
    }
    if (optind < argc) fail_usage("what is \"%s\"?  The surface goes with --surface, rays with --rays", argv[optind]);
    if (!a.surface) fail_usage("--surface is missing");
    if (a.all && a.shared.solver.pick) fail_usage("--pick or --all, not both");
    if (!file == !a.rays.count) fail_usage("%s", file ? "--rays or --ray, not both" : "--rays or --ray is missing");
    if (file) rays_read(&a.rays, file, skip_bad);
    return a;
}

/* ------------------------------------------------------------------ roots */

/* The answers for one ray, in order; the room grows to what the richest ray needs. */
typedef struct answers {
    sgt_hit *hit;
    int count, capacity;
} answers;

static void find(answers *a, const arguments *asked, sgt_surface surface, const sgt_ray *ray)
{
    const sgt_options *opt = &asked->shared.solver;
    a->count = 0;
    while (asked->all && (a->count = sgt_intersect_all(surface, *ray, a->capacity, a->hit, opt)) > a->capacity) {
        a->capacity = a->count;
        a->hit = memory_grow(a->hit, (size_t)a->capacity, sizeof *a->hit);
    }
    if (a->count > 0) return;
    a->hit[0] = sgt_intersect(surface, *ray, opt); /* of all, none: the search for one says what that took */
    a->count = 1;
}

/* ------------------------------------------------------------------- rows */

/* A miss, and a ray that is none, have no root; an undecided stretch is numbered as one. */
static void write_row(table *t, const launch *l, int root, const sgt_hit *h, bool named)
{
    bool none = h->status == SGT_MISS || h->status == SGT_INVALID;
    bool met = h->status > 0;
    const double no = (double)NAN;
    const double numbers[] = {met ? h->p.x : no, met ? h->p.y : no, met ? h->p.z : no,
                              met ? h->n.x : no, met ? h->n.y : no, met ? h->n.z : no};
    table_count(t, (long long)l->number);
    table_count(t, none ? -1 : root);
    table_word(t, sgt_status_text(h->status));
    table_number_within(t, h->t, h->t_err);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) table_number(t, numbers[i]);
    table_count(t, h->evals);
    if (named) table_word(t, l->id);
}

/* "5 rays: 3 hit, 2 miss.  Every answer is certain." */
static void write_verdict(table *t, const arguments *a, sgt_surface surface, const size_t count[])
{
    char text[300], rows[60] = "";
    size_t length = 0, all = 0, undecided = 0, rays = a->rays.count;
    for (int s = SGT_GRAZE; s >= SGT_INVALID; s--) {
        size_t n = count[s - SGT_INVALID];
        if (n == 0) continue;
        all += n;
        if (s < 0) undecided += n;
        length += (size_t)snprintf(text + length, sizeof text - length, "%s %zu %s", length ? "," : "", n,
                                   sgt_status_text((sgt_status)s));
    }
    text[length] = 0;
    if (a->all) snprintf(rows, sizeof rows, ", %zu row%s", all, all == 1 ? "" : "s");
    bool fast = options_fast(&a->shared, surface);
    const char *end = !undecided && !fast ? "  Every answer is certain."
                    : undecided && !a->all ? "  For the undecided, sagitta diagnose says why." : "";
    table_line(t, "%zu ray%s%s:%s.%s", rays, rays == 1 ? "" : "s", rows, rays ? text : " nothing to decide", end);
    if (undecided && a->all) {
        table_line(t, "Of an undecided row t +- t_err is the stretch that may hold roots, or none; sagitta diagnose,");
        table_line(t, "with its ends as tmin and tmax, says why.");
    }
    if (fast) table_line(t, "%s", explain_fast);
}

exit_status command_intersect(int argc, char *argv[])
{
    arguments a = arguments_of(argc, argv);
    sgt_surface surface = surface_parse("--surface", a.surface);
    options_note_unread(&a.shared, 1, &(sgt_element){.surface = surface});
    table *t = table_begin(&a.shared.target, a.rays.named ? HEAD_COUNT : HEAD_COUNT - 1, head);
    size_t count[SGT_GRAZE - SGT_INVALID + 1] = {0}, undecided = 0;
    const launch *missed = NULL; /* the first that did */
    answers found = {.hit = memory_take(1, sizeof *found.hit), .capacity = 1};
    for (size_t i = 0; i < a.rays.count; i++) {
        const launch *l = &a.rays.ray[i];
        find(&found, &a, surface, &l->ray);
        if (a.all && i > 0) table_gap(t);
        for (int root = 0; root < found.count; root++) {
            sgt_status status = found.hit[root].status;
            write_row(t, l, root, &found.hit[root], a.rays.named);
            count[status - SGT_INVALID]++;
            if (status < 0) undecided++;
            if (status == SGT_MISS && !missed) missed = l;
        }
    }
    if (missed && a.shared.target.format == TABLE_TEXT) explain_miss(t, missed->number, surface, &missed->ray);
    write_verdict(t, &a, surface, count);
    table_end(t);
    return undecided ? EXIT_UNDECIDED : EXIT_DECIDED;
}

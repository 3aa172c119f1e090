/* intersect.c - sagitta intersect: one surface, many rays. */
#include "commands.h"
#include "explain.h"
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
    "there is none.\n"
    "\n"
    "  --surface SPEC     YAML: '{type: conic, radius: -2.2136, conic: -0.6, semi_diameter: 2}'\n"
    "  --rays FILE        csv with a header: ox,oy,oz,dx,dy,dz and optionally tmin,tmax,id;\n"
    "                     - for standard input.  ray counts the data rows from 0\n"
    "  --ray \"...\"        a ray as six numbers, or eight with tmin tmax; may be repeated\n"
    "  --skip-bad         leave bad rows out, and say how many\n"
    "  --pick P           first (the default): the smallest t that counts; near-seed: the\n"
    "                     one the crossing of the vertex plane leads to\n";

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
        case ALL: fail_usage("--all: this version finds one root of a ray, not all");
        case PROOF: fail_usage("--proof: this version gives no proofs");
        default: options_take(&a.shared, code, help);
        }
    }
    if (optind < argc) fail_usage("what is \"%s\"?  The surface goes with --surface, rays with --rays", argv[optind]);
    if (!a.surface) fail_usage("--surface is missing");
    if (!file == !a.rays.count) fail_usage("%s", file ? "--rays or --ray, not both" : "--rays or --ray is missing");
    if (file) rays_read(&a.rays, file, skip_bad);
    return a;
}

/* A miss, and a ray that is none, have no root; an undecided stretch is numbered as one. */
static void write_row(table *t, const launch *l, const sgt_hit *h, bool named)
{
    bool none = h->status == SGT_MISS || h->status == SGT_INVALID;
    bool met = h->status > 0;
    const double no = (double)NAN;
    const double numbers[] = {met ? h->p.x : no, met ? h->p.y : no, met ? h->p.z : no,
                              met ? h->n.x : no, met ? h->n.y : no, met ? h->n.z : no};
    table_count(t, (long long)l->number);
    table_count(t, none ? -1 : 0);
    table_word(t, sgt_status_text(h->status));
    table_number_within(t, h->t, h->t_err);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) table_number(t, numbers[i]);
    table_count(t, h->evals);
    if (named) table_word(t, l->id);
}

/* "5 rays: 3 hit, 2 miss.  Every ray is decided." */
static void write_verdict(table *t, size_t rays, const size_t count[])
{
    char text[300];
    size_t length = 0, undecided = 0;
    for (int s = SGT_GRAZE; s >= SGT_INVALID; s--) {
        size_t n = count[s - SGT_INVALID];
        if (n == 0) continue;
        if (s < 0) undecided += n;
        length += (size_t)snprintf(text + length, sizeof text - length, "%s %zu %s", length ? "," : "", n,
                                   sgt_status_text((sgt_status)s));
    }
    text[length] = 0;
    table_line(t, "%zu ray%s:%s.  %s", rays, rays == 1 ? "" : "s", rays ? text : " nothing to decide",
               undecided ? "For the undecided, sagitta diagnose says why." : "Every answer is certain.");
}

exit_status command_intersect(int argc, char *argv[])
{
    arguments a = arguments_of(argc, argv);
    sgt_surface surface = surface_parse("--surface", a.surface);
    table *t = table_begin(&a.shared.target, a.rays.named ? HEAD_COUNT : HEAD_COUNT - 1, head);
    size_t count[SGT_GRAZE - SGT_INVALID + 1] = {0}, undecided = 0;
    const launch *missed = NULL; /* the first that did */
    for (size_t i = 0; i < a.rays.count; i++) {
        sgt_hit h = sgt_intersect(surface, a.rays.ray[i].ray, &a.shared.solver);
        write_row(t, &a.rays.ray[i], &h, a.rays.named);
        count[h.status - SGT_INVALID]++;
        if (h.status < 0) undecided++;
        if (h.status == SGT_MISS && !missed) missed = &a.rays.ray[i];
    }
    if (missed && a.shared.target.format == TABLE_TEXT) explain_miss(t, missed->number, surface, &missed->ray);
    write_verdict(t, a.rays.count, count);
    table_end(t);
    return undecided ? EXIT_UNDECIDED : EXIT_DECIDED;
}

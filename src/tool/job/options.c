/* options.c - the options that several subcommands share. */
#include "options.h"

#include "../../text/number.h"
#include "../base/tiles.h"
#include "../read/lens.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char options_help[] =
    "  --t-tol X          stop when the error of t is below X (lengths of the direction).\n"
    "                     0 (the default): go on to the limit of rounding\n"
    "  --dt-min X         only for level sets (julia, mandelbrot): go along the ray in steps of X\n"
    "                     (lengths of the direction) or more.  Faster, but it proves nothing, and\n"
    "                     thin parts may be skipped\n"
    "  --max-evals N      give up on a root after N evaluations of F (default 2000)\n"
    "  --format F         text (for people, the default), csv or json\n"
    "  --hex              numbers in hexadecimal\n"
    "  --output FILE      write to FILE instead of standard output\n"
    "  -q, --quiet        print no remarks on how a lens file was read\n"
    "  --help, --version\n"
    "\n"
    "Exit status\n"
    "  0  every ray is decided (a miss is a decision)\n"
    "  1  some ray is undecided\n"
    "  2  wrong arguments\n"
    "  3  bad input, or output that cannot be written\n";

enum { THREADS_MOST = 1024 };

const char options_threads_help[] =
    "  --threads N        work in N threads; the output does not depend on N.  Default: what\n"
    "                     OMP_NUM_THREADS says, else one for each processor\n";

const char options_rows_help[] =
    "  --columns A,B,...  only these columns, in this order\n"
    "  --format npy       with --output NAME.npy one array of rows for NumPy; with --output FOLDER an\n"
    "                     array for each column.  docs/lens_file.md has types and codes\n"
    "  --progress         say on standard error how far it is; without this only on a terminal\n";

double options_number(const char *option, const char *text)
{
    double x;
    if (!number_read(text, &x) || !isfinite(x))
        fail_usage("--%s must be a finite number, not \"%s\"", option, text);
    return x;
}

long options_integer(const char *option, const char *text, long lowest, long highest)
{
    long n;
    if (!number_read_integer(text, lowest, highest, &n))
        fail_usage("--%s must be a whole number from %ld to %ld, not \"%s\"", option, lowest, highest, text);
    return n;
}

static double length_of(const char *option)
{
    double x = options_number(option, optarg);
    if (x < 0) fail_usage("--%s must not be negative, but is %s", option, optarg);
    return x;
}

static table_format format_of(const char *text, bool scales)
{
    if (strcmp(text, "text") == 0) return TABLE_TEXT;
    if (strcmp(text, "csv") == 0) return TABLE_CSV;
    if (strcmp(text, "json") == 0) return TABLE_JSON;
    if (scales && strcmp(text, "npy") == 0) return TABLE_NPY;
    fail_usage("--format must be text, csv%s json%s, not \"%s\"", scales ? "," : " or",
               scales ? " or npy" : "", text);
}

static sgt_pick pick_of(const char *text)
{
    if (strcmp(text, "first") == 0) return SGT_FIRST;
    if (strcmp(text, "near-seed") == 0) return SGT_NEAR_SEED;
    fail_usage("--pick must be first or near-seed, not \"%s\"", text);
}

static sgt_proof proof_of(const char *text)
{
    if (strcmp(text, "estimate") == 0) return SGT_ESTIMATE;
    if (strcmp(text, "root") == 0) return SGT_PROVE_ROOT;
    if (strcmp(text, "first") == 0) return SGT_PROVE_FIRST;
    fail_usage("--proof must be estimate, root or first, not \"%s\"", text);
}

void options_note_unread(const shared_options *o, size_t count, const sgt_element element[])
{
    bool set = false, other = false;
    for (size_t i = 0; i < count; i++) {
        set = set || surface_is_level_set(element[i].surface);
        other = other || !surface_is_level_set(element[i].surface);
    }
    if (o->solver.dt_min > 0 && set && o->solver.proof)
        fail_usage("give --proof or --dt-min, not both: the steps of --dt-min prove nothing");
    if (o->solver.dt_min > 0 && !set) note("--dt-min: not used; it is for level sets (julia, mandelbrot)");
    if (o->solver.pick == SGT_NEAR_SEED && !other)
        note("--pick near-seed: not used; on a level set the first root is taken");
}

bool options_near_seed(const shared_options *o, sgt_surface s, sgt_pick by_default)
{
    return (o->solver.pick ? o->solver.pick : by_default) == SGT_NEAR_SEED && !surface_is_level_set(s);
}

int options_threads(const shared_options *o)
{
    int most = tiles_threads();
    if (o->threads == 0) return most;
#ifndef _OPENMP
    if (o->threads > 1)
        note("--threads %d: not used; this command is built without OpenMP and works in one thread",
             o->threads);
    return 1;
#else
    return o->threads;
#endif
}

void options_version(void)
{
    print_and_end("sagitta %s\n", sgt_version());
}

void options_take(shared_options *o, int code, const char *help)
{
    switch (code) {
    case OPTION_FORMAT: o->target.format = format_of(optarg, o->scales); return;
    case OPTION_COLUMNS: o->target.columns = optarg; return;
    case OPTION_PROGRESS: o->progress = true; return;
    case 'o':
    case OPTION_OUTPUT: o->target.path = optarg; return;
    case OPTION_HEX: o->target.hexadecimal = true; return;
    case OPTION_PICK: o->solver.pick = pick_of(optarg); return;
    case OPTION_PROOF: o->solver.proof = proof_of(optarg); return;
    case OPTION_MAX_EVALS:
        o->solver.max_evals = (int)options_integer("max-evals", optarg, 1, INT_MAX);
        return;
    case OPTION_T_TOL: o->solver.t_tol = length_of("t-tol"); return;
    case OPTION_THREADS: o->threads = (int)options_integer("threads", optarg, 1, THREADS_MOST); return;
    case OPTION_DT_MIN: o->solver.dt_min = length_of("dt-min"); return;
    case 'q':
    case OPTION_QUIET: lens_be_quiet(); return;
    case OPTION_VERSION: options_version();
    case 'h':
    case OPTION_HELP: print_and_end("%s%s", help, options_help);
    default: fail_hint();
    }
}

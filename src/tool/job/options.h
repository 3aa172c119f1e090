/* options.h - the options that several subcommands share. */
#ifndef TOOL_OPTIONS_H
#define TOOL_OPTIONS_H
#include "../read/surface.h"
#include "../show/table.h"

#include <getopt.h>
#include <sagitta/system.h>

typedef struct shared_options {
    table_target target;
    sgt_options solver;
    int threads;          /* 0: not given */
    bool scales;          /* set by a command with ROWS_OPTIONS */
    bool progress;
} shared_options;

/* Room for the --help of a subcommand with those of its parts. */
enum { HELP_SIZE = 12000 };

/* Codes for getopt_long.  Those of a subcommand begin with OPTION_OWN. */
enum {
    OPTION_FORMAT = 256, OPTION_OUTPUT, OPTION_HEX, OPTION_HELP, OPTION_VERSION,
    OPTION_PICK, OPTION_T_TOL, OPTION_DT_MIN, OPTION_MAX_EVALS, OPTION_THREADS, OPTION_PROOF,
    OPTION_COLUMNS, OPTION_PROGRESS, OPTION_QUIET, OPTION_OWN
};

/* To be put into a subcommand's table of options, which ends with {0}. */
#define SHARED_OPTIONS                                          \
    {"format", required_argument, NULL, OPTION_FORMAT},         \
    {"output", required_argument, NULL, OPTION_OUTPUT},         \
    {"hex", no_argument, NULL, OPTION_HEX},                     \
    {"help", no_argument, NULL, OPTION_HELP},                   \
    {"quiet", no_argument, NULL, OPTION_QUIET},                 \
    {"version", no_argument, NULL, OPTION_VERSION},             \
    {"pick", required_argument, NULL, OPTION_PICK},             \
    {"t-tol", required_argument, NULL, OPTION_T_TOL},           \
    {"dt-min", required_argument, NULL, OPTION_DT_MIN},         \
    {"max-evals", required_argument, NULL, OPTION_MAX_EVALS}

/* For subcommands that work in threads. */
#define THREADS_OPTION {"threads", required_argument, NULL, OPTION_THREADS}

/* For subcommands that prove. */
#define PROOF_OPTION {"proof", required_argument, NULL, OPTION_PROOF}

/* For subcommands that write a row for each ray: --columns, --progress, --format npy and -o. */
#define ROWS_OPTIONS                                    \
    {"columns", required_argument, NULL, OPTION_COLUMNS}, \
    {"progress", no_argument, NULL, OPTION_PROGRESS}
#define ROWS_LETTERS "hqo:"

/* The help of the shared options, that of --threads, and that of ROWS_OPTIONS. */
extern const char options_help[], options_threads_help[], options_rows_help[];

/* Takes an option with one of the shared codes.  Any other code is an unknown option: getopt has printed a
 * message, and this ends with a usage error.  --help and --version end the command here. */
void options_take(shared_options *o, int code, const char *help);

_Noreturn void options_version(void);

/* Is this surface searched in the fast way of --dt-min?  Its answers then claim less. */
static inline bool options_fast(const shared_options *o, sgt_surface s)
{
    return o->solver.dt_min > 0 && surface_is_level_set(s);
}

/* Is the root near the seed asked for?  by_default: the pick without --pick.  Never on a level set, which has
 * no seed. */
bool options_near_seed(const shared_options *o, sgt_surface s, sgt_pick by_default);

/* How many threads to work in.  Notes on standard error if --threads cannot be used. */
int options_threads(const shared_options *o);

/* Notes on standard error if --dt-min or --pick was given and no element uses it.  Ends with a usage error if
 * --dt-min and --proof are given for the same element. */
void options_note_unread(const shared_options *o, size_t count, const sgt_element element[]);

/* Read the value of an option; a bad one ends with a usage error. */
double options_number(const char *option, const char *text);
long options_integer(const char *option, const char *text, long lowest, long highest);

#endif

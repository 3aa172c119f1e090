/* options.h - the options that several subcommands share. */
#ifndef TOOL_OPTIONS_H
#define TOOL_OPTIONS_H
#include "../show/table.h"

#include <getopt.h>
#include <sagitta/system.h>

typedef struct shared_options {
    table_target target;
    sgt_options solver;
    int threads;          /* 0: not given */
} shared_options;

/* Room for the --help of a subcommand with those of its parts. */
enum { HELP_SIZE = 12000 };

/* Codes for getopt_long; a subcommand's own begin with OPTION_OWN. */
enum {
    OPTION_FORMAT = 256, OPTION_OUTPUT, OPTION_HEX, OPTION_HELP, OPTION_VERSION,
    OPTION_PICK, OPTION_T_TOL, OPTION_DT_MIN, OPTION_MAX_EVALS, OPTION_THREADS, OPTION_PROOF, OPTION_OWN
};

/* For the subcommand's own table of options, which ends with {0}. */
#define SHARED_OPTIONS                                          \
    {"format", required_argument, NULL, OPTION_FORMAT},         \
    {"output", required_argument, NULL, OPTION_OUTPUT},         \
    {"hex", no_argument, NULL, OPTION_HEX},                     \
    {"help", no_argument, NULL, OPTION_HELP},                   \
    {"version", no_argument, NULL, OPTION_VERSION},             \
    {"pick", required_argument, NULL, OPTION_PICK},             \
    {"t-tol", required_argument, NULL, OPTION_T_TOL},           \
    {"dt-min", required_argument, NULL, OPTION_DT_MIN},         \
    {"max-evals", required_argument, NULL, OPTION_MAX_EVALS}

/* For those that work in threads, besides. */
#define THREADS_OPTION {"threads", required_argument, NULL, OPTION_THREADS}

/* For those that prove. */
#define PROOF_OPTION {"proof", required_argument, NULL, OPTION_PROOF}

/* Their paragraph of a --help, and its line. */
extern const char options_help[], options_threads_help[];

/* Takes a code of getopt_long that is one of the shared; any other (an unknown option,
 * of which getopt has told the user) is a usage error.  --help and --version end here. */
void options_take(shared_options *o, int code, const char *help);

_Noreturn void options_version(void);

/* Is a surface searched in the fast way that --dt-min asks for?  Its answers claim less. */
static inline bool options_fast(const shared_options *o, sgt_surface s)
{
    return o->solver.dt_min > 0 && s.ops->estimate;
}

/* Is the root near the seed the one that is asked for?  by_default: where --pick was not given.  A level
 * set has none. */
bool options_near_seed(const shared_options *o, sgt_surface s, sgt_pick by_default);

/* How many threads to work in.  A word on standard error if more are asked for than can be. */
int options_threads(const shared_options *o);

/* A word on standard error if --dt-min or --pick was given and none of these reads it; a usage error
 * if --dt-min is to make fast what --proof is to prove. */
void options_note_unread(const shared_options *o, size_t count, const sgt_element element[]);

/* Values; what does not fit is a usage error. */
double options_number(const char *option, const char *text);
long options_integer(const char *option, const char *text, long lowest, long highest);

#endif

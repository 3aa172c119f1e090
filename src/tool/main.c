// SPDX-License-Identifier: MIT
/* main.c - which subcommand? */
#include "command/commands.h"
#include "base/ranks.h"
#include "base/shard.h"
#include "job/options.h"
#include "look/look.h"

#include <sagitta/sagitta.h>

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

static const command *const commands[] = {
    &command_intersect, &command_trace, &command_diagnose, &command_info, &command_spot, &command_fan,
    &command_opd, &command_field, &command_map, &command_sweep, &command_tolerance, &command_prove,
    &command_edit, &command_import, &command_trade, &command_join,
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

/* The commands from 0 on: behind those above, the analyses of the library that are none of them.  false:
 * there are no more. */
static bool command_at(size_t place, command *c)
{
    if (place < COMMANDS) return *c = *commands[place], true;
    for (size_t i = 0; sgt_analysis_at(i); i++) {
        const sgt_analysis *a = sgt_analysis_at(i);
        bool own = a->part_of != NULL;
        for (size_t k = 0; k < COMMANDS; k++) own = own || strcmp(a->name, commands[k]->name) == 0;
        if (!own && place-- == COMMANDS) return *c = look_command(a), true;
    }
    return false;
}

bool command_named(const char *name, command *c)
{
    for (size_t i = 0; command_at(i, c); i++)
        if (strcmp(name, c->name) == 0) return true;
    return false;
}

/* Is the word a command's name, but for one letter more, less or wrong, or for two that changed places? */
static bool like_command(const char *word, command *c)
{
    for (size_t i = 0; command_at(i, c); i++)
        if (fail_is_slip(word, c->name)) return true;
    return false;
}

/* What is asked for by another name, and the command line that does it; NULL: no such name is known. */
static const char *does_it(const char *word)
{
    static const struct { const char *words, *line; } other[] = {
        {"draw layout plot view show picture", "trace LENS --picture lens.svg"},
        {"convert open load", "import FILE -o LENS"},
        {"set change insert remove reverse scale", "edit LENS"},
        {"paraxial seidel aberrations first-order", "info LENS --seidel"},
        {"rayfan ray-fan", "fan LENS"},
        {"wavefront zernike opl", "opd LENS"},
        {"distortion astigmatism curvature", "field LENS"},
        {"vignetting", "illumination LENS"},
        {"montecarlo monte-carlo yield", "tolerance LENS --trials 1000"},
        {"verify certify proof", "prove LENS"},
        {"explain why debug", "diagnose LENS --ray 0"},
        {"raytrace ray-trace rays", "trace LENS"},
    };
    for (size_t i = 0; i < sizeof other / sizeof *other; i++) {
        const size_t length = strlen(word);
        for (const char *at = other[i].words; *at; at += strcspn(at, " "), at += *at == ' ')
            if (strcspn(at, " ") == length && strncmp(at, word, length) == 0) return other[i].line;
    }
    return NULL;
}

/* Can its rays be divided among machines? */
static bool is_divided(const command *c)
{
    for (size_t i = 0; i < COMMAND_GROUPS && c->group[i]; i++)
        if (c->group[i] == &options_shards) return true;
    return sgt_analysis_named(c->name) || c->run == command_sweep.run;
}

static void print_main_help(FILE *to)
{
    command c;
    fputs("sagitta: where does a ray meet a surface, and how sure is the answer?\n\n", to);
    for (size_t i = 0; command_at(i, &c); i++) fprintf(to, "  sagitta %-12s %s\n", c.name, c.brief);
    fputs("\n  sagitta COMMAND --help     a command in one screen; --help all: all of it\n"
          "                             --help options: its options as a table, for programs\n"
          "  sagitta --version\n"
          "\n"
          "For example:\n"
          "  sagitta intersect --surface '{type: sphere, radius: 20}' --ray '0 3 -5 0 0 1'\n"
          "  sagitta trace examples/lenses/ftheta.yaml --field 20 --fan 3\n"
          "  sagitta spot examples/lenses/cooke_triplet.yaml --picture spots.svg\n", to);
}

/* For programs, as parse.c prints the options of a command. */
static void print_table_of_commands(void)
{
    command c;
    for (size_t i = 0; command_at(i, &c); i++) printf("%s\t%s\n", c.name, c.brief);
}

/* If a standard file is closed at the start, the next file opened would take its number, and a message for
 * standard error would be written into it.  So open /dev/null in its place. */
static void hold_standard_files(void)
{
#ifdef F_GETFD /* not on Windows */
    for (int file = 0; file < 3; file++)
        /* opened the wrong way round: to use it is an error, as with a closed file */
        if (fcntl(file, F_GETFD) < 0 && open("/dev/null", file == 0 ? O_WRONLY : O_RDONLY) < 0) return;
#endif
}

/* A limit of the size of files is an error, as a full disk is, and ends the command as that does. */
static void outlive_limits(void)
{
#ifdef SIGXFSZ
    signal(SIGXFSZ, SIG_IGN);
#endif
}

/* A library that is loaded before the command may have been linked with -Ofast. */
static void require_arithmetic(void)
{
    int bad = sgt_arithmetic();
    if (bad)
        fail_input("the arithmetic of this process has been changed: %s.  No bound would hold.  A library "
                   "linked with -ffast-math or -Ofast and loaded into it (LD_PRELOAD, say) is the usual "
                   "cause",
                   sgt_arithmetic_text(bad));
}

int main(int argc, char *argv[])
{
    hold_standard_files();
    outlive_limits();
    ranks_begin(&argc, &argv);
    require_arithmetic();
    const char *name = argc > 1 ? argv[1] : "";
    command c;
    const bool known = command_named(name, &c);
    if (!known || !is_divided(&c)) ranks_alone();
    if (known) {
        char full[40]; /* in messages of getopt */
        snprintf(full, sizeof full, "sagitta %s", name);
        argv[1] = full;
        fail_name(c.name);
        const exit_status status = c.run(&c, argc - 1, argv + 1);
        shard_clear();
        return (int)status;
    }
    if (strcmp(name, "--version") == 0) command_version();
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        if (argc > 2 && strcmp(argv[2], "options") == 0) print_table_of_commands();
        else print_main_help(stdout);
        print_and_end("%s", "");
    }
    if (strchr(name, '.') || strchr(name, '/'))
        fail_usage("no such command: %s; a lens file comes behind a command: sagitta trace %s", name, name);
    if (*name && does_it(name))
        fail_usage("no such command: %s; it is: sagitta %s", name, does_it(name));
    if (*name && like_command(name, &c))
        fail_usage("no such command: %s; did you mean sagitta %s?", name, c.name);
    if (*name)
        fail_usage("no such command: %s; sagitta --help lists them", name);
    print_main_help(stderr);
    return EXIT_USAGE;
}

/* main.c - which subcommand? */
#include "command/commands.h"
#include "job/options.h"
#include "look/look.h"

#include <sagitta/sagitta.h>

#include <fcntl.h>
#include <stdio.h>
#include <string.h>

static const char main_help[] =
    "sagitta: where does a ray meet a surface, and how sure is the answer?\n"
    "\n"
    "  sagitta intersect --surface SPEC --rays FILE      one surface, many rays\n"
    "  sagitta trace LENS [--picture FILE]               rays through a lens file\n"
    "  sagitta diagnose --surface SPEC --ray \"...\"       one ray, evaluation by evaluation\n"
    "  sagitta info LENS                                 focal length, pupils, Seidel sums\n"
    "  sagitta spot LENS [--picture FILE]                spot diagrams: how rays scatter at the image\n"
    "  sagitta fan LENS [--picture FILE]                 transverse errors across the pupil\n"
    "  sagitta opd LENS [--picture FILE]                 optical path differences, Zernike polynomials\n"
    "  sagitta field LENS [--picture FILE]               field curvature, astigmatism, distortion\n"
    "  sagitta map LENS [--picture FILE]                 where rays are lost, over pupil or field\n"
    "  sagitta sweep LENS [--picture FILE]               what becomes of rays, against the field\n"
    "%s"
    "  sagitta import FILE [-o LENS]                     a .zmx file as a lens file\n"
    "  sagitta trade [LENS | --surface SPEC]             speed against accuracy, measured\n"
    "\n"
    "  sagitta COMMAND --help     the options and the columns of a command\n"
    "  sagitta --version\n"
    "\n"
    "For example:\n"
    "  sagitta intersect --surface '{type: sphere, radius: 20}' --ray '0 3 -5 0 0 1'\n"
    "  sagitta trace examples/lenses/ftheta.yaml --field 20 --fan 3\n";

static const struct { const char *name, *full; exit_status (*run)(int argc, char *argv[]); } commands[] = {
    {"intersect", "sagitta intersect", command_intersect},
    {"trace", "sagitta trace", command_trace},
    {"diagnose", "sagitta diagnose", command_diagnose},
    {"trade", "sagitta trade", command_trade},
    {"info", "sagitta info", command_info},
    {"import", "sagitta import", command_import},
    {"spot", "sagitta spot", command_spot},
    {"fan", "sagitta fan", command_fan},
    {"opd", "sagitta opd", command_opd},
    {"field", "sagitta field", command_field},
    {"map", "sagitta map", command_map},
    {"sweep", "sagitta sweep", command_sweep},
};

/* An analysis of the library that has no subcommand of its own: those have pictures that they draw. */
static const sgt_analysis *plain_analysis(size_t place)
{
    const sgt_analysis *a = sgt_analysis_at(place);
    for (size_t i = 0; a && i < sizeof commands / sizeof commands[0]; i++)
        if (a->part_of || strcmp(a->name, commands[i].name) == 0) return plain_analysis(place + 1);
    return a;
}

static exit_status run_plain(const sgt_analysis *a, int argc, char *argv[])
{
    static char full[60];
    static const look_way plain = {.draw = NULL};
    snprintf(full, sizeof full, "sagitta %s", a->name);
    argv[0] = full;
    fail_name(a->name);
    return look_run(a->name, &plain, argc, argv);
}

static const char *plain_help(void)
{
    static char text[2000];
    size_t n = 0;
    const sgt_analysis *before = NULL;
    for (size_t i = 0; plain_analysis(i) && n < sizeof text - 200; i++) {
        const sgt_analysis *a = plain_analysis(i);
        char head[60];
        if (a == before) continue;
        snprintf(head, sizeof head, "sagitta %s LENS [--picture FILE]", a->name);
        n += (size_t)snprintf(text + n, sizeof text - n, "  %-48s  %s\n", head, a->title);
        before = a;
    }
    return text;
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
    require_arithmetic();
    const char *name = argc > 1 ? argv[1] : "";
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        if (strcmp(name, commands[i].name) != 0) continue;
        char full[40];
        snprintf(full, sizeof full, "%s", commands[i].full);
        argv[1] = full;
        fail_name(commands[i].name);
        return (int)commands[i].run(argc - 1, argv + 1);
    }
    for (size_t i = 0; plain_analysis(i); i++)
        if (strcmp(name, plain_analysis(i)->name) == 0)
            return (int)run_plain(plain_analysis(i), argc - 1, argv + 1);
    if (strcmp(name, "--version") == 0) options_version();
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0)
        print_and_end(main_help, plain_help());
    if (*name)
        fail_usage("no such command: %s; sagitta --help lists them", name);
    fprintf(stderr, main_help, plain_help());
    return EXIT_USAGE;
}

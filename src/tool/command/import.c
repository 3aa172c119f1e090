/* import.c - sagitta import: a lens of another format, or of several manners, as a lens file. */
#include "commands.h"

#include "../base/input.h"
#include "../job/options.h"
#include "../read/lens.h"

#include <limits.h>

static const char import_help[] =
    "sagitta import FILE [options]\n"
    "\n"
    "Reads a lens and writes it as a lens file (YAML, docs/lens_file.md).  FILE is a .zmx file, or a\n"
    "lens file, which is written anew.  (All commands take a .zmx file as it is, too.)\n"
    "\n"
    "On standard error: what was turned into something else, and what was left out, one remark a\n"
    "line: FILE:LINE: KEY: taken as ..., or left out: ...  Nothing is left out in silence.  Notes of\n"
    "a .zmx file, and comments at the head of a lens file, become comments at the head of the YAML.\n"
    "\n"
    "Options\n"
    "  -o, --output LENS  write to LENS instead of standard output\n"
    "  --glass PATH       glasses of a catalogue (.agf, .yml, .csv) or a folder of them, before those\n"
    "                     that ship.  May be repeated.  If several makers have a name, the first of the\n"
    "                     lens's `makers` decides; else such a catalogue; else SCHOTT, OHARA, HOYA, CDGM,\n"
    "                     HIKARI, SUMITA\n"
    "  --configuration N  of a file with several configurations the N-th, counted from 1.  Default: the\n"
    "                     one in which it was saved\n"
    "  --strict           what is left out is an error, and nothing is written\n"
    "  -q, --quiet        print no remarks\n"
    "  --help, --version\n"
    "\n"
    "Exit status\n"
    "  0  the lens was written\n"
    "  2  wrong arguments\n"
    "  3  bad input, or output that cannot be written\n";

exit_status command_import(int argc, char *argv[])
{
    enum { GLASS = OPTION_OWN, CONFIGURATION, STRICT };
    static const struct option known[] = {
        {"output", required_argument, NULL, OPTION_OUTPUT}, {"glass", required_argument, NULL, GLASS},
        {"configuration", required_argument, NULL, CONFIGURATION}, {"strict", no_argument, NULL, STRICT},
        {"quiet", no_argument, NULL, OPTION_QUIET}, {"help", no_argument, NULL, OPTION_HELP},
        {"version", no_argument, NULL, OPTION_VERSION}, {0},
    };
    const char *output = NULL;
    for (int code; (code = getopt_long(argc, argv, "hqo:", known, NULL)) != -1;) {
        switch (code) {
        case 'o':
        case OPTION_OUTPUT: output = optarg; break;
        case GLASS: lens_glass_folder(optarg); break;
        case CONFIGURATION:
            lens_configuration((int)options_integer("configuration", optarg, 1, INT_MAX));
            break;
        case STRICT: lens_be_strict(); break;
        case 'q':
        case OPTION_QUIET: lens_be_quiet(); break;
        case OPTION_VERSION: options_version();
        case 'h':
        case OPTION_HELP: print_and_end("%s", import_help);
        default: fail_hint();
        }
    }
    if (optind == argc) fail_usage("the file is missing: sagitta import FILE");
    if (optind + 1 < argc) fail_usage("unexpected argument \"%s\"; import takes one file", argv[optind + 1]);
    sgt_lens *l = lens_open(argv[optind]);
    size_t length;
    const char *text = sgt_lens_yaml(l, &length);
    if (!text) fail_input("%s: could not be written as YAML", l->file);
    output_write(output, text, length);
    return EXIT_DECIDED;
}

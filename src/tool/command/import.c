// SPDX-License-Identifier: MIT
/* import.c - sagitta import: a lens of another format, or of several manners, as a lens file. */
#include "commands.h"

#include "../job/job.h"
#include "../read/lens.h"

static const option_row import_output_rows[] = {
    {"output", "LENS", "write to LENS instead of standard output; or -o", OPTION_TEXT,
     .to = offsetof(shared_options, target.path)},
    {0},
};
static const option_group import_output = {OPTIONS_SHARED, "Options", .row = import_output_rows};

static exit_status import_run(const command *c, int argc, char *argv[]);

const command command_import = {
    .name = "import", .usage = "FILE [-o LENS] [options]", .brief = "a .zmx or .seq file as a lens file",
    .what = "Reads a lens and writes it as a lens file (YAML, docs/lens_file.md).  FILE is a .zmx file, "
            "a sequence file of CODE V (.seq), or a lens file, which is written anew.  (All commands take "
            "such files as they are, too.)",
    .often = "output glass configuration strict quiet",
    .examples = "  sagitta import triplet.zmx -o triplet.yaml\n"
                "  sagitta import tests/data/seq/triplet.seq --configuration 1\n",
    .docs = "docs/import.md",
    .all = "On standard error: what was turned into something else, and what was left out, one remark a\n"
           "line: FILE:LINE: KEY: taken as ..., or left out: ...  Nothing is left out in silence.  Notes of\n"
           "a .zmx file, and comments at the head of a lens file, become comments at the head of the YAML.\n",
    .exits = "  0  the lens was written\n"
             "  2  wrong arguments\n"
             "  3  bad input, or output that cannot be written\n",
    .group = {&import_output, &job_glass_options}, .run = import_run,
};

static exit_status import_run(const command *c, int argc, char *argv[])
{
    shared_options shared = {.threads = 0};
    job_options asked = {.lens = NULL};
    command_read(c, NULL, &asked, &shared, argc, argv);
    lens_write_check("output", shared.target.path);
    lens_write(lens_open_whole(command_file(c, "file", argc, argv)), shared.target.path);
    return EXIT_DECIDED;
}

// SPDX-License-Identifier: MIT
/* edit.c - sagitta edit: a lens with other surfaces, turned or larger, as a lens file. */
#include "commands.h"

#include "../base/memory.h"
#include "../job/job.h"
#include "../read/lens.h"

#include <string.h>

static void take_insert(void *into, const option_row *row, const char *value)
{
    (void)into;
    lens_edit_value(SGT_EDIT_INSERT, row->name, value);
}

static void take_remove(void *into, const option_row *row, const char *value)
{
    (void)into, (void)row;
    lens_edit((sgt_edit){.kind = SGT_EDIT_REMOVE, .path = value});
}

/* FIRST,LAST, or one surface: their numbers or names. */
static void take_reverse(void *into, const option_row *row, const char *value)
{
    const char *comma = strchr(value, ',');
    (void)into, (void)row;
    const char *first = comma ? memory_text(value, (size_t)(comma - value)) : value;
    lens_edit((sgt_edit){.kind = SGT_EDIT_REVERSE,
                         .path = memory_print("surfaces[%s]", first),
                         .text = memory_print("surfaces[%s]", comma ? comma + 1 : value)});
}

static void take_scale(void *into, const option_row *row, const char *value)
{
    (void)into;
    lens_edit((sgt_edit){.kind = SGT_EDIT_SCALE, .number = options_number(row->name, value)});
}

static const option_row edit_rows[] = {
    {"insert", "PATH=VALUE",
     "in front of what has the place: 'surfaces[3]={type: plane, glass: air}'\n"
     "PATH is a place in a list; the place behind the last one is the end.  VALUE is YAML",
     OPTION_TAKE, .take = take_insert},
    {"remove", "PATH", "an entry of a list, or a key: surfaces[3], fields[2], surfaces[1].conic", OPTION_TAKE,
     .take = take_remove},
    {"reverse", "FIRST,LAST",
     "surfaces turned front to back: 3,6, or by name\n"
     "What stands in front of them and behind them stays",
     OPTION_TAKE, .take = take_reverse},
    {"scale", "FACTOR", "all lengths of the lens times FACTOR; wavelengths stay", OPTION_TAKE,
     .take = take_scale},
    {0},
};
static const option_row edit_output_rows[] = {
    {"output", "LENS", "write to LENS instead of standard output; or -o", OPTION_TEXT,
     .to = offsetof(shared_options, target.path)},
    {0},
};
static const option_group edit_own = {OPTIONS_OWN, "Edits, made in the order in which they are given",
                                      .row = edit_rows},
                          edit_output = {OPTIONS_SHARED, NULL, .row = edit_output_rows};

static exit_status edit_run(const command *c, int argc, char *argv[]);

const command command_edit = {
    .name = "edit",
    .usage = "LENS [-o NEW] [options]",
    .brief = "a lens with other surfaces, as a lens file",
    .what = "Changes a lens and writes it as a lens file (YAML, docs/lens_file.md).  LENS is a lens file or "
            "a .zmx or .seq file; it stays as it is.",
    .often = "set insert remove reverse scale output glass quiet",
    .examples = "  sagitta edit triplet.zmx --set surfaces[3].radius=-21 -o other.yaml\n"
                "  sagitta edit examples/lenses/cooke_triplet.yaml --reverse 1,6 --scale 0.5\n",
    .docs = "docs/lens_file.md#edits",
    .all = "Each edit counts surfaces as the one before it has left them.  Then the lens is read, so that\n"
           "all checks of the reader hold.\n",
    .exits = "  0  the lens was written\n"
             "  2  wrong arguments\n"
             "  3  bad input, an edit that cannot be made, or output that cannot be written\n",
    .group = {&edit_own, &job_glass_options, &edit_output},
    .run = edit_run,
};

static exit_status edit_run(const command *c, int argc, char *argv[])
{
    shared_options shared = {.threads = 0};
    job_options asked = {.lens = NULL};
    command_read(c, NULL, &asked, &shared, argc, argv);
    lens_write_check("output", shared.target.path);
    lens_write(lens_open_whole(command_file(c, "file", argc, argv)), shared.target.path);
    return EXIT_DECIDED;
}

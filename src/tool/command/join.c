// SPDX-License-Identifier: MIT
/* join.c - sagitta join: the parts of all shards, made into what one run writes.
 *
 * It runs the command of the parts again, which has from them what they have computed (base/shard.h). */
#include "commands.h"
#include "../base/memory.h"
#include "../job/options.h"

#include <stdio.h>
#include <string.h>

typedef struct join_arguments {
    const char *output, *threads;
    bool progress;
} join_arguments;

static const option_row join_rows[] = {
    {"output", "FILE", "write to FILE instead of standard output; or -o", OPTION_TEXT,
     .to = offsetof(join_arguments, output)},
    {"threads", "N", "work in N threads; the output does not depend on N", OPTION_TEXT,
     .to = offsetof(join_arguments, threads)},
    {"progress", NULL, "say on standard error how far it is; without this only on a terminal", OPTION_FLAG,
     .to = offsetof(join_arguments, progress)},
    {0},
};
static const option_group join_own = {OPTIONS_OWN, "Options", .row = join_rows};

static exit_status join_run(const command *c, int argc, char *argv[])
{
    join_arguments a = {.output = NULL};
    command of;
    command_read(c, &a, NULL, NULL, argc, argv);
    if (optind == argc) fail_usage("no parts; give all parts of a run: sagitta join PART...");
    shard_join(argc - optind, argv + optind);
    const part_of_run *run = shard_joined();
    char **again = memory_take(run->length + 8, sizeof *again);
    char *all = memory_text(run->arguments, run->length);
    if (!command_named(all, &of)) fail_input("%s: a part of an unknown command: %s", argv[optind], all);
    int n = 0;
    again[n++] = memory_print("sagitta %s", of.name);
    if (a.output) again[n++] = memory_print("--output=%s", a.output);
    if (a.threads) again[n++] = memory_print("--threads=%s", a.threads);
    if (a.progress) again[n++] = memory_print("--progress");
    for (char *at = all + strlen(all) + 1; at < all + run->length; at += strlen(at) + 1) again[n++] = at;
    optind = 0; /* getopt begins anew */
    fail_name(of.name);
    return of.run(&of, n, again);
}

const command command_join = {
    .name = "join", .usage = "PART... [options]", .brief = "parts made by --shard into what one run writes",
    .what = "Reads the parts of all shards of a run (--shard K/N --output PART), in any order, and writes "
            "what one run writes, to the byte.  The lens and the rays have to be where the parts found them. "
            "A part that is missing, damaged, there twice or of another run is an error that names it.",
    .often = "output threads progress",
    .examples = "  sagitta spot FILE --random 1000000 --shard 1/2 --output 1.part\n"
                "  sagitta spot FILE --random 1000000 --shard 2/2 --output 2.part\n"
                "  sagitta join 1.part 2.part --output FILE\n",
    .docs = "docs/scale.md", .group = {&join_own}, .run = join_run,
};

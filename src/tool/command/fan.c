// SPDX-License-Identifier: MIT
/* fan.c - sagitta fan: the picture of transverse errors along two lines of the pupil. */
#include "commands.h"
#include "../look/lines.h"

static void draw_fans(const look *l)
{
    look_lines_draw(l, "from the chief ray of the primary wavelength", "ey", "ex");
}

static exit_status fan_run(const command *c, int argc, char *argv[])
{
    return look_run(c, &(look_way){.draw = draw_fans, .check = look_lines_check}, argc, argv);
}

const command command_fan = {
    .name = "fan", .brief = "transverse errors across the pupil",
    .often = "fields field cross fan wavelength picture proof format output",
    .examples = "  sagitta fan examples/lenses/cooke_triplet.yaml --cross 5\n"
                "  sagitta fan examples/lenses/cooke_triplet.yaml --picture fans.svg\n",
    .run = fan_run,
};

/* fan.c - sagitta fan: the picture of transverse errors along two lines of the pupil. */
#include "commands.h"
#include "../look/lines.h"

static void draw_fans(const look *l)
{
    look_lines_draw(l, "from the chief ray of the primary wavelength", "ey", "ex");
}

exit_status command_fan(int argc, char *argv[])
{
    return look_run("fan", &(look_way){.draw = draw_fans, .check = look_lines_check}, argc, argv);
}

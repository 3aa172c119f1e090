// SPDX-License-Identifier: MIT
/* lines.h - pictures of a number along two lines of the pupil: in y (tangential) and in x (sagittal). */
#ifndef TOOL_LINES_H
#define TOOL_LINES_H
#include "look.h"

/* For --picture: fewer than two of these points on each line are a usage error. */
void look_lines_check(look *l);

/* Draws the column `tangential` against py where px is 0, and `sagittal` against px where py is 0: two panels
 * for each field; a line with fewer than two points has none.  line: under the title. */
void look_lines_draw(const look *l, const char *line, const char *tangential, const char *sagittal);

#endif

/* lines.h - pictures of a number along two lines of the pupil: in y (tangential) and in x (sagittal). */
#ifndef TOOL_LINES_H
#define TOOL_LINES_H
#include "look.h"

/* What is collected of a field: for each wavelength the numbers along both lines. */
typedef struct look_lines {
    size_t bands;
    struct look_line { size_t count; double *at, *value; } *line[2]; /* [bands]; 0: in y, 1: in x */
} look_lines;

/* For --picture: fewer than two of these points on each line are a usage error. */
void look_lines_check(const launch_pattern *points);

look_lines look_lines_for(const look *l, const launch_pattern *points);

/* Adds a ray, if its point is on one of the lines: the centre is on both. */
void look_lines_add(look_lines *of, size_t band, const sgt_ray_end *end, double tangential, double sagittal);

/* Draws those of all fields, two panels each; a line with fewer than two points has none. */
void look_lines_draw(const look *l, const look_lines of[], const char *what, const char *line,
                     const char *tangential_label, const char *sagittal_label);

#endif

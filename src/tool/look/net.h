// SPDX-License-Identifier: MIT
/* net.h - numbers over the pupil or the field as maps of squares. */
#ifndef TOOL_NET_H
#define TOOL_NET_H
#include "look.h"

/* The rows of one field and wavelength, from `first` on, as a map over px, py; blank outside the circle.  n:
 * points across, of a grid or (cells) of cells.  value: of each row. */
chart_map look_net(const look *l, size_t first, size_t count, size_t n, bool cells, const double value[],
                   const char *label);

/* One scale of colours for all of them. */
void look_same_scale(size_t count, chart_map map[]);

/* Is a map drawn of these points: cells or a grid?  *n: points across. */
bool look_is_net(const look *l, size_t *n, bool *cells);

#endif

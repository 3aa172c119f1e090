/* net.h - the points of a pupil as a map of squares. */
#ifndef TOOL_NET_H
#define TOOL_NET_H
#include "../draw/chart.h"
#include "look.h"

/* The values of points that are a grid or cells, as a map over px, py; blank outside the circle. */
chart_map look_net(const launch_pattern *points, const double value[], const char *label);

#endif

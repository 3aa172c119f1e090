/* net.c - a grid of n has n points from edge to edge, and cells of n have n middles of squares. */
#include "net.h"

#include "../base/memory.h"

#include <math.h>

chart_map look_net(const launch_pattern *points, const double value[], const char *label)
{
    const size_t n = points->n;
    const bool cells = points->pattern == SGT_PATTERN_CELLS;
    const double step = cells   ? 2 / (double)n
                        : n > 1 ? 2 / (double)(n - 1)
                                : 2,
                 edge = cells || n == 1 ? 1 : 1 + step / 2;
    double *square = memory_take(n * n, sizeof *square);
    for (size_t i = 0; i < n * n; i++) square[i] = (double)NAN;
    for (size_t i = 0; i < points->count; i++) {
        const double place = floor((points->at[i].x + edge) / step),
                     row = floor((points->at[i].y + edge) / step);
        square[(size_t)row * n + (size_t)place] = value[i];
    }
    return (chart_map){.columns = n,
                       .rows = n,
                       .x_low = -edge,
                       .x_high = edge,
                       .y_low = -edge,
                       .y_high = edge,
                       .value = square,
                       .label = label};
}

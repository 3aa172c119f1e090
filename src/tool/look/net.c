// SPDX-License-Identifier: MIT
/* net.c - a grid of n has n points from edge to edge, and cells of n have n middles of squares. */
#include "net.h"

#include "../base/memory.h"

#include <math.h>

chart_map look_net(const look *l, size_t first, size_t count, size_t n, bool cells, const double value[],
                   const char *label)
{
    const size_t px = look_column(l, "px"), py = look_column(l, "py");
    const double step = cells   ? 2 / (double)n
                        : n > 1 ? 2 / (double)(n - 1)
                                : 2,
                 edge = cells || n == 1 ? 1 : 1 + step / 2;
    double *square = memory_take(n * n, sizeof *square);
    for (size_t i = 0; i < n * n; i++) square[i] = (double)NAN;
    for (size_t i = 0; i < count; i++) {
        const void *row = look_row(l, first + i);
        const double place = floor((look_value(l, row, px) + edge) / step),
                     line = floor((look_value(l, row, py) + edge) / step);
        square[(size_t)line * n + (size_t)place] = value[i];
    }
    return (chart_map){.columns = n, .rows = n, .x_low = -edge, .x_high = edge, .y_low = -edge,
                       .y_high = edge, .value = square, .label = label};
}

void look_same_scale(size_t count, chart_map map[])
{
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (size_t m = 0; m < count; m++)
        for (size_t i = 0; i < map[m].columns * map[m].rows; i++) {
            const double x = map[m].value[i];
            if (isfinite(x)) least = fmin(least, x), most = fmax(most, x);
        }
    for (size_t m = 0; m < count && least <= most; m++)
        map[m].scaled = true, map[m].least = least, map[m].most = most;
}

bool look_is_net(const look *l, size_t *n, bool *cells)
{
    const job_points_asked asked = job_points_of(&l->job, l->of->pattern);
    *cells = asked.pattern == SGT_PATTERN_CELLS;
    *n = asked.rays ? asked.rays : l->of->rays;
    return !asked.count && (*cells || asked.pattern == SGT_PATTERN_GRID);
}

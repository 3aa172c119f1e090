// SPDX-License-Identifier: MIT
/* chart.h - a sheet of panels with curves, points, maps and circles, as svg, png or pdf.
 *
 * Everything lasts until chart_write returns.  Texts are UTF-8.  A NULL or a zero means that there is none,
 * or that the chart chooses. */
#ifndef TOOL_CHART_H
#define TOOL_CHART_H
#include <stdbool.h>
#include <stddef.h>

/* How the points of a series are drawn: CHART_DOT and CHART_CROSS are for single points, and so small that
 * hundreds of them can be told apart. */
typedef enum chart_mark {
    CHART_NO_MARK, CHART_DOT, CHART_PLUS, CHART_CROSS, CHART_TRIANGLE, CHART_SQUARE, CHART_RING, CHART_DIAMOND
} chart_mark;

typedef enum chart_dash { CHART_SOLID, CHART_DASHED, CHART_DOTTED } chart_dash;

/* Points, joined by a line if `line`.  A NaN is a gap. */
typedef struct chart_series {
    const char *name;      /* in the legend of the sheet, where equal names with equal looks stand once */
    size_t colour;         /* 0, 1, ...: of the palette, which is safe for the colour-blind; repeated with
                              other marks and dashes if there are more than it has */
    chart_mark mark;
    chart_dash dash;
    bool line;
    size_t count;
    const double *x, *y;
} chart_series;

/* Values on a net of squares, in colours, with a bar that tells them.  value[j * columns + i] fills the i-th
 * square from the left of the j-th row from below.  A NaN is left blank. */
typedef struct chart_map {
    size_t columns, rows;
    double x_low, x_high, y_low, y_high;
    const double *value;
    const char *label;     /* of the bar, with its unit */
    const char *const *kinds; /* if given, the values are 0, 1, ...: one flat colour for each of the names */
    size_t kind_count;
    bool logarithmic;      /* colours by the logarithm */
    bool about_zero;       /* two hues that meet at 0 */
    bool scaled;           /* the colours go at least from `least` to `most`, as of other maps beside it */
    double least, most;
} chart_map;

typedef struct chart_circle { double x, y, radius; const char *name; chart_dash dash; } chart_circle;

/* A straight line across the panel at x (upright) or y. */
typedef struct chart_rule { bool upright; double at; const char *name; chart_dash dash; } chart_rule;

typedef struct chart_panel {
    const char *title;               /* above it */
    const char *x_label, *y_label;   /* with units */
    const char *const *note;         /* [notes]: lines of small text below it */
    size_t notes;
    bool square;                     /* x and y have one scale */
    bool bar;                        /* a scale bar in place of numbers on the axes (with `square`) */
    double x_low, x_high, y_low, y_high; /* the least range; both zero: as the content has it */
    size_t series_count, circles, rules;
    const chart_series *series;
    const chart_circle *circle;
    const chart_rule *rule;
    const chart_map *map;            /* below all else */
} chart_panel;

typedef struct chart {
    const char *title;               /* of the sheet, bold */
    const char *const *line;         /* [lines] under it */
    size_t lines;
    size_t columns;                  /* of panels; fewer if too narrow; 0: the chart chooses */
    size_t panels;
    const chart_panel *panel;
    const char *legend_title;
    bool same_x, same_y;             /* all panels have the same range of x, or y */
} chart;

/* Ends with a usage error if the ending of `path` is none of .svg, .png and .pdf, or if the command was built
 * without cairo.  option: without its dashes. */
void chart_check(const char *option, const char *path);

/* Writes the picture.  If it cannot be written the command ends. */
void chart_write(const char *path, const chart *c);

#endif

// SPDX-License-Identifier: MIT
/* chart_sheet.c - draws sheets of src/tool/draw/chart.h: ordinary ones as the analyses have, and hostile
 * ones.
 *
 *   chart_sheet               the names of the sheets
 *   chart_sheet NAME FILE     draws one
 *   chart_sheet SEED FILE     draws a random one, of a number above 0 */
#include "../../src/tool/base/fail.h"
#include "../../src/tool/base/memory.h"
#include "../../src/tool/draw/chart.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(list) (sizeof(list) / sizeof(list)[0])
#define MICRO "\302\265m"

static const char *const wave_name[] = {"0.4861 " MICRO, "0.5876 " MICRO, "0.6563 " MICRO};

static double *line_of(size_t count, double from, double to)
{
    double *x = memory_take(count, sizeof *x);
    for (size_t i = 0; i < count; i++) x[i] = from + (to - from) * (double)i / (double)(count - 1);
    return x;
}

/* ------------------------------------------------------------ as the analyses have them */

enum { SIDE = 25 };

/* The spot of a field and a wavelength: astigmatism, coma and a colour error. */
static chart_series spot_of(double field, size_t wave, double defocus)
{
    chart_series s = {.name = wave_name[wave], .colour = wave, .mark = (chart_mark)(CHART_DOT + wave)};
    double *x = memory_take(SIDE * SIDE, sizeof *x), *y = memory_take(SIDE * SIDE, sizeof *y);
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++) {
            double px = 2.0 * i / (SIDE - 1) - 1, py = 2.0 * j / (SIDE - 1) - 1, r2 = px * px + py * py;
            if (r2 > 1) continue;
            x[s.count] = px * (defocus + 3 * r2 - 2 * field) + 1.5 * field * px * py;
            y[s.count] =
                py * (defocus + 3 * r2 - 6 * field) + field * (px * px + 3 * py * py) + (double)wave * field;
            s.count++;
        }
    s.x = x, s.y = y;
    return s;
}

static chart spot_sheet(void)
{
    static const char *const line[] = {
        "Cooke triplet, f/4, 50 mm; 489 rays for each field and wavelength, hexapolar; about the chief ray",
        "all rays passed; rounding leaves 9 digits of each point certain"};
    static const char *const note[] = {"RMS 3.21 " MICRO ", largest 8.04 " MICRO, "Airy radius 2.87 " MICRO};
    static const char *const title[9] = {
        "0\302\260, focus \342\210\2220.1 mm",  "0\302\260",  "0\302\260, focus +0.1 mm",
        "14\302\260, focus \342\210\2220.1 mm", "14\302\260", "14\302\260, focus +0.1 mm",
        "20\302\260, focus \342\210\2220.1 mm", "20\302\260", "20\302\260, focus +0.1 mm"};
    chart_panel *panel = memory_take(9, sizeof *panel);
    for (size_t i = 0; i < 9; i++) {
        chart_series *s = memory_take(3, sizeof *s);
        chart_circle *airy = memory_take(1, sizeof *airy);
        for (size_t w = 0; w < 3; w++) s[w] = spot_of((double)(i / 3) / 2, w, 4.0 * ((double)(i % 3) - 1));
        *airy = (chart_circle){.radius = 2.87, .name = "Airy disk, 0.5876 " MICRO};
        panel[i] = (chart_panel){.title = title[i],
                                 .x_label = "x (" MICRO ")",
                                 .y_label = "y (" MICRO ")",
                                 .note = note,
                                 .notes = 2,
                                 .square = true,
                                 .bar = true,
                                 .series_count = 3,
                                 .series = s,
                                 .circles = 1,
                                 .circle = airy};
    }
    return (chart){.title = "Spot diagram",
                   .line = line,
                   .lines = 2,
                   .columns = 3,
                   .panels = 9,
                   .panel = panel,
                   .legend_title = "wavelength",
                   .same_x = true,
                   .same_y = true};
}

static chart fan_sheet(void)
{
    static const char *const line[] = {"Cooke triplet, f/4, 50 mm; 61 rays for each curve"};
    static const char *const title[] = {"0\302\260, tangential",  "0\302\260, sagittal",
                                        "14\302\260, tangential", "14\302\260, sagittal",
                                        "20\302\260, tangential", "20\302\260, sagittal"};
    enum { POINTS = 61 };
    chart_panel *panel = memory_take(6, sizeof *panel);
    for (size_t i = 0; i < 6; i++) {
        chart_series *s = memory_take(3, sizeof *s);
        for (size_t w = 0; w < 3; w++) {
            double *x = line_of(POINTS, -1, 1), *y = memory_take(POINTS, sizeof *y), f = (double)(i / 2);
            for (size_t k = 0; k < POINTS; k++)
                y[k] = 22 * pow(x[k], 3) - (14 + 3 * (double)w) * x[k] + (i % 2 ? 0 : 6 * f * x[k] * x[k]);
            if (i == 4) y[0] = y[1] = y[2] = NAN; /* vignetted */
            s[w] = (chart_series){
                .name = wave_name[w], .colour = w, .line = true, .count = POINTS, .x = x, .y = y};
        }
        panel[i] = (chart_panel){.title = title[i],
                                 .x_label = i % 2 ? "pupil x" : "pupil y",
                                 .y_label = i % 2 ? "ray error x (" MICRO ")" : "ray error y (" MICRO ")",
                                 .x_low = -1,
                                 .x_high = 1,
                                 .series_count = 3,
                                 .series = s};
    }
    return (chart){.title = "Transverse ray fans",
                   .line = line,
                   .lines = 1,
                   .columns = 2,
                   .panels = 6,
                   .panel = panel,
                   .legend_title = "wavelength",
                   .same_y = true};
}

static chart_map *map_over_pupil(double (*value)(double x, double y), size_t side)
{
    chart_map *m = memory_take(1, sizeof *m);
    double *v = memory_take(side * side, sizeof *v);
    *m = (chart_map){.columns = side, .rows = side, .x_low = -1, .x_high = 1, .y_low = -1, .y_high = 1};
    for (size_t j = 0; j < side; j++)
        for (size_t i = 0; i < side; i++) {
            double x = (2.0 * (double)i + 1) / (double)side - 1, y = (2.0 * (double)j + 1) / (double)side - 1;
            v[j * side + i] = x * x + y * y <= 1 ? value(x, y) : (double)NAN;
        }
    m->value = v;
    return m;
}

static double wave_error(double x, double y)
{
    double r2 = x * x + y * y;
    return 0.9 * y * (3 * r2 - 2) + 0.4 * (x * x - y * y) + 0.3 * (6 * r2 * r2 - 6 * r2 + 1) - 0.2;
}

static double fate(double x, double y)
{
    return y > 0.6 + 0.2 * x * x ? 1 : hypot(x, y + 0.2) < 0.25 ? 2 : x > 0.9 ? 3 : 0;
}

static double evaluations(double x, double y) { return floor(pow(10, 0.4 + 3 * fabs(x * y) + x * x)); }

static double errors_of_t(double x, double y) { return pow(10, -15 + 3 * x * x + 2 * y); }

static chart opd_sheet(void)
{
    static const char *const line[] = {"Cooke triplet, f/4, 50 mm; against the chief ray's reference sphere; "
                                       "positive: the wavefront is ahead"};
    static const char *const note[] = {"RMS 0.321 waves, peak to valley 1.702 waves; 3228 rays",
                                       "digits certain: 7"};
    chart_panel *panel = memory_take(2, sizeof *panel);
    for (size_t i = 0; i < 2; i++) {
        chart_map *m = map_over_pupil(wave_error, 64);
        m->label = "optical path difference (waves)", m->about_zero = true;
        panel[i] = (chart_panel){.title = i ? "20\302\260, 0.5876 " MICRO : "0\302\260, 0.5876 " MICRO,
                                 .x_label = "pupil x",
                                 .y_label = "pupil y",
                                 .square = true,
                                 .map = m,
                                 .note = note,
                                 .notes = 2};
    }
    return (chart){.title = "Wavefront", .line = line, .lines = 1, .panels = 2, .panel = panel};
}

static chart field_sheet(void)
{
    enum { POINTS = 41 };
    static const char *const curve[] = {"tangential, 0.4861 " MICRO, "sagittal, 0.4861 " MICRO,
                                        "tangential, 0.5876 " MICRO, "sagittal, 0.5876 " MICRO,
                                        "tangential, 0.6563 " MICRO, "sagittal, 0.6563 " MICRO};
    double *field = line_of(POINTS, 0, 20), *still = line_of(POINTS, 0, 20), *bent = line_of(POINTS, 0, 20);
    chart_series *focus = memory_take(6, sizeof *focus), *height = memory_take(3, sizeof *height);
    for (size_t i = 0; i < 6; i++) {
        double *z = memory_take(POINTS, sizeof *z);
        for (size_t k = 0; k < POINTS; k++)
            z[k] = (i % 2 ? -2e-4 : -6e-4) * field[k] * field[k] + 4e-9 * pow(field[k], 5) +
                   0.02 * (double)(i / 2);
        focus[i] = (chart_series){.name = curve[i],
                                  .colour = i / 2,
                                  .dash = i % 2 ? CHART_DASHED : CHART_SOLID,
                                  .line = true,
                                  .count = POINTS,
                                  .x = z,
                                  .y = field};
    }
    for (size_t k = 0; k < POINTS; k++)
        still[k] = -3e-4 * pow(field[k], 2), bent[k] = 1.2e-6 * pow(field[k], 4);
    height[0] = (chart_series){
        .name = wave_name[1], .colour = 1, .line = true, .count = POINTS, .x = still, .y = field};
    height[1] = (chart_series){
        .name = "grid of 9 fields", .colour = 1, .mark = CHART_DIAMOND, .count = 9, .x = bent, .y = field};
    chart_rule *zero = memory_take(1, sizeof *zero);
    *zero = (chart_rule){.upright = true, .name = "image plane", .dash = CHART_DOTTED};
    chart_panel *panel = memory_take(3, sizeof *panel);
    panel[0] = (chart_panel){.title = "Field curvature",
                             .x_label = "focus (mm)",
                             .y_label = "field (\302\260)",
                             .series_count = 6,
                             .series = focus,
                             .rules = 1,
                             .rule = zero,
                             .y_high = 20};
    panel[1] = (chart_panel){.title = "Distortion against f tan",
                             .x_label = "distortion (%)",
                             .y_label = "field (\302\260)",
                             .series_count = 2,
                             .series = height,
                             .y_high = 20};
    panel[2] = (chart_panel){.title = "Astigmatism",
                             .x_label = "tangential \342\210\222 sagittal (mm)",
                             .y_label = "field (\302\260)",
                             .series_count = 2,
                             .series = focus,
                             .y_high = 20};
    return (chart){.title = "Field curves", .panels = 3, .panel = panel};
}

static chart map_sheet(void)
{
    static const char *const kinds[] = {"passed", "clipped at element 4", "missed element 2",
                                        "totally reflected at element 3", "lost"};
    chart_panel *panel = memory_take(3, sizeof *panel);
    chart_map *m[3] = {map_over_pupil(fate, 101), map_over_pupil(evaluations, 51),
                       map_over_pupil(errors_of_t, 51)};
    m[0]->kinds = kinds, m[0]->kind_count = COUNT(kinds);
    m[1]->label = "evaluations", m[1]->logarithmic = true;
    m[2]->label = "t_err (mm)", m[2]->logarithmic = true;
    for (size_t i = 0; i < 3; i++)
        panel[i] = (chart_panel){.title = i == 0   ? "Fate of the rays"
                                          : i == 1 ? "Cost"
                                                   : "Bound on the error",
                                 .x_label = "pupil x",
                                 .y_label = "pupil y",
                                 .square = true,
                                 .map = m[i]};
    return (chart){.title = "Over the pupil, field 14\302\260", .panels = 3, .panel = panel};
}

static chart sweep_sheet(void)
{
    enum { POINTS = 91 };
    static const char *const name[] = {"passed", "clipped", "missed", "totally reflected", "lost"};
    double *angle = line_of(POINTS, 0, 45);
    chart_series *s = memory_take(5, sizeof *s);
    for (size_t i = 0; i < 5; i++) {
        double *y = memory_take(POINTS, sizeof *y);
        for (size_t k = 0; k < POINTS; k++) {
            double passed = 10000 / (1 + exp((angle[k] - 27) / 2));
            y[k] = i == 0 ? floor(passed)
                          : floor((10000 - passed) * (i == 1   ? 0.7
                                                      : i == 2 ? 0.2
                                                      : i == 3 ? 0.1
                                                               : 0));
        }
        s[i] = (chart_series){.name = name[i],
                              .colour = i,
                              .line = true,
                              .mark = i == 4 ? CHART_CROSS : CHART_NO_MARK,
                              .count = POINTS,
                              .x = angle,
                              .y = y};
    }
    chart_panel *panel = memory_take(1, sizeof *panel);
    *panel = (chart_panel){.x_label = "field angle (\302\260)",
                           .y_label = "rays",
                           .series_count = 5,
                           .x_high = 45,
                           .y_high = 10000,
                           .series = s};
    return (chart){.title = "Fates of 10000 rays against the field angle", .panels = 1, .panel = panel};
}

/* --------------------------------------------------------------------- hostile */

static chart one_series(const chart_series *s, size_t panels)
{
    chart_panel *panel = memory_take(panels, sizeof *panel);
    for (size_t i = 0; i < panels; i++)
        panel[i] = (chart_panel){
            .title = s[i].name, .x_label = "x (mm)", .y_label = "y (mm)", .series_count = 1, .series = &s[i]};
    return (chart){.title = "Hostile numbers", .panels = panels, .panel = panel};
}

static chart numbers_sheet(void)
{
    static const double zero[] = {0, 0, 0}, three[] = {3, 3, 3}, nan3[] = {NAN, NAN, NAN},
                        mixed[] = {1, NAN, INFINITY, 2, -INFINITY, 4}, six[] = {0, 1, 2, 3, 4, 5},
                        huge[] = {-1e300, 1e300, 5e299}, tiny[] = {1e-300, -2e-300, 5e-300},
                        close_by[] = {97.4, 97.4 + 4e-10, 97.4 + 9e-10},
                        ulps[] = {1, 1 + 2.3e-16, 1 - 1.2e-16}, beyond[] = {1.7e308, -1.7e308, 1},
                        subnormal[] = {5e-324, 0, 1e-310}, large[] = {1234567, 1234890, 1234999},
                        small[] = {1.2e-7, 3.4e-7, -2e-8}, negative[] = {-97.4, -97.4 - 4e-8, -97.4 - 9e-8},
                        counts[] = {0, 250000, 1000000};
    static const struct {
        const char *name;
        size_t count;
        const double *x, *y;
    } list[] = {{"no points", 0, NULL, NULL},     {"one point", 1, three, zero},
                {"all equal", 3, three, three},   {"all NaN", 3, nan3, six},
                {"gaps", 6, six, mixed},          {"1e300", 3, six, huge},
                {"1e300 both", 3, huge, huge},    {"1e-300", 3, tiny, tiny},
                {"close by", 3, close_by, six},   {"close by, both", 3, close_by, close_by},
                {"ulps", 3, six, ulps},           {"beyond", 3, six, beyond},
                {"subnormal", 3, six, subnormal}, {"large", 3, large, large},
                {"small", 3, six, small},         {"negative", 3, negative, negative},
                {"counts", 3, counts, counts},    {"flat at 0", 3, six, zero}};
    chart_series *s = memory_take(COUNT(list), sizeof *s);
    for (size_t i = 0; i < COUNT(list); i++)
        s[i] = (chart_series){.name = list[i].name,
                              .line = true,
                              .mark = CHART_RING,
                              .count = list[i].count,
                              .x = list[i].x,
                              .y = list[i].y};
    return one_series(s, COUNT(list));
}

/* The same in square panels, with a bar in every second. */
static chart squares_sheet(void)
{
    chart c = numbers_sheet();
    chart_panel *panel = memory_take(c.panels, sizeof *panel);
    for (size_t i = 0; i < c.panels; i++) {
        panel[i] = c.panel[i];
        panel[i].square = true, panel[i].bar = i % 2;
    }
    c.panel = panel, c.columns = 6;
    return c;
}

static chart shared_sheet(void)
{
    chart c = squares_sheet();
    c.same_x = c.same_y = true, c.columns = 5;
    return c;
}

static chart empty_sheet(void) { return (chart){.title = "Nothing"}; }

static chart bare_sheet(void)
{
    static const chart_panel panel[2] = {{.title = NULL}, {.square = true, .bar = true}};
    return (chart){.panels = 2, .panel = panel};
}

static chart texts_sheet(void)
{
    static const char long_text[] =
        "The quick brown fox jumps over the lazy dog, the five boxing wizards jump quickly, "
        "and sphinx of black quartz judges the vow of many a longer sentence than fits";
    static const char bad[] =
        "not UTF-8: \377\200 \303( \355\240\200 \360\217\277\277 \364\220\200\200 end\302";
    static const char word[] =
        "Donaudampfschifffahrtselektrizitaetenhauptbetriebswerkbauunterbeamtengesellschaft"
        "sversammlungsraumschluesselbundverwahrungsbeauftragtenvertreterinnenkammervorsitz";
    static const char *const lines[] = {long_text, bad, word, "",
                                        "a <b> & \"c\"\twith a tab\nand a new line"};
    static const double x[] = {0, 1, 2}, y[] = {0.00123456, 0.0012346, 0.00123478};
    chart_series *s = memory_take(60, sizeof *s);
    chart_panel *panel = memory_take(4, sizeof *panel);
    for (size_t i = 0; i < 60; i++) {
        char *name = memory_take(200, 1);
        snprintf(name, 200, "%.*s %zu", (int)(i % 7 == 6 ? 150 : 3 * (i % 9)), long_text, i);
        s[i] = (chart_series){.name = name,
                              .colour = i,
                              .mark = (chart_mark)(i % 8),
                              .dash = (chart_dash)(i % 3),
                              .line = i % 2,
                              .count = 3,
                              .x = x,
                              .y = y};
    }
    for (size_t i = 0; i < 4; i++)
        panel[i] = (chart_panel){.title = lines[i % 3],
                                 .x_label = "a label that is much longer than its axis is, and "
                                            "still has a unit (furlongs per fortnight)",
                                 .y_label = long_text,
                                 .note = lines,
                                 .notes = COUNT(lines),
                                 .square = i == 3,
                                 .bar = i == 3,
                                 .series_count = 60 - 20 * i,
                                 .series = s};
    return (chart){.title = long_text,
                   .line = lines,
                   .lines = COUNT(lines),
                   .columns = 4,
                   .panels = 4,
                   .panel = panel,
                   .legend_title = word};
}

static double nowhere(double x, double y) { return (void)x, (void)y, (double)NAN; }
static double everywhere(double x, double y) { return (void)x, (void)y, 0.25; }
static double wild(double x, double y) { return x > 0 ? 1e300 * y : x < -0.5 ? -HUGE_VAL : 1e-300 * y; }
static double many_kinds(double x, double y) { return floor(12 * (x + 1)) + (y > 0 ? 0.5 : -2); }

static chart maps_sheet(void)
{
    static const char *const kinds[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k",
                                        "l", "m", "n", "o", "p", "q", "r", "s", "t", "u"};
    double (*const value[])(double, double) = {nowhere,    everywhere, wild,    many_kinds,
                                               everywhere, everywhere, nowhere, wave_error};
    chart_panel *panel = memory_take(COUNT(value), sizeof *panel);
    for (size_t i = 0; i < COUNT(value); i++) {
        chart_map *m = map_over_pupil(value[i], i == 1 ? 1 : i == 2 ? 7 : 40);
        m->label = "a value (mm)";
        m->logarithmic = i == 2 || i == 4, m->about_zero = i == 5;
        if (i == 3) m->kinds = kinds, m->kind_count = COUNT(kinds);
        if (i == 7) m->columns = m->rows = 0;
        panel[i] = (chart_panel){.title = "map", .x_label = "x", .y_label = "y", .map = m, .square = i % 2};
    }
    return (chart){.title = "Maps", .panels = COUNT(value), .panel = panel};
}

static chart far_sheet(void)
{
    static const double x[] = {-1e12, 1e12, 0, 0.5, 3e9, NAN, 0.2, 0.3},
                        y[] = {-1e12, 1e12, 0, 0.5, 1, 0, 0.8, 1e200};
    static const chart_circle circle[] = {{0, 0, 0.5, "small", CHART_SOLID},
                                          {1e6, 0, 1e6, "large", CHART_DASHED},
                                          {0, 0, 0, "none", CHART_DOTTED},
                                          {NAN, 0, 1, "nan", CHART_SOLID},
                                          {0, 0, INFINITY, "infinite", CHART_SOLID}};
    static const chart_rule rule[] = {{true, 0.25, "upright", CHART_DASHED},
                                      {false, 0.75, "level", CHART_DOTTED},
                                      {false, NAN, "nan", CHART_SOLID}};
    chart_series *s = memory_take(1, sizeof *s);
    chart_panel *panel = memory_take(1, sizeof *panel);
    *s =
        (chart_series){.name = "far", .line = true, .mark = CHART_DIAMOND, .count = COUNT(x), .x = x, .y = y};
    *panel = (chart_panel){.x_label = "x",
                           .y_label = "y",
                           .series_count = 1,
                           .series = s,
                           .circles = COUNT(circle),
                           .circle = circle,
                           .rules = COUNT(rule),
                           .rule = rule,
                           .square = true};
    return (chart){.title = "Far beyond the frame", .panels = 1, .panel = panel};
}

static chart tall_sheet(void)
{
    chart c = numbers_sheet();
    chart_panel *panel = memory_take(120, sizeof *panel);
    for (size_t i = 0; i < 120; i++) panel[i] = c.panel[i % c.panels];
    return (chart){
        .title = "Taller than a png may be at 2 pixels a point", .columns = 1, .panels = 120, .panel = panel};
}

/* ---------------------------------------------------------------------- random */

static uint64_t state;

/* Below n, by splitmix64 (Steele, Lea & Flood 2014). */
static size_t pick(size_t n)
{
    uint64_t z = state += 0x9E3779B97F4A7C15;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9;
    z = (z ^ z >> 27) * 0x94D049BB133111EB;
    return (size_t)((z ^ z >> 31) % n);
}

static double part(void) { return (double)pick(1u << 30) / (1u << 30); }

static double any_size(void) { return pow(10, pick(4) ? 6 * part() - 3 : 615 * part() - 310); }

/* Values of one size about a middle, some of them not finite. */
static double *any_values(size_t count)
{
    double middle = pick(2) ? 0 : any_size(), size = pick(3) ? any_size() : middle * pow(10, -16 * part());
    double *v = memory_take(count, sizeof *v);
    for (size_t i = 0; i < count; i++) {
        v[i] = pick(10) ? middle + size * (2 * part() - 1) : middle;
        if (!pick(12)) v[i] = pick(2) ? (double)NAN : HUGE_VAL;
    }
    return v;
}

static const char *any_text(void)
{
    static const char *const word[] = {
        "field",   "14\302\260",       "RMS (" MICRO ")",   "x", "(mm)", "a", "wavelengths,",
        "clipped", "\342\210\2220.25", "Gullstrand-LeGrand"};
    if (!pick(6)) return NULL;
    char *text = memory_take(400, 1);
    for (size_t words = pick(5) ? pick(4) : pick(20); words > 0; words--)
        strcat(strcat(text, word[pick(COUNT(word))]), words > 1 ? " " : "");
    return text;
}

static const char *const *any_texts(size_t count)
{
    const char **list = memory_take(count, sizeof *list);
    for (size_t i = 0; i < count; i++) list[i] = any_text();
    return list;
}

static chart_map *any_map(void)
{
    size_t columns = 1 + pick(30), rows = 1 + pick(30), kinds = 1 + pick(9);
    chart_map *m = memory_take(1, sizeof *m);
    *m = (chart_map){.columns = columns,
                     .rows = rows,
                     .x_low = -any_size(),
                     .x_high = any_size(),
                     .y_low = -any_size(),
                     .y_high = any_size(),
                     .value = any_values(columns * rows),
                     .label = any_text(),
                     .kinds = pick(3) ? NULL : any_texts(kinds),
                     .kind_count = kinds,
                     .logarithmic = pick(2),
                     .about_zero = pick(2)};
    return m;
}

static chart_panel any_panel(void)
{
    chart_panel p = {.title = any_text(),
                     .x_label = any_text(),
                     .y_label = any_text(),
                     .notes = pick(3),
                     .square = pick(2),
                     .bar = pick(2),
                     .series_count = pick(4),
                     .circles = pick(3),
                     .rules = pick(3)};
    p.note = any_texts(p.notes);
    chart_series *s = memory_take(p.series_count, sizeof *s);
    for (size_t i = 0; i < p.series_count; i++) {
        size_t count = pick(40);
        s[i] = (chart_series){.name = any_text(),
                              .colour = pick(30),
                              .mark = (chart_mark)pick(8),
                              .dash = (chart_dash)pick(3),
                              .line = pick(2),
                              .count = count,
                              .x = any_values(count),
                              .y = any_values(count)};
    }
    chart_circle *c = memory_take(p.circles, sizeof *c);
    for (size_t i = 0; i < p.circles; i++)
        c[i] = (chart_circle){*any_values(1), *any_values(1), any_size(), any_text(), CHART_DASHED};
    chart_rule *r = memory_take(p.rules, sizeof *r);
    for (size_t i = 0; i < p.rules; i++)
        r[i] = (chart_rule){pick(2), *any_values(1), any_text(), CHART_DOTTED};
    if (pick(2)) p.x_low = -any_size(), p.x_high = any_size();
    p.series = s, p.circle = c, p.rule = r, p.map = pick(3) ? NULL : any_map();
    return p;
}

static chart random_sheet(uint64_t seed)
{
    state = seed;
    chart c = {.title = any_text(),
               .lines = pick(4),
               .columns = pick(12),
               .panels = pick(13),
               .legend_title = any_text(),
               .same_x = pick(2),
               .same_y = pick(2)};
    chart_panel *panel = memory_take(c.panels, sizeof *panel);
    for (size_t i = 0; i < c.panels; i++) panel[i] = any_panel();
    c.panel = panel, c.line = any_texts(c.lines);
    return c;
}

static const struct {
    const char *name;
    chart (*make)(void);
} sheets[] = {
    {"spot", spot_sheet},     {"fan", fan_sheet},     {"opd", opd_sheet},         {"field", field_sheet},
    {"map", map_sheet},       {"sweep", sweep_sheet}, {"numbers", numbers_sheet}, {"squares", squares_sheet},
    {"shared", shared_sheet}, {"empty", empty_sheet}, {"bare", bare_sheet},       {"texts", texts_sheet},
    {"maps", maps_sheet},     {"far", far_sheet},     {"tall", tall_sheet},
};

static chart sheet_named(const char *name)
{
    uint64_t seed = strtoull(name, NULL, 10);
    if (seed > 0) return random_sheet(seed);
    for (size_t i = 0; i < COUNT(sheets); i++)
        if (strcmp(name, sheets[i].name) == 0) return sheets[i].make();
    fail_usage("%s: no such sheet", name);
}

int main(int argc, char **argv)
{
    fail_name("chart_sheet");
    if (argc == 1)
        for (size_t i = 0; i < COUNT(sheets); i++) puts(sheets[i].name);
    if (argc == 1) return EXIT_DECIDED;
    if (argc != 3) fail_usage("chart_sheet [NAME FILE]");
    chart_check("picture", argv[2]);
    chart c = sheet_named(argv[1]);
    chart_write(argv[2], &c);
    return EXIT_DECIDED;
}

// SPDX-License-Identifier: MIT
/* chart_map.c - values as colours, and the bar that tells them.
 *
 * The ramp goes from dark violet by blue and green to yellow.  Its 17 colours are equal steps of CIELAB's
 * lightness L*, from 16 to 91, to within 0.3.  So values can be read in grey, too.  The ramp about zero goes
 * from light grey by steps of equal CIELAB distance to dark blue and dark orange.  Neighbours of both ramps
 * stay 4.4 or more apart in protanopia, deuteranopia and tritanopia (Machado, Oliveira & Fernandes 2009).
 * Between two of the colours, values are interpolated.
 *
 * A map is drawn as an image with a whole number of pixels for each square, so that edges are sharp in every
 * viewer and no seams show between squares. */
#include "chart_draw.h"

#include "../base/memory.h"
#include "palette.h"

#include <math.h>
#include <stdint.h>

static const double BAR_GAP = 10, BAR_WIDTH = 11, BAR_TICK = 3, BAR_TEXT = 6, BAR_LABEL = 14,
                    PIXELS_PER_POINT = 3, FEWEST_DECADES = 0.8, OVERLAP = 0.3;
enum { STEPS = 17, LARGEST_IMAGE = 30000 };
static const uint32_t BLANK = 0xFFFFFFFFu; /* no pixel has this */

static const double sequence[STEPS][3] = {
    {0.182, 0.111, 0.352}, {0.177, 0.167, 0.408}, {0.162, 0.223, 0.457}, {0.138, 0.280, 0.495},
    {0.109, 0.336, 0.524}, {0.092, 0.392, 0.543}, {0.108, 0.446, 0.557}, {0.147, 0.499, 0.568},
    {0.189, 0.553, 0.580}, {0.232, 0.607, 0.588}, {0.255, 0.664, 0.590}, {0.308, 0.719, 0.578},
    {0.402, 0.771, 0.551}, {0.522, 0.817, 0.513}, {0.659, 0.857, 0.468}, {0.806, 0.891, 0.422},
    {0.958, 0.918, 0.386},
};
static const double two_sided[STEPS][3] = {
    {0.005, 0.309, 0.542}, {0.065, 0.377, 0.637}, {0.199, 0.482, 0.749}, {0.332, 0.583, 0.834},
    {0.465, 0.673, 0.887}, {0.592, 0.751, 0.917}, {0.713, 0.819, 0.933}, {0.828, 0.882, 0.940},
    {0.941, 0.941, 0.941}, {0.931, 0.844, 0.801}, {0.913, 0.749, 0.667}, {0.884, 0.652, 0.535},
    {0.838, 0.552, 0.403}, {0.770, 0.445, 0.269}, {0.664, 0.330, 0.130}, {0.556, 0.239, 0.000},
    {0.489, 0.206, 0.000},
};

/* ---------------------------------------------------------------- colours */

static bool two_hues(const chart_map *m) { return m->about_zero && !m->logarithmic; }

/* The colour at a part of the scale from 0 to 1. */
static void ramp_colour(const chart_map *m, double part, double rgb[3])
{
    const double(*ramp)[3] = two_hues(m) ? two_sided : sequence;
    double at = fmin(fmax(part, 0), 1) * (STEPS - 1), below = fmin(floor(at), STEPS - 2);
    const double *a = ramp[(int)below], *b = ramp[(int)below + 1];
    for (int i = 0; i < 3; i++) rgb[i] = a[i] + (at - below) * (b[i] - a[i]);
}

/* The palette's, lightened: they fill areas. */
void chart_kind_colour(size_t i, double rgb[3])
{
    const double *c = palette_colour(i);
    double white = i < PALETTE_COLOURS ? 0.25 : i < 2 * PALETTE_COLOURS ? 0.55 : 0.75;
    for (int k = 0; k < 3; k++) rgb[k] = c[k] + white * (1 - c[k]);
}

/* Its place along the scale's axis; NaN: there is none. */
static double scaled(const chart_map *m, double value)
{
    if (!chart_finite(value) || (m->logarithmic && !(value > 0))) return NAN;
    return m->logarithmic ? log10(value) : value;
}

/* Returns false for a square that is left blank. */
static bool square_colour(const chart_map *m, const chart_scale *s, double value, double rgb[3])
{
    if (m->kinds) {
        if (!(value >= 0 && value < (double)m->kind_count)) return false;
        chart_kind_colour((size_t)value, rgb);
        return true;
    }
    double at = scaled(m, value);
    if (isnan(at)) return false;
    ramp_colour(m, chart_axis_part(&s->axis, at), rgb);
    return true;
}

chart_scale chart_scale_of(const chart_map *m, double length)
{
    chart_scale s = {.shown = false};
    chart_range r = chart_range_none();
    for (size_t i = 0; i < m->columns * m->rows; i++) chart_range_add(r.fixed, scaled(m, m->value[i]));
    if (m->scaled)
        chart_range_add(r.fixed, scaled(m, m->least)), chart_range_add(r.fixed, scaled(m, m->most));
    if (two_hues(m)) {
        double most = fmax(fabs(r.fixed[0]), fabs(r.fixed[1]));
        chart_range_add(r.fixed, most);
        chart_range_add(r.fixed, -most);
    }
    s.shown = !m->kinds && r.fixed[0] <= r.fixed[1];
    if (m->logarithmic &&
        r.fixed[1] - r.fixed[0] < FEWEST_DECADES) { /* so that two of 1, 2, 5 are on the bar */
        double middle = (r.fixed[0] + r.fixed[1]) / 2;
        r.fixed[0] = middle - FEWEST_DECADES / 2, r.fixed[1] = middle + FEWEST_DECADES / 2;
    }
    s.axis = chart_axis_of(&r);
    chart_axis_ticks(&s.axis, length, fmax(20, length / 9));
    if (m->logarithmic) s.axis.exponent = 0, s.axis.origin = 0; /* its numbers are those of the values */
    return s;
}

/* ------------------------------------------------------------------ image */

static uint32_t pixel_of(const double rgb[3])
{
    uint32_t part[3];
    for (int i = 0; i < 3; i++) part[i] = (uint32_t)lround(255 * rgb[i]);
    return part[0] << 16 | part[1] << 8 | part[2];
}

/* How many pixels a square has along a side of the map. */
static size_t pixels_of(size_t squares, double length)
{
    size_t wanted = (size_t)ceil(PIXELS_PER_POINT * length / (double)squares);
    return wanted * squares <= LARGEST_IMAGE ? wanted : 1;
}

/* Adds the coloured squares to the path, in runs along the rows; returns whether these are all.  A run
 * reaches a little into the row below, or a seam would show. */
static bool add_coloured(cairo_t *cr, const uint32_t *colour, size_t columns, size_t rows,
                         const chart_box *at)
{
    double wide = (at->right - at->left) / (double)columns, high = (at->bottom - at->top) / (double)rows;
    bool all = true;
    for (size_t j = 0; j < rows; j++)
        for (size_t i = 0, end; i < columns; i = end) {
            for (end = i; end < columns && colour[j * columns + end] != BLANK;) end++;
            double count = (double)(end - i);
            if (end > i)
                cairo_rectangle(cr, at->left + (double)i * wide, at->bottom - (double)(j + 1) * high,
                                count * wide, high + OVERLAP);
            for (; end < columns && colour[j * columns + end] == BLANK; end++) all = false;
        }
    return all;
}

/* Fills `at` with an image of columns * rows squares; row 0 is the lowest. */
static void draw_squares(cairo_t *cr, const uint32_t *colour, size_t columns, size_t rows,
                         const chart_box *at)
{
    size_t across = pixels_of(columns, at->right - at->left), up = pixels_of(rows, at->bottom - at->top);
    int width = (int)(columns * across), height = (int)(rows * up);
    cairo_surface_t *image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    unsigned char *data = cairo_image_surface_get_data(image);
    size_t stride = (size_t)cairo_image_surface_get_stride(image);
    for (size_t y = 0; data && y < rows * up; y++) {
        uint32_t *pixel = (uint32_t *)(void *)(data + y * stride);
        const uint32_t *row = colour + (rows - 1 - y / up) * columns;
        for (size_t x = 0; x < columns * across; x++) pixel[x] = row[x / across];
    }
    cairo_surface_mark_dirty(image);
    cairo_save(cr);
    cairo_new_path(cr);
    if (add_coloured(cr, colour, columns, rows, at))
        cairo_new_path(cr);
    else
        cairo_clip(cr);
    cairo_translate(cr, at->left, at->top);
    cairo_scale(cr, (at->right - at->left) / width, (at->bottom - at->top) / height);
    cairo_set_source_surface(cr, image, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cr), CAIRO_FILTER_NEAREST);
    cairo_rectangle(cr, 0, 0, width, height);
    cairo_fill(cr);
    cairo_restore(cr);
    cairo_surface_destroy(image);
}

void chart_map_draw(cairo_t *cr, const chart_map *m, const chart_scale *s, const chart_box *at)
{
    double rgb[3];
    size_t count = m->columns * m->rows;
    uint32_t *colour = memory_take(count, sizeof *colour);
    for (size_t i = 0; i < count; i++)
        colour[i] = square_colour(m, s, m->value[i], rgb) ? pixel_of(rgb) : BLANK;
    draw_squares(cr, colour, m->columns, m->rows, at);
}

/* -------------------------------------------------------------------- bar */

typedef struct bar_tick { double at; char text[CHART_TEXT]; } bar_tick;
enum { MOST_TICKS = 60 };

/* Of a logarithmic scale: powers of ten, and 2 and 5 times those where there is room. */
static size_t logarithmic_ticks(const chart_axis *a, bar_tick tick[MOST_TICKS])
{
    static const double leading[] = {1, 2, 5};
    size_t count = 0;
    int each = a->step <= 0.5 ? 3 : 1, apart = (int)fmax(a->step, 1),
        power = (int)floor(a->low / apart) * apart;
    for (; power <= a->high; power += apart)
        for (int i = 0; i < each && count < MOST_TICKS; i++) {
            double at = power + log10(leading[i]);
            if (at < a->low - 1e-9 || at > a->high + 1e-9) continue;
            tick[count].at = at;
            chart_number(leading[i] * pow(10, power), NULL, tick[count++].text);
        }
    return count;
}

static size_t bar_ticks(const chart_map *m, const chart_axis *a, bar_tick tick[MOST_TICKS])
{
    if (m->logarithmic) return logarithmic_ticks(a, tick);
    size_t count = 0;
    for (long i = chart_axis_first(a); i <= chart_axis_last(a) && count < MOST_TICKS; i++) {
        tick[count].at = a->origin + (double)i * a->step;
        chart_axis_number(a, i, tick[count++].text);
    }
    return count;
}

static double widest_tick(cairo_t *cr, const chart_map *m, const chart_scale *s)
{
    bar_tick tick[MOST_TICKS];
    size_t count = bar_ticks(m, &s->axis, tick);
    double widest = 0;
    chart_font(cr, CHART_SMALL, false);
    for (size_t i = 0; i < count; i++) widest = fmax(widest, chart_width(cr, tick[i].text));
    return widest;
}

double chart_scale_width(cairo_t *cr, const chart_map *m, const chart_scale *s)
{
    if (!s->shown) return 0;
    char text[CHART_TEXT];
    double label = chart_axis_label(&s->axis, m->label, true, text) ? BAR_LABEL + 0.3 * CHART_NORMAL : 0;
    return BAR_GAP + BAR_WIDTH + BAR_TEXT + widest_tick(cr, m, s) + label;
}

static void draw_bar(cairo_t *cr, const chart_map *m, const chart_box *bar)
{
    enum { SHADES = 256 };
    uint32_t colour[SHADES];
    double rgb[3];
    for (int i = 0; i < SHADES; i++) ramp_colour(m, i / (SHADES - 1.0), rgb), colour[i] = pixel_of(rgb);
    draw_squares(cr, colour, 1, SHADES, bar);
    chart_grey(cr, 0.25);
    cairo_set_line_width(cr, 0.7);
    cairo_rectangle(cr, bar->left, bar->top, bar->right - bar->left, bar->bottom - bar->top);
    cairo_stroke(cr);
}

void chart_scale_draw(cairo_t *cr, const chart_map *m, const chart_scale *s, const chart_box *plot)
{
    if (!s->shown) return;
    chart_box bar = {plot->right + BAR_GAP, plot->top, plot->right + BAR_GAP + BAR_WIDTH, plot->bottom};
    bar_tick tick[MOST_TICKS];
    char label[CHART_TEXT];
    size_t count = bar_ticks(m, &s->axis, tick);
    double right = bar.right + BAR_TEXT + widest_tick(cr, m, s);
    draw_bar(cr, m, &bar);
    for (size_t i = 0; i < count; i++) {
        double y = bar.bottom - chart_axis_part(&s->axis, tick[i].at) * (bar.bottom - bar.top);
        cairo_move_to(cr, bar.right, y), cairo_line_to(cr, bar.right + BAR_TICK, y);
        cairo_stroke(cr);
        chart_text(cr, bar.right + BAR_TEXT, y + 0.35 * CHART_SMALL, 0, HUGE_VAL, tick[i].text);
    }
    double high = bar.bottom - bar.top + 12; /* a label may be longer than the bar */
    if (!chart_axis_label(&s->axis, m->label, true, label)) return;
    chart_font_within(cr, CHART_NORMAL, high, label);
    chart_text_up(cr, right + BAR_LABEL, (bar.top + bar.bottom) / 2, high, label);
}

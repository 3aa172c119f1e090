// SPDX-License-Identifier: MIT
/* chart_axis.c - ranges, ticks and their numbers.
 *
 * Ticks are 1, 2 or 5 times a power of ten apart.  All numbers of an axis have the same decimals.  If they
 * were longer than five or six digits, the axis has a power of ten, a multiple of three, in its unit.  If the
 * values agree in more than that, the axis counts from an origin that its label names.
 *
 * Values are shown up to 1e300, so that no difference of two overflows, and to within 1e-300.  A range of
 * less than 1e-12 of its values is widened: below that the steps of double numbers begin to show. */
#include "chart_draw.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double LARGEST = 1e300, SMALLEST = 1e-300, NARROWEST = 1e-12, MARGIN_PART = 0.05,
                    MOST_STEPS = 1e5; /* from 0 to the farthest tick without an origin */
enum { LONGEST_ORIGIN = 15 };
#define MINUS "\342\210\222"
#define TIMES "\303\227"

bool chart_finite(double value) { return fabs(value) <= LARGEST; }

chart_range chart_range_none(void) { return (chart_range){{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}}; }

void chart_range_add(double pair[2], double value)
{
    if (!chart_finite(value)) return;
    pair[0] = fmin(pair[0], value), pair[1] = fmax(pair[1], value);
}

/* An empty or too narrow range is made wider. */
static void widen_axis(chart_axis *a)
{
    double size = fmax(fabs(a->low), fabs(a->high)), middle = a->low / 2 + a->high / 2;
    if (!(a->low <= a->high)) {
        a->low = 0, a->high = 1;
    } else if (!(a->high - a->low >= fmax(SMALLEST, NARROWEST * size))) {
        double half = fabs(middle) > SMALLEST ? MARGIN_PART * fabs(middle) : 1;
        a->low = middle - half, a->high = middle + half;
    }
}

chart_axis chart_axis_of(const chart_range *r)
{
    chart_axis a = {.low = fmin(r->fixed[0], r->free[0]), .high = fmax(r->fixed[1], r->free[1])};
    double margin = a.low < a.high ? MARGIN_PART * (a.high - a.low) : 0;
    if (r->free[0] < r->fixed[0]) a.low -= margin;
    if (r->free[1] > r->fixed[1]) a.high += margin;
    widen_axis(&a);
    return a;
}

/* ------------------------------------------------------------------ ticks */

static int power_of(double x) { return (int)floor(log10(x) + 1e-9); }

long chart_axis_first(const chart_axis *a) { return (long)ceil((a->low - a->origin) / a->step - 1e-6); }

long chart_axis_last(const chart_axis *a) { return (long)floor((a->high - a->origin) / a->step + 1e-6); }

double chart_axis_part(const chart_axis *a, double value) { return (value - a->low) / (a->high - a->low); }

/* The origin is the shortest number within a few lengths of the range. */
static void set_origin(chart_axis *a)
{
    a->origin = 0;
    if (fmax(fabs(a->low), fabs(a->high)) / a->step <= MOST_STEPS) return;
    double middle = a->low / 2 + a->high / 2;
    for (int digits = 1; digits <= LONGEST_ORIGIN; digits++) {
        char text[40];
        snprintf(text, sizeof text, "%.*g", digits, middle);
        a->origin = strtod(text, NULL);
        if (fabs(a->origin - middle) <= 5 * (a->high - a->low)) return;
    }
}

void chart_axis_ticks(chart_axis *a, double length, double spacing)
{
    static const struct {
        double step;
        int minor;
    } nice[] = {{1, 5}, {2, 4}, {5, 5}, {10, 5}};
    double least = (a->high - a->low) * fmin(spacing / length, 1), ten = pow(10, power_of(least));
    int i = 0;
    while (i < 3 && nice[i].step * ten < least * (1 - 1e-9)) i++;
    a->step = nice[i].step * ten, a->minor = nice[i].minor;
    set_origin(a);
    double most = a->step * (double)labs(chart_axis_first(a));
    most = fmax(most, a->step * (double)labs(chart_axis_last(a)));
    if (most == 0) most = a->step;
    int below = power_of(a->step);
    a->exponent = most >= 1e5 || below < -4 ? 3 * (int)floor(power_of(most) / 3.0) : 0;
    a->decimals = a->exponent > below ? a->exponent - below : 0;
}

void chart_axis_ticks_beside(cairo_t *cr, chart_axis *a, double length)
{
    const double apart = 9;
    double spacing = fmax(24, length / 9);
    for (int i = 0; i < 6; i++) { /* a second round is rare: numbers of longer steps are shorter */
        chart_axis_ticks(a, length, spacing);
        double wide = chart_axis_width(cr, a) + apart, step = a->step / (a->high - a->low) * length;
        if (step >= wide) return;
        spacing = fmax(wide, 1.01 * step);
    }
}

/* ---------------------------------------------------------------- numbers */

/* Appends, as far as there is room. */
static void chart_append(char text[CHART_TEXT], const char *more)
{
    size_t length = strlen(text);
    snprintf(text + length, CHART_TEXT - length, "%s", more);
}

/* A number as printf writes it, with the sign of mathematics and no sign of zero. */
static void append_signed(char text[CHART_TEXT], const char *number)
{
    bool zero = strspn(number, "-0.") == strlen(number);
    if (*number == '-' && !zero) chart_append(text, MINUS);
    chart_append(text, number + (*number == '-'));
}

static void append_power(char text[CHART_TEXT], int exponent)
{
    static const char *const raised[] = {"\342\201\260", "\302\271",     "\302\262",     "\302\263",
                                         "\342\201\264", "\342\201\265", "\342\201\266", "\342\201\267",
                                         "\342\201\270", "\342\201\271"};
    char digits[16];
    snprintf(digits, sizeof digits, "%d", abs(exponent));
    chart_append(text, exponent < 0 ? "10\342\201\273" : "10");
    for (const char *d = digits; *d; d++) chart_append(text, raised[*d - '0']);
}

void chart_axis_number(const chart_axis *a, long i, char text[CHART_TEXT])
{
    char number[60];
    int below = power_of(a->step);
    double leading = a->step / pow(10, below); /* 1, 2 or 5; the product below does not underflow */
    snprintf(number, sizeof number, "%.*f", a->decimals, (double)i * leading * pow(10, below - a->exponent));
    *text = 0;
    append_signed(text, number);
}

double chart_axis_width(cairo_t *cr, const chart_axis *a)
{
    double widest = 0;
    char text[CHART_TEXT];
    chart_font(cr, CHART_SMALL, false);
    for (long i = chart_axis_first(a); i <= chart_axis_last(a); i++) {
        chart_axis_number(a, i, text);
        widest = fmax(widest, chart_width(cr, text));
    }
    return widest;
}

void chart_number(double value, const char *unit, char text[CHART_TEXT])
{
    char number[60];
    int power = value == 0 ? 0 : power_of(fabs(value));
    bool plain = power >= -3 && power < 5;
    snprintf(number, sizeof number, "%.6g", plain ? value : value / pow(10, power));
    *text = 0;
    if (plain || strcmp(number, "1") != 0) append_signed(text, number);
    if (!plain && *text) chart_append(text, " " TIMES " ");
    if (!plain) append_power(text, power);
    if (unit && *unit) chart_append(text, " "), chart_append(text, unit);
}

/* ----------------------------------------------------------------- labels */

/* Where the bracket of the unit opens; NULL: there is none. */
static const char *unit_in(const char *label)
{
    const char *open = strrchr(label, '(');
    return open && label[strlen(label) - 1] == ')' ? open : NULL;
}

void chart_unit(const char *label, char text[CHART_TEXT])
{
    const char *open = label ? unit_in(label) : NULL;
    *text = 0;
    if (open) snprintf(text, CHART_TEXT, "%.*s", (int)strlen(open) - 2, open + 1);
}

bool chart_axis_label(const chart_axis *a, const char *label, bool numbers, char text[CHART_TEXT])
{
    char number[60], unit[CHART_TEXT];
    if (!label) label = "";
    const char *open = unit_in(label);
    int length = open ? (int)(open - label) : (int)strlen(label);
    while (length > 0 && label[length - 1] == ' ') length--;
    snprintf(text, CHART_TEXT, "%.*s", length, label);
    if (!numbers) return *text;
    chart_unit(label, unit);
    if (!*unit && a->exponent == 0 && a->origin == 0) return *text;
    chart_append(text, *text ? " (" : "(");
    if (a->exponent != 0) append_power(text, a->exponent);
    if (a->exponent != 0 && *unit) chart_append(text, " ");
    chart_append(text, unit);
    if (a->origin != 0) {
        snprintf(number, sizeof number, "%.*g", LONGEST_ORIGIN, a->origin);
        chart_append(text, a->exponent != 0 || *unit ? " from " : "from ");
        append_signed(text, number);
        if (*unit) chart_append(text, " "), chart_append(text, unit);
    }
    chart_append(text, ")");
    return true;
}

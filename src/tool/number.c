/* number.c - doubles as text.
 *
 * strtod and printf round correctly in the C library this is built with, and the
 * command never sets a locale, so a point is a point. */
#include "number.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool named(const char *text, const char *name)
{
    return strcasecmp(text, name) == 0 || (*text == '.' && strcasecmp(text + 1, name) == 0);
}

bool number_read(const char *text, double *value)
{
    const char *bare = text + (*text == '+' || *text == '-');
    double sign = *text == '-' ? -1 : 1;
    if (named(bare, "inf")) return *value = sign * HUGE_VAL, true;
    if (named(bare, "nan")) return *value = (double)NAN, true;
    if (!strchr("0123456789.", *bare) || !*bare) return false; /* strtod takes blanks, "infinity", "nan(x)" */
    char *end;
    *value = strtod(text, &end);
    return end != text && *end == 0 && isfinite(*value);
}

bool number_read_integer(const char *text, long lowest, long highest, long *value)
{
    if (!strchr("+-0123456789", *text)) return false;
    char *end;
    errno = 0;
    *value = strtol(text, &end, 10);
    return end != text && *end == 0 && errno == 0 && *value >= lowest && *value <= highest;
}

/* Prints the shortest decimal that reads back; how many digits it took. */
static int shortest(char text[NUMBER_SIZE], double value)
{
    for (int digits = 15;; digits++) {
        snprintf(text, NUMBER_SIZE, "%.*g", digits, value);
        if (digits == 17 || strtod(text, NULL) == value) return digits;
    }
}

void number_print(char text[NUMBER_SIZE], double value, bool hexadecimal)
{
    if (!isfinite(value)) {
        snprintf(text, NUMBER_SIZE, "%s", isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
        return;
    }
    if (hexadecimal) {
        snprintf(text, NUMBER_SIZE, "%a", value);
        return;
    }
    shortest(text, value);
}

/* Of the digits that were left out, counted in the last that was not: 0.4 of it, say, or
 * 0.6, where it was rounded up.  41 digits leave out 2^-80 of the value themselves. */
double number_print_gap(double value)
{
    char text[2 * NUMBER_SIZE], rest[3 * NUMBER_SIZE], unit[NUMBER_SIZE];
    if (!isfinite(value) || value == 0) return 0;
    int digits = shortest(unit, value);
    snprintf(text, sizeof text, "%.40e", fabs(value)); /* d.ddd ... e+dd */
    char *e = strchr(text, 'e');
    int last = (int)strtol(e + 1, NULL, 10) - digits + 1;
    *e = 0;
    snprintf(rest, sizeof rest, "0.%se%d", text + digits + 1, last);
    snprintf(unit, sizeof unit, "1e%d", last);
    double gap = strtod(rest, NULL);
    return fmin(gap, strtod(unit, NULL) - gap) * (1 + 0x1p-50);
}

void number_print_short(char text[NUMBER_SIZE], double value, int digits)
{
    if (isnan(value)) snprintf(text, NUMBER_SIZE, "-");
    else snprintf(text, NUMBER_SIZE, "%.*g", digits, value == 0 ? 0.0 : value);
}

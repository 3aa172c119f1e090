// SPDX-License-Identifier: MIT
/* effects.c - what a setting changes against the base, in words. */
#include "trade.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void say(setting *s, const char *format, ...) LIKE_PRINTF(2, 3);

static void say(setting *s, const char *format, ...)
{
    size_t length = strlen(s->effect);
    va_list values;
    if (length) length += (size_t)snprintf(s->effect + length, sizeof s->effect - length, "; ");
    va_start(values, format);
    vsnprintf(s->effect + length, sizeof s->effect - length, format, values);
    va_end(values);
}

/* 1.52 becomes 1.5, 15.2 becomes 15, 152.3 becomes 152. */
static double two_digits(double x) { return x < 100 ? measure_rounded(x, 2) : measure_rounded(x, 3); }

static void say_more(setting *s, size_t now, size_t before, const char *what)
{
    if (now == before) return;
    size_t n = now > before ? now - before : before - now;
    say(s, "%zu %s ray%s %s", n, now > before ? "more" : "fewer", n == 1 ? "" : "s", what);
}

static void find_effect(setting *s, const setting *base)
{
    if (measure_slower(base, s)) say(s, "%.15g times as fast", two_digits(base->ns / s->ns));
    if (measure_slower(s, base)) say(s, "%.15g times as slow", two_digits(s->ns / base->ns));
    if (isnan(s->error_99) && !isnan(base->error_99)) say(s, "no hit is left");
    else if (s->error_99 > MEASURE_SAME_ERROR * base->error_99 ||
             base->error_99 > MEASURE_SAME_ERROR * s->error_99)
        say(s, "err_99 %.2g, not %.2g", s->error_99, base->error_99);
    say_more(s, s->undecided, base->undecided, "undecided");
    say_more(s, s->wrong, base->wrong, "wrong");
    if (*s->effect) return;
    bool apart = s->ns > MEASURE_SAME_TIME * base->ns || base->ns > MEASURE_SAME_TIME * s->ns;
    say(s, "%s",
        apart            ? "nothing beyond the scatter of the runs"
        : measure_gives(base, s) ? "changes nothing"
                         : "costs nothing");
}

void trade_say_effects(trade *t)
{
    for (size_t i = 0; i < t->count; i++) {
        trade_case *c = &t->list[i];
        const setting *base = measure_base(c);
        for (size_t k = 0; k < c->settings && base; k++)
            if (&c->setting[k] != base) find_effect(&c->setting[k], base);
    }
}

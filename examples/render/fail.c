// SPDX-License-Identifier: MIT
/* fail.c - what is said of an error, and the status the program ends with. */
#include "fail.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

LIKE_PRINTF(1, 0) static void say(const char *format, va_list values)
{
    fputs("render: ", stderr);
    vfprintf(stderr, format, values);
    fputc('\n', stderr);
}

void fail_usage(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    say(format, values);
    va_end(values);
    fail_hint();
}

void fail_hint(void)
{
    fputs("Try: render --help\n", stderr);
    exit(EXIT_USAGE);
}

void fail_input(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    say(format, values);
    va_end(values);
    exit(EXIT_BAD_INPUT);
}

void *room(void *old, size_t n, size_t size)
{
    void *p = realloc(old, n * size);
    if (!p) fail_input("out of memory for %zu times %zu bytes", n, size);
    return p;
}

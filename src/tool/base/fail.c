// SPDX-License-Identifier: MIT
/* fail.c - an error ends the command where it is found.
 *
 * At exit all memory is freed (memory.c), but not while other threads may still use it.  An error in the
 * input leaves no half a table: all input is read before the first line is written.
 */
#include "fail.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

static const char *running = "";
static atomic_bool at_work; /* other threads */
static void (*first)(void);

void fail_in_threads(bool now) { at_work = now; }

void fail_first(void (*tidy)(void)) { first = tidy; }

void fail_tidy(void)
{
    if (first) first();
}

void fail_name(const char *command) { running = command; }

LIKE_PRINTF(2, 0) static void say_after(const char *prefix, const char *format, va_list values)
{
    fputs(prefix, stderr);
    vfprintf(stderr, format, values);
    fputc('\n', stderr);
}

LIKE_PRINTF(1, 0) static void say(const char *format, va_list values)
{
    say_after("sagitta: ", format, values);
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
    fprintf(stderr, "Try: sagitta%s%s --help\n", *running ? " " : "", running);
    exit(EXIT_USAGE);
}

void fail_input(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    say(format, values);
    va_end(values);
    if (at_work) fail_tidy();
    if (at_work) _Exit(EXIT_BAD_INPUT);
    exit(EXIT_BAD_INPUT);
}

void print_and_end(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vprintf(format, values);
    va_end(values);
    if (fflush(stdout) != 0 || ferror(stdout)) fail_input("standard output: could not be written");
    exit(EXIT_DECIDED);
}

void note(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    say(format, values);
    va_end(values);
}

void remark(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    say_after("", format, values);
    va_end(values);
}

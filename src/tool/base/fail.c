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
#include <string.h>

static const char *running = "";
static atomic_bool at_work; /* other threads */
enum { FIRST_MOST = 4 };
static void (*first[FIRST_MOST])(void);
static int firsts;
static bool always(void) { return true; }
static void end_at_once(int status) { (void)status; }
static fail_speaker speaker = {"sagitta: ", always, always, end_at_once};

void fail_as(const fail_speaker *s) { speaker = *s; }

void fail_in_threads(bool now) { at_work = now; }

void fail_first(void (*tidy)(void))
{
    if (firsts < FIRST_MOST) first[firsts++] = tidy;
}

void fail_tidy(void)
{
    for (int i = 0; i < firsts; i++) first[i]();
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
    say_after(speaker.who, format, values);
}

_Noreturn static void end(exit_status status)
{
    speaker.end((int)status);
    if (at_work) fail_tidy();
    if (at_work) _Exit((int)status);
    exit((int)status);
}

_Noreturn static void hint(bool said)
{
    if (said) fprintf(stderr, "Try: sagitta%s%s --help\n", *running ? " " : "", running);
    end(EXIT_USAGE);
}

void fail_usage(const char *format, ...)
{
    const bool speaks = speaker.fails();
    va_list values;
    va_start(values, format);
    if (speaks) say(format, values);
    va_end(values);
    hint(speaks);
}

void fail_hint(const char *near)
{
    const bool speaks = speaker.fails();
    if (speaks && near) fprintf(stderr, "Did you mean --%s?  ", near);
    hint(speaks);
}

bool fail_is_slip(const char *word, const char *other)
{
    const char *a = word, *b = other;
    while (*a && *a == *b) a++, b++;
    if (!*a && !*b) return false;
    return (*a && (strcmp(a + 1, b) == 0 || (*b && strcmp(a + 1, b + 1) == 0)))
           || (*b && strcmp(a, b + 1) == 0)
           || (*a && a[1] && a[0] == b[1] && a[1] == b[0] && strcmp(a + 2, b + 2) == 0);
}

void fail_input(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (speaker.fails()) say(format, values);
    va_end(values);
    end(EXIT_BAD_INPUT);
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
    if (speaker.notes()) say(format, values);
    va_end(values);
}

void remark(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (speaker.notes()) say_after("", format, values);
    va_end(values);
}

// SPDX-License-Identifier: MIT
/* tool.h - the readers of the command, run inside a fuzz target.
 *
 * They end the command where they find an error (fail.h), and take their text from a file.  Here an error
 * ends the reading and leaves its message, the text comes from memory, and all blocks are freed after each
 * input: fail.c and input.c are replaced, memory.c is taken in whole.  A file that the text names holds
 * what stands in the input behind its first byte 0xff, which no text has. */
#ifndef TESTS_FUZZ_TOOL_H
#define TESTS_FUZZ_TOOL_H

#include "fuzz.h"

#include <setjmp.h>
#include <stdarg.h>

#include "../../src/tool/base/fail.h"
#include "../../src/tool/base/input.h"
#include "../../src/tool/base/memory.c"

static jmp_buf refused;
static char message[2000], noted[2000];
static int message_length;
static exit_status status; /* EXIT_DECIDED: not refused */
static struct { const uint8_t *data, *file; size_t size, file_size; } given;

LIKE_PRINTF(3, 0) static void say(exit_status s, char to[2000], const char *format, va_list values)
{
    message_length = vsnprintf(to, 2000, format, values);
    if (s) status = s;
}

void fail_name(const char *command) { (void)command; }
void fail_hint(const char *near) { (void)near; longjmp(refused, 1); }
bool fail_is_slip(const char *word, const char *other) { return strcmp(word, other) == 0; }

void fail_usage(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    say(EXIT_USAGE, message, format, values);
    va_end(values);
    longjmp(refused, 1);
}

void fail_input(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    say(EXIT_BAD_INPUT, message, format, values);
    va_end(values);
    longjmp(refused, 1);
}

void note(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    say(EXIT_DECIDED, noted, format, values);
    va_end(values);
}

input input_read(const char *path)
{
    return (input){
        .name = path, .text = memory_text((const char *)given.data, given.size), .length = given.size};
}

input input_map(const char *path, bool *mapped)
{
    *mapped = false;
    return input_read(path);
}

void input_note(const void *from, size_t size) { (void)from, (void)size; }

void input_leave(const void *from, size_t length) { (void)from, (void)length; }

const char *input_try(const char *path, input *in)
{
    *in = (input){.name = path};
    if (!given.file) return "there is none";
    in->text = memory_text((const char *)given.file, given.file_size), in->length = given.file_size;
    return NULL;
}

/* How long the text is that stands before a file's. */
static UNUSED size_t split(const uint8_t *data, size_t size)
{
    given.file = size ? memchr(data, 0xff, size) : NULL;
    if (!given.file) return given.file_size = 0, size;
    size_t text = (size_t)(given.file - data);
    given.file++, given.file_size = size - text - 1;
    return text;
}

static UNUSED void read_anew(const uint8_t *data, size_t size)
{
    free_all();
    given.data = data, given.size = size;
    message[0] = noted[0] = 0, message_length = 0;
    status = EXIT_DECIDED;
}

/* At most so many lines: YAML ends one at \r, at U+0085, U+2028 and U+2029 too. */
static UNUSED size_t lines_of(const uint8_t *data, size_t size)
{
    size_t lines = 1;
    for (size_t i = 0; i + 1 < size; i++)
        lines += data[i] == '\n' || data[i] == '\r' || data[i] == 0x85 || data[i] == 0xa8 ||
                 data[i] == 0xa9 || data[i] == 0x28 || data[i] == 0x29;
    return lines;
}

#endif

// SPDX-License-Identifier: MIT
/* input.h - a file, read whole or mapped. */
#ifndef TOOL_INPUT_H
#define TOOL_INPUT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct input {
    const char *name;   /* for messages */
    char *text;         /* [length + 1], ends in a zero byte */
    size_t length;
} input;

/* Reads a file; "-" is standard input.  A file that cannot be read ends the command. */
input input_read(const char *path);

/* Reads a file of that name, even if it is "-".  Returns NULL, or why it cannot be read. */
const char *input_try(const char *path, input *in);

/* A file whose bytes are not changed, and end in no zero byte: mapped where that can be, else read whole.
 * One that cannot be read ends the command; so does one that becomes shorter while it is mapped. */
input input_map(const char *path, bool *mapped);

/* Ends the command if a mapped file was cut, or written to, since it was mapped.  To be asked when all is
 * read. */
void input_check(void);

/* A digest of all that was read whole, and of what was noted besides: of files that are mapped. */
void     input_note(const void *bytes, size_t size);
uint64_t input_digest(void);

/* The same file, of which nothing is read any more. */
void input_unmap(const char *text);

/* Gives memory of a mapped file back until it is read again; pages that are only in part here stay. */
void input_leave(const void *from, size_t length);

/* Ends with a usage error if the path, under any name, is a file that was read or reserved. */
void output_check(const char *option, const char *path);

/* The same, and reserves it; an error if it cannot be opened.  Its content is kept until it is written. */
void output_reserve(const char *option, const char *path);

/* Where a file is written that is to be at the path when it is whole: in a run of ranks beside it, under a
 * name that output_whole changes, and that is gone if the command fails.  In other runs, and if something at
 * the path is no plain file, it is the path. */
const char *output_name(const char *path);
void output_stays(const char *name); /* even if the command fails: another run may go on with it */
void output_whole(const char *option, const char *name, const char *path); /* a fault ends the command */

/* Writes a text to the file of --output (NULL: standard output).  If it cannot be written the command
 * ends. */
void output_write(const char *path, const char *text, size_t length);

/* The same to a file that was reserved for an option. */
void output_fill(const char *option, const char *path, const char *text, size_t length);

#endif

/* input.h - a file, read whole. */
#ifndef TOOL_INPUT_H
#define TOOL_INPUT_H
#include <stddef.h>

typedef struct input {
    const char *name;   /* for messages */
    char *text;         /* a zero byte stands behind it */
    size_t length;
} input;

/* path "-": standard input.  A file that cannot be read ends the command. */
input input_read(const char *path);

/* A file of that name, be it "-"; NULL, or why it cannot be read. */
const char *input_try(const char *path, input *in);

/* A usage error if the path is a file that was read, or that is reserved, by whatever name. */
void output_check(const char *option, const char *path);

/* The same, and an error if it cannot be opened; what is in it stays, until it is written. */
void output_reserve(const char *option, const char *path);

#endif

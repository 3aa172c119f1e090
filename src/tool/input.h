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

#endif

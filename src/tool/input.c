/* input.c - a file, or standard input, read whole. */
#include "input.h"

#include "fail.h"
#include "memory.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

input input_read(const char *path)
{
    bool standard = strcmp(path, "-") == 0;
    input in = {.name = standard ? "standard input" : path};
    FILE *file = standard ? stdin : fopen(path, "rb");
    if (!file) fail_input("%s: %s", in.name, strerror(errno));
    size_t capacity = 0;
    for (size_t got = 1; got > 0; in.length += got) {
        capacity = 2 * in.length + 65536;
        in.text = memory_grow(in.text, capacity, 1);
        got = fread(in.text + in.length, 1, capacity - in.length - 1, file);
    }
    int error = ferror(file) ? errno : 0;
    if (!standard) fclose(file);
    if (error) fail_input("%s: %s", in.name, strerror(error));
    in.text[in.length] = 0;
    return in;
}

/* input.c - a file, or standard input, read whole; and that none is written over. */
#include "input.h"

#include "fail.h"
#include "memory.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* The files in use, by what they are and not by what they are called. */
enum { USED_MOST = 4 };
static struct { struct stat is; const char *name; } used[USED_MOST];
static int used_count;

static void remember(FILE *file, const char *name)
{
    struct stat is;
    if (used_count == USED_MOST || fstat(fileno(file), &is) != 0 || !S_ISREG(is.st_mode)) return;
    used[used_count].is = is;
    used[used_count++].name = name;
}

void output_check(const char *option, const char *path)
{
    struct stat is;
    if (stat(path, &is) != 0) return;
    for (int i = 0; i < used_count; i++)
        if (is.st_dev == used[i].is.st_dev && is.st_ino == used[i].is.st_ino)
            fail_usage("--%s %s: would be written over %s", option, path, used[i].name);
}

void output_reserve(const char *option, const char *path)
{
    output_check(option, path);
    FILE *file = fopen(path, "ab");
    if (!file) fail_input("%s: %s", path, strerror(errno));
    remember(file, "the picture of --svg");
    fclose(file);
}

input input_read(const char *path)
{
    bool standard = strcmp(path, "-") == 0;
    input in = {.name = standard ? "standard input" : path};
    FILE *file = standard ? stdin : fopen(path, "rb");
    if (!file) fail_input("%s: %s", in.name, strerror(errno));
    remember(file, in.name);
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

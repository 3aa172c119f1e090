// SPDX-License-Identifier: MIT
/* output.c - a file is written beside its place and renamed: POSIX's rename replaces at once or not at all.
 *
 * The temporary name has the process in it, so two runs do not write into each other's.  A run that is
 * killed while it writes leaves one behind, FILE.PID.part, which nothing ever reads.  A symbolic link is
 * followed first: what it leads to is replaced, and not the link. */
#include "output.h"

#include "fail.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void bytes_add(bytes *b, const void *from, size_t n)
{
    if (b->room < b->n + n) b->at = room(b->at, b->room = 2 * (b->n + n), 1);
    if (n) memcpy(b->at + b->n, from, n);
    b->n += n;
}

/* Where the bytes go: the file itself if it is no ordinary one, else its temporary name. */
typedef struct target {
    char file[PATH_MAX], temporary[PATH_MAX + 40];
    bool plain;
} target;

static target target_of(const char *file)
{
    target t = {.plain = true};
    struct stat is;
    char *real = realpath(file, NULL);
    const char *name = real ? real : file;
    if (strlen(name) >= sizeof t.file) fail_input("%s: %s", file, strerror(ENAMETOOLONG));
    memcpy(t.file, name, strlen(name) + 1);
    free(real);
    if (stat(t.file, &is) == 0) {
        if (S_ISDIR(is.st_mode)) fail_input("%s: %s", file, strerror(EISDIR));
        t.plain = S_ISREG(is.st_mode);
        if (access(t.file, W_OK) != 0) fail_input("%s: %s", file, strerror(errno));
    }
    if (t.plain)
        snprintf(t.temporary, sizeof t.temporary, "%s.%ld.part", t.file, (long)getpid());
    else
        memcpy(t.temporary, t.file, sizeof t.file);
    return t;
}

void output_try(const char *file)
{
    const target t = target_of(file);
    if (!t.plain) return;
    FILE *out = fopen(t.temporary, "wb");
    if (!out) fail_input("%s: %s", file, strerror(errno));
    fclose(out);
    remove(t.temporary);
}

void output_write(const char *file, const bytes *b)
{
    const target t = target_of(file);
    FILE *out = fopen(t.temporary, "wb");
    if (!out) fail_input("%s: %s", file, strerror(errno));
    bool good = fwrite(b->at, 1, b->n, out) == b->n && fflush(out) == 0;
    int error = errno;
    if (fclose(out) != 0 && good) good = false, error = errno;
    if (good && t.plain && rename(t.temporary, t.file) != 0) good = false, error = errno;
    if (good) return;
    if (t.plain) remove(t.temporary);
    fail_input("%s: %s", file, strerror(error));
}

bool output_read(const char *file, bytes *to)
{
    FILE *in = fopen(file, "rb");
    if (!in) return false;
    unsigned char part[4096];
    for (size_t n; (n = fread(part, 1, sizeof part, in)) > 0;) bytes_add(to, part, n);
    bool good = !ferror(in);
    fclose(in);
    return good;
}

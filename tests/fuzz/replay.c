// SPDX-License-Identifier: MIT
/* replay.c - feeds files to a fuzz target: past findings and the corpus as a test, with any compiler.
 *
 * Each argument is a file or a folder.  The name of a file is printed before it is fed, to be read where it
 * is the one that fails; a folder that holds nothing is an error, for a test of nothing cannot fail. */
#include "fuzz.h"

#include <dirent.h>
#include <sys/stat.h>

static char current[1024];
static long fed;

static int feed(const char *path)
{
    FILE *file = fopen(path, "rb");
    size_t size = 0, room = 1 << 12, got;
    uint8_t *data = malloc(room), *exact;
    if (!file || !data) return fprintf(stderr, "%s: cannot be read\n", path), 1;
    while ((got = fread(data + size, 1, room - size, file)) > 0) {
        size += got;
        if (size == room && !(data = realloc(data, room *= 2)))
            return fprintf(stderr, "%s: out of memory\n", path), 1;
    }
    fclose(file);
    exact = malloc(size ? size : 1); /* a sanitizer then sees a byte beyond it */
    if (!exact) return 1;
    memcpy(exact, data, size);
    free(data);
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
    fed++;
    return 0;
}

static int feed_all(const char *path)
{
    struct stat is;
    if (stat(path, &is) != 0) return fprintf(stderr, "%s: not there\n", path), 1;
    if (!S_ISDIR(is.st_mode)) return feed(path);
    DIR *folder = opendir(path);
    if (!folder) return fprintf(stderr, "%s: cannot be read\n", path), 1;
    int fault = 0;
    long before = fed;
    for (struct dirent *entry; !fault && (entry = readdir(folder));) {
        if (entry->d_name[0] == '.') continue;
        snprintf(current, sizeof current, "%s/%s", path, entry->d_name);
        printf("%s\n", current);
        fflush(stdout);
        fault = feed(current);
    }
    closedir(folder);
    if (fed == before) return fprintf(stderr, "%s: empty\n", path), 1;
    return fault;
}

int main(int count, char *argument[])
{
    for (int i = 1; i < count; i++)
        if (feed_all(argument[i])) return 1;
    printf("%ld inputs\n", fed);
    return fed == 0;
}

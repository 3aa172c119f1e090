// SPDX-License-Identifier: MIT
/* input.c - reads a file or standard input whole, or maps it, and keeps output from overwriting an input. */
#define _DEFAULT_SOURCE /* madvise */
#include "input.h"

#include "digest.h"
#include "fail.h"
#include "memory.h"
#include "ranks.h"

#include <errno.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* The files in use, told apart by device and inode, since a file can have several names. */
typedef struct used_file {
    struct stat is;
    const char *name;
    const char *text, *shorter; /* of one that is mapped: its bytes; what is said if some are gone */
} used_file;
static used_file *used;
static size_t used_count, used_room;

static void remember(FILE *file, const char *name)
{
    struct stat is;
    if (fstat(fileno(file), &is) != 0 || !S_ISREG(is.st_mode)) return;
    used = memory_room(used, used_count, &used_room, sizeof *used);
    used[used_count++] = (used_file){.is = is, .name = memory_text(name, strlen(name))};
}

void output_check(const char *option, const char *path)
{
    struct stat is;
    if (stat(path, &is) != 0) return;
    for (size_t i = 0; i < used_count; i++)
        if (is.st_dev == used[i].is.st_dev && is.st_ino == used[i].is.st_ino)
            fail_usage("--%s %s: would be written over %s, which is in use", option, path, used[i].name);
}

void output_reserve(const char *option, const char *path)
{
    output_check(option, path);
    path = output_name(path);
    FILE *file = fopen(path, "ab");
    if (!file) fail_input("--%s %s: %s", option, path, strerror(errno));
    char name[40];
    snprintf(name, sizeof name, "the file of --%.15s", option);
    remember(file, name);
    fclose(file);
}

/* Those that are not yet whole. */
static const char **unfinished;
static size_t unfinished_count, unfinished_room;

static void remove_outputs(void)
{
    for (size_t i = 0; i < unfinished_count; i++)
        if (unfinished[i]) remove(unfinished[i]);
}

void output_stays(const char *name)
{
    for (size_t i = 0; i < unfinished_count; i++)
        if (unfinished[i] == name) unfinished[i] = NULL;
}

const char *output_name(const char *path)
{
    struct stat is;
    if (!ranks_are() || (lstat(path, &is) == 0 && !S_ISREG(is.st_mode))) return path;
    const char *name = memory_print("%s.unfinished", path);
    for (size_t i = 0; i < unfinished_count; i++)
        if (unfinished[i] && strcmp(unfinished[i], name) == 0) return unfinished[i];
    if (!unfinished_count) atexit(remove_outputs), fail_first(remove_outputs);
    unfinished = memory_room(unfinished, unfinished_count, &unfinished_room, sizeof *unfinished);
    return unfinished[unfinished_count++] = name;
}

void output_whole(const char *option, const char *name, const char *path)
{
    output_stays(name);
    if (name == path || rename(name, path) == 0) return;
    const char *why = strerror(errno);
    remove(name);
    fail_input("--%s %s: could not be written: %s", option, path, why);
}

void output_fill(const char *option, const char *path, const char *text, size_t length)
{
    const char *name = path ? output_name(path) : NULL;
    FILE *file = path ? fopen(name, "wb") : stdout;
    if (!file) fail_input("--%s %s: %s", option, path, strerror(errno));
    fwrite(text, 1, length, file);
    bool fine = fflush(file) == 0 && !ferror(file);
    if (path && fclose(file) != 0) fine = false;
    if (fine && path) output_whole(option, name, path);
    if (fine) return;
    if (path) fail_input("--%s %s: could not be written", option, path);
    fail_input("standard output: could not be written");
}

void output_write(const char *path, const char *text, size_t length)
{
    if (path) output_check("output", path);
    output_fill("output", path, text, length);
}

static uint64_t all_read;

void input_note(const void *bytes, size_t size) { all_read = digest_bytes(all_read, bytes, size); }
uint64_t input_digest(void) { return all_read; }

static const char *read_all(FILE *file, input *in)
{
    size_t capacity = 0;
    for (size_t got = 1; got > 0; in->length += got) {
        capacity = 2 * in->length + 65536;
        in->text = memory_grow(in->text, capacity, 1);
        got = fread(in->text + in->length, 1, capacity - in->length - 1, file);
    }
    in->text[in->length] = 0;
    return ferror(file) ? strerror(errno) : NULL;
}

const char *input_try(const char *path, input *in)
{
    *in = (input){.name = path};
    FILE *file = fopen(path, "rb");
    if (!file) return strerror(errno);
    remember(file, path);
    const char *fault = read_all(file, in);
    input_note(in->text, in->length);
    fclose(file);
    return fault;
}

/* A byte of a mapped file was asked for that is not there any more.  Other threads may be at work. */
static void end_shorter(int number, siginfo_t *at, void *unused)
{
    (void)number, (void)unused;
    for (size_t i = 0; i < used_count; i++) {
        const used_file *u = &used[i];
        const uintptr_t from = (uintptr_t)u->text, asked = (uintptr_t)at->si_addr;
        if (!u->text || asked < from || asked - from >= (size_t)u->is.st_size) continue;
        const ssize_t told = write(STDERR_FILENO, u->shorter, strlen(u->shorter));
        (void)told;
    }
    fail_tidy();
    _Exit(EXIT_BAD_INPUT);
}

/* Behind the end of a file its last page has zeros, and what is written into a file is seen in the map. */
void input_check(void)
{
    for (size_t i = 0; i < used_count; i++) {
        const struct stat *was = &used[i].is;
        struct stat is;
        if (!used[i].text || stat(used[i].name, &is) != 0) continue;
        if (is.st_dev != was->st_dev || is.st_ino != was->st_ino) continue; /* another file of that name */
        bool written = is.st_mtim.tv_sec != was->st_mtim.tv_sec || is.st_mtim.tv_nsec != was->st_mtim.tv_nsec;
        if (is.st_size < was->st_size || (written && is.st_size == was->st_size))
            fail_input("%s: it was changed while it was read", used[i].name);
    }
}

input input_map(const char *path, bool *mapped)
{
    input in = {.name = path};
    FILE *file = fopen(path, "rb");
    if (!file) fail_input("%s: %s", path, strerror(errno));
    const size_t before = used_count;
    remember(file, path);
    used_file *u = used_count > before && used[before].is.st_size > 0 ? &used[before] : NULL; /* plain */
    void *at = u ? mmap(NULL, (size_t)u->is.st_size, PROT_READ, MAP_PRIVATE, fileno(file), 0) : MAP_FAILED;
    *mapped = at != MAP_FAILED;
    if (*mapped) {
        u->text = at, u->shorter = memory_print("sagitta: %s: it became shorter while it was read\n", path);
        sigaction(SIGBUS, &(struct sigaction){.sa_sigaction = end_shorter, .sa_flags = SA_SIGINFO}, NULL);
        in.text = at, in.length = (size_t)u->is.st_size;
    } else {
        const char *fault = read_all(file, &in);
        if (fault) fail_input("%s: %s", path, fault);
    }
    fclose(file);
    return in;
}

void input_unmap(const char *text)
{
    for (size_t i = 0; i < used_count && text; i++) {
        if (used[i].text != text) continue;
        munmap((char *)(uintptr_t)text, (size_t)used[i].is.st_size);
        used[i] = used[--used_count];
        return;
    }
}

void input_leave(const void *from, size_t length)
{
#ifdef MADV_DONTNEED
    const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), end = (uintptr_t)from + length;
    const uintptr_t begin = ((uintptr_t)from + page - 1) / page * page;
    if (end > begin) madvise((void *)begin, (end - begin) / page * page, MADV_DONTNEED);
#else
    (void)from, (void)length;
#endif
}

input input_read(const char *path)
{
    input in = {.name = "standard input"};
    bool standard = strcmp(path, "-") == 0;
    if (standard) remember(stdin, in.name);
    const char *fault = standard ? read_all(stdin, &in) : input_try(path, &in);
    if (standard) ranks_tell_text(&in.text, &in.length);
    if (standard) input_note(in.text, in.length);
    if (fault) fail_input("%s: %s", in.name, fault);
    return in;
}

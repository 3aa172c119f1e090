// SPDX-License-Identifier: MIT
/* part.c - the file of one shard, written so that what has its name is whole, and read so that it is known
 * to be.
 *
 * THE FORM (docs/scale.md).  Numbers have 8 bytes, in the order of the machine, which the second one tells.
 * A mark; the order; number, of, digest; the version and the arguments, each as a record.  Then the records:
 * a length, the bytes, zeros up to a multiple of 8.  Last a length of all bits set, how many records there
 * were, and the checksum of all bytes before.
 *
 * WHOLE.  A temporary file beside the path is written, asked to be on the disk, and renamed.  So a command
 * that is killed, or a disk that is full, leaves nothing with the name of a part.  A file that was cut or
 * changed later has no end, or another checksum. */
#include "part.h"

#include "digest.h"
#include "fail.h"
#include "input.h"
#include "memory.h"

#include <errno.h>
#include <sagitta/sagitta.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char MARK[8] = "sagpart1";
static const uint64_t ORDER = UINT64_C(0x0102030405060708), LAST = UINT64_MAX;
enum { WORD = 8, HEAD = 5 * WORD, TAIL = 3 * WORD };

/* ------------------------------------------------------------------------- writing */

static struct {
    const char *path;
    char *unfinished;
    FILE *file;
    bool brief;
    uint64_t sum, records;
} writing;

static void remove_unfinished(void)
{
    if (writing.file) fclose(writing.file), remove(writing.unfinished);
    writing.file = NULL;
}

/* Other threads may be writing: the file stays open. */
static void unlink_unfinished(void)
{
    if (writing.file) remove(writing.unfinished);
}

_Noreturn static void fail_writing(void)
{
    const char *why = strerror(errno);
    remove_unfinished();
    fail_input("--output %s: could not be written: %s", writing.path, why);
}

static void file_words(const void *bytes, size_t size)
{
    const char *at = bytes;
    if (size && fwrite(bytes, 1, size, writing.file) != size) fail_writing();
    for (uint64_t word; size; size -= WORD, at += WORD)
        memcpy(&word, at, WORD), writing.sum = digest_word(writing.sum, word);
}

static void file_word(uint64_t word) { file_words(&word, WORD); }

void part_put(const void *bytes, size_t size)
{
    char rest[WORD] = {0};
    const size_t over = size % WORD, whole = size - over;
    file_word(size), file_words(bytes, whole);
    if (over) memcpy(rest, (const char *)bytes + whole, over), file_words(rest, WORD);
    writing.records++;
}

/* A part is renamed to the path, and would take the place of a device, a link, a pipe. */
static void require_plain(const char *path)
{
    struct stat is;
    if (lstat(path, &is) == 0 && !S_ISREG(is.st_mode))
        fail_input("--output %s: no plain file, and a part would take its place; give another name", path);
}

void part_begin(const char *path, const part_of_run *of, bool brief)
{
    static bool registered;
    require_plain(path);
    memory_drop(writing.unfinished);
    writing.path = path, writing.unfinished = memory_print("%s.%ld.unfinished", path, (long)getpid());
    writing.brief = brief, writing.sum = 0;
    writing.file = fopen(writing.unfinished, "wb");
    if (!writing.file) fail_input("--output %s: %s", path, strerror(errno));
    setvbuf(writing.file, NULL, _IOFBF, 1 << 16);
    if (!registered) atexit(remove_unfinished), fail_first(unlink_unfinished);
    registered = true;
    file_words(MARK, WORD), file_word(ORDER), file_word(of->number), file_word(of->of), file_word(of->digest);
    part_put(sgt_version(), strlen(sgt_version()) + 1), part_put(of->arguments, of->length);
    writing.records = 0;
}

void part_end(void)
{
    file_word(LAST), file_word(writing.records);
    const uint64_t sum = writing.sum;
    if (fwrite(&sum, WORD, 1, writing.file) != 1 || fflush(writing.file) != 0) fail_writing();
    const bool kept = writing.brief || fsync(fileno(writing.file)) == 0 || errno == EINVAL || errno == ENOSYS;
    if (!kept) fail_writing();
    FILE *file = writing.file;
    writing.file = NULL;
    if (fclose(file) == 0 && rename(writing.unfinished, writing.path) == 0) return;
    const char *why = strerror(errno);
    remove(writing.unfinished);
    fail_input("--output %s: could not be written: %s", writing.path, why);
}

/* ------------------------------------------------------------------------- reading */

static uint64_t word_at(const char *at)
{
    uint64_t word;
    memcpy(&word, at, WORD);
    return word;
}

/* The record at *at, which moves behind it; NULL: it does not end before the tail. */
static const char *next_record(const run_part *p, const char **at, size_t *size)
{
    const char *from = *at + WORD;
    if ((size_t)(p->end - *at) < WORD) return NULL;
    const uint64_t length = word_at(*at), left = (uint64_t)(p->end - from);
    if (length > left || (length + WORD - 1) / WORD * WORD > left) return NULL;
    *size = (size_t)length, *at = from + (length + WORD - 1) / WORD * WORD;
    return from;
}

static const char *read_records(run_part *p, const char *at)
{
    size_t capacity = 0, size;
    p->bytes = at;
    while (at < p->end) {
        p->record = memory_room(p->record, p->records, &capacity, sizeof *p->record);
        p->record[p->records++] = at;
        if (!next_record(p, &at, &size)) return "damaged: a record has no end";
    }
    return word_at(p->end + WORD) == p->records ? NULL : "damaged: there are records too many, or too few";
}

const char *part_read(const char *path, run_part *p)
{
    bool mapped;
    const input in = input_map(path, &mapped);
    *p = (run_part){.path = path, .file = in.text};
    if (in.length < WORD || memcmp(in.text, MARK, WORD) != 0) return "not a part of sagitta";
    if (in.length < HEAD + TAIL || in.length % WORD) return "cut off";
    p->end = in.text + in.length - TAIL;
    if (word_at(in.text + WORD) != ORDER) return "a part of a machine with another order of bytes";
    if (word_at(p->end) != LAST) return "cut off";
    uint64_t sum = 0;
    for (const char *at = in.text; at < in.text + in.length - WORD; at += WORD)
        sum = digest_word(sum, word_at(at));
    if (sum != word_at(p->end + (ptrdiff_t)2 * WORD)) return "damaged: the checksum is another one";
    p->of = (part_of_run){word_at(in.text + (ptrdiff_t)2 * WORD), word_at(in.text + (ptrdiff_t)3 * WORD),
                          word_at(in.text + (ptrdiff_t)4 * WORD), NULL, 0};
    const char *at = in.text + HEAD;
    size_t length;
    const char *version = next_record(p, &at, &length);
    p->of.arguments = version ? next_record(p, &at, &p->of.length) : NULL;
    if (!p->of.arguments || !p->of.length || p->of.arguments[p->of.length - 1]) return "damaged";
    if (length != strlen(sgt_version()) + 1 || memcmp(version, sgt_version(), length) != 0)
        return memory_print("of sagitta %.*s; this is %s", (int)length, version, sgt_version());
    if (!p->of.number || p->of.number > p->of.of) return "damaged";
    return read_records(p, at);
}

void part_leave(run_part *p)
{
    memory_drop(p->record);
    input_unmap(p->file);
    *p = (run_part){.path = NULL};
}

const void *part_record(const run_part *p, size_t i, size_t *size)
{
    if (i >= p->records) return NULL;
    const char *at = p->record[i];
    return next_record(p, &at, size);
}

// SPDX-License-Identifier: MIT
/* mutate.c - each prefix of files of CODE V or Zemax, and mutations of them: an honest lens or one clear
 * error, as imported.h says.
 *
 *     mutate COUNT FILE...           all .seq, or all .zmx
 *
 * A mutation changes, inserts, removes or repeats some bytes, or takes a line from another file.  It is drawn
 * from SAGITTA_TEST_SEED (1).  A prefix of a sequence file that is a lens must say that the file may be cut
 * off, unless what is missing is blank; a .zmx has no last record. */
#include "imported.h"

#include <stdio.h>
#include <string.h>

enum { MOST = 1 << 14, FILES = 32 };
static const char *name = "a.seq";

static uint8_t text[FILES][MOST];
static size_t length[FILES];
static int files;

static uint64_t state;

static size_t draw(size_t below)
{
    state = state * 6364136223846793005u + 1442695040888963407u; /* Knuth's MMIX */
    return (size_t)(state >> 33) % below;
}

static size_t mutated(uint8_t *to, int from)
{
    size_t n = length[from];
    memcpy(to, text[from], n);
    for (size_t times = 1 + draw(3); times--;) {
        const size_t at = draw(n), much = 1 + draw(n - at < 12 ? n - at : 12);
        const int other = (int)draw((size_t)files);
        const size_t there = draw(length[other]);
        static const char marks[] = "&;!'\"SZ01.-\n eQ";
        switch (draw(5)) {
        case 0:
            to[at] = (uint8_t)draw(256);
            break;
        case 1:
            to[at] = (uint8_t)marks[draw(sizeof marks - 1)];
            break;
        case 2:
            memmove(to + at, to + at + much, n - at - much);
            n -= much;
            break;
        default:
            for (size_t i = 0; i < 40 && there + i < length[other] && n + 1 < MOST; i++) {
                memmove(to + at + i + 1, to + at + i, n - at - i);
                to[at + i] = text[other][there + i], n++;
                if (to[at + i] == '\n') break;
            }
        }
        if (n == 0) return 0;
    }
    return n;
}

static bool blank_from(int file, size_t at)
{
    for (; at < length[file]; at++)
        if (text[file][at] > ' ') return false;
    return true;
}

/* Whether the file could be read whole by its text; a lens that is short of it must say so. */
static void require_told(int file, size_t size)
{
    const sgt_lens_options options = {.allocator = &counted, .glasses = glasses()};
    sgt_error e;
    sgt_lens *l = sgt_lens_read_text(name, (const char *)text[file], size, &options, &e);
    bool told = false;
    for (size_t i = 0; l && i < l->remarks; i++) told = told || strstr(l->remark[i].words, "cut off");
    REQUIRE(!l || told || blank_from(file, size), "file %d, %zu bytes: a part of it is a lens", file, size);
    sgt_lens_free(l);
}

int main(int count, char *argument[])
{
    const char *seed = getenv("SAGITTA_TEST_SEED");
    const long mutations = count > 1 ? strtol(argument[1], NULL, 10) : 0;
    static uint8_t changed[MOST];
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%llu\n", (unsigned long long)state);
    for (int i = 2; i < count && files < FILES; i++, files++) {
        const bool seq = !strstr(argument[i], ".zmx");
        FILE *f = fopen(argument[i], "rb");
        if (!seq) name = "a.zmx";
        REQUIRE(f, "%s", argument[i]);
        length[files] = fread(text[files], 1, MOST, f);
        fclose(f);
        for (size_t size = 0; size < length[files]; size++) {
            read_imported(name, text[files], size);
            if (seq) require_told(files, size);
        }
    }
    for (long i = 0; i < mutations; i++) {
        const size_t size = mutated(changed, (int)draw((size_t)files));
        read_imported(name, changed, size);
    }
    printf("%d files, %ld mutations\n", files, mutations);
    return 0;
}

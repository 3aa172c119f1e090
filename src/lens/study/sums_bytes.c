// SPDX-License-Identifier: MIT
/* sums_bytes.c - sums as bytes, and back.
 *
 * All numbers are of 8 bytes, the lowest first: the mark "sag sums", the version, the kind; the point, how
 * many rays there are, and passed, and three doubles (the largest distance, or the least, largest and worst
 * difference).  Then each exact sum, its carries taken: which numbers that are not finite it has, its first
 * word that is not 0, how many words follow, and these.  Last comes the checksum of all bytes before
 * (Fowler-Noll-Vo 1a, 64 bits). */
#include "sums.h"

#include "../optics/launch.h"

#include <stdio.h>

enum { NUMBER = 8, VERSION = 1 };
static const uint64_t MARK = UINT64_C(0x736d757320676173); /* "sag sums" */

static uint64_t checksum(size_t size, const unsigned char bytes[])
{
    uint64_t h = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < size; i++) h = (h ^ bytes[i]) * UINT64_C(0x100000001b3);
    return h;
}

/* Bytes that are written or read; beyond the end they are only counted. */
typedef struct octets { unsigned char *to; const unsigned char *from; size_t room, at; } octets;

static void put_whole(octets *p, uint64_t x)
{
    for (size_t i = 0; i < NUMBER && p->at + NUMBER <= p->room; i++)
        p->to[p->at + i] = (unsigned char)(x >> 8 * i);
    p->at += NUMBER;
}

static uint64_t get_whole(octets *p)
{
    uint64_t x = 0;
    for (size_t i = 0; i < NUMBER && p->at + NUMBER <= p->room; i++)
        x |= (uint64_t)p->from[p->at + i] << 8 * i;
    p->at += NUMBER;
    return x;
}

static void put_double(octets *p, double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    put_whole(p, bits);
}

static double get_double(octets *p)
{
    const uint64_t bits = get_whole(p);
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static void put_exact(octets *p, exact *s)
{
    size_t low = 0, high = EXACT_WORDS;
    sgt_exact_carry(s);
    while (low < high && !s->word[low]) low++;
    while (high > low && !s->word[high - 1]) high--;
    put_whole(p, s->odd), put_whole(p, low), put_whole(p, high - low);
    for (size_t i = low; i < high; i++) put_whole(p, (uint64_t)s->word[i]);
}

static bool get_exact(octets *p, exact *s)
{
    const uint64_t odd = get_whole(p), low = get_whole(p), count = get_whole(p);
    if (odd > 7 || low > EXACT_WORDS || count > EXACT_WORDS - low) return false;
    s->odd = (uint32_t)odd, s->adds = 1;
    for (size_t i = 0; i < count; i++) s->word[low + i] = (int64_t)get_whole(p);
    for (size_t i = 0; i < count; i++) /* carries were taken */
        if (s->word[low + i] >> 32 && (low + i + 1 < EXACT_WORDS || s->word[low + i] >> 32 != -1))
            return false;
    return true;
}

size_t sgt_sums_write(const sgt_sums *sums, size_t room, unsigned char bytes[])
{
    exact *of[SUMS_MOST_EXACT];
    sgt_sums s = *sums;
    const bool waves = s.kind == SGT_SUMS_WAVEFRONT;
    octets p = {.to = bytes, .room = room};
    put_whole(&p, MARK), put_whole(&p, VERSION), put_whole(&p, (uint64_t)s.kind);
    put_double(&p, s.about.x), put_double(&p, s.about.y);
    put_whole(&p, waves ? s.front.rays : s.spread.rays);
    put_whole(&p, waves ? s.front.passed : s.spread.passed);
    put_double(&p, waves ? s.front.least : s.spread.far);
    put_double(&p, s.front.most), put_double(&p, s.front.off);
    const size_t count = sgt_sums_exact(&s, of);
    for (size_t i = 0; i < count; i++) put_exact(&p, of[i]);
    put_whole(&p, p.at + NUMBER <= room ? checksum(p.at, bytes) : 0);
    return p.at;
}

/* What is wrong; NULL: nothing. */
static const char *sums_of_bytes(sgt_sums *s, size_t size, const unsigned char bytes[])
{
    exact *of[SUMS_MOST_EXACT];
    octets p = {.from = bytes, .room = size}, end = {.from = bytes, .room = size, .at = size - NUMBER};
    if (size < 4 * NUMBER || get_whole(&p) != MARK) return "not sums of rays";
    const uint64_t version = get_whole(&p), kind = get_whole(&p);
    if (version != VERSION) return "sums of another version of sagitta";
    if (get_whole(&end) != checksum(size - NUMBER, bytes))
        return "cut off or damaged: the checksum is another one";
    if (kind != SGT_SUMS_SPOT && kind != SGT_SUMS_WAVEFRONT) return "sums of an unknown kind";
    s->kind = (sgt_sums_kind)kind, s->about.x = get_double(&p), s->about.y = get_double(&p);
    const size_t rays = (size_t)get_whole(&p), passed = (size_t)get_whole(&p);
    const double first = get_double(&p), most = get_double(&p), off = get_double(&p);
    const bool waves = s->kind == SGT_SUMS_WAVEFRONT;
    if (waves) s->front.rays = rays, s->front.passed = passed, s->front.least = first;
    else s->spread.rays = rays, s->spread.passed = passed, s->spread.far = first;
    s->front.most = most, s->front.off = off;
    const size_t count = sgt_sums_exact(s, of);
    for (size_t i = 0; i < count; i++)
        if (!get_exact(&p, of[i])) return "sums that cannot be";
    return p.at + NUMBER == size ? NULL : "sums that cannot be";
}

sgt_sums *sgt_sums_read(const char *name, size_t size, const unsigned char bytes[],
                        const sgt_allocator *allocator, sgt_error *error)
{
    const sgt_launcher none = {.allocator = sgt_allocator_or(allocator)};
    sgt_sums *s = sgt_sums_new(SGT_SUMS_SPOT, NULL, allocator);
    const char *fault = s ? sums_of_bytes(s, size, bytes) : "no memory";
    if (!fault) return s;
    sgt_sums_free(s);
    sgt_launch_fail(&none, error, "", "%s", fault);
    if (error) snprintf(error->file, sizeof error->file, "%s", name);
    return NULL;
}

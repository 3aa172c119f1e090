// SPDX-License-Identifier: MIT
/* text.c - files as text: reading them whole, and their encodings.
 *
 * ENCODINGS.  A mark at the start tells UTF-8 and both UTF-16.  Without one, a zero in one of the
 * first two bytes tells UTF-16, since these files begin with a character of ASCII; text that is
 * valid UTF-8 is that, and all other is Latin-1, of which each byte is a character. */
#include "reader.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* Appends a character as UTF-8. */
static char *put(char *out, unsigned long u)
{
    if (u < 0x80) return *out++ = (char)u, out;
    int more = u < 0x800 ? 1 : u < 0x10000 ? 2 : 3;
    static const unsigned mark[] = {0, 0xC0, 0xE0, 0xF0};
    *out++ = (char)(mark[more] | u >> 6 * more);
    while (more--) *out++ = (char)(0x80 | (u >> 6 * more & 0x3F));
    return out;
}

/* Whether bytes are UTF-8, without forms that are longer than needed and without surrogates. */
static bool is_utf8(const unsigned char *s, const unsigned char *end)
{
    while (s < end) {
        unsigned long u = *s++;
        int more = u < 0x80                ? 0
                   : u >= 0xC2 && u < 0xE0 ? 1
                   : u >= 0xE0 && u < 0xF0 ? 2
                   : u >= 0xF0 && u < 0xF5 ? 3
                                           : -1;
        static const unsigned long least[] = {0, 0x80, 0x800, 0x10000};
        if (more < 0 || end - s < more) return false;
        u &= more == 0 ? 0x7FUL : 0x3FUL >> more;
        for (int i = 0; i < more; i++, s++) {
            if ((*s & 0xC0) != 0x80) return false;
            u = u << 6 | (*s & 0x3FU);
        }
        if (u < least[more] || u > 0x10FFFF || (u >= 0xD800 && u < 0xE000)) return false;
    }
    return true;
}

char *sgt_reader_decoded(arena *a, const char *text, size_t *length)
{
    const unsigned char *s = (const unsigned char *)text, *end = s + *length;
    if (*length > SIZE_MAX / 2 - 1) return NULL;
    char *copy = sgt_arena_take(a, 2 * *length + 1), *out = copy;
    if (!copy) return NULL;
    bool two = *length >= 2;
    bool low_first = two && ((s[0] == 0xFF && s[1] == 0xFE) || (s[0] && !s[1]));
    bool high_first = two && ((s[0] == 0xFE && s[1] == 0xFF) || (!s[0] && s[1]));
    if (low_first || high_first) {
        for (; end - s >= 2; s += 2) {
            unsigned long u = low_first ? s[0] | (unsigned long)s[1] << 8 : s[1] | (unsigned long)s[0] << 8;
            if (u >= 0xD800 && u < 0xDC00 && end - s >= 4) {
                const unsigned char *t = s + 2;
                unsigned long v = low_first ? t[0] | (unsigned long)t[1] << 8
                                            : t[1] | (unsigned long)t[0] << 8;
                if (v >= 0xDC00 && v < 0xE000) u = 0x10000 + ((u - 0xD800) << 10) + (v - 0xDC00), s += 2;
            }
            if (u >= 0xD800 && u < 0xE000) u = 0xFFFD; /* half a pair */
            if (u != 0xFEFF) out = put(out, u);        /* the mark */
        }
        if (s < end) out = put(out, 0xFFFD); /* half a character */
    } else if (is_utf8(s, end)) {
        if (end - s >= 3 && s[0] == 0xEF && s[1] == 0xBB && s[2] == 0xBF) s += 3;
        memcpy(out, s, (size_t)(end - s)), out += end - s;
    } else {
        while (s < end) out = put(out, *s++);
    }
    *length = (size_t)(out - copy);
    return copy;
}

/* A catalogue of all makers is some megabytes; a device without an end is none. */
enum { FILE_MOST = 256 << 20 };

bool sgt_reader_file(const sgt_allocator *a, const char *path, char **text, size_t *length,
                     sgt_error *error)
{
    reader r = {.file = path, .error = error};
    FILE *file = fopen(path, "rb");
    if (!file) return sgt_reader_fail(&r, 0, "", "cannot be opened: %s", strerror(errno));
    size_t room = 0;
    bool fine = true, whole = false;
    *text = NULL, *length = 0;
    while (fine && !whole) {
        if (*length + 1 >= room) {
            room = room ? 2 * room : 1 << 16;
            char *more = room <= FILE_MOST ? a->resize(a->context, *text, room) : NULL;
            if (!more) {
                fine = sgt_reader_fail(&r, 0, "", "too long, or no memory");
                break;
            }
            *text = more;
        }
        *length += fread(*text + *length, 1, room - *length - 1, file);
        if (ferror(file)) fine = sgt_reader_fail(&r, 0, "", "cannot be read: %s", strerror(errno));
        whole = feof(file);
    }
    fclose(file);
    if (fine) (*text)[*length] = 0;
    else if (*text) a->resize(a->context, *text, 0);
    return fine;
}

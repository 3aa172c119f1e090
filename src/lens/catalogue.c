/* catalogue.c - catalogues of glasses: files and folders, encodings, looking up by name.
 *
 * ENCODINGS.  A mark at the start tells UTF-8 and both UTF-16.  Without one, a zero in one of the
 * first two bytes tells UTF-16, since a catalogue begins with a character of ASCII; text that is
 * valid UTF-8 is that, and all other is Latin-1, of which each byte is a character.
 *
 * NEAREST NAMES are those with the least edit distance (Levenshtein 1966): insertions, deletions
 * and changes of one character, the case of letters aside. */
#include "reader.h"

#include <dirent.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* A catalogue of all makers is some megabytes; a device without an end is none. */
enum { FILE_MOST = 256 << 20, NAME_MOST = 63, NEAREST = 3 };

static void *plain_resize(void *context, void *memory, size_t size)
{
    (void)context;
    if (size) return realloc(memory, size);
    free(memory);
    return NULL;
}

sgt_catalogue *sgt_catalogue_new(const sgt_allocator *allocator)
{
    sgt_allocator a = {.resize = plain_resize};
    if (allocator) a = *allocator;
    sgt_catalogue *c = a.resize(a.context, NULL, sizeof *c);
    if (c) *c = (sgt_catalogue){.allocator = a};
    return c;
}

void sgt_catalogue_free(sgt_catalogue *c)
{
    if (!c) return;
    sgt_allocator a = c->allocator;
    for (block *b = c->blocks, *next; b; b = next) next = b->next, a.resize(a.context, b, 0);
    if (c->glass) a.resize(a.context, c->glass, 0);
    if (c->addition) a.resize(a.context, c->addition, 0);
    a.resize(a.context, c, 0);
}

size_t sgt_catalogue_count(const sgt_catalogue *c) { return c->count; }

bool sgt_catalogue_glass(const sgt_catalogue *c, size_t place, sgt_glass *glass)
{
    if (place >= c->count) return false;
    *glass = c->glass[place];
    return true;
}

/* -------------------------------------------------------------- encodings */

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

/* A copy as UTF-8, of which *length is set; NULL: no memory. */
static char *decoded(sgt_catalogue *c, const char *text, size_t *length)
{
    const unsigned char *s = (const unsigned char *)text, *end = s + *length;
    if (*length > SIZE_MAX / 2 - 1) return NULL;
    char *copy = sgt_reader_take(c, 2 * *length + 1), *out = copy;
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

/* ------------------------------------------------------------------ files */

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c; }

static bool same_letters(piece a, const char *b)
{
    for (; a.begin < a.end && *b; a.begin++, b++)
        if (lower(*a.begin) != lower(*b)) return false;
    return a.begin == a.end && !*b;
}

static bool slash(char c)
{
#ifdef _WIN32
    if (c == '\\') return true;
#endif
    return c == '/';
}

/* The last part of a path that ends before `end`. */
static piece last_part(const char *path, const char *end)
{
    const char *s = end;
    while (s > path && !slash(s[-1])) s--;
    return (piece){s, end};
}

static piece ending(piece name)
{
    const char *s = name.end;
    while (s > name.begin && *s != '.') s--;
    return (piece){s, name.end};
}

typedef enum form { FORM_NONE, FORM_AGF, FORM_CSV, FORM_RII } form;

static form form_of(const char *path)
{
    piece e = ending(last_part(path, path + strlen(path)));
    if (same_letters(e, ".agf")) return FORM_AGF;
    if (same_letters(e, ".csv")) return FORM_CSV;
    return same_letters(e, ".yml") || same_letters(e, ".yaml") ? FORM_RII : FORM_NONE;
}

/* The folder's name, but for those in which the database keeps all materials of a maker. */
static piece folder_of(const char *path, piece name)
{
    piece folder = {path, path};
    for (const char *end = name.begin; end > path; end = folder.begin) {
        folder = last_part(path, end - 1);
        if (!sgt_reader_is(folder, "optical") && !sgt_reader_is(folder, "nk")) break;
    }
    return folder;
}

static bool add_text(sgt_catalogue *c, const char *path, const char *text, size_t length,
                     sgt_lens_error *error)
{
    reader r = {.catalogue = c, .file = path, .error = error};
    form f = form_of(path);
    if (f == FORM_NONE)
        return sgt_reader_fail(&r, 0, "", "not a catalogue by its name: .agf, .csv, .yml or .yaml is known");
    const char *file = sgt_reader_text(c, (piece){path, path + strlen(path)});
    char *copy = decoded(c, text, &length);
    if (!file || !copy) return sgt_reader_fail(&r, 0, "", "no memory");
    r.file = file, r.at = copy, r.end = copy + length;
    const char *zero = memchr(copy, 0, length);
    if (zero) {
        for (piece line; r.at <= zero && sgt_reader_line(&r, &line);) {}
        return sgt_reader_fail(&r, r.line, "", "a zero byte: this is no text");
    }
    piece name = last_part(file, file + strlen(file)), folder = folder_of(file, name);
    name.end = ending(name).begin;
    size_t before = c->count;
    bool done = f == FORM_AGF   ? sgt_read_agf(&r, name)
                : f == FORM_CSV ? sgt_read_csv(&r)
                                : sgt_read_rii(&r, name, folder);
    if (!done) c->count = before;
    return done;
}

static bool add_file(sgt_catalogue *c, const char *path, sgt_lens_error *error)
{
    reader r = {.catalogue = c, .file = path, .error = error};
    sgt_allocator *a = &c->allocator;
    FILE *file = fopen(path, "rb");
    if (!file) return sgt_reader_fail(&r, 0, "", "cannot be opened: %s", strerror(errno));
    char *text = NULL;
    size_t length = 0, room = 0;
    bool fine = true, whole = false;
    while (fine && !whole) {
        if (length == room) {
            room = room ? 2 * room : 1 << 16;
            char *more = room <= FILE_MOST ? a->resize(a->context, text, room) : NULL;
            if (!more) { fine = sgt_reader_fail(&r, 0, "", "too long, or no memory"); break; }
            text = more;
        }
        size_t n = fread(text + length, 1, room - length, file);
        length += n;
        if (ferror(file)) fine = sgt_reader_fail(&r, 0, "", "cannot be read: %s", strerror(errno));
        whole = feof(file);
    }
    fclose(file);
    fine = fine && add_text(c, path, text, length, error);
    if (text) a->resize(a->context, text, 0);
    return fine;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool add_folder(sgt_catalogue *c, const char *path, sgt_lens_error *error)
{
    reader r = {.catalogue = c, .file = path, .error = error};
    sgt_allocator *a = &c->allocator;
    DIR *folder = opendir(path);
    if (!folder) return sgt_reader_fail(&r, 0, "", "cannot be opened: %s", strerror(errno));
    char **name = NULL;
    size_t count = 0, room = 0, length = strlen(path);
    bool fine = true;
    for (struct dirent *entry; fine && (entry = readdir(folder));) {
        if (entry->d_name[0] == '.' || form_of(entry->d_name) == FORM_NONE) continue;
        if (count == room) {
            room = room ? 2 * room : 64;
            char **more = a->resize(a->context, name, room * sizeof *name);
            if (!more) { fine = sgt_reader_fail(&r, 0, "", "no memory"); break; }
            name = more;
        }
        size_t own = strlen(entry->d_name);
        name[count] = sgt_reader_take(c, length + own + 2);
        if (!name[count]) { fine = sgt_reader_fail(&r, 0, "", "no memory"); break; }
        memcpy(name[count], path, length), name[count][length] = '/';
        memcpy(name[count] + length + 1, entry->d_name, own + 1);
        count++;
    }
    closedir(folder);
    if (fine && count == 0)
        fine = sgt_reader_fail(&r, 0, "", "no catalogue in this folder: .agf, .csv, .yml or .yaml");
    if (count) qsort(name, count, sizeof *name, by_name);
    for (size_t i = 0; fine && i < count; i++) fine = add_file(c, name[i], error);
    if (name) a->resize(a->context, name, 0);
    return fine;
}

static bool is_folder(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

bool sgt_catalogue_add(sgt_catalogue *c, const char *path, sgt_lens_error *error)
{
    sgt_lens_error unread;
    if (!error) error = &unread;
    if (!path) {
        const char *asked = getenv("SAGITTA_GLASS");
        path = is_folder(SGT_GLASS_INSTALLED) ? SGT_GLASS_INSTALLED : SGT_GLASS_SOURCE;
        if (asked && *asked) path = asked;
    }
    c->additions++;
    return is_folder(path) ? add_folder(c, path, error) : add_file(c, path, error);
}

bool sgt_catalogue_add_text(sgt_catalogue *c, const char *name, const char *text, size_t length,
                            sgt_lens_error *error)
{
    sgt_lens_error unread;
    c->additions++;
    return add_text(c, name, text, length, error ? error : &unread);
}

/* ------------------------------------------------------------------ names */

/* Levenshtein's distance of two names, of which at most NAME_MOST characters are looked at. */
static size_t distance(piece a, const char *b)
{
    size_t row[NAME_MOST + 1], m = (size_t)(a.end - a.begin), n = strlen(b);
    if (m > NAME_MOST) m = NAME_MOST;
    if (n > NAME_MOST) n = NAME_MOST;
    for (size_t j = 0; j <= n; j++) row[j] = j;
    for (size_t i = 0; i < m; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < n; j++) {
            size_t best = diagonal + (lower(a.begin[i]) != lower(b[j]));
            if (row[j] + 1 < best) best = row[j] + 1;
            if (row[j + 1] + 1 < best) best = row[j + 1] + 1;
            diagonal = row[j + 1], row[j + 1] = best;
        }
    }
    return row[n];
}

/* `name` is that of the glass, or MAKER NAME. */
static bool fits(piece name, const sgt_glass *g)
{
    if (same_letters(name, g->name)) return true;
    size_t maker = strlen(g->maker);
    if ((size_t)(name.end - name.begin) <= maker || name.begin[maker] != ' ') return false;
    return same_letters((piece){name.begin, name.begin + maker}, g->maker) &&
           same_letters((piece){name.begin + maker + 1, name.end}, g->name);
}

static bool unknown_name(const sgt_catalogue *c, piece name, sgt_lens_error *error)
{
    const sgt_glass *near[NEAREST] = {NULL};
    size_t apart[NEAREST], count = 0;
    piece bare_name = name; /* without a maker before it */
    for (const char *s = name.begin; s < name.end; s++)
        if (*s == ' ') { bare_name.begin = s + 1; break; }
    for (size_t i = 0; i < c->count; i++) {
        size_t d = distance(name, c->glass[i].name), e = distance(bare_name, c->glass[i].name);
        if (e < d) d = e;
        size_t at = count;
        while (at > 0 && d < apart[at - 1]) at--;
        if (at == NEAREST) continue;
        if (count < NEAREST) count++;
        for (size_t j = count - 1; j > at; j--) near[j] = near[j - 1], apart[j] = apart[j - 1];
        near[at] = &c->glass[i], apart[at] = d;
    }
    reader r = {.file = "", .error = error};
    char list[200] = "; the catalogue is empty";
    for (size_t i = 0, used = 0; i < count && used < sizeof list; i++) {
        int n = snprintf(list + used, sizeof list - used, "%s%.20s%s%.40s", i ? ", " : "; nearest: ",
                         near[i]->maker, *near[i]->maker ? " " : "", near[i]->name);
        used += n > 0 ? (size_t)n : 0;
    }
    return sgt_reader_fail(&r, 0, "glass", "no glass \"%.*s\"%s",
                           sgt_reader_width(name),
                           name.begin, list);
}

bool sgt_catalogue_find(const sgt_catalogue *c, const char *name, size_t makers_count,
                        const char *const *makers, sgt_glass *glass, sgt_lens_error *error)
{
    sgt_lens_error unread;
    piece asked = {name, name + strlen(name)};
    size_t best = c->count, best_rank = 0;
    for (size_t i = 0; i < c->count; i++) {
        const sgt_glass *g = &c->glass[i];
        if (!fits(asked, g)) continue;
        size_t rank = 0;
        piece maker = {g->maker, g->maker + strlen(g->maker)};
        while (rank < makers_count && !same_letters(maker, makers[rank])) rank++;
        if (best == c->count || rank < best_rank || (rank == best_rank && c->addition[i] > c->addition[best]))
            best = i, best_rank = rank;
    }
    if (best == c->count) return unknown_name(c, asked, error ? error : &unread);
    *glass = c->glass[best];
    return true;
}

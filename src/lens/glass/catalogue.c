// SPDX-License-Identifier: MIT
/* catalogue.c - catalogues of glasses: files and folders, looking up by name.
 *
 * NEAREST NAMES are those with the least edit distance (Levenshtein 1966): insertions, deletions
 * and changes of one character, the case of letters aside. */
#include "forms.h"

#include <dirent.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { NEAREST = 3 };

sgt_catalogue *sgt_catalogue_new(const sgt_allocator *allocator)
{
    sgt_allocator a = sgt_allocator_or(allocator);
    sgt_catalogue *c = a.resize(a.context, NULL, sizeof *c);
    if (c) *c = (sgt_catalogue){.arena = {.allocator = a}};
    return c;
}

void sgt_catalogue_free(sgt_catalogue *c)
{
    if (!c) return;
    sgt_allocator a = c->arena.allocator;
    sgt_arena_free(&c->arena);
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

/* ------------------------------------------------------------------ files */

static bool same_letters(piece a, const char *b)
{
    for (; a.begin < a.end && *b; a.begin++, b++)
        if (sgt_lower(*a.begin) != sgt_lower(*b)) return false;
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
                     sgt_error *error)
{
    reader r = {.catalogue = c, .file = path, .error = error};
    form f = form_of(path);
    if (f == FORM_NONE)
        return sgt_reader_fail(&r, 0, "", "not a catalogue by its name: .agf, .csv, .yml or .yaml is known");
    const char *file = sgt_arena_text(&c->arena, path, strlen(path));
    char *copy = sgt_reader_decoded(&c->arena, text, &length);
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

static bool add_file(sgt_catalogue *c, const char *path, sgt_error *error)
{
    const sgt_allocator *a = &c->arena.allocator;
    char *text;
    size_t length;
    if (!sgt_reader_file(a, path, &text, &length, error)) return false;
    bool fine = add_text(c, path, text, length, error);
    a->resize(a->context, text, 0);
    return fine;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool add_folder(sgt_catalogue *c, const char *path, sgt_error *error)
{
    reader r = {.catalogue = c, .file = path, .error = error};
    const sgt_allocator *a = &c->arena.allocator;
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
        name[count] = sgt_arena_take(&c->arena, length + own + 2);
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

bool sgt_catalogue_add(sgt_catalogue *c, const char *path, sgt_error *error)
{
    sgt_error unread;
    if (!error) error = &unread;
    if (!path) {
        const char *asked = getenv("SAGITTA_GLASS");
        bool has_source = SGT_GLASS_SOURCE[0] != '\0'; /* (-Dsource_folder) */
        path = is_folder(SGT_GLASS_INSTALLED) || !has_source ? SGT_GLASS_INSTALLED : SGT_GLASS_SOURCE;
        if (asked && *asked) path = asked;
    }
    c->additions++;
    return is_folder(path) ? add_folder(c, path, error) : add_file(c, path, error);
}

bool sgt_catalogue_add_text(sgt_catalogue *c, const char *name, const char *text, size_t length,
                            sgt_error *error)
{
    sgt_error unread;
    c->additions++;
    return add_text(c, name, text, length, error ? error : &unread);
}

/* ------------------------------------------------------------------ names */

static size_t distance(piece a, const char *b)
{
    return sgt_reader_distance(a, (piece){b, b + strlen(b)});
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

static bool unknown_name(const sgt_catalogue *c, piece name, sgt_error *error)
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

/* Whose glass a bare name means where nothing else decides: as designers take it.  SCHOTT's names are those
 * of books; the others have taken some of them over for glasses of their own. */
static const char *const usual_makers[] = {"schott", "ohara", "hoya", "cdgm", "hikari", "sumita"};
enum { USUAL_MAKERS = sizeof usual_makers / sizeof usual_makers[0] };

static size_t usual_rank(piece maker)
{
    size_t rank = 0;
    while (rank < USUAL_MAKERS && !same_letters(maker, usual_makers[rank])) rank++;
    return rank;
}

bool sgt_catalogue_find(const sgt_catalogue *c, const char *name, size_t makers_count,
                        const char *const *makers, sgt_glass *glass, sgt_error *error)
{
    sgt_error unread;
    piece asked = {name, name + strlen(name)};
    size_t best = c->count, best_rank = 0, best_usual = 0;
    for (size_t i = 0; i < c->count; i++) {
        const sgt_glass *g = &c->glass[i];
        if (!fits(asked, g)) continue;
        size_t rank = 0;
        piece maker = {g->maker, g->maker + strlen(g->maker)};
        while (rank < makers_count && !same_letters(maker, makers[rank])) rank++;
        size_t usual = usual_rank(maker);
        bool better = best == c->count || rank < best_rank;
        if (!better && rank == best_rank)
            better = c->addition[i] > c->addition[best] ||
                     (c->addition[i] == c->addition[best] && usual < best_usual);
        if (better) best = i, best_rank = rank, best_usual = usual;
    }
    if (best == c->count) return unknown_name(c, asked, error ? error : &unread);
    *glass = c->glass[best];
    return true;
}

// SPDX-License-Identifier: MIT
/* rays.c - reads rays from CSV.
 *
 * RFC 4180, and what spreadsheets write: CR LF or LF, blanks around a field, a field in
 * quotes, a byte order mark, a last line without an end, and empty lines (which are not
 * rows).  The header says which column is which.
 *
 * A row is bad if it has too few or too many fields, or one that is not a number, or if the
 * library would call the ray invalid.  So the user is told the line, and not only a status.
 *
 * Nearly all lines are numbers with commas between them.  Those are read where they stand, in one pass; only
 * another line is first split into its fields.
 *
 * A line ends at its \n, even inside quotes.  So the text can be cut at any \n, and the pieces
 * are read in threads.  First the rows of each piece are counted.  Then each piece knows where
 * its rays go, and the numbers of its rows and lines. */
#include "ray_table.h"

#include "../base/fail.h"
#include "../base/input.h"
#include "../base/memory.h"
#include "../../text/number.h"
#include "../base/threads.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

const char *const ray_column_name[RAY_COLUMNS] = {"ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax", "id"};
const char *const place_column_name[RAY_COLUMNS] = {"lat", "lon",  "height", "az", "el",
                                                    "",    "tmin", "tmax",   "id"};

enum { FIELDS_MOST = RAY_COLUMNS + 1 };
#ifndef PIECE
#define PIECE (1 << 18) /* the least bytes of a piece; a test may set it lower */
#endif
static const char BROKEN[] = "a quote that does not end, text behind a closing quote, or a zero byte";

void rays_add(ray_list *list, launch ray)
{
    list->ray = memory_room(list->ray, list->count, &list->capacity, sizeof *list->ray);
    list->ray[list->count++] = ray;
}

/* ---------------------------------------------------------------- one ray */

LIKE_PRINTF(2, 3) static bool bad(char why[RAY_WHY], const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(why, RAY_WHY, format, values);
    va_end(values);
    return false;
}

double ray_end(const sgt_ray *ray)
{
    bool none = ray->tmin == 0 && ray->tmax == 0 && !signbit(ray->tmax);
    return none ? HUGE_VAL : ray->tmax + 0.0; /* a -0, of sgt_ray_between, is 0 */
}

/* The stretch of a ray whose o and d are set. */
static bool stretch_of(const double value[8], bool has_tmin, bool has_tmax, sgt_ray *ray, char why[RAY_WHY])
{
    ray->tmin = has_tmin ? value[RAY_TMIN] : 0;
    ray->tmax = has_tmax ? value[RAY_TMAX] : HUGE_VAL;
    if (isnan(ray->tmin) || isnan(ray->tmax)) return bad(why, "tmin, tmax: must not be nan");
    if (ray->tmin > ray->tmax)
        return bad(why, "tmin, tmax: tmin must not be above tmax, and %g is above %g", ray->tmin, ray->tmax);
    if (ray->tmin == HUGE_VAL || ray->tmax == -HUGE_VAL)
        return bad(why, "tmin, tmax: there is nothing between %g and %g", ray->tmin, ray->tmax);
    *ray = sgt_ray_between(ray->o, ray->d, ray->tmin, ray->tmax); /* 0 to 0 was written, and is meant */
    return true;
}

bool place_of(const double value[8], bool has_tmin, bool has_tmax, sgt_ray *ray, char why[RAY_WHY])
{
    for (int i = 0; i < 5; i++)
        if (!isfinite(value[i])) return bad(why, "%s: must be finite", place_column_name[i]);
    if (fabs(value[0]) > 90) return bad(why, "lat: must be from -90 to 90 degrees, not %g", value[0]);
    if (fabs(value[4]) > 90)
        return bad(why, "el: must be from -90 (down) to 90 degrees, not %g", value[4]);
    *ray = (sgt_ray){.o = {value[0], value[1], value[2]}, .d = {value[3], value[4], 1}};
    return stretch_of(value, has_tmin, has_tmax, ray, why);
}

bool ray_of(const double value[8], bool has_tmin, bool has_tmax, sgt_ray *ray, char why[RAY_WHY])
{
    for (int i = 0; i < RAY_TMIN; i++)
        if (!isfinite(value[i])) return bad(why, "%s: must be finite", ray_column_name[i]);
    *ray = (sgt_ray){.o = {value[0], value[1], value[2]}, .d = {value[3], value[4], value[5]}};
    double longest = fmax(fabs(ray->d.x), fmax(fabs(ray->d.y), fabs(ray->d.z)));
    if (longest == 0) return bad(why, "dx, dy, dz: the direction must not be zero");
    if (longest < DBL_MIN) return bad(why, "dx, dy, dz: the direction is too short (below 2.2e-308)");
    return stretch_of(value, has_tmin, has_tmax, ray, why);
}

/* The numbers of an option; returns how many there are, of which the first eight are read. */
static int option_numbers(const char *option, const char *text, double value[8])
{
    char copy[400];
    int count = 0;
    if (snprintf(copy, sizeof copy, "%s", text) >= (int)sizeof copy) fail_input("%s: too long", option);
    for (char *rest = copy, *word; (word = strtok_r(rest, " \t\n,", &rest)); count++) {
        double x;
        if (!number_read(word, &x)) fail_input("%s: \"%s\" is not a number", option, word);
        if (count < 8) value[count] = x;
    }
    return count;
}

void rays_from(ray_list *list, const char *text)
{
    double value[8] = {0};
    char why[RAY_WHY];
    sgt_ray ray;
    const int count = option_numbers("--from", text, value);
    if (count != 3) fail_input("--from: must be 3 numbers in quotes, \"lat lon height\", not %d", count);
    if (!place_of(value, false, false, &ray, why)) fail_input("--from: %s", why);
    list->begun = true;
    memcpy(list->from, value, sizeof list->from);
}

void rays_look(ray_list *list, const char *text)
{
    double look[8] = {0};
    char why[RAY_WHY];
    const int count = option_numbers("--look", text, look);
    if (count != 2 && count != 4)
        fail_input("--look: must be 2 numbers in quotes, \"az el\", or 4, with tmin tmax; not %d", count);
    if (list->count && !list->places) fail_input("--look: give --ray or --look, not both");
    if (!list->begun) fail_input("--look: give the place first, by --from \"lat lon height\"");
    const double *f = list->from, value[8] = {f[0], f[1], f[2], look[0], look[1], 0, look[2], look[3]};
    launch l = {.number = list->count};
    if (!place_of(value, count == 4, count == 4, &l.ray, why)) fail_input("--look: %s", why);
    list->places = true;
    rays_add(list, l);
}

void rays_parse(ray_list *list, const char *text)
{
    char why[RAY_WHY];
    double value[8] = {0};
    const int count = option_numbers("--ray", text, value);
    if (list->places) fail_input("--ray: give --ray or --look, not both");
    if (count == 1)
        fail_input("--ray: \"%s\" is only one number; put the whole ray in quotes: \"ox oy oz dx dy dz\"",
                   text);
    if (count != 6 && count != 8)
        fail_input("--ray: must be 6 numbers, ox oy oz dx dy dz, or 8, with tmin tmax; not %d", count);
    launch l = {.number = list->count};
    if (!ray_of(value, count == 8, count == 8, &l.ray, why)) fail_input("--ray: %s", why);
    rays_add(list, l);
}

/* -------------------------------------------------------------------- csv */

typedef struct reader {
    const char *source; /* for messages */
    /* the next line, and the end of the last; a zero byte is written over each line's \n */
    char *at, *end;
    size_t line;        /* number of the last line split, from 1 */
    int count;          /* of its fields; FIELDS_MOST also for more */
    char *field[FIELDS_MOST];
    bool broken;        /* it has the fault BROKEN */
} reader;

static char *skip_blanks(char *s) { return s + strspn(s, " \t\r"); }

/* Each splitter sets *field and returns where the next one starts, NULL after the last. */
static char *split_bare(char *s, char **field)
{
    char *comma = strchr(s, ','), *end = comma ? comma : s + strlen(s);
    while (end > s && strchr(" \t\r", end[-1])) end--;
    *end = 0;
    *field = s;
    return comma ? comma + 1 : NULL;
}

static char *split_quoted(reader *r, char *s, char **field)
{
    char *to = *field = s + 1, *from = to;
    for (; *from && !(from[0] == '"' && from[1] != '"'); from++) {
        if (*from == '"') from++; /* "" inside is one " */
        *to++ = *from;
    }
    char *behind = *from ? skip_blanks(from + 1) : from;
    if (!*from || (*behind && *behind != ',')) r->broken = true;
    char *next = *behind == ',' ? behind + 1 : NULL;
    *to = 0;
    return next;
}

/* The next line that is not empty; *stop: its end.  NULL at the end of the text. */
static char *find_line(reader *r, char **stop)
{
    while (r->at < r->end) {
        char *s = r->at;
        *stop = memchr(s, '\n', (size_t)(r->end - s));
        if (!*stop) *stop = r->end;
        r->at = *stop + (*stop < r->end);
        r->line++;
        if (skip_blanks(s) < *stop) return s;
    }
    return NULL;
}

/* Splits the next line into its fields; false at the end of the text. */
static bool next_line(reader *r)
{
    char *stop, *s = find_line(r, &stop);
    if (!s) return false;
    *stop = 0;
    r->broken = strlen(s) != (size_t)(stop - s);
    r->count = 0;
    while (s && r->count < FIELDS_MOST) {
        char **field = &r->field[r->count++];
        s = skip_blanks(s);
        s = *s == '"' ? split_quoted(r, s, field) : split_bare(s, field);
    }
    return true;
}

/* The column that is meant by another name for it; NULL: no such name is known. */
static const char *usual_column(const char *name, bool earth)
{
    static const char *const usual[][2] = {
        {"latitude", "lat"}, {"longitude", "lon"}, {"lng", "lon"}, {"long", "lon"}, {"alt", "height"},
        {"altitude", "height"}, {"h", "height"}, {"azimuth", "az"}, {"elevation", "el"}, {"elev", "el"},
        {"lat", "lat"}, {"lon", "lon"}, {"height", "height"}, {"az", "az"}, {"el", "el"},
        {"x", "ox"}, {"y", "oy"}, {"z", "oz"}, {"l", "dx"}, {"m", "dy"}, {"n", "dz"}, {"vx", "dx"},
        {"vy", "dy"}, {"vz", "dz"}, {"name", "id"}, {"ox", "ox"}, {"oy", "oy"}, {"oz", "oz"}, {"dx", "dx"},
        {"dy", "dy"}, {"dz", "dz"}, {"tmin", "tmin"}, {"tmax", "tmax"}, {"id", "id"}};
    const size_t first = earth ? 0 : 15;
    for (size_t i = first; i < sizeof usual / sizeof *usual; i++)
        if (strcasecmp(name, usual[i][0]) == 0) return usual[i][1];
    return NULL;
}

/* Reads the header.  place[c]: the field that holds column c, or -1. */
static void rays_read_header(reader *r, const ray_list *list, bool *places, int place[RAY_COLUMNS])
{
    const char *source = r->source, *const *known = ray_column_name;
    static const char place_words[] = "lat, lon, height, az, el";
    if (r->end - r->at >= 3 && memcmp(r->at, "\xef\xbb\xbf", 3) == 0) r->at += 3;
    if (!next_line(r)) fail_input("%s: empty; it needs a header row: ox,oy,oz,dx,dy,dz", source);
    if (r->broken) fail_input("%s:%zu: %s", source, r->line, BROKEN);
    for (int c = 0; c < RAY_COLUMNS; c++) place[c] = -1;
    for (int f = 0; f < r->count && list->earth; f++)
        if (strcmp(r->field[f], "lat") == 0) known = place_column_name;
    *places = known == place_column_name;
    for (int f = 0; f < r->count; f++) {
        int c = 0;
        while (c < RAY_COLUMNS && (!*known[c] || strcmp(r->field[f], known[c]) != 0)) c++;
        if (c == RAY_COLUMNS) {
            double x;
            const char *meant = usual_column(r->field[f], list->earth);
            const char *hint = number_read(r->field[f], &x)    ? "is the header missing?  "
                               : *r->field[f] == '#'           ? "comments are not read; "
                               : strpbrk(r->field[f], " \t;") ? "put commas between columns; "
                               : meant ? memory_print("did you mean %s?  ", meant)
                                       : "";
            fail_input(
                "%s:%zu: %.60s: unknown column; %sknown columns: %s, tmin, tmax, id%s", source, r->line,
                r->field[f], hint, *places ? place_words : "ox, oy, oz, dx, dy, dz",
                list->earth && !*places ? memory_print("; or %s", place_words) : "");
        }
        if (place[c] >= 0)
            fail_input("%s:%zu: %s: this column is given twice", source, r->line, ray_column_name[c]);
        place[c] = f;
    }
    for (int c = 0; c < RAY_REQUIRED; c++)
        if (place[c] < 0 && *known[c])
            fail_input("%s:%zu: %s: this column is missing; %s are needed", source, r->line, known[c],
                       *places ? place_words : "ox, oy, oz, dx, dy, dz");
}

/* The numbers of the line that was split. */
static bool row_of(const reader *r, const int place[RAY_COLUMNS], int columns, double value[8],
                   char why[RAY_WHY])
{
    const char *const *name = place[RAY_REQUIRED - 1] < 0 ? place_column_name : ray_column_name;
    if (r->broken) return bad(why, "%s", BROKEN);
    if (r->count != columns)
        return bad(why, "%s fields than the %d of the header", r->count < columns ? "fewer" : "more",
                   columns);
    for (int c = 0; c < RAY_ID; c++)
        if (place[c] >= 0 && !number_read(r->field[place[c]], &value[c]))
            return bad(why, "%s: \"%.60s\" is not a number", name[c], r->field[place[c]]);
    return true;
}

/* A piece of the text: whole lines. */
typedef struct piece {
    reader reader;
    size_t lines, rows;         /* how many */
    size_t number, good, bad;   /* the number of its first row; how many rows are good, and bad */
    size_t bad_line;            /* the line of the first bad row, and what is wrong with it */
    char why[RAY_WHY];
} piece;

static piece *cut(const reader *r, size_t *count)
{
    const size_t most = (size_t)(r->end - r->at) / PIECE + 1;
    piece *p = memory_take(most, sizeof *p);
    *count = 0;
    for (char *at = r->at; at < r->end; ++*count) {
        char *stop = r->end - at > PIECE ? memchr(at + PIECE, '\n', (size_t)(r->end - at - PIECE)) : NULL;
        p[*count].reader = (reader){.source = r->source, .at = at, .end = stop ? stop + 1 : r->end};
        at = p[*count].reader.end;
    }
    return p;
}

static void count_rows(piece *p)
{
    reader r = p->reader;
    char *stop;
    while (find_line(&r, &stop)) p->rows++;
    p->lines = r.line;
}

/* Reads the next line right where it stands, if each field is a decimal number and its column no id.  false:
 * it is no such line, and nothing is read. */
static bool read_plain(reader *r, const int column[FIELDS_MOST], int columns, double value[8])
{
    const char *s = r->at, *stop = memchr(s, '\n', (size_t)(r->end - s));
    if (!stop) stop = r->end;
    for (int f = 0; f < columns; f++, s++) {
        while (s < stop && (*s == ' ' || *s == '\t')) s++;
        const size_t length = column[f] == RAY_ID ? 0 : number_read_first(s, stop, &value[column[f]]);
        if (length == 0) return false;
        s += length;
        while (s < stop && (*s == ' ' || *s == '\t' || *s == '\r')) s++;
        if (f + 1 < columns ? s == stop || *s != ',' : s != stop) return false;
    }
    r->at += stop - r->at + (stop < r->end);
    r->line++;
    return true;
}

/* Reads the rays of a piece to ray[0], ray[1] ... */
static void read_piece(piece *p, const int place[RAY_COLUMNS], int columns, launch *ray, bool skip_bad)
{
    reader *r = &p->reader;
    char why[RAY_WHY];
    int column[FIELDS_MOST] = {0};
    for (int c = 0; c < RAY_COLUMNS; c++)
        if (place[c] >= 0) column[place[c]] = c;
    bool (*const make)(const double *, bool, bool, sgt_ray *, char *) =
        place[RAY_REQUIRED - 1] < 0 ? place_of : ray_of;
    for (size_t number = p->number;; number++) {
        launch *l = &ray[p->good];
        double value[8] = {0};
        const bool plain = r->at < r->end && read_plain(r, column, columns, value);
        if (!plain && !next_line(r)) return;
        *l = (launch){.number = number};
        if ((plain || row_of(r, place, columns, value, why)) &&
            make(value, place[RAY_TMIN] >= 0, place[RAY_TMAX] >= 0, &l->ray, why)) {
            if (place[RAY_ID] >= 0) l->id = r->field[place[RAY_ID]];
            p->good++;
        } else if (p->bad++ == 0) {
            p->bad_line = r->line;
            memcpy(p->why, why, sizeof p->why);
            if (!skip_bad) return;
        }
    }
}

static void read_table(ray_list *list, const char *path, bool skip_bad)
{
    ray_table_open(list, path, skip_bad);
    if (list->parts) return;
    const size_t rows = list->count;
    list->ray = memory_grow(NULL, rows, sizeof *list->ray);
    list->count = 0;
    ray_block *b = memory_take(1, sizeof *b);
    for (size_t first = 0; first < rows; first += TILE_RAYS) {
        ray_table_part(list->table, first, rows - first < TILE_RAYS ? rows - first : TILE_RAYS, b);
        for (size_t i = 0; i < b->count; i++) list->ray[list->count++] = rays_launch(b, i);
    }
}

static void read_csv(ray_list *list, const char *path, bool skip_bad)
{
    input file = input_read(path);
    reader r = {.source = file.name, .at = file.text, .end = file.text + file.length};
    int place[RAY_COLUMNS];
    rays_read_header(&r, list, &list->places, place);
    list->ended = place[RAY_TMIN] >= 0 || place[RAY_TMAX] >= 0;
    list->named = place[RAY_ID] >= 0;
    const int columns = r.count;
    size_t pieces, rows = 0, bad = 0;
    piece *p = cut(&r, &pieces), *first_bad = NULL;
    int threads = list->threads > 1 && pieces > 1 ? list->threads : 1;
    (void)threads; /* unused without OpenMP */
    THREADS(omp parallel for schedule(dynamic) num_threads(threads))
    for (size_t i = 0; i < pieces; i++) count_rows(&p[i]);
    for (size_t i = 0, line = r.line; i < pieces; line += p[i].lines, rows += p[i].rows, i++)
        p[i].reader.line = line, p[i].number = rows;
    if (rows == 0) fail_input("%s: no rays: there is a header row and nothing under it", r.source);
    list->ray = memory_grow(NULL, rows, sizeof *list->ray);
    list->capacity = rows;
    THREADS(omp parallel for schedule(dynamic) num_threads(threads))
    for (size_t i = 0; i < pieces; i++) read_piece(&p[i], place, columns, &list->ray[p[i].number], skip_bad);
    for (size_t i = 0; i < pieces; i++) {
        if (p[i].bad && !skip_bad) fail_input("%s:%zu: %s", r.source, p[i].bad_line, p[i].why);
        if (p[i].bad && !first_bad) first_bad = &p[i];
        memmove(&list->ray[list->count], &list->ray[p[i].number], bad ? p[i].good * sizeof *list->ray : 0);
        list->count += p[i].good;
        bad += p[i].bad;
    }
    for (size_t i = 0; i < list->count && list->named; i++) {
        const size_t length = strlen(list->ray[i].id);
        if (length > list->longest_id) list->longest_id = length;
    }
    if (bad)
        note("%s: %zu bad row%s skipped, the first in line %zu: %s", r.source, bad, bad == 1 ? "" : "s",
             first_bad->bad_line, first_bad->why);
}

void rays_read(ray_list *list, const char *path, bool skip_bad)
{
    (ray_table_is(path) ? read_table : read_csv)(list, path, skip_bad);
}

launch rays_launch(const ray_block *b, size_t i)
{
    const double(*n)[TILE_RAYS] = b->number;
    return (launch){.ray = sgt_ray_between((sgt_vec3){n[0][i], n[1][i], n[2][i]},
                                           (sgt_vec3){n[3][i], n[4][i], n[5][i]}, b->ended ? n[6][i] : 0,
                                           b->ended ? n[7][i] : HUGE_VAL),
                    .number = (size_t)b->ray[i], .field = (size_t)b->field[i], .px = b->px[i],
                    .py = b->py[i], .id = b->id[i], .status = SGT_MET};
}

void rays_part(const ray_list *list, size_t first, size_t count, ray_block *to)
{
    if (!list->ray) {
        ray_table_part(list->table, first, count, to);
        return;
    }
    to->count = count, to->ended = true;
    for (size_t i = 0; i < count; i++) {
        const launch *l = &list->ray[first + i];
        const sgt_ray *r = &l->ray;
        const double number[] = {r->o.x, r->o.y, r->o.z, r->d.x, r->d.y, r->d.z, r->tmin, ray_end(r)};
        for (int k = 0; k < 8; k++) to->number[k][i] = number[k];
        to->ray[i] = (long long)l->number, to->id[i] = l->id;
    }
}

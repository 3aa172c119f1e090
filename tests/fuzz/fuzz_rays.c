// SPDX-License-Identifier: MIT
/* fuzz_rays.c - bytes as a file of rays, and as the text of --ray.
 *
 * The first byte says how it is read: bit 0, --skip-bad; bit 1, as --ray.  rays.c is built to cut the text
 * into pieces of 64 bytes and what is left of a line.  A second reader, made here out of the words of
 * rays.c and strtod, says what each line holds; both must agree on every ray to the bit, on which rows are
 * bad and how many, and on the line of the first. */
#include "tool.h"

#include "../../src/text/number.h"
#include "../../src/tool/read/rays.h"

#include <ctype.h>
#include <sagitta/surfaces.h>

static const char *const names[] = {"ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax", "id"};
enum { NAMES = 9, MOST_FIELDS = 40 };

/* One line, split; its bytes are copied. */
typedef struct row { int count; bool good; char *field[MOST_FIELDS]; char room[8000]; } row;

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

static void split_line(row *r, const char *line, size_t length)
{
    char *to = r->room;
    size_t i = 0;
    r->count = 0, r->good = length < sizeof r->room / 2 && !memchr(line, 0, length);
    for (bool more = r->good; more && r->count < MOST_FIELDS;) {
        while (i < length && is_blank(line[i])) i++;
        r->field[r->count++] = to;
        if (i < length && line[i] == '"') {
            bool closed = false;
            for (i++; i < length && !closed; i++) {
                closed = line[i] == '"' && !(i + 1 < length && line[i + 1] == '"');
                if (line[i] == '"' && !closed) i++;
                if (!closed) *to++ = line[i];
            }
            while (i < length && is_blank(line[i])) i++;
            if (!closed || (i < length && line[i] != ',')) r->good = false;
        } else {
            char *from = to;
            while (i < length && line[i] != ',') *to++ = line[i++];
            while (to > from && is_blank(to[-1])) to--;
        }
        *to++ = 0;
        more = r->good && i < length;
        i++;
    }
}

/* A number as the manual has it, by strtod. */
static bool number_of(const char *text, double *x)
{
    const char *bare = text + (*text == '+' || *text == '-');
    double sign = *text == '-' ? -1 : 1;
    char word[8] = "", *end;
    for (size_t i = 0; i < sizeof word - 1 && bare[i]; i++) word[i] = (char)tolower((unsigned char)bare[i]);
    if (strcmp(word, "inf") == 0 || strcmp(word, ".inf") == 0) return *x = sign * HUGE_VAL, true;
    if (strcmp(word, "nan") == 0 || strcmp(word, ".nan") == 0) return *x = NAN, true;
    if (!isdigit((unsigned char)*bare) && *bare != '.') return false;
    *x = strtod(text, &end);
    return end != text && !*end && isfinite(*x);
}

static bool legal(const double v[8])
{
    double big = 0;
    for (int i = 0; i < 6; i++) {
        if (!isfinite(v[i])) return false;
        if (i >= 3) big = fmax(big, fabs(v[i]));
    }
    return big >= DBL_MIN && v[6] <= v[7] && v[6] < HUGE_VAL && v[7] > -HUGE_VAL;
}

static void require_ray(const launch *l, const double v[8])
{
    const double got[8] = {l->ray.o.x, l->ray.o.y, l->ray.o.z,  l->ray.d.x,
                           l->ray.d.y, l->ray.d.z, l->ray.tmin, l->ray.tmax};
    for (int i = 0; i < 8; i++) {
        if (i == 7 && v[7] == 0) { /* written down, it means 0, and not the default of sgt_ray */
            REQUIRE(got[7] == 0 && signbit(got[7]), "tmax %a", got[7]);
            continue;
        }
        REQUIRE(same(got[i], v[i]), "row %zu, %s: %a, and the text says %a", l->number, names[i], got[i],
                v[i]);
    }
    REQUIRE(sgt_intersect((sgt_surface){&sgt_conic_ops, &(sgt_conic){0}}, l->ray, NULL).status != SGT_INVALID,
            "row %zu is no ray", l->number);
}

/* What is printed reads back. */
static void require_print(double x)
{
    char text[NUMBER_SIZE];
    double back;
    for (int hexadecimal = 0; hexadecimal < 2; hexadecimal++) {
        int length = number_print(text, x, hexadecimal);
        REQUIRE(length == (int)strlen(text) && length < NUMBER_SIZE, "%a: \"%s\", %d", x, text, length);
        REQUIRE(number_read(text, &back) && same(x, back), "%a: \"%s\" reads back as %a", x, text, back);
        REQUIRE(!isfinite(x) || same(strtod(text, NULL), x), "%a: \"%s\"", x, text);
    }
    if (isfinite(x) && x > 0 && x < 1e300)
        REQUIRE(number_round_up(x) >= x && number_round_up(x) <= x * 1.02 + 1e-320, "%a: %a", x,
                number_round_up(x));
    for (int digits = 1; digits <= 9; digits += 4) {
        int length = number_print_short(text, x, digits);
        REQUIRE(length == (int)strlen(text) && length < NUMBER_SIZE, "%a: \"%s\", %d", x, text, length);
        if (isfinite(x) && fabs(x) < 1e300 && fabs(x) > 1e-300)
            REQUIRE(fabs(strtod(text, NULL) - x) <= 0.6 * fabs(x) * pow(10, 1 - digits),
                    "%a in %d digits: \"%s\"", x, digits, text);
    }
}

typedef struct ledger { size_t good, bad, first_bad, rows; bool header; } ledger;

/* Goes through the text beside the list (NULL: it was refused) and says what there is. */
static ledger audit(const char *text, size_t size, const ray_list *list, bool skip_bad)
{
    static row r;
    int place[NAMES], columns = 0;
    ledger told = {0};
    size_t at = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    for (size_t line = 1; at < size; line++) {
        const char *stop = memchr(text + at, '\n', size - at);
        size_t length = stop ? (size_t)(stop - text) - at : size - at, i = 0;
        const char *s = text + at;
        at += length + 1;
        while (i < length && is_blank(s[i])) i++;
        if (i == length) continue;
        split_line(&r, s, length);
        if (!told.header) {
            if (!r.good) return told;
            for (int c = 0; c < NAMES; c++) {
                place[c] = -1;
                for (int f = 0; f < r.count; f++)
                    /* twice */
                    if (strcmp(r.field[f], names[c]) == 0) place[c] = place[c] < 0 ? f : NAMES * 100;
                if (place[c] > NAMES * 99 || (c < 6 && place[c] < 0)) return told;
            }
            columns = r.count;
            int known = 0;
            for (int c = 0; c < NAMES; c++) known += place[c] >= 0;
            if (known != columns) return told;
            told.header = true;
            continue;
        }
        double v[9] = {0, 0, 0, 0, 0, 0, 0, HUGE_VAL, 0};
        bool good = r.good && r.count == columns;
        for (int c = 0; good && c < 8; c++)
            if (place[c] >= 0) good = number_of(r.field[place[c]], &v[c]);
        good = good && legal(v);
        told.rows++;
        if (!good && told.bad++ == 0) told.first_bad = line;
        if (good && list && (skip_bad || !told.bad)) {
            REQUIRE(told.good < list->count, "ray %zu of %zu", told.good, list->count);
            const launch *l = &list->ray[told.good];
            REQUIRE(l->number == told.rows - 1, "row %zu is told as %zu", told.rows - 1, l->number);
            require_ray(l, v);
            REQUIRE(place[8] < 0 ? !l->id : l->id && strcmp(l->id, r.field[place[8]]) == 0,
                    "row %zu, id \"%s\"", l->number, l->id ? l->id : "none");
            for (int k = 0; k < 8 && told.good < 50; k++) require_print(v[k]);
        }
        told.good += good;
    }
    return told;
}

static void read_file(const char *text, size_t size, bool skip_bad)
{
    static ray_list list;
    list = (ray_list){0};
    read_anew((const uint8_t *)text, size);
    if (setjmp(refused) == 0) {
        rays_read(&list, "text", skip_bad);
        ledger told = audit(text, size, &list, skip_bad);
        REQUIRE(told.header && list.count == told.good, "%zu rays, and the text has %zu", list.count,
                told.good);
        REQUIRE(skip_bad || !told.bad, "%zu rows are bad, the first in line %zu", told.bad, told.first_bad);
        if (told.bad) {
            size_t many, line;
            REQUIRE(sscanf(noted, "text: %zu bad row%*[s] skipped, the first in line %zu", &many, &line) ==
                            2 ||
                        sscanf(noted, "text: %zu bad row skipped, the first in line %zu", &many, &line) == 2,
                    "\"%s\"", noted);
            REQUIRE(many == told.bad && line == told.first_bad, "%zu bad, the first in line %zu: \"%s\"",
                    told.bad, told.first_bad, noted);
        } else {
            REQUIRE(!*noted, "\"%s\"", noted);
        }
    } else {
        ledger told = audit(text, size, NULL, skip_bad);
        REQUIRE(status == EXIT_BAD_INPUT && strncmp(message, "text:", 5) == 0 && message_length > 8,
                "status %d: \"%s\"", (int)status, message);
        REQUIRE(!told.header || !told.rows || (told.bad && !skip_bad), "%zu good rows are refused: \"%s\"",
                told.good, message);
        if (told.header && told.rows)
            REQUIRE(strtoul(message + 5, NULL, 10) == told.first_bad, "line %zu: \"%s\"", told.first_bad,
                    message);
    }
}

static void read_option(const char *text)
{
    static ray_list list;
    list = (ray_list){0};
    double v[9] = {0, 0, 0, 0, 0, 0, 0, HUGE_VAL};
    char copy[500], *rest = copy, *word;
    int count = 0;
    bool good = strlen(text) < 400;
    if (good) strcpy(copy, text);
    for (; good && (word = strtok_r(rest, " \t\n,", &rest)); count++)
        good = number_of(word, &v[count < 8 ? count : 8]);
    good = good && (count == 6 || count == 8) && legal(v);
    read_anew((const uint8_t *)text, strlen(text));
    if (setjmp(refused) == 0) {
        rays_parse(&list, text);
        REQUIRE(good && list.count == 1, "\"%s\" is accepted", text);
        require_ray(&list.ray[0], v);
    } else {
        REQUIRE(!good && status == EXIT_BAD_INPUT && strncmp(message, "--ray: ", 7) == 0 &&
                    message_length > 9,
                "\"%s\": \"%s\"", text, message);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 1) return 0;
    unsigned how = data[0];
    const char *from = (const char *)data + 1;
    size_t length = size - 1;
    if (how & 2) {
        char *text = malloc(length + 1);
        memcpy(text, from, length);
        text[length] = 0;
        read_option(text);
        free(text);
    } else {
        read_file(from, length, how & 1);
    }
    free_all();
    return 0;
}

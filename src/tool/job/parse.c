// SPDX-License-Identifier: MIT
/* parse.c - the arguments of a command, and its help, of its table of options.
 *
 * HELP IN ONE SCREEN is what a newcomer needs: what the command is for, the options that are used most, and
 * examples.  --help all has the columns and every option. */
#include "parse.h"

#include "../../text/number.h"
#include "../base/bytes.h"
#include "../base/memory.h"
#include "../read/lens.h"

#include <math.h>
#include <sagitta/sagitta.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void take_quiet(void *into, const option_row *row, const char *value)
{
    (void)into, (void)row, (void)value;
    lens_be_quiet();
}

static void take_version(void *into, const option_row *row, const char *value)
{
    (void)into, (void)row, (void)value;
    command_version();
}

/* What each command has. */
static const option_row help_rows[] = {
    {"quiet", NULL, "print no remarks on a lens file, or how it was read; or -q", OPTION_TAKE,
     .take = take_quiet},
    {"help", NULL,
     "the first things to know; or -h.  --help all: this text\n"
     "--help options: the options as a table, for programs", .kind = OPTION_FLAG},
    {"version", NULL, "the version of sagitta", OPTION_TAKE, .take = take_version},
    {0},
};
static const option_group help_group = {OPTIONS_SHARED, NULL, .row = help_rows};

static const option_group *group_at(const command *c, size_t i)
{
    return i < COMMAND_GROUPS && c->group[i] ? c->group[i] : &help_group;
}

/* Calls `each` for every row. */
typedef struct found_row { const option_row *row; option_of of; } found_row;

enum { ROWS_MOST = 80 };

static size_t all_rows(const command *c, found_row out[ROWS_MOST])
{
    size_t n = 0;
    for (size_t i = 0;; i++) {
        const option_group *g = group_at(c, i);
        for (const option_row *r = g->row; r->name; r++) out[n++] = (found_row){r, g->of};
        if (g == &help_group) return n;
    }
}

/* ------------------------------------------------------------------- help */

enum { SCREEN = 100, INDENT = 21 };

void command_print_words(const char *text, int indent)
{
    for (int at = indent; *text; text += strspn(text, " \n")) {
        const int length = (int)strcspn(text, " \n"), gap = at > indent;
        if (at + gap + length > SCREEN) printf("\n%*s", indent, ""), at = indent;
        else if (gap) putchar(' '), at++;
        printf("%.*s", length, text);
        at += length, text += length;
        if (text[0] == ' ' && text[1] == ' ') putchar(' '), at++; /* between sentences */
    }
    putchar('\n');
}

void command_print_item(const char *name, const char *words)
{
    const int n = printf("  %s", name);
    if (n >= INDENT) printf("\n%*s", INDENT, "");
    else printf("%*s", INDENT - n, "");
    command_print_words(words, INDENT);
}

/* Prints a row, all of it or what has room in its first line. */
static void print_option(const option_row *r, bool all)
{
    char line[SCREEN - INDENT + 1];
    size_t first = strcspn(r->help, "\n");
    const char *more = r->help[first] ? r->help + first + 1 : NULL, *dots = "";
    if (!all && first >= sizeof line)
        for (first = sizeof line - 5, dots = " ..."; first > 0 && r->help[first] != ' ';) first--;
    const int n = printf("  --%s%s%s", r->name, r->value ? " " : "", r->value ? r->value : "");
    if (n >= INDENT) printf("\n%*s", INDENT, "");
    else printf("%*s", INDENT - n, "");
    if (!all) {
        printf("%.*s%s\n", (int)first, r->help, dots);
        return;
    }
    command_print_words(memory_text(r->help, first), INDENT);
    if (!more) return;
    printf("%*s", INDENT, "");
    command_print_words(more, INDENT);
}

static void print_often(const command *c)
{
    found_row row[ROWS_MOST];
    const size_t rows = all_rows(c, row);
    char *rest, *list = memory_text(c->often, strlen(c->often));
    for (char *word = strtok_r(list, " ", &rest); word; word = strtok_r(NULL, " ", &rest))
        for (size_t i = 0; i < rows; i++)
            if (strcmp(word, row[i].row->name) == 0) print_option(row[i].row, false);
}

static void print_all(const command *c)
{
    for (size_t i = 0;; i++) {
        const option_group *g = group_at(c, i);
        if (!g->row->name) continue;
        if (g->title && !g->hidden) printf("\n%s\n", g->title);
        for (const option_row *r = g->row; r->name && !g->hidden; r++)
            if (r->kind != OPTION_REFUSED) print_option(r, true);
        if (c->rays && !g->hidden && strcmp(g->row->name, "fan") == 0)
            printf("  none of these      %s\n", c->rays);
        if (g == &help_group) break;
    }
    printf("\nExit status\n%s", c->exits ? c->exits : "  0  every ray is decided (a miss is a decision)\n"
                                                      "  1  some ray is undecided\n"
                                                      "  2  wrong arguments\n"
                                                      "  3  bad input, or output that cannot be written\n");
}

/* The types of surfaces, with blanks between. */
static const char *type_words(void)
{
    const char *text = "";
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        text = memory_print("%s%s%s", text, *text ? " " : "", b->type);
    return memory_print("%s formula", text);
}

/* For programs: name, value, its words, help, with tabs between; "-": none. */
static void print_table(const command *c)
{
    for (size_t i = 0;; i++) {
        const option_group *g = group_at(c, i);
        for (const option_row *r = g->row; r->name && !g->hidden; r++) {
            const bool columns = c->columns && strcmp(r->name, "columns") == 0;
            const bool types = r->value && strcmp(r->name, "surface") == 0 && strcmp(r->value, "SPEC") == 0;
            const char *words = columns ? c->columns(c->context) : types ? type_words() : r->words;
            if (r->kind != OPTION_REFUSED)
                printf("--%s\t%s\t%s\t%.*s\n", r->name, r->value ? r->value : "-", words ? words : "-",
                       (int)strcspn(r->help, "\n"), r->help);
        }
        if (g == &help_group) print_and_end("%s", "");
    }
}

_Noreturn static void print_help(const command *c, bool all)
{
    printf("sagitta %s %s\n\n", c->name, c->usage);
    command_print_words(c->what, 0);
    if (all) {
        if (c->all || c->print_all) printf("\n%s", c->all ? c->all : "");
        if (c->print_all) c->print_all(c->context);
        print_all(c);
    } else {
        puts("\nOptions that are used most");
        print_often(c);
        if (c->rays) printf("Rays without an option for them: %s\n", c->rays);
    }
    printf("\nExamples\n%s", c->examples);
    printf("\nMore\n");
    if (!all) printf("  sagitta %s --help all: columns, every option, exit status\n", c->name);
    printf("  %s\n", c->docs);
    print_and_end("%s", "");
}

void command_version(void) { print_and_end("sagitta %s\n", sgt_version()); }

/* -------------------------------------------------------------- arguments */

double options_number(const char *option, const char *text)
{
    double x;
    if (!number_read(text, &x) || !isfinite(x))
        fail_usage("--%s must be a finite number, not \"%s\"", option, text);
    return x;
}

long options_integer(const char *option, const char *text, long lowest, long highest)
{
    long n;
    if (!number_read_integer(text, lowest, highest, &n))
        fail_usage("--%s must be a whole number from %ld to %ld, not \"%s\"", option, lowest, highest, text);
    return n;
}

static double length_of(const char *option, const char *text)
{
    const double x = options_number(option, text);
    if (x < 0) fail_usage("--%s must not be negative, but is %s", option, text);
    return x;
}

int options_word(const option_row *r, const char *value)
{
    char said[200] = "", words[200];
    char *rest, *word;
    int n = 0, found = -1;
    size_t at = 0;
    snprintf(words, sizeof words, "%s", r->words);
    for (word = strtok_r(words, " |", &rest); word; n++) {
        char *next = strtok_r(NULL, " |", &rest);
        if (strcmp(value, word) == 0) found = n;
        at += (size_t)snprintf(said + at, sizeof said - at, "%s%s", n == 0 ? "" : next ? ", " : " or ", word);
        word = next;
    }
    if (found < 0) fail_usage("--%s must be %s, not \"%s\"", r->name, said, value);
    return (int)r->least + found;
}

static void take_row(const option_row *r, void *into, const char *value)
{
    char *to = into ? (char *)into + r->to : NULL; /* a command of which nothing is kept has none */
    const bool yes = true;
    double x;
    int n;
    switch (r->kind) {
    case OPTION_FLAG: memcpy(to, &yes, sizeof yes); return;
    case OPTION_TEXT: memcpy(to, &value, sizeof value); return;
    case OPTION_WHOLE:
        n = (int)options_integer(r->name, value, r->least, r->most);
        memcpy(to, &n, sizeof n);
        return;
    case OPTION_REAL:
    case OPTION_LENGTH:
        x = (r->kind == OPTION_REAL ? options_number : length_of)(r->name, value);
        memcpy(to, &x, sizeof x);
        return;
    case OPTION_WORD:
        n = options_word(r, value);
        memcpy(to, &n, sizeof n);
        return;
    case OPTION_TAKE: r->take(into, r, value); return;
    case OPTION_REFUSED: fail_usage("%s", r->help);
    }
}

static bytes arguments;

const char *command_arguments(size_t *length) { return *length = arguments.length, arguments.at; }

static void keep_argument(const char *text) { bytes_put(&arguments, text, strlen(text) + 1); }

static void keep_option(const option_row *r, const char *value)
{
    static const char *const others[] = {"output", "shard", "resume", "threads", "progress"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(r->name, others[i]) == 0) return;
    keep_argument(r->value ? memory_print("--%s=%s", r->name, value) : memory_print("--%s", r->name));
}

/* The option that does what another name asks for, and what to write behind it; NULL: no such name is
 * known. */
static const char *usual_option(const char *word, const struct option known[])
{
    static const struct { const char *words, *option; } usual[] = {
        {" plot draw image svg png pdf figure-file graph chart ", "picture"},
        {" csv json npy ", "format"}, {" lambda wl wave wavelength-um nm ", "wavelength"},
        {" jobs cores parallel cpus ", "threads"}, {" angle fov ", "field"},
        {" out file save ", "output"}, {" refocus focus shift ", "defocus"},
        {" rings ", "hexapolar"}, {" nrays number rays-number ", "grid"},
        {" thickness radius curvature conic glass-name index semi_diameter semi-diameter coefficients "
         "decenter tilt ", "set"},
        {" lat place position location ", "from"}, {" az azimuth direction ", "look"},
        {" prove certify certain ", "proof"}, {" monte-carlo montecarlo mc ", "trials"},
    };
    const char *own = memory_print(" %s ", word);
    for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
        for (const struct option *k = known; strstr(usual[i].words, own) && k->name; k++)
            if (strcmp(k->name, usual[i].option) == 0)
                return strcmp(k->name, "set") == 0      ? memory_print("set surfaces[N].%s=VALUE", word)
                       : strcmp(k->name, "format") == 0 ? memory_print("format %s", word)
                                                        : k->name;
    return NULL;
}

/* The option that was meant by "--feild", or "--feild=2"; NULL: none is a slip away. */
static const char *meant(const char *argument, const struct option known[])
{
    if (strncmp(argument, "--", 2) != 0) return NULL;
    const char *word = memory_text(argument + 2, strcspn(argument + 2, "="));
    const char *usual = usual_option(word, known);
    if (usual) return usual;
    for (; known->name; known++)
        if (fail_is_slip(word, known->name)) return known->name;
    return NULL;
}

unsigned command_read(const command *c, void *own, void *job, void *shared, int argc, char *argv[])
{
    void *const into[] = {own, job, job, shared};
    enum { CODE = 256 };
    found_row row[ROWS_MOST];
    const size_t rows = all_rows(c, row);
    struct option known[ROWS_MOST + 1] = {{0}};
    unsigned given = 0;
    bool help = false;
    size_t output = rows, quiet = rows;
    arguments.length = 0;
    keep_argument(c->name);
    for (size_t i = 0; i < rows; i++) {
        const option_row *r = row[i].row;
        known[i] = (struct option){r->name, r->value ? required_argument : no_argument, NULL, CODE + (int)i};
        if (strcmp(r->name, "output") == 0) output = i;
        if (r->take == take_quiet) quiet = i;
    }
    for (int code; (code = getopt_long(argc, argv, output < rows ? "hqo:" : "hq", known, NULL)) != -1;) {
        if (code == '?') fail_hint(meant(argv[optind - 1], known));
        const size_t i = code == 'o' ? output : code == 'q' ? quiet : (size_t)(code - CODE);
        if (code == 'h' || row[i].row == &help_rows[1]) {
            help = true;
            continue;
        }
        keep_option(row[i].row, optarg);
        take_row(row[i].row, into[row[i].of], optarg);
        given |= 1u << row[i].of;
    }
    keep_argument("--");
    for (int k = optind; k < argc; k++) keep_argument(argv[k]);
    const char *how = optind < argc ? argv[optind] : "";
    if (help && strcmp(how, "options") == 0) print_table(c);
    if (help) print_help(c, strcmp(how, "all") == 0);
    return given;
}

const char *command_file(const command *c, const char *kind, int argc, char *argv[])
{
    if (optind == argc) fail_usage("the %s is missing: sagitta %s %s", kind, c->name, c->usage);
    if (optind + 1 < argc)
        fail_usage("unexpected argument \"%s\"; %s takes one %s", argv[optind + 1], c->name, kind);
    return argv[optind];
}

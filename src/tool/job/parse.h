// SPDX-License-Identifier: MIT
/* parse.h - a command and its options as a table: getopt, --help and the list of commands have it from
 * here. */
#ifndef TOOL_PARSE_H
#define TOOL_PARSE_H
#include "../base/fail.h"

#include <getopt.h>
#include <stdbool.h>
#include <stddef.h>

/* What becomes of the value of an option.  `to` is the place in the struct of its group. */
typedef enum option_kind {
    OPTION_FLAG,   /* there is none: sets a bool */
    OPTION_TEXT,   /* const char * */
    OPTION_WHOLE,  /* int, from `least` to `most` */
    OPTION_REAL,   /* double, finite */
    OPTION_LENGTH, /* double, not negative */
    OPTION_WORD,   /* int: which of `words`, counted from `least` */
    OPTION_TAKE,   /* take() has it */
    OPTION_REFUSED /* an error, which `help` tells: an old spelling, say */
} option_kind;

typedef struct option_row option_row;
struct option_row {
    const char *name, *value; /* --name VALUE; NULL: nothing follows */
    const char *help;         /* lines; the first by itself is in the short help */
    option_kind kind;
    size_t to;
    long least, most;
    const char *words;        /* with blanks between */
    void (*take)(void *into, const option_row *row, const char *value);
};

/* Rows, up to one without a name, whose values go into one struct: OPTIONS_OF_RAYS into that of the job. */
typedef enum option_of { OPTIONS_OWN, OPTIONS_OF_JOB, OPTIONS_OF_RAYS, OPTIONS_SHARED } option_of;
typedef struct option_group {
    option_of of;
    const char *title;     /* NULL: they stand under the last one */
    const option_row *row;
    bool hidden;           /* for a command that tells why it does not take them */
} option_group;

enum { COMMAND_GROUPS = 16 };

typedef struct command command;
struct command {
    const char *name, *usage, *brief; /* in one line: what follows the name; what it is for */
    const char *what;                 /* in two or three sentences */
    const char *often;                /* the options of the short help, with blanks between */
    const char *rays;                 /* "--fan 5": the rays where no pattern is given; NULL: no patterns */
    const char *examples;             /* lines */
    const char *docs;                 /* a page */
    const char *all;                  /* for --help all: the columns, and what else there is to say */
    void (*print_all)(const void *context); /* or what prints it; NULL: none */
    const char *(*columns)(const void *context); /* their names, blanks between, for completion; NULL: none */
    const void *context;
    const char *exits;                /* the exit status; NULL: of rays */
    const option_group *group[COMMAND_GROUPS];
    exit_status (*run)(const command *c, int argc, char *argv[]);
};

/* Sets own, job and shared by the arguments; optind is then the first that is none.  Returns which were
 * given, as bits 1 << option_of.  --help and --version end the command here; so do wrong options, with a
 * usage error. */
unsigned command_read(const command *c, void *own, void *job, void *shared, int argc, char *argv[]);

/* The arguments of the last command_read that say what is computed, each with a zero byte behind it, the
 * command first: all but where it goes, how it is divided and in how many threads. */
const char *command_arguments(size_t *length);

/* Print a line of help with its words, and words in lines of at most 100 columns (from the second on they
 * are indented). */
void command_print_item(const char *name, const char *words);
void command_print_words(const char *words, int indent);

/* Which of the words of a row, with blanks or | between, counted from `least`. */
int options_word(const option_row *row, const char *value);

/* The one file among the arguments that are left. */
const char *command_file(const command *c, const char *kind, int argc, char *argv[]);

/* Read the value of an option; a bad one ends with a usage error. */
double options_number(const char *option, const char *text);
long options_integer(const char *option, const char *text, long lowest, long highest);

_Noreturn void command_version(void);

#endif

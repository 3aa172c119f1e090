// SPDX-License-Identifier: MIT
/* fail.h - messages on standard error, and the exit status. */
#ifndef TOOL_FAIL_H
#define TOOL_FAIL_H
#include <stdbool.h>

typedef enum exit_status {
    EXIT_DECIDED = 0,   /* every ray is decided; a miss is a decision */
    EXIT_UNDECIDED = 1, /* some ray is undecided */
    EXIT_USAGE = 2,     /* wrong arguments */
    EXIT_BAD_INPUT = 3, /* a bad surface, lens, ray or file; or output that cannot be written */
    EXIT_BROKEN = 4     /* a limit is broken by a ray */
} exit_status;

#define LIKE_PRINTF(text, first) __attribute__((format(printf, text, first)))

/* Sets the subcommand's name, for the hint under a usage error. */
void fail_name(const char *command);

/* Print a message and end the command, with EXIT_USAGE or EXIT_BAD_INPUT. */
_Noreturn void fail_usage(const char *format, ...) LIKE_PRINTF(1, 2);
_Noreturn void fail_input(const char *format, ...) LIKE_PRINTF(1, 2);

/* For one of several ranks (ranks.h): what its messages begin with; whether it says why it fails, and whether
 * it prints notes; and what is done before it ends with a status.  It is copied. */
typedef struct fail_speaker {
    const char *who;
    bool (*fails)(void), (*notes)(void);
    void (*end)(int status);
} fail_speaker;
void fail_as(const fail_speaker *speaker);

/* Set while several threads work: an error then ends the command without giving back what they use. */
void fail_in_threads(bool now);

/* What is to be done first where an error ends the command while other threads work: nothing is then given
 * back by exit. */
void fail_first(void (*tidy)(void));
void fail_tidy(void); /* calls it, before an end that is no exit */

/* Prints only the hint, and ends with EXIT_USAGE: getopt has printed the message.  The hint is where --help
 * is, and before that the option that was meant; near: NULL if it is not known. */
_Noreturn void fail_hint(const char *near);

/* Is the word the other one with a letter wrong, too many, missing, or two of them turned? */
bool fail_is_slip(const char *word, const char *other);

/* Prints on standard output (as for --help) and ends: with EXIT_DECIDED, or EXIT_BAD_INPUT if it could not be
 * written. */
_Noreturn void print_and_end(const char *format, ...) LIKE_PRINTF(1, 2);

/* Prints a message on standard error and goes on. */
void note(const char *format, ...) LIKE_PRINTF(1, 2);

/* The same without the name of the command: for what begins with FILE:LINE: of an input. */
void remark(const char *format, ...) LIKE_PRINTF(1, 2);

#endif

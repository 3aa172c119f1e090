/* fail.h - what the command says on standard error, and with what status it ends. */
#ifndef TOOL_FAIL_H
#define TOOL_FAIL_H

typedef enum exit_status {
    EXIT_DECIDED = 0,   /* every ray has its answer: a miss is one */
    EXIT_UNDECIDED = 1, /* some ray has none */
    EXIT_USAGE = 2,     /* the arguments */
    EXIT_BAD_INPUT = 3 /* what they name: a surface, a lens, rays, a file; an output that cannot be written */
} exit_status;

#define LIKE_PRINTF(text, first) __attribute__((format(printf, text, first)))

/* The subcommand that runs, for the hint under a usage error. */
void fail_name(const char *command);

_Noreturn void fail_usage(const char *format, ...) LIKE_PRINTF(1, 2);
_Noreturn void fail_hint(void); /* a usage error that has been told: where the help is */
_Noreturn void fail_input(const char *format, ...) LIKE_PRINTF(1, 2);
/* on standard output, as --help, and ends: well, if it could be written */
_Noreturn void print_and_end(const char *format, ...) LIKE_PRINTF(1, 2);
void note(const char *format, ...) LIKE_PRINTF(1, 2);

#endif

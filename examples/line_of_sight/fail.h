// SPDX-License-Identifier: MIT
/* fail.h - errors end the program where they are found. */
#ifndef LINE_OF_SIGHT_FAIL_H
#define LINE_OF_SIGHT_FAIL_H

enum { EXIT_DECIDED = 0, EXIT_UNDECIDED = 1, EXIT_USAGE = 2, EXIT_BAD_INPUT = 3 };

#ifdef __cplusplus
#define NO_RETURN [[noreturn]]
extern "C" {
#else
#define NO_RETURN _Noreturn
#endif

NO_RETURN void fail_usage(const char *format, ...) __attribute__((format(printf, 1, 2)));
NO_RETURN void fail_hint(void); /* a usage error that has been told: where the help is */
NO_RETURN void fail_input(const char *format, ...) __attribute__((format(printf, 1, 2)));

#ifdef __cplusplus
}
#endif
#endif

// SPDX-License-Identifier: MIT
/* fail.h - errors end the program where they are found. */
#ifndef RENDER_FAIL_H
#define RENDER_FAIL_H
#include <stddef.h>

enum { EXIT_USAGE = 2, EXIT_BAD_INPUT = 3 };

#define LIKE_PRINTF(text, first) __attribute__((format(printf, text, first)))

_Noreturn void fail_usage(const char *format, ...) LIKE_PRINTF(1, 2);
_Noreturn void fail_hint(void); /* a usage error that has been told: where the help is */
_Noreturn void fail_input(const char *format, ...) LIKE_PRINTF(1, 2);

/* realloc for n things, at least one; where there is no memory the program ends. */
void *room(void *old, size_t n, size_t size);

#endif

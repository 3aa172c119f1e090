// SPDX-License-Identifier: MIT
/* say.h - a text that grows in the room of a caller; short numbers. */
#ifndef SGT_LENS_SAY_H
#define SGT_LENS_SAY_H
#include "../../text/number.h"

#include <stdbool.h>
#include <stddef.h>

/* begin: size and room; length counts what did not fit, too. */
typedef struct saying { size_t size; char *text; size_t length; } saying;

/* Appends, as printf does. */
#ifdef __GNUC__
__attribute__((format(printf, 2, 3)))
#endif
void sgt_say(saying *s, const char *format, ...);

/* Is the room of a struct, [4], zero?  If not, says that a later version has what is asked for. */
bool sgt_say_unknown(saying *s, const unsigned long long reserved[], const char *type);

/* A number as a text; so many digits, 0: enough to read it back. */
typedef struct written { char text[NUMBER_SIZE]; } written;
written sgt_written(double x, int digits);

#endif

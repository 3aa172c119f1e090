// SPDX-License-Identifier: MIT
/* output.h - files that are whole or not there. */
#ifndef RENDER_OUTPUT_H
#define RENDER_OUTPUT_H
#include <stdbool.h>
#include <stddef.h>

/* Bytes that grow; free(b->at) is the caller's. */
typedef struct bytes { unsigned char *at; size_t n, room; } bytes;
void bytes_add(bytes *b, const void *from, size_t n);

/* Can the file be written?  Ends the program if not; leaves no trace. */
void output_try(const char *file);

/* Writes the bytes under a temporary name in the same folder and renames that.  So whoever looks at the
 * file sees what it was before or all of it, whenever the program is killed.  What is no ordinary file (a
 * pipe) is written as it is.  What goes wrong ends the program, and the file is as it was. */
void output_write(const char *file, const bytes *b);

/* Reads a whole file; false: it is not there, or not readable. */
bool output_read(const char *file, bytes *to);

#endif

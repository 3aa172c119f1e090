// SPDX-License-Identifier: MIT
/* number.h - doubles as text, there and back; the point is a point in any locale. */
#ifndef SGT_TEXT_NUMBER_H
#define SGT_TEXT_NUMBER_H
#include <stdbool.h>
#include <stddef.h>

/* Reads the whole text as a number: decimal (1e-06, .5, 5.), hexadecimal (0x1.8p+1), .inf or
 * inf, .nan or nan, with or without a sign.  false: blanks, text behind it, or a number too
 * large for a double. */
bool number_read(const char *text, double *value);

/* Reads the decimal number that a text begins with, up to `end`.  Returns its length; 0: there is none, or it
 * is too large for a double. */
size_t number_read_first(const char *text, const char *end, double *value);

/* Reads a decimal number up to `end` (NULL: the whole text), and nothing else: not inf, nan, 0x1p3. */
bool number_read_decimal(const char *text, const char *end, double *value);

/* Reads a whole number from lowest to highest. */
bool number_read_integer(const char *text, long lowest, long highest, long *value);

/* Functions that print return the length of the text; what is behind it may be written over. */
enum { NUMBER_SIZE = 40 };

/* Prints the shortest of 15, 16 or 17 digits that reads back to the same double, or its
 * hexadecimal form; nan, inf, -inf. */
int number_print(char text[NUMBER_SIZE], double value, bool hexadecimal);

/* The same, decimal; *gap: at least |decimal - double|, and hardly more. */
int number_print_with_gap(char text[NUMBER_SIZE], double value, double *gap);

/* x > 0 rounded up to three significant digits (or x itself): not less than x, at most some 1 % more. */
double number_round_up(double x);
int number_print_up(char text[NUMBER_SIZE], double x); /* prints that */

/* Prints `digits` significant digits, for people; - for NaN. */
int number_print_short(char text[NUMBER_SIZE], double value, int digits);

int number_print_count(char text[NUMBER_SIZE], long long value);

#endif

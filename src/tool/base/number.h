/* number.h - doubles as text, there and back. */
#ifndef TOOL_NUMBER_H
#define TOOL_NUMBER_H
#include <stdbool.h>

/* The whole of the text as a number: decimal (1e-06, .5, 5.), hexadecimal (0x1.8p+1),
 * .inf or inf, .nan or nan, with a sign or without; no blanks, nothing behind it, and
 * nothing so large that it would become infinite. */
bool number_read(const char *text, double *value);

/* A whole number from lowest to highest. */
bool number_read_integer(const char *text, long lowest, long highest, long *value);

/* What prints returns the length of the text. */
enum { NUMBER_SIZE = 40 };

/* The shortest of 15, 16 or 17 digits that reads back to the same double, or its
 * hexadecimal form; nan, inf, -inf. */
int number_print(char text[NUMBER_SIZE], double value, bool hexadecimal);

/* How far the decimal that number_print writes is from the double it stands for. */
double number_print_gap(double value);

/* A double of three digits, or x itself: not less than x, and hardly more (x positive). */
double number_round_up(double x);

/* `digits` significant digits, for people; - for NaN. */
int number_print_short(char text[NUMBER_SIZE], double value, int digits);

int number_print_count(char text[NUMBER_SIZE], long long value);

#endif

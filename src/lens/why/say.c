// SPDX-License-Identifier: MIT
/* say.c - a text that grows in the room of a caller. */
#include "say.h"

#include <sagitta/sagitta.h>

#include <stdarg.h>
#include <stdio.h>

void sgt_say(saying *s, const char *format, ...)
{
    const size_t left = s->length < s->size ? s->size - s->length : 0;
    va_list values;
    va_start(values, format);
    int more = vsnprintf(left ? s->text + s->length : NULL, left, format, values);
    va_end(values);
    if (more > 0) s->length += (size_t)more;
}

bool sgt_say_unknown(saying *s, const unsigned long long reserved[], const char *type)
{
    if (!(reserved[0] | reserved[1] | reserved[2] | reserved[3])) return false;
    sgt_say(s, "the program asks for a member that %s of sagitta %s has not", type, sgt_version());
    return true;
}

written sgt_written(double x, int digits)
{
    written w;
    if (digits) number_print_short(w.text, x, digits);
    else number_print(w.text, x, false);
    return w;
}

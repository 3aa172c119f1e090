// SPDX-License-Identifier: MIT
/* limit.c - limits as text: NAME[ELEMENT] < NUMBER, with semicolons between. */
#include <sagitta/prove.h>

#include "../../text/number.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct limit_name { const char *name; bool above, at_element; } limit_name;
static const limit_name limit_names[] = {
    [SGT_PROVE_PASSES] = {"pass", true, false},      [SGT_PROVE_EX] = {"ex", false, false},
    [SGT_PROVE_EY] = {"ey", false, false},           [SGT_PROVE_SPOT] = {"spot", false, false},
    [SGT_PROVE_RMS] = {"rms", false, false},         [SGT_PROVE_OPD] = {"opd", false, false},
    [SGT_PROVE_OPD_RMS] = {"wavefront", false, false}, [SGT_PROVE_INCIDENCE] = {"incidence", false, true},
    [SGT_PROVE_CLEARANCE] = {"clearance", true, true},
};
enum { LIMIT_NAMES = sizeof limit_names / sizeof *limit_names };

const char *sgt_limit_verdict_text(int verdict)
{
    return verdict == SGT_LIMIT_PROVEN   ? "proven"
           : verdict == SGT_LIMIT_BROKEN ? "broken"
           : verdict == SGT_LIMIT_EMPTY  ? "empty"
                                         : "undecided";
}

const char *sgt_prove_quantity_text(int q)
{
    return q >= 0 && q < LIMIT_NAMES ? limit_names[q].name : "?";
}

void sgt_prove_limit_text(const sgt_prove_limit *l, char text[SGT_PROVE_LIMIT_SIZE])
{
    const limit_name *n = &limit_names[l->quantity];
    char at[24] = "";
    if (l->element) snprintf(at, sizeof at, "[%zu]", l->element);
    snprintf(text, SGT_PROVE_LIMIT_SIZE, "%s%s %c%s %.6g", n->name, at, n->above ? '>' : '<',
             l->or_equal ? "=" : "", l->value);
}

__attribute__((format(printf, 2, 3)))
static bool limit_fault(sgt_error *error, const char *words, ...)
{
    if (!error) return false;
    *error = (sgt_error){.line = 0};
    snprintf(error->key, sizeof error->key, "limit");
    va_list more;
    va_start(more, words);
    vsnprintf(error->words, sizeof error->words, words, more);
    va_end(more);
    return false;
}

static const char *past_blanks(const char *at)
{
    while (isspace((unsigned char)*at)) at++;
    return at;
}

/* One limit from *at on; sets *at behind it. */
static bool read_one(const char **at, sgt_prove_limit *out, sgt_error *error)
{
    const char *begin = past_blanks(*at), *to = begin;
    while (isalpha((unsigned char)*to)) to++;
    size_t q = 0;
    while (q < LIMIT_NAMES && !(strlen(limit_names[q].name) == (size_t)(to - begin) &&
                                strncmp(limit_names[q].name, begin, (size_t)(to - begin)) == 0))
        q++;
    if (q == LIMIT_NAMES)
        return limit_fault(error, "\"%.*s\" is no quantity: pass, ex, ey, spot, rms, opd, wavefront, "
                                  "incidence or clearance",
                           (int)(to - begin < 40 ? to - begin : 40), begin);
    const limit_name *n = &limit_names[q];
    *out = (sgt_prove_limit){.quantity = (sgt_prove_quantity)q};
    to = past_blanks(to);
    if (*to == '[') {
        if (!n->at_element) return limit_fault(error, "%s is not of an element", n->name);
        while (isdigit((unsigned char)*++to) && out->element < 1000000)
            out->element = 10 * out->element + (size_t)(*to - '0');
        if (!out->element || *to != ']')
            return limit_fault(error, "%s[...]: an element counts from 1, as in %s[3]", n->name, n->name);
        to = past_blanks(to + 1);
    }
    if (*to != '<' && *to != '>')
        return limit_fault(error, "%s must be followed by %c and a number", n->name, n->above ? '>' : '<');
    if ((*to == '>') != n->above)
        return limit_fault(error, "%s %c ...: only %s %c ... can be a limit of all rays", n->name, *to,
                           n->name, n->above ? '>' : '<');
    out->or_equal = to[1] == '=';
    to += out->or_equal ? 2 : 1;
    to = past_blanks(to);
    const size_t length = number_read_first(to, to + strlen(to), &out->value);
    if (!length || !isfinite(out->value))
        return limit_fault(error, "%s: \"%.20s\" is no number", n->name, to);
    *at = past_blanks(to + length);
    return true;
}

size_t sgt_prove_limit_read(const char *text, size_t most, sgt_prove_limit limit[], sgt_error *error)
{
    size_t count = 0;
    for (const char *at = text;;) {
        if (count == most) return limit_fault(error, "more than %zu limits", most);
        if (!read_one(&at, &limit[count++], error)) return 0;
        if (*at == ';') at = past_blanks(at + 1);
        else if (*at) return limit_fault(error, "\"%.20s\" behind a limit; put a semicolon between two", at);
        if (!*at) return count;
    }
}

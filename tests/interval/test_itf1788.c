// SPDX-License-Identifier: MIT
/* The operations of interval.h against ITF1788, the test suite of IEEE 1788 (itf1788/README.md).
 *
 *     test_itf1788 FILE...
 *
 * A case is "operation operands = result;". Taken are those with bare intervals, whose operation interval.h
 * has. The expected interval is the least one of doubles. Each end of ours is compared with it by how many
 * doubles it is farther out: none of the expected interval may be missed, and no end may be farther out
 * than the header allows, which is one double. An integer power is made of products: each may add a double,
 * and what the first ones add is raised to the power, too, so 2 |n| are allowed; and [0, 1 / DBL_MAX] where
 * x^-n may be infinite. Questions (isEmpty, subset, mid ...) are answered as expected. How many cases there
 * were of each is printed. An unknown operation fails, and so do too few cases: a file that was not read
 * would pass otherwise. */
#include <sagitta/interval.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef sgt_interval (*one_operand)(sgt_interval x);
typedef sgt_interval (*two_operands)(sgt_interval x, sgt_interval y);

static sgt_interval same(sgt_interval x) { return x; }
static sgt_interval reciprocal(sgt_interval x) { return sgt_interval_quotient(sgt_interval_of(1), x); }

static const struct { const char *name; one_operand at; } of_one[] = {
    {"pos", same}, {"neg", sgt_interval_negative}, {"recip", reciprocal}, {"sqr", sgt_interval_square},
    {"sqrt", sgt_interval_square_root}, {"exp", sgt_interval_exponential}, {"log", sgt_interval_logarithm},
    {"sin", sgt_interval_sine}, {"cos", sgt_interval_cosine}, {"tan", sgt_interval_tangent},
    {"asin", sgt_interval_arc_sine}, {"acos", sgt_interval_arc_cosine}, {"atan", sgt_interval_arc_tangent},
    {"sinh", sgt_interval_hyperbolic_sine}, {"cosh", sgt_interval_hyperbolic_cosine},
    {"tanh", sgt_interval_hyperbolic_tangent}, {"abs", sgt_interval_absolute}};

static const struct { const char *name; two_operands at; } of_two[] = {
    {"add", sgt_interval_sum}, {"sub", sgt_interval_difference}, {"mul", sgt_interval_product},
    {"div", sgt_interval_quotient}, {"pow", sgt_interval_real_power}, {"atan2", sgt_interval_angle},
    {"min", sgt_interval_minimum}, {"max", sgt_interval_maximum},
    {"intersection", sgt_interval_intersection}, {"convexHull", sgt_interval_hull}};

/* What interval.h has not, or means otherwise: operations, and questions about decorations. */
static const char elsewhere[] =
    " fma exp2 exp10 log2 log10 asinh acosh atanh sign ceil floor trunc roundTiesToEven roundTiesToAway "
    "isNaI equal less strictLess precedes strictPrecedes interior disjoint isEntire rad midRad mig inf sup "
    "numsToInterval textToInterval decorationPart intervalPart newDec setDec cancelPlus cancelMinus ";

static struct { unsigned long cases, tight, near, wide, skipped; } count;
static int faults;

static void fault(const char *line, const char *words)
{
    if (faults++ < 20) printf("%s: %s\n", words, line);
}

/* Neighbours are 1 apart, -0 and 0 the same. */
static int64_t place(double x)
{
    int64_t b;
    memcpy(&b, &x, sizeof b);
    return b < 0 ? INT64_MIN - b : b;
}

/* Reads "[a,b]", "[a]", "[empty]", "[entire]"; false: another thing. */
static bool read_interval(const char **at, sgt_interval *x)
{
    static const struct { const char *text; double lo, hi; } words[] = {
        {"[empty]", HUGE_VAL, -HUGE_VAL}, {"[entire]", -HUGE_VAL, HUGE_VAL}, {"[]", HUGE_VAL, -HUGE_VAL},
        {"[,]", -HUGE_VAL, HUGE_VAL}};
    while (**at == ' ') ++*at;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strncmp(*at, words[i].text, strlen(words[i].text)) == 0) {
            *x = sgt_interval_between(words[i].lo, words[i].hi);
            *at += strlen(words[i].text);
            return **at != '_';
        }
    if (**at != '[') return false;
    char *end;
    const double lo = strtod(*at + 1, &end);
    if (end == *at + 1) return false;
    double hi = lo;
    while (*end == ' ') end++;
    if (*end == ',') {
        const char *second = end + 1;
        hi = strtod(second, &end);
        if (end == second) return false;
    }
    while (*end == ' ') end++;
    if (*end != ']') return false;
    *at = end + 1;
    *x = sgt_interval_between(lo, hi);
    return **at != '_'; /* a decoration */
}

static bool equals_sign(const char **at)
{
    while (**at == ' ') ++*at;
    if (**at != '=') return false;
    ++*at;
    return true;
}

static void judge(const char *line, sgt_interval got, sgt_interval least, int64_t allowed)
{
    count.cases++;
    if (sgt_interval_is_empty(least)) {
        if (sgt_interval_is_empty(got)) count.tight++;
        else fault(line, "empty was expected");
        return;
    }
    if (!(got.lo <= least.lo && got.hi >= least.hi)) {
        fault(line, "a part is missed");
        return;
    }
    const int64_t below = place(least.lo) - place(got.lo), above = place(got.hi) - place(least.hi);
    const int64_t out = below > above ? below : above;
    if (out > allowed) fault(line, "farther out than allowed");
    if (out == 0) count.tight++;
    else if (out == 1) count.near++;
    else count.wide++;
}

/* true: the line was a case of an operation that gives an interval. */
static bool operation(const char *line, const char *name, const char *rest)
{
    sgt_interval x, y, least;
    for (size_t i = 0; i < sizeof of_one / sizeof *of_one; i++)
        if (strcmp(name, of_one[i].name) == 0) {
            if (read_interval(&rest, &x) && equals_sign(&rest) && read_interval(&rest, &least))
                judge(line, of_one[i].at(x), least, 1);
            else count.skipped++;
            return true;
        }
    for (size_t i = 0; i < sizeof of_two / sizeof *of_two; i++)
        if (strcmp(name, of_two[i].name) == 0) {
            if (read_interval(&rest, &x) && read_interval(&rest, &y) && equals_sign(&rest) &&
                read_interval(&rest, &least))
                judge(line, of_two[i].at(x, y), least, 1);
            else count.skipped++;
            return true;
        }
    if (strcmp(name, "pown") != 0) return false;
    char *end;
    bool read = read_interval(&rest, &x);
    const long n = strtol(rest, &end, 10);
    read = read && end != rest;
    rest = end;
    if (read && equals_sign(&rest) && read_interval(&rest, &least)) {
        const sgt_interval got = sgt_interval_power(x, (int)n);
        const bool beyond = n < 0 && sgt_interval_greatest(got) <= 2 / DBL_MAX; /* x^-n may be infinite */
        judge(line, got, least, beyond ? INT64_MAX : 2 * labs(n));
    } else {
        count.skipped++;
    }
    return true;
}

/* true: the line was a case of a question with a number or a truth for an answer. */
static bool question(const char *line, const char *name, const char *rest)
{
    sgt_interval x, y;
    const bool subset = strcmp(name, "subset") == 0, empty = strcmp(name, "isEmpty") == 0;
    const bool middle = strcmp(name, "mid") == 0, width = strcmp(name, "wid") == 0;
    const bool most = strcmp(name, "mag") == 0;
    if (!subset && !empty && !middle && !width && !most) return false;
    if (!read_interval(&rest, &x) || (subset && !read_interval(&rest, &y)) || !equals_sign(&rest)) {
        count.skipped++;
        return true;
    }
    count.cases++, count.tight++;
    while (*rest == ' ') rest++;
    if (subset || empty) {
        const bool got = subset ? sgt_interval_is_in(x, y) : sgt_interval_is_empty(x);
        if (got != (*rest == 't')) fault(line, "another answer was expected");
        return true;
    }
    const double expected = strtod(rest, NULL);
    const double got = middle ? sgt_interval_middle(x)
                       : width ? sgt_interval_width(x)
                               : sgt_interval_greatest(x);
    /* of none the width and the greatest magnitude are 0 here */
    const bool right = isnan(expected) ? (middle ? isnan(got) : got == 0) : got == expected;
    /* of an infinite interval any finite double in it will do; the standard wants the largest */
    const bool endless = isinf(x.lo) || isinf(x.hi);
    if (!right && !(middle && endless && isfinite(got) && sgt_interval_has(x, got)))
        fault(line, "another number was expected");
    return true;
}

static void take(char *line)
{
    while (*line == ' ' || *line == '\t') line++;
    char name[40];
    size_t length = strcspn(line, " \t");
    if (line[length] == 0 || length >= sizeof name || strchr(line, '=') == NULL) return;
    memcpy(name, line, length), name[length] = 0;
    if (operation(line, name, line + length) || question(line, name, line + length)) return;
    char word[sizeof name + 2];
    snprintf(word, sizeof word, " %s ", name[1] == '-' ? name + 2 : name); /* b-textToInterval */
    count.skipped++;
    if (!strstr(elsewhere, word)) fault(line, "an unknown operation");
}

static bool take_file(const char *path)
{
    char line[1000];
    bool comment = false;
    FILE *in = fopen(path, "r");
    if (!in) return false;
    while (fgets(line, sizeof line, in)) {
        char *end = strchr(line, ';');
        if (strstr(line, "/*")) comment = true;
        if (!comment && end && !strstr(line, "testcase")) {
            *end = 0;
            take(line);
        }
        if (strstr(line, "*/")) comment = false;
    }
    fclose(in);
    return true;
}

int main(int argc, char *argv[])
{
    for (int i = 1; i < argc; i++)
        if (!take_file(argv[i])) {
            printf("%s cannot be read\n", argv[i]);
            return 1;
        }
    printf("%lu cases: %lu with the least interval, %lu within one double, %lu integer powers wider\n"
           "left out: %lu, decorated or of operations that interval.h has not\n",
           count.cases, count.tight, count.near, count.wide, count.skipped);
    if (count.cases < 2500) fault("the files", "fewer than 2,500 cases");
    return faults != 0;
}

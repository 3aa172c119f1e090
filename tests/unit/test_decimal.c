// SPDX-License-Identifier: MIT
/* Decimal numbers (src/num/decimal.h), as they are in formulas and in files, against strtod of the C library,
 * which rounds correctly: random digits, doubles printed with 1 to 800 digits, middles between two doubles
 * exactly and next to them, the ends of the range, and forms of every kind. */
#include "unit.h"

#include "../../src/num/decimal.h"
#include "../../src/surface/formula/tape.h"

/* The number that a text is read as: x - number has it as its only uniform. */
static double number_of(const char *text, sgt_error *error)
{
    static char formula[4000];
    static double room[60000];
    int length = snprintf(formula, sizeof formula, "%s*x + y", text);
    REQUIRE(length < (int)sizeof formula, "too long");
    REQUIRE(sgt_formula_room(formula, 0) <= sizeof room, "the room is short");
    sgt_tape *t = sgt_formula_read(formula, SGT_FORMULA_XYZ, 0, NULL, room, sizeof room, error);
    if (!t) return NOT;
    REQUIRE(t->uniforms <= 1, "%s: %d uniforms", text, t->uniforms);
    /* 1 * x is x */
    return t->uniforms ? t->uniform[0].number : 1;
}

/* The text as a part of a longer one: what follows must not be read. */
static double part_of(const char *text)
{
    static char longer[4000];
    const size_t all = strlen(text);
    size_t length;
    snprintf(longer, sizeof longer, "%s00e9", text);
    const double x = decimal_read(longer, longer + all, &length);
    REQUIRE(length == all, "%.60s...: %zu of %zu characters", text, length, all);
    return x;
}

static void judge(const char *text)
{
    sgt_error error = {0};
    double want = strtod(text, NULL), got = number_of(text, &error), part = part_of(text);
    REQUIRE(same_bits(want, part), "%.60s...: %a, not %a", text, part, want);
    if (isinf(want)) {
        REQUIRE(isnan(got) && error.column == 1 && strstr(error.words, "larger"), "%.60s...: column %d, %s",
                text, (int)error.column, error.words);
        return;
    }
    REQUIRE(same_bits(want, got), "%.60s...: %a, not %a (%s)", text, got, want, error.words);
}

static void test_forms(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "0",
        "0.0",
        "00",
        "1",
        "1.",
        ".5",
        "5.",
        "0.5e1",
        "1e5",
        "1E5",
        "1e+5",
        "1e-5",
        "1e05",
        "000123.4500e-002",
        "0e999999999999",
        "0.000e-99999",
        "1e-99999999999",
        "123456789012345678901234567890",
        "1e22",
        "1e23",
        "9007199254740993",
        "9007199254740992.99999999999999999999999999",
        "9007199254740993.00000000000000000001",
        "4.9e-324",
        "2.4703282292062327e-324",
        "2.4703282292062328e-324",
        "2.2250738585072014e-308",
        "2.2250738585072011e-308",
        "1.7976931348623157e308",
        "1.7976931348623158e308",
        "1.7976931348623159e308",
        "179769313486231580793e289",
        "1e308",
        "1e309",
        "1e310",
        "1e99999",
        "1e9999999999999999999",
        "0.000000000000000000000000000000000000000000000000000000000000000001",
        "8.5e15",
        "123456789012345e22",
        "999999999999999e22",
        "999999999999999e-22",
        "1e-22",
        "1e-23",
        "0.1",
        "0.3",
        "6929495644600919.5",
        "3.141592653589793238462643383279502884197169399375105820974944592307816406286",
    };
    for (size_t i = 0; i < COUNT_OF(texts); i++) judge(texts[i]);
    static char zeros[3000];
    memset(zeros, '0', 2900), zeros[1] = '.', zeros[2899] = '1';
    judge(zeros); /* 1e-2898 */
    strcpy(zeros + 2900, "e2898");
    judge(zeros); /* 1 */
    memset(zeros, '9', 2900), zeros[2900] = 0, strcpy(zeros + 2900, "e-2899");
    judge(zeros); /* 9.99... is 10 */
}

static void test_random(void **state)
{
    (void)state;
    generator g = seeded("decimals");
    char text[1200];
    for (long i = 0, n = scaled(60000); i < n; i++) {
        if (chance(&g, 0.5)) {
            int digits = chance(&g, 0.8) ? 1 + below(&g, 20) : 1 + below(&g, 900), at = 0;
            int point = chance(&g, 0.5) ? below(&g, digits + 1) : -1;
            for (int k = 0; k < digits; k++) {
                if (k == point) text[at++] = '.';
                text[at++] = (char)('0' + below(&g, 10));
            }
            int e = chance(&g, 0.5) ? below(&g, 40) - 20 : below(&g, 700) - 350 - digits / 2;
            text[at] = 0;
            if (!chance(&g, 0.2)) sprintf(text + at, "e%d", e);
        } else {
            uint64_t bits = random_bits(&g) >> 1;
            double x;
            memcpy(&x, &bits, sizeof x);
            if (!(x < FAR)) continue;
            snprintf(text, sizeof text, "%.*e", chance(&g, 0.8) ? below(&g, 20) : below(&g, 800), x);
        }
        judge(text);
    }
}

/* The middle between two doubles has at most 768 digits, which printf prints exactly from a long double. */
static void test_middles(void **state)
{
    (void)state;
    generator g = seeded("middles between doubles");
    char text[1400];
    for (long i = 0, n = scaled(3000); i < n; i++) {
        uint64_t bits = random_bits(&g) >> 1;
        if (chance(&g, 0.3)) bits &= ((uint64_t)1 << 54) - 1; /* subnormal, or nearly */
        if (chance(&g, 0.2)) bits |= ((uint64_t)1 << 52) - 1; /* the next one is a power of two */
        double x;
        memcpy(&x, &bits, sizeof x);
        if (!(x < DBL_MAX)) continue;
        long double middle = ((long double)x + (long double)nextafter(x, FAR)) / 2;
        int length = snprintf(text, sizeof text, "%.800Le", middle);
        REQUIRE(length > 0 && length < (int)sizeof text, "too long");
        judge(text);
        char *e = strchr(text, 'e'), *last = e - 1, tail[16];
        strcpy(tail, e);
        strcpy(last, "1"), strcat(text, tail); /* a little more */
        judge(text);
        int back = 30;
        while (last - back > text && last[-back] == '0') back++;
        if (last[-back] >= '1' && last[-back] <= '9') { /* a little less */
            last[-back]--;
            for (int k = back - 1; k >= 0; k--) last[-k] = '9';
            judge(text);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_random),
        cmocka_unit_test(test_middles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

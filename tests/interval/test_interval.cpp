// SPDX-License-Identifier: MIT
// interval.h against MPFR: each operation on random operands of every kind, and on all pairs of
// special ones.
//
//     test_interval      SAGITTA_TEST_SCALE=50: 10^7 random pairs; SAGITTA_TEST_SEED
//
// The oracle is the definition (IEEE 1788-2015, set-based flavour, 10.5): the hull of the values that the
// operation has on the members of its arguments.  All operations here are monotone in each argument where
// that has one sign, so the least and the greatest value of such a piece are at its corners, or are the
// limits there: a zero end of a divisor is approached from inside (it gets the sign of its piece), 0 times
// infinity is 0, and infinity over infinity lies between other corners.  MPFR rounds the corners once, down
// and up, to 53 bits and the exponents of a double, subnormals included.  The header's cases of signs are
// nowhere repeated.
//
// What is demanded of each end: it is outside the oracle's or on it; it does not leave it by more doubles
// than the header allows (none but in the ranges it names); it does not cross zero.
#include <sagitta/interval.h>

#include <mpfr.h>

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace {

const double inf = HUGE_VAL, nan_ = double(NAN), least = 0x1p-1074;

std::uint64_t bits_of(double x)
{
    std::uint64_t b;
    std::memcpy(&b, &x, sizeof b);
    return b;
}

double of_bits(std::uint64_t b)
{
    double x;
    std::memcpy(&x, &b, sizeof x);
    return x;
}

// The place of a double among the doubles: neighbours are 1 apart, -0 and 0 the same.
std::int64_t place(double x)
{
    const auto b = static_cast<std::int64_t>(bits_of(x));
    return b < 0 ? INT64_MIN - b : b;
}

double at_place(std::int64_t p) { return of_bits(static_cast<std::uint64_t>(p < 0 ? INT64_MIN - p : p)); }

// x moved by that many doubles, infinity the last.
double moved(double x, long by)
{
    const std::int64_t p = place(x) + by, end = place(inf);
    return at_place(p > end ? end : p < -end ? -end : p);
}

// How many doubles b is above a.
double doubles_between(double a, double b)
{
    const std::int64_t p = place(a), q = place(b);
    return (p < 0) == (q < 0) ? double(q - p) : double(q) - double(p);
}

// ------------------------------------------------------------------ MPFR

enum operation { sum, difference, product, quotient, power, root };
const char *const operation_names[] = {"sum", "difference", "product", "quotient", "power", "square_root"};
mpfr_t first, second, result;

// a op b (a^n, the root of a) rounded once.
double rounded(operation op, double a, double b, int n, mpfr_rnd_t way)
{
    int inexact = 0;
    mpfr_set_d(first, a, MPFR_RNDN); // 53 bits: exact
    mpfr_set_d(second, b, MPFR_RNDN);
    switch (op) {
    case sum: inexact = mpfr_add(result, first, second, way); break;
    case difference: inexact = mpfr_sub(result, first, second, way); break;
    case product: inexact = mpfr_mul(result, first, second, way); break;
    case quotient: inexact = mpfr_div(result, first, second, way); break;
    case power: inexact = mpfr_pow_si(result, first, n, way); break;
    case root: inexact = mpfr_sqrt(result, first, way); break;
    }
    mpfr_subnormalize(result, inexact, way);
    return mpfr_get_d(result, way);
}

// ------------------------------------------------------------------ the oracle

struct hull {
    bool empty = true;
    double lo = inf, hi = -inf;
    void add(double below, double above)
    {
        empty = false;
        if (below < lo) lo = below;
        if (above > hi) hi = above;
    }
    void corner(operation op, double a, double b, int n)
    {
        const double below = rounded(op, a, b, n, MPFR_RNDD);
        if (below == below) add(below, rounded(op, a, b, n, MPFR_RNDU));
        else if (a == 0 || b == 0) add(0, 0); // 0 times infinity; 0 over a divisor on its way to 0
    }
};

bool has_nan(sgt_interval x) { return x.lo != x.lo || x.hi != x.hi; }

// Beyond the largest double: the corner of that set is the largest double.
sgt_interval closed(sgt_interval x) { return {x.lo == inf ? DBL_MAX : x.lo, x.hi == -inf ? -DBL_MAX : x.hi}; }

// x without zero: none, one or two pieces, their ends at zero with their sign.
std::vector<sgt_interval> pieces(sgt_interval x)
{
    std::vector<sgt_interval> p;
    if (x.lo < 0) p.push_back({x.lo, x.hi < 0 ? x.hi : -0.0});
    if (x.hi > 0) p.push_back({x.lo > 0 ? x.lo : 0.0, x.hi});
    return p;
}

hull truth(operation op, sgt_interval x, sgt_interval y, int n)
{
    hull h;
    x = closed(x), y = closed(y);
    switch (op) {
    case sum:
    case difference:
    case product:
        for (double a : {x.lo, x.hi})
            for (double b : {y.lo, y.hi}) h.corner(op, a, b, n);
        break;
    case quotient:
        for (const sgt_interval &piece : pieces(y))
            for (double a : {x.lo, x.hi})
                for (double b : {piece.lo, piece.hi}) h.corner(op, a, b, n);
        break;
    case power:
        if (n == 0) h.add(1, 1);
        else {
            for (const sgt_interval &piece : pieces(x))
                for (double a : {piece.lo, piece.hi}) h.corner(op, a, 0, n);
            if (n > 0 && x.lo <= 0 && x.hi >= 0) h.add(0, 0);
        }
        break;
    case root:
        if (x.hi >= 0) {
            h.corner(op, x.lo > 0 ? x.lo : 0, 0, n);
            h.corner(op, x.hi, 0, n);
        }
        break;
    }
    return h;
}

// ------------------------------------------------------------------ verdicts

struct count {
    long tried = 0, exact = 0, failed = 0;
    double farthest = 0;
};
std::map<std::string, count> counts;
long failures;

void print_operands(const sgt_interval *x, const sgt_interval *y)
{
    if (x) std::printf(" x [%a, %a]", x->lo, x->hi);
    if (y) std::printf(" y [%a, %a]", y->lo, y->hi);
}

void fail(const std::string &name, const char *what, const sgt_interval *x, const sgt_interval *y,
          sgt_interval got, double lo, double hi)
{
    failures++;
    if (counts[name].failed++ >= 5) return;
    std::printf("FAIL %s: %s;", name.c_str(), what);
    print_operands(x, y);
    std::printf(" got [%a, %a] oracle [%a, %a]\n", got.lo, got.hi, lo, hi);
}

// The ranges the header names, where one double more is allowed.
bool named(double x)
{
    const double size = std::fabs(x);
    return size != 0 && size < inf && (size <= 1e-289 || size >= 1e307);
}

// At most that many doubles outside.
bool near(double end, double oracle, long allowed)
{
    return std::fabs(doubles_between(end, oracle)) <= double(allowed);
}

void check(const std::string &name, sgt_interval got, const hull &want, long allowed, bool zero_is_a_wall,
           const sgt_interval *x, const sgt_interval *y, const hull *wide = nullptr)
{
    count &c = counts[name];
    c.tried++;
    const char *what = nullptr;
    if (has_nan(got)) what = "a NaN";
    else if (want.empty) what = got.lo > got.hi ? nullptr : "not empty";
    else if (got.lo > got.hi) what = "empty";
    else if (!(got.lo <= want.lo && got.hi >= want.hi)) what = "does not contain";
    else if (zero_is_a_wall && ((want.lo >= 0 && got.lo < 0) || (want.hi <= 0 && got.hi > 0)))
        what = "crosses zero";
    else if (got.lo < moved((wide ? wide : &want)->lo, -allowed) ||
             got.hi > moved((wide ? wide : &want)->hi, allowed))
        what = "wider than it may be";
    if (what) fail(name, what, x, y, got, want.lo, want.hi);
    if (want.empty || got.lo > got.hi) {
        c.exact += !what;
        return;
    }
    c.exact += got.lo == want.lo && got.hi == want.hi;
    const hull &out = wide ? *wide : want;
    const double steps = std::max(doubles_between(got.lo, out.lo), doubles_between(out.hi, got.hi));
    if (steps > c.farthest) c.farthest = steps;
}

void check_number(const char *name, double got, double want, const sgt_interval *x,
                  const sgt_interval *y = nullptr)
{
    counts[name].tried++;
    counts[name].exact += got == want;
    if (!(got == want || (got != got && want != want)))
        fail(name, "another number", x, y, {got, got}, want, want);
}

void check_truth(const char *name, bool got, bool want, const sgt_interval *x, const sgt_interval *y,
                 double a = 0)
{
    counts[name].tried++;
    counts[name].exact += got == want;
    if (got != want) fail(name, "the other answer", x, y, {a, got ? 1.0 : 0.0}, a, want);
}

// What an operation on a NaN or on an empty interval is; false where there is neither.
bool odd(const std::string &name, sgt_interval got, const sgt_interval *x, const sgt_interval *y)
{
    hull want;
    if (has_nan(*x) || (y && has_nan(*y))) want.add(-inf, inf);
    else if (!(x->lo > x->hi || (y && y->lo > y->hi))) return false;
    check(name, got, want, 0, true, x, y);
    return true;
}

sgt_interval applied(operation op, sgt_interval x, sgt_interval y, int n)
{
    switch (op) {
    case sum: return sgt_interval_sum(x, y);
    case difference: return sgt_interval_difference(x, y);
    case product: return sgt_interval_product(x, y);
    case quotient: return sgt_interval_quotient(x, y);
    case power: return sgt_interval_power(x, n);
    default: return sgt_interval_square_root(x);
    }
}

// ------------------------------------------------------------------ the operations

void try_operation(operation op, sgt_interval x, sgt_interval y, int n)
{
    const bool binary = op <= quotient, sums = op <= difference;
    const sgt_interval got = applied(op, x, y, n), *other = binary ? &y : nullptr;
    const std::string name = op == power ? "power " + std::to_string(n) : operation_names[op];
    if (odd(name, got, &x, other)) return;
    const hull want = truth(op, x, y, n);
    hull wide = want;

    // Farther out by one double in the ranges named, sums only at their upper end.
    const sgt_interval cx = closed(x), cy = binary ? closed(y) : sgt_interval{1, 1};
    bool in_range = false;
    for (double e : {cx.lo, cx.hi, cy.lo, cy.hi, want.lo, want.hi})
        in_range |= named(e) && (!sums || std::fabs(e) > 1);
    long allowed = in_range;
    if (op == power && n != 0) {
        // |n| - 1 products, each of which moves its end by 2^-52 of it at most, which is two doubles at
        // most, or, in the ranges named, by twice that; and a quotient.
        const long steps = n < 0 ? -n : n;
        const hull up = n < 0 ? truth(power, x, x, -n) : hull();
        in_range |= !up.empty && (named(up.lo) || named(up.hi));
        allowed = 2 * (steps - 1) + (n < 0) + (n < 0 ? 16 * steps : 2 * steps + 2) * in_range;
        // Of an x^-n beyond the largest double 1 / x^-n knows no more than that; of a subnormal one, where
        // that is not beyond as well, two bits less.
        if (n < 0 && !want.empty) {
            const double largest = moved(DBL_MAX, -2 * steps); // as computed it may be beyond already
            if (up.hi > largest && want.lo >= 0) wide.add(0, 1 / DBL_MAX);
            if (up.lo < -largest && want.hi <= 0) wide.add(-1 / DBL_MAX, 0);
        }
    }
    const bool wall = !sums || ((x.lo >= 0 && y.lo >= 0) && op == sum);
    check(name, got, want, allowed, wall, &x, other, &wide);
}

void try_one(sgt_interval x)
{
    const bool unknown = has_nan(x), empty = x.lo > x.hi, plain = !unknown && !empty;
    hull h;

    check_truth("is_empty", sgt_interval_is_empty(x), empty, &x, nullptr);
    check_truth("is_positive", sgt_interval_is_positive(x), plain && x.lo > 0, &x, nullptr);
    check_truth("is_negative", sgt_interval_is_negative(x), plain && x.hi < 0, &x, nullptr);

    const sgt_interval minus = sgt_interval_negative(x);
    if (!odd("negative", minus, &x, nullptr)) {
        h = hull(), h.add(-x.hi, -x.lo);
        check("negative", minus, h, 0, true, &x, nullptr);
    }
    const sgt_interval size = sgt_interval_absolute(x);
    if (!odd("absolute", size, &x, nullptr)) {
        h = hull();
        h.add(std::fabs(x.lo), std::fabs(x.lo)), h.add(std::fabs(x.hi), std::fabs(x.hi));
        if (x.lo <= 0 && x.hi >= 0) h.add(0, 0);
        check("absolute", size, h, 0, true, &x, nullptr);
    }
    const sgt_interval square = sgt_interval_square(x);
    if (!odd("square", square, &x, nullptr)) {
        const sgt_interval c = closed(x);
        h = truth(power, x, x, 2);
        check("square", square, h, named(c.lo) || named(c.hi) || named(h.lo) || named(h.hi), true, &x,
              nullptr);
    }
    try_operation(root, x, x, 0);

    // A double in x, near its middle.
    const double m = sgt_interval_middle(x);
    if (!plain) check_number("middle", m, nan_, &x);
    else {
        const double lo = x.lo < -DBL_MAX ? -DBL_MAX : x.lo, hi = x.hi > DBL_MAX ? DBL_MAX : x.hi;
        const double half = rounded(product, lo, 0.5, 0, MPFR_RNDN) + rounded(product, hi, 0.5, 0, MPFR_RNDN);
        const bool beyond = x.lo == inf || x.hi == -inf; // no double is in it
        check_truth("middle",
                    std::fabs(m) <= DBL_MAX &&
                        (beyond || (m >= x.lo && m <= x.hi &&
                                    std::fabs(m - half) <= 2 * (least + std::fabs(half) * 0x1p-53))),
                    true, &x, nullptr, m);
    }
    check_number("greatest", sgt_interval_greatest(x),
                 empty     ? 0
                 : unknown ? inf
                           : std::fmax(std::fabs(x.lo), std::fabs(x.hi)),
                 &x);
    h = hull();
    if (empty) h.add(0, 0);
    else if (unknown) h.add(inf, inf);
    else {
        const sgt_interval c = closed(x);
        h.add(rounded(difference, c.hi, c.lo, 0, MPFR_RNDU), rounded(difference, c.hi, c.lo, 0, MPFR_RNDU));
        if (x.lo == inf || x.hi == -inf) h.add(inf, inf), h.lo = inf;
    }
    const double width = sgt_interval_width(x);
    counts["width"].tried++;
    counts["width"].exact += width == h.hi;
    if (!(width >= h.hi && near(width, h.hi, named(x.lo) || named(x.hi) || named(h.hi))))
        fail("width", "wrong", &x, nullptr, {width, width}, h.hi, h.hi);
}

void try_pair(sgt_interval x, sgt_interval y)
{
    for (operation op : {sum, difference, product, quotient}) try_operation(op, x, y, 0);

    const bool x_empty = x.lo > x.hi, y_empty = y.lo > y.hi, unknown = has_nan(x) || has_nan(y);
    hull h;
    const sgt_interval both = sgt_interval_intersection(x, y), either = sgt_interval_hull(x, y);
    if (!x_empty && !y_empty) {
        const double lo = std::fmax(has_nan(x) ? -inf : x.lo, has_nan(y) ? -inf : y.lo),
                     hi = std::fmin(has_nan(x) ? inf : x.hi, has_nan(y) ? inf : y.hi);
        if (lo <= hi) h.add(lo, hi);
    }
    check("intersection", both, h, 0, true, &x, &y);
    h = hull();
    if (unknown) h.add(-inf, inf);
    if (!x_empty && !unknown) h.add(x.lo, x.lo), h.add(x.hi, x.hi);
    if (!y_empty && !unknown) h.add(y.lo, y.lo), h.add(y.hi, y.hi);
    check("hull", either, h, 0, true, &x, &y);
    // Of a NaN no proof is made.
    check_truth("is_in", sgt_interval_is_in(x, y),
                x_empty || (!unknown && !y_empty && x.lo >= y.lo && x.hi <= y.hi), &x, &y);
}

// The functions of numbers; x and y stand for their lower ends.
void try_numbers(double a, double b)
{
    const sgt_interval x = {a, a}, y = {b, b};
    check_number("next_above", sgt_next_above(a), a == inf ? a : a != a ? a : std::nextafter(a, inf), &x);
    check_number("next_below", sgt_next_below(a), a == -inf ? a : a != a ? a : std::nextafter(a, -inf), &x);
    if (a != a || b != b) return;

    const sgt_interval got[] = {
        {-sgt_sum_above(-a, -b), sgt_sum_above(a, b)},
        {-sgt_product_above(-a, b), sgt_product_above(a, b)},
        {-sgt_quotient_above(-a, b), sgt_quotient_above(a, b)},
        {a >= 0 ? sgt_square_root_below(a) : 0, a >= 0 ? sgt_square_root_above(a) : 0},
    };
    const operation ops[] = {sum, product, quotient, root};
    const char *names[] = {"sum_above", "product_above", "quotient_above", "square_root_above"};
    const bool finite = std::fabs(a) < inf && std::fabs(b) < inf;
    for (int i = 0; i < 4; i++) {
        hull h;
        if (!finite || (ops[i] == quotient && b == 0) || (ops[i] == root && a < 0)) continue;
        h.corner(ops[i], a, ops[i] == root ? 1 : b, 0);
        const bool in_range = named(a) || (ops[i] != root && named(b)) || named(h.lo) || named(h.hi);
        const bool huge = std::fabs(a) > 1 || std::fabs(b) > 1;
        check(names[i], got[i], h, in_range && (ops[i] != sum || huge), ops[i] != sum, &x, &y);
    }
    if (b >= 0) {
        const sgt_interval about = sgt_interval_about(a, b);
        hull h;
        h.add(rounded(difference, a == inf ? DBL_MAX : a, b, 0, MPFR_RNDD),
              rounded(sum, a == -inf ? -DBL_MAX : a, b, 0, MPFR_RNDU));
        check("about", about, h, std::fabs(a) >= 1e307 || b >= 1e307, false, &x, &y);
    }
    check_truth("has", sgt_interval_has({-1, b}, a), -1 <= a && a <= b, &x, &y, a);
    check_truth("has", sgt_interval_has({b, 1}, a), b <= a && a <= 1, &x, &y, a);
    check_truth("has",
                sgt_interval_has({nan_, b}, a) && sgt_interval_has({b, nan_}, a) &&
                    sgt_interval_has({nan_, nan_}, a),
                true, &x, &y, a);
    const sgt_interval sc = sgt_interval_scaled(x, b), pr = sgt_interval_product(x, y);
    check_truth("scaled", sc.lo == pr.lo && sc.hi == pr.hi, true, &x, &y);
}

// Members of the arguments, not corners: this tries the oracle too.
void try_members(operation op, sgt_interval x, sgt_interval y, double a, double b)
{
    if (!(x.lo <= a && a <= x.hi && y.lo <= b && b <= y.hi) || (op == quotient && b == 0) ||
        std::fabs(a) == inf || std::fabs(b) == inf)
        return;
    const sgt_interval got = applied(op, x, y, 0);
    const double below = rounded(op, a, b, 0, MPFR_RNDD), above = rounded(op, a, b, 0, MPFR_RNDU);
    // It contains a number between these two doubles, or this one.
    counts["members"].tried++;
    counts["members"].exact++;
    if (!(got.lo <= below && got.hi >= above))
        fail("members", operation_names[op], &x, &y, got, below, above);
}

// ------------------------------------------------------------------ operands

struct generator { // splitmix64
    std::uint64_t state;
    std::uint64_t bits()
    {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    int below(int n) { return static_cast<int>(bits() % static_cast<unsigned>(n)); }
};

const double special[] = {
    0.0,     -0.0,     least,    -least,  3 * least,   DBL_MIN - least, -(DBL_MIN - least),
    DBL_MIN, -DBL_MIN, 1,        -1,      1 + 0x1p-52, -(1 + 0x1p-52),  1 - 0x1p-53,
    0.1,     -3,       0x1p-538, 0x1p512, -0x1p512,    0x1p1023,        -0x1p1023,
    DBL_MAX, -DBL_MAX, inf,      -inf,    nan_,
};
const int specials = sizeof special / sizeof *special;

double with_exponent(generator &g, int lo, int hi)
{
    return std::ldexp((g.bits() & 1 ? 1 : -1) * (1 + double(g.bits() >> 12) * 0x1p-52),
                      lo + g.below(hi - lo + 1));
}

// A finite number; `by` is one that it may have to do with.
double number(generator &g, double by)
{
    double x;
    switch (g.below(13)) {
    case 0: x = of_bits(g.bits()); break;                                        // any exponent
    case 1: x = with_exponent(g, -1075, -1015); break;                           // subnormal and around
    case 2: x = with_exponent(g, 1000, 1023); break;                             // huge
    case 3:
        x = g.below(33) - 16;
        break; // products and sums that are exact
    case 4: x = std::ldexp(g.below(2001) - 1000, g.below(80) - 40); break;       // and others
    case 5: x = special[g.below(specials - 3)]; break;                           // finite
    case 6:
        x = moved(by, g.below(7) - 3);
        break; // cancellation, or an end shared
    case 7: x = -moved(by, g.below(7) - 3); break;
    case 8:
        x = std::ldexp(by, g.below(7) - 3 - 52 * g.below(3));
        break; // its last bit, or a half of it
    case 9:
        x = moved((g.bits() & 1 ? 1 : -1) * (g.bits() & 1 ? 1e-289 : 1e307), g.below(7) - 3);
        break; // where the header changes its way
    case 10: x = (g.bits() & 1 ? DBL_MAX : with_exponent(g, -1075, -960)) / by; break; // a product there
    default: x = with_exponent(g, -60, 60); break;
    }
    return std::fabs(x) <= DBL_MAX ? x : with_exponent(g, -3, 3);
}

sgt_interval interval(generator &g, sgt_interval by)
{
    double a = number(g, g.bits() & 1 ? by.lo : by.hi), b = number(g, a);
    switch (g.below(10)) {
    case 0:
    case 1: b = a; break;
    case 2: b = moved(a, g.below(9)); break;
    case 3: return a < 0 ? sgt_interval{a, inf} : sgt_interval{-inf, a};
    case 4: a = 0; break;
    case 5: b = -a; break;
    case 6: return sgt_interval{number(g, a), inf};
    default: break;
    }
    return a <= b ? sgt_interval{a, b} : sgt_interval{b, a};
}

double member(generator &g, sgt_interval x)
{
    const double m = sgt_interval_middle(x);
    switch (g.below(4)) {
    case 0: return x.lo;
    case 1: return x.hi;
    case 2: return m;
    default: return sgt_interval_middle({x.lo, m});
    }
}

} // namespace

int main()
{
    std::uint64_t seed = 1;
    double scale = 0.5;
    if (const char *e = std::getenv("SAGITTA_TEST_SEED")) seed = std::strtoull(e, nullptr, 0);
    if (const char *e = std::getenv("SAGITTA_TEST_SCALE")) scale = std::atof(e);
    const long pairs = static_cast<long>(200000 * scale);
    std::printf("SAGITTA_TEST_SEED=%" PRIu64 ", %ld random pairs\n", seed, pairs);

    mpfr_set_emin(-1073); // doubles: the least is 2^-1074 = 0.5 * 2^-1073
    mpfr_set_emax(1024);
    mpfr_inits2(53, first, second, result, static_cast<mpfr_ptr>(nullptr));

    std::vector<sgt_interval> odd_ones;
    for (double a : special)
        for (double b : special) odd_ones.push_back({a, b});
    for (const sgt_interval &x : odd_ones) {
        try_one(x);
        try_numbers(x.lo, x.hi);
        for (int n = -9; n <= 12; n++) try_operation(power, x, x, n);
    }
    for (const sgt_interval &x : odd_ones)
        for (const sgt_interval &y : odd_ones) try_pair(x, y);

    generator g = {seed};
    for (long i = 0; i < pairs; i++) {
        const sgt_interval x = interval(g, {1, 1}), y = interval(g, x);
        try_pair(x, y);
        try_one(x);
        try_numbers(x.lo, y.hi);
        try_operation(power, x, x, g.below(22) - 9);
        const double a = member(g, x), b = member(g, y);
        try_members(static_cast<operation>(g.below(4)), x, y, a, b);
    }

    std::printf("%-18s %10s %10s %8s %s\n", "", "tried", "exact", "failed", "doubles too far, at most");
    for (const auto &c : counts)
        std::printf("%-18s %10ld %10ld %8ld %.3g\n", c.first.c_str(), c.second.tried, c.second.exact,
                    c.second.failed, c.second.farthest);
    mpfr_clears(first, second, result, static_cast<mpfr_ptr>(nullptr));
    mpfr_free_cache();
    if (failures) std::printf("%ld failures\n", failures);
    return failures != 0;
}

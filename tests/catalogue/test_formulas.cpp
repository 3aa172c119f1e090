// SPDX-License-Identifier: MIT
// The oracle's check of itself, without the library: polynomials as they are printed in the sources, and
// what each is defined by (orthogonal, of unit mean square, through the heights).  Coefficients are
// integers and roots of integers.
#include "formulas.h"

using namespace catalogue;

static int failures;

static void expect(const char *what, int index, quad found, quad wanted, quad allowed)
{
    if (oracle::magnitude(found - wanted) <= allowed * (1 + oracle::magnitude(wanted))) return;
    failures++;
    std::printf("FAIL %s %d: %s, wanted %s\n", what, index, oracle::text(found).c_str(),
                oracle::text(wanted).c_str());
}

static void indices()
{
    // Noll 1976, table I; Wyant and Creath 1992, table III.
    static const int of_noll[][2] = {{0, 0},  {1, 1},  {1, -1}, {2, 0},  {2, -2}, {2, 2},  {3, -1},
                                     {3, 1},  {3, -3}, {3, 3},  {4, 0},  {4, 2},  {4, -2}, {4, 4},
                                     {4, -4}, {5, 1},  {5, -1}, {5, 3},  {5, -3}, {5, 5},  {5, -5},
                                     {6, 0},  {6, -2}, {6, 2},  {6, -4}, {6, 4},  {6, -6}, {6, 6}};
    static const int of_fringe[][2] = {{0, 0},  {1, 1},  {1, -1}, {2, 0},  {2, 2},  {2, -2}, {3, 1},  {3, -1},
                                       {4, 0},  {3, 3},  {3, -3}, {4, 2},  {4, -2}, {5, 1},  {5, -1}, {6, 0},
                                       {4, 4},  {4, -4}, {5, 3},  {5, -3}, {6, 2},  {6, -2}, {7, 1},  {7, -1},
                                       {8, 0},  {5, 5},  {5, -5}, {6, 4},  {6, -4}, {7, 3},  {7, -3}, {8, 2},
                                       {8, -2}, {9, 1},  {9, -1}, {10, 0}};
    int j = 0;
    for (const auto &w : of_noll)
        if (noll(++j) != std::pair<int, int>(w[0], w[1])) failures++, std::printf("FAIL Noll %d\n", j);
    j = 0;
    for (const auto &w : of_fringe)
        if (fringe(++j) != std::pair<int, int>(w[0], w[1])) failures++, std::printf("FAIL Fringe %d\n", j);
    if (noll(5151) != std::pair<int, int>(100, 100) && noll(5151) != std::pair<int, int>(100, -100))
        failures++, std::printf("FAIL Noll 5151\n");
}

static void zernikes()
{
    const quad x = quad(0.3), y = quad(-0.45), r2 = x * x + y * y;
    const auto z = [&](int n, int m) { return zernike_at(n, m, x, y); };
    expect("Z", 4, z(2, 0), 2 * r2 - 1, 1e-30);
    expect("Z", 7, z(3, -1), (3 * r2 - 2) * y, 1e-30);
    expect("Z", 10, z(3, 3), x * x * x - 3 * x * y * y, 1e-30);
    expect("Z", 11, z(4, 0), 6 * r2 * r2 - 6 * r2 + 1, 1e-30);
    expect("Z", 13, z(4, -2), (4 * r2 - 3) * 2 * x * y, 1e-30);
    expect("Z", 37, z(8, 0), (((70 * r2 - 140) * r2 + 90) * r2 - 20) * r2 + 1, 1e-30);
    // Each is 1 at the edge, and their mean squares over the circle are 1 / (n + 1) or half of it: by the
    // mean of a trigonometric polynomial and Gauss' rule in r2 (five points of it here: degree 9).
    for (int n = 0; n <= 40; n++)
        for (int m = n % 2; m <= n; m += 2) {
            quad edge = 0;
            for (quad c : radial(n, m)) edge += c;
            expect("Z at the edge", n, edge, 1, 1e-20);
            quad square = 0;
            const auto &c = radial(n, m);
            for (std::size_t i = 0; i < c.size(); i++)
                for (std::size_t j = 0; j < c.size(); j++)
                    square += c[i] * c[j] / (2 * (int(i) + int(j) + m) + 2);
            if (n <= 20) expect("mean square of R", n, square * 2 * (n + 1), 1, 1e-15);
        }
    // A sum is the sum of its terms.
    double a[66];
    for (int i = 0; i < 66; i++) a[i] = 0.1 + 0.01 * i;
    for (int order = SGT_NOLL; order <= SGT_FRINGE; order++)
        for (int normalised = 0; normalised < 2; normalised++) {
            const sgt_zernike s = {0, 0, 0, 2, order, normalised, {a, 1, 66}};
            const formula<quad> f({&sgt_zernike_ops, &s});
            quad sum = 0;
            for (int j = 1; j <= 66; j++) {
                const auto i = order == SGT_NOLL ? noll(j) : fringe(j);
                const quad norm = !normalised ? quad(1)
                                              : square_root(quad((i.second ? 2 : 1) * (i.first + 1)));
                sum += quad(a[j - 1]) * norm * z(i.first, i.second);
            }
            expect("a sum of Z", order, -f(2 * x, 2 * y, quad(0)), sum, 1e-28);
        }
}

static void chebyshevs()
{
    const quad u[] = {quad(0.3), quad(-0.9), quad(1.5), quad(-2.25)};
    for (quad x : u) {
        const std::vector<quad> t = chebyshev_at(x, 40);
        const quad x2 = x * x;
        expect("T", 2, t[2], 2 * x2 - 1, 1e-30);
        expect("T", 3, t[3], (4 * x2 - 3) * x, 1e-30);
        expect("T", 8, t[8], (((128 * x2 - 256) * x2 + 160) * x2 - 32) * x2 + 1, 1e-28);
        expect("T of T", 36, t[36], chebyshev_at(t[6], 7)[6], 1e-22);
        typedef dual<quad, 1> jet;
        expect("T'", 5, chebyshev_at(jet::variable(x, 0), 6)[5].v[0], (80 * x2 - 60) * x2 + 5, 1e-28);
    }
}

// Forbes 2007, equation 3.7 (as functions of x = u^2), and table of Q_con: 1, 6x - 5, 28x^2 - 42x + 15 ...
static void forbes()
{
    for (quad x : {quad(0), quad(0.2), quad(0.75), quad(1)}) {
        const std::vector<quad> q = slopes::up_to(24).at(x, 24);
        expect("Q_bfs", 0, q[0], 1, 1e-30);
        expect("Q_bfs", 1, q[1], (13 - 16 * x) / square_root(quad(19)), 1e-28);
        expect("Q_bfs", 2, q[2], square_root(quad(2) / 95) * (29 - 4 * x * (25 - 19 * x)), 1e-28);
        expect("Q_bfs", 3, q[3], square_root(quad(2) / 2545) * (207 - 4 * x * (315 - x * (577 - 320 * x))),
               1e-28);
        expect("Q_bfs", 4, q[4],
               (7737 - 16 * x * (4653 - 2 * x * (7381 - 8 * x * (1168 - 509 * x)))) /
                   (3 * square_root(quad(131831))),
               1e-28);
        expect("Q_bfs", 5, q[5],
               (66657 - 32 * x * (28338 - x * (135325 - 8 * x * (35884 - x * (34661 - 12432 * x))))) /
                   (3 * square_root(quad(6632213))),
               1e-28);
        expect("Q_con", 0, q_con_at(0, x), 1, 1e-30);
        expect("Q_con", 1, q_con_at(1, x), 6 * x - 5, 1e-30);
        expect("Q_con", 2, q_con_at(2, x), 28 * x * x - 42 * x + 15, 1e-30);
        expect("Q_con", 3, q_con_at(3, x), ((120 * x - 252) * x + 168) * x - 35, 1e-30);
        expect("Q_con", 4, q_con_at(4, x), (((495 * x - 1320) * x + 1260) * x - 504) * x + 70, 1e-30);
        expect("Q_con", 5, q_con_at(5, x), ((((2002 * x - 6435) * x + 7920) * x - 4620) * x + 1260) * x - 126,
               1e-30);
    }
}

static void grids()
{
    // Third order: a quadratic is reproduced, at the edge too.
    double z[5][6];
    const auto of = [](quad x, quad y) {
        return quad(0.5) + x / 4 - y / 8 + x * x / 16 + x * y / 32 - y * y / 64;
    };
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 6; j++)
            z[i][j] = oracle::to_double(of((j - quad(2.5)) * 0.5, (i - quad(2)) * 0.25));
    const sgt_grid s = {0, 0, 0, 0.5, 0.25, {z[0], 5, 6}, 0, 0, 0};
    const formula<quad> f({&sgt_grid_ops, &s});
    for (double x : {-1.25, -1.2, -0.3, 0.25, 1.1, 1.25})
        for (double y : {-0.5, -0.4, 0.0, 0.1, 0.5})
            expect("a quadratic on a grid", 0, -f(quad(x), quad(y), quad(0)), of(quad(x), quad(y)), 1e-30);
    if (f(quad(1.3), quad(0), quad(0)) == f(quad(1.3), quad(0), quad(0)))
        failures++, std::printf("FAIL beyond the grid\n");
    for (double t : {0.0, 0.25, 0.5, 0.9})
        expect("Keys", 0, keys(quad(t)) + keys(1 - quad(t)) + keys(1 + quad(t)) + keys(2 - quad(t)), 1,
               1e-30);
}

// Surfaces that are others: a toroid with c_x = c and a circle is a sphere; so is a biconic; a paraboloid.
static void others()
{
    const sgt_conic sphere = {0.25, 0, 0};
    const sgt_toroidal toroid = {0.25, 0, 0.25, 0, {}};
    const sgt_biconic biconic = {0.25, 0, 0.25, 0, 0};
    const sgt_ellipsoid ball = {4, 0};
    const sgt_quadric quadric = {{1, 1, 1}, {0, 0, 0}, {0, 0, -8}, 0};
    const sgt_torus torus = {3, 1};
    const quad x = quad(0.7), y = quad(-1.1),
               z = oracle::magnitude(formula<quad>({&sgt_conic_ops, &sphere})(x, y, quad(0)));
    expect("a sphere's sag", 0, z, 4 - square_root(16 - x * x - y * y), 1e-30);
    expect("a toroid's", 0, formula<quad>({&sgt_toroidal_ops, &toroid})(x, y, z), 0, 1e-30);
    expect("a biconic's", 0, formula<quad>({&sgt_biconic_ops, &biconic})(x, y, z), 0, 1e-30);
    expect("a quadric's", 0, formula<quad>({&sgt_quadric_ops, &quadric})(x, y, z), 0, 1e-29);
    expect("an ellipsoid's", 0, formula<quad>({&sgt_ellipsoid_ops, &ball})(x, y, z - 4), 0, 1e-30);
    expect("a torus'", 0, formula<quad>({&sgt_torus_ops, &torus})(quad(3) + quad(0.6), quad(0), quad(0.8)), 0,
           1e-14);
    expect("a torus'", 1, formula<quad>({&sgt_torus_ops, &torus})(quad(0), quad(-3), quad(1)), 0, 1e-30);
}

// Level sets by hand: |Q^2 + c|^2 and the one component that Q^3 + c has on the real axis; the escape that
// is left open.
static void level_sets()
{
    const quad x = quad(0.3), y = quad(-0.75), z = quad(0.5), w = quad(0.25);
    const sgt_julia julia = {{-0.5, 0.25, 0.125, -0.0625}, {0, 0, 0, 0.25}, {}, {}, {}, 3, 1, 2};
    const quad q[4] = {x * x - y * y - z * z - w * w - quad(0.5), 2 * x * y + quad(0.25),
                       2 * x * z + quad(0.125), 2 * x * w - quad(0.0625)};
    const quad u = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) / 9;
    expect("a julia", 1, formula<quad>({&sgt_julia_ops, &julia})(x, y, z), (u - 1) / (u + 1), 1e-30);
    const sgt_julia cubic = {{-0.5, 0, 0, 0}, {}, {2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}, 4, 2, 3};
    const quad r = 8 * x * x * x - quad(0.5), s = r * r * r - quad(0.5), v = s * s / 16;
    expect("a julia", 2, formula<quad>({&sgt_julia_ops, &cubic})(x, quad(0), quad(0)), (v - 1) / (v + 1),
           1e-30);
    const sgt_mandelbrot set = {{}, {}, {}, {}, 2, 3, 2};
    const quad t = x * x + x, m = (t * t + x) * (t * t + x) / 4;
    expect("a mandelbrot", 3, formula<quad>({&sgt_mandelbrot_ops, &set})(x, quad(0), quad(0)),
           (m - 1) / (m + 1), 1e-30);
    expect("the safe escape of z^2 + c", 2, catalogue::safe_escape(quad(2), 2, false), 2, 1e-30);
    expect("the safe escape of z^2 + c", 0, catalogue::safe_escape(quad(0), 2, false), 1, 1e-30);
    expect("the safe escape of a mandelbrot", 5, power(catalogue::safe_escape(quad(0), 5, true), 4), 2,
           1e-30);
}

// A type that is added to the library wants its row here.
static void rows()
{
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if (!row_of<quad>({b->ops, nullptr})) failures++, std::printf("FAIL %s has no formula\n", b->type);
}

// The smooth form is zero where F is, and goes on beyond the equator, where F ends.
static void smooth()
{
    const sgt_even_asphere s = {0.25, 0.5, 0, {1e-3, -1e-5}};
    const formula<quad> f({&sgt_even_asphere_ops, &s});
    for (quad x : {quad(0), quad(1), quad(3)}) {
        const quad z = -f(x, quad(0.5), quad(0));
        expect("a smooth form", 0, f.smooth(x, quad(0.5), z), 0, 1e-30);
    }
    const quad beyond = f(quad(3.5), quad(0), quad(1)), still = f.smooth(quad(3.5), quad(0), quad(1));
    if (beyond == beyond || still != still) failures++, std::printf("FAIL beyond the equator\n");
}

int main()
{
    rows();
    level_sets();
    smooth();
    indices();
    zernikes();
    chebyshevs();
    forbes();
    grids();
    others();
    std::printf(failures ? "%d FAILED\n" : "ok\n", failures);
    return failures != 0;
}

// SPDX-License-Identifier: MIT
/* orbit.c - cells and values of an orbit along a ray.  The mathematics is in orbit.h. */
#include "../../num/elementary.h"
#include "cell.h"

static const double FAR2 = 0x1p64; /* u beyond it is taken as infinite: F = 1 - 2/u rounds to 1 */

/* ------------------------------------------------------------- parameters */

/* The positive root of x^p = x + b, within 4 ulps: Newton's method from above, where x^p - x is convex. */
static double safe_escape(double b, int power)
{
    if (power == 2) return 0.5 + sqrt(0.25 + b);
    double x = 1 + b, last;
    for (int i = 0; i < 200; i++) { /* from 1e6 with p = 8: 95 steps */
        double xp = small_power(x, power - 1);
        last = x;
        x -= (xp * x - x - b) / (power * xp - 1);
        if (!(x < last)) break;
    }
    return x;
}

static quaternion quaternion_of(const double q[4]) { return (quaternion){q[0], q[1], q[2], q[3]}; }

/* What the two kinds of set have in common. */
typedef struct orbit_slice {
    const double *at, *ex, *ey, *ez;
    double escape;
    int iterations, power;
} orbit_slice;

/* Is each component at most `most`?  False for NaN. */
static bool orbit_bounded(const double q[4], double most)
{
    return fabs(q[0]) <= most && fabs(q[1]) <= most && fabs(q[2]) <= most && fabs(q[3]) <= most;
}

/* Are three axes, each of them in range, independent?  Tests what is left of each beside those before it
 * (Gram and Schmidt). */
static sgt_objection independent(quaternion x, quaternion y, quaternion z)
{
    x = quaternion_times(x, 1 / sqrt(quaternion_dot(x, x)));
    y = quaternion_times(y, 1 / sqrt(quaternion_dot(y, y)));
    z = quaternion_times(z, 1 / sqrt(quaternion_dot(z, z)));
    y = quaternion_sum(y, quaternion_times(x, -quaternion_dot(x, y)));
    double left = quaternion_dot(y, y);
    if (!(left > 0x1p-80)) return (sgt_objection){"ey", "the axes are not independent"};
    z = quaternion_sum(z, quaternion_times(x, -quaternion_dot(x, z)));
    z = quaternion_sum(z, quaternion_times(y, -quaternion_dot(y, z) / left));
    if (!(quaternion_dot(z, z) > 0x1p-80)) return (sgt_objection){"ez", "the axes are not independent"};
    return (sgt_objection){NULL, NULL};
}

static sgt_objection axes(const orbit_slice *s, orbit *o)
{
    o->x = quaternion_of(s->ex), o->y = quaternion_of(s->ey), o->z = quaternion_of(s->ez);
    double xx = quaternion_dot(o->x, o->x), yy = quaternion_dot(o->y, o->y), zz = quaternion_dot(o->z, o->z);
    /* True for NaN. */
    if (!(xx + yy + zz <= 1e200) &&
        !(orbit_bounded(s->ex, 1e100) && orbit_bounded(s->ey, 1e100) && orbit_bounded(s->ez, 1e100))) {
        const char *key = !orbit_bounded(s->ex, 1e100) ? "ex" : !orbit_bounded(s->ey, 1e100) ? "ey" : "ez";
        return (sgt_objection){key, "a number that is not finite, or above 1e100"};
    }
    bool none = xx + yy + zz == 0;
    for (int i = 0; none && i < 4; i++) none = s->ex[i] == 0 && s->ey[i] == 0 && s->ez[i] == 0;
    if (none) {
        o->x = (quaternion){1, 0, 0, 0}, o->y = (quaternion){0, 1, 0, 0}, o->z = (quaternion){0, 0, 1, 0};
        o->x_length = o->y_length = o->z_length = 1;
        return (sgt_objection){NULL, NULL};
    }
    double least = 1e-200 * (1 - 0x1p-40);
    if (!(xx >= least && yy >= least && zz >= least))
        return (sgt_objection){!(xx >= least)   ? "ex"
                               : !(yy >= least) ? "ey"
                                                : "ez",
                               "zero, or shorter than 1e-100"};
    o->x_length = sqrt(xx), o->y_length = sqrt(yy), o->z_length = sqrt(zz);
    double xy = quaternion_dot(o->x, o->y), yz = quaternion_dot(o->y, o->z), zx = quaternion_dot(o->z, o->x);
    /* If no two make an angle of less than a little over 60 degrees, they are independent. */
    double X = o->x_length * 0.49, Y = o->y_length, Z = o->z_length * 0.49;
    if (fabs(xy) <= X * Y && fabs(yz) <= Y * Z && fabs(zx) <= X * o->z_length)
        return (sgt_objection){NULL, NULL};
    return independent(o->x, o->y, o->z);
}

/* 2^(1/(p - 1)) for p = 2 ... 8, to nearest. */
static const double mandelbrot_escape[] = {
    2, 0x1.6a09e667f3bcdp+0, 0x1.428a2f98d728bp+0, 0x1.306fe0a31b715p+0,
    0x1.2611186bae675p+0, 0x1.1f59ac3c7d6c0p+0, 0x1.1aa59c4115e7dp+0,
};

static sgt_objection common(const orbit_slice *s, const double *c, orbit *o)
{
    static const char finite[] = "a number that is not finite, or above 1e6";
    if (s->iterations < 0 || s->iterations > SGT_LEVELS)
        return (sgt_objection){"iterations", "not within 1 ... 10000"};
    if (s->power != 0 && (s->power < 2 || s->power > 8))
        return (sgt_objection){"power", "not within 2 ... 8"};
    o->c = c ? quaternion_of(c) : (quaternion){0, 0, 0, 0}, o->at = quaternion_of(s->at);
    double cc = quaternion_dot(o->c, o->c), aa = quaternion_dot(o->at, o->at);
    if (!(cc <= 1e12) && c && !orbit_bounded(c, 1e6)) return (sgt_objection){"c", finite}; /* true for NaN */
    if (!(aa <= 1e12) && !orbit_bounded(s->at, 1e6)) return (sgt_objection){"at", finite};
    o->at_length = sqrt(aa);
    o->iterations = s->iterations ? s->iterations : 10, o->power = s->power ? s->power : 2,
    o->mandelbrot = !c;
    sgt_objection fault = axes(s, o);
    if (fault.param) return fault;
    if (c) {
        o->c_abs = sqrt(cc) * (1 + 4 * SGT_U);
        o->safe = safe_escape(o->c_abs, o->power);
    } else {
        o->safe = mandelbrot_escape[o->power - 2];
    }
    if (s->escape != 0 && !(s->escape >= o->safe * (1 - 0x1p-40)))
        return (sgt_objection){"escape", c ? "below the safe value, the root of x^power = x + |c|"
                                           : "below the safe value, 2^(1/(power - 1))"};
    if (!(s->escape <= 1e6)) return (sgt_objection){"escape", "above 1e6"};
    o->E = s->escape != 0 ? s->escape : o->safe;
    o->E_err = s->escape != 0 || (!c && o->power == 2) ? 0 : 8 * SGT_U * o->safe;
    if (!c) o->c_abs = larger(o->safe, o->E) * (1 + 0x1p-40);
    /* The derivative of the orbit, at most (p R^(p-1))^N on the set, has to be a double. */
    double growth = o->power * small_power(c ? o->safe : o->c_abs, o->power - 1);
    if (growth > 16 && integer_power(growth, (unsigned)o->iterations) > 0x1p480)
        return (sgt_objection){"iterations",
                               "too many for so large a c: the derivative leaves the range of a double"};
    o->stretch = growth;
    return (sgt_objection){NULL, NULL};
}

sgt_objection sgt_orbit_of_julia(const void *self, orbit *o)
{
    const sgt_julia *s = self;
    return common(&(orbit_slice){s->at, s->ex, s->ey, s->ez, s->escape, s->iterations, s->power}, s->c, o);
}

sgt_objection sgt_orbit_of_mandelbrot(const void *self, orbit *o)
{
    const sgt_mandelbrot *s = self;
    return common(&(orbit_slice){s->at, s->ex, s->ey, s->ez, s->escape, s->iterations, s->power}, NULL, o);
}

/* ------------------------------------------------------------------ cells */

/* d of the next level, from A, V, e and d of this one. */
SGT_INLINE double next_d(double A, double V, double e, double d, double h, int power)
{
    double D = V * h + e, P = power;
    if (power == 2) return 2 * (D * V + (A + D) * d) + 16 * SGT_U * A * V;
    double most = small_power(A + D, power - 2);
    return (P * most * (A + D) * d + P * (P - 1) * most * D * V) +
           96 * P * P * SGT_U * small_power(A, power - 1) * V;
}

/* Is the whole cell outside, |Q + v s| > E + e?  |Q|^2 > E^2 is known. */
SGT_INLINE bool orbit_outside(pair_norms n, double E, double e, double h)
{
    double reach = n.V2 * h, T = E + e, ends = n.A2 + reach * h;
    T = T * T * (1 + 0x1p-38) + 64 * SGT_U * ends;
    return fabs(n.qv) >= reach ? ends - 2 * fabs(n.qv) * h > T : n.A2 * n.V2 - n.qv * n.qv > T * n.V2;
}

/* Does the orbit leave at level k, where E_k is E? */
SGT_INLINE bool left_at(const path *w, pair_norms n, double E, double e, double h, int k, bool thorough,
                        cell *r)
{
    if (!(n.A2 > E * E)) return false;
    bool out = orbit_outside(n, E, e, h);
    if (out ? thorough && k == w->iterations : !(n.A2 > 3 * E * E && k < w->iterations)) return false;
    r->verdict = out ? CELL_OUTSIDE : CELL_OPEN, r->level = k;
    r->A2 = n.A2, r->V2 = n.V2, r->qv = n.qv, r->e = e, r->W = r->g_err = HUGE_VAL;
    return true;
}

/* The cell at level N.  Returns true if it may be monotone. */
SGT_INLINE bool at_the_end(const path *w, pair_norms n, double e, double h, cell *r)
{
    double told = judge(w->E, w->E_err, n, sqrt(n.V2), e, h);
    *r = (cell){told == 1 ? CELL_INSIDE : CELL_OPEN, w->iterations, n.A2, n.V2, n.qv, e, HUGE_VAL, HUGE_VAL};
    return told == 2;
}

SGT_INLINE void bound_slope(const path *w, double A, double V, double d, double center, double h, cell *r)
{
    orbit_bounds b = judge_slope(w->E, w->E_err, (pair_norms){r->A2, r->V2, r->qv}, A, V,
                                 (orbit_errors){r->e, d, center}, h);
    r->W = b.W, r->g_err = b.g_err;
    if (fabs(r->qv) > r->W && r->verdict == CELL_OPEN) r->verdict = CELL_MONOTONE;
}

SGT_INLINE void look_at_powers(const path *w, double m, double h, bool thorough, cell *r)
{
    double A[SGT_KEPT + 1], V[SGT_KEPT + 1], es[SGT_KEPT + 1];
    quaternion v = w->along, q = quaternion_sum(w->start, quaternion_times(w->along, m)),
               c = w->mandelbrot ? q : w->c;
    double e = place_error(w->start_size, w->along_size, m, h), extra = w->mandelbrot ? e : 0;
    for (int k = w->mandelbrot ? 1 : 0;; k++) {
        pair_norms n = {quaternion_dot(q, q), quaternion_dot(v, v), quaternion_dot(q, v)};
        if (left_at(w, n, w->escape[k], e, h, k, thorough, r)) return;
        A[k] = sqrt(n.A2), V[k] = sqrt(n.V2), es[k] = e;
        if (k == w->iterations) {
            if (!at_the_end(w, n, e, h, r) && !thorough) return;
            break;
        }
        e = next_e(A[k], V[k], e, h, w->c_abs, w->power) + extra;
        orbit_step(&q, &v, c, w->along, w->power, w->mandelbrot);
    }
    double d = 8 * SGT_U * w->along_size, own = 8 * SGT_U * (w->start_size + fabs(m) * w->along_size),
           center = own, first = w->mandelbrot ? d : 0;
    int last = w->iterations;
    for (int k = w->mandelbrot ? 1 : 0; k < last; k++) {
        d = next_d(A[k], V[k], es[k], d, h, w->power) + first;
        center = next_e(A[k], 0, center, 0, w->c_abs, w->power) + (w->mandelbrot ? own : 0);
    }
    bound_slope(w, A[last], V[last], d, center, h, r);
}

/* The same for more levels than are kept, of any power ("more than 100 levels" of orbit.h). */
static void look_at_many(const path *w, double m, double h, bool thorough, cell *r)
{
    const quaternion start = quaternion_sum(w->start, quaternion_times(w->along, m)),
                     c = w->mandelbrot ? start : w->c;
    const double given = place_error(w->start_size, w->along_size, m, h), extra = w->mandelbrot ? given : 0,
                 first = 8 * SGT_U * w->along_size,
                 own = 8 * SGT_U * (w->start_size + fabs(m) * w->along_size);
    quaternion v = w->along, q = start;
    double e = given;
    for (int k = first_level(w);; k++) {
        pair_norms n = {quaternion_dot(q, q), quaternion_dot(v, v), quaternion_dot(q, v)};
        if (left_at(w, n, escape_at(w, k), e, h, k, thorough, r)) return;
        if (k == w->iterations) {
            if (!at_the_end(w, n, e, h, r) && !thorough) return;
            break;
        }
        e = UP * next_e(sqrt(n.A2), sqrt(n.V2), e, h, w->c_abs, w->power) + extra;
        orbit_step(&q, &v, c, w->along, w->power, w->mandelbrot);
    }
    double d = first, center = own;
    q = start, v = w->along, e = given;
    for (int k = first_level(w); k < w->iterations; k++) {
        double A = sqrt(quaternion_dot(q, q)), V = larger(LEAST_SPEED, sqrt(quaternion_dot(v, v)));
        d = UP * next_d(A, V, e, d, h, w->power) + (w->mandelbrot ? first : 0);
        center = UP * next_e(A, 0, center, 0, w->c_abs, w->power) + (w->mandelbrot ? own : 0);
        e = UP * next_e(A, V, e, h, w->c_abs, w->power) + extra;
        orbit_step(&q, &v, c, w->along, w->power, w->mandelbrot);
    }
    bound_slope(w, sqrt(r->A2), larger(LEAST_SPEED, sqrt(r->V2)), d, center, h, r);
}

/* Four cells of one ray at once, for p = 2.  One cell waits for its own results.  Four in the lanes of a
 * register take hardly longer. */
#if defined(__GNUC__)
typedef double lanes __attribute__((vector_size(32)));
typedef unsigned long long lane_bits __attribute__((vector_size(32)));

static const lane_bits SIGN = {1ULL << 63, 1ULL << 63, 1ULL << 63, 1ULL << 63};

SGT_INLINE void four_guess(const lanes *x, lanes *r) { *r = (lanes)(HALF_WAY - ((lane_bits)*x >> 1)); }
SGT_INLINE void four_magnitude(const lanes *x, lanes *r) { *r = (lanes)((lane_bits)*x & ~SIGN); }
SGT_INLINE void four_positive(const lanes *x, lanes *r) { *r = (lanes)((lane_bits)*x & (lane_bits)(*x > 0)); }

SGT_SQUARES(four, lanes)

#define ORBIT_ANY(b) ((((b)[0] | (b)[1]) | ((b)[2] | (b)[3])) != 0)

SGT_INLINE void look_at_squares(const path *w, const double m[4], const double h[4], bool mandelbrot,
                                cell r[4], bool known[4])
{
    lanes at = {m[0], m[1], m[2], m[3]}, half = {h[0], h[1], h[2], h[3]}, zero = {0, 0, 0, 0}, far,
          half2 = half * half;
    four_magnitude(&at, &far);
    four s = {.a = w->start.a + at * w->along.a, .b = w->start.b + at * w->along.b,
              .c = w->start.c + at * w->along.c, .d = w->start.d + at * w->along.d, .va = w->along.a + zero,
              .vb = w->along.b + zero, .vc = w->along.c + zero, .vd = w->along.d + zero,
              .e = 8 * SGT_U * (w->start_size + (far + half) * w->along_size)};
    four_constant c = {w->c.a + zero, w->c.b + zero, w->c.c + zero, w->c.d + zero, zero};
    if (mandelbrot) c = (four_constant){s.a, s.b, s.c, s.d, s.e}; /* Q_1 = c */
    lanes A[SGT_KEPT + 1], V2s[SGT_KEPT + 1], es[SGT_KEPT + 1];
    const lane_bits before[3] = {{~0ULL, 0, 0, 0}, {~0ULL, ~0ULL, 0, 0}, {~0ULL, ~0ULL, ~0ULL, 0}};
    /* live: not decided; wanted: of use; outside: decided to be so. */
    lane_bits live = {~0ULL, ~0ULL, ~0ULL, ~0ULL}, wanted = live, outside = live ^ live;
    const circle near = circle_of(w);
    int n = w->iterations;
    for (int k = mandelbrot ? 1 : 0;; k++) {
        four_norms(&s);
        double E = w->escape[k], E2 = E * E;
        lanes y = half2 * s.V2;
        lane_bits over = (lane_bits)(s.A2 > E2) & live;
        if (ORBIT_ANY(over)) {
            lanes escape = E + zero, x, room;
            four_magnitude(&s.qv, &x);
            x *= half;
            four_room(&s, near.keep, &escape, &x, &y, &room);
            lane_bits out = (lane_bits)(room > 0);
            outside |= out & over;
            live &= ~(over & out);
            if (k < n) live &= ~(over & (lane_bits)(s.A2 > near.far));
            /* Those behind an open cell are of no use. */
            for (int l = 0; l < 3; l++)
                if (!(live[l] | outside[l])) wanted &= before[l];
            lane_bits left = live & wanted;
            if (!ORBIT_ANY(left)) break;
        }
        four_twice_root(&s.A2, &A[k]), V2s[k] = s.V2, es[k] = s.e;
        if (k == n) break;
        four_step(&s, &A[k], &y, near.round, &c, mandelbrot);
        if (mandelbrot) s.va += w->along.a, s.vb += w->along.b, s.vc += w->along.c, s.vd += w->along.d;
    }
    bool slopes = false, asked[4] = {false, false, false, false};
    for (int l = 0; l < 4; l++) {
        known[l] = wanted[l] != 0;
        /* The rest is for level N only. */
        r[l].verdict = outside[l] ? CELL_OUTSIDE : CELL_OPEN, r[l].W = HUGE_VAL, r[l].level = 0;
        if (live[l] && wanted[l]) {
            asked[l] = at_the_end(w, (pair_norms){s.A2[l], s.V2[l], s.qv[l]}, s.e[l], h[l], &r[l]);
            slopes = slopes || asked[l];
        }
    }
    if (!slopes) return;
    lanes first = (8 * SGT_U * w->along_size) + zero, own = 8 * SGT_U * (w->start_size + far * w->along_size),
          center = own, d = first;
    for (int k = mandelbrot ? 1 : 0; k < n; k++) {
        four_slope(&A[k], &V2s[k], &es[k], &half, near.round, &d, &center);
        if (mandelbrot) d += first, center += own;
    }
    for (int l = 0; l < 4; l++)
        if (asked[l]) bound_slope(w, 0.5 * A[n][l], sqrt(s.V2[l]), d[l], center[l], h[l], &r[l]);
}
#else
SGT_INLINE void look_at_squares(const path *w, const double m[4], const double h[4], bool mandelbrot,
                                cell r[4], bool known[4])
{
    (void)mandelbrot;
    known[0] = true, known[1] = known[2] = known[3] = false;
    look_at_powers(w, m[0], h[0], false, &r[0]);
}
#endif

SGT_KERNEL static void look_at_julia(const path *w, const double m[4], const double h[4], cell r[4],
                                     bool known[4])
{
    look_at_squares(w, m, h, false, r, known);
}
SGT_KERNEL static void look_at_mandelbrot(const path *w, const double m[4], const double h[4], cell r[4],
                                          bool known[4])
{
    look_at_squares(w, m, h, true, r, known);
}
static void look_at_any(const path *w, double m, double h, cell *r) { look_at_powers(w, m, h, false, r); }
static void look_thoroughly(const path *w, double m, double h, cell *r)
{
    if (w->before) look_at_many(w, m, h, true, r);
    else look_at_powers(w, m, h, true, r);
}

void sgt_orbit_cells(const path *w, const double m[4], const double h[4], cell r[4], bool known[4])
{
    if (w->power == 2 && !w->before) {
        if (w->mandelbrot) look_at_mandelbrot(w, m, h, r, known);
        else look_at_julia(w, m, h, r, known);
    } else {
        known[0] = true, known[1] = known[2] = known[3] = false;
        if (w->before) look_at_many(w, m[0], h[0], false, &r[0]);
        else look_at_any(w, m[0], h[0], &r[0]);
    }
}

void sgt_orbit_cell(const path *w, double m, double h, cell *r)
{
    cell all[4];
    bool known[4];
    sgt_orbit_cells(w, (double[]){m, m, m, m}, (double[]){h, h, h, h}, all, known);
    *r = all[0];
}

bool sgt_orbit_monotone(const path *w, double m, double h)
{
    quaternion v = w->along, q = quaternion_sum(w->start, quaternion_times(w->along, m)),
               c = w->mandelbrot ? q : w->c;
    double e = place_error(w->start_size, w->along_size, m, h), extra = w->mandelbrot ? e : 0,
           d = 8 * SGT_U * w->along_size, first = w->mandelbrot ? d : 0;
    const double up = w->before ? UP : 1, least = w->before ? LEAST_SPEED : 0;
    for (int k = first_level(w); k < w->iterations; k++) {
        double A = sqrt(quaternion_dot(q, q)), V = larger(least, sqrt(quaternion_dot(v, v)));
        d = up * next_d(A, V, e, d, h, w->power) + first;
        e = up * next_e(A, V, e, h, w->c_abs, w->power) + extra;
        orbit_step(&q, &v, c, w->along, w->power, w->mandelbrot);
    }
    pair_norms n = {quaternion_dot(q, q), quaternion_dot(v, v), quaternion_dot(q, v)};
    const orbit_errors by = {e, d, 0};
    const double V = larger(least, sqrt(n.V2));
    return fabs(n.qv) > judge_slope(w->E, w->E_err, n, sqrt(n.A2), V, by, h).W; /* NaN: no */
}

/* F at |Q| = A, for bounds: slightly lower for slip -1, higher for slip 1. */
static double f_of(double A2, double E2, double slip)
{
    if (!(A2 < HUGE_VAL)) return 1;
    double f = (A2 - E2) / (A2 + E2) + slip * 4 * SGT_U;
    return f < -1 ? -1 : f > 1 ? 1 : f;
}

sgt_interval sgt_orbit_enclose(const path *w, double m, double h, sgt_interval *slope)
{
    cell e;
    look_thoroughly(w, m, h, &e);
    double E2 = w->E * w->E, slack = 1 + 0x1p-38;
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    if (e.level < w->iterations) return (sgt_interval){e.verdict == CELL_OUTSIDE ? 0x1p-1022 : -1, 1};
    double most = sqrt(e.A2 + e.V2 * h * h + 2 * fabs(e.qv) * h) * (1 + 16 * SGT_U) + e.e * slack;
    double ends = e.A2 + e.V2 * h * h,
           low = fabs(e.qv) >= e.V2 * h ? ends - 2 * fabs(e.qv) * h : e.A2 - e.qv * e.qv / e.V2;
    double least = larger(sqrt(larger(low - 64 * SGT_U * ends, 0)) * (1 - 4 * SGT_U) - e.e * slack, 0);
    if (!(most < 0x1p500)) return (sgt_interval){-1, 1};
    double lowest = f_of(least * least, E2, -1), highest = f_of(most * most, E2, 1);
    double shift = 2 * w->E_err / w->E;
    if (e.W < HUGE_VAL) { /* F' = 4 E^2 <Q, dQ> / (|Q|^2 + E^2)^2 */
        double s = most * most + E2, l = least * least + E2, steep = 4 * E2 / l / l * slack * (1 + 8 * shift),
               gentle = 4 * E2 / s / s / slack * (1 - 8 * shift);
        double lo = e.qv - e.W, hi = e.qv + e.W;
        slope->lo = (lo < 0 ? lo * steep : lo * gentle) - 0x1p-1022;
        slope->hi = (hi > 0 ? hi * steep : hi * gentle) + 0x1p-1022;
    }
    return (sgt_interval){larger(lowest - shift, -1), -larger(-(highest + shift), -1)};
}

/* ------------------------------------------------------------------ values */

SGT_INLINE double value_along(const path *w, double m, double *slope, int power, bool mandelbrot)
{
    quaternion q = quaternion_sum(w->start, quaternion_times(w->along, m)), v = w->along, c = w->c,
               dc = w->along;
    double E2 = w->E * w->E, A2 = quaternion_dot(q, q), most = FAR2 * (1 + E2);
    int k = 0;
    if (mandelbrot) c = q, k = 1;
    for (; k < w->iterations; k++) {
        if (!(A2 < most)) {
            *slope = A2 > 0 ? 0 : NAN;
            return A2 > 0 ? 1 : NAN;
        }
        orbit_step(&q, &v, c, dc, power, mandelbrot);
        A2 = quaternion_dot(q, q);
    }
    double inverse = 1 / (A2 + E2);
    *slope = 4 * (E2 * inverse) * quaternion_dot(quaternion_times(q, inverse), v);
    return (A2 - E2) * inverse;
}

static double value_of_square(const path *w, double m, double *slope)
{
    return value_along(w, m, slope, 2, false);
}
static double value_of_any(const path *w, double m, double *slope)
{
    return value_along(w, m, slope, w->power, w->mandelbrot);
}

double sgt_orbit_value(const path *w, double m, double *slope)
{
    return w->power == 2 && !w->mandelbrot ? value_of_square(w, m, slope) : value_of_any(w, m, slope);
}

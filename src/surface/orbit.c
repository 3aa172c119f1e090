/* orbit.c - cells and values of an orbit along a ray; orbit.h has the mathematics. */
#include "orbit.h"

/* A cell whose middle is so far outside, |Q|^2 > 3 E_k^2, and that is not outside as a whole, will not be at a later
 * level either: its bounds grow as fast.  Nothing but time depends on it (1.2: 15 % more cells; 64: 3 % more levels). */
static const double HOPELESS = 3;

static const double FAR2 = 0x1p64; /* u beyond it is infinity: F = 1 - 2/u rounds to 1 */

/* ------------------------------------------------------------- parameters */

/* The positive root of x^p = x + b, within 4 ulps: Newton from above, where x^p - x is convex. */
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

/* What two kinds of set have in common. */
typedef struct slice { const double *at, *ex, *ey, *ez; double escape; int iterations, power; } slice;

/* Each component at most `most`; not of NaN. */
static bool bounded(const double q[4], double most)
{
    return fabs(q[0]) <= most && fabs(q[1]) <= most && fabs(q[2]) <= most && fabs(q[3]) <= most;
}

/* Three axes, each of them in range: what is left of each beside those before it (Gram and Schmidt). */
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

static sgt_objection axes(const slice *s, orbit *o)
{
    o->x = quaternion_of(s->ex), o->y = quaternion_of(s->ey), o->z = quaternion_of(s->ez);
    double xx = quaternion_dot(o->x, o->x), yy = quaternion_dot(o->y, o->y), zz = quaternion_dot(o->z, o->z);
    if (!(xx + yy + zz <= 1e200) && !(bounded(s->ex, 1e100) && bounded(s->ey, 1e100) && bounded(s->ez, 1e100))) { /* not of NaN */
        const char *key = !bounded(s->ex, 1e100) ? "ex" : !bounded(s->ey, 1e100) ? "ey" : "ez";
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
    if (!(xx >= least && yy >= least && zz >= least)) return (sgt_objection){!(xx >= least) ? "ex" : !(yy >= least) ? "ey" : "ez", "zero, or shorter than 1e-100"};
    o->x_length = sqrt(xx), o->y_length = sqrt(yy), o->z_length = sqrt(zz);
    double xy = quaternion_dot(o->x, o->y), yz = quaternion_dot(o->y, o->z), zx = quaternion_dot(o->z, o->x);
    /* no two at less than 60 degrees, and a little: then they are independent */
    double X = o->x_length * 0.49, Y = o->y_length, Z = o->z_length * 0.49;
    if (fabs(xy) <= X * Y && fabs(yz) <= Y * Z && fabs(zx) <= X * o->z_length) return (sgt_objection){NULL, NULL};
    return independent(o->x, o->y, o->z);
}

static sgt_objection common(const slice *s, const double *c, orbit *o)
{
    static const char finite[] = "a number that is not finite, or above 1e6";
    if (s->iterations < 0 || s->iterations > SGT_LEVELS) return (sgt_objection){"iterations", "not within 1 ... 100"};
    if (s->power != 0 && (s->power < 2 || s->power > 8)) return (sgt_objection){"power", "not within 2 ... 8"};
    o->c = c ? quaternion_of(c) : (quaternion){0, 0, 0, 0}, o->at = quaternion_of(s->at);
    double cc = quaternion_dot(o->c, o->c), aa = quaternion_dot(o->at, o->at);
    if (!(cc <= 1e12) && c && !bounded(c, 1e6)) return (sgt_objection){"c", finite}; /* not of NaN */
    if (!(aa <= 1e12) && !bounded(s->at, 1e6)) return (sgt_objection){"at", finite};
    o->at_length = sqrt(aa);
    o->iterations = s->iterations ? s->iterations : 10, o->power = s->power ? s->power : 2, o->mandelbrot = !c;
    sgt_objection fault = axes(s, o);
    if (fault.param) return fault;
    if (c) {
        o->c_abs = sqrt(cc) * (1 + 4 * SGT_U);
        o->safe = safe_escape(o->c_abs, o->power);
    } else {
        o->safe = o->power == 2 ? 2 : pow(2, 1.0 / (o->power - 1));
    }
    if (s->escape != 0 && !(s->escape >= o->safe * (1 - 0x1p-40))) return (sgt_objection){"escape", c ? "below the safe value, the root of x^power = x + |c|" : "below the safe value, 2^(1/(power - 1))"};
    if (!(s->escape <= 1e6)) return (sgt_objection){"escape", "above 1e6"};
    o->E = s->escape != 0 ? s->escape : o->safe;
    o->E_err = s->escape != 0 || (!c && o->power == 2) ? 0 : 8 * SGT_U * o->safe;
    if (!c) o->c_abs = larger(o->safe, o->E) * (1 + 0x1p-40);
    /* the derivative of the orbit, at most (p R^(p-1))^N on the set, has to be a double */
    double growth = o->power * small_power(c ? o->safe : o->c_abs, o->power - 1);
    if (growth > 16 && o->iterations * log2(growth) > 480) return (sgt_objection){"iterations", "too many for so large a c: the derivative leaves the range of a double"};
    o->stretch = growth;
    return (sgt_objection){NULL, NULL};
}

sgt_objection sgt_orbit_of_julia(const void *self, orbit *o)
{
    const sgt_julia *s = self;
    return common(&(slice){s->at, s->ex, s->ey, s->ez, s->escape, s->iterations, s->power}, s->c, o);
}

sgt_objection sgt_orbit_of_mandelbrot(const void *self, orbit *o)
{
    const sgt_mandelbrot *s = self;
    return common(&(slice){s->at, s->ex, s->ey, s->ez, s->escape, s->iterations, s->power}, NULL, o);
}

/* ------------------------------------------------------------------ cells */

/* d of the next level; A, V, e, d of this. */
SGT_INLINE double next_d(double A, double V, double e, double d, double h, int power)
{
    double D = V * h + e, P = power;
    if (power == 2) return 2 * (D * V + (A + D) * d) + 16 * SGT_U * A * V;
    double most = small_power(A + D, power - 2);
    return (P * most * (A + D) * d + P * (P - 1) * most * D * V) + 96 * P * P * SGT_U * small_power(A, power - 1) * V;
}

typedef struct pair_norms { double A2, V2, qv; } pair_norms;

/* Is the whole cell outside, |Q + v s| > E + e?  |Q|^2 > E^2 is known. */
SGT_INLINE bool outside(pair_norms n, double E, double e, double h)
{
    double reach = n.V2 * h, T = E + e, ends = n.A2 + reach * h;
    T = T * T * (1 + 0x1p-38) + 64 * SGT_U * ends;
    return fabs(n.qv) >= reach ? ends - 2 * fabs(n.qv) * h > T : n.A2 * n.V2 - n.qv * n.qv > T * n.V2;
}

SGT_INLINE bool left_at(const path *w, pair_norms n, double e, double h, int k, bool thorough, cell *r)
{
    double E = w->escape[k];
    if (!(n.A2 > E * E)) return false;
    bool out = outside(n, E, e, h);
    if (out ? thorough && k == w->iterations : !(n.A2 > HOPELESS * E * E && k < w->iterations)) return false;
    r->verdict = out ? CELL_OUTSIDE : CELL_OPEN, r->level = k;
    r->A2 = n.A2, r->V2 = n.V2, r->qv = n.qv, r->e = e, r->W = r->g_err = HUGE_VAL;
    return true;
}

/* At level N: inside, or not; true: it may be monotone, or g so near its rounding that W and g_err are wanted. */
SGT_INLINE bool judge(const path *w, pair_norms at, double V, double e, double h, cell *r)
{
    double slack = 1 + 0x1p-38, room = (w->E - w->E_err) * (1 - 0x1p-50) - e * slack, qv = fabs(at.qv), least = at.V2 * h + e * V;
    r->verdict = CELL_OPEN, r->level = w->iterations;
    r->A2 = at.A2, r->V2 = at.V2, r->qv = at.qv, r->e = e, r->W = r->g_err = HUGE_VAL;
    if (room > 0 && (at.A2 + at.V2 * h * h + 2 * qv * h) * (1 + 64 * SGT_U) < room * room) r->verdict = CELL_INSIDE;
    return r->verdict == CELL_OPEN && (qv > least || (qv + least) * h <= 0x1p-30 * at.A2);
}

/* With d and the bound `center` of what Q at m itself is off by. */
SGT_INLINE void judge_slope(const path *w, double A, double V, double d, double center, double h, cell *r)
{
    double D = V * h + r->e, slack = 1 + 0x1p-38;
    r->W = (r->V2 * h + r->e * V + (A + D) * d) * slack + 16 * SGT_U * A * V;
    r->g_err = ((2 * A + center) * center) * slack + 8 * SGT_U * r->A2 + 4 * (w->E + w->E_err) * (w->E_err + SGT_U * w->E);
    if (fabs(r->qv) > r->W && r->verdict == CELL_OPEN) r->verdict = CELL_MONOTONE;
}

SGT_INLINE double place_error(const path *w, double m, double h) { return 8 * SGT_U * (w->start_size + (fabs(m) + h) * w->along_size); }

SGT_INLINE void look_at_powers(const path *w, double m, double h, bool thorough, cell *r)
{
    double A[SGT_LEVELS + 1], V[SGT_LEVELS + 1], es[SGT_LEVELS + 1];
    quaternion v = w->along, q = quaternion_sum(w->start, quaternion_times(w->along, m)), c = w->mandelbrot ? q : w->c;
    double e = place_error(w, m, h), extra = w->mandelbrot ? e : 0;
    for (int k = w->mandelbrot ? 1 : 0;; k++) {
        pair_norms n = {quaternion_dot(q, q), quaternion_dot(v, v), quaternion_dot(q, v)};
        if (left_at(w, n, e, h, k, thorough, r)) return;
        A[k] = sqrt(n.A2), V[k] = sqrt(n.V2), es[k] = e;
        if (k == w->iterations) {
            if (!judge(w, n, V[k], e, h, r) && !thorough) return;
            break;
        }
        e = next_e(A[k], V[k], e, h, w->c_abs, w->power) + extra;
        orbit_step(&q, &v, c, w->along, w->power, w->mandelbrot);
    }
    double d = 8 * SGT_U * w->along_size, own = 8 * SGT_U * (w->start_size + fabs(m) * w->along_size), center = own, first = w->mandelbrot ? d : 0;
    int last = w->iterations;
    for (int k = w->mandelbrot ? 1 : 0; k < last; k++) {
        d = next_d(A[k], V[k], es[k], d, h, w->power) + first;
        center = next_e(A[k], 0, center, 0, w->c_abs, w->power) + (w->mandelbrot ? own : 0);
    }
    judge_slope(w, A[last], V[last], d, center, h, r);
}

/* Four cells of one ray at once, p = 2.  A cell alone waits for its own results; four in the lanes of a register
 * take hardly longer.  No root of V2 is needed on the way: by 2 V h e <= V^2 h^2 / 4 + 4 e^2,
 *     (V h + e)^2 <= 5/4 V^2 h^2 + 5 e^2    and    16 u h A V <= 8 u (A^2 + h^2 V^2).
 * With A2 = |Q|^2 and qv = <Q, v> known, a^2 - |q|^2 = 2 a^2 - A2 and a va - <q, vq> =
 * 2 a va - qv; A2 is off by 3 u A^2 and qv by 3 u A V, which is in the bounds of orbit.h.  A and V are needed
 * as bounds from above: upper_root is one, at most 0.4 % too great. */
#if defined(__GNUC__)
typedef double lanes __attribute__((vector_size(32)));
typedef unsigned long long lane_bits __attribute__((vector_size(32)));

/* Newton's step toward 1 / sqrt(x) ends below it; from a start within 3.43 % (the well-known constant, for
 * doubles: Lomont 2003), within 0.18 %. */
SGT_INLINE void upper_root(const lanes *x, lanes *root)
{
    lanes r = (lanes)(0x5fe6eb50c7b537a9ULL - ((lane_bits)*x >> 1));
    r *= 1.5 - 0.5 * *x * (r * r);
    *root = *x * r * 1.0018;
}

#define ANY(b) ((((b)[0] | (b)[1]) | ((b)[2] | (b)[3])) != 0)

/* Which of the lanes with |Q| > E are outside as a whole: `outside` above, lane by lane. */
SGT_INLINE void lanes_outside(const lanes *A2, const lanes *V2, const lanes *qv, const lanes *e, const lanes *h, double E, lane_bits *out)
{
    const lane_bits sign = (lane_bits){1, 1, 1, 1} << 63;
    lanes reach = *V2 * *h, ends = *A2 + reach * *h, T = E + *e, steep = (lanes)((lane_bits)*qv & ~sign);
    T = T * T * (1 + 0x1p-38) + 64 * SGT_U * ends;
    lane_bits by_end = (lane_bits)(steep >= reach);
    *out = (by_end & (lane_bits)(ends - 2 * steep * *h > T)) | (~by_end & (lane_bits)(*A2 * *V2 - *qv * *qv > T * *V2));
}

SGT_INLINE void look_at_squares(const path *w, const double m[4], const double h[4], bool mandelbrot, cell r[4], bool known[4])
{
    lanes at = {m[0], m[1], m[2], m[3]}, half = {h[0], h[1], h[2], h[3]}, zero = {0, 0, 0, 0};
    lanes a = w->start.a + at * w->along.a, b = w->start.b + at * w->along.b, c = w->start.c + at * w->along.c, d = w->start.d + at * w->along.d;
    lanes va = w->along.a + zero, vb = w->along.b + zero, vc = w->along.c + zero, vd = w->along.d + zero;
    lanes ca = w->c.a + zero, cb = w->c.b + zero, cc = w->c.c + zero, cd = w->c.d + zero;
    lanes A[SGT_LEVELS + 1], V2s[SGT_LEVELS + 1], es[SGT_LEVELS + 1], A2, V2, qv, half2 = half * half;
    lanes far = (lanes)((lane_bits)at & ~((lane_bits){1, 1, 1, 1} << 63)), e = 8 * SGT_U * (w->start_size + (far + half) * w->along_size), extra = zero;
    if (mandelbrot) ca = a, cb = b, cc = c, cd = d, extra = e; /* Q_1 = c */
    const lane_bits before[3] = {{~0ULL, 0, 0, 0}, {~0ULL, ~0ULL, 0, 0}, {~0ULL, ~0ULL, ~0ULL, 0}};
    lane_bits live = {~0ULL, ~0ULL, ~0ULL, ~0ULL}, wanted = live, outside = live ^ live; /* not decided; of use; decided so */
    int n = w->iterations;
    for (int k = mandelbrot ? 1 : 0;; k++) {
        A2 = (a * a + b * b) + (c * c + d * d), V2 = (va * va + vb * vb) + (vc * vc + vd * vd), qv = (a * va + b * vb) + (c * vc + d * vd);
        double E = w->escape[k], E2 = E * E;
        lane_bits over = (lane_bits)(A2 > E2) & live;
        if (ANY(over)) {
            lane_bits out;
            lanes_outside(&A2, &V2, &qv, &e, &half, E, &out);
            outside |= out & over;
            live &= ~(over & out);
            if (k < n) live &= ~(over & (lane_bits)(A2 > HOPELESS * E2));
            /* those behind an open cell are of no use */
            for (int l = 0; l < 3; l++)
                if (!(live[l] | outside[l])) wanted &= before[l];
            lane_bits left = live & wanted;
            if (!ANY(left)) break;
        }
        upper_root(&A2, &A[k]), V2s[k] = V2, es[k] = e;
        if (k == n) break;
        lanes reach2 = half2 * V2, two_a = 2 * a, two_va = 2 * va;
        e = (((2 * A[k] + 5 * e) * e + 1.25 * reach2) + 8 * SGT_U * ((2 * A2 + reach2) + w->c_abs)) + extra;
        va = two_a * va * 2 - 2 * qv, vb = two_a * vb + two_va * b, vc = two_a * vc + two_va * c, vd = two_a * vd + two_va * d;
        if (mandelbrot) va += w->along.a, vb += w->along.b, vc += w->along.c, vd += w->along.d;
        a = (two_a * a - A2) + ca, b = two_a * b + cb, c = two_a * c + cc, d = two_a * d + cd;
    }
    bool slopes = false;
    for (int l = 0; l < 4; l++) {
        known[l] = wanted[l] != 0;
        r[l].verdict = outside[l] ? CELL_OUTSIDE : CELL_OPEN, r[l].W = HUGE_VAL, r[l].level = 0; /* the rest is of level N alone */
        if (live[l] && wanted[l]) slopes = judge(w, (pair_norms){A2[l], V2[l], qv[l]}, sqrt(V2[l]), e[l], h[l], &r[l]) || slopes;
    }
    if (!slopes) return;
    lanes first = (8 * SGT_U * w->along_size) + zero, own = 8 * SGT_U * (w->start_size + far * w->along_size), center = own, dv = first;
    for (int k = mandelbrot ? 1 : 0; k < n; k++) {
        lanes V, D;
        upper_root(&V2s[k], &V);
        D = V * half + es[k];
        dv = 2 * (D * V + (A[k] + D) * dv) + 16 * SGT_U * A[k] * V;
        center = 2 * A[k] * center + center * center + 8 * SGT_U * (A[k] * A[k] + w->c_abs);
        if (mandelbrot) dv += first, center += own;
    }
    for (int l = 0; l < 4; l++)
        if (live[l] && wanted[l] && r[l].verdict == CELL_OPEN) judge_slope(w, A[n][l], sqrt(V2[l]), dv[l], center[l], h[l], &r[l]);
}
#else
SGT_INLINE void look_at_squares(const path *w, const double m[4], const double h[4], bool mandelbrot, cell r[4], bool known[4])
{
    (void)mandelbrot;
    known[0] = true, known[1] = known[2] = known[3] = false;
    look_at_powers(w, m[0], h[0], false, &r[0]);
}
#endif

SGT_CLONES_WIDE static void look_at_julia(const path *w, const double m[4], const double h[4], cell r[4], bool known[4]) { look_at_squares(w, m, h, false, r, known); }
SGT_CLONES_WIDE static void look_at_mandelbrot(const path *w, const double m[4], const double h[4], cell r[4], bool known[4]) { look_at_squares(w, m, h, true, r, known); }
SGT_CLONES static void look_at_any(const path *w, double m, double h, cell *r) { look_at_powers(w, m, h, false, r); }
SGT_CLONES static void look_thoroughly(const path *w, double m, double h, cell *r) { look_at_powers(w, m, h, true, r); }

void sgt_orbit_cells(const path *w, const double m[4], const double h[4], cell r[4], bool known[4])
{
    if (w->power == 2) {
        if (w->mandelbrot) look_at_mandelbrot(w, m, h, r, known);
        else look_at_julia(w, m, h, r, known);
    } else {
        known[0] = true, known[1] = known[2] = known[3] = false;
        look_at_any(w, m[0], h[0], &r[0]);
    }
}

void sgt_orbit_cell(const path *w, double m, double h, cell *r)
{
    cell four[4];
    bool known[4];
    sgt_orbit_cells(w, (double[]){m, m, m, m}, (double[]){h, h, h, h}, four, known);
    *r = four[0];
}

/* F at |Q| = A, for bounds: a little lower, or higher. */
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
    double ends = e.A2 + e.V2 * h * h, low = fabs(e.qv) >= e.V2 * h ? ends - 2 * fabs(e.qv) * h : e.A2 - e.qv * e.qv / e.V2;
    double least = larger(sqrt(larger(low - 64 * SGT_U * ends, 0)) * (1 - 4 * SGT_U) - e.e * slack, 0);
    if (!(most < 0x1p500)) return (sgt_interval){-1, 1};
    double lowest = f_of(least * least, E2, -1), highest = f_of(most * most, E2, 1);
    double shift = 2 * w->E_err / w->E;
    if (e.W < HUGE_VAL) { /* F' = 4 E^2 <Q, dQ> / (|Q|^2 + E^2)^2 */
        double s = most * most + E2, l = least * least + E2, steep = 4 * E2 / l / l * slack * (1 + 8 * shift), gentle = 4 * E2 / s / s / slack * (1 - 8 * shift);
        double lo = e.qv - e.W, hi = e.qv + e.W;
        slope->lo = (lo < 0 ? lo * steep : lo * gentle) - 0x1p-1022;
        slope->hi = (hi > 0 ? hi * steep : hi * gentle) + 0x1p-1022;
    }
    return (sgt_interval){larger(lowest - shift, -1), -larger(-(highest + shift), -1)};
}

/* ------------------------------------------------------------------ values */

SGT_INLINE double value_along(const path *w, double m, double *slope, int power, bool mandelbrot)
{
    quaternion q = quaternion_sum(w->start, quaternion_times(w->along, m)), v = w->along, c = w->c, dc = w->along;
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

SGT_CLONES static double value_of_square(const path *w, double m, double *slope) { return value_along(w, m, slope, 2, false); }
SGT_CLONES static double value_of_any(const path *w, double m, double *slope) { return value_along(w, m, slope, w->power, w->mandelbrot); }

double sgt_orbit_value(const path *w, double m, double *slope)
{
    return w->power == 2 && !w->mandelbrot ? value_of_square(w, m, slope) : value_of_any(w, m, slope);
}

// SPDX-License-Identifier: MIT
/* folded.c - fractals by distance bounds: Menger's sponge and Sierpinski's tetrahedron, with proofs.
 *
 * Both are bodies of finitely many flat faces, and F is a distance bound of the folding kind (J. C. Hart,
 * "Sphere tracing", 1996; such bounds are folklore since 2010): continuous, zero on the surface and nowhere
 * else but there, and changing by no more than the distance travelled.  So |F| is a clearance.  Along a ray F
 * is piecewise linear.
 *
 * THE SPONGE of level n (K. Menger 1926).  The cube |x|, |y|, |z| <= 1 is cut in 27; the cubes at which two
 * coordinates or more are in the middle third are taken away; and so on with those left, n times.  At level k
 * cells have half an edge of h = 3^(1-k), and v = |x / h - nearest even number| says how far x is from the
 * middle of its cell: w = (v - 1/3) h is below 0 in the middle third, and is a distance.  Two of three are
 * below 0 just where the middle one in size is: so g_k = -median(w_x, w_y, w_z) is above 0 in what level k
 * takes away, and F = max(|x| - 1, |y| - 1, |z| - 1, g_1, ..., g_n). Each w changes by no more than its
 * coordinate; median and max keep that.
 *
 * THE TETRAHEDRON of level n (W. Sierpinski 1915, in space).  T has the corners (1, 1, 1), (1, -1, -1),
 * (-1, 1, -1), (-1, -1, 1); its copies of half the size at each corner are left, n times: 4^n tetrahedra. The
 * three mirrors that exchange (1, 1, 1) with another corner, each used if it brings the point nearer to
 * (1, 1, 1), take a point to the quarter of that corner, because after each the corner is the nearest of
 * those compared so far.  Then p -> 2 p - (1, 1, 1).  After n turns F = (distance bound of T) / 2^n, T's
 * being the greatest of its faces' four linear forms.  A mirror changes nothing on its own plane, so F is
 * continuous; it keeps distances, so F changes by no more than the distance.
 *
 * ENCLOSURES.  Over a stretch of the ray every coordinate has an interval of values and one of slopes.  Where
 * a kink (the middle or border of a cell, a mirror's plane) may lie in the stretch, both sides are taken;
 * where one of several may be the greatest, or the median, the slopes of all that may are.  F is continuous,
 * so a mean value theorem holds with these slopes.  F is also within its value in the middle, plus slope
 * times half the width; both are cut.  All of it is widened by what rounding can do.
 *
 * ROUNDING, in units of U = 2^-53, with P >= |x|, |y|, |z|.  Sponge: x / h rounds once, the nearest even
 * number is taken away exactly, - 1/3 and times h round: 2 P + 3 is more than the sum.  Tetrahedron: |p_k| <=
 * 2^k (P + 1), and each turn rounds 2 p - 1 once and doubles what was before: n (P + 1) 2^n in each
 * coordinate, sqrt(3) times in length; the forms round 4 terms: (2 n + 12) (P + 1) in units of F is more than
 * the sum. */
#include "own.h"

static const double U = 0x1p-53;

/* Values over a stretch of the ray, and slopes. */
typedef struct course {
    double lo, hi, least, most;
} course;

static inline course hull(course a, course b)
{
    return (course){fmin(a.lo, b.lo), fmax(a.hi, b.hi), fmin(a.least, b.least), fmax(a.most, b.most)};
}

static inline course negated(course a) { return (course){-a.hi, -a.lo, -a.most, -a.least}; }

/* The greater: slopes of those that may be it. */
static inline course greater(course a, course b)
{
    course c = {fmax(a.lo, b.lo), fmax(a.hi, b.hi), HUGE_VAL, -HUGE_VAL};
    if (a.hi >= c.lo) c.least = a.least, c.most = a.most;
    if (b.hi >= c.lo) c.least = fmin(c.least, b.least), c.most = fmax(c.most, b.most);
    return c;
}

static inline double median(double a, double b, double c) { return fmax(fmin(a, b), fmin(fmax(a, b), c)); }

static course median_of(const course w[3])
{
    course m = {median(w[0].lo, w[1].lo, w[2].lo), median(w[0].hi, w[1].hi, w[2].hi), HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < 3; i++)
        if (w[i].hi >= m.lo && w[i].lo <= m.hi)
            m.least = fmin(m.least, w[i].least), m.most = fmax(m.most, w[i].most);
    return m;
}

/* The ray's three coordinates over t, without what rounds; *far is the P of the head. */
static void courses(const sgt_ray *ray, sgt_interval t, course x[3], double *far)
{
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    *far = 0;
    for (int i = 0; i < 3; i++) {
        const double a = o[i] + t.lo * d[i], b = o[i] + t.hi * d[i];
        x[i] = (course){fmin(a, b), fmax(a, b), d[i], d[i]};
        *far = fmax(*far, fabs(o[i]) + fmax(fabs(t.lo), fabs(t.hi)) * fabs(d[i]));
    }
}

/* What both know of F, and F in the middle, where the ray's point is rounded too (4 P). */
static sgt_interval cut(course f, double middle, double off, double half, sgt_interval *slope)
{
    const double reach = half * fmax(fabs(f.least), fabs(f.most)) * (1 + 4 * U);
    *slope = (sgt_interval){f.least, f.most};
    return (sgt_interval){fmax(f.lo, middle - reach) - off, fmin(f.hi, middle + reach) + off};
}

/* --------------------------------------------------------------- the sponge */

static int levels_of_menger(const menger *s) { return s->iterations ? s->iterations : 3; }

static double menger_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const double x[3] = {p.x, p.y, p.z};
    double f = -HUGE_VAL, h = 1, slope = 0;
    int by = 0;
    for (int i = 0; i < 3; i++)
        if (fabs(x[i]) - 1 > f) f = fabs(x[i]) - 1, by = i, slope = x[i] < 0 ? -1 : 1;
    for (int k = levels_of_menger(self); k > 0; k--, h /= 3) {
        double w[3], toward[3];
        for (int i = 0; i < 3; i++) {
            const double y = x[i] / h, aside = y - 2 * rint(y / 2);
            w[i] = (fabs(aside) - 1.0 / 3) * h, toward[i] = aside < 0 ? -1 : 1;
        }
        const double m = median(w[0], w[1], w[2]);
        if (-m > f) f = -m, by = w[0] == m ? 0 : w[1] == m ? 1 : 2, slope = -toward[by];
    }
    if (grad) *grad = (vec3){by == 0 ? slope : 0, by == 1 ? slope : 0, by == 2 ? slope : 0};
    return isfinite(p.x + p.y + p.z) ? f : (double)NAN;
}

static double menger_rounding(const void *self, sgt_vec3 p)
{
    (void)self;
    return U * (2 * fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) + 3);
}

static double menger_clearance(const void *self, sgt_vec3 p)
{
    return fabs(menger_value(self, p, NULL)) - menger_rounding(self, p);
}

/* |y - nearest even number| for y = x / h, as w; off: how far y may be off. */
static course wave(course x, double h, double off)
{
    const double a = x.lo / h - off, b = x.hi / h + off, even = 2 * ceil(a / 2),
                 odd = 2 * ceil((a - 1) / 2) + 1, at_a = fabs(a - 2 * rint(a / 2)),
                 at_b = fabs(b - 2 * rint(b / 2));
    const bool falls = even <= b, turns = odd <= b; /* there is a middle, a border of a cell */
    const double slope = x.least, size = fabs(slope);
    course w = {falls ? 0 : fmin(at_a, at_b), turns ? 1 : fmax(at_a, at_b), -size, size};
    if (!falls && !turns) {
        const double up = a - 2 * rint(a / 2) < 0 ? -slope : slope;
        w.least = w.most = up;
    }
    w.lo = (w.lo - 1.0 / 3) * h, w.hi = (w.hi - 1.0 / 3) * h;
    return w;
}

static sgt_interval menger_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    course x[3], f = {-HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
    double far, h = 1;
    courses(ray, t, x, &far);
    const double off = 16 * U * (far + 1), middle = t.lo + 0.5 * (t.hi - t.lo);
    for (int i = 0; i < 3; i++) {
        const course away = negated(x[i]), size = x[i].lo > off    ? x[i]
                                                  : x[i].hi < -off ? away
                                                                   : hull(x[i], away);
        const course wall = {x[i].lo <= 0 && x[i].hi >= 0 ? -1 : size.lo - 1, size.hi - 1, size.least,
                             size.most};
        f = greater(f, (course){wall.lo - off, wall.hi + off, wall.least, wall.most});
    }
    for (int k = levels_of_menger(self); k > 0; k--, h /= 3) {
        course w[3];
        for (int i = 0; i < 3; i++) {
            w[i] = wave(x[i], h, off / h);
            w[i].lo -= off, w[i].hi += off;
        }
        f = greater(f, negated(median_of(w)));
    }
    const vec3 p = along(ray->o, middle, ray->d);
    return cut(f, menger_value(self, p, NULL), 2 * off, fmax(t.hi - middle, middle - t.lo), slope);
}

/* ---------------------------------------------------------- the tetrahedron */

static int levels_of_sierpinski(const sierpinski *s) { return s->iterations ? s->iterations : 5; }

static const double NORMAL = 0.57735026918962576451; /* 1 / sqrt(3) */
static const signed char FACES[4][3] = {{-1, -1, -1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};
static const signed char MIRRORS[3][2] = {{0, 1}, {0, 2}, {1, 2}};

static double sierpinski_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const int n = levels_of_sierpinski(self);
    double x[3] = {p.x, p.y, p.z}, f = -HUGE_VAL, g[3] = {0, 0, 0};
    bool mirrored[3 * 32];
    for (int k = 0; k < n; k++) {
        for (int m = 0; m < 3; m++) {
            const int i = MIRRORS[m][0], j = MIRRORS[m][1];
            const double a = x[i];
            mirrored[3 * k + m] = a + x[j] < 0;
            if (mirrored[3 * k + m]) x[i] = -x[j], x[j] = -a;
        }
        for (int i = 0; i < 3; i++) x[i] = 2 * x[i] - 1;
    }
    for (int k = 0; k < 4; k++) {
        const double form = FACES[k][0] * x[0] + FACES[k][1] * x[1] + FACES[k][2] * x[2] - 1;
        if (!(form > f)) continue;
        f = form;
        for (int i = 0; i < 3; i++) g[i] = FACES[k][i] * NORMAL;
    }
    for (int k = 3 * n; k-- > 0;) /* the gradient goes back through the mirrors */
        if (mirrored[k]) {
            const int i = MIRRORS[k % 3][0], j = MIRRORS[k % 3][1];
            const double a = g[i];
            g[i] = -g[j], g[j] = -a;
        }
    if (grad) *grad = (vec3){g[0], g[1], g[2]};
    return isfinite(p.x + p.y + p.z) ? ldexp(f * NORMAL, -n) : (double)NAN;
}

static double sierpinski_rounding(const void *self, sgt_vec3 p)
{
    return U * (2 * levels_of_sierpinski(self) + 12) * (fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) + 1);
}

static double sierpinski_clearance(const void *self, sgt_vec3 p)
{
    return fabs(sierpinski_value(self, p, NULL)) - sierpinski_rounding(self, p);
}

static sgt_interval sierpinski_enclose(const void *self, const sgt_ray *ray, sgt_interval t,
                                       sgt_interval *slope)
{
    const int n = levels_of_sierpinski(self);
    course x[3], f = {-HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
    double far;
    courses(ray, t, x, &far);
    const double unit = U * (4 * n + 32) * (far + 1), middle = t.lo + 0.5 * (t.hi - t.lo);
    double off = unit; /* of a coordinate, at this level */
    for (int k = 0; k < n; k++, off *= 2) {
        for (int m = 0; m < 3; m++) {
            const int i = MIRRORS[m][0], j = MIRRORS[m][1];
            const course a = x[i], b = x[j], from_b = negated(b), from_a = negated(a);
            if (a.lo + b.lo > 2 * off) continue;
            const bool all = a.hi + b.hi < -2 * off;
            x[i] = all ? from_b : hull(a, from_b), x[j] = all ? from_a : hull(b, from_a);
        }
        for (int i = 0; i < 3; i++)
            x[i] = (course){2 * x[i].lo - 1, 2 * x[i].hi - 1, 2 * x[i].least, 2 * x[i].most};
    }
    for (int k = 0; k < 4; k++) {
        course form = {-1, -1, 0, 0};
        for (int i = 0; i < 3; i++) {
            const course c = FACES[k][i] < 0 ? negated(x[i]) : x[i];
            form = (course){form.lo + c.lo, form.hi + c.hi, form.least + c.least, form.most + c.most};
        }
        form.lo -= 4 * off, form.hi += 4 * off;
        f = greater(f, form);
    }
    const double small = ldexp(NORMAL, -n), more = 8 * U * (fabs(f.least) + fabs(f.most)) * small;
    f = (course){f.lo * small, f.hi * small, f.least * small - more, f.most * small + more};
    const vec3 p = along(ray->o, middle, ray->d);
    return cut(f, sierpinski_value(self, p, NULL), 4 * unit, fmax(t.hi - middle, middle - t.lo), slope);
}

/* ---------------------------------------------------------------- both */

/* Both lie in the cube, and that in the ball of radius sqrt(3). */
static sgt_span folded_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    return own_ball(1.7320508075688774, ray->o, ray->d);
}

const sgt_surface_ops menger_ops = {.name = "menger",
                                    .value = menger_value,
                                    .span = folded_span,
                                    .rounding = menger_rounding,
                                    .clearance = menger_clearance,
                                    .enclose = menger_enclose};
const sgt_surface_ops sierpinski_ops = {.name = "sierpinski",
                                        .value = sierpinski_value,
                                        .span = folded_span,
                                        .rounding = sierpinski_rounding,
                                        .clearance = sierpinski_clearance,
                                        .enclose = sierpinski_enclose};

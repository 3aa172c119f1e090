// SPDX-License-Identifier: MIT
/* torus.c - the torus about z, from a thin hoop to a spindle.
 *
 * With rho = sqrt(x^2 + y^2) the quartic is a product, (x^2 + y^2 + z^2 + R^2 - r^2)^2 - 4 R^2 rho^2 = G
 * H:
 *     G = (rho - R)^2 + z^2 - r^2,     H = (rho + R)^2 + z^2 - r^2 = G + 4 R rho.
 * The quartic as it stands loses a thin hoop in its own rounding.  G does not: rho - R is a difference of
 * two numbers of which only rho is rounded.  So
 *     r <= R:  F = G / 2r, a distance to first order.  H is not below 0 there.
 *     r > R:   F = G H / (8 r R (R + r)).  The inner part of a spindle is where H = 0.  Its gradient is that
 *              of the quartic, smooth on the axis:  4 (x (G + 2 R (rho - R)), y (...), z (G + 2 R rho)).
 *
 * THE ROUNDING.  rho is right to 2 u of itself.  So off = rho - R is right to 2 u rho + u |off|.  G is
 * off^2 + (z^2 - r^2) by fma, with r^2 as two doubles.
 *
 * THE CLEARANCE.  |G| = |d - r| (d + r), where d is the distance from the circle in the middle of the
 * tube.  For a spindle take the nearer of the two circles that a plane through the axis cuts out.
 *
 * ALONG A RAY x + tau d, let h = x dx + y dy, X = x dy - y dx, A = |d|^2, and A_xy that in x and y:
 *     G' / 2 = b = (rho - R) h / rho + z dz,     G'' / 2 = A - R X^2 / rho^3.
 * So G'' <= 2 A everywhere (on the axis the slope falls at once, too).  G'' has a lower bound wherever rho
 * has one.  No root has rho < R - r.  So the stretch of the ray inside that cylinder is skipped, and
 * outside it
 *     G'' / 2 >= kappa = A - R X^2 / rho_least^3,     rho_least = max(R - r, X / sqrt A_xy).
 * Inside the tube rho <= R + r, so
 *     G'' / 2 <= K = A - R X^2 / (R + r)^3.
 * Along a thin tube K is far below A: a ray nearly along it stays inside for long.
 *
 * THE FIRST ROOT after a point where G > 0 is not before the first zero of G + 2 b s + kappa s^2, nor
 * before the clearance.  The search goes there and repeats.  This approaches the root as fast as Newton's
 * method and never passes it.  If that parabola has no zero, and the ray has no other stretch, it is a
 * miss.
 *
 * If b < 0 and 2.5 A G <= b^2, G falls all the way to s = -b / A and is certainly negative on a part of
 * it.  So there is one root, and it is the first.  For a spindle this holds as far as H, which is convex,
 * cannot be 0.  Inside the tube the same holds for -G, with -K in place of kappa and -kappa in place of A.
 *
 * THE SLOPE ABOUT A ROOT.  Such a stretch ends at most halfway to where 2 (b + A s) is 0, and the root is
 * before: it has A s < 0.29 |b|.  So |G'| >= |b| all over it, and where r <= R |F'| >= |b| / 2r.  A root
 * there needs no look beside it.
 *
 * PROOFS rest on this (ray/cells_batch.c): G, b and the bounds on G'' are taken with their errors, and misses
 * are told by the same search.
 *
 * WHY APART.  Nothing else parts the roots of a quartic.  Without `first` and `firsts` the enclosures answer:
 * 6.6 to 18 times the instructions one by one, 17 to 54 times in a batch.  As a user's surface (own_ = NULL
 * besides) it is 2.3 to 3.5 and 5.6 to 11 times (a ring, a hoop and a spindle, 300 rays of a picture each, by
 * callgrind).
 *
 * A START ON THE SURFACE is looked at by itself, and not from the local origin: seen from there, its
 * rounding would be that of R, above the rule's own width near the top of a thin tube, where x Fx and y Fy
 * are 0.  It is on the surface if |G| and its rounding are within 3/4 of the rule (sagitta.h, sgt_ray).  That
 * root is not accepted.
 * The search begins where G is certainly away from 0: outside at b / -2 kappa, where G is above 3 b^2 / -4
 * kappa, inside at -3 b / 2 K, where G is below -3 b^2 / 4 K.
 *
 * STEPS.  Of a million rays in random directions from points of a torus, 18 (R / r = 139), 137 (3) and 1009
 * (1.2) are left without a promise: they nearly touch the inside of the tube, or start where rho is so small
 * that rounding of rho - R is not.  A block of rays makes no more steps than its rays need.  A root that is
 * found is brought near by two steps to the root of the parabola with G, b and G'' at tau.
 *
 * THE ENCLOSURE.  In the middle m of the stretch G and b are known in twice the precision.  Over the
 * stretch rho^2 is a parabola and has an exact range, so G'' has a narrow one:
 *     G in G(m) + 2 b(m) tau + [G''] tau^2 / 2,     b in b(m) + [G''] tau / 2.
 * On long stretches, and near the axis, the formulas of G and b are taken besides: rho' = h / rho never
 * falls.  For a spindle the same is done with H, which has -R in place of R, and the two are multiplied. */
#include "../../solve/ways.h"
#include "quadratic.h"

enum { STEPS = 16 };
static const double LEAST_SLOPE = 0.48; /* THE SLOPE ABOUT A ROOT, over |b| / r */

typedef struct torus_ring { double R, r, r2, r2_lo, half, inverse, k; mask spindle; } torus_ring;

SGT_INLINE torus_ring ring_of(const sgt_torus *s)
{
    twofold r2 = two_product(s->minor, s->minor);
    double R = s->major, r = s->minor;
    return (torus_ring){R, r, r2.hi, r2.lo, 0.5 / r, 1 / r, 1 / (8 * r * R * (R + r)), MASK(r > R)};
}

typedef struct tube { double rho, off, g; } tube;

SGT_INLINE tube tube_at(const torus_ring *s, double x, double y, double z)
{
    double rho = sqrt(x * x + y * y), off = rho - s->R;
    return (tube){rho, off, sgt_fma(off, off, sgt_fma(z, z, -s->r2)) - s->r2_lo};
}

SGT_INLINE double ring_at(const torus_ring *s, double x, double y, double z, double *gx, double *gy,
                          double *gz)
{
    tube p = tube_at(s, x, y, z);
    double by = chosen(MASK(p.rho > 0), p.off * s->inverse / p.rho, 0);
    *gx = x * by, *gy = y * by, *gz = z * s->inverse;
    return p.g * s->half;
}

SGT_INLINE double spindle_at(const torus_ring *s, double x, double y, double z, double *gx, double *gy,
                             double *gz)
{
    tube p = tube_at(s, x, y, z);
    double twice = 2 * s->R, by = 4 * s->k * (p.g + twice * p.off);
    *gx = x * by, *gy = y * by, *gz = z * (4 * s->k * (p.g + twice * p.rho));
    return p.g * (p.g + 2 * twice * p.rho) * s->k;
}

static double torus_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    torus_ring s = ring_of(self);
    sgt_vec3 n;
    double f = s.spindle ? spindle_at(&s, p.x, p.y, p.z, &n.x, &n.y, &n.z)
                         : ring_at(&s, p.x, p.y, p.z, &n.x, &n.y, &n.z);
    if (grad) *grad = n;
    return f;
}

#define TORUS_VALUES(NAME)                                                                 \
    SGT_KERNEL                                                                             \
    static void NAME##_values(const torus_ring *shared, size_t n, sgt_points p, sgt_values out)  \
    {                                                                                      \
        const torus_ring s = *shared;                                                            \
        const double *x = p.p[0], *y = p.p[1], *z = p.p[2];                                \
        double *f = out.f, *gx = out.grad[0], *gy = out.grad[1], *gz = out.grad[2];        \
        if (gx) {                                                                          \
            LANES for (size_t i = 0; i < n; i++)                                           \
            {                                                                              \
                double nx, ny, nz, value = NAME##_at(&s, x[i], y[i], z[i], &nx, &ny, &nz); \
                f[i] = value, gx[i] = nx, gy[i] = ny, gz[i] = nz;                          \
            }                                                                              \
        } else {                                                                           \
            LANES for (size_t i = 0; i < n; i++)                                           \
            {                                                                              \
                double nx, ny, nz;                                                         \
                f[i] = NAME##_at(&s, x[i], y[i], z[i], &nx, &ny, &nz);                     \
            }                                                                              \
        }                                                                                  \
    }

TORUS_VALUES(ring)
TORUS_VALUES(spindle)

static void torus_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    torus_ring s = ring_of(self);
    if (s.spindle) spindle_values(&s, n, p, out);
    else ring_values(&s, n, p, out);
}

/* The rounding of G. */
SGT_INLINE double tube_rounding(const torus_ring *s, const tube *p, double z)
{
    double off = SGT_U * (2 * p->rho + fabs(p->off));
    return (2 * fabs(p->off) + off) * off + SGT_U * (fabs(z * z - s->r2) + 2 * fabs(p->g)) +
           0x1p-100 * (z * z + s->r2);
}

SGT_INLINE double ring_rounding(const torus_ring *s, double x, double y, double z)
{
    tube at = tube_at(s, x, y, z);
    return 1.01 * s->half * (tube_rounding(s, &at, z) + 2 * SGT_U * fabs(at.g)) + 0x1p-1060;
}

SGT_INLINE double spindle_rounding(const torus_ring *s, double x, double y, double z)
{
    tube at = tube_at(s, x, y, z);
    double g = fabs(at.g), g_err = tube_rounding(s, &at, z), far = 4 * s->R * at.rho, h = fabs(at.g + far),
           h_err = g_err + SGT_U * (3 * far + h);
    return 1.01 * s->k * (g * h_err + (h + h_err) * g_err + 8 * SGT_U * g * h) + 0x1p-1060;
}

static double torus_rounding(const void *self, sgt_vec3 p)
{
    torus_ring s = ring_of(self);
    return s.spindle ? spindle_rounding(&s, p.x, p.y, p.z) : ring_rounding(&s, p.x, p.y, p.z);
}

SGT_KERNEL
static bool torus_roundings(const void *self, const sgt_shared *shared, size_t n, sgt_points p,
                            const double f[], double out[])
{
    const torus_ring s = ring_of(self);
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2];
    (void)f, (void)shared;
    if (s.spindle) {
        LANES for (size_t i = 0; i < n; i++) out[i] = spindle_rounding(&s, x[i], y[i], z[i]);
    } else {
        LANES for (size_t i = 0; i < n; i++) out[i] = ring_rounding(&s, x[i], y[i], z[i]);
    }
    return true;
}

static double torus_clearance(const void *self, sgt_vec3 p)
{
    torus_ring s = ring_of(self);
    double rho = sqrt(p.x * p.x + p.y * p.y), near = sqrt((rho - s.R) * (rho - s.R) + p.z * p.z),
           far = sqrt((rho + s.R) * (rho + s.R) + p.z * p.z);
    double one = fabs(near - s.r), other = s.spindle ? fabs(far - s.r) : one;
    return (one < other ? one : other) - 8 * SGT_U * (rho + fabs(p.z) + s.R + s.r);
}

SGT_KERNEL
static bool torus_values_rounded(const void *self, const sgt_shared *shared, const double *const rows[3],
                                 size_t n, sgt_points p, sgt_values out, double own[])
{
    const torus_ring s = ring_of(self);
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2];
    double *f = out.f, *gx = out.grad[0], *gy = out.grad[1], *gz = out.grad[2];
    (void)shared, (void)rows;
    if (s.spindle) {
        LANES for (size_t i = 0; i < n; i++) {
            double nx, ny, nz, value = spindle_at(&s, x[i], y[i], z[i], &nx, &ny, &nz);
            f[i] = value, gx[i] = nx, gy[i] = ny, gz[i] = nz;
            own[i] = spindle_rounding(&s, x[i], y[i], z[i]);
        }
    } else {
        LANES for (size_t i = 0; i < n; i++) {
            double nx, ny, nz, value = ring_at(&s, x[i], y[i], z[i], &nx, &ny, &nz);
            f[i] = value, gx[i] = nx, gy[i] = ny, gz[i] = nz;
            own[i] = ring_rounding(&s, x[i], y[i], z[i]);
        }
    }
    return true;
}

/* ------------------------------------------------------------------ the first root */

enum { BLOCK = DEPARTURE_BLOCK / 2 }; /* its rows are many, and the stack is small */
typedef double row[BLOCK];

/* The state of n rays in the search.
 *
 *   seek  1 as long as a root is sought
 *   left  steps left to bring tau nearer to a root that was found
 *   none  1: there is no root
 *   met   1: there is a root, the only one in [from, to]
 *
 * When seek and left are 0, nothing changes any more.  So the result does not depend on how many rays go
 * together.  (Each has a row of its own: from conditions on one number gcc makes branches.) */
typedef struct torus_parting {
    row x, y, z, l, m, n, t0, scale;
    row lo, hi, enter, leave;    /* no root is outside [lo, hi], nor between enter and leave */
    row kappa, inside;           /* bounds on G'' / 2: from below, and from above inside the tube */
    row start, at;               /* tmin; a margin about it for rounding, by its magnitude */
    row tau, side, from, to, seek, left, none, met;
    row ease;                    /* at `from`, of a root that was found: a lower bound on |G'| / 2 */
    row g, b, bend, g_err, b_err, radius, one; /* of one step: at tau, with the signs of `side` */
} torus_parting;

typedef struct torus_look { tube at; double b, g_err, b_err, terms; } torus_look;

/* At a point of the ray, whose coordinates are off by u of ex, ey and ez. */
SGT_INLINE torus_look torus_look_of(const torus_ring *s, sgt_vec3 p, double l, double m, double n, double ex,
                                    double ey, double ez)
{
    torus_look e;
    double x = p.x, y = p.y, z = p.z;
    e.at = tube_at(s, x, y, z);
    double turn = e.at.off / e.at.rho, gx = fabs(turn * x), gy = fabs(turn * y), gz = fabs(z);
    double ax = fabs(l), ay = fabs(m), az = fabs(n);
    e.b = turn * (x * l + y * m) + z * n;
    e.terms = 2 * (gx * fabs(x) + gy * fabs(y) + gz * fabs(z));
    e.g_err = 1.01 * (2 * SGT_U * (ex * gx + ey * gy + ez * gz) + tube_rounding(s, &e.at, z)) +
              0x1p-90 * (e.at.rho * e.at.rho + z * z);
    /* off / rho changes by R / rho^2 times the change of rho, a direction by 1 / rho. */
    double rough = (ex * ax + ey * ay) * (1 + s->R / e.at.rho) + (e.at.rho + s->R) * (ax + ay);
    e.b_err = 8 * SGT_U * (rough + ez * az);
    return e;
}

SGT_INLINE torus_look torus_look_at(const torus_ring *s, const torus_parting *c, size_t i, double tau)
{
    double l = c->l[i], m = c->m[i], n = c->n[i], x = c->x[i] + tau * l, y = c->y[i] + tau * m,
           z = c->z[i] + tau * n;
    return torus_look_of(s, (sgt_vec3){x, y, z}, l, m, n, fabs(c->x[i]) + fabs(tau * l) + fabs(x),
                         fabs(c->y[i]) + fabs(tau * m) + fabs(y), fabs(c->z[i]) + fabs(tau * n) + fabs(z));
}

SGT_INLINE void parting_begin(const torus_ring *s, torus_parting *c, size_t i, sgt_vec3 o, sgt_vec3 d,
                             double tmin)
{
    near_ray r = near_ray_of(d);
    double l = r.d.x, m = r.d.y, n = r.d.z, a = l * l + m * m, A = a + n * n, R = s->R;
    near_ray_at(&r, o, -(o.x * l + o.y * m + o.z * n) / A);
    double x = r.x.x, y = r.x.y, z = r.x.z, p = x * x + y * y, h = x * l + y * m, b = h + z * n,
           middle = -b / A;

    /* The ball and the slab about the torus.  t can be told to u |t0|. */
    double ball = (R + s->r) * (1 + 0x1p-20), thick = s->r * (1 + 0x1p-10) + 0x1p-44 * R,
           inside = b * b - A * ((p + z * z) - ball * ball);
    double reach = sqrt(inside > 0 ? inside : 0) / A, below = (-thick - z) / n, above = (thick - z) / n;
    mask level = MASK(n == 0), gone = MASK(inside < -0x1p-40 * A * ball * ball) |
                                      (level & MASK(fabs(z) > thick)) | MASK(!(p < HUGE_VAL));
    double enters = chosen(level, -HUGE_VAL, below < above ? below : above),
           leaves = chosen(level, HUGE_VAL, below < above ? above : below);
    double lo = larger(middle - reach, enters), hi = middle + reach < leaves ? middle + reach : leaves;
    double more = 0x1p-50 * fabs(r.t0) + 0x1p-20 * reach;
    gone |= MASK(lo > hi + 2 * more);
    lo -= more, hi += more;

    /* The cylinder in the hole. */
    double cross = fabs(x * m - y * l), off = 8 * SGT_U * (fabs(x * m) + fabs(y * l)),
           q = (R - s->r) * (1 - 0x1p-20), room = a * q * q - cross * cross;
    mask hole = MASK(R - s->r > 0x1p-10 * R), along = MASK(a < 0x1p-100),
         through = hole & MASK(room > 0) & ~along, in = hole & along & MASK(p < q * q);
    double wide = sqrt(room > 0 ? room : 0) / a;
    c->enter[i] = chosen(in, -HUGE_VAL, chosen(through, -h / a - wide, HUGE_VAL)),
    c->leave[i] = chosen(in | ~through, HUGE_VAL, -h / a + wide);
    double closest = (cross - off) / sqrt(a) * (1 - 0x1p-40),
           least = chosen(hole & MASK(q > closest), q, closest), X = cross + off,
           cube = least * least * least, bend = R * X * X / cube;
    c->kappa[i] = chosen(MASK(cube > 0x1p-1000), (A - bend) - 0x1p-40 * (A + bend), -HUGE_VAL);
    double outer = R + s->r, far = larger(cross - off, 0),
           bound = A * (1 + 0x1p-40) - R * far * far / (outer * outer * outer) * (1 - 0x1p-40);
    bound = larger(bound, 0x1p-20 * A), c->inside[i] = bound;

    double from = tmin * r.inverse;
    twofold start = two_sum(from, -r.t0);
    mask endless = MASK(from == -HUGE_VAL);
    c->start[i] = chosen(endless, -HUGE_VAL, start.hi),
    c->at[i] = chosen(endless, 0, 32 * fabs(start.lo) + 0x1p-45 * fabs(from));
    c->x[i] = x, c->y[i] = y, c->z[i] = z, c->l[i] = l, c->m[i] = m, c->n[i] = n, c->t0[i] = r.t0,
    c->scale[i] = r.scale;
    c->lo[i] = lo, c->hi[i] = hi;
    double tau = chosen(endless | MASK(start.hi < lo), lo, start.hi);
    tau = chosen(MASK(tau > c->enter[i]) & MASK(tau < c->leave[i]), c->leave[i], tau);
    gone |= MASK(tau > hi);

    /* Is the start inside, outside, or on the surface?  If on it, begin past it. */
    c->tau[i] = tau;
    mask exact = MASK(tau == start.hi);
    sgt_vec3 at = {chosen(exact, moved_along(o.x, from, l), x + tau * l),
                  chosen(exact, moved_along(o.y, from, m), y + tau * m),
                  chosen(exact, moved_along(o.z, from, n), z + tau * n)};
    double ex = fabs(at.x), ey = fabs(at.y), ez = fabs(at.z);
    torus_look e = torus_look_of(s, at, l, m, n, ex + chosen(exact, 0, fabs(x) + fabs(tau * l)),
                                 ey + chosen(exact, 0, fabs(y) + fabs(tau * m)),
                                 ez + chosen(exact, 0, fabs(z) + fabs(tau * n)));
    double kappa = c->kappa[i];
    mask on = ~endless & exact & MASK(fabs(e.at.g) + 2 * e.g_err <= 0.75 * START_ULPS * e.terms);
    mask out = (on & MASK(e.b > 16 * e.b_err)) | (~on & MASK(e.at.g > 4 * e.g_err)),
         deep = (on & MASK(e.b < -16 * e.b_err)) | (~on & MASK(e.at.g < -4 * e.g_err));
    double turn = chosen(out, chosen(MASK(kappa < 0), 0.5 * e.b / -kappa, HUGE_VAL), 1.5 * -e.b / bound),
           past = tau + chosen(on, turn, 0);
    past = chosen(on & out & MASK(tau < c->enter[i]) & MASK(past > c->enter[i]), c->leave[i], past);
    gone |= on & out & MASK(past > hi);
    c->tau[i] = past, c->side[i] = chosen(deep, -1, 1);
    c->seek[i] = chosen((out | deep) & ~gone, 1, 0), c->none[i] = chosen(gone, 1, 0),
    c->left[i] = c->met[i] = c->ease[i] = 0;
    c->from[i] = lo, c->to[i] = hi;
}

/* Is there one root, and is it not the start? */
SGT_INLINE void parting_judge(const torus_ring *s, torus_parting *c, size_t i)
{
    double tau = c->tau[i], side = c->side[i], l = c->l[i], m = c->m[i], n = c->n[i], a = l * l + m * m;
    torus_look e = torus_look_at(s, c, i, tau);
    double g = side * e.at.g, b = side * e.b, over = chosen(MASK(side > 0), a + n * n, -c->kappa[i]);
    double ease = -b - 4 * e.b_err, most = larger(over, 0.4 * b * b / g), way = 0.5 * ease / most,
           width = START_ULPS * e.terms / -b;
    way = chosen(MASK(side < 0) & MASK(tau + way > c->enter[i]) & MASK(tau < c->enter[i]), c->enter[i] - tau,
                 way);
    /* For a spindle: only as far as the inner part is certainly away.  (H is convex, and not below its
     * tangent.) */
    double inner = e.at.g + 4 * s->R * e.at.rho,
           nearer = -2 * (e.b + 2 * s->R * (c->x[i] * l + c->y[i] * m + tau * a) / e.at.rho);
    double apart = chosen(MASK(nearer > 0), 0.75 * inner / nearer, HUGE_VAL),
           clear = chosen(MASK(side > 0) & MASK(inner > 64 * e.g_err), apart, 0);
    apart = chosen(s->spindle, clear, HUGE_VAL);
    way = apart < way ? apart : way;
    double start = chosen(MASK(c->start[i] == -HUGE_VAL), HUGE_VAL, (tau - c->start[i]) + 0.25 * g / -b);
    mask one = MASK(1.2 * g + way * (over * way - 2 * ease) < 0) & MASK(g > 64 * e.g_err) &
               MASK(ease > 0.9 * -b) & MASK(over * g <= 0.4 * b * b) & MASK(way > 0x1p-46 * fabs(c->t0[i])) &
               MASK(start > 16 * width + c->at[i]);
    double X = c->x[i] * m - c->y[i] * l, rho = e.at.rho;
    c->bend[i] = side * ((a + n * n) - s->R * (X * X) / (rho * rho * rho));
    c->g[i] = g, c->b[i] = b, c->g_err[i] = e.g_err, c->b_err[i] = e.b_err,
    c->radius[i] = sqrt(larger(s->r2 + e.at.g, 0)) + s->r;
    c->from[i] = chosen(one & MASK(c->seek[i] > 0), tau, c->from[i]),
    c->to[i] = chosen(one & MASK(c->seek[i] > 0), tau + way, c->to[i]);
    c->ease[i] = chosen(one & MASK(c->seek[i] > 0), ease, c->ease[i]);
    c->one[i] = chosen(one, c->seek[i], 0);
}

/* Moves to a point with no root before it.  If the root is found, moves to that of the parabola with g, its
 * slope and its bend at tau. */
SGT_INLINE void parting_move(torus_parting *c, size_t i)
{
    double tau = c->tau[i], side = c->side[i], l = c->l[i], m = c->m[i], n = c->n[i],
           A = (l * l + m * m) + n * n, g = c->g[i], b = c->b[i];
    double under = chosen(MASK(side > 0), c->kappa[i], -c->inside[i]), low = g - 2 * c->g_err[i],
           fall = -b + 2 * c->b_err[i], root = fall * fall - under * low;
    double ahead = fall + sqrt(larger(root, 0)), clear = low / (c->radius[i] * sqrt(A)), step = low / ahead;
    step = chosen(MASK(root >= 0) & MASK(ahead > 0), step, HUGE_VAL);
    step = larger(step, clear) * (1 - 0x1p-20);
    double level = b * b - c->bend[i] * g, newton = tau + g / (sqrt(larger(level, 0)) - b),
           next = tau + step,
           sure = chosen(MASK(g > 4 * c->g_err[i]), c->seek[i], 0), one = c->one[i],
           left = larger(c->left[i], one);
    next = chosen(MASK(side > 0) & MASK(tau < c->enter[i]) & MASK(next > c->enter[i]), c->leave[i], next);
    /* from where G is nearly at its extreme (a start on the far side of the tube) it steps over the root */
    newton = chosen(MASK(newton >= c->to[i]), 0.5 * c->from[i] + 0.5 * c->to[i], newton);
    newton = chosen(MASK(newton > c->from[i]) & MASK(newton < c->to[i]), newton, tau);
    double none = chosen(MASK(side > 0) & MASK(next > c->hi[i]), sure - one, 0);
    next = chosen(MASK(next <= c->hi[i]), next, tau);
    next = chosen(MASK(sure > 0), next, tau);
    c->tau[i] = chosen(MASK(left > 0), newton, next);
    c->left[i] = larger(chosen(MASK(one > 0), 2, left) - 1, 0), c->seek[i] = sure - one - none;
    c->none[i] += none, c->met[i] += one;
}

SGT_KERNEL
static void torus_begin(const torus_ring *shared, torus_parting *c, size_t n, const double *const o[3],
                        const double *const d[3], const double *tmin)
{
    const torus_ring s = *shared;
    const double *ox = o[0], *oy = o[1], *oz = o[2], *dx = d[0], *dy = d[1], *dz = d[2];
    LANES for (size_t i = 0; i < n; i++)
        parting_begin(&s, c, i, (sgt_vec3){ox[i], oy[i], oz[i]}, (sgt_vec3){dx[i], dy[i], dz[i]}, tmin[i]);
}

SGT_KERNEL
static void torus_judge(const torus_ring *shared, torus_parting *c, size_t n)
{
    const torus_ring s = *shared;
    LANES for (size_t i = 0; i < n; i++) parting_judge(&s, c, i);
}

SGT_KERNEL
static void move(torus_parting *c, size_t n)
{
    LANES for (size_t i = 0; i < n; i++) parting_move(c, i);
}

/* 0 if all rays have finished. */
SGT_KERNEL
static double unfinished(const torus_parting *c, size_t n)
{
    double more = 0;
    _Pragma("omp simd reduction(+ : more)") for (size_t i = 0; i < n; i++) more += c->seek[i] + c->left[i];
    return more;
}

/* The span, with its seed. */
SGT_KERNEL
static void end_spans(const torus_parting *c, size_t n, double *lo, double *hi, double *seed, bool *is_single)
{
    LANES for (size_t i = 0; i < n; i++) {
        mask none = MASK(c->none[i] > 0);
        double t0 = c->t0[i], scale = c->scale[i], from = c->lo[i], to = c->hi[i];
        double below = (t0 + from) - 0x1p-51 * (fabs(t0) + fabs(from)), above = t0 + to;
        lo[i] = chosen(none, 1.0, below * scale), hi[i] = chosen(none, -1.0, above * scale);
        seed[i] = chosen(none, (double)NAN, (t0 + c->tau[i]) * scale), is_single[i] = none != 0;
    }
}

/* The same, and [from, to] where a root was found, with the bound on the slope. */
SGT_KERNEL
static void end_firsts(const torus_parting *c, double least, size_t n, double *restrict lo,
                       double *restrict hi, double *restrict seed, double *restrict steep,
                       double *restrict is_single)
{
    LANES for (size_t i = 0; i < n; i++) {
        mask none = MASK(c->none[i] > 0), found = MASK(c->met[i] > 0);
        double t0 = c->t0[i], scale = c->scale[i], from = chosen(found, c->from[i], c->lo[i]),
               to = chosen(found, c->to[i], c->hi[i]);
        double below = (t0 + from) - 0x1p-51 * (fabs(t0) + fabs(from)), above = t0 + to;
        lo[i] = chosen(none, 1.0, below * scale), hi[i] = chosen(none, -1.0, above * scale);
        seed[i] = chosen(none, (double)NAN, (t0 + c->tau[i]) * scale);
        is_single[i] = chosen(none | found, 1, 0);
        steep[i] = chosen(found & ~none & MASK(to - from > 0x1p-40 * fabs(t0)), c->ease[i] * least, 0);
    }
}

/* Do cubes of these lengths (a spindle: fourth powers), and squares with what is lost in them, stay in the
 * range of doubles?  If they do not the search tells nothing, neither a root nor that there is none. */
static bool in_range(const torus_ring *s)
{
    const double most = s->spindle ? 0x1p240 : 0x1p330;
    return s->R + s->r < most && larger(s->R, s->r) > 1 / most && s->r > 0x1p-450 && s->R > 0x1p-450;
}

static void torus_search(const void *self, size_t n, sgt_rays rays, bool first, sgt_spans out, double steep[])
{
    torus_ring s = ring_of(self);
    torus_parting c;
    row whole, unread, single;
    WENT(WAY_PARTED);
    const double least = s.spindle ? 0 : LEAST_SLOPE * s.inverse;
    const bool outside = !in_range(&s);
    for (size_t i = 0; i < BLOCK; i++) whole[i] = -HUGE_VAL;
    for (size_t at = 0, few; at < n; at += few) {
        few = n - at < BLOCK ? n - at : BLOCK;
        const double *const o[3] = {rays.o[0] + at, rays.o[1] + at, rays.o[2] + at}, *const d[3] = {
                                                                                         rays.d[0] + at,
                                                                                         rays.d[1] + at,
                                                                                         rays.d[2] + at};
        torus_begin(&s, &c, few, o, d, first ? rays.tmin + at : whole);
        for (int i = 0; i < STEPS && unfinished(&c, few) > 0; i++) torus_judge(&s, &c, few), move(&c, few);
        double *own = steep ? steep + at : unread;
        if (first) end_firsts(&c, least, few, out.lo + at, out.hi + at, out.seed + at, own, single);
        for (size_t i = 0; i < few && first; i++) out.single[at + i] = single[i] > 0;
        if (!first) end_spans(&c, few, out.lo + at, out.hi + at, out.seed + at, out.single + at);
        for (size_t i = 0; i < few; i++) /* if d is this long, the ends may underflow in lengths of d */
            if (outside || (!(c.scale[i] * (s.R + s.r) > 0x1p-900) && out.lo[at + i] <= out.hi[at + i]))
                out.lo[at + i] = -HUGE_VAL, out.hi[at + i] = HUGE_VAL, out.single[at + i] = false, own[i] = 0;
    }
}

static void torus_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    torus_search(self, n, rays, false, out, NULL);
}
static void torus_firsts(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    torus_search(self, n, rays, true, out, NULL);
}
static void torus_steep_firsts(const void *self, size_t n, sgt_rays rays, sgt_spans out, double steep[])
{
    torus_search(self, n, rays, true, out, steep);
}

static sgt_span unique(const void *self, const sgt_ray *ray, bool first, double *steep)
{
    sgt_span a;
    torus_search(self, 1, rays_of(ray), first, (sgt_spans){&a.lo, &a.hi, &a.seed, &a.single}, steep);
    return a;
}

static sgt_span torus_span(const void *self, const sgt_ray *ray) { return unique(self, ray, false, NULL); }
static sgt_span torus_first(const void *self, const sgt_ray *ray) { return unique(self, ray, true, NULL); }
static sgt_span torus_steep_first(const void *self, const sgt_ray *ray, double *steep)
{
    return unique(self, ray, true, steep);
}

/* ------------------------------------------------------------------ by intervals */

/* G (for -R: H) and half its slope over a stretch with these ranges of rho, h and z.  The length of d in x
 * and y is at most `steep`. */
typedef struct stretch_of { sgt_interval g, b; } stretch_of;

static stretch_of natural(double R, double r, sgt_interval rho, sgt_interval h, sgt_interval z, double n,
                          sgt_interval steep)
{
    sgt_interval off = sgt_interval_difference(rho, sgt_interval_of(R)),
                 outward = rho.lo > 0 ? sgt_interval_quotient(h, rho) : sgt_interval_all();
    outward = sgt_interval_intersection(outward, sgt_interval_hull(sgt_interval_negative(steep), steep));
    return (stretch_of){
        sgt_interval_difference(sgt_interval_sum(sgt_interval_square(off), sgt_interval_square(z)),
                                sgt_interval_square(sgt_interval_of(r))),
        sgt_interval_sum(sgt_interval_product(off, outward), sgt_interval_scaled(z, n))};
}

/* What G and H share on a stretch. */
typedef struct view {
    fine_ray r;
    twofold rho, h, ratio;
    sgt_interval all_rho, all_h, all_z, steep, a, cross;
    double length;
} view;

static view view_of(const fine_ray *r)
{
    view v = {.r = *r};
    twofold xl = twofold_scaled(r->x, r->l), ym = twofold_scaled(r->y, r->m), xm = twofold_scaled(r->x, r->m),
            yl = twofold_scaled(r->y, r->l);
    twofold l2 = two_product(r->l, r->l), m2 = two_product(r->m, r->m), a = twofold_sum(l2, m2),
            X = twofold_difference(xm, yl);
    fine_parabola p = {a, twofold_sum(xl, ym),
                       twofold_sum(twofold_product(r->x, r->x), twofold_product(r->y, r->y)), a.hi,
                       fabs(xl.hi) + fabs(ym.hi) + 0x1p-700, 0};
    sgt_interval square, slope, A = fine_interval(a, FINE_COEFFICIENT * a.hi);
    p.Ca = p.C.hi + 0x1p-700;
    square = fine_enclose(&p, r, &slope);
    v.cross = sgt_interval_absolute(
        fine_interval(X, FINE_COEFFICIENT * (fabs(xm.hi) + fabs(yl.hi)) + 0x1p-700));
    v.all_rho = sgt_interval_square_root(sgt_interval_between(larger(square.lo, 0), square.hi));
    v.rho = twofold_root(p.C), v.h = p.B, v.length = p.Ba;
    v.ratio = v.rho.hi > 0 ? twofold_quotient(p.B, v.rho) : twofold_of(0);
    v.all_h = sgt_interval_sum(fine_interval(p.B, FINE_COEFFICIENT * p.Ba), sgt_interval_product(A, r->tau));
    v.all_z = sgt_interval_sum(fine_interval(r->z, FINE_COEFFICIENT * fabs(r->z.hi)),
                               sgt_interval_scaled(r->tau, r->n));
    v.steep = sgt_interval_square_root(A);
    v.a = sgt_interval_sum(A, sgt_interval_square(sgt_interval_of(r->n)));
    return v;
}

static stretch_of about_middle(const view *v, double R, double r)
{
    stretch_of e = natural(R, r, v->all_rho, v->all_h, v->all_z, v->r.n, v->steep);
    if (!(v->all_rho.lo > 0x1p-300)) return e;
    twofold off = twofold_difference(v->rho, twofold_of(R)), z = v->r.z, r2 = two_product(r, r),
            zn = twofold_scaled(z, v->r.n), turn = twofold_product(off, v->ratio);
    twofold g = twofold_sum(twofold_product(off, off), twofold_difference(twofold_product(z, z), r2));
    double rho = v->rho.hi, size = fabs(R), o = fabs(off.hi), near = FINE_COEFFICIENT * (rho + size);
    double g_err = (2 * o + near) * near + FINE_COEFFICIENT * (o * o + z.hi * z.hi + r2.hi),
           b_err = near * (v->length / rho) + FINE_COEFFICIENT * (2 * o * (v->length / rho) + fabs(zn.hi));
    sgt_interval tau = v->r.tau, lo = sgt_interval_of(tau.lo), hi = sgt_interval_of(tau.hi),
                 G = fine_interval(g, g_err), b = fine_interval(twofold_sum(turn, zn), b_err);
    sgt_interval bend = sgt_interval_quotient(
        sgt_interval_scaled(sgt_interval_square(v->cross), R),
        sgt_interval_product(sgt_interval_square(v->all_rho), v->all_rho));
    bend = sgt_interval_difference(v->a, bend);
    sgt_interval twice = sgt_interval_scaled(b, 2),
                 slope = sgt_interval_sum(b, sgt_interval_product(bend, tau));
    e.b = sgt_interval_intersection(e.b, slope);
    sgt_interval all = sgt_interval_sum(
        G, sgt_interval_product(tau, sgt_interval_sum(twice, sgt_interval_product(bend, tau))));
    if (e.b.lo >= 0 || e.b.hi <= 0)
        all = sgt_interval_hull(
            sgt_interval_sum(
                G, sgt_interval_product(lo, sgt_interval_sum(twice, sgt_interval_product(bend, lo)))),
            sgt_interval_sum(
                G, sgt_interval_product(hi, sgt_interval_sum(twice, sgt_interval_product(bend, hi)))));
    e.g = sgt_interval_intersection(e.g, all);
    return e;
}

SGT_NARROW(sgt_interval, sgt_torus_enclose_from,
           (const void *self, const sgt_ray *ray, double t0, sgt_interval t,
            sgt_interval *slope))
{
    const sgt_torus *s = self;
    double R = s->major, r = s->minor, by = 1;
    bool spindle = r > R;
    sgt_interval g;
    stretch_of near, far = {.g = {1, 1}, .b = {0, 0}};
    fine_ray fine;
    if (!stretch_valid(ray, t, &g, slope)) return g;
    if (fine_ray_of(ray, t0, t, &fine) && R > 0x1p-300 && R < 0x1p300 && r > 0x1p-300 && r < 0x1p300) {
        view v = view_of(&fine);
        near = about_middle(&v, R, r);
        if (spindle) far = about_middle(&v, -R, r);
        by = fine.inverse;
    } else {
        sgt_interval x = plain_line(ray->o.x, ray->d.x, t0, t), y = plain_line(ray->o.y, ray->d.y, t0, t),
                     z = plain_line(ray->o.z, ray->d.z, t0, t);
        sgt_interval rho = sgt_interval_square_root(
                         sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y))),
                     h = sgt_interval_sum(sgt_interval_scaled(x, ray->d.x), sgt_interval_scaled(y, ray->d.y));
        sgt_interval steep = sgt_interval_square_root(sgt_interval_sum(
            sgt_interval_square(sgt_interval_of(ray->d.x)), sgt_interval_square(sgt_interval_of(ray->d.y))));
        near = natural(R, r, rho, h, z, ray->d.z, steep);
        if (spindle) far = natural(-R, r, rho, h, z, ray->d.z, steep);
    }
    sgt_interval minor = sgt_interval_of(r), middle = sgt_interval_of(R);
    if (!spindle) {
        *slope = sgt_interval_scaled(sgt_interval_quotient(near.b, minor), by);
        return sgt_interval_quotient(near.g, sgt_interval_scaled(minor, 2));
    }
    sgt_interval k = sgt_interval_product(sgt_interval_product(sgt_interval_scaled(minor, 4), middle),
                                          sgt_interval_sum(middle, minor));
    g = sgt_interval_product(near.g, far.g);
    *slope = sgt_interval_sum(sgt_interval_product(near.b, far.g), sgt_interval_product(near.g, far.b));
    *slope = sgt_interval_scaled(sgt_interval_quotient(*slope, k), by);
    return sgt_interval_quotient(g, sgt_interval_scaled(k, 2));
}

static sgt_interval torus_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    return sgt_torus_enclose_from(self, ray, 0, t, slope);
}

/* ------------------------------------------------------------------- cells in lanes
 *
 * The same for many cells at once, for proofs (sgt_builtin_ops.encloses): quadratic.h has the ray about the
 * middle of a cell, in units of the scaled direction, and the unit u of its bounds, LANE_ROUNDING.  At the
 * middle rho, h, z, X, G and b are known in twice the precision, as above.  Let w be the greater |tau|, and S
 * the length of d in x and y.
 *
 * RHO is convex along the ray, and rho' = h / rho.  So over the cell (tau has 0 in it)
 *     rho >= rho(m) + rho' tau at an end (the tangent),   rho >= X / S,
 *     rho <= sqrt(rho(m)^2 + w (2 |h| + S^2 w)),          |rho'| <= S.
 * rho'' = X^2 / rho^3 lies in [curl_lo, curl_hi], from these bounds.  (X / rho is at most S, so its square
 * does not overflow.)  Where the least rho is not above 2^-200 nothing is known of rho''.
 * Else rho' is in rho'(m) + curl_hi [tau_lo, tau_hi], and G'' / 2 in A - R [curl_lo, curl_hi].
 *
 * G AND b by that: b in b(m) + bend tau, and G - G(m) is between the parabolas tau (2 b(m) + bend tau) with
 * either end of bend (lane_least).  Besides, G in (rho - R)^2 + z^2 - r^2 and b in (rho - R) rho' + z dz, by
 * intervals.  H is G with -R for R, and A + R [curl] for its bend.
 *
 * ROUNDING.  rho(m), rho'(m) and S are right to 4 u of themselves, or rho'(m) to 2^-90 S.  The tangent is
 * lowered by 16 u (rho(m) + S w); the greatest rho and X / S are moved by 16 u of themselves, and curl by 64
 * u.  The other sums are treated as in lane_parabola. */
typedef struct fine_tube {
    double R, half, k;
    twofold r2;
    two_ends square; /* r^2 */
    mask known;
} fine_tube;

static fine_tube fine_tube_of(const sgt_torus *s)
{
    torus_ring ring = ring_of(s);
    return (fine_tube){s->major, ring.half, ring.k, two_product(s->minor, s->minor),
                       ends_square(ends_of(s->minor, s->minor)),
                       MASK(s->major > 0x1p-150) & MASK(s->major < 0x1p150) & MASK(s->minor > 0x1p-150) &
                           MASK(s->minor < 0x1p150)};
}

/* What G and H share on a cell; numbers of a single precision but for what is known at the middle. */
typedef struct lane_view {
    twofold rho, ratio, z, zn;
    double length, n, A, lo, hi, w;
    two_ends all_rho, turn, curl, all_z;
    double unknown; /* NaN where nothing is known of rho'', else 0 */
} lane_view;

/* Of a sum of squares: 0, or above 2^-800. */
SGT_INLINE twofold lane_root(twofold a)
{
    double s = sqrt(a.hi);
    twofold r = twofold_difference(a, two_product(s, s));
    return quick_two_sum(s, r.hi / larger(2 * s, 0x1p-800));
}

SGT_INLINE void lane_view_of(const fine_ray *r, lane_view *v)
{
    twofold xl = twofold_scaled(r->x, r->l), ym = twofold_scaled(r->y, r->m), xm = twofold_scaled(r->x, r->m),
            yl = twofold_scaled(r->y, r->l), h = twofold_sum(xl, ym), X = twofold_difference(xm, yl),
            square = twofold_sum(twofold_product(r->x, r->x), twofold_product(r->y, r->y));
    double lo = r->tau.lo, hi = r->tau.hi, w = greater_of(-lo, hi), S2 = r->l * r->l + r->m * r->m,
           S = sqrt(S2);
    v->length = fabs(xl.hi) + fabs(ym.hi) + 0x1p-700;
    v->rho = lane_root(square), v->z = r->z, v->n = r->n, v->zn = twofold_scaled(r->z, r->n);
    twofold rho_or_more = {larger(v->rho.hi, 0x1p-800), v->rho.lo};
    v->ratio = twofold_quotient(h, rho_or_more); /* 0 on the axis */
    double rho = v->rho.hi, slope = v->ratio.hi, blur = LANE_ROUNDING * (rho + S * w),
           tangent = rho + lesser_of(slope * lo, slope * hi) - blur;
    double away = fabs(X.hi), away_err = FINE_COEFFICIENT * (fabs(xm.hi) + fabs(yl.hi)) + 0x1p-700,
           nearest = (away * (1 - LANE_ROUNDING) - away_err) / S * (1 - LANE_ROUNDING), /* NaN if S is 0 */
           least = greater_of(larger(nearest, tangent), 0),
           most = sqrt(square.hi + w * (2 * fabs(h.hi) + S2 * w));
    v->all_rho = ends_of(least, most * (1 + LANE_ROUNDING) + 0x1p-500);
    double q = (away * (1 + LANE_ROUNDING) + away_err) / least,
           p = larger(away * (1 - LANE_ROUNDING) - away_err, 0) / v->all_rho.hi,
           curled = q * q / least * (1 + 4 * LANE_ROUNDING);
    v->curl = ends_of(p * p / v->all_rho.hi * (1 - 4 * LANE_ROUNDING), curled);
    v->unknown = (least > 0x1p-200 ? 0 : (double)NAN) + ends_unknown(curled);
    double turned = LANE_ROUNDING * fabs(slope) + 0x1p-80 * S, bound = S * (1 + LANE_ROUNDING);
    double from = slope + curled * lo * (1 + LANE_ROUNDING) - turned + v->unknown,
           to = slope + curled * hi * (1 + LANE_ROUNDING) + turned + v->unknown;
    v->turn.lo = larger(from, -bound), v->turn.hi = lesser_of(to, bound);
    double nl = r->n * lo, nh = r->n * hi, z = r->z.hi, rise = greater_of(nl, nh),
           fall = lesser_of(nl, nh), z_off = LANE_ROUNDING * (fabs(z) + fabs(r->n) * w);
    v->all_z = ends_of(z + fall - z_off, z + rise + z_off);
    v->A = S2 + r->n * r->n, v->lo = lo, v->hi = hi, v->w = w;
}

/* Of G, or with -R of H: twice the slope by tau is told. */
SGT_INLINE void lane_tube(const fine_tube *s, const lane_view *v, double R, lane_cell *e)
{
    /* by intervals */
    two_ends off = ends_difference(v->all_rho, ends_of(R, R)),
             g = ends_difference(ends_sum(ends_square(off), ends_square(v->all_z)), s->square),
             b = ends_sum(ends_product(off, v->turn), ends_product(v->all_z, ends_of(v->n, v->n)));
    /* about the middle */
    twofold o = twofold_difference(v->rho, twofold_of(R)), z = v->z, turn = twofold_product(o, v->ratio);
    twofold G = twofold_sum(twofold_product(o, o), twofold_difference(twofold_product(z, z), s->r2)),
            B = twofold_sum(turn, v->zn);
    double rho = v->rho.hi, size = fabs(R), far = fabs(o.hi), near = FINE_COEFFICIENT * (rho + size),
           length = v->length / rho;
    double g_err = 1.25 * ((2 * far + near) * near +
                           FINE_COEFFICIENT * (far * far + z.hi * z.hi + s->r2.hi) + fabs(G.lo)) + LANE_LOST,
           b_err = 1.25 * (near * length + FINE_COEFFICIENT * (2 * far * length + fabs(v->zn.hi)) +
                           fabs(B.lo)) + LANE_LOST;
    double curl = size * v->curl.hi, flat = size * v->curl.lo, loose = LANE_ROUNDING * (v->A + curl),
           bend_lo = (R > 0 ? v->A - curl : v->A + flat) - loose,
           bend_hi = (R > 0 ? v->A - flat : v->A + curl) + loose,
           bent = greater_of(fabs(bend_lo), fabs(bend_hi));
    double w = v->w, mid = B.hi, swing = w * (LANE_ROUNDING * (2 * fabs(mid) + bent * w) + 2 * b_err) + g_err,
           low = G.hi + lane_least(bend_lo, mid, v->lo, v->hi),
           high = G.hi - lane_least(-bend_hi, -mid, v->lo, v->hi);
    low -= swing + 4 * SGT_U * fabs(low), high += swing + 4 * SGT_U * fabs(high);
    double b_off = LANE_ROUNDING * (fabs(mid) + bent * w) + b_err,
           b_low = mid + lesser_of(0, lesser_of(bend_lo * v->hi, bend_hi * v->lo)) - b_off,
           b_high = mid + greater_of(0, greater_of(bend_hi * v->hi, bend_lo * v->lo)) + b_off;
    e->g.lo = larger(low + v->unknown, g.lo), e->g.hi = lesser_of(high + v->unknown, g.hi);
    e->slope.lo = 2 * larger(b_low + v->unknown, b.lo);
    e->slope.hi = 2 * lesser_of(b_high + v->unknown, b.hi);
}

SGT_INLINE void torus_ring_cell(const fine_tube *s, const fine_ray *r, lane_cell *e)
{
    lane_view v;
    lane_view_of(r, &v);
    lane_tube(s, &v, s->R, e);
}

SGT_INLINE void torus_spindle_cell(const fine_tube *s, const fine_ray *r, lane_cell *e)
{
    lane_view v;
    lane_cell g, h;
    lane_view_of(r, &v);
    lane_tube(s, &v, s->R, &g);
    lane_tube(s, &v, -s->R, &h);
    two_ends both = ends_product(g.g, h.g), slope = ends_two_products(g.slope, h.g, g.g, h.slope);
    e->g.lo = both.lo, e->g.hi = both.hi, e->slope.lo = slope.lo, e->slope.hi = slope.hi;
}

LANE_CELLS(torus_ring, fine_tube, fine_tube_of, torus_ring_cell, s.half, s.known)
LANE_CELLS(torus_spindle, fine_tube, fine_tube_of, torus_spindle_cell, s.k, s.known)

static void torus_encloses(const void *self, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
                           sgt_enclosures out)
{
    const sgt_torus *s = self;
    (s->minor > s->major ? torus_spindle_encloses : torus_ring_encloses)(self, n, rays, t_lo, t_hi, out);
}

/* ------------------------------------------------------------------ sensitivities */

static void torus_second(const void *self, size_t n, sgt_points p, double *const out[6])
{
    torus_ring s = ring_of(self);
    for (size_t i = 0; i < n; i++) {
        double x = p.p[0][i], y = p.p[1][i], z = p.p[2][i];
        tube at = tube_at(&s, x, y, z);
        if (s.spindle) { /* J = S^2 - 4 R^2 rho^2 */
            double k = 4 * s.k, S = at.g + 2 * s.R * at.rho, less = S - 2 * s.R * s.R;
            out[0][i] = k * (less + 2 * x * x), out[1][i] = k * (2 * x * y), out[2][i] = k * (2 * x * z);
            out[3][i] = k * (less + 2 * y * y), out[4][i] = k * (2 * y * z), out[5][i] = k * (S + 2 * z * z);
        } else { /* rho bends by 1 / rho across the radius */
            double c = x / at.rho, t = y / at.rho, bend = at.off / at.rho;
            out[0][i] = s.inverse * (c * c + bend * t * t), out[1][i] = s.inverse * (c * t * (1 - bend)),
            out[3][i] = s.inverse * (t * t + bend * c * c);
            out[2][i] = out[4][i] = 0, out[5][i] = s.inverse;
        }
    }
}

static size_t torus_parameters(const void *self) { return (void)self, 2; }

static void torus_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out)
{
    torus_ring s = ring_of(self);
    for (size_t i = 0; i < n; i++) {
        double x = p.p[0][i], y = p.p[1][i], z = p.p[2][i], f, gx, gy, gz;
        tube at = tube_at(&s, x, y, z);
        if (s.spindle) { /* F = J k: the derivative of J, and that of log k */
            double value = spindle_at(&s, x, y, z, &gx, &gy, &gz), S = at.g + 2 * s.R * at.rho,
                   log = -(1 / (j ? s.r : s.R) + 1 / (s.R + s.r)), by = s.k * (j ? -8 * s.r : 8 * s.R);
            f = log * value + s.k * (j ? -4 * s.r * S : 4 * s.R * (S - 2 * at.rho * at.rho));
            gx = log * gx + (j ? by * x : -by * x), gy = log * gy + (j ? by * y : -by * y),
            gz = log * gz + by * z;
        } else if (j) {
            double value = ring_at(&s, x, y, z, &gx, &gy, &gz);
            f = -1 - value * s.inverse, gx *= -s.inverse, gy *= -s.inverse, gz *= -s.inverse;
        } else {
            f = -at.off * s.inverse, gx = -s.inverse * x / at.rho, gy = -s.inverse * y / at.rho, gz = 0;
        }
        out.f[i] = f;
        if (out.grad[0]) out.grad[0][i] = gx, out.grad[1][i] = gy, out.grad[2][i] = gz;
    }
}

static sgt_objection torus_object(const void *self)
{
    const sgt_torus *s = self;
    if (!(fabs(s->major) < HUGE_VAL)) return (sgt_objection){"major", "not finite"};
    if (!(fabs(s->minor) < HUGE_VAL)) return (sgt_objection){"minor", "not finite"};
    if (!(s->major > 0)) return (sgt_objection){"major", "not above 0"};
    if (!(s->minor > 0)) return (sgt_objection){"minor", "not above 0"};
    return (sgt_objection){NULL, NULL};
}

static const struct sgt_builtin_ops torus_builtin = {
    .object = torus_object, .roundings = torus_roundings, .enclose = sgt_torus_enclose_from,
    .encloses = torus_encloses, .values_rounded = torus_values_rounded,
    .first = torus_steep_first, .firsts = torus_steep_firsts};

const sgt_surface_ops sgt_torus_ops = {
    .name = "torus", .value = torus_value, .values = torus_values, .span = torus_span, .spans = torus_spans,
    .rounding = torus_rounding, .clearance = torus_clearance, .enclose = torus_enclose,
    .first = torus_first, .firsts = torus_firsts, .second = torus_second, .parameters = torus_parameters,
    .by_parameter = torus_by_parameter, .own_ = &torus_builtin};

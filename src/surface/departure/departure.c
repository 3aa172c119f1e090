// SPDX-License-Identifier: MIT
/* departure/departure.c - a departure P(x, y) on a conic base: all that such a surface answers
 * (departure.h).
 *
 * F = z - (s + P), with s = c r^2 / (1 + phi) and phi^2 = 1 - (1 + k) c^2 r^2.  Its gradient is
 *     grad F = (-(c x / phi + P_x), -(c y / phi + P_y), 1).
 *
 * THE SPAN.  Within the rim the span is the chord of the ray with the cylinder r <= rim.  It is found from
 * the point of the ray that is nearest the axis, as in chord.c, but without branches and for many rays at
 * once.  The chord is made longer by 16 u of where it is.  The seed is the conic's root near the vertex
 * plane; a departure moves it by little.
 *
 * Let (l, m, n) be the direction and L >= |grad (s + P)| all over the rim.  For the conic, L is c r / phi
 * at the rim.  Then
 *     g' = n - (s + P)_x l - (s + P)_y m,    |g' - n| <= L sqrt(l^2 + m^2).
 * If |n| is greater than that bound, g is monotone along the chord.  A root there is the only one, and F at
 * any point of the chord bounds the distance to it.
 *
 * BY AXIS.  A mirror in grazing incidence is steep across the rays and nearly flat along them.  Where
 * L_x >= |P_x| and L_y >= |P_y| are known, |g' - n| is also at most L_x |l| + L_y |m|, and the smaller
 * bound is taken.
 *
 * THE ENCLOSURE.  That of the base is in sag/enclose.c.  P is evaluated at the middle m of the stretch, and
 * extended from there by its bounds over the box of the stretch.  Let w = t - m, p' the slope of P along
 * the ray at m, A = dx^2 + dy^2, B >= |P''| and S >= |grad P|.  Then
 *     P in P(m) + p' w +- B A w^2 / 2,    P in P(m) +- S sqrt(A) |w|,
 *     slope in p' +- B A |w|,             |slope| <= S sqrt(A).
 * The doubles x(m) and y(m) are only near the point of the ray.  P there differs by at most S times their
 * distance from it.  If the slope g' found so is bounded, g is also in g(m) + g' w by the mean value
 * theorem.  Its excess width falls with w^2.
 *
 * If the gradient jumps (that of a cone does at its tip, that of a grid does not), there is no B.  The mean
 * value theorem needs S only.
 *
 * ROUNDING.  The sum of four terms: that of conic_sag (sag.h), that of P, that of adding the two, and that
 * of the difference from z. */
#include "departure.h"

/* ------------------------------------------------------------------------- F and its gradient */

/* phi and what the base adds.  NaN outside the domain of the base, and where c^2 r^2 overflows. */
typedef struct base { double r2, phi, sag, by_r; } base;

SGT_INLINE base base_at(double c, double k, double x, double y)
{
    base e = {.r2 = x * x + y * y};
    double cr2 = c * e.r2;
    e.phi = sqrt(1 - (1 + k) * c * cr2);
    e.sag = cr2 / (1 + e.phi) + (e.phi - e.phi);
    e.by_r = c / e.phi; /* ds/dr over r */
    return e;
}

/* In place: f, fx, fy hold P and its derivatives before, F and its gradient after. */
SGT_KERNEL
static void on_conic(const departure_sag *s, size_t n, const double *restrict x, const double *restrict y,
                     const double *restrict z, double *restrict f, double *restrict fx, double *restrict fy)
{
    const double c = s->c, k = s->k;
    LANES for (size_t i = 0; i < n; i++) {
        base e = base_at(c, k, x[i], y[i]);
        f[i] = z[i] - (e.sag + f[i]);
        fx[i] = -(e.by_r * x[i] + fx[i]);
        fy[i] = -(e.by_r * y[i] + fy[i]);
    }
}

SGT_KERNEL
static void on_plane(size_t n, const double *restrict z, double *restrict f, double *restrict fx,
                     double *restrict fy)
{
    LANES for (size_t i = 0; i < n; i++) f[i] = z[i] - f[i], fx[i] = -fx[i], fy[i] = -fy[i];
}

void sgt_departure_values(const departure_sag *s, size_t n, sgt_points at, sgt_values out)
{
    double unwanted[2][DEPARTURE_BLOCK];
    bool wanted = out.grad[0] != NULL;
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < DEPARTURE_BLOCK ? n - i : DEPARTURE_BLOCK;
        const double *x = at.p[0] + i, *y = at.p[1] + i, *z = at.p[2] + i;
        double *f = out.f + i, *fx = wanted ? out.grad[0] + i : unwanted[0],
               *fy = wanted ? out.grad[1] + i : unwanted[1];
        s->of->at(s->self, few, x, y, (sag_values){f, fx, fy});
        if (s->base) on_conic(s, few, x, y, z, f, fx, fy);
        else on_plane(few, z, f, fx, fy);
        for (size_t m = 0; wanted && m < few; m++) out.grad[2][i + m] = 1;
    }
}

double sgt_departure_value(const departure_sag *s, sgt_vec3 p, sgt_vec3 *grad)
{
    double f, fx, fy;
    s->of->at(s->self, 1, &p.x, &p.y, (sag_values){&f, &fx, &fy});
    if (s->base) {
        base e = base_at(s->c, s->k, p.x, p.y);
        f = e.sag + f, fx = e.by_r * p.x + fx, fy = e.by_r * p.y + fy;
    }
    if (grad) *grad = (sgt_vec3){-fx, -fy, 1};
    return p.z - f;
}

/* A bound on what underflow takes from a sum of moderate powers. */
static const double DEPARTURE_LOST = 0x1p-1050;

/* The same where many points share it.  There it is a term of an fma, and some processors take a hundred
 * cycles for one with a subnormal number. */
static const double NOISE_LOST = 0x1p-1020;

double sgt_departure_rounding(const departure_sag *s, sgt_vec3 at)
{
    double p, px, py, p_err, grad_err, sag = 0, sag_err = 0;
    s->of->at(s->self, 1, &at.x, &at.y, (sag_values){&p, &px, &py});
    if (s->of->size_rounding) p_err = s->of->size_rounding(s->self, at.x, at.y);
    else s->of->rounding(s->self, at.x, at.y, &p_err, &grad_err);
    if (s->base) {
        base e = base_at(s->c, s->k, at.x, at.y);
        sag = e.sag, sag_err = SGT_U * conic_sag_rounding(s->c, s->k, e.r2, e.sag, e.phi);
    }
    return 1.01 * (sag_err + p_err + SGT_U * (fabs(sag + p) + fabs(at.z - (sag + p)))) + DEPARTURE_LOST;
}

/* The same for many points, at less cost.  F is known, so s + P is z - F.  What P adds is one bound for all
 * points within the rim. */
SGT_INLINE double rounding_within(double c, double k, double most2, double e0, double e1, base e, double z,
                                  double f)
{
    double sag = conic_sag_rounding(c, k, e.r2, e.sag, e.phi), sum = fabs(z - f) + fabs(f);
    return chosen(MASK(e.r2 <= most2), 1.01 * (SGT_U * (sag + 2 * sum) + sgt_fma(e1, e.r2, e0)), (double)NAN);
}

SGT_KERNEL
static void roundings_within(const sgt_shared *s, size_t n, sgt_points p, const double *restrict f,
                             double *restrict out)
{
    const double c = s->base_c, k = s->base_k, most2 = s->most2, e0 = s->noise[0], e1 = s->noise[1],
                 *restrict x = p.p[0], *restrict y = p.p[1], *restrict z = p.p[2];
    LANES for (size_t i = 0; i < n; i++)
        out[i] = rounding_within(c, k, most2, e0, e1, base_at(c, k, x[i], y[i]), z[i], f[i]);
}

bool sgt_departure_roundings(const void *self, const sgt_shared *s, size_t n, sgt_points p, const double f[],
                             double out[])
{
    (void)self;
    if (!(s->noise[0] + s->noise[1] < HUGE_VAL)) return false;
    roundings_within(s, n, p, f, out);
    return true;
}

/* on_conic, or on_plane, and roundings_within in one loop; noise: as rows of values_rounded (builtin.h), NULL
 * if there are none. */
SGT_INLINE void rounded_by(bool conic, bool rows, const sgt_shared *shared, const double *const noise[3],
                           size_t n, sgt_points p, sag_values at, double *restrict own)
{
    const double *restrict x = p.p[0], *restrict y = p.p[1], *restrict z = p.p[2];
    double *restrict f = at.p, *restrict fx = at.px, *restrict fy = at.py;
    const double c = shared->base_c, k = shared->base_k, most2 = shared->most2, e0 = shared->noise[0],
                 e1 = shared->noise[1], *restrict row0 = rows ? noise[0] : NULL,
                 *restrict row1 = rows ? noise[1] : NULL, *restrict row2 = rows ? noise[2] : NULL;
    LANES for (size_t i = 0; i < n; i++) {
        base e = base_at(c, k, x[i], y[i]);
        double g = z[i] - (conic ? e.sag + f[i] : f[i]),
               bound = rounding_within(c, k, most2, e0, e1, e, z[i], g);
        if (rows) bound += sgt_noise_at(row0[i], row1[i], row2[i], e.r2);
        own[i] = bound;
        f[i] = g;
        fx[i] = -(conic ? e.by_r * x[i] + fx[i] : fx[i]);
        fy[i] = -(conic ? e.by_r * y[i] + fy[i] : fy[i]);
    }
}

#define ROUNDED(NAME, CONIC, ROWS)                                                                           \
    SGT_KERNEL                                                                                               \
    static void NAME(const sgt_shared *shared, const double *const noise[3], size_t n, sgt_points p,         \
                     sag_values at, double *own)                                                             \
    {                                                                                                        \
        rounded_by(CONIC, ROWS, shared, noise, n, p, at, own);                                               \
    }
ROUNDED(on_conic_rounded, true, false)
ROUNDED(on_conic_rounded_apart, true, true)
ROUNDED(on_plane_rounded, false, false)
ROUNDED(on_plane_rounded_apart, false, true)

bool sgt_departure_values_rounded(const departure_sag *s, const sgt_shared *shared,
                                  const double *const noise[3], size_t n, sgt_points at, sgt_values out,
                                  double own[])
{
    if (!(shared->noise[0] + shared->noise[1] < HUGE_VAL)) return false;
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < DEPARTURE_BLOCK ? n - i : DEPARTURE_BLOCK;
        sgt_points p = {{at.p[0] + i, at.p[1] + i, at.p[2] + i}};
        sag_values f = {out.f + i, out.grad[0] + i, out.grad[1] + i};
        s->of->at(s->self, few, p.p[0], p.p[1], f);
        const double *here[3] = {noise ? noise[0] + i : NULL, noise ? noise[1] + i : NULL,
                                 noise ? noise[2] + i : NULL};
        if (s->base && noise) on_conic_rounded_apart(shared, here, few, p, f, own + i);
        else if (s->base) on_conic_rounded(shared, here, few, p, f, own + i);
        else if (noise) on_plane_rounded_apart(shared, here, few, p, f, own + i);
        else on_plane_rounded(shared, here, few, p, f, own + i);
        for (size_t m = 0; m < few; m++) out.grad[2][i + m] = 1;
    }
    return true;
}

/* --------------------------------------------------------------------------------------- the span */

static const double FAR_OUT = 0x1p1023; /* no point of a ray whose coordinates are doubles is farther */

typedef struct spanned { double lo, hi, seed, least; } spanned; /* least > 0: there is at most one root */

typedef struct chord { double lo, hi, least; } chord;

/* radius2 is that of the domain; it is widened here by 2^-40 and more.  steep is L, already rounded up by a
 * part in 2^20; so are L_x and L_y, which are read if by_axis is set. */
SGT_INLINE chord departure_chord_of(double radius2, double steep, bool by_axis, double steep_x,
                                    double steep_y, sgt_vec3 o, sgt_vec3 d)
{
    double scale = scale_of(d), l = d.x * scale, m = d.y * scale, n = d.z * scale, a = l * l + m * m,
           inverse = 1 / a;
    /* The chord from the point nearest the axis, computed twice: the second time from the first result, so
     * that rounding is small beside the chord. */
    double t0 = -(o.x * l + o.y * m) * inverse;
    double x = moved_along(o.x, t0, l), y = moved_along(o.y, t0, m);
    double middle = -(x * l + y * m) * inverse, cross = x * m - y * l, near2 = cross * cross * inverse;
    double half2 = (radius2 * (1 + 0x1p-39) - near2 * (1 - 0x1p-40)) * inverse;
    double half = sqrt(half2) * (1 + 0x1p-40) + 0x1p-49 * (fabs(middle) + fabs(t0));
    middle += t0;
    double lo = end_below(middle - half, scale), hi = end_above(middle + half, scale);
    mask along = MASK(fabs(d.x) + fabs(d.y) == 0), across = MASK(a > TINY);
    mask outside = MASK(o.x * o.x + o.y * o.y > radius2 * (1 + 0x1p-39));
    mask none = (along & outside) | (across & ~along & MASK(half2 < 0));
    mask finite = across & ~along & MASK((lo - lo) + (hi - hi) == 0);
    lo = chosen(finite, lo, -HUGE_VAL), hi = chosen(finite, hi, HUGE_VAL);
    lo = chosen(none, 1, lo), hi = chosen(none, -1, hi);
    /* L bounds the slope for r <= rim (1 + 2^-20).  Rounding makes the chord longer, here and where the ray
     * is made local.  So `least` is given only if the longer chord is certainly within that r. */
    double slope = steep * sqrt(a), apart = steep_x * fabs(l) + steep_y * fabs(m);
    if (by_axis) slope = chosen(MASK(apart < slope), apart, slope);
    double least = fabs(n) * (1 - 0x1p-40) - slope, added = 0x1p-48 * (fabs(middle) + fabs(t0));
    least = chosen(along | (across & MASK(added * added * a <= 0x1p-42 * radius2) & MASK(hi - lo > 0x1p-900)),
                   least, 0);
    return (chord){lo, hi, chosen(MASK(least > 0) & ~none, least, 0)};
}

/* The root of the conic near the vertex plane.  by_axis: with the curvature c + lean along x, and c - lean
 * along y.  A ray along a mirror would end far from its root by the mean of the two. */
SGT_INLINE double seed_of(const sgt_shared *s, bool by_axis, sgt_vec3 o, sgt_vec3 d)
{
    const double c = s->c, k1 = s->k1, lean = s->lean;
    double scale = scale_of(d), l = d.x * scale, m = d.y * scale, n = d.z * scale, a = l * l + m * m;
    double by_n = 1 / n, tz = -o.z * by_n;
    twofold qx = two_product(tz, l), qy = two_product(tz, m), rx = two_sum(o.x, qx.hi),
            ry = two_sum(o.y, qy.hi);
    double tz_lo = sgt_fma(-tz, n, -o.z) * by_n;
    double x = rx.hi + (rx.lo + qx.lo + tz_lo * l), y = ry.hi + (ry.lo + qy.lo + tz_lo * m);
    double A = c * (a + k1 * n * n), B = n - c * (x * l + y * m), C = c * (x * x + y * y);
    if (by_axis) A += lean * (l * l - m * m), B -= lean * (x * l - y * m), C += lean * (x * x - y * y);
    double root = sqrt(larger(B * B - A * C, 0)), near = C / (B + copysign(root, B));
    return (tz + (tz_lo + near)) * scale;
}

SGT_INLINE spanned span_of(const sgt_shared *s, bool by_axis, sgt_vec3 o, sgt_vec3 d)
{
    chord at = departure_chord_of(s->radius2, s->steep, by_axis, s->axis.x, s->axis.y, o, d);
    double seed = seed_of(s, by_axis, o, d);
    seed = chosen(MASK(seed >= at.lo) & MASK(seed <= at.hi), seed, (double)NAN);
    return (spanned){at.lo, at.hi, seed, at.least};
}

/* A bound on the slope of the conic within r: w / phi with w = |c| r, which grows with r.  If its squares
 * overflow, it is the slope of the asymptote, which is never reached.  For a paraboloid w itself is exact. */
static double conic_slope(double c, double k1, double r)
{
    double w = fabs(c) * r, phi2 = 1 - k1 * w * w;
    if (!(w < HUGE_VAL)) return k1 < 0 ? 1 / sqrt(-k1) : HUGE_VAL;
    return phi2 == HUGE_VAL ? 1 / sqrt(-k1) : phi2 > 0x1p-30 ? w / sqrt(phi2) : HUGE_VAL;
}

/* What the second derivative of the sag lies in within r, if that of P is at most `bend`.  The conic has
 * c / phi^3 in the direction of r and c / phi across it, and phi is monotone in r.  So it is between c and
 * the c / phi^3 at r.  More than rounding is added at either end. */
static sgt_interval bent_within(double c, double k1, double r, double bend)
{
    double axis = fabs(c), w = axis * r, phi2 = 1 - k1 * w * w, rim = axis / (phi2 * sqrt(phi2));
    double most = larger(rim, axis), least = rim < axis ? rim : axis,
           off = bend + (most + bend + DEPARTURE_LOST) * 0x1p-17;
    if (!(phi2 > 0x1p-30 && off < HUGE_VAL)) return sgt_interval_all();
    return c < 0 ? sgt_interval_between(-most - off, off - least)
                 : sgt_interval_between(least - off, most + off);
}

/* The heights of the surface within r, if those of P lie in p.  The sag of a conic grows with r. */
static sgt_interval heights_within(const departure_sag *s, double r, sgt_interval p)
{
    double c = s->base ? s->c : 0, cr2 = fabs(c) * r * r, phi2 = 1 - (1 + s->k) * fabs(c) * cr2,
           most = cr2 / (1 + sqrt(larger(phi2, 0)));
    double off = 0x1p-20 * (most + larger(-p.lo, p.hi)) + DEPARTURE_LOST;
    if (!(r < 0x1p400 && phi2 < HUGE_VAL && off < HUGE_VAL && p.lo <= p.hi)) return sgt_interval_all();
    return sgt_interval_between(p.lo - (c < 0 ? most : 0) - off, p.hi + (c > 0 ? most : 0) + off);
}

void sgt_departure_noise(const departure_sag *s, double radius, double e[2])
{
    e[0] = e[1] = (double)NAN;
    if (s->of->noise && radius < HUGE_VAL) s->of->noise(s->self, radius, e);
    e[0] += NOISE_LOST;
}

void sgt_departure_noise_about(const departure_sag *s, double radius, double e[2])
{
    e[0] = e[1] = (double)NAN;
    if (!s->of->noise_about || !(radius < HUGE_VAL)) {
        sgt_departure_noise(s, radius, e);
        return;
    }
    s->of->noise_about(s->self, radius, e);
    e[0] += NOISE_LOST;
}

/* noise_about of many radii; an infinite one is NaN. */
bool sgt_departure_noises(const departure_sag *s, size_t n, const double radius[], double e0[], double e1[])
{
    if (!s->of->noises) return false;
    s->of->noises(s->self, n, radius, e0, e1);
    LANES for (size_t i = 0; i < n; i++) e0[i] += NOISE_LOST;
    return true;
}

/* The sag of the base is at most |c| r^2, with the sign of c: 1 + phi >= 1.  A tail so small that its margins
 * would be lost, or those of the terms that it is made of, is not known. */
double sgt_departure_tail(const departure_sag *s, double radius)
{
    static const double LEAST = 0x1p-900;
    double tail = s->of->tail && radius < 0x1p400 ? s->of->tail(s->self, radius) : 0, c = s->base ? s->c : 0;
    double against = c != 0 && signbit(c) != signbit(tail) ? fabs(c) * radius * radius * (1 + 0x1p-40) : 0;
    double left = fabs(tail) - against;
    return left > LEAST ? copysign(left, tail) : 0;
}

/* If a rectangle has no rim, the circle through its corners is taken.  That is safe because a ray is inside
 * a rectangle along one stretch at most. */
static double rim2_within_frame(const departure_sag *s)
{
    double rim2 = rim2_of(s->semi_diameter);
    return s->of->framed && s->reach > 0 && !(rim2 < HUGE_VAL) ? s->reach * s->reach * (1 + 0x1p-40) : rim2;
}

static sgt_interval departure_within(double size)
{
    return size < HUGE_VAL ? sgt_interval_between(-size, size) : sgt_interval_all();
}

static const sgt_extent UNKNOWN = SGT_NO_EXTENT;

/* As `steep` and `bend` are made wider.  Of a cylinder some are 0, and what is added is multiplied by parts
 * of directions for each ray: it is so large that no product is subnormal, and far below all that counts. */
static const double AXIS_LOST = 0x1p-900;

SGT_INLINE sgt_interval sag_wider(sgt_interval x)
{
    double off = 0x1p-19 * larger(-x.lo, x.hi) + AXIS_LOST;
    return off < HUGE_VAL ? sgt_interval_between(x.lo - off, x.hi + off) : sgt_interval_all();
}

static sgt_by_axis widened(sgt_by_axis b)
{
    double more = (1 + 0x1p-20) * (1 + 0x1p-20), least = AXIS_LOST;
    return (sgt_by_axis){(b.x + least) * more, (b.y + least) * more, (b.xy + least) * more, b.turn,
                         sag_wider(b.xx), sag_wider(b.yy)};
}

/* The heights and the bend are worked out only if they are wanted. */
static void extent_of(const departure_sag *s, bool wanted, bool bent, sgt_extent *extent)
{
    double rim2 = rim2_within_frame(s), domain2 = s->base ? domain2_within(s->c, s->k, rim2) : rim2;
    sgt_extent e;
    e.radius2 = domain2, e.steep = HUGE_VAL, e.z = e.bent = sgt_interval_all();
    if (s->of->by_axis) e.axis = UNKNOWN.axis;
    bool whole = domain2 == rim2; /* if not, the equator of the base is inside, and its slope has no bound */
    if (rim2 > 0 && (whole || rim2 < HUGE_VAL)) {
        double r = domain2 < HUGE_VAL ? sqrt(domain2) * (1 + 0x1p-19) : FAR_OUT,
               conic = s->base ? conic_slope(s->c, 1 + s->k, r) : 0;
        region where = {{-r, r}, {-r, r}, 0, r};
        bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
        sgt_interval heights;
        int defined = !(conic < HUGE_VAL || !whole) ? 0
                      : s->of->by_axis              ? s->of->by_axis(s->self, &where, &b, &e.axis, &heights)
                                                    : s->of->bounds(s->self, &where, &b);
        double steep = (conic + b.steep + DEPARTURE_LOST) * (1 + 0x1p-20);
        bool bounded = whole && (defined == 1 || s->of->framed) && steep < 0x1p500;
        if (bounded) e.steep = steep * (1 + 0x1p-20);
        if (bounded && bent) e.bent = bent_within(s->base ? s->c : 0, 1 + s->k, r, b.bend);
        if (s->of->by_axis) e.axis = bounded ? widened(e.axis) : UNKNOWN.axis;
        if (!(s->of->by_axis && b.size < HUGE_VAL)) heights = departure_within(b.size);
        if (wanted && !(b.size < HUGE_VAL) && defined && s->of->range)
            heights = s->of->range(s->self, &where);
        if (wanted && defined) e.z = heights_within(s, r, heights);
    }
    if (s->reach > 0 && !(s->reach * s->reach * (1 + 0x1p-40) > domain2))
        e.radius2 = larger(s->reach * s->reach * (1 + 0x1p-40), TINY);
    extent->radius2 = e.radius2, extent->steep = e.steep, extent->z = e.z, extent->bent = e.bent;
    if (s->of->by_axis) extent->axis = e.axis;
}

void sgt_departure_within(const departure_sag *s, bool bent, sgt_extent *extent)
{
    extent_of(s, true, bent, extent);
}

void sgt_departure_in_box(const departure_sag *s, double x, double y, double *steep, sgt_by_axis *axis)
{
    *steep = HUGE_VAL, *axis = UNKNOWN.axis;
    if (!s->of->by_axis || s->base || !(x < 0x1p400 && y < 0x1p400)) return;
    x *= 1 + 0x1p-19, y *= 1 + 0x1p-19;
    region where = {{-x, x}, {-y, y}, 0, sqrt(x * x + y * y) * (1 + 0x1p-40)};
    bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    sgt_interval heights;
    if (s->of->by_axis(s->self, &where, &b, axis, &heights) != 1 || !(b.steep < 0x1p500)) {
        *axis = UNKNOWN.axis;
        return;
    }
    *steep = b.steep * (1 + 0x1p-20) + DEPARTURE_LOST, *axis = widened(*axis);
}

bool sgt_departure_bent(const departure_sag *s, sgt_interval *bent)
{
    double rim2 = rim2_within_frame(s), domain2 = s->base ? domain2_within(s->c, s->k, rim2) : rim2,
           c = s->base ? s->c : 0, r = sqrt(rim2) * (1 + 0x1p-19); /* as in extent_of */
    if (!s->of->bent || !(rim2 > 0 && rim2 < HUGE_VAL) || domain2 != rim2) return false;
    region where = {{-r, r}, {-r, r}, 0, r};
    bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    sgt_interval p, conic = bent_within(c, 1 + s->k, r, 0);
    if (s->of->bounds(s->self, &where, &b) != 1 || !(b.bend < HUGE_VAL && conic.hi < HUGE_VAL)) return false;
    if (!s->of->bent(s->self, r, b.bend, &p)) return false;
    *bent = sag_wider(sgt_interval_between(conic.lo + p.lo, conic.hi + p.hi));
    return bent->hi < HUGE_VAL;
}

bool sgt_departure_in_part(const departure_sag *s, sgt_part *part)
{
    if (!s->of->bounds_along || !(part->radius < 0x1p400)) return false;
    double wide = 1 + 0x1p-19, r = part->radius * wide, x = part->x * wide, y = part->y * wide,
           c = s->base ? s->c : 0, steep = conic_slope(c, 1 + s->k, r),
           a = part->l * part->l + part->m * part->m;
    region where = {{-x, x}, {-y, y}, 0, r};
    bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    sgt_interval bent = bent_within(c, 1 + s->k, r, 0);
    if (s->of->bounds_along(s->self, &where, part->l, part->m, &b) != 1) return false;
    steep = (steep + b.steep + DEPARTURE_LOST) * wide, b.bend = b.bend * wide + AXIS_LOST;
    if (!(steep < 0x1p500 && b.bend < HUGE_VAL && bent.hi < HUGE_VAL)) return false;
    part->steep = steep;
    part->bent = sag_wider(sgt_interval_between(bent.lo * a - b.bend, bent.hi * a + b.bend));
    sgt_departure_noise_in_box(s, part->x, part->y, part->noise);
    return true;
}

void sgt_departure_noise_in_box(const departure_sag *s, double x, double y, double e[2])
{
    e[0] = e[1] = (double)NAN;
    if (s->of->noise_in_box) s->of->noise_in_box(s->self, x * (1 + 0x1p-19), y * (1 + 0x1p-19), e);
    e[0] += NOISE_LOST;
}

/* The radius at which the surface ends, or HUGE_VAL.  P may end before the rim; `bounds` then says so.
 * *endless is set if the surface ends there in one direction, but farther out or nowhere in the other (a
 * cylinder). */
static double end_of_surface(const departure_sag *s, bool *endless)
{
    double rim2 = rim2_within_frame(s), domain2 = s->base ? domain2_within(s->c, s->k, rim2) : rim2;
    region all = {{-FAR_OUT, FAR_OUT}, {-FAR_OUT, FAR_OUT}, 0, FAR_OUT};
    bounds b;
    *endless = false;
    if (!(domain2 < HUGE_VAL) && s->of->bounds(s->self, &all, &b) == -1) {
        double x = sgt_interval_greatest(all.x), y = sgt_interval_greatest(all.y), least = x < y ? x : y;
        domain2 = x < 0x1p400 && y < 0x1p400 ? x * x + y * y : HUGE_VAL;
        *endless = !(domain2 < HUGE_VAL) && !s->base && s->of->range;
        if (*endless) domain2 = least < 0x1p400 ? least * least : HUGE_VAL;
    }
    return domain2 > 0x1p-400 && domain2 < 0x1p400 ? sqrt(domain2) * (1 + 0x1p-19) : HUGE_VAL;
}

/* The range of P where it is defined; empty if it is nowhere defined. */
static sgt_interval range_over(const departure_sag *s, region *where)
{
    bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    if (s->of->range) return s->of->range(s->self, where);
    return s->of->bounds(s->self, where, &b) ? sgt_interval_between(-b.size, b.size) : sgt_interval_empty();
}

/* The sag of the base is monotone in r.  Next to its equator one rounding is 2^-26 of it. */
void sgt_departure_heights(const departure_sag *s, sgt_heights *out)
{
    double end = end_of_surface(s, &out->endless), width = end / SGT_RINGS, k1 = 1 + s->k;
    out->width = end < HUGE_VAL ? width * (1 + 0x1p-40) : 0;
    for (int j = 0; j < SGT_RINGS && out->width > 0; j++) {
        double in = j * width * (1 - 0x1p-40), r = (j + 1) * width * (1 + 0x1p-40);
        region where = {{-r, r}, {-r, r}, in, r};
        if (out->endless && j == SGT_RINGS - 1) {
            bounds unused;
            where = (region){{-FAR_OUT, FAR_OUT}, {-FAR_OUT, FAR_OUT}, in, FAR_OUT};
            s->of->bounds(s->self, &where, &unused); /* cuts it to where P is defined */
        }
        out->low[j] = HUGE_VAL, out->high[j] = -HUGE_VAL;
        sgt_interval p = range_over(s, &where);
        if (sgt_interval_is_empty(p)) continue;
        double c = s->base ? s->c : 0, u = 1 - k1 * c * c * (in * in), v = 1 - k1 * c * c * (r * r);
        double near = c * (in * in) / (1 + sqrt(u > 0 ? u : 0)),
               far = c * (r * r) / (1 + sqrt(v > 0 ? v : 0));
        double off = 0x1p-20 * (fabs(near) + fabs(far)) + DEPARTURE_LOST;
        out->low[j] = (near < far ? near : far) + p.lo - (off + 0x1p-20 * fabs(p.lo));
        out->high[j] = (near > far ? near : far) + p.hi + (off + 0x1p-20 * fabs(p.hi));
    }
}

void sgt_departure_share(const departure_sag *s, sgt_shared *shared)
{
    sgt_extent e;
    extent_of(s, false, true, &e);
    shared->c = s->c, shared->k1 = 1 + s->k, shared->radius2 = e.radius2, shared->steep = e.steep;
    shared->base_c = s->base ? s->c : 0, shared->base_k = s->base ? s->k : 0, shared->bent = e.bent;
    shared->by_axis = s->of->by_axis != NULL, shared->boxed = s->of->bounds_along != NULL;
    shared->tailed = s->of->tail != NULL, shared->ahead = looks_ahead(s);
    if (shared->by_axis) shared->axis = e.axis, shared->lean = s->lean;
    shared->most2 = rim2_within_frame(s) * (1 + 0x1p-20);
    sgt_departure_noise(s, sqrt(shared->most2) * (1 + 0x1p-40), shared->noise);
}

SGT_INLINE void chords_of(size_t n, const sgt_rays *r, const double *restrict radius2,
                          const double *restrict steep, const double *const axis[2], double *restrict lo,
                          double *restrict hi, double *restrict least)
{
    const double *ox = r->o[0], *oy = r->o[1], *oz = r->o[2], *dx = r->d[0], *dy = r->d[1], *dz = r->d[2],
                 *steep_x = axis ? axis[0] : steep, *steep_y = axis ? axis[1] : steep;
    const bool by_axis = axis != NULL;
    LANES for (size_t i = 0; i < n; i++) {
        chord e = departure_chord_of(radius2[i], steep[i], by_axis, steep_x[i], steep_y[i],
                                     (sgt_vec3){ox[i], oy[i], oz[i]}, (sgt_vec3){dx[i], dy[i], dz[i]});
        lo[i] = e.lo, hi[i] = e.hi, least[i] = e.least;
    }
}

SGT_KERNEL
static void all_chords(size_t n, const sgt_rays *r, const double *radius2, const double *steep, double *lo,
                       double *hi, double *least)
{
    chords_of(n, r, radius2, steep, NULL, lo, hi, least);
}

SGT_KERNEL
static void all_chords_by_axis(size_t n, const sgt_rays *r, const double *radius2, const double *steep,
                               const double *const axis[2], double *lo, double *hi, double *least)
{
    const double *const both[2] = {axis[0], axis[1]};
    chords_of(n, r, radius2, steep, both, lo, hi, least);
}

void sgt_departure_chords(size_t n, sgt_rays r, const double *radius2, const double *steep,
                          const double *const axis[2], double *lo, double *hi, double *least)
{
    if (axis) all_chords_by_axis(n, &r, radius2, steep, axis, lo, hi, least);
    else all_chords(n, &r, radius2, steep, lo, hi, least);
}

#define SPANS(NAME, BY_AXIS)                                                                                 \
    SGT_KERNEL                                                                                               \
    static void NAME(const sgt_shared *self, size_t n, const double *restrict ox, const double *restrict oy, \
                     const double *restrict oz, const double *restrict dx, const double *restrict dy,        \
                     const double *restrict dz, double *restrict lo, double *restrict hi,                    \
                     double *restrict seed, double *restrict least)                                          \
    {                                                                                                        \
        const sgt_shared s = *self;                                                                          \
        LANES for (size_t i = 0; i < n; i++)                                                                 \
        {                                                                                                    \
            spanned e =                                                                                      \
                span_of(&s, BY_AXIS, (sgt_vec3){ox[i], oy[i], oz[i]}, (sgt_vec3){dx[i], dy[i], dz[i]});      \
            lo[i] = e.lo, hi[i] = e.hi, seed[i] = e.seed, least[i] = e.least;                                \
        }                                                                                                    \
    }
SPANS(all_spans, false)
SPANS(all_spans_by_axis, true)

void sgt_departure_spans(const void *self, const sgt_shared *s, size_t n, sgt_rays r, sgt_spans out,
                         double *least)
{
    (void)self;
    double own[DEPARTURE_BLOCK];
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < DEPARTURE_BLOCK ? n - i : DEPARTURE_BLOCK;
        double *to = least ? least + i : own;
        (s->by_axis ? all_spans_by_axis : all_spans)(s, few, r.o[0] + i, r.o[1] + i, r.o[2] + i, r.d[0] + i,
                                                     r.d[1] + i, r.d[2] + i, out.lo + i, out.hi + i,
                                                     out.seed + i, to);
        for (size_t j = 0; out.single && j < few; j++) out.single[i + j] = to[j] > 0;
    }
}

#define SEEDS(NAME, BY_AXIS)                                                                                 \
    SGT_KERNEL                                                                                               \
    static void NAME(const sgt_shared *self, size_t n, const double *restrict ox, const double *restrict oy, \
                     const double *restrict oz, const double *restrict dx, const double *restrict dy,        \
                     const double *restrict dz, double *restrict seed)                                       \
    {                                                                                                        \
        const sgt_shared s = *self;                                                                          \
        LANES for (size_t i = 0; i < n; i++) seed[i] =                                                       \
            seed_of(&s, BY_AXIS, (sgt_vec3){ox[i], oy[i], oz[i]}, (sgt_vec3){dx[i], dy[i], dz[i]});          \
    }
SEEDS(all_seeds, false)
SEEDS(all_seeds_by_axis, true)

void sgt_departure_seeds(const void *self, const sgt_shared *s, size_t n, sgt_rays r, double seed[])
{
    (void)self;
    (s->by_axis ? all_seeds_by_axis : all_seeds)(s, n, r.o[0], r.o[1], r.o[2], r.d[0], r.d[1], r.d[2], seed);
}

static spanned one_span(const sgt_shared *s, const sgt_ray *ray)
{
    return span_of(s, s->by_axis, ray->o, ray->d);
}

sgt_span sgt_departure_span(const void *self, const sgt_shared *s, const sgt_ray *ray, double *least)
{
    (void)self;
    spanned a = one_span(s, ray);
    if (least) *least = a.least;
    return (sgt_span){a.lo, a.hi, a.seed, a.least > 0};
}

/* ---------------------------------------------------------------------------------- the enclosure */

/* o + t0 d.  However far the origin, at most an ulp of the result is lost. */
static sgt_interval moved_to(double o, double d, double t0)
{
    twofold p = two_product(t0, d), s = two_sum(o, p.hi);
    double size = fabs(p.hi);
    if (t0 == 0 || d == 0) return sgt_interval_of(o);
    if (!(size > 0x1p-960 && size < 0x1p1000 && fabs(o) < 0x1p1000))
        return sgt_interval_sum(sgt_interval_of(o), sgt_interval_scaled(sgt_interval_of(t0), d));
    return sgt_interval_between(-sgt_sum_above(-s.hi, sgt_sum_above(-s.lo, -p.lo)),
                                sgt_sum_above(s.hi, sgt_sum_above(s.lo, p.lo)));
}

static sgt_interval along(sgt_interval from, double d, sgt_interval t)
{
    return sgt_interval_sum(from, sgt_interval_scaled(t, d));
}

static bool departure_bounded(sgt_interval x) { return x.lo > -HUGE_VAL && x.hi < HUGE_VAL; }

/* The double nearest the middle of `at`, moved into x. */
static double inside(sgt_interval at, sgt_interval x)
{
    double m = sgt_interval_middle(at);
    return m < x.lo ? x.lo : m > x.hi ? x.hi : m;
}

/* P over t0 + t, and its slope along the ray. */
static sgt_interval departure_over(const departure_sag *s, const sgt_ray *ray, double t0, sgt_interval t,
                                   double m, sgt_interval *slope)
{
    sgt_vec3 o = ray->o, d = ray->d;
    sgt_interval none = sgt_interval_empty(), all = sgt_interval_all(), x0 = moved_to(o.x, d.x, t0),
                 y0 = moved_to(o.y, d.y, t0);
    region where = {.x = along(x0, d.x, t), .y = along(y0, d.y, t)};
    *slope = all;
    sgt_interval r = sgt_interval_square_root(
        sgt_interval_sum(sgt_interval_square(where.x), sgt_interval_square(where.y)));
    where.r_lo = r.lo, where.r_hi = r.hi;
    bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    int defined = s->of->bounds(s->self, &where, &b);
    if (!defined) return *slope = none;
    if (!(r.hi < 0x1p500)) return all;

    sgt_interval xm = along(x0, d.x, sgt_interval_of(m)), ym = along(y0, d.y, sgt_interval_of(m));
    double x = inside(xm, where.x), y = inside(ym, where.y), p, px, py, p_err, grad_err;
    s->of->at(s->self, 1, &x, &y, (sag_values){&p, &px, &py});
    s->of->rounding(s->self, x, y, &p_err, &grad_err);
    /* A plane is exact, and so is a departure on the axis.  Where a normal number bounds the bend, a size and
     * a slope of 0 have not underflown, or the departure is below all numbers: a cylinder where y is 0. */
    double lost = b.size > 0 || (r.hi > 0 && (b.steep > 0 || (b.bend > 0 && b.bend < 0x1p-1000)))
                      ? DEPARTURE_LOST : 0;
    p_err += lost, grad_err += lost, b.size += lost, b.steep += lost, b.bend += lost;
    sgt_interval whole = !(b.steep < HUGE_VAL) && s->of->range ? s->of->range(s->self, &where)
                                                               : departure_within(b.size);
    if (!(p_err < HUGE_VAL && fabs(p) < HUGE_VAL)) return whole;

    sgt_interval here = sgt_interval_about(p, p_err), w = sgt_interval_difference(t, sgt_interval_of(m));
    sgt_interval lm2 = sgt_interval_sum(sgt_interval_square(sgt_interval_of(d.x)),
                                        sgt_interval_square(sgt_interval_of(d.y)));
    double length = sgt_interval_square_root(lm2).hi, w_most = sgt_interval_greatest(w);
    /* How far (x, y) is from the point of the ray.  If P is defined only in a part of the box, (x, y) may
     * have been moved into it.  Then the distance to the whole stretch is taken. */
    sgt_interval off_x = sgt_interval_difference(defined < 0 ? where.x : xm, sgt_interval_of(x)),
                 off_y = sgt_interval_difference(defined < 0 ? where.y : ym, sgt_interval_of(y));
    double off = sgt_sum_above(sgt_interval_greatest(off_x), sgt_interval_greatest(off_y));
    sgt_interval moved = sgt_interval_sum(here, departure_within(sgt_product_above(b.steep, off)));
    if (defined < 0) return sgt_interval_intersection(moved, whole);

    sgt_interval run = departure_within(sgt_product_above(sgt_product_above(b.steep, length), w_most));
    sgt_interval range = sgt_interval_intersection(sgt_interval_sum(moved, run), whole);
    sgt_interval steep = departure_within(sgt_product_above(b.steep, length));
    *slope = steep;
    if (b.bend < HUGE_VAL && grad_err < HUGE_VAL && fabs(px) < HUGE_VAL && fabs(py) < HUGE_VAL) {
        double bent = sgt_product_above(b.bend, off), reach = sgt_product_above(lm2.hi, w_most),
               sideways = sgt_sum_above(grad_err, bent);
        sgt_interval at = sgt_interval_sum(sgt_interval_scaled(sgt_interval_about(px, sideways), d.x),
                                           sgt_interval_scaled(sgt_interval_about(py, sideways), d.y));
        *slope = sgt_interval_intersection(
            steep, sgt_interval_sum(at, departure_within(sgt_product_above(b.bend, reach))));
        double half = sgt_product_above(0.5 * b.bend, sgt_product_above(reach, w_most));
        range = sgt_interval_intersection(
            range,
            sgt_interval_sum(moved, sgt_interval_sum(sgt_interval_product(at, w), departure_within(half))));
    }
    return range;
}

static sgt_interval base_over(const departure_sag *s, const sgt_ray *ray, double t0, sgt_interval t,
                              sgt_interval *slope)
{
    double c = s->base ? s->c : 0;
    shape conic = {.c = c, .k = s->k, .ck = (1 + s->k) * c, .terms = 0, .a = NULL, .rim2 = HUGE_VAL,
                   .domain2 = HUGE_VAL};
    return sgt_sag_enclose(&conic, ray, t0, t, slope);
}

SGT_NARROW(sgt_interval, sgt_departure_enclose,
           (const departure_sag *s, const sgt_ray *ray, double t0, sgt_interval t,
            sgt_interval *slope))
{
    double m = sgt_interval_middle(t);
    sgt_interval by_base, by_p, sag = base_over(s, ray, t0, t, &by_base);
    *slope = by_base;
    if (sgt_interval_is_empty(sag)) return sag;
    if (!(t.lo <= t.hi)) return *slope = sgt_interval_all();
    sgt_interval p = departure_over(s, ray, t0, t, m, &by_p);
    *slope = sgt_interval_difference(by_base, by_p);
    sgt_interval g = sgt_interval_difference(sag, p);
    if (t.lo < t.hi && departure_bounded(*slope) && !sgt_interval_is_empty(g)) {
        sgt_interval unused, thin = sgt_interval_of(m),
                             here = sgt_interval_difference(base_over(s, ray, t0, thin, &unused),
                                                            departure_over(s, ray, t0, thin, m, &unused));
        sgt_interval w = sgt_interval_difference(t, thin);
        if (!sgt_interval_is_empty(here))
            g = sgt_interval_intersection(g, sgt_interval_sum(here, sgt_interval_product(*slope, w)));
    }
    return g;
}

/* ----------------------------------------------------------------------------- sensitivities */

SGT_KERNEL
static void second_of(const departure_sag *s, size_t n, const double *restrict x, const double *restrict y,
                      double *restrict xx, double *restrict xy, double *restrict yy)
{
    double pxx[DEPARTURE_BLOCK], pxy[DEPARTURE_BLOCK], pyy[DEPARTURE_BLOCK];
    const double c = s->base ? s->c : 0, k = s->k;
    s->of->second(s->self, n, x, y, pxx, pxy, pyy);
    LANES for (size_t i = 0; i < n; i++) {
        base e = base_at(c, k, x[i], y[i]);
        double bent = (1 + k) * (e.by_r * e.by_r) * e.by_r;
        xx[i] = -(e.by_r + bent * (x[i] * x[i]) + pxx[i]);
        xy[i] = -(bent * (x[i] * y[i]) + pxy[i]);
        yy[i] = -(e.by_r + bent * (y[i] * y[i]) + pyy[i]);
    }
}

void sgt_departure_second(const departure_sag *s, size_t n, sgt_points at, double *const out[6])
{
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < DEPARTURE_BLOCK ? n - i : DEPARTURE_BLOCK;
        const double *x = at.p[0] + i, *y = at.p[1] + i;
        second_of(s, few, x, y, out[0] + i, out[1] + i, out[3] + i);
        for (size_t j = i; j < i + few; j++) out[2][j] = out[4][j] = out[5][j] = 0;
    }
}

static size_t of_base(const departure_sag *s) { return s->base ? (s->fixed_k ? 1 : 2) : 0; }

size_t sgt_departure_parameters(const departure_sag *s) { return of_base(s) + s->of->parameters(s->self); }

/* ds/dc = r^2 / (phi (1 + phi)), with gradient (x, y) / phi^3.  ds/dk = c^3 r^4 / (2 phi (1 + phi)^2), with
 * gradient c^3 r^2 (x, y) / (2 phi^3).  F has both with a minus sign, and so what P adds to either.
 *
 * In place: f, fx, fy hold what P adds before. */
SGT_KERNEL
static void by_base(const departure_sag *s, size_t n, bool by_c, const double *restrict x,
                    const double *restrict y, sag_values out)
{
    const double c = s->c, k = s->k;
    double *restrict f = out.p, *restrict fx = out.px, *restrict fy = out.py;
    if (by_c) {
        LANES for (size_t i = 0; i < n; i++) {
            base e = base_at(c, k, x[i], y[i]);
            double cube = 1 / (e.phi * e.phi * e.phi);
            f[i] = -(e.r2 / (e.phi * (1 + e.phi)) + f[i]);
            fx[i] = -(x[i] * cube + fx[i]), fy[i] = -(y[i] * cube + fy[i]);
        }
    } else {
        LANES for (size_t i = 0; i < n; i++) {
            base e = base_at(c, k, x[i], y[i]);
            double h = 0.5 * (c * c * c) * e.r2, bent = h / (e.phi * e.phi * e.phi);
            f[i] = -(h * e.r2 / (e.phi * (1 + e.phi) * (1 + e.phi)) + f[i]);
            fx[i] = -(x[i] * bent + fx[i]), fy[i] = -(y[i] * bent + fy[i]);
        }
    }
}

void sgt_departure_by_parameter(const departure_sag *s, size_t j, size_t n, sgt_points at, sgt_values out)
{
    size_t own = of_base(s);
    double unwanted[2][DEPARTURE_BLOCK];
    bool wanted = out.grad[0] != NULL;
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < DEPARTURE_BLOCK ? n - i : DEPARTURE_BLOCK;
        const double *x = at.p[0] + i, *y = at.p[1] + i;
        sag_values to = {out.f + i, wanted ? out.grad[0] + i : unwanted[0],
                         wanted ? out.grad[1] + i : unwanted[1]};
        if (j < own) {
            if (j == 0 && s->of->by_curvature) s->of->by_curvature(s->self, few, x, y, to);
            else for (size_t m = 0; m < few; m++) to.p[m] = to.px[m] = to.py[m] = 0;
            by_base(s, few, j == 0, x, y, to);
        } else {
            s->of->by_parameter(s->self, j - own, few, x, y, to);
            for (size_t m = 0; m < few; m++) to.p[m] = -to.p[m], to.px[m] = -to.px[m], to.py[m] = -to.py[m];
        }
        for (size_t m = 0; wanted && m < few; m++) out.grad[2][i + m] = 0;
    }
}

/* --------------------------------------------------------------------------------- parameters */

sgt_objection sgt_departure_object(const departure_sag *s)
{
    if (!(s->semi_diameter >= 0 && s->semi_diameter < HUGE_VAL))
        return (sgt_objection){"semi_diameter", "must be finite and not below 0"};
    if (s->base && !(fabs(s->c) < HUGE_VAL)) return (sgt_objection){"curvature", "must be finite"};
    if (s->base && !s->fixed_k && !(fabs(s->k) < HUGE_VAL)) return (sgt_objection){"conic", "must be finite"};
    return s->of->object(s->self);
}

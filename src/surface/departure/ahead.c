// SPDX-License-Identifier: MIT
/* ahead.c - the way of some rays from some point on: nothing is met, or one root is parted from all others.
 *
 * WHAT IS LOOKED AT is not F = z - s(x, y) but a function G of t without the root of the sag: a polynomial,
 * or one with a profile in it.  Each root of F is one of G.  G has others, on sheets that are no part of the
 * surface.  So that G has no root in a stretch says that F has none; that it has one says no more than that
 * F has one at most.  Whether it has, and where, is told by F itself (ray/lanes.c, ray/walk.c).
 *
 * THE MARCH goes from t to e = t + h, where G is at least a and b away from zero:
 *
 *     G is not 0 all over [t, e], or F has        nothing is met before e
 *     no root there for another reason
 *     like signs, s G'' <= B all over, and        the same: s G is above the parabola through both
 *     h sqrt(B / 2) < sqrt a + sqrt b             (ray/wings.c, THE MARCH)
 *     unlike signs, |G''| <= B, and               G' is (a + b) / h at least in the mean, and differs from
 *     a + b > B h^2 / 2                           that by B h / 2 at most: one root
 *     else                                        h is made shorter
 *
 * THE START.  Let |F| be at most f where the march begins, on the surface or next to it, and G = K F.  As
 * far as |G'| is between l > 0 and u, G has one root at most.  If F has it, at t* behind the start, then t*
 * <= f |K_0| / l, and |F'| = |G'| / |K| there.  So t* |F'| <= f (u / l) |K_0 / K|.  If that is less than
 * 2^-48 of the terms of the rule of the start, at t*, the root is not accepted (accept.h), and nothing else
 * is met so far.
 *
 * A step is guessed from the slope, which is not relied on.  What is known of G'' over a stretch holds in
 * each part of it.  A root of G at which F certainly has none is stepped over: all along some stretch that
 * holds it.
 *
 * ROWS.  Up to AHEAD_ROWS rays are looked along at once.  Each question (a look, the bounds over a stretch,
 * the tail, the start) is put for all of them, by loops that become vector code.  What follows from the
 * answer is each ray's own affair, and no row is read for another: a ray gets the same bits in any company.
 * Rows that are done are asked again at the same point.  After a few steps the rays that are left are given
 * back, to be put beside others (ray/vicinity.c).
 *
 * ROUNDING.  Each number is off by less than 2^-43 of the sum of the magnitudes of all that it is made of,
 * as there are at most 2^9 roundings of 2^-53, and 2^-900 for underflow.  Bounds are made wider by that, and
 * the comparisons by 2^-20.  With a NaN none of them holds. */
#include "ahead.h"

enum { AHEAD_STEPS = 4, START_STEPS = 6, PAST_STEPS = 3 }; /* of one call: see ROWS */

/* Of each ray: the point t, and the next one, h farther on; up to where the bounds hold that are in `over`,
 * and how long that stretch was. */
typedef struct march {
    ahead_row t, to, h, known_to, known;
    ahead_looks at, next;
    ahead_overs over;
    bool asked[AHEAD_ROWS];
} march;

static void take_look(ahead_looks *to, const ahead_looks *from, size_t i)
{
    to->g[i] = from->g[i], to->slope[i] = from->slope[i];
    to->err[i] = from->err[i], to->slope_err[i] = from->slope_err[i];
}

static void take_over(ahead_overs *to, const ahead_overs *from, size_t i)
{
    to->g_lo[i] = from->g_lo[i], to->g_hi[i] = from->g_hi[i], to->none[i] = from->none[i];
    to->bend_lo[i] = from->bend_lo[i], to->bend_hi[i] = from->bend_hi[i];
}

static bool any(size_t n, const bool *of)
{
    bool some = false;
    for (size_t i = 0; i < n; i++) some = some || of[i];
    return some;
}

/* |G''| at most. */
static double greatest_bend(const ahead_overs *over, size_t i)
{
    return larger(-over->bend_lo[i], over->bend_hi[i]);
}

/* G at the two ends, certainly at least this far from zero; the length; s G'' and |G''| at most.  A NaN tells
 * nothing. */
static bool stays_clear(double a, double b, double h, double most)
{
    return most <= 0 || h * sqrt(0.5 * most) * (1 + 0x1p-20) < sqrt(a) + sqrt(b);
}

static bool parted(double a, double b, double h, double most)
{
    return a + b > (0.5 + 0x1p-20) * most * h * h;
}

/* The next step, if G falls to zero at this rate, or rises (fall < 0). */
static double step_guessed(double a, double fall, double most, double bend, double room)
{
    double to_root = a / fall;
    if (fall > 0 && 3 * bend * to_root < fall && 1.25 * to_root < room) return 1.25 * to_root;
    if (!(most > 0)) return room;
    double safe = fall > 0 ? 1.8 * a / (fall + sqrt(fall * fall + 2 * most * a)) : 0.98 * sqrt(2 * a / most);
    return safe < room ? safe : room;
}

/* How far behind the first of two points of unlike signs the root is, as the parabola has it that has G at
 * both and G' at the first. */
static double root_of_ends(double a, double slope, double b, double h)
{
    double secant = h * (a / (a - b)), bend = (b - a - slope * h) / (h * h),
           root = sqrt(slope * slope - 4 * bend * a), up = copysign(root, b - a), by = -2 * a / (slope + up);
    return by > 0 && by < h ? by : secant;
}

/* G has one root between t and t + h, near t + root, where F has none.  How far behind t a stretch ends
 * that holds that root and none of F; 0: not known. */
static double past_root(const ahead_ops *ops, const void *w, const march *m, size_t i, double root)
{
    const double t = m->t[i], h = m->h[i], sign = m->at.g[i] > 0 ? 1 : -1;
    double off = 0x1p-6 * h;
    for (int k = 0; k < PAST_STEPS; k++, off *= 0x1p-6) {
        ahead_row from = {0}, to = {0};
        ahead_overs over;
        ahead_looks a, b;
        from[i] = t + larger(root - off, 0), to[i] = t + smaller(root + off, h);
        ops->over(w, i, i + 1, from, to, &over);
        if (over.none[i] == 0) continue;
        ops->at(w, i, i + 1, from, &a), ops->at(w, i, i + 1, to, &b);
        return sign * a.g[i] > a.err[i] && -sign * b.g[i] > b.err[i] ? to[i] - t : 0;
    }
    return 0;
}

/* THE START: moves the rays that begin on the surface to behind it.  Those of which that is not known are
 * asked no more. */
SGT_NOINLINE
static void leave_start(const ahead_ops *ops, const void *w, size_t n, march *m, sgt_ahead *e)
{
    const size_t rows = ahead_rows(n);
    bool starting[AHEAD_ROWS];
    ahead_row h, to, least, most;
    for (size_t i = 0; i < rows; i++) {
        starting[i] = m->asked[i] && e->f[i] < HUGE_VAL;
        h[i] = smaller(e->length[i], e->to[i] - m->t[i]), least[i] = most[i] = 0;
    }
    if (!any(n, starting)) return;
    for (int k = 0; k < START_STEPS && any(n, starting); k++) {
        ahead_overs over;
        ahead_starts start;
        bool judged[AHEAD_ROWS] = {false};
        for (size_t i = 0; i < rows; i++) to[i] = starting[i] ? m->t[i] + h[i] : m->t[i];
        ops->over(w, 0, rows, m->t, to, &over);
        for (size_t i = 0; i < n; i++) {
            if (!starting[i]) continue;
            const double slope = fabs(m->at.slope[i]), bend = greatest_bend(&over, i),
                         most_step = 0x1p-6 * slope / bend, step = most_step < h[i] ? most_step : h[i],
                         off = m->at.slope_err[i] + bend * step;
            if (!(to[i] > m->t[i] && to[i] < HUGE_VAL)) {
                starting[i] = m->asked[i] = false;
            } else if (over.none[i] != 0 || !(bend < HUGE_VAL) ||
                       (step < 0x1p-4 * h[i] && k < START_STEPS - 1)) {
                h[i] *= 0.25;
            } else {
                judged[i] = true, starting[i] = false, m->h[i] = step;
                least[i] = (slope - off) * (1 - 0x1p-20), most[i] = slope + off;
            }
        }
        if (!any(n, judged)) continue;
        ops->start(w, 0, rows, m->t, e->f, least, &start);
        for (size_t i = 0; i < n; i++) {
            if (!judged[i]) continue;
            const double terms = e->f[i] * start.ratio[i] * (most[i] / least[i]);
            m->asked[i] = least[i] > 0 && start.width[i] < m->h[i] &&
                          terms < START_ULPS * start.terms[i] * (1 - 0x1p-20) && m->h[i] > 0;
        }
    }
    for (size_t i = 0; i < n; i++) {
        if (!(e->f[i] < HUGE_VAL)) continue;
        if (starting[i]) m->asked[i] = false;
        if (m->asked[i]) e->clear[i] = m->t[i] = m->known_to[i] = m->t[i] + m->h[i];
    }
    ops->at(w, 0, rows, m->t, &m->at);
    for (size_t i = 0; i < n; i++)
        if (e->f[i] < HUGE_VAL && !(fabs(m->at.g[i]) > m->at.err[i])) m->asked[i] = false;
}

/* Asks of the rows without an end whether anything is ahead. */
SGT_NOINLINE
static void ask_tails(const ahead_ops *ops, const void *w, size_t n, march *m, sgt_ahead *e)
{
    const size_t rows = ahead_rows(n);
    ahead_row sign = {0}, none;
    for (size_t i = 0; i < rows; i++) {
        double certain = fabs(m->at.g[i]) - m->at.err[i];
        sign[i] = certain > 0 ? copysign(1, m->at.g[i]) : 0;
    }
    ops->tail(w, 0, rows, m->t, sign, none);
    for (size_t i = 0; i < n; i++)
        if (m->asked[i] && !(e->to[i] < HUGE_VAL) && none[i] != 0)
            m->asked[i] = false, e->kind[i] = AHEAD_NONE;
}

/* What the next point has shown of row i: nothing is met before it; or it parts one root from others, near
 * t + *root; else h is made shorter. */
typedef enum shown { SHORTER, MOVES, PARTED } shown;

static shown next_shows(march *m, size_t i, double *root)
{
    const double h = m->h[i], a = fabs(m->at.g[i]) - m->at.err[i], sign = m->at.g[i] > 0 ? 1 : -1,
                 b = fabs(m->next.g[i]) - m->next.err[i], g = m->next.g[i],
                 greatest = greatest_bend(&m->over, i),
                 most = sign > 0 ? m->over.bend_hi[i] : -m->over.bend_lo[i], fall = -sign * m->at.slope[i];
    const bool certain = a > 0, like = b > 0 && sign * g > 0, unlike = certain && b > 0 && sign * g < 0;
    if (m->over.none[i] != 0 || m->over.g_lo[i] > 0 || m->over.g_hi[i] < 0) return MOVES;
    if (certain && like && stays_clear(a, b, h, most)) return MOVES;
    *root = unlike ? root_of_ends(m->at.g[i], m->at.slope[i], g, h) : h;
    if (unlike && parted(a, b, h, greatest)) return PARTED;
    if (!certain || !(greatest < HUGE_VAL)) {
        m->h[i] *= 0.25;
    } else if (unlike) {
        m->h[i] = *root > 0.3 * h ? 0.8 * *root : 1.3 * *root;
    } else {
        double shorter = step_guessed(a, fall, most, greatest, h);
        m->h[i] = shorter < 0.125 * h ? 0.25 * h : shorter < 0.75 * h ? shorter : 0.5 * h;
    }
    return SHORTER;
}

/* Moves row i to its next point. */
static void move_on(march *m, size_t i, sgt_ahead *e)
{
    const double greatest = greatest_bend(&m->over, i), rest = fabs(m->next.g[i]) - m->next.err[i],
                 falls = m->next.g[i] > 0 ? -m->next.slope[i] : m->next.slope[i],
                 up = m->next.g[i] > 0 ? m->over.bend_hi[i] : -m->over.bend_lo[i];
    e->clear[i] = m->t[i] = m->to[i], take_look(&m->at, &m->next, i);
    if (!(m->t[i] < e->to[i])) {
        m->asked[i] = false, e->kind[i] = AHEAD_NONE;
        return;
    }
    m->h[i] = m->t[i] < m->known_to[i] ? m->known_to[i] - m->t[i] : 2 * m->h[i];
    if (rest > 0 && m->over.none[i] == 0 && greatest < HUGE_VAL)
        m->h[i] = step_guessed(rest, falls, up, greatest, m->h[i]);
}

/* The rows that part one root: it is ahead, or moved past, if F certainly has none there. */
SGT_NOINLINE
static void take_parted(const ahead_ops *ops, const void *w, size_t n, const bool *found, const double *root,
                        march *m, sgt_ahead *e)
{
    const size_t rows = ahead_rows(n);
    ahead_row at = {0};
    ahead_overs there;
    for (size_t i = 0; i < rows; i++) at[i] = found[i] ? m->t[i] + root[i] : m->t[i];
    ops->over(w, 0, rows, at, at, &there);
    for (size_t i = 0; i < n; i++) {
        if (!found[i]) continue;
        const double past = there.none[i] != 0 ? past_root(ops, w, m, i, root[i]) : 0;
        if (!(past > 0)) {
            e->lo[i] = m->t[i], e->hi[i] = m->to[i], e->seed[i] = at[i];
            m->asked[i] = false, e->kind[i] = AHEAD_ONE;
            continue;
        }
        if (past < m->h[i]) {
            m->to[i] = m->t[i] + past, m->h[i] = past;
            ops->at(w, i, i + 1, m->to, &m->next);
        }
        move_on(m, i, e);
    }
}

/* Chooses the next points, and asks what is known up to them.  Returns whether to look there. */
static bool next_points(const ahead_ops *ops, const void *w, size_t n, march *m, sgt_ahead *e)
{
    const size_t rows = ahead_rows(n);
    bool wants[AHEAD_ROWS] = {false}, looks = false;
    for (size_t i = 0; i < rows; i++) {
        const double t = m->t[i], end = e->to[i];
        double h = m->h[i], to = t + h;
        if (!m->asked[i]) {
            m->to[i] = t;
            continue;
        }
        if (!(to < end)) to = end, h = end - t;
        m->asked[i] = to > t && h > 0x1p-36 * fabs(t) && to < 0x1p200;
        wants[i] = m->asked[i] && (to > m->known_to[i] || 4 * h <= m->known[i]);
        m->to[i] = m->asked[i] ? to : t, m->h[i] = h;
    }
    if (any(n, wants)) {
        ahead_overs told;
        ops->over(w, 0, rows, m->t, m->to, &told);
        for (size_t i = 0; i < n; i++)
            if (wants[i]) take_over(&m->over, &told, i), m->known_to[i] = m->to[i], m->known[i] = m->h[i];
    }
    for (size_t i = 0; i < n; i++) {
        bool apart = m->over.none[i] != 0 || m->over.g_lo[i] > 0 || m->over.g_hi[i] < 0;
        looks = looks || (m->asked[i] && !(apart && m->to[i] == e->to[i]));
    }
    return looks;
}

void sgt_look_ahead(const ahead_ops *ops, const void *w, size_t n, double part, sgt_ahead *e)
{
    const size_t rows = ahead_rows(n);
    march m;
    for (size_t i = 0; i < rows; i++) {
        const double t = e->from[i], end = e->to[i];
        m.t[i] = m.to[i] = m.known_to[i] = t, m.known[i] = m.h[i] = 0;
        m.over.g_lo[i] = m.over.g_hi[i] = m.over.none[i] = m.over.bend_lo[i] = m.over.bend_hi[i] = 0;
        m.asked[i] = i < n && end > t && fabs(t) < HUGE_VAL;
        e->clear[i] = t, e->kind[i] = end == t ? AHEAD_NONE : AHEAD_OPEN;
    }
    if (!any(n, m.asked)) return;
    ops->at(w, 0, rows, m.t, &m.at);
    leave_start(ops, w, n, &m, e);
    m.next = m.at;
    for (size_t i = 0; i < n; i++) {
        m.h[i] = e->step[i] > 0 ? e->step[i] : part * (e->to[i] - m.t[i]);
        if (!(m.h[i] < HUGE_VAL)) m.h[i] = larger(4 * fabs(m.t[i] - e->start[i]), e->length[i]);
    }
    for (int k = 0; k < AHEAD_STEPS && any(n, m.asked); k++) {
        bool found[AHEAD_ROWS] = {false}, endless = false;
        ahead_row root;
        for (size_t i = 0; i < n; i++) endless = endless || (m.asked[i] && !(e->to[i] < HUGE_VAL));
        if (endless) ask_tails(ops, w, n, &m, e);
        if (next_points(ops, w, n, &m, e)) ops->at(w, 0, rows, m.to, &m.next);
        for (size_t i = 0; i < n; i++) {
            if (!m.asked[i]) continue;
            shown is = next_shows(&m, i, &root[i]);
            if (is == MOVES) move_on(&m, i, e);
            found[i] = is == PARTED;
        }
        if (any(n, found)) take_parted(ops, w, n, found, root, &m, e);
    }
    for (size_t i = 0; i < n; i++)
        if (m.asked[i]) e->kind[i] = AHEAD_MORE, e->step[i] = m.h[i];
}

// SPDX-License-Identifier: MIT
/* vicinity.c - see vicinity.h.  A single ray is a row of one. */
#include "general.h"
#include "glance.h"
#include "takeoff.h"
#include "wings.h"

#include "../surface/departure/departure.h"

enum { SHRINKS = 12, LEAST_BUDGET = 8 };

/* Takes the place of a bound on the slope that is too small: with it a root would be known less well than
 * by a look on either side. */
static const double NO_BOUND = 0x1p-1000;

/* A surface that is steeper than this within a power of two is not gentle within half of it. */
static const double STEEPEST = 0x1p64;

/* What is worked out of some rays, a row each: where the search begins; a radius for that and the seed, and
 * one for the seed alone; the rungs of the first, and of the root; and what is known within it.  axis: NULL,
 * or two rows. */
typedef struct region_rows {
    double *from, *radius, *at_seed, *wide, *about, *radius2, *steep, *low, *high, *const *axis;
} region_rows;

/* ------------------------------------------------------------------------------- rungs */

/* Works out what is known of the surface within the radius `rung`, at this place.  Nothing is if the rung is
 * infinite or the ray is not asked. */
SGT_NOINLINE
static const known_part *vicinity_within(sgt_surface s, double rung, double asked, int place,
                                         vicinities *kept)
{
    static const known_part none = {0, HUGE_VAL, -HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};
    if (!(asked != 0 && rung < HUGE_VAL)) return &none;
    sgt_extent e = SGT_NO_EXTENT;
    s.ops->own_->extent_within(s.self, rung, false, &e);
    kept->radius[place] = rung;
    kept->part[place] = (known_part){e.radius2, e.steep, e.z.lo, e.z.hi, e.axis.x, e.axis.y};
    return &kept->part[place];
}

/* Rays from afar need some five powers of two about where they begin, and as many about where they meet the
 * surface.  11 places keep both for any distance of the two, mostly; the last three are those of finer rungs,
 * too. */
enum { COARSE_PLACES = 11 };

/* Sets radius2, steep, low, high and axis within the rungs of n rays.  Of a ray that is not asked they are
 * not read. */
SGT_INLINE void extents(sgt_surface s, size_t n, const double *rung, int digits, const double *asked,
                        vicinities *kept, const region_rows *w)
{
    for (size_t i = 0; i < n; i++) {
        int place = digits == COARSE ? place_of(rung[i], COARSE, COARSE_PLACES)
                                     : place_of(rung[i], digits, VICINITIES / 2) + VICINITIES / 2;
        const known_part *e = &kept->part[place];
        if (kept->radius[place] != rung[i]) e = vicinity_within(s, rung[i], asked[i], place, kept);
        w->radius2[i] = e->radius2, w->steep[i] = e->steep, w->low[i] = e->low, w->high[i] = e->high;
        if (w->axis) w->axis[0][i] = e->steep_x, w->axis[1][i] = e->steep_y;
    }
}

/* A power of two, which most rays share, is as good where the sag is gentle. */
double sgt_steep_about(sgt_surface s, double x, double y, vicinities *kept)
{
    double r = 1.02 * radius_at(x, y, 0, 0, 0), asked = 1, steep = HUGE_VAL, unread[3];
    region_rows w = {.radius2 = &unread[0], .steep = &steep, .low = &unread[1], .high = &unread[2]};
    for (int digits = COARSE; digits >= FINE && !(steep < 2); digits -= COARSE - FINE) {
        double rung = rung_above(r, digits);
        extents(s, 1, &rung, digits, &asked, kept, &w);
    }
    return steep;
}

/* How many rows that are asked have a rung that is not in the table.  (What a table has is fetched one by one
 * in this loop and the next.) */
SGT_NOINLINE
static double slopes_missing(size_t n, const double *restrict rung, const double *restrict asked,
                             const slopes_known *table)
{
    double missing = 0;
    for (size_t i = 0; i < n; i++) {
        double kept = table->radius[place_of(rung[i], COARSE, SLOPES)],
               other = ((kept != rung[i]) & (rung[i] < HUGE_VAL)) ? 1.0 : 0.0;
        missing += asked[i] != 0 ? other : 0;
    }
    return missing;
}

SGT_NOINLINE
static void slopes_read(size_t n, const double *restrict rung, const double *restrict asked,
                        const slopes_known *table, double *restrict radius2, double *restrict steep)
{
    for (size_t i = 0; i < n; i++) {
        int k = place_of(rung[i], COARSE, SLOPES);
        double r2 = table->radius2[k], slope = table->steep[k], known = asked[i] != 0 ? rung[i] : HUGE_VAL;
        radius2[i] = known < HUGE_VAL ? r2 : 0, steep[i] = known < HUGE_VAL ? slope : HUGE_VAL;
    }
}

/* `extents` for rungs that are COARSE, without the size. */
static void slopes_of(sgt_surface s, size_t n, const double *rung, const double *asked, slopes_known *table,
                      double *radius2, double *steep)
{
    if (n > 1 && slopes_missing(n, rung, asked, table) == 0) {
        slopes_read(n, rung, asked, table, radius2, steep);
        return;
    }
    for (size_t i = 0; i < n; i++) {
        radius2[i] = 0, steep[i] = HUGE_VAL;
        if (asked[i] == 0 || !(rung[i] < HUGE_VAL)) continue;
        int k = place_of(rung[i], COARSE, SLOPES);
        if (table->radius[k] != rung[i]) {
            sgt_extent e;
            s.ops->own_->extent_within(s.self, rung[i], false, &e);
            table->radius[k] = rung[i], table->radius2[k] = e.radius2, table->steep[k] = e.steep;
        }
        radius2[i] = table->radius2[k], steep[i] = table->steep[k];
    }
}

/* Sets the noise of row i for a root whose rung is `rung`. */
SGT_INLINE void noise_about(sgt_surface s, double rung, size_t i, vicinities *kept, const vicinity *v)
{
    v->noise[0][i] = v->noise[1][i] = v->noise[2][i] = (double)NAN;
    if (!(rung < HUGE_VAL)) return;
    int k = place_of(rung, FINE, NOISES);
    double *e = kept->noise[k];
    if (kept->noise_radius[k] != rung)
        kept->noise_radius[k] = rung, s.ops->own_->noise_within(s.self, rung * (1 + 0x1p-20), e);
    v->noise[0][i] = e[0], v->noise[1][i] = e[1], v->noise[2][i] = rung * rung;
}

SGT_INLINE bool has_profile(sgt_surface s)
{
    const departure *of = s.ops->own_->departure;
    return of && of->profile;
}

/* The noise within 2^-8 beyond r.  For a sag of high powers that is a tenth of what a whole rung has. */
SGT_NOINLINE
static void noise_next_to(sgt_surface s, double r, size_t i, const vicinity *v)
{
    double e[2], within = r * (1 + 0x1p-8);
    s.ops->own_->noise_within(s.self, within * (1 + 0x1p-20), e);
    v->noise[0][i] = e[0], v->noise[1][i] = e[1], v->noise[2][i] = within * within;
}

SGT_KERNEL
static void noise_radii(size_t n, const double *restrict rung, const double *restrict asked,
                        double *restrict radius, double *restrict most2)
{
    LANES for (size_t i = 0; i < n; i++) {
        double r = chosen(MASK(asked[i] != 0), rung[i], HUGE_VAL);
        radius[i] = r * (1 + 0x1p-20), most2[i] = chosen(MASK(r < HUGE_VAL), r * r, (double)NAN);
    }
}

/* The same for all rows that are asked.  A bound at an infinite radius is not read, as most2 is NaN. */
SGT_INLINE void noises_about(sgt_surface s, size_t n, const double *rung, double *radius, vicinities *kept,
                             const vicinity *v)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    if (n > 1) noise_radii(n, rung, v->asked, radius, v->noise[2]);
    if (n > 1 && builtin->noises_within &&
        builtin->noises_within(s.self, n, radius, v->noise[0], v->noise[1])) return;
    for (size_t i = 0; i < n; i++) noise_about(s, v->asked[i] != 0 ? rung[i] : HUGE_VAL, i, kept, v);
}

/* -------------------------------------------------------------------------- the radius */

/* The radius of the seed, and somewhat more, the point from which the search begins, and the least radius for
 * both; the rungs of that radius and of the root. */
SGT_INLINE void vicinity_begin_by(size_t n, bool near, const sgt_rays *r, const vicinity *v,
                                  const region_rows *w)
{
    const double *ox = r->o[0], *oy = r->o[1], *dx = r->d[0], *dy = r->d[1], *dz = r->d[2], *tmin = v->tmin,
                 *t = v->seed;
    double *restrict at_seed = w->at_seed, *restrict from = w->from, *restrict radius = w->radius,
           *restrict wide = w->wide, *restrict about = w->about;
    LANES for (size_t i = 0; i < n; i++) {
        double seed = t[i], far = fabs(seed) * (fabs(dx[i]) + fabs(dy[i]) + fabs(dz[i])),
               axis = radius_at(ox[i], oy[i], dx[i], dy[i], seed);
        double most = 1.125 * axis + 0x1p-10 * far; /* a departure moves the root from the seed */
        double first = near ? seed : tmin[i], all = most, fine = rung_above(1.02 * axis, FINE);
        if (!near)
            all = chosen(MASK(fabs(dx[i]) + fabs(dy[i]) == 0), most,
                         larger(most, radius_at(ox[i], oy[i], dx[i], dy[i], first)));
        at_seed[i] = 1.125 * axis, from[i] = first, radius[i] = all, about[i] = fine;
        wide[i] = chosen(MASK(fine < HUGE_VAL), rung_above(all, COARSE), HUGE_VAL);
    }
}

SGT_KERNEL
static void vicinity_begin(size_t n, const sgt_rays *r, const vicinity *v, const region_rows *w)
{
    vicinity_begin_by(n, false, r, v, w);
}

SGT_KERNEL
static void vicinity_begin_near(size_t n, const sgt_rays *r, const vicinity *v, const region_rows *w)
{
    vicinity_begin_by(n, true, r, v, w);
}

/* Moves the beginning to where the ray enters [low, high], if a smaller radius is enough from there on.
 * Both ends are first moved out by far more than rounding.  Not if the ray comes from so far that an ulp of t
 * is too long for that.  The root is as far from the seed as a part of the way from the beginning, so less
 * room is needed about the seed, too.  Returns how many rays were moved. */
SGT_KERNEL
static double shrink(size_t n, const sgt_rays *ray, const vicinity *v, const region_rows *w)
{
    const double *ox = ray->o[0], *oy = ray->o[1], *oz = ray->o[2], *dx = ray->d[0], *dy = ray->d[1],
                 *dz = ray->d[2], *low = w->low, *high = w->high, *seed = v->seed, *at_seed = w->at_seed;
    double *restrict from = w->from, *restrict radius = w->radius, *restrict wide = w->wide;
    double more = 0;
#pragma omp simd reduction(+ : more)
    for (size_t i = 0; i < n; i++) {
        double t = from[i], s = larger(-low[i], high[i]), r = radius[i], rung = wide[i],
               floor = low[i] - 0x1p-10 * s, top = high[i] + 0x1p-10 * s, z = oz[i] + t * dz[i];
        double to = (chosen(MASK(dz[i] < 0), top, floor) - oz[i]) / dz[i],
               length = fabs(dx[i]) + fabs(dy[i]) + fabs(dz[i]),
               about = at_seed[i] + 0x1p-10 * (fabs(seed[i] - to) * length), /* as vicinity_begin has it */
            smaller = larger(about, radius_at(ox[i], oy[i], dx[i], dy[i], to)),
               narrow = rung_above(smaller, COARSE);
        mask sharp = MASK(fabs(oz[i]) + fabs(t * dz[i]) + fabs(to * dz[i]) < 0x1p36 * s),
             inward = (MASK(z > top) & MASK(dz[i] < 0)) | (MASK(z < floor) & MASK(dz[i] > 0));
        mask goes = sharp & inward & MASK(to > t) & MASK(narrow < rung) & MASK(fabs(dx[i]) + fabs(dy[i]) > 0);
        from[i] = chosen(goes, to, t), radius[i] = chosen(goes, smaller, r),
        wide[i] = chosen(goes, narrow, rung);
        more += chosen(goes, 1, 0);
    }
    return more;
}

/* ------------------------------------------------------------------------- the stretch */

/* Takes the bound on the slope from rays whose root may be the start itself.  Nothing would be known of what
 * is behind the chord, and a march knows how to leave.  These are the rays that start between the heights of
 * this part, and nearer to the seed than `part` of the chord. */
SGT_KERNEL
static void vicinity_leave(size_t n, double part, const sgt_rays *r, const vicinity *v, const region_rows *w,
                           const double *lo, const double *hi, double *restrict least)
{
    const double *oz = r->o[2], *dz = r->d[2], *low = w->low, *high = w->high, *tmin = v->tmin,
                 *seed = v->seed;
    LANES for (size_t i = 0; i < n; i++) {
        double z = oz[i] + tmin[i] * dz[i];
        mask starts = MASK(fabs(seed[i] - tmin[i]) < part * (hi[i] - lo[i])) & MASK(z >= low[i])
                      & MASK(z <= high[i]);
        least[i] = chosen(starts, 0, least[i]);
    }
}

/* What a look at the start of a ray has said: nothing, as there was none; F is 0 there to within 2^-32 of its
 * terms; it is not. */
enum { UNSEEN = 0, SEEN_ON, SEEN_OFF, SEEN_AHEAD, SEEN_OPEN };

/* Gives the bound back to the rays that start near the surface and not on it: before a chord there is a
 * root only if F is 0 at the start to within the rule of the start, which is far less than 2^-32 of its
 * terms; and a chord is cheaper than a march.  least: as vicinity_leave has left it; before: as it was.
 * This look chooses the way and is no step of a search: like those at heights it is not counted, and no
 * watcher is told of it. */
static void stays_off(sgt_surface s, size_t n, const sgt_rays *r, const vicinity *v, const double *seen,
                      const double *before, double *least)
{
    double *const *p = v->work + 13, *f = v->work[16], *const *g = v->work + 17, some = 0;
    for (size_t i = 0; i < n; i++) {
        least[i] = seen[i] == SEEN_OFF ? before[i] : least[i];
        some += v->asked[i] > 0 && least[i] == 0 && before[i] > 0 && seen[i] == UNSEEN;
    }
    if (some == 0) return;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) p[c][i] = moved_along(r->o[c][i], v->tmin[i], r->d[c][i]);
    s.ops->values(s.self, n, (sgt_points){{p[0], p[1], p[2]}}, (sgt_values){f, {g[0], g[1], g[2]}});
    for (size_t i = 0; i < n; i++) {
        double terms = fabs(p[0][i] * g[0][i]) + fabs(p[1][i] * g[1][i]) + fabs(p[2][i] * g[2][i]);
        if (least[i] == 0 && before[i] > 0 && fabs(f[i]) > 0x1p-32 * terms) least[i] = before[i];
    }
}

/* Of one ray: may it be one of these? */
SGT_INLINE bool starts_between(const sgt_rays *r, const vicinity *v, const region_rows *w)
{
    double z = r->o[2][0] + v->tmin[0] * r->d[2][0];
    return z >= w->low[0] && z <= w->high[0];
}

/* Accepts the chord if F is monotone on it, some of the ray is in it, and it begins before the search
 * does.  Returns how many rays are left. */
SGT_KERNEL
static double vicinity_judge(size_t n, const sgt_rays *r, const vicinity *v, const double *from,
                             const double *lo, const double *hi, const double *slope)
{
    const double *dx = r->d[0], *dy = r->d[1], *dz = r->d[2], *tmin = v->tmin, *tmax = v->tmax,
                 *seed = v->seed;
    double *restrict asked = v->asked, *restrict out_lo = v->lo, *restrict out_hi = v->hi,
           *restrict least = v->least;
    double left = 0;
#pragma omp simd reduction(+ : left)
    for (size_t i = 0; i < n; i++) {
        double scale = scale_of((sgt_vec3){dx[i], dy[i], dz[i]}), steep = slope[i];
        mask here =
            MASK(lo[i] <= seed[i]) & MASK(seed[i] <= hi[i]) & MASK(lo[i] <= tmax[i]) & MASK(hi[i] >= tmin[i]);
        mask monotone = here & MASK(steep > 0) & MASK(lo[i] <= from[i]) & MASK(asked[i] != 0);
        steep = chosen(MASK(steep < 0x1p-4 * fabs(dz[i] * scale)), NO_BOUND, steep);
        out_lo[i] = chosen(monotone, lo[i], out_lo[i]), out_hi[i] = chosen(monotone, hi[i], out_hi[i]);
        least[i] = chosen(monotone, steep, least[i]);
        double rest = chosen(monotone, 0, asked[i]);
        asked[i] = rest, left += rest;
    }
    return left;
}

/* ------------------------------------------------------------------------------- misses */

/* How many rays begin behind the seed.  (Too short a loop for tests/build/vectorised.py to judge.) */
SGT_NOINLINE
static double all_behind(size_t n, const double *restrict asked, const double *restrict seed,
                         const double *restrict tmin)
{
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) count += ((asked[i] != 0) & (seed[i] < tmin[i])) ? 1.0 : 0.0;
    return count;
}

/* Marks as misses the rays that miss the whole surface.  behind: looks at the rays that begin behind the
 * seed, which may well leave the surface, or have none; else at the others.  Of those that begin on it, and
 * so are asked only from some t on, leave_circles has asked. */
static void vicinity_without_passing(sgt_surface s, size_t n, sgt_rays r, bool behind, const double *from,
                                     vicinities *kept, const vicinity *v)
{
    for (size_t i = 0; i < n; i++) {
        if (!(v->asked[i] > 0) || behind != !(v->seed[i] >= v->tmin[i]) || from[i] > v->tmin[i]) continue;
        sgt_ray ray = ray_of(&r, i);
        ray.tmin = v->tmin[i], ray.tmax = v->tmax[i];
        if (sgt_passes_by(heights_about(s, kept), &ray, v->tmin[i]))
            v->asked[i] = 0, v->lo[i] = 1, v->hi[i] = 0;
    }
}

/* ------------------------------------------------------------------------------- leaving */

/* The rows that may start on the surface (starts_low): 1, else 0.  Returns how many there are. */
SGT_KERNEL
static double may_start(size_t n, const sgt_rays *r, const vicinity *v, double *restrict starts)
{
    const double *ox = r->o[0], *oy = r->o[1], *oz = r->o[2], *tmin = v->tmin, *asked = v->asked;
    double some = 0;
#pragma omp simd reduction(+ : some)
    for (size_t i = 0; i < n; i++) {
        bool low = fabs(oz[i]) <= 0.5 * (fabs(ox[i]) + fabs(oy[i])); /* as starts_low */
        double is = ((asked[i] > 0) & (tmin[i] == 0) & low) ? 1.0 : 0.0;
        starts[i] = is, some += is;
    }
    return some;
}

/* F at the origins: values, gradient and a bound on what is rounded, but for the departure's own noise. */
typedef struct at_starts { const double *f, *fx, *fy, *own; } at_starts;

/* What is left of these rows by F at their origins.  seen: what it says.  Returns how many. */
SGT_KERNEL
static double starts_seen(size_t n, const sgt_rays *r, const at_starts *at, double *restrict starts,
                          double *restrict seen)
{
    const double *ox = r->o[0], *oy = r->o[1], *oz = r->o[2], *f = at->f, *fx = at->fx, *fy = at->fy;
    double some = 0;
#pragma omp simd reduction(+ : some)
    for (size_t i = 0; i < n; i++) {
        double terms = fabs(ox[i] * fx[i]) + fabs(oy[i] * fy[i]) + fabs(oz[i]), may = starts[i];
        mask asked = MASK(may > 0), off = MASK(fabs(f[i]) > 0x1p-32 * terms);
        double is = chosen(off, 0, may);
        double what = chosen(off, SEEN_OFF, SEEN_ON);
        seen[i] = chosen(asked, what, UNSEEN), starts[i] = is, some += is;
    }
    return some;
}

/* The rungs of a circle about the start. */
SGT_KERNEL
static void start_rungs(size_t n, const sgt_rays *r, const double *starts, double *restrict wide)
{
    const double *ox = r->o[0], *oy = r->o[1];
    LANES for (size_t i = 0; i < n; i++) {
        double coarse = rung_above(1.125 * radius_at(ox[i], oy[i], 0, 0, 0), COARSE);
        wide[i] = chosen(MASK(starts[i] > 0), coarse, HUGE_VAL);
    }
}

/* And those of its rounding. */
SGT_KERNEL
static void start_noise_rungs(size_t n, const sgt_rays *r, const double *starts, double *restrict about)
{
    const double *ox = r->o[0], *oy = r->o[1];
    LANES for (size_t i = 0; i < n; i++) {
        double fine = rung_above(1.02 * radius_at(ox[i], oy[i], 0, 0, 0), FINE);
        about[i] = chosen(MASK(starts[i] > 0), fine, HUGE_VAL);
    }
}

/* What is left of the rows that may start on the surface: those between the heights of the circle about their
 * start.  Returns how many. */
SGT_KERNEL
static double starts_between_all(size_t n, const sgt_rays *r, const region_rows *w, double *restrict starts)
{
    const double *oz = r->o[2], *low = w->low, *high = w->high;
    double some = 0;
#pragma omp simd reduction(+ : some)
    for (size_t i = 0; i < n; i++) {
        double is = ((starts[i] > 0) & (oz[i] >= low[i]) & (oz[i] <= high[i])) ? 1.0 : 0.0;
        starts[i] = is, some += is;
    }
    return some;
}

/* And those with F monotone along the chord in it. */
SGT_KERNEL
static double starts_monotone(size_t n, const double *lo, const double *hi, const double *least,
                              double *restrict starts)
{
    double some = 0;
#pragma omp simd reduction(+ : some)
    for (size_t i = 0; i < n; i++) {
        double is = ((starts[i] > 0) & (least[i] > 0) & (lo[i] <= 0) & (hi[i] > 0)) ? 1.0 : 0.0;
        starts[i] = is, some += is;
    }
    return some;
}

/* LEAVING (vicinity.h).  Of the rows that may start on the surface: 1 in `starts` for those that do, else 0.
 * Returns how many. */
SGT_KERNEL
static double starts_within(size_t n, const sgt_rays *r, const at_starts *at, const double *const noise[3],
                        const double *least, double *restrict starts)
{
    const double *ox = r->o[0], *oy = r->o[1], *oz = r->o[2], *dx = r->d[0], *dy = r->d[1], *dz = r->d[2],
                 *f = at->f, *fx = at->fx, *fy = at->fy, *own = at->own, *e0 = noise[0], *e1 = noise[1],
                 *most2 = noise[2];
    const double off = 0x1p-40;
    double some = 0;
#pragma omp simd reduction(+ : some)
    for (size_t i = 0; i < n; i++) {
        double scale = scale_of((sgt_vec3){dx[i], dy[i], dz[i]}), steep = fabs(dz[i]) * scale,
               r2 = ox[i] * ox[i] + oy[i] * oy[i];
        double most = 2 * (1 + off) * steep - least[i],
               err = fabs(f[i]) + (own[i] + sgt_noise_at(e0[i], e1[i], most2[i], r2)),
               terms = fabs(ox[i] * fx[i]) + fabs(oy[i] * fy[i]) + fabs(oz[i]);
        double is = ((starts[i] > 0) & (err * most < 0.98 * START_ULPS * terms * least[i])) ? 1.0 : 0.0;
        starts[i] = is, some += is;
    }
    return some;
}

/* `over` is 1 where nothing is met behind the chord as far as the rings tell, else 0. */
SGT_KERNEL
static void leaves_circle(size_t n, const sgt_rays *r, const sgt_heights *g, const double *tmax,
                          const double *radius2, const double *hi, double *restrict over)
{
    const double *oz = r->o[2], *dx = r->d[0], *dy = r->d[1], *dz = r->d[2];
    const double off = 0x1p-40, width = g->width;
    LANES for (size_t i = 0; i < n; i++) over[i] = ((hi[i] >= tmax[i]) | (width > 0)) ? 1.0 : 0.0;
    for (int j = 0; j < SGT_RINGS && width > 0; j++) {
        const double in = j * width * (1 - off), out = (j + 1) * width * (1 + off), high = g->high[j],
                     low = -g->low[j];
        const bool last = g->endless && j == SGT_RINGS - 1;
        const double end = last ? HUGE_VAL : out;
        LANES for (size_t i = 0; i < n; i++) {
            double z = oz[i] + hi[i] * dz[i], lost = off * (fabs(oz[i]) + fabs(hi[i] * dz[i])),
                   from = (dz[i] > 0 ? z : -z) - lost, R = sqrt(radius2[i]),
                   q = fabs(dz[i]) / sqrt(dx[i] * dx[i] + dy[i] * dy[i]) * (1 - off),
                   least_z = from + q * larger(in - R * (1 + 0x1p-18), 0), sag = dz[i] > 0 ? high : low;
            mask past = MASK(end < R * (1 - 0x1p-18)) | MASK(sag < least_z - off * fabs(least_z)) |
                        MASK(hi[i] >= tmax[i]);
            over[i] = chosen(past, over[i], 0);
        }
    }
}

static void tell_start(const sgt_rays *r, const vicinity *v, const at_starts *at, double hi)
{
    double slope = at->fx[0] * r->d[0][0] + at->fy[0] * r->d[1][0] + r->d[2][0];
    tell(v->told, SGT_MARCH, 0, at->f[0], slope, 0, hi);
}

/* Answers the rays that start on the surface and meet nothing more, as misses, and sets from[i] to a t up to
 * which nothing is met, for others that start on it.  seen: what a look at the origin says.  Returns whether
 * any is a miss. */
SGT_NOINLINE
static bool leave_circles(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *whole, vicinities *kept,
                          const vicinity *v, double *from, double *seen)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    double *const both[2] = {v->work[8], v->work[9]}, *const *axis = whole->by_axis ? both : NULL;
    const double *const read[2] = {both[0], both[1]};
    const region_rows w = {.wide = v->work[3], .low = v->work[4], .steep = v->work[5], .radius2 = v->work[6],
                           .about = v->work[7], .high = v->work[10], .axis = axis};
    double *starts = v->work[0], *lo = v->work[1], *hi = v->work[11], *least = v->work[2],
           *over = v->work[12], *const *rows = v->work + 13;
    if (v->budget < LEAST_BUDGET || may_start(n, &r, v, starts) == 0) return false;
    start_rungs(n, &r, starts, w.wide);
    extents(s, n, w.wide, COARSE, starts, kept, &w);
    if (starts_between_all(n, &r, &w, starts) == 0) return false;
    const sgt_shared bare = bare_of(*whole);
    if (!builtin->values_rounded(s.self, &bare, NULL, n, (sgt_points){{r.o[0], r.o[1], r.o[2]}},
                                 (sgt_values){rows[0], {rows[1], rows[2], rows[3]}}, rows[4]))
        return false;
    const at_starts at = {rows[0], rows[1], rows[2], rows[4]};
    if (starts_seen(n, &r, &at, starts, seen) == 0) return false;
    builtin->chords(n, r, w.radius2, w.steep, axis ? read : NULL, lo, hi, least);
    if (starts_monotone(n, lo, hi, least, starts) == 0) return false;
    start_noise_rungs(n, &r, starts, w.about);
    const vicinity near = {.asked = starts, .noise = {v->noise[0], v->noise[1], v->noise[2]}};
    noises_about(s, n, w.about, v->work[9], kept, &near);
    const double *const noise[3] = {v->noise[0], v->noise[1], v->noise[2]};
    if (starts_within(n, &r, &at, noise, least, starts) == 0) return false;
    leaves_circle(n, &r, heights_about(s, kept), v->tmax, w.radius2, hi, over);
    bool some = false;
    for (size_t i = 0; i < n; i++) {
        if (starts[i] != 1) continue;
        double clear = hi[i];
        v->evals[i] += 1;
        if (v->told) tell_start(&r, v, &at, hi[0]);
        if (over[i] == 0 && !has_profile(s)) { /* that says more */
            sgt_ray ray = ray_of(&r, i);
            ray.tmin = v->tmin[i], ray.tmax = v->tmax[i];
            clear = sgt_clear_by_heights(heights_about(s, kept), &ray, clear);
        }
        from[i] = clear;
        if (over[i] > 0 || clear == HUGE_VAL || clear > v->tmax[i])
            v->asked[i] = 0, v->lo[i] = 1, v->hi[i] = 0, some = true;
    }
    return some;
}

/* How many rows the profile is asked of before all else: those that leave the surface, and those that come
 * from afar, where a circle says nothing. */
SGT_NOINLINE
static double early(sgt_surface s, size_t n, const sgt_rays *r, const vicinity *v,
                    const double *restrict from)
{
    const bool far = !s.ops->own_->departure->heights_first;
    double count = 0;
    for (size_t i = 0; i < n; i++) count += sgt_early(r, v, from, far, i) ? 1.0 : 0.0;
    return count;
}

/* How many rays are still to be looked at. */
static double asked_all(size_t n, const double *asked)
{
    double count = 0;
    for (size_t i = 0; i < n; i++) count += larger(asked[i], 0);
    return count;
}

/* Few rays need these, and no others pay for `bare`. */
SGT_NOINLINE
static void march_wings(sgt_surface s, size_t n, sgt_rays r, const double *from, bool behind,
                        const sgt_shared *whole, vicinities *kept, const vicinity *v)
{
    sgt_shared bare = bare_of(*whole);
    sgt_march_wings(s, n, r, from, behind, &bare, kept, v);
}

SGT_NOINLINE
static void march_box(sgt_surface s, size_t n, sgt_rays r, const double *from, const sgt_shared *whole,
                      vicinities *kept, const vicinity *v)
{
    sgt_shared bare = bare_of(*whole);
    sgt_march_box(s, n, r, from, &bare, kept, v);
}

/* Most rays are answered by looks at the start or beside the root; the others are marched along. */
static void along_chord_bent(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *whole, const vicinity *v)
{
    const unsigned long long begun = sgt_take_off(s, n, r, whole, v);
    if (asked_all(n, v->asked) == 0 || (v->told && v->told->stopped)) return;
    sgt_glance_chord(s, n, r, whole, v);
    if (asked_all(n, v->asked) == 0 || (v->told && v->told->stopped)) return;
    sgt_march_chord(s, n, r, whole, v);
    for (size_t i = 0; i < n; i++)
        if ((begun >> i & 1) && v->asked[i] != 0) v->lo[i] = v->tmin[i];
}

/* Where the surface may be bent either way, as far as the sum of its terms' bounds tells, these looks tell
 * less.  There more is asked of it. */
SGT_NOINLINE
static void along_chord_sharply(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *whole,
                                vicinities *kept, const vicinity *v)
{
    sgt_shared sharp = *whole;
    if (!kept->any_bent && !s.ops->own_->bent(s.self, &kept->bent)) kept->bent = whole->bent;
    kept->any_bent = true;
    if (kept->bent.lo > sharp.bent.lo) sharp.bent.lo = kept->bent.lo;
    if (kept->bent.hi < sharp.bent.hi) sharp.bent.hi = kept->bent.hi;
    along_chord_bent(s, n, r, &sharp, v);
}

static void along_chord(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *whole, vicinities *kept,
                        const vicinity *v)
{
    const bool either = whole->bent.lo < 0 && whole->bent.hi > 0;
    if (either && s.ops->own_->bent) along_chord_sharply(s, n, r, whole, kept, v);
    else along_chord_bent(s, n, r, whole, v);
}

/* Puts a ray, and that it is asked from `from` on, into row j.  step: as in sgt_ahead. */
static void ahead_put(const sgt_ray *ray, double from, double step, sgt_ahead *e, size_t j)
{
    const sgt_vec3 o = ray->o, d = ray->d;
    e->o[0][j] = o.x, e->o[1][j] = o.y, e->o[2][j] = o.z;
    e->d[0][j] = d.x, e->d[1][j] = d.y, e->d[2][j] = d.z;
    e->start[j] = ray->tmin, e->from[j] = from, e->to[j] = ray->tmax, e->f[j] = HUGE_VAL;
    e->step[j] = step;
    e->length[j] = (fabs(o.x) + fabs(o.y) + fabs(o.z)) / (fabs(d.x) + fabs(d.y) + fabs(d.z));
}

/* Sets f of the rows that begin on the surface. */
static void ahead_starts_at(sgt_surface s, size_t n, sgt_ahead *e)
{
    ahead_row f, unread[3];
    bool some = false, low[AHEAD_ROWS];
    for (size_t j = 0; j < n; j++) {
        const sgt_vec3 o = {e->o[0][j], e->o[1][j], e->o[2][j]};
        low[j] = e->from[j] == 0 && e->step[j] == 0 && starts_low(o, e->start[j]), some = some || low[j];
    }
    if (!some) return;
    s.ops->values(s.self, n, (sgt_points){{e->o[0], e->o[1], e->o[2]}},
                  (sgt_values){f, {unread[0], unread[1], unread[2]}});
    for (size_t j = 0; j < n; j++) {
        const sgt_vec3 o = {e->o[0][j], e->o[1][j], e->o[2][j]};
        const double most = START_ULPS * (fabs(o.x) + fabs(o.y) + fabs(o.z));
        if (!(low[j] && fabs(f[j]) <= most)) continue;
        f[j] = fabs(f[j]) + s.ops->rounding(s.self, o);
        if (f[j] <= most) e->f[j] = f[j];
    }
}

enum { AHEAD_PASSES = 16 };

bool sgt_nothing_ahead(sgt_surface s, const sgt_ray *ray)
{
    sgt_ahead e;
    if (!(fabs(ray->tmin) < HUGE_VAL)) return false;
    ahead_put(ray, ray->tmin, 0, &e, 0), ahead_starts_at(s, 1, &e);
    s.ops->own_->ahead(s.self, 1, &e);
    for (int k = 1; k < AHEAD_PASSES && e.kind[0] == AHEAD_MORE; k++) {
        ahead_put(ray, e.clear[0], e.step[0], &e, 0);
        s.ops->own_->ahead(s.self, 1, &e);
    }
    return e.kind[0] == AHEAD_NONE;
}

/* Rows of look_ahead: from where a ray is asked next, and with which step. */
typedef struct ahead_state {
    double *from, *seen, *at, *step;
} ahead_state;

/* Asks of n rows of `of` what is ahead.  Rows that are left over repeat the first ray.  Those that are to
 * be asked again are put into `again`, with `at` and `step` set; returns how many. */
static size_t look_some(sgt_surface s, const sgt_rays *r, const unsigned char *of, size_t n,
                        const vicinity *v, ahead_state a, unsigned char *again)
{
    sgt_ahead e;
    size_t more = 0;
    for (size_t j = 0; j < (n > 1 ? AHEAD_ROWS : 1); j++) {
        const size_t i = of[j < n ? j : 0];
        sgt_ray ray = ray_of(r, i);
        ray.tmin = v->tmin[i], ray.tmax = v->tmax[i];
        ahead_put(&ray, a.at[i], a.step[i], &e, j);
    }
    ahead_starts_at(s, n, &e);
    s.ops->own_->ahead(s.self, n, &e);
    for (size_t j = 0; j < n; j++) {
        const size_t i = of[j];
        switch (e.kind[j]) {
        case AHEAD_MORE: again[more++] = of[j], a.at[i] = e.clear[j], a.step[i] = e.step[j]; break;
        case AHEAD_OPEN: /* on a way without an end the rest may be known better from where it was asked */
            if (e.to[j] < HUGE_VAL) a.from[i] = larger(a.from[i], e.clear[j]);
            break;
        case AHEAD_NONE: v->asked[i] = 0, v->lo[i] = 1, v->hi[i] = 0; break;
        case AHEAD_ONE:
            v->asked[i] = 0, v->lo[i] = e.lo[j], v->hi[i] = e.hi[j], v->least[i] = NO_BOUND;
            v->seed[i] = e.seed[j], a.seen[i] = a.seen[VICINITY_MOST] = SEEN_AHEAD;
            break;
        }
    }
    return more;
}

/* Asks that of rows: of those only that leave the surface, by their seed or by a look, or have no seed; or
 * of all. What is not known begins later, perhaps.  Marks in `seen` those whose root is parted from
 * others.  F is not asked for, but at starts: this is not counted, and no watcher is told of it.  Rays that
 * need more steps than most are put side by side again. */
SGT_NOINLINE
static void look_ahead(sgt_surface s, size_t n, const sgt_rays *r, bool all, const vicinity *v, double *from,
                       double *seen)
{
    unsigned char of[VICINITY_MOST];
    double at[VICINITY_MOST], step[VICINITY_MOST];
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        const bool leaves = from[i] > v->tmin[i] || seen[i] == SEEN_ON || !(v->seed[i] >= v->tmin[i]);
        if (v->asked[i] > 0 && (all || leaves)) of[count++] = (unsigned char)i, at[i] = from[i], step[i] = 0;
    }
    for (int k = 0; k < AHEAD_PASSES && count > 0; k++) {
        size_t left = 0;
        for (size_t j = 0, few; j < count; j += few) {
            few = count - j < AHEAD_ROWS ? count - j : AHEAD_ROWS;
            left += look_some(s, r, of + j, few, v, (ahead_state){from, seen, at, step}, of + left);
        }
        count = left;
    }
}

/* Marks the rows at whose start F is 0 to within 2^-32 of its terms. */
SGT_NOINLINE
static void see_starts(sgt_surface s, size_t n, const sgt_rays *r, const vicinity *v, double *seen)
{
    for (size_t i = 0; i < n; i++) {
        const sgt_vec3 o = {r->o[0][i], r->o[1][i], r->o[2][i]};
        sgt_vec3 g;
        if (!(v->asked[i] > 0 && starts_low(o, v->tmin[i]))) continue;
        double f = s.ops->value(s.self, o, &g);
        if (fabs(f) <= 0x1p-32 * (fabs(o.x * g.x) + fabs(o.y * g.y) + fabs(o.z * g.z))) seen[i] = SEEN_ON;
    }
}

/* How many rows leave, as look_ahead has it. */
SGT_NOINLINE
static double all_leaving(size_t n, const vicinity *v, const double *restrict from,
                          const double *restrict seen)
{
    const double *seed = v->seed, *tmin = v->tmin, *asked = v->asked;
    double count = 0;
    for (size_t i = 0; i < n; i++) {
        bool leaves = (from[i] > tmin[i]) | (seen[i] == SEEN_ON) | !(seed[i] >= tmin[i]);
        count += ((asked[i] > 0) & leaves) ? 1.0 : 0.0;
    }
    return count;
}

/* Rows without a seed are asked for that alone. */
static void park(size_t n, const vicinity *v, double *seen)
{
    for (size_t i = 0; i < n; i++)
        if (v->asked[i] > 0 && !(fabs(v->seed[i]) < HUGE_VAL))
            v->asked[i] = 0, seen[i] = seen[VICINITY_MOST] = SEEN_OPEN;
}

/* The noise at the roots that a march has found. */
static void noises_of_marched(sgt_surface s, size_t n, const sgt_rays *r, bool profiled, vicinities *kept,
                              const vicinity *v, const double *seen)
{
    for (size_t i = 0; i < n; i++) {
        bool monotone = v->asked[i] < 0;
        if (monotone) v->asked[i] = 0;
        /* the rays that a march has answered: what their neighbours need is no matter */
        const bool marched = v->evals[i] > (v->begun ? v->begun[i] : 0) || monotone;
        if (!(marched && v->asked[i] == 0 && v->lo[i] <= v->hi[i]) || seen[i] >= SEEN_AHEAD) continue;
        double off = radius_at(r->o[0][i], r->o[1][i], r->d[0][i], r->d[1][i], v->seed[i]);
        noise_about(s, rung_above(1.02 * off, FINE), i, kept, v);
        /* Far out a bound for the whole rung may be 10^7 times that at the root.  Where t would then be known
         * to less than 2^-40 of it, more is asked: of a profile the noise next to r; if that is too much, the
         * noise at the point, which costs two looks. */
        const sgt_vec3 d = {r->d[0][i], r->d[1][i], r->d[2][i]};
        const double enough = 0x1p-40 * v->least[i] * fabs(v->seed[i]) * inverse_of_scale(d);
        if (profiled && v->noise[0][i] + v->noise[1][i] * (off * off) > enough) noise_next_to(s, off, i, v);
        if (v->noise[0][i] + v->noise[1][i] * (off * off) > enough) noise_about(s, HUGE_VAL, i, kept, v);
    }
}

static void vicinity_of_rows(sgt_surface s, size_t n, sgt_rays r, slopes_known *near,
                             const sgt_shared *whole, vicinities *kept, const vicinity *v, double *seen)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    const bool chords = !near && marches_chord(whole), rimmed = chords && rim2_of_surface(s) < HUGE_VAL;
    double from[VICINITY_MOST];
    if (chords && whole->ahead) {
        memcpy(from, v->tmin, n * sizeof *from);
        see_starts(s, n, &r, v, seen);
        look_ahead(s, n, &r, false, v, from, seen);
        if (asked_all(n, v->asked) == 0) return;
    }
    if (rimmed) { /* what is left has no F on a part of its chord */
        along_chord(s, n, r, whole, kept, v);
        if (asked_all(n, v->asked) == 0) return;
    }
    const bool marches = !near && builtin->roundings && !(whole->noise[0] < HUGE_VAL),
               boxes = marches && whole->by_axis, profiled = marches && has_profile(s);
    const bool asks = marches && whole->ahead;
    memcpy(from, v->tmin, n * sizeof *from);
    if (marches && (n > 1 || starts_low((sgt_vec3){r.o[0][0], r.o[1][0], r.o[2][0]}, v->tmin[0])) &&
        leave_circles(s, n, r, whole, kept, v, from, seen) && asked_all(n, v->asked) == 0)
        return;
    if (asks_ahead(whole, near) && all_leaving(n, v, from, seen) > 0) {
        if (asks) vicinity_without_passing(s, n, r, true, from, kept, v);
        if (asks) look_ahead(s, n, &r, false, v, from, seen);
        if (asks && v->clear) v->clear[0] = larger(v->clear[0], from[0]);
        park(n, v, seen);
        if (asked_all(n, v->asked) == 0) { /* rows that were not asked have no bound, too */
            for (size_t i = 0; i < n; i++) noise_about(s, HUGE_VAL, i, kept, v);
            return;
        }
    }
    const bool behind = n == 1 ? v->seed[0] < v->tmin[0] : all_behind(n, v->asked, v->seed, v->tmin) > 0;
    if (behind && profiled && builtin->departure->heights_first)
        vicinity_without_passing(s, n, r, true, from, kept, v);
    const bool looked = profiled && early(s, n, &r, v, from) > 0;
    if (looked) {
        sgt_begin_by_profile(s, n, &r, from, kept, v);
        if (asked_all(n, v->asked) == 0) {
            for (size_t i = 0; i < n; i++) noise_about(s, HUGE_VAL, i, kept, v);
            noises_of_marched(s, n, &r, profiled, kept, v, seen);
            return;
        }
    }
    if (behind) {
        if (!profiled) vicinity_without_passing(s, n, r, true, from, kept, v);
        if (marches && whole->radius2 < HUGE_VAL) march_wings(s, n, r, from, true, whole, kept, v);
    }
    double *const both[2] = {v->work[8], v->work[9]}, *const *axis = whole->by_axis ? both : NULL;
    const region_rows w = {.at_seed = v->work[0], .from = v->work[1], .radius = v->work[2],
                           .wide = v->work[3], .low = v->work[4], .steep = v->work[5], .radius2 = v->work[6],
                           .about = v->work[7], .high = v->work[10], .axis = axis};
    const double *const read[2] = {both[0], both[1]};
    (near ? vicinity_begin_near : vicinity_begin)(n, &r, v, &w);
    if (!(whole->noise[0] < HUGE_VAL)) noises_about(s, n, w.about, v->work[8], kept, v);
    else /* the whole surface has one bound */
        for (size_t i = 0; i < n; i++) noise_about(s, HUGE_VAL, i, kept, v);
    const bool known = near && !axis;
    if (known) slopes_of(s, n, w.wide, v->asked, near, w.radius2, w.steep);
    for (int k = 0; !known; k++) {
        extents(s, n, w.wide, COARSE, v->asked, kept, &w);
        if (near || k == SHRINKS || shrink(n, &r, v, &w) == 0) break;
    }
    double *lo = w.at_seed, *hi = v->work[11], *before = v->work[12], *least = w.about, left = 0;
    for (int k = 0; k < 2; k++) {
        builtin->chords(n, r, w.radius2, w.steep, axis ? read : NULL, lo, hi, least);
        /* without a box the march costs more than a chord: it is for rays that start on the surface */
        const bool leaving = marches && (n > 1 || starts_between(&r, v, &w));
        if (leaving) {
            memcpy(before, least, n * sizeof *least);
            vicinity_leave(n, boxes ? 0.25 : 0x1p-5, &r, v, &w, lo, hi, least);
            if (!boxes) stays_off(s, n, &r, v, seen, before, least);
        }
        left = vicinity_judge(n, &r, v, w.from, lo, hi, least);
        if (left == 0 || k == 1 || boxes) break; /* a box says as much as a smaller circle */
        /* A smaller circle says no more where the ray starts on the surface, where the surface is steep all
         * over the circle, or where the smaller one reaches beyond its edge. */
        for (size_t i = 0; i < n; i++) {
            const double wide = w.wide[i], edge2 = w.radius2[i], fine = rung_above(w.radius[i], FINE);
            const bool starts = leaving && before[i] > 0 && least[i] == 0,
                       all = edge2 >= 0.99 * wide * wide, beyond = fine * fine > 1.01 * edge2,
                       steep = !(w.steep[i] <= STEEPEST) && (all || beyond);
            w.wide[i] = starts || steep ? HUGE_VAL : fine;
        }
        extents(s, n, w.wide, FINE, v->asked, kept, &w);
    }
    if (left != 0 && chords) {
        if (!rimmed) along_chord(s, n, r, whole, kept, v);
        return;
    }
    const bool boxed = left != 0 && boxes;
    if (boxed) {
        march_box(s, n, r, w.from, whole, kept, v);
        left = asked_all(n, v->asked);
    }
    if (left != 0 && !near && !profiled) vicinity_without_passing(s, n, r, false, from, kept, v);
    if (!marches || !(left != 0 || behind || boxed || looked)) return;
    if (v->clear && !boxed) v->clear[0] = larger(v->clear[0], larger(from[0], w.from[0]));
    /* the march through the box has used the rows of `from` */
    for (size_t i = 0; i < n && !boxed; i++) from[i] = larger(from[i], w.from[i]);
    if (left != 0 && asks) {
        look_ahead(s, n, &r, true, v, from, seen);
        left = asked_all(n, v->asked);
        if (v->clear) v->clear[0] = larger(v->clear[0], from[0]);
    }
    if (left != 0) march_wings(s, n, r, from, false, whole, kept, v);
    noises_of_marched(s, n, &r, profiled, kept, v, seen);
}

void sgt_vicinity_of(sgt_surface s, size_t n, sgt_rays r, slopes_known *near, const sgt_shared *whole,
                     vicinities *kept, const vicinity *v)
{
    double seen[VICINITY_MOST + 1]; /* the last: of any */
    memset(seen, 0, n * sizeof *seen);
    seen[VICINITY_MOST] = UNSEEN;
    vicinity_of_rows(s, n, r, near, whole, kept, v, seen);
    /* a root ahead: `rounding` is asked at the very point */
    for (size_t i = 0; i < n && seen[VICINITY_MOST] != UNSEEN; i++) {
        if (seen[i] == SEEN_AHEAD) noise_about(s, HUGE_VAL, i, kept, v);
        if (seen[i] == SEEN_OPEN) v->asked[i] = 1;
    }
}

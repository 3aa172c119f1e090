/* vicinity.c - see vicinity.h. */
#include "vicinity.h"

#include <string.h>

enum { SHRINKS = 12 };

/* In place of a bound of the slope by which a root would be known less well than by a look on either side. */
static const double NO_BOUND = 0x1p-1000;

typedef struct rung { double radius; int place; } rung;

/* A power of two above r, or an eighth of one; infinite beyond 2^400, and never below 2^-400. */
static rung rung_of(double r, bool fine)
{
    if (!(r < 0x1p400)) return (rung){HUGE_VAL, 0};
    r = larger(r, 0x1p-401);
    double below = inverse_of_scale((sgt_vec3){r, 0, 0});
    int eighths = fine ? (int)(8 * (r / below)) + 1 : 16; /* 9 ... 16 */
    unsigned long long bits;
    memcpy(&bits, &below, sizeof bits);
    int power = (int)(bits >> 52);
    return (rung){below * (0.125 * eighths), (fine ? 8 * power + eighths : power) % VICINITIES};
}

/* Made that of the surface within the radius. */
static void within(sgt_surface s, rung r, vicinities *kept, sgt_shared *shared)
{
    int i = r.place;
    if (kept->radius[i] != r.radius) {
        sgt_shared own;
        s.ops->own_->share_within(s.self, r.radius, &own);
        kept->radius[i] = r.radius, kept->radius2[i] = own.radius2, kept->steep[i] = own.steep, kept->size[i] = own.size;
    }
    shared->radius2 = kept->radius2[i], shared->steep = kept->steep[i], shared->size = kept->size[i];
}

static void noise_near(sgt_surface s, rung r, vicinities *kept, double noise[3])
{
    double *e = kept->noise[r.place], radius = r.radius * (1 + 0x1p-20);
    if (kept->noise_radius[r.place] != r.radius) kept->noise_radius[r.place] = r.radius, s.ops->own_->noise_within(s.self, radius, e);
    noise[0] = e[0], noise[1] = e[1], noise[2] = r.radius * r.radius;
}

/* Not below it: of a ray from afar x and y are known to an ulp of what they are made of. */
static double radius_at(const sgt_ray *ray, double t)
{
    double tl = t * ray->d.x, tm = t * ray->d.y, x = ray->o.x + tl, y = ray->o.y + tm;
    return sqrt(x * x + y * y) + 0x1p-51 * ((fabs(ray->o.x) + fabs(tl)) + (fabs(ray->o.y) + fabs(tm)));
}

/* Where the ray, from t on, enters |z| <= size, made larger by far more than rounding; t itself where it is inside, or leaves,
 * or is from so far that an ulp of t is too long for that. */
static double entry_of(const sgt_ray *ray, double t, double size)
{
    double thick = size * (1 + 0x1p-10), z = ray->o.z + t * ray->d.z, from = z < 0 ? -thick : thick, to = (from - ray->o.z) / ray->d.z;
    bool sharp = fabs(ray->o.z) + fabs(t * ray->d.z) + fabs(to * ray->d.z) < 0x1p36 * size;
    return sharp && fabs(z) > thick && z * ray->d.z < 0 && to > t ? to : t;
}

/* Is F monotone on the chord within that radius, is some of the ray there, and does it begin before `from`? */
static bool monotone_within(sgt_surface s, const sgt_ray *ray, double from, double seed, const sgt_shared *shared, vicinity *v)
{
    sgt_span chord = s.ops->own_->span(s.self, shared, ray, &v->least);
    bool here = chord.lo <= seed && seed <= chord.hi && chord.lo <= ray->tmax && chord.hi >= ray->tmin;
    v->lo = chord.lo, v->hi = chord.hi;
    double scale = scale_of(ray->d);
    if (v->least > 0 && v->least < 0x1p-4 * fabs(ray->d.z * scale)) v->least = NO_BOUND;
    return v->monotone = chord.single && v->least > 0 && chord.lo <= from && here;
}

vicinity sgt_vicinity_of(sgt_surface s, const sgt_shared *whole, const sgt_ray *ray, double seed, bool near, vicinities *kept)
{
    vicinity v = {.monotone = false, .noise = {(double)NAN, (double)NAN, (double)NAN}};
    bool along = ray->d.x == 0 && ray->d.y == 0;
    double from = near ? seed : ray->tmin, far = fabs(seed) * (fabs(ray->d.x) + fabs(ray->d.y) + fabs(ray->d.z)), axis = radius_at(ray, seed);
    sgt_shared shared = *whole;
    rung about = rung_of(1.02 * axis, true);
    if (!(about.radius < HUGE_VAL)) return v;
    noise_near(s, about, kept, v.noise);
    double at_seed = 1.125 * axis + 0x1p-10 * far; /* a departure moves the root from the seed */
    double radius = near || along ? at_seed : larger(at_seed, radius_at(ray, from));
    rung wide = rung_of(radius, false);
    for (int i = 0; i < SHRINKS && !near && !along && wide.radius < HUGE_VAL; i++) {
        within(s, wide, kept, &shared);
        double entry = entry_of(ray, from, shared.size), smaller = larger(at_seed, radius_at(ray, entry));
        rung narrow = rung_of(smaller, false);
        if (!(entry > from && narrow.radius < wide.radius)) break;
        from = entry, radius = smaller, wide = narrow;
    }
    if (!(wide.radius < HUGE_VAL)) return v;
    within(s, wide, kept, &shared);
    if (monotone_within(s, ray, from, seed, &shared, &v)) return v;
    within(s, rung_of(radius, true), kept, &shared);
    monotone_within(s, ray, from, seed, &shared, &v);
    return v;
}

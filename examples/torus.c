/* torus.c - every root on a ray, and what a surface's answers let the library claim.
 *
 * A thin torus is asked three times: by its value alone, with a clearance (how far away is it
 * for certain?), and with an enclosure (between which numbers is F over a stretch of the ray?).
 * One ray crosses the tube twice, two pass it by. */
#include <sagitta/sagitta.h>

#include <math.h>
#include <stdio.h>

typedef struct torus { double major, minor; } torus;

/* The distance from the circle in the middle of the tube, less the tube's radius: negative inside. */
static double torus_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const torus *s = self;
    double axis = sqrt(p.x * p.x + p.y * p.y), off = axis - s->major, circle = sqrt(off * off + p.z * p.z);
    if (grad) *grad = (sgt_vec3){off * p.x / (axis * circle), off * p.y / (axis * circle), p.z / circle};
    return circle - s->minor;
}

/* No more than 8 roundings of terms that add up to this. */
static double torus_rounding(const void *self, sgt_vec3 p)
{
    const torus *s = self;
    return 8 * 0x1p-53 * (fabs(p.x) + fabs(p.y) + fabs(p.z) + s->major + s->minor);
}

/* F is the distance itself, so this is it, less what rounding can have added. */
static double torus_clearance(const void *self, sgt_vec3 p)
{
    return fabs(torus_value(self, p, NULL)) - torus_rounding(self, p);
}

/* Interval arithmetic.  An end is rounded to nearest: the next double outward is far enough. */
static sgt_interval outward(double lo, double hi) { return (sgt_interval){nextafter(lo, -HUGE_VAL), nextafter(hi, HUGE_VAL)}; }

static sgt_interval number(double x) { return (sgt_interval){x, x}; }

static sgt_interval sum(sgt_interval a, sgt_interval b) { return outward(a.lo + b.lo, a.hi + b.hi); }

static sgt_interval product(sgt_interval a, sgt_interval b)
{
    double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    return outward(fmin(fmin(p, q), fmin(r, s)), fmax(fmax(p, q), fmax(r, s)));
}

/* sqrt(a^2 + b^2); a square is least where its root is nearest zero. */
static sgt_interval length(sgt_interval a, sgt_interval b)
{
    double a0 = a.lo > 0 ? a.lo : a.hi < 0 ? a.hi : 0, a1 = fmax(-a.lo, a.hi);
    double b0 = b.lo > 0 ? b.lo : b.hi < 0 ? b.hi : 0, b1 = fmax(-b.lo, b.hi);
    sgt_interval least = sum(product(number(a0), number(a0)), product(number(b0), number(b0)));
    sgt_interval most = sum(product(number(a1), number(a1)), product(number(b1), number(b1)));
    return outward(sqrt(fmax(least.lo, 0)), sqrt(most.hi));
}

/* The formulas of the value and of its derivative along the ray, with intervals in place of numbers. */
static sgt_interval torus_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const torus *s = self;
    sgt_interval dx = number(ray->d.x), dy = number(ray->d.y), dz = number(ray->d.z);
    sgt_interval x = sum(number(ray->o.x), product(t, dx)), y = sum(number(ray->o.y), product(t, dy));
    sgt_interval z = sum(number(ray->o.z), product(t, dz)), axis = length(x, y);
    sgt_interval off = sum(axis, number(-s->major)), circle = length(off, z);
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL}; /* on the axis, and in the middle of the tube */
    if (axis.lo > 0 && circle.lo > 0) {
        sgt_interval outer = product(sum(product(x, dx), product(y, dy)), outward(1 / axis.hi, 1 / axis.lo));
        *slope = product(sum(product(off, outer), product(z, dz)), outward(1 / circle.hi, 1 / circle.lo));
    }
    return sum(circle, number(-s->minor));
}

/* One surface that says more and more of itself. */
static const sgt_surface_ops torus_ops[] = {
    {.name = "value", .value = torus_value, .rounding = torus_rounding},
    {.name = "value and clearance", .value = torus_value, .rounding = torus_rounding, .clearance = torus_clearance},
    {.name = "value and enclose", .value = torus_value, .rounding = torus_rounding, .enclose = torus_enclose},
};
static const char *const claim[] = {
    "what steps of 1/64 of the stretch can see; finding nothing is no miss",
    "none missed but in stretches below 2^-20 of the whole",
    "none missed",
};

enum { MOST = 8 };

/* Every entry on the ray, printed. */
static int print_all(const sgt_surface_ops *ops, const torus *shape, sgt_ray ray, sgt_hit hits[MOST])
{
    int count = sgt_intersect_all((sgt_surface){ops, shape}, ray, MOST, hits, NULL);
    if (count == 0) printf("    miss\n");
    for (int i = 0; i < count && i < MOST; i++) {
        const sgt_hit *h = &hits[i];
        double slope = h->n.x * ray.d.x + h->n.y * ray.d.y + h->n.z * ray.d.z; /* n . d */
        if (h->status == SGT_HIT)
            printf("    %s at t = %.15f, right within %.1g, %d evaluations\n", slope < 0 ? "enters" : "leaves", h->t, h->t_err, h->evals);
        else
            printf("    %s, t from %g to %g\n", sgt_status_text(h->status), h->lo, h->hi);
    }
    return count;
}

int main(void)
{
    const torus shape = {.major = 1, .minor = 0.001};
    const sgt_ray across = {.o = {-5, 0.9, 0.0004}, .d = {1, 0, 0}, .tmin = 0, .tmax = 10};
    sgt_ray past = across, near = across;
    past.o.z = 0.002;    /* one radius above the tube */
    near.o.z = 0.001001; /* 1e-6 above it */
    int wrong = 0;

    for (int i = 0; i < 3; i++) {
        sgt_hit hits[MOST];
        printf("%s: %s\n  across the tube, twice\n", torus_ops[i].name, claim[i]);
        int count = print_all(&torus_ops[i], &shape, across, hits);
        wrong += i == 0 ? count != 1 || hits[0].status != SGT_UNPROVEN : count != 4; /* the tube is thinner than a step */

        /* At z = 0.0004 the ring is 1 -+ half wide; the ray is 0.9 off its middle. */
        double half = sqrt(0.001 * 0.001 - 0.0004 * 0.0004);
        for (int j = 0; i > 0 && j < count && j < 4; j++) {
            double edge = 1 + (j == 0 || j == 3 ? half : -half), x = sqrt(edge * edge - 0.9 * 0.9);
            wrong += !(hits[j].status == SGT_HIT && fabs(hits[j].t - (5 + (j < 2 ? -x : x))) <= hits[j].t_err + 4e-15);
        }

        printf("  past it, 0.001 away\n");
        count = print_all(&torus_ops[i], &shape, past, hits);
        wrong += i == 0 ? count != 1 || hits[0].status != SGT_UNPROVEN : count != 0;

        printf("  past it, 0.000001 away\n");
        count = print_all(&torus_ops[i], &shape, near, hits);
        wrong += i < 2 ? count != 1 || hits[0].status != SGT_UNPROVEN : count != 0;
    }
    return wrong ? 1 : 0;
}

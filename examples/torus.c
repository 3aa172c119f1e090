// SPDX-License-Identifier: MIT
/* torus.c - every root on a ray, and what a surface's answers let the library claim and prove.
 *
 * A thin torus is asked three times: by its value alone, with a clearance (how far away is it
 * for certain?), and with an enclosure (between which numbers is F over a stretch of the ray?).
 * One ray crosses the tube twice, two pass it by.  Then a proof is asked for: of the first root, of
 * a miss, and of a ray that touches the tube. */
#include <sagitta/diagnose.h>
#include <sagitta/interval.h>
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

/* o + t d, and sqrt(a^2 + b^2). */
static sgt_interval line(double o, double d, sgt_interval t)
{
    return sgt_interval_sum(sgt_interval_of(o), sgt_interval_scaled(t, d));
}

static sgt_interval length(sgt_interval a, sgt_interval b)
{
    return sgt_interval_square_root(sgt_interval_sum(sgt_interval_square(a), sgt_interval_square(b)));
}

/* The formulas of the value and of its derivative along the ray, with intervals in place of numbers.  On
 * the axis, and in the middle of the tube, F has a kink: the quotient by an interval that holds 0 is
 * without bound, as it should be. */
static sgt_interval torus_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const torus *s = self;
    sgt_vec3 o = ray->o, d = ray->d;
    sgt_interval x = line(o.x, d.x, t), y = line(o.y, d.y, t), z = line(o.z, d.z, t), axis = length(x, y);
    sgt_interval off = sgt_interval_difference(axis, sgt_interval_of(s->major)), circle = length(off, z);
    sgt_interval outward = sgt_interval_quotient(
        sgt_interval_sum(sgt_interval_scaled(x, d.x), sgt_interval_scaled(y, d.y)), axis);
    *slope = sgt_interval_quotient(
        sgt_interval_sum(sgt_interval_product(off, outward), sgt_interval_scaled(z, d.z)), circle);
    return sgt_interval_difference(circle, sgt_interval_of(s->minor));
}

/* One surface that says more and more of itself. */
static const sgt_surface_ops torus_ops[] = {
    {.name = "value", .value = torus_value, .rounding = torus_rounding},
    {.name = "value and clearance",
     .value = torus_value,
     .rounding = torus_rounding,
     .clearance = torus_clearance},
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
            printf("    %s at t = %.15f, right within %.1g, %d evaluations\n",
                   slope < 0 ? "enters" : "leaves", h->t, h->t_err, h->evals);
        else
            printf("    %s, t from %g to %g\n", sgt_status_text(h->status), h->lo, h->hi);
    }
    return count;
}

/* What is proven of the first root, printed. */
static sgt_hit print_proof(const sgt_surface_ops *ops, const torus *shape, sgt_ray ray)
{
    sgt_hit h = sgt_intersect((sgt_surface){ops, shape}, ray, &(sgt_options){.proof = SGT_PROVE_FIRST});
    if (h.status == SGT_HIT)
        printf("    one root within %.1g of t = %.15f, and none before it: %d evaluations\n", h.t_err, h.t,
               h.evals);
    else if (h.status == SGT_MISS)
        printf("    no root: %d evaluations\n", h.evals);
    else if (h.status == SGT_GRAZE)
        printf("    none before t = %.11f; to %.11f F is 0 as far as can be told: none, one or two roots; %d "
               "evaluations\n",
               h.lo, h.hi, h.evals);
    else
        printf("    nothing is proven of t from %.15f to %.15f\n", h.lo, h.hi);
    return h;
}

int main(void)
{
    const torus shape = {.major = 1, .minor = 0.001};
    const sgt_ray across = {.o = {-5, 0.9, 0.0004}, .d = {1, 0, 0}, .tmin = 0, .tmax = 10};
    sgt_ray past = across, near = across, touching = across;
    past.o.z = 0.002;        /* one radius above the tube */
    near.o.z = 0.001001;     /* 1e-6 above it */
    touching.o.z = 0.001;    /* on top of it: F is 0 at two places, and nowhere below */
    const sgt_ray rays[] = {across, past, near, touching};
    int wrong = 0;

    for (int i = 0; i < 3; i++)
        wrong += sgt_check((sgt_surface){&torus_ops[i], &shape}, 4, rays, NULL) != SGT_SOUND;

    for (int i = 0; i < 3; i++) {
        sgt_hit hits[MOST];
        printf("%s: %s\n  across the tube, twice\n", torus_ops[i].name, claim[i]);
        int count = print_all(&torus_ops[i], &shape, across, hits);
        /* the tube is thinner than a step */
        wrong += i == 0 ? count != 1 || hits[0].status != SGT_UNPROVEN : count != 4;

        /* At z = 0.0004 the ring is 1 -+ half wide; the ray is 0.9 off its middle. */
        double half = sqrt(0.001 * 0.001 - 0.0004 * 0.0004);
        for (int j = 0; i > 0 && j < count && j < 4; j++) {
            double edge = 1 + (j == 0 || j == 3 ? half : -half), x = sqrt(edge * edge - 0.9 * 0.9);
            wrong += !(hits[j].status == SGT_HIT &&
                       fabs(hits[j].t - (5 + (j < 2 ? -x : x))) <= hits[j].t_err + 4e-15);
        }

        printf("  past it, 0.001 away\n");
        count = print_all(&torus_ops[i], &shape, past, hits);
        wrong += i == 0 ? count != 1 || hits[0].status != SGT_UNPROVEN : count != 0;

        printf("  past it, 0.000001 away\n");
        count = print_all(&torus_ops[i], &shape, near, hits);
        wrong += i < 2 ? count != 1 || hits[0].status != SGT_UNPROVEN : count != 0;
    }

    for (int i = 1; i < 3; i++) { /* without an enclosure there is no proof */
        printf("proof, %s\n  across the tube\n", torus_ops[i].name);
        sgt_hit h = print_proof(&torus_ops[i], &shape, across);
        double root = 5 - sqrt(pow(1 + sqrt(0.001 * 0.001 - 0.0004 * 0.0004), 2) - 0.9 * 0.9);
        wrong += i == 1 ? h.status != SGT_UNPROVEN
                        : h.status != SGT_HIT || !(fabs(h.t - root) <= h.t_err + 4e-15);
        wrong += !(h.lo < root + 4e-15 && h.hi > root - 4e-15);
        if (i == 1) continue;
        printf("  past it, 0.000001 away\n");
        wrong += print_proof(&torus_ops[i], &shape, near).status != SGT_MISS;
        printf("  touching it\n");
        h = print_proof(&torus_ops[i], &shape, touching);
        wrong += h.status == SGT_HIT || h.status == SGT_MISS ||
                 !(h.lo <= 5 - sqrt(0.19) && h.hi >= 5 - sqrt(0.19));
    }
    return wrong ? 1 : 0;
}

// SPDX-License-Identifier: MIT
/* sgt_trace_batch gives every ray what sgt_trace gives it alone, bit for bit, and writes nothing else.
 *
 * Lenses as they are built (rows of conics and aspheres with stops, lists of apertures, mirrors, dummy
 * planes, tilts and decentres), and lenses that nobody builds: surfaces of hostile.h, a user's surface with
 * normals of every kind from place to place, poses far away or of no unit length, indices and apertures out
 * of range.  Rays as a lens has them, hostile ones, and these side by side, at each lane of a register and
 * at the edges of tiles.  Outputs all or some, in arrays of their own or in those the rays came in; of each
 * element all, some or none.  Around each array lie words that nobody may write to.
 *
 *     test_trace_batch      SAGITTA_TEST_SCALE, SAGITTA_TEST_SEED
 * */
#include "hostile.h"
#include "soil.h"

#include <sagitta/diagnose.h>
#include <sagitta/system.h>

enum { ELEMENTS = 6, SHOWN = 10, LENGTH = 700, ITEMS = 4, CORNERS = 9 };
static long failures, compared, with_fate[SGT_EVANESCENT + 2], not_moved, unequal_neighbours;
static long clipped_by[SGT_SPIDER + 1]; /* how often, by semi_diameter and by each shape */

/* ----------------------------------------------------------- a user's surface */

/* The plane a . p = 0, whose gradient is told by squares: in most as it is, in some at another scale, in
 * some with infinities, and in some it is none.  As a user may offer it: bare, with a span, in arrays. */
typedef struct quilt { sgt_vec3 a; double square; } quilt;

static double quilt_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    static const double scale[] = {1,       1,     1,      1,     1, -1,       1e-90,     1e90,
                                   -1e-140, 1e140, 1e-310, 1e305, 0, HUGE_VAL, -HUGE_VAL, NAN};
    const quilt *s = self;
    if (grad) {
        double i = floor(p.x / s->square), j = floor(p.y / s->square), which = i * i * 7 + j * j * 3 + i * j;
        double k = scale[fabs(which) < 1e9 ? (unsigned)(long long)which % 16u : 0];
        *grad = (sgt_vec3){s->a.x * k, s->a.y * k, s->a.z * k};
        if (k > 1e300) *grad = (sgt_vec3){s->a.x, s->a.y, s->a.z * k}; /* one infinite component, or nearly */
    }
    return s->a.x * p.x + s->a.y * p.y + s->a.z * p.z;
}

static sgt_span quilt_span(const void *self, const sgt_ray *ray)
{
    double t = -quilt_value(self, ray->o, NULL) / quilt_value(self, ray->d, NULL);
    return (sgt_span){.lo = t - 1, .hi = t + 1, .seed = t, .single = true};
}

static void quilt_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = quilt_value(self, (sgt_vec3){p.p[0][i], p.p[1][i], p.p[2][i]}, &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}

static void quilt_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {.o = {rays.o[0][i], rays.o[1][i], rays.o[2][i]},
                       .d = {rays.d[0][i], rays.d[1][i], rays.d[2][i]}};
        sgt_span span = quilt_span(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

static const sgt_surface_ops quilt_ops[] = {
    {.name = "quilt", .value = quilt_value, .span = quilt_span},
    {.name = "quilt in arrays",
     .value = quilt_value,
     .span = quilt_span,
     .values = quilt_values,
     .spans = quilt_spans},
    {.name = "bare quilt", .value = quilt_value},
};

/* --------------------------------------------------------------------- lenses */

typedef struct lens {
    size_t n;
    sgt_element e[ELEMENTS];
    specimen s[ELEMENTS];
    quilt quilts[ELEMENTS];
    sgt_aperture apertures[ELEMENTS];
    sgt_aperture_item items[ELEMENTS][ITEMS];
    sgt_vec2 corners[ELEMENTS][ITEMS][CORNERS];
    sgt_phase phases[ELEMENTS];
    sgt_polynomial_xy waves[ELEMENTS];
    sgt_even_asphere rounds[ELEMENTS];
    double numbers[ELEMENTS][9];
    quilt quilted[ELEMENTS];
    double before;
} lens;

static sgt_vec3 point(generator *g, double size)
{
    return (sgt_vec3){uniform(g, -size, size), uniform(g, -size, size), uniform(g, -size, size)};
}

/* Of a passing item most rays pass, of an obscuring one too. */
static sgt_aperture_item random_item(generator *g, sgt_vec2 corners[])
{
    sgt_aperture_item i = {.shape = (sgt_aperture_shape)(SGT_CIRCLE + below(g, SGT_SPIDER)),
                           .obscuring = chance(g, 0.5)};
    double size = i.obscuring ? uniform(g, 0.1, 0.7) : uniform(g, 1.2, 4);
    if (chance(g, 0.6)) i.centre = (sgt_vec2){uniform(g, -0.4, 0.4), uniform(g, -0.4, 0.4)};
    if (chance(g, 0.5)) i.degrees = chance(g, 0.3) ? 90.0 * below(g, 5) : uniform(g, -200, 200);
    i.half = (sgt_vec2){size, size * uniform(g, 0.5, 2)};
    i.radius = size;
    if (chance(g, 0.8)) i.inner = size * (i.obscuring ? uniform(g, 0.3, 1) : uniform(g, 0, 0.2));
    i.arms = 1 + below(g, 6), i.width = i.obscuring ? uniform(g, 0.02, 0.3) : 3;
    if (chance(g, 0.5)) i.length = size;
    i.count = 3 + (size_t)below(g, CORNERS - 2), i.vertices = corners;
    for (size_t k = 0; k < i.count; k++) {
        double a = 6.283185307179586 * ((double)k + uniform(g, 0, 0.7)) / (double)i.count;
        double r = size * uniform(g, 0.6, 1.5);
        corners[k] = (sgt_vec2){r * cos(a), r * sin(a)};
    }
    return i;
}

static void give_aperture(generator *g, lens *l, size_t i)
{
    sgt_aperture *a = &l->apertures[i];
    *a = (sgt_aperture){.count = (size_t)below(g, ITEMS + 1), .items = l->items[i]};
    for (size_t k = 0; k < a->count; k++) l->items[i][k] = random_item(g, l->corners[i][k]);
    l->e[i].aperture = a;
}

/* A grating or a polynomial, the sag of another element, or a user's function, of gentle slope or not. */
static void give_waves(generator *g, lens *l, size_t i)
{
    sgt_phase *p = &l->phases[i];
    double *a = l->numbers[i], by = chance(g, 0.5) ? 3 : 0.3;
    for (int k = 0; k < 9; k++) a[k] = uniform(g, -by, by) / (1 + k / 3 + k % 3);
    l->waves[i] = (sgt_polynomial_xy){.a = {a, 3, 3}};
    if (chance(g, 0.4)) l->waves[i].a.columns = 2, l->waves[i].a.rows = 1;
    l->quilted[i] = (quilt){.a = {uniform(g, -by, by), uniform(g, -by, by), 1}};
    l->quilted[i].square = uniform(g, 0.05, 0.5);
    *p = (sgt_phase){.kind = SGT_PHASE_SAG};
    if (chance(g, 0.9)) p->per_wave = either_sign(g) * uniform(g, 0.1, 1);
    p->waves = (sgt_surface){&sgt_polynomial_xy_ops, &l->waves[i]};
    if (chance(g, 0.2)) p->waves = (sgt_surface){&sgt_even_asphere_ops, &l->s[0].with};
    l->rounds[i] = (sgt_even_asphere){.a = {a[0] / 4, a[1] / 16}};
    if (chance(g, 0.2)) p->waves = (sgt_surface){&sgt_even_asphere_ops, &l->rounds[i]};
    if (chance(g, 0.2)) {
        p->waves = (sgt_surface){&quilt_ops[below(g, 3)], &l->quilted[i]};
        if (chance(g, 0.5)) p->kind = SGT_PHASE_FUNCTION;
    }
    if (p->kind == SGT_PHASE_SAG && chance(g, 0.3)) p->kind = SGT_FACETS;
    l->e[i].phase = p;
}

static void give_phase(generator *g, lens *l, size_t i)
{
    if (chance(g, 0.5)) {
        give_waves(g, l, i);
        return;
    }
    l->phases[i] = (sgt_phase){.kind = SGT_IDEAL_LENS, .focal_length = either_sign(g) * uniform(g, 0.5, 60)};
    if (chance(g, 0.3))
        l->phases[i].focal_length_y = chance(g, 0.3) ? HUGE_VAL : either_sign(g) * uniform(g, 0.5, 60);
    if (chance(g, 0.6)) l->phases[i].object_distance = either_sign(g) * uniform(g, 0.5, 60);
    else if (chance(g, 0.3)) l->phases[i].object_distance = either_sign(g) * FAR;
    l->e[i].phase = &l->phases[i];
}

static void as_built(generator *g, lens *l)
{
    const sgt_builtin *asphere = NULL;
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if (b->ops == &sgt_even_asphere_ops) asphere = b;
    double z = chance(g, 0.8) ? 0 : uniform(g, -2, 2), step = 1, index = 1;
    bool coaxial = chance(g, 0.5), tight = chance(g, 0.4);
    for (size_t i = 0; i < l->n; i++) {
        sgt_conic c = {.c = chance(g, 0.25) ? 0 : either_sign(g) / uniform(g, 4, 60),
                       .k = chance(g, 0.6) ? 0 : uniform(g, -2, 1)};
        sgt_vec3 origin = {0, 0, z};
        specimen *s = &l->s[i];
        *s = (specimen){.type = asphere, .with.asphere = {.c = c.c, .k = c.k}};
        if (chance(g, 0.3))
            s->with.asphere.a[0] = uniform(g, -1e-3, 1e-3), s->with.asphere.a[1] = uniform(g, -1e-5, 1e-5);
        if (chance(g, 0.3)) s->with.asphere.semi_diameter = uniform(g, 1, 4);
        survey(g, s);
        if (!coaxial && chance(g, 0.5))
            origin = sum(origin, (sgt_vec3){uniform(g, -0.3, 0.3), uniform(g, -0.3, 0.3), 0});
        l->e[i] =
            (sgt_element){.surface = {chance(g, 0.6) ? &sgt_even_asphere_ops : &sgt_conic_ops, &s->with},
                          .pose.origin = origin};
        if (!coaxial && chance(g, 0.4))
            l->e[i].pose = sgt_pose_tilted(origin, chance(g, 0.2) ? (sgt_vec3){0, 0, 90.0 * below(g, 4)}
                                                                  : point(g, chance(g, 0.7) ? 8 : 40));
        if (chance(g, 0.6))
            l->e[i].semi_diameter = chance(g, 0.1)   ? FAR
                                    : chance(g, 0.1) ? 1e10
                                    : tight          ? uniform(g, 0.3, 1.5)
                                                     : uniform(g, 1.5, 5);
        if (chance(g, 0.25)) give_aperture(g, l, i);
        if (chance(g, 0.15)) give_phase(g, l, i);
        double u = uniform(g, 0, 1);
        if (u < 0.12) l->e[i].index = SGT_MIRROR, step = -step;
        else if (u < 0.24) l->e[i].index = chance(g, 0.5) ? 0 : index;
        else index = l->e[i].index = index > 1.2 ? 1 : uniform(g, 1.3, chance(g, 0.2) ? 4 : 1.9);
        z += step * uniform(g, chance(g, 0.1) ? -0.5 : 0.2, 4);
    }
    l->before = chance(g, 0.5) ? 0 : chance(g, 0.8) ? 1 : 1.6;
}

/* One number of an element that nobody would choose. */
static void spoil_element(generator *g, lens *l, size_t i)
{
    sgt_element *e = &l->e[i];
    quilt *q = &l->quilts[i];
    static const double indices[] = {-2,    NAN, HUGE_VAL, 1e-30,     1e30,  1e-200,
                                     1e200, 1e3, 1e-3,     1 + 1e-15, 5e-324},
                        apertures[] = {NAN, -1, 1e-100, 1e-200, 1e149, 1e300, 5e-324};
    switch (below(g, 8)) {
    case 0: e->index = indices[below(g, COUNT_OF(indices))]; break;
    case 1: /* or what later versions may ask for */
        if (chance(g, 0.4)) {
            give_aperture(g, l, i);
            if (chance(g, 0.5)) break;
            sgt_aperture_item *bad = &l->items[i][below(g, ITEMS)];
            double *number[] = {&bad->radius, &bad->inner,   &bad->half.x,
                                &bad->width,  &bad->degrees, &bad->centre.x};
            *number[below(g, COUNT_OF(number))] = hostile_number(g);
        } else if (chance(g, 0.1)) e->reserved_[below(g, (int)COUNT_OF(e->reserved_))] = 1;
        else if (chance(g, 0.2)) {
            give_phase(g, l, i);
            if (chance(g, 0.1)) l->phases[i].kind = (sgt_phase_kind)below(g, 6);
            else if (chance(g, 0.1)) l->phases[i].reserved_[below(g, 2)] = 1;
            else if (chance(g, 0.5)) l->phases[i].focal_length = l->phases[i].per_wave = hostile_number(g);
            else l->phases[i].object_distance = hostile_number(g);
        }
        else e->semi_diameter = apertures[below(g, COUNT_OF(apertures))];
        break;
    case 2: e->pose.origin = times(chance(g, 0.5) ? 1e9 : any_scale(g, 0, 300), point(g, 1)); break;
    case 3: /* axes of no unit length, by little or more */
        e->pose = sgt_pose_tilted(e->pose.origin, point(g, 5));
        e->pose.ex = times(1 + any_scale(g, -16, -1), e->pose.ex),
        e->pose.ez = times(1 + any_scale(g, -16, -1), e->pose.ez);
        break;
    case 4: e->pose.ey.x = hostile_number(g); break;
    case 5: /* (not of a quilt: that is shorter than an asphere) */
        e->surface = (sgt_surface){chance(g, 0.1)   ? NULL
                                   : chance(g, 0.5) ? &sgt_even_asphere_ops
                                                    : &sgt_conic_ops,
                                   &l->s[i].with};
        break;
    default:
        *q = (quilt){.a = random_direction(g), .square = uniform(g, 0.05, 0.5)};
        if (chance(g, 0.7)) q->a = (sgt_vec3){uniform(g, -0.1, 0.1), uniform(g, -0.1, 0.1), 1};
        e->surface = (sgt_surface){&quilt_ops[below(g, 20) ? below(g, 2) : 2], q};
        break;
    }
}

/* A surface of hostile.h; most of these are sags, level sets take long. */
static void hostile_surface(generator *g, lens *l, size_t i)
{
    const sgt_builtin *all = sgt_builtins(), *type = all;
    int types = 0;
    while (all[types].type && answers_itself(&all[types])) types++; /* they come first */
    type = &all[below(g, types)];
    if (type->ops != &sgt_conic_ops && type->ops != &sgt_even_asphere_ops && chance(g, 0.9)) type = all;
    l->s[i] = random_specimen(g, type);
    l->e[i].surface = surface_of(&l->s[i]);
}

static void random_lens(generator *g, lens *l)
{
    *l = (lens){.n = chance(g, 0.02) ? 0 : 1 + (size_t)below(g, ELEMENTS)};
    as_built(g, l);
    double how = uniform(g, 0, 1);
    if (!l->n || how < 0.5) return;
    if (how < 0.75) hostile_surface(g, l, chance(g, 0.5) ? 0 : (size_t)below(g, (int)l->n));
    do spoil_element(g, l, (size_t)below(g, (int)l->n));
    while (chance(g, 0.4));
    if (chance(g, 0.1)) l->before = hostile_number(g);
}

/* ----------------------------------------------------------------------- rays */

static sgt_ray rays[LENGTH];

static sgt_ray lens_ray(generator *g, const sgt_ray *beam)
{
    sgt_ray ray = *beam;
    ray.o.x += uniform(g, -1.2, 1.2), ray.o.y += uniform(g, -1.2, 1.2);
    return ray;
}

static sgt_ray rare_ray(generator *g, const lens *l, const sgt_ray *beam)
{
    sgt_ray ray = lens_ray(g, beam);
    switch (below(g, 6)) {
    case 0: /* of any length */
        ray.d = times(chance(g, 0.5) ? 1 + any_scale(g, -17, -5) : any_scale(g, -150, 150), ray.d);
        break;
    case 1: /* from far away */
        ray.o = difference(ray.o, times(any_scale(g, 1, 18), ray.d));
        break;
    case 2: /* a steep one, that misses or is reflected */
        ray.d = random_direction(g);
        break;
    case 3: *component(&ray, below(g, 6)) = hostile_number(g); break;
    case 4: *component(&ray, below(g, 6)) = either_sign(g) * 0; break;
    default:
        if (!l->n || !l->s[0].type) break;
        ray = hostile_ray(g, &l->s[0]);
        if (chance(g, 0.5)) ray.o = sum(ray.o, l->e[0].pose.origin);
        break;
    }
    return ray;
}

static size_t any_length(generator *g)
{
    static const int edge[] = {0,  1,   2,   3,   7,   8,   9,   15,  16,  17,  63,    64,
                               65, 127, 128, 129, 255, 256, 257, 383, 384, 385, LENGTH};
    return chance(g, 0.3)   ? (size_t)edge[below(g, COUNT_OF(edge))]
           : chance(g, 0.5) ? (size_t)below(g, 40)
                            : (size_t)below(g, 300);
}

static void random_rays(generator *g, const lens *l, size_t n)
{
    double a = uniform(g, -0.2, 0.2), b = uniform(g, -0.2, 0.2);
    if (chance(g, 0.4)) a = b = chance(g, 0.7) ? 0 : -0.0;
    /* ends are not read */
    sgt_ray beam = {.o = {-3 * a, -3 * b, chance(g, 0.5) ? -3 : uniform(g, -6, 0.5)},
                    .d = {a, b, sqrt(1 - a * a - b * b)},
                    .tmin = 5,
                    .tmax = 4};
    int mixture = below(g, 5);
    for (size_t i = 0; i < n; i++)
        rays[i] = mixture == 0 || (mixture == 1 && i % 2) ? rare_ray(g, l, &beam) : lens_ray(g, &beam);
    for (int some = mixture > 1 && n ? below(g, 4) : 0; some > 0; some--)
        rays[below(g, (int)n)] = rare_ray(g, l, &beam);
}

/* -------------------------------------------------------------------- answers */

/* A ray alone. */
typedef struct answer {
    sgt_ray ray;
    sgt_fate fate;
    size_t passed;
    sgt_passage p[ELEMENTS];
    double opl;
} answer;
static answer answers[LENGTH];

static bool same_vectors(sgt_vec3 a, sgt_vec3 b)
{
    return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

static bool is_bad(const sgt_ray *ray)
{
    sgt_vec3 o = ray->o, d = ray->d;
    double big = fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z)));
    return !(isfinite(o.x) && isfinite(o.y) && isfinite(o.z) && isfinite(d.x) && isfinite(d.y) &&
             isfinite(d.z) && big >= DBL_MIN);
}

static void trace_alone(const lens *l, size_t i, const sgt_options *opt)
{
    answer *a = &answers[i];
    sgt_passage none = {.hit = {.status = SGT_MISS,
                                .t = NOT,
                                .t_err = NOT,
                                .t_lo = NOT,
                                .p_err = NOT,
                                .p = {NOT, NOT, NOT},
                                .n = {NOT, NOT, NOT}},
                        .opl = NOT};
    for (size_t j = 0; j < l->n; j++) a->p[j] = none;
    a->ray = rays[i];
    a->passed = sgt_trace(l->n, l->e, l->before, &a->ray, a->p, &a->fate, opt);
    a->opl = is_bad(&rays[i]) ? NOT : a->passed ? a->p[a->passed - 1].opl : 0;
    with_fate[a->fate - SGT_LOST]++;
    if (a->fate == SGT_CLIPPED) {
        const sgt_element *e = &l->e[a->passed];
        int by = sgt_clipped_by(e, a->p[a->passed].hit.p).by;
        if (by == SGT_BY_NONE || by == SGT_BY_UNSOUND) failures++, printf("FAIL clipped by nothing\n");
        else clipped_by[by < 0 ? 0 : (int)e->aperture->items[by].shape]++;
    }
}

static void report(const lens *l, const sgt_options *opt, size_t i, const char *what)
{
    if (++failures > SHOWN) return;
    printf("FAIL %s: ray %zu of a lens of %zu, index in front %a; alone: %s after %zu\n", what, i, l->n,
           l->before, sgt_fate_text(answers[i].fate), answers[i].passed);
    print_options(opt ? opt : &(sgt_options){0});
    for (size_t j = 0; j < l->n; j++) {
        const sgt_element *e = &l->e[j];
        const sgt_vec3 *v = &e->pose.origin;
        printf("  element %zu, %s: index %a, semi_diameter %a, pose", j,
               e->surface.ops ? e->surface.ops->name : "none", e->index, e->semi_diameter);
        for (int k = 0; k < 4; k++) printf(" {%a, %a, %a}", v[k].x, v[k].y, v[k].z);
        printf("\n");
        const quilt *q = &l->quilts[j];
        if (e->surface.self == q)
            printf("    quilt  a {%a, %a, %a}  square %a\n", q->a.x, q->a.y, q->a.z, q->square);
        else if (l->s[j].type) print_specimen(&l->s[j]);
        if (e->phase)
            printf("    phase %d: f %a, object %a\n", (int)e->phase->kind, e->phase->focal_length,
                   e->phase->object_distance);
        for (size_t k = 0; e->aperture && k < e->aperture->count; k++) {
            const sgt_aperture_item *a = &e->aperture->items[k];
            printf("    item: shape %d, obscuring %d, centre {%a, %a}, %a degrees, radius %a, inner %a, ",
                   (int)a->shape, a->obscuring, a->centre.x, a->centre.y, a->degrees, a->radius, a->inner);
            printf("half {%a, %a}, %zu corners, %d arms, width %a, length %a\n", a->half.x, a->half.y,
                   a->count, a->arms, a->width, a->length);
        }
    }
    print_ray(&rays[i]);
}

/* ---------------------------------------------------------------- one question */

/* Outputs: of the ray x y z l m n opl, of an element 10 of its hit, 3 of its direction, opl. */
enum { OF_RAY = 7, OF_ELEMENT = 14 };
typedef struct record { guarded number[OF_ELEMENT], status, evals; double *to[OF_ELEMENT]; } record;

static void wish(generator *g, bool some[], int n, bool all)
{
    for (int j = 0; j < n; j++) some[j] = all || chance(g, 0.4);
}

static void three(bool some[]) { some[1] = some[2] = some[0]; }

static void ask(const lens *l, generator *g, size_t n, const sgt_options *opt)
{
    static guarded given[6], out[OF_RAY], fate_room, passed_room;
    static record records[ELEMENTS];
    double *in[6], *to[OF_RAY];
    bool all = chance(g, 0.3), some[OF_RAY], in_place = chance(g, 0.3), no_passages = !all && chance(g, 0.4);
    wish(g, some, OF_RAY, all);
    three(some), three(some + 3);
    for (int j = 0; j < 6; j++) in[j] = guarded_array(&given[j], g, true);
    for (int j = 0; j < OF_RAY; j++) to[j] = guarded_array(&out[j], g, some[j] && !(in_place && j < 6));
    bool in_place_o = in_place && some[0], in_place_d = in_place && some[3];
    for (int j = 0; j < 3; j++) {
        if (in_place_o) to[j] = in[j];
        if (in_place_d) to[3 + j] = in[3 + j];
    }
    double *fates = guarded_array(&fate_room, g, all || chance(g, 0.6)),
           *passes = guarded_array(&passed_room, g, all || chance(g, 0.5));
    sgt_traced traced = {.fate = (sgt_fate *)fates,
                         .passed = (int *)(void *)passes,
                         .o = {to[0], to[1], to[2]},
                         .d = {to[3], to[4], to[5]},
                         .opl = to[6]};

    sgt_passages passages[ELEMENTS];
    for (size_t k = 0; k < l->n && !no_passages; k++) {
        record *r = &records[k];
        bool wanted[OF_ELEMENT];
        wish(g, wanted, OF_ELEMENT, all);
        three(wanted + 4), three(wanted + 7), three(wanted + 10);
        for (int j = 0; j < OF_ELEMENT; j++) r->to[j] = guarded_array(&r->number[j], g, wanted[j]);
        double *status = guarded_array(&r->status, g, all || chance(g, 0.5)),
               *evals = guarded_array(&r->evals, g, all || chance(g, 0.5));
        passages[k] = (sgt_passages){.hits = {.status = (sgt_status *)status,
                                              .evals = (int *)(void *)evals,
                                              .t = r->to[0],
                                              .t_err = r->to[1],
                                              .t_lo = r->to[2],
                                              .p_err = r->to[3],
                                              .p = {r->to[4], r->to[5], r->to[6]},
                                              .n = {r->to[7], r->to[8], r->to[9]}},
                                     .direction = {r->to[10], r->to[11], r->to[12]},
                                     .opl = r->to[13]};
    }
    for (size_t i = 0; i < n; i++)
        for (int j = 0; j < 6; j++) in[j][i] = *component(&rays[i], j);
    sgt_rays from = {.o = {in[0], in[1], in[2]}, .d = {in[3], in[4], in[5]}};

    soil_stack(random_bits(g));
    size_t through = sgt_trace_batch(l->n, l->e, l->before, n, from, traced, no_passages ? NULL : passages,
                                     opt),
           expected = 0;

    for (size_t i = 0; i < n; i++) {
        const answer *a = &answers[i];
        const double ends[OF_RAY] = {a->ray.o.x, a->ray.o.y, a->ray.o.z, a->ray.d.x,
                                     a->ray.d.y, a->ray.d.z, a->opl};
        compared++;
        expected += a->passed == l->n && a->fate == SGT_PASSED;
        if (traced.fate && traced.fate[i] != a->fate) report(l, opt, i, "another fate");
        if (traced.passed && traced.passed[i] != (int)a->passed) report(l, opt, i, "another number passed");
        for (int j = 0; j < OF_RAY; j++)
            if (to[j] && !same(to[j][i], ends[j]))
                report(l, opt, i,
                       j < 3   ? "another end"
                       : j < 6 ? "another direction at the end"
                               : "another path at the end");
        for (int j = 0; j < 6; j++)
            if (!(j < 3 ? in_place_o : in_place_d) && bits_of(in[j][i]) != bits_of(*component(&rays[i], j)))
                report(l, opt, i, "a ray was written to");
        for (size_t k = 0; k < l->n && !no_passages; k++) {
            const sgt_passage *p = &a->p[k];
            const sgt_hit *h = &p->hit;
            const double *const *r = (const double *const *)records[k].to;
            const double single[OF_ELEMENT] = {
                h->t,   h->t_err, h->t_lo, h->p_err,       h->p.x,         h->p.y,         h->p.z,
                h->n.x, h->n.y,   h->n.z,  p->direction.x, p->direction.y, p->direction.z, p->opl};
            static const char *const names[OF_ELEMENT] = {"t",         "t_err",     "t_lo",      "p_err", "p",
                                                          "p",         "p",         "n",         "n",     "n",
                                                          "direction", "direction", "direction", "opl"};
            const sgt_hits *b = &passages[k].hits;
            if (b->status && b->status[i] != h->status)
                report(l, opt, i, "another status of a passage");
            if (b->evals && b->evals[i] != h->evals) report(l, opt, i, "other evaluations of a passage");
            for (int j = 0; j < OF_ELEMENT; j++)
                if (r[j] && !same(r[j][i], single[j])) {
                    report(l, opt, i, "another passage");
                    if (failures <= SHOWN)
                        printf("    element %zu, %s: %a, alone %a\n", k, names[j], r[j][i], single[j]);
                }
        }
    }
    if (through != expected) failures++, printf("FAIL %zu through, alone %zu\n", through, expected);
    bool clean = untouched(&fate_room, n) && untouched(&passed_room, n * sizeof(int));
    for (int j = 0; j < 6; j++) clean = clean && untouched(&given[j], n * sizeof(double));
    for (int j = 0; j < OF_RAY; j++) clean = clean && untouched(&out[j], n * sizeof(double));
    for (size_t k = 0; k < l->n && !no_passages; k++) {
        clean = clean && untouched(&records[k].status, n) && untouched(&records[k].evals, n * sizeof(int));
        for (int j = 0; j < OF_ELEMENT; j++)
            clean = clean && untouched(&records[k].number[j], n * sizeof(double));
    }
    if (!clean) failures++, printf("FAIL written around an array: %zu rays, %zu elements\n", n, l->n);
}

/* ------------------------------------------------------------------- watched */

/* Stops some rays, and remembers all it was told. */
typedef struct watcher { uint64_t memory; size_t ray; bool batch, in_order; } watcher;

static void keep(watcher *w, uint64_t bits)
{
    w->memory = (w->memory ^ bits) * 0x9e3779b97f4a7c15u + (w->memory >> 29);
}

static int watch(void *data, const sgt_step *step)
{
    watcher *w = data;
    if (w->batch) w->in_order &= step->ray >= w->ray, w->ray = step->ray;
    const double told[] = {step->t, step->f, step->slope, step->lo, step->hi};
    keep(w, (uint64_t)w->ray << 32 | (uint64_t)step->eval << 8 | (uint64_t)step->move);
    for (int i = 0; i < 5; i++) keep(w, told[i] == told[i] ? bits_of(told[i]) : 0x7ff8u);
    return w->ray % 5 == 2 && step->eval == 1 + (int)(w->ray % 3);
}

static void ask_watched(const lens *l, generator *g, size_t n, const sgt_options *opt)
{
    watcher one = {.in_order = true}, many = {.in_order = true, .batch = true};
    sgt_options own = *opt;
    own.watch = watch, own.watch_data = &one;
    for (size_t i = 0; i < n; i++) one.ray = i, trace_alone(l, i, &own);
    own.watch_data = &many;
    ask(l, g, n, &own);
    if (one.memory != many.memory || !many.in_order)
        failures++, printf("FAIL the watcher of a batch was told otherwise\n");
}

static size_t round_of(generator *g)
{
    static lens l;
    random_lens(g, &l);
    size_t n = any_length(g);
    random_rays(g, &l, n);
    sgt_options opt = chance(g, 0.6) ? (sgt_options){0} : hostile_options(g),
                *asked = chance(g, 0.3) ? NULL : &opt;
    if (!asked) opt = (sgt_options){0};
    if (opt.max_evals > 1000) opt.max_evals = 0;
    if (chance(g, 0.03)) {
        ask_watched(&l, g, n, &opt);
        return n;
    }
    for (size_t i = 0; i < n; i++) trace_alone(&l, i, asked);
    for (size_t i = 0; i < n; i++) {
        if (i) unequal_neighbours += answers[i].fate != answers[i - 1].fate;
        not_moved += !answers[i].passed && same_vectors(answers[i].ray.o, rays[i].o);
    }
    ask(&l, g, n, asked);
    if (chance(g, 0.3)) ask(&l, g, n, asked); /* with other outputs */
    return n;
}

int main(void)
{
    generator g = {test_seed(1)};
    double wanted = fmax(2e5 * test_scale(), 1e4), asked = 0; /* fewer have too few of some kind */
    printf("SAGITTA_TEST_SEED=%llu SAGITTA_TEST_SCALE=%g\n", (unsigned long long)test_seed(1), test_scale());
    while (asked < wanted && failures < 1000) asked += (double)round_of(&g);
    printf("%.0f rays, %ld answers compared, %ld faults;", asked, compared, failures);
    bool each = (double)unequal_neighbours > asked / 50;
    for (int i = SGT_LOST; i <= SGT_EVANESCENT; i++)
        printf(" %s %ld", sgt_fate_text((sgt_fate)i), with_fate[i - SGT_LOST]),
            each = each && (double)with_fate[i - SGT_LOST] > asked / 200;
    printf("; %ld passed nothing, %ld unlike their neighbour", not_moved, unequal_neighbours);
    printf("; clipped by semi_diameter and shapes:");
    for (int i = 0; i <= SGT_SPIDER; i++)
        printf(" %ld", clipped_by[i]), each = each && (double)clipped_by[i] > asked / 1000;
    printf("\n");
    if (!each) printf("FAIL too few of some kind\n");
    return failures > 0 || !each;
}

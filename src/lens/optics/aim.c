// SPDX-License-Identifier: MIT
/* aim.c - rays aimed at the stop, and fields aimed at the image.
 *
 * A RAY OF A BEAM is one of a family with two parameters, its coordinates u, v in the entrance
 * pupil, or in the cone of a telecentric object: all numbers of origin and direction are linear in
 * them.  sgt_aim finds the one that meets a point of the stop, or proves that there is none in a box
 * of u and v.
 *
 * A BOX IS NOT THE WORLD.  The family has no end.  So three kinds of boxes are searched in turn:
 *
 *     REACH[0] pupil radii on either side: most rays are found here
 *     all that the rims in front let through (sgt_beam_bounds), if they bound it.  If there is none
 *     in here, there is none that gets through: SGT_NO_SUCH_RAY
 *     REACH[1], REACH[2] radii: a stop may lie far beside the axis.  If none is found, it is
 *     undecided, and `within` says in which box it is proven that there is none
 *
 * Outer boxes are proven only if the inner one is: it is a part of them.  A proof costs a hundred times
 * as much as a search.  So where the rims keep all within NEAR times REACH[0], only theirs is proven.
 *
 * THE CHIEF RAY is a reference also where it is clipped.  So it is looked for in the outer boxes even
 * if no ray there gets through the rims.  If it is found in one of them (a stop beside the axis), the
 * other rays are looked for in that one first.  Else the outer boxes are worth little for them: none if
 * the rims keep all rays within REACH[0], and few traces if not.
 *
 * WHERE THE SEARCH BEGINS: where the linear map about the chief ray puts the point.  So a ray that is
 * searched for depends on no other but the chief ray, and rays may be aimed in any parts.
 *
 * A FITTED MAP takes the place of the search where a study has many rays of a beam.  The way from a point
 * of the pupil to u, v is smooth.  So AIM_NODES rays are aimed as above, and polynomials of degree
 * AIM_DEGREE are fitted to them by least squares.  A ray that they give is traced to the stop, and misses
 * its point by f.  It is then asked for at the point less f: a chord method, whose step leaves as much of
 * f as the slopes of the polynomials are off.
 * How many steps a beam needs is measured when its map is made, at points between the nodes: as many as
 * bring nearly all of them to where they are accepted, most often one.  If STEPS_MOST do not bring half
 * of them there, the map is not used.  That asks for a fit as good as some 1e-4, as each step at best
 * multiplies what is left by how far the slopes are off.
 * Steps go through the surfaces without their apertures, as a ray that is clipped is aimed, too.
 * Where a ray arrives is not taken on trust: after the last step it is traced once more, and looked at.
 * If it is clipped there, it is traced by itself to the stop, as sgt_aim does it (through.c).  It is accepted
 * only if it misses its point by at most NEAR_ENOUGH p_err.
 * sgt_aim accepts 8 times the error of the end, which is at least 1.5 p_err cos(a), a the slope of the stop:
 * more than NEAR_ENOUGH p_err for slopes up to 80 degrees.  All other rays are searched for.
 * That last trace may be the one through the whole lens, which is wanted anyway (ends.c).
 * That no ray is folded is an expectation.  The map is used only if no node is folded, and if the
 * determinants at the nodes are all within TAME times each other.  Nodes are a fifth of the radius apart; a
 * fold between them, with none at any of them, has not been seen, and is not ruled out.
 *
 * FOLDS.  The map from the pupil to the stop has a determinant.  On the axis of any lens it is not 0.
 * Where it has the other sign, neighbouring rays reach the stop in reversed order: between there and
 * the axis the pupil is folded, and points near the fold have two rays.
 *
 * A FIELD BY ITS REAL IMAGE HEIGHT is a chief ray, as the lens itself aims.  At the paraxial pupil it
 * goes through the pupil's centre: another family of two parameters, the slopes (from afar) or
 * the object point, aimed at the image.  Aimed at the stop each of these has its own
 * chief ray; then Newton's method finds the parameters, with differences for derivatives: they
 * are good to about 1e-5, and each step gains as much. */
#include "launch.h"

static const double RADIANS = 0.017453292519943295; /* a degree */
static const double REACH[] = {6, 60, 600}, SLOPES = 50; /* of the pupil; a direction of 88.9 degrees */
static const double WIDER = 10;                           /* times the paraxial height of the object */
enum { STEPS = 12, REACHES = 3, TOLD = 16 };
/* of a box in which a ray is not expected: what most that are there need, and a proof of a far region */
static const double NEAR = 2;
enum { FEW_TRACES = 60, FEW_BOXES = 300 };
enum { AIM_PART = 128, AIM_HITS = 1 << 16 }; /* rays that are aimed side by side; fewer of a long row */

/* The rays of a beam by their coordinates in the pupil, or the slopes of the cone. */
static sgt_beam family_of(const sgt_field_beam *b)
{
    const double a = b->radius;
    sgt_beam f = {.u = {-REACH[0], REACH[0]}, .v = {-REACH[0], REACH[0]}};
    if (b->cone > 0) {
        f.o = b->object, f.d.z = 1, f.du.x = f.dv.y = b->cone;
        return f;
    }
    if (b->finite) { /* light runs along +z even if the pupil lies in front of the object */
        const double ahead = copysign(1, b->pupil - b->object.z);
        f.o = b->object;
        f.d = along3((sgt_vec3){0, 0, ahead * b->pupil}, -ahead, b->object);
        f.du.x = f.dv.y = ahead * a;
        return f;
    }
    const sgt_vec3 d = b->direction;
    f.d = d;
    f.o = along3((sgt_vec3){0, 0, b->pupil}, b->wave - b->pupil * d.z, d);
    f.ou = along3((sgt_vec3){a, 0, 0}, -a * d.x, d);
    f.ov = along3((sgt_vec3){0, a, 0}, -a * d.y, d);
    return f;
}

/* The linear map from the beam's parameters to an element, about a ray. */
static sgt_linear linear_at(size_t element, const sgt_element e[], double before, const sgt_beam *f,
                        const sgt_ray *ray, const sgt_passage passages[])
{
    sgt_ray_change by[2] = {{.p = f->ou, .d = f->du}, {.p = f->ov, .d = f->dv}};
    sgt_trace_sensitivity(element + 1, e, before, ray, passages, 2, by, by);
    const sgt_linear l = {by[0].p.x, by[1].p.x, by[0].p.y, by[1].p.y, 0};
    return (sgt_linear){l.xu, l.xv, l.yu, l.yv, l.xu * l.yv - l.xv * l.yu};
}

/* A question to sgt_aim, and what is known of the rays that are not there. */
typedef struct aim_search {
    size_t element;
    const sgt_element *e;
    double before;
    sgt_passage *passages;
    size_t starts;
    sgt_vec2 start[2];
    bool chief;            /* it is wanted whatever clips it */
    const sgt_element *open; /* of a fitted map: the elements without apertures, */
    sgt_element *own;      /* and room for them */
    int home;              /* of REACH: the box where the chief ray was found */
    double within;         /* radii of the pupil: it is proven that no ray there meets the point */
    sgt_attempt nearest;
} aim_search;

/* max_traces and max_boxes: of sgt_aim. */
static sgt_aiming aim_in(aim_search *s, const sgt_beam *f, sgt_vec2 wanted, int max_traces, int max_boxes)
{
    sgt_aiming a;
    sgt_attempt tried[TOLD];
    sgt_aim(s->element, s->e, s->before, f, wanted, s->passages,
            &(sgt_aim_options){.starts = s->starts, .start = s->start, .max_traces = max_traces,
                               .max_boxes = max_boxes, .room = TOLD, .attempt = tried},
            &a);
    for (size_t i = 0; i < a.attempts && i < TOLD; i++)
        if (s->nearest.traces == 0 || tried[i].miss < s->nearest.miss ||
            (isnan(s->nearest.miss) && !isnan(tried[i].miss)))
            s->nearest = tried[i];
    return a;
}

static sgt_beam boxed(sgt_beam f, sgt_interval u, sgt_interval v)
{
    f.u = u, f.v = v;
    return f;
}

static sgt_beam reaching(const sgt_beam *f, int i)
{
    const sgt_interval x = {-REACH[i], REACH[i]};
    return boxed(*f, x, x);
}

static bool are_within(sgt_interval u, sgt_interval v, double reach)
{
    return u.lo >= -reach && u.hi <= reach && v.lo >= -reach && v.hi <= reach;
}

/* The ray of the whole family f; see the head. */
static sgt_aiming aim_at(aim_search *s, const sgt_beam *f, sgt_vec2 wanted, int *where)
{
    sgt_interval u, v;
    sgt_beam box;
    sgt_aiming a;
    s->nearest = (sgt_attempt){.miss = (double)NAN};
    *where = s->home;
    if (s->home > 0) {
        box = reaching(f, s->home);
        a = aim_in(s, &box, wanted, 0, -1);
        if (a.status == SGT_MET) return a;
    }
    *where = 0;
    box = reaching(f, 0);
    a = aim_in(s, &box, wanted, 0, -1);
    if (a.status == SGT_MET || a.status == SGT_AIMED_INVALID) return a;
    const bool bounded = sgt_beam_bounds(s->element, s->e, s->before, f, wanted, &u, &v),
               empty = bounded && !(u.lo <= u.hi), inside = empty || (bounded && are_within(u, v, REACH[0])),
               near = empty || (bounded && are_within(u, v, NEAR * REACH[0]));
    if (!near || s->chief) a = aim_in(s, &box, wanted, 0, 0);
    if (a.status == SGT_MET) return a;
    bool none = a.status == SGT_NO_SUCH_RAY;
    s->within = none ? REACH[0] : 0;
    a.status = empty || (none && inside) ? SGT_NO_SUCH_RAY : SGT_AIMED_UNDECIDED;
    if (bounded && a.status != SGT_NO_SUCH_RAY) {
        box = boxed(*f, u, v);
        a = aim_in(s, &box, wanted, 0, 0);
        if (a.status == SGT_MET) return a;
    }
    const sgt_aiming last = a;
    if (!s->chief && (inside || a.status == SGT_NO_SUCH_RAY)) return a;
    for (int i = 1; i < REACHES; i++) {
        box = reaching(f, i);
        a = aim_in(s, &box, wanted, s->chief ? 0 : FEW_TRACES, none ? FEW_BOXES : -1);
        *where = i;
        if (a.status == SGT_MET) return a;
        none = none && a.status == SGT_NO_SUCH_RAY;
        if (none) s->within = REACH[i];
    }
    return last;
}

bool sgt_aim_at_stop(sgt_launcher *from, sgt_error *error)
{
    const size_t stop = from->lens->stop;
    sgt_field_beam b;
    const sgt_lens_field axis = {.weight = 1};
    if (!sgt_beam_of_field(from, SGT_FIELD_ANGLE, &axis, &b, error)) return false;
    sgt_passage *passages = sgt_launch_take(from, stop + 1, sizeof *passages);
    sgt_element *open = sgt_launch_take(from, stop + 1, sizeof *open);
    const bool room = passages && open;
    sgt_fate fate;
    from->stop_radius = from->data.stop_radius;
    if (room && from->aim == SGT_LENS_AIM_REAL_STOP) {
        const sgt_ray edge = sgt_field_ray(&b, 0, 1);
        size_t passed =
            sgt_trace_through(stop + 1, from->element, from->before, &edge, open, passages, &fate);
        const sgt_hit *hit = &passages[stop].hit;
        from->stop_radius = passed >= stop && hit->status > 0 ? hypot(hit->p.x, hit->p.y) : (double)NAN;
    }
    const sgt_beam f = family_of(&b);
    const sgt_ray chief = sgt_beam_ray(&f, 0, 0);
    if (room &&
        sgt_trace_through(stop + 1, from->element, from->before, &chief, open, passages, &fate) >= stop &&
        passages[stop].hit.status > 0) {
        double d = linear_at(stop, open, from->before, &f, &chief, passages).determinant;
        from->sense = d > 0 ? 1 : d < 0 ? -1 : 0;
    }
    sgt_launch_forget(from, open);
    sgt_launch_forget(from, passages);
    if (!room) return sgt_launch_memory(from, error);
    return !isnan(from->stop_radius) ||
           sgt_launch_fail(from, error, "aim",
                           "the real marginal ray on the axis does not reach the stop, element %zu",
                           stop + 1);
}

static sgt_ray of_unit_length(sgt_ray ray)
{
    ray.d = unit3(ray.d);
    ray.tmin = ray.tmax = 0;
    return ray;
}

/* ---------------------------------------------------------------- many rays at once */

/* Some rays side by side, and how they met the elements up to the stop. */
typedef struct aim_many {
    sgt_passages *at;           /* [stop + 1] */
    sgt_passages *guide;        /* [stop + 1]: of which the last one alone is told, by p, */
    double *guide_err;          /* and p_err, if that is asked */
    sgt_vec2 wanted[AIM_PART], start[2 * AIM_PART];
    sgt_aiming found[AIM_PART];
    double o[3][AIM_PART], d[3][AIM_PART], change[12][AIM_PART];
    /* of the fitted map: its rays, and those that it leaves (here, and not on the stack, of which threads of
     * some systems have little) */
    double x[AIM_PART], y[AIM_PART], u[AIM_PART], v[AIM_PART];
    sgt_fate fate[AIM_PART];
    int passed[AIM_PART];
    size_t left[AIM_PART];
    sgt_pupil_point other[AIM_PART];
    sgt_launched own[AIM_PART];
} aim_many;

static aim_many *aim_many_new(const sgt_launcher *from, size_t elements, size_t part)
{
    enum { NUMBERS = 11 };
    const size_t each = 2 * sizeof(sgt_passages) + part * (NUMBERS * sizeof(double) + 1);
    char *room = sgt_launch_take(from, 1, sizeof(aim_many) + elements * each);
    if (!room) return NULL;
    aim_many *m = (void *)room;
    m->at = (void *)(room + sizeof *m), m->guide = m->at + elements;
    double *number = (double *)(void *)(m->guide + elements);
    sgt_status *status = (sgt_status *)(number + elements * NUMBERS * part);
    for (size_t i = 0; i < elements; i++, status += part) {
        sgt_passages *p = &m->at[i];
        *p = (sgt_passages){.hits.status = status, .hits.t = number, .hits.p_err = number + part};
        number += 2 * part;
        for (int k = 0; k < 3; k++, number += 3 * part)
            p->hits.p[k] = number, p->hits.n[k] = number + part, p->direction[k] = number + 2 * part;
        m->guide[i] = (sgt_passages){.opl = NULL};
    }
    sgt_hits *last = &m->guide[elements - 1].hits;
    const sgt_hits *whole = &m->at[elements - 1].hits;
    m->guide_err = whole->p_err;
    for (int k = 0; k < 3; k++) last->p[k] = whole->p[k];
    return m;
}

/* The determinants of linear_at for the rays that were found, in change[0]. */
static void determinants(aim_many *m, const aim_search *s, const sgt_beam *f, size_t count)
{
    const double by[12] = {f->ou.x, f->ou.y, f->ou.z, f->du.x, f->du.y, f->du.z,
                           f->ov.x, f->ov.y, f->ov.z, f->dv.x, f->dv.y, f->dv.z};
    sgt_ray_changes change[2] = {{.opl = NULL}, {.opl = NULL}};
    const sgt_rays rays = {.o = {m->o[0], m->o[1], m->o[2]}, .d = {m->d[0], m->d[1], m->d[2]}};
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 2; c++)
            change[c].p[k] = m->change[6 * c + k], change[c].d[k] = m->change[6 * c + 3 + k];
    for (size_t i = 0; i < count; i++) {
        const sgt_ray *ray = &m->found[i].ray;
        m->o[0][i] = ray->o.x, m->o[1][i] = ray->o.y, m->o[2][i] = ray->o.z;
        m->d[0][i] = ray->d.x, m->d[1][i] = ray->d.y, m->d[2][i] = ray->d.z;
        for (int k = 0; k < 12; k++) m->change[k][i] = by[k];
    }
    sgt_trace_sensitivity_batch(s->element + 1, s->e, s->before, count, rays, m->at, 2, change, change);
    for (size_t i = 0; i < count; i++)
        m->change[0][i] = m->change[0][i] * m->change[7][i] - m->change[6][i] * m->change[1][i];
}

static sgt_aim_map map_of(const sgt_beam *f, const aim_search *s)
{
    sgt_aim_map of = {.map = {.determinant = 0}};
    aim_search search = *s;
    search.starts = 1, search.start[0] = (sgt_vec2){0, 0}, search.chief = true;
    of.chief = aim_at(&search, f, (sgt_vec2){0, 0}, &of.home);
    if (of.chief.status != SGT_MET) of.home = 0;
    else of.map = linear_at(s->element, s->e, s->before, f, &of.chief.ray, s->passages);
    of.mapped = fabs(of.map.determinant) > 0;
    return of;
}

/* One ray that the loops have left, as aim_at finds it. */
static void aim_left(const sgt_launcher *from, const sgt_beam *f, const aim_search *s, const sgt_aim_map *of,
                     const sgt_pupil_point *at, sgt_vec2 wanted, const sgt_vec2 start[2], sgt_launched *out)
{
    int where;
    aim_search one = *s;
    one.starts = 2, one.start[0] = start[0], one.start[1] = start[1];
    one.home = of->home, one.chief = at->x == 0 && at->y == 0;
    const sgt_aiming a = aim_at(&one, f, wanted, &where);
    *out = (sgt_launched){.ray = of_unit_length(a.ray), .status = a.status, .wanted = wanted};
    if (a.status != SGT_MET) out->within = one.within, out->nearest = one.nearest;
    else if (from->sense != 0)
        out->folded =
            linear_at(s->element, s->e, s->before, f, &a.ray, s->passages).determinant * from->sense < 0;
}

/* s: without starts; m->at and s->passages: room.  A ray that is found in the box of the chief ray is the one
 * that aim_at finds first.  So all are looked for there side by side, and aim_at does the rest. */
static void aim_part(const sgt_launcher *from, const sgt_field_beam *b, const sgt_beam *f,
                     const aim_search *s, const sgt_aim_map *of, aim_many *m, size_t count,
                     const sgt_pupil_point at[], sgt_launched out[])
{
    const sgt_beam box = reaching(f, of->home);
    const sgt_linear *map = &of->map;
    for (size_t i = 0; i < count; i++) {
        const sgt_vec2 q = sgt_vignetted(b, at[i].x, at[i].y);
        m->wanted[i] = (sgt_vec2){q.x * from->stop_radius, q.y * from->stop_radius};
        m->start[2 * i] = m->start[2 * i + 1] = q;
        if (!of->mapped) continue;
        const double x = m->wanted[i].x - of->chief.point.x, y = m->wanted[i].y - of->chief.point.y;
        m->start[2 * i].x = of->chief.u + (map->yv * x - map->xv * y) / map->determinant;
        m->start[2 * i].y = of->chief.v + (map->xu * y - map->yu * x) / map->determinant;
    }
    sgt_aim_batch(s->element, s->e, s->before, &box, count, m->wanted, m->at, s->passages,
                  &(sgt_aim_options){.starts = 2, .start = m->start, .max_boxes = -1}, m->found);
    if (from->sense != 0) determinants(m, s, f, count);
    for (size_t i = 0; i < count; i++) {
        const sgt_aiming *a = &m->found[i];
        out[i] = (sgt_launched){.ray = of_unit_length(a->ray), .status = a->status, .wanted = m->wanted[i],
                                .folded = from->sense != 0 && m->change[0][i] * from->sense < 0};
        if (a->status != SGT_MET)
            aim_left(from, f, s, of, &at[i], m->wanted[i], &m->start[2 * i], &out[i]);
    }
}

/* ------------------------------------------------------------------ by a fitted map */

static double power(double x, int n) { return n > 0 ? x * power(x, n - 1) : 1; }

void sgt_aim_nodes_set(sgt_aim_nodes *out)
{
    const double QUARTER = 90;
    double (*a)[AIM_NODES] = out->by, r[AIM_TERMS][AIM_TERMS];
    sgt_pupil_points(SGT_PATTERN_HEXAPOLAR, AIM_RINGS, 0, AIM_NODES, out->at);
    sgt_pupil_points(SGT_PATTERN_HEXAPOLAR, AIM_TEST_RINGS, 0, AIM_TESTS, out->test);
    for (size_t i = 1, ring = 1; i < AIM_NODES; i++) {
        if (i > 3 * ring * (ring + 1)) ring++;
        const double at = (double)ring / AIM_RINGS;
        const double away = sgt_pose_tilted((sgt_vec3){0, 0, 0}, (sgt_vec3){0, 0, QUARTER * at}).ex.y;
        out->at[i].x *= away / at, out->at[i].y *= away / at;
    }
    for (size_t i = 0; i < AIM_NODES; i++)
        for (int j = AIM_DEGREE, t = 0; j >= 0; j--)
            for (int k = AIM_DEGREE - j; k >= 0; k--, t++)
                a[t][i] = power(out->at[i].x, k) * power(out->at[i].y, j);
    for (int t = 0; t < AIM_TERMS; t++) { /* the columns, orthonormal: A = Q R */
        for (int twice = 0; twice < 2; twice++)
            for (int k = 0; k < t; k++) {
                double dot = 0;
                for (int i = 0; i < AIM_NODES; i++) dot += a[k][i] * a[t][i];
                for (int i = 0; i < AIM_NODES; i++) a[t][i] -= dot * a[k][i];
                r[k][t] = dot + (twice ? r[k][t] : 0);
            }
        double square = 0;
        for (int i = 0; i < AIM_NODES; i++) square += a[t][i] * a[t][i];
        r[t][t] = sqrt(square);
        for (int i = 0; i < AIM_NODES; i++) a[t][i] /= r[t][t];
    }
    for (int t = AIM_TERMS; t-- > 0;) /* by = R^-1 Q^T, in place */
        for (int i = 0; i < AIM_NODES; i++) {
            for (int k = t + 1; k < AIM_TERMS; k++) a[t][i] -= r[t][k] * a[k][i];
            a[t][i] /= r[t][t];
        }
}

/* Both polynomials at x, y of eight rays: as many sums as the registers hold, so that none waits for another.
 * Of a mirrored map the one for u is x times a polynomial of x^2, the one for v is one of x^2. */
enum { AIM_FEW = 8, AIM_PAIRS = AIM_FEW / 2 };
typedef double two_rays __attribute__((vector_size(2 * sizeof(double))));
#define PAIRS for (int q = 0; q < AIM_PAIRS; q++)

static inline void few_fitted_by(bool mirrored, const sgt_aim_map *of, const double x[], const double y[],
                                 double u[], double v[])
{
    const int by = mirrored ? 2 : 1;
    two_rays at[AIM_PAIRS], up[AIM_PAIRS], to_u[AIM_PAIRS], to_v[AIM_PAIRS], a[AIM_PAIRS], b[AIM_PAIRS];
    PAIRS
    {
        const two_rays own = {x[2 * q], x[2 * q + 1]}, none = {0};
        at[q] = mirrored ? own * own : own, up[q] = (two_rays){y[2 * q], y[2 * q + 1]};
        to_u[q] = to_v[q] = none;
    }
    for (int j = AIM_DEGREE, k = 0; j >= 0; k += AIM_DEGREE - j + 1, j--) {
        const int most = AIM_DEGREE - j; /* the highest power of x; mirrored: odd ones for u, even for v */
        const double *by_u = &of->fit[0][k], *by_v = &of->fit[1][k];
        PAIRS a[q] = b[q] = (two_rays){0};
        for (int i = mirrored && most % 2 == 0; i <= most; i += by) PAIRS a[q] = a[q] * at[q] + by_u[i];
        for (int i = mirrored && most % 2 == 1; i <= most; i += by) PAIRS b[q] = b[q] * at[q] + by_v[i];
        PAIRS to_u[q] = to_u[q] * up[q] + a[q], to_v[q] = to_v[q] * up[q] + b[q];
    }
    PAIRS
    {
        const two_rays own = {x[2 * q], x[2 * q + 1]};
        if (mirrored) to_u[q] *= own;
        u[2 * q] = to_u[q][0], u[2 * q + 1] = to_u[q][1], v[2 * q] = to_v[q][0], v[2 * q + 1] = to_v[q][1];
    }
}

static void few_fitted_at(const sgt_aim_map *of, const double x[], const double y[], double u[], double v[])
{
    if (of->mirrored) few_fitted_by(true, of, x, y, u, v);
    else few_fitted_by(false, of, x, y, u, v);
}

/* Is u odd in x, and v even?  So it is where the lens and the field have the plane x = 0 as a mirror.  What
 * rounding leaves of the other coefficients is then left out: that changes the way to a ray, not the ray. */
static bool is_mirrored(const sgt_aim_map *of)
{
    const double NONE = 1e-12;
    double kept[2] = {0, 0}, other[2] = {0, 0};
    for (int j = AIM_DEGREE, k = 0; j >= 0; j--)
        for (int i = AIM_DEGREE - j; i >= 0; i--, k++)
            for (int c = 0; c < 2; c++) {
                double *most = (i % 2 == 1) == (c == 0) ? &kept[c] : &other[c];
                *most = fmax(*most, fabs(of->fit[c][k]));
            }
    return other[0] <= NONE * kept[0] && other[1] <= NONE * kept[1];
}

_Static_assert((int)AIM_NODES <= (int)AIM_PART && (int)AIM_TESTS <= (int)AIM_PART, "room for all");
static void fitted_at(const sgt_aim_map *of, size_t count, const double x[], const double y[], double u[],
                      double v[])
{
    const size_t whole = count - count % AIM_FEW;
    double few[4][AIM_FEW] = {{0}};
    for (size_t i = 0; i < whole; i += AIM_FEW) few_fitted_at(of, x + i, y + i, u + i, v + i);
    if (whole == count) return;
    for (size_t i = whole; i < count; i++) few[0][i - whole] = x[i], few[1][i - whole] = y[i];
    few_fitted_at(of, few[0], few[1], few[2], few[3]);
    for (size_t i = whole; i < count; i++) u[i] = few[2][i - whole], v[i] = few[3][i - whole];
}

static const double NEAR_ENOUGH = 2, DISC = 1 + 0x1p-40;

static void set_wanted(const sgt_launcher *from, const sgt_field_beam *b, aim_many *m, size_t count,
                       const sgt_pupil_point at[])
{
    for (size_t i = 0; i < count; i++) {
        const sgt_vec2 q = sgt_vignetted(b, at[i].x, at[i].y);
        m->wanted[i] = (sgt_vec2){q.x * from->stop_radius, q.y * from->stop_radius};
        m->x[i] = at[i].x, m->y[i] = at[i].y;
    }
}

static bool is_none(sgt_vec3 a) { return a.x == 0 && a.y == 0 && a.z == 0; }

static sgt_vec3 unit_at(const sgt_beam *b, double u, double v)
{
    const sgt_vec3 way = along3(along3(b->d, u, b->du), v, b->dv);
    const double by = 1 / length3(way);
    return (sgt_vec3){way.x * by, way.y * by, way.z * by};
}

/* Rays at u, v, of unit length.  From afar all have one direction. */
static void rays_at(const sgt_beam *f, size_t count, const double *restrict u, const double *restrict v,
                    double *const o[3], double *const d[3])
{
    const sgt_beam b = *f;
    const bool afar = is_none(b.du) && is_none(b.dv);
    const sgt_vec3 common = unit_at(&b, 0, 0);
    double *restrict ox = o[0], *restrict oy = o[1], *restrict oz = o[2];
    double *restrict dx = d[0], *restrict dy = d[1], *restrict dz = d[2];
    for (size_t i = 0; i < count; i++) {
        const sgt_vec3 at = along3(along3(b.o, u[i], b.ou), v[i], b.ov);
        ox[i] = at.x, oy[i] = at.y, oz[i] = at.z;
    }
    for (size_t i = 0; afar && i < count; i++) dx[i] = common.x, dy[i] = common.y, dz[i] = common.z;
    for (size_t i = 0; !afar && i < count; i++) {
        const sgt_vec3 way = unit_at(&b, u[i], v[i]);
        dx[i] = way.x, dy[i] = way.y, dz[i] = way.z;
    }
}

/* Traces rays to the stop: through the open elements, or as they are, with the errors of the points. */
static void trace_guides(const aim_search *s, aim_many *m, bool errors, size_t count, sgt_rays rays)
{
    const sgt_options near = {.pick = SGT_NEAR_SEED};
    m->guide[s->element].hits.p_err = errors ? m->guide_err : NULL;
    sgt_trace_batch(s->element + 1, errors ? s->e : s->open, s->before, count, rays,
                    (sgt_traced){.fate = m->fate, .passed = m->passed}, m->guide, &near);
}

/* A step: moves x, y of rays that were traced by as much as they miss.  Those that did not get there become
 * NaN, and are found out later. */
static void step_by_miss(const sgt_launcher *from, const sgt_field_beam *b, const aim_search *s, aim_many *m,
                         size_t first, size_t count)
{
    const sgt_vec2 turn = b->turn; /* (sgt_vignetted) */
    const double by_x = 1 / (from->stop_radius * b->scale.x), by_y = 1 / (from->stop_radius * b->scale.y);
    const double *px = m->guide[s->element].hits.p[0], *py = m->guide[s->element].hits.p[1];
    for (size_t k = 0; k < count; k++) {
        const size_t i = first + k;
        const double x = px[k] - m->wanted[i].x, y = py[k] - m->wanted[i].y;
        m->x[i] -= (x * turn.x + y * turn.y) * by_x, m->y[i] -= (y * turn.x - x * turn.y) * by_y;
    }
}

/* Aims by the fitted map in so many steps.  m->wanted, x, y: set.  part: rays at a time. */
static void guess_rays(const sgt_launcher *from, const sgt_field_beam *b, const sgt_beam *f,
                       const aim_search *s, const sgt_aim_map *of, aim_many *m, size_t part, int steps,
                       size_t count, double *const o[3], double *const d[3])
{
    for (size_t first = 0; first < count; first += part) {
        const size_t some = count - first < part ? count - first : part;
        double *const at[3] = {o[0] + first, o[1] + first, o[2] + first};
        double *const way[3] = {d[0] + first, d[1] + first, d[2] + first};
        const sgt_rays rays = {.o = {at[0], at[1], at[2]}, .d = {way[0], way[1], way[2]}};
        for (int step = 0; step <= steps; step++) {
            if (step > 0) trace_guides(s, m, false, some, rays), step_by_miss(from, b, s, m, first, some);
            fitted_at(of, some, m->x + first, m->y + first, m->u + first, m->v + first);
            rays_at(f, some, m->u + first, m->v + first, at, way);
        }
    }
}

static bool is_there(const aim_many *m, size_t i, double px, double py, double p_err, sgt_pupil_point at)
{
    const double x = px - m->wanted[i].x, y = py - m->wanted[i].y;
    return (p_err < HUGE_VAL) & (sqrt(x * x + y * y) <= NEAR_ENOUGH * p_err) &
           (at.x * at.x + at.y * at.y <= DISC);
}

/* Does a ray that is clipped in front of the stop, or there, get to its point if nothing clips it? */
static bool gets_there(const aim_many *m, const aim_search *s, size_t i, const sgt_ray *ray,
                       sgt_pupil_point at)
{
    sgt_fate fate;
    const size_t passed =
        sgt_trace_through(s->element + 1, s->e, s->before, ray, s->own, s->passages, &fate);
    const sgt_hit *hit = &s->passages[s->element].hit;
    return passed >= s->element && hit->status > 0 && is_there(m, i, hit->p.x, hit->p.y, hit->p_err, at);
}

/* Lists in `left` the rays o, d that were traced and are not accepted; returns how many. */
static size_t which_missed(const aim_many *m, const aim_search *s, size_t count, const sgt_pupil_point at[],
                           double *const o[3], double *const d[3], sgt_traced traced, const sgt_hits *hits,
                           size_t left[])
{
    const double *px = hits->p[0], *py = hits->p[1], *p_err = hits->p_err;
    size_t missed = 0, still = 0;
    for (size_t i = 0; i < count; i++) {
        left[missed] = i;
        missed += !(((size_t)traced.passed[i] > s->element) & is_there(m, i, px[i], py[i], p_err[i], at[i]));
    }
    for (size_t k = 0; k < missed; k++) {
        const size_t i = left[k];
        const bool clipped = traced.fate[i] == SGT_CLIPPED && (size_t)traced.passed[i] <= s->element;
        const sgt_ray ray = {.o = {o[0][i], o[1][i], o[2][i]}, .d = {d[0][i], d[1][i], d[2][i]}};
        left[still] = i;
        still += !(clipped && gets_there(m, s, i, &ray, at[i]));
    }
    return still;
}

/* Aims by the fitted map; returns how many are left, with their numbers in m->left. */
static size_t aim_guided(const sgt_launcher *from, const sgt_field_beam *b, const sgt_beam *f,
                         const aim_search *s, const sgt_aim_map *of, aim_many *m, size_t count,
                         const sgt_pupil_point at[], sgt_launched out[])
{
    double *const o[3] = {m->o[0], m->o[1], m->o[2]}, *const d[3] = {m->d[0], m->d[1], m->d[2]};
    set_wanted(from, b, m, count, at);
    guess_rays(from, b, f, s, of, m, count, of->steps, count, o, d);
    trace_guides(s, m, true, count, (sgt_rays){.o = {o[0], o[1], o[2]}, .d = {d[0], d[1], d[2]}});
    for (size_t i = 0; i < count; i++)
        out[i] = (sgt_launched){.status = SGT_MET, .wanted = m->wanted[i],
                                .ray = {.o = {o[0][i], o[1][i], o[2][i]}, .d = {d[0][i], d[1][i], d[2][i]}}};
    return which_missed(m, s, count, at, o, d, (sgt_traced){.fate = m->fate, .passed = m->passed},
                        &m->guide[s->element].hits, m->left);
}

/* Sets how many steps the map needs, and whether it is worth its while. */
static void try_map(const sgt_launcher *from, const sgt_field_beam *b, const sgt_beam *f, const aim_search *s,
                    const sgt_aim_nodes *nodes, aim_many *m, sgt_aim_map *of)
{
    enum { STEPS_MOST = 3, FEW = 16 }; /* one of so many may be left */
    size_t reached = 1, missed = 1;    /* of the rays that get to the stop, or are clipped */
    for (of->steps = 0; of->steps < STEPS_MOST && FEW * missed > reached;) {
        of->steps++;
        const size_t left = aim_guided(from, b, f, s, of, m, AIM_TESTS, nodes->test, m->own);
        reached = 0;
        for (size_t i = 0; i < AIM_TESTS; i++)
            reached += m->fate[i] == SGT_PASSED || m->fate[i] == SGT_CLIPPED;
        missed = left + reached - AIM_TESTS;
    }
    of->fitted = 2 * missed < reached;
}

/* Fits the map to the rays through the nodes, if all are there and none is folded. */
static void fit_map(const sgt_launcher *from, const sgt_field_beam *b, const sgt_beam *f,
                    const aim_search *s, const sgt_aim_nodes *nodes, aim_many *m, sgt_aim_map *of)
{
    const double TAME = 16;
    double least = HUGE_VAL, most = 0;
    if (!of->mapped || from->sense == 0) return;
    aim_part(from, b, f, s, of, m, AIM_NODES, nodes->at, m->own);
    for (size_t i = 0; i < AIM_NODES; i++) {
        const double determinant = m->change[0][i] * from->sense;
        if (m->found[i].status != SGT_MET || !(determinant > 0)) return;
        least = fmin(least, determinant), most = fmax(most, determinant);
    }
    if (!(most <= TAME * least)) return;
    for (size_t t = 0; t < AIM_TERMS; t++) {
        of->fit[0][t] = of->fit[1][t] = 0;
        for (size_t i = 0; i < AIM_NODES; i++)
            of->fit[0][t] += nodes->by[t][i] * m->found[i].u,
                of->fit[1][t] += nodes->by[t][i] * m->found[i].v;
    }
    of->mirrored = is_mirrored(of);
    try_map(from, b, f, s, nodes, m, of);
}

/* Some rays: those by the map, then the others. */
static void aim_some(const sgt_launcher *from, const sgt_field_beam *b, const sgt_beam *f,
                     const aim_search *s, const sgt_aim_map *of, aim_many *m, size_t count,
                     const sgt_pupil_point at[], sgt_launched out[])
{
    if (!of->fitted) {
        aim_part(from, b, f, s, of, m, count, at, out);
        return;
    }
    const size_t more = aim_guided(from, b, f, s, of, m, count, at, out);
    for (size_t i = 0; i < more; i++) m->other[i] = at[m->left[i]];
    if (more) aim_part(from, b, f, s, of, m, more, m->other, m->own);
    for (size_t i = 0; i < more; i++) out[m->left[i]] = m->own[i];
}

struct sgt_aim_room {
    sgt_beam f;
    aim_search search;
    sgt_passage *passages;
    sgt_element *bare, *open, *own;
    aim_many *many;
    size_t part;
};

void sgt_aim_room_free(const sgt_launcher *from, sgt_aim_room *r)
{
    if (!r) return;
    sgt_launch_forget(from, r->many);
    sgt_launch_forget(from, r->passages);
    sgt_launch_forget(from, r->bare); /* and those behind it */
    sgt_launch_forget(from, r);
}

sgt_aim_room *sgt_aim_room_new(const sgt_launcher *from, size_t count)
{
    const size_t stop = from->lens->stop, fit = AIM_HITS / (stop + 1);
    const size_t most = fit < 1 ? 1 : fit < AIM_PART ? fit : AIM_PART;
    sgt_aim_room *r = sgt_launch_take(from, 1, sizeof *r);
    if (!r) return NULL;
    r->part = count < most ? count : most;
    r->passages = sgt_launch_take(from, stop + 1, sizeof *r->passages);
    r->bare = sgt_launch_take(from, 3 * (stop + 1), sizeof *r->bare);
    r->many = aim_many_new(from, stop + 1, r->part);
    if (r->passages && r->bare && r->many) {
        r->open = r->bare + stop + 1, r->own = r->open + stop + 1;
        return r;
    }
    sgt_aim_room_free(from, r);
    return NULL;
}

/* Sets the beam and the elements up to the stop. */
static void begin_aims(const sgt_launcher *from, sgt_aim_room *r, const sgt_field_beam *b,
                       const sgt_element e[], double before)
{
    const size_t stop = from->lens->stop;
    for (size_t i = 0; i <= stop; i++) r->bare[i] = e[i];
    r->bare[stop].phase = NULL; /* what the stop does to light has no say in where it is met */
    for (size_t i = 0; i <= stop; i++)
        r->open[i] = r->bare[i], r->open[i].semi_diameter = 0, r->open[i].aperture = NULL;
    r->f = family_of(b);
    r->search = (aim_search){stop, r->bare, before, r->passages, .open = r->open, .own = r->own};
}

bool sgt_aim_map_of(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[], double before,
                    const sgt_aim_nodes *nodes, sgt_aim_map *out)
{
    sgt_aim_room *r = sgt_aim_room_new(from, AIM_NODES);
    if (!r) return false;
    begin_aims(from, r, b, e, before);
    *out = map_of(&r->f, &r->search);
    if (r->part == AIM_NODES) fit_map(from, b, &r->f, &r->search, nodes, r->many, out);
    sgt_aim_room_free(from, r);
    return true;
}

void sgt_aim_rays(const sgt_launcher *from, sgt_aim_room *r, const sgt_field_beam *b, const sgt_element e[],
                  double before, const sgt_aim_map *of, size_t count, const sgt_pupil_point at[],
                  sgt_launched out[])
{
    sgt_aim_map own;
    begin_aims(from, r, b, e, before);
    if (!of) own = map_of(&r->f, &r->search);
    for (size_t first = 0; first < count; first += r->part)
        aim_some(from, b, &r->f, &r->search, of ? of : &own, r->many,
                 count - first < r->part ? count - first : r->part, at + first, out + first);
}

void sgt_aim_guess(const sgt_launcher *from, sgt_aim_room *r, const sgt_field_beam *b, const sgt_element e[],
                   double before, const sgt_aim_map *of, size_t count, const sgt_pupil_point at[],
                   double *const o[3], double *const d[3])
{
    begin_aims(from, r, b, e, before);
    set_wanted(from, b, r->many, count, at);
    guess_rays(from, b, &r->f, &r->search, of, r->many, r->part, of->steps, count, o, d);
}

size_t sgt_aim_missed(const sgt_aim_room *r, size_t count, const sgt_pupil_point at[], double *const o[3],
                      double *const d[3], sgt_traced traced, const sgt_hits *hits, size_t left[])
{
    return which_missed(r->many, &r->search, count, at, o, d, traced, hits, left);
}

/* ------------------------------------------------------------ real image heights */

/* The chief rays through the centre of the paraxial pupil, by their slopes or by their object point.
 * b->object is the one on the axis. */
static sgt_beam chiefs_of(const sgt_lens *l, const sgt_field_beam *b)
{
    if (b->finite) {
        const sgt_vec2 tilt = l->object_slope;
        sgt_beam f = {.o = {0, 0, b->object.z}, .ou = {1, 0, tilt.x}, .ov = {0, 1, tilt.y}, .d = {0, 0, 1}};
        const double ahead = b->cone > 0 ? 0 : copysign(1, b->pupil - b->object.z); /* 0: telecentric */
        if (ahead != 0) {
            f.d.z = fabs(b->pupil - b->object.z), f.du.x = f.dv.y = -ahead;
            f.du.z = -ahead * tilt.x, f.dv.z = -ahead * tilt.y;
        }
        return f;
    }
    double way = b->pupil - b->front;
    return (sgt_beam){.o = {0, 0, b->front}, .ou = {-way, 0, 0}, .ov = {0, -way, 0}, .d = {0, 0, 1},
                      .du = {1, 0, 0}, .dv = {0, 1, 0}, .u = {-SLOPES, SLOPES}, .v = {-SLOPES, SLOPES}};
}

static void set_point(const sgt_launcher *from, sgt_field_beam *b, sgt_vec2 at)
{
    if (b->finite) sgt_beam_point(from, b, at.x, at.y);
    else sgt_beam_point(from, b, atan(at.x) / RADIANS, atan(at.y) / RADIANS);
}

/* What a search for a field works with. */
typedef struct field_search {
    const sgt_launcher *from;
    sgt_element *open;       /* room for the lens without what clips a ray */
    sgt_passage *passages;
    size_t count;
} field_search;

/* Where the chief ray through the centre of the stop meets the image, for a field at `at`. */
static bool image_of(const field_search *s, sgt_field_beam b, sgt_vec2 at, sgt_vec2 *image, sgt_vec2 *pupil)
{
    set_point(s->from, &b, at);
    const sgt_beam f = family_of(&b);
    sgt_fate fate;
    int where;
    aim_search one = {s->from->lens->stop, s->from->element, s->from->before, s->passages, .starts = 1,
                      .start = {*pupil}, .chief = true};
    sgt_aiming a = aim_at(&one, &f, (sgt_vec2){0, 0}, &where);
    if (a.status != SGT_MET) return false;
    *pupil = (sgt_vec2){a.u, a.v};
    size_t passed = sgt_trace_through(s->count, s->from->element, s->from->before, &a.ray, s->open,
                                      s->passages, &fate);
    if (passed < s->count) return false;
    *image = (sgt_vec2){s->passages[s->count - 1].hit.p.x, s->passages[s->count - 1].hit.p.y};
    return true;
}

/* Newton's method for the field whose aimed chief ray meets the image at `wanted`. */
static bool solve_field(const field_search *s, const sgt_field_beam *b, sgt_vec2 wanted, sgt_vec2 *at)
{
    const sgt_lens *l = s->from->lens;
    /* of a telecentric object the pupil is at infinity */
    double size = b->cone > 0 ? fabs(l->object_distance) : fabs(b->object.z - b->pupil);
    if (size == 0) size = hypot(wanted.x, wanted.y); /* such an object at the first vertex */
    const double scale = 1e-5 * (b->finite ? size : 1), radius = b->cone > 0 ? b->cone * size : b->radius;
    double least = HUGE_VAL;
    sgt_vec2 best = *at, pupil = {0, 0};
    for (int i = 0; i < STEPS; i++) {
        sgt_vec2 f, fx, fy, x = {at->x + scale, at->y}, y = {at->x, at->y + scale};
        if (!image_of(s, *b, *at, &f, &pupil)) break;
        double miss = hypot(f.x - wanted.x, f.y - wanted.y);
        if (!(miss < least)) break; /* as near as rounding allows, or off the way */
        least = miss, best = *at;
        if (!image_of(s, *b, x, &fx, &pupil) || !image_of(s, *b, y, &fy, &pupil)) break;
        double a = (fx.x - f.x) / scale, c = (fy.x - f.x) / scale, e = (fx.y - f.y) / scale,
               g = (fy.y - f.y) / scale, by = a * g - c * e, u = wanted.x - f.x, v = wanted.y - f.y;
        if (!(fabs(by) > 0)) break;
        at->x += (g * u - c * v) / by, at->y += (a * v - e * u) / by;
    }
    *at = best;
    return least <= 1e-9 * (hypot(wanted.x, wanted.y) + 1e-3 * radius);
}

/* *limit: how far slopes or objects were searched; 0: by steps from the paraxial one. */
static bool find_field(const field_search *s, const sgt_field_beam *b, sgt_vec2 wanted, sgt_vec2 *found,
                       double *limit)
{
    const sgt_lens *l = s->from->lens;
    if (l->aim != SGT_LENS_AIM_PUPIL) return solve_field(s, b, wanted, found);
    sgt_beam f = chiefs_of(l, b);
    if (b->finite) {
        double reach =
            WIDER * (hypot(found->x, found->y) + (b->cone > 0 ? hypot(wanted.x, wanted.y) : b->radius));
        f.u = f.v = (sgt_interval){-reach, reach};
    }
    aim_search one = {l->count - 1, s->from->element, s->from->before, s->passages, .starts = 1,
                      .start = {*found}};
    const sgt_aiming a = aim_in(&one, &f, wanted, 0, 0);
    *limit = b->finite ? f.u.hi : SLOPES;
    *found = (sgt_vec2){a.u, a.v};
    return a.status == SGT_MET;
}

bool sgt_aim_field(const sgt_launcher *from, sgt_field_beam *b, sgt_vec2 wanted, sgt_error *error)
{
    const sgt_lens *l = from->lens;
    if (b->finite) b->object.z = l->surface[0].z - l->object_distance;
    double by = b->finite ? 1 / from->data.magnification : from->data.power / from->before;
    sgt_vec2 found = {isfinite(by) ? wanted.x * by : 0, isfinite(by) ? wanted.y * by : 0};
    field_search s = {.from = from, .count = l->count};
    s.open = sgt_launch_take(from, l->count, sizeof *s.open);
    s.passages = sgt_launch_take(from, l->count, sizeof *s.passages);
    const bool room = s.open && s.passages;
    bool fine = room;
    double limit = 0;
    if (room) fine = find_field(&s, b, wanted, &found, &limit);
    sgt_launch_forget(from, s.open);
    sgt_launch_forget(from, s.passages);
    if (fine) {
        set_point(from, b, found);
        return true;
    }
    if (!room) return sgt_launch_memory(from, error);
    static const char way_out[] = "there may be one yet; give --field or --rays";
    if (limit == 0)
        return sgt_launch_fail(from, error, "fields",
                               "no chief ray was found that meets the image at [%g, %g] by %d steps of "
                               "Newton's method from the paraxial field; %s",
                               wanted.x, wanted.y, (int)STEPS, way_out);
    return sgt_launch_fail(from, error, "fields",
                           "no chief ray was found that meets the image at [%g, %g], with %s up to %g; %s",
                           wanted.x, wanted.y, b->finite ? "object heights" : "slopes", limit, way_out);
}

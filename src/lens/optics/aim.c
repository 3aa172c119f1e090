// SPDX-License-Identifier: MIT
/* aim.c - rays aimed at the stop, by search.
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
 * FOLDS.  The map from the pupil to the stop has a determinant.  On the axis of any lens it is not 0.
 * Where it has the other sign, neighbouring rays reach the stop in reversed order: between there and
 * the axis the pupil is folded, and points near the fold have two rays. */
#include "aim.h"

static const double REACH[] = {6, 60, 600}; /* radii of the pupil */
enum { REACHES = 3, TOLD = 16 };
/* of a box in which a ray is not expected: what most that are there need, and a proof of a far region */
static const double NEAR = 2;
enum { FEW_TRACES = 60, FEW_BOXES = 300 };
enum { AIM_HITS = 1 << 16 }; /* of rays that are aimed side by side; fewer rays of a long row */

sgt_beam sgt_aim_family(const sgt_field_beam *b)
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

sgt_aiming sgt_aim_in_box(aim_search *s, const sgt_beam *f, sgt_vec2 wanted, int max_traces, int max_boxes)
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

sgt_aiming sgt_aim_in_family(aim_search *s, const sgt_beam *f, sgt_vec2 wanted, int *where)
{
    sgt_interval u, v;
    sgt_beam box;
    sgt_aiming a;
    s->nearest = (sgt_attempt){.miss = (double)NAN};
    *where = s->home;
    if (s->home > 0) {
        box = reaching(f, s->home);
        a = sgt_aim_in_box(s, &box, wanted, 0, -1);
        if (a.status == SGT_MET) return a;
    }
    *where = 0;
    box = reaching(f, 0);
    a = sgt_aim_in_box(s, &box, wanted, 0, -1);
    if (a.status == SGT_MET || a.status == SGT_AIMED_INVALID) return a;
    const bool bounded = sgt_beam_bounds(s->element, s->e, s->before, f, wanted, &u, &v),
               empty = bounded && !(u.lo <= u.hi), inside = empty || (bounded && are_within(u, v, REACH[0])),
               near = empty || (bounded && are_within(u, v, NEAR * REACH[0]));
    if (!near || s->chief) a = sgt_aim_in_box(s, &box, wanted, 0, 0);
    if (a.status == SGT_MET) return a;
    bool none = a.status == SGT_NO_SUCH_RAY;
    s->within = none ? REACH[0] : 0;
    a.status = empty || (none && inside) ? SGT_NO_SUCH_RAY : SGT_AIMED_UNDECIDED;
    if (bounded && a.status != SGT_NO_SUCH_RAY) {
        box = boxed(*f, u, v);
        a = sgt_aim_in_box(s, &box, wanted, 0, 0);
        if (a.status == SGT_MET) return a;
    }
    const sgt_aiming last = a;
    if (!s->chief && (inside || a.status == SGT_NO_SUCH_RAY)) return a;
    for (int i = 1; i < REACHES; i++) {
        box = reaching(f, i);
        a = sgt_aim_in_box(s, &box, wanted, s->chief ? 0 : FEW_TRACES, none ? FEW_BOXES : -1);
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
    const sgt_beam f = sgt_aim_family(&b);
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
static void determinants(const sgt_aim_room *r, size_t count)
{
    aim_many *m = r->many;
    const aim_search *s = &r->search;
    const sgt_beam *f = &r->f;
    const double by[12] = {f->ou.x, f->ou.y, f->ou.z, f->du.x, f->du.y, f->du.z,
                           f->ov.x, f->ov.y, f->ov.z, f->dv.x, f->dv.y, f->dv.z};
    sgt_ray_changes change[2] = {{.opl = NULL}, {.opl = NULL}};
    const sgt_traces traces = {
        count, {.o = {m->o[0], m->o[1], m->o[2]}, .d = {m->d[0], m->d[1], m->d[2]}}, m->at};
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 2; c++)
            change[c].p[k] = m->change[6 * c + k], change[c].d[k] = m->change[6 * c + 3 + k];
    for (size_t i = 0; i < count; i++) {
        const sgt_ray *ray = &m->found[i].ray;
        m->o[0][i] = ray->o.x, m->o[1][i] = ray->o.y, m->o[2][i] = ray->o.z;
        m->d[0][i] = ray->d.x, m->d[1][i] = ray->d.y, m->d[2][i] = ray->d.z;
        for (int k = 0; k < 12; k++) m->change[k][i] = by[k];
    }
    sgt_trace_sensitivity_batch(s->element + 1, s->e, s->before, &traces, 2, change, change);
    for (size_t i = 0; i < count; i++)
        m->change[0][i] = m->change[0][i] * m->change[7][i] - m->change[6][i] * m->change[1][i];
}

sgt_aim_map sgt_aim_chief(const sgt_aim_room *r)
{
    sgt_aim_map of = {.map = {.determinant = 0}};
    const sgt_beam *f = &r->f;
    aim_search search = r->search;
    search.starts = 1, search.start[0] = (sgt_vec2){0, 0}, search.chief = true;
    of.chief = sgt_aim_in_family(&search, f, (sgt_vec2){0, 0}, &of.home);
    if (of.chief.status != SGT_MET) of.home = 0;
    else of.map = linear_at(search.element, search.e, search.before, f, &of.chief.ray, r->passages);
    of.mapped = fabs(of.map.determinant) > 0;
    return of;
}

/* Ray i, which the loops have left, as the whole family has it. */
static void search_further(const sgt_aim_room *r, size_t i, const sgt_pupil_point *at, sgt_launched *out)
{
    const aim_many *m = r->many;
    const double sense = r->of.from->sense;
    int where;
    aim_search one = r->search;
    one.starts = 2, one.start[0] = m->start[2 * i], one.start[1] = m->start[2 * i + 1];
    one.home = r->of.map->home, one.chief = at->x == 0 && at->y == 0;
    const sgt_aiming a = sgt_aim_in_family(&one, &r->f, m->wanted[i], &where);
    *out = (sgt_launched){.ray = of_unit_length(a.ray), .status = a.status, .wanted = m->wanted[i]};
    if (a.status != SGT_MET) out->within = one.within, out->nearest = one.nearest;
    else if (sense != 0)
        out->folded =
            linear_at(one.element, one.e, one.before, &r->f, &a.ray, one.passages).determinant * sense < 0;
}

/* A ray that is found in the box of the chief ray is the one that sgt_aim_in_family finds first.  So all are
 * looked for there side by side, and it does the rest. */
void sgt_aim_search_for(sgt_aim_room *r, size_t count, const sgt_pupil_point at[], sgt_launched out[])
{
    aim_many *m = r->many;
    const aim_search *s = &r->search;
    const sgt_launcher *from = r->of.from;
    const sgt_aim_map *of = r->of.map;
    const sgt_beam box = reaching(&r->f, of->home);
    const sgt_linear *map = &of->map;
    for (size_t i = 0; i < count; i++) {
        const sgt_vec2 q = sgt_vignetted(r->of.beam, at[i].x, at[i].y);
        m->wanted[i] = (sgt_vec2){q.x * from->stop_radius, q.y * from->stop_radius};
        m->start[2 * i] = m->start[2 * i + 1] = q;
        if (!of->mapped) continue;
        const double x = m->wanted[i].x - of->chief.point.x, y = m->wanted[i].y - of->chief.point.y;
        m->start[2 * i].x = of->chief.u + (map->yv * x - map->xv * y) / map->determinant;
        m->start[2 * i].y = of->chief.v + (map->xu * y - map->yu * x) / map->determinant;
    }
    sgt_aim_batch(s->element, s->e, s->before, &box, &(sgt_aims){count, m->wanted, m->found, m->at},
                  s->passages, &(sgt_aim_options){.starts = 2, .start = m->start, .max_boxes = -1});
    if (from->sense != 0) determinants(r, count);
    for (size_t i = 0; i < count; i++) {
        const sgt_aiming *a = &m->found[i];
        out[i] = (sgt_launched){.ray = of_unit_length(a->ray), .status = a->status, .wanted = m->wanted[i],
                                .folded = from->sense != 0 && m->change[0][i] * from->sense < 0};
        if (a->status != SGT_MET) search_further(r, i, &at[i], &out[i]);
    }
}

/* ------------------------------------------------------------------------ the room */

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
        r->open = r->bare + stop + 1, r->clear = r->open + stop + 1;
        return r;
    }
    sgt_aim_room_free(from, r);
    return NULL;
}

void sgt_aim_begin(sgt_aim_room *r, const sgt_colour_beam *of)
{
    const size_t stop = of->from->lens->stop;
    for (size_t i = 0; i <= stop; i++) r->bare[i] = of->e[i];
    r->bare[stop].phase = NULL; /* what the stop does to light has no say in where it is met */
    for (size_t i = 0; i <= stop; i++)
        r->open[i] = r->bare[i], r->open[i].semi_diameter = 0, r->open[i].aperture = NULL;
    r->of = *of, r->of.e = r->bare;
    r->f = sgt_aim_family(of->beam);
    r->search = (aim_search){stop, r->bare, of->before, r->passages, .open = r->open, .own = r->clear};
}

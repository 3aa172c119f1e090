// SPDX-License-Identifier: MIT
/* aim_map.c - rays aimed at the stop by a fitted map.
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
 * fold between them, with none at any of them, has not been seen, and is not ruled out. */
#include "aim.h"
#include "widths.h"

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
    size_t few;
    few_fitted *const few_at = widest(&few);
    const size_t whole = count - count % few;
    double last[4][AIM_FEW_MOST] = {{0}};
    for (size_t i = 0; i < whole; i += few) few_at(of, x + i, y + i, u + i, v + i);
    if (whole == count) return;
    for (size_t i = whole; i < count; i++) last[0][i - whole] = x[i], last[1][i - whole] = y[i];
    few_at(of, last[0], last[1], last[2], last[3]);
    for (size_t i = whole; i < count; i++) u[i] = last[2][i - whole], v[i] = last[3][i - whole];
}

static const double NEAR_ENOUGH = 2, DISC = 1 + 0x1p-40;

static void set_wanted(const sgt_aim_room *r, size_t count, const sgt_pupil_point at[])
{
    aim_many *m = r->many;
    const double radius = r->of.from->stop_radius;
    for (size_t i = 0; i < count; i++) {
        const sgt_vec2 q = sgt_vignetted(r->of.beam, at[i].x, at[i].y);
        m->wanted[i] = (sgt_vec2){q.x * radius, q.y * radius};
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
static void trace_guides(const sgt_aim_room *r, bool errors, size_t count, sgt_rays rays)
{
    const aim_search *s = &r->search;
    aim_many *m = r->many;
    const sgt_options near = {.pick = SGT_NEAR_SEED};
    m->guide[s->element].hits.p_err = errors ? m->guide_err : NULL;
    sgt_trace_batch(s->element + 1, errors ? s->e : s->open, s->before, count, rays,
                    (sgt_traced){.fate = m->fate, .passed = m->passed}, m->guide, &near);
}

/* A step: moves x, y of rays that were traced by as much as they miss.  Those that did not get there become
 * NaN, and are found out later. */
static void step_by_miss(const sgt_aim_room *r, size_t first, size_t count)
{
    aim_many *m = r->many;
    const sgt_hits *stop = &m->guide[r->search.element].hits;
    const sgt_vec2 turn = r->of.beam->turn, scale = r->of.beam->scale; /* (sgt_vignetted) */
    const double radius = r->of.from->stop_radius;
    const double by_x = 1 / (radius * scale.x), by_y = 1 / (radius * scale.y);
    const double *px = stop->p[0], *py = stop->p[1];
    for (size_t k = 0; k < count; k++) {
        const size_t i = first + k;
        const double x = px[k] - m->wanted[i].x, y = py[k] - m->wanted[i].y;
        m->x[i] -= (x * turn.x + y * turn.y) * by_x, m->y[i] -= (y * turn.x - x * turn.y) * by_y;
    }
}

/* Aims by the map `of` in as many steps as it needs.  m->wanted, x, y: set. */
static void guess_rays(const sgt_aim_room *r, const sgt_aim_map *of, size_t count, double *const o[3],
                       double *const d[3])
{
    aim_many *m = r->many;
    for (size_t first = 0; first < count; first += r->part) {
        const size_t some = count - first < r->part ? count - first : r->part;
        double *const at[3] = {o[0] + first, o[1] + first, o[2] + first};
        double *const way[3] = {d[0] + first, d[1] + first, d[2] + first};
        const sgt_rays rays = {.o = {at[0], at[1], at[2]}, .d = {way[0], way[1], way[2]}};
        for (int step = 0; step <= of->steps; step++) {
            if (step > 0) trace_guides(r, false, some, rays), step_by_miss(r, first, some);
            fitted_at(of, some, m->x + first, m->y + first, m->u + first, m->v + first);
            rays_at(&r->f, some, m->u + first, m->v + first, at, way);
        }
    }
}

static bool is_there(const aim_many *m, size_t i, double px, double py, double p_err, sgt_pupil_point at)
{
    const double x = px - m->wanted[i].x, y = py - m->wanted[i].y;
    return (p_err < HUGE_VAL) & (sqrt(x * x + y * y) <= NEAR_ENOUGH * p_err) &
           (at.x * at.x + at.y * at.y <= DISC);
}

/* Does ray i, which is clipped in front of the stop, or there, get to its point if nothing clips it? */
static bool gets_there(const sgt_aim_room *r, size_t i, const sgt_ray *ray, sgt_pupil_point at)
{
    const aim_search *s = &r->search;
    sgt_fate fate;
    const size_t passed =
        sgt_trace_through(s->element + 1, s->e, s->before, ray, s->own, s->passages, &fate);
    const sgt_hit *hit = &s->passages[s->element].hit;
    return passed >= s->element && hit->status > 0 &&
           is_there(r->many, i, hit->p.x, hit->p.y, hit->p_err, at);
}

size_t sgt_aim_missed(const sgt_aim_room *r, size_t count, const sgt_pupil_point at[], double *const o[3],
                      double *const d[3], sgt_traced traced, const sgt_hits *hits, size_t left[])
{
    const size_t stop = r->search.element;
    const double *px = hits->p[0], *py = hits->p[1], *p_err = hits->p_err;
    size_t missed = 0, still = 0;
    for (size_t i = 0; i < count; i++) {
        left[missed] = i;
        missed += !(((size_t)traced.passed[i] > stop) & is_there(r->many, i, px[i], py[i], p_err[i], at[i]));
    }
    for (size_t k = 0; k < missed; k++) {
        const size_t i = left[k];
        const bool clipped = traced.fate[i] == SGT_CLIPPED && (size_t)traced.passed[i] <= stop;
        const sgt_ray ray = {.o = {o[0][i], o[1][i], o[2][i]}, .d = {d[0][i], d[1][i], d[2][i]}};
        left[still] = i;
        still += !(clipped && gets_there(r, i, &ray, at[i]));
    }
    return still;
}

/* Aims by the map `of`; returns how many are left, with their numbers in m->left. */
static size_t aim_guided(const sgt_aim_room *r, const sgt_aim_map *of, size_t count,
                         const sgt_pupil_point at[], sgt_launched out[])
{
    aim_many *m = r->many;
    double *const o[3] = {m->o[0], m->o[1], m->o[2]}, *const d[3] = {m->d[0], m->d[1], m->d[2]};
    set_wanted(r, count, at);
    guess_rays(r, of, count, o, d);
    trace_guides(r, true, count, (sgt_rays){.o = {o[0], o[1], o[2]}, .d = {d[0], d[1], d[2]}});
    for (size_t i = 0; i < count; i++)
        out[i] = (sgt_launched){.status = SGT_MET, .wanted = m->wanted[i],
                                .ray = {.o = {o[0][i], o[1][i], o[2][i]}, .d = {d[0][i], d[1][i], d[2][i]}}};
    return sgt_aim_missed(r, count, at, o, d, (sgt_traced){.fate = m->fate, .passed = m->passed},
                          &m->guide[r->search.element].hits, m->left);
}

/* Sets how many steps the map needs, and whether it is worth its while. */
static void try_map(const sgt_aim_room *r, const sgt_aim_nodes *nodes, sgt_aim_map *of)
{
    enum { STEPS_MOST = 3, FEW = 16 }; /* one of so many may be left */
    aim_many *m = r->many;
    size_t reached = 1, missed = 1;    /* of the rays that get to the stop, or are clipped */
    for (of->steps = 0; of->steps < STEPS_MOST && FEW * missed > reached;) {
        of->steps++;
        const size_t left = aim_guided(r, of, AIM_TESTS, nodes->test, m->own);
        reached = 0;
        for (size_t i = 0; i < AIM_TESTS; i++)
            reached += m->fate[i] == SGT_PASSED || m->fate[i] == SGT_CLIPPED;
        missed = left + reached - AIM_TESTS;
    }
    of->fitted = 2 * missed < reached;
}

/* Fits the map, which r->of.map is, to the rays through the nodes, if all are there and none is folded. */
static void fit_map(sgt_aim_room *r, const sgt_aim_nodes *nodes, sgt_aim_map *of)
{
    const double TAME = 16, sense = r->of.from->sense;
    const aim_many *m = r->many;
    double least = HUGE_VAL, most = 0;
    if (!of->mapped || sense == 0) return;
    sgt_aim_search_for(r, AIM_NODES, nodes->at, r->many->own);
    for (size_t i = 0; i < AIM_NODES; i++) {
        const double determinant = m->change[0][i] * sense;
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
    try_map(r, nodes, of);
}

bool sgt_aim_map_of(const sgt_colour_beam *of, const sgt_aim_nodes *nodes, sgt_aim_map *out)
{
    sgt_aim_room *r = sgt_aim_room_new(of->from, AIM_NODES);
    if (!r) return false;
    sgt_aim_begin(r, of);
    *out = sgt_aim_chief(r), r->of.map = out;
    if (r->part == AIM_NODES) fit_map(r, nodes, out);
    sgt_aim_room_free(of->from, r);
    return true;
}

/* Some rays: those by the map, then the others. */
static void aim_some(sgt_aim_room *r, size_t count, const sgt_pupil_point at[], sgt_launched out[])
{
    aim_many *m = r->many;
    if (!r->of.map->fitted) {
        sgt_aim_search_for(r, count, at, out);
        return;
    }
    const size_t more = aim_guided(r, r->of.map, count, at, out);
    for (size_t i = 0; i < more; i++) m->other[i] = at[m->left[i]];
    if (more) sgt_aim_search_for(r, more, m->other, m->own);
    for (size_t i = 0; i < more; i++) out[m->left[i]] = m->own[i];
}

void sgt_aim_rays(const sgt_colour_beam *of, sgt_aim_room *r, size_t count, const sgt_pupil_point at[],
                  sgt_launched out[])
{
    sgt_aim_begin(r, of);
    if (!of->map) r->own = sgt_aim_chief(r), r->of.map = &r->own;
    for (size_t first = 0; first < count; first += r->part)
        aim_some(r, count - first < r->part ? count - first : r->part, at + first, out + first);
}

void sgt_aim_guess(const sgt_colour_beam *of, sgt_aim_room *r, size_t count, const sgt_pupil_point at[],
                   double *const o[3], double *const d[3])
{
    sgt_aim_begin(r, of);
    set_wanted(r, count, at);
    guess_rays(r, of->map, count, o, d);
}

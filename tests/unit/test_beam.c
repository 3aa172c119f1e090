// SPDX-License-Identifier: MIT
/* Boxes of rays (beam.h) against sgt_trace: random lenses, random boxes of all widths, and rays of each box
 * at its corners, on its edges, inside, and climbing toward edges of apertures and toward total reflection.
 * No ray may contradict its box, and no number may leave its model.
 *
 * A box that is plainly decidable is decided, and what a model leaves out shrinks with the third power of the
 * box. */
#include "unit.h"

#include <sagitta/beam.h>
#include <sagitta/formula.h>
#include <sagitta/surfaces.h>

enum { MOST = 7, POLYGON = 5 };

/* A lens with room for all that its surfaces point to. */
typedef struct room {
    sgt_conic conic;
    sgt_even_asphere even;
    sgt_toroidal toroidal;
    sgt_biconic biconic;
    sgt_zernike zernike;
    sgt_polynomial_xy xy;
    sgt_odd_asphere odd;
    sgt_chebyshev chebyshev;
    sgt_q_con q_con;
    sgt_q_bfs q_bfs;
    sgt_grid grid;
    sgt_sum sum;
    sgt_quadric quadric;
    sgt_ellipsoid ellipsoid;
    sgt_torus torus;
    sgt_formula formula;
    sgt_formula_sag formula_sag;
    double tape[2000];
    sgt_surface terms[2];
    double a[16], b[36];
    sgt_phase phase;
    sgt_aperture aperture;
    sgt_aperture_item items[2];
    sgt_vec2 corners[POLYGON];
} room;
typedef struct lens {
    int n;
    sgt_element e[MOST];
    room of[MOST];
} lens;

static generator drawn;

static double about(double size) { return uniform(&drawn, -size, size); }

enum {
    CONIC,
    EVEN,
    TOROIDAL,
    BICONIC,
    ZERNIKE,
    XY,
    ODD,
    CHEBYSHEV,
    Q_CON,
    Q_BFS,
    GRID,
    SUM,
    FORMULA_SAG,
    QUADRIC,
    ELLIPSOID,
    TORUS,
    FORMULA,
    USERS,
    TYPES
};

/* A user's surface, F = z - a x^2 - b y^2 - c x y z, with `box`. */
static double users_value(const void *self, sgt_vec3 p, sgt_vec3 *n)
{
    const double *a = self;
    if (n)
        *n = (sgt_vec3){-2 * a[0] * p.x - a[2] * p.y * p.z, -2 * a[1] * p.y - a[2] * p.x * p.z,
                        1 - a[2] * p.x * p.y};
    return p.z - a[0] * p.x * p.x - a[1] * p.y * p.y - a[2] * p.x * p.y * p.z;
}

static bool users_box(const void *self, const sgt_interval p[3], sgt_interval *f, sgt_interval g[3],
                      sgt_interval h[6])
{
    const double *a = self;
    const sgt_interval xy = sgt_interval_product(p[0], p[1]), yz = sgt_interval_product(p[1], p[2]),
                       xz = sgt_interval_product(p[0], p[2]);
    const sgt_interval r = sgt_interval_sum(sgt_interval_scaled(sgt_interval_square(p[0]), a[0]),
                                            sgt_interval_scaled(sgt_interval_square(p[1]), a[1]));
    *f = sgt_interval_difference(
        p[2], sgt_interval_sum(r, sgt_interval_scaled(sgt_interval_product(xy, p[2]), a[2])));
    g[0] = sgt_interval_negative(
        sgt_interval_sum(sgt_interval_scaled(p[0], 2 * a[0]), sgt_interval_scaled(yz, a[2])));
    g[1] = sgt_interval_negative(
        sgt_interval_sum(sgt_interval_scaled(p[1], 2 * a[1]), sgt_interval_scaled(xz, a[2])));
    g[2] = sgt_interval_difference(sgt_interval_of(1), sgt_interval_scaled(xy, a[2]));
    h[0] = sgt_interval_of(-2 * a[0]), h[1] = sgt_interval_scaled(p[2], -a[2]),
    h[2] = sgt_interval_scaled(p[1], -a[2]);
    h[3] = sgt_interval_of(-2 * a[1]), h[4] = sgt_interval_scaled(p[0], -a[2]), h[5] = sgt_interval_of(0);
    return true;
}

static sgt_span users_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    const double t = -ray->o.z / ray->d.z, far = 20 / fabs(ray->d.z);
    return (sgt_span){.lo = t - far, .hi = t + far, .seed = t};
}

static const sgt_surface_ops users_ops = {
    .size = sizeof users_ops, .name = "users", .value = users_value, .span = users_span, .box = users_box};

/* A surface of a type.  strong: how bent it is; rim: its rim, 0 for none. */
static sgt_surface surface_of(int type, room *of, double strong, double rim)
{
    const double c = chance(&drawn, 0.15) ? 0 : strong * about(1 / 12.0),
                 k = chance(&drawn, 0.5) ? 0 : about(2);
    for (int i = 0; i < 16; i++) of->a[i] = strong * about(0.01);
    for (int i = 0; i < 36; i++) of->b[i] = about(0.01);
    switch (type) {
    case EVEN:
        of->even = (sgt_even_asphere){.c = c, .k = k, .semi_diameter = rim};
        for (int i = 0; i < 4; i++)
            of->even.a[i] = chance(&drawn, 0.6) ? strong * about(0.2) * pow(0.1, 1.6 * i + 1) : 0;
        return (sgt_surface){&sgt_even_asphere_ops, &of->even};
    case TOROIDAL:
        of->toroidal = (sgt_toroidal){.c = c, .k = k, .c_x = about(0.05), .semi_diameter = rim};
        of->toroidal.a[1] = about(1e-5);
        return (sgt_surface){&sgt_toroidal_ops, &of->toroidal};
    case BICONIC:
        of->biconic = (sgt_biconic){.c_x = c, .k_x = k, .c_y = about(0.05), .semi_diameter = rim};
        return (sgt_surface){&sgt_biconic_ops, &of->biconic};
    case ZERNIKE:
        of->zernike = (sgt_zernike){.c = c,
                                    .k = k,
                                    .semi_diameter = rim,
                                    .norm = 10,
                                    .order = chance(&drawn, 0.5) ? SGT_NOLL : SGT_FRINGE,
                                    .normalised = below(&drawn, 2),
                                    .a = {of->a, 1, 12}};
        return (sgt_surface){&sgt_zernike_ops, &of->zernike};
    case XY:
        for (int i = 0; i < 16; i++) of->a[i] *= pow(0.2, i / 4 + i % 4);
        of->xy = (sgt_polynomial_xy){.c = c, .k = k, .semi_diameter = rim, .a = {of->a, 4, 4}};
        return (sgt_surface){&sgt_polynomial_xy_ops, &of->xy};
    case ODD:
        of->odd = (sgt_odd_asphere){.c = c, .k = k, .semi_diameter = rim, .a = {0, about(1e-3), about(1e-4)}};
        return (sgt_surface){&sgt_odd_asphere_ops, &of->odd};
    case CHEBYSHEV:
        of->chebyshev = (sgt_chebyshev){
            .c = c, .k = k, .semi_diameter = rim, .norm_x = 10, .norm_y = 12, .a = {of->a, 4, 3}};
        return (sgt_surface){&sgt_chebyshev_ops, &of->chebyshev};
    case Q_CON:
        of->q_con = (sgt_q_con){.c = c, .k = k, .semi_diameter = rim, .norm = 10, .a = {of->a, 1, 6}};
        return (sgt_surface){&sgt_q_con_ops, &of->q_con};
    case Q_BFS:
        of->q_bfs = (sgt_q_bfs){.c = c, .semi_diameter = rim, .norm = 10, .a = {of->a, 1, 6}};
        return (sgt_surface){&sgt_q_bfs_ops, &of->q_bfs};
    case GRID: { /* of half of them all cells but one lie at the border */
        const size_t points = of->b[35] > 0 ? 4 : 6;
        const double step = points == 4 ? 6 : 4;
        of->grid = (sgt_grid){.c = c, .k = k, .semi_diameter = rim, .step_x = step, .step_y = step,
                              .z = {of->b, points, points}};
        sgt_grid_measure(&of->grid);
        return (sgt_surface){&sgt_grid_ops, &of->grid};
    }
    case SUM:
        of->terms[0] = surface_of(TOROIDAL, of, strong, rim),
        of->terms[1] = surface_of(Q_CON, of, strong, rim);
        of->sum = (sgt_sum){.c = c, .k = k, .semi_diameter = rim, .terms = of->terms, .count = 2};
        return (sgt_surface){&sgt_sum_ops, &of->sum};
    case FORMULA_SAG:
    case FORMULA: {
        const sgt_named names[] = {{"c", c}, {"a", about(0.01)}, {"b", about(0.001)}};
        const bool sag = type == FORMULA_SAG;
        const char *text =
            sag ? "c*(x^2+y^2)/2 + a*sin(x+y/2) + b*x*y^2" : "z - c*(x^2+y^2+z^2)/2 - a*cos(x-y) - b*x*y*z";
        sgt_tape *tape = sgt_formula_read(text, sag ? SGT_FORMULA_XY : SGT_FORMULA_XYZ, 3, names, of->tape,
                                          sizeof of->tape, NULL);
        assert_non_null(tape);
        of->formula = (sgt_formula){.tape = tape, .ball = rim > 0 ? rim + 3 : 0},
        of->formula_sag = (sgt_formula_sag){.tape = tape, .semi_diameter = rim};
        return sag ? (sgt_surface){&sgt_formula_sag_ops, &of->formula_sag}
                   : (sgt_surface){&sgt_formula_ops, &of->formula};
    }
    case QUADRIC:
        of->quadric = (sgt_quadric){.squares = {c / 2 + 0.02, c / 2 + 0.03, 0.02},
                                    .products = {about(0.01), about(0.01), 0},
                                    .linear = {0, about(0.1), -1}};
        return (sgt_surface){&sgt_quadric_ops, &of->quadric};
    case ELLIPSOID:
        of->ellipsoid = (sgt_ellipsoid){.a = uniform(&drawn, 4, 15), .f = about(0.3)};
        return (sgt_surface){&sgt_ellipsoid_ops, &of->ellipsoid};
    case TORUS:
        of->torus = (sgt_torus){.major = uniform(&drawn, 3, 8), .minor = uniform(&drawn, 0.5, 3)};
        return (sgt_surface){&sgt_torus_ops, &of->torus};
    case USERS:
        of->a[0] = c, of->a[1] = about(0.05), of->a[2] = about(0.01);
        return (sgt_surface){&users_ops, of->a};
    default:
        of->conic = (sgt_conic){.c = c, .k = k, .semi_diameter = rim};
        return (sgt_surface){&sgt_conic_ops, &of->conic};
    }
}

static void draw_surface(sgt_surface *s, room *of, double strong, bool departures)
{
    int type = departures && chance(&drawn, 0.6) ? below(&drawn, TYPES) : chance(&drawn, 0.7) ? CONIC : EVEN;
    double rim = chance(&drawn, type > EVEN ? 0.7 : 0.4) ? uniform(&drawn, 4, 9) : 0;
    *s = surface_of(type, of, strong, rim);
}

static void draw_aperture(sgt_element *e, room *of)
{
    of->aperture = (sgt_aperture){.count = 1 + (size_t)below(&drawn, 2), .items = of->items};
    for (size_t i = 0; i < of->aperture.count; i++) {
        sgt_aperture_item *item = &of->items[i];
        *item = (sgt_aperture_item){.shape = (sgt_aperture_shape)(1 + below(&drawn, 6)),
                                    .centre = {about(2), about(2)},
                                    .degrees = about(180),
                                    .radius = uniform(&drawn, 1, 6),
                                    .half = {uniform(&drawn, 0.5, 6), uniform(&drawn, 0.5, 6)},
                                    .arms = 1 + below(&drawn, 5),
                                    .width = uniform(&drawn, 0.1, 2)};
        item->inner = uniform(&drawn, 0, item->radius), item->obscuring = chance(&drawn, 0.3);
        item->length = chance(&drawn, 0.5) ? 0 : 4, item->vertices = of->corners, item->count = POLYGON;
        for (int k = 0; k < POLYGON; k++)
            of->corners[k] = (sgt_vec2){uniform(&drawn, 1, 6) * cos(1.256637 * k),
                                        uniform(&drawn, 1, 6) * sin(1.256637 * k)};
    }
    e->aperture = &of->aperture;
}

static void draw_phase(sgt_element *e, room *of)
{
    of->phase =
        (sgt_phase){.kind = SGT_IDEAL_LENS, .focal_length = either_sign(&drawn) * uniform(&drawn, 10, 80)};
    if (chance(&drawn, 0.5)) of->phase.focal_length_y = either_sign(&drawn) * uniform(&drawn, 10, 80);
    if (chance(&drawn, 0.2)) of->phase.focal_length_y = HUGE_VAL;
    if (of->phase.focal_length_y != 0 && isfinite(of->phase.focal_length_y) && chance(&drawn, 0.2))
        of->phase.focal_length = HUGE_VAL;
    if (chance(&drawn, 0.5)) of->phase.object_distance = either_sign(&drawn) * uniform(&drawn, 20, 200);
    if (chance(&drawn, 0.5)) {
        const sgt_phase_kind kind = chance(&drawn, 0.2) ? SGT_FACETS : SGT_PHASE_SAG;
        of->phase = (sgt_phase){.kind = kind, .per_wave = 5e-4 * either_sign(&drawn)};
        of->even = (sgt_even_asphere){.a = {about(20), about(0.2)}};
        of->phase.waves = (sgt_surface){&sgt_even_asphere_ops, &of->even};
        of->conic = (sgt_conic){.c = about(0.05)};
        e->surface = (sgt_surface){&sgt_conic_ops, &of->conic};
    }
    e->phase = &of->phase;
}

static void draw_lens(lens *l, bool departures)
{
    double z = 0, way = 1;
    memset(l, 0, sizeof *l);
    l->n = 1 + below(&drawn, MOST);
    double strong = chance(&drawn, 0.3) ? 2 : 1;
    for (int i = 0; i < l->n; i++) {
        sgt_element *e = &l->e[i];
        draw_surface(&e->surface, &l->of[i], strong, departures);
        sgt_vec3 origin = {0, 0, z}, tilt = {0, 0, 0};
        if (chance(&drawn, 0.2)) origin.x = about(1), origin.y = about(1);
        if (chance(&drawn, 0.2)) tilt = (sgt_vec3){about(10), about(10), about(90)};
        e->pose = sgt_pose_tilted(origin, tilt);
        e->semi_diameter = chance(&drawn, 0.85) ? uniform(&drawn, 2, 9) : 0;
        if (chance(&drawn, 0.15))
            e->index = SGT_MIRROR, way = -way;
        else if (chance(&drawn, 0.9))
            e->index = chance(&drawn, 0.4) ? 1 : uniform(&drawn, 1.3, 2);
        if (chance(&drawn, 0.15)) draw_aperture(e, &l->of[i]);
        if (chance(&drawn, 0.1)) draw_phase(e, &l->of[i]);
        z += way * uniform(&drawn, 1, 12);
    }
}

/* A launch of n parameters: each number of the ray is a sum of them. */
static void draw_launch(sgt_box_launch *from, int n)
{
    double spread = log_uniform(&drawn, 1e-6, 2), turn = log_uniform(&drawn, 1e-7, 0.1);
    *from = (sgt_box_launch){.parameters = n};
    for (int k = 0; k < 3; k++) {
        from->o[k] = sgt_model_of(k == 2 ? -10 : about(4));
        from->d[k] = sgt_model_of(k == 2 ? 1 : about(chance(&drawn, 0.2) ? 0.6 : 0.2));
        for (int i = 0; i < n; i++) {
            if (k < 2 && (i == k || chance(&drawn, 0.3))) from->o[k].by[i] = spread * about(1);
            if (chance(&drawn, 0.3)) from->d[k].by[i] = turn * about(1);
        }
    }
}

static double number_at(const sgt_model *x, const double s[SGT_MODEL_PARAMETERS])
{
    double sum = x->c;
    for (int i = 0; i < SGT_MODEL_PARAMETERS; i++) sum += x->by[i] * s[i];
    return sum;
}

/* ------------------------------------------------------------------------ one box */

typedef struct trial {
    lens *l;
    const sgt_box_lens *whole;
    const sgt_box_launch *from;
    const sgt_box_at *at;
    const sgt_box_end *end;
    long number;
    const sgt_series_ray *arriving, *ends; /* by series; NULL: by models */
} trial;

static void within(const trial *t, const char *what, size_t i, sgt_interval x, double y)
{
    REQUIRE(y >= x.lo && y <= x.hi, "case %ld: %s %zu is %.17g, not in [%.17g, %.17g]", t->number, what, i, y,
            x.lo, x.hi);
}

static double dot3(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static sgt_vec3 combined(sgt_vec3 a, sgt_pose e)
{
    return (sgt_vec3){a.x * e.ex.x + a.y * e.ey.x + a.z * e.ez.x, a.x * e.ex.y + a.y * e.ey.y + a.z * e.ez.y,
                      a.x * e.ex.z + a.y * e.ey.z + a.z * e.ez.z};
}

/* The lens as it is at s.  Returns the index in front. */
static double lens_at(lens *l, const sgt_box_lens *whole, const double s[SGT_MODEL_PARAMETERS])
{
    double before = 1, turn[MOST][3] = {{0}};
    bool turned[MOST] = {false};
    for (size_t i = 0; i < whole->numbers; i++) {
        const sgt_box_number *a = &whole->number[i];
        const double x = number_at(a->value, s);
        if (a->element == SGT_BOX_BEFORE) {
            before = x;
            continue;
        }
        sgt_element *e = &l->e[a->element];
        if (a->what == SGT_BOX_INDEX && e->index != SGT_MIRROR) e->index = x;
        if (a->what == SGT_BOX_PER_WAVE) l->of[a->element].phase.per_wave = x;
        if (a->what == SGT_BOX_ORIGIN) (&e->pose.origin.x)[a->which] += x;
        if (a->what == SGT_BOX_TURN)
            turn[a->element][a->which] = x * 57.29577951308232, turned[a->element] = true;
        if (a->what == SGT_BOX_SURFACE) {
            double *own =
                e->surface.ops == &sgt_conic_ops ? &l->of[a->element].conic.c : &l->of[a->element].even.c;
            if (a->which < 2)
                own[a->which] += x;
            else
                l->of[a->element].even.a[a->which - 2] += x;
        }
    }
    for (int i = 0; i < l->n; i++) {
        if (!turned[i]) continue;
        sgt_pose *p = &l->e[i].pose,
                 r = sgt_pose_tilted((sgt_vec3){0, 0, 0}, (sgt_vec3){turn[i][0], turn[i][1], turn[i][2]}),
                 e = *p;
        if (e.ex.x == 0 && e.ex.y == 0 && e.ex.z == 0) e.ex.x = e.ey.y = e.ez.z = 1;
        if (r.ex.x == 0 && r.ex.y == 0 && r.ex.z == 0) continue;
        p->ex = combined(r.ex, e), p->ey = combined(r.ey, e), p->ez = combined(r.ez, e);
    }
    return before;
}

static int draw_numbers(const lens *l, int n, sgt_box_number number[MOST], sgt_model value[MOST])
{
    int count = below(&drawn, MOST);
    double spread = log_uniform(&drawn, 1e-6, 1);
    for (int i = 0; i < count; i++) {
        const size_t e = (size_t)below(&drawn, l->n);
        const sgt_element *at = &l->e[e];
        sgt_box_number *a = &number[i];
        *a = (sgt_box_number){.element = e, .what = (sgt_box_what)(1 + below(&drawn, 5)), .value = &value[i]};
        double size = 0.1;
        value[i] = sgt_model_of(0);
        if (a->what == SGT_BOX_INDEX) value[i].c = uniform(&drawn, 1.3, 1.9);
        if (a->what == SGT_BOX_INDEX && chance(&drawn, 0.2)) a->element = SGT_BOX_BEFORE;
        if (a->what == SGT_BOX_PER_WAVE) {
            size = 1e-4, value[i].c = 5e-4;
            if (!at->phase || at->phase->kind != SGT_PHASE_SAG) return i;
        }
        if (a->what == SGT_BOX_ORIGIN || a->what == SGT_BOX_TURN) a->which = (size_t)below(&drawn, 3);
        if (a->what == SGT_BOX_SURFACE) {
            a->which = (size_t)below(&drawn, 2), size = a->which ? 0.1 : 0.01;
            if (at->surface.ops == &sgt_even_asphere_ops && chance(&drawn, 0.5))
                a->which = 2 + (size_t)below(&drawn, 3), size = pow(0.03, (double)a->which);
        }
        for (int j = 0; j < n; j++) value[i].by[j] = chance(&drawn, 0.5) ? spread * about(size) : 0;
        for (int j = 0; j < i; j++)
            if (number[j].element == a->element && number[j].what == a->what && number[j].which == a->which)
                return i;
    }
    return count;
}

/* In front of the last element the ray is on the line to where it is met. */
static void arrives(const trial *t, const double s[], const sgt_passage *last)
{
    double at[6], low[3], high[3];
    for (int k = 0; k < 6; k++) {
        const sgt_series *x = k < 3 ? &t->arriving->p[k] : &t->arriving->d[k - 3];
        const sgt_interval in = sgt_series_at(x, s[0], s[1]);
        at[k] = (in.lo + in.hi) / 2;
        if (k < 3) low[k] = in.lo, high[k] = in.hi;
        else REQUIRE(in.hi - in.lo < HUGE_VAL, "case %ld", t->number);
    }
    const double to[3] = {last->hit.p.x, last->hit.p.y, last->hit.p.z};
    double way = 0, off = 0, size = 1;
    for (int k = 0; k < 3; k++) way += (to[k] - at[k]) * at[3 + k], size += fabs(to[k]) + fabs(at[k]);
    for (int k = 0; k < 3; k++) {
        const sgt_interval d = sgt_series_at(&t->arriving->d[k], s[0], s[1]);
        off = fmax(0, fabs(at[k] + way * at[3 + k] - to[k]) - (high[k] - low[k]) * 2 -
                          (fabs(way) + size) * (d.hi - d.lo) * 4);
        REQUIRE(off <= 1e-11 * size, "case %ld: arriving %d is off by %g", t->number, k, off);
    }
}

/* Returns how near the ray is to being stopped: the least margin, in some unit. */
static double look(const trial *t, const double s[SGT_MODEL_PARAMETERS], size_t at_element)
{
    const sgt_box_end *end = t->end;
    sgt_passage passed[MOST];
    sgt_fate fate;
    sgt_ray ray = {
        .o = {number_at(&t->from->o[0], s), number_at(&t->from->o[1], s), number_at(&t->from->o[2], s)},
        .d = {number_at(&t->from->d[0], s), number_at(&t->from->d[1], s), number_at(&t->from->d[2], s)}};
    const lens own = *t->l;
    const sgt_ray ray0 = ray;
    const double before = lens_at(t->l, t->whole, s);
    const size_t n = (size_t)t->l->n, count = sgt_trace(n, t->l->e, before, &ray, passed, &fate, NULL);
    const lens moved = *t->l;
    *t->l = own;
    if (end->verdict == SGT_BOX_PASSED)
        REQUIRE(fate == SGT_PASSED && count == n, "case %ld: passed, and a ray is %s at %zu (%s)", t->number,
                sgt_fate_text(fate), count, count < n ? sgt_status_text(passed[count].hit.status) : "");
    if (end->verdict == SGT_BOX_STOPPED) {
        REQUIRE(count == end->element, "case %ld: stopped at %zu, and a ray at %zu (%s)", t->number,
                end->element, count, sgt_fate_text(fate));
        REQUIRE(fate == SGT_LOST || (fate >= 0 && (end->causes >> fate & 1)), "case %ld: %s", t->number,
                sgt_fate_text(fate));
    }
    sgt_vec3 way = {ray0.d.x, ray0.d.y, ray0.d.z};
    const size_t told = end->verdict == SGT_BOX_PASSED ? n : end->element;
    for (size_t i = 0; i < told && i < count; i++) {
        const sgt_hit *h = &passed[i].hit;
        const sgt_pose e = moved.e[i].pose;
        const bool turned = e.ex.x != 0 || e.ex.y != 0 || e.ex.z != 0;
        const sgt_vec3 normal = h->n, to = passed[i].direction;
        const sgt_vec3 d = turned ? (sgt_vec3){dot3(way, e.ex), dot3(way, e.ey), dot3(way, e.ez)} : way;
        const double cosine = fabs(dot3(d, normal)) / sqrt(dot3(d, d) * dot3(normal, normal)),
                     behind = fabs(dot3(to, normal)) / sqrt(dot3(normal, normal));
        const sgt_interval c = t->at[i].cosine, b = t->at[i].behind;
        within(t, "cosine", i, (sgt_interval){c.lo - 1e-12, c.hi + 1e-12}, cosine);
        within(t, "behind", i, (sgt_interval){b.lo - 1e-12, b.hi + 1e-12}, behind);
        way = turned ? combined(to, e) : to;
        within(t, "x", i, t->at[i].x, h->p.x), within(t, "y", i, t->at[i].y, h->p.y),
            within(t, "z", i, t->at[i].z, h->p.z);
        const double r = sqrt(h->p.x * h->p.x + h->p.y * h->p.y), rim = t->l->e[i].semi_diameter;
        if (rim > 0) {
            const sgt_interval m = t->at[i].margin;
            within(t, "margin", i, (sgt_interval){m.lo - 1e-12, m.hi + 1e-12}, rim - r);
        }
    }
    if (end->verdict == SGT_BOX_PASSED) {
        const sgt_passage *last = &passed[n - 1];
        const double p[3] = {last->hit.p.x, last->hit.p.y, last->hit.p.z},
                     d[3] = {last->direction.x, last->direction.y, last->direction.z};
        for (size_t k = 0; k < 3; k++) {
            const sgt_interval at = t->ends ? sgt_series_at(&t->ends->p[k], s[0], s[1])
                                            : sgt_model_at(&end->p[k], s);
            within(t, "p", k, at, p[k]);
            within(t, "d", k,
                   t->ends ? sgt_series_at(&t->ends->d[k], s[0], s[1]) : sgt_model_at(&end->d[k], s), d[k]);
        }
        within(t, "opl", 0,
               t->ends ? sgt_series_at(&t->ends->opl, s[0], s[1]) : sgt_model_at(&end->opl, s), last->opl);
        if (t->arriving) arrives(t, s, &passed[n - 1]);
    }
    if (at_element >= count) return -1;
    const sgt_vec3 p = passed[at_element].hit.p;
    return t->l->e[at_element].semi_diameter > 0 ? t->l->e[at_element].semi_diameter - hypot(p.x, p.y)
                                                 : fabs(passed[at_element].direction.z);
}

static double corner_or_inside(void)
{
    double x = about(1.5);
    return x > 1 ? 1 : x < -1 ? -1 : x;
}

static void attack(const trial *t, int rays)
{
    double best[SGT_MODEL_PARAMETERS] = {0}, least = HUGE_VAL;
    const size_t element = (size_t)below(&drawn, t->l->n);
    const double sign = chance(&drawn, 0.5) ? 1 : -1;
    for (int k = 0; k < rays; k++) {
        double s[SGT_MODEL_PARAMETERS] = {0};
        const bool climb = k > rays / 2;
        for (int i = 0; i < t->from->parameters; i++) {
            s[i] = climb ? best[i] + about(2) * pow(0.5, k - rays / 2) : corner_or_inside();
            if (s[i] > 1) s[i] = 1;
            if (s[i] < -1) s[i] = -1;
        }
        const double near = sign * look(t, s, element);
        if (near < least) {
            least = near;
            memcpy(best, s, sizeof best);
        }
    }
}

/* The launch of two parameters at most, as series. */
static sgt_series series_of(const sgt_model *x)
{
    sgt_series y = sgt_series_of(x->c);
    y.k[SGT_SERIES_PLACE(1, 0)] = x->by[0], y.k[SGT_SERIES_PLACE(0, 1)] = x->by[1];
    return y;
}

static sgt_box_verdict trace_series(const sgt_box_lens *whole, const sgt_box_launch *from, sgt_box_room *kept,
                                    sgt_box_at *at, sgt_series_ray of[2], sgt_box_end *end)
{
    sgt_series_ray ray = {.opl = {.rest = 0}};
    for (int k = 0; k < 3; k++) ray.p[k] = series_of(&from->o[k]), ray.d[k] = series_of(&from->d[k]);
    return sgt_series_trace(whole, &ray, kept, at, &of[0], &of[1], end);
}

static void no_ray_contradicts(bool departures, long count)
{
    long passed = 0, stopped = 0, cut = 0;
    for (long i = 0; i < count; i++) {
        static lens l;
        sgt_box_launch from;
        sgt_box_at at[MOST];
        sgt_box_end end;
        sgt_box_room rooms[MOST] = {{{0}}};
        draw_lens(&l, departures);
        for (int k = 0; k < 9; k++) {
            const int n = (int[]){1, 2, 2, 3, 4, 6, 1, 2, 2}[k];
            static sgt_series_ray rays[2];
            draw_launch(&from, n);
            sgt_box_number number[MOST];
            sgt_model value[MOST];
            const int numbers = k > 2 && k < 8 ? draw_numbers(&l, n, number, value) : 0;
            const sgt_box_lens whole = {
                .elements = (size_t)l.n, .e = l.e, .numbers = (size_t)numbers, .number = number};
            sgt_box_room *kept = !numbers && chance(&drawn, 0.5) ? rooms : NULL;
            if (k < 6)
                sgt_box_trace(&whole, &from, kept, at, &end);
            else
                trace_series(&whole, &from, kept, at, rays, &end);
            passed += end.verdict == SGT_BOX_PASSED, stopped += end.verdict == SGT_BOX_STOPPED;
            cut += end.verdict == SGT_BOX_CUT;
            const trial t = {&l, &whole, &from, at, &end, i, k < 6 ? NULL : rays, k < 6 ? NULL : rays + 1};
            attack(&t, 12);
        }
    }
    printf("%ld passed, %ld stopped, %ld cut\n", passed, stopped, cut);
}

static void quadrics_hold(void **unused)
{
    (void)unused;
    drawn = seeded("beam");
    no_ray_contradicts(false, scaled(3000));
}

static void departures_hold(void **unused)
{
    (void)unused;
    drawn = seeded("beam departures");
    no_ray_contradicts(true, scaled(2000));
}

/* One conic up to its equator and beyond, met from all sides: lines whose near root is on its other half, or
 * on the other sheet of a hyperboloid. */
static void other_sheets_hold(void **unused)
{
    (void)unused;
    drawn = seeded("beam sheets");
    for (long i = 0, count = scaled(3000); i < count; i++) {
        static lens l;
        sgt_box_launch from = {.parameters = 2};
        sgt_box_at at[MOST];
        sgt_box_end end;
        const double radius = either_sign(&drawn) * uniform(&drawn, 3, 7),
                     spread = log_uniform(&drawn, 1e-6, 0.3);
        const double k = chance(&drawn, 0.5) ? 0 : uniform(&drawn, -4, 0.5), side = fabs(radius);
        memset(&l, 0, sizeof l);
        l.n = 1, l.of[0].conic = (sgt_conic){.c = 1 / radius, .k = k};
        if (chance(&drawn, 0.2)) l.of[0].conic.semi_diameter = side * uniform(&drawn, 0.5, 1);
        l.e[0] = (sgt_element){.surface = {&sgt_conic_ops, &l.of[0].conic}, .index = 1};
        if (chance(&drawn, 0.8)) l.e[0].semi_diameter = side * uniform(&drawn, 0.6, 1.2);
        const double to[3] = {side * about(1), side * about(1), radius + side * about(1.5)};
        for (int axis = 0; axis < 3; axis++) {
            const double d = about(1);
            from.d[axis] = sgt_model_of(d);
            from.o[axis] = (sgt_model){.c = to[axis] - 10 * d, .by = {spread * about(1), spread * about(1)}};
        }
        /* a chord from inside the aperture to outside of it: one root is meant, whichever comes first */
        const double semi = l.e[0].semi_diameter, inner = semi * uniform(&drawn, 0, 0.95),
                     outer = semi * uniform(&drawn, 1.05, 1.6), c = 1 / radius;
        if (chance(&drawn, 0.3) && semi > 0 && (1 + k) * c * c * outer * outer < 0.98) {
            double chord[2][3];
            for (int end_of = 0; end_of < 2; end_of++) {
                const double r = end_of ? outer : inner, turn = about(3.14);
                chord[end_of][0] = r * cos(turn), chord[end_of][1] = r * sin(turn);
                chord[end_of][2] = c * r * r / (1 + sqrt(1 - (1 + k) * c * c * r * r));
            }
            const int first = chance(&drawn, 0.5);
            for (int axis = 0; axis < 3; axis++) {
                const double d = chord[1 - first][axis] - chord[first][axis];
                from.d[axis] = sgt_model_of(d), from.o[axis].c = chord[first][axis] - 3 * d;
            }
        }
        const sgt_box_lens whole = {.elements = 1, .e = l.e};
        static sgt_series_ray rays[2];
        const bool series = i % 2;
        if (series)
            trace_series(&whole, &from, NULL, at, rays, &end);
        else
            sgt_box_trace(&whole, &from, NULL, at, &end);
        const trial t = {&l, &whole, &from, at, &end, i, series ? &rays[0] : NULL, series ? &rays[1] : NULL};
        attack(&t, 6);
    }
}

/* Lines that a search leads to another root than the one next to the vertex plane: of a polynomial where its
 * base is missed, and of a toroid, whose seed is that of a conic although it has none as its base. */
static void roots_beside_the_seed_hold(void **unused)
{
    (void)unused;
    static const double xy[5][5] = {
        {0, -0.16644593034819, 0, 0, -0.031069424732559487},
        {-0.22706990236970423, 0, 0, 0, 0.015323036797538792},
        {0, -0.0080522049158578204, 0, -0.004324201455343013, 0},
        {0.020322447914209871, -0.016861050949413044, 0, 0, 0},
        {0, 0.0051534620241787408, 0, 0, 0}};
    static const double along[] = {0, -0.0015357020659278206, -5.5774904813331415e-05, 2.800364170488669e-07};
    const sgt_polynomial_xy missed = {.c = 0.22692091183531285, .k = -1, .a = {&xy[0][0], 5, 5}};
    const double c = -0.0090342471085399518;
    sgt_toroidal bent = {.c = c, .k = -0.89118176819146377, .c_x = c};
    for (size_t i = 0; i < sizeof along / sizeof *along; i++) bent.a[i] = along[i];
    const struct {
        sgt_surface surface;
        double o[3], d[3];
    } cases[] = {{{&sgt_polynomial_xy_ops, &missed},
                  {-4.9759730681815011, -0.21886317457965512, -0.6247347861869621},
                  {-0.5060642132426707, -0.00082876560050097563, 0.86249540591394236}},
                 {{&sgt_toroidal_ops, &bent},
                  {0.56077097301836765, 0.53751214684120507, -8.5121436410727331},
                  {-1.6191387565359023, -1.8231353934737855, 1}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static lens l;
        sgt_box_launch from = {.parameters = 2};
        memset(&l, 0, sizeof l), l.n = 1;
        sgt_box_end end;
        sgt_box_at at[1];
        l.e[0] = (sgt_element){.surface = cases[i].surface, .index = 1.32034};
        for (int axis = 0; axis < 3; axis++) {
            from.o[axis] = (sgt_model){.c = cases[i].o[axis],
                                       .by = {axis == 0 ? 1e-9 : 0, axis == 1 ? 1e-9 : 0}};
            from.d[axis] = sgt_model_of(cases[i].d[axis]);
        }
        const sgt_box_lens whole = {.elements = 1, .e = l.e};
        sgt_box_trace(&whole, &from, NULL, at, &end);
        const trial t = {&l, &whole, &from, at, &end, (long)i, NULL, NULL};
        if (end.verdict == SGT_BOX_PASSED) attack(&t, 8);
        printf("case %zu: verdict %d\n", i, (int)end.verdict);
    }
}

/* Sags without any edge, bent and steep, met near a vertex that may be far from where the line comes down: of
 * several roots on a line the box says the one that sgt_trace takes. */
static void sags_without_edge_hold(void **unused)
{
    (void)unused;
    drawn = seeded("beam without edge");
    long passed = 0, count = scaled(4000);
    for (long i = 0; i < count; i++) {
        static lens l;
        static sgt_series_ray rays[2];
        sgt_box_launch from = {.parameters = 2};
        sgt_box_at at[MOST];
        sgt_box_end end;
        memset(&l, 0, sizeof l);
        const int type = (int[]){EVEN, TOROIDAL, BICONIC, ZERNIKE, XY, ODD, CHEBYSHEV, Q_CON, Q_BFS, SUM,
                                 FORMULA_SAG}[below(&drawn, 11)];
        l.n = 1, l.e[0].surface = surface_of(type, &l.of[0], log_uniform(&drawn, 0.3, 6), 0);
        l.e[0].index = chance(&drawn, 0.5) ? 1.5 : 1;
        const double spread = log_uniform(&drawn, 1e-5, 1), lean = chance(&drawn, 0.3) ? 0 : 1.5;
        from.d[0] = sgt_model_of(lean * about(1)), from.d[1] = sgt_model_of(lean * about(1));
        from.d[2] = sgt_model_of(1);
        for (int axis = 0; axis < 3; axis++)
            from.o[axis] = (sgt_model){.c = (axis < 2 ? about(8) : 0) - 10 * from.d[axis].c,
                                       .by = {axis == 0 ? spread : 0, axis == 1 ? spread : 0}};
        const sgt_box_lens whole = {.elements = 1, .e = l.e};
        const bool series = i % 2;
        if (series)
            trace_series(&whole, &from, NULL, at, rays, &end);
        else
            sgt_box_trace(&whole, &from, NULL, at, &end);
        passed += end.verdict == SGT_BOX_PASSED;
        const trial t = {&l, &whole, &from, at, &end, i, series ? &rays[0] : NULL, series ? &rays[1] : NULL};
        if (end.verdict == SGT_BOX_PASSED) attack(&t, 8);
    }
    printf("%ld of %ld passed\n", passed, count);
    REQUIRE(passed > count / 10, "boxes of sags without an edge are decided");
}

/* ------------------------------------------------------------------------- how fine */

/* A lens of two surfaces of the type, and an image plane; the box is `spread` wide about a ray that is off
 * the axis.  What is left out of the last point, and of the path. */
static sgt_box_verdict rest_of(lens *l, double spread, bool series, double *point, double *path)
{
    sgt_box_launch from = {.parameters = 2};
    sgt_box_end end;
    const sgt_box_lens whole = {.elements = 3, .e = l->e};
    from.o[0] = (sgt_model){.c = 1.2, .by = {spread, 0}},
    from.o[1] = (sgt_model){.c = 0.7, .by = {0, spread}}, from.o[2] = sgt_model_of(-5);
    from.d[0] = sgt_model_of(0.02), from.d[1] = sgt_model_of(0.05), from.d[2] = sgt_model_of(1);
    if (series) {
        static sgt_series_ray rays[2];
        const sgt_box_verdict v = trace_series(&whole, &from, NULL, NULL, rays, &end);
        *point = rays[1].p[0].rest + rays[1].p[1].rest, *path = rays[1].opl.rest;
        return v;
    }
    sgt_box_verdict v = sgt_box_trace(&whole, &from, NULL, NULL, &end);
    *point = end.p[0].rest + end.p[1].rest, *path = end.opl.rest;
    return v;
}

/* A box half as wide leaves out an eighth of it, or half of it where a type is known by its bend only.  By
 * series it is some 1 / 128, as long as that is more than rounding. */
static void rest_shrinks(void **unused)
{
    (void)unused;
    drawn = seeded("beam order");
    for (int case_of = 0; case_of < 2 * TYPES; case_of++) {
        static lens l;
        const int type = case_of / 2;
        const bool series = case_of % 2;
        if (type == TORUS || type == ELLIPSOID || (type == USERS && series))
            continue; /* no vertex to put a lens about; the rays of the others are */
        /* (the grid has a cell about the vertex) */
        const double least = type == FORMULA_SAG || type == FORMULA || type == USERS ? 3.4
                             : series && type == ODD                                  ? 20
                             : series                                                ? 50
                                                                                     : 7;
        const double widest = !series || least < 20 ? 0.1 : type == ODD ? 0.2 : 1;
        double before = 0, path_before = 0;
        memset(&l, 0, sizeof l);
        l.n = 3;
        for (int i = 0; i < 3; i++) {
            sgt_element *e = &l.e[i];
            e->surface = surface_of(i < 2 ? type : CONIC, &l.of[i], 0.6, i < 2 ? 6 : 0);
            e->pose.origin.z = 4 * i, e->index = i == 0 ? 1.5 : 1, e->semi_diameter = i < 2 ? 5 : 0;
        }
        for (double spread = widest; spread > widest / (series ? 5 : 10); spread /= 2) {
            double point, path;
            const sgt_box_verdict v = rest_of(&l, spread, series, &point, &path);
            REQUIRE(v == SGT_BOX_PASSED, "type %d, %s, %g: a small box well inside is %s", type,
                    series ? "series" : "models", spread,
                    sgt_box_verdict_text(v));
            if (before > 1e-9) {
                REQUIRE(before / point > least, "type %d: the rest shrinks by %g", type, before / point);
                REQUIRE(path_before / path > least, "type %d: of the path by %g", type, path_before / path);
            }
            before = point, path_before = path;
        }
    }
}

/* Boxes that are plainly decidable, of a singlet: inside, outside, missed, totally reflected. */
static void plain_boxes_are_decided(void **unused)
{
    (void)unused;
    const sgt_conic front = {.c = 1 / 22.0}, back = {.c = -1 / 30.0}, image = {0};
    sgt_element e[3] = {
        {.surface = {&sgt_conic_ops, &front}, .index = 1.62, .semi_diameter = 6},
        {.surface = {&sgt_conic_ops, &back}, .pose = {.origin = {0, 0, 3}}, .index = 1, .semi_diameter = 6},
        {.surface = {&sgt_conic_ops, &image}, .pose = {.origin = {0, 0, 20}}}};
    const sgt_box_lens singlet = {.elements = 3, .e = e};
    const struct {
        double x, y, spread, dx;
        sgt_box_verdict verdict;
        sgt_fate fate;
        size_t element;
    } cases[] = {
        {0, 0, 3.5, 0, SGT_BOX_PASSED, SGT_PASSED, 3},  {4, 0, 1.5, 0, SGT_BOX_PASSED, SGT_PASSED, 3},
        {10, 0, 2, 0, SGT_BOX_STOPPED, SGT_CLIPPED, 0}, {40, 0, 10, 0, SGT_BOX_STOPPED, SGT_MISSED, 0},
        {5.9, 0, 0.2, 0, SGT_BOX_CUT, SGT_LOST, 0},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        sgt_box_launch from = {.parameters = 2};
        sgt_box_end end;
        from.o[0] = (sgt_model){.c = cases[i].x, .by = {cases[i].spread, 0}},
        from.o[1] = (sgt_model){.c = cases[i].y, .by = {0, cases[i].spread}};
        from.o[2] = sgt_model_of(-5), from.d[0] = sgt_model_of(cases[i].dx), from.d[2] = sgt_model_of(1);
        sgt_box_trace(&singlet, &from, NULL, NULL, &end);
        REQUIRE(end.verdict == cases[i].verdict && end.element == cases[i].element &&
                    (end.verdict != SGT_BOX_STOPPED || end.fate == cases[i].fate),
                "box %zu: %s at %zu, %s", i, sgt_box_verdict_text(end.verdict), end.element,
                sgt_fate_text(end.fate));
    }
    e[0].index = 1, e[0].semi_diameter = e[1].semi_diameter = 0; /* glass in front: past the critical angle */
    const sgt_box_lens glass = {.elements = 2, .e = e, .index_before = 1.6};
    sgt_conic flat = {0};
    e[0].surface.self = &flat;
    sgt_box_launch from = {.parameters = 1};
    sgt_box_end end;
    from.d[0] = (sgt_model){.c = 0.9, .by = {0.05}}, from.d[2] = sgt_model_of(1),
    from.o[2] = sgt_model_of(-1);
    sgt_box_trace(&glass, &from, NULL, NULL, &end);
    REQUIRE(end.verdict == SGT_BOX_STOPPED && end.fate == SGT_TIR && end.element == 0, "reflected: %s",
            sgt_box_verdict_text(end.verdict));
}

/* Of each shape a box that goes over an edge by a seventh of its half width is cut; well inside it passes. */
static void edges_of_apertures_cut(void **unused)
{
    (void)unused;
    static const sgt_vec2 corners[] = {{-5, -9}, {5, -9}, {5, 9}, {-5, 9}};
    const sgt_aperture_item items[] = {
        {.shape = SGT_CIRCLE, .radius = 5},
        {.shape = SGT_ANNULUS, .radius = 5, .inner = 0.1},
        {.shape = SGT_RECTANGLE, .half = {5, 9}},
        {.shape = SGT_ELLIPSE, .half = {5, 40}},
        {.shape = SGT_POLYGON, .count = 4, .vertices = corners},
        {.shape = SGT_CIRCLE, .radius = 5, .centre = {10, 0}, .obscuring = true},
        {.shape = SGT_RECTANGLE, .half = {5, 9}, .centre = {10, 0}, .obscuring = true},
    };
    const sgt_conic flat = {0};
    for (size_t k = 0; k < COUNT_OF(items); k++) {
        const sgt_aperture aperture = {.count = 1, .items = &items[k]};
        const sgt_element e = {.surface = {&sgt_conic_ops, &flat}, .index = 1, .aperture = &aperture};
        const sgt_box_lens plane = {.elements = 1, .e = &e};
        for (int over = 0; over < 2; over++) {
            const double spread = 0.5, x = 5 - (over ? 0.85 : 3) * spread;
            sgt_box_launch from = {.parameters = 2};
            sgt_box_end end;
            from.o[0] = (sgt_model){.c = x, .by = {spread, 0}};
            from.o[1] = (sgt_model){.by = {0, 0.1 * spread}};
            from.o[2] = sgt_model_of(-5), from.d[2] = sgt_model_of(1);
            sgt_box_trace(&plane, &from, NULL, NULL, &end);
            REQUIRE(end.verdict == (over ? SGT_BOX_CUT : SGT_BOX_PASSED), "shape %zu, %s: %s", k,
                    over ? "over its edge" : "inside", sgt_box_verdict_text(end.verdict));
        }
    }
}

/* The operations on models contain what they do: members at random places, in long double. */
static void models_contain(void **unused)
{
    (void)unused;
    drawn = seeded("beam models");
    for (long i = 0, count = scaled(10000); i < count; i++) {
        sgt_model x = sgt_model_of(about(4)), y = sgt_model_of(about(4)), z;
        double s[SGT_MODEL_PARAMETERS], small = exp2(uniform(&drawn, -25, 1));
        long double at[2] = {x.c, y.c};
        sgt_model *const both[2] = {&x, &y};
        for (int k = 0; k < SGT_MODEL_PARAMETERS; k++) s[k] = corner_or_inside();
        for (int b = 0; b < 2; b++) {
            for (int k = 0; k < 3; k++)
                both[b]->by[k] = small * about(1), at[b] += (long double)both[b]->by[k] * s[k];
            for (int k = 0; k < 3; k++)
                for (int j = 0; j <= k; j++) {
                    both[b]->pair[SGT_MODEL_PAIR(j, k)] = small * small * about(1);
                    at[b] += (long double)both[b]->pair[SGT_MODEL_PAIR(j, k)] * s[j] * s[k];
                }
            both[b]->rest = chance(&drawn, 0.5) ? 0 : small * small * small;
            at[b] += both[b]->rest * corner_or_inside();
        }
        const long double k = about(3);
        const struct {
            const char *what;
            void (*of)(const sgt_model *, const sgt_model *, sgt_model *);
            long double y;
        } two[] = {{"sum", sgt_model_sum, at[0] + at[1]},
                   {"difference", sgt_model_difference, at[0] - at[1]},
                   {"product", sgt_model_product, at[0] * at[1]}};
        for (size_t j = 0; j < 5; j++) {
            long double value;
            if (j < 3)
                two[j].of(&x, &y, &z), value = two[j].y;
            else if (j == 3)
                sgt_model_inverse(&x, &z), value = 1 / at[0];
            else
                sgt_model_root(&x, &z), value = sqrtl(at[0] > 0 ? at[0] : 0);
            if (!(z.rest < HUGE_VAL)) continue;
            const sgt_interval in = sgt_model_at(&z, s), range = sgt_model_range(&z);
            REQUIRE(value >= (long double)in.lo && value <= (long double)in.hi, "%zu: %Lg is not in [%g, %g]",
                    j, value, in.lo, in.hi);
            REQUIRE(value >= (long double)range.lo && value <= (long double)range.hi, "%zu: not in its range",
                    j);
        }
        sgt_model_scaled(&x, (double)k, &z);
        const sgt_interval in = sgt_model_at(&z, s);
        REQUIRE(k * at[0] >= (long double)in.lo && k * at[0] <= (long double)in.hi, "scaled");
        sgt_model px, py;
        const double r = uniform(&drawn, 0, 3), dr = uniform(&drawn, 0, 1), a = about(7),
                     da = uniform(&drawn, 0, 1);
        sgt_model_polar(0, (sgt_interval){r, r + dr}, 1, (sgt_interval){a, a + da}, &px, &py);
        const long double rr = r + dr * (1 + (long double)s[0]) / 2,
                          aa = a + da * (1 + (long double)s[1]) / 2;
        const sgt_interval ix = sgt_model_at(&px, s), iy = sgt_model_at(&py, s);
        const long double X = rr * cosl(aa), Y = rr * sinl(aa);
        REQUIRE(X >= (long double)ix.lo && X <= (long double)ix.hi && Y >= (long double)iy.lo &&
                    Y <= (long double)iy.hi,
                "polar");
    }
}

/* The same of series: of random members of all orders; and means, against the sum over the terms. */
static long double series_value(const sgt_series *x, long double s, long double t)
{
    long double sum = 0;
    for (int d = SGT_SERIES_ORDER; d >= 0; d--)
        for (int j = 0; j <= d; j++)
            sum += x->k[SGT_SERIES_PLACE(d - j, j)] * powl(s, d - j) * powl(t, j);
    return sum;
}

static bool is_in(sgt_interval in, long double x)
{
    return x >= (long double)in.lo && x <= (long double)in.hi;
}

static void series_contain(void **unused)
{
    (void)unused;
    drawn = seeded("beam series");
    for (long i = 0, count = scaled(10000); i < count; i++) {
        sgt_series x = sgt_series_of(about(4)), y = sgt_series_of(about(4)), z;
        const double s = corner_or_inside(), t = corner_or_inside(), small = exp2(uniform(&drawn, -20, 1));
        sgt_series *const both[2] = {&x, &y};
        long double at[2];
        for (int b = 0; b < 2; b++) {
            for (int d = 1; d <= SGT_SERIES_ORDER; d++)
                for (int j = 0; j <= d; j++)
                    if (chance(&drawn, 0.7))
                        both[b]->k[SGT_SERIES_PLACE(d - j, j)] = pow(small, d) * about(1);
            both[b]->rest = chance(&drawn, 0.5) ? 0 : pow(small, 6) * 0.1;
            at[b] = series_value(both[b], s, t) + (long double)both[b]->rest * corner_or_inside();
        }
        const double k = about(3);
        for (int j = 0; j < 7; j++) {
            long double value = 0;
            if (j == 0) sgt_series_sum(&x, &y, &z), value = at[0] + at[1];
            if (j == 1) sgt_series_difference(&x, &y, &z), value = at[0] - at[1];
            if (j == 2) sgt_series_product(&x, &y, &z), value = at[0] * at[1];
            if (j == 3) sgt_series_inverse(&x, &z), value = 1 / at[0];
            if (j == 4) sgt_series_root(&x, &z), value = sqrtl(at[0] > 0 ? at[0] : 0);
            if (j == 5) sgt_series_scaled(&x, k, &z), value = k * at[0];
            if (j == 6) sgt_series_plus(&x, k, &z), value = k + at[0];
            if (!(z.rest < HUGE_VAL)) continue;
            REQUIRE(is_in(sgt_series_at(&z, s, t), value), "%ld, %d: not in it", i, j);
            REQUIRE(is_in(sgt_series_range(&z), value), "%ld, %d: not in its range", i, j);
        }
        const double r = uniform(&drawn, 0, 3), dr = uniform(&drawn, 0, 1), a = about(7),
                     da = uniform(&drawn, 0, 1.8);
        sgt_series px, py;
        sgt_series_polar((sgt_interval){r, r + dr}, (sgt_interval){a, a + da}, &px, &py);
        const long double rr = r + dr * (1 + (long double)s) / 2, aa = a + da * (1 + (long double)t) / 2;
        REQUIRE(is_in(sgt_series_at(&px, s, t), rr * cosl(aa)), "polar, x");
        REQUIRE(is_in(sgt_series_at(&py, s, t), rr * sinl(aa)), "polar, y");
        /* Gauss's rule of five points is exact to the ninth order; of the weight too, and twice */
        static const long double place[3] = {0, 0.538469310105683091036314420700209L,
                                             0.906179845938663992797626878299393L},
                                 share[3] = {0.568888888888888888888888888888889L,
                                             0.478628670499366468041291514835638L,
                                             0.236926885056189087514264040719917L};
        const double w = about(1);
        long double mean = 0;
        for (int j = -2; j <= 2; j++)
            for (int m = -2; m <= 2; m++) {
                const long double u = (j < 0 ? -1 : 1) * place[abs(j)], v = (m < 0 ? -1 : 1) * place[abs(m)];
                mean += share[abs(j)] * share[abs(m)] / 4 * (1 + w * u) * series_value(&x, u, v);
            }
        const sgt_interval in = sgt_series_mean(&x, w);
        REQUIRE(is_in((sgt_interval){in.lo - 1e-15, in.hi + 1e-15}, mean), "%ld: mean", i);
        REQUIRE(in.hi - in.lo <= 2.1 * x.rest + 1e-12, "%ld: the mean is wide", i);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(models_contain), cmocka_unit_test(series_contain),
        cmocka_unit_test(plain_boxes_are_decided), cmocka_unit_test(edges_of_apertures_cut),
        cmocka_unit_test(rest_shrinks), cmocka_unit_test(other_sheets_hold),
        cmocka_unit_test(sags_without_edge_hold), cmocka_unit_test(roots_beside_the_seed_hold),
        cmocka_unit_test(quadrics_hold), cmocka_unit_test(departures_hold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

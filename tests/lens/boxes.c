// SPDX-License-Identifier: MIT
/* boxes.c - no ray contradicts its box, and none leaves its bounds: many rays against each box of the pupils
 * of lenses.
 *
 *     boxes [--rays N] [--random N] [--boxes N] [--write FOLDER] [LENS...]
 *
 * SAGITTA_TEST_SEED (1) chooses lenses and rays; N random lenses are tried beside those of the files, and
 * --rays are divided among all their pupils, boxes in equal parts: so small boxes, which lie at edges, have
 * as many rays as large ones.  SAGITTA_TEST_SCALE (0.5) multiplies them.
 *
 * OF EACH BOX the rays are its corners, points on its edges and inside it.  Each ray has to end as its box
 * says, and if it passes, each number has to be inside the bound of that box, not of the pupil: the distance
 * from the chief ray, the path difference, and at each element the angle, the height and the clearance.
 * Then some are attacked: of a box that passes a random number climbs, from the best of its rays (so rays
 * climb toward the edge of an aperture, total reflection, or a caustic); of a box that is clipped, through a
 * lens without apertures, the height where it is clipped falls.
 *
 * THE INTEGRALS over each box that passes are held against Gauss's quadrature of traced rays, and the parts
 * of a box at an edge against a lattice of rays (test_prove.py has areas that are known). */
#include "../../src/lens/study/prove.c" /* whose cells and proofs are seen nowhere else */

#include <sagitta/lens.h>

#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>

/* ------------------------------------------------------------------------- random */

static uint64_t state = 1;

static double unit(void)
{
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return (double)(state * 0x2545f4914f6cdd1dull >> 11) * 0x1p-53;
}
static double between(double a, double b) { return a + (b - a) * unit(); }
static bool chance(double p) { return unit() < p; }
static int one_of(int n) { return (int)(unit() * n); }

/* ------------------------------------------------------------------- random lenses */

typedef struct text {
    char at[20000];
    size_t size;
} text;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
put(text *t, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    t->size += (size_t)vsnprintf(t->at + t->size, sizeof t->at - t->size, format, list);
    va_end(list);
    if (t->size >= sizeof t->at) exit(2);
}

/* A departure of that size at the radius R; x^i y^j, r^i. */
static void put_powers(text *t, const char *key, int first, int step, int count, double size, double R)
{
    put(t, ", %s: [", key);
    for (int k = 0; k < count; k++)
        put(t, "%s%.9g", k ? ", " : "", between(-1, 1) * size / pow(R, first + step * k));
    put(t, "]");
}

static void put_table(text *t, double size, double R, bool powers)
{
    put(t, ", coefficients: [");
    for (int i = 0; i < 4; i++) {
        put(t, "%s[", i ? ", " : "");
        for (int j = 0; j < 4 - i; j++)
            put(t, "%s%.9g", j ? ", " : "",
                i + j < 2 ? 0.0 : between(-1, 1) * size / (powers ? pow(R, i + j) : 1));
        put(t, "]");
    }
    put(t, "]");
}

/* The shape of a surface, with the radius of curvature r, for rays up to R from its axis. */
static void put_shape(text *t, double r, double R)
{
    const double size = R * pow(10, between(-5, -1.7)), conic = chance(0.5) ? 0 : between(-2, 1);
    switch (one_of(16)) {
    case 0:
    case 1:
        put(t, "{type: sphere, radius: %.9g", r);
        break;
    case 2:
        put(t, "{type: conic, radius: %.9g, conic: %.9g", r, conic);
        break;
    case 3:
        put(t, "{type: even_asphere, radius: %.9g, conic: %.9g", r, conic);
        put_powers(t, "coefficients", 2, 2, 1 + one_of(5), size, R);
        break;
    case 4:
        put(t, "{type: odd_asphere, radius: %.9g, conic: %.9g", r, conic);
        put_powers(t, "coefficients", 1, 1, 1 + one_of(6), 0.3 * size, R);
        break;
    case 5:
        put(t, "{type: polynomial_xy, radius: %.9g, conic: %.9g", r, conic), put_table(t, size, R, true);
        break;
    case 6:
        put(t, "{type: chebyshev, radius: %.9g, conic: %.9g, norm_x: %.9g, norm_y: %.9g", r, conic,
            R * between(1, 2), R * between(1, 2));
        put_table(t, 0.3 * size, R, false);
        break;
    case 7:
        put(t, "{type: zernike, radius: %.9g, conic: %.9g, norm: %.9g, order: %s", r, conic,
            R * between(1, 2), chance(0.5) ? "noll" : "fringe");
        put_powers(t, "coefficients", 0, 0, 1 + one_of(12), 0.3 * size, R);
        break;
    case 8:
        put(t, "{type: q_con, radius: %.9g, conic: %.9g, norm: %.9g", r, conic, R * between(1.2, 2));
        put_powers(t, "coefficients", 0, 0, 1 + one_of(4), size, R);
        break;
    case 9:
        put(t, "{type: q_bfs, radius: %.9g, norm: %.9g", r, R * between(1.2, 2));
        put_powers(t, "coefficients", 0, 0, 1 + one_of(4), size, R);
        break;
    case 10:
        put(t, "{type: toroidal, radius: %.9g, radius_x: %.9g, conic: %.9g", r, r * between(0.7, 1.6), conic);
        if (chance(0.3)) put_powers(t, "coefficients", 2, 2, 3, size, R);
        break;
    case 11:
        put(t, "{type: biconic, radius_x: %.9g, conic_x: %.9g, radius_y: %.9g", r, conic,
            r * between(0.7, 1.6));
        break;
    case 12:
        put(t, "{type: cylinder, radius: %.9g", r);
        break;
    case 13:
        put(t,
            "{type: formula, sag: \"c*r^2/(1 + sqrt(1 - c^2*r^2)) + a*x^3 + b*x*y\", c: %.9g, a: %.9g, b: "
            "%.9g",
            1 / r, size / (R * R * R), size / (R * R));
        break;
    case 14:
        put(t, "{type: sum, radius: %.9g, conic: %.9g, terms: [{type: even_asphere", r, conic);
        put_powers(t, "coefficients", 4, 2, 2, size, R);
        put(t, "}, {type: zernike, norm: %.9g, order: noll", 1.5 * R);
        put_powers(t, "coefficients", 0, 0, 7, 0.3 * size, R);
        put(t, "}]");
        break;
    default:
        put(t, "{type: plane");
        break;
    }
}

/* Up to six elements and an image, some of them tilted, mirrors or ideal; apertures that clip a part. */
static void random_lens(text *t)
{
    const double S = pow(10, between(-1, 3)), R = S * between(0.1, 0.35), w = between(0.4, 1);
    const int count = 1 + one_of(6), stop = one_of(count);
    const bool far = chance(0.6), askew = chance(0.5);
    const double field = between(0.5, 8), f = far ? field : 0.02 * S * field;
    double ahead = 1, index = 1;
    t->size = 0;
    put(t, "units: mm\nwavelengths: [%.9g]\npupil: {semi_diameter: %.9g, distance: 0}\naim: pupil\n", w, R);
    if (!far) put(t, "object: {distance: %.9g}\n", S * between(2, 10));
    put(t, "fields: [0, %.9g, [%.9g, %.9g]]\nsurfaces:\n", f, 0.5 * f, -0.4 * f);
    for (int i = 0; i < count; i++) {
        const bool last = i == count - 1, ideal = index == 1 && ahead > 0 && chance(0.08);
        const double r = (chance(0.5) ? -1 : 1) * S * between(0.9, 8),
                     thick = S * (last ? between(1, 5) : between(0.05, 0.5));
        bool mirror = false;
        put(t, "  - ");
        if (ideal)
            put(t, "{type: ideal, focal_length: %.9g", S * between(1, 6) * (chance(0.3) ? -1 : 1));
        else
            put_shape(t, r, R), mirror = chance(0.15);
        if (mirror)
            put(t, ", mirror: true"), ahead = -ahead;
        else if (!ideal)
            put(t, ", index: %.9g", index = last || index > 1 ? (chance(0.8) ? 1 : 1.33) : between(1.4, 1.9));
        if (chance(0.85)) put(t, ", semi_diameter: %.9g", R * between(chance(0.3) ? 0.5 : 1, 1.6));
        if (i == stop) put(t, ", stop: true");
        if (askew && chance(0.5))
            put(t, ", tilt: [%.9g, %.9g, %.9g]", between(-8, 8), between(-8, 8), between(-90, 90));
        if (askew && chance(0.3))
            put(t, ", decenter: [%.9g, %.9g, 0]", between(-0.2, 0.2) * R, between(-0.2, 0.2) * R);
        if (chance(0.15)) {
            const double x = between(-0.3, 0.3) * R, y = between(-0.3, 0.3) * R;
            if (chance(0.4))
                put(t, ", apertures: [{type: circle, radius: %.9g, obscures: true, offset: [%.9g, %.9g]}]",
                    0.3 * R, x, y);
            else if (chance(0.5))
                put(t, ", apertures: [{type: rectangle, half_width: %.9g, half_height: %.9g}]", 0.7 * R,
                    0.9 * R);
            else
                put(t, ", apertures: [{type: ellipse, half_width: %.9g, half_height: %.9g}]", 0.7 * R,
                    0.9 * R);
        }
        put(t, ", thickness: %.9g}\n", ahead * thick);
    }
    put(t, "  - {type: %s}\n", chance(0.8) ? "plane" : "sphere, radius: 1000000");
}

/* -------------------------------------------------------------------------- rays */

static struct {
    double rays, passed, climbed, boxes, pupils, integrals, parts, undecided;
    int faults;
    const char *name;
} sums;
static double rays_each; /* of a pupil */

#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
static void
fault(const proving *w, const prove_box *b, const double at[2], const char *format, ...)
{
    va_list list;
    if (sums.faults++ > 20) return;
    printf("%s, field %zu: the ray %.17g %.17g of the box %.9g %.9g, %.9g %.9g, fate %d: ", sums.name,
           w->ask->number[w->i / w->ask->bands], at[0], at[1], b->of.r0, b->of.r1, b->of.turn0, b->of.turn1,
           b->fate);
    va_start(list, format), vprintf(format, list), va_end(list);
    printf("\n");
}

/* How a ray ends: its fate, and the element. */
static sgt_fate fate_of(const prove_cell *c, sgt_passage passages[], double x, double y, size_t *element)
{
    const sgt_vec2 q = sgt_vignetted(c->beam, x, y);
    sgt_ray ray = sgt_field_ray(c->beam, q.x, q.y);
    sgt_fate fate;
    *element = sgt_trace(c->count, c->e, c->before, &ray, passages, &fate, NULL);
    return fate;
}

/* A box under attack. */
typedef struct under {
    const proving *w;
    const prove_box *box;
    const double *bound; /* of this box */
    carry_room *room, *open_room;
    prove_cell open; /* without apertures */
    sgt_passage *passages;
    double *value;       /* [quantities] of the last ray */
    double unit_of_path; /* waves: what an end is off by, at most */
} under;

/* Values are rounded, and so are bounds that come near them. */
static double rounding(const under *u, size_t q)
{
    const prove_cell *c = &u->w->cell;
    if (q == Q_HIGH || q == Q_LOW) return u->unit_of_path;
    if (q < Q_OF_ELEMENTS)
        return c->afocal ? 1e-11
                         : 2e-14 * (fabs(c->reference.x) + fabs(c->reference.y) + c->beam->radius) +
                               8 * c->reference_err;
    switch ((q - Q_OF_ELEMENTS) % Q_EACH) {
    case Q_INCIDENCE:
        return 1e-6 * (u->bound[q] < 0.1) + 1e-10; /* the arc cosine near 1 */
    default:
        return 1e-14 * (c->beam->radius + fabs(u->value[q]));
    }
}

/* One ray: held against the box; its value of q is given back, NaN if it has none. */
static double try_ray(under *u, double p, double t, size_t q)
{
    const prove_cell *c = &u->w->cell;
    const prove_box *b = u->box;
    double at[2];
    size_t element = 0;
    sgt_sector_point(&b->of, p, t, &at[0], &at[1]);
    sums.rays++;
    if (b->fate != SGT_PASSED && b->fate != SGT_LOST) {
        const sgt_fate fate = fate_of(c, u->passages, at[0], at[1], &element);
        const bool same =
            (int)fate == b->fate || fate == SGT_LOST || (fate == SGT_MISSED && b->fate == SGT_CLIPPED);
        if (!same || element != b->element)
            fault(u->w, b, at, "it has the fate %d at element %zu, not %zu", (int)fate, element + 1,
                  b->element + 1);
        return (double)NAN;
    }
    const sgt_fate fate = sgt_carry_ray(c, u->room, at[0], at[1], u->value);
    if (fate != SGT_PASSED) {
        if (b->fate == SGT_PASSED) fault(u->w, b, at, "it has the fate %d", (int)fate);
        return (double)NAN;
    }
    sums.passed++;
    for (size_t k = 0; k < u->w->of.quantities; k++) {
        const double over = u->value[k] - u->bound[k];
        if (over > 0 && over > rounding(u, k))
            fault(u->w, b, at, "number %zu is %.17g, beyond %.17g by %.3g", k, u->value[k], u->bound[k],
                  over);
    }
    return u->value[q];
}

/* From p, t, up. */
static void climb(under *u, double p, double t, size_t q)
{
    double best = try_ray(u, p, t, q), step = 0.25;
    for (int k = 0; k < 24 && !isnan(best); k++, step *= 0.7) {
        const double p1 = fmin(fmax(p + step * between(-1, 1), 0), 1),
                     t1 = fmin(fmax(t + step * between(-1, 1), 0), 1);
        const double now = try_ray(u, p1, t1, q);
        if (now > best) best = now, p = p1, t = t1, step *= 1.6;
    }
    sums.climbed++;
}

/* Of a box that is clipped: down to the edge, as seen without apertures. */
static void climb_in(under *u)
{
    const size_t q = prove_at_element(u->box->element, Q_HEIGHT);
    double p = unit(), t = unit(), best = HUGE_VAL, step = 0.5;
    for (int k = 0; k < 16; k++, step *= 0.75) {
        const double p1 = fmin(fmax(p + step * between(-1, 1), 0), 1),
                     t1 = fmin(fmax(t + step * between(-1, 1), 0), 1);
        double at[2];
        sgt_sector_point(&u->box->of, p1, t1, &at[0], &at[1]);
        sums.rays++;
        if (sgt_carry_ray(&u->open, u->open_room, at[0], at[1], u->value) == SGT_PASSED && u->value[q] < best)
            best = u->value[q], p = p1, t = t1;
    }
    try_ray(u, p, t, q), sums.climbed++;
}

static void try_one_box(under *u, size_t rays)
{
    const size_t q = (size_t)one_of((int)u->w->of.quantities);
    double best = -HUGE_VAL, best_p = 0.5, best_t = 0.5;
    for (size_t k = 0; k < rays; k++) {
        double p = unit(), t = unit();
        if (k < 4)
            p = (double)(k & 1), t = (double)(k >> 1);
        else if (k % 3 == 0)
            *(chance(0.5) ? &p : &t) = one_of(2);
        const double now = try_ray(u, p, t, q);
        if (now > best) best = now, best_p = p, best_t = t;
    }
    if (best > -HUGE_VAL) climb(u, best_p, best_t, q);
    if (u->box->fate == SGT_CLIPPED && u->open_room) climb_in(u);
}

static bool within(sgt_interval x, double value, double off)
{
    return value >= x.lo - off && value <= x.hi + off;
}

/* The integrals of a box that passes, by Gauss's rule of eight points each way. */
static void try_integrals(under *u)
{
    static const double node[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                   0.9602898564975363};
    static const double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                     0.1012285362903763};
    const prove_cell *c = &u->w->cell;
    const prove_box *b = u->box;
    const double middle = (b->of.r0 + b->of.r1) / 2, half = (b->of.r1 - b->of.r0) / 2,
                 area = sgt_sector_area(&b->of);
    double f = 0, d = 0, dd = 0, f_most = 0, d_most = 0, at[2];
    for (int i = 0; i < 64; i++) {
        const double s = (i % 8 < 4 ? -1 : 1) * node[i % 4], t = (i / 8 < 4 ? -1 : 1) * node[i / 8 % 4];
        const double by = area * weight[i % 4] * weight[i / 8 % 4] / 4 * (1 + half / middle * s);
        sgt_sector_point(&b->of, (1 + s) / 2, (1 + t) / 2, &at[0], &at[1]);
        if (sgt_carry_ray(c, u->room, at[0], at[1], u->value) != SGT_PASSED) return; /* told elsewhere */
        const double spot = u->value[Q_SPOT], w = u->value[Q_HIGH] - c->middle;
        f += by * spot * spot, d += by * w, dd += by * w * w;
        f_most = fmax(f_most, spot * spot), d_most = fmax(d_most, fabs(w));
        if (c->has_reference &&
            !within(b->f, spot * spot, 1e-9 * spot * spot + 2 * spot * rounding(u, Q_SPOT)))
            fault(u->w, b, at, "the square of the distance is %.17g, not in %.17g, %.17g", spot * spot,
                  b->f.lo, b->f.hi);
        if (c->has_opd && !within(b->w, w, u->unit_of_path))
            fault(u->w, b, at, "the path difference is %.17g, not in %.17g, %.17g", w, b->w.lo, b->w.hi);
    }
    sums.rays += 64, sums.integrals++;
    const double few = 1e-10; /* what the rule leaves out of a box that is as wide as may be */
    if (c->has_reference &&
        !within(b->f_sum, f, area * (few * f_most + 2 * sqrt(f_most) * rounding(u, Q_SPOT))))
        fault(u->w, b, at, "the integral of the square is %.17g, not in %.17g, %.17g", f, b->f_sum.lo,
              b->f_sum.hi);
    const double off = u->unit_of_path;
    if (c->has_opd && !within(b->w_sum, d, area * (few * d_most + off)))
        fault(u->w, b, at, "the integral of paths is %.17g, not in %.17g, %.17g", d, b->w_sum.lo,
              b->w_sum.hi);
    if (c->has_opd && !within(b->ww_sum, dd, area * (few * d_most * d_most + 2 * d_most * off)))
        fault(u->w, b, at, "the integral of squared paths is %.17g, not in %.17g, %.17g", dd, b->ww_sum.lo,
              b->ww_sum.hi);
}

/* The parts of a box at an edge, by a lattice of rays: what that is off by is an error of a lattice. */
static void try_parts(under *u)
{
    enum { LATTICE = 12 };
    const prove_box *b = u->box;
    const double area = sgt_sector_area(&b->of), w = (b->of.r1 - b->of.r0) / (b->of.r1 + b->of.r0),
                 off = 2.5 / LATTICE;
    double passed = 0, at[2];
    for (int i = 0; i < LATTICE * LATTICE; i++) {
        const double p = (i % LATTICE + 0.5) / LATTICE, t = (i / LATTICE + 0.5) / LATTICE;
        size_t element;
        sgt_sector_point(&b->of, p, t, &at[0], &at[1]);
        if (fate_of(&u->w->cell, u->passages, at[0], at[1], &element) == SGT_PASSED)
            passed += 1 + w * (2 * p - 1);
    }
    passed /= LATTICE * LATTICE, sums.rays += LATTICE * LATTICE, sums.parts++;
    if (!(b->in >= 0 && b->out >= b->out_here && b->out_here >= 0 && b->in + b->out <= area))
        fault(u->w, b, at, "its parts are %g and %g of %g", b->in, b->out, area);
    if (passed < b->in / area - off || passed > 1 - b->out / area + off)
        fault(u->w, b, at, "%g of it passes, between %g and %g", passed, b->in / area, 1 - b->out / area);
}

static void try_pupil(proving *w)
{
    const prove_cell *c = &w->cell;
    const proof *p = &w->of;
    under u = {.w = w, .room = sgt_carry_room_new(c), .open = *c};
    sgt_element *bare = malloc(c->count * sizeof *bare);
    u.passages = malloc(c->count * sizeof *u.passages), u.value = malloc(p->quantities * sizeof *u.value);
    if (!bare || !u.passages || !u.value || !u.room) exit(2);
    for (size_t i = 0; i < c->count; i++)
        bare[i] = c->e[i], bare[i].semi_diameter = 0, bare[i].aperture = NULL;
    u.open.e = bare, u.open_room = sgt_carry_room_new(&u.open);
    double far = fabs(c->about.opl) + fabs(c->about.radius < 0x1p400 ? c->about.radius : 0);
    u.unit_of_path =
        c->has_opd ? 1e-14 * c->waves * far + 2 * c->waves * (c->about.opl_err + 4 * c->about.p_err) : 0;
    const double each = rays_each / (double)p->count;
    double owed = 0;
    for (size_t i = 0; i < p->count; i++) {
        owed += each;
        const size_t rays = (size_t)owed;
        owed -= (double)rays;
        u.box = &p->box[i], u.bound = p->bound + i * p->quantities;
        if (rays) try_one_box(&u, rays);
        if (u.box->fate == SGT_PASSED) try_integrals(&u);
        if (u.box->in + u.box->out > 0) try_parts(&u);
    }
    sums.boxes += (double)p->count, sums.pupils++, sums.undecided += p->undecided;
    sgt_carry_room_free(c, u.room), sgt_carry_room_free(&u.open, u.open_room);
    free(bare), free(u.passages), free(u.value);
}

static bool ask_boxes(sgt_asking *a) { return prove_each(a, false, try_pupil); }

/* false: it is no lens, or has no first order (as random ones may). */
static bool try_lens(const char *name, const sgt_lens *lens, size_t boxes)
{
    const sgt_lens_aim aim = SGT_LENS_AIM_PUPIL;
    sgt_error error = {0};
    sgt_study *study = sgt_study_new(lens, &(sgt_study_options){.aim = &aim}, &error);
    sgt_analysis each = sgt_prove_analysis;
    const sgt_prove_options options = {.boxes = boxes};
    const double before = sums.rays, passed = sums.passed, pupils = sums.pupils, climbed = sums.climbed,
                 all = sums.boxes, undecided = sums.undecided;
    sums.name = name, each.ask = ask_boxes;
    const bool fine = study && sgt_study_run(study, &each, &options, &(sgt_sink){0}, NULL, &error);
    sgt_study_free(study);
    if (!fine) {
        printf("%s: %s\n", name, error.words);
        return false;
    }
    printf("%-60s %3g pupils %7g boxes %6.2f %% undecided %10g rays, %10g passed, %8g climbs\n", name,
           sums.pupils - pupils, sums.boxes - all,
           100 * (sums.undecided - undecided) / (sums.pupils - pupils), sums.rays - before,
           sums.passed - passed, sums.climbed - climbed);
    return true;
}

int main(int argc, char *argv[])
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE"), *folder = NULL;
    double rays = 1e6, random = 10, boxes = 1000;
    int first = 1;
    for (; first + 1 < argc && argv[first][0] == '-'; first += 2) {
        const double x = strtod(argv[first + 1], NULL);
        if (!strcmp(argv[first], "--rays"))
            rays = x;
        else if (!strcmp(argv[first], "--random"))
            random = x;
        else if (!strcmp(argv[first], "--boxes"))
            boxes = x;
        else if (!strcmp(argv[first], "--write"))
            folder = argv[first + 1];
        else
            return fprintf(stderr, "boxes: %s?\n", argv[first]), 2;
    }
    if (scale) rays *= strtod(scale, NULL) / 0.5;
    const unsigned long long drawn = seed ? strtoull(seed, NULL, 0) : 1;
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    printf("SAGITTA_TEST_SEED=%llu\n", drawn);
    state = 0x9e3779b97f4a7c15ull * (drawn + 1);
    for (int i = 0; i < 20; i++) unit();
    const double lenses = (argc - first) + random;
    int unread = 0;
    for (int i = first; i < argc; i++) {
        sgt_error error = {0};
        sgt_lens *lens = sgt_lens_read(argv[i], NULL, &error);
        const char *slash = strrchr(argv[i], '/');
        if (!lens) return printf("%s: %s\n", argv[i], error.words), 2;
        rays_each = rays / lenses / (double)(lens->fields * lens->wavelengths);
        if (!try_lens(slash ? slash + 1 : argv[i], lens, (size_t)boxes)) unread++;
        sgt_lens_free(lens);
    }
    rays_each = rays / lenses / 3;
    for (int i = 0, tried = 0; i < random && tried < 10 * random; tried++) {
        static text t;
        char name[64];
        sgt_error error = {0};
        random_lens(&t);
        snprintf(name, sizeof name, "random_%llu_%d.yaml", drawn, tried);
        if (folder) {
            char path[1000];
            snprintf(path, sizeof path, "%s/%s", folder, name);
            FILE *f = fopen(path, "w");
            if (f) fputs(t.at, f), fclose(f);
        }
        sgt_lens *lens = sgt_lens_read_text(name, t.at, t.size, NULL, &error);
        if (!lens)
            printf("%s: %s\n", name, error.words);
        else
            i += try_lens(name, lens, (size_t)boxes);
        sgt_lens_free(lens);
    }
    printf("%g rays, %g of them passed, %g climbs, %g integrals, %g boxes in parts, of %g boxes of %g "
           "pupils; %.2f %% of these undecided\n",
           sums.rays, sums.passed, sums.climbed, sums.integrals, sums.parts, sums.boxes, sums.pupils,
           100 * sums.undecided / sums.pupils);
    printf("%d faults\n", sums.faults);
    return sums.faults || unread ? 1 : 0;
}

// SPDX-License-Identifier: MIT
/* zmx_shape.c - the shapes of surfaces of a .zmx file as keys of the lens file.
 *
 * z is the sag, r^2 = x^2 + y^2, c = CURV, k = CONI, Pi = PARM i, Xi = XDAT i; conic(r) as always, and
 * even(r) = P1 r^2 + P2 r^4 + ... + P8 r^16.  N terms are a_1 ... a_N, their radius is R.
 *     STANDARD   conic(r)
 *     EVENASPH   conic(r) + even(r)
 *     ODDASPHE   conic(r) + P1 r + P2 r^2 + ... + P8 r^8
 *     XASPHERE   conic(r) + sum of a_i (r/R)^(2i); N = X1, R = X2, a_i = X(2+i).  XODDASPH: (r/R)^i
 *     TOROIDAL   the curve conic(y) + P2 y^2 + P3 y^4 + ... + P8 y^14, turned about an axis parallel to y at
 *                z = P1; P1 = 0 is a cylinder.  X1 counts Zernike terms on top, which are refused
 *     BICONICX   c and k in y; the radius P1 (0: flat) and the conic constant P2 in x
 *     XPOLYNOM   conic(r) + sum of a_i (x/R)^a (y/R)^b, in the order x, y, x^2, xy ...; N, R, a_i as XASPHERE
 *     IRREGULA   conic(r) + P5 q^4 + P6 v^2 + P7 q^2 v; q = r/R, v = (x sin P8 + y cos P8)/R, R = DIAM.  It
 *                alone is decentred by P1, P2, then tilted by P3 about x, P4 about y
 *     QED_TYPE   conic(r) + Forbes' Qbfs (X1 = 0; see below) or Qcon (X1 = 1); N = X2, R = X3, a_0 = X4
 *     FZERNSAG   conic(r) + even(r) + Zernike's in the fringe order, 1 at r = R; N, R, a_i as XASPHERE
 *     SZERNSAG   the same in Noll's order, with the mean square 1
 *     GRID_SAG   the same as SZERNSAG, and the heights of GARR on a grid that GDAT describes
 *     DGRATING, BINARY_1, BINARY_2, BINARY_3, FZERNPHA, SZERNPHA, HOLOGRM1, HOLOGRM2: see zmx_phase.c
 *     TILTSURF   the plane z = P1 x + P2 y; as surface 0 an object whose points lie there
 *     PARAXIAL   a thin lens without aberrations, of the focal length P1
 *     PARAX_XY   the same with the powers P1 in x and P2 in y, not focal lengths; 0: none there
 *     FRESNELS   the plane z = 0, whose facets have the slopes of conic(r) + even(r)
 *     COORDBRK   no surface: decenter P1, P2, then tilts P3, P4, P5 about x, y, z; P6 not 0: the tilts come
 *                first, and in the other order.  As the stop it is the plane z = 0 behind these
 *
 * (OpticStudio's help, Sequential Surfaces: Toroidal, Extended Polynomial, Irregular, Q-Type Asphere, Zernike
 * Fringe Sag, Grid Sag and others.  It numbers extra data on from the parameters: what it calls parameter
 * 12 + i is XDAT i.)  Types that lack a published layout of their records are refused by name: a wrong shape
 * is worse than none.
 *
 * QBFS ON A CONIC.  Forbes (2007) divides the departure from a sphere by sqrt(1 - c^2 r^2), the cosine of the
 * sphere's normal: it is measured along that normal.  Of a conic the cosine is s, with
 *     1 / s = sqrt((1 - k c^2 r^2) / w) = sqrt(1 + c^2 r^2 / w),    w = 1 - (1 + k) c^2 r^2,
 * the same for k = 0.  The designs of catalogue lenses with such a surface focus with this factor, and not
 * with Forbes' own or with 1.  q_bfs has a sphere under it, so the surface becomes a formula.  Its polynomial
 * is one of t = 1 - 2 u^2, u = r / R, in [-1, 1] over the aperture.  It is made of the P_m of q_bfs.c, whose
 * recurrence is P_m+1 = 2 t P_m - P_m-1 from -2 and 2 on.  Term m gets factors of some 2.4^m, which cancel:
 * 20 terms lose 1e-9 of the largest coefficient at most.
 *
 * THE TILTED PLANE.  Its normal is (-P1, -P2, 1).  The tilt Rz Ry Rx by (a, b, 0) takes (0, 0, 1) to
 * (cos a sin b, -sin a, cos a cos b), so tan b = -P1 and tan a = P2 cos b = P2 / hypot(1, P1).  Apertures are
 * in x and y before the tilt, and would be ellipses after it: they are left out. */
#include "zmx.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double DEGREE = 57.295779513082320877;
enum { BFS_ON_CONIC = 20 }; /* terms */

size_t sgt_zmx_number_of(const zmx *z, const zmx_surface *f) { return (size_t)(f - z->surface); }

void sgt_zmx_set_word(zmx *z, node *map, const char *key, size_t line, const char *text)
{
    tree_set(z->s, map, key, tree_word(z->s, line, text));
}

void sgt_zmx_set_number(zmx *z, node *map, const char *key, size_t line, double x)
{
    tree_set(z->s, map, key, tree_number(z->s, line, x));
}

/* ------------------------------------------------------------------ shapes */

/* The curvature as its radius, if that is the same number: 1/(1/c) is not always c.  The radius with the
 * fewest digits is taken: people type radii, and programs store their reciprocals. */
static void set_curvature(zmx *z, node *map, const char *radius, const char *curvature, size_t line, double c)
{
    enum { FEWEST = 4, MOST = 17 };
    if (c == 0) return;
    for (int digits = FEWEST; digits <= MOST; digits++) {
        char text[40];
        double r;
        snprintf(text, sizeof text, "%.*g", digits, 1 / c);
        if (!sgt_reader_number((piece){text, text + strlen(text)}, &r) || 1 / r != c) continue;
        sgt_zmx_set_number(z, map, radius, line, r);
        return;
    }
    sgt_zmx_set_number(z, map, curvature, line, c);
}

static void write_base(zmx *z, const zmx_surface *f, node *map, const char *type)
{
    sgt_zmx_set_word(z, map, "type", f->line, type);
    set_curvature(z, map, "radius", "curvature", f->curvature_line, f->curvature);
    if (f->conic != 0 && f->curvature != 0) sgt_zmx_set_number(z, map, "conic", f->conic_line, f->conic);
}

void sgt_zmx_write_standard(zmx *z, const zmx_surface *f, node *map)
{
    write_base(z, f, map, f->curvature == 0 ? "plane" : f->conic == 0 ? "sphere" : "conic");
}

/* PARM first ... last as coefficients, without the zeros at their end; false: there are none. */
static size_t coefficients(const zmx_surface *f, size_t first, size_t last)
{
    while (last >= first && f->parm[last] == 0) last--;
    return last + 1 - first;
}

static void set_coefficients(zmx *z, const zmx_surface *f, node *map, size_t first, size_t count)
{
    if (count) tree_set(z->s, map, "coefficients", tree_numbers(z->s, f->parm_line, count, f->parm + first));
}

void sgt_zmx_write_asphere(zmx *z, const zmx_surface *f, node *map)
{
    size_t count = coefficients(f, 1, 8);
    if (count == 0) {
        sgt_zmx_write_standard(z, f, map);
        return;
    }
    write_base(z, f, map, *f->type->name == 'O' ? "odd_asphere" : "even_asphere");
    set_coefficients(z, f, map, 1, count);
}

static void write_toroidal(zmx *z, const zmx_surface *f, node *map)
{
    for (size_t i = 0; i < f->extras; i++)
        if (f->extra[i].number == 1 && f->extra[i].value != 0)
            tree_fail(z->s, f->extra[i].line, "XDAT", "surface %zu: Zernike terms on a TOROIDAL are not read",
                      sgt_zmx_number_of(z, f));
        else if (f->extra[i].number > 2 && f->extra[i].value != 0) /* 2 is the radius of such terms */
            sgt_zmx_tally(z, ZMX_UNUSED, f->extra[i].line, "XDAT");
    write_base(z, f, map, "toroidal");
    if (f->parm[1] != 0) sgt_zmx_set_number(z, map, "radius_x", f->parm_line, f->parm[1]);
    set_coefficients(z, f, map, 2, coefficients(f, 2, 8));
}

static void write_biconic(zmx *z, const zmx_surface *f, node *map)
{
    sgt_zmx_set_word(z, map, "type", f->line, "biconic");
    if (f->parm[1] != 0) sgt_zmx_set_number(z, map, "radius_x", f->parm_line, f->parm[1]);
    if (f->parm[2] != 0) sgt_zmx_set_number(z, map, "conic_x", f->parm_line, f->parm[2]);
    set_curvature(z, map, "radius_y", "curvature_y", f->curvature_line, f->curvature);
    if (f->conic != 0) sgt_zmx_set_number(z, map, "conic_y", f->conic_line, f->conic);
}

/* --------------------------------------------------------- shapes with XDAT */

/* XDAT 1 ... most, 0 where there is none; *line is that of the last one. */
double *sgt_zmx_extras(zmx *z, const zmx_surface *f, size_t most, size_t *line)
{
    bool *given = tree_room(z->s, most + 1, sizeof *given);
    double *extra = tree_room(z->s, most + 1, sizeof *extra);
    *line = f->line;
    for (size_t i = 0; i < f->extras; i++) {
        const size_t n = f->extra[i].number;
        *line = f->extra[i].line;
        if (n > most) continue;
        if (given[n])
            tree_fail(z->s, *line, "XDAT", "a second XDAT %zu of surface %zu", n, sgt_zmx_number_of(z, f));
        given[n] = true, extra[n] = f->extra[i].value;
    }
    return extra;
}

/* XDAT `first` counts them, the next is their radius, and behind that they stand. */
zmx_terms sgt_zmx_terms(zmx *z, const zmx_surface *f, size_t first, size_t most)
{
    zmx_terms t;
    const double *extra = sgt_zmx_extras(z, f, most + first + 1, &t.line), count = extra[first];
    if (!(count >= 0 && count <= (double)most && count == floor(count)))
        tree_fail(z->s, t.line, "XDAT",
                  "surface %zu has %g terms (XDAT %zu), which is no whole number up to %zu",
                  sgt_zmx_number_of(z, f), count, first, most);
    t.count = (size_t)count, t.norm = extra[first + 1];
    for (size_t i = 0; i < f->extras; i++)
        if (f->extra[i].number >= first + 2 + t.count && f->extra[i].value != 0)
            sgt_zmx_tally(z, ZMX_UNUSED, f->extra[i].line, "XDAT"); /* beyond those that are counted */
    t.value = tree_room(z->s, t.count, sizeof *t.value);
    for (size_t i = 0; i < t.count; i++) t.value[i] = extra[first + 2 + i];
    while (t.count && t.value[t.count - 1] == 0) t.count--;
    if (t.count && !(t.norm > 0))
        tree_fail(z->s, t.line, "XDAT", "surface %zu: its terms cannot be scaled by the radius %g (XDAT %zu)",
                  sgt_zmx_number_of(z, f), t.norm, first + 1);
    return t;
}

/* x / norm^power */
double sgt_zmx_by_norm(zmx *z, const zmx_surface *f, size_t line, double x, double norm, size_t power)
{
    const double y = x / pow(norm, (double)power);
    if (!(norm > 0) || !isfinite(y))
        tree_fail(z->s, line, "XDAT", "surface %zu: its terms cannot be scaled by the radius %g",
                  sgt_zmx_number_of(z, f), norm);
    return y;
}

void sgt_zmx_add_xy(zmx_xy *t, size_t i, size_t j, double factor)
{
    if (factor == 0) return;
    t->factor[i][j] += factor;
    if (t->width[i] <= j) t->width[i] = j + 1;
    if (t->rows <= i) t->rows = i + 1;
}

node *sgt_zmx_rows(zmx *z, size_t line, const zmx_xy *t)
{
    node *list = tree_node(z->s, NODE_LIST, line);
    for (size_t i = 0; i < t->rows; i++)
        tree_append(z->s, list, tree_numbers(z->s, line, t->width[i] ? t->width[i] : 1, t->factor[i]));
    return list;
}

static void write_xy(zmx *z, const zmx_surface *f, node *map, size_t line, const zmx_xy *t)
{
    if (t->rows == 0) {
        sgt_zmx_write_standard(z, f, map);
        return;
    }
    write_base(z, f, map, "polynomial_xy");
    tree_set(z->s, map, "coefficients", sgt_zmx_rows(z, line, t));
}

size_t sgt_zmx_polynomial(zmx *z, const zmx_surface *f, zmx_xy *xy)
{
    const zmx_terms t = sgt_zmx_terms(z, f, 1, XY_TERMS);
    for (size_t term = 0, order = 1; term < t.count; order++)
        for (size_t j = 0; j <= order && term < t.count; j++, term++)
            if (t.value[term] != 0)
                sgt_zmx_add_xy(xy, order - j, j, sgt_zmx_by_norm(z, f, t.line, t.value[term], t.norm, order));
    return t.line;
}

static void write_polynomial(zmx *z, const zmx_surface *f, node *map)
{
    zmx_xy *xy = tree_room(z->s, 1, sizeof *xy);
    write_xy(z, f, map, sgt_zmx_polynomial(z, f, xy), xy);
}

/* P1 ... P4, where it is, are breaks. */
static void write_irregular(zmx *z, const zmx_surface *f, node *map)
{
    const double spherical = f->parm[5], astigmatic = f->parm[6], coma = f->parm[7], size = f->size;
    const double s = sin(f->parm[8] / DEGREE), c = cos(f->parm[8] / DEGREE);
    const size_t line = f->parm_line ? f->parm_line : f->line;
    zmx_xy *xy = tree_room(z->s, 1, sizeof *xy);
    if (!(size > 0) && (spherical != 0 || astigmatic != 0 || coma != 0))
        tree_fail(z->s, f->size_line ? f->size_line : line, "DIAM",
                  "surface %zu is IRREGULA, whose terms are scaled by a DIAM above 0",
                  sgt_zmx_number_of(z, f));
    if (size > 0) {
        const double z4 = sgt_zmx_by_norm(z, f, line, spherical, size, 4);
        const double a2 = sgt_zmx_by_norm(z, f, line, astigmatic, size, 2),
                     c3 = sgt_zmx_by_norm(z, f, line, coma, size, 3);
        sgt_zmx_add_xy(xy, 4, 0, z4), sgt_zmx_add_xy(xy, 2, 2, 2 * z4), sgt_zmx_add_xy(xy, 0, 4, z4);
        sgt_zmx_add_xy(xy, 2, 0, a2 * s * s), sgt_zmx_add_xy(xy, 1, 1, 2 * a2 * s * c),
            sgt_zmx_add_xy(xy, 0, 2, a2 * c * c);
        sgt_zmx_add_xy(xy, 3, 0, c3 * s), sgt_zmx_add_xy(xy, 1, 2, c3 * s);
        sgt_zmx_add_xy(xy, 2, 1, c3 * c), sgt_zmx_add_xy(xy, 0, 3, c3 * c);
    }
    write_xy(z, f, map, line, xy);
}

/* Powers of r / R become those of r. */
static void write_extended(zmx *z, const zmx_surface *f, node *map)
{
    const bool even = f->type->name[1] == 'A';
    const zmx_terms t = sgt_zmx_terms(z, f, 1, even ? 8 : 16);
    if (t.count == 0) {
        sgt_zmx_write_standard(z, f, map);
        return;
    }
    for (size_t i = 0; i < t.count; i++)
        t.value[i] = sgt_zmx_by_norm(z, f, t.line, t.value[i], t.norm, even ? 2 * (i + 1) : i + 1);
    write_base(z, f, map, even ? "even_asphere" : "odd_asphere");
    tree_set(z->s, map, "coefficients", tree_numbers(z->s, t.line, t.count, t.value));
}

/* The sum of a[m] Qbfs_m as one of b[m] t^m; b: zeros. */
static void powers_of_bfs(const double a[], size_t count, double b[])
{
    double f[BFS_ON_CONIC] = {2, 0.5 * sqrt(19)}, g[BFS_ON_CONIC] = {-0.5}, h[BFS_ON_CONIC] = {0};
    double by_p[BFS_ON_CONIC + 2] = {0}, before[BFS_ON_CONIC] = {-2}, p[BFS_ON_CONIC] = {2};
    for (size_t m = 2; m < count; m++) {
        const double n = (double)m;
        h[m - 2] = -n * (n - 1) / (2 * f[m - 2]);
        g[m - 1] = -(1 + g[m - 2] * h[m - 2]) / f[m - 1];
        f[m] = sqrt(n * (n + 1) + 3 - g[m - 1] * g[m - 1] - h[m - 2] * h[m - 2]);
    }
    /* P_m = f_m Q_m + g_(m-1) Q_(m-1) + h_(m-2) Q_(m-2), so the sum of by_p[m] P_m is that of a[m] Q_m: */
    for (size_t m = count; m-- > 0;)
        by_p[m] = (a[m] - g[m] * by_p[m + 1] - h[m] * by_p[m + 2]) / f[m];
    for (size_t m = 0; m < count; m++) {
        double next[BFS_ON_CONIC] = {0};
        for (size_t i = 0; i <= m; i++) {
            b[i] += by_p[m] * p[i];
            next[i] -= before[i];
            if (i + 1 < count) next[i + 1] += 2 * p[i];
        }
        memcpy(before, p, sizeof p), memcpy(p, next, sizeof p);
    }
}

static void write_bfs_on_conic(zmx *z, const zmx_surface *f, node *map, const zmx_terms *t)
{
    double b[BFS_ON_CONIC] = {0};
    if (t->count > BFS_ON_CONIC)
        tree_fail(z->s, t->line, "XDAT", "surface %zu: on a conic up to %d terms of Qbfs are read, not %zu",
                  sgt_zmx_number_of(z, f), (int)BFS_ON_CONIC, t->count);
    powers_of_bfs(t->value, t->count, b);
    const char *sum = "0";
    for (size_t m = t->count; m-- > 0;)
        sum = m + 1 == t->count ? tree_print(z->s, "b%zu", m)
                                : tree_print(z->s, "(b%zu + (1 - 2*r^2/norm^2)*%s)", m, sum);
    node *text = tree_word(z->s, f->line, tree_print(z->s,
        "c*r^2/(1 + sqrt(1 - (1 + k)*c^2*r^2)) + "
        "sqrt(1 + c^2*r^2/(1 - (1 + k)*c^2*r^2))*r^2/norm^2*(1 - r^2/norm^2)*%s", sum));
    text->quoted = true;
    sgt_zmx_set_word(z, map, "type", f->line, "formula");
    tree_set(z->s, map, "sag", text);
    sgt_zmx_set_number(z, map, "c", f->curvature_line, f->curvature);
    sgt_zmx_set_number(z, map, "k", f->conic_line, f->conic);
    sgt_zmx_set_number(z, map, "norm", t->line, t->norm);
    for (size_t m = 0; m < t->count; m++)
        sgt_zmx_set_number(z, map, tree_print(z->s, "b%zu", m), t->line, b[m]);
}

/* XDAT 1 says which polynomials of Forbes there are. */
static void write_forbes(zmx *z, const zmx_surface *f, node *map)
{
    enum { MOST = 64 };
    size_t line;
    const double kind = sgt_zmx_extras(z, f, 1, &line)[1];
    const zmx_terms t = sgt_zmx_terms(z, f, 2, MOST);
    if (kind != 0 && kind != 1)
        tree_fail(z->s, line, "XDAT",
                  "surface %zu: %g is no kind of Q polynomials (XDAT 1): 0 is Qbfs, 1 Qcon",
                  sgt_zmx_number_of(z, f), kind);
    if (t.count == 0) {
        sgt_zmx_write_standard(z, f, map);
        return;
    }
    if (kind == 0 && f->conic != 0 && f->curvature != 0) {
        write_bfs_on_conic(z, f, map, &t);
        return;
    }
    write_base(z, f, map, kind == 0 ? "q_bfs" : "q_con");
    sgt_zmx_set_number(z, map, "norm", t.line, t.norm);
    tree_set(z->s, map, "coefficients", tree_numbers(z->s, t.line, t.count, t.value));
}

/* ------------------------------------------ departures, and powers of r beside them */

static node *term_of(zmx *z, size_t line, const char *type)
{
    node *map = tree_node(z->s, NODE_MAP, line);
    sgt_zmx_set_word(z, map, "type", line, type);
    map->inline_ = true;
    return map;
}

/* Puts the conic, PARM 1 ... 8 as even powers, and the terms (NULL: none) together. */
static void write_together(zmx *z, const zmx_surface *f, node *map, node *const terms[], size_t count)
{
    const size_t evens = coefficients(f, 1, 8);
    node *list = tree_node(z->s, NODE_LIST, f->line), *one = NULL;
    if (evens) {
        one = term_of(z, f->parm_line, "even_asphere");
        set_coefficients(z, f, one, 1, evens);
        tree_append(z->s, list, one);
    }
    for (size_t i = 0; i < count; i++)
        if (terms[i]) tree_append(z->s, list, one = terms[i]);
    if (list->count == 0) {
        sgt_zmx_write_standard(z, f, map);
        return;
    }
    write_base(z, f, map, list->count > 1 ? "sum" : tree_take(one, "type")->text);
    if (list->count > 1) tree_set(z->s, map, "terms", list);
    else
        for (size_t i = 0; i < one->count; i++)
            if (strcmp(one->key[i]->text, "type") != 0) tree_set(z->s, map, one->key[i]->text, one->item[i]);
}

/* The Zernike terms of XDAT; NULL: none. */
node *sgt_zmx_zernike(zmx *z, const zmx_surface *f, bool fringe)
{
    enum { FRINGE = 37, NOLL = 231 };
    const zmx_terms t = sgt_zmx_terms(z, f, 1, fringe ? FRINGE : NOLL);
    if (t.count == 0) return NULL;
    if (f->parm[9] != 0 || f->parm[10] != 0)
        tree_fail(z->s, f->parm_line, "PARM", "surface %zu: Zernike terms beside the vertex are not read",
                  sgt_zmx_number_of(z, f));
    node *map = term_of(z, t.line, "zernike");
    sgt_zmx_set_number(z, map, "norm", t.line, t.norm);
    sgt_zmx_set_word(z, map, "order", t.line, fringe ? "fringe" : "noll");
    if (!fringe) sgt_zmx_set_word(z, map, "normalised", t.line, "true");
    tree_set(z->s, map, "coefficients", tree_numbers(z->s, t.line, t.count, t.value));
    return map;
}

/* PARM 0: whether Zernike terms go on beyond their radius, as they do here. */
static void write_zernike(zmx *z, const zmx_surface *f, node *map)
{
    node *const terms[] = {sgt_zmx_zernike(z, f, f->type->name[0] == 'F')};
    if (terms[0] && f->parm[0] == 0)
        tree_remark(z->s, SGT_REMARK_TURNED, f->line, f->type->name,
                    "Zernike terms that go on beyond their radius; in OpticStudio they end there");
    write_together(z, f, map, terms, 1);
}

/* The heights of a grid come in rows from the largest y on. */
static void write_grid(zmx *z, const zmx_surface *f, node *map)
{
    const zmx_grid *g = &f->grid;
    if (!g->line)
        tree_fail(z->s, f->line, "GDAT", "surface %zu is a grid without GDAT", sgt_zmx_number_of(z, f));
    if (g->count != g->columns * g->rows)
        tree_fail(z->s, g->line, "GDAT", "surface %zu has %zu of the %zu heights (GARR) of its grid",
                  sgt_zmx_number_of(z, f), g->count, g->columns * g->rows);
    if (f->parm[0] != 0)
        tree_fail(z->s, f->parm_line, "PARM",
                  "surface %zu: a grid with straight lines between its heights is not read",
                  sgt_zmx_number_of(z, f));
    node *grid = term_of(z, g->line, "grid"), *rows = tree_node(z->s, NODE_LIST, g->line);
    sgt_zmx_set_number(z, grid, "step_x", g->line, g->step[0]);
    sgt_zmx_set_number(z, grid, "step_y", g->line, g->step[1]);
    for (size_t row = g->rows; row-- > 0;)
        tree_append(z->s, rows, tree_numbers(z->s, g->line, g->columns, g->height + row * g->columns));
    tree_set(z->s, grid, "sag", rows);
    tree_remark(z->s, SGT_REMARK_TURNED, g->line, "GDAT",
                "a bicubic surface through its heights; the slopes that the file gives are not used");
    node *const terms[] = {grid, sgt_zmx_zernike(z, f, false)};
    write_together(z, f, map, terms, 2);
}

/* ------------------------------------------------------------------- planes */

static void write_tilted(zmx *z, const zmx_surface *f, node *map)
{
    double slope_x = f->parm[1], slope_y = f->parm[2];
    sgt_zmx_set_word(z, map, "type", f->line, "plane");
    if (slope_x == 0 && slope_y == 0) return;
    double tilt[] = {atan(slope_y / hypot(1, slope_x)) * DEGREE, 0 - atan(slope_x) * DEGREE, 0};
    tree_set(z->s, map, "tilt", tree_numbers(z->s, f->parm_line, 3, tilt));
    sgt_zmx_tally(z, ZMX_TILTED, f->line, "TILTSURF");
}

static void write_ideal(zmx *z, const zmx_surface *f, node *map)
{
    size_t line = f->parm_line ? f->parm_line : f->line;
    if (f->parm[1] == 0)
        tree_fail(z->s, line, "PARM", "surface %zu is PARAXIAL without a focal length",
                  sgt_zmx_number_of(z, f));
    sgt_zmx_set_word(z, map, "type", f->line, "ideal");
    sgt_zmx_set_number(z, map, "focal_length", line, f->parm[1]);
}

/* Powers, and no focal lengths. */
static void write_two_powers(zmx *z, const zmx_surface *f, node *map)
{
    const double x = f->parm[1], y = f->parm[2];
    if (x == 0 && y == 0) {
        sgt_zmx_set_word(z, map, "type", f->line, "plane");
        return;
    }
    sgt_zmx_set_word(z, map, "type", f->line, "ideal");
    sgt_zmx_set_number(z, map, "focal_length", f->parm_line, 1 / x);
    if (x != y) sgt_zmx_set_number(z, map, "focal_length_y", f->parm_line, 1 / y);
}

static void write_fresnel(zmx *z, const zmx_surface *f, node *map)
{
    node *facets = tree_node(z->s, NODE_MAP, f->line);
    sgt_zmx_write_asphere(z, f, facets);
    sgt_zmx_set_word(z, map, "type", f->line, "plane");
    tree_set(z->s, map, "facets", facets);
}

static const zmx_type types[] = {
    {"STANDARD", .round = true, .write = sgt_zmx_write_standard},
    {"EVENASPH", .parms = 8, .round = true, .powers = true, .write = sgt_zmx_write_asphere},
    {"ODDASPHE", .parms = 8, .round = true, .powers = true, .write = sgt_zmx_write_asphere},
    {"XASPHERE", .round = true, .extras = true, .write = write_extended},
    {"XODDASPH", .round = true, .extras = true, .write = write_extended},
    {"TOROIDAL", .parms = 8, .round = true, .extras = true, .write = write_toroidal},
    {"BICONICX", .parms = 2, .round = true, .write = write_biconic},
    {"XPOLYNOM", .round = true, .extras = true, .write = write_polynomial},
    {"IRREGULA", .parms = 8, .round = true, .alone = true, .write = write_irregular},
    {"QED_TYPE", .round = true, .extras = true, .write = write_forbes},
    {"FZERNSAG", .parms = 10, .zeroth = true, .round = true, .extras = true, .write = write_zernike},
    {"SZERNSAG", .parms = 10, .zeroth = true, .round = true, .extras = true, .write = write_zernike},
    {"GRID_SAG", .parms = 10, .zeroth = true, .round = true, .extras = true, .heights = true,
     .write = write_grid},
    {"TILTSURF", .parms = 2, .aslant = true, .write = write_tilted},
    {"PARAXIAL", .parms = 2, .write = write_ideal}, /* PARM 2: how paths are counted, not where rays go */
    {"PARAX_XY", .parms = 2, .write = write_two_powers},
    {"FRESNELS", .parms = 8, .round = true, .powers = true, .write = write_fresnel},
    {"COORDBRK", .parms = 6},
};

/* Types that cannot be read, and those that begin so. */
static const struct { const char *name, *why; } refused[] = {
    {"CHEBYSHE", "the order in which its coefficients are stored is not published"},
    {"NONSEQCO", "light meets its objects in no order that the file says"},
    {"JONESMAT", "polarisation is not traced"},
    {"GRIN", "light goes in curves behind it (a gradient of the index)"},
    {"BIRE", "the medium behind it has two indices"},
    {"USERSURF", "its shape is in another file, a program"},
};

const char *sgt_zmx_refused(piece name)
{
    const size_t length = (size_t)(name.end - name.begin);
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        const size_t own = strlen(refused[i].name);
        if (length >= own && memcmp(name.begin, refused[i].name, own) == 0) return refused[i].why;
    }
    return NULL;
}

const zmx_type *sgt_zmx_shape(piece name)
{
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (sgt_reader_is(name, types[i].name)) return &types[i];
    return NULL;
}

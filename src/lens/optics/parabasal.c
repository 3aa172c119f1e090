// SPDX-License-Identifier: MIT
/* parabasal.c - first-order data along a real chief ray.
 *
 * Rays near the chief ray differ from it by X, a displacement at right angles to it, and by U, the
 * change of its unit direction.  From the launch to the end both are linear:
 *
 *     X' = A X + B U,   U' = C X + D U,
 *
 * with 2 x 2 matrices that the derivatives of the trace give (sgt_trace_sensitivity).  A point of
 * the end is on the last surface; its part at right angles to the ray is X'.
 *
 * THE SECTIONS.  X and U are told in a basis at right angles to the ray.  It begins with the global
 * x, as far as that is across the ray, and y; at a mirror it is reflected, and at a refraction
 * turned as little as the ray is.  So on the axis of a centred lens it is x and y throughout, and
 * where all lies in the y-z plane its first vector is x.
 *
 * POWER is -n' C.  Rays that come parallel (U = 0) meet the chief ray where A + t C is singular; if
 * the sections do not mix, C_xy = C_yx = 0, that is t = -A_xx / C_xx and -A_yy / C_yy.  Rays from
 * the start of the chief ray (X = 0): t = -B / D (the matrices of Buchroeder 1970 and of
 * Stone and Forbes 1992, J. Opt. Soc. Am. A 9, 96, for the base ray of an asymmetric system).
 *
 * IF THE SECTIONS MIX, a neighbouring ray of a section passes the chief ray beside it.  Its part along the
 * section still vanishes at -A_xx / C_xx, or -B_xx / D_xx: there the ray fan of the section has no slope. */
#include "parabasal.h"

#include "../base/vec3.h"

#include <sagitta/aim.h>

#include <stdio.h>

/* A vector across the ray d as it goes on along d'. */
static sgt_vec3 carried(sgt_vec3 e, sgt_vec3 d, sgt_vec3 after, bool mirror)
{
    if (mirror) {
        sgt_vec3 n = unit3(along3(after, -1, d));
        return along3(e, -2 * dot3(e, n), n);
    }
    sgt_vec3 turn = cross3(d, after), once = cross3(turn, e), twice = cross3(turn, once);
    return along3(along3(e, 1, once), 1 / (1 + dot3(d, after)), twice);
}

bool sgt_parabasal_about(const sgt_chief_ray *chief, sgt_vec3 across, sgt_parabasal *out,
                         sgt_sections *sections)
{
    const size_t elements = chief->elements;
    const sgt_element *e = chief->e;
    const sgt_passage *passages = chief->passages;
    const bool from_point = chief->from_point;
    const double none = (double)NAN;
    if (sections) *sections = (sgt_sections){{none, none}, {{none, none, none}, {none, none, none}}};
    *out = (sgt_parabasal){.power = {{none, none}, {none, none}}, .power_xy = none};
    for (int k = 0; k < 2; k++) out->efl[k] = out->focus[k] = out->image[k] = out->magnification[k] = none;
    if (elements == 0) return false;
    for (size_t i = 0; i < elements; i++)
        if (!(passages[i].hit.status > 0)) return false;
    sgt_ray ray = *chief->ray;
    ray.d = unit3(ray.d);
    const sgt_vec3 zero = {0, 0, 0};
    sgt_vec3 d = ray.d, base[2];
    base[0] = unit3(along3(across, -dot3(across, d), d));
    base[1] = cross3(d, base[0]);

    sgt_ray_change change[4];
    for (int k = 0; k < 2; k++) {
        change[k] = (sgt_ray_change){.p = base[k], .d = zero};
        change[k + 2] = (sgt_ray_change){.p = zero, .d = base[k]};
    }
    if (sgt_trace_sensitivity(elements, e, chief->index_before, &ray, passages, 4, change, change))
        return false;

    double index = chief->index_before == 0 ? 1 : chief->index_before;
    for (size_t i = 0; i < elements; i++) {
        sgt_vec3 after = unit3(out_of3(&e[i].pose, passages[i].direction));
        for (int k = 0; k < 2; k++) base[k] = carried(base[k], d, after, e[i].index == SGT_MIRROR);
        if (e[i].index != SGT_MIRROR && e[i].index != 0) index = e[i].index;
        d = after;
    }
    /* m[row][column]: X', U' along the two vectors, by X and U */
    double m[4][4];
    for (int c = 0; c < 4; c++) {
        sgt_vec3 dp = out_of3(&e[elements - 1].pose, change[c].p);
        sgt_vec3 dd = out_of3(&e[elements - 1].pose, change[c].d);
        for (int k = 0; k < 2; k++) m[k][c] = dot3(base[k], dp), m[k + 2][c] = dot3(base[k], dd);
    }
    double largest = 0, mixed = 0;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            out->power[i][j] = -index * m[i + 2][j];
            double size = fabs(out->power[i][j]);
            if (i == j) largest = fmax(largest, size);
            else mixed = fmax(mixed, size);
        }
    const bool apart = mixed <= 1e-9 * largest;
    out->power_xy = apart ? 0 : mixed;
    for (int k = 0; k < 2; k++) {
        double a = m[k][k], b = m[k][k + 2], c = m[k + 2][k], g = m[k + 2][k + 2];
        bool powered = fabs(c) > 1e-13 * largest && largest > 0, converging = fabs(g) > 1e-13;
        if (apart && powered) out->efl[k] = -1 / (index * c), out->focus[k] = -a / c;
        if (apart && from_point && converging) {
            out->image[k] = -b / g;
            out->magnification[k] = a + out->image[k] * c;
        } else if (apart) {
            out->image[k] = out->focus[k];
        }
        if (sections) sections->along[k] = into3(&e[elements - 1].pose, base[k]);
        if (sections && (from_point ? converging : powered))
            sections->focus[k] = from_point ? -b / g : -a / c;
    }
    return true;
}

bool sgt_lens_parabasal(size_t elements, const sgt_element e[], double index_before, bool from_point,
                        const sgt_ray *chief, const sgt_passage passages[], sgt_parabasal *out,
                        sgt_error *error)
{
    const bool along_x = !(fabs(unit3(chief->d).x) < 0.99);
    const sgt_vec3 across = along_x ? (sgt_vec3){0, 1, 0} : (sgt_vec3){1, 0, 0};
    const sgt_chief_ray way = {elements, e, index_before, chief, passages, from_point};
    if (sgt_parabasal_about(&way, across, out, NULL)) return true;
    if (!error) return false;
    *error = (sgt_error){.line = 0};
    size_t met = 0;
    while (met < elements && passages[met].hit.status > 0) met++;
    if (elements == 0) snprintf(error->words, sizeof error->words, "there are no elements");
    else if (met < elements)
        snprintf(error->words, sizeof error->words, "the chief ray does not get through surface %zu",
                 met + 1);
    else snprintf(error->words, sizeof error->words, "a surface has no second derivatives");
    return false;
}

// SPDX-License-Identifier: MIT
/* bundle.h - all launch rays of a part of a beam at once, as far as a stop. */
#ifndef SGT_SYSTEM_BUNDLE_H
#define SGT_SYSTEM_BUNDLE_H
#include "aim.h"
#include "form.h"

/* See the head of bundle.c. */
#define BUNDLE_SLACK 0x1p-46

typedef enum bundle_fate {
    BUNDLE_THERE,    /* rays that get to the stop meet it within x, y */
    BUNDLE_GONE,     /* certainly none gets there */
    BUNDLE_UNKNOWN   /* nothing is known of so large a part */
} bundle_fate;

/* Can bundles be traced through these elements at all?  (bundle.c) */
bool sgt_bundle_offered(const aim_task *task);

/* The rays of the beam with u and v in the box, which is mapped to U and V: where they meet the stop, in its
 * frame.  kept: [AIM_KEPT][2], the same for all boxes of the beam; none is known before the first.
 * (bundle.c) */
bundle_fate sgt_bundle_trace(const aim_task *task, sgt_interval u, sgt_interval v, sag_kept (*kept)[2],
                             linear *x, linear *y);

/* The lines of a bundle at a surface: they cross its vertex plane at (x, y, 0), with the unit direction d. */
typedef struct bundle_lines { linear x, y; form3 d; } bundle_lines;

/* Where the lines meet a surface: n is along the gradient there, size2 is n . n, slope n . d, and sign that
 * of the slope on all lines. */
typedef struct bundle_hit { form3 p, n; linear size2, slope; double sign; } bundle_hit;

/* Every root that sgt_trace may mean, of a conic, and of an even asphere or a departure.  aperture: of the
 * element; HUGE_VAL: none.  kept: of the surface with this aperture, and with its rim.  (bundle_conic.c,
 * bundle_sag.c) */
bundle_fate sgt_bundle_conic(double c, double k, double rim, double aperture, const bundle_lines *w,
                             bundle_hit *h);
bundle_fate sgt_bundle_sag(sgt_surface surface, double aperture, const bundle_lines *w, sag_kept kept[2],
                           bundle_hit *h);

/* Has each of the lines at most one root with r <= L, of an even asphere or a departure?  *none: and none of
 * them has one.  kept: as above, of this L.  (bundle_sag.c) */
bool sgt_bundle_sag_only(sgt_surface surface, double L, const bundle_lines *w, sag_kept *kept, bool *none);

/* The points of a conic or one of these sags within r <= reach, its rim and its edge: x (and y), and z.
 * false: nothing bounds them.  (bundle_sag.c) */
bool sgt_bundle_sag_points(sgt_surface surface, double reach, sgt_interval *x, sgt_interval *z);

/* The slopes of the sag of a conic or one of these at x, y.  false: nothing is known of them.
 * (bundle_sag.c) */
bool sgt_bundle_sag_slopes(sgt_surface surface, linear x, linear y, linear *by_x, linear *by_y);

/* d behind an element whose phase is in waves, from that in front.  false: *fate says why there is none.
 * (waves.c) */
bool sgt_waves_bundle(const sgt_element *e, double n1, const bundle_hit *h, form3 *d, bundle_fate *fate);

/* Is it one of these, with valid parameters?  (bundle_sag.c) */
bool sgt_bundle_has_sag(sgt_surface surface);

#endif

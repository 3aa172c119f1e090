// SPDX-License-Identifier: MIT
/* disc.h - the unit disc of a pupil in boxes of radius and angle, which fit it without an edge.
 *
 * A SECTOR is r0 <= r <= r1, turn0 <= angle <= turn1, angles in turns from x toward y.  It is halved in
 * radius or angle.  Its ends stay sums of few powers of two, so that its area
 *
 *     (r1^2 - r0^2) (turn1 - turn0)   of the disc's
 *
 * is exact as long as it is halved at most DISC_DEEPEST times each way.  Areas of sectors that make up the
 * disc add up to 1 without rounding.
 *
 * A COVER is the rectangle about it: along its middle direction from r0 cos(w) to r1, and across it r1 sin(w)
 * to either side, w half its angle.  A whole turn has the square about the disc of r1.  So
 *
 *     x = x0 + s xs + t xt,   y = y0 + s ys + t yt,   s and t in [-1, 1],
 *
 * are the parameters of a box of rays.  The cover sticks out of the disc by r1 w^2 / 2.  (Radius and angle as
 * parameters stick out less, but they are not linear: what a model leaves out of a cosine, w^3 / 6, is
 * carried
 * on as if each ray had its own, and then makes rests twelve times as large: measured on a triplet.)
 *
 * AN INTEGRAL over the sector of a model f = c + a s + b t + aa s^2 + ab s t + bb t^2 +- rest is that of each
 * of its terms.  In parts of the disc's area, with c0, hs, ht the middle and the half widths of the cover:
 *
 *     of 1:             (r1^2 - r0^2) w / pi
 *     of r cos:         (r1^3 - r0^3) / 3 2 sin w / pi
 *     of (r cos)^2:     (r1^4 - r0^4) / 4 (w + sin w cos w) / pi
 *     of (r sin)^2:     (r1^4 - r0^4) / 4 (w - sin w cos w) / pi
 *     s = (r cos - c0) / hs,   t = r sin / ht;   of t and s t: 0, by symmetry. */
#ifndef SGT_PROVE_DISC_H
#define SGT_PROVE_DISC_H
#include <sagitta/beam.h>

typedef struct sector { double r0, r1, turn0, turn1; } sector;
enum { DISC_DEEPEST = 24 };

/* All of the disc. */
static const sector DISC_WHOLE = {0, 1, 0, 1};

/* In parts of the disc's area; exact. */
double sgt_sector_area(const sector *of);

/* Is its cover of use: a disc about the centre, or an eighth of a turn at most? */
bool sgt_sector_is_fit(const sector *of);

/* The middle and the half widths; x and y of its points. */
typedef struct cover { double c, hs, ht; } cover;
cover sgt_sector_cover(const sector *of);
void sgt_sector_models(const sector *of, sgt_model *x, sgt_model *y);

/* The integral of a function over it, in parts of the disc's area. */
sgt_interval sgt_sector_integral(const sector *of, const sgt_model *f);

/* Halves it: in angle, or in radius. */
void sgt_sector_halve(const sector *of, bool in_angle, sector half[2]);

/* Can it be halved this way? */
bool sgt_sector_can_halve(const sector *of, bool in_angle);

/* A point of it: at the share p of its radii and q of its angles, 0 to 1; of a disc the centre, or at q the
 * edge. */
void sgt_sector_point(const sector *of, double p, double q, double *x, double *y);

#endif

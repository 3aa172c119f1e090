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
 * ITS RAYS.  Radius and angle are the parameters of a series: x = r cos a, y = r sin a, so that the sector is
 * the box, no more and no less.  The series leave out some 3e-5 of a sector of a quarter turn, and 1 / 128 of
 * that of its half.
 *
 * AN INTEGRAL over the sector, in parts of the disc's area, is the area times the mean with the weight r.  Of
 * a series each term has its own in closed form (sgt_series_mean). */
#ifndef SGT_PROVE_DISC_H
#define SGT_PROVE_DISC_H
#include <sagitta/beam.h>

typedef struct sector { double r0, r1, turn0, turn1; } sector;
enum { DISC_DEEPEST = 24 };

/* All of the disc. */
static const sector DISC_WHOLE = {0, 1, 0, 1};

/* In parts of the disc's area; exact. */
double sgt_sector_area(const sector *of);

/* Can it be carried through: a quarter of a turn at most? */
bool sgt_sector_is_fit(const sector *of);

/* x and y of its points. */
void sgt_sector_series(const sector *of, sgt_series *x, sgt_series *y);

/* The integral of a function over it, in parts of the disc's area. */
sgt_interval sgt_sector_integral(const sector *of, const sgt_series *f);

/* Halves it: in angle, or in radius. */
void sgt_sector_halve(const sector *of, bool in_angle, sector half[2]);

/* Can it be halved this way? */
bool sgt_sector_can_halve(const sector *of, bool in_angle);

/* A point of it: at the share p of its radii and q of its angles, 0 to 1; of a disc the centre, or at q the
 * edge. */
void sgt_sector_point(const sector *of, double p, double q, double *x, double *y);

#endif

// SPDX-License-Identifier: MIT
/* between_box.h - a box of field, wavelength and pupil on its way: what the files between*.c share.
 *
 *     between_through.c  the room; indices over the wavelengths; a box as a launch, and through the lens
 *     between_carry.c    bounds of what it shows at the elements and in the image
 *     between_rays.c     rays of it, and the worst that are found
 *     between.c          branch and bound */
#ifndef SGT_PROVE_BETWEEN_BOX_H
#define SGT_PROVE_BETWEEN_BOX_H
#include "between.h"

#include <math.h>
#include <string.h>

static const double HALF_TURN = 3.141592653589793, SLACK = 0x1p-46;
enum { CHOICES = 3 };

/* Which bound is too wide: each has its own best way to divide. */
enum { WAY_SPOT, WAY_OPD, WAY_ELEMENT };

typedef struct between_box {
    double lo[SIDES], hi[SIDES];
    size_t patch;
    bool ended, bounded, hopeless; /* no ray passes; bounds are not those of nothing; it cannot be divided */
    signed char divide[CHOICES];
    double high, low;            /* bounds of the path difference and of its negative */
    size_t element;
    sgt_box_why why;
} between_box;

/* What stands behind an element: of a glass its index varies with the wavelength. */
typedef struct medium_over { sgt_glass glass; bool varies; } medium_over;

/* The numbers of the lens over wavelengths from lo to hi. */
typedef struct at_waves {
    double lo, hi;
    sgt_model um, *index;
    size_t numbers;
    sgt_box_number *number;
    sgt_model *per_wave;
} at_waves;

/* The rays of a box at the last element (sgt_between_through). */
typedef struct ray_ends { sgt_box_end end; sgt_model p[3], d[3], at[3], opl, whole; } ray_ends;

enum { WAVES_KEPT = 8, VARIANTS = 4 };
typedef struct through_room {
    const between_cell *c;
    sgt_element *own[VARIANTS];  /* the lens, a wider one, and without items: the chief ray's, at um[0] and at
                                    the primary wavelength */
    sgt_box_room *kept[VARIANTS];
    sgt_box_at *at;
    medium_over *medium;           /* [count + 1] */
    at_waves waves[WAVES_KEPT];
    size_t next;
    /* rays of one field at one wavelength */
    sgt_passage *passages;
    sgt_element *open, *traced;
    sgt_phase *phase;
    double *value;
    sgt_field_beam beam;
    prove_cell cell;
    carry_room *rays;
} through_room;

/* Memory set to zero; NULL: there is none. */
static inline void *taken(const between_cell *c, size_t count, size_t size)
{
    void *at = sgt_launch_take(c->from, count, size);
    if (at) memset(at, 0, (count ? count : 1) * size);
    return at;
}

/* Is there a range of wavelengths? */
static inline bool is_wide(const between_cell *c) { return c->um[1] > c->um[0]; }

static inline void add_rest(sgt_model *m, double by) { m->rest = sgt_sum_above(m->rest, by); }

static inline sgt_model dot_product(const sgt_model a[3], const sgt_model b[3])
{
    sgt_model sum, product;
    sgt_model_product(&a[0], &b[0], &sum);
    for (int k = 1; k < 3; k++)
        sgt_model_product(&a[k], &b[k], &product), sgt_model_sum(&sum, &product, &sum);
    return sum;
}

static inline void minus_of(const sgt_model a[3], const sgt_model b[3], sgt_model out[3])
{
    for (int k = 0; k < 3; k++) sgt_model_difference(&a[k], &b[k], &out[k]);
}

static inline void scaled_of(const sgt_model a[3], const sgt_model *by, sgt_model out[3])
{
    for (int k = 0; k < 3; k++) sgt_model_product(&a[k], by, &out[k]);
}

/* ------------------------------------------------------- between_through.c */

/* What one thread needs.  false: no memory.  It is freed in either case. */
bool sgt_between_room_begin(through_room *r, const between_cell *c);
void sgt_between_room_free(through_room *r);

/* The numbers of the lens over a range of wavelengths.  parameter: that of the wavelength.  false: not known.
 */
bool sgt_between_waves(through_room *r, int parameter, double lo, double hi, at_waves **out);

/* The lens at one wavelength, for rays. */
double sgt_between_elements(through_room *r, double um);

/* Which parameter each side is; -1: none, as it has no width.  Those of the field come first: the chief ray
 * has no others. */
int sgt_between_parameters(const between_cell *c, int place[SIDES]);

/* The field: slopes, or x and y of the object. */
void sgt_between_field_model(const between_cell *c, const between_box *b, const int place[SIDES],
                             sgt_model out[2]);

/* Points of a pupil of radius 1 that hold the sector. */
void sgt_between_pupil_model(const between_box *b, const int place[SIDES], sgt_model out[2]);

/* The point x, y of the pupil of radius 1, after vignetting, as rays of the field. */
sgt_box_launch sgt_between_launch(const between_cell *c, const sgt_model field[2],
                                  const sgt_model pupil[2], int parameters);

/* Through one of the lenses of the room, element by element.  Of `ends`: p and opl in front of the last
 * element, d there, all in its frame, `at` where they meet it, and the whole path to there.  wave: NULL, as
 * the lens stands. */
sgt_box_verdict sgt_between_through(through_room *r, int variant, const at_waves *wave,
                                    const sgt_box_launch *launch, size_t count, sgt_box_at at[],
                                    ray_ends *out);

/* --------------------------------------------------------- between_carry.c */

/* Does the last element bend nothing? */
bool sgt_between_front_known(const between_cell *c);

/* Carries a box: its fate, how it is best divided, and bounds of each quantity. */
void sgt_between_carry(through_room *r, between_box *b, double bound[]);

/* ---------------------------------------------------------- between_rays.c */

/* The rays of a field and wavelength from now on. */
void sgt_between_aim(through_room *r, size_t patch, const double s[SIDES]);

/* Traces the ray of these sides, of the field and wavelength that are aimed at.  true: it passes. */
bool sgt_between_passes(through_room *r, const double s[SIDES]);

/* Keeps what is worse than anything seen, of the ray that was traced last. */
void sgt_between_note(const through_room *r, size_t patch, const double s[SIDES], between_seen seen[]);

#endif

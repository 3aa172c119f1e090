/* move.h - the origin of a ray moved along it. */
#ifndef SGT_RAY_MOVE_H
#define SGT_RAY_MOVE_H

#include <sagitta/sagitta.h>

/* The ray with its origin moved along it to near `about`, exactly; the t0 of that, 0 where there is none. */
double sgt_move_exactly(const sgt_ray *ray, double about, sgt_ray *moved);

#endif

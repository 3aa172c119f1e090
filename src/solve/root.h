/* root.h - what the floors above may ask of the solver beyond its public face. */
#ifndef SGT_SOLVE_ROOT_H
#define SGT_SOLVE_ROOT_H
#include <sagitta/sagitta.h>

enum { SGT_DEFAULT_EVALS = 2000 };

/* Tells the solver of an evaluation made elsewhere (an end of a bracket that a
 * march has found); before the first sgt_root_next.  It costs no budget. */
void sgt_root_tell(sgt_root *r, double t, double g);

/* Every number an option may hold: none NaN, none negative; and a proof there is. */
static inline bool sgt_options_valid(const sgt_options *o)
{
    return !o || (o->t_tol >= 0 && o->f_tol >= 0 && o->dt_min >= 0 && o->max_evals >= 0 &&
                  (unsigned)o->proof <= SGT_PROVE_FIRST);
}

#endif

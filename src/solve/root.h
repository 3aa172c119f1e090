/* root.h - what other files may ask of the solver (root.c) beyond sagitta.h. */
#ifndef SGT_SOLVE_ROOT_H
#define SGT_SOLVE_ROOT_H
#include <sagitta/sagitta.h>

enum { SGT_DEFAULT_EVALS = 2000 };

/* Tells the solver of an evaluation made elsewhere: g at t, an end of a bracket that a march has found.  g
 * has a certain sign.  To be called before the first sgt_root_next.  It costs no budget. */
void sgt_root_tell(sgt_root *r, double t, double g);

/* Is every number of the options valid: not NaN, not negative, and `proof` one of its names? */
static inline bool sgt_options_valid(const sgt_options *o)
{
    return !o || (o->t_tol >= 0 && o->f_tol >= 0 && o->dt_min >= 0 && o->max_evals >= 0 &&
                  (unsigned)o->proof <= SGT_PROVE_FIRST);
}

#endif

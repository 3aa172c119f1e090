// SPDX-License-Identifier: MIT
/* schedule.h - the nodes of a graph that a formula needs, as the steps of a tape. */
#ifndef SGT_SURFACE_FORMULA_SCHEDULE_H
#define SGT_SURFACE_FORMULA_SCHEDULE_H

#include "graph.h"

/* What the result needs: how many steps and uniforms there will be. */
typedef struct formula_needs {
    int steps, uniforms;
} formula_needs;

/* Marks them, and works out in which order operands are best made.  After that no nodes may be added, and
 * constants have no intervals any more. */
formula_needs sgt_schedule_needs(formula_graph *g, int result);

/* Writes that many uniforms and steps.  Returns the most registers that are needed at once, with x, y, z.  If
 * they are more than FORMULA_REGISTERS, the steps are of no use. */
int sgt_schedule_write(formula_graph *g, int result, formula_uniform *uniform, formula_step *step);

#endif

// SPDX-License-Identifier: MIT
/* grid_measure.c - the bounds of a grid: surfaces.h. */
#include "dispatch.h"

#include <sagitta/surfaces.h>

SGT_DISPATCH_VOID(sgt_grid_measure, (sgt_grid * grid), (grid))

// SPDX-License-Identifier: MIT
/* tolerance.h - reads `tolerances` of a lens file. */
#ifndef SGT_LENS_READ_TOLERANCE_H
#define SGT_LENS_READ_TOLERANCE_H
#include "lens.h"

/* Of a list, when the surfaces have been read: sets w->tolerance and w->tolerances.  n NULL: none. */
void sgt_read_tolerances(whole_lens *w, source *s, const node *n);

#endif

// SPDX-License-Identifier: MIT
/* conjugate.h - the conjugate planes of ideal lenses whose file gives none. */
#ifndef SGT_LENS_CONJUGATE_H
#define SGT_LENS_CONJUGATE_H
#include "../read/lens.h"

/* Puts them into w->phase_at, once all else of the lens is read. */
void sgt_find_conjugates(whole_lens *w, source *s);

#endif

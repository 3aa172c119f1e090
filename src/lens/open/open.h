// SPDX-License-Identifier: MIT
/* open.h - a tree becomes a lens. */
#ifndef SGT_LENS_OPEN_H
#define SGT_LENS_OPEN_H
#include "../read/lens.h"

typedef void (*lens_maker)(whole_lens *w, source *s);

/* Makes the lens of s->root, by w->make.  Remarks that s has already are those of the import. */
void sgt_make_lens(whole_lens *w, source *s);

/* When a making has ended, well or not: gives back what is not in the arena. */
void sgt_end_making(whole_lens *w, source *s);

#endif

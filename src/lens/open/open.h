// SPDX-License-Identifier: MIT
/* open.h - a tree becomes a lens. */
#ifndef SGT_LENS_OPEN_H
#define SGT_LENS_OPEN_H
#include "../read/lens.h"

typedef void (*lens_maker)(whole_lens *w, source *s);

/* Makes the lens of s->root, by w->make.  Remarks that s has already are those of the import. */
void sgt_make_lens(whole_lens *w, source *s);

/* What a new making takes from a lens that was made: its tree, copied, and what does not stand there. */
void sgt_take_over(whole_lens *w, source *s, const whole_lens *old);

/* When a making has ended, well or not: gives back what is not in the arena. */
void sgt_end_making(whole_lens *w, source *s);

#endif

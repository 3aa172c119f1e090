// SPDX-License-Identifier: MIT
/* resolve.h - the values of pickups and solves. */
#ifndef SGT_LENS_RESOLVE_H
#define SGT_LENS_RESOLVE_H
#include "../read/lens.h"

typedef struct resolution resolution;

/* Puts its value in the place of each pickup and solve of s->root, for the reader.  NULL: there is none. */
const resolution *sgt_resolve(whole_lens *w, source *s);

/* Puts them back, with their values beside them.  NULL: nothing. */
void sgt_end_resolution(const resolution *r);

#endif
